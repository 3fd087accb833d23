//! Least-squares line and parabola through points.

/// The least-squares line through points (x, y) and its residuals.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Line {
    pub(crate) slope: f64,
    pub(crate) intercept: f64,
    /// Σ (x − x̄)².
    pub(crate) spread_x: f64,
    /// y minus the line, in the order of the points.
    pub(crate) residuals: Vec<f64>,
}

impl Line {
    /// Fits the line through points; its numbers are not finite if all x are equal.
    pub(crate) fn through(points: &[(f64, f64)]) -> Self {
        let count = points.len() as f64;
        let mean_x = points.iter().map(|point| point.0).sum::<f64>() / count;
        let mean_y = points.iter().map(|point| point.1).sum::<f64>() / count;
        let spread_x: f64 = points.iter().map(|point| (point.0 - mean_x).powi(2)).sum();
        let product: f64 = points.iter().map(|point| (point.0 - mean_x) * (point.1 - mean_y)).sum();
        let slope = product / spread_x;
        Self {
            slope,
            intercept: mean_y - slope * mean_x,
            spread_x,
            residuals: points.iter().map(|point| point.1 - mean_y - slope * (point.0 - mean_x)).collect(),
        }
    }

    /// Returns the variance of the residuals times (1 + r)/(1 − r) with their lag-one autocorrelation r:
    /// AR(1) residuals carry that much less information than white ones.
    pub(crate) fn effective_variance(&self) -> f64 {
        let r = autocorrelation(&self.residuals).clamp(0.0, 0.99);
        let degrees = (self.residuals.len() as f64 - 2.0).max(1.0);
        self.squares() / degrees * (1.0 + r) / (1.0 - r)
    }

    /// Returns the standard error of the slope.
    pub(crate) fn slope_std_error(&self) -> f64 {
        (self.effective_variance() / self.spread_x).sqrt()
    }

    /// Returns the sum of the squared residuals.
    pub(crate) fn squares(&self) -> f64 {
        self.residuals.iter().map(|residual| residual * residual).sum()
    }
}

/// A parabola fitted to the residuals of a line.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Bend {
    /// Root mean square of the parabola's part beyond the line.
    pub(crate) size: f64,
    /// That part over its standard error. The remaining residuals may wander, so the standard error is the
    /// larger of two: one widened for their autocorrelation as an AR(1) process, and one from the
    /// disagreement between stretches of the points.
    pub(crate) standard_errors: f64,
    /// The line with the residuals that remain beside the parabola.
    pub(crate) line: Line,
}

/// Number of stretches to compare; the parabola uses up three of them.
const STRETCHES: usize = 12;

impl Bend {
    /// Fits a parabola to the residuals of a line through the points.
    pub(crate) fn of(line: &Line, points: &[(f64, f64)]) -> Self {
        let count = points.len() as f64;
        let mean_x = points.iter().map(|point| point.0).sum::<f64>() / count;
        let squares: Vec<(f64, f64)> =
            points.iter().map(|point| (point.0, (point.0 - mean_x).powi(2) / line.spread_x)).collect();
        // Orthogonal to constants and to x.
        let bent = Line::through(&squares).residuals;
        let square: f64 = bent.iter().map(|b| b * b).sum();
        let product: f64 = bent.iter().zip(&line.residuals).map(|(b, r)| b * r).sum();
        let factor = if square > 0.0 { product / square } else { 0.0 };
        let residuals: Vec<f64> = line.residuals.iter().zip(&bent).map(|(r, b)| r - factor * b).collect();
        let left = Line { residuals, ..line.clone() };
        let length = points.len().div_ceil(STRETCHES).max(1);
        let stretches = bent.chunks(length).zip(left.residuals.chunks(length));
        let sums = stretches.map(|(b, r)| b.iter().zip(r).map(|(b, r)| b * r).sum::<f64>().powi(2));
        let apart =
            sums.sum::<f64>() * STRETCHES as f64 / (STRETCHES - 3) as f64 / square.max(f64::MIN_POSITIVE);
        let error = (left.effective_variance().max(apart) / square.max(f64::MIN_POSITIVE)).sqrt();
        let standard_errors = if error > 0.0 { factor.abs() / error } else { 0.0 };
        Self { size: factor.abs() * (square / count).sqrt(), standard_errors, line: left }
    }
}

/// Returns the lag-one autocorrelation about the mean; 0 for a constant series.
fn autocorrelation(series: &[f64]) -> f64 {
    let mean = series.iter().sum::<f64>() / series.len().max(1) as f64;
    let square: f64 = series.iter().map(|x| (x - mean).powi(2)).sum();
    let product: f64 = series.iter().zip(series.iter().skip(1)).map(|(a, b)| (a - mean) * (b - mean)).sum();
    if square > 0.0 { product / square } else { 0.0 }
}
