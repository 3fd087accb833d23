//! Truth of a simulated record: everything that determines its bits.

use dynamics::chain::Chain;
use dynamics::{Start, System};
use serde::{Deserialize, Serialize};

/// Value of the `schema` field in the text of a truth.
pub const TRUTH_SCHEMA: &str = "ringdown.truth/1";

/// Truth of a record: everything that generated it. Simulating it again reproduces the record bit for bit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Truth {
    /// Schema of the text, [`TRUTH_SCHEMA`].
    pub schema: String,
    /// The true oscillator, with the effects that act in it.
    pub system: System,
    /// Initial state of the motion.
    pub start: Start,
    /// Input that drives the system; `None` for a free motion.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub excitation: Option<Excitation>,
    /// Measurement chain between the motion and the file.
    pub chain: Chain,
    /// Sampling of the record, and decimals of its numbers in the file.
    pub sampling: Sampling,
    /// Branch of the seed tree that the random draws come from.
    pub draws: Draws,
}

/// Sampling of a record, and decimals of its numbers in the file.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sampling {
    /// Sample rate of the sensor's own clock, in Hz.
    pub rate_hz: f64,
    /// Number of samples before any is lost.
    pub samples: usize,
    /// Reading of the recorder's clock at the first sample, in seconds.
    pub first_stamp_s: f64,
    /// Decimals of a timestamp in seconds.
    pub stamp_decimals: u8,
    /// Decimals of a value in its SI unit.
    pub value_decimals: u8,
}

/// Branch of the seed tree that a record's measurement chain draws from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Draws {
    /// Root seed as configured.
    pub seed: u64,
    /// Names along the path from the root.
    pub branch: Vec<String>,
}

/// Shape of an input over time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Waveform {
    /// A sine of one frequency.
    Sine,
    /// A sine whose frequency rises linearly over the record.
    Chirp,
    /// Square wave that switches between plus and minus the amplitude.
    Square,
}

/// Input that is held between the sensor's samples.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Excitation {
    /// Shape over time.
    pub waveform: Waveform,
    /// Amplitude, in the input's unit.
    pub amplitude: f64,
    /// Frequency in hertz; for a chirp, the frequency at the start.
    pub frequency_hz: f64,
    /// Frequency at the end of a chirp, in hertz; for other shapes, equal to `frequency_hz`.
    pub end_frequency_hz: f64,
}

impl Excitation {
    /// Returns the input at `time_s` seconds after the first sample of a record that lasts `duration_s`
    /// seconds.
    #[must_use]
    pub fn at(&self, time_s: f64, duration_s: f64) -> f64 {
        let sweep = match self.waveform {
            Waveform::Chirp => (self.end_frequency_hz - self.frequency_hz) / duration_s,
            Waveform::Sine | Waveform::Square => 0.0,
        };
        let turns = self.frequency_hz * time_s + 0.5 * sweep * time_s * time_s;
        let sine = (std::f64::consts::TAU * turns).sin();
        match self.waveform {
            Waveform::Sine | Waveform::Chirp => self.amplitude * sine,
            Waveform::Square => self.amplitude * if turns.fract() < 0.5 { 1.0 } else { -1.0 },
        }
    }
}
