//! NumPy arrays that are handed out: written by nobody.

use numpy::ndarray::{Array2, ArrayBase, Dim, OwnedRepr};
use numpy::{Element, IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use powerhouse::model::{Stress, Vec3};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// An array of numbers, whose memory is that of the list.
pub(crate) fn of_list<T: Element>(py: Python<'_>, values: Vec<T>) -> Bound<'_, PyArray1<T>> {
    let array = values.into_pyarray(py);
    array.readwrite().make_nonwriteable();
    array
}

/// An array with rows of `width` numbers, whose memory is that of the list.
///
/// # Errors
/// A list that is not whole rows.
pub(crate) fn of_rows<T: Element>(
    py: Python<'_>,
    values: Vec<T>,
    width: usize,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let shape = (values.len() / width.max(1), width);
    let rows: ArrayBase<OwnedRepr<T>, Dim<[usize; 2]>> = Array2::from_shape_vec(shape, values)
        .map_err(|error| PyValueError::new_err(error.to_string()))?;
    let array = rows.into_pyarray(py);
    array.readwrite().make_nonwriteable();
    Ok(array)
}

/// The components of vectors, those of one after those of the other.
pub(crate) fn components(vectors: impl IntoIterator<Item = Vec3>) -> Vec<f64> {
    let components = vectors.into_iter().flat_map(|v| [v.x, v.y, v.z]);
    components.collect()
}

/// The components of stresses (xx, yy, zz, xy, yz, zx), those of one after those of the other.
pub(crate) fn stresses(stresses: &[Stress]) -> Vec<f64> {
    stresses.iter().flat_map(|stress| stress.0).collect()
}
