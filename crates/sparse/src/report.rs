//! Report on the discovered law in words.

use crate::law::{Law, number};
use crate::path::Path;
use crate::scaled::Scaled;

/// Returns one sentence on why the fit stopped: the law, the number of laws compared, and how far its
/// information criterion lies below that of an exponential. `criteria` holds one value per law of the path,
/// in its order.
pub fn because(equation: &str, law: &Law, path: &Path, criteria: &[f64]) -> String {
    debug_assert_eq!(path.laws.len(), criteria.len(), "a criterion for each law");
    let criterion_of = |parameters: usize| {
        path.laws
            .iter()
            .zip(criteria)
            .find(|(law, _)| law.parameters() == parameters)
            .map(|(_, found)| *found)
    };
    let own = criterion_of(law.parameters()).unwrap_or(f64::NAN);
    let compared = path.laws.len();
    if law.terms.is_empty() {
        format!("{equation}: of {compared} laws no richer one earns its terms")
    } else {
        let gain = criterion_of(2).unwrap_or(f64::NAN) - own;
        format!(
            "{equation}: of {compared} laws the simplest that explains the peaks; its information criterion is \
             {gain:.1} below that of an exponential"
        )
    }
}

/// Returns the text of the model file: the law, the definition of λ, and the path that the law was chosen
/// from.
///
/// `method` is the method's own text before the path: whole paragraphs, or empty.
pub fn model_text(scaled: &Scaled, law: &Law, path: &Path, criteria: &[f64], method: &str) -> String {
    let start = law.start() + scaled.mean;
    let mut text = format!(
        "{}\n{}\nA(0) = {}\n\nA in the record's unit, t in seconds after the first peak.\n",
        law.equation(scaled),
        law.amplitude_equation(scaled),
        number(start.exp()),
    );
    text.push_str(&format!(
        "lambda = {} 1/s: {}.\n\n",
        scaled.decay_rate(&law.trajectory),
        if law.terms.is_empty() {
            "minus the constant"
        } else {
            "minus the slope of the line fitted to this law's ln A(t) at the peaks"
        }
    ));
    text.push_str(method);
    text.push_str("Laws compared (information criterion, rms scatter of ln A):\n");
    for (law, criterion) in path.laws.iter().zip(criteria) {
        let scatter = (law.squares / scaled.peaks() as f64).sqrt();
        text.push_str(&format!("{criterion:10.2}  {scatter:.3e}  {}\n", law.equation(scaled)));
    }
    if path.unsettled > 0 {
        text.push_str(&format!("{} more did not settle.\n", path.unsettled));
    }
    text
}
