//! Angle and speed of the spindle by regression: the encoder's quantum of 0.09 deg jitters both.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use crate::parameters::Parameters;

/// Shortest change from angle `from` to angle `to`, both rad, wrapped or not.
pub fn change(from: f64, to: f64) -> f64 {
    wrap(to - from)
}

/// The same angle within -pi to pi, rad.
pub fn wrap(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}

/// Least-squares line through the last `window` s of unwrapped angles.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Spindle {
    period: f64,
    quantum: f64,
    /// unwrapped angles less `anchor`, a ring
    angles: Vec<f64>,
    newest: usize,
    count: usize,
    anchor: f64,
    /// sum of the angles, and the same weighted with their age rank 0 (oldest) to count - 1
    sums: [f64; 2],
    raw: Option<f64>,
    unwrapped: f64,
}

impl Spindle {
    /// Before the first sample.
    pub fn new(p: &Parameters) -> Self {
        Self {
            period: p.sample_period,
            quantum: p.spindle.quantum,
            angles: vec![0.0; p.ticks(p.spindle.window).max(2) as usize],
            newest: 0,
            count: 0,
            anchor: 0.0,
            sums: [0.0; 2],
            raw: None,
            unwrapped: 0.0,
        }
    }

    /// Takes the next angle (rad, wrapped or not); the change since the last one.
    pub fn update(&mut self, raw: f64) -> f64 {
        let moved = self.raw.map_or(0.0, |before| change(before, raw));
        self.unwrapped = if self.raw.is_some() { self.unwrapped + moved } else { raw };
        self.raw = Some(raw);
        self.push(self.unwrapped);
        moved
    }

    /// Forgets all samples: the encoder has jumped.
    pub fn restart(&mut self) {
        (self.count, self.raw, self.sums) = (0, None, [0.0; 2]);
    }

    /// Speed, rad/s; 0 before two samples.
    pub fn speed(&self) -> f64 {
        self.slope() / self.period
    }

    /// Whether the regression has its full length.
    pub fn ready(&self) -> bool {
        self.count == self.angles.len()
    }

    /// Smoothed unwrapped angle now, rad: the end of the line, within one quantum of the encoder.
    pub fn angle(&self) -> f64 {
        if self.count == 0 {
            return self.unwrapped;
        }
        let n = self.count as f64;
        let end = self.anchor + self.sums[0] / n + self.slope() * (n - 1.0) / 2.0;
        end.clamp(self.unwrapped - self.quantum, self.unwrapped + self.quantum)
    }

    /// Slope of the line, rad per sample.
    fn slope(&self) -> f64 {
        if self.count < 2 {
            return 0.0;
        }
        let n = self.count as f64;
        12.0 / (n * (n * n - 1.0)) * (self.sums[1] - (n - 1.0) / 2.0 * self.sums[0])
    }

    fn push(&mut self, angle: f64) {
        let length = self.angles.len();
        self.newest = if self.count == 0 { 0 } else { (self.newest + 1) % length };
        if self.count < length {
            if self.count == 0 {
                self.anchor = angle;
            }
            let y = angle - self.anchor;
            self.sums[1] += self.count as f64 * y;
            self.sums[0] += y;
            self.count += 1;
            self.angles[self.newest] = y;
            return;
        }
        // the sums are made anew once per turn of the ring, so that they stay exact for hours
        if self.newest == 0 {
            self.move_anchor(angle);
        }
        let (y, oldest) = (angle - self.anchor, self.angles[self.newest]);
        self.sums[1] += (length - 1) as f64 * y - (self.sums[0] - oldest);
        self.sums[0] += y - oldest;
        self.angles[self.newest] = y;
    }

    /// Moves the anchor to `angle`; the oldest sample stands at index 0.
    fn move_anchor(&mut self, angle: f64) {
        let shift = angle - self.anchor;
        self.anchor = angle;
        self.sums = [0.0; 2];
        for (rank, y) in self.angles.iter_mut().enumerate() {
            *y -= shift;
            self.sums[0] += *y;
            self.sums[1] += rank as f64 * *y;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const QUANTUM: f64 = TAU / 4000.0;

    fn encoder(angle: f64) -> f64 {
        (angle / QUANTUM).round() * QUANTUM
    }

    /// Largest errors of speed (relative) and angle (rad) after the window is full.
    fn errors(speed: f64, seconds: u32, read: impl Fn(f64) -> f64) -> (f64, f64) {
        let mut spindle = Spindle::new(&Parameters::PAPER);
        let (mut of_speed, mut of_angle) = (0.0, 0.0);
        for k in 0..seconds * 1000 {
            let angle = 0.3 + speed * f64::from(k) * 1e-3;
            spindle.update(read(encoder(angle)));
            if spindle.ready() {
                of_speed = f64::max(of_speed, (spindle.speed() / speed - 1.0).abs());
                of_angle = f64::max(of_angle, change(angle, spindle.angle()).abs());
            }
        }
        (of_speed, of_angle)
    }

    #[test]
    fn quantised_angle_and_speed_are_smoothed_in_both_directions() {
        // 20 and 45 rpm: the quantum is 1.6 mrad, half of it the error of one reading
        for (speed, share) in [(2.0944, 0.25), (-2.0944, 0.25), (4.6, 0.25), (4.712, 0.8), (-4.712, 0.8)] {
            let (of_speed, of_angle) = errors(speed, 20, |angle| angle);
            assert!(of_speed < 2e-3, "{speed} rad/s: speed {of_speed}");
            // 45 rpm are three quanta per sample: the rounding is the same for many samples
            assert!(of_angle < share * QUANTUM, "{speed} rad/s: angle {of_angle} rad");
        }
    }

    #[test]
    fn wrapped_angles_give_the_same() {
        let plain = errors(2.0944, 20, |angle| angle);
        for read in [wrap as fn(f64) -> f64, |angle| angle.rem_euclid(TAU)] {
            let wrapped = errors(2.0944, 20, read);
            assert!((wrapped.0 - plain.0).abs() < 1e-9 && (wrapped.1 - plain.1).abs() < 1e-9);
        }
    }

    #[test]
    fn sums_stay_exact_for_an_hour() {
        let mut spindle = Spindle::new(&Parameters::PAPER);
        for k in 0..3_600_000 {
            spindle.update(1e-3 * f64::from(k));
        }
        assert!((spindle.speed() - 1.0).abs() < 1e-9, "{}", spindle.speed());
        assert!((spindle.angle() - 3599.999).abs() < 1e-9, "{}", spindle.angle());
    }

    #[test]
    fn a_change_of_speed_leaves_the_angle_within_a_quantum() {
        let mut spindle = Spindle::new(&Parameters::PAPER);
        let mut angle = 0.0;
        for k in 0..3000 {
            let speed = if k < 1500 { 2.0 } else { -3.0 };
            angle += 1e-3 * speed;
            spindle.update(encoder(angle));
            assert!((spindle.angle() - angle).abs() <= 1.5 * QUANTUM);
        }
        assert!((spindle.speed() + 3.0).abs() < 0.01);
    }

    #[test]
    fn at_rest_it_stands_still() {
        let mut spindle = Spindle::new(&Parameters::PAPER);
        for _ in 0..2000 {
            spindle.update(1.0);
        }
        assert_eq!((spindle.speed(), spindle.angle()), (0.0, 1.0));
    }

    #[test]
    fn the_first_sample_is_an_angle_without_a_speed() {
        let mut spindle = Spindle::new(&Parameters::PAPER);
        assert_eq!(spindle.update(2.5), 0.0);
        assert_eq!((spindle.angle(), spindle.speed(), spindle.ready()), (2.5, 0.0, false));
    }
}
