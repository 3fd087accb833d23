//! Simulator to be fitted: its hypotheses, their predictions, and every effect it may lack.

pub(crate) mod candidate;
pub(crate) mod candidates;
pub(crate) mod contact;
pub(crate) mod encoder_hysteresis;
pub(crate) mod hypothesis;
pub(crate) mod lag;
pub(crate) mod predictor;
pub(crate) mod seen;
pub(crate) mod sensor;
pub(crate) mod vocabulary;
