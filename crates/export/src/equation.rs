//! Export of the equation of motion, for people.

use crate::Repaired;
use crate::configuration::one_line;
use dynamics::{Coordinate, Description};
use std::fmt::Write;

/// Symbols of the coordinate and its first two derivatives, as text and in LaTeX.
struct Letters {
    text: [&'static str; 3],
    latex: [&'static str; 3],
}

const LETTERS: Letters =
    Letters { text: ["θ", "θ′", "θ″"], latex: [r"\theta", r"\dot\theta", r"\ddot\theta"] };

/// Returns the coefficients of the left-hand side with their symbols, values and units.
fn coefficients(repaired: &Repaired) -> Vec<(&'static str, &'static str, f64, &'static str)> {
    use dynamics::Quantity::{Damping, Inertia, Position, Stiffness};
    let nominal = repaired.system.nominal();
    let all = [
        ("I", "I", nominal.inertia(), repaired.unit(Inertia)),
        ("c", "c", nominal.damping(), repaired.unit(Damping)),
        ("k", "k", nominal.stiffness(), repaired.unit(Stiffness)),
        ("θ_rest", r"\theta_\mathrm{rest}", nominal.rest_angle(), repaired.unit(Position)),
    ];
    let springless = nominal.stiffness() == 0.0;
    let shown = |index: usize| if index == 0 { nominal.inertia() != 1.0 } else { index == 1 || !springless };
    all.into_iter().enumerate().filter(|(index, _)| shown(*index)).map(|(_, row)| row).collect()
}

/// Writes the equation of motion as text, with θ as the coordinate. The numbers follow with their units, one
/// to a line, then the effects of the measurement chain and the parts of the diagnosis that the simulator
/// leaves out.
#[must_use]
pub fn equation_text(repaired: &Repaired) -> String {
    let [x, v, a] = LETTERS.text;
    let nominal = repaired.system.nominal();
    let mut left = if nominal.inertia() == 1.0 { format!("{a} + c {v}") } else { format!("I {a} + c {v}") };
    if nominal.stiffness() != 0.0 {
        let _ = write!(left, " + k ({x} - θ_rest)");
    }
    // The words of an effect say more than its term: one effect to a line, under its title.
    let mut terms: Vec<String> = Vec::new();
    if repaired.driven() {
        terms.push("input: g u(t)".to_owned());
    }
    terms.extend(repaired.system.effects().iter().map(|active| {
        let description = active.effect().description();
        format!("{}: {}", description.title, description.equation)
    }));
    let mut text = match terms.len() {
        0 => format!("{left} = 0"),
        1 => format!("{left} = the term below"),
        _ => format!("{left} = the sum of the terms below"),
    };
    for term in terms {
        let _ = write!(text, "\n  {term}");
    }
    text.push_str("\n\nwhere");
    for (symbol, _, value, unit) in coefficients(repaired) {
        let _ = write!(text, "\n  {symbol} = {value:.6e} {unit}");
    }
    if repaired.driven() {
        let _ = write!(text, "\n  g = {:.6e}, torque per unit of the input u", nominal.input_gain());
    }
    for (description, symbol, value, unit) in parameters(repaired) {
        let _ = write!(text, "\n  {symbol} = {value:.6e} {unit} ({})", description.title);
    }
    if nominal.coordinate() == Coordinate::Displacement {
        text.push_str("\n\nθ is the displacement, I the mass.");
    }
    for active in &repaired.chain {
        let description = active.effect().description();
        let _ = write!(text, "\n\nIn the measurement chain: {}: {}", description.title, description.equation);
    }
    for sentence in &repaired.left_out {
        let _ = write!(text, "\n\nNot part of it: {}.", one_line(sentence));
    }
    text.push('\n');
    text
}

/// Writes the equation of motion as LaTeX: an aligned display, then the numbers as a list.
#[must_use]
pub fn equation_latex(repaired: &Repaired) -> String {
    let [x, v, a] = LETTERS.latex;
    let nominal = repaired.system.nominal();
    let mut left = if nominal.inertia() == 1.0 { format!("{a}+c{v}") } else { format!("I{a}+c{v}") };
    if nominal.stiffness() != 0.0 {
        let _ = write!(left, r"+k({x}-\theta_\mathrm{{rest}})");
    }
    let mut right: Vec<String> = Vec::new();
    if repaired.driven() {
        right.push("g\\,u(t)".to_owned());
    }
    right.extend(repaired.system.effects().iter().map(|a| a.effect().description().latex.to_owned()));
    let right = if right.is_empty() { "0".to_owned() } else { right.join("\\\\\n  &\\quad ") };
    let mut text =
        format!("\\begin{{align*}}\n  {left} ={{}}& {right}\n\\end{{align*}}\n\\begin{{itemize}}\n");
    for (_, symbol, value, unit) in coefficients(repaired) {
        let _ = writeln!(text, "  \\item ${symbol} = {}$ {}", latex_number(value), latex_unit(unit));
    }
    if repaired.driven() {
        let _ = writeln!(text, "  \\item $g = {}$", latex_number(nominal.input_gain()));
    }
    for (description, symbol, value, unit) in parameters(repaired) {
        let _ = writeln!(
            text,
            "  \\item ${} = {}$ {} ({})",
            latex_symbol(symbol),
            latex_number(value),
            latex_unit(unit),
            description.title
        );
    }
    for active in &repaired.chain {
        let description = active.effect().description();
        let _ = writeln!(
            text,
            "  \\item in the measurement chain: {}, ${}$",
            description.title, description.latex
        );
    }
    for sentence in &repaired.left_out {
        let _ = writeln!(text, "  \\item Not part of it: {}.", latex_words(&one_line(sentence)));
    }
    text.push_str("\\end{itemize}\n");
    text
}

/// Returns every parameter of every effect with its symbol, value and unit.
fn parameters(repaired: &Repaired) -> Vec<(&'static Description, &'static str, f64, &'static str)> {
    let all = repaired.system.effects().iter().chain(&repaired.chain);
    all.flat_map(|active| {
        let description = active.effect().description();
        let own = description.parameters.iter().zip(active.values());
        own.map(move |(parameter, value)| {
            (description, parameter.symbol, *value, repaired.unit(parameter.quantity))
        })
    })
    .collect()
}

/// Escapes words so that LaTeX prints them literally.
fn latex_words(words: &str) -> String {
    let mut text = String::new();
    for letter in words.chars() {
        match letter {
            '\\' => text.push_str("\\textbackslash{}"),
            '^' => text.push_str("\\textasciicircum{}"),
            '~' => text.push_str("\\textasciitilde{}"),
            '{' | '}' | '$' | '&' | '#' | '_' | '%' => text.extend(['\\', letter]),
            other => text.push(other),
        }
    }
    text
}

fn latex_number(value: f64) -> String {
    let text = format!("{value:.5e}");
    match text.split_once('e') {
        Some((mantissa, "0")) => mantissa.to_owned(),
        Some((mantissa, exponent)) => format!("{mantissa}\\times10^{{{exponent}}}"),
        None => text,
    }
}

/// Returns a unit as LaTeX: `N m s/rad^2` becomes `N\,m\,s/rad$^2$`.
fn latex_unit(unit: &str) -> String {
    let mut text = String::new();
    let mut letters = unit.chars().peekable();
    while let Some(letter) = letters.next() {
        match letter {
            ' ' => text.push_str("\\,"),
            '^' => {
                let power = letters.next().map_or_else(String::new, String::from);
                let _ = write!(text, "$^{power}$");
            }
            other => text.push(other),
        }
    }
    text
}

/// Returns a symbol of the registry as LaTeX, with Greek letters by name and the part after `_` as an index.
fn latex_symbol(symbol: &str) -> String {
    let mut text = String::new();
    for letter in symbol.chars() {
        match greek(letter) {
            Some(name) => {
                let _ = write!(text, "\\{name} ");
            }
            None => text.push(letter),
        }
    }
    match text.split_once('_') {
        Some((base, index)) => format!("{}_{{{}}}", base.trim_end(), index.trim_end()),
        None => text.trim_end().to_owned(),
    }
}

fn greek(letter: char) -> Option<&'static str> {
    Some(match letter {
        'α' => "alpha",
        'β' => "beta",
        'δ' => "delta",
        'ε' => "varepsilon",
        'θ' => "theta",
        'σ' => "sigma",
        'τ' => "tau",
        'φ' => "varphi",
        'χ' => "chi",
        'ψ' => "psi",
        'ω' => "omega",
        'Ω' => "Omega",
        'Δ' => "Delta",
        _ => return None,
    })
}
