//! Spindle with an induction motor: torque by slip, and the speed measured by its pulse generator.

use crate::element::{Element, Ports};

/// Induction motor by Kloss' equation, `T = 2 Tb / (s / sb + sb / s)` with the slip `s`.
#[derive(Clone, Copy, Debug)]
pub struct InductionSpindle {
    /// speed without slip, rad/s
    synchronous: f64,
    /// maximum torque, N.m
    breakdown: f64,
    /// slip at the maximum torque
    breakdown_slip: f64,
    /// kg.m2
    inertia: f64,
    /// friction torque, N.m
    friction: f64,
    /// lag of the measured speed, s
    lag: f64,
    speed: f64,
    measured: f64,
}

/// Data of the rating plate of a motor, and its time constant.
#[derive(Clone, Copy, Debug)]
pub struct RatingPlate {
    /// speed without slip, rad/s
    pub synchronous: f64,
    /// speed at the rated torque, rad/s
    pub rated_speed: f64,
    /// W
    pub rated_power: f64,
    /// maximum torque over the rated one, more than 1
    pub overload: f64,
    /// time constant of the speed about the rated point, s
    pub time: f64,
}

impl InductionSpindle {
    /// A spindle that turns without load; `friction` in N.m, `lag` of the measured speed in s.
    pub fn new(plate: RatingPlate, friction: f64, lag: f64) -> Self {
        let rated_torque = plate.rated_power / plate.rated_speed;
        let rated_slip = 1.0 - plate.rated_speed / plate.synchronous;
        // s / sb + sb / s = 2 Tb / T at the rated point
        let breakdown_slip = rated_slip * (plate.overload + (plate.overload * plate.overload - 1.0).sqrt());
        let mut spindle = Self {
            synchronous: plate.synchronous,
            breakdown: plate.overload * rated_torque,
            breakdown_slip,
            inertia: 0.0,
            friction,
            lag,
            speed: 0.0,
            measured: 0.0,
        };
        spindle.inertia = plate.time * spindle.slope(rated_slip);
        // friction alone: the smaller slip of the two with that torque
        let ratio = spindle.friction / spindle.breakdown;
        let slip = spindle.breakdown_slip * (1.0 - (1.0 - ratio * ratio).sqrt()) / ratio.max(f64::MIN_POSITIVE);
        spindle.speed = spindle.synchronous * (1.0 - slip);
        spindle.measured = spindle.speed;
        spindle
    }

    /// torque of the motor at a speed, N.m
    fn torque(&self, speed: f64) -> f64 {
        let (slip, most) = (1.0 - speed / self.synchronous, self.breakdown_slip);
        2.0 * self.breakdown * slip * most / (slip * slip + most * most)
    }

    /// torque per loss of speed, N.m.s/rad
    fn slope(&self, slip: f64) -> f64 {
        let (s, most) = (slip * slip, self.breakdown_slip * self.breakdown_slip);
        2.0 * self.breakdown / self.synchronous * self.breakdown_slip * (most - s) / ((s + most) * (s + most))
    }

    fn acceleration(&self, speed: f64, load: f64) -> f64 {
        (self.torque(speed) - self.friction - load) / self.inertia
    }
}

impl Element for InductionSpindle {
    fn ports(&self) -> Ports {
        Ports { inputs: &["load"], outputs: &["speed", "measured", "torque"] }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], h: f64) {
        let load = inputs[0];
        outputs.copy_from_slice(&[self.speed, self.measured, self.torque(self.speed)]);
        // a load brakes and does not turn the spindle back
        let middle = (self.speed + 0.5 * h * self.acceleration(self.speed, load)).max(0.0);
        self.measured += (middle - self.measured) * (1.0 - (-h / self.lag).exp());
        self.speed = (self.speed + h * self.acceleration(middle, load)).max(0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RPM: f64 = std::f64::consts::TAU / 60.0;

    fn spindle() -> InductionSpindle {
        let plate = RatingPlate {
            synchronous: 18_000.0 * RPM,
            rated_speed: 17_500.0 * RPM,
            rated_power: 600.0,
            overload: 2.5,
            time: 0.15,
        };
        InductionSpindle::new(plate, 0.008, 0.02)
    }

    /// Speed after every step of 1 ms under a load.
    fn run(spindle: &mut InductionSpindle, load: f64, steps: usize) -> Vec<[f64; 3]> {
        let row = |_| {
            let mut out = [0.0; 3];
            spindle.step(&[load], &mut out, 1e-3);
            out
        };
        (0..steps).map(row).collect()
    }

    #[test]
    fn the_plate_holds() {
        let mut spindle = spindle();
        let rated = 600.0 / (17_500.0 * RPM);
        let rows = run(&mut spindle, rated - 0.008, 5000);
        assert!((rows[4999][0] / RPM - 17_500.0).abs() < 1e-6, "{} rpm", rows[4999][0] / RPM);
        assert!((rows[4999][2] - rated).abs() < 1e-9);
        assert!((spindle.breakdown_slip - 0.133).abs() < 1e-3);
    }

    #[test]
    fn without_load_it_keeps_its_speed_from_the_start() {
        let rows = run(&mut spindle(), 0.0, 1000);
        assert!((rows[999][0] - rows[0][0]).abs() < 1e-9);
        assert!(rows[0][0] < 18_000.0 * RPM && rows[0][0] > 17_980.0 * RPM);
    }

    #[test]
    fn about_the_rated_point_it_answers_with_its_time_constant() {
        let mut spindle = spindle();
        let rated = 600.0 / (17_500.0 * RPM) - 0.008;
        run(&mut spindle, rated, 5000);
        let rows = run(&mut spindle, rated * 1.01, 4000);
        let share = (rows[0][0] - rows[150][0]) / (rows[0][0] - rows[3999][0]);
        assert!((share - (1.0 - (-1.0_f64).exp())).abs() < 5e-3, "{share}");
    }

    #[test]
    fn beyond_the_breakdown_torque_it_stalls_and_stands() {
        let mut spindle = spindle();
        let rows = run(&mut spindle, 0.9, 9000);
        assert_eq!(rows[8999][0], 0.0);
        assert!(rows[8999][1] < 1e-6);
        // and starts again when the load is gone
        assert!(run(&mut spindle, 0.0, 20_000)[19_999][0] > 17_980.0 * RPM);
    }

    #[test]
    fn the_measured_speed_lags() {
        let mut spindle = spindle();
        let rows = run(&mut spindle, 0.3, 200);
        let slope = rows[150][0] - rows[149][0];
        assert!((rows[150][1] - rows[150][0] + 20.0 * slope).abs() < 0.25 * (20.0 * slope).abs());
    }

    #[test]
    fn a_spindle_without_friction_has_no_slip() {
        let plate = RatingPlate { synchronous: 100.0, rated_speed: 95.0, rated_power: 95.0, overload: 2.0, time: 0.1 };
        let mut spindle = InductionSpindle::new(plate, 0.0, 0.02);
        assert_eq!(run(&mut spindle, 0.0, 1)[0][0], 100.0);
    }
}
