//! Repaired MJCF: the file as it was, with other numbers in its `<joint>` elements.

use crate::repair::{JointRepair, comment};
use roxmltree::{Document, Node};
use std::fmt::Write as _;

/// Returns the tag of a joint with other numbers; all other attributes stay, in their order.
fn tag(node: &Node<'_, '_>, own: &JointRepair, text: &str) -> Option<String> {
    let spring = own.stiffness.map(|_| 0.0);
    let attributes = [
        ("damping", own.damping),
        ("frictionloss", own.friction),
        ("armature", own.armature),
        ("stiffness", own.stiffness),
        ("springref", spring),
    ];
    let old = text.get(node.range())?;
    let offset = node.range().start;
    let mut edits: Vec<(usize, usize, String)> = Vec::new();
    let mut added = String::new();
    for (name, value) in attributes {
        let Some(value) = value else { continue };
        match node.attribute_node(name) {
            Some(known) => {
                let range = known.range_value();
                edits.push((range.start - offset, range.end - offset, value.to_string()));
            }
            // Writing to a text does not fail.
            None => drop(write!(added, " {name}=\"{value}\"")),
        }
    }
    // The attributes of a joint end where its tag does.
    let last = node.attributes().map(|own| own.range().end).max()? - offset;
    edits.push((last, last, added));
    edits.sort_by_key(|(start, ..)| *start);
    let (mut new, mut from) = (String::new(), 0);
    for (start, end, value) in edits {
        new += old.get(from..start)?;
        new += &value;
        from = end;
    }
    Some(new + old.get(from..)? + &comment(&own.remarks))
}

/// Returns the text of a model with other numbers in the joints that are named. `None` if one of them is not in this text:
/// it may stand in an included file.
pub(crate) fn repaired(text: &str, repairs: &[(&str, &JointRepair)]) -> Option<String> {
    let document = Document::parse(text).ok()?;
    let mut edits = Vec::new();
    for (name, own) in repairs {
        let is_joint = |node: &Node<'_, '_>| {
            node.has_tag_name("joint")
                && node.attribute("name") == Some(name)
                && node.ancestors().any(|above| above.has_tag_name("worldbody"))
        };
        let node = document.descendants().find(is_joint)?;
        edits.push((node.range(), tag(&node, own, text)?));
    }
    edits.sort_by_key(|(range, _)| range.start);
    let (mut new, mut from) = (String::new(), 0);
    for (range, own) in edits {
        new += text.get(from..range.start)?;
        new += &own;
        from = range.end;
    }
    Some(new + text.get(from..)?)
}

#[cfg(test)]
mod tests {
    use super::repaired;
    use crate::repair::JointRepair;

    #[test]
    fn numbers_are_changed_or_added_and_all_else_stays() {
        let text = "<mujoco><!-- mine -->\n<worldbody><body><joint name=\"a\" damping='0.1'  axis=\"0 1 0\" /><joint name=\"b\"></joint>\
                    </body></worldbody><actuator><motor joint=\"a\"/></actuator></mujoco>";
        let own = JointRepair {
            damping: Some(0.5),
            friction: Some(0.2),
            remarks: vec!["so -- it is".to_owned()],
            ..Default::default()
        };
        let found =
            repaired(text, &[("a", &own), ("b", &JointRepair { armature: Some(0.3), ..Default::default() })]);
        assert_eq!(
            found.unwrap(),
            "<mujoco><!-- mine -->\n<worldbody><body><joint name=\"a\" damping='0.5'  axis=\"0 1 0\" frictionloss=\"0.2\" />\
             <!-- Ringdown: so - - it is --><joint name=\"b\" armature=\"0.3\"></joint></body></worldbody><actuator>\
             <motor joint=\"a\"/></actuator></mujoco>"
        );
        assert_eq!(repaired(text, &[("c", &own)]), None);
    }
}
