//! `trainer list`: estimators, learners, effects or runs.

mod runs;

use crate::error::TableError;
use crate::error::TrainerError;
use crate::fits::method::Method;
use crate::options::Output;
use crate::outcome::Outcome;
use crate::terminal::console;
use crate::terminal::table::table;
use ::learn::Entry;
use ::learn::learners::LEARNERS;
use clap::ValueEnum;
use dynamics::{Class, Coordinate, Description, Kind, REGISTRY, Units};
use runs::list_runs;
use serde_json::json;
use std::path::Path;

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Listing {
    /// The estimators
    Estimators,
    /// The learners of `task = "learn"`
    Learners,
    /// The effects that a simulator may lack
    Effects,
    /// The runs that are kept in a folder, newest first
    Runs,
}

pub(crate) fn list(what: Listing, folder: Option<&Path>, output: Output) -> Result<Outcome, TrainerError> {
    let name = match what {
        Listing::Runs => None,
        Listing::Estimators => Some("estimators"),
        Listing::Learners => Some("learners"),
        Listing::Effects => Some("effects"),
    };
    if let (Some(what), Some(folder)) = (name, folder) {
        return Err(TableError::NoFolder { what, folder: folder.display().to_string() }.into());
    }
    match what {
        Listing::Runs => return list_runs(folder, output),
        Listing::Estimators => estimators(output)?,
        Listing::Learners => learners(output),
        Listing::Effects => effects(output),
    }
    Ok(Outcome::Done)
}

fn estimators(output: Output) -> Result<(), TrainerError> {
    let methods = Method::all()?;
    if output.json {
        let rows: Vec<_> = methods
            .iter()
            .map(|method| {
                json!({
                    "id": method.id(),
                    "paper_number": method.number(),
                    "family": method.family(),
                    "title": method.title(),
                    "summary": method.summary(),
                    "citations": method.citations(),
                })
            })
            .collect();
        console::result(&json!({ "estimators": rows }).to_string());
        return Ok(());
    }
    let number = |number: Option<u8>| number.map_or_else(|| "-".to_owned(), |n| n.to_string());
    let rows = methods
        .iter()
        .map(|method| {
            vec![
                method.id().to_owned(),
                number(method.number()),
                method.family().name().to_owned(),
                method.summary().to_owned(),
            ]
        })
        .collect();
    console::text(&table(&["name", "no. in the paper", "family", "what it does"], rows));
    Ok(())
}

fn learners(output: Output) {
    if output.json {
        let rows: Vec<_> = LEARNERS
            .iter()
            .map(|entry| {
                json!({
                    "id": entry.id,
                    "kind": entry.kind.name(),
                    "title": entry.title,
                    "summary": entry.summary,
                    "reference": entry.reference,
                })
            })
            .collect();
        console::result(&json!({ "learners": rows }).to_string());
        return;
    }
    let row = |entry: &Entry| [entry.id, entry.kind.name(), entry.summary].map(str::to_owned).to_vec();
    console::text(&table(&["name", "kind", "what it does"], LEARNERS.iter().map(row).collect()));
}

fn effects(output: Output) {
    let descriptions = || REGISTRY.iter().map(|effect| effect.description());
    if output.json {
        let rows: Vec<_> = descriptions().map(effect_json).collect();
        console::result(&json!({ "effects": rows }).to_string());
        return;
    }
    let entries: Vec<String> = descriptions().map(entry).collect();
    console::text(&entries.join("\n\n"));
}

/// Formats an effect as a paragraph of short lines: a table of all its properties would be wider than a
/// screen.
fn entry(effect: &Description) -> String {
    let mut lines = vec![
        format!(
            "{}: {}, in {}, {}",
            effect.id,
            effect.title,
            kind(effect.kind),
            class_in_words(effect.class)
        ),
        format!("  law            {}", effect.equation),
    ];
    for parameter in effect.parameters {
        let (name, symbol, unit) = (parameter.name, parameter.symbol, parameter.quantity.unit(SI));
        let unit = if unit.is_empty() { String::new() } else { format!(" ({unit})") };
        let (range, meaning) = (parameter.range, parameter.meaning);
        let default =
            parameter.default.map_or_else(String::new, |value| format!("; {value} where not given"));
        lines.push(format!("  {name:<14} {symbol}{unit}, {range}: {meaning}{default}"));
    }
    lines.push(format!("  tell-tale      {}", effect.tell_tale));
    if !effect.confused_with.is_empty() {
        lines.push(format!("  confused with  {}", effect.confused_with.join(", ")));
    }
    lines.join("\n")
}

/// Units shown in listings: those of an angle with a known inertia.
const SI: Units = Units::Si(Coordinate::Angle);

fn kind(kind: Kind) -> &'static str {
    match kind {
        Kind::System => "the system",
        Kind::MeasuringChain => "the measurement chain",
    }
}

fn class(class: Class) -> &'static str {
    match class {
        Class::Dissipative => "dissipative",
        Class::Conservative => "conservative",
        Class::TimeDependent => "time_dependent",
        Class::Sensor => "sensor",
        Class::Clock => "clock",
    }
}

fn class_in_words(of: Class) -> String {
    class(of).replace('_', "-")
}

fn effect_json(effect: &Description) -> serde_json::Value {
    let parameters: Vec<_> = effect
        .parameters
        .iter()
        .map(|parameter| {
            json!({
                "name": parameter.name,
                "symbol": parameter.symbol,
                "unit": parameter.quantity.unit(SI),
                "range": parameter.range.to_string(),
                "meaning": parameter.meaning,
                "default": parameter.default,
            })
        })
        .collect();
    json!({
        "id": effect.id,
        "title": effect.title,
        "acts_in": kind(effect.kind),
        "class": class(effect.class),
        "equation": effect.equation,
        "latex": effect.latex,
        "parameters": parameters,
        "tell_tale": effect.tell_tale,
        "confused_with": effect.confused_with,
        "driven_only": effect.driven_only,
        "reference": effect.reference,
    })
}
