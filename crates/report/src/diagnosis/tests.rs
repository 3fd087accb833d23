//! Of the page's verdicts, shares and series.

use runs::result::{BudgetShares, DiagnosisResult, SeriesRow};
use serde_json::{Value, json};

use crate::{RunTexts, render, render_run};

/// A diagnosis as it might have been: small, and with everything that may be absent absent.
fn small() -> Value {
    let estimate = json!({ "value": 0.5, "interval_95": [0.25, null] });
    let cell = json!({ "bounds": [[0.0, 1.0]], "value": 0.02, "repaired": 0.001, "band": 0.003,
                       "significant": true, "samples": 100 });
    let coefficient = json!({ "nominal": 0.3, "unit": "1/s", "recalibrated": null, "repaired": estimate });
    json!({
        "schema": "ringdown.diagnosis/1",
        "verdict": { "status": "effect", "effects": ["gravity"], "confidence": 0.9,
                     "equivalent": [["gravity", "cubic_stiffness"]], "summary": "The simulator lacks gravity." },
        "effects": [{ "id": "gravity", "title": "Gravity", "probability": 0.9, "gap_share": estimate,
                      "parameters": { "torque": { "value": 1.0, "unit": "N m", "interval_95": [0.9, 1.1] } } }],
        "gap": { "unit": "rad", "nominal": 0.1, "recalibrated": 0.02, "repaired": 0.001, "ceiling": 0.001,
                 "noise_floor": 0.001, "noise_floor_interval_95": [0.0009, 0.0011], "closure": estimate,
                 "closure_of_recalibrated": estimate, "ratio_to_floor": null,
                 "ratio_to_floor_interval_95": [null, null], "last_third": [null, null], "held_out": "segments" },
        "where": { "budget": { "dissipative": 0.0, "conservative": 1.0, "time_dependent": 0.0, "sensor": 0.0,
                               "clock": 0.0 },
                   "time": [cell], "amplitude": [], "phase": [], "frequency": [] },
        "measuring_chain": { "clock": "host", "clock_reason": "", "sample_rate_hz": 260.0, "resolution": null,
                             "noise": 0.001, "findings": [] },
        "calibration": { "inertia": coefficient, "damping": coefficient, "stiffness": coefficient,
                         "rest_angle": coefficient },
        "next_experiment": { "text": "release farther out", "separates": [], "distance": null, "considered": [] },
        "seconds": 1.0, "stages": [], "records": [], "nominal": "nominal.toml", "seed": 0,
        "quantity": "position", "samples_used": 0.5, "rivals": [], "detectability": [], "sets": [],
        "rejected": [], "equation": { "text": "θ″ = 0", "latex": "" }, "units": ["rad", "rad/s", "N m"],
        "backbone": { "measured": [], "nominal": [], "repaired": [] }, "surface": []
    })
}

const EMPTY: RunTexts<'static> = RunTexts {
    name: "a case",
    config: "",
    result: "",
    trace: "",
    envelope: "",
    predictions: "",
    series: "",
    environment: "",
};

fn page(result: &Value, series: &str) -> String {
    crate::glossary::unexplained(&render(&RunTexts { result: &result.to_string(), series, ..EMPTY }).unwrap())
}

fn row(record: usize, segment: usize, time_s: f64, off: f64) -> SeriesRow {
    SeriesRow {
        record,
        segment,
        time_s,
        observed: time_s.sin() + off,
        nominal: 0.0,
        recalibrated: time_s.sin(),
        repaired: time_s.sin() + off,
        input_torque: None,
    }
}

fn table(rows: &[SeriesRow]) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row).unwrap();
    }
    String::from_utf8(writer.into_inner().unwrap()).unwrap()
}

#[test]
fn what_is_absent_is_said_and_breaks_nothing() {
    let html = page(&small(), "");
    for part in [
        "There is no series.csv",
        "No backbone curves",
        "These data cannot tell gravity and cubic stiffness apart",
        "50.0\u{a0}% of their samples were used",
        "held: these data cannot tell it",
        "not finite",
        "the values lie on no lattice",
    ] {
        assert!(html.contains(part), "{part}");
    }
    assert!(!crate::scripts::stripped(&html).contains("NaN"));
}

/// Rivals without a row of their own keep the capital of a person's name.
#[test]
fn names_of_persons_keep_their_capital() {
    let mut result = small();
    result["rivals"] = json!([{ "effect": "gravity", "rival": "coulomb_friction", "distance": 3.0 },
                              { "effect": "gravity", "rival": "end_stop", "distance": 4.0 }]);
    let html = page(&result, "");
    assert!(html.contains("gravity and Coulomb friction: best fits 3.0 × noise apart"), "{html}");
    assert!(html.contains("gravity and end stop: best fits 4.0 × noise apart"));
}

#[test]
fn the_worst_stretch_is_the_one_farthest_off() {
    let rows: Vec<SeriesRow> = (0..300)
        .map(|index| {
            let segment = index / 100 + 1;
            row(1, segment, 0.1 * index as f64, if segment == 2 { 0.3 } else { 0.01 })
        })
        .collect();
    let html = page(&small(), &table(&rows));
    assert!(html.contains("The worst stretch: 10.0 to 19.9\u{a0}s"), "{}", html.len());
    assert_eq!(html, page(&small(), &table(&rows)), "equal bytes");
}

/// Samples are missing from 5 to 9 s: no line crosses the gap, in any plot over time.
#[test]
fn no_line_is_drawn_across_missing_samples() {
    let at = |index: usize| 0.1 * index as f64 + if index < 50 { 0.0 } else { 4.0 };
    let rows: Vec<SeriesRow> = (0..100).map(|index| row(1, 1, at(index), 0.1)).collect();
    let html = page(&small(), &table(&rows));
    for (id, lines) in [("record", 1), ("worst-stretch", 3), ("residuals", 2)] {
        let figure = html.split(&format!("<figure id=\"{id}\"")).nth(1).unwrap();
        let live = figure.split("class=\"live\">").nth(1).unwrap().split("</script>").next().unwrap();
        let live: Value = serde_json::from_str(live).unwrap();
        let breaks = |column: &Value| {
            column["deltas"].as_array().unwrap().iter().filter(|delta| delta.is_null()).count()
        };
        let columns =
            live["tables"].as_array().unwrap().iter().flat_map(|table| table["columns"].as_array().unwrap());
        assert!(columns.map(breaks).filter(|count| *count == 1).count() >= lines, "{id}: {live}");
    }
}

#[test]
fn the_input_is_plotted_where_there_is_one() {
    let mut rows: Vec<SeriesRow> = (0..100).map(|index| row(1, 1, 0.1 * f64::from(index), 0.1)).collect();
    assert!(!page(&small(), &table(&rows)).contains("<figure id=\"input\""));
    for row in &mut rows {
        row.input_torque = Some(row.time_s.cos());
    }
    let html = page(&small(), &table(&rows));
    assert!(html.contains("<figure id=\"input\"") && html.contains("torque of the input (N m)"));
}

/// A map whose second cell holds no sample, and whose fourth begins beyond the end of the third.
#[test]
fn no_line_is_drawn_across_empty_cells() {
    let cell = |from: f64, to: f64, samples: u64| {
        json!({ "bounds": [[from, to]], "value": 0.02, "repaired": 0.001, "band": 0.003, "significant": false,
                "samples": samples })
    };
    let mut result = small();
    result["where"]["time"] =
        json!([cell(0.0, 1.0, 9), cell(1.0, 2.0, 0), cell(2.0, 3.0, 9), cell(5.0, 6.0, 9)]);
    let html = page(&result, "");
    let figure = html.split("<figure id=\"gap-over-time\"").nth(1).unwrap();
    let svg = figure.split("</svg>").next().unwrap();
    assert_eq!(svg.matches(&format!("stroke=\"{}\"", crate::plot::Hue::Estimate.light())).count(), 3);
}

#[test]
fn every_status_has_its_words_and_a_rest_above_the_noise_its_caution() {
    let mut result = small();
    result["gap"]["ratio_to_floor_interval_95"] = json!([1.0, 1.2]);
    for (status, label) in [
        ("none", "Nothing is missing"),
        ("calibration", "Only calibration"),
        ("effect", "Missing effect"),
        ("unknown", "a gap without a name"),
        ("asleep", "not known to this report"),
    ] {
        result["verdict"]["status"] = json!(status);
        assert!(page(&result, "").contains(label), "{status}");
    }
    result["verdict"]["status"] = json!("effect");
    assert!(page(&result, "").contains("class=\"verdict good\""));
    result["gap"]["ratio_to_floor_interval_95"] = json!([5.0, 6.0]);
    assert!(page(&result, "").contains("class=\"verdict caution\""));
}

#[test]
fn what_comes_from_files_is_escaped() {
    const EVIL: &str = "<script>alert(1)</script>\"'&$x$";
    let text = small().to_string();
    // Every text of the result but what the schema and the numbers stand in.
    let evil = serde_json::to_string(EVIL).unwrap();
    let mut replaced = text;
    for words in [
        "\"rad\"",
        "\"rad/s\"",
        "\"segments\"",
        "\"release farther out\"",
        "\"Gravity\"",
        "\"θ″ = 0\"",
        "\"1/s\"",
    ] {
        assert!(replaced.contains(words), "{words}");
        replaced = replaced.replace(words, &evil);
    }
    let rows: Vec<SeriesRow> = (0..50).map(|index| row(1, 1, 0.1 * f64::from(index), 0.2)).collect();
    let html =
        render(&RunTexts { name: EVIL, config: EVIL, result: &replaced, series: &table(&rows), ..EMPTY })
            .unwrap();
    assert!(!crate::scripts::stripped(&html).contains("<script"));
}

#[test]
fn a_diagnosis_is_not_taken_for_an_estimation() {
    let text = small().to_string();
    let message = render_run(&RunTexts { result: &text, envelope: "x", ..EMPTY }).unwrap_err().to_string();
    assert!(!message.is_empty());
    let result: DiagnosisResult = serde_json::from_str(&text).unwrap();
    assert_eq!(serde_json::from_str::<Value>(&serde_json::to_string(&result).unwrap()).unwrap(), small());
}

#[test]
fn shares_that_round_to_zero_are_left_out() {
    let budget = BudgetShares {
        dissipative: 0.25,
        conservative: 0.7498,
        time_dependent: 2e-4,
        sensor: f64::NAN,
        clock: 0.0,
    };
    let shares = super::budget::shares(&budget);
    let names: Vec<&str> = shares.iter().map(|share| share.name).collect();
    assert_eq!(names, ["dissipative", "conservative"]);
    assert!(shares.iter().all(|share| share.labeled));
}
