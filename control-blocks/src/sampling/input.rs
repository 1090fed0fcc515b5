//! Plausibility of an input.

/// Whether an input is finite and within a limit.
pub fn is_plausible(value: f64, limit: f64) -> bool {
    value.is_finite() && value.abs() <= limit
}

/// For tests: copies of good inputs, each with an invalid number in one of the fields.
pub fn with_nonsense<I: Clone>(good: &I, fields: &[fn(&mut I) -> &mut f64]) -> Vec<I> {
    let copy = |nonsense: f64| {
        move |field: &fn(&mut I) -> &mut f64| {
            let mut bad = good.clone();
            *field(&mut bad) = nonsense;
            bad
        }
    };
    [f64::NAN, f64::INFINITY, f64::NEG_INFINITY]
        .iter()
        .flat_map(|nonsense| fields.iter().map(copy(*nonsense)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neither_nan_nor_infinity_nor_the_absurd() {
        for (value, expected) in [(-2.0, true), (2.0, true), (2.1, false), (f64::NAN, false), (f64::INFINITY, false)] {
            assert_eq!(is_plausible(value, 2.0), expected, "{value}");
        }
        assert!(!is_plausible(f64::INFINITY, f64::INFINITY));
    }

    #[test]
    fn every_field_is_spoilt_in_three_ways_and_the_others_stay() {
        let all = with_nonsense(&[1.0, 2.0], &[|pair| &mut pair[0], |pair| &mut pair[1]]);
        assert_eq!(all.len(), 6);
        for pair in all {
            assert_eq!(pair.map(f64::is_finite).iter().filter(|finite| **finite).count(), 1, "{pair:?}");
        }
    }
}
