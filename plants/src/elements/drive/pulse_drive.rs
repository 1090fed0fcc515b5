//! Positioner that moves by pulses: a ball screw with a position loop, a velocity loop and feedforward.

use crate::element::{Element, Ports};

/// Parameters of the amplifier of one axis.
#[derive(Clone, Copy, Debug)]
pub struct DriveGains {
    /// position loop, 1/s
    pub position: f64,
    /// velocity loop, rad/s for a mass of `inertia`
    pub velocity: f64,
    /// integral of the velocity loop, 1/s
    pub integral: f64,
    /// fraction of the commanded velocity that bypasses the position loop
    pub feedforward: f64,
    /// bandwidth of that path, rad/s
    pub smoothing: f64,
    /// mass assumed by the velocity loop, kg
    pub inertia: f64,
    /// largest force, N
    pub force: f64,
}

/// `pulses` of `pulse` m arrive in every `tick` and are spread evenly over it; the axis starts at rest at zero.
///
/// `v_ref = position (x_ref - x) + feedforward lag(v_command)`, then
/// `force = inertia velocity (e + integral of integral e)` with `e = v_ref - v`, which stops integrating at its limit.
/// While `enable` is 0 there is no force and pulses are lost; the amplifier clears its deviation counter, so that the axis
/// keeps its position when `enable` returns.
#[derive(Clone, Debug)]
pub struct PulseDrive {
    gains: DriveGains,
    /// length of a pulse, m
    pulse: f64,
    /// time in which the pulses of a command arrive, s
    tick: f64,
    /// commanded position, m
    reference: f64,
    /// lagged velocity command, m/s
    smoothed: f64,
    /// integral of the velocity error, m
    sum: f64,
}

impl PulseDrive {
    /// A drive with pulses of `pulse` m that arrive in `tick` s.
    pub fn new(gains: DriveGains, pulse: f64, tick: f64) -> Self {
        Self { gains, pulse, tick, reference: 0.0, smoothed: 0.0, sum: 0.0 }
    }
}

impl Element for PulseDrive {
    fn ports(&self) -> Ports {
        Ports { inputs: &["pulses", "position", "velocity", "enable"], outputs: &["force", "reference"] }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], h: f64) {
        let &[pulses, position, velocity, enable] = inputs else { return };
        let g = self.gains;
        if enable == 0.0 {
            (self.reference, self.smoothed, self.sum) = (position, 0.0, 0.0);
            outputs.copy_from_slice(&[0.0, position]);
            return;
        }
        outputs[1] = self.reference;
        let command = pulses * self.pulse / self.tick;
        let error = g.position * (self.reference - position) + g.feedforward * self.smoothed - velocity;
        let gain = g.inertia * g.velocity;
        let wanted = gain * (error + g.integral * self.sum);
        outputs[0] = wanted.clamp(-g.force, g.force);
        // no integration into the limit
        if wanted.abs() < g.force || wanted * error < 0.0 {
            self.sum += error * h;
        }
        self.smoothed += (command - self.smoothed) * -(-g.smoothing * h).exp_m1();
        self.reference += command * h;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const H: f64 = 1e-4;
    const GAINS: DriveGains = DriveGains {
        position: 80.0,
        velocity: 500.0,
        integral: 60.0,
        feedforward: 0.8,
        smoothing: 628.0,
        inertia: 10.0,
        force: 400.0,
    };

    fn drive(gains: DriveGains) -> PulseDrive {
        PulseDrive::new(gains, 1e-6, 1e-3)
    }

    /// a free mass with viscous friction under the drive; position after some ticks
    fn travel(drive: &mut PulseDrive, pulses: impl Fn(u32) -> f64, ticks: u32, load: f64) -> (f64, f64) {
        let (mut x, mut v, mut out) = (0.0, 0.0, [0.0; 2]);
        for k in 0..10 * ticks {
            drive.step(&[pulses(k / 10), x, v, 1.0], &mut out, H);
            v += (out[0] - 20.0 * v - load) / 10.0 * H;
            x += v * H;
        }
        (x, v)
    }

    #[test]
    fn pulses_are_spread_over_the_tick() {
        let mut drive = drive(GAINS);
        let mut out = [0.0; 2];
        for k in 0..10 {
            drive.step(&[7.0, 0.0, 0.0, 1.0], &mut out, H);
            assert!((out[1] - 7e-7 * f64::from(k)).abs() < 1e-20);
        }
        drive.step(&[0.0, 0.0, 0.0, 1.0], &mut out, H);
        assert!((out[1] - 7e-6).abs() < 1e-18);
    }

    #[test]
    fn the_axis_arrives_where_the_pulses_say_whatever_the_load() {
        for load in [0.0, 30.0] {
            let (x, v) = travel(&mut drive(GAINS), |tick| if tick < 100 { 5.0 } else { 0.0 }, 1000, load);
            assert!((x - 500e-6).abs() < 1e-9 && v.abs() < 1e-8, "{load} N: {x} m");
        }
    }

    #[test]
    fn at_constant_speed_it_lags_by_what_is_not_fed_forward() {
        let (x, v) = travel(&mut drive(GAINS), |_| 10.0, 1000, 0.0);
        assert!((v - 0.01).abs() < 1e-8);
        // (1 - 0.8) v / 80
        assert!((0.01 - x - 0.2 * 0.01 / 80.0).abs() < 1e-8, "{x}");
    }

    #[test]
    fn the_force_has_a_limit_behind_which_nothing_winds_up() {
        let mut stiff = drive(DriveGains { force: 5.0, ..GAINS });
        let mut out = [0.0; 2];
        for _ in 0..10_000 {
            stiff.step(&[50.0, 0.0, 0.0, 1.0], &mut out, H);
            assert!(out[0].abs() <= 5.0);
        }
        assert!(stiff.sum < 1e-4, "{}", stiff.sum);
    }

    #[test]
    fn without_enable_there_is_no_force_and_the_axis_stays_where_it_was_moved_to() {
        let mut drive = drive(GAINS);
        let mut out = [0.0; 2];
        (0..100).for_each(|_| drive.step(&[50.0, 0.0, 0.0, 1.0], &mut out, H));
        drive.step(&[50.0, 3e-3, 0.1, 0.0], &mut out, H);
        assert_eq!(out, [0.0, 3e-3]);
        drive.step(&[0.0, 3e-3, 0.0, 1.0], &mut out, H);
        assert_eq!(out, [0.0, 3e-3]);
    }
}
