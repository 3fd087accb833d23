//! Oscillator with a hysteretic force after Bouc and Wen.

use super::law::{Guess, Law, State, linear};
use crate::data::DataSet;
use crate::learners::library::weighted;
use serde::{Deserialize, Serialize};

/// θ̈ = b·u − c·θ̇ − k·θ − z + a₀, where z is hidden: ż = a·θ̇ − β·(γ·|θ̇|·|z|ⁿ⁻¹·z + δ·θ̇·|z|ⁿ). The products βγ and
/// βδ are parameters, so that all seven and the exponent n can be told from a motion.
///
/// Wen, Journal of the Engineering Mechanics Division 102 (1976) 249-263, with the signs of Noël, Schoukens,
/// Hysteretic benchmark with a dynamic nonlinearity, Workshop on Nonlinear System Identification Benchmarks
/// (2016).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct BoucWen {}

/// Shares of the stiffness that a search starts from in the hysteretic force.
const SHARES: [f64; 2] = [0.5, 0.2];

impl Law for BoucWen {
    fn states(&self) -> usize {
        3
    }

    fn names(&self, unit: &str) -> Vec<(String, String)> {
        [
            ("u", format!("{unit}/s^2 per unit of u")),
            ("theta_dot", "1/s".to_owned()),
            ("theta", "1/s^2".to_owned()),
            ("1", format!("{unit}/s^2")),
            ("hysteresis.stiffness", "1/s^2".to_owned()),
            ("hysteresis.dissipation", format!("1/{unit} at an exponent of 1")),
            ("hysteresis.asymmetry", format!("1/{unit} at an exponent of 1")),
            ("hysteresis.exponent", String::new()),
        ]
        .map(|(name, unit)| (name.to_owned(), unit))
        .to_vec()
    }

    /// Returns the linear law of the regression in weak form, with a share of its stiffness in the hysteretic
    /// force, which does not dissipate yet.
    fn guesses(&self, data: &DataSet) -> Vec<Guess> {
        let Some([gain, damping, stiffness, constant]) = linear(data) else { return Vec::new() };
        let stiffness = stiffness.abs();
        // Little dissipation over a typical displacement.
        let dissipation = 0.1 / data.scale.position;
        let guess = |share: f64| {
            let (elastic, hysteretic) = ((1.0 - share) * stiffness, share * stiffness);
            let parameters = vec![gain, -damping, elastic, constant, hysteretic, dissipation, 0.0, 1.0];
            let acceleration = data.scale.acceleration;
            let damping = damping.abs().max(0.01 * stiffness.sqrt());
            let sizes =
                vec![gain, damping, elastic, 0.1 * acceleration, hysteretic, dissipation, dissipation, 0.1];
            Guess { parameters, sizes, hidden: 0.0, first: vec![0, 1, 2, 4, 5, 6] }
        };
        SHARES.into_iter().map(guess).collect()
    }

    fn sizes(&self, data: &DataSet) -> State {
        [data.scale.position, data.scale.velocity, data.scale.acceleration]
    }

    fn rate(&self, parameters: &[f64], [x, v, z]: State, input: f64) -> State {
        let [gain, damping, stiffness, constant, hysteretic, dissipation, asymmetry, exponent] = parameters
        else {
            return [f64::NAN; 3];
        };
        let size = if *exponent == 1.0 { z.abs() } else { z.abs().powf(exponent.max(0.1)) };
        let force = hysteretic * v - size * (dissipation * v.abs() * z.signum() + asymmetry * v);
        [v, gain * input - damping * v - stiffness * x + constant - z, force]
    }

    fn equation(&self, parameters: &[f64]) -> String {
        let [gain, damping, stiffness, constant, hysteretic, dissipation, asymmetry, exponent] = parameters
        else {
            return String::new();
        };
        let motion = [(*gain, "*u"), (-damping, "*theta_dot"), (-stiffness, "*theta"), (*constant, "")];
        let memory = [(*dissipation, "*|theta_dot|*sign(z)"), (*asymmetry, "*theta_dot")];
        let (motion, memory) = (weighted(&motion), weighted(&memory));
        format!("theta_ddot ={motion} - z, z_dot = {hysteretic:.5}*theta_dot - |z|^{exponent:.4}*({memory} )")
    }
}
