//! Classes of effects in words: how sure, which kind, how large. Page, terminal and `diagnosis.json` share these sentences.

use runs::result::{ClassRow, DiagnosisResult, EffectRow};

use crate::format::{
    self, UNDETERMINED, estimate, plain_spaces, quantity, share_with_interval, significant, unit,
};
use crate::verdict::in_a_sentence;

/// Share within its class from which on a kind is mentioned where the data do not tell the kind.
const LEAST_KIND: f64 = 0.1;
/// Kinds that are mentioned at most where the data do not tell which.
const MOST_KINDS: usize = 3;

/// Certainty of a class of effects, by its probability.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Standing {
    /// Probability of 0.9 or more.
    Certain,
    /// Probability from 0.5 to 0.9.
    Likely,
    /// Probability from 0.1 to 0.5.
    Open,
}

impl Standing {
    /// Every standing, the surest first.
    pub const ALL: [Self; 3] = [Self::Certain, Self::Likely, Self::Open];

    /// Standing of a class with this probability; `None` below 0.1.
    #[must_use]
    pub fn of(probability: f64) -> Option<Self> {
        Self::ALL.into_iter().find(|standing| probability >= standing.least())
    }

    /// Its word: `certain`, `likely` or `open`.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Certain => "certain",
            Self::Likely => "likely",
            Self::Open => "open",
        }
    }

    /// Lowest probability that has this standing.
    #[must_use]
    pub fn least(self) -> f64 {
        match self {
            Self::Certain => 0.9,
            Self::Likely => 0.5,
            Self::Open => 0.1,
        }
    }
}

/// A class of effects with what is to be said of it.
#[derive(Debug, Clone, PartialEq)]
pub struct ClassStatement<'a> {
    /// The class.
    pub class: &'a ClassRow,
    /// How sure it is.
    pub standing: Standing,
    /// Its name in words, as inside a sentence: `dry friction`.
    pub title: String,
    /// Kind, size, share of the gap, and the error without and with it, in one sentence.
    pub sentence: String,
}

/// Name of a class in plain words, as inside a sentence. An id that is not known is its own name.
#[must_use]
pub fn class_title(id: &str) -> String {
    match id {
        "friction" => "dry friction",
        "restoring" => "nonlinear restoring force",
        "damping" => "damping beyond viscous",
        "play" => "play or stops",
        "drift" => "drift of spring or clock",
        "second_body" => "second body",
        "forcing" => "periodic forcing",
        "preload" => "constant torque",
        "actuator" => "delay or limits of the actuator",
        "sensor" => "distortion by the sensor",
        "stamps" => "irregular time stamps",
        other => return other.replace('_', " "),
    }
    .to_owned()
}

/// Classes with a probability of 0.1 or more, the surest first; none for a file of an older version.
#[must_use]
pub fn class_statements(result: &DiagnosisResult) -> Vec<ClassStatement<'_>> {
    result
        .classes
        .iter()
        .filter_map(|class| {
            let standing = Standing::of(class.probability)?;
            let sentence = sentence(result, class, standing);
            Some(ClassStatement { class, standing, title: class_title(&class.id), sentence })
        })
        .collect()
}

/// Name of an effect inside a sentence, by the result's own table where it has a row.
pub(crate) fn effect_title(result: &DiagnosisResult, id: &str) -> String {
    let known = result.effects.iter().find(|row| row.id == id);
    let title = known.map_or_else(|| capitalized(&id.replace('_', " ")), |row| row.title.clone());
    in_a_sentence(&title)
}

/// A text with its first letter large.
pub(crate) fn capitalized(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().into_iter().flat_map(char::to_uppercase).chain(letters).collect()
}

/// Words with commas between and a last word before the last of them: `a, b and c`.
#[must_use]
pub fn listed(words: &[String], last: &str) -> String {
    match words {
        [] => String::new(),
        [one] => one.clone(),
        [most @ .., end] => format!("{} {last} {end}", most.join(", ")),
    }
}

/// Name of a kind beside that of its class: `Coulomb` beside `dry friction`.
pub(crate) fn kind_title(result: &DiagnosisResult, class: &ClassRow, id: &str) -> String {
    let title = effect_title(result, id);
    match title.strip_suffix(" friction") {
        Some(kind) if class.id == "friction" => kind.to_owned(),
        _ => title,
    }
}

/// Ids of the kinds that a class is told to be of; empty where the data do not tell.
fn told(result: &DiagnosisResult, class: &ClassRow) -> Vec<String> {
    let ids = || class.kinds.iter().map(|kind| kind.id.clone());
    let named: Vec<String> = ids().filter(|id| result.verdict.effects.contains(id)).collect();
    match (class.kind_is_told || class.kinds.len() == 1, named.is_empty()) {
        // A kind that stamps or values show is told, whatever the fits can tell.
        (false, _) => named.into_iter().filter(|id| !effect(result, id).is_some_and(is_fitted)).collect(),
        (true, false) => named,
        (true, true) => ids().take(1).collect(),
    }
}

/// Kinds between which the data do not tell.
fn possible(result: &DiagnosisResult, class: &ClassRow) -> Vec<String> {
    let shown = class.kinds.iter().enumerate();
    let shown = shown.filter(|(at, kind)| *at < 2 || kind.share >= LEAST_KIND).take(MOST_KINDS);
    shown.map(|(_, kind)| kind_title(result, class, &kind.id)).collect()
}

/// The class with its kind in parentheses: `dry friction (Coulomb)`.
fn with_kind(result: &DiagnosisResult, class: &ClassRow) -> String {
    let title = class_title(&class.id);
    let told: Vec<String> = told(result, class)
        .iter()
        .map(|id| kind_title(result, class, id))
        .filter(|kind| *kind != title)
        .collect();
    if !told.is_empty() {
        return format!("{title} ({})", listed(&told, "and"));
    }
    let possible = possible(result, class);
    if possible.len() < 2 {
        return title;
    }
    format!("{title} ({}: these data don’t tell which)", listed(&possible, "or"))
}

fn effect<'a>(result: &'a DiagnosisResult, id: &str) -> Option<&'a EffectRow> {
    result.effects.iter().find(|row| row.id == id)
}

fn is_fitted(row: &EffectRow) -> bool {
    row.gap_share.is_some() || !row.parameters.is_empty()
}

/// Whether stamps or values show a class without a fit.
fn is_shown(result: &DiagnosisResult, class: &ClassRow) -> bool {
    class.gap_share.is_none()
        && !class.error_with.is_finite()
        && !class.kinds.iter().any(|kind| effect(result, &kind.id).is_some_and(is_fitted))
}

/// Coefficients of the kinds that a class is, or most probably is.
fn sizes(result: &DiagnosisResult, class: &ClassRow) -> Vec<String> {
    let told = told(result, class);
    let likeliest = class.kinds.first().map(|kind| kind.id.clone());
    let ids = if told.is_empty() { likeliest.into_iter().collect() } else { told.clone() };
    let mut sizes = Vec::new();
    for id in &ids {
        let Some(row) = effect(result, id) else { continue };
        let of = match ids.len() > 1 || told.is_empty() {
            true => format!("{}, ", kind_title(result, class, id)),
            false => String::new(),
        };
        sizes.extend(row.parameters.iter().map(|(name, own)| {
            let name = name.replace('_', " ");
            if own.determined {
                format!("{of}{name} {}", estimate(own.value, own.interval_95, unit(&own.unit)))
            } else {
                format!("{of}{name}: {UNDETERMINED}")
            }
        }));
    }
    sizes
}

fn sentence(result: &DiagnosisResult, class: &ClassRow, standing: Standing) -> String {
    let title = class_title(&class.id);
    let told: Vec<String> = told(result, class)
        .iter()
        .map(|id| kind_title(result, class, id))
        .filter(|kind| *kind != title)
        .collect();
    let mut parts: Vec<String> = Vec::new();
    let possible = possible(result, class);
    if !told.is_empty() {
        parts.push(listed(&told, "and"));
    } else if !class.kind_is_told && possible.len() > 1 {
        parts.push(format!("the kind can’t be told on these data ({})", listed(&possible, "or")));
    }
    if is_shown(result, class) {
        parts.push("the record shows it without a fit".to_owned());
    } else {
        if standing != Standing::Open {
            parts.extend(sizes(result, class));
            parts.extend(
                class.gap_share.as_ref().map(|share| format!("{} of the gap", share_with_interval(share))),
            );
        }
        let rms = |value: f64| quantity(&significant(value, 3), &result.gap.unit);
        if class.error_without.is_finite() && class.error_with.is_finite() {
            parts.push(format!(
                "error {} without it, {} with it",
                rms(class.error_without),
                rms(class.error_with)
            ));
        }
    }
    let text = capitalized(&parts.join("; "));
    if text.is_empty() { text } else { format!("{text}.") }
}

/// Share of the gap that has no name, 0 to 1: what the repaired simulator leaves, and a torque that was found and has no
/// cause. `None` where there is no gap, where it is too small beside the noise to be divided, and in files of older versions.
#[must_use]
pub fn nameless_share(result: &DiagnosisResult) -> Option<f64> {
    let left = result.left_over?.share_of_gap;
    let [low, high] = result.gap.closure.interval_95;
    let is_divisible = left.is_finite() && high - low < 1.0;
    if result.verdict.status == "none" || !is_divisible {
        return None;
    }
    let unnamed = effect(result, "unknown").and_then(|row| row.gap_share).map_or(0.0, |share| share.value);
    Some((left + (1.0 - left) * unnamed).clamp(0.0, 1.0))
}

/// Whether a calibration is off by more than chance and yet by nothing that matters: recalibrated, the error on parts that
/// were not fitted is less than 5 % smaller. So it is after `trainer init`, whose numbers come from the same record.
#[must_use]
pub fn is_calibrated_already(result: &DiagnosisResult) -> bool {
    const OF_NO_SIZE: f64 = 1.05;
    result.verdict.status == "calibration" && result.gap.nominal <= OF_NO_SIZE * result.gap.recalibrated
}

/// The verdict in one or two sentences: what is certain, what is likely, what is open, and how much of the gap has no name.
#[must_use]
pub fn verdict_sentence(result: &DiagnosisResult) -> String {
    let floor = floor(result);
    let rest = rest(result);
    let not_fitted = "on parts that were not fitted";
    let text = match result.verdict.status.as_str() {
        "none" => format!(
            "Nothing is missing: the simulator as given explains what was recorded, down to {floor} {not_fitted}{}.",
            remaining(result)
        ),
        "calibration" if is_calibrated_already(result) => format!(
            "Nothing is missing: the simulator as given explains what was recorded, down to {floor} {not_fitted}; \
             recalibration moves its coefficients by more than their errors and takes next to nothing off the \
             error{rest}{}.",
            remaining(result)
        ),
        "calibration" => format!(
            "Only the coefficients were off: recalibrated, the simulator explains what was recorded down to {floor} \
             {not_fitted}, and no effect is missing{rest}{}.",
            remaining(result)
        ),
        "effect" => effects(result, &format!("{floor} {not_fitted}{rest}")),
        _ => format!(
            "Something is missing that no known effect explains{}{}{}.",
            match repeating(result) {
                Some(torque) => format!(": {torque}; with it the simulator leaves {floor}{rest}"),
                None => format!(": the best named model leaves {floor}, and what it leaves is no noise"),
            },
            nameless(result).map_or_else(String::new, |share| format!("; {share}")),
            remaining(result),
        ),
    };
    plain_spaces(&text)
}

/// The sentence where effects are named.
fn effects(result: &DiagnosisResult, left: &str) -> String {
    let all = class_statements(result);
    let (shown, fitted): (Vec<_>, Vec<_>) =
        all.iter().filter(|one| one.standing != Standing::Open).partition(|one| is_shown(result, one.class));
    let of = |standing: Standing| -> Vec<String> {
        let own = fitted.iter().filter(|one| one.standing == standing);
        own.map(|one| with_kind(result, one.class)).collect()
    };
    let shown: Vec<String> = shown.iter().map(|one| with_kind(result, one.class)).collect();
    let (certain, likely) = (listed(&of(Standing::Certain), "and"), listed(&of(Standing::Likely), "and"));
    let lacks = match (certain.is_empty(), likely.is_empty()) {
        (true, true) => String::new(),
        (false, true) => format!("the simulator certainly lacks {certain}"),
        (true, false) => format!("the simulator likely lacks {likely}"),
        (false, false) => format!("the simulator certainly lacks {certain}, and likely {likely}"),
    };
    let shows = match shown.is_empty() {
        true => String::new(),
        false => format!("the record shows {}, which the simulator lacks", listed(&shown, "and")),
    };
    let missing: Vec<String> = [lacks, shows].into_iter().filter(|text| !text.is_empty()).collect();
    let mut text = capitalized(&missing.join("; "));
    if text.is_empty() {
        // Named by the rest angle or by a value alone, in no class of its own.
        let named: Vec<String> = result.verdict.effects.iter().map(|id| effect_title(result, id)).collect();
        text = format!("The simulator lacks {}", listed(&named, "and"));
    }
    text.push_str(&remaining(result));
    text.push_str(&repeating(result).map_or_else(String::new, |torque| format!("; {torque}")));
    let share = nameless(result).map_or_else(String::new, |share| format!("; {share}"));
    if fitted.is_empty() {
        let which = if is_off(result) { "recalibrated, the simulator" } else { "the simulator as given" };
        return format!(
            "{text}. Beside that nothing is missing: {which} explains what was recorded down to {left}."
        );
    }
    format!("{text}. Recalibrated and repaired, the simulator leaves {left}{share}.")
}

/// Error of the repaired simulator in units of the noise.
fn floor(result: &DiagnosisResult) -> String {
    let gap = &result.gap;
    if gap.ratio_to_floor.is_finite() {
        format!("{} times the noise floor", significant(gap.ratio_to_floor, 3))
    } else {
        quantity(&significant(gap.repaired, 3), &gap.unit)
    }
}

/// Half a sentence on what is left and is no noise.
fn rest(result: &DiagnosisResult) -> &'static str {
    // Beyond √2 floors more than half of what is left, by its square, is something else than noise.
    let [low, _] = result.gap.ratio_to_floor_interval_95;
    if low.powi(2) > 2.0 {
        "; most of the remaining error is not noise"
    } else if result.verdict.left_over.is_some_and(|probability| probability > 0.5) {
        "; part of the remaining error is not noise"
    } else {
        ""
    }
}

/// Half a sentence on the classes that are open.
fn remaining(result: &DiagnosisResult) -> String {
    let all = class_statements(result);
    let open = all.iter().filter(|one| one.standing == Standing::Open);
    let open: Vec<String> = open.map(|one| one.title.clone()).collect();
    match open.len() {
        0 => String::new(),
        1 => format!("; {} remains open", listed(&open, "and")),
        _ => format!("; {} remain open", listed(&open, "and")),
    }
}

/// Half a sentence on the share of the gap that has no name.
fn nameless(result: &DiagnosisResult) -> Option<String> {
    let share = nameless_share(result)?;
    Some(match share < 5e-4 {
        true => "less than 0.1 % of the gap has no name".to_owned(),
        false => format!("{} of the gap has no name", format::share(share)),
    })
}

/// The torque along the position that has no name, where there is one.
fn repeating(result: &DiagnosisResult) -> Option<String> {
    let row = effect(result, "unknown").filter(|row| row.gap_share.is_some())?;
    let wavenumber = row.parameters.get("wavenumber")?;
    // Of a length it is stated how far apart the waves are.
    let often = if wavenumber.unit == "1" {
        format!("{} times a turn", significant(wavenumber.value, 3))
    } else {
        format!("every {} m", significant(std::f64::consts::TAU / wavenumber.value, 3))
    };
    Some(format!("a position-dependent torque of unknown cause repeats {often}"))
}

/// Whether the simulator's coefficients are more probably off than right.
fn is_off(result: &DiagnosisResult) -> bool {
    let probability = |id: &str| effect(result, id).map_or(0.0, |row| row.probability);
    probability("calibration") > probability("none")
}
