//! Terminal output for a robot.

use crate::terminal::table::table;
use report::format::{self, estimate, quantity, significant, unit};
use results::{JointErrorRow, JointRow, JointsResult};
use std::path::Path;
use workflow::robot::RobotAnswer;

/// Summarizes the joints: a table of what is missing, one of the whole model's errors, and files.
pub(super) fn summary(RobotAnswer { result, repaired, .. }: &RobotAnswer, folder: &Path) -> String {
    let repaired = repaired.as_ref().map_or_else(String::new, |own| {
        format!("\nrepaired model: {}/repaired.{}", folder.display(), own.extension)
    });
    let failed: Vec<String> =
        result.failed.iter().map(|case| format!("no answer for {}: {}", case.id, case.message)).collect();
    let parts = [
        missing(result),
        coefficients(result),
        closed_loop(result),
        [failed, differing(result), result.notes.clone()].concat().join("\n"),
        format!(
            "took: {:.2} s\nreport: {path}/report.html\neach joint: {path}/<joint>/report.html{repaired}",
            result.seconds,
            path = folder.display()
        ),
    ];
    parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("\n\n")
}

/// Names recordings that differ from the others.
fn differing(result: &JointsResult) -> Vec<String> {
    let differing = result.recordings.iter().filter(|own| !own.agrees);
    differing
        .map(|own| format!("{} differs from the other recordings in {}", own.path, own.differs_in.join(", ")))
        .collect()
}

fn missing(result: &JointsResult) -> String {
    let mut rows = Vec::new();
    for joint in &result.joints {
        let statements = report::class_statements(&joint.diagnosis);
        if statements.is_empty() {
            rows.push(vec![
                joint.name.clone(),
                "–".to_owned(),
                joint.diagnosis.verdict.summary.clone(),
                String::new(),
                String::new(),
            ]);
        }
        for (at, one) in statements.iter().enumerate() {
            let name = if at == 0 { joint.name.clone() } else { String::new() };
            rows.push(vec![
                name,
                one.standing.word().to_owned(),
                one.title.clone(),
                format::probability(one.class.probability),
                one.sentence.clone(),
            ]);
        }
    }
    if rows.is_empty() { String::new() } else { table(&["joint", "", "missing", "probability", ""], rows) }
}

fn coefficients(result: &JointsResult) -> String {
    let row = |joint: &JointRow| {
        let symbols = match joint.diagnosis.gap.unit.as_str() {
            "m" => ["kg", "N s/m", "N", "1"],
            _ => ["kg m^2", "N m s/rad", "N m", "1"],
        };
        let own = &joint.repair;
        let cells = [own.armature, own.damping, own.torque_offset, own.torque_gain]
            .into_iter()
            .zip(symbols)
            .map(|(own, symbol)| {
                own.map_or_else(|| "–".to_owned(), |own| estimate(own.value, own.interval_95, unit(symbol)))
            });
        std::iter::once(joint.name.clone()).chain(cells).collect()
    };
    let rows: Vec<Vec<String>> = result.joints.iter().map(row).collect();
    if rows.is_empty() {
        String::new()
    } else {
        table(&["beside them, 95 % interval", "armature", "damping", "torque offset", "torque gain"], rows)
    }
}

fn closed_loop(result: &JointsResult) -> String {
    let Some(found) = &result.closed_loop else { return String::new() };
    let cell = |row: &JointErrorRow, own: Option<f64>| {
        own.map_or_else(
            || "left every bound".to_owned(),
            |own| quantity(&significant(own, 3), unit(&row.unit)),
        )
    };
    let rows: Vec<Vec<String>> = result
        .joints
        .iter()
        .filter_map(|joint| Some((joint, joint.closed_loop.as_ref()?)))
        .map(|(joint, row)| {
            let errors = [row.nominal, row.recalibrated, row.repaired].map(|own| cell(row, own));
            std::iter::once(joint.name.clone()).chain(errors).collect()
        })
        .collect();
    if rows.is_empty() {
        return String::new();
    }
    let title = format!("whole model, runs of {} s", significant(found.span_s, 2));
    format!(
        "{}\nheld out: {}",
        table(&[&title, "as given", "recalibrated", "repaired"], rows),
        found.held_out
    )
}
