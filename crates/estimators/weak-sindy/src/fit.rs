//! Path of laws, and the estimate.

use crate::config::{TermsAlong, WeakSindyConfig};
use crate::sloped::Sloped;
use crate::test_functions::TestFunctions;
use envelope::Envelope;
use estimator::{Estimate, Estimator, FitContext, FitError};
use nalgebra::DVector;
use sparse::{Column, Halt, Law, Path, Progress, Regression, Scaled, running_integral, solve};

/// Most passes; a law that has not settled by then is dropped.
const MOST_PASSES: usize = 200;

/// Most reweightings, after which the covariance stays as it is; then the relative change at which it has
/// settled.
const MOST_REWEIGHTINGS: usize = 30;
const REWEIGHTED: f64 = 1e-8;

impl Estimator for WeakSindyConfig {
    fn fit(&self, envelope: &Envelope, context: &FitContext<'_>) -> Result<Estimate, FitError> {
        let scaled = Scaled::of(envelope)?;
        let mut progress = Progress::new(context, self.max_steps, &scaled);
        let problem = Problem {
            scaled: &scaled,
            functions: TestFunctions::over(&scaled, self.test_functions, self.exponent),
            terms_along: self.terms_along,
            settle_tolerance: self.settle_tolerance,
        };
        let columns = self.terms().filter_map(|term| Column::over(term, &scaled)).collect();
        let path = problem.path(columns, &mut progress);
        let regression = Regression {
            method: &format!("Weak form against {} test functions.\n\n", problem.functions.len()),
            instruments: &|law| problem.functions.instruments(law, &scaled),
            information: problem.functions.information(&scaled),
        };
        Ok(regression.estimate(&scaled, &path, self.evidence, progress.steps(), context.query_times()))
    }
}

/// Regression problem shared by all laws of a path.
struct Problem<'a> {
    scaled: &'a Scaled,
    functions: TestFunctions,
    terms_along: TermsAlong,
    settle_tolerance: f64,
}

/// Constant, then the coefficients of the columns.
type Coefficients = DVector<f64>;

impl Problem<'_> {
    /// Raises the threshold until only the constant is left.
    fn path(&self, mut columns: Vec<Column>, progress: &mut Progress<'_>) -> Path {
        // The constant is an unknown too, and the scatter needs a degree of freedom, here and at the peaks.
        let most = self.functions.len().saturating_sub(1).min(self.scaled.peaks().saturating_sub(3));
        columns.truncate(most);
        let mut sloped = Sloped::null(self.scaled);
        Path::over(columns, self.scaled, |columns, latest| {
            let settled = self.settle(columns, progress, &mut sloped);
            latest.clone_from(&sloped.law);
            settled
        })
    }

    /// Reweights at the measured peaks, then regresses along the trajectory until it reproduces itself;
    /// `latest` is updated. Returns `true` if it does.
    fn settle(
        &self,
        columns: &[Column],
        progress: &mut Progress<'_>,
        latest: &mut Sloped,
    ) -> Result<bool, Halt> {
        let scaled = self.scaled;
        let phase = format!("{} terms", columns.len() + 1);
        let Some(coefficients) = self.reweighted(columns, progress, &phase, latest)? else {
            *latest = Sloped::null(scaled);
            return Ok(false);
        };
        *latest = self.law_along_peaks(&coefficients, columns);
        // The constant has no terms to evaluate along a trajectory.
        if columns.is_empty() {
            return Ok(true);
        }
        // A second integration gives slopes without the peaks' scatter.
        *latest = self.law_along(&coefficients, columns, latest);
        let (mut relaxation, mut last_change) = (1.0, f64::INFINITY);
        for _ in 0..MOST_PASSES {
            let coefficients = match self.terms_along {
                TermsAlong::Peaks => coefficients.clone(),
                TermsAlong::Trajectory => {
                    progress.advance()?;
                    let (target, matrix) = self.functions.along(latest, columns, scaled);
                    let whitening = &self.functions.whitening;
                    match solve(whitening.apply_all(&matrix), whitening.apply(&target)) {
                        Some(coefficients) => coefficients,
                        None => return Ok(false),
                    }
                }
            };
            let mut law = self.law_along(&coefficients, columns, latest);
            if !law.law.squares.is_finite() {
                return Ok(false);
            }
            let change = law.law.distance(&latest.law.trajectory);
            if change > last_change {
                relaxation = f64::max(relaxation / 2.0, 1.0 / 16.0);
            }
            if relaxation < 1.0 {
                law = law.toward(latest, 1.0 - relaxation, scaled);
            }
            *latest = law;
            if self.terms_along == TermsAlong::Trajectory {
                progress.tell(&latest.law, &phase, scaled);
            }
            if change <= self.settle_tolerance * scaled.spread {
                return Ok(true);
            }
            last_change = change;
        }
        Ok(false)
    }

    /// Fits by generalized least squares with the terms at the measured peaks. The covariance of the
    /// residuals comes from the law of the previous regression, until neither changes. `None` if a number
    /// overflows.
    fn reweighted(
        &self,
        columns: &[Column],
        progress: &mut Progress<'_>,
        phase: &str,
        latest: &mut Sloped,
    ) -> Result<Option<Coefficients>, Halt> {
        let matrix = self.functions.terms_at_peaks(columns, self.scaled);
        let target = self.functions.measured(&self.scaled.logs);
        let mut whitening = self.functions.whitening.clone();
        let mut before: Option<Coefficients> = None;
        for _ in 0..MOST_REWEIGHTINGS {
            progress.advance()?;
            let Some(found) = solve(whitening.apply_all(&matrix), whitening.apply(&target)) else {
                return Ok(before);
            };
            let law = self.law_along_peaks(&found, columns);
            progress.tell(&law.law, phase, self.scaled);
            latest.clone_from(&law);
            let settled = before.is_some_and(|before| (&found - before).amax() <= REWEIGHTED * found.amax());
            // The constant's scatter does not depend on the law.
            if settled || columns.is_empty() {
                return Ok(Some(found));
            }
            let Some(next) = self.functions.whitening_at_peaks(&law.law, self.scaled) else {
                return Ok(Some(found));
            };
            whitening = next;
            before = Some(found);
        }
        Ok(before)
    }

    /// Returns the law with its function by one integration along the measured peaks, which have no reliable
    /// derivative.
    fn law_along_peaks(&self, coefficients: &Coefficients, columns: &[Column]) -> Sloped {
        self.integrated(coefficients, columns, &self.scaled.logs, None)
    }

    /// Returns the law with its function by one integration along another law's trajectory.
    fn law_along(&self, coefficients: &Coefficients, columns: &[Column], along: &Sloped) -> Sloped {
        self.integrated(coefficients, columns, &along.law.trajectory, Some(&along.slopes))
    }

    /// Returns x(0) + ∫law ds with the law evaluated along a function. x(0) is chosen so that the residuals
    /// at the peaks have mean zero, since a weak form does not determine it.
    fn integrated(
        &self,
        coefficients: &Coefficients,
        columns: &[Column],
        along: &[f64],
        slopes: Option<&[f64]>,
    ) -> Sloped {
        let scaled = self.scaled;
        debug_assert_eq!(coefficients.len(), columns.len() + 1, "the constant, then one for each column");
        let terms: Vec<(Column, f64)> =
            columns.iter().copied().zip(coefficients.iter().skip(1).copied()).collect();
        let law = Law::new(coefficients[0], terms, Vec::new(), scaled);
        let rates: Vec<f64> =
            along.iter().zip(&scaled.times).map(|(&log, &time)| law.rate(log, time)).collect();
        let curvatures: Vec<f64> = slopes.map_or_else(
            || vec![0.0; scaled.peaks()],
            |slopes| along.iter().zip(slopes).map(|(&log, &slope)| law.derivative(log, slope)).collect(),
        );
        let rise = running_integral(&scaled.times, &rates, &curvatures);
        let start = scaled.residuals(&rise).iter().sum::<f64>() / scaled.peaks() as f64;
        let trajectory = rise.iter().map(|x| x + start).collect();
        Sloped::new(law.constant, law.terms, trajectory, rates, scaled)
    }
}
