//! Motion of all axes from one position to another at rest, that can be held during the motion.

use control_blocks::{minimum_jerk, quintic_duration};
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;
use crate::path::kinematics::{AXES, Joints};

/// Ratio of these motions' velocity to the largest velocity of the axis: moderate, because the operator watches them.
pub const VELOCITY_RATIO: f64 = 0.3;
/// Time in which a held motion comes to rest, s.
const HOLD_TIME: f64 = 0.3;

/// The motion in progress.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct TransferMotion {
    from: Joints,
    to: Joints,
    duration: f64,
    /// time on the quintic, s
    time: f64,
    /// how fast that time runs, 0 when held
    rate: f64,
}

impl TransferMotion {
    /// At rest at a position.
    pub fn at(position: &Joints) -> Self {
        Self { from: *position, to: *position, duration: 0.0, time: 0.0, rate: 1.0 }
    }

    /// From rest at one position to rest at another.
    pub fn new(p: &Parameters, from: &Joints, to: &Joints) -> Self {
        let needed = |i: usize| {
            let velocity = p.axis[i].velocity_max * VELOCITY_RATIO;
            quintic_duration((to[i] - from[i]).abs(), velocity)
        };
        let duration = (0..AXES).map(needed).fold(p.transfer.time, f64::max);
        Self { from: *from, to: *to, duration, time: 0.0, rate: 1.0 }
    }

    /// Position after one sample more; a held motion slows down and continues later.
    pub fn step(&mut self, dt: f64, hold: bool) -> Joints {
        let change = dt / HOLD_TIME;
        self.rate = (self.rate + if hold { -change } else { change }).clamp(0.0, 1.0);
        self.time += self.rate * dt;
        self.position()
    }

    /// Time of the motion, s.
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Whether the motion has come to its end.
    pub fn over(&self) -> bool {
        self.time >= self.duration
    }

    /// Whether the motion is held and at rest.
    pub fn stopped(&self) -> bool {
        self.rate == 0.0
    }

    fn position(&self) -> Joints {
        if self.over() {
            return self.to;
        }
        let fraction = minimum_jerk(self.time / self.duration);
        std::array::from_fn(|i| self.from[i] + (self.to[i] - self.from[i]) * fraction)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f64 = 0.01;
    const FROM: Joints = [0.0, 0.0, 0.5, 0.0, 0.0, 0.0];
    const TO: Joints = [1.5, -0.2, 1.0, 0.1, 0.0, 0.0];

    #[test]
    fn keeps_the_speed_of_every_axis_and_arrives() {
        let p = Parameters::START;
        let mut transfer = TransferMotion::new(&p, &FROM, &TO);
        let mut before = FROM;
        for _ in 0..10_000 {
            let now = transfer.step(DT, false);
            for (i, axis) in p.axis.iter().enumerate() {
                assert!((now[i] - before[i]).abs() <= axis.velocity_max * 0.3 * DT * 1.001);
            }
            before = now;
        }
        assert!(transfer.over() && before == TO);
    }

    #[test]
    fn a_held_motion_rests_and_goes_on_without_a_jump() {
        let p = Parameters::START;
        let mut transfer = TransferMotion::new(&p, &FROM, &TO);
        let (mut before, mut last_change) = (FROM[0], 0.0);
        for k in 0..1000 {
            let now = transfer.step(DT, (60..200).contains(&k))[0];
            let change = now - before;
            assert!((change - last_change).abs() < 1e-3, "{k}");
            assert!(!(100..200).contains(&k) || (transfer.stopped() && change == 0.0));
            (before, last_change) = (now, change);
        }
        assert!(transfer.over());
    }

    #[test]
    fn a_motion_to_the_same_position_takes_its_time_too() {
        let p = Parameters::START;
        let mut transfer = TransferMotion::new(&p, &FROM, &FROM);
        assert!(!transfer.over());
        (0..151).for_each(|_| assert_eq!(transfer.step(DT, false), FROM));
        assert!(transfer.over());
    }

    #[test]
    fn a_motion_comes_to_rest_and_up_again_in_three_tenths_of_a_second() {
        let p = Parameters::START;
        let mut transfer = TransferMotion::new(&p, &FROM, &TO);
        for _ in 0..60 {
            transfer.step(DT, false);
        }
        let rest = (1..100).find(|_| {
            transfer.step(DT, true);
            transfer.stopped()
        });
        // the rate does not come to zero by its last bit
        assert!(matches!(rest, Some(30 | 31)), "{rest:?}");
        let time = transfer.time;
        for _ in 0..30 {
            transfer.step(DT, false);
        }
        // 1/30, 2/30, ..., 1
        assert!((transfer.time - time - DT * 15.5).abs() < 1e-9);
        for _ in 0..30 {
            transfer.step(DT, false);
        }
        assert!((transfer.time - time - DT * 45.5).abs() < 1e-9);
    }
}
