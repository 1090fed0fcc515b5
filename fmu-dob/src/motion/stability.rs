//! Whether the servo over its observer is stable on the nominal stage, before anything moves.
//!
//! Without its limits the loop is linear: one sample is x' = A x with x = (position, velocity, current, memory of the
//! observer, integral, delayed currents), and column i of A is the response of a sample to the i-th unit vector. The
//! loop is stable while all eigenvalues of A are inside the unit circle. A margin is required: a drive that is
//! stronger, and one sample more delay, than configured.

use control_blocks::{DELAY_MAX, Trajectory};
use nalgebra::DMatrix;

use crate::force::observer::DisturbanceObserver;
use crate::interface::Parameters;
use crate::motion::servo;

/// Required gain margin over the configured drive: 30 % of thrust or mass.
const GAIN_MARGIN: f64 = 1.3;
/// Required margin of the delay, samples.
const DELAY_MARGIN: usize = 1;
/// Position, velocity, current, two of the observer, integral.
const OWN: usize = 6;
/// Steps of the stage in a sample.
const SUBSTEPS: u32 = 8;

/// Largest absolute value of the eigenvalues of a sample, with the margins.
pub fn spectral_radius(p: &Parameters) -> f64 {
    radius(p, GAIN_MARGIN, p.io_delay as usize + DELAY_MARGIN)
}

/// Longest configured delay (samples) up to `maximum` with which the loop keeps the margins.
pub fn longest_delay(p: &Parameters, maximum: usize) -> i32 {
    let stable = |io_delay: &i32| spectral_radius(&Parameters { io_delay: *io_delay, ..p.clone() }) < 1.0;
    (p.io_delay + 1..=maximum.min(DELAY_MAX) as i32).take_while(stable).last().unwrap_or(p.io_delay)
}

/// The same of a drive `gain` times as strong as configured, with a delay of `delay` samples, not less than configured.
pub fn radius(p: &Parameters, gain: f64, delay: usize) -> f64 {
    let order = OWN + delay + 1;
    let observer = DisturbanceObserver::new(p);
    let mut matrix = DMatrix::zeros(order, order);
    for i in 0..order {
        let mut x = [0.0; OWN + DELAY_MAX + DELAY_MARGIN + 1];
        x[i] = 1.0;
        sample(p, &observer, gain, &mut x[..order]);
        (0..order).for_each(|row| matrix[(row, i)] = x[row]);
    }
    matrix.complex_eigenvalues().iter().map(|z| z.norm()).fold(0.0, f64::max)
}

/// One sample of the loop: read, act, move.
fn sample(p: &Parameters, observer: &DisturbanceObserver, gain: f64, x: &mut [f64]) {
    let mut observer = observer.with_memory([x[3], x[4]]);
    let acted = x[OWN + p.io_delay as usize];
    observer.update(x[0], acted);
    [x[3], x[4]] = observer.memory();
    let mut force = p.stage.mass * servo::acceleration(&p.servo, &Trajectory::default(), x[0], observer.velocity());
    if p.servo.disturbance_compensation {
        force += observer.force();
    }
    if p.servo.disturbance_compensation || p.servo.integral_gain == 0.0 {
        // not there, and no eigenvalue 1
        x[5] = 0.0;
    } else {
        x[5] -= p.servo.integral_gain * x[0] * p.sample_period;
        force += p.stage.mass * x[5];
    }
    x[OWN..].rotate_right(1);
    x[OWN] = force / p.stage.force_constant;
    let acting = x[x.len() - 1];
    let dt = p.sample_period / f64::from(SUBSTEPS);
    let lag = (-p.stage.current_bandwidth * dt).exp();
    for _ in 0..SUBSTEPS {
        x[2] = acting + (x[2] - acting) * lag;
        let acceleration = gain * p.stage.force_constant * x[2] / p.stage.mass;
        x[0] += x[1] * dt + 0.5 * acceleration * dt * dt;
        x[1] += acceleration * dt;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_presets_are_stable_with_every_delay_up_to_four() {
        for io_delay in 0..=4 {
            for compensation in [false, true] {
                let mut p = Parameters { io_delay, ..Parameters::START };
                p.servo.disturbance_compensation = compensation;
                assert!(spectral_radius(&p) < 0.999, "{io_delay}: {}", spectral_radius(&p));
            }
        }
    }

    #[test]
    fn every_delay_can_be_evaluated() {
        for io_delay in 0..=DELAY_MAX as i32 {
            let mut p = Parameters { io_delay, ..Parameters::START };
            p.servo.bandwidth = 20.0;
            p.observer.bandwidth = 60.0;
            assert!(spectral_radius(&p) < 1.0, "{io_delay}: {}", spectral_radius(&p));
        }
    }

    #[test]
    fn a_slow_servo_decays_as_its_roots_say() {
        let mut p = Parameters { sample_period: 2e-5, ..Parameters::START };
        (p.servo.disturbance_compensation, p.servo.integral_gain) = (false, 0.0);
        (p.servo.bandwidth, p.servo.damping) = (10.0, 1.0);
        (p.observer.velocity_bandwidth, p.stage.current_bandwidth) = (50_000.0, 1e6);
        // s^2 + 1.3 (2 omega s + omega^2) = 0
        let slowest = 10.0 * (1.3 - (1.3f64 * 1.3 - 1.3).sqrt());
        let decay = -spectral_radius(&p).ln() / p.sample_period;
        assert!((decay / slowest - 1.0).abs() < 2e-2, "{decay} {slowest}");
    }

    #[test]
    fn a_drive_of_the_margin_moves_the_stage_by_half_a_t_squared() {
        let mut p = Parameters::START;
        p.stage.current_bandwidth = 1e6;
        let mut x = [0.0; OWN + 3];
        // 0.1 A that acts next
        x[OWN + 1] = 0.1;
        sample(&p, &DisturbanceObserver::new(&p), GAIN_MARGIN, &mut x);
        let (a, t) = (1.3 * 20.0 * 0.1 / 10.0, 1e-4);
        assert!((x[1] / (a * t) - 1.0).abs() < 1e-5 && (x[0] / (0.5 * a * t * t) - 1.0).abs() < 1e-5, "{x:?}");
    }

    #[test]
    fn the_radius_is_the_growth_of_the_loop_in_a_sample() {
        let mut p = Parameters::START;
        (p.servo.bandwidth, p.observer.bandwidth) = (785.0, 3000.0);
        let observer = DisturbanceObserver::new(&p);
        let mut x = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let mut largest = || {
            (0..400)
                .map(|_| {
                    sample(&p, &observer, GAIN_MARGIN, &mut x);
                    x[0].abs()
                })
                .fold(0.0, f64::max)
        };
        largest();
        let growth = (largest().recip() * largest()).powf(1.0 / 400.0);
        assert!(
            growth > 1.001 && (growth / spectral_radius(&p) - 1.0).abs() < 5e-3,
            "{growth} {}",
            spectral_radius(&p)
        );
    }

    #[test]
    fn without_any_gain_the_radius_is_that_of_a_free_mass() {
        let mut p = Parameters::START;
        (p.servo.disturbance_compensation, p.servo.integral_gain) = (false, 0.0);
        p.servo.bandwidth = 1e-9;
        assert!((spectral_radius(&p) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn the_current_lags_its_command() {
        let p = Parameters::START;
        let mut x = [0.0; OWN + 3];
        x[OWN + 1] = 0.1;
        sample(&p, &DisturbanceObserver::new(&p), GAIN_MARGIN, &mut x);
        let current = 0.1 * (1.0 - (-p.stage.current_bandwidth * p.sample_period).exp());
        assert!((x[2] / current - 1.0).abs() < 1e-9, "{} {current}", x[2]);
    }
}
