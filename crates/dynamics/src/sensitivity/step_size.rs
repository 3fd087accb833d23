//! Size of a step by Taylor series.

use super::graph::MOST_STATES;
use super::march::March;
use super::series::{Series, head, slope, value};
use crate::field::State;
use crate::system::ROUNDING;

/// Parts of a step at which its defect is evaluated.
const PARTS: [f64; 2] = [1.0, 0.6];

/// Largest defect of a step in units of the tolerance: that of the first neglected term, times the degree.
const MOST_DEFECT: f64 = 20.0;

impl March<'_> {
    /// Returns the largest step for which the last two coefficients of every series are below the tolerance
    /// and the terms fall off toward the end.
    pub(super) fn step_size(&self, series: &[Series; MOST_STATES], degree: usize, number: usize) -> f64 {
        let mut tails = Tails::default();
        for (series, &scale) in series.iter().zip(&self.scale).take(self.model.states) {
            tails.take(series, degree, self.reach(series, scale));
        }
        if self.mode.sticks()
            && let Some(piece) = self.model.graphs.get(number)
        {
            // Nothing changes but the torque: the step has to resolve it, or a break-away is missed.
            let holding = self.model.field.holding_torque(&self.point(), &self.mode).unwrap_or(1.0).abs();
            for (_, node) in &piece.graph.edges {
                tails.take(piece.graph.series(*node), degree, holding);
            }
        }
        tails.step_size(degree, self.model.settings.tolerance)
    }

    /// Returns the size that errors of a variable are compared with: its largest so far or, if it has not
    /// moved yet, its motion by the first terms.
    fn reach(&self, series: &Series, scale: f64) -> f64 {
        let [_, first, second, third, ..] = series;
        let time = self.size;
        let reach = scale
            .max(first.abs() * time)
            .max(second.abs() * time * time)
            .max(third.abs() * time * time * time);
        if reach > 0.0 { reach } else { first_term(series, time) }
    }

    /// Returns the state that the series reach in a time.
    fn reached(&self, series: &[Series; MOST_STATES], degree: usize, size: f64) -> State<f64> {
        let mut end = [0.0; MOST_STATES];
        for (slot, series) in end.iter_mut().zip(series).take(self.model.states) {
            *slot = value(head(series, degree + 1), size);
        }
        let [position, velocity, hidden @ ..] = end;
        let time = self.time + size;
        let input = self.drive.torque(time);
        State { time, position, velocity, hidden, input }
    }

    /// Returns the defect of the equation of motion at the end of a step, over the step, in units of the
    /// tolerance. It detects a narrow peak ahead, which the coefficients alone do not show. `known` is the
    /// error that the rates may have anyway.
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

    /// Returns the part of each rate of the state that may be rounding.
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

    /// Returns `true` if the defect of the equation of motion in a time exceeds what tolerance and rounding
    /// allow. If torques cancel, their remainder is rounding, and no step is short enough for it.
    fn fails(&self, series: &[Series; MOST_STATES], degree: usize, size: f64) -> bool {
        let end = self.reached(series, degree, size);
        self.defect(series, degree, size, &end, &[0.0; MOST_STATES]) > MOST_DEFECT
            && self.defect(series, degree, size, &end, &self.rounding(&end)) > MOST_DEFECT
    }

    /// Returns a step shortened until the equation of motion holds along it.
    pub(super) fn without_defect(&self, series: &[Series; MOST_STATES], degree: usize, mut size: f64) -> f64 {
        while size > f64::EPSILON * self.time.abs()
            && PARTS.into_iter().any(|part| self.fails(series, degree, part * size))
        {
            size *= 0.7;
        }
        size
    }
}

/// Returns the distance that the first nonzero term moves a variable. Behind a soft coupling a ramp of the
/// torque shows only in the fourth or the fifth term.
#[cold]
fn first_term(series: &Series, time: f64) -> f64 {
    let mut terms =
        series.iter().zip(0_i32..).map(|(coefficient, degree)| coefficient.abs() * time.powi(degree));
    terms.find(|term| *term > 0.0).unwrap_or(0.0)
}

/// Largest of the last coefficients of several series, the highest degree first, each relative to its scale.
#[derive(Debug, Default)]
struct Tails([f64; 4]);

impl Tails {
    fn take(&mut self, series: &Series, degree: usize, scale: f64) {
        let last = head(series, degree + 1).iter().rev();
        for (largest, coefficient) in self.0.iter_mut().zip(last) {
            let part = coefficient.abs() / scale.max(f64::MIN_POSITIVE);
            // `max` ignores NaN.
            *largest = if part.is_finite() { largest.max(part) } else { f64::INFINITY };
        }
    }

    fn step_size(&self, degree: usize, tolerance: f64) -> f64 {
        let [last, second, third, fourth] = self.0;
        let root = |coefficient: f64, degree: usize| {
            if coefficient > 0.0 { libm::log(tolerance / coefficient) / degree as f64 } else { f64::INFINITY }
        };
        let size = libm::exp(root(last, degree).min(root(second, degree - 1)));
        // Small last terms do not bound the rest if terms still grow with the degree, as before a narrow
        // peak: two degrees have to gain a factor of four.
        let (late, early) = (last * size + second, third * size + fourth);
        let growth = late * size * size / early.max(f64::MIN_POSITIVE);
        if size.is_finite() && growth > 0.25 { size * (0.25 / growth).sqrt() } else { size }
    }
}
