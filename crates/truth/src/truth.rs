//! Everything that a simulated record's bits follow from.

use dynamics::chain::Chain;
use dynamics::{Start, System};
use serde::{Deserialize, Serialize};

/// The `schema` of a truth's text.
pub const TRUTH_SCHEMA: &str = "ringdown.truth/1";

/// Truth of a record: everything that generated it. Simulating it again gives the record to the bit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Truth {
    /// [`TRUTH_SCHEMA`].
    pub schema: String,
    /// The oscillator as it is, with the effects that act in it.
    pub system: System,
    /// Where the motion starts.
    pub start: Start,
    /// The input that drives it; absent for a free motion.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub excitation: Option<Excitation>,
    /// Measurement chain between the motion and the file.
    pub chain: Chain,
    /// When and how exactly the file's samples are taken.
    pub sampling: Sampling,
    /// Where its random draws come from.
    pub draws: Draws,
}

/// Sampling and notation of a record.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sampling {
    /// Samples per second of the sensor's own clock.
    pub rate_hz: f64,
    /// Number of samples before any is lost.
    pub samples: usize,
    /// Reading of the recorder's clock at the first sample, in seconds.
    pub first_stamp_s: f64,
    /// Decimals of a stamp in seconds.
    pub stamp_decimals: u8,
    /// Decimals of a value in its SI unit.
    pub value_decimals: u8,
}

/// The branch of the tree of seeds that a record's chain draws from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Draws {
    /// The seed as configured.
    pub seed: u64,
    /// The names on the way from the root.
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
    /// Steps between plus and minus the amplitude.
    Square,
}

/// An input that is held between the sensor's samples.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Excitation {
    /// The shape.
    pub waveform: Waveform,
    /// Largest value, in the input's unit.
    pub amplitude: f64,
    /// Frequency in hertz; of a chirp, at the start.
    pub frequency_hz: f64,
    /// Frequency at the end of a chirp, in hertz; otherwise that at the start.
    pub end_frequency_hz: f64,
}

impl Excitation {
    /// The input at a time after the first sample, in a record of some duration; both in seconds.
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
