//! An instance as the C API sees it, whatever its model.

use crate::host::phase::{Function, Phase, Status};
use crate::instance::states::TakenState;
use std::ffi::CStr;

/// An instance as the C API sees it. Every method returns a status and reports the reason.
pub trait Slave: Send {
    /// fmi2SetDebugLogging
    fn set_debug_logging(&mut self, on: bool, categories: &[&str]) -> Status;
    /// fmi2SetupExperiment
    fn setup_experiment(&mut self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> Status;
    /// fmi2EnterInitializationMode
    fn enter_initialization_mode(&mut self) -> Status;
    /// fmi2ExitInitializationMode
    fn exit_initialization_mode(&mut self) -> Status;
    /// fmi2Terminate
    fn terminate(&mut self) -> Status;
    /// fmi2Reset
    fn reset(&mut self) -> Status;
    /// fmi2GetReal
    fn get_real(&mut self, references: &[u32], values: &mut [f64]) -> Status;
    /// fmi2GetInteger
    fn get_integer(&mut self, references: &[u32], values: &mut [i32]) -> Status;
    /// fmi2GetBoolean
    fn get_boolean(&mut self, references: &[u32], give: &mut dyn FnMut(usize, bool)) -> Status;
    /// fmi2GetString; the texts live until the next call.
    fn get_string(&mut self, references: &[u32], give: &mut dyn FnMut(usize, &CStr)) -> Status;
    /// fmi2SetReal
    fn set_real(&mut self, references: &[u32], values: &[f64]) -> Status;
    /// fmi2SetInteger
    fn set_integer(&mut self, references: &[u32], values: &[i32]) -> Status;
    /// fmi2SetBoolean
    fn set_boolean(&mut self, references: &[u32], value_of: &dyn Fn(usize) -> bool) -> Status;
    /// fmi2SetString
    fn set_string(&mut self, references: &[u32], values: &[&str]) -> Status;
    /// fmi2SetRealInputDerivatives
    fn set_input_derivatives(&mut self, references: &[u32], orders: &[i32], values: &[f64]) -> Status;
    /// fmi2GetRealStatus with fmi2LastSuccessfulTime
    fn last_successful_time(&mut self, value: &mut f64) -> Status;
    /// Any function that leads to another phase and does nothing else.
    fn enter(&mut self, function: Function, phase: Phase) -> Status;
    /// fmi2SetTime
    fn set_time(&mut self, time: f64) -> Status;
    /// fmi2NewDiscreteStates; gives the time of the next event.
    fn new_discrete_states(&mut self, next: &mut f64) -> Status;
    /// fmi2GetFMUstate
    fn take_state(&mut self, slot: &mut Option<TakenState>) -> Status;
    /// fmi2SetFMUstate
    fn put_state(&mut self, state: &TakenState) -> Status;
    /// fmi2SerializeFMUstate and fmi2SerializedFMUstateSize
    fn serialize(&mut self, function: Function, state: &TakenState, bytes: &mut Vec<u8>) -> Status;
    /// fmi2DeSerializeFMUstate
    fn deserialize(&mut self, bytes: &[u8], slot: &mut Option<TakenState>) -> Status;
    /// Any function: whether it may be called now.
    fn permit(&mut self, function: Function) -> Status;
    /// A call that is rejected for a reason the C API has found.
    fn refuse(&mut self, function: Function, status: Status, text: &str) -> Status;
    /// After a panic: only reset, restoring a state and freeing are left.
    fn poison(&mut self, function: Function, text: &str);
}
