//! The effects of a system as named constants, states and expressions, for languages with similar syntax.

use crate::Repaired;
use dynamics::{Active, Description, Effect, Joint};

/// A constant with its comment.
pub(crate) struct Constant {
    pub(crate) name: String,
    pub(crate) value: f64,
    pub(crate) comment: String,
}

/// A hidden state.
pub(crate) struct State {
    pub(crate) name: String,
    pub(crate) rate: String,
    pub(crate) start: String,
}

/// A torque with the title of its effect.
pub(crate) struct Term {
    pub(crate) title: &'static str,
    pub(crate) expression: String,
}

/// A system split into its terms.
pub(crate) struct Terms {
    pub(crate) constants: Vec<Constant>,
    pub(crate) states: Vec<State>,
    pub(crate) torques: Vec<Term>,
    /// Delay of the input, in seconds.
    pub(crate) delay: Option<f64>,
    /// Parts that these terms leave out, one sentence each.
    pub(crate) left_out: Vec<String>,
    /// Speed below which the direction of motion is blurred.
    pub(crate) small_speed: f64,
}

impl Terms {
    pub(crate) fn of(repaired: &Repaired) -> Self {
        use dynamics::Quantity::{Damping, Inertia, Position, Stiffness};
        let nominal = repaired.system.nominal();
        let constant = |name: &str, value, comment: &str| Constant {
            name: name.to_owned(),
            value,
            comment: comment.to_owned(),
        };
        let mut terms = Self {
            constants: vec![
                constant("inertia", nominal.inertia(), repaired.unit(Inertia)),
                constant("damping", nominal.damping(), repaired.unit(Damping)),
                constant("stiffness", nominal.stiffness(), repaired.unit(Stiffness)),
                constant("rest_angle", nominal.rest_angle(), repaired.unit(Position)),
            ],
            states: Vec::new(),
            torques: Vec::new(),
            delay: None,
            left_out: left_out(repaired),
            small_speed: small_speed(repaired),
        };
        if repaired.driven() {
            let gain = constant("input_gain", nominal.input_gain(), "torque or force per unit of the input");
            terms.constants.push(gain);
        }
        for active in repaired.system.effects() {
            if let Effect::System(effect) = active.effect() {
                terms.add(repaired, active, effect);
            }
        }
        terms
    }

    /// Returns `true` if a torque needs the rate of the input's torque.
    pub(crate) fn use_the_drives_rate(&self) -> bool {
        self.torques.iter().any(|term| term.expression.contains("drive_rate"))
    }

    fn add(&mut self, repaired: &Repaired, active: &Active, effect: dynamics::SystemEffect) {
        let (description, export) = (effect.description(), effect.export());
        for (parameter, value) in description.parameters.iter().zip(active.values()) {
            self.constants.push(Constant {
                name: own(description, parameter.name),
                value: *value,
                comment: format!("{}, {}", repaired.unit(parameter.quantity), parameter.meaning),
            });
        }
        let known = repaired.hidden_start(description.id);
        for (at, state) in export.states.iter().enumerate() {
            let known = known.and_then(|known| known.get(at));
            self.states.push(State {
                name: own(description, state.name),
                rate: filled(state.rate, description),
                start: known.map_or_else(|| state.start.to_owned(), |value| format!("{value:?}")),
            });
        }
        if let Some(expression) = export.torque {
            self.torques.push(Term { title: description.title, expression: filled(expression, description) });
        } else {
            let mut values = [0.0; dynamics::MOST_PARAMETERS];
            for (slot, value) in values.iter_mut().zip(active.values()) {
                *slot = *value;
            }
            match effect.input_delay(&values) {
                Some(delay) => self.delay = Some(delay),
                None => self.left_out.push(format!("{}: {}", description.title, description.equation)),
            }
        }
    }
}

/// Returns the name of an effect's own quantity.
fn own(description: &Description, name: &str) -> String {
    format!("{}_{name}", description.id)
}

/// Returns an expression with its braces filled in.
fn filled(expression: &str, description: &Description) -> String {
    expression.replace('{', &format!("{}_", description.id)).replace('}', "")
}

/// Returns the parameters of an effect by symbol, with values and units.
fn values(repaired: &Repaired, active: &Active) -> String {
    let parameters = active.effect().description().parameters.iter().zip(active.values());
    let stated: Vec<String> = parameters
        .map(|(parameter, value)| {
            format!("{} = {value:?} {}", parameter.symbol, repaired.unit(parameter.quantity))
        })
        .collect();
    stated.join(", ")
}

/// Returns the effects between the motion and the file, and the parts that could not be part of the repaired
/// simulator.
pub(crate) fn left_out(repaired: &Repaired) -> Vec<String> {
    let measured = repaired.chain.iter().map(|active| {
        let description = active.effect().description();
        format!(
            "{} acts on the measurement, not on the motion: {} ({})",
            description.title,
            description.equation,
            values(repaired, active)
        )
    });
    measured.chain(repaired.left_out.iter().cloned()).collect()
}

/// Returns a hundred-thousandth of the largest initial speed: a creep this slow has no visible effect.
fn small_speed(repaired: &Repaired) -> f64 {
    let nominal = repaired.system.nominal();
    let swing = (repaired.start.position - nominal.rest_angle()).abs() * nominal.angular_frequency();
    let speed = swing.max(repaired.start.velocity.abs());
    if speed > 0.0 { 1e-5 * speed } else { 1e-5 }
}

/// Terms that a joint of a robot description can hold, with sentences on the others.
pub(crate) struct JointTerms {
    pub(crate) friction: Option<f64>,
    pub(crate) rest: f64,
    /// Weight times lever arm, and the angle from hanging straight down.
    pub(crate) weight: Option<(f64, f64)>,
    pub(crate) second_body: Option<SecondBody>,
    pub(crate) left_out: Vec<String>,
}

/// Body on a joint of its own upon the first body.
pub(crate) struct SecondBody {
    pub(crate) inertia: f64,
    pub(crate) stiffness: f64,
    pub(crate) damping: f64,
    /// Deflection of its joint at the start, and the rate of the deflection.
    pub(crate) start: (f64, f64),
}

impl JointTerms {
    pub(crate) fn of(repaired: &Repaired) -> Self {
        let nominal = repaired.system.nominal();
        let mut terms = Self {
            friction: None,
            rest: nominal.rest_angle(),
            weight: None,
            second_body: None,
            left_out: left_out(repaired),
        };
        for active in repaired.system.effects() {
            let Effect::System(effect) = active.effect() else { continue };
            let value = |name: &str| active.value(name);
            let placed = match effect.export().joint {
                Joint::Friction(torque) => value(torque).map(|torque| terms.friction = Some(torque)),
                Joint::SpringShift(torque) if nominal.stiffness() > 0.0 => {
                    value(torque).map(|torque| terms.rest += torque / nominal.stiffness())
                }
                Joint::Weight { torque, angle } if nominal.coordinate() == dynamics::Coordinate::Angle => {
                    let weight = value(torque).filter(|torque| *torque > 0.0).zip(value(angle));
                    weight.map(|weight| terms.weight = Some(weight))
                }
                Joint::SecondBody { inertia, stiffness, damping } => {
                    let start = match repaired.hidden_start(active.id()) {
                        Some([position, velocity, ..]) => {
                            (position - repaired.start.position, velocity - repaired.start.velocity)
                        }
                        // Relaxed: it moves along.
                        _ => (0.0, 0.0),
                    };
                    value(inertia).zip(value(stiffness).zip(value(damping))).map(
                        |(inertia, (stiffness, damping))| {
                            terms.second_body = Some(SecondBody { inertia, stiffness, damping, start });
                        },
                    )
                }
                _ => None,
            };
            if placed.is_none() {
                let description = active.effect().description();
                terms.left_out.push(format!(
                    "{} has no place in a joint: {} ({})",
                    description.title,
                    description.equation,
                    values(repaired, active)
                ));
            }
        }
        terms
    }
}
