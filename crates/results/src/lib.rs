//! Types of all results: the schemas of `result.json`, `diagnosis.json` and the tables beside them.
//!
//! Every command's result is written, read, scored and displayed through these types. A state is therefore an
//! enum variant, never a text to be compared. Other programs may rely on the field names: adding fields is
//! fine, renaming them is not.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod actuator;
mod batch;
mod calibration;
mod comparison;
mod diagnosis;
mod estimation;
mod failure;
mod fleet;
mod interval;
mod joints;
mod launch;
mod learning;
mod method;
mod modes;
mod prediction;
mod rigs;
mod search;
mod series;
mod simulation;
mod sweep;
mod trials;

pub use actuator::{ActuatorRow, GainRow, RatioRow};
pub use batch::{BatchResult, CASE_SCHEMA, CaseFile, FailedCase};
pub use calibration::{CalibratedRow, Calibration, KnownEffectRow};
pub use comparison::{
    AblationRow, Caution, ComparisonResult, Derived, MethodEstimate, MethodOutcome, MethodRow,
};
pub use diagnosis::{
    Backbone, BackbonePoint, BudgetShares, ChainFinding, ChainSummary, ClassEvidenceRow, ClassRow,
    DIAGNOSIS_SCHEMA, DISTINCT_DISTANCE, DetectabilityRow, DiagnosisResult, DiagnosisVerdict, EffectRow,
    Equation, GapMaps, GapSummary, KindRow, LeftOverRow, MapCell, NextExperiment, ParameterRow, RecordRow,
    RivalRow, SetRow, StageRow, SurfaceCell, VerdictStatus,
};
/// Origin of a record's numbers.
pub use record::{Origin, Reading};

pub use estimation::{
    DataSummary, EnvelopeRow, EnvelopeSummary, EstimateSummary, EstimationResult, OracleSummary,
    PipelineOutcome, PipelineRow, RESULT_SCHEMA, SeedRow, TraceRow, TruthComparison,
};
pub use failure::Failure;
pub use fleet::{FLEET_SCHEMA, FleetCase, FleetClass, FleetGroup, FleetNumber, FleetOutlier, FleetResult};
pub use interval::WithInterval;
pub use joints::{
    ClosedLoopRecording, ClosedLoopRow, IdentifiableRow, JOINTS_SCHEMA, JointErrorRow, JointRepairRow,
    JointRow, JointsResult, RecordingRow, RunStartRow, TrackingRow,
};
pub use launch::{LAUNCH_SCHEMA, LaunchResult, LaunchedArray};
pub use learning::{
    LearnCoefficient, LearnData, LearnDraw, LearnEnd, LearnKind, LearnPart, LearnPartError, LearnProblem,
    LearnPublished, LearnResult, LearnRow, LearnSeriesRow, LearnTest, LearnTorqueRow, LearnTraceRow,
    LearnValidation,
};
pub use method::{Ablation, Estimand, Family, Reached};
pub use modes::{ModeRow, Resonance};
pub use prediction::{
    Coverage, ExponentialScores, HeldOutScore, LawSummary, MethodScores, PairedComparison, PredictionCsvRow,
    PredictionOutcome, PredictionResult, PredictionRow, ProblemOutcome, ProblemRow, ProblemStudy, SplitKind,
    SplitSummary,
};
pub use rigs::{
    FarthestPair, RIGS_SCHEMA, RigClassRow, RigRow, RigValueRow, RigsResult, SharedClassRow,
    SharedCoefficientRow,
};
pub use search::{
    SearchBest, SearchOutcome, SweepHalving, SweepRung, SweepRungValue, SweepSampler, SweepSearch,
};
pub use series::SeriesRow;
pub use simulation::{EffectCount, Manifest, ManifestLine, RECORDS_SCHEMA, SimulationResult};
pub use sweep::{
    LearnedScores, RunState, RunTable, RunTableRow, RunTableTask, SWEEP_SCHEMA, SweepAxis, SweepEnd,
    SweepLine, SweepManifest, SweepRecord, SweepState,
};
pub use trials::{
    AreaRow, BankRow, BarRow, BaselineRow, ClassScores, ClosureStudy, Confusion, FailureRow, InclusionRow,
    LeftOutBank, NuisanceRow, ProbabilityMap, Proportion, Quantiles, RecallRow, Reliability, ReliabilityBin,
    SizeRow, TRIALS_MANIFEST_SCHEMA, TRIALS_SCHEMA, TrialCaseRow, TrialsManifest, TrialsManifestLine,
    TrialsResult, TrialsShare, UnknownStudy,
};
