//! No-U-turn sampler: one transition.
//!
//! Reference: Hoffman, Gelman, J. Mach. Learn. Res. 15 (2014) 1593, for the doubling and the step size;
//! Betancourt, arXiv:1701.02434 (2017), appendix A.3 and A.4, for drawing from the trajectory by weight
//! instead of by a slice, and for the U-turn criterion with a metric that is not the identity.

use nalgebra::{Cholesky, Matrix3, U3, Vector3};
use rand::{Rng, RngExt};
use rand_distr::StandardNormal;

/// Position with the density and its gradient there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Point {
    pub(crate) position: Vector3<f64>,
    /// Logarithm of the density, up to a constant.
    pub(crate) log_density: f64,
    /// Gradient of the logarithm of the density.
    pub(crate) gradient: Vector3<f64>,
}

/// Density in three dimensions.
pub(crate) trait LogDensity {
    /// Returns the density and its gradient at a position.
    fn at(&self, position: Vector3<f64>) -> Point;
}

/// Inverse mass matrix: an estimate of the posterior's covariance.
#[derive(Debug, Clone)]
pub(crate) struct Metric {
    covariance: Matrix3<f64>,
    factor: Cholesky<f64, U3>,
}

impl Metric {
    /// Returns the metric used before anything is known about the posterior.
    pub(crate) fn identity() -> Self {
        let covariance = Matrix3::identity();
        Self { covariance, factor: Cholesky::pack_dirty(covariance) }
    }

    /// Creates a metric from a covariance; `None` if the matrix is not positive definite.
    pub(crate) fn new(covariance: Matrix3<f64>) -> Option<Self> {
        let finite = covariance.iter().all(|entry| entry.is_finite());
        let factor = Cholesky::new(covariance).filter(|_| finite)?;
        Some(Self { covariance, factor })
    }

    /// Draws a momentum, normal with the inverse of the covariance: p = L⁻ᵀ·n with covariance = L·Lᵀ.
    fn draw(&self, generator: &mut impl Rng) -> Vector3<f64> {
        let normal = Vector3::from_fn(|_, _| generator.sample::<f64, _>(StandardNormal));
        self.factor.l_dirty().tr_solve_lower_triangular(&normal).unwrap_or(normal)
    }

    fn velocity(&self, momentum: &Vector3<f64>) -> Vector3<f64> {
        self.covariance * momentum
    }
}

/// State in phase space.
#[derive(Debug, Clone, Copy)]
struct State {
    point: Point,
    momentum: Vector3<f64>,
    velocity: Vector3<f64>,
}

impl State {
    /// Returns the energy −ln density + ½·pᵀ·covariance·p.
    fn energy(&self) -> f64 {
        0.5 * self.momentum.dot(&self.velocity) - self.point.log_density
    }
}

/// Energy error above which a trajectory is divergent.
const MOST_ENERGY_ERROR: f64 = 1000.0;

/// Result of a transition.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Transition {
    /// New point of the chain.
    pub(crate) point: Point,
    /// Mean acceptance over the trajectory's states, used to tune the step size.
    pub(crate) acceptance: f64,
    /// `true` if the trajectory diverged: the step is too long somewhere.
    pub(crate) diverged: bool,
}

/// Stretch of a trajectory: both ends, the sum of momenta, the total weight, and a draw by weight.
#[derive(Clone, Copy)]
struct Stretch {
    first: State,
    last: State,
    momenta: Vector3<f64>,
    log_weight: f64,
    draw: Point,
}

/// Sampler of one transition.
pub(crate) struct Trajectory<'a, D, G> {
    pub(crate) density: &'a D,
    pub(crate) metric: &'a Metric,
    pub(crate) step_size: f64,
    pub(crate) deepest: u32,
    pub(crate) generator: &'a mut G,
}

#[derive(Default)]
struct Tally {
    acceptance: f64,
    states: u32,
    diverged: bool,
}

impl<D: LogDensity, G: Rng> Trajectory<'_, D, G> {
    /// Makes one transition from a point.
    pub(crate) fn transition(&mut self, from: Point) -> Transition {
        let momentum = self.metric.draw(self.generator);
        let start = State { point: from, momentum, velocity: self.metric.velocity(&momentum) };
        let energy = start.energy();
        let mut tally = Tally::default();
        // `whole.first` is its earliest state in time, `whole.last` its latest.
        let mut whole = Stretch { first: start, last: start, momenta: momentum, log_weight: 0.0, draw: from };
        for depth in 0..self.deepest {
            let forward = self.generator.random::<bool>();
            let (near, far, direction) =
                if forward { (whole.first, whole.last, 1.0) } else { (whole.last, whole.first, -1.0) };
            let Some(new) = self.extend(far, depth, direction, energy, &mut tally) else {
                break;
            };
            // Biased toward the new half: it is accepted by the ratio of weights.
            if self.accepts(new.log_weight - whole.log_weight) {
                whole.draw = new.draw;
            }
            let old = Stretch { first: near, last: far, ..whole };
            let turned = turns(&old, &new);
            let (first, last) = if forward { (near, new.last) } else { (new.last, near) };
            whole = Stretch {
                first,
                last,
                momenta: old.momenta + new.momenta,
                log_weight: add_logs(old.log_weight, new.log_weight),
                draw: whole.draw,
            };
            if turned {
                break;
            }
        }
        let acceptance = tally.acceptance / f64::from(tally.states.max(1));
        Transition { point: whole.draw, acceptance, diverged: tally.diverged }
    }

    /// Extends the trajectory by 2^depth states from an end; `first` of the result is nearest to that end.
    /// `None` if the stretch makes a U-turn within itself or diverges.
    fn extend(
        &mut self,
        from: State,
        depth: u32,
        direction: f64,
        energy: f64,
        tally: &mut Tally,
    ) -> Option<Stretch> {
        let Some(half) = depth.checked_sub(1) else {
            let state = leapfrog(self.density, self.metric, &from, direction * self.step_size);
            // A density that is not finite counts as infinitely unlikely.
            let error = energy - state.energy();
            let log_weight = if error.is_nan() { f64::NEG_INFINITY } else { error };
            tally.states += 1;
            tally.acceptance += log_weight.min(0.0).exp();
            if log_weight < -MOST_ENERGY_ERROR {
                tally.diverged = true;
                return None;
            }
            let (momenta, draw) = (state.momentum, state.point);
            return Some(Stretch { first: state, last: state, momenta, log_weight, draw });
        };
        let one = self.extend(from, half, direction, energy, tally)?;
        let other = self.extend(one.last, half, direction, energy, tally)?;
        if turns(&one, &other) {
            return None;
        }
        let log_weight = add_logs(one.log_weight, other.log_weight);
        let draw = if self.accepts(other.log_weight - log_weight) { other.draw } else { one.draw };
        Some(Stretch {
            first: one.first,
            last: other.last,
            momenta: one.momenta + other.momenta,
            log_weight,
            draw,
        })
    }

    fn accepts(&mut self, log_probability: f64) -> bool {
        log_probability >= 0.0 || self.generator.random::<f64>() < log_probability.exp()
    }
}

/// Makes one leapfrog step.
fn leapfrog<D: LogDensity>(density: &D, metric: &Metric, from: &State, step: f64) -> State {
    let halfway = from.momentum + from.point.gradient * (0.5 * step);
    let point = density.at(from.point.position + metric.velocity(&halfway) * step);
    let momentum = halfway + point.gradient * (0.5 * step);
    State { point, momentum, velocity: metric.velocity(&momentum) }
}

/// Returns `true` if two neighboring stretches together, or either one with the nearest state of the other,
/// make a U-turn: at one end the velocity no longer points along the sum of momenta.
fn turns(one: &Stretch, other: &Stretch) -> bool {
    let back = |sum: Vector3<f64>, first: &State, last: &State| {
        sum.dot(&first.velocity) <= 0.0 || sum.dot(&last.velocity) <= 0.0
    };
    back(one.momenta + other.momenta, &one.first, &other.last)
        || back(one.momenta + other.first.momentum, &one.first, &other.first)
        || back(one.last.momentum + other.momenta, &one.last, &other.last)
}

fn add_logs(one: f64, other: f64) -> f64 {
    let (large, small) = if one > other { (one, other) } else { (other, one) };
    if large == f64::NEG_INFINITY { large } else { large + (small - large).exp().ln_1p() }
}

/// Returns a step size near which one step's acceptance crosses 0.8, found by doubling or halving.
///
/// Reference: Hoffman, Gelman (2014), algorithm 4, with Stan's 0.8 in place of 0.5.
pub(crate) fn reasonable_step_size<D: LogDensity>(
    density: &D,
    metric: &Metric,
    from: Point,
    guess: f64,
    generator: &mut impl Rng,
) -> f64 {
    let momentum = metric.draw(generator);
    let start = State { point: from, momentum, velocity: metric.velocity(&momentum) };
    let passes = |step: f64| start.energy() - leapfrog(density, metric, &start, step).energy() > 0.8_f64.ln();
    let up = passes(guess);
    let mut step = guess;
    // Twenty decades either way are more than any posterior needs.
    for _ in 0..66 {
        let next = if up { 2.0 * step } else { 0.5 * step };
        if passes(next) != up {
            return if up { step } else { next };
        }
        step = next;
    }
    step
}

#[cfg(test)]
mod tests {
    use super::{LogDensity, Metric, Point, State, Trajectory, leapfrog};
    use nalgebra::{Matrix3, Vector3};
    use seed::Seed;

    /// Correlated normal density.
    struct Normal(Matrix3<f64>);

    impl LogDensity for Normal {
        fn at(&self, position: Vector3<f64>) -> Point {
            let gradient = -(self.0 * position);
            Point { position, log_density: 0.5 * position.dot(&gradient), gradient }
        }
    }

    #[test]
    fn a_known_normal_comes_out() {
        let covariance = Matrix3::new(1.0, 0.8, 0.0, 0.8, 2.0, 0.3, 0.0, 0.3, 0.5);
        let density = Normal(covariance.try_inverse().unwrap());
        let metric = Metric::new(Matrix3::identity()).unwrap();
        let mut generator = Seed::new(0).generator();
        let mut point = density.at(Vector3::new(1.0, 1.0, 1.0));
        let (mut sum, mut squares) = (Vector3::zeros(), Matrix3::zeros());
        let draws = 100_000;
        for _ in 0..draws {
            let mut trajectory = Trajectory {
                density: &density,
                metric: &metric,
                step_size: 0.4,
                deepest: 10,
                generator: &mut generator,
            };
            point = trajectory.transition(point).point;
            sum += point.position;
            squares += point.position * point.position.transpose();
        }
        let (mean, second) = (sum / f64::from(draws), squares / f64::from(draws));
        assert!(mean.norm() < 0.03, "{mean}");
        assert!((second - covariance).norm() < 0.06, "{second}");
    }

    #[test]
    fn a_step_back_undoes_a_step() {
        let density = Normal(Matrix3::new(2.0, 0.1, 0.0, 0.1, 1.0, 0.0, 0.0, 0.0, 3.0));
        let metric = Metric::new(Matrix3::identity() * 0.7).unwrap();
        let momentum = Vector3::new(0.3, -1.0, 0.2);
        let start = State {
            point: density.at(Vector3::new(1.0, 2.0, -0.5)),
            momentum,
            velocity: metric.velocity(&momentum),
        };
        let there = leapfrog(&density, &metric, &start, 0.3);
        let back = leapfrog(&density, &metric, &there, -0.3);
        assert!((back.point.position - start.point.position).norm() < 1e-14);
        assert!((back.momentum - start.momentum).norm() < 1e-14);
    }
}
