//! A system with effects as text: for people, and for other simulators.
//!
//! What an effect looks like elsewhere is said in the effect's own file (`dynamics::Export`); here those pieces are
//! put together. What a format cannot express is said in a comment inside it, never left out in silence.

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

/// Every form with the name of its file.
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
