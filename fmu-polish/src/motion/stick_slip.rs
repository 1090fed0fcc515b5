//! Stick-slip motion: a small velocity beside the feed that changes its sign (eqs. 7 to 17).

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::Vector3;

use crate::interface::{Mode, StickSlip, Wave};
use crate::path::centre_path::Frame;

/// A vector shorter than this has no direction, m.
const LENGTH_MIN: f64 = 1e-9;

/// Unit vector v_v / |v_v|; zero where it has no direction.
pub fn direction(mode: Mode, frame: &Frame) -> Vector3<f64> {
    let (n, x) = (&frame.normal, &frame.contact);
    let vector = match mode {
        Mode::Off => Vector3::zeros(),
        // eqs. 9 to 15: v_v = i n + j x with i = - j (n . x)
        Mode::Paper => x - n * n.dot(x),
        Mode::Cross => n.cross(&frame.tangent),
    };
    let length = vector.norm();
    // a division that stays finite, whichever side of the branch is computed
    if length > LENGTH_MIN { vector / length.max(LENGTH_MIN) } else { Vector3::zeros() }
}

/// The sign of sample `k` = 1, 2, ...; the motion is centred: it begins with half of a half period.
pub fn sign(law: &StickSlip, k: u32) -> f64 {
    let half = law.half_period.unsigned_abs().max(1);
    match law.wave {
        // eq. 17 for a half period of 1
        Wave::Square if ((k - 1 + half / 2) / half).is_multiple_of(2) => 1.0,
        Wave::Square => -1.0,
        // a square of height 1 and a sine of height pi / 2 travel equally far
        Wave::Sine => FRAC_PI_2 * (phase(half, k) - 0.5 * phase(half, 1)).cos(),
    }
}

/// Angle (rad) of sample `k` in a period of two half periods.
pub fn phase(half: u32, k: u32) -> f64 {
    PI * f64::from(k % (2 * half)) / f64::from(half)
}

/// K_v (m/s) at the feed `feed` (m/s).
pub fn velocity(law: &StickSlip, feed: f64) -> f64 {
    match law.mode {
        Mode::Off => 0.0,
        Mode::Paper | Mode::Cross if law.ratio > 0.0 => law.ratio * feed,
        Mode::Paper | Mode::Cross => law.velocity,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAW: StickSlip = StickSlip::START;

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
    fn every_wave_is_centred_and_travels_equally_far() {
        for (wave, half, tolerance) in [(Wave::Square, 10, 1e-12), (Wave::Sine, 10, 0.1), (Wave::Square, 7, 1.0)] {
            let law = StickSlip { half_period: half, wave, ..LAW };
            let way = (1..=4 * half as u32).scan(0.0, |sum, k| {
                *sum += sign(&law, k);
                Some(*sum)
            });
            let way: Vec<f64> = way.collect();
            let (most, least) = way.iter().fold((0.0f64, 0.0f64), |(a, b), w| (a.max(*w), b.min(*w)));
            assert!((most - least - f64::from(half)).abs() <= tolerance, "{wave:?} {half}: {most} {least}");
            assert!((most + least).abs() <= tolerance, "{wave:?} {half}: {most} {least}");
        }
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
