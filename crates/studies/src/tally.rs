//! Scores computed from trials.

use crate::problem::Ready;
use crate::trial::{Trial, held_out};
use results::{
    Coverage, Failure, HeldOutScore, MethodScores, PairedComparison, PredictionOutcome, SplitKind,
};
use scoring::HeldOutPeak;
use std::collections::BTreeMap;

/// Trial with its draw and split.
#[derive(Debug)]
pub struct Placed {
    /// Index of the draw.
    pub draw: usize,
    /// Index of the split.
    pub split: usize,
    /// Trial, or the reason why it has no outcome.
    pub trial: Result<Trial, Failure>,
}

/// Relative difference from the exponential's squared error up to which two squared errors count as equal:
/// the method then draws the same line.
const EQUAL: f64 = 1e-6;

/// Held-out peaks of one kind of split by unit: a draw of a simulation, a block of a record.
struct Units {
    /// Held-out peaks by draw (simulation) or by block (record).
    peaks: BTreeMap<usize, Vec<HeldOutPeak>>,
    /// Number of held-out peaks that have no prediction because a fit failed, by unit.
    lost: BTreeMap<usize, usize>,
    is_record: bool,
}

/// Computes the scores of a method from its trials; `exponential` holds the trials of the best exponential on
/// the same draws.
///
/// `common` is the number of draws on which every method was fitted. The p-values are not adjusted yet:
/// [`adjust`] does that once all methods of a problem are known.
pub(crate) fn outcome(
    problem: &Ready,
    trials: &[Placed],
    exponential: &[Placed],
    common: usize,
) -> PredictionOutcome {
    let fitted = || trials.iter().filter_map(|placed| placed.trial.as_ref().ok());
    // Scores from only some of its fits would otherwise stand beside scores from all fits.
    if trials.iter().any(|placed| matches!(placed.trial, Err(Failure::NotBegun))) {
        return PredictionOutcome::Failed { reason: Failure::NotBegun };
    }
    let first_failure = trials.iter().find_map(|placed| placed.trial.as_ref().err().cloned());
    if fitted().next().is_none() {
        return PredictionOutcome::Failed {
            reason: first_failure.unwrap_or_else(|| "nothing was fitted".into()),
        };
    }
    let of = |kind| score(problem, trials, kind, common, Some(exponential));
    let (equation, commonest_form) = laws(problem, trials);
    PredictionOutcome::Scored(Box::new(MethodScores {
        draws: trials.iter().map(|placed| placed.draw + 1).fold(0, usize::max),
        failed_fits: trials.iter().filter(|placed| placed.trial.is_err()).count(),
        first_failure,
        fits: trials.len(),
        converged: fitted().filter(|trial| trial.converged).count(),
        interpolation: of(SplitKind::Interpolation),
        extrapolation: of(SplitKind::Extrapolation),
        covers_projected_slope: problem
            .truth
            .as_ref()
            .and_then(|truth| covers(problem, trials, |split| truth.projected_slopes.get(split).copied())),
        covers_viscous_rate: problem
            .truth
            .as_ref()
            .and_then(|truth| covers(problem, trials, |_| Some(truth.law.viscous_rate))),
        equation,
        commonest_form,
        seconds: scoring::median(fitted().map(|trial| trial.seconds)),
    }))
}

/// Computes the scores on held-out peaks of one kind of split; `None` if the method makes no prediction.
/// Errors and densities are those of the first `common` draws, so that they can be compared with those of
/// methods with fewer draws.
pub(crate) fn score(
    problem: &Ready,
    trials: &[Placed],
    kind: SplitKind,
    common: usize,
    exponential: Option<&[Placed]>,
) -> Option<HeldOutScore> {
    let units = units(problem, trials, kind, usize::MAX)?;
    let shared = self::units(problem, trials, kind, common)?;
    let rms = shared.errors(scoring::rms_log_error);
    Some(HeldOutScore {
        peaks: units.all().len() + units.lost_peaks(),
        not_finite: units.lost_peaks()
            + units.all().iter().filter(|peak| !peak.predicted.is_finite()).count(),
        rms_log_error: scoring::median(rms.iter().copied()),
        worst_rms_log_error: scoring::worst(rms.iter().copied()),
        amplitude_error_percent: scoring::median(shared.errors(scoring::relative_amplitude_error_percent)),
        truth_rms_log_error: truth_error(problem, trials, kind, common),
        mean_log_density: scoring::mean_log_density(&shared.all())
            .map(|mean| if shared.lost_peaks() > 0 { f64::NEG_INFINITY } else { mean }),
        coverage: units.coverage(),
        against_exponential: exponential
            .filter(|_| !(problem.truth.is_none() && kind == SplitKind::Extrapolation))
            .and_then(|reference| Some(compare(&units, &self::units(problem, reference, kind, usize::MAX)?))),
    })
}

/// Collects the held-out peaks of the first `draws` draws.
fn units(problem: &Ready, trials: &[Placed], kind: SplitKind, draws: usize) -> Option<Units> {
    let is_record = problem.truth.is_none();
    let mut units = Units { peaks: BTreeMap::new(), lost: BTreeMap::new(), is_record };
    for placed in trials.iter().filter(|placed| placed.draw < draws) {
        let Some(split) = problem.splits.get(placed.split).filter(|split| split.kind == kind) else {
            continue;
        };
        let envelope = problem.envelopes.get(placed.draw)?;
        match &placed.trial {
            Ok(trial) => {
                for (block, peak) in held_out(trial, envelope.log_amplitudes(), split)? {
                    let unit = if is_record { block } else { placed.draw };
                    units.peaks.entry(unit).or_default().push(peak);
                }
            }
            Err(_) => {
                for block in split.held_out.iter().flatten() {
                    let unit = if is_record { *block } else { placed.draw };
                    *units.lost.entry(unit).or_default() += 1;
                }
            }
        }
    }
    (!units.peaks.is_empty() || !units.lost.is_empty()).then_some(units)
}

impl Units {
    fn all(&self) -> Vec<HeldOutPeak> {
        self.peaks.values().flatten().copied().collect()
    }

    fn lost_peaks(&self) -> usize {
        self.lost.values().sum()
    }

    /// Returns the error of each draw; for a record, the single error over all its peaks. Infinite if a fit
    /// failed.
    fn errors(&self, error: fn(&[HeldOutPeak]) -> f64) -> Vec<f64> {
        if self.is_record {
            return vec![if self.lost.is_empty() { error(&self.all()) } else { f64::INFINITY }];
        }
        let lost = self.lost.keys().map(|_| f64::INFINITY);
        self.peaks.values().map(|peaks| error(peaks)).chain(lost).collect()
    }

    /// Counts the stated predictive intervals that contain their peak. Peaks of failed fits count as not
    /// contained.
    fn coverage(&self) -> Option<Coverage> {
        let stated: Option<Vec<(usize, usize)>> =
            self.peaks.values().map(|peaks| scoring::held_within_95(peaks)).collect();
        let clusters: Vec<(usize, usize)> =
            stated?.into_iter().chain(self.lost.values().map(|&lost| (0, lost))).collect();
        Some(Coverage {
            held: clusters.iter().map(|(held, _)| held).sum(),
            of: clusters.iter().map(|(_, of)| of).sum(),
            interval_95: scoring::clustered_interval(&clusters),
        })
    }

    /// Returns the mean square error of a unit; infinite if a fit failed.
    fn mean_square(&self, unit: usize) -> Option<f64> {
        if self.lost.contains_key(&unit) {
            return Some(f64::INFINITY);
        }
        self.peaks.get(&unit).map(|peaks| scoring::rms_log_error(peaks).powi(2))
    }
}

fn compare(method: &Units, exponential: &Units) -> PairedComparison {
    let (mut better, mut worse, mut equal) = (0, 0, 0);
    let own: std::collections::BTreeSet<usize> =
        method.peaks.keys().chain(method.lost.keys()).copied().collect();
    for unit in own {
        let (Some(error), Some(reference)) = (method.mean_square(unit), exponential.mean_square(unit)) else {
            continue;
        };
        // Two infinite errors are equal although their difference is undefined; a share of an infinite error
        // is no difference either.
        let is_equal = error.total_cmp(&reference).is_eq()
            || reference.is_finite() && (error - reference).abs() <= EQUAL * reference;
        if is_equal {
            equal += 1;
        } else if error < reference {
            better += 1;
        } else {
            worse += 1;
        }
    }
    let p_value = scoring::sign_test(better, worse);
    PairedComparison { better, worse, equal, p_value, adjusted_p_value: p_value }
}

/// Adjusts the p-values of a problem's comparisons for their number, and returns that number. A method that
/// differs from the exponential in no unit does not count as a comparison.
pub(crate) fn adjust(comparisons: Vec<&mut PairedComparison>) -> usize {
    let mut open: Vec<&mut PairedComparison> =
        comparisons.into_iter().filter(|pair| pair.better + pair.worse > 0).collect();
    let p_values: Vec<f64> = open.iter().map(|pair| pair.p_value).collect();
    for (pair, adjusted) in open.iter_mut().zip(scoring::holm(&p_values)) {
        pair.adjusted_p_value = adjusted;
    }
    open.len()
}

/// Computes the median error against the noise-free ln A over the first `common` draws, including infinite
/// errors.
fn truth_error(problem: &Ready, trials: &[Placed], kind: SplitKind, common: usize) -> Option<f64> {
    let truth = problem.truth.as_ref()?;
    let errors: Option<Vec<f64>> = trials
        .iter()
        .filter(|placed| placed.draw < common)
        .filter_map(|placed| Some((placed, problem.splits.get(placed.split)?)))
        .filter(|(_, split)| split.kind == kind)
        .map(|(placed, split)| match &placed.trial {
            Ok(trial) => {
                let peaks = held_out(trial, &truth.log_amplitudes, split)?;
                Some(scoring::rms_log_error(&peaks.into_iter().map(|(_, peak)| peak).collect::<Vec<_>>()))
            }
            Err(_) => Some(f64::INFINITY),
        })
        .collect();
    errors.map(scoring::median)
}

/// Computes the share of interpolation fits whose stated interval of λ contains a rate; `None` if no fit
/// states an interval.
fn covers(problem: &Ready, trials: &[Placed], rate: impl Fn(usize) -> Option<f64>) -> Option<Coverage> {
    let (mut held, mut stated, mut of) = (0, 0, 0);
    for placed in interpolations(problem, trials) {
        of += 1;
        let interval = placed.trial.as_ref().ok().and_then(|trial| trial.rate_interval);
        if let (Some([low, high]), Some(rate)) = (interval, rate(placed.split)) {
            stated += 1;
            held += usize::from((low..=high).contains(&rate));
        }
    }
    (stated > 0).then(|| Coverage {
        held,
        of,
        interval_95: Some(scoring::binomial_interval(held as f64, of as f64)),
    })
}

fn interpolations<'a>(problem: &'a Ready, trials: &'a [Placed]) -> impl Iterator<Item = &'a Placed> {
    trials.iter().filter(|placed| {
        problem.splits.get(placed.split).is_some_and(|split| split.kind == SplitKind::Interpolation)
    })
}

/// Returns the first law that the interpolation fits discovered, and the most common form with its count.
fn laws(problem: &Ready, trials: &[Placed]) -> (Option<String>, Option<(String, usize)>) {
    let laws: Vec<&String> = interpolations(problem, trials)
        .filter_map(|placed| placed.trial.as_ref().ok()?.equation.as_ref())
        .collect();
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for law in &laws {
        *counts.entry(form(law)).or_default() += 1;
    }
    // Of equally common forms, the first by name is taken: `max_by_key` alone would return the last.
    let commonest = counts.into_iter().rev().max_by_key(|(_, count)| *count);
    (laws.first().map(|law| (*law).clone()), commonest)
}

/// Returns a law with every number replaced by `c`, except exponents of powers: `d ln A/dt = -c - c/A^2`.
pub(crate) fn form(law: &str) -> String {
    let letters: Vec<char> = law.chars().collect();
    let at = |index: usize| letters.get(index).copied().unwrap_or(' ');
    let mut text = String::new();
    let mut index = 0;
    while index < letters.len() {
        let before = if index == 0 { ' ' } else { at(index - 1) };
        // A digit that is part of a name, or the exponent of a power, is not a coefficient.
        let starts = at(index).is_ascii_digit() && before != '^' && !before.is_alphanumeric();
        if !starts {
            text.push(at(index));
            index += 1;
            continue;
        }
        while at(index).is_ascii_digit() || at(index) == '.' {
            index += 1;
        }
        let sign = usize::from(matches!(at(index + 1), '-' | '+'));
        if matches!(at(index), 'e' | 'E') && at(index + 1 + sign).is_ascii_digit() {
            index += 1 + sign;
            while at(index).is_ascii_digit() {
                index += 1;
            }
        }
        text.push('c');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::{Units, adjust, compare, form};
    use results::PairedComparison;
    use scoring::HeldOutPeak;
    use std::collections::BTreeMap;

    #[test]
    fn the_form_of_a_law_is_its_text_without_its_numbers() {
        assert_eq!(form("d ln A/dt = -0.150000 - 1.23400e-5/A"), "d ln A/dt = -c - c/A");
        assert_eq!(form("d ln A/dt = 2 A^2 + 0.5 (ln A - 1.5)^2"), "d ln A/dt = c A^2 + c (ln A - c)^2");
        assert_eq!(form("ln A = 0.3 - 2E+07*t1"), "ln A = c - c*t1");
        assert_eq!(form(""), "");
    }

    /// Draw by draw: both failed; the method failed; the exponential failed; both came to rest too early;
    /// both have the same error; the method has the smaller error.
    #[test]
    fn what_fails_where_the_exponential_fails_is_no_worse() {
        let units = |predictions: [Option<f64>; 6]| {
            let mut units = Units { peaks: BTreeMap::new(), lost: BTreeMap::new(), is_record: false };
            for (draw, predicted) in predictions.into_iter().enumerate() {
                match predicted {
                    Some(predicted) => {
                        let peak = HeldOutPeak { observed: 0.0, predicted, std_error: None };
                        units.peaks.insert(draw, vec![peak]);
                    }
                    None => drop(units.lost.insert(draw, 1)),
                }
            }
            units
        };
        let rest = Some(f64::NEG_INFINITY);
        let method = units([None, None, Some(0.1), rest, Some(0.1), Some(0.1)]);
        let exponential = units([None, Some(0.1), None, rest, Some(0.1), Some(0.2)]);
        let found = compare(&method, &exponential);
        assert_eq!((found.better, found.worse, found.equal), (2, 1, 3));
    }

    #[test]
    fn ties_are_no_comparisons() {
        let pair = |better, worse| PairedComparison {
            better,
            worse,
            equal: 3,
            p_value: scoring::sign_test(better, worse),
            adjusted_p_value: f64::NAN,
        };
        let mut pairs = [pair(10, 0), pair(0, 0), pair(5, 5)];
        assert_eq!(adjust(pairs.iter_mut().collect()), 2);
        assert!((pairs[0].adjusted_p_value - 2.0 * pairs[0].p_value).abs() < 1e-15);
        assert!((pairs[2].adjusted_p_value - 1.0).abs() < 1e-15);
    }
}
