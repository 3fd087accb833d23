//! Parts shared by the plots of a diagnosis.

use crate::figures::Figure;
use crate::plot::{Axis, Drawing, Hue, Mark, Series};
use record::Unit;
use results::DiagnosisResult;

/// Returns a drawing with its title, explanation and data.
pub(super) fn framed(
    id: &'static str,
    title: String,
    explanation: String,
    drawing: Drawing,
    (csv, rows): (String, String),
) -> Figure {
    let mut notes = Vec::new();
    if drawing.left_out > 0 {
        notes.push(format!("Values that are not finite are left out: {}.", drawing.left_out));
    }
    Figure { id: id.into(), title: title.into(), explanation, notes, drawing, csv, rows }
}

/// The simulator that a series belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Simulator {
    Given,
    Recalibrated,
    Repaired,
}

impl Simulator {
    /// Returns the simulator's series; each simulator has one color on the whole page.
    pub(super) fn series(self, mark: Mark, points: Vec<(f64, f64)>) -> Series {
        let (label, hue) = match self {
            Self::Given => ("simulator as given", Hue::Third),
            Self::Recalibrated => ("recalibrated", Hue::Oracle),
            Self::Repaired => ("repaired", Hue::Estimate),
        };
        Series { label: label.to_owned(), hue, mark, points }
    }
}

/// Returns the series of the record.
pub(super) fn recorded(mark: Mark, points: Vec<(f64, f64)>) -> Series {
    Series { label: "recorded".to_owned(), hue: Hue::Data, mark, points }
}

/// Returns the axis of the observed quantity.
pub(super) fn observed_axis(result: &DiagnosisResult) -> Axis {
    let what = match (result.quantity.as_str(), Unit::parse(&result.gap.unit)) {
        ("position", Some(unit)) if unit.is_signal() => "signal",
        ("position", Some(unit)) if unit.si() == "rad" => "angle",
        ("position", Some(_)) => "displacement",
        (other, _) => other,
    };
    Axis::linear(format!("{what} ({})", result.gap.unit))
}
