//! Identification of the linear oscillator nearest to a record: a first nominal simulator if there is none
//! yet.
//!
//! Per unit of inertia, θ̈ + 2ζω₀·θ̇ + ω₀²·(θ − θ_rest) = g·u(t). A free decay is identified from its turning
//! points (`decay`), which assume least, or from damped sinusoids fitted to its samples (`samples_pipeline`) where those
//! tell the damping much better. A record with an input, or without a swing, is identified by the simulated response
//! that is nearest to it (`response`), from a regression in weak form (`weak`), which also serves where nothing pulls
//! the system back.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod decay;
mod error;
mod modes;
mod observed;
mod oscillator;
mod regular;
mod response;
mod samples_pipeline;
mod scaled;
mod weak;

pub use decay::half_period;
pub use error::IdentifyError;
pub use modes::{Mode, modes};
pub use oscillator::{Basis, Estimated, LinearOscillator};
pub use regular::regular_part;
pub use samples_pipeline::SamplesPipeline;

use observed::input;
use record::{Clock, Record};

/// Identifies the linear oscillator nearest to a record under a clock. The run time is linear in the number
/// of samples.
///
/// # Errors
/// [`IdentifyError`] if nothing moves, if the record is shorter than a few swings, or if its motion does not
/// tell the coefficients apart.
pub fn identify(record: &Record, clock: &Clock) -> Result<LinearOscillator, IdentifyError> {
    let values = record.values();
    if values.windows(2).all(|pair| pair.first() == pair.last()) {
        return Err(IdentifyError::NoMotion { samples: values.len() });
    }
    let free = input(record, clock).is_none();
    let peaks = if free { decay::oscillator(record, clock) } else { None };
    let is_coarse = peaks
        .as_ref()
        .and_then(LinearOscillator::natural_frequency_hz)
        .is_some_and(|frequency| clock.sample_rate_hz < MANY_PER_PERIOD * frequency.value);
    // The scatter of so few tells no error.
    let are_few = peaks.is_some_and(|peaks| matches!(peaks.basis, Basis::TurningPoints(..FEW)));
    let needs_samples = is_coarse || are_few;
    let samples = if free && (needs_samples || !peaks.as_ref().is_some_and(is_well_known)) {
        SamplesPipeline::DEFAULT.oscillator(record, clock).ok()
    } else {
        None
    };
    let is_tighter = |peaks: &LinearOscillator| {
        !needs_samples
            && samples.is_none_or(|samples| peaks.damping.std_error < TIGHTER * samples.damping.std_error)
    };
    if let Some(peaks) = peaks.filter(is_tighter) {
        return Ok(peaks);
    }
    if let Some(best) = samples.or(peaks) {
        let is_short = best.damping_ratio().is_some_and(|ratio| ratio.value > FEW_CYCLES);
        let guesses = || samples.iter().chain(&peaks);
        let found = if is_short { response::returning(record, clock, guesses()) } else { None };
        return Ok(found.unwrap_or(best));
    }
    let guess = weak::oscillator(record, clock);
    let near = guess.as_ref().ok();
    let found = match free {
        true => response::returning(record, clock, near),
        false => response::driven(record, clock, near),
    };
    found.map_or(guess, Ok)
}

/// Damping ratio above which a free decay is over in few cycles, and a response is fitted to all of it.
const FEW_CYCLES: f64 = 0.2;
/// Standard errors of a damping ratio, relative and absolute, below which turning points need no help.
const WELL_KNOWN: (f64, f64) = (0.05, 1e-4);
/// Number of turning points below which samples are believed.
const FEW: usize = 8;
/// Samples per period that turning points need.
const MANY_PER_PERIOD: f64 = 8.0;
/// Ratio of standard errors from which on the samples are believed and not the turning points.
const TIGHTER: f64 = 2.0;

/// Returns `true` if turning points tell the damping ratio well.
fn is_well_known(found: &LinearOscillator) -> bool {
    let (relative, absolute) = WELL_KNOWN;
    found.damping_ratio().is_some_and(|ratio| ratio.std_error < (relative * ratio.value).max(absolute))
}

#[cfg(test)]
mod tests {
    use super::{Basis, IdentifyError, LinearOscillator, identify};
    use rand_distr::{Distribution, Normal};
    use record::{Clock, ClockChoice, InputRow, Quantity, Record};
    use seed::Seed;

    const RATE: f64 = 200.0;

    /// A swing of damping ratio `zeta` at 2 Hz about 0.1: 20 midpoint steps per sample, with the input held
    /// between samples.
    fn record(zeta: f64, noise: f64, input: Option<fn(f64) -> f64>, seed: u64) -> Record {
        let omega = 2.0 * std::f64::consts::TAU;
        let mut draws = Seed::new(seed).child("noise").generator();
        let normal = Normal::new(0.0, noise).unwrap();
        let (step, steps) = (1.0 / RATE, 20);
        let (mut x, mut v) = if input.is_some() { (0.0, 0.0) } else { (0.5, 0.0) };
        let (mut times, mut values, mut inputs) = (Vec::new(), Vec::new(), Vec::new());
        for sample in 0..3000 {
            let time = f64::from(sample) * step;
            let torque = input.map_or(0.0, |input| input(time));
            times.push(time);
            values.push(0.1 + x + normal.sample(&mut draws));
            inputs.push(torque);
            let small = step / f64::from(steps);
            for _ in 0..steps {
                let rate = |x: f64, v: f64| 3.0 * torque - 2.0 * zeta * omega * v - omega * omega * x;
                let (vm, am) =
                    (v + 0.5 * small * rate(x, v), rate(x + 0.5 * small * v, v + 0.5 * small * rate(x, v)));
                x += small * vm;
                v += small * am;
            }
        }
        let input = input.map(|_| inputs);
        Record::new(times, values, input, Quantity::Position, "rad").unwrap()
    }

    fn found(record: &Record) -> LinearOscillator {
        identify(record, &Clock::new(record, ClockChoice::Auto).unwrap()).unwrap()
    }

    #[test]
    fn a_free_decay_is_read_from_its_turning_points() {
        let found = found(&record(0.02, 1e-4, None, 1));
        assert!(matches!(found.basis, Basis::TurningPoints(_)));
        let frequency = found.natural_frequency_hz().unwrap();
        assert!((frequency.value - 2.0).abs() < 1e-3, "{frequency:?}");
        let ratio = found.damping_ratio().unwrap();
        assert!((ratio.value - 0.02).abs() < 3.0 * ratio.std_error + 2e-5, "{ratio:?}");
        assert!((found.rest.unwrap().value - 0.1).abs() < 1e-3);
        assert!(found.input_gain.is_none());
    }

    #[test]
    fn a_driven_record_tells_its_gain_too() {
        let sweep = |time: f64| (time * (3.0 + 0.8 * time)).sin();
        for seed in 0..5 {
            let found = found(&record(0.05, 1e-4, Some(sweep), seed));
            assert!(matches!(found.basis, Basis::Response(_)));
            let (frequency, ratio) = (found.natural_frequency_hz().unwrap(), found.damping_ratio().unwrap());
            assert!((frequency.value - 2.0).abs() < 0.01, "{frequency:?}");
            assert!((ratio.value - 0.05).abs() < 4.0 * ratio.std_error + 1e-3, "{ratio:?}");
            assert!((found.input_gain.unwrap().value - 3.0).abs() < 0.1, "{:?}", found.input_gain);
        }
    }

    /// The input alternates between rows and is recorded at every third row only, where it always has the
    /// same sign.
    #[test]
    fn an_input_acts_where_the_sensor_says_nothing() {
        let alternating = |time: f64| {
            let row = (time * RATE).round() as i64;
            (time * (3.0 + 0.8 * time)).sin() + if row % 3 == 0 { 1.0 } else { -0.5 }
        };
        let whole = record(0.05, 1e-4, Some(alternating), 3);
        let (stamps, values, input) = (whole.stamps_s(), whole.values(), whole.input().unwrap());
        let seen: Vec<usize> = (0..whole.len()).filter(|row| row % 3 == 0).collect();
        let pick = |column: &[f64]| seen.iter().map(|row| column[*row]).collect::<Vec<f64>>();
        let record =
            Record::new(pick(stamps), pick(values), Some(pick(input)), Quantity::Position, "rad").unwrap();
        let record = record.with_rows(seen.clone());
        let rest = |record: &Record| found(record).rest.unwrap().value;
        let blind = rest(&record);
        let between = (0..whole.len()).filter(|row| row % 3 != 0);
        let row = |row: usize| InputRow { row, stamp_s: stamps[row], input: input[row] };
        let told = rest(&record.with_input_rows(between.map(row).collect()));
        // The recorded rows have a mean of 1 that the whole input does not have; times the gain of 3, over
        // ω²: 19 mrad.
        assert!((blind - 0.1).abs() > 0.015, "{blind}");
        assert!((told - 0.1).abs() < 1e-3, "{told}");
    }

    /// A command is kept between its samples, a measured force is not.
    #[test]
    fn an_input_is_read_as_it_is_held() {
        // Steps of 0.1 s, which begin at samples.
        let steps = |time: f64| ((time * 10.0 + 1e-6).floor() * 2.399).sin();
        let smooth = |time: f64| (time * (3.0 + 0.8 * time)).sin();
        for input in [steps as fn(f64) -> f64, smooth] {
            let ratio = found(&record(0.1, 1e-4, Some(input), 2)).damping_ratio().unwrap();
            assert!((ratio.value - 0.1).abs() < 4.0 * ratio.std_error + 5e-4, "{ratio:?}");
        }
    }

    #[test]
    fn what_does_not_move_is_refused() {
        let record =
            Record::new((0..50).map(f64::from).collect(), vec![0.3; 50], None, Quantity::Position, "rad")
                .unwrap();
        let clock = Clock::new(&record, ClockChoice::Auto).unwrap();
        assert_eq!(identify(&record, &clock), Err(IdentifyError::NoMotion { samples: 50 }));
    }
}
