//! Design of the position loop: the crossover for the desired bandwidth, and the resulting margins.

use control_blocks::{ParameterError, require};
use nalgebra::Complex;

use crate::interface::Parameters;
use crate::servo::lead_lag::LeadLag;
use crate::servo::loop_model::{ArmPoint, LoopModel};
use crate::servo::nominal::Nominal;

/// Smallest phase margin, rad: 30 degrees.
const PHASE_MARGIN_MIN: f64 = 0.524;
/// Smallest gain margin.
const GAIN_MARGIN_MIN: f64 = 2.0;
/// Frequencies looked at, per octave.
const PER_OCTAVE: i32 = 96;
/// Frequencies looked at about the resonance of the arm, in its half widths: a peak is narrower than the grid.
const ABOUT_PEAK: [f64; 9] = [-30.0, -8.0, -2.5, -0.8, 0.0, 0.8, 2.5, 8.0, 30.0];
/// Smallest damping ratio for which that is done.
const DAMPING_MIN: f64 = 1e-6;
/// Frequencies looked at: 16 octaves at the shortest sample period, and those about the resonance.
const POINTS_MAX: usize = 16 * PER_OCTAVE as usize + 1 + ABOUT_PEAK.len();

/// How far a loop is from instability.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopMargins {
    /// Phase margin at the last crossover, rad.
    pub phase: f64,
    /// Factor on the gain that makes the loop unstable.
    pub gain: f64,
    /// Largest magnitude of 1 / (1 + L).
    pub sensitivity: f64,
}

impl LoopMargins {
    /// Whether the loop may be closed.
    pub fn enough(&self) -> bool {
        self.phase >= PHASE_MARGIN_MIN && self.gain >= GAIN_MARGIN_MIN
    }

    /// Those of a loop of this machine whose delay is longer than it knows by `late` samples.
    pub fn of(nominal: &Nominal, model: &LoopModel, late: f64) -> Self {
        let mut grid = Grid::new(nominal, model);
        grid.points.iter_mut().for_each(|point| *point = point.later(late * nominal.sample_period));
        margins(model, grid.points())
    }
}

/// The compensator that gives `servo.bandwidth`, and the margins that it leaves.
pub fn shape(nominal: &Nominal) -> (LeadLag, LoopMargins) {
    let target = nominal.servo.bandwidth;
    // more crossover, more bandwidth
    let (mut low, mut high) = (0.1 * target, 1.5 * target);
    let model = LoopModel::new(*nominal, LeadLag::new(*nominal, low));
    let grid = Grid::new(nominal, &model);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let tried = model.with(LeadLag::new(*nominal, middle));
        if bandwidth(&tried, grid.points()) < target { low = middle } else { high = middle }
    }
    let compensator = LeadLag::new(*nominal, low);
    (compensator, margins(&model.with(compensator), grid.points()))
}

/// The compensator that gives `servo.bandwidth`.
///
/// # Errors
/// When the loop would be without sufficient margins.
pub fn design(p: &Parameters) -> Result<LeadLag, ParameterError> {
    let target = p.servo.bandwidth;
    let (compensator, margins) = shape(&p.into());
    require(margins.enough(), || ParameterError {
        name: "servo.bandwidth",
        value: format!("{target} rad/s"),
        limit: format!(
            "less: it leaves a phase margin of `{:.3} rad` (at least `{PHASE_MARGIN_MIN}`) and a gain margin of \
             `{:.2}` (at least `{GAIN_MARGIN_MIN}`)",
            margins.phase, margins.gain
        ),
        hint: "reduce `servo.bandwidth`, increase `expert.servo.lead`, or reduce the delay (`io_delay`, `arm_delay`, `servo.current_bandwidth`)",
    })?;
    Ok(compensator)
}

/// The frequency (rad/s) at which the closed loop has fallen to -3 dB for good below; half the sampling rate if never.
fn bandwidth(model: &LoopModel, grid: &[ArmPoint]) -> f64 {
    let passes = |point: &ArmPoint| point.closed(model.compensator()).norm_sqr() >= 0.5;
    let Some(piece) = grid.windows(2).find(|piece| !passes(&piece[1])) else {
        return model.nyquist();
    };
    let (mut low, mut high) = (piece[0].omega, piece[1].omega);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if passes(&model.at(middle)) { low = middle } else { high = middle }
    }
    low
}

/// Margins of a loop.
fn margins(model: &LoopModel, grid: &[ArmPoint]) -> LoopMargins {
    let mut margins = LoopMargins { phase: std::f64::consts::PI, gain: f64::INFINITY, sensitivity: 0.0 };
    let mut crossed = false;
    for piece in grid.windows(2) {
        let (here, there) = (piece[0].open(model.compensator()), piece[1].open(model.compensator()));
        let return_difference = here + 1.0;
        margins.sensitivity = margins.sensitivity.max(1.0 / return_difference.norm());
        if here.norm() >= 1.0 && there.norm() < 1.0 {
            margins.phase = margins.phase.min(lag_left(here, there));
            crossed = true;
        }
        // through the negative real axis: inside the unit circle, or outside of it in a peak beyond the crossover
        if here.im * there.im < 0.0 && here.re < 0.0 && (crossed || here.re > -1.0) {
            margins.gain = margins.gain.min(2.0 / (here.norm() + there.norm()));
        }
    }
    margins
}

/// Phase above -pi where the magnitude passes 1 between two points.
fn lag_left(here: Complex<f64>, there: Complex<f64>) -> f64 {
    let fraction = here.norm().ln() / (here.norm() / there.norm()).ln();
    let rotation = (there / here).arg();
    (-here).arg() + fraction * rotation
}

/// The arm at frequencies from 1 Hz (or below) to half the sampling rate, and about its resonance; it is the same for
/// every compensator.
struct Grid {
    points: [ArmPoint; POINTS_MAX],
    count: usize,
}

impl Grid {
    fn new(nominal: &Nominal, model: &LoopModel) -> Self {
        let (nyquist, tip) = (model.nyquist(), &nominal.tip);
        let ratio = 2f64.powf(-1.0 / f64::from(PER_OCTAVE));
        let octaves = (nyquist / 3.0).log2().ceil() as i32;
        let stiffening = (1.0 - tip.inertia).sqrt().recip();
        let (peak, damping) = (tip.frequency * stiffening, (tip.damping * stiffening).max(DAMPING_MIN));
        let about = ABOUT_PEAK.iter().map(|width| peak * (1.0 + width * damping));
        let even = (0..=octaves * PER_OCTAVE).map(|k| nyquist * ratio.powi(k));
        let lowest = nyquist * ratio.powi(octaves * PER_OCTAVE);
        let frequencies = even.chain(about.filter(|omega| *omega > lowest && *omega < nyquist));
        let mut grid = Self { points: [ArmPoint::REST; POINTS_MAX], count: 0 };
        for (point, omega) in grid.points.iter_mut().zip(frequencies) {
            *point = model.at(omega);
            grid.count += 1;
        }
        grid.points[..grid.count].sort_unstable_by(|a, b| a.omega.total_cmp(&b.omega));
        grid
    }

    fn points(&self) -> &[ArmPoint] {
        &self.points[..self.count]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn designed(p: &Parameters) -> (LoopModel, LoopMargins) {
        let model = LoopModel::new(p, design(p).unwrap());
        (model, LoopMargins::of(&Nominal::from(p), &model, 0.0))
    }

    #[test]
    fn a_loop_may_be_closed_with_both_margins_and_with_one_of_them_it_may_not() {
        let enough = |phase: f64, gain: f64| LoopMargins { phase, gain, sensitivity: 1.0 }.enough();
        let (phase, gain) = (PHASE_MARGIN_MIN, GAIN_MARGIN_MIN);
        assert!(enough(phase, gain) && !enough(0.999 * phase, 9.0) && !enough(1.5, 0.999 * gain));
    }

    #[test]
    fn the_default_loop_has_the_bandwidth_and_margins_of_the_paper() {
        let (model, margins) = designed(&Parameters::START);
        assert!(
            (bandwidth(&model, Grid::new(&(&Parameters::START).into(), &model).points()) / TAU - 230.0).abs() < 1e-6
        );
        assert!((margins.phase.to_degrees() - 43.7).abs() < 0.5, "{margins:?}");
        assert!((margins.gain - 5.0).abs() < 0.1, "{margins:?}");
        assert!((margins.sensitivity - 1.59).abs() < 0.01, "{margins:?}");
        let (at_500, sensitivity_20) = (model.closed(TAU * 500.0), 1.0 / (model.open(TAU * 20.0) + 1.0).norm());
        assert!((at_500.norm() - 0.165).abs() < 1e-3 && (at_500.arg().to_degrees() - 164.0).abs() < 0.5);
        assert!((sensitivity_20 - 0.088).abs() < 1e-3, "{sensitivity_20}");
    }

    #[test]
    fn the_grid_holds_the_resonance_and_both_its_sides_however_narrow_it_is() {
        for damping in [0.02, 1e-3, 1e-5] {
            let mut p = Parameters::START;
            p.tip.damping = damping;
            let model = LoopModel::new(&p, LeadLag::new(&p, 500.0));
            let points: Vec<f64> = Grid::new(&(&p).into(), &model).points().iter().map(|point| point.omega).collect();
            assert!(points.is_sorted() && points[0] <= TAU && *points.last().unwrap() == model.nyquist());
            assert!(points.windows(2).all(|pair| pair[1] / pair[0] < 2f64.powf(1.0001 / 96.0)));
            // two inertias: the free arm has a higher frequency than that on the locked hub, and more damping
            let peak = p.tip.frequency / (1.0 - p.tip.inertia).sqrt();
            let width = damping / (1.0 - p.tip.inertia).sqrt();
            for offset in [0.0, 0.8, 2.5, 8.0, 30.0] {
                for omega in [1.0 - offset * width, 1.0 + offset * width].map(|fraction| peak * fraction) {
                    let nearest = points.iter().map(|point| (point / omega - 1.0).abs()).fold(1.0, f64::min);
                    assert!(omega > model.nyquist() || nearest < 1e-9, "{damping} {offset}: {nearest}");
                }
            }
            // so that the highest of its points is the peak
            let height = |omega: f64| model.arm(omega).norm();
            let about = (-400..=400).map(|k| height(peak * (1.0 + 0.01 * width * f64::from(k)))).fold(0.0, f64::max);
            let seen =
                points.iter().filter(|omega| **omega > 0.8 * peak).map(|omega| height(*omega)).fold(0.0, f64::max);
            assert!(seen > 0.95 * about, "{damping}: {seen} {about}");
        }
    }

    #[test]
    fn a_loop_that_never_has_the_gain_1_still_has_a_gain_margin() {
        let p = Parameters::START;
        let at = |crossover: f64| {
            let model = LoopModel::new(&p, LeadLag::new(&p, crossover));
            LoopMargins::of(&Nominal::from(&p), &model, 0.0)
        };
        let slow = at(1.0);
        assert!(slow.phase == std::f64::consts::PI && slow.gain.is_finite() && slow.gain > 2.0, "{slow:?}");
    }

    #[test]
    fn the_phase_that_is_left_is_taken_where_the_gain_is_1() {
        // a loop of constant slope: the magnitude falls from 2 to 1/2, the phase from -120 to -140 degrees
        let (here, there) =
            (Complex::from_polar(2.0, -120f64.to_radians()), Complex::from_polar(0.5, -140f64.to_radians()));
        assert!((lag_left(here, there).to_degrees() - 50.0).abs() < 1e-9);
        let there = Complex::from_polar(0.25, -150f64.to_radians());
        assert!((lag_left(here, there).to_degrees() - 50.0).abs() < 1e-9);
    }

    #[test]
    fn every_desired_bandwidth_is_met_or_rejected() {
        for frequency in [20.0, 60.0, 150.0, 230.0, 300.0] {
            let mut p = Parameters::START;
            p.servo.bandwidth = TAU * frequency;
            let (model, margins) = designed(&p);
            assert!(
                (bandwidth(&model, Grid::new(&(&p).into(), &model).points()) / TAU - frequency).abs() < 1e-6,
                "{frequency} Hz"
            );
            assert!(margins.sensitivity < 2.0, "{frequency} Hz: {margins:?}");
        }
        let mut p = Parameters::START;
        p.servo.bandwidth = TAU * 490.0;
        let message = design(&p).unwrap_err().to_string();
        assert!(message.starts_with("parameter `servo.bandwidth` is `3078"), "{message}");
        assert!(message.contains("phase margin") && message.contains("hint:"), "{message}");
    }

    #[test]
    fn a_resonance_that_makes_the_loop_unstable_is_found_however_narrow_it_is() {
        for (damping, good) in [(0.02, true), (0.01, true), (2e-3, false), (1e-3, false), (5e-4, false), (0.0, false)] {
            let mut p = Parameters::START;
            p.tip.damping = damping;
            assert_eq!(design(&p).is_ok(), good, "{damping}: {:?}", design(&p).map(|_| ()));
        }
    }

    #[test]
    fn more_delay_leaves_less_margin() {
        let phases = [0, 1, 2].map(|delay| {
            let mut p = Parameters::START;
            p.io_delay = delay;
            designed(&p).1.phase.to_degrees()
        });
        assert!(phases[0] > phases[1] && phases[1] > phases[2] && phases[2] > 38.0, "{phases:?}");
        // a late measurement has the effect of a late command, and is rejected with the margins if too little remains
        let late = |arm_delay: i32| design(&Parameters { io_delay: 0, arm_delay, ..Parameters::START });
        let mut p = Parameters::START;
        (p.io_delay, p.arm_delay) = (0, 2);
        assert_eq!(designed(&p).1.phase.to_degrees(), phases[2]);
        let rejected = late(6).map(|_| ()).unwrap_err();
        assert!(rejected.limit.contains("a phase margin of `0."), "{rejected:?}");
    }
}
