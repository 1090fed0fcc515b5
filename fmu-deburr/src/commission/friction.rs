//! Displacement by which friction holds a drive back, from its strokes.
//!
//! The residual of the weights, summed, is the distance of the commanded from the actual position: h sgn x', in lags
//! 1/(g Kp T), with h = F/(m wn^2). Only samples in which the axis slides are used, in both directions. Small errors of
//! the weights leave parts of position, velocity and acceleration in it, an offset of the drive a slope in time, and
//! the first sum a constant. All are fitted together with h, so that h does not depend on them.

use nalgebra::{SMatrix, SVector};

use crate::learning::drive::TAPS;
use crate::learning::identification::{BareRun, Identification};

/// Ratio of the fastest rate from which on an axis slides.
const SLIDES: f64 = 0.3;
/// Unknowns: h, constant, slope, place, velocity, acceleration.
const UNKNOWNS: usize = 6;
/// Smallest variance of the noise of a measurement: that of a whole count.
const ROUNDING: f64 = 1.0 / 12.0;

/// The displacement and its standard deviation, counts; none where the strokes do not show it.
pub fn held_back<R: BareRun>(run: &Identification<R>) -> Option<[f64; 2]> {
    let (lag, count, fastest) = (run.bare_lag(), run.samples(), run.fastest());
    let (mut normal, mut target) = (SMatrix::<f64, UNKNOWNS, UNKNOWNS>::zeros(), SVector::<f64, UNKNOWNS>::zeros());
    let (mut squares, mut used) = (0.0, 0.0);
    let (mut beyond, mut positions) = (0.0, [0.0; TAPS]);
    for k in 0..count {
        let rates = run.modelled_rates(k);
        if rates[1].abs() > SLIDES * fastest {
            let [late, position, early] = positions.map(|position| position / fastest);
            let time = k as f64 / count as f64 - 0.5;
            let shape =
                [rates[1].signum(), 1.0, time, position / count as f64, early - late, early - 2.0 * position + late];
            let shape = SVector::from(shape);
            normal += shape * shape.transpose();
            target += shape * beyond;
            squares += beyond * beyond;
            used += 1.0;
        }
        beyond += run.left(k) / lag;
        (0..TAPS).for_each(|tap| positions[tap] += rates[tap]);
    }
    let inverse = normal.cholesky()?.inverse();
    let found = inverse * target;
    let left = (squares - found.dot(&target)) / (used - UNKNOWNS as f64).max(1.0);
    let estimate = [found[0], (left.max(ROUNDING) * run.shared() * inverse[(0, 0)]).sqrt()];
    estimate.iter().all(|value| value.is_finite()).then_some(estimate)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commission::strokes::Strokes;
    use crate::interface::Parameters;
    use crate::learning::drive::NominalDrive;

    /// Of strokes of 100 samples with these ends, counts, and an error of `error` times their rate.
    fn travel(ends: &[f64], error: f64) -> Option<[f64; 2]> {
        let nominal = NominalDrive::new(&Parameters::START, 2);
        let mut strokes = Strokes::new(1000);
        for pair in ends.windows(2) {
            for k in 0..100 {
                let fraction = f64::from(k) / 100.0;
                let rate = (pair[1] - pair[0]) * fraction * (1.0 - fraction) * 0.06;
                let position = pair[0] + (pair[1] - pair[0]) * fraction * fraction * (3.0 - 2.0 * fraction);
                strokes.take(position, error * rate);
            }
        }
        let mut room = [0.0; 1000];
        held_back(&Identification::new(&nominal, &strokes, &mut room))
    }

    #[test]
    fn strokes_back_and_forth_show_the_travel_and_none_at_rest_or_without_a_number_do() {
        let [_, deviation] = travel(&[0.0, 1e4, 0.0, 1e4, 0.0], 2.0).unwrap();
        assert!(deviation > 0.0 && deviation.is_finite(), "{deviation}");
        assert_eq!(travel(&[], 2.0), None);
        assert_eq!(travel(&[0.0, 0.0, 0.0], 2.0), None);
        assert_eq!(travel(&[0.0, 1e4, 0.0, 1e4, 0.0], f64::NAN), None);
        assert_eq!(travel(&[0.0, 1e4, 0.0, 1e4, 0.0], 1e200), None);
    }
}
