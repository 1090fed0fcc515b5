//! Following of the surface: the probe is held at its null by the velocity of the slide.

use serde::{Deserialize, Serialize};

use crate::interface::{Law, Parameters};
use crate::sensing::Calm;

/// Time within the band of settling after which the probe has settled, published law, s (default; ten beats of the loop).
const SETTLE_TIME: f64 = 0.1;

impl Parameters {
    /// Probe deflection while following, m.
    pub fn null(&self) -> f64 {
        match self.law {
            Law::Paper => self.probe.at_pusher - self.follow.gap,
            Law::Default => self.park.probe,
        }
    }

    /// Error of following without reaction, m.
    pub fn dead_zone(&self) -> f64 {
        match self.law {
            Law::Paper => self.follow.dead_zone,
            Law::Default => self.park.dead_zone,
        }
    }

    /// Following error of a settled probe (m), and the time for which it must persist (s).
    pub fn settling(&self) -> (f64, f64) {
        match self.law {
            Law::Paper => (self.follow.settle_band, SETTLE_TIME),
            // the model accepts any motion of the surface, and the slide may move
            Law::Default => (self.park.probe, 0.0),
        }
    }
}

/// Velocity of following in the control loop; by default before its first period.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Follower {
    /// tip position in the last period, if the probe touched
    tip: Option<f64>,
    surface: f64,
    velocity: f64,
}

impl Follower {
    /// One period of the control loop.
    pub fn update(&mut self, p: &Parameters, calm: &Calm) {
        let tip = (calm.probe >= p.probe.contact).then_some(calm.tip);
        let before = std::mem::replace(&mut self.tip, tip);
        (self.surface, self.velocity) = (0.0, 0.0);
        // a slide that follows a lost ring would crash into it when the ring returns
        let Some(tip) = tip else { return };
        // the tip has the velocity of the surface, whatever the slide does
        self.surface = before.map_or(0.0, |before| (tip - before) * p.rates.control);
        let error = p.null() - calm.probe;
        let beyond = error - error.clamp(-p.dead_zone(), p.dead_zone());
        if beyond != 0.0 || p.dead_zone() == 0.0 {
            let (maximum, limit) = (p.follow.velocity_max, p.slide.velocity_max);
            // the probe signal is corrected slowly: the surface may be nearer
            let correction = (p.follow.gain * beyond).clamp(-maximum, maximum);
            self.velocity = (correction + self.surface).clamp(-limit, limit);
        }
    }

    /// Velocity of the surface over the last period, positive away from the pusher, m/s; 0 without contact.
    pub fn surface(&self) -> f64 {
        self.surface
    }

    /// Velocity of the slide until the next period, m/s.
    pub fn velocity(&self) -> f64 {
        self.velocity
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use control_blocks::Trajectory;

    /// Largest error (m) after 1 s, following a surface of amplitude `b` m at `w` rad/s with the setpoint `delay` late.
    fn error(p: &Parameters, b: f64, w: f64, delay: usize) -> f64 {
        let mut follower = Follower::default();
        let mut setpoint = Trajectory { position: 0.08 + p.null() - 1e-4, ..Trajectory::default() };
        let mut slide = vec![setpoint.position; delay + 1];
        let mut largest: f64 = 0.0;
        for k in 0..6000 {
            let angle = w * 1e-3 * f64::from(k);
            let probe = slide[0] - (0.08 - b * angle.cos());
            if k % 10 == 0 {
                follower.update(p, &Calm { tip: slide[0] - probe, probe });
            }
            setpoint.step(follower.velocity(), p.slide.acceleration_max, p.sample_period);
            slide.rotate_left(1);
            slide[delay] = setpoint.position;
            // a travel of 20 mm takes a second
            if k > 2000 {
                largest = largest.max((probe - p.null()).abs());
            }
        }
        largest
    }

    #[test]
    fn a_ring_at_rest_is_held() {
        assert!(error(&Parameters::PAPER, 0.0, 2.0944, 5) < 1e-10);
    }

    #[test]
    fn eccentric_rings_are_followed_within_a_part_of_the_gap() {
        let p = Parameters::PAPER;
        // 0.6 mm at 20 rpm, 3 mm at 45 rpm, 20 mm at 20 rpm; the servo lags by 5 ms
        for (b, w, limit) in [(6e-4, 2.0944, 5e-6), (3e-3, 4.712, 1e-4), (0.02, 2.0944, 1.5e-4)] {
            let error = error(&p, b, w, 5);
            assert!(error < limit, "{b} m at {w} rad/s: {error} m");
        }
    }

    #[test]
    fn the_outer_loop_is_damped_with_twice_the_gain_and_oscillates_beyond_its_limit() {
        let mut p = Parameters::PAPER;
        p.follow.gain = 25.0;
        assert!(error(&p, 0.0, 2.0, 0) < 1e-9);
        // |1 - Kp T| > 1
        p.follow.gain = 210.0;
        assert!(error(&p, 0.0, 2.0, 0) > 1e-5);
    }

    #[test]
    fn a_lost_ring_is_not_chased() {
        let p = Parameters::PAPER;
        let mut follower = Follower::default();
        follower.update(&p, &Calm { tip: 0.1, probe: 0.0 });
        assert_eq!(follower.velocity(), 0.0);
    }

    #[test]
    fn the_way_to_the_ring_is_slow_beside_the_surface() {
        let p = Parameters::PAPER;
        let mut follower = Follower::default();
        // 10 mm before its position, on a surface that moves away at 30 mm/s
        for k in 0..2 {
            follower.update(&p, &Calm { tip: 0.1 + 3e-4 * f64::from(k), probe: p.null() - 0.01 });
        }
        assert!((follower.velocity() - 0.05).abs() < 1e-12, "{} m/s", follower.velocity());
        for _ in 0..2 {
            follower.update(&p, &Calm { tip: 0.1, probe: p.null() + 0.003 });
        }
        assert!((follower.velocity() + 0.02).abs() < 1e-12, "{} m/s", follower.velocity());
    }

    #[test]
    fn within_the_dead_zone_the_slide_does_not_move() {
        let mut p = Parameters::PAPER;
        p.follow.dead_zone = 1e-4;
        let mut follower = Follower::default();
        for k in 0..100 {
            let probe = p.null() + 0.9e-4 * (0.1 * f64::from(k)).sin();
            follower.update(&p, &Calm { tip: 0.1 - probe, probe });
            assert_eq!(follower.velocity(), 0.0);
        }
        follower.update(&p, &Calm { tip: 0.1 - p.null() + 2e-4, probe: p.null() - 2e-4 });
        assert!(follower.velocity() > 0.0);
    }

    #[test]
    fn position_dead_zone_and_settling_are_those_of_the_law() {
        let (paper, start) = (Parameters::PAPER, Parameters::START);
        assert_eq!((paper.null(), start.null()), (0.02 - 5e-4, 4.5e-3));
        assert_eq!((paper.dead_zone(), start.dead_zone()), (paper.follow.dead_zone, start.park.dead_zone));
        assert_eq!(paper.settling(), (paper.follow.settle_band, SETTLE_TIME));
        assert_eq!(start.settling(), (start.park.probe, 0.0));
    }

    #[test]
    fn the_surface_is_what_the_tip_does_from_period_to_period_while_the_probe_touches() {
        let p = Parameters::PAPER;
        let mut follower = Follower::default();
        let contact = p.probe.contact;
        let found = [(0.1, contact), (0.1002, contact), (0.1001, contact), (0.1, 0.999 * contact), (0.0999, contact)]
            .map(|(tip, probe)| {
                follower.update(&p, &Calm { tip, probe });
                follower.surface()
            });
        // 100 Hz
        for (found, expected) in found.into_iter().zip([0.0, 0.02, -0.01, 0.0, 0.0]) {
            assert!((found - expected).abs() < 1e-9, "{found} m/s");
        }
        follower.update(&p, &Calm { tip: 0.0997, probe: 0.0 });
        assert_eq!((follower.surface(), follower.velocity()), (0.0, 0.0));
    }
}
