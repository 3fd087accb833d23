//! Reading of a robot's recordings and its model.

use crate::error::WorkflowError;
use crate::logs::logs;
use crate::read::{Loaded, Reading};
use record::{Fault, Filter, Unit, extremes};
use robot::columns::{JointColumns, Stated, find, find_long};
use robot::{Along, Channel, JointInfo, Model, Recording, RobotError, Urdf};
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Options of a robot's diagnosis beside those of reading.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RobotOptions {
    /// Names of the joints to diagnose; all if empty.
    pub joints: Vec<String>,
    /// Columns of joints, where the header does not tell.
    pub columns: Vec<Stated>,
    /// Inertia of rotors at the joints, by name.
    pub armatures: Vec<(String, f64)>,
    /// Recordings that are not fitted, with which the whole model is checked.
    pub check: Vec<PathBuf>,
}

/// Recording of all joints with its source.
#[derive(Debug, Clone)]
pub struct LoadedRecording {
    /// Samples of all joints, with the model along their motion.
    pub along: Along,
    /// The same, joint by joint, with source and clock.
    pub joints: Vec<Loaded>,
    /// `true` if the recording is fitted; otherwise the whole model is checked with it.
    pub fitted: bool,
}

/// Recordings of a robot and its model.
pub struct RobotQuestion {
    /// Model of the robot.
    pub model: Arc<dyn Model>,
    /// Name of the model's file.
    pub name: String,
    /// Recordings, in the order given, those to check last.
    pub recordings: Vec<LoadedRecording>,
    /// Indices of the joints to diagnose.
    pub asked: Vec<usize>,
}

/// Columns of one joint, with the lines that belong to it.
struct Place {
    columns: JointColumns,
    filter: Option<Filter>,
}

impl RobotQuestion {
    /// Reads recordings and a model from files; a folder stands for the logs in it.
    ///
    /// # Errors
    /// [`WorkflowError`] with the file, the place in it and the option to set.
    pub fn read(
        records: &[PathBuf],
        model: &Path,
        options: &RobotOptions,
        reading: &Reading,
    ) -> Result<Self, WorkflowError> {
        let name = model.display().to_string();
        let text = std::fs::read_to_string(model).map_err(|error| RobotError::NotXml {
            file: name.clone(),
            problem: format!("it cannot be read: {error}"),
        })?;
        let model = Urdf::parse(&name, &text)?.with_armatures(&options.armatures)?;
        Self::of(Arc::new(model), name, records, options, reading)
    }

    /// Reads recordings of a robot whose model is there already; `name` is its name in messages.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn of(
        model: Arc<dyn Model>,
        name: String,
        records: &[PathBuf],
        options: &RobotOptions,
        reading: &Reading,
    ) -> Result<Self, WorkflowError> {
        let asked = asked(model.joints(), &options.joints)?;
        let mut recordings: Vec<LoadedRecording> = Vec::new();
        for (paths, fitted) in [(records, true), (&options.check, false)] {
            for path in paths {
                for log in logs(path)? {
                    recordings.push(load(&log, &*model, (options, &asked), (reading, fitted))?);
                }
            }
        }
        check_distinct(&recordings)?;
        Ok(Self { model, name, recordings, asked })
    }
}

/// Returns the index of a joint by its name.
pub(super) fn place(joints: &[JointInfo], name: &str) -> Result<usize, RobotError> {
    joints.iter().position(|joint| joint.name == name).ok_or_else(|| {
        let known: Vec<&str> = joints.iter().map(|joint| joint.name.as_str()).collect();
        RobotError::Unknown { name: name.to_owned(), what: "joint of the model", known: known.join(", ") }
    })
}

/// Returns the indices of the joints that are asked for.
fn asked(joints: &[JointInfo], names: &[String]) -> Result<Vec<usize>, WorkflowError> {
    let mut asked: Vec<usize> = match names {
        [] => (0..joints.len()).collect(),
        names => names.iter().map(|name| place(joints, name)).collect::<Result<_, _>>()?,
    };
    asked.sort_unstable();
    asked.dedup();
    Ok(asked)
}

/// Checks that a recording lasts long enough and holds the torques of the joints to diagnose.
fn check_usable(
    recording: &Recording,
    loaded: &[Loaded],
    joints: &[JointInfo],
    asked: &[usize],
) -> Result<(), RobotError> {
    recording.check_length()?;
    let lacks = |index: &&usize| recording.joints.get(**index).is_some_and(|own| own.torques.is_none());
    match asked.iter().find(lacks).and_then(|index| joints.get(*index)) {
        None => Ok(()),
        Some(joint) => Err(RobotError::NoColumn {
            log: recording.name.clone(),
            quantity: "torque",
            joint: joint.name.clone(),
            columns: loaded.first().map_or_else(String::new, |own| own.columns.clone()),
            option: format!("{}=POSITION,TORQUE", joint.name),
        }),
    }
}

fn check_distinct(recordings: &[LoadedRecording]) -> Result<(), WorkflowError> {
    let mut known: BTreeMap<&str, &LoadedRecording> = BTreeMap::new();
    for own in recordings {
        let Some(joint) = own.joints.first() else { continue };
        if let Some(earlier) = known.insert(&joint.source.digest, own) {
            let [first, second] = [earlier, own].map(|own| own.along.recording().name.clone());
            return Err(WorkflowError::SameRecord { first, second, digest: joint.source.digest.clone() });
        }
    }
    Ok(())
}

fn load(
    path: &Path,
    model: &dyn Model,
    (options, asked): (&RobotOptions, &[usize]),
    (reading, fitted): (&Reading, bool),
) -> Result<LoadedRecording, WorkflowError> {
    let name = path.display().to_string();
    let bytes = std::fs::read(path).map_err(|error| {
        WorkflowError::Record(Fault::Unreadable { problem: error.to_string() }.in_file(&name))
    })?;
    let places = places(&name, &bytes, model.joints(), &options.columns)?;
    let mut joints = Vec::new();
    let mut channels = Vec::new();
    for (joint, Place { columns, filter }) in model.joints().iter().zip(places) {
        let mut reading = reading.clone();
        let own = &mut reading.options;
        own.columns.value = Some(columns.position.clone());
        own.columns.input = Some(columns.torque.clone().unwrap_or_else(|| "none".to_owned()));
        own.columns.filter = filter.or(own.columns.filter.take());
        own.driven = columns.torque.is_some();
        own.coordinate =
            Some(if joint.slides { record::Coordinate::Displacement } else { record::Coordinate::Angle });
        let stated_unit = own.columns.unit.is_some();
        let mut loaded = Loaded::parse(&name, &bytes, &reading)?;
        if !joint.slides && !stated_unit && !loaded.source.reading.value.is_stated_by_header() {
            // A guess by the size of the numbers would differ from joint to joint.
            reading.options.columns.unit = Some(Unit::Radian);
            loaded = Loaded::parse(&name, &bytes, &reading)?;
        }
        if !joint.slides && !stated_unit {
            check_turns(&loaded, joint)?;
        }
        let times = loaded.believed()?.times_s;
        let torques = loaded.record.input().map(<[f64]>::to_vec);
        channels.push(Channel { times, positions: loaded.record.values().to_vec(), torques });
        joints.push(loaded);
    }
    let recording = Recording { name, joints: channels };
    check_usable(&recording, &joints, model.joints(), asked)?;
    Ok(LoadedRecording { along: Along::of(model, recording)?, joints, fitted })
}

fn places(
    name: &str,
    bytes: &[u8],
    joints: &[JointInfo],
    stated: &[Stated],
) -> Result<Vec<Place>, WorkflowError> {
    let header = record::titles(name, bytes).map_err(WorkflowError::Record)?;
    let Some((column, values)) = header.joints else {
        let found = find(name, &header.titles, joints, stated)?;
        return Ok(found.into_iter().map(|columns| Place { columns, filter: None }).collect());
    };
    let columns = find_long(name, &header.titles)?;
    let place = |joint: &JointInfo| match values.contains(&joint.name) {
        true => {
            let filter = Filter { column: column.clone(), value: joint.name.clone() };
            Ok(Place { columns: columns.clone(), filter: Some(filter) })
        }
        false => Err(WorkflowError::Robot(RobotError::Unknown {
            name: joint.name.clone(),
            what: "value of the column joint, but a joint of the model",
            known: values.join(", "),
        })),
    };
    joints.iter().map(place).collect()
}

/// Refuses angles that are called radians only by their header, or by nothing, and exceed a turn on either side.
fn check_turns(loaded: &Loaded, joint: &JointInfo) -> Result<(), WorkflowError> {
    let [lowest, highest] = extremes(loaded.record.values());
    let span = highest - lowest;
    if loaded.record.unit() == Unit::Radian.symbol() && span > 2.0 * TAU {
        return Err(WorkflowError::Robot(RobotError::Degrees {
            log: loaded.source.path.clone(),
            joint: joint.name.clone(),
            column: loaded.source.reading.value.column.clone(),
            span,
            turns: span / TAU,
        }));
    }
    Ok(())
}
