//! Configuration keys shared by all amortized estimators.

use settings::{Default, Field, Kind};

/// Smallest and largest number of peaks of a simulated envelope.
pub const PEAKS: Field = Field::new(
    "peaks",
    Kind::Integers { min: 5, max: 10_000, at_least: 2, at_most: 2 },
    Default::Integers(&[10, 400]),
)
.unit("peaks")
.meaning("Fewest and most peaks of a simulated envelope, drawn evenly in the logarithm.")
.source("ring-downs of a few cycles up to Q of about a thousand");

/// Smallest and largest decay of a simulated envelope.
pub const DECAY: Field = Field::new(
    "decay",
    Kind::Floats { min: 1e-3, max: 100.0, at_least: 2, at_most: 2 },
    Default::Floats(&[0.3, 8.0]),
)
.meaning(
    "Least and largest change of ln A over a simulated envelope, drawn evenly in the \
                logarithm; half of them grow.",
)
.source(
    "from amplitudes that lose a quarter to those that lose all but a three-thousandth, a \
                12-bit sensor's range",
);

/// Smallest and largest scatter of a simulated envelope.
pub const SCATTER: Field = Field::new(
    "scatter",
    Kind::Floats { min: 1e-6, max: 10.0, at_least: 2, at_most: 2 },
    Default::Floats(&[0.003, 0.3]),
)
.meaning(
    "Least and largest standard deviation of ln A about the simulated curve, drawn evenly \
                in the logarithm.",
)
.source("amplitudes good to 0.3 % up to 30 %");

/// Unevenness of the simulated times.
pub const UNEVENNESS: Field =
    Field::new("unevenness", Kind::Float { min: 0.0, max: 1.0 }, Default::Float(0.15))
        .unit("intervals")
        .meaning("Largest standard deviation of a simulated peak's time; drawn evenly from 0.")
        .source("host stamps that come in bursts shift a peak by a tenth of a period");

/// Probability of missing peaks in a simulated envelope.
pub const MISSING: Field = Field::new("missing", Kind::Float { min: 0.0, max: 0.9 }, Default::Float(0.2))
    .meaning("Largest probability that a simulated peak is missing; drawn evenly from 0.")
    .source("peaks below the prominence are left out");

/// Share of bent envelopes.
pub const BENT: Field = Field::new("bent", Kind::Float { min: 0.0, max: 1.0 }, Default::Float(0.5))
    .meaning(
        "Share of the simulated envelopes that bend; their rate is that of the line closest \
                to the curve.",
    )
    .source("dry friction and drag bend measured envelopes");

/// Largest bend of a simulated envelope.
pub const BEND: Field = Field::new("bend", Kind::Float { min: 0.0, max: 1.0 }, Default::Float(0.25))
    .meaning(
        "Largest distance of a bent envelope from its chord, as a share of the decay; drawn \
                evenly, to either side.",
    )
    .source("the published records lie 13 to 19 % off");

/// Largest number of entries that the network reads.
pub const LONGEST_SEQUENCE: Field =
    Field::new("longest_sequence", Kind::Integer { min: 4, max: 1000 }, Default::Integer(24))
        .unit("peaks")
        .meaning(
            "Most entries the network reads; a longer envelope is read as means over even runs of \
                neighboring peaks.",
        )
        .source("means over runs cost 1/runs² of the slope's accuracy: 0.7 % of the variance at 12");

/// Largest number of looks at an envelope.
pub const MOST_LOOKS: Field =
    Field::new("most_looks", Kind::Integer { min: 1, max: 1000 }, Default::Integer(20))
        .meaning(
            "Most looks at an envelope; each look after the first reads the residual of the \
                previous look's line.",
        )
        .source("several times what envelopes of the prior take");

/// Number of training steps.
pub const MAX_STEPS: Field =
    Field::new("max_steps", Kind::Integer { min: 0, max: 1_000_000 }, Default::Integer(400))
        .meaning("Steps of the training, each on simulated envelopes of its own.")
        .source("where the error over fresh envelopes is near that of least squares");

/// Number of envelopes per step.
pub const BATCH: Field = Field::new("batch", Kind::Integer { min: 2, max: 10_000 }, Default::Integer(32))
    .unit("envelopes")
    .meaning("Simulated envelopes of a step, all with the same number of peaks.")
    .source("64 take twice the time and gain one or two percent of accuracy");

/// Largest learning rate.
pub const LEARNING_RATE: Field =
    Field::new("learning_rate", Kind::Float { min: 1e-6, max: 1.0 }, Default::Float(0.01))
        .meaning(
            "Largest rate of Adam; it rises over a twentieth of the steps and falls with a \
                cosine.",
        )
        .source("Kingma, Ba 2015; Loshchilov, Hutter 2017");

/// Number of envelopes for the calibration.
pub const CALIBRATION: Field =
    Field::new("calibration", Kind::Integer { min: 0, max: 1_000_000 }, Default::Integer(3000))
        .unit("envelopes")
        .meaning(
            "Number of simulated envelopes, not used in training, on which the stated errors are \
                scaled so that 95 % of the intervals contain the truth; 0 for no scaling.",
        )
        .source("their chance is worth 0.4 % of coverage; Papadopoulos et al. 2002");
