//! State machine: states, faults and the transitions between them.

use crate::interface::{Fault, State};

/// What happened in one sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Events {
    /// `enable` is set.
    pub enabled: bool,
    /// Rising edge of `enable`.
    pub start: bool,
    /// Rising edge of `reset_fault`.
    pub reset: bool,
    /// The slide is at rest.
    pub at_rest: bool,
    /// Something is wrong.
    pub fault: Option<Fault>,
    /// The slide has been at the target for long enough.
    pub arrived: bool,
}

/// The state after `state` and `events`; a fault comes first, then the end of `enable`.
pub fn next(state: State, events: &Events) -> State {
    use State::{Done, Fault, Idle, Run};
    match state {
        Fault if events.reset && events.at_rest && events.fault.is_none() => Idle,
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

    const ENABLED: Events =
        Events { enabled: true, start: false, reset: false, at_rest: false, fault: None, arrived: false };

    #[test]
    fn nothing_happens_without_events() {
        for state in State::ALL.iter().copied() {
            assert_eq!(next(state, &ENABLED), state);
        }
    }

    #[test]
    fn the_whole_way() {
        assert_eq!(next(State::Idle, &Events { start: true, ..ENABLED }), State::Run);
        assert_eq!(next(State::Run, &Events { arrived: true, ..ENABLED }), State::Done);
        assert_eq!(next(State::Done, &Events::default()), State::Idle);
    }

    #[test]
    fn a_fault_wins_everywhere_and_ends_with_its_reset_at_rest_only() {
        let wrong = Events { start: true, reset: true, at_rest: true, fault: Some(Fault::FollowingError), ..ENABLED };
        for state in State::ALL.iter().copied() {
            assert_eq!(next(state, &wrong), State::Fault);
        }
        for events in [Events { fault: None, at_rest: false, ..wrong }, Events { fault: None, reset: false, ..wrong }] {
            assert_eq!(next(State::Fault, &events), State::Fault);
        }
        assert_eq!(next(State::Fault, &Events { fault: None, ..wrong }), State::Idle);
    }
}
