//! Words in the names of columns, by the role that they suggest.

/// Names of time columns, most reliable first.
pub(crate) const TIMES: &[&str] = &[
    "time",
    "t",
    "timestamp",
    "stamp",
    "ts",
    "elapsed",
    "seconds",
    "second",
    "secs",
    "sec",
    "millis",
    "milliseconds",
    "ms",
    "micros",
    "microseconds",
    "us",
    "nanos",
    "ns",
    "zeit",
    "datetime",
    "date",
    "clock",
];

/// Names of position columns, most reliable first. Of a file's columns, the one with the earliest of these
/// names is taken.
pub(crate) const POSITIONS: &[&str] = &[
    "angle",
    "theta",
    "displacement",
    "position",
    "pos",
    "phi",
    "winkel",
    "weg",
    "auslenkung",
    "deflection",
    "travel",
    "roll",
    "pitch",
    "yaw",
    "q",
    "encoder",
    "enc",
    "y",
    "x",
    "z",
    "state",
    "measured",
    "ist",
    "istwert",
];

/// Names of columns of velocities.
pub(crate) const VELOCITIES: &[&str] =
    &["velocity", "vel", "gyro", "omega", "speed", "qd", "dq", "thetadot", "gx", "gy", "gz"];

/// Names of columns of accelerations.
pub(crate) const ACCELERATIONS: &[&str] =
    &["acceleration", "accel", "acc", "accelerometer", "ax", "ay", "az"];

/// Names of columns of torques and forces, which are inputs.
pub(crate) const TORQUES: &[&str] = &["torque", "tau", "force", "moment", "effort", "kraft", "drehmoment"];

/// Names of columns of other inputs, most reliable first.
pub(crate) const INPUTS: &[&str] = &[
    "command",
    "cmd",
    "u",
    "input",
    "voltage",
    "setpoint",
    "target",
    "action",
    "desired",
    "des",
    "soll",
    "sollwert",
    "current",
    "drive",
    "excitation",
    "exciter",
    "shaker",
];

/// Names of columns that number the samples.
pub(crate) const COUNTERS: &[&str] = &[
    "frame", "sample", "index", "idx", "row", "n", "no", "nr", "number", "counter", "seq", "sequence",
    "bild", "image",
];

/// Words in the names of lengths, for columns without a unit.
pub(crate) const LENGTHS: &[&str] = &["displacement", "deflection", "travel", "weg", "auslenkung"];

/// Words in the names of signals of sensors, which are voltages if they state no unit.
pub(crate) const SIGNALS: &[&str] =
    &["ampl", "amplitude", "channel", "ch", "ch1", "ch2", "ch3", "ch4", "signal", "spannung"];

/// Words for the length of a vector whose components are columns too.
pub(crate) const OF_VECTORS: &[&str] = &["absolute", "abs", "magnitude", "norm", "betrag", "total"];
