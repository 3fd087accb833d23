//! Choice between laws.

use crate::law::Law;
use crate::scaled::Scaled;

/// Scatter, as a share of the spread, below which it cannot be told from the error of the quadrature.
const SMALLEST_SCATTER: f64 = 1e-6;

/// Returns the effective number of peaks for residuals whose correlation falls as ρ^lag: N(1 − ρ)/(1 + ρ),
/// where ρ is their correlation at lag 1, or 0 if that is negative.
///
/// `floor` is a variance added as independent scatter. A perfect law leaves smooth but tiny quadrature
/// errors; with the floor they do not count as correlated scatter.
///
/// Reference: Bayley, Hammersley, Journal of the Royal Statistical Society Supplement 8 (1946) 184.
pub(crate) fn effective_peaks(residuals: &[f64], floor: f64) -> f64 {
    let squares: f64 = residuals.iter().map(|residual| residual * residual + floor).sum();
    let products: f64 = residuals.iter().zip(residuals.iter().skip(1)).map(|(one, next)| one * next).sum();
    let correlation = if squares > 0.0 { (products / squares).clamp(0.0, 1.0) } else { 0.0 };
    residuals.len() as f64 * (1.0 - correlation) / (1.0 + correlation)
}

/// Returns the variance below which scatter cannot be told from the error of the quadrature.
fn floor(scaled: &Scaled) -> f64 {
    (SMALLEST_SCATTER * scaled.spread).powi(2)
}

/// Returns the Bayesian information criterion with the correction for few peaks; lower is better: N
/// ln(squares/n) + k ln N + 2k(k + 1)/(N − k − 1), with n the number of peaks, N their effective number and k
/// the number of parameters. Infinite if N ≤ k + 1.
///
/// Reference: Schwarz, Annals of Statistics 6 (1978) 461. The correction is that of Hurvich, Tsai, Biometrika
/// 76 (1989) 297. Mangan, Kutz, Brunton, Proctor, Proceedings of the Royal Society A 473 (2017) 20170009, use
/// it to choose between sparse laws.
pub(crate) fn criterion(law: &Law, scaled: &Scaled, effective: f64) -> f64 {
    let peaks = scaled.peaks() as f64;
    let parameters = law.parameters() as f64;
    let freedom = effective - parameters - 1.0;
    if freedom <= 0.0 {
        return f64::INFINITY;
    }
    effective * (law.squares / peaks + floor(scaled)).ln()
        + parameters * effective.ln()
        + 2.0 * parameters * (parameters + 1.0) / freedom
}

/// Returns the simplest law whose criterion is within `evidence` of the best, and the criteria of all laws.
///
/// `laws` are ordered from the richest to the poorest; `None` for no law.
pub(crate) fn choose<'a>(laws: &'a [Law], scaled: &Scaled, evidence: f64) -> Option<(&'a Law, Vec<f64>)> {
    let effective = effective_peaks(&scaled.residuals(&laws.first()?.trajectory), floor(scaled));
    let criteria: Vec<f64> = laws.iter().map(|law| criterion(law, scaled, effective)).collect();
    let best = criteria.iter().copied().fold(f64::INFINITY, f64::min);
    let law = laws
        .iter()
        .zip(&criteria)
        .filter(|(_, criterion)| **criterion <= best + evidence)
        .min_by_key(|(law, _)| law.parameters())?
        .0;
    Some((law, criteria))
}

#[cfg(test)]
mod tests {
    use super::*;
    use envelope::Envelope;

    fn scaled(peaks: usize) -> Scaled {
        let times: Vec<f64> = (0..peaks).map(|i| i as f64).collect();
        let logs = times.iter().map(|t| -0.1 * t).collect();
        Scaled::of(&Envelope::new(times, logs, 6.0).unwrap()).unwrap()
    }

    #[test]
    fn correlated_residuals_are_worth_fewer_peaks() {
        let alternating: Vec<f64> = (0..50).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect();
        assert!((effective_peaks(&alternating, 0.0) - 50.0).abs() < 1e-12);
        // Runs of three: of 23 neighboring pairs 16 have equal signs and 7 do not.
        let runs: Vec<f64> = (0..24).map(|i| if i / 3 % 2 == 0 { 1.0 } else { -1.0 }).collect();
        let correlation = (16.0 - 7.0) / 24.0;
        let expected = 24.0 * (1.0 - correlation) / (1.0 + correlation);
        assert!((effective_peaks(&runs, 0.0) - expected).abs() < 1e-12);
        assert!((effective_peaks(&[0.0; 7], 0.0) - 7.0).abs() < 1e-12);
        assert!(effective_peaks(&[1e-9; 7], 1e-12) > 6.99);
    }

    #[test]
    fn the_criterion_is_the_formula() {
        let scaled = scaled(30);
        let mut law = Law::null(&scaled);
        law.squares = 0.6;
        let expected = 30.0 * (0.6_f64 / 30.0).ln() + 2.0 * 30.0_f64.ln() + 12.0 / 27.0;
        assert!((criterion(&law, &scaled, 30.0) - expected).abs() < 1e-6);
        assert!(criterion(&law, &scaled, 3.0).is_infinite());
    }

    #[test]
    fn no_law_is_no_choice() {
        assert!(choose(&[], &scaled(5), 2.0).is_none());
    }
}
