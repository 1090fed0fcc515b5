//! The parameters that a commissioning run derives.

use control_blocks::{RATIO_MAX, SIGNIFICANT, is_certain, significant_or, whole_delay, within_factor};

use crate::commission::response::loop_spread;
use crate::interface::{Measured, Parameters};
use serde::{Deserialize, Serialize};

/// `guard.force` over the standard deviation of the force, as the defaults have it, and over the cogging of the longest
/// approach.
const GUARD: (f64, f64) = (20.0, 2.0);
/// `limits.residual_force` over `guard.force`, as the defaults have it.
const RESIDUAL_FORCE: f64 = 0.5;
/// `limits.slope_sigma_max` over the noise of the slope, as the default has it.
const SLOPE_SIGMA: f64 = 5.0;
/// `limits.jump` over the noise of the position, as the defaults have it: half of it, which counts, is eight sigma.
const JUMP: f64 = 17.0;
/// Maximum ratio of the derived to the configured guard.
const GUARD_GROWTH: f64 = 3.0;

/// All parameters that a commissioning run derives.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Values {
    pub force_constant: f64,
    io_delay: i32,
    guard_force: f64,
    residual_force: f64,
    slope_sigma_max: f64,
    jump: f64,
    disturbance_walk: f64,
    force_noise: f64,
    position_noise: f64,
}

impl Values {
    /// Those of the parameters.
    pub fn of(p: &Parameters) -> Self {
        Self {
            force_constant: p.stage.force_constant,
            io_delay: p.io_delay,
            guard_force: p.guard_force,
            residual_force: p.limits.residual_force,
            slope_sigma_max: p.limits.slope_sigma_max,
            jump: p.limits.jump,
            disturbance_walk: p.kalman.disturbance_walk,
            force_noise: p.kalman.force_noise,
            position_noise: p.kalman.position_noise,
        }
    }

    /// Puts them into the parameters.
    pub fn put(&self, p: &mut Parameters) {
        p.stage.force_constant = self.force_constant;
        p.io_delay = self.io_delay;
        p.guard_force = self.guard_force;
        p.limits.residual_force = self.residual_force;
        p.limits.slope_sigma_max = self.slope_sigma_max;
        p.limits.jump = self.jump;
        p.kalman.disturbance_walk = self.disturbance_walk;
        p.kalman.force_noise = self.force_noise;
        p.kalman.position_noise = self.position_noise;
    }

    /// Their names and values.
    pub fn entries(&self) -> [(&'static str, f64); 9] {
        [
            ("stage.force_constant", self.force_constant),
            ("io_delay", f64::from(self.io_delay)),
            ("guard.force", self.guard_force),
            ("limits.residual_force", self.residual_force),
            ("limits.slope_sigma_max", self.slope_sigma_max),
            ("limits.jump", self.jump),
            ("expert.kalman.disturbance_walk", self.disturbance_walk),
            ("expert.kalman.force_noise", self.force_noise),
            ("expert.kalman.position_noise", self.position_noise),
        ]
    }

    /// Those with the response that was measured.
    pub fn with_response(self, measured: &Measured) -> Self {
        Self { force_constant: measured.force_constant, io_delay: delay(measured), ..self }
    }

    /// Those with all that was measured.
    pub fn derived(self, p: &Parameters, measured: &Measured) -> Self {
        self.with_response(measured).with_noise(p, measured)
    }

    /// Those with the measured noise; insignificant values keep the configured ones. The limit of the noise only gets
    /// tighter.
    fn with_noise(self, p: &Parameters, m: &Measured) -> Self {
        // a short travel shows little of the cogging farther on: at least the configured value
        let guard_force = guard(p, m).max(self.guard_force);
        Self {
            guard_force,
            residual_force: self.residual_force.max(RESIDUAL_FORCE * guard_force),
            slope_sigma_max: self.slope_sigma_max.min(SLOPE_SIGMA * m.slope_sigma),
            jump: self.jump.max(JUMP * significant_or(m.position_noise, m.position_noise_std, 0.0)),
            disturbance_walk: significant_or(m.disturbance_walk, m.disturbance_walk_std, self.disturbance_walk),
            force_noise: significant_or(m.force_noise, m.force_noise_std, self.force_noise),
            position_noise: significant_or(m.position_noise, m.position_noise_std, self.position_noise),
            ..self
        }
    }

    /// Whether a touch can be detected in this noise, by the configured limits: a limit that rejects noise does not
    /// grow with it, in one run or in many.
    pub fn quiet(&self, p: &Parameters, m: &Measured) -> bool {
        m.slope_sigma <= self.slope_sigma_max && guard(p, m) <= GUARD_GROWTH * self.guard_force
    }
}

/// Force (N) of the guard that this noise, and the significant part of this cogging, never reach.
pub fn guard(p: &Parameters, m: &Measured) -> f64 {
    let stiffness = (m.stiffness.abs() - SIGNIFICANT * m.stiffness_std).max(0.0);
    f64::max(GUARD.0 * m.force_sigma, GUARD.1 * stiffness * p.approach.travel_max)
}

/// Whether the response is certain enough and can be controlled: `expected` is the assumed thrust constant, `longest`
/// the longest delay at which the loop is stable. The lag of the current loop is part of the sum either way, so its
/// contribution to the uncertainty of the delay does not cause a rejection.
pub fn acceptable(p: &Parameters, expected: f64, longest: i32, m: &Measured) -> bool {
    is_certain(m.force_constant, m.force_constant_std, p.commission.std_max)
        && m.io_delay_std <= p.commission.delay_std_max.hypot(loop_spread(p))
        && within_factor(m.force_constant, expected, RATIO_MAX)
        && (0..=longest).contains(&delay(m))
}

/// The delay in whole samples. No machine responds before its command: an insignificant negative delay is 0.
fn delay(m: &Measured) -> i32 {
    let none = m.io_delay < 0.0 && -m.io_delay <= SIGNIFICANT * m.io_delay_std;
    if none { 0 } else { whole_delay(m.io_delay) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A successful measurement of a machine a fifth stronger than configured.
    const GOOD: Measured = Measured {
        valid: true,
        force_constant: 24.0,
        force_constant_std: 0.01,
        io_delay: 1.7,
        io_delay_std: 0.03,
        stiffness: 50.0,
        stiffness_std: 30.0,
        position_noise: 9e-10,
        position_noise_std: 1e-11,
        force_noise: 2e-3,
        force_noise_std: 1e-3,
        disturbance_walk: 4e-4,
        disturbance_walk_std: 5e-5,
        force_sigma: 0.03,
        slope_sigma: 0.8,
        ..Measured::START
    };

    #[test]
    fn what_is_put_is_what_was_taken() {
        let mut p = Parameters::START;
        Values::of(&p).put(&mut p);
        assert_eq!(p, Parameters::START);
        let values = Values::of(&p).derived(&p, &GOOD);
        values.put(&mut p);
        assert_eq!(Values::of(&p), values);
        assert_eq!((p.stage.force_constant, p.io_delay, p.stage.mass), (24.0, 2, 10.0));
        // 20 and 5 sigma, half of the guard
        assert_eq!((p.guard_force, p.limits.residual_force, p.limits.slope_sigma_max), (0.6, 0.3, 4.0));
        // the white force is not significant
        assert_eq!((p.kalman.force_noise, p.kalman.disturbance_walk, p.kalman.position_noise), (5e-3, 4e-4, 9e-10));
        // 17 sigma of 0.9 nm
        assert!((p.limits.jump - 1.53e-8).abs() < 1e-20, "{}", p.limits.jump);
        let names = values.entries().map(|(name, _)| name);
        assert!(names.contains(&"guard.force") && names.contains(&"limits.residual_force"));
    }

    #[test]
    fn the_guard_covers_the_cogging_that_is_known_and_never_undercuts_what_was_configured() {
        let p = Parameters::START;
        let guard = |m: &Measured| {
            let mut found = p.clone();
            Values::of(&p).with_noise(&p, m).put(&mut found);
            (found.guard_force, found.limits.residual_force)
        };
        assert_eq!(guard(&Measured { force_sigma: 0.001, ..GOOD }), (0.4, 0.2));
        // 200 N/m less three deviations of 20 for 5 mm, and as much again
        let stiff = Measured { stiffness: -200.0, stiffness_std: 20.0, force_sigma: 0.001, ..GOOD };
        let (force, left) = guard(&stiff);
        assert!((force - 1.4).abs() < 1e-12 && (left - 0.7).abs() < 1e-12, "{force} {left}");
    }

    #[test]
    fn a_jump_is_beyond_the_noise_and_never_less_than_configured() {
        let p = Parameters::START;
        let mut found = p.clone();
        Values::of(&p).with_noise(&p, &Measured { position_noise: 5.8e-10, ..GOOD }).put(&mut found);
        assert_eq!(found.limits.jump, 1e-8);
    }

    #[test]
    fn a_limit_of_the_noise_never_grows_and_noise_beyond_it_is_rejected() {
        let p = Parameters::START;
        let mut found = p.clone();
        Values::of(&p).with_noise(&p, &Measured { slope_sigma: 2.0, ..GOOD }).put(&mut found);
        assert_eq!(found.limits.slope_sigma_max, 5.0);
        let configured = Values::of(&p);
        // what an earlier commission has brought into force moves no limit
        found.guard_force = 3.0 * p.guard_force;
        let with = |slope_sigma, force_sigma| configured.quiet(&found, &Measured { slope_sigma, force_sigma, ..GOOD });
        // 5 N/s, and a guard of three times 0.4 N
        assert_eq!([with(5.0, 0.06), with(5.1, 0.06), with(5.0, 0.0601)], [true, false, false]);
        let stiff = |stiffness| configured.quiet(&found, &Measured { stiffness, stiffness_std: 10.0, ..GOOD });
        // 150 N/m less three deviations of 10 for 5 mm, and as much again
        assert_eq!([stiff(-149.0), stiff(-151.0)], [true, false]);
    }

    #[test]
    fn each_limit_of_a_response_is_the_last_value_that_is_accepted() {
        let p = Parameters::START;
        let accepted = |m: Measured| acceptable(&p, 20.0, 4, &m);
        type Set = fn(&mut Measured, f64);
        let with = |set: Set, x: f64| {
            let mut m = GOOD;
            set(&mut m, x);
            accepted(m)
        };
        let limits: [(Set, f64, f64); 6] = [
            (|m, x| m.force_constant_std = x, 0.48, 0.481),
            (|m, x| m.io_delay_std = x.hypot(0.17 / 0.628_318_53), 0.2499, 0.2501),
            (|m, x| m.force_constant = x, 40.0, 40.1),
            (|m, x| m.force_constant = x, 10.0, 9.9),
            (|m, x| m.io_delay = x, 4.49, 4.5),
            (|m, x| m.io_delay = x, -0.49, -0.5),
        ];
        for (set, last, first) in limits {
            assert_eq!((with(set, last), with(set, first)), (true, false));
        }
        assert!(!accepted(Measured::START));
        // less than none, by no more than three deviations
        let early = |io_delay| Measured { io_delay, io_delay_std: 0.27, ..GOOD };
        assert_eq!([-0.8, -0.82].map(|delay| accepted(early(delay))), [true, false]);
        assert_eq!(Values::of(&p).with_response(&early(-0.8)).io_delay, 0);
    }
}
