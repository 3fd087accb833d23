//! Several rigs of one build: probability over all rigs that they have a class of effects, and agreement of
//! coefficients.
//!
//! The rigs of a build share which effects they have, not how large these are: each rig keeps its own
//! coefficients, which are compared by Cochran's Q.

use record::Origin;
use report::{format, nameless_share};
use results::{
    DiagnosisResult, EffectRow, FailedCase, FarthestPair, ParameterRow, RIGS_SCHEMA, RigClassRow, RigRow,
    RigValueRow, RigsResult, SharedClassRow, SharedCoefficientRow, WithInterval,
};
use scoring::{Agreement, agreement};

/// Prior probability that a rig has a class of effects that its nominal simulator lacks. Rigs simulated like
/// real ones have two to four effects of eleven classes, and rigs with one effect or none are diagnosed as
/// well: about one class in five. The value matters little: it enters the result only once, whatever the
/// number of rigs.
const PRIOR: f64 = 0.2;

/// Probability of a class on a rig if no set with it was worth a fit: that of the least probable class that
/// is stated.
const NOT_FITTED: f64 = 0.1;

/// Minimum probability of a class, and of its absence, that a single rig's records can support. Stated
/// probabilities cannot be tested beyond it, and no single rig overrules all the others.
const LEAST: f64 = 1e-3;

/// Probability from which a class counts as present on a rig according to its own records.
const LIKELY: f64 = 0.5;

/// Significance level of the test for different coefficients: the chance that equal ones are said to differ.
const SIGNIFICANCE: f64 = 0.01;

/// 97.5 % quantile of the normal distribution: half the width of a 95 % interval in standard errors.
const HALF_WIDTH: f64 = 1.959_963_984_540_054;

/// Rig with its answer.
pub struct AnsweredRig {
    /// Name of the rig.
    pub name: String,
    /// Folder of its records, as given.
    pub folder: String,
    /// Answer on its own records.
    pub result: DiagnosisResult,
}

/// Combines the answers of a build's rigs into the content of `rigs.json`. `failed` lists the rigs without an answer,
/// `complete` is `false` after an interruption, and `seconds` is the time that all took.
#[must_use]
pub fn pooled(rigs: &[AnsweredRig], failed: Vec<FailedCase>, complete: bool, seconds: f64) -> RigsResult {
    let classes = classes(rigs);
    RigsResult {
        schema: RIGS_SCHEMA.to_owned(),
        sentences: sentences(rigs, &classes),
        rigs: rigs.iter().map(AnsweredRig::row).collect(),
        classes,
        failed,
        complete,
        seconds,
    }
}

impl AnsweredRig {
    fn row(&self) -> RigRow {
        RigRow {
            name: self.name.clone(),
            folder: self.folder.clone(),
            origin: Origin::shared(self.result.records.iter().map(|record| record.origin)),
            status: self.result.verdict.status,
            summary: self.result.verdict.summary.clone(),
            nameless_share: nameless_share(&self.result),
            classes: self
                .result
                .classes
                .iter()
                .map(|class| RigClassRow { id: class.id.clone(), probability: class.probability })
                .collect(),
        }
    }

    fn probability(&self, class: &str) -> Option<f64> {
        self.result.classes.iter().find(|own| own.id == class).map(|own| own.probability)
    }

    fn effect(&self, id: &str) -> Option<&EffectRow> {
        self.result.effects.iter().find(|row| row.id == id)
    }
}

/// Computes the probability that all rigs of a build have a class from the probabilities on each rig by its
/// own records.
///
/// A rig's log odds are the sum of the prior log odds and the contribution of its records. Given that the
/// build has the class, or lacks it, the rigs' records are independent, so their contributions are summed and
/// the prior is counted once: logit p = Σ logit pᵢ − (n − 1) logit p₀.
fn combined(probabilities: &[f64]) -> f64 {
    let logit = |p: f64| libm::log(p / (1.0 - p));
    let sum: f64 = probabilities.iter().map(|p| logit(p.clamp(LEAST, 1.0 - LEAST))).sum();
    let log_odds = sum - (probabilities.len() as f64 - 1.0) * logit(PRIOR);
    1.0 / (1.0 + libm::exp(-log_odds))
}

/// Returns every class that some rig states, with its probability over all rigs and its coefficients; the
/// most probable class comes first.
fn classes(rigs: &[AnsweredRig]) -> Vec<SharedClassRow> {
    let mut ids: Vec<&str> = Vec::new();
    for class in rigs.iter().flat_map(|rig| &rig.result.classes) {
        if !ids.contains(&class.id.as_str()) {
            ids.push(&class.id);
        }
    }
    let mut rows: Vec<SharedClassRow> = ids
        .into_iter()
        .map(|id| {
            let own: Vec<f64> = rigs.iter().map(|rig| rig.probability(id).unwrap_or(NOT_FITTED)).collect();
            let present = rigs.iter().filter(|rig| rig.probability(id).is_some_and(|p| p >= LIKELY));
            SharedClassRow {
                id: id.to_owned(),
                probability: combined(&own),
                present_in: present.map(|rig| rig.name.clone()).collect(),
                coefficients: coefficients(rigs, id),
            }
        })
        .collect();
    rows.sort_by(|one, other| other.probability.total_cmp(&one.probability));
    rows
}

/// Share within its class from which a kind is possible on a rig whose data do not distinguish the kinds.
const POSSIBLE: f64 = 0.1;

/// Returns the coefficients of the kinds of a class that some rig names or cannot rule out; those of the
/// likeliest kind come first.
fn coefficients(rigs: &[AnsweredRig], class: &str) -> Vec<SharedCoefficientRow> {
    let mut kinds: Vec<(&str, f64, bool)> = Vec::new();
    for rig in rigs {
        for own in rig.result.classes.iter().filter(|own| own.id == class) {
            for kind in &own.kinds {
                let is_named = rig.result.verdict.effects.contains(&kind.id);
                let counts = is_named || !own.kind_is_told && kind.share >= POSSIBLE;
                match kinds.iter_mut().find(|(id, ..)| *id == kind.id) {
                    Some((_, share, is_shown)) => {
                        *share += kind.share;
                        *is_shown |= counts;
                    }
                    None => kinds.push((&kind.id, kind.share, counts)),
                }
            }
        }
    }
    kinds.retain(|(.., is_shown)| *is_shown);
    kinds.sort_by(|(_, one, _), (_, other, _)| other.total_cmp(one));
    kinds.into_iter().flat_map(|(kind, ..)| of_kind(rigs, kind)).collect()
}

fn of_kind(rigs: &[AnsweredRig], effect: &str) -> Vec<SharedCoefficientRow> {
    let rows: Vec<(&str, &EffectRow)> =
        rigs.iter().filter_map(|rig| Some((rig.name.as_str(), rig.effect(effect)?))).collect();
    let Some((_, first)) = rows.first() else { return Vec::new() };
    let mut names: Vec<&String> = Vec::new();
    for name in rows.iter().flat_map(|(_, row)| row.parameters.keys()) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let of = |name: &String| {
        let values: Vec<(&str, &ParameterRow)> = rows
            .iter()
            .filter_map(|(rig, row)| Some((*rig, row.parameters.get(name)?)))
            .filter(|(_, own)| own.determined && own.value.is_finite())
            .collect();
        (!values.is_empty()).then(|| coefficient(effect, &first.title, name, &values))
    };
    names.into_iter().filter_map(of).collect()
}

fn coefficient(
    effect: &str,
    title: &str,
    parameter: &str,
    values: &[(&str, &ParameterRow)],
) -> SharedCoefficientRow {
    let unit = values.first().map_or_else(String::new, |(_, own)| own.unit.clone());
    let is_one_unit = values.iter().all(|(_, own)| own.unit == unit);
    let estimates: Vec<(f64, f64)> = values
        .iter()
        .map(|(_, own)| {
            let [low, high] = own.interval_95;
            (own.value, (high - low) / (2.0 * HALF_WIDTH))
        })
        .collect();
    let found = agreement(&estimates).filter(|_| is_one_unit);
    let agree = found.map(|found| found.p_value >= SIGNIFICANCE);
    let of = |at: usize| values.get(at).map_or_else(String::new, |(rig, _)| (*rig).to_owned());
    SharedCoefficientRow {
        effect: effect.to_owned(),
        title: title.to_owned(),
        parameter: parameter.to_owned(),
        unit: if is_one_unit { unit } else { String::new() },
        values: values
            .iter()
            .map(|(rig, own)| RigValueRow {
                rig: (*rig).to_owned(),
                value: own.value,
                interval_95: own.interval_95,
                unit: own.unit.clone(),
            })
            .collect(),
        agree,
        chi_squared: found.map(|found| found.chi_squared),
        degrees: found.map_or(0, |found| found.degrees),
        mean: found.filter(|_| agree == Some(true)).map(mean),
        farthest: found.map(|found| {
            let (one, other, standard_errors) = found.farthest;
            FarthestPair { rigs: [of(one), of(other)], standard_errors }
        }),
    }
}

fn mean(found: Agreement) -> WithInterval {
    let half = HALF_WIDTH * found.std_error;
    WithInterval { value: found.mean, interval_95: [found.mean - half, found.mean + half] }
}

/// Describes the table in sentences, one for each class that is likely on some rig, in the order of the
/// table.
fn sentences(rigs: &[AnsweredRig], classes: &[SharedClassRow]) -> Vec<String> {
    let mut sentences: Vec<String> = classes
        .iter()
        .filter(|class| !class.present_in.is_empty())
        .map(|class| sentence(rigs, class))
        .collect();
    if sentences.is_empty() {
        sentences.push("No class of effects is likely on any of the rigs.".to_owned());
    }
    sentences.iter().map(|text| format::plain_spaces(text)).collect()
}

fn sentence(rigs: &[AnsweredRig], class: &SharedClassRow) -> String {
    let title = report::class_title(&class.id);
    let probability = format::probability(class.probability);
    let lead = if class.present_in.len() == rigs.len() {
        format!("{title}: in all {} (probability {probability})", number(rigs.len()))
    } else {
        let absent = rigs.iter().map(|rig| &rig.name).filter(|name| !class.present_in.contains(name));
        let absent: Vec<String> = absent.cloned().collect();
        format!(
            "{title}: likely in {}, but not in {}, each by its own records (probability that all have it: \
             {probability})",
            report::listed(&class.present_in, "and"),
            report::listed(&absent, "and")
        )
    };
    // If the data do not distinguish several kinds, only the likeliest one is described; the table has all of
    // them.
    let likeliest = class.coefficients.first().map(|row| row.effect.as_str());
    let own = class.coefficients.iter().filter(|row| Some(row.effect.as_str()) == likeliest);
    let told: Vec<String> = own.map(told).collect();
    let mut letters = lead.chars();
    let lead: String = letters.next().into_iter().flat_map(char::to_uppercase).chain(letters).collect();
    if told.is_empty() { format!("{lead}.") } else { format!("{lead}; {}.", told.join("; ")) }
}

/// Writes small numbers of rigs as words, others as digits.
fn number(count: usize) -> String {
    match count {
        2 => "two".to_owned(),
        3 => "three".to_owned(),
        4 => "four".to_owned(),
        other => other.to_string(),
    }
}

/// Describes a coefficient: its values and whether they agree.
fn told(row: &SharedCoefficientRow) -> String {
    let name = format!("{} of {}", row.parameter.replace('_', " "), report::in_a_sentence(&row.title));
    let unit = format::unit(&row.unit);
    let shown: Vec<String> = row.values.iter().map(|own| format::significant(own.value, 3)).collect();
    let values = format::quantity(&shown.join(", "), unit);
    match (row.agree, &row.farthest, row.values.as_slice()) {
        (Some(true), ..) => format!("{name} {values}, the same within errors"),
        (Some(false), Some(pair), _) => {
            let [one, other] = &pair.rigs;
            let errors = format::significant(pair.standard_errors, 2);
            format!("{name} {values}, not the same: {one} and {other} differ by {errors} standard errors")
        }
        (_, _, [only]) => {
            let value = format::estimate(only.value, only.interval_95, unit);
            format!("{name} determined only by {}, {value}", only.rig)
        }
        _ => format!("{name} {values}, in units or with errors that cannot be compared"),
    }
}

#[cfg(test)]
mod tests {
    use super::{PRIOR, coefficient, combined, told};
    use results::ParameterRow;

    fn value(value: f64, std_error: f64, unit: &str) -> ParameterRow {
        let half = super::HALF_WIDTH * std_error;
        let interval_95 = [value - half, value + half];
        ParameterRow { value, unit: unit.to_owned(), interval_95, determined: true }
    }

    #[test]
    fn a_rig_alone_keeps_its_probability_and_the_prior_is_counted_once() {
        assert!((combined(&[0.7]) - 0.7).abs() < 1e-12);
        // A rig whose records carry no information has the prior probability and changes nothing.
        assert!((combined(&[0.7, PRIOR, PRIOR]) - 0.7).abs() < 1e-12);
        // Odds of 7/3 twice over, against a prior of 1/4: 49/9·4 = 21.8.
        assert!((combined(&[0.7, 0.7]) - 21.777_8 / 22.777_8).abs() < 1e-6);
    }

    #[test]
    fn no_rig_overrules_all_others() {
        assert!(combined(&[0.0, 0.99, 0.99]) > 0.5);
        assert!(combined(&[1.0, 0.01, 0.01, 0.01]) < 0.5);
        assert!(combined(&[0.0, 0.0]) > 0.0 && combined(&[1.0, 1.0]) < 1.0);
    }

    #[test]
    fn values_within_their_errors_agree_and_others_are_told_apart() {
        let (a, b, c) = (value(2.0, 0.01, "N m"), value(2.01, 0.01, "N m"), value(2.5, 0.01, "N m"));
        let row = coefficient("gravity", "Gravity", "torque", &[("A", &a), ("B", &b)]);
        assert_eq!((row.agree, row.degrees), (Some(true), 1));
        assert!((row.mean.unwrap().value - 2.005).abs() < 1e-12);
        assert_eq!(
            told(&row).replace('\u{a0}', " "),
            "torque of gravity 2.00, 2.01 N m, the same within errors"
        );
        let row = coefficient("gravity", "Gravity", "torque", &[("A", &a), ("B", &b), ("C", &c)]);
        assert_eq!((row.agree, row.mean), (Some(false), None));
        assert!(told(&row).ends_with("not the same: A and C differ by 35 standard errors"), "{}", told(&row));
    }

    #[test]
    fn values_in_other_units_and_single_ones_are_not_compared() {
        let (a, b) = (value(2.0, 0.01, "N m"), value(2.0, 0.01, "rad/s^2"));
        let row = coefficient("gravity", "Gravity", "torque", &[("A", &a), ("B", &b)]);
        assert_eq!((row.agree, row.unit.as_str()), (None, ""));
        assert!(told(&row).ends_with("cannot be compared"), "{}", told(&row));
        let row = coefficient("gravity", "Gravity", "torque", &[("A", &a)]);
        assert!(told(&row).contains("determined only by A,"), "{}", told(&row));
    }
}
