//! Whole model of a robot against recordings, with what was found in its joints.

use super::joint::JointAnswer;
use super::read::{LoadedRecording, RobotQuestion, place};
use crate::error::WorkflowError;
use diagnosis::Settings;
use dynamics::tree::Acting;
use dynamics::{Hold, REGISTRY};
use rayon::prelude::*;
use results::{ClosedLoopRecording, ClosedLoopRow, JointErrorRow, RunStartRow};
use robot::{ClosedLoop, JointError, RobotError, Variant, closed_loop};
use std::ops::Range;

/// Lengths of a run in seconds, the first one that the fitted models follow: links that fall without their controller may move
/// chaotically, and no model with the errors of a torque sensor follows them for long.
const SPANS_S: [f64; 4] = [3.0, 1.5, 0.75, 0.375];

/// Share of a single recording that is fitted, if no other one is there to check with.
const FITTED: f64 = 0.67;

/// Model that is run.
enum Model {
    Given,
    Recalibrated,
    Repaired,
}

/// Recordings and coefficients of a check.
struct Check<'a> {
    recordings: Vec<&'a LoadedRecording>,
    part: Range<f64>,
    acting: [Vec<Acting>; 3],
    holds: Vec<Hold>,
    gains: Vec<f64>,
    held_out: String,
}

impl RobotQuestion {
    /// Runs the whole model, as given, recalibrated and repaired, over recordings that were not fitted. Those of
    /// [`super::RobotOptions::check`] serve if there are any; otherwise the coefficients of the named effects are
    /// fitted again without the last recording, or without the last third of the only one.
    ///
    /// # Errors
    /// [`WorkflowError`] if a torque was not recorded, or if a fit fails.
    pub fn closed_loop(
        &self,
        answers: &[JointAnswer],
        settings: &Settings,
        seed: u64,
    ) -> Result<ClosedLoopRow, WorkflowError> {
        let check = self.check(answers, settings, seed)?;
        let floors = self.floors(answers);
        let mut spans = Vec::new();
        for own in &check.recordings {
            let ends = own.along.recording().joints.first().map(|own| (own.times.first(), own.times.last()));
            if let Some((Some(first), Some(last))) = ends {
                spans.push((last - first) * (check.part.end - check.part.start));
            }
        }
        let longest = spans.into_iter().fold(0.0, f64::max);
        let (mut fitted, mut held) = (Vec::new(), longest);
        for span in SPANS_S.into_iter().filter(|span| *span < longest || *span == SPANS_S[3]) {
            (fitted, held) = (self.runs(&check, &[Model::Recalibrated, Model::Repaired], span)?, span);
            if fitted.iter().zip(&check.recordings).all(|(found, own)| is_followed(found, own)) {
                break;
            }
        }
        let given = self.runs(&check, &[Model::Given], held)?;
        let found = given.into_iter().zip(fitted).map(|(given, fitted)| [given, fitted].concat());
        let recordings = check.recordings.iter().zip(found);
        Ok(ClosedLoopRow {
            recordings: recordings.map(|(own, found)| row(self, own, &found, &floors)).collect(),
            span_s: held.min(longest),
            is_held_out: true,
            held_out: check.held_out,
        })
    }

    /// Runs models over the recordings of a check, in runs of `span` seconds.
    fn runs(
        &self,
        check: &Check<'_>,
        models: &[Model],
        span: f64,
    ) -> Result<Vec<Vec<ClosedLoop>>, RobotError> {
        let exact = vec![1.0; check.gains.len()];
        let one = |own: &&LoadedRecording| {
            let of = |model: &Model| {
                let [given, recalibrated, repaired] = &check.acting;
                // The model as given takes the torques as they were read.
                let (acting, gains) = match model {
                    Model::Given => (given, &exact),
                    Model::Recalibrated => (recalibrated, &check.gains),
                    Model::Repaired => (repaired, &check.gains),
                };
                let variant = Variant { acting, holds: &check.holds, gains };
                closed_loop(&*self.model, variant, &own.along, (span, check.part.clone()))
            };
            models.par_iter().map(of).collect()
        };
        check.recordings.iter().map(one).collect()
    }

    fn check(
        &self,
        answers: &[JointAnswer],
        settings: &Settings,
        seed: u64,
    ) -> Result<Check<'_>, WorkflowError> {
        let (fitted, others): (Vec<usize>, Vec<usize>) = (0..self.recordings.len())
            .partition(|index| self.recordings.get(*index).is_some_and(|own| own.fitted));
        let named = |indices: &[usize]| -> Vec<&LoadedRecording> {
            indices.iter().filter_map(|index| self.recordings.get(*index)).collect()
        };
        if !others.is_empty() {
            return Ok(Check {
                recordings: named(&others),
                part: 0.0..1.0,
                acting: self.acting(answers),
                holds: self.holds(answers),
                gains: self.gains(answers),
                held_out: "the recordings given with --check, which no fit has seen".to_owned(),
            });
        }
        let (train, recordings, part, held_out) = match fitted.split_last() {
            Some((last, before)) if !before.is_empty() => (
                (before.to_vec(), 1.0),
                named(&[*last]),
                0.0..1.0,
                "the last recording; the coefficients of the named effects were fitted to the others",
            ),
            _ => (
                (fitted.clone(), FITTED),
                named(&fitted),
                FITTED..1.0,
                "the last third of the recording; the coefficients of the named effects were fitted to the rest",
            ),
        };
        let (indices, share) = train;
        let again = |own: &JointAnswer| self.again(own, (&indices, share), settings, seed);
        let again: Vec<JointAnswer> = answers.par_iter().map(again).collect::<Result<_, _>>()?;
        Ok(Check {
            recordings,
            part,
            acting: self.acting(&again),
            holds: self.holds(&again),
            gains: self.gains(&again),
            held_out: held_out.to_owned(),
        })
    }

    /// Fits effects of the classes that an answer names, and no others, to other recordings.
    fn again(
        &self,
        own: &JointAnswer,
        (recordings, share): (&[usize], f64),
        settings: &Settings,
        seed: u64,
    ) -> Result<JointAnswer, WorkflowError> {
        let result = &own.answer.result;
        // The class is what a recording tells; with less of it, another kind of the class may be the simpler one.
        let classes = result.classes.iter().map(|class| &class.kinds);
        let named =
            classes.filter(|kinds| kinds.iter().any(|kind| result.verdict.effects.contains(&kind.id)));
        let named: Vec<&str> = named.flatten().map(|kind| kind.id.as_str()).collect();
        let others = REGISTRY.iter().map(|effect| effect.id()).filter(|id| !named.contains(id));
        let without = others.map(str::to_owned).collect();
        let settings = Settings { without, ..settings.clone() };
        let joint = place(self.model.joints(), &own.joint.name)?;
        self.joint(joint, recordings, share)?.answer(&settings, seed, &|_| true)
    }

    /// Returns what acts in every joint: as given, recalibrated, repaired. A joint without an answer stays as given.
    fn acting(&self, answers: &[JointAnswer]) -> [Vec<Acting>; 3] {
        let of = |variant: usize| {
            let joint = |joint: &robot::JointInfo| {
                let answer = answers.iter().find(|own| own.joint.name == joint.name);
                let given = || Acting { damping: joint.damping, ..Acting::default() };
                answer.and_then(|own| own.acting.get(variant)).cloned().unwrap_or_else(given)
            };
            self.model.joints().iter().map(joint).collect()
        };
        [of(0), of(1), of(2)]
    }

    /// Returns the behavior of each drive between samples; that of the first answer for a joint without one.
    fn holds(&self, answers: &[JointAnswer]) -> Vec<Hold> {
        let first = answers.first().map_or(Hold::Linear, |own| own.hold);
        let of = |joint: &robot::JointInfo| {
            answers.iter().find(|own| own.joint.name == joint.name).map_or(first, |own| own.hold)
        };
        self.model.joints().iter().map(of).collect()
    }

    /// Returns the torque of each drive over what its sensor reads: 1 where the recordings say nothing else.
    fn gains(&self, answers: &[JointAnswer]) -> Vec<f64> {
        let of = |joint: &robot::JointInfo| {
            let answer = answers.iter().find(|own| own.joint.name == joint.name);
            answer.and_then(|own| own.repair.torque_gain).map_or(1.0, |gain| gain.value)
        };
        self.model.joints().iter().map(of).collect()
    }

    /// Returns the noise of each joint's sensor; 0 for a joint without an answer.
    fn floors(&self, answers: &[JointAnswer]) -> Vec<f64> {
        let of = |joint: &robot::JointInfo| {
            let answer = answers.iter().find(|own| own.joint.name == joint.name);
            answer.map_or(0.0, |own| own.answer.result.gap.noise_floor)
        };
        self.model.joints().iter().map(of).collect()
    }
}

/// Returns `true` if one of the fitted models stays closer to the motion of each joint than the mean position does.
fn is_followed(found: &[ClosedLoop], own: &LoadedRecording) -> bool {
    own.along.recording().joints.iter().enumerate().all(|(joint, channel)| {
        let count = channel.positions.len().max(1) as f64;
        let mean = channel.positions.iter().sum::<f64>() / count;
        let size = channel.positions.iter().map(|own| (own - mean).powi(2)).sum::<f64>() / count;
        let error = |own: &ClosedLoop| own.joints.as_ref()?.get(joint)?.rms();
        let best = found.iter().filter_map(error).fold(f64::INFINITY, f64::min);
        best * best <= size
    })
}

fn row(
    question: &RobotQuestion,
    own: &LoadedRecording,
    found: &[ClosedLoop],
    floors: &[f64],
) -> ClosedLoopRecording {
    let error = |variant: usize, joint: usize| {
        let joints = found.get(variant)?.joints.as_ref()?;
        joints.get(joint).and_then(JointError::rms)
    };
    let joints = question.model.joints().iter().enumerate().zip(floors);
    let joints = joints.map(|((at, joint), floor)| JointErrorRow {
        unit: if joint.slides { "m" } else { "rad" }.to_owned(),
        nominal: error(0, at),
        recalibrated: error(1, at),
        repaired: error(2, at),
        noise_floor: *floor,
    });
    // The variant with the most runs has all starts.
    let longest =
        found.iter().max_by_key(|own| own.starts.len()).map_or(&[][..], |own| own.starts.as_slice());
    let starts = longest.iter().map(|(time_s, state)| RunStartRow {
        time_s: *time_s,
        position: state.position.clone(),
        velocity: state.velocity.clone(),
    });
    ClosedLoopRecording {
        path: own.along.recording().name.clone(),
        // Variants have as many runs each, unless their motion leaves every bound.
        runs: found.iter().map(|own| own.runs).fold(0, usize::max),
        starts: starts.collect(),
        joints: joints.collect(),
    }
}
