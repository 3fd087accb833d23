//! Hypothesis: the nominal simulator with some of its coefficients free, and candidates with parameters.

#![allow(
    clippy::indexing_slicing,
    reason = "a point begins with the calibrated numbers, whose indices the hypothesis made itself"
)]

use crate::data::scales::Scales;
use crate::model::candidate::{Candidate, EvidenceClass, Parameter};
use crate::model::sensor::Sensor;
use dynamics::sensitivity::Free;
use dynamics::{
    Active, Coefficients, DynamicsError, Effect, KnownEffect, Nominal, NominalSimulator, System, SystemEffect,
};
use record::Quantity;

/// Number of state variables of a segment's start that are not hidden: position and velocity.
pub(crate) const VISIBLE: usize = 2;

/// Least stiffness of a position drive, relative to the stated one.
const WEAKEST: f64 = 0.1;

/// Smallest time constant I/c of the inertia that a fit may reach, in sampling intervals.
const STIFFEST: f64 = 0.5;

/// Damping ratio from which on a body is well damped: a swing of six periods leaves less than a thousandth.
pub(crate) const WELL_DAMPED: f64 = 0.2;

/// Number that calibration may move: a nominal coefficient, or a parameter of a known effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Calibrated {
    Inertia,
    Damping,
    Stiffness,
    RestAngle,
    /// Parameter of an effect that the nominal simulator has; both are indices from 0.
    Effect {
        known: usize,
        parameter: usize,
    },
}

impl Calibrated {
    /// Coefficients of the oscillator itself.
    pub(crate) const PLAIN: [Self; 4] = [Self::Inertia, Self::Damping, Self::Stiffness, Self::RestAngle];

    /// Returns the name of a coefficient of the oscillator; empty for an effect's parameter, which is named
    /// with the effect.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Inertia => "inertia",
            Self::Damping => "damping",
            Self::Stiffness => "stiffness",
            Self::RestAngle => "rest_angle",
            Self::Effect { .. } => "",
        }
    }

    /// Returns the coefficient of the oscillator as a free quantity; `None` for an effect's parameter.
    pub(crate) fn free(self) -> Option<Free> {
        match self {
            Self::Inertia => Some(Free::Inertia),
            Self::Damping => Some(Free::Damping),
            Self::Stiffness => Some(Free::Stiffness),
            Self::RestAngle => Some(Free::RestAngle),
            Self::Effect { .. } => None,
        }
    }

    /// Returns the quantity that a coefficient of the oscillator measures.
    pub(crate) fn quantity(self) -> dynamics::Quantity {
        match self {
            Self::Inertia => dynamics::Quantity::Inertia,
            Self::Damping => dynamics::Quantity::Damping,
            Self::Stiffness => dynamics::Quantity::Stiffness,
            Self::RestAngle => dynamics::Quantity::Position,
            Self::Effect { .. } => dynamics::Quantity::Ratio,
        }
    }

    /// Returns the value of a coefficient of the oscillator; NaN for an effect's parameter.
    pub(crate) fn of(self, coefficients: &Coefficients<f64>) -> f64 {
        match self {
            Self::Inertia => coefficients.inertia,
            Self::Damping => coefficients.damping,
            Self::Stiffness => coefficients.stiffness,
            Self::RestAngle => coefficients.rest_angle,
            Self::Effect { .. } => f64::NAN,
        }
    }

    fn set(self, coefficients: &mut Coefficients<f64>, value: f64) {
        match self {
            Self::Inertia => coefficients.inertia = value,
            Self::Damping => coefficients.damping = value,
            Self::Stiffness => coefficients.stiffness = value,
            Self::RestAngle => coefficients.rest_angle = value,
            Self::Effect { .. } => {}
        }
    }
}

/// Effect that the nominal simulator has, with its fit parameters.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Known {
    pub(crate) candidate: Candidate,
    pub(crate) stated: Vec<f64>,
    /// `true` if recalibration may move the effect.
    pub(crate) recalibrate: bool,
}

impl Known {
    /// Returns the effects of a nominal simulator that a fit of records of a quantity includes.
    pub(crate) fn of(simulator: &NominalSimulator, quantity: Quantity) -> Vec<Self> {
        let known = |known: &KnownEffect| {
            let (candidate, values) = Candidate::of(&known.active)?;
            candidate.is_observed_in(quantity).then(|| Self {
                candidate,
                stated: candidate.fitted(&values),
                recalibrate: known.recalibrate,
            })
        };
        simulator.effects().iter().filter_map(known).collect()
    }
}

/// Simulator to be fitted: its known part, and what is free in it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Hypothesis {
    pub(crate) nominal: Nominal,
    /// Effects that the nominal simulator has; part of every hypothesis.
    pub(crate) known: Vec<Known>,
    /// Numbers that calibration moves: the oscillator's coefficients, then the parameters of known effects.
    /// Of each known effect either all parameters are moved or none.
    pub(crate) calibrated: Vec<Calibrated>,
    /// Effects that the nominal simulator lacks.
    pub(crate) candidates: Vec<Candidate>,
}

/// Origin of a global parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Source {
    Nominal(Calibrated),
    /// Index among the effects (see [`Hypothesis::effects`]), and index among the effect's parameters.
    Effect(usize, usize),
}

impl Hypothesis {
    /// Replaces the candidates, sorted in the vocabulary's order so that the same set is the same hypothesis.
    pub(crate) fn with(&self, candidates: &[Candidate]) -> Self {
        let mut candidates = candidates.to_vec();
        candidates.sort_by_key(|candidate| candidate.rank());
        candidates.dedup();
        Self { candidates, ..self.clone() }
    }

    /// Returns every effect: those of the nominal simulator, then the candidates.
    pub(crate) fn effects(&self) -> impl Iterator<Item = Candidate> + '_ {
        self.known.iter().map(|known| known.candidate).chain(self.candidates.iter().copied())
    }

    /// Returns the effect at an index among all.
    pub(crate) fn effect(&self, index: usize) -> Option<Candidate> {
        self.effects().nth(index)
    }

    /// Returns `true` if an effect is among the candidates, by whichever of its laws.
    pub(crate) fn has(&self, effect: Effect) -> bool {
        self.candidates.iter().any(|own| own.effect() == effect)
    }

    /// Returns `true` if the nominal simulator has an effect.
    pub(crate) fn knows(&self, candidate: Candidate) -> bool {
        self.known.iter().any(|known| known.candidate == candidate)
    }

    pub(crate) fn sources(&self, facts: &Scales) -> Vec<Source> {
        let nominal = self.calibrated.iter().map(|&which| match which {
            Calibrated::Effect { known, parameter } => Source::Effect(known, parameter),
            which => Source::Nominal(which),
        });
        let own = self.candidates.iter().enumerate().flat_map(|(index, candidate)| {
            let index = self.known.len() + index;
            (0..candidate.parameters(facts).len()).map(move |parameter| Source::Effect(index, parameter))
        });
        nominal.chain(own).collect()
    }

    /// Returns every global parameter with its bounds.
    pub(crate) fn parameters(&self, facts: &Scales) -> Vec<Parameter> {
        let plain = |which: Calibrated| Parameter {
            name: which.name(),
            lower: match which {
                Calibrated::Inertia => self.least_inertia(facts),
                Calibrated::Stiffness => self.least_stiffness(),
                Calibrated::Damping => 0.0,
                Calibrated::RestAngle | Calibrated::Effect { .. } => f64::NEG_INFINITY,
            },
            upper: f64::INFINITY,
            strength: false,
            shape: false,
            simpler: false,
        };
        let nominal =
            self.calibrated.iter().map(|&which| self.of_known(which, facts).unwrap_or(plain(which)));
        nominal.chain(self.candidates.iter().flat_map(|candidate| candidate.parameters(facts))).collect()
    }

    /// Returns the lower bound of the inertia: a millionth of the nominal one, since mistaken units may put it off by
    /// a factor of a thousand. For a well-damped body, whose period does not tell its inertia, it is one at which
    /// the motion follows the torque within a part of a sampling interval, so that no sample tells a smaller one
    /// apart and the equation of motion is stiff; at most a tenth of the nominal inertia.
    fn least_inertia(&self, facts: &Scales) -> f64 {
        let (damping, least) = (self.nominal.damping(), 1e-6 * facts.inertia);
        let critical = 2.0 * (self.nominal.stiffness() * self.nominal.inertia()).sqrt();
        if damping < WELL_DAMPED * critical {
            return least;
        }
        (STIFFEST * damping * facts.interval).clamp(least, 0.1 * facts.inertia)
    }

    /// Returns the lower bound of the stiffness: 0, or a part of the stated one where the input commands a position. The
    /// spring is then the drive's own, with the input's gain. Without a bound, sets are fitted that no input moves:
    /// each segment's start state follows a joint that holds still, and gains more there than it loses in all motions.
    fn least_stiffness(&self) -> f64 {
        let is_driven = self.calibrated.contains(&Calibrated::Inertia);
        if is_driven && self.nominal.commands_position() { WEAKEST * self.nominal.stiffness() } else { 0.0 }
    }

    /// Returns a known effect's parameter with bounds that always include its stated value. The effect is
    /// present at any size.
    fn of_known(&self, which: Calibrated, facts: &Scales) -> Option<Parameter> {
        let Calibrated::Effect { known, parameter } = which else { return None };
        let known = self.known.get(known)?;
        let own = *known.candidate.parameters(facts).get(parameter)?;
        let stated = known.stated.get(parameter).copied()?;
        let (lower, upper) = (own.lower.min(stated), own.upper.max(stated));
        Some(Parameter { lower, upper, strength: false, shape: false, simpler: false, ..own })
    }

    /// Returns the nominal values of the calibrated numbers, at which a fit without candidates starts.
    pub(crate) fn nominal_point(&self) -> Vec<f64> {
        let coefficients = self.nominal.coefficients();
        let stated = |which: Calibrated| match which {
            Calibrated::Effect { known, parameter } => self.known[known].stated[parameter],
            which => which.of(&coefficients),
        };
        self.calibrated.iter().map(|&which| stated(which)).collect()
    }

    /// Returns each candidate's part of a point.
    pub(crate) fn parts<'a>(&self, facts: &Scales, point: &'a [f64]) -> Vec<&'a [f64]> {
        let mut rest = &point[self.calibrated.len()..];
        self.candidates
            .iter()
            .map(|candidate| {
                let (own, after) =
                    rest.split_at_checked(candidate.parameters(facts).len()).unwrap_or((rest, &[]));
                rest = after;
                own
            })
            .collect()
    }

    /// Returns the fit parameters of every effect at a point, with the index of the first among the global
    /// parameters; no index for known effects that are held.
    pub(crate) fn all_parts<'a>(
        &'a self,
        facts: &Scales,
        point: &'a [f64],
    ) -> Vec<(Candidate, Option<usize>, &'a [f64])> {
        let mut all = Vec::with_capacity(self.known.len() + self.candidates.len());
        for (index, known) in self.known.iter().enumerate() {
            let first = Calibrated::Effect { known: index, parameter: 0 };
            let place = self.calibrated.iter().position(|own| *own == first);
            let moved = place.and_then(|place| point.get(place..place + known.stated.len()));
            all.push((known.candidate, moved.and(place), moved.unwrap_or(&known.stated)));
        }
        let mut place = self.calibrated.len();
        for (candidate, own) in self.candidates.iter().zip(self.parts(facts, point)) {
            all.push((*candidate, Some(place), own));
            place += own.len();
        }
        all
    }

    pub(crate) fn calibrated_nominal(&self, point: &[f64]) -> Result<Nominal, DynamicsError> {
        let mut coefficients = self.nominal.coefficients();
        for (which, &value) in self.calibrated.iter().zip(point) {
            which.set(&mut coefficients, value);
        }
        self.nominal.with_coefficients(coefficients)
    }

    pub(crate) fn system(&self, facts: &Scales, point: &[f64]) -> Result<System, DynamicsError> {
        let mut effects = Vec::new();
        for (candidate, _, own) in self.all_parts(facts, point) {
            if let Some(effect) = candidate.system() {
                effects.push(active(effect, &candidate.values(own))?);
            }
        }
        System::new(self.calibrated_nominal(point)?, effects)
    }

    /// Returns the oscillator at a point, and its stiffness against small swings including that of a known
    /// weight.
    pub(crate) fn swinging(&self, facts: &Scales, point: &[f64]) -> Result<(Nominal, f64), DynamicsError> {
        let nominal = self.calibrated_nominal(point)?;
        let parts = self.all_parts(facts, point).into_iter().take(self.known.len());
        let weight = parts.filter_map(|(known, _, own)| {
            let effect = known.system().filter(|_| known.is_weight())?;
            Some(active(effect, &known.values(own)))
        });
        let effects = weight.map(|active| Ok(KnownEffect { active: active?, recalibrate: true }));
        let simulator = NominalSimulator::new(nominal, effects.collect::<Result<_, DynamicsError>>()?)?;
        Ok((nominal, simulator.equilibrium().1))
    }

    pub(crate) fn measurement(&self, facts: &Scales, point: &[f64]) -> Sensor {
        let mut sensor = Sensor::default();
        for (candidate, _, own) in self.all_parts(facts, point) {
            candidate.read(&candidate.values(own), &mut sensor);
        }
        sensor
    }

    /// Returns `true` if the motion depends smoothly on everything that is fitted.
    pub(crate) fn smooth(&self) -> bool {
        self.effects().all(|candidate| candidate.is_smooth())
    }

    /// Returns the number of fitted state variables of a segment's start: position, velocity and hidden ones.
    pub(crate) fn start_length(&self) -> usize {
        VISIBLE + self.effects().map(|effect| effect.free_hidden().len()).sum::<usize>()
    }

    /// Returns the same number without candidates, which every hypothesis fits.
    pub(crate) fn least_start_length(&self) -> usize {
        VISIBLE + self.known.iter().map(|known| known.candidate.free_hidden().len()).sum::<usize>()
    }

    /// Returns the sizes of the variables of a segment's start state, in their order; `None` for one whose steps a fit
    /// does not bound.
    pub(crate) fn start_sizes(&self, facts: &Scales) -> Vec<Option<f64>> {
        let hidden = self.effects().flat_map(|effect| effect.free_hidden()).map(|own| own.scale(facts));
        [None; VISIBLE].into_iter().chain(hidden).collect()
    }

    /// Returns the candidates that count as effects.
    pub(crate) fn counted(&self) -> impl Iterator<Item = &Candidate> {
        self.candidates.iter().filter(|own| own.counts())
    }

    /// Returns `true` if the hypothesis has an effect of a class and no unnamed law that stands for the class: beside
    /// such a law the effect may have no size at all.
    pub(crate) fn holds(&self, class: EvidenceClass) -> bool {
        self.counted().any(|own| own.evidence_class() == class)
            && self.counted().all(|own| own.stands_for() != Some(class))
    }

    /// Returns `true` if the hypothesis has neither an effect of a class nor an unnamed law that stands for
    /// the class.
    pub(crate) fn lacks(&self, class: EvidenceClass) -> bool {
        self.counted().all(|own| own.evidence_class() != class && own.stands_for() != Some(class))
    }

    /// Returns `true` if all counted candidates are plain laws.
    pub(crate) fn is_plain(&self) -> bool {
        self.counted().all(|own| own.is_plain())
    }

    /// Returns the number of flexible effects among the counted candidates.
    pub(crate) fn flexible(&self) -> usize {
        self.counted().filter(|own| own.is_flexible()).count()
    }

    /// Returns the candidates' positions in the vocabulary, which identify a set.
    pub(crate) fn ranks(&self) -> Vec<usize> {
        self.candidates.iter().map(|candidate| candidate.rank()).collect()
    }

    pub(crate) fn ids(&self) -> Vec<&'static str> {
        self.candidates.iter().map(|candidate| candidate.id()).collect()
    }
}

/// Creates an effect from its law's parameters, kept inside their ranges. Open ranges exclude their ends,
/// which a fit at its bound reaches.
pub(crate) fn active(effect: SystemEffect, values: &[f64]) -> Result<Active, DynamicsError> {
    let parameters = effect.description().parameters;
    let inside = values.iter().zip(parameters).map(|(&value, parameter)| {
        if parameter.range.contains(value) { value } else { value.max(f64::MIN_POSITIVE) }
    });
    Active::of(Effect::System(effect), &inside.collect::<Vec<_>>())
}
