//! The outputs are finite and within the limits for any inputs.

use fmu_dob::controller::Controller;
use fmu_dob::interface::{Input, Output, Parameters, State};
use rand::{RngExt, SeedableRng};

/// Whether all outputs are finite.
pub fn finite(o: &Output) -> bool {
    let reals = [
        o.current,
        o.contact_position,
        o.contact_position_estimate,
        o.contact_time,
        o.force.disturbance,
        o.force.notched,
        o.force.deviation,
        o.force.slope,
        o.threshold.mean,
        o.threshold.sigma,
        o.threshold.value,
        o.threshold.alpha_used,
        o.threshold.crossing_rate,
        o.reference.position,
        o.reference.velocity,
        o.tracking_error,
        o.drive_gain_ratio,
        o.measured.force_constant,
        o.measured.force_constant_std,
        o.measured.io_delay,
        o.measured.io_delay_std,
        o.measured.damping,
        o.measured.damping_std,
        o.measured.stiffness,
        o.measured.stiffness_std,
        o.measured.position_noise,
        o.measured.position_noise_std,
        o.measured.force_noise,
        o.measured.force_noise_std,
        o.measured.disturbance_walk,
        o.measured.disturbance_walk_std,
        o.measured.force_sigma,
        o.measured.force_sigma_std,
        o.measured.slope_sigma,
        o.measured.slope_sigma_std,
        o.calibrated.bias,
        o.calibrated.bias_std,
        o.calibrated.bias_fast,
        o.calibrated.bias_slow,
        o.calibrated.std,
        o.calibrated.scatter,
        o.calibrated.scatter_std,
    ];
    reals.iter().all(|x| x.is_finite())
}

#[test]
fn the_outputs_stay_finite_and_limited() {
    let p = Parameters::START;
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(23);
    let mut controller = Controller::new(&p).unwrap();
    let hostile = [f64::NAN, f64::INFINITY, -1e308, 1e3, -1e3, 1e5, 0.0, 5e-324, 1e-9];
    let mut output = Output::START;
    let (mut faults, mut approaches) = (0, 0);
    for k in 0..200_000 {
        let calm = (k / 10_000) % 2 == 0;
        let mut pick = || if calm { 0.1 } else { hostile[random.random_range(0..hostile.len())] };
        let (position, spindle_speed) = (pick(), pick());
        let input = Input {
            position,
            spindle_speed,
            position_valid: calm || random.random_bool(0.7),
            enable: !calm || random.random_bool(0.999),
            commission: calm || random.random_bool(0.99),
            calibrate: random.random_bool(0.5),
            reset_fault: random.random_bool(0.01),
        };
        controller.tick(&input, &p, &mut output);
        assert!(finite(&output), "sample {k}: {output:?}");
        assert!(output.current.abs() <= p.stage.current_max);
        faults += u32::from(output.state == State::Fault);
        approaches += u32::from(output.state == State::Approach);
    }
    assert!(faults > 0 && approaches > 0, "{faults} {approaches}");
}
