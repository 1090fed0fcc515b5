//! The state machine of a co-simulation slave: which function may be called in which phase
//! (FMI 2.0.5, section 4.2.4).

use serde::{Deserialize, Serialize};

/// What a call returns to the master.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// All well.
    Ok,
    /// Done, with something to tell.
    Warning,
    /// Refused, and the instance is as it was.
    Discard,
    /// Refused, and the instance takes no further steps until it is reset.
    Error,
    /// Nothing of this instance can be used any more.
    Fatal,
}

/// Phase of an instance. Steps are synchronous, so none is ever in progress or cancelled, and a
/// step is done or is an error, so none is left as failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    Instantiated,
    Initialization,
    StepComplete,
    Terminated,
    Error,
}

impl Phase {
    /// How messages call the phase.
    pub fn name(self) -> &'static str {
        match self {
            Phase::Instantiated => "before initialization",
            Phase::Initialization => "in initialization mode",
            Phase::StepComplete => "between steps",
            Phase::Terminated => "after termination",
            Phase::Error => "after an error",
        }
    }
}

/// A function of the C API that works on an instance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Function {
    pub name: &'static str,
    allowed: u8,
}

const I: u8 = 1 << Phase::Instantiated as u8;
const M: u8 = 1 << Phase::Initialization as u8;
const S: u8 = 1 << Phase::StepComplete as u8;
const T: u8 = 1 << Phase::Terminated as u8;
const E: u8 = 1 << Phase::Error as u8;
const ANY: u8 = I | M | S | T | E;

macro_rules! functions {
    ($($constant:ident $name:literal $allowed:expr;)+) => {
        impl Function { $(pub const $constant: Self = Self { name: $name, allowed: $allowed };)+ }
    };
}

functions! {
    SET_DEBUG_LOGGING         "fmi2SetDebugLogging"         ANY;
    SETUP_EXPERIMENT          "fmi2SetupExperiment"         I;
    ENTER_INITIALIZATION_MODE "fmi2EnterInitializationMode" I;
    EXIT_INITIALIZATION_MODE  "fmi2ExitInitializationMode"  M;
    TERMINATE                 "fmi2Terminate"               S;
    RESET                     "fmi2Reset"                   ANY;
    GET_REAL                  "fmi2GetReal"                 M | S | T | E;
    GET_INTEGER               "fmi2GetInteger"              M | S | T | E;
    GET_BOOLEAN               "fmi2GetBoolean"              M | S | T | E;
    GET_STRING                "fmi2GetString"               M | S | T | E;
    SET_REAL                  "fmi2SetReal"                 I | M | S;
    SET_INTEGER               "fmi2SetInteger"              I | M | S;
    SET_BOOLEAN               "fmi2SetBoolean"              I | M | S;
    SET_STRING                "fmi2SetString"               I | M | S;
    GET_FMU_STATE             "fmi2GetFMUstate"             ANY;
    SET_FMU_STATE             "fmi2SetFMUstate"             ANY;
    FREE_FMU_STATE            "fmi2FreeFMUstate"            ANY;
    SERIALIZED_STATE_SIZE     "fmi2SerializedFMUstateSize"  ANY;
    SERIALIZE_STATE           "fmi2SerializeFMUstate"       ANY;
    DESERIALIZE_STATE         "fmi2DeSerializeFMUstate"     ANY;
    DIRECTIONAL_DERIVATIVE    "fmi2GetDirectionalDerivative" M | S | T | E;
    SET_INPUT_DERIVATIVES     "fmi2SetRealInputDerivatives" I | M | S;
    GET_OUTPUT_DERIVATIVES    "fmi2GetRealOutputDerivatives" S | T | E;
    DO_STEP                   "fmi2DoStep"                  S;
    CANCEL_STEP               "fmi2CancelStep"              0;
    GET_STATUS                "fmi2GetStatus"               S | T | E;
    GET_REAL_STATUS           "fmi2GetRealStatus"           S | T | E;
    GET_INTEGER_STATUS        "fmi2GetIntegerStatus"        S | T | E;
    GET_BOOLEAN_STATUS        "fmi2GetBooleanStatus"        S | T | E;
    GET_STRING_STATUS         "fmi2GetStringStatus"         S | T | E;
}

impl Function {
    /// Whether the function may be called in a phase.
    pub fn is_allowed(self, phase: Phase) -> bool {
        self.allowed & (1 << phase as u8) != 0
    }
}
