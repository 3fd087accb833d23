//! Scores by effect and by class for cases with several effects.

use results::{ClassScores, InclusionRow, Proportion, TrialsResult};

use super::grid::{Grid, GridCell, GridRow, Section};
use super::grids::{plain, share};
use crate::format::fixed;

/// Score of one group.
type Score = Box<dyn Fn(&ClassScores) -> Proportion>;

/// Returns the scores by class: for each score its name and one share for each group of cases.
#[must_use]
pub fn class_rows(groups: &[ClassScores]) -> Vec<(String, Vec<Proportion>)> {
    let mut scores: Vec<(String, Score)> = vec![
        ("leading effect's class named".to_owned(), Box::new(|own| own.leading_named)),
        ("leading effect's class at 0.9 or more".to_owned(), Box::new(|own| own.leading_sure)),
    ];
    let ranges = groups.first().map(|own| own.recall.iter().map(|row| row.floors).collect::<Vec<_>>());
    for (index, [low, high]) in ranges.unwrap_or_default().into_iter().enumerate() {
        let to = if high.is_finite() { format!("to {}", fixed(high, 0)) } else { "and more".to_owned() };
        let name = format!("class named, effects of {} {to} × noise", fixed(low, 0));
        let nothing = Proportion { count: 0, of: 0, share: f64::NAN, interval_95: [f64::NAN; 2] };
        scores.push((name, Box::new(move |own| own.recall.get(index).map_or(nothing, |row| row.named))));
    }
    let more: [(&str, Score); 4] = [
        ("names whose class acts", Box::new(|own| own.precision)),
        ("set of classes right", Box::new(|own| own.set)),
        ("`unknown`, or an allowed class, for an unlisted law", Box::new(|own| own.unknown)),
        ("false alarms where nothing is missing", Box::new(|own| own.false_alarms)),
    ];
    scores.extend(more.map(|(name, score)| (name.to_owned(), score)));
    scores.into_iter().map(|(name, score)| (name, groups.iter().map(score).collect())).collect()
}

/// Returns the section, if there are such cases.
pub(super) fn section(result: &TrialsResult) -> Option<Section> {
    let groups = &result.inclusion;
    if groups.is_empty() {
        return None;
    }
    let row = |(name, shares): (String, Vec<Proportion>)| GridRow {
        name,
        cells: shares.iter().map(share).collect(),
    };
    let mut rows: Vec<GridRow> = class_rows(groups).into_iter().map(row).collect();
    rows.push(GridRow {
        name: "part of the gap attributed to classes that act, median".to_owned(),
        cells: groups.iter().map(|own| number(own.attributed.median.value)).collect(),
    });
    let mut grids = vec![Grid {
        title: "By class".to_owned(),
        corner: "Cases",
        columns: groups.iter().map(|own| own.banks.clone()).collect(),
        rows,
    }];
    for own in groups {
        grids.push(inclusion(format!("Each class: {}", own.banks), &own.classes));
        grids.push(inclusion(format!("Each effect: {}", own.banks), &own.effects));
    }
    Some(Section {
        id: "classes",
        title: "Several effects at once: which of them are named",
        sentences: vec![
            "Effects that explain a record alike form one class. Sizes are root mean squares of the part \
             that no recalibration absorbs, in units of the noise. The class of a law outside the vocabulary \
             is not counted."
                .to_owned(),
        ],
        grids: grids.into_iter().filter(|grid| !grid.rows.is_empty()).collect(),
        figures: Vec::new(),
    })
}

fn number(value: f64) -> GridCell {
    plain(if value.is_finite() { fixed(value, 2) } else { "–".to_owned() })
}

fn inclusion(title: String, rows: &[InclusionRow]) -> Grid {
    let row = |row: &InclusionRow| GridRow {
        name: row.id.clone(),
        cells: vec![
            share(&row.recall),
            share(&row.precision),
            number(row.stated_where_it_acts),
            number(row.stated_where_it_does_not),
        ],
    };
    Grid {
        title,
        corner: "",
        columns: [
            "Named if it acts",
            "Acts if named",
            "Probability if it acts",
            "Probability if it does not",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: rows.iter().map(row).collect(),
    }
}
