//! Weights to and from safetensors files.

use estimator::FitError;
use safetensors::tensor::{Dtype, SafeTensors, TensorView, serialize};

/// Named tensor of doubles.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedTensor {
    /// Name, such as `layers.0.weight`.
    pub name: String,
    /// Lengths of the axes.
    pub shape: Vec<usize>,
    /// Values; the last axis varies fastest.
    pub values: Vec<f64>,
}

/// Serializes tensors to the bytes of a safetensors file of type F64.
///
/// # Errors
/// [`FitError::Backend`] if a shape does not match its values or a name repeats.
pub fn to_safetensors(tensors: &[NamedTensor]) -> Result<Vec<u8>, FitError> {
    let refused = |error| FitError::Backend { problem: format!("safetensors: {error}") };
    let bytes: Vec<Vec<u8>> = tensors
        .iter()
        .map(|tensor| tensor.values.iter().flat_map(|value| value.to_le_bytes()).collect())
        .collect();
    let mut views = Vec::new();
    for (tensor, bytes) in tensors.iter().zip(&bytes) {
        let view = TensorView::new(Dtype::F64, tensor.shape.clone(), bytes).map_err(refused)?;
        views.push((tensor.name.as_str(), view));
    }
    serialize(views, None).map_err(refused)
}

/// Reads the tensors of a safetensors file that [`to_safetensors`] wrote, sorted by name.
///
/// # Errors
/// [`FitError::Backend`] if the bytes are no such file or hold another type than F64.
pub fn from_safetensors(bytes: &[u8]) -> Result<Vec<NamedTensor>, FitError> {
    let refused = |problem: String| FitError::Backend { problem: format!("safetensors: {problem}") };
    let file = SafeTensors::deserialize(bytes).map_err(|error| refused(error.to_string()))?;
    let mut tensors = Vec::new();
    for (name, view) in file.tensors() {
        if view.dtype() != Dtype::F64 {
            return Err(refused(format!("`{name}` holds {:?}, expected F64", view.dtype())));
        }
        let (words, _) = view.data().as_chunks::<8>();
        tensors.push(NamedTensor {
            name,
            shape: view.shape().to_vec(),
            values: words.iter().map(|word| f64::from_le_bytes(*word)).collect(),
        });
    }
    tensors.sort_by(|one, other| one.name.cmp(&other.name));
    Ok(tensors)
}

#[cfg(test)]
mod tests {
    use super::{FitError, NamedTensor, from_safetensors, to_safetensors};

    #[test]
    fn every_bit_comes_back() {
        let tensors = [
            NamedTensor { name: "a".into(), shape: vec![2, 1], values: vec![0.1, -1e-300] },
            NamedTensor { name: "b".into(), shape: vec![1], values: vec![f64::MIN_POSITIVE] },
        ];
        assert_eq!(from_safetensors(&to_safetensors(&tensors).unwrap()).unwrap(), tensors);
    }

    #[test]
    fn garbage_is_refused() {
        let shape = NamedTensor { name: "a".into(), shape: vec![3], values: vec![1.0] };
        for refused in [from_safetensors(b"no such file").map(|_| ()), to_safetensors(&[shape]).map(|_| ())] {
            let refused = refused.unwrap_err();
            assert!(
                matches!(&refused, FitError::Backend { problem } if problem.starts_with("safetensors: ")),
                "{refused}"
            );
        }
    }
}
