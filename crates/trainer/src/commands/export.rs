//! `trainer export`: finished runs for common experiment trackers.

use crate::error::TrainerError;
use crate::folders::resume::is_finished;
use crate::options::Output;
use crate::outcome::Outcome;
use clap::{Args, ValueEnum};
use runs::RunFolder;
use serde_json::json;
use std::path::PathBuf;
use tracking::{Finished, mlflow, tensorboard};

/// Arguments of exporting runs.
#[derive(Debug, Args)]
pub(crate) struct ExportArguments {
    /// Folders of finished runs
    #[arg(required = true, value_name = "RUN")]
    runs: Vec<PathBuf>,
    /// Tracker to write for
    #[arg(long, value_enum, value_delimiter = ',', required = true)]
    to: Vec<Tracker>,
    /// MLflow's store
    #[arg(long, value_name = "DIR", default_value = "mlruns")]
    store: PathBuf,
    #[command(flatten)]
    output: Output,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Tracker {
    /// An event file in the run's folder, below tensorboard/
    Tensorboard,
    /// A run in MLflow's file store
    Mlflow,
}

/// Writes the files for the requested trackers; repeating the export writes the same files again.
pub(crate) fn command(arguments: &ExportArguments) -> Result<Outcome, TrainerError> {
    let mut written = Vec::new();
    for path in &arguments.runs {
        let run = Finished::read(path, is_finished(&RunFolder::open(path))?)?;
        for tracker in &arguments.to {
            let place = match tracker {
                Tracker::Tensorboard => {
                    let name = tensorboard::file_name(&run);
                    RunFolder::open(path).write(&name, &tensorboard::events(&run))?;
                    path.join(name)
                }
                Tracker::Mlflow => {
                    let store = RunFolder::open(&arguments.store);
                    // MLflow needs a path that is valid from whatever folder it is started in.
                    let place =
                        std::path::absolute(&arguments.store).unwrap_or_else(|_| arguments.store.clone());
                    for (name, content) in mlflow::files(&run, &place) {
                        store.write_reproducible(&name, content.as_bytes())?;
                    }
                    if !arguments.store.join(mlflow::EXPERIMENT).exists() {
                        store.write(mlflow::EXPERIMENT, mlflow::experiment(&run, &place).as_bytes())?;
                    }
                    arguments.store.join(mlflow::folder(&run))
                }
            };
            written.push(place.display().to_string());
        }
    }
    arguments.output.print(&json!({ "written": written }), || written.join("\n"))?;
    Ok(Outcome::Done)
}
