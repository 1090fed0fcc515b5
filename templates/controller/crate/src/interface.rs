//! Every variable of the FMU, declared once.
//!
//! Sources: "derived" = follows from the equations; "default" = usual practice, with its reason.

pub use variables::*;

#[fmi2_export::interface]
mod variables {
    use std::f64::consts::TAU;

    use control_blocks::{DELAY_MAX, Reaction};
    use fmi2_export::units::{KILOGRAM, METRE, METRE_PER_SECOND, NEWTON, ONE, RADIAN_PER_SECOND, SECOND};

    /// State of the controller
    pub enum State {
        /// Comes to rest, holds the position and waits for a rising edge of enable
        Idle,
        /// Moves to the target
        Run,
        /// Holds the target until enable is false
        Done,
        /// Performs the reaction of the fault and waits for a rising edge of reset_fault
        Fault,
    }

    /// Why the controller is in the fault state
    #[reactions(Reaction,
        DriveOff = ["Sets `force` to zero", "Rising edge of `reset_fault` at rest"])]
    pub enum Fault {
        /// No fault
        None,
        /// The slide is too far from its setpoint
        #[reaction(DriveOff)]
        #[detection("The absolute following error exceeds `limits.following_error`")]
        #[hint(
            "Check that the slide moves freely. Reduce `motion.velocity_max`, or increase `limits.following_error`."
        )]
        FollowingError,
        /// The position is NaN, infinite or out of range
        #[reaction(DriveOff)]
        #[detection("`position` is NaN, infinite or beyond 100 m")]
        #[hint("Check the connection and the unit of `position`.")]
        PositionLost,
    }

    /// Control law
    pub enum Law {
        /// PD with an integral that compensates friction
        Default,
        /// As published: PD without an integral; friction leaves an error
        Paper,
    }

    /// Inputs, sampled at the start of the control step.
    #[inputs]
    pub struct Input {
        /// Encoder of the slide
        #[var(unit = METRE as "mm", accepts_nan)]
        pub position: f64,
        /// Rising edge in Idle starts a motion; false stops it
        pub enable: bool,
        /// Rising edge at rest acknowledges a fault
        pub reset_fault: bool,
    }

    /// Outputs; always finite.
    #[outputs]
    pub struct Output {
        /// Force on the slide
        #[var(unit = NEWTON)]
        pub force: f64,
        /// Position setpoint
        #[var(unit = METRE as "mm")]
        pub setpoint: f64,
        /// Setpoint minus position
        #[var(unit = METRE as "um")]
        pub following_error: f64,
        /// State of the controller
        pub state: State,
        /// Why the controller is in the fault state
        pub fault: Fault,
    }

    /// All parameters.
    #[parameters]
    pub struct Parameters {
        /// Control law
        #[var(source = "default; compensates friction")]
        pub law: Law,
        /// Sample period
        #[var(unit = SECOND as "ms", range = 1e-5..=0.1, start = 1e-3, essential, source = "default; usual drive rate")]
        pub sample_period: f64,
        /// Samples between a command and its action; 1 with a standard master, 0 if immediate
        #[var(range = 0..=DELAY_MAX as i32, start = 1, essential, source = "default; a standard master")]
        pub io_delay: i32,
        /// The machine
        pub slide: Slide,
        /// Motion to the target
        pub motion: Motion,
        /// Position servo
        pub servo: Servo,
        /// Decision that the slide has arrived
        pub settle: Settle,
        /// Limits of the faults
        pub limits: Limits,
    }

    /// The machine.
    pub struct Slide {
        /// Moving mass
        #[var(unit = KILOGRAM, range = 1e-3..=1e4, start = 2.0, essential, source = "default; mass of the plant")]
        pub mass: f64,
        /// Maximum force of the drive
        #[var(unit = NEWTON, range = 1e-3..=1e5, start = 50.0, essential, source = "default; below the limit of the plant")]
        pub force_max: f64,
    }

    /// Motion to the target.
    pub struct Motion {
        /// Target position
        #[var(unit = METRE as "mm", range = -10.0..=10.0, start = 0.05, essential, source = "default; motion of the scenario")]
        pub target: f64,
        /// Maximum velocity of the motion
        #[var(unit = METRE_PER_SECOND as "mm/s", range = 1e-6..=10.0, start = 0.1, essential, source = "default; motion of the scenario")]
        pub velocity_max: f64,
        /// Time of a stop after enable has become false
        #[var(unit = SECOND as "ms", range = 1e-3..=10.0, start = 0.1, source = "default; a gentle stop")]
        pub stop_time: f64,
    }

    /// Position servo.
    pub struct Servo {
        /// Bandwidth of the position servo
        #[var(unit = RADIAN_PER_SECOND as "Hz", range = 0.1..=1e4, start = 15.0 * TAU, essential, source = "default; three quarters of its limit")]
        pub bandwidth: f64,
        /// Damping ratio of the position servo
        #[var(unit = ONE, range = 0.1..=10.0, start = 1.0, source = "default; no overshoot")]
        pub damping: f64,
        /// Bandwidth of the integral action; 0 without it
        #[var(unit = RADIAN_PER_SECOND as "Hz", range = 0.0..=1e3, start = 30.0, paper = 0.0, source = "default; two thirds of its limit")]
        pub integral_bandwidth: f64,
    }

    /// Decision that the slide has arrived.
    pub struct Settle {
        /// Maximum error of an arrived slide
        #[var(unit = METRE as "um", range = 1e-9..=0.1, start = 2e-5, source = "default; 20 steps of the encoder")]
        pub band: f64,
        /// Time within the band before Done
        #[var(unit = SECOND as "ms", range = 0.0..=10.0, start = 0.05, source = "default; about one period of the servo")]
        pub time: f64,
    }

    /// Limits of the faults.
    pub struct Limits {
        /// Maximum following error
        #[var(unit = METRE as "mm", range = 1e-6..=1.0, start = 1e-3, source = "default; several times the error of friction")]
        pub following_error: f64,
    }
}
