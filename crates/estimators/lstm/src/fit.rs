//! Training of the network.

use crate::config::LstmConfig;
use crate::network::Network;
use envelope::Envelope;
use estimator::{Estimate, Estimator, FitContext, FitError};
use neural::device;

impl Estimator for LstmConfig {
    fn fit(&self, envelope: &Envelope, context: &FitContext<'_>) -> Result<Estimate, FitError> {
        let device = device()?;
        let network = Network::for_one_envelope(self.hidden_units, &device);
        let start = network.draw(self.initial_scale, &mut context.seed("initial weights").generator())?;
        self.training.fit(envelope, context, &network, start, &device)
    }
}
