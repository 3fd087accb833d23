//! Method 9: the Levenberg–Marquardt method, as in MINPACK and `curve_fit`.

use super::line::{Line, NEUTRAL, TOLERANCE};
use super::local::Local;
use super::problem::{LeastSquaresProblem, LeastSquaresSolution, Limits};
use super::qr::factorize;
use super::vectors::{combine, diagonal, dot, finite, length, minus, over, times};
use super::{ClassicalFit, ClassicalRoute, Reached};
use crate::error::OracleError;
use envelope::Envelope;
use seed::Seed;

/// Levenberg–Marquardt on the line.
pub const ROUTE: ClassicalRoute = ClassicalRoute {
    id: "levenberg-marquardt",
    paper_number: 9,
    title: "Levenberg–Marquardt (curve_fit)",
    summary: "Damped Gauss–Newton steps whose damping keeps them within a trusted radius.",
    citations: &[
        "Levenberg, Quart. Appl. Math. 2 (1944) 164",
        "Marquardt, J. SIAM 11 (1963) 431",
        "Moré, Lecture Notes in Mathematics 630 (1978) 105",
        "Bates, Watts, Technometrics 23 (1981) 179: the stopping rule",
    ],
    draws: false,
    fit,
};

/// First trust radius, in lengths of the scaled start.
const FIRST_RADIUS: f64 = 10.0;

/// Smallest accepted gain of a step, as a share of the predicted gain.
const LEAST_GAIN: f64 = 1e-4;

/// Largest relative difference between the length of a damped step and the radius.
const RADIUS_MISFIT: f64 = 0.1;

fn fit(envelope: &Envelope, _: &Seed) -> Result<ClassicalFit, OracleError> {
    let line = Line::new(envelope);
    Ok(line.fit_with_error(minimize(&line, &NEUTRAL, Limits { tolerance: TOLERANCE, max_steps: 200 })?))
}

/// Minimizes a sum of squares from a start.
///
/// The algorithm is Moré's: the step minimizes ‖r + J·p‖ within ‖D·p‖ ≤ Δ. D holds the largest lengths so far
/// of the Jacobian's columns, and Δ follows the gains. Converged means that the residuals' projection on the
/// tangent space is at most the tolerance times their length, up to rounding errors, with a Jacobian of full
/// rank. The size of a step or a gain is no criterion, since both are also small in a valley or on a plateau.
/// Where gains are below rounding, steps are accepted by the projection.
///
/// # Errors
/// [`OracleError::NotFinite`] if a residual is not finite at the start, [`OracleError::TooFewRows`] for fewer
/// residuals than parameters.
pub fn minimize(
    problem: &impl LeastSquaresProblem,
    start: &[f64],
    limits: Limits,
) -> Result<LeastSquaresSolution, OracleError> {
    let mut x = start.to_vec();
    let mut here = Local::start(problem, &x, &limits)?;
    let mut scales = here.lengths.clone();
    let mut radius = match FIRST_RADIUS * length(&times(&scales, &x)) {
        0.0 => FIRST_RADIUS,
        radius => radius,
    };
    let mut damping = 0.0;
    let mut steps = 0;
    let reached = loop {
        if here.is_stationary(here.orthogonality, &limits) {
            break Reached::Converged;
        }
        if steps >= limits.max_steps {
            break Reached::BudgetSpent;
        }
        steps += 1;
        let step = Step::within(&here, &scales, radius, damping);
        damping = step.damping;
        if steps == 1 {
            radius = radius.min(step.size);
        }
        if step.gain <= here.flat(problem) {
            match by_projection(problem, &here, &scales, &x, &limits) {
                Some((next, there)) => (x, here) = (next, there),
                None => break Reached::Stalled,
            }
            continue;
        }
        let next = minus(&x, &step.back);
        let there = length(&problem.residuals(&next));
        let actual = if there < 10.0 * here.size { 1.0 - (there / here.size).powi(2) } else { -1.0 };
        let ratio = actual / step.gain;
        if ratio <= 0.25 {
            let shrink = if actual >= 0.0 { 0.5 } else { 0.5 * step.slope / (step.slope + 0.5 * actual) };
            let shrink = if there < 10.0 * here.size { shrink.max(0.1) } else { 0.1 };
            radius = shrink * radius.min(10.0 * step.size);
            damping /= shrink;
        } else if damping == 0.0 || ratio >= 0.75 {
            radius = 2.0 * step.size;
            damping *= 0.5;
        }
        if ratio >= LEAST_GAIN {
            match Local::evaluate(problem, &next, &limits) {
                Some(there) => {
                    (x, here) = (next, there);
                    for (scale, length) in scales.iter_mut().zip(&here.lengths) {
                        *scale = scale.max(*length);
                    }
                }
                // Residuals without a finite Jacobian are treated as too far away.
                None => radius *= 0.25,
            }
        }
        if radius <= f64::EPSILON * length(&times(&scales, &x)) {
            break Reached::Stalled;
        }
    };
    let orthogonality = here.orthogonality;
    Ok(here.report(x, steps, reached, orthogonality, &limits))
}

/// Returns a step that brings the residuals closer to orthogonality: the Gauss–Newton step, or a damped one.
fn by_projection(
    problem: &impl LeastSquaresProblem,
    here: &Local,
    scales: &[f64],
    x: &[f64],
    limits: &Limits,
) -> Option<(Vec<f64>, Local)> {
    let weights = over(scales, &here.lengths);
    [0.0, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0, 100.0].into_iter().find_map(|damping| {
        let back = over(&damped(here, &weights, damping)?.0, &here.lengths);
        let next = minus(x, &back);
        let there = Local::evaluate(problem, &next, limits)?;
        (there.orthogonality < here.orthogonality).then_some((next, there))
    })
}

/// Step to be subtracted from the parameters.
struct Step {
    back: Vec<f64>,
    /// Scaled length ‖D·p‖.
    size: f64,
    damping: f64,
    /// Predicted relative gain in the sum of squares.
    gain: f64,
    /// Relative slope of the sum of squares along the step, negative.
    slope: f64,
}

impl Step {
    /// Returns the step of Moré's algorithm: the Gauss–Newton step if it is short enough, or else the one
    /// with the damping at which the step's length equals the radius to within a tenth, found by Newton's
    /// method on the length.
    fn within(here: &Local, scales: &[f64], radius: f64, damping: f64) -> Self {
        // In variables in which the Jacobian has unit columns, D is diag(weights).
        let weights = over(scales, &here.lengths);
        let mut low = 0.0;
        let mut newton = None;
        if let Some((z, r)) = damped(here, &weights, 0.0) {
            let size = length(&times(&weights, &z));
            if size <= (1.0 + RADIUS_MISFIT) * radius {
                return Self::of(here, &weights, z, 0.0);
            }
            low = (size - radius) / radius / decrease(&weights, &z, size, &r);
            newton = Some((z, 0.0));
        }
        let gradient = over(&products(here), &weights);
        let mut high = length(&gradient) / radius;
        let mut damping = damping.max(low).min(high);
        if damping == 0.0 {
            damping = (1e-3 * high).max((low * high).sqrt());
        }
        for _ in 0..20 {
            let Some((z, r)) = damped(here, &weights, damping) else {
                low = damping;
                damping = (10.0 * damping).max(f64::MIN_POSITIVE);
                continue;
            };
            let size = length(&times(&weights, &z));
            let misfit = size - radius;
            let change = misfit / radius / decrease(&weights, &z, size, &r);
            newton = Some((z, damping));
            if misfit.abs() <= RADIUS_MISFIT * radius || !change.is_finite() {
                break;
            }
            if misfit > 0.0 {
                low = f64::max(low, damping);
            } else {
                high = high.min(damping);
            }
            damping = (damping + change).max(low).min(high.max(low));
        }
        let (z, damping) = newton.unwrap_or_else(|| (vec![0.0; scales.len()], damping));
        Self::of(here, &weights, z, damping)
    }

    fn of(here: &Local, weights: &[f64], z: Vec<f64>, damping: f64) -> Self {
        let model = length(&combine(&here.factor.triangle.square(), &z)) / here.size;
        let size = length(&times(weights, &z));
        let penalty = damping * (size / here.size).powi(2);
        Self {
            back: over(&z, &here.lengths),
            size,
            damping,
            gain: model * model + 2.0 * penalty,
            slope: -(model * model + penalty),
        }
    }
}

/// Returns Rᵀ·(Qᵀr).
fn products(here: &Local) -> Vec<f64> {
    here.factor.triangle.0.iter().map(|column| dot(column, &here.factor.projected)).collect()
}

/// Minimizes ‖R·z − Qᵀr‖² + damping·‖diag(weights)·z‖². Returns the solution and the triangle of the stacked
/// matrix; `None` if it is singular.
fn damped(here: &Local, weights: &[f64], damping: f64) -> Option<(Vec<f64>, super::linear::Triangle)> {
    let scaled: Vec<f64> = weights.iter().map(|weight| damping.sqrt() * weight).collect();
    let columns = here
        .factor
        .triangle
        .square()
        .into_iter()
        .zip(diagonal(&scaled))
        .map(|(upper, lower)| upper.into_iter().chain(lower).collect())
        .collect();
    let right = here.factor.projected.iter().copied().chain(weights.iter().map(|_| 0.0)).collect();
    let factor = factorize(columns, right);
    if factor.triangle.is_singular() {
        return None;
    }
    let solution = factor.triangle.solve(&factor.projected);
    finite(&solution).then_some((solution, factor.triangle))
}

/// Returns minus the relative derivative of a step's length by the damping: ‖R⁻ᵀ·(D²z/‖Dz‖)‖².
fn decrease(weights: &[f64], z: &[f64], size: f64, triangle: &super::linear::Triangle) -> f64 {
    let direction: Vec<f64> = weights.iter().zip(z).map(|(w, z)| w * (w * z / size)).collect();
    let back = triangle.solve_transposed(&direction);
    dot(&back, &back)
}

#[cfg(test)]
mod tests {
    use super::{Step, damped, decrease, minimize};
    use crate::classical::local::Local;
    use crate::classical::problem::Limits;
    use crate::classical::vectors::{combine, dot, length, minus, times};
    use crate::classical::{LeastSquaresProblem, Reached};
    use crate::error::OracleError;
    use rand::RngExt;
    use seed::Seed;

    const LIMITS: Limits = Limits { tolerance: 1e-10, max_steps: 500 };

    /// Model y = b₁ + b₂ at every point, so that only the sum is determined.
    struct Undetermined;

    impl LeastSquaresProblem for Undetermined {
        fn residuals(&self, b: &[f64]) -> Vec<f64> {
            [1.0, 2.0, 4.0].map(|y| b[0] + b[1] - y).to_vec()
        }

        fn jacobian(&self, _: &[f64]) -> Vec<Vec<f64>> {
            vec![vec![1.0; 3]; 2]
        }

        fn data_length(&self) -> f64 {
            21_f64.sqrt()
        }
    }

    #[test]
    fn what_is_not_determined_is_never_called_converged() {
        let found = minimize(&Undetermined, &[0.0, 0.0], LIMITS).unwrap();
        assert_ne!(found.reached, Reached::Converged, "{found:?}");
        assert_eq!(found.std_errors, None);
        assert!((found.sum_of_squares - 14.0 / 3.0).abs() < 1e-9, "{found:?}");
        assert!(found.because.contains("wanted"), "{}", found.because);
    }

    /// Residuals √x − 1 at three points, NaN for negative x.
    struct Root;

    impl LeastSquaresProblem for Root {
        fn residuals(&self, b: &[f64]) -> Vec<f64> {
            [1.0, 2.0, 3.0].map(|x| x * (b[0].sqrt() - 1.0)).to_vec()
        }

        fn jacobian(&self, b: &[f64]) -> Vec<Vec<f64>> {
            vec![[1.0, 2.0, 3.0].map(|x| 0.5 * x / b[0].sqrt()).to_vec()]
        }

        fn data_length(&self) -> f64 {
            14_f64.sqrt()
        }
    }

    #[test]
    fn a_step_out_of_the_domain_is_shortened() {
        let found = minimize(&Root, &[9.0], LIMITS).unwrap();
        assert_eq!(found.reached, Reached::Converged, "{found:?}");
        assert!((found.parameters[0] - 1.0).abs() < 1e-12, "{found:?}");
        assert_eq!(minimize(&Root, &[-1.0], LIMITS), Err(OracleError::NotFinite { row: 1 }));
    }

    /// Linear problem with residuals b − A·p at p and curvatures up to 10⁶ apart.
    struct Linear {
        columns: Vec<Vec<f64>>,
        right: Vec<f64>,
    }

    impl LeastSquaresProblem for Linear {
        fn residuals(&self, p: &[f64]) -> Vec<f64> {
            minus(&combine(&self.columns, p), &self.right)
        }

        fn jacobian(&self, _: &[f64]) -> Vec<Vec<f64>> {
            self.columns.clone()
        }

        fn data_length(&self) -> f64 {
            length(&self.right)
        }
    }

    fn linear_problems() -> impl Iterator<Item = Linear> {
        let mut generator = Seed::new(15).generator();
        (0..100).map(move |number| {
            let mut vector =
                |scale: f64| (0..7).map(|_| scale * generator.random_range(-1.0..1.0)).collect::<Vec<f64>>();
            let columns = (0..2 + number % 3).map(|at| vector(10_f64.powi(at - 1))).collect();
            Linear { columns, right: vector(3.0) }
        })
    }

    /// A step solves (JᵀJ + μD²)·p = Jᵀr with ‖D·p‖ at the radius to within a tenth, or inside it undamped;
    /// the gain is the model's.
    #[test]
    fn a_step_is_the_best_within_its_radius() {
        for problem in linear_problems() {
            let size = problem.columns.len();
            let here = Local::start(&problem, &vec![0.0; size], &LIMITS).unwrap();
            let scales: Vec<f64> =
                here.lengths.iter().zip([1.0, 2.0, 1.0, 5.0]).map(|(a, b)| a * b).collect();
            let free = Step::within(&here, &scales, f64::MAX, 0.0);
            assert_eq!(free.damping, 0.0);
            for share in [1e-4, 0.03, 0.5, 0.9, 1.2] {
                for damping in [0.0, 1e-3, 10.0] {
                    let radius = share * free.size;
                    let step = Step::within(&here, &scales, radius, damping);
                    let misfit = (step.size / radius - 1.0).abs();
                    assert!(
                        if share > 1.0 { step.damping == 0.0 } else { misfit <= 0.1 },
                        "{share} {misfit}"
                    );
                    assert!((length(&times(&scales, &step.back)) / step.size - 1.0).abs() < 1e-9);
                    let (residuals, image) =
                        (problem.residuals(&vec![0.0; size]), combine(&problem.columns, &step.back));
                    let left = minus(&residuals, &image);
                    for ((column, scale), p) in problem.columns.iter().zip(&scales).zip(&step.back) {
                        let gap = dot(column, &left) - step.damping * scale * scale * p;
                        assert!(gap.abs() <= 1e-9 * length(column) * here.size, "{gap:e}");
                    }
                    let gain = 1.0 - (length(&left) / here.size).powi(2);
                    assert!((step.gain / gain - 1.0).abs() < 1e-6, "{} {gain}", step.gain);
                    // Half the derivative of ‖r − t·J·p‖² by t at 0, over ‖r‖².
                    let slope = -dot(&residuals, &image) / here.size.powi(2);
                    assert!((step.slope / slope - 1.0).abs() < 1e-6, "{} {slope}", step.slope);
                }
            }
        }
    }

    /// Compares −d ln‖D·p‖/dμ with differences.
    #[test]
    fn a_step_shortens_with_its_damping_as_said() {
        for problem in linear_problems() {
            let here = Local::start(&problem, &vec![0.0; problem.columns.len()], &LIMITS).unwrap();
            let weights: Vec<f64> = [1.0, 2.0, 1.0, 5.0].into_iter().take(problem.columns.len()).collect();
            let size = |damping: f64| length(&times(&weights, &damped(&here, &weights, damping).unwrap().0));
            for damping in [0.01, 1.0] {
                let (z, triangle) = damped(&here, &weights, damping).unwrap();
                let h = 1e-5 * damping;
                let difference = (size(damping - h) - size(damping + h)) / (2.0 * h) / size(damping);
                let stated = decrease(&weights, &z, size(damping), &triangle);
                assert!((stated / difference - 1.0).abs() < 1e-6, "{stated} {difference}");
            }
        }
    }

    /// A linear problem is solved by the first step that is not limited in length.
    #[test]
    fn a_linear_problem_takes_a_step_or_two() {
        for problem in linear_problems() {
            let start = vec![1.0; problem.columns.len()];
            let found = minimize(&problem, &start, Limits { tolerance: 1e-12, max_steps: 50 }).unwrap();
            assert_eq!(found.reached, Reached::Converged, "{found:?}");
            assert!(found.steps <= 12, "{found:?}");
            let left = problem.residuals(&found.parameters);
            for column in &problem.columns {
                assert!(dot(column, &left).abs() <= 1e-9 * length(column) * length(&left));
            }
        }
    }
}
