//! Physics-informed neural network for the envelope's decay rate.
