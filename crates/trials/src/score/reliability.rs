//! Reliability (calibration) of stated probabilities.

use super::isotonic::at;
use super::judgment::Judgment;
use super::statistics::{proportion, quantile};
use crate::hidden::{Asked, Bank};
use rand::RngExt;
use results::{ProbabilityMap, Reliability, ReliabilityBin, VerdictStatus, WithInterval};
use seed::Seed;

/// Number of bins, with equal counts.
const BINS: usize = 10;
/// Number of draws of a bootstrap, and of outcomes by chance.
const DRAWS: usize = 1000;

/// Stated probabilities, each with `true` if the statement came true, grouped by case; the bootstrap draws
/// whole cases.
pub(crate) type Statements = Vec<Vec<(f64, bool)>>;

/// Returns the stated confidence of the answered cases.
pub(crate) fn of_confidence<'a>(judged: impl Iterator<Item = &'a Judgment<'a>>) -> Statements {
    judged
        .filter_map(|judgment| Some(vec![(judgment.answer()?.verdict.confidence, judgment.right)]))
        .collect()
}

/// Returns the stated probabilities of effects and of `unknown`, as listed in answers, without nuisances.
pub(crate) fn of_effects<'a>(judged: impl Iterator<Item = &'a Judgment<'a>>) -> Statements {
    judged
        .filter_map(|judgment| {
            let hidden = &judgment.case.hidden;
            let is_so = |id: &str| match VerdictStatus::of_row(id) {
                Some(VerdictStatus::Unknown) => judgment.asked() == Asked::Unknown,
                _ => hidden.effects.iter().any(|effect| effect.id == id),
            };
            let rows = judgment.answer()?.effects.iter();
            let counted = rows.filter(|row| {
                !hidden.nuisances.contains(&row.id)
                    && matches!(VerdictStatus::of_row(&row.id), None | Some(VerdictStatus::Unknown))
            });
            Some(counted.map(|row| (row.probability, is_so(&row.id))).collect())
        })
        .collect()
}

/// Returns `true` if a bank's records come from the default generator.
pub(crate) fn is_own(bank: Bank) -> bool {
    !matches!(bank, Bank::Stressed | Bank::Measured | Bank::Engine | Bank::Composite | Bank::Rigs)
}

fn sorted(statements: &Statements) -> Vec<(f64, bool)> {
    let mut all: Vec<(f64, bool)> = statements.iter().flatten().copied().collect();
    all.sort_by(|one, other| one.0.total_cmp(&other.0));
    all
}

/// Cuts a sorted list into bins with counts as equal as possible. Equal probabilities may fall into two bins.
fn cut(sorted: &[(f64, bool)]) -> Vec<&[(f64, bool)]> {
    let bins = BINS.min(sorted.len());
    (0..bins)
        .filter_map(|bin| sorted.get(bin * sorted.len() / bins..(bin + 1) * sorted.len() / bins))
        .collect()
}

fn means(bin: &[(f64, bool)]) -> (f64, f64) {
    let count = bin.len() as f64;
    let stated = bin.iter().map(|pair| pair.0).sum::<f64>() / count;
    (stated, bin.iter().filter(|pair| pair.1).count() as f64 / count)
}

/// Returns the expected calibration error: the mean over bins of |stated − found|, weighted by count.
fn calibration_error(sorted: &[(f64, bool)]) -> f64 {
    let count = sorted.len() as f64;
    let part = |bin: &[(f64, bool)]| {
        let (stated, found) = means(bin);
        bin.len() as f64 / count * (stated - found).abs()
    };
    cut(sorted).into_iter().map(part).sum()
}

/// Returns the reliability of stated probabilities; `None` without statements.
///
/// The bootstrap draws cases. Scatter alone causes a calibration error, so the mean error for exactly right
/// probabilities is stated as well.
pub(crate) fn reliability(
    subject: &str,
    banks: &str,
    statements: &Statements,
    seed: &Seed,
) -> Option<Reliability> {
    let all = sorted(statements);
    if all.is_empty() {
        return None;
    }
    let mut generator = seed.child("cases").generator();
    let mut drawn: Vec<f64> = (0..DRAWS)
        .map(|_| {
            let draw = |_| statements.get(generator.random_range(0..statements.len())).cloned();
            calibration_error(&sorted(&(0..statements.len()).filter_map(draw).collect()))
        })
        .collect();
    drawn.sort_by(f64::total_cmp);
    let mut generator = seed.child("outcomes").generator();
    let by_chance: f64 = (0..DRAWS)
        .map(|_| {
            let outcome = |(stated, _): &(f64, bool)| (*stated, generator.random::<f64>() < *stated);
            calibration_error(&all.iter().map(outcome).collect::<Vec<_>>())
        })
        .sum();
    let squares: f64 = all.iter().map(|(stated, so)| (stated - f64::from(u8::from(*so))).powi(2)).sum();
    let bin = |pairs: &[(f64, bool)]| ReliabilityBin {
        range: [pairs.first().map_or(f64::NAN, |p| p.0), pairs.last().map_or(f64::NAN, |p| p.0)],
        stated: means(pairs).0,
        found: proportion(pairs.iter().map(|pair| pair.1)),
    };
    Some(Reliability {
        subject: subject.to_owned(),
        banks: banks.to_owned(),
        count: all.len() as u64,
        calibration_error: WithInterval {
            value: calibration_error(&all),
            interval_95: [quantile(&drawn, 0.025), quantile(&drawn, 0.975)],
        },
        calibration_error_by_chance: by_chance / DRAWS as f64,
        brier: squares / all.len() as f64,
        bins: cut(&all).into_iter().map(bin).collect(),
    })
}

/// Returns the same statements with mapped probabilities.
pub(crate) fn mapped(statements: &Statements, map: &ProbabilityMap) -> Statements {
    let through = |case: &Vec<(f64, bool)>| case.iter().map(|(stated, so)| (at(map, *stated), *so)).collect();
    statements.iter().map(through).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn statements(outcome: impl Fn(f64, f64) -> bool, count: usize) -> Statements {
        let mut generator = Seed::new(8).generator();
        (0..count)
            .map(|_| {
                let stated: f64 = generator.random();
                vec![(stated, outcome(stated, generator.random()))]
            })
            .collect()
    }

    #[test]
    fn exact_probabilities_are_off_by_chance_only() {
        let found = reliability("x", "own", &statements(|p, u| u < p, 2000), &Seed::new(1)).unwrap();
        assert_eq!((found.count, found.bins.len()), (2000, 10));
        assert!(found.bins.iter().all(|bin| bin.found.of == 200));
        let error = found.calibration_error;
        assert!(error.value < 2.0 * found.calibration_error_by_chance, "{error:?}");
        // The mean of p·(1 − p) over uniform p.
        assert!((found.brier - 1.0 / 6.0).abs() < 0.02, "{}", found.brier);
    }

    #[test]
    fn overconfidence_shows() {
        // Stated p, found p²: wrong by p − p² = 1/6 on average.
        let found = reliability("x", "own", &statements(|p, u| u < p * p, 2000), &Seed::new(1)).unwrap();
        let error = found.calibration_error;
        assert!((error.value - 1.0 / 6.0).abs() < 0.03, "{error:?}");
        assert!(error.interval_95[0] < error.value && error.value < error.interval_95[1]);
        assert!(error.interval_95[0] > 3.0 * found.calibration_error_by_chance);
    }

    #[test]
    fn few_statements_make_fewer_bins() {
        let found = reliability("x", "own", &statements(|_, _| true, 3), &Seed::new(1)).unwrap();
        assert_eq!(found.bins.len(), 3);
        assert!(reliability("x", "own", &Vec::new(), &Seed::new(1)).is_none());
    }
}
