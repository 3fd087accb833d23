//! Sentences on classes of effects: certainty, kind and size. The page, the terminal and `diagnosis.json`
//! share them.

use results::{ClassRow, DiagnosisResult, EffectRow, KindRow, VerdictStatus};

use crate::factors;
use crate::format::{
    self, UNDETERMINED, estimate, plain_spaces, quantity, share_with_interval, significant, unit,
};
use crate::verdict::in_a_sentence;

/// Smallest share within its class with which a kind is mentioned if the data do not distinguish the kind.
const LEAST_KIND: f64 = 0.1;
/// Largest number of kinds mentioned if the data do not distinguish the kind.
const MOST_KINDS: usize = 3;

/// Certainty of a class of effects, from its probability.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Standing {
    /// Probability of 0.9 or more.
    Certain,
    /// Probability from 0.5 to 0.9.
    Likely,
    /// Probability from 0.1 to 0.5, with evidence for the class.
    Open,
}

impl Standing {
    /// All standings, the most certain first.
    pub const ALL: [Self; 3] = [Self::Certain, Self::Likely, Self::Open];

    /// Returns the standing for a probability; `None` below 0.1.
    #[must_use]
    pub fn of(probability: f64) -> Option<Self> {
        Self::ALL.into_iter().find(|standing| probability >= standing.least())
    }

    /// Returns the standing of a class: [`Self::of`] its probability, but open only with evidence for the
    /// class. Without evidence the probability is merely the one with which any system has the class.
    #[must_use]
    pub fn of_class(class: &ClassRow) -> Option<Self> {
        let evidence = class.evidence;
        let speaks = evidence.replacement > 0.0 || evidence.half_swings.is_some_and(|nats| nats > 0.0);
        Self::of(class.probability).filter(|standing| *standing != Self::Open || speaks)
    }

    /// Returns the word for the standing: `certain`, `likely` or `open`.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Certain => "certain",
            Self::Likely => "likely",
            Self::Open => "open",
        }
    }

    /// Returns the lowest probability with this standing.
    #[must_use]
    pub fn least(self) -> f64 {
        match self {
            Self::Certain => 0.9,
            Self::Likely => 0.5,
            Self::Open => 0.1,
        }
    }
}

/// A class of effects with the statement about it.
#[derive(Debug, Clone, PartialEq)]
pub struct ClassStatement<'a> {
    /// Row of the class.
    pub class: &'a ClassRow,
    /// Certainty of the class.
    pub standing: Standing,
    /// Name of the class as inside a sentence: `dry friction`.
    pub title: String,
    /// `true` if fits support the class, and not only the record itself.
    pub is_fitted: bool,
    /// Kind, size, share of the closed gap, and the error without and with the class, in one sentence.
    pub sentence: String,
}

/// Returns the name of a class in plain words, as inside a sentence. An unknown id is returned unchanged.
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

/// Returns the name of a class as the object of a sentence: `a second body`.
fn with_article(id: &str) -> String {
    let title = class_title(id);
    match id {
        "restoring" | "drift" | "second_body" | "preload" | "actuator" => format!("a {title}"),
        _ => title,
    }
}

/// Returns the classes that are certain, likely or open, ordered by standing and then by their share of the
/// gap. Empty for a file of an older version.
#[must_use]
pub fn class_statements(result: &DiagnosisResult) -> Vec<ClassStatement<'_>> {
    let mut statements: Vec<ClassStatement<'_>> = result
        .classes
        .iter()
        .filter_map(|class| {
            let standing = Standing::of_class(class)?;
            let told = Told::new(result, class);
            let (is_fitted, sentence) = (told.is_fitted(), told.sentence());
            Some(ClassStatement { class, standing, title: class_title(&class.id), is_fitted, sentence })
        })
        .collect();
    let share = |one: &ClassStatement<'_>| one.class.gap_share.map_or(-1.0, |share| share.value);
    statements.sort_by(|one, other| {
        one.standing.cmp(&other.standing).then_with(|| share(other).total_cmp(&share(one)))
    });
    statements
}

/// Returns the other classes with their probabilities, in one sentence; `None` if there are none.
#[must_use]
pub fn unlikely_classes(result: &DiagnosisResult) -> Option<String> {
    let all = result.classes.iter().filter(|class| Standing::of_class(class).is_none());
    let named: Vec<String> = all
        .map(|class| format!("{} {}", class_title(&class.id), format::probability(class.probability)))
        .collect();
    (!named.is_empty()).then(|| format!("Unlikely, with their probabilities: {}.", named.join(", ")))
}

/// Returns the name of an effect as inside a sentence, from the result's own table if it has a row.
pub(crate) fn effect_title(result: &DiagnosisResult, id: &str) -> String {
    let known = result.effects.iter().find(|row| row.id == id);
    let title = known.map_or_else(|| capitalized(&id.replace('_', " ")), |row| row.title.clone());
    in_a_sentence(&title)
}

/// Returns a text with its first letter in upper case.
pub(crate) fn capitalized(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().into_iter().flat_map(char::to_uppercase).chain(letters).collect()
}

/// Joins words with commas, and the last two with a given word: `a, b and c`.
#[must_use]
pub fn listed(words: &[String], last: &str) -> String {
    match words {
        [] => String::new(),
        [one] => one.clone(),
        [most @ .., end] => format!("{} {last} {end}", most.join(", ")),
    }
}

/// Returns the name of a kind beside that of its class: `Coulomb` beside `dry friction`.
pub(crate) fn kind_title(result: &DiagnosisResult, class: &str, id: &str) -> String {
    let title = effect_title(result, id);
    let short = match class {
        "friction" => title.strip_suffix(" friction"),
        "sensor" => title.strip_prefix("sensor "),
        _ => None,
    };
    short.unwrap_or(&title).to_owned()
}

fn effect<'a>(result: &'a DiagnosisResult, id: &str) -> Option<&'a EffectRow> {
    result.effects.iter().find(|row| row.id == id)
}

/// Kinds of a class: those that stamps or values show without a fit, and those that were fitted.
struct Told<'a> {
    result: &'a DiagnosisResult,
    class: &'a ClassRow,
    /// Ids of kinds that the record shows.
    shown: Vec<&'a str>,
    /// Ids of kinds that the fits determine; empty if they do not distinguish the kind or name none.
    fitted: Vec<&'a str>,
    /// Ids of kinds that the fits do not distinguish.
    possible: Vec<&'a str>,
}

impl<'a> Told<'a> {
    fn new(result: &'a DiagnosisResult, class: &'a ClassRow) -> Self {
        let is_shown = |id: &str| {
            result.measuring_chain.findings.iter().any(|found| found.effect.as_deref() == Some(id))
        };
        let is_named = |id: &str| result.verdict.effects.iter().any(|named| named == id);
        let (shown, others): (Vec<&KindRow>, Vec<&KindRow>) =
            class.kinds.iter().partition(|kind| is_shown(&kind.id) && is_named(&kind.id));
        let shown: Vec<&str> = shown.iter().map(|kind| kind.id.as_str()).collect();
        let named: Vec<&str> = others.iter().map(|kind| kind.id.as_str()).filter(|id| is_named(id)).collect();
        // Beside a kind that the record shows, a fitted kind is judged on its own.
        let is_told = class.kind_is_told || others.len() == 1 || !shown.is_empty();
        let likely = others.iter().enumerate().filter(|(at, kind)| *at < 2 || kind.share >= LEAST_KIND);
        let (fitted, possible) = match (is_told, named.is_empty()) {
            (true, false) => (named, Vec::new()),
            (true, true) if shown.is_empty() => {
                (others.first().map(|kind| kind.id.as_str()).into_iter().collect(), Vec::new())
            }
            (true, true) => (Vec::new(), Vec::new()),
            (false, _) => (Vec::new(), likely.take(MOST_KINDS).map(|(_, kind)| kind.id.as_str()).collect()),
        };
        Self { result, class, shown, fitted, possible }
    }

    fn titles(&self, ids: &[&str]) -> Vec<String> {
        let own = class_title(&self.class.id);
        let titles = ids.iter().map(|id| kind_title(self.result, &self.class.id, id));
        titles.filter(|title| *title != own).collect()
    }

    /// Returns `true` if fits support the class, and not only the record itself.
    fn is_fitted(&self) -> bool {
        !self.fitted.is_empty() || !self.possible.is_empty()
    }

    /// Returns the standing of the fitted kinds: that of the class, or of the most certain fitted kind beside
    /// one that the record shows.
    fn standing(&self) -> Option<Standing> {
        if self.shown.is_empty() {
            return Standing::of_class(self.class);
        }
        let of = |id: &&str| effect(self.result, id).map_or(0.0, |row| row.probability);
        Standing::of(self.fitted.iter().map(of).fold(0.0, f64::max))
    }

    /// Returns the class with the fitted kinds in parentheses: `dry friction (Coulomb)`.
    fn with_kind(&self) -> String {
        let title = with_article(&self.class.id);
        let (fitted, possible) = (self.titles(&self.fitted), self.titles(&self.possible));
        if !fitted.is_empty() {
            format!("{title} ({})", listed(&fitted, "and"))
        } else if possible.len() > 1 {
            format!("{title} ({}: these data do not determine which)", listed(&possible, "or"))
        } else {
            title
        }
    }

    /// Returns a kind with its coefficients: `Coulomb: torque 2.0 N m [1.9, 2.1]`.
    fn sized(&self, id: &str) -> String {
        let title = self.titles(&[id]).into_iter().next();
        let rows = effect(self.result, id).into_iter().flat_map(|row| &row.parameters);
        let sizes: Vec<String> = rows
            .map(|(name, own)| {
                let name = name.replace('_', " ");
                if own.determined {
                    format!("{name} {}", estimate(own.value, own.interval_95, unit(&own.unit)))
                } else {
                    format!("{name} {UNDETERMINED}")
                }
            })
            .collect();
        match (title, sizes.is_empty()) {
            (None, _) => sizes.join(", "),
            (Some(title), true) => title,
            (Some(title), false) => format!("{title}: {}", sizes.join(", ")),
        }
    }

    /// Returns kind, size, share of the gap, and the error without and with the class.
    fn sentence(&self) -> String {
        let mut parts: Vec<String> = self
            .shown
            .iter()
            .map(|id| format!("{}, which the record shows without a fit", self.sized(id)))
            .collect();
        let is_open = self.standing().is_none_or(|standing| standing == Standing::Open);
        if is_open {
            parts.extend(self.titles(&self.fitted));
        } else {
            parts.extend(self.fitted.iter().map(|id| self.sized(id)));
        }
        let possible = self.titles(&self.possible);
        if possible.len() > 1 {
            parts.push(format!("these data do not determine the kind ({})", listed(&possible, "or")));
        }
        if !is_open {
            parts.extend(self.repaired_kind().map(|id| self.sized(id)));
        }
        if self.is_fitted() {
            let share = self.class.gap_share.as_ref().filter(|_| !is_open);
            parts.extend(share.map(|share| format!("{} of the closed gap", share_with_interval(share))));
            parts.extend(self.errors());
        }
        let text =
            capitalized(&parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("; "));
        if text.is_empty() { text } else { format!("{text}.") }
    }

    /// Returns the kind of the repaired simulator if the data do not distinguish the kind, else the most
    /// likely one.
    fn repaired_kind(&self) -> Option<&'a str> {
        let has_share = |id: &&&str| effect(self.result, id).is_some_and(|row| row.gap_share.is_some());
        self.possible.iter().find(has_share).or(self.possible.first()).copied()
    }

    fn errors(&self) -> Option<String> {
        let ClassRow { error_without: without, error_with: with, .. } = *self.class;
        if !without.is_finite() || !with.is_finite() {
            return None;
        }
        let [without, with] =
            [without, with].map(|rms| quantity(&significant(rms, 3), &self.result.gap.unit));
        Some(match without == with {
            true => format!("error {with} with it and without"),
            false => format!("error {without} without it, {with} with it"),
        })
    }
}

/// Returns the share of the gap that no named effect explains, 0 to 1: the left-over of the repaired
/// simulator, and a torque that was found but has no known cause. `None` without a gap, if the gap is too
/// small beside the noise to be divided, and in files of older versions.
#[must_use]
pub fn nameless_share(result: &DiagnosisResult) -> Option<f64> {
    let left = result.left_over?.share_of_gap;
    let [low, high] = result.gap.closure.interval_95;
    let is_divisible = left.is_finite() && high - low < 1.0;
    if result.verdict.status == VerdictStatus::None || !is_divisible {
        return None;
    }
    let unnamed =
        result.row(VerdictStatus::Unknown).and_then(|row| row.gap_share).map_or(0.0, |share| share.value);
    Some((left + (1.0 - left) * unnamed).clamp(0.0, 1.0))
}

/// Returns `true` if the coefficients are off by more than chance but by an immaterial amount: recalibration
/// lowers the held-out error by less than 5 %. This is so after `trainer init`, whose numbers come from the
/// same record.
#[must_use]
pub fn is_calibrated_already(result: &DiagnosisResult) -> bool {
    const OF_NO_SIZE: f64 = 1.05;
    result.verdict.status == VerdictStatus::Calibration
        && result.gap.nominal <= OF_NO_SIZE * result.gap.recalibrated
}

/// Returns the verdict in a few sentences: classes that are certain, likely or open, the share of the gap
/// without a name, and a hint at a mistaken unit.
#[must_use]
pub fn verdict_sentence(result: &DiagnosisResult) -> String {
    let floor = floor(result);
    let rest = rest(result);
    let not_fitted = "on parts that were not fitted";
    let text = match result.verdict.status {
        VerdictStatus::None => format!(
            "Nothing is missing: the simulator as given explains the records down to {floor} {not_fitted}{}.",
            remaining(result)
        ),
        VerdictStatus::Calibration if is_calibrated_already(result) => format!(
            "Nothing is missing: the simulator as given explains the records down to {floor} {not_fitted}; \
             recalibration changes its coefficients by more than their errors but hardly lowers the held-out \
             error{rest}{}.",
            remaining(result)
        ),
        VerdictStatus::Calibration => format!(
            "Only the coefficients were off: the recalibrated simulator explains the records down to {floor} \
             {not_fitted}, and no effect is missing{rest}{}.",
            remaining(result)
        ),
        VerdictStatus::Effect => effects(result, &format!("{floor} {not_fitted}{rest}")),
        VerdictStatus::Unknown => format!(
            "Something is missing that no known effect explains{}{}{}.",
            match repeating(result) {
                Some(torque) => format!(": {torque}; with it, the error of the simulator is {floor}{rest}"),
                None => format!(": the best named model has an error of {floor}; its residual is not noise"),
            },
            nameless(result).map_or_else(String::new, |share| format!("; {share}")),
            remaining(result),
        ),
    };
    let units = factors::of_units(&result.calibration).map_or_else(String::new, |said| format!(" {said}"));
    plain_spaces(&(text + &units))
}

/// Returns the sentence for a verdict that names effects.
fn effects(result: &DiagnosisResult, left: &str) -> String {
    let all: Vec<Told<'_>> =
        class_statements(result).iter().map(|one| Told::new(result, one.class)).collect();
    let of = |standing: Standing| -> Vec<String> {
        let own = all.iter().filter(|one| one.is_fitted() && one.standing() == Some(standing));
        own.map(Told::with_kind).collect()
    };
    let shown: Vec<String> =
        all.iter().flat_map(|one| &one.shown).map(|id| effect_title(result, id)).collect();
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
    let is_in_the_motion = !lacks.is_empty();
    let missing: Vec<String> = [lacks, shows].into_iter().filter(|text| !text.is_empty()).collect();
    let mut text = capitalized(&missing.join("; "));
    if text.is_empty() {
        // Named only by the rest angle or by a value, so that no class is listed.
        let named: Vec<String> = result.verdict.effects.iter().map(|id| effect_title(result, id)).collect();
        text = format!("The simulator lacks {}", listed(&named, "and"));
    }
    text.push_str(&remaining(result));
    text.push_str(&repeating(result).map_or_else(String::new, |torque| format!("; {torque}")));
    if !is_in_the_motion {
        let which = if is_off(result) { "the recalibrated simulator" } else { "the simulator as given" };
        return format!("{text}. Nothing else is missing: {which} explains the records down to {left}.");
    }
    let share = nameless(result).map_or_else(String::new, |share| format!("; {share}"));
    format!("{text}. The error of the recalibrated and repaired simulator is {left}{share}.")
}

/// Returns the error of the repaired simulator in units of the noise.
fn floor(result: &DiagnosisResult) -> String {
    let gap = &result.gap;
    if gap.ratio_to_floor.is_finite() {
        format!("{} times the noise floor", significant(gap.ratio_to_floor, 3))
    } else {
        quantity(&significant(gap.repaired, 3), &gap.unit)
    }
}

/// Returns half a sentence on the part of the remaining error that is not noise.
fn rest(result: &DiagnosisResult) -> &'static str {
    // Beyond √2 noise floors, more than half of the remaining squared error is not noise.
    let [low, _] = result.gap.ratio_to_floor_interval_95;
    if low.powi(2) > 2.0 {
        "; most of the remaining error is not noise"
    } else if result.verdict.left_over.is_some_and(|probability| probability > 0.5) {
        "; part of the remaining error is not noise"
    } else {
        ""
    }
}

/// Returns half a sentence on the open classes.
fn remaining(result: &DiagnosisResult) -> String {
    let all = class_statements(result);
    let open = all.iter().filter(|one| Told::new(result, one.class).standing() == Some(Standing::Open));
    let open: Vec<String> = open.map(|one| with_article(&one.class.id)).collect();
    match open.len() {
        0 => String::new(),
        1 => format!("; {} remains open", listed(&open, "and")),
        _ => format!("; {} remain open", listed(&open, "and")),
    }
}

/// Returns half a sentence on the share of the gap without a name.
fn nameless(result: &DiagnosisResult) -> Option<String> {
    let share = nameless_share(result)?;
    Some(match share < 5e-4 {
        true => "named effects leave less than 0.1 % of the gap unexplained".to_owned(),
        false => format!("named effects leave {} of the gap unexplained", format::share(share)),
    })
}

/// Returns half a sentence on a torque along the position without a known cause, if there is one.
fn repeating(result: &DiagnosisResult) -> Option<String> {
    let row = result.row(VerdictStatus::Unknown).filter(|row| row.gap_share.is_some())?;
    let wavenumber = row.parameters.get("wavenumber")?;
    // For a displacement, the distance between the waves is stated.
    let often = if wavenumber.unit == "1" {
        format!("{} times a turn", significant(wavenumber.value, 3))
    } else {
        format!("every {} m", significant(std::f64::consts::TAU / wavenumber.value, 3))
    };
    Some(format!("a position-dependent torque of unknown cause repeats {often}"))
}

/// Returns `true` if the simulator's coefficients are more probably off than right.
fn is_off(result: &DiagnosisResult) -> bool {
    result.probability(VerdictStatus::Calibration) > result.probability(VerdictStatus::None)
}
