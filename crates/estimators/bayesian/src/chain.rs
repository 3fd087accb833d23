//! Markov chain: warm-up, then draws.
//!
//! Reference: Hoffman, Gelman, J. Mach. Learn. Res. 15 (2014) 1593, algorithm 6, for the step size; the
//! Stan Reference Manual, section "HMC algorithm parameters", for the windows of the warm-up.

use crate::nuts::{LogDensity, Metric, Point, Trajectory, reasonable_step_size};
use nalgebra::{Matrix3, Vector3};
use rand::Rng;

/// Settings that all chains share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Tuning {
    /// Number of warm-up transitions, which tune step size and metric and are discarded.
    pub(crate) warm_up: u64,
    /// Acceptance probability that the step size is tuned for.
    pub(crate) target_acceptance: f64,
    /// Most doublings of a trajectory.
    pub(crate) deepest: u32,
}

/// Chain in progress.
pub(crate) struct Chain<'a, D, G> {
    density: &'a D,
    generator: G,
    tuning: Tuning,
    metric: Metric,
    step_size: DualAveraging,
    window: Moments,
    taken: u64,
    point: Point,
    /// Draws after the warm-up.
    pub(crate) draws: Vec<Point>,
    /// Number of divergent transitions after the warm-up.
    pub(crate) divergences: u64,
}

impl<'a, D: LogDensity, G: Rng> Chain<'a, D, G> {
    /// Creates a chain at its start.
    pub(crate) fn new(density: &'a D, start: Vector3<f64>, tuning: Tuning, mut generator: G) -> Self {
        let point = density.at(start);
        let metric = Metric::identity();
        let step = reasonable_step_size(density, &metric, point, 1.0, &mut generator);
        Self {
            density,
            generator,
            tuning,
            metric,
            step_size: DualAveraging::new(step, tuning.target_acceptance),
            window: Moments::default(),
            taken: 0,
            point,
            draws: Vec::new(),
            divergences: 0,
        }
    }

    /// Returns the current point of the chain.
    pub(crate) fn point(&self) -> &Point {
        &self.point
    }

    /// Takes one transition: of the warm-up while that lasts, otherwise a draw.
    pub(crate) fn step(&mut self) {
        let warming = self.taken < self.tuning.warm_up;
        let step_size = if warming { self.step_size.current() } else { self.step_size.settled() };
        let transition = Trajectory {
            density: self.density,
            metric: &self.metric,
            step_size,
            deepest: self.tuning.deepest,
            generator: &mut self.generator,
        }
        .transition(self.point);
        self.point = transition.point;
        self.taken += 1;
        if warming {
            self.step_size.learn(transition.acceptance);
            self.learn_metric();
        } else {
            self.draws.push(transition.point);
            self.divergences += u64::from(transition.diverged);
        }
    }

    fn learn_metric(&mut self) {
        match phase(self.taken - 1, self.tuning.warm_up) {
            Phase::StepSizeOnly => {}
            Phase::Collecting => self.window.add(&self.point.position),
            Phase::EndOfWindow => {
                self.window.add(&self.point.position);
                // A window in which the chain did not move gives no metric: the old one stays.
                if let Some(metric) = self.window.metric() {
                    self.metric = metric;
                }
                self.window = Moments::default();
                let step = reasonable_step_size(
                    self.density,
                    &self.metric,
                    self.point,
                    self.step_size.current(),
                    &mut self.generator,
                );
                self.step_size = DualAveraging::new(step, self.tuning.target_acceptance);
            }
        }
    }
}

/// Purpose of a warm-up transition.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    StepSizeOnly,
    Collecting,
    EndOfWindow,
}

/// Returns the purpose of a warm-up transition. A warm-up of 500 has 75 transitions to reach the posterior,
/// windows of 25, 50, 100 and 200 for the metric, and 50 transitions for the final step size. Other lengths
/// are divided in the same proportions.
fn phase(at: u64, warm_up: u64) -> Phase {
    const ENDS: [u64; 4] = [100, 150, 250, 450];
    let scaled = |mark: u64| mark * warm_up / 500;
    if at < scaled(75) || at >= scaled(450) {
        Phase::StepSizeOnly
    } else if ENDS.iter().any(|&end| at + 1 == scaled(end)) {
        Phase::EndOfWindow
    } else {
        Phase::Collecting
    }
}

/// Step size by dual averaging: Hoffman, Gelman (2014), equation 6, with their γ, t₀ and κ.
#[derive(Debug, Clone, Copy)]
struct DualAveraging {
    target: f64,
    center: f64,
    log_step: f64,
    log_settled: f64,
    error: f64,
    count: f64,
}

impl DualAveraging {
    const SHRINKAGE: f64 = 0.05;
    const OFFSET: f64 = 10.0;
    const FORGETTING: f64 = 0.75;

    fn new(step: f64, target: f64) -> Self {
        Self {
            target,
            center: (10.0 * step).ln(),
            log_step: step.ln(),
            log_settled: step.ln(),
            error: 0.0,
            count: 0.0,
        }
    }

    fn learn(&mut self, acceptance: f64) {
        self.count += 1.0;
        let share = 1.0 / (self.count + Self::OFFSET);
        self.error += share * (self.target - acceptance - self.error);
        self.log_step = self.center - self.count.sqrt() / Self::SHRINKAGE * self.error;
        let weight = self.count.powf(-Self::FORGETTING);
        self.log_settled += weight * (self.log_step - self.log_settled);
    }

    fn current(&self) -> f64 {
        self.log_step.exp()
    }

    fn settled(&self) -> f64 {
        self.log_settled.exp()
    }
}

/// Running mean and covariance (Welford).
#[derive(Debug, Clone, Copy, Default)]
struct Moments {
    count: f64,
    mean: Vector3<f64>,
    products: Matrix3<f64>,
}

impl Moments {
    fn add(&mut self, position: &Vector3<f64>) {
        self.count += 1.0;
        let before = position - self.mean;
        self.mean += before / self.count;
        self.products += before * (position - self.mean).transpose();
    }

    /// Returns the covariance with its correlations shrunk by 5/(n + 5). Stan shrinks toward a fixed
    /// diagonal, which would dominate a narrow posterior; here it is the covariance's own diagonal.
    fn metric(&self) -> Option<Metric> {
        if self.count < 2.0 {
            return None;
        }
        let covariance = self.products / (self.count - 1.0);
        let keep = self.count / (self.count + 5.0);
        let diagonal = Matrix3::from_diagonal(&covariance.diagonal());
        Metric::new(covariance * keep + diagonal * (1.0 - keep))
    }
}

#[cfg(test)]
mod tests {
    use super::{Chain, Moments, Phase, Tuning, phase};
    use crate::nuts::{LogDensity, Point};
    use nalgebra::Vector3;
    use seed::Seed;

    #[test]
    fn the_windows_are_those_documented() {
        let ends: Vec<u64> = (0..500).filter(|&at| phase(at, 500) == Phase::EndOfWindow).collect();
        assert_eq!(ends, [99, 149, 249, 449]);
        assert_eq!((0..500).filter(|&at| phase(at, 500) == Phase::StepSizeOnly).count(), 125);
    }

    #[test]
    fn moments_are_those_of_the_textbook() {
        let mut moments = Moments::default();
        let points = [[1.0, 0.0, 2.0], [3.0, 1.0, 2.5], [2.0, 5.0, -1.0]].map(Vector3::from);
        points.iter().for_each(|point| moments.add(point));
        assert!((moments.mean - Vector3::new(2.0, 2.0, 3.5 / 3.0)).norm() < 1e-15);
        assert!((moments.products[(0, 1)] - 1.0).abs() < 1e-14);
    }

    /// Normal density with three scales, three decades apart each.
    struct Scales;

    impl LogDensity for Scales {
        fn at(&self, position: Vector3<f64>) -> Point {
            let gradient = -position.component_mul(&Vector3::new(1e6, 1.0, 1e-6));
            Point { position, log_density: 0.5 * position.dot(&gradient), gradient }
        }
    }

    #[test]
    fn the_warm_up_finds_acceptance_and_scales() {
        let tuning = Tuning { warm_up: 500, target_acceptance: 0.8, deepest: 10 };
        let mut chain = Chain::new(&Scales, Vector3::new(0.1, 0.1, 0.1), tuning, Seed::new(1).generator());
        for _ in 0..1500 {
            chain.step();
        }
        assert_eq!((chain.draws.len(), chain.divergences), (1000, 0));
        for (axis, scale) in [1e-3, 1.0, 1e3].into_iter().enumerate() {
            let square = chain.draws.iter().map(|draw| draw.position[axis].powi(2)).sum::<f64>() / 1000.0;
            assert!((square.sqrt() / scale - 1.0).abs() < 0.15, "{axis}: {}", square.sqrt());
        }
    }
}
