//! Learner shared by all architectures.

use super::frame::Framed;
use super::model::SequenceModel;
use super::roll::{Roll, sizes};
use super::{Architecture, Settings, plain_device};
use crate::data::{DataSet, Trajectory, Window, windows};
use crate::training::{Schedule, State, Training, train};
use crate::{Context, Fitted, LearnError, Learner, Model, Stored};
use estimator::Reached;
use neural::{DeviceKind, device_of};
use settings::{Resolved, SettingsError};

/// Architecture with its settings.
struct SequenceLearner<A> {
    architecture: A,
    settings: Settings,
}

/// Share of the steps over which the learning rate rises, and final learning rate as a share of the largest.
const WARM_UP: f64 = 0.05;
const LAST: f64 = 0.01;

/// Norm to which a gradient is clipped.
const CLIP: f64 = 1.0;

/// Largest number of windows, and of blocks per window, of a validation.
const HELD_WINDOWS: usize = 24;
const HELD_BLOCKS: usize = 40;

/// Builds the learner of an architecture from its section.
///
/// # Errors
/// [`SettingsError`] for a section of another form, and for a device that the program was built without.
pub fn build<A: Architecture>(resolved: &Resolved) -> Result<Box<dyn Learner>, SettingsError> {
    let architecture: A = resolved.section(A::ID)?;
    let settings: Settings = resolved.section(A::ID)?;
    let name = settings.device.name();
    if !settings.device.is_built() {
        let device = resolved.setting(&format!("{}.device", A::ID))?;
        let built = DeviceKind::all_built();
        return Err(SettingsError::BadValue {
            origin: device.origin.clone(),
            key: device.key(),
            found: format!("\"{name}\""),
            expected: format!(
                "what this program was built with ({built}); build it with `--features {name}`"
            ),
            unit: String::new(),
        });
    }
    Ok(Box::new(SequenceLearner { architecture, settings }))
}

/// Restores a model of an architecture from its file.
///
/// # Errors
/// [`LearnError::Stored`] for a file of another form.
pub fn restore<A: Architecture>(stored: &Stored) -> Result<Box<dyn Model>, LearnError> {
    Ok(Box::new(SequenceModel::<A>::restored(stored)?))
}

/// Returns the windows of the validation part: long ones of equal length, evenly chosen.
fn held(parts: &[Trajectory], past: usize, block: usize) -> Vec<Window> {
    let Some(shortest) = parts.iter().map(Trajectory::len).min() else { return Vec::new() };
    let blocks = (shortest.saturating_sub(past) / block).clamp(1, HELD_BLOCKS);
    let all = windows(parts, past, blocks * block, blocks * block);
    let stride = all.len().div_ceil(HELD_WINDOWS).max(1);
    all.into_iter().step_by(stride).collect()
}

impl<A: Architecture> Learner for SequenceLearner<A> {
    fn fit(&self, data: &DataSet, context: &Context<'_>) -> Result<Fitted, LearnError> {
        let settings = &self.settings;
        let Framed { frame, train: parts, validation } = Framed::new(data, settings)?;
        let blocks = parts.iter().map(|part| part.len().saturating_sub(frame.past) / frame.block);
        let blocks = blocks.fold(1, usize::max).min(settings.blocks);
        let future = blocks * frame.block;
        let stride = windows(&parts, frame.past, future, 1).len().div_ceil(settings.windows).max(1);
        let device = device_of(settings.device, settings.precision)?;
        let roll = Roll {
            architecture: &self.architecture,
            held: held(&validation, frame.past, frame.block),
            shape: self.architecture.init(sizes(&frame), &context.seed, &device)?,
            frame: &frame,
            train: &parts,
            validation: &validation,
            device,
        };
        let training = Training {
            epochs: settings.epochs,
            batch: settings.batch,
            schedule: Schedule { peak: settings.learning_rate, warm_up: WARM_UP, last: LAST },
            clip: CLIP,
            weight_decay: settings.weight_decay,
            patience: settings.patience,
        };
        let all = windows(&parts, frame.past, future, stride);
        let mut keep = |state: &State| context.checkpoint(state.steps, state);
        let trained = train(&roll, &all, &training, context.resumed()?, context, &mut keep)?;
        let state = trained.state;
        let reached = if trained.stopped_early { Reached::Converged } else { Reached::BudgetSpent };
        let network = neural::with_parameters(roll.shape.clone(), &state.best, &plain_device()?)?;
        let model = SequenceModel::<A>::new(
            self.architecture.clone(),
            frame.clone(),
            &network,
            state.best_validation,
        )?;
        Ok(Fitted { model: Box::new(model.calibrated(data)), reached, steps: state.steps })
    }
}
