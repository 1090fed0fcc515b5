//! Measurement equation of a ring: eq. 4 for an eccentric ring with lobes, and its gradient.
//!
//! State: b0, center (c_x, c_y) in the table frame, cosine and sine of the form harmonics.

use nalgebra::SVector;

/// States of a model of a ground ring, whose form has harmonics up to 6.
pub const GROUND: usize = states(6);
/// States of a model of a ring of any form, with harmonics up to 20.
pub const ANY: usize = states(20);
/// Largest c_y of a plausible estimate, in radii.
const LEVER_MAX: f64 = 0.9;

/// The state, or a gradient by it.
pub type Vector<const N: usize> = SVector<f64, N>;

/// b0, center, and two for each harmonic; the lowest is 2, since 1 is the center.
const fn states(highest: usize) -> usize {
    3 + 2 * (highest - 1)
}

/// y = b0 + r - (c_x + sqrt(R^2 - c_y^2)), eq. 4 with the center in the world frame, of a ring of `radius` m at the
/// spindle angle (rad), for a state near the point of linearization, and its gradient.
pub fn line<const N: usize>(radius: f64, linear: &Vector<N>, angle: f64, state: &Vector<N>) -> (f64, Vector<N>) {
    let tangent = Tangent::new(radius, linear, angle);
    (tangent.at(linear, state), tangent.gradient)
}

/// That line at one spindle angle, linearized.
pub struct Tangent<const N: usize> {
    /// y of a round ring at the point of linearization, minus b0, m.
    round: f64,
    /// By the state.
    pub gradient: Vector<N>,
}

impl<const N: usize> Tangent<N> {
    /// Of a ring of `radius` m at the spindle angle (rad).
    pub fn new(radius: f64, linear: &Vector<N>, angle: f64) -> Self {
        let (sine, cosine) = angle.sin_cos();
        let (x, y) = (linear[1], linear[2]);
        let (across, along) = (sine * x + cosine * y, cosine * x - sine * y);
        let lever = (across / radius).clamp(-LEVER_MAX, LEVER_MAX);
        let root = radius * (1.0 - lever * lever).sqrt();
        let tilt = radius * lever / root;
        // the chord changes by more than the radius
        let mut gradient = harmonics::<N>(-lever.asin() - angle) * (-radius / root);
        gradient[0] = 1.0;
        gradient[1] = -cosine + tilt * sine;
        gradient[2] = sine + tilt * cosine;
        Self { round: radius - along - root, gradient }
    }

    /// y of a state near the point of linearization, m.
    pub fn at(&self, linear: &Vector<N>, state: &Vector<N>) -> f64 {
        let mut rest = state - linear;
        // b0 and form enter linearly
        rest[0] = state[0];
        rest.rows_range_mut(3..).copy_from(&state.rows_range(3..));
        self.round + self.gradient.dot(&rest)
    }
}

/// Deviation of the ring from its radius in the direction `phi` (rad, ring frame), m.
pub fn form<const N: usize>(state: &Vector<N>, phi: f64) -> f64 {
    let terms = harmonics::<N>(phi);
    (3..N).map(|i| state[i] * terms[i]).sum()
}

/// Cosine and sine of each harmonic of `phi` at their indices in the state, the rest 0.
fn harmonics<const N: usize>(phi: f64) -> Vector<N> {
    let mut terms = Vector::<N>::zeros();
    let (s1, c1) = phi.sin_cos();
    let (mut s, mut c) = (s1, c1);
    for i in (3..N).step_by(2) {
        (s, c) = (s * c1 + c * s1, c * c1 - s * s1);
        (terms[i], terms[i + 1]) = (c, s);
    }
    terms
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A state 14 mm off, with small lobes.
    fn state<const N: usize>() -> Vector<N> {
        let mut state = Vector::from_fn(|i, _| 1e-7 / (1.0 + i as f64));
        (state[0], state[1], state[2]) = (0.07, 0.011, -0.009);
        state
    }

    #[test]
    fn the_form_is_the_sum_of_its_harmonics() {
        fn off<const N: usize>(highest: u32) -> f64 {
            let (state, phi) = (state::<N>(), 0.8_f64);
            let sum: f64 = (2..=highest)
                .map(|h| {
                    let (sine, cosine) = (f64::from(h) * phi).sin_cos();
                    let i = 2 * h as usize - 1;
                    state[i] * cosine + state[i + 1] * sine
                })
                .sum();
            form(&state, phi) - sum
        }
        assert!(off::<GROUND>(6).abs() < 1e-20 && off::<ANY>(20).abs() < 1e-20);
    }

    #[test]
    fn the_line_of_a_round_ring_is_that_of_the_circle() {
        let mut round = state::<GROUND>();
        round.rows_range_mut(3..).fill(0.0);
        for angle in [0.0, 1.0, 2.5, 4.0] {
            let (sine, cosine) = f64::sin_cos(angle);
            let (x, y) = (cosine * round[1] - sine * round[2], sine * round[1] + cosine * round[2]);
            let surface = x + (0.05_f64.powi(2) - y * y).sqrt();
            assert!((line(0.05, &round, angle, &round).0 - (0.07 + 0.05 - surface)).abs() < 1e-15);
        }
    }

    #[test]
    fn the_gradient_is_that_of_the_line() {
        let at = state::<ANY>();
        for angle in [0.3, 1.9, 3.3, 5.0] {
            let (_, gradient) = line(0.05, &at, angle, &at);
            for i in 0..ANY {
                let mut there = at;
                there[i] += 1e-7;
                // the line of another ring, linearized there; the rotation of the lobes is neglected
                let by = (line(0.05, &there, angle, &there).0 - line(0.05, &at, angle, &at).0) / 1e-7;
                assert!((by - gradient[i]).abs() < 2e-4, "{i} at {angle}: {by}, {}", gradient[i]);
            }
        }
    }
}
