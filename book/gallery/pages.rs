//! The text of the pages.

use crate::plot::svg;
use crate::shown::panels;
use dynamics::{Class, Coordinate, Description, Parameter, Units};
use ringdown_lab::{Error, effects};
use std::fmt::Write;

/// The pages: file, part of the budget, heading, first paragraph.
const PAGES: [(&str, Class, &str, &str); 5] = [
    (
        "dissipative",
        Class::Dissipative,
        "Effects that take energy",
        "The decay of the amplitude distinguishes them: each has its own law of loss per half swing.",
    ),
    (
        "conservative",
        Class::Conservative,
        "Effects that store energy",
        "The frequency distinguishes them: each makes the frequency, and the center of the swing, depend on \
         the amplitude in its own way.",
    ),
    (
        "time-dependent",
        Class::TimeDependent,
        "Effects that depend on time",
        "They depend on the time or on the input, not on the amplitude.",
    ),
    (
        "sensor",
        Class::Sensor,
        "Effects of the sensor",
        "The motion is unchanged, but the file shows it wrongly.",
    ),
    ("clock", Class::Clock, "Effects of the clock", "The values are right, but the times are wrong."),
];

/// Every file of the gallery with its content.
pub(crate) fn pages() -> Result<Vec<(String, String)>, Error> {
    let mut files = Vec::new();
    for (name, class, heading, first) in PAGES {
        let mut text = format!("# {heading}\n\n{first}\n");
        for effect in effects().filter(|effect| effect.class == class) {
            section(&mut text, effect);
            files.push((format!("{}.svg", effect.id), svg(&panels(effect)?)));
        }
        text.push_str(
            "\n---\n\nGenerated from the registry by `cargo run -p ringdown-lab --example gallery -- --write`; every record \
             behind a plot is simulated.\n",
        );
        files.push((format!("{name}.md"), text));
    }
    Ok(files)
}

/// One effect. Writing to a text cannot fail.
fn section(text: &mut String, effect: &Description) {
    let _ = writeln!(text, "\n## {}\n\n`{}` adds  `{}`\n", effect.title, effect.id, effect.equation);
    let _ = writeln!(text, "**Signature.** {}\n", effect.tell_tale);
    let _ = writeln!(text, "![{}]({}.svg)\n", effect.title, effect.id);
    text.push_str(
        "| parameter | unit (angle) | unit (displacement) | values | meaning |\n|---|---|---|---|---|\n",
    );
    for Parameter { name, symbol, quantity, range, meaning, .. } in effect.parameters {
        let [angle, displacement] =
            [Coordinate::Angle, Coordinate::Displacement].map(|own| quantity.unit(Units::Si(own)));
        let _ = writeln!(text, "| `{name}` ({symbol}) | {angle} | {displacement} | {range} | {meaning} |");
    }
    let others: Vec<String> = effect.confused_with.iter().map(|id| format!("`{id}`")).collect();
    if !others.is_empty() {
        let _ = writeln!(text, "\n**Confused with** {} where data are poor.", others.join(", "));
    }
    let _ = writeln!(text, "\n**Source.** {}", effect.reference);
}
