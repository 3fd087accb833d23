//! Configuration keys of an experiment, except those of the estimators.

use envelope::RecommendedPipeline;
use identify::SamplesPipeline;
use record::{ClockChoice, Format, Missing, Origin, TimeUnit, Unit};
use settings::{Default, Field, Kind, Section};

/// All sections except those of a single task.
pub const SECTIONS: &[Section<'static>] = &[
    Section { name: "", fields: TOP },
    Section { name: "data", fields: DATA },
    Section { name: "envelope", fields: ENVELOPE },
    Section { name: "envelope.paper", fields: PAPER },
    Section { name: "envelope.recommended", fields: RECOMMENDED },
    Section { name: "envelope.samples", fields: SAMPLES },
    Section { name: "fit", fields: FIT },
    Section { name: "checkpoint", fields: CHECKPOINT },
];

/// Returns the key that names the estimator, within the section `estimator`.
#[must_use]
pub const fn estimator_name_field() -> Field {
    Field::new("name", Kind::Text, Default::Required)
        .meaning("The estimator, as `trainer list estimators` names it.")
}

/// Section of `task = "compare"`.
pub const COMPARE: Section<'static> = Section { name: "compare", fields: COMPARE_FIELDS };

const COMPARE_FIELDS: &[Field] = &[
    Field::new("methods", Kind::Texts { at_least: 1, at_most: 1000 }, Default::Absent)
        .meaning("Which methods, classical and learned, by name; left open, all of the paper's."),
    Field::new("inertia_kg_m2", Kind::Float { min: 1e-12, max: 1e12 }, Default::Absent)
        .unit("kg m^2")
        .meaning(
            "Moment of inertia, for stiffness and damping coefficient, which are per unit of \
                inertia without it; a free decay does not determine it.",
        ),
    Field::new("claims", Kind::Choice(&["none", "paper"]), Default::Text("none"))
        .meaning("Source of the statements to check against the numbers: the paper, or none."),
];

pub(crate) const TOP: &[Field] = &[
    Field::new("task", Kind::Choice(&["estimate", "compare", "predict"]), Default::Text("estimate")).meaning(
        "What to do: fit one estimator to a record, compare many methods on it, or score them \
                on peaks held out.",
    ),
    Field::new("name", Kind::Text, Default::Absent)
        .meaning("Start of the run folder's name; left open, the estimator's."),
    Field::new("seed", Kind::Integer { min: 0, max: i64::MAX }, Default::Integer(0))
        .meaning("Root of every random draw; each part draws from its own branch by name."),
];

pub(crate) const DATA: &[Field] = &[
    Field::new("path", Kind::Path, Default::Text("experiments/default-record/record.csv"))
        .meaning(
            "The record file; a relative path starts from the folder of the configuration that \
                says it, on the command line from the working directory.",
        )
        .source("the simulated record that the project ships"),
    Field::new("source", Kind::Text, Default::Absent)
        .meaning("Repository and file of the record, for the message if it is absent."),
    Field::new("format", Kind::Choice(Format::NAMES), Default::Text("auto"))
        .meaning("Format of the file; auto detects it from the first line."),
    Field::new("quantity", Kind::Choice(&["position", "velocity", "acceleration"]), Default::Absent).meaning(
        "What the sensor observes; left open, what the column's unit and name say, else \
                position.",
    ),
    Field::new("clock", Kind::Choice(ClockChoice::NAMES), Default::Text("auto")).meaning(
        "Clock to use: the stamps, an even one in the sample index, or whichever stamps and \
                values support.",
    ),
    Field::new("time", Kind::Text, Default::Absent)
        .meaning("csv: name of the time column; left open, found by name and unit."),
    Field::new("value", Kind::Text, Default::Absent)
        .meaning("csv: name of the observed column; left open, found by name and unit."),
    Field::new("angle", Kind::Text, Default::Absent)
        .meaning("csv: the same as value, under its former name."),
    Field::new("input", Kind::Text, Default::Absent).meaning(
        "csv: name of the measured input's column; left open, a torque or a force if there is \
                one.",
    ),
    Field::new("unit", Kind::Choice(Unit::NAMES), Default::Absent)
        .meaning("csv: unit of the observed column; left open, what the header says, else rad or m."),
    Field::new("input_unit", Kind::Choice(Unit::INPUT_NAMES), Default::Absent)
        .meaning("csv: unit of the input; left open, what the header says."),
    Field::new("time_unit", Kind::Choice(TimeUnit::NAMES), Default::Absent).meaning(
        "csv: unit of the time column, iso for dates; left open, what the header or the \
                numbers say, else s.",
    ),
    Field::new("from_s", Kind::Float { min: -1e12, max: 1e12 }, Default::Absent).unit("s").meaning(
        "Start of the part of the time to read; left open, that in which the system swings \
                freely.",
    ),
    Field::new("to_s", Kind::Float { min: -1e12, max: 1e12 }, Default::Absent)
        .unit("s")
        .meaning("End of that part."),
    Field::new("run", Kind::Integer { min: 1, max: 65535 }, Default::Absent).meaning(
        "csv: the run to read, where a file holds several, each with its own time; left open, \
                the first.",
    ),
    Field::new("counts_per_turn", Kind::Float { min: 1e-9, max: 1e12 }, Default::Absent)
        .meaning("csv: counts of the encoder that make a turn, where the observed column holds counts."),
    Field::new("where", Kind::Text, Default::Absent).meaning(
        "csv: the lines to read, as COLUMN=VALUE, where a file holds several series; left \
                open, all.",
    ),
    Field::new("missing", Kind::Choice(Missing::NAMES), Default::Text("segment")).meaning(
        "csv: how to treat cells without a number: as a gap, which clocks count and nothing \
                bridges (segment), as rows that the file never had (drop), or as an error (refuse).",
    ),
    Field::new("sample_rate_hz", Kind::Float { min: 1e-9, max: 1e12 }, Default::Absent)
        .unit("Hz")
        .meaning("csv: sampling rate of a file that has no time column."),
    Field::new("origin", Kind::Choice(Origin::NAMES), Default::Absent).meaning(
        "Where the numbers come from, for every table and report; left open, what the file \
                states.",
    ),
    Field::new("stated_rate_hz", Kind::Float { min: 1e-9, max: 1e12 }, Default::Absent)
        .unit("Hz")
        .meaning("A sampling rate stated elsewhere, to be checked against the stamps."),
    Field::new("stated_samples", Kind::Integer { min: 1, max: i64::MAX }, Default::Absent)
        .meaning("A number of samples stated elsewhere, to be checked against the file."),
];

const ENVELOPE: &[Field] = &[Field::new(
    "pipeline",
    Kind::Choice(&["auto", "paper", "recommended", "samples"]),
    Default::Text("auto"),
)
.meaning(
    "Pipeline from the record to its envelope: the paper's peaks, the recommended peaks, \
                a fit of the samples, or the last where the recommended peaks are few or mix several \
                modes.",
)];

pub(crate) const PAPER: &[Field] = &[
    Field::new("interpolation_step_s", Kind::Float { min: 1e-9, max: 1e6 }, Default::Float(0.002))
        .unit("s")
        .meaning("Step of the even grid the record is interpolated to.")
        .source("the paper's 500 Hz"),
    Field::new("smoothing_window", Kind::Integer { min: 0, max: 1_000_001 }, Default::Integer(0))
        .unit("grid points")
        .meaning("Window of the Savitzky-Golay smoothing, odd; 0 for none.")
        .source("the paper's numbers come out without smoothing"),
    Field::new("smoothing_order", Kind::Integer { min: 0, max: 20 }, Default::Integer(3))
        .meaning("Order of the smoothing polynomial."),
    Field::new("late_fraction", Kind::Float { min: 1e-6, max: 1.0 }, Default::Float(0.2))
        .meaning("Share of the record's end whose mean is taken for the rest position.")
        .source("the paper's late-time mean"),
    Field::new("peak_distance", Kind::Integer { min: 1, max: 1_000_000_000 }, Default::Integer(50))
        .unit("grid points")
        .meaning("Least distance between peaks.")
        .source("the paper's code"),
    Field::new("prominence", Kind::Float { min: 0.0, max: 1e12 }, Default::Float(0.01))
        .unit("unit of the record")
        .meaning("Least prominence of a peak.")
        .source("the paper's code"),
];

pub(crate) const RECOMMENDED: &[Field] = &[
    Field::new(
        "half_width_periods",
        Kind::Float { min: 1e-3, max: 0.25 },
        Default::Float(RecommendedPipeline::DEFAULT.half_width_periods),
    )
    .unit("periods")
    .meaning("Half-width of the stretch around a turning point that a polynomial is fitted to.")
    .source("a quartic follows a sine over this stretch to 3e-4 of its height"),
    Field::new(
        "floor_in_noise",
        Kind::Float { min: 0.0, max: 1e6 },
        Default::Float(RecommendedPipeline::DEFAULT.floor_in_noise),
    )
    .unit("noise standard deviations")
    .meaning("Smallest amplitude that is used.")
    .source("the logarithm of a height known to 1/8 is known to 0.13 at worst"),
];

pub(crate) const SAMPLES: &[Field] = &[
    Field::new(
        "window_periods",
        Kind::Float { min: 0.1, max: 100.0 },
        Default::Float(SamplesPipeline::DEFAULT.window_periods),
    )
    .unit("periods")
    .meaning(
        "Length of the windows whose samples are fitted; shorter where the amplitude falls to \
                1/e in less.",
    )
    .source("two amplitudes a period, as many as there are peaks"),
    Field::new(
        "floor_in_errors",
        Kind::Float { min: 1.0, max: 1e6 },
        Default::Float(SamplesPipeline::DEFAULT.floor_in_errors),
    )
    .unit("standard errors")
    .meaning("Smallest amplitude that is used.")
    .source("the logarithm of an amplitude known to 1/8 is known to 0.13"),
];

/// Section `checkpoint`: the interval between checkpoints.
pub(crate) const CHECKPOINT: &[Field] = &[
    Field::new("interval_s", Kind::Float { min: 0.0, max: 1e9 }, Default::Float(5.0))
        .unit("s")
        .meaning(
            "Time between two checkpoints of a fit, and time spent on finished fits before they \
                are saved: a crash costs at most this much work; 0 saves the state before every \
                step.",
        )
        .source(
            "a checkpoint of 100 kB takes 0.6 to 12 ms, the machine idle or busy: 0.2 % of a fit \
                at most",
        ),
    Field::new("interval_steps", Kind::Integer { min: 1, max: i64::MAX }, Default::Absent)
        .unit("steps")
        .meaning("Steps between two checkpoints of a fit, in place of the time."),
];

const FIT: &[Field] = &[
    Field::new("seeds", Kind::Integer { min: 1, max: 100_000 }, Default::Integer(1)).meaning(
        "How many seeds to fit, from `seed` on; the result is the first one's, the worst is \
                reported.",
    ),
    Field::new("max_steps", Kind::Integer { min: 0, max: i64::MAX }, Default::Absent).meaning(
        "Cap on the training steps, in addition to the estimator's own; 0 leaves it \
                untrained.",
    ),
    Field::new("tolerance_percent", Kind::Float { min: 0.0, max: 1e9 }, Default::Float(0.1))
        .unit("%")
        .meaning("Largest distance from closed-form least squares that passes.")
        .source("the paper's bar"),
];
