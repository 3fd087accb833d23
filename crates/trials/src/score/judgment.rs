//! Judgment of one answer against one truth.

use crate::effects::class_of;
use crate::hidden::{Asked, Bank, Hidden};
use dynamics::{Class, Effect};
use results::{DiagnosisResult, VerdictStatus};

/// Case with its opened truth and the answer of the diagnosis.
#[derive(Debug, Clone, PartialEq)]
pub struct AnsweredCase {
    /// Identifier of the case.
    pub id: String,
    /// Hidden truth.
    pub hidden: Hidden,
    /// Answer, or the reason why there is none.
    pub answer: Result<DiagnosisResult, String>,
    /// Closure of the answer's repaired simulator on the noise-free motion, from −1 to 1, or the reason why
    /// there is none; see [`true_closure`](crate::true_closure).
    pub true_closure: Result<f64, String>,
    /// Held-out error, in the observed quantity's unit, of the set that is there, fitted from the truth; or the reason
    /// why there is none. See [`with_the_truth`](crate::with_the_truth).
    pub error_of_the_truth: Result<f64, String>,
    /// Command that diagnoses this case alone again.
    pub command: String,
}

/// Status of an answer, with nuisances removed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Said {
    None,
    Calibration,
    Effect,
    Unknown,
    Nothing,
}

/// Kinds of verdict.
pub(crate) const KINDS: [&str; 7] =
    ["none", "calibration", "structure", "sensor", "clock", "unknown", "no answer"];

impl Said {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::None => VerdictStatus::None.name(),
            Self::Calibration => VerdictStatus::Calibration.name(),
            Self::Effect => VerdictStatus::Effect.name(),
            Self::Unknown => VerdictStatus::Unknown.name(),
            Self::Nothing => "no answer",
        }
    }
}

/// Judged answer.
#[derive(Debug, Clone)]
pub(crate) struct Judgment<'a> {
    pub(crate) case: &'a AnsweredCase,
    pub(crate) said: Said,
    /// Named effects without nuisances, best first.
    pub(crate) named: Vec<&'a str>,
    /// `true` if status and named set are right.
    pub(crate) right: bool,
    pub(crate) top_1: bool,
    pub(crate) class: bool,
    /// `true` if every hidden effect is named.
    pub(crate) both: bool,
    /// `true` if at least one hidden effect is named.
    pub(crate) either: bool,
}

/// All banks, in the order of tables.
pub(crate) const BANKS: [Bank; 13] = [
    Bank::None,
    Bank::Calibration,
    Bank::Single,
    Bank::Pair,
    Bank::LeftOut,
    Bank::Foreign,
    Bank::Releases,
    Bank::Driven,
    Bank::Stressed,
    Bank::Measured,
    Bank::Engine,
    Bank::Composite,
    Bank::Rigs,
];

/// Definition of `right` in words, for the results.
pub(crate) const RIGHT_MEANS: &str = "Effects of the measurement chain that the records of every bank have \
     in common are first removed from an answer. If nothing is missing, an answer is right if it names \
     nothing, with status none or calibration. If effects are hidden, its status must be effect and its \
     set exactly the hidden one. If the hidden effect was not to be considered or lies outside the \
     vocabulary, unknown is right, and so is an answer that names only classes that the truth allows; if \
     such a law is small, every answer that names no other class is right. A case without an answer is \
     wrong. The stated confidence is the probability of being right in this sense.";

impl<'a> Judgment<'a> {
    pub(crate) fn of(case: &'a AnsweredCase) -> Self {
        let hidden = &case.hidden;
        let (said, named) = match &case.answer {
            Ok(answer) => said(answer, &hidden.nuisances),
            Err(_) => (Said::Nothing, Vec::new()),
        };
        let named_here: &[&str] = if said == Said::Effect { &named } else { &[] };
        let is_hidden = |id: &str| hidden.effects.iter().any(|effect| effect.id == id);
        let first = named_here.first().copied();
        // A preload and a wrong rest position are one class on a single record.
        let said_first = first.or((said == Said::Calibration).then_some(VerdictStatus::Calibration.name()));
        let alike = |id: &str| {
            let classes = case.answer.iter().flat_map(|answer| &answer.verdict.equivalent);
            let mut of_first =
                classes.filter(|class| class.iter().any(|own| Some(own.as_str()) == said_first));
            of_first.any(|class| class.iter().any(|own| own == id))
        };
        let allowed = named_here.iter().all(|id| hidden.allowed.iter().any(|class| class == class_of(id)));
        let (right, top_1, class) = match hidden.asked() {
            Asked::Unknown => {
                let right = said == Said::Unknown || said == Said::Effect && allowed;
                (right, right, right)
            }
            Asked::NoName => {
                let right = said != Said::Nothing && allowed;
                (right, right, right)
            }
            Asked::Nothing => {
                let right = matches!(said, Said::None | Said::Calibration);
                (right, right, right || named_here.len() == 1 && alike(VerdictStatus::Calibration.name()))
            }
            Asked::Effects => {
                let every = hidden.effects.iter().all(|effect| named_here.contains(&effect.id.as_str()));
                let right = said == Said::Effect && every && named_here.len() == hidden.effects.len();
                let top_1 = first.is_some_and(is_hidden);
                let like_hidden = || hidden.effects.iter().any(|effect| alike(&effect.id));
                (right, top_1, top_1 || said_first.is_some() && like_hidden())
            }
        };
        let mut found = hidden.effects.iter().map(|effect| named_here.contains(&effect.id.as_str()));
        let either = found.clone().any(|found| found);
        let both = !hidden.effects.is_empty() && found.all(|found| found);
        Self { case, said, named, right, top_1, class, both, either }
    }

    /// Returns the answer's held-out error over that of the set that is there, fitted from the truth.
    pub(crate) fn regret(&self) -> Option<f64> {
        let of_truth = self.case.error_of_the_truth.as_ref().ok()?;
        Some(self.answer()?.gap.repaired / of_truth)
    }

    pub(crate) fn bank(&self) -> Bank {
        self.case.hidden.bank
    }

    /// Returns the kind of answer that the case asks for.
    pub(crate) fn asked(&self) -> Asked {
        self.case.hidden.asked()
    }

    pub(crate) fn answer(&self) -> Option<&'a DiagnosisResult> {
        self.case.answer.as_ref().ok()
    }

    /// Returns the size of what is hidden: for several effects the smallest, because all must be seen; NaN if
    /// there is none.
    pub(crate) fn size(&self) -> f64 {
        let hidden = &self.case.hidden;
        let foreign = hidden.foreign.iter().map(|foreign| foreign.detectability);
        hidden.effects.iter().map(|effect| effect.detectability).chain(foreign).fold(f64::NAN, f64::min)
    }

    /// Returns `true` if the answer names something or says `unknown`.
    pub(crate) fn alarms(&self) -> bool {
        matches!(self.said, Said::Effect | Said::Unknown)
    }

    /// Returns the stated probability of an identifier; 0 if the answer does not list it. `None` without an
    /// answer.
    pub(crate) fn probability(&self, id: &str) -> Option<f64> {
        let answer = self.answer()?;
        Some(answer.effects.iter().find(|row| row.id == id).map_or(0.0, |row| row.probability))
    }

    /// Returns the description of the law outside the vocabulary, if one acts.
    pub(crate) fn foreign_law(&self) -> Option<String> {
        self.case.hidden.foreign.as_ref().map(|foreign| foreign.law.clone())
    }

    /// Returns what was hidden, as written in tables.
    pub(crate) fn hidden_name(&self) -> String {
        let ids: Vec<&str> = self.case.hidden.effects.iter().map(|effect| effect.id.as_str()).collect();
        match (self.bank(), ids.is_empty()) {
            (Bank::LeftOut, _) => format!("{}, not considered", ids.join("+")),
            (bank, true) => self.foreign_law().unwrap_or_else(|| bank.name().to_owned()),
            (_, false) => ids.join("+"),
        }
    }

    /// Returns what was answered, as written in tables.
    pub(crate) fn said_name(&self) -> String {
        match self.said {
            Said::Effect => self.named.join("+"),
            said => said.name().to_owned(),
        }
    }

    /// Returns the kind of what was hidden; for several effects, that of the first.
    pub(crate) fn hidden_kind(&self) -> &'static str {
        match self.bank() {
            Bank::None => Said::None.name(),
            Bank::Calibration => Said::Calibration.name(),
            _ if self.asked() == Asked::Unknown => Said::Unknown.name(),
            _ => self.case.hidden.effects.first().map_or(Said::None.name(), |effect| kind(&effect.id)),
        }
    }

    /// Returns the kind of the answer: that of the first name.
    pub(crate) fn said_kind(&self) -> &'static str {
        match self.said {
            Said::Effect => self.named.first().map_or(Said::None.name(), |id| kind(id)),
            said => said.name(),
        }
    }

    /// Returns `true` if the kind is right; for several hidden effects, the kind of any of them is right.
    pub(crate) fn kind_is_right(&self) -> bool {
        let said = self.said_kind();
        said == self.hidden_kind()
            || self.asked() != Asked::Unknown
                && self.case.hidden.effects.iter().any(|effect| kind(&effect.id) == said)
    }
}

/// Returns status and names of an answer without nuisances. If only nuisances were named, the status is
/// `none` or `calibration`, whichever is more probable according to the answer.
fn said<'a>(answer: &'a DiagnosisResult, nuisances: &[String]) -> (Said, Vec<&'a str>) {
    let named: Vec<&str> =
        answer.verdict.effects.iter().filter(|id| !nuisances.contains(id)).map(String::as_str).collect();
    let said = match answer.verdict.status {
        VerdictStatus::None => Said::None,
        VerdictStatus::Calibration => Said::Calibration,
        VerdictStatus::Unknown => Said::Unknown,
        VerdictStatus::Effect if !named.is_empty() => Said::Effect,
        VerdictStatus::Effect
            if answer.probability(VerdictStatus::None) > answer.probability(VerdictStatus::Calibration) =>
        {
            Said::None
        }
        VerdictStatus::Effect => Said::Calibration,
    };
    (said, named)
}

/// Returns the kind of verdict to which an effect belongs.
fn kind(id: &str) -> &'static str {
    match Effect::find(id).map(|effect| effect.description().class) {
        Ok(Class::Sensor) => "sensor",
        Ok(Class::Clock) => "clock",
        _ => "structure",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::score::sample::{answered, case};

    #[test]
    fn nuisances_count_for_nothing() {
        let mut nothing = case(Bank::None, &[], answered("effect", &["sensor_quantization"], 0.9));
        assert!(!Judgment::of(&nothing).right);
        nothing.hidden.nuisances = vec!["sensor_quantization".to_owned()];
        let judged = Judgment::of(&nothing);
        assert!(judged.right && judged.top_1 && judged.named.is_empty() && !judged.alarms());
        let mut one =
            case(Bank::Single, &["gravity"], answered("effect", &["sensor_quantization", "gravity"], 0.9));
        one.hidden.nuisances = vec!["sensor_quantization".to_owned()];
        assert!(Judgment::of(&one).right);
    }

    #[test]
    fn a_class_holds_what_the_answer_cannot_tell_apart() {
        let mut one = case(Bank::Single, &["gravity"], answered("effect", &["cubic_stiffness"], 0.9));
        let judged = Judgment::of(&one);
        assert!(!judged.top_1 && !judged.class && judged.kind_is_right());
        one.answer.as_mut().unwrap().verdict.equivalent =
            vec![vec!["cubic_stiffness".to_owned(), "gravity".to_owned()]];
        let judged = Judgment::of(&one);
        assert!(!judged.top_1 && judged.class && !judged.right);
    }

    #[test]
    fn two_effects_need_both_names_and_no_third() {
        let hidden = ["gravity", "coulomb_friction"];
        let of = |named: &[&str]| case(Bank::Pair, &hidden, answered("effect", named, 0.9));
        let (all, half, more) = (
            of(&["coulomb_friction", "gravity"]),
            of(&["coulomb_friction"]),
            of(&["gravity", "coulomb_friction", "backlash"]),
        );
        let judged = Judgment::of(&all);
        assert!(judged.right && judged.both && judged.either && judged.top_1);
        let judged = Judgment::of(&half);
        assert!(!judged.right && !judged.both && judged.either && judged.top_1);
        let judged = Judgment::of(&more);
        assert!(!judged.right && judged.both);
    }

    #[test]
    fn what_is_outside_asks_for_unknown_and_no_answer_is_wrong() {
        let left = case(Bank::LeftOut, &["gravity"], answered("unknown", &["cubic_stiffness"], 0.8));
        assert!(Judgment::of(&left).right && Judgment::of(&left).kind_is_right());
        let named = case(Bank::LeftOut, &["gravity"], answered("effect", &["cubic_stiffness"], 0.8));
        assert!(!Judgment::of(&named).right && !Judgment::of(&named).kind_is_right());
        let none = case(Bank::None, &[], Err("too few samples".to_owned()));
        let judged = Judgment::of(&none);
        assert!(!judged.right && !judged.top_1 && !judged.class && !judged.alarms());
        assert_eq!(judged.said_kind(), "no answer");
        let unknown = case(Bank::Single, &["gravity"], answered("unknown", &["gravity"], 0.8));
        assert!(!Judgment::of(&unknown).top_1);
    }
}
