//! Estimate from the result of the evolution.

use crate::basis::TangentSpace;
use crate::config::SymbolicConfig;
use crate::constants::{FULL, fit_constants, loss, tangent_space};
use crate::data::Data;
use crate::equation::Equation;
use crate::evolution::{Evolved, evolve};
use crate::expression::{Expression, Workspace};
use crate::front::{Front, Member};
use crate::operators::Binary;
use envelope::Envelope;
use estimator::{
    Estimate, Estimator, FitContext, FitError, ModelFile, Prediction, Reached, Stop, Uncertainty,
};
use std::fmt::Write;

/// Fewest peaks: two parameters and a degree of freedom.
const FEWEST_PEAKS: usize = 3;

impl Estimator for SymbolicConfig {
    fn fit(&self, envelope: &Envelope, context: &FitContext<'_>) -> Result<Estimate, FitError> {
        if envelope.len() < FEWEST_PEAKS {
            return Err(FitError::TooFewPeaks {
                estimator: "symbolic",
                found: envelope.len(),
                needed: FEWEST_PEAKS,
            });
        }
        let mut data = Data::new(envelope)?;
        data.times = context.input("times", data.times);
        let mut workspace = Workspace::default();
        let evolved = evolve(self, &data.thinned(self.search_peaks), context);
        if evolved.generations == 0 {
            return Ok(untrained(&data, &evolved, context.query_times(), &mut workspace));
        }
        let found = if context.is_at_zero() { &Front::default() } else { &evolved.front };
        let front = whole_front(found, &data, &mut workspace);
        // If the constants diverge with the line, the next expression is tried.
        let settled = front.by_preference(&data).find_map(|member| {
            let joined = with_line(member, &data, &mut workspace)?;
            Some((member, joined))
        });
        let Some((chosen, joined)) = settled else {
            return Ok(untrained(&data, &evolved, context.query_times(), &mut workspace));
        };
        let rank = tangent_space(&joined, &data, &mut workspace).rank();
        let report = report(&front, chosen, &joined, &data);
        let stop = stop(&evolved, &Equation::new(&chosen.expression, &data));
        let mut estimate = describe(&joined, &data, stop, &mut workspace);
        estimate.steps = evolved.generations;
        estimate.uncertainty = uncertainty(&estimate, &joined, rank, &data, &mut workspace);
        let query_times = context.query_times();
        estimate.predictions = predictions(&joined, &data, Scatter::Fitted, query_times, &mut workspace);
        estimate.model = Some(ModelFile { name: "equation.txt".to_owned(), bytes: report.into_bytes() });
        Ok(estimate)
    }
}

/// Fits the front to all peaks; if an odd envelope leaves nothing, the front is a constant.
fn whole_front(front: &Front, data: &Data, workspace: &mut Workspace) -> Front {
    let mut polished = front.polished(data, workspace);
    if polished.members().is_empty() {
        // The mean of the scaled amplitudes is zero.
        let constant = Expression::constant(0.0);
        let loss = loss(&constant, data, workspace);
        polished.offer(&constant, loss, data, workspace);
    }
    polished
}

/// Adds the part of a straight line a + b·x that the expression lacks, and fits all constants together from
/// their present values.
///
/// Without the line the slope of a bent expression would depend on the misfit of its shape, since the
/// expression is fitted to the peaks and not to their slope. With it the residuals are orthogonal to every
/// straight line, and the expression's projected slope is that of the best exponential. An expression that
/// contains a free line stays as it is. `None` if the constants then do not settle.
fn with_line(chosen: &Member, data: &Data, workspace: &mut Workspace) -> Option<Expression> {
    let mut joined = chosen.expression.clone();
    let mut space: TangentSpace = tangent_space(&joined, data, workspace);
    let level = vec![1.0; data.len()];
    if space.extend(&level) {
        joined = Expression::binary(Binary::Add, joined, &Expression::constant(0.0));
    }
    if space.extend(&data.times) {
        let slope = Expression::binary(Binary::Multiply, Expression::constant(0.0), &Expression::time());
        joined = Expression::binary(Binary::Add, joined, &slope);
    }
    let fitted = fit_constants(&mut joined, data, FULL, workspace);
    (fitted.settled && fitted.loss.is_finite()).then_some(joined)
}

fn untrained(data: &Data, evolved: &Evolved, query_times: &[f64], workspace: &mut Workspace) -> Estimate {
    let drawn = &evolved.drawn.expression;
    let stop = stop(evolved, &Equation::new(drawn, data));
    let predictions = predictions(drawn, data, Scatter::Unknown, query_times, workspace);
    Estimate { predictions, ..describe(drawn, data, stop, workspace) }
}

fn stop(evolved: &Evolved, equation: &Equation) -> Stop {
    let generations = evolved.generations;
    let why = match evolved.reached {
        Reached::Converged => format!("the held-out error fell no more by generation {generations}"),
        Reached::Interrupted => format!("interrupted after {generations} generations"),
        _ => format!(
            "the budget of {generations} generations ended; raise estimator.max_generations or fit.max_steps"
        ),
    };
    Stop { reached: evolved.reached, because: format!("{why}: ln A = {equation}") }
}

fn describe(expression: &Expression, data: &Data, stop: Stop, workspace: &mut Workspace) -> Estimate {
    let values = workspace.values(expression, &data.times);
    let fitted: Vec<f64> = values.iter().map(|&z| data.scaling.log_amplitude(z)).collect();
    Estimate {
        decay_rate: data.scaling.rate_per_unit_time(-data.projected_slope(values)),
        log_amplitude: fitted.first().copied().unwrap_or(data.scaling.mean()),
        uncertainty: None,
        stop,
        steps: 0,
        parameters: expression.constants().count(),
        fitted_log_amplitudes: fitted,
        predictions: Vec::new(),
        equation: Some(format!("ln A = {}", Equation::new(expression, data))),
        model: None,
    }
}

/// State of an expression's constants, which decides whether its residuals measure the scatter of the peaks.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Scatter {
    /// The constants were fitted.
    Fitted,
    /// The constants are as drawn.
    Unknown,
}

/// Evaluates the expression at the query times with plain arithmetic: infinite or NaN where it overflows or
/// leaves a domain, and on the other branch beyond a pole.
///
/// The variance of a measured ln A is s²·(1 + gᵀ(JᵀJ)⁻¹g), with g the derivatives by the effective constants
/// at that time and J those at the peaks: to first order, for the given expression.
fn predictions(
    expression: &Expression,
    data: &Data,
    scatter: Scatter,
    query_times: &[f64],
    workspace: &mut Workspace,
) -> Vec<Prediction> {
    if query_times.is_empty() {
        return Vec::new();
    }
    let asked = query_times.iter().map(|&time| data.scaling.unit_time(time));
    let points: Vec<f64> = data.times.iter().copied().chain(asked).collect();
    let values = workspace.values(expression, &points).to_vec();
    let space = TangentSpace::of(data.len(), workspace.derivatives(expression, points.len()));
    let leverages = space.leverages(points.len());
    let pairs = values.iter().zip(&data.targets);
    let squares: f64 = pairs.map(|(value, target)| (value - target).powi(2)).sum();
    let degrees = data.len().saturating_sub(space.rank());
    let known = scatter == Scatter::Fitted && degrees > 0;
    let predict = |(value, leverage): (&f64, f64)| {
        let std_error = || (squares / degrees as f64 * (1.0 + leverage)).sqrt();
        let std_error = known.then(|| data.scaling.deviation(std_error()));
        Prediction::new(data.scaling.log_amplitude(*value), std_error)
    };
    values.iter().zip(leverages).skip(data.len()).map(predict).collect()
}

/// Computes the standard error of the projected slope, s/√Σ(x − x̄)², with Student's t on the number of peaks
/// minus that of effective constants.
///
/// To first order in the scatter it is exact for the given expression, since the space of its derivatives
/// contains every line. It does not include the uncertainty from the choice of the expression by the data.
fn uncertainty(
    estimate: &Estimate,
    expression: &Expression,
    rank: usize,
    data: &Data,
    workspace: &mut Workspace,
) -> Option<Uncertainty> {
    let degrees = data.len().checked_sub(rank).filter(|degrees| *degrees > 0)? as f64;
    let squares = loss(expression, data, workspace) * data.len() as f64;
    let std_error = (squares / degrees / data.time_scatter()).sqrt();
    Uncertainty::students_t(estimate.decay_rate, data.scaling.rate_per_unit_time(std_error), degrees)
}

/// Writes the front as a text.
fn report(front: &Front, chosen: &Member, joined: &Expression, data: &Data) -> String {
    let mut text = String::new();
    let equation = Equation::new(&chosen.expression, data);
    let with_line = Equation::new(joined, data);
    let mut line = |written: std::fmt::Arguments<'_>| {
        // Writing to a string does not fail.
        let _ = text.write_fmt(written);
        text.push('\n');
    };
    line(format_args!("ln A = {equation}"));
    line(format_args!(""));
    line(format_args!(
        "# t in seconds after the first peak. The simplest expression whose held-out error is"
    ));
    line(format_args!(
        "# within one standard error (+-) of the least, from the front of error against nodes."
    ));
    if *joined != chosen.expression {
        line(format_args!("#"));
        line(format_args!("# Fitted together with the straight line that it lacks, for the decay rate:"));
        line(format_args!("# ln A = {with_line}"));
    }
    line(format_args!("#"));
    line(format_args!("# nodes  error (rms of ln A)  held-out error  held-out mean square +-  ln A"));
    for member in front.members() {
        let mark = if member == chosen { '>' } else { ' ' };
        let spread = data.scaling.spread();
        line(format_args!(
            "#{mark}{:5}  {:19.4e}  {:14.4e}  {:11.4e} {:11.4e}  {}",
            member.expression.complexity(),
            spread * member.loss.sqrt(),
            spread * member.held_out.mean.sqrt(),
            spread * spread * member.held_out.mean,
            spread * spread * member.held_out.std_error,
            Equation::new(&member.expression, data),
        ));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::{Scatter, predictions};
    use crate::data::Data;
    use crate::expression::{Expression, Workspace};
    use crate::operators::{Binary, Unary};
    use envelope::Envelope;

    #[test]
    fn where_an_expression_leaves_its_domain_or_overflows_it_says_so() {
        let times: Vec<f64> = (0..20).map(f64::from).collect();
        let logs = times.iter().map(|t| 1.0 - 0.1 * t).collect();
        let data = Data::new(&Envelope::new(times, logs, 6.0).unwrap()).unwrap();
        let rest = Expression::binary(Binary::Subtract, Expression::constant(1.5), &Expression::time());
        let root = Expression::unary(Unary::SquareRoot, rest.clone());
        let at = |expression: &Expression, times: &[f64]| {
            predictions(expression, &data, Scatter::Fitted, times, &mut Workspace::default())
        };
        let found = at(&root, &[19.0, 38.0]);
        let expected = data.scaling.log_amplitude(0.5_f64.sqrt());
        assert!((found[0].log_amplitude - expected).abs() < 1e-14 && found[0].std_error.is_some());
        assert!(found[1].log_amplitude.is_nan() && found[1].std_error.is_none());
        let found = at(&Expression::unary(Unary::Exp, rest), &[19.0, -19e3]);
        assert!(found[0].std_error.is_some());
        assert_eq!((found[1].log_amplitude, found[1].std_error), (f64::INFINITY, None));
    }
}
