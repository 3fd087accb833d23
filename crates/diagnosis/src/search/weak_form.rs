//! Sets of laws that the weak form of the equation of motion prefers, with values to begin their fits at.
//!
//! A fit of trajectories that begins at the recalibrated simulator is lost if a missing law outweighs the laws
//! of the simulator, or if it has a shape (the width of a play, the place of a stop) that is far off. The weak
//! form needs no trajectory. Multiplied by a bump φ and integrated by parts over it, the equation of motion
//! I·ẍ + c·ẋ + k·(x − x₀) = u + Σ bⱼ·τⱼ is linear in I, c, k, k·x₀ and bⱼ, with derivatives of φ in place of
//! those of the record (Messenger and Bortz, "Weak SINDy for partial differential equations", Journal of
//! Computational Physics 443, 2021). Here x is the smoothed record, and every law takes part at each shape of a
//! dense grid. Effects of the sensor take no part: with an error in proportion to the motion nothing would be
//! left of the equation. A smoothed record holds noise that it
//! is asked to explain, so the solution is a start for a fit and no evidence.

use crate::data::scales::Scales;
use crate::data::segments::{Data, Segment};
use crate::fit::fitted::Fit;
use crate::linear::dictionary::{Dictionary, Gain};
use crate::matrices::{product, solve};
use crate::model::candidate::Candidate;
use crate::model::candidates::{Along, driven};
use crate::model::hypothesis::{Calibrated, Hypothesis};
use crate::model::predictor::Motion;
use crate::residual::floor;
use crate::search::bump::bumps;
use crate::search::gains::best_of_each;
use crate::search::smoothed::smoothed;
use dynamics::{Coefficients, Input, Nominal};
use nalgebra::DMatrix;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Fewest bumps for each unknown of the oscillator.
const ROWS: usize = 8;

/// Number of sets of each size that are extended, and that are returned.
const WIDTH: usize = 10;
const BEST: usize = 3;

/// Set of laws with the values at which its fit begins.
#[derive(Debug)]
pub(crate) struct Begun {
    pub(crate) hypothesis: Hypothesis,
    pub(crate) globals: Vec<f64>,
}

/// Sets that the weak form proposes, and the motion that they begin at.
#[derive(Debug, Default)]
pub(crate) struct Proposed {
    pub(crate) sets: Vec<Begun>,
    /// Times with position and velocity, by record.
    states: Vec<Vec<(f64, [f64; 2])>>,
}

impl Proposed {
    /// Proposes the best sets of up to `most` laws: with a free rest angle, and with the stated one. The torque of a
    /// servo's drive follows from the coefficients themselves, and calibration without a missing limit of it may put
    /// them far off: a driven record is also tried with the stated ones.
    pub(crate) fn of(data: &Data, calibrated: &Fit, candidates: &[Candidate], most: usize) -> Self {
        let hypothesis = &calibrated.hypothesis;
        let stated =
            hypothesis.calibrated.contains(&Calibrated::RestAngle).then(|| hypothesis.nominal.rest_angle());
        let own = hypothesis.calibrated_nominal(&calibrated.point.globals).ok();
        let given = (data.facts.drive_torque > 0.0).then_some((hypothesis.nominal, None));
        let rests = [None].into_iter().chain(stated.map(Some));
        let tried: Vec<(Nominal, Option<f64>)> =
            given.into_iter().chain(rests.filter_map(|rest| Some((own?, rest)))).collect();
        let found =
            tried.par_iter().map(|(own, rest)| WeakForm::of(data, calibrated, candidates, (own, *rest)));
        let found: Vec<Option<(Self, Vec<Begun>)>> =
            found.map(|own| own.map(|own| (own.motion(), own.sets(most)))).collect();
        found.into_iter().flatten().fold(Self::default(), |all, (motion, sets)| Self {
            sets: all.sets.into_iter().chain(sets).collect(),
            ..motion
        })
    }

    /// Returns the sets of which at least one member has a property.
    pub(crate) fn with_members(mut self, has: impl Fn(&Candidate) -> bool) -> Self {
        self.sets.retain(|set| set.hypothesis.candidates.iter().any(&has));
        self
    }

    /// Returns position and velocity of a record at a time of one of its samples, or of the next one.
    pub(crate) fn state(&self, record: usize, time: f64) -> Option<[f64; 2]> {
        let states = self.states.get(record)?;
        let at = states.partition_point(|(own, _)| *own < time);
        states.get(at).or(states.last()).map(|(_, state)| *state)
    }
}

/// Equations of the weak form, one row for each bump.
struct WeakForm<'a> {
    data: &'a Data,
    hypothesis: &'a Hypothesis,
    /// Closest oscillator.
    nominal: Nominal,
    /// `true` for each of the oscillator's terms that is solved for.
    free: [bool; 4],
    /// Runs of joined segments with their smoothed motions.
    runs: Vec<(Segment, Motion)>,
    /// Columns of the oscillator's free coefficients, and the torque that the others leave.
    oscillator: DMatrix<f64>,
    torque: DMatrix<f64>,
    /// Columns of the laws; `dictionary` has them without what the oscillator absorbs.
    laws: DMatrix<f64>,
    dictionary: Dictionary,
}

impl<'a> WeakForm<'a> {
    /// Sets up the equations of a data set about an oscillator; `None` if there are no laws or too few samples. Laws about the rest
    /// angle, such as a play, have their middle at the `rest` angle if one is given, and a constant torque is
    /// then one of the laws; otherwise the rest angle is free.
    fn of(
        data: &'a Data,
        calibrated: &'a Fit,
        candidates: &[Candidate],
        (found, rest): (&Nominal, Option<f64>),
    ) -> Option<Self> {
        let hypothesis = &calibrated.hypothesis;
        let own = found.coefficients();
        let rest_angle = rest.unwrap_or(own.rest_angle);
        let nominal = found.with_coefficients(Coefficients { rest_angle, ..own }).ok()?;
        let free = Calibrated::PLAIN.map(|own| {
            hypothesis.calibrated.contains(&own) && (own != Calibrated::RestAngle || rest.is_none())
        });
        let noise = floor::floor(data, &calibrated.residuals).value;
        let runs = data.joined(usize::MAX).segments;
        let smoothed = |run: Segment| {
            let motion = smoothed(data, &run, &nominal, noise);
            (run, motion)
        };
        let runs: Vec<(Segment, Motion)> = runs.into_par_iter().map(smoothed).collect();
        let entries: Vec<(Candidate, Vec<f64>)> = candidates
            .iter()
            .filter(|law| law.system().is_some())
            .flat_map(|law| law.dense_shapes(&data.facts).into_iter().map(|shape| (*law, shape)))
            .collect();
        let mut rows = Rows::default();
        for run in &runs {
            let seen = Seen::of(data, run, &nominal, rest.is_none());
            rows.add(&seen, hypothesis, &entries);
        }
        rows.equations(data, hypothesis, (nominal, free), runs, entries)
    }

    /// Returns the smoothed motion, without sets.
    fn motion(&self) -> Proposed {
        let state = |((time, position), velocity): ((&f64, &f64), &f64)| (*time, [*position, *velocity]);
        let mut states: Vec<Vec<(f64, [f64; 2])>> = vec![Vec::new(); self.data.inputs.len()];
        for (run, motion) in &self.runs {
            let own = run.times.iter().zip(&motion.position).zip(&motion.velocity).map(state);
            states.iter_mut().skip(run.record).take(1).for_each(|known| known.extend(own.clone()));
        }
        Proposed { sets: Vec::new(), states }
    }

    /// Returns the best sets of up to `most` laws, with the values that solve the equations.
    fn sets(&self, most: usize) -> Vec<Begun> {
        let mut kept: Vec<Gain> = vec![Gain { entries: Vec::new(), squares: 0.0, coefficients: Vec::new() }];
        let mut found = Vec::new();
        for _ in 0..most {
            kept = self.extended(&kept);
            found.extend(kept.iter().take(BEST).filter_map(|gain| self.begun(gain)));
        }
        found
    }

    /// Returns the best sets with one law more, each with its best shapes.
    fn extended(&self, sets: &[Gain]) -> Vec<Gain> {
        let all = 0..self.dictionary.entries.len();
        let with = |set: &Gain, entry: usize| {
            let entries = [set.entries.as_slice(), &[entry]].concat();
            (self.ranks(&entries), entries)
        };
        let larger = sets.iter().flat_map(|set| {
            let others = all.clone().filter(|entry| self.fits(&set.entries, *entry));
            others.map(|entry| with(set, entry))
        });
        let mut best = best_of_each(&self.dictionary, larger);
        best.truncate(WIDTH);
        let mut best: Vec<Gain> = best.into_iter().map(|gain| self.reshaped(gain)).collect();
        best.sort_by(|a, b| b.squares.total_cmp(&a.squares));
        best
    }

    /// Returns a set with the best shape of each member, given those of the others.
    fn reshaped(&self, gain: Gain) -> Gain {
        let mut best = gain;
        for place in 0..best.entries.len() {
            let Some(candidate) = best.entries.get(place).and_then(|entry| self.candidate(*entry)) else {
                continue;
            };
            for entry in
                (0..self.dictionary.entries.len()).filter(|own| self.candidate(*own) == Some(candidate))
            {
                let mut entries = best.entries.clone();
                entries.iter_mut().skip(place).take(1).for_each(|own| *own = entry);
                if let Some(other) = self.dictionary.gain(&entries).filter(|own| own.squares > best.squares) {
                    best = other;
                }
            }
        }
        best
    }

    fn candidate(&self, entry: usize) -> Option<Candidate> {
        self.dictionary.entries.get(entry).map(|own| own.candidate)
    }

    fn ranks(&self, entries: &[usize]) -> Vec<usize> {
        let candidates = entries.iter().filter_map(|entry| self.candidate(*entry));
        let mut ranks: Vec<usize> = candidates.map(|own| own.rank()).collect();
        ranks.sort_unstable();
        ranks
    }

    /// Returns `true` if a set has no law of an entry's class: two of them hardly differ along a smoothed record.
    fn fits(&self, set: &[usize], entry: usize) -> bool {
        let Some(own) = self.candidate(entry) else { return false };
        let mut members = set.iter().filter_map(|entry| self.candidate(*entry));
        members.all(|member| member.evidence_class() != own.evidence_class())
    }

    /// Returns the values at which the fit of a set begins; `None` if they are those of no oscillator.
    fn begun(&self, gain: &Gain) -> Option<Begun> {
        let columns: Vec<usize> = gain
            .entries
            .iter()
            .filter_map(|entry| self.dictionary.entries.get(*entry))
            .flat_map(|own| own.columns.clone())
            .collect();
        let coefficients = DMatrix::from_column_slice(gain.coefficients.len(), 1, &gain.coefficients);
        let rest = &self.torque - self.laws.select_columns(&columns) * coefficients;
        let solution = solve(&self.oscillator.tr_mul(&self.oscillator), &self.oscillator.tr_mul(&rest))?;
        let oscillator = self.oscillator_of(solution.as_slice())?;
        let stated = self.hypothesis.nominal_point();
        let calibrated = self.hypothesis.calibrated.iter().zip(stated);
        let mut globals: Vec<f64> = calibrated
            .map(|(which, stated)| if which.free().is_some() { which.of(&oscillator) } else { stated })
            .collect();
        let mut members: Vec<(Candidate, Vec<f64>)> = Vec::new();
        let mut sizes = gain.coefficients.as_slice();
        for entry in &gain.entries {
            let own = self.dictionary.entries.get(*entry)?;
            let (first, rest) = sizes.split_at_checked(own.columns.len())?;
            sizes = rest;
            // With the stiffness free, the coefficient of a law that is its own shape is not its secant's.
            let values = if own.candidate.is_its_own_shape() {
                own.shape.clone()
            } else {
                self.dictionary.parameters(*entry, first)
            };
            members.push((own.candidate, values));
        }
        members.sort_by_key(|(candidate, _)| candidate.rank());
        let candidates: Vec<Candidate> = members.iter().map(|(candidate, _)| *candidate).collect();
        globals.extend(members.into_iter().flat_map(|(_, values)| values));
        let is_finite = globals.iter().all(|value| value.is_finite());
        is_finite.then(|| Begun { hypothesis: self.hypothesis.with(&candidates), globals })
    }

    /// Returns the oscillator with the solved coefficients in place of those that are free.
    fn oscillator_of(&self, solution: &[f64]) -> Option<Coefficients<f64>> {
        let stated = self.nominal.coefficients();
        let mut terms = terms(&stated);
        let mut solved = solution.iter();
        for (term, _) in terms.iter_mut().zip(self.free).filter(|(_, free)| *free) {
            *term = *solved.next()?;
        }
        let [inertia, damping, stiffness, moment] = terms;
        let is_spring = stated.stiffness > 0.0;
        if inertia <= 0.0 || (is_spring && stiffness <= 0.0) {
            return None;
        }
        let [.., is_rest_free] = self.free;
        let rest_angle = if is_spring && is_rest_free { moment / stiffness } else { stated.rest_angle };
        // A fitted rest angle far outside of the swing shows that another law acts.
        let reach = 2.0 * self.data.facts.amplitude;
        let rest_angle = rest_angle.clamp(stated.rest_angle - reach, stated.rest_angle + reach);
        Some(Coefficients { inertia, damping: damping.max(0.0), stiffness, rest_angle, ..stated })
    }
}

/// Returns the coefficients of the oscillator's four terms.
fn terms(own: &Coefficients<f64>) -> [f64; 4] {
    [own.inertia, own.damping, own.stiffness, own.stiffness * own.rest_angle]
}

/// Rows of the equations as they are collected.
#[derive(Default)]
struct Rows {
    /// ∫φ̈·x, −∫φ̇·x, ∫φ·x and −∫φ: the factors of inertia, damping, stiffness, and stiffness times rest
    /// angle.
    oscillator: Vec<[f64; 4]>,
    /// ∫φ·u, plus the integrals of the torques of known effects.
    torque: Vec<f64>,
    /// ∫φ·τ of the laws' columns, and the number of columns of each entry.
    laws: Vec<Vec<f64>>,
    counts: Vec<usize>,
}

impl Rows {
    fn add(&mut self, seen: &Seen<'_>, hypothesis: &Hypothesis, entries: &[(Candidate, Vec<f64>)]) {
        let columns: Vec<Vec<Vec<f64>>> =
            entries.iter().map(|(law, shape)| seen.columns(*law, shape)).collect();
        self.counts = columns.iter().map(Vec::len).collect();
        let known = hypothesis
            .known
            .iter()
            .filter_map(|own| seen.torque(own.candidate, &own.candidate.values(&own.stated)));
        let acting: Vec<Vec<f64>> = known.chain(seen.input.iter().take(1).cloned()).collect();
        let ones = vec![1.0; seen.run.times.len()];
        let period = TAU / seen.data.facts.frequency;
        let rest_angle = seen.nominal.rest_angle();
        for bump in bumps(&seen.run.times, period) {
            let integral = |values: &[f64]| {
                let [integral, ..] = bump.integrals(values);
                integral
            };
            let [position, slope, bend] = bump.integrals(&seen.motion.position);
            let one = integral(&ones);
            let deflection = if seen.rest_is_free { position } else { position - rest_angle * one };
            self.oscillator.push([bend, -slope, deflection, if seen.rest_is_free { -one } else { 0.0 }]);
            self.torque.push(acting.iter().map(|torque| integral(torque)).sum());
            self.laws.push(columns.iter().flatten().map(|column| integral(column)).collect());
        }
    }

    /// Returns the equations; `None` without laws or with too few rows.
    fn equations<'a>(
        self,
        data: &'a Data,
        hypothesis: &'a Hypothesis,
        (nominal, free): (Nominal, [bool; 4]),
        runs: Vec<(Segment, Motion)>,
        entries: Vec<(Candidate, Vec<f64>)>,
    ) -> Option<WeakForm<'a>> {
        let held = terms(&nominal.coefficients());
        let count = free.iter().filter(|free| **free).count();
        let (rows, width) = (self.torque.len(), self.counts.iter().sum::<usize>());
        if width == 0 || rows < ROWS * count.max(1) {
            return None;
        }
        let both = |row: &[f64; 4]| -> Vec<(f64, (bool, f64))> {
            row.iter().copied().zip(free.into_iter().zip(held)).collect()
        };
        let oscillator: Vec<f64> = self
            .oscillator
            .iter()
            .flat_map(|row| both(row).into_iter().filter(|(_, (free, _))| *free).map(|(term, _)| term))
            .collect();
        let oscillator = DMatrix::from_row_slice(rows, count, &oscillator);
        let left = self.oscillator.iter().zip(&self.torque).map(|(row, torque)| {
            let held = both(row).into_iter().filter(|(_, (free, _))| !*free);
            torque - held.map(|(term, (_, value))| term * value).sum::<f64>()
        });
        let torque = DMatrix::from_iterator(rows, 1, left);
        // Torques of the laws enter the equation of motion with the opposite sign.
        let laws: Vec<f64> = self.laws.iter().flatten().map(|own| -own).collect();
        let laws = DMatrix::from_row_slice(rows, width, &laws);
        let products = oscillator.tr_mul(&oscillator);
        let without = |columns: &DMatrix<f64>| {
            Some(columns - product(&oscillator, &solve(&products, &oscillator.tr_mul(columns))?))
        };
        let (columns, residual) = (without(&laws)?, without(&torque)?);
        let dictionary = Dictionary::of_columns(entries, &self.counts, &laws, columns, &residual);
        Some(WeakForm { data, hypothesis, nominal, free, runs, oscillator, torque, laws, dictionary })
    }
}

/// Run of samples with its smoothed motion.
struct Seen<'s> {
    data: &'s Data,
    run: &'s Segment,
    motion: &'s Motion,
    nominal: &'s Nominal,
    rest_is_free: bool,
    /// Torque of the input, and its rate.
    input: [Vec<f64>; 2],
    command: Option<&'s Input>,
}

impl<'s> Seen<'s> {
    fn of(
        data: &'s Data,
        (run, motion): &'s (Segment, Motion),
        nominal: &'s Nominal,
        rest_is_free: bool,
    ) -> Self {
        let command = data.inputs.get(run.record).and_then(Option::as_ref);
        let input = driven(command, nominal.input_gain(), &run.times);
        Self { data, run, motion, nominal, rest_is_free, input, command }
    }

    /// Returns the torques of an effect at the samples, one series for each column.
    fn columns(&self, law: Candidate, shape: &[f64]) -> Vec<Vec<f64>> {
        self.along(&|along| law.columns(shape, along))
    }

    /// Returns the torque of an effect with some values; `None` for an effect of the measurement chain.
    fn torque(&self, law: Candidate, values: &[f64]) -> Option<Vec<f64>> {
        let effect = law.system()?;
        Some(self.along(&|along| along.response_to(effect, values)))
    }

    fn along<T>(&self, read: &dyn Fn(&Along<'_>) -> T) -> T {
        let coefficients = self.nominal.coefficients();
        let facts: &Scales = &self.data.facts;
        let [input, input_rate] = &self.input;
        read(&Along {
            times: &self.run.times,
            position: &self.motion.position,
            velocity: &self.motion.velocity,
            observed: &self.motion.position,
            rate: &self.motion.velocity,
            input,
            input_rate,
            command: self.command,
            first: self.run.first,
            facts,
            nominal: &coefficients,
            respond: &|torque: &[f64]| torque.to_vec(),
        })
    }
}
#[cfg(test)]
mod tests {
    use super::Proposed;
    use crate::data::observations::Observations;
    use crate::data::segments::cut;
    use crate::fit::calibrate::baseline;
    use crate::fixtures::record;
    use crate::model::candidate::Candidate;
    use dynamics::chain::{Chain, Observed};
    use dynamics::{Active, Nominal, System};
    use record::{Clock, ClockChoice};

    /// Returns the proposed sets for a swing with some effects, each with the values of its members.
    fn proposed(effects: &[(&str, &[f64])]) -> Vec<(Vec<&'static str>, Vec<f64>)> {
        let nominal = Nominal::new(1.0, 0.2, 480.0, 0.0).unwrap();
        let active = effects.iter().map(|(id, values)| Active::new(id, values).unwrap()).collect();
        let system = System::new(nominal, active).unwrap();
        let chain = Chain::new(Observed::Position, 1e-3, Vec::new()).unwrap();
        let record = record(&system, 0.6, 1500, &chain, 1);
        let clock = Clock::new(&record, ClockChoice::Host).unwrap();
        let observed = Observations::new(&record, &clock);
        let simulator = (&nominal).into();
        let kept = vec![true; observed.len()];
        let data = cut(std::slice::from_ref(&observed), &[kept], &simulator).unwrap();
        let base = baseline(&data, &simulator).unwrap().calibrated;
        let candidates = Candidate::that_apply(&data.facts, data.quantity, &simulator);
        let found = Proposed::of(&data, &base, &candidates, 2);
        let first = base.hypothesis.calibrated.len();
        let of = |set: &super::Begun| (set.hypothesis.ids(), set.globals[first..].to_vec());
        found.sets.iter().map(of).collect()
    }

    /// With a torque that holds the body beside the middle of its play, the mean of the swing is not the middle.
    #[test]
    fn proposes_a_large_play_beside_a_constant_torque() {
        let sets = proposed(&[("backlash", &[0.24]), ("constant_torque", &[20.0])]);
        let set = sets.iter().find(|(ids, _)| *ids == ["backlash", "constant_torque"]);
        let (_, values) = set.unwrap_or_else(|| panic!("{sets:?}"));
        assert!((values[0] / 0.24 - 1.0).abs() < 0.2, "{values:?}");
    }

    #[test]
    fn proposes_a_stop_that_is_met_on_every_swing() {
        let sets = proposed(&[("end_stop", &[0.3, 12_000.0, 0.02])]);
        let (ids, values) = &sets[0];
        assert_eq!(ids, &["end_stop"]);
        assert!((values[0] - 0.3).abs() < 0.05, "{values:?}");
    }
}
