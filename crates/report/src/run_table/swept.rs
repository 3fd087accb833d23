//! The plots of a metric against each varied key: along an axis for numbers, in rows for words.

use results::{RunTable, RunTableRow, SweepSampler};
use scoring::median;
use serde_json::Value;

use super::cells::{has_data_sets, short_key, short_name, shown};
use super::figures::{drawn, figure as rows_figure, settings, short_label};
use crate::figures::{Figure, csv, figure as plot_figure, number};
use crate::plot::{Axis, BREAK, DotRow, DotRows, Hue, Mark, Plot, Series};
use crate::tables::anchor;

/// Plots of one page; of a search over more keys, the table and its file have the others.
const MOST_KEYS: usize = 8;
/// Lines of one plot: as many as there are hues of equal rank.
const MOST_LINES: usize = 4;
/// Ratio of the largest to the smallest positive value from which on a logarithmic axis is easier to read.
const DECADES: f64 = 30.0;

/// Number by which the runs are compared.
struct Metric<'a> {
    label: String,
    of: Of<'a>,
    /// `true` if larger values are better.
    maximize: bool,
}

/// Place of a metric in a row.
enum Of<'a> {
    /// The measure of a search, by its name.
    Measure(&'a str),
    /// The error of learners.
    Validation,
    /// The distance from the reference.
    Distance,
}

impl Metric<'_> {
    fn of(&self, row: &RunTableRow) -> Option<f64> {
        match self.of {
            Of::Measure(name) => row.settings.get(name)?.as_f64(),
            Of::Validation => row.learned.as_ref()?.validation_over_noise,
            Of::Distance => row.error_percent.map(drawn),
        }
    }
}

/// A run with its value of a key and its metric.
struct Point<'a> {
    row: &'a RunTableRow,
    value: Value,
    metric: f64,
}

pub(super) fn figures(table: &RunTable) -> Vec<Figure> {
    let metric = metric(table);
    let keys = std::iter::once(METHOD).chain(settings(table).filter(|key| *key != "seed"));
    let varied: Vec<(&str, Vec<Point<'_>>)> =
        keys.map(|key| (key, points(table, &metric, key))).filter(|(_, points)| differ(points)).collect();
    let is_only = varied.len() == 1;
    varied
        .iter()
        .filter_map(|(key, points)| {
            match points.iter().map(|point| point.value.as_f64()).collect::<Option<Vec<f64>>>() {
                Some(values) => numeric(table, &metric, key, points, &values),
                // The plot by setting shows the same.
                None if is_only && matches!(metric.of, Of::Distance) => None,
                None => words(table, &metric, key, points),
            }
        })
        .take(MOST_KEYS)
        .collect()
}

/// Stands for the method, which is no key.
const METHOD: &str = "method";

/// Returns the measure of a search, else the error of learners, else the distance from the reference.
fn metric(table: &RunTable) -> Metric<'_> {
    let (label, of) = match &table.search {
        Some(search) => (search.measure.as_str(), Of::Measure(&search.measure)),
        None if table.rows.iter().any(|row| row.learned.is_some()) => {
            ("validation error (× noise)", Of::Validation)
        }
        None => ("distance from the reference in ζ (%)", Of::Distance),
    };
    let maximize = table.search.as_ref().is_some_and(|search| search.maximize);
    Metric { label: label.to_owned(), of, maximize }
}

/// Returns the runs that have a value of a key and a metric.
fn points<'a>(table: &'a RunTable, metric: &Metric<'_>, key: &str) -> Vec<Point<'a>> {
    let value = |row: &RunTableRow| match key {
        METHOD => (!row.estimator.is_empty()).then(|| row.estimator.clone().into()),
        key => row.settings.get(key).cloned(),
    };
    let point = |row| Some(Point { row, value: value(row)?, metric: metric.of(row)? });
    table.rows.iter().filter_map(point).filter(|point| point.metric.is_finite()).collect()
}

fn differ(points: &[Point<'_>]) -> bool {
    points.iter().any(|point| Some(&point.value) != points.first().map(|first| &first.value))
}

/// Returns an axis for values: logarithmic if they span decades.
fn axis(label: &str, values: impl Iterator<Item = f64>) -> Axis {
    let (low, high) = values
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    if low > 0.0 && high >= DECADES * low { Axis::log(label) } else { Axis::linear(label) }
}

fn numeric(
    table: &RunTable,
    metric: &Metric<'_>,
    key: &str,
    points: &[Point<'_>],
    values: &[f64],
) -> Option<Figure> {
    let placed: Vec<(f64, &Point<'_>)> = values.iter().copied().zip(points).collect();
    let runs = placed.iter().flat_map(|(x, point)| [(*x, point.metric), BREAK]).collect();
    let mut series = lines(table, key, &placed);
    let has_lines = !series.is_empty();
    series.push(Series { label: "a run".into(), hue: Hue::Data, mark: Mark::Dots, points: runs });
    let plot = Plot {
        x: axis(key, values.iter().copied()),
        y: axis(&metric.label, points.iter().map(|point| point.metric)),
        series,
        shaded: vec![],
    };
    let title = title(table, metric, key, "against");
    let explanation = match has_lines {
        true => {
            "Each dot is a run. Lines join the medians over the runs that differ in nothing but their seed, or in all \
             other keys if these have more combinations than a plot has room for."
        }
        false => "Each dot is a run.",
    };
    plot_figure(id(key), title, explanation, &plot, data(table, key, points))
}

/// Returns the medians over equal values of a key: a line for each combination of the other keys and data set, or a
/// single line if there are too many of them. A search draws its points: it has no equal values.
fn lines(table: &RunTable, key: &str, placed: &[(f64, &Point<'_>)]) -> Vec<Series> {
    if table.search.as_ref().is_some_and(|search| search.sampler != SweepSampler::Grid) {
        return Vec::new();
    }
    let has_data_sets = has_data_sets(table);
    let others = |row: &RunTableRow| {
        let label = short_label(table, row, &|other| other != key && other != "seed");
        match row.learned.as_ref().filter(|_| has_data_sets) {
            Some(of) => format!("{label}, {}", of.problem),
            None => label,
        }
    };
    let mut names: Vec<String> = Vec::new();
    for (_, point) in placed {
        let name = others(point.row);
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let is_single = names.len() > MOST_LINES || names.len() == 1;
    if is_single {
        names = vec!["median".to_owned()];
    }
    let line = |(index, name): (usize, String)| {
        let own: Vec<&(f64, &Point<'_>)> =
            placed.iter().filter(|(_, point)| is_single || others(point.row) == name).collect();
        let mut places: Vec<f64> = own.iter().map(|(x, _)| *x).collect();
        places.sort_by(f64::total_cmp);
        places.dedup();
        let middle = |at: f64| median(own.iter().filter(|(x, _)| *x == at).map(|(_, point)| point.metric));
        let points = places.into_iter().map(|at| (at, middle(at))).collect();
        Series { label: name, hue: Hue::of_series(index), mark: Mark::Line, points }
    };
    names.into_iter().enumerate().map(line).collect()
}

fn words(table: &RunTable, metric: &Metric<'_>, key: &str, points: &[Point<'_>]) -> Option<Figure> {
    let mut names: Vec<String> = Vec::new();
    for point in points {
        let name = shown(&point.value);
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let row = |name: String| {
        let own = || points.iter().filter(|point| shown(&point.value) == name).map(|point| point.metric);
        let worst = if metric.maximize { own().reduce(f64::min) } else { own().reduce(f64::max) };
        DotRow { value: Some(median(own())), extreme: worst, interval: None, name }
    };
    let plot = DotRows {
        x: axis(&metric.label, points.iter().map(|point| point.metric)),
        rows: names.into_iter().map(row).collect(),
        value_label: "median over the runs of a row".into(),
        extreme_label: "the worst of them".into(),
        level: None,
    };
    let title = title(table, metric, key, "by");
    let explanation =
        "One row for each value; all runs with this value share the row, whatever their other settings.";
    rows_figure(id(key), title, explanation, &plot, Vec::new(), data(table, key, points))
}

fn id(key: &str) -> String {
    format!("by-{}", anchor(key))
}

fn title(table: &RunTable, metric: &Metric<'_>, key: &str, relation: &str) -> String {
    let what = metric.label.split(" (").next().unwrap_or(&metric.label);
    let mut letters = what.chars();
    // A measure is a path, and is written as it is.
    let what = match letters.next() {
        Some(first) if !what.contains(['.', '_']) => first.to_uppercase().chain(letters).collect(),
        _ => what.to_owned(),
    };
    format!("{what} {relation} {}", short_key(table, key))
}

fn data(table: &RunTable, key: &str, points: &[Point<'_>]) -> (String, String) {
    csv(&["run", key, "metric"], points, |point| {
        vec![short_name(table, &point.row.run), shown(&point.value), number(point.metric)]
    })
}
