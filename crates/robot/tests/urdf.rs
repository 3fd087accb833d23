//! Reading of URDF: what is refused, with its place, and what is written back.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use robot::{JointRepair, Model, Urdf};

const LINK: &str = r#"<inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1"/></inertial>"#;

fn joint(name: &str, kind: &str, parent: &str, child: &str, more: &str) -> String {
    format!(
        r#"<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>{more}</joint>"#
    )
}

fn robot(links: &[&str], joints: &[String]) -> String {
    let links: Vec<String> =
        links.iter().map(|name| format!("<link name=\"{name}\">{LINK}</link>")).collect();
    format!(
        "<robot name=\"r\">\n<link name=\"base\"/>\n{}\n{}\n</robot>\n",
        links.join("\n"),
        joints.join("\n")
    )
}

#[test]
fn what_is_no_tree_of_joints_is_refused_with_its_place() {
    let refused = |text: &str, expected: &str| {
        let message = Urdf::parse("arm.urdf", text).unwrap_err().to_string();
        assert!(message.contains(expected), "{message}");
    };
    let first = || joint("first", "revolute", "base", "a", "");
    refused("inertia = 1", "arm.urdf: is no URDF");
    refused("<mujoco/>", "arm.urdf:1:1: this is an MJCF model");
    refused(
        &robot(&["a"], &[joint("first", "floating", "base", "a", "")]),
        "arm.urdf:4:1: a joint of type \"floating\"",
    );
    refused(&robot(&["a"], &[joint("first", "revolute", "base", "b", "")]), "no link named \"b\"");
    let again = joint("again", "revolute", "base", "a", "");
    refused(&robot(&["a"], &[first(), again]), "arm.urdf:5:1: link \"a\" hangs on two joints, a loop");
    let around = [joint("p", "revolute", "b", "a", ""), joint("q", "revolute", "a", "b", "")];
    refused(&robot(&["a", "b"], &around), "is below itself, a loop");
    refused(&robot(&["a"], &[first()]).replace(LINK, ""), "joint `first` moves no inertia");
    let origin = joint("first", "revolute", "base", "a", "<origin xyz=\"0 0\"/>");
    refused(&robot(&["a"], &[origin]), "expected 3 numbers");
    refused(&robot(&["a"], &[joint("first", "fixed", "base", "a", "")]), "every joint is fixed");
    let follows = joint("first", "revolute", "base", "a", "<mimic joint=\"x\"/>");
    refused(&robot(&["a"], &[follows]), "<mimic>");
}

#[test]
fn a_repair_changes_damping_and_friction_and_keeps_all_else() {
    let with = r#"<!-- as measured --><dynamics damping="0.1" friction="0" extra="x"/>"#;
    let text = robot(
        &["a", "b", "c"],
        &[
            joint("first", "revolute", "base", "a", with),
            joint("second", "prismatic", "a", "b", ""),
            joint("third", "continuous", "b", "c", ""),
        ],
    );
    let urdf = Urdf::parse("arm.urdf", &text).unwrap();
    let repairs = [
        JointRepair {
            friction: Some(0.25),
            remarks: vec!["Armature: 0.01 kg m^2 -- not here.".into()],
            ..JointRepair::default()
        },
        JointRepair { damping: Some(1.5), ..JointRepair::default() },
        JointRepair::default(),
    ];
    let new = urdf.repaired(&repairs).unwrap().unwrap().text;
    assert!(new.contains(r#"<dynamics damping="0.1" friction="0.25" extra="x"/><!-- Ringdown: Armature: 0.01 kg m^2 - - not here. -->"#), "{new}");
    let again = Urdf::parse("repaired.urdf", &new).unwrap();
    let joints = again.joints();
    assert_eq!((joints[0].damping, joints[0].friction), (0.1, 0.25));
    assert_eq!((joints[1].damping, joints[1].friction), (1.5, 0.0));
    assert!(joints[1].slides && !joints[0].slides);
    let lines = |text: &str| {
        text.lines()
            .filter(|line| !line.contains("first") && !line.contains("second"))
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    assert_eq!(lines(&new), lines(&text));
}
