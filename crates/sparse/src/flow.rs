//! Integration of a law in time, with its derivatives by the parameters.
//!
//! Reference: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, 2nd ed. (Springer 1993),
//! table II.5.2 (the method of Dormand and Prince), section II.4 (its step), section I.14 (derivatives).

use crate::law::Law;

/// Nodes of the stages; then, for each stage, the weights of the stages before it. The last stage lies at the
/// end of the step, and its weights are those of the step.
const NODES: [f64; 7] = [0.0, 0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0];
const STAGES: [&[f64]; 7] = [
    &[],
    &[0.2],
    &[3.0 / 40.0, 9.0 / 40.0],
    &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
    &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0],
    &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
    &[35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];
/// Weights of the fifth-order step minus those of the fourth-order step.
const ERRORS: [f64; 7] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0];

/// Largest error of a step in ln A, relative to 1 + |ln A|; then that of a derivative, relative to 1 plus its
/// size.
const TOLERANCE: f64 = 1e-11;
const TOLERANCE_OF_DERIVATIVES: f64 = 1e-8;

/// First step, as a share of the record.
const FIRST_STEP: f64 = 1e-3;

/// Shortest step, as a share of 1 plus the scaled time. A law that needs a shorter one has no finite value
/// beyond.
const SHORTEST_STEP: f64 = 1e-14;

/// Most steps in one direction; the law is not followed further.
const MOST_STEPS: usize = 100_000;

/// State of a law that is followed in time.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct State {
    /// x = ln A − mean.
    pub(crate) log: f64,
    /// Derivatives of x by its initial value, by the constant rate and by the terms' coefficients.
    pub(crate) derivatives: Vec<f64>,
}

impl State {
    /// Creates a start state; its value is the first of the parameters.
    pub(crate) fn start(log: f64, law: &Law) -> Self {
        let mut derivatives = vec![0.0; law.parameters()];
        if let Some(own) = derivatives.first_mut() {
            *own = 1.0;
        }
        Self { log, derivatives }
    }

    fn lost(log: f64, law: &Law) -> Self {
        Self { log, derivatives: vec![f64::NAN; law.parameters()] }
    }

    fn moved(&self, step: f64, weights: &[f64], slopes: &[Self]) -> Self {
        let mut sum = self.clone();
        for (weight, slope) in weights.iter().zip(slopes) {
            let share = step * weight;
            sum.log += share * slope.log;
            let pairs = sum.derivatives.iter_mut().zip(&slope.derivatives);
            pairs.for_each(|(own, theirs)| *own += share * theirs);
        }
        sum
    }

    fn is_finite(&self) -> bool {
        self.log.is_finite() && self.derivatives.iter().all(|entry| entry.is_finite())
    }
}

impl Law {
    /// Returns d/ds of a state: the rate of the law, and the derivatives of the rate by every parameter.
    fn slope(&self, state: &State, time: f64) -> State {
        let by_log = self.gradient(state.log);
        let own = std::iter::once(0.0)
            .chain([1.0])
            .chain(self.terms.iter().map(|(column, _)| column.value(state.log, time)));
        let derivatives =
            state.derivatives.iter().zip(own).map(|(along, own)| by_log * along + own).collect();
        State { log: self.rate(state.log, time), derivatives }
    }

    /// Takes one step; returns the new state and the error as a multiple of the tolerance.
    fn step(&self, state: &State, time: f64, step: f64) -> (State, f64) {
        let mut slopes: Vec<State> = Vec::with_capacity(STAGES.len());
        let mut next = state.clone();
        for (node, weights) in NODES.iter().zip(STAGES) {
            next = state.moved(step, weights, &slopes);
            slopes.push(self.slope(&next, time + node * step));
        }
        let zero = State { log: 0.0, derivatives: vec![0.0; state.derivatives.len()] };
        let off = zero.moved(step, &ERRORS, &slopes);
        let of_derivatives = off
            .derivatives
            .iter()
            .zip(&next.derivatives)
            .map(|(off, value)| off.abs() / (TOLERANCE_OF_DERIVATIVES * (1.0 + value.abs())));
        let error = of_derivatives.fold(off.log.abs() / (TOLERANCE * (1.0 + next.log.abs())), f64::max);
        let finite = next.is_finite() && off.is_finite();
        (next, if finite { error } else { f64::INFINITY })
    }

    /// Follows the law from a state at a time to other times, which all lie later or all lie earlier, in the
    /// order of passing them.
    ///
    /// The step sizes depend on the law only: the state at one time does not depend on the other times. If ln
    /// A diverges in a finite time, it is infinite from there on: −∞ for a motion that has come to rest. If
    /// the steps are used up, it is NaN.
    pub(crate) fn follow(&self, from: &State, start: f64, times: &[f64]) -> Vec<State> {
        let mut found: Vec<State> = Vec::with_capacity(times.len());
        let mut rest = times.iter().copied().peekable();
        let way = if rest.peek().is_some_and(|time| *time < start) { -1.0 } else { 1.0 };
        let (mut state, mut now, mut length) = (from.clone(), start, FIRST_STEP);
        let mut end = f64::NAN;
        for _ in 0..MOST_STEPS {
            if rest.peek().is_none() {
                return found;
            }
            let (next, error) = self.step(&state, now, way * length);
            if error <= 1.0 {
                let then = now + way * length;
                while let Some(time) = rest.next_if(|time| (*time - then) * way <= 0.0) {
                    found.push(self.step(&state, now, time - now).0);
                }
                (state, now) = (next, then);
            }
            // Safety factor and bounds as in the textbook.
            length *= (0.9 * error.powf(-0.2)).clamp(0.2, 5.0);
            if length < SHORTEST_STEP * (1.0 + now.abs()) {
                end = f64::INFINITY.copysign(way * self.rate(state.log, now));
                break;
            }
        }
        found.extend(rest.map(|_| State::lost(end, self)));
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Column;
    use crate::scaled::Scaled;
    use crate::term::Term;
    use envelope::Envelope;

    fn scaled() -> Scaled {
        let times: Vec<f64> = (0..30).map(f64::from).collect();
        let logs = times.iter().map(|t| -0.1 * t).collect();
        Scaled::of(&Envelope::new(times, logs, 6.0).unwrap()).unwrap()
    }

    /// Law dA/ds = −viscous·A − dry − drag·A² with A = exp(x).
    fn law(scaled: &Scaled, [viscous, dry, drag]: [f64; 3]) -> Law {
        let mut law = Law::new(-viscous, Vec::new(), scaled.logs.clone(), scaled);
        for (term, wanted) in [(Term::InverseAmplitude, -dry), (Term::Amplitude, -drag)] {
            let column = Column::over(term, scaled).unwrap();
            // A column is the term minus its mean, over its deviation; undo both.
            let (at_zero, unit) = (column.value(0.0, 0.0), column.value(1.0, 0.0));
            let deviation = term.value(1.0, 0.0) / (unit - at_zero);
            let factor = wanted * deviation;
            law.constant += wanted - factor * at_zero;
            law.terms.push((column, factor));
        }
        law
    }

    #[test]
    fn the_tables_are_consistent() {
        for (node, weights) in NODES.iter().zip(STAGES) {
            assert!((weights.iter().sum::<f64>() - node).abs() < 1e-14, "{node}");
        }
        assert!(ERRORS.iter().sum::<f64>().abs() < 1e-15);
    }

    #[test]
    fn drag_is_followed_both_ways() {
        // For pure drag A = 1/(s/2 + 1/A(0)).
        let scaled = scaled();
        let law = law(&scaled, [0.0, 0.0, 0.5]);
        let start = State::start(0.3, &law);
        let times = [0.1, 0.5, 1.0, 40.0, 1e6];
        for (time, state) in times.iter().zip(law.follow(&start, 0.0, &times)) {
            let expected = -(0.5 * time + (-0.3_f64).exp()).ln();
            assert!((state.log - expected).abs() < 1e-9, "{time}: {} {expected}", state.log);
        }
        // Backward in time it diverges at s = −2·exp(−0.3).
        let found = law.follow(&start, 0.0, &[-0.5, -1.0, -1.48, -1.49]);
        let expected = |time: f64| -(0.5 * time + (-0.3_f64).exp()).ln();
        assert!((found[1].log - expected(-1.0)).abs() < 1e-9);
        assert!((found[2].log - expected(-1.48)).abs() < 1e-7 && found[3].log == f64::INFINITY);
    }

    #[test]
    fn dry_friction_brings_the_motion_to_rest() {
        // A = (A(0) + d/v)·exp(−v·s) − d/v, which is zero at s = ln(1 + A(0)·v/d)/v.
        let scaled = scaled();
        let law = law(&scaled, [0.7, 0.4, 0.0]);
        let end = (1.0_f64 + 0.7 / 0.4).ln() / 0.7;
        let times = [0.5 * end, 0.999 * end, end * (1.0 + 1e-9), 2.0 * end];
        let found = law.follow(&State::start(0.0, &law), 0.0, &times);
        for (time, state) in times.iter().zip(&found).take(2) {
            let expected = ((1.0 + 0.4 / 0.7) * (-0.7 * time).exp() - 0.4 / 0.7).ln();
            assert!((state.log - expected).abs() < 1e-7, "{time}: {} {expected}", state.log);
        }
        assert_eq!([found[2].log, found[3].log], [f64::NEG_INFINITY; 2]);
        assert!(found[3].derivatives[0].is_nan());
    }

    #[test]
    fn the_derivatives_are_those_of_differences() {
        let scaled = scaled();
        let base = law(&scaled, [0.7, 0.05, 0.4]);
        let at = |law: &Law, start: f64| law.follow(&State::start(start, law), 0.0, &[0.9, 1.7]);
        let found = at(&base, 0.2);
        let step = 1e-4;
        for parameter in 0..base.parameters() {
            let moved = |way: f64| {
                let (mut law, mut start) = (base.clone(), 0.2);
                match parameter {
                    0 => start += way,
                    1 => law.constant += way,
                    term => law.terms[term - 2].1 += way,
                }
                at(&law, start)
            };
            for (at, (up, down)) in moved(step).iter().zip(moved(-step)).enumerate() {
                let difference = (up.log - down.log) / (2.0 * step);
                let exact = found[at].derivatives[parameter];
                assert!((difference - exact).abs() < 1e-6, "{parameter}: {difference} {exact}");
            }
        }
    }

    #[test]
    fn what_is_found_does_not_depend_on_the_other_times() {
        let scaled = scaled();
        let law = law(&scaled, [0.7, 0.05, 0.4]);
        let start = State::start(0.2, &law);
        let many = law.follow(&start, 0.0, &[0.1, 0.4, 0.41, 1.3, 2.0]);
        assert_eq!(law.follow(&start, 0.0, &[1.3])[0], many[3]);
    }
}
