//! Checks that a record has to pass before it is cut into segments.

use crate::data::observations::Observations;
use crate::data::period::swing;
use crate::error::DiagnosisError;
use crate::noise::periodogram::strongest_period;
use dynamics::NominalSimulator;
use std::f64::consts::TAU;

/// Minimum number of samples, and of cycles, in a record.
const FEWEST_SAMPLES: usize = 50;
const FEWEST_CYCLES: f64 = 3.0;

/// Factor between the measured and the nominal period from which on they belong to different systems. A
/// spring that misses a weight swings more than twice as slowly, and a wrong unit makes a factor of at least
/// √9.81.
const ANOTHER_SYSTEM: f64 = 3.0;

/// Checks that a record can be diagnosed and returns its period in seconds. `None` for a driven record, and
/// for a free swing without a period to compare. `kept` is `true` for each sample that is not an outlier.
pub(crate) fn check(
    number: usize,
    (record, kept): (&Observations, &[bool]),
    first: &Observations,
    simulator: &NominalSimulator,
) -> Result<Option<f64>, DiagnosisError> {
    if record.quantity != first.quantity || record.unit != first.unit {
        return Err(DiagnosisError::MixedQuantities { record: number });
    }
    if record.len() < FEWEST_SAMPLES {
        return Err(DiagnosisError::TooFewSamples {
            record: number,
            found: record.len(),
            needed: FEWEST_SAMPLES,
        });
    }
    let span = span(&record.values);
    let resolution = record.resolution.or(simulator.nominal().sensor_resolution()).unwrap_or(0.0);
    if span <= 3.0 * resolution || span <= 0.0 {
        return Err(DiagnosisError::NoMotion { record: number, span, resolution, unit: record.unit });
    }
    if record.input.is_some() { Ok(None) } else { own_period(number, (record, kept), simulator) }
}

/// Returns the period of a free swing in seconds; `None` if it has none to compare with the simulator's.
///
/// # Errors
/// Returns an error if the simulator has no spring and the record no input, if fewer than [`FEWEST_CYCLES`]
/// cycles are seen, or if the period is that of another system ([`ANOTHER_SYSTEM`]).
fn own_period(
    number: usize,
    (record, kept): (&Observations, &[bool]),
    simulator: &NominalSimulator,
) -> Result<Option<f64>, DiagnosisError> {
    let nominal = simulator.nominal();
    let omega = simulator.angular_frequency();
    if omega == 0.0 {
        return Err(DiagnosisError::MissingInput { record: number });
    }
    if nominal.damping() / nominal.inertia() > 1.5 * omega {
        return Ok(None);
    }
    let nominal_s = TAU / omega;
    let (times, values) = (only(&record.times_s, kept), only(&record.values, kept));
    let swing = swing(&times, &values);
    let cycles = swing.map_or(0.0, |swing| swing.cycles);
    let spans = record.duration_s() / nominal_s;
    if cycles < FEWEST_CYCLES && spans < FEWEST_CYCLES {
        return Err(DiagnosisError::TooFewCycles {
            record: number,
            found: cycles.max(spans),
            needed: FEWEST_CYCLES,
            period_s: nominal_s,
        });
    }
    // A swing that friction stops within a few half periods has no period of its own to compare.
    let Some(crossed_s) = swing.filter(|swing| swing.cycles >= FEWEST_CYCLES).map(|swing| swing.period_s)
    else {
        return Ok(None);
    };
    let ratio = |period_s: f64| (period_s / nominal_s).max(nominal_s / period_s);
    let is_own = |period_s: &f64| ratio(*period_s) < ANOTHER_SYSTEM;
    if is_own(&crossed_s) {
        return Ok(Some(crossed_s));
    }
    // Crossings mislead where noise or a drift is large, and the spectrum where a forcing outlasts the swing.
    let measured_s = strongest_period(&times, &values, crossed_s.min(nominal_s)).unwrap_or(crossed_s);
    let others = [Some(measured_s), first_period(&times, &values, nominal_s)];
    let own = others.into_iter().flatten().find(is_own);
    let ratio = ratio(measured_s);
    own.map(Some).ok_or(DiagnosisError::AnotherPeriod { record: number, nominal_s, measured_s, ratio })
}

/// Number of nominal periods that a record's beginning lasts, and of cycles that it needs to have a period.
const BEGINNING: f64 = 4.0;
const FEWEST_AT_FIRST: f64 = 2.0;

/// Returns the period in seconds of the swing that a record begins with.
fn first_period(times: &[f64], values: &[f64], nominal_s: f64) -> Option<f64> {
    let first = times.first()?;
    let count = times.partition_point(|time| time - first <= BEGINNING * nominal_s);
    let found = swing(times.get(..count)?, values.get(..count)?)?;
    (found.cycles >= FEWEST_AT_FIRST).then_some(found.period_s)
}

/// Returns the difference between the highest and the lowest value.
pub(crate) fn span(values: &[f64]) -> f64 {
    let highest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    highest - values.iter().copied().fold(f64::INFINITY, f64::min)
}

/// Returns the values that `kept` marks.
pub(crate) fn only(values: &[f64], kept: &[bool]) -> Vec<f64> {
    values.iter().zip(kept).filter(|(_, kept)| **kept).map(|(value, _)| *value).collect()
}

#[cfg(test)]
mod tests {
    use crate::fixtures::record;
    use crate::{DiagnosisError, Observations, Settings, diagnose};
    use dynamics::chain::{Chain, Observed};
    use dynamics::{Active, Nominal, System};
    use record::{Clock, ClockChoice};

    /// A swing at 12.7 Hz decays within half a second, and a forcing at 2.6 Hz goes on for six.
    #[test]
    fn a_forcing_that_outlasts_the_swing_is_not_taken_for_another_system() {
        let nominal = Nominal::new(1.0, 16.0, 6400.0, 0.0).unwrap();
        let forcing = Active::new("periodic_forcing", &[60.0, 16.3, 0.3]).unwrap();
        let system = System::new(nominal, vec![forcing]).unwrap();
        let chain = Chain::new(Observed::Position, 1e-4, Vec::new()).unwrap();
        let record = record(&system, -0.03, 1600, &chain, 1);
        let clock = Clock::new(&record, ClockChoice::Auto).unwrap();
        let answer = |nominal: &Nominal| {
            diagnose(&[Observations::new(&record, &clock)], nominal, &Settings::default(), &|| 0.0)
        };
        assert_eq!(answer(&nominal).unwrap().verdict.effects, ["periodic_forcing"]);
        for stiffness in [1.0, 2.5e5] {
            let other = answer(&Nominal::new(1.0, 1.0, stiffness, 0.0).unwrap());
            assert!(matches!(other, Err(DiagnosisError::AnotherPeriod { .. })), "{stiffness}");
        }
    }
}
