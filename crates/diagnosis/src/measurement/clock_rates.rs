//! Correction of clocks that run at different rates.
//!
//! Records of one system are often stamped by clocks whose rates differ by up to some parts in a thousand. A
//! clock that is fast by ε makes every swing of its record longer by ε. No single spring then fits all
//! records, and any effect that can change a duration takes the place of what is missing. So the search also
//! runs on corrected clocks, and the better result is kept: a law by which the frequency depends on the
//! amplitude explains more than rates that imitate it.

#![allow(clippy::indexing_slicing, reason = "there is a rate for every record")]

use crate::answer::Finding;
use crate::data::observations::Observations;
use crate::data::segments::{Data, Segment};
use crate::fit::fitted::Fit;
use crate::fit::levenberg_marquardt::{Moving, fit, residuals};
use crate::fit::stopping::Stopping;
use crate::linear::projection::Projection;
use crate::linear::tangent::matrix;
use crate::matrices::solve;
use crate::model::candidate::Candidate;
use crate::residual::floor;
use crate::sets::archive::Archive;
use crate::sets::likelihood::Likelihood;
use crate::sets::proposals::{Proposal, fit_all, proposal};
use crate::sets::score::{parameter_price, score, score_with};
use crate::sets::shooting_interval::{ShootingInterval, shortened};
use crate::sets::weights::price;
use dynamics::DynamicsError;
use nalgebra::DVector;
use rayon::prelude::*;

/// Largest difference of two rates that is attributed to clocks: ten times that of a poor oscillator.
const LARGEST: f64 = 0.02;

/// Log evidence, in nats, that the rates have to gain beyond the price of their parameters: the same as for a
/// flexible effect.
const ENOUGH: f64 = 30.0;

/// Number of standard errors within which the stamps leave a rate open. Such rates have to gain no more than
/// the price of their parameters.
const OPEN: f64 = 3.0;

/// Sets that are refitted with clock rates: this many of the best, and all sets with at most this many
/// effects.
const BEST: usize = 3;
const FEW: usize = 1;

/// Maximum number of alternations between fitting a set and estimating the rates.
const TURNS: usize = 3;

/// Records on the clock of the first record.
#[derive(Debug, Clone)]
pub(crate) struct ClockRates {
    pub(crate) records: Vec<Observations>,
    /// Relative rate by which each record's clock is fast, compared with the first one's.
    rates: Vec<f64>,
    /// Log evidence that the rates have to gain, in nats.
    pub(crate) price: f64,
}

impl ClockRates {
    /// Returns the records on their clocks as stamped.
    pub(crate) fn as_stamped(records: &[Observations]) -> Self {
        Self { records: records.to_vec(), rates: vec![0.0; records.len()], price: 0.0 }
    }

    /// Corrects the records for the rates that fit best, and returns them with the fit of the best set on
    /// them. `None` if no set with rates scores better than the best set without, or if a rate is too large
    /// for a clock.
    ///
    /// A set that imitates clock rates leaves no rates to fit, but the plain law with rates beside it is
    /// cheaper. A set whose fit fails on other clocks is left out. `segments` are those that the sets'
    /// shooting interval was joined from.
    pub(crate) fn corrected(
        &self,
        segments: &Data,
        (interval, sets): (&ShootingInterval, &Archive),
        vocabulary: usize,
    ) -> Option<(Self, Fit)> {
        let data = &interval.data;
        let further = self.records.len().checked_sub(1).filter(|further| *further > 0)?;
        let time = sets.autocorrelation_time();
        let few = |fit: &&Fit| fit.hypothesis.counted().count() <= FEW;
        let ranked = sets.ranked(time);
        let chosen: Vec<&Fit> = ranked
            .iter()
            .take(BEST)
            .chain(ranked.iter().skip(BEST).filter(|fit| few(fit)))
            .copied()
            .collect();
        let alone = ranked.first().map_or_else(Vec::new, |best| alone(data, best, sets));
        let chosen: Vec<&Fit> = chosen.into_iter().chain(&alone).collect();
        let all: Vec<Rated> =
            chosen.par_iter().filter_map(|fit| rated(segments, data, fit).ok().flatten()).collect();
        let worth = |own: &Rated| {
            score_with(&own.fit, own.fit.squares, further, time) - price(data, &own.fit, vocabulary, 1.0)
        };
        let best = all.into_iter().max_by(|a, b| worth(a).total_cmp(&worth(b)));
        let as_stamped = |fit: &Fit| score(fit, time) - price(data, fit, vocabulary, 1.0);
        let known = sets.fits.iter().map(as_stamped).fold(f64::NEG_INFINITY, f64::max);
        let Rated { rates, price, fit } = best.filter(|own| worth(own) - own.price > known)?;
        let mut records = self.records.clone();
        for (record, rate) in records.iter_mut().zip(&rates) {
            let input_rows = record.input_rows.iter_mut().map(|(time, _)| time);
            for time in record.times_s.iter_mut().chain(input_rows) {
                *time = true_time(*time, *rate);
            }
        }
        let rates: Vec<f64> = self.rates.iter().zip(&rates).map(|(old, new)| both(*old, *new)).collect();
        let is_clock = rates.iter().all(|rate| rate.abs() <= LARGEST);
        is_clock.then_some((Self { records, rates, price }, fit))
    }

    /// Returns the finding that states the rates; `None` if all are zero.
    pub(crate) fn finding(&self) -> Option<Finding> {
        let largest = self.rates.iter().copied().fold(0.0, |known: f64, rate| known.max(rate.abs()));
        let told: Vec<String> = self.rates.iter().map(|rate| format!("{:+.4} %", 100.0 * rate)).collect();
        let text = format!(
            "the clocks of the records run at different rates ({} relative to the first), or the system was \
             slower in some records at every amplitude; the difference was removed from the stamps",
            told.join(", ")
        );
        (largest > 0.0).then_some(Finding { effect: None, text })
    }
}

impl Data {
    /// Returns the data on clocks without these rates. `rates` says by how much each record's clock is fast.
    ///
    /// # Errors
    /// None for rates above −1, since the times of an input stay in increasing order.
    fn without_rates(&self, rates: &[f64]) -> Result<Self, DynamicsError> {
        let slower = |times: &[f64], record: usize| -> Vec<f64> {
            times.iter().map(|time| true_time(*time, rates[record])).collect()
        };
        let segments =
            self.segments.iter().map(|own| Segment { times: slower(&own.times, own.record), ..own.clone() });
        let inputs = self.inputs.iter().enumerate().map(|(record, input)| {
            input.as_ref().map(|own| own.with_times(slower(own.times(), record))).transpose()
        });
        Ok(Self { segments: segments.collect(), inputs: inputs.collect::<Result<_, _>>()?, ..self.clone() })
    }
}

/// Fits each member of the best set alone, beginning where the set's fit ended, if it has not been fitted
/// alone yet. Without the rates the search may have found no size for it.
fn alone(data: &Data, best: &Fit, known: &Archive) -> Vec<Fit> {
    let members: Vec<Candidate> = best.hypothesis.counted().copied().collect();
    let without = |member: &Candidate| {
        let others: Vec<Candidate> = members.iter().copied().filter(|own| own != member).collect();
        proposal(data, best, &others, &[])
    };
    let begun: Vec<Proposal> = members.iter().map(without).collect();
    let unknown = begun.into_iter().filter(|own| known.find(&own.hypothesis.candidates).is_none());
    fit_all(data, &unknown.collect::<Vec<_>>(), |_| Stopping::SEARCH)
}

/// Returns the true time at which a clock that is fast by a rate shows the time `shown`.
fn true_time(shown: f64, rate: f64) -> f64 {
    shown / (1.0 + rate)
}

/// Combines two rates: that of a clock fast by `new` on a clock fast by `old`.
fn both(old: f64, new: f64) -> f64 {
    (1.0 + old) * (1.0 + new) - 1.0
}

/// Set of effects fitted together with clock rates.
struct Rated {
    /// Relative rate by which each record's clock is fast.
    rates: Vec<f64>,
    /// Log evidence that the rates have to gain, in nats.
    price: f64,
    fit: Fit,
}

/// Fits a set and the clock rates in alternation: first on short segments, where clocks that differ by much
/// do not lose count of the swings, then on the shooting interval of the set's own fit. `None` if the
/// residual shows no rates.
fn rated(segments: &Data, data: &Data, found: &Fit) -> Result<Option<Rated>, DynamicsError> {
    let mut rates = vec![0.0; data.inputs.len()];
    let mut least = None;
    let mut fit = shortened(segments, data, found)?;
    for (data, begun) in [(segments, fit.clone()), (data, found.clone())] {
        fit = begun;
        for turn in 0..TURNS {
            let slower = data.without_rates(&rates)?;
            if turn > 0 || least.is_some() {
                fit = again(&slower, &fit)?;
            }
            let Some((further, price)) = left(&slower, &fit)? else { break };
            least.get_or_insert(price);
            for (rate, further) in rates.iter_mut().zip(further) {
                *rate = both(*rate, further);
            }
            if rates.iter().any(|rate| rate.abs() > LARGEST) {
                return Ok(None);
            }
        }
    }
    let Some(price) = least else { return Ok(None) };
    // The first clock has an error as well.
    let open = OPEN * std::f64::consts::SQRT_2 * data.facts.rate_error;
    let price = if rates.iter().all(|rate| rate.abs() <= open) { price } else { price + ENOUGH };
    let fit = again(&data.without_rates(&rates)?, &fit)?;
    Ok(Some(Rated { rates, price, fit }))
}

fn again(data: &Data, found: &Fit) -> Result<Fit, DynamicsError> {
    fit(data, &found.hypothesis, found.point.clone(), Moving::All, Stopping::FINAL)
}

/// Phase in radians by which the longest segment is shifted to compute the effect of a rate.
const SMALL: f64 = 1e-3;

/// Returns the change of the prediction per unit of each clock's rate, for all records but the first. The
/// input is on the same clock: a swing that follows the input therefore shows a rate by its lag and not by
/// its timing.
fn by_rates(data: &Data, fit: &Fit) -> Result<Vec<Vec<f64>>, DynamicsError> {
    let rate = SMALL / (data.facts.frequency * data.longest_span()).max(1.0);
    let shifted = residuals(&data.without_rates(&vec![rate; data.inputs.len()])?, fit)?;
    let all = || data.segments.iter().zip(fit.residuals.iter().zip(&shifted));
    let of = |record: usize| {
        all()
            .flat_map(|(segment, (before, after))| {
                let own = if segment.record == record { 1.0 / rate } else { 0.0 };
                before.iter().zip(after).map(move |(before, after)| own * (before - after))
            })
            .collect()
    };
    Ok((1..data.inputs.len()).map(of).collect())
}

/// Estimates by how much each record's clock is fast, and the price of these parameters in log evidence;
/// `None` if the residual does not gain more than that price.
fn left(data: &Data, fit: &Fit) -> Result<Option<(Vec<f64>, f64)>, DynamicsError> {
    let records = data.inputs.len();
    let columns = by_rates(data, fit)?;
    let projection = Projection::at(data, fit)?;
    let mut columns = matrix(projection.rows(), &columns);
    projection.apply(&mut columns);
    let residual = DVector::from_iterator(columns.nrows(), fit.stacked());
    let right =
        nalgebra::DMatrix::from_column_slice(columns.ncols(), 1, columns.tr_mul(&residual).as_slice());
    let Some(solution) = solve(&columns.tr_mul(&columns), &right) else { return Ok(None) };
    let left = &residual - &columns * solution.column(0);
    let by_segment = |all: &DVector<f64>| {
        let mut at = 0;
        let mut cut = |own: &DVector<f64>| {
            at += own.len();
            all.rows(at - own.len(), own.len()).clone_owned()
        };
        data.by_part(&fit.residuals.iter().map(&mut cut).collect::<Vec<_>>())
    };
    let (before, after) = (by_segment(&residual), by_segment(&left));
    let noise = floor::floor(data, &fit.residuals).value;
    let likelihood = Likelihood::of(data, &after, noise);
    // The search on the corrected clocks decides whether the rates gain enough.
    let price = parameter_price(records - 1, likelihood.worth());
    if likelihood.log(&after) - likelihood.log(&before) <= price {
        return Ok(None);
    }
    let solution = solution.column(0).clone_owned();
    let solved = (0..records - 1).map(|at| solution[at]);
    Ok(Some((std::iter::once(0.0).chain(solved).collect(), price)))
}

#[cfg(test)]
mod tests {
    use crate::data::observations::Observations;
    use crate::{Diagnosis, Settings, diagnose};
    use dynamics::reference::{Tolerance, simulate};
    use dynamics::{Active, Hold, Input, Nominal, Start, System};
    use rand_distr::{Distribution, StandardNormal};
    use record::{Clock, ClockChoice, Quantity, Record};
    use seed::Seed;

    /// Two records of a system, the second on a clock that is fast by `rate`: of a body driven by a chirp, or
    /// released from 0.4 and from half as far.
    fn diagnosed(effects: &[(&str, &[f64])], rate: f64, driven: bool) -> Diagnosis {
        let nominal = Nominal::new(1.0, 0.3, 400.0, 0.0).unwrap();
        let effects = effects.iter().map(|(id, values)| Active::new(id, values).unwrap()).collect();
        let system = System::new(nominal, effects).unwrap();
        let times: Vec<f64> = (0..600).map(|at| f64::from(at) / 50.0).collect();
        let torques: Vec<f64> = times.iter().map(|t| 20.0 * ((15.0 + 0.4 * t) * t).sin()).collect();
        let input = driven.then(|| Input::new(times.clone(), torques.clone(), Hold::Linear).unwrap());
        let mut generator = Seed::new(5).child("noise").generator();
        let mut observe = |start: f64, rate: f64| {
            let tolerance = Tolerance::default();
            let motion =
                simulate(&system, Start::release(start), input.as_ref(), &times, &tolerance).unwrap();
            let mut noise = || -> f64 { StandardNormal.sample(&mut generator) };
            let values = motion.position.iter().map(|x| x + 3e-4 * noise()).collect();
            let stamps = times.iter().map(|time| time * (1.0 + rate)).collect();
            let logged = driven.then(|| torques.clone());
            let record = Record::new(stamps, values, logged, Quantity::Position, "rad").unwrap();
            Observations::new(&record, &Clock::new(&record, ClockChoice::Host).unwrap())
        };
        let records = [observe(0.4, 0.0), observe(0.2, rate)];
        diagnose(&records, &nominal, &Settings { most_effects: 2, ..Settings::default() }, &|| 0.0).unwrap()
    }

    /// Percentage by which the second clock is reported to be fast.
    fn percent(answer: &Diagnosis) -> Option<f64> {
        clocks(answer)?.split("+0.0000 %, ").nth(1)?.split(" %").next()?.parse().ok()
    }

    fn clocks(answer: &Diagnosis) -> Option<&str> {
        let all = &answer.measuring_chain.findings;
        all.iter().map(|own| own.text.as_str()).find(|text| text.contains("clocks of the records"))
    }

    #[test]
    fn a_clock_that_is_fast_is_no_effect() {
        for driven in [false, true] {
            let answer = diagnosed(&[], 2e-3, driven);
            assert!(answer.verdict.effects.is_empty(), "{driven}: {:?}", answer.verdict);
            let told = percent(&answer).unwrap();
            assert!((told - 0.2).abs() < 0.01, "{driven}: {told} %");
        }
    }

    /// A nonlinear spring makes the small swing slower too, and within each record as well.
    #[test]
    fn a_frequency_that_depends_on_the_amplitude_is_no_clock() {
        let answer = diagnosed(&[("cubic_stiffness", &[40.0])], 0.0, false);
        assert_eq!(clocks(&answer), None);
        assert_eq!(answer.verdict.effects, ["cubic_stiffness"]);
    }

    /// A clock rate and a nonlinear spring both lengthen the swings of the second record, and both are found.
    #[test]
    fn a_clock_does_not_hide_in_what_stands_in_for_it() {
        let answer = diagnosed(&[("cubic_stiffness", &[40.0])], 1e-3, false);
        assert!(percent(&answer).is_some_and(|told| (told - 0.1).abs() < 0.01), "{:?}", clocks(&answer));
        assert_eq!(answer.verdict.effects, ["cubic_stiffness"]);
    }
}
