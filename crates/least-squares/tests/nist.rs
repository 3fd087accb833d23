//! NIST's nonlinear sets, the oracle's copies, solved from both of NIST's starts.

#![allow(clippy::indexing_slicing)]

use classical::problem::LeastSquaresProblem;
use least_squares::{LeastSquares, Linearized, Method};
use nalgebra::{DMatrix, DVector};
use nonlinear_sets::{NonlinearSet, easier, harder};
use std::convert::Infallible;
use std::ops::ControlFlow;

#[path = "../../oracle/src/classical/nist/nonlinear_data.rs"]
mod nonlinear_data;
#[path = "../../oracle/src/classical/nist/nonlinear_sets.rs"]
#[allow(dead_code, reason = "standard errors are the oracle's own test")]
mod nonlinear_sets;

/// Place at which the sets look for the trait that they implement.
mod classical {
    pub(crate) mod problem {
        #[allow(dead_code, reason = "the scale of the data is the oracle's own")]
        pub(crate) trait LeastSquaresProblem {
            fn residuals(&self, parameters: &[f64]) -> Vec<f64>;
            fn jacobian(&self, parameters: &[f64]) -> Vec<Vec<f64>>;
            fn data_length(&self) -> f64;
        }
    }
}

/// Set whose parameters are in units of a start.
struct Scaled<'a> {
    set: &'a NonlinearSet,
    unit: DVector<f64>,
}

impl LeastSquares for Scaled<'_> {
    type Error = Infallible;

    fn residuals(&self, parameters: &DVector<f64>) -> Result<DVector<f64>, Infallible> {
        Ok(DVector::from_vec(self.set.residuals(parameters.component_mul(&self.unit).as_slice())))
    }

    fn linearize(&self, parameters: &DVector<f64>) -> Result<Linearized, Infallible> {
        let columns = self.set.jacobian(parameters.component_mul(&self.unit).as_slice());
        let columns =
            columns.into_iter().zip(&self.unit).map(|(column, unit)| DVector::from_vec(column) * *unit);
        let jacobian = DMatrix::from_columns(&columns.collect::<Vec<_>>());
        Ok(Linearized { residuals: self.residuals(parameters)?, jacobian })
    }
}

#[test]
fn every_set_is_solved_from_both_starts() {
    let tenfold = Method { first: 1e-5, max_damping: 1e20, ..Method::TENFOLD };
    for (rule, method) in [("Nielsen", Method::NIELSEN), ("tenfold", tenfold)] {
        for (set, at) in easier().iter().chain(&harder()).flat_map(|set| [(set, 0), (set, 1)]) {
            let unit = DVector::from_row_slice(set.starts[at]);
            let ones = DVector::from_element(unit.len(), 1.0);
            let method = Method { max_steps: 5000, ..method };
            let problem = Scaled { set, unit };
            let Ok(found) = method.minimize(&problem, &ones, |_| ControlFlow::Continue(()));
            let certified = DVector::from_row_slice(set.certified);
            let error =
                found.parameters.component_mul(&problem.unit).component_div(&certified).add_scalar(-1.0);
            // From the far start of MGH17, Nielsen's rule ends where two exponentials have become one.
            let is_solved = (rule, set.name, at) != ("Nielsen", "MGH17", 0);
            assert_eq!(error.amax() < 1e-9, is_solved, "{} by {rule} from start {at}: {found:?}", set.name);
        }
    }
}
