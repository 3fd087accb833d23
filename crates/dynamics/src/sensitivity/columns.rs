//! Taylor series of the derivatives of the state.

#![allow(clippy::indexing_slicing, reason = "a remainder is below the number of lanes")]

use super::graph::MOST_STATES;
use super::series::{LENGTH, Series, head};

/// Number of columns that are computed side by side.
pub(crate) const LANES: usize = 4;

pub(crate) type Lanes = [f64; LANES];

/// Series of a few columns, side by side.
type Wide = [Lanes; LENGTH];

/// Derivatives of every state variable with respect to four free quantities.
#[derive(Debug, Clone)]
struct Block {
    /// Series of the derivatives.
    states: [Wide; MOST_STATES],
    /// Series of the direct influence of the free quantities on the rates.
    sources: [Wide; MOST_STATES],
}

/// Dependence of the rate of one state variable on another state variable.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Coupling {
    pub(crate) rate: usize,
    pub(crate) state: usize,
    /// Number of coefficients in use; those from `length` on are zero.
    pub(crate) length: usize,
    pub(crate) series: Series,
}

/// Derivatives of the state with respect to all free quantities.
#[derive(Debug, Clone)]
pub(crate) struct Columns {
    blocks: Vec<Block>,
    columns: usize,
    states: usize,
}

impl Columns {
    pub(crate) fn new(columns: usize, states: usize) -> Self {
        let zero = [[[0.0; LANES]; LENGTH]; MOST_STATES];
        let block = Block { states: zero, sources: zero };
        Self { blocks: vec![block; columns.div_ceil(LANES)], columns, states }
    }

    /// Clears every derivative.
    pub(crate) fn clear(&mut self) {
        for block in &mut self.blocks {
            for state in &mut block.states {
                state.fill([0.0; LANES]);
            }
        }
    }

    /// Clears the direct influences on a rate, below a degree.
    pub(crate) fn clear_sources(&mut self, rate: usize, degree: usize) {
        for source in self.blocks.iter_mut().filter_map(|block| block.sources.get_mut(rate)) {
            for lanes in source.iter_mut().take(degree) {
                *lanes = [0.0; LANES];
            }
        }
    }

    /// Adds `factor` times a series to the direct influence of a free quantity on a rate, from degree `from`
    /// on.
    pub(crate) fn add_source(
        &mut self,
        column: usize,
        rate: usize,
        series: &[f64],
        factor: f64,
        from: usize,
    ) {
        debug_assert!(column < self.columns && rate < self.states, "column {column}, rate {rate}");
        let block = self.blocks.get_mut(column / LANES);
        let Some(source) = block.and_then(|block| block.sources.get_mut(rate)) else { return };
        for (lanes, value) in source.iter_mut().skip(from).zip(series) {
            if let Some(lane) = lanes.get_mut(column % LANES) {
                *lane += factor * value;
            }
        }
    }

    /// Returns the derivative of a state variable at the start of the step.
    pub(crate) fn first(&self, column: usize, state: usize) -> f64 {
        let wide = self.blocks.get(column / LANES).and_then(|block| block.states.get(state));
        let [first, ..] = wide.unwrap_or(&[[0.0; LANES]; LENGTH]);
        debug_assert!(column < self.columns && state < MOST_STATES, "column {column}, state {state}");
        first[column % LANES]
    }

    /// Returns the same derivative as a mutable reference.
    pub(crate) fn first_mut(&mut self, column: usize, state: usize) -> Option<&mut f64> {
        let wide = self.blocks.get_mut(column / LANES)?.states.get_mut(state)?;
        let [first, ..] = wide;
        first.get_mut(column % LANES)
    }

    /// Solves the variational equation along a step, up to and including a degree. `links` names the state
    /// variable that a rate is identical to, if any.
    pub(crate) fn propagate(&mut self, couplings: &[Coupling], links: &[Option<usize>], degree: usize) {
        for k in 0..degree {
            let divisor = 1.0 / (k + 1) as f64;
            for rate in 0..self.states {
                let link = links.get(rate).copied().flatten();
                // The loop over blocks is innermost because their sums do not wait for one another.
                for block in &mut self.blocks {
                    let mut sum = match link {
                        Some(state) => coefficient(&block.states, state, k),
                        None => {
                            let mut sum = coefficient(&block.sources, rate, k);
                            for coupling in couplings.iter().filter(|coupling| coupling.rate == rate) {
                                let Some(state) = block.states.get(coupling.state) else { continue };
                                product(coupling, state, k, &mut sum);
                            }
                            sum
                        }
                    };
                    for lane in &mut sum {
                        *lane *= divisor;
                    }
                    let state = block.states.get_mut(rate);
                    if let Some(slot) = state.and_then(|state| state.get_mut(k + 1)) {
                        *slot = sum;
                    }
                }
            }
        }
    }

    /// Moves the start of the step to a time within it.
    pub(crate) fn advance(&mut self, time: f64, degree: usize) {
        for block in &mut self.blocks {
            for state in block.states.iter_mut().take(self.states) {
                let value = value(state, time, degree);
                let [first, ..] = state;
                *first = value;
            }
        }
    }

    /// Writes the derivatives of a state variable at a time within the step.
    #[inline]
    pub(crate) fn write(&self, state: usize, time: f64, degree: usize, row: &mut [f64]) {
        for (block, slots) in self.blocks.iter().zip(row.chunks_mut(LANES)) {
            let Some(series) = block.states.get(state) else { continue };
            for (slot, lane) in slots.iter_mut().zip(value(series, time, degree)) {
                *slot = lane;
            }
        }
    }

    /// Writes the time derivatives of the derivatives of a state variable.
    pub(crate) fn write_slope(&self, state: usize, time: f64, degree: usize, row: &mut [f64]) {
        for (block, slots) in self.blocks.iter().zip(row.chunks_mut(LANES)) {
            let Some(series) = block.states.get(state) else { continue };
            let mut sum = [0.0; LANES];
            for (power, lanes) in series.iter().enumerate().take(degree + 1).skip(1).rev() {
                for (sum, lane) in sum.iter_mut().zip(lanes) {
                    *sum = *sum * time + lane * power as f64;
                }
            }
            for (slot, lane) in slots.iter_mut().zip(sum) {
                *slot = lane;
            }
        }
    }

    pub(crate) fn count(&self) -> usize {
        self.columns
    }
}

#[inline]
fn coefficient(wide: &[Wide; MOST_STATES], state: usize, degree: usize) -> Lanes {
    debug_assert!(state < MOST_STATES && degree < LENGTH, "coefficient {degree} of state {state}");
    wide.get(state).and_then(|wide| wide.get(degree)).copied().unwrap_or([0.0; LANES])
}

/// Adds coefficient `degree` of the product of a coupling and a state's series.
#[inline]
fn product(coupling: &Coupling, state: &Wide, degree: usize, sum: &mut Lanes) {
    let reversed = head(state, degree + 1).iter().rev();
    for (factor, lanes) in coupling.series.iter().take(coupling.length).zip(reversed) {
        for (sum, lane) in sum.iter_mut().zip(lanes) {
            *sum += factor * lane;
        }
    }
}

/// Evaluates a series of four columns by Horner's rule.
#[inline]
fn value(series: &Wide, time: f64, degree: usize) -> Lanes {
    let mut sum = [0.0; LANES];
    for lanes in head(series, degree + 1).iter().rev() {
        for (sum, lane) in sum.iter_mut().zip(lanes) {
            *sum = *sum * time + lane;
        }
    }
    sum
}
