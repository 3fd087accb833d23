//! Tests of trees against formulas and against themselves.

use super::{Acting, Body, Inertia, JointMotion, Placement, State, Tree, TreeError, rollout};
use crate::Active;
use crate::scalar::Dual;

fn body(name: &str, parent: Option<usize>, placement: Placement, motion: JointMotion) -> Body {
    let moments = [[0.02, 0.003, -0.001], [0.003, 0.03, 0.002], [-0.001, 0.002, 0.025]];
    let inertia = Inertia { mass: 0.7, center: [0.05, -0.02, -0.2], moments };
    Body { name: name.into(), parent, placement, motion, inertia, armature: 0.004 }
}

/// A branched tree of a hinge, a slider on a tilted frame behind a fixed joint, and another hinge.
fn branched() -> Tree {
    let tilted = Placement::from_roll_pitch_yaw([0.1, 0.05, -0.3], [0.4, -0.7, 1.1]);
    Tree::new(vec![
        body("base", None, Placement::default(), JointMotion::Revolute([0.0, 2.0, 0.0])),
        body("plate", Some(0), tilted, JointMotion::Fixed),
        body("slider", Some(1), tilted, JointMotion::Prismatic([1.0, 1.0, 0.0])),
        body("side", Some(0), tilted, JointMotion::Revolute([0.3, 0.1, -1.0])),
    ])
    .unwrap()
}

const POSITION: [f64; 3] = [0.7, -0.2, 1.9];
const VELOCITY: [f64; 3] = [1.3, 0.6, -2.1];

/// Columns of the mass matrix are the torques of unit accelerations, less the bias; the two algorithms share no
/// recursion.
#[test]
fn the_two_algorithms_agree() {
    let tree = branched();
    let matrix = tree.mass_matrix(&POSITION).unwrap();
    let bias = tree.bias(&POSITION, &VELOCITY).unwrap();
    for column in 0..3 {
        let mut unit = [0.0; 3];
        unit[column] = 1.0;
        let torque = tree.inverse_dynamics(&POSITION, &VELOCITY, &unit).unwrap();
        for row in 0..3 {
            assert!((torque[row] - bias[row] - matrix[row][column]).abs() < 1e-14, "{row}, {column}");
            assert_eq!(matrix[row][column], matrix[column][row]);
        }
    }
}

/// Without gravity the bias does the work that changes the kinetic energy: v·b = ½ v·Ṁ·v along the motion.
#[test]
fn coriolis_torques_keep_the_energy() {
    let tree = branched().with_gravity([0.0; 3]);
    let bias = tree.bias(&POSITION, &VELOCITY).unwrap();
    let along: Vec<Dual<1>> =
        (0..3).map(|at| Dual { value: POSITION[at], partials: [VELOCITY[at]] }).collect();
    let matrix = tree.mass_matrix(&along).unwrap();
    let mut work = 0.0;
    for row in 0..3 {
        work += VELOCITY[row] * bias[row];
        for column in 0..3 {
            work -= 0.5 * VELOCITY[row] * matrix[row][column].partials[0] * VELOCITY[column];
        }
    }
    assert!(work.abs() < 1e-14, "{work}");
}

/// The accelerations that torques cause need these torques.
#[test]
fn forward_and_inverse_dynamics_agree() {
    let tree = branched();
    let torque = [0.3, -1.0, 0.2];
    let rates = tree.accelerations(&POSITION, &VELOCITY, &torque).unwrap();
    let needed = tree.inverse_dynamics(&POSITION, &VELOCITY, &rates).unwrap();
    for (own, given) in needed.iter().zip(torque) {
        assert!((own - given).abs() < 1e-12, "{own} {given}");
    }
}

/// A free fall keeps its energy over 2 s: the kinetic energy is that of the mass matrix, the potential energy the
/// work of the bias at rest.
#[test]
fn a_fall_keeps_its_energy() {
    let tree = branched();
    let start = State { position: vec![0.7, 0.0, 0.3], velocity: vec![0.0; 3] };
    let times: Vec<f64> = (0..=2000).map(|at| f64::from(at) * 1e-3).collect();
    let stiff = vec![Acting { stiffness: 40.0, ..Acting::default() }; 3];
    let path = rollout(&tree, &stiff, &start, &times, &vec![vec![0.0; 3]; times.len()]).unwrap();
    let (mut lost, mut most) = (0.0_f64, 0.0_f64);
    let mut work = 0.0;
    for at in 1..path.len() - 1 {
        let speed: Vec<f64> = (0..3).map(|j| (path[at + 1][j] - path[at - 1][j]) / 2e-3).collect();
        let matrix = tree.mass_matrix(&path[at]).unwrap();
        let kinetic: f64 =
            (0..3).map(|i| (0..3).map(|j| 0.5 * speed[i] * matrix[i][j] * speed[j]).sum::<f64>()).sum();
        let held = tree.bias(&path[at], &[0.0; 3]).unwrap();
        // Half of the present step's work is done.
        let half: f64 = (0..3).map(|j| 5e-4 * speed[j] * (held[j] + 40.0 * path[at][j])).sum();
        lost = lost.max((kinetic - work + half).abs());
        work -= 2.0 * half;
        most = most.max(kinetic);
    }
    assert!(lost < 2e-4 * most, "{lost} of {most}");
}

/// Dry friction holds up to its torque, and beyond it the joint accelerates by the rest.
#[test]
fn friction_holds_and_lets_go() {
    let hinge = Body {
        armature: 0.1,
        ..body("hinge", None, Placement::default(), JointMotion::Revolute([0.0, 0.0, 1.0]))
    };
    let tree = Tree::new(vec![hinge]).unwrap();
    let inertia = tree.mass_matrix(&[0.0]).unwrap()[0][0];
    let friction = Active::named("coulomb_friction", &[("torque", 0.5)]).unwrap();
    let acting = [Acting { effects: vec![friction], ..Acting::default() }];
    let start = State { position: vec![0.2], velocity: vec![0.0] };
    let times: Vec<f64> = (0..=500).map(|at| f64::from(at) * 1e-3).collect();
    let pushed = |torque: f64| {
        let torques = vec![vec![torque]; times.len()];
        rollout(&tree, &acting, &start, &times, &torques).unwrap()[500][0] - 0.2
    };
    assert_eq!(pushed(0.49), 0.0);
    assert!((pushed(0.7) / (0.5 * 0.2 / inertia * 0.25) - 1.0).abs() < 1e-3, "{}", pushed(0.7));
}

#[test]
fn what_is_no_tree_is_refused() {
    let hinge = body("hinge", None, Placement::default(), JointMotion::Revolute([0.0, 0.0, 1.0]));
    let refused = |bodies: Vec<Body>| Tree::new(bodies).unwrap_err();
    assert!(matches!(refused(Vec::new()), TreeError::NoJoint));
    assert!(matches!(refused(vec![Body { parent: Some(0), ..hinge.clone() }]), TreeError::Parent { .. }));
    let turned = Body { motion: JointMotion::Revolute([0.0; 3]), ..hinge.clone() };
    assert!(matches!(refused(vec![turned]), TreeError::Axis { .. }));
    let empty = Inertia { mass: 0.0, center: [0.0; 3], moments: [[0.0; 3]; 3] };
    let empty = Body { inertia: empty, armature: 0.0, ..hinge.clone() };
    assert_eq!(refused(vec![empty]), TreeError::NoInertia { joint: "hinge".into() });
    let tree = Tree::new(vec![hinge]).unwrap();
    assert_eq!(tree.mass_matrix(&[0.0, 1.0]).unwrap_err(), TreeError::Length { expected: 1, found: 2 });
}
