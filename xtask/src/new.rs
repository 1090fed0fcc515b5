//! `cargo xtask new`: a controller with its plant, scenario and tests from `templates/controller`.
//!
//! It creates the files of the template and adds an entry to two lists. It overwrites nothing.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};

const TEMPLATE: &str = "templates/controller";

/// Names that are not allowed: keywords of Rust, then those of Python.
const KEYWORDS: &str = "abstract as async await become box break const continue crate do dyn else enum extern false \
                        final fn for gen if impl in let loop macro match mod move mut override priv pub ref return \
                        self static struct super trait true try type typeof unsafe unsized use virtual where while \
                        yield and assert class def del elif except finally from global import is lambda none nonlocal \
                        not or pass raise with";

/// Files to write: paths and contents.
type Files = Vec<(PathBuf, String)>;

/// A list in a file that names every controller or plant.
struct List {
    file: &'static str,
    begin: &'static str,
    end: &'static str,
    separator: &'static str,
}

const MEMBERS: List = List { file: "Cargo.toml", begin: "members = [", end: "]", separator: ", " };
const PLANTS: List = List { file: "plants/__init__.py", begin: "PLANTS = {\n", end: "}\n", separator: ",\n" };

/// Makes the controller `name` in the checkout `root`, and prints the next steps.
///
/// # Errors
/// When the name is not allowed, or when a file of that name exists.
pub fn run(root: &Path, name: &str) -> Result<()> {
    let files = made(root, name)?;
    let lists = listed(root, name)?;
    for (path, text) in files.iter().chain(&lists) {
        let path = root.join(path);
        let folder = path.parent().unwrap_or(root);
        fs::create_dir_all(folder).with_context(|| format!("cannot make `{}`", folder.display()))?;
        fs::write(&path, text).with_context(|| format!("cannot write `{}`", path.display()))?;
    }
    println!("{}", next_steps(name));
    Ok(())
}

fn next_steps(name: &str) -> String {
    format!(
        "created `fmu-{name}/`: variables in `src/interface.rs`, the control law in `src/controller.rs`\n\
         created `plants/{name}.py`, `.xml`, `_parameters.py`, `scenarios/{name}.toml`, `tests/acceptance/test_{name}.py`\n\
         added to `{}` and `{}`\n\
         \n\
         next:\n\
         cargo xtask fmu {name}\n\
         cosim run {name} --plot {name}.png\n\
         cargo test -p fmu-{name}",
        MEMBERS.file, PLANTS.file
    )
}

/// Files of the template with the name filled in.
fn made(root: &Path, name: &str) -> Result<Files> {
    let class = camel_case(name);
    let template = root.join(TEMPLATE);
    let mut files = Files::new();
    for source in sources(&template)? {
        let text = fs::read_to_string(&source).with_context(|| format!("cannot read `{}`", source.display()))?;
        files.push((target(source.strip_prefix(&template)?, name)?, text));
    }
    check(name, &files)?;
    refuse_existing(root, name, &files)?;
    files.iter_mut().for_each(|(_, text)| *text = text.replace("__name__", name).replace("__Name__", &class));
    Ok(files)
}

fn refuse_existing(root: &Path, name: &str, files: &Files) -> Result<()> {
    // a folder in `plants` would hide the module of the same name
    let folders = [PathBuf::from(format!("fmu-{name}")), Path::new("plants").join(name)];
    let mut paths = folders.iter().chain(files.iter().map(|(path, _)| path));
    match paths.find(|path| root.join(path).exists()) {
        Some(path) => bail!("`{}` exists, and nothing is overwritten\nhint: Use another name.", path.display()),
        None => Ok(()),
    }
}

/// Path of a file of the template in the checkout.
fn target(relative: &Path, name: &str) -> Result<PathBuf> {
    if let Ok(inside) = relative.strip_prefix("crate") {
        return Ok(Path::new(&format!("fmu-{name}")).join(inside));
    }
    let file = relative.to_str().unwrap_or_default();
    Ok(match file {
        "plant.py" | "plant.xml" | "plant_parameters.py" => format!("plants/{}", file.replacen("plant", name, 1)),
        "scenario.toml" => format!("scenarios/{name}.toml"),
        "acceptance.py" => format!("tests/acceptance/test_{name}.py"),
        _ => bail!("`{TEMPLATE}/{}` does not belong to a controller", relative.display()),
    }
    .into())
}

fn sources(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| format!("cannot list `{}`", folder.display()))? {
        let path = entry?.path();
        if path.is_dir() { found.extend(sources(&path)?) } else { found.push(path) }
    }
    found.sort();
    Ok(found)
}

/// Checks that the name is valid for a crate and a Python module, and that its type name is new.
fn check(name: &str, template: &Files) -> Result<()> {
    let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    ensure!(
        name.starts_with(|c: char| c.is_ascii_lowercase()) && name.chars().all(plain),
        "`{name}` is no name for a controller\nhint: Use lower-case letters, digits and `_`, a letter first, such as `feed_drive`."
    );
    ensure!(
        KEYWORDS.split_whitespace().all(|word| word != name),
        "`{name}` is no name for a controller: a keyword of Rust or Python\nhint: Use another name."
    );
    let class = camel_case(name);
    let taken = |text: &str| text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').any(|word| word == class);
    ensure!(
        !template.iter().any(|(_, text)| taken(text)),
        "`{name}` is no name for a controller: `{class}` means something else in its files\nhint: Use another name."
    );
    Ok(())
}

fn camel_case(name: &str) -> String {
    let capital = |word: &str| word[..1].to_ascii_uppercase() + &word[1..];
    name.split('_').filter(|word| !word.is_empty()).map(capital).collect()
}

/// Lists with the new controller.
fn listed(root: &Path, name: &str) -> Result<Files> {
    let entries =
        [(&MEMBERS, format!("\"fmu-{name}\"")), (&PLANTS, format!("    \"{name}\": \"{}\"", camel_case(name)))];
    let entered = entries.map(|(list, entry)| {
        let text = fs::read_to_string(root.join(list.file)).with_context(|| format!("cannot read `{}`", list.file))?;
        let text = list.with(&text, &entry);
        let text = text.with_context(|| format!("`{}` holds no list `{}`", list.file, list.begin.trim_end()))?;
        Ok((PathBuf::from(list.file), text))
    });
    entered.into_iter().collect()
}

impl List {
    /// Returns the file with an additional entry, in alphabetical order.
    fn with(&self, text: &str, entry: &str) -> Option<String> {
        let Self { begin, end, separator, .. } = self;
        let (head, rest) = text.split_once(begin)?;
        let (inside, tail) = rest.split_once(end)?;
        let mut entries: Vec<_> = inside.split_terminator(separator).chain([entry]).collect();
        entries.sort_unstable();
        let last = if inside.ends_with(separator) { separator } else { "" };
        Some(format!("{head}{begin}{}{last}{end}{tail}", entries.join(separator)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn root() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
    }

    fn refusal(name: &str) -> String {
        made(&root(), name).unwrap_err().to_string()
    }

    #[test]
    fn a_name_is_that_of_a_crate_and_of_a_python_module() {
        for name in ["", "2d", "Trial", "two-words", "a b", "a.b", "../up", "größe", "_trial"] {
            assert!(refusal(name).contains("hint: Use lower-case letters"), "{name}");
        }
        for name in ["match", "loop", "lambda", "none"] {
            assert!(refusal(name).contains("a keyword of Rust or Python"), "{name}");
        }
    }

    #[test]
    fn a_name_means_nothing_else_in_the_files_of_the_template() {
        for name in ["model", "controller", "plant", "option", "state"] {
            assert!(refusal(name).contains("means something else"), "{name}");
        }
    }

    #[test]
    fn nothing_is_overwritten() {
        for (path, told) in [
            ("fmu-trial/notes.txt", "fmu-trial"),
            ("plants/trial.xml", "plants/trial.xml"),
            ("plants/trial/notes.txt", "plants/trial"),
            ("scenarios/trial.toml", "scenarios/trial.toml"),
            ("tests/acceptance/test_trial.py", "tests/acceptance/test_trial.py"),
        ] {
            let folder = tempfile::tempdir().unwrap();
            copy(&root().join(TEMPLATE), &folder.path().join(TEMPLATE));
            fs::create_dir_all(folder.path().join(path).parent().unwrap()).unwrap();
            fs::write(folder.path().join(path), "mine").unwrap();
            let error = run(folder.path(), "trial").unwrap_err().to_string();
            assert!(error.starts_with(&format!("`{told}` exists")), "{error}");
        }
        assert!(refusal("dob").starts_with("`fmu-dob` exists"), "a controller of the project");
        for folder in ["tools", "bare"] {
            assert!(refusal(folder).starts_with(&format!("`plants/{folder}` exists")), "a folder of the plants");
        }
    }

    #[test]
    fn every_placeholder_is_filled_and_only_two_files_are_changed() {
        let (here, changed) = (made(&root(), "feed_drive").unwrap(), listed(&root(), "feed_drive").unwrap());
        let paths: Vec<_> = changed.iter().map(|(path, _)| path.to_str().unwrap().to_owned()).collect();
        assert_eq!(paths, ["Cargo.toml", "plants/__init__.py"]);
        for (path, text) in &here {
            assert!(!text.contains("__name__") && !text.contains("__Name__"), "{}", path.display());
        }
        let lib = &here.iter().find(|(path, _)| path.ends_with("fmu-feed_drive/src/lib.rs")).unwrap().1;
        assert!(lib.contains("name: \"FeedDrive\""));
    }

    #[test]
    fn a_list_gets_one_entry_in_its_place() {
        let members = "members = [\"a\", \"fmu-dob\", \"xtask\"]\n";
        assert_eq!(MEMBERS.with(members, "\"fmu-trial\"").unwrap(), members.replace("\"x", "\"fmu-trial\", \"x"));
        let plants = "PLANTS = {\n    \"slide\": \"Slide\",\n}\nrest\n";
        let both = "PLANTS = {\n    \"cart\": \"Cart\",\n    \"slide\": \"Slide\",\n}\nrest\n";
        assert_eq!(PLANTS.with(plants, "    \"cart\": \"Cart\"").unwrap(), both);
        assert_eq!(PLANTS.with("NAMES = {}\n", "x"), None);
    }

    fn copy(from: &Path, to: &Path) {
        for source in sources(from).unwrap() {
            let path = to.join(source.strip_prefix(from).unwrap());
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::copy(source, path).unwrap();
        }
    }
}
