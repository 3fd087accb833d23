//! What inputs do between their samples, where nobody says it.

use crate::LearnError;
use crate::data::{DataSet, Making, Trajectory};
use crate::learners::library::Term;
use crate::learners::weak_sindy::regression;
use crate::linear::least_squares;
use dynamics::Hold;

/// Splits and checks records as [`DataSet::new`] does, with the likely behavior of inputs between samples where it is left open.
///
/// # Errors
/// As [`DataSet::new`].
pub fn data_set(records: &[Trajectory], making: Making) -> Result<DataSet, LearnError> {
    let stated = making.hold;
    let data = DataSet::new(records, making)?;
    Ok(DataSet { hold: stated.unwrap_or_else(|| likely_hold(&data)), ..data })
}

/// The behavior of the inputs of the training part with which a law of all terms leaves less in weak form: half a sampling
/// interval of delay lies between the two, which no term of the law can stand for. [`Hold::Zero`] where there is no input.
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

/// A trajectory whose input at each sample is its mean over the interval about it.
fn centered(part: &Trajectory, hold: Hold) -> Option<Trajectory> {
    let input = part.input()?;
    let before = input.iter().take(1).chain(input);
    let mean = |(now, before): (&f64, &f64)| match hold {
        Hold::Zero => 0.5 * (now + before),
        Hold::Linear => *now,
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
