//! Runs programs: one header line per step, errors that name the command and what is missing.

use std::io::ErrorKind;
use std::path::Path;
use std::process::{Command, ExitStatus, Output, Stdio};

use anyhow::{Context, Error, Result, ensure};

/// Prints the one-line header of a step.
pub fn header(title: &str) {
    eprintln!("==> {title}");
}

/// Says that a step has nothing to do.
pub fn up_to_date(what: &str) {
    eprintln!("==> {what}: up to date");
}

/// Runs a command whose output goes to the terminal.
///
/// # Errors
/// When the program is missing or does not end with success.
pub fn run(title: &str, command: &mut Command) -> Result<()> {
    header(title);
    let status = status(command)?;
    ensure!(status.success(), "`{}` failed: {status}", display(command));
    Ok(())
}

/// Runs a command whose output goes to the terminal and returns how it ended.
///
/// # Errors
/// When the program is missing.
pub fn status(command: &mut Command) -> Result<ExitStatus> {
    command.status().map_err(|error| not_started(command, error))
}

/// Runs a command and returns how it ended and its standard output; its standard error goes where the command says.
///
/// # Errors
/// When the program is missing.
pub fn status_and_text(command: &mut Command) -> Result<(ExitStatus, Vec<u8>)> {
    let child =
        command.stdin(Stdio::null()).stdout(Stdio::piped()).spawn().map_err(|error| not_started(command, error))?;
    let output = child.wait_with_output()?;
    Ok((output.status, output.stdout))
}

/// Runs a command and collects what it prints.
///
/// # Errors
/// When the program is missing.
pub fn output(command: &mut Command) -> Result<Output> {
    command.stdin(Stdio::null()).output().map_err(|error| not_started(command, error))
}

/// Runs a command and returns its standard output as text.
///
/// # Errors
/// When the program is missing, does not end with success (its last words are in the message), or prints no UTF-8.
pub fn text(command: &mut Command) -> Result<String> {
    let output = output(command)?;
    let stderr = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "`{}` failed: {}\n{}", display(command), output.status, stderr.trim_end());
    String::from_utf8(output.stdout).with_context(|| format!("`{}` printed no UTF-8", display(command)))
}

/// The command as one would type it, without the folder of its program.
pub fn display(command: &Command) -> String {
    let program = Path::new(command.get_program()).file_name().unwrap_or(command.get_program());
    let words = std::iter::once(program).chain(command.get_args());
    words.map(|word| word.to_string_lossy().into_owned()).collect::<Vec<_>>().join(" ")
}

fn not_started(command: &Command, error: std::io::Error) -> Error {
    let program = command.get_program().to_string_lossy().into_owned();
    let missing = error.kind() == ErrorKind::NotFound;
    let error = Error::new(error).context(format!("cannot start `{program}`"));
    if missing { error.context(format!("`{program}` is not installed")) } else { error }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_program_is_named() {
        let error = text(&mut Command::new("no-such-program-here")).unwrap_err();
        assert!(format!("{error:#}").starts_with("`no-such-program-here` is not installed"));
    }

    #[test]
    fn a_failure_carries_the_command_and_its_last_words() {
        let error = text(Command::new(env!("CARGO")).arg("no-such-subcommand")).unwrap_err();
        let message = format!("{error:#}");
        assert!(message.starts_with("`cargo no-such") && message.contains("no-such-subcommand"), "{message}");
    }
}
