//! Every variable of the FMU, told once.
//!
//! Sources: "derived" = follows from the equations; "our choice" = usual practice, with the reason where there is one.

pub use variables::*;

#[fmi2_export::interface]
mod variables {
    use std::f64::consts::TAU;

    use control_blocks::DELAY_MAX;
    use fmi2_export::units::{KILOGRAM, METRE, METRE_PER_SECOND, NEWTON, ONE, RADIAN_PER_SECOND, SECOND};

    /// What the controller is doing.
    pub enum State {
        /// Comes to rest, holds, and waits for `enable`
        Idle,
        /// Moves to the target
        Run,
        /// Has arrived; holds the target until `enable` is false
        Done,
        /// Commands no force; a rising edge of `reset_fault` ends it at rest
        Fault,
    }

    /// Why the controller is in the fault state.
    pub enum Fault {
        /// No fault
        None,
        /// The slide is too far from its setpoint
        #[hint("is something in its way? else move more slowly, or raise `limits.following_error`")]
        FollowingError,
        /// The position is NaN, infinite or out of any plausible range
        #[hint("check what is connected to `position`, and its unit")]
        LostReading,
    }

    /// Which law holds the slide.
    pub enum Law {
        /// With an integral that takes up the friction
        Default,
        /// The PD law alone: friction leaves an error
        Paper,
    }

    /// Inputs, sampled at the start of the tick.
    #[inputs]
    pub struct Input {
        /// Encoder of the slide
        #[var(unit = METRE as "mm", accepts_nan)]
        pub position: f64,
        /// Rising edge in Idle begins a motion; false ends it: come to rest, Idle
        pub enable: bool,
        /// Rising edge ends the state Fault once the slide is at rest: Idle, which waits for a rising edge of `enable`
        pub reset_fault: bool,
    }

    /// Outputs; always finite.
    #[outputs]
    pub struct Output {
        /// Force on the slide
        #[var(unit = NEWTON)]
        pub force: f64,
        /// Where the slide should be
        #[var(unit = METRE as "mm")]
        pub setpoint: f64,
        /// Setpoint less position
        #[var(unit = METRE as "um")]
        pub following_error: f64,
        /// What the controller is doing
        pub state: State,
        /// Why it is in the state Fault
        pub fault: Fault,
    }

    /// All parameters.
    #[parameters]
    pub struct Parameters {
        /// Which law holds the slide
        #[var(source = "our choice")]
        pub law: Law,
        /// Sample period
        #[var(unit = SECOND as "ms", range = 1e-5..=0.1, start = 1e-3, source = "our choice")]
        pub sample_period: f64,
        /// Samples between a force and its action; 1 for a standard master, 0 if it acts at once
        #[var(range = 0..=DELAY_MAX as i32, start = 1, source = "our choice: what a standard master does")]
        pub io_delay: i32,
        /// The machine
        pub slide: Slide,
        /// Motion to the target
        pub motion: Motion,
        /// Position servo
        pub servo: Servo,
        /// When the slide is where it should be
        pub settle: Settle,
        /// What is a fault
        pub limits: Limits,
    }

    /// The machine.
    pub struct Slide {
        /// Moving mass
        #[var(unit = KILOGRAM, range = 1e-3..=1e4, start = 2.0, source = "our choice")]
        pub mass: f64,
        /// Largest force
        #[var(unit = NEWTON, range = 1e-3..=1e5, start = 50.0, source = "our choice")]
        pub force_max: f64,
    }

    /// Motion to the target.
    pub struct Motion {
        /// Where the slide is brought
        #[var(unit = METRE as "mm", range = -10.0..=10.0, start = 0.05, source = "our choice")]
        pub target: f64,
        /// Largest velocity on the way
        #[var(unit = METRE_PER_SECOND as "mm/s", range = 1e-6..=10.0, start = 0.1, source = "our choice")]
        pub velocity_max: f64,
        /// Time in which a motion comes to rest when `enable` is taken away
        #[var(unit = SECOND as "ms", range = 1e-3..=10.0, start = 0.1, source = "our choice")]
        pub stop_time: f64,
    }

    /// Position servo.
    pub struct Servo {
        /// Bandwidth
        #[var(unit = RADIAN_PER_SECOND as "Hz", range = 0.1..=1e4, start = 15.0 * TAU, source = "our choice")]
        pub bandwidth: f64,
        /// Damping ratio
        #[var(unit = ONE, range = 0.1..=10.0, start = 1.0, source = "our choice: no overshoot")]
        pub damping: f64,
        /// Bandwidth of the integral
        #[var(unit = RADIAN_PER_SECOND as "Hz", range = 0.0..=1e3, start = 30.0, paper = 0.0, source = "our choice: less than `check.rs` allows")]
        pub integral_bandwidth: f64,
    }

    /// When the slide is where it should be.
    pub struct Settle {
        /// Largest error
        #[var(unit = METRE as "um", range = 1e-9..=0.1, start = 2e-5, source = "our choice")]
        pub band: f64,
        /// For so long without a break
        #[var(unit = SECOND as "ms", range = 0.0..=10.0, start = 0.05, source = "our choice")]
        pub time: f64,
    }

    /// What is a fault.
    pub struct Limits {
        /// Largest following error
        #[var(unit = METRE as "mm", range = 1e-6..=1.0, start = 1e-3, source = "our choice: some times what friction leaves")]
        pub following_error: f64,
    }
}
