//! Trials on records whose effect is withheld: the content of their `result.json`, `manifest.json` and `cases.csv`.
//!
//! A number that could not be had is not finite, and `null` in JSON.

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
    /// Root of every random draw.
    pub seed: u64,
    /// Digest of the resolved configuration.
    pub config_digest: String,
    /// Banks that were asked for and not made, and why.
    pub left_out: Vec<LeftOutBank>,
    /// One line a case, in the order in which cases are made.
    pub cases: Vec<TrialsManifestLine>,
}

/// A case in the manifest.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct TrialsManifestLine {
    /// The case.
    pub id: String,
    /// Folder below `cases` and `answers`: `full`, or `without-` and the effect not considered.
    pub group: String,
    /// SHA-256 of the sealed truth's text, prefixed `sha256:`.
    pub truth_digest: String,
    /// SHA-256 of each file that the diagnosis is given.
    pub files: BTreeMap<String, String>,
}

/// A share of trials that is done while others are not.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct TrialsShare {
    /// Always [`super::RESULT_SCHEMA`].
    pub schema: String,
    /// Task that was asked for: `"trials-share"`.
    pub task: String,
    /// The share, as `2/8`.
    pub shard: String,
    /// Cases of the trials.
    pub cases: usize,
    /// Cases without an answer yet; they belong to other shares.
    pub open: usize,
}

/// Share of independent cases in which something was so.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Proportion {
    /// Cases where it was.
    pub count: u64,
    /// Cases.
    pub of: u64,
    /// The share; not finite, in JSON `null`, of no cases.
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
    /// Task that was asked for: `"trials"`.
    pub task: String,
    /// Name of the trials.
    pub name: String,
    /// Root of every random draw.
    pub seed: u64,
    /// Cases made.
    pub cases: u64,
    /// Cases without an answer; they count as wrong.
    pub unanswered: u64,
    /// Banks that were not made, and why.
    pub left_out: Vec<LeftOutBank>,
    /// Meaning of `right`, by kind of case.
    pub right_means: String,
    /// The bars, in the order of their document.
    pub bars: Vec<BarRow>,
    /// Values that the configuration's gate asks for; empty where it asks for none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub gate: Vec<BarRow>,
    /// Scores by effect and by class where several effects act; empty without such banks.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub inclusion: Vec<ClassScores>,
    /// Accuracy by bank.
    pub banks: Vec<BankRow>,
    /// Accuracy by bank, effect and size.
    pub effects: Vec<SizeRow>,
    /// Accuracy by bank and size, all effects together.
    pub sizes: Vec<SizeRow>,
    /// Hidden effect against the first named.
    pub confusion: Confusion,
    /// Hidden kind against the kind of the answer.
    pub kinds: Confusion,
    /// Reliability of stated probabilities.
    pub reliability: Vec<Reliability>,
    /// Map from stated confidence to the share that was right, from the even cases of the own banks.
    pub map: ProbabilityMap,
    /// Telling what has no name from what has.
    pub unknown: UnknownStudy,
    /// Held-out error over noise floor, of right answers that name an effect.
    pub ratio_to_floor: Quantiles,
    /// Coverage of the intervals of closure: of the closure that the repaired simulator has on the clean motion.
    pub closure: ClosureStudy,
    /// Wall time of a diagnosis in seconds.
    pub seconds_per_case: Quantiles,
    /// Share of cases in which an effect that comes with records of every bank was named.
    pub nuisances: Vec<NuisanceRow>,
    /// Simpler diagnosers on the same records.
    pub baselines: Vec<BaselineRow>,
    /// Cases that were answered wrongly or not at all.
    pub failures: Vec<FailureRow>,
    /// Wall time of the whole in seconds; of scoring alone where cases were scored again.
    pub seconds: f64,
}

/// A bank that was not made.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct LeftOutBank {
    /// Its name.
    pub bank: String,
    /// Why.
    pub reason: String,
}

/// A bar and what was measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BarRow {
    /// Name of the measure.
    pub metric: String,
    /// Smallest value that meets the bar, where there is one.
    pub at_least: Option<f64>,
    /// Largest value that meets the bar, where there is one.
    pub at_most: Option<f64>,
    /// Unit of the numbers; empty for a ratio, `%` for shares, which stand as shares here.
    pub unit: String,
    /// Measured value.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub value: f64,
    /// Its 95 % interval.
    #[serde(deserialize_with = "nulls_are_not_numbers")]
    pub interval_95: [f64; 2],
    /// Cases behind it.
    pub cases: u64,
    /// `met`, `not met` or `not measured here`.
    pub state: String,
    /// True if the whole interval lies on the wrong side.
    pub missed_beyond_chance: bool,
}

/// Scores by effect and by class of a group of cases. Effects that explain alike are one class. Where a law outside the
/// vocabulary, or what a logger does to every record, is of a class, that class counts neither for nor against.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ClassScores {
    /// The cases: a bank, or a part of one.
    pub banks: String,
    /// Number of cases.
    pub cases: u64,
    /// The class of the largest hidden effect is named.
    pub leading_named: Proportion,
    /// Its stated probability is 0.9 or more.
    pub leading_sure: Proportion,
    /// The classes named are those that act; of cases with hidden effects.
    pub set: Proportion,
    /// Hidden effects whose class is named, by size.
    pub recall: Vec<RecallRow>,
    /// Names whose class acts.
    pub precision: Proportion,
    /// Part of the gap attributed to classes that act, of what is attributed to any; over answers that attribute some.
    pub attributed: Quantiles,
    /// `unknown`, or a class that the truth allows, where a law outside the vocabulary acts alone.
    pub unknown: Proportion,
    /// Something named, or `unknown`, where nothing is missing.
    pub false_alarms: Proportion,
    /// By class.
    pub classes: Vec<InclusionRow>,
    /// By effect.
    pub effects: Vec<InclusionRow>,
}

/// Hidden effects of a range of sizes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RecallRow {
    /// From and to, as multiples of the noise; the upper end of the last is `null`.
    #[serde(deserialize_with = "nulls_are_not_numbers")]
    pub floors: [f64; 2],
    /// Those whose class is named.
    pub named: Proportion,
}

/// Recall and precision of an effect or a class.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InclusionRow {
    /// Its id.
    pub id: String,
    /// Named, of the cases in which it acts.
    pub recall: Proportion,
    /// It acts, of the cases in which it is named.
    pub precision: Proportion,
    /// Mean of its stated probability over cases in which it acts; `null` without any.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub stated_where_it_acts: f64,
    /// The same over cases in which it does not.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub stated_where_it_does_not: f64,
}

/// Accuracy on a bank.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BankRow {
    /// The bank.
    pub bank: String,
    /// Status and set right.
    pub right: Proportion,
    /// The first name is that of a hidden effect; without one, nothing named, or `unknown` where that is asked for.
    pub top_1: Proportion,
    /// Share with the right name first, or one that the answer says it cannot tell from it.
    pub class: Proportion,
    /// Every hidden effect named; of cases with two.
    pub both: Proportion,
    /// At least one of the hidden effects named; of cases with two.
    pub either: Proportion,
    /// Something named, or `unknown`, where nothing is missing.
    pub false_alarms: Proportion,
}

/// Accuracy at a size.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SizeRow {
    /// The bank.
    pub bank: String,
    /// The first hidden effect; empty for all together.
    pub effect: String,
    /// Size in noise units that stands for the range; of a pair that of the smaller.
    pub size: f64,
    /// The range of sizes; the upper end of the last is `null`.
    #[serde(deserialize_with = "nulls_are_not_numbers")]
    pub range: [f64; 2],
    /// Share with the right name first, as in [`BankRow::top_1`].
    pub top_1: Proportion,
    /// Share with the right class first, as in [`BankRow::class`].
    pub class: Proportion,
    /// Share of pairs of which both are named, as in [`BankRow::both`].
    pub both: Proportion,
}

/// Counts of what was against what was said.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Confusion {
    /// Names of the rows: what was.
    pub hidden: Vec<String>,
    /// Names of the columns: what was said.
    pub said: Vec<String>,
    /// Counts, row by row.
    pub counts: Vec<Vec<u64>>,
}

/// Reliability of stated probabilities.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Reliability {
    /// `confidence`, `confidence, mapped`, `effects` or `classes`.
    pub subject: String,
    /// `own`, `stressed`, or a group of [`ClassScores::banks`].
    pub banks: String,
    /// Probabilities looked at.
    pub count: u64,
    /// Expected calibration error over bins of equal count, its 95 % interval by a bootstrap over cases.
    pub calibration_error: WithInterval,
    /// Average of that error for probabilities that are exactly right, as many as here.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub calibration_error_by_chance: f64,
    /// Mean square of probability less outcome.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub brier: f64,
    /// At most ten bins of equal count.
    pub bins: Vec<ReliabilityBin>,
}

/// A bin of probabilities.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReliabilityBin {
    /// Smallest and largest probability in it.
    pub range: [f64; 2],
    /// Their mean.
    pub stated: f64,
    /// Share that was so.
    pub found: Proportion,
}

/// A map from stated to found probabilities.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ProbabilityMap {
    /// Method by which the map was made.
    pub method: String,
    /// Stated and found, rising; linear between, constant beyond.
    pub knots: Vec<[f64; 2]>,
    /// Cases it was fitted to.
    pub fitted_to: u64,
}

/// Telling what has no name from what has.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct UnknownStudy {
    /// All sizes together first, then by size.
    pub areas: Vec<AreaRow>,
    /// Shares of positives and of negatives above each threshold: false alarms, then hits.
    pub curve: Vec<[f64; 2]>,
}

/// An area under the receiver operating characteristic.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AreaRow {
    /// Size in noise units; `null` for all together.
    pub size: Option<f64>,
    /// Cases where `unknown` is right.
    pub positives: u64,
    /// Cases where it is wrong.
    pub negatives: u64,
    /// The area with its 95 % interval.
    pub area: WithInterval,
}

/// Quantiles of a sample.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Quantiles {
    /// Its size.
    pub count: u64,
    /// The median, with its 95 % interval by order statistics.
    pub median: WithInterval,
    /// The 95 % quantile.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub quantile_95: f64,
    /// The largest.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub worst: f64,
}

/// Coverage of the intervals of closure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ClosureStudy {
    /// Definition of the true closure.
    pub means: String,
    /// Share of intervals that hold it.
    pub coverage: Proportion,
    /// Number of cases in which it lies below the interval.
    pub below: u64,
    /// Number of cases in which it lies above.
    pub above: u64,
    /// Cases left out, by reason.
    pub left_out: BTreeMap<String, u64>,
}

/// Share of cases in which an effect that comes with all records was named.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NuisanceRow {
    /// Its id.
    pub id: String,
    /// Named, of the answered cases that have it.
    pub named: Proportion,
}

/// A simpler diagnoser.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BaselineRow {
    /// Its id.
    pub id: String,
    /// Method, in a sentence.
    pub method: String,
    /// First name right, on the bank of single effects.
    pub top_1: Proportion,
    /// The diagnosis on the same cases.
    pub diagnosis: Proportion,
    /// Something named where nothing is missing.
    pub false_alarms: Proportion,
    /// First name right by size, on the bank of single effects.
    pub sizes: Vec<SizeRow>,
}

/// A case answered wrongly or not at all.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FailureRow {
    /// The case.
    pub id: String,
    /// Its bank.
    pub bank: String,
    /// Hidden effects, or the law that acts.
    pub hidden: String,
    /// Answer, or the reason why there is none.
    pub said: String,
    /// Size in noise units of what was hidden; of a pair of the smaller one.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub size: f64,
    /// True if the answer says that it cannot tell what it named from what was hidden.
    pub same_class: bool,
    /// Diagnoses this case alone again.
    pub command: String,
}

/// One row of `cases.csv`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TrialCaseRow {
    /// The case.
    pub id: String,
    /// Its bank.
    pub bank: String,
    /// Hidden effects, joined by `+`.
    pub hidden: String,
    /// Their sizes in noise units, joined by `+`.
    pub size: String,
    /// Status of the answer; `no answer` where there is none.
    pub status: String,
    /// Effects named beside nuisances, best first, joined by `+`.
    pub named: String,
    /// Stated probability of status and set.
    pub confidence: Option<f64>,
    /// Stated probability of `unknown`.
    pub unknown: Option<f64>,
    /// Status and set right.
    pub right: bool,
    /// First name right.
    pub top_1: bool,
    /// First name right, or in one class with it.
    pub class: bool,
    /// Held-out error over noise floor.
    pub ratio_to_floor: Option<f64>,
    /// Stated closure of the gap.
    pub closure: Option<f64>,
    /// Lower end of its interval.
    pub closure_low: Option<f64>,
    /// Upper end of its interval.
    pub closure_high: Option<f64>,
    /// Closure on the clean motion.
    pub true_closure: Option<f64>,
    /// Wall time of the diagnosis in seconds.
    pub seconds: Option<f64>,
}
