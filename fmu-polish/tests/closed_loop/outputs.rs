//! The outputs of every sample of a cycle are consistent.

use fmu_polish::axes::Axes;
use fmu_polish::interface::{Fault, Parameters, State};
use fmu_polish::path::cl_file::points;
use nalgebra::Vector3;

use crate::common::{HOLLOW, file, spiral};
use crate::robot::Build;
use crate::run::{Loop, POINTS};

const P: Parameters = Parameters::START;

#[test]
fn the_outputs_of_a_cycle_hold_together() {
    let mut run = Loop::new(&P, Build::NOMINAL, 600);
    let (mut before, mut distance) = (None, 0.0);
    while run.output.state != State::Done {
        assert!(run.time() < 20.0 && run.output.fault == Fault::None, "{:?}", run.output);
        run.step();
        let (input, output) = (&run.input, &run.output);
        let (normal, tangent) = (output.normal.vector(), output.tangent.vector());
        assert!((normal.norm() - 1.0).abs() < 1e-12 && (tangent.norm() - 1.0).abs() < 1e-12);
        assert!(normal.dot(&tangent).abs() < 1e-12, "{output:?}");
        // x_d - x, in three directions
        let offset = output.desired.vector() - input.position.vector();
        let parts = [offset.dot(&tangent), offset.dot(&normal.cross(&tangent)), offset.dot(&normal)];
        let expected = [output.error.tangential, output.error.lateral, output.error.normal];
        assert!(
            parts.iter().zip(expected).all(|(part, expected)| (part - expected).abs() < 1e-15),
            "{parts:?} {expected:?}"
        );
        assert_eq!(output.force.error, output.force.setpoint - output.force.measured);
        let pressing = matches!(output.state, State::Settle | State::Follow | State::Unload);
        assert_eq!(output.in_contact, pressing && output.force.measured >= P.limits.lost_force);
        assert!(pressing || output.force.setpoint == 0.0);
        assert_eq!(output.done, output.state == State::Done);
        assert!(output.drive_enable);
        // the position continues by the velocity along the path
        let desired = output.desired.vector();
        if let Some((last, tangential)) = before.replace((desired, output.velocity.tangential)) {
            distance += Vector3::norm(&(desired - last));
            let expected = tangential * P.sample_period;
            // less where it cuts a corner of the polyline, and where the path ends
            let minimum = if output.progress < 1.0 { 0.95 * expected } else { 0.0 };
            assert!((minimum - 1e-12..=1.05 * expected + 1e-12).contains(&(desired - last).norm()), "{output:?}");
        }
    }
    let points = points(file(&spiral(POINTS)).as_bytes(), &P).unwrap();
    let length: f64 = points.windows(2).map(|pair| (pair[1].contact - pair[0].contact).norm()).sum();
    assert!(
        run.output.progress == 1.0 && (run.output.path_length - length).abs() < 1e-12,
        "{}",
        run.output.path_length
    );
    // the ball center is nearer to the middle of the hollow
    let nearer = (HOLLOW - P.tool_radius) / HOLLOW;
    assert!((distance / (nearer * length) - 1.0).abs() < 1e-3, "{distance} {length}");
}

#[test]
fn an_override_that_is_lost_at_any_sample_of_the_tare_is_reported_at_its_sample_and_moves_nothing() {
    // the zero is taken in the samples 1 to 100
    for begin in 85..=95 {
        let mut run = Loop::new(&P, Build::NOMINAL, 601);
        for k in 0..=begin + 5 {
            assert_eq!(run.output.state, State::Idle, "{begin}");
            run.step_with(|input| input.feed_override = if k < begin { 1.0 } else { f64::NAN });
        }
        assert_eq!((run.output.state, run.output.fault), (State::Fault, Fault::InvalidInput), "{begin}");
        assert_eq!(run.output.counts, Axes::all(0));
        (0..100).for_each(|_| run.step());
        assert_eq!(run.output.counts, Axes::all(0), "{begin}");
    }
}
