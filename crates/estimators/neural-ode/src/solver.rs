//! ODE solver: the classical fourth-order Runge–Kutta method on an even grid, dense output by cubic Hermite
//! interpolation, and the derivatives of both with respect to parameters.
//!
//! The grid does not depend on the peaks, so that a record with many peaks costs no more to solve. Values
//! between the nodes come from the interpolant, which has order four like the method.
//!
//! Reference: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, 2nd ed. (Springer
//! 1993), table II.1.2 (the method), section II.6 (dense output), section I.14 (derivatives).

use crate::field::Partials;
use nalgebra::DVector;

/// Scaled time of the start; the record ends at 1.
pub(crate) const START: f64 = -1.0;

/// Point at which the solver evaluates the vector field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stage {
    /// Scaled time.
    pub(crate) time: f64,
    /// State at that time.
    pub(crate) state: f64,
    /// Value of the field there.
    pub(crate) slope: f64,
}

/// Solution from −1 on.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Trajectory {
    /// Length of a step; negative backward in time.
    pub(crate) step: f64,
    /// Stages in the order of their computation: four per step, then the last node.
    pub(crate) stages: Vec<Stage>,
}

/// Derivatives of a solution with respect to the parameters; the last parameter is the initial state.
pub(crate) struct Sensitivities {
    /// Derivatives of the state at each node.
    pub(crate) states: Vec<DVector<f64>>,
    /// Derivatives of the slope at each node.
    pub(crate) slopes: Vec<DVector<f64>>,
    /// Derivatives of the curvatures, two per step.
    pub(crate) curvatures: Vec<DVector<f64>>,
}

/// Returns the length of a step if −1..1 is divided into `steps` of them.
fn step_length(steps: usize) -> f64 {
    -2.0 * START / steps as f64
}

/// Solves y′ = f(y, s) from y(−1) = `initial` to s = 1.
pub(crate) fn integrate<E>(
    field: impl FnMut(f64, f64) -> Result<f64, E>,
    initial: f64,
    steps: usize,
) -> Result<Trajectory, E> {
    march(field, initial, step_length(steps), steps)
}

/// Solves y′ = f(y, s) from y(−1) = `initial` over a number of steps, which may extend beyond s = 1, or go
/// backward in time if `step` is negative.
pub(crate) fn march<E>(
    mut field: impl FnMut(f64, f64) -> Result<f64, E>,
    initial: f64,
    step: f64,
    count: usize,
) -> Result<Trajectory, E> {
    let mut stages = Vec::with_capacity(4 * count + 1);
    let mut evaluate = |state: f64, time: f64| {
        field(state, time).inspect(|&slope| stages.push(Stage { time, state, slope }))
    };
    let mut state = initial;
    for at in 0..count {
        let time = START + at as f64 * step;
        let one = evaluate(state, time)?;
        let two = evaluate(state + 0.5 * step * one, time + 0.5 * step)?;
        let three = evaluate(state + 0.5 * step * two, time + 0.5 * step)?;
        let four = evaluate(state + step * three, time + step)?;
        state += step / 6.0 * (one + 2.0 * two + 2.0 * three + four);
    }
    evaluate(state, START + count as f64 * step)?;
    Ok(Trajectory { step, stages })
}

/// Returns the steps of a record's grid that lead from its start to a time: their signed length and their
/// number.
pub(crate) fn steps_to(time: f64, steps: usize) -> (f64, usize) {
    let step = step_length(steps).copysign(time - START);
    (step, ((time - START) / step).ceil().max(1.0) as usize)
}

impl Trajectory {
    /// Returns the nodes: the points between steps, and both ends.
    pub(crate) fn nodes(&self) -> impl Iterator<Item = &Stage> {
        self.stages.iter().step_by(4)
    }

    /// Returns y″ over the halves of each step, as differences of the slopes at its stages: two per step.
    pub(crate) fn curvatures(&self) -> impl Iterator<Item = f64> {
        let (steps, _) = self.stages.as_chunks::<4>();
        steps.iter().flat_map(|[one, two, three, four]| {
            [two.slope - one.slope, four.slope - three.slope].map(|change| 2.0 * change / self.step)
        })
    }

    /// Returns the derivatives with respect to the parameters of the field and the initial state. They are
    /// derivatives of the solver's own arithmetic, and so exact for the numerical solution.
    pub(crate) fn sensitivities(&self, partials: &Partials) -> Sensitivities {
        let own = partials.by_parameters.nrows();
        let step = self.step;
        // The rule d f(y(p), s; p)/dp = ∂f/∂y · dy/dp + ∂f/∂p is applied stage after stage.
        let mut columns = partials.by_parameters.column_iter().zip(&partials.by_state);
        let mut total = |state: &DVector<f64>| {
            columns.next().map_or_else(
                || DVector::zeros(own + 1),
                |(column, by_state)| {
                    let mut slope = state * *by_state;
                    let mut of_field = slope.rows_mut(0, own);
                    of_field += column;
                    slope
                },
            )
        };
        let mut state = DVector::zeros(own + 1);
        state.rows_mut(own, 1).fill(1.0);
        let mut found = Sensitivities { states: Vec::new(), slopes: Vec::new(), curvatures: Vec::new() };
        for _ in 0..self.stages.len() / 4 {
            let one = total(&state);
            let two = total(&(&state + &one * (0.5 * step)));
            let three = total(&(&state + &two * (0.5 * step)));
            let four = total(&(&state + &three * step));
            let next = &state + (&one + (&two + &three) * 2.0 + &four) * (step / 6.0);
            found.curvatures.push((two - &one) * (2.0 / step));
            found.curvatures.push((four - three) * (2.0 / step));
            found.states.push(std::mem::replace(&mut state, next));
            found.slopes.push(one);
        }
        found.slopes.push(total(&state));
        found.states.push(state);
        found
    }
}

/// Location of a time on the grid: its interval, and the Hermite weights of the state and the slope at the
/// interval's two ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Place {
    interval: usize,
    weights: [f64; 4],
}

impl Place {
    /// Locates a scaled time in −1..1 on a grid of `steps`.
    pub(crate) fn of(time: f64, steps: usize) -> Self {
        Self::on(time, step_length(steps), steps)
    }

    /// Locates a scaled time on a grid from −1 on, which goes backward in time if `step` is negative.
    pub(crate) fn on(time: f64, step: f64, steps: usize) -> Self {
        let along = (time - START) / step;
        let interval = (along.floor().max(0.0) as usize).min(steps.saturating_sub(1));
        let x = along - interval as f64;
        let (near, far) = (1.0 - x, x);
        let weights = [
            (1.0 + 2.0 * far) * near * near,
            step * far * near * near,
            (1.0 + 2.0 * near) * far * far,
            -step * near * far * far,
        ];
        Self { interval, weights }
    }

    /// Returns the value at this place of a function with the given states and slopes at the nodes.
    pub(crate) fn value(&self, nodes: &[Stage]) -> f64 {
        let [a, b, c, d] = self.weights;
        match nodes.get(self.interval..self.interval + 2) {
            Some([from, to]) => a * from.state + b * from.slope + c * to.state + d * to.slope,
            _ => f64::NAN,
        }
    }

    /// Returns the derivative at this place with respect to the parameters.
    pub(crate) fn sensitivity(&self, of: &Sensitivities) -> Option<DVector<f64>> {
        let [a, b, c, d] = self.weights;
        let ends = self.interval..self.interval + 2;
        let ([from, to], [from_slope, to_slope]) = (of.states.get(ends.clone())?, of.slopes.get(ends)?)
        else {
            return None;
        };
        let mut sum = from * a;
        sum.axpy(b, from_slope, 1.0);
        sum.axpy(c, to, 1.0);
        sum.axpy(d, to_slope, 1.0);
        Some(sum)
    }
}

#[cfg(test)]
mod tests {
    use super::{Place, Stage, integrate, march, steps_to};
    use std::convert::Infallible;

    /// The equation y′ = −(1 + s/2)·y² has the solution y = 1/(1 + (s + 1) + (s² − 1)/4) from y(−1) = 1.
    fn solve(steps: usize) -> Vec<Stage> {
        let field = |y: f64, s: f64| Ok::<f64, Infallible>(-(1.0 + s / 2.0) * y * y);
        integrate(field, 1.0, steps).unwrap().nodes().copied().collect()
    }

    fn truth(s: f64) -> f64 {
        1.0 / (1.0 + (s + 1.0) + (s * s - 1.0) / 4.0)
    }

    fn order(error: impl Fn(usize) -> f64, steps: usize) -> f64 {
        (error(steps) / error(2 * steps)).log2()
    }

    #[test]
    fn the_method_is_of_order_four() {
        let at_the_end = |steps: usize| (solve(steps)[steps].state - truth(1.0)).abs();
        let found = order(at_the_end, 160);
        assert!((found - 4.0).abs() < 0.05, "{found}");
    }

    #[test]
    fn the_dense_output_is_of_order_four() {
        let largest = |steps: usize| {
            let nodes = solve(steps);
            (0..=1000)
                .map(|i| {
                    let s = -1.0 + f64::from(i) / 500.0;
                    (Place::of(s, steps).value(&nodes) - truth(s)).abs()
                })
                .fold(0.0, f64::max)
        };
        let found = order(largest, 80);
        assert!((found - 4.0).abs() < 0.05, "{found}");
    }

    #[test]
    fn both_ends_of_the_time_are_nodes() {
        let nodes = solve(7);
        assert_eq!(nodes.len(), 8);
        assert_eq!(Place::of(-1.0, 7).value(&nodes), nodes[0].state);
        assert!((Place::of(1.0, 7).value(&nodes) - nodes[7].state).abs() < 1e-15);
        assert!((nodes[7].time - 1.0).abs() < 1e-15);
    }

    #[test]
    fn beyond_both_ends_it_goes_on() {
        let field = |y: f64, s: f64| Ok::<f64, Infallible>(-(1.0 + s / 2.0) * y * y);
        for time in [-1.3, -1.0, 0.4, 1.0, 2.2] {
            let (step, count) = steps_to(time, 200);
            let trajectory = march(field, 1.0, step, count).unwrap();
            let nodes: Vec<Stage> = trajectory.nodes().copied().collect();
            let found = Place::on(time, step, count).value(&nodes);
            assert!((found - truth(time)).abs() < 1e-8, "{time}: {found} {}", truth(time));
        }
    }
}
