//! Classes of effects that explain alike.

/// Effects that explain alike, by class; and ids of classes themselves.
pub(super) const CLASSES: [(&str, &[&str]); 11] = [
    ("friction", &["coulomb_friction", "stribeck_friction", "hysteresis"]),
    ("restoring", &["cubic_stiffness", "asymmetric_stiffness", "gravity"]),
    ("damping", &["quadratic_drag", "damping_drift"]),
    ("play", &["backlash", "end_stop"]),
    ("drift", &["stiffness_drift", "clock_drift"]),
    ("second_body", &["flexible_coupling"]),
    ("forcing", &["periodic_forcing"]),
    ("preload", &["constant_torque"]),
    ("actuator", &["input_delay", "input_saturation"]),
    (
        "sensor",
        &[
            "sensor_quantization",
            "sensor_saturation",
            "sensor_lag",
            "sensor_nonlinearity",
            "sensor_drift",
            "outliers",
        ],
    ),
    ("stamps", &["timestamp_batching", "timestamp_jitter", "dropouts"]),
];

/// The class of an effect; of an id that is none, that id.
pub(crate) fn class_of(id: &str) -> &str {
    CLASSES.iter().find(|(_, effects)| effects.contains(&id)).map_or(id, |(class, _)| class)
}
