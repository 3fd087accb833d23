//! Data of the interactive plot, as JSON inside the page.
//!
//! Points with the same horizontal coordinates share one table. A column is stored as whole steps of about a
//! millionth of its range, each as the difference from the previous one. This takes a third of the text of
//! decimal numbers and is finer than any screen. On a logarithmic axis, the decimal logarithm is stored.

use serde_json::{Value, json};

use super::{Axis, Mark, Plot, Scale, Series};

/// Number of values of all series together beyond which every stretch keeps only its lowest and highest
/// values.
const MOST_VALUES: usize = 16_000;
/// Number of steps across the range of a column.
const STEPS: f64 = 1e6;

/// Series with the same horizontal coordinates.
struct Table {
    x: Vec<f64>,
    columns: Vec<Vec<f64>>,
}

impl Plot {
    /// Returns the plot in the form that `plots.js` reads; `None` if nothing can be shown or a line runs back
    /// and forth.
    pub(super) fn live(&self, legend: impl Fn(&Series) -> Option<usize>) -> Option<String> {
        let shown = || self.series.iter().flat_map(|series| &series.points).filter(|p| self.can_show(**p));
        let ends = shown().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), point| {
            (low.min(point.0), high.max(point.0))
        });
        if ends.0 > ends.1 {
            return None;
        }
        let mut tables: Vec<Table> = Vec::new();
        let mut places = Vec::new();
        for series in &self.series {
            let (x, y) = self.columns(series, ends)?;
            let same = tables.iter().position(|table| same_bits(&table.x, &x));
            let at = same.unwrap_or(tables.len());
            if same.is_none() {
                tables.push(Table { x, columns: Vec::new() });
            }
            let table = tables.get_mut(at)?;
            places.push((at, table.columns.len()));
            table.columns.push(y);
        }
        let total: usize = tables.iter().map(|table| table.x.len() * table.columns.len()).sum();
        if total > MOST_VALUES {
            for table in &mut tables {
                *table = table.thinned(MOST_VALUES * table.x.len() / total);
            }
        }
        let series: Vec<Value> = self
            .series
            .iter()
            .zip(places)
            .map(|(series, (table, column))| {
                json!({ "label": series.label, "hue": series.hue.name(), "mark": name(series.mark),
                        "legend": legend(series), "table": table, "column": column })
            })
            .collect();
        let shaded: Vec<[f64; 2]> = self
            .shaded
            .iter()
            .filter(|(from, to)| self.x.can_show(*from) && self.x.can_show(*to))
            .map(|(from, to)| [place(&self.x, *from), place(&self.x, *to)])
            .collect();
        let tables: Vec<Value> = tables.iter().map(Table::json).collect();
        let plot = json!({ "x": axis(&self.x), "y": axis(&self.y), "shaded": shaded, "series": series, "tables": tables });
        // Inside a script element, only this character could end it.
        Some(plot.to_string().replace('<', "\\u003c"))
    }

    /// Returns the increasing horizontal coordinates of a series and its vertical ones, NaN where its line is
    /// interrupted.
    fn columns(&self, series: &Series, ends: (f64, f64)) -> Option<(Vec<f64>, Vec<f64>)> {
        let mut points: Vec<(f64, f64)> = Vec::with_capacity(series.points.len());
        for &(x, y) in &series.points {
            let y = if self.can_show((x, y)) { place(&self.y, y) } else { f64::NAN };
            if self.x.can_show(x) {
                points.push((place(&self.x, x), y));
            } else if let Some(&(last, _)) = points.last() {
                points.push((last, f64::NAN));
            }
        }
        match series.mark {
            Mark::Level | Mark::DottedLevel => {
                let height = points.first().map_or(f64::NAN, |point| point.1);
                points = [ends.0, ends.1].map(|x| (place(&self.x, x), height)).to_vec();
            }
            Mark::Dots => points.sort_by(|a, b| a.0.total_cmp(&b.0)),
            Mark::Line | Mark::Dashes | Mark::DottedLine => {
                if !points.is_sorted_by(|a, b| a.0 <= b.0) {
                    points.reverse();
                }
                if !points.is_sorted_by(|a, b| a.0 <= b.0) {
                    return None;
                }
            }
        }
        Some(points.into_iter().unzip())
    }
}

impl Table {
    /// Returns the table thinned to about `rows` rows: of every stretch, the lowest and the highest value of
    /// each column, and interruptions of lines.
    fn thinned(&self, rows: usize) -> Self {
        let stretch = (self.x.len() * 2 * self.columns.len()).div_ceil(rows.max(4)).max(1);
        let mut kept = vec![0, self.x.len().saturating_sub(1)];
        for start in (0..self.x.len()).step_by(stretch) {
            let end = (start + stretch).min(self.x.len());
            for column in &self.columns {
                let Some(part) = column.get(start..end) else { continue };
                let by_height = |a: &(usize, &f64), b: &(usize, &f64)| a.1.total_cmp(b.1);
                let finite = || part.iter().enumerate().filter(|(_, value)| value.is_finite());
                let interrupted = part.iter().position(|value| value.is_nan());
                let extremes = [finite().min_by(by_height), finite().max_by(by_height)];
                kept.extend(extremes.into_iter().flatten().map(|(at, _)| start + at));
                kept.extend(interrupted.map(|at| start + at));
            }
        }
        kept.sort_unstable();
        kept.dedup();
        let of = |column: &[f64]| kept.iter().filter_map(|at| column.get(*at).copied()).collect();
        Self { x: of(&self.x), columns: self.columns.iter().map(|column| of(column)).collect() }
    }

    fn json(&self) -> Value {
        let columns: Vec<Value> = self.columns.iter().map(|column| encoded(column, false)).collect();
        json!({ "x": encoded(&self.x, true), "columns": columns })
    }
}

/// Encodes a column as whole steps from value to value, `null` where there is no value. A rising column rises
/// by at least one step, so that no two points share a horizontal coordinate: an interruption keeps its own
/// place.
fn encoded(column: &[f64], rising: bool) -> Value {
    let finite = || column.iter().copied().filter(|value| value.is_finite());
    let (low, high) = finite().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    let from = finite().next().unwrap_or(0.0);
    // A power of ten, so that a round number stays round.
    let step = if high > low { 10f64.powf(((high - low) / STEPS).log10().floor()) } else { 1.0 };
    let mut last: Option<i64> = None;
    let deltas: Vec<Option<i64>> = column
        .iter()
        .map(|value| {
            value.is_finite().then(|| {
                let mut at = ((value - from) / step).round() as i64;
                if let (true, Some(last)) = (rising, last) {
                    at = at.max(last + 1);
                }
                let delta = last.map_or(at, |last| at - last);
                last = Some(at);
                delta
            })
        })
        .collect();
    json!({ "from": from, "step": step, "deltas": deltas })
}

fn place(axis: &Axis, value: f64) -> f64 {
    match axis.scale {
        Scale::Linear => value,
        Scale::Log => value.log10(),
    }
}

fn axis(axis: &Axis) -> Value {
    json!({ "label": axis.label, "log": axis.scale == Scale::Log })
}

fn name(mark: Mark) -> &'static str {
    match mark {
        Mark::Dots => "dots",
        Mark::Line => "line",
        Mark::Dashes => "dashes",
        Mark::DottedLine => "dotted-line",
        Mark::Level => "level",
        Mark::DottedLevel => "dotted-level",
    }
}

fn same_bits(one: &[f64], other: &[f64]) -> bool {
    one.len() == other.len() && one.iter().zip(other).all(|(a, b)| a.to_bits() == b.to_bits())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::Hue;

    fn plot(y: Axis, mark: Mark, points: Vec<(f64, f64)>) -> Plot {
        let series = Series { label: "a<b".into(), hue: Hue::Data, mark, points };
        Plot { x: Axis::linear("time (s)"), y, series: vec![series], shaded: vec![(0.5, 1.0)] }
    }

    fn read(plot: &Plot) -> Value {
        serde_json::from_str(&plot.live(|_| Some(0)).unwrap()).unwrap()
    }

    /// Decodes a column as `plots.js` does.
    fn decoded(column: &Value) -> Vec<Option<f64>> {
        let mut at = 0;
        let (from, step) = (column["from"].as_f64().unwrap(), column["step"].as_f64().unwrap());
        let deltas = column["deltas"].as_array().unwrap();
        deltas
            .iter()
            .map(|delta| {
                delta.as_i64().map(|delta| {
                    at += delta;
                    from + step * at as f64
                })
            })
            .collect()
    }

    #[test]
    fn values_come_back_to_a_millionth_of_their_range() {
        let points: Vec<(f64, f64)> =
            (0..1000).map(|i| (0.004 * f64::from(i), (f64::from(i)).sin())).collect();
        let live = read(&plot(Axis::linear("y"), Mark::Line, points.clone()));
        let (x, y) = (decoded(&live["tables"][0]["x"]), decoded(&live["tables"][0]["columns"][0]));
        for ((x, y), point) in x.iter().zip(&y).zip(&points) {
            assert!((x.unwrap() - point.0).abs() < 4e-6 && (y.unwrap() - point.1).abs() < 2e-6);
        }
    }

    #[test]
    fn an_interruption_has_a_place_of_its_own() {
        let points = vec![(0.0, 1.0), (5.0, f64::NAN), (5.0, 2.0), (6.0, 3.0)];
        let live = read(&plot(Axis::linear("y"), Mark::Line, points));
        let x = decoded(&live["tables"][0]["x"]);
        assert!(x.windows(2).all(|pair| pair[0].unwrap() < pair[1].unwrap()), "{x:?}");
        assert_eq!(decoded(&live["tables"][0]["columns"][0])[1], None);
    }

    #[test]
    fn a_logarithmic_axis_holds_decimal_logarithms() {
        let live = read(&plot(Axis::log("y"), Mark::Line, vec![(0.0, 1e-300), (1.0, 0.0), (2.0, 1e-3)]));
        let y = decoded(&live["tables"][0]["columns"][0]);
        assert_eq!(y[1], None);
        assert!((y[0].unwrap() + 300.0).abs() < 1e-9 && (y[2].unwrap() + 3.0).abs() < 1e-3, "{y:?}");
    }

    #[test]
    fn long_lines_keep_their_peaks_and_stay_small() {
        let mut points: Vec<_> = (0..300_000).map(|i| (f64::from(i), f64::from(i % 7))).collect();
        points[123_456].1 = 9.0;
        let plot = plot(Axis::linear("y"), Mark::Line, points);
        assert!(plot.live(|_| None).unwrap().len() < 300_000);
        let y = decoded(&read(&plot)["tables"][0]["columns"][0]);
        assert!(y.len() > 10_000 && y.iter().flatten().any(|value| (value - 9.0).abs() < 1e-5));
    }

    #[test]
    fn a_line_back_and_forth_has_no_live_plot_and_dots_do() {
        let zigzag = vec![(0.0, 0.0), (2.0, 1.0), (1.0, 2.0)];
        assert!(plot(Axis::linear("y"), Mark::Line, zigzag.clone()).live(|_| None).is_none());
        assert!(plot(Axis::linear("y"), Mark::Dots, zigzag).live(|_| None).is_some());
        let back = vec![(2.0, 0.0), (1.0, 1.0)];
        assert!(plot(Axis::linear("y"), Mark::Line, back).live(|_| None).is_some());
        assert!(plot(Axis::linear("y"), Mark::Line, vec![]).live(|_| None).is_none());
    }

    #[test]
    fn a_level_spans_what_is_shown_and_no_label_ends_the_script() {
        let mut both = plot(Axis::linear("y"), Mark::Dots, vec![(1.0, 1.0), (3.0, 2.0)]);
        both.series.push(Series { mark: Mark::Level, points: vec![(1.0, 7.0)], ..both.series[0].clone() });
        let text = both.live(|_| Some(1)).unwrap();
        assert!(!text.contains('<'));
        let live: Value = serde_json::from_str(&text).unwrap();
        let place = &live["series"][1];
        let table = &live["tables"][place["table"].as_u64().unwrap() as usize];
        assert_eq!(decoded(&table["x"]), [Some(1.0), Some(3.0)]);
        assert_eq!(decoded(&table["columns"][place["column"].as_u64().unwrap() as usize]), [Some(7.0); 2]);
    }
}
