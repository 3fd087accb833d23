//! Export of a system with effects as text: for people, and for other simulators.
//!
//! The form of each effect in other languages is part of the effect's own file (`dynamics::Export`); this
//! crate puts these parts together. What a format cannot express is stated in a comment inside it, never left
//! out silently.
//!
//! # Example
//!
//! ```
//! use dynamics::chain::Observed;
//! use dynamics::{Active, Nominal, Start, System};
//! use export::{Repaired, equation_text, files};
//!
//! let nominal = Nominal::new(1.0, 0.3, 484.0, 0.0)?;
//! let friction = Active::named("coulomb_friction", &[("torque", 2.0)])?;
//! let repaired = Repaired {
//!     system: System::new(nominal, vec![friction])?,
//!     units: nominal.units(),
//!     chain: Vec::new(),
//!     left_out: Vec::new(),
//!     input: None,
//!     start: Start::release(0.7),
//!     hidden_starts: Vec::new(),
//!     observed: Observed::Position,
//!     noise: 5e-4,
//!     rate_hz: 130.0,
//!     seconds: 8.0,
//! };
//! assert!(equation_text(&repaired).contains("τ_c sign(θ′)"));
//! let python = files(&repaired).into_iter().find(|(name, _)| *name == "repaired.py");
//! assert!(python.is_some_and(|(_, text)| text.contains("def rhs(time, state")));
//! # Ok::<(), dynamics::DynamicsError>(())
//! ```

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod configuration;
mod equation;
mod modelica;
mod nominal;
mod python;
mod repaired;
mod robot;
mod terms;
#[cfg(test)]
mod tests;

pub use configuration::configuration;
pub use equation::{equation_latex, equation_text};
pub use modelica::modelica;
pub use nominal::nominal_text;
pub use python::python;
pub use repaired::Repaired;
pub use robot::{mjcf, urdf};

/// Writes the simulator in every format and returns the file names with their texts: `repaired.toml` for
/// `trainer simulate`, `equation.txt` and `equation.tex` for people, `repaired.py` for SciPy, `repaired.mo`
/// for Modelica, `repaired.mjcf.xml` for MuJoCo and `repaired.urdf.xml` for robot descriptions.
#[must_use]
pub fn files(repaired: &Repaired) -> Vec<(&'static str, String)> {
    vec![
        ("repaired.toml", configuration(repaired)),
        ("equation.txt", equation_text(repaired)),
        ("equation.tex", equation_latex(repaired)),
        ("repaired.py", python(repaired)),
        ("repaired.mo", modelica(repaired)),
        ("repaired.mjcf.xml", mjcf(repaired)),
        ("repaired.urdf.xml", urdf(repaired)),
    ]
}
