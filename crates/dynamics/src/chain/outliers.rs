//! Isolated wrong samples.

use super::step::{Samples, Step};
use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::law::Values;
use crate::units::Quantity;
use rand::{Rng, RngExt};
use rand_distr::StandardNormal;

const DESCRIPTION: Description = Description {
    id: "outliers",
    title: "Outliers",
    kind: Kind::MeasuringChain,
    class: Class::Sensor,
    equation: "x + s n with probability p, n standard normal",
    latex: r"x+s\,n\ \text{with probability}\ p,\quad n\sim\mathcal N(0,1)",
    parameters: &[
        Parameter {
            name: "probability",
            symbol: "p",
            quantity: Quantity::Ratio,
            range: Range { minimum: 0.0, maximum: 1.0, closed: true },
            meaning: "probability that a sample is wrong, independently of the others",
            default: None,
        },
        Parameter {
            name: "size",
            symbol: "s",
            quantity: Quantity::Observed,
            range: Range::POSITIVE,
            meaning: "standard deviation of a wrong sample's error",
            default: None,
        },
    ],
    tell_tale: "Heavy tails: isolated samples are far off, but their neighbors are right.",
    confused_with: &[],
    reference: "Huber, Annals of Mathematical Statistics 35 (1964) 73 (contaminated normal)",
    driven_only: false,
    hidden_states: 0,
    smooth: false,
    example: &[0.03, 0.2],
};

/// Samples that are wrong by a normal error, each with a probability and independent of the others. A sensor
/// with a step reports wrong readings on its lattice too: see [`crate::chain::Chain::observe`].
#[derive(Debug, Clone, Copy)]
pub struct Outliers;

impl Step for Outliers {
    const DESCRIPTION: &'static Description = &DESCRIPTION;

    fn distort<R: Rng + ?Sized>(
        &[probability, size, ..]: &Values<f64>,
        samples: &mut Samples<f64>,
        generator: &mut R,
    ) {
        for value in &mut samples.values {
            // Two draws for each sample, so that earlier wrong samples do not change later draws.
            let (chance, error): (f64, f64) = (generator.random(), generator.sample(StandardNormal));
            if chance < probability {
                *value += size * error;
            }
        }
    }
}
