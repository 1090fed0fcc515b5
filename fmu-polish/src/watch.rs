//! Watches force and position: contact, settling, and what is a fault.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::force::Measured;
use crate::machine::{Fault, State};
use crate::parameters::Parameters;
use crate::path::Frame;
use crate::signals::Error;

/// Time constant of the mean force error, s.
const ERROR_TIME: f64 = 0.02;
/// Time constant of the mean force, s.
const FORCE_TIME: f64 = 0.1;
/// A force has a direction from here on, over the contact force.
const DIRECTION_RATIO: f64 = 2.0;

/// Counters and means of the present state.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Watch {
    touching: u32,
    settled: u32,
    lost: u32,
    error: f64,
    force: Vector3<f64>,
}

/// What is seen in one sample, before anything is decided.
#[derive(Clone, Copy, Debug)]
pub struct Sight {
    /// The path at the present place.
    pub frame: Frame,
    /// Measured force.
    pub force: Measured,
    /// Wanted less controlled force, N.
    pub force_error: f64,
    /// E_p = x_d - x, m.
    pub offset: Vector3<f64>,
    /// Its parts, m.
    pub error: Error,
    /// Distance of the surface from the path along the normal, m.
    pub surface: f64,
    /// Samples since the state began.
    pub ticks: u32,
    /// Way of approach or retract so far, m.
    pub travelled: f64,
}

impl Watch {
    /// Nothing seen.
    pub fn new() -> Self {
        Self { touching: 0, settled: 0, lost: 0, error: 0.0, force: Vector3::zeros() }
    }

    /// Takes one sample of `state`; `steady` says whether the wanted force has arrived at its target.
    pub fn update(&mut self, p: &Parameters, state: State, sight: &Sight, steady: bool) {
        let count = |counter: u32, on: bool| if on { counter.saturating_add(1) } else { 0 };
        let share = |time: f64| 1.0 - (-p.sample_period / time).exp();
        self.touching = count(self.touching, state == State::Approach && sight.force.norm > p.approach.contact_force);
        self.error += share(ERROR_TIME) * (sight.force_error - self.error);
        let small = self.error.abs() < p.settle.tolerance * p.force.target;
        self.settled = count(self.settled, state == State::Settle && steady && small);
        self.lost = count(self.lost, state == State::Follow && sight.force.controlled < p.limits.lost_force);
        self.force += (sight.force.vector - self.force) * share(FORCE_TIME);
    }

    /// The tool touches.
    pub fn contact(&self, p: &Parameters) -> bool {
        self.touching >= p.approach.contact_samples.unsigned_abs()
    }

    /// The force is settled.
    pub fn settled(&self, p: &Parameters) -> bool {
        self.settled >= p.ticks(p.settle.hold_time).max(1)
    }

    /// The gravest fault of force and motion in `state`.
    pub fn fault(&self, p: &Parameters, state: State, sight: &Sight) -> Option<Fault> {
        let beside = sight.error.tangential.abs().max(sight.error.lateral.abs());
        let on_path = matches!(state, State::Settle | State::Follow);
        let faults = [
            (Fault::ForceLimit, sight.force.norm > p.limits.force && (state.pressing() || state == State::Approach)),
            (Fault::InvalidPath, on_path && self.astray(p, &sight.frame.normal)),
            (Fault::ApproachTimeout, state == State::Approach && sight.travelled > p.approach.distance_max),
            (Fault::SettleTimeout, state == State::Settle && sight.ticks > p.ticks(p.settle.time_max)),
            (Fault::LostContact, self.lost >= p.ticks(p.limits.lost_time).max(1)),
            (Fault::PositionError, state == State::Follow && beside > p.limits.position_error),
            (Fault::SurfaceError, on_path && sight.surface.abs() > p.limits.surface_error),
        ];
        faults.into_iter().find_map(|(fault, holds)| holds.then_some(fault))
    }

    /// The mean force points away from the normal.
    fn astray(&self, p: &Parameters, normal: &Vector3<f64>) -> bool {
        let size = self.force.norm();
        size > DIRECTION_RATIO * p.approach.contact_force && self.force.dot(normal) < size * p.limits.force_angle.cos()
    }
}

impl Default for Watch {
    fn default() -> Self {
        Self::new()
    }
}
