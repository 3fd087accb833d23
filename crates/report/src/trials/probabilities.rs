//! Comparison of stated probabilities with observed shares.

use results::{Reliability, TrialsResult};

use super::figures;
use super::grid::{Grid, GridRow, Section};
use super::grids::{plain, size};
use crate::format::{count, fixed, interval};

pub(super) fn section(result: &TrialsResult) -> Section {
    let row = |study: &Reliability| GridRow {
        name: format!("{}, {}", study.subject, study.banks),
        cells: vec![
            plain(count(study.count)),
            plain(format!(
                "{} {}",
                fixed(study.calibration_error.value, 4),
                interval(study.calibration_error.interval_95)
            )),
            plain(fixed(study.calibration_error_by_chance, 4)),
            plain(fixed(study.brier, 4)),
        ],
    };
    let map = &result.map;
    let mapping = if map.knots.is_empty() {
        format!("Too few cases for a map of confidence: {}.", map.fitted_to)
    } else {
        let knots: Vec<String> =
            map.knots.iter().map(|[from, to]| format!("{} → {}", fixed(*from, 3), fixed(*to, 3))).collect();
        format!("Map of confidence ({}; {} cases): {}.", map.method, map.fitted_to, knots.join(", "))
    };
    Section {
        id: "probabilities",
        title: "Calibration of the stated probabilities",
        sentences: vec![
            "The expected calibration error is the mean distance between stated probability and observed \
             frequency over ten bins of equal count. Scatter alone makes it larger than zero: the column “By \
             chance alone” is its mean for exactly correct probabilities. Its bootstrap interval is biased \
             upward for the same reason."
                .to_owned(),
            mapping,
        ],
        grids: vec![Grid {
            title: String::new(),
            corner: "Probability of, on",
            columns: ["Statements", "Calibration error", "By chance alone", "Brier score"]
                .map(str::to_owned)
                .to_vec(),
            rows: result.reliability.iter().map(row).collect(),
        }],
        figures: figures::reliability(result).into_iter().collect(),
    }
}

pub(super) fn unknown(result: &TrialsResult) -> Section {
    let rows = result.unknown.areas.iter().map(|row| GridRow {
        name: row.size.map_or_else(|| "all".to_owned(), size),
        cells: vec![
            plain(count(row.positives)),
            plain(count(row.negatives)),
            plain(fixed(row.area.value, 4)),
            plain(interval(row.area.interval_95)),
        ],
    });
    Section {
        id: "unknown",
        title: "Detection of effects outside the vocabulary",
        sentences: vec![
            "Positives are cases whose effect was excluded or lies outside the vocabulary, negatives those with effects of the \
             vocabulary or none; the score is the stated probability of unknown."
                .to_owned(),
        ],
        grids: vec![Grid {
            title: String::new(),
            corner: "Size in × noise",
            columns: ["Positives", "Negatives", "Area under the curve", "95 % interval"]
                .map(str::to_owned)
                .to_vec(),
            rows: rows.collect(),
        }],
        figures: figures::unknown(result).into_iter().collect(),
    }
}
