//! Bandwidth, damping, integral action and delay of the servo, from the factors of its regression and their covariance.
//!
//! The estimator moves the slide along straight lines between its samples. Their mean over a sample T is that of the
//! slide plus T^2/12 x''. With x'' of the servo that adds T^2/12 (w^2 r'' + 2 zeta w r''') to the right side. In
//! strokes that reverse at the frequency of the servo r''' is -w^2 r', so that 2 zeta w is (w T)^2/12 too large.
//!
//! A servo that computes in steps of its own brakes half a step tau late: x'' = w^2 e + 2 zeta w (e' + tau x''), which
//! is a servo with w and zeta (1 - 2 zeta w tau)^(-1/2) times as large. No motion distinguishes the two. So zeta w tau
//! is part of the standard deviations; for zeta both effects add up.

use nalgebra::SVector;

use crate::interface::{Measured, Parameters};
use crate::sensing::{Fit, TERMS};

/// Half a step of the servo over the sample period: motion boards close their loops about ten times for each setpoint.
const SERVO_LATE: f64 = 0.05;
/// Smallest standard deviation of the delay, samples: setpoints in steps are no lines.
const DELAY_MIN: f64 = 2.5e-3;
/// Correlation time of the residuals that determine the integral action, relative to the others: 48 ms instead of 8, the
/// time of a reversal of the slow strokes (measured: 2.4 times the scatter on servos within 30 %).
const SLOW: f64 = 6.0;

/// Quantities that the factors of x'' = w^2 e + 2 zeta w e' - w^2 t r' + (w^2 / T_i) integral of e give, t later than
/// `delay` samples, with standard deviations; none if the servo does not follow, or a number is not finite.
pub fn response(p: &Parameters, fit: &Fit<TERMS>, delay: f64) -> Option<Measured> {
    let m = of_factors(p, fit, delay)?;
    let (braked_late, lines) = (braked_late(p, &m), (m.slide_bandwidth * p.sample_period).powi(2) / 12.0);
    Some(Measured {
        slide_bandwidth_std: m.slide_bandwidth_std.hypot(m.slide_bandwidth * braked_late),
        slide_damping_std: m.slide_damping_std.hypot(m.slide_damping * (braked_late + lines)),
        slide_integral_std: SLOW.sqrt() * m.slide_integral_std,
        io_delay_std: m.io_delay_std.hypot(DELAY_MIN),
        ..m
    })
}

/// Relative increase of natural frequency and damping of a servo that computes in its own steps.
pub fn braked_late(p: &Parameters, m: &Measured) -> f64 {
    m.slide_damping * m.slide_bandwidth * SERVO_LATE * p.sample_period
}

/// The same with the standard deviations of the factors alone, to first order.
fn of_factors(p: &Parameters, fit: &Fit<TERMS>, delay: f64) -> Option<Measured> {
    let servo = fit.servo()?;
    let [stiffness, damping, late, _, integral, _, _]: [f64; TERMS] = fit.value.into();
    let (w, sample) = (servo.bandwidth, stiffness * p.sample_period);
    let deviation = |slopes: [(usize, f64); 2]| {
        let mut gradient = SVector::<f64, TERMS>::zeros();
        slopes.into_iter().for_each(|(i, slope)| gradient[i] = slope);
        gradient.dot(&(fit.covariance * gradient)).max(0.0).sqrt()
    };
    let found = Measured {
        slide_bandwidth: w,
        slide_bandwidth_std: servo.deviation,
        slide_damping: damping / (2.0 * w),
        slide_damping_std: deviation([(0, -damping / (4.0 * w * stiffness)), (1, 0.5 / w)]),
        slide_integral: integral / stiffness,
        slide_integral_std: deviation([(0, -integral / stiffness.powi(2)), (4, stiffness.recip())]),
        io_delay: delay - late / sample,
        io_delay_std: deviation([(0, late / (sample * stiffness)), (2, -sample.recip())]),
        ..Measured::START
    };
    let numbers = [
        found.slide_damping,
        found.slide_damping_std,
        found.slide_integral,
        found.slide_integral_std,
        found.io_delay,
        found.io_delay_std,
    ];
    numbers.into_iter().all(f64::is_finite).then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use control_blocks::Trajectory;
    use nalgebra::SMatrix;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    use crate::sensing::ServoEstimator;

    const P: Parameters = Parameters::START;
    /// A value of a measurement and its standard deviation.
    type Word = fn(&Measured) -> [f64; 2];
    const WORDS: [Word; 4] = [
        |m| [m.slide_bandwidth, m.slide_bandwidth_std],
        |m| [m.slide_damping, m.slide_damping_std],
        |m| [m.slide_integral, m.slide_integral_std],
        |m| [m.io_delay, m.io_delay_std],
    ];

    /// Factors of the regression for 200 rad/s, damping 0.6, an integral time of 0.1 s and 1.5 samples more than configured.
    fn factors() -> SVector<f64, TERMS> {
        SVector::from([4e4, 240.0, -60.0, 0.0, 4e5, 0.0, 0.0])
    }

    #[test]
    fn the_factors_are_expressed_in_terms_of_the_servo() {
        let fit = Fit { value: factors(), covariance: SMatrix::zeros() };
        let m = of_factors(&P, &fit, 1.0).unwrap();
        for (word, expected) in WORDS.iter().zip([200.0, 0.6, 10.0, 2.5]) {
            let [value, deviation] = word(&m);
            assert!((value / expected - 1.0).abs() < 1e-12 && deviation == 0.0, "{value} {expected}");
        }
        assert_eq!(response(&P, &Fit { value: -factors(), ..fit }, 1.0), None);
        let mut covariance = SMatrix::zeros();
        covariance[(2, 2)] = f64::INFINITY;
        assert_eq!(response(&P, &Fit { covariance, ..fit }, 1.0), None);
    }

    #[test]
    fn the_deviations_are_the_slopes_of_these_words() {
        for i in 0..TERMS {
            let step = 1e-6 * factors()[i].abs().max(1.0);
            let mut covariance = SMatrix::zeros();
            covariance[(i, i)] = step * step;
            let mut moved = factors();
            moved[i] += step;
            let [before, after] =
                [factors(), moved].map(|value| of_factors(&P, &Fit { value, covariance }, 1.0).unwrap());
            for word in WORDS {
                let ([value, deviation], change) = (word(&before), word(&after)[0] - word(&before)[0]);
                assert!((deviation - change.abs()).abs() <= 1e-5 * change.abs() + 1e-12, "{i}: {value} {change}");
            }
        }
    }

    /// Result for a servo whose setpoint is a sum of many sines, measured with this noise (m).
    fn found(noise: f64, seed: u64) -> Measured {
        const FINE: u32 = 100;
        const SINES: [[f64; 2]; 4] = [[7.0, 0.0], [45.0, 1.0], [130.0, 2.0], [260.0, 3.0]];
        let (w, zeta, integral, dt) = (220.0, 0.6, 8.0, P.sample_period);
        let fine = dt / f64::from(FINE);
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
        let (mut x, mut v, mut sum, mut newest) = (0.0, 0.0, 0.0, Trajectory::default());
        let mut estimator = ServoEstimator::default();
        for k in 0..4000 {
            let normal: f64 = StandardNormal.sample(&mut random);
            estimator.update(dt, 1.0, &newest, x + noise * normal);
            let t = f64::from(k) * dt;
            let velocity = SINES.iter().map(|[omega, phase]| 0.004 * ((omega * t + phase).sin() - phase.sin())).sum();
            let next = Trajectory { position: newest.position + newest.velocity * dt, velocity, acceleration: 0.0 };
            let acts = std::mem::replace(&mut newest, next);
            for i in 0..FINE {
                let error = acts.position + acts.velocity * fine * f64::from(i) - x;
                v += fine * (w * w * (error + sum) + 2.0 * zeta * w * (acts.velocity - v));
                sum += fine * integral * error;
                x += fine * v;
            }
        }
        of_factors(&P, &estimator.fit(dt).unwrap(), 1.0).unwrap()
    }

    #[test]
    fn the_deviation_covers_the_scatter_of_the_estimates() {
        let all: Vec<Measured> = (0..24).map(|seed| found(3e-7, seed)).collect();
        for (word, expected) in WORDS.iter().zip([220.0, 0.6, 8.0, 1.0]) {
            let mean = |i: usize| all.iter().map(|m| word(m)[i]).sum::<f64>() / 24.0;
            let scatter = (all.iter().map(|m| (word(m)[0] - mean(0)).powi(2)).sum::<f64>() / 23.0).sqrt();
            println!("{expected}: mean {}, scatter {scatter}, reported {}", mean(0), mean(1));
            assert!((0.7..5.0).contains(&(mean(1) / scatter)), "{expected}: {} {scatter}", mean(1));
            assert!((mean(0) / expected - 1.0).abs() < 0.02, "{expected}: {}", mean(0));
        }
    }
}
