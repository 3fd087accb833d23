//! Observed quantity along a motion, with its derivatives.

#![allow(
    clippy::indexing_slicing,
    reason = "a series that was integrated has an entry for every row and column"
)]

use crate::model::lag::Lag;
use dynamics::sensitivity::Response;
use record::Quantity;

/// Observed quantity along a motion, with its derivatives by all free quantities: values, rates and
/// curvatures by rows. The third derivative of the position is not integrated; where it is needed, it counts as
/// zero.
pub(crate) struct Seen<'r> {
    motion: [&'r [f64]; 3],
    by_free: [&'r [f64]; 3],
    columns: usize,
    lagged: Option<Lagged>,
}

/// The quantity after the sensor's lag, its derivatives by the time constant, and those by each free quantity.
struct Lagged {
    values: Vec<f64>,
    by_constant: Vec<f64>,
    by_free: Vec<Vec<f64>>,
}

impl<'r> Seen<'r> {
    pub(crate) fn new(response: &'r Response, quantity: Quantity) -> Self {
        let motion = [&response.position, &response.velocity, &response.acceleration];
        let by_free = [
            &response.position_sensitivity,
            &response.velocity_sensitivity,
            &response.acceleration_sensitivity,
        ];
        let order = match quantity {
            Quantity::Position => 0,
            Quantity::Velocity => 1,
            Quantity::Acceleration => 2,
        };
        let from = |all: [&'r Vec<f64>; 3]| {
            [0, 1, 2].map(|derivative| all.get(order + derivative).map_or(&[][..], |list| list.as_slice()))
        };
        Self { motion: from(motion), by_free: from(by_free), columns: response.columns, lagged: None }
    }

    /// Returns the same as a sensor with a lag sees it.
    /// `differentiated` asks for the derivatives by the time constant, which count as zero otherwise.
    pub(crate) fn through(self, lag: &Lag<'_>, differentiated: bool) -> Self {
        let of = |[value, rate, curvature]: [&'r [f64]; 3], index: usize| {
            Some([*value.get(index)?, at(rate, index), at(curvature, index)])
        };
        let motion = |row: usize| of(self.motion, row);
        let column = |own: usize| lag.of(&|row| of(self.by_free, row * self.columns + own));
        let lagged = Lagged {
            values: lag.of(&motion),
            by_constant: if differentiated { lag.by_constant(&motion) } else { Vec::new() },
            by_free: (0..self.columns).map(column).collect(),
        };
        Self { lagged: Some(lagged), ..self }
    }

    /// Returns the quantity after the lag with its derivative by the time constant, and its rate.
    pub(crate) fn at(&self, row: usize) -> ([f64; 2], f64) {
        let [value, rate, _] = self.motion.map(|list| at(list, row));
        let read = self.lagged.as_ref().map(|own| [own.values[row], at(&own.by_constant, row)]);
        (read.unwrap_or([value, 0.0]), rate)
    }

    /// Returns the derivative by the free quantity of a column.
    pub(crate) fn by(&self, row: usize, column: usize) -> f64 {
        match &self.lagged {
            Some(lagged) => lagged.by_free[column][row],
            None => self.by_free[0][row * self.columns + column],
        }
    }
}

/// Returns an entry of a series; zero for a series that was not integrated.
fn at(series: &[f64], index: usize) -> f64 {
    if series.is_empty() { 0.0 } else { series[index] }
}
