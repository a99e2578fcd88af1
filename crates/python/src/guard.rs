//! Nothing that was read is written over, unless that is asked for.

use pyo3::{exceptions::PyFileExistsError, prelude::*};
use std::path::Path;
use steradian::Inputs;

/// Refuses an output that is one of the files that were read, whatever it is called.
pub fn claim<'a>(output: &Path, read: impl IntoIterator<Item = &'a Path>) -> PyResult<()> {
    match Inputs::of(read).find(output) {
        None => Ok(()),
        Some(input) => Err(PyFileExistsError::new_err(format!(
            "'{}' is a file that is read here ('{}') and would be overwritten; give another name, or overwrite=True",
            output.display(),
            input.display()
        ))),
    }
}
