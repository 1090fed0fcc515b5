//! Arguments of the stepper from Python, read by attribute names: an argument must have every field of its struct
//! here.

use plants::python::{Cell, PyCircuit};
use pyo3::prelude::*;

/// A plant after its reset.
#[derive(FromPyObject)]
pub struct MachineRow<'py> {
    /// addresses of `mj_step1`, `mj_step2`, `mjb_makeBatch`, `mjb_deleteBatch`, `mjb_apply`, `mjb_error`
    pub functions: [usize; 6],
    pub empty: usize,
    pub model: usize,
    pub data: usize,
    pub timestep: f64,
    pub warnings: Bound<'py, PyAny>,
    pub sensing: Py<PyCircuit>,
    pub circuit: Py<PyCircuit>,
    pub readings: Vec<Py<Cell>>,
    pub commands: Vec<Py<Cell>>,
    pub truths: Vec<Py<Cell>>,
}

/// A function that transfers values between a controller and an array.
#[derive(FromPyObject)]
pub struct CallRow<'py> {
    pub function: usize,
    pub references: Bound<'py, PyAny>,
    pub values: Bound<'py, PyAny>,
}

/// An initialized controller.
#[derive(FromPyObject)]
pub struct ControllerRow<'py> {
    pub component: usize,
    pub set: Vec<CallRow<'py>>,
    pub step: usize,
    pub status: usize,
    pub get: Vec<CallRow<'py>>,
}

/// One value in an array; `kind` is `Real`, `Integer` or `Boolean`.
#[derive(FromPyObject)]
pub struct PlaceRow<'py> {
    pub array: Bound<'py, PyAny>,
    pub index: usize,
    pub kind: String,
}

/// Processing of a value on a wire.
#[derive(FromPyObject)]
pub struct ShapeRow<'py> {
    pub from_plant: bool,
    pub scale: f64,
    pub offset: f64,
    pub noise: Option<Bound<'py, PyAny>>,
    pub quantum: f64,
    pub minimum: f64,
    pub maximum: f64,
}

/// Delay in steps, and the values before the first step.
#[derive(FromPyObject)]
pub struct DelayRow {
    pub steps: usize,
    pub ring: Vec<f64>,
}

/// A wire.
#[derive(FromPyObject)]
pub struct LinkRow<'py> {
    pub source: PlaceRow<'py>,
    pub target: PlaceRow<'py>,
    pub shape: ShapeRow<'py>,
    pub delay: DelayRow,
}

/// A signal.
#[derive(FromPyObject)]
pub struct StimulusRow<'py> {
    pub samples: Bound<'py, PyAny>,
    pub target: PlaceRow<'py>,
}

/// An injection.
#[derive(FromPyObject)]
pub struct FaultRow<'py> {
    pub begin: PlaceRow<'py>,
    pub length: f64,
    pub change: FaultEffectRow<'py>,
    pub target: PlaceRow<'py>,
}

/// Effect of an injection; `kind` defines the meaning of the other fields.
#[derive(FromPyObject)]
pub struct FaultEffectRow<'py> {
    pub kind: String,
    pub number: f64,
    pub series: Option<Bound<'py, PyAny>>,
    pub delay: DelayRow,
}

/// A condition as in [`LogRow`], the steps from its row to the first step of an injection, and the location of that step.
#[derive(FromPyObject)]
pub struct TriggerRow<'py> {
    pub program: Vec<(String, f64)>,
    pub delay: f64,
    pub begin: PlaceRow<'py>,
}

/// All connections; `sensed` and `commands` are the arrays of the plant's side.
#[derive(FromPyObject)]
pub struct LinksRow<'py> {
    pub sensed: Bound<'py, PyAny>,
    pub commands: Bound<'py, PyAny>,
    pub readings: Vec<LinkRow<'py>>,
    pub stimuli: Vec<StimulusRow<'py>>,
    pub input_faults: Vec<FaultRow<'py>>,
    pub outputs: Vec<LinkRow<'py>>,
    pub command_faults: Vec<FaultRow<'py>>,
}

/// Table of the trace: time, then from column `start` on the banks and the ground truth, every few steps; `stop` is a
/// condition as postfix of (`column`, number), (`number`, value) and (name of numpy's function, 0).
#[derive(FromPyObject)]
pub struct LogRow<'py> {
    pub table: Bound<'py, PyAny>,
    pub start: usize,
    pub banks: Vec<Bound<'py, PyAny>>,
    pub every: usize,
    pub stop: Option<Vec<(String, f64)>>,
    pub triggers: Vec<TriggerRow<'py>>,
}
