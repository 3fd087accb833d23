//! `trainer explain`: the values in force, their sources and their meaning.

use crate::configured::{Configured, read_document};
use crate::error::TrainerError;
use crate::options::Output;
use crate::outcome::Outcome;
use crate::terminal::table::table;
use clap::Args;
use serde_json::{Value, json};
use settings::{Default, Origin, Setting};
use std::path::Path;

/// Arguments of explaining keys of a configuration.
#[derive(Debug, Args)]
#[command(override_usage = "trainer explain [OPTIONS] [KEY] <CONFIG> [KEY=VALUE]...")]
pub(crate) struct ExplainArguments {
    /// The key or table to explain (all keys, if left out), the configuration, and values that override it
    #[arg(required = true, value_name = "[KEY] CONFIG [KEY=VALUE]")]
    words: Vec<String>,
    /// Overrides the configuration's seed
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    #[command(flatten)]
    output: Output,
}

impl ExplainArguments {
    /// Splits the words into key, configuration and overrides. The second word is the configuration unless it
    /// is an override.
    fn parts(&self) -> (Option<&str>, &Path, &[String]) {
        match self.words.as_slice() {
            [key, config, overrides @ ..] if !config.contains('=') => {
                (Some(key.as_str()), Path::new(config), overrides)
            }
            [config, overrides @ ..] => (None, Path::new(config), overrides),
            [] => (None, Path::new(""), &[]),
        }
    }
}

/// Explains one key, the keys of a table, or all keys.
pub(crate) fn command(arguments: &ExplainArguments) -> Result<Outcome, TrainerError> {
    let (key, path, overrides) = arguments.parts();
    let configured = Configured::resolve(&read_document(path, overrides, arguments.seed)?)?;
    let resolved = configured.resolved();
    let Some(key) = key else {
        return listing(resolved.settings().iter(), arguments.output);
    };
    let below = |setting: &&Setting| {
        setting.section == key || setting.section.strip_prefix(key).is_some_and(|rest| rest.starts_with('.'))
    };
    if !key.is_empty() && resolved.settings().iter().any(|setting| below(&setting)) {
        return listing(resolved.settings().iter().filter(below), arguments.output);
    }
    let setting = resolved.setting(key)?;
    arguments.output.print(&as_json(setting), || paragraph(setting))?;
    Ok(Outcome::Done)
}

fn listing<'a>(
    settings: impl Iterator<Item = &'a Setting> + Clone,
    output: Output,
) -> Result<Outcome, TrainerError> {
    let rows: Vec<Value> = settings.clone().map(as_json).collect();
    output.print(&json!({ "settings": rows }), || {
        let rows = settings
            .map(|setting| {
                let unit = setting.field.unit.to_owned();
                vec![setting.key(), value(setting), unit, setting.origin.to_string()]
            })
            .collect();
        table(&["key", "value", "unit", "from"], rows)
    })?;
    Ok(Outcome::Done)
}

/// Formats the value in force as TOML.
fn value(setting: &Setting) -> String {
    setting.value.as_ref().map_or_else(|| "(left open)".to_owned(), ToString::to_string)
}

fn default(setting: &Setting) -> String {
    match setting.field.default {
        Default::Required => "none: it has to be given".to_owned(),
        Default::Absent => "left open".to_owned(),
        other => other.value().map(|value| value.to_string()).unwrap_or_default(),
    }
}

fn paragraph(setting: &Setting) -> String {
    let field = &setting.field;
    let mut lines = vec![format!("{} = {}", setting.key(), value(setting))];
    for (what, text) in [
        ("from", setting.origin.to_string().as_str()),
        ("means", field.meaning),
        ("unit", field.unit),
        ("expected", &field.kind.expected()),
        ("default", &default(setting)),
        ("source", field.source),
    ] {
        if !text.is_empty() {
            lines.push(format!("  {what:<9} {text}"));
        }
    }
    lines.join("\n")
}

fn as_json(setting: &Setting) -> Value {
    let field = &setting.field;
    let origin = match &setting.origin {
        Origin::File { file, line, column } => json!({ "file": file, "line": line, "column": column }),
        Origin::Override(argument) => json!({ "command_line": argument }),
        Origin::Default => json!("default"),
    };
    json!({
        "key": setting.key(),
        "value": setting.value,
        "origin": origin,
        "meaning": field.meaning,
        "unit": field.unit,
        "expected": field.kind.expected(),
        "default": field.default.value(),
        "required": field.default == Default::Required,
        "source": field.source,
    })
}
