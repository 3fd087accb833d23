//! Models as files: safetensors with a description in the header.

use crate::LearnError;
use safetensors::tensor::{Dtype, TensorView};
use safetensors::{SafeTensors, serialize};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

/// Key of the description in the header.
const KEY: &str = "ringdown";

/// Name of the tensor with draws of the weights, in files of laws and torques.
pub(crate) const DRAWS: &str = "draws";

/// Array of numbers with a shape, row-major.
#[derive(Debug, Clone, PartialEq)]
pub struct Tensor {
    /// Name of the tensor within the file.
    pub name: String,
    /// Lengths of the axes.
    pub shape: Vec<usize>,
    /// The numbers, row-major.
    pub values: Vec<f64>,
}

/// Model as stored in a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Stored {
    /// Identifier of the learner that made the model.
    pub learner: String,
    /// Everything that is not a weight, as JSON.
    pub description: serde_json::Value,
    /// Caller's information about the training, as JSON.
    pub about: serde_json::Value,
    /// Weights.
    pub tensors: Vec<Tensor>,
}

#[derive(Serialize, Deserialize)]
struct Header {
    learner: String,
    description: serde_json::Value,
    about: serde_json::Value,
}

fn refused(problem: impl Into<String>) -> LearnError {
    LearnError::Stored { problem: problem.into() }
}

impl Stored {
    /// Combines a model's tensors with its description.
    ///
    /// # Errors
    /// [`LearnError::Stored`] for a description that cannot be written as JSON.
    pub fn new(
        learner: &str,
        description: &impl Serialize,
        tensors: Vec<Tensor>,
    ) -> Result<Self, LearnError> {
        let description = serde_json::to_value(description).map_err(|error| refused(error.to_string()))?;
        let about = serde_json::Value::Null;
        Ok(Self { learner: learner.to_owned(), description, about, tensors })
    }

    /// Returns the same model with the caller's information about its training.
    #[must_use]
    pub fn about(self, about: serde_json::Value) -> Self {
        Self { about, ..self }
    }

    /// Reads the caller's information about the training.
    ///
    /// # Errors
    /// [`LearnError::Stored`] if it has another form.
    pub fn about_as<T: DeserializeOwned>(&self) -> Result<T, LearnError> {
        serde_json::from_value(self.about.clone())
            .map_err(|error| refused(format!("its description of the training has another form: {error}")))
    }

    /// Returns the same model with everything that was learned set to zero: zero weights, and no draws of
    /// them.
    ///
    /// A sequence model then is the linear prediction that it corrects, a torque is the nominal simulator,
    /// and a law is uniform motion without any term.
    #[must_use]
    pub fn at_zero(&self) -> Self {
        let zero = |tensor: &Tensor| match tensor.name == DRAWS {
            true => Tensor {
                shape: vec![0, tensor.shape.last().copied().unwrap_or(1)],
                values: Vec::new(),
                ..tensor.clone()
            },
            false => Tensor { values: vec![0.0; tensor.values.len()], ..tensor.clone() },
        };
        Self { tensors: self.tensors.iter().map(zero).collect(), ..self.clone() }
    }

    /// Reads the description.
    ///
    /// # Errors
    /// [`LearnError::Stored`] if it has another form.
    pub fn described<T: DeserializeOwned>(&self) -> Result<T, LearnError> {
        serde_json::from_value(self.description.clone()).map_err(|error| {
            refused(format!("the description of {} has another form: {error}", self.learner))
        })
    }

    /// Returns the tensor with a name.
    ///
    /// # Errors
    /// [`LearnError::Stored`] if there is none with this name.
    pub fn tensor(&self, name: &str) -> Result<&Tensor, LearnError> {
        let found = self.tensors.iter().find(|tensor| tensor.name == name);
        found.ok_or_else(|| refused(format!("there is no tensor `{name}`")))
    }

    /// Serializes the model to the bytes of a file.
    ///
    /// # Errors
    /// [`LearnError::Stored`] for tensors whose shape does not match their number of values.
    pub fn to_bytes(&self) -> Result<Vec<u8>, LearnError> {
        let header = Header {
            learner: self.learner.clone(),
            description: self.description.clone(),
            about: self.about.clone(),
        };
        let header = serde_json::to_string(&header).map_err(|error| refused(error.to_string()))?;
        let bytes: Vec<Vec<u8>> = self
            .tensors
            .iter()
            .map(|tensor| tensor.values.iter().flat_map(|value| value.to_le_bytes()).collect())
            .collect();
        let views = self.tensors.iter().zip(&bytes).map(|(tensor, bytes)| {
            TensorView::new(Dtype::F64, tensor.shape.clone(), bytes).map(|view| (tensor.name.clone(), view))
        });
        let views = views.collect::<Result<Vec<_>, _>>().map_err(|error| refused(error.to_string()))?;
        serialize(views, Some(HashMap::from([(KEY.to_owned(), header)])))
            .map_err(|error| refused(error.to_string()))
    }

    /// Reads a model from the bytes of a file.
    ///
    /// # Errors
    /// [`LearnError::Stored`] if the bytes are something else.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, LearnError> {
        let not =
            |error: safetensors::SafeTensorError| refused(format!("it is no safetensors file: {error}"));
        let (_, metadata) = SafeTensors::read_metadata(bytes).map_err(not)?;
        let header = metadata.metadata().as_ref().and_then(|header| header.get(KEY));
        let header = header.ok_or_else(|| refused("the file's header names no learner"))?;
        let header: Header = serde_json::from_str(header).map_err(|error| refused(error.to_string()))?;
        let file = SafeTensors::deserialize(bytes).map_err(not)?;
        let mut tensors = Vec::new();
        for (name, view) in file.tensors() {
            if view.dtype() != Dtype::F64 {
                return Err(refused(format!("tensor `{name}` is not of doubles")));
            }
            let eights = view.data().as_chunks::<8>().0.iter();
            let values = eights.map(|bytes| f64::from_le_bytes(*bytes)).collect();
            tensors.push(Tensor { name, shape: view.shape().to_vec(), values });
        }
        tensors.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(Self { learner: header.learner, description: header.description, about: header.about, tensors })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_survives_its_file_to_the_bit() {
        let tensor = Tensor { name: "w".to_owned(), shape: vec![2, 1], values: vec![0.1, -1e-300] };
        let stored = Stored::new("sindy", &serde_json::json!({ "step": 0.1 }), vec![tensor]).unwrap();
        assert_eq!(Stored::from_bytes(&stored.to_bytes().unwrap()).unwrap(), stored);
    }

    #[test]
    fn a_file_of_something_else_is_refused_with_a_remedy() {
        let error = Stored::from_bytes(b"time,angle\n0,1\n").unwrap_err().to_string();
        assert!(error.contains("no safetensors file") && error.contains("task = \"learn\""), "{error}");
    }
}
