//! Tests of the nonlinear routes on NIST's nonlinear sets.

use super::nonlinear_sets::{NonlinearSet, easier, harder};
use super::{digits, fewest};
use crate::classical::problem::Limits;
use crate::classical::trust_region::Bounds;
use crate::classical::{
    LeastSquaresProblem, LeastSquaresSolution, Reached, levenberg_marquardt, trust_region,
};
use rand::RngExt;

const LIMITS: Limits = Limits { tolerance: 1e-10, max_steps: 5000 };

fn sets() -> Vec<NonlinearSet> {
    easier().into_iter().chain(harder()).collect()
}

/// The data are NIST's: at the certified parameters they give the certified sum of squares, to ten digits or
/// to the rounding of the residuals. (Only Lanczos2 needs the second criterion: with 40 digits its sum is
/// 2.22994281272524e-11, right to 10.1 digits.)
#[test]
fn the_data_give_the_certified_sums() {
    for set in sets() {
        let sum: f64 = set.residuals(set.certified).iter().map(|r| r * r).sum();
        let rounding = f64::EPSILON * set.data_length() * sum.sqrt();
        let error = (sum - set.sum_of_squares).abs();
        assert!(error <= 1e-10 * set.sum_of_squares + rounding, "{}: {sum:e}", set.name);
        assert!(rounding < 1e-10 * sum || set.name == "Lanczos2", "{}: {rounding:e}", set.name);
    }
}

#[test]
fn the_jacobians_are_the_derivatives() {
    for set in sets() {
        for (at, column) in set.jacobian(set.certified).iter().enumerate() {
            let shifted = |by: f64| {
                let mut parameters = set.certified.to_vec();
                parameters[at] *= 1.0 + by;
                set.residuals(&parameters)
            };
            let (up, down) = (shifted(1e-5), shifted(-1e-5));
            let largest = column.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
            for ((up, down), entry) in up.iter().zip(&down).zip(column) {
                let difference = (up - down) / (2e-5 * set.certified[at]);
                assert!(
                    (difference - entry).abs() < 1e-5 * largest,
                    "{} {at}: {difference} {entry}",
                    set.name
                );
            }
        }
    }
}

/// Solves with both solvers from one start.
fn solve(set: &NonlinearSet, start: &[f64], limits: Limits) -> [(&'static str, LeastSquaresSolution); 2] {
    let bounds = Bounds::none(start.len());
    [
        ("levenberg-marquardt", levenberg_marquardt::minimize(set, start, limits).unwrap()),
        ("trust-region", trust_region::minimize(set, start, &bounds, limits).unwrap()),
    ]
}

#[test]
fn both_routes_solve_every_set_from_both_starts() {
    for set in sets() {
        for start in set.starts {
            for (route, found) in solve(&set, start, LIMITS) {
                let place = format!("{} by {route} from {start:?}: {found:?}", set.name);
                assert_eq!(found.reached, Reached::Converged, "{place}");
                assert!(digits(found.sum_of_squares, set.sum_of_squares) >= 9.5, "{place}");
                assert!(fewest(&found.parameters, set.certified) >= 9.0, "{place}");
                if !set.std_errors.is_empty() {
                    assert!(fewest(&found.std_errors.unwrap(), set.std_errors) >= 8.0, "{place}");
                }
            }
        }
    }
}

/// Wherever the budget ends, only the solution is called converged.
#[test]
fn a_budget_that_ends_on_the_way_is_never_called_converged() {
    for set in sets() {
        for max_steps in [0, 1, 2, 3, 4, 6, 8, 11, 16, 23, 32, 45, 64, 91, 128] {
            for start in set.starts {
                for (route, found) in solve(&set, start, Limits { max_steps, ..LIMITS }) {
                    let place = format!("{} by {route} from {start:?}: {found:?}", set.name);
                    assert!(found.steps <= max_steps, "{place}");
                    match found.reached {
                        Reached::Converged => {
                            assert!(fewest(&found.parameters, set.certified) >= 9.0, "{place}");
                        }
                        Reached::BudgetSpent => {
                            assert!(found.because.contains("Raise the budget"), "{place}")
                        }
                        Reached::Stalled => panic!("{place}"),
                    }
                }
            }
        }
    }
}

/// Far from the solution the models of BoxBOD and Misra1a are constant up to rounding: a local "minimum" at
/// which solvers with criteria on steps or gains report success.
#[test]
fn a_plateau_is_no_minimum() {
    for set in sets().into_iter().filter(|set| set.name == "BoxBOD" || set.name == "Misra1a") {
        for rate in [20.0, 50.0, 1e3, 1e5] {
            for (route, found) in solve(&set, &[172.0, rate], LIMITS) {
                let right = fewest(&found.parameters, set.certified) >= 9.0;
                let place = format!("{} by {route} from rate {rate}: {found:?}", set.name);
                assert!(right == (found.reached == Reached::Converged), "{place}");
            }
        }
    }
}

/// Starts far from NIST's own: "converged" always means a stationary point.
#[test]
fn whatever_is_called_converged_is_stationary() {
    let mut generator = seed::Seed::new(0).child("starts").generator();
    for set in sets() {
        for _ in 0..10 {
            let start: Vec<f64> =
                set.certified.iter().map(|b| b * 10_f64.powf(generator.random_range(-1.0..1.0))).collect();
            if !set.residuals(&start).iter().all(|r| r.is_finite()) {
                continue;
            }
            for (route, found) in solve(&set, &start, Limits { max_steps: 300, ..LIMITS }) {
                if found.reached != Reached::Converged {
                    continue;
                }
                let residuals = set.residuals(&found.parameters);
                let rounding = 1e3 * f64::EPSILON * set.data_length();
                for column in set.jacobian(&found.parameters) {
                    let product: f64 = column.iter().zip(&residuals).map(|(j, r)| j * r).sum();
                    let length = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
                    let cosine = product.abs() / length(&column) / (length(&residuals) + rounding);
                    assert!(cosine <= 1e-9, "{} by {route}: {cosine:e} {found:?}", set.name);
                }
            }
        }
    }
}

/// Each parameter in turn is kept 2 % away from its certified value, toward 0. Its bound has to bind, with
/// the descent pressing against it, and the gradient has to vanish in the others.
#[test]
fn bounds_are_met_where_they_bind() {
    let length = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    for set in sets() {
        let count = set.certified.len();
        for held in 0..count {
            let wall = 0.98 * set.certified[held];
            let mut bounds = [vec![f64::NEG_INFINITY; count], vec![f64::INFINITY; count]];
            bounds[usize::from(wall > 0.0)][held] = wall;
            let [low, high] = bounds;
            let bounds = Bounds::new(low, high).unwrap();
            let start: Vec<f64> = set.certified.iter().map(|b| 0.9 * b).collect();
            let found = trust_region::minimize(&set, &start, &bounds, LIMITS).unwrap();
            let place = format!("{} with parameter {held} held: {found:?}", set.name);
            assert_eq!(found.reached, Reached::Converged, "{place}");
            assert!((found.parameters[held] / wall - 1.0).abs() < 1e-12, "{place}");
            assert!(found.parameters[held].abs() < wall.abs(), "{place}");
            let residuals = set.residuals(&found.parameters);
            for (at, column) in set.jacobian(&found.parameters).iter().enumerate() {
                let product: f64 = column.iter().zip(&residuals).map(|(j, r)| j * r).sum();
                let cosine = product / length(column) / length(&residuals);
                if at == held {
                    assert!(cosine * wall.signum() < -1e-6, "{place} {cosine:e}");
                } else {
                    assert!(cosine.abs() < 1e-9, "{place} {cosine:e}");
                }
            }
        }
    }
}
