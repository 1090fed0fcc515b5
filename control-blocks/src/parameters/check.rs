//! Checks of parameters against each other, one function each.

use super::error::ParameterError;

/// One check: nothing, or the error of a parameter that does not fit the others.
pub type Check<P> = fn(&P) -> Result<(), ParameterError>;

/// Runs all checks in their order.
///
/// # Errors
/// The first error.
pub fn check_all<P>(p: &P, checks: &[Check<P>]) -> Result<(), ParameterError> {
    checks.iter().try_for_each(|check| check(p))
}

/// The message with which `check` rejects the parameters that `change` makes of `p`.
fn refusal<P>(mut p: P, change: impl FnOnce(&mut P), check: impl FnOnce(&P) -> Result<(), ParameterError>) -> String {
    change(&mut p);
    check(&p).expect_err("the changed parameters are accepted").to_string()
}

/// For tests of checks: a change of valid parameters, and the expected contents of the message: name of the parameter,
/// value, and part of the limit.
pub type Refusal<P> = (fn(&mut P), &'static str, &'static str, &'static str);

/// For tests of checks: `check` accepts all of `fitting`, and rejects each change of the first with a message that names
/// the error.
///
/// # Panics
/// If it does not.
pub fn assert_refusals<P: Clone>(
    check: impl Fn(&P) -> Result<(), ParameterError>,
    fitting: &[P],
    refusals: &[Refusal<P>],
) {
    fitting.iter().for_each(|p| check(p).expect("valid parameters are rejected"));
    for (change, name, value, limit) in refusals {
        let message = refusal(fitting[0].clone(), change, &check);
        assert!(message.starts_with(&format!("parameter `{name}` is {value}")), "{message}");
        assert!(message.contains(limit) && message.contains("hint:"), "{message}");
    }
}

#[cfg(test)]
mod tests {
    use super::super::error::require;
    use super::*;

    #[derive(Clone)]
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
    fn what_fits_passes_and_every_check_is_made() {
        assert_refusals(
            check,
            &[P],
            &[(|p| p.low = 1.0, "high", "`1`", "more"), (|p| p.steps = 0, "steps", "`0`", "more")],
        );
    }

    #[test]
    fn the_first_error_is_reported() {
        let message = refusal(P, |p| (p.low, p.steps) = (2.0, 0), check);
        assert!(message.starts_with("parameter `high`"), "{message}");
    }

    #[test]
    #[should_panic(expected = "`high` is `1`")]
    fn another_limit_is_no_refusal() {
        assert_refusals(check, &[P], &[(|p| p.low = 1.0, "high", "`1`", "less")]);
    }

    #[test]
    #[should_panic(expected = "accepted")]
    fn parameters_that_fit_are_no_refusal() {
        refusal(P, |p| p.steps = 4, check);
    }
}
