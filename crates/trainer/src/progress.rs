//! Progress: bars on a terminal, plain lines elsewhere.

use crate::console;
use estimator::{Observer, Step};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use runs::result::{SeedRow, TraceRow};
use std::io::IsTerminal;
use std::sync::Mutex;

/// Progress over the seeds of an experiment.
pub(crate) struct Progress {
    bar: ProgressBar,
    seeds: u64,
    lines: bool,
}

impl Progress {
    pub(crate) fn new(seeds: u64, quiet: bool) -> Self {
        let terminal = std::io::stderr().is_terminal();
        let bar = ProgressBar::with_draw_target(Some(seeds), ProgressDrawTarget::hidden());
        if terminal && !quiet {
            bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        let unit = if seeds == 1 { "steps" } else { "seeds" };
        let template = format!("{{bar:30}} {{pos}}/{{len}} {unit}, {{eta}} left  {{msg}}");
        if let Ok(style) = ProgressStyle::with_template(&template) {
            bar.set_style(style);
        }
        Self { bar, seeds, lines: !terminal && !quiet }
    }

    /// A step of the only seed. With several seeds the bar counts those.
    fn step(&self, step: &Step) {
        if self.seeds == 1 {
            self.bar.set_length(step.planned);
            self.bar.set_position(step.step);
            self.bar.set_message(format!("loss {:.3e}, λ {:.9} 1/s", step.loss, step.decay_rate));
        }
    }

    /// A seed that is done.
    pub(crate) fn seed_done(&self, row: &SeedRow) {
        if self.seeds > 1 {
            self.bar.inc(1);
            self.bar.set_message(format!("seed {}: {:.1e} %", row.seed, row.error_percent));
        }
        if self.lines {
            console::remark(&format!(
                "seed {}: {} after {} steps, {:.2} s, error {:.1e} %",
                row.seed, row.reached, row.steps, row.seconds, row.error_percent
            ));
        }
    }

    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// Watches one fit: keeps its trace and moves the bar.
pub(crate) struct Watcher<'a> {
    progress: &'a Progress,
    trace: Mutex<Vec<TraceRow>>,
}

impl<'a> Watcher<'a> {
    pub(crate) fn new(progress: &'a Progress) -> Self {
        Self { progress, trace: Mutex::default() }
    }

    pub(crate) fn into_trace(self) -> Vec<TraceRow> {
        self.trace.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

impl Observer for Watcher<'_> {
    fn observe(&self, step: &Step) {
        self.progress.step(step);
        let mut trace = self.trace.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        trace.push(TraceRow {
            step: step.step,
            phase: step.phase.clone(),
            loss: step.loss,
            decay_rate: step.decay_rate,
        });
    }
}
