//! Devices for the networks' computations: burn's CPU backend, in double precision by default, and the GPU
//! backends that the program was built with.

#![expect(clippy::disallowed_methods, reason = "this module hands out the device")]

use burn::tensor::{DType, Device, FloatDType, IntDType, Tensor, TensorData};
use estimator::FitError;
use serde::{Deserialize, Serialize};
use std::sync::OnceLock;

/// Kind of device.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DeviceKind {
    /// CPU; always available.
    #[default]
    Cpu,
    /// GPU by way of WebGPU; needs the cargo feature `wgpu`.
    Wgpu,
    /// NVIDIA GPU; needs the cargo feature `cuda`.
    Cuda,
}

impl DeviceKind {
    /// Returns the name used in configurations.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Cpu => "cpu",
            Self::Wgpu => "wgpu",
            Self::Cuda => "cuda",
        }
    }

    /// Returns `true` if the program was built with this kind.
    #[must_use]
    pub const fn is_built(self) -> bool {
        match self {
            Self::Cpu => true,
            Self::Wgpu => cfg!(feature = "wgpu"),
            Self::Cuda => cfg!(feature = "cuda"),
        }
    }

    /// Returns the names of all kinds that the program was built with, for a message.
    #[must_use]
    pub fn all_built() -> String {
        let built = [Self::Cpu, Self::Wgpu, Self::Cuda].into_iter().filter(|kind| kind.is_built());
        built.map(Self::name).collect::<Vec<_>>().join(", ")
    }
}

/// Floating-point precision of a network's computations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Precision {
    /// Double precision.
    #[default]
    F64,
    /// Single precision.
    F32,
}

impl Precision {
    /// Returns the name used in configurations.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::F64 => "f64",
            Self::F32 => "f32",
        }
    }

    fn dtypes(self) -> (FloatDType, IntDType) {
        match self {
            Self::F64 => (FloatDType::F64, IntDType::I64),
            Self::F32 => (FloatDType::F32, IntDType::I32),
        }
    }

    fn of_float(self) -> DType {
        match self {
            Self::F64 => DType::F64,
            Self::F32 => DType::F32,
        }
    }
}

/// Device, and the precision to which this process has set it.
type Set = OnceLock<Result<(Device, Precision), String>>;

static CPU: Set = OnceLock::new();
static WGPU: Set = OnceLock::new();
static CUDA: Set = OnceLock::new();

/// Returns burn's CPU device, set to double precision.
///
/// The setting holds for the whole process and can be made only once, before the first tensor. Therefore,
/// every tensor of this workspace must be made through this module.
///
/// # Errors
/// [`FitError::Backend`] if burn refuses the setting, or if this process has set the CPU to single precision.
pub fn device() -> Result<Device, FitError> {
    device_of(DeviceKind::Cpu, Precision::F64)
}

/// Returns burn's CPU device in the precision to which this process has set it, by default double: the device
/// on which a trained network predicts.
///
/// # Errors
/// [`FitError::Backend`] if burn refuses the setting.
pub fn cpu_as_set() -> Result<Device, FitError> {
    let set = CPU.get().and_then(|set| set.as_ref().ok());
    device_of(DeviceKind::Cpu, set.map_or(Precision::F64, |(_, precision)| *precision))
}

/// Returns a device of a kind in a precision; the first one if there are several.
///
/// # Errors
/// [`FitError::Backend`] if the program was built without this kind, the machine has no such device, the
/// device does not support this precision, or this process has set it to the other one. The message states
/// what is available.
pub fn device_of(kind: DeviceKind, precision: Precision) -> Result<Device, FitError> {
    let refused = |problem: String| FitError::Backend { problem };
    let set = match kind {
        DeviceKind::Cpu => &CPU,
        DeviceKind::Wgpu => &WGPU,
        DeviceKind::Cuda => &CUDA,
    };
    let (device, found) = set.get_or_init(|| configured(kind, precision)).clone().map_err(refused)?;
    if found == precision {
        return Ok(device);
    }
    let (kind, found, asked) = (kind.name(), found.name(), precision.name());
    Err(refused(format!(
        "device \"{kind}\" computes in {found} in this process, and {asked} was asked for; use one precision, or run them \
         one after the other"
    )))
}

fn configured(kind: DeviceKind, precision: Precision) -> Result<(Device, Precision), String> {
    let name = kind.name();
    if !kind.is_built() {
        return Err(format!(
            "device \"{name}\" was asked for, and this program was built without it: it has {}; build it with \
             `--features {name}`",
            DeviceKind::all_built()
        ));
    }
    let Some(mut device) = first(kind) else {
        return Err(format!(
            "device \"{name}\" was asked for, and this machine has none: use device = \"cpu\""
        ));
    };
    if !device.supports_dtype(precision.of_float()) {
        return Err(format!(
            "device \"{name}\" does not compute in {}; use precision = \"f32\", or device = \"cpu\"",
            precision.name()
        ));
    }
    device
        .configure(precision.dtypes())
        .map_err(|error| format!("{} was refused: {error:?}", precision.name()))?;
    Ok((device, precision))
}

/// Returns the first device of a kind. Listing devices starts none, so a machine without one gets an error
/// message instead of a panic.
fn first(kind: DeviceKind) -> Option<Device> {
    match kind {
        DeviceKind::Cpu => Some(Device::flex()),
        #[cfg(feature = "wgpu")]
        DeviceKind::Wgpu => Device::enumerate(burn::tensor::DeviceType::Wgpu).into_vec().into_iter().next(),
        #[cfg(feature = "cuda")]
        DeviceKind::Cuda => Device::enumerate(burn::tensor::DeviceType::Cuda).into_vec().into_iter().next(),
        #[cfg(not(all(feature = "wgpu", feature = "cuda")))]
        _ => None,
    }
}

/// Makes a matrix of doubles on a device from its values, row by row.
///
/// It goes through `TensorData`, which keeps every digit; burn's literals go through single precision.
#[must_use]
pub fn tensor(values: Vec<f64>, [rows, columns]: [usize; 2], device: &Device) -> Tensor<2> {
    Tensor::from_data(TensorData::new(values, [rows, columns]), device)
}

/// Returns the values of a tensor, row by row, as doubles.
///
/// # Errors
/// [`FitError::Backend`] if the tensor does not hold floating-point numbers.
pub fn values<const D: usize>(tensor: Tensor<D>) -> Result<Vec<f64>, FitError> {
    let data = tensor.into_data();
    let data = if data.dtype() == DType::F32 { data.convert::<f64>() } else { data };
    data.try_to_vec::<f64>().map_err(|error| FitError::Backend { problem: format!("{error:?}") })
}

#[cfg(test)]
mod tests {
    use super::{DeviceKind, Precision, device, device_of};

    #[test]
    fn what_is_not_there_is_told_with_what_is() {
        for (kind, feature) in [(DeviceKind::Wgpu, "wgpu"), (DeviceKind::Cuda, "cuda")] {
            if kind.is_built() {
                continue;
            }
            let message = device_of(kind, Precision::F64).unwrap_err().to_string();
            assert!(message.contains("it has cpu") && message.contains(&format!("--features {feature}")));
        }
    }

    #[test]
    fn one_process_computes_in_one_precision() {
        device().unwrap();
        let message = device_of(DeviceKind::Cpu, Precision::F32).unwrap_err().to_string();
        assert!(message.contains("computes in f64 in this process, and f32 was asked for"), "{message}");
        assert!(device_of(DeviceKind::Cpu, Precision::F64).is_ok());
    }
}
