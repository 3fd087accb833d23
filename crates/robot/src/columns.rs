//! Columns of a log of several joints: which hold position and torque of which joint.

use crate::error::RobotError;
use crate::model::JointInfo;

/// Words that mean a position after or before the name of a joint.
const POSITION: &[&str] = &["position", "pos", "angle", "q", "measured_position"];
/// Words that mean a torque or a force.
const TORQUE: &[&str] = &["torque", "effort", "tau", "force", "measured_torque", "measured_effort"];
/// Letters before the number of a joint, for positions and for torques.
const NUMBERED: [&[&str]; 2] =
    [&["q", "joint", "position", "pos", "angle"], &["tau", "torque", "effort", "t"]];

/// Columns of one joint.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct JointColumns {
    /// Title of the column of the position.
    pub position: String,
    /// Title of the column of the torque; `None` if the log has none.
    pub torque: Option<String>,
}

/// Columns as stated for one joint: `NAME=POSITION,TORQUE`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stated {
    /// Name of the joint.
    pub joint: String,
    /// Its columns.
    pub columns: JointColumns,
}

impl Stated {
    /// Reads a value of `--columns`.
    ///
    /// # Errors
    /// [`RobotError::Form`].
    pub fn parse(text: &str) -> Result<Self, RobotError> {
        let read = || {
            let (joint, columns) = text.split_once('=')?;
            let (position, torque) = match columns.split_once(',') {
                Some((position, torque)) => (position, Some(torque.trim().to_owned())),
                None => (columns, None),
            };
            let (joint, position) = (joint.trim().to_owned(), position.trim().to_owned());
            let filled = !joint.is_empty() && !position.is_empty() && torque.as_deref() != Some("");
            filled.then_some(Self { joint, columns: JointColumns { position, torque } })
        };
        read().ok_or_else(|| RobotError::Form {
            text: text.to_owned(),
            expected: "JOINT=POSITION,TORQUE with two titles of the header, such as shoulder=q1,tau1",
        })
    }
}

/// Returns the title in small letters, without a unit in brackets, with one `_` for each run of other signs.
fn plain(title: &str) -> String {
    let bare = title.split(['[', '(']).next().unwrap_or(title);
    let words: Vec<String> = bare
        .split(|sign: char| !sign.is_alphanumeric())
        .filter(|word| !word.is_empty())
        .map(str::to_lowercase)
        .collect();
    words.join("_")
}

/// Returns the title whose plain form joins the name of the joint and one of the words, in either order, and may
/// begin with more (`/joint_states/elbow/position`).
fn named<'a>(titles: &'a [String], joint: &str, words: &[&str]) -> Option<&'a String> {
    let joint = plain(joint);
    let is = |title: &String, word: &&str| {
        let title = plain(title);
        let wanted =
            [format!("{joint}_{word}"), format!("{word}_{joint}"), format!("joint_states_{joint}_{word}")];
        wanted.contains(&title) || title.ends_with(&format!("_{joint}_{word}"))
    };
    words.iter().find_map(|word| titles.iter().find(|title| is(title, word)))
}

/// Returns the titles that are a letter and a number, ascending from 0 or 1, if there are as many as joints.
fn numbered<'a>(titles: &'a [String], words: &[&str], count: usize) -> Option<Vec<&'a String>> {
    let of = |word: &&str| {
        [0, 1].into_iter().find_map(|first| {
            let title = |at: usize| {
                let forms = [format!("{word}{}", first + at), format!("{word}_{}", first + at)];
                titles.iter().find(|title| forms.contains(&plain(title)))
            };
            // A further number belongs to a joint that the model lacks.
            let found: Option<Vec<_>> = (0..count).map(title).collect();
            found.filter(|_| title(count).is_none())
        })
    };
    words.iter().find_map(of)
}

/// Finds the columns of every joint of a model among the titles of a log, which is called `log` in messages.
///
/// Titles such as `elbow_position`, `q_elbow` and `/joint_states/elbow/position` name their joint; without them,
/// `q1, q2, …` and `tau1, tau2, …` are the joints in the model's order. `stated` goes before both.
///
/// # Errors
/// [`RobotError::Unknown`] for a stated joint or column that does not exist; [`RobotError::NoJoint`] where no column
/// belongs to a joint; [`RobotError::NoColumn`] where the position of some joint has none.
pub fn find(
    log: &str,
    titles: &[String],
    joints: &[JointInfo],
    stated: &[Stated],
) -> Result<Vec<JointColumns>, RobotError> {
    for own in stated {
        check(titles, joints, own)?;
    }
    let stated = |joint: &str| stated.iter().find(|own| own.joint == joint).map(|own| own.columns.clone());
    let pick = |words: &[&str], letters: &[&str]| -> Vec<Option<String>> {
        let by_name: Vec<Option<&String>> =
            joints.iter().map(|joint| named(titles, &joint.name, words)).collect();
        let any = by_name.iter().any(Option::is_some);
        match numbered(titles, letters, joints.len()).filter(|_| !any) {
            Some(found) => found.into_iter().map(|title| Some(title.clone())).collect(),
            None => by_name.into_iter().map(|title| title.cloned()).collect(),
        }
    };
    let [positions, torques] = NUMBERED;
    let (positions, torques) = (pick(POSITION, positions), pick(TORQUE, torques));
    let columns = joints.iter().zip(positions).zip(torques);
    let found: Vec<(&JointInfo, Option<JointColumns>)> = columns
        .map(|((joint, position), torque)| {
            let own = position.map(|position| JointColumns { position, torque });
            (joint, stated(&joint.name).or(own))
        })
        .collect();
    if found.iter().all(|(_, columns)| columns.is_none()) {
        return Err(no_joint(log, titles, joints));
    }
    let each = found.into_iter().map(|(joint, columns)| {
        columns.ok_or_else(|| RobotError::NoColumn {
            log: log.to_owned(),
            quantity: "position",
            joint: joint.name.clone(),
            columns: titles.join(", "),
            option: format!("{}=POSITION,TORQUE", joint.name),
        })
    });
    each.collect()
}

/// Finds the columns of a log in long form, which hold all joints one below the other.
///
/// # Errors
/// [`RobotError::NoColumn`] without a position.
pub fn find_long(log: &str, titles: &[String]) -> Result<JointColumns, RobotError> {
    let of = |words: &[&str]| {
        words.iter().find_map(|word| titles.iter().find(|title| plain(title) == **word)).cloned()
    };
    let missing = || RobotError::NoColumn {
        log: log.to_owned(),
        quantity: "position",
        joint: "each joint".to_owned(),
        columns: titles.join(", "),
        option: "with a title such as position in the header".to_owned(),
    };
    Ok(JointColumns { position: of(POSITION).ok_or_else(missing)?, torque: of(TORQUE) })
}

fn no_joint(log: &str, titles: &[String], joints: &[JointInfo]) -> RobotError {
    let names: Vec<&str> = joints.iter().map(|joint| joint.name.as_str()).collect();
    // A model has at least one joint that moves.
    let first = names.first().copied().unwrap_or_default();
    RobotError::NoJoint {
        log: log.to_owned(),
        joints: names.join(", "),
        columns: titles.join(", "),
        example: format!("{first}_position and {first}_torque"),
        option: format!("{first}=POSITION,TORQUE"),
    }
}

fn check(titles: &[String], joints: &[JointInfo], own: &Stated) -> Result<(), RobotError> {
    if joints.iter().all(|joint| joint.name != own.joint) {
        let known: Vec<&str> = joints.iter().map(|joint| joint.name.as_str()).collect();
        let (name, known) = (own.joint.clone(), known.join(", "));
        return Err(RobotError::Unknown { name, what: "joint of the model", known });
    }
    let JointColumns { position, torque } = &own.columns;
    match std::iter::once(position).chain(torque).find(|column| !titles.contains(column)) {
        Some(column) => Err(RobotError::Unknown {
            name: column.clone(),
            what: "column of the log",
            known: titles.join(", "),
        }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::{Stated, find};
    use crate::model::JointInfo;

    fn joints() -> Vec<JointInfo> {
        let joint = |name: &str| JointInfo {
            name: name.into(),
            slides: false,
            damping: 0.0,
            friction: 0.0,
            armature: None,
            stiffness: None,
        };
        vec![joint("shoulder"), joint("el-bow")]
    }

    fn found(header: &str, stated: &[&str]) -> Result<Vec<(String, Option<String>)>, String> {
        let titles: Vec<String> = header.split(',').map(|title| title.trim().to_owned()).collect();
        let stated: Vec<Stated> = stated.iter().map(|text| Stated::parse(text).unwrap()).collect();
        match find("log.csv", &titles, &joints(), &stated) {
            Ok(found) => Ok(found.into_iter().map(|own| (own.position, own.torque)).collect()),
            Err(error) => Err(error.to_string()),
        }
    }

    #[test]
    fn columns_are_found_by_name_and_by_number() {
        for [header, first, torque, second] in [
            ["t, q1, q2, qd1, qd2, tau1, tau2, tau1_cmd, tau2_cmd", "q1", "tau1", "q2"],
            ["t, q_0, q_1, torque_0, torque_1", "q_0", "torque_0", "q_1"],
            [
                "t, shoulder_torque, shoulder_position [rad], el_bow_position",
                "shoulder_position [rad]",
                "shoulder_torque",
                "el_bow_position",
            ],
            [
                "time, /joint_states/shoulder/position, /joint_states/el-bow/position, /joint_states/shoulder/effort",
                "/joint_states/shoulder/position",
                "/joint_states/shoulder/effort",
                "/joint_states/el-bow/position",
            ],
            ["time, q_shoulder, q_el-bow, tau_shoulder", "q_shoulder", "tau_shoulder", "q_el-bow"],
        ] {
            let found = found(header, &[]).unwrap();
            assert_eq!(found[0], (first.to_owned(), Some(torque.to_owned())), "{header}");
            assert_eq!(found[1].0, second, "{header}");
        }
        let stated = found("t, a, b, q1, q2, tau1, tau2", &["shoulder=a,b"]).unwrap();
        assert_eq!(stated[0], ("a".to_owned(), Some("b".to_owned())));
        assert_eq!(stated[1].0, "q2");
    }

    #[test]
    fn what_is_missing_is_named_with_the_option_to_state_it() {
        let refused = |header: &str, stated: &[&str], expected: &str| {
            let message = found(header, stated).unwrap_err();
            assert!(message.contains(expected), "{message}");
        };
        refused("t, a, b", &[], "--columns shoulder=POSITION,TORQUE");
        refused("t, a, b", &[], "whose joints are shoulder, el-bow");
        refused("t, q1, q2, q3, tau1, tau2, tau3", &[], "no column belongs to a joint");
        refused("t, shoulder_position", &[], "no column for the position of joint `el-bow`");
        refused("t, q1, q2", &["wrist=q1,tau1"], "`wrist` is no joint of the model");
        refused("t, q1, q2", &["shoulder=q1,tau1"], "`tau1` is no column of the log");
        assert!(Stated::parse("shoulder").unwrap_err().to_string().contains("shoulder=q1,tau1"));
    }
}
