//! Variable-speed deburring robot with repetitive control (Kimura, Mukai and Kobayashi), as an FMU.
//!
//! This file is the FMU: its variables and the calls into the law. [`controller::Controller`] is the law,
//! plain Rust that knows nothing of FMI.
#![forbid(unsafe_code)]

pub mod bank;
pub mod bank_file;
pub mod check;
pub mod controller;
pub mod feasible;
pub mod feed;
pub mod file;
pub mod fingerprint;
pub mod geometry;
pub mod kinematics;
pub mod learning;
pub mod load;
pub mod lookup;
pub mod machine;
mod messages;
pub mod nominal;
pub mod norm_optimal;
pub mod parameters;
pub mod path;
pub mod path_file;
pub mod pattern;
pub mod reading;
pub mod records;
pub mod run;
pub mod save;
pub mod servo;
pub mod signals;
pub mod storage;
pub mod texts;
pub mod transfer;
pub mod zero_phase;

use control_blocks::ParameterError;
use fmi2_export::units::{
    HERTZ, METRE, METRE_PER_SECOND, METRE_PER_SECOND_SQUARED, ONE, RADIAN, RADIAN_PER_SECOND, SECOND,
};
use fmi2_export::{
    Env, Error, Info, Model, Start, Unit, Variable, boolean, choice, enumeration, export, integer, real, text,
};
use serde::{Deserialize, Serialize};

use controller::Controller;
use machine::{Fault, Mode, State};
use parameters::{Format, Law, Parameters};
use signals::{BankStatus, Input, Output};
use texts::Texts;

enumeration! { Mode, "What is asked for" {
    Idle = 1, "Hold the pose; a motion stops on its way",
    DryRun = 2, "Run the path once without compensation",
    Learn = 3, "Learn the patterns of all speeds, in air",
    Playback = 4, "Run the path with the patterns at the overridden speed",
    Deburr = 5, "Run the path with the patterns at the speed that the cutting load allows",
    Export = 6, "Write the bank",
} }

enumeration! { State, "What the controller is doing" {
    Off = 1, "Not enabled: velocity commands are zero",
    Idle = 2, "Holds the pose",
    Approach = 3, "Moves to the start of the path",
    Settle = 4, "Rests before a run",
    Run = 5, "Runs the path",
    Stop = 6, "Stops on its way",
    Done = 7, "The job is done, holds the pose",
    Fault = 8, "Velocity commands are zero; `reset_fault` ends it",
} }

enumeration! { Fault, "Why the controller is in the fault state" {
    None = 1, "No fault",
    InvalidInput = 2, "An input is NaN, infinite or absurd",
    ControlError = 3, "An axis was farther from its reference than `axisN.error_max`",
    PatternTooLarge = 4, "A pattern became larger than `learn.pulses_max`",
    BankEmpty = 5, "There is no pattern to compensate with",
    SpindleSlow = 6, "The tool turned slower than `spindle.speed_min` while deburring",
} }

enumeration! { Law, "How a pattern is renewed after a repetition" {
    Plain = 1, "Pattern plus error: the paper's repetitive control",
    LeadFilter = 2, "Pattern plus error read ahead, through a zero-phase low-pass",
    NormOptimal = 3, "Pattern plus the change that is best for the nominal loop",
} }

enumeration! { Format, "What a bank is written as" {
    Full = 1, "All digits and a checksum",
    Records = 2, "The paper's 18 bytes for each sample, in whole pulses",
} }

enumeration! { BankStatus, "Where the control patterns come from, or what became of them" {
    Empty = 1, "There are none",
    Imported = 2, "Read from `bank.import`",
    Learned = 3, "Learned, not written",
    Exported = 4, "Written to `bank.export`",
    ExportFailed = 5, "Not written; they are still here",
} }

/// All variables of the FMU.
#[derive(Clone, Serialize, Deserialize)]
pub struct Vars {
    /// Inputs of the law.
    pub input: Input,
    /// Outputs of the law.
    pub output: Output,
    /// Parameters of the law.
    pub parameters: Parameters,
    /// Texts among the variables.
    pub text: Texts,
}

impl Start for Vars {
    const START: Self =
        Self { input: Input::START, output: Output::START, parameters: Parameters::DEFAULT, text: Texts::EMPTY };
}

/// Unit of a loop gain.
const PER_SECOND: Unit = Unit::si("1/s", [0, 0, -1, 0, 0], &[]);

/// The FMU.
pub struct Deburr;

impl Model for Deburr {
    const INFO: Info = Info {
        name: "VariableSpeedDeburring",
        identifier: "fmu_deburr",
        description: "Drives a six-axis deburring robot with cutting-load control and interpolated repetitive control \
                      (Kimura, Mukai and Kobayashi)",
        state_version: 1,
        stop_time: 10.0,
        step_size: 0.01,
        ..fmi2_export::package!()
    };
    type Vars = Vars;
    type State = Controller;

    #[rustfmt::skip]
    const VARIABLES: &'static [Variable<Vars>] = &[
        // inputs
        real!(Vars.input => axis1.position).input().unit(&RADIAN).display("deg").accepts_nan().describe("Encoder reading of axis 1, column, positive towards +y"),
        real!(Vars.input => axis2.position).input().unit(&METRE).display("mm").accepts_nan().describe("Encoder reading of axis 2, height"),
        real!(Vars.input => axis3.position).input().unit(&METRE).display("mm").accepts_nan().describe("Encoder reading of axis 3, arm"),
        real!(Vars.input => axis4.position).input().unit(&RADIAN).display("deg").accepts_nan().describe("Encoder reading of axis 4, yaw of the wrist"),
        real!(Vars.input => axis5.position).input().unit(&RADIAN).display("deg").accepts_nan().describe("Encoder reading of axis 5, pitch of the wrist"),
        real!(Vars.input => axis6.position).input().unit(&RADIAN).display("deg").accepts_nan().describe("Encoder reading of axis 6, roll of the wrist"),
        real!(Vars.input => spindle_speed).input().unit(&RADIAN_PER_SECOND).display("rpm").accepts_nan().describe("Tool speed N"),
        choice!(Vars.input => mode: Mode).input().describe("What is asked for; a job begins when the mode changes to it"),
        boolean!(Vars.input => enable).input().describe("The drives may move; false makes all velocity commands zero"),
        boolean!(Vars.input => hold).input().describe("Slow down and stand on the way; false goes on"),
        real!(Vars.input => speed_override).input().unit(&ONE).accepts_nan().describe("Part of the taught speed in DryRun, Playback and Deburr, limited to 0 to 1"),
        boolean!(Vars.input => reset_fault).input().describe("Rising edge ends a fault"),
        // outputs
        real!(Vars.output => axis1.velocity).output().unit(&RADIAN_PER_SECOND).describe("Velocity command of axis 1"),
        real!(Vars.output => axis2.velocity).output().unit(&METRE_PER_SECOND).describe("Velocity command of axis 2"),
        real!(Vars.output => axis3.velocity).output().unit(&METRE_PER_SECOND).describe("Velocity command of axis 3"),
        real!(Vars.output => axis4.velocity).output().unit(&RADIAN_PER_SECOND).describe("Velocity command of axis 4"),
        real!(Vars.output => axis5.velocity).output().unit(&RADIAN_PER_SECOND).describe("Velocity command of axis 5"),
        real!(Vars.output => axis6.velocity).output().unit(&RADIAN_PER_SECOND).describe("Velocity command of axis 6"),
        real!(Vars.output => axis1.reference).output().unit(&RADIAN).display("deg").describe("Reference r of axis 1, in whole pulses"),
        real!(Vars.output => axis1.error).output().unit(&RADIAN).display("deg").describe("Control error e of axis 1"),
        real!(Vars.output => axis1.compensation).output().unit(&RADIAN).display("deg").describe("Compensation c of axis 1, in whole pulses"),
        real!(Vars.output => axis1.rms).output().unit(&RADIAN).display("deg").describe("Root mean square of the control error of axis 1 in the last finished repetition"),
        real!(Vars.output => axis1.peak).output().unit(&RADIAN).display("deg").describe("Largest control error of axis 1 in the last finished repetition"),
        real!(Vars.output => axis2.reference).output().unit(&METRE).display("mm").describe("Reference r of axis 2, in whole pulses"),
        real!(Vars.output => axis2.error).output().unit(&METRE).display("mm").describe("Control error e of axis 2"),
        real!(Vars.output => axis2.compensation).output().unit(&METRE).display("mm").describe("Compensation c of axis 2, in whole pulses"),
        real!(Vars.output => axis2.rms).output().unit(&METRE).display("mm").describe("Root mean square of the control error of axis 2 in the last finished repetition"),
        real!(Vars.output => axis2.peak).output().unit(&METRE).display("mm").describe("Largest control error of axis 2 in the last finished repetition"),
        real!(Vars.output => axis3.reference).output().unit(&METRE).display("mm").describe("Reference r of axis 3, in whole pulses"),
        real!(Vars.output => axis3.error).output().unit(&METRE).display("mm").describe("Control error e of axis 3"),
        real!(Vars.output => axis3.compensation).output().unit(&METRE).display("mm").describe("Compensation c of axis 3, in whole pulses"),
        real!(Vars.output => axis3.rms).output().unit(&METRE).display("mm").describe("Root mean square of the control error of axis 3 in the last finished repetition"),
        real!(Vars.output => axis3.peak).output().unit(&METRE).display("mm").describe("Largest control error of axis 3 in the last finished repetition"),
        real!(Vars.output => axis4.reference).output().unit(&RADIAN).display("deg").describe("Reference r of axis 4, in whole pulses"),
        real!(Vars.output => axis4.error).output().unit(&RADIAN).display("deg").describe("Control error e of axis 4"),
        real!(Vars.output => axis4.compensation).output().unit(&RADIAN).display("deg").describe("Compensation c of axis 4, in whole pulses"),
        real!(Vars.output => axis4.rms).output().unit(&RADIAN).display("deg").describe("Root mean square of the control error of axis 4 in the last finished repetition"),
        real!(Vars.output => axis4.peak).output().unit(&RADIAN).display("deg").describe("Largest control error of axis 4 in the last finished repetition"),
        real!(Vars.output => axis5.reference).output().unit(&RADIAN).display("deg").describe("Reference r of axis 5, in whole pulses"),
        real!(Vars.output => axis5.error).output().unit(&RADIAN).display("deg").describe("Control error e of axis 5"),
        real!(Vars.output => axis5.compensation).output().unit(&RADIAN).display("deg").describe("Compensation c of axis 5, in whole pulses"),
        real!(Vars.output => axis5.rms).output().unit(&RADIAN).display("deg").describe("Root mean square of the control error of axis 5 in the last finished repetition"),
        real!(Vars.output => axis5.peak).output().unit(&RADIAN).display("deg").describe("Largest control error of axis 5 in the last finished repetition"),
        real!(Vars.output => axis6.reference).output().unit(&RADIAN).display("deg").describe("Reference r of axis 6, in whole pulses"),
        real!(Vars.output => axis6.error).output().unit(&RADIAN).display("deg").describe("Control error e of axis 6"),
        real!(Vars.output => axis6.compensation).output().unit(&RADIAN).display("deg").describe("Compensation c of axis 6, in whole pulses"),
        real!(Vars.output => axis6.rms).output().unit(&RADIAN).display("deg").describe("Root mean square of the control error of axis 6 in the last finished repetition"),
        real!(Vars.output => axis6.peak).output().unit(&RADIAN).display("deg").describe("Largest control error of axis 6 in the last finished repetition"),
        boolean!(Vars.output => saturated).output().describe("A velocity command is at its limit"),
        choice!(Vars.output => state: State).output().describe("What the controller is doing"),
        choice!(Vars.output => fault: Fault).output().describe("Why it is in the state Fault"),
        real!(Vars.output => path.distance).output().unit(&METRE).display("mm").describe("Distance L of the reference from the start of the path"),
        real!(Vars.output => path.speed).output().unit(&METRE_PER_SECOND).display("mm/s").describe("Speed V of the reference on the path"),
        integer!(Vars.output => path.block).output().describe("Number of the block, from 1"),
        real!(Vars.output => path.block_distance).output().unit(&METRE).display("mm").describe("Distance from the previous teaching point"),
        real!(Vars.output => path.length).output().unit(&METRE).display("mm").describe("Length of the path"),
        integer!(Vars.output => path.laps).output().describe("Full laps of a cyclic path since the run began"),
        boolean!(Vars.output => path.done).output().describe("The job is done and the robot stands"),
        real!(Vars.output => path.tip[3]).output().unit(&METRE).display("mm").describe("Tip of the tool that the reference stands for, x, y, z in the base frame"),
        integer!(Vars.output => learn.speed_index).output().describe("Number of the speed that is learned, from 1; 0 before"),
        integer!(Vars.output => learn.repetition).output().describe("Number of the present repetition; 0 is the bare servo"),
        integer!(Vars.output => learn.best).output().describe("Repetition with the smallest error so far at this speed"),
        real!(Vars.output => learn.cost).output().unit(&METRE).display("um").describe("Root mean square of the control error at the tip over all axes in the last finished repetition"),
        boolean!(Vars.output => learn.done).output().describe("All speeds are learned"),
        real!(Vars.output => load.feed).output().unit(&METRE_PER_SECOND).display("mm/s").describe("Feed V_n that the cutting load allows, eq. 5"),
        boolean!(Vars.output => load.overload).output().describe("The slowest feed is still too fast for longer than `load.overload_time`"),
        choice!(Vars.output => bank.status: BankStatus).output().describe("Where the control patterns come from, or what became of them"),
        integer!(Vars.output => bank.patterns).output().describe("Number of patterns that can be used"),
        text!(Vars.text => bank.message).output().describe("What became of the last reading or writing of the bank"),
        // robot
        real!(Vars.parameters => sample_period).parameter().unit(&SECOND).display("ms").range(1e-3, 0.05).describe("Sample period t of servo and learning"),
        real!(Vars.parameters => axis1.pulse).parameter().unit(&RADIAN).range(1e-9, 1e-2).describe("Encoder pulse q of axis 1"),
        real!(Vars.parameters => axis1.velocity_max).parameter().unit(&RADIAN_PER_SECOND).range(1e-3, 100.0).describe("Largest velocity command of axis 1"),
        real!(Vars.parameters => axis1.minimum).parameter().unit(&RADIAN).display("deg").range(-100.0, 100.0).describe("Lower end of the travel of axis 1"),
        real!(Vars.parameters => axis1.maximum).parameter().unit(&RADIAN).display("deg").range(-100.0, 100.0).describe("Upper end of the travel of axis 1"),
        real!(Vars.parameters => axis1.error_max).parameter().unit(&RADIAN).display("deg").range(1e-6, 10.0).describe("Control error of axis 1 that is a fault"),
        real!(Vars.parameters => axis2.pulse).parameter().unit(&METRE).range(1e-9, 1e-2).describe("Encoder pulse q of axis 2"),
        real!(Vars.parameters => axis2.velocity_max).parameter().unit(&METRE_PER_SECOND).range(1e-3, 100.0).describe("Largest velocity command of axis 2"),
        real!(Vars.parameters => axis2.minimum).parameter().unit(&METRE).display("mm").range(-100.0, 100.0).describe("Lower end of the travel of axis 2"),
        real!(Vars.parameters => axis2.maximum).parameter().unit(&METRE).display("mm").range(-100.0, 100.0).describe("Upper end of the travel of axis 2"),
        real!(Vars.parameters => axis2.error_max).parameter().unit(&METRE).display("mm").range(1e-6, 10.0).describe("Control error of axis 2 that is a fault"),
        real!(Vars.parameters => axis3.pulse).parameter().unit(&METRE).range(1e-9, 1e-2).describe("Encoder pulse q of axis 3"),
        real!(Vars.parameters => axis3.velocity_max).parameter().unit(&METRE_PER_SECOND).range(1e-3, 100.0).describe("Largest velocity command of axis 3"),
        real!(Vars.parameters => axis3.minimum).parameter().unit(&METRE).display("mm").range(-100.0, 100.0).describe("Lower end of the travel of axis 3"),
        real!(Vars.parameters => axis3.maximum).parameter().unit(&METRE).display("mm").range(-100.0, 100.0).describe("Upper end of the travel of axis 3"),
        real!(Vars.parameters => axis3.error_max).parameter().unit(&METRE).display("mm").range(1e-6, 10.0).describe("Control error of axis 3 that is a fault"),
        real!(Vars.parameters => axis4.pulse).parameter().unit(&RADIAN).range(1e-9, 1e-2).describe("Encoder pulse q of axis 4"),
        real!(Vars.parameters => axis4.velocity_max).parameter().unit(&RADIAN_PER_SECOND).range(1e-3, 100.0).describe("Largest velocity command of axis 4"),
        real!(Vars.parameters => axis4.minimum).parameter().unit(&RADIAN).display("deg").range(-100.0, 100.0).describe("Lower end of the travel of axis 4"),
        real!(Vars.parameters => axis4.maximum).parameter().unit(&RADIAN).display("deg").range(-100.0, 100.0).describe("Upper end of the travel of axis 4"),
        real!(Vars.parameters => axis4.error_max).parameter().unit(&RADIAN).display("deg").range(1e-6, 10.0).describe("Control error of axis 4 that is a fault"),
        real!(Vars.parameters => axis5.pulse).parameter().unit(&RADIAN).range(1e-9, 1e-2).describe("Encoder pulse q of axis 5"),
        real!(Vars.parameters => axis5.velocity_max).parameter().unit(&RADIAN_PER_SECOND).range(1e-3, 100.0).describe("Largest velocity command of axis 5"),
        real!(Vars.parameters => axis5.minimum).parameter().unit(&RADIAN).display("deg").range(-100.0, 100.0).describe("Lower end of the travel of axis 5"),
        real!(Vars.parameters => axis5.maximum).parameter().unit(&RADIAN).display("deg").range(-100.0, 100.0).describe("Upper end of the travel of axis 5"),
        real!(Vars.parameters => axis5.error_max).parameter().unit(&RADIAN).display("deg").range(1e-6, 10.0).describe("Control error of axis 5 that is a fault"),
        real!(Vars.parameters => axis6.pulse).parameter().unit(&RADIAN).range(1e-9, 1e-2).describe("Encoder pulse q of axis 6"),
        real!(Vars.parameters => axis6.velocity_max).parameter().unit(&RADIAN_PER_SECOND).range(1e-3, 100.0).describe("Largest velocity command of axis 6"),
        real!(Vars.parameters => axis6.minimum).parameter().unit(&RADIAN).display("deg").range(-100.0, 100.0).describe("Lower end of the travel of axis 6"),
        real!(Vars.parameters => axis6.maximum).parameter().unit(&RADIAN).display("deg").range(-100.0, 100.0).describe("Upper end of the travel of axis 6"),
        real!(Vars.parameters => axis6.error_max).parameter().unit(&RADIAN).display("deg").range(1e-6, 10.0).describe("Control error of axis 6 that is a fault"),
        real!(Vars.parameters => arm.height).parameter().unit(&METRE).display("mm").range(-10.0, 10.0).describe("Height of the wrist above the base frame where axis 2 reads 0"),
        real!(Vars.parameters => arm.reach).parameter().unit(&METRE).display("mm").range(-10.0, 10.0).describe("Distance of the wrist from the column where axis 3 reads 0"),
        real!(Vars.parameters => arm.tool_offset).parameter().unit(&METRE).display("mm").range(0.0, 2.0).describe("Distance from the wrist to the tip of the tool"),
        real!(Vars.parameters => servo.gain[6]).parameter().unit(&PER_SECOND).range(0.1, 100.0).describe("Gain Kp of the position loop of each axis"),
        integer!(Vars.parameters => servo.io_delay).parameter().range_int(0, 6).describe("Samples between a command and its action; 1 for a standard master, 0 if the command acts at once"),
        real!(Vars.parameters => transfer.time).parameter().unit(&SECOND).range(0.1, 60.0).describe("Shortest time of the motion to the start of the path"),
        real!(Vars.parameters => transfer.settle_time).parameter().unit(&SECOND).range(0.0, 60.0).describe("Rest before a run"),
        real!(Vars.parameters => transfer.velocity_share).parameter().unit(&ONE).range(0.01, 1.0).describe("Part of the largest velocities that the motion to the start may use"),
        // path
        text!(Vars.text => path.file).parameter().describe("JSON file of the taught path, in the folder resources of the FMU or with its whole path; empty for the test piece, `path.json`"),
        real!(Vars.parameters => path.taught_speed).parameter().unit(&METRE_PER_SECOND).display("mm/s").range(0.0, 2.0).describe("Taught speed; 0 for that of the file"),
        real!(Vars.parameters => path.corner).parameter().unit(&RADIAN).display("deg").range(1e-3, 3.2).describe("Turn of the tangent at which the feed stops"),
        real!(Vars.parameters => feed.acceleration).parameter().unit(&METRE_PER_SECOND_SQUARED).range(0.01, 50.0).describe("Acceleration and deceleration on the path"),
        integer!(Vars.parameters => feed.smoothing).parameter().range_int(1, 32).describe("Samples of the moving average over the speed; 1 for none"),
        // learning
        choice!(Vars.parameters => learn.law: Law).parameter().describe("How a pattern is renewed after a repetition"),
        text!(Vars.text => learn.speeds).parameter().start_text(texts::SPEEDS).describe("Multiples of the taught speed at which patterns are learned, descending, up to 9"),
        integer!(Vars.parameters => learn.repetitions).parameter().range_int(0, 100).describe("Renewals of each pattern"),
        boolean!(Vars.parameters => learn.stop_at_best).parameter().describe("Keep the pattern with the smallest error, not the last one"),
        boolean!(Vars.parameters => learn.from_bank).parameter().describe("Learn on from the patterns of the bank, not from zero"),
        integer!(Vars.parameters => learn.lead).parameter().range_int(-6, 8).describe("Samples that the error is read ahead, beyond `servo.io_delay`; Plain and LeadFilter"),
        real!(Vars.parameters => learn.cutoff).parameter().unit(&HERTZ).range(0.1, 400.0).describe("Cut-off of the zero-phase filter; LeadFilter"),
        real!(Vars.parameters => learn.weight).parameter().unit(&ONE).range(1e-6, 1e3).describe("Weight lambda of the change of the pattern; NormOptimal"),
        integer!(Vars.parameters => learn.lead_in).parameter().range_int(8, 100).describe("Samples of a pattern before the start of the path"),
        integer!(Vars.parameters => learn.lead_out).parameter().range_int(8, 500).describe("Samples of a pattern after the end of the path"),
        real!(Vars.parameters => learn.pulses_max).parameter().unit(&ONE).range(1.0, 1e9).describe("Largest pattern value in pulses"),
        real!(Vars.parameters => model.natural_frequency).parameter().unit(&RADIAN_PER_SECOND).range(10.0, 1e5).describe("Natural frequency of the nominal velocity loop, eq. 1; NormOptimal"),
        real!(Vars.parameters => model.damping).parameter().unit(&ONE).range(0.05, 5.0).describe("Damping ratio of the nominal velocity loop, eq. 1; NormOptimal"),
        // use
        boolean!(Vars.parameters => lookup.enable).tunable().describe("Compensate with the patterns in Playback and Deburr"),
        boolean!(Vars.parameters => lookup.recorded_speed).parameter().describe("Eq. 4 with the speed recorded at the distance, not with the nominal one"),
        real!(Vars.parameters => lookup.preview).parameter().unit(&SECOND).display("ms").range(-0.3, 0.4).describe("Time by which the feed is known before the reference follows it, beyond `servo.io_delay`: the lag of the velocity loop"),
        text!(Vars.text => bank.import).parameter().describe("Bank that is read at initialisation, in the folder resources of the FMU or with its whole path; empty for none"),
        text!(Vars.text => bank.export).parameter().describe("File that the bank is written to after learning and on Export; empty for none"),
        choice!(Vars.parameters => bank.format: Format).parameter().describe("What `bank.export` is written as"),
        boolean!(Vars.parameters => load.enable).tunable().describe("Regulate the feed by the cutting load in Deburr; false keeps the taught speed"),
        real!(Vars.parameters => load.spindle_speed).tunable().unit(&RADIAN_PER_SECOND).display("rpm").range(10.0, 1e5).describe("Target tool speed N_nom"),
        real!(Vars.parameters => load.k1).tunable().unit(&METRE_PER_SECOND).range(0.0, 10.0).describe("Gain K1 for each sample"),
        real!(Vars.parameters => load.k2).tunable().unit(&METRE).range(-1.0, 1.0).describe("Gain K2; negative is the sign as printed in the paper, which destabilises"),
        real!(Vars.parameters => load.speed_min).tunable().unit(&METRE_PER_SECOND).display("mm/s").range(0.0, 1.0).describe("Slowest feed"),
        real!(Vars.parameters => load.overload_time).tunable().unit(&SECOND).range(0.0, 60.0).describe("Time at the slowest feed that is an overload"),
        real!(Vars.parameters => spindle.speed_min).tunable().unit(&RADIAN_PER_SECOND).display("rpm").range(0.0, 1e5).describe("Tool speed below which deburring is a fault"),
    ];

    fn period(vars: &Vars) -> f64 {
        vars.parameters.sample_period
    }

    fn initialise(vars: &mut Vars, env: &mut Env) -> Result<Controller, Error> {
        let text = |error: ParameterError| error.to_string();
        let Vars { output, parameters: p, text: texts, .. } = vars;
        p.learn.speeds = texts.speeds().map_err(text)?;
        let path = path_file::read(p, &texts.path.file, env.resources()).map_err(text)?;
        let mut controller = Controller::new(p, path, &texts.path.file).map_err(text)?;
        output.path.length = controller.path().length();
        if !texts.bank.import.is_empty() {
            let read = storage::import(&texts.bank.import, env.resources(), &mut controller, p.learn.pulses_max);
            texts.bank.message = read.map_err(text)?;
            output.bank.status = BankStatus::Imported;
            output.bank.patterns = controller.bank().patterns().len() as i32;
        }
        Ok(controller)
    }

    fn tick(vars: &mut Vars, controller: &mut Controller, env: &mut Env) -> Result<(), Error> {
        let before = vars.output.state;
        controller.tick(&vars.parameters, &vars.input, &mut vars.output);
        if vars.output.state != before {
            messages::tell_state(vars, env);
        }
        if controller.take_export() {
            export_bank(vars, controller, env);
        }
        Ok(())
    }
}

/// Writes the bank; what cannot be written stays where it is, and is told.
fn export_bank(vars: &mut Vars, controller: &Controller, env: &Env) {
    let bank = &mut vars.text.bank;
    if bank.export.is_empty() {
        "not written: `bank.export` is empty".clone_into(&mut bank.message);
        return env.event(&bank.message);
    }
    match storage::export(&bank.export, vars.parameters.bank.format, controller) {
        Ok(message) => {
            env.event(&message);
            (bank.message, vars.output.bank.status) = (message, BankStatus::Exported);
        }
        Err(message) => {
            env.warn(&message);
            (bank.message, vars.output.bank.status) = (message, BankStatus::ExportFailed);
        }
    }
}

export!(Deburr);
