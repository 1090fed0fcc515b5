//! Tracking, start at rest, mirror image, calibrated contact position.

use fmu_dob::controller::Controller;
use fmu_dob::interface::{Input, Output, Parameters, State};

use crate::run::Loop;
use crate::slide::{SPINDLE_SPEED, Slide};

#[test]
fn tracks_within_ten_nanometres_at_constant_speed() {
    let mut run = Loop::new(&Parameters::START, 31, 1.0);
    assert!(run.run_to(State::Learn, 1.0));
    let (mut sum, mut largest, n) = (0.0, 0.0, 5000);
    for _ in 0..n {
        run.step();
        sum += run.output.tracking_error;
        largest = f64::max(largest, run.output.tracking_error.abs());
    }
    let mean = sum / f64::from(n);
    println!("tracking error: mean {mean:e} m, largest {largest:e} m");
    assert!(largest < 10e-9, "largest {largest} m");
    assert!(mean.abs() < 1e-9, "mean {mean} m");
}

#[test]
fn the_notches_take_the_spindle_out_of_the_force() {
    let mut run = Loop::new(&Parameters::START, 37, 1.0);
    assert!(run.run_to(State::Learn, 1.0));
    let mut lines = [[0.0; 2]; 2];
    for k in 0..5000 {
        run.step();
        let (sine, cosine) = (SPINDLE_SPEED * 1e-4 * f64::from(k)).sin_cos();
        for (line, force) in lines.iter_mut().zip([run.output.force.disturbance, run.output.force.notched]) {
            (line[0], line[1]) = (line[0] + sine * force / 2500.0, line[1] + cosine * force / 2500.0);
        }
    }
    let [disturbance, notched] = lines.map(|[a, b]| f64::hypot(a, b));
    // 20 mN after the 100 Hz of the observer
    assert!(disturbance > 2e-3 && notched < 0.1 * disturbance, "{disturbance} N, {notched} N");
}

#[test]
fn integral_action_replaces_the_compensation() {
    let mut p = Parameters::START;
    p.servo.disturbance_compensation = false;
    let mut run = Loop::new(&p, 32, 80e-6);
    assert!(run.run_to(State::Detect, 1.0));
    assert!(run.output.tracking_error.abs() < 50e-9, "{}", run.output.tracking_error);
    assert!(run.run_to(State::Done, 3.0));
    assert!(run.slide.depth > 0.0 && run.slide.depth < 0.5e-6, "{} m", run.slide.depth);
}

#[test]
fn starts_at_rest_anywhere() {
    let p = Parameters::START;
    for position in [0.0, -0.75, 123.456] {
        let mut controller = Controller::new(&p).unwrap();
        let mut output = Output::START;
        // the velocity is known after 3.2 ms, and a motion before it has no effect after 9.6 ms
        for k in 0..100 {
            let input = Input { position, enable: k == 99, ..Input::START };
            controller.tick(&input, &p, &mut output);
        }
        assert_eq!(output.state, State::Approach);
        assert!((output.reference.position - position).abs() < 1e-8);
        // one tick of the acceleration feed-forward, nothing else
        assert!(output.current.abs() < 0.05, "{} A", output.current);
    }
}

#[test]
fn negative_direction_is_the_mirror_image() {
    let forward = Parameters::START;
    let mut backward = forward.clone();
    backward.approach.direction = -1;
    let mut left = Controller::new(&forward).unwrap();
    let mut right = Controller::new(&backward).unwrap();
    let mut slide = Slide::new(33, 90e-6);
    let (mut a, mut b) = (Output::START, Output::START);
    for k in 0..14_000 {
        let there = Input { position: slide.encoder(), spindle_speed: SPINDLE_SPEED, enable: k > 100, ..Input::START };
        let here = Input { position: -there.position, ..there.clone() };
        left.tick(&there, &forward, &mut a);
        right.tick(&here, &backward, &mut b);
        assert_eq!(a.current, -b.current);
        assert_eq!(a.contact_position, -b.contact_position);
        assert_eq!(a.reference.position, -b.reference.position);
        assert_eq!((a.state, &a.force, &a.threshold), (b.state, &b.force, &b.threshold));
        slide.advance(a.current);
    }
    assert!(slide.touch.is_some());
}

#[test]
fn a_fast_retract_may_be_late_besides_its_following_error() {
    let mut p = Parameters::START;
    // 10 mm/s for two samples are 2 um
    (p.retract.distance, p.retract.velocity, p.retract.deceleration) = (5e-3, 1e-2, 0.05);
    (p.limits.following_error, p.limits.residual_force) = (1e-6, 10.0);
    let mut run = Loop::new(&p, 38, 90e-6);
    assert!(run.run_to(State::Done, 4.0), "{:?}", run.output);
}

#[test]
fn calibrated_bias_moves_the_estimate_only() {
    for direction in [1, -1] {
        let mut p = Parameters::START;
        p.approach.direction = direction;
        p.contact.bias = 300e-9;
        let mut controller = Controller::new(&p).unwrap();
        let mut slide = Slide::new(36, 90e-6);
        let (mut output, sign) = (Output::START, f64::from(direction));
        for k in 0..14_000 {
            let position = sign * slide.encoder();
            let input = Input { position, spindle_speed: SPINDLE_SPEED, enable: k > 100, ..Input::START };
            controller.tick(&input, &p, &mut output);
            slide.advance(sign * output.current);
        }
        assert_eq!((output.state, output.contact), (State::Done, true));
        let shift = output.contact_position - output.contact_position_estimate;
        assert!((shift - sign * 300e-9).abs() < 1e-15, "{shift}");
    }
}
