//! Commanded speed of the table, and whether the table follows it.

use control_blocks::{Consecutive, ramp_between};
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;
use crate::limits::spindle_acceleration;

/// Relative tolerance of the table speed (default; twice the oscillation of usual drives).
pub const TOLERANCE: f64 = 0.05;
/// Time for the spindle drive to settle after the end of the ramp, s (default).
const LAG_TIME: f64 = 1.0;

/// Command to the drive of the spindle, where `spindle.speed` is not 0; at rest by default.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Table {
    setpoint: f64,
    /// consecutive samples since the end of the ramp, and those with a wrong speed
    constant: Consecutive,
    diverged: Consecutive,
}

impl Table {
    /// Moves the setpoint for one sample, towards `spindle.speed` if the table is to turn; `speed` rad/s is measured.
    pub fn update(&mut self, p: &Parameters, rotates: bool, speed: f64) {
        let target = if rotates { p.spindle_speed } else { 0.0 };
        let change = spindle_acceleration(p) * p.sample_period;
        self.setpoint = ramp_between(self.setpoint, target, change, change);
        self.constant.update(rotates && self.setpoint == target);
        self.diverged.update(self.settled(p) && (speed - target).abs() > TOLERANCE * target.abs());
    }

    /// Speed to command, rad/s.
    pub fn setpoint(&self) -> f64 {
        self.setpoint
    }

    /// The measured speed is the commanded one, or none is commanded.
    pub fn steady(&self, p: &Parameters) -> bool {
        p.spindle_speed == 0.0 || (self.settled(p) && self.diverged.count() == 0)
    }

    /// The table does not turn as commanded.
    pub fn disobeys(&self, p: &Parameters) -> bool {
        p.spindle_speed != 0.0 && self.diverged.count() > p.ticks(LAG_TIME)
    }

    /// The whole window of the speed regression is after the ramp.
    fn settled(&self, p: &Parameters) -> bool {
        self.constant.count() > p.ticks(p.spindle_window)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn configured() -> Parameters {
        Parameters { spindle_speed: 8.0, spindle_acceleration: 16.0, spindle_window: 0.2, ..Parameters::START }
    }

    /// The table after this number of samples, with the speed that `measured` computes from the setpoint.
    fn after(samples: u32, p: &Parameters, measured: impl Fn(f64) -> f64) -> Table {
        let mut table = Table::default();
        for _ in 0..samples {
            table.update(p, true, measured(table.setpoint()));
        }
        table
    }

    #[test]
    fn the_setpoint_rises_evenly_and_ends_exactly() {
        for sign in [1.0, -1.0] {
            let p = Parameters { spindle_speed: sign * 8.0, ..configured() };
            assert!((after(250, &p, |w| w).setpoint() - sign * 4.0).abs() < 1e-9);
            assert_eq!(after(501, &p, |w| w).setpoint(), sign * 8.0);
        }
    }

    #[test]
    fn it_returns_to_rest_as_evenly() {
        let p = configured();
        let mut table = after(600, &p, |w| w);
        for _ in 0..250 {
            table.update(&p, false, 0.0);
        }
        assert!((table.setpoint() - 4.0).abs() < 1e-9 && !table.steady(&p) && !table.disobeys(&p));
        for _ in 0..2000 {
            table.update(&p, false, 8.0);
        }
        assert!(table.setpoint() == 0.0 && !table.disobeys(&p));
    }

    #[test]
    fn it_is_steady_once_the_regression_is_behind_the_ramp() {
        let p = configured();
        assert!(!after(699, &p, |w| w).steady(&p));
        assert!(after(700, &p, |w| w).steady(&p));
        assert!(after(700, &p, |w| 1.04 * w).steady(&p) && after(700, &p, |w| 0.96 * w).steady(&p));
        assert!(!after(700, &p, |w| 1.06 * w).steady(&p) && !after(700, &p, |w| -w).steady(&p));
    }

    #[test]
    fn a_table_that_does_not_turn_as_configured_is_found_a_second_later() {
        let p = configured();
        for ratio in [0.0, 0.94, 1.06, -1.0] {
            assert!(!after(1699, &p, |w| ratio * w).disobeys(&p), "{ratio}");
            assert!(after(1700, &p, |w| ratio * w).disobeys(&p), "{ratio}");
        }
        assert!(!after(9000, &p, |w| 0.96 * w).disobeys(&p));
    }

    #[test]
    fn without_a_speed_any_table_is_right() {
        let p = Parameters { spindle_speed: 0.0, ..configured() };
        let table = after(9000, &p, |_| 3.0);
        assert!(table.setpoint() == 0.0 && table.steady(&p) && !table.disobeys(&p));
    }
}
