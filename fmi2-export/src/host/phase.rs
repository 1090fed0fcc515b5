//! The state machines of an instance: which function may be called in which phase (FMI 2.0.5, sections 3.2.3 and 4.2.4).
//! Beyond the standard, fmi2SetInteger, fmi2SetBoolean and fmi2SetString are taken in continuous-time mode, where some
//! importers write the values again that are there.

use serde::{Deserialize, Serialize};

/// Status that a call returns to the master.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// All well.
    Ok,
    /// Done, with a warning.
    Warning,
    /// Rejected, and the instance is as it was.
    Discard,
    /// Rejected, and the instance takes no further steps until it is reset.
    Error,
    /// Nothing of this instance can be used any more.
    Fatal,
}

/// Interface type for which an instance was made: `fmi2Type`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum FmuType {
    /// The importer steps.
    CoSimulation,
    /// The importer sets the time, and the samples are time events.
    ModelExchange,
}

impl FmuType {
    /// How messages call the type.
    pub fn name(self) -> &'static str {
        match self {
            FmuType::CoSimulation => "co-simulation",
            FmuType::ModelExchange => "model exchange",
        }
    }
}

/// Phase of an instance. Steps are synchronous, so none is ever in progress or canceled, and a
/// step is done or is an error, so none is left as failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    Instantiated,
    Initialization,
    /// Of co-simulation only.
    StepComplete,
    /// This and the next of model exchange only.
    EventMode,
    ContinuousTime,
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
            Phase::EventMode => "in event mode",
            Phase::ContinuousTime => "in continuous-time mode",
            Phase::Terminated => "after termination",
            Phase::Error => "after an error",
        }
    }

    /// Whether the model runs: after initialization, and before its end.
    pub fn is_running(self) -> bool {
        matches!(self, Phase::StepComplete | Phase::EventMode | Phase::ContinuousTime)
    }
}

const I: u8 = 1 << Phase::Instantiated as u8;
const M: u8 = 1 << Phase::Initialization as u8;
const S: u8 = 1 << Phase::StepComplete as u8;
const V: u8 = 1 << Phase::EventMode as u8;
const C: u8 = 1 << Phase::ContinuousTime as u8;
const T: u8 = 1 << Phase::Terminated as u8;
const E: u8 = 1 << Phase::Error as u8;
const ANY: u8 = I | M | S | V | C | T | E;

const BOTH: Option<FmuType> = None;
const CS: Option<FmuType> = Some(FmuType::CoSimulation);
const ME: Option<FmuType> = Some(FmuType::ModelExchange);

macro_rules! functions {
    ($($function:ident $fmu_type:ident $allowed:expr;)+) => {
        /// A function of the C API that works on an instance.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Function { $($function),+ }

        impl Function {
            /// Name of the function in the C API.
            pub fn name(self) -> &'static str {
                match self { $(Self::$function => concat!("fmi2", stringify!($function))),+ }
            }

            /// The type of instance that has the function, none where both have it.
            #[inline]
            pub fn fmu_type(self) -> Option<FmuType> {
                const TYPES: &[Option<FmuType>] = &[$($fmu_type),+];
                TYPES[self as usize]
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
    SetDebugLogging               BOTH ANY;
    SetupExperiment               BOTH I;
    EnterInitializationMode       BOTH I;
    ExitInitializationMode        BOTH M;
    Terminate                     BOTH S | V | C;
    Reset                         BOTH ANY;
    GetReal                       BOTH M | S | V | C | T | E;
    GetInteger                    BOTH M | S | V | C | T | E;
    GetBoolean                    BOTH M | S | V | C | T | E;
    GetString                     BOTH M | S | V | C | T | E;
    SetReal                       BOTH I | M | S | V | C;
    SetInteger                    BOTH I | M | S | V | C;
    SetBoolean                    BOTH I | M | S | V | C;
    SetString                     BOTH I | M | S | V | C;
    GetFMUstate                   BOTH ANY;
    SetFMUstate                   BOTH ANY;
    FreeFMUstate                  BOTH ANY;
    SerializedFMUstateSize        BOTH ANY;
    SerializeFMUstate             BOTH ANY;
    DeSerializeFMUstate           BOTH ANY;
    GetDirectionalDerivative      BOTH M | S | V | C | T | E;
    SetRealInputDerivatives       CS   I | M | S;
    GetRealOutputDerivatives      CS   S | T | E;
    DoStep                        CS   S;
    CancelStep                    CS   0;
    GetStatus                     CS   S | T | E;
    GetRealStatus                 CS   S | T | E;
    GetIntegerStatus              CS   S | T | E;
    GetBooleanStatus              CS   S | T | E;
    GetStringStatus               CS   S | T | E;
    EnterEventMode                ME   V | C;
    NewDiscreteStates             ME   V;
    EnterContinuousTimeMode       ME   V;
    CompletedIntegratorStep       ME   C;
    SetTime                       ME   V | C;
    SetContinuousStates           ME   C;
    GetDerivatives                ME   V | C | T | E;
    GetEventIndicators            ME   M | V | C | T | E;
    GetContinuousStates           ME   M | V | C | T | E;
    GetNominalsOfContinuousStates ME   I | V | C | T | E;
}
