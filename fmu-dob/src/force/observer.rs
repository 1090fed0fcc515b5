//! Disturbance observer, eq. 1: F_dis = K_tn I - M_n z'', low-passed so that nothing is differentiated twice.

use serde::{Deserialize, Serialize};

use crate::interface::{Observer, Parameters, Stage};

/// An acceleration has no effect on the observer after this many times 1 / `observer.bandwidth`: exp(-6) remains.
const FORGOTTEN: f64 = 6.0;

/// Time (s) until an acceleration has no effect on the observer.
pub fn forgetting(p: &Parameters) -> f64 {
    FORGOTTEN / p.observer.bandwidth
}

/// Velocity-form disturbance observer, discretized by backward Euler.
///
/// With Q(s) = g / (s + g) and v = g_v s / (s + g_v) z the filtered eq. 1 is
/// F = Q [K_tn I + g M_n v] - g M_n v. Backward Euler keeps both low-passes and their gains
/// consistent, so that the inertia term is exact at low frequency.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct DisturbanceObserver {
    velocity_gain: f64,
    velocity_weight: f64,
    mass: f64,
    momentum_gain: f64,
    force_weight: f64,
    force_constant: f64,
    sample_period: f64,
    leverage: f64,
    position_filter: f64,
    force_filter: f64,
    velocity: f64,
    /// by how much the velocity of the nominal stage is ahead of the filtered one, m/s
    lag: f64,
}

impl DisturbanceObserver {
    /// Observer at rest at position 0.
    pub fn new(p: &Parameters) -> Self {
        let Observer { bandwidth, velocity_bandwidth } = p.observer;
        let Stage { mass, force_constant, .. } = p.stage;
        let weight = |g: f64| g * p.sample_period / (1.0 + g * p.sample_period);
        Self {
            velocity_gain: velocity_bandwidth,
            velocity_weight: weight(velocity_bandwidth),
            mass,
            momentum_gain: bandwidth * mass,
            force_weight: weight(bandwidth),
            force_constant,
            sample_period: p.sample_period,
            leverage: 0.5 * p.sample_period * p.sample_period + p.sample_period / velocity_bandwidth,
            position_filter: 0.0,
            force_filter: 0.0,
            velocity: 0.0,
            lag: 0.0,
        }
    }

    /// The observer of another nominal stage, at the same position, with the force of the present current.
    pub fn renewed(&self, p: &Parameters) -> Self {
        let new = Self::new(p);
        let force = self.force() * new.force_constant / self.force_constant;
        let force_filter = force + new.momentum_gain * self.velocity;
        Self { position_filter: self.position_filter, force_filter, velocity: self.velocity, lag: self.lag, ..new }
    }

    /// Nominal thrust constant, N/A.
    pub fn force_constant(&self) -> f64 {
        self.force_constant
    }

    /// The same with its state: filtered position (m) and filtered force (N).
    pub fn with_memory(&self, [position_filter, force_filter]: [f64; 2]) -> Self {
        Self { position_filter, force_filter, ..self.clone() }
    }

    /// Its state: filtered position (m) and filtered force (N).
    pub fn memory(&self) -> [f64; 2] {
        [self.position_filter, self.force_filter]
    }

    /// Takes the position (m) and the current that acted since the last sample (A).
    pub fn update(&mut self, position: f64, acted: f64) {
        let gained = self.acceleration(acted) * self.sample_period;
        self.lag += gained - self.velocity_weight * (self.lag + 0.5 * gained);
        self.position_filter += self.velocity_weight * (position - self.position_filter);
        self.velocity = self.velocity_gain * (position - self.position_filter);
        let input = self.force_constant * acted + self.momentum_gain * self.velocity;
        self.force_filter += self.force_weight * (input - self.force_filter);
    }

    /// Bridges a sample without a position, in which the current `acted` acted (A): the stage is where the nominal one
    /// is.
    pub fn coast(&mut self, acted: f64) {
        let position = self.position_filter + self.velocity / self.velocity_gain;
        self.update(position + self.nominal_motion(self.acceleration(acted)), acted);
    }

    /// Moves to a position (m) and velocity (m/s) without changing the estimated force.
    pub fn reseat(&mut self, position: f64, velocity: f64) {
        let force = self.force();
        (self.velocity, self.lag) = (velocity, 0.0);
        self.position_filter = position - velocity / self.velocity_gain;
        self.force_filter = force + self.momentum_gain * velocity;
    }

    /// Motion (m) in a sample of T_s at an acceleration of `a` (m/s2): v T_s + a (T_s^2 / 2 + T_s / g_v), where v is
    /// late by the 1 / g_v of its filter.
    pub fn motion(&self, acceleration: f64) -> f64 {
        self.velocity * self.sample_period + acceleration * self.leverage
    }

    /// The same where no reading corrects it: v is late by what all the accelerations until now have made of the
    /// nominal stage.
    pub fn nominal_motion(&self, acceleration: f64) -> f64 {
        (self.velocity + self.lag + 0.5 * acceleration * self.sample_period) * self.sample_period
    }

    /// Acceleration (m/s2) of the nominal stage when the drive pushes with the current `acted` (A), if the force stays.
    pub fn acceleration(&self, acted: f64) -> f64 {
        (self.force_constant * acted - self.force()) / self.mass
    }

    /// Additional motion in a sample per unforeseen acceleration, m/(m/s2): T_s^2 / 2, plus T_s / g_v for the velocity
    /// that the filter does not yet show.
    pub fn leverage(&self) -> f64 {
        self.leverage
    }

    /// Estimated disturbance force, N; positive against the positive axis.
    pub fn force(&self) -> f64 {
        self.force_filter - self.momentum_gain * self.velocity
    }

    /// Estimated velocity, m/s.
    pub fn velocity(&self) -> f64 {
        self.velocity
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Force estimates after a step of 0.1 N on a free mass of `mass` kg that starts at rest.
    fn step_response(mass: f64) -> Vec<f64> {
        let p = Parameters::START;
        let (dt, force) = (p.sample_period, 0.1);
        let mut observer = DisturbanceObserver::new(&p);
        (1..=1000)
            .map(|k| {
                let t = f64::from(k) * dt;
                observer.update(-0.5 * force / mass * t * t, 0.0);
                observer.force()
            })
            .collect()
    }

    #[test]
    fn force_step_reaches_63_percent_in_two_milliseconds() {
        let response = step_response(Parameters::START.stage.mass);
        let ticks = response.iter().position(|f| *f >= 0.0632).unwrap() + 1;
        let rise = ticks as f64 * 1e-4;
        println!("63 % after {rise} s");
        assert!((1.8e-3..=2.5e-3).contains(&rise), "63 % after {rise} s");
        let last = response.last().unwrap();
        assert!((last - 0.1).abs() < 1e-3 * 0.1, "final {last} N");
    }

    #[test]
    fn wrong_mass_scales_the_final_force() {
        let mass = 10.4;
        let last = *step_response(mass).last().unwrap();
        let expected = 0.1 * Parameters::START.stage.mass / mass;
        assert!((last - expected).abs() < 1e-4 * expected, "final {last} N, expected {expected} N");
    }

    #[test]
    fn acted_current_on_the_nominal_mass_is_no_disturbance() {
        let p = Parameters::START;
        let mut observer = DisturbanceObserver::new(&p);
        let (current, dt) = (0.5, p.sample_period);
        let acceleration = p.stage.force_constant * current / p.stage.mass;
        for k in 1..=2000 {
            let t = f64::from(k) * dt;
            observer.update(0.5 * acceleration * t * t, current);
        }
        // 10 N of thrust, all of it accelerates
        assert!(observer.force().abs() < 1e-6, "{} N", observer.force());
    }

    #[test]
    fn coasting_bridges_a_constant_velocity() {
        let p = Parameters::START;
        let mut observer = DisturbanceObserver::new(&p);
        let position = |k: i32| 1e-3 * f64::from(k) * p.sample_period;
        (0..3000).for_each(|k| observer.update(position(k), 0.0));
        (0..3).for_each(|_| observer.coast(0.0));
        observer.update(position(3003), 0.0);
        assert!(observer.force().abs() < 1e-9, "{} N", observer.force());
        assert!((observer.velocity() - 1e-3).abs() < 1e-12);
    }

    #[test]
    fn coasting_goes_where_the_drive_pushes() {
        let p = Parameters::START;
        let mut observer = DisturbanceObserver::new(&p);
        // -20 N brake from 2 mm/s for 1 ms, the gap begins 0.2 ms before their end
        let (dt, brake) = (p.sample_period, 2.0);
        let position = |k: i32| {
            let t = f64::from(k) * dt;
            let braked = t.clamp(0.0, 1e-3);
            2e-3 * t - brake * braked * (t - 0.5 * braked)
        };
        let acted = |k: i32| if (1..=10).contains(&k) { -1.0 } else { 0.0 };
        (-3000..=8).for_each(|k| observer.update(position(k), acted(k)));
        let force = observer.force();
        (9..=12).for_each(|k| observer.coast(acted(k)));
        let predicted = observer.position_filter + observer.velocity / observer.velocity_gain;
        // it interprets its late velocity as 3 N, which decay as with positions
        assert!((predicted - position(12)).abs() < 6e-8, "{} m", predicted - position(12));
        assert!(observer.force().abs() < force.abs(), "{} N after {force} N", observer.force());
    }

    #[test]
    fn the_motion_to_come_is_that_of_velocity_and_acceleration() {
        let p = Parameters::START;
        let mut observer = DisturbanceObserver::new(&p);
        let (acceleration, current, dt) = (0.5, 0.25, p.sample_period);
        let position = |k: i32| 0.5 * acceleration * (f64::from(k) * dt).powi(2);
        (0..3000).for_each(|k| observer.update(position(k), current));
        // 5 N on 10 kg, no disturbance
        let a = observer.acceleration(current);
        assert!((a - acceleration).abs() < 1e-5, "{a}");
        let motion = observer.motion(a);
        assert!((motion - (position(3000) - position(2999))).abs() < 2.5e-4 * motion, "{motion}");
        // a force of 1 N takes 0.1 m/s2 of it
        observer.force_filter += 1.0;
        assert!((observer.acceleration(current) - (a - 0.1)).abs() < 1e-9);
    }

    #[test]
    fn another_thrust_constant_changes_the_force_in_its_ratio_and_not_the_motion() {
        let p = Parameters::START;
        let mut observer = DisturbanceObserver::new(&p);
        let position = |k: i32| 1e-3 * f64::from(k) * p.sample_period;
        (0..3000).for_each(|k| observer.update(position(k), 0.01));
        let mut other = p.clone();
        other.stage.force_constant *= 0.8;
        let mut renewed = observer.renewed(&other);
        assert!((renewed.force() / observer.force() - 0.8).abs() < 1e-9, "{renewed:?}");
        assert_eq!(renewed.velocity(), observer.velocity());
        // and so it continues, by itself
        renewed.update(position(3000), 0.01);
        assert!((renewed.force() / observer.force() - 0.8).abs() < 1e-6, "{renewed:?}");
    }

    #[test]
    fn reseat_keeps_the_force() {
        let p = Parameters::START;
        let mut observer = DisturbanceObserver::new(&p);
        for _ in 0..200 {
            observer.update(0.0, 0.01);
        }
        let before = observer.force();
        assert!(before > 0.1);
        observer.reseat(0.3, 1e-3);
        assert!((observer.force() - before).abs() < 1e-12);
        assert!((observer.velocity() - 1e-3).abs() < 1e-15);
        // and so it continues
        observer.update(0.3 + 1e-3 * p.sample_period, 0.01);
        assert!((observer.velocity() - 1e-3).abs() < 1e-12, "{}", observer.velocity());
    }
}
