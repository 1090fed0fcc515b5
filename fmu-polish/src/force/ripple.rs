//! Cancels the force ripple at the frequency of the stick-slip motion and at twice that; the drive model gives the phases.
//!
//! On a tilted mold the sweep climbs by the slope of the surface against the path, s in the plane of the mold: a linear
//! sweep along b by s . b, once up and once down during a revolution of the path. With the phase phi of the sweep and
//! the angle theta of the path this ripple is Re sum c_n e^(j (phi + n theta)), n = +-1. Its amplitudes are constant at
//! any rate of revolution; at a fixed phase they would have to be learned again in every quarter of a revolution. All
//! three terms are learned together. With the complex amplitude e of the error at phi, they correct e / x,
//! x = gain / s + g |w| (1 / (s - j w) + 1 / (s + j w)), w = dtheta/dt, g = `expert.repetitive.ripple_gain`, a lossless
//! sum. So the loop is stable for phase errors of the response below a quarter of a revolution, as without these terms.

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use super::harmonic::{FREQUENCY_RATIO, Harmonic};
use super::impedance::Coefficients;
use super::repetitive::ERROR_RATIO;
use super::response::closed;
use super::turning::{Rotation, WholeRevolution};
use crate::interface::{Mode, Parameters};
use crate::motion::stick_slip::{fastest, phase, velocity};

/// Warning when a part of the cancellation has stopped.
pub const STOPPED: &str = "a part of the ripple cancellation increased the ripple and was stopped\n\
                           hint: Compare `drive.*` and `io_delay` with the machine, or set `expert.ripple.gain`, \
                           `expert.repetitive.ripple_gain` or `expert.repetitive.gain` = 0.";

/// Harmonics of the stick-slip frequency.
const HARMONICS: usize = 2;
/// Largest velocity of each harmonic, over that of the sweep over K_v, m/s: a tip that bends instead of sliding on a
/// slope of 14 degrees makes a ripple of a quarter of the sweep, and K_v = 20 mm/s is the most of it.
const VELOCITY_MAX: f64 = 5e-3;
/// Fastest turn of the path with which a ripple is learned, over its frequency: the response is that at the frequency
/// itself.
const ROTATION_RATIO: f64 = 0.25;
/// Periods over which the amplitude of a ripple is taken.
const WINDOW_PERIODS: u32 = 10;

/// The cancellation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RippleCancellation {
    /// velocity to force error at each frequency, N s/m; none if it is too high
    responses: [Option<Complex<f64>>; HARMONICS],
    /// velocities, m/s
    harmonics: [Harmonic; HARMONICS],
    /// the same of what turns with the path and against it
    turning: [[Harmonic; 2]; HARMONICS],
    half: u32,
    samples: u32,
    rotation: WholeRevolution,
    frozen: bool,
}

impl RippleCancellation {
    /// Nothing learned, for the force control `law` on a contact of `stiffness` N/m.
    pub fn new(p: &Parameters, law: &Coefficients, stiffness: f64) -> Self {
        let half = p.stick_slip.half_period.unsigned_abs().max(1);
        let rate = std::f64::consts::TAU / p.sample_period;
        let responses = std::array::from_fn(|i| {
            let omega = rate * (i as f64 + 1.0) / f64::from(2 * half);
            (omega <= FREQUENCY_RATIO * rate).then(|| closed(p, law, stiffness, omega))
        });
        Self {
            responses,
            harmonics: Default::default(),
            turning: Default::default(),
            half,
            samples: 0,
            rotation: WholeRevolution::default(),
            frozen: false,
        }
    }

    /// Whether a ripple has grown and its cancellation was stopped.
    pub fn stopped(&self) -> bool {
        self.frozen
    }

    /// Velocity (m/s) of sample `k`, in which the sweep has K_v = `sweep` (m/s) and the path turns by `rotation`, for
    /// the force error `error` (N).
    pub fn step(&mut self, p: &Parameters, k: u32, sweep: f64, rotation: Rotation, error: f64) -> f64 {
        let mut velocity = 0.0;
        let sweeps = p.repetitive.ripple_gain > 0.0 && p.stick_slip.mode != Mode::Off;
        let rotates = sweeps && rotation.step != 0.0 && rotation.step.abs() < ROTATION_RATIO * phase(self.half, 1);
        let (maximum, learned) = (ERROR_RATIO * p.force.target, p.repetitive.ripple_gain * rotation.step.abs());
        for ((m, harmonic), response) in (1..).zip(&mut self.harmonics).zip(self.responses) {
            let Some(response) = response else { continue };
            let carrier = Complex::cis(phase(self.half, m * (k % (2 * self.half))));
            if p.ripple_gain > 0.0 {
                harmonic.observe(carrier, error);
                harmonic.learn(2.0 * p.ripple_gain * p.sample_period, response, carrier, error, fastest_ripple(p));
                velocity += harmonic.output(carrier);
            }
            let sides = &mut self.turning[m as usize - 1];
            for (side, angle) in sides.iter_mut().zip([rotation.angle, -rotation.angle]).filter(|_| rotates) {
                let carrier = carrier * Complex::cis(angle);
                side.observe(carrier, error);
                side.learn(2.0 * learned, response, carrier, error.clamp(-maximum, maximum), climb(p));
                velocity += side.output(carrier);
            }
        }
        if p.ripple_gain > 0.0 {
            self.evaluate(p, raised(p, sweep));
        }
        if rotates {
            self.evaluate_revolution(p, raised(p, sweep), rotation.step);
        }
        velocity
    }

    /// Evaluates the terms that rotate with the path, after each revolution.
    fn evaluate_revolution(&mut self, p: &Parameters, raised: f64, step: f64) {
        let Some(samples) = self.rotation.ends(step) else { return };
        for side in self.turning.iter_mut().flatten() {
            self.frozen |= side.evaluate(samples, raised, climb(p));
        }
    }

    /// Freezes what makes the ripple worse: a phase of the model is more than a quarter wrong.
    fn evaluate(&mut self, p: &Parameters, raised: f64) {
        self.samples += 1;
        let window = WINDOW_PERIODS * 2 * self.half;
        if self.samples < window {
            return;
        }
        self.samples = 0;
        for harmonic in &mut self.harmonics {
            self.frozen |= harmonic.evaluate(window, raised, fastest_ripple(p));
        }
    }
}

/// How many times as fast as configured a circle is, and with it the ripple of a tilted mold. A linear sweep has no
/// such allowance: its force error detects a wrong mold before the depth monitor reports a frozen sensor.
fn raised(p: &Parameters, sweep: f64) -> f64 {
    match p.stick_slip.mode {
        Mode::Circular => (sweep / velocity(&p.stick_slip, p.feed.velocity)).max(1.0),
        _ => 1.0,
    }
}

/// Largest velocity (m/s) that cancels a harmonic.
fn fastest_ripple(p: &Parameters) -> f64 {
    VELOCITY_MAX * fastest(&p.stick_slip)
}

/// Largest velocity (m/s) at which a sweep climbs on a mold with the maximum tilt.
fn climb(p: &Parameters) -> f64 {
    let sweep = fastest(&p.stick_slip) * velocity(&p.stick_slip, p.feed.velocity);
    fastest_ripple(p).min(p.limits.surface_slope * sweep)
}

#[cfg(test)]
mod tests {
    use std::ops::Range;

    use super::super::impedance::damping;
    use super::*;
    use crate::interface::{Repetitive, StickSlip};
    use crate::motion::stick_slip::tests::circular;

    const P: Parameters = Parameters::START;
    /// Configured K_v, m/s.
    const KV: f64 = 10e-3;
    const STRAIGHT: Rotation = Rotation { angle: 0.3, step: 0.0 };

    /// Force error (N) at the angle `angle` (rad) that remains of a ripple with the amplitude `size` (N), if the output
    /// of `harmonic` acts through the actual response `response`.
    fn part(harmonic: &Harmonic, response: Complex<f64>, size: f64, angle: f64) -> f64 {
        let carrier = Complex::cis(angle);
        harmonic.output(response * carrier) + size * carrier.re
    }

    /// Largest error in the samples `counted`, the last ones of a run with ripples of `size` N when the true phase is
    /// `phase_error` rad off; and whether the cancellation has ended itself.
    fn worst_error(phase_error: f64, size: f64, counted: Range<u32>) -> (f64, bool) {
        let law = Coefficients::new(&P, damping(&P, 178e3));
        let mut ripple = RippleCancellation::new(&P, &law, 178e3);
        let actual = ripple.responses.map(|response| response.unwrap() * Complex::cis(phase_error));
        let mut worst: f64 = 0.0;
        for k in 1..counted.end {
            // the plant in the steady state of the learned amplitudes
            let error: f64 =
                (1..).zip(ripple.harmonics).zip(actual).map(|((m, h), t)| part(&h, t, size, phase(10, m * k))).sum();
            ripple.step(&P, k, KV, STRAIGHT, error);
            if counted.contains(&k) {
                worst = worst.max(error.abs());
            }
        }
        (worst, ripple.stopped())
    }

    #[test]
    fn a_ripple_vanishes_if_the_phase_is_about_right() {
        for phase_error in [0.0, 0.7, -0.7] {
            let (worst, frozen) = worst_error(phase_error, 0.2, 3501..4000);
            assert!(worst < 0.02 && !frozen, "{phase_error}: {worst}");
        }
    }

    #[test]
    fn a_wrong_phase_ends_the_cancellation() {
        for phase_error in [2.5, -2.5] {
            let (worst, frozen) = worst_error(phase_error, 0.1, 1..6000);
            assert!(frozen && worst < 2.5, "{phase_error}: {worst}");
        }
    }

    #[test]
    fn the_first_amplitude_is_that_of_the_ripple() {
        let mut p = P;
        p.ripple_gain = 1e-9;
        let mut ripple = RippleCancellation::new(&p, &Coefficients::new(&p, damping(&p, 178e3)), 178e3);
        for k in 1..=200 {
            ripple.step(&p, k, KV, STRAIGHT, 0.1 + 0.3 * phase(10, k).cos() + 0.2 * phase(10, 2 * k).sin());
        }
        let [one, two] = ripple.harmonics.map(|harmonic| harmonic.first().unwrap());
        assert!((one - 0.3).abs() < 1e-9 && (two - 0.2).abs() < 1e-9, "{one} {two}");
    }

    #[test]
    fn too_high_a_frequency_is_left_alone() {
        let mut p = P;
        p.stick_slip.half_period = 1;
        let mut ripple = RippleCancellation::new(&p, &Coefficients::new(&p, 1e4), 178e3);
        assert!((1..1000).all(|k| ripple.step(&p, k, KV, STRAIGHT, if k % 2 == 0 { 1.0 } else { -1.0 }) == 0.0));
    }

    /// Whether a ripple of `size` N that no output changes ends the cancellation, where it was `first` N and K_v has
    /// been raised to `sweep`.
    fn given_up(p: &Parameters, sweep: f64, first: f64, size: f64) -> bool {
        let mut ripple = RippleCancellation::new(p, &Coefficients::new(p, damping(p, 178e3)), 178e3);
        for k in 1..=1200 {
            let (sweep, size) = if k <= 200 { (KV, first) } else { (sweep, size) };
            ripple.step(p, k, sweep, STRAIGHT, size * phase(10, k).cos());
        }
        ripple.stopped()
    }

    #[test]
    fn a_circle_that_is_raised_may_make_as_much_more_of_a_ripple_and_a_line_may_not() {
        let mut p = circular();
        p.ripple_gain = 1e-9;
        // 1.5 times 0.2 N and 0.3 N are the most at first
        for (sweep, maximum) in [(KV, 0.6), (1.6 * KV, 0.96), (0.5 * KV, 0.6)] {
            assert_eq!([0.99, 1.01].map(|factor| given_up(&p, sweep, 0.2, factor * maximum)), [false, true], "{sweep}");
        }
        let line = Parameters { stick_slip: P.stick_slip, ..p.clone() };
        assert_eq!([0.59, 0.61].map(|size| given_up(&line, 1.6 * KV, 0.2, size)), [false, true]);
        // with a ratio K_v goes with the feed and is not raised
        p.stick_slip.ratio = KV / p.feed.velocity;
        assert!(given_up(&p, KV, 0.2, 0.61) && !given_up(&p, KV, 0.2, 0.59));
    }

    #[test]
    fn the_ripple_of_a_circle_is_cancelled_as_fast_as_it_moves() {
        for (mode, maximum) in [(Mode::Cross, 5e-3), (Mode::Circular, 5e-3 * std::f64::consts::FRAC_PI_2)] {
            let p = Parameters { stick_slip: StickSlip { mode, ..P.stick_slip }, ..P };
            let mut ripple = RippleCancellation::new(&p, &Coefficients::new(&p, damping(&p, 178e3)), 178e3);
            // more than can be taken back
            let mut step = |k: u32| ripple.step(&p, k, KV, STRAIGHT, phase(10, k).cos());
            (1..4000).for_each(|k| _ = step(k));
            let amplitude = ((4000..4020).map(|k| step(k).powi(2)).sum::<f64>() / 10.0).sqrt();
            assert!((amplitude / maximum - 1.0).abs() < 0.03, "{mode:?}: {amplitude}");
        }
    }

    fn turning() -> Parameters {
        Parameters { repetitive: Repetitive { ripple_gain: 0.09, ..P.repetitive }, ..P }
    }

    /// Largest error (N) in each of `revolutions` turns of a path that turns with `rate` rad/s, where a slope makes a
    /// ripple of 0.3 N that turns with it, its true phase `late` rad off; and whether the cancellation has ended
    /// itself.
    fn tilted(p: &Parameters, rate: f64, late: f64, revolutions: u32) -> (Vec<f64>, bool) {
        let mut ripple = RippleCancellation::new(p, &Coefficients::new(p, damping(p, 178e3)), 178e3);
        let actual = ripple.responses.map(|response| response.unwrap() * Complex::cis(late));
        let (step, mut found) = (rate * p.sample_period, Vec::new());
        let samples = (std::f64::consts::TAU / step.abs()).round() as u32;
        for revolution in 0..revolutions {
            let mut worst: f64 = 0.0;
            for k in revolution * samples + 1..=(revolution + 1) * samples {
                let theta = step * f64::from(k);
                let error: f64 = (1..)
                    .zip(ripple.harmonics)
                    .zip(ripple.turning)
                    .zip(actual)
                    .map(|(((m, h), sides), t)| {
                        let carrier = t * Complex::cis(phase(10, m * k));
                        let [with, against] = [theta, -theta].map(|angle| carrier * Complex::cis(angle));
                        h.output(carrier) + sides[0].output(with) + sides[1].output(against)
                    })
                    .sum::<f64>()
                    + 0.3 * theta.cos() * phase(10, k).cos();
                ripple.step(p, k, KV, Rotation { angle: theta, step }, error);
                worst = worst.max(error.abs());
            }
            found.push(worst);
        }
        (found, ripple.stopped())
    }

    #[test]
    fn a_ripple_that_turns_with_the_path_vanishes_whichever_way_and_however_fast() {
        // a path that turns slower than `ripple.gain` is followed at a fixed phase as well, which leaves less to learn from
        for (rate, factor) in [(25.0, 0.1), (-25.0, 0.1), (6.0, 0.1), (1.5, 0.35)] {
            for late in [0.0, 0.8, -0.8] {
                let (found, frozen) = tilted(&turning(), rate, late, 12);
                assert!(found[11] < factor * found[0] && !frozen, "{rate} {late}: {found:?}");
            }
        }
        // alone as well
        let mut alone = turning();
        alone.ripple_gain = 0.0;
        let (found, frozen) = tilted(&alone, 25.0, 0.0, 12);
        assert!(found[11] < 0.1 * found[0] && !frozen, "{found:?}");
        // without what is learned from turn to turn it stays
        let (found, _) = tilted(&P, 25.0, 0.0, 12);
        assert!(found[11] > 0.25, "{found:?}");
    }

    #[test]
    fn a_turning_ripple_that_grows_ends_itself_and_a_turn_too_fast_is_left_alone() {
        let p = turning();
        let (found, frozen) = tilted(&p, 25.0, 2.6, 12);
        // a revolution multiplies each of two terms by e^(2 pi 0.09 cos 2.6) = 1.6, and the fourth exceeds the limit
        assert!(frozen && found.iter().all(|error| *error < 0.3 * 1.63f64.powi(4)), "{found:?}");
        // a quarter of 50 Hz
        for (factor, learns) in [(0.99, true), (1.01, false)] {
            let mut ripple = RippleCancellation::new(&p, &Coefficients::new(&p, damping(&p, 178e3)), 178e3);
            let step = factor * 0.25 * phase(10, 1);
            for k in 1..100 {
                ripple.step(&p, k, KV, Rotation { angle: step * f64::from(k), step }, 0.3);
            }
            assert_eq!(ripple.turning.iter().flatten().any(|side| *side != Harmonic::default()), learns, "{factor}");
        }
    }
}
