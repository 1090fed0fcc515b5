//! Checks of parameters against each other, one function each.

use super::error::ParameterError;

/// One check: nothing, or the error of a parameter that does not fit the others.
pub type Check<P> = fn(&P) -> Result<(), ParameterError>;

/// Runs all checks in their order.
///
/// # Errors
/// The first that a check finds.
pub fn check_all<P>(p: &P, checks: &[Check<P>]) -> Result<(), ParameterError> {
    checks.iter().try_for_each(|check| check(p))
}

/// For tests of checks: the message with which `check` refuses the parameters that `change` makes of `p`.
///
/// # Panics
/// When they are not refused.
pub fn refusal<P>(
    mut p: P,
    change: impl FnOnce(&mut P),
    check: impl FnOnce(&P) -> Result<(), ParameterError>,
) -> String {
    change(&mut p);
    check(&p).expect_err("the changed parameters are accepted").to_string()
}

#[cfg(test)]
mod tests {
    use super::super::error::require;
    use super::*;

    struct Parameters {
        low: f64,
        high: f64,
        steps: u32,
    }

    const P: Parameters = Parameters { low: 0.0, high: 1.0, steps: 3 };

    fn ascending(p: &Parameters) -> Result<(), ParameterError> {
        require(p.high > p.low, || wrong("high", p.high.to_string()))
    }

    fn stepped(p: &Parameters) -> Result<(), ParameterError> {
        require(p.steps > 0, || wrong("steps", p.steps.to_string()))
    }

    fn wrong(name: &'static str, value: String) -> ParameterError {
        ParameterError { name, value, limit: "more".into(), hint: "raise it" }
    }

    fn check(p: &Parameters) -> Result<(), ParameterError> {
        check_all(p, &[ascending, stepped])
    }

    #[test]
    fn what_fits_passes_and_every_check_is_asked() {
        assert_eq!(check(&P), Ok(()));
        assert!(refusal(P, |p| p.low = 1.0, check).starts_with("parameter `high` is `1`"));
        assert!(refusal(P, |p| p.steps = 0, check).starts_with("parameter `steps` is `0`"));
    }

    #[test]
    fn the_first_error_is_told() {
        let message = refusal(P, |p| (p.low, p.steps) = (2.0, 0), check);
        assert!(message.starts_with("parameter `high`"), "{message}");
    }

    #[test]
    #[should_panic(expected = "accepted")]
    fn parameters_that_fit_are_no_refusal() {
        refusal(P, |p| p.steps = 4, check);
    }
}
