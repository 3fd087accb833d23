//! Time of a simulated record: 25 s at 260 Hz with friction, drag and gravity, through the measurement chain
//! of an encoder.

#![allow(missing_docs, clippy::expect_used, reason = "a benchmark")]

use settings::Document;
use simulator::{Plan, csv_text};

const RIG: &str = r#"
[nominal]
inertia = 5e-4
damping = 1.1e-4
stiffness = 0.23653
[start]
position = 0.63
[sensor]
noise = 3e-4
[[effects]]
id = "coulomb_friction"
parameters.torque = 9.5e-5
[[effects]]
id = "quadratic_drag"
parameters.coefficient = 5e-6
[[effects]]
id = "gravity"
parameters = { torque = 2e-3, angle = 1.57 }
[[effects]]
id = "sensor_quantization"
parameters.step = 1.534e-3
[[effects]]
id = "timestamp_batching"
parameters = { interval = 0.062, scatter = 0.003 }
"#;

fn plan() -> Plan {
    let document = Document::parse("bench", RIG).expect("the text above is TOML");
    Plan::resolve(&document).expect("the configuration above is complete")
}

#[divan::bench]
fn one_record(bencher: divan::Bencher<'_, '_>) {
    let plan = plan();
    // Checked before it is timed: a whole record, on the encoder's lattice, in bursts.
    let (record, sealed) = plan.record(0, 0).expect("the rig can be simulated");
    assert_eq!(record.len(), 6_500);
    assert!((record.lattice().expect("an encoder").step / 1.534e-3 - 1.0).abs() < 1e-3);
    assert_eq!(simulator::generate(&sealed.open().expect("sealed")).expect("again"), record);
    bencher.bench(|| plan.record(0, 0));
}

#[divan::bench]
fn its_text(bencher: divan::Bencher<'_, '_>) {
    let (record, _) = plan().record(0, 0).expect("the rig can be simulated");
    assert_eq!(csv_text(&record, 3, 6).lines().count(), 6_500 + 3);
    bencher.bench(|| csv_text(&record, 3, 6));
}

fn main() {
    divan::main();
}
