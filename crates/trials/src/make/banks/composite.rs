//! Composite cases: systems that lack several effects of very different size, together with smooth laws
//! outside the vocabulary. The effects act by laws that differ from the vocabulary's.
//!
//! The numbers of swings per record and of samples per swing are drawn over decades, as far as the configured
//! number of samples permits. A size is stated as a multiple of the noise: the root mean square, over all
//! samples, of the part of the effect alone that no recalibration absorbs, divided by the standard deviation
//! of all white disturbances.

use super::own_record::{Told, written};
use crate::effects::by_other_laws;
use crate::make::case::Case;
use crate::make::draws::Draws;
use crate::make::error::TrialError;
use crate::make::integrator::{TorqueLaw, motions};
use crate::make::job::Job;
use crate::make::plan::TrialPlan;
use crate::make::ranges::Ranges;
use crate::make::recalibration::Absorbed;
use crate::make::setup::{ATTEMPTS, Setup};
use crate::make::situation::{Motion, Motions, Situation};
use crate::make::unlisted;
use crate::{HiddenEffect, Unlisted};
use seed::Seed;
use std::f64::consts::PI;
use truth::Sampling;

/// Sizes × noise: of the leading effect, of the others, of small ones among them, and of laws outside the
/// vocabulary.
const LEADING: [f64; 2] = [30.0, 150.0];
const OTHERS: [f64; 2] = [4.0, 30.0];
const SMALL: [f64; 2] = [1.0, 4.0];
const NAMELESS: [f64; 2] = [0.3, 3.0];

/// Share of small effects among the others.
const SMALL_SHARE: f64 = 0.3;

/// Size of the leading effect as a share of the swing: from, to. It determines the noise.
const LEADING_PART: [f64; 2] = [0.01, 0.06];

/// Numbers of swings per record and of samples per swing: from, to.
const SWINGS: [f64; 2] = [8.0, 300.0];
const SAMPLES: [f64; 2] = [12.0, 200.0];

/// Smallest number of samples of a record, if the configured number permits.
const FEWEST: usize = 800;

/// Largest decrease of ln A over a free decay; a longer decay would show nothing more.
const LARGEST_DECAY: f64 = 6.0;

/// Largest distance from the rest angle, in units of the drawn amplitude.
const LARGEST_SWING: f64 = 2.0;

/// Makes a case of the bank.
pub(crate) fn make(plan: &TrialPlan, job: Job, id: String) -> Result<Case, TrialError> {
    let (seed, branch) = job.seed(plan.seed);
    for attempt in 0..ATTEMPTS {
        let own = seed.child(&format!("attempt {attempt}"));
        let mut draws = Draws::new(&own.child("composite"));
        let sizes = Sizes::draw(&mut draws);
        let situation = situation(plan, &own, &sizes, &mut draws)?;
        let setup = Setup::with(situation, seed.clone(), own.clone(), branch.clone(), &[])?;
        let Some(parts) = Parts::draw(&setup, &own, &sizes, &mut draws)? else { continue };
        let laws: Vec<&dyn TorqueLaw> = parts.laws.iter().map(Box::as_ref).collect();
        let motions = motions(&setup.situation, &laws, &|_| Vec::new())?;
        if !motions.iter().all(|motion| is_sensible(&setup.situation, motion)) {
            continue;
        }
        let mut effects = parts.effects;
        effects.sort_by(|one, other| other.detectability.total_cmp(&one.detectability));
        let told = Told {
            effects,
            unlisted: parts.unlisted,
            made: "composite, by splitting".to_owned(),
            ..Told::default()
        };
        return written(plan, job, id, &setup, &motions, told);
    }
    Err(TrialError::OutOfReach { effect: "composite".to_owned(), wanted: LEADING[0], attempts: ATTEMPTS })
}

/// Sizes × noise: of the effects, the leading one first, and of the laws outside the vocabulary.
struct Sizes {
    effects: Vec<f64>,
    unlisted: Vec<f64>,
}

impl Sizes {
    fn draw(draws: &mut Draws) -> Self {
        let mut effects = vec![draws.log_uniform(LEADING[0], LEADING[1])];
        for _ in 0..1 + draws.below(5) {
            let [low, high] = if draws.chance(SMALL_SHARE) { SMALL } else { OTHERS };
            effects.push(draws.log_uniform(low, high));
        }
        let unlisted = (0..1 + draws.below(2)).map(|_| draws.log_uniform(NAMELESS[0], NAMELESS[1])).collect();
        Self { effects, unlisted }
    }
}

/// Draws a system, its motion and its sensor over wider ranges than in other banks.
fn situation(
    plan: &TrialPlan,
    own: &Seed,
    sizes: &Sizes,
    draws: &mut Draws,
) -> Result<Situation, TrialError> {
    let [low, high] = plan.ranges.frequency_hz;
    let frequency = draws.log_uniform(low, high);
    let [low, high] = plan.ranges.damping_ratio;
    let ratio = draws.log_uniform(0.25 * low, (4.0 * high).min(0.2));
    let kind = match draws.uniform(0.0, 1.0) {
        share if share < 0.6 => Motions::Release,
        share if share < 0.85 => Motions::Releases,
        _ => Motions::Driven,
    };
    let mut swings = draws.log_uniform(SWINGS[0], SWINGS[1]);
    if kind != Motions::Driven {
        swings = swings.min(LARGEST_DECAY / (2.0 * PI * ratio)).max(SWINGS[0]);
    }
    let most = plan.sampling.samples;
    let each = draws.log_uniform(SAMPLES[0], SAMPLES[1]).max(FEWEST.min(most) as f64 / swings);
    let samples = ((swings * each) as usize).min(most);
    let leading = draws.log_uniform(LEADING_PART[0], LEADING_PART[1]);
    let swing = plan.ranges.release_deg.map(f64::to_radians).iter().sum::<f64>() / 2.0;
    let noise = leading * swing / sizes.effects.first().copied().unwrap_or(LEADING[1]);
    let ranges = Ranges {
        frequency_hz: [frequency; 2],
        damping_ratio: [ratio; 2],
        noise: [noise; 2],
        release_deg: plan.ranges.release_deg,
    };
    let sampling = Sampling { rate_hz: frequency * each, samples, ..plan.sampling };
    Situation::draw(&ranges, sampling, own, kind)
}

/// Laws of a case, and their descriptions in its truth.
#[derive(Default)]
struct Parts {
    laws: Vec<Box<dyn TorqueLaw>>,
    effects: Vec<HiddenEffect>,
    unlisted: Vec<Unlisted>,
}

impl Parts {
    /// Finds effects with the wanted sizes, in a random order of the vocabulary. Effects that cannot be so
    /// large are skipped. `None` if fewer than two effects or no law outside the vocabulary are found.
    fn draw(setup: &Setup, own: &Seed, sizes: &Sizes, draws: &mut Draws) -> Result<Option<Self>, TrialError> {
        let situation = &setup.situation;
        let count = (situation.sampling.samples * situation.starts.len()) as f64;
        let mut parts = Self::default();
        let mut wanted = sizes.effects.iter();
        let mut size = wanted.next();
        for (effect, other) in shuffled(by_other_laws(), draws) {
            let Some(floors) = size else { break };
            let beside = |id: &str| parts.effects.iter().any(|effect| effect.id == id);
            if effect.alike.iter().any(|other| beside(other.id())) {
                continue;
            }
            let drawn = (other.draw)(situation, &mut Draws::new(&own.child(effect.id())));
            let detectability = floors * count.sqrt();
            let Some(sized) = setup.sized(&drawn.open, detectability, Absorbed::BY_RECALIBRATION)? else {
                continue;
            };
            parts.effects.push(HiddenEffect {
                id: effect.id().to_owned(),
                parameters: (drawn.parameters)(sized.size),
                law: other.name.to_owned(),
                detectability: sized.detectability,
                floors: Some(sized.detectability / count.sqrt()),
            });
            parts.laws.push(sized.law);
            size = wanted.next();
        }
        let laws = shuffled(unlisted::REGISTRY.iter().collect(), draws);
        for (law, floors) in laws.into_iter().zip(&sizes.unlisted) {
            let (open, _) = (law.draw)(situation, &mut Draws::new(&own.child(law.name)));
            let Some(sized) = setup.sized(&open, floors * count.sqrt(), Absorbed::BY_RECALIBRATION)? else {
                continue;
            };
            parts.unlisted.push(Unlisted {
                law: law.name.to_owned(),
                floors: sized.detectability / count.sqrt(),
                class: law.class.map(|class| class.id().to_owned()),
            });
            parts.laws.push(sized.law);
        }
        Ok((parts.effects.len() > 1 && !parts.unlisted.is_empty()).then_some(parts))
    }
}

/// Shuffles a list.
fn shuffled<T>(mut items: Vec<T>, draws: &mut Draws) -> Vec<T> {
    for last in (1..items.len()).rev() {
        items.swap(last, draws.below(last + 1));
    }
    items
}

/// Returns `true` if a motion stays near the rest angle.
fn is_sensible(situation: &Situation, motion: &Motion) -> bool {
    let rest = situation.nominal.rest_angle();
    let near = |position: &f64| (position - rest).abs() <= LARGEST_SWING * situation.amplitude;
    motion.position.iter().all(near)
}
