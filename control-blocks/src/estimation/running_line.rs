//! Least-squares line through the newest samples, in constant time per sample.
//!
//! With the samples y_j, j = 0 (oldest) to n - 1, S0 = sum y_j and S1 = sum j y_j, the normal equations give
//!
//! ```text
//! slope = 12 / (n (n^2 - 1)) (S1 - (n - 1)/2 S0),   mean = S0 / n,   end = mean + slope (n - 1)/2.
//! ```
//!
//! A new sample moves every stored one by one index towards the past: S1 += (n - 1) y - (S0 - oldest), then S0 += y -
//! oldest. Once per pass of the ring buffer, when it is in time order, both sums are computed again, so that rounding
//! never accumulates.

use serde::{Deserialize, Serialize};

/// Line through values that stay near zero.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunningLine {
    past: Vec<f64>,
    next: usize,
    count: usize,
    sum: f64,
    moment: f64,
}

impl RunningLine {
    /// Over `window` samples (at least 2), all zero at first.
    pub fn zeroed(window: usize) -> Self {
        Self { count: window, ..Self::empty(window) }
    }

    /// Over the newest samples, at most `window` (at least 2); none at first.
    pub fn empty(window: usize) -> Self {
        Self { past: vec![0.0; window], next: 0, count: 0, sum: 0.0, moment: 0.0 }
    }

    /// Adds the newest sample; the sums are computed again at the end of each pass of the ring buffer.
    pub fn update(&mut self, y: f64) {
        self.push(y);
        if self.in_time_order() {
            self.lower(0.0);
        }
    }

    /// Slope, unit of the samples per second when they are `period` s apart; 0 before two samples.
    pub fn slope(&self, period: f64) -> f64 {
        if self.count < 2 {
            return 0.0;
        }
        let n = self.count as f64;
        12.0 / (period * n * (n * n - 1.0)) * (self.moment - 0.5 * (n - 1.0) * self.sum)
    }

    /// Whether the line has its full length.
    pub fn full(&self) -> bool {
        self.count == self.past.len()
    }

    fn push(&mut self, y: f64) {
        if self.full() {
            let oldest = self.past[self.next];
            self.moment += (self.count - 1) as f64 * y - (self.sum - oldest);
            self.sum += y - oldest;
        } else {
            self.moment += self.count as f64 * y;
            self.sum += y;
            self.count += 1;
        }
        self.past[self.next] = y;
        self.next = if self.next + 1 == self.past.len() { 0 } else { self.next + 1 };
    }

    /// Whether the ring buffer is full with its oldest sample first.
    fn in_time_order(&self) -> bool {
        self.full() && self.next == 0
    }

    /// Lowers all samples of a ring buffer in time order, and computes the sums again.
    fn lower(&mut self, by: f64) {
        (self.sum, self.moment) = (0.0, 0.0);
        for (j, y) in self.past.iter_mut().enumerate() {
            *y -= by;
            self.sum += *y;
            self.moment += j as f64 * *y;
        }
    }

    fn clear(&mut self) {
        (self.next, self.count, self.sum, self.moment) = (0, 0, 0.0, 0.0);
    }
}

/// Line through values that grow without limit, such as the angle of a spindle: it stores their differences from an
/// anchor, which moves to the newest value once per pass of the ring buffer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AnchoredLine {
    line: RunningLine,
    anchor: f64,
}

impl AnchoredLine {
    /// Over the newest samples, at most `window` (at least 2); none at first.
    pub fn new(window: usize) -> Self {
        Self { line: RunningLine::empty(window), anchor: 0.0 }
    }

    /// Adds the newest sample.
    pub fn update(&mut self, y: f64) {
        if self.line.count == 0 {
            self.anchor = y;
        } else if self.line.in_time_order() {
            self.line.lower(y - self.anchor);
            self.anchor = y;
        }
        self.line.push(y - self.anchor);
    }

    /// Slope, unit of the samples per second when they are `period` s apart; 0 before two samples.
    pub fn slope(&self, period: f64) -> f64 {
        self.line.slope(period)
    }

    /// The line at the newest sample; none before the first.
    pub fn end(&self) -> Option<f64> {
        let n = self.line.count as f64;
        (n > 0.0).then(|| self.anchor + self.line.sum / n + self.line.slope(1.0) * (n - 1.0) / 2.0)
    }

    /// Whether the line has its full length.
    pub fn full(&self) -> bool {
        self.line.full()
    }

    /// Discards all samples.
    pub fn clear(&mut self) {
        self.line.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f64 = 1e-4;

    /// Repeatable noise in +-1.
    fn noise(k: u64) -> f64 {
        let x = k.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        ((x ^ (x >> 29)) % 20_011) as f64 / 10_005.0 - 1.0
    }

    /// Two-pass least squares around the means: slope per sample and end.
    fn batch(y: &[f64]) -> (f64, f64) {
        let n = y.len() as f64;
        let (t_mean, y_mean) = ((n - 1.0) / 2.0, y[0] + y.iter().map(|value| value - y[0]).sum::<f64>() / n);
        let (mut ty, mut tt) = (0.0, 0.0);
        for (j, y) in y.iter().enumerate() {
            let t = j as f64 - t_mean;
            ty += t * (y - y_mean);
            tt += t * t;
        }
        (ty / tt, y_mean + ty / tt * t_mean)
    }

    #[test]
    fn equals_batch_least_squares_after_a_hundred_thousand_samples() {
        for (window, offset) in [(2, 0.0), (20, 0.0), (50, 10.0), (200, 10.0)] {
            let mut line = RunningLine::zeroed(window);
            let samples = 100_000 + window as u64 / 2;
            let force = |k: u64| offset + 0.01 * noise(k);
            (0..samples).for_each(|k| line.update(force(k)));
            let recent: Vec<f64> = (samples - window as u64..samples).map(force).collect();
            let error = (line.slope(DT) - batch(&recent).0 / DT).abs();
            assert!(error < 1e-8, "window {window}: error {error} N/s");
        }
    }

    #[test]
    fn an_anchored_line_equals_batch_least_squares_however_far_it_is() {
        for window in [2, 37, 200] {
            let mut line = AnchoredLine::new(window);
            let samples = 100_000 + window as u64 / 2;
            let angle = |k: u64| 5e-3 * k as f64 + 1e-3 * noise(k);
            (0..samples).for_each(|k| line.update(angle(k)));
            let recent: Vec<f64> = (samples - window as u64..samples).map(angle).collect();
            let (slope, end) = batch(&recent);
            assert!((line.slope(DT) - slope / DT).abs() < 1e-8, "window {window}: {}", line.slope(DT));
            assert!((line.end().unwrap() - end).abs() < 1e-9, "window {window}");
        }
    }

    #[test]
    fn a_growing_line_is_a_line_through_what_there_is() {
        let mut line = AnchoredLine::new(100);
        assert_eq!((line.end(), line.slope(DT)), (None, 0.0));
        let values: Vec<f64> = (0..250).map(|k| 3.0 + noise(k)).collect();
        for count in 1..=values.len() {
            line.update(values[count - 1]);
            assert_eq!(line.full(), count >= 100);
            let recent = &values[count.saturating_sub(100)..count];
            let (slope, end) = if count == 1 { (0.0, values[0]) } else { batch(recent) };
            assert!((line.slope(1.0) - slope).abs() < 1e-12 && (line.end().unwrap() - end).abs() < 1e-11, "{count}");
        }
        line.clear();
        assert_eq!((line.end(), line.full()), (None, false));
        line.update(7.0);
        assert_eq!((line.end(), line.slope(DT)), (Some(7.0), 0.0));
    }

    #[test]
    fn a_ramp_gives_its_slope_and_its_end() {
        let mut zeroed = RunningLine::zeroed(50);
        let mut anchored = AnchoredLine::new(50);
        for k in 0..1234 {
            let y = 20.0 * f64::from(k) * DT;
            zeroed.update(y);
            anchored.update(y);
        }
        assert!((zeroed.slope(DT) - 20.0).abs() < 1e-9 && (anchored.slope(DT) - 20.0).abs() < 1e-9);
        assert!((anchored.end().unwrap() - 20.0 * 1233.0 * DT).abs() < 1e-12);
    }
}
