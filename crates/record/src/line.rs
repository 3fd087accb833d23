//! A straight line through points.

/// The least-squares line through (x, y) and what it leaves.
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
    /// The line through the points; its numbers are not finite where all x are equal.
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

    /// Sum of the squared residuals.
    pub(crate) fn squares(&self) -> f64 {
        self.residuals.iter().map(|residual| residual * residual).sum()
    }
}
