//! Polynomial acceleration: a Duffing oscillator of higher order.

use super::law::{Guess, Law, State};
use crate::Place;
use crate::data::DataSet;
use crate::learners::library::{Term, signed};
use crate::learners::weak_sindy::regression;
use crate::linear::least_squares;
use serde::{Deserialize, Serialize};

/// Highest total degree that any law has.
const MOST: usize = 5;

/// Number of powers of a variable.
const POWERS: usize = MOST + 1;

/// Highest degree in position and velocity of what the input is multiplied by.
const OF_INPUT: usize = 2;

/// θ̈ = Σ w·θⁱ·θ̇ʲ + u·Σ w·θⁱ·θ̇ʲ with i + j up to the degree in the first sum, and up to 2 in the second. Variables
/// are scaled, so that weights are of similar size.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Polynomial {
    /// Powers of position, velocity and input of each term.
    terms: Vec<[usize; 3]>,
    /// Sizes of position, velocity, input and acceleration.
    scale: [f64; 4],
}

impl Polynomial {
    /// Builds the law of a degree up to 5, for a data set.
    pub(super) fn new(degree: usize, data: &DataSet) -> Self {
        let degree = degree.min(MOST);
        let powers = |most: usize, input: usize| {
            (0..=most).flat_map(move |total| (0..=total).rev().map(move |i| [i, total - i, input]))
        };
        let of_input = if data.is_driven() { OF_INPUT + 1 } else { 0 };
        let terms = powers(degree, 0).chain(powers(OF_INPUT, 1).filter(|_| of_input > 0)).collect();
        let scale = &data.scale;
        let spread = scale.input.hypot(scale.input_center);
        Self { terms, scale: [scale.position, scale.velocity, spread, scale.acceleration] }
    }

    /// Returns a weight's size in units of its term.
    fn size(&self, [i, j, k]: [usize; 3]) -> f64 {
        let [position, velocity, input, acceleration] = self.scale;
        acceleration / (position.powi(i as i32) * velocity.powi(j as i32) * input.powi(k as i32))
    }
}

fn powers(x: f64) -> [f64; POWERS] {
    let mut all = [1.0; POWERS];
    let mut power = 1.0;
    for own in all.iter_mut().skip(1) {
        power *= x;
        *own = power;
    }
    all
}

fn name([i, j, k]: [usize; 3]) -> String {
    let factors = [("theta", i), ("theta_dot", j), ("u", k)].into_iter().filter(|(_, power)| *power > 0);
    let words: Vec<String> = factors
        .map(|(name, power)| if power == 1 { name.to_owned() } else { format!("{name}^{power}") })
        .collect();
    if words.is_empty() { "1".to_owned() } else { words.join("*") }
}

impl Law for Polynomial {
    fn states(&self) -> usize {
        2
    }

    fn names(&self, unit: &str) -> Vec<(String, String)> {
        let unit = format!("{unit}/s^2 per unit of the term");
        self.terms.iter().map(|term| (name(*term), unit.clone())).collect()
    }

    fn stated(&self, parameters: &[f64]) -> Vec<f64> {
        self.terms.iter().zip(parameters).map(|(term, weight)| weight * self.size(*term)).collect()
    }

    /// Returns the linear law of the regression in weak form.
    fn guesses(&self, data: &DataSet) -> Vec<Guess> {
        let linear = [Term::Constant, Term::Position, Term::Velocity, Term::Input];
        let linear: Vec<Term> =
            linear.into_iter().filter(|term| *term != Term::Input || data.is_driven()).collect();
        let rows = regression(data, &linear);
        let Some(found) = least_squares(&rows.rows, &rows.right) else { return Vec::new() };
        let of = |term: &[usize; 3]| {
            let own = match term {
                [0, 0, 0] => Term::Constant,
                [1, 0, 0] => Term::Position,
                [0, 1, 0] => Term::Velocity,
                [0, 0, 1] => Term::Input,
                _ => return None,
            };
            linear.iter().zip(found.iter()).find(|(other, _)| **other == own).map(|(_, weight)| *weight)
        };
        // Terms that are not linear start from a weight of zero.
        let weight = |term: &[usize; 3]| of(term).unwrap_or(0.0) / self.size(*term);
        let parameters: Vec<f64> = self.terms.iter().map(weight).collect();
        let cubic = |term: &[usize; 3]| of(term).is_some() || *term == [3, 0, 0];
        let first = self.terms.iter().enumerate().filter(|(_, term)| cubic(term)).map(|(at, _)| at).collect();
        vec![Guess { sizes: vec![1.0; self.terms.len()], parameters, hidden: 0.0, first }]
    }

    fn sizes(&self, _data: &DataSet) -> State {
        let [position, velocity, ..] = self.scale;
        [position, velocity, 1.0]
    }

    fn rate(&self, parameters: &[f64], [x, v, _]: State, input: f64) -> State {
        let [position, velocity, spread, acceleration] = self.scale;
        let (xs, vs, us) = (powers(x / position), powers(v / velocity), [1.0, input / spread]);
        let at = |powers: &[f64], power: usize| {
            debug_assert!(power < powers.len(), "the powers of a term are those of the highest degree");
            // Invariant above.
            powers.get(power).copied().unwrap_or(0.0)
        };
        let term = |[i, j, k]: &[usize; 3]| at(&xs, *i) * at(&vs, *j) * at(&us, *k);
        let sum: f64 = self.terms.iter().zip(parameters).map(|(own, weight)| weight * term(own)).sum();
        [v, acceleration * sum, 0.0]
    }

    fn acceleration(&self, parameters: &[f64], place: &Place) -> Option<f64> {
        let [_, acceleration, _] = self.rate(parameters, [place.position, place.velocity, 0.0], place.input);
        Some(acceleration)
    }

    fn equation(&self, parameters: &[f64]) -> String {
        let weights = self.stated(parameters);
        let terms = self.terms.iter().zip(&weights).enumerate();
        let words = terms.map(|(number, (term, weight))| match term {
            [0, 0, 0] => signed(number, *weight),
            _ => format!("{}*{}", signed(number, *weight), name(*term)),
        });
        format!("theta_ddot ={}", words.collect::<String>())
    }
}
