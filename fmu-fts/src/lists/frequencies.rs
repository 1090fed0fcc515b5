//! A list of frequencies, written as text in Hz like `10, 20, 30`.

use std::f64::consts::TAU;
use std::str::FromStr;

use control_blocks::{ParameterError, real_numbers, require};
use serde::{Deserialize, Serialize};

/// Frequencies that a list can hold.
pub const COUNT_MAX: usize = 32;
/// Lowest and highest frequency of a list, Hz.
const LIMITS: (f64, f64) = (0.1, 10_000.0);

/// Up to [`COUNT_MAX`] ascending frequencies.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Frequencies {
    hertz: [f64; COUNT_MAX],
    count: usize,
}

impl Frequencies {
    /// Dense up to the bandwidth, where the harmonics of the path and of the cancellation are, and about the resonance of
    /// the arm on the locked hub.
    pub const DEFAULT: Self = Self {
        hertz: [
            10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 80.0, 100.0, 120.0, 140.0, 160.0, 180.0, 200.0, 230.0, 260.0, 280.0,
            300.0, 330.0, 360.0, 400.0, 450.0, 500.0, 550.0, 600.0, 700.0, 800.0, 900.0, 1000.0, 1100.0, 1150.0,
            1200.0, 1250.0,
        ],
        count: COUNT_MAX,
    };
    /// The same as text.
    pub const DEFAULT_TEXT: &'static str = "10, 20, 30, 40, 50, 60, 80, 100, 120, 140, 160, 180, 200, 230, 260, 280, 300, 330, 360, 400, \
        450, 500, 550, 600, 700, 800, 900, 1000, 1100, 1150, 1200, 1250";

    /// The highest frequency, Hz.
    pub fn highest(&self) -> f64 {
        self.hertz[..self.count].last().copied().unwrap_or(0.0)
    }

    /// The frequencies, rad/s.
    pub fn iter(&self) -> impl Iterator<Item = f64> {
        self.hertz[..self.count].iter().map(|hertz| TAU * hertz)
    }
}

impl FromStr for Frequencies {
    type Err = ParameterError;

    /// Ascending numbers in Hz, separated by commas, semicolons or blanks.
    fn from_str(text: &str) -> Result<Self, ParameterError> {
        let mut list = Self { hertz: [0.0; COUNT_MAX], count: 0 };
        for (part, number) in real_numbers(text) {
            let above = if list.count > 0 { list.hertz[list.count - 1] } else { 0.0 };
            let fits = |hertz: &f64| *hertz >= LIMITS.0 && *hertz <= LIMITS.1 && *hertz > above;
            let hertz = number.filter(fits).ok_or_else(|| rejected(text, &format!("not `{part}`")))?;
            *list.hertz.get_mut(list.count).ok_or_else(|| rejected(text, "not more"))? = hertz;
            list.count += 1;
        }
        require(list.count > 0, || rejected(text, "not ``"))?;
        Ok(list)
    }
}

fn rejected(text: &str, what: &str) -> ParameterError {
    let (low, high) = LIMITS;
    ParameterError {
        name: "expert.identify.frequencies",
        value: text.to_owned(),
        limit: format!("1 to {COUNT_MAX} ascending numbers from `{low}` to `{high}` Hz, {what}"),
        hint: "write for instance `10, 20, 40, 80, 160, 320`",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_hertz_are_read_as_angular_frequencies() {
        let list: Frequencies = " 10, 20.5 ;300".parse().unwrap();
        assert_eq!(list.iter().collect::<Vec<_>>(), [TAU * 10.0, TAU * 20.5, TAU * 300.0]);
        assert_eq!(list.highest(), 300.0);
    }

    #[test]
    fn the_default_is_the_default_text() {
        assert_eq!(Frequencies::DEFAULT_TEXT.parse(), Ok(Frequencies::DEFAULT));
    }

    #[test]
    fn nonsense_is_named() {
        let many = (1..=33).map(|i| i.to_string()).collect::<Vec<_>>().join(",");
        let cases = [
            ("", "not ``"),
            ("10,ten", "`ten`"),
            ("10,10", "`10`"),
            ("0", "`0`"),
            ("2e4", "`2e4`"),
            ("nan", "`nan`"),
            (&many, "not more"),
        ];
        for (text, part) in cases {
            let message = text.parse::<Frequencies>().unwrap_err().to_string();
            assert!(message.starts_with(&format!("parameter `expert.identify.frequencies` is `{text}`")), "{message}");
            assert!(message.contains(part) && message.contains("hint:"), "{message}");
        }
    }
}
