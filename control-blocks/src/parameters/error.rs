//! The error of a parameter that does not fit the others, with its remedy.

use std::fmt;

/// A parameter that does not fit the others.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterError {
    /// FMI name of the parameter.
    pub name: &'static str,
    /// Value with unit.
    pub value: String,
    /// Requirement.
    pub limit: String,
    /// Remedy.
    pub hint: &'static str,
}

impl fmt::Display for ParameterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, value, limit, hint } = self;
        write!(f, "parameter `{name}` is `{value}`, must be {limit}\nhint: {hint}")
    }
}

impl std::error::Error for ParameterError {}

impl ParameterError {
    /// The same error for a value that a commissioning run has derived.
    pub fn of_derived(&self) -> String {
        let Self { name, value, limit, .. } = self;
        format!(
            "the values that follow from what was measured do not fit: parameter `{name}` would be `{value}`, must be {limit}"
        )
    }
}

/// The error unless the condition holds.
///
/// # Errors
/// The given one.
pub fn require(holds: bool, error: impl FnOnce() -> ParameterError) -> Result<(), ParameterError> {
    if holds { Ok(()) } else { Err(error()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_message_names_parameter_value_limit_and_hint() {
        let error = || ParameterError {
            name: "servo.bandwidth",
            value: "9 rad/s".into(),
            limit: "at most `5 rad/s`".into(),
            hint: "lower it",
        };
        assert_eq!(require(true, error), Ok(()));
        let message = require(false, error).unwrap_err().to_string();
        assert_eq!(message, "parameter `servo.bandwidth` is `9 rad/s`, must be at most `5 rad/s`\nhint: lower it");
        let derived = error().of_derived();
        assert!(
            derived.ends_with("parameter `servo.bandwidth` would be `9 rad/s`, must be at most `5 rad/s`"),
            "{derived}"
        );
    }
}
