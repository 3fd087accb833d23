//! From observations to an answer, stage by stage.

use crate::answer::{Budget, Cell, Diagnosis, Finding, MeasuringChain, Series, SetScore, Stage, Where};
use crate::budget::budget;
use crate::calibrate::better_hold;
use crate::candidate::Candidate;
use crate::coefficients::calibration;
use crate::conclusion::{Parts, probabilities, verdict};
use crate::dictionary::Dictionary;
use crate::error::DiagnosisError;
use crate::fit::{Effort, Fit, Moving, fit};
use crate::gap::{Stages, gap, paired};
use crate::held_out::HeldOut;
use crate::observations::Observations;
use crate::refine::refine;
use crate::search::{Breadth, search};
use crate::segments::{Data, MOST_SEARCHED, cut};
use crate::tangent::Path;
use crate::verdict::{significant, unknown, weigh};
use crate::work::{OFF_BY_CHANCE, Thin, Work};
use crate::{chain_statistics, experiment, latent, maps, noise, null};
use dynamics::Nominal;
use record::{ClockKind, Quantity};
use seed::Seed;

/// How to diagnose.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Probability with which an effect is named where there is none; 0.001 to 0.2.
    pub false_alarm: f64,
    /// Most effects named together, 1 to 5.
    pub most_effects: usize,
    /// Ids of effects that are not considered: a vocabulary with holes, for whoever knows that an effect is absent, and for
    /// trials of what is said where the cause has no name.
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

/// Sets that are fitted again on every sample.
const REFINED: usize = 10;
/// Diagnoses the gap between a nominal simulator and records of one system.
///
/// `seconds` is a stopwatch: it gives seconds since any moment. Costs are linear in the number of samples up to
/// 10,000; longer data are thinned by whole segments, and the answer states the share used. The same input gives the
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
        .filter(|candidate| settings.considers(candidate.id()))
        .filter(|candidate| {
            candidate.applies(&data.facts, data.quantity == Quantity::Position, nominal.stiffness() > 0.0)
        })
        .collect();
    let coarse = data.strided();
    let finer = data.samples() as f64 / coarse.samples().max(1) as f64;
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
    // On fewer samples a gain is so many times smaller; the search must not stop on that account.
    let found = search(&coarse, &coarse_base, &candidates, &breadth, 0.5 * threshold / finer);
    lap("search");
    let pool = refine(&data, &base.calibrated, &found, REFINED, finer);
    let time = pool.autocorrelation_time();
    let weighed = weigh(&pool, &base.calibrated, time, threshold, candidates.len());
    lap("fits");

    let thin = Thin { data: &coarse, calibrated: &coarse_base, pool: &found };
    let work = Work { data: &data, base: &base, pool: &pool, thin, time, settings };
    let shift = if settings.considers("constant_torque") { work.shift()? } else { None };
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
    let next_experiment = closest
        .filter(|rival| !rival.hypothesis.candidates.is_empty())
        .and_then(|rival| experiment::next(&coarse, repaired, rival, noise_coarse / finer.sqrt()));
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

    let mut measuring_chain = chain(records, &kept, nominal, &data, repaired, floor.value);
    for finding in &mut measuring_chain.findings {
        finding.effect = finding.effect.filter(|id| settings.considers(id));
    }
    let parts = Parts {
        work: &work,
        candidates: &candidates,
        repaired,
        named: &named,
        shares: &shares,
        weighed: &weighed,
        unnamed,
        calibrated_off,
        shift,
        rivals: &rivals,
        findings: &measuring_chain.findings,
        gap: &figures,
    };
    let (effects, verdict) = (probabilities(&parts), verdict(&parts));
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
    findings.extend(chain_statistics::frequencies(records));
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
