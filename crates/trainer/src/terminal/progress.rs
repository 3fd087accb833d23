//! Progress: bars on a terminal, plain lines elsewhere.

use crate::terminal::console;
use estimator::Step;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use record::two_digits;
use results::SeedRow;
use std::fmt::Display;
use std::io::IsTerminal;
use std::time::Duration;

/// Time between two redraws of a stage in progress.
const TICK: Duration = Duration::from_millis(200);

/// Progress over the fits of an experiment or, with a single fit, over its steps.
pub(crate) struct Progress {
    bar: ProgressBar,
    unit: &'static str,
    counts_steps: bool,
    lines: bool,
}

impl Progress {
    /// Creates the progress over the steps of one seed, or over several seeds.
    pub(crate) fn over_seeds(seeds: u64, quiet: bool) -> Self {
        let unit = if seeds == 1 { "steps" } else { "seeds" };
        Self::new(seeds, unit, seeds == 1, quiet)
    }

    /// Creates the progress over `count` items of a kind, such as `"fits"`.
    pub(crate) fn over(count: u64, unit: &'static str, quiet: bool) -> Self {
        Self::new(count, unit, false, quiet)
    }

    fn new(length: u64, unit: &'static str, counts_steps: bool, quiet: bool) -> Self {
        let terminal = std::io::stderr().is_terminal();
        let bar = ProgressBar::with_draw_target(Some(length), ProgressDrawTarget::hidden());
        if terminal && !quiet {
            bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        let template = format!("{{bar:30}} {{pos}}/{{len}} {unit}, {{eta}} left  {{wide_msg}}");
        if let Ok(style) = ProgressStyle::with_template(&template) {
            bar.set_style(style);
        }
        Self { bar, unit, counts_steps, lines: !terminal && !quiet }
    }

    /// Creates the progress over stages of unknown duration: shows the current stage and the time elapsed.
    pub(crate) fn over_stages(first: &'static str, quiet: bool) -> Self {
        let progress = Self::new(0, "stages", false, quiet);
        if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed}  {wide_msg}") {
            progress.bar.set_style(style);
        }
        progress.stage(first);
        if !progress.bar.is_hidden() {
            progress.bar.enable_steady_tick(TICK);
        }
        progress
    }

    /// Starts the next stage.
    pub(crate) fn stage(&self, now: &'static str) {
        self.bar.set_message(now);
    }

    /// Reports a step of the only fit.
    pub(crate) fn step(&self, step: &Step) {
        if self.counts_steps {
            self.bar.set_length(step.planned);
            self.bar.set_position(step.step);
            self.bar.set_message(format!("loss {:.3e}, λ {:.9} 1/s", step.loss, step.decay_rate));
        }
    }

    /// Reports a finished fit, or the reason why it failed.
    pub(crate) fn fit_done<E: Display>(&self, method: &str, seed: u64, fit: Result<&SeedRow, E>) {
        let line = match fit {
            Ok(row) => format!(
                "{method}, seed {seed}: {} after {}, {:.2} s, error {} %",
                row.reached.in_words(),
                record::counted(row.steps as usize, "step"),
                row.seconds,
                two_digits(row.error_percent)
            ),
            Err(error) => format!("{method}, seed {seed}: FAILED: {error}"),
        };
        if self.lines {
            console::remark(&line);
        }
        if !self.counts_steps {
            self.bar.inc(1);
            self.bar.set_message(line);
        }
    }

    /// Reports the end of a run.
    pub(crate) fn run_done(&self, said: &str) {
        self.bar.inc(1);
        if self.lines {
            let (done, all) = self.place();
            console::remark(&format!("{done} of {all}: {said}"));
        }
        self.bar.set_message(said.to_owned());
    }

    /// Returns the number of finished items and the total number.
    fn place(&self) -> (u64, u64) {
        (self.bar.position(), self.bar.length().unwrap_or(0))
    }

    /// Reports one more of very many items as done; prints a line for every tenth of them.
    pub(crate) fn one_of_many_done(&self) {
        self.bar.inc(1);
        let (done, all) = self.place();
        if self.lines && all > 0 && done * 10 / all > (done - 1) * 10 / all {
            console::remark(&format!("{done} of {all} {}", self.unit));
        }
    }

    /// Sets the number of finished items among very many; prints a line whenever another tenth of them is
    /// done.
    pub(crate) fn so_many_done(&self, done: u64) {
        let (before, all) = self.place();
        self.bar.set_position(done);
        if self.lines && all > 0 && done * 10 / all > before * 10 / all {
            console::remark(&format!("{done} of {all} {}", self.unit));
        }
    }

    /// Prints something without disturbing the bar.
    pub(crate) fn aside(&self, print: impl FnOnce()) {
        self.bar.suspend(print);
    }

    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
