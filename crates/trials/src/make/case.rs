//! From a number to a case.

use super::draws::Draws;
use super::error::TrialError;
use super::hiding::{INPUTS, PAIRS, RELEASES, SINGLE, UNNAMED, needs_input};
use super::plan::TrialPlan;
use super::recalibration::{Absorbed, left_over};
use super::shape::{RANDOM, Shape, random_effect};
use super::situation::{Motion, Motions, Nuisances, Situation, believed};
use super::size::solve;
use super::{composite, foreign, outside, rigs, stressed};
use crate::{Bank, HIDDEN_SCHEMA, Hidden, HiddenEffect};
use dynamics::chain::{Chain, Observed};
use dynamics::{Active, Coordinate, Effect, Nominal, System};
use seed::Seed;
use simulator::{csv_text, generate, nominal_text};
use truth::{Draws as Branch, TRUTH_SCHEMA, Truth};

/// A case: what the diagnosis is given, and what is hidden from it.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Name of its folder: a number that tells neither bank nor effect.
    pub id: String,
    /// The effect that the diagnosis is told not to consider.
    pub without: Option<String>,
    /// The records as texts of CSV files, `record-000.csv` and on.
    pub records: Vec<String>,
    /// The text of `nominal.toml`: what is believed of the system.
    pub nominal: String,
    /// What is hidden; whoever diagnoses must not see it.
    pub hidden: Hidden,
}

/// A bank and a number there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Job {
    pub(crate) bank: Bank,
    pub(crate) number: usize,
}

/// How often a system and a shape are drawn anew where no size is as detectable as wanted.
pub(crate) const ATTEMPTS: usize = 40;

/// How much of the cases of banks with a free choice has a measured input.
const DRIVEN_SHARE: f64 = 0.15;

/// How far nominal coefficients are off, at most, where they are the case's subject, and where they are not.
const OFF_AS_SUBJECT: f64 = 0.3;
const OFF_BESIDES: f64 = 0.1;

/// What a case is to hide.
struct Subject<'a> {
    ids: Vec<&'a str>,
    wanted: f64,
    motions: Motions,
    made: String,
}

/// Everything that banks have in common.
pub(crate) struct Setup {
    /// The case's branch of the tree of seeds.
    pub(crate) seed: Seed,
    /// Its names, from the root.
    pub(crate) branch: Vec<String>,
    pub(crate) situation: Situation,
    pub(crate) nuisances: Nuisances,
    /// Σθ̇² over all samples of all records, without anything hidden.
    pub(crate) square_velocities: f64,
    /// Standard deviation of all that is white, in rad: the unit of detectability.
    pub(crate) white: f64,
}

impl Setup {
    /// Draws a situation; a later attempt draws another, with the same nuisances.
    pub(crate) fn draw(
        plan: &TrialPlan,
        job: Job,
        attempt: usize,
        motions: Motions,
        hidden: &[&str],
    ) -> Result<Self, TrialError> {
        let (seed, branch) = job.seed(plan.seed);
        let own = seed.child(&format!("attempt {attempt}"));
        let situation = Situation::draw(&plan.ranges, plan.sampling, &own, motions)?;
        Self::with(situation, seed, own, branch, hidden)
    }

    /// A setup about a situation; `seed` is the case's and `own` the attempt's.
    pub(crate) fn with(
        situation: Situation,
        seed: Seed,
        own: Seed,
        branch: Vec<String>,
        hidden: &[&str],
    ) -> Result<Self, TrialError> {
        let nuisances = Nuisances::draw(&seed).beside(hidden);
        let clean = situation.motions(&[])?;
        let square_velocities: f64 =
            clean.iter().flat_map(|motion| &motion.velocity).map(|velocity| velocity * velocity).sum();
        let count = (situation.sampling.samples * situation.starts.len()) as f64;
        let white = nuisances.white(&situation, square_velocities / count);
        Ok(Self { seed: own, branch, situation, nuisances, square_velocities, white })
    }

    /// The nuisances as effects of the measurement chain.
    pub(crate) fn nuisance_effects(&self) -> Result<Vec<Active>, TrialError> {
        let count = (self.situation.sampling.samples * self.situation.starts.len()) as f64;
        self.nuisances.active(&self.situation, self.square_velocities / count)
    }

    /// How detectable noise-free motions are, seen by an ideal sensor.
    pub(crate) fn detectability(&self, motions: Vec<Motion>, absorbed: Absorbed) -> Result<f64, TrialError> {
        let seen: Vec<_> = motions.into_iter().map(Motion::seen).collect();
        Ok(left_over(&self.situation, &seen, absorbed)? / self.white)
    }
}

impl Job {
    pub(crate) fn seed(&self, root: u64) -> (Seed, Vec<String>) {
        let branch = vec!["trials".to_owned(), format!("{:?}", self.bank), format!("case {}", self.number)];
        (branch.iter().fold(Seed::new(root), |node, name| node.child(name)), branch)
    }

    /// Draws the case.
    pub(crate) fn make(&self, plan: &TrialPlan, id: String) -> Result<Case, TrialError> {
        match self.bank {
            Bank::Foreign => foreign::make(plan, *self, id),
            Bank::Stressed => stressed::make(plan, *self, id),
            Bank::Measured => outside::measured_case(plan, *self, id),
            Bank::Engine => outside::engine_case(plan, *self, id),
            Bank::Composite => composite::make(plan, *self, id),
            Bank::Rigs => rigs::make(plan, *self, id),
            _ => self.vocabulary_case(plan, id),
        }
    }

    /// What nominal.toml says: exact, off as the case's subject, or, by an even chance, off besides.
    pub(crate) fn believed(
        &self,
        plan: &TrialPlan,
        nominal: &Nominal,
    ) -> Result<(Nominal, bool), TrialError> {
        let (seed, _) = self.seed(plan.seed);
        let off = match self.bank {
            Bank::None => None,
            Bank::Calibration | Bank::Composite => Some(OFF_AS_SUBJECT),
            // A preload moves the rest angle: beside other coefficients that are off it is one more of these.
            _ if self.subject(plan).ids.contains(&"constant_torque") => None,
            _ => Draws::new(&seed.child("miscalibration")).chance(0.5).then_some(OFF_BESIDES),
        };
        Ok((believed(nominal, off, &seed)?, off.is_some()))
    }

    /// Whether a case of a bank with a free choice has a measured input.
    pub(crate) fn free_motions(&self, plan: &TrialPlan) -> Motions {
        let (seed, _) = self.seed(plan.seed);
        let driven = Draws::new(&seed.child("input")).chance(DRIVEN_SHARE);
        if driven { Motions::Driven } else { Motions::Release }
    }

    fn subject<'a>(&self, plan: &TrialPlan) -> Subject<'a> {
        let free = self.free_motions(plan);
        let one_of = |ids: &'static [&'static str]| {
            let (at, wanted) = plan.turn(self.number, ids.len());
            (ids.get(at).copied().unwrap_or_default(), wanted)
        };
        let with_input = |id: &str| if needs_input(id) { Motions::Driven } else { free };
        let subject = |(id, wanted): (&'static str, f64), motions: Motions| Subject {
            ids: vec![id],
            wanted,
            motions,
            made: format!("{id} by the vocabulary's law"),
        };
        match self.bank {
            Bank::Single => {
                let chosen = one_of(&SINGLE);
                subject(chosen, with_input(chosen.0))
            }
            Bank::LeftOut => {
                let chosen = one_of(&UNNAMED);
                subject(chosen, with_input(chosen.0))
            }
            Bank::Releases => subject(one_of(&RELEASES), Motions::Releases),
            Bank::Driven => subject(one_of(&INPUTS), Motions::Driven),
            Bank::Pair => {
                let (at, wanted) = plan.turn(self.number, PAIRS.len());
                let (one, other, place) = PAIRS.get(at).copied().unwrap_or_default();
                Subject { ids: vec![one, other], wanted, motions: free, made: place.to_owned() }
            }
            _ => Subject { ids: Vec::new(), wanted: 0.0, motions: free, made: "nothing hidden".to_owned() },
        }
    }

    /// A case whose records follow from truths in the vocabulary.
    fn vocabulary_case(&self, plan: &TrialPlan, id: String) -> Result<Case, TrialError> {
        let subject = self.subject(plan);
        for attempt in 0..ATTEMPTS {
            let setup = Setup::draw(plan, *self, attempt, subject.motions, &subject.ids)?;
            let hidden = |wanted: f64| {
                let effects = subject.ids.iter().map(|id| hide(&setup, id, wanted));
                effects.collect::<Result<Option<Vec<_>>, _>>()
            };
            if let Some(hidden) = apart(&setup, subject.wanted, hidden)? {
                return self.written(plan, id, &setup, hidden, &subject);
            }
        }
        Err(TrialError::OutOfReach {
            effect: subject.ids.join(" and "),
            wanted: subject.wanted,
            attempts: ATTEMPTS,
        })
    }

    fn written(
        &self,
        plan: &TrialPlan,
        id: String,
        setup: &Setup,
        hidden: Vec<(Active, f64)>,
        subject: &Subject<'_>,
    ) -> Result<Case, TrialError> {
        let Setup { situation, .. } = setup;
        let nuisances = setup.nuisance_effects()?;
        let (acting, sensing): (Vec<Active>, Vec<Active>) = hidden
            .iter()
            .map(|(active, _)| *active)
            .partition(|active| matches!(active.effect(), Effect::System(_)));
        let system = System::new(situation.nominal, acting)?;
        let sensing = sensing.into_iter().chain(nuisances.iter().copied()).collect();
        let chain = Chain::new(Observed::Position, situation.noise, sensing)?;
        let truths: Vec<Truth> = situation
            .starts
            .iter()
            .enumerate()
            .map(|(record, &start)| Truth {
                schema: TRUTH_SCHEMA.to_owned(),
                system: system.clone(),
                start,
                excitation: situation.excitation,
                chain: chain.clone(),
                sampling: situation.sampling,
                draws: Branch {
                    seed: plan.seed,
                    branch: setup.branch.iter().cloned().chain([format!("record {record}")]).collect(),
                },
            })
            .collect();
        let sampling = situation.sampling;
        let records = truths
            .iter()
            .map(|truth| Ok(csv_text(&generate(truth)?, sampling.stamp_decimals, sampling.value_decimals)))
            .collect::<Result<Vec<_>, TrialError>>()?;
        let (nominal, miscalibrated) = self.believed(plan, &situation.nominal)?;
        let without =
            (self.bank == Bank::LeftOut).then(|| subject.ids.first().map(|id| (*id).to_owned())).flatten();
        Ok(Case {
            id,
            without: without.clone(),
            records,
            nominal: nominal_toml(nominal, &setup.nuisances)?,
            hidden: Hidden {
                schema: HIDDEN_SCHEMA.to_owned(),
                bank: self.bank,
                effects: described(&hidden, "vocabulary"),
                foreign: None,
                unlisted: Vec::new(),
                allowed: Vec::new(),
                nuisances: nuisances.iter().map(|active| active.id().to_owned()).collect(),
                miscalibrated,
                without,
                noise: situation.noise,
                records: truths,
                made: format!("{}; {}", self.in_words(plan.seed), subject.made),
            },
        })
    }

    /// Seed, bank and number, for whoever makes the case again.
    pub(crate) fn in_words(&self, seed: u64) -> String {
        format!("seed {seed}, {:?} {}", self.bank, self.number)
    }
}

/// The text of a `nominal.toml`; an encoder's step is stated there.
pub(crate) fn nominal_toml(nominal: Nominal, nuisances: &Nuisances) -> Result<String, TrialError> {
    let stated = match nuisances.encoder_step {
        Some(step) => nominal.with_sensor_resolution(step)?,
        None => nominal,
    };
    Ok(nominal_text(&stated))
}

/// Hidden effects for the truth, the most detectable first.
pub(crate) fn described(hidden: &[(Active, f64)], law: &str) -> Vec<HiddenEffect> {
    let mut effects: Vec<HiddenEffect> = hidden
        .iter()
        .map(|(active, detectability)| HiddenEffect {
            id: active.id().to_owned(),
            parameters: active.values().to_vec(),
            law: law.to_owned(),
            detectability: *detectability,
            floors: None,
        })
        .collect();
    effects.sort_by(|one, other| other.detectability.total_cmp(&one.detectability));
    effects
}

/// An effect as detectable as wanted in a situation, alone; `None` where no size is.
pub(crate) fn hide(setup: &Setup, id: &str, wanted: f64) -> Result<Option<(Active, f64)>, TrialError> {
    let situation = &setup.situation;
    let mut draws = Draws::new(&setup.seed.child(id));
    if RANDOM.contains(&id) {
        let drawn = random_effect(id, situation, setup.square_velocities, setup.white, wanted, &mut draws)?;
        return Ok(Some(drawn));
    }
    let shape = Shape::draw(id, situation, &mut draws)?;
    let clean = match Effect::find(id)? {
        Effect::MeasuringChain(_) => Some(situation.motions(&[])?),
        Effect::System(_) => None,
    };
    // A preload is a rest angle that the simulator does not have.
    let absorbed = Absorbed { rest_angle: id != "constant_torque", ..Absorbed::BY_RECALIBRATION };
    let detectability = |size: f64| {
        let active = shape.at(size)?;
        let motions = match &clean {
            Some(clean) => clean.clone(),
            None => situation.motions(&[active])?,
        };
        beyond_recalibration(setup, motions, clean.is_some().then_some(active), absorbed)
    };
    let sized = solve(wanted, shape.guess, shape.most, detectability)?;
    sized.map(|sized| Ok((shape.at(sized.size)?, sized.detectability))).transpose()
}

/// Size in noise units of noise-free motions that a sensor with distortions of its own sees.
fn beyond_recalibration(
    setup: &Setup,
    motions: Vec<Motion>,
    distortions: impl IntoIterator<Item = Active>,
    absorbed: Absorbed,
) -> Result<f64, TrialError> {
    let chain = Chain::new(Observed::Position, 0.0, distortions.into_iter().collect())?;
    let seen = motions
        .iter()
        .map(|motion| {
            let unused = |name: &'static str| setup.seed.child(name).generator();
            chain.observe(&motion.sampled(), Coordinate::Angle, unused)
        })
        .collect::<Result<Vec<_>, _>>()?;
    Ok(left_over(&setup.situation, &seen, absorbed)? / setup.white)
}

/// Factor beyond which two effects are one for all that a record says.
const HARDLY_APART: f64 = 5.0;

/// Effects of which each is as detectable as wanted beyond what recalibration *and the other one* make up for.
///
/// Two that are so detectable alone may cancel: dry friction flattens the end of a decay and drag its
/// beginning. With sizes d₁ and d₂ alone and d₁₂ together their correlation is ρ = (d₁₂² − d₁² −
/// d₂²)/(2·d₁·d₂), and of each d·√(1 − ρ²) is its own: both are hidden anew at so many times the size. `None`
/// where that is out of reach.
fn apart(
    setup: &Setup,
    wanted: f64,
    hidden: impl Fn(f64) -> Result<Option<Vec<(Active, f64)>>, TrialError>,
) -> Result<Option<Vec<(Active, f64)>>, TrialError> {
    let Some(alone) = hidden(wanted)? else { return Ok(None) };
    let &[(one, first), (other, second)] = alone.as_slice() else { return Ok(Some(alone)) };
    let preload = [one, other].iter().any(|active| active.id() == "constant_torque");
    let absorbed = Absorbed { rest_angle: !preload, ..Absorbed::BY_RECALIBRATION };
    let size = |effects: &[Active]| {
        let (acting, sensing): (Vec<Active>, Vec<Active>) =
            effects.iter().partition(|active| matches!(active.effect(), Effect::System(_)));
        beyond_recalibration(setup, setup.situation.motions(&acting)?, sensing, absorbed)
    };
    let both = size(&[one, other])?;
    // Beside a preload nothing shifts the rest angle: the other's own size is another one then.
    let [first, second] = if preload { [size(&[one])?, size(&[other])?] } else { [first, second] };
    let correlation = (both * both - first * first - second * second) / (2.0 * first * second);
    let factor = (1.0 - correlation * correlation).max(0.0).sqrt().recip();
    if factor >= HARDLY_APART {
        return Ok(None);
    }
    let own = |effects: Vec<(Active, f64)>| {
        effects.into_iter().map(|(active, detectability)| (active, detectability / factor)).collect()
    };
    Ok(hidden(wanted * factor)?.map(own))
}
