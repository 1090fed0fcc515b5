//! The state `Commission` in a sample: how it is watched, what it moves, and what it learns.

use control_blocks::{ParameterError, export_commission};
use nalgebra::Vector3;

use crate::commission::experiment::Sample;
use crate::commission::plan;
use crate::controller::Controller;
use crate::force::contact::{ContactMonitor, Measurement};
use crate::force::orientation::Orientation;
use crate::interface::{Output, Parameters, State};
use crate::motion::velocity::VelocityParts;
use crate::reading::Reading;

impl Controller {
    /// Puts what a commission has measured into the parameters, where `commission.apply` says so, and the half period of the sweep; before each
    /// sample.
    pub fn bring_into_force(&mut self, p: &mut Parameters) {
        p.stick_slip.half_period = self.half_period;
        self.identification.put(p);
        p.stick_slip.half_period += self.sliding.lengthened;
    }

    /// Writes what the last good commission derives into the file `commission.export`.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn export(&self, p: &Parameters) -> Result<(), ParameterError> {
        export_commission(&p.commission.export, &self.identification.derived())
    }

    /// The state; of a commission that of a job which is watched alike.
    pub(super) fn role(&self) -> State {
        if self.state == State::Commission { self.identification.experiment.like() } else { self.state }
    }

    /// Samples and way (m) since this part of the commission, or the state, began.
    pub(super) fn progress(&self) -> (u32, f64) {
        let experiment = &self.identification.experiment;
        if self.state == State::Commission {
            (experiment.ticks, experiment.travelled)
        } else {
            (self.ticks, self.travelled)
        }
    }

    /// Begins a commission, at rest.
    pub(super) fn commission(&mut self, p: &Parameters, reading: &Reading) {
        self.restart(p, reading, plan::time(p));
        self.contact = ContactMonitor::default();
        self.identification.begin(p);
    }

    /// Breaks it off where that is asked for, and goes on from the zero of the sensor.
    pub(super) fn direct(&mut self, reading: &Reading, zero: Option<Vector3<f64>>) {
        if self.state != State::Commission {
            return;
        }
        if !reading.commission || reading.start {
            self.taring = false;
            self.identification.break_off();
        } else if zero.is_some() {
            self.identification.experiment.tared();
        }
    }

    /// The velocity of the experiment.
    pub(super) fn experiment(&mut self, p: &Parameters, now: &Measurement) -> VelocityParts {
        let parts = self.identification.experiment.act(p, now);
        self.setpoint = self.identification.experiment.setpoint;
        self.way = parts.tangential.hypot(parts.stick_slip) * p.sample_period;
        parts
    }

    /// Takes what this sample has read and sent.
    pub(super) fn learn(&mut self, p: &Parameters, reading: &Reading, now: &Measurement, output: &Output) {
        let pulses = Vector3::new(output.pulses.x, output.pulses.y, output.pulses.z);
        self.identification.observe(
            p,
            &Sample {
                shown: &Orientation::of(p).shown(&now.force.unfiltered),
                position: &reading.position,
                sent: &(pulses.map(f64::from) * (p.pulses_size / p.sample_period)),
                now,
                contact: &self.contact,
            },
        );
    }
}
