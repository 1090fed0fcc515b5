//! The largest K_v: what parameters, axes and the position error leave of it.

use crate::interface::Parameters;
use crate::motion::stick_slip::{fastest, sharpest};

/// Largest sweep to each side, over the position error that is a fault.
pub const SWEEP: f64 = 0.9;

/// The largest K_v, m/s: that of the parameters, what the feed leaves of the drives, and no sweep that is a position error.
pub fn highest(p: &Parameters) -> f64 {
    let sweep = f64::from(p.stick_slip.half_period) * p.sample_period;
    let left = (p.velocity_max - p.feed.velocity) / fastest(&p.stick_slip);
    p.stick_slip.velocity_max.min(left).min(2.0 * SWEEP * p.limits.position_error / sweep).min(accelerated(p))
}

/// The largest K_v (m/s) that the weakest axis can accelerate; infinite if that is not configured.
pub fn accelerated(p: &Parameters) -> f64 {
    match sharpest(&p.stick_slip, p.sample_period) {
        Some(sharpest) if p.drive.acceleration_max > 0.0 => p.drive.acceleration_max / sharpest,
        _ => f64::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interface::Drive;
    use crate::motion::stick_slip::tests::circular;

    const P: Parameters = Parameters::START;

    #[test]
    fn a_circle_is_raised_to_what_drives_and_speed_bear() {
        let limited = |change: fn(&mut Parameters)| {
            let mut p = circular();
            change(&mut p);
            highest(&p)
        };
        assert_eq!(limited(|_| ()), 20e-3);
        let speed = limited(|p| p.velocity_max = 20e-3 + p.feed.velocity);
        assert!((speed - 20e-3 / std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        // (pi / 2) K_v pi / 10 ms
        let accelerated = limited(|p| p.drive.acceleration_max = 7.0);
        assert!((accelerated - 7.0 * 2.0 * 10e-3 / std::f64::consts::PI.powi(2)).abs() < 1e-12);
        let weak = Drive { acceleration_max: 7.0, ..P.drive };
        assert_eq!(highest(&Parameters { drive: weak, ..P }), 20e-3);
    }

    #[test]
    fn no_sweep_is_raised_to_a_position_error() {
        let mut p = P;
        assert_eq!(highest(&p), 20e-3);
        // 0.45 mm to each side in 99 ms
        p.stick_slip.half_period = 99;
        assert!((highest(&p) - 0.9e-3 / 99e-3).abs() < 1e-12);
    }

    #[test]
    fn it_is_raised_to_no_more_than_the_feed_leaves_of_the_drives() {
        let p = Parameters { velocity_max: P.feed.velocity + 12e-3, ..P };
        assert!((highest(&p) - 12e-3).abs() < 1e-12);
    }
}
