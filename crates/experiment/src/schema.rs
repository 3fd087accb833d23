//! Configuration keys of an experiment, except those of the estimators.

use envelope::RecommendedPipeline;
use identify::SamplesPipeline;
use record::{ClockChoice, Format, Missing, Origin, TimeUnit, Unit};
use settings::{Default, Field, Kind, Section};

/// Text field without unit and source; other fields refine it by struct update.
pub(crate) const PLAIN: Field =
    Field { key: "", kind: Kind::Text, default: Default::Absent, unit: "", meaning: "", source: "" };

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
    Field {
        key: "name",
        default: Default::Required,
        meaning: "The estimator, as `trainer list estimators` names it.",
        ..PLAIN
    }
}

/// Section of `task = "compare"`.
pub const COMPARE: Section<'static> = Section { name: "compare", fields: COMPARE_FIELDS };

const COMPARE_FIELDS: &[Field] = &[
    Field {
        key: "methods",
        kind: Kind::Texts { at_least: 1, at_most: 1000 },
        meaning: "Which methods, classical and learned, by name; left open, all of the paper's.",
        ..PLAIN
    },
    Field {
        key: "inertia_kg_m2",
        kind: Kind::Float { min: 1e-12, max: 1e12 },
        unit: "kg m^2",
        meaning: "Moment of inertia, for stiffness and damping coefficient, which are per unit of inertia \
                  without it; a free decay does not determine it.",
        ..PLAIN
    },
    Field {
        key: "claims",
        kind: Kind::Choice(&["none", "paper"]),
        default: Default::Text("none"),
        meaning: "Source of the statements to check against the numbers: the paper, or none.",
        ..PLAIN
    },
];

pub(crate) const TOP: &[Field] = &[
    Field {
        key: "task",
        kind: Kind::Choice(&["estimate", "compare", "predict"]),
        default: Default::Text("estimate"),
        meaning: "What to do: fit one estimator to a record, compare many methods on it, or score them on peaks held out.",
        ..PLAIN
    },
    Field {
        key: "name",
        default: Default::Absent,
        meaning: "Start of the run folder's name; left open, the estimator's.",
        ..PLAIN
    },
    Field {
        key: "seed",
        kind: Kind::Integer { min: 0, max: i64::MAX },
        default: Default::Integer(0),
        meaning: "Root of every random draw; each part draws from its own branch by name.",
        ..PLAIN
    },
];

pub(crate) const DATA: &[Field] = &[
    Field {
        key: "path",
        kind: Kind::Path,
        default: Default::Text("experiments/default-record/record.csv"),
        meaning: "The record file; a relative path starts from the folder of the configuration that says it, on the command line from the working directory.",
        source: "the simulated record that the project ships",
        ..PLAIN
    },
    Field {
        key: "source",
        meaning: "Repository and file of the record, for the message if it is absent.",
        ..PLAIN
    },
    Field {
        key: "format",
        kind: Kind::Choice(Format::NAMES),
        default: Default::Text("auto"),
        meaning: "Format of the file; auto detects it from the first line.",
        ..PLAIN
    },
    Field {
        key: "quantity",
        kind: Kind::Choice(&["position", "velocity", "acceleration"]),
        meaning: "What the sensor observes; left open, what the column's unit and name say, else position.",
        ..PLAIN
    },
    Field {
        key: "clock",
        kind: Kind::Choice(ClockChoice::NAMES),
        default: Default::Text("auto"),
        meaning: "Clock to use: the stamps, an even one in the sample index, or whichever stamps and values support.",
        ..PLAIN
    },
    Field {
        key: "time",
        meaning: "csv: name of the time column; left open, found by name and unit.",
        ..PLAIN
    },
    Field {
        key: "value",
        meaning: "csv: name of the observed column; left open, found by name and unit.",
        ..PLAIN
    },
    Field { key: "angle", meaning: "csv: the same as value, under its former name.", ..PLAIN },
    Field {
        key: "input",
        meaning: "csv: name of the measured input's column; left open, a torque or a force if there is one.",
        ..PLAIN
    },
    Field {
        key: "unit",
        kind: Kind::Choice(Unit::NAMES),
        meaning: "csv: unit of the observed column; left open, what the header says, else rad or m.",
        ..PLAIN
    },
    Field {
        key: "input_unit",
        kind: Kind::Choice(Unit::INPUT_NAMES),
        meaning: "csv: unit of the input; left open, what the header says.",
        ..PLAIN
    },
    Field {
        key: "time_unit",
        kind: Kind::Choice(TimeUnit::NAMES),
        meaning: "csv: unit of the time column, iso for dates; left open, what the header or the numbers say, else s.",
        ..PLAIN
    },
    Field {
        key: "from_s",
        kind: Kind::Float { min: -1e12, max: 1e12 },
        unit: "s",
        meaning: "Start of the part of the time to read; left open, that in which the system swings freely.",
        ..PLAIN
    },
    Field {
        key: "to_s",
        kind: Kind::Float { min: -1e12, max: 1e12 },
        unit: "s",
        meaning: "End of that part.",
        ..PLAIN
    },
    Field {
        key: "run",
        kind: Kind::Integer { min: 1, max: 65535 },
        meaning: "csv: the run to read, where a file holds several, each with its own time; left open, the first.",
        ..PLAIN
    },
    Field {
        key: "counts_per_turn",
        kind: Kind::Float { min: 1e-9, max: 1e12 },
        meaning: "csv: counts of the encoder that make a turn, where the observed column holds counts.",
        ..PLAIN
    },
    Field {
        key: "where",
        meaning: "csv: the lines to read, as COLUMN=VALUE, where a file holds several series; left open, all.",
        ..PLAIN
    },
    Field {
        key: "missing",
        kind: Kind::Choice(Missing::NAMES),
        default: Default::Text("segment"),
        meaning: "csv: how to treat cells without a number: as a gap, which clocks count and nothing bridges \
                  (segment), as rows that the file never had (drop), or as an error (refuse).",
        ..PLAIN
    },
    Field {
        key: "sample_rate_hz",
        kind: Kind::Float { min: 1e-9, max: 1e12 },
        unit: "Hz",
        meaning: "csv: sampling rate of a file that has no time column.",
        ..PLAIN
    },
    Field {
        key: "origin",
        kind: Kind::Choice(Origin::NAMES),
        meaning: "Where the numbers come from, for every table and report; left open, what the file states.",
        ..PLAIN
    },
    Field {
        key: "stated_rate_hz",
        kind: Kind::Float { min: 1e-9, max: 1e12 },
        unit: "Hz",
        meaning: "A sampling rate stated elsewhere, to be checked against the stamps.",
        ..PLAIN
    },
    Field {
        key: "stated_samples",
        kind: Kind::Integer { min: 1, max: i64::MAX },
        meaning: "A number of samples stated elsewhere, to be checked against the file.",
        ..PLAIN
    },
];

const ENVELOPE: &[Field] = &[Field {
    key: "pipeline",
    kind: Kind::Choice(&["auto", "paper", "recommended", "samples"]),
    default: Default::Text("auto"),
    meaning: "Pipeline from the record to its envelope: the paper's peaks, the recommended peaks, a fit of the samples, or \
              the last where the recommended peaks are few or mix several modes.",
    ..PLAIN
}];

pub(crate) const PAPER: &[Field] = &[
    Field {
        key: "interpolation_step_s",
        kind: Kind::Float { min: 1e-9, max: 1e6 },
        default: Default::Float(0.002),
        unit: "s",
        meaning: "Step of the even grid the record is interpolated to.",
        source: "the paper's 500 Hz",
    },
    Field {
        key: "smoothing_window",
        kind: Kind::Integer { min: 0, max: 1_000_001 },
        default: Default::Integer(0),
        unit: "grid points",
        meaning: "Window of the Savitzky-Golay smoothing, odd; 0 for none.",
        source: "the paper's numbers come out without smoothing",
    },
    Field {
        key: "smoothing_order",
        kind: Kind::Integer { min: 0, max: 20 },
        default: Default::Integer(3),
        meaning: "Order of the smoothing polynomial.",
        ..PLAIN
    },
    Field {
        key: "late_fraction",
        kind: Kind::Float { min: 1e-6, max: 1.0 },
        default: Default::Float(0.2),
        meaning: "Share of the record's end whose mean is taken for the rest position.",
        source: "the paper's late-time mean",
        ..PLAIN
    },
    Field {
        key: "peak_distance",
        kind: Kind::Integer { min: 1, max: 1_000_000_000 },
        default: Default::Integer(50),
        unit: "grid points",
        meaning: "Least distance between peaks.",
        source: "the paper's code",
    },
    Field {
        key: "prominence",
        kind: Kind::Float { min: 0.0, max: 1e12 },
        default: Default::Float(0.01),
        unit: "unit of the record",
        meaning: "Least prominence of a peak.",
        source: "the paper's code",
    },
];

pub(crate) const RECOMMENDED: &[Field] = &[
    Field {
        key: "half_width_periods",
        kind: Kind::Float { min: 1e-3, max: 0.25 },
        default: Default::Float(RecommendedPipeline::DEFAULT.half_width_periods),
        unit: "periods",
        meaning: "Half-width of the stretch around a turning point that a polynomial is fitted to.",
        source: "a quartic follows a sine over this stretch to 3e-4 of its height",
    },
    Field {
        key: "floor_in_noise",
        kind: Kind::Float { min: 0.0, max: 1e6 },
        default: Default::Float(RecommendedPipeline::DEFAULT.floor_in_noise),
        unit: "noise standard deviations",
        meaning: "Smallest amplitude that is used.",
        source: "the logarithm of a height known to 1/8 is known to 0.13 at worst",
    },
];

pub(crate) const SAMPLES: &[Field] = &[
    Field {
        key: "window_periods",
        kind: Kind::Float { min: 0.1, max: 100.0 },
        default: Default::Float(SamplesPipeline::DEFAULT.window_periods),
        unit: "periods",
        meaning: "Length of the windows whose samples are fitted; shorter where the amplitude falls to 1/e in less.",
        source: "two amplitudes a period, as many as there are peaks",
    },
    Field {
        key: "floor_in_errors",
        kind: Kind::Float { min: 1.0, max: 1e6 },
        default: Default::Float(SamplesPipeline::DEFAULT.floor_in_errors),
        unit: "standard errors",
        meaning: "Smallest amplitude that is used.",
        source: "the logarithm of an amplitude known to 1/8 is known to 0.13",
    },
];

/// Section `checkpoint`: the interval between checkpoints.
pub(crate) const CHECKPOINT: &[Field] = &[
    Field {
        key: "interval_s",
        kind: Kind::Float { min: 0.0, max: 1e9 },
        default: Default::Float(5.0),
        unit: "s",
        meaning: "Time between two checkpoints of a fit, and time spent on finished fits before they are \
                  saved: a crash costs at most this much work; 0 saves the state before every step.",
        source: "a checkpoint of 100 kB takes 0.6 to 12 ms, the machine idle or busy: 0.2 % of a fit at most",
    },
    Field {
        key: "interval_steps",
        kind: Kind::Integer { min: 1, max: i64::MAX },
        unit: "steps",
        meaning: "Steps between two checkpoints of a fit, in place of the time.",
        ..PLAIN
    },
];

const FIT: &[Field] = &[
    Field {
        key: "seeds",
        kind: Kind::Integer { min: 1, max: 100_000 },
        default: Default::Integer(1),
        meaning: "How many seeds to fit, from `seed` on; the result is the first one's, the worst is reported.",
        ..PLAIN
    },
    Field {
        key: "max_steps",
        kind: Kind::Integer { min: 0, max: i64::MAX },
        meaning: "Cap on the training steps, in addition to the estimator's own; 0 leaves it untrained.",
        ..PLAIN
    },
    Field {
        key: "tolerance_percent",
        kind: Kind::Float { min: 0.0, max: 1e9 },
        default: Default::Float(0.1),
        unit: "%",
        meaning: "Largest distance from closed-form least squares that passes.",
        source: "the paper's bar",
    },
];
