//! An FMU with a variable of every kind and a way to provoke every failure; the tests of the C API
//! work on it, and it shows the whole export interface in one place.

use fmi2_export::{Env, Error, Info, Model, Start, Variable, boolean, choice, enumeration, export};
use fmi2_export::{integer, package, real, text, units};
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum Mode {
    Off = 1,
    Hold = 2,
    Follow = 3,
}

enumeration! { Mode, "What the probe does with its input" {
    Off = 1, "Output is zero",
    Hold = 2, "Output stays",
    Follow = 3, "Output follows the input",
} }

/// What the probe does wrong on purpose.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum Failure {
    None = 1,
    Error = 2,
    Panic = 3,
    NotANumber = 4,
    Warn = 5,
}

enumeration! { Failure, "What the probe does wrong on purpose" {
    None = 1, "Nothing",
    Error = 2, "The sample returns an error",
    Panic = 3, "The sample panics",
    NotANumber = 4, "The sample computes NaN",
    Warn = 5, "The sample sends a warning and an event",
} }

#[derive(Clone, Serialize, Deserialize)]
struct Input {
    position: f64,
    sensor: f64,
    count: i32,
    enable: bool,
}

#[derive(Clone, Serialize, Deserialize)]
struct Parameters {
    period: f64,
    gain: f64,
    limits: Limits,
    bias: [f64; 3],
    order: i32,
    mode: Mode,
    failure: Failure,
    label: String,
    natural_frequency: f64,
}

#[derive(Clone, Serialize, Deserialize)]
struct Limits {
    low: f64,
    high: f64,
}

#[derive(Clone, Serialize, Deserialize)]
struct Output {
    force: f64,
    counted: i32,
    enabled: bool,
    active_mode: Mode,
    text: String,
    sum: f64,
    ticks: i32,
}

#[derive(Clone, Serialize, Deserialize)]
struct Vars {
    input: Input,
    parameters: Parameters,
    output: Output,
}

impl Start for Vars {
    const START: Self = Self {
        input: Input { position: 0.0, sensor: 0.0, count: 0, enable: true },
        parameters: Parameters {
            period: 1e-3,
            gain: 2.0,
            limits: Limits { low: -10.0, high: 10.0 },
            bias: [0.0, 0.5, 1.0],
            order: 2,
            mode: Mode::Follow,
            failure: Failure::None,
            label: String::new(),
            natural_frequency: 0.0,
        },
        output: Output {
            force: 0.0,
            counted: 0,
            enabled: false,
            active_mode: Mode::Off,
            text: String::new(),
            sum: 0.0,
            ticks: 0,
        },
    };
}

#[derive(Clone, Serialize, Deserialize)]
struct State {
    sum: f64,
    ticks: i32,
}

struct Probe;

impl Model for Probe {
    const INFO: Info = Info {
        name: "Probe",
        identifier: "probe",
        description: "Every kind of variable & every kind of failure",
        ..package!()
    };
    type Vars = Vars;
    type State = State;
    const VARIABLES: &'static [Variable<Vars>] = &[
        real!(Vars.input => position).input().unit(&units::METRE).display("um").describe("Position"),
        real!(Vars.input => sensor).input().accepts_nan().describe("A sensor that may fail"),
        integer!(Vars.input => count).input().describe("Number to count by"),
        boolean!(Vars.input => enable).input().describe("Switch"),
        real!(Vars.parameters => period).parameter().unit(&units::SECOND).range(1e-6, 1.0).describe("Sample period"),
        real!(Vars.parameters => gain).tunable().unit(&units::NEWTON_PER_METRE).range(0.0, 1e6).describe("Gain"),
        real!(Vars.parameters => limits.low).parameter().unit(&units::NEWTON).describe("Lower limit of the force"),
        real!(Vars.parameters => limits.high).parameter().unit(&units::NEWTON).describe("Upper limit of the force"),
        real!(Vars.parameters => bias[3]).tunable().unit(&units::NEWTON).describe("Bias of the force"),
        integer!(Vars.parameters => order).parameter().range_int(1, 5).describe("Order"),
        choice!(Vars.parameters => mode: Mode).tunable().describe("Mode"),
        choice!(Vars.parameters => failure: Failure).tunable().describe("Failure to provoke"),
        text!(Vars.parameters => label).parameter().start_text("100 % <probe>").describe("Label for the log"),
        real!(Vars.parameters => natural_frequency).calculated().unit(&units::RADIAN_PER_SECOND).describe("sqrt(gain)"),
        real!(Vars.output => force)
            .output()
            .unit(&units::NEWTON)
            .nominal(10.0)
            .describe("gain * position + sum of bias"),
        integer!(Vars.output => counted).output().describe("Sum of `count` over the samples"),
        boolean!(Vars.output => enabled).output().describe("The switch at the last sample"),
        choice!(Vars.output => active_mode: Mode).output().describe("Mode at the last sample"),
        text!(Vars.output => text).output().describe("Label and time of the last sample"),
        real!(Vars.output => sum).local().describe("Sum of the force over the samples"),
        integer!(Vars.output => ticks).local().describe("Number of samples"),
    ];

    fn period(vars: &Vars) -> f64 {
        vars.parameters.period
    }

    fn calculate(vars: &mut Vars) {
        vars.parameters.natural_frequency = vars.parameters.gain.sqrt();
    }

    fn initialise(vars: &mut Vars, _: &mut Env) -> Result<State, Error> {
        let Limits { low, high } = vars.parameters.limits;
        if low > high {
            return Err(format!("`limits.low` = {low} N must be at most `limits.high` = {high} N").into());
        }
        Ok(State { sum: 0.0, ticks: 0 })
    }

    fn tick(vars: &mut Vars, state: &mut State, env: &mut Env) -> Result<(), Error> {
        let Vars { input, parameters, output } = vars;
        output.force = match parameters.mode {
            Mode::Off => 0.0,
            Mode::Hold => output.force,
            Mode::Follow => parameters.gain * input.position + parameters.bias.iter().sum::<f64>(),
        };
        fail(parameters, output, env)?;
        output.force = output.force.clamp(parameters.limits.low, parameters.limits.high);
        state.sum += output.force;
        state.ticks += 1;
        output.sum = state.sum;
        output.ticks = state.ticks;
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
