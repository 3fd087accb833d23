//! Training of the network.

use crate::config::LstmConfig;
use crate::network::Network;
use envelope::Envelope;
use estimator::{Estimate, Estimator, FitContext, FitError};
use neural::{Reconstruction, device};

impl Estimator for LstmConfig {
    fn fit(&self, envelope: &Envelope, context: &FitContext<'_>) -> Result<Estimate, FitError> {
        let device = device()?;
        let network = Network::for_one_envelope(self.hidden_units, &device);
        let start = network.draw(self.initial_scale, &mut context.seed("initial weights").generator())?;
        let training = Reconstruction {
            longest_sequence: self.longest_sequence,
            max_steps: self.max_steps,
            memory: self.memory,
            gradient_tolerance: self.gradient_tolerance,
        };
        training.fit(envelope, context, &network, start, &device)
    }
}
