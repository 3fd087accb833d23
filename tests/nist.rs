//! Tests of the linear problems of NIST's Statistical Reference Datasets that are given by formulas.
//!
//! Definitions and certified values: NIST StRD, Linear Regression (NoInt1, NoInt2: Eberhardt, K., NIST;
//! Wampler1 to Wampler5: Wampler, R. H., J. Amer. Statist. Assoc. 65 (1970) 549).

use oracle::{Intercept, LinearFit, least_squares};

/// Returns the number of correct significant digits: −log10 of the relative error, or of the absolute error
/// if the certified value is 0; at most the certified 15.
fn digits(found: f64, certified: f64) -> f64 {
    let error = (found - certified).abs() / if certified == 0.0 { 1.0 } else { certified.abs() };
    if error == 0.0 { 15.0 } else { (-error.log10()).min(15.0) }
}

fn fewest(found: &[f64], certified: &[f64]) -> f64 {
    assert_eq!(found.len(), certified.len());
    found.iter().zip(certified).map(|(&found, &certified)| digits(found, certified)).fold(15.0, f64::min)
}

#[test]
fn no_int_1() {
    let x: Vec<f64> = (60..=70).map(f64::from).collect();
    let y: Vec<f64> = (130..=140).map(f64::from).collect();
    let fit = least_squares(&[&x], &y, Intercept::None).unwrap();
    assert!(fewest(&fit.coefficients, &[2.074_380_165_289_26]) >= 14.0);
    assert!(fewest(&fit.std_errors, &[0.165_289_256_198_347E-01]) >= 14.0);
    assert!(digits(fit.residual_std_dev, 3.567_530_340_063_38) >= 14.0);
    assert!(digits(fit.r_squared, 0.999_365_492_298_663) >= 14.0);
}

#[test]
fn no_int_2() {
    let fit = least_squares(&[&[4.0, 5.0, 6.0]], &[3.0, 4.0, 4.0], Intercept::None).unwrap();
    assert!(fewest(&fit.coefficients, &[0.727_272_727_272_727]) >= 14.0);
    assert!(fewest(&fit.std_errors, &[0.420_827_318_078_432E-01]) >= 14.0);
    assert!(digits(fit.residual_std_dev, 0.369_274_472_937_998) >= 14.0);
    assert!(digits(fit.r_squared, 0.993_348_115_299_335) >= 14.0);
}

/// Scatter of Wampler3; Wampler4 and 5 have 100 and 10,000 times as much.
const SCATTER: [f64; 21] = [
    759.0, -2048.0, 2048.0, -2048.0, 2523.0, -2048.0, 2048.0, -2048.0, 1838.0, -2048.0, 2048.0, -2048.0,
    1838.0, -2048.0, 2048.0, -2048.0, 2523.0, -2048.0, 2048.0, -2048.0, 759.0,
];

/// Fits a polynomial of the fifth degree in x = 0, 1, …, 20 with coefficients 1, r, r², … plus scatter.
fn wampler(ratio: f64, scatter: f64) -> LinearFit {
    let powers: Vec<Vec<f64>> =
        (0..=5).map(|power| (0..=20).map(|x| f64::from(x).powi(power)).collect()).collect();
    let columns: Vec<&[f64]> = powers.iter().map(Vec::as_slice).collect();
    let y: Vec<f64> = (0..=20)
        .zip(SCATTER)
        .map(|(x, noise)| {
            if ratio == 1.0 {
                (0..=5).map(|power| f64::from(x).powi(power)).sum::<f64>() + scatter * noise
            } else {
                // Wampler2's values have five decimals: an exact integer over 10⁵.
                let hundred_thousandths: i64 =
                    (0..=5).map(|power| i64::from(x).pow(power) * 10_i64.pow(5 - power)).sum();
                hundred_thousandths as f64 / 1e5
            }
        })
        .collect();
    least_squares(&columns, &y, Intercept::Included).unwrap()
}

#[test]
fn wampler_1() {
    let fit = wampler(1.0, 0.0);
    assert!(fewest(&fit.coefficients, &[1.0; 6]) >= 13.0, "{fit:?}");
    assert!(fewest(&fit.std_errors, &[0.0; 6]) >= 13.0, "{fit:?}");
    assert!(digits(fit.r_squared, 1.0) >= 13.0);
}

#[test]
fn wampler_2() {
    let fit = wampler(0.1, 0.0);
    assert!(fewest(&fit.coefficients, &[1.0, 0.1, 0.01, 0.001, 0.0001, 0.00001]) >= 13.0, "{fit:?}");
    assert!(digits(fit.r_squared, 1.0) >= 13.0);
}

const WAMPLER_3_ERRORS: [f64; 6] = [
    2_152.326_246_781_70,
    2_363.551_734_696_81,
    779.343_524_331_583,
    101.475_507_550_350,
    5.645_665_121_707_52,
    0.112_324_854_679_312,
];

#[test]
fn wampler_3_to_5() {
    for (scatter, r_squared) in
        [(1.0, 0.999_995_559_025_820), (100.0, 0.957_478_440_825_662), (1e4, 0.224_668_921_574_940E-02)]
    {
        let fit = wampler(1.0, scatter);
        assert!(fewest(&fit.coefficients, &[1.0; 6]) >= 13.0, "{scatter}: {fit:?}");
        let errors = WAMPLER_3_ERRORS.map(|error| error * scatter);
        assert!(fewest(&fit.std_errors, &errors) >= 13.0, "{scatter}: {fit:?}");
        assert!(digits(fit.residual_std_dev, 2_360.145_023_792_68 * scatter) >= 13.0);
        assert!(digits(fit.r_squared, r_squared) >= 13.0);
        assert!(fit.promised_digits >= 13.0, "{}", fit.promised_digits);
    }
}
