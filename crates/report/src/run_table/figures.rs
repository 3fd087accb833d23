//! The plots of many runs: distance from the reference by setting, damping ratio by run.

use std::borrow::Cow;

use results::{RunTable, RunTableRow};

use super::cells::{short_key, short_name, shown};
use crate::figures::{Figure, csv, number};
use crate::format;
use crate::plot::{Axis, DotRow, DotRows};
use scoring::median;

/// Errors below this, in percent, are drawn at it: the spacing of doubles, where digits end.
const LEAST_PERCENT: f64 = 100.0 * f64::EPSILON;
/// Rows of one plot; beyond, a table reads better.
const MOST_ROWS: usize = 200;
/// Letters of a value beside a row.
const MOST_LETTERS: usize = 16;
/// Letters of a label beside a row, beyond which its keys are left out in favor of their values.
const LONGEST_LABEL: usize = 48;

pub(super) fn figures(table: &RunTable) -> Vec<Figure> {
    [gaps(table), ratios(table)].into_iter().flatten().collect()
}

/// Runs that differ in nothing but their seed.
struct Group<'a> {
    name: String,
    rows: Vec<&'a RunTableRow>,
}

/// The rows with an estimate by everything but the seed, in the order in which they are met.
fn groups(table: &RunTable) -> Vec<Group<'_>> {
    let mut groups: Vec<Group<'_>> = Vec::new();
    for row in table.rows.iter().filter(|row| row.zeta.is_some()) {
        let name = label(table, row, &|key| key != "seed");
        match groups.iter_mut().find(|group| group.name == name) {
            Some(group) => group.rows.push(row),
            None => groups.push(Group { name, rows: vec![row] }),
        }
    }
    groups
}

impl Group<'_> {
    /// Label beside its row of a plot.
    fn short_name(&self, table: &RunTable) -> String {
        self.rows.first().map_or_else(String::new, |row| short_label(table, row, &|key| key != "seed"))
    }
}

/// The method, if the runs differ in it, and what else differs, as `pinn, hidden = [64]`.
fn label(table: &RunTable, row: &RunTableRow, wanted: &dyn Fn(&str) -> bool) -> String {
    parts(table, row, wanted, &|value| value)
}

/// As [`label`], of long values their ends alone: of paths that is where they differ. Of a label that is too
/// long all the same, the values alone, because they tell the rows apart.
pub(super) fn short_label(table: &RunTable, row: &RunTableRow, wanted: &dyn Fn(&str) -> bool) -> String {
    let ended = |value: String| {
        let left_out = value.chars().count().saturating_sub(MOST_LETTERS);
        if left_out == 0 { value } else { format!("…{}", value.chars().skip(left_out).collect::<String>()) }
    };
    let label = parts(table, row, wanted, &ended);
    if label.chars().count() <= LONGEST_LABEL {
        return label;
    }
    let values = settings(table)
        .filter(|key| wanted(key))
        .filter_map(|key| row.settings.get(key))
        .map(|value| ended(shown(value)));
    let method = is_shown(table, row).then(|| row.estimator.clone());
    method.into_iter().chain(values).collect::<Vec<_>>().join(", ")
}

/// Returns the columns that hold settings: the measure of a search is a result.
pub(super) fn settings(table: &RunTable) -> impl Iterator<Item = &str> {
    let measure = table.search.as_ref().map(|search| search.measure.as_str());
    table.columns.iter().map(String::as_str).filter(move |key| Some(*key) != measure)
}

/// Returns `true` if the method of a row is part of its label: the runs differ in it, or in nothing else.
fn is_shown(table: &RunTable, row: &RunTableRow) -> bool {
    table.columns.is_empty() || table.rows.iter().any(|other| other.estimator != row.estimator)
}

fn parts(
    table: &RunTable,
    row: &RunTableRow,
    wanted: &dyn Fn(&str) -> bool,
    shape: &dyn Fn(String) -> String,
) -> String {
    let mut parts: Vec<String> = is_shown(table, row).then(|| row.estimator.clone()).into_iter().collect();
    for key in settings(table).filter(|key| wanted(key)) {
        if let Some(value) = row.settings.get(key) {
            parts.push(format!("{} = {}", short_key(table, key), shape(shown(value))));
        }
    }
    if parts.is_empty() {
        // Runs that differ in their seed alone.
        parts.push(row.estimator.clone());
    }
    parts.join(", ")
}

/// Returns an error in percent as it is drawn. `max` would turn a value that is no number into one.
pub(super) fn drawn(error: f64) -> f64 {
    if error < LEAST_PERCENT { LEAST_PERCENT } else { error }
}

fn gaps(table: &RunTable) -> Option<Figure> {
    let groups = groups(table);
    let middle = |group: &Group<'_>| median(group.rows.iter().filter_map(|row| row.error_percent));
    let worst = |group: &Group<'_>| {
        group.rows.iter().filter_map(|row| row.worst_error_percent).max_by(f64::total_cmp).unwrap_or(f64::NAN)
    };
    let mut tolerances: Vec<f64> = table.rows.iter().filter_map(|row| row.tolerance_percent).collect();
    tolerances.dedup();
    let plot = DotRows {
        x: Axis::log("distance from the reference (least squares) in ζ (%)"),
        rows: groups
            .iter()
            .map(|group| DotRow {
                name: group.short_name(table),
                value: Some(drawn(middle(group))),
                extreme: Some(drawn(worst(group))),
                interval: None,
            })
            .collect(),
        value_label: "median over the runs of a row".into(),
        extreme_label: "worst of all their seeds".into(),
        level: match tolerances[..] {
            [one] => Some(("stated tolerance".into(), one)),
            _ => None,
        },
    };
    let explanation = "One row for each setting; runs that differ only in their seed share a row. Each \
                       decade to the left is one more digit of ζ shared with closed-form least squares on \
                       the same envelope. The distance shows how well a method solves the fit; it says \
                       nothing about the oscillator.";
    let table = csv(&["setting", "median_error_percent", "worst_error_percent", "runs"], &groups, |group| {
        vec![group.name.clone(), number(middle(group)), number(worst(group)), group.rows.len().to_string()]
    });
    let mut notes = Vec::new();
    if groups.iter().any(|group| middle(group) < LEAST_PERCENT || worst(group) < LEAST_PERCENT) {
        notes.push(format!(
            "Distances below {}, the precision of a double, are drawn at this value, including zero.",
            format::percent(LEAST_PERCENT)
        ));
    }
    figure("gaps", "Distance from the reference by setting", explanation, &plot, notes, table)
}

fn ratios(table: &RunTable) -> Option<Figure> {
    let rows: Vec<&RunTableRow> = table.rows.iter().filter(|row| row.zeta.is_some()).collect();
    let mut oracles: Vec<f64> = rows.iter().filter_map(|row| row.oracle_zeta).collect();
    oracles.dedup();
    let plot = DotRows {
        x: Axis::linear("damping ratio ζ"),
        rows: rows
            .iter()
            .map(|row| DotRow {
                name: short_label(table, row, &|_| true),
                value: row.zeta,
                extreme: None,
                interval: row.zeta_interval_95,
            })
            .collect(),
        value_label: "the method’s ζ with its 95 % interval, where it states one".into(),
        extreme_label: String::new(),
        level: match oracles[..] {
            [one] => Some(("closed-form least squares".into(), one)),
            _ => None,
        },
    };
    let explanation = "One row for each run. Where the dashed line is missing, the runs have different envelopes, and \
                       so different references.";
    let header = ["run", "setting", "zeta", "low_95", "high_95", "oracle_zeta"];
    let text = csv(&header, &rows, |row| {
        let [low, high] = row.zeta_interval_95.map_or([None, None], |ends| ends.map(Some));
        let cell = |value: Option<f64>| value.map_or_else(String::new, number);
        vec![
            short_name(table, &row.run),
            label(table, row, &|_| true),
            cell(row.zeta),
            cell(low),
            cell(high),
            cell(row.oracle_zeta),
        ]
    });
    figure("ratios", "Damping ratio by run", explanation, &plot, Vec::new(), text)
}

pub(super) fn figure(
    id: impl Into<Cow<'static, str>>,
    title: impl Into<Cow<'static, str>>,
    explanation: &str,
    plot: &DotRows,
    mut notes: Vec<String>,
    (csv, rows): (String, String),
) -> Option<Figure> {
    let title = title.into();
    let drawing = plot.draw(&format!("{title}: {}, one row each.", plot.x.label))?;
    if plot.rows.len() > MOST_ROWS {
        notes.push(format!("The first {MOST_ROWS} of {} rows.", plot.rows.len()));
    }
    if drawing.left_out > 0 {
        notes.push(format!("Values that are not finite have no mark: {}.", drawing.left_out));
    }
    Some(Figure { id: id.into(), title, explanation: explanation.to_owned(), notes, drawing, csv, rows })
}

#[cfg(test)]
mod tests {
    use super::{label, median, short_label};
    use results::{RunState, RunTable, RunTableRow, RunTableTask};

    #[test]
    fn of_a_long_value_its_end_is_shown() {
        let mut row = RunTableRow::without_numbers("a", RunState::Done, "");
        row.estimator = "pinn".into();
        row.settings.insert("data.path".into(), "a/long/way/to/record-07.csv".into());
        row.settings.insert("seed".into(), 3.into());
        let columns = vec!["data.path".into(), "seed".into()];
        let other = RunTableRow { estimator: "lstm".into(), ..row.clone() };
        let table = RunTable::new(RunTableTask::Runs, "", vec![], columns.clone(), vec![row.clone(), other]);
        assert_eq!(short_label(&table, &row, &|_| true), "pinn, path = …to/record-07.csv, seed = 3");
        assert_eq!(label(&table, &row, &|key| key != "seed"), "pinn, path = a/long/way/to/record-07.csv");
        // One method needs no name, and its runs that differ in their seed alone have no other.
        let table = RunTable::new(RunTableTask::Runs, "", vec![], columns, vec![row.clone()]);
        assert_eq!(short_label(&table, &row, &|_| true), "path = …to/record-07.csv, seed = 3");
        assert_eq!(label(&table, &row, &|_| false), "pinn");
    }

    #[test]
    fn of_a_long_label_the_values_are_left() {
        let mut row = RunTableRow::without_numbers("a", RunState::Done, "");
        row.settings.insert("estimator.physics_weight".into(), 123_456_789_012.0.into());
        row.settings.insert("estimator.collocation_points".into(), 128.into());
        let columns = row.settings.keys().cloned().collect();
        let table = RunTable::new(RunTableTask::Runs, "", vec![], columns, vec![row.clone()]);
        assert_eq!(short_label(&table, &row, &|_| true), "123456789012, 128");
    }

    #[test]
    fn the_median_is_the_middle() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(vec![4.0, 1.0, 2.0, 3.0]), 2.5);
        assert!(median(vec![]).is_nan());
    }
}
