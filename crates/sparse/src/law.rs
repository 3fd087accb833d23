//! Fitted law of the envelope's dynamics.

#![allow(clippy::indexing_slicing, reason = "an envelope has at least three peaks")]

use crate::scaled::Scaled;
use crate::term::Term;

/// Term standardized to mean 0 and standard deviation 1 over the peaks, so that one threshold fits the
/// coefficients of different terms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Column {
    /// Term that is standardized.
    pub term: Term,
    mean: f64,
    deviation: f64,
}

impl Column {
    /// Standardizes a term over the peaks of an envelope: mean 0 and standard deviation 1 (with divisor n).
    ///
    /// `None` if the term overflows, or if it varies by less than 1e-13 of its mean, which is rounding.
    pub fn over(term: Term, scaled: &Scaled) -> Option<Self> {
        let values = || scaled.logs.iter().zip(&scaled.times).map(|(&log, &time)| term.value(log, time));
        let count = scaled.peaks() as f64;
        let mean = values().sum::<f64>() / count;
        let deviation = (values().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt();
        let usable = deviation.is_finite() && deviation > 1e-13 * mean.abs();
        usable.then_some(Self { term, mean, deviation })
    }

    /// Returns the standardized value, dimensionless, at x = `log` (ln A − mean) and s = `time` (0 at the
    /// first peak, 1 at the last).
    pub fn value(&self, log: f64, time: f64) -> f64 {
        (self.term.value(log, time) - self.mean) / self.deviation
    }

    /// Returns the derivative of the standardized value with respect to x, at x = `log`.
    pub fn derivative_by_log(&self, log: f64) -> f64 {
        self.term.gradient(log).0 / self.deviation
    }

    /// Returns the total derivative of the standardized value with respect to s, at x = `log` along a
    /// function of slope dx/ds.
    pub fn derivative(&self, log: f64, slope: f64) -> f64 {
        let (by_log, by_time) = self.term.gradient(log);
        (by_log * slope + by_time) / self.deviation
    }
}

/// Fitted law of the envelope, dx/ds = constant + Σ coefficient · column, with its trajectory.
///
/// It is in the scaled coordinates of [`Scaled`]: s is dimensionless, x is in natural logarithms of the
/// amplitude. [`Self::coefficients`] gives the same law in seconds and in the record's unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Law {
    /// Constant part of dx/ds.
    pub constant: f64,
    /// Columns with their coefficients.
    pub terms: Vec<(Column, f64)>,
    /// x at the peaks, one entry per peak; empty for a law that is used for its rates only.
    pub trajectory: Vec<f64>,
    /// Sum of the squared differences between the peaks and the trajectory, in squared natural logarithms.
    pub squares: f64,
}

impl Law {
    /// Creates the law of no decay, dx/ds = 0, with a trajectory of zeros.
    pub fn null(scaled: &Scaled) -> Self {
        Self::new(0.0, Vec::new(), vec![0.0; scaled.peaks()], scaled)
    }

    /// Creates a law from its trajectory, x at each peak, and computes the sum of squares.
    pub fn new(constant: f64, terms: Vec<(Column, f64)>, trajectory: Vec<f64>, scaled: &Scaled) -> Self {
        let squares = scaled.residuals(&trajectory).iter().map(|residual| residual * residual).sum();
        Self { constant, terms, trajectory, squares }
    }

    /// Moves this law a share (0 to 1) of the way toward another law with the same terms in the same order.
    /// Coefficients and trajectory are interpolated linearly.
    pub fn toward(&self, other: &Self, share: f64, scaled: &Scaled) -> Self {
        debug_assert_eq!(self.terms.len(), other.terms.len(), "laws of the same terms");
        debug_assert_eq!(self.trajectory.len(), other.trajectory.len(), "laws at the same peaks");
        let mix = |own: f64, theirs: f64| own + share * (theirs - own);
        let terms = self
            .terms
            .iter()
            .zip(&other.terms)
            .map(|((column, own), (_, theirs))| (*column, mix(*own, *theirs)));
        let trajectory =
            self.trajectory.iter().zip(&other.trajectory).map(|(own, theirs)| mix(*own, *theirs));
        Self::new(mix(self.constant, other.constant), terms.collect(), trajectory.collect(), scaled)
    }

    /// Returns x at the first peak.
    pub fn start(&self) -> f64 {
        self.trajectory[0]
    }

    /// Returns the largest absolute difference in x between the trajectory and another one at the same peaks.
    pub fn distance(&self, trajectory: &[f64]) -> f64 {
        debug_assert_eq!(self.trajectory.len(), trajectory.len(), "trajectories at the same peaks");
        let pairs = self.trajectory.iter().zip(trajectory);
        pairs.map(|(own, other)| (own - other).abs()).fold(0.0, f64::max)
    }

    /// Returns the number of fitted parameters: one coefficient per term, the constant, and the initial
    /// value.
    pub fn parameters(&self) -> usize {
        2 + self.terms.len()
    }

    /// Returns the rate dx/ds at x = `log` and s = `time`.
    pub fn rate(&self, log: f64, time: f64) -> f64 {
        self.constant
            + self.terms.iter().map(|(column, factor)| factor * column.value(log, time)).sum::<f64>()
    }

    /// Returns the derivative of the rate dx/ds with respect to x, at x = `log`.
    pub fn gradient(&self, log: f64) -> f64 {
        self.terms.iter().map(|(column, factor)| factor * column.derivative_by_log(log)).sum()
    }

    /// Returns the total derivative of the rate dx/ds with respect to s, at x = `log` along a function of
    /// slope dx/ds.
    pub fn derivative(&self, log: f64, slope: f64) -> f64 {
        self.terms.iter().map(|(column, factor)| factor * column.derivative(log, slope)).sum()
    }

    /// Returns the coefficients of d ln A/dt in seconds and the record's unit, the constant first.
    ///
    /// ln A and t enter as differences: ln A − mean, and t minus the time of the first peak.
    pub fn coefficients(&self, scaled: &Scaled) -> Vec<(Term, f64)> {
        let constant = self.terms.iter().fold(self.constant, |sum, (column, factor)| {
            sum - factor * (column.mean + column.term.offset()) / column.deviation
        });
        let others = self.terms.iter().map(|(column, factor)| {
            let scale = match column.term {
                Term::InverseAmplitude => scaled.mean.exp(),
                Term::Amplitude => (-scaled.mean).exp(),
                Term::SquaredAmplitude => (-2.0 * scaled.mean).exp(),
                Term::Time => 1.0 / scaled.span_s,
                Term::Constant | Term::LogAmplitude | Term::SquaredLogAmplitude => 1.0,
            };
            (column.term, factor / column.deviation * scale / scaled.span_s)
        });
        std::iter::once((Term::Constant, constant / scaled.span_s)).chain(others).collect()
    }

    /// Returns the law as an equation, `d ln A/dt = …`, with A in the record's unit and t in seconds after
    /// the first peak.
    pub fn equation(&self, scaled: &Scaled) -> String {
        self.written(scaled, "d ln A/dt", |term| match term {
            Term::Constant => String::new(),
            Term::InverseAmplitude => "/A".to_owned(),
            Term::Amplitude => " A".to_owned(),
            Term::SquaredAmplitude => " A^2".to_owned(),
            Term::LogAmplitude => format!(" (ln A - {})", number(scaled.mean)),
            Term::SquaredLogAmplitude => format!(" (ln A - {})^2", number(scaled.mean)),
            Term::Time => " t".to_owned(),
        })
    }

    /// Returns the same law for the amplitude, `dA/dt = …`, in the same units.
    pub fn amplitude_equation(&self, scaled: &Scaled) -> String {
        self.written(scaled, "dA/dt", |term| match term {
            Term::Constant => " A".to_owned(),
            Term::InverseAmplitude => String::new(),
            Term::Amplitude => " A^2".to_owned(),
            Term::SquaredAmplitude => " A^3".to_owned(),
            Term::LogAmplitude => format!(" A (ln A - {})", number(scaled.mean)),
            Term::SquaredLogAmplitude => format!(" A (ln A - {})^2", number(scaled.mean)),
            Term::Time => " t A".to_owned(),
        })
    }

    fn written(&self, scaled: &Scaled, left: &str, factor: impl Fn(Term) -> String) -> String {
        let mut text = format!("{left} =");
        for (at, (term, coefficient)) in self.coefficients(scaled).into_iter().enumerate() {
            let sign = match (at, coefficient < 0.0) {
                (0, true) => " -",
                (0, false) => " ",
                (_, true) => " - ",
                (_, false) => " + ",
            };
            text.push_str(&format!("{sign}{}{}", number(coefficient.abs()), factor(term)));
        }
        text.replace("- -", "+ ")
    }
}

/// Returns ∫₀ˢ of a function at every peak, from its values and derivatives there, by the corrected
/// trapezoidal rule h/2·(f₀ + f₁) + h²/12·(f₀′ − f₁′), which is exact for cubics.
///
/// `times`, `values` and `derivatives` have one entry per peak. If there are no derivatives, as for measured
/// values, pass zeros; the plain trapezoidal rule remains.
///
/// Reference: Davis, Rabinowitz, Methods of Numerical Integration (1984), section 2.1.
pub fn running_integral(times: &[f64], values: &[f64], derivatives: &[f64]) -> Vec<f64> {
    let mut sum = 0.0;
    let steps = times.iter().zip(times.iter().skip(1));
    let ends = values.iter().zip(values.iter().skip(1));
    let slopes = derivatives.iter().zip(derivatives.iter().skip(1));
    let pieces = steps.zip(ends).zip(slopes).map(|(((from, to), (one, next)), (rise, next_rise))| {
        let step = to - from;
        step / 2.0 * (one + next) + step * step / 12.0 * (rise - next_rise)
    });
    std::iter::once(0.0)
        .chain(pieces.map(|piece| {
            sum += piece;
            sum
        }))
        .collect()
}

/// Formats a number with six digits.
pub(crate) fn number(value: f64) -> String {
    let magnitude = value.abs().log10().floor();
    if value == 0.0 {
        "0".to_owned()
    } else if (-4.0..6.0).contains(&magnitude) {
        format!("{value:.*}", (5.0 - magnitude) as usize)
    } else {
        format!("{value:.5e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use envelope::Envelope;

    #[test]
    fn the_running_integral_is_exact_for_cubics() {
        let times = [0.0, 0.2, 0.7, 1.0, 1.9];
        let values = times.map(|t: f64| 4.0 * t.powi(3) - 3.0 * t * t + 1.0);
        let derivatives = times.map(|t: f64| 12.0 * t * t - 6.0 * t);
        let integral = running_integral(&times, &values, &derivatives);
        for (t, found) in times.iter().zip(integral) {
            assert!((found - (t.powi(4) - t.powi(3) + t)).abs() < 1e-14, "{t} {found}");
        }
    }

    #[test]
    fn a_law_is_written_in_seconds_and_the_records_unit() {
        let logs: Vec<f64> = (0..5).map(|i| -2.0 - f64::from(i)).collect();
        let envelope = Envelope::new(vec![0.0, 1.0, 2.0, 3.0, 5.0], logs, 6.0).unwrap();
        let scaled = Scaled::of(&envelope).unwrap();
        let columns: Vec<Column> =
            Term::ALL.into_iter().filter_map(|term| Column::over(term, &scaled)).collect();
        // The constant does not vary, so that it gives no column.
        assert_eq!(columns.len(), Term::ALL.len() - 1);
        let terms = columns.into_iter().zip([-0.3, 0.2, 0.1, -0.4, 0.5, 0.6]).collect();
        let law = Law::new(-1.1, terms, scaled.logs.clone(), &scaled);
        let (log, time): (f64, f64) = (-2.7, 2.3);
        let found: f64 = law
            .coefficients(&scaled)
            .into_iter()
            .map(|(term, factor)| {
                factor
                    * match term {
                        Term::Constant => 1.0,
                        Term::InverseAmplitude => (-log).exp(),
                        Term::Amplitude => log.exp(),
                        Term::SquaredAmplitude => (2.0 * log).exp(),
                        Term::LogAmplitude => log - scaled.mean,
                        Term::SquaredLogAmplitude => (log - scaled.mean).powi(2),
                        Term::Time => time,
                    }
            })
            .sum();
        let expected = law.rate(log - scaled.mean, time / 5.0) / 5.0;
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
        let text = law.amplitude_equation(&scaled);
        assert!(text.contains(" A (ln A + 4.00000)^2") && text.contains(" t A"), "{text}");
    }

    #[test]
    fn numbers_have_six_digits() {
        let texts = [0.0, -0.131_931_4, 0.003_532_34, 123.456_78, 1e-7, 2.5e9].map(number);
        assert_eq!(texts, ["0", "-0.131931", "0.00353234", "123.457", "1.00000e-7", "2.50000e9"]);
    }
}
