//! Choice of the columns of time, observed quantity and input: by the options, else by names and units.

use crate::columns::CsvColumns;
use crate::error::Fault;
use crate::heading::Heading;
use crate::names::{
    ACCELERATIONS, INPUTS, LENGTHS, OF_VECTORS, POSITIONS, SIGNALS, TIMES, TORQUES, VELOCITIES,
};
use crate::options::ReadOptions;
use crate::reading::Coordinate;
use crate::record::Quantity;
use crate::statistics::extremes;
use crate::swing::Swing;
use crate::unit::{Dimension, Unit};

/// Kind of the cells of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Numbers,
    Dates,
    Text,
}

/// A column before its cells are read.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Column {
    pub(crate) heading: Heading,
    pub(crate) kind: Kind,
}

/// A chosen column with the reason for the choice.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Pick {
    pub(crate) at: usize,
    pub(crate) because: &'static str,
}

const NAMED: &str = "named in the options";
const BY_NAME: &str = "by its name";
const BY_UNIT: &str = "by its unit";
const ONLY: &str = "the only other column of numbers";
const BY_SWING: &str = "by its swing";
/// Factor by which one column has to swing farther than another to be taken against the order of names.
const FARTHER: f64 = 2.0;

/// Name that requests no input, unless a column has this name.
const NO_INPUT: &str = "none";

/// Returns the position in a list of the first of its words that a name contains.
fn rank(heading: &Heading, list: &[&str]) -> Option<usize> {
    list.iter().position(|word| heading.has(word))
}

fn drives(heading: &Heading) -> bool {
    rank(heading, TORQUES).or_else(|| rank(heading, INPUTS)).is_some()
        || heading.unit().is_some_and(|unit| matches!(unit.dimension(), Dimension::Drive | Dimension::Force))
}

/// Returns the quantity that a name suggests, with its rank.
fn observed(heading: &Heading) -> Option<(Quantity, usize)> {
    let of = |quantity, list| rank(heading, list).map(|rank| (quantity, rank));
    let by_unit = heading.unit().map(|unit| quantity_of(unit.order()));
    of(Quantity::Acceleration, ACCELERATIONS)
        .or_else(|| of(Quantity::Velocity, VELOCITIES))
        .or_else(|| of(Quantity::Position, POSITIONS))
        .map(|(quantity, rank)| (by_unit.unwrap_or(quantity), rank))
}

pub(crate) fn quantity_of(order: usize) -> Quantity {
    match order {
        0 => Quantity::Position,
        1 => Quantity::Velocity,
        _ => Quantity::Acceleration,
    }
}

/// Returns the quantity of a column: by the options, else by its unit or name, else a position.
pub(crate) fn quantity(heading: &Heading, options: &ReadOptions) -> Quantity {
    let unit = options.columns.unit.or(heading.unit());
    options
        .quantity
        .or(unit.map(|unit| quantity_of(unit.order())))
        .or(observed(heading).map(|(quantity, _)| quantity))
        .unwrap_or(Quantity::Position)
}

/// Returns `true` if a column is a time by its name or its unit.
pub(crate) fn is_time(heading: &Heading) -> bool {
    heading.time_unit().is_some() || heading.unit().is_none() && rank(heading, TIMES).is_some()
}

/// Half the range of values, in radians, above which angles without a unit are taken to be in degrees.
const DEGREES_BEYOND: f64 = std::f64::consts::TAU;

/// Returns the unit of a column that states none: the SI unit, volts for the channel of an oscilloscope or of a sound, or
/// degrees for angles that would be turns, of which not all are whole numbers as counts are.
pub(crate) fn assumed_unit(
    heading: &Heading,
    quantity: Quantity,
    coordinate: Option<Coordinate>,
    values: &[f64],
) -> Unit {
    let is_signal = observed(heading).is_none() && rank(heading, SIGNALS).is_some();
    if is_signal && quantity == Quantity::Position && coordinate != Some(Coordinate::Angle) {
        return Unit::Volt;
    }
    let length = rank(heading, LENGTHS).is_some()
        || quantity == Quantity::Acceleration && rank(heading, ACCELERATIONS).is_some();
    let coordinate = coordinate.unwrap_or(if length { Coordinate::Displacement } else { Coordinate::Angle });
    match (coordinate, quantity) {
        (Coordinate::Angle, Quantity::Position) if reaches_turns(values) => Unit::Degree,
        (Coordinate::Angle, Quantity::Position) => Unit::Radian,
        (Coordinate::Angle, Quantity::Velocity) => Unit::RadianPerSecond,
        (Coordinate::Angle, Quantity::Acceleration) => Unit::RadianPerSecondSquared,
        (Coordinate::Displacement, Quantity::Position) => Unit::Meter,
        (Coordinate::Displacement, Quantity::Velocity) => Unit::MeterPerSecond,
        (Coordinate::Displacement, Quantity::Acceleration) => Unit::MeterPerSecondSquared,
    }
}

fn reaches_turns(values: &[f64]) -> bool {
    let [lowest, highest] = extremes(values);
    0.5 * (highest - lowest) > DEGREES_BEYOND && values.iter().any(|value| value.fract() != 0.0)
}

/// Suitability of a column as the observed one; see [`Roles::score`].
type Score = (bool, usize, usize, bool);

/// Columns of a table, and the options for choosing among them.
pub(crate) struct Roles<'a> {
    pub(crate) line: u64,
    pub(crate) columns: &'a [Column],
    pub(crate) options: &'a ReadOptions,
}

impl Roles<'_> {
    fn asked(&self) -> &CsvColumns {
        &self.options.columns
    }

    /// Finds a column by name: as written, else ignoring case, else without its unit.
    pub(crate) fn named(&self, name: &str, key: &'static str) -> Result<usize, Fault> {
        let find =
            |same: &dyn Fn(&Heading) -> bool| self.columns.iter().position(|column| same(&column.heading));
        find(&|heading| heading.title == name)
            .or_else(|| find(&|heading| heading.title.eq_ignore_ascii_case(name)))
            .or_else(|| find(&|heading| heading.words.join("_").eq_ignore_ascii_case(name)))
            .or_else(|| find(&|heading| heading.without_unit().eq_ignore_ascii_case(name)))
            .ok_or_else(|| self.missing(name.to_owned(), key))
    }

    fn missing(&self, wanted: String, key: &'static str) -> Fault {
        Fault::MissingColumn { line: self.line, wanted, found: self.titles(|_| true), key }
    }

    fn titles(&self, shown: impl Fn(&Column) -> bool) -> String {
        let titles = self.columns.iter().filter(|column| shown(column) && !column.heading.title.is_empty());
        titles.map(|column| format!("`{}`", column.heading.title)).collect::<Vec<_>>().join(", ")
    }

    /// Returns the time column; `None` if the file has no stamps and the options give a rate.
    pub(crate) fn time(&self) -> Result<Option<Pick>, Fault> {
        if let Some(name) = &self.asked().time {
            return Ok(Some(Pick { at: self.named(name, "data.time")?, because: NAMED }));
        }
        let usable = |column: &&(usize, &Column)| column.1.kind != Kind::Text;
        let score = |&(_, column): &(usize, &Column)| {
            let word = rank(&column.heading, TIMES).filter(|_| column.heading.unit().is_none());
            let has_unit = column.heading.time_unit().is_some();
            // Dates rank after elapsed times, because a date states when a line was written.
            let kind = if column.kind == Kind::Dates { 200 } else { 0 };
            match (word, has_unit) {
                _ if column.heading.has("elapsed") => Some(kind),
                (Some(word), _) => Some(kind + 1 + word),
                (None, true) => Some(kind + 100),
                (None, false) => (column.kind == Kind::Dates).then_some(kind + 100),
            }
        };
        let columns: Vec<(usize, &Column)> = self.columns.iter().enumerate().collect();
        let best = columns
            .iter()
            .filter(usable)
            .filter_map(|column| score(column).map(|score| (score, column.0)))
            .min();
        match best {
            Some((score, at)) if score % 200 < 100 => Ok(Some(Pick { at, because: BY_NAME })),
            Some((_, at)) => Ok(Some(Pick { at, because: BY_UNIT })),
            None if self.asked().sample_rate_hz.is_some() => Ok(None),
            None => Err(Fault::NoTime { line: self.line, found: self.titles(|_| true) }),
        }
    }

    /// Returns the observed column, and a sentence if another one could be it as well. Names decide between
    /// columns that swing alike; a column that swings comes before one that does not, and one that swings
    /// twice as far as the others of its unit before those. `swing` measures the motion in a column.
    pub(crate) fn value(
        &self,
        time: Option<Pick>,
        swing: &dyn Fn(usize) -> Swing,
    ) -> Result<(Pick, Option<String>), Fault> {
        if let Some(name) = &self.asked().value {
            return Ok((Pick { at: self.named(name, "data.value")?, because: NAMED }, None));
        }
        let mut left: Vec<(usize, &Column)> = self
            .columns
            .iter()
            .enumerate()
            .filter(|(at, column)| {
                time.is_none_or(|time| time.at != *at)
                    && column.kind == Kind::Numbers
                    && column.heading.time_unit().is_none()
                    && !column.heading.title.is_empty()
            })
            .collect();
        // The length of a vector swings twice as fast as its components, beside which it says nothing.
        let is_length = |column: &Column| OF_VECTORS.iter().any(|word| column.heading.has(word));
        let components: Vec<Option<Unit>> =
            left.iter().filter(|(_, own)| !is_length(own)).map(|(_, own)| own.heading.unit()).collect();
        left.retain(|(_, own)| !is_length(own) || !components.contains(&own.heading.unit()));
        let mut found: Vec<(Score, usize)> =
            left.iter().filter_map(|(at, column)| Some((self.score(&column.heading)?, *at))).collect();
        found.sort_unstable();
        match found.as_slice() {
            [(_, at)] => match self.swings_without_name(&left, &found, swing) {
                Some(taken) => Ok(taken),
                None => Ok((Pick { at: *at, because: BY_NAME }, None)),
            },
            [(best, by_name), (next, _), ..] => match self.by_swing(&found, swing) {
                Some(at) if at != *by_name => {
                    Ok((Pick { at, because: BY_SWING }, self.by_swing_said(at, &found)))
                }
                // A column that swings comes before one with a better name that does not.
                None if let Some(taken) = self.swings_without_name(&left, &found, swing) => Ok(taken),
                // Of two columns of the same name and rank only the swing can decide.
                None if best == next => {
                    let tied = |column: &Column| self.score(&column.heading).as_ref() == Some(best);
                    Err(self.ambiguous("the observed column", self.titles(tied), "data.value"))
                }
                _ => Ok((Pick { at: *by_name, because: BY_NAME }, self.as_likely(&found))),
            },
            // Words in such a column are a fault of their line, which is reported when the cells are read.
            [] if let Some(at) = self.text_with_such_a_name() => Ok((Pick { at, because: BY_NAME }, None)),
            [] => self.unnamed(&left, swing),
        }
    }

    /// Returns the only column without a known name that swings, if none of those with one does.
    fn swings_without_name(
        &self,
        left: &[(usize, &Column)],
        named: &[(Score, usize)],
        swing: &dyn Fn(usize) -> Swing,
    ) -> Option<(Pick, Option<String>)> {
        let is_named = |at: usize| named.iter().any(|(_, other)| *other == at);
        let others = left.iter().filter(|(at, column)| !is_named(*at) && !drives(&column.heading));
        let mut swinging = others.filter(|(at, _)| swing(*at).is_regular);
        let (at, _) = swinging.next()?;
        let only = swinging.next().is_none() && !named.iter().any(|(_, at)| swing(*at).is_regular);
        only.then(|| (Pick { at: *at, because: BY_SWING }, self.by_swing_said(*at, named)))
    }

    /// Returns the observed column among columns without a known name, as [`Roles::value`] does.
    fn unnamed(
        &self,
        left: &[(usize, &Column)],
        swing: &dyn Fn(usize) -> Swing,
    ) -> Result<(Pick, Option<String>), Fault> {
        let other: Vec<(Score, usize)> = left
            .iter()
            .filter(|(_, column)| !drives(&column.heading))
            .map(|(at, _)| ((false, 0, 0, false), *at))
            .collect();
        match other.as_slice() {
            // A voltage or a force beside a time alone is a sensor's.
            [] => match left {
                [(at, column)] if column.heading.unit().is_some_and(Unit::is_signal) => {
                    Ok((Pick { at: *at, because: ONLY }, None))
                }
                _ => Err(self.missing("angle`, `displacement` or `position".to_owned(), "data.value")),
            },
            [(_, at)] => Ok((Pick { at: *at, because: ONLY }, None)),
            _ => match self.by_swing(&other, swing) {
                Some(at) => Ok((Pick { at, because: BY_SWING }, self.by_swing_said(at, &other))),
                None => {
                    let titles = self.titles_at(&other);
                    Err(self.ambiguous("the observed column", titles, "data.value"))
                }
            },
        }
    }

    /// Returns the column that the data choose: of those of the best quantity in which something swings, the
    /// one whose swing is larger than the others' of its unit by [`FARTHER`], else the first by name. `None` if
    /// names have to decide between columns of the same rank, and cannot.
    fn by_swing(&self, found: &[(Score, usize)], swing: &dyn Fn(usize) -> Swing) -> Option<usize> {
        let measured: Vec<(&Score, usize, Swing)> =
            found.iter().map(|(score, at)| (score, *at, swing(*at))).collect();
        let order = |score: &Score| (score.0, score.1);
        let swings = measured.iter().filter(|(.., swing)| swing.is_regular);
        let (best, by_name, first) = *swings.clone().min_by_key(|(score, at, _)| (**score, *at))?;
        let unit = |at: usize| self.columns.get(at).and_then(|column| column.heading.unit()).map(Unit::si);
        let factor = |at: usize| {
            self.columns.get(at).and_then(|column| column.heading.unit()).map_or(1.0, Unit::to_si)
        };
        let like = swings.filter(|(score, at, _)| order(score) == order(best) && unit(*at) == unit(by_name));
        let mut sizes: Vec<(f64, usize)> =
            like.map(|(_, at, swing)| (swing.size * factor(*at), *at)).collect();
        sizes.sort_by(|one, other| other.0.total_cmp(&one.0));
        match sizes.as_slice() {
            [(size, at), ..] if *size > FARTHER * first.size * factor(by_name) => Some(*at),
            _ => {
                let tied = |(_, at): &&(f64, usize)| {
                    *at != by_name && measured.iter().any(|(score, other, _)| other == at && *score == best)
                };
                let close =
                    sizes.iter().filter(tied).any(|(size, _)| *size * FARTHER > first.size * factor(by_name));
                (!close).then_some(by_name)
            }
        }
    }

    /// Returns a sentence on the columns that were not taken, because another one swings.
    fn by_swing_said(&self, taken: usize, found: &[(Score, usize)]) -> Option<String> {
        let taken = &self.columns.get(taken)?.heading.title;
        let others: Vec<(Score, usize)> = found
            .iter()
            .filter(|(_, at)| self.columns.get(*at).is_some_and(|column| column.heading.title != *taken))
            .copied()
            .collect();
        let others = self.titles_at(&others);
        (!others.is_empty()).then(|| {
            format!("`{taken}` was taken, which swings most clearly, and not {others}; name another with `data.value`")
        })
    }

    fn titles_at(&self, found: &[(Score, usize)]) -> String {
        let titles = found.iter().filter_map(|(_, at)| self.columns.get(*at));
        titles.map(|column| format!("`{}`", column.heading.title)).collect::<Vec<_>>().join(", ")
    }

    fn ambiguous(&self, what: &'static str, found: String, key: &'static str) -> Fault {
        Fault::Ambiguous { line: self.line, what, found, key }
    }

    /// Returns a sentence if several columns hold the same quantity as the first of `found`, as roll and
    /// pitch are both positions.
    fn as_likely(&self, found: &[(Score, usize)]) -> Option<String> {
        let ((other, order, ..), taken) = found.first()?;
        let same = |column: &Column| {
            self.score(&column.heading)
                .is_some_and(|(its, its_order, ..)| (its, its_order) == (*other, *order))
        };
        let taken = &self.columns.get(*taken)?.heading;
        // A column with the same words but another unit is the same quantity once more.
        let more = self.titles(|column| column.heading.words != taken.words && same(column));
        (!more.is_empty())
            .then(|| format!("`{}` was taken and not {more}; name another with `data.value`", taken.title))
    }

    fn text_with_such_a_name(&self) -> Option<usize> {
        self.columns
            .iter()
            .position(|column| column.kind == Kind::Text && self.score(&column.heading).is_some())
    }

    /// Returns the suitability of a column as the observed one; smaller is better. Columns of the nominal
    /// simulator's dimension come first, then positions before their derivatives, then the order of names,
    /// then SI units before others.
    fn score(&self, heading: &Heading) -> Option<Score> {
        if drives(heading) {
            return None;
        }
        let (quantity, rank) = observed(heading).or_else(|| {
            heading.unit().filter(|unit| !unit.is_signal()).map(|unit| (quantity_of(unit.order()), 50))
        })?;
        if self.options.quantity.is_some_and(|asked| asked != quantity && heading.unit().is_some()) {
            return None;
        }
        let other = match (self.options.coordinate, heading.unit().map(Unit::dimension)) {
            (Some(Coordinate::Angle), Some(dimension)) => dimension != Dimension::Angle,
            (Some(Coordinate::Displacement), Some(dimension)) => dimension == Dimension::Angle,
            (Some(Coordinate::Displacement), None) => heading.has("angle"),
            (Some(Coordinate::Angle), None) => self::rank(heading, LENGTHS).is_some(),
            (None, _) => false,
        };
        let order = match quantity {
            Quantity::Position => 0,
            Quantity::Velocity => 1,
            Quantity::Acceleration => 2,
        };
        Some((other, order, rank, heading.unit().is_some_and(|unit| unit.to_si() != 1.0)))
    }

    /// Returns the input, if there is one, and sentences if several columns could be it. Torques and forces are
    /// accepted; commands and voltages only if the system is known to be driven. Of columns that tie, one that never `moves` drives nothing.
    /// `is_observed` tells one that is the observed one in other units, as a sensor's own voltage is.
    pub(crate) fn input(
        &self,
        taken: &[usize],
        moves: &dyn Fn(usize) -> bool,
        is_observed: &dyn Fn(usize) -> bool,
    ) -> Result<(Option<Pick>, Vec<String>), Fault> {
        if let Some(name) = &self.asked().input {
            let named = self.named(name, "data.input");
            if name == NO_INPUT && named.is_err() {
                return Ok((None, Vec::new()));
            }
            let at = named?;
            if taken.contains(&at) {
                return Err(Fault::InputIsTaken { line: self.line, column: name.clone() });
            }
            return Ok((Some(Pick { at, because: NAMED }), Vec::new()));
        }
        let score = |heading: &Heading| {
            let torque = rank(heading, TORQUES).map(|_| 0);
            let by_unit = heading.unit().filter(|unit| matches!(unit.si(), "N m" | "N")).map(|_| 1);
            let other = rank(heading, INPUTS).map(|rank| 2 + rank).filter(|_| self.options.driven);
            torque.or(by_unit).or(other)
        };
        let candidates = self
            .columns
            .iter()
            .enumerate()
            .filter(|(at, column)| column.kind == Kind::Numbers && !taken.contains(at))
            .filter_map(|(at, column)| Some((score(&column.heading)?, at)));
        let (observed, mut found): (Vec<_>, Vec<_>) = candidates.partition(|(_, at)| is_observed(*at));
        found.sort_unstable();
        let mut said: Vec<String> =
            observed.iter().filter_map(|(_, at)| self.is_observed_said(*at)).collect();
        let input = match found.as_slice() {
            [] => None,
            [(best, _), (next, _), ..] if best == next => {
                let titles = self.titles(|column| score(&column.heading) == Some(*best));
                let tied = found.iter().filter(|(rank, _)| rank == best).map(|(_, at)| *at);
                let moving: Vec<usize> = tied.filter(|at| self.options.driven && moves(*at)).collect();
                if moving.len() > 1 {
                    return Err(self.ambiguous("the input", titles, "data.input"));
                }
                if moving.is_empty() {
                    said.push(format!(
                        "{titles} could each be the input and none was taken; name one with `data.input`"
                    ));
                }
                moving.first().map(|at| Pick { at: *at, because: BY_NAME })
            }
            [(_, at), ..] => Some(Pick { at: *at, because: BY_NAME }),
        };
        Ok((input, said))
    }

    fn is_observed_said(&self, at: usize) -> Option<String> {
        let title = &self.columns.get(at)?.heading.title;
        Some(format!(
            "`{title}` is the observed column in other units, as a sensor's own signal is, and was not taken as the input; \
             name it with `data.input` if it drives the system"
        ))
    }
}
