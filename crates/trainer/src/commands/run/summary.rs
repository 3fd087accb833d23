//! Terminal output of estimates and comparisons, on one short screen.

use crate::terminal::table::table;
use estimator::Ablation;
use record::two_digits;
use report::{format, half_power_width, quality_factor};
use results::{
    ComparisonResult, DataSummary, EstimationResult, Family, MethodOutcome, MethodRow, OracleSummary, Origin,
    PipelineOutcome, PipelineRow, Resonance, TruthComparison,
};
use std::path::Path;

/// Formats an estimate for the terminal.
pub(crate) fn summary(result: &EstimationResult, folder: &Path) -> String {
    let (doubt, differing) = differing(result.disagreement.as_ref(), &result.pipelines, &result.data);
    let mut parts: Vec<String> = doubt.into_iter().collect();
    parts.extend([headline(result), numbers(result)]);
    if result.seeds.len() > 1 {
        parts.push(format!(
            "{} seeds from {} on: {} % from least squares at worst, slowest {:.2} s",
            result.seeds.len(),
            result.seed,
            two_digits(result.worst_error_percent),
            result.seeds.iter().map(|row| row.seconds).fold(0.0, f64::max),
        ));
    }
    parts.push(pipelines(&result.pipelines));
    parts.extend(differing);
    parts.push(remarks(result).join("\n"));
    parts.push(ending(folder));
    parts.join("\n\n")
}

/// Returns the sentence on pipelines or clocks that differ, in one of two places: before the answer if another
/// answer is to be believed, else below it.
fn differing(
    disagreement: Option<&String>,
    pipelines: &[PipelineRow],
    data: &DataSummary,
) -> (Option<String>, Option<String>) {
    match report::is_believed(pipelines, data) {
        true => (None, disagreement.map(|said| format!("note: {said}"))),
        false => (disagreement.cloned(), None),
    }
}

fn headline(result: &EstimationResult) -> String {
    let verdict = if result.pass { "solves" } else { "does NOT solve" };
    let whose = match result.seeds.len() {
        0 | 1 => "its damping ratio is".to_owned(),
        count => format!("the worst damping ratio of {count} seeds is"),
    };
    // A method that states no error has none shown.
    let error = result.estimate.zeta_std_error.unwrap_or_default();
    format!(
        "damping ratio ζ = {}\n{} on {} ({}): {verdict} least squares to {} %; {whose} {} % from that of the closed \
         form",
        ratio(result.estimate.zeta, error),
        result.estimator_title,
        result.data.path,
        origin(&result.data),
        result.tolerance_percent,
        two_digits(result.worst_error_percent),
    )
}

/// Describes the origin of a record.
fn origin(data: &DataSummary) -> &'static str {
    match data.origin {
        Origin::Measured => "measured record",
        Origin::Simulated => "simulated record",
        Origin::Unstated => "origin not stated",
    }
}

fn numbers(result: &EstimationResult) -> String {
    let row = |name: &str, value: String| vec![name.to_owned(), value];
    let estimate = &result.estimate;
    // The frequency is taken as known, so the rate has the same relative error as the ratio.
    let error = estimate.zeta_std_error.unwrap_or_default();
    let rate_error = error * estimate.decay_rate / estimate.zeta;
    let said = |words: fn(&Resonance) -> String| {
        estimate.resonance.as_ref().map_or_else(|| "none: no resonance".to_owned(), words)
    };
    let mut rows = vec![
        row("pipeline", result.envelope.pipeline_in_words()),
        row(result.envelope.counted(), result.envelope.peaks.to_string()),
        row("angular frequency ω", format!("{} rad/s", format::significant(result.envelope.omega_rad_s, 7))),
        row("decay rate λ", format!("{} 1/s", format::with_uncertainty(estimate.decay_rate, rate_error))),
        row("damping ratio ζ", ratio(estimate.zeta, error)),
        row("quality factor 1/(2ζ)", said(quality_factor)),
        row("half-power width 2ζf", said(|resonance| format!("{} Hz", half_power_width(resonance)))),
        row(
            "ζ by closed-form least squares",
            format!(
                "{}, R² {:.6}",
                ratio(result.oracle.zeta, result.oracle.zeta_std_error),
                result.oracle.r_squared
            ),
        ),
        row("distance from least squares", format!("{} %", two_digits(result.error_percent))),
        row(
            "stopped",
            format!(
                "{} after {}: {}",
                result.estimate.reached.in_words(),
                record::counted(result.steps as usize, "step"),
                result.estimate.stopped_because
            ),
        ),
        row("time", format!("{:.2} s for {} parameters", result.seconds, result.parameters)),
    ];
    rows.extend(truth(result.truth.as_ref()));
    table(&[], rows)
}

/// Formats the truth of a simulated record, and the distance of the estimate from it.
fn truth(known: Option<&TruthComparison>) -> Vec<Vec<String>> {
    let rows = known.map(report::truth_rows).unwrap_or_default();
    rows.into_iter().map(|(name, value)| vec![name.to_owned(), value]).collect()
}

/// Formats a comparison for the terminal: the paper's Tables 3 to 5 in one screen or two.
pub(crate) fn comparison(result: &ComparisonResult, folder: &Path) -> String {
    let (doubt, differing) = differing(result.disagreement.as_ref(), &result.pipelines, &result.data);
    let mut parts: Vec<String> = doubt.into_iter().collect();
    parts.extend([
        comparison_headline(result),
        oscillation(result),
        methods(result),
        contributions(result),
        pipelines(&result.pipelines),
        // Pipelines that agree leave nothing to say.
        differing.unwrap_or_default(),
        comparison_remarks(result),
        ending(folder),
    ]);
    parts.retain(|part| !part.is_empty());
    parts.join("\n\n")
}

fn comparison_headline(result: &ComparisonResult) -> String {
    let passed = result.held_to_least_squares().filter(|row| row.outcome.passes()).count();
    let count = result.held_to_least_squares().count();
    let waiting = result.held_to_least_squares().filter(|row| !is_begun(row)).count();
    let verdict = match (result.pass, waiting, passed + waiting < count) {
        (true, ..) => String::new(),
        (false, 0, _) => ", THE OTHERS DO NOT".to_owned(),
        (false, _, true) => format!(", {waiting} WERE NOT STARTED, THE OTHERS DO NOT"),
        (false, _, false) => format!(", {waiting} WERE NOT STARTED"),
    };
    let seeds = match result.seeds {
        0 | 1 => format!("seed {}", result.seed),
        count => format!("seeds {} to {}", result.seed, result.seed + count - 1),
    };
    format!(
        "damping ratio ζ = {}\n{passed} of {count} methods on {} ({}) solve least squares to {} %{verdict}; at most {} % from the closed \
         form{}, {seeds}, {:.1} s",
        ratio(result.oracle.zeta, result.oracle.zeta_std_error),
        result.data.path,
        origin(&result.data),
        result.tolerance_percent,
        two_digits(result.max_error_percent),
        report::beside_least_squares(result),
        result.seconds,
    )
}

/// Returns the methods that were not begun when the run was interrupted.
fn waiting(result: &ComparisonResult) -> Vec<&MethodRow> {
    result.results.iter().filter(|row| !is_begun(row)).collect()
}

fn is_begun(row: &MethodRow) -> bool {
    !row.outcome.is_not_begun()
}

fn oscillation(result: &ComparisonResult) -> String {
    let (oracle, derived) = (&result.oracle, &result.derived);
    let row = |name: &str, value: String| vec![name.to_owned(), value];
    let unit = |with_inertia: &str, without: &str| match derived.per_unit_of_inertia {
        true => format!("{without} per unit of inertia (compare.inertia_kg_m2 is not given)"),
        false => with_inertia.to_owned(),
    };
    let mut rows = vec![
        row("pipeline", result.envelope.pipeline_in_words()),
        row(result.envelope.counted(), result.envelope.peaks.to_string()),
        row("period", format!("{:.4} s, {:.4} Hz", derived.period_s, derived.frequency_hz)),
        row("angular frequency ω", format!("{} rad/s", format::significant(result.envelope.omega_rad_s, 7))),
        row("decay rate λ", format!("{} 1/s", format::with_uncertainty(oracle.decay_rate, oracle.std_error))),
        row("R²", format!("{:.6}", oracle.r_squared)),
        row("damping ratio ζ", ratio(oracle.zeta, oracle.zeta_std_error)),
        row("stiffness", format!("{:.4} {}", derived.stiffness_n_m_per_rad, unit("N m/rad", "1/s^2"))),
        row(
            "damping coefficient",
            format!("{:.4e} {}", derived.damping_n_m_s_per_rad, unit("N m s/rad", "1/s")),
        ),
        row(
            "critical damping",
            format!("{:.4e} {}", derived.critical_damping_n_m_s_per_rad, unit("N m s/rad", "1/s")),
        ),
        row(
            "quality factor",
            format!("{:.2}; to 1/e in {:.2} cycles", derived.quality_factor, derived.cycles_to_one_over_e),
        ),
        row(
            "half-life, time constant",
            format!("{:.3} s, {:.3} s", derived.half_life_s, derived.time_constant_s),
        ),
    ];
    rows.extend(truth(result.truth.as_ref()));
    table(&[], rows)
}

fn methods(result: &ComparisonResult) -> String {
    let rows = result
        .results
        .iter()
        .chain(&result.libraries)
        .filter(|row| is_begun(row))
        .map(|row| {
            let number = row.number.map_or_else(|| "-".to_owned(), |number| number.to_string());
            let mut cells = vec![number, row.id.clone()];
            match &row.outcome {
                MethodOutcome::Estimate(found) => cells.extend([
                    format!("{:.8}", found.zeta),
                    found.zeta_std_error.map_or_else(|| "-".to_owned(), |error| format!("{error:.1e}")),
                    format!("{:.1e}", found.error_percent),
                    format!("{:.1e}", found.worst_error_percent),
                    format!("{:.1}", found.digits_of_agreement),
                    found.seeds.to_string(),
                    found.steps.to_string(),
                    found.parameters.to_string(),
                    format!("{:.3}", found.seconds),
                    format!(
                        "{}{}",
                        found.reached.in_words(),
                        match (found.pass, row.excused) {
                            (true, _) => "",
                            (false, true) => ", does not count",
                            (false, false) => ", FAILS",
                        }
                    ),
                ]),
                MethodOutcome::Failed { reason } => {
                    cells.extend(std::iter::repeat_n(String::new(), 9));
                    cells.push(format!("FAILED: {reason}"));
                }
            }
            cells
        })
        .collect();
    let header =
        ["#", "method", "ζ", "±", "error %", "worst %", "digits", "seeds", "steps", "par.", "s", "state"];
    let waiting: Vec<&str> = waiting(result).iter().map(|row| row.id.as_str()).collect();
    match waiting.as_slice() {
        [] => table(&header, rows),
        ids => format!("{}\ninterrupted before these were fitted: {}", table(&header, rows), ids.join(", ")),
    }
}

/// Formats, for each learned method, whether its value may differ from least squares, and the contribution of
/// its learned part.
fn contributions(result: &ComparisonResult) -> String {
    let learned = result.results.iter().filter(|row| is_begun(row) && row.family == Family::Learned);
    let rows = learned.map(|row| {
        let ablations = row.outcome.estimate().map_or(&[][..], |found| &found.ablations);
        let error = |ablation: Ablation| report::ablation_cell(ablations, ablation);
        let mut cells = vec![row.id.clone(), row.estimand.may_differ().to_owned()];
        cells.extend(Ablation::ALL.map(error));
        cells
    });
    let rows: Vec<Vec<String>> = rows.collect();
    if rows.is_empty() {
        return String::new();
    }
    let header = [
        "method",
        "may differ from least squares",
        "learned part set to zero, error %",
        "noise as its input, error %",
    ];
    format!("{}\n{}", table(&header, rows), report::ABLATION_READING)
}

fn comparison_remarks(result: &ComparisonResult) -> String {
    let cautions = result
        .cautions
        .iter()
        .map(|caution| format!("not supported: \u{201c}{}\u{201d}. {}", caution.statement, caution.finding));
    clock(&result.data)
        .into_iter()
        .chain(warned(&result.oracle))
        .chain(cautions)
        .collect::<Vec<_>>()
        .join("\n")
}

/// Formats a damping ratio, with its standard error if it has one.
fn ratio(zeta: f64, std_error: f64) -> String {
    let said = if std_error > 0.0 { " (standard error)" } else { "" };
    format!("{}{said}", format::with_uncertainty(zeta, std_error))
}

fn pipelines(pipelines: &[PipelineRow]) -> String {
    let mark = |in_force: bool| if in_force { "*" } else { "" }.to_owned();
    let rows = pipelines
        .iter()
        .map(|row| {
            let mut cells = vec![mark(row.in_force), row.pipeline.clone(), row.clock.clone()];
            match &row.outcome {
                PipelineOutcome::Fit { peaks, omega_rad_s, decay_rate, zeta, r_squared, .. } => {
                    cells.extend([
                        peaks.to_string(),
                        format!("{omega_rad_s:.6}"),
                        format!("{decay_rate:.8}"),
                        format!("{zeta:.8}"),
                        format!("{r_squared:.5}"),
                    ]);
                }
                PipelineOutcome::Failed { .. } => cells.push("none".to_owned()),
            }
            cells
        })
        .collect();
    let header = ["", "pipeline", "clock", "peaks", "ω rad/s", "λ 1/s", "ζ", "R²"];
    let mut text = format!(
        "closed-form least squares on the record, by pipeline and clock (* in force):\n{}",
        table(&header, rows)
    );
    let mut told: Vec<(&str, &str)> = Vec::new();
    for row in pipelines {
        let PipelineOutcome::Failed { reason } = &row.outcome else { continue };
        // Advice on pipelines that are not in force helps nobody, and the clocks fail alike.
        let (reason, _) = reason.split_once(". ").unwrap_or((reason, ""));
        let failed = (row.pipeline.as_str(), reason.trim_end_matches('.'));
        if !told.contains(&failed) {
            told.push(failed);
            text.push_str(&format!("\n{}: none, since {}", failed.0, failed.1));
        }
    }
    text
}

fn ending(folder: &Path) -> String {
    format!("run: {0}\nreport: {0}/report.html", folder.display())
}

/// Describes the clock, the sensor's rate, and the findings in the file.
fn clock(data: &DataSummary) -> Vec<String> {
    let mut remarks = vec![
        data.reading.sentence.clone(),
        format!("clock in force: {}", data.clock),
        match data.sample_rate_std_error_hz {
            error if error >= 0.005 => format!(
                "sensor: one sample every {:.6} ms, {:.2} ± {error:.2} Hz",
                1e3 * data.sample_period_s,
                data.sample_rate_hz
            ),
            _ => format!(
                "sensor: one sample every {:.6} ms, {:.2} Hz",
                1e3 * data.sample_period_s,
                data.sample_rate_hz
            ),
        },
    ];
    remarks.extend(report::noticed(data).iter().map(|finding| format!("note: {finding}")));
    remarks
}

fn remarks(result: &EstimationResult) -> Vec<String> {
    clock(&result.data).into_iter().chain(warned(&result.oracle)).collect()
}

fn warned(reference: &OracleSummary) -> impl Iterator<Item = String> {
    report::warnings(reference).into_iter().map(|warning| format!("note: {warning}"))
}
