//! Simulators that another program runs, such as MuJoCo, or an object in Python.
//!
//! They are asked in text, one JSON object for each question and answer:
//!
//! | question | answer |
//! |---|---|
//! | `{"do": "describe"}` | `{"joints": [{"name", "slides", "damping", "friction", "armature", "stiffness"}], "rollout": bool}` |
//! | `{"do": "along", "positions": [[…]], "velocities": [[…]]}` | `{"mass": [[[…]]], "bias": [[…]]}` |
//! | `{"do": "rollout", "parameters": {JOINT: {…}}, "start": {…}, "times": […], "torques": [[…]]}` | `{"positions": [[…]]}` |
//! | `{"do": "write", "parameters": {JOINT: {…}}}` | `{"text": …}` |

use crate::error::RobotError;
use crate::mjcf;
use crate::model::{Evaluated, JointInfo, Model, Moving, RepairedModel};
use crate::repair::JointRepair;
use dynamics::Effect;
use dynamics::tree::{Acting, State, rollout};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value, json};

/// Way to a simulator that another program runs.
pub trait Simulator: Send + Sync {
    /// Puts a question and returns the answer.
    ///
    /// # Errors
    /// The reason in words, if there is no answer.
    fn ask(&self, question: &str) -> Result<String, String>;
}

/// Description that a simulator gives of itself.
#[derive(Deserialize)]
struct Described {
    joints: Vec<DescribedJoint>,
    rollout: bool,
}

#[derive(Deserialize)]
struct DescribedJoint {
    name: String,
    slides: bool,
    damping: f64,
    friction: f64,
    armature: f64,
    stiffness: f64,
}

#[derive(Deserialize)]
struct Along {
    mass: Vec<Vec<Vec<f64>>>,
    bias: Vec<Vec<f64>>,
}

#[derive(Deserialize)]
struct Path {
    positions: Vec<Vec<f64>>,
}

#[derive(Deserialize)]
struct Text {
    text: String,
}

/// Model that is a simulator of another program.
pub struct Foreign {
    simulator: Box<dyn Simulator>,
    joints: Vec<JointInfo>,
    /// Inertia that is added to the model's, by joint.
    added: Vec<f64>,
    rolls: bool,
    /// Text of the MJCF file, if the model is one.
    text: Option<String>,
}

impl Foreign {
    /// Asks a simulator for its joints.
    ///
    /// # Errors
    /// [`RobotError::Model`] if it does not answer, or has no joint.
    pub fn new(simulator: Box<dyn Simulator>) -> Result<Self, RobotError> {
        let described: Described = answer(&*simulator, "description", &json!({ "do": "describe" }))?;
        if described.joints.is_empty() {
            let problem = "it has no hinge or slide that moves".to_owned();
            return Err(RobotError::Model { quantity: "joint", problem });
        }
        let joint = |own: DescribedJoint| JointInfo {
            name: own.name,
            slides: own.slides,
            damping: own.damping,
            friction: own.friction,
            armature: Some(own.armature),
            // A spring of the model's own is part of its bias forces, and may be relaxed elsewhere.
            stiffness: (own.stiffness == 0.0).then_some(0.0),
        };
        let joints: Vec<JointInfo> = described.joints.into_iter().map(joint).collect();
        let added = vec![0.0; joints.len()];
        Ok(Self { simulator, joints, added, rolls: described.rollout, text: None })
    }

    /// Returns the model of an MJCF file, into whose text a repair is written.
    #[must_use]
    pub fn with_text(self, text: String) -> Self {
        Self { text: Some(text), ..self }
    }

    /// Returns the model with more inertia at the joints that are named, in kg m² or kg.
    ///
    /// # Errors
    /// [`RobotError::Unknown`] for a joint that the model does not have.
    pub fn with_armatures(mut self, armatures: &[(String, f64)]) -> Result<Self, RobotError> {
        for (name, value) in armatures {
            let mut places = self.joints.iter_mut().zip(&mut self.added);
            let Some((joint, added)) = places.find(|(own, _)| own.name == *name) else {
                let known: Vec<&str> = self.joints.iter().map(|own| own.name.as_str()).collect();
                let (name, known) = (name.clone(), known.join(", "));
                return Err(RobotError::Unknown { name, what: "joint of the model", known });
            };
            *added = *value;
            joint.armature = joint.armature.map(|own| own + value);
        }
        Ok(self)
    }

    fn ask<T: DeserializeOwned>(&self, quantity: &'static str, question: &Value) -> Result<T, RobotError> {
        answer(&*self.simulator, quantity, question)
    }

    fn one(&self, position: &[f64], velocity: &[f64]) -> Result<(Vec<Vec<f64>>, Vec<f64>), RobotError> {
        let (mass, bias) =
            self.along(&[State { position: position.to_vec(), velocity: velocity.to_vec() }])?;
        let none =
            || RobotError::Model { quantity: "mass matrix", problem: "it answers for no state".to_owned() };
        mass.into_iter().zip(bias).next().ok_or_else(none)
    }

    /// Returns the parameters of the joints that the simulator can represent; `None` if an effect acts that it cannot.
    fn parameters(&self, acting: &[Acting]) -> Option<Value> {
        let mut all = Map::new();
        for ((joint, own), added) in self.joints.iter().zip(acting).zip(&self.added) {
            let mut friction = 0.0;
            for active in &own.effects {
                match (active.id(), active.effect()) {
                    ("coulomb_friction", _) => friction = active.value("torque")?,
                    (_, Effect::System(_)) => return None,
                    // Effects of the sensor move nothing.
                    _ => {}
                }
            }
            let parameters = json!({
                "damping": own.damping,
                "friction": friction,
                "armature": own.inertia + added,
                "stiffness": own.stiffness,
                "torque": own.torque,
            });
            all.insert(joint.name.clone(), parameters);
        }
        Some(Value::Object(all))
    }
}

/// Puts a question to a simulator and reads the answer.
fn answer<T: DeserializeOwned>(
    simulator: &dyn Simulator,
    quantity: &'static str,
    question: &Value,
) -> Result<T, RobotError> {
    let failed = |problem: String| RobotError::Model { quantity, problem };
    let text = simulator.ask(&question.to_string()).map_err(failed)?;
    serde_json::from_str(&text).map_err(|error| failed(format!("its answer cannot be read: {error}")))
}

impl Model for Foreign {
    fn joints(&self) -> &[JointInfo] {
        &self.joints
    }

    fn format(&self) -> &'static str {
        if self.text.is_some() { "MJCF" } else { "A model file" }
    }

    fn mass_matrix(&self, position: &[f64]) -> Result<Vec<Vec<f64>>, RobotError> {
        let still = vec![0.0; position.len()];
        self.one(position, &still).map(|(mass, _)| mass)
    }

    fn bias(&self, position: &[f64], velocity: &[f64]) -> Result<Vec<f64>, RobotError> {
        self.one(position, velocity).map(|(_, bias)| bias)
    }

    fn along(&self, states: &[State]) -> Result<Evaluated, RobotError> {
        let positions: Vec<&[f64]> = states.iter().map(|own| own.position.as_slice()).collect();
        let velocities: Vec<&[f64]> = states.iter().map(|own| own.velocity.as_slice()).collect();
        let question = json!({ "do": "along", "positions": positions, "velocities": velocities });
        let Along { mut mass, bias } = self.ask("mass matrix or bias forces", &question)?;
        for matrix in &mut mass {
            for (at, (row, added)) in matrix.iter_mut().zip(&self.added).enumerate() {
                row.get_mut(at).into_iter().for_each(|own| *own += added);
            }
        }
        Ok((mass, bias))
    }

    fn rollout(
        &self,
        acting: &[Acting],
        start: &State,
        times: &[f64],
        torques: &[Vec<f64>],
    ) -> Result<Vec<Vec<f64>>, RobotError> {
        let Some(parameters) = self.parameters(acting).filter(|_| self.rolls) else {
            return rollout(&Moving(self), acting, start, times, torques);
        };
        let question = json!({
            "do": "rollout",
            "parameters": parameters,
            "start": { "position": start.position, "velocity": start.velocity },
            "times": times,
            "torques": torques,
        });
        let Path { positions } = self.ask("rollout", &question)?;
        let is_whole = positions.len() == times.len()
            && positions
                .iter()
                .all(|own| own.len() == self.joints.len() && own.iter().all(|x| x.is_finite()));
        match (is_whole, times.last()) {
            (true, _) | (_, None) => Ok(positions),
            (false, Some(&time_s)) => Err(dynamics::tree::TreeError::Diverged { time_s }.into()),
        }
    }

    fn repaired(&self, repairs: &[JointRepair]) -> Result<Option<RepairedModel>, RobotError> {
        let Some(text) = &self.text else { return Ok(None) };
        let named: Vec<(&str, &JointRepair)> =
            self.joints.iter().map(|own| own.name.as_str()).zip(repairs).collect();
        if let Some(text) = mjcf::repaired(text, &named) {
            return Ok(Some(RepairedModel { extension: "xml", text }));
        }
        // Some joint stands in another file, which the simulator merges.
        let mut parameters = Map::new();
        for (name, own) in named {
            let numbers = json!({
                "damping": own.damping,
                "friction": own.friction,
                "armature": own.armature,
                "stiffness": own.stiffness,
            });
            parameters.insert(name.to_owned(), numbers);
        }
        let Text { text } = self.ask("repaired file", &json!({ "do": "write", "parameters": parameters }))?;
        Ok(Some(RepairedModel { extension: "xml", text }))
    }
}
