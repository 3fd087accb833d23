//! Laws of grey-box models: differential equations with parameters and, possibly, a hidden state.

use crate::Place;
use crate::data::{DataSet, Trajectory};
use crate::flow::first_guess;
use crate::learners::library::Term;
use crate::learners::weak_sindy::regression;
use crate::linear::least_squares;

/// State of a law. The first entry is the observed quantity, unless the law says otherwise; a law with two states
/// leaves the last at 0.
pub(super) type State = [f64; 3];

/// Start of a search: parameters, and the part of them that is fitted first, beside the start states.
#[derive(Debug, Clone)]
pub(super) struct Guess {
    /// All parameters.
    pub(super) parameters: Vec<f64>,
    /// Typical sizes of the parameters.
    pub(super) sizes: Vec<f64>,
    /// Hidden state at the start of every part.
    pub(super) hidden: f64,
    /// Indices of the parameters that are fitted first.
    pub(super) first: Vec<usize>,
}

/// Returns gain, damping, stiffness and constant of the linear law θ̈ = b·u + c·θ̇ + k·θ + a₀ by the regression in weak form;
/// `None` without an input.
pub(super) fn linear(data: &DataSet) -> Option<[f64; 4]> {
    if !data.is_driven() {
        return None;
    }
    let rows = regression(data, &[Term::Input, Term::Velocity, Term::Position, Term::Constant]);
    least_squares(&rows.rows, &rows.right)?.as_slice().try_into().ok()
}

/// Law with parameters: rates of the states.
pub(super) trait Law: Send + Sync {
    /// Returns the number of states, 2 or 3.
    fn states(&self) -> usize;

    /// Returns the names of the parameters and their units, for positions in `unit`.
    fn names(&self, unit: &str) -> Vec<(String, String)>;

    /// Returns the parameters in the units of their names.
    fn stated(&self, parameters: &[f64]) -> Vec<f64> {
        parameters.to_vec()
    }

    /// Returns starts of a search; empty if the law does not apply to the data.
    fn guesses(&self, data: &DataSet) -> Vec<Guess>;

    /// Returns a state from which the start state of a piece is searched; `hidden` is typical of the hidden state.
    fn start(&self, piece: &Trajectory, period_s: f64, hidden: f64) -> State {
        let state = first_guess(piece, period_s);
        [state.position, state.velocity, hidden]
    }

    /// Returns the typical sizes of the states.
    fn sizes(&self, data: &DataSet) -> State;

    /// Returns the rates of the states.
    fn rate(&self, parameters: &[f64], state: State, input: f64) -> State;

    /// Returns the state after a step, within its limits.
    fn limited(&self, _parameters: &[f64], state: State) -> State {
        state
    }

    /// Returns the observed quantity in a state.
    fn observed(&self, _parameters: &[f64], [observed, ..]: State) -> f64 {
        observed
    }

    /// Returns the hidden state of which a start search needs a typical value; 0 if there is none.
    fn hidden(&self, _state: State) -> f64 {
        0.0
    }

    /// Returns the acceleration without an effect of hidden states; `None` if it is not a function of position,
    /// velocity and input.
    fn acceleration(&self, _parameters: &[f64], _place: &Place) -> Option<f64> {
        None
    }

    /// Returns the law as text.
    fn equation(&self, parameters: &[f64]) -> String;
}
