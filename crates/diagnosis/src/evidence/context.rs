//! Context shared by the later stages: the fits, and comparisons between them.

#![allow(
    clippy::indexing_slicing,
    reason = "a fit has a global parameter for every calibrated number; there is a worth for every set"
)]

use crate::answer::Rivalry;
use crate::data::segments::Data;
use crate::error::DiagnosisError;
use crate::evidence::held_out::{Both, HeldOut};
use crate::evidence::shapley::shapley;
use crate::fit::calibrate::Baseline;
use crate::fit::fitted::{Fit, Point};
use crate::fit::levenberg_marquardt::{Moving, fit};
use crate::fit::significance::{OFF_BY_CHANCE, ratio, significant};
use crate::fit::stopping::Stopping;
use crate::model::candidate::Candidate;
use crate::model::candidates::EvidenceClass;
use crate::model::hypothesis::{Calibrated as Coefficient, Hypothesis};
use crate::noise::statistics::{normal_above, quantile, resampled};
use crate::search::refine::without;
use crate::sets::archive::Archive;
use crate::sets::shooting_interval::shortened;
use crate::settings::Settings;
use rayon::prelude::*;
use results::{DetectabilityRow, WithInterval};

/// Ratio of the squared errors without and with a shift of the rest angle below which nobody would see it: a hundredth of
/// the error. Many samples make smaller ones significant.
const VISIBLE: f64 = 1.02;

/// Probability of a false alarm at which a shift of the rest angle counts as significant. It is low because
/// the shift is named as an effect.
const SHIFTED_BY_CHANCE: f64 = 0.001;

/// Number of standard errors of the clock's rate within which a change of the stiffness may be due to the
/// clock. The stiffness depends on the square of the rate.
const STANDARD_ERRORS: f64 = 3.0;

/// Data, fits and settings shared by the later stages.
pub(crate) struct Context<'a> {
    /// Data on the longest shooting interval that the best sets follow.
    pub(crate) data: &'a Data,
    pub(crate) base: &'a Baseline,
    /// Unjoined segments, each with its own start state.
    pub(crate) segments: Unjoined<'a>,
    pub(crate) pool: &'a Archive,
    pub(crate) thin: Thin<'a>,
    pub(crate) time: f64,
    pub(crate) settings: &'a Settings,
}

/// Unjoined segments, each with its own start state.
#[derive(Clone, Copy)]
pub(crate) struct Unjoined<'a> {
    pub(crate) data: &'a Data,
    pub(crate) base: &'a Baseline,
}

/// The same data on fewer samples: enough for shares of the gap, and many times as fast.
pub(crate) struct Thin<'a> {
    pub(crate) data: &'a Data,
    pub(crate) calibrated: &'a Fit,
    pub(crate) pool: &'a Archive,
}

/// Set of effects with its held-out predictions.
pub(crate) struct Predicted<'a> {
    /// Fit on the shooting interval that the set was judged on; `fitted` is the fit on the unjoined segments.
    pub(crate) followed: &'a Fit,
    pub(crate) fitted: Fit,
    pub(crate) after: HeldOut,
}

/// Held-out predictions of the simulators and of all sets.
pub(crate) struct Predictions<'a> {
    pub(crate) nominal: HeldOut,
    pub(crate) recalibrated: HeldOut,
    /// Mean square error of the recalibrated simulator on the last third, fitted to the first two thirds.
    pub(crate) last_third: f64,
    pub(crate) sets: Vec<Predicted<'a>>,
}

/// Held-out residuals, and the set that they and the evidence support.
pub(crate) struct Held<'a> {
    pub(crate) nominal: HeldOut,
    pub(crate) recalibrated: HeldOut,
    pub(crate) after: HeldOut,
    /// Mean square errors on the last third, recalibrated and repaired.
    pub(crate) last_third: [f64; 2],
    /// Fit of the set on the shooting interval that it was judged on.
    pub(crate) repaired: &'a Fit,
    /// Fit of the set on the unjoined segments.
    pub(crate) fitted: Fit,
}

/// Shift of the rest angle that alone explains the recalibration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Shift {
    /// Constant torque that causes the shift.
    pub(crate) torque: WithInterval,
}

impl<'a> Context<'a> {
    /// Returns the shift of the rest angle if, beside the effects of a set, the shift alone improves the fit
    /// as much as the whole calibration does: this is a constant torque.
    pub(crate) fn shift(&self, repaired: &Fit) -> Option<Shift> {
        let own = &repaired.hypothesis;
        let effects = &repaired.point.globals[own.calibrated.len()..];
        if !own.calibrated.contains(&Coefficient::RestAngle) {
            return None;
        }
        // If the effects cannot be fitted beside the given coefficients, a mere shift does not explain the
        // calibration.
        let with = |calibrated: Vec<Coefficient>| {
            let hypothesis = Hypothesis { calibrated, ..own.clone() };
            let globals = [hypothesis.nominal_point().as_slice(), effects].concat();
            let from = if effects.is_empty() { &self.base.nominal } else { repaired };
            let point = Point { globals, starts: from.point.starts.clone() };
            fit(self.data, &hypothesis, point, Moving::All, Stopping::FINAL).ok()
        };
        let time = repaired.autocorrelation_time();
        let is_all = |part: &Fit| {
            let others = own.calibrated.len() - part.hypothesis.calibrated.len();
            !significant(repaired, part, time, others, OFF_BY_CHANCE)
        };
        let mut shifted = with(vec![Coefficient::RestAngle])?;
        if !is_all(&shifted) {
            // An uncertain rate of the clock acts like an uncertain stiffness.
            let allowed = STANDARD_ERRORS * 2.0 * self.data.facts.rate_error;
            let both = [Coefficient::RestAngle, Coefficient::Stiffness];
            let has_both = both.iter().all(|which| own.calibrated.contains(which));
            let freed = if has_both && allowed > 0.0 { with(both.to_vec()) } else { None };
            let is_the_clock = |freed: &Fit| {
                // Two coefficients are moved: rest angle and stiffness.
                let stiffness = freed.point.globals[1];
                (stiffness / own.nominal.stiffness() - 1.0).abs() < allowed
            };
            shifted = freed.filter(|freed| is_the_clock(freed) && is_all(freed))?;
        }
        // The same fit without the shift.
        let others = shifted.hypothesis.calibrated.iter().skip(1).copied().collect::<Vec<_>>();
        let bare =
            if effects.is_empty() && others.is_empty() { self.base.nominal.clone() } else { with(others)? };
        let is_seen = bare.squares > VISIBLE * shifted.squares;
        if !is_seen || !significant(&shifted, &bare, time, 1, SHIFTED_BY_CHANCE) {
            return None;
        }
        let nominal = &own.nominal;
        let torque = |angle: f64| nominal.stiffness() * (angle - nominal.rest_angle());
        // The rest angle is the first of the moved coefficients.
        let angle = shifted.point.globals[0];
        let error = (shifted.variance_with(time) * shifted.inverse[(0, 0)]).sqrt();
        let reach = normal_above(0.025) * error;
        let interval_95 = [torque(angle - reach), torque(angle + reach)];
        Some(Shift { torque: WithInterval { value: torque(angle), interval_95 } })
    }

    /// Returns `true` if recalibration moves the rest angle by more than chance explains: a constant torque would do
    /// the same.
    pub(crate) fn moves_the_rest(&self, repaired: &Fit) -> bool {
        let own = &repaired.hypothesis;
        let Some(at) = own.calibrated.iter().position(|which| *which == Coefficient::RestAngle) else {
            return false;
        };
        let variance = repaired.variance_with(self.time) * repaired.inverse[(at, at)];
        let moved = repaired.point.globals[at] - own.nominal.rest_angle();
        moved.abs() > normal_above(0.5 * SHIFTED_BY_CHANCE) * variance.sqrt()
    }

    /// Predicts held-out parts with the nominal simulator, with the recalibrated one (the nominal one, if
    /// recalibration predicts worse), and with the given sets. Sets whose motion cannot be simulated from
    /// parts of the data are left out.
    pub(crate) fn predictions(&self, sets: &[&'a Fit]) -> Result<Predictions<'a>, DiagnosisError> {
        let short = self.segments.base;
        let own = |followed: &'a Fit, fitted: &'a Fit| Both {
            longer: self.data,
            followed,
            segments: self.segments.data,
            fitted,
        };
        // On longer stretches the nominal simulator loses count of the swings, and no start state fits.
        let given = Both { longer: self.segments.data, ..own(&short.nominal, &short.nominal) };
        let nominal = given.interleaved(Moving::Starts)?;
        let calibrated = own(&self.base.calibrated, &short.calibrated);
        // A fit of parts may fail where the whole does not, for example if it becomes too stiff to integrate.
        let recalibrated = calibrated.interleaved(Moving::All).unwrap_or_else(|_| nominal.clone());
        // Many coefficients fitted to half of a record may predict the other half worse than the nominal
        // ones.
        let (recalibrated, last_third) = if recalibrated.mean_square() > nominal.mean_square() {
            (nominal.clone(), given.last_third(Moving::Starts)?)
        } else {
            let last_third = calibrated.last_third(Moving::All);
            let last_third = last_third.unwrap_or_else(|_| recalibrated.mean_square());
            (recalibrated, last_third)
        };
        let sets: Vec<Predicted<'a>> = sets.par_iter().filter_map(|set| self.predicted(set)).collect();
        Ok(Predictions { nominal, recalibrated, last_third, sets })
    }

    /// Returns the held-out predictions of a set; `None` if its motion cannot be simulated from parts of the
    /// data.
    pub(crate) fn predicted(&self, followed: &'a Fit) -> Option<Predicted<'a>> {
        let segments = self.segments.data;
        let fitted = shortened(segments, self.data, followed).ok()?;
        let both = Both { longer: self.data, followed, segments, fitted: &fitted };
        let after = both.interleaved(Moving::All).ok()?;
        Some(Predicted { followed, fitted, after })
    }

    /// Returns the set of the named effects with its predictions; the recalibrated simulator if none is named
    /// or no predicted set has exactly these effects.
    pub(crate) fn held_out(
        &self,
        predictions: Predictions<'a>,
        named: &[Candidate],
    ) -> Result<Held<'a>, DiagnosisError> {
        let Predictions { nominal, recalibrated, last_third: third, sets } = predictions;
        let is_named = |own: &Predicted<'_>| own.followed.hypothesis.candidates == named;
        let set = sets.into_iter().find(|own| !named.is_empty() && is_named(own));
        if let Some(Predicted { followed, fitted, after }) = set {
            let both = Both { longer: self.data, followed, segments: self.segments.data, fitted: &fitted };
            let last_third = [third, both.last_third(Moving::All).unwrap_or_else(|_| after.mean_square())];
            return Ok(Held { nominal, recalibrated, after, last_third, repaired: followed, fitted });
        }
        let repaired = self
            .pool
            .find(&[])
            .ok_or_else(|| DiagnosisError::NotFitted { reason: "no set of effects was fitted".to_owned() })?;
        let after = recalibrated.clone();
        let fitted = self.segments.base.calibrated.clone();
        Ok(Held { nominal, after, recalibrated, last_third: [third, third], repaired, fitted })
    }

    /// Returns the decrease of the sum of squares by each subset of a set's effects, for each part of the
    /// thin data. The bits of the index are the subset's members.
    fn worths(&self, repaired: &Fit) -> Vec<Vec<f64>> {
        let count = repaired.hypothesis.candidates.len();
        // A set that was not fitted to the thin data leaves the whole gap to be explained.
        let whole = self.thin.calibrated.squares;
        let known = self.thin.pool.find(&repaired.hypothesis.candidates);
        let effort = Stopping::share(known.map_or(whole, |own| whole - own.squares).max(0.0));
        let mut worths: Vec<Vec<f64>> = (0..1_usize << count)
            .into_par_iter()
            .map(|set| {
                let members: Vec<Candidate> = repaired
                    .hypothesis
                    .candidates
                    .iter()
                    .enumerate()
                    .filter(|(index, _)| set & (1 << index) != 0)
                    .map(|(_, candidate)| *candidate)
                    .collect();
                let known = self.thin.pool.find(&members).cloned();
                let fitted = known
                    .or_else(|| without(self.thin.data, repaired, |index| set & (1 << index) != 0, effort));
                let calibrated = self.thin.calibrated;
                let by_part = |fit: &Fit| -> Vec<f64> {
                    let parts = self.thin.data.by_part(&fit.residuals);
                    parts.iter().map(|part| part.norm_squared()).collect()
                };
                let squares = by_part(fitted.as_ref().unwrap_or(calibrated));
                let before = by_part(calibrated);
                before.iter().zip(squares).map(|(before, after)| before - after).collect()
            })
            .collect();
        // A set explains at least as much as its subsets. If its own fit ended in a local minimum, the best
        // of theirs is taken.
        for set in 0..worths.len() {
            let total = |set: usize| worths[set].iter().sum::<f64>();
            let subsets = (0..count).map(|member| set & !(1 << member));
            let best = subsets.max_by(|a, b| total(*a).total_cmp(&total(*b))).unwrap_or(set);
            if total(best) > total(set) {
                worths[set] = worths[best].clone();
            }
        }
        worths
    }

    /// Returns, for each effect of a set, the decrease of the sum of squares that it causes (Shapley value),
    /// and its share in the decrease by all effects. The interval of the share is from a bootstrap over
    /// segments.
    pub(crate) fn shares(&self, repaired: &Fit) -> Vec<(f64, WithInterval)> {
        let count = repaired.hypothesis.candidates.len();
        let worths = self.worths(repaired);
        let by_segment = |pick: &[usize]| -> Vec<f64> {
            shapley(count, &|set| {
                let own = worths.get(set);
                pick.iter().filter_map(|index| own.and_then(|own| own.get(*index))).sum()
            })
        };
        let segments = self.segments.data.segments.len();
        let all: Vec<usize> = (0..segments).collect();
        let values = by_segment(&all);
        let relative = |values: &[f64]| -> Vec<f64> {
            let total: f64 = values.iter().map(|v| v.max(0.0)).sum();
            values.iter().map(|v| if total > 0.0 { v.max(0.0) / total } else { 0.0 }).collect()
        };
        let seed = self.settings.seed.child("shares");
        let draws: Vec<Vec<f64>> =
            resampled(segments, 400, &seed).map(|drawn| relative(&by_segment(&drawn))).collect();
        values
            .iter()
            .zip(relative(&values))
            .enumerate()
            .map(|(index, (squares, value))| {
                let own: Vec<f64> = draws.iter().filter_map(|draw| draw.get(index).copied()).collect();
                let end = |share: f64| quantile(&own, share);
                (*squares, WithInterval { value, interval_95: [end(0.025), end(0.975)] })
            })
            .collect()
    }

    /// Returns the rivals of each effect, closest first, and the closest rival set. A rival set differs from
    /// the given one by one replaced effect.
    pub(crate) fn rivals(&self, repaired: &Fit) -> (Vec<Rivalry>, Option<&'a Fit>) {
        let own = &repaired.hypothesis.candidates;
        let mut found: Vec<(Rivalry, &'a Fit)> = Vec::new();
        let mut nested = Vec::new();
        for fit in &self.pool.fits {
            let others = &fit.hypothesis.candidates;
            let gone: Vec<&Candidate> = own.iter().filter(|c| !others.contains(c)).collect();
            let come: Vec<&Candidate> = others.iter().filter(|c| !own.contains(c)).collect();
            let has_names = come.iter().all(|own| own.evidence_class() != EvidenceClass::Unnamed);
            if let (&[gone], &[come], true) = (gone.as_slice(), come.as_slice(), has_names)
                && gone.effect() != come.effect()
            {
                let distance = (2.0 * ratio(repaired, fit, self.time)).max(0.0).sqrt();
                found.push((Rivalry { effect: gone.id(), rival: come.id(), distance }, fit));
            }
        }
        // A generalization that was rejected because it reduced to the member itself is at distance 0.
        for member in own {
            let is_other = |general: &&Candidate| general.effect() != member.effect();
            let generals = Candidate::ALL.iter().filter(|general| general.generalizes() == Some(*member));
            for &general in generals.filter(is_other) {
                let swapped = repaired
                    .hypothesis
                    .with(&own.iter().map(|c| if c == member { general } else { *c }).collect::<Vec<_>>());
                let given_up = self.pool.rejected.contains(&swapped.candidates);
                if given_up && self.pool.find(&swapped.candidates).is_none() {
                    let rivalry = Rivalry { effect: member.id(), rival: general.id(), distance: 0.0 };
                    nested.push(rivalry);
                }
            }
        }
        found.sort_by(|a, b| a.0.distance.total_cmp(&b.0.distance));
        let closest = found.first().map(|(_, fit)| *fit);
        nested.extend(found.into_iter().map(|(rivalry, _)| rivalry));
        (nested, closest)
    }

    pub(crate) fn detectability(&self, repaired: &Fit) -> Vec<DetectabilityRow> {
        let candidates = &repaired.hypothesis.candidates;
        candidates
            .par_iter()
            .enumerate()
            .filter_map(|(left_out, candidate)| {
                let rest: Vec<Candidate> = candidates.iter().copied().filter(|c| c != candidate).collect();
                let known = self.pool.find(&rest).cloned();
                let reduced = known
                    .or_else(|| without(self.data, repaired, |index| index != left_out, Stopping::SEARCH))?;
                let d = (2.0 * ratio(repaired, &reduced, self.time)).max(0.0).sqrt();
                Some(DetectabilityRow { effect: candidate.id().to_owned(), d })
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::fixtures::record;
    use crate::{Diagnosis, Observations, Settings, diagnose};
    use dynamics::chain::{Chain, Observed};
    use dynamics::{Active, Nominal, System};
    use record::{Clock, ClockChoice};

    /// Returns the diagnosis of 25 s of a swing under a constant torque, with 260 samples a second in bursts
    /// whose receive times scatter by 2.5 ms. The swing determines the rate more precisely than these times
    /// do.
    fn diagnosed(torque: f64, seed: u64) -> Diagnosis {
        let nominal = Nominal::new(1.0, 0.19, 55.0, 0.0).unwrap();
        let preload = Active::new("constant_torque", &[torque]).unwrap();
        let system = System::new(nominal, vec![preload]).unwrap();
        let bursts = Active::new("timestamp_batching", &[0.042, 0.0025]).unwrap();
        let chain = Chain::new(Observed::Position, 2e-4, vec![bursts]).unwrap();
        let record = record(&system, 0.55, 6500, &chain, seed);
        let clock = Clock::new(&record, ClockChoice::Auto).unwrap();
        diagnose(&[Observations::new(&record, &clock)], &nominal, &Settings::default(), &|| 0.0).unwrap()
    }

    #[test]
    fn a_clock_that_is_a_little_off_hides_no_preload_and_makes_none() {
        for seed in 1..=3 {
            let answer = diagnosed(0.24, seed);
            assert_eq!(answer.verdict.effects, ["constant_torque", "timestamp_batching"], "{seed}");
            let rows = answer.effects.iter().filter(|row| row.id == "constant_torque");
            assert_eq!(rows.count(), 1, "{seed}");
            let answer = diagnosed(0.0, seed);
            assert_eq!(answer.verdict.effects, ["timestamp_batching"], "{seed}");
        }
    }
}
