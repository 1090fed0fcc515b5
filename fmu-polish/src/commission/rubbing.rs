//! Friction, lateral stiffness and mounting of the sensor from a slow reciprocating motion across the normal, at a held
//! force.
//!
//! All vectors are in the axes of the sensor, since its mounting is unknown. The mean force of a period of the motion
//! is the normal force, since the friction changes its sign within the period. The lateral rest does the work W =
//! -sum(F dx), here a vector. It points in the direction in which the sensor measures the motion. With Q = -sum(|F| F
//! dx) the friction is |Q| / |W| (see `motion/sliding.rs`: a bend of the tip is reversible).
//!
//! After a reversal the ball sticks, and the force changes from one friction to the other with the stiffness of the
//! tip. The estimate is the slope in the middle of that travel, where the ball sticks according to the friction of the
//! previous periods.

use control_blocks::Welford;
use nalgebra::{Complex, Vector3};
use serde::{Deserialize, Serialize};

use crate::force::stiffness::Slope;
use crate::interface::Parameters;
use crate::motion::sensed_motion::{SensedMotion, sensed_noise};

/// Fraction of the friction up to which the slope is that of a ball that sticks.
const STICKS: f64 = 0.7;
/// A step of the encoder as noise, in steps.
const STEP_NOISE: f64 = 0.288_675_134_594_812_9;

/// Measurements of rubbing along one direction; empty by default.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Rubbing {
    motion: SensedMotion,
    /// mean force of the last period, N
    normal: Option<Vector3<f64>>,
    sum: Vector3<f64>,
    samples: u32,
    /// W (J) and Q (N J) of this period
    work: Vector3<f64>,
    weighted: Vector3<f64>,
    /// lines of the sticking ball of this period, forth and back
    lines: [Slope; 2],
    /// way since the turning point (m), and whether the ball still sticks
    travel: f64,
    sticks: bool,
    /// W of all periods, J
    pub direction: Vector3<f64>,
    /// friction, N
    sliding: Welford,
}

/// Results of pressing and rubbing; empty by default.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Found {
    /// Stiffness along the normal, N/m.
    pub stiffness: Welford,
    /// Friction coefficient.
    pub friction: Welford,
    /// Stiffness across the normal, N/m.
    pub lateral: Welford,
    /// Scatter of the directions, rad.
    pub angle: Welford,
}

impl Found {
    /// Adds the result of a period of rubbing.
    pub fn take(&mut self, period: &Period) {
        self.friction.push(period.friction);
        self.angle.push(period.angle);
        if let Some(stiffness) = period.stiffness {
            self.lateral.push(stiffness);
        }
    }
}

/// Result of a period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Period {
    /// Friction over normal force.
    pub friction: f64,
    /// Stiffness of the tip across the normal, N/m, where the ball has stuck.
    pub stiffness: Option<f64>,
    /// Its direction in the plane of the sensor, as angle from that of all periods so far, rad.
    pub angle: f64,
}

impl Rubbing {
    /// Takes the force (N) that the sensor shows and the position (m), in a motion along the unit vector `along`, now
    /// `forth` or back.
    pub fn take(
        &mut self,
        p: &Parameters,
        force: &Vector3<f64>,
        position: &Vector3<f64>,
        along: &Vector3<f64>,
        forth: bool,
    ) {
        self.sum += force;
        self.samples += 1;
        let Some((mean, sensed)) = self.motion.step(p, force, position) else { return };
        let Some(normal) = self.normal else { return };
        let unit = normal.normalize();
        let (across, travel) = (mean - unit * unit.dot(&mean), sensed.dot(along));
        let work = -across * travel;
        self.work += work;
        self.weighted += across.norm() * work;
        self.stick(&across, travel, forth);
    }

    /// Takes the lateral force (N) over the travel (m) while the ball sticks.
    fn stick(&mut self, across: &Vector3<f64>, travel: f64, forth: bool) {
        let sign = if forth { 1.0 } else { -1.0 };
        self.travel += sign * travel;
        let (friction, length) = (self.sliding.mean(), self.direction.norm());
        if friction <= 0.0 || length <= 0.0 {
            return;
        }
        // against the motion once it slides
        let against = -sign * across.dot(&self.direction) / length;
        self.sticks &= against < STICKS * friction;
        if self.sticks && against > -STICKS * friction {
            self.lines[usize::from(forth)].take(self.travel, against);
        }
    }

    /// The motion turns round.
    pub fn reverse(&mut self) {
        (self.travel, self.sticks) = (0.0, true);
    }

    /// Ends a period: its result, except for the first.
    pub fn close(&mut self, p: &Parameters) -> Option<Period> {
        let found = self.normal.and_then(|normal| self.conclude(p, normal.norm()));
        self.normal = Some(self.sum / f64::from(self.samples.max(1)));
        (self.sum, self.samples, self.work, self.weighted, self.lines) = Default::default();
        found
    }

    fn conclude(&mut self, p: &Parameters, normal: f64) -> Option<Period> {
        let work = self.work.norm();
        if work == 0.0 || normal == 0.0 {
            return None;
        }
        let friction = self.weighted.norm() / work;
        self.sliding.push(friction);
        self.direction += self.work;
        let stiffness = Slope::common(&self.lines, STEP_NOISE * p.encoder_resolution * sensed_noise(p));
        let angle = (plane(&self.work) * plane(&self.direction).conj()).arg();
        Some(Period { friction: friction / normal, stiffness, angle })
    }
}

/// The part in the plane across z.
pub fn plane(v: &Vector3<f64>) -> Complex<f64> {
    Complex::new(v.x, v.y)
}

/// How the sensor is mounted, from the directions that it shows of motions along the unit vectors `along`: angle about
/// z (rad), and -1 where its y counts the other way. It shows e exp(-j a) of a direction e, or the conjugate of that.
pub fn mounting(shown: [&Vector3<f64>; 2], along: [&Vector3<f64>; 2]) -> (f64, i32) {
    let ([a, b], [e, f]) = (shown.map(plane), along.map(plane));
    let mirrored = (a.conj() * b).im * (e.conj() * f).im < 0.0;
    let rotated = |shown: Complex<f64>, along: Complex<f64>| along * if mirrored { shown } else { shown.conj() };
    ((rotated(a, e) / a.norm() + rotated(b, f) / b.norm()).arg(), if mirrored { -1 } else { 1 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::force::orientation::Orientation;
    use control_blocks::Welford;

    const QUARTER: u32 = 100;

    /// Result of reciprocating rubbing by 50 um along `along` with a tip of `stiffness` N/m that slides at `friction` N
    /// under 5 N along `normal`, as measured by the sensor of the parameters with its lag: friction, stiffness, and the
    /// direction.
    fn rubbed(
        p: &Parameters,
        stiffness: f64,
        friction: f64,
        along: &Vector3<f64>,
        normal: &Vector3<f64>,
    ) -> ([Welford; 2], Vector3<f64>) {
        const FINE: u32 = 50;
        let (mut rubbing, mut found) = (Rubbing::default(), [Welford::default(); 2]);
        let (mut bend, mut sensed, mut x) = (0.0f64, Vector3::zeros(), 0.3e-6);
        for k in 0..7 * 4 * QUARTER {
            let forth = !matches!(k / QUARTER % 4, 1 | 2);
            if matches!(k % (4 * QUARTER), QUARTER) || k % (4 * QUARTER) == 3 * QUARTER {
                rubbing.reverse();
            }
            let reading = (along * x).map(|x| (x * 1e6).round() * 1e-6);
            rubbing.take(p, &Orientation::of(p).shown(&sensed), &reading, along, forth);
            let travel = if forth { 0.5e-6 } else { -0.5e-6 } / f64::from(FINE);
            for _ in 0..FINE {
                x += travel;
                bend = (bend - travel).clamp(-friction / stiffness, friction / stiffness);
                let force = 5.0 * normal + along * (bend * stiffness);
                sensed += (force - sensed) * (p.sample_period / f64::from(FINE) * p.sensor_bandwidth);
            }
            if (k + 1).is_multiple_of(4 * QUARTER)
                && let Some(period) = rubbing.close(p)
            {
                found[0].push(period.friction);
                assert!(period.angle.abs() < 1e-3);
                period.stiffness.into_iter().for_each(|stiffness| found[1].push(stiffness));
            }
        }
        (found, rubbing.direction)
    }

    #[test]
    fn friction_and_stiffness_are_identified_with_any_mounting() {
        let p =
            Parameters { sensor_rotation: 2.0, sensor_direction_y: -1, sensor_direction_z: -1, ..Parameters::START };
        let (along, normal) = (Vector3::new(0.6, 0.0, 0.8), Vector3::new(-0.8, 0.0, 0.6));
        for (p, along, normal) in [(&Parameters::START, Vector3::x(), Vector3::z()), (&p, along, normal)] {
            for (stiffness, friction) in [(209e3, 1.0), (100e3, 1.3), (300e3, 0.7)] {
                let ([mu, tip], _) = rubbed(p, stiffness, friction, &along, &normal);
                assert_eq!((mu.count(), tip.count()), (6.0, 5.0));
                assert!((mu.mean() / (friction / 5.0) - 1.0).abs() < 0.01, "{stiffness} {friction}: {mu:?}");
                assert!((tip.mean() / stiffness - 1.0).abs() < 0.05, "{stiffness} {friction}: {tip:?}");
            }
        }
    }

    #[test]
    fn a_ball_that_never_slides_shows_no_stiffness_of_sticking() {
        let ([_, tip], _) = rubbed(&Parameters::START, 10e3, 3.0, &Vector3::x(), &Vector3::z());
        assert!(tip.count() == 0.0 || tip.mean() < 20e3, "{tip:?}");
    }

    #[test]
    fn two_directions_that_disagree_count_the_same_however_strongly_each_is_sensed() {
        let shown = |angle: f64, size: f64| size * Vector3::new(angle.cos(), -angle.sin(), 0.0);
        for size in [0.2, 1.0, 30.0] {
            // the second is rotated by a quarter of a revolution
            let second = shown(0.4 - std::f64::consts::FRAC_PI_2, 2.0);
            let (angle, direction) = mounting([&shown(0.2, size), &second], [&Vector3::x(), &Vector3::y()]);
            assert!((angle - 0.3).abs() < 1e-12 && direction == 1, "{size}: {angle} {direction}");
        }
    }

    #[test]
    fn every_mounting_is_found_from_two_directions() {
        let along = [Vector3::new(0.6, 0.8, 0.0), Vector3::new(-0.8, 0.6, 0.0)];
        for (rotation, y) in [(0.0, 1), (0.5, 1), (-0.5, -1), (3.0, -1), (-2.0, 1)] {
            let p = Parameters { sensor_rotation: rotation, sensor_direction_y: y, ..Parameters::START };
            let shown = along.map(|along| rubbed(&p, 209e3, 1.0, &along, &Vector3::z()).1);
            let (angle, direction) = mounting([&shown[0], &shown[1]], [&along[0], &along[1]]);
            assert!((angle - rotation).abs() < 1e-3 && direction == y, "{rotation} {y}: {angle} {direction}");
        }
    }
}
