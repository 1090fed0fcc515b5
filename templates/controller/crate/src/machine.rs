//! State machine: states, faults and the transitions between them.

use crate::interface::{Fault, State};

/// Events of one sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Events {
    /// `enable` is set.
    pub enabled: bool,
    /// Rising edge of `enable`.
    pub start: bool,
    /// Rising edge of `reset_fault` at rest.
    pub reset: bool,
    /// Fault of this sample.
    pub fault: Option<Fault>,
    /// The slide has been at the target for long enough.
    pub arrived: bool,
}

/// Returns the next state. A fault has priority over the end of `enable`.
pub fn next(state: State, events: &Events) -> State {
    use State::{Done, Fault, Idle, Run};
    match state {
        Fault if events.reset && events.fault.is_none() => Idle,
        Fault => Fault,
        _ if events.fault.is_some() => Fault,
        Idle if events.start => Run,
        _ if !events.enabled => Idle,
        Run if events.arrived => Done,
        unchanged => unchanged,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_state_has_one_exit() {
        let quiet = Events { enabled: true, ..Events::default() };
        let start = Events { start: true, ..quiet };
        let arrived = Events { arrived: true, ..quiet };
        let off = Events::default();
        for (state, by_start, by_arrival, by_off) in [
            (State::Idle, State::Run, State::Idle, State::Idle),
            (State::Run, State::Run, State::Done, State::Idle),
            (State::Done, State::Done, State::Done, State::Idle),
            (State::Fault, State::Fault, State::Fault, State::Fault),
        ] {
            let seen = [&quiet, &start, &arrived, &off].map(|events| next(state, events));
            assert_eq!(seen, [state, by_start, by_arrival, by_off]);
        }
    }

    #[test]
    fn a_fault_has_priority_and_ends_by_its_reset_only() {
        let faulty = Events { start: true, reset: true, fault: Some(Fault::FollowingError), ..Events::default() };
        assert!(State::ALL.iter().all(|state| next(*state, &faulty) == State::Fault));
        assert_eq!(next(State::Fault, &Events { fault: None, reset: false, ..faulty }), State::Fault);
        assert_eq!(next(State::Fault, &Events { fault: None, ..faulty }), State::Idle);
    }
}
