//! Force and position control with stick-slip motion for polishing molds (Nagata and others, 2010), as an FMU.
//!
//! This file is the FMU: its variables and the calls into the law. [`controller::Controller`] is the law,
//! plain Rust that knows nothing of FMI.
#![forbid(unsafe_code)]

pub mod axes;
pub mod check;
pub mod cl_file;
pub mod controller;
pub mod drive;
pub mod feed;
pub mod force;
pub mod impedance;
pub mod machine;
mod messages;
pub mod misalignment;
pub mod motion;
pub mod parameters;
pub mod path;
pub mod position;
pub mod press;
pub mod pulses;
pub mod reading;
pub mod ripple;
pub mod signals;
pub mod stick_slip;
pub mod stiffness;
pub mod texts;
pub mod watch;

use fmi2_export::units::{
    KILOGRAM, METRE, METRE_PER_SECOND, METRE_PER_SECOND_SQUARED, NEWTON, NEWTON_PER_METRE, ONE, RADIAN,
    RADIAN_PER_SECOND, SECOND,
};
use fmi2_export::{
    Env, Error, Info, Model, Start, Unit, Variable, boolean, choice, enumeration, export, integer, real, text,
};
use serde::{Deserialize, Serialize};

use controller::Controller;
use force::ForceMode;
use machine::{Fault, State};
use parameters::{FeedSource, Parameters};
use signals::{Input, Output};
use stick_slip::{Mode, Wave};
use texts::Texts;

enumeration! { State, "What the controller is doing" {
    Idle = 1, "At rest; takes the zero of the force sensor after `enable`",
    Approach = 2, "Moves along the first normal until the tool touches",
    Settle = 3, "Builds up the force",
    Follow = 4, "Follows the path",
    Unload = 5, "Takes the force away",
    Retract = 6, "Moves out along the normal",
    Done = 7, "At rest after the job",
    Fault = 8, "At rest, or moving out; `reset_fault` without `enable` ends it",
} }

enumeration! { Fault, "Why the controller is in the fault state" {
    None = 1, "No fault",
    ForceLimit = 2, "The force was above `limits.force`",
    SettleTimeout = 3, "The force was not settled within `settle.time_max`",
    LostContact = 4, "The force was below `limits.lost_force` for `limits.lost_time`",
    InvalidInput = 5, "An input is NaN, infinite or absurd",
    InvalidPath = 6, "The force does not point along the normals of the path",
    ApproachTimeout = 7, "No contact within `approach.distance_max`",
    PositionError = 8, "The tool was more than `limits.position_error` off along the path or beside it",
    Stroke = 9, "The position is outside `stroke`",
    EmergencyStop = 10, "`estop` was set",
    TareRejected = 11, "The force was above `tare.force_max` when the zero was taken",
    NotAtStart = 12, "The tool was not above the begin of the path",
    SurfaceError = 13, "The surface was further from the path than `limits.surface_error`",
} }

enumeration! { ForceMode, "What of the measured force is controlled" {
    Norm = 1, "Its norm, friction included, as in the paper",
    Projected = 2, "Its part along the normal",
} }

enumeration! { Mode, "Where the stick-slip vector points" {
    Off = 1, "No stick-slip",
    Paper = 2, "Position vector in the tangent plane, as in the paper",
    Cross = 3, "Normal cross tangent, always beside the path",
} }

enumeration! { Wave, "Wave form of the stick-slip velocity" {
    Square = 1, "Square, as in the paper",
    Sine = 2, "Sine that travels equally far",
} }

enumeration! { FeedSource, "Where the feed comes from" {
    Parameter = 1, "`feed.velocity`",
    File = 2, "FEDRAT in the CL file",
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
    /// Texts among the parameters.
    pub text: Texts,
}

impl Start for Vars {
    const START: Self =
        Self { input: Input::START, output: Output::START, parameters: Parameters::DEFAULT, text: Texts::EMPTY };
}

/// Unit of a damping.
const NEWTON_SECOND_PER_METRE: Unit = Unit::si("N.s/m", [1, 0, -1, 0, 0], &[]);
/// Unit of a gain from an error to its rate.
const PER_SECOND: Unit = Unit::si("1/s", [0, 0, -1, 0, 0], &[]);
/// Unit of the integral gain of the position.
const PER_SECOND_SQUARED: Unit = Unit::si("1/s2", [0, 0, -2, 0, 0], &[]);
/// Unit of an integrated length.
const METRE_SECOND: Unit = Unit::si("m.s", [0, 1, 1, 0, 0], &[]);

/// The FMU.
pub struct Polish;

impl Model for Polish {
    const INFO: Info = Info {
        name: "StickSlipPolishing",
        identifier: "fmu_polish",
        description: "Polishes a mold along CL data with controlled force and stick-slip motion (Nagata and others, \
                      AROB 2010)",
        state_version: 1,
        stop_time: 60.0,
        step_size: 1e-3,
        ..fmi2_export::package!()
    };
    type Vars = Vars;
    type State = Controller;

    #[rustfmt::skip]
    const VARIABLES: &'static [Variable<Vars>] = &[
        // inputs
        real!(Vars.input => position.x).input().unit(&METRE).display("mm").accepts_nan().describe("Ball centre by the encoders, x in the work frame of the path"),
        real!(Vars.input => position.y).input().unit(&METRE).display("mm").accepts_nan().describe("Ball centre by the encoders, y"),
        real!(Vars.input => position.z).input().unit(&METRE).display("mm").accepts_nan().describe("Ball centre by the encoders, z, out of the mold"),
        real!(Vars.input => force.x).input().unit(&NEWTON).accepts_nan().describe("Raw force on the tool, x in the work frame"),
        real!(Vars.input => force.y).input().unit(&NEWTON).accepts_nan().describe("Raw force on the tool, y"),
        real!(Vars.input => force.z).input().unit(&NEWTON).accepts_nan().describe("Raw force on the tool, z"),
        real!(Vars.input => feed_override).input().unit(&ONE).display("%").accepts_nan().describe("Factor of the feed, 0 to 2"),
        real!(Vars.input => force_override).input().unit(&ONE).display("%").accepts_nan().describe("Factor of the wanted force, 0 to 2"),
        boolean!(Vars.input => enable).input().describe("Rising edge starts a job: zero of the sensor, approach, ...; false ends it"),
        boolean!(Vars.input => estop).input().describe("Stops at once"),
        boolean!(Vars.input => reset_fault).input().describe("Rising edge ends a fault, while `enable` is false and the tool at rest"),
        // outputs
        real!(Vars.output => velocity.x).output().unit(&METRE_PER_SECOND).display("mm/s").describe("Velocity command, x, eq. 1"),
        real!(Vars.output => velocity.y).output().unit(&METRE_PER_SECOND).display("mm/s").describe("Velocity command, y"),
        real!(Vars.output => velocity.z).output().unit(&METRE_PER_SECOND).display("mm/s").describe("Velocity command, z"),
        integer!(Vars.output => pulses.x).output().describe("Pulses of this sample, x"),
        integer!(Vars.output => pulses.y).output().describe("Pulses of this sample, y"),
        integer!(Vars.output => pulses.z).output().describe("Pulses of this sample, z"),
        real!(Vars.output => velocity.normal).output().unit(&METRE_PER_SECOND).display("mm/s").describe("Part of the force law v_normal, positive out of the material, eq. 3"),
        real!(Vars.output => velocity.tangential).output().unit(&METRE_PER_SECOND).display("mm/s").describe("Part of the feed v_t, of the ball centre, eq. 2"),
        real!(Vars.output => velocity.position).output().unit(&METRE_PER_SECOND).display("mm/s").describe("Size of the part of the position feedback v_p, eq. 6"),
        real!(Vars.output => velocity.stick_slip).output().unit(&METRE_PER_SECOND).display("mm/s").describe("Part of the stick-slip v_v with its sign, eq. 16"),
        real!(Vars.output => force.measured).output().unit(&NEWTON).describe("Controlled force: norm or normal part, without the zero of the sensor"),
        real!(Vars.output => force.setpoint).output().unit(&NEWTON).describe("Wanted force F_d with its ramps"),
        real!(Vars.output => force.error).output().unit(&NEWTON).describe("Force error E_f, eq. 5"),
        real!(Vars.output => desired.x).output().unit(&METRE).display("mm").describe("Desired ball centre x_d, x"),
        real!(Vars.output => desired.y).output().unit(&METRE).display("mm").describe("Desired ball centre x_d, y"),
        real!(Vars.output => desired.z).output().unit(&METRE).display("mm").describe("Desired ball centre x_d, z"),
        real!(Vars.output => normal.x).output().unit(&ONE).describe("Unit normal o_d out of the material, x"),
        real!(Vars.output => normal.y).output().unit(&ONE).describe("Unit normal o_d out of the material, y"),
        real!(Vars.output => normal.z).output().unit(&ONE).describe("Unit normal o_d out of the material, z"),
        real!(Vars.output => tangent.x).output().unit(&ONE).describe("Unit tangent t, x"),
        real!(Vars.output => tangent.y).output().unit(&ONE).describe("Unit tangent t, y"),
        real!(Vars.output => tangent.z).output().unit(&ONE).describe("Unit tangent t, z"),
        real!(Vars.output => error.tangential).output().unit(&METRE).display("um").describe("Position error x_d - x along t"),
        real!(Vars.output => error.lateral).output().unit(&METRE).display("um").describe("Position error along o_d x t"),
        real!(Vars.output => error.normal).output().unit(&METRE).display("um").describe("Position error along o_d"),
        real!(Vars.output => progress).output().unit(&ONE).display("%").describe("Part of the path that is done"),
        choice!(Vars.output => state: State).output().describe("What the controller is doing"),
        choice!(Vars.output => fault: Fault).output().describe("Why it is in the state Fault"),
        boolean!(Vars.output => in_contact).output().describe("The tool presses on the mold"),
        boolean!(Vars.output => done).output().describe("The whole path is polished and the tool retracted"),
        real!(Vars.output => stiffness.estimate).output().unit(&NEWTON_PER_METRE).display("N/mm").describe("Stiffness of tool and contact, estimated while the force builds up"),
        real!(Vars.output => misalignment.x).output().unit(&METRE).display("um").describe("Estimated shift of the mold, x"),
        real!(Vars.output => misalignment.y).output().unit(&METRE).display("um").describe("Estimated shift of the mold, y"),
        real!(Vars.output => misalignment.z).output().unit(&METRE).display("um").describe("Estimated shift of the mold, z"),
        real!(Vars.output => misalignment.rx).output().unit(&RADIAN).display("deg").describe("Estimated rotation of the mold about x"),
        real!(Vars.output => misalignment.ry).output().unit(&RADIAN).display("deg").describe("Estimated rotation of the mold about y"),
        real!(Vars.output => misalignment.rz).output().unit(&RADIAN).display("deg").describe("Estimated rotation of the mold about z"),
        boolean!(Vars.output => ripple.frozen).output().describe("A part of the ripple cancellation made it worse and has ended"),
        real!(Vars.output => path.length).output().unit(&METRE).display("mm").describe("Length of the path along the contact points"),
        // machine
        real!(Vars.parameters => sample_period).parameter().unit(&SECOND).display("ms").range(2e-4, 5e-3).describe("Sample period"),
        real!(Vars.parameters => tool.radius).parameter().unit(&METRE).display("mm").range(5e-5, 0.02).describe("Radius of the ball end"),
        real!(Vars.parameters => stroke.x).parameter().unit(&METRE).display("mm").range(1e-3, 10.0).describe("Stroke along x, the origin of the path in its middle"),
        real!(Vars.parameters => stroke.y).parameter().unit(&METRE).display("mm").range(1e-3, 10.0).describe("Stroke along y"),
        real!(Vars.parameters => stroke.z).parameter().unit(&METRE).display("mm").range(1e-3, 10.0).describe("Stroke along z"),
        real!(Vars.parameters => pulses.size).parameter().unit(&METRE).display("um").range(1e-9, 1e-4).describe("Way of one pulse"),
        real!(Vars.parameters => drive.position_gain).parameter().unit(&PER_SECOND).range(1.0, 1e4).describe("Gain of the position loop of the drives, for the phases of the ripple"),
        real!(Vars.parameters => drive.feedforward).parameter().unit(&ONE).range(0.0, 1.0).describe("Part of the velocity that the drives feed forward"),
        real!(Vars.parameters => drive.feedforward_bandwidth).parameter().unit(&RADIAN_PER_SECOND).display("Hz").range(1.0, 1e5).describe("Bandwidth of the velocity feedforward"),
        real!(Vars.parameters => drive.velocity_bandwidth).parameter().unit(&RADIAN_PER_SECOND).display("Hz").range(10.0, 1e5).describe("Bandwidth of the velocity loop"),
        real!(Vars.parameters => drive.velocity_integral).parameter().unit(&PER_SECOND).range(0.0, 1e4).describe("Integral action of the velocity loop"),
        integer!(Vars.parameters => drive.io_delay).parameter().range_int(0, 8).describe("Samples between a command and its action; 1 for a standard master, 0 if the command acts at once"),
        real!(Vars.parameters => sensor.bandwidth).parameter().unit(&RADIAN_PER_SECOND).display("Hz").range(10.0, 1e6).describe("Bandwidth of the filter of the force sensor"),
        // path and feed
        text!(Vars.text => path.file).parameter().start_text(cl_file::BUILT_IN).describe("CL file with contact points and normals, in the folder resources of the FMU or with its whole path; the start value is built in"),
        real!(Vars.parameters => path.slope_max).parameter().unit(&RADIAN).display("deg").range(0.1, 1.5).describe("Steepest surface that is polished"),
        choice!(Vars.parameters => feed.source: FeedSource).parameter().describe("Where the feed comes from"),
        real!(Vars.parameters => feed.velocity).tunable().unit(&METRE_PER_SECOND).display("mm/s").range(1e-6, 0.1).describe("Velocity v_tangent of the contact point, eq. 2"),
        real!(Vars.parameters => feed.acceleration).parameter().unit(&METRE_PER_SECOND_SQUARED).range(1e-3, 10.0).describe("Largest acceleration along the path"),
        real!(Vars.parameters => feed.turn_rate_max).parameter().unit(&RADIAN_PER_SECOND).range(1.0, 1e3).describe("Fastest turn of the direction of motion; slows the feed where the path bends"),
        // force law
        real!(Vars.parameters => force.target).tunable().unit(&NEWTON).range(0.1, 100.0).describe("Desired polishing force F_d"),
        choice!(Vars.parameters => force.mode: ForceMode).parameter().describe("What of the measured force is controlled, eq. 5"),
        real!(Vars.parameters => force.filter_bandwidth).parameter().unit(&RADIAN_PER_SECOND).display("Hz").range(0.0, 1e5).describe("Low-pass of the measured force; 0 for none"),
        real!(Vars.parameters => force.integral_time).tunable().unit(&SECOND).range(0.0, 100.0).describe("Time T_i of the force integral; 0 for none"),
        real!(Vars.parameters => impedance.mass).parameter().unit(&KILOGRAM).range(0.01, 1e4).describe("Desired mass M_d, eq. 4"),
        real!(Vars.parameters => impedance.damping).tunable().unit(&NEWTON_SECOND_PER_METRE).range(10.0, 1e7).describe("Desired damping B_d, eq. 4; with `impedance.adaptive` until the stiffness is known"),
        real!(Vars.parameters => impedance.gain).tunable().unit(&ONE).range(0.0, 100.0).describe("Force feedback gain K_f, eq. 4"),
        boolean!(Vars.parameters => impedance.adaptive).parameter().describe("After settling take the damping that the estimated stiffness needs"),
        real!(Vars.parameters => impedance.bandwidth).parameter().unit(&PER_SECOND).range(1.0, 100.0).describe("Wanted loop gain K_f k / B_d, with `impedance.adaptive`"),
        real!(Vars.parameters => stiffness.nominal).parameter().unit(&NEWTON_PER_METRE).display("N/mm").range(1e3, 1e8).describe("Stiffness of tool and contact before it is estimated"),
        // position feedback
        real!(Vars.parameters => position.gain.x).tunable().unit(&PER_SECOND).range(0.0, 200.0).describe("Gain K_px, eq. 6"),
        real!(Vars.parameters => position.gain.y).tunable().unit(&PER_SECOND).range(0.0, 200.0).describe("Gain K_py"),
        real!(Vars.parameters => position.gain.z).tunable().unit(&PER_SECOND).range(0.0, 200.0).describe("Gain K_pz"),
        real!(Vars.parameters => position.integral.x).tunable().unit(&PER_SECOND_SQUARED).range(0.0, 1e4).describe("Integral gain K_ix, the paper's over the sample period"),
        real!(Vars.parameters => position.integral.y).tunable().unit(&PER_SECOND_SQUARED).range(0.0, 1e4).describe("Integral gain K_iy"),
        real!(Vars.parameters => position.integral.z).tunable().unit(&PER_SECOND_SQUARED).range(0.0, 1e4).describe("Integral gain K_iz"),
        real!(Vars.parameters => position.integral_max).parameter().unit(&METRE_SECOND).range(0.0, 1.0).describe("Limit of the integrated position error"),
        boolean!(Vars.parameters => position.select.x).parameter().describe("Switch S_x"),
        boolean!(Vars.parameters => position.select.y).parameter().describe("Switch S_y"),
        boolean!(Vars.parameters => position.select.z).parameter().describe("Switch S_z"),
        boolean!(Vars.parameters => position.projected).parameter().describe("Position feedback in the tangent plane alone; false as in the paper"),
        // stick-slip
        choice!(Vars.parameters => stick_slip.mode: Mode).parameter().describe("Where the stick-slip vector points"),
        real!(Vars.parameters => stick_slip.velocity).tunable().unit(&METRE_PER_SECOND).display("mm/s").range(0.0, 0.1).describe("Velocity K_v, eq. 16"),
        integer!(Vars.parameters => stick_slip.half_period).parameter().range_int(1, 1000).describe("Samples of one sign, 1 for eq. 17"),
        choice!(Vars.parameters => stick_slip.wave: Wave).parameter().describe("Wave form of the velocity"),
        real!(Vars.parameters => stick_slip.ratio).tunable().unit(&ONE).range(0.0, 100.0).describe("K_v over the feed, keeps the removal per length; 0 for `stick_slip.velocity`"),
        real!(Vars.parameters => ripple.gain).parameter().unit(&PER_SECOND).range(0.0, 20.0).describe("Rate at which the force ripple at the frequency of the stick-slip and twice that is cancelled; 0 for none"),
        real!(Vars.parameters => ripple.growth_max).parameter().unit(&NEWTON).range(0.01, 10.0).describe("Growth of a ripple that ends its cancellation"),
        // misalignment
        boolean!(Vars.parameters => misalignment.enable).parameter().describe("Estimate shift and rotation of the mold and feed them forward"),
        real!(Vars.parameters => misalignment.forgetting).parameter().unit(&ONE).range(0.99, 1.0).describe("Forgetting factor of the least squares"),
        real!(Vars.parameters => misalignment.lead_time).parameter().unit(&SECOND).display("ms").range(0.0, 0.1).describe("Time by which the feedforward is ahead"),
        real!(Vars.parameters => misalignment.distance_min).parameter().unit(&METRE).display("mm").range(0.0, 1.0).describe("Path before the feedforward begins"),
        // job
        real!(Vars.parameters => tare.time).parameter().unit(&SECOND).range(1e-3, 10.0).describe("Time over which the zero of the sensor is averaged"),
        real!(Vars.parameters => tare.force_max).parameter().unit(&NEWTON).range(0.1, 100.0).describe("Largest force that may be a zero"),
        real!(Vars.parameters => approach.velocity).parameter().unit(&METRE_PER_SECOND).display("mm/s").range(1e-5, 0.01).describe("Velocity of the approach"),
        real!(Vars.parameters => approach.contact_force).parameter().unit(&NEWTON).range(0.05, 50.0).describe("Force that is a contact"),
        integer!(Vars.parameters => approach.contact_samples).parameter().range_int(1, 100).describe("Samples in a row above it"),
        real!(Vars.parameters => approach.distance_max).parameter().unit(&METRE).display("mm").range(1e-5, 0.1).describe("Longest way without contact"),
        real!(Vars.parameters => approach.offset_max).parameter().unit(&METRE).display("mm").range(1e-6, 0.05).describe("Largest distance beside the begin of the path, and below it"),
        real!(Vars.parameters => settle.ramp_time).parameter().unit(&SECOND).range(1e-3, 10.0).describe("Time in which the wanted force rises and falls"),
        real!(Vars.parameters => settle.tolerance).parameter().unit(&ONE).display("%").range(0.01, 0.5).describe("Force error that is settled, part of `force.target`"),
        real!(Vars.parameters => settle.hold_time).parameter().unit(&SECOND).range(1e-3, 10.0).describe("Time for which the error must stay there"),
        real!(Vars.parameters => settle.time_max).parameter().unit(&SECOND).range(0.01, 60.0).describe("Longest time of settling and of unloading"),
        real!(Vars.parameters => retract.distance).parameter().unit(&METRE).display("mm").range(1e-5, 0.1).describe("Distance of the retract"),
        real!(Vars.parameters => retract.velocity).parameter().unit(&METRE_PER_SECOND).display("mm/s").range(1e-5, 0.1).describe("Velocity of the retract"),
        real!(Vars.parameters => limits.force).parameter().unit(&NEWTON).range(0.5, 1e3).describe("Largest force"),
        real!(Vars.parameters => limits.lost_force).parameter().unit(&NEWTON).range(0.0, 50.0).describe("Force below which contact is lost"),
        real!(Vars.parameters => limits.lost_time).parameter().unit(&SECOND).range(1e-3, 10.0).describe("Time below that force that is a fault"),
        real!(Vars.parameters => limits.position_error).parameter().unit(&METRE).display("mm").range(1e-6, 0.05).describe("Largest position error along the path or beside it"),
        real!(Vars.parameters => limits.surface_error).parameter().unit(&METRE).display("mm").range(1e-6, 0.05).describe("Largest distance of the surface from the path along the normal"),
        real!(Vars.parameters => limits.force_angle).parameter().unit(&RADIAN).display("deg").range(0.1, 3.0).describe("Largest angle between the mean force and the normal"),
        real!(Vars.parameters => limits.velocity).parameter().unit(&METRE_PER_SECOND).display("mm/s").range(1e-3, 1.0).describe("Largest commanded velocity"),
    ];

    fn period(vars: &Vars) -> f64 {
        vars.parameters.sample_period
    }

    fn initialise(vars: &mut Vars, env: &mut Env) -> Result<Controller, Error> {
        let text = |error: control_blocks::ParameterError| error.to_string();
        let points = cl_file::read(&vars.text.path.file, env.resources(), &vars.parameters).map_err(text)?;
        let controller = Controller::new(&vars.parameters, &points).map_err(text)?;
        vars.output.path.length = controller.path().length();
        Ok(controller)
    }

    fn tick(vars: &mut Vars, controller: &mut Controller, env: &mut Env) -> Result<(), Error> {
        let (state, frozen) = (vars.output.state, vars.output.ripple.frozen);
        controller.tick(&vars.parameters, &vars.input, &mut vars.output);
        if vars.output.state != state {
            messages::tell_state(vars, env);
        }
        if vars.output.ripple.frozen && !frozen {
            messages::tell_frozen(env);
        }
        Ok(())
    }
}

export!(Polish);
