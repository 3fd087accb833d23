//! Requests of the page and their answers.

use crate::diagnose::{DiagnoseRequest, diagnose};
use crate::estimate::{EstimateRequest, estimated};
use crate::examples::{ExampleRequest, examples, simulated};
use crate::host::Host;
use crate::looked::{LookRequest, looked};
use crate::reading::offered;
use serde::Deserialize;
use serde_json::json;
use workflow::Log;

/// The dropped files.
#[derive(Debug, Default)]
pub struct Dropped {
    logs: Vec<Log>,
}

/// Request of the page.
#[derive(Deserialize)]
#[serde(tag = "do", rename_all = "kebab-case", deny_unknown_fields)]
enum Request {
    /// Forgets the files.
    Clear,
    /// Lists the options for reading logs, and the examples.
    Offer,
    /// Simulates the record of an example.
    Simulate(ExampleRequest),
    /// Says what each file was taken for.
    Look(LookRequest),
    /// Estimates the decay of each file.
    Estimate(EstimateRequest),
    /// Diagnoses the files as records of one system.
    Diagnose(Box<DiagnoseRequest>),
}

impl Dropped {
    /// Adds a file with its name.
    pub fn add(&mut self, name: String, bytes: Vec<u8>) {
        self.logs.push(Log { name, bytes, note: None });
    }

    /// Answers a request in JSON, with JSON: an object with `error`, a message for people, if there is no other answer.
    pub fn ask(&mut self, request: &[u8], host: &dyn Host) -> String {
        let answer = match serde_json::from_slice(request) {
            Ok(Request::Clear) => {
                self.logs.clear();
                Ok(json!({}))
            }
            Ok(Request::Offer) => Ok(json!({ "options": offered(), "examples": examples() })),
            Ok(Request::Simulate(request)) => simulated(&request),
            Ok(Request::Look(request)) => looked(&self.logs, &request),
            Ok(Request::Estimate(request)) => estimated(&self.logs, &request),
            Ok(Request::Diagnose(request)) => diagnose(&self.logs, &request, host),
            Err(error) => Err(format!("the page asked for something unknown: {error}")),
        };
        answer.unwrap_or_else(|error| json!({ "error": report::in_fields(&error) })).to_string()
    }
}
