//! Sample cases and answers for tests.

use super::AnsweredCase;
use crate::hidden::{Bank, Foreign, HIDDEN_SCHEMA, Hidden, HiddenEffect};
use results::DiagnosisResult;
use serde_json::json;

/// Builds an answer with a status, names and a confidence; the other values are arbitrary.
pub(crate) fn answered(status: &str, named: &[&str], confidence: f64) -> Result<DiagnosisResult, String> {
    let estimate = json!({ "value": 0.95, "interval_95": [0.9, 0.99] });
    let coefficient = json!({ "nominal": 0.3, "unit": "1/s", "recalibrated": null, "repaired": null });
    let unknown = if status == "unknown" { confidence } else { 0.01 };
    let mut effects: Vec<_> = named
        .iter()
        .map(|id| {
            json!({ "id": id, "title": id, "probability": confidence, "gap_share": null, "parameters": {} })
        })
        .collect();
    for (id, probability) in [("unknown", unknown), ("none", 0.01), ("calibration", 0.02)] {
        effects.push(
            json!({ "id": id, "title": id, "probability": probability, "gap_share": null, "parameters": {} }),
        );
    }
    let answer = json!({
        "schema": "ringdown.diagnosis/1",
        "verdict": { "status": status, "effects": named, "confidence": confidence, "equivalent": [],
                     "summary": "A sentence." },
        "effects": effects,
        "gap": { "unit": "rad", "nominal": 0.1, "recalibrated": 0.02, "repaired": 0.001, "ceiling": 0.001,
                 "noise_floor": 0.001, "noise_floor_interval_95": [0.0009, 0.0011], "closure": estimate,
                 "closure_of_recalibrated": estimate, "ratio_to_floor": 1.02,
                 "ratio_to_floor_interval_95": [1.0, 1.1], "last_third": [null, null], "held_out": "segments" },
        "where": { "budget": { "dissipative": 0.0, "conservative": 1.0, "time_dependent": 0.0, "sensor": 0.0,
                               "clock": 0.0 },
                   "time": [], "amplitude": [], "phase": [], "frequency": [] },
        "measuring_chain": { "clock": "host", "clock_reason": "", "sample_rate_hz": 260.0, "resolution": null,
                             "noise": 0.001, "findings": [] },
        "calibration": { "inertia": coefficient, "damping": coefficient, "stiffness": coefficient,
                         "rest_angle": coefficient },
        "next_experiment": { "text": "", "separates": [], "distance": null, "considered": [] },
        "seconds": 1.5, "stages": [], "records": [], "nominal": "nominal.toml", "seed": 0,
        "quantity": "position", "samples_used": 1.0, "rivals": [], "detectability": [], "sets": [],
        "rejected": [], "equation": { "text": "", "latex": "" }, "units": ["rad", "rad/s", "N m"],
        "backbone": { "measured": [], "nominal": [], "repaired": [] }, "surface": []
    });
    Ok(serde_json::from_value(answer).unwrap())
}

/// Builds a case with effects of size 25.
pub(crate) fn case(bank: Bank, hidden: &[&str], answer: Result<DiagnosisResult, String>) -> AnsweredCase {
    let effects = hidden
        .iter()
        .map(|id| HiddenEffect {
            id: (*id).to_owned(),
            parameters: Vec::new(),
            law: "vocabulary".to_owned(),
            detectability: 25.0,
            floors: None,
        })
        .collect();
    AnsweredCase {
        id: "case-000".to_owned(),
        hidden: Hidden {
            schema: HIDDEN_SCHEMA.to_owned(),
            bank,
            effects,
            foreign: (bank == Bank::Foreign)
                .then(|| Foreign { law: "a law of its own".to_owned(), detectability: 25.0 }),
            unlisted: Vec::new(),
            allowed: Vec::new(),
            nuisances: Vec::new(),
            miscalibrated: true,
            without: None,
            noise: 1e-3,
            records: Vec::new(),
            made: String::new(),
        },
        answer,
        error_of_the_truth: Err("no effect is hidden".to_owned()),
        true_closure: Err("the system cannot be said in the vocabulary".to_owned()),
        command: "trainer diagnose case-000".to_owned(),
    }
}
