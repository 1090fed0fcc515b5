//! Bandwidth, damping, integral action and delay of the servo, from the factors of its regression and their covariance.

use nalgebra::SVector;

use crate::interface::{Measured, Parameters};
use crate::sensing::{Fit, TERMS};

/// What the factors of x'' = w^2 e + 2 zeta w e' - w^2 t r' + (w^2 / T_i) integral of e say, t later than `delay` samples, with
/// standard deviations to first order; none if the servo does not go where it should.
pub fn response(p: &Parameters, fit: &Fit<TERMS>, delay: f64) -> Option<Measured> {
    let servo = fit.servo()?;
    let [stiffness, damping, late, _, integral, _, _]: [f64; TERMS] = fit.value.into();
    let (w, sample) = (servo.bandwidth, stiffness * p.sample_period);
    let deviation = |gradient: [f64; TERMS]| {
        let gradient = SVector::from(gradient);
        gradient.dot(&(fit.covariance * gradient)).max(0.0).sqrt()
    };
    Some(Measured {
        slide_bandwidth: w,
        slide_bandwidth_deviation: servo.deviation,
        slide_damping: damping / (2.0 * w),
        slide_damping_deviation: deviation([-damping / (4.0 * w * stiffness), 0.5 / w, 0.0, 0.0, 0.0, 0.0, 0.0]),
        slide_integral: integral / stiffness,
        slide_integral_deviation: deviation([-integral / stiffness.powi(2), 0.0, 0.0, 0.0, stiffness.recip(), 0.0, 0.0]),
        io_delay: delay - late / sample,
        io_delay_deviation: deviation([late / (sample * stiffness), 0.0, -sample.recip(), 0.0, 0.0, 0.0, 0.0]),
        ..Measured::START
    })
}
