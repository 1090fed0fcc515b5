//! Short forms of the calls, with variables by their names.
#![allow(
    clippy::undocumented_unsafe_blocks,
    reason = "always: the component exists and the arrays have the given length"
)]

use super::{ERROR, EventInfo, Instance, OK, State, Status, Text};
use std::ffi::{CStr, c_char};

impl Instance<'_> {
    pub fn setup(&self, start: f64, stop: Option<f64>) -> Status {
        unsafe {
            (self.fmu.setup_experiment)(self.component, 0, 0.0, start, i32::from(stop.is_some()), stop.unwrap_or(0.0))
        }
    }
    pub fn enter(&self) -> Status {
        unsafe { (self.fmu.enter_initialization_mode)(self.component) }
    }
    pub fn exit(&self) -> Status {
        unsafe { (self.fmu.exit_initialization_mode)(self.component) }
    }
    pub fn terminate(&self) -> Status {
        unsafe { (self.fmu.terminate)(self.component) }
    }
    pub fn reset(&self) -> Status {
        unsafe { (self.fmu.reset)(self.component) }
    }
    pub fn step(&self, time: f64, step: f64) -> Status {
        unsafe { (self.fmu.do_step)(self.component, time, step, 1) }
    }

    pub fn enter_event_mode(&self) -> Status {
        unsafe { (self.fmu.enter_event_mode)(self.component) }
    }
    pub fn enter_continuous_time_mode(&self) -> Status {
        unsafe { (self.fmu.enter_continuous_time_mode)(self.component) }
    }
    pub fn set_time(&self, time: f64) -> Status {
        unsafe { (self.fmu.set_time)(self.component, time) }
    }
    /// Status, and the time of the next event where the answer is one.
    pub fn new_discrete_states(&self) -> (Status, f64) {
        let nothing = EventInfo {
            new_discrete_states_needed: 7,
            terminate_simulation: 7,
            nominals_changed: 7,
            values_changed: 7,
            next_event_time_defined: 7,
            next_event_time: f64::NAN,
        };
        let mut info = nothing;
        let status = unsafe { (self.fmu.new_discrete_states)(self.component, &mut info) };
        let [needed, end, nominals, values, defined] = [
            info.new_discrete_states_needed,
            info.terminate_simulation,
            info.nominals_changed,
            info.values_changed,
            info.next_event_time_defined,
        ];
        let expected = if status == ERROR { [7; 5] } else { [0, 0, 0, 0, 1] };
        assert_eq!([needed, end, nominals, values, defined], expected);
        (status, info.next_event_time)
    }
    /// From continuous-time mode through the event at `time` and back; the time of the next event.
    pub fn event(&self, time: f64) -> f64 {
        assert_eq!((self.set_time(time), self.enter_event_mode()), (OK, OK));
        let (status, next) = self.new_discrete_states();
        assert_eq!((status, self.enter_continuous_time_mode()), (OK, OK));
        next
    }

    pub fn set_reals(&self, names: &[&str], values: &[f64]) -> Status {
        let references = self.references(names);
        unsafe { (self.fmu.set_real)(self.component, references.as_ptr(), references.len(), values.as_ptr()) }
    }
    pub fn set_integers(&self, names: &[&str], values: &[i32]) -> Status {
        let references = self.references(names);
        unsafe { (self.fmu.set_integer)(self.component, references.as_ptr(), references.len(), values.as_ptr()) }
    }
    pub fn set_booleans(&self, names: &[&str], values: &[i32]) -> Status {
        let references = self.references(names);
        unsafe { (self.fmu.set_boolean)(self.component, references.as_ptr(), references.len(), values.as_ptr()) }
    }
    pub fn set_texts(&self, names: &[&str], values: &[&CStr]) -> Status {
        let references = self.references(names);
        let values: Vec<Text> = values.iter().map(|value| value.as_ptr()).collect();
        unsafe { (self.fmu.set_string)(self.component, references.as_ptr(), references.len(), values.as_ptr()) }
    }
    pub fn set_derivatives(&self, names: &[&str], orders: &[i32], values: &[f64]) -> Status {
        let references = self.references(names);
        unsafe {
            (self.fmu.set_input_derivatives)(
                self.component,
                references.as_ptr(),
                references.len(),
                orders.as_ptr(),
                values.as_ptr(),
            )
        }
    }
    pub fn set_real(&self, name: &str, value: f64) -> Status {
        self.set_reals(&[name], &[value])
    }
    pub fn set_integer(&self, name: &str, value: i32) -> Status {
        self.set_integers(&[name], &[value])
    }

    pub fn real(&self, name: &str) -> f64 {
        let mut value = f64::NAN;
        assert_eq!(unsafe { (self.fmu.get_real)(self.component, &self.fmu.reference(name), 1, &mut value) }, OK);
        value
    }
    pub fn integer(&self, name: &str) -> i32 {
        let mut value = i32::MIN;
        assert_eq!(unsafe { (self.fmu.get_integer)(self.component, &self.fmu.reference(name), 1, &mut value) }, OK);
        value
    }
    pub fn boolean(&self, name: &str) -> i32 {
        let mut value = i32::MIN;
        assert_eq!(unsafe { (self.fmu.get_boolean)(self.component, &self.fmu.reference(name), 1, &mut value) }, OK);
        value
    }
    pub fn text(&self, name: &str) -> String {
        let mut value = std::ptr::null();
        assert_eq!(unsafe { (self.fmu.get_string)(self.component, &self.fmu.reference(name), 1, &mut value) }, OK);
        unsafe { CStr::from_ptr(value) }.to_str().unwrap().to_owned()
    }

    pub fn take_state(&self) -> State {
        let mut state = std::ptr::null_mut();
        assert_eq!(unsafe { (self.fmu.get_fmu_state)(self.component, &mut state) }, OK);
        state
    }
    pub fn put_state(&self, state: State) -> Status {
        unsafe { (self.fmu.set_fmu_state)(self.component, state) }
    }
    pub fn free_state(&self, mut state: State) {
        assert_eq!(unsafe { (self.fmu.free_fmu_state)(self.component, &mut state) }, OK);
        assert!(state.is_null());
    }
    pub fn deserialize(&self, bytes: &[u8]) -> (Status, State) {
        let mut state = std::ptr::null_mut();
        let status = unsafe { (self.fmu.deserialize)(self.component, bytes.as_ptr().cast(), bytes.len(), &mut state) };
        (status, state)
    }

    fn references(&self, names: &[&str]) -> Vec<u32> {
        names.iter().map(|name| self.fmu.reference(name)).collect()
    }
}

impl Instance<'_> {
    /// The present state as bytes.
    pub fn bytes(&self) -> Vec<u8> {
        let (state, mut size) = (self.take_state(), 0);
        let bytes = unsafe {
            assert_eq!((self.fmu.serialized_size)(self.component, state, &mut size), OK);
            let mut bytes = vec![0_u8; size];
            assert_eq!((self.fmu.serialize)(self.component, state, bytes.as_mut_ptr().cast::<c_char>(), size), OK);
            bytes
        };
        self.free_state(state);
        bytes
    }

    /// Restores bytes that must be good.
    pub fn restore(&self, bytes: &[u8]) {
        let (status, state) = self.deserialize(bytes);
        assert_eq!(status, OK, "{:?}", self.messages());
        assert_eq!(self.put_state(state), OK);
        self.free_state(state);
    }

    /// Every output and local of the probe, as bits and text.
    pub fn outputs(&self) -> (Vec<u64>, Vec<i32>, String) {
        let reals = ["force", "sum", "natural_frequency"].map(|name| self.real(name).to_bits());
        let integers = ["counted", "active_mode", "ticks"].map(|name| self.integer(name));
        let all = integers.into_iter().chain([self.boolean("enabled")]);
        (reals.to_vec(), all.collect(), self.text("text"))
    }
}
