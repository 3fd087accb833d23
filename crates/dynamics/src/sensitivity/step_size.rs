//! How far a step by Taylor series reaches.

use super::graph::MOST_STATES;
use super::march::March;
use super::series::{Series, head, slope, value};
use crate::field::State;
use crate::system::ROUNDING;

/// Parts of a step at which its defect is looked at.
const PARTS: [f64; 2] = [1.0, 0.6];

/// Largest defect of a step in units of the tolerance: what the first neglected term brings, times the degree.
const MOST_DEFECT: f64 = 20.0;

impl March<'_> {
    /// The largest step for which the last two coefficients of every series are below the tolerance, and
    /// those behind them fall off.
    pub(super) fn step_size(&self, series: &[Series; MOST_STATES], degree: usize, number: usize) -> f64 {
        let mut tails = Tails::default();
        for (series, &scale) in series.iter().zip(&self.scale).take(self.model.states) {
            tails.take(series, degree, self.reach(series, scale));
        }
        if self.mode.sticks()
            && let Some(piece) = self.model.graphs.get(number)
        {
            // Nothing moves but the torque: the step has to resolve it, or a break-away is missed.
            let holding = self.model.field.holding_torque().unwrap_or(1.0).abs();
            for (_, node) in &piece.graph.edges {
                tails.take(piece.graph.series(*node), degree, holding);
            }
        }
        tails.step_size(degree, self.model.settings.tolerance)
    }

    /// The size that errors of a variable are measured by: its largest so far, or, where it has not moved yet, how
    /// far its first terms take it.
    fn reach(&self, series: &Series, scale: f64) -> f64 {
        let [_, first, second, third, ..] = series;
        let time = self.size;
        let reach = scale
            .max(first.abs() * time)
            .max(second.abs() * time * time)
            .max(third.abs() * time * time * time);
        if reach > 0.0 { reach } else { first_term(series, time) }
    }

    /// Where the series get to in a time.
    fn reached(&self, series: &[Series; MOST_STATES], degree: usize, size: f64) -> State<f64> {
        let mut end = [0.0; MOST_STATES];
        for (slot, series) in end.iter_mut().zip(series).take(self.model.states) {
            *slot = value(head(series, degree + 1), size);
        }
        let [position, velocity, hidden @ ..] = end;
        let time = self.time + size;
        let input = if self.drive.is_present() { self.drive.torque(time) } else { 0.0 };
        State { time, position, velocity, hidden, input }
    }

    /// By how much the series at the end of a step fails the equation of motion, over the step, in units of the
    /// tolerance. The coefficients alone do not betray a narrow peak ahead; this does. `known` is what the rates may
    /// be off by anyway.
    fn defect(
        &self,
        series: &[Series; MOST_STATES],
        degree: usize,
        size: f64,
        end: &State<f64>,
        known: &[f64; MOST_STATES],
    ) -> f64 {
        let (acceleration, hidden) = self.model.field.rates(end, &self.mode);
        let rates = [end.velocity, acceleration].into_iter().chain(hidden);
        let defects = series.iter().zip(rates).zip(&self.scale).zip(known).take(self.model.states);
        defects
            .map(|(((series, rate), &scale), known)| {
                let scale = self.reach(series, scale).max(f64::MIN_POSITIVE);
                let defect = slope(head(series, degree + 1), size) - rate;
                (defect.abs() - known) * size / (scale * self.model.settings.tolerance)
            })
            .fold(0.0, |largest: f64, part| if part.is_finite() { largest.max(part) } else { f64::INFINITY })
    }

    /// How much of each rate of the state may be rounding.
    #[cold]
    fn rounding(&self, point: &State<f64>) -> [f64; MOST_STATES] {
        let point = point.over();
        let (acceleration, hidden) = self.model.rounded.rates(&point, &self.mode);
        let mut errors = [0.0; MOST_STATES];
        let rates = [point.velocity, acceleration].into_iter().chain(hidden);
        for (error, rate) in errors.iter_mut().zip(rates) {
            *error = ROUNDING * rate.error;
        }
        errors
    }

    /// Returns whether the equation of motion fails in a time by more than the tolerance and rounding allow. Where torques
    /// cancel, what is left of them is rounding, and no step is short enough for it.
    fn fails(&self, series: &[Series; MOST_STATES], degree: usize, size: f64) -> bool {
        let end = self.reached(series, degree, size);
        self.defect(series, degree, size, &end, &[0.0; MOST_STATES]) > MOST_DEFECT
            && self.defect(series, degree, size, &end, &self.rounding(&end)) > MOST_DEFECT
    }

    /// A step shortened until the equation of motion holds along it.
    pub(super) fn without_defect(&self, series: &[Series; MOST_STATES], degree: usize, mut size: f64) -> f64 {
        while size > f64::EPSILON * self.time.abs()
            && PARTS.into_iter().any(|part| self.fails(series, degree, part * size))
        {
            size *= 0.7;
        }
        size
    }
}

/// How far the first term that is not zero takes a variable. Behind a soft coupling a ramp of the torque is felt in
/// the fourth or the fifth only.
#[cold]
fn first_term(series: &Series, time: f64) -> f64 {
    let mut terms =
        series.iter().zip(0_i32..).map(|(coefficient, degree)| coefficient.abs() * time.powi(degree));
    // Where every term is zero the variable stays where it is.
    terms.find(|term| *term > 0.0).unwrap_or(0.0)
}

/// The largest of the last coefficients of several series, the highest degree first, each relative to its scale.
#[derive(Debug, Default)]
struct Tails([f64; 4]);

impl Tails {
    fn take(&mut self, series: &Series, degree: usize, scale: f64) {
        let last = head(series, degree + 1).iter().rev();
        for (largest, coefficient) in self.0.iter_mut().zip(last) {
            let part = coefficient.abs() / scale.max(f64::MIN_POSITIVE);
            // `max` passes over what is not a number.
            *largest = if part.is_finite() { largest.max(part) } else { f64::INFINITY };
        }
    }

    fn step_size(&self, degree: usize, tolerance: f64) -> f64 {
        let [last, second, third, fourth] = self.0;
        let root = |coefficient: f64, degree: usize| {
            if coefficient > 0.0 {
                (tolerance / coefficient).powf(1.0 / degree as f64)
            } else {
                f64::INFINITY
            }
        };
        let size = root(last, degree).min(root(second, degree - 1));
        // Small last terms do not bound the rest where terms still grow with the degree, as before a narrow
        // peak: two degrees have to gain a factor of four.
        let (late, early) = (last * size + second, third * size + fourth);
        let growth = late * size * size / early.max(f64::MIN_POSITIVE);
        if size.is_finite() && growth > 0.25 { size * (0.25 / growth).sqrt() } else { size }
    }
}
