//! Reader of the `csv` format: a header with column names, then numbers.

use crate::columns::{Filter, Missing};
use crate::copies::copies;
use crate::dialect::{self, Layout, is_date, is_missing};
use crate::error::Fault;
use crate::heading::{Heading, Measure};
use crate::options::ReadOptions;
use crate::parsed::Parsed;
use crate::reading::{ColumnReading, Reading};
use crate::record::InputRow;
use crate::roles::{Column, Kind, Pick, Roles, assumed_unit, quantity};
use crate::statement::Statements;
use crate::times::{Stamp, Times, Told, seconds};
use crate::unit::{TimeUnit, Unit};
use crate::words::counted;
use std::collections::BTreeSet;

/// Number of rows from which the kind of a column is determined.
const TOLD_FROM: usize = 200;
/// Largest number of values of a column that distinguishes series.
const MOST_SERIES: usize = 40;
/// Names of columns that distinguish series.
const SERIES: &[&str] =
    &["joint", "axis", "motor", "channel", "sensor", "body", "link", "servo", "name", "id"];

/// Table of a text, with the headings and kinds of its columns.
pub(crate) struct Table<'a> {
    layout: Layout<'a>,
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

    fn title(&self, at: usize) -> &str {
        self.columns.get(at).map_or("", |column| column.heading.title.as_str())
    }

    /// Returns the values of a column in the order of their first lines, or no values if there are too many
    /// to distinguish series.
    fn values(&self, at: usize) -> Vec<&'a str> {
        let (mut known, mut found) = (BTreeSet::new(), Vec::new());
        for (_, row) in &self.layout.rows {
            // A row that ends before the column has an empty cell there.
            let value = self.layout.dialect.split(row).get(at).copied().unwrap_or_default();
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
    fn series(&self, any: bool) -> Option<Fault> {
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
            // Without a value there is no example.
            example: values.first().copied().unwrap_or_default().to_owned(),
        })
    }

    /// Returns the lines that a filter keeps.
    fn chosen(&self, filter: Option<&(usize, &Filter)>) -> Result<Vec<(u64, Vec<&'a str>)>, Fault> {
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

/// Samples of a table before their stamps are converted to seconds.
#[derive(Default)]
struct Samples {
    lines: Vec<u64>,
    /// Numbers of the lines among the chosen lines.
    numbers: Vec<usize>,
    stamps: Vec<Stamp>,
    /// `None` on a line that lacks only the observed cell: its input still acts.
    values: Vec<Option<f64>>,
    input: Vec<f64>,
    missing_cells: usize,
    missing_lines: usize,
    first_missing: Option<(u64, usize)>,
}

/// Columns that are read.
struct Chosen {
    time: Option<Pick>,
    /// Column of nanoseconds that belongs to a time column of seconds.
    nanoseconds: Option<usize>,
    value: Pick,
    input: Option<Pick>,
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
    let roles = Roles { line: table.layout.line, columns: &table.columns, options };
    let filter = match &asked.filter {
        Some(filter) => Some((roles.named(&filter.column, "data.where")?, filter)),
        None => None,
    };
    let time = roles.time()?;
    let (value, also) = roles.value(time)?;
    let taken: Vec<usize> = [Some(value), time].into_iter().flatten().map(|pick| pick.at).collect();
    let (input, note) = roles.input(&taken)?;
    if let Some(fault) = filter.is_none().then(|| table.series(false)).flatten() {
        return Err(fault);
    }
    let chosen = Chosen {
        time,
        nanoseconds: time.and_then(|time| nanoseconds(&table.columns, time.at)),
        value,
        input,
    };
    let rows = table.chosen(filter.as_ref())?;
    let samples = read(&table, &chosen, &rows, asked.missing)?;
    if let (Missing::Refuse, Some((line, at))) = (asked.missing, samples.first_missing) {
        let column = table.title(at).to_owned();
        return Err(Fault::MissingCells { line, column, count: samples.missing_cells });
    }
    if time.is_some() {
        statements.sample_rate_hz = asked.sample_rate_hz.or(statements.sample_rate_hz);
    }
    let (heading, quantity) = (heading(&table, value.at), quantity(heading(&table, value.at), options));
    let assumed = asked.unit.or(heading.unit()).is_none();
    let unit =
        asked.unit.or(heading.unit()).unwrap_or_else(|| assumed_unit(heading, quantity, options.coordinate));
    let (stamps, time_reading, mut findings) = stamps(&table, &chosen, options, &samples);
    findings.extend(also.into_iter().chain(note));
    let stated = [asked.unit, heading.unit()].map(|unit| unit.map(Unit::symbol));
    findings.extend(contradiction(heading, stated, "data.unit"));
    findings.extend(unknown_unit(heading, assumed, unit.symbol(), "data.unit"));
    let (input_factor, input_reading) = input_scale(&table, input, unit, options, &mut findings);
    let reading = Reading {
        format: "csv".to_owned(),
        separator: table.layout.dialect.name().to_owned(),
        decimal: if table.layout.dialect.decimal_comma { "comma" } else { "point" }.to_owned(),
        header_line: table.layout.line,
        time: time_reading,
        sample_rate_hz: if time.is_none() { asked.sample_rate_hz } else { None },
        value: ColumnReading {
            column: heading.title.clone(),
            unit: Some(unit.symbol().to_owned()),
            because: format!("{}; unit {}", value.because, told(asked.unit.is_some(), assumed)),
        },
        input: input_reading,
        filter: asked.filter.clone().map(String::from),
        missing_cells: samples.missing_cells,
        missing_lines: samples.missing_lines,
        missing: asked.missing,
        quantity,
        ..Reading::default()
    };
    let mut parsed = Parsed::new(unit, statements, reading);
    let copies =
        if time.is_some() { copies(&stamps, &samples.values, &samples.input) } else { BTreeSet::new() };
    findings.extend(copied(copies.len()));
    let (mut numbers, mut left_out) = (Vec::new(), 0);
    for (at, ((line, stamp), number)) in samples.lines.iter().zip(&stamps).zip(&samples.numbers).enumerate() {
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
        let pushed = parsed.push(*line, *stamp, value * unit.to_si(), input);
        // Stamps that run backward may belong to several interleaved series.
        pushed.map_err(|fault| filter.is_none().then(|| table.series(true)).flatten().unwrap_or(fault))?;
        numbers.push(number);
    }
    parsed.rows = (samples.missing_lines > 0 && asked.missing == Missing::Segment).then_some(numbers);
    let doubted = heading.unknown.is_none() && (assumed || asked.unit.is_none());
    let values: Vec<f64> = samples.values.iter().flatten().copied().collect();
    findings.extend(doubted.then(|| doubtful_unit(&values, unit, assumed)).flatten());
    parsed.findings = findings;
    Ok(parsed)
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

/// Reads the cells of the chosen columns.
fn read(
    table: &Table<'_>,
    chosen: &Chosen,
    rows: &[(u64, Vec<&str>)],
    treated: Missing,
) -> Result<Samples, Fault> {
    let dialect = table.layout.dialect;
    let width = table.columns.len();
    let mut samples = Samples::default();
    let columns = chosen.columns();
    // The observed column is always among them.
    let needed = columns.iter().max().map_or(0, |at| at + 1);
    for (number, (line, row)) in rows.iter().enumerate() {
        if row.len() < needed {
            return Err(Fault::MissingField { line: *line, found: row.len(), expected: width });
        }
        if row.iter().skip(width).any(|field| !field.is_empty()) {
            return Err(Fault::ExtraFields { line: *line, found: row.len(), expected: width });
        }
        // A row that ends before the column has an empty cell there.
        let cell = |at: usize| row.get(at).copied().unwrap_or_default();
        let missing: Vec<usize> = columns.iter().copied().filter(|at| is_missing(cell(*at))).collect();
        let read =
            |at: usize| dialect.number(cell(at)).ok_or_else(|| not_a_number(table, *line, at, cell(at)));
        if let Some(first) = missing.first() {
            // A word in one of the other cells is still a fault.
            columns.iter().filter(|at| !missing.contains(at)).try_for_each(|at| {
                let known = Some(*at) == chosen.time.map(|pick| pick.at) || read(*at).is_ok();
                if known { Ok(()) } else { Err(not_a_number(table, *line, *at, cell(*at))) }
            })?;
            samples.missing_cells += missing.len();
            samples.missing_lines += 1;
            samples.first_missing.get_or_insert((*line, *first));
            let acts = chosen.input.is_some() && treated == Missing::Segment;
            if !(acts && missing == [chosen.value.at]) {
                continue;
            }
        }
        if let Some(time) = chosen.time {
            let stamp = |at: usize| {
                Stamp::parse(cell(at), dialect).ok_or_else(|| not_a_number(table, *line, at, cell(at)))
            };
            let whole = stamp(time.at)?;
            samples.stamps.push(match chosen.nanoseconds {
                Some(at) => whole.with_nanoseconds(stamp(at)?),
                None => whole,
            });
        }
        samples.values.push(if missing.is_empty() { Some(read(chosen.value.at)?) } else { None });
        if let Some(input) = chosen.input {
            samples.input.push(read(input.at)?);
        }
        samples.lines.push(*line);
        samples.numbers.push(number);
    }
    Ok(samples)
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
            Missing::Drop => index as f64 / rate,
            _ => *number as f64 / rate,
        };
        return (samples.numbers.iter().enumerate().map(place).collect(), None, Vec::new());
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
        (None, Told::Assumed) => "unit assumed, none is stated".to_owned(),
    };
    if from_first {
        because.push_str(", counted from the first");
    }
    let stated = [asked.time_unit, named.filter(|_| !dates)].map(|unit| unit.map(TimeUnit::name));
    let findings = if how == Told::Assumed {
        odd_rate(&seconds)
    } else {
        contradiction(heading, stated, "data.time_unit")
    };
    let reading = ColumnReading {
        column: heading.title.clone(),
        unit: Some(unit.name().to_owned()),
        because: format!("{}; {because}", time.because),
    };
    (seconds, Some(reading), findings.into_iter().collect())
}

/// Returns a sentence if an option states a different unit than the header.
fn contradiction(heading: &Heading, [asked, written]: [Option<&str>; 2], key: &str) -> Option<String> {
    let (asked, written) = asked.zip(written).filter(|(asked, written)| asked != written)?;
    Some(format!(
        "the header `{}` states {written}, the options say {asked} and are followed; leave out `{key}` if the header is right",
        heading.title
    ))
}

/// Returns a sentence if the header states an unknown unit.
fn unknown_unit(heading: &Heading, assumed: bool, taken: &str, key: &str) -> Option<String> {
    let unit = heading.unknown.as_ref().filter(|_| assumed)?;
    Some(format!(
        "the header `{}` states `{unit}`, which is no known unit: the numbers were taken to be in {taken}; set `{key}`, or \
         convert them",
        heading.title
    ))
}

/// Returns a sentence if stamps assumed to be in seconds imply a sampling rate that hardly any logger has.
fn odd_rate(stamps: &[f64]) -> Option<String> {
    let mut steps: Vec<f64> =
        stamps.iter().zip(stamps.iter().skip(1)).map(|(one, next)| next - one).collect();
    steps.retain(|step| *step > 0.0);
    steps.sort_by(f64::total_cmp);
    let step = *steps.get(steps.len() / 2)?;
    let unit = match step {
        step if (1.0..1000.0).contains(&step) => "ms",
        step if (1e3..1e6).contains(&step) => "us",
        step if step >= 1e6 => "ns",
        step if step < 1e-6 => "another unit",
        _ => return None,
    };
    Some(format!(
        "the time column states no unit and was taken to be in seconds, which makes {:.3e} samples a second; if it is in \
         {unit}, set `data.time_unit`",
        1.0 / step
    ))
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
    let commands =
        ["command", "cmd", "setpoint", "target", "desired", "action"].iter().any(|word| heading.has(word));
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

/// Returns a sentence if the values suggest another unit. Without a stated unit these are angles beyond a
/// right angle, angular velocities beyond the range of gyroscopes, and accelerations centered on 1, the
/// gravity in g. With a unit from the header, only angles beyond a full turn are doubted.
fn doubtful_unit(values: &[f64], unit: Unit, assumed: bool) -> Option<String> {
    let highest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let lowest = values.iter().copied().fold(f64::INFINITY, f64::min);
    let (half, middle) = (0.5 * (highest - lowest), 0.5 * (highest + lowest));
    let taken = if assumed {
        format!("the values state no unit and were taken to be in {}", unit.symbol())
    } else {
        format!("the header says {}", unit.symbol())
    };
    match unit {
        Unit::Radian if half > std::f64::consts::TAU => Some(format!(
            "{taken}, {:.1} turns to either side; if they are degrees (a factor of 57.3), set `data.unit` to deg",
            half / std::f64::consts::TAU
        )),
        _ if !assumed => None,
        Unit::Radian if half > std::f64::consts::FRAC_PI_2 => Some(format!(
            "{taken}, {:.0} degrees to either side; if they are degrees (a factor of 57.3), {half:.1} of them, set \
             `data.unit` to deg",
            half.to_degrees()
        )),
        Unit::RadianPerSecond if half > FASTEST => Some(format!(
            "{taken}, {:.0} degrees a second; if they are degrees a second (a factor of 57.3), set `data.unit` to deg/s",
            half.to_degrees()
        )),
        Unit::MeterPerSecondSquared if (middle.abs() - 1.0).abs() < 0.1 => Some(format!(
            "{taken}, and they center on {middle:.2}, as at rest in units of gravity; if they are in g (a factor of 9.81), set \
             `data.unit` to g"
        )),
        _ => None,
    }
}

/// Largest angular velocity that gyroscopes measure, in rad/s: 2000 degrees a second.
const FASTEST: f64 = 35.0;
