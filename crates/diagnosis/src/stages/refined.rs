//! Best sets on every sample, fitted to convergence.

use super::{Question, Request, Searched};
use crate::data::segments::Data;
use crate::error::DiagnosisError;
use crate::evidence::context::{Context, Thin, Unjoined};
use crate::fit::calibrate::Baseline;
use crate::fit::fitted::Point;
use crate::fit::levenberg_marquardt::{Moving, fit};
use crate::fit::stopping::Stopping;
use crate::model::candidate::Candidate;
use crate::search::alternatives::alternatives;
use crate::search::asked::Asked;
use crate::search::beam::search;
use crate::search::nameless::nameless;
use crate::search::refine::refine;
use crate::sets::archive::Archive;
use crate::sets::shooting_interval::ShootingInterval;
use crate::sets::weights::{Weighed, Weighing};
use dynamics::Hold;

/// Results of all fits, on the unjoined segments and on the shooting interval that the best sets follow.
pub(crate) struct Refined {
    pub(crate) candidates: Vec<Candidate>,
    /// Unjoined segments.
    pub(crate) segments: Data,
    segments_base: Baseline,
    /// Behavior of the inputs between their samples, of which these data keep only some.
    pub(crate) hold: Option<Hold>,
    /// Segments joined to the shooting interval.
    pub(crate) data: Data,
    pub(crate) base: Baseline,
    /// Shooting interval with the coarse samples, on which the sets were found.
    pub(crate) coarse: ShootingInterval,
    found: Archive,
    /// Sets fitted on every sample.
    pub(crate) archive: Archive,
    /// Autocorrelation time, in samples, of the residual of the closest set.
    pub(crate) time: f64,
}

impl Refined {
    pub(crate) fn of(question: Question, searched: Searched) -> Result<Self, DiagnosisError> {
        let hold = question.hold();
        let Question { data, base: segments_base, candidates, proposed, enough, .. } = question;
        let Searched { interval: coarse, mut found, most_effects } = searched;
        let closest = found.ranked(found.autocorrelation_time());
        let closest = closest.first().map_or(&coarse.calibrated, |best| *best);
        let segments = data.with_fewer_knots(data.joined(coarse.by).spare_knots(closest));
        let data = segments.joined(coarse.by);
        let base = followed(&data, &Unjoined { data: &segments, base: &segments_base }, &coarse)?;
        let vocabulary = candidates.len();
        alternatives(&coarse.data, &coarse.calibrated, &mut found, &candidates, vocabulary);
        nameless(&coarse.data, &coarse.calibrated, &mut found, vocabulary);
        let weighing = Weighing::of(&coarse.data, &coarse.calibrated, &found, vocabulary);
        let known = Archive::of(&base.calibrated);
        let mut archive = refine(&data, &known, &weighing.weigh(&found), &found.rejected, &candidates);
        if let Some((known, others)) = found.misled(&archive, &candidates) {
            let asked = Asked {
                data: &coarse.data,
                calibrated: &coarse.calibrated,
                candidates: &others,
                proposed: &proposed,
                most_effects,
                threshold: enough,
            };
            found = search(&asked, known).archive;
            let weighing = Weighing::of(&coarse.data, &coarse.calibrated, &found, vocabulary);
            archive = refine(&data, &archive, &weighing.weigh(&found), &found.rejected, &others);
        }
        let time = archive.autocorrelation_time();
        Ok(Self { candidates, segments, segments_base, hold, data, base, coarse, found, archive, time })
    }

    /// Returns the context shared by the later stages.
    pub(crate) fn context<'a>(&'a self, request: &Request<'a>) -> Context<'a> {
        let (data, calibrated) = (&self.coarse.data, &self.coarse.calibrated);
        Context {
            data: &self.data,
            base: &self.base,
            segments: Unjoined { data: &self.segments, base: &self.segments_base },
            pool: &self.archive,
            thin: Thin { data, calibrated, pool: &self.found },
            time: self.time,
            settings: request.settings,
        }
    }

    /// Returns the sets by their evidence on the fitted samples, best first.
    pub(crate) fn weighed(&self) -> Vec<Weighed<'_>> {
        let weighing = Weighing::of(&self.data, &self.base.calibrated, &self.archive, self.candidates.len());
        weighing.weigh(&self.archive)
    }
}

/// Fits the nominal and the recalibrated simulator on every sample of a shooting interval.
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
