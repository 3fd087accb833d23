//! Reader of JSON documents and JSON lines that hold a table: an array of records, an object of columns, an
//! array of rows, or one of these inside an object.
//!
//! Sources: RFC 8259 (JSON); jsonlines.org; for objects of columns, the documentation of pandas' `to_json`.

use super::sheet::{Cell, Column, named, unnamed};
use super::unread::Unread;
use crate::FEWEST_SAMPLES;
use serde_json::{Map, Value};
use std::collections::HashSet;

/// Values of one series, by their name; records are a series without a name.
type Series<'a> = (String, Vec<&'a Value>);

/// Scalars beside a table, as remarks.
type Remarks = [(String, String)];

/// Step from a value to a part of it.
#[derive(Clone)]
enum Step<'a> {
    Key(&'a str),
    Index(usize),
}

/// Largest number of cells for each byte of the file: records that share no keys would fill a table with
/// empty cells that is far larger than the file.
const MOST_CELLS: usize = 16;

/// Returns the table of a document, or `None` if the text does not look like JSON.
pub(super) fn text(text: &str) -> Option<Result<String, Unread>> {
    let mut signs = text.chars().filter(|sign| !sign.is_whitespace());
    let first = signs.next().filter(|sign| "{[".contains(*sign))?;
    // A log that begins with a time or a name in brackets is not JSON with a fault.
    let sure = match (first, signs.next()?) {
        ('{', '"' | '}') | ('[', '{' | '[') => true,
        ('[', next) if next == '"' || next == '-' || next == ']' || next.is_ascii_digit() => false,
        _ => return None,
    };
    let table = match parse(text) {
        Ok(values) => table_of(&values, text.len()),
        Err(problem) if sure => Err(problem),
        Err(_) => return None,
    };
    Some(table.map_err(|problem| Unread {
        kind: "a JSON document",
        problem,
        remedy: "write it as records with a time, or convert it, in Python with\n    \
                 import json, pandas; data = json.load(open('in.json'))  # choose the part with the samples\n    \
                 pandas.json_normalize(data).to_csv('out.csv', index=False)"
            .to_owned(),
    }))
}

/// Parses a document or several, one after another, as in JSON lines.
fn parse(text: &str) -> Result<Vec<Value>, String> {
    let once = |text: &str| {
        let mut values = Vec::new();
        for value in serde_json::Deserializer::from_str(text).into_iter::<Value>() {
            match value {
                Ok(value) => values.push(value),
                // A logger that was cut off leaves half a line at the end.
                Err(error) if error.is_eof() && values.len() >= FEWEST_SAMPLES => break,
                Err(error) => return Err(format!("it is damaged: {error}")),
            }
        }
        Ok(values)
    };
    once(text).or_else(|problem| once(&without_nan(text).ok_or(problem)?))
}

/// Returns the text with `null` for the words that Python writes for numbers that are not finite, or `None`
/// if there are none.
fn without_nan(text: &str) -> Option<String> {
    let (mut plain, mut rest, mut changed) = (String::new(), text, false);
    while let Some(at) = rest.find(['"', 'N', 'I', '-']) {
        let (before, after) = rest.split_at(at);
        plain += before;
        let word = ["NaN", "-Infinity", "Infinity"].into_iter().find(|word| after.starts_with(word));
        changed |= word.is_some();
        let taken = word.map_or_else(|| if after.starts_with('"') { quoted(after) } else { 1 }, str::len);
        let (sign, after) = after.split_at_checked(taken)?;
        plain += if word.is_some() { "null" } else { sign };
        rest = after;
    }
    plain += rest;
    changed.then_some(plain)
}

/// Returns the number of bytes of the text in quotes at the beginning.
fn quoted(text: &str) -> usize {
    let mut escaped = false;
    for (at, byte) in text.bytes().enumerate().skip(1) {
        match byte {
            _ if escaped => escaped = false,
            b'\\' => escaped = true,
            b'"' => return at + 1,
            _ => {}
        }
    }
    text.len()
}

fn table_of(values: &[Value], bytes: usize) -> Result<String, String> {
    match values {
        [Value::Object(object)] => object_of(object, bytes),
        [Value::Array(items)] => array_of(&items.iter().collect::<Vec<_>>(), None, &[], bytes),
        values => array_of(&values.iter().collect::<Vec<_>>(), None, &[], bytes),
    }
}

/// Returns the table of an object: its columns, or the table inside it.
fn object_of(object: &Map<String, Value>, bytes: usize) -> Result<String, String> {
    let remarks: Vec<(String, String)> =
        object.iter().filter_map(|(key, value)| Some((key.clone(), scalar(value)?))).collect();
    let arrays: Vec<Series<'_>> = object
        .iter()
        .filter_map(|(key, value)| Some((key.clone(), value.as_array()?.iter().collect::<Vec<_>>())))
        .collect();
    let composed = |(_, items): &&Series<'_>| items.iter().all(|item| item.is_object() || item.is_array());
    let length = |(_, items): &Series<'_>| items.len();
    let longest = arrays.iter().map(length).fold(0, usize::max);
    let inside: Vec<&Series<'_>> =
        arrays.iter().filter(|series| length(series) == longest && composed(series)).collect();
    let others = |name: &str| {
        let name = name.to_owned();
        arrays.iter().filter(move |(own, _)| *own != name)
    };
    // A few words or numbers lie beside the object with the samples.
    let has_array = |value: &Value| value.as_object().is_some_and(|map| map.values().any(Value::is_array));
    if longest == 0 || longest < FEWEST_SAMPLES && object.values().any(has_array) {
        return nested(object, bytes);
    }
    match inside.as_slice() {
        [(name, items)] if others(name).all(|other| is_index(other, items)) => {
            let fits = |titles: &Vec<String>| width(items) == Some(titles.len());
            let titles = others(name).find_map(|(_, titles)| words(titles).filter(fits));
            array_of(items, titles, &remarks, bytes)
        }
        _ => columns_of(&arrays, &remarks, bytes),
    }
}

/// Returns `true` for an array beside a table: names of its columns, numbers of its rows, a few constants.
fn is_index((name, items): &Series<'_>, table: &[&Value]) -> bool {
    items.len() < FEWEST_SAMPLES
        || words(items).is_some_and(|titles| width(table) == Some(titles.len()))
        || (name == "index" && items.len() == table.len())
}

/// Returns the table inside an object without columns: columns with numbered entries or numbered
/// records, as pandas writes them, or the member that is a table.
fn nested(object: &Map<String, Value>, bytes: usize) -> Result<String, String> {
    let members: Vec<(&String, &Map<String, Value>)> =
        object.iter().filter_map(|(key, value)| Some((key, value.as_object()?))).collect();
    let numbered =
        |map: &Map<String, Value>| !map.is_empty() && map.keys().all(|key| key.parse::<u64>().is_ok());
    if !members.is_empty() && members.iter().all(|(_, map)| numbered(map)) {
        let columns: Vec<Series<'_>> =
            members.iter().map(|(key, map)| ((*key).clone(), map.values().collect())).collect();
        return columns_of(&columns, &[], bytes);
    }
    if !members.is_empty() && numbered(object) {
        let records = members.iter().filter_map(|(key, _)| object.get(*key)).collect();
        return columns_of(&[(String::new(), records)], &[], bytes);
    }
    let has_array = |map: &Map<String, Value>| map.values().any(Value::is_array);
    let mut tables = members.iter().filter(|(key, map)| *key == "data" || has_array(map));
    match (tables.next(), tables.next()) {
        (Some((_, map)), None) if has_array(map) => object_of(map, bytes),
        (Some(_), Some(_)) => Err("it holds several tables".to_owned()),
        _ => {
            let keys: Vec<String> = object.keys().take(6).map(|key| format!("`{key:.40}`")).collect();
            Err(format!("it holds no table of samples, only {}", keys.join(", ")))
        }
    }
}

/// Returns the table of an array of records, of rows, or of numbers.
fn array_of(
    items: &[&Value],
    titles: Option<Vec<String>>,
    remarks: &Remarks,
    bytes: usize,
) -> Result<String, String> {
    if items.iter().all(|item| item.is_object()) {
        return columns_of(&[(String::new(), items.to_vec())], remarks, bytes);
    }
    if let Some(width) = width(items) {
        // The first of the rows may hold the names.
        let header = items.first().and_then(|row| words(&row.as_array()?.iter().collect::<Vec<_>>()));
        let (_, rows) = items.split_at(usize::from(header.is_some()));
        if width.saturating_mul(rows.len()) > bytes {
            return Err("its rows have too different lengths".to_owned());
        }
        let part = |row: usize, column: usize| rows.get(row).and_then(|row| row.get(column));
        let Some(titles) = titles.or(header) else {
            return Ok(unnamed((rows.len(), width), |row, column| cell(part(row, column)), remarks));
        };
        let column = |(at, name): (usize, String)| Column {
            name,
            length: rows.len(),
            cell: Box::new(move |row| cell(part(row, at))),
        };
        return named(&titles.into_iter().enumerate().map(column).collect::<Vec<_>>(), remarks);
    }
    if items.iter().all(|item| item.is_number() || item.is_null()) && !items.is_empty() {
        return Ok(unnamed((items.len(), 1), |row, _| cell(items.get(row).copied()), remarks));
    }
    Err("its array holds neither records nor rows of numbers".to_owned())
}

/// Returns the largest number of entries of rows, if all items are rows.
fn width(items: &[&Value]) -> Option<usize> {
    items.iter().map(|item| item.as_array().map(Vec::len)).collect::<Option<Vec<_>>>()?.into_iter().max()
}

/// Returns the texts of an array that holds nothing but texts.
fn words(items: &[&Value]) -> Option<Vec<String>> {
    let texts: Option<Vec<String>> = items.iter().map(|item| item.as_str().map(str::to_owned)).collect();
    texts.filter(|texts| !texts.is_empty())
}

/// Returns the table of series side by side; records and arrays in a series become several columns.
fn columns_of(series: &[Series<'_>], remarks: &Remarks, bytes: usize) -> Result<String, String> {
    let (mut columns, mut cells) = (Vec::new(), 0_usize);
    for (name, items) in series {
        let paths = paths(name, items);
        cells = cells.saturating_add(paths.len().saturating_mul(items.len()));
        if cells > bytes.saturating_mul(MOST_CELLS) {
            return Err("its records have too few keys in common".to_owned());
        }
        columns.extend(paths.into_iter().map(|(name, path)| Column {
            name,
            length: items.len(),
            cell: Box::new(move |row| cell(items.get(row).and_then(|item| follow(item, &path)))),
        }));
    }
    named(&columns, remarks)
}

/// Returns the paths to all scalars of some items, with their names, in the order of their appearance.
fn paths<'a>(name: &str, items: &[&'a Value]) -> Vec<(String, Vec<Step<'a>>)> {
    let (mut known, mut found) = (HashSet::new(), Vec::new());
    for item in items {
        walk(item, name, &mut Vec::new(), &mut |name, path| {
            if !known.contains(name) {
                known.insert(name.to_owned());
                found.push((name.to_owned(), path.to_vec()));
            }
        });
    }
    found
}

/// Returns the part of a value at the end of a path.
fn follow<'a>(value: &'a Value, path: &[Step<'_>]) -> Option<&'a Value> {
    path.iter().try_fold(value, |value, step| match step {
        Step::Key(key) => value.get(*key),
        Step::Index(at) => value.get(*at),
    })
}

/// Visits the scalars of a value; names of parts are joined by dots, and entries of arrays counted from 1.
fn walk<'a>(
    value: &'a Value,
    name: &str,
    path: &mut Vec<Step<'a>>,
    visit: &mut impl FnMut(&str, &[Step<'a>]),
) {
    match value {
        Value::Object(object) => {
            for (key, value) in object {
                let name = if name.is_empty() { key.clone() } else { format!("{name}.{key}") };
                path.push(Step::Key(key));
                walk(value, &name, path, visit);
                path.pop();
            }
        }
        Value::Array(items) => {
            for (at, value) in items.iter().enumerate() {
                path.push(Step::Index(at));
                walk(value, &format!("{name}_{}", at + 1), path, visit);
                path.pop();
            }
        }
        _ => visit(name, path),
    }
}

fn cell(value: Option<&Value>) -> Cell {
    match value {
        Some(Value::Number(number)) => match (number.as_i128(), number.as_f64()) {
            (Some(whole), _) => Cell::Integer(whole),
            (None, Some(number)) => Cell::Float(number),
            (None, None) => Cell::Missing,
        },
        Some(Value::Bool(truth)) => Cell::Integer((*truth).into()),
        Some(Value::String(text)) => Cell::Text(text.clone()),
        _ => Cell::Missing,
    }
}

/// Returns a number or a text, as text.
fn scalar(value: &Value) -> Option<String> {
    match value {
        Value::Number(number) => Some(number.to_string()),
        Value::String(text) => Some(text.chars().take(200).collect()),
        _ => None,
    }
}
