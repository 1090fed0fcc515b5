//! Elements bound to places inside numpy arrays.
//!
//! All the unsafe code of the crate is here. A [`Cell`] keeps the buffer of its array exported, so the
//! memory it points at neither moves nor goes away while a [`Circuit`] uses it. A [`Circuit`] is what any
//! stepper calls once per plant step, from Python or from native code.

use std::ptr::NonNull;

use pyo3::buffer::PyBuffer;
use pyo3::exceptions::{PyFloatingPointError, PyIndexError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;

use crate::Element;

/// A place inside a numpy array that is read, set or added to.
///
/// Parameters
/// ----------
/// array : numpy.ndarray
///     C-contiguous float64 array; it stays alive and cannot be resized as long as the cell lives.
/// index : int
///     Flat index of the place, or of its first sample if `stride` is not zero.
/// scale, offset : float
///     Between the array and its user: reads `scale * array[i] + offset`, writes `scale * value + offset`.
/// stride : int
///     At plant step k the place is `index + k * stride`: 0 is a fixed place, 1 a signal (read only).
/// add : bool
///     Writes add to the place; a circuit starts such places at zero in every step.
///
/// Raises
/// ------
/// BufferError, ValueError
///     The array is not float64 or not C-contiguous.
/// IndexError
///     `index` is outside the array.
#[pyclass(frozen, module = "plants._native")]
pub(crate) struct Cell {
    pointer: NonNull<f64>,
    scale: f64,
    offset: f64,
    stride: usize,
    add: bool,
    /// plant steps for which there is a sample
    steps: usize,
    /// keeps the memory behind `pointer` exported
    buffer: PyBuffer<f64>,
}

// SAFETY: the memory behind `pointer` belongs to an exported buffer, which may be used from any thread.
unsafe impl Send for Cell {}
// SAFETY: numpy data has no lock of its own: as with any numpy array, the caller lets one thread at a time
// step a plant. Cells of different plants share no memory.
unsafe impl Sync for Cell {}

#[pymethods]
impl Cell {
    #[new]
    #[pyo3(signature = (array, index=0, *, scale=1.0, offset=0.0, stride=0, add=false))]
    fn new(
        array: &Bound<'_, PyAny>,
        index: usize,
        scale: f64,
        offset: f64,
        stride: usize,
        add: bool,
    ) -> PyResult<Self> {
        let buffer = PyBuffer::<f64>::get(array)?;
        let count = buffer.item_count();
        if !buffer.is_c_contiguous() {
            return Err(PyValueError::new_err("the array of a cell must be C-contiguous"));
        }
        if index >= count {
            return Err(PyIndexError::new_err(format!("cell index `{index}`, limit `{count}`")));
        }
        // SAFETY: `index` is inside the buffer, whose items are contiguous f64.
        let pointer = unsafe { buffer.buf_ptr().cast::<f64>().add(index) };
        let pointer = NonNull::new(pointer).expect("a buffer with items has an address");
        let steps = if stride == 0 { usize::MAX } else { (count - index).div_ceil(stride) };
        Ok(Self { pointer, scale, offset, stride, add, steps, buffer })
    }

    /// The value now.
    fn read(&self) -> f64 {
        self.sample(0)
    }

    /// Set the value, or add to it.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     The array is read-only, or the cell is a signal.
    fn write(&self, value: f64) -> PyResult<()> {
        self.check_writable()?;
        self.put(value);
        Ok(())
    }
}

impl Cell {
    fn check_writable(&self) -> PyResult<()> {
        if self.buffer.readonly() || self.stride != 0 {
            return Err(PyValueError::new_err("cannot write to a signal or to a read-only array"));
        }
        Ok(())
    }

    /// value at plant step `k`, which is less than `steps`
    fn sample(&self, k: usize) -> f64 {
        assert!(k < self.steps);
        // SAFETY: k < steps, so the address is inside the exported buffer.
        let value = unsafe { self.pointer.add(k * self.stride).read() };
        self.scale * value + self.offset
    }

    /// write to a place that `check_writable` has accepted
    fn put(&self, value: f64) {
        // SAFETY: a fixed place inside a writable exported buffer.
        unsafe {
            let before = if self.add { self.pointer.read() } else { 0.0 };
            self.pointer.write(before + (self.scale * value + self.offset));
        }
    }

    /// zero a place that `check_writable` has accepted
    fn clear(&self) {
        // SAFETY: as in `put`.
        unsafe { self.pointer.write(0.0) }
    }
}

/// An element that waits to be bound to a circuit.
#[pyclass(name = "Element", module = "plants._native")]
pub(crate) struct Unbound(Option<Box<dyn Element>>);

impl Unbound {
    /// Hand an element to Python.
    pub(crate) fn new(element: impl Element + 'static) -> Self {
        Self(Some(Box::new(element)))
    }
}

/// An element with its cells and room for its numbers.
struct Wired {
    name: String,
    element: Box<dyn Element>,
    inputs: Vec<Py<Cell>>,
    outputs: Vec<Py<Cell>>,
    read: Vec<f64>,
    written: Vec<f64>,
}

/// Elements in the order in which they act, bound to their cells.
#[pyclass(module = "plants._native")]
#[derive(Default)]
pub(crate) struct Circuit {
    elements: Vec<Wired>,
    /// plant steps since the reset
    k: usize,
}

/// Why a step could not be made.
enum StepError {
    /// a signal has no sample for this step
    Exhausted { element: String, input: &'static str, steps: usize },
    /// an input is NaN or infinite
    NotFinite { element: String, input: &'static str, value: f64 },
    /// the element says that the plant cannot go on
    Stopped { element: String, cause: String },
}

impl From<StepError> for PyErr {
    fn from(error: StepError) -> Self {
        match error {
            StepError::Exhausted { element, input, steps } => {
                PyIndexError::new_err(format!("element `{element}`: input `{input}` ends after `{steps}` plant steps"))
            }
            StepError::NotFinite { element, input, value } => {
                PyFloatingPointError::new_err(format!("element `{element}`: input `{input}` is `{value}`"))
            }
            StepError::Stopped { element, cause } => PyRuntimeError::new_err(format!("element `{element}`: {cause}")),
        }
    }
}

impl Circuit {
    /// One plant step of `h` seconds; needs no Python.
    fn advance(&mut self, h: f64) -> Result<(), StepError> {
        let outputs = self.elements.iter().flat_map(|bound| &bound.outputs);
        outputs.map(Py::get).filter(|cell| cell.add).for_each(Cell::clear);
        for bound in &mut self.elements {
            bound.step(self.k, h)?;
        }
        self.k += 1;
        Ok(())
    }
}

impl Wired {
    fn step(&mut self, k: usize, h: f64) -> Result<(), StepError> {
        for (port, cell) in self.inputs.iter().map(Py::get).enumerate() {
            let input = || (self.name.clone(), self.element.ports().inputs[port]);
            if k >= cell.steps {
                let (element, input) = input();
                return Err(StepError::Exhausted { element, input, steps: cell.steps });
            }
            let value = cell.sample(k);
            if !value.is_finite() {
                let (element, input) = input();
                return Err(StepError::NotFinite { element, input, value });
            }
            self.read[port] = value;
        }
        self.element.step(&self.read, &mut self.written, h);
        for (cell, value) in self.outputs.iter().zip(&self.written) {
            cell.get().put(*value);
        }
        match self.element.stop() {
            Some(cause) => Err(StepError::Stopped { element: self.name.clone(), cause }),
            None => Ok(()),
        }
    }
}

#[pymethods]
impl Circuit {
    /// An empty circuit.
    #[new]
    fn new() -> Self {
        Self::default()
    }

    /// Append an element and tie its inputs and outputs, in the order of its ports, to cells.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     A wrong number of cells, an element that is bound already, or an output that cannot be written.
    fn bind(
        &mut self,
        name: String,
        mut element: PyRefMut<'_, Unbound>,
        inputs: Vec<Py<Cell>>,
        outputs: Vec<Py<Cell>>,
    ) -> PyResult<()> {
        let Some(ports) = element.0.as_ref().map(|element| element.ports()) else {
            return Err(PyValueError::new_err(format!("element `{name}` is bound already")));
        };
        for (cells, wanted) in [(&inputs, ports.inputs), (&outputs, ports.outputs)] {
            if cells.len() != wanted.len() {
                let count = cells.len();
                let message = format!("element `{name}`: `{count}` cells for the ports {wanted:?}");
                return Err(PyValueError::new_err(message));
            }
        }
        outputs.iter().try_for_each(|cell| cell.get().check_writable())?;
        let (read, written) = (vec![0.0; inputs.len()], vec![0.0; outputs.len()]);
        if let Some(element) = element.0.take() {
            self.elements.push(Wired { name, element, inputs, outputs, read, written });
        }
        Ok(())
    }

    /// Back to time zero.
    fn reset(&mut self) {
        self.k = 0;
        for bound in &mut self.elements {
            bound.element.reset();
        }
    }

    /// One plant step of `h` seconds: every element in order.
    ///
    /// Raises
    /// ------
    /// FloatingPointError
    ///     An input is NaN or infinite.
    /// IndexError
    ///     A signal has no sample for this step.
    /// RuntimeError
    ///     An element says that the plant cannot go on.
    fn step(&mut self, h: f64) -> PyResult<()> {
        Ok(self.advance(h)?)
    }
}
