//! Configuration keys of trials.

use settings::{Default, Field, Kind, Section};

/// All sections of a trial configuration.
pub(crate) const SECTIONS: &[Section<'static>] = &[
    Section { name: "", fields: TOP },
    Section { name: "trials", fields: TRIALS },
    Section { name: "record", fields: RECORD },
    Section { name: "system", fields: SYSTEM },
    Section { name: "sensor", fields: SENSOR },
    Section { name: "gate", fields: GATE },
];

const TOP: &[Field] = &[
    Field::new("task", Kind::Choice(&["trials"]), Default::Text("trials"))
        .meaning("What the configuration is for."),
    Field::new("name", Kind::Text, Default::Text("trials")).meaning("Start of the run folder's name."),
    Field::new("seed", Kind::Integer { min: 0, max: i64::MAX }, Default::Integer(0))
        .meaning("Root of every random draw; a case draws from a branch of its own."),
];

const fn count(key: &'static str, meaning: &'static str) -> Field {
    Field::new(key, Kind::Integer { min: 0, max: 1_000_000 }, Default::Integer(0))
        .unit("cases")
        .meaning(meaning)
}

const TRIALS: &[Field] = &[
    count("none", "Cases in which nothing is missing and the nominal simulator is exact."),
    count("calibration", "Cases in which nothing is missing and the nominal coefficients are off."),
    count("single", "Cases with one effect of the vocabulary, each effect at each detectability in turn."),
    count("pair", "Cases with two effects, each pair at each detectability in turn."),
    count("left_out", "Cases with one effect that the diagnosis is told not to consider."),
    count("foreign", "Cases with something that the vocabulary does not have."),
    count("releases", "Cases with one effect and two or three releases of different amplitude."),
    count("driven", "Cases with one effect and a measured input."),
    count("stressed", "Cases with one effect by another law, another integrator, correlated disturbances."),
    count(
        "measured_cases",
        "Cases with one effect added to what a diagnosis left over of a measured record.",
    ),
    count("engine_cases", "Cases of a physics engine, at most; those of the folder, in order."),
    count("composite", "Cases with two to six effects of very different size beside unlisted smooth laws."),
    count("rigs_cases", "Rigs of another program, at most; those of the folder, in order."),
    Field::new("rigs", Kind::Path, Default::Absent)
        .meaning("Folder with rigs and their truths, as experiments/rigs makes it."),
    Field::new("measured", Kind::Path, Default::Absent).meaning(
        "Folder with residual-*.csv (columns time_s and residual, in rad) of measured \
                records.",
    ),
    Field::new("engine", Kind::Path, Default::Absent)
        .meaning("Folder with the records of a physics engine, as experiments/physics-engine makes it."),
    Field::new(
        "detectabilities",
        Kind::Floats { min: 0.1, max: 1000.0, at_least: 1, at_most: 20 },
        Default::Floats(&[3.0, 6.0, 12.0, 25.0, 50.0, 100.0]),
    )
    .unit("noise units")
    .meaning(
        "Sizes of hidden effects: root of the sum of squares of what no recalibration \
                absorbs.",
    ),
];

const RECORD: &[Field] = &[
    Field::new("rate_hz", Kind::Float { min: 20.0, max: 100_000.0 }, Default::Float(260.0))
        .unit("Hz")
        .meaning("Samples per second of the sensor's own clock.")
        .source("the paper's rig"),
    Field::new("seconds", Kind::Float { min: 1.0, max: 10_000.0 }, Default::Float(25.0))
        .unit("s")
        .meaning("Length of a record.")
        .source("the paper's rig"),
    Field::new("smallest_release_deg", Kind::Float { min: 1.0, max: 120.0 }, Default::Float(20.0))
        .unit("deg")
        .meaning("Smallest release, or largest swing of a driven record, from the rest angle."),
    Field::new("largest_release_deg", Kind::Float { min: 1.0, max: 120.0 }, Default::Float(60.0))
        .unit("deg")
        .meaning("Largest release, or largest swing of a driven record, from the rest angle."),
];

const SYSTEM: &[Field] = &[
    Field::new("lowest_frequency_hz", Kind::Float { min: 0.1, max: 100.0 }, Default::Float(1.0))
        .unit("Hz")
        .meaning("Lowest natural frequency; drawn uniformly in its logarithm."),
    Field::new("highest_frequency_hz", Kind::Float { min: 0.1, max: 100.0 }, Default::Float(8.0))
        .unit("Hz")
        .meaning("Highest natural frequency."),
    Field::new("smallest_damping_ratio", Kind::Float { min: 1e-4, max: 0.5 }, Default::Float(0.002))
        .meaning("Smallest damping ratio; drawn uniformly in its logarithm."),
    Field::new("largest_damping_ratio", Kind::Float { min: 1e-4, max: 0.5 }, Default::Float(0.03))
        .meaning("Largest damping ratio."),
];

const SENSOR: &[Field] = &[
    Field::new("smallest_noise", Kind::Float { min: 1e-7, max: 0.1 }, Default::Float(2e-4))
        .unit("rad")
        .meaning(
            "Smallest standard deviation of the sensor's white noise; drawn uniformly in its \
                logarithm.",
        ),
    Field::new("largest_noise", Kind::Float { min: 1e-7, max: 0.1 }, Default::Float(1e-3))
        .unit("rad")
        .meaning("Largest standard deviation of the sensor's white noise."),
];

const fn share(key: &'static str, meaning: &'static str) -> Field {
    Field::new(key, Kind::Float { min: 0.0, max: 1.0 }, Default::Absent).meaning(meaning)
}

const GATE: &[Field] = &[
    share("leading_named", "Least share of composite cases in which the leading effect's class is named."),
    share(
        "leading_sure",
        "Least share of composite cases in which the leading effect's class gets 0.9 or more.",
    ),
    share("recall", "Least share of effects of 10 x noise or more whose class is named, where several act."),
    share("precision", "Least share of names whose class acts, where several effects act."),
    share(
        "unknown",
        "Least share of `unknown`, or allowed classes, where a law outside the vocabulary acts alone.",
    ),
    share("false_alarms", "Largest share of alarms where nothing is missing."),
    share(
        "calibration_error",
        "Largest calibration error of the probabilities of classes, where several effects act.",
    ),
    share(
        "regret",
        "Largest share of composite cases whose error is above 1.1 times that of the set that is there.",
    ),
];
