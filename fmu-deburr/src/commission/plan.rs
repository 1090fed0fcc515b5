//! Distance, speed and duration of the commissioning run, from its bounds.
//!
//! One axis after the other moves back and forth while the others hold their positions, each time from rest to rest by
//! a minimum-jerk motion (quintic) of the distance D in the time T. Its speed peaks at 15/8 D/T, its acceleration at
//! 5.77 D/T^2. Strokes with the speed and the acceleration of the path show the behavior of the drives on the path.
//! Both peak where D = 1.64 v^2/a, which is the default travel. The reference does not exceed D, because a motion from
//! rest to rest is monotone. The servo without patterns exceeds its reference by a thousandth of the distance.
//!
//! Only the position loop holds the axes: L = g Kp G(s)/s e^(-s tau) with the hold, T/2, and the delay in tau. G is
//! flat at the crossover g Kp, so the phase margin is pi/2 - g Kp (d T + T/2 + 2 zeta/wn). For the paper's loop, a
//! drive of 1.3 times its gain, two samples of delay and a lag of 6.9 ms (wn 0.7, zeta 1.3 times nominal) this is 59
//! degrees; a weaker, faster or earlier drive has more.
//!
//! Each stroke moves to the side on which the tip leaves the part, against the tool, otherwise to the side with more
//! travel. In all strokes the tip is therefore never nearer to what is in front of the tool than at the start, and
//! sideways by at most D.

use control_blocks::{QUINTIC_ACCELERATION, commission_time, configured_or, quintic_duration, ticks};
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;
use crate::path::kinematics::{AXES, Joints};
use crate::path::transfer::VELOCITY_RATIO;

/// Strokes of each axis, back and forth.
pub const STROKES: u32 = 4;
/// Rest after each of them in time constants 1/Kp.
const REST: f64 = 6.0;
/// Largest default travel, m.
const TRAVEL_MAX: f64 = 0.05;
/// No turning axis moves the tip by less than that of a lever of this length, m: it would turn too far.
const LEVER_MIN: f64 = 0.1;
/// A stroke takes at least this number of samples.
const SAMPLES_MIN: f64 = 10.0;
/// Ways of the tip that differ by less are the same, m.
const SAME: f64 = 1e-6;

/// The strokes of all axes.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Plan {
    /// Distance from the rest position of each axis, rad or m.
    pub travel: Joints,
    /// Time of a stroke, s.
    pub time: Joints,
    /// Samples of a stroke and the rest after it.
    pub samples: [u32; AXES],
    /// Deceleration of a stroke that is aborted, rad/s2 or m/s2.
    pub brake: Joints,
}

impl Plan {
    /// From the position `joints` (rad or m); `speed` is that of the path, m/s.
    pub fn new(p: &Parameters, speed: f64, joints: &Joints) -> Self {
        let levers = levers(p, joints);
        let travel = std::array::from_fn(|i| side(p, joints, i, travel(p, speed) / levers[i]));
        let time = std::array::from_fn(|i| duration(p, speed, i, travel[i], levers[i]));
        Self {
            travel,
            time,
            samples: std::array::from_fn(|i| samples(p, i, time[i])),
            brake: levers.map(|lever| acceleration(p) / lever),
        }
    }
}

/// How far the tip moves for a unit motion of each axis, at least: m/rad or 1.
fn levers(p: &Parameters, joints: &Joints) -> Joints {
    let levers = p.arm.levers(joints);
    std::array::from_fn(|i| if linear(i) { 1.0 } else { levers[i].abs().max(LEVER_MIN) })
}

fn linear(axis: usize) -> bool {
    matches!(axis, 1 | 2)
}

/// The travel of the axis `axis`, at most `maximum` (rad or m) and within its travel, to the side that is free.
fn side(p: &Parameters, joints: &Joints, axis: usize, maximum: f64) -> f64 {
    let (here, at) = (p.arm.forward(joints), joints[axis]);
    let away = |travel: f64| {
        let mut there = *joints;
        there[axis] += travel;
        -(p.arm.forward(&there).tip - here.tip).dot(&here.axis)
    };
    let (up, down) = (away(maximum), away(-maximum));
    let [below, above] = [at - p.axis[axis].minimum, p.axis[axis].maximum - at].map(|room| room.max(0.0));
    let forward = if (up - down).abs() > SAME { up > down } else { above >= below };
    if forward { maximum.min(above) } else { -maximum.min(below) }
}

/// Time of a stroke of the axis `axis` over `travel` (rad or m), s.
fn duration(p: &Parameters, speed: f64, axis: usize, travel: f64, lever: f64) -> f64 {
    let maximum = (speed / lever).min(VELOCITY_RATIO * p.axis[axis].velocity_max);
    let hard = (QUINTIC_ACCELERATION * travel.abs() * lever / acceleration(p)).sqrt();
    quintic_duration(travel.abs(), maximum).max(hard).max(SAMPLES_MIN * p.sample_period)
}

/// Samples of a stroke of the axis `axis` that takes `time` (s), and of the rest after it.
fn samples(p: &Parameters, axis: usize, time: f64) -> u32 {
    ticks(time, p.sample_period) + ticks(REST / p.servo_gain[axis], p.sample_period)
}

/// Longest time of a stroke of the axis `axis`, wherever it begins, s.
fn longest(p: &Parameters, speed: f64, axis: usize) -> f64 {
    let lever = if linear(axis) { 1.0 } else { LEVER_MIN };
    let travel = travel(p, speed);
    duration(p, speed, axis, travel / lever, lever)
}

/// Samples of all strokes of one axis, at most.
pub fn room(p: &Parameters, speed: f64) -> usize {
    let of = |i: usize| STROKES * samples(p, i, longest(p, speed, i));
    (0..AXES).map(of).max().unwrap_or(0) as usize
}

/// Farthest way (m) of the tip with each axis.
pub fn travel(p: &Parameters, speed: f64) -> f64 {
    // where quintic_duration and the acceleration ask for the same time
    let both = QUINTIC_ACCELERATION / quintic_duration(1.0, 1.0).powi(2) * speed * speed / acceleration(p);
    configured_or(p.commission.travel, || both.min(TRAVEL_MAX))
}

/// Largest acceleration (m/s2) of the tip with each axis.
fn acceleration(p: &Parameters) -> f64 {
    configured_or(p.commission.acceleration, || p.feed.acceleration)
}

/// Time of all motions (s), including the retract from the part.
pub fn shortest_time(p: &Parameters, speed: f64) -> f64 {
    let strokes: u32 = (0..AXES).map(|i| STROKES * samples(p, i, longest(p, speed, i))).sum();
    let slowest = p.axis.iter().fold(f64::INFINITY, |minimum, axis| minimum.min(axis.velocity_max));
    let out = quintic_duration(p.transfer.clearance, VELOCITY_RATIO * slowest).max(p.transfer.time);
    f64::from(strokes) * p.sample_period + out
}

/// Longest time (s): `expert.commission.time`, or what the motions take and some more.
pub fn time(p: &Parameters, speed: f64) -> f64 {
    commission_time(p.commission.time, || shortest_time(p, speed))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Above the start of the test piece.
    const ABOVE: Joints = [-0.1, 0.02, 0.7, 0.0, 0.0, 0.0];

    fn near(value: f64, expected: f64) {
        assert!((value / expected - 1.0).abs() < 1e-3, "{value} {expected}");
    }

    #[test]
    fn the_travel_is_given_or_that_of_the_speed_and_acceleration_of_the_path() {
        let mut p = Parameters::START;
        near(travel(&p, 0.1), 1.642 * 0.01 / 0.5);
        near(travel(&p, 0.05), 1.642 * 0.0025 / 0.5);
        p.commission.acceleration = 1.0;
        near(travel(&p, 0.1), 1.642 * 0.01);
        assert_eq!(travel(&p, 1.0), 0.05);
        p.commission.travel = 0.3;
        assert_eq!(travel(&p, 1.0), 0.3);
    }

    #[test]
    fn strokes_peak_at_the_speed_or_at_the_acceleration() {
        let mut p = Parameters::START;
        let plan = Plan::new(&p, 0.1, &ABOVE);
        // both immediately
        near(1.875 * plan.travel[1] / plan.time[1], 0.1);
        near(5.7735 * plan.travel[2] / plan.time[2].powi(2), 0.5);
        // the reach is the lever of the column, and no lever is shorter than 0.1 m
        near(plan.travel[0].abs() * 0.7, plan.travel[1]);
        near(plan.travel[4].abs() * 0.2, plan.travel[1]);
        near(plan.travel[5].abs() * 0.1, plan.travel[1]);
        p.commission.travel = 0.2;
        let plan = Plan::new(&p, 0.1, &ABOVE);
        near(1.875 * plan.travel[1] / plan.time[1], 0.1);
        assert!(5.7735 * plan.travel[1] / plan.time[1].powi(2) < 0.5);
        p.commission.travel = 0.01;
        let plan = Plan::new(&p, 0.1, &ABOVE);
        near(5.7735 * plan.travel[1] / plan.time[1].powi(2), 0.5);
        assert!(1.875 * plan.travel[1] / plan.time[1] < 0.1);
        // an axis that may not turn so fast takes longer
        (p.axis[5].velocity_max, p.commission.travel) = (0.5, 0.03);
        let plan = Plan::new(&p, 0.1, &ABOVE);
        near(1.875 * plan.travel[5].abs() / plan.time[5], 0.3 * 0.5);
    }

    #[test]
    fn each_axis_goes_away_from_the_part_or_to_where_there_is_room() {
        let mut p = Parameters::START;
        let travels = |p: &Parameters, joints: &Joints| Plan::new(p, 0.1, joints).travel.map(f64::signum);
        // up, and to the middle of the travel
        assert_eq!(travels(&p, &ABOVE), [1.0; AXES]);
        let mut there = [0.2, 0.9, 1.9, 0.2, 0.0, 0.2];
        assert_eq!(travels(&p, &there), [-1.0, 1.0, -1.0, -1.0, 1.0, -1.0]);
        // a tool that is tilted inwards comes away outwards, and the other way round
        (there[3], there[4]) = (0.0, 0.3);
        assert_eq!(travels(&p, &there)[2], 1.0);
        there[4] = -0.3;
        assert_eq!(travels(&p, &there)[2], -1.0);
        // an upside down one from below
        there[4] = 3.1;
        assert_eq!(travels(&p, &there)[1], -1.0);
        // no farther than the travel allows
        p.axis[1].maximum = 0.91;
        near(Plan::new(&p, 0.1, &[0.2, 0.9, 1.9, 0.0, 0.0, 0.0]).travel[1], 0.01);
        p.axis[1].maximum = 0.8;
        assert_eq!(Plan::new(&p, 0.1, &[0.2, 0.9, 1.9, 0.0, 0.0, 0.0]).travel[1], 0.0);
    }

    #[test]
    fn there_is_room_for_every_stroke_wherever_it_begins() {
        let mut p = Parameters::START;
        p.axis[4].velocity_max = 0.4;
        for joints in [ABOVE, [0.0, 0.0, 0.05, 0.0, 0.0, 0.0], [1.0, 0.5, 1.9, 0.5, 0.5, 0.5]] {
            let plan = Plan::new(&p, 0.1, &joints);
            assert!(plan.samples.iter().all(|samples| (STROKES * samples) as usize <= room(&p, 0.1)), "{plan:?}");
            let all = plan.samples.iter().map(|samples| 0.01 * f64::from(STROKES * samples)).sum::<f64>();
            assert!(all + p.transfer.time <= shortest_time(&p, 0.1) + 1e-9);
        }
        near(time(&p, 0.1), 1.25 * shortest_time(&p, 0.1) + 1.0);
        p.commission.time = 77.0;
        assert_eq!(time(&p, 0.1), 77.0);
        p.commission.time = 0.0;
        // a long way out at the speed of the slowest axis
        let short = shortest_time(&p, 0.1);
        (p.transfer.clearance, p.axis[1].velocity_max) = (0.9, 0.4);
        near(shortest_time(&p, 0.1) - short, 1.875 * 0.9 / (0.3 * 0.4) - p.transfer.time);
    }
}
