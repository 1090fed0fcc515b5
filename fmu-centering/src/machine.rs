//! State machine of one centering: states, faults and the transitions between them.

use crate::interface::{Fault, State};
use crate::law::Decision;

impl State {
    /// Whether a cycle is running or finished, without a fault.
    pub fn active(self) -> bool {
        !matches!(self, Self::Idle | Self::Fault | Self::Commission)
    }

    /// Whether the slide follows the surface of the ring, without contact of the pusher.
    pub fn follows(self) -> bool {
        matches!(self, Self::Follow | Self::Collect | Self::Model | Self::Wait | Self::Centered)
    }

    /// Whether the state can end only by rotation of the spindle.
    pub fn needs_rotation(self) -> bool {
        matches!(self, Self::Collect | Self::Wait)
    }

    /// Whether the probe must touch the ring.
    pub fn touches(self) -> bool {
        self.follows() || matches!(self, Self::Push | Self::Settle | Self::Confirm)
    }
}

/// Events of one control step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Events {
    /// `enable` is set.
    pub enabled: bool,
    /// Rising edge of `enable`.
    pub start: bool,
    /// Rising edge of `reset_fault`.
    pub reset: bool,
    /// The slide is at rest, and no move is active.
    pub at_rest: bool,
    /// Fault that was detected.
    pub fault: Option<Fault>,
    /// The probe touches the ring.
    pub touched: bool,
    /// The probe has settled at its position.
    pub settled: bool,
    /// The data suffice for a model.
    pub collected: bool,
    /// Conclusion from the new model.
    pub decision: Option<Decision>,
    /// The push starts now.
    pub launched: bool,
    /// The stroke of the push is over.
    pub stroke_over: bool,
    /// The probe has responded in the test before the end.
    pub confirmed: bool,
    /// A commissioning run is requested, see [`control_blocks::WaitingRequest`].
    pub commission: bool,
    /// The commissioning run must be aborted.
    pub abort: bool,
    /// The commissioning run is finished.
    pub commissioned: bool,
}

/// The state after `state` and `events`; a fault comes first, then the end of `enable`.
pub fn next(state: State, events: &Events) -> State {
    use State::{Approach, Centered, Collect, Commission, Confirm, Fault, Follow, Idle, Model, Push, Settle, Wait};
    match state {
        Fault if events.reset && events.at_rest && events.fault.is_none() => Idle,
        Fault => Fault,
        _ if events.fault.is_some() => Fault,
        Idle if events.start => Approach,
        Idle if events.commission && events.at_rest => Commission,
        Idle => Idle,
        Commission if events.abort || events.commissioned => Idle,
        Commission => Commission,
        _ if !events.enabled => Idle,
        Approach if events.touched => Follow,
        Follow | Settle if events.settled => Collect,
        Wait if events.launched => Push,
        Collect | Model | Wait if events.decision.is_some() => match events.decision {
            Some(Decision::Centered) => Confirm,
            Some(Decision::Push) => Wait,
            _ => Collect,
        },
        Collect if events.collected => Model,
        Push if events.stroke_over => Settle,
        Confirm if events.confirmed => Centered,
        unchanged => unchanged,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `enable` is set, and in addition what `change` sets.
    fn enabled(change: impl FnOnce(&mut Events)) -> Events {
        let mut events = Events { enabled: true, ..Events::default() };
        change(&mut events);
        events
    }

    #[test]
    fn nothing_happens_without_events() {
        for state in State::ALL.iter().copied() {
            assert_eq!(next(state, &enabled(|_| ())), state);
        }
    }

    #[test]
    fn the_whole_way_of_one_centering() {
        let settled = enabled(|events| events.settled = true);
        let collected = enabled(|events| events.collected = true);
        let sequence = [
            (enabled(|events| events.start = true), State::Approach),
            (enabled(|events| events.touched = true), State::Follow),
            (settled, State::Collect),
            (collected, State::Model),
            (enabled(|events| events.decision = Some(Decision::Push)), State::Wait),
            (enabled(|events| events.launched = true), State::Push),
            (enabled(|events| events.stroke_over = true), State::Settle),
            (settled, State::Collect),
            (collected, State::Model),
            (enabled(|events| events.decision = Some(Decision::Centered)), State::Confirm),
            (enabled(|events| events.confirmed = true), State::Centered),
        ];
        let mut state = State::Idle;
        for (events, expected) in sequence {
            state = next(state, &events);
            assert_eq!(state, expected);
        }
    }

    #[test]
    fn a_fault_wins_everywhere() {
        let others: [fn(&mut Events); 9] = [
            |events| events.enabled = false,
            |events| events.start = true,
            |events| (events.reset, events.at_rest) = (true, true),
            |events| (events.touched, events.settled) = (true, true),
            |events| events.collected = true,
            |events| events.decision = Some(Decision::Centered),
            |events| events.launched = true,
            |events| events.stroke_over = true,
            |events| events.confirmed = true,
        ];
        for (change, &state) in others.iter().flat_map(|other| State::ALL.iter().map(move |state| (other, state))) {
            let mut events = enabled(|events| events.fault = Some(Fault::NoPart));
            change(&mut events);
            assert_eq!(next(state, &events), State::Fault, "{events:?}");
        }
    }

    #[test]
    fn a_commission_begins_at_rest_and_ends_in_idle() {
        let commission = Events { commission: true, at_rest: true, ..Events::default() };
        assert_eq!(next(State::Idle, &commission), State::Commission);
        assert_eq!(next(State::Idle, &Events { at_rest: false, ..commission }), State::Idle);
        // a request for both starts the cycle
        assert_eq!(next(State::Idle, &Events { start: true, enabled: true, ..commission }), State::Approach);
        let ends =
            [(true, false), (false, true)].map(|(abort, commissioned)| Events { abort, commissioned, ..commission });
        for events in ends {
            assert_eq!(next(State::Commission, &events), State::Idle);
            let fault = Some(Fault::PositionLost);
            assert_eq!(next(State::Commission, &Events { fault, ..events }), State::Fault);
        }
    }

    #[test]
    fn without_enable_everything_but_a_fault_and_a_commission_is_idle() {
        for state in State::ALL.iter().copied() {
            let stays = matches!(state, State::Fault | State::Commission);
            let expected = if stays { state } else { State::Idle };
            assert_eq!(next(state, &Events::default()), expected);
        }
    }

    #[test]
    fn a_fault_ends_with_its_reset_at_rest_only_and_then_waits_for_enable() {
        let start = enabled(|events| (events.start, events.at_rest) = (true, true));
        assert_eq!(next(State::Fault, &start), State::Fault);
        assert_eq!(next(State::Fault, &enabled(|events| events.reset = true)), State::Fault);
        let reset = enabled(|events| (events.reset, events.at_rest) = (true, true));
        assert_eq!(next(State::Fault, &reset), State::Idle);
        assert_eq!(next(State::Idle, &enabled(|_| ())), State::Idle);
        assert_eq!(next(State::Idle, &start), State::Approach);
    }
}
