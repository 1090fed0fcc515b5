//! Flexure of the arm: what the hub, where the encoder is, must do for the tool to be on the path.

use nalgebra::Complex;

use crate::parameters::Parameters;

/// Up to this share of the natural frequency the flexure is compensated; above, as there.
const SHARE_MAX: f64 = 0.7;

/// Motion of the hub over motion of the tool at `omega` (rad/s); 1 without compensation.
pub fn hub_over_tool(p: &Parameters, omega: f64) -> Complex<f64> {
    if !p.tip.compensation || p.tip.frequency == 0.0 {
        return Complex::new(1.0, 0.0);
    }
    let share = (omega / p.tip.frequency).clamp(-SHARE_MAX, SHARE_MAX);
    let spring = Complex::new(1.0, 2.0 * p.tip.damping * share);
    (spring - share * share) / spring
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hub_moves_less_by_the_square_of_the_frequency() {
        let mut p = Parameters::DEFAULT;
        p.tip.damping = 0.0;
        assert_eq!(hub_over_tool(&p, 0.0), Complex::new(1.0, 0.0));
        let ratio = hub_over_tool(&p, 0.25 * p.tip.frequency);
        assert!((ratio - (1.0 - 0.0625)).norm() < 1e-15);
        assert_eq!(hub_over_tool(&p, 1e9), hub_over_tool(&p, 0.7 * p.tip.frequency));
    }

    #[test]
    fn negative_frequencies_are_mirrored() {
        let p = Parameters::DEFAULT;
        assert_eq!(hub_over_tool(&p, -2000.0), hub_over_tool(&p, 2000.0).conj());
    }

    #[test]
    fn rigid_or_not_compensated_is_one() {
        let mut p = Parameters::DEFAULT;
        p.tip.compensation = false;
        assert_eq!(hub_over_tool(&p, 3000.0), Complex::new(1.0, 0.0));
        let mut p = Parameters::DEFAULT;
        p.tip.frequency = 0.0;
        assert_eq!(hub_over_tool(&p, 3000.0), Complex::new(1.0, 0.0));
    }
}
