//! Assembly of the answer: verdict, classes, shares, maps, the repaired simulator and the next experiment.

use super::{Judged, Measured, Refined, Remaining, Request};
use crate::answer::{Diagnosis, MeasuringChain, Series};
use crate::error::DiagnosisError;
use crate::evidence::context::Context;
use crate::evidence::held_out::HeldOut;
use crate::explain::attribution::budget;
use crate::explain::coefficients::{calibration, known};
use crate::explain::conclusion::{self, Parts, probabilities, verdict};
use crate::explain::gap::paired;
use crate::explain::repaired::repaired as repaired_simulator;
use crate::explain::{maps, next_experiment};
use crate::fit::fitted::Fit;
use crate::fit::levenberg_marquardt::{Moving, fit};
use crate::fit::stopping::Stopping;
use crate::linear::dictionary::Dictionary;
use crate::linear::tangent::Path;
use crate::measurement::{chain, encoder_hysteresis};
use crate::model::candidate::Candidate;
use crate::sets::shooting_interval::ShootingInterval;
use results::{BudgetShares, GapMaps, MapCell, SetRow};

/// Results of all stages before.
#[derive(Clone, Copy)]
struct All<'a> {
    request: Request<'a>,
    measured: &'a Measured,
    refined: &'a Refined,
    judged: &'a Judged<'a>,
    remaining: &'a Remaining,
}

/// Assembles the answer from the results of the stages before.
pub(crate) fn answer<'a>(
    request: Request<'a>,
    measured: &'a Measured,
    refined: &'a Refined,
    work: &'a Context<'a>,
    judged: &'a Judged<'a>,
    remaining: &'a Remaining,
) -> Result<Diagnosis, DiagnosisError> {
    let all = All { request, measured, refined, judged, remaining };
    let (repaired, complete) = (judged.held.repaired, remaining.complete(judged));
    let shares = work.shares(repaired);
    let (rivals, closest) = work.rivals(repaired);
    let measuring_chain = all.measuring_chain()?;
    let parts = Parts {
        work,
        candidates: &refined.candidates,
        repaired,
        unnamed: remaining.unnamed.as_ref(),
        shares: &shares,
        classes: &judged.classes,
        inclusion: &judged.inclusion,
        nameless: remaining.nameless,
        left_over: remaining.left_over,
        calibrated_off: refined.base.is_off(),
        shift: judged.shift,
        is_shifted: judged.is_shifted,
        rivals: &rivals,
        findings: &measuring_chain.findings,
    };
    let (effects, verdict) = (probabilities(&parts), verdict(&parts));
    let classes = conclusion::classes(&parts, &effects);
    let is_rounded = measuring_chain.findings.iter().any(|own| own.effect == Some("sensor_quantization"));
    let squares: Vec<f64> = shares.iter().map(|share| share.0).collect();
    Ok(Diagnosis {
        verdict,
        effects,
        classes,
        left_over: remaining.summary(),
        gap: remaining.gap.clone(),
        place: all.place(&squares)?,
        measuring_chain,
        calibration: calibration(work, complete),
        known: known(work, request.simulator, complete),
        repaired: all.repaired(is_rounded)?,
        detectability: work.detectability(repaired),
        next_experiment: all.next_experiment(closest),
        rivals,
        sets: all.sets(),
        rejected: refined
            .archive
            .rejected
            .iter()
            .map(|set| set.iter().map(|own| own.id()).collect())
            .collect(),
        series: all.series(),
        samples_used: measured.samples_used,
        stages: Vec::new(),
    })
}

impl All<'_> {
    fn after(&self) -> &HeldOut {
        self.remaining.after(self.judged)
    }

    fn complete(&self) -> &Fit {
        self.remaining.complete(self.judged)
    }

    /// Returns an experiment that would distinguish the set from its closest rival.
    fn next_experiment(&self, closest: Option<&Fit>) -> Option<crate::answer::Experiment> {
        let coarse = &self.refined.coarse.data;
        let finer = self.refined.data.samples() as f64 / coarse.samples().max(1) as f64;
        let noise = self.remaining.noise * (self.refined.time / finer).sqrt();
        let rival = closest.filter(|rival| !rival.hypothesis.candidates.is_empty())?;
        next_experiment::next(coarse, self.judged.held.repaired, rival, noise)
    }

    /// Returns the place of the gap: by class of cause, and over time, amplitude, phase and frequency.
    /// `squares` is the decrease of the sum of squares by each effect of the set.
    fn place(&self, squares: &[f64]) -> Result<GapMaps, DiagnosisError> {
        let Self { refined, judged, remaining, .. } = self;
        let (held, complete) = (&judged.held, self.complete());
        let noise = remaining.noise;
        let beyond = (self.after().mean_square() - noise * noise).max(0.0) * refined.data.samples() as f64;
        let named = held.repaired.hypothesis.candidates.iter().map(|own| own.class());
        let unnamed = remaining.unnamed.iter().map(|torque| (Candidate::UNNAMED.class(), torque.squares));
        let total: Vec<_> = named.zip(squares.iter().copied()).chain(unnamed).collect();
        let is_closer = paired(&held.recalibrated.residuals, &self.after().residuals) > 0.0;
        let budget = if remaining.excess > 0.0 && is_closer || remaining.nameless > 0.5 {
            let coarse = &refined.coarse.data;
            let point = complete.point.clone();
            let at = fit(coarse, &complete.hypothesis, point, Moving::All, Stopping::HELD_OUT)?;
            budget(&total, beyond, Dictionary::at(coarse, &at, &refined.candidates).ok().as_ref())
        } else {
            BudgetShares::default()
        };
        let rest = refined.data.facts.rest(&complete.point.globals, &complete.hypothesis);
        let (before, after) = (&held.recalibrated.residuals, &self.after().residuals);
        let [time, amplitude, phase, frequency]: [Vec<MapCell>; 4] =
            maps::maps(&refined.segments, &remaining.paths, rest, before, after, noise);
        Ok(GapMaps { budget, time, amplitude, phase, frequency })
    }

    fn measuring_chain(&self) -> Result<MeasuringChain, DiagnosisError> {
        let Self { request, measured, refined, judged, remaining, .. } = self;
        let fitted = remaining.fitted(judged);
        let (records, kept, segments) = (request.records, &measured.kept, &refined.segments);
        let mut chain = chain::chain(records, kept, request.simulator, segments, fitted, remaining.noise)?;
        chain.findings.extend(measured.findings.iter().cloned());
        chain.findings.extend(refined.hold.map(chain::between_samples));
        chain.findings.extend(encoder_hysteresis::finding(&refined.data, self.complete()));
        let is_known = |id: &str| request.simulator.effects().iter().any(|known| known.active.id() == id);
        for finding in &mut chain.findings {
            finding.effect = finding.effect.filter(|id| request.settings.considers(id) && !is_known(id));
        }
        chain.findings.extend(chain::not_followed(request.simulator, refined.data.quantity));
        Ok(chain)
    }

    fn repaired(&self, is_rounded: bool) -> Result<crate::answer::RepairedSimulator, DiagnosisError> {
        let refined = self.refined;
        let data = refined.data.clone();
        let own = ShootingInterval { by: refined.coarse.by, data, calibrated: self.complete().clone() };
        // If parts of long records were left out, the motion cannot be continued through them.
        let followed = if self.measured.is_whole { &refined.segments } else { &refined.data };
        repaired_simulator(own, followed, self.request.simulator, is_rounded, refined.hold)
    }

    fn sets(&self) -> Vec<SetRow> {
        let score = |w: &crate::sets::weights::Weighed<'_>| SetRow {
            effects: w.fit.hypothesis.ids().into_iter().map(str::to_owned).collect(),
            probability: w.probability,
            rms: (w.fit.squares / w.fit.freedom()).sqrt(),
            evidence: w.evidence,
        };
        self.judged.inclusion.sets.weighed.iter().map(score).collect()
    }

    fn series(&self) -> Series {
        let held = &self.judged.held;
        series(
            &self.refined.segments,
            [&held.nominal, &held.recalibrated, self.after()],
            &self.remaining.paths,
        )
    }
}

fn series(
    data: &crate::data::segments::Data,
    [nominal, recalibrated, repaired]: [&HeldOut; 3],
    paths: &[Path],
) -> Series {
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
