//! Recordings of all joints of a robot.

use crate::error::RobotError;
use dynamics::Hold;

/// Shortest recording, in seconds.
const SHORTEST_S: f64 = 1.0;

/// Samples of one joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Times in seconds, ascending, of the same clock for all joints.
    pub times: Vec<f64>,
    /// Positions in rad or m.
    pub positions: Vec<f64>,
    /// Torques in N m, or forces in N; `None` if they were not recorded.
    pub torques: Option<Vec<f64>>,
}

/// Recording of all joints of a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// Name in messages.
    pub name: String,
    /// Joints in the model's order.
    pub joints: Vec<Channel>,
}

impl Recording {
    /// Checks that every joint was recorded for a second.
    ///
    /// # Errors
    /// [`RobotError::Short`].
    pub fn check_length(&self) -> Result<(), RobotError> {
        for channel in &self.joints {
            let ends = channel.times.first().zip(channel.times.last());
            // A channel without samples lasts 0 s.
            let seconds = ends.map_or(0.0, |(first, last)| last - first);
            if seconds < SHORTEST_S {
                return Err(RobotError::Short { log: self.name.clone(), seconds });
            }
        }
        Ok(())
    }
}

impl Channel {
    /// Returns the torques as values that change linearly from sample to sample; `None` if they were not recorded.
    ///
    /// A controller's output that keeps its last sample acts half a sampling interval later than it was written, which would
    /// pass for damping. Its mean over the intervals on both sides of a sample has the right time.
    #[must_use]
    pub fn linear_torques(&self, hold: Hold) -> Option<Vec<f64>> {
        let torques = self.torques.as_ref()?;
        if hold != Hold::Zero {
            return Some(torques.clone());
        }
        let before = torques.first().into_iter().chain(torques);
        Some(before.zip(torques).map(|(before, own)| 0.5 * (before + own)).collect())
    }
}
