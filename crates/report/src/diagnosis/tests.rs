//! Tests of the page's verdicts, shares and series.

use results::{BudgetShares, DiagnosisResult, SeriesRow};
use serde_json::{Value, json};

use crate::{RunTexts, render, render_run};

/// Returns a made-up small diagnosis without any of the optional parts.
pub(crate) fn small() -> Value {
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

/// Returns the diagnosis with classes: friction of an undetermined kind, a possible restoring force, and a
/// sensor's steps.
fn classed() -> Value {
    let class = |id: &str, probability: f64, kinds: Value, is_told: bool| {
        json!({ "id": id, "probability": probability, "gap_share": null, "kinds": kinds, "kind_is_told": is_told,
                "error_without": 0.0021, "error_with": 0.0011, "stability": 0.96,
                "evidence": { "replacement": 12.0, "half_swings": null } })
    };
    let torque = json!({ "torque": { "value": 2.0, "unit": "N m", "interval_95": [1.9, 2.1] } });
    let effect = |id: &str, title: &str, probability: f64, parameters: Value| json!({ "id": id, "title": title, "probability": probability, "gap_share": null, "parameters": parameters });
    let mut result = small();
    let mut friction = class(
        "friction",
        0.95,
        json!([{ "id": "coulomb_friction", "share": 0.7 }, { "id": "hysteresis", "share": 0.3 }]),
        false,
    );
    friction["gap_share"] = json!({ "value": 0.62, "interval_95": [0.58, 0.66] });
    let mut sensor = class("sensor", 0.99, json!([{ "id": "sensor_quantization", "share": 1.0 }]), true);
    sensor["error_with"] = Value::Null;
    result["classes"] = json!([
        sensor,
        friction,
        class("restoring", 0.6, json!([{ "id": "gravity", "share": 1.0 }]), true),
        class("forcing", 0.2, json!([{ "id": "periodic_forcing", "share": 1.0 }]), true),
        class("play", 0.03, json!([{ "id": "end_stop", "share": 1.0 }]), true)
    ]);
    result["effects"] = json!([
        effect("sensor_quantization", "Sensor quantization", 0.99, json!({})),
        effect("coulomb_friction", "Coulomb friction", 0.7, torque.clone()),
        effect("gravity", "Gravity", 0.6, torque)
    ]);
    result["verdict"]["effects"] = json!(["coulomb_friction", "gravity", "sensor_quantization"]);
    result["measuring_chain"]["findings"] =
        json!([{ "effect": "sensor_quantization", "text": "the values lie on steps" }]);
    result["gap"]["closure"] = json!({ "value": 0.9, "interval_95": [0.88, 0.92] });
    result["left_over"] = json!({ "share_of_gap": 0.1, "over_noise": 1.5 });
    result
}

fn read(result: &Value) -> DiagnosisResult {
    serde_json::from_value(result.clone()).unwrap()
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
    reader: crate::Reader::CommandLine,
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
        "These data cannot distinguish gravity and cubic stiffness",
        "50.0\u{a0}% of their samples were used",
        "held: these data do not determine it",
        "not finite",
        "no quantization steps found",
    ] {
        assert!(html.contains(part), "{part}");
    }
    assert!(!crate::scripts::stripped(&html).contains("NaN"));
}

/// Rivals without a row of their own keep the capital letter of a person's name.
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

/// Samples are missing from 5 to 9 s: no line crosses the gap in any plot over time.
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

/// The second cell of the map holds no sample, and the fourth begins beyond the end of the third.
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
        ("unknown", "no known effect explains the gap"),
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
fn a_status_that_there_is_not_is_refused_with_those_that_there_are() {
    let mut result = small();
    result["verdict"]["status"] = json!("asleep");
    let refused = render(&RunTexts { result: &result.to_string(), ..EMPTY }).unwrap_err().to_string();
    assert!(refused.contains("unknown variant `asleep`, expected one of `none`, `calibration`"), "{refused}");
}

/// Regression: the plots ended where the swing does, and nothing stated that the record goes on.
#[test]
fn a_still_end_that_no_plot_shows_is_told() {
    let rows: Vec<SeriesRow> = (0..50).map(|index| row(1, 1, 0.1 * f64::from(index), 0.2)).collect();
    let of = |duration: f64, used: f64| {
        let mut result = small();
        result["samples_used"] = json!(used);
        result["records"] = json!([{ "path": "a.csv", "digest": "", "origin": "unstated", "samples": 50,
            "duration_s": duration, "clock": "host", "clock_reason": "", "findings": [] }]);
        crate::format::plain_spaces(&page(&result, &table(&rows)))
    };
    let still = "Not shown and not fitted: the last 15.1 s, in which nothing moves visibly.";
    assert!(of(20.0, 1.0).contains(still));
    assert!(of(20.0, 0.5).contains("Not shown and not fitted: the last 15.1 s."));
    assert!(!of(4.9, 1.0).contains("Not shown"));
}

#[test]
fn what_comes_from_files_is_escaped() {
    const EVIL: &str = "<script>alert(1)</script>\"'&$x$";
    let text = small().to_string();
    // All texts of the result except the schema and those that hold numbers.
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
    // Writing the parsed diagnosis again gives the same value.
    assert_eq!(serde_json::to_value(read(&classed())).unwrap(), classed());
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

#[test]
fn the_verdict_tells_what_is_certain_likely_and_open_and_how_much_has_no_name() {
    let text = crate::verdict_sentence(&read(&classed()));
    for part in [
        "The simulator certainly lacks dry friction (Coulomb or hysteresis: these data do not determine \
         which), and likely a nonlinear restoring force (gravity); the record shows sensor quantization, \
         which the simulator lacks; periodic forcing remains open.",
        "; named effects leave 10.0 % of the gap unexplained.",
    ] {
        assert!(text.contains(part), "no `{part}` in {text}");
    }
    assert!(!text.contains('\u{a0}') && !text.contains("end stop"), "{text}");
    // A class without evidence is not open, although it keeps the probability that any system has it.
    let mut result = read(&classed());
    for class in &mut result.classes {
        class.evidence.replacement = class.evidence.replacement.min(0.0);
        class.evidence.half_swings = None;
    }
    assert!(!crate::verdict_sentence(&result).contains("open"));
    assert!(crate::classes::unlikely_classes(&result).unwrap().contains("periodic forcing"));
}

#[test]
fn each_class_tells_its_kind_its_size_and_the_error_without_it() {
    let result = read(&classed());
    let statements = crate::class_statements(&result);
    let told: Vec<String> = statements
        .iter()
        .map(|one| {
            format!("{} {}: {}", one.standing.word(), one.title, crate::format::plain_spaces(&one.sentence))
        })
        .collect();
    assert_eq!(
        told,
        [
            "certain dry friction: These data do not determine the kind (Coulomb or hysteresis); Coulomb: \
             torque 2.000 N m [1.900, 2.100]; 62.0 % [58.0 %, 66.0 %] of the closed gap; error 0.00210 rad \
             without it, 0.00110 rad with it.",
            "certain distortion by the sensor: Quantization, which the record shows without a fit.",
            "likely nonlinear restoring force: Gravity: torque 2.000 N m [1.900, 2.100]; error 0.00210 rad without it, 0.00110 \
             rad with it.",
            "open periodic forcing: Error 0.00210 rad without it, 0.00110 rad with it.",
        ]
    );
}

#[test]
fn the_first_screen_shows_classes_as_bars_and_no_confidence_of_the_exact_set() {
    let html = page(&classed(), "");
    let (first, rest) = html.split_once("<main>").unwrap();
    for part in [
        "<strong>Certain</strong>",
        "<strong>Likely</strong>",
        "<strong>Open</strong>",
        "<strong>Unexplained</strong>",
        "Dry friction",
        "width: 95.0%",
        "width: 62.0%",
        "width: 10.0%",
        "Stability 96.0",
        "play or stops 0.030",
    ] {
        assert!(first.contains(part), "no `{part}` in {first}");
    }
    assert!(!first.contains("Probability of"), "{first}");
    assert!(rest.contains("Probability of exactly this set of effects"));
}

#[test]
fn a_file_of_an_older_version_has_no_classes_and_is_shown() {
    let html = page(&small(), "");
    assert!(html.contains("The simulator lacks gravity.") && !html.contains("class=\"classes\""));
}

#[test]
fn a_calibration_of_no_size_is_none() {
    let mut result = small();
    result["verdict"]["status"] = json!("calibration");
    result["verdict"]["effects"] = json!([]);
    result["gap"]["nominal"] = json!(0.0201);
    result["gap"]["recalibrated"] = json!(0.02);
    assert!(crate::is_calibrated_already(&read(&result)));
    assert!(page(&result, "").contains("<p class=\"label\">Nothing is missing</p>"));
    result["gap"]["nominal"] = json!(0.03);
    assert!(!crate::is_calibrated_already(&read(&result)));
    assert!(page(&result, "").contains("<p class=\"label\">Only calibration</p>"));
}

#[test]
fn errors_that_are_about_the_same_have_no_bars_on_a_logarithmic_scale() {
    let mut result = small();
    assert!(page(&result, "").contains("On a logarithmic scale"));
    for (key, error) in [("nominal", 0.00102), ("recalibrated", 0.00101), ("repaired", 0.001)] {
        result["gap"][key] = json!(error);
    }
    assert!(!page(&result, "").contains("On a logarithmic scale"));
}

#[test]
fn a_report_in_the_page_speaks_of_what_the_page_can_do() {
    let mut result = small();
    result["verdict"]["summary"] = "Are the stamps in ms? Set --time-unit ms".into();
    let text = result.to_string();
    let texts = RunTexts { result: &text, ..EMPTY };
    let page = render(&RunTexts { reader: crate::Reader::Page, ..texts }).unwrap();
    assert!(page.contains("Set “time unit” ms"));
    assert!(!page.contains("trainer simulate"));
    let beside_the_command_line = render(&texts).unwrap();
    assert!(beside_the_command_line.contains("Set --time-unit ms"));
    assert!(beside_the_command_line.contains("trainer simulate repaired.toml"));
}
