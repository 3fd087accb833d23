//! Weak-form sparse identification of the missing term.
//!
//! The equation of motion is multiplied by test functions that vanish, with their derivatives, at both ends
//! of a window. Integration by parts then avoids the second derivative of the record:
//! ∫φ″θ = −∫φ·(c·θ̇ + k·θ + …). Terms of the library are removed one by one, each time the term whose removal
//! costs least. The Bayesian information criterion chooses among the laws on this path, and the term whose
//! removal would cost most is named.
//!
//! # Reference
//! D. A. Messenger, D. M. Bortz, Multiscale Model. Simul. 19 (2021) 1474–1497.

#![allow(clippy::indexing_slicing, reason = "`weak_form` refuses records whose lists differ in length")]

use super::BaselineRecord;
use dynamics::Nominal;
use dynamics::weak_form::test_function;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;

/// Identifier of this baseline.
pub const WEAK_FORM: &str = "weak-form";

/// One-sentence description of the method.
pub const WEAK_FORM_METHOD: &str = "weak-form sparse regression with one term for each of ten effects, the one that explains \
    most is named; it has no term for forcing, a second body, delays or the measurement chain";

/// Exponent of the test function (1 − s²)^p.
const EXPONENT: i32 = 6;
/// Number of windows that start in each period.
const HOPS_PER_PERIOD: f64 = 4.0;
/// Half-width of the window for estimating a velocity, in periods.
const VELOCITY_WINDOW: f64 = 1.0 / 16.0;
/// Share of the largest speed above which the body counts as moving.
const VISIBLE: f64 = 0.02;
/// Smallest number of windows.
const FEWEST: usize = 24;

/// Effects with a term in the library, in the order of its columns.
const LIBRARY: [&str; 10] = [
    "coulomb_friction",
    "stribeck_friction",
    "quadratic_drag",
    "cubic_stiffness",
    "asymmetric_stiffness",
    "gravity",
    "backlash",
    "hysteresis",
    "stiffness_drift",
    "damping_drift",
];

/// Number of columns for recalibration: velocity, position, rest position, input.
const CALIBRATION: usize = 4;

/// Record with the quantities that the library's terms need.
struct Motion<'a> {
    record: &'a BaselineRecord,
    velocity: Vec<f64>,
    /// Largest distance from the rest position; below, the largest speed.
    amplitude: f64,
    speed: f64,
    /// State of Dahl's friction for a displacement of a tenth of the amplitude.
    bristle: Vec<f64>,
}

/// Returns the effect that a weak-form sparse regression names. `None` if it names nothing or cannot read the
/// records: a nominal simulator without a spring, records shorter than a few periods, or numbers of values or
/// inputs that differ from the number of times.
#[must_use]
pub fn weak_form(records: &[BaselineRecord], nominal: &Nominal) -> Option<&'static str> {
    if !records.iter().all(BaselineRecord::is_whole) {
        return None;
    }
    let omega = nominal.angular_frequency();
    let period = if omega > 0.0 { TAU / omega } else { return None };
    let mut rows: Vec<[f64; CALIBRATION + LIBRARY.len() + 1]> = Vec::new();
    let mut duration = 0.0;
    for record in records {
        let motion = Motion::of(record, nominal, period);
        let (first, last) = (record.times_s.first()?, record.times_s.last()?);
        duration += last - first;
        let mut center = first + period;
        while center + period <= *last {
            if motion.swings(center, period) {
                rows.push(motion.window(center, period, nominal));
            }
            center += period / HOPS_PER_PERIOD;
        }
    }
    if rows.len() < FEWEST {
        return None;
    }
    let target = DVector::from_iterator(rows.len(), rows.iter().filter_map(|row| row.last().copied()));
    let column =
        |index: usize| -> Vec<f64> { rows.iter().filter_map(|row| row.get(index).copied()).collect() };
    let squares = |terms: &[usize]| -> Option<f64> {
        let calibration = (0..CALIBRATION).map(column).filter(|values| values.iter().any(|v| *v != 0.0));
        let own = terms.iter().map(|term| column(CALIBRATION + term));
        let columns: Vec<DVector<f64>> = calibration.chain(own).map(DVector::from_vec).collect();
        let matrix = DMatrix::from_columns(&columns);
        let solution = sparse::solve(matrix.clone(), target.clone())?;
        Some((&target - matrix * solution).norm_squared())
    };
    let without = |terms: &[usize], left_out: usize| -> Vec<usize> {
        terms.iter().copied().filter(|term| *term != left_out).collect()
    };
    // Windows overlap; centers a window's half-width apart count as independent.
    let worth = (duration / period).max(2.0);
    let criterion =
        |left: f64, terms: usize| worth * left.max(f64::MIN_POSITIVE).ln() + terms as f64 * worth.ln();
    let mut terms: Vec<usize> = (0..LIBRARY.len()).collect();
    let mut best: Option<(f64, Vec<usize>)> = None;
    loop {
        if let Some(left) = squares(&terms) {
            let own = criterion(left, terms.len());
            if best.as_ref().is_none_or(|(least, _)| own < *least) {
                best = Some((own, terms.clone()));
            }
        }
        let missed = |term: &usize| squares(&without(&terms, *term)).unwrap_or(f64::INFINITY);
        let least = terms.iter().map(|term| (*term, missed(term))).min_by(|a, b| a.1.total_cmp(&b.1));
        let Some((least, _)) = least else { break };
        terms = without(&terms, least);
    }
    let (_, chosen) = best?;
    let missed = |term: &usize| Some((*term, squares(&without(&chosen, *term))?));
    let most = chosen.iter().filter_map(missed).max_by(|a, b| a.1.total_cmp(&b.1))?;
    LIBRARY.get(most.0).copied()
}

impl<'a> Motion<'a> {
    fn of(record: &'a BaselineRecord, nominal: &Nominal, period: f64) -> Self {
        let velocity = velocities(record, VELOCITY_WINDOW * period);
        let rest = nominal.rest_angle();
        let amplitude = record.values.iter().map(|value| (value - rest).abs()).fold(0.0, f64::max);
        let speed = velocity.iter().map(|value| value.abs()).fold(0.0, f64::max);
        let mut state: f64 = 0.0;
        let mut bristle = Vec::with_capacity(record.values.len());
        let mut before = None;
        for &value in &record.values {
            // Exact along a monotonic path: z → s − (s − z)·exp(−path/δ).
            let step = value - before.replace(value).unwrap_or(value);
            let end = step.signum();
            state = end - (end - state) * (-step.abs() / (0.1 * amplitude)).exp();
            bristle.push(state);
        }
        Self { record, velocity, amplitude, speed, bristle }
    }

    /// Returns `true` if the body moves throughout a window. At rest, dry friction takes whatever value holds
    /// the body, which no term describes.
    fn swings(&self, center: f64, half: f64) -> bool {
        let times = &self.record.times_s;
        let from = times.partition_point(|time| *time < center - half);
        let to = times.partition_point(|time| *time <= center + half);
        let Some(own) = self.velocity.get(from..to) else { return false };
        let quarter = own.len().div_ceil(4).max(1);
        own.chunks(quarter).all(|part| part.iter().any(|velocity| velocity.abs() > VISIBLE * self.speed))
    }

    /// Returns a row: the columns for recalibration, those of the library, and the target.
    fn window(&self, center: f64, half: f64, nominal: &Nominal) -> [f64; CALIBRATION + LIBRARY.len() + 1] {
        let mut row = [0.0; CALIBRATION + LIBRARY.len() + 1];
        let times = &self.record.times_s;
        let from = times.partition_point(|time| *time < center - half);
        let to = times.partition_point(|time| *time <= center + half);
        let rest = nominal.rest_angle();
        for index in from..to {
            let time = times[index];
            let width = 0.5 * (times[(index + 1).min(times.len() - 1)] - times[index.saturating_sub(1)]);
            let [bump, slope, curvature] = test_function((time - center) / half, EXPONENT);
            let weights = [bump, slope / half, curvature / (half * half)];
            let [bump, slope, curvature] = weights.map(|value| value * width);
            let position = self.record.values[index] - rest;
            let velocity = self.velocity[index];
            let input = self.record.input.as_ref().map_or(0.0, |input| input[index]);
            // Mean of a sign over the time that belongs to the sample, in case the sign changes within it.
            let mean_sign = |value: f64, rate: f64| {
                let change = 0.5 * rate.abs() * width;
                if change > 0.0 { (value / change).clamp(-1.0, 1.0) } else { value.signum() }
            };
            let direction = mean_sign(velocity, nominal.stiffness() / nominal.inertia() * position);
            let slow = velocity / (0.1 * self.speed);
            let side = mean_sign(position, velocity);
            let terms = [
                0.0,
                position,
                1.0,
                input,
                direction,
                direction * (-slow * slow).exp(),
                velocity * velocity.abs(),
                (position / self.amplitude).powi(3),
                (position / self.amplitude).powi(2),
                (position + rest).sin(),
                side,
                self.bristle[index],
                time * position,
                time * velocity,
            ];
            for (slot, term) in row.iter_mut().zip(terms) {
                *slot += bump * term;
            }
            // ∫φ·θ̇ = −∫φ′·θ.
            if let Some(damping) = row.first_mut() {
                *damping -= slope * position;
            }
            if let Some(target) = row.last_mut() {
                *target -= curvature * position;
            }
        }
        row
    }
}

/// Returns slopes of straight lines through the samples within half a window; symmetric windows leave no
/// error of second order.
fn velocities(record: &BaselineRecord, half: f64) -> Vec<f64> {
    let times = &record.times_s;
    let slope = |time: &f64| {
        let from = times.partition_point(|other| *other < time - half).saturating_sub(1);
        let to = (times.partition_point(|other| *other <= time + half) + 1).min(times.len());
        let own = || times.iter().zip(&record.values).take(to).skip(from);
        let count = (to - from) as f64;
        let mean_time = own().map(|pair| pair.0).sum::<f64>() / count;
        let mean = own().map(|pair| pair.1).sum::<f64>() / count;
        let products: f64 = own().map(|(time, value)| (time - mean_time) * (value - mean)).sum();
        let squares: f64 = own().map(|(time, _)| (time - mean_time).powi(2)).sum();
        if squares > 0.0 { products / squares } else { 0.0 }
    };
    times.iter().map(slope).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use dynamics::reference::{Tolerance, simulate};
    use dynamics::{Active, Start, System};

    fn named(effects: &[(&str, &[f64])]) -> Option<&'static str> {
        let nominal = Nominal::new(1.0, 0.3, 484.0, 0.0).unwrap();
        let effects = effects.iter().map(|(id, values)| Active::new(id, values).unwrap()).collect();
        let system = System::new(nominal, effects).unwrap();
        let times: Vec<f64> = (0..1500).map(|i| f64::from(i) / 130.0).collect();
        let motion = simulate(&system, Start::release(0.7), None, &times, &Tolerance::default()).unwrap();
        let record = BaselineRecord { times_s: times, values: motion.position, input: None };
        weak_form(&[record], &nominal)
    }

    #[test]
    fn terms_of_the_library_are_found_without_noise() {
        assert_eq!(named(&[("coulomb_friction", &[1.5])]), Some("coulomb_friction"));
        assert_eq!(named(&[("quadratic_drag", &[0.1])]), Some("quadratic_drag"));
        assert_eq!(named(&[("asymmetric_stiffness", &[40.0])]), Some("asymmetric_stiffness"));
        assert_eq!(named(&[("stiffness_drift", &[0.01])]), Some("stiffness_drift"));
    }

    #[test]
    fn records_it_cannot_read_name_nothing() {
        let drive = Nominal::new(1.0, 0.3, 0.0, 0.0).unwrap();
        assert_eq!(weak_form(&[], &drive), None);
        let nominal = Nominal::new(1.0, 0.3, 484.0, 0.0).unwrap();
        let short = BaselineRecord { times_s: vec![0.0, 0.1], values: vec![0.0, 0.1], input: None };
        assert_eq!(weak_form(&[short], &nominal), None);
        let times: Vec<f64> = (0..1500).map(|i| f64::from(i) / 130.0).collect();
        let values: Vec<f64> = times.iter().map(|time| 0.7 * (22.0 * time).cos()).collect();
        let torn = BaselineRecord { times_s: times, input: Some(vec![0.0; 3]), values };
        assert_eq!(weak_form(&[torn], &nominal), None);
    }
}
