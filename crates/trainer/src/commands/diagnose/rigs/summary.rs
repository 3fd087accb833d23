//! Terminal output for several rigs.

use crate::terminal::table::table;
use report::{class_title, format};
use results::{RigRow, RigsResult, SharedCoefficientRow};
use std::path::Path;

/// Probability, over all rigs and on each of them, below which a class is listed in `rigs.json` only.
const LEAST: f64 = 0.1;

/// Summarizes the shared effects: a table of classes, a table of coefficients, and sentences.
pub(super) fn summary(result: &RigsResult, folder: &Path) -> String {
    let names: Vec<&str> = result.rigs.iter().map(|rig| rig.name.as_str()).collect();
    let state = match (result.complete, result.failed.len()) {
        (false, _) => ": INTERRUPTED".to_owned(),
        (true, 0) => String::new(),
        (true, failed) => format!(": {failed} FAILED"),
    };
    let parts = [
        format!(
            "{} of one build{state}\n{}",
            record::counted(names.len(), "rig"),
            result.sentences.join("\n")
        ),
        classes(result, &names),
        coefficients(result, &names),
        format!(
            "took: {:.2} s\nreport: {path}/report.html\neach rig: {path}/<rig>/report.html",
            result.seconds,
            path = folder.display()
        ),
    ];
    parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("\n\n")
}

fn classes(result: &RigsResult, names: &[&str]) -> String {
    let own = |rig: &RigRow, id: &str| {
        rig.classes.iter().find(|class| class.id == id).map(|class| class.probability)
    };
    let rows: Vec<Vec<String>> = result
        .classes
        .iter()
        .filter(|class| {
            let most =
                result.rigs.iter().filter_map(|rig| own(rig, &class.id)).fold(class.probability, f64::max);
            most >= LEAST
        })
        .map(|class| {
            let mut cells = vec![class_title(&class.id), format::probability(class.probability)];
            let of = |rig: &RigRow| own(rig, &class.id).map_or_else(|| "–".to_owned(), format::probability);
            cells.extend(result.rigs.iter().map(of));
            cells
        })
        .collect();
    let mut header = vec!["class of effects, probability", "all"];
    header.extend(names);
    if rows.is_empty() { String::new() } else { table(&header, rows) }
}

fn coefficients(result: &RigsResult, names: &[&str]) -> String {
    let rows: Vec<Vec<String>> = result
        .classes
        .iter()
        .filter(|class| class.probability >= LEAST)
        .flat_map(|class| &class.coefficients)
        .map(|row| {
            let mut cells =
                vec![format!("{}, {}", row.effect.replace('_', " "), row.parameter.replace('_', " "))];
            cells.extend(names.iter().map(|name| {
                let own = row.values.iter().find(|value| value.rig == *name);
                own.map_or_else(
                    || "–".to_owned(),
                    |own| format::estimate(own.value, own.interval_95, format::unit(&own.unit)),
                )
            }));
            cells.push(agreement(row));
            cells
        })
        .collect();
    let mut header = vec!["coefficient, 95 % interval"];
    header.extend(names);
    header.push("");
    if rows.is_empty() { String::new() } else { table(&header, rows) }
}

fn agreement(row: &SharedCoefficientRow) -> String {
    match (row.agree, row.chi_squared) {
        (Some(agree), Some(chi_squared)) => {
            let verdict = if agree { "agree" } else { "DIFFER" };
            format!("{verdict}, χ² {} of {}", format::significant(chi_squared, 2), row.degrees)
        }
        _ => "not compared".to_owned(),
    }
}
