//! Search space: keys with choices or with ranges of numbers.

use super::{Axis, SweepError};
use settings::Document;
use toml::{Table, Value};

/// A key that a search varies and its domain.
#[derive(Debug, Clone, PartialEq)]
pub struct Dimension {
    /// Dotted key.
    pub key: String,
    /// Values that the key may take.
    pub domain: Domain,
}

/// Values that a key may take.
#[derive(Debug, Clone, PartialEq)]
pub enum Domain {
    /// One of several values, as overrides write them.
    Choice(Vec<String>),
    /// A number within a range.
    Range(Range),
}

/// Range of numbers, both endpoints included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    from: f64,
    to: f64,
    is_whole: bool,
    is_logarithmic: bool,
}

/// Significant digits of a drawn real number; few digits keep configurations readable.
const DIGITS: usize = 5;

/// Largest magnitude of a whole-number endpoint: doubles represent every whole number up to it.
const MOST_WHOLE: f64 = 9.0e15;

/// Expected form of a range, for messages.
const EXPECTED: &str = "from and to, from below to, and scale = \"linear\" or, with from above 0, \"log\"";

impl Dimension {
    /// Parses `KEY=V1,V2`, `KEY=A..B` and `KEY={from=A,to=B,scale="log"}`.
    ///
    /// A range with whole endpoints gives whole numbers, any other gives real numbers; both endpoints are
    /// included. Choices are parsed as by [`Axis::parse`].
    ///
    /// # Errors
    /// The errors of [`Axis::parse`], and [`SweepError::BadRange`] if the endpoints or the scale make no
    /// range.
    pub fn parse(argument: &str) -> Result<Self, SweepError> {
        let no_axis = || SweepError::NoAxis { argument: argument.to_owned() };
        let (key, text) = argument.split_once('=').ok_or_else(no_axis)?;
        let (key, text) = (key.trim().to_owned(), text.trim());
        if key.is_empty() {
            return Err(no_axis());
        }
        let bad =
            |problem| SweepError::BadRange { argument: argument.to_owned(), range: text.to_owned(), problem };
        if let Ok(Value::Table(table)) = text.parse::<Value>() {
            let domain = Domain::from_table(&table).ok_or_else(|| bad(EXPECTED))?;
            return Ok(Self { key, domain });
        }
        let ends = text.split_once("..").map(|(from, to)| (from.trim(), to.trim()));
        if let Some((from, to)) = ends
            && let (Ok(_), Ok(_)) = (from.parse::<f64>(), to.parse::<f64>())
        {
            let range = Range::of_text(from, to, false).ok_or_else(|| bad("it ends before it begins"))?;
            return Ok(Self { key, domain: Domain::Range(range) });
        }
        let axis = Axis::parse(argument)?;
        Ok(Self { key: axis.key, domain: Domain::Choice(axis.values) })
    }

    /// Takes the ranges and choices out of a study file: `KEY = { from = A, to = B, scale = "log" }` and
    /// `KEY = { choices = [V1, V2] }`.
    ///
    /// # Errors
    /// [`SweepError::BadRange`] if a table makes no range.
    pub fn taken_from(document: &mut Document) -> Result<Vec<Self>, SweepError> {
        let mut keys: Vec<String> = Vec::new();
        for leaf in document.leaves() {
            let known = leaf.key.strip_suffix(".from").or_else(|| leaf.key.strip_suffix(".choices"));
            if let Some(key) = known.filter(|key| !keys.iter().any(|known| known == key)) {
                keys.push(key.to_owned());
            }
        }
        let mut found = Vec::new();
        for key in keys {
            let mut table = Table::new();
            for name in ["from", "to", "scale", "choices"] {
                if let Some(leaf) = document.get(&format!("{key}.{name}")) {
                    table.insert(name.to_owned(), leaf.value.clone());
                }
            }
            document.clear_table(&key);
            let domain = Domain::from_table(&table).ok_or_else(|| SweepError::BadRange {
                argument: format!("{}: {key}", document.file()),
                range: Value::Table(table).to_string(),
                problem: EXPECTED,
            })?;
            found.push(Self { key, domain });
        }
        Ok(found)
    }

    /// Returns the override for a place in the unit interval.
    #[must_use]
    pub fn at(&self, place: f64) -> String {
        match &self.domain {
            Domain::Choice(values) => {
                let number = ((place * values.len() as f64) as usize).min(values.len().saturating_sub(1));
                format!("{}={}", self.key, values.get(number).map_or("", String::as_str))
            }
            Domain::Range(range) => format!("{}={}", self.key, range.text(place)),
        }
    }

    /// Returns the place in the unit interval of an override's value; `None` if the domain does not contain
    /// the value.
    #[must_use]
    pub fn place(&self, argument: &str) -> Option<f64> {
        let value = argument.strip_prefix(&self.key)?.strip_prefix('=')?;
        match &self.domain {
            Domain::Choice(values) => {
                let number = values.iter().position(|own| own == value)?;
                Some((number as f64 + 0.5) / values.len() as f64)
            }
            Domain::Range(range) => range.place(value.parse().ok()?),
        }
    }

    /// Returns the number of different values; `None` if the values cannot be counted.
    #[must_use]
    pub fn count(&self) -> Option<u128> {
        match &self.domain {
            Domain::Choice(values) => Some(values.len() as u128),
            Domain::Range(range) if range.is_whole => Some((range.to - range.from) as u128 + 1),
            Domain::Range(_) => None,
        }
    }

    /// Returns values and scale as stored in a manifest: the choices without a scale, or the endpoints with
    /// one.
    #[must_use]
    pub fn described(&self) -> (Vec<String>, Option<&'static str>) {
        match &self.domain {
            Domain::Choice(values) => (values.clone(), None),
            Domain::Range(range) => {
                let scale = if range.is_logarithmic { "log" } else { "linear" };
                (vec![range.written(range.from), range.written(range.to)], Some(scale))
            }
        }
    }

    /// Returns the dimension that [`described`](Self::described) describes; `None` if the description is
    /// invalid.
    #[must_use]
    pub fn from_described(key: &str, values: &[String], scale: Option<&str>) -> Option<Self> {
        let domain = match (scale, values) {
            (None, values) => Domain::Choice(values.to_vec()),
            (Some(scale), [from, to]) => Domain::Range(Range::of_text(from, to, scale == "log")?),
            _ => return None,
        };
        Some(Self { key: key.to_owned(), domain })
    }
}

impl Domain {
    fn from_table(table: &Table) -> Option<Self> {
        if let Some(Value::Array(values)) = table.get("choices").filter(|_| table.len() == 1) {
            let text = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
            return (!values.is_empty()).then(|| Self::Choice(values.iter().map(text).collect()));
        }
        let known = |name: &String| ["from", "to", "scale"].contains(&name.as_str());
        let is_logarithmic = match table.get("scale").map(Value::as_str) {
            None | Some(Some("linear")) => false,
            Some(Some("log")) => true,
            Some(_) => return None,
        };
        let [from, to] = ["from", "to"].map(|name| table.get(name).map(Value::to_string));
        let range = Range::of_text(&from?, &to?, is_logarithmic)?;
        table.keys().all(known).then_some(Self::Range(range))
    }
}

impl Range {
    /// Parses the endpoints; the range is one of whole numbers if both are whole.
    fn of_text(from: &str, to: &str, is_logarithmic: bool) -> Option<Self> {
        let is_whole = from.parse::<i64>().is_ok() && to.parse::<i64>().is_ok();
        let (from, to): (f64, f64) = (from.parse().ok()?, to.parse().ok()?);
        let is_range = from < to && from.is_finite() && to.is_finite() && (to - from).is_finite();
        let can_be_whole = !is_whole || from.abs().max(to.abs()) <= MOST_WHOLE;
        let can_be_logarithmic = !is_logarithmic || from > 0.0;
        (is_range && can_be_whole && can_be_logarithmic).then_some(Self {
            from,
            to,
            is_whole,
            is_logarithmic,
        })
    }

    /// Returns the endpoints on the scale on which draws are uniform. Each whole number has a cell of equal
    /// width.
    fn ends(self) -> [f64; 2] {
        let half = if self.is_whole { 0.5 } else { 0.0 };
        [self.from - half, self.to + half].map(|end| if self.is_logarithmic { end.ln() } else { end })
    }

    fn text(self, place: f64) -> String {
        let [low, high] = self.ends();
        let value = low + place * (high - low);
        let value = if self.is_logarithmic { value.exp() } else { value };
        let rounded = if self.is_whole {
            value.round()
        } else {
            format!("{value:.*e}", DIGITS - 1).parse().unwrap_or(value)
        };
        self.written(rounded.clamp(self.from, self.to))
    }

    fn place(self, value: f64) -> Option<f64> {
        let [low, high] = self.ends();
        let value = if self.is_logarithmic { value.ln() } else { value };
        let place = (value - low) / (high - low);
        (0.0..=1.0).contains(&place).then_some(place)
    }

    /// Formats a value; a real number keeps its decimal point, so that it is read back as one.
    fn written(self, value: f64) -> String {
        if self.is_whole { format!("{value:.0}") } else { format!("{value:?}") }
    }
}

#[cfg(test)]
mod tests {
    use super::Dimension;
    use settings::Document;

    fn dimension(argument: &str) -> Dimension {
        Dimension::parse(argument).unwrap()
    }

    #[test]
    fn a_range_is_drawn_from_evenly_in_its_scale() {
        let at = |argument: &str| [0.0, 0.5, 0.999_999_9].map(|place| dimension(argument).at(place));
        assert_eq!(at("x=0.5..1.5"), ["x=0.5", "x=1.0", "x=1.5"]);
        assert_eq!(at("x={from=1e-4,to=1e-2,scale=\"log\"}"), ["x=0.0001", "x=0.001", "x=0.01"]);
        assert_eq!(at("x=2..4"), ["x=2", "x=3", "x=4"]);
        assert_eq!(at("x={ from = 8, to = 128, scale = 'log' }"), ["x=8", "x=31", "x=128"]);
        assert_eq!(at("x=[16],[32,32],a"), ["x=[16]", "x=[32,32]", "x=a"]);
    }

    #[test]
    fn a_value_lies_where_it_was_drawn() {
        for argument in ["x=0.5..1.5", "x={from=1e-4,to=1e-2,scale='log'}", "x=1..9", "x=a,b,c"] {
            let dimension = dimension(argument);
            for place in [0.0, 0.3, 0.7, 0.99] {
                let text = dimension.at(place);
                let back = dimension.place(&text).unwrap();
                assert_eq!(dimension.at(back), text, "{argument} {place} {back}");
            }
            let (values, scale) = dimension.described();
            assert_eq!(Dimension::from_described("x", &values, scale).unwrap(), dimension);
        }
        assert_eq!(dimension("x=1..9").place("x=11"), None);
        assert_eq!([dimension("x=1..9").count(), dimension("x=a,b").count()], [Some(9), Some(2)]);
        assert_eq!(dimension("x=1.0..9").count(), None);
    }

    #[test]
    fn a_study_file_may_hold_the_ranges() {
        let text = "seed = 1\n[lstm]\nwidth = { from = 8, to = 64 }\nlearning_rate = { from = 1e-4, to = 1e-2, scale = 'log' }\n\
                    layers = { choices = [1, 2] }\nepochs = 3\n";
        let mut document = Document::parse("a.toml", text).unwrap();
        let found = Dimension::taken_from(&mut document).unwrap();
        let mut drawn: Vec<String> = found.iter().map(|dimension| dimension.at(0.0)).collect();
        drawn.sort();
        assert_eq!(drawn, ["lstm.layers=1", "lstm.learning_rate=0.0001", "lstm.width=8"]);
        let left: Vec<&str> = document.leaves().iter().map(|leaf| leaf.key.as_str()).collect();
        assert_eq!(left, ["seed", "lstm.epochs"]);
        let mut wrong = Document::parse("a.toml", "[lstm]\nwidth = { from = 8 }").unwrap();
        let refused = Dimension::taken_from(&mut wrong).unwrap_err().to_string();
        assert!(refused.contains("lstm.width") && refused.contains("from below to"), "{refused}");
    }

    #[test]
    fn what_makes_no_range_is_refused() {
        for argument in [
            "x={from=0,to=1,scale='log'}",
            "x={from=1,to=0}",
            "x={from=1}",
            "x={from=1,to=2,scale='square'}",
            "x={from=1,to=2,step=1}",
            "x=2.5..1.5",
            "x=2..2",
        ] {
            let refused = Dimension::parse(argument).unwrap_err().to_string();
            assert!(refused.contains("x="), "{argument}: {refused}");
        }
        assert!(Dimension::parse("x").unwrap_err().to_string().contains("is no axis"));
    }
}
