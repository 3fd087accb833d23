//! Path of laws from the richest to the constant.

use crate::law::{Column, Law};
use crate::progress::Halt;
use crate::scaled::Scaled;

/// Laws along a rising threshold.
#[derive(Debug, Clone, PartialEq)]
pub struct Path {
    /// Laws that settled, from the richest to the constant.
    pub laws: Vec<Law>,
    /// Law of the last regression.
    pub latest: Law,
    /// Number of laws that did not settle.
    pub unsettled: usize,
    /// Reason why the path was cut short; `None` if it reached the constant.
    pub halt: Option<Halt>,
}

impl Path {
    /// Raises the threshold until only the constant is left.
    ///
    /// `settle` regresses on the remaining columns and updates the law that is its second argument. It
    /// returns `true` if the law settled, and an error if the fit has to stop.
    pub fn over(
        mut columns: Vec<Column>,
        scaled: &Scaled,
        mut settle: impl FnMut(&[Column], &mut Law) -> Result<bool, Halt>,
    ) -> Self {
        let mut path = Self { laws: Vec::new(), latest: Law::null(scaled), unsettled: 0, halt: None };
        loop {
            match settle(&columns, &mut path.latest) {
                Ok(true) => path.laws.push(path.latest.clone()),
                Ok(false) => path.unsettled += 1,
                Err(halt) => {
                    path.halt = Some(halt);
                    return path;
                }
            }
            // The threshold rises just above the smallest coefficient, so that one term is dropped.
            let smallest = path
                .latest
                .terms
                .iter()
                .min_by(|(_, one), (_, other)| one.abs().total_cmp(&other.abs()))
                .map(|(column, _)| column.term)
                .or_else(|| columns.last().map(|column| column.term));
            let Some(smallest) = smallest else {
                return path;
            };
            columns.retain(|column| column.term != smallest);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::term::Term;
    use envelope::Envelope;

    fn scaled() -> Scaled {
        let times: Vec<f64> = (0..9).map(f64::from).collect();
        let logs = times.iter().map(|t| -0.1 * t).collect();
        Scaled::of(&Envelope::new(times, logs, 6.0).unwrap()).unwrap()
    }

    fn columns(scaled: &Scaled) -> Vec<Column> {
        let terms = [Term::InverseAmplitude, Term::Amplitude, Term::Time];
        terms.into_iter().filter_map(|term| Column::over(term, scaled)).collect()
    }

    fn law(columns: &[Column], scaled: &Scaled) -> Law {
        let coefficient = |term: Term| match term {
            Term::InverseAmplitude => -0.5,
            Term::Amplitude => 0.1,
            _ => 2.0,
        };
        let terms = columns.iter().map(|column| (*column, coefficient(column.term))).collect();
        Law::new(-1.0, terms, scaled.logs.clone(), scaled)
    }

    #[test]
    fn the_smallest_coefficient_falls_first() {
        let scaled = scaled();
        let path = Path::over(columns(&scaled), &scaled, |columns, latest| {
            *latest = law(columns, &scaled);
            Ok(columns.len() != 2)
        });
        let left: Vec<Vec<Term>> =
            path.laws.iter().map(|law| law.terms.iter().map(|(column, _)| column.term).collect()).collect();
        let all = vec![Term::InverseAmplitude, Term::Amplitude, Term::Time];
        assert_eq!(left, [all, vec![Term::Time], vec![]]);
        assert_eq!((path.unsettled, path.halt), (1, None));
    }

    #[test]
    fn a_halt_ends_the_path() {
        let scaled = scaled();
        let path = Path::over(columns(&scaled), &scaled, |columns, latest| {
            if columns.len() < 3 {
                return Err(Halt::Spent);
            }
            *latest = law(columns, &scaled);
            Ok(true)
        });
        assert_eq!((path.laws.len(), path.unsettled, path.halt), (1, 0, Some(Halt::Spent)));
        assert_eq!(path.latest, path.laws[0]);
    }
}
