//! Page of a fleet: the diagnoses of a batch side by side.

#[cfg(test)]
mod tests;

use askama::Template;
use results::{FailedCase, FleetCase, FleetGroup, FleetNumber, FleetOutlier, FleetResult, VerdictStatus};

use crate::classes::{capitalized, class_title, listed};
use crate::format::{probability, quantity, share, significant, unit};
use crate::frame::{Frame, finish};
use crate::tables::whole;
use crate::verdict::{self, Origin, Tone, Verdict};
use crate::{ReportError, RunTexts};

/// Largest number of table rows on the page; `fleet.json` has all rows.
const MOST_ROWS: usize = 5_000;
/// Largest number of outliers, and of failures, on the page.
const MOST_OUTLIERS: usize = 200;
/// Probability from which on a class is likely.
const LIKELY: f64 = 0.5;

#[derive(Template)]
#[template(path = "fleet.html")]
struct FleetPage<'a> {
    frame: Frame<'a>,
    classes: Vec<ClassView>,
    /// Column titles of the table by label.
    titles: Vec<String>,
    groups: Vec<GroupView<'a>>,
    outliers: Vec<OutlierView<'a>>,
    more_outliers: usize,
    labels: &'a [String],
    cases: Vec<CaseView<'a>>,
    shortened: String,
    failed: &'a [FailedCase],
    more_failed: usize,
}

/// Counts of a class of effects over all cases.
struct ClassView {
    title: String,
    likely: String,
    certain: String,
    of_cases: String,
    /// Length of the bar in percent.
    bar: String,
    gap_share: String,
}

/// Cases with the same value of a label.
struct GroupView<'a> {
    label: &'a str,
    value: &'a str,
    cases: String,
    cells: Vec<String>,
}

struct OutlierView<'a> {
    case: &'a str,
    link: String,
    name: String,
    value: String,
    median: String,
    of: String,
    score: String,
}

/// A case in its row.
struct CaseView<'a> {
    id: &'a str,
    link: String,
    labels: Vec<&'a str>,
    status: &'static str,
    tone: &'static str,
    /// Likely classes with their probabilities, the most probable first.
    effects: String,
    origin: &'static str,
    over_noise: String,
    closure: String,
    nameless: String,
}

pub(crate) fn render(texts: &RunTexts<'_>, result: &FleetResult) -> Result<String, ReportError> {
    let shown = result.cases.len().min(MOST_ROWS);
    let ids: Vec<&str> =
        result.classes.iter().filter(|class| class.likely > 0).map(|class| class.id.as_str()).collect();
    finish(&FleetPage {
        frame: Frame {
            warnings: warnings(result),
            files: [
                ("Configuration", ""),
                ("Environment", ""),
                ("Every number, unrounded (fleet.json)", FILE_NOTE),
            ],
            ..Frame::bare(
                texts,
                "a fleet: the answers of a batch side by side",
                headline(result),
                origin(result),
            )
        },
        classes: classes(result),
        titles: ids.iter().map(|id| capitalized(&class_title(id))).collect(),
        groups: result.groups.iter().map(|own| group(own, &ids)).collect(),
        outliers: result.outliers.iter().take(MOST_OUTLIERS).map(outlier).collect(),
        more_outliers: result.outliers.len().saturating_sub(MOST_OUTLIERS),
        labels: &result.labels,
        cases: result.cases.iter().take(shown).map(|own| case(own, &result.labels)).collect(),
        shortened: if shown < result.cases.len() {
            format!("The first {} of {} cases; fleet.json has all.", whole(shown), whole(result.cases.len()))
        } else {
            String::new()
        },
        failed: result.failed.get(..MOST_OUTLIERS).unwrap_or(&result.failed),
        more_failed: result.failed.len().saturating_sub(MOST_OUTLIERS),
    })
}

/// Note that replaces a file of several megabytes.
const FILE_NOTE: &str = "The file stands beside this page.";

fn headline(result: &FleetResult) -> Verdict {
    let of = |status: VerdictStatus| result.cases.iter().filter(|case| case.status == status).count();
    let all = result.cases.len();
    let common: Vec<String> = result
        .classes
        .iter()
        .filter(|class| class.likely > 0)
        .take(3)
        .map(|class| format!("{} in {}", class_title(&class.id), whole(class.likely)))
        .collect();
    let common = if common.is_empty() {
        "No class of effects is likely in any of them.".to_owned()
    } else {
        format!("Most often: {}.", listed(&common, "and"))
    };
    let is_whole = result.failed.is_empty();
    Verdict {
        tone: if is_whole { Tone::Good } else { Tone::Caution },
        label: if is_whole { "What the fleet lacks" } else { "What the fleet lacks, as far as it answered" },
        sentence: format!(
            "Of {} diagnoses, {} name effects, {} find only wrong coefficients, {} find nothing beyond the \
             noise, and {} find a gap that no known effect explains. {common}",
            whole(all),
            whole(of(VerdictStatus::Effect)),
            whole(of(VerdictStatus::Calibration)),
            whole(of(VerdictStatus::None)),
            whole(of(VerdictStatus::Unknown)),
        ),
    }
}

/// Returns the origin of the records, if all share it.
fn origin(result: &FleetResult) -> Origin {
    let stated = result.cases.iter().map(|case| case.origin);
    verdict::origin_of_all(
        stated,
        Some("Some were measured; others were simulated or have no stated origin: see the table of cases."),
    )
}

fn warnings(result: &FleetResult) -> Vec<String> {
    match result.failed.len() {
        0 => Vec::new(),
        1 => vec!["One case gave no answer; the reason stands below.".to_owned()],
        failed => vec![format!("{} cases gave no answer; the reasons stand below.", whole(failed))],
    }
}

fn classes(result: &FleetResult) -> Vec<ClassView> {
    let all = result.cases.len().max(1) as f64;
    let view = |class: &results::FleetClass| ClassView {
        title: capitalized(&class_title(&class.id)),
        likely: whole(class.likely),
        certain: whole(class.certain),
        of_cases: share(class.likely as f64 / all),
        bar: format!("{:.1}", 100.0 * class.likely as f64 / all),
        gap_share: class.gap_share.map_or_else(absent, share),
    };
    result.classes.iter().filter(|class| class.likely > 0).map(view).collect()
}

fn group<'a>(group: &'a FleetGroup, ids: &[&str]) -> GroupView<'a> {
    let cell = |id: &&str| group.likely.get(*id).map_or_else(|| "0".to_owned(), |likely| whole(*likely));
    GroupView {
        label: &group.label,
        value: &group.value,
        cases: whole(group.cases),
        cells: ids.iter().map(cell).collect(),
    }
}

fn outlier(outlier: &FleetOutlier) -> OutlierView<'_> {
    let said = |value: f64| quantity(&significant(value, 3), unit(&outlier.unit));
    OutlierView {
        case: &outlier.case,
        link: link(&outlier.case),
        name: outlier.name.replace(['_', '.'], " "),
        value: said(outlier.value),
        median: said(outlier.median),
        of: whole(outlier.of),
        score: significant(outlier.score, 2),
    }
}

fn case<'a>(case: &'a FleetCase, labels: &[String]) -> CaseView<'a> {
    let number = |name: &str| case.numbers.get(name).map(|number: &FleetNumber| number.value);
    let mut likely: Vec<(&String, f64)> =
        case.classes.iter().map(|(id, own)| (id, *own)).filter(|(_, own)| *own >= LIKELY).collect();
    likely.sort_by(|one, other| other.1.total_cmp(&one.1));
    let effects: Vec<String> =
        likely.into_iter().map(|(id, own)| format!("{} {}", class_title(id), probability(own))).collect();
    let (status, tone) = match case.status {
        VerdictStatus::None => ("nothing missing", "good"),
        VerdictStatus::Calibration => ("calibration", "good"),
        VerdictStatus::Effect => ("effects", "caution"),
        VerdictStatus::Unknown => ("unexplained", "bad"),
    };
    CaseView {
        id: &case.id,
        link: link(&case.id),
        labels: labels.iter().map(|label| case.labels.get(label).map_or("–", String::as_str)).collect(),
        status,
        tone,
        effects: if effects.is_empty() { absent() } else { effects.join(", ") },
        origin: case.origin.name(),
        over_noise: number(FleetNumber::OVER_NOISE).map_or_else(absent, |value| significant(value, 3)),
        closure: number(FleetNumber::CLOSURE).map_or_else(absent, share),
        nameless: number(FleetNumber::NAMELESS).map_or_else(absent, share),
    }
}

fn absent() -> String {
    "–".to_owned()
}

/// Returns the address of a case's diagnosis, relative to this page.
fn link(id: &str) -> String {
    format!("{}/diagnosis.json", crate::rigs::encoded(id))
}
