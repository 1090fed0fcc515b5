//! Fixtures of the tests of the C API: the loaded library, and an instance with a captured log.
//!
//! The tests never link this crate: they load the built libraries as an importer does.
#![allow(dead_code, reason = "every test uses a part of it")]

mod api;
mod calls;

pub use api::*;
use std::ffi::{CStr, c_int, c_void};
use std::sync::Mutex;

/// One call of the logger.
#[derive(Clone, Debug, PartialEq)]
pub struct Message {
    pub instance: String,
    pub status: Status,
    pub category: String,
    pub text: String,
}

type Log = Mutex<Vec<Message>>;

/// Appends to the [`Log`] in the environment.
unsafe extern "C" fn capture(environment: *mut c_void, instance: Text, status: Status, category: Text, text: Text) {
    let own = |text: Text| {
        assert!(!text.is_null(), "the logger got NULL");
        // SAFETY: the FMU gives C strings that live during the call.
        unsafe { CStr::from_ptr(text) }.to_str().unwrap().to_owned()
    };
    // SAFETY: the environment is the log of a valid instance.
    let log = unsafe { &*environment.cast::<Log>() };
    let message = Message { instance: own(instance), status, category: own(category), text: own(text) };
    log.lock().unwrap().push(message);
}

/// Phases of the state machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    Instantiated,
    Initialization,
    StepComplete,
    EventMode,
    ContinuousTime,
    Terminated,
    Error,
}

/// Phases of an instance for co-simulation.
pub const PHASES: [Phase; 5] =
    [Phase::Instantiated, Phase::Initialization, Phase::StepComplete, Phase::Terminated, Phase::Error];

/// Phases of an instance for model exchange.
pub const EXCHANGE_PHASES: [Phase; 6] = [
    Phase::Instantiated,
    Phase::Initialization,
    Phase::EventMode,
    Phase::ContinuousTime,
    Phase::Terminated,
    Phase::Error,
];

/// An instance, its log, and short forms of the calls. Freed when dropped.
pub struct Instance<'f> {
    pub fmu: &'f Fmu,
    pub component: Component,
    log: Box<Log>,
    /// The standard lets an FMU keep the pointer to the callbacks.
    _callbacks: Box<Callbacks>,
}

// SAFETY: FMI lets an instance move between threads; the log is guarded.
unsafe impl Send for Instance<'_> {}

impl Drop for Instance<'_> {
    fn drop(&mut self) {
        // SAFETY: the component comes from fmi2Instantiate and is freed once.
        unsafe { (self.fmu.free_instance)(self.component) }
    }
}

impl<'f> Instance<'f> {
    /// An instance for co-simulation.
    pub fn new(fmu: &'f Fmu) -> Self {
        Self::of_type(fmu, CO_SIMULATION)
    }

    /// An instance of an FMU type.
    pub fn of_type(fmu: &'f Fmu, fmu_type: c_int) -> Self {
        let log = Box::<Log>::default();
        let environment = std::ptr::from_ref(&*log).cast_mut().cast();
        let callbacks =
            Box::new(Callbacks { logger: Some(capture), allocate: None, free: None, step_finished: None, environment });
        let (name, guid) = (c"test", fmu.guid.as_ptr());
        // SAFETY: all pointers live during the call, the callbacks and the log as long as the instance.
        let component =
            unsafe { (fmu.instantiate)(name.as_ptr(), fmu_type, guid, std::ptr::null(), &raw const *callbacks, 0, 0) };
        assert!(!component.is_null(), "{:?}", log.lock());
        Self { fmu, component, log, _callbacks: callbacks }
    }

    /// A new instance in a phase; parameters have their start values and time starts at zero.
    pub fn in_phase(fmu: &'f Fmu, phase: Phase) -> Self {
        Self::of_type_in_phase(fmu, CO_SIMULATION, phase)
    }

    /// The same of an FMU type.
    pub fn of_type_in_phase(fmu: &'f Fmu, fmu_type: c_int, phase: Phase) -> Self {
        let instance = Self::of_type(fmu, fmu_type);
        if phase != Phase::Instantiated {
            assert_eq!(instance.setup(0.0, None), OK);
            assert_eq!(instance.enter(), OK);
        }
        if !matches!(phase, Phase::Instantiated | Phase::Initialization) {
            assert_eq!(instance.exit(), OK);
        }
        match phase {
            Phase::Terminated => assert_eq!(instance.terminate(), OK),
            Phase::Error => assert_eq!(instance.step(0.0, f64::NAN), ERROR),
            Phase::ContinuousTime => assert_eq!(instance.enter_continuous_time_mode(), OK),
            _ => (),
        }
        instance.messages();
        instance
    }

    /// An instance for model exchange at the first time event.
    pub fn at_first_event(fmu: &'f Fmu) -> Self {
        Self::of_type_in_phase(fmu, MODEL_EXCHANGE, Phase::EventMode)
    }

    /// An instance ready for its first step.
    pub fn started(fmu: &'f Fmu) -> Self {
        Self::in_phase(fmu, Phase::StepComplete)
    }

    /// Takes the messages since the last look.
    pub fn messages(&self) -> Vec<Message> {
        std::mem::take(&mut self.log.lock().unwrap())
    }

    /// The phase, from the message of a call that is never allowed; the call leads to the error phase.
    pub fn end_phase(&self) -> Phase {
        self.messages();
        // SAFETY: the component lives.
        assert_eq!(unsafe { (self.fmu.cancel_step)(self.component) }, ERROR);
        let text = self.messages().remove(0).text;
        let phase = text.strip_prefix("fmi2CancelStep: may not be called ").unwrap();
        match phase.strip_suffix(": this instance is for model exchange").unwrap_or(phase) {
            "before initialization" => Phase::Instantiated,
            "in initialization mode" => Phase::Initialization,
            "between steps" => Phase::StepComplete,
            "in event mode" => Phase::EventMode,
            "in continuous-time mode" => Phase::ContinuousTime,
            "after termination" => Phase::Terminated,
            "after an error" => Phase::Error,
            other => panic!("unknown phase `{other}`"),
        }
    }

    /// Checks the result of a rejected call: status, one message in the fitting declared category,
    /// and that its text holds every word.
    pub fn assert_rejected(&self, status: Status, expected: Status, words: &[&str]) {
        let messages = self.messages();
        assert_eq!(status, expected, "{messages:?}");
        let [message] = &messages[..] else { panic!("one message expected for {words:?}: {messages:?}") };
        let category = match expected {
            WARNING => "logStatusWarning",
            DISCARD => "logStatusDiscard",
            _ => "logStatusError",
        };
        assert_eq!((message.instance.as_str(), message.status), ("test", expected), "{message:?}");
        assert_eq!(message.category, category);
        assert!(self.fmu.description.contains(&format!("<Category name=\"{category}\"")));
        for word in words {
            assert!(message.text.contains(word), "`{word}` is missing in: {}", message.text);
        }
    }
}
