//! A condition over the row of a step that ends the run.

/// One operation of a condition in postfix notation. True is 1, false is 0.
#[derive(Clone, Copy, Debug)]
pub enum Operation {
    /// puts a column of the row on the stack
    Column(usize),
    /// puts a number on the stack
    Number(f64),
    /// replaces the top of the stack
    Unary(fn(f64) -> f64),
    /// replaces the two on top of the stack
    Binary(fn(f64, f64) -> f64),
}

impl Operation {
    /// Operation by the name of numpy's function, exact in every bit; None if there is none.
    pub fn named(name: &str) -> Option<Self> {
        Some(match name {
            "negative" => Self::Unary(|a| -a),
            "positive" => Self::Unary(|a| a),
            "absolute" => Self::Unary(f64::abs),
            "sqrt" => Self::Unary(f64::sqrt),
            "isfinite" => Self::Unary(|a| number(a.is_finite())),
            "logical_not" => Self::Unary(|a| number(a == 0.0)),
            "add" => Self::Binary(|a, b| a + b),
            "subtract" => Self::Binary(|a, b| a - b),
            "multiply" => Self::Binary(|a, b| a * b),
            "divide" => Self::Binary(|a, b| a / b),
            "minimum" => Self::Binary(|a, b| if a < b || a.is_nan() { a } else { b }),
            "maximum" => Self::Binary(|a, b| if a > b || a.is_nan() { a } else { b }),
            "equal" => Self::Binary(|a, b| number(a == b)),
            "not_equal" => Self::Binary(|a, b| number(a != b)),
            "less" => Self::Binary(|a, b| number(a < b)),
            "less_equal" => Self::Binary(|a, b| number(a <= b)),
            "greater" => Self::Binary(|a, b| number(a > b)),
            "greater_equal" => Self::Binary(|a, b| number(a >= b)),
            "logical_and" => Self::Binary(|a, b| number(a != 0.0 && b != 0.0)),
            "logical_or" => Self::Binary(|a, b| number(a != 0.0 || b != 0.0)),
            _ => return None,
        })
    }
}

fn number(truth: bool) -> f64 {
    f64::from(u8::from(truth))
}

/// A condition that was checked against the number of columns.
#[derive(Clone, Debug)]
pub struct Condition {
    program: Vec<Operation>,
    stack: Vec<f64>,
}

impl Condition {
    /// A condition over rows of `columns` numbers; None when the program leaves no single value or reads beyond a row.
    pub fn new(program: Vec<Operation>, columns: usize) -> Option<Self> {
        let mut depth = 0_usize;
        for operation in &program {
            depth = match operation {
                Operation::Column(column) if *column >= columns => return None,
                Operation::Column(_) | Operation::Number(_) => depth + 1,
                Operation::Unary(_) => depth.checked_sub(1)? + 1,
                Operation::Binary(_) => depth.checked_sub(2)? + 1,
            };
        }
        let stack = Vec::with_capacity(program.len());
        (depth == 1).then_some(Self { program, stack })
    }

    /// Whether it is true; NaN is true, as in Python.
    pub(super) fn holds(&mut self, row: &[f64]) -> bool {
        let stack = &mut self.stack;
        stack.clear();
        for operation in &self.program {
            let value = match operation {
                Operation::Column(column) => row[*column],
                Operation::Number(value) => *value,
                Operation::Unary(function) => function(pop(stack)),
                Operation::Binary(function) => {
                    let right = pop(stack);
                    function(pop(stack), right)
                }
            };
            stack.push(value);
        }
        pop(stack) != 0.0
    }
}

/// top of a stack that `Condition::new` has found deep enough
fn pop(stack: &mut Vec<f64>) -> f64 {
    stack.pop().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn condition(words: &[&str], columns: usize) -> Option<Condition> {
        let operation = |word: &&str| {
            let column = word.strip_prefix('c').and_then(|rest| rest.parse().ok()).map(Operation::Column);
            column.or_else(|| word.parse().ok().map(Operation::Number)).or_else(|| Operation::named(word))
        };
        Condition::new(words.iter().map(operation).collect::<Option<_>>()?, columns)
    }

    #[test]
    fn postfix_takes_the_left_side_first() {
        // c0 - c1 / 2 > 1 and not c2
        let words = ["c0", "c1", "2", "divide", "subtract", "1", "greater", "c2", "logical_not", "logical_and"];
        let mut stop = condition(&words, 3).expect("a condition");
        assert_eq!(
            [[3.1, 4.0, 0.0], [3.0, 4.0, 0.0], [9.0, 4.0, 0.5]].map(|row| stop.holds(&row)),
            [true, false, false]
        );
    }

    #[test]
    fn what_is_not_a_number_compares_and_counts_as_in_python() {
        let nan = [f64::NAN];
        for (words, holds) in [
            (&["c0", "0", "greater"][..], false),
            (&["c0", "c0", "equal"], false),
            (&["c0", "c0", "not_equal"], true),
            (&["c0", "1", "minimum", "isfinite"], false),
            (&["c0"], true),
            (&["c0", "logical_not"], false),
        ] {
            assert_eq!(condition(words, 1).expect("a condition").holds(&nan), holds, "{words:?}");
        }
    }

    #[test]
    fn programs_that_do_not_fit_are_refused() {
        for words in [&[][..], &["add"], &["1", "2"], &["1", "add"], &["c3"], &["sin"]] {
            assert!(condition(words, 3).is_none(), "{words:?}");
        }
    }
}
