//! Page of a robot: its joints, what each lacks, and the whole model against recordings.

use askama::Template;
use results::{FailedCase, JointRow, JointsResult, RecordingRow, WithInterval};

use crate::classes::{Standing, capitalized, class_statements};
use crate::format::{self, estimate, quantity, significant, unit};
use crate::frame::{Frame, finish};
use crate::rigs::encoded;
use crate::verdict::{self, Origin, Tone, Verdict};
use crate::{ReportError, RunTexts};

#[derive(Template)]
#[template(path = "joints.html")]
struct JointsPage<'a> {
    frame: Frame<'a>,
    joints: Vec<JointView<'a>>,
    failed: &'a [FailedCase],
    errors: Vec<ErrorView<'a>>,
    held_out: String,
    untold: Vec<String>,
    recordings: Vec<RecordingView<'a>>,
    notes: &'a [String],
}

/// A class of effects that a joint lacks.
struct MissingView {
    title: String,
    standing: &'static str,
    probability: String,
    sentence: String,
}

/// A joint.
struct JointView<'a> {
    name: &'a str,
    /// Address of its page, relative to this one.
    link: String,
    summary: &'a str,
    missing: Vec<MissingView>,
    closes: String,
    armature: String,
    damping: String,
    offset: String,
    gain: String,
    frequency: String,
}

/// Errors of the whole model at one joint.
struct ErrorView<'a> {
    joint: &'a str,
    nominal: String,
    recalibrated: String,
    repaired: String,
    floor: String,
}

/// A recording.
struct RecordingView<'a> {
    path: &'a str,
    duration: String,
    samples: usize,
    role: &'static str,
    /// Quantities that differ from the other recordings; empty if none does.
    differs: String,
}

pub(crate) fn render(texts: &RunTexts<'_>, result: &JointsResult) -> Result<String, ReportError> {
    let untold = result.identifiable.iter().filter(|row| !row.told);
    finish(&JointsPage {
        frame: Frame {
            files: [
                ("Configuration", ""),
                ("Environment (environment.json)", texts.environment),
                ("Every number, unrounded (joints.json)", texts.result),
            ],
            ..Frame::bare(
                texts,
                "a robot: its joints one by one, and the whole model",
                headline(result),
                origin(result),
            )
        },
        joints: result.joints.iter().map(joint).collect(),
        failed: &result.failed,
        errors: errors(result),
        held_out: result.closed_loop.as_ref().map_or_else(String::new, |found| {
            format!(
                "Runs of {} s from the measured state, under the recorded torques. Checked with {}.",
                significant(found.span_s, 2),
                found.held_out
            )
        }),
        untold: untold
            .map(|row| format!("{} of {}: record {}", row.quantity.replace('_', " "), row.joint, row.record))
            .collect(),
        recordings: result.recordings.iter().map(recording).collect(),
        notes: &result.notes,
    })
}

/// Returns the classes that a joint certainly or likely lacks, in words.
fn named(joint: &JointRow) -> Vec<String> {
    let likely = |standing: Standing| matches!(standing, Standing::Certain | Standing::Likely);
    let statements = class_statements(&joint.diagnosis);
    statements.into_iter().filter(|one| likely(one.standing)).map(|one| one.title.to_lowercase()).collect()
}

fn headline(result: &JointsResult) -> Verdict {
    let of = |joint: &JointRow| {
        let named = named(joint);
        let lacks = if named.is_empty() {
            "nothing that can be named".to_owned()
        } else {
            crate::classes::listed(&named, "and")
        };
        format!("{}: {lacks}", joint.name)
    };
    let sentences: Vec<String> = result.joints.iter().map(of).collect();
    let is_whole = result.failed.is_empty();
    Verdict {
        tone: if is_whole { Tone::Good } else { Tone::Caution },
        label: if is_whole {
            "What the joints lack"
        } else {
            "What the joints lack, as far as they answered"
        },
        sentence: format!("{}.", sentences.join("; ")),
    }
}

fn origin(result: &JointsResult) -> Origin {
    let records = result.joints.iter().flat_map(|joint| &joint.diagnosis.records);
    verdict::origin_of_all(records.map(|row| row.origin), None)
}

fn with_unit(own: Option<WithInterval>, symbol: &str) -> String {
    own.map_or_else(|| "–".to_owned(), |own| estimate(own.value, own.interval_95, unit(symbol)))
}

fn joint(row: &JointRow) -> JointView<'_> {
    let [inertia, damping, torque] = match row.diagnosis.gap.unit.as_str() {
        "m" => ["kg", "N s/m", "N"],
        _ => ["kg m^2", "N m s/rad", "N m"],
    };
    let missing = class_statements(&row.diagnosis).into_iter().map(|one| MissingView {
        title: capitalized(&one.title),
        standing: one.standing.word(),
        probability: format::probability(one.class.probability),
        sentence: one.sentence,
    });
    JointView {
        name: &row.name,
        link: format!("{}/report.html", encoded(&row.name)),
        summary: &row.diagnosis.verdict.summary,
        missing: missing.collect(),
        closes: format::share_with_interval(&row.diagnosis.gap.closure),
        armature: with_unit(row.repair.armature, inertia),
        damping: with_unit(row.repair.damping, damping),
        offset: with_unit(row.repair.torque_offset, torque),
        gain: with_unit(row.repair.torque_gain, "1"),
        frequency: quantity(&significant(row.tracking.frequency_hz, 2), "Hz"),
    }
}

fn errors(result: &JointsResult) -> Vec<ErrorView<'_>> {
    let rows = result.joints.iter().filter_map(|joint| Some((&joint.name, joint.closed_loop.as_ref()?)));
    let views = rows.map(|(joint, row)| {
        let cell = |own: Option<f64>| {
            own.map_or_else(
                || "left every bound".to_owned(),
                |own| quantity(&significant(own, 3), unit(&row.unit)),
            )
        };
        let (nominal, recalibrated) = (cell(row.nominal), cell(row.recalibrated));
        let (repaired, floor) = (cell(row.repaired), cell(Some(row.noise_floor)));
        ErrorView { joint, nominal, recalibrated, repaired, floor }
    });
    views.collect()
}

fn recording(row: &RecordingRow) -> RecordingView<'_> {
    RecordingView {
        path: &row.path,
        duration: quantity(&significant(row.duration_s, 3), "s"),
        samples: row.samples,
        role: if row.fitted { "fitted" } else { "checked only" },
        differs: row.differs_in.join(", "),
    }
}
