//! The class `Stepper`.

use plants::python::{Cell, PyCircuit};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;

use super::build;
use super::rows::{LinksRow, LogRow, MachineRow};
use crate::failure::Failure;
use crate::ffi::{Exports, trap};
use crate::stepper::{End, Stepper};

/// A closed loop of a plant and a controller in native code.
///
/// It is bit-identical to the reference engine. The arguments are read once, by their attributes.
///
/// Parameters
/// ----------
/// machine : plants.base.machine.Machine
///     The plant, after its reset.
/// controller : object or None
///     Addresses of an initialized FMU; None runs the plant alone.
/// links : object
///     Wires, signals and injections; `sensed` holds the measurements at time zero.
/// log : object or None
///     Table of the trace.
/// step : float
///     Communication step, s.
/// substeps : int
///     Plant steps per communication step.
///
/// Raises
/// ------
/// ValueError, BufferError, AttributeError
///     An array, an address or an attribute is invalid.
#[pyclass(name = "Stepper", module = "machining_native")]
pub struct PyStepper {
    stepper: Stepper,
    sensing: Py<PyCircuit>,
    circuit: Py<PyCircuit>,
    /// keep every address valid
    _exports: Exports,
    _cells: Vec<Py<Cell>>,
    _owners: Vec<Py<PyAny>>,
}

#[pymethods]
impl PyStepper {
    #[new]
    fn new(
        machine: &Bound<'_, PyAny>,
        controller: Option<&Bound<'_, PyAny>>,
        links: LinksRow,
        log: Option<LogRow>,
        step: f64,
        substeps: usize,
    ) -> PyResult<Self> {
        let mut exports = Exports::default();
        let mut owners = vec![machine.clone().unbind()];
        owners.extend(controller.map(|owner| owner.clone().unbind()));
        let row: MachineRow = machine.extract()?;
        let trap = trap(&row)?;
        let body = build::machine(&mut exports, &row, substeps)?;
        let controller = controller.map(|row| exports.controller(&row.extract()?)).transpose()?;
        let links = build::links(&mut exports, links)?;
        if (links.sensed.len(), links.commands.len()) != (body.readings.len(), body.commands.len()) {
            return Err(PyValueError::new_err("measurements or commands without a location"));
        }
        let log = log.map(|row| build::log(&mut exports, &row, body.truths.len())).transpose()?;
        let stepper = Stepper::new(body, controller, links, log, step, trap);
        let cells = row.readings.into_iter().chain(row.commands).chain(row.truths).collect();
        Ok(Self {
            stepper,
            sensing: row.sensing,
            circuit: row.circuit,
            _exports: exports,
            _cells: cells,
            _owners: owners,
        })
    }

    /// Completed steps; the number of a failed step.
    #[getter]
    fn k(&self) -> usize {
        self.stepper.steps()
    }

    /// Number of the first call of the controller that returned a warning, and its time in s.
    #[getter]
    fn warned(&self) -> Option<(usize, f64)> {
        self.stepper.warned()
    }

    /// Run until `until` steps are done, without the GIL.
    ///
    /// Returns
    /// -------
    /// (str, int, float) or None
    ///     Kind, number and value of the cause of the end: `warning`, `sensed` and `command` are the plant's,
    ///     `reading` and `output` are wire numbers, `integer` is a value beyond 32 bits, `call` is a function
    ///     of the controller by number (set, doStep, get) with its status. The loop cannot continue then. After the
    ///     step, `stop` is the condition of the log, and `terminated` the controller that ends the run.
    ///
    /// Raises
    /// ------
    /// FloatingPointError, IndexError, RuntimeError
    ///     As `Circuit.step`; RuntimeError is also an error of MuJoCo.
    fn run(&mut self, py: Python<'_>, until: usize) -> PyResult<Option<(&'static str, usize, f64)>> {
        let (mut sensing, mut circuit) = (self.sensing.try_borrow_mut(py)?, self.circuit.try_borrow_mut(py)?);
        let (sensing, circuit, stepper) = (sensing.circuit(), circuit.circuit(), &mut self.stepper);
        match py.detach(|| stepper.run(sensing, circuit, until)) {
            Ok(None) => Ok(None),
            Ok(Some(End::Stopped)) => Ok(Some(("stop", 0, 0.0))),
            Ok(Some(End::Terminated)) => Ok(Some(("terminated", 0, 0.0))),
            Err(Failure::Element(error)) => Err(error.into()),
            Err(Failure::MuJoCo(words)) => Err(PyRuntimeError::new_err(words)),
            Err(Failure::Warning) => Ok(Some(("warning", 0, 0.0))),
            Err(Failure::Sensed) => Ok(Some(("sensed", 0, 0.0))),
            Err(Failure::Command) => Ok(Some(("command", 0, 0.0))),
            Err(Failure::Reading { wire, value }) => Ok(Some(("reading", wire, value))),
            Err(Failure::Output { wire, value }) => Ok(Some(("output", wire, value))),
            Err(Failure::Integer(value)) => Ok(Some(("integer", 0, value))),
            Err(Failure::Call { call, status }) => Ok(Some(("call", call, f64::from(status)))),
        }
    }
}
