//! Data from the records: trusted samples, segments, and findings on the measurement chain.

use super::Request;
use crate::answer::Finding;
use crate::data::observations::Observations;
use crate::data::release;
use crate::data::segments::{Data, MOST_SEARCHED, cut};
use crate::error::DiagnosisError;
use crate::measurement::signatures;
use crate::model::hypothesis::WELL_DAMPED;
use dynamics::NominalSimulator;

/// Records, cut into segments.
pub(crate) struct Measured {
    /// Samples of each record that are not outliers. `free` marks those of them that come after its release.
    pub(crate) kept: Vec<Vec<bool>>,
    pub(crate) free: Vec<Vec<bool>>,
    pub(crate) data: Data,
    /// `true` if no segment was left out.
    pub(crate) is_whole: bool,
    /// Share of the samples that is used.
    pub(crate) samples_used: f64,
    pub(crate) findings: Vec<Finding>,
}

/// Maximum number of samples of a driven body that forgets its start: a hundred independent segments tell what all
/// of them do.
const MOST_FORGOTTEN: usize = 3000;

impl Measured {
    pub(crate) fn of(request: &Request<'_>) -> Result<Self, DiagnosisError> {
        let records = request.records;
        let kept: Vec<Vec<bool>> = records.iter().map(signatures::kept).collect();
        let (free, mut findings) = free(records, &kept);
        let all = cut(records, &free, request.simulator)?;
        findings.extend(signatures::without_motion(&free, all.samples()));
        let forgets = all.driven() && forgets(request.simulator);
        let most = if forgets { MOST_FORGOTTEN } else { MOST_SEARCHED };
        let sparser = all.sparser(MOST_SEARCHED);
        let data = sparser.thinned(most);
        let is_whole = data.samples() == sparser.samples();
        let samples_used = data.samples() as f64 / all.samples().max(1) as f64;
        Ok(Self { kept, free, data, is_whole, samples_used, findings })
    }
}

/// Returns `true` if a swing of the nominal simulator dies away within a segment. Its input alone then says where a
/// driven body is: segments are independent samples of the same law, and nothing accumulates from one to the next.
fn forgets(simulator: &NominalSimulator) -> bool {
    let nominal = simulator.nominal();
    let critical = 2.0 * nominal.inertia() * simulator.angular_frequency();
    critical > 0.0 && nominal.damping() > WELL_DAMPED * critical
}

/// Returns the kept samples of each record without those before its release, and the findings on the latter.
fn free(records: &[Observations], kept: &[Vec<bool>]) -> (Vec<Vec<bool>>, Vec<Finding>) {
    let mut findings = Vec::new();
    let free = records.iter().zip(kept).map(|(record, kept)| {
        let Some(until) = release::held_until(record) else { return kept.clone() };
        findings.push(release::finding(until));
        record.times_s.iter().zip(kept).map(|(time, kept)| *kept && *time >= until).collect()
    });
    (free.collect(), findings)
}
