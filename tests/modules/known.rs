//! Known exceptions to the rules. The lists may only become shorter.

/// Crates with folders that need each other.
pub(super) const TANGLED: &[&str] = &["learn", "trainer", "trials"];

/// Functions of more than 60 lines, by crate, with the reason.
pub(super) const LONG: &[(&str, &str, &str)] = &[
    ("bayesian", "fit::by_sampling", "one run of the sampler from its start to its answer"),
    ("gaussian-process", "fit::train", "one loop over the steps of a training"),
    ("gaussian-process", "likelihood::slope", "one derivative in closed form, term by term"),
    ("neural", "amortized::training::train", "one loop over the steps of a training"),
    ("neural", "decay::fit", "one fit from its sequence to its estimate"),
    (
        "oracle",
        "classical::levenberg_marquardt::minimize",
        "one iteration of a published method, in its order",
    ),
    ("oracle", "classical::trust_region::minimize", "one iteration of a published method, in its order"),
    ("record", "clock::decide", "one question after another, each with its sentence"),
];
