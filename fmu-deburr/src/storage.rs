//! The bank in files: read at initialisation, written after learning and on request.

use std::path::Path;

use control_blocks::ParameterError;

use crate::controller::Controller;
use crate::file::FileParameter;
use crate::parameters::Format;
use crate::save::save;
use crate::{bank_file, records};

/// Reads the bank that `bank.import` names; tells what was read.
///
/// # Errors
/// Names the file and what is wrong with it; nothing is taken over then.
pub fn import(
    file: &str,
    resources: Option<&Path>,
    controller: &mut Controller,
    pulses_max: f64,
) -> Result<String, ParameterError> {
    let parameter = FileParameter {
        name: "bank.import",
        file,
        hint: "learn on this path with these parameters, or leave `bank.import` empty",
    };
    let bytes = parameter.read(resources)?;
    let read = bank_file::decode(&bytes).or_else(|| records::decode(&bytes, controller.bank(), controller.path()));
    let read = read.unwrap_or_else(|| Err("it is in none of the formats of a bank".to_owned()));
    let wrong = |what| parameter.wrong(format!("a bank for this path and robot: {what}"));
    controller.bank_mut().take_over(&read.map_err(wrong)?, pulses_max).map_err(wrong)?;
    Ok(format!("read {} patterns from `{file}`", controller.bank().patterns().len()))
}

/// Writes the bank; tells what was written.
///
/// # Errors
/// Names the file and what is wrong.
pub fn export(file: &str, format: Format, controller: &Controller) -> Result<String, String> {
    let (bank, path) = (controller.bank(), controller.path());
    let bytes = match format {
        Format::Full => Ok(bank_file::encode(bank)),
        Format::Records => records::encode(bank, path),
    };
    let place = Path::new(file);
    let written = bytes.and_then(|bytes| save(place, &bytes).map_err(|error| error.to_string()));
    written.map_err(|what| {
        format!("`bank.export` = `{file}`: not written: {what}\nhint: the patterns are still here; the mode Export tries again")
    })?;
    Ok(format!("wrote {} patterns to `{file}`", bank.patterns().len()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::file::place::Place;
    use crate::parameters::Parameters;
    use crate::pattern::tests::straight;

    fn controller(length: f64) -> Controller {
        Controller::new(&Parameters::DEFAULT, straight(length), "path.json").unwrap()
    }

    #[test]
    fn both_formats_come_back() {
        let place = Place::new();
        for format in [Format::Full, Format::Records] {
            let mut from = controller(0.1);
            *from.bank_mut() = crate::bank::tests::numbered(|k| (k % 50) as f64);
            let file = place.path().join("bank.bin");
            let file = file.to_str().unwrap();
            assert!(export(file, format, &from).unwrap().contains("wrote 5 patterns"));
            let mut to = controller(0.1);
            assert!(import(file, None, &mut to, 32_767.0).unwrap().contains("read 5 patterns"));
            assert_eq!(to.bank(), from.bank());
            let message = import(file, None, &mut controller(0.2), 32_767.0).unwrap_err().to_string();
            assert!(message.contains("parameter `bank.import`") && message.contains("another path"), "{message}");
        }
    }

    #[test]
    fn what_is_no_bank_is_refused_and_what_cannot_be_written_is_told() {
        let place = Place::new();
        let file = place.path().join("path.json");
        std::fs::write(&file, "{}").unwrap();
        let message = import(file.to_str().unwrap(), None, &mut controller(0.1), 1e9).unwrap_err().to_string();
        assert!(message.contains("none of the formats") && message.contains("hint:"), "{message}");
        let missing = place.path().join("missing").join("bank.bin");
        let message = export(missing.to_str().unwrap(), Format::Full, &controller(0.1)).unwrap_err();
        assert!(message.contains("not written: No such file") && message.contains("hint:"), "{message}");
    }
}
