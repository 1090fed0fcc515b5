//! An FMU with a variable of every kind and a way to provoke every failure; the tests of the C API
//! work on it, and it shows the whole export interface in one place.

use fmi2_export::serde::{Deserialize, Serialize};
use fmi2_export::{Env, Error, Info, Model, export, package};
use variables::{Failure, Limits, Mode, Output, Parameters, Vars};

#[fmi2_export::interface]
mod variables {
    use fmi2_export::units::{METRE, NEWTON, NEWTON_PER_METRE, RADIAN_PER_SECOND, SECOND};

    /// What the probe does with its input
    pub enum Mode {
        /// Output is zero
        Off,
        /// Output stays
        Hold,
        /// Output follows the input
        Follow,
    }

    /// Which values the parameters have that were not set
    pub enum Law {
        /// Their start values
        Default,
        /// Those of the paper
        Paper,
    }

    /// What the probe does wrong on purpose
    pub enum Failure {
        /// Nothing
        None,
        /// The sample returns an error
        #[hint("switch the failure off")]
        Error,
        /// The sample panics
        Panic,
        /// The sample computes NaN
        NotANumber,
        /// The sample sends a warning and an event
        Warn,
    }

    #[inputs]
    pub struct Input {
        /// Position
        #[var(unit = METRE as "um")]
        pub position: f64,
        /// A sensor that may fail
        #[var(accepts_nan)]
        pub sensor: f64,
        /// Number to count by
        pub count: i32,
        /// Switch
        #[var(start = true)]
        pub enable: bool,
    }

    #[outputs]
    pub struct Output {
        /// gain * position + sum of bias
        #[var(unit = NEWTON, nominal = 10.0)]
        pub force: f64,
        /// Sum of `count` over the samples
        pub counted: i32,
        /// The switch at the last sample
        pub enabled: bool,
        /// Mode at the last sample
        pub active_mode: Mode,
        /// Label and time of the last sample
        pub text: String,
        /// Sum of the force over the samples
        #[var(local)]
        pub sum: f64,
        /// Number of samples
        #[var(local)]
        pub ticks: i32,
        /// Number of steps that were too long
        #[var(local)]
        pub long_steps: i32,
    }

    #[parameters]
    pub struct Parameters {
        /// Sample period
        #[var(unit = SECOND, range = 1e-6..=1.0, start = 1e-3, source = "default; a usual control rate")]
        pub sample_period: f64,
        /// Gain
        #[var(unit = NEWTON_PER_METRE, range = 0.0..=1e6, start = 2.0, paper = 3.0, tunable)]
        pub gain: f64,
        /// Limits of the force
        pub limits: Limits,
        /// Bias of the force
        #[var(unit = NEWTON, start = [0.0, 0.5, 1.0], paper = [0.0, 5.0, 10.0], tunable)]
        pub bias: [f64; 3],
        /// Order
        #[var(range = 1..=5, start = 2)]
        pub order: i32,
        /// Mode
        #[var(start = Mode::Follow, tunable)]
        pub mode: Mode,
        /// Failure to provoke
        #[var(tunable)]
        pub failure: Failure,
        /// Label for the log
        #[var(start = "100 % <probe>", paper = "probe of the paper")]
        pub label: String,
        /// sqrt(gain)
        #[var(unit = RADIAN_PER_SECOND, calculated)]
        pub natural_frequency: f64,
        pub law: Law,
    }

    /// Limits of the force.
    pub struct Limits {
        /// Lower limit of the force
        #[var(unit = NEWTON, start = -10.0)]
        pub low: f64,
        /// Upper limit of the force
        #[var(unit = NEWTON, start = 10.0)]
        pub high: f64,
    }
}

#[derive(Clone, Serialize, Deserialize)]
#[serde(crate = "fmi2_export::serde")]
struct Probe {
    sum: f64,
    ticks: i32,
    long_steps: i32,
}

impl Model for Probe {
    const INFO: Info = Info {
        name: "Probe",
        description: "Every kind of variable & every kind of failure",
        longest_step: 1e6,
        ..package!()
    };
    type Vars = Vars;

    fn calculate(vars: &mut Vars) {
        vars.parameters.natural_frequency = vars.in_force.gain.sqrt();
    }

    fn initialise(vars: &mut Vars, _: &mut Env) -> Result<Self, Error> {
        let Limits { low, high } = vars.in_force.limits;
        if low > high {
            return Err(format!("`limits.low` = {low} N must be at most `limits.high` = {high} N").into());
        }
        Ok(Self { sum: 0.0, ticks: 0, long_steps: 0 })
    }

    fn begin_long_step(&mut self) {
        self.long_steps += 1;
    }

    fn sample(&mut self, vars: &mut Vars, env: &mut Env) -> Result<(), Error> {
        let Vars { input, in_force: parameters, output, .. } = vars;
        output.force = match parameters.mode {
            Mode::Off => 0.0,
            Mode::Hold => output.force,
            Mode::Follow => parameters.gain * input.position + parameters.bias.iter().sum::<f64>(),
        };
        fail(parameters, output, env)?;
        output.force = output.force.clamp(parameters.limits.low, parameters.limits.high);
        self.sum += output.force;
        self.ticks += 1;
        output.sum = self.sum;
        output.ticks = self.ticks;
        output.long_steps = self.long_steps;
        output.counted += input.count;
        output.enabled = input.enable;
        output.active_mode = parameters.mode;
        output.text = format!("{} at {} s", parameters.label, env.time());
        Ok(())
    }
}

fn fail(parameters: &Parameters, output: &mut Output, env: &Env) -> Result<(), Error> {
    match parameters.failure {
        Failure::None => Ok(()),
        Failure::Error => Err("provoked error".into()),
        Failure::Panic => panic!("provoked panic of {}", parameters.label),
        Failure::NotANumber => {
            output.force = f64::NAN;
            Ok(())
        }
        Failure::Warn => {
            env.warn("50 % of a warning");
            let (name, end, tolerance) = (env.instance_name(), env.stop_time(), env.tolerance());
            env.event(format_args!("an event of {name}, stop time {end:?}, tolerance {tolerance:?}"));
            Ok(())
        }
    }
}

export!(Probe);
