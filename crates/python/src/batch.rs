//! Functions of Python that take arrays: what several threads ask at a time is one call.
//!
//! A thread puts its row into a list. The first one serves all: it takes the rows that are there, calls the function
//! once, leaves each its answer and wakes who waits for it, until no row is left (flat combining, Hendler et al. 2010).
//! Others come to their next row while the function runs, so that the length of arrays grows with that of threads.

use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyUntypedArrayMethods,
    ndarray::{Array1, Array2},
};
use pyo3::{
    exceptions::{PyTypeError, PyValueError},
    prelude::*,
    sync::PyOnceLock,
    types::PyDict,
};
use std::{
    cell::Cell,
    fmt,
    sync::{
        Arc, Mutex, MutexGuard, OnceLock, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, Thread},
};
use steradian::bsdf::Inputs;

/// Exception that a function raised, until somebody takes it.
static FAULT: Mutex<Option<PyErr>> = Mutex::new(None);
static HAS_FAULT: AtomicBool = AtomicBool::new(false);

thread_local! {
    /// True while this thread calls a function.
    static CALLS: Cell<bool> = const { Cell::new(false) };
}

/// Result of renders and measurements: the exception of a function, if one raised.
pub fn fault() -> PyResult<()> {
    HAS_FAULT.store(false, Ordering::Relaxed);
    lock(&FAULT).take().map_or(Ok(()), Err)
}

/// True if a function raised an exception that nobody has taken.
pub fn has_fault() -> bool {
    HAS_FAULT.load(Ordering::Relaxed)
}

/// Keeps the first exception.
pub fn raise(why: PyErr) {
    lock(&FAULT).get_or_insert(why);
    HAS_FAULT.store(true, Ordering::Relaxed);
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
    /// A function by its name in messages.
    pub fn new(
        function: Py<PyAny>,
        name: &'static str,
        columns: [usize; 2],
        results: &'static [usize],
        names: [Vec<&'static str>; 2],
    ) -> Self {
        Self { function, name, columns, results, names, queue: Mutex::default() }
    }

    /// The function's value for a row, one number in all lanes; zero after a fault.
    pub fn ask(&self, row: Row) -> [f32; 4] {
        if has_fault() {
            return [0.0; 4];
        }
        // A function that asks for itself cannot wait for its own end.
        if CALLS.get() {
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
        CALLS.set(true);
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
        CALLS.set(false);
    }

    fn called(&self, rows: &[Row]) -> Vec<[f32; 4]> {
        Python::attach(|py| self.call(py, rows)).unwrap_or_else(|why| {
            raise(why);
            vec![[0.0; 4]; rows.len()]
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

/// A result as a contiguous array of single precision.
pub fn numbers<'py>(result: &Bound<'py, PyAny>, name: &str) -> PyResult<Bound<'py, numpy::PyArrayDyn<f32>>> {
    static AS_ARRAY: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let py = result.py();
    let as_array = AS_ARRAY.import(py, "numpy", "ascontiguousarray")?;
    let array = as_array
        .call1((result, "float32"))
        .map_err(|e| PyTypeError::new_err(format!("'{name}' gave something that is no array of numbers: {e}")))?;
    array.cast_into::<numpy::PyArrayDyn<f32>>().map_err(PyErr::from)
}

/// An array of rows.
pub fn matrix(py: Python<'_>, shape: (usize, usize), data: Vec<f32>) -> PyResult<Bound<'_, PyArray2<f32>>> {
    let array = Array2::from_shape_vec(shape, data).map_err(|e| PyValueError::new_err(e.to_string()))?;
    Ok(array.into_pyarray(py))
}
