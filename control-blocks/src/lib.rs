//! Discrete-time blocks for more than one controller, one per file, with derivation and closed-form
//! tests. They are independent of FMI and of any controller, and allocate nothing in a control step.
#![forbid(unsafe_code)]

mod commission;
mod estimation;
mod monitoring;
mod motion;
mod parameters;
mod sampling;

pub use commission::active::ActiveValues;
pub use commission::bounds::{
    DELAY_SPREAD, RATIO_MAX, SIGNIFICANT, check_commission_time, commission_time, configured_or, is_certain,
    significant_or, tolerated_delays, whole_delay, within_factor,
};
pub use commission::excitation::{Excitation, ExcitationTimes};
pub use commission::export::{export_commission, export_values};
pub use commission::multisine::{HARMONICS, Multisine, TONES};
pub use estimation::allan::{AllanVariance, of_walk_and_white, walk_and_white};
pub use estimation::angle::{Unwrapper, wrap, wrap_half_open};
pub use estimation::canceller::{Canceller, adaptation_gain};
pub use estimation::least_squares::{Estimate, NoEstimate, Observation, least_squares};
pub use estimation::periodic::{PeriodicSpectra, SpectralLine};
pub use estimation::running_line::{AnchoredLine, RunningLine};
pub use estimation::welford::Welford;
pub use monitoring::following::Following;
pub use monitoring::frozen::Frozen;
pub use monitoring::jump::{JumpGuard, Reach};
pub use monitoring::progress::Progress;
pub use monitoring::reaction::Reaction;
pub use monitoring::response::Response;
pub use monitoring::reversals::Reversals;
pub use motion::quintic::{QUINTIC_ACCELERATION, Quintic, minimum_jerk, minimum_jerk_rates, quintic_duration};
pub use motion::ramp::{ramp, ramp_between};
pub use motion::trajectory::{Trajectory, stopping_distance};
pub use parameters::check::{Check, Refusal, assert_refusals, check_all};
pub use parameters::error::{ParameterError, require};
pub use parameters::file::FileParameter;
pub use parameters::numbers::{real_numbers, whole_numbers};
pub use parameters::parameter::Parameter;
pub use sampling::consecutive::Consecutive;
pub use sampling::edge::Edge;
pub use sampling::input::{is_plausible, with_nonsense};
pub use sampling::last_good::LastGood;
pub use sampling::request::WaitingRequest;
pub use sampling::sent_commands::{DELAY_MAX, SentCommands};
pub use sampling::ticks::ticks;
