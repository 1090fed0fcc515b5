//! The bank in files: read at initialization, written after learning and on request.

use std::path::Path;

use control_blocks::{FileParameter, ParameterError};

use crate::bank::pattern_bank::PatternBank;
use crate::bank::save::save;
use crate::bank::{bank_file, records};
use crate::interface::{BankOutput, BankStatus, Format, Parameters};
use crate::path::programmed_path::ProgrammedPath;

/// Largest file that is read, bytes.
const BYTES_MAX: u64 = 64 << 20;

/// Reads the bank that `bank.import` names, if it names one; else says whether the bank was computed.
///
/// # Errors
/// Names the file and what is wrong with it; nothing is taken over then.
pub fn start(
    p: &Parameters,
    resources: Option<&Path>,
    path: &ProgrammedPath,
    bank: &mut PatternBank,
) -> Result<BankOutput, ParameterError> {
    let computed = bank.patterns().len();
    match (p.bank.import.is_empty(), computed) {
        (true, 0) => return Ok(BankOutput::START),
        (true, _) => {
            let message = format!("computed {computed} patterns from the nominal drive");
            return Ok(BankOutput { status: BankStatus::Computed, patterns: computed as i32, message });
        }
        _ => {}
    }
    let file = FileParameter {
        name: "bank.import",
        file: &p.bank.import,
        hint: "learn on this path with these parameters, or leave `bank.import` empty",
    };
    let bytes = file.read(resources, BYTES_MAX)?;
    let read = bank_file::decode(&bytes).or_else(|| records::decode(&bytes, bank, path));
    let read = read.unwrap_or_else(|| Err("it has none of the formats of a bank".to_owned()));
    let wrong = |what| file.wrong(format!("a bank for this path and robot: {what}"));
    bank.take_over(&read.map_err(wrong)?, p.limits.pulses_max).map_err(wrong)?;
    let patterns = bank.patterns().len();
    let message = format!("read {patterns} patterns from `{}`", p.bank.import);
    Ok(BankOutput { status: BankStatus::Imported, patterns: patterns as i32, message })
}

/// Writes the bank to the file that `bank.export` names, if it names one; the message says what became of it.
///
/// False when the file cannot be written; the bank stays where it is.
pub fn export(p: &Parameters, path: &ProgrammedPath, bank: &PatternBank, output: &mut BankOutput) -> bool {
    if p.bank.export.is_empty() {
        "not written: `bank.export` is empty".clone_into(&mut output.message);
        return true;
    }
    let bytes = match p.bank.format {
        Format::Full => Ok(bank_file::encode(bank)),
        Format::Records => records::encode(bank, path),
    };
    let file = &p.bank.export;
    match bytes.and_then(|bytes| save(Path::new(file), &bytes).map_err(|error| error.to_string())) {
        Ok(()) => {
            output.message = format!("wrote {} patterns to `{file}`", bank.patterns().len());
            output.status = BankStatus::Exported;
            true
        }
        Err(what) => {
            let hint = "hint: The patterns remain in use. The mode Export tries again.";
            output.message = format!("`bank.export` = `{file}`: not written: {what}\n{hint}");
            output.status = BankStatus::ExportFailed;
            false
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bank::pattern_bank::tests::numbered;
    use crate::learning::pattern::tests::straight;

    fn imported(file: &Path, length: f64) -> Result<(PatternBank, BankOutput), String> {
        let (mut p, path) = (Parameters::START, straight(length));
        p.bank.import = file.to_str().unwrap().to_owned();
        let mut bank = PatternBank::plan(&p, &path).unwrap();
        let output = start(&p, None, &path, &mut bank).map_err(|error| error.to_string())?;
        Ok((bank, output))
    }

    fn exported(file: &Path, format: Format, bank: &PatternBank) -> (bool, BankOutput) {
        let (mut p, mut output) = (Parameters::START, BankOutput::START);
        (p.bank.export, p.bank.format) = (file.to_str().unwrap().to_owned(), format);
        (export(&p, &straight(0.1), bank, &mut output), output)
    }

    #[test]
    fn both_formats_are_restored() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("bank.bin");
        let bank = numbered(|k| (k % 50) as f64);
        for format in [Format::Full, Format::Records] {
            let (done, output) = exported(&file, format, &bank);
            assert!(done && output.status == BankStatus::Exported, "{output:?}");
            assert!(output.message.contains("wrote 5 patterns"), "{output:?}");
            let (read, output) = imported(&file, 0.1).unwrap();
            assert_eq!(read, bank);
            assert!(output.message.contains("read 5 patterns") && output.patterns == 5, "{output:?}");
            let message = imported(&file, 0.2).unwrap_err();
            assert!(message.contains("parameter `bank.import`") && message.contains("another path"), "{message}");
        }
    }

    #[test]
    fn what_is_no_bank_is_rejected_and_what_cannot_be_written_is_reported() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("path.json");
        std::fs::write(&file, "{}").unwrap();
        let message = imported(&file, 0.1).unwrap_err();
        assert!(message.contains("none of the formats") && message.contains("hint:"), "{message}");
        let missing = folder.path().join("missing").join("bank.bin");
        let (done, output) = exported(&missing, Format::Full, &numbered(|k| k as f64));
        assert!(!done && output.status == BankStatus::ExportFailed);
        assert!(output.message.contains("not written: No such file") && output.message.contains("hint:"));
    }

    #[test]
    fn the_banks_of_the_resources_belong_to_the_test_piece() {
        let resources = Path::new(env!("CARGO_MANIFEST_DIR")).join("resources");
        for (file, mut p, io_delay) in [("bank.bin", Parameters::START, 1), ("bank_paper.bin", Parameters::PAPER, 0)] {
            (p.io_delay, p.bank.import) = (io_delay, file.to_owned());
            let path = crate::path::path_file::read(&p, Some(&resources)).unwrap();
            let mut bank = PatternBank::plan(&p, &path).unwrap();
            let output = start(&p, Some(&resources), &path, &mut bank).unwrap();
            assert_eq!((output.status, output.patterns), (BankStatus::Imported, 5));
        }
    }

    #[test]
    fn without_a_file_the_bank_is_empty_or_computed() {
        let (p, path) = (Parameters::START, straight(0.1));
        let mut empty = PatternBank::plan(&p, &path).unwrap();
        assert_eq!(start(&p, None, &path, &mut empty).unwrap(), BankOutput::START);
        let output = start(&p, None, &path, &mut numbered(|_| 0.0)).unwrap();
        assert_eq!((output.status, output.patterns), (BankStatus::Computed, 5));
        assert_eq!(output.message, "computed 5 patterns from the nominal drive");
        let mut output = BankOutput::START;
        assert!(export(&p, &path, &empty, &mut output) && output.status == BankOutput::START.status);
        assert_eq!(output.message, "not written: `bank.export` is empty");
    }
}
