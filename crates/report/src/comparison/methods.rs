//! A row for each method: the paper's Tables 4 and 5.

use results::{Ablation, AblationRow, ComparisonResult, Family, MethodOutcome, MethodRow};

use crate::format::{count, duration, fixed, significant};
use crate::tables::whole;

/// Explanation of these tables.
pub(super) const READING: &str = "The error is |ζ − ζ₀|/ζ₀, where ζ₀ is that of certified least squares; the \
     worst is the largest over a method’s seeds. Digits are the significant digits in which the worst seed \
     agrees with ζ₀; a double has 15.7. ± is the method’s own standard error of ζ, where it states one. ζ, \
     steps and state are the first seed’s, the time of a fit is the median over the seeds. A method passes \
     where every seed is within the stated tolerance, or where it estimates something else; a weak baseline \
     with a fixed number of steps that did not suffice does not count. “May differ” \
     states whether the method’s value can differ from least squares at all. “At zero” and “on noise” are \
     the first seed’s errors in percent with the learned part set to zero and with noise in place of its \
     input: if such an error stays small, the learned part, or its input, contributed nothing to λ. Columns \
     that tell nothing are left out: the worst error where each method has one seed, “may differ” where none may.";

/// Explanation of the two columns of ablations, for the terminal.
pub const ABLATION_READING: &str = "if such an error stays small, the learned part, or its input, \
     contributed nothing to the decay rate";

/// The error of a fit without a part, in percent; – where there is no such part.
#[must_use]
pub fn ablation_cell(ablations: &[AblationRow], part: Ablation) -> String {
    match ablations.iter().find(|row| row.ablation == part) {
        None => NONE.to_owned(),
        Some(row) => row.error_percent.map_or_else(|| "no estimate".to_owned(), error),
    }
}

/// Titles of the columns of numbers. Beside them, a table has the method's number and its name on the left, its
/// state and its verdict on the right. A method without an estimate has its reason in place of all numbers.
const NUMBERS: [&str; 12] = [
    "ζ",
    "error, %",
    "worst, %",
    "digits",
    "± of ζ",
    "seeds",
    "steps",
    "parameters",
    "time",
    "may differ",
    "at zero, %",
    "on noise, %",
];

/// Placeholder for a number that a method does not have.
const NONE: &str = "–";

/// The methods of one family.
pub(super) struct MethodTable {
    /// Name of its anchor in the page.
    pub(super) id: &'static str,
    pub(super) title: &'static str,
    /// Titles of all columns, those of [`NUMBERS`] only where they tell something about these methods.
    pub(super) columns: Vec<&'static str>,
    pub(super) rows: Vec<MethodView>,
}

/// One method as it stands in its table.
pub(super) struct MethodView {
    pub(super) number: String,
    pub(super) title: String,
    /// The cells between name and verdict that hold numbers; none where there is no estimate.
    pub(super) numbers: Vec<String>,
    /// The state, or why there is no estimate.
    pub(super) state: String,
    /// Reason that the first seed's fit stopped; empty if there is no estimate.
    pub(super) because: String,
    pub(super) passes: bool,
    /// `true` if a miss does not count.
    pub(super) excused: bool,
}

impl MethodView {
    /// The last cell.
    pub(super) fn verdict(&self) -> &'static str {
        match (self.passes, self.excused) {
            (true, _) => "pass",
            (false, true) => "does not count",
            (false, false) => "FAIL",
        }
    }

    /// Class of the last cell in the style sheet.
    pub(super) fn tone(&self) -> &'static str {
        match (self.passes, self.excused) {
            (true, _) => "good",
            (false, true) => "caution",
            (false, false) => "bad",
        }
    }
}

/// The tables that have rows, in the paper's order.
pub(super) fn tables(result: &ComparisonResult) -> Vec<MethodTable> {
    let table = |id, title, family| {
        let rows = result.results.iter().chain(&result.libraries).filter(|row| row.family == family);
        let mut rows: Vec<MethodView> = rows.map(view).collect();
        let numbers = leave_out(&mut rows);
        let columns = ["#", "method"].into_iter().chain(numbers).chain(["state", ""]).collect();
        MethodTable { id, title, columns, rows }
    };
    [
        table("classical", "Table 4: classical numerical methods", Family::Classical),
        table("learned", "Table 5: learned methods", Family::Learned),
        table("further", "Further methods", Family::Library),
    ]
    .into_iter()
    .filter(|table| !table.rows.is_empty())
    .collect()
}

/// Leaves out the numbers that tell nothing about any of these methods, so that their table fits the page, and
/// returns the titles of the others.
fn leave_out(rows: &mut [MethodView]) -> Vec<&'static str> {
    let tells = |at: usize, nothing: &str| {
        rows.iter().filter_map(|row| row.numbers.get(at)).any(|cell| cell != nothing)
    };
    let has_seeds = NUMBERS.iter().position(|title| *title == "seeds").is_none_or(|at| tells(at, "1"));
    let is_told: Vec<bool> = NUMBERS
        .iter()
        .enumerate()
        .map(|(at, title)| match *title {
            "seeds" | "worst, %" => has_seeds,
            "may differ" => tells(at, "no"),
            _ => tells(at, NONE),
        })
        .collect();
    for row in rows {
        let mut told = is_told.iter();
        row.numbers.retain(|_| told.next() == Some(&true));
    }
    NUMBERS.into_iter().zip(is_told).filter_map(|(title, told)| told.then_some(title)).collect()
}

fn view(row: &MethodRow) -> MethodView {
    let number = row.number.map_or_else(|| NONE.to_owned(), |number| number.to_string());
    let title = row.title.clone();
    match &row.outcome {
        MethodOutcome::Estimate(estimate) => MethodView {
            number,
            title,
            numbers: vec![
                significant(estimate.zeta, 8),
                error(estimate.error_percent),
                error(estimate.worst_error_percent),
                fixed(estimate.digits_of_agreement, 1),
                estimate.zeta_std_error.map_or_else(|| NONE.to_owned(), |error| significant(error, 2)),
                count(estimate.seeds),
                count(estimate.steps),
                whole(estimate.parameters),
                duration(estimate.seconds),
                row.estimand.may_differ().to_owned(),
                ablation_cell(&estimate.ablations, Ablation::LearnedPartAtZero),
                ablation_cell(&estimate.ablations, Ablation::NoiseForInput),
            ],
            state: estimate.reached.in_words().to_owned(),
            because: estimate.stopped_because.clone(),
            passes: estimate.pass,
            excused: row.excused,
        },
        MethodOutcome::Failed { reason } => MethodView {
            number,
            title,
            numbers: Vec::new(),
            state: format!("no estimate: {reason}"),
            because: String::new(),
            passes: false,
            excused: false,
        },
    }
}

/// An error in percent, without the sign; an exact zero is one.
fn error(percent: f64) -> String {
    if percent == 0.0 { "0".to_owned() } else { significant(percent, 2) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::comparison::sample;

    #[test]
    fn every_method_has_one_row_in_one_table() {
        let mut result = sample::result();
        let sizes = |result: &ComparisonResult| -> Vec<_> {
            tables(result).iter().map(|table| (table.id, table.rows.len())).collect()
        };
        assert_eq!(sizes(&result), [("classical", 11), ("learned", 10)]);
        result.results[20].family = Family::Library;
        assert_eq!(sizes(&result), [("classical", 11), ("learned", 9), ("further", 1)]);
        result.results.truncate(3);
        assert_eq!(sizes(&result), [("classical", 3)]);
    }

    #[test]
    fn a_failed_method_gives_its_reason_and_fails() {
        let tables = tables(&sample::result());
        let row = tables[1].rows.iter().find(|row| row.number == "16").unwrap();
        assert!(row.state.starts_with("no estimate: the budget"), "{}", row.state);
        assert_eq!(row.verdict(), "FAIL");
        assert!(row.numbers.is_empty());
    }

    #[test]
    fn the_numbers_of_a_row_fill_its_columns() {
        for table in tables(&sample::result()) {
            for row in &table.rows {
                // Beside number, name, state and verdict.
                assert!(row.numbers.is_empty() || row.numbers.len() == table.columns.len() - 4);
            }
        }
    }

    #[test]
    fn columns_that_tell_nothing_are_left_out() {
        let mut result = sample::result();
        for row in &mut result.results {
            if let MethodOutcome::Estimate(estimate) = &mut row.outcome {
                (estimate.seeds, estimate.ablations) = (1, Vec::new());
            }
        }
        let columns = tables(&result)[1].columns.clone();
        assert!(columns.contains(&"error, %") && columns.contains(&"steps"), "{columns:?}");
        for title in ["seeds", "worst, %", "at zero, %", "on noise, %", "may differ"] {
            assert!(!columns.contains(&title), "{title}");
        }
    }
}
