//! Neural ordinary differential equation for the envelope.
//!
//! A network is the vector field of y = ln A in scaled units, y′ = f(y, s) = c + net(y, s), with a trainable
//! initial state y(−1). The classical Runge–Kutta method solves it, and the numerical solution is trained by
//! Levenberg–Marquardt on its exact Jacobian. The Jacobian is the derivative of the solver's own arithmetic,
//! from one batched backward pass over all its stages.
//!
//! The field depends on the time besides the state, so that damping may change with amplitude and drift with
//! time. One trajectory cannot tell these apart, and the method does not claim to. A field of the state alone
//! could only have monotonic trajectories, and would bias λ. The constant part c is the affine skip: its
//! trajectory is a line, an exponential decay.
//!
//! A field this flexible would follow the scatter of the peaks. Two terms limit it: the trajectory's mean
//! squared second derivative, which makes a smoothing spline smooth and a neural ODE easy to solve; and
//! weight decay, without which weights grow without end for insignificant gains in the loss.
//!
//! λ is minus the slope of the least-squares line through the trained trajectory's values at the peaks: a
//! property of the fitted function. After convergence it agrees with the slope of the line through the peaks
//! themselves, for the following reason. y + a + b·s solves the field whose first layer receives y − a − b·s
//! and whose c is larger by b. So a line added to the trajectory is a change of parameters, for the numerical
//! solution too. It changes no second derivative, and the weights that it changes are not subject to the
//! decay. Hence at a stationary point the residuals are orthogonal to 1 and to t, and have no slope. This
//! does not hold at the start: an untrained field is wrong.
//!
//! Predictions follow the field beyond the last peak and before the first one, where only weight decay limits
//! it. Their standard deviation is that of a Laplace approximation.
//!
//! References: Chen, Rubanova, Bettencourt, Duvenaud, NeurIPS 31 (2018), equation 2 (the model); Kelly,
//! Bettencourt, Johnson, Duvenaud, NeurIPS 33 (2020), section 3 (the derivative of order K as a
//! regularizer; K = 2 here).

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod config;
mod field;
mod fit;
mod objective;
mod solver;
#[cfg(test)]
mod tests;

pub use config::NeuralOdeConfig;

use estimator::{Entry, Estimator, Tag};
use field::VectorField;
use neural::check_memory;

/// Registry entry of the neural ODE.
pub const ENTRY: Entry = Entry {
    id: "neural-ode",
    paper_number: Some(14),
    title: "Neural ordinary differential equation",
    summary: "A network as the vector field of ln A, trained through a Runge-Kutta solver; λ is the slope of \
              its trajectory.",
    tags: &[Tag::Iterative, Tag::Seeded, Tag::Interval, Tag::Ablation],
    citations: &[
        "Chen, Rubanova, Bettencourt, Duvenaud, Advances in Neural Information Processing Systems 31 (2018) \
         6571-6583",
        "Kelly, Bettencourt, Johnson, Duvenaud, Advances in Neural Information Processing Systems 33 (2020) \
         4370-4380",
        "Marquardt, SIAM Journal on Applied Mathematics 11 (1963) 431-441",
    ],
    fields: config::FIELDS,
    build: |settings| {
        let config: NeuralOdeConfig = settings.section("estimator")?;
        // The initial state counts besides the field's parameters. The number of peaks is not known yet, but
        // it is small.
        check_memory(settings, VectorField::parameter_count(&config.hidden) + 1, 0)?;
        Ok(Box::new(config) as Box<dyn Estimator>)
    },
};
