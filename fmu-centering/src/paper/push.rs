//! Distance, velocity and lead angle of a push, eq. 28 to 36.

use std::f64::consts::PI;

use crate::interface::Push;
/// Maximum number of steps that bracket the lead angle.
const BRACKETS: f64 = 256.0;
/// Halvings of the bracket: beyond the last digit of a double.
const HALVINGS: u32 = 60;

/// Travel d (m) of the slide that centers a ring of radius `r` and eccentricity `b` (m), begun at the angle `lead`
/// (rad) before the ring is nearest, with the pusher `gap` m before the surface and the learned `offset` m.
pub fn distance(r: f64, b: f64, lead: f64, gap: f64, offset: f64) -> f64 {
    let (sine, cosine) = lead.sin_cos();
    // eq. 28 to 31, the last term of 31 with the sign and the radius of eq. 28
    let side = b * sine;
    gap + b * cosine + (r * r - side * side).max(0.0).sqrt() - r + offset
}

/// Velocity v (m/s) of a push that moves the ring by `b` m.
pub fn velocity(p: &Push, b: f64) -> f64 {
    if b >= p.critical_distance {
        return p.velocity_max;
    }
    // eq. 33 with its exponents and the steepness s = 1 of the paper: between v_min at 0 and v_max at d_crit
    let u = (p.critical_distance - b) / p.critical_distance;
    p.velocity_min.powf(u) * p.velocity_max.powf(1.0 - u)
}

/// Smallest lead angle L (rad) with L = |w| t(d(L)), eq. 36: the ring is nearest when the slide has come to rest.
///
/// `time` is t(d(L)), s. Repeated insertion converges only while w B sin(L) / v < 1; this bisects.
pub fn lead_angle(w: f64, time: impl Fn(f64) -> f64) -> f64 {
    let excess = |lead: f64| lead - w.abs() * time(lead);
    // no travel is longer than that from L = 0, so the excess is not negative at `maximum`
    let maximum = w.abs() * time(0.0);
    let step = (PI / 16.0).max(maximum / BRACKETS);
    let mut high = step.min(maximum);
    while high < maximum && excess(high) < 0.0 {
        high = (high + step).min(maximum);
    }
    let mut low = (high - step).max(0.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if excess(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::duration;

    const R: f64 = 0.05;
    const A: f64 = 2.56;
    /// 20 rpm, rad/s.
    const W: f64 = 2.0944;

    #[test]
    fn velocity_goes_from_its_minimum_to_its_maximum() {
        let p = Push::START;
        assert!((velocity(&p, 0.0) - 4e-4).abs() < 1e-15);
        assert!((velocity(&p, 2.5e-3) - 3.5e-3).abs() < 1e-15);
        assert_eq!(velocity(&p, 0.01), 3.5e-3);
        // s = 1: the geometric mean at half the critical distance
        assert!((velocity(&p, 1.25e-3) - (4e-4f64 * 3.5e-3).sqrt()).abs() < 1e-12);
        // the unnumbered exponential above eq. 33
        let exponential = 3.5e-3 * (-(2.3f64 / 2.5) * (3.5f64 / 0.4).ln()).exp();
        assert!((velocity(&p, 2e-4) - exponential).abs() < 1e-12);
    }

    #[test]
    fn distance_without_lead_is_gap_and_eccentricity() {
        assert!((distance(R, 3e-4, 0.0, 5e-4, 0.0) - 8e-4).abs() < 1e-15);
        assert!((distance(R, 3e-4, 0.0, 5e-4, -2e-5) - 7.8e-4).abs() < 1e-15);
    }

    #[test]
    fn distance_ends_where_the_centered_ring_would_be() {
        // the pusher ends at x = r, wherever the surface was at the start
        for lead in [0.0f64, 0.4, 1.5, 3.0, 6.0] {
            let (b, gap) = (4e-3, 5e-4);
            let surface = b * lead.cos() + (R * R - (b * lead.sin()).powi(2)).sqrt();
            assert!((surface + gap - distance(R, b, lead, gap, 0.0) - R).abs() < 1e-15);
        }
    }

    /// Lead angle and its error for eccentricity `b`, velocity `v` and `gap`.
    fn solved(b: f64, v: f64, gap: f64) -> (f64, f64) {
        let time = |lead: f64| duration(distance(R, b, lead, gap, 0.0), v, A);
        let lead = lead_angle(W, time);
        (lead, lead - W * time(lead))
    }

    #[test]
    fn the_lead_angle_solves_its_equation() {
        let p = Push::START;
        for b in [0.0, 1e-6, 1e-5, 1e-4, 3e-4, 6e-4, 3e-3, 0.02] {
            for gap in [0.0, 1e-5, 2e-4, 5e-4, 2e-3] {
                let (lead, error) = solved(b, velocity(&p, b), gap);
                assert!(error.abs() < 1e-9 && lead >= 0.0, "B {b}, gap {gap}: {lead}, {error}");
            }
        }
    }

    #[test]
    fn it_is_found_where_blind_iteration_diverges() {
        // w B / v > 1 from B = 0.19 mm on, at 20 rpm and 0.4 mm/s
        let (b, v, gap) = (4e-4, 4e-4, 2e-4);
        let (lead, error) = solved(b, v, gap);
        assert!(error.abs() < 1e-9 && lead > 0.0 && lead < PI, "{lead}, {error}");
        let insert = |lead: f64| W * duration(distance(R, b, lead, gap, 0.0), v, A);
        let mut blind = lead + 1e-3;
        (0..200).for_each(|_| blind = insert(blind));
        assert!((blind - lead).abs() > 0.1, "blind iteration ends at {blind}");
    }

    #[test]
    fn no_earlier_angle_solves_it() {
        let (b, v, gap) = (3e-3, 3.5e-3, 5e-4);
        let (lead, _) = solved(b, v, gap);
        for k in 0..1000 {
            let earlier = lead * f64::from(k) / 1001.0;
            assert!(earlier < W * duration(distance(R, b, earlier, gap, 0.0), v, A));
        }
    }

    #[test]
    fn a_spindle_at_rest_needs_no_lead() {
        assert_eq!(lead_angle(0.0, |_| 1.0), 0.0);
        assert_eq!(lead_angle(W, |_| 0.0), 0.0);
    }
}
