//! Form of a cut lens: what the path of the next one is to be corrected by.
//!
//! A measurement equals the depth of the path plus zero + g E(x, theta) - c s. E is the error of the lens along the
//! path, g the fraction of it seen on the part, c the position of the spindle axis on the scale of the probe, and s the
//! slope of the section. E is a [`Correction`] with the sign reversed, without its constant, which cannot be separated
//! from the probe zero. A lens that was cut with a correction C needs C - E: that is what is fitted, so that a second
//! lens corrects the first.
//!
//! The uncertainty is that of the probe, or the scatter about the fit if it is larger. A coefficient c with the
//! standard deviation sigma is multiplied by 1 - (3 sigma / c)^2, and ignored below three sigma.

use control_blocks::{NoEstimate, Observation, least_squares};
use nalgebra::{Complex, SVector};
use serde::{Deserialize, Serialize};

use crate::path::correction::{Correction, HIGHEST_CORRECTED, POLYNOMIALS, legendre, scaled};
use crate::tracking::phasors::Phasors;

/// Standard deviations that a coefficient must exceed.
const DOUBT: f64 = 3.0;
/// Cosines and sines.
const WAVES: usize = 2 * HIGHEST_CORRECTED + 1;
/// Coefficients, of which the constant is the probe zero, and the position of the spindle axis.
const UNKNOWNS: usize = WAVES * POLYNOMIALS + 1;

/// Smallest number of samples for a fit.
pub const READINGS_MIN: usize = UNKNOWNS + 1;

/// Coefficients and the position of the spindle axis.
type FormUnknowns = SVector<f64, UNKNOWNS>;

/// One sample on a lens.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FormReading {
    /// Slide position at which it was cut, m.
    pub slide_position: f64,
    /// Spindle angle at which it was cut, rad.
    pub angle: f64,
    /// Depth that was read less that of the path, m.
    pub excess: f64,
    /// Fraction of a depth of the path that is seen on the part.
    pub gain: f64,
    /// Slope of the section to the lateral position of the probe.
    pub slope: f64,
}

/// Standard deviations of what is measured, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FormAccuracy {
    /// Of a depth.
    pub depth: f64,
    /// Of a lateral position.
    pub lateral: f64,
    /// Standard deviation of the spindle axis on the scale of the probe.
    pub axis: f64,
}

/// Result of the fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FormEstimate {
    /// Correction of the next path.
    pub correction: Correction,
    /// Standard deviation of its depth, root mean square over what was probed, m.
    pub std: f64,
    /// Form error of this lens: rms of the smooth part of the samples, without the mean, m.
    pub error: f64,
    /// Largest depth of the correction where it was probed, m.
    pub largest: f64,
    /// Rms of the residuals, m.
    pub residual: f64,
}

/// The correction that a lens asks for which was cut with the correction `cut_with`.
///
/// # Errors
/// Says why there is none.
pub fn fit(
    readings: &[FormReading],
    cut_with: Option<&Correction>,
    accuracy: &FormAccuracy,
) -> Result<FormEstimate, NoEstimate> {
    if readings.len() < READINGS_MIN {
        return Err(NoEstimate::TooFew);
    }
    let positions = readings.iter().map(|reading| reading.slide_position);
    let span = [positions.clone().fold(f64::INFINITY, f64::min), positions.fold(f64::NEG_INFINITY, f64::max)];
    if span[1] <= span[0] {
        return Err(NoEstimate::NotObservable);
    }
    let found = least_squares(FormUnknowns::zeros(), readings.len() + 1, |i, value| match readings.get(i) {
        Some(reading) => {
            let sigma = accuracy.depth.hypot(reading.slope * accuracy.lateral);
            let row = row(reading, &span);
            Observation { residual: (row.dot(value) - needed(reading, cut_with)) / sigma, gradient: row / sigma }
        }
        // what is known of the axis beforehand
        None => {
            let mut gradient = FormUnknowns::zeros();
            gradient[UNKNOWNS - 1] = 1.0 / accuracy.axis;
            Observation { residual: value[UNKNOWNS - 1] / accuracy.axis, gradient }
        }
    })?;
    let certain = FormUnknowns::from_fn(|i, _| found.value[i] * certainty(found.value[i], found.sigma(i)));
    let (whole, correction) = (correction(span, &found.value), correction(span, &certain));
    let mean = readings.iter().map(|reading| error(reading, cut_with, &whole)).sum::<f64>() / readings.len() as f64;
    let rms = |part: &dyn Fn(&FormReading) -> f64| {
        (readings.iter().map(|reading| part(reading).powi(2)).sum::<f64>() / readings.len() as f64).sqrt()
    };
    Ok(FormEstimate {
        std: (1..UNKNOWNS - 1).map(|i| found.sigma(i).powi(2) * power(i)).sum::<f64>().sqrt(),
        error: rms(&|reading| error(reading, cut_with, &whole) - mean),
        largest: readings.iter().map(|reading| depth(&correction, reading).abs()).fold(0.0, f64::max),
        residual: rms(&|reading| row(reading, &span).dot(&found.value) - needed(reading, cut_with)),
        correction,
    })
}

/// Share with which a value counts.
fn certainty(value: f64, sigma: f64) -> f64 {
    if value.abs() > DOUBT * sigma { 1.0 - (DOUBT * sigma / value).powi(2) } else { 0.0 }
}

/// Correction that a sample needs, with the probe zero, m.
fn needed(reading: &FormReading, cut_with: Option<&Correction>) -> f64 {
    reading.gain * cut_with.map_or(0.0, |correction| depth(correction, reading)) - reading.excess
}

/// Form error at a sample, m.
fn error(reading: &FormReading, cut_with: Option<&Correction>, needed: &Correction) -> f64 {
    cut_with.map_or(0.0, |correction| depth(correction, reading)) - depth(needed, reading)
}

/// Depth of a correction at a sample, m.
fn depth(correction: &Correction, reading: &FormReading) -> f64 {
    let phasors = Phasors::new(reading.angle, HIGHEST_CORRECTED);
    correction.depth(reading.slide_position, phasors.from_zero())
}

/// Derivatives of [`needed`] with respect to the unknowns: for each wave its polynomials, then the position of the axis.
fn row(reading: &FormReading, span: &[f64; 2]) -> FormUnknowns {
    let basis = legendre(scaled(span, reading.slide_position));
    let phasors = Phasors::new(reading.angle, HIGHEST_CORRECTED);
    FormUnknowns::from_fn(|i, _| match (i / POLYNOMIALS, i % POLYNOMIALS) {
        (0, 0) => 1.0,
        (WAVES, _) => reading.slope,
        (wave, k) => {
            let phasor = phasors.from_zero()[wave.div_ceil(2)];
            reading.gain * basis[k] * if wave % 2 == 0 { phasor.re } else { phasor.im }
        }
    })
}

/// Mean square of the function of unknown `i` over the lens.
fn power(i: usize) -> f64 {
    let (wave, k) = (i / POLYNOMIALS, i % POLYNOMIALS);
    let of_wave = if wave == 0 { 1.0 } else { 0.5 };
    of_wave / (2 * k + 1) as f64
}

/// The correction of some unknowns, without the zero of the probe.
fn correction(span: [f64; 2], value: &FormUnknowns) -> Correction {
    let mut coefficients = [[Complex::default(); POLYNOMIALS]; HIGHEST_CORRECTED + 1];
    for i in 1..UNKNOWNS - 1 {
        let (wave, k) = (i / POLYNOMIALS, i % POLYNOMIALS);
        let c: &mut Complex<f64> = &mut coefficients[wave.div_ceil(2)][k];
        // waves: 1, sin theta, cos theta, sin 2 theta, ...; c_n = a_n - j b_n
        if wave % 2 == 0 { c.re = value[i] } else { c.im = -value[i] }
    }
    Correction { span, coefficients }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use rand::SeedableRng;
    use rand_distr::{Distribution, Normal};
    use rand_pcg::Pcg64Mcg;

    use super::*;

    const SPAN: [f64; 2] = [0.04, 0.043];
    const ACCURACY: FormAccuracy = FormAccuracy { depth: 65e-9, lateral: 30e-9, axis: 1e-4 };

    /// Form error (m) of an arm and a lens position that are off by micrometers.
    fn wrong() -> Correction {
        let mut coefficients = [[Complex::default(); POLYNOMIALS]; HIGHEST_CORRECTED + 1];
        coefficients[0][1] = Complex::new(-3e-7, 0.0);
        coefficients[1][0] = Complex::new(0.0, 4e-7);
        coefficients[2] = [5e-6, -1.1e-6, 2e-7, 0.0].map(|a| Complex::new(a, 0.3 * a));
        coefficients[4][0] = Complex::new(8e-7, 0.0);
        Correction { span: SPAN, coefficients }
    }

    /// Samples at `angles` angles of the near side, and at as many of the far side, of a lens with the error `wrong`.
    fn readings(wrong: &Correction, angles: i32, noise: f64, random: &mut Pcg64Mcg) -> Vec<FormReading> {
        let normal = Normal::new(0.0, noise).unwrap();
        let mut readings = Vec::new();
        for (side, k, i) in (0..2 * angles).flat_map(|k| (0..14).map(move |i| (1.0 - 2.0 * f64::from(k % 2), k / 2, i)))
        {
            let u = f64::from(i) / 6.5 - 1.0;
            let slope = -side * (0.22 + 0.02 * u) * (1.0 + (TAU * f64::from(2 * k) / f64::from(angles)).cos());
            let mut reading = FormReading {
                slide_position: 0.0415 + 0.0015 * u,
                angle: TAU * f64::from(k) / f64::from(angles),
                excess: 5e-3,
                gain: 0.99,
                slope,
            };
            // the axis is 20 um off the zero of the scale
            reading.excess += reading.gain * depth(wrong, &reading) - 2e-5 * slope + normal.sample(random);
            readings.push(reading);
        }
        readings
    }

    /// Root mean square of the sum of two corrections over the lens, m.
    fn left(a: &Correction, b: &Correction) -> f64 {
        let mut squares = 0.0;
        for (u, angle) in (0..20).flat_map(|k| (0..24).map(move |i| (k, i))) {
            let slide_position = 0.040_075 + 1.5e-4 * f64::from(u);
            let reading = FormReading { slide_position, angle: f64::from(angle) * TAU / 24.0, ..Default::default() };
            squares += (depth(a, &reading) + depth(b, &reading)).powi(2) / 480.0;
        }
        squares.sqrt()
    }

    #[test]
    fn what_is_smooth_is_corrected_without_zero_and_axis_of_the_probe() {
        let mut random = Pcg64Mcg::seed_from_u64(3);
        let found = fit(&readings(&wrong(), 16, 1e-12, &mut random), None, &ACCURACY).unwrap();
        // uncertain parts are omitted: less than 9 s^2 / c of a coefficient c
        assert!(left(&found.correction, &wrong()) < 3e-8, "{:e}", left(&found.correction, &wrong()));
        let nothing = Correction { span: SPAN, coefficients: Default::default() };
        assert!((found.error / left(&wrong(), &nothing) - 1.0).abs() < 0.05, "{:e}", found.error);
        assert!(found.largest > 5e-6 && found.largest < 8e-6 && found.residual < 1e-11);
        assert_eq!(found.correction.coefficients[0][0], Complex::default());
    }

    #[test]
    fn a_second_lens_corrects_the_first() {
        let mut random = Pcg64Mcg::seed_from_u64(4);
        // cut with the half of what it needs: the other half is its error
        let half = |factor: f64| {
            let mut part = wrong();
            part.coefficients.iter_mut().flatten().for_each(|c| *c *= factor);
            part
        };
        let (cut_with, error) = (half(-0.5), half(0.5));
        let found = fit(&readings(&error, 16, 1e-12, &mut random), Some(&cut_with), &ACCURACY).unwrap();
        assert!(left(&found.correction, &wrong()) < 3e-8, "{:e}", left(&found.correction, &wrong()));
        assert!(
            (found.error / fit(&readings(&error, 16, 1e-12, &mut random), None, &ACCURACY).unwrap().error - 1.0).abs()
                < 1e-3
        );
    }

    #[test]
    fn the_deviation_is_the_scatter_and_noise_is_not_cut() {
        let mut random = Pcg64Mcg::seed_from_u64(1999);
        let nothing = Correction { span: SPAN, coefficients: Default::default() };
        // 0.3 um of a cut instead of the nominal 65 nm
        let (mut ratio, mut cut) = (0.0, 0.0);
        for _ in 0..40 {
            let found = fit(&readings(&nothing, 16, 3e-7, &mut random), None, &ACCURACY).unwrap();
            ratio += (found.error / found.std).powi(2) / 40.0;
            cut += left(&found.correction, &nothing).powi(2) / 40.0;
            assert!((found.residual / 3e-7 - 1.0).abs() < 0.15, "{:e}", found.residual);
        }
        println!("ratio {:.3}, cut {:.3e} m", ratio.sqrt(), cut.sqrt());
        assert!((ratio.sqrt() - 1.0).abs() < 0.15, "{}", ratio.sqrt());
        assert!(cut.sqrt() < 1.5e-8, "{:e}", cut.sqrt());
    }

    #[test]
    fn too_few_samples_angles_or_positions_are_rejected() {
        let mut random = Pcg64Mcg::seed_from_u64(5);
        let all = readings(&wrong(), 16, 6e-8, &mut random);
        assert_eq!(fit(&all[..UNKNOWNS], None, &ACCURACY).map(|_| ()), Err(NoEstimate::TooFew));
        let circle: Vec<_> = all.iter().map(|reading| FormReading { slide_position: 0.04, ..*reading }).collect();
        assert_eq!(fit(&circle, None, &ACCURACY).map(|_| ()), Err(NoEstimate::NotObservable));
        // eight angles do not resolve the fourth harmonic
        let few = readings(&wrong(), 8, 6e-8, &mut random);
        match fit(&few, None, &ACCURACY) {
            Ok(found) => assert!(found.std > 1e-3, "{:e}", found.std),
            Err(failure) => assert_eq!(failure, NoEstimate::NotObservable),
        }
    }
}
