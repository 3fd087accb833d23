//! How well a hypothesis predicts what it was not fitted to.

use crate::fit::{Effort, Fit, Moving, Point, fit};
use crate::segments::Data;
use dynamics::DynamicsError;
use nalgebra::DVector;

/// Residuals on parts not fitted.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct HeldOut {
    /// By segment, in the order of the data; only start states were fitted to them.
    pub(crate) residuals: Vec<DVector<f64>>,
    /// Start values fitted by segment.
    pub(crate) starts: usize,
}

impl HeldOut {
    /// Mean square over all segments, each weighed by its samples.
    pub(crate) fn mean_square(&self) -> f64 {
        let squares: f64 = self.residuals.iter().map(DVector::norm_squared).sum();
        let freedom: f64 = self.residuals.iter().map(|e| e.len() as f64 - self.starts as f64).sum();
        squares / freedom.max(1.0)
    }
}

/// Fits the segments that `train` names, then the start states alone of the others.
fn one_way(
    data: &Data,
    fitted: &Fit,
    train: &dyn Fn(usize) -> bool,
    moving: Moving,
) -> Result<Fit, DynamicsError> {
    let choose = |wanted: bool| {
        let starts = fitted.point.starts.iter().enumerate().filter(|(index, _)| train(*index) == wanted);
        Point {
            globals: fitted.point.globals.clone(),
            starts: starts.map(|(_, start)| start.clone()).collect(),
        }
    };
    let learned = fit(&data.only(train), &fitted.hypothesis, choose(true), moving, Effort::HELD_OUT)?;
    let point = Point { globals: learned.point.globals, ..choose(false) };
    fit(&data.only(|index| !train(index)), &fitted.hypothesis, point, Moving::Starts, Effort::HELD_OUT)
}

/// Interleaved segments, both ways: fitted to the even ones and scored on the odd ones, and the other way round.
/// With `Moving::Starts` no coefficient is fitted at all.
pub(crate) fn interleaved(data: &Data, fitted: &Fit, moving: Moving) -> Result<HeldOut, DynamicsError> {
    let odd = one_way(data, fitted, &|index| index % 2 == 0, moving)?;
    let even = one_way(data, fitted, &|index| index % 2 == 1, moving)?;
    let (mut odd, mut even) = (odd.residuals.into_iter(), even.residuals.into_iter());
    let residuals = (0..data.segments.len())
        .filter_map(|index| if index % 2 == 0 { even.next() } else { odd.next() })
        .collect();
    Ok(HeldOut { residuals, starts: fitted.hypothesis.start_length() })
}

/// Fitted to the first two thirds of the segments, scored on the last third: mean square.
pub(crate) fn last_third(data: &Data, fitted: &Fit, moving: Moving) -> Result<f64, DynamicsError> {
    let count = data.segments.len();
    let first = count - (count / 3).max(1);
    let scored = one_way(data, fitted, &|index| index < first, moving)?;
    let held = HeldOut { residuals: scored.residuals, starts: fitted.hypothesis.start_length() };
    Ok(held.mean_square())
}
