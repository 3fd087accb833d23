//! Diagnosis of a robot: recordings of several joints and a model, one question for each joint, and a check of the
//! whole model.

mod closed_loop;
mod identifiable;
mod joint;
mod read;
mod recordings;
mod result;

pub use joint::{JointAnswer, JointQuestion};
pub use read::{LoadedRecording, RobotOptions, RobotQuestion};

use diagnosis::{Settings, Stage};
use rayon::prelude::*;
use results::{FailedCase, JointsResult};
use std::time::Instant;

/// Question and answer of a joint, or the reason why it has no answer.
pub type JointFate = Result<(JointQuestion, JointAnswer), FailedCase>;

/// Joints of a robot with their answers, and the content of `joints.json`.
pub struct RobotAnswer {
    /// Questions and answers of the joints that have one, in the model's order.
    pub joints: Vec<(JointQuestion, JointAnswer)>,
    /// Content of `joints.json`.
    pub result: JointsResult,
    /// Repaired model; `None` for a model that is no file, or cannot be written.
    pub repaired: Option<robot::RepairedModel>,
}

impl RobotQuestion {
    /// Returns the name of a joint of the model by its index.
    fn name_of(&self, joint: usize) -> String {
        let own = self.model.joints().get(joint);
        own.map_or_else(|| format!("joint {}", joint + 1), |own| own.name.clone())
    }

    /// Diagnoses every joint in parallel and checks the whole model. A joint that fails is among
    /// [`JointsResult::failed`], and the others continue. `goes_on` is asked after each stage of a joint, and `done` hears of each
    /// joint.
    #[must_use]
    pub fn answer(
        &self,
        settings: &Settings,
        seed: u64,
        goes_on: &(dyn Fn(Stage) -> bool + Sync),
        done: &(dyn Fn(&JointFate) + Sync),
    ) -> RobotAnswer {
        let start = Instant::now();
        let fitted: Vec<usize> = (0..self.recordings.len())
            .filter(|index| self.recordings.get(*index).is_some_and(|own| own.fitted))
            .collect();
        let fate = |joint: &usize| {
            let answer = self.joint(*joint, &fitted, 1.0).and_then(|own| {
                let answer = own.answer(settings, seed, goes_on)?;
                Ok((own, answer))
            });
            let fate =
                answer.map_err(|error| FailedCase { id: self.name_of(*joint), message: error.to_string() });
            done(&fate);
            fate
        };
        let (mut questions, mut answers, mut failed) = (Vec::new(), Vec::new(), Vec::new());
        for fate in self.asked.par_iter().map(fate).collect::<Vec<JointFate>>() {
            match fate {
                Ok((question, answer)) => {
                    questions.push(question);
                    answers.push(answer);
                }
                Err(case) => failed.push(case),
            }
        }
        let mut notes = Vec::new();
        let closed_loop = self
            .closed_loop(&answers, settings, seed)
            .map_err(|error| notes.push(format!("The whole model was not run: {error}.")))
            .ok();
        let repaired = self.repaired(&answers).unwrap_or_else(|error| {
            notes.push(format!("The repaired model was not written: {error}."));
            None
        });
        let result = self.result(&answers, failed, closed_loop, (notes, start.elapsed().as_secs_f64()));
        RobotAnswer { joints: questions.into_iter().zip(answers).collect(), result, repaired }
    }
}
