//! Keys of a scene from a dictionary.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyString};
use toml::{Table, Value};

/// The keys as text in TOML.
///
/// # Errors
/// `TypeError` that names the key of a value that is none of TOML.
pub(crate) fn text(keys: &Bound<'_, PyDict>) -> PyResult<String> {
    let table = table(keys, "")?;
    toml::to_string(&table).map_err(|error| PyTypeError::new_err(error.to_string()))
}

fn table(keys: &Bound<'_, PyDict>, path: &str) -> PyResult<Table> {
    let mut found = Table::new();
    for (key, item) in keys.iter() {
        let name = key.cast::<PyString>().map_err(|_| {
            PyTypeError::new_err(format!("the key {key} of '{path}' is not a string"))
        })?;
        let name = name.to_string();
        let path = match path {
            "" => name.clone(),
            path => format!("{path}.{name}"),
        };
        // A key of no value is one that is not given.
        if !item.is_none() {
            found.insert(name, value(&item, &path)?);
        }
    }
    Ok(found)
}

fn value(item: &Bound<'_, PyAny>, path: &str) -> PyResult<Value> {
    if let Ok(keys) = item.cast::<PyDict>() {
        return Ok(Value::Table(table(keys, path)?));
    }
    if item.is_instance_of::<PyBool>() {
        return Ok(Value::Boolean(item.extract()?));
    }
    if item.is_instance_of::<PyInt>() {
        return Ok(Value::Integer(item.extract()?));
    }
    if item.is_instance_of::<PyFloat>() {
        return Ok(Value::Float(item.extract()?));
    }
    if item.is_instance_of::<PyString>() {
        return Ok(Value::String(item.extract()?));
    }
    // Numbers of NumPy, and paths.
    if item.hasattr("item")? && item.getattr("ndim").is_ok_and(|n| n.eq(0).unwrap_or(false)) {
        return value(&item.call_method0("item")?, path);
    }
    if item.hasattr("__fspath__")? {
        return value(&item.call_method0("__fspath__")?, path);
    }
    if item.hasattr("tolist")? {
        return value(&item.call_method0("tolist")?, path);
    }
    if let Ok(entries) = item.try_iter() {
        let entries = entries.enumerate();
        let entries = entries.map(|(index, entry)| value(&entry?, &format!("{path}[{index}]")));
        return Ok(Value::Array(entries.collect::<PyResult<_>>()?));
    }
    let kind = item.get_type().name()?;
    Err(PyTypeError::new_err(format!(
        "the value of '{path}' is of type {kind}: expected a number, a string, a list, a dictionary or a path"
    )))
}
