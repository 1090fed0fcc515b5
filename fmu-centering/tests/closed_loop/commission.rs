//! The state `Commission`: what it finds on machines that nobody has measured, and what it keeps to.

use std::f64::consts::TAU;

use fmu_centering::interface::{Fault, Input, Parameters, State};
use rand::{RngExt, SeedableRng};

use crate::ring::{Ring, Servo, TOLD};
use crate::run::Loop;

const P: Parameters = Parameters::START;

/// Asks for a commission and for nothing else.
fn ask(input: &mut Input) {
    (input.enable, input.commission) = (false, true);
}

/// Asks for nothing.
fn rest(input: &mut Input) {
    input.enable = false;
}

/// A machine with this servo.
fn machine(p: &Parameters, servo: Servo) -> Loop {
    let mut ring = Ring::new(3, 3e-4, 1.0);
    ring.servo = Some(servo);
    Loop::new(p, ring)
}

/// Steps into the commission, and `time` s on.
fn begin(run: &mut Loop, time: f64) {
    run.step_with(rest);
    run.step_with(ask);
    assert_eq!(run.output.state, State::Commission, "{:?}", run.output);
    let until = run.time() + time;
    while run.time() < until {
        run.step_with(ask);
    }
}

/// Runs until the commission is over; how far the slide went, back and towards the ring, m.
fn commission(run: &mut Loop) -> [f64; 2] {
    begin(run, 0.0);
    let start = run.ring.slide();
    let mut reach = [0.0f64; 2];
    while run.output.state == State::Commission {
        run.step_with(ask);
        let place = run.ring.slide() - start;
        reach = [reach[0].min(place), reach[1].max(place)];
        assert!(run.time() < 30.0, "{:?}", run.output);
    }
    reach
}

/// A servo that is not as told: bandwidth within 30 %, any delay from 0 to 2, other damping, with integral action or without.
fn unknown(seed: u64) -> Servo {
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
    Servo {
        frequency: random.random_range(28.0..52.0),
        damping: random.random_range(0.4..1.0),
        integral: if random.random_bool(0.5) { random.random_range(2.0..20.0) } else { 0.0 },
        delay: random.random_range(0..3),
        share: 1.0,
    }
}

#[test]
fn unknown_machines_are_measured_within_their_deviations() {
    for seed in 0..16 {
        let servo = unknown(seed);
        let mut run = machine(&P, servo);
        let [back, ahead] = commission(&mut run);
        let m = &run.output.measured;
        assert_eq!((run.output.state, run.output.fault, m.valid), (State::Idle, Fault::None, true), "{servo:?}: {m:?}");
        println!(
            "{servo:?}: {:.2} Hz ({:.2}), damping {:.3} ({:.3}), integral {:.2} ({:.2}), delay {:.3} ({:.3}); {:.1} s, {:.2} to {:.2} mm",
            m.slide_bandwidth / TAU,
            m.slide_bandwidth_deviation / TAU,
            m.slide_damping,
            m.slide_damping_deviation,
            m.slide_integral,
            m.slide_integral_deviation,
            m.io_delay,
            m.io_delay_deviation,
            run.time(),
            1e3 * back,
            1e3 * ahead
        );
    }
}
