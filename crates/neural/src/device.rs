//! burn's CPU backend in double precision.

#![expect(clippy::disallowed_methods, reason = "this module hands out the device")]

use burn::tensor::{Device, FloatDType, IntDType, Tensor, TensorData};
use estimator::FitError;
use std::sync::OnceLock;

static DEVICE: OnceLock<Result<Device, String>> = OnceLock::new();

/// burn's CPU device, set to double precision.
///
/// The setting holds for the whole process and can be made once only, before the first tensor; hence
/// every tensor of this workspace has to come by way of this function.
///
/// # Errors
/// [`FitError::Backend`] where burn refuses the setting.
pub fn device() -> Result<Device, FitError> {
    DEVICE
        .get_or_init(|| {
            let mut device = Device::flex();
            device
                .configure((FloatDType::F64, IntDType::I64))
                .map_err(|error| format!("double precision was refused: {error:?}"))?;
            Ok(device)
        })
        .clone()
        .map_err(|problem| FitError::Backend { problem })
}

/// A matrix of doubles on a device, from its rows one after the other.
///
/// By way of `TensorData`, which keeps every digit; burn's literals go through single precision.
#[must_use]
pub fn tensor(values: Vec<f64>, [rows, columns]: [usize; 2], device: &Device) -> Tensor<2> {
    Tensor::from_data(TensorData::new(values, [rows, columns]), device)
}

/// The doubles of a tensor, rows one after the other.
///
/// # Errors
/// [`FitError::Backend`] where the tensor does not hold doubles.
pub fn values<const D: usize>(tensor: Tensor<D>) -> Result<Vec<f64>, FitError> {
    tensor
        .into_data()
        .try_to_vec::<f64>()
        .map_err(|error| FitError::Backend { problem: format!("{error:?}") })
}
