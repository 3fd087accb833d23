//! Tests of the declarations, and of resolving documents into settings.

use crate::prediction::{KINDS, PREDICT_SECTIONS, fields_of};
use crate::schema::{COMPARE, SECTIONS, estimator_name_field};
use crate::{
    KNOWN_EFFECT, NOMINAL, Pipeline, ProblemSource, Single, Task, is_prediction, resolve, resolve_nominal,
    resolve_prediction,
};
use envelope::Envelope;
use estimator::{Entry, Estimate, Estimator, FitContext, FitError};
use record::ClockChoice;
use settings::{Default, Document, Field, Kind, SettingsError};
use std::collections::BTreeSet;

struct Nothing;

impl Estimator for Nothing {
    fn fit(&self, _: &Envelope, _: &FitContext<'_>) -> Result<Estimate, FitError> {
        panic!("configurations are checked here, nothing is fitted")
    }
}

const REGISTRY: &[Entry] = &[Entry {
    id: "mine",
    paper_number: None,
    title: "Mine",
    summary: "",
    tags: &[],
    citations: &[],
    fields: &[Field {
        key: "width",
        kind: Kind::Integer { min: 1, max: 9 },
        default: Default::Integer(3),
        unit: "",
        meaning: "A width.",
        source: "",
    }],
    build: |_| Ok(Box::new(Nothing)),
}];

const CLASSICAL: &[&str] = &["ols", "qr"];

fn document(text: &str) -> Document {
    Document::parse("a.toml", text).unwrap()
}

/// Returns every declared key with the name of its section.
fn declared() -> Vec<(String, Field)> {
    let sections = SECTIONS.iter().chain([&COMPARE]).chain(PREDICT_SECTIONS).chain([&NOMINAL, &KNOWN_EFFECT]);
    let fixed =
        sections.flat_map(|section| section.fields.iter().map(|field| (section.name.to_owned(), *field)));
    let problems = KINDS.iter().map(Some).chain([None]).flat_map(|kind| {
        let name = format!("problem, {}", kind.unwrap_or(&"any"));
        fields_of(kind.copied()).into_iter().map(move |field| (name.clone(), field))
    });
    fixed.chain(problems).chain([("estimator".to_owned(), estimator_name_field())]).collect()
}

#[test]
fn every_key_is_declared_whole() {
    for (section, field) in declared() {
        let place = format!("[{section}] {}", field.key);
        assert!(!field.key.is_empty(), "{section} has a key without a name: {}", field.meaning);
        assert!(field.meaning.ends_with('.') && field.meaning.len() > 8, "{place}: {}", field.meaning);
        let admitted = field.default.value().map(|value| field.kind.admit(&value));
        assert!(!matches!(admitted, Some(Err(_))), "{place}: its default is not admitted: {admitted:?}");
        // A key whose name ends in a unit declares the same unit.
        let endings = [
            ("_rad_s", "rad/s"),
            ("_s", "s"),
            ("_hz", "Hz"),
            ("_kg_m2", "kg m^2"),
            ("_percent", "%"),
            ("_periods", "periods"),
        ];
        if let Some((_, unit)) = endings.iter().find(|(ending, _)| field.key.ends_with(ending)) {
            assert_eq!(field.unit, *unit, "{place}");
        }
    }
}

#[test]
fn no_key_is_declared_twice() {
    for kind in KINDS {
        let keys: Vec<&str> = fields_of(Some(kind)).iter().map(|field| field.key).collect();
        assert_eq!(keys.iter().collect::<BTreeSet<_>>().len(), keys.len(), "{keys:?}");
    }
}

#[test]
fn a_silent_configuration_has_the_defaults_of_the_paper_and_ours() {
    let found = resolve(&document("[estimator]\nname = \"mine\"\n"), REGISTRY, CLASSICAL).unwrap();
    assert_eq!((found.name.as_str(), found.seed), ("mine", 0));
    assert!(matches!(&found.task, Task::Estimate(Single::Learned { entry, .. }) if entry.id == "mine"));
    assert_eq!(found.data.clock, ClockChoice::Auto);
    assert_eq!((found.fit.seeds, found.fit.max_steps), (1, None));
    assert!((found.fit.tolerance_percent - 0.1).abs() < 1e-15);
    assert_eq!((found.envelope.pipeline.name(), Pipeline::Paper.name()), ("auto", "paper"));
    let paper = &found.envelope.paper;
    assert_eq!((paper.smoothing_window, paper.smoothing_order, paper.peak_distance), (0, 3, 50));
    let numbers = [paper.interpolation_step_s, paper.late_fraction, paper.prominence];
    assert_eq!(numbers, [0.002, 0.2, 0.01]);
    let ours = &found.envelope.recommended;
    assert!((ours.half_width_periods * 6.0 - 1.0).abs() < 1e-15 && (ours.floor_in_noise - 8.0).abs() < 1e-15);
    assert_eq!(found.data.read_options(), record::ReadOptions::default());
}

#[test]
fn what_is_stated_of_a_record_arrives_where_it_is_read() {
    let text = "[data]\ntime = \"t\"\nunit = \"deg\"\nsample_rate_hz = 50\norigin = \"measured\"\nstated_samples = 7\n\
                [estimator]\nname = \"ols\"\n";
    let found = resolve(&document(text), REGISTRY, CLASSICAL).unwrap();
    let options = found.data.read_options();
    assert_eq!((options.columns.time.as_deref(), options.columns.sample_rate_hz), (Some("t"), Some(50.0)));
    assert_eq!(options.columns.unit, Some(record::Unit::Degree));
    let stated = found.data.statements();
    assert_eq!((stated.origin, stated.samples), (Some(record::Origin::Measured), Some(7)));
}

fn refused(text: &str) -> String {
    let document = document(text);
    let error = if is_prediction(&document) {
        resolve_prediction(&document, REGISTRY, CLASSICAL).map(|_| ())
    } else {
        resolve(&document, REGISTRY, CLASSICAL).map(|_| ())
    };
    error.unwrap_err().to_string()
}

/// One value outside each range or set of words.
#[test]
fn values_beyond_what_is_declared_are_refused() {
    for wrong in [
        "task = \"guess\"",
        "seed = -1",
        "name = 3",
        "[data]\nformat = \"xml\"",
        "[data]\nquantity = \"jerk\"",
        "[data]\nclock = \"sun\"",
        "[data]\nunit = \"furlong\"",
        "[data]\ntime_unit = \"moon\"",
        "[data]\nsample_rate_hz = 0",
        "[data]\norigin = \"heaven\"",
        "[data]\nstated_rate_hz = 0",
        "[data]\nstated_samples = 0",
        "[data]\npath = 3",
        "[data]\ntime = 3",
        "[data]\nangle = 3",
        "[data]\ninput = 3",
        "[envelope]\npipeline = \"none\"",
        "[envelope.paper]\ninterpolation_step_s = 0",
        "[envelope.paper]\nsmoothing_window = -1",
        "[envelope.paper]\nsmoothing_order = 21",
        "[envelope.paper]\nlate_fraction = 0",
        "[envelope.paper]\npeak_distance = 0",
        "[envelope.paper]\nprominence = -1",
        "[envelope.recommended]\nhalf_width_periods = 0.3",
        "[envelope.recommended]\nfloor_in_noise = -1",
        "[fit]\nseeds = 0",
        "[fit]\nmax_steps = -1",
        "[fit]\ntolerance_percent = -1",
    ] {
        let expected = if wrong.contains("[fit]\nmax_steps") { "fit.max_steps" } else { "; expected " };
        let message = refused(&format!("{wrong}\n[estimator]\nname = \"mine\"\n"));
        assert!(message.contains(expected) && message.contains("expected"), "{wrong}: {message}");
    }
    for wrong in ["methods = []", "inertia_kg_m2 = 0"] {
        let message = refused(&format!("task = \"compare\"\n[compare]\n{wrong}\n"));
        assert!(message.contains("; expected "), "{wrong}: {message}");
    }
    for wrong in [
        "methods = []",
        "problems = []",
        "draws = 0",
        "draws_seeded = 0",
        "block_peaks = 0",
        "every = 1",
        "last_share = 0.9",
        "significance = 0",
        "max_steps = -1",
    ] {
        let problem = "[problem.a]\nkind = \"exponential\"\ndecay_rate = 1\nscatter_size = 0.1\n";
        let message = refused(&format!("task = \"predict\"\n[predict]\n{wrong}\n{problem}"));
        assert!(message.contains("; expected "), "{wrong}: {message}");
    }
    for wrong in [
        "amplitude = 0",
        "period_s = 0",
        "peaks = 3",
        "decay_rate = -1",
        "scatter = \"none\"",
        "scatter_size = -1",
        "dead_zone = -1",
        "title = 3",
    ] {
        let message =
            refused(&format!("task = \"predict\"\n[problem.a]\nkind = \"coulomb-viscous\"\n{wrong}\n"));
        assert!(message.contains("; expected "), "{wrong}: {message}");
    }
    for (kind, wrong) in [("viscous-quadratic", "quadratic_rate = -1"), ("record", "pipeline = \"none\"")] {
        let message = refused(&format!("task = \"predict\"\n[problem.a]\nkind = \"{kind}\"\n{wrong}\n"));
        assert!(message.contains("; expected "), "{wrong}: {message}");
    }
}

#[test]
fn names_are_held_against_what_there_is() {
    let known = ["[estimator]\nname = \"min\"\n", "task = \"compare\"\n[compare]\nmethods = [\"min\"]\n"];
    for text in known {
        assert!(refused(text).contains("did you mean `mine`?"), "{}", refused(text));
    }
    let problem = "[problem.a]\nkind = \"exponential\"\ndecay_rate = 1\nscatter_size = 0.1\n";
    let predict = |keys: &str| format!("task = \"predict\"\n[predict]\n{keys}\n{problem}");
    assert!(refused(&predict("methods = [\"min\"]")).contains("did you mean `mine`?"));
    assert!(refused(&predict("problems = [\"b\"]")).contains("unknown problem \"b\""));
    assert!(refused("seed = 1\n").contains("`estimator.name` is missing"));
    let wide = "[estimator]\nname = \"ols\"\nwidth = 3\n";
    assert!(refused(wide).contains("unknown key `estimator.width`"), "{}", refused(wide));
}

#[test]
fn methods_of_a_comparison_may_be_classical_or_learned() {
    let text = "task = \"compare\"\n[compare]\nmethods = [\"qr\", \"mine\"]\n";
    let found = resolve(&document(text), REGISTRY, CLASSICAL).unwrap();
    let Task::Compare(comparison) = found.task else { panic!("a comparison") };
    assert_eq!(comparison.methods, Some(vec!["qr".to_owned(), "mine".to_owned()]));
    assert_eq!(comparison.inertia_kg_m2, None);
    assert_eq!(found.name, "compare");
}

#[test]
fn the_problems_of_a_study_have_the_keys_of_their_kind() {
    let text = "task = \"predict\"\n[predict]\nproblems = [\"dry\", \"file\"]\n\
                [problem.dry]\nkind = \"coulomb-viscous\"\ndecay_rate = 1\nscatter_size = 0.1\ndead_zone = 0.2\n\
                [problem.left]\nkind = \"exponential\"\ndecay_rate = 1\nscatter_size = 0.1\n\
                [problem.file]\nkind = \"record\"\npath = \"x.csv\"\npipeline = \"paper\"\ntitle = \"A file\"\n";
    let found = resolve_prediction(&document(text), REGISTRY, CLASSICAL).unwrap();
    let settings = &found.settings;
    assert_eq!((settings.draws, settings.draws_seeded), (200, 20));
    assert_eq!((settings.block_peaks, settings.every, settings.max_steps), (3, 4, None));
    assert!((settings.last_share * 3.0 - 1.0).abs() < 1e-15 && (settings.significance - 0.05).abs() < 1e-15);
    let [dry, file] = &found.problems[..] else { panic!("two problems") };
    assert_eq!((dry.title.as_str(), file.title.as_str()), ("dry", "A file"));
    let ProblemSource::Simulated(law) = &dry.source else { panic!("a law") };
    assert_eq!((law.amplitude, law.period_s, law.peaks, law.dead_zone), (0.5, 0.288, 72, 0.2));
    let ProblemSource::Record { data, pipeline } = &file.source else { panic!("a record") };
    assert_eq!((data.path.as_str(), *pipeline), ("x.csv", Pipeline::Paper));
    for (kind, missing) in [
        ("exponential", "decay_rate"),
        ("coulomb-viscous", "decay_rate"),
        ("viscous-quadratic", "decay_rate"),
        ("record", "path"),
    ] {
        let message = refused(&format!("task = \"predict\"\n[problem.a]\nkind = \"{kind}\"\n"));
        assert!(message.contains(&format!("`problem.a.{missing}` is missing")), "{message}");
    }
    let given = "decay_rate = 1\nscatter_size = 0.1\n";
    for (kind, missing) in [("coulomb-viscous", "dead_zone"), ("viscous-quadratic", "quadratic_rate")] {
        let message = refused(&format!("task = \"predict\"\n[problem.a]\nkind = \"{kind}\"\n{given}"));
        assert!(message.contains(&format!("`problem.a.{missing}` is missing")), "{message}");
    }
}

#[test]
fn a_nominal_simulator_is_read_with_what_it_may_leave_out() {
    let text = "inertia = 2\ndamping = 0.5\nstiffness = 8\nrest_angle = 0.1\n";
    let found = resolve_nominal(&document(text)).unwrap();
    assert!(!found.driven);
    let all = format!("{text}input_gain = 3\ncoordinate = \"displacement\"\nsensor_resolution = 1e-3\n");
    let driven = resolve_nominal(&document(&all)).unwrap();
    assert!(driven.driven);
    let same = |a: &dynamics::Nominal, b: &dynamics::Nominal| format!("{a:?}") == format!("{b:?}");
    assert!(!same(&found.nominal, &driven.nominal));
    for wrong in [
        "inertia = 0",
        "damping = -1",
        "stiffness = -1",
        "rest_angle = nan",
        "input_gain = inf",
        "coordinate = \"heat\"",
        "sensor_resolution = 0",
    ] {
        let key = wrong.split(' ').next().unwrap();
        let kept: String =
            all.lines().filter(|line| !line.starts_with(key)).map(|line| format!("{line}\n")).collect();
        let error = resolve_nominal(&document(&format!("{kept}{wrong}\n"))).unwrap_err();
        assert!(matches!(error, SettingsError::BadValue { .. }), "{wrong}: {error}");
    }
    for key in ["inertia", "damping", "stiffness"] {
        let kept: String =
            text.lines().filter(|line| !line.starts_with(key)).map(|line| format!("{line}\n")).collect();
        let message = resolve_nominal(&document(&kept)).unwrap_err().to_string();
        assert!(message.contains(&format!("`{key}` is missing")), "{message}");
    }
}

/// A servo's inner loop, whose numbers may be known, known within a tolerance, or unknown.
#[test]
fn an_actuator_is_read_with_what_it_leaves_open() {
    let of = |text: &str| resolve_nominal(&document(&format!("inertia = 0.02\n[actuator]\n{text}")));
    let servo = "kind = \"position\"\nproportional = { value = 3.0, tolerance = 1.0 }\nderivative = 0.12\n\
                 derivative_on = \"error\"\ndelay = \"unknown\"\ngear_ratio = 10\nrotor_inertia = 1e-4\n";
    let stated = of(servo).unwrap();
    let own = stated.nominal.coefficients();
    assert_eq!([own.stiffness, own.damping, own.input_gain, own.rest_angle], [3.0, 0.12, 3.0, 0.0]);
    assert!((own.inertia - 0.03).abs() < 1e-15 && stated.driven);
    let effects: Vec<(&str, bool)> =
        stated.simulator.effects().iter().map(|own| (own.active.id(), own.recalibrate)).collect();
    assert_eq!(effects, [("command_derivative", true), ("input_delay", true)]);
    let unknown = of("kind = \"position\"\nproportional = \"unknown\"\nderivative = \"unknown\"\n").unwrap();
    assert!(!unknown.driven, "the records have to tell the gain first");
    let told = unknown.driven_by(5.0).unwrap();
    assert!(told.driven && told.nominal.stiffness() == 5.0 && told.nominal.input_gain() == 5.0);
    let limited =
        of("kind = \"velocity\"\nderivative = 0.5\ntorque_limit = 2.0\ndead_band = 0.01\n").unwrap();
    assert_eq!(limited.simulator.effects().len(), 2);
    for (wrong, what) in [
        ("kind = \"position\"\nderivative = 0.1\n", "`actuator.proportional` is missing"),
        ("kind = \"heat\"\n", "kind"),
        ("kind = \"position\"\nproportional = -3\nderivative = 0.1\n", "proportional"),
        ("kind = \"position\"\nproportional = 3\nderivative = \"about 2\"\n", "unknown"),
        ("kind = \"velocity\"\nderivative = 1\nproportional = 3\n", "leave it out"),
        ("kind = \"torque\"\nintegral = 2\n", "integral"),
        ("kind = \"position\"\nproportional = { value = 3 }\nderivative = 0.1\n", "tolerance"),
    ] {
        let message = of(wrong).unwrap_err().to_string();
        assert!(message.contains(what), "{message}");
    }
}

#[test]
fn stiffness_and_damping_may_be_a_frequency_and_a_ratio() {
    let of = |text: &str| resolve_nominal(&document(text)).unwrap().nominal;
    let rate = std::f64::consts::TAU * 3.5;
    for swing in [
        "natural_frequency = 3.5".to_owned(),
        format!("natural_frequency_rad_s = {rate}"),
        format!("period = {}", 1.0 / 3.5),
    ] {
        let found = of(&format!("{swing}\ndamping_ratio = 0.01\n"));
        assert_eq!((found.inertia(), found.rest_angle()), (1.0, 0.0));
        assert!((found.stiffness() / (rate * rate) - 1.0).abs() < 1e-14, "{found:?}");
        assert!((found.damping() / (0.02 * rate) - 1.0).abs() < 1e-14, "{found:?}");
    }
    let heavy = of("inertia = 2\nnatural_frequency = 3.5\ndamping = 0.1\nrest_angle = 0.2\n");
    assert!((heavy.stiffness() / (2.0 * rate * rate) - 1.0).abs() < 1e-14);
    assert_eq!((heavy.damping(), heavy.rest_angle()), (0.1, 0.2));
    let stiff = of("inertia = 2\nstiffness = 8\ndamping_ratio = 0.5\nrest_angle = 0\n");
    assert_eq!(stiff.damping(), 4.0);
    for (text, said) in [
        ("damping = 0.1\n", "`stiffness` is missing"),
        ("natural_frequency = 3.5\n", "`damping` is missing"),
        ("stiffness = 8\ndamping_ratio = 0.1\nrest_angle = 0\n", "`inertia` is missing"),
        (
            "period = 2\nstiffness = 8\ndamping = 0\n",
            "a.toml:1:1: `period` is 2; expected one of stiffness, natural_frequency, natural_frequency_rad_s, period, and `stiffness` is stated already",
        ),
        (
            "period = 2\ndamping = 0\ndamping_ratio = 0\n",
            "a.toml:3:1: `damping_ratio` is 0; expected one of damping, damping_ratio, and `damping` is stated already",
        ),
        (
            "inertia = 1\nstiffness = 0\ndamping_ratio = 0.1\nrest_angle = 0\n",
            "a.toml:3:1: `damping_ratio` is 0.1; expected damping in its place",
        ),
        ("natural_frequenzy = 3.5\n", "did you mean `natural_frequency`"),
    ] {
        let message = resolve_nominal(&document(text)).unwrap_err().to_string();
        assert!(message.contains(said), "{message}");
    }
}

#[test]
fn a_nominal_simulator_has_effects_as_a_simulation_has() {
    let effect = "[[effects]]\nid = \"gravity\"\nparameters.torque = 5\nparameters.angle = 0.1\n";
    let oscillator = "inertia = 2\ndamping = 0.5\nstiffness = 8\nrest_angle = 0.1\n";
    let held = effect.replace("id", "recalibrate = false\nid");
    let unnamed = "[[effects]]\nid = \"unknown\"\nparameters = { torque = 1, wavenumber = 9, phase = 0 }\n";
    let found = resolve_nominal(&document(&format!("{oscillator}{effect}{unnamed}"))).unwrap();
    let ids: Vec<&str> = found.simulator.effects().iter().map(|known| known.active.id()).collect();
    assert_eq!(ids, ["gravity", "unknown"]);
    assert!(found.simulator.effects().iter().all(|known| known.recalibrate));
    assert_eq!(found.simulator.effects()[0].active.values(), [5.0, 0.1]);
    let found = resolve_nominal(&document(&format!("{oscillator}{held}"))).unwrap();
    assert!(!found.simulator.effects()[0].recalibrate);
    // A file as a repaired simulator has it: the oscillator in a table, and further tables about the records.
    let records = "task = \"simulate\"\nname = \"repaired\"\nseed = 0\n[record]\nrate_hz = 260.0\n[start]\nposition = 0.7\n[sensor]\nobserves = \"position\"\nnoise = 1e-3\n";
    let whole = format!("{records}[nominal]\n{oscillator}input_gain = 1.0\n{effect}");
    let repaired = resolve_nominal(&document(&whole)).unwrap();
    assert_eq!(repaired.nominal.inertia(), 2.0);
    assert_eq!(repaired.simulator.effects().len(), 1);
    assert!(!repaired.driven);
    assert!(resolve_nominal(&document(&format!("{whole}[input]\nwaveform = \"none\"\n"))).unwrap().driven);
    for (wrong, said) in [
        (effect.replace("gravity", "gravty"), "unknown effect \"gravty\"; did you mean `gravity`"),
        (
            effect.replace("torque", "torqe"),
            "a.toml:7:12: unknown key `effects.1.parameters.torqe`; did you mean `effects.1.parameters.torque`",
        ),
        (effect.replace("parameters.angle = 0.1", ""), "`effects.1.parameters.angle` is missing"),
        (effect.replace("torque = 5", "torque = -5"), "`effects.1.parameters.torque` is -5; expected"),
        (effect.replace("id = \"gravity\"", ""), "`effects.1.id` is missing"),
        (format!("{effect}{effect}"), "`effects.2.id` is gravity again; expected each effect once"),
        (effect.replace("id", "recalibrat = true\nid"), "did you mean `effects.1.recalibrate`"),
        (effect.replace("id", "probability = 0.5\nid"), "`effects.1.probability` is 0.5"),
        ("[recrd]\nrate_hz = 1\n".to_owned(), "unknown key `recrd.rate_hz`"),
    ] {
        let message = resolve_nominal(&document(&format!("{oscillator}{wrong}"))).unwrap_err().to_string();
        assert!(message.contains(said), "{message}");
    }
}

#[test]
fn schemas_close_what_is_declared() {
    for (schema, task) in [
        (crate::estimate_schema(REGISTRY, CLASSICAL), "estimate"),
        (crate::compare_schema(REGISTRY, CLASSICAL), "compare"),
        (crate::predict_schema(REGISTRY, CLASSICAL), "predict"),
    ] {
        assert_eq!(schema["properties"]["task"]["const"], task);
        assert_eq!(schema["additionalProperties"], false);
        assert!(schema["properties"]["base"].is_object());
    }
    let estimate = crate::estimate_schema(REGISTRY, CLASSICAL);
    let estimator = &estimate["properties"]["estimator"];
    assert_eq!(estimator["properties"]["name"]["enum"], serde_json::json!(["mine", "ols", "qr"]));
    assert_eq!(estimator["properties"]["width"]["maximum"], 9);
    assert_eq!(estimate["then"]["properties"]["estimator"]["required"], serde_json::json!(["name"]));
    let compare = crate::compare_schema(REGISTRY, CLASSICAL);
    let items = &compare["properties"]["compare"]["properties"]["methods"]["anyOf"][0]["items"];
    assert_eq!(items["enum"], serde_json::json!(["ols", "qr", "mine"]));
    assert_eq!(compare["then"]["required"], serde_json::json!(["task"]));
}
