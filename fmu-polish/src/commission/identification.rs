//! The commissioning run as the controller uses it: its motion, its results, and the values in use.

use control_blocks::{ActiveValues, Welford};
use serde::{Deserialize, Serialize};

use crate::check::check;
use crate::commission::experiment::{Experiment, Milestone, Sample};
use crate::commission::response::{GUIDES, response};
use crate::commission::rubbing::mounting;
use crate::commission::values::{Values, acceptable};
use crate::interface::{Measured, Parameters};

/// Standard deviations of the model errors, in addition to the scatter: relative for stiffness, friction and lateral
/// stiffness, rad for the angle. All are roots of the mean square of the errors of robots within 30 %, without noise.
/// The slope of a ramp of the force has a part of the lags of sensor and axes, and a tip that is pressed slides. Noise
/// makes |F| larger, by 1.5 of its square over that of the friction. While the ball sticks, it creeps. The friction of
/// the guides and the lag of the axes turn the work of rubbing.
const LEFT_OUT: [f64; 4] = [0.016, 0.012, 0.024, 0.008];
/// Minimum number of samples for a standard deviation.
const SAMPLES_MIN: f64 = 4.0;

/// Consecutive commissioning runs.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Identification {
    /// The present or last experiment.
    pub experiment: Experiment,
    /// Results of the last commissioning run with their standard deviations; start values until all is measured.
    pub measured: Measured,
    /// The result cannot be used.
    pub rejected: bool,
    /// All is measured and accepted so far; the tool retracts.
    pub complete: bool,
    values: ActiveValues<Values>,
    /// values in use in the last sample
    before: Values,
}

impl Identification {
    /// Nothing measured so far.
    pub fn new(p: &Parameters) -> Self {
        let nominal = Values::of(p);
        Self {
            experiment: Experiment::new(p),
            measured: Measured::START,
            rejected: false,
            complete: false,
            values: ActiveValues::new(nominal),
            before: nominal,
        }
    }

    /// Begins at rest, with what is in force.
    pub fn begin(&mut self, p: &Parameters) {
        self.experiment = Experiment::new(p);
        (self.measured, self.rejected, self.complete) = (Measured::START, false, false);
    }

    /// Leaves the mold in order, before its end.
    pub fn break_off(&mut self) {
        self.experiment.leave();
        self.complete = false;
    }

    /// The tool is retracted: without a good result the configured values are restored.
    pub fn end(&mut self) {
        if !self.measured.valid {
            self.values.restore();
        }
    }

    /// Replaces the parameters by the values in use. Newly derived values are used only if all parameters fit each other,
    /// then also for the retract: the mounting of the sensor is known.
    pub fn put(&mut self, p: &mut Parameters) {
        if let Some(derived) = self.values.take_proposed() {
            self.put_values(p, derived);
            self.complete = check(p).is_ok();
            self.rejected = !self.complete;
            if self.complete {
                self.values.conclude(derived, true);
            }
        }
        self.put_values(p, self.values.now());
    }

    fn put_values(&mut self, p: &mut Parameters, values: Values) {
        values.put(p, [self.values.configured(), self.before]);
        self.before = values;
    }

    /// Names and values of the parameters that a good commissioning run derives.
    pub fn derived(&self) -> [(&'static str, f64); 10] {
        self.values.derived().entries()
    }

    /// Takes what this sample has read and sent.
    pub fn observe(&mut self, p: &Parameters, sample: &Sample) {
        match self.experiment.observe(p, sample) {
            Milestone::None => {}
            Milestone::Touched => {
                // what is pressed on the mold pushes back
                if sample.contact.pulls(&sample.now.frame.normal) {
                    self.values.bring(self.values.now().rotated());
                }
            }
            Milestone::Measured => self.identify(p, sample),
            Milestone::Over => self.finish(p),
        }
    }

    fn identify(&mut self, p: &Parameters, sample: &Sample) {
        let Experiment { plan, spectra, found, rubbing, .. } = &self.experiment;
        let frame = &sample.now.frame;
        let crosswise = frame.normal.cross(&frame.tangent);
        let shown = [&rubbing[0].direction, &rubbing[1].direction];
        let (rotation, direction) = mounting(shown, [&frame.tangent, &crosswise]);
        let [stiffness, friction, lateral, angle] =
            [found.stiffness, found.friction, found.lateral, found.angle].map(|scatter| measure(&scatter));
        self.measured = Measured {
            stiffness: stiffness[0],
            stiffness_std: left_out(stiffness, LEFT_OUT[0]),
            lateral_stiffness: lateral[0],
            lateral_stiffness_std: left_out(lateral, LEFT_OUT[2]),
            friction: friction[0],
            friction_std: left_out(friction, LEFT_OUT[1]),
            sensor_rotation: rotation,
            sensor_rotation_std: angle[1].hypot(LEFT_OUT[3]),
            sensor_direction_y: direction,
            sensor_direction_z: self.values.now().sensor_direction_z,
            ..Measured::START
        };
        if let Ok(drive) = response(p, &self.values.configured().drive, plan, spectra) {
            let (value, gain) = (drive.value, drive.value[0].exp());
            self.measured = Measured {
                drive_gain: gain,
                drive_gain_std: gain * drive.sigma(0).hypot(GUIDES[0]),
                feedforward: value[1],
                feedforward_std: drive.sigma(1).hypot(GUIDES[1]),
                io_delay: value[2],
                io_delay_std: drive.sigma(2).hypot(GUIDES[2]),
                ..self.measured
            };
        }
        let nominal = self.values.configured();
        self.rejected = !acceptable(p, &nominal, &self.measured);
        if !self.rejected {
            self.values.propose(nominal.derived(p, &self.measured));
        }
    }

    /// The tool is out.
    fn finish(&mut self, p: &Parameters) {
        self.measured.valid = self.complete;
        if !p.commission.apply {
            self.values.restore();
        }
    }
}

/// Mean of a scatter and the deviation of the mean; zeros where there is too little.
fn measure(scatter: &Welford) -> [f64; 2] {
    let count = scatter.count();
    if count < SAMPLES_MIN { [0.0; 2] } else { [scatter.mean(), scatter.sigma() / count.sqrt()] }
}

/// Standard deviation of a value, model error included.
fn left_out([value, deviation]: [f64; 2], ratio: f64) -> f64 {
    deviation.hypot(ratio * value)
}
