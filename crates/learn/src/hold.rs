//! Estimation of how inputs vary between their samples.

use crate::LearnError;
use crate::data::{DataSet, Making, Trajectory};
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
    let data = DataSet::new(records, making)?;
    Ok(DataSet { hold: stated.unwrap_or_else(|| likely_hold(&data)), ..data })
}

/// Returns the interpolation of the inputs with the smaller weak-form residual of a law of all terms, on the
/// training part.
///
/// The two interpolations differ by a delay of half a sampling interval, which no term of the law can
/// imitate. [`Hold::Zero`] without an input.
fn likely_hold(data: &DataSet) -> Hold {
    let left = |hold: Hold| {
        let train = data.train.iter().map(|part| centered(part, hold)).collect::<Option<Vec<_>>>()?;
        let rows = regression(&DataSet { train, ..data.clone() }, &Term::ALL);
        let weights = least_squares(&rows.rows, &rows.right)?;
        Some((&rows.right - &rows.rows * weights).norm())
    };
    match (left(Hold::Zero), left(Hold::Linear)) {
        (Some(zero), Some(linear)) if linear < zero => Hold::Linear,
        _ => Hold::Zero,
    }
}

/// Returns a trajectory whose input at each sample is replaced by its mean over the interval around the
/// sample; `None` without an input.
fn centered(part: &Trajectory, hold: Hold) -> Option<Trajectory> {
    let input = part.input()?;
    let before = input.iter().take(1).chain(input);
    let mean = |(now, before): (&f64, &f64)| match hold {
        Hold::Zero => 0.5 * (now + before),
        Hold::Linear | Hold::BandLimited => *now,
    };
    let input = input.iter().zip(before).map(mean).collect();
    Trajectory::new(part.name(), part.times_s().to_vec(), part.values().to_vec(), Some(input)).ok()
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
            for hold in [Hold::Zero, Hold::Linear] {
                let records: Vec<_> =
                    (0..6).map(|number| record_held(&system, number, Some(hold), 2e-3)).collect();
                let nominal = NominalSimulator::from(system.nominal());
                let data = DataSet::new(&records, making(Some(nominal))).unwrap();
                assert_eq!(likely_hold(&data), hold);
            }
        }
    }
}
