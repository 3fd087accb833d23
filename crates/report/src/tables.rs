//! Tables of the page: cells, and the number of their digits.

use results::{
    DataSummary, EstimationResult, PipelineOutcome, PipelineRow, Resonance, SeedRow, TruthComparison,
    WithInterval,
};

use crate::format::{count, exact, fixed, interval, percent, quantity, significant, with_uncertainty};
use crate::modes::{half_power_width, quality_factor};

/// A quantity and its value, as shown on the page.
pub(crate) struct Fact {
    pub(crate) name: &'static str,
    pub(crate) value: String,
}

pub(crate) fn fact(name: &'static str, value: impl Into<String>) -> Fact {
    Fact { name, value: value.into() }
}

/// Table of methods and their scores on held-out records or peaks.
pub(crate) struct ScoreTable {
    /// Titles of the columns, that of the methods first.
    pub(crate) columns: Vec<String>,
    pub(crate) rows: Vec<ScoreRow>,
}

/// One method in such a table.
pub(crate) struct ScoreRow {
    pub(crate) title: String,
    /// `true` if the row is highlighted: a learner, or the reference of the comparison.
    pub(crate) is_marked: bool,
    /// One cell for each column but the first; empty if there is a reason instead.
    pub(crate) cells: Vec<String>,
    /// Reason for missing scores; empty if there are scores.
    pub(crate) reason: String,
}

/// Returns a name in a form that is allowed in an anchor.
pub(crate) fn anchor(name: &str) -> String {
    name.chars().map(|letter| if letter.is_ascii_alphanumeric() { letter } else { '-' }).collect()
}

/// One quantity by the oracle and by the estimator; `None` if it is not stated.
pub(crate) struct ComparisonRow {
    pub(crate) quantity: &'static str,
    pub(crate) oracle: Option<String>,
    pub(crate) estimate: Option<String>,
}

pub(crate) fn comparison(result: &EstimationResult) -> Vec<ComparisonRow> {
    let (oracle, estimate) = (&result.oracle, &result.estimate);
    let unknown = f64::NAN;
    let of_least_squares = WithInterval { value: oracle.zeta, interval_95: oracle.zeta_interval_95 };
    let least_squares = Resonance::of_swing(result.envelope.omega_rad_s, of_least_squares);
    vec![
        ComparisonRow {
            quantity: "damping ratio ζ ± standard error",
            oracle: Some(with_uncertainty(oracle.zeta, oracle.zeta_std_error)),
            estimate: Some(with_uncertainty(estimate.zeta, estimate.zeta_std_error.unwrap_or(unknown))),
        },
        ComparisonRow {
            quantity: "95 % interval of ζ",
            oracle: Some(interval(oracle.zeta_interval_95)),
            estimate: estimate.zeta_interval_95.map(interval),
        },
        ComparisonRow {
            quantity: "quality factor Q = 1/(2ζ)",
            oracle: least_squares.as_ref().map(quality_factor),
            estimate: estimate.resonance.as_ref().map(quality_factor),
        },
        ComparisonRow {
            quantity: "half-power width 2ζf, Hz",
            oracle: least_squares.as_ref().map(half_power_width),
            estimate: estimate.resonance.as_ref().map(half_power_width),
        },
        ComparisonRow {
            quantity: "decay rate λ ± standard error, 1/s",
            oracle: Some(with_uncertainty(oracle.decay_rate, oracle.std_error)),
            estimate: Some(with_uncertainty(estimate.decay_rate, estimate.std_error.unwrap_or(unknown))),
        },
        ComparisonRow {
            quantity: "95 % interval of λ, 1/s",
            oracle: Some(interval(oracle.interval_95)),
            estimate: estimate.interval_95.map(interval),
        },
        // Two methods on one envelope can agree far beyond its standard error; their difference shows only
        // with more digits than that error justifies.
        ComparisonRow {
            quantity: "ζ to eight digits, whatever its standard error",
            oracle: Some(significant(oracle.zeta, 8)),
            estimate: Some(significant(estimate.zeta, 8)),
        },
        ComparisonRow {
            quantity: "λ to eight digits, 1/s",
            oracle: Some(significant(oracle.decay_rate, 8)),
            estimate: Some(significant(estimate.decay_rate, 8)),
        },
        ComparisonRow {
            quantity: "ln A at the first peak",
            oracle: Some(significant(oracle.log_amplitude, 6)),
            estimate: Some(significant(estimate.log_amplitude, 6)),
        },
        ComparisonRow {
            quantity: "coefficient of determination R²",
            oracle: Some(fixed(oracle.r_squared, 4)),
            estimate: None,
        },
    ]
}

/// Returns facts about the envelope that every method was fitted to.
pub(crate) fn envelope(result: &EstimationResult) -> Vec<Fact> {
    let envelope = &result.envelope;
    vec![
        fact("Pipeline", envelope.pipeline_in_words()),
        fact("Peaks", whole(envelope.peaks)),
        fact("Samples after interpolation", whole(envelope.samples)),
        fact("Median period", quantity(&significant(envelope.period_s, 6), "s")),
        fact("Angular frequency ω", quantity(&significant(envelope.omega_rad_s, 6), "rad/s")),
        fact("Rest position removed", quantity(&significant(envelope.offset, 4), &result.data.unit)),
        fact("First peak after the first sample", quantity(&significant(envelope.first_peak_s, 4), "s")),
    ]
}

/// Returns facts about the training of the estimate.
pub(crate) fn training(result: &EstimationResult) -> Vec<Fact> {
    let error = format!(
        "{} (stated tolerance {})",
        percent(result.error_percent),
        quantity(&exact(result.tolerance_percent), "%")
    );
    vec![
        fact("ζ differs from the reference by", error),
        fact("Stopped because", result.estimate.stopped_because.clone()),
        fact("State", result.estimate.reached.in_words()),
        fact("Steps", count(result.steps)),
        fact("Time", quantity(&significant(result.seconds, 3), "s")),
        fact("Trained parameters", whole(result.parameters)),
        fact("Seed", result.seed.to_string()),
    ]
}

/// Returns facts about the quality of the oracle's arithmetic and residuals.
pub(crate) fn oracle(result: &EstimationResult) -> Vec<Fact> {
    let oracle = &result.oracle;
    vec![
        fact("Digits guaranteed by the arithmetic", fixed(oracle.promised_digits, 1)),
        fact("Condition number, columns scaled", significant(oracle.condition, 3)),
        fact("Autocorrelation of the residuals at lag one", fixed(oracle.residual_autocorrelation, 3)),
    ]
}

/// Returns facts about the truth of a simulated record, and the distance of the answer from it.
pub(crate) fn truth(known: &TruthComparison) -> Vec<Fact> {
    crate::remarks::truth_rows(known).into_iter().map(|(name, value)| fact(name, value)).collect()
}

/// Returns facts about the source of the record.
pub(crate) fn data(data: &DataSummary) -> Vec<Fact> {
    let rate = with_uncertainty(data.sample_rate_hz, data.sample_rate_std_error_hz);
    let mut facts = vec![
        fact("File", data.path.clone()),
        fact("Digest", data.digest.clone()),
        fact("Samples", whole(data.samples)),
        fact("Clock in force", data.clock.as_str()),
        fact("Sample rate", quantity(&rate, "Hz")),
        fact("Sample period", quantity(&significant(data.sample_period_s * 1e3, 6), "ms")),
        fact(
            "Resolution",
            data.resolution.map_or_else(
                || "no quantization steps found".to_owned(),
                |step| quantity(&significant(step, 6), &data.unit),
            ),
        ),
    ];
    facts.extend(crate::remarks::read_as(&data.reading.sentence).map(|text| fact("Read as", text)));
    facts
}

/// The fit of one seed in its table.
pub(crate) struct SeedView {
    pub(crate) seed: String,
    pub(crate) decay_rate: String,
    pub(crate) zeta: String,
    pub(crate) error: String,
    pub(crate) state: String,
    pub(crate) steps: String,
    pub(crate) seconds: String,
    pub(crate) is_worst: bool,
}

/// Returns the rows of the table of seeds, with the worst marked; empty if there is only one seed.
pub(crate) fn seeds(rows: &[SeedRow]) -> Vec<SeedView> {
    if rows.len() < 2 {
        return Vec::new();
    }
    // NaN counts as worse than any error.
    let badness = |row: &SeedRow| {
        if row.error_percent.is_nan() { f64::INFINITY } else { row.error_percent }
    };
    let worst = rows
        .iter()
        .enumerate()
        .max_by(|one, other| badness(one.1).total_cmp(&badness(other.1)))
        .map(|(index, _)| index);
    rows.iter()
        .enumerate()
        .map(|(index, row)| SeedView {
            seed: row.seed.to_string(),
            decay_rate: significant(row.decay_rate, 7),
            zeta: significant(row.zeta, 7),
            error: percent(row.error_percent),
            state: row.reached.in_words().to_owned(),
            steps: count(row.steps),
            seconds: significant(row.seconds, 3),
            is_worst: Some(index) == worst,
        })
        .collect()
}

/// The result for one pipeline and one clock in its table.
pub(crate) struct PipelineView<'a> {
    pub(crate) pipeline: &'a str,
    pub(crate) clock: &'a str,
    pub(crate) is_in_force: bool,
    pub(crate) fit: Option<FitView>,
    /// Reason for a missing fit.
    pub(crate) reason: &'a str,
}

/// Fit of a pipeline.
pub(crate) struct FitView {
    pub(crate) peaks: String,
    pub(crate) omega: String,
    pub(crate) decay_rate: String,
    pub(crate) zeta: String,
    pub(crate) r_squared: String,
}

pub(crate) fn pipelines(rows: &[PipelineRow]) -> Vec<PipelineView<'_>> {
    rows.iter()
        .map(|row| {
            let (fit, reason) = match &row.outcome {
                PipelineOutcome::Fit { peaks, omega_rad_s, decay_rate, zeta, zeta_std_error, r_squared } => (
                    Some(FitView {
                        peaks: whole(*peaks),
                        omega: significant(*omega_rad_s, 6),
                        decay_rate: significant(*decay_rate, 6),
                        zeta: with_uncertainty(*zeta, *zeta_std_error),
                        r_squared: fixed(*r_squared, 4),
                    }),
                    "",
                ),
                PipelineOutcome::Failed { reason } => (None, reason.as_str()),
            };
            PipelineView {
                pipeline: &row.pipeline,
                clock: &row.clock,
                is_in_force: row.in_force,
                fit,
                reason,
            }
        })
        .collect()
}

pub(crate) fn whole(value: usize) -> String {
    count(u64::try_from(value).unwrap_or(u64::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::Sample;

    #[test]
    fn the_worst_seed_is_marked_and_nan_is_worse_than_any() {
        let mut rows = Sample::new().result.seeds;
        let marked = |rows: &[SeedRow]| {
            let views = seeds(rows);
            let marked: Vec<_> = (0..views.len()).filter(|i| views[*i].is_worst).collect();
            marked
        };
        assert_eq!(marked(&rows), [3]);
        rows[1].error_percent = f64::NAN;
        assert_eq!(marked(&rows), [1]);
        assert!(seeds(&rows[..1]).is_empty());
    }

    #[test]
    fn what_is_not_stated_is_left_open() {
        let mut result = Sample::new().result;
        result.estimate.interval_95 = None;
        result.estimate.std_error = None;
        let rows = comparison(&result);
        let of = |name: &str| {
            rows.iter().find(|row| row.quantity.contains(name)).and_then(|row| row.estimate.as_deref())
        };
        assert_eq!(of("interval of λ"), None);
        assert_eq!(of("decay rate"), Some("0.1909610"));
        assert_eq!(of("quality factor"), Some("57.1\u{a0}±\u{a0}1.3"));
    }
}
