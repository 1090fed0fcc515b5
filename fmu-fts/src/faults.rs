//! Every fault is found here; and the numbers that are told with it.

use crate::interface::{Fault, Parameters, Vars};
use crate::path::feasibility::{available_torque, needed_torque};
use crate::path::path_table::PathTable;

/// A table that leaves out more is told to the user, m.
const TRUNCATION_MAX: f64 = 1e-7;

/// What the faults of one sample are found from.
pub struct Situation<'a> {
    /// Every input that the law needs is believable.
    pub valid: bool,
    /// Following error at the tool, m; 0 while the position loop is open.
    pub following_error: f64,
    /// The path that is asked for, if one is.
    pub path: Option<&'a PathTable>,
    /// Slide position, m.
    pub slide_position: f64,
    /// Spindle speed, rad/s.
    pub spindle_speed: f64,
}

/// The gravest fault of this sample.
pub fn find(p: &Parameters, now: &Situation) -> Option<Fault> {
    let outside = |path: &PathTable| !path.covers(now.slide_position);
    let infeasible = |path: &PathTable| needed_torque(p, path, now.spindle_speed) > available_torque(p);
    (!now.valid)
        .then_some(Fault::InvalidInput)
        .or((now.following_error.abs() > p.limits.following_error).then_some(Fault::FollowingError))
        .or(now.path.is_some_and(outside).then_some(Fault::OutsideTable))
        .or(now.path.is_some_and(infeasible).then_some(Fault::Infeasible))
}

/// The numbers behind a fault.
pub fn numbers(vars: &Vars) -> String {
    let Vars { input, output, in_force: p, .. } = vars;
    match output.fault {
        Fault::None => String::new(),
        Fault::FollowingError => format!(": limit `{} m`", p.limits.following_error),
        Fault::Infeasible => format!(
            ": needed `{:.3} N.m` at `{:.2} rad/s`, available `{:.3} N.m`",
            output.path_torque,
            output.spindle_speed,
            available_torque(p)
        ),
        Fault::OutsideTable => format!(": `slide_position` = `{} m`", input.slide_position),
        Fault::InvalidInput => format!(
            ": `arm_angle` = `{} rad`, `spindle_angle` = `{} rad`, `slide_position` = `{} m`, `hold_angle` = `{} rad`",
            input.arm_angle, input.spindle_angle, input.slide_position, input.hold_angle
        ),
    }
}

/// A warning of a table with too few harmonics.
pub fn truncation(vars: &Vars) -> Option<String> {
    let (left_out, harmonics) = (vars.output.path_truncation, vars.in_force.path.harmonics);
    (left_out > TRUNCATION_MAX).then(|| {
        format!(
            "`path.harmonics` = `{harmonics}` leave out up to `{left_out:.1e} m` of the depth\nhint: take more harmonics, \
             or end the cut at a smaller `surface.outer_radius`"
        )
    })
}
