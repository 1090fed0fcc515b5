//! CL data that are wrong are rejected with the line and the reason; good ones are read as they are.

mod common;

use std::path::Path;

use common::{file, row, spiral};
use control_blocks::ParameterError;
use fmu_polish::interface::{FeedSource, Parameters};
use fmu_polish::path::built_in;
use fmu_polish::path::cl_data::Point;
use fmu_polish::path::cl_file::{self, points};

const P: Parameters = Parameters::START;
/// Lines before the first point.
const HEADER: usize = 4;

/// Reads the points of the path with `path.file` = `file`.
fn read(file: &str, resources: Option<&Path>) -> Result<Vec<Point>, ParameterError> {
    let mut p = P;
    p.path.file = file.to_owned();
    cl_file::read(resources, &p)
}

fn error(text: &str) -> String {
    points(text.as_bytes(), &P).unwrap_err().to_string()
}

/// The spiral with one changed row.
fn spoiled(i: usize, change: impl FnOnce(&mut [f64; 6])) -> String {
    let mut rows = spiral(100);
    change(&mut rows[i]);
    file(&rows)
}

#[test]
fn a_good_file_is_restored() {
    let rows = spiral(200);
    let read = points(file(&rows).as_bytes(), &P).unwrap();
    assert_eq!(read.len(), 200);
    for (point, row) in read.iter().zip(&rows) {
        assert!((point.contact.x - 1e-3 * row[0]).abs() < 1e-9 && (point.normal.z - row[5]).abs() < 1e-6);
        assert!((point.normal.norm() - 1.0).abs() < 1e-15 && (point.feed - 2e-3).abs() < 1e-12);
    }
    assert_eq!((read[0].line, read[199].line), (HEADER + 1, HEADER + 200));
}

#[test]
fn inches_crlf_comments_and_doubled_points() {
    let inches: Vec<[f64; 6]> =
        spiral(50).into_iter().map(|[x, y, z, i, j, k]| [x / 25.4, y / 25.4, z / 25.4, i, j, k]).collect();
    let text = file(&inches).replace("UNITS/MM", "units/inch $$ old").replace("CUTTER/1", "CUTTER/0.0393701");
    let mut lines: Vec<&str> = text.lines().collect();
    lines.insert(10, lines[9]);
    // six digits of an inch are 25 nm
    let read = points(lines.join("\r\n").as_bytes(), &P).unwrap();
    assert_eq!(read.len(), 50);
    assert!((read[49].contact.x - 1e-3 * spiral(50)[49][0]).abs() < 5e-8);
}

#[test]
fn ten_malformed_files_are_rejected_with_line_and_reason() {
    let many = {
        let mut text = file(&[]).replace("FINI\n", "");
        for i in 0..=200_000 {
            text += if i % 2 == 0 { "GOTO/0,0,0,0,0,1\n" } else { "GOTO/0.02,0,0,0,0,1\n" };
        }
        text + "FINI\n"
    };
    let fold: Vec<[f64; 6]> = (0..100).map(|i| ball(0.3, 0.02 * f64::from(i) - 1.0)).collect();
    let cases = [
        ("flipped normal", spoiled(40, |r| (3..6).for_each(|i| r[i] = -r[i])), "line 45: the normal points down"),
        ("gap", spoiled(40, |r| r[0] += 0.5), "line 45: a gap of"),
        ("non-unit normal", spoiled(40, |r| r[5] *= 1.1), "line 45: the normal has the length `1.0997`"),
        (
            "fold",
            file(&fold),
            "line 6: the path of the ball center folds: the surface has a smaller radius than the tool",
        ),
        ("NaN", spoiled(40, |r| r[2] = f64::NAN), "line 45: `NaN` is not a finite number"),
        ("too many points", many, "line 200005: more than `200000` points"),
        ("wrong units", file(&spiral(100)).replace("MM\n", "INCH\n"), "line 3: CUTTER is `0.0254 m`"),
        ("empty", String::new(), "line 1: the file is empty"),
        ("out of stroke", file(&shifted(0.3e3)), "line 5: `x` reaches `0.300"),
        ("no FINI", file(&spiral(100)).replace("FINI\n", ""), "line 104: the file ends without FINI"),
    ];
    for (name, text, expected) in cases {
        let message = error(&text);
        assert!(message.starts_with(expected), "{name}: {message}");
        assert!(message.contains("hint: "), "{name}: {message}");
    }
    let junk: Vec<u8> = b"PARTNO/X\nUNITS/MM\n".iter().copied().chain((128..=255).cycle().take(5000)).collect();
    assert!(points(&junk, &P).unwrap_err().to_string().starts_with("line 3: the file is not UTF-8 text"));
}

#[test]
fn other_mistakes() {
    let cases = [
        (file(&spiral(9)), "line 14: only `9` different points, must be at least `10`"),
        (spoiled(0, |r| r[5] = 0.0), "line 5: the normal has the length"),
        (spoiled(40, lean), "line 45: the normal rotates by"),
        (file(&climbing()), "line 6: the step has"),
        (file(&steep()), "line 5: the surface is `1.2"),
        (file(&spiral(20)).replace("UNITS/MM\n", ""), "line 2: a length before UNITS"),
        (file(&spiral(20)).replace("UNITS/MM", "UNITS/CM"), "line 2: the unit `CM` is unknown"),
        (file(&spiral(20)).replace("FEDRAT", "UNITS/INCH\nFEDRAT"), "line 4: a second UNITS that differs"),
        (file(&spiral(20)).replace("CUTTER/1", "CUTTER/2"), "line 3: CUTTER is `0.002 m`"),
        (file(&spiral(20)) + "GOTO/0,0,0,0,0,1\n", "line 26: a statement after FINI"),
        (file(&spiral(20)).replace("PARTNO", "RAPID"), "line 1: `RAPID/HOLLOW` is not a statement"),
    ];
    for (text, expected) in cases {
        let message = error(&text);
        assert!(message.starts_with(expected), "{message}");
    }
}

#[test]
fn a_feed_from_the_file_must_be_there() {
    let mut p = P;
    p.feed.source = FeedSource::File;
    let text = file(&spiral(20));
    assert!(points(text.as_bytes(), &p).is_ok());
    let message = points(text.replace("FEDRAT/120,MMPM\n", "").as_bytes(), &p).unwrap_err().to_string();
    assert!(message.starts_with("line 4: a point before the first FEDRAT"), "{message}");
}

#[test]
fn the_file_is_named() {
    let nowhere = read("nothing.cls", None).unwrap_err().to_string();
    assert!(nowhere.starts_with("parameter `path.file` is `nothing.cls`, must be there: "), "{nowhere}");
    let unnamed = read("", None).unwrap_err().to_string();
    assert!(unnamed.contains("must be the name of a file"), "{unnamed}");
    let folder = read(".", None).unwrap_err().to_string();
    assert!(folder.contains("a file, not a folder"), "{folder}");
}

#[test]
fn the_built_in_path_needs_no_folder() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("resources");
    let built_in = read(built_in::NAME, None).unwrap();
    let bytes = std::fs::read(folder.join(built_in::NAME)).unwrap();
    assert_eq!(built_in, points(&bytes, &P).unwrap());
}

#[test]
fn every_shipped_path_is_read() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("resources");
    let mut count = 0;
    for entry in std::fs::read_dir(&folder).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if name.ends_with(".cls") {
            let read = read(&name, Some(&folder));
            assert!(read.as_ref().is_ok_and(|points| points.len() > 100), "{name}: {:?}", read.err());
            count += 1;
        }
    }
    assert!(count >= 1);
}

/// Whatever a file holds, the answer is points or an error with a line.
#[test]
fn mutilated_files_never_panic() {
    let text = file(&spiral(30)).into_bytes();
    for i in 0..text.len() {
        for byte in [b'\n', b'/', b',', b'-', b'9', b'e', 0, 255] {
            let mut bytes = text.clone();
            bytes[i] = byte;
            if let Err(error) = points(&bytes, &P) {
                assert!(error.line >= 1 && error.line <= 36, "{error}");
            }
        }
        let _ = points(&text[..i], &P);
    }
}

/// A hollow cylinder of the radius `radius` mm.
fn ball(radius: f64, angle: f64) -> [f64; 6] {
    [radius * angle.sin(), 0.0, radius * (1.0 - angle.cos()), -angle.sin(), 0.0, angle.cos()]
}

fn shifted(shift: f64) -> Vec<[f64; 6]> {
    spiral(100).into_iter().map(|[x, y, z, i, j, k]| [x + shift, y, z, i, j, k]).collect()
}

/// A normal turned by about 0.3 rad.
fn lean(row: &mut [f64; 6]) {
    let (i, k) = (row[3], row[5]);
    row[3] = i * 0.3f64.cos() + k * 0.3f64.sin();
    row[5] = k * 0.3f64.cos() - i * 0.3f64.sin();
}

/// A ramp of 45 degrees with upright normals.
fn climbing() -> Vec<[f64; 6]> {
    (0..20).map(|i| [0.02 * f64::from(i), 0.0, 0.02 * f64::from(i), 0.0, 0.0, 1.0]).collect()
}

/// The wall of the hollow.
fn steep() -> Vec<[f64; 6]> {
    (0..20).map(|i| row(2.85, 0.007 * f64::from(i))).collect()
}
