//! Tables of a diagnosis: cells, and the number of their digits.

use results::{CalibratedRow, DISTINCT_DISTANCE, DiagnosisResult, RecordRow, VerdictStatus, WithInterval};

use crate::classes::effect_title;
use crate::format::{
    self, UNDETERMINED, estimate, fixed, interval, quantity, share_with_interval, significant, unit,
};
use crate::remarks::read_as;
use crate::tables::{Fact, fact, whole};

/// A simulator with its error.
pub(super) struct GapView {
    pub(super) name: &'static str,
    pub(super) meaning: &'static str,
    pub(super) rms: String,
    pub(super) floors: String,
    /// Length of the bar in percent of the longest, on a logarithmic scale starting at the smallest error;
    /// `None` if all errors are about equal.
    pub(super) bar: Option<String>,
}

/// Smallest logarithm of the ratio of the largest to the smallest error for which bars are drawn.
const LEAST_SPAN: f64 = 0.1;

pub(super) fn gap(result: &DiagnosisResult) -> Vec<GapView> {
    let gap = &result.gap;
    let unnamed = result.row(VerdictStatus::Unknown).is_some_and(|row| row.gap_share.is_some());
    let with =
        if unnamed { "with the named effects and an unexplained torque" } else { "with the named effects" };
    let rows = [
        ("simulator as given", "only its start states fitted", gap.nominal),
        ("recalibrated", "its coefficients fitted, no effect added", gap.recalibrated),
        ("repaired", with, gap.repaired),
        ("ceiling", "with a free torque added: the best that any further effect could reach", gap.ceiling),
        ("noise floor", "estimated from the white part of the residual", gap.noise_floor),
    ];
    let least = rows.iter().map(|row| row.2).filter(|rms| *rms > 0.0).fold(f64::INFINITY, f64::min);
    let most = rows.iter().map(|row| row.2).fold(0.0, f64::max);
    // Simulators with equal errors get no bars: on a logarithmic scale with hardly any span, a tiny
    // difference would fill the whole length.
    let span = (most / least).ln();
    let is_drawn = span > LEAST_SPAN;
    rows.into_iter()
        .map(|(name, meaning, rms)| {
            let share = if is_drawn && rms > 0.0 { (rms / least).ln() / span } else { 0.0 };
            GapView {
                name,
                meaning,
                rms: quantity(&significant(rms, 3), &gap.unit),
                floors: if gap.noise_floor > 0.0 {
                    significant(rms / gap.noise_floor, 3)
                } else {
                    "–".to_owned()
                },
                bar: is_drawn.then(|| format!("{:.1}", 4.0 + 96.0 * share.clamp(0.0, 1.0))),
            }
        })
        .collect()
}

pub(super) fn gap_notes(result: &DiagnosisResult) -> Vec<String> {
    let gap = &result.gap;
    let closed = || {
        format!(
            "Closure of the whole gap: {}; of the gap after recalibration: {}. Closure compares squared errors \
             above the noise floor, so even at 99 % the error can still be several times the noise: see the \
             column “× noise”.",
            share_with_interval(&gap.closure),
            share_with_interval(&gap.closure_of_recalibrated)
        )
    };
    let mut notes = match result.verdict.status {
        VerdictStatus::None => vec!["There is no gap to close.".to_owned()],
        _ if gap.is_closure_told() => vec![closed()],
        _ => vec!["The gap is too small compared with the noise to state its closure.".to_owned()],
    };
    let [recalibrated, repaired] = gap.last_third;
    if recalibrated.is_finite() && repaired.is_finite() {
        notes.push(format!(
            "Fitted to the first two thirds and scored on the last third: recalibrated {}, repaired {}.",
            quantity(&significant(recalibrated, 3), &gap.unit),
            quantity(&significant(repaired, 3), &gap.unit)
        ));
    }
    notes.push(format!(
        "Noise floor, 95 % interval: {} {}. Held out: {}",
        interval(gap.noise_floor_interval_95),
        gap.unit,
        gap.held_out
    ));
    notes
}

/// An effect in the table.
pub(super) struct EffectView {
    pub(super) title: String,
    pub(super) id: String,
    pub(super) probability: String,
    /// Length of the bar in percent.
    pub(super) bar: String,
    /// Coefficients, one text each.
    pub(super) coefficients: Vec<String>,
    pub(super) share: String,
    pub(super) is_named: bool,
}

pub(super) fn effects(result: &DiagnosisResult) -> Vec<EffectView> {
    result
        .effects
        .iter()
        .map(|row| EffectView {
            title: row.title.clone(),
            id: row.id.clone(),
            probability: format::probability(row.probability),
            bar: format!("{:.1}", 100.0 * row.probability.clamp(0.0, 1.0)),
            coefficients: row
                .parameters
                .iter()
                .map(|(name, parameter)| {
                    let name = name.replace('_', " ");
                    let unit = unit(&parameter.unit);
                    let all = estimate(parameter.value, parameter.interval_95, unit);
                    if parameter.determined {
                        format!("{name} = {all}")
                    } else {
                        format!("{name}: {UNDETERMINED}")
                    }
                })
                .collect(),
            share: row.gap_share.as_ref().map_or_else(|| "–".to_owned(), share_with_interval),
            is_named: result.verdict.effects.contains(&row.id),
        })
        .collect()
}

/// Returns the probability of the exact set, which trials score; `None` if nothing is named.
pub(super) fn exact_set(result: &DiagnosisResult) -> Option<String> {
    (!result.verdict.effects.is_empty()).then(|| {
        format!(
            "Probability of exactly this set of effects, with every kind correct and no other effect: {}. It \
             is low if kinds cannot be distinguished, even if the classes are certain.",
            format::share(result.verdict.confidence)
        )
    })
}

/// Returns sentences on the explanations that the data can and cannot distinguish.
pub(super) fn apart(result: &DiagnosisResult) -> Vec<String> {
    let mut sentences: Vec<String> = result
        .rivals
        .iter()
        .filter(|rival| rival.distance.is_finite())
        .take(4)
        .map(|rival| {
            let verdict = if rival.distance < DISTINCT_DISTANCE {
                "not distinguishable on these data"
            } else {
                "distinguishable on these data"
            };
            format!(
                "{} and {}: best fits {} × noise apart, {verdict}.",
                effect_title(result, &rival.effect),
                effect_title(result, &rival.rival),
                significant(rival.distance, 2)
            )
        })
        .collect();
    sentences.extend(result.detectability.iter().filter(|row| row.d.is_finite()).map(|row| {
        format!(
            "Leaving out {} worsens the fit by {} × noise.",
            effect_title(result, &row.effect),
            significant(row.d, 2)
        )
    }));
    sentences
}

pub(super) fn experiments(result: &DiagnosisResult) -> Vec<String> {
    result
        .next_experiment
        .considered
        .iter()
        .map(|(text, distance)| match distance {
            Some(distance) => format!("{text}: distance {}", significant(*distance, 2)),
            None => format!("{text}: cannot be predicted"),
        })
        .collect()
}

/// A nominal coefficient before and after recalibration and repair.
pub(super) struct CoefficientView {
    pub(super) name: String,
    pub(super) unit: String,
    pub(super) given: String,
    pub(super) recalibrated: String,
    pub(super) repaired: String,
}

pub(super) fn coefficients(result: &DiagnosisResult) -> Vec<CoefficientView> {
    let view = |(name, row): (String, &CalibratedRow)| {
        // Parameters of the simulator's own effects are held if the simulator says so.
        let held = if name.contains('.') { "held" } else { "held: these data do not determine it" };
        let estimate = |found: &Option<WithInterval>| {
            found
                .as_ref()
                .map_or_else(|| held.to_owned(), |found| estimate(found.value, found.interval_95, ""))
        };
        CoefficientView {
            name: name.replace("rest_angle", "rest position").replace('_', " ").replace('.', ": "),
            unit: row.unit.clone(),
            given: significant(row.nominal, 5),
            recalibrated: estimate(&row.recalibrated),
            repaired: match row.determined {
                Some(false) => UNDETERMINED.to_owned(),
                _ => estimate(&row.repaired),
            },
        }
    };
    result.calibration.rows().into_iter().map(view).collect()
}

pub(super) fn chain(result: &DiagnosisResult) -> Vec<Fact> {
    let chain = &result.measuring_chain;
    vec![
        fact("Clock in force", format!("{}: {}", chain.clock, chain.clock_reason)),
        fact("Sampling rate", quantity(&significant(chain.sample_rate_hz, 6), "Hz")),
        fact(
            "Resolution",
            chain.resolution.map_or_else(
                || "no quantization steps found".to_owned(),
                |step| quantity(&significant(step, 4), &result.gap.unit),
            ),
        ),
        fact("Noise, standard deviation", quantity(&significant(chain.noise, 3), &result.gap.unit)),
        fact("Samples used", format::share(result.samples_used)),
    ]
}

pub(super) fn findings(result: &DiagnosisResult) -> Vec<String> {
    result
        .measuring_chain
        .findings
        .iter()
        .map(|finding| match &finding.effect {
            Some(effect) => format!("{}: {}", effect.replace('_', " "), finding.text),
            None => finding.text.clone(),
        })
        .collect()
}

/// A record in the list.
pub(super) struct RecordView<'a> {
    pub(super) path: &'a str,
    pub(super) facts: Vec<Fact>,
    pub(super) findings: &'a [String],
}

pub(super) fn records(result: &DiagnosisResult) -> Vec<RecordView<'_>> {
    fn view(record: &RecordRow) -> RecordView<'_> {
        let RecordRow { path, digest, origin, samples, duration_s, clock, clock_reason, findings, reading } =
            record;
        let mut facts = vec![
            fact("Samples", whole(*samples)),
            fact("Length", quantity(&significant(*duration_s, 4), "s")),
            fact("Clock", format!("{clock}: {clock_reason}")),
            fact("Origin", origin.name()),
            fact("Digest", digest.as_str()),
        ];
        facts.extend(read_as(&reading.sentence).map(|text| fact("Read as", text)));
        RecordView { path, facts, findings }
    }
    result.records.iter().map(view).collect()
}

pub(super) fn stages(result: &DiagnosisResult) -> String {
    let stages: Vec<String> = result
        .stages
        .iter()
        .filter(|stage| stage.seconds >= 0.01 * result.seconds)
        .map(|stage| format!("{} {}", stage.name, quantity(&fixed(stage.seconds, 2), "s")))
        .collect();
    format!("{}: {}", quantity(&fixed(result.seconds, 2), "s"), stages.join(", "))
}
