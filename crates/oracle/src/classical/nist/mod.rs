//! NIST's Statistical Reference Datasets: data, certified values, and tests of the routes.

mod linear;
mod linear_data;
mod nonlinear;
mod nonlinear_data;
mod nonlinear_sets;

/// Returns the number of correct significant digits: −log10 of the relative error, or of the absolute error
/// if the certified value is 0.
fn digits(found: f64, certified: f64) -> f64 {
    let error = (found - certified).abs() / if certified == 0.0 { 1.0 } else { certified.abs() };
    if error == 0.0 { 16.0 } else { -error.log10() }
}

/// Returns the smallest number of correct digits among several numbers.
fn fewest(found: &[f64], certified: &[f64]) -> f64 {
    assert_eq!(found.len(), certified.len());
    found.iter().zip(certified).map(|(&found, &certified)| digits(found, certified)).fold(16.0, f64::min)
}
