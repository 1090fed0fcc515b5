//! One line of a CL file.

/// Millimeters per minute in a meter per second.
const MM_PER_MINUTE: f64 = 1e-3 / 60.0;
/// Meters in an inch.
const INCH: f64 = 0.0254;
/// No path has larger numbers; in the unit of the file.
const NUMBER_MAX: f64 = 1e6;
/// Words that say nothing about the path.
const REMARKS: [&str; 9] = ["PARTNO", "PPRINT", "REMARK", "MACHIN", "MULTAX", "LOADTL", "SPINDL", "COOLNT", "TOOLNO"];

/// Unit of the lengths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Units {
    /// Millimeters.
    Millimetre,
    /// Inches.
    Inch,
}

impl Units {
    /// Meters in the unit.
    pub fn metre(self) -> f64 {
        match self {
            Self::Millimetre => 1e-3,
            Self::Inch => INCH,
        }
    }
}

/// Statement of a line of CL data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Statement {
    /// A statement without effect on the path.
    Remark,
    /// `UNITS/MM` or `UNITS/INCH`.
    Units(Units),
    /// `CUTTER/d`: diameter in the unit of the file.
    Cutter(f64),
    /// `FEDRAT/v,MMPM` or `FEDRAT/v,IPM`: feed, m/s.
    Feed(f64),
    /// `GOTO/x,y,z,i,j,k`: contact point in the unit of the file and normal.
    Goto([f64; 6]),
    /// `FINI`.
    Fini,
}

/// Error in a line, and the instruction that corrects it.
pub type Wrong = (String, &'static str);

/// The statement in `line`, none in an empty line or a comment.
///
/// # Errors
/// If the statement is unknown, or if a number or unit in it is wrong.
pub fn parse(line: &str) -> Result<Option<Statement>, Wrong> {
    let text = line.split("$$").next().unwrap_or_default().trim();
    if text.is_empty() {
        return Ok(None);
    }
    let (word, rest) = text.split_once('/').unwrap_or((text, ""));
    let word = word.trim().to_ascii_uppercase();
    let statement = match word.as_str() {
        "GOTO" => Statement::Goto(numbers(rest)?),
        "UNITS" => Statement::Units(units(rest)?),
        "CUTTER" => Statement::Cutter(positive("CUTTER", rest.split(',').next().unwrap_or_default())?),
        "FEDRAT" => Statement::Feed(feed(rest)?),
        "FINI" => Statement::Fini,
        known if REMARKS.contains(&known) => Statement::Remark,
        _ => {
            let hint = "Use PARTNO, UNITS, CUTTER, FEDRAT, GOTO and FINI, and comments after `$$`.";
            return Err((format!("`{}` is not a statement", shown(text)), hint));
        }
    };
    Ok(Some(statement))
}

/// At most 40 characters of the file, without control characters.
fn shown(text: &str) -> String {
    text.chars().take(40).map(|c| if c.is_control() { '?' } else { c }).collect()
}

fn numbers(rest: &str) -> Result<[f64; 6], Wrong> {
    let hint = "Write `GOTO/x,y,z,i,j,k`: contact point and unit normal.";
    let count = rest.split(',').count();
    if count != 6 {
        return Err((format!("GOTO has `{count}` numbers, must have `6`"), hint));
    }
    let mut numbers = [0.0; 6];
    for (slot, field) in numbers.iter_mut().zip(rest.split(',')) {
        *slot = number(field).ok_or_else(|| (format!("`{}` is not a finite number", shown(field.trim())), hint))?;
    }
    Ok(numbers)
}

fn units(rest: &str) -> Result<Units, Wrong> {
    match rest.trim().to_ascii_uppercase().as_str() {
        "MM" => Ok(Units::Millimetre),
        "INCH" | "IN" | "INCHES" => Ok(Units::Inch),
        other => Err((format!("the unit `{}` is unknown", shown(other)), "Write `UNITS/MM` or `UNITS/INCH`.")),
    }
}

/// m/s.
fn feed(rest: &str) -> Result<f64, Wrong> {
    let (value, unit) = rest.split_once(',').unwrap_or((rest, "MMPM"));
    let scale = match unit.trim().to_ascii_uppercase().as_str() {
        "MMPM" => MM_PER_MINUTE,
        "IPM" => INCH / 60.0,
        other => return Err((format!("the feed unit `{}` is unknown", shown(other)), "Write `MMPM` or `IPM`.")),
    };
    Ok(scale * positive("FEDRAT", value)?)
}

fn positive(word: &str, field: &str) -> Result<f64, Wrong> {
    number(field)
        .filter(|value| *value > 0.0)
        .ok_or_else(|| (format!("{word} is `{}`, must be positive", shown(field.trim())), "Write a number above 0."))
}

fn number(field: &str) -> Option<f64> {
    field.trim().parse().ok().filter(|value: &f64| value.is_finite() && value.abs() <= NUMBER_MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statements_in_any_case_with_blanks_and_comments() {
        let cases = [
            ("  goto / 1, -2 ,3e-1,0,0,1 $$ first", Statement::Goto([1.0, -2.0, 0.3, 0.0, 0.0, 1.0])),
            ("UNITS/MM\r", Statement::Units(Units::Millimetre)),
            ("units/inch", Statement::Units(Units::Inch)),
            ("CUTTER/1,0.5", Statement::Cutter(1.0)),
            ("FEDRAT/120,MMPM", Statement::Feed(2e-3)),
            ("PARTNO/LED LENS 7", Statement::Remark),
            ("FINI", Statement::Fini),
        ];
        for (line, expected) in cases {
            assert_eq!(parse(line), Ok(Some(expected)), "{line}");
        }
        assert_eq!(parse(" $$ GOTO/1"), Ok(None));
        assert_eq!(parse(""), Ok(None));
    }

    #[test]
    fn a_wrong_line_says_what_is_wrong() {
        let cases = [
            ("GOTO/1,2,3", "GOTO has `3` numbers, must have `6`"),
            ("GOTO/1,2,nan,0,0,1", "`nan` is not a finite number"),
            ("GOTO/1,2,x,0,0,1", "`x` is not a finite number"),
            ("GOTO/1,2,1e300,0,0,1", "`1e300` is not a finite number"),
            ("UNITS/CM", "the unit `CM` is unknown"),
            ("FEDRAT/0,MMPM", "FEDRAT is `0`, must be positive"),
            ("FEDRAT/1,MPS", "the feed unit `MPS` is unknown"),
            ("CUTTER/-1", "CUTTER is `-1`, must be positive"),
            ("RAPID", "`RAPID` is not a statement"),
            ("\u{1}\u{2}", "`??` is not a statement"),
        ];
        for (line, expected) in cases {
            assert_eq!(parse(line).unwrap_err().0, expected);
        }
    }
}
