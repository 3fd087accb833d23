//! Levenberg–Marquardt over all segments at once, with the start states eliminated.
//!
//! The normal equations have the shape of an arrow: each segment's start state affects only its own samples,
//! the global parameters affect all. Start states are eliminated segment by segment (Schur complement), so
//! that the cost is linear in the number of samples. Bounds hold by projection: a parameter that a step would
//! push out of its range stays at the limit, and the step is solved again for the others.
//!
//! Each diagonal entry is raised by a fraction of itself. A ridge proportional to the largest entry held the
//! coefficient of a cubic spring in place, because its unit makes its column small.
//!
//! # Reference
//! Marquardt, Journal of the Society for Industrial and Applied Mathematics 11 (1963) 431 (scaling by the
//! diagonal); Nielsen, Technical University of Denmark IMM-REP-1999-05 (update of the damping from the gain);
//! Bock, in Modelling of Chemical Reaction Systems, Springer 1981, 102 (multiple shooting).

use crate::data::segments::{Data, Segment};
use crate::fit::fitted::{Fit, Point};
use crate::fit::normal_equations::NormalEquations;
use crate::fit::restart::settle;
use crate::fit::stopping::{Ending, SHORT, Stopping};
use crate::model::candidate::Parameter;
use crate::model::hypothesis::Hypothesis;
use crate::model::predictor::{Derivatives, Prediction, Simulator};
use crate::noise::statistics::median;
use dynamics::DynamicsError;
use least_squares::Method;
use nalgebra::DVector;

/// Parameters that a fit moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Moving {
    /// Start states only.
    Starts,
    /// Start states and every global parameter.
    All,
}

fn evaluate(
    simulator: &mut Simulator<'_>,
    segments: &[Segment],
    point: &Point,
) -> Result<Vec<Prediction>, DynamicsError> {
    simulator.set(&point.globals)?;
    segments.iter().zip(&point.starts).map(|(segment, start)| simulator.predict(segment, start)).collect()
}

/// Evaluates a trial that is of use only below a bound on the weighted squares; `None` as soon as the squares
/// exceed it, which saves the remaining segments.
fn evaluate_below(
    simulator: &mut Simulator<'_>,
    segments: &[Segment],
    point: &Point,
    weights: &[f64],
    bound: f64,
) -> Option<Vec<Prediction>> {
    simulator.set(&point.globals).ok()?;
    let mut predictions = Vec::with_capacity(segments.len());
    let mut total = 0.0;
    for ((segment, start), weight) in segments.iter().zip(&point.starts).zip(weights) {
        let prediction = simulator.predict(segment, start).ok()?;
        total += weight * prediction.residual.norm_squared();
        // A residual that is NaN is not a gain either.
        if total.is_nan() || total > bound {
            return None;
        }
        predictions.push(prediction);
    }
    Some(predictions)
}

/// Returns the sum of squared residuals of a hypothesis at a point.
///
/// # Errors
/// Returns an error if the motion cannot be computed at that point.
pub(crate) fn squares(data: &Data, hypothesis: &Hypothesis, point: &Point) -> Result<f64, DynamicsError> {
    let mut simulator = Simulator::new(data, hypothesis, &point.globals, Derivatives::None)?;
    let at = evaluate(&mut simulator, &data.segments, point)?;
    Ok(at.iter().map(|prediction| prediction.residual.norm_squared()).sum())
}

/// Returns the residuals at a fit's point on other data with the same segments, such as with other inputs.
///
/// # Errors
/// Returns an error if the motion cannot be computed there.
pub(crate) fn residuals(data: &Data, at: &Fit) -> Result<Vec<DVector<f64>>, DynamicsError> {
    let mut simulator = Simulator::new(data, &at.hypothesis, &at.point.globals, Derivatives::None)?;
    let predictions = evaluate(&mut simulator, &data.segments, &at.point)?;
    Ok(predictions.into_iter().map(|prediction| prediction.residual).collect())
}

/// Rule for the damping, which stays as it is after a step that gained less than half of what it promised. With
/// too small a factor after a step that gained nothing, the next one hardly differs: with Nielsen's 2 and a
/// damping of 1e-4, four out of five steps that followed a failed one failed as well. [`Ending`] has the limits.
const METHOD: Method = Method {
    first: 1e-4,
    cut: (1.0 / 3.0, 1.0),
    least: 1e-12,
    raise: 8.0,
    growth: 8.0,
    least_raised: 1e-6,
    max_rejections: u32::MAX,
    ..Method::NIELSEN
};

/// Mean square, relative to the median over the segments, beyond which a segment gets less weight.
const DOUBTFUL: f64 = 2.0;

/// Returns the weights of the segments: 1 up to [`DOUBTFUL`], falling with the mean square beyond it.
fn trust(predictions: &[Prediction]) -> Vec<f64> {
    let own: Vec<f64> = predictions.iter().map(Prediction::mean_square).collect();
    let usual = median(&own).max(f64::MIN_POSITIVE);
    own.into_iter().map(|square| (DOUBTFUL * usual / square.max(f64::MIN_POSITIVE)).min(1.0)).collect()
}

fn weighted(predictions: &[Prediction], weights: &[f64]) -> f64 {
    predictions.iter().zip(weights).map(|(p, weight)| weight * p.residual.norm_squared()).sum()
}

/// State of a running fit.
struct Descent<'a> {
    data: &'a Data,
    hypothesis: &'a Hypothesis,
    parameters: Vec<Parameter>,
    moving: Moving,
    effort: Stopping,
    simulator: Simulator<'a>,
    point: Point,
    at: Vec<Prediction>,
    /// Weights of the segments: below 1 for segments that fit badly while the descent is `wary`.
    weights: Vec<f64>,
    system: NormalEquations,
    course: least_squares::Descent,
    ending: Ending,
    wary: bool,
    /// `true` if segments have begun again since the last step with a large gain.
    settled: bool,
    /// `true` if an attempt to begin again gained nothing before the end: the next attempt is then made at
    /// the end only.
    in_vain: bool,
}

impl<'a> Descent<'a> {
    fn new(
        data: &'a Data,
        hypothesis: &'a Hypothesis,
        mut point: Point,
        moving: Moving,
        effort: Stopping,
    ) -> Result<Self, DynamicsError> {
        let parameters = hypothesis.parameters(&data.facts);
        let derivatives = match moving {
            Moving::Starts => Derivatives::Starts,
            Moving::All => Derivatives::All,
        };
        for (value, parameter) in point.globals.iter_mut().zip(&parameters) {
            *value = value.clamp(parameter.lower, parameter.upper);
        }
        let mut simulator = Simulator::new(data, hypothesis, &point.globals, derivatives)?;
        let at = evaluate(&mut simulator, &data.segments, &point)?;
        let wary = !hypothesis.smooth() && effort.wary;
        let weights = if wary { trust(&at) } else { vec![1.0; data.segments.len()] };
        let mut own = Self {
            data,
            hypothesis,
            system: NormalEquations::of(&[], &[], Vec::new(), 0),
            parameters,
            moving,
            effort,
            simulator,
            point,
            at,
            weights,
            course: least_squares::Descent::new(METHOD),
            ending: Ending::new(if wary { effort.roughly() } else { effort }),
            wary,
            settled: false,
            in_vain: false,
        };
        own.system = own.equations(&own.weights);
        Ok(own)
    }

    fn equations(&self, weights: &[f64]) -> NormalEquations {
        let globals = if self.moving == Moving::All { self.parameters.len() } else { 0 };
        NormalEquations::of(&self.at, weights, self.hypothesis.start_sizes(&self.data.facts), globals)
    }

    /// Returns `true` if a step moves sizes only and not yet shapes.
    fn is_of_sizes(&self, step: usize) -> bool {
        step <= self.effort.sizes_first
    }

    /// Tries a step.
    fn step(&mut self, step: usize) {
        let sizes = self.is_of_sizes(step);
        let is_held = |own: &Parameter| self.moving == Moving::Starts || sizes && own.shape;
        let held = self.parameters.iter().map(is_held).collect();
        let before = weighted(&self.at, &self.weights);
        let (trial, promised) = self.system.trial(&self.point, self.course.damping, &self.parameters, held);
        // A step that promises next to nothing is not worth a trial.
        let done = self.ending.promises_nothing(promised / before, self.course.damping);
        let outcome = trial.filter(|_| !done || sizes).and_then(|next| {
            let simulator = &mut self.simulator;
            let evaluation = evaluate_below(simulator, &self.data.segments, &next, &self.weights, before)?;
            Some((next, evaluation))
        });
        match outcome {
            Some((next, evaluation)) => {
                let decrease = before - weighted(&evaluation, &self.weights);
                self.ending.gained(decrease / before, self.course.damping, &evaluation);
                self.course.accept(decrease / promised, decrease / before);
                (self.point, self.at) = (next, evaluation);
                self.gained();
            }
            None if done => self.ending.nothing_left(),
            None => {
                self.course.reject();
                if !sizes {
                    self.ending.failed(promised / before, self.course.damping);
                }
            }
        }
    }

    /// Continues from a step that gained.
    fn gained(&mut self) {
        if self.wary {
            self.weights = trust(&self.at);
        }
        if !self.ending.is_small() {
            self.settled = false;
        }
        self.system = self.equations(&self.weights);
    }

    /// Ends the wary phase, or lets segments that fit badly begin again, if it is time for either. Returns
    /// `true` if the descent continues from there.
    fn begins_again(&mut self, step: usize, ended: bool) -> Result<bool, DynamicsError> {
        if self.wary && (ended || step >= self.effort.steps / 2) {
            self.wary = false;
            self.weights = vec![1.0; self.data.segments.len()];
            self.settle()?;
            self.ending = Ending::new(self.effort);
        } else {
            let may = !self.hypothesis.smooth() && self.effort.begins_again && !self.settled;
            if !may || !ended && (self.course.damping <= SHORT || self.in_vain) {
                return Ok(false);
            }
            self.settled = true;
            if !self.settle()? {
                self.in_vain = true;
                return Ok(false);
            }
            self.ending.begin_again();
        }
        (self.course.damping, self.settled) = (METHOD.first, true);
        self.system = self.equations(&self.weights);
        Ok(true)
    }

    /// Lets segments that fit badly begin again with the present coefficients. Returns `true` if any did.
    fn settle(&mut self) -> Result<bool, DynamicsError> {
        // A failed trial has left its coefficients in the simulator.
        self.simulator.set(&self.point.globals)?;
        let better = settle(self.data, self.hypothesis, &self.point, &self.at)?;
        let mut begun = false;
        for (index, start) in better {
            let Some(segment) = self.data.segments.get(index) else { continue };
            let prediction = self.simulator.predict(segment, &start)?;
            if let (Some(slot), Some(known)) = (self.at.get_mut(index), self.point.starts.get_mut(index)) {
                (*slot, *known) = (prediction, start);
                begun = true;
            }
        }
        Ok(begun)
    }

    fn finished(self, converged: bool) -> Fit {
        let inverse = self.equations(&vec![1.0; self.data.segments.len()]).inverse(&self.parameters);
        let at_end = |(value, own): (&f64, &Parameter)| *value <= own.lower || *value >= own.upper;
        Fit {
            hypothesis: self.hypothesis.clone(),
            at_bound: self.point.globals.iter().zip(&self.parameters).map(at_end).collect(),
            squares: self.at.iter().map(|prediction| prediction.residual.norm_squared()).sum(),
            residuals: self.at.into_iter().map(|prediction| prediction.residual).collect(),
            point: self.point,
            converged,
            inverse,
        }
    }
}

/// Fits a hypothesis, beginning at a point.
///
/// # Errors
/// Returns an error if the motion cannot be computed at that point.
pub(crate) fn fit(
    data: &Data,
    hypothesis: &Hypothesis,
    from: Point,
    moving: Moving,
    effort: Stopping,
) -> Result<Fit, DynamicsError> {
    let mut descent = Descent::new(data, hypothesis, from, moving, effort)?;
    for step in 1..=effort.steps {
        descent.step(step);
        let sizes = descent.is_of_sizes(step);
        let ended = !sizes && descent.ending.is_reached(descent.course.damping);
        if descent.begins_again(step, ended)? {
            continue;
        }
        if ended {
            return Ok(descent.finished(true));
        }
        let squares = weighted(&descent.at, &descent.weights);
        if !sizes && !descent.wary && descent.ending.is_in_vain(squares, step) {
            break;
        }
    }
    Ok(descent.finished(false))
}

#[cfg(test)]
#[path = "levenberg_marquardt_tests.rs"]
mod tests;
