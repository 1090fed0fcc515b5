//! Servo of one axis on a motion board: position and velocity setpoints arrive at intervals, the loop runs fast.

use crate::element::{Element, Ports};

/// `force = limit(stiffness (e + integral of e / integral_time) + damping (v_ref - v))`, with `e = x_ref - x` and `x_ref`
/// going on at the velocity setpoint. An integral time of 0 disables the integral; at the limit it waits.
///
/// A setpoint is new when it differs from the last one. From then on the reference moves at the velocity setpoint,
/// for at most `period`; without a new one it then stops.
#[derive(Clone, Debug)]
pub struct MotionBoard {
    /// force per position error, N/m
    stiffness: f64,
    /// force per velocity error, N.s/m
    damping: f64,
    /// largest force, N
    force_limit: f64,
    /// longest extrapolation, s
    period: f64,
    /// s, 0 for none
    integral_time: f64,
    /// integral of the position error over `integral_time`, m
    integral: f64,
    /// last setpoint, m and m/s
    setpoint: (f64, f64),
    /// time since it arrived, s
    age: f64,
}

impl MotionBoard {
    /// A servo of `stiffness` N/m, `damping` N.s/m and `force_limit` N that gets a setpoint every `period` s, with an
    /// integral of `integral_time` s unless that is 0.
    pub fn new(stiffness: f64, damping: f64, force_limit: f64, period: f64, integral_time: f64) -> Self {
        let (setpoint, age, integral) = ((0.0, 0.0), 0.0, 0.0);
        Self { stiffness, damping, force_limit, period, integral_time, integral, setpoint, age }
    }

    /// desired position and velocity of the axis
    fn reference(&self) -> (f64, f64) {
        let (position, velocity) = self.setpoint;
        if self.age < self.period {
            (position + velocity * self.age, velocity)
        } else {
            (position + velocity * self.period, 0.0)
        }
    }
}

impl Element for MotionBoard {
    fn ports(&self) -> Ports {
        let inputs = &["position_setpoint", "velocity_setpoint", "position", "velocity"];
        Ports { inputs, outputs: &["force"] }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], h: f64) {
        let setpoint = (inputs[0], inputs[1]);
        if setpoint != self.setpoint {
            (self.setpoint, self.age) = (setpoint, 0.0);
        }
        let (position, velocity) = self.reference();
        let error = position - inputs[2];
        let force = self.stiffness * (error + self.integral) + self.damping * (velocity - inputs[3]);
        outputs[0] = force.clamp(-self.force_limit, self.force_limit);
        if self.integral_time > 0.0 && force.abs() < self.force_limit {
            self.integral += error * h / self.integral_time;
        }
        self.age += h;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const H: f64 = 1e-4;

    /// force of a board with unit stiffness for an axis at rest at zero
    fn force(board: &mut MotionBoard, position: f64, velocity: f64) -> f64 {
        let mut out = [0.0];
        board.step(&[position, velocity, 0.0, 0.0], &mut out, H);
        out[0]
    }

    #[test]
    fn force_is_proportional_to_the_errors_up_to_its_limit() {
        let mut board = MotionBoard::new(1e5, 1e3, 400.0, 1e-3, 0.0);
        let mut out = [0.0];
        for (inputs, wanted) in [
            ([1e-3, 0.0, 0.0, 0.0], 100.0),
            ([0.0, 0.0, 1e-3, 0.0], -100.0),
            ([0.0, 0.0, 0.0, 0.05], -50.0),
            ([1e-3, 0.1, 1e-3, 0.02], 80.0),
            ([1.0, 0.0, 0.0, 0.0], 400.0),
            ([-1.0, 0.0, 0.0, 0.0], -400.0),
        ] {
            board.step(&inputs, &mut out, H);
            assert!((out[0] - wanted).abs() < 1e-9, "{inputs:?}: {} N", out[0]);
        }
    }

    #[test]
    fn a_straight_line_in_setpoints_of_1_ms_is_followed_at_every_step() {
        let mut board = MotionBoard::new(1.0, 0.0, 1e9, 1e-3, 0.0);
        for k in 0..100 {
            // setpoints of 0.1 m/s at 0, 1, 2, ... ms
            let (tick, now) = (f64::from(k / 10) * 1e-3, f64::from(k) * H);
            let reference = force(&mut board, 0.1 * tick, 0.1);
            assert!((reference - 0.1 * now).abs() < 1e-15, "step {k}: {reference} m");
        }
    }

    #[test]
    fn without_new_setpoints_the_reference_stops_after_one_period() {
        let mut board = MotionBoard::new(1.0, 0.0, 1e9, 1e-3, 0.0);
        let last = (0..50).map(|_| force(&mut board, 0.0, 0.1)).last();
        assert!((last.expect("steps") - 1e-4).abs() < 1e-15);
        let mut damped = MotionBoard::new(0.0, 1.0, 1e9, 1e-3, 0.0);
        let forces: Vec<f64> = (0..30).map(|_| force(&mut damped, 0.0, 0.1)).collect();
        assert_eq!((forces[5], forces[29]), (0.1, 0.0));
    }

    #[test]
    fn the_integral_doubles_the_force_in_its_time_and_waits_at_the_limit() {
        let mut board = MotionBoard::new(1e5, 0.0, 400.0, 1e-3, 0.1);
        let forces: Vec<f64> = (0..20_000).map(|_| force(&mut board, 1e-3, 0.0)).collect();
        assert!((forces[1000] - 200.0).abs() < 1e-9, "{} N after the integral time", forces[1000]);
        assert!((forces[19_999] - 400.0).abs() < 1e-9);
        // from 400 N at once down with the error, not after what was wound up
        assert!((force(&mut board, 0.0, 0.0) - 300.0).abs() < 0.2);
    }
}
