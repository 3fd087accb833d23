//! Handing a frozen sweep to Slurm: a job array with one task for each share.

use super::arguments::SweepArguments;
use super::frozen::FrozenSweep;
use crate::error::SweepCommandError;
use crate::error::TrainerError;
use crate::outcome::Outcome;
use crate::own_program::own_program;
use crate::terminal::console;
use runs::RunError;
use serde_json::json;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Name of the job script in the sweep's folder.
const SCRIPT: &str = "slurm.sh";

/// Writes the job script and submits it. The script stays where that is not possible.
pub(super) fn launch(arguments: &SweepArguments, sweep: &FrozenSweep) -> Result<Outcome, TrainerError> {
    let folder = sweep.folder.folder();
    let shares = usize::from(arguments.shards).min(sweep.manifest.runs.len());
    let job = Job {
        name: &sweep.manifest.name,
        program: own_program().map_err(system("the program's own path"))?,
        here: std::env::current_dir().map_err(system("the current folder"))?,
        folder: absolute(folder.path())?,
        shares,
        threads: arguments.run.threads.unwrap_or(1),
        failed: arguments.failed,
    };
    folder.write(SCRIPT, job.script().as_bytes())?;
    folder.write("slurm/README", b"What each task printed: <job>_<share>.log\n")?;
    let script = folder.path().join(SCRIPT);
    let shown = script.display().to_string();
    let failed = |problem: String| SweepCommandError::Launch { script: shown.clone(), problem };
    let output = Command::new("sbatch").arg(&script).output().map_err(|error| match error.kind() {
        ErrorKind::NotFound => failed("there is no sbatch on this machine".to_owned()),
        _ => failed(format!("sbatch cannot be run: {error}")),
    })?;
    let said = String::from_utf8_lossy(&output.stdout).trim().to_owned();
    if !output.status.success() {
        let complaint = String::from_utf8_lossy(&output.stderr).trim().replace('\n', ", ");
        return Err(failed(format!("sbatch refused it: {complaint}")).into());
    }
    folder.record_event("submitted", &json!({ "shares": shares, "said": said }))?;
    if !arguments.output.quiet {
        let path = folder.path().display();
        console::result(&format!(
            "{said}\n{} runs in {shares} shares, logs in {path}/slurm; how far it is: trainer compare {path}",
            sweep.manifest.runs.len()
        ));
    }
    Ok(Outcome::Done)
}

/// What the script says.
struct Job<'a> {
    name: &'a str,
    program: PathBuf,
    /// Relative paths of records start here.
    here: PathBuf,
    folder: PathBuf,
    shares: usize,
    threads: u16,
    failed: bool,
}

impl Job<'_> {
    /// A task sees its share's number in `SLURM_ARRAY_TASK_ID`. A task that Slurm puts in the queue again goes on with
    /// what its share is missing.
    fn script(&self) -> String {
        let safe = |c: char| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '-' };
        let name: String = self.name.chars().map(safe).collect();
        let folder = self.folder.display().to_string();
        let [program, here, out] =
            [&self.program, &self.here, &self.folder].map(|path| quoted(&path.display().to_string()));
        let (shares, threads) = (self.shares, self.threads);
        let failed = if self.failed { " --failed" } else { "" };
        // `#SBATCH` lines know double quotes only, and `%` has a meaning in file names.
        let log = format!("{}/slurm/%A_%a.log", folder.replace('%', "%%").replace('"', "\\\""));
        format!(
            "#!/bin/sh\n\
             #SBATCH --job-name={name}\n\
             #SBATCH --array=1-{shares}\n\
             #SBATCH --cpus-per-task={threads}\n\
             #SBATCH --output=\"{log}\"\n\
             #SBATCH --requeue\n\
             cd {here} || exit 2\n\
             exec {program} sweep --out {out} --resume{failed} --shard \"$SLURM_ARRAY_TASK_ID/{shares}\" \
             --threads {threads}\n"
        )
    }
}

/// A word as a shell takes it, whatever is in it.
fn quoted(word: &str) -> String {
    format!("'{}'", word.replace('\'', "'\\''"))
}

fn absolute(path: &Path) -> Result<PathBuf, TrainerError> {
    path.canonicalize()
        .map_err(|source| RunError::Io { path: path.to_owned(), action: "find", source }.into())
}

fn system(what: &'static str) -> impl FnOnce(std::io::Error) -> TrainerError {
    move |error| TrainerError::System { what, problem: error.to_string() }
}

#[cfg(test)]
mod tests {
    use super::{Job, quoted};

    #[test]
    fn a_word_survives_the_shell() {
        for word in ["plain", "a b", "it's", "$HOME `x` \"y\" \\"] {
            let output = std::process::Command::new("sh")
                .args(["-c", &format!("printf %s {}", quoted(word))])
                .output()
                .unwrap();
            assert_eq!(String::from_utf8(output.stdout).unwrap(), word);
        }
    }

    #[test]
    fn the_script_has_one_task_for_each_share() {
        let job = Job {
            name: "a sweep",
            program: "/opt/it's/trainer".into(),
            here: "/home/me".into(),
            folder: "/data/100 %".into(),
            shares: 4,
            threads: 2,
            failed: false,
        };
        let script = job.script();
        for line in [
            "#SBATCH --job-name=a-sweep",
            "#SBATCH --array=1-4",
            "#SBATCH --cpus-per-task=2",
            "#SBATCH --output=\"/data/100 %%/slurm/%A_%a.log\"",
            "cd '/home/me' || exit 2",
            "exec '/opt/it'\\''s/trainer' sweep --out '/data/100 %' --resume --shard \"$SLURM_ARRAY_TASK_ID/4\" --threads 2",
        ] {
            assert!(script.lines().any(|found| found == line), "{line}\n{script}");
        }
    }
}
