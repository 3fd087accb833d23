//! Held-out prediction: residuals of a hypothesis on parts of the records that it was not fitted to.

use crate::data::segments::{Data, Segment};
use crate::data::shooting_interval::Origin;
use crate::fit::fitted::{Fit, Point, extended};
use crate::fit::levenberg_marquardt::{Moving, fit};
use crate::fit::stopping::Stopping;
use crate::model::predictor::{Derivatives, Simulator};
use dynamics::DynamicsError;
use nalgebra::DVector;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Residuals on held-out parts.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct HeldOut {
    /// Residuals by segment, in the order of the data; only start states were fitted to them.
    pub(crate) residuals: Vec<DVector<f64>>,
    /// Number of start values fitted per segment.
    pub(crate) starts: usize,
    /// Residuals by segment of predictions that continue from the fitted parts: nothing is fitted to the
    /// held-out parts, not even start states. The parts are segments, or blocks of samples if there are few
    /// segments. In the first part of each shooting interval, and if segments are not joined, these are the
    /// residuals with fitted start states, scaled up for the degrees of freedom that those take.
    pub(crate) continued: Vec<DVector<f64>>,
}

impl HeldOut {
    /// Returns the mean square over all segments, weighted by their samples.
    pub(crate) fn mean_square(&self) -> f64 {
        mean_square(&self.residuals, self.starts)
    }
}

fn mean_square(residuals: &[DVector<f64>], starts: usize) -> f64 {
    let squares: f64 = residuals.iter().map(DVector::norm_squared).sum();
    let freedom: f64 = residuals.iter().map(|e| e.len() as f64 - starts as f64).sum();
    squares / freedom.max(1.0)
}

/// Fewest parts of the records that take turns at being held out. With fewer, a law learned from one half of
/// a decaying swing would have to predict amplitudes that it never saw.
const FEWEST: usize = 8;

/// Fewest periods in a block. Not a multiple of a half, so that blocks fall on different sides of the swing.
const BLOCK: f64 = 0.75;

/// Number of turns in which blocks are held out.
const TURNS: usize = 4;

/// Scales residuals up for the degrees of freedom that fitted start values have taken.
fn for_freedom(residual: &DVector<f64>, starts: usize) -> DVector<f64> {
    let count = residual.len() as f64;
    residual * (count / (count - starts as f64).max(1.0)).sqrt()
}

/// Residuals of parts, each with the part's index.
type Numbered = Vec<(usize, DVector<f64>)>;

/// Fit on a shooting interval, and the same on the unjoined segments.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Both<'a> {
    pub(crate) longer: &'a Data,
    pub(crate) followed: &'a Fit,
    pub(crate) segments: &'a Data,
    pub(crate) fitted: &'a Fit,
}

impl Both<'_> {
    /// Fits the parts that `train` selects, on the longer shooting interval. Also returns where the segments of
    /// that fit begin.
    fn learned(
        &self,
        train: &(dyn Fn(usize) -> bool + Sync),
        moving: Moving,
    ) -> Result<(Fit, Vec<Origin>), DynamicsError> {
        let (masked, origins) = self.longer.masked(train);
        Ok((self.fitted_to(masked, &origins, moving)?, origins))
    }

    /// Fits a part of the data, from the followed motion on.
    fn fitted_to(&self, mut part: Data, origins: &[Origin], moving: Moving) -> Result<Fit, DynamicsError> {
        let Fit { hypothesis, point, .. } = self.followed;
        let mut simulator = Simulator::new(self.longer, hypothesis, &point.globals, Derivatives::None)?;
        let mut starts = Vec::with_capacity(origins.len());
        for (own, origin) in part.segments.iter_mut().zip(origins) {
            let known = self.longer.segments.get(origin.segment).zip(point.starts.get(origin.segment));
            let Some((segment, start)) = known else { continue };
            if origin.sample == 0 {
                starts.push(start.clone());
                continue;
            }
            let motion = simulator.motion(segment, start)?;
            let state = motion.position.get(origin.sample).zip(motion.velocity.get(origin.sample));
            own.guess = state.map_or(own.guess, |(position, velocity)| [*position, *velocity]);
            starts.push(extended(&own.guess, hypothesis));
        }
        let point = Point { globals: point.globals.clone(), starts };
        fit(&part, hypothesis, point, moving, Stopping::HELD_OUT)
    }

    /// Returns the residuals of the segments that `train` does not select, with only start states fitted to
    /// them, and those of [`Self::continued`] if segments are joined.
    fn scored(
        &self,
        train: &(dyn Fn(usize) -> bool + Sync),
        moving: Moving,
    ) -> Result<(Vec<DVector<f64>>, Numbered), DynamicsError> {
        let learned = self.learned(train, moving)?;
        let residuals = self.with_own_starts(train, &learned.0)?;
        if !self.longer.is_joined() {
            return Ok((residuals, Vec::new()));
        }
        // The first part is always fitted: predicting backward to it would be another question than
        // continuing.
        let firsts = self.longer.firsts();
        if firsts.iter().all(|&first| train(first)) {
            return Ok((residuals, self.continued(train, &learned)?));
        }
        let train = |index: usize| train(index) || firsts.contains(&index);
        Ok((residuals, self.continued(&train, &self.learned(&train, moving)?)?))
    }

    /// Returns the residuals of the segments that `train` does not select, with only start states fitted to
    /// them.
    fn with_own_starts(
        &self,
        train: &(dyn Fn(usize) -> bool + Sync),
        learned: &Fit,
    ) -> Result<Vec<DVector<f64>>, DynamicsError> {
        let others = self.fitted.point.starts.iter().enumerate().filter(|(index, _)| !train(*index));
        let point = Point {
            globals: learned.point.globals.clone(),
            starts: others.map(|(_, start)| start.clone()).collect(),
        };
        let rest = self.segments.only(|index| !train(index));
        Ok(fit(&rest, &self.fitted.hypothesis, point, Moving::Starts, Stopping::HELD_OUT)?.residuals)
    }

    /// Returns the residuals, with their indices, of the parts that `train` does not select; nothing is fitted
    /// to them. `learned` is the fit of the others, whose segments begin with those of the data.
    fn continued(
        &self,
        train: &dyn Fn(usize) -> bool,
        (learned, origins): &(Fit, Vec<Origin>),
    ) -> Result<Numbered, DynamicsError> {
        let mut simulator =
            Simulator::new(self.longer, &learned.hypothesis, &learned.point.globals, Derivatives::None)?;
        let mut all = Vec::new();
        for (origin, start) in origins.iter().zip(&learned.point.starts) {
            if let Some(segment) = self.longer.segments.get(origin.segment) {
                all.push(simulator.predict(segment, start)?.residual);
            }
        }
        let parts = self.longer.by_part(&all).into_iter().enumerate();
        Ok(parts.filter(|(index, _)| !train(*index)).collect())
    }

    /// Returns the turn in which each sample is held out, if there are too few segments to take turns; `None`
    /// otherwise.
    fn turns(&self) -> Option<Vec<Vec<usize>>> {
        if self.segments.segments.len() >= FEWEST {
            return None;
        }
        let period = TAU / self.longer.facts.frequency;
        let spans = || self.longer.segments.iter().map(Segment::span);
        // Every segment has blocks of all turns, so that the other blocks determine its start state.
        let shortest = spans().fold(f64::INFINITY, f64::min) / TURNS as f64;
        let length = (spans().sum::<f64>() / FEWEST as f64).min(shortest).max(BLOCK * period);
        let of = |segment: &Segment| {
            // A segment without samples has no blocks.
            let first = segment.times.first().copied().unwrap_or_default();
            segment.times.iter().map(|time| ((time - first) / length) as usize % TURNS).collect()
        };
        Some(self.longer.segments.iter().map(of).collect())
    }

    /// Returns the residuals of the samples held out in each turn. The coefficients are fitted to the other
    /// samples. The start states, which belong to the record and not to the law, are then fitted to all samples,
    /// and the residuals are scaled up for the degrees of freedom that they take: in a strongly damped motion
    /// nothing but the first samples determines them.
    fn by_turns(&self, turns: &[Vec<usize>], moving: Moving) -> Result<Vec<DVector<f64>>, DynamicsError> {
        let turn_of = |segment: usize, sample: usize| turns.get(segment).and_then(|own| own.get(sample));
        let learned: Vec<Vec<DVector<f64>>> = (0..TURNS)
            .into_par_iter()
            .map(|turn| {
                let (train, origins) =
                    self.longer.keeping(|segment, sample| turn_of(segment, sample) != Some(&turn));
                let globals = self.fitted_to(train, &origins, moving)?.point.globals;
                let Fit { hypothesis, point, .. } = self.followed;
                let point = Point { globals, starts: point.starts.clone() };
                let all = fit(self.longer, hypothesis, point, Moving::Starts, Stopping::HELD_OUT)?;
                let starts = hypothesis.start_length();
                Ok(all.residuals.iter().map(|own| for_freedom(own, starts)).collect())
            })
            .collect::<Result<_, DynamicsError>>()?;
        let held_out = |segment: usize, sample: usize| {
            // Every sample has a turn.
            let turn = turn_of(segment, sample).copied().unwrap_or_default();
            // Every turn has a fit of all segments.
            learned.get(turn).and_then(|own| own.get(segment)?.get(sample)).copied().unwrap_or_default()
        };
        let lengths = self.longer.segments.iter().map(|segment| segment.times.len()).enumerate();
        let all: Vec<DVector<f64>> = lengths
            .map(|(segment, length)| DVector::from_fn(length, |sample, _| held_out(segment, sample)))
            .collect();
        Ok(self.longer.by_part(&all))
    }

    /// Returns residuals on interleaved segments: fitted to the even ones and scored on the odd ones, and the
    /// other way round. With few segments, blocks of samples are held out in turns instead. With
    /// [`Moving::Starts`] no coefficient is fitted.
    pub(crate) fn interleaved(&self, moving: Moving) -> Result<HeldOut, DynamicsError> {
        if let Some(turns) = self.turns() {
            let residuals = self.by_turns(&turns, moving)?;
            return Ok(HeldOut { continued: residuals.clone(), residuals, starts: 0 });
        }
        let (even, odd) = (|index: usize| index.is_multiple_of(2), |index: usize| !index.is_multiple_of(2));
        let starts = self.fitted.hypothesis.start_length();
        let (first, second) = rayon::join(|| self.scored(&odd, moving), || self.scored(&even, moving));
        let ((first, first_continued), (second, second_continued)) = (first?, second?);
        let (mut first, mut second) = (first.into_iter(), second.into_iter());
        let residuals: Vec<DVector<f64>> = (0..self.segments.segments.len())
            .filter_map(|index| if even(index) { first.next() } else { second.next() })
            .collect();
        let mut continued: Vec<DVector<f64>> = residuals.iter().map(|own| for_freedom(own, starts)).collect();
        for (index, part) in first_continued.into_iter().chain(second_continued) {
            if let Some(own) = continued.get_mut(index) {
                *own = part;
            }
        }
        Ok(HeldOut { residuals, starts, continued })
    }

    /// Returns the mean square error on the last third of the segments, fitted to the first two thirds.
    pub(crate) fn last_third(&self, moving: Moving) -> Result<f64, DynamicsError> {
        let count = self.segments.segments.len();
        let first = count.saturating_sub((count / 3).max(1));
        let train = |index: usize| index < first;
        let (learned, _) = self.learned(&train, moving)?;
        let scored = self.with_own_starts(&train, &learned)?;
        Ok(mean_square(&scored, self.fitted.hypothesis.start_length()))
    }
}

#[cfg(test)]
mod tests {
    use crate::fixtures::record;
    use crate::{Observations, Settings, diagnose};
    use dynamics::chain::{Chain, Observed};
    use dynamics::{Active, Nominal, System};
    use record::{Clock, ClockChoice};

    /// Seven swings whose amplitude falls to a third: little more than one segment, and neither half can
    /// predict the other.
    #[test]
    fn a_short_swing_is_judged_by_blocks() {
        let nominal = Nominal::new(1.0, 0.2, 480.0, 0.0).unwrap();
        let effects = [("coulomb_friction", 6.0), ("cubic_stiffness", -60.0)];
        let effects = effects.map(|(id, value)| Active::new(id, &[value]).unwrap()).to_vec();
        let system = System::new(nominal, effects).unwrap();
        let chain = Chain::new(Observed::Position, 5e-4, Vec::new()).unwrap();
        let record = record(&system, 0.6, 520, &chain, 1);
        let clock = Clock::new(&record, ClockChoice::Host).unwrap();
        let observations = [Observations::new(&record, &clock)];
        let answer = diagnose(&observations, &nominal, &Settings::default(), &|| 0.0).unwrap();
        let of =
            |id: &str| answer.classes.iter().find(|class| class.id == id).map_or(0.0, |own| own.probability);
        assert!(of("friction") > 0.9 && of("restoring") > 0.9, "{:?}", answer.classes);
        assert!(answer.gap.repaired < 1.1 * answer.gap.noise_floor.value, "{:?}", answer.gap);
    }
}
