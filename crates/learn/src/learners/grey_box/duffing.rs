//! Duffing oscillator with the imperfections of an electronic one.

use super::law::{Guess, Law, State, linear};
use crate::Place;
use crate::data::DataSet;
use crate::learners::library::weighted;
use serde::{Deserialize, Serialize};

/// Duffing oscillator whose circuit is not ideal:
///
/// θ̈ = b·u + a₀ + k₁·θ + k₂·θ² + k₃·θ³ + c·θ̇ + f·tanh(θ̇/v) + l·(θ̇³ + 3·θ·θ̇·α), where α is all before it, and what
/// is observed is y = θ + τ·θ̇ + p·θ³ + q·θ·θ̇².
///
/// The damping of small and of large swings differs by f/v and stays bounded. The term with l is the part of the
/// third derivative of θ³/6 that holds no change of the acceleration: the cubic force's third harmonic lags by more
/// than three times what its fundamental does. The observed quantity is delayed by −τ and distorted. No term
/// grows faster than θ³, so that the law holds beyond the swings that it was fitted to.
///
/// Wigren, Schoukens, Three free data sets for development and benchmarking in nonlinear system identification,
/// European Control Conference (2013), section III (the circuit).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Duffing {
    /// Sizes of position, velocity, input and acceleration, in which the parameters are counted.
    scale: [f64; 4],
}

/// Start of the speed at which the damping changes, in typical velocities, and of the change, as a share of the
/// damping.
const SPEED: f64 = 0.5;
const CHANGE: f64 = 0.01;

/// Least speed at which the damping changes, in typical velocities.
const LEAST_SPEED: f64 = 1e-3;

impl Duffing {
    /// Builds the law for a data set.
    pub(super) fn new(data: &DataSet) -> Self {
        let scale = &data.scale;
        let input = scale.input.hypot(scale.input_center);
        Self { scale: [scale.position, scale.velocity, input, scale.acceleration] }
    }

    /// Returns the units that the parameters are counted in.
    fn units(&self) -> [f64; 12] {
        let [x, v, u, a] = self.scale;
        let motion = [a / u, a / v, a / x, a / (x * x), a / (x * x * x), a];
        let [gain, damping, stiffness, square, cubic, constant] = motion;
        let [lag, delay, third, mixed] = [a / (v * v * v), x / v, (x * x).recip(), (v * v).recip()];
        [gain, damping, stiffness, square, cubic, constant, a, v, lag, delay, third, mixed]
    }
}

impl Law for Duffing {
    fn states(&self) -> usize {
        2
    }

    fn names(&self, unit: &str) -> Vec<(String, String)> {
        [
            ("u", format!("{unit}/s^2 per unit of u")),
            ("theta_dot", "1/s".to_owned()),
            ("theta", "1/s^2".to_owned()),
            ("theta^2", format!("1/({unit} s^2)")),
            ("theta^3", format!("1/({unit}^2 s^2)")),
            ("1", format!("{unit}/s^2")),
            ("damping.change", format!("{unit}/s^2")),
            ("damping.speed", format!("{unit}/s")),
            ("cubic.lag", format!("s/{unit}^2")),
            ("output.theta_dot", "s".to_owned()),
            ("output.theta^3", format!("1/{unit}^2")),
            ("output.theta*theta_dot^2", format!("s^2/{unit}^2")),
        ]
        .map(|(name, unit)| (name.to_owned(), unit))
        .to_vec()
    }

    fn stated(&self, parameters: &[f64]) -> Vec<f64> {
        parameters.iter().zip(self.units()).map(|(parameter, unit)| parameter * unit).collect()
    }

    /// Returns the linear law of the regression in weak form; empty without an input.
    fn guesses(&self, data: &DataSet) -> Vec<Guess> {
        let Some([gain, damping, stiffness, constant]) = linear(data) else { return Vec::new() };
        let [x, v, u, a] = self.scale;
        let damping = damping * v / a;
        let parameters = [
            gain * u / a,
            damping,
            stiffness * x / a,
            0.0,
            0.0,
            constant / a,
            CHANGE * damping,
            SPEED,
            0.0,
            0.0,
            0.0,
            0.0,
        ];
        vec![Guess {
            sizes: vec![1.0; parameters.len()],
            parameters: parameters.to_vec(),
            hidden: 0.0,
            first: (0..6).collect(),
        }]
    }

    fn sizes(&self, _data: &DataSet) -> State {
        let [position, velocity, ..] = self.scale;
        [position, velocity, 1.0]
    }

    #[inline]
    fn rate(&self, parameters: &[f64], [position, velocity, _]: State, input: f64) -> State {
        let [gain, damping, stiffness, square, cubic, constant, change, speed, lag, ..] = parameters else {
            return [f64::NAN; 3];
        };
        let [unit_x, unit_v, unit_u, unit_a] = self.scale;
        let (x, v, u) = (position / unit_x, velocity / unit_v, input / unit_u);
        let force = gain * u + constant + x * (stiffness + x * (square + x * cubic)) + damping * v;
        let force = force + change * (v / speed.abs().max(LEAST_SPEED)).tanh();
        // The product θ·θ̈ in units of the velocity's square.
        let product = x * force * unit_x * unit_a / (unit_v * unit_v);
        let force = force + lag * v * (v * v + 3.0 * product);
        [velocity, unit_a * force, 0.0]
    }

    #[inline]
    fn observed(&self, parameters: &[f64], [position, velocity, _]: State) -> f64 {
        let [.., delay, cubic, mixed] = parameters else { return f64::NAN };
        let [unit_x, unit_v, ..] = self.scale;
        let (x, v) = (position / unit_x, velocity / unit_v);
        unit_x * (x + delay * v + x * (cubic * x * x + mixed * v * v))
    }

    fn acceleration(&self, parameters: &[f64], place: &Place) -> Option<f64> {
        let [_, acceleration, _] = self.rate(parameters, [place.position, place.velocity, 0.0], place.input);
        Some(acceleration)
    }

    fn equation(&self, parameters: &[f64]) -> String {
        let stated = self.stated(parameters);
        let [gain, damping, stiffness, square, cubic, constant, change, speed, lag, delay, third, mixed] =
            stated.as_slice()
        else {
            return String::new();
        };
        let motion = weighted(&[
            (*gain, "*u"),
            (*damping, "*theta_dot"),
            (*stiffness, "*theta"),
            (*square, "*theta^2"),
            (*cubic, "*theta^3"),
            (*constant, ""),
        ]);
        let speed = speed.abs();
        format!(
            "theta_ddot ={motion} + {change:.4e}*tanh(theta_dot/{speed:.4e}) + {lag:.4e}*(theta_dot^3 + \
             3*theta*theta_dot*theta_ddot), observed: theta + {delay:.4e}*theta_dot + {third:.4e}*theta^3 + \
             {mixed:.4e}*theta*theta_dot^2"
        )
    }
}
