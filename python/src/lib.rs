//! The way in from Python: the Rust interface as an extension module.
//!
//! Everything here translates: arguments to the types of `ringdown_lab`, errors to exceptions, results to JSON text, arrays to
//! and from NumPy. The package beside it, `python/ringdown_lab`, gives these their shape in Python.

mod diagnosis;
mod error;
mod estimate;
mod learning;
mod nominal;
mod program;
mod record;
mod robot;
mod simulate;
mod words;
mod work;

/// What the package is built on; use `ringdown_lab`.
#[pyo3::pymodule]
mod _native {
    #[pymodule_export]
    use crate::diagnosis::{NativeDiagnosis, diagnose};
    #[pymodule_export]
    use crate::error::{ConfigError, DiagnosisError, FitError, RecordError, RingdownError};
    #[pymodule_export]
    use crate::estimate::{estimate, estimate_own, methods};
    #[pymodule_export]
    use crate::learning::learn;
    #[pymodule_export]
    use crate::nominal::NativeNominal;
    #[pymodule_export]
    use crate::program::program;
    #[pymodule_export]
    use crate::record::NativeRecord;
    #[pymodule_export]
    use crate::robot::{NativeJoints, NativeRobot, diagnose_joints};
    #[pymodule_export]
    use crate::simulate::{effects, simulate};
}
