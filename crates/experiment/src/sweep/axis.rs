//! Axes of a sweep and their combinations.

use super::{MOST_RUNS, SweepError};

/// A key and the values that a sweep gives it, in the order of the argument.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Axis {
    /// Dotted key.
    pub key: String,
    /// Values as an override takes them: TOML or plain text.
    pub values: Vec<String>,
}

impl Axis {
    /// Parses `KEY=V1,V2` and `KEY=A..B`.
    ///
    /// Commas separate values, but not inside brackets, braces or quotes: `estimator.hidden=[64],[32,32]` has
    /// two values. `A..B` stands for every whole number from A to B, *both included*. A range may stand among
    /// other values, as in `seed=0..4,10`.
    ///
    /// # Errors
    /// [`SweepError::NoAxis`] without a `=`; [`SweepError::EmptyValue`], [`SweepError::Unclosed`] and
    /// [`SweepError::BadRange`] if the values cannot be read; [`SweepError::TooManyRuns`] if a range is
    /// longer than a sweep may be.
    pub fn parse(argument: &str) -> Result<Self, SweepError> {
        let no_axis = || SweepError::NoAxis { argument: argument.to_owned() };
        let (key, text) = argument.split_once('=').ok_or_else(no_axis)?;
        let key = key.trim();
        if key.is_empty() {
            return Err(no_axis());
        }
        let mut values = Vec::new();
        for part in split(text).ok_or_else(|| SweepError::Unclosed { argument: argument.to_owned() })? {
            let part = part.trim();
            if part.is_empty() {
                return Err(SweepError::EmptyValue { argument: argument.to_owned() });
            }
            match range(part).map_err(|problem| SweepError::BadRange {
                argument: argument.to_owned(),
                range: part.to_owned(),
                problem,
            })? {
                Some((first, last)) => {
                    let length = u128::from(last.abs_diff(first)) + 1;
                    if length > MOST_RUNS as u128 {
                        return Err(SweepError::TooManyRuns { runs: length });
                    }
                    values.extend((first..=last).map(|number| number.to_string()));
                }
                None => values.push(part.to_owned()),
            }
        }
        Ok(Self { key: key.to_owned(), values })
    }
}

/// Returns every combination of the axes' values, as one override per axis. The first axis varies slowest.
///
/// Without axes there is one combination, which overrides nothing.
///
/// # Errors
/// [`SweepError::RepeatedKey`] if two axes have the same key; [`SweepError::TooManyRuns`] beyond
/// [`MOST_RUNS`].
pub fn combinations(axes: &[Axis]) -> Result<Vec<Vec<String>>, SweepError> {
    for (at, axis) in axes.iter().enumerate() {
        if axes.iter().take(at).any(|other| other.key == axis.key) {
            return Err(SweepError::RepeatedKey { key: axis.key.clone() });
        }
    }
    let runs = axes.iter().fold(1_u128, |runs, axis| runs.saturating_mul(axis.values.len() as u128));
    if runs > MOST_RUNS as u128 {
        return Err(SweepError::TooManyRuns { runs });
    }
    let mut all = vec![Vec::new()];
    for axis in axes {
        let longer = |begun: &Vec<String>| -> Vec<Vec<String>> {
            let with = |value| [&begun[..], &[format!("{}={value}", axis.key)]].concat();
            axis.values.iter().map(with).collect()
        };
        all = all.iter().flat_map(longer).collect();
    }
    Ok(all)
}

/// Splits a text at the commas outside brackets, braces and quotes; `None` if one of these is not closed.
fn split(text: &str) -> Option<Vec<String>> {
    let mut parts = vec![String::new()];
    let mut closing: Vec<char> = Vec::new();
    let mut quote: Option<char> = None;
    let mut is_escaped = false;
    for letter in text.chars() {
        match (quote, letter) {
            (Some(_), _) if is_escaped => is_escaped = false,
            // TOML's single-quoted strings have no escapes.
            (Some('"'), '\\') => is_escaped = true,
            (Some(mark), _) if mark == letter => quote = None,
            (Some(_), _) => (),
            (None, '"' | '\'') => quote = Some(letter),
            (None, '[') => closing.push(']'),
            (None, '{') => closing.push('}'),
            (None, ']' | '}') => {
                if closing.pop() != Some(letter) {
                    return None;
                }
            }
            (None, ',') if closing.is_empty() => {
                parts.push(String::new());
                continue;
            }
            (None, _) => (),
        }
        parts.last_mut()?.push(letter);
    }
    (closing.is_empty() && quote.is_none()).then_some(parts)
}

/// Returns the endpoints of `A..B`; `None` for text that is no range, such as the path `../log.csv`.
fn range(text: &str) -> Result<Option<(i64, i64)>, &'static str> {
    let Some((first, last)) = text.split_once("..") else { return Ok(None) };
    let (first, last) = (first.trim(), last.trim());
    match (first.parse::<i64>(), last.parse::<i64>()) {
        (Ok(first), Ok(last)) if first <= last => Ok(Some((first, last))),
        (Ok(_), Ok(_)) => Err("it ends before it begins"),
        _ if first.parse::<f64>().is_ok() && last.parse::<f64>().is_ok() => {
            Err("a range is of whole numbers; write others out, as in 0.1,0.2,0.5")
        }
        _ => Ok(None),
    }
}

#[cfg(test)]
mod tests {
    use super::{Axis, MOST_RUNS, combinations};

    fn values(argument: &str) -> Vec<String> {
        Axis::parse(argument).unwrap().values
    }

    fn refused(argument: &str) -> String {
        Axis::parse(argument).unwrap_err().to_string()
    }

    #[test]
    fn values_are_split_at_commas_outside_brackets_and_quotes() {
        assert_eq!(values("estimator=pinn,lstm"), ["pinn", "lstm"]);
        assert_eq!(values("estimator.hidden=[64],[32, 32]"), ["[64]", "[32, 32]"]);
        assert_eq!(values("a={x=[1,2],y=3},4"), ["{x=[1,2],y=3}", "4"]);
        assert_eq!(
            values(r#"data.path="a,b.csv",'c\,d.csv',e.csv"#),
            [r#""a,b.csv""#, r"'c\,d.csv'", "e.csv"]
        );
        assert_eq!(values(r#"a="x\"y,z",2"#), [r#""x\"y,z""#, "2"]);
        assert_eq!(values("fit.tolerance_percent=1e-3"), ["1e-3"]);
    }

    #[test]
    fn a_range_holds_both_its_ends() {
        assert_eq!(values("seed=0..3"), ["0", "1", "2", "3"]);
        assert_eq!(values("seed=-1..1,7,9..9"), ["-1", "0", "1", "7", "9"]);
        // Two dots in a path do not make a range.
        assert_eq!(values("data.path=../log.csv,a..b,1.5..b"), ["../log.csv", "a..b", "1.5..b"]);
    }

    #[test]
    fn what_cannot_be_read_is_named() {
        assert_eq!(
            refused("seed"),
            "command line: `seed` is no axis; write KEY=V1,V2 or KEY=A..B, for example seed=0..9"
        );
        assert!(refused("=1").contains("is no axis"));
        assert!(refused("seed=1,,2").contains("a value is empty"));
        assert!(refused("seed=").contains("a value is empty"));
        assert!(refused("a=[1,2").contains("not closed"));
        assert!(refused("a=1],[2").contains("not closed"));
        assert!(refused("a=\"1,2").contains("not closed"));
        assert!(refused("seed=9..0").contains("`9..0`: it ends before it begins"));
        assert!(refused("x=0.1..0.5").contains("write others out"));
        assert!(refused("seed=0..99999999999").contains("100000000000 runs"));
    }

    #[test]
    fn the_first_axis_varies_slowest() {
        let axes = ["a=1,2", "b=x,y"].map(|axis| Axis::parse(axis).unwrap());
        assert_eq!(
            combinations(&axes).unwrap(),
            [["a=1", "b=x"], ["a=1", "b=y"], ["a=2", "b=x"], ["a=2", "b=y"]]
        );
        assert_eq!(combinations(&[]).unwrap(), [[] as [&str; 0]]);
    }

    #[test]
    fn a_sweep_has_an_end() {
        let axes = ["a=0..999", "b=0..999"].map(|axis| Axis::parse(axis).unwrap());
        assert!(combinations(&axes).unwrap_err().to_string().contains("1000000 runs"));
        let most = Axis::parse(&format!("a=1..{MOST_RUNS}")).unwrap();
        assert_eq!(combinations(&[most]).unwrap().len(), MOST_RUNS);
        assert!(refused(&format!("a=0..{MOST_RUNS}")).contains("runs"));
        let axes = ["a=1", "a=2"].map(|axis| Axis::parse(axis).unwrap());
        assert!(combinations(&axes).unwrap_err().to_string().contains("`a` is given twice"));
    }
}
