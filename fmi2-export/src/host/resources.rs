//! The resource location of an instance: importers write it in many forms.

use std::path::PathBuf;

/// How paths are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Platform {
    /// Slashes from one root; any bytes but NUL.
    Unix,
    /// Drives and servers; UTF-8.
    Windows,
}

const HERE: Platform = if cfg!(windows) { Platform::Windows } else { Platform::Unix };

/// Folder of a `fmuResourceLocation`; `None` for an empty one.
///
/// Takes `file:/x`, `file:///x`, `file:////x`, `file://localhost/x`, `file:///C:/x`, `file://server/share/x`, a trailing
/// slash, percent-encoded bytes and plain paths.
///
/// # Errors
/// Why the location names no folder of this platform.
pub fn folder(location: &[u8]) -> Result<Option<PathBuf>, String> {
    let path = path(location, HERE).map_err(|reason| {
        format!("the resource location `{}` {reason}; the instance has no resources", String::from_utf8_lossy(location))
    })?;
    Ok((!path.is_empty()).then(|| to_path(path)))
}

#[cfg(unix)]
fn to_path(path: Vec<u8>) -> PathBuf {
    use std::os::unix::ffi::OsStringExt;
    std::ffi::OsString::from_vec(path).into()
}

#[cfg(not(unix))]
fn to_path(path: Vec<u8>) -> PathBuf {
    String::from_utf8_lossy(&path).into_owned().into()
}

/// The bytes of the path of a location, without a slash at its end.
fn path(location: &[u8], platform: Platform) -> Result<Vec<u8>, &'static str> {
    let path = match uri(location)? {
        None => location.to_vec(),
        Some((host, rest)) => on_platform(&percent_decode(host), &percent_decode(rest), platform)?,
    };
    if path.contains(&0) {
        return Err("holds a NUL");
    }
    if platform == Platform::Windows && std::str::from_utf8(&path).is_err() {
        return Err("is not UTF-8");
    }
    Ok(without_end(path, platform))
}

/// Host and path.
type Uri<'a> = (&'a [u8], &'a [u8]);

/// The parts of a `file:` URI; `None` for a plain path.
fn uri(location: &[u8]) -> Result<Option<Uri<'_>>, &'static str> {
    let colon = location.iter().position(|byte| *byte == b':').unwrap_or(0);
    if location[..colon].eq_ignore_ascii_case(b"file") {
        let rest = &location[colon + 1..];
        let Some(rest) = rest.strip_prefix(b"//") else { return Ok(Some((b"", rest))) };
        return Ok(Some(rest.split_at(rest.iter().position(|byte| *byte == b'/').unwrap_or(rest.len()))));
    }
    // one letter is a drive
    let is_scheme =
        colon > 1 && location[..colon].iter().all(|byte| byte.is_ascii_alphanumeric() || b"+-.".contains(byte));
    if is_scheme && location[colon..].starts_with(b"://") { Err("is of another scheme than `file:`") } else { Ok(None) }
}

/// The path of a URI as the platform writes it.
fn on_platform(host: &[u8], path: &[u8], platform: Platform) -> Result<Vec<u8>, &'static str> {
    let is_here = host.is_empty() || host.eq_ignore_ascii_case(b"localhost");
    let slashes = path.iter().take_while(|byte| **byte == b'/').count();
    let bare = &path[slashes..];
    match platform {
        Platform::Unix if is_here => Ok([if slashes > 0 { &b"/"[..] } else { b"" }, bare].concat()),
        Platform::Unix => Err("names another computer"),
        // `file://C:/x`, which should be `file:///C:/x`
        Platform::Windows if is_drive(host) => Ok(backslashes(&[host, path].concat())),
        Platform::Windows if !is_here => Ok(backslashes(&[b"//", host, path].concat())),
        // `file:////server/share`
        Platform::Windows if slashes > 1 && !is_drive(bare) => Ok(backslashes(&[b"//", bare].concat())),
        Platform::Windows => Ok(backslashes(if is_drive(bare) { bare } else { path })),
    }
}

fn is_drive(path: &[u8]) -> bool {
    matches!(path, [letter, b':', ..] if letter.is_ascii_alphabetic())
}

fn backslashes(path: &[u8]) -> Vec<u8> {
    path.iter().map(|byte| if *byte == b'/' { b'\\' } else { *byte }).collect()
}

/// Roots keep the slash at their end.
fn without_end(mut path: Vec<u8>, platform: Platform) -> Vec<u8> {
    let root = if platform == Platform::Windows && is_drive(&path) { 3 } else { 1 };
    let is_end = |byte: u8| byte == b'/' || (platform == Platform::Windows && byte == b'\\');
    while path.len() > root && path.last().copied().is_some_and(is_end) {
        path.pop();
    }
    path
}

/// `%` without two hexadecimal digits after it is kept.
fn percent_decode(text: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text;
    while let [first, tail @ ..] = rest {
        match tail {
            [high, low, after @ ..]
                if *first == b'%'
                    && let Some(byte) = hexadecimal(*high, *low) =>
            {
                bytes.push(byte);
                rest = after;
            }
            _ => {
                bytes.push(*first);
                rest = tail;
            }
        }
    }
    bytes
}

fn hexadecimal(high: u8, low: u8) -> Option<u8> {
    let digit = |byte: u8| char::from(byte).to_digit(16);
    u8::try_from(16 * digit(high)? + digit(low)?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use Platform::{Unix, Windows};

    fn text(location: &[u8], platform: Platform) -> String {
        String::from_utf8(path(location, platform).unwrap()).unwrap()
    }

    #[test]
    fn every_way_importers_write_it_on_unix() {
        for location in [
            "file:/data/x y/resources",
            "file:///data/x%20y/resources",
            "file:////data/x%20y/resources",
            "file://localhost/data/x%20y/resources/",
            "FILE:///data/x%20y/resources/",
            "/data/x y/resources",
        ] {
            assert_eq!(text(location.as_bytes(), Unix), "/data/x y/resources", "{location}");
        }
        assert_eq!(text(b"file:///data/%C3%A9", Unix), "/data/\u{e9}");
        assert_eq!(text(b"file:///", Unix), "/");
        assert_eq!(text(b"relative/resources", Unix), "relative/resources");
        assert_eq!(folder(b""), Ok(None));
        assert_eq!(folder(b"file:"), Ok(None));
    }

    #[test]
    fn every_way_importers_write_it_on_windows() {
        for location in
            ["file:///C:/x%20y/resources/", "file:/C:/x y/resources", "file://C:/x y/resources", r"C:\x y\resources\"]
        {
            assert_eq!(text(location.as_bytes(), Windows), r"C:\x y\resources", "{location}");
        }
        for location in
            ["file://server/share/resources", "file:////server/share/resources/", r"\\server\share\resources"]
        {
            assert_eq!(text(location.as_bytes(), Windows), r"\\server\share\resources", "{location}");
        }
        assert_eq!(text(b"file:///C:/", Windows), r"C:\");
    }

    #[test]
    fn percent_signs_that_encode_nothing_stay() {
        assert_eq!(text(b"file:///data/100%", Unix), "/data/100%");
        assert_eq!(text(b"file:///data/%+5%-1%zz", Unix), "/data/%+5%-1%zz");
    }

    #[test]
    fn any_bytes_name_a_folder_on_unix_and_none_on_windows() {
        assert_eq!(path(b"file:///data/%E9", Unix), Ok(b"/data/\xe9".to_vec()));
        assert_eq!(path(b"file:///C:/%E9", Windows), Err("is not UTF-8"));
    }

    #[test]
    fn what_names_no_folder_here_is_refused_with_a_reason() {
        for location in ["http://server/x", "fmi2://x", "FTP://x"] {
            assert_eq!(path(location.as_bytes(), Unix), Err("is of another scheme than `file:`"), "{location}");
        }
        assert_eq!(path(b"file://server/share/x", Unix), Err("names another computer"));
        assert_eq!(path(b"file:///x%00y", Unix), Err("holds a NUL"));
        let error = folder(b"http://x").unwrap_err();
        assert_eq!(
            error,
            "the resource location `http://x` is of another scheme than `file:`; the instance has no resources"
        );
    }
}
