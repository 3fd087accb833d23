//! Terminal output of a diagnosis, on one screen.

use crate::terminal::table::table;
use report::format::{
    self, UNDETERMINED, estimate, interval, quantity, share_with_interval, significant, unit,
};
use results::{CalibratedRow, DISTINCT_DISTANCE, DiagnosisResult, MapCell, VerdictStatus, WithInterval};
use std::path::Path;

/// Formats a diagnosis for the terminal, in the unit of the log as its report has it.
pub(super) fn summary(result: &DiagnosisResult, folder: &Path) -> String {
    let result = &report::in_log_unit(result);
    let parts = [
        verdict(result),
        classes(result),
        gap(result),
        apart(result),
        whereabouts(result),
        report::actuator_sentence(result),
        report::modes_sentence(&result.modes),
        calibration(result),
        chain(result),
        format!("took: {}", stages(result)),
        format!(
            "report: {path}/report.html\nrepaired simulator: {path}/repaired.toml, .py, .mo, .mjcf.xml, .urdf.xml; equation.txt, equation.tex",
            path = folder.display()
        ),
    ];
    parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("\n\n")
}

fn verdict(result: &DiagnosisResult) -> String {
    let label = match result.verdict.status {
        VerdictStatus::None => "NOTHING IS MISSING",
        VerdictStatus::Calibration if report::is_calibrated_already(result) => "NOTHING IS MISSING",
        VerdictStatus::Calibration => "CALIBRATION",
        VerdictStatus::Effect if report::is_of_the_chain_only(result) => "NOTHING IS MISSING IN THE MOTION",
        VerdictStatus::Effect => "MISSING EFFECT",
        VerdictStatus::Unknown => "UNKNOWN",
    };
    format!("{label}\n{}", result.verdict.summary)
}

/// Lists the classes that are certain, likely and open, and the share of the gap without a name.
fn classes(result: &DiagnosisResult) -> String {
    let statements = report::class_statements(result);
    let mut rows: Vec<Vec<String>> = statements
        .iter()
        .map(|one| {
            vec![
                one.standing.word().to_owned(),
                one.title.clone(),
                format::probability(one.class.probability),
                one.sentence.clone(),
            ]
        })
        .collect();
    let unlikely = report::unlikely_classes(result);
    if rows.is_empty() {
        return unlikely.unwrap_or_default();
    }
    if let Some((share, left)) = report::nameless_share(result).zip(result.left_over) {
        let left = significant(left.over_noise, 3);
        let text =
            format!("{} of the gap; the repaired simulator's error is {left} × noise", format::share(share));
        rows.push(vec!["unexplained".to_owned(), String::new(), String::new(), text]);
    }
    let found = table(&["", "class of effects", "probability", ""], rows);
    [Some(found), unlikely].into_iter().flatten().collect::<Vec<_>>().join("\n")
}

fn gap(result: &DiagnosisResult) -> String {
    let gap = &result.gap;
    let row = |name: &str, value: f64, note: String| {
        let ratio =
            if gap.noise_floor > 0.0 { significant(value / gap.noise_floor, 3) } else { "–".to_owned() };
        vec![name.to_owned(), quantity(&significant(value, 3), &gap.unit), ratio, note]
    };
    let closed = |of: &WithInterval| format!("closes {}", share_with_interval(of));
    let same = gap.repaired == gap.recalibrated;
    let nothing = result.verdict.status == VerdictStatus::None;
    let is_told = gap.is_closure_told();
    let mut rows = vec![
        row("simulator as given", gap.nominal, String::new()),
        row("recalibrated", gap.recalibrated, String::new()),
        row(
            if same { "repaired (the same)" } else { "repaired" },
            gap.repaired,
            if nothing {
                "there is no gap to close".to_owned()
            } else if !is_told {
                "the gap is too small compared with the noise to state its closure".to_owned()
            } else {
                format!("{} of the whole gap", closed(&gap.closure))
            },
        ),
        row("ceiling: a free torque added", gap.ceiling, String::new()),
        row("noise floor", gap.noise_floor, format!("95 %: {}", interval(gap.noise_floor_interval_95))),
    ];
    if let Some(note) =
        rows.get_mut(2).and_then(|row| row.last_mut()).filter(|_| !same && !nothing && is_told)
    {
        note.push_str(&format!(
            ", {} of the gap after recalibration",
            share_with_interval(&gap.closure_of_recalibrated)
        ));
    }
    let told = "× noise: the RMS divided by that of the sensor's noise; 1 is the best that a simulator can \
                reach";
    format!("{}\n{told}", table(&["held-out error", "RMS", "× noise", ""], rows))
}

fn apart(result: &DiagnosisResult) -> String {
    let mut lines: Vec<String> = result
        .verdict
        .equivalent
        .iter()
        .map(|class| format!("not distinguishable on these data: {}", class.join(" ~ ")))
        .collect();
    if lines.is_empty() {
        lines.extend(result.rivals.first().map(|rival| match rival {
            rival if rival.distance.is_finite() => format!(
                "distinguishable: {} is closest to {}, {} noise standard deviations away ({DISTINCT_DISTANCE} are enough)",
                rival.rival,
                rival.effect,
                significant(rival.distance, 2)
            ),
            _ => "every effect that was found is distinguishable from the others".to_owned(),
        }));
    }
    let distance = result.next_experiment.distance.map_or_else(String::new, |distance| {
        let enough = if distance < DISTINCT_DISTANCE { ", too small by itself" } else { "" };
        format!(
            " (predicted distance between them: {} noise standard deviations{enough})",
            significant(distance, 2)
        )
    });
    lines.push(format!("next experiment: {}{distance}", result.next_experiment.text));
    lines.join("\n")
}

fn whereabouts(result: &DiagnosisResult) -> String {
    let budget = &result.place.budget;
    let mut shares = [
        ("dissipative", budget.dissipative),
        ("conservative", budget.conservative),
        ("time-dependent", budget.time_dependent),
        ("sensor", budget.sensor),
        ("clock", budget.clock),
    ];
    shares.sort_by(|a, b| b.1.total_cmp(&a.1));
    let named: Vec<String> = shares
        .iter()
        .filter(|(_, share)| *share >= 0.005)
        .map(|(name, share)| format!("{name} {}", format::share(*share)))
        .collect();
    let kinds = if named.is_empty() {
        "the gap beyond recalibration: too small to divide".to_owned()
    } else {
        format!("the gap beyond recalibration: {}", named.join(", "))
    };
    let unit = &result.gap.unit;
    let [position, ..] = &result.units;
    let places: Vec<String> = [
        worst("time", &result.place.time, "s", unit),
        worst("amplitude", &result.place.amplitude, position, unit),
        worst("frequency", &result.place.frequency, "rad/s", unit),
    ]
    .into_iter()
    .flatten()
    .collect();
    if places.is_empty() { kinds } else { format!("{kinds}\nlargest at {}", places.join("; ")) }
}

/// Returns the significant cell with the largest value along an axis.
fn worst(axis: &str, cells: &[MapCell], axis_unit: &str, unit: &str) -> Option<String> {
    let significant_cells = cells.iter().filter(|cell| cell.significant);
    let cell = significant_cells.max_by(|a, b| a.value.total_cmp(&b.value))?;
    let [low, high] = cell.bounds.first()?;
    Some(format!(
        "{axis} {} to {} ({})",
        significant(*low, 3),
        quantity(&significant(*high, 3), axis_unit),
        quantity(&significant(cell.value, 2), unit)
    ))
}

fn calibration(result: &DiagnosisResult) -> String {
    let all = result.calibration.rows().into_iter();
    let rows: Vec<Vec<String>> = all
        .filter(|(_, row)| row.recalibrated.is_some() || row.repaired.is_some())
        .map(|(name, row)| calibrated(&name, row))
        .collect();
    if rows.is_empty() {
        return String::new();
    }
    table(&["coefficient", "given", "recalibrated", "repaired, 95 % interval"], rows)
}

fn calibrated(name: &str, row: &CalibratedRow) -> Vec<String> {
    let value = |found: &Option<WithInterval>| {
        found.as_ref().map_or_else(|| "held".to_owned(), |found| significant(found.value, 4))
    };
    let repaired = match (&row.repaired, row.determined) {
        (None, _) => "held".to_owned(),
        (_, Some(false)) => UNDETERMINED.to_owned(),
        (Some(found), _) => estimate(found.value, found.interval_95, unit(&row.unit)),
    };
    vec![name.to_owned(), significant(row.nominal, 4), value(&row.recalibrated), repaired]
}

fn chain(result: &DiagnosisResult) -> String {
    let chain = &result.measuring_chain;
    let resolution = chain.resolution.map_or_else(String::new, |step| {
        format!(", resolution {}", quantity(&significant(step, 3), &result.gap.unit))
    });
    let mut lines = vec![format!(
        "measurement chain: clock {}, {}{resolution}",
        chain.clock,
        quantity(&significant(chain.sample_rate_hz, 5), "Hz")
    )];
    lines.extend(chain.findings.iter().map(|finding| match &finding.effect {
        Some(effect) => format!("  {effect}: {}", finding.text),
        None => format!("  {}", finding.text),
    }));
    for record in &result.records {
        lines.push(format!("  {}: {}", record.path, record.reading.sentence));
        lines.extend(record.findings.iter().map(|finding| format!("  {}: {finding}", record.path)));
    }
    if result.samples_used < 0.9999 {
        lines.push(format!(
            "  {} of the samples were used: every n-th sample, as long as a swing stays well sampled, and \
             then evenly spaced stretches",
            format::share(result.samples_used)
        ));
    }
    lines.join("\n")
}

fn stages(result: &DiagnosisResult) -> String {
    let mut stages: Vec<String> = result
        .stages
        .iter()
        .filter(|stage| stage.seconds >= 0.01 * result.seconds)
        .map(|stage| format!("{} {:.2}", stage.name, stage.seconds))
        .collect();
    stages.insert(0, format!("{:.2} s", result.seconds));
    stages.join(", ")
}
