//! Runs the exported models in their programs and compares the motion with our own simulation: within 1 % of
//! its RMS.
//!
//! If Python, SciPy or MuJoCo are not installed, the tests report it and check nothing.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::print_stderr,
    clippy::disallowed_methods,
    reason = "tests"
)]

use dynamics::chain::Observed;
use dynamics::reference::{Tolerance, simulate};
use dynamics::sensitivity::{FullState, Model, Settings};
use dynamics::{
    Active, Coordinate, Effect, Hold, Input, Nominal, Parameter, REGISTRY, Start, System, UNNAMED, Units,
};
use export::{Repaired, mjcf, modelica, python, urdf};
use std::process::Command;

const RATE: f64 = 100.0;
const SECONDS: f64 = 8.0;
/// Inertia in kg m^2.
const INERTIA: f64 = 5e-4;

/// Values at which these effects change the motion of this body by many times 1 %; of all others, the examples do.
const CASES: &[(&str, &[f64])] = &[
    ("coulomb_friction", &[6e-4]),
    ("stribeck_friction", &[3e-4, 1e-3, 1.0]),
    ("quadratic_drag", &[2e-5]),
    ("cubic_stiffness", &[-0.05]),
    ("asymmetric_stiffness", &[0.08]),
    ("gravity", &[0.1, 0.6]),
    ("constant_torque", &[0.02]),
    ("backlash", &[0.03]),
    ("hysteresis", &[2e-3, 0.05]),
    ("end_stop", &[0.35, 2.0, 0.02]),
    ("stiffness_drift", &[0.01]),
    ("damping_drift", &[0.5]),
    ("periodic_forcing", &[5e-3, 14.0, 0.4]),
    ("flexible_coupling", &[5e-5, 0.05, 2e-5]),
    ("input_delay", &[0.05]),
    ("input_saturation", &[8e-3]),
    ("command_derivative", &[0.03]),
    ("torque_limit", &[0.06]),
    ("load_friction", &[3e-4, 0.01]),
    ("directional_friction", &[6e-4, 4e-4]),
    ("friction_drift", &[6e-4, 0.2]),
    ("drive_dead_band", &[0.03]),
    ("speed_torque_limit", &[0.09, 8.0]),
];

/// Returns the case of an effect: its values for a body of the inertia [`INERTIA`].
fn case(id: &str) -> (&'static str, &'static [f64]) {
    let effect = Effect::find(id).unwrap().description();
    let scaled = |(parameter, value): (&Parameter, &f64)| {
        let unit = |units: fn(Coordinate) -> Units| parameter.quantity.unit(units(Coordinate::Angle));
        if unit(Units::Si) == unit(Units::PerInertia) { *value } else { value * INERTIA }
    };
    let example = || effect.parameters.iter().zip(effect.example).map(scaled).collect::<Vec<_>>().leak();
    let own = CASES.iter().find(|(own, _)| *own == id);
    (effect.id, own.map_or_else(|| &*example(), |(_, values)| values))
}

/// Returns the cases of all effects in the system.
fn all_cases() -> Vec<(&'static str, &'static [f64])> {
    let in_system = REGISTRY.iter().chain(UNNAMED).filter(|effect| matches!(effect, Effect::System(_)));
    in_system.map(|effect| case(effect.id())).collect()
}

fn is_driven(id: &str) -> bool {
    Effect::find(id).unwrap().description().driven_only
}

fn repaired(effects: &[(&str, &[f64])]) -> Repaired {
    of_size(1.0, effects)
}

/// Returns a body `size` times as large with the same motion.
fn of_size(size: f64, effects: &[(&str, &[f64])]) -> Repaired {
    let nominal = Nominal::new(size * INERTIA, size * 1.9e-4, size * 0.238, 0.02).unwrap();
    let active = effects.iter().map(|(id, values)| Active::new(id, values).unwrap()).collect();
    Repaired {
        system: System::new(nominal, active).unwrap(),
        units: nominal.units(),
        chain: Vec::new(),
        left_out: Vec::new(),
        input: effects.iter().any(|(id, _)| is_driven(id)).then_some(Hold::Zero),
        start: Start { position: 0.5, velocity: 1.0 },
        hidden_starts: Vec::new(),
        observed: Observed::Position,
        noise: 0.0,
        rate_hz: RATE,
        seconds: SECONDS,
    }
}

fn times() -> Vec<f64> {
    (0..(RATE * SECONDS) as usize).map(|index| index as f64 / RATE).collect()
}

/// Returns the input of driven cases. `own` interpolates it between knots that are dense enough to be as good
/// as the formula.
fn drive(time: f64) -> f64 {
    0.012 * (17.0 * time).sin()
}

fn own(repaired: &Repaired) -> Vec<f64> {
    let knots: Vec<f64> = (0..40_000).map(|index| f64::from(index) * SECONDS / 40_000.0).collect();
    let values = knots.iter().map(|time| drive(*time)).collect();
    let input = Input::new(knots, values, Hold::Linear).unwrap();
    let input = repaired.driven().then_some(&input);
    simulate(&repaired.system, repaired.start, input, &times(), &Tolerance::default()).unwrap().position
}

/// Returns the RMS of the difference over the RMS of the motion about its mean.
fn distance(found: &[f64], own: &[f64]) -> f64 {
    assert_eq!(found.len(), own.len());
    let mean = own.iter().sum::<f64>() / own.len() as f64;
    let squares: f64 = found.iter().zip(own).map(|(a, b)| (a - b).powi(2)).sum();
    (squares / own.iter().map(|b| (b - mean).powi(2)).sum::<f64>()).sqrt()
}

/// Returns an empty folder of this name below cargo's folder for tests.
fn scratch(name: &str) -> std::path::PathBuf {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    if folder.exists() {
        std::fs::remove_dir_all(&folder).unwrap();
    }
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// Runs a script with a folder as its argument; each printed line holds the positions of one case. Reports it
/// and returns `None` if the script's imports are missing.
fn run(script: &str, folder: &std::path::Path, needs: &str) -> Option<Vec<Vec<f64>>> {
    let there = Command::new("python3").args(["-c", needs]).output();
    if !there.is_ok_and(|output| output.status.success()) {
        eprintln!("SKIPPED, NOTHING CHECKED: `python3 -c \"{needs}\"` fails; install it with pip");
        return None;
    }
    let output = Command::new("python3").args(["-c", script]).arg(folder).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    Some(text.lines().map(|line| serde_json::from_str(line).unwrap()).collect())
}

const SCIPY: &str = r#"
import importlib.util, json, math, pathlib, sys
times = [index / 100.0 for index in range(800)]
for path in sorted(pathlib.Path(sys.argv[1]).glob("*.py")):
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    positions, _ = module.simulate(times, lambda time: 0.012 * math.sin(17.0 * time))
    print(json.dumps(list(positions)))
"#;

const MUJOCO: &str = r#"
import json, mujoco, pathlib, sys
for path in sorted(pathlib.Path(sys.argv[1]).glob("*.xml")):
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    positions, before = [], (data.time, data.qpos[0])
    for index in range(800):
        time = index / 100.0
        while data.time < time:
            before = (data.time, data.qpos[0])
            mujoco.mj_step(model, data)
        now = (data.time, data.qpos[0])
        share = (time - before[0]) / (now[0] - before[0]) if now[0] > before[0] else 1.0
        positions.append(before[1] + share * (now[1] - before[1]))
    print(json.dumps(positions))
"#;

#[test]
fn the_python_function_moves_as_our_own_simulation_does() {
    let folder = scratch("scipy");
    let mut cases: Vec<Vec<(&str, &[f64])>> = all_cases().into_iter().map(|case| vec![case]).collect();
    cases.push(Vec::new());
    cases.push(["coulomb_friction", "gravity", "quadratic_drag"].map(case).to_vec());
    for (index, case) in cases.iter().enumerate() {
        let name = folder.join(format!("case_{index:02}.py"));
        std::fs::write(name, python(&repaired(case))).unwrap();
    }
    std::fs::write(folder.join("hidden.py"), python(&beating())).unwrap();
    let Some(found) = run(SCIPY, &folder, "import scipy.integrate") else { return };
    assert_eq!(found.len(), cases.len() + 1);
    holds_both_modes(found.last().unwrap());
    let bare = own(&repaired(&[]));
    for (case, found) in cases.iter().zip(&found) {
        let own = own(&repaired(case));
        let off = distance(found, &own);
        assert!(off < 0.01, "{case:?}: {off}");
        if let [(id, _)] = case.as_slice()
            && !is_driven(id)
        {
            // Otherwise the agreement would say nothing about the effect.
            let moved = distance(&bare, &own);
            assert!(moved > 0.05, "{id}: {moved}");
        }
    }
}

/// Returns a swing whose second body moves against it at the start.
fn beating() -> Repaired {
    let coupling = ("flexible_coupling", &[5e-5, 0.02, 2e-6][..]);
    Repaired { hidden_starts: vec![("flexible_coupling", vec![-0.4, 2.0])], ..repaired(&[coupling]) }
}

/// Asserts that a motion is that of both bodies from their own starts, by the other of our integrators.
fn holds_both_modes(found: &[f64]) {
    let repaired = beating();
    let mut model = Model::new(&repaired.system, &[], Settings::default()).unwrap();
    let (along, mut hidden) = (FullState::from(repaired.start), [0.0; dynamics::SYSTEM_HIDDEN]);
    (hidden[0], hidden[1]) = (-0.4, 2.0);
    let own = model.run(FullState { hidden: Some(hidden), ..along }, None, &times()).unwrap().position;
    assert!(distance(found, &own) < 0.01, "{}", distance(found, &own));
    let relaxed = model.run(along, None, &times()).unwrap().position;
    assert!(distance(&relaxed, &own) > 0.1, "the start of the second body matters");
}

#[test]
fn the_mujoco_joint_moves_as_our_own_simulation_does() {
    let folder = scratch("mujoco");
    let all = ["coulomb_friction", "gravity", "constant_torque"].map(case);
    let [friction, gravity, constant] = all;
    let coupling = [case("flexible_coupling")];
    let cases: [&[(&str, &[f64])]; 6] = [&[], &[friction], &[gravity], &[constant], &all, &coupling];
    for (index, case) in cases.iter().enumerate() {
        let name = folder.join(format!("case_{index:02}.xml"));
        let text = mjcf(&repaired(case));
        assert!(!text.contains("Not part of it"), "{text}");
        std::fs::write(name, text).unwrap();
    }
    // A balance wheel and a smaller body: MuJoCo refuses bodies of less than 1e-15.
    std::fs::write(folder.join("case_06.xml"), mjcf(&of_size(1e-6, &[]))).unwrap();
    std::fs::write(folder.join("case_07.xml"), mjcf(&of_size(1e-9, &[]))).unwrap();
    std::fs::write(folder.join("hidden.xml"), mjcf(&beating())).unwrap();
    let Some(found) = run(MUJOCO, &folder, "import mujoco") else { return };
    assert_eq!(found.len(), cases.len() + 3);
    holds_both_modes(found.last().unwrap());
    for (case, found) in cases.iter().chain([&cases[0]; 2]).zip(&found) {
        let off = distance(found, &own(&repaired(case)));
        assert!(off < 0.01, "{case:?}: {off}");
    }
}

#[test]
fn what_a_joint_cannot_hold_is_said_and_never_dropped() {
    for (id, values) in all_cases() {
        let repaired = repaired(&[(id, values)]);
        let title = Effect::find(id).unwrap().description().title;
        for text in [mjcf(&repaired), urdf(&repaired)] {
            let held = text.contains("frictionloss") || text.contains("second_body");
            let held = held || ["constant_torque", "gravity"].contains(&id);
            let title = if id == "flexible_coupling" { "the second body" } else { title };
            let friction = text.contains("friction=\"0.0006\"");
            assert!(held || friction || text.contains(&format!("Not part of it: {title}")), "{text}");
        }
        assert!(python(&repaired).contains(title) || id == "input_delay", "{id}");
        assert!(modelica(&repaired).contains(title) || id == "input_delay", "{id}");
    }
}

#[test]
fn the_measuring_chain_is_said_to_be_left_out() {
    let mut repaired = repaired(&[]);
    repaired.chain = vec![Active::new("sensor_drift", &[1e-3]).unwrap()];
    repaired.left_out = vec!["stamps --\nin bursts".to_owned()];
    for text in [mjcf(&repaired), urdf(&repaired), python(&repaired), modelica(&repaired)] {
        assert!(text.contains("Sensor drift acts on the measurement, not on the motion"), "{text}");
        assert!(text.contains("in bursts"), "{text}");
    }
    for text in [mjcf(&repaired), urdf(&repaired)] {
        for comment in text.split("<!--").skip(1) {
            assert!(!comment.split_once("-->").unwrap().0.contains("--"), "{comment}");
        }
    }
}
