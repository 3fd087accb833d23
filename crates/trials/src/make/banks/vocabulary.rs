//! Cases of effects by the vocabulary's laws, alone or in pairs, and cases in which nothing is missing.

use crate::effects::{TrialEffect, hidden_in};
use crate::make::case::Case;
use crate::make::error::TrialError;
use crate::make::job::Job;
use crate::make::pairs::{PAIRS, effects_of};
use crate::make::plan::TrialPlan;
use crate::make::setup::{ATTEMPTS, Setup, absorbed_beside};
use crate::make::situation::Motions;
use crate::{Bank, Hidden, HiddenEffect};
use dynamics::chain::{Chain, Observed};
use dynamics::{Active, Effect, System};
use simulator::{csv_text, generate};
use truth::{Draws as Branch, TRUTH_SCHEMA, Truth};

/// Effects that a case hides, and their wanted size.
struct Subject {
    effects: Vec<&'static TrialEffect>,
    wanted: f64,
    motions: Motions,
    made: String,
}

impl Subject {
    /// Returns what a job's bank hides in its turn.
    fn of(plan: &TrialPlan, job: Job) -> Result<Self, TrialError> {
        let free = job.free_motions(plan.seed);
        let nothing =
            Self { effects: Vec::new(), wanted: 0.0, motions: free, made: "nothing hidden".to_owned() };
        let one = |motions: fn(&TrialEffect, Motions) -> Motions| {
            let (effect, wanted) = plan.turn(job.number, &hidden_in(job.bank))?;
            let made = format!("{} by the vocabulary's law", effect.id());
            Ok(Self { effects: vec![effect], wanted, motions: motions(effect, free), made })
        };
        match job.bank {
            Bank::Single | Bank::LeftOut => {
                one(|effect, free| if effect.needs_input { Motions::Driven } else { free })
            }
            Bank::Releases => one(|_, _| Motions::Releases),
            Bank::Driven => one(|_, _| Motions::Driven),
            Bank::Pair => {
                let (pair, wanted) = plan.turn(job.number, PAIRS)?;
                let effects = effects_of(&pair)?.to_vec();
                Ok(Self { effects, wanted, motions: free, made: pair.2.to_owned() })
            }
            Bank::None
            | Bank::Calibration
            | Bank::Foreign
            | Bank::Stressed
            | Bank::Measured
            | Bank::Engine
            | Bank::Composite
            | Bank::Rigs => Ok(nothing),
        }
    }
}

/// Makes a case whose records follow from truths in the vocabulary.
pub(crate) fn make(plan: &TrialPlan, job: Job, id: String) -> Result<Case, TrialError> {
    let subject = Subject::of(plan, job)?;
    for attempt in 0..ATTEMPTS {
        let setup = Setup::draw(plan, job, attempt, subject.motions, &subject.effects)?;
        let hidden = |wanted: f64| {
            let effects = subject.effects.iter().map(|effect| setup.hide(effect, wanted));
            effects.collect::<Result<Option<Vec<_>>, _>>()
        };
        if let Some(hidden) = apart(&setup, &subject, hidden)? {
            return written(plan, job, id, &setup, &hidden, &subject);
        }
    }
    let ids: Vec<&str> = subject.effects.iter().map(|effect| effect.id()).collect();
    Err(TrialError::OutOfReach { effect: ids.join(" and "), wanted: subject.wanted, attempts: ATTEMPTS })
}

/// Separates effects in the system from those in the measurement chain.
fn by_place(effects: impl IntoIterator<Item = Active>) -> (Vec<Active>, Vec<Active>) {
    effects.into_iter().partition(|active| matches!(active.effect(), Effect::System(_)))
}

fn written(
    plan: &TrialPlan,
    job: Job,
    id: String,
    setup: &Setup,
    hidden: &[(Active, f64)],
    subject: &Subject,
) -> Result<Case, TrialError> {
    let situation = &setup.situation;
    let nuisances = setup.nuisance_effects()?;
    let (acting, sensing) = by_place(hidden.iter().map(|(active, _)| *active));
    let system = System::new(situation.nominal, acting)?;
    let sensing = sensing.into_iter().chain(nuisances.iter().copied()).collect();
    let chain = Chain::new(Observed::Position, situation.noise, sensing)?;
    let branch = |record: usize| setup.branch.iter().cloned().chain([format!("record {record}")]).collect();
    let truth = |(record, &start)| Truth {
        schema: TRUTH_SCHEMA.to_owned(),
        system: system.clone(),
        start,
        excitation: situation.excitation,
        chain: chain.clone(),
        sampling: situation.sampling,
        draws: Branch { seed: plan.seed, branch: branch(record) },
    };
    let truths: Vec<Truth> = situation.starts.iter().enumerate().map(truth).collect();
    let sampling = situation.sampling;
    let records = truths
        .iter()
        .map(|truth| Ok(csv_text(&generate(truth)?, sampling.stamp_decimals, sampling.value_decimals)))
        .collect::<Result<Vec<_>, TrialError>>()?;
    let (nominal, miscalibrated) = job.believed(plan.seed, &situation.nominal, &subject.effects)?;
    let left_out = subject.effects.first().filter(|_| job.bank == Bank::LeftOut);
    let without = left_out.map(|effect| effect.id().to_owned());
    let made = format!("{}; {}", job.in_words(plan.seed), subject.made);
    let hidden = Hidden {
        effects: HiddenEffect::by_the_vocabulary(hidden),
        nuisances: nuisances.iter().map(|active| active.id().to_owned()).collect(),
        miscalibrated,
        without: without.clone(),
        records: truths,
        ..Hidden::nothing(job.bank, situation.noise, made)
    };
    Ok(Case { id, without, records, nominal: setup.nominal_toml(nominal)?, hidden })
}

/// Factor above which a record can hardly tell two effects apart.
const HARDLY_APART: f64 = 5.0;

/// Sizes the effects so that each one alone is as detectable as wanted beyond what recalibration *and the
/// other effect* absorb. `None` if this is out of reach.
///
/// Two effects that are detectable alone may cancel each other: dry friction flattens the end of a decay,
/// drag its beginning. Let d₁ and d₂ be the sizes alone and d₁₂ the size together. Their correlation is ρ =
/// (d₁₂² − d₁² − d₂²)/(2·d₁·d₂), and the part of each that the other cannot absorb is d·√(1 − ρ²). Both
/// effects are hidden again with the wanted size divided by √(1 − ρ²).
fn apart(
    setup: &Setup,
    subject: &Subject,
    hidden: impl Fn(f64) -> Result<Option<Vec<(Active, f64)>>, TrialError>,
) -> Result<Option<Vec<(Active, f64)>>, TrialError> {
    let Some(alone) = hidden(subject.wanted)? else { return Ok(None) };
    let &[(one, first), (other, second)] = alone.as_slice() else { return Ok(Some(alone)) };
    let absorbed = absorbed_beside(subject.effects.iter().copied());
    let size = |effects: &[Active]| {
        let (acting, sensing) = by_place(effects.iter().copied());
        setup.detectability_seen(&setup.situation.motions(&acting)?, sensing, absorbed)
    };
    let both = size(&[one, other])?;
    // Beside a preload, recalibration must not move the rest angle, which changes the other effect's size
    // alone.
    let [first, second] =
        if absorbed.rest_angle { [first, second] } else { [size(&[one])?, size(&[other])?] };
    let correlation = (both * both - first * first - second * second) / (2.0 * first * second);
    let factor = (1.0 - correlation * correlation).max(0.0).sqrt().recip();
    if factor >= HARDLY_APART {
        return Ok(None);
    }
    let own = |effects: Vec<(Active, f64)>| {
        effects.into_iter().map(|(active, detectability)| (active, detectability / factor)).collect()
    };
    Ok(hidden(subject.wanted * factor)?.map(own))
}
