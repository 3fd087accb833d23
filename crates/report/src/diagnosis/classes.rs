//! First screen of a diagnosis: classes of effects as bars, the most certain first, and the share without a
//! name.

use results::DiagnosisResult;

use crate::classes::{
    ClassStatement, Standing, capitalized, class_statements, class_title, kind_title, nameless_share,
};
use crate::format::{self, significant};

/// Largest plausible sum of the kinds' shares: they add up to 1, unless stamps or values show a kind beside
/// the fitted ones.
const MOST_SHARED: f64 = 1.01;

/// Classes with the same standing.
pub(super) struct Group {
    /// `Certain`, `Likely` or `Open`.
    pub(super) title: String,
    /// Name of the class in the style sheet, and tag at each row.
    pub(super) word: &'static str,
    /// Probabilities with this standing.
    pub(super) range: String,
    pub(super) rows: Vec<ClassView>,
}

/// A class with its bars.
pub(super) struct ClassView {
    pub(super) title: String,
    pub(super) probability: Bar,
    /// Share of the gap; `None` if the repaired simulator has no effect of the class.
    pub(super) share: Option<Bar>,
    /// Share of bootstrap draws of the segments in which the class is found again; `None` without a fit.
    pub(super) stability: Option<String>,
    pub(super) sentence: String,
    /// Kinds with their shares of the class, if there are several.
    pub(super) kinds: Vec<(String, Bar)>,
}

/// A bar with its number.
pub(super) struct Bar {
    pub(super) text: String,
    /// Length in percent.
    pub(super) length: String,
}

impl Bar {
    fn new(text: String, share: f64) -> Self {
        Self { text, length: format!("{:.1}", 100.0 * share.clamp(0.0, 1.0)) }
    }
}

/// Share of the gap without a name, and the left-over of the repaired simulator.
pub(super) struct Nameless {
    pub(super) bar: Bar,
    pub(super) note: String,
}

/// Returns the classes that are certain, likely or open; standings without a class are left out.
pub(super) fn groups(result: &DiagnosisResult) -> Vec<Group> {
    let all = class_statements(result);
    Standing::ALL
        .into_iter()
        .filter_map(|standing| {
            let own = all.iter().filter(|one| one.standing == standing);
            let rows: Vec<ClassView> = own.map(|one| view(result, one)).collect();
            (!rows.is_empty()).then(|| Group {
                title: capitalized(standing.word()),
                word: standing.word(),
                range: match standing {
                    Standing::Certain => "probability 0.9 or more",
                    Standing::Likely => "probability 0.5 to 0.9",
                    Standing::Open => "probability 0.1 to 0.5, and something speaks for it",
                }
                .to_owned(),
                rows,
            })
        })
        .collect()
}

fn view(result: &DiagnosisResult, one: &ClassStatement<'_>) -> ClassView {
    let class = one.class;
    let is_split =
        class.kinds.len() > 1 && class.kinds.iter().map(|kind| kind.share).sum::<f64>() < MOST_SHARED;
    let kinds = class.kinds.iter().filter(|kind| is_split && kind.share >= 0.01);
    ClassView {
        title: capitalized(&class_title(&class.id)),
        probability: Bar::new(format::probability(class.probability), class.probability),
        share: class.gap_share.map(|share| Bar::new(format::share(share.value), share.value)),
        stability: one.is_fitted.then(|| format::share(class.stability)),
        sentence: one.sentence.clone(),
        kinds: kinds
            .map(|kind| {
                let title = capitalized(&kind_title(result, &class.id, &kind.id));
                (title, Bar::new(format::share(kind.share), kind.share))
            })
            .collect(),
    }
}

/// Returns the share without a name, if there is a gap that can be divided.
pub(super) fn nameless(result: &DiagnosisResult) -> Option<Nameless> {
    let share = nameless_share(result)?;
    let left = result.left_over?;
    let note = if left.over_noise.is_finite() {
        format!("The repaired simulator leaves {} × noise.", significant(left.over_noise, 3))
    } else {
        String::new()
    };
    Some(Nameless { bar: Bar::new(format::share(share), share), note })
}
