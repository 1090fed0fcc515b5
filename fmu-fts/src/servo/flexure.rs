//! The flexure between the encoder on the hub and the tool: nominal, or identified in a measured response.
//!
//! The encoder does not see the tool. But the hub answers the torque with
//!
//! ```text
//! G = N / D,   N = 1 - x^2 + 2 j z x,   D = 1 - (1 - m) x^2 + 2 j z x,   x = omega / omega_t
//! ```
//!
//! relative to the rigid arm (m: fraction of the inertia beyond the flexure), with a zero where the tool oscillates and
//! the hub rests: the natural frequency omega_t of the arm on the locked hub, which is what tool and hub differ by.
//! Neither the controller nor the inertia, drive gain or delay moves that zero. With the measured T the arm is
//! `T / ((1 - T) K)`, and G is that relative to the nominal rigid arm. The fit is of `k e^(-j omega d) N - G D`, without
//! poles, in the factor k, the delay d, omega_t, z and m.

use control_blocks::{Observation, least_squares};
use nalgebra::{Complex, SVector};
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;
use crate::servo::loop_model::LoopModel;
use crate::servo::nominal::Nominal;
use crate::servo::response::{FrequencyResponse, Point};

/// Up to this ratio to the natural frequency the flexure is compensated; above, as at this ratio.
const RATIO_MAX: f64 = 0.7;
/// From this ratio to the nominal frequency on the flexure is identified: dry friction dominates below.
const LOOK_FROM: f64 = 0.3;
/// Accepted standard deviation of the identified frequency, relative, and largest ratio to the nominal frequency.
const SIGMA_MAX: f64 = 0.01;
const FACTOR_MAX: f64 = 1.5;
/// Relative standard deviation of a point: friction on an oscillation with half of the torque.
const POINT_SIGMA: f64 = 2e-3;

/// Flexure of the arm on the locked hub.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Flexure {
    /// Natural frequency omega_t, rad/s; 0 for a rigid arm.
    pub frequency: f64,
    /// Damping ratio z.
    pub damping: f64,
    /// Standard deviation of the frequency, rad/s; 0 while it is nominal.
    pub sigma: f64,
}

impl Flexure {
    /// The nominal flexure.
    pub fn nominal(p: &Parameters) -> Self {
        Self { frequency: p.tip.frequency, damping: p.tip.damping, sigma: 0.0 }
    }

    /// Motion of the hub over motion of the tool at `omega` (rad/s).
    pub fn hub_over_tool(&self, omega: f64) -> Complex<f64> {
        if self.frequency == 0.0 {
            return Complex::ONE;
        }
        let ratio = (omega / self.frequency).clamp(-RATIO_MAX, RATIO_MAX);
        let spring = Complex::new(1.0, 2.0 * self.damping * ratio);
        (spring - ratio * ratio) / spring
    }

    /// The flexure that a measured response of the position loop `model` identifies; none if it is uncertain.
    pub fn found(p: &Parameters, model: &LoopModel, measured: &FrequencyResponse) -> Option<Self> {
        let nominal = Self::nominal(p);
        let shape = Shape::nominal(&p.into());
        let first = measured.points().partition_point(|point| point.frequency < LOOK_FROM * nominal.frequency);
        let points = &measured.points()[first..];
        if nominal.frequency == 0.0 || p.tip.inertia == 0.0 {
            return None;
        }
        let start = SVector::from([1.0, 0.0, 1.0, nominal.damping, p.tip.inertia]);
        let found = least_squares(start, 2 * points.len(), |i, value| {
            let measured = shape.measured(model, &points[i / 2]);
            let residual = |value: &Value| {
                let residual = shape.residual(points[i / 2].frequency, measured, value) / POINT_SIGMA;
                if i % 2 == 0 { residual.re } else { residual.im }
            };
            Observation { residual: residual(value), gradient: gradient(residual, value) }
        })
        .ok()?;
        let ([_, _, factor, damping, _], sigma) = (found.value.data.0[0], found.sigma(2));
        let plausible = factor * FACTOR_MAX > 1.0 && factor < FACTOR_MAX && sigma < SIGMA_MAX * factor;
        plausible.then(|| Self {
            frequency: factor * nominal.frequency,
            damping: damping.clamp(0.0, 0.5),
            sigma: sigma * nominal.frequency,
        })
    }
}

/// Factor k, delay d in samples, omega_t over the nominal one, z, m.
type Value = SVector<f64, 5>;

/// Response G = N / D of the hub to the torque, with frequencies relative to that of the nominal flexure.
pub struct Shape {
    nominal: Flexure,
    /// fraction of the inertia beyond the flexure, nominal
    inertia: f64,
    period: f64,
}

impl Shape {
    /// The nominal flexure.
    pub fn nominal(nominal: &Nominal) -> Self {
        let Nominal { tip, sample_period, .. } = nominal;
        let nominal = Flexure { frequency: tip.frequency, damping: tip.damping, sigma: 0.0 };
        Self { nominal, inertia: tip.inertia, period: *sample_period }
    }

    /// N and D at `omega` (rad/s), with the frequency relative to the nominal one.
    pub fn zero_and_pole(&self, omega: f64, [frequency, damping, inertia]: [f64; 3]) -> [Complex<f64>; 2] {
        if self.nominal.frequency == 0.0 {
            return [Complex::ONE; 2];
        }
        let x = omega / (frequency * self.nominal.frequency);
        let spring = Complex::new(1.0, 2.0 * damping * x);
        [spring - x * x, spring - (1.0 - inertia) * x * x]
    }

    /// The rigid arm over the nominal one, N / D.
    pub fn rigid(&self, omega: f64) -> Complex<f64> {
        let [zero, pole] = self.zero_and_pole(omega, [1.0, self.nominal.damping, self.inertia]);
        zero / pole
    }

    /// Measured G: the nominal one times the measured L over that of the nominal loop.
    pub fn measured(&self, model: &LoopModel, point: &Point) -> Complex<f64> {
        let [zero, pole] = self.zero_and_pole(point.frequency, [1.0, self.nominal.damping, self.inertia]);
        let t = point.value();
        t / (1.0 - t) / model.open(point.frequency) * zero / pole
    }

    fn residual(&self, omega: f64, measured: Complex<f64>, value: &Value) -> Complex<f64> {
        let [factor, delay, frequency, damping, inertia] = value.data.0[0];
        let [zero, pole] = self.zero_and_pole(omega, [frequency, damping, inertia]);
        Complex::from_polar(factor, -omega * self.period * delay) * zero - measured * pole
    }
}

/// By central differences; all parameters are of the order of 1.
pub fn gradient<const N: usize>(
    function: impl Fn(&SVector<f64, N>) -> f64,
    value: &SVector<f64, N>,
) -> SVector<f64, N> {
    const STEP: f64 = 1e-5;
    SVector::from_fn(|i, _| {
        let moved = |step: f64| {
            let mut value = *value;
            value[i] += step;
            function(&value)
        };
        (moved(STEP) - moved(-STEP)) / (2.0 * STEP)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo::design::design;
    use std::f64::consts::TAU;

    const GRID: [f64; 12] = [300.0, 360.0, 420.0, 500.0, 600.0, 800.0, 900.0, 1000.0, 1100.0, 1200.0, 1350.0, 1500.0];

    /// The response of an arm after `change` at these frequencies (Hz), measured by a controller with the nominal one.
    fn found(grid: &[f64], change: impl FnOnce(&mut Parameters)) -> Option<Flexure> {
        let compensator = design(&Parameters::START).unwrap();
        let mut real = Parameters::START;
        change(&mut real);
        let (model, nominal) = (LoopModel::new(&real, compensator), LoopModel::new(&Parameters::START, compensator));
        let grid: Vec<f64> = grid.iter().map(|hertz| TAU * hertz).collect();
        Flexure::found(&Parameters::START, &nominal, &FrequencyResponse::from_model(&grid, |omega| model.closed(omega)))
    }

    #[test]
    fn it_is_found_whatever_drive_inertia_and_delay_are() {
        for (inertia, ratio, frequency, damping, delay, current) in [
            (8e-4, 0.4375, 1200.0, 0.02, 1, 2000.0),
            (1e-3, 0.4375, 1080.0, 0.01, 1, 2000.0),
            (6.6e-4, 0.4375, 1320.0, 0.03, 1, 2000.0),
            (8e-4, 0.35, 1100.0, 0.01, 2, 2000.0),
            (8e-4, 0.5, 1300.0, 0.015, 0, 1500.0),
        ] {
            let flexure = found(&GRID, |p| {
                (p.servo.inertia, p.tip.inertia, p.io_delay) = (inertia, ratio, delay);
                (p.tip.frequency, p.tip.damping) = (TAU * frequency, damping);
                p.servo.current_bandwidth = TAU * current;
            })
            .unwrap();
            let error = flexure.frequency / (TAU * frequency) - 1.0;
            println!(
                "{:.2} Hz of {frequency}, {:.4} of {damping}, sigma {:.2} Hz",
                flexure.frequency / TAU,
                flexure.damping,
                flexure.sigma / TAU
            );
            // 0.2 um of 36 um rms at 500 Hz are 1.3 %
            assert!(error.abs() < 5e-3 && (flexure.damping - damping).abs() < 3e-3, "{flexure:?}");
        }
    }

    #[test]
    fn far_below_the_zero_nothing_is_taken() {
        let p = Parameters::START;
        let model = LoopModel::new(&p, design(&p).unwrap());
        let grid: Vec<f64> = [50.0, 100.0, 200.0, 300.0].iter().chain(&GRID).map(|hertz| TAU * hertz).collect();
        let nominal = |low: f64| {
            let seen = |omega: f64| model.closed(omega) * if omega < LOOK_FROM * p.tip.frequency { low } else { 1.0 };
            Flexure::found(&p, &model, &FrequencyResponse::from_model(&grid, seen)).unwrap()
        };
        assert_eq!(nominal(0.5), nominal(1.0));
    }

    #[test]
    fn a_response_that_does_not_determine_it_identifies_nothing() {
        // far below the zero, too few points, a rigid nominal arm, and one that is twice as stiff
        assert_eq!(found(&[300.0, 350.0, 400.0], |_| ()), None);
        assert_eq!(found(&[10.0, 100.0], |_| ()), None);
        assert_eq!(found(&GRID, |p| p.tip.frequency = TAU * 2400.0), None);
        let rigid =
            Parameters { tip: crate::interface::Tip { frequency: 0.0, ..Parameters::START.tip }, ..Parameters::START };
        let model = LoopModel::new(&rigid, design(&rigid).unwrap());
        assert_eq!(
            Flexure::found(&rigid, &model, &FrequencyResponse::from_model(&[4e3; 1], |w| model.closed(w))),
            None
        );
    }

    #[test]
    fn the_hub_moves_less_by_the_square_of_the_frequency() {
        let flexure = Flexure { frequency: 8e3, damping: 0.0, sigma: 0.0 };
        assert_eq!(flexure.hub_over_tool(0.0), Complex::ONE);
        let ratio = flexure.hub_over_tool(2e3);
        assert!((ratio - (1.0 - 0.0625)).norm() < 1e-15);
        assert_eq!(flexure.hub_over_tool(1e9), flexure.hub_over_tool(0.7 * 8e3));
    }

    #[test]
    fn hub_and_tool_are_a_spring_and_a_damper() {
        let mut p = Parameters::START;
        p.tip.damping = 0.1;
        for ratio in [0.1, 0.3, 0.69, -0.5] {
            // the tool is pulled by spring and damper alone: s^2 y = (w^2 + 2 d w s) (x - y)
            let (s, w) = (Complex::new(0.0, ratio * p.tip.frequency), p.tip.frequency);
            let (hub, tool) = (Flexure::nominal(&p).hub_over_tool(ratio * w), Complex::new(1.0, 0.0));
            let pull = (s * 2.0 * p.tip.damping * w + w * w) * (hub - tool);
            assert!((pull / (s * s * tool) - 1.0).norm() < 1e-9, "{ratio}: {hub}");
        }
    }

    #[test]
    fn negative_frequencies_are_mirrored_and_a_rigid_arm_does_not_bend() {
        let nominal = Flexure::nominal(&Parameters::START);
        assert_eq!(nominal.hub_over_tool(-2000.0), nominal.hub_over_tool(2000.0).conj());
        let rigid = Flexure { frequency: 0.0, ..nominal };
        assert_eq!(rigid.hub_over_tool(3000.0), Complex::ONE);
    }
}
