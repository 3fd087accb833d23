//! From observations to an answer, stage by stage.

use crate::answer::{
    Budget, Calibrated, Cell, Detectability, Diagnosis, EffectProbability, Finding, Interval, MeasuringChain,
    ParameterEstimate, Rivalry, Series, SetScore, Stage, Status, Verdict, Where,
};
use crate::budget::{budget, shapley};
use crate::calibrate::{Baseline, better_hold};
use crate::candidate::{Candidate, Distortion};
use crate::dictionary::Dictionary;
use crate::error::DiagnosisError;
use crate::fit::{Effort, Fit, Moving, Point, fit};
use crate::gap::{Stages, gap, paired};
use crate::held_out::{HeldOut, interleaved, last_third};
use crate::hypothesis::{Calibrated as Coefficient, Hypothesis};
use crate::observations::Observations;
use crate::refine::{refine, without};
use crate::search::{Breadth, Pool, search};
use crate::segments::{Data, MOST_SEARCHED, cut};
use crate::statistics::normal_above;
use crate::tangent::Path;
use crate::verdict::{Weighed, marginal, ratio, significant, unknown, weigh};
use crate::{chain_statistics, experiment, latent, maps, noise, null};
use dynamics::{Nominal, SystemEffect, Units};
use record::{ClockKind, Quantity};
use seed::Seed;

/// How to diagnose.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Probability with which an effect is named where there is none; 0.001 to 0.2.
    pub false_alarm: f64,
    /// Most effects named together, 1 to 4.
    pub most_effects: usize,
    /// Randomness of the bootstraps.
    pub seed: Seed,
}

impl Default for Settings {
    fn default() -> Self {
        Self { false_alarm: 0.01, most_effects: MOST_EFFECTS, seed: Seed::new(0) }
    }
}

/// Most effects that a set can hold.
const MOST_EFFECTS: usize = 4;

/// Sets that are fitted again on every sample.
const REFINED: usize = 10;

/// Probability with which a right calibration is called off, and a right rest angle shifted: the latter is an effect's
/// name and adds to the false alarms.
const OFF_BY_CHANCE: f64 = 0.01;
const SHIFTED_BY_CHANCE: f64 = 0.001;

/// Distance in noise units below which two explanations are one class: 2·1.645, so that either is mistaken for the
/// other in one of twenty records.
const DISTINCT: f64 = 3.29;

/// Diagnoses the gap between a nominal simulator and records of one system.
///
/// `seconds` is a stopwatch: it gives seconds since any moment. Costs are linear in the number of samples up to
/// 30,000; longer data are thinned by whole segments, and the answer states the share used. The same input gives the
/// same bits with any number of threads (times apart).
///
/// # Errors
/// [`DiagnosisError`] for records that say nothing, or that are not of this system.
pub fn diagnose(
    records: &[Observations],
    nominal: &Nominal,
    settings: &Settings,
    seconds: &dyn Fn() -> f64,
) -> Result<Diagnosis, DiagnosisError> {
    let mut stages = Vec::new();
    let mut last = seconds();
    let mut lap = |name: &'static str| {
        let now = seconds();
        stages.push(Stage { name, seconds: now - last });
        last = now;
    };
    let kept: Vec<Vec<bool>> = records.iter().map(chain_statistics::kept).collect();
    let all = cut(records, &kept, nominal)?;
    let data = all.thinned(MOST_SEARCHED);
    let samples_used = data.samples() as f64 / all.samples().max(1) as f64;
    lap("measuring chain");
    let (data, base) = better_hold(&data, nominal)?;
    let data = data.for_noise(noise::floor(&data, &base.calibrated.residuals).value);
    lap("calibration");

    let candidates: Vec<Candidate> = Candidate::ALL
        .iter()
        .copied()
        .filter(|candidate| {
            candidate.applies(&data.facts, data.quantity == Quantity::Position, nominal.stiffness() > 0.0)
        })
        .collect();
    let (coarse, stride) = data.strided();
    let coarse_base =
        fit(&coarse, &base.calibrated.hypothesis, base.calibrated.point.clone(), Moving::All, Effort::FINAL)?;
    let dictionary = Dictionary::at(&coarse, &coarse_base, &candidates)?;
    let threshold = null::threshold(&dictionary, settings.false_alarm, &settings.seed);
    lap("null");
    let breadth = Breadth {
        most_effects: settings.most_effects.clamp(1, MOST_EFFECTS),
        singles: 8,
        pairs: 8,
        beam: 3,
        additions: 4,
    };
    // On every stride-th sample a gain is so many times smaller; the search must not stop on that account.
    let found = search(&coarse, &coarse_base, &candidates, &breadth, 0.5 * threshold / stride as f64);
    lap("search");
    let pool = refine(&data, &base.calibrated, &found, REFINED, stride);
    let time = pool.autocorrelation_time();
    let weighed = weigh(&pool, &base.calibrated, time, threshold, candidates.len());
    lap("fits");

    let thin = Thin { data: &coarse, calibrated: &coarse_base, pool: &found };
    let work = Work { data: &data, base: &base, pool: &pool, thin, time, settings };
    let shift = work.shift()?;
    let held = work.held_out(&weighed)?;
    let repaired = held.repaired;
    lap("held out");
    let floor = noise::floor(&data, &repaired.residuals);
    let ceiling = latent::ceiling(&data, repaired)?;
    lap("latent torque");
    let unit = records.first().map_or("", |record| record.unit);
    let figures = gap(
        &Stages {
            nominal: &held.nominal,
            recalibrated: &held.recalibrated,
            repaired: &held.after,
            ceiling: &ceiling,
        },
        floor,
        held.last_third,
        unit,
        &settings.seed,
    );
    lap("gap");

    // The free latent torque against the repaired simulator, in the excess variance of the recalibrated one.
    let noise_square = floor.value * floor.value;
    let excess = figures.recalibrated.powi(2) - noise_square;
    let explained = figures.repaired.powi(2) - figures.ceiling.powi(2);
    let share = if excess > 0.0 { explained / excess } else { 0.0 };
    let unnamed = unknown(share, paired(&held.after.residuals, &ceiling));

    let named: Vec<Candidate> = repaired.hypothesis.candidates.clone();
    let shares = work.shares(repaired);
    let calibrated_off = significant(
        &base.calibrated,
        &base.nominal,
        base.calibrated.autocorrelation_time(),
        base.calibrated.globals(),
        OFF_BY_CHANCE,
    );

    let (rivals, closest) = work.rivals(repaired);
    let detectability = work.detectability(repaired);
    let noise_coarse = floor.value * time.sqrt();
    let next_experiment = closest.filter(|rival| !rival.hypothesis.candidates.is_empty()).and_then(|rival| {
        let strided = |fit: &Fit| fit.clone();
        experiment::next(&coarse, &strided(repaired), &strided(rival), noise_coarse / (stride as f64).sqrt())
    });
    lap("identifiability");

    let left = (held.after.mean_square() - noise_square).max(0.0) * data.samples() as f64;
    let at_repaired = Dictionary::at(&coarse, &refit(&coarse, repaired)?, &candidates).ok();
    let total = named.iter().copied().map(Candidate::class).zip(shares.iter().map(|share| share.0));
    let worthwhile =
        excess > 0.0 && paired(&held.recalibrated.residuals, &held.after.residuals) > 0.0 || unnamed > 0.5;
    let budget = if worthwhile {
        budget(&total.collect::<Vec<_>>(), left, at_repaired.as_ref())
    } else {
        Budget::default()
    };
    let paths = Path::of(&data, repaired)?;
    let rest = data.facts.rest(&repaired.point.globals, &repaired.hypothesis);
    let [over_time, amplitude, phase, frequency]: [Vec<Cell>; 4] =
        maps::maps(&data, &paths, rest, &held.recalibrated.residuals, &held.after.residuals, floor.value);
    lap("maps");

    let measuring_chain = chain(records, &kept, nominal, &data, repaired, floor.value);
    let effects =
        probabilities(&work, &weighed, &candidates, repaired, &shares, unnamed, calibrated_off, shift);
    let verdict = verdict(VerdictParts {
        named: &named,
        shares: &shares,
        weighed: &weighed,
        unnamed,
        calibrated_off,
        shift,
        rivals: &rivals,
        findings: &measuring_chain.findings,
        gap: &figures,
    });
    let calibration = calibration(&work, repaired)?;
    let series = series(&data, [&held.nominal, &held.recalibrated, &held.after], &paths);
    let sets = weighed
        .iter()
        .map(|w| SetScore {
            effects: w.fit.hypothesis.ids(),
            probability: w.probability,
            rms: (w.fit.squares / w.fit.freedom()).sqrt(),
            evidence: w.evidence,
        })
        .collect();
    let rejected =
        pool.rejected.iter().map(|set| set.iter().map(|candidate| candidate.id()).collect()).collect();
    lap("answer");
    Ok(Diagnosis {
        verdict,
        effects,
        gap: figures,
        place: Where { budget, time: over_time, amplitude, phase, frequency },
        measuring_chain,
        calibration,
        repaired_nominal: repaired.hypothesis.calibrated_nominal(&repaired.point.globals)?,
        rivals,
        detectability,
        next_experiment,
        sets,
        rejected,
        series,
        samples_used,
        stages,
    })
}

fn refit(data: &Data, found: &Fit) -> Result<Fit, DiagnosisError> {
    Ok(fit(data, &found.hypothesis, found.point.clone(), Moving::All, Effort::HELD_OUT)?)
}

/// What the later stages share.
struct Work<'a> {
    data: &'a Data,
    base: &'a Baseline,
    pool: &'a Pool,
    thin: Thin<'a>,
    time: f64,
    settings: &'a Settings,
}

/// The same on every stride-th sample: enough for shares, and many times as fast.
struct Thin<'a> {
    data: &'a Data,
    calibrated: &'a Fit,
    pool: &'a Pool,
}

/// Held-out residuals, and the set that they and the evidence speak for.
struct Held<'a> {
    nominal: HeldOut,
    recalibrated: HeldOut,
    after: HeldOut,
    /// Mean squares on the last third, recalibrated and repaired.
    last_third: [f64; 2],
    repaired: &'a Fit,
}

/// A shift of the rest angle and nothing else.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Shift {
    /// Torque that shifts it.
    torque: Interval,
}

impl<'a> Work<'a> {
    /// Whether a shifted rest angle alone does what the whole calibration does: that is a constant torque.
    fn shift(&self) -> Result<Option<Shift>, DiagnosisError> {
        let base = &self.base.calibrated;
        if !base.hypothesis.calibrated.contains(&Coefficient::RestAngle) {
            return Ok(None);
        }
        let hypothesis = Hypothesis { calibrated: vec![Coefficient::RestAngle], ..base.hypothesis.clone() };
        let point =
            Point { globals: hypothesis.nominal_point(), starts: self.base.nominal.point.starts.clone() };
        let shifted = fit(self.data, &hypothesis, point, Moving::All, Effort::FINAL)?;
        let time = base.autocorrelation_time();
        let enough = !significant(base, &shifted, time, base.globals() - 1, OFF_BY_CHANCE);
        let needed = significant(&shifted, &self.base.nominal, time, 1, SHIFTED_BY_CHANCE);
        let nominal = &base.hypothesis.nominal;
        let torque = |angle: f64| nominal.stiffness() * (angle - nominal.rest_angle());
        let angle = shifted.point.globals.first().copied().unwrap_or_default();
        let error = (shifted.squares / shifted.freedom() * time * shifted.inverse[(0, 0)]).sqrt();
        let reach = normal_above(0.025) * error;
        Ok((enough && needed).then(|| Shift {
            torque: Interval {
                value: torque(angle),
                interval_95: [torque(angle - reach), torque(angle + reach)],
            },
        }))
    }

    /// Goes through the sets in the order of their probability and takes the first that also predicts held-out segments better
    /// than the calibrated simulator.
    fn held_out(&self, weighed: &[Weighed<'a>]) -> Result<Held<'a>, DiagnosisError> {
        let nominal = interleaved(self.data, &self.base.nominal, Moving::Starts)?;
        let recalibrated = interleaved(self.data, &self.base.calibrated, Moving::All)?;
        let third = last_third(self.data, &self.base.calibrated, Moving::All)?;
        let calibrated = self.pool.find(&[]).or(weighed.first().map(|w| w.fit));
        for w in weighed.iter().take(4) {
            if w.fit.hypothesis.candidates.is_empty() {
                break;
            }
            // A set whose motion cannot be followed from parts of the data predicts nothing.
            let Ok(after) = interleaved(self.data, w.fit, Moving::All) else { continue };
            let Ok(later) = last_third(self.data, w.fit, Moving::All) else { continue };
            if after.mean_square() < recalibrated.mean_square() {
                let last_third = [third, later];
                return Ok(Held { nominal, recalibrated, after, last_third, repaired: w.fit });
            }
        }
        let repaired = calibrated
            .ok_or_else(|| DiagnosisError::NotFitted { reason: "no set of effects was fitted".to_owned() })?;
        let after = recalibrated.clone();
        Ok(Held { nominal, after, recalibrated, last_third: [third, third], repaired })
    }

    /// Shapley share of each effect of a set in what the set takes away: squares, and the share with its interval from a
    /// bootstrap over segments.
    fn shares(&self, repaired: &Fit) -> Vec<(f64, Interval)> {
        let count = repaired.hypothesis.candidates.len();
        let mut worths: Vec<Vec<f64>> = (0..1_usize << count)
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
                let fitted =
                    known.or_else(|| without(self.thin.data, repaired, |index| set & (1 << index) != 0));
                let calibrated = self.thin.calibrated;
                let squares = fitted.unwrap_or_else(|| calibrated.clone()).segment_squares();
                let before = calibrated.segment_squares();
                before.iter().zip(squares).map(|(before, after)| before - after).collect()
            })
            .collect();
        // A set explains at least what its subsets do; where its own fit ended in a hollow, the best of theirs stands.
        for set in 0..worths.len() {
            let total = |set: usize| worths.get(set).map_or(0.0, |own| own.iter().sum::<f64>());
            let subsets = (0..count).map(|member| set & !(1 << member));
            let best = subsets.max_by(|a, b| total(*a).total_cmp(&total(*b))).unwrap_or(set);
            if total(best) > total(set) {
                let better = worths.get(best).cloned();
                if let (Some(slot), Some(better)) = (worths.get_mut(set), better) {
                    *slot = better;
                }
            }
        }
        let by_segment = |pick: &[usize]| -> Vec<f64> {
            shapley(count, &|set| {
                let own = worths.get(set);
                pick.iter().filter_map(|index| own.and_then(|own| own.get(*index))).sum()
            })
        };
        let segments = self.data.segments.len();
        let all: Vec<usize> = (0..segments).collect();
        let values = by_segment(&all);
        let relative = |values: &[f64]| -> Vec<f64> {
            let total: f64 = values.iter().map(|v| v.max(0.0)).sum();
            values.iter().map(|v| if total > 0.0 { v.max(0.0) / total } else { 0.0 }).collect()
        };
        let mut generator = self.settings.seed.child("shares").generator();
        let draws: Vec<Vec<f64>> = (0..400)
            .map(|_| {
                let drawn: Vec<usize> = all
                    .iter()
                    .map(|_| rand::RngExt::random_range(&mut generator, 0..segments.max(1)))
                    .collect();
                relative(&by_segment(&drawn))
            })
            .collect();
        values
            .iter()
            .zip(relative(&values))
            .enumerate()
            .map(|(index, (squares, value))| {
                let own: Vec<f64> = draws.iter().filter_map(|draw| draw.get(index).copied()).collect();
                let end = |share: f64| crate::statistics::quantile(&own, share);
                (*squares, Interval { value, interval_95: [end(0.025), end(0.975)] })
            })
            .collect()
    }

    /// What could stand in the place of each effect, closest first; and the closest set.
    fn rivals(&self, repaired: &Fit) -> (Vec<Rivalry>, Option<&'a Fit>) {
        let own = &repaired.hypothesis.candidates;
        let mut found: Vec<(Rivalry, &'a Fit)> = Vec::new();
        for fit in &self.pool.fits {
            let others = &fit.hypothesis.candidates;
            let gone: Vec<&Candidate> = own.iter().filter(|c| !others.contains(c)).collect();
            let come: Vec<&Candidate> = others.iter().filter(|c| !own.contains(c)).collect();
            if let (&[gone], &[come]) = (gone.as_slice(), come.as_slice()) {
                let distance = (2.0 * ratio(repaired, fit, self.time)).max(0.0).sqrt();
                found.push((Rivalry { effect: gone.id(), rival: come.id(), distance }, fit));
            }
        }
        found.sort_by(|a, b| a.0.distance.total_cmp(&b.0.distance));
        let closest = found.first().map(|(_, fit)| *fit);
        (found.into_iter().map(|(rivalry, _)| rivalry).collect(), closest)
    }

    fn detectability(&self, repaired: &Fit) -> Vec<Detectability> {
        let candidates = &repaired.hypothesis.candidates;
        candidates
            .iter()
            .enumerate()
            .filter_map(|(left_out, candidate)| {
                let rest: Vec<Candidate> = candidates.iter().copied().filter(|c| c != candidate).collect();
                let known = self.pool.find(&rest).cloned();
                let reduced = known.or_else(|| without(self.data, repaired, |index| index != left_out))?;
                let d = (2.0 * ratio(repaired, &reduced, self.time)).max(0.0).sqrt();
                Some(Detectability { effect: candidate.id(), d })
            })
            .collect()
    }
}

/// Standard error of a global parameter, widened for the residual's autocorrelation.
fn interval(fit: &Fit, index: usize) -> Interval {
    let value = fit.point.globals.get(index).copied().unwrap_or_default();
    let variance = fit.squares / fit.freedom() * fit.autocorrelation_time() * fit.inverse[(index, index)];
    let reach = normal_above(0.025) * variance.max(0.0).sqrt();
    Interval { value, interval_95: [value - reach, value + reach] }
}

fn parameters(work: &Work<'_>, fit: &Fit, candidate: Candidate) -> Vec<ParameterEstimate> {
    let facts = &work.data.facts;
    let units = fit.hypothesis.nominal.units();
    let mut at = fit.hypothesis.calibrated.len();
    for own in &fit.hypothesis.candidates {
        let parameters = own.parameters(facts);
        if *own == candidate {
            let mut estimates: Vec<ParameterEstimate> = parameters
                .iter()
                .enumerate()
                .map(|(index, parameter)| ParameterEstimate {
                    name: parameter.name,
                    unit: unit(candidate, index, units, work.data.quantity),
                    estimate: interval(fit, at + index),
                })
                .collect();
            // The second parameter of Stribeck friction is fitted as an excess over the first.
            if candidate == Candidate::System(SystemEffect::StribeckFriction) {
                let first = estimates.first().map_or(0.0, |estimate| estimate.estimate.value);
                if let Some(second) = estimates.get_mut(1) {
                    second.estimate.value += first;
                    second.estimate.interval_95 = second.estimate.interval_95.map(|end| end + first);
                }
            }
            return estimates;
        }
        at += parameters.len();
    }
    Vec::new()
}

fn unit(candidate: Candidate, index: usize, units: Units, quantity: Quantity) -> String {
    match candidate {
        Candidate::System(effect) => effect
            .description()
            .parameters
            .get(index)
            .map_or_else(String::new, |parameter| parameter.quantity.unit(units).to_owned()),
        Candidate::Chain(distortion) => {
            let position = match quantity {
                Quantity::Position => dynamics::Quantity::Position.unit(units).to_owned(),
                Quantity::Velocity => dynamics::Quantity::Velocity.unit(units).to_owned(),
                Quantity::Acceleration => format!("{}/s", dynamics::Quantity::Velocity.unit(units)),
            };
            match distortion {
                Distortion::Lag => "s".to_owned(),
                Distortion::Nonlinearity if index == 1 => "rad".to_owned(),
                Distortion::Nonlinearity | Distortion::Saturation => position,
                Distortion::Drift => format!("{position}/s"),
                Distortion::Clock => "1/s".to_owned(),
            }
        }
    }
}

#[allow(clippy::too_many_arguments)]
fn probabilities(
    work: &Work<'_>,
    weighed: &[Weighed<'_>],
    candidates: &[Candidate],
    repaired: &Fit,
    shares: &[(f64, Interval)],
    unnamed: f64,
    calibrated_off: bool,
    shift: Option<Shift>,
) -> Vec<EffectProbability> {
    let bare: f64 =
        weighed.iter().filter(|w| w.fit.hypothesis.candidates.is_empty()).map(|w| w.probability).sum();
    let bare = bare * (1.0 - unnamed);
    // The significance of the calibration was tested at 1 %.
    let of_calibration = if calibrated_off { 0.99 } else { 0.01 };
    let of_shift = if shift.is_some() { 0.9 } else { 0.0 };
    let plain =
        |id, probability| EffectProbability { id, probability, parameters: Vec::new(), gap_share: None };
    let mut list = vec![
        plain("unknown", unnamed),
        plain("none", bare * (1.0 - of_calibration)),
        plain("calibration", bare * of_calibration * (1.0 - of_shift)),
    ];
    if let Some(shift) = shift {
        let units = work.base.calibrated.hypothesis.nominal.units();
        list.push(EffectProbability {
            parameters: vec![ParameterEstimate {
                name: "torque",
                unit: dynamics::Quantity::Torque.unit(units).to_owned(),
                estimate: shift.torque,
            }],
            ..plain("constant_torque", bare * of_calibration * of_shift)
        });
    }
    for &candidate in candidates {
        let probability = marginal(weighed, candidate) * (1.0 - unnamed);
        let place = repaired.hypothesis.candidates.iter().position(|own| *own == candidate);
        if probability < 0.01 && place.is_none() {
            continue;
        }
        let best = weighed.iter().find(|w| w.fit.hypothesis.candidates.contains(&candidate));
        let source = if place.is_some() { Some(repaired) } else { best.map(|w| w.fit) };
        list.push(EffectProbability {
            id: candidate.id(),
            probability,
            parameters: source.map(|fit| parameters(work, fit, candidate)).unwrap_or_default(),
            gap_share: place.and_then(|place| shares.get(place)).map(|share| share.1),
        });
    }
    list.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    list
}

struct VerdictParts<'a> {
    named: &'a [Candidate],
    shares: &'a [(f64, Interval)],
    weighed: &'a [Weighed<'a>],
    unnamed: f64,
    calibrated_off: bool,
    shift: Option<Shift>,
    rivals: &'a [Rivalry],
    findings: &'a [Finding],
    gap: &'a crate::answer::Gap,
}

fn verdict(parts: VerdictParts<'_>) -> Verdict {
    let mut order: Vec<(Candidate, f64)> =
        parts.named.iter().copied().zip(parts.shares.iter().map(|share| share.0)).collect();
    order.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut effects: Vec<&'static str> = order.iter().map(|(candidate, _)| candidate.id()).collect();
    let mut equivalent: Vec<Vec<&'static str>> = Vec::new();
    for effect in &effects {
        let class: Vec<&'static str> = [*effect]
            .into_iter()
            .chain(
                parts
                    .rivals
                    .iter()
                    .filter(|rivalry| rivalry.effect == *effect && rivalry.distance < DISTINCT)
                    .map(|rivalry| rivalry.rival),
            )
            .collect();
        if class.len() > 1 {
            equivalent.push(class);
        }
    }
    let physical = !effects.is_empty();
    if !physical && parts.shift.is_some() && parts.unnamed <= 0.5 {
        effects.push("constant_torque");
        equivalent.push(vec!["constant_torque", "calibration"]);
    }
    for finding in parts.findings {
        effects.extend(finding.effect.filter(|id| !effects.contains(id)));
    }
    let set = parts
        .weighed
        .iter()
        .find(|w| w.fit.hypothesis.candidates == parts.named)
        .map_or(0.0, |w| w.probability);
    let status = if parts.unnamed > 0.5 {
        Status::Unknown
    } else if !effects.is_empty() {
        Status::Effect
    } else if parts.calibrated_off {
        Status::Calibration
    } else {
        Status::None
    };
    let confidence = if status == Status::Unknown { parts.unnamed } else { set * (1.0 - parts.unnamed) };
    let gap = parts.gap;
    let figures = format!(
        "{:.3e} {} recalibrated, {:.3e} after, noise floor {:.3e}",
        gap.recalibrated, gap.unit, gap.repaired, gap.noise_floor.value
    );
    let summary = match status {
        Status::None => format!("The nominal simulator explains the record down to its noise ({figures})."),
        Status::Calibration => {
            format!(
                "The nominal simulator's coefficients are off; recalibrated, nothing is missing ({figures})."
            )
        }
        Status::Effect => format!("The simulator lacks {} ({figures}).", effects.join(", ")),
        Status::Unknown => format!(
            "A torque without a name explains more than the vocabulary does ({figures}; {:.3e} with a free latent \
             torque).",
            gap.ceiling
        ),
    };
    Verdict { status, effects, confidence, equivalent, summary }
}

fn chain(
    records: &[Observations],
    kept: &[Vec<bool>],
    nominal: &Nominal,
    data: &Data,
    repaired: &Fit,
    noise: f64,
) -> MeasuringChain {
    let mut findings: Vec<Finding> = records
        .iter()
        .zip(kept)
        .flat_map(|(record, kept)| chain_statistics::findings(record, kept, nominal))
        .collect();
    findings.extend(chain_statistics::quantization(data, noise, nominal));
    let host = records.iter().any(|record| record.clock == ClockKind::Host);
    let known = findings.iter().any(|finding| finding.effect == Some("timestamp_jitter"));
    if host && !known {
        findings.extend(chain_statistics::noise_with_speed(data, repaired));
    }
    let first = records.first();
    MeasuringChain {
        clock: first.map_or("host", |record| record.clock.name()),
        sample_rate_hz: first.map_or(0.0, |record| record.sample_rate_hz),
        resolution: data.resolution,
        noise,
        findings,
    }
}

fn calibration(work: &Work<'_>, repaired: &Fit) -> Result<Vec<Calibrated>, DiagnosisError> {
    let base = &work.base.calibrated;
    let coefficients = base.hypothesis.nominal.coefficients();
    let all = [Coefficient::Inertia, Coefficient::Damping, Coefficient::Stiffness, Coefficient::RestAngle];
    Ok(all
        .into_iter()
        .map(|which| {
            let place = base.hypothesis.calibrated.iter().position(|own| *own == which);
            Calibrated {
                name: which.name(),
                nominal: which.of(&coefficients),
                recalibrated: place.map(|place| interval(base, place)),
                repaired: place.map(|place| interval(repaired, place)),
            }
        })
        .collect())
}

fn series(data: &Data, [nominal, recalibrated, repaired]: [&HeldOut; 3], paths: &[Path]) -> Series {
    let mut series = Series::default();
    for (segment, path) in data.segments.iter().zip(paths) {
        series.segment_starts.push(series.time_s.len());
        series.segment_records.push(segment.record);
        series.time_s.extend(&segment.times);
        series.observed.extend(&segment.values);
        series.position.extend(&path.motion.position);
        series.velocity.extend(&path.motion.velocity);
        series.input_torque.extend(&path.input);
    }
    let flat = |held: &HeldOut| held.residuals.iter().flat_map(|e| e.iter().copied()).collect();
    series.nominal_residual = flat(nominal);
    series.recalibrated_residual = flat(recalibrated);
    series.repaired_residual = flat(repaired);
    series
}
