//! Several runs in one file, side by side, each with a time column of its own.

use crate::FEWEST_SAMPLES;
use crate::error::Fault;
use crate::heading::Heading;
use crate::roles::{Column, Kind, is_time};

/// Columns of one run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Run {
    /// Name of the run: the words that set its titles apart, else its number.
    pub(crate) label: String,
    /// Its columns.
    pub(crate) columns: Vec<usize>,
}

/// Words that number runs.
const WORDS: &[&str] =
    &["run", "latest", "set", "data", "trial", "test", "series", "measurement", "messung", "no", "nr"];

/// Finds the runs of a table: the time columns that have the same name, apart from the number of the run,
/// each with the columns of the same number, else with those up to the next time column. Empty if there is
/// one time column at most.
pub(crate) fn runs(columns: &[Column]) -> Vec<Run> {
    let numbers = |column: &Column| column.kind == Kind::Numbers;
    let times: Vec<usize> = (0..columns.len())
        .filter(|at| columns.get(*at).is_some_and(|column| numbers(column) && is_time(&column.heading)))
        .collect();
    let heading = |at: usize| columns.get(at).map(|column| &column.heading);
    let plain = |at: usize| heading(at).map(|heading| (name(heading), heading.time_unit()));
    let Some(first) = times.first().copied() else { return Vec::new() };
    let times: Vec<usize> = times.into_iter().filter(|at| plain(*at) == plain(first)).collect();
    if times.len() < 2 {
        return Vec::new();
    }
    let labels: Vec<String> = times.iter().filter_map(|at| heading(*at)).map(label).collect();
    let of_label = |label: &String| -> Vec<usize> {
        let same = |at: &usize| heading(*at).is_some_and(|heading| self::label(heading) == *label);
        (0..columns.len()).filter(same).collect()
    };
    let labeled = labels.iter().enumerate().all(|(at, label)| {
        !label.is_empty() && !labels.iter().take(at).any(|other| other == label) && of_label(label).len() > 1
    });
    let ends = times.iter().skip(1).copied().chain([columns.len()]);
    let runs = times.iter().zip(ends).zip(labels).enumerate();
    runs.map(|(at, ((from, to), label))| {
        let columns = if labeled { of_label(&label) } else { (*from..to).collect() };
        let label = if labeled { label } else { (at + 1).to_string() };
        Run { label, columns }
    })
    .collect()
}

/// Lines of one of several runs that follow each other in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Part {
    /// Number of the run, from 1.
    pub(crate) run: usize,
    /// Its lines, by their index.
    pub(crate) lines: std::ops::Range<usize>,
}

/// Part of the first run's duration from its start in which each further run has to start.
const NEAR_THE_START: f64 = 0.1;

/// Finds the runs of a file that follow each other: the stamps fall back to about the first one, and each
/// time at least [`FEWEST_SAMPLES`] lines follow. Returns the run with the number that is asked for, else the
/// first, with a sentence; `None` for one run.
///
/// # Errors
/// [`Fault::NoSuchRun`].
pub(crate) fn one_after_another(
    stamps: &[f64],
    asked: Option<usize>,
) -> Result<Option<(Part, String)>, Fault> {
    let falls = stamps.iter().zip(stamps.iter().skip(1)).enumerate().filter(|(_, (one, next))| next < one);
    let starts: Vec<usize> = std::iter::once(0).chain(falls.map(|(at, _)| at + 1)).collect();
    let ends = starts.iter().skip(1).copied().chain([stamps.len()]);
    let runs: Vec<std::ops::Range<usize>> = starts.iter().zip(ends).map(|(from, to)| *from..to).collect();
    let stamp = |at: usize| stamps.get(at).copied();
    let first = runs.first().and_then(|run| Some((stamp(run.start)?, stamp(run.end - 1)?)));
    let Some((from, to)) = first else { return Ok(None) };
    let restarts = |run: &std::ops::Range<usize>| {
        stamp(run.start).is_some_and(|start| start <= from + NEAR_THE_START * (to - from))
    };
    let are_runs = runs.len() > 1 && runs.iter().all(|run| run.len() >= FEWEST_SAMPLES && restarts(run));
    let count = if are_runs { runs.len() } else { 1 };
    let run = asked.unwrap_or(1);
    let part = run.checked_sub(1).and_then(|at| runs.get(at)).filter(|_| run <= count).cloned();
    let lines = part.ok_or(Fault::NoSuchRun { asked: run, count })?;
    let finding = match asked {
        Some(_) => format!("run {run} of {count} was taken; the time starts again where the next one begins"),
        None => format!(
            "the time starts again {}: the file holds {count} runs; run 1 was taken, another with `data.run`",
            if count == 2 { "once".to_owned() } else { format!("{} times", count - 1) }
        ),
    };
    Ok(are_runs.then_some((Part { run, lines }, finding)))
}

/// Returns the words of a title that do not number a run.
fn name(heading: &Heading) -> Vec<&str> {
    heading.words.iter().map(String::as_str).filter(|word| !WORDS.contains(word)).collect()
}

/// Returns the part of a title that tells the run: its words for runs and its last number, unless that belongs
/// to a unit in brackets.
fn label(heading: &Heading) -> String {
    let outside: String = heading
        .title
        .split(['(', '['])
        .enumerate()
        .map(
            |(at, part)| {
                if at == 0 { part } else { part.split_once([')', ']']).map_or("", |(_, rest)| rest) }
            },
        )
        .collect::<Vec<_>>()
        .join(" ");
    if heading.has("latest") {
        return "latest".to_owned();
    }
    let digits = outside.split(|sign: char| !sign.is_ascii_digit()).rfind(|part| !part.is_empty());
    digits.unwrap_or("").to_owned()
}

#[cfg(test)]
mod tests {
    use super::runs;
    use crate::heading::Heading;
    use crate::roles::{Column, Kind};

    fn of(titles: &[&str]) -> Vec<(String, Vec<usize>)> {
        let column = |title: &&str| Column { heading: Heading::parse(title, None), kind: Kind::Numbers };
        let columns: Vec<Column> = titles.iter().map(column).collect();
        runs(&columns).into_iter().map(|run| (run.label, run.columns)).collect()
    }

    #[test]
    fn runs_stand_side_by_side() {
        let two = |one: &str, other: &str| vec![(one.to_owned(), vec![0, 1]), (other.to_owned(), vec![2, 3])];
        for (titles, found) in [
            (
                ["Time (s) Run #1", "Position (m) Run #1", "Time (s) Run #2", "Position (m) Run #2"],
                two("1", "2"),
            ),
            (
                ["Run 1: Time (s)", "Run 1: Position (m)", "Latest: Time (s)", "Latest: Position (m)"],
                two("1", "latest"),
            ),
            (["t1", "x1", "t2", "x2"], two("1", "2")),
            (["Time (s)", "Position (m)", "Time (s)", "Position (m)"], two("1", "2")),
        ] {
            assert_eq!(of(&titles), found, "{titles:?}");
        }
        let apart = of(&["t1", "t2", "x1", "x2"]);
        assert_eq!(apart, [("1".to_owned(), vec![0, 2]), ("2".to_owned(), vec![1, 3])]);
        assert!(of(&["time", "x"]).is_empty() && of(&["time", "timestamp", "x"]).is_empty());
        assert!(of(&["header.stamp.secs", "header.stamp.nsecs", "x"]).is_empty() && of(&["x"]).is_empty());
    }
}
