//! The resource location of an instance: importers write it in many ways.

use std::path::PathBuf;

/// Folder behind a `fmuResourceLocation`, or `None` when there is none to use.
///
/// Takes `file:/x`, `file:///x`, `file:////x`, `file://localhost/x`, a trailing slash,
/// percent-encoded bytes and plain paths.
pub fn folder(location: &str) -> Option<PathBuf> {
    let decoded = match strip_scheme(location) {
        Some(rest) => percent_decode(rest)?,
        None => location.to_owned(),
    };
    let trimmed = if decoded.len() > 1 { decoded.trim_end_matches('/') } else { &decoded };
    // file:///C:/x names a drive, not a folder below the root
    let path = if cfg!(windows) { trimmed.trim_start_matches('/') } else { trimmed };
    (!path.is_empty()).then(|| PathBuf::from(path))
}

fn strip_scheme(location: &str) -> Option<&str> {
    let scheme = location.get(..5)?;
    if !scheme.eq_ignore_ascii_case("file:") {
        return None;
    }
    let rest = &location[5..];
    // the host between // and the next / is empty or localhost
    Some(match rest.strip_prefix("//") {
        Some(host) => match host.find('/') {
            Some(slash) => single_slash(&host[slash..]),
            None => host,
        },
        None => rest,
    })
}

fn single_slash(path: &str) -> &str {
    let extra = path.len() - path.trim_start_matches('/').len();
    &path[extra.saturating_sub(1)..]
}

fn percent_decode(text: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let [first, tail @ ..] = rest {
        let digits = tail.get(..2).and_then(|hex| std::str::from_utf8(hex).ok());
        match (first, digits.and_then(|hex| u8::from_str_radix(hex, 16).ok())) {
            (b'%', Some(byte)) => {
                bytes.push(byte);
                rest = &tail[2..];
            }
            _ => {
                bytes.push(*first);
                rest = tail;
            }
        }
    }
    String::from_utf8(bytes).ok()
}

#[cfg(all(test, not(windows)))]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn every_way_importers_write_it() {
        for location in [
            "file:/tmp/x y/resources",
            "file:///tmp/x%20y/resources",
            "file:////tmp/x%20y/resources",
            "file://localhost/tmp/x%20y/resources/",
            "FILE:///tmp/x%20y/resources/",
            "/tmp/x y/resources",
        ] {
            assert_eq!(folder(location).as_deref(), Some(Path::new("/tmp/x y/resources")), "{location}");
        }
        assert_eq!(folder("file:///tmp/%C3%A9"), Some(PathBuf::from("/tmp/\u{e9}")));
        assert_eq!(folder("file:///tmp/100%"), Some(PathBuf::from("/tmp/100%")));
        assert_eq!(folder("file:///"), Some(PathBuf::from("/")));
    }

    #[test]
    fn nothing_and_bad_bytes_give_no_folder() {
        assert_eq!(folder(""), None);
        assert_eq!(folder("file:"), None);
        assert_eq!(folder("file:///tmp/%FF"), None);
    }
}
