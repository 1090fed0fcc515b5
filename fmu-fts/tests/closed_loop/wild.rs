//! Parameters anywhere in their ranges: rejected with a reason, or a controller that stays finite.

use fmu_fts::controller::Controller;
use fmu_fts::interface::{Input, Mode, Output, Parameters, SurfaceKind};
use fmu_fts::lists::harmonics::{HIGHEST, Harmonics};
use fmu_fts::texts::Tables;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Most parameters as they are, some anywhere in the ranges of the FMU.
fn parameters(random: &mut Pcg64Mcg) -> Parameters {
    let mut p = Parameters::START;
    let mut change = |value: &mut f64, low: f64, high: f64| {
        if random.random_range(0..4) == 0 {
            // small values are as likely as large ones where the range begins above zero
            *value = if low > 0.0 {
                low * (high / low).powf(random.random_range(0.0..1.0))
            } else {
                random.random_range(low..high)
            };
        }
    };
    change(&mut p.sample_period, 2e-5, 1e-3);
    change(&mut p.tool.arm_length[0], 0.02, 0.5);
    change(&mut p.tool.arm_zero[0], -7.0, 7.0);
    change(&mut p.tool.center_offset[0], -2.0, 2.0);
    change(&mut p.tool.nose_radius[0], 0.0, 0.02);
    change(&mut p.surface.base_curvature, -50.0, 50.0);
    change(&mut p.surface.cross_curvature, -50.0, 50.0);
    change(&mut p.surface.tilt_x, -0.5, 0.5);
    change(&mut p.surface.tilt_y, -0.5, 0.5);
    change(&mut p.surface.wave_amplitude, 0.0, 0.05);
    change(&mut p.surface.inner_radius, 0.0, 0.5);
    change(&mut p.surface.outer_radius, 1e-3, 0.5);
    change(&mut p.surface.depth, -0.2, 0.2);
    change(&mut p.path.grid, 1e-4, 5e-3);
    change(&mut p.servo.bandwidth, 62.8, 3142.0);
    change(&mut p.servo.lead, 1.5, 10.0);
    change(&mut p.servo.roll_off, 1e3, 31_400.0);
    change(&mut p.servo.inertia, 1e-7, 10.0);
    change(&mut p.servo.viscous_friction, 0.0, 10.0);
    change(&mut p.servo.dry_friction, 0.0, 10.0);
    change(&mut p.servo.torque_max, 1e-3, 1e4);
    change(&mut p.servo.current_bandwidth, 600.0, 1e6);
    change(&mut p.tip.frequency, 0.0, 1e5);
    change(&mut p.tip.inertia, 0.0, 0.95);
    change(&mut p.tip.damping, 0.0, 0.5);
    change(&mut p.afc.tau, 0.01, 100.0);
    change(&mut p.afc.frequency_max, 62.8, 31_400.0);
    change(&mut p.approach_time, 0.01, 60.0);
    change(&mut p.hold_speed, 1e-4, 100.0);
    change(&mut p.limits.following_error, 1e-6, 0.1);
    change(&mut p.limits.torque_ratio, 0.1, 1.0);
    if random.random_range(0..4) == 0 {
        p.surface.kind = SurfaceKind::Wave;
    }
    p.path.harmonics = random.random_range(1..=64);
    p.feedforward_harmonics = random.random_range(0..=64);
    p.io_delay = random.random_range(0..=8).min(random.random_range(0..=8));
    p.afc.cancelled = Harmonics::NONE.with(random.random_range(1..=HIGHEST)).with(random.random_range(1..=HIGHEST));
    p.surface.depth_auto = random.random_range(0..2) == 0;
    p
}

/// Whether the parameters were taken; drives a perfect arm if so.
fn survives(random: &mut Pcg64Mcg) -> bool {
    let p = parameters(random);
    let mut controller = match Controller::new(&p, &Tables::default()) {
        Ok(controller) => controller,
        Err(error) => {
            let message = error.to_string();
            assert!(message.contains("hint:") && !message.contains("NaN"), "{message}");
            return false;
        }
    };
    let mut output = Output::START;
    let speed = random.random_range(-300.0..300.0);
    let radius = random.random_range(p.surface.inner_radius..p.surface.outer_radius);
    for k in 0..400 {
        let input = Input {
            arm_angle: output.reference.angle,
            spindle_angle: speed * p.sample_period * f64::from(k),
            slide_position: p.tool.center_offset[0] - p.tool.arm_length[0] - radius,
            enable: true,
            mode: if k < 100 { Mode::Hold } else { Mode::Track },
            commission: k % 2 == 1,
            ..Input::START
        };
        controller.tick(&input, &p, &mut output);
        let reals = [output.torque, output.reference.depth, output.reference.angle, output.error.tracking];
        let finite = reals.iter().all(|x| x.is_finite()) && output.path_torque.is_finite();
        assert!(finite && output.torque.abs() <= p.servo.torque_max, "{p:?} {output:?}");
    }
    true
}

fn survive(seed: u64, cases: usize) {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let taken = (0..cases).filter(|_| survives(&mut random)).count();
    println!("{taken} of {cases} sets of parameters were taken");
    assert!(taken > cases / 20);
}

#[test]
fn two_hundred_wild_sets_of_parameters() {
    survive(11, 200);
}

/// `cargo test --release -p fmu-fts --test closed_loop -- thousand --ignored --nocapture`
#[test]
#[ignore = "takes a minute"]
fn five_thousand_wild_sets_of_parameters() {
    survive(12, 5000);
}
