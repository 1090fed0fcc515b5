//! Load of an end mill that removes a burr.

use std::f64::consts::TAU;

/// Mean torque of a straight end mill from chip cross-section and engaged edge length.
#[derive(Clone, Copy, Debug)]
pub struct Milling {
    /// teeth of the tool
    pub teeth: f64,
    /// radius of the tool, m
    pub radius: f64,
    /// force per chip cross-section, Pa
    pub pressure: f64,
    /// force per engaged edge length, N/m
    pub edge_force: f64,
    /// largest chip of one tooth, m: a slow tool rubs and does not cut deeper
    pub chip_most: f64,
}

impl Milling {
    /// Torque in N.m for `engagement` m into a burr `thickness` m thick, at a feed in m/s and a spindle speed in rad/s.
    pub fn torque(&self, engagement: f64, thickness: f64, feed: f64, speed: f64) -> f64 {
        if engagement <= 0.0 {
            return 0.0;
        }
        let engagement = engagement.min(2.0 * self.radius);
        let passages = self.teeth * speed.max(0.0) / TAU;
        // f_z = V / (z n)
        let chip = (feed.max(0.0) / passages.max(f64::MIN_POSITIVE)).min(self.chip_most);
        let contact = (1.0 - engagement / self.radius).acos();
        let force = self.pressure * chip * engagement + self.edge_force * self.radius * contact;
        self.teeth * thickness / TAU * force
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MILL: Milling = Milling { teeth: 2.0, radius: 6e-3, pressure: 9e8, edge_force: 2e4, chip_most: 5e-4 };
    const SPEED: f64 = 1811.651;

    #[test]
    fn a_burr_of_2_by_5_mm_loads_the_spindle_as_the_paper_says() {
        // at 65 mm/s and 17,300 rpm close to 1.35 of the rated 0.327 N.m, a slip of 0.039
        let torque = MILL.torque(5e-3, 2e-3, 0.065, SPEED);
        let chip = 0.065 / (2.0 * 17_300.0 / 60.0);
        let by_hand = 2.0 * 2e-3 / TAU * (9e8 * chip * 5e-3 + 2e4 * 6e-3 * (1.0_f64 / 6.0).acos());
        assert!((torque - by_hand).abs() < 1e-6 * by_hand, "{torque} instead of {by_hand}");
        assert!((0.38..0.46).contains(&torque), "{torque} N.m");
    }

    #[test]
    fn nothing_is_cut_in_air_and_a_tool_that_stands_only_rubs() {
        assert_eq!(MILL.torque(0.0, 2e-3, 0.1, SPEED), 0.0);
        assert_eq!(MILL.torque(-1e-3, 2e-3, 0.1, SPEED), 0.0);
        let rubs = 2.0 * 2e-3 / TAU * 2e4 * 6e-3 * (1.0_f64 / 6.0).acos();
        for feed in [0.0, -0.1] {
            assert!((MILL.torque(5e-3, 2e-3, feed, SPEED) - rubs).abs() < 1e-12);
        }
    }

    #[test]
    fn a_stalled_tool_and_a_full_slot_stay_finite() {
        let most = 2.0 * 2e-3 / TAU * (9e8 * 5e-4 * 5e-3 + 2e4 * 6e-3 * (1.0_f64 / 6.0).acos());
        for speed in [0.0, -1.0, 1e-9] {
            assert!((MILL.torque(5e-3, 2e-3, 0.1, speed) - most).abs() < 1e-9);
        }
        assert!(MILL.torque(5e-3, 2e-3, 0.0, 0.0) < 0.12);
        assert_eq!(MILL.torque(0.012, 2e-3, 0.1, SPEED), MILL.torque(0.05, 2e-3, 0.1, SPEED));
    }
}
