//! Elements bound to locations in numpy arrays.
//!
//! A [`Cell`] keeps the buffer of its array exported, so that its memory is neither moved nor freed
//! while a [`Circuit`] uses it.

use std::ptr::NonNull;

use pyo3::buffer::PyBuffer;
use pyo3::exceptions::{PyFloatingPointError, PyIndexError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;

use crate::circuit::{Circuit, StepError};
use crate::element::Element;
use crate::place::Place;

/// A location in a numpy array that is read, set or added to.
///
/// Parameters
/// ----------
/// array : numpy.ndarray
///     C-contiguous float64 array; it stays alive and cannot be resized while the cell exists.
/// index : int
///     Flat index of the location, or of its first sample if `stride` is not zero.
/// scale, offset : float
///     Between the array and its user: reads `scale * array[i] + offset`, writes `scale * value + offset`.
/// stride : int
///     At plant step k the location is `index + k * stride`: 0 is a fixed location, 1 a signal (read only).
/// add : bool
///     Writes add to the location; a circuit starts such locations at zero in every step.
///
/// Raises
/// ------
/// BufferError, ValueError
///     The array is not float64 or not C-contiguous.
/// IndexError
///     `index` is outside the array.
#[pyclass(frozen, module = "machining_native")]
pub struct Cell {
    place: Place,
    /// keeps the memory exported
    buffer: PyBuffer<f64>,
}

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
        // SAFETY: the block is exported while the cell exists. numpy data has no lock of its own: as with any numpy
        // array, the caller lets one thread at a time step a plant, and cells of different plants share no memory.
        let place = unsafe { Place::new(pointer, count - index, (scale, offset), stride, add) };
        Ok(Self { place, buffer })
    }

    /// The value now.
    fn read(&self) -> f64 {
        self.place.sample(0)
    }

    /// Set the value, or add to it.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     The array is read-only, or the cell is a signal.
    fn write(&self, value: f64) -> PyResult<()> {
        self.check_writable()?;
        self.place.put(value);
        Ok(())
    }
}

impl Cell {
    /// The location; its memory stays where it is while the cell exists.
    pub fn place(&self) -> Place {
        self.place
    }

    /// Checks that the location can be written.
    ///
    /// # Errors
    /// `ValueError` for a signal or a read-only array.
    pub fn check_writable(&self) -> PyResult<()> {
        if self.buffer.readonly() || self.place.is_signal() {
            return Err(PyValueError::new_err("cannot write to a signal or to a read-only array"));
        }
        Ok(())
    }
}

/// An element that is not yet bound to a circuit.
#[pyclass(name = "Element", module = "machining_native")]
pub struct PyElement(Option<Box<dyn Element>>);

impl PyElement {
    /// Convert an element to Python.
    pub(super) fn new(element: impl Element + 'static) -> Self {
        Self(Some(Box::new(element)))
    }
}

/// Elements in the order in which they act, bound to their cells.
#[pyclass(name = "Circuit", module = "machining_native")]
#[derive(Default)]
pub struct PyCircuit {
    circuit: Circuit,
    /// keep the memory of the circuit exported
    cells: Vec<Py<Cell>>,
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

impl PyCircuit {
    /// The circuit for native code.
    pub fn circuit(&mut self) -> &mut Circuit {
        &mut self.circuit
    }
}

#[pymethods]
impl PyCircuit {
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
        mut element: PyRefMut<'_, PyElement>,
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
        if let Some(element) = element.0.take() {
            let places = |cells: &[Py<Cell>]| cells.iter().map(|cell| cell.get().place()).collect();
            self.circuit.bind(name, element, places(&inputs), places(&outputs));
            self.cells.extend(inputs.into_iter().chain(outputs));
        }
        Ok(())
    }

    /// Back to time zero.
    fn reset(&mut self) {
        self.circuit.reset();
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
    ///     An element reports that the plant cannot continue.
    fn step(&mut self, h: f64) -> PyResult<()> {
        Ok(self.circuit.step(h)?)
    }
}
