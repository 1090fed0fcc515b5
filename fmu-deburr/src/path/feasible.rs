//! Walks along the path before it is used: every position must be within the travel of the axes, and none too fast.

use control_blocks::ParameterError;

use crate::interface::Parameters;
use crate::path::kinematics::{AXES, Joints};
use crate::path::programmed_path::ProgrammedPath;

/// Names of the axes and their units, as in the messages.
const NAMES: [(&str, &str); AXES] =
    [("axis1", "rad"), ("axis2", "m"), ("axis3", "m"), ("axis4", "rad"), ("axis5", "rad"), ("axis6", "rad")];
/// Most positions that are looked at.
const SAMPLES_MAX: f64 = 2e5;

/// Reason why the robot cannot take a position of the path: a singularity, the travel or the speed of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hindrance {
    /// The wrist is on the axis of the column.
    Column,
    /// The axis (from 0) would be at this position (rad or m), beyond its travel.
    Travel(usize, f64),
    /// The axis (from 0) would move at this speed (rad/s or m/s), above its limit.
    Speed(usize, f64),
}

impl Hindrance {
    /// Message for the user.
    pub fn text(self, p: &Parameters) -> String {
        match self {
            Self::Column => "the wrist is on the axis of the column".to_owned(),
            Self::Travel(i, value) => {
                let ((name, unit), axis) = (NAMES[i], &p.axis[i]);
                format!("`{name}` is `{value:.4} {unit}`, limits `{}` to `{} {unit}`", axis.minimum, axis.maximum)
            }
            Self::Speed(i, speed) => {
                let (name, unit) = NAMES[i];
                format!("`{name}` moves at `{speed:.3} {unit}/s`, limit `{} {unit}/s`", p.axis[i].velocity_max)
            }
        }
    }
}

/// A position of the path that the robot cannot follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Obstacle {
    /// Distance from the start of the path, m.
    pub distance: f64,
    what: Hindrance,
    /// drawn back along the tool
    back: bool,
}

/// Axes at the start of the path; the whole path is checked at the programmed speed.
///
/// # Errors
/// Names block, distance, axis, value and limit.
pub fn start(p: &Parameters, path: &ProgrammedPath) -> Result<Joints, ParameterError> {
    walk(p, path).map_err(|Obstacle { distance, what, back }| {
        let location = path.locate(distance);
        let text = what.text(p);
        let (text, hint) = match what {
            Hindrance::Column => (text, "move the part"),
            Hindrance::Travel(..) if back => (
                format!("retracted by `transfer.clearance` = `{} m`, {text}", p.transfer.clearance),
                "move the part, or reduce `transfer.clearance`",
            ),
            Hindrance::Travel(..) => (text, "move the part, or widen `axisN.minimum` and `.maximum`"),
            Hindrance::Speed(..) => (
                text,
                "keep the wrist away from the column and the tool away from the vertical, or reduce the programmed speed",
            ),
        };
        ParameterError {
            name: "path.file",
            value: p.path.file.clone(),
            limit: format!(
                "a path the robot can follow: block {}, {:.4} m from its start: {text}",
                location.block + 1,
                location.distance
            ),
            hint,
        }
    })
}

/// Axes at the start of the path, after a walk along all of it.
///
/// # Errors
/// The first position that the robot cannot follow.
pub fn walk(p: &Parameters, path: &ProgrammedPath) -> Result<Joints, Obstacle> {
    let step = (path.speed * p.sample_period).max(path.length() / SAMPLES_MAX);
    let count = (path.length() / step).ceil() as usize;
    let mut before = upright_start(p, path, step, count);
    let mut first = None;
    for k in 0..=count {
        let distance = (k as f64 * step).min(path.length());
        let wrong = |back: bool| move |what: Hindrance| Obstacle { distance, what, back };
        let joints = p.arm.inverse(&path.at(distance), &before).ok_or(Hindrance::Column).map_err(wrong(false))?;
        travel(p, &joints).map_err(wrong(false))?;
        travel(p, &p.arm.retracted(&joints, p.transfer.clearance)).map_err(wrong(true))?;
        if first.is_some() {
            speed(p, &joints, &before, step / path.speed).map_err(wrong(false))?;
        }
        before = joints;
        first.get_or_insert(joints);
    }
    Ok(first.unwrap_or(before))
}

/// Axes to compare the first position with: on an upright start the yaw is that of the first tilted place.
fn upright_start(p: &Parameters, path: &ProgrammedPath, step: f64, count: usize) -> Joints {
    let nothing = [0.0; AXES];
    let yaw = |k: usize| {
        let joints = p.arm.inverse(&path.at((k as f64 * step).min(path.length())), &nothing)?;
        (joints[4] != 0.0).then_some(joints[3])
    };
    [0.0, 0.0, 0.0, (0..=count).find_map(yaw).unwrap_or(0.0), 0.0, 0.0]
}

/// Whether all axes are within their travel.
///
/// # Errors
/// The first axis that is not.
pub fn travel(p: &Parameters, joints: &Joints) -> Result<(), Hindrance> {
    let beyond = |i: &usize| joints[*i] < p.axis[*i].minimum || joints[*i] > p.axis[*i].maximum;
    (0..AXES).find(beyond).map_or(Ok(()), |i| Err(Hindrance::Travel(i, joints[i])))
}

fn speed(p: &Parameters, joints: &Joints, before: &Joints, time: f64) -> Result<(), Hindrance> {
    let fast = |i: usize| (joints[i] - before[i]).abs() / time;
    (0..AXES).find(|i| fast(*i) > p.axis[*i].velocity_max).map_or(Ok(()), |i| Err(Hindrance::Speed(i, fast(i))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::geometry::{Block, Pose, Vector};

    fn path(poses: &[([f64; 3], [f64; 3])]) -> ProgrammedPath {
        let poses: Vec<Pose> = poses
            .iter()
            .map(|(tip, axis)| Pose { tip: Vector::from(*tip), axis: Vector::from(*axis).normalize() })
            .collect();
        let blocks = poses.windows(2).map(|pair| Block::line(&pair[0], &pair[1]).unwrap()).collect();
        ProgrammedPath::new(blocks, 0.1, false, 4.0).unwrap()
    }

    fn message(poses: &[([f64; 3], [f64; 3])]) -> String {
        start(&Parameters::START, &path(poses)).unwrap_err().to_string()
    }

    const DOWN: [f64; 3] = [0.0, 0.0, -1.0];

    #[test]
    fn a_good_path_has_a_start() {
        let joints = start(&Parameters::START, &path(&[([0.7, 0.0, -0.2], DOWN), ([0.7, 0.1, -0.2], DOWN)])).unwrap();
        assert!((joints[2] - 0.7).abs() < 1e-12 && joints[1].abs() < 1e-12);
    }

    #[test]
    fn an_upright_start_has_the_yaw_that_comes() {
        let poses = [([0.7, 0.0, -0.2], DOWN), ([0.7, 0.1, -0.2], [0.0, 0.3, -1.0])];
        let joints = start(&Parameters::START, &path(&poses)).unwrap();
        assert!((joints[3] - std::f64::consts::FRAC_PI_2).abs() < 0.01, "{joints:?}");
    }

    #[test]
    fn a_tool_that_rotates_about_the_vertical_near_it_is_rejected() {
        // tilt of 0.001, azimuth rotates by 180 degrees in 1 mm
        let poses = [([0.7, 0.0, -0.2], [0.1, 0.001, -1.0]), ([0.7, 0.1, -0.2], [-0.1, 0.001, -1.0])];
        let message = message(&poses);
        assert!(message.contains("block 1, 0.0") && message.contains("`axis4` moves at"), "{message}");
    }

    #[test]
    fn a_tool_that_cannot_be_retracted_is_rejected() {
        let path = path(&[([0.7, 0.0, 0.79], DOWN), ([0.7, 0.1, 0.79], DOWN)]);
        let message = start(&Parameters::START, &path).unwrap_err().to_string();
        assert!(
            message.contains("`transfer.clearance` = `0.02 m`") && message.contains("`axis2` is `1.01"),
            "{message}"
        );
    }

    #[test]
    fn outside_the_travel_is_rejected_with_the_position() {
        let message = message(&[([0.7, 0.0, -0.2], DOWN), ([2.2, 0.0, -0.2], DOWN)]);
        assert!(
            message.contains("block 1, 1.3")
                && message.contains("`axis3` is `2.00")
                && message.contains("`0.1` to `2 m`"),
            "{message}"
        );
        let message = self::message(&[([0.3, 0.0, -0.2], DOWN), ([-0.3, 0.0, -0.2], DOWN)]);
        assert!(message.contains("hint:"), "{message}");
    }

    #[test]
    fn an_axis_may_be_at_the_ends_of_its_travel_and_as_fast_as_it_is() {
        let p = Parameters::START;
        for i in 0..AXES {
            for (end, out) in [(p.axis[i].minimum, -1e-9), (p.axis[i].maximum, 1e-9)] {
                let mut joints = p.axis.map(|axis| 0.5 * (axis.minimum + axis.maximum));
                joints[i] = end;
                assert_eq!(travel(&p, &joints), Ok(()));
                joints[i] += out;
                assert!(travel(&p, &joints).unwrap_err().text(&p).contains(NAMES[i].0));
            }
            let moved = |fraction: f64| {
                let mut joints = [0.0; AXES];
                joints[i] = fraction * p.axis[i].velocity_max;
                speed(&p, &joints, &[0.0; AXES], 1.0)
            };
            assert_eq!((moved(1.0), moved(-1.0)), (Ok(()), Ok(())));
            assert!(moved(1.001).unwrap_err().text(&p).contains(NAMES[i].0) && moved(-1.001).is_err());
        }
    }

    #[test]
    fn the_yaw_of_an_upright_start_is_that_of_the_first_position_that_is_tilted() {
        let poses = [
            ([0.7, 0.0, -0.2], DOWN),
            ([0.7, 0.05, -0.2], DOWN),
            ([0.7, 0.1, -0.2], [0.0, 0.05, -1.0]),
            ([0.7, 0.2, -0.2], [0.05, 0.05, -1.0]),
        ];
        let joints = start(&Parameters::START, &path(&poses)).unwrap();
        // across the arm, which has turned by 50 mm on 700 mm
        let expected = std::f64::consts::FRAC_PI_2 - (0.05_f64 / 0.7).atan();
        assert!((joints[3] - expected).abs() < 0.01, "{joints:?}");
    }
}
