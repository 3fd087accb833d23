//! Repaired URDF: the file as it was, with other numbers in its `<dynamics>`.

use std::fmt::Write as _;
use std::ops::Range;

/// Place of a joint in the text.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct JointPlace {
    /// Range of `<joint …>…</joint>`.
    pub(crate) element: Range<usize>,
    /// Range of its `<dynamics …/>`, if there is one.
    pub(crate) dynamics: Option<Range<usize>>,
}

/// Numbers and remarks to write back for one joint.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct JointRepair {
    /// Viscous damping in N m s/rad or N s/m; `None` keeps that of the file.
    pub damping: Option<f64>,
    /// Dry friction in N m or N; `None` keeps that of the file.
    pub friction: Option<f64>,
    /// Inertia of the rotor in kg m² or kg; `None` keeps that of the file. URDF can hold none.
    pub armature: Option<f64>,
    /// Stiffness of a spring that is relaxed at 0, in N m/rad or N/m; `None` keeps that of the file. URDF can hold none.
    pub stiffness: Option<f64>,
    /// Sentences on what the file cannot hold.
    pub remarks: Vec<String>,
}

/// Returns a `<dynamics>` element with other numbers; further attributes stay.
fn dynamics(text: &str, own: &JointRepair) -> String {
    let mut kept = String::new();
    let mut known = [own.damping, own.friction];
    if let Ok(document) = roxmltree::Document::parse(text) {
        for attribute in document.root_element().attributes() {
            let value = attribute.value();
            match attribute.name() {
                "damping" => known[0] = known[0].or_else(|| value.parse().ok()),
                "friction" => known[1] = known[1].or_else(|| value.parse().ok()),
                name => {
                    // Writing to a text does not fail.
                    let _ = write!(kept, " {name}=\"{value}\"");
                }
            }
        }
    }
    let [damping, friction] = [("damping", known[0]), ("friction", known[1])]
        .map(|(name, value)| value.map_or_else(String::new, |value| format!(" {name}=\"{value}\"")));
    format!("<dynamics{damping}{friction}{kept}/>")
}

/// Returns the remarks as a comment, which may not hold two hyphens in a row.
pub(crate) fn comment(remarks: &[String]) -> String {
    if remarks.is_empty() {
        return String::new();
    }
    format!("<!-- Ringdown: {} -->", remarks.join(" ").replace("--", "- -"))
}

/// Returns the text of a model with other damping and friction, one repair for each joint that moves. All else is
/// as it was.
#[must_use]
pub(crate) fn repaired(old: &str, places: &[JointPlace], repairs: &[JointRepair]) -> String {
    let mut edits: Vec<(usize, usize, String)> = Vec::new();
    for (JointPlace { element, dynamics: place }, own) in places.iter().zip(repairs) {
        let changes = own.damping.is_some() || own.friction.is_some();
        let remark = comment(&own.remarks);
        if !changes && remark.is_empty() {
            continue;
        }
        match place {
            Some(place) => {
                let known = old.get(place.clone()).unwrap_or_default();
                let new = if changes { dynamics(known, own) } else { known.to_owned() };
                edits.push((place.start, place.end, new + &remark));
            }
            None => {
                // The closing tag of a joint, which has children, ends its element.
                let end = old.get(element.clone()).and_then(|text| text.rfind("</"));
                let at = end.map_or(element.end, |end| element.start + end);
                let new = if changes { dynamics("<dynamics/>", own) } else { String::new() };
                edits.push((at, at, new + &remark));
            }
        }
    }
    edits.sort_by_key(|(start, ..)| *start);
    let (mut text, mut from) = (String::new(), 0);
    for (start, end, new) in edits {
        text += old.get(from..start).unwrap_or_default();
        text += &new;
        from = end;
    }
    text + old.get(from..).unwrap_or_default()
}
