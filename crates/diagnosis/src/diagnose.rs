//! From observations to an answer, stage by stage.

use crate::answer::{
    Budget, Cell, Diagnosis, Finding, LeftOver, MeasuringChain, Series, SetScore, Stage, Where,
};
use crate::data::observations::Observations;
use crate::data::release;
use crate::data::segments::{Data, MOST_SEARCHED, cut};
use crate::data::shooting_interval::ShootingInterval;
use crate::error::DiagnosisError;
use crate::evidence::conclusion::{self, Parts, likely, probabilities, verdict};
use crate::evidence::context::{Context, Thin, Unjoined};
use crate::evidence::discrepancy;
use crate::evidence::half_swings::half_swings;
use crate::evidence::held_out::HeldOut;
use crate::evidence::inclusion::{Inclusion, asked};
use crate::evidence::left_over::unexplained;
use crate::evidence::weights::{Weighing, acts, unknown};
use crate::explain::attribution::budget;
use crate::explain::coefficients::{calibration, known};
use crate::explain::gap::{Stages, gap, paired};
use crate::explain::position_torque::unnamed;
use crate::explain::repaired::repaired as repaired_simulator;
use crate::explain::{maps, next_experiment};
use crate::fit::calibrate::{Baseline, better_hold};
use crate::fit::levenberg_marquardt::{Fit, Moving, Point, Stopping, fit};
use crate::measurement::{encoder_hysteresis, signatures};
use crate::model::candidate::Candidate;
use crate::model::dictionary::Dictionary;
use crate::model::tangent::Path;
use crate::noise::floor as noise;
use crate::search::alternatives::alternatives;
use crate::search::archive::Archive;
use crate::search::beam::{Breadth, search};
use crate::search::null;
use crate::search::plain::plain_family;
use crate::search::refine::refine;
use dynamics::{DynamicsError, KnownEffect, Nominal, NominalSimulator};
use record::{ClockKind, Quantity};
use seed::Seed;
use std::cell::OnceCell;

/// How to diagnose.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Probability with which an effect is named where there is none; 0.001 to 0.2.
    pub false_alarm: f64,
    /// Most effects named together, 1 to 5.
    pub most_effects: usize,
    /// Ids of effects that are not considered: a vocabulary with holes, for whoever knows that an effect is
    /// absent, and for trials of what is said where the cause has no name.
    pub without: Vec<String>,
    /// Randomness of the bootstraps.
    pub seed: Seed,
}

impl Settings {
    pub(crate) fn considers(&self, id: &str) -> bool {
        !self.without.iter().any(|other| other == id)
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self { false_alarm: 0.01, most_effects: 3, without: Vec::new(), seed: Seed::new(0) }
    }
}

/// Most effects that a set can hold.
const MOST_EFFECTS: usize = 5;

/// Error over the white noise floor beyond which what is left is no noise. An autoregressive noise of first
/// order stays below it up to a correlation of 0.84 from sample to sample.
const FAR_ABOVE: f64 = 3.0;

/// Log evidence by which the set of all likely classes may predict worse than the best set of some of them.
const WORSE: f64 = 3.0;

/// Searches on longer horizons at most.
const MOST_HORIZONS: usize = 3;

/// Diagnoses the gap between a nominal simulator and records of one system.
///
/// `seconds` is a stopwatch: it gives seconds since any moment. Costs are linear in the number of samples up to
/// 20,000; of more, every so many are taken or whole segments are left out, and the answer states the share used. The
/// same input gives the same bits with any number of threads (times apart).
///
/// `simulator` is the nominal oscillator, alone or with effects that it has already: these are part of every hypothesis
/// and no candidates.
///
/// # Errors
/// [`DiagnosisError`] for records that say nothing, or that are not of this system.
pub fn diagnose(
    records: &[Observations],
    simulator: impl Into<NominalSimulator>,
    settings: &Settings,
    seconds: &dyn Fn() -> f64,
) -> Result<Diagnosis, DiagnosisError> {
    let simulator = &simulator.into();
    let mut stages = Vec::new();
    let mut last = seconds();
    let mut lap = |name: &'static str| {
        let now = seconds();
        stages.push(Stage { name, seconds: now - last });
        last = now;
    };
    let kept: Vec<Vec<bool>> = records.iter().map(signatures::kept).collect();
    let (free, unreleased) = free(records, &kept);
    let all = cut(records, &free, simulator)?;
    let unseen = signatures::without_motion(&free, all.samples());
    let sparser = all.sparser(MOST_SEARCHED);
    let data = sparser.thinned(MOST_SEARCHED);
    let is_whole = data.samples() == sparser.samples();
    let samples_used = data.samples() as f64 / all.samples().max(1) as f64;
    lap("measuring chain");
    let (data, base) = better_hold(&data, simulator)?;
    let data = data.for_noise(noise::floor(&data, &base.calibrated.residuals).value);
    lap("calibration");

    let mut candidates = Candidate::that_apply(&data.facts, data.quantity, simulator);
    candidates.retain(|candidate| settings.considers(candidate.id()));
    let coarse = data.averaged(data.spare_knots(&base.calibrated)).strided();
    let finer = data.samples() as f64 / coarse.samples().max(1) as f64;
    let coarse_base = fit(
        &coarse,
        &base.calibrated.hypothesis,
        base.calibrated.point.clone(),
        Moving::All,
        Stopping::FINAL,
    )?;
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
    // On fewer samples a gain is so many times smaller; the search must not stop on that account.
    let enough = 0.5 * threshold / finer;
    let (horizon, mut found) = explore(&coarse, &coarse_base, &candidates, &breadth, enough, is_whole);
    plain_family(&horizon.data, &horizon.calibrated, &candidates, &mut found);
    lap("search");
    let found_best =
        found.ranked(found.autocorrelation_time()).first().map_or(&horizon.calibrated, |best| *best);
    let knots = data.joined(horizon.by).spare_knots(found_best);
    let data = data.averaged(knots);
    let segments = Unjoined { data: &data, base: &base };
    let data = &data.joined(horizon.by);
    let base = &followed(data, &segments, &horizon)?;
    let (coarse, coarse_base) = (&horizon.data, &horizon.calibrated);
    let vocabulary = candidates.len();
    alternatives(coarse, coarse_base, &mut found, &candidates, vocabulary);
    let weighing = Weighing::of(coarse, coarse_base, &found, vocabulary);
    let sets = weighing.weigh(&found);
    let mut pool = refine(data, &Archive::of(&base.calibrated), &sets, &found.rejected, &candidates);
    if let Some((known, others)) = found.misled(&pool, &candidates) {
        found = search(coarse, coarse_base, known, &others, &breadth, enough);
        let weighing = Weighing::of(coarse, coarse_base, &found, vocabulary);
        pool = refine(data, &pool, &weighing.weigh(&found), &found.rejected, &others);
    }
    let time = pool.autocorrelation_time();
    let weighing = Weighing::of(data, &base.calibrated, &pool, vocabulary);
    let fitted = weighing.weigh(&pool);
    lap("fits");
    let completed = OnceCell::new();
    let thin = Thin { data: coarse, calibrated: coarse_base, pool: &found };
    let work = Context { data, base, segments, pool: &pool, thin, time, settings };
    let mut predictions = work.predictions(&asked(&fitted))?;
    let bare = pool.find(&[]).unwrap_or(&base.calibrated);
    let inclusion = Inclusion::of(segments.data, &predictions, bare, vocabulary);
    let swings = half_swings(records, &free, simulator.angular_frequency());
    let classes = inclusion.classes(swings.as_ref().map(|own| &own.witness), &settings.seed);
    let names = likely(&classes);
    let within = inclusion.within(&names);
    let mut chosen = within.map(|w| w.fit.hypothesis.candidates.clone()).unwrap_or_default();
    if let Some(fit) = inclusion.completed(data, &names) {
        let least = within.map_or(0.0, |w| w.evidence) - WORSE;
        let set = work.predicted(completed.get_or_init(|| fit));
        if let Some(set) = set.filter(|set| inclusion.evidence(segments.data, set) > least) {
            chosen.clone_from(&set.followed.hypothesis.candidates);
            predictions.sets.push(set);
        }
    }
    let held = work.held_out(predictions, &chosen)?;
    let repaired = held.repaired;
    let shift = if settings.considers("constant_torque") { work.shift(repaired) } else { None };
    lap("held out");
    let unnamed = unnamed(&work, &held)?;
    let (complete, fitted, after, later) = match &unnamed {
        Some(torque) => (&torque.followed, &torque.fitted, &torque.after, torque.last_third),
        None => (repaired, &held.fitted, &held.after, held.last_third[1]),
    };
    lap("unnamed torque");
    let floors = noise::squares(segments.data, &fitted.residuals);
    let floor = noise::of_squares(&floors);
    let paths = Path::of(segments.data, fitted)?;
    let ceiling = discrepancy::ceiling(segments.data, fitted, &paths)?;
    lap("latent torque");
    let unit = records.first().map_or("", |record| record.unit);
    let figures = gap(
        &Stages {
            nominal: &held.nominal,
            recalibrated: &held.recalibrated,
            repaired: after,
            ceiling: &ceiling,
        },
        (floor, &floors),
        [held.last_third[0], later],
        unit,
    );
    lap("gap");

    let left_over_of_gap =
        LeftOver { share_of_gap: 1.0 - figures.closure.value, over_noise: figures.ratio_to_floor.value };
    let noise_square = floor.value * floor.value;
    let excess = figures.recalibrated.powi(2) - noise_square;
    let left = unexplained(data, repaired)?;
    let gained = (base.calibrated.squares - repaired.squares).max(0.0);
    let mut nameless = left.squares / (left.squares + gained).max(f64::MIN_POSITIVE);
    let mut evidence = left.evidence;
    if let Some(torque) = &unnamed {
        nameless = nameless.max(torque.share.value);
        evidence = evidence.max(torque.evidence);
    }
    let with_names = held.after.mean_square();
    if with_names > (FAR_ABOVE * floor.value).powi(2) {
        // No noise is so smooth: whatever its spectrum is, it is a part of the gap.
        nameless = nameless.max((with_names - noise_square) / excess.max(f64::MIN_POSITIVE));
        evidence = f64::INFINITY;
    }
    let left_over = acts(evidence);
    let nameless = unknown(left_over, nameless.min(1.0));
    lap("unexplained");

    let named: Vec<Candidate> = repaired.hypothesis.candidates.clone();
    let shares = work.shares(repaired);
    let calibrated_off = base.is_off();

    let (rivals, closest) = work.rivals(repaired);
    let detectability = work.detectability(repaired);
    let noise_coarse = floor.value * time.sqrt();
    let next_experiment = closest
        .filter(|rival| !rival.hypothesis.candidates.is_empty())
        .and_then(|rival| next_experiment::next(coarse, repaired, rival, noise_coarse / finer.sqrt()));
    lap("identifiability");

    let beyond = (after.mean_square() - noise_square).max(0.0) * data.samples() as f64;
    let at_repaired = Dictionary::at(coarse, &refit(coarse, complete)?, &candidates).ok();
    let total = named.iter().copied().map(Candidate::class).zip(shares.iter().map(|share| share.0));
    let total = total.chain(unnamed.iter().map(|torque| (Candidate::UNNAMED.class(), torque.squares)));
    let worthwhile =
        excess > 0.0 && paired(&held.recalibrated.residuals, &after.residuals) > 0.0 || nameless > 0.5;
    let budget = if worthwhile {
        budget(&total.collect::<Vec<_>>(), beyond, at_repaired.as_ref())
    } else {
        Budget::default()
    };
    let rest = data.facts.rest(&complete.point.globals, &complete.hypothesis);
    let [over_time, amplitude, phase, frequency]: [Vec<Cell>; 4] =
        maps::maps(segments.data, &paths, rest, &held.recalibrated.residuals, &after.residuals, floor.value);
    lap("maps");

    let mut measuring_chain = chain(records, &kept, &seen(simulator)?, segments.data, fitted, floor.value);
    let behind = encoder_hysteresis::finding(data, complete);
    measuring_chain.findings.extend(unreleased.into_iter().chain(unseen).chain(behind));
    let is_known = |id: &str| simulator.effects().iter().any(|known| known.active.id() == id);
    for finding in &mut measuring_chain.findings {
        finding.effect = finding.effect.filter(|id| settings.considers(id) && !is_known(id));
    }
    measuring_chain.findings.extend(not_followed(simulator, data.quantity));
    let parts = Parts {
        work: &work,
        candidates: &candidates,
        repaired,
        unnamed: unnamed.as_ref(),
        shares: &shares,
        classes: &classes,
        inclusion: &inclusion,
        nameless,
        left_over,
        calibrated_off,
        shift,
        rivals: &rivals,
        findings: &measuring_chain.findings,
    };
    let (effects, verdict) = (probabilities(&parts), verdict(&parts));
    let classes = conclusion::classes(&parts, &effects);
    let calibration = calibration(&work, complete);
    let is_rounded = measuring_chain.findings.iter().any(|own| own.effect == Some("sensor_quantization"));
    let own = ShootingInterval { by: horizon.by, data: data.clone(), calibrated: complete.clone() };
    // Parts that were left out of long records have nothing to go on through.
    let followed = if is_whole { segments.data } else { data };
    let repaired = repaired_simulator(own, followed, simulator, is_rounded)?;
    let series = series(segments.data, [&held.nominal, &held.recalibrated, after], &paths);
    let sets = inclusion
        .weighed
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
        classes,
        left_over: left_over_of_gap,
        gap: figures,
        place: Where { budget, time: over_time, amplitude, phase, frequency },
        measuring_chain,
        calibration,
        known: known(&work, simulator, complete),
        repaired,
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

/// Searches on the longest horizon on which the recalibrated simulator is a model to begin at, and goes on to
/// longer ones for as long as what was found follows the motion there.
fn explore(
    segments: &Data,
    calibrated: &Fit,
    candidates: &[Candidate],
    breadth: &Breadth,
    threshold: f64,
    is_whole: bool,
) -> (ShootingInterval, Archive) {
    let begin = |horizon: &ShootingInterval| {
        search(&horizon.data, &horizon.calibrated, Vec::new(), candidates, breadth, threshold)
    };
    let shortest = ShootingInterval::shortest(segments, calibrated);
    // Parts that were left out of long records have nothing to go on through.
    if !is_whole {
        let pool = begin(&shortest);
        return (shortest, pool);
    }
    let mut horizon = ShootingInterval::longest(segments, calibrated);
    let mut pool = begin(&horizon);
    if horizon.by > 1 && !horizon.is_followed(segments, &pool) {
        pool = begin(&shortest);
        horizon = shortest;
    }
    for _ in 0..MOST_HORIZONS {
        let Some((longer, sets)) = horizon.beyond(segments, &pool) else { break };
        pool = search(&longer.data, &longer.calibrated, sets, candidates, breadth, threshold);
        horizon = longer;
    }
    (horizon, pool)
}

/// The given and the recalibrated simulator on every sample of a horizon.
fn followed(
    data: &Data,
    segments: &Unjoined<'_>,
    horizon: &ShootingInterval,
) -> Result<Baseline, DiagnosisError> {
    if horizon.by == 1 {
        return Ok(segments.base.clone());
    }
    let hypothesis = &segments.base.nominal.hypothesis;
    let firsts = data.firsts();
    let starts = firsts.iter().filter_map(|&first| segments.base.nominal.point.starts.get(first).cloned());
    let point = Point { globals: hypothesis.nominal_point(), starts: starts.collect() };
    let nominal = fit(data, hypothesis, point, Moving::Starts, Stopping::FINAL)?;
    let point = horizon.calibrated.point.clone();
    let calibrated = fit(data, hypothesis, point, Moving::All, Stopping::FINAL)?;
    Ok(Baseline { nominal, calibrated })
}

/// The samples that are kept of each record, less those before its release; and what is said of these.
fn free(records: &[Observations], kept: &[Vec<bool>]) -> (Vec<Vec<bool>>, Vec<Finding>) {
    let mut findings = Vec::new();
    let free = records.iter().zip(kept).map(|(record, kept)| {
        let Some(until) = release::held_until(record) else { return kept.clone() };
        findings.push(release::finding(until));
        record.times_s.iter().zip(kept).map(|(time, kept)| *kept && *time >= until).collect()
    });
    (free.collect(), findings)
}

fn refit(data: &Data, found: &Fit) -> Result<Fit, DiagnosisError> {
    Ok(fit(data, &found.hypothesis, found.point.clone(), Moving::All, Stopping::HELD_OUT)?)
}

/// The nominal oscillator with the sensor's step, also where the simulator states that as an effect.
fn seen(simulator: &NominalSimulator) -> Result<Nominal, DynamicsError> {
    let nominal = *simulator.nominal();
    let steps = simulator.effects().iter().filter(|known| known.active.id() == "sensor_quantization");
    match steps.filter_map(|known| known.active.value("step")).next() {
        Some(step) if nominal.sensor_resolution().is_none() => nominal.with_sensor_resolution(step),
        _ => Ok(nominal),
    }
}

/// Words on effects of the nominal simulator that no fit follows.
fn not_followed(simulator: &NominalSimulator, quantity: Quantity) -> Vec<Finding> {
    let followed = |known: &&KnownEffect| {
        Candidate::of(&known.active).is_some_and(|(own, _)| own.is_observed_in(quantity))
    };
    let others = simulator.effects().iter().filter(|known| !followed(known));
    others
        .map(|known| Finding {
            effect: None,
            text: format!(
                "the nominal simulator has {}: it is taken as known, and shows in stamps and values as they are",
                known.active.id()
            ),
        })
        .collect()
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
        .flat_map(|(record, kept)| signatures::findings(record, kept, nominal))
        .collect();
    findings.extend(signatures::quantization(data, noise, nominal));
    findings.extend(signatures::frequencies(records));
    let host = records.iter().any(|record| record.clock == ClockKind::Host);
    let known = findings.iter().any(|finding| finding.effect == Some("timestamp_jitter"));
    if host && !known {
        findings.extend(signatures::noise_with_speed(data, repaired));
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

#[cfg(test)]
mod tests {
    use super::FAR_ABOVE;

    /// Second differences of an autoregressive noise of unit variance have the variance 6 − 8ρ + 2ρ².
    #[test]
    fn colored_noise_stays_below_what_is_no_noise() {
        let over_floor = |rho: f64| (6.0 / (6.0 - 8.0 * rho + 2.0 * rho * rho)).sqrt();
        assert!(over_floor(0.84) < FAR_ABOVE && over_floor(0.85) > FAR_ABOVE);
    }
}
