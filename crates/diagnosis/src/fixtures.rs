//! Simulated records as a logger would write them, for tests and benchmarks.

use dynamics::chain::Chain;
use dynamics::reference::{Tolerance, simulate};
use dynamics::{Coordinate, Start, System};
use record::{Quantity, Record};
use seed::Seed;

/// Returns a record of a system released at an angle in rad, with `samples` samples at 260 Hz, through a
/// measurement chain.
pub(crate) fn record(system: &System, release: f64, samples: u32, chain: &Chain, seed: u64) -> Record {
    let times: Vec<f64> = (0..samples).map(|i| f64::from(i) / 260.0).collect();
    let motion = simulate(system, Start::release(release), None, &times, &Tolerance::default()).unwrap();
    let seed = Seed::new(seed);
    let draws = |id: &str| seed.child(id).generator();
    let samples = chain.observe(&motion.sampled(&times), Coordinate::Angle, draws).unwrap();
    Record::new(samples.stamps_s, samples.values, None, Quantity::Position, "rad").unwrap()
}
