//! Sentences shared by a page and the terminal, each made by one function.

use results::{
    BarRow, DataSummary, DiagnosisResult, OracleSummary, PipelineRow, TruthComparison, VerdictStatus,
};

use crate::format;

/// Lag-one autocorrelation of residuals beyond which their standard error is misleading.
const CORRELATED: f64 = 0.5;
/// Share of the variance of ln A in the residuals of a line below which they are too small to matter,
/// whatever their pattern. For an exponential without noise, the pipelines leave at most 3e-6; at 1e-5 the
/// standard error of λ is below a thousandth.
const NEGLIGIBLE: f64 = 1e-5;

/// Returns findings about a record file: time stamps first, then remarks from reading it.
#[must_use]
pub fn noticed(data: &DataSummary) -> Vec<String> {
    let mut sentences = Vec::new();
    if data.believed_clock == data.clock {
        sentences.push(format!("Time stamps: {}.", ended(&data.believed_clock_reason)));
    } else {
        sentences.push(format!(
            "Time stamps: {}. They support the {} clock, but the {} clock is in force ({}).",
            ended(&data.believed_clock_reason),
            data.believed_clock,
            data.clock,
            ended(&data.clock_reason)
        ));
    }
    sentences.extend(data.findings.iter().cloned());
    sentences
}

/// Returns `true` if everything that a diagnosis names lies in the measurement chain, and nothing in the
/// equation of motion: `none`, or `calibration`, is then more probable than not beside the effects.
#[must_use]
pub fn is_of_the_chain_only(result: &DiagnosisResult) -> bool {
    let [none, calibration] = [VerdictStatus::None, VerdictStatus::Calibration];
    result.verdict.status == VerdictStatus::Effect
        && result.probability(none) + result.probability(calibration) > 0.5
}

/// Returns rows on the truth of a simulated record and the distance of the answer from it: a name and a
/// sentence each.
#[must_use]
pub fn truth_rows(known: &TruthComparison) -> Vec<(&'static str, String)> {
    let mut rows = Vec::new();
    if let (Some(omega), Some(off)) = (known.omega_rad_s, known.omega_off_percent) {
        rows.push(("true ω", format!("{omega:.6} rad/s; found {off:+.2} % from it")));
    }
    if let (Some(zeta), Some(off)) = (known.zeta, known.zeta_off_percent) {
        let errors = known
            .zeta_off_std_errors
            .map_or_else(String::new, |errors| format!(", {errors:+.1} standard errors"));
        rows.push(("true ζ", format!("{}; found {off:+.2} % from it{errors}", format::significant(zeta, 6))));
    }
    rows.push(("of the truth", known.meaning.clone()));
    rows
}

/// Returns the interpretation of a file without the words `read as`; `None` in results of versions that did
/// not state it.
pub(crate) fn read_as(sentence: &str) -> Option<&str> {
    let text = sentence.strip_prefix("read as: ").unwrap_or(sentence);
    (!text.is_empty()).then_some(text)
}

/// Returns a sentence without its full stop, because one will follow.
fn ended(sentence: &str) -> &str {
    sentence.strip_suffix('.').unwrap_or(sentence)
}

/// Returns `true` if a line through ln A leaves only immaterial residuals: rounding and the placing of peaks
/// have patterns of their own, which carry no information about the decay.
#[must_use]
pub fn is_exponential(r_squared: f64) -> bool {
    1.0 - r_squared < NEGLIGIBLE
}

/// Returns warnings about the reference's standard errors.
#[must_use]
pub fn warnings(reference: &OracleSummary) -> Vec<String> {
    let correlation = reference.residual_autocorrelation;
    if correlation.abs() <= CORRELATED || is_exponential(reference.r_squared) {
        return Vec::new();
    }
    let consequence = if correlation > 0.0 { "are therefore too small" } else { "therefore do not hold" };
    vec![format!(
        "Neighboring residuals of ln A are correlated (lag-one autocorrelation {}): the standard errors and intervals \
         stated here assume independent residuals and {consequence}.",
        format::fixed(correlation, 2)
    )]
}

/// Returns `true` if the pipeline and the clock in force are those to believe. Others that give a different
/// answer then leave this answer as it is, and are a remark below it; else they come before it.
#[must_use]
pub fn is_believed(pipelines: &[PipelineRow], data: &DataSummary) -> bool {
    pipelines.iter().any(|row| row.in_force && row.pipeline != "paper" && row.clock == data.believed_clock)
}

/// Returns the state of a bar in words: `within chance` only if the interval contains the bar.
#[must_use]
pub fn bar_state(row: &BarRow) -> &str {
    let [low, high] = row.interval_95;
    let excludes = row.at_least.is_some_and(|bar| high < bar) || row.at_most.is_some_and(|bar| low > bar);
    match (row.state.as_str(), row.missed_beyond_chance) {
        ("not met", false) if excludes => "not met, within scatter",
        ("not met", false) if low.is_finite() && high.is_finite() => "not met, within chance",
        (state, _) => state,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::Sample;

    #[test]
    fn correlated_residuals_are_warned_about() {
        let mut reference = Sample::new().result.oracle;
        reference.residual_autocorrelation = 0.5;
        assert!(warnings(&reference).is_empty());
        reference.residual_autocorrelation = 0.61;
        assert!(warnings(&reference)[0].contains("0.61): the standard errors"));
        assert!(warnings(&reference)[0].contains("too small"));
        reference.residual_autocorrelation = -0.7;
        assert!(warnings(&reference)[0].contains("do not hold"));
    }

    #[test]
    fn residuals_that_the_pipeline_leaves_of_an_exponential_are_passed_over() {
        let mut reference = Sample::new().result.oracle;
        reference.residual_autocorrelation = 0.99;
        reference.r_squared = 1.0 - 1e-4;
        assert_eq!(warnings(&reference).len(), 1);
        reference.r_squared = 1.0 - 2.8e-6;
        assert!(warnings(&reference).is_empty());
    }

    #[test]
    fn repeated_stamps_are_noticed() {
        let mut data = Sample::new().result.data;
        data.findings.clear();
        data.believed_clock_reason = "7134 of 7606 stamps (94 %) repeat the one before".into();
        let text = noticed(&data).join(" ");
        assert_eq!(text, "Time stamps: 7134 of 7606 stamps (94 %) repeat the one before.");
        data.clock = "host".into();
        data.clock_reason = "set in the configuration".into();
        let text = noticed(&data).join(" ");
        assert!(text.ends_with("but the host clock is in force (set in the configuration)."), "{text}");
    }

    #[test]
    fn the_recommended_pipeline_is_believed_on_the_believed_clock_alone() {
        let mut result = Sample::new().result;
        assert!(!is_believed(&result.pipelines, &result.data));
        for row in &mut result.pipelines {
            row.in_force = row.pipeline == "recommended" && row.clock == "uniform-index";
        }
        assert!(is_believed(&result.pipelines, &result.data));
        result.data.believed_clock = "host".into();
        assert!(!is_believed(&result.pipelines, &result.data));
    }

    #[test]
    fn a_bar_outside_the_interval_is_not_within_chance() {
        let bar = |low: f64, high: f64, beyond: bool| BarRow {
            metric: String::new(),
            at_least: None,
            at_most: Some(0.03),
            unit: String::new(),
            value: 0.05,
            interval_95: [low, high],
            cases: 100,
            state: "not met".into(),
            missed_beyond_chance: beyond,
        };
        assert_eq!(bar_state(&bar(0.02, 0.07, false)), "not met, within chance");
        assert_eq!(bar_state(&bar(0.04, 0.07, true)), "not met");
        assert_eq!(bar_state(&bar(0.04, 0.07, false)), "not met, within scatter");
        assert_eq!(bar_state(&bar(f64::NAN, f64::NAN, false)), "not met");
        assert_eq!(bar_state(&BarRow { state: "met".into(), ..bar(0.0, 0.01, false) }), "met");
    }
}
