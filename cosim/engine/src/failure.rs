//! Why a run ended.

use plants::StepError;

/// Why a run ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Failure {
    /// MuJoCo counted a warning
    Warning,
    /// a reading of the plant is not finite
    Sensed,
    /// a command of the plant is not finite
    Command,
    /// an element of the plant
    Element(StepError),
    /// MuJoCo ended the step; its words
    MuJoCo(String),
    /// a value on the wire of a reading is not finite
    Reading {
        /// number of the wire
        wire: usize,
        /// the value
        value: f64,
    },
    /// a value on the wire of an output is not finite
    Output {
        /// number of the wire
        wire: usize,
        /// the value
        value: f64,
    },
    /// a value does not fit into an integer
    Integer(f64),
    /// a function of the controller failed
    Call {
        /// its number: those that set, `doStep`, those that get
        call: usize,
        /// what it returned
        status: i32,
    },
}

impl From<StepError> for Failure {
    fn from(error: StepError) -> Self {
        Self::Element(error)
    }
}
