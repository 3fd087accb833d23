//! `trainer diagnose --rigs`: several rigs of one build, each diagnosed separately, and the effects that they
//! share.

mod summary;

use super::arguments::DiagnoseArguments;
use super::batch::Case;
use super::kept;
use crate::error::TrainerError;
use crate::folders::environment::Environment;
use crate::folders::page::write_report;
use crate::outcome::Outcome;
use crate::terminal::interrupt::Saving;
use crate::terminal::progress::Progress;
use crate::terminal::{console, interrupt};
use rayon::prelude::*;
use results::{FailedCase, RigsResult};
use runs::{Disk, RunFolder, default_root};
use std::path::{Path, PathBuf};
use std::time::Instant;
use workflow::Question;
use workflow::rigs::{AnsweredRig, pooled};

/// Rig and the name of its answer's folder.
struct Rig {
    name: String,
    folder: PathBuf,
    case: Case,
}

/// Outcome of one rig, with the digests of its records.
type Fate = Result<(AnsweredRig, String), FailedCase>;

/// Diagnoses every rig and combines the answers. A rig that fails is reported, and the others continue.
pub(super) fn rigs(arguments: &DiagnoseArguments) -> Result<Outcome, TrainerError> {
    let start = Instant::now();
    let rigs = list(&arguments.rigs)?;
    let cancel = interrupt::watch()?;
    let folder = match &arguments.out {
        Some(path) if arguments.resume => RunFolder::resume_on(&Disk::default(), path)?,
        Some(path) => RunFolder::create_at(path)?,
        None => RunFolder::create(&default_root(), "rigs")?,
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(arguments.threads.map_or(0, usize::from))
        .build()
        .map_err(|error| TrainerError::System { what: "threads", problem: error.to_string() })?;
    let threads = pool.current_num_threads();
    let progress =
        Progress::over(rigs.len() as u64, "cases", arguments.output.quiet || arguments.output.json);
    let fates: Vec<Option<Fate>> = pool.install(|| {
        rigs.par_iter()
            .map(|rig| {
                if cancel.is_requested() {
                    return None;
                }
                let fate = answered(arguments, rig, folder.path(), threads).map_err(|error| {
                    let message = error.to_string();
                    progress.aside(|| console::error(&format!("{}: {message}", rig.name)));
                    FailedCase { id: rig.name.clone(), message }
                });
                progress.one_of_many_done();
                Some(fate)
            })
            .collect()
    });
    progress.finish();
    let _saving = Saving::begin();
    let result = kept_result(&folder, fates, threads, start)?;
    arguments.output.print(&result, || summary::summary(&result, folder.path()))?;
    Ok(Outcome::of(!result.complete, result.failed.is_empty()))
}

/// Writes the combined result, with the report last.
fn kept_result(
    folder: &RunFolder,
    fates: Vec<Option<Fate>>,
    threads: usize,
    start: Instant,
) -> Result<RigsResult, TrainerError> {
    let complete = fates.iter().all(Option::is_some);
    let (mut rigs, mut digests, mut failed) = (Vec::new(), Vec::new(), Vec::new());
    for fate in fates.into_iter().flatten() {
        match fate {
            Ok((rig, digest)) => {
                rigs.push(rig);
                digests.push(digest);
            }
            Err(case) => failed.push(case),
        }
    }
    let result = pooled(&rigs, failed, complete, start.elapsed().as_secs_f64());
    folder.write_json("environment.json", &Environment::new(threads, &digests.join(" ")))?;
    folder.write_json("rigs.json", &result)?;
    write_report(folder)?;
    Ok(result)
}

/// Lists the rigs in the given folders; rigs with the same name are distinguished by a number.
fn list(folders: &[PathBuf]) -> Result<Vec<Rig>, TrainerError> {
    if let [one] = folders {
        return Err(TrainerError::OneRig { rig: one.display().to_string() });
    }
    let mut rigs: Vec<Rig> = Vec::new();
    for folder in folders {
        let refused = |problem: std::io::Error| TrainerError::NoRig {
            folder: folder.display().to_string(),
            problem: problem.to_string(),
        };
        // `.` and `..` have a name only after resolution.
        let resolved = folder.canonicalize().map_err(refused)?;
        if let Some(other) =
            rigs.iter().find(|rig| rig.folder.canonicalize().is_ok_and(|own| own == resolved))
        {
            let problem = std::io::Error::other(format!("is the rig {} again", other.folder.display()));
            return Err(refused(problem));
        }
        let case = Case::read(folder).map_err(refused)?;
        let base = resolved.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let taken = |name: &str| rigs.iter().any(|rig| rig.name == name);
        let mut name = base.clone();
        for count in 2.. {
            if !taken(&name) {
                break;
            }
            name = format!("{base}-{count}");
        }
        rigs.push(Rig { name, folder: folder.clone(), case });
    }
    Ok(rigs)
}

/// Diagnoses one rig in a run folder of its own, or reads the finished answer from it.
fn answered(
    arguments: &DiagnoseArguments,
    rig: &Rig,
    out: &Path,
    threads: usize,
) -> Result<(AnsweredRig, String), TrainerError> {
    let question = Question::read(&rig.case.records, &rig.case.nominal, &arguments.reading.plain())?;
    let asked = kept::asked(arguments, &question);
    let folder = RunFolder::resume_on(&Disk::default(), &out.join(&rig.name))?;
    let result = match kept::finished(&folder, &asked)? {
        Some(result) => result,
        None => {
            let answer = question.answer(&arguments.settings(), arguments.seed)?;
            kept::keep(&folder, &question, &asked, &answer, threads)?;
            answer.result
        }
    };
    let folder = rig.folder.display().to_string();
    Ok((AnsweredRig { name: rig.name.clone(), folder, result }, question.digests()))
}
