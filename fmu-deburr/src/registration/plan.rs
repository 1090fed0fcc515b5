//! Requirements of touching: positions that the robot must reach, the time, and the uncertainty of a touch.
//!
//! At each touch the tip comes from outside at `expert.register.speed`, returns by `expert.register.retract` from where
//! it has detected the part, returns at `expert.register.touch_speed`, and returns to where it came from. Contact is
//! reported by the samples: the surface was between the tips of two, so half a sample of way is taken off, and what is
//! left is spread evenly over a sample, v T/sqrt(12); in addition to it are half a count of the encoders, in both tips,
//! and `expert.register.touch_std`.

use control_blocks::{ParameterError, commission_time, quintic_duration};

use crate::interface::Parameters;
use crate::path::feasible;
use crate::path::geometry::Vector;
use crate::path::kinematics::{AXES, Joints};
use crate::path::programmed_path::ProgrammedPath;
use crate::path::route::Route;
use crate::path::touch::Touch;

/// Axes at the start of the approach to a touch, near others.
pub fn outside(p: &Parameters, touch: &Touch, near: &Joints) -> Joints {
    p.arm.inverse(&touch.at(0.0), near).unwrap_or(*near)
}

/// Time of a return (m), s.
pub fn back_time(p: &Parameters, distance: f64) -> f64 {
    quintic_duration(distance.abs(), p.register.speed).max(p.sample_period)
}

/// Longest time of a registration that begins at rest at `from`, s: as configured, or as of a commissioning run with
/// these motions.
pub fn time(p: &Parameters, path: &ProgrammedPath, from: &Joints, inside: bool) -> f64 {
    commission_time(p.register.time, || motions(p, path, from, inside))
}

/// Time of all motions, s.
fn motions(p: &Parameters, path: &ProgrammedPath, from: &Joints, inside: bool) -> f64 {
    let (mut from, mut inside, mut time) = (*from, inside, 0.0);
    let register = &p.register;
    let bridged = f64::from(p.limits.lost_samples + 1) * p.sample_period;
    // up to speed and down again takes as long as the speed over the acceleration more
    let stops = 2.0 * register.speed / p.feed.acceleration;
    for touch in &path.touches {
        let to = outside(p, touch, &from);
        let deep = 2.0 * touch.approach;
        let seek = deep / register.speed + bridged + stops;
        let again = 2.0 * register.retract / register.touch_speed + bridged + stops;
        time += Route::around(p, &from, &to, inside).time() + seek + again + 2.0 * back_time(p, deep);
        (from, inside) = (to, true);
    }
    time
}

/// Standard deviation of a touch at which the axes are at `joints`, along the normal, m.
pub fn deviation(p: &Parameters, normal: &Vector, joints: &Joints) -> f64 {
    let tip = p.arm.forward(joints).tip;
    let count = |i: usize| {
        let mut moved = *joints;
        moved[i] += p.axis[i].pulse;
        (p.arm.forward(&moved).tip - tip).dot(normal)
    };
    let counts = (0..AXES).map(|i| count(i).powi(2)).sum::<f64>() / 24.0;
    let distance = p.register.touch_speed * p.sample_period;
    (distance * distance / 12.0 + counts + p.register.touch_std.powi(2)).sqrt()
}

/// Every touch must be within the travel of the axes, drawn back along the tool as well.
///
/// # Errors
/// Names the touch, the axis, its value and its limit.
pub fn check(p: &Parameters, path: &ProgrammedPath, start: &Joints) -> Result<(), ParameterError> {
    let wrong = |number: usize, what: String| ParameterError {
        name: "path.file",
        value: p.path.file.clone(),
        limit: format!("a path whose touches the robot can reach: touch {}: {what}", number + 1),
        hint: "touch at other positions, reduce `approach_m`, or widen `axisN.minimum` and `.maximum`",
    };
    for (number, touch) in path.touches.iter().enumerate() {
        for distance in [0.0, 2.0 * touch.approach] {
            let joints = p.arm.inverse(&touch.at(distance), start);
            let joints = joints.ok_or_else(|| wrong(number, "the wrist is on the axis of the column".to_owned()))?;
            for joints in [joints, p.arm.retracted(&joints, p.transfer.clearance)] {
                feasible::travel(p, &joints).map_err(|what| wrong(number, what.text(p)))?;
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learning::pattern::tests::straight;
    use crate::path::touch::tests::touch;

    fn touched() -> ProgrammedPath {
        let mut path = straight(0.1);
        path.touches = vec![touch(0.7, 0.0, 0.0), touch(0.7, 0.05, 0.0)];
        path
    }

    #[test]
    fn a_touch_is_as_certain_as_a_sample_and_a_count() {
        let mut p = Parameters::START;
        (p.register.touch_std, p.register.touch_speed) = (0.0, 1e-3);
        let joints = [0.0, 0.0, 0.7, 0.0, 0.0, 0.0];
        // out along the arm: 10 um of way in a sample, counts of 5 um, and those of the pitch at the length of the tool
        let squares = 1e-10 / 12.0 + (25e-12 + (0.2 * p.axis[4].pulse).powi(2)) / 24.0;
        let std = deviation(&p, &Vector::new(1.0, 0.0, 0.0), &joints);
        assert!((std - squares.sqrt()).abs() < 1e-11, "{std}");
        // across it: counts of axis 1 at 0.7 m; the wrist is above its tip
        let std = deviation(&p, &Vector::new(0.0, 1.0, 0.0), &joints);
        assert!((std - (1e-10 / 12.0 + (0.7 * p.axis[0].pulse).powi(2) / 24.0).sqrt()).abs() < 1e-9, "{std}");
        p.register.touch_std = 3e-6;
        let std = deviation(&p, &Vector::new(1.0, 0.0, 0.0), &joints);
        assert!((std - (squares + 9e-12).sqrt()).abs() < 1e-11, "{std}");
    }

    #[test]
    fn the_time_is_a_quarter_more_than_the_motions_or_as_configured() {
        let (mut p, path) = (Parameters::START, touched());
        let from = outside(&p, &path.touches[0], &[0.0, 0.0, 0.7, 0.0, 0.0, 0.0]);
        let register = &p.register;
        let seek = 1e-2 / register.speed + 0.04 + 2.0 * register.speed / p.feed.acceleration;
        let again = 2.0 * register.retract / register.touch_speed + 0.04 + 2.0 * register.speed / p.feed.acceleration;
        let one = seek + again + 2.0 * 1.875 * 1e-2 / register.speed;
        // up and in again, and for the second one across as well
        let legs = 5.0 * p.transfer.time;
        let expected = 1.25 * (2.0 * one + legs) + 1.0;
        let found = time(&p, &path, &from, true);
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        p.register.time = 7.0;
        assert_eq!(time(&p, &path, &from, true), 7.0);
    }

    #[test]
    fn a_touch_out_of_reach_is_rejected_with_its_number() {
        let (mut p, path) = (Parameters::START, touched());
        let start = [0.0, 0.0, 0.7, 0.0, 0.0, 0.0];
        assert!(check(&p, &path, &start).is_ok());
        // the second one is farther out
        p.axis[2].maximum = 0.7055;
        let message = check(&p, &path, &start).unwrap_err().to_string();
        assert!(message.contains("touch 2: `axis3` is `0.70") && message.contains("hint:"), "{message}");
        p = Parameters::START;
        p.axis[1].maximum = 0.03;
        assert!(check(&p, &path, &start).unwrap_err().to_string().contains("touch 1: `axis2`"));
    }
}
