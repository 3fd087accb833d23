//! Script of a Slurm job array.

use std::path::Path;

/// Option of `sbatch`, as in a line of the script.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct SlurmOption(String);

/// Options that follow from other options of this program, and those to use instead.
const OWN: [(&str, &str); 2] = [("array", "--shards and --slurm-at-once"), ("parsable", "--json")];

impl SlurmOption {
    /// Parses `NAME=VALUE`, or `NAME` for an option without a value; dashes before the name are allowed.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let text = line(text)?;
        let text = text.trim_start_matches('-');
        let name = text.split('=').next().unwrap_or(text);
        if name.len() < 2 || !name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-') {
            return Err("expected the long name of an option of sbatch, such as partition=long".to_owned());
        }
        if let Some((_, instead)) = OWN.iter().find(|(own, _)| *own == name) {
            return Err(format!("is set by the program: use {instead}"));
        }
        Ok(Self(text.to_owned()))
    }

    /// Returns the option's text; a value that contains spaces is put in double quotes.
    fn text(&self) -> String {
        match self.0.split_once('=') {
            Some((name, value)) if value.contains(char::is_whitespace) => {
                format!("{name}={}", double_quoted(value))
            }
            _ => self.0.clone(),
        }
    }
}

/// Checks that a text is a single, non-empty line.
pub(super) fn line(text: &str) -> Result<String, String> {
    match text.trim() {
        "" => Err("expected some words".to_owned()),
        text if text.contains(['\n', '\r']) => {
            Err("expected one line; give the option once for each".to_owned())
        }
        text => Ok(text.to_owned()),
    }
}

/// Content of the script.
pub(super) struct Script<'a> {
    /// Name of the job.
    pub(super) name: &'a str,
    pub(super) program: &'a Path,
    /// Words of the program's command line, without those of the share.
    pub(super) words: &'a [String],
    /// Folder to which relative paths refer.
    pub(super) here: &'a Path,
    /// Folder below which the logs are written.
    pub(super) folder: &'a Path,
    pub(super) shares: usize,
    /// Tasks of the first array, in the form of `--array`.
    pub(super) array: String,
    pub(super) threads: u16,
    pub(super) options: &'a [SlurmOption],
    pub(super) setup: &'a [String],
    pub(super) prefix: Option<&'a str>,
}

impl Script<'_> {
    /// Returns the text of the script. A task works on the share whose number is the task's index plus the
    /// script's first argument. A task that Slurm requeues continues with the missing parts of its share, and
    /// appends to its log.
    pub(super) fn text(&self) -> String {
        let safe = |c: char| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '-' };
        let name: String = self.name.chars().map(safe).collect();
        let log = format!("{}/slurm/%A_%a.log", self.folder.display().to_string().replace('%', "%%"));
        let mut lines = vec![
            "#!/bin/sh".to_owned(),
            format!("#SBATCH --job-name={name}"),
            format!("#SBATCH --array={}", self.array),
            format!("#SBATCH --cpus-per-task={}", self.threads),
            format!("#SBATCH --output={}", double_quoted(&log)),
            "#SBATCH --open-mode=append".to_owned(),
            "#SBATCH --requeue".to_owned(),
        ];
        lines.extend(self.options.iter().map(|option| format!("#SBATCH --{}", option.text())));
        lines.push(format!("cd {} || exit 2", quoted(&self.here.display().to_string())));
        lines.extend(self.setup.iter().cloned());
        let words: Vec<String> = std::iter::once(&self.program.display().to_string())
            .chain(self.words)
            .map(|word| quoted(word))
            .collect();
        let prefix = self.prefix.map(|prefix| format!("{prefix} ")).unwrap_or_default();
        let (words, shares, threads) = (words.join(" "), self.shares, self.threads);
        lines.push(format!(
            "exec {prefix}{words} --shard \"$((SLURM_ARRAY_TASK_ID + ${{1:-0}}))/{shares}\" --as-task --threads {threads}"
        ));
        lines.join("\n") + "\n"
    }
}

/// Quotes a word for a shell, whatever its content.
pub(super) fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=:,+@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}

/// Quotes a text for `#SBATCH` lines, which accept double quotes only.
fn double_quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\\\""))
}

#[cfg(test)]
mod tests {
    use super::{Script, SlurmOption, line, quoted};
    use std::path::Path;

    #[test]
    fn a_word_survives_the_shell() {
        for word in ["plain", "a b", "it's", "$HOME `x` \"y\" \\", ""] {
            let output = std::process::Command::new("sh")
                .args(["-c", &format!("printf %s {}", quoted(word))])
                .output()
                .unwrap();
            assert_eq!(String::from_utf8(output.stdout).unwrap(), word);
        }
    }

    #[test]
    fn the_script_has_one_task_for_each_share_and_what_the_cluster_asks_for() {
        let option = |text| SlurmOption::parse(text).unwrap();
        let options = [option("partition=long"), option("--comment=two words"), option("exclusive")];
        let script = Script {
            name: "a sweep",
            program: Path::new("/opt/it's/trainer"),
            words: &["sweep".to_owned(), "--out".to_owned(), "/data/100 %".to_owned()],
            here: Path::new("/home/me"),
            folder: Path::new("/data/100 %"),
            shares: 4,
            array: "1-4%2".to_owned(),
            threads: 2,
            options: &options,
            setup: &["module load gcc".to_owned()],
            prefix: Some("apptainer exec image.sif"),
        };
        let script = script.text();
        let expected = [
            "#!/bin/sh",
            "#SBATCH --job-name=a-sweep",
            "#SBATCH --array=1-4%2",
            "#SBATCH --cpus-per-task=2",
            "#SBATCH --output=\"/data/100 %%/slurm/%A_%a.log\"",
            "#SBATCH --open-mode=append",
            "#SBATCH --requeue",
            "#SBATCH --partition=long",
            "#SBATCH --comment=\"two words\"",
            "#SBATCH --exclusive",
            "cd /home/me || exit 2",
            "module load gcc",
            "exec apptainer exec image.sif '/opt/it'\\''s/trainer' sweep --out '/data/100 %' \
             --shard \"$((SLURM_ARRAY_TASK_ID + ${1:-0}))/4\" --as-task --threads 2",
        ];
        assert_eq!(script.lines().collect::<Vec<_>>(), expected);
    }

    #[test]
    fn what_is_no_option_of_sbatch_is_refused() {
        for (text, says) in [
            ("", "some words"),
            ("p long", "long name"),
            ("-p", "long name"),
            ("array=1-9", "--shards and --slurm-at-once"),
            ("time=1\nrm", "one line"),
        ] {
            let refused = SlurmOption::parse(text).unwrap_err();
            assert!(refused.contains(says), "{text}: {refused}");
        }
        assert!(line("one\ntwo").unwrap_err().starts_with("expected one line"));
    }
}
