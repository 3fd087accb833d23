//! Candidate terms of a law.

use std::fmt;

/// Candidate term of the right-hand side of d ln A/dt, as a function of x = ln A − mean and of the scaled
/// time s in 0..1.
///
/// Exponentials are taken minus one, so that an envelope that hardly decays keeps its digits. The constant
/// that every law has absorbs the difference.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Term {
    /// 1: viscous damping. Every law has it.
    Constant,
    /// 1/A: dry (Coulomb) friction.
    InverseAmplitude,
    /// A: drag quadratic in the velocity.
    Amplitude,
    /// A²: drag cubic in the velocity.
    SquaredAmplitude,
    /// ln A.
    LogAmplitude,
    /// (ln A)².
    SquaredLogAmplitude,
    /// t: damping that drifts with time.
    Time,
}

impl Term {
    /// Every term, in the order of equations.
    pub const ALL: [Self; 7] = [
        Self::Constant,
        Self::InverseAmplitude,
        Self::Amplitude,
        Self::SquaredAmplitude,
        Self::LogAmplitude,
        Self::SquaredLogAmplitude,
        Self::Time,
    ];

    /// Returns the name used in configurations.
    pub fn name(self) -> &'static str {
        match self {
            Self::Constant => "1",
            Self::InverseAmplitude => "1/A",
            Self::Amplitude => "A",
            Self::SquaredAmplitude => "A^2",
            Self::LogAmplitude => "ln A",
            Self::SquaredLogAmplitude => "(ln A)^2",
            Self::Time => "t",
        }
    }

    /// Returns the term with a name as given by [`Self::name`]; `None` if there is none.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|term| term.name() == name)
    }

    /// Returns the value at x = `log` and s = `time`, dimensionless; exponentials are taken minus one, as
    /// [`Self::offset`] says.
    pub fn value(self, log: f64, time: f64) -> f64 {
        match self {
            Self::Constant => 1.0,
            Self::InverseAmplitude => (-log).exp_m1(),
            Self::Amplitude => log.exp_m1(),
            Self::SquaredAmplitude => (2.0 * log).exp_m1(),
            Self::LogAmplitude => log,
            Self::SquaredLogAmplitude => log * log,
            Self::Time => time,
        }
    }

    /// Returns the partial derivatives of [`Self::value`] at x = `log`: with respect to x, then with respect
    /// to s.
    pub fn gradient(self, log: f64) -> (f64, f64) {
        match self {
            Self::Constant => (0.0, 0.0),
            Self::InverseAmplitude => (-(-log).exp(), 0.0),
            Self::Amplitude => (log.exp(), 0.0),
            Self::SquaredAmplitude => (2.0 * (2.0 * log).exp(), 0.0),
            Self::LogAmplitude => (1.0, 0.0),
            Self::SquaredLogAmplitude => (2.0 * log, 0.0),
            Self::Time => (0.0, 1.0),
        }
    }

    /// Returns the number that [`Self::value`] subtracts from the term: 1 for exponentials, 0 for the others.
    pub fn offset(self) -> f64 {
        match self {
            Self::InverseAmplitude | Self::Amplitude | Self::SquaredAmplitude => 1.0,
            _ => 0.0,
        }
    }
}

impl fmt::Display for Term {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_leads_back_to_its_term() {
        for term in Term::ALL {
            assert_eq!(Term::named(term.name()), Some(term));
        }
        assert_eq!(Term::named("sin A"), None);
    }

    #[test]
    fn gradients_agree_with_differences() {
        let (log, time, step) = (0.3, 0.6, 1e-5);
        for term in Term::ALL {
            let by_log = (term.value(log + step, time) - term.value(log - step, time)) / (2.0 * step);
            let by_time = (term.value(log, time + step) - term.value(log, time - step)) / (2.0 * step);
            let (one, other) = term.gradient(log);
            assert!((one - by_log).abs() < 1e-9 && (other - by_time).abs() < 1e-9, "{term}");
        }
    }

    #[test]
    fn offsets_make_the_exponentials_whole() {
        let log: f64 = 0.7;
        let whole = |term: Term| term.value(log, 0.0) + term.offset();
        assert!((whole(Term::InverseAmplitude) - 1.0 / log.exp()).abs() < 1e-15);
        assert!((whole(Term::SquaredAmplitude) - log.exp().powi(2)).abs() < 1e-14);
    }
}
