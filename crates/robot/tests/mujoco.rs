//! Ten random trees against MuJoCo; `experiments/arms/mujoco_reference.py` made models and numbers.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use robot::{Model, Urdf};
use serde_json::Value;

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|own| own.as_f64().unwrap()).collect()
}

#[test]
fn mass_matrices_and_bias_forces_are_those_of_mujoco() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models");
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
    let reference: Value = serde_json::from_str(&read("mujoco.json")).unwrap();
    let mut compared = 0;
    for case in reference["cases"].as_array().unwrap() {
        let name = case["urdf"].as_str().unwrap();
        let joints: Vec<&str> =
            case["joints"].as_array().unwrap().iter().map(|own| own.as_str().unwrap()).collect();
        let armatures: Vec<(String, f64)> =
            joints.iter().map(|own| (*own).to_owned()).zip(numbers(&case["armature"])).collect();
        let model = Urdf::parse(name, &read(name)).unwrap().with_armatures(&armatures).unwrap();
        let own: Vec<&str> = model.joints().iter().map(|joint| joint.name.as_str()).collect();
        assert_eq!(own, joints, "{name}: the order of the joints");
        for state in case["states"].as_array().unwrap() {
            let (position, velocity) = (numbers(&state["position"]), numbers(&state["velocity"]));
            let matrix = model.mass_matrix(&position).unwrap();
            for (row, expected) in matrix.iter().zip(state["mass_matrix"].as_array().unwrap()) {
                for (own, expected) in row.iter().zip(numbers(expected)) {
                    assert!((own - expected).abs() < 1e-10, "{name}: {own} {expected}");
                    compared += 1;
                }
            }
            let bias = model.bias(&position, &velocity).unwrap();
            for (own, expected) in bias.iter().zip(numbers(&state["bias"])) {
                assert!((own - expected).abs() < 1e-10 * (1.0 + expected.abs()), "{name}: {own} {expected}");
            }
        }
    }
    assert_eq!(compared, 3 * 2 * (4 + 9 + 16 + 25 + 36));
}
