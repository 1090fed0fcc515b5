//! A parameter that a check compares with a limit that follows from others.

use std::fmt::Display;

use super::error::{ParameterError, require};

/// A parameter with the data for its error.
#[derive(Clone, Copy, Debug)]
pub struct Parameter<T> {
    name: &'static str,
    value: T,
    unit: &'static str,
    hint: &'static str,
}

impl<T: Display + PartialOrd> Parameter<T> {
    /// FMI name, value, unit (`""` for none), and remedy.
    pub fn new(name: &'static str, value: T, unit: &'static str, hint: &'static str) -> Self {
        Self { name, value, unit, hint }
    }

    /// Requires `limit` or more; `why` is the source of the limit.
    ///
    /// # Errors
    /// When it is less.
    pub fn at_least(&self, limit: T, why: impl Display) -> Result<(), ParameterError> {
        self.must_be(self.value >= limit, || format!("at least `{}`, {why}", self.with_unit(&limit)))
    }

    /// Requires `limit` or less; `why` is the source of the limit.
    ///
    /// # Errors
    /// When it is more.
    pub fn at_most(&self, limit: T, why: impl Display) -> Result<(), ParameterError> {
        self.must_be(self.value <= limit, || format!("at most `{}`, {why}", self.with_unit(&limit)))
    }

    /// Requires more than `limit`; `why` is the source of the limit.
    ///
    /// # Errors
    /// When it is not.
    pub fn more_than(&self, limit: T, why: impl Display) -> Result<(), ParameterError> {
        self.must_be(self.value > limit, || format!("more than `{}`, {why}", self.with_unit(&limit)))
    }

    /// Requires less than `limit`; `why` is the source of the limit.
    ///
    /// # Errors
    /// When it is not.
    pub fn less_than(&self, limit: T, why: impl Display) -> Result<(), ParameterError> {
        self.must_be(self.value < limit, || format!("less than `{}`, {why}", self.with_unit(&limit)))
    }

    /// Requires any other condition, with its text.
    ///
    /// # Errors
    /// When it does not hold.
    pub fn must_be(&self, holds: bool, limit: impl FnOnce() -> String) -> Result<(), ParameterError> {
        let Self { name, value, hint, .. } = self;
        require(holds, || ParameterError { name, value: self.with_unit(value), limit: limit(), hint })
    }

    fn with_unit(&self, value: &T) -> String {
        if self.unit.is_empty() { value.to_string() } else { format!("{value} {}", self.unit) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GAP: Parameter<f64> = Parameter { name: "follow.gap", value: 2.5, unit: "m", hint: "move on" };

    fn text(outcome: Result<(), ParameterError>) -> String {
        let error = outcome.unwrap_err();
        assert_eq!((error.name, error.value.as_str(), error.hint), ("follow.gap", "2.5 m", "move on"));
        error.limit
    }

    #[test]
    fn the_limit_belongs_to_the_closed_ranges_only() {
        assert_eq!((GAP.at_least(2.5, "-"), GAP.at_most(2.5, "-")), (Ok(()), Ok(())));
        assert_eq!((GAP.more_than(2.0, "-"), GAP.less_than(3.0, "-")), (Ok(()), Ok(())));
        assert_eq!(text(GAP.at_least(3.0, "the distance")), "at least `3 m`, the distance");
        assert_eq!(text(GAP.at_most(2.0, "the distance")), "at most `2 m`, the distance");
        assert_eq!(text(GAP.more_than(2.5, "the distance")), "more than `2.5 m`, the distance");
        assert_eq!(text(GAP.less_than(2.5, "the distance")), "less than `2.5 m`, the distance");
    }

    #[test]
    fn what_is_no_number_fits_no_limit() {
        let nothing = Parameter::new("follow.gap", f64::NAN, "m", "move on");
        let outcomes = [
            nothing.at_least(0.0, "-"),
            nothing.at_most(0.0, "-"),
            nothing.more_than(0.0, "-"),
            nothing.less_than(0.0, "-"),
        ];
        assert!(outcomes.iter().all(Result::is_err));
    }

    #[test]
    fn a_number_without_unit_is_shown_alone() {
        let lead = Parameter::new("learn.lead", -3, "", "read later");
        let message = lead.at_least(-1, "minus `io_delay`").unwrap_err().to_string();
        assert_eq!(
            message,
            "parameter `learn.lead` is `-3`, must be at least `-1`, minus `io_delay`\nhint: read later"
        );
    }
}
