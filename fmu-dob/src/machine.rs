//! State machine of one approach: states, faults and the transitions between them.

use crate::interface::{ContactSource, Fault, State};

impl State {
    /// Whether the stage moves towards the workpiece.
    pub fn approaching(self) -> bool {
        matches!(self, Self::Approach | Self::Learn | Self::Detect | Self::Confirm)
    }

    /// Whether a cycle is active.
    pub fn at_work(self) -> bool {
        self.approaching() || matches!(self, Self::Contact | Self::Retract)
    }

    /// Whether an approach or a commissioning run may start.
    pub fn waits(self) -> bool {
        matches!(self, Self::Idle | Self::Done)
    }
}

/// Events of one sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Events {
    /// An approach is requested, see [`control_blocks::WaitingRequest`].
    pub begin: bool,
    /// A commissioning run is requested, see [`control_blocks::WaitingRequest`].
    pub commission: bool,
    /// A calibration cycle is requested, see [`control_blocks::WaitingRequest`].
    pub calibrate: bool,
    /// A touch of a calibration has just ended.
    pub calibration: bool,
    /// The calibration cycle has ended or is aborted.
    pub calibrated: bool,
    /// The commissioning run is aborted.
    pub abort: bool,
    /// The commissioning run has ended.
    pub commissioned: bool,
    /// `enable` is set.
    pub enabled: bool,
    /// Rising edge of `reset_fault`.
    pub reset: bool,
    /// The position is valid, the velocity known, and the reference at rest for as long as the stage takes to come to
    /// rest, or the drive off.
    pub restful: bool,
    /// Something is wrong.
    pub fault: Option<Fault>,
    /// Contact, from its source.
    pub contact: Option<ContactSource>,
    /// A contact is suspected and is touched a second time.
    pub suspected: bool,
    /// The second touch is over, without a contact.
    pub dismissed: bool,
    /// The time of the present state at constant speed is over.
    pub elapsed: bool,
    /// The reference no longer moves towards the workpiece.
    pub reversed: bool,
    /// The retract is complete, and in a cycle the force after it is known.
    pub retreated: bool,
}

/// The state after `state` and `events`; a fault comes first, then contact, then `enable`.
pub fn next(state: State, events: &Events) -> State {
    use State::{Approach, Calibrate, Commission, Confirm, Contact, Detect, Done, Fault, Idle, Learn, Retract};
    let touched = events.contact.is_some();
    match state {
        Fault if events.reset && events.restful && events.retreated && events.fault.is_none() => Idle,
        Fault => Fault,
        _ if events.fault.is_some() => Fault,
        Idle | Done if events.begin && events.restful => Approach,
        Idle | Done if events.commission && events.restful => Commission,
        Idle | Done if events.calibrate && events.restful => Calibrate,
        Calibrate if events.calibrated && events.retreated => Idle,
        Calibrate if events.restful && events.retreated => Approach,
        Commission if events.abort || events.commissioned => Idle,
        Approach | Learn | Detect | Confirm if touched => Contact,
        Approach | Learn | Detect | Confirm if !events.enabled => Retract,
        Approach if events.elapsed => Learn,
        Learn if events.elapsed => Detect,
        Detect if events.suspected => Confirm,
        Confirm if events.dismissed => Detect,
        Contact if events.reversed => Retract,
        Retract if events.retreated && events.calibration => Calibrate,
        Retract if events.retreated => Done,
        unchanged => unchanged,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Enabled, and nothing else.
    const QUIET: Events = Events {
        begin: false,
        commission: false,
        calibrate: false,
        calibration: false,
        calibrated: false,
        abort: false,
        commissioned: false,
        enabled: true,
        reset: false,
        restful: false,
        fault: None,
        contact: None,
        suspected: false,
        dismissed: false,
        elapsed: false,
        reversed: false,
        retreated: false,
    };

    #[test]
    fn nothing_happens_without_events() {
        for &state in State::ALL {
            assert_eq!(next(state, &QUIET), state);
        }
    }

    #[test]
    fn the_whole_sequence_of_one_approach() {
        let begin = Events { begin: true, restful: true, ..QUIET };
        let elapsed = Events { elapsed: true, ..QUIET };
        let contact = Events { contact: Some(ContactSource::Slope), ..QUIET };
        let reversed = Events { reversed: true, ..QUIET };
        let retreated = Events { retreated: true, ..QUIET };
        let mut state = State::Idle;
        let sequence = [begin, elapsed, elapsed, contact, reversed, retreated, begin];
        let expected = [
            State::Approach,
            State::Learn,
            State::Detect,
            State::Contact,
            State::Retract,
            State::Done,
            State::Approach,
        ];
        for (events, expected) in sequence.iter().zip(expected) {
            state = next(state, events);
            assert_eq!(state, expected);
        }
    }

    #[test]
    fn a_commission_begins_at_rest_and_ends_in_idle() {
        let commission = Events { commission: true, restful: true, retreated: true, ..QUIET };
        for &state in State::ALL {
            let expected = match state {
                State::Idle | State::Done => State::Commission,
                // the next touch, and the end of a cycle
                State::Calibrate => State::Approach,
                State::Retract => State::Done,
                unchanged => unchanged,
            };
            assert_eq!(next(state, &commission), expected);
            assert_eq!(next(state, &Events { restful: false, retreated: false, ..commission }), state);
        }
        // who asks for both gets the approach
        assert_eq!(next(State::Idle, &Events { begin: true, ..commission }), State::Approach);
        for events in [Events { abort: true, ..QUIET }, Events { commissioned: true, ..QUIET }] {
            assert_eq!(next(State::Commission, &events), State::Idle);
        }
    }

    #[test]
    fn a_calibration_goes_from_touch_to_touch_and_ends_in_idle() {
        let calibrate = Events { calibrate: true, restful: true, retreated: true, ..QUIET };
        for state in [State::Idle, State::Done] {
            assert_eq!(next(state, &calibrate), State::Calibrate);
            assert_eq!(next(state, &Events { restful: false, ..calibrate }), state);
            // a commissioning run has priority, and an approach before it
            assert_eq!(next(state, &Events { commission: true, ..calibrate }), State::Commission);
        }
        let restful = Events { restful: true, retreated: true, ..QUIET };
        assert_eq!(
            [next(State::Calibrate, &restful), next(State::Calibrate, &QUIET)],
            [State::Approach, State::Calibrate]
        );
        let retreated = Events { calibration: true, ..restful };
        assert_eq!(next(State::Retract, &retreated), State::Calibrate);
        assert_eq!(next(State::Calibrate, &Events { calibrated: true, ..restful }), State::Idle);
        // aborted, and retracting
        assert_eq!(next(State::Calibrate, &Events { calibrated: true, retreated: false, ..restful }), State::Calibrate);
    }

    #[test]
    fn what_is_suspected_is_touched_again_and_confirmed_or_dismissed() {
        let suspected = Events { suspected: true, ..QUIET };
        let dismissed = Events { dismissed: true, ..QUIET };
        for &state in State::ALL {
            assert_eq!(next(state, &suspected), if state == State::Detect { State::Confirm } else { state });
            assert_eq!(next(state, &dismissed), if state == State::Confirm { State::Detect } else { state });
        }
        let contact = Events { contact: Some(ContactSource::Glr), ..suspected };
        assert_eq!([State::Detect, State::Confirm].map(|state| next(state, &contact)), [State::Contact; 2]);
    }

    #[test]
    fn a_cycle_lasts_from_the_approach_to_the_retract() {
        let at_work: Vec<bool> = State::ALL.iter().map(|state| state.at_work()).collect();
        assert_eq!(at_work, [false, true, true, true, true, true, false, false, false, true, false]);
        let approaching: Vec<bool> = State::ALL.iter().map(|state| state.approaching()).collect();
        assert_eq!(approaching, [false, true, true, true, false, false, false, false, false, true, false]);
    }

    #[test]
    fn a_cycle_begins_in_idle_or_done() {
        let waits = State::ALL.iter().filter(|state| state.waits());
        assert_eq!(waits.copied().collect::<Vec<_>>(), [State::Idle, State::Done]);
    }

    #[test]
    fn a_fault_wins_everywhere() {
        let events = Events {
            begin: true,
            commission: true,
            calibrate: true,
            calibration: true,
            calibrated: true,
            abort: true,
            commissioned: true,
            enabled: false,
            reset: true,
            restful: true,
            fault: Some(Fault::PositionLost),
            contact: Some(ContactSource::Slope),
            suspected: true,
            dismissed: true,
            elapsed: true,
            reversed: true,
            retreated: true,
        };
        for &state in State::ALL {
            assert_eq!(next(state, &events), State::Fault);
        }
    }

    #[test]
    fn disabling_acts_only_while_approaching() {
        let disabled = Events { enabled: false, ..QUIET };
        for &state in State::ALL {
            let expected = if state.approaching() { State::Retract } else { state };
            assert_eq!(next(state, &disabled), expected);
        }
    }

    #[test]
    fn a_fault_ends_by_a_reset_at_rest_after_the_retract_and_then_waits() {
        let reset = Events { reset: true, restful: true, retreated: true, ..QUIET };
        assert_eq!(next(State::Fault, &reset), State::Idle);
        let too_early = [
            Events { reset: false, begin: true, ..reset },
            Events { restful: false, ..reset },
            Events { retreated: false, ..reset },
        ];
        for events in too_early {
            assert_eq!(next(State::Fault, &events), State::Fault);
        }
    }
}
