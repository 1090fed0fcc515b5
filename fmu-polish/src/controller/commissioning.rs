//! The state `Commission` in one control step: monitors, motion and measurements.

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
    /// Replaces parameters by the results of a commissioning run with `commission.apply`, and sets the half period of
    /// the sweep; called before each sample.
    pub fn bring_into_force(&mut self, p: &mut Parameters) {
        p.stick_slip.half_period = self.half_period;
        self.identification.put(p);
        p.stick_slip.half_period += self.sliding.lengthened;
    }

    /// Writes the derived parameters of the last good commissioning run into the file `commission.export`.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn export(&self, p: &Parameters) -> Result<(), ParameterError> {
        export_commission(&p.commission.export, &self.identification.derived())
    }

    /// The state; during a commissioning run the state of a cycle with the same monitors.
    pub(super) fn role(&self) -> State {
        if self.state == State::Commission { self.identification.experiment.like() } else { self.state }
    }

    /// Samples and travel (m) since this part of the commissioning run, or the state, began.
    pub(super) fn progress(&self) -> (u32, f64) {
        let experiment = &self.identification.experiment;
        if self.state == State::Commission {
            (experiment.ticks, experiment.travelled)
        } else {
            (self.ticks, self.travelled)
        }
    }

    /// Starts a commissioning run, at rest.
    pub(super) fn commission(&mut self, p: &Parameters, reading: &Reading) {
        self.restart(p, reading, plan::time(p));
        self.contact = ContactMonitor::default();
        self.identification.begin(p);
    }

    /// Aborts the run on request, and continues after the zero of the sensor.
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
        self.distance = parts.tangential.hypot(parts.stick_slip) * p.sample_period;
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
