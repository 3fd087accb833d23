//! Plot of a record of which only a part was read.

use results::Reading;

use crate::Reader;
use crate::figures::{Figure, csv, number};
use crate::format::{quantity, significant};
use crate::plot::{Axis, Hue, Mark, Plot, Series};

/// Returns the plot of a whole record with the part that was read shaded; `None` if all of it was read.
///
/// `title` names the record, and `axis` its values.
pub(crate) fn figure(
    id: String,
    title: String,
    axis: Axis,
    reading: &Reading,
    reader: Reader,
) -> Option<Figure> {
    let (whole, [from, to]) = (reading.whole.as_ref()?, reading.part_s?);
    let plot = Plot {
        x: Axis::linear("time (s)"),
        y: axis,
        series: vec![Series {
            label: "recorded".to_owned(),
            hue: Hue::Data,
            mark: Mark::Line,
            points: whole.outline.iter().map(|[time, value]| (*time, *value)).collect(),
        }],
        shaded: vec![(from, to)],
    };
    let drawing = plot.draw("The whole record over time, with the part that was read.")?;
    let time = |value: f64| quantity(&significant(value, 4), "s");
    let others = whole.free_s.iter().filter(|free| **free != [from, to]);
    let others: Vec<String> = others.map(|[from, to]| format!("{} to {}", time(*from), time(*to))).collect();
    let why = if whole.free_s.is_empty() { "" } else { ", since it swings freely there" };
    let also = if others.is_empty() {
        String::new()
    } else {
        format!(" It also swings freely from {}.", others.join(" and from "))
    };
    let keys = match reader {
        Reader::CommandLine => "--from and --to, or data.from_s and data.to_s",
        Reader::Page => "“from” and “to”",
    };
    let explanation = format!(
        "The file's own time. Shaded: the part from {} to {}, which was read{why}.{also} Another part is taken with \
         {keys}.",
        time(from),
        time(to)
    );
    let (csv, rows) =
        csv(&["time_s", "observed"], &whole.outline, |point: &[f64; 2]| point.map(number).to_vec());
    Some(Figure { id: id.into(), title: title.into(), explanation, notes: Vec::new(), drawing, csv, rows })
}
