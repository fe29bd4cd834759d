//! Arrays of a result: values by rows, with a type and a shape, that become NumPy arrays in Python.

use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyDict, PyTuple};

/// Values of one type, row after row.
#[derive(Debug)]
pub enum Values {
    /// Numbers; NaN where a value is not known.
    Float(Vec<f64>),
    /// Numbers of ticks.
    Tick(Vec<u32>),
    /// True or false.
    Bool(Vec<bool>),
}

/// Arrays with their names.
#[derive(Debug, Default)]
pub struct Arrays(Vec<(String, Values, Vec<usize>)>);

impl Arrays {
    /// Adds an array; `row` is the shape of one row.
    pub fn add(&mut self, name: impl Into<String>, values: Values, row: &[usize]) {
        self.0.push((name.into(), values, row.to_vec()));
    }

    /// A dictionary: name → (bytes, type by NumPy's letters, shape of a row).
    ///
    /// # Errors
    /// Python's, when memory is short.
    pub fn into_dict(self, py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        let dict = PyDict::new(py);
        for (name, values, row) in self.0 {
            let row = PyTuple::new(py, row)?;
            dict.set_item(name, (values.bytes(py)?, values.dtype(), row))?;
        }
        Ok(dict)
    }
}

impl Values {
    /// NumPy's letters for the type, in the order of this machine's bytes.
    const fn dtype(&self) -> &'static str {
        match self {
            Self::Float(_) => "f8",
            Self::Tick(_) => "u4",
            Self::Bool(_) => "?",
        }
    }

    fn bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyByteArray>> {
        match self {
            Self::Float(values) => filled(py, values, f64::to_ne_bytes),
            Self::Tick(values) => filled(py, values, u32::to_ne_bytes),
            Self::Bool(values) => filled(py, values, |value| [u8::from(value)]),
        }
    }
}

fn filled<'py, T: Copy, const N: usize>(
    py: Python<'py>,
    values: &[T],
    bytes: impl Fn(T) -> [u8; N],
) -> PyResult<Bound<'py, PyByteArray>> {
    PyByteArray::new_with(py, values.len() * N, |buffer| {
        let (places, _) = buffer.as_chunks_mut::<N>();
        places.iter_mut().zip(values).for_each(|(place, value)| *place = bytes(*value));
        Ok(())
    })
}

/// The numbers of an array of type `f8`.
pub fn floats(bytes: &[u8]) -> Vec<f64> {
    let (numbers, _) = bytes.as_chunks();
    numbers.iter().map(|number| f64::from_ne_bytes(*number)).collect()
}
