//! Held-out prediction: residuals of a hypothesis on parts of the records that it was not fitted to.
//!
//! Blocks of every segment take turns. Half of the segments would have to predict amplitudes that they never had: a
//! stop that only the first swings meet was rated at −106 nats although the set with it left a fifteenth of the error.

use crate::data::segments::{Data, Segment};
use crate::fit::fitted::{Fit, Point};
use crate::fit::levenberg_marquardt::{Moving, fit};
use crate::fit::stopping::Stopping;
use dynamics::DynamicsError;
use nalgebra::DVector;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Residuals on held-out parts.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct HeldOut {
    /// Residuals by unjoined segment, in the order of the data, scaled up for the degrees of freedom that the
    /// start states take.
    pub(crate) residuals: Vec<DVector<f64>>,
}

impl HeldOut {
    /// Returns the mean square over all segments.
    pub(crate) fn mean_square(&self) -> f64 {
        mean_square(&self.residuals, 0)
    }
}

fn mean_square(residuals: &[DVector<f64>], starts: usize) -> f64 {
    let squares: f64 = residuals.iter().map(DVector::norm_squared).sum();
    let freedom: f64 = residuals.iter().map(|e| e.len() as f64 - starts as f64).sum();
    squares / freedom.max(1.0)
}

/// Periods in a block. Not a multiple of a half, so that blocks fall on different sides of the swing.
const BLOCK: f64 = 0.75;

/// Number of turns in which blocks are held out.
const TURNS: usize = 4;

/// Scales residuals up for the degrees of freedom that fitted start values have taken.
fn for_freedom(residual: &DVector<f64>, starts: usize) -> DVector<f64> {
    let count = residual.len() as f64;
    residual * (count / (count - starts as f64).max(1.0)).sqrt()
}

/// Fit on a shooting interval, and the same on the unjoined segments.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Both<'a> {
    pub(crate) longer: &'a Data,
    pub(crate) followed: &'a Fit,
    pub(crate) segments: &'a Data,
    pub(crate) fitted: &'a Fit,
}

impl Both<'_> {
    /// Returns the coefficients fitted to a part of the data whose segments have the given numbers, from the
    /// followed fit on. With [`Moving::Starts`] these are the followed ones.
    fn learned(
        &self,
        (part, numbers): (Data, Vec<usize>),
        moving: Moving,
    ) -> Result<Vec<f64>, DynamicsError> {
        let Fit { hypothesis, point, .. } = self.followed;
        if moving == Moving::Starts {
            return Ok(point.globals.clone());
        }
        let starts = numbers.iter().filter_map(|&number| point.starts.get(number).cloned());
        let point = Point { globals: point.globals.clone(), starts: starts.collect() };
        Ok(fit(&part, hypothesis, point, moving, Stopping::HELD_OUT)?.point.globals)
    }

    /// Returns the residuals of the segments that `train` does not select, with only start states fitted to
    /// them.
    fn with_own_starts(
        &self,
        train: &(dyn Fn(usize) -> bool + Sync),
        globals: Vec<f64>,
    ) -> Result<Vec<DVector<f64>>, DynamicsError> {
        let others = self.fitted.point.starts.iter().enumerate().filter(|(index, _)| !train(*index));
        let point = Point { globals, starts: others.map(|(_, start)| start.clone()).collect() };
        let rest = self.segments.only(|index| !train(index));
        Ok(fit(&rest, &self.fitted.hypothesis, point, Moving::Starts, Stopping::HELD_OUT)?.residuals)
    }

    /// Returns the turn in which each sample of the unjoined segments is held out. Every segment has blocks of all
    /// turns, so that no turn has to predict an amplitude that the others never saw.
    fn turns(&self) -> Vec<Vec<usize>> {
        let length = BLOCK * TAU / self.segments.facts.frequency;
        let of = |segment: &Segment| {
            let turn = |first: &f64, time: &f64| ((time - first) / length) as usize % TURNS;
            let first = segment.times.first();
            first.map_or_else(Vec::new, |first| segment.times.iter().map(|time| turn(first, time)).collect())
        };
        self.segments.segments.iter().map(of).collect()
    }

    /// Returns the residuals of the samples held out in each turn, by unjoined segment. The coefficients are fitted
    /// to the other samples. The start states, which belong to the record and not to the law, are then fitted to all
    /// samples of every segment, and the residuals are scaled up for the degrees of freedom that they take: in a
    /// strongly damped motion nothing but the first samples determines them.
    fn by_turns(&self, turns: &[Vec<usize>], moving: Moving) -> Result<Vec<DVector<f64>>, DynamicsError> {
        let mut parts = turns.iter();
        let joined = self
            .longer
            .segments
            .iter()
            .map(|own| parts.by_ref().take(own.parts.len()).flatten().copied().collect());
        let joined: Vec<Vec<usize>> = joined.collect();
        let Fit { hypothesis, point, .. } = self.fitted;
        let starts = hypothesis.start_length();
        let learned = |turn: usize| {
            let is_kept = |segment: usize, sample: usize| {
                joined.get(segment).and_then(|own: &Vec<usize>| own.get(sample)) != Some(&turn)
            };
            let train = self.longer.keeping(is_kept);
            let numbers = (0..train.segments.len()).collect();
            let globals = self.learned((train, numbers), moving)?;
            let point = Point { globals, starts: point.starts.clone() };
            let all = fit(self.segments, hypothesis, point, Moving::Starts, Stopping::HELD_OUT)?;
            Ok(all.residuals.iter().map(|own| for_freedom(own, starts)).collect())
        };
        let learned: Vec<Vec<DVector<f64>>> =
            (0..TURNS).into_par_iter().map(learned).collect::<Result<_, DynamicsError>>()?;
        let held_out = |(segment, turns): (usize, &Vec<usize>)| {
            let own = turns.iter().enumerate().filter_map(|(sample, turn)| {
                learned.get(*turn).and_then(|own| own.get(segment)?.get(sample)).copied()
            });
            DVector::from_vec(own.collect())
        };
        Ok(turns.iter().enumerate().map(held_out).collect())
    }

    /// Returns the residuals of blocks of samples that are held out in turns. With [`Moving::Starts`] no
    /// coefficient is fitted.
    pub(crate) fn interleaved(&self, moving: Moving) -> Result<HeldOut, DynamicsError> {
        Ok(HeldOut { residuals: self.by_turns(&self.turns(), moving)? })
    }

    /// Returns the mean square error on the last third of the segments, fitted to the first two thirds.
    pub(crate) fn last_third(&self, moving: Moving) -> Result<f64, DynamicsError> {
        let count = self.segments.segments.len();
        let first = count.saturating_sub((count / 3).max(1));
        let train = |index: usize| index < first;
        let learned = self.learned(self.longer.masked(&train), moving)?;
        let scored = self.with_own_starts(&train, learned)?;
        Ok(mean_square(&scored, self.fitted.hypothesis.start_length()))
    }
}

#[cfg(test)]
mod tests {
    use crate::fixtures::record;
    use crate::{Observations, Settings, Status, diagnose};
    use dynamics::chain::{Chain, Observed};
    use dynamics::reference::{Tolerance, simulate};
    use dynamics::{Active, Hold, Input, Nominal, Start, System};
    use rand_distr::{Distribution, StandardNormal};
    use record::{Clock, ClockChoice, Quantity, Record};
    use seed::Seed;

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
        assert!(of("friction") > 0.9 && of("restoring") > 0.7, "{:?}", answer.classes);
        assert!(answer.gap.repaired < 1.1 * answer.gap.noise_floor, "{:?}", answer.gap);
    }

    /// The start velocity of a strongly damped joint is gone after half a second: nothing but the first samples
    /// determines it.
    #[test]
    fn an_exact_simulator_of_a_damped_joint_lacks_nothing() {
        let tau = std::f64::consts::TAU;
        let times: Vec<f64> = (0..1500).map(|at| 0.01 * f64::from(at)).collect();
        for ratio in [0.3, 0.75] {
            let frequency = 1.8 * tau;
            let nominal = Nominal::new(1.0, 2.0 * ratio * frequency, frequency * frequency, 0.0).unwrap();
            let system = System::new(nominal, Vec::new()).unwrap();
            let command = |t: &f64| frequency * frequency * 0.5 * (tau * (0.3 + 0.08 * t) * t).sin();
            let torque: Vec<f64> = times.iter().map(command).collect();
            let input = Input::new(times.clone(), torque.clone(), Hold::Zero).unwrap();
            let start = Start::release(0.0);
            let motion = simulate(&system, start, Some(&input), &times, &Tolerance::default()).unwrap();
            let mut generator = Seed::new(4).child("noise").generator();
            let mut noise = || -> f64 { StandardNormal.sample(&mut generator) };
            let values = motion.position.iter().map(|x| x + 5e-4 * noise()).collect();
            let record = Record::new(times.clone(), values, Some(torque), Quantity::Position, "rad").unwrap();
            let observed = Observations::new(&record, &Clock::new(&record, ClockChoice::Host).unwrap());
            let answer = diagnose(&[observed], &nominal, &Settings::default(), &|| 0.0).unwrap();
            assert!(matches!(answer.verdict.status, Status::None | Status::Calibration), "{ratio}");
            assert!(answer.gap.repaired < 1.1 * answer.gap.noise_floor, "{ratio}: {:?}", answer.gap);
        }
    }
}
