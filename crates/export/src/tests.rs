//! Tests of the texts for people.

use crate::{Repaired, configuration, equation_latex, equation_text, files, python, urdf};
use dynamics::chain::Observed;
use dynamics::{Active, Coefficients, Coordinate, Hold, Nominal, Start, System};

fn repaired(nominal: Nominal, effects: &[(&str, &[f64])]) -> Repaired {
    let active = effects.iter().map(|(id, values)| Active::new(id, values).unwrap()).collect();
    Repaired {
        system: System::new(nominal, active).unwrap(),
        units: nominal.units(),
        chain: Vec::new(),
        left_out: Vec::new(),
        input: None,
        start: Start::release(0.5),
        hidden_starts: Vec::new(),
        observed: Observed::Position,
        noise: 1e-3,
        rate_hz: 260.0,
        seconds: 25.0,
    }
}

fn pendulum() -> Nominal {
    Nominal::new(5e-4, 1.9e-4, 0.238, 0.02).unwrap()
}

#[test]
fn an_equation_lists_its_terms_and_every_number_with_its_unit() {
    let text =
        equation_text(&repaired(pendulum(), &[("coulomb_friction", &[7e-5]), ("gravity", &[0.1, 1.5])]));
    for line in [
        "I θ″ + c θ′ + k (θ - θ_rest) = the sum of the terms below",
        "  Coulomb friction: -τ_c sign(θ′); at rest, the torque up to τ_c that holds the body",
        "  Gravity: -m g l sin(θ + φ)",
        "  I = 5.000000e-4 kg m^2",
        "  τ_c = 7.000000e-5 N m (Coulomb friction)",
        "  φ = 1.500000e0 rad (Gravity)",
    ] {
        assert!(text.lines().any(|found| found == line), "no `{line}` in\n{text}");
    }
    assert!(equation_text(&repaired(pendulum(), &[])).starts_with("I θ″ + c θ′ + k (θ - θ_rest) = 0\n"));
}

#[test]
fn a_drive_without_a_spring_has_no_spring_in_its_equation() {
    let nominal = Nominal::from_coefficients(Coefficients {
        inertia: 95.0,
        damping: 203.0,
        stiffness: 0.0,
        rest_angle: 0.0,
        input_gain: 35.0,
    })
    .unwrap()
    .with_coordinate(Coordinate::Displacement);
    let drive = Repaired { input: Some(Hold::Linear), ..repaired(nominal, &[]) };
    let text = equation_text(&drive);
    assert!(text.starts_with("I θ″ + c θ′ = the term below\n  input: g u(t)\n"), "{text}");
    assert!(text.contains("I = 9.500000e1 kg\n") && text.contains("θ is the displacement"), "{text}");
    let file = configuration(&drive);
    assert!(file.contains("coordinate = \"displacement\""));
    assert!(file.contains(
        "trainer simulate repaired.toml input.waveform=sine input.amplitude=1 input.frequency_hz=1.000\n"
    ));
    assert!(python(&drive).contains("drive = input_gain * u(time)"));
}

#[test]
fn what_is_per_inertia_stays_so_when_calibration_moves_the_inertia() {
    let given = Nominal::new(1.0, 0.3, 484.0, 0.0).unwrap();
    let moved = Nominal::new(1.002, 0.3, 484.0, 0.0).unwrap();
    let repaired = Repaired { units: given.units(), ..repaired(moved, &[("coulomb_friction", &[2.0])]) };
    assert!(equation_text(&repaired).contains("τ_c = 2.000000e0 rad/s^2"));
    assert!(configuration(&repaired).contains("# rad/s^2"));
}

#[test]
fn latex_has_symbols_numbers_and_units() {
    let text = equation_latex(&repaired(pendulum(), &[("coulomb_friction", &[7e-5])]));
    for part in [
        r"I\ddot\theta+c\dot\theta+k(\theta-\theta_\mathrm{rest}) ={}& -\tau_c\,\operatorname{sign}\dot\theta",
        r"\item $\tau_{c} = 7.00000\times10^{-5}$ N\,m (Coulomb friction)",
        r"\item $I = 5.00000\times10^{-4}$ kg\,m$^2$",
    ] {
        assert!(text.contains(part), "no `{part}` in\n{text}");
    }
    assert_eq!(text.matches('{').count(), text.matches('}').count());
}

#[test]
fn nothing_that_was_left_out_breaks_a_comment_or_a_string() {
    let mut repaired = repaired(pendulum(), &[]);
    repaired.left_out = vec!["one \"quoted\"\nand */ --> broken".to_owned()];
    for (name, text) in files(&repaired) {
        assert!(text.contains("broken"), "{name}");
        if name.starts_with("equation") {
            continue;
        }
        let line = text.lines().find(|line| line.contains("broken")).unwrap().trim_start();
        let commented = ["#", "//", "<!--"].iter().any(|start| line.starts_with(start));
        assert!(commented || (name.ends_with(".py") && !line.contains('"')), "{name}: {line}");
    }
}

#[test]
fn an_equation_says_in_a_sentence_what_is_not_part_of_it() {
    let whole = repaired(pendulum(), &[]);
    assert!(!equation_text(&whole).contains("Not part of it"));
    assert!(!equation_latex(&whole).contains("Not part of it"));
    let part = Repaired {
        left_out: vec!["input delay: 50 % of\nspeed_max".to_owned(), "every effect".to_owned()],
        ..whole
    };
    let text = equation_text(&part);
    assert!(
        text.ends_with(
            "\n\nNot part of it: input delay: 50 % of speed_max.\n\nNot part of it: every effect.\n"
        ),
        "{text}"
    );
    let latex = equation_latex(&part);
    let item = r"  \item Not part of it: input delay: 50 \% of speed\_max.";
    assert!(latex.lines().any(|line| line == item), "{latex}");
    assert!(latex.ends_with("  \\item Not part of it: every effect.\n\\end{itemize}\n"), "{latex}");
}

/// Covers every special character of LaTeX and its printed form.
#[test]
fn words_stay_words_in_latex() {
    let mut all = repaired(pendulum(), &[]);
    all.left_out = vec![r"a\b{c}$d&e#f^g_h~i%j".to_owned()];
    let latex = equation_latex(&all);
    let item = r"a\textbackslash{}b\{c\}\$d\&e\#f\textasciicircum{}g\_h\textasciitilde{}i\%j";
    assert!(latex.contains(item), "{latex}");
}

/// urdfdom accepts a prismatic joint only with limits, and omitted bounds are 0, so that nothing could move.
#[test]
fn a_joint_that_slides_has_limits_and_one_that_turns_has_none() {
    let turning = repaired(pendulum(), &[]);
    let text = urdf(&turning);
    assert!(text.contains("type=\"continuous\"") && !text.contains("<limit"), "{text}");
    let nominal = pendulum().with_coordinate(Coordinate::Displacement);
    let text = urdf(&Repaired { system: System::new(nominal, vec![]).unwrap(), ..turning });
    assert!(text.contains("type=\"prismatic\""), "{text}");
    let line = text.lines().find(|line| line.contains("<limit")).unwrap();
    let value = |name: &str| -> f64 {
        let (_, rest) = line.split_once(&format!(" {name}=\"")).unwrap();
        rest.split_once('"').unwrap().0.parse().unwrap()
    };
    assert!(value("lower") < -1e6 && value("upper") > 1e6, "{line}");
    assert!(value("effort") > 1e6 && value("velocity") > 1e6, "{line}");
    let says = "the limits bound nothing: URDF asks for some where a joint slides";
    assert!(text.to_lowercase().contains(&says.to_lowercase()), "{text}");
}
