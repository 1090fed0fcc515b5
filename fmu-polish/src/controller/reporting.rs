//! The outputs of a sample.

use control_blocks::Reaction;

use super::touching;
use crate::controller::Controller;
use crate::force::contact::Measurement;
use crate::interface::{ForceOutput, MisalignmentOutput, Output, Parameters, SlidingOutput, State};
use crate::monitoring::numbers::Numbers;
use crate::motion::velocity::VelocityParts;

impl Controller {
    /// Sends the pulses and sets all outputs.
    pub(super) fn report(&mut self, p: &Parameters, now: &Measurement, parts: &VelocityParts) -> Output {
        let velocity = parts.sum(&now.frame, p.velocity_max);
        let pulses = self.remainder.step(p, &velocity);
        self.axes.send(p, &pulses);
        let (shift, rotation) = (self.normal.misalignment.shift(), self.normal.misalignment.rotation());
        Output {
            velocity: parts.report(&velocity),
            pulses: pulses.into(),
            counts: self.remainder.counts().into(),
            force: ForceOutput {
                measured: now.force.controlled,
                setpoint: self.setpoint,
                error: self.setpoint - now.force.controlled,
            },
            desired: now.frame.centre.into(),
            normal: now.frame.normal.into(),
            tangent: now.frame.tangent.into(),
            error: now.error,
            following: self.axes.errors().into(),
            progress: (self.path_position.s / self.path.length()).min(1.0),
            state: self.state,
            fault: self.fault,
            drive_enable: self.state != State::Fault || self.fault.reaction() != Reaction::DriveOff,
            in_contact: self.role().pressing() && touching(p, now),
            done: self.state == State::Done && self.path_position.s >= self.path.length(),
            stiffness_estimate: self.normal.stiffness,
            sliding: SlidingOutput {
                speed: self.sliding.speed.unwrap_or(0.0),
                friction: self.sliding.friction,
                added: self.sliding.added,
                lengthened: self.sliding.lengthened,
            },
            misalignment: MisalignmentOutput { shift: shift.into(), rx: rotation.x, ry: rotation.y, rz: rotation.z },
            ripple_stopped: self.normal.ripple.stopped() || self.normal.repetitive.stopped(),
            path_length: self.path.length(),
            measured: self.identification.measured,
            numbers: self.numbers(p, now),
        }
    }

    fn numbers(&self, p: &Parameters, now: &Measurement) -> Numbers {
        let (time, time_limit) = self.time.seconds(p);
        Numbers {
            ratio: self.axes.motion_ratio(p),
            time,
            time_limit,
            norm: now.force.norm,
            zero: self.sensor.zero().norm(),
            angle: self.contact.angle(&now.frame.normal),
            surface: now.surface,
            noise: self.force.noise(),
            force_error: self.force.error(p),
        }
    }
}
