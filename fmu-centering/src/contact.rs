//! Kinematics of a push: where the ring must be when the pusher meets it, so that the push ends at the centre.
//!
//! World frame, pusher from +x. While it is pushed the ring slips over the table along the force that moves it, the
//! normal force and the friction of the pusher, which drags against the rotation:
//!
//! ```text
//! c' = omega z x c + lambda (-x - sign(omega) mu y),   lambda >= 0,   c_x + sqrt(r^2 - c_y^2) = r + d(t)
//! ```
//!
//! d is how far the pusher is from the end of its stroke. It is integrated backwards from the centre.

use nalgebra::Vector2;

/// Steps of the integration for one radian of the spindle or one stroke.
const STEPS: u32 = 64;

/// End of a stroke: constant velocity, then a constant deceleration to rest at d = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finish {
    /// Velocity at contact, m/s.
    pub velocity: f64,
    /// Deceleration, m/s2.
    pub deceleration: f64,
}

impl Finish {
    /// Distance (m) from the end and velocity (m/s) at `time` s before the end.
    pub fn at(&self, time: f64) -> (f64, f64) {
        let braking = self.velocity / self.deceleration;
        if time <= braking {
            return (0.5 * self.deceleration * time * time, self.deceleration * time);
        }
        (self.velocity * (time - 0.5 * braking), self.velocity)
    }

    /// Time before the end (s) at which the distance is `d` (m).
    pub fn time(&self, d: f64) -> f64 {
        let braking = self.velocity / self.deceleration;
        if d <= 0.5 * self.velocity * braking {
            return (2.0 * d / self.deceleration).sqrt();
        }
        d / self.velocity + 0.5 * braking
    }
}

/// Where and when the pusher meets the ring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    /// Centre of the ring in the world frame, m.
    pub centre: Vector2<f64>,
    /// Time before the end of the stroke, s.
    pub time: f64,
}

/// What the push does to a ring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Radius of the ring, m.
    pub radius: f64,
    /// Speed of the spindle, rad/s, signed.
    pub speed: f64,
    /// Lateral ratio mu: slip across the push over slip along it.
    pub lateral: f64,
}

impl Contact {
    /// The meeting at the eccentricity (m) from which the stroke ends with the ring at the centre.
    pub fn meeting(&self, eccentricity: f64, finish: &Finish) -> Meeting {
        // the ring approaches the pusher or flees it by at most omega e, so the stroke alone is a good scale
        let step = finish.time(eccentricity) / f64::from(STEPS);
        let mut y = 0.0;
        let mut before = Meeting { centre: Vector2::zeros(), time: 0.0 };
        for k in 1..=8 * STEPS {
            let time = f64::from(k) * step;
            let half = y - 0.5 * step * self.lateral_velocity(y, time - step, finish);
            y -= step * self.lateral_velocity(half, time - 0.5 * step, finish);
            let now = Meeting { centre: Vector2::new(self.along(y, finish.at(time).0), y), time };
            if now.centre.norm() >= eccentricity {
                return between(&before, &now, eccentricity);
            }
            before = now;
        }
        before
    }

    /// c_x with the ring at the pusher.
    fn along(&self, y: f64, d: f64) -> f64 {
        d + self.radius - (self.radius * self.radius - y * y).max(0.0).sqrt()
    }

    /// c_y' at `time` s before the end.
    fn lateral_velocity(&self, y: f64, time: f64, finish: &Finish) -> f64 {
        let (d, v) = finish.at(time);
        let drag = self.speed.signum() * self.lateral;
        let slope = y / (self.radius * self.radius - y * y).max(self.radius * self.radius * 0.01).sqrt();
        // lambda = v - slope c_y' - omega c_y, and none at all if the ring flees the pusher
        let pushed = (self.speed * self.along(y, d) - drag * (v - self.speed * y)) / (1.0 - drag * slope);
        let lambda = v - slope * pushed - self.speed * y;
        if lambda > 0.0 { pushed } else { self.speed * self.along(y, d) }
    }
}

/// Linear interpolation to the eccentricity.
fn between(a: &Meeting, b: &Meeting, eccentricity: f64) -> Meeting {
    let (ra, rb) = (a.centre.norm(), b.centre.norm());
    let share = if rb > ra { (eccentricity - ra) / (rb - ra) } else { 1.0 };
    Meeting { centre: a.centre.lerp(&b.centre, share), time: a.time + share * (b.time - a.time) }
}
