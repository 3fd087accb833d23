//! Models that MuJoCo reads, through the installed Python.

use robot::{Foreign, RobotError, Simulator};
use serde_json::Value;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::{Mutex, PoisonError};

/// Program that answers for MuJoCo; the Python package holds it too.
const PROGRAM: &str = include_str!("../../../../../../python/ringdown_lab/_simulator.py");

/// Names of the interpreter, the first one first.
const INTERPRETERS: [&str; 2] = ["python3", "python"];

/// Running interpreter and the two ends of its pipes.
struct Interpreter {
    child: Child,
    input: Option<ChildStdin>,
    output: BufReader<ChildStdout>,
}

impl Drop for Interpreter {
    fn drop(&mut self) {
        // The program ends where its input does.
        self.input = None;
        let _ = self.child.wait();
    }
}

impl Interpreter {
    /// Reads the answer to the last question.
    fn answer(&mut self) -> Result<String, String> {
        let mut line = String::new();
        match self.output.read_line(&mut line) {
            Ok(1..) => {}
            _ => return Err("the Python program ended without an answer".to_owned()),
        }
        let refused = serde_json::from_str(&line)
            .ok()
            .and_then(|own: Value| own.get("refused").and_then(Value::as_str).map(str::to_owned));
        refused.map_or(Ok(line), Err)
    }

    fn ask(&mut self, question: &str) -> Result<String, String> {
        let written =
            self.input.as_mut().map(|input| writeln!(input, "{question}").and_then(|()| input.flush()));
        match written {
            Some(Ok(())) => self.answer(),
            _ => Err("the Python program has ended".to_owned()),
        }
    }
}

/// One question at a time, from any thread.
struct Shared(Mutex<Interpreter>);

impl Simulator for Shared {
    fn ask(&self, question: &str) -> Result<String, String> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).ask(question)
    }
}

/// Reads an MJCF model through the installed Python.
///
/// # Errors
/// [`RobotError::Simulator`] without Python, without its MuJoCo, or for a model that MuJoCo refuses.
pub(super) fn mjcf(model: &Path) -> Result<Foreign, RobotError> {
    let file = model.display().to_string();
    let refused = |problem: String| RobotError::Simulator { file: file.clone(), problem };
    let text =
        std::fs::read_to_string(model).map_err(|error| refused(format!("it cannot be read: {error}")))?;
    let start = |name: &&str| {
        let mut command = Command::new(name);
        command.arg("-c").arg(PROGRAM).arg(model);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().ok()
    };
    let mut child = INTERPRETERS.iter().find_map(start).ok_or_else(|| {
        refused(
            "MJCF models are read by MuJoCo through Python, and there is no python3 on the PATH: install Python and \
             `pip install mujoco`, or convert the model to URDF"
                .to_owned(),
        )
    })?;
    let (Some(input), Some(output)) = (child.stdin.take(), child.stdout.take()) else {
        return Err(refused("the Python program has no input and output".to_owned()));
    };
    let mut interpreter = Interpreter { child, input: Some(input), output: BufReader::new(output) };
    interpreter.answer().map_err(|problem| {
        // What the program says names the file where the model is at fault.
        refused(problem.strip_prefix(&format!("{file}: ")).unwrap_or(&problem).to_owned())
    })?;
    Ok(Foreign::new(Box::new(Shared(Mutex::new(interpreter))))?.with_text(text))
}
