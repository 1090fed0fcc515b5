//! Traits that make a controller an FMU, the facts about it, and its environment.

use crate::host::logger::{Category, Logger};
use crate::table::enumeration::Item;
use crate::table::variable::Variable;
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// Facts about an FMU for its model description.
#[derive(Clone, Copy, Debug)]
pub struct Info {
    /// Model name as tools show it.
    pub name: &'static str,
    /// Model identifier: a C identifier, and the file name of the shared library.
    pub identifier: &'static str,
    /// One sentence.
    pub description: &'static str,
    /// Version of the model; this and the three below may be empty.
    pub version: &'static str,
    /// Authors.
    pub author: &'static str,
    /// Copyright line.
    pub copyright: &'static str,
    /// Licence.
    pub license: &'static str,
    /// Raise it whenever the variables or the model change their layout or meaning: the GUID changes and
    /// state bytes of the older version are rejected.
    pub state_version: u32,
    /// Suggested stop time, s; 0 for 1000 sample periods, the longest experiment in which FMPy's default step is one of
    /// them.
    pub stop_time: f64,
    /// Sample period of a model without a parameter `sample_period`, s.
    pub sample_period: f64,
    /// Longest communication step, in sample periods, at which a closed loop with this model works: the first longer one
    /// returns a warning. Infinity where it is unknown.
    pub longest_step: f64,
}

impl Info {
    /// Common values; name, identifier and description are still to be given. [`package!`](crate::package) knows more.
    pub const DEFAULT: Self = Self {
        name: "",
        identifier: "",
        description: "",
        version: "",
        author: "",
        copyright: "",
        license: "",
        state_version: 1,
        stop_time: 0.0,
        sample_period: 1e-3,
        longest_step: f64::INFINITY,
    };
}

/// Facts about a model from the `Cargo.toml` of its package: identifier (the name of the library), description,
/// version, authors, licence.
///
/// ```
/// use fmi2_export::{Info, package};
/// const INFO: Info = Info { name: "Spring", description: "A sampled spring", ..package!() };
/// ```
#[macro_export]
macro_rules! package {
    () => {
        $crate::Info {
            identifier: env!("CARGO_CRATE_NAME"),
            description: env!("CARGO_PKG_DESCRIPTION"),
            version: env!("CARGO_PKG_VERSION"),
            author: env!("CARGO_PKG_AUTHORS"),
            copyright: concat!("Copyright (c) ", env!("CARGO_PKG_AUTHORS")),
            license: env!("CARGO_PKG_LICENSE"),
            ..$crate::Info::DEFAULT
        }
    };
}

/// All variables of an FMU, declared once; implemented by [`interface`](macro@crate::interface).
pub trait Interface: Sized + 'static {
    /// The value of every field before anything is set.
    const START: Self;
    /// The variable table; value references are the positions in it.
    const TABLE: &'static [Variable<Self>];

    /// Brings parameters into force after some were set: where `law` asks for those of the paper, each that `is_set` does
    /// not know, by its value reference.
    fn bring_into_force(&mut self, _is_set: impl Fn(usize) -> bool) {}

    /// Sample period, s, of a model with a parameter `sample_period`.
    fn sample_period(&self) -> Option<f64> {
        None
    }

    /// Items of the outputs `state` and `fault`, whose changes are logged; none where the model has no such output.
    fn status(&self) -> Report {
        Report::default()
    }
}

/// State and fault of a model; the first fault means that there is none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Report {
    /// The state.
    pub state: Option<&'static Item>,
    /// The fault, none for the first item of its enumeration.
    pub fault: Option<&'static Item>,
}

/// A sampled controller: a value of this type is its state between samples, in addition to its variables.
///
/// Its sample period is the parameter `sample_period`, where it has one, otherwise that of [`Info`].
pub trait Model: Clone + Serialize + DeserializeOwned + Send + Sync + 'static {
    /// Facts for the model description.
    const INFO: Info;
    /// All variables of the FMU, as plain fields.
    type Vars: Interface + Clone + Serialize + DeserializeOwned + Send + Sync + 'static;

    /// Computes the calculated parameters from the others.
    fn calculate(_vars: &mut Self::Vars) {}

    /// The numbers of a new state or fault, reported after its meaning, such as `: 3 mm, limit 2 mm`.
    fn numbers(_vars: &Self::Vars) -> String {
        String::new()
    }

    /// Checks parameters against each other and makes the controller of time zero.
    ///
    /// Compute a `hidden` field that depends on other parameters in [`Model::calculate`]: each set of a parameter makes
    /// `in_force` again.
    ///
    /// # Errors
    /// The parameter's name, value and limit.
    fn initialise(vars: &mut Self::Vars, env: &mut Env) -> Result<Self, Error>;

    /// Called before more than [`Info::longest_step`] samples run together: those of a long communication step, or of
    /// the time events that an importer of model exchange has passed.
    fn begin_long_step(&mut self) {}

    /// One sample: reads inputs and parameters, writes outputs.
    ///
    /// # Errors
    /// Only what the controller cannot answer with a fault state of its own.
    fn sample(&mut self, vars: &mut Self::Vars, env: &mut Env) -> Result<(), Error>;
}

/// Environment of a model, in addition to its variables: time, experiment, instance name, resources and log.
pub struct Env<'a> {
    pub(crate) time: f64,
    pub(crate) experiment: Experiment,
    pub(crate) host: &'a Host,
}

/// Instance name, folder of resources and logger that the importer passed at instantiation.
pub(crate) struct Host {
    pub name: String,
    pub resources: Option<PathBuf>,
    pub logger: Logger,
}

/// The arguments of fmi2SetupExperiment.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Experiment {
    pub start: f64,
    pub tolerance: Option<f64>,
    /// Infinity when there is none.
    pub stop: f64,
}

impl Env<'_> {
    /// Time of this sample, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Relative tolerance that the importer suggests for iterations and integrations of the model, if it does.
    pub fn tolerance(&self) -> Option<f64> {
        self.experiment.tolerance
    }

    /// End of the experiment, s, if the importer knows it.
    pub fn stop_time(&self) -> Option<f64> {
        Some(self.experiment.stop).filter(|stop| stop.is_finite())
    }

    /// Name that the importer has given to this instance.
    pub fn instance_name(&self) -> &str {
        &self.host.name
    }

    /// The folder `resources` of the FMU, if the importer passed its location.
    pub fn resources(&self) -> Option<&Path> {
        self.host.resources.as_deref()
    }

    /// Reports a change of state; shown when the importer switches events on.
    pub fn event(&self, text: impl Display) {
        self.host.logger.send(Category::Events, format_args!("t = {} s: {text}", shown(self.time)));
    }

    /// Reports a new fault, otherwise a new state, with meaning and hint as the enumerations describe them.
    pub(crate) fn report(&self, before: Report, now: Report, numbers: impl FnOnce() -> String) {
        let line = |kind: &str, Item { name, description, hint, .. }: &Item| {
            let hint = if hint.is_empty() { String::new() } else { format!("\nhint: {hint}") };
            format!("{kind} `{name}`: {description}{}{hint}", numbers())
        };
        match (now.fault, now.state) {
            (Some(fault), _) if now.fault != before.fault => self.warn(line("fault", fault)),
            (_, Some(state)) if now.state != before.state => self.event(line("state", state)),
            _ => {}
        }
    }

    /// Reports a warning; the call of the importer returns fmi2Warning.
    pub fn warn(&self, text: impl Display) {
        self.host.logger.send(Category::Warning, format_args!("t = {} s: {text}", shown(self.time)));
    }
}

/// A time (s) to the nanosecond: later digits come from counting samples in binary fractions.
fn shown(time: f64) -> f64 {
    (time * 1e9).round() / 1e9
}

/// Why a model cannot go on: a text with names, values and limits, or any error that says so.
pub type Error = Box<dyn std::error::Error + Send + Sync>;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_is_shown_without_the_rounding_of_its_samples() {
        let times = [3.0 * 1e-4, 0.1 + 0.2, -1.1 * 3.0, 12_345.678_912_345];
        assert_ne!(times[0].to_string(), "0.0003");
        assert_eq!(times.map(|time| shown(time).to_string()), ["0.0003", "0.3", "-3.3", "12345.678912345"]);
    }
}
