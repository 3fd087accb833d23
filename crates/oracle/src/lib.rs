//! Closed-form least squares with certified digits: what every estimator is compared with.
