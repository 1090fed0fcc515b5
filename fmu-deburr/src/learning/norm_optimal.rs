//! Norm-optimal change of a pattern: (T'T + lambda)^-1 T' e, by conjugate gradients.
//!
//! T is the nominal loop over the whole run, never written as a matrix: each product is one run of the loop, forward or
//! backward in time.

use crate::learning::nominal::Nominal;

/// Most steps; at lambda = 0.01 some forty are enough.
const STEPS_MAX: usize = 400;
/// The residual, relative to the start, at which the solution counts.
const TOLERANCE: f64 = 1e-9;

/// Memory for three signals in addition to the solution.
pub struct Work<'a> {
    /// Residual.
    pub residual: &'a mut [f64],
    /// Direction of the search.
    pub direction: &'a mut [f64],
    /// Product with the direction.
    pub product: &'a mut [f64],
}

/// Replaces an error by the change of the pattern; all slices have one length.
pub fn solve(nominal: &Nominal, weight: f64, error: &mut [f64], work: &mut Work) {
    let Work { residual, direction, product } = work;
    nominal.apply(error, true);
    residual.copy_from_slice(error);
    direction.copy_from_slice(error);
    error.fill(0.0);
    let mut square = dot(residual, residual);
    let enough = TOLERANCE * TOLERANCE * square;
    for _ in 0..STEPS_MAX {
        if square <= enough {
            break;
        }
        product.copy_from_slice(direction);
        nominal.apply(product, false);
        nominal.apply(product, true);
        add(product, weight, direction);
        let step = square / dot(direction, product);
        add(error, step, direction);
        add(residual, -step, product);
        let next = dot(residual, residual);
        let fraction = next / square;
        direction.iter_mut().zip(residual.iter()).for_each(|(d, r)| *d = r + fraction * *d);
        square = next;
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// a += factor b.
fn add(a: &mut [f64], factor: f64, b: &[f64]) {
    a.iter_mut().zip(b).for_each(|(a, b)| *a += factor * b);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interface::Parameters;

    #[test]
    fn the_solution_solves_the_equation() {
        let nominal = Nominal::new(&Parameters::START, 1);
        let error: Vec<f64> = (0..200).map(|k| (0.1 * f64::from(k)).sin() * 100.0).collect();
        for weight in [1e-3, 1e-2, 0.1, 1.0] {
            let mut solution = error.clone();
            let mut room = vec![vec![0.0; 200]; 3];
            let [a, b, c] = room.as_mut_slice() else { panic!() };
            solve(&nominal, weight, &mut solution, &mut Work { residual: a, direction: b, product: c });
            let (mut left, mut right) = (solution.clone(), error.clone());
            nominal.apply(&mut left, false);
            nominal.apply(&mut left, true);
            add(&mut left, weight, &solution);
            nominal.apply(&mut right, true);
            assert!(left.iter().zip(&right).all(|(l, r)| (l - r).abs() < 1e-5), "{weight}");
        }
    }

    #[test]
    fn no_error_no_change() {
        let mut zero = [0.0; 50];
        let (mut a, mut b, mut c) = ([0.0; 50], [0.0; 50], [0.0; 50]);
        let mut work = Work { residual: &mut a, direction: &mut b, product: &mut c };
        solve(&Nominal::new(&Parameters::START, 0), 0.01, &mut zero, &mut work);
        assert_eq!(zero, [0.0; 50]);
    }
}
