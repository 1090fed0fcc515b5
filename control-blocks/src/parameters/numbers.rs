//! Lists of numbers in a text, with one grammar: numbers stand between commas, semicolons or blanks, in any number.
//!
//! Whole numbers may be ranges, `1-24` or `1 - 24`; the minus of a number with a fraction is its sign. The parameter defines
//! the valid contents of a list: a part that is no number is returned as none, with its text.

use std::ops::RangeInclusive;

fn separates(c: char) -> bool {
    c == ',' || c == ';' || c.is_whitespace()
}

/// The parts of a list of numbers, each with its finite number or none.
pub fn real_numbers(text: &str) -> impl Iterator<Item = (&str, Option<f64>)> {
    let parts = text.split(separates).filter(|part| !part.is_empty());
    parts.map(|part| (part, part.parse().ok().filter(|number: &f64| number.is_finite())))
}

/// The parts of a list of whole numbers and ascending ranges of them, each with its range or none.
pub fn whole_numbers(text: &str) -> impl Iterator<Item = (&str, Option<RangeInclusive<usize>>)> {
    let mut left = text;
    std::iter::from_fn(move || {
        left = left.trim_start_matches(separates);
        let (part, rest) = left.split_at(part_end(left));
        left = rest;
        (!part.is_empty()).then(|| (part, range(part)))
    })
}

/// Bytes of the first part of a text: one word, or words and minus signs with blanks between.
fn part_end(text: &str) -> usize {
    let word = |text: &str| text.find(separates).unwrap_or(text.len());
    let mut end = word(text);
    loop {
        let after = text[end..].trim_start();
        let more = word(after);
        let joined = text[..end].ends_with('-') || after.starts_with('-');
        if more == 0 || !joined {
            return end;
        }
        end = text.len() - after.len() + more;
    }
}

fn range(part: &str) -> Option<RangeInclusive<usize>> {
    let (first, last) = part.split_once('-').unwrap_or((part, part));
    let number = |text: &str| text.trim().parse::<usize>().ok();
    let (first, last) = (number(first)?, number(last)?);
    (first <= last).then_some(first..=last)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wholes(text: &str) -> Option<Vec<usize>> {
        let ranges: Option<Vec<_>> = whole_numbers(text).map(|(_, range)| range).collect();
        Some(ranges?.into_iter().flatten().collect())
    }

    fn reals(text: &str) -> Option<Vec<f64>> {
        real_numbers(text).map(|(_, number)| number).collect()
    }

    #[test]
    fn commas_semicolons_and_blanks_are_the_same() {
        for text in ["2,4,10", "2, 4, 10", "2 4 10", "2;4;10", " ,2;; 4\t10\n, "] {
            assert_eq!((wholes(text), reals(text)), (Some(vec![2, 4, 10]), Some(vec![2.0, 4.0, 10.0])), "{text}");
        }
        for text in ["", "  ", ",;"] {
            assert_eq!((wholes(text), reals(text)), (Some(vec![]), Some(vec![])), "`{text}`");
        }
    }

    #[test]
    fn ranges_of_whole_numbers() {
        for text in ["1-3", "1 - 3", "1- 3", "1 -3", " 1-3; "] {
            assert_eq!(wholes(text), Some(vec![1, 2, 3]), "{text}");
        }
        assert_eq!(wholes("50, 1 - 3 ,2 7-8 9"), Some(vec![50, 1, 2, 3, 2, 7, 8, 9]));
        assert_eq!(wholes("4-4"), Some(vec![4]));
    }

    #[test]
    fn what_is_no_whole_number_is_named() {
        let cases = ["5-3", "1--3", "1 - - 3", "-3", "3-", "- 3", "1-2-3", "two", "1.5", "1e2", "99999999999999999999"];
        for text in cases {
            assert_eq!(whole_numbers(&format!("1, {text}, 2")).nth(1), Some((text, None)));
        }
    }

    #[test]
    fn numbers_with_a_sign_and_a_fraction() {
        assert_eq!(reals("1.5 -2;3e-2,.5"), Some(vec![1.5, -2.0, 0.03, 0.5]));
        for text in ["ten", "nan", "inf", "1-3", "1_000", "1e999", "-"] {
            assert_eq!(real_numbers(&format!("7 {text} 8")).nth(1), Some((text, None)));
        }
    }
}
