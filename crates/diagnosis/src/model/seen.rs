//! Observed quantity along a motion, with its derivatives.

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
        // A response has an entry for every row; derivatives that it lacks count as zero.
        let of = |lists: [&'r [f64]; 3], index: usize| {
            let [value, others @ ..] = lists;
            // As said above.
            let [rate, curvature] = others.map(|list| list.get(index).copied().unwrap_or(0.0));
            Some([*value.get(index)?, rate, curvature])
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
        // As above.
        let of = |list: &[f64]| list.get(row).copied().unwrap_or(0.0);
        let [value, rate, _] = self.motion.map(of);
        let read = self.lagged.as_ref().map(|own| [of(&own.values), of(&own.by_constant)]);
        (read.unwrap_or([value, 0.0]), rate)
    }

    /// Returns the derivative by the free quantity of a column.
    pub(crate) fn by(&self, row: usize, column: usize) -> f64 {
        let [by_value, ..] = self.by_free;
        let own = match &self.lagged {
            Some(lagged) => lagged.by_free.get(column).and_then(|own| own.get(row)),
            None => by_value.get(row * self.columns + column),
        };
        // As above.
        own.copied().unwrap_or(0.0)
    }
}
