//! Table of a text: its layout with the headings and kinds of its columns.

use crate::columns::{CsvColumns, Filter};
use crate::dates::is_date;
use crate::dialect::{self, Layout, is_missing};
use crate::error::Fault;
use crate::heading::Heading;
use crate::line::Line;
use crate::names::COUNTERS;
use crate::reading::NO_SEPARATOR;
use crate::roles::{Column, Kind, Pick};
use crate::runs::{Run, runs};
use crate::statistics::extremes;
use crate::words::counted;
use std::collections::BTreeSet;

/// Number of rows from which the kind of a column is determined.
const TOLD_FROM: usize = 200;
/// Largest number of values of a column that distinguishes series.
const MOST_SERIES: usize = 40;
/// Largest part of a column's variance by which its numbers may be off another column in other units: 1 % of its
/// root mean square, as a sensor's voltage is from the rounded angle that was computed from it.
const ROUNDED: f64 = 1e-4;
/// Names of columns that distinguish series.
const SERIES: &[&str] =
    &["joint", "axis", "motor", "channel", "sensor", "body", "link", "servo", "name", "id"];

/// Columns of the run that is read.
pub(crate) struct OfRun {
    /// Number of the run, from 1; `None` if the table holds only one.
    pub(crate) run: Option<usize>,
    /// All columns, those of other runs without a title and a content.
    pub(crate) columns: Vec<Column>,
    /// Sentence about the other runs, if the first was taken for want of a choice.
    pub(crate) finding: Option<String>,
}

/// Table of a text, with the headings and kinds of its columns.
pub(crate) struct Table<'a> {
    pub(crate) layout: Layout<'a>,
    pub(crate) columns: Vec<Column>,
}

impl<'a> Table<'a> {
    /// Determines the dialect of a text and the kinds of its columns.
    pub(crate) fn new(text: &'a str) -> Result<Self, Fault> {
        let layout = dialect::layout(text)?;
        let below = |at: usize| layout.units.as_ref().and_then(|units| units.get(at)).copied();
        let step = layout.rows.len().div_ceil(TOLD_FROM).max(1);
        let rows: Vec<Vec<&str>> =
            layout.rows.iter().step_by(step).map(|(_, row)| layout.dialect.split(row)).collect();
        let kind = |at: usize| {
            let count = |is: &dyn Fn(&str) -> bool| {
                rows.iter().filter(|row| row.get(at).is_some_and(|cell| is(cell))).count()
            };
            let numbers = count(&|cell| layout.dialect.number(cell).is_some());
            let dates = count(&|cell| is_date(cell) && layout.dialect.number(cell).is_none());
            let texts = count(&|cell| !is_missing(cell)) - numbers - dates;
            match () {
                () if dates > numbers.max(texts) => Kind::Dates,
                () if texts > numbers => Kind::Text,
                () => Kind::Numbers,
            }
        };
        let titles = layout.titles.iter().enumerate();
        let columns = titles
            .map(|(at, title)| Column { heading: Heading::parse(title, below(at)), kind: kind(at) })
            .collect();
        Ok(Self { layout, columns })
    }

    /// Returns the separator of the columns in words.
    pub(crate) fn separator(&self) -> &'static str {
        if self.columns.len() > 1 { self.layout.dialect.name() } else { NO_SEPARATOR }
    }

    pub(crate) fn title(&self, at: usize) -> &str {
        self.columns.get(at).map_or("", |column| column.heading.title.as_str())
    }

    /// Returns the values of a column in the order of their first lines, or no values if there are too many
    /// to distinguish series.
    pub(crate) fn values(&self, at: usize) -> Vec<&'a str> {
        let (mut known, mut found) = (BTreeSet::new(), Vec::new());
        for (_, row) in &self.layout.rows {
            // A row that ends before the column has an empty cell there.
            let value = self.layout.dialect.split(row).get(at).copied().unwrap_or("");
            if !value.is_empty() && known.insert(value) {
                found.push(value);
            }
            if found.len() > MOST_SERIES {
                return Vec::new();
            }
        }
        found
    }

    /// Returns the fault of a column that distinguishes series of which none was chosen. With `any`, every
    /// text column counts.
    pub(crate) fn series(&self, any: bool) -> Option<Fault> {
        let tells = |column: &Column| {
            let words = column.heading.words.iter();
            let named =
                words.clone().count() > 0 && words.clone().all(|word| SERIES.contains(&word.as_str()));
            named || any && column.kind == Kind::Text
        };
        let at = (0..self.columns.len())
            .filter(|at| self.columns.get(*at).is_some_and(tells))
            .find(|at| self.values(*at).len() > 1)?;
        let values = self.values(at);
        Some(Fault::SeveralValues {
            line: self.layout.line,
            column: self.title(at).to_owned(),
            count: values.len(),
            values: values.join(", "),
            example: values.first().copied().unwrap_or("").to_owned(),
        })
    }

    /// Returns the numbers in a column, without the cells that hold none.
    pub(crate) fn numbers(&self, at: usize, rows: &[(u64, Vec<&str>)]) -> Vec<f64> {
        rows.iter().filter_map(|(_, row)| self.layout.dialect.number(row.get(at)?)).collect()
    }

    /// Returns `true` if a column's numbers are not all the same.
    pub(crate) fn moves(&self, at: usize, rows: &[(u64, Vec<&str>)]) -> bool {
        let [lowest, highest] = extremes(&self.numbers(at, rows));
        lowest < highest
    }

    /// Returns the column that numbers the rows, with the number of each counted from the first, if some are missing: by
    /// its name, whole numbers that increase, by 1 as a rule.
    pub(crate) fn counter(&self, rows: &[(u64, Vec<&str>)]) -> Option<(Pick, Vec<usize>)> {
        let named = |column: &Column| COUNTERS.iter().any(|word| column.heading.has(word));
        let mut columns = (0..self.columns.len()).filter(|at| self.columns.get(*at).is_some_and(named));
        columns.find_map(|at| {
            let numbers = self.numbers(at, rows);
            let is_whole = numbers.iter().all(|number| number.fract() == 0.0);
            let steps = || numbers.windows(2).filter_map(|pair| Some(pair.last()? - pair.first()?));
            let ones = steps().filter(|step| *step == 1.0).count();
            let (complete, rises) = (ones + 1 == numbers.len(), steps().all(|step| step >= 1.0));
            let is_counter = is_whole && rises && !complete && 2 * ones > numbers.len();
            let first = *numbers.first()?;
            let pick = Pick { at, because: "numbers the samples" };
            (is_counter && numbers.len() == rows.len())
                .then(|| (pick, numbers.iter().map(|number| (number - first) as usize).collect()))
        })
    }

    /// Returns `true` if one column is another one in other units, except for [`ROUNDED`] of its variance.
    pub(crate) fn is_affine(&self, columns: [usize; 2], rows: &[(u64, Vec<&str>)]) -> bool {
        let pair = |row: &Vec<&str>| {
            let [x, y] = columns.map(|at| self.layout.dialect.number(row.get(at)?));
            x.zip(y)
        };
        let points: Vec<(f64, f64)> = rows.iter().filter_map(|(_, row)| pair(row)).collect();
        let line = Line::through(&points);
        // Of the second column's variance, that along the line is the slope's. A column that stands still is affine
        // to none: it has neither.
        line.squares() < ROUNDED * line.slope.powi(2) * line.spread_x
    }

    /// Returns the columns of which only those of one run have a title and a content.
    pub(crate) fn only(&self, run: &Run) -> Vec<Column> {
        let other = || Column { heading: Heading::parse("", None), kind: Kind::Text };
        let columns = self.columns.iter().enumerate();
        columns.map(|(at, own)| if run.columns.contains(&at) { own.clone() } else { other() }).collect()
    }

    /// Chooses the run to read, if the table holds several side by side: that of the options, else that of
    /// the columns that the options name, else the first.
    ///
    /// # Errors
    /// [`Fault::NoSuchRun`].
    pub(crate) fn run(&self, asked: &CsvColumns) -> Result<OfRun, Fault> {
        let runs = runs(&self.columns);
        if runs.is_empty() {
            return Ok(OfRun { run: None, columns: self.columns.clone(), finding: None });
        }
        let named = |run: &Run| {
            let names = [&asked.time, &asked.value].into_iter().flatten();
            let titles = || run.columns.iter().map(|at| self.title(*at));
            names.clone().count() > 0 && names.clone().all(|name| titles().any(|title| title == name))
        };
        let number = asked.run.or_else(|| runs.iter().position(named).map(|at| at + 1));
        let taken = number.unwrap_or(1);
        let Some(run) = taken.checked_sub(1).and_then(|at| runs.get(at)) else {
            return Err(Fault::NoSuchRun { asked: taken, count: runs.len() });
        };
        let labels: Vec<&str> = runs.iter().map(|run| run.label.as_str()).collect();
        let finding = number.is_none().then(|| {
            format!(
                "the file holds {} runs, each with its own time ({}); run 1 was taken, another with `data.run`",
                runs.len(),
                labels.join(", ")
            )
        });
        Ok(OfRun { run: Some(taken), columns: self.only(run), finding })
    }

    /// Returns `true`, with a sentence, if the input is written on fewer than two of three lines that hold a
    /// value: it then acts until it is written again.
    pub(crate) fn held(
        &self,
        input: Option<Pick>,
        value: Pick,
        rows: &[(u64, Vec<&str>)],
    ) -> (bool, Option<String>) {
        let Some(input) = input else { return (false, None) };
        let has = |row: &[&str], at: usize| row.get(at).is_some_and(|cell| !is_missing(cell));
        let valued = rows.iter().filter(|(_, row)| has(row, value.at));
        let (lines, both) = valued.fold((0_usize, 0_usize), |(lines, both), (_, row)| {
            (lines + 1, both + usize::from(has(row, input.at)))
        });
        let held = 3 * both < 2 * lines;
        let written = rows.iter().filter(|(_, row)| has(row, input.at)).count();
        let finding = held.then(|| {
            format!(
                "`{}` is written on {} for {}, and was held between them",
                self.title(input.at),
                counted(written, "line"),
                counted(lines, "value")
            )
        });
        (held, finding)
    }

    /// Returns the lines that a filter keeps.
    pub(crate) fn chosen(
        &self,
        filter: Option<&(usize, &Filter)>,
    ) -> Result<Vec<(u64, Vec<&'a str>)>, Fault> {
        let rows = self.layout.rows.iter().map(|(line, row)| (*line, self.layout.dialect.split(row)));
        let Some((at, filter)) = filter else { return Ok(rows.collect()) };
        let chosen: Vec<_> =
            rows.filter(|(_, row)| row.get(*at).is_some_and(|cell| *cell == filter.value)).collect();
        if chosen.is_empty() {
            return Err(Fault::NoSuchValue {
                column: filter.column.clone(),
                value: filter.value.clone(),
                values: self.values(*at).join(", "),
            });
        }
        Ok(chosen)
    }
}
