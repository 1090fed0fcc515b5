//! Calibration flats: zero of the arm angle from the depths of flats cut at several arm angles.
//!
//! Eq. (1) of the paper, R_a sin(b_0 + b_i) = p_i - K with K = R_t + p_0, fits arm length, arm zero and K together. The
//! arm length of the toroid enters with its standard deviation: as an exact value it would change b_0 by
//! (dR_a / R_a) cot(b_0 + b), without limit where the arm is square to the spindle.

use control_blocks::{NoEstimate, Observation, least_squares};
use nalgebra::SVector;
use serde::{Deserialize, Serialize};

/// One flat.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Flat {
    /// Arm angle b_i while it was cut, rad.
    pub arm_angle: f64,
    /// Probed depth p_i, m.
    pub depth: f64,
}

/// Arm length and arm zero, each with its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ArmEstimate {
    /// Arm length R_a, m.
    pub length: f64,
    /// Arm zero b_0, rad.
    pub zero: f64,
    /// Standard deviation of the length, m.
    pub length_std: f64,
    /// Standard deviation of the zero, rad.
    pub zero_std: f64,
}

/// Standard deviations of what is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlatAccuracy {
    /// Of the depth, m.
    pub depth: f64,
    /// Of the arm angle, rad.
    pub arm_angle: f64,
}

/// Arm zero, arm length, K.
type ArmUnknowns = SVector<f64, 3>;

/// Fits the arm and the root mean square of the residuals (m), with `known.length` and `known.length_std` from the
/// toroid; `known.zero` only selects the half revolution of the arm.
///
/// # Errors
/// Says why there is no estimate.
pub fn fit(flats: &[Flat], known: &ArmEstimate, accuracy: &FlatAccuracy) -> Result<(ArmEstimate, f64), NoEstimate> {
    if flats.is_empty() {
        return Err(NoEstimate::TooFew);
    }
    let start = start(flats, known);
    let found = least_squares(start, flats.len() + 1, |i, value| match flats.get(i) {
        Some(flat) => observe(flat, accuracy, value),
        // the arm length of the toroid
        None => Observation {
            residual: (value[1] - known.length) / known.length_std,
            gradient: SVector::from([0.0, 1.0 / known.length_std, 0.0]),
        },
    })?;
    let squares: f64 = flats.iter().map(|flat| gap(flat, &found.value).powi(2)).sum();
    let arm = ArmEstimate {
        length: found.value[1],
        zero: found.value[0],
        length_std: found.sigma(1),
        zero_std: found.sigma(0),
    };
    Ok((arm, (squares / flats.len() as f64).sqrt()))
}

/// R_a sin(b_0 + b_i) + K - p_i, m; eq. (1)
fn gap(flat: &Flat, value: &ArmUnknowns) -> f64 {
    value[1] * (value[0] + flat.arm_angle).sin() + value[2] - flat.depth
}

fn observe(flat: &Flat, accuracy: &FlatAccuracy, value: &ArmUnknowns) -> Observation<3> {
    let (sin, cos) = (value[0] + flat.arm_angle).sin_cos();
    let sigma = accuracy.depth.hypot(value[1] * cos * accuracy.arm_angle);
    let gradient = SVector::from([value[1] * cos, sin, 1.0]) / sigma;
    Observation { residual: gap(flat, value) / sigma, gradient }
}

/// Arm zero near the known one, then K.
fn start(flats: &[Flat], known: &ArmEstimate) -> ArmUnknowns {
    let zero = known.zero;
    let n = flats.len() as f64;
    let k = flats.iter().map(|flat| flat.depth - known.length * (zero + flat.arm_angle).sin()).sum::<f64>() / n;
    SVector::from([zero, known.length, k])
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_distr::{Distribution, Normal};
    use rand_pcg::Pcg64Mcg;

    use super::*;

    const LENGTH: f64 = 0.080_003;
    const ZERO: f64 = 0.052_4;
    const ACCURACY: FlatAccuracy = FlatAccuracy { depth: 65e-9, arm_angle: 0.25e-6 };
    /// Assumed machine before the flats, with the arm length of a toroid from 30 to 60 degrees.
    const KNOWN: ArmEstimate = ArmEstimate { length: LENGTH, zero: 0.05, length_std: 0.35e-6, zero_std: 0.01 };

    /// `count` flats with b_0 + b from `low` to `high` degrees.
    fn flats(low: f64, high: f64, count: usize) -> Vec<Flat> {
        let phi = |i: usize| (low + (high - low) * i as f64 / (count - 1) as f64).to_radians();
        let flat = |phi: f64| Flat { arm_angle: phi - ZERO, depth: LENGTH * phi.sin() + 0.0123 };
        (0..count).map(phi).map(flat).collect()
    }

    #[test]
    fn exact_flats_give_the_arm() {
        for (low, high) in [(30.0, 60.0), (-11.0, 11.0), (0.0, 22.0), (-30.0, 30.0)] {
            let (arm, residual) = fit(&flats(low, high, 15), &KNOWN, &ACCURACY).unwrap();
            assert!((arm.zero - ZERO).abs() < 1e-8, "{low}..{high}: {:e}", arm.zero - ZERO);
            assert!((arm.length - LENGTH).abs() < 1e-10);
            assert!(residual < 1e-11);
        }
    }

    #[test]
    fn the_residual_is_the_root_mean_square_of_what_the_fit_leaves() {
        // alternating by 1 um, which three parameters hardly follow over 30 flats
        let mut rough = flats(30.0, 60.0, 30);
        rough.iter_mut().enumerate().for_each(|(i, flat)| flat.depth += if i % 2 == 0 { 1e-6 } else { -1e-6 });
        let (_, residual) = fit(&rough, &KNOWN, &ACCURACY).unwrap();
        assert!((0.95e-6..1e-6).contains(&residual), "{residual:e}");
    }

    #[test]
    fn a_start_half_a_radian_away_is_good_enough() {
        for away in [-0.5, -0.2, 0.2, 0.5] {
            let known = ArmEstimate { zero: ZERO + away, ..KNOWN };
            let (arm, _) = fit(&flats(30.0, 60.0, 15), &known, &ACCURACY).unwrap();
            assert!((arm.zero - ZERO).abs() < 1e-8, "{away}: {:e}", arm.zero - ZERO);
        }
    }

    #[test]
    fn the_other_end_of_the_arm_is_half_a_revolution_away() {
        let mut other = flats(30.0, 60.0, 15);
        other.iter_mut().for_each(|flat| flat.arm_angle -= std::f64::consts::PI);
        let known = ArmEstimate { zero: KNOWN.zero + std::f64::consts::PI, ..KNOWN };
        let (arm, _) = fit(&other, &known, &ACCURACY).unwrap();
        assert!((arm.zero - ZERO - std::f64::consts::PI).abs() < 1e-8);
    }

    /// Error of b_0 (rad) and its ratio to the reported sigma: root mean squares and largest error of `runs` samples.
    fn monte_carlo(flats: &[Flat], length_std: f64, runs: u32) -> [f64; 3] {
        let mut random = Pcg64Mcg::seed_from_u64(42);
        let (depth, length) = (Normal::new(0.0, ACCURACY.depth).unwrap(), Normal::new(0.0, length_std).unwrap());
        let angle = Normal::new(0.0, ACCURACY.arm_angle).unwrap();
        let (mut squares, mut ratios, mut largest) = (0.0, 0.0, 0.0);
        for _ in 0..runs {
            let add = |f: &Flat, random: &mut Pcg64Mcg| Flat {
                arm_angle: f.arm_angle + angle.sample(random),
                depth: f.depth + depth.sample(random),
            };
            let sample: Vec<_> = flats.iter().map(|flat| add(flat, &mut random)).collect();
            let known = ArmEstimate { length: LENGTH + length.sample(&mut random), length_std, ..KNOWN };
            let (arm, _) = fit(&sample, &known, &ACCURACY).unwrap();
            let error = arm.zero - ZERO;
            squares += error * error;
            ratios += (error / arm.zero_std).powi(2);
            largest = f64::max(largest, error.abs());
        }
        [(squares / f64::from(runs)).sqrt(), (ratios / f64::from(runs)).sqrt(), largest]
    }

    #[test]
    fn sigma_is_the_scatter_of_the_estimate() {
        for (low, high) in [(30.0, 60.0), (0.0, 22.0), (-30.0, 30.0), (-11.0, 11.0)] {
            let [rms, ratio, largest] = monte_carlo(&flats(low, high, 15), KNOWN.length_std, 2000);
            println!("flats {low}..{high}: rms {rms:.3e} rad, largest {largest:.3e} rad, against sigma {ratio:.3}");
            // the residuals of 15 flats can only widen sigma
            assert!(ratio > 0.8 && ratio < 1.05, "{low}..{high}: {ratio}");
        }
    }

    #[test]
    fn flats_around_45_degrees_keep_a_hundredth_of_a_milliradian() {
        let [rms, _, largest] = monte_carlo(&flats(30.0, 60.0, 15), KNOWN.length_std, 500);
        assert!(rms < 0.01e-3 && largest < 0.025e-3, "{rms:e} {largest:e}");
    }

    #[test]
    fn near_the_square_position_sigma_says_that_the_zero_is_unknown() {
        let around = |degrees: f64| {
            let (arm, _) = fit(&flats(-degrees, degrees, 15), &KNOWN, &ACCURACY).unwrap();
            arm.zero_std
        };
        let (good, _) = fit(&flats(30.0, 60.0, 15), &KNOWN, &ACCURACY).unwrap();
        assert!(good.zero_std < 5e-6, "{:e}", good.zero_std);
        assert!(around(11.0) > 30e-6, "{:e}", around(11.0));
        assert!(around(3.0) > 300e-6, "{:e}", around(3.0));
    }

    #[test]
    fn an_arm_length_taken_as_exact_spoils_the_zero() {
        // the paper's estimator with 1 um of error in R_a: db_0 = (dR_a / R_a) cot(b_0 + b) in the middle of the flats
        let exact = ArmEstimate { length: LENGTH + 1e-6, length_std: 1e-9, ..KNOWN };
        for (low, high) in [(40.0f64, 50.0f64), (30.0, 60.0), (15.0, 25.0), (5.0, 15.0)] {
            let (arm, _) = fit(&flats(low, high, 15), &exact, &ACCURACY).unwrap();
            let expected = 1e-6 / LENGTH / (0.5 * (low + high)).to_radians().tan();
            let ratio = (arm.zero - ZERO) / expected;
            assert!((ratio - 1.0).abs() < 0.1, "{low}..{high}: {ratio}");
        }
    }

    #[test]
    fn too_few_or_equal_flats_are_rejected() {
        assert_eq!(fit(&flats(30.0, 60.0, 2), &KNOWN, &ACCURACY), Err(NoEstimate::TooFew));
        assert_eq!(fit(&[Flat { arm_angle: 0.7, depth: 0.07 }; 9], &KNOWN, &ACCURACY), Err(NoEstimate::NotObservable));
        let mut random = Pcg64Mcg::seed_from_u64(1);
        let nonsense: Vec<_> = (0..20).map(|_| Flat { arm_angle: random.random(), depth: f64::NAN }).collect();
        assert!(fit(&nonsense, &KNOWN, &ACCURACY).is_err());
    }
}
