//! Remarks on what a log shows, in sentences.

use super::damping::changing;
use super::looked::{CRITICAL, FEW_CYCLES, Looked};
use crate::error::in_options;
use envelope::Envelope;
use identify::{Mode, regular_part};
use record::{Clock, Quantity, Record, extremes, noise_level};
use report::format::{quantity, significant};

/// Relative error of a natural frequency above which it is doubtful whether anything swings: 24 simulated
/// records of noise, white or red, have 4 to 15 % or no frequency.
const HARDLY_KNOWN: f64 = 0.03;

/// Height of the largest swing in steps of the readings, below which their rounding is no small noise.
const COARSE: f64 = 8.0;

/// Noise of an input, as a part of its range, that is no error but the input itself.
const LARGE_INPUT_NOISE: f64 = 0.05;
/// Motion by an input's noise, in units of the sensor's, from which it is seen.
const SEEN: f64 = 0.5;

/// Returns remarks on the modes of a record that has several, and on steady lines.
fn several(modes: &[Mode]) -> Vec<String> {
    let (lines, modes): (Vec<&Mode>, Vec<&Mode>) = modes.iter().partition(|mode| mode.is_steady);
    let several = (modes.len() > 1).then(|| {
        format!(
            "the record holds {} modes; the numbers above are those of the strongest, and so are those of an estimate, \
             before which the others are subtracted",
            modes.len()
        )
    });
    let steady = lines.iter().map(|line| {
        format!(
            "a line at {} keeps its amplitude while the swing decays, as the hum of the mains or a motor does: it is no \
             mode, and an estimate subtracts it",
            quantity(&significant(line.frequency_hz.value, 4), "Hz")
        )
    });
    several.into_iter().chain(steady).collect()
}

/// Returns remarks on a free decay that no single oscillator describes: a hand that moved it, a sensor that clips or shows
/// one side alone, a damping ratio or a frequency that changes along its envelope. They name keys of a configuration.
#[must_use]
pub fn of_decay(record: &Record, clock: &Clock, modes: usize, envelope: Option<&Envelope>) -> Vec<String> {
    if record.input().is_some() {
        return Vec::new();
    }
    let remarks =
        [uneven(record, clock, modes), clipped(record, modes).or_else(|| one_sided(record)), coarse(record)];
    let changes = envelope.map(changing).unwrap_or_default();
    remarks.into_iter().flatten().chain(changes).collect()
}

/// Returns a remark if only a part of the record swings evenly, and not because of another mode.
fn uneven(record: &Record, clock: &Clock, modes: usize) -> Option<String> {
    let [from, to] = regular_part(record, clock).filter(|_| modes < 2)?;
    // Times of the clock begin where the stamps do.
    let shift = record.stamps_s().first()? - clock.start_s();
    Some(format!(
        "amplitude or phase change unevenly outside {from:.2} s to {to:.2} s, as if a hand moved it or friction stopped it \
         there: set `data.from_s` to {from:.2} and `data.to_s` to {to:.2} to read that part alone",
        from = from + shift,
        to = to + shift
    ))
}

/// Returns a remark if the sensor clips the largest swings. The sum of several modes stands for long at its extremes too.
fn clipped(record: &Record, modes: usize) -> Option<String> {
    let found = record.clipped().filter(|_| modes < 2)?;
    Some(format!(
        "the values stand at {} in {} half swings, up to {:.2} s, as those of a sensor do whose range ends there: the swing is \
         larger, and its amplitude is not seen; set `data.from_s` to {:.2} to read what follows",
        quantity(&significant(found.level, 3), record.unit()),
        found.half_swings,
        found.to_s,
        found.to_s + 0.005
    ))
}

/// Returns a remark if the sensor's steps are coarse beside the swing: their errors depend on the motion and are no noise.
fn coarse(record: &Record) -> Option<String> {
    let [lowest, highest] = extremes(record.values());
    let steps = 0.5 * (highest - lowest) / record.quantum();
    (steps < COARSE).then(|| {
        format!(
            "the largest swing is {steps:.1} steps of the readings high, of {} each: what rounding takes from a small swing is taken for \
             damping, and the errors do not hold it; give a record of a larger swing or with more digits",
            quantity(&significant(record.quantum(), 3), record.unit())
        )
    })
}

/// Returns a remark if the values turn back at one level on one side.
fn one_sided(record: &Record) -> Option<String> {
    record.stands_on_one_side().then(|| {
        "the values turn back at one level on one side, while those of the other fall: a magnitude, a rectified or a clipped \
         signal does so. A magnitude has twice the frequency of its motion; name a column with a sign with `data.value`"
            .to_owned()
    })
}

impl Looked {
    /// Returns remarks on the motion, in options of the command line: too few cycles, no swing, several modes, doubtful
    /// numbers, and those [`of_decay`] with the envelope of an estimate if it has one.
    #[must_use]
    pub fn remarks(&self, envelope: Option<&Envelope>) -> Vec<String> {
        let Self { look, modes, .. } = self;
        let first = [self.few_cycles(), self.no_swing()].into_iter().flatten().chain(several(modes));
        let then = [self.hardly_known(), self.growth(), self.noisy_input()].into_iter().flatten();
        let of_decay = of_decay(&look.record, &look.clock, modes.len(), envelope);
        first.chain(then).chain(of_decay.iter().map(|said| in_options(said))).collect()
    }

    /// Returns a remark if the noise of the measured input, taken as a push, moves the oscillator visibly: white pushes of
    /// standard deviation s a sample Δt make a variance of s²·Δt/(2·c·k), per unit of inertia.
    fn noisy_input(&self) -> Option<String> {
        let (record, oscillator) = (&self.look.record, &self.oscillator);
        let (input, gain) = (record.input()?, oscillator.input_gain?.value);
        let (damping, stiffness) = (oscillator.damping.value, oscillator.stiffness.value);
        let own = noise_level(input);
        let [lowest, highest] = extremes(input);
        let excited = own > LARGE_INPUT_NOISE * (highest - lowest);
        if record.quantity() != Quantity::Position || excited || damping <= 0.0 || stiffness <= 0.0 {
            return None;
        }
        let moved = gain.abs() * own / (2.0 * damping * stiffness * self.look.clock.sample_rate_hz).sqrt();
        let ratio = moved / noise_level(record.values()).max(record.quantum());
        (ratio > SEEN).then(|| {
            format!(
                "the measured input has a noise of its own, {}, which taken as a push moves the oscillator by {} times the \
                 noise of the observed column: no simulator with this input comes closer. Give the commanded input if the \
                 file has it",
                significant(own, 2),
                significant(ratio, 2)
            )
        })
    }

    /// Returns a warning if the swing grows, which no passive system does.
    fn growth(&self) -> Option<String> {
        let damping = self.oscillator.damping;
        (damping.value < 0.0 && damping.is_significant()).then(|| {
            "the swing grows: something adds energy to it, which no passive simulator can do; the written \
             damping is 0"
                .to_owned()
        })
    }

    /// Returns a warning if the frequency is so uncertain that the record may hold no swing.
    fn hardly_known(&self) -> Option<String> {
        let frequency = self.oscillator.natural_frequency_hz()?;
        let part = frequency.std_error / frequency.value;
        (part > HARDLY_KNOWN).then(|| {
            format!(
                "the natural frequency is known to {:.0} % only: the record may hold noise and no swing, or a swing that \
                 hardly oscillates",
                100.0 * part
            )
        })
    }

    /// Returns a remark if the record comes to rest without a swing.
    fn no_swing(&self) -> Option<String> {
        let oscillator = &self.oscillator;
        if oscillator.input_gain.is_some() {
            return None;
        }
        match oscillator.damping_ratio() {
            Some(ratio) if ratio.value < CRITICAL => None,
            Some(_) => Some(
                "no oscillation: the record comes to rest without a swing, as a critically damped or overdamped system does"
                    .to_owned(),
            ),
            None => Some(
                "no oscillation: the record comes to rest without a swing, as an overdamped or critically damped system \
                 does, or it drifts, or is sampled less than two and a half times in a cycle; neither a frequency nor a damping ratio \
                 can be read from it"
                    .to_owned(),
            ),
        }
    }

    /// Returns a warning if the record is too short for its decay to show.
    fn few_cycles(&self) -> Option<String> {
        let cycles = self.cycles()?;
        (cycles < FEW_CYCLES).then(|| {
            format!(
                "the record shows {cycles:.1} cycles, too few to see what a simulator lacks; give a record of ten cycles or \
                 more"
            )
        })
    }
}
