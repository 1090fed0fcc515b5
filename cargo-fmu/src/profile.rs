//! The release profile of a project, as far as it makes or breaks an FMU.

use std::ffi::OsString;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use toml::{Table, Value};

/// Release profile for a small library without symbol names; a key that the project sets keeps its value.
const DEFAULTS: [(&str, &str); 3] = [("codegen-units", "1"), ("lto", "\"fat\""), ("strip", "true")];

/// Words for `cargo rustc` that fill what `[profile.release]` of the workspace's manifest leaves open.
///
/// # Errors
/// When the manifest cannot be read, or asks for `panic = "abort"`.
pub fn arguments(manifest: &Path) -> Result<Vec<OsString>> {
    let shown = manifest.display();
    let text = fs::read_to_string(manifest).with_context(|| format!("cannot read `{shown}`"))?;
    let table: Table = text.parse().with_context(|| format!("`{shown}` is no TOML"))?;
    let release = table.get("profile").and_then(|profile| profile.get("release"));
    let set = |key: &str| release.and_then(|release| release.get(key));
    ensure!(
        set("panic").and_then(Value::as_str) != Some("abort"),
        "`panic = \"abort\"` in `[profile.release]` of `{shown}`: a panic of the model would end the importer\n\
         hint: remove that line; a panic is then an error of one instance"
    );
    let open = DEFAULTS.iter().filter(|(key, _)| set(key).is_none());
    Ok(open.flat_map(|(key, value)| ["--config".into(), format!("profile.release.{key}={value}").into()]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(manifest: &str) -> Result<Vec<OsString>> {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("Cargo.toml");
        fs::write(&file, manifest).unwrap();
        arguments(&file)
    }

    #[test]
    fn only_what_is_left_open_is_filled() {
        assert_eq!(words("[package]\nname = \"a\"").unwrap().len(), 6);
        let some = words("[profile.release]\nlto = \"thin\"\nstrip = false").unwrap();
        assert_eq!(some, ["--config", "profile.release.codegen-units=1"]);
        assert!(words("[profile.release]\nlto = \"fat\"\ncodegen-units = 1\nstrip = true\n").unwrap().is_empty());
    }

    #[test]
    fn a_profile_that_aborts_is_refused() {
        let error = words("[profile.release]\npanic = \"abort\"").unwrap_err().to_string();
        assert!(error.contains("`panic = \"abort\"` in `[profile.release]` of `") && error.contains("hint: remove"));
        words("[profile.dev]\npanic = \"abort\"").unwrap();
        words("[profile.release]\npanic = \"unwind\"").unwrap();
    }
}
