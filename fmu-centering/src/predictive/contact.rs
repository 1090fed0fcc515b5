//! Kinematics of a push: the ring position at contact from which the push ends at the center.
//!
//! World frame, pusher from +x. The ring turns with the table; while it is pushed, it slips over the table along the
//! force of the pusher, which acts along the normal and, by friction, against the turning surface:
//!
//! ```text
//! c' = omega z x c - lambda (x + tan(phi + sign(omega) atan(mu)) y),   lambda >= 0,   sin(phi) = -c_y / r
//! c_x + sqrt(r^2 - c_y^2) = r + d(t)                                   while they touch
//! ```
//!
//! d is the remaining stroke. It is integrated backwards from the center, where every good push ends; a pusher
//! that dwells does not center, since (0, c_y) slides in equilibrium.

use nalgebra::Vector2;

use crate::predictive::stroke::Finish;

/// Steps of the integration for the time that the stroke alone would take.
const STEPS: u32 = 64;

/// Position and time of the contact of pusher and ring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstContact {
    /// Center of the ring in the world frame, m.
    pub center: Vector2<f64>,
    /// Time before the end of the stroke, s.
    pub time: f64,
}

impl FirstContact {
    /// Direction of the center as seen from the axis, rad.
    pub fn direction(&self) -> f64 {
        self.center.y.atan2(self.center.x)
    }
}

/// Ring and pusher.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Radius of the ring, m.
    pub radius: f64,
    /// Speed of the spindle, rad/s, signed.
    pub speed: f64,
    /// Lateral ratio mu: slip of the ring across the push over slip along it, against the rotation.
    pub lateral: f64,
}

impl Contact {
    /// The contact at the eccentricity (m) from which a stroke with this finish ends at the center.
    pub fn meeting(&self, eccentricity: f64, finish: &Finish) -> FirstContact {
        let step = finish.time(eccentricity) / f64::from(STEPS);
        let mut before = FirstContact { center: Vector2::zeros(), time: 0.0 };
        // the ring flees a slow pusher; beyond four times the stroke there is no contact any more
        for k in 1..=4 * STEPS {
            let (time, y) = (f64::from(k) * step, before.center.y);
            let half = y - 0.5 * step * self.velocity_across(y, time - step, finish);
            let y = y - step * self.velocity_across(half, time - 0.5 * step, finish);
            let now = FirstContact { center: Vector2::new(self.along(y, finish.before(time).0), y), time };
            if now.center.norm() >= eccentricity {
                return between(&before, &now, eccentricity);
            }
            before = now;
        }
        before
    }

    /// The contact for a tap that moves the ring immediately.
    pub fn blow(&self, eccentricity: f64) -> FirstContact {
        let direction = self.speed.signum() * self.lateral.atan();
        let (sine, cosine) = direction.sin_cos();
        FirstContact { center: Vector2::new(cosine, sine) * eccentricity, time: 0.0 }
    }

    /// c_x while the ring touches the pusher, `d` m before its end.
    fn along(&self, y: f64, d: f64) -> f64 {
        d + self.radius - self.root(y)
    }

    /// c_y' at `time` s before the end.
    fn velocity_across(&self, y: f64, time: f64, finish: &Finish) -> f64 {
        let (d, v) = finish.before(time);
        let slope = y / self.root(y);
        let friction = self.speed.signum() * self.lateral;
        // tangent of a sum
        let drag = (friction - slope) / (1.0 + friction * slope);
        let carried = self.speed * self.along(y, d);
        // lambda = v - slope c_y' - omega c_y with c_y' = carried - drag lambda
        let slip = (v - slope * carried - self.speed * y) / (1.0 - slope * drag);
        carried - drag * slip.max(0.0)
    }

    /// Half of the chord at c_y, m.
    fn root(&self, y: f64) -> f64 {
        // far from the middle the circle is too steep for a push
        (self.radius.powi(2) - y * y).max(0.01 * self.radius.powi(2)).sqrt()
    }
}

/// Linear interpolation to the eccentricity.
fn between(a: &FirstContact, b: &FirstContact, eccentricity: f64) -> FirstContact {
    let (near, far) = (a.center.norm(), b.center.norm());
    let fraction = (eccentricity - near) / (far - near);
    FirstContact { center: a.center.lerp(&b.center, fraction), time: a.time + fraction * (b.time - a.time) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONTACT: Contact = Contact { radius: 0.05, speed: 2.094_395, lateral: 0.12 };

    #[test]
    fn a_short_push_leads_by_friction_and_rotation() {
        // to first order y = mu B - omega integral of d, here B T / 3
        for sign in [1.0, -1.0] {
            let contact = Contact { speed: sign * CONTACT.speed, ..CONTACT };
            let (b, duration) = (1e-5, 0.02);
            let meeting = contact.meeting(b, &Finish::braked(b, duration, 1.0));
            let expected = sign * (0.12 * b - CONTACT.speed * b * duration / 3.0);
            assert!((meeting.center.y - expected).abs() < 5e-3 * b, "{meeting:?}");
            assert!((meeting.center.norm() - b).abs() < 1e-12);
            assert!((meeting.time - duration).abs() < 0.02 * duration);
        }
    }

    #[test]
    fn forwards_in_time_the_ring_reaches_the_center() {
        for (eccentricity, duration, lateral) in [(5e-4, 0.08, 0.12), (3e-3, 0.2, 0.3), (0.02, 0.6, 0.05)] {
            let contact = Contact { lateral, ..CONTACT };
            let finish = Finish::braked(eccentricity, duration, 0.04);
            let meeting = contact.meeting(eccentricity, &finish);
            let (steps, mut y) = (100_000, meeting.center.y);
            let dt = meeting.time / f64::from(steps);
            for k in 0..steps {
                y += dt * contact.velocity_across(y, meeting.time - (f64::from(k) + 0.5) * dt, &finish);
            }
            assert!(y.abs() < 1e-4 * eccentricity, "{eccentricity}: {y}");
        }
    }

    #[test]
    fn the_other_direction_is_the_mirror() {
        let finish = Finish::braked(3e-3, 0.2, 0.04);
        let forth = CONTACT.meeting(3e-3, &finish);
        let back = Contact { speed: -CONTACT.speed, ..CONTACT }.meeting(3e-3, &finish);
        assert_eq!((forth.center.x, forth.center.y, forth.time), (back.center.x, -back.center.y, back.time));
    }

    #[test]
    fn a_blow_moves_against_the_rotation() {
        let meeting = CONTACT.blow(1e-5);
        assert!((meeting.direction().tan() - 0.12).abs() < 1e-12);
        assert!((meeting.center.norm() - 1e-5).abs() < 1e-18);
    }

    #[test]
    fn a_ring_that_flees_ends_the_search() {
        let finish = Finish { velocity: 1e-6, deceleration: 1e-6 };
        let meeting = CONTACT.meeting(0.02, &finish);
        assert!(meeting.center.iter().all(|x| x.is_finite()) && meeting.time.is_finite());
    }

    #[test]
    fn what_the_ring_does_across_is_in_balance_with_slip_and_friction() {
        let finish = Finish::braked(5e-4, 0.08, 0.04);
        for sign in [1.0, -1.0] {
            let contact = Contact { speed: sign * CONTACT.speed, ..CONTACT };
            for (y, time) in [(1e-5, 0.08), (-4e-3, 0.05), (6e-3, 0.03), (0.02, 0.001), (-0.03, 0.06)] {
                let across = contact.velocity_across(y, time, &finish);
                let (d, v) = finish.before(time);
                let x = contact.along(y, d);
                assert!((x + (0.05_f64.powi(2) - y * y).sqrt() - 0.05 - d).abs() < 1e-15);
                // c_x' of the ring that touches, and the slip along the push that this needs
                let along = -v + y / (0.05_f64.powi(2) - y * y).sqrt() * across;
                let slip = -contact.speed * y - along;
                let force = (-y / 0.05).asin() + sign * 0.12_f64.atan();
                let expected = contact.speed * x - slip.max(0.0) * force.tan();
                assert!((across - expected).abs() < 1e-12 + 1e-9 * expected.abs(), "{y} {time}: {across} {expected}");
            }
        }
    }

    #[test]
    fn between_two_positions_the_meeting_is_on_their_line() {
        let at = |x: f64, y: f64, time: f64| FirstContact { center: Vector2::new(x, y), time };
        let (near, far) = (at(3e-3, 4e-3, 0.1), at(6e-3, 8e-3, 0.2));
        let met = between(&near, &far, 7.5e-3);
        assert!((met.center - Vector2::new(4.5e-3, 6e-3)).norm() < 1e-15 && (met.time - 0.15).abs() < 1e-15);
        assert!((met.direction() - (4.0_f64 / 3.0).atan()).abs() < 1e-12);
    }
}
