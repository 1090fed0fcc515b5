//! Detects every fault, and formats the numbers of its message.

use crate::interface::{Fault, Parameters, State, Vars};
use crate::reading::Reading;

/// Returns the fault of this sample. `following_error` is in m.
pub fn find(p: &Parameters, reading: &Reading, following_error: f64) -> Option<Fault> {
    if !reading.valid {
        return Some(Fault::PositionLost);
    }
    (following_error.abs() > p.limits.following_error).then_some(Fault::FollowingError)
}

/// Numbers of a state or a fault, for the log.
pub fn numbers(vars: &Vars) -> String {
    let (input, output, p) = (&vars.input, &vars.output, &vars.in_force);
    match (output.state, output.fault) {
        (State::Fault, Fault::FollowingError) => {
            format!(": `{:.6} m`, limit `{} m`", output.following_error, p.limits.following_error)
        }
        (State::Fault, Fault::PositionLost) => format!(": `{} m`", input.position),
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
        let limit = P.limits.following_error;
        for (error, fault) in [(limit, None), (1.001 * limit, Some(Fault::FollowingError))] {
            assert_eq!((find(&P, &GOOD, error), find(&P, &GOOD, -error)), (fault, fault));
        }
    }

    #[test]
    fn without_a_position_other_faults_are_ignored() {
        assert_eq!(find(&P, &Reading { valid: false, ..GOOD }, 1.0), Some(Fault::PositionLost));
    }
}
