//! Tests from configurations to records.

use crate::{Plan, csv_text, generate, nominal_text};
use dynamics::Nominal;
use record::{Clock, ClockChoice, ClockKind, ReadOptions, Record, read_text};
use settings::Document;
use std::collections::BTreeSet;

/// The rig in short: an oscillator at 21.75 rad/s with dry friction, observed by an encoder in bursts.
const RIG: &str = r#"
seed = 3
[record]
rate_hz = 259.6
seconds = 12
stamp_decimals = 3
[nominal]
inertia = 1.0
damping = 0.22
stiffness = 473.0625
[start]
position = 0.6
[sensor]
noise = 3e-4
[[effects]]
id = "coulomb_friction"
parameters.torque = 0.19
[[effects]]
id = "sensor_quantization"
parameters.step = 1.534e-3
[[effects]]
id = "timestamp_batching"
parameters = { interval = 0.062, scatter = 0.003 }
"#;

fn plan_of(text: &str, overrides: &[&str]) -> Result<Plan, String> {
    let mut document = Document::parse("a.toml", text).map_err(|error| error.to_string())?;
    for argument in overrides {
        document.apply_override(argument).unwrap();
    }
    Plan::resolve(&document).map_err(|error| error.to_string())
}

fn plan(text: &str, overrides: &[&str]) -> Plan {
    plan_of(text, overrides).unwrap()
}

fn record(text: &str, overrides: &[&str]) -> Record {
    plan(text, overrides).record(0, 0).unwrap().0
}

#[test]
fn the_same_seed_gives_the_same_bits_and_another_does_not() {
    assert_eq!(record(RIG, &[]), record(RIG, &[]));
    assert_ne!(record(RIG, &[]).values(), record(RIG, &["seed=4"]).values());
    let several = plan(RIG, &["simulate.systems=2", "simulate.records=2"]);
    assert_eq!(several.record(0, 0).unwrap().0, record(RIG, &[]));
    assert_ne!(several.record(1, 0).unwrap().0, several.record(0, 0).unwrap().0);
    assert_ne!(several.record(0, 1).unwrap().0, several.record(0, 0).unwrap().0);
}

#[test]
fn a_truth_gives_its_record_again() {
    let (made, sealed) = plan(RIG, &[]).record(0, 0).unwrap();
    let truth = sealed.open().unwrap();
    assert_eq!(generate(&truth).unwrap(), made);
    let ids: Vec<&str> =
        truth.system.effects().iter().chain(truth.chain.effects()).map(|active| active.id()).collect();
    assert_eq!(ids, ["coulomb_friction", "sensor_quantization", "timestamp_batching"]);
}

#[test]
fn its_file_reads_back_to_the_bit() {
    let cases: [&[&str]; 3] = [
        &[],
        &["record.value_decimals=12", "record.stamp_decimals=12", "record.first_stamp_s=-3.3"],
        &["input.waveform=chirp", "input.amplitude=3"],
    ];
    for overrides in cases {
        let plan = plan(RIG, overrides);
        let made = plan.record(0, 0).unwrap().0;
        let text = csv_text(&made, plan.sampling().stamp_decimals, plan.sampling().value_decimals);
        let (read, source) = read_text("a.csv", text.as_bytes(), &ReadOptions::default()).unwrap();
        assert_eq!(read, made);
        assert_eq!(source.statements.origin.unwrap().name(), "simulated");
    }
}

/// The record's own detection of clocks: bursts are receive times, and regression finds the sensor's rate.
#[test]
fn bursts_are_seen_through() {
    let mut inside = 0;
    for seed in 0..20 {
        let made = record(RIG, &[&format!("seed={seed}"), "record.seconds=25"]);
        let clock = Clock::new(&made, ClockChoice::Auto).unwrap();
        assert_eq!(clock.kind, ClockKind::UniformIndex, "{}", clock.reason);
        let statistics = &clock.statistics;
        assert!(statistics.repeated > made.len() * 9 / 10 && statistics.rounding_s == Some(1e-3));
        assert!((statistics.group_interval_s - 0.062).abs() < 0.002);
        let off = (clock.sample_rate_hz - 259.6).abs();
        assert!(off < 5.0 * clock.sample_rate_std_error_hz, "{off} {}", clock.sample_rate_std_error_hz);
        inside += i32::from(off < 1.96 * clock.sample_rate_std_error_hz);
    }
    // 95 % of twenty; fewer than 15 would happen once in 3000 times.
    assert!(inside >= 15, "{inside} of 20 intervals hold the true rate");
}

#[test]
fn the_lattice_of_the_encoder_is_in_the_file() {
    let lattice = record(RIG, &[]).lattice().unwrap();
    assert!((lattice.step / 1.534e-3 - 1.0).abs() < 1e-3, "{lattice:?}");
}

#[test]
fn an_input_is_written_beside_the_motion() {
    let driven = record(RIG, &["input.waveform=sine", "input.frequency_hz=2", "input.amplitude=5"]);
    let input = driven.input().unwrap();
    assert_eq!(input.len(), driven.len());
    let largest = input.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    assert!((largest - 5.0).abs() < 1e-2);
    assert!(record(RIG, &[]).input().is_none());
}

#[test]
fn lost_samples_take_their_input_along() {
    let text = format!("{RIG}[[effects]]\nid = 'dropouts'\nparameters = {{ share = 0.2, length = 3 }}\n");
    let driven = record(&text, &["input.waveform=square"]);
    let complete = record(RIG, &["input.waveform=square"]);
    assert!(driven.len() < complete.len() * 9 / 10);
    assert_eq!(driven.input().unwrap().len(), driven.len());
}

const PRIORS: &str = r#"
[simulate]
systems = 400
effects_per_system = 1
[record]
seconds = 0.2
[nominal]
inertia = 5e-4
damping = { mean = 1.9e-4, deviation = 1e-5 }
stiffness = { from = 0.2, to = 0.3 }
[calibration]
stiffness = 0.02
[start]
position = { from = 0.3, to = 0.7 }
[[effects]]
id = "coulomb_friction"
parameters.torque = { from = 1e-5, to = 1e-4, scale = "log" }
[[effects]]
id = "quadratic_drag"
probability = 0.5
parameters.coefficient = 1e-5
[[effects]]
id = "sensor_drift"
probability = 0
parameters.rate = 1e-3
"#;

#[test]
fn so_many_effects_are_drawn_by_their_weights() {
    let plan = plan(PRIORS, &[]);
    let systems: Vec<_> = (0..400).map(|index| plan.draw(index).unwrap().truths.remove(0).system).collect();
    assert!(systems.iter().all(|system| system.effects().len() == 1));
    let friction = systems.iter().filter(|system| system.effects()[0].id() == "coulomb_friction").count();
    // Two of three: 267 ± 9.4.
    assert!(friction.abs_diff(267) < 38, "{friction}");
    let stiffness = systems.iter().map(|system| system.nominal().stiffness().to_bits());
    assert_eq!(stiffness.collect::<BTreeSet<_>>().len(), 400);
}

#[test]
fn effects_come_with_their_probabilities() {
    let mut text = PRIORS.replace("effects_per_system = 1\n", "");
    text = text.replace("probability = 0\n", "probability = 1\n");
    let plan = plan(&text, &[]);
    let truths: Vec<_> = (0..400).map(|index| plan.draw(index).unwrap().truths.remove(0)).collect();
    let having = |id: &str| {
        truths.iter().filter(|truth| truth.system.effects().iter().any(|active| active.id() == id)).count()
    };
    assert_eq!(having("coulomb_friction"), 400);
    assert!(truths.iter().all(|truth| truth.chain.effects().count() == 1));
    // 200 ± 10.
    assert!(having("quadratic_drag").abs_diff(200) < 40, "{}", having("quadratic_drag"));
}

/// An additional effect does not change the draws of the others.
#[test]
fn a_further_effect_changes_no_other_number() {
    let text = PRIORS.replace("effects_per_system = 1\n", "");
    let longer =
        format!("{text}[[effects]]\nid = \"gravity\"\nparameters = {{ torque = 1e-3, angle = 0.1 }}\n");
    let (short, long) = (plan(&text, &[]).draw(7).unwrap(), plan(&longer, &[]).draw(7).unwrap());
    assert_eq!(short.nominal, long.nominal);
    let (short, long) = (&short.truths[0].system, &long.truths[0].system);
    assert_eq!(short.effects(), &long.effects()[..short.effects().len()]);
    assert_eq!(long.effects().len(), short.effects().len() + 1);
}

#[test]
fn what_is_believed_is_off_by_the_calibration_error() {
    let plan = plan(PRIORS, &[]);
    let ratios: Vec<f64> = (0..400)
        .map(|index| {
            let drawn = plan.draw(index).unwrap();
            let is = drawn.truths[0].system.nominal();
            assert_eq!(drawn.nominal.damping(), is.damping());
            drawn.nominal.stiffness() / is.stiffness() - 1.0
        })
        .collect();
    let spread = (ratios.iter().map(|x| x * x).sum::<f64>() / 400.0).sqrt();
    assert!((spread / 0.02 - 1.0).abs() < 4.0 / 800_f64.sqrt(), "{spread}");
}

#[test]
fn a_nominal_survives_its_text_and_can_be_simulated() {
    let drawn = plan(PRIORS, &["nominal.sensor_resolution=0.0015"]).draw(3).unwrap();
    let text = nominal_text(&drawn.nominal);
    let start = plan(&text, &["start.position=0.5", "record.seconds=0.1"]);
    assert_eq!(start.draw(0).unwrap().nominal, drawn.nominal, "{text}");
    let displacement = "coordinate = 'displacement'\ninertia = 95.0\ndamping = 203.5\nstiffness = 0.0\n\
                        rest_angle = 0.0\ninput_gain = 35.1506519\n";
    let drive = plan(displacement, &["start.position=0", "input.waveform=sine"]);
    let nominal: Nominal = drive.draw(0).unwrap().nominal;
    assert_eq!(nominal.input_gain(), 35.150_651_9);
    assert_eq!(drive.record(0, 0).unwrap().0.unit(), "m");
}

/// A repaired simulator, as a diagnosis would write it: nominal oscillator and effects.
#[test]
fn a_system_written_as_toml_is_a_configuration() {
    let text = "[nominal]\ninertia = 5e-4\ndamping = 1.9e-4\nstiffness = 0.238\nrest_angle = 0.01\n\
                [[effects]]\nid = 'coulomb_friction'\n[effects.parameters]\ntorque = 7e-5\n";
    let truth = plan(text, &["start.position=0.5", "record.seconds=0.1"]).draw(0).unwrap().truths.remove(0);
    assert_eq!(truth.system.nominal().rest_angle(), 0.01);
    assert_eq!(truth.system.effects()[0].value("torque"), Some(7e-5));
}

#[test]
fn the_resolved_text_draws_the_same_systems() {
    let first = plan(PRIORS, &["effects.1.parameters.torque.to=2e-4", "nominal.stiffness=0.25"]);
    let second = plan(&first.resolved.to_toml(), &[]);
    for index in [0, 5, 399] {
        assert_eq!(first.draw(index).unwrap(), second.draw(index).unwrap(), "{}", first.resolved.to_toml());
    }
}

#[test]
fn mistakes_are_pointed_at() {
    let message = |old: &str, new: &str| {
        assert!(PRIORS.contains(old), "{old}");
        plan_of(&PRIORS.replacen(old, new, 1), &[]).unwrap_err()
    };
    for (old, new, expected) in [
        (
            "\"quadratic_drag\"",
            "\"quadratic_drug\"",
            "a.toml:19:1: unknown effect \"quadratic_drug\"; did you mean `quadratic_drag`?",
        ),
        (
            "\"quadratic_drag\"",
            "\"coulomb_friction\"",
            "`effects.2.id` is \"coulomb_friction\" again; expected each effect once",
        ),
        (
            "parameters.coefficient",
            "parameters.coeficient",
            "unknown key `effects.2.parameters.coeficient`; did you mean `effects.2.parameters.coefficient`?",
        ),
        ("parameters.coefficient = 1e-5\n", "", "`effects.2.parameters.coefficient` is missing"),
        (
            "parameters.coefficient = 1e-5",
            "parameters.coefficient = -1",
            "`effects.2.parameters.coefficient` is -1; expected a finite number from 0 up (N m s^2/rad^2)",
        ),
        (
            "inertia = 5e-4",
            "inertia = 0",
            "a.toml:8:1: `nominal.inertia` is 0; expected a finite number above 0 (kg m^2)",
        ),
        (
            "id = \"quadratic_drag\"\n",
            "",
            "`effects.2.id` is missing: The effect, as `trainer list effects` names it.",
        ),
        (
            "{ from = 0.2, to = 0.3 }",
            "{ from = 0.4, to = 0.3 }",
            "`nominal.stiffness` is { from = 0.4, to = 0.3 }; expected a number, or a prior",
        ),
        (
            "{ from = 0.2, to = 0.3 }",
            "{ from = 0.2, too = 0.3 }",
            "unknown key `nominal.stiffness.too`; did you mean `nominal.stiffness.to`?",
        ),
        (
            "{ from = 0.2, to = 0.3 }",
            "{ from = -0.2, to = 0.3 }",
            "`nominal.stiffness.from` is -0.2; expected a finite number of 0 or above (N m/rad)",
        ),
        ("from = 1e-5, to = 1e-4, scale", "from = 0.0, to = 1e-4, scale", "with scale = \"log\" above 0"),
        (
            "effects_per_system = 1",
            "effects_per_system = 3",
            "`simulate.effects_per_system` is 3; expected at most 2",
        ),
        ("position = { from = 0.3, to = 0.7 }", "", "`start.position` is missing"),
        (
            "mean = 1.9e-4, deviation = 1e-5",
            "mean = -1.9e-4, deviation = 1e-5",
            "`nominal.damping.mean` is -0.00019; expected a finite number of 0 or above",
        ),
        (
            "probability = 0\nparameters.rate = 1e-3",
            "probability = 0\nparameters.rat = 1e-3",
            "did you mean `effects.3.parameters.rate`?",
        ),
        ("seconds = 0.2", "second = 0.2", "unknown key `record.second`; did you mean `record.seconds`?"),
    ] {
        let found = message(old, new);
        assert!(found.contains(expected), "{found}");
    }
    let text = format!(
        "{RIG}[[effects]]\nid = 'clock_drift'\nparameters.change = 0\nparameters.rate = {{ mean = 0, deviation = 9 }}\n"
    );
    let wide = plan_of(&text, &[]).unwrap_err();
    assert!(wide.contains("`effects.4.parameters.rate.deviation` is 9; expected at most 1.5"), "{wide}");
    let gyroscope = plan_of(RIG, &["sensor.observes=velocity", "sensor.noise=-1"]).unwrap_err();
    assert!(gyroscope.contains("from 0 up (rad/s)"), "{gyroscope}");
    let impossible = |overrides: &[&str]| plan(RIG, overrides).record(0, 0).unwrap_err().to_string();
    assert!(impossible(&["effects.3.parameters.interval=1e-3"]).contains("holds zero samples"));
    assert!(impossible(&["record.rate_hz=1e9", "record.seconds=1e6"]).contains("samples is"));
}

/// A second body that starts elsewhere pulls with its spring from the beginning: k₂·(ψ − θ) = 0.2·(0.1 − 0.5) N m on 2e-3 kg m².
#[test]
fn a_second_body_starts_where_it_is_stated() {
    let text = r#"task = "simulate"
[record]
rate_hz = 1000.0
seconds = 0.1
[nominal]
inertia = 2e-3
damping = 0.0
stiffness = 0.3
[start]
position = 0.5
[sensor]
noise = 0.0
[[effects]]
id = "flexible_coupling"
parameters.inertia = 1e-4
parameters.stiffness = 0.2
parameters.damping = 0.0
"#;
    let second = |text: &str| {
        let (record, _) = plan(text, &[]).record(0, 0).unwrap();
        (record.values()[1] - record.values()[0]) / (0.5 * 1e-6)
    };
    let [relaxed, apart] = [text.to_owned(), format!("{text}start = [0.1, 0.0]\n")].map(|text| second(&text));
    assert!((relaxed + 0.3 * 0.5 / 2e-3).abs() < 0.1, "{relaxed}");
    assert!((apart - relaxed + 0.2 * 0.4 / 2e-3).abs() < 0.1, "{apart} {relaxed}");
    let short = plan(&format!("{text}start = [0.1]\n"), &[]).record(0, 0).unwrap_err();
    assert!(short.to_string().contains("`flexible_coupling` has 2 hidden states, not 1"), "{short}");
}
