//! Training of the network.

use crate::config::TransformerConfig;
use crate::network::Network;
use envelope::Envelope;
use estimator::{Estimate, Estimator, FitContext, FitError};
use neural::device;

impl Estimator for TransformerConfig {
    fn fit(&self, envelope: &Envelope, context: &FitContext<'_>) -> Result<Estimate, FitError> {
        let device = device()?;
        let network = Network::zeros(self.size(), &device);
        let start = network.draw(self.initial_scale, &mut context.seed("initial weights").generator())?;
        self.training.fit(envelope, context, &network, start, &device)
    }
}
