//! Cubic between rows of numbers at equal distances: Hermite's, with the slopes of central differences.
//!
//! One more row at each end, continued quadratically, gives the slopes there.

use nalgebra::Complex;

/// One row more at each end, on the parabola through the three next.
pub fn continued(rows: &[Vec<Complex<f64>>]) -> Vec<Vec<Complex<f64>>> {
    let beyond = |[a, b, c]: [&Vec<Complex<f64>>; 3]| {
        a.iter().zip(b).zip(c).map(|((a, b), c)| a * 3.0 - b * 3.0 + c).collect::<Vec<_>>()
    };
    let last = rows.len() - 1;
    let mut all = vec![beyond([&rows[0], &rows[1], &rows[2]])];
    all.extend_from_slice(rows);
    all.push(beyond([&rows[last], &rows[last - 1], &rows[last - 2]]));
    all
}

/// Weights of four neighboring rows at the fraction `t` between the middle two.
pub fn weights(t: f64) -> [f64; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [0.5 * (2.0 * t2 - t3 - t), 0.5 * (3.0 * t3 - 5.0 * t2) + 1.0, 0.5 * (4.0 * t2 - 3.0 * t3 + t), 0.5 * (t3 - t2)]
}

/// Derivatives of these weights to `t`.
pub fn slopes(t: f64) -> [f64; 4] {
    let t2 = t * t;
    [
        0.5 * (4.0 * t - 3.0 * t2 - 1.0),
        0.5 * (9.0 * t2 - 10.0 * t),
        0.5 * (8.0 * t - 9.0 * t2 + 1.0),
        0.5 * (3.0 * t2 - 2.0 * t),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_two_rows_it_is_hermite_s_cubic() {
        assert_eq!((weights(0.0), weights(1.0)), ([0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]));
        assert_eq!(weights(0.5), [-1.0 / 16.0, 9.0 / 16.0, 9.0 / 16.0, -1.0 / 16.0]);
        for t in [0.1, 0.3, 0.9] {
            let weights = weights(t);
            let moment =
                |f: fn(f64) -> f64| weights.iter().zip([-1.0, 0.0, 1.0, 2.0]).map(|(w, x)| w * f(x)).sum::<f64>();
            // exact for parabolas
            assert!((moment(|_| 1.0) - 1.0).abs() < 1e-15 && (moment(|x| x) - t).abs() < 1e-15);
            assert!((moment(|x| x * x) - t * t).abs() < 1e-15, "{t}");
        }
    }

    #[test]
    fn the_slopes_are_the_derivatives_of_the_weights() {
        for t in [0.0, 0.1, 0.5, 0.9, 1.0] {
            let (before, after) = (weights(t - 1e-6), weights(t + 1e-6));
            for (i, slope) in slopes(t).into_iter().enumerate() {
                assert!(((after[i] - before[i]) / 2e-6 - slope).abs() < 1e-9, "{t} {i}: {slope}");
            }
        }
    }
}
