//! Every fault is found here and gets its name; and the numbers that are told with it.

use crate::interface::{Fault, Parameters, State, Vars};
use crate::reading::Reading;

/// What is wrong in this sample, with a following error in m.
pub fn find(p: &Parameters, reading: &Reading, following_error: f64) -> Option<Fault> {
    if !reading.valid {
        return Some(Fault::LostReading);
    }
    (following_error.abs() > p.limits.following_error).then_some(Fault::FollowingError)
}

/// The numbers behind a state or a fault, for the log.
pub fn numbers(vars: &Vars) -> String {
    let (input, output, p) = (&vars.input, &vars.output, &vars.in_force);
    match (output.state, output.fault) {
        (State::Fault, Fault::FollowingError) => {
            format!(": `{:.6} m`, limit `{} m`", output.following_error, p.limits.following_error)
        }
        (State::Fault, Fault::LostReading) => format!(": `{} m`", input.position),
        (State::Run, _) => format!(": from `{:.6} m` to `{} m`", input.position, p.motion.target),
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const P: Parameters = Parameters::START;
    const GOOD: Reading =
        Reading { position: 0.0, valid: true, first: false, at_rest: false, enabled: true, start: false, reset: false };

    #[test]
    fn a_following_error_beyond_its_limit_is_a_fault_in_both_directions() {
        let most = P.limits.following_error;
        for (error, fault) in [(most, None), (1.001 * most, Some(Fault::FollowingError))] {
            assert_eq!((find(&P, &GOOD, error), find(&P, &GOOD, -error)), (fault, fault));
        }
    }

    #[test]
    fn without_a_position_nothing_else_counts() {
        assert_eq!(find(&P, &Reading { valid: false, ..GOOD }, 1.0), Some(Fault::LostReading));
    }
}
