use super::*;

const P: Parameters = Parameters::START;

/// A controller in `state` with this probe position, m.
fn reading(state: State, probe: f64) -> Controller {
    let mut controller = Controller::new(&P).unwrap();
    controller.motion.reseat(0.1, true);
    controller.state = state;
    controller.sample.probe = probe;
    controller.calm.probe = probe;
    controller
}

#[test]
fn a_probe_that_touches_by_just_so_much_has_the_ring() {
    for (probe, touches) in [(P.probe.contact, true), (0.999 * P.probe.contact, false)] {
        // after a push the slide retracts from a ring, and stops if there is none
        let mut pushed = reading(State::Settle, probe);
        pushed.retract(&P);
        assert_eq!(pushed.motion.moving(), touches, "{probe} m");
        // and such a ring is followed
        let mut followed = reading(State::Follow, probe);
        assert_eq!(followed.settle(&P), touches, "{probe} m");
    }
}
