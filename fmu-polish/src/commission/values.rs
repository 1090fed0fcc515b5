//! The parameters that a commission derives, and how.

use std::f64::consts::PI;

use control_blocks::DELAY_MAX;
use serde::{Deserialize, Serialize};

use crate::commission::plan::RATIO_MAX;
use crate::force::response::axis;
use crate::interface::{Drive, Measured, Mode, Parameters};
use crate::motion::sliding::highest;

/// All parameters that a commission derives.
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
    pub fn put(&self, p: &mut Parameters, known: &[Self; 2]) {
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

    /// What follows from a measurement, from these that were told.
    pub fn derived(self, p: &Parameters, m: &Measured) -> Self {
        let drive = self.drive.faster(m.drive_gain, m.feedforward.clamp(0.0, 1.0));
        Self {
            stiffness: m.stiffness,
            // the same gain of the loop
            damping: self.damping * m.stiffness / self.stiffness,
            drive,
            io_delay: (m.io_delay.round() as i32).clamp(0, DELAY_MAX as i32),
            sensor_rotation: m.sensor_rotation,
            sensor_direction_y: m.sensor_direction_y,
            sensor_direction_z: m.sensor_direction_z,
            stick_slip_velocity: self.stick_slip(p, &drive, m),
        }
    }

    /// K_v (m/s) with which the ball slides as fast as the told axes move: on every half period the tip bends to and fro by the
    /// friction before it does, and the axes follow as they do.
    fn stick_slip(&self, p: &Parameters, drive: &Drive, m: &Measured) -> f64 {
        let (told, half) = (self.stick_slip_velocity, f64::from(p.stick_slip.half_period) * p.sample_period);
        if p.stick_slip.mode == Mode::Off || p.stick_slip.ratio > 0.0 || told == 0.0 {
            return told;
        }
        let follows = |drive: &Drive| axis(drive, PI / half).norm();
        let bent = 2.0 * m.friction * p.force.target / m.lateral_stiffness;
        ((follows(&self.drive) * told + bent / half) / follows(drive)).min(highest(p).max(told))
    }
}

/// Whether a measurement is sure enough, and of a machine that this controller can hold: `told` is what it took it for.
pub fn acceptable(p: &Parameters, told: &Values, m: &Measured) -> bool {
    let sure = |value: f64, deviation: f64| value > 0.0 && deviation <= p.commission.deviation_max * value;
    let near = |ratio: f64| (RATIO_MAX.recip()..=RATIO_MAX).contains(&ratio);
    let contact = [
        (m.stiffness, m.stiffness_deviation),
        (m.friction, m.friction_deviation),
        (m.lateral_stiffness, m.lateral_stiffness_deviation),
    ];
    contact.iter().all(|(value, deviation)| sure(*value, *deviation))
        && near(m.stiffness / told.stiffness)
        && sure(m.drive_gain, m.drive_gain_deviation)
        && near(m.drive_gain)
        && m.feedforward_deviation <= p.commission.deviation_max
        && m.io_delay_deviation <= p.commission.delay_deviation_max
        && (-0.5..DELAY_MAX as f64 + 0.5).contains(&m.io_delay)
        && m.sensor_rotation_deviation <= p.commission.deviation_max
}
