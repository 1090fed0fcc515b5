//! What goes in and out of the law in one sample, grouped as in the FMU.

use serde::{Deserialize, Serialize};

use crate::kinematics::{AXES, Joints};
use crate::machine::{Fault, Mode, State};

/// Inputs, sampled at the start of the tick.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Input {
    /// Column.
    pub axis1: AxisInput,
    /// Height.
    pub axis2: AxisInput,
    /// Arm.
    pub axis3: AxisInput,
    /// Yaw.
    pub axis4: AxisInput,
    /// Pitch.
    pub axis5: AxisInput,
    /// Roll.
    pub axis6: AxisInput,
    /// Tool speed N, rad/s.
    pub spindle_speed: f64,
    /// What is asked for.
    pub mode: Mode,
    /// The drives may move.
    pub enable: bool,
    /// Stand on the way.
    pub hold: bool,
    /// Part of the taught speed in DryRun, Playback and Deburr, 0 to 1.
    pub speed_override: f64,
    /// Rising edge ends a fault.
    pub reset_fault: bool,
}

/// Inputs of one axis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AxisInput {
    /// Encoder reading, rad or m.
    pub position: f64,
}

impl Input {
    /// At rest, enabled, nothing asked for, tool at 18,000 rpm.
    pub const START: Self = Self {
        axis1: AxisInput { position: 0.0 },
        axis2: AxisInput { position: 0.0 },
        axis3: AxisInput { position: 0.0 },
        axis4: AxisInput { position: 0.0 },
        axis5: AxisInput { position: 0.0 },
        axis6: AxisInput { position: 0.0 },
        spindle_speed: 1885.0,
        mode: Mode::Idle,
        enable: true,
        hold: false,
        speed_override: 1.0,
        reset_fault: false,
    };

    /// Encoder readings of all axes, rad or m.
    pub fn positions(&self) -> Joints {
        [&self.axis1, &self.axis2, &self.axis3, &self.axis4, &self.axis5, &self.axis6].map(|axis| axis.position)
    }

    /// Sets the encoder readings of all axes, rad or m.
    pub fn set_positions(&mut self, positions: &Joints) {
        let axes =
            [&mut self.axis1, &mut self.axis2, &mut self.axis3, &mut self.axis4, &mut self.axis5, &mut self.axis6];
        axes.into_iter().zip(positions).for_each(|(axis, position)| axis.position = *position);
    }
}

/// Outputs; always finite.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Output {
    /// Column.
    pub axis1: AxisOutput,
    /// Height.
    pub axis2: AxisOutput,
    /// Arm.
    pub axis3: AxisOutput,
    /// Yaw.
    pub axis4: AxisOutput,
    /// Pitch.
    pub axis5: AxisOutput,
    /// Roll.
    pub axis6: AxisOutput,
    /// A velocity command is at its limit.
    pub saturated: bool,
    /// What the controller is doing.
    pub state: State,
    /// Why it is in the state Fault.
    pub fault: Fault,
    /// Where the reference is on the path.
    pub path: PathOutput,
    /// How the learning goes.
    pub learn: LearnOutput,
    /// Cutting-load control.
    pub load: LoadOutput,
    /// Control patterns.
    pub bank: BankOutput,
}

/// Outputs of one axis; rad or m.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AxisOutput {
    /// Velocity command, per second.
    pub velocity: f64,
    /// Reference, in whole pulses.
    pub reference: f64,
    /// Control error: reference minus encoder.
    pub error: f64,
    /// Compensation from the patterns, in whole pulses.
    pub compensation: f64,
    /// Root mean square of the error of the last finished repetition.
    pub rms: f64,
    /// Largest error of the last finished repetition.
    pub peak: f64,
}

/// Where the reference is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PathOutput {
    /// Distance from the start, m.
    pub distance: f64,
    /// Speed, m/s.
    pub speed: f64,
    /// Number of the block, from 1.
    pub block: i32,
    /// Distance from the previous teaching point (L*), m.
    pub block_distance: f64,
    /// Length of the path, m.
    pub length: f64,
    /// Full laps of a cyclic path since the run began.
    pub laps: i32,
    /// The run is over.
    pub done: bool,
    /// Tip of the tool that the reference stands for, m.
    pub tip: [f64; 3],
}

/// How the learning goes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LearnOutput {
    /// Number of the speed, from 1; 0 before.
    pub speed_index: i32,
    /// Number of the repetition; 0 is the bare servo.
    pub repetition: i32,
    /// Repetition with the smallest error so far at this speed.
    pub best: i32,
    /// Root mean square of the error at the tip in the last finished repetition, m.
    pub cost: f64,
    /// All speeds are learned.
    pub done: bool,
}

/// Cutting-load control.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoadOutput {
    /// Wanted feed, m/s.
    pub feed: f64,
    /// The slowest feed is still too fast.
    pub overload: bool,
}

/// Where the control patterns come from, or what became of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum BankStatus {
    /// There are none.
    Empty = 1,
    /// Read from `bank.import`.
    Imported = 2,
    /// Learned, not written.
    Learned = 3,
    /// Written to `bank.export`.
    Exported = 4,
    /// Not written; they are still here.
    ExportFailed = 5,
}

/// Control patterns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BankOutput {
    /// Where they come from.
    pub status: BankStatus,
    /// Number of patterns that can be used.
    pub patterns: i32,
}

const REST: AxisOutput =
    AxisOutput { velocity: 0.0, reference: 0.0, error: 0.0, compensation: 0.0, rms: 0.0, peak: 0.0 };

impl Output {
    /// Before the first sample.
    pub const START: Self = Self {
        axis1: REST,
        axis2: REST,
        axis3: REST,
        axis4: REST,
        axis5: REST,
        axis6: REST,
        saturated: false,
        state: State::Off,
        fault: Fault::None,
        path: PathOutput {
            distance: 0.0,
            speed: 0.0,
            block: 1,
            block_distance: 0.0,
            length: 0.0,
            laps: 0,
            done: false,
            tip: [0.0; 3],
        },
        learn: LearnOutput { speed_index: 0, repetition: 0, best: 0, cost: 0.0, done: false },
        load: LoadOutput { feed: 0.0, overload: false },
        bank: BankOutput { status: BankStatus::Empty, patterns: 0 },
    };

    /// The axes in their order.
    pub fn axes(&self) -> [&AxisOutput; AXES] {
        [&self.axis1, &self.axis2, &self.axis3, &self.axis4, &self.axis5, &self.axis6]
    }

    /// The axes in their order, to be written.
    pub fn axes_mut(&mut self) -> [&mut AxisOutput; AXES] {
        [&mut self.axis1, &mut self.axis2, &mut self.axis3, &mut self.axis4, &mut self.axis5, &mut self.axis6]
    }
}
