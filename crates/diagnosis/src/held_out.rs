//! How well a hypothesis predicts what it was not fitted to.

use crate::fit::{Effort, Fit, Moving, Point, fit};
use crate::response::Simulator;
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
    /// Mean square where nothing at all was fitted to the parts held out, not even their start states: what goes on from
    /// the parts that were. The same as with start states where segments are not joined.
    pub(crate) continued: f64,
}

impl HeldOut {
    /// Mean square over all segments, each weighed by its samples.
    pub(crate) fn mean_square(&self) -> f64 {
        mean_square(&self.residuals, self.starts)
    }
}

fn mean_square(residuals: &[DVector<f64>], starts: usize) -> f64 {
    let squares: f64 = residuals.iter().map(DVector::norm_squared).sum();
    let freedom: f64 = residuals.iter().map(|e| e.len() as f64 - starts as f64).sum();
    squares / freedom.max(1.0)
}

/// A fit on some horizon, and the same on the segments as they were cut.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Both<'a> {
    pub(crate) longer: &'a Data,
    pub(crate) followed: &'a Fit,
    pub(crate) segments: &'a Data,
    pub(crate) fitted: &'a Fit,
}

/// What one half says of the other.
struct OneWay {
    scored: Vec<DVector<f64>>,
    continued: Vec<DVector<f64>>,
}

impl Both<'_> {
    /// Fits the parts that `train` names, on the longer horizon; then the start states alone of the others.
    fn one_way(&self, train: &dyn Fn(usize) -> bool, moving: Moving) -> Result<OneWay, DynamicsError> {
        let (masked, numbers) = self.longer.masked(train);
        let own = numbers.iter().filter_map(|&number| self.followed.point.starts.get(number).cloned());
        let point = Point { globals: self.followed.point.globals.clone(), starts: own.collect() };
        let learned = fit(&masked, &self.followed.hypothesis, point, moving, Effort::HELD_OUT)?;
        let others = self.fitted.point.starts.iter().enumerate().filter(|(index, _)| !train(*index));
        let point = Point {
            globals: learned.point.globals.clone(),
            starts: others.map(|(_, start)| start.clone()).collect(),
        };
        let rest = self.segments.only(|index| !train(index));
        let scored = fit(&rest, &self.fitted.hypothesis, point, Moving::Starts, Effort::HELD_OUT)?;
        let mut continued = Vec::new();
        if self.longer.is_joined() {
            let mut simulator =
                Simulator::new(self.longer, &learned.hypothesis, &learned.point.globals, true)?;
            simulator.set(&learned.point.globals)?;
            let mut all = Vec::new();
            let mut starts = learned.point.starts.iter();
            for (number, segment) in self.longer.segments.iter().enumerate() {
                // A segment that was left out as a whole goes on from nowhere.
                let Some(start) = numbers.contains(&number).then(|| starts.next()).flatten() else {
                    all.push(DVector::zeros(segment.times.len()));
                    continue;
                };
                all.push(simulator.predict(segment, start)?.residual);
            }
            let parts = self.longer.by_part(&all).into_iter().enumerate();
            continued = parts.filter(|(index, _)| !train(*index)).map(|(_, part)| part).collect();
        }
        Ok(OneWay { scored: scored.residuals, continued })
    }

    /// Interleaved segments, both ways: fitted to the even ones and scored on the odd ones, and the other way round.
    /// With `Moving::Starts` no coefficient is fitted at all.
    pub(crate) fn interleaved(&self, moving: Moving) -> Result<HeldOut, DynamicsError> {
        let odd = self.one_way(&|index| index % 2 == 0, moving)?;
        let even = self.one_way(&|index| index % 2 == 1, moving)?;
        let starts = self.fitted.hypothesis.start_length();
        let parts: Vec<DVector<f64>> = odd.continued.into_iter().chain(even.continued).collect();
        let (mut odd, mut even) = (odd.scored.into_iter(), even.scored.into_iter());
        let residuals: Vec<DVector<f64>> = (0..self.segments.segments.len())
            .filter_map(|index| if index % 2 == 0 { even.next() } else { odd.next() })
            .collect();
        let continued =
            if parts.is_empty() { mean_square(&residuals, starts) } else { mean_square(&parts, 0) };
        Ok(HeldOut { residuals, starts, continued })
    }

    /// Fitted to the first two thirds of the segments, scored on the last third: mean square.
    pub(crate) fn last_third(&self, moving: Moving) -> Result<f64, DynamicsError> {
        let count = self.segments.segments.len();
        let first = count - (count / 3).max(1);
        let scored = self.one_way(&|index| index < first, moving)?.scored;
        Ok(mean_square(&scored, self.fitted.hypothesis.start_length()))
    }
}
