//! Tests of submitting shares to Slurm, with stand-ins for its programs; the tests in `slurm::` use a real
//! one.

use crate::support::root;
use crate::sweep::{code, said, scratch, states};
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

/// Submits a sweep of five runs to Slurm in three shares, with the given search path for programs.
fn launch(out: &str, path: &str, options: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_trainer"))
        .args(["sweep", "configs/ols.toml", "seed=0..4", "--out", out, "--launcher", "slurm"])
        .args([&["--shards", "3"], options].concat())
        .env("PATH", path)
        .current_dir(root())
        .output()
        .unwrap()
}

/// Folder for stand-ins of Slurm's programs, used as the only search path.
#[cfg(unix)]
struct Tools(TempDir);

#[cfg(unix)]
impl Tools {
    fn path(&self) -> &str {
        self.0.path().to_str().unwrap()
    }

    fn set(&self, name: &str, text: &str) {
        use std::os::unix::fs::PermissionsExt;
        let program = self.0.path().join(name);
        std::fs::write(&program, format!("#!/bin/sh\n{text}")).unwrap();
        std::fs::set_permissions(&program, std::fs::Permissions::from_mode(0o755)).unwrap();
    }
}

/// Stand-in for `sbatch` that runs the tasks of an array at once; a job's number is that of its first share.
#[cfg(unix)]
const SBATCH: &str = "for word; do script=$offset; offset=$word; case $word in --array=1-*) tasks=${word#--array=1-};; esac; done\n\
                      tasks=${tasks%%%*}; task=1\n\
                      while [ $task -le $tasks ]; do\n\
                      SLURM_ARRAY_TASK_ID=$task /bin/sh \"$script\" \"$offset\" >/dev/null 2>&1 || exit 1; task=$((task + 1)); done\n\
                      echo \"$((offset + 1));cluster\"\n";

/// Tests a machine without Slurm, one whose `sbatch` refuses, and one whose `sbatch` runs the tasks at once.
#[cfg(unix)]
#[test]
fn a_slurm_array_has_one_task_for_each_share() {
    let (_folder, out) = scratch();
    let tools = Tools(tempfile::tempdir().unwrap());
    let absent = launch(&out, tools.path(), &[]);
    assert_eq!(code(&absent), 2);
    assert!(said(&absent).contains("there is no sbatch on this machine"), "{}", said(&absent));
    assert!(said(&absent).contains("submit it with: sbatch --parsable --array=1-3 "), "{}", said(&absent));
    let script = Path::new(&out).join("slurm.sh");
    assert!(script.is_file() && states(&out) == ["pending"; 5]);

    // An option that was refused is not advised again.
    tools.set("sbatch", "echo 'invalid partition' >&2\nexit 1\n");
    let refused = launch(&out, tools.path(), &["--resume"]);
    assert_eq!(code(&refused), 2);
    let message = said(&refused);
    assert!(
        message.contains("sbatch refused ") && message.contains("slurm.sh: invalid partition."),
        "{message}"
    );
    assert!(
        message.contains("--slurm-option NAME=VALUE") && !message.contains("sbatch --parsable"),
        "{message}"
    );

    tools.set("sbatch", SBATCH);
    let submitted = launch(&out, tools.path(), &["--resume", "--json", "--slurm-option", "partition=long"]);
    assert_eq!(code(&submitted), 0, "{}", said(&submitted));
    let told: Value = serde_json::from_slice(&submitted.stdout).unwrap();
    assert_eq!((&told["schema"], &told["shares"]), (&"ringdown.launch/1".into(), &3.into()));
    assert_eq!((&told["arrays"][0]["job"], &told["submitted"]), (&1.into(), &true.into()));
    let text = std::fs::read_to_string(&script).unwrap();
    assert!(text.contains("#SBATCH --array=1-3\n") && text.contains("#SBATCH --partition=long\n"), "{text}");
    assert!(text.contains("#SBATCH --open-mode=append\n"), "{text}");
    assert_eq!(states(&out), ["done"; 5]);
}

/// The largest index of an array is one less than the cluster's `MaxArraySize`.
#[cfg(unix)]
#[test]
fn more_shares_than_an_array_may_have_are_several_arrays() {
    let (_folder, out) = scratch();
    let tools = Tools(tempfile::tempdir().unwrap());
    tools.set("scontrol", "echo 'MaxArraySize            = 3'\n");
    let options = ["--shards", "5", "--slurm-at-once", "1", "--json"];
    let launch = |options: &[&str]| {
        let arguments =
            [&["sweep", "configs/ols.toml", "seed=0..4", "--out", &out, "--launcher", "slurm"], options]
                .concat();
        let output = Command::new(env!("CARGO_BIN_EXE_trainer"))
            .args(arguments)
            .env("PATH", tools.path())
            .current_dir(root())
            .output()
            .unwrap();
        assert_eq!(code(&output), 0, "{}", said(&output));
        serde_json::from_slice::<Value>(&output.stdout).unwrap()
    };
    // With `--write-only` nothing is submitted, and there is no job number yet.
    let written = launch(&[&options[..], &["--write-only"]].concat());
    assert_eq!((&written["submitted"], &written["arrays"][2]["job"]), (&false.into(), &Value::Null));
    assert_eq!(states(&out), ["pending"; 5]);

    tools.set("sbatch", SBATCH);
    let submitted = launch(&[&options[..], &["--resume"]].concat());
    let arrays = submitted["arrays"].as_array().unwrap();
    let of = |name: &str| arrays.iter().map(|array| array[name].as_u64().unwrap()).collect::<Vec<_>>();
    assert_eq!((of("job"), of("tasks"), of("first_share")), (vec![1, 3, 5], vec![2, 2, 1], vec![1, 3, 5]));
    let last = arrays[2]["command"].as_str().unwrap();
    assert!(
        last.starts_with("sbatch --parsable --array=1-1%1 --dependency=afterany:3 ") && last.ends_with(" 4"),
        "{last}"
    );
    assert_eq!(states(&out), ["done"; 5]);
}
