//! Stick-slip motion: a small velocity in addition to the feed that changes its sign (eqs. 7 to 17), or rotates.
//!
//! A circle is as wide as a square wave is long: radius a = K_v h T_s / 2 for h samples of half a period. So its speed is
//! a pi / (h T_s) = (pi / 2) K_v. A tip of the stiffness k bends by d = mu F / k before the ball slides. A linear sweep
//! loses that twice in each half period, so 2 (a - d) remain. On a circle the friction has a constant magnitude against
//! the motion. The ball follows a circle of the radius r on which the bend d is orthogonal to its motion, r^2 + d^2 =
//! a^2, and slides at (pi / 2) K_v sqrt(1 - d^2 / a^2). So it slides (pi / 2) sqrt((a + d) / (a - d)) times as fast as
//! in a linear sweep. With d > a it sticks in both cases and follows the axes.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::Vector3;

use crate::interface::{Mode, StickSlip};
use crate::path::centre_path::Frame;

/// A vector shorter than this has no direction, m.
const LENGTH_MIN: f64 = 1e-9;
/// Periods in which a circle grows from its middle, which is the position on the path.
const GROWTH: f64 = 2.0;

/// Unit vector v_v / |v_v|; zero where it has no direction.
pub fn direction(mode: Mode, frame: &Frame) -> Vector3<f64> {
    let (n, x) = (&frame.normal, &frame.contact);
    let vector = match mode {
        Mode::Off => Vector3::zeros(),
        // eqs. 9 to 15: v_v = i n + j x with i = - j (n . x)
        Mode::Paper => x - n * n.dot(x),
        Mode::Cross | Mode::Circular => n.cross(&frame.tangent),
    };
    let length = vector.norm();
    // a division that stays finite, whichever side of the branch is computed
    if length > LENGTH_MIN { vector / length.max(LENGTH_MIN) } else { Vector3::zeros() }
}

/// Velocity over K_v in sample `k` = 1, 2, ... and the unit vector along which it counts.
pub fn motion(law: &StickSlip, k: u32, frame: &Frame) -> (f64, Vector3<f64>) {
    let vector = direction(law.mode, frame);
    if law.mode != Mode::Circular {
        return (sign(law, k), vector);
    }
    let half = law.half_period.unsigned_abs().max(1);
    let [across, along] = [0, 1].map(|axis| circle(half, k)[axis] - circle(half, k - 1)[axis]);
    let velocity = across * vector + along * vector.cross(&frame.normal);
    let size = velocity.norm();
    (size, velocity / size.max(f64::MIN_POSITIVE))
}

/// Place on the circle after sample `k`, along the stick-slip vector and square to it, over K_v and the sample period.
fn circle(half: u32, k: u32) -> [f64; 2] {
    let radius = 0.5 * f64::from(half) * (f64::from(k) / (GROWTH * f64::from(2 * half))).min(1.0);
    let (sin, cos) = phase(half, k).sin_cos();
    [radius * cos, radius * sin]
}

/// Whether a soft tip may bend with the whole sweep: on a circle, and where the half period has been raised as far as
/// it may.
pub fn bends(law: &StickSlip) -> bool {
    law.mode == Mode::Circular || (law.half_period_max > 0 && law.half_period >= law.half_period_max)
}

/// Largest velocity over K_v.
pub fn fastest(law: &StickSlip) -> f64 {
    if law.mode == Mode::Circular { FRAC_PI_2 } else { 1.0 }
}

/// Largest acceleration over K_v, 1/s, in samples of `period` s; none of a square wave, which the axes round as they can.
pub fn sharpest(law: &StickSlip, period: f64) -> Option<f64> {
    let turning = PI / (f64::from(law.half_period.max(1)) * period);
    (fastest(law) > 1.0).then_some(FRAC_PI_2 * turning)
}

/// The sign of sample `k` = 1, 2, ...; the motion is centered: it begins with half of a half period.
pub fn sign(law: &StickSlip, k: u32) -> f64 {
    let half = law.half_period.unsigned_abs().max(1);
    // eq. 17 for a half period of 1
    if ((k - 1 + half / 2) / half).is_multiple_of(2) { 1.0 } else { -1.0 }
}

/// Angle (rad) of sample `k` in a period of two half periods.
pub fn phase(half: u32, k: u32) -> f64 {
    PI * f64::from(k % (2 * half)) / f64::from(half)
}

/// K_v (m/s) at the feed `feed` (m/s).
pub fn velocity(law: &StickSlip, feed: f64) -> f64 {
    match law.mode {
        Mode::Off => 0.0,
        _ if law.ratio > 0.0 => law.ratio * feed,
        _ => law.velocity,
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::interface::Parameters;

    const LAW: StickSlip = StickSlip::START;

    /// Parameters with a circular sweep.
    pub fn circular() -> Parameters {
        Parameters { stick_slip: StickSlip { mode: Mode::Circular, ..LAW }, ..Parameters::START }
    }

    fn frame(normal: Vector3<f64>, tangent: Vector3<f64>, contact: Vector3<f64>) -> Frame {
        let (normal, centre) = (normal.normalize(), contact);
        let tangent = (tangent - normal * normal.dot(&tangent)).normalize();
        Frame { centre, contact, normal, tangent, ratio: 1.0, feed_max: 1.0 }
    }

    #[test]
    fn eq_17_alternates_in_every_sample() {
        let law = StickSlip { half_period: 1, ..LAW };
        for k in 1..100 {
            assert_eq!(sign(&law, k), if k % 2 == 1 { 1.0 } else { -1.0 });
        }
    }

    #[test]
    fn every_square_wave_is_centered() {
        for (half, tolerance) in [(10, 1e-12), (7, 1.0)] {
            let law = StickSlip { half_period: half, ..LAW };
            let offsets = (1..=4 * half as u32).scan(0.0, |sum, k| {
                *sum += sign(&law, k);
                Some(*sum)
            });
            let offsets: Vec<f64> = offsets.collect();
            let (maximum, minimum) = offsets.iter().fold((0.0f64, 0.0f64), |(a, b), w| (a.max(*w), b.min(*w)));
            assert!((maximum - minimum - f64::from(half)).abs() <= tolerance, "{half}: {maximum} {minimum}");
            assert!((maximum + minimum).abs() <= tolerance, "{half}: {maximum} {minimum}");
        }
    }

    #[test]
    fn a_circle_is_as_wide_as_the_linear_sweep_is_long_about_the_path_and_never_rests() {
        let u = frame(Vector3::new(0.2, -0.1, 1.0), Vector3::y(), Vector3::zeros());
        let across = direction(Mode::Cross, &u);
        for half in [5, 10, 14] {
            let law = StickSlip { mode: Mode::Circular, half_period: half, ..LAW };
            let (mut position, mut speeds) = (Vector3::zeros(), Vec::new());
            for k in 1..=6 * half as u32 {
                let (speed, vector) = motion(&law, k, &u);
                assert!((vector.norm() - 1.0).abs() < 1e-12 && vector.dot(&u.normal).abs() < 1e-12);
                position += speed * vector;
                speeds.push(speed);
                // the middle is where the path is, from the first sample on
                let radius = 0.5 * f64::from(half) * (f64::from(k) / f64::from(4 * half)).min(1.0);
                assert!((position.norm() - radius).abs() < 1e-9, "{half} {k}: {position}");
                let round = f64::from(k % (2 * half as u32)) * PI / f64::from(half);
                assert!((position.dot(&across) - radius * round.cos()).abs() < 1e-9, "{half} {k}");
                assert!((position.dot(&u.tangent) - radius * round.sin()).abs() < 1e-9, "{half} {k}");
            }
            let steady = &speeds[4 * half as usize..];
            let minimum = steady.iter().copied().fold(f64::MAX, f64::min);
            assert!((minimum / fastest(&law) - 1.0).abs() < 0.02, "{half}: {minimum}");
            assert!(speeds.iter().all(|speed| *speed <= 1.005 * fastest(&law)), "{half}: {speeds:?}");
        }
    }

    #[test]
    fn a_circle_of_one_sample_alternates_as_eq_17() {
        let u = frame(Vector3::new(-0.3, 0.1, 1.0), Vector3::y(), Vector3::new(1e-3, 2e-3, 5e-4));
        let law = StickSlip { mode: Mode::Circular, half_period: 1, ..LAW };
        for k in 10..20 {
            let (speed, vector) = motion(&law, k, &u);
            let expected = if k % 2 == 0 { 1.0 } else { -1.0 };
            assert!((speed * vector.dot(&direction(Mode::Circular, &u)) - expected).abs() < 1e-9, "{k}");
        }
    }

    #[test]
    fn speed_and_acceleration_of_a_circle_are_those_of_the_motion() {
        let (u, dt) = (frame(Vector3::z(), Vector3::y(), Vector3::zeros()), 1e-3);
        let law = StickSlip { mode: Mode::Circular, half_period: 50, ..LAW };
        let velocity = |k: u32| {
            let (size, vector) = motion(&law, k, &u);
            size * vector
        };
        let change = (400..600).map(|k| (velocity(k + 1) - velocity(k)).norm() / dt).fold(0.0, f64::max);
        assert!((change / sharpest(&law, dt).unwrap() - 1.0).abs() < 1e-3, "{change}");
        assert_eq!((sharpest(&LAW, dt), fastest(&LAW)), (None, 1.0));
    }

    #[test]
    fn the_cross_vector_is_orthogonal_to_normal_and_tangent_and_a_unit() {
        for k in 0..1000 {
            let a = f64::from(k);
            let normal = Vector3::new(a.sin(), (2.3 * a).cos(), 1.2);
            let u = frame(normal, Vector3::new((0.7 * a).cos(), a.sin(), 0.1), Vector3::zeros());
            let v = direction(Mode::Cross, &u);
            assert!(v.dot(&u.normal).abs() < 1e-12 && v.dot(&u.tangent).abs() < 1e-12);
            assert!((v.norm() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn the_paper_vector_is_a_unit_in_the_tangent_plane_towards_the_contact() {
        let u = frame(Vector3::new(-0.3, 0.1, 1.0), Vector3::y(), Vector3::new(1e-3, 2e-3, 5e-4));
        let v = direction(Mode::Paper, &u);
        assert!(v.dot(&u.normal).abs() < 1e-12 && v.dot(&u.contact) > 0.0 && (v.norm() - 1.0).abs() < 1e-12);
        // eqs. 7 and 8 cannot both hold
        assert!(v.dot(&u.tangent).abs() > 0.1);
        let start = frame(Vector3::z(), Vector3::y(), Vector3::zeros());
        assert_eq!(direction(Mode::Paper, &start), Vector3::zeros());
    }

    #[test]
    fn the_ratio_follows_the_feed() {
        assert_eq!(velocity(&LAW, 2e-3), LAW.velocity);
        assert_eq!(velocity(&StickSlip { ratio: 5.0, ..LAW }, 2e-3), 10e-3);
        assert_eq!(velocity(&StickSlip { mode: Mode::Off, ..LAW }, 2e-3), 0.0);
    }
}
