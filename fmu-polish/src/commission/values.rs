//! The parameters that a commissioning run derives, and their derivation.

use std::f64::consts::PI;

use control_blocks::{DELAY_MAX, RATIO_MAX, is_certain, whole_delay, within_factor};
use serde::{Deserialize, Serialize};

use crate::commission::response::GUIDES;
use crate::force::response::axis;
use crate::interface::{Drive, Measured, Mode, Parameters};
use crate::motion::sweep_limits::highest;

/// All parameters that a commissioning run derives.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Values {
    /// `stiffness.nominal`, N/m.
    pub stiffness: f64,
    damping: f64,
    /// Loops of the drives.
    pub drive: Drive,
    io_delay: i32,
    sensor_rotation: f64,
    sensor_direction_y: i32,
    /// `sensor.direction.z`.
    pub sensor_direction_z: i32,
    stick_slip_velocity: f64,
}

impl Values {
    /// Those of the parameters.
    pub fn of(p: &Parameters) -> Self {
        Self {
            stiffness: p.stiffness_nominal,
            damping: p.impedance.damping,
            drive: p.drive,
            io_delay: p.io_delay,
            sensor_rotation: p.sensor_rotation,
            sensor_direction_y: p.sensor_direction_y,
            sensor_direction_z: p.sensor_direction_z,
            stick_slip_velocity: p.stick_slip.velocity,
        }
    }

    /// Puts them into the parameters; a tunable one that is none of `known` was tuned meanwhile, and that counts.
    pub fn put(&self, p: &mut Parameters, known: [Self; 2]) {
        p.stiffness_nominal = self.stiffness;
        p.drive = self.drive;
        p.io_delay = self.io_delay;
        p.sensor_rotation = self.sensor_rotation;
        p.sensor_direction_y = self.sensor_direction_y;
        p.sensor_direction_z = self.sensor_direction_z;
        if known.iter().any(|one| one.damping == p.impedance.damping) {
            p.impedance.damping = self.damping;
        }
        if known.iter().any(|one| one.stick_slip_velocity == p.stick_slip.velocity) {
            p.stick_slip.velocity = self.stick_slip_velocity;
        }
    }

    /// Their names and values.
    pub fn entries(&self) -> [(&'static str, f64); 10] {
        [
            ("stiffness.nominal", self.stiffness),
            ("impedance.damping", self.damping),
            ("drive.position_gain", self.drive.position_gain),
            ("drive.feedforward", self.drive.feedforward),
            ("drive.velocity_bandwidth", self.drive.velocity_bandwidth),
            ("io_delay", f64::from(self.io_delay)),
            ("sensor.rotation", self.sensor_rotation),
            ("sensor.direction.y", f64::from(self.sensor_direction_y)),
            ("sensor.direction.z", f64::from(self.sensor_direction_z)),
            ("stick_slip.velocity", self.stick_slip_velocity),
        ]
    }

    /// With the z of the sensor the other way.
    pub fn rotated(self) -> Self {
        Self { sensor_direction_z: -self.sensor_direction_z, ..self }
    }

    /// The values that follow from a measurement and these configured values.
    pub fn derived(self, p: &Parameters, m: &Measured) -> Self {
        let drive = self.drive.faster(m.drive_gain, m.feedforward.clamp(0.0, 1.0));
        Self {
            stiffness: m.stiffness,
            // the same gain of the loop
            damping: self.damping * m.stiffness / self.stiffness,
            drive,
            io_delay: whole_delay(m.io_delay),
            sensor_rotation: m.sensor_rotation,
            sensor_direction_y: m.sensor_direction_y,
            sensor_direction_z: m.sensor_direction_z,
            stick_slip_velocity: self.stick_slip(p, &drive, m),
        }
    }

    /// K_v (m/s) with which the ball slides as fast as the nominal axes move: on every half period the tip bends back
    /// and forth by the friction first; on a circle the bend is orthogonal to the motion of the ball. The drives of the
    /// machine reduce the motion.
    fn stick_slip(&self, p: &Parameters, drive: &Drive, m: &Measured) -> f64 {
        let (nominal, half) = (self.stick_slip_velocity, f64::from(p.stick_slip.half_period) * p.sample_period);
        if p.stick_slip.mode == Mode::Off || p.stick_slip.ratio > 0.0 || nominal == 0.0 {
            return nominal;
        }
        let follows = |drive: &Drive| axis(drive, PI / half).norm();
        let bent = 2.0 * m.friction * p.force.target / m.lateral_stiffness;
        let (slides, bends) = (follows(&self.drive) * nominal, bent / half);
        let moved = match p.stick_slip.mode {
            Mode::Circular => slides.hypot(bends),
            _ => slides + bends,
        };
        (moved / follows(drive)).min(highest(p).max(nominal))
    }
}

/// Whether the measurement is certain enough and within the range of this controller, with the configured values
/// `nominal`. The uncertainty of the drives due to guide friction rejects nothing: they are identified and used with
/// that friction.
pub fn acceptable(p: &Parameters, nominal: &Values, m: &Measured) -> bool {
    let ratio = p.commission.std_max;
    let contact =
        [(m.stiffness, m.stiffness_std), (m.friction, m.friction_std), (m.lateral_stiffness, m.lateral_stiffness_std)];
    contact.iter().all(|(value, deviation)| *value > 0.0 && is_certain(*value, *deviation, ratio))
        && within_factor(m.stiffness, nominal.stiffness, RATIO_MAX)
        && is_certain(m.drive_gain, m.drive_gain_std, ratio.hypot(GUIDES[0]))
        && within_factor(m.drive_gain, 1.0, RATIO_MAX)
        && m.feedforward_std <= ratio.hypot(GUIDES[1])
        && m.io_delay_std <= p.commission.delay_std_max
        && (0..=DELAY_MAX as i32).contains(&whole_delay(m.io_delay))
        && m.sensor_rotation.is_finite()
        && m.sensor_rotation_std <= ratio
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A good measurement of a robot that is softer and slower than configured.
    const GOOD: Measured = Measured {
        stiffness: 142.4e3,
        stiffness_std: 1e3,
        lateral_stiffness: 100e3,
        lateral_stiffness_std: 2e3,
        friction: 0.2,
        friction_std: 0.001,
        drive_gain: 0.8,
        drive_gain_std: 0.004,
        feedforward: 1.02,
        feedforward_std: 0.002,
        io_delay: 1.7,
        io_delay_std: 0.01,
        sensor_rotation: 0.3,
        sensor_rotation_std: 0.001,
        sensor_direction_y: -1,
        sensor_direction_z: 1,
        ..Measured::START
    };

    fn derived(p: &Parameters, m: &Measured) -> Parameters {
        let (mut found, nominal) = (p.clone(), Values::of(p));
        nominal.derived(p, m).put(&mut found, [nominal, nominal]);
        found
    }

    #[test]
    fn what_is_put_is_what_was_taken() {
        let (mut p, nominal) = (Parameters::START, Values::of(&Parameters::START));
        nominal.put(&mut p, [nominal, nominal]);
        assert_eq!(p, Parameters::START);
        let values = nominal.derived(&p, &GOOD);
        values.put(&mut p, [nominal, nominal]);
        assert_eq!(Values::of(&p), values);
        assert_eq!((p.stiffness_nominal, p.impedance.damping, p.io_delay), (142.4e3, 8e3, 2));
        assert_eq!((p.drive.position_gain, p.drive.velocity_bandwidth, p.drive.feedforward), (64.0, 400.0, 1.0));
        assert_eq!((p.sensor_rotation, p.sensor_direction_y, p.sensor_direction_z), (0.3, -1, 1));
        let names = values.entries().map(|(name, _)| name);
        assert!(names.contains(&"stick_slip.velocity") && names.contains(&"sensor.direction.y"));
    }

    #[test]
    fn what_was_tuned_meanwhile_counts() {
        let nominal = Values::of(&Parameters::START);
        let values = nominal.derived(&Parameters::START, &GOOD);
        let mut p = Parameters::START;
        (p.impedance.damping, p.stick_slip.velocity) = (7e3, 9e-3);
        values.put(&mut p, [nominal, nominal]);
        assert_eq!((p.impedance.damping, p.stick_slip.velocity, p.stiffness_nominal), (7e3, 9e-3, 142.4e3));
        // restores the configured values from the values in use
        let tuned = Values::of(&p);
        values.put(&mut p, [tuned, nominal]);
        assert_eq!(p.impedance.damping, values.damping);
        nominal.put(&mut p, [nominal, values]);
        assert_eq!(p, Parameters::START);
    }

    #[test]
    fn the_ball_slides_as_fast_as_the_commanded_axes_move() {
        let p = Parameters::START;
        let nominal = Measured { drive_gain: 1.0, feedforward: 0.8, lateral_stiffness: 1e15, ..GOOD };
        assert!((derived(&p, &nominal).stick_slip.velocity / 10e-3 - 1.0).abs() < 1e-9);
        // 10 um to each side in 10 ms
        let soft = derived(&p, &Measured { lateral_stiffness: 100e3, ..nominal });
        let more = 2.0 * 10e-6 / 10e-3 / axis(&p.drive, 314.159).norm();
        assert!((soft.stick_slip.velocity - 10e-3 - more).abs() < 1e-8, "{}", soft.stick_slip.velocity);
        // never more than it may be raised to
        assert_eq!(derived(&p, &Measured { lateral_stiffness: 5e3, ..nominal }).stick_slip.velocity, 20e-3);
        // on a circle the bend is square to the way: (10 mm/s)^2 + (2 mm/s)^2
        let mut round = p.clone();
        round.stick_slip.mode = Mode::Circular;
        let velocity = derived(&round, &Measured { lateral_stiffness: 100e3, ..nominal }).stick_slip.velocity;
        let bends = 2e-3 / axis(&p.drive, 314.159).norm();
        assert!((velocity - 10e-3f64.hypot(bends)).abs() < 1e-8, "{velocity}");
        let slow = Measured { drive_gain: 0.6, feedforward: 0.6, ..nominal };
        assert!(derived(&p, &slow).stick_slip.velocity > 11e-3);
        let changes: [fn(&mut Parameters); 3] =
            [|p| p.stick_slip.mode = Mode::Off, |p| p.stick_slip.ratio = 5.0, |p| p.stick_slip.velocity = 0.0];
        for change in changes {
            let mut p = Parameters::START;
            change(&mut p);
            assert_eq!(derived(&p, &GOOD).stick_slip.velocity, p.stick_slip.velocity);
        }
    }

    #[test]
    fn each_limit_of_a_measurement_is_the_last_value_that_is_accepted() {
        let p = Parameters::START;
        type Set = fn(&mut Measured, f64);
        let with = |set: Set, x: f64| {
            let mut m = GOOD;
            set(&mut m, x);
            acceptable(&p, &Values::of(&p), &m)
        };
        let limits: [(Set, f64, f64); 13] = [
            (|m, x| m.stiffness_std = x, 14.24e3, 14.25e3),
            (|m, x| m.stiffness = x, 356e3, 357e3),
            (|m, x| m.stiffness = x, 89e3, 88.9e3),
            (|m, x| m.lateral_stiffness_std = x, 10e3, 10.1e3),
            (|m, x| m.friction_std = x, 0.02, 0.0201),
            (|m, x| m.drive_gain_std = x, 0.1312, 0.1313),
            (|m, x| m.drive_gain = x, 2.0, 2.01),
            (|m, x| m.drive_gain = x, 0.5, 0.499),
            (|m, x| m.feedforward_std = x, 0.1414, 0.1415),
            (|m, x| m.io_delay_std = x, 0.25, 0.251),
            (|m, x| m.io_delay = x, -0.49, -0.5),
            (|m, x| m.io_delay = x, DELAY_MAX as f64 + 0.49, DELAY_MAX as f64 + 0.5),
            (|m, x| m.sensor_rotation_std = x, 0.1, 0.101),
        ];
        for (i, (set, last, first)) in limits.into_iter().enumerate() {
            assert_eq!((with(set, last), with(set, first)), (true, false), "{i}");
        }
        assert!(!acceptable(&p, &Values::of(&p), &Measured::START));
    }
}
