//! Estimate by the discovered law, and the report on it in words.

use crate::choice::choose;
use crate::law::{Law, number};
use crate::path::Path;
use crate::prediction::predictions;
use crate::scaled::Scaled;
use estimator::{Estimate, ModelFile, Reached, Stop, Uncertainty};
use nalgebra::DMatrix;

/// Regression of a method, as the errors of an estimate need it.
pub struct Regression<'a> {
    /// Method's own text before the path: whole paragraphs, or empty.
    pub method: &'a str,
    /// Instruments of the regression along a law's trajectory, peaks by parameters: their products with the residuals at
    /// the peaks are zero.
    pub instruments: &'a dyn Fn(&Law) -> DMatrix<f64>,
    /// Information on a constant law's rate in scaled time, per variance of the scatter at a peak.
    pub information: f64,
}

impl Regression<'_> {
    /// Returns the estimate by the simplest law of a path whose criterion is within `evidence` of the best, with
    /// predictions at times in seconds after the first peak. A path that halted states no errors.
    #[must_use]
    pub fn estimate(
        &self,
        scaled: &Scaled,
        path: &Path,
        evidence: f64,
        steps: u64,
        query_times: &[f64],
    ) -> Estimate {
        let chosen = choose(&path.laws, scaled, evidence);
        let law = chosen.as_ref().map_or(&path.latest, |(law, _)| law);
        let equation = law.equation(scaled);
        let criteria = chosen.as_ref().map_or(&[][..], |(_, criteria)| criteria);
        let stop = path.halt.map_or_else(
            || Stop { reached: Reached::Converged, because: because(&equation, law, path, criteria) },
            |halt| halt.stop(steps, &equation),
        );
        let fitted: Vec<f64> = law.trajectory.iter().map(|x| x + scaled.mean).collect();
        let has_settled = path.halt.is_none();
        let instruments = (has_settled && !query_times.is_empty()).then(|| (self.instruments)(law));
        Estimate {
            decay_rate: scaled.decay_rate(&law.trajectory),
            log_amplitude: fitted.first().copied().unwrap_or(scaled.mean),
            uncertainty: self.uncertainty(scaled, law).filter(|_| has_settled),
            stop,
            steps,
            parameters: law.parameters(),
            model: Some(ModelFile {
                name: "equation.txt".to_owned(),
                bytes: model_text(scaled, law, path, criteria, self.method).into_bytes(),
            }),
            fitted_log_amplitudes: fitted,
            predictions: predictions(law, scaled, instruments, query_times),
            equation: Some(equation),
        }
    }

    /// Returns the interval by the scatter about a law, with the information on a constant rate.
    fn uncertainty(&self, scaled: &Scaled, law: &Law) -> Option<Uncertainty> {
        let degrees = scaled.peaks().checked_sub(law.parameters()).filter(|degrees| *degrees > 0)? as f64;
        let std_error = (law.squares / degrees / self.information).sqrt() / scaled.span_s;
        Uncertainty::students_t(scaled.decay_rate(&law.trajectory), std_error, degrees)
    }
}

/// Returns one sentence on why the fit stopped: the law, the number of laws compared, and how far its
/// information criterion lies below that of an exponential. `criteria` holds one value per law of the path,
/// in its order.
fn because(equation: &str, law: &Law, path: &Path, criteria: &[f64]) -> String {
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
fn model_text(scaled: &Scaled, law: &Law, path: &Path, criteria: &[f64], method: &str) -> String {
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
