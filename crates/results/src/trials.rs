//! Results of withheld-effect trials: the content of `result.json`, `manifest.json` and `cases.csv`.
//!
//! A number that cannot be computed is not finite, and `null` in JSON.

use super::interval::{WithInterval, null_is_not_a_number, nulls_are_not_numbers};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The `schema` field of trials.
pub const TRIALS_SCHEMA: &str = "ringdown.trials/1";

/// The `schema` field of the manifest of trials.
pub const TRIALS_MANIFEST_SCHEMA: &str = "ringdown.trials-manifest/1";

/// Digests of records and truths, published before the first diagnosis.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct TrialsManifest {
    /// Always [`TRIALS_MANIFEST_SCHEMA`].
    pub schema: String,
    /// Name of the trials.
    pub name: String,
    /// Root seed of all random draws.
    pub seed: u64,
    /// Digest of the resolved configuration.
    pub config_digest: String,
    /// Banks that were requested but not made, with the reasons.
    pub left_out: Vec<LeftOutBank>,
    /// One line for each case, in the order in which the cases are made.
    pub cases: Vec<TrialsManifestLine>,
}

/// A case in the manifest.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct TrialsManifestLine {
    /// Id of the case.
    pub id: String,
    /// Folder below `cases` and `answers`: `full`, or `without-` followed by the effect that is not
    /// considered.
    pub group: String,
    /// SHA-256 of the sealed truth's text, prefixed `sha256:`.
    pub truth_digest: String,
    /// SHA-256 of each file given to the diagnosis.
    pub files: BTreeMap<String, String>,
}

/// A finished share of trials whose other shares are not finished.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct TrialsShare {
    /// Always [`super::RESULT_SCHEMA`].
    pub schema: String,
    /// Task of the run: `"trials-share"`.
    pub task: String,
    /// The share, such as `2/8`.
    pub shard: String,
    /// Number of cases in the trials.
    pub cases: usize,
    /// Number of cases without an answer yet; they belong to other shares.
    pub open: usize,
}

/// Share of independent cases that have a property.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Proportion {
    /// Number of cases with the property.
    pub count: u64,
    /// Number of all cases.
    pub of: u64,
    /// The share; not finite, in JSON `null`, if there are no cases.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub share: f64,
    /// 95 % interval by Clopper and Pearson.
    #[serde(deserialize_with = "nulls_are_not_numbers")]
    pub interval_95: [f64; 2],
}

/// Scores of a diagnosis on cases whose truth was sealed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TrialsResult {
    /// Always [`TRIALS_SCHEMA`].
    pub schema: String,
    /// Task of the run: `"trials"`.
    pub task: String,
    /// Name of the trials.
    pub name: String,
    /// Root seed of all random draws.
    pub seed: u64,
    /// Number of cases.
    pub cases: u64,
    /// Number of cases without an answer; they count as wrong.
    pub unanswered: u64,
    /// Banks that were not made, with the reasons.
    pub left_out: Vec<LeftOutBank>,
    /// Definition of a right answer for each kind of case.
    pub right_means: String,
    /// Acceptance bars, in the order of the document that defines them.
    pub bars: Vec<BarRow>,
    /// Bars of the configuration's gate; empty if it has none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub gate: Vec<BarRow>,
    /// Scores by effect and by class for banks with several effects at once; empty without such banks.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub inclusion: Vec<ClassScores>,
    /// Accuracy for each bank.
    pub banks: Vec<BankRow>,
    /// Accuracy for each bank, effect and size.
    pub effects: Vec<SizeRow>,
    /// Accuracy for each bank and size, all effects together.
    pub sizes: Vec<SizeRow>,
    /// Confusion matrix of hidden effect and first named effect.
    pub confusion: Confusion,
    /// Confusion matrix of hidden kind and kind of the answer.
    pub kinds: Confusion,
    /// Reliability of stated probabilities.
    pub reliability: Vec<Reliability>,
    /// Map from stated confidence to the share of right answers, fitted to the even cases of the own banks.
    pub map: ProbabilityMap,
    /// Separation of cases where `unknown` is right from cases where it is wrong.
    pub unknown: UnknownStudy,
    /// Held-out error over noise floor, for right answers that name an effect.
    pub ratio_to_floor: Quantiles,
    /// Coverage of the closure intervals, checked against the repaired simulator's closure on the clean
    /// motion.
    pub closure: ClosureStudy,
    /// Wall time of a diagnosis, in seconds.
    pub seconds_per_case: Quantiles,
    /// Share of cases in which a nuisance was named: an effect that records of every bank have.
    pub nuisances: Vec<NuisanceRow>,
    /// Simpler diagnosers on the same records.
    pub baselines: Vec<BaselineRow>,
    /// Cases answered wrongly or not at all.
    pub failures: Vec<FailureRow>,
    /// Wall time of the trials, in seconds; of scoring alone if existing answers were scored again.
    pub seconds: f64,
}

/// A bank that was not made.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct LeftOutBank {
    /// Name of the bank.
    pub bank: String,
    /// Reason for leaving it out.
    pub reason: String,
}

/// An acceptance bar and the measured value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BarRow {
    /// Name of the measure.
    pub metric: String,
    /// Smallest value that meets the bar, if there is one.
    pub at_least: Option<f64>,
    /// Largest value that meets the bar, if there is one.
    pub at_most: Option<f64>,
    /// Unit for display: empty for a ratio, `%` for a share. The numbers of a share are stored as shares, not
    /// in percent.
    pub unit: String,
    /// Measured value.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub value: f64,
    /// 95 % interval of the measured value.
    #[serde(deserialize_with = "nulls_are_not_numbers")]
    pub interval_95: [f64; 2],
    /// Number of cases behind the value.
    pub cases: u64,
    /// `met`, `not met` or `not measured here`.
    pub state: String,
    /// `true` if the whole interval lies on the wrong side of the bar.
    pub missed_beyond_chance: bool,
}

/// Scores by effect and by class for a group of cases. Effects that act alike form one class. If a nuisance
/// of the logger or a law outside the vocabulary belongs to a class, naming that class counts neither for nor
/// against an answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ClassScores {
    /// Group of cases: a bank, or a part of one.
    pub banks: String,
    /// Number of cases.
    pub cases: u64,
    /// Share of cases in which the class of the largest hidden effect is named.
    pub leading_named: Proportion,
    /// Share of cases in which the stated probability of that class is 0.9 or more.
    pub leading_sure: Proportion,
    /// Share of cases with hidden effects in which the named classes are exactly those that act.
    pub set: Proportion,
    /// Share of hidden effects whose class is named, by size.
    pub recall: Vec<RecallRow>,
    /// Share of named effects whose class acts.
    pub precision: Proportion,
    /// Share of the attributed gap that is attributed to classes that act, over answers that attribute any.
    pub attributed: Quantiles,
    /// Share of cases with a law outside the vocabulary acting alone whose answer is `unknown` or a class
    /// that the truth allows.
    pub unknown: Proportion,
    /// Share of cases with nothing missing whose answer names an effect or `unknown`.
    pub false_alarms: Proportion,
    /// Recall and precision by class.
    pub classes: Vec<InclusionRow>,
    /// Recall and precision by effect.
    pub effects: Vec<InclusionRow>,
}

/// Recall of hidden effects in a range of sizes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RecallRow {
    /// Lower and upper end of the range, × noise; the upper end of the last range is `null`.
    #[serde(deserialize_with = "nulls_are_not_numbers")]
    pub floors: [f64; 2],
    /// Share of these effects whose class is named.
    pub named: Proportion,
}

/// Recall and precision of an effect or a class.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InclusionRow {
    /// Id of the effect or class.
    pub id: String,
    /// Share of the cases in which it acts that name it.
    pub recall: Proportion,
    /// Share of the cases that name it in which it acts.
    pub precision: Proportion,
    /// Mean stated probability over cases in which it acts; `null` if there are none.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub stated_where_it_acts: f64,
    /// Mean stated probability over cases in which it does not act.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub stated_where_it_does_not: f64,
}

/// Accuracy on one bank.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BankRow {
    /// Name of the bank.
    pub bank: String,
    /// Share of cases with the right status and set of effects.
    pub right: Proportion,
    /// Share of cases whose first named effect is hidden. Without a hidden effect: nothing named, or
    /// `unknown` if that is the right answer.
    pub top_1: Proportion,
    /// Share of cases whose first named effect is hidden or, by the answer itself, indistinguishable from a
    /// hidden one.
    pub class: Proportion,
    /// Share of cases with two hidden effects in which both are named.
    pub both: Proportion,
    /// Share of cases with two hidden effects in which at least one is named.
    pub either: Proportion,
    /// Share of cases with nothing missing whose answer names an effect or `unknown`.
    pub false_alarms: Proportion,
}

/// Accuracy at one size.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SizeRow {
    /// Name of the bank.
    pub bank: String,
    /// First hidden effect; empty for all effects together.
    pub effect: String,
    /// Size, × noise, that represents the range; for a pair, of the smaller effect.
    pub size: f64,
    /// Range of sizes; the upper end of the last range is `null`.
    #[serde(deserialize_with = "nulls_are_not_numbers")]
    pub range: [f64; 2],
    /// Share with the right effect named first, as in [`BankRow::top_1`].
    pub top_1: Proportion,
    /// Share with the right class named first, as in [`BankRow::class`].
    pub class: Proportion,
    /// Share of pairs in which both effects are named, as in [`BankRow::both`].
    pub both: Proportion,
}

/// Confusion matrix: counts of truths against answers.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Confusion {
    /// Names of the rows: truths.
    pub hidden: Vec<String>,
    /// Names of the columns: answers.
    pub said: Vec<String>,
    /// Counts, one vector for each row.
    pub counts: Vec<Vec<u64>>,
}

/// Reliability of stated probabilities.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Reliability {
    /// Kind of probability: `confidence`, `confidence, mapped`, `confidence, not mapped`, `effects` or
    /// `classes`.
    pub subject: String,
    /// Banks: `own`, `own, not fitted`, `stressed`, `measured and engine`, or a group of
    /// [`ClassScores::banks`].
    pub banks: String,
    /// Number of probabilities.
    pub count: u64,
    /// Expected calibration error over bins of equal count, with a 95 % interval from a bootstrap over cases.
    pub calibration_error: WithInterval,
    /// Average of that error for the same number of probabilities that are exactly right.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub calibration_error_by_chance: f64,
    /// Brier score: mean square of probability minus outcome.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub brier: f64,
    /// Bins of equal count, at most ten.
    pub bins: Vec<ReliabilityBin>,
}

/// A bin of probabilities.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReliabilityBin {
    /// Smallest and largest probability in the bin.
    pub range: [f64; 2],
    /// Mean probability in the bin.
    pub stated: f64,
    /// Share of the statements in the bin that were true.
    pub found: Proportion,
}

/// A map from stated probabilities to observed shares.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ProbabilityMap {
    /// Method that fitted the map.
    pub method: String,
    /// Pairs of stated probability and observed share, increasing; linear between them, constant beyond them.
    pub knots: Vec<[f64; 2]>,
    /// Number of cases that the map was fitted to.
    pub fitted_to: u64,
}

/// Separation of cases where `unknown` is right from cases where it is wrong.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct UnknownStudy {
    /// Areas under the curve: all sizes together first, then by size.
    pub areas: Vec<AreaRow>,
    /// Receiver operating characteristic: shares of negatives (false alarms) and of positives (hits) above
    /// each threshold.
    pub curve: Vec<[f64; 2]>,
}

/// An area under the receiver operating characteristic.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AreaRow {
    /// Size, × noise; `null` for all sizes together.
    pub size: Option<f64>,
    /// Number of cases where `unknown` is right.
    pub positives: u64,
    /// Number of cases where `unknown` is wrong.
    pub negatives: u64,
    /// Area with its 95 % interval.
    pub area: WithInterval,
}

/// Quantiles of a sample.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Quantiles {
    /// Size of the sample.
    pub count: u64,
    /// Median with its 95 % interval by order statistics.
    pub median: WithInterval,
    /// 95 % quantile.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub quantile_95: f64,
    /// Largest value.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub worst: f64,
}

/// Coverage of the closure intervals.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ClosureStudy {
    /// Definition of the true closure.
    pub means: String,
    /// Share of intervals that contain the true closure.
    pub coverage: Proportion,
    /// Number of cases in which the true closure lies below the interval.
    pub below: u64,
    /// Number of cases in which the true closure lies above the interval.
    pub above: u64,
    /// Number of cases left out, by reason.
    pub left_out: BTreeMap<String, u64>,
}

/// Share of cases in which one nuisance was named: an effect that records of every bank have.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NuisanceRow {
    /// Id of the effect.
    pub id: String,
    /// Share of the answered cases with the effect that name it.
    pub named: Proportion,
}

/// Scores of a simpler diagnoser.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BaselineRow {
    /// Id of the diagnoser.
    pub id: String,
    /// Method as a sentence.
    pub method: String,
    /// Share of cases with the right effect named first, on the bank of single effects.
    pub top_1: Proportion,
    /// The same share for the diagnosis on the same cases.
    pub diagnosis: Proportion,
    /// Share of cases with nothing missing in which something was named.
    pub false_alarms: Proportion,
    /// Share of cases with the right effect named first by size, on the bank of single effects.
    pub sizes: Vec<SizeRow>,
}

/// A case answered wrongly or not at all.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FailureRow {
    /// Id of the case.
    pub id: String,
    /// Name of its bank.
    pub bank: String,
    /// Hidden effects, or the law outside the vocabulary that acts.
    pub hidden: String,
    /// Answer, or the reason for a missing one.
    pub said: String,
    /// Size of the hidden effect, × noise; for a pair, of the smaller effect.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub size: f64,
    /// `true` if the answer states that the named and the hidden effect are indistinguishable.
    pub same_class: bool,
    /// Command that diagnoses this case alone again.
    pub command: String,
}

/// One row of `cases.csv`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TrialCaseRow {
    /// Id of the case.
    pub id: String,
    /// Name of its bank.
    pub bank: String,
    /// Hidden effects, joined by `+`.
    pub hidden: String,
    /// Sizes of the hidden effects, × noise, joined by `+`.
    pub size: String,
    /// Status of the answer; `no answer` if there is none.
    pub status: String,
    /// Named effects without nuisances, best first, joined by `+`.
    pub named: String,
    /// Stated joint probability of status and set of effects.
    pub confidence: Option<f64>,
    /// Stated probability of `unknown`.
    pub unknown: Option<f64>,
    /// `true` if status and set of effects are right.
    pub right: bool,
    /// `true` if the first named effect is right.
    pub top_1: bool,
    /// `true` if the first named effect is right or in one class with the right one.
    pub class: bool,
    /// Held-out error over the noise floor.
    pub ratio_to_floor: Option<f64>,
    /// Stated closure of the gap.
    pub closure: Option<f64>,
    /// Lower end of the closure's interval.
    pub closure_low: Option<f64>,
    /// Upper end of the closure's interval.
    pub closure_high: Option<f64>,
    /// Closure of the repaired simulator on the clean motion.
    pub true_closure: Option<f64>,
    /// Held-out error over that of the set that is there, fitted from the truth (regret).
    #[serde(default)]
    pub regret: Option<f64>,
    /// Wall time of the diagnosis, in seconds.
    pub seconds: Option<f64>,
}
