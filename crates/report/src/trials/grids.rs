//! Tables of the page of trials.

use results::{Confusion, Proportion, SizeRow, TrialsResult};

use super::grid::{Grid, GridCell, GridRow, Section, percent, percents};
use crate::format::{count, fixed, interval, quantity, significant};

/// Shading, in percent, of a cell that holds all cases; text stays readable on it.
const DEEPEST: f64 = 45.0;

/// Returns a share with its count and interval; `–` if there are no cases.
pub(super) fn share(of: &Proportion) -> GridCell {
    if of.of == 0 {
        return GridCell { text: "–".to_owned(), ..GridCell::default() };
    }
    GridCell {
        text: percent(of.share),
        aside: format!("{}/{} {}", of.count, of.of, percents(of.interval_95)),
        shade: Some(fixed(DEEPEST * of.share, 1)),
    }
}

pub(super) fn plain(text: impl Into<String>) -> GridCell {
    GridCell { text: text.into(), ..GridCell::default() }
}

/// Formats a size in noise units as the title of a column.
pub(super) fn size(value: f64) -> String {
    format!("about {}", fixed(value, 0))
}

/// Returns a table with rows by name and columns by size.
fn by_size(
    rows: &[&SizeRow],
    name: impl Fn(&SizeRow) -> String,
    of: impl Fn(&SizeRow) -> Proportion,
) -> Grid {
    let mut sizes: Vec<f64> = rows.iter().map(|row| row.size).collect();
    sizes.sort_by(f64::total_cmp);
    sizes.dedup();
    let mut names: Vec<String> = Vec::new();
    for row in rows {
        let name = name(row);
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let row = |own: &String| GridRow {
        name: own.clone(),
        cells: sizes
            .iter()
            .map(|size| {
                let found = rows.iter().find(|row| row.size == *size && name(row) == *own);
                found.map_or_else(|| plain("–"), |row| share(&of(row)))
            })
            .collect(),
    };
    Grid {
        title: String::new(),
        corner: "Hidden, size in × noise",
        columns: sizes.iter().map(|value| size(*value)).collect(),
        rows: names.iter().map(row).collect(),
    }
}

/// Returns each bank's shares of right answers, by the definition of right.
fn by_bank(result: &TrialsResult) -> Grid {
    Grid {
        title: "By kind of case".to_owned(),
        corner: "Bank",
        columns: [
            "Status and set right",
            "First name",
            "Its class",
            "Both of two",
            "Either of two",
            "False alarms",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: result
            .banks
            .iter()
            .map(|bank| GridRow {
                name: bank.bank.clone(),
                cells: [&bank.right, &bank.top_1, &bank.class, &bank.both, &bank.either, &bank.false_alarms]
                    .map(share)
                    .into_iter()
                    .collect(),
            })
            .collect(),
    }
}

pub(super) fn accuracy(result: &TrialsResult) -> Section {
    let grid =
        |title: &str, rows: &[&SizeRow], name: fn(&SizeRow) -> String, of: fn(&SizeRow) -> Proportion| Grid {
            title: title.to_owned(),
            ..by_size(rows, name, of)
        };
    let bank = |row: &SizeRow| row.bank.clone();
    let effect = |row: &SizeRow| row.effect.clone();
    let all: Vec<&SizeRow> = result.sizes.iter().collect();
    let mut grids = vec![
        by_bank(result),
        grid("First name right, by kind of case and size", &all, bank, |row| row.top_1),
        grid("Its class right, by kind of case and size", &all, bank, |row| row.class),
    ];
    let pairs: Vec<&SizeRow> = all.iter().copied().filter(|row| row.both.of > 0).collect();
    if !pairs.is_empty() {
        grids.push(grid("Both of two named, by size of the smaller", &pairs, bank, |row| row.both));
    }
    let mut banks: Vec<&str> = result.effects.iter().map(|row| row.bank.as_str()).collect();
    banks.dedup();
    for bank in banks.into_iter().filter(|bank| *bank != "pair") {
        let own: Vec<&SizeRow> = result.effects.iter().filter(|row| row.bank == bank).collect();
        let title = format!("First name right, by effect and size: {bank}");
        grids.push(grid(&title, &own, effect, |row| row.top_1));
        let title = format!("Its class right, by effect and size: {bank}");
        grids.push(grid(&title, &own, effect, |row| row.class));
    }
    Section {
        id: "accuracy",
        title: "Accuracy by effect and size",
        sentences: vec![
            "The size of a hidden effect is the size of the part of its trace that recalibration cannot \
             absorb, in units of the noise; for two effects, it is that of the smaller one. The class of an \
             answer is its first name together with all effects that the answer calls indistinguishable from \
             it. If nothing is missing, the right answer names nothing; if the hidden effect was excluded, \
             the right answer is unknown."
                .to_owned(),
        ],
        grids,
        figures: Vec::new(),
    }
}

fn counts(title: &str, corner: &'static str, confusion: &Confusion) -> Grid {
    let row = |(name, own): (&String, &Vec<u64>)| {
        let all: u64 = own.iter().sum();
        let cell = |value: &u64| match value {
            0 => plain(""),
            value => GridCell {
                text: count(*value),
                aside: String::new(),
                shade: Some(fixed(DEEPEST * *value as f64 / all as f64, 1)),
            },
        };
        GridRow { name: name.clone(), cells: own.iter().map(cell).collect() }
    };
    Grid {
        title: title.to_owned(),
        corner,
        columns: confusion.said.iter().map(|name| name.replace('_', " ")).collect(),
        rows: confusion.hidden.iter().zip(&confusion.counts).map(row).collect(),
    }
}

pub(super) fn confusion(result: &TrialsResult) -> Section {
    let nuisances: Vec<String> = result
        .nuisances
        .iter()
        .map(|row| format!("{} in {} of {}", row.id, row.named.count, row.named.of))
        .collect();
    let mut sentences = vec![
        "Cases with at most one hidden effect, by hidden effect (rows) and by the effect named first \
         (columns), shaded by the share of the row."
            .to_owned(),
    ];
    if !nuisances.is_empty() {
        sentences.push(format!(
            "Effects that the records of every bank have in common are not scored. They were named: {}.",
            nuisances.join(", ")
        ));
    }
    Section {
        id: "confusion",
        title: "Confusion matrices",
        sentences,
        grids: vec![
            counts("Effects", "Hidden", &result.confusion),
            counts("Kinds of verdict, of all cases", "Hidden", &result.kinds),
        ],
        figures: Vec::new(),
    }
}

/// Returns the distributions of the right answers' errors and of all answers' times.
fn distributions(result: &TrialsResult) -> Grid {
    let number = |value: f64, unit: &str| {
        plain(if value.is_finite() { quantity(&significant(value, 3), unit) } else { "–".to_owned() })
    };
    Grid {
        title: String::new(),
        corner: "",
        columns: ["Cases", "Median", "95 % interval", "95 % quantile", "Largest"].map(str::to_owned).to_vec(),
        rows: [
            ("Held-out error, × noise, of right answers with a name", &result.ratio_to_floor, ""),
            ("Wall time of an answer", &result.seconds_per_case, "s"),
        ]
        .map(|(name, of, unit)| {
            let cells = vec![
                plain(count(of.count)),
                number(of.median.value, unit),
                plain(if of.median.interval_95[0].is_finite() {
                    interval(of.median.interval_95)
                } else {
                    "–".to_owned()
                }),
                number(of.quantile_95, unit),
                number(of.worst, unit),
            ];
            GridRow { name: name.to_owned(), cells }
        })
        .into_iter()
        .collect(),
    }
}

pub(super) fn closure(result: &TrialsResult) -> Section {
    let study = &result.closure;
    let left_out: Vec<String> =
        study.left_out.iter().map(|(reason, cases)| format!("{reason} ({cases})")).collect();
    let mut sentences = vec![format!("True closure: {}.", study.means)];
    if !left_out.is_empty() {
        sentences.push(format!("Cases left out of the coverage: {}.", left_out.join("; ")));
    }
    Section {
        id: "closure",
        title: "Closure of the gap, and time per answer",
        sentences,
        grids: vec![
            Grid {
                title: "Intervals of closure".to_owned(),
                corner: "",
                columns: ["Hold the true closure", "Lie above it", "Lie below it"]
                    .map(str::to_owned)
                    .to_vec(),
                rows: vec![GridRow {
                    name: "95 % intervals".to_owned(),
                    cells: vec![share(&study.coverage), plain(count(study.below)), plain(count(study.above))],
                }],
            },
            distributions(result),
        ],
        figures: Vec::new(),
    }
}

pub(super) fn baselines(result: &TrialsResult) -> Section {
    let rows = result.baselines.iter().map(|row| GridRow {
        name: row.id.clone(),
        cells: vec![share(&row.top_1), share(&row.diagnosis), share(&row.false_alarms)],
    });
    Section {
        id: "baselines",
        title: "Baselines on the same records",
        sentences: result.baselines.iter().map(|row| format!("{}: {}.", row.id, row.method)).collect(),
        grids: vec![Grid {
            title: "Cases of a single effect".to_owned(),
            corner: "Diagnoser",
            columns: ["First name right", "The diagnosis on these", "False alarms where nothing is missing"]
                .map(str::to_owned)
                .to_vec(),
            rows: rows.collect(),
        }],
        figures: Vec::new(),
    }
}
