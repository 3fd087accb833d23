use super::*;

fn place(position: f64, velocity: f64, input: f64) -> Place {
    Place { position, velocity, direction: if velocity < 0.0 { -1.0 } else { 1.0 }, input }
}

#[test]
fn a_text_means_what_it_says() {
    let at = place(0.3, -0.7, 2.0);
    for (text, expected) in [
        ("sin(2*theta)", 0.6_f64.sin()),
        ("theta_dot*|theta_dot|", -0.49),
        ("1 - 2 - 3", -4.0),
        ("-theta^2 + 8/4/2", 1.0 - 0.09),
        ("u*sign(theta_dot)", -2.0),
        ("1.5e-1*(theta + pi)", 0.15 * (0.3 + std::f64::consts::PI)),
        ("exp(-theta_dot^2)", (-0.49_f64).exp()),
    ] {
        let expression: Expression = text.parse().unwrap();
        assert!((expression.dual(&at)[0] - expected).abs() < 1e-12, "{text}: {expression}");
        let again: Expression = expression.to_string().parse().unwrap();
        assert!((again.dual(&at)[0] - expected).abs() < 1e-12, "{text}: {expression} read as {again}");
    }
}

#[test]
fn derivatives_are_those_of_differences() {
    let text =
        "tanh(theta*theta_dot) + sqrt(2 + theta)/(3 + theta_dot^3) - log(4 + theta)*|theta_dot|*cos(theta)";
    let expression: Expression = text.parse().unwrap();
    let (at, step) = (place(0.4, 0.6, 0.0), 1e-6);
    let [_, by_x, by_v] = expression.dual(&at);
    let difference = |x: f64, v: f64| {
        let value = |way: f64| expression.dual(&place(0.4 + way * x, 0.6 + way * v, 0.0))[0];
        (value(step) - value(-step)) / (2.0 * step)
    };
    assert!((by_x - difference(1.0, 0.0)).abs() < 1e-8 && (by_v - difference(0.0, 1.0)).abs() < 1e-8);
}

#[test]
fn a_wrong_text_is_refused_with_its_place() {
    for (text, words) in [
        ("theta +", "at character 8: expected a number"),
        ("sin theta", "at character 5: expected `(`"),
        ("2*(theta", "expected `)`"),
        ("theta^0.5", "expected a whole exponent"),
        ("omega*theta", "at character 1: `omega` is not known; there are theta, theta_dot, u, sin"),
        ("theta theta", "follows a whole expression"),
        ("", "expected a number"),
    ] {
        let error = text.parse::<Expression>().unwrap_err().to_string();
        assert!(error.contains(words), "{text}: {error}");
    }
    let deep = ("(".repeat(5000) + "1").parse::<Expression>().unwrap_err().to_string();
    assert!(deep.contains("nested deeper than"), "{deep}");
}

#[test]
fn what_follows_the_direction_is_known() {
    let directed = |text: &str| text.parse::<Expression>().unwrap().is_directed();
    assert!(directed("2*sign(theta_dot)") && directed("|theta_dot|*theta") && !directed("|theta|*theta_dot"));
}
