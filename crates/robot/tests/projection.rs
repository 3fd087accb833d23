//! Tests of the projection of a recording onto one joint.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]

use dynamics::Hold;
use dynamics::tree::{Acting, State, Tree, rollout};
use robot::{
    Along, Channel, Foreign, Model, Recording, RobotError, Simulator, Urdf, Variant, closed_loop,
    coefficients, project,
};
use serde_json::{Value, json};

const ARM: &str = r#"<robot name="arm">
<link name="base"/>
<link name="upper"><inertial><origin xyz="0 0 -0.25"/><mass value="0.8"/><inertia ixx="0.006" iyy="0.006" izz="0.001"/></inertial></link>
<link name="lower"><inertial><origin xyz="0 0 -0.2"/><mass value="0.5"/><inertia ixx="0.004" iyy="0.004" izz="0.001"/></inertial></link>
<joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/></joint>
<joint name="elbow" type="continuous"><parent link="upper"/><child link="lower"/><origin xyz="0 0 -0.3"/><axis xyz="0 1 0"/></joint>
</robot>"#;

/// Seconds between samples.
const STEP: f64 = 0.01;

fn arm() -> Urdf {
    Urdf::parse("arm.urdf", ARM).unwrap()
}

/// Returns a recording of 10 s of the arm under torques that keep their last sample, or change linearly.
fn recorded(tree: &Tree, hold: Hold) -> Recording {
    let times: Vec<f64> = (0..1000).map(|at| f64::from(at) * STEP).collect();
    let torque = |t: f64| {
        vec![
            0.9 * (3.0 * t).sin() + 0.8 * (9.3 * t).sin(),
            0.35 * (5.5 * t + 1.0).sin() + 0.25 * (12.1 * t).cos(),
        ]
    };
    // A step between samples: the torque jumps there within a hundredth of the interval.
    let fine: Vec<(f64, Vec<f64>)> = match hold {
        Hold::Zero => times.iter().flat_map(|t| [(*t, torque(*t)), (t + 0.99 * STEP, torque(*t))]).collect(),
        _ => times.iter().map(|t| (*t, torque(*t))).collect(),
    };
    let (at, torques): (Vec<f64>, Vec<Vec<f64>>) = fine.into_iter().unzip();
    let damped = vec![Acting { damping: 0.2, ..Acting::default() }; 2];
    let start = State { position: vec![0.3, -0.2], velocity: vec![0.0; 2] };
    let path = rollout(tree, &damped, &start, &at, &torques).unwrap();
    let every = at.len() / times.len();
    let channel = |joint: usize| Channel {
        times: times.clone(),
        positions: path.iter().step_by(every).map(|own| own[joint]).collect(),
        torques: Some(times.iter().map(|t| torque(*t)[joint]).collect()),
    };
    Recording { name: "log".into(), joints: vec![channel(0), channel(1)] }
}

#[test]
fn a_torque_that_keeps_its_last_sample_is_told_from_one_that_does_not() {
    let arm = arm();
    for hold in [Hold::Zero, Hold::Linear] {
        let along = Along::of(&arm, recorded(arm.tree(), hold)).unwrap();
        for joint in 0..2 {
            let found = project(arm.joints(), &[&along], joint, 1.0).unwrap();
            assert_eq!(found.hold, hold, "joint {joint}");
        }
    }
}

/// Coefficients come with their errors, so that chance is not taken for a difference.
#[test]
fn one_recording_tells_the_coefficients_of_a_joint_with_their_errors() {
    let arm = arm();
    let along = Along::of(&arm, recorded(arm.tree(), Hold::Linear)).unwrap();
    for joint in 0..2 {
        for own in coefficients(arm.joints(), &along, joint).unwrap() {
            let truth = if own.quantity == "damping" { 0.2 } else { 0.0 };
            let scale = match own.quantity {
                "dry_friction" => 0.02,
                "damping" => 0.02,
                "armature" => 0.003,
                _ => 0.05,
            };
            assert!(
                (own.value - truth).abs() < scale && own.error < scale && own.error > 0.0,
                "{joint} {own:?}"
            );
        }
    }
}

/// Half a sampling interval of delay would drive this arm off by far more.
#[test]
fn the_whole_model_follows_a_held_torque() {
    let arm = arm();
    let along = Along::of(&arm, recorded(arm.tree(), Hold::Zero)).unwrap();
    let damped = vec![Acting { damping: 0.2, ..Acting::default() }; 2];
    let error = |hold: Hold| {
        let variant = Variant { acting: &damped, holds: &[hold; 2], gains: &[1.0; 2] };
        let found = closed_loop(&arm, variant, &along, (3.0, 0.0..1.0)).unwrap();
        found.joints.unwrap()[1].rms().unwrap()
    };
    let (held, linear) = (error(Hold::Zero), error(Hold::Linear));
    assert!(held < 0.003 && held < 0.2 * linear, "{held} {linear}");
}

/// Another program that computes what the URDF says.
struct Elsewhere {
    arm: Urdf,
    rolls: bool,
}

impl Simulator for Elsewhere {
    fn ask(&self, question: &str) -> Result<String, String> {
        let asked: Value = serde_json::from_str(question).map_err(|error| error.to_string())?;
        let rows = |name: &str| -> Vec<Vec<f64>> { serde_json::from_value(asked[name].clone()).unwrap() };
        let answer = match asked["do"].as_str() {
            Some("describe") => {
                let joint = |name: &str| json!({ "name": name, "slides": false, "damping": 0.0, "friction": 0.0, "armature": 0.1, "stiffness": 0.0 });
                json!({ "joints": [joint("shoulder"), joint("elbow")], "rollout": self.rolls })
            }
            Some("along") => {
                let states: Vec<State> = rows("positions")
                    .into_iter()
                    .zip(rows("velocities"))
                    .map(|(position, velocity)| State { position, velocity })
                    .collect();
                let (mass, bias) = self.arm.along(&states).unwrap();
                json!({ "mass": mass, "bias": bias })
            }
            Some("rollout") => {
                let damping = asked["parameters"]["elbow"]["damping"].as_f64().unwrap();
                json!({ "positions": rows("torques").iter().map(|_| vec![0.0, damping]).collect::<Vec<_>>() })
            }
            _ => return Err("the simulator is not at home".to_owned()),
        };
        Ok(answer.to_string())
    }
}

#[test]
fn a_simulator_elsewhere_gives_the_same_joint_and_runs_itself() {
    let arm = arm();
    let recording = recorded(arm.tree(), Hold::Linear);
    let foreign = |rolls| Foreign::new(Box::new(Elsewhere { arm: arm.clone(), rolls })).unwrap();
    let along = Along::of(&foreign(false), recording.clone()).unwrap();
    let own = project(arm.joints(), &[&Along::of(&arm, recording).unwrap()], 0, 1.0).unwrap();
    assert_eq!(project(arm.joints(), &[&along], 0, 1.0).unwrap(), own);
    let damped = vec![Acting { damping: 0.2, ..Acting::default() }; 2];
    let (start, times) = (State { position: vec![0.3, 0.0], velocity: vec![0.0; 2] }, [0.0, 0.1]);
    let torques = vec![vec![0.1, 0.0]; 2];
    let path = foreign(false).rollout(&damped, &start, &times, &torques).unwrap();
    assert_eq!(path, arm.rollout(&damped, &start, &times, &torques).unwrap());
    assert_eq!(foreign(true).rollout(&damped, &start, &times, &torques).unwrap(), vec![vec![0.0, 0.2]; 2]);
    // Of an armature, the file's is the part that is there already.
    let heavier = foreign(false).with_armatures(&[("elbow".into(), 0.5)]).unwrap();
    assert_eq!(heavier.joints()[1].armature, Some(0.6));
    let by = heavier.mass_matrix(&[0.0; 2]).unwrap()[1][1] - arm.mass_matrix(&[0.0; 2]).unwrap()[1][1];
    assert!((by - 0.5).abs() < 1e-12, "{by}");
}

#[test]
fn a_simulator_that_answers_with_another_size_is_refused() {
    struct Wrong;
    impl Simulator for Wrong {
        fn ask(&self, question: &str) -> Result<String, String> {
            Ok(if question.contains("describe") {
                r#"{"joints": [{"name": "a", "slides": false, "damping": 0, "friction": 0, "armature": 0, "stiffness": 0}], "rollout": false}"#.to_owned()
            } else {
                r#"{"mass": [[[1, 0], [0, 1]]], "bias": [[0]]}"#.to_owned()
            })
        }
    }
    let channel = Channel {
        times: (0..200).map(|at| f64::from(at) * STEP).collect(),
        positions: (0..200).map(|at| (f64::from(at) * 0.05).sin()).collect(),
        torques: None,
    };
    let recording = Recording { name: "log".into(), joints: vec![channel] };
    let error = Along::of(&Foreign::new(Box::new(Wrong)).unwrap(), recording).unwrap_err();
    assert!(matches!(error, RobotError::Model { quantity: "mass matrix", .. }), "{error}");
}
