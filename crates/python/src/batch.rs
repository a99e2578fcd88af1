//! Functions of Python that take arrays: what several threads ask at a time is one call.
//!
//! A thread puts its row into a list. The first one serves all: it takes the rows that are there, calls the function
//! once, leaves each its answer and wakes who waits for it, until no row is left (flat combining, Hendler et al. 2010).
//! Others come to their next row while the function runs, so that the length of arrays grows with that of threads.

use crate::faults;
use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyUntypedArrayMethods,
    ndarray::{Array1, Array2},
};
use pyo3::{
    exceptions::{PyRecursionError, PyRuntimeError, PyTypeError, PyValueError},
    prelude::*,
    sync::PyOnceLock,
    types::PyDict,
};
use rayon::prelude::*;
use std::{
    cell::Cell,
    fmt,
    sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError},
    thread::{self, Thread},
};
use steradian::bsdf::Inputs;

/// Most calls of functions by functions.
const MOST_NESTED: u32 = 16;

thread_local! {
    /// Calls of functions that this thread is in.
    static NESTED: Cell<u32> = const { Cell::new(0) };
}

/// True in a function of a material or texture. Rows of arrays are asked for by its own thread there: all others may
/// wait for its end.
pub fn is_inside() -> bool {
    NESTED.get() > 0
}

/// Refuses what takes threads of its own in a function of a material or texture, which they would wait for.
pub fn refuse_inside(what: &str) -> PyResult<()> {
    match is_inside() {
        true => Err(PyRuntimeError::new_err(format!("functions of materials and textures cannot {what}"))),
        false => Ok(()),
    }
}

/// A call of a function by this thread.
struct Inside;

impl Inside {
    fn begin() -> PyResult<Self> {
        if NESTED.get() >= MOST_NESTED {
            let why = format!("functions of materials and textures ask for themselves {MOST_NESTED} deep");
            return Err(PyRecursionError::new_err(why));
        }
        NESTED.set(NESTED.get() + 1);
        Ok(Self)
    }
}

impl Drop for Inside {
    fn drop(&mut self) {
        NESTED.set(NESTED.get() - 1);
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Arguments of a row.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Vectors of two or three numbers.
    pub vectors: [[f32; 3]; 2],
    /// Parameters of a material.
    pub at: Option<Inputs>,
}

#[derive(Debug)]
struct Slot {
    row: Row,
    answer: OnceLock<[f32; 4]>,
    /// Thread that waits for it.
    asker: Thread,
}

/// Rows without an answer, and true if a thread serves them.
#[derive(Debug, Default)]
struct Queue {
    pending: Vec<Arc<Slot>>,
    is_served: bool,
}

/// A function of arrays of vectors, and of the parameters of materials.
pub struct Batch {
    function: Py<PyAny>,
    /// Name of the model that it is of.
    model: &'static str,
    /// Name in messages.
    name: &'static str,
    /// Columns of the two arrays of vectors.
    columns: [usize; 2],
    /// Numbers of a row of its result that are allowed; 1 for a plain array.
    results: &'static [usize],
    /// Names of the colours and numbers that the parameters are.
    names: [Vec<&'static str>; 2],
    queue: Mutex<Queue>,
}

impl fmt::Debug for Batch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Batch").field("name", &self.name).finish_non_exhaustive()
    }
}

impl Batch {
    /// A function of a model, by its name in messages.
    pub fn new(
        function: Py<PyAny>,
        model: &'static str,
        name: &'static str,
        columns: [usize; 2],
        results: &'static [usize],
        names: [Vec<&'static str>; 2],
    ) -> Self {
        Self { function, model, name, columns, results, names, queue: Mutex::default() }
    }

    /// The function's value for a row, one number in all lanes; zero after a fault.
    pub fn ask(&self, row: Row) -> [f32; 4] {
        if faults::is_over(self.model) {
            return [0.0; 4];
        }
        // A function that asks for itself cannot wait for its own end.
        if is_inside() {
            return self.called(&[row])[0];
        }
        let slot = Arc::new(Slot { row, answer: OnceLock::new(), asker: thread::current() });
        let serves = {
            let mut queue = lock(&self.queue);
            queue.pending.push(Arc::clone(&slot));
            !std::mem::replace(&mut queue.is_served, true)
        };
        if serves {
            self.serve();
        }
        loop {
            match slot.answer.get() {
                Some(answer) => return *answer,
                None => thread::park(),
            }
        }
    }

    /// Answers all rows, those that come meanwhile, too.
    fn serve(&self) {
        loop {
            let all = {
                let mut queue = lock(&self.queue);
                if queue.pending.is_empty() {
                    queue.is_served = false;
                    break;
                }
                std::mem::take(&mut queue.pending)
            };
            let rows: Vec<Row> = all.iter().map(|slot| slot.row).collect();
            for (slot, answer) in all.iter().zip(self.called(&rows)) {
                // Nobody else answers.
                let _ = slot.answer.set(answer);
                slot.asker.unpark();
            }
            // Who was answered may ask again.
            thread::yield_now();
        }
    }

    fn called(&self, rows: &[Row]) -> Vec<[f32; 4]> {
        Python::attach(|py| {
            let answers = Inside::begin().and_then(|_inside| self.call(py, rows));
            answers.unwrap_or_else(|why| {
                faults::raise(py, self.model, &why);
                vec![[0.0; 4]; rows.len()]
            })
        })
    }

    fn call(&self, py: Python<'_>, rows: &[Row]) -> PyResult<Vec<[f32; 4]>> {
        let vectors = |k: usize| {
            let columns = self.columns[k];
            let data = rows.iter().flat_map(|row| row.vectors[k][..columns].to_vec()).collect();
            matrix(py, (rows.len(), columns), data)
        };
        let (a, b) = (vectors(0)?, vectors(1)?);
        let result = match self.parameters(py, rows)? {
            Some(at) => self.function.bind(py).call1((a, b, at))?,
            None => self.function.bind(py).call1((a, b))?,
        };
        self.answers(result, rows.len())
    }

    /// Colours, of four lanes each, and numbers by their names.
    fn parameters<'py>(&self, py: Python<'py>, rows: &[Row]) -> PyResult<Option<Bound<'py, PyDict>>> {
        let Some(at) = rows.iter().map(|row| row.at).collect::<Option<Vec<Inputs>>>() else { return Ok(None) };
        let all = PyDict::new(py);
        for (k, name) in self.names[0].iter().enumerate() {
            let data = at.iter().flat_map(|at| at.colors[k].to_array()).collect();
            all.set_item(name, matrix(py, (rows.len(), 4), data)?)?;
        }
        for (k, name) in self.names[1].iter().enumerate() {
            let numbers: Bound<'_, PyArray1<f32>> =
                Array1::from_iter(at.iter().map(|at| at.numbers[k])).into_pyarray(py);
            all.set_item(name, numbers)?;
        }
        Ok(Some(all))
    }

    /// The rows of a result, of single numbers in all lanes.
    fn answers(&self, result: Bound<'_, PyAny>, rows: usize) -> PyResult<Vec<[f32; 4]>> {
        let array = numbers(&result, self.name)?;
        let shape = array.shape();
        let columns = match *shape {
            [n] if n == rows => 1,
            [n, columns] if n == rows => columns,
            _ => 0,
        };
        if !self.results.contains(&columns) {
            let wanted = self.results.iter().map(|c| if *c == 1 { "(n,)".to_owned() } else { format!("(n, {c})") });
            let wanted = wanted.collect::<Vec<_>>().join(" or ");
            let what =
                format!("'{}' gave an array of shape {shape:?}, where {wanted} is needed, n = {rows}", self.name);
            return Err(PyValueError::new_err(what));
        }
        let data = array.to_vec()?;
        let lanes = |row: &[f32]| match *row {
            [v] => [v; 4],
            _ => std::array::from_fn(|lane| row.get(lane).copied().unwrap_or(0.0)),
        };
        Ok(data.chunks_exact(columns).map(lanes).collect())
    }
}

/// A result as a contiguous array of single precision. Single numbers and `None` are none, of one row, too.
pub fn numbers<'py>(result: &Bound<'py, PyAny>, name: &str) -> PyResult<Bound<'py, numpy::PyArrayDyn<f32>>> {
    static AS_ARRAY: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let py = result.py();
    let as_array = AS_ARRAY.import(py, "numpy", "asarray")?;
    // The order, casting (neither of complex numbers nor of objects), subclasses and copies of `astype`.
    let astype = ("float32", "C", "same_kind", false, false);
    let array = as_array
        .call1((result,))
        .and_then(|array| array.call_method1("astype", astype))
        .map_err(|e| PyTypeError::new_err(format!("'{name}' gave something that is no array of numbers: {e}")))?;
    array.cast_into::<numpy::PyArrayDyn<f32>>().map_err(PyErr::from)
}

/// An array of rows.
pub fn matrix(py: Python<'_>, shape: (usize, usize), data: Vec<f32>) -> PyResult<Bound<'_, PyArray2<f32>>> {
    let array = Array2::from_shape_vec(shape, data).map_err(|e| PyValueError::new_err(e.to_string()))?;
    Ok(array.into_pyarray(py))
}

/// Something for each of so many rows, by threads that take at least so many at a time; by this thread alone in a
/// function, for which others may wait.
pub fn each<T: Send>(py: Python<'_>, rows: usize, at_once: usize, of: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    let is_inside = is_inside();
    py.detach(|| match is_inside {
        true => (0..rows).map(of).collect(),
        false => (0..rows).into_par_iter().with_min_len(at_once).map(of).collect(),
    })
}
