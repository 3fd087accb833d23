//! Plots of the page of trials.

use results::{Reliability, ReliabilityBin, TrialsResult};

use crate::figures::{Figure, csv, figure, number};
use crate::plot::{Axis, Hue, Mark, Plot, Series};

fn diagonal(label: &str) -> Series {
    Series {
        label: label.to_owned(),
        hue: Hue::Data,
        mark: Mark::Dashes,
        points: vec![(0.0, 0.0), (1.0, 1.0)],
    }
}

/// Plots observed shares against stated probabilities, for each kind of probability and group of banks.
pub(super) fn reliability(result: &TrialsResult) -> Option<Figure> {
    let shown: Vec<&Reliability> =
        result.reliability.iter().filter(|study| study.subject != "confidence, not mapped").collect();
    let mut series = vec![diagonal("perfect calibration")];
    for (index, study) in shown.iter().enumerate() {
        series.push(Series {
            label: format!("{}, {}", study.subject, study.banks),
            hue: Hue::of_series(index),
            // The hues repeat after four.
            mark: if index < 4 { Mark::Line } else { Mark::DottedLine },
            points: study.bins.iter().map(|bin| (bin.stated, bin.found.share)).collect(),
        });
    }
    let rows: Vec<(&Reliability, &ReliabilityBin)> =
        shown.iter().flat_map(|study| study.bins.iter().map(move |bin| (*study, bin))).collect();
    let table =
        csv(&["subject", "banks", "stated", "found", "low", "high", "cases"], &rows, |(study, bin)| {
            let [low, high] = bin.found.interval_95;
            vec![
                study.subject.clone(),
                study.banks.clone(),
                number(bin.stated),
                number(bin.found.share),
                number(low),
                number(high),
                bin.found.of.to_string(),
            ]
        });
    if rows.is_empty() {
        return None;
    }
    let plot = Plot {
        x: Axis::linear("stated probability, mean of a bin"),
        y: Axis::linear("share that came true"),
        series,
        shaded: Vec::new(),
    };
    let explanation = "Each point is a tenth of the statements. Below the dashed line the diagnosis is \
                       overconfident, above it underconfident.";
    figure("reliability", "Reliability", explanation, &plot, table)
}

/// Plots hits against false alarms of `unknown`.
pub(super) fn unknown(result: &TrialsResult) -> Option<Figure> {
    let curve = &result.unknown.curve;
    if curve.is_empty() {
        return None;
    }
    let plot = Plot {
        x: Axis::linear("share called unknown: cases of a known effect or none"),
        y: Axis::linear("share called unknown: cases of an unknown effect"),
        series: vec![
            diagonal("chance"),
            Series {
                label: "probability of unknown above a threshold".to_owned(),
                hue: Hue::Estimate,
                mark: Mark::Line,
                points: curve.iter().map(|[alarms, hits]| (*alarms, *hits)).collect(),
            },
        ],
        shaded: Vec::new(),
    };
    let table = csv(&["false_alarms", "hits"], curve, |[alarms, hits]| vec![number(*alarms), number(*hits)]);
    let explanation = "Receiver operating characteristic over all thresholds, with all sizes together.";
    figure("unknown-curve", "Unknown against named", explanation, &plot, table)
}
