//! Tests of the bounds of a plan: phase of the delays at the largest crossing, bending of the flexure at its
//! resonance, motion of the tool over that of the hub.

use std::f64::consts::PI;

use super::*;

#[test]
fn delays_take_their_phase_at_the_largest_crossing_and_no_more() {
    let mut p = Parameters::START;
    // a rigid arm without friction and an inactive bandwidth limit: only delays change its phase
    (p.tip.frequency, p.servo.viscous_friction, p.servo.bandwidth) = (0.0, 0.0, TAU * 2000.0);
    for io_delay in [0, 1, 3] {
        p.io_delay = io_delay;
        let nominal = Nominal::from(&p);
        let latest = Nominal { io_delay: io_delay + DELAY_SPREAD, ..nominal };
        let omega = CROSSING * crossover(&nominal);
        let arm = LoopModel::new(latest, compensator(&nominal)).arm(omega);
        let late = -(-arm).arg() + (omega / nominal.servo.roll_off).atan();
        assert!((late / PHASE - 1.0).abs() < 0.03, "{io_delay}: {late}");
    }
}

#[test]
fn about_its_resonance_the_flexure_is_bent_half_as_far_as_by_full_torque_at_rest() {
    let p = Parameters::START;
    let (plan, whole) = (Plan::new(&p), (1.0 - p.tip.inertia).sqrt());
    // at the resonance of the free arm a torque bends it by 1 / 2 z of what it does at rest
    assert!(
        (bending(&p) / (2.0 * p.tip.damping * whole) * (1.0 - p.tip.inertia) - 0.5 * p.servo.torque_max).abs() < 1e-9
    );
    let maximum = |about: bool| {
        let tones = plan.tones.iter().map(|tone| (TAU * tone.frequency() / p.sample_period, tone.amplitude));
        let pushes = tones
            .filter(|(omega, _)| (*omega > BENDS_FROM * p.tip.frequency) == about)
            .map(|(omega, amplitude)| amplitude * (plan.model.closed(omega) / plan.model.arm(omega)).norm());
        pushes.fold(0.0, f64::max)
    };
    assert!(maximum(true) <= bending(&p) && maximum(false) > bending(&p), "{} {}", maximum(true), maximum(false));
}

#[test]
fn the_tool_goes_with_the_hub_far_below_the_flexure_and_against_it_above() {
    let tip = Tip { frequency: 1000.0, damping: 0.02, ..Parameters::START.tip };
    assert!((tool_over_hub(&tip, 1.0) - 1.0).norm() < 1e-5);
    // a quarter of a period late at its frequency, 1 / 2 z of it
    let there = tool_over_hub(&tip, 1000.0);
    assert!((there.norm() * 0.04 - 1.0).abs() < 1e-3 && (there.arg() + 0.5 * PI).abs() < 0.05, "{there}");
    assert!((tool_over_hub(&tip, 1000.0 * 2.0_f64.sqrt()) + 1.0).norm() < 0.15);
    assert_eq!(tool_over_hub(&Tip { frequency: 0.0, ..tip }, 1000.0), Complex::ONE);
}
