//! Estimation of how inputs vary between their samples.

use crate::LearnError;
use crate::data::{DataSet, Making, Parts, Trajectory};
use crate::learners::library::Term;
use crate::learners::weak_sindy::regression;
use crate::linear::least_squares;
use dynamics::Hold;

/// Checks and splits records as [`DataSet::new`] does, and estimates the interpolation of inputs if
/// `making.hold` is `None`.
///
/// # Errors
/// As [`DataSet::new`].
pub fn data_set(records: &[Trajectory], making: Making) -> Result<DataSet, LearnError> {
    let stated = making.hold;
    Ok(held(DataSet::new(records, making)?, stated))
}

/// Checks stated parts as [`DataSet::of_parts`] does, and estimates the interpolation as [`data_set`] does.
///
/// # Errors
/// As [`DataSet::of_parts`].
pub fn data_set_of_parts(parts: Parts, making: Making) -> Result<DataSet, LearnError> {
    let stated = making.hold;
    Ok(held(DataSet::of_parts(parts, making)?, stated))
}

fn held(data: DataSet, stated: Option<Hold>) -> DataSet {
    DataSet { hold: stated.unwrap_or_else(|| likely_hold(&data)), ..data }
}

/// Lengths of the windows of the weak form, in periods.
///
/// A law of all terms may still lack something, such as a hidden state, whose residual hides the input in long
/// windows. Short ones weigh the high frequencies, at which an input's course between its samples matters most and
/// at which inertia alone decides how a system follows.
const WINDOWS: [f64; 3] = [1.0, 0.5, 0.25];

/// Fewest sampling intervals in a window.
const LEAST_WINDOW: f64 = 8.0;

/// Returns the interpolation of the inputs with the smallest weak-form residual of a law of all terms on the training
/// part, in the windows that distinguish interpolations most. [`Hold::Zero`] without an input.
fn likely_hold(data: &DataSet) -> Hold {
    // Without a training part there is no input.
    let rate_hz = data.train.first().map_or(0.0, Trajectory::rate_hz);
    let told = WINDOWS.iter().filter_map(|periods| {
        let window_s = (periods * data.period_s).max(LEAST_WINDOW / rate_hz);
        let left: Vec<(Hold, f64)> =
            Hold::ALL.into_iter().filter_map(|hold| Some((hold, residual(data, hold, window_s)?))).collect();
        let best = *left.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
        let worst = left.iter().map(|own| own.1).fold(0.0, f64::max);
        Some((best.0, worst / best.1))
    });
    // Of equals, the first, whose windows are the longest.
    let most = told.reduce(|most, own| if own.1 > most.1 { own } else { most });
    most.map_or(Hold::Zero, |(hold, _)| hold)
}

/// Returns the weak-form residual of a law of all terms in windows of this length; `None` without an input.
fn residual(data: &DataSet, hold: Hold, window_s: f64) -> Option<f64> {
    let train = data.train.iter().map(|part| filtered(part, hold)).collect::<Option<Vec<_>>>()?;
    let rows = regression(&DataSet { train, period_s: window_s, ..data.clone() }, &Term::ALL);
    let weights = least_squares(&rows.rows, &rows.right)?;
    Some((&rows.right - &rows.rows * weights).norm())
}

/// Returns a trajectory whose input at each sample is replaced by the number whose sum with a test function over
/// the samples is the integral of the input with it, to third order in the sampling interval; `None` without an
/// input.
///
/// The sum over samples is the integral for a band-limited input u. An input that goes straight from sample to
/// sample acts as u + δ²u/12, where δ² is the second difference. One that is held acts as m − δ²m/12, where m is
/// the mean of a sample and the one before it.
fn filtered(part: &Trajectory, hold: Hold) -> Option<Trajectory> {
    let input = part.input()?;
    let before = input.iter().take(1).chain(input);
    let input: Vec<f64> = match hold {
        Hold::Zero => curved(&input.iter().zip(before).map(|(a, b)| 0.5 * (a + b)).collect::<Vec<_>>(), -1.0),
        Hold::Linear => curved(input, 1.0),
        Hold::BandLimited => input.to_vec(),
    };
    Trajectory::new(part.name(), part.times_s().to_vec(), part.values().to_vec(), Some(input)).ok()
}

/// Returns values plus `sign` twelfths of their second differences; the first and the last stay as they are.
fn curved(values: &[f64], sign: f64) -> Vec<f64> {
    let inside = values.windows(3).map(|near| match near {
        [before, now, after] => now + sign / 12.0 * (before - 2.0 * now + after),
        _ => f64::NAN,
    });
    let ends = (values.first().copied(), values.last().copied().filter(|_| values.len() > 1));
    ends.0.into_iter().chain(inside).chain(ends.1).collect()
}

#[cfg(test)]
mod tests {
    use super::likely_hold;
    use crate::data::DataSet;
    use crate::testing::{drag_and_cubic, friction_and_gravity, making, record_held};
    use dynamics::{Hold, NominalSimulator};

    #[test]
    fn the_input_is_held_as_it_was() {
        for system in [drag_and_cubic(), friction_and_gravity()] {
            for hold in Hold::ALL {
                let records: Vec<_> =
                    (0..6).map(|number| record_held(&system, number, Some(hold), 2e-3)).collect();
                let nominal = NominalSimulator::from(system.nominal());
                let data = DataSet::new(&records, making(Some(nominal))).unwrap();
                assert_eq!(likely_hold(&data), hold);
            }
        }
    }
}
