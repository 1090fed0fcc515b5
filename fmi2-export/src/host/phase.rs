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

const I: u8 = 1 << Phase::Instantiated as u8;
const M: u8 = 1 << Phase::Initialization as u8;
const S: u8 = 1 << Phase::StepComplete as u8;
const T: u8 = 1 << Phase::Terminated as u8;
const E: u8 = 1 << Phase::Error as u8;
const ANY: u8 = I | M | S | T | E;

macro_rules! functions {
    ($($function:ident $allowed:expr;)+) => {
        /// A function of the C API that works on an instance.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Function { $($function),+ }

        impl Function {
            /// Name of the function in the C API.
            pub fn name(self) -> &'static str {
                match self { $(Self::$function => concat!("fmi2", stringify!($function))),+ }
            }

            /// Whether the function may be called in a phase.
            #[inline]
            pub fn is_allowed(self, phase: Phase) -> bool {
                const ALLOWED: &[u8] = &[$($allowed),+];
                ALLOWED[self as usize] & (1 << phase as u8) != 0
            }
        }
    };
}

functions! {
    SetDebugLogging          ANY;
    SetupExperiment          I;
    EnterInitializationMode  I;
    ExitInitializationMode   M;
    Terminate                S;
    Reset                    ANY;
    GetReal                  M | S | T | E;
    GetInteger               M | S | T | E;
    GetBoolean               M | S | T | E;
    GetString                M | S | T | E;
    SetReal                  I | M | S;
    SetInteger               I | M | S;
    SetBoolean               I | M | S;
    SetString                I | M | S;
    GetFMUstate              ANY;
    SetFMUstate              ANY;
    FreeFMUstate             ANY;
    SerializedFMUstateSize   ANY;
    SerializeFMUstate        ANY;
    DeSerializeFMUstate      ANY;
    GetDirectionalDerivative M | S | T | E;
    SetRealInputDerivatives  I | M | S;
    GetRealOutputDerivatives S | T | E;
    DoStep                   S;
    CancelStep               0;
    GetStatus                S | T | E;
    GetRealStatus            S | T | E;
    GetIntegerStatus         S | T | E;
    GetBooleanStatus         S | T | E;
    GetStringStatus          S | T | E;
}
