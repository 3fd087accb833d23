//! `trainer list`.

use crate::Outcome;
use crate::cli::{Listing, Output};
use crate::console;
use crate::error::TrainerError;
use crate::method::Method;
use crate::summary::table;
use dynamics::{Class, Coordinate, Description, Kind, REGISTRY, Units};
use serde_json::json;

pub(crate) fn list(what: Listing, output: Output) -> Result<Outcome, TrainerError> {
    match what {
        Listing::Estimators => estimators(output)?,
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
                method.family().to_owned(),
                method.summary().to_owned(),
            ]
        })
        .collect();
    console::result(&table(&["name", "no. in the paper", "family", "what it does"], rows));
    Ok(())
}

fn effects(output: Output) {
    let descriptions = || REGISTRY.iter().map(|effect| effect.description());
    if output.json {
        let rows: Vec<_> = descriptions().map(effect_json).collect();
        console::result(&json!({ "effects": rows }).to_string());
        return;
    }
    let rows = descriptions()
        .map(|effect| {
            let parameters: Vec<String> = effect
                .parameters
                .iter()
                .map(|parameter| {
                    format!("{} {} [{}]", parameter.name, parameter.symbol, parameter.quantity.unit(SI))
                })
                .collect();
            vec![
                effect.id.to_owned(),
                kind(effect.kind).to_owned(),
                effect.equation.to_owned(),
                parameters.join(", "),
                effect.tell_tale.to_owned(),
            ]
        })
        .collect();
    console::result(&table(&["id", "acts in", "what it adds", "parameters", "tell-tale"], rows));
}

/// The units that listings show: of an angle, with the inertia known.
const SI: Units = Units::Si(Coordinate::Angle);

fn kind(kind: Kind) -> &'static str {
    match kind {
        Kind::System => "the system",
        Kind::MeasuringChain => "the measuring chain",
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
