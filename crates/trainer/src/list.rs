//! `trainer list`.

use crate::Outcome;
use crate::cli::{Listing, Output};
use crate::console;
use crate::error::TrainerError;
use crate::summary::table;
use registry::ESTIMATORS;
use serde_json::json;

pub(crate) fn list(what: Listing, output: Output) -> Result<Outcome, TrainerError> {
    match what {
        Listing::Estimators => estimators(output),
    }
    Ok(Outcome::Done)
}

fn estimators(output: Output) {
    if output.json {
        let rows: Vec<_> = ESTIMATORS
            .iter()
            .map(|entry| {
                json!({
                    "id": entry.id,
                    "paper_number": entry.paper_number,
                    "title": entry.title,
                    "summary": entry.summary,
                    "citations": entry.citations,
                })
            })
            .collect();
        console::result(&json!({ "estimators": rows }).to_string());
        return;
    }
    let number = |number: Option<u8>| number.map_or_else(|| "-".to_owned(), |n| n.to_string());
    let rows = ESTIMATORS
        .iter()
        .map(|entry| vec![entry.id.to_owned(), number(entry.paper_number), entry.summary.to_owned()])
        .collect();
    console::result(&table(&["name", "no. in the paper", "what it does"], rows));
}
