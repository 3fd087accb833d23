//! `trainer list`.

use crate::Outcome;
use crate::cli::{Listing, Output};
use crate::console;
use crate::error::TrainerError;
use crate::method::Method;
use crate::summary::table;
use serde_json::json;

pub(crate) fn list(what: Listing, output: Output) -> Result<Outcome, TrainerError> {
    match what {
        Listing::Estimators => estimators(output)?,
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
