//! Reasons for the end of a run.

use plants::StepError;

/// Reason for the end of a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Failure {
    /// MuJoCo counted a warning
    Warning,
    /// a measurement of the plant is not finite
    Sensed,
    /// a command of the plant is not finite
    Command,
    /// an element of the plant failed
    Element(StepError),
    /// MuJoCo ended the step; its message
    MuJoCo(String),
    /// a value on the wire of a measurement is not finite
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
        /// its number: set calls, `doStep`, get calls
        call: usize,
        /// its status
        status: i32,
    },
}

impl From<StepError> for Failure {
    fn from(error: StepError) -> Self {
        Self::Element(error)
    }
}
