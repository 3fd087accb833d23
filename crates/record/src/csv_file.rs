//! Reader of the `csv` format: a header with column names, then numbers.

use crate::coding::decoded;
use crate::columns::{CsvColumns, Missing};
use crate::copies::copies;
use crate::dates::DateOrder;
use crate::dialect::{self, is_missing};
use crate::doubts::{contradiction, doubtful_unit, odd_rate, unknown_unit};
use crate::error::Fault;
use crate::heading::{Heading, Measure};
use crate::options::ReadOptions;
use crate::parsed::Parsed;
use crate::reading::{ColumnReading, Reading};
use crate::record::{InputRow, Quantity};
use crate::roles::{Column, Kind, Pick, Roles, assumed_unit, quantity};
use crate::runs::one_after_another;
use crate::statement::Statements;
use crate::swing::Swing;
use crate::table::{OfRun, Table};
use crate::times::{Stamp, Times, Told, seconds};
use crate::unit::{TimeUnit, Unit};
use crate::words::counted;
use std::collections::BTreeSet;

/// Samples of a table before their stamps are converted to seconds.
#[derive(Default)]
struct Samples {
    lines: Vec<u64>,
    /// Numbers of the lines among the chosen lines.
    numbers: Vec<usize>,
    /// Order of day and month in the time column.
    order: DateOrder,
    stamps: Vec<Stamp>,
    /// `None` on a line that lacks only the observed cell: its input still acts.
    values: Vec<Option<f64>>,
    input: Vec<f64>,
    missing_cells: usize,
    missing_lines: usize,
    /// Number of lines that hold only an input, among lines between which it is held.
    held_lines: usize,
    first_missing: Option<(u64, usize)>,
}

/// Columns that are read.
struct Chosen {
    time: Option<Pick>,
    /// Column of nanoseconds that belongs to a time column of seconds.
    nanoseconds: Option<usize>,
    value: Pick,
    input: Option<Pick>,
    /// `true` if other runs stand beside this one, whose lines may go on after its last.
    is_run: bool,
    /// Column that counts the rows, and their numbers by it, if there is no time column.
    counter: Option<(Pick, Vec<usize>)>,
}

impl Samples {
    /// Refuses missing cells, unless the options say what becomes of them.
    fn refuse_missing(&self, table: &Table<'_>, treated: Missing) -> Result<(), Fault> {
        let (Missing::Refuse, Some((line, at))) = (treated, self.first_missing) else { return Ok(()) };
        let column = table.title(at).to_owned();
        Err(Fault::MissingCells { line, column, count: self.missing_cells })
    }

    /// Undoes the coding of the values; returns a sentence about it, and `true` if it confirms the unit.
    fn decode(&mut self, unit: Option<Unit>) -> Option<(String, bool)> {
        let plain: Vec<f64> = self.values.iter().flatten().copied().collect();
        let decoded = decoded(&plain, unit)?;
        let known = self.values.iter_mut().flatten();
        known.zip(decoded.values).for_each(|(value, decoded)| *value = decoded);
        Some((decoded.finding, decoded.is_turn))
    }
}

impl Chosen {
    /// Returns the indices of the columns, the observed column first.
    fn columns(&self) -> Vec<usize> {
        let picks = [Some(self.value), self.input, self.time].map(|pick| pick.map(|pick| pick.at));
        picks.into_iter().chain([self.nanoseconds]).flatten().collect()
    }
}

/// Reads the text of a `csv` file.
pub(crate) fn parse(text: &str, options: &ReadOptions) -> Result<Parsed, Fault> {
    let asked = &options.columns;
    let mut statements = Statements::default();
    dialect::statements(text).for_each(|comment| statements.read_comment(comment));
    let table = Table::new(text)?;
    let OfRun { run, columns, finding } = table.run(asked)?;
    let mut findings: Vec<String> = finding.into_iter().collect();
    let roles = Roles { line: table.layout.line, columns: &columns, options };
    let filter = match &asked.filter {
        Some(filter) => Some((roles.named(&filter.column, "data.where")?, filter)),
        None => None,
    };
    let rows = table.chosen(filter.as_ref())?;
    let time = roles.time()?;
    let counter = if time.is_none() { table.counter(&rows) } else { None };
    let places = time.or(counter.as_ref().map(|(pick, _)| *pick));
    let (value, also) = roles.value(places, &|at| Swing::of(&table.numbers(at, &rows)))?;
    let taken: Vec<usize> = [Some(value), places].into_iter().flatten().map(|pick| pick.at).collect();
    let (input, note) =
        roles.input(&taken, &|at| table.moves(at, &rows), &|at| table.is_affine([value.at, at], &rows))?;
    if let Some(fault) = filter.is_none().then(|| table.series(false)).flatten() {
        return Err(fault);
    }
    let nanoseconds = time.and_then(|time| nanoseconds(&columns, time.at));
    let chosen = Chosen { time, nanoseconds, value, input, is_run: run.is_some(), counter };
    let (mut samples, held) = read(&table, &chosen, &rows, asked.missing)?;
    samples.refuse_missing(&table, asked.missing)?;
    if time.is_some() {
        statements.sample_rate_hz = asked.sample_rate_hz.or(statements.sample_rate_hz);
    }
    let (stamps, time_reading, found) = stamps(&table, &chosen, options, &samples);
    findings.extend(found.into_iter().chain(also).chain(note).chain(held));
    let observed = Observed::new(&table, value, options, &mut samples, &mut findings);
    let (input_factor, input_reading) = input_scale(&table, input, observed.unit, options, &mut findings);
    let reading = Reading {
        format: "csv".to_owned(),
        separator: table.separator().to_owned(),
        decimal: if table.layout.dialect.decimal_comma { "comma" } else { "point" }.to_owned(),
        header_line: table.layout.line,
        run,
        time: time_reading,
        sample_rate_hz: if time.is_none() { asked.sample_rate_hz } else { None },
        value: observed.reading,
        counts_per_turn: asked.counts_per_turn,
        input: input_reading,
        filter: asked.filter.clone().map(String::from),
        missing_cells: samples.missing_cells,
        missing_lines: samples.missing_lines,
        missing: asked.missing,
        quantity: observed.quantity,
        ..Reading::default()
    };
    let mut parsed = Parsed::new(observed.unit, statements, reading);
    parsed.findings = findings;
    let factors = [observed.factor, input_factor];
    // Stamps that run backward may belong to several interleaved series.
    let interleaved = |fault| filter.is_none().then(|| table.series(true)).flatten().unwrap_or(fault);
    fill(&mut parsed, samples, &stamps, factors, (&chosen, asked)).map_err(interleaved)?;
    Ok(parsed)
}

/// Fills a record with samples, less the lines that a file holds twice and those of other runs.
fn fill(
    parsed: &mut Parsed,
    samples: Samples,
    stamps: &[f64],
    [factor, input_factor]: [f64; 2],
    (chosen, asked): (&Chosen, &CsvColumns),
) -> Result<(), Fault> {
    let is_stamped = chosen.time.is_some();
    let copies = if is_stamped { copies(stamps, &samples.values, &samples.input) } else { BTreeSet::new() };
    let of_run = one_after_another(stamps, asked.run.filter(|_| parsed.reading.run.is_none()))?;
    if let Some((part, finding)) = &of_run {
        parsed.findings.push(finding.clone());
        parsed.reading.run = Some(part.run);
    }
    parsed.findings.extend(copied(copies.len()));
    let (mut numbers, mut left_out) = (Vec::new(), 0);
    for (at, ((line, stamp), number)) in samples.lines.iter().zip(stamps).zip(&samples.numbers).enumerate() {
        if of_run.as_ref().is_some_and(|(part, _)| !part.lines.contains(&at)) {
            continue;
        }
        if copies.contains(&at) {
            left_out += 1;
            continue;
        }
        let number = number - left_out;
        let input = samples.input.get(at).map(|value| value * input_factor);
        let Some(value) = samples.values.get(at).copied().flatten() else {
            let row = |input| InputRow { row: number, stamp_s: *stamp, input };
            parsed.input_rows.extend(input.map(row));
            continue;
        };
        parsed.push(*line, *stamp, value * factor, input)?;
        numbers.push(number);
    }
    let is_numbered = samples.missing_lines > 0 && asked.missing == Missing::Segment
        || samples.held_lines > 0
        || chosen.counter.is_some();
    parsed.rows = is_numbered.then_some(numbers);
    Ok(())
}

/// The observed column: its quantity, its unit, and the factor from its numbers to SI.
struct Observed {
    quantity: Quantity,
    unit: Unit,
    factor: f64,
    reading: ColumnReading,
}

impl Observed {
    /// Determines the unit of the observed column and undoes the coding of its numbers. Findings about both
    /// are added.
    fn new(
        table: &Table<'_>,
        pick: Pick,
        options: &ReadOptions,
        samples: &mut Samples,
        findings: &mut Vec<String>,
    ) -> Self {
        let asked = &options.columns;
        let heading = heading(table, pick.at);
        let counts = asked.counts_per_turn.filter(|_| asked.unit.is_none());
        let stated = asked.unit.or(heading.unit()).filter(|_| counts.is_none());
        let quantity = if counts.is_some() { Quantity::Position } else { quantity(heading, options) };
        let (decoded, confirmed) = samples.decode(stated).unzip();
        let confirmed = confirmed == Some(true);
        findings.extend(decoded);
        let values: Vec<f64> = samples.values.iter().flatten().copied().collect();
        let assumed = counts.is_none() && stated.is_none();
        let unit = stated.unwrap_or_else(|| match counts {
            Some(_) => Unit::Radian,
            None => assumed_unit(heading, quantity, options.coordinate, &values),
        });
        findings.extend(contradiction(
            heading,
            [asked.unit, heading.unit()].map(|unit| unit.map(Unit::symbol)),
            "data.unit",
        ));
        findings.extend(unknown_unit(heading, assumed, unit.symbol(), "data.unit"));
        let doubted = !confirmed && heading.unknown.is_none() && counts.is_none() && asked.unit.is_none();
        findings.extend(doubted.then(|| doubtful_unit(&values, unit, assumed)).flatten());
        let because = match counts {
            Some(counts) => format!("{}; counts, {counts} of them a turn", pick.because),
            None => {
                let turns = if confirmed { ", confirmed by its wraps" } else { "" };
                format!("{}; unit {}{turns}", pick.because, told(asked.unit.is_some(), assumed))
            }
        };
        let shown = counts.is_none().then(|| unit.symbol().to_owned());
        let factor = counts.map_or(unit.to_si(), |counts| std::f64::consts::TAU / counts);
        let reading = ColumnReading { column: heading.title.clone(), unit: shown, because };
        Self { quantity, unit, factor, reading }
    }
}

/// Returns a sentence if duplicate lines were left out.
fn copied(count: usize) -> Option<String> {
    let which = if count == 1 { "repeats" } else { "repeat" };
    (count > 0).then(|| {
        format!("{} {which} the one before, stamp and all, and were read once", counted(count, "line"))
    })
}

fn heading<'a>(table: &'a Table<'_>, at: usize) -> &'a Heading {
    const NONE: &Heading = &Heading { title: String::new(), words: Vec::new(), measure: None, unknown: None };
    table.columns.get(at).map_or(NONE, |column| &column.heading)
}

fn told(stated: bool, assumed: bool) -> &'static str {
    match (stated, assumed) {
        (true, _) => "from the options",
        (false, true) => "assumed, none is stated",
        (false, false) => "from the header",
    }
}

/// Returns the column of nanoseconds that belongs to a column of seconds: `header.stamp.secs`,
/// `header.stamp.nsecs`.
fn nanoseconds(columns: &[Column], time: usize) -> Option<usize> {
    let title = |column: &Column| column.heading.title.to_lowercase();
    let own = title(columns.get(time)?);
    let stem =
        own.strip_suffix("secs").or_else(|| own.strip_suffix("sec")).filter(|stem| !stem.is_empty())?;
    let pairs = ["nsecs", "nsec", "nanosec"].map(|ending| format!("{stem}{ending}"));
    columns.iter().position(|column| pairs.contains(&title(column)))
}

/// Reads the cells of the chosen columns; returns a sentence if the input was held between its lines.
fn read(
    table: &Table<'_>,
    chosen: &Chosen,
    rows: &[(u64, Vec<&str>)],
    treated: Missing,
) -> Result<(Samples, Option<String>), Fault> {
    let width = table.columns.len();
    let columns = chosen.columns();
    let (held, finding) = table.held(chosen.input, chosen.value, rows);
    let needed = columns.iter().map(|at| at + 1).fold(0, usize::max);
    let times =
        chosen.time.into_iter().flat_map(|time| rows.iter().filter_map(move |(_, row)| row.get(time.at)));
    let samples = Samples { order: DateOrder::of(times.copied()), ..Samples::default() };
    let mut reader = Reader { table, chosen, treated, held, last_input: None, samples };
    let mut number = 0;
    for (at, (line, row)) in rows.iter().enumerate() {
        // A row that ends before the column has an empty cell there.
        let cell = |at: usize| row.get(at).copied().unwrap_or("");
        if chosen.is_run && columns.iter().all(|at| is_missing(cell(*at))) {
            continue;
        }
        if row.len() < needed {
            return Err(Fault::MissingField { line: *line, found: row.len(), expected: width });
        }
        if row.iter().skip(width).any(|field| !field.is_empty()) {
            return Err(Fault::ExtraFields { line: *line, found: row.len(), expected: width });
        }
        let place = chosen.counter.as_ref().and_then(|(_, numbers)| numbers.get(at)).copied();
        number += usize::from(reader.line(*line, place.unwrap_or(number), &columns, &cell)?);
    }
    Ok((reader.samples, finding))
}

/// Reader of the lines of a table.
struct Reader<'a> {
    table: &'a Table<'a>,
    chosen: &'a Chosen,
    treated: Missing,
    /// `true` if the input is written at a lower rate than the values and acts until it is written again.
    held: bool,
    last_input: Option<f64>,
    samples: Samples,
}

impl<'a> Reader<'a> {
    /// Reads one line, the `number`th; returns `false` if it does not count, as one that holds only the input
    /// among lines between which it is held.
    fn line(
        &mut self,
        line: u64,
        number: usize,
        columns: &[usize],
        cell: &dyn Fn(usize) -> &'a str,
    ) -> Result<bool, Fault> {
        let (table, chosen) = (self.table, self.chosen);
        let dialect = table.layout.dialect;
        let read =
            |at: usize| dialect.number(cell(at)).ok_or_else(|| not_a_number(table, line, at, cell(at)));
        let mut missing: Vec<usize> = columns.iter().copied().filter(|at| is_missing(cell(*at))).collect();
        if let Some(input) = chosen.input.filter(|_| self.held) {
            if !missing.contains(&input.at) {
                self.last_input = Some(read(input.at)?);
            }
            if self.last_input.is_none() {
                return Ok(false);
            }
            if missing.contains(&chosen.value.at) {
                if let Some(before) = number.checked_sub(1).filter(|_| !missing.contains(&input.at)) {
                    self.between(line, before, cell)?;
                }
                return Ok(false);
            }
            missing.retain(|at| *at != input.at);
        }
        if let Some(first) = missing.first() {
            // A word in one of the other cells is still a fault.
            columns.iter().filter(|at| !missing.contains(at)).try_for_each(|at| {
                let is_time = Some(*at) == chosen.time.map(|pick| pick.at);
                let held = self.held && is_missing(cell(*at));
                if is_time || held || read(*at).is_ok() {
                    Ok(())
                } else {
                    Err(not_a_number(table, line, *at, cell(*at)))
                }
            })?;
            self.samples.missing_cells += missing.len();
            self.samples.missing_lines += 1;
            self.samples.first_missing.get_or_insert((line, *first));
            let acts = chosen.input.is_some() && self.treated == Missing::Segment;
            if !(acts && missing == [chosen.value.at]) {
                return Ok(true);
            }
        }
        self.stamp(line, cell)?;
        self.samples.values.push(if missing.is_empty() { Some(read(chosen.value.at)?) } else { None });
        if let Some(input) = chosen.input {
            let held = self.last_input.filter(|_| self.held);
            self.samples.input.push(held.map_or_else(|| read(input.at), Ok)?);
        }
        self.samples.lines.push(line);
        self.samples.numbers.push(number);
        Ok(true)
    }

    /// Reads a line that holds only an input, among lines between which it is held. It has the number of the line
    /// before.
    fn between(&mut self, line: u64, number: usize, cell: &dyn Fn(usize) -> &'a str) -> Result<(), Fault> {
        // Without a time column a line between two samples has no time.
        if self.chosen.time.is_none() {
            return Ok(());
        }
        self.stamp(line, cell)?;
        self.samples.values.push(None);
        self.samples.input.extend(self.last_input);
        self.samples.lines.push(line);
        self.samples.numbers.push(number);
        self.samples.held_lines += 1;
        Ok(())
    }

    /// Reads the stamp of a line, if there is a time column.
    fn stamp(&mut self, line: u64, cell: &dyn Fn(usize) -> &'a str) -> Result<(), Fault> {
        let (table, Some(time)) = (self.table, self.chosen.time) else { return Ok(()) };
        let stamp = |at: usize| {
            Stamp::parse(cell(at), table.layout.dialect, self.samples.order)
                .ok_or_else(|| not_a_number(table, line, at, cell(at)))
        };
        let whole = stamp(time.at)?;
        self.samples.stamps.push(match self.chosen.nanoseconds {
            Some(at) => whole.with_nanoseconds(stamp(at)?),
            None => whole,
        });
        Ok(())
    }
}

fn not_a_number(table: &Table<'_>, line: u64, at: usize, cell: &str) -> Fault {
    Fault::NotANumber { line, column: table.title(at).to_owned(), text: cell.chars().take(40).collect() }
}

/// Returns stamps in seconds, the reading of the time column, and findings about it.
fn stamps(
    table: &Table<'_>,
    chosen: &Chosen,
    options: &ReadOptions,
    samples: &Samples,
) -> (Vec<f64>, Option<ColumnReading>, Vec<String>) {
    let asked = &options.columns;
    let Some(time) = chosen.time else {
        let rate = asked.sample_rate_hz.unwrap_or(1.0);
        let place = |(index, number): (usize, &usize)| match asked.missing {
            Missing::Drop if chosen.counter.is_none() => index as f64 / rate,
            _ => *number as f64 / rate,
        };
        let counted = chosen.counter.iter().map(|(pick, _)| {
            let title = table.title(pick.at);
            format!("`{title}` {}, of which some are missing, and placed them in time", pick.because)
        });
        return (samples.numbers.iter().enumerate().map(place).collect(), None, counted.collect());
    };
    let heading = heading(table, time.at);
    let named = match (chosen.nanoseconds, heading.measure) {
        (Some(_), _) => Some(TimeUnit::Nanosecond),
        (None, Some(Measure::Time(unit))) => Some(unit),
        _ => None,
    };
    let dates = table.columns.get(time.at).is_some_and(|column| column.kind == Kind::Dates);
    let Times { seconds, unit, told: how, from_first } =
        seconds(&samples.stamps, asked.time_unit.or(named), dates);
    let mut because = match (asked.time_unit, how) {
        _ if dates => "dates or times of the day".to_owned(),
        (Some(_), _) => "unit from the options".to_owned(),
        (None, Told::Stated) => "unit from the header".to_owned(),
        (None, Told::Magnitude) => "times since 1970 by their size".to_owned(),
        (None, Told::Whole) => format!("unit assumed to be {}, for whole numbers", unit.name()),
        (None, Told::Assumed) => "unit assumed, none is stated".to_owned(),
    };
    if from_first {
        because.push_str(", counted from the first");
    }
    let stated = [asked.time_unit, named.filter(|_| !dates)].map(|unit| unit.map(TimeUnit::name));
    let findings = match how {
        _ if dates && samples.order.is_assumed => Some(format!(
            "the dates in `{}` do not tell day and month apart and were read with the month first; if the day is first, \
             write them with dots, as 14.06.2023",
            heading.title
        )),
        Told::Assumed => odd_rate(&seconds),
        Told::Whole => Some(format!(
            "the time column states no unit; its whole numbers were taken to be in {}, another with `data.time_unit`",
            unit.name()
        )),
        _ => contradiction(heading, stated, "data.time_unit"),
    };
    let reading = ColumnReading {
        column: heading.title.clone(),
        unit: Some(unit.name().to_owned()),
        because: format!("{}; {because}", time.because),
    };
    (seconds, Some(reading), findings.into_iter().collect())
}

/// Returns the input's factor to SI and its reading.
fn input_scale(
    table: &Table<'_>,
    input: Option<Pick>,
    observed: Unit,
    options: &ReadOptions,
    findings: &mut Vec<String>,
) -> (f64, Option<ColumnReading>) {
    let Some(input) = input else { return (1.0, None) };
    let heading = heading(table, input.at);
    let stated = options.columns.input_unit.or(heading.unit());
    // A commanded position has the unit of the position in the same file.
    let commands = ["command", "cmd", "setpoint", "target", "desired", "action", "soll", "sollwert"]
        .iter()
        .any(|word| heading.has(word));
    let unit = stated.or(Some(observed).filter(|_| commands));
    let taken = unit.map_or("its own unit", Unit::symbol);
    findings.extend(unknown_unit(heading, stated.is_none(), taken, "data.input_unit"));
    if stated.is_none() && heading.unknown.is_none() && observed.to_si() != 1.0 {
        let taken =
            unit.map_or("left as it is".to_owned(), |unit| format!("taken to be in {}", unit.symbol()));
        findings.push(format!(
            "the input `{}` states no unit and was {taken}, beside values in {}; set `data.input_unit` if that is wrong",
            heading.title,
            observed.symbol()
        ));
    }
    let how = match (options.columns.input_unit, heading.unit(), unit) {
        (Some(_), ..) => "from the options",
        (None, Some(_), _) => "from the header",
        (None, None, Some(_)) => "assumed to be that of the values",
        (None, None, None) => "not stated",
    };
    let reading = ColumnReading {
        column: heading.title.clone(),
        unit: unit.map(|unit| unit.symbol().to_owned()),
        because: format!("{}; unit {how}", input.because),
    };
    (unit.map_or(1.0, Unit::to_si), Some(reading))
}
