//! URDF: links, joints and what dissipates in them.
//!
//! Read by position in the text, so that messages name line and column, and the repaired file keeps all that this
//! program does not read (visuals, transmissions, plug-ins, comments).

use crate::error::RobotError;
use crate::model::{JointInfo, Model, RepairedModel, TreeModel};
use crate::repair::{JointPlace, JointRepair, repaired};
use dynamics::tree::{Body, Inertia, JointMotion, Placement, Tree};
use roxmltree::{Document, Node};
use std::collections::BTreeMap;

/// Model of a robot as URDF. Prismatic and revolute joints move; the root link stands on the ground.
#[derive(Debug, Clone, PartialEq)]
pub struct Urdf {
    text: String,
    model: TreeModel,
    /// Place of each joint that moves.
    places: Vec<JointPlace>,
}

/// Reader of one file.
struct Reader<'a, 'input> {
    file: &'a str,
    document: &'a Document<'input>,
}

type Element<'a, 'input> = Node<'a, 'input>;

impl<'a, 'input> Reader<'a, 'input> {
    fn refused(&self, node: &Element<'_, '_>, problem: String) -> RobotError {
        let place = self.document.text_pos_at(node.range().start);
        RobotError::Element { file: self.file.to_owned(), line: place.row, column: place.col, problem }
    }

    fn numbers<const N: usize>(
        &self,
        node: &Element<'_, '_>,
        name: &str,
    ) -> Result<Option<[f64; N]>, RobotError> {
        let Some(text) = node.attribute(name) else { return Ok(None) };
        let numbers: Option<Vec<f64>> = text.split_whitespace().map(|own| own.parse().ok()).collect();
        let numbers = numbers.filter(|own| own.iter().all(|own: &f64| own.is_finite()));
        numbers.and_then(|own| <[f64; N]>::try_from(own).ok()).map(Some).ok_or_else(|| {
            self.refused(node, format!("`{name}` is \"{text}\"; expected {N} numbers with blanks between"))
        })
    }

    fn number(&self, node: &Element<'_, '_>, name: &str) -> Result<f64, RobotError> {
        match self.numbers::<1>(node, name)? {
            Some([value]) => Ok(value),
            None => Err(self.refused(node, format!("<{}> has no `{name}`", node.tag_name().name()))),
        }
    }

    fn name(&self, node: &Element<'a, 'input>, attribute: &str) -> Result<&'a str, RobotError> {
        node.attribute(attribute)
            .ok_or_else(|| self.refused(node, format!("<{}> has no `{attribute}`", node.tag_name().name())))
    }

    /// Reads `<origin>`; the identity without one.
    fn placement(&self, node: &Element<'_, '_>) -> Result<Placement, RobotError> {
        let Some(origin) = child(node, "origin") else { return Ok(Placement::default()) };
        let (xyz, rpy) = (self.numbers(&origin, "xyz")?, self.numbers(&origin, "rpy")?);
        // The standard says that both are 0 where they are missing.
        Ok(Placement::from_roll_pitch_yaw(xyz.unwrap_or([0.0; 3]), rpy.unwrap_or([0.0; 3])))
    }

    /// Reads `<inertial>`; no mass without one.
    fn inertia(&self, link: &Element<'_, '_>) -> Result<Inertia, RobotError> {
        let none = Inertia { mass: 0.0, center: [0.0; 3], moments: [[0.0; 3]; 3] };
        let Some(inertial) = child(link, "inertial") else { return Ok(none) };
        let placement = self.placement(&inertial)?;
        let mass = child(&inertial, "mass")
            .ok_or_else(|| self.refused(&inertial, "<inertial> has no <mass value=\"…\"/>".to_owned()))?;
        let mass = self.number(&mass, "value")?;
        let moments = child(&inertial, "inertia").ok_or_else(|| {
            self.refused(&inertial, "<inertial> has no <inertia ixx=\"…\" iyy=\"…\" izz=\"…\"/>".to_owned())
        })?;
        let diagonal = |name| self.number(&moments, name);
        let (xx, yy, zz) = (diagonal("ixx")?, diagonal("iyy")?, diagonal("izz")?);
        // Products of inertia are 0 where they are missing.
        let product = |name| {
            Ok::<f64, RobotError>(self.numbers(&moments, name)?.map_or(0.0, |[value]: [f64; 1]| value))
        };
        let (xy, xz, yz) = (product("ixy")?, product("ixz")?, product("iyz")?);
        let moments = placement.moments(&[[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]);
        Ok(Inertia { mass, center: placement.origin, moments })
    }

    fn motion(&self, joint: &Element<'a, 'input>) -> Result<JointMotion, RobotError> {
        // The axis is x where it is missing.
        let axis = child(joint, "axis").map(|axis| self.numbers(&axis, "xyz")).transpose()?.flatten();
        let axis = axis.unwrap_or([1.0, 0.0, 0.0]);
        match self.name(joint, "type")? {
            "revolute" | "continuous" => Ok(JointMotion::Revolute(axis)),
            "prismatic" => Ok(JointMotion::Prismatic(axis)),
            "fixed" => Ok(JointMotion::Fixed),
            other => Err(self.refused(
                joint,
                format!(
                    "a joint of type \"{other}\" is not supported; revolute, continuous, prismatic and fixed joints are: replace \
                     it, or make it fixed"
                ),
            )),
        }
    }

    /// Reads damping and friction of a joint.
    fn dissipation(&self, joint: &Element<'_, '_>) -> Result<(f64, f64), RobotError> {
        // A joint without <dynamics> has neither.
        let Some(own) = child(joint, "dynamics") else { return Ok((0.0, 0.0)) };
        let of = |name| match self.numbers(&own, name)? {
            None => Ok(0.0),
            Some([value]) if value >= 0.0 => Ok(value),
            Some([value]) => {
                Err(self.refused(&own, format!("`{name}` is {value}; expected a number of 0 or above")))
            }
        };
        Ok((of("damping")?, of("friction")?))
    }
}

fn child<'a, 'input>(node: &Element<'a, 'input>, name: &str) -> Option<Element<'a, 'input>> {
    node.children().find(|child| child.has_tag_name(name))
}

/// Joint element with the names of its links.
struct Link<'a, 'input> {
    joint: Element<'a, 'input>,
    parent: &'a str,
    child: &'a str,
}

impl Urdf {
    /// Reads a model from the text of a file; `file` is its name in messages.
    ///
    /// # Errors
    /// [`RobotError`] with line and column for what is not URDF, joints that form a loop or belong together
    /// nowhere, kinds of joints that are not supported, and joints that move no inertia.
    pub fn parse(file: &str, text: &str) -> Result<Self, RobotError> {
        let document = Document::parse(text)
            .map_err(|error| RobotError::NotXml { file: file.to_owned(), problem: error.to_string() })?;
        let reader = Reader { file, document: &document };
        let root = document.root_element();
        if !root.has_tag_name("robot") {
            let found = root.tag_name().name();
            let problem = match found {
                "mujoco" => "this is an MJCF model; name its file with the ending .xml".into(),
                _ => format!("the outermost element is <{found}>; expected <robot>"),
            };
            return Err(reader.refused(&root, problem));
        }
        let mut links = BTreeMap::new();
        for link in root.children().filter(|node| node.has_tag_name("link")) {
            links.insert(reader.name(&link, "name")?, link);
        }
        let mut joints = Vec::new();
        for joint in root.children().filter(|node| node.has_tag_name("joint")) {
            joints.push(reader.link(joint, &links)?);
        }
        reader.check_tree(&joints)?;
        let mut built = Built::default();
        for root in links.keys().filter(|name| joints.iter().all(|own| own.child != **name)) {
            built.add(&reader, (*root, None), &joints, &links)?;
        }
        let tree =
            Tree::new(built.bodies).map_err(|source| RobotError::Tree { file: file.to_owned(), source })?;
        let model = TreeModel::new(tree, &built.dissipation);
        Ok(Self { text: text.to_owned(), model, places: built.places })
    }

    /// Returns the same model with the rotors' inertia at the joints that are named, in kg m² (kg for a prismatic
    /// joint): the rotor's times the square of the gear ratio.
    ///
    /// # Errors
    /// [`RobotError::Unknown`] for a joint that the model does not have; [`RobotError::Tree`] for a number below 0.
    pub fn with_armatures(mut self, armatures: &[(String, f64)]) -> Result<Self, RobotError> {
        let names: Vec<&str> = self.model.tree.names().collect();
        if let Some((name, _)) = armatures.iter().find(|(name, _)| !names.contains(&name.as_str())) {
            return Err(RobotError::Unknown {
                name: name.clone(),
                what: "joint of the model",
                known: names.join(", "),
            });
        }
        let of = |name: &&str| armatures.iter().find(|(own, _)| own == name).map(|(_, value)| *value);
        // A joint that is not named has no rotor.
        let values: Vec<f64> = names.iter().map(|name| of(name).unwrap_or(0.0)).collect();
        let tree = self.model.tree.clone().with_armatures(&values);
        let file = "--armature".to_owned();
        self.model.tree = tree.map_err(|source| RobotError::Tree { file, source })?;
        Ok(self)
    }

    /// Returns the tree of bodies.
    #[must_use]
    pub fn tree(&self) -> &Tree {
        &self.model.tree
    }
}

impl Model for Urdf {
    fn joints(&self) -> &[JointInfo] {
        self.model.joints()
    }

    fn format(&self) -> &'static str {
        self.model.format()
    }

    fn mass_matrix(&self, position: &[f64]) -> Result<Vec<Vec<f64>>, RobotError> {
        self.model.mass_matrix(position)
    }

    fn bias(&self, position: &[f64], velocity: &[f64]) -> Result<Vec<f64>, RobotError> {
        self.model.bias(position, velocity)
    }

    fn repaired(&self, repairs: &[JointRepair]) -> Result<Option<RepairedModel>, RobotError> {
        Ok(Some(RepairedModel { extension: "urdf", text: repaired(&self.text, &self.places, repairs) }))
    }
}

impl<'a, 'input> Reader<'a, 'input> {
    fn link(
        &self,
        joint: Element<'a, 'input>,
        links: &BTreeMap<&'a str, Element<'a, 'input>>,
    ) -> Result<Link<'a, 'input>, RobotError> {
        let end = |which: &str| {
            let node = child(&joint, which)
                .ok_or_else(|| self.refused(&joint, format!("<joint> has no <{which} link=\"…\"/>")))?;
            let name = self.name(&node, "link")?;
            match links.contains_key(name) {
                true => Ok(name),
                false => Err(self.refused(&node, format!("there is no link named \"{name}\""))),
            }
        };
        Ok(Link { joint, parent: end("parent")?, child: end("child")? })
    }

    /// Checks that no link hangs on two joints and that every joint hangs on a root.
    fn check_tree(&self, joints: &[Link<'a, 'input>]) -> Result<(), RobotError> {
        for (index, own) in joints.iter().enumerate() {
            let before = joints.iter().take(index);
            if before.clone().any(|other| other.child == own.child) {
                let problem = format!(
                    "link \"{}\" hangs on two joints, a loop; a diagnosis takes trees: cut the loop at one of them",
                    own.child
                );
                return Err(self.refused(&own.joint, problem));
            }
            // As many steps toward the root as there are joints lead around a loop.
            let above =
                |link: &str| joints.iter().find(|other| other.child == link).map(|other| other.parent);
            let mut link = own.parent;
            for _ in 0..joints.len() {
                match above(link) {
                    Some(parent) => link = parent,
                    None => break,
                }
            }
            if above(link).is_some() {
                let problem = format!(
                    "link \"{}\" is below itself, a loop; a diagnosis takes trees: cut it at one joint",
                    own.child
                );
                return Err(self.refused(&own.joint, problem));
            }
        }
        Ok(())
    }
}

/// Bodies in the tree's order: each branch to its end, in the order of the file.
#[derive(Default)]
struct Built {
    bodies: Vec<Body>,
    dissipation: Vec<(f64, f64)>,
    places: Vec<JointPlace>,
}

impl Built {
    fn add<'a, 'input>(
        &mut self,
        reader: &Reader<'a, 'input>,
        (link, parent): (&'a str, Option<usize>),
        joints: &[Link<'a, 'input>],
        links: &BTreeMap<&'a str, Element<'a, 'input>>,
    ) -> Result<(), RobotError> {
        for own in joints.iter().filter(|own| own.parent == link) {
            let Some(body) = links.get(own.child) else { continue };
            let motion = reader.motion(&own.joint)?;
            if motion != JointMotion::Fixed {
                self.dissipation.push(reader.dissipation(&own.joint)?);
                let dynamics = child(&own.joint, "dynamics").map(|node| node.range());
                self.places.push(JointPlace { element: own.joint.range(), dynamics });
            }
            if child(&own.joint, "mimic").is_some() {
                let problem =
                    "a joint that follows another one (<mimic>) is not supported; make it fixed".to_owned();
                return Err(reader.refused(&own.joint, problem));
            }
            self.bodies.push(Body {
                name: reader.name(&own.joint, "name")?.to_owned(),
                parent,
                placement: reader.placement(&own.joint)?,
                motion,
                inertia: reader.inertia(body)?,
                armature: 0.0,
            });
            let index = self.bodies.len() - 1;
            self.add(reader, (own.child, Some(index)), joints, links)?;
        }
        Ok(())
    }
}
