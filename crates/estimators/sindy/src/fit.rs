//! Path of laws, and the estimate.

use crate::config::SindyConfig;
use envelope::Envelope;
use estimator::{Estimate, Estimator, FitContext, FitError};
use nalgebra::{DMatrix, DVector};
use sparse::{Column, Halt, Law, Path, Progress, Regression, Scaled, running_integral, solve};

/// Most passes; a law that has not settled by then is dropped.
const MOST_PASSES: usize = 200;

impl Estimator for SindyConfig {
    fn fit(&self, envelope: &Envelope, context: &FitContext<'_>) -> Result<Estimate, FitError> {
        let scaled = Scaled::of(envelope)?;
        let mut progress = Progress::new(context, self.max_steps, &scaled);
        let path = self.path(&scaled, &mut progress);
        let instruments = |law: &Law| {
            let columns: Vec<Column> = law.terms.iter().map(|(column, _)| *column).collect();
            regressors(&columns, Some(law), &scaled)
        };
        // The residuals are orthogonal to 1 and t, so that the slope of a line through the trajectory is that through the
        // peaks.
        let regression =
            Regression { method: "", instruments: &instruments, information: scaled.squared_times() };
        Ok(regression.estimate(&scaled, &path, self.evidence, progress.steps(), context.query_times()))
    }
}

impl SindyConfig {
    /// Raises the threshold until only the constant is left.
    fn path(&self, scaled: &Scaled, progress: &mut Progress<'_>) -> Path {
        let mut columns: Vec<Column> = self.terms().filter_map(|term| Column::over(term, scaled)).collect();
        // The initial value and the constant are unknowns too, and the scatter needs a degree of freedom.
        columns.truncate(scaled.peaks().saturating_sub(3));
        Path::over(columns, scaled, |columns, latest| self.settle(columns, scaled, progress, latest))
    }

    /// Regresses along the trajectory until the trajectory reproduces itself; `latest` is updated. Returns
    /// `true` if it does.
    fn settle(
        &self,
        columns: &[Column],
        scaled: &Scaled,
        progress: &mut Progress<'_>,
        latest: &mut Law,
    ) -> Result<bool, Halt> {
        let phase = format!("{} terms", columns.len() + 1);
        let mut relaxation = 1.0;
        let mut last_change = f64::INFINITY;
        let mut along: Option<Law> = None;
        for _ in 0..MOST_PASSES {
            progress.advance()?;
            let Some(mut law) = regress(columns, along.as_ref(), scaled) else {
                // Terms are dropped by the coefficients of the last finite law, if there was one.
                *latest = along.unwrap_or_else(|| Law::null(scaled));
                return Ok(false);
            };
            let before = along.as_ref().map_or(&scaled.logs, |along| &along.trajectory);
            let change = law.distance(before);
            if change > last_change && along.is_some() {
                relaxation = f64::max(relaxation / 2.0, 1.0 / 16.0);
            }
            if let Some(along) = along.as_ref().filter(|_| relaxation < 1.0) {
                law = law.toward(along, 1.0 - relaxation, scaled);
            }
            progress.tell(&law, &phase, scaled);
            *latest = law.clone();
            // A law of the constant alone has no terms to evaluate again.
            if columns.is_empty() || (along.is_some() && change <= self.settle_tolerance * scaled.spread) {
                return Ok(true);
            }
            last_change = change;
            along = Some(law);
        }
        Ok(false)
    }
}

/// Returns the regressors 1, s and the integrals of the terms, evaluated along a law's trajectory or at the
/// measured peaks: peaks by parameters.
fn regressors(columns: &[Column], along: Option<&Law>, scaled: &Scaled) -> DMatrix<f64> {
    let points = along.map_or(&scaled.logs, |along| &along.trajectory);
    // Measured peaks have no reliable derivative.
    let slopes: Option<Vec<f64>> = along.map(|along| {
        along.trajectory.iter().zip(&scaled.times).map(|(&x, &time)| along.rate(x, time)).collect()
    });
    let integral = |column: &Column| {
        let at = || points.iter().zip(&scaled.times);
        let values: Vec<f64> = at().map(|(&x, &time)| column.value(x, time)).collect();
        let derivatives = slopes.as_ref().map_or_else(
            || vec![0.0; points.len()],
            |slopes| points.iter().zip(slopes).map(|(&x, &slope)| column.derivative(x, slope)).collect(),
        );
        running_integral(&scaled.times, &values, &derivatives)
    };
    let ones = std::iter::repeat_n(1.0, scaled.peaks());
    let entries = ones.chain(scaled.times.iter().copied()).chain(columns.iter().flat_map(integral));
    DMatrix::from_iterator(scaled.peaks(), 2 + columns.len(), entries)
}

/// Regresses x once on the regressors along a law's trajectory, or at the measured peaks. `None` if a number
/// overflows.
fn regress(columns: &[Column], along: Option<&Law>, scaled: &Scaled) -> Option<Law> {
    let matrix = regressors(columns, along, scaled);
    let solution = solve(matrix.clone(), DVector::from_column_slice(&scaled.logs))?;
    let trajectory: Vec<f64> = (matrix * &solution).iter().copied().collect();
    let constant = solution.get(1).copied()?;
    let terms = columns.iter().copied().zip(solution.iter().copied().skip(2)).collect();
    let law = Law::new(constant, terms, trajectory, scaled);
    law.squares.is_finite().then_some(law)
}
