//! Shooting intervals: the time over which a fit predicts the motion from one start state.
//!
//! With segments of a few periods a fit cannot lose count of the swings, and a disturbance spoils only one
//! segment. But short segments are less sensitive. An effect that accumulates over the whole record (a
//! frequency or a decay that changes little by little) all but vanishes if every segment has a start state of
//! its own. So segments are joined, two by two, for as long as a model follows the motion; in the end a
//! record may have a single start state.

use crate::data::segments::Data;
use crate::fit::fitted::{Fit, Point, extended};
use crate::fit::levenberg_marquardt::{Moving, fit};
use crate::fit::stopping::Stopping;
use crate::model::predictor::{Derivatives, Simulator};
use crate::sets::archive::{Archive, vanished};
use dynamics::DynamicsError;
use rayon::prelude::*;

/// Factor by which the recalibrated simulator's error may grow on a longer shooting interval, since it is not
/// the complete model.
const RECALIBRATED: f64 = 2.0;

/// Factor by which the error of a set may grow on a longer shooting interval if the set is to be judged
/// there.
const JUDGED: f64 = 1.03;

/// Largest error relative to the motion at which a linearization still holds, as a phase error in radians.
const LINEAR: f64 = 0.05;

/// Number of sets that are tried on a longer shooting interval.
const TRIED: usize = 6;

fn mean_square(fit: &Fit) -> f64 {
    fit.squares / fit.samples().max(1) as f64
}

/// Returns the mean square of the observed values about their mean.
fn motion(data: &Data) -> f64 {
    let values: Vec<f64> = data.segments.iter().flat_map(|segment| segment.values.iter().copied()).collect();
    let center = crate::noise::statistics::mean(&values);
    values.iter().map(|value| (value - center).powi(2)).sum::<f64>() / values.len().max(1) as f64
}

/// Fits a set on data joined twice as far, from the start states that the shorter segments have there.
///
/// The fit stops early if its mean square per degree of freedom will not fall below `below`. `None` if a
/// start state is missing or the motion cannot be computed.
fn lengthened(longer: &Data, shorter: &Data, found: &Fit, below: f64) -> Option<Fit> {
    let places = shorter.firsts();
    let starts = longer
        .firsts()
        .iter()
        .map(|first| {
            let place = places.iter().position(|own| own == first)?;
            found.point.starts.get(place).cloned()
        })
        .collect::<Option<_>>()?;
    let point = Point { globals: found.point.globals.clone(), starts };
    let effort = Stopping::FINAL.below(below * point.freedom(longer.samples()));
    fit(longer, &found.hypothesis, point, Moving::All, effort).ok()
}

/// Transfers a fit on joined segments to the unjoined ones. The start states are taken along the fitted
/// motion, and only they are refitted.
pub(crate) fn shortened(segments: &Data, longer: &Data, found: &Fit) -> Result<Fit, DynamicsError> {
    if !longer.is_joined() {
        return Ok(found.clone());
    }
    let mut simulator = Simulator::new(longer, &found.hypothesis, &found.point.globals, Derivatives::None)?;
    let mut starts = Vec::with_capacity(segments.segments.len());
    for (segment, start) in longer.segments.iter().zip(&found.point.starts) {
        let motion = simulator.motion(segment, start)?;
        for &at in &segment.parts {
            let state = motion.position.get(at).zip(motion.velocity.get(at));
            let state = state.map_or([0.0; 2], |(position, velocity)| [*position, *velocity]);
            starts.push(extended(&state, &found.hypothesis));
        }
    }
    let point = Point { globals: found.point.globals.clone(), starts };
    fit(segments, &found.hypothesis, point, Moving::Starts, Stopping::HELD_OUT)
}

/// Data with segments joined by some number, and the recalibrated simulator fitted to them.
#[derive(Debug, Clone)]
pub(crate) struct ShootingInterval {
    pub(crate) by: usize,
    pub(crate) data: Data,
    pub(crate) calibrated: Fit,
}

impl ShootingInterval {
    /// Returns the shortest shooting interval: the segments as they were cut.
    pub(crate) fn shortest(data: &Data, calibrated: &Fit) -> Self {
        Self { by: 1, data: data.clone(), calibrated: calibrated.clone() }
    }

    /// Doubles the shooting interval; `None` if nothing is left to join or the fit fails.
    fn doubled(&self, segments: &Data) -> Option<Self> {
        let by = 2 * self.by;
        let data = segments.joined(by);
        if data.segments.len() == self.data.segments.len() {
            return None;
        }
        let calibrated = lengthened(&data, &self.data, &self.calibrated, f64::INFINITY)?;
        Some(Self { by, data, calibrated })
    }

    /// Joins segments by `by`, a power of two; `None` if there are not enough to join or a fit fails.
    pub(crate) fn joined(segments: &Data, calibrated: &Fit, by: usize) -> Option<Self> {
        let mut interval = Self::shortest(segments, calibrated);
        while interval.by < by {
            interval = interval.doubled(segments)?;
        }
        Some(interval)
    }

    /// Returns the longest shooting interval on which the recalibrated simulator is still close enough to
    /// linearize.
    pub(crate) fn longest(segments: &Data, calibrated: &Fit) -> Self {
        let mut horizon = Self::shortest(segments, calibrated);
        let (shortest, motion) = (mean_square(calibrated), motion(segments));
        while let Some(longer) = horizon.doubled(segments) {
            let square = mean_square(&longer.calibrated);
            if square > RECALIBRATED * RECALIBRATED * shortest || square > LINEAR * LINEAR * motion {
                break;
            }
            horizon = longer;
        }
        horizon
    }

    /// Returns the longest shooting interval on which the fit follows the motion as well as on this one, up
    /// to chance.
    pub(crate) fn farthest(self, segments: &Data) -> Self {
        let mut horizon = self;
        let each = |own: &Self| own.calibrated.squares / own.calibrated.freedom();
        while let Some(longer) = horizon.doubled(segments) {
            // Two standard errors of a mean square of so many independent samples.
            let worth = horizon.calibrated.freedom() / horizon.calibrated.autocorrelation_time();
            let by_chance = 1.0 + 2.0 * (2.0 / worth).sqrt();
            if each(&longer) > by_chance * each(&horizon) {
                break;
            }
            horizon = longer;
        }
        horizon
    }

    /// Returns `true` if the best set of a pool follows the motion on this shooting interval as well as
    /// segment by segment.
    pub(crate) fn is_followed(&self, segments: &Data, pool: &Archive) -> bool {
        let time = pool.autocorrelation_time();
        pool.ranked(time).first().is_some_and(|best| {
            let short = shortened(segments, &self.data, best);
            let short = short.and_then(|short| {
                fit(segments, &short.hypothesis, short.point, Moving::All, Stopping::HELD_OUT)
            });
            // Every start state takes its degrees of freedom out of the sum of squares.
            short.is_ok_and(|short| {
                best.squares / best.freedom() <= JUDGED * JUDGED * short.squares / short.freedom()
            })
        })
    }

    /// Returns the longest shooting interval on which the best sets of a pool still follow the motion, with
    /// the fits of these sets on it; `None` if that is the present one.
    pub(crate) fn beyond(&self, segments: &Data, pool: &Archive) -> Option<(Self, Vec<Fit>)> {
        let time = pool.autocorrelation_time();
        let best: Vec<Fit> = pool
            .ranked(time)
            .into_iter()
            .filter(|fit| !fit.hypothesis.candidates.is_empty())
            .take(TRIED)
            .cloned()
            .collect();
        let first = best.first().map(|fit| fit.squares / fit.freedom())?;
        let mut reached: Option<(Self, Vec<Fit>)> = None;
        let mut sets = best;
        let mut horizon = self.clone();
        while let Some(longer) = horizon.doubled(segments) {
            let most = JUDGED * JUDGED * first;
            // A set does not follow if it ends there as another effect or as none.
            let kept: Vec<Fit> = sets
                .par_iter()
                .filter_map(|set| lengthened(&longer.data, &horizon.data, set, most))
                .filter(|fit| !vanished(&longer.data, fit))
                .collect();
            let smallest = kept.iter().map(|fit| fit.squares / fit.freedom()).fold(f64::INFINITY, f64::min);
            if smallest > most {
                break;
            }
            sets.clone_from(&kept);
            horizon = longer.clone();
            reached = Some((longer, kept));
        }
        reached
    }
}

#[cfg(test)]
mod tests {
    use super::{ShootingInterval, shortened};
    use crate::data::observations::Observations;
    use crate::data::segments::{Data, cut};
    use crate::fit::calibrate::baseline;
    use crate::{Settings, Status, diagnose};
    use dynamics::reference::{Tolerance, simulate};
    use dynamics::{Active, Nominal, Start, System};
    use rand_distr::{Distribution, StandardNormal};
    use record::{Clock, ClockChoice, Quantity, Record};
    use seed::Seed;

    fn nominal() -> Nominal {
        Nominal::new(1.0, 0.2, 480.0, 0.0).unwrap()
    }

    /// 20 s of a swing at 3.5 Hz with some effects, 100 samples a second, noise of 1 mrad.
    fn observed(effects: &[(&str, &[f64])]) -> Observations {
        let active = effects.iter().map(|(id, values)| Active::new(id, values).unwrap()).collect();
        let system = System::new(nominal(), active).unwrap();
        let times: Vec<f64> = (0..2000).map(|i| f64::from(i) * 0.01).collect();
        let motion = simulate(&system, Start::release(0.6), None, &times, &Tolerance::default()).unwrap();
        let mut generator = Seed::new(5).child("noise").generator();
        let mut noise = || -> f64 { StandardNormal.sample(&mut generator) };
        let values = motion.position.iter().map(|x| x + 1e-3 * noise()).collect();
        let record = Record::new(times, values, None, Quantity::Position, "rad").unwrap();
        let clock = Clock::new(&record, ClockChoice::Host).unwrap();
        Observations::new(&record, &clock)
    }

    fn data(observations: &Observations) -> Data {
        cut(std::slice::from_ref(observations), &[vec![true; observations.len()]], &(&nominal()).into())
            .unwrap()
    }

    /// Without a missing effect the whole record follows from one start state, and the states along it fit
    /// each segment.
    #[test]
    fn a_record_without_effects_is_followed_as_a_whole() {
        let data = data(&observed(&[]));
        let base = baseline(&data, &(&nominal()).into()).unwrap().calibrated;
        let horizon = ShootingInterval::longest(&data, &base);
        assert_eq!(horizon.data.segments.len(), 1);
        let noise = (horizon.calibrated.squares / horizon.calibrated.freedom()).sqrt();
        assert!((noise / 1e-3 - 1.0).abs() < 0.05, "{noise}");
        let short = shortened(&data, &horizon.data, &horizon.calibrated).unwrap();
        assert_eq!(short.point.starts.len(), data.segments.len());
        assert!((short.squares / horizon.calibrated.squares - 1.0).abs() < 0.05);
    }

    /// A softening whose frequency shift accumulates over the record: at most 2.3e-3 of the spring's torque,
    /// next to nothing within six periods.
    #[test]
    fn what_adds_up_over_a_record_is_seen() {
        let observations = observed(&[("cubic_stiffness", &[-3.0])]);
        let seconds = || 0.0;
        let answer = diagnose(&[observations], &nominal(), &Settings::default(), &seconds).unwrap();
        assert_eq!(answer.verdict.status, Status::Effect, "{:?}", answer.verdict);
        let class = answer.verdict.equivalent.iter().flatten().chain(&answer.verdict.effects);
        assert!(class.into_iter().any(|id| *id == "cubic_stiffness"), "{:?}", answer.verdict);
    }
}
