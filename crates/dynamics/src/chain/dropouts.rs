//! Loss of samples.

use super::step::{Samples, Step};
use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::law::Values;
use crate::units::Quantity;
use rand::{Rng, RngExt};

const DESCRIPTION: Description = Description {
    id: "dropouts",
    title: "Dropouts",
    kind: Kind::MeasuringChain,
    class: Class::Clock,
    equation: "samples lost in stretches: a share p, L at a time on average",
    latex: r"\text{a share}\ p\ \text{lost in stretches of mean length}\ L",
    parameters: &[
        Parameter {
            name: "share",
            symbol: "p",
            quantity: Quantity::Ratio,
            range: Range { minimum: 0.0, maximum: 0.9, closed: true },
            meaning: "expected share of the samples that are lost",
            default: None,
        },
        Parameter {
            name: "length",
            symbol: "L",
            quantity: Quantity::Samples,
            range: Range { minimum: 1.0, maximum: f64::INFINITY, closed: true },
            meaning: "mean number of samples lost in a row",
            default: None,
        },
    ],
    tell_tale: "Gaps in the stamps; if the stamps were computed from the index, jumps of the phase.",
    confused_with: &["clock_drift"],
    reference: "Gilbert, Bell System Technical Journal 39 (1960) 1253",
    driven_only: false,
    hidden_states: 0,
    smooth: false,
    example: &[0.3, 8.0],
};

/// Samples lost in stretches of geometrically distributed length (Gilbert's channel, which is either up or
/// down).
#[derive(Debug, Clone, Copy)]
pub struct Dropouts;

impl Step for Dropouts {
    const DESCRIPTION: &'static Description = &DESCRIPTION;

    fn distort<R: Rng + ?Sized>(
        &[share, length, ..]: &Values<f64>,
        samples: &mut Samples<f64>,
        generator: &mut R,
    ) {
        let recover = 1.0 / length;
        // The stationary share of lost samples is fail/(fail + recover).
        let fail = (share / (1.0 - share) * recover).min(1.0);
        let mut lost = generator.random::<f64>() < share;
        let kept: Vec<bool> = samples
            .values
            .iter()
            .map(|_| {
                let keep = !lost;
                let chance: f64 = generator.random();
                lost = if lost { chance >= recover } else { chance < fail };
                keep
            })
            .collect();
        samples.retain(&kept);
    }
}
