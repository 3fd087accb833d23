//! Network of time: Fourier features, one hidden layer of tanh units beside a linear path, and exact
//! derivatives with respect to time and weights.

use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};
use seed::Seed;

/// Shape of a network of scaled time, which runs from −1 to 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Shape {
    /// Number of frequencies of the features: half a cycle per window, one cycle, one and a half, …
    pub(super) frequencies: usize,
    /// Number of hidden units.
    pub(super) hidden: usize,
}

/// Value, first and second derivative with respect to scaled time.
pub(super) type Jet = [f64; 3];

impl Shape {
    /// Returns the number of features: 1, the time, and a sine and a cosine of each frequency.
    fn features(self) -> usize {
        2 + 2 * self.frequencies
    }

    /// Returns the number of weights: those of the linear path, then each unit's output weight, bias and
    /// input weights.
    pub(super) fn weights(self) -> usize {
        self.features() + self.hidden * (2 + self.features())
    }

    /// Draws initial weights: the network's output is zero, its hidden units are not.
    pub(super) fn start(self, seed: &Seed) -> Vec<f64> {
        let mut generator = seed.generator();
        let (features, spread) = (self.features(), (self.features() as f64).sqrt().recip());
        let mut weights = vec![0.0; features];
        for _ in 0..self.hidden {
            weights.push(0.0);
            weights.push(2.0 * generator.random::<f64>() - 1.0);
            let draw = |_| {
                let standard: f64 = StandardNormal.sample(&mut generator);
                spread * standard
            };
            weights.extend((0..features).map(draw));
        }
        weights
    }

    /// Returns the features at a scaled time.
    fn features_at(self, s: f64) -> Vec<Jet> {
        let waves = (1..=self.frequencies).flat_map(|number| {
            let rate = 0.5 * std::f64::consts::PI * number as f64;
            let (sine, cosine) = (rate * s).sin_cos();
            let square = rate * rate;
            [[sine, rate * cosine, -square * sine], [cosine, -rate * sine, -square * cosine]]
        });
        [[1.0, 0.0, 0.0], [s, 1.0, 0.0]].into_iter().chain(waves).collect()
    }

    /// Returns the network at a scaled time, and the derivatives of its value, slope and curvature with
    /// respect to each weight.
    pub(super) fn at(self, weights: &[f64], s: f64) -> (Jet, Vec<Jet>) {
        let features = self.features_at(s);
        let (linear, units) = weights.split_at_checked(features.len()).unwrap_or((weights, &[]));
        let mut sum = dot(linear, &features);
        let mut by_weight = features.clone();
        for unit in units.chunks(2 + features.len()) {
            let [out, bias, inputs @ ..] = unit else { continue };
            let [z, slope, curvature] = dot(inputs, &features);
            let t = (z + bias).tanh();
            let first = 1.0 - t * t;
            let second = -2.0 * t * first;
            let third = -2.0 * (first * first + t * second);
            let own = [t, first * slope, second * slope * slope + first * curvature];
            sum.iter_mut().zip(own).for_each(|(sum, own)| *sum += out * own);
            by_weight.push(own);
            let by = |[value, along, bend]: Jet| {
                [
                    out * first * value,
                    out * (second * value * slope + first * along),
                    out * (third * value * slope * slope
                        + 2.0 * second * slope * along
                        + second * value * curvature
                        + first * bend),
                ]
            };
            by_weight.push(by([1.0, 0.0, 0.0]));
            by_weight.extend(features.iter().map(|feature| by(*feature)));
        }
        (sum, by_weight)
    }
}

fn dot(weights: &[f64], features: &[Jet]) -> Jet {
    weights.iter().zip(features).fold([0.0; 3], |sum, (weight, feature)| {
        let [a, b, c] = sum;
        let [value, slope, curvature] = feature;
        [a + weight * value, b + weight * slope, c + weight * curvature]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_those_of_the_network() {
        let shape = Shape { frequencies: 2, hidden: 3 };
        let mut weights = shape.start(&Seed::new(1));
        weights.iter_mut().enumerate().for_each(|(at, weight)| *weight += 0.3 * (at as f64).sin());
        let step = 1e-5;
        let [before, here, after] = [-step, 0.0, step].map(|by| shape.at(&weights, 0.3 + by).0);
        assert!((here[1] - (after[0] - before[0]) / (2.0 * step)).abs() < 1e-7);
        assert!((here[2] - (after[1] - before[1]) / (2.0 * step)).abs() < 1e-7);
        let by_weight = shape.at(&weights, 0.3).1;
        assert_eq!(by_weight.len(), weights.len());
        for (at, expected) in by_weight.iter().enumerate() {
            let moved = |by: f64| {
                let mut moved = weights.clone();
                moved[at] += by;
                shape.at(&moved, 0.3).0
            };
            let (low, high) = (moved(-step), moved(step));
            for order in 0..3 {
                let slope = (high[order] - low[order]) / (2.0 * step);
                assert!((slope - expected[order]).abs() < 1e-6, "{at} {order}");
            }
        }
    }
}
