//! Search over sets of effects.

pub(crate) mod alternatives;
pub(crate) mod asked;
pub(crate) mod beam;
pub(crate) mod bump;
pub(crate) mod from_afar;
pub(crate) mod gains;
pub(crate) mod nameless;
pub(crate) mod null;
pub(crate) mod plain;
pub(crate) mod position_torque;
pub(crate) mod refine;
pub(crate) mod smoothed;
pub(crate) mod weak_form;
