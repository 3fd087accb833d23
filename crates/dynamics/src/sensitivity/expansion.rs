//! Taylor expansion of a state.

use super::graph::{Graph, MOST_STATES};
use super::series::Series;

/// Expands the state into its series and returns the degree used. A lower degree than `most` may suffice if
/// the step cannot be long (`room`).
pub(super) fn expand(
    graph: &mut Graph,
    series: &mut [Series; MOST_STATES],
    states: usize,
    most: usize,
    room: f64,
    scale: &[f64; MOST_STATES],
    tolerance: f64,
) -> usize {
    let mut small = 0;
    let mut power = 1.0;
    for degree in 0..most {
        graph.extend(degree);
        let divisor = 1.0 / (degree + 1) as f64;
        power *= room;
        let mut negligible = true;
        for (variable, (series, scale)) in series.iter_mut().zip(scale).enumerate().take(states) {
            debug_assert!(variable < graph.rates.len(), "a rate for each of {states} state variables");
            let Some(&node) = graph.rates.get(variable) else { continue };
            let coefficient = graph.coefficient(node, degree) * divisor;
            graph.set_state(variable, degree + 1, coefficient);
            if let Some(slot) = series.get_mut(degree + 1) {
                *slot = coefficient;
            }
            negligible &= coefficient.abs() * power <= 0.1 * tolerance * scale;
        }
        small = if negligible { small + 1 } else { 0 };
        if small >= 2 && degree >= 3 {
            graph.extend(degree + 1);
            return degree + 1;
        }
    }
    graph.extend(most);
    most
}
