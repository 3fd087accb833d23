//! Tests of the linear routes on NIST's linear sets.

use super::linear_data::{LinearSet, linear_sets};
use super::{digits, fewest};
use crate::classical::LinearSolution;
use crate::classical::{normal_equations, ols, polynomial_fit, qr, svd, weighted_regression};
use crate::double_double::DoubleDouble;
use crate::error::OracleError;
use rand::RngExt;

type Solved = Result<LinearSolution, OracleError>;

fn columns(set: &LinearSet) -> Vec<&[f64]> {
    set.columns.iter().map(Vec::as_slice).collect()
}

/// Returns the results on a set of the routes that accept it, with the routes' names.
fn routes(set: &LinearSet) -> Vec<(&'static str, Solved)> {
    let columns = columns(set);
    let mut solved = vec![
        ("normal-equations", normal_equations::least_squares(&columns, &set.y)),
        ("qr", qr::least_squares(&columns, &set.y)),
        ("svd", svd::least_squares(&columns, &set.y)),
        (
            "weighted-regression",
            weighted_regression::least_squares(&columns, &set.y, &vec![1.0; set.y.len()]),
        ),
    ];
    if let Some(degree) = set.degree {
        let x = &set.columns[1];
        solved.push(("polynomial-fit", polynomial_fit::polynomial(x, &set.y, degree)));
        if degree == 1 {
            solved.push(("ols", ols::line(x, &set.y)));
        }
    }
    solved
}

/// The data are NIST's: at the certified coefficients they give the certified residual deviation.
#[test]
fn the_data_give_the_certified_residuals() {
    let exact = |value: f64| DoubleDouble::from(value);
    for set in linear_sets() {
        let mut sum = DoubleDouble::ZERO;
        for (row, y) in set.y.iter().enumerate() {
            // Powers are computed here without rounding to doubles, which would ruin Filip's residuals.
            let fitted = match set.degree {
                Some(_) => set
                    .coefficients
                    .iter()
                    .rev()
                    .fold(DoubleDouble::ZERO, |sum, b| sum * exact(set.columns[1][row]) + exact(*b)),
                None => {
                    set.columns.iter().zip(set.coefficients).map(|(c, b)| exact(c[row]) * exact(*b)).sum()
                }
            };
            let residual = exact(*y) - fitted;
            sum = sum + residual * residual;
        }
        let degrees = (set.y.len() - set.columns.len()) as f64;
        let deviation = (sum / exact(degrees)).sqrt().value();
        if set.residual_std_dev == 0.0 {
            assert!(deviation < 1e-9, "{}: {deviation:e}", set.name);
        } else {
            assert!(digits(deviation, set.residual_std_dev) >= 10.0, "{}: {deviation}", set.name);
        }
    }
}

#[test]
fn orthogonal_routes_reach_their_digits() {
    for set in linear_sets() {
        for (route, solved) in routes(&set).into_iter().filter(|(route, _)| *route != "normal-equations") {
            let fit = solved.unwrap_or_else(|error| panic!("{} by {route}: {error}", set.name));
            let reached = fewest(&fit.coefficients, set.coefficients);
            assert!(reached >= 5.5, "{} by {route}: {reached}", set.name);
            assert!(reached >= fit.promised_digits.min(14.5), "{} by {route}: {reached}, {fit:?}", set.name);
        }
    }
}

#[test]
fn normal_equations_reach_their_digits_and_refuse_filip() {
    for set in linear_sets() {
        let solved = normal_equations::least_squares(&columns(&set), &set.y);
        if set.name == "Filip" {
            assert!(matches!(solved, Err(OracleError::IllConditioned { .. })), "{solved:?}");
            continue;
        }
        let fit = solved.unwrap_or_else(|error| panic!("{}: {error}", set.name));
        let reached = fewest(&fit.coefficients, set.coefficients);
        assert!(reached >= 5.5, "{}: {reached}", set.name);
        assert!(reached >= fit.promised_digits.min(14.5), "{}: {reached}, {fit:?}", set.name);
    }
}

/// Standard errors follow from the residuals: both have at least 5.5 digits.
#[test]
fn standard_errors_are_the_certified_ones() {
    for set in linear_sets() {
        for (route, solved) in routes(&set) {
            let Ok(fit) = solved else { continue };
            if set.residual_std_dev == 0.0 {
                assert!(fit.residual_std_dev < 1e-3, "{} by {route}: {fit:?}", set.name);
                continue;
            }
            let errors = fewest(&fit.std_errors, set.std_errors);
            let deviation = digits(fit.residual_std_dev, set.residual_std_dev);
            assert!(errors >= 5.5 && deviation >= 5.5, "{} by {route}: {errors} {deviation}", set.name);
        }
    }
}

/// Tests the certifying route, on the measured sets too.
#[test]
fn the_certifying_route_reaches_thirteen_digits() {
    for set in linear_sets() {
        let intercept =
            if set.name.starts_with("NoInt") { crate::Intercept::None } else { crate::Intercept::Included };
        let fit = crate::least_squares(&columns(&set), &set.y, intercept).unwrap();
        let reached = fewest(&fit.coefficients, set.coefficients);
        // Powers of Filip's abscissas are rounded to doubles before the route receives them.
        let wanted = if set.name == "Filip" { 7.0 } else { 13.0 };
        assert!(reached >= wanted, "{}: {reached}", set.name);
    }
}

/// Tests random problems with 3 to 200 rows, 1 to 6 columns, condition numbers up to 10⁵, and small and large
/// residuals, against the certifying route.
#[test]
fn promises_are_kept_on_random_problems() {
    let mut generator = seed::Seed::new(1).child("problems").generator();
    for number in 0..2000 {
        let rows = generator.random_range(3..200_usize);
        let count = generator.random_range(1..=(rows - 1).min(6));
        let apart = 10_f64.powf(-generator.random_range(0.0..5.0));
        let noise = 10_f64.powf(generator.random_range(-8.0..2.0));
        let common: Vec<f64> = (0..rows).map(|_| generator.random()).collect();
        let mut around = |centers: &[f64], width: f64| -> Vec<f64> {
            centers.iter().map(|center| center + width * (generator.random::<f64>() - 0.5)).collect()
        };
        let columns: Vec<Vec<f64>> = (0..count).map(|_| around(&common, apart)).collect();
        let sums: Vec<f64> = (0..rows).map(|row| columns.iter().map(|column| column[row]).sum()).collect();
        let y = around(&sums, noise);
        let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
        let truth = crate::least_squares(&columns, &y, crate::Intercept::None).unwrap();
        for (route, solved) in [
            ("normal-equations", normal_equations::least_squares(&columns, &y)),
            ("qr", qr::least_squares(&columns, &y)),
            ("svd", svd::least_squares(&columns, &y)),
            ("weighted-regression", weighted_regression::least_squares(&columns, &y, &vec![1.0; rows])),
        ] {
            let Ok(fit) = solved else { continue };
            let reached = fewest(&fit.coefficients, &truth.coefficients);
            assert!(reached >= fit.promised_digits, "{number} by {route}: {reached} {fit:?} {truth:?}");
        }
    }
}
