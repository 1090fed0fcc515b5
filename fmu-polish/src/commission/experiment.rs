//! The motion of a commissioning run: up, excite the axes, down to the mold, press, rub along and across the path, retract.

use control_blocks::{PeriodicSpectra, Quintic, Trajectory, ramp};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::commission::plan::{PRESSES, Plan, RUBS};
use crate::commission::rubbing::{Found, Rubbing};
use crate::force::contact::{ContactMonitor, Measurement};
use crate::force::impedance::{Coefficients, ForceLaw};
use crate::force::stiffness::Slope;
use crate::interface::{Parameters, State};
use crate::motion::velocity::VelocityParts;

/// Part of the experiment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Phase {
    Tare,
    Rise,
    Excite,
    Approach,
    Press,
    Rub,
    Unload,
    Retract,
    Over,
}

/// Milestone that the experiment reaches in a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Milestone {
    /// No milestone in this sample.
    None,
    /// The tool has touched the mold.
    Touched,
    /// All is measured; the force is unloaded next.
    Measured,
    /// The tool is retracted.
    Over,
}

/// Measurements of a sample, and the velocity that was sent in it.
#[derive(Clone, Copy, Debug)]
pub struct Sample<'a> {
    /// Unfiltered force without the zero of the sensor, along the axes of the sensor, N.
    pub shown: &'a Vector3<f64>,
    /// Measured position of the axes, m.
    pub position: &'a Vector3<f64>,
    /// Velocity that was sent in pulses, m/s.
    pub sent: &'a Vector3<f64>,
    /// Path, force and errors of the sample.
    pub now: &'a Measurement,
    /// Counters and means of the contact.
    pub contact: &'a ContactMonitor,
}

/// One experiment, sample by sample.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Experiment {
    /// Its motions.
    pub plan: Plan,
    /// Answer of each axis to the excitation: velocity and position.
    pub spectra: [PeriodicSpectra; 3],
    /// Measurements in contact.
    pub found: Found,
    /// Rubbing along the path and across it.
    pub rubbing: [Rubbing; 2],
    /// Target force, N.
    pub setpoint: f64,
    /// Samples of this phase.
    pub ticks: u32,
    /// Travel of this phase along the normal, m.
    pub travelled: f64,
    phase: Phase,
    motion: Quintic,
    law: ForceLaw,
    slope: Slope,
}

impl Experiment {
    /// An experiment that begins at rest.
    pub fn new(p: &Parameters) -> Self {
        let plan = Plan::new(p);
        let motion = Quintic::new(Trajectory::resting(0.0), plan.rise, plan.rise_time);
        Self {
            plan,
            spectra: Default::default(),
            found: Found::default(),
            rubbing: Default::default(),
            setpoint: 0.0,
            ticks: 0,
            travelled: 0.0,
            phase: Phase::Tare,
            motion,
            law: ForceLaw::default(),
            slope: Slope::default(),
        }
    }

    /// The state of a cycle with the same monitors as this phase.
    pub fn like(&self) -> State {
        match self.phase {
            Phase::Tare | Phase::Over => State::Idle,
            Phase::Rise | Phase::Excite | Phase::Approach => State::Approach,
            Phase::Press | Phase::Rub => State::Follow,
            Phase::Unload => State::Unload,
            Phase::Retract => State::Retract,
        }
    }

    /// The run is complete, or aborted and retracted.
    pub fn over(&self) -> bool {
        self.phase == Phase::Over
    }

    /// The zero of the sensor is known.
    pub fn tared(&mut self) {
        self.enter(Phase::Rise);
    }

    /// Leaves in order.
    pub fn leave(&mut self) {
        match self.phase {
            Phase::Tare | Phase::Rise | Phase::Excite => self.enter(Phase::Over),
            Phase::Approach => self.enter(Phase::Retract),
            Phase::Press | Phase::Rub => self.enter(Phase::Unload),
            Phase::Unload | Phase::Retract | Phase::Over => {}
        }
    }

    /// The velocity of this sample.
    pub fn act(&mut self, p: &Parameters, now: &Measurement) -> VelocityParts {
        let dt = p.sample_period;
        let still = VelocityParts::default();
        match self.phase {
            Phase::Tare | Phase::Over => still,
            Phase::Rise => {
                let at = |ticks: u32| self.motion.at(f64::from(ticks) * dt).position;
                VelocityParts { normal: (at(self.ticks + 1) - at(self.ticks)) / dt, ..still }
            }
            Phase::Excite => {
                let at = |ticks: u32| self.plan.excitation.at(ticks).position;
                let velocity = (at(self.ticks + 1) - at(self.ticks)) / dt;
                VelocityParts { position: Vector3::from_element(velocity), ..still }
            }
            Phase::Approach => self.travel(p, -p.approach.velocity),
            Phase::Retract if self.travelled < p.retract.distance => self.travel(p, p.retract.velocity),
            Phase::Retract => still,
            Phase::Press | Phase::Unload => VelocityParts { normal: self.press(p, now), ..still },
            Phase::Rub => {
                let normal = self.press(p, now);
                let speed = if self.forth(self.ticks) { self.plan.speed } else { -self.plan.speed };
                let [along, crosswise] = if self.crosswise(self.ticks) { [0.0, speed] } else { [speed, 0.0] };
                VelocityParts {
                    normal,
                    tangential: along,
                    stick_slip: crosswise,
                    sideways: now.frame.normal.cross(&now.frame.tangent),
                    ..still
                }
            }
        }
    }

    /// Uses the measurements and commands of this sample, and advances.
    pub fn observe(&mut self, p: &Parameters, sample: &Sample) -> Milestone {
        let tick = self.ticks;
        self.ticks += 1;
        match self.phase {
            Phase::Rise if self.motion.over(f64::from(self.ticks) * p.sample_period) => self.enter(Phase::Excite),
            Phase::Excite => self.excite(tick, sample),
            Phase::Approach if sample.contact.contact() => {
                self.enter(Phase::Press);
                self.law.velocity = -p.approach.velocity;
                self.setpoint = sample.now.force.norm;
                return Milestone::Touched;
            }
            Phase::Press => self.learn_stiffness(tick, sample),
            Phase::Rub => {
                self.rub(p, tick, sample);
                if self.ticks >= 2 * RUBS * 4 * self.plan.quarter {
                    self.enter(Phase::Unload);
                    return Milestone::Measured;
                }
            }
            Phase::Unload if sample.contact.unloaded() => self.enter(Phase::Retract),
            Phase::Retract if self.travelled >= p.retract.distance && sample.contact.free() => {
                self.enter(Phase::Over);
                return Milestone::Over;
            }
            _ => {}
        }
        Milestone::None
    }

    fn enter(&mut self, phase: Phase) {
        (self.phase, self.ticks, self.travelled) = (phase, 0, 0.0);
    }

    fn travel(&mut self, p: &Parameters, velocity: f64) -> VelocityParts {
        self.travelled += velocity.abs() * p.sample_period;
        VelocityParts { normal: velocity, ..VelocityParts::default() }
    }

    fn excite(&mut self, tick: u32, sample: &Sample) {
        let excitation = &self.plan.excitation;
        if excitation.measures(tick) {
            let signals = sample.sent.iter().zip(sample.position.iter());
            for (spectra, (velocity, position)) in self.spectra.iter_mut().zip(signals) {
                spectra.update(excitation.sines.period, *velocity, *position);
            }
        }
        if self.ticks >= excitation.samples() {
            self.enter(Phase::Approach);
        }
    }

    /// Velocity (m/s) of the force control towards the target force.
    fn press(&mut self, p: &Parameters, now: &Measurement) -> f64 {
        let [maximum, low] = self.plan.force;
        let target = match self.phase {
            Phase::Unload => 0.0,
            Phase::Press if self.falls() => low,
            _ => maximum,
        };
        self.setpoint = ramp(self.setpoint, target, self.plan.force_rate * p.sample_period);
        self.law.step(&Coefficients::new(p, self.plan.damping), self.setpoint - now.force.controlled)
    }

    /// Every second press is one back to the low force.
    fn falls(&self) -> bool {
        !(self.ticks / self.plan.press[0]).is_multiple_of(2)
    }

    fn learn_stiffness(&mut self, tick: u32, sample: &Sample) {
        let [press, ramp] = self.plan.press;
        let (number, tick) = (tick / press, tick % press);
        if tick == 0 {
            self.slope = Slope::default();
        }
        if tick < ramp {
            let depth = -sample.position.dot(&sample.now.frame.normal);
            self.slope.update(depth, sample.now.force.normal, self.plan.force[0]);
        }
        if tick + 1 == ramp
            && number > 1
            && let Some(slope) = self.slope.slope()
        {
            self.found.stiffness.push(slope);
        }
        // the last one has gone up, and the force stays
        if number == PRESSES + 2 && tick + 1 == press {
            self.enter(Phase::Rub);
        }
    }

    /// Whether it rubs across the path at this tick, no longer along it.
    fn crosswise(&self, tick: u32) -> bool {
        tick >= RUBS * 4 * self.plan.quarter
    }

    /// Whether it rubs forth: a quarter of a period from the middle, half of one back, and a quarter to the middle.
    fn forth(&self, tick: u32) -> bool {
        !matches!(tick / self.plan.quarter % 4, 1 | 2)
    }

    fn rub(&mut self, p: &Parameters, tick: u32, sample: &Sample) {
        let (crosswise, forth, quarter) = (self.crosswise(tick), self.forth(tick), self.plan.quarter);
        let frame = &sample.now.frame;
        let along = if crosswise { frame.normal.cross(&frame.tangent) } else { frame.tangent };
        let rubbing = &mut self.rubbing[usize::from(crosswise)];
        if matches!(tick % (4 * quarter), phase if phase == quarter || phase == 3 * quarter) {
            rubbing.reverse();
        }
        rubbing.take(p, sample.shown, sample.position, &along, forth);
        if (tick + 1).is_multiple_of(4 * quarter)
            && let Some(period) = rubbing.close(p)
        {
            self.found.take(&period);
        }
    }
}
