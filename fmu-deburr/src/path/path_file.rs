//! The programmed path from a JSON file.

use control_blocks::{FileParameter, ParameterError};
use serde::Deserialize;

use crate::interface::Parameters;
use crate::path::geometry::{Block, Pose, Vector};
use crate::path::programmed_path::{CORNER, ProgrammedPath};
use crate::path::touch::Touch;
use crate::registration::fit::{TOUCHES_MIN, geometry};

/// Largest file, bytes.
const BYTES_MAX: u64 = 64 << 20;
/// Most blocks of a path.
const BLOCKS_MAX: usize = 10_000;
/// Programmed speeds, m/s.
const SPEEDS: (f64, f64) = (1e-3, 2.0);
/// No place is farther from the base, m.
const COORDINATE_MAX: f64 = 100.0;
/// Most touches of a part.
const TOUCHES_MAX: usize = 100;
/// Ways of an approach, m.
const APPROACHES: (f64, f64) = (1e-4, 0.1);
/// Largest part of a normal that is not level.
const LEVEL: f64 = 1e-3;
/// Largest standard deviation of the angle (rad) that touches of 1 mm may leave.
const ANGLE_MAX: f64 = 0.1;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(rename = "description", default)]
    _description: String,
    speed_m_s: f64,
    #[serde(default)]
    cyclic: bool,
    start: ProgrammedPoint,
    blocks: Vec<Step>,
    #[serde(default)]
    touches: Vec<TouchPoint>,
}

/// A touch; without `axis` the tool is upright.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TouchPoint {
    tip_m: [f64; 3],
    axis: Option<[f64; 3]>,
    normal: [f64; 3],
    approach_m: f64,
}

/// A path point; without `axis` the tool keeps its direction.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ProgrammedPoint {
    tip_m: [f64; 3],
    axis: Option<[f64; 3]>,
}

#[derive(Deserialize)]
#[serde(tag = "type", rename_all = "lowercase", deny_unknown_fields)]
enum Step {
    Line { to: ProgrammedPoint },
    Arc { to: ProgrammedPoint, via_m: Option<[f64; 3]>, centre_m: Option<[f64; 3]> },
}

/// The path without a file: importers need not provide the folder of the resources.
const TEST_PIECE: &[u8] = include_bytes!("../../resources/path.json");

/// Reads the path that `path.file` names, or the test piece if it names none.
///
/// # Errors
/// Names the file, the block, the field, its value and the limit.
pub fn read(p: &Parameters, resources: Option<&std::path::Path>) -> Result<ProgrammedPath, ParameterError> {
    let parameter = FileParameter {
        name: "path.file",
        file: &p.path.file,
        hint: "write {\"speed_m_s\": 0.1, \"start\": {\"tip_m\": [0.7, 0, -0.2], \"axis\": [0, 0, -1]}, \"blocks\": \
               [{\"type\": \"line\", \"to\": {\"tip_m\": [0.7, 0.1, -0.2]}}]}",
    };
    let test_piece = p.path.file.is_empty();
    let bytes = if test_piece { TEST_PIECE.to_vec() } else { parameter.read(resources, BYTES_MAX)? };
    let path = parse(p, &bytes);
    path.map_err(|what| parameter.wrong(format!("a path: {what}")))
}

fn parse(p: &Parameters, bytes: &[u8]) -> Result<ProgrammedPath, String> {
    let file: File = serde_json::from_slice(bytes).map_err(|error| error.to_string())?;
    let count = file.blocks.len();
    require_or(count > 0 && count <= BLOCKS_MAX, || {
        format!("`blocks` has `{count}` entries, limits `1` to `{BLOCKS_MAX}`")
    })?;
    let speed = if p.path.programmed_speed > 0.0 { p.path.programmed_speed } else { file.speed_m_s };
    let (low, high) = SPEEDS;
    require_or(speed >= low && speed <= high, || {
        format!("`speed_m_s` or `path.programmed_speed` is `{speed}`, limits `{low}` to `{high}`")
    })?;
    let upright = Vector::new(0.0, 0.0, -1.0);
    let mut from = pose(&file.start, upright).map_err(|what| format!("`start`: {what}"))?;
    let mut blocks = Vec::with_capacity(count);
    for (i, step) in file.blocks.iter().enumerate() {
        let (block, to) = block(step, &from).map_err(|what| format!("block {}: {what}", i + 1))?;
        blocks.push(block);
        from = to;
    }
    let mut path = ProgrammedPath::new(blocks, speed, file.cyclic, CORNER)?;
    path.touches = touches(&file.touches, upright)?;
    Ok(path)
}

fn touches(points: &[TouchPoint], upright: Vector) -> Result<Vec<Touch>, String> {
    let count = points.len();
    if count == 0 {
        return Ok(Vec::new());
    }
    require_or((TOUCHES_MIN..=TOUCHES_MAX).contains(&count), || {
        format!("`touches` has `{count}` entries, limits `{TOUCHES_MIN}` to `{TOUCHES_MAX}`, or none")
    })?;
    let read = |(i, point)| touch(point, upright).map_err(|what| format!("touch {}: {what}", i + 1));
    let touches = points.iter().enumerate().map(read).collect::<Result<Vec<_>, _>>()?;
    let std = geometry(&touches).map(|deviations| 1e-3 * deviations[2]);
    require_or(std.is_some_and(|std| std <= ANGLE_MAX), || {
        let std = std.map_or("no angle".to_owned(), |std| format!("the angle to `{std:.3} rad`"));
        format!(
            "`touches` with errors of 1 mm determine {std}, limit `{ANGLE_MAX} rad`: they must be far apart, on faces in two directions"
        )
    })?;
    Ok(touches)
}

fn touch(point: &TouchPoint, upright: Vector) -> Result<Touch, String> {
    let TouchPoint { tip_m, axis, normal, approach_m } = point;
    let pose = pose(&ProgrammedPoint { tip_m: *tip_m, axis: *axis }, upright)?;
    let normal = vector("normal", normal)?;
    require_or(normal.norm() > 1e-6, || format!("`normal` has the length `{}`, limit `0.000001`", normal.norm()))?;
    let normal = normal.normalize();
    require_or(normal.z.abs() <= LEVEL, || {
        format!("`normal` rises by `{}`, limit `{LEVEL}`: it must be horizontal", normal.z)
    })?;
    let (low, high) = APPROACHES;
    require_or(*approach_m >= low && *approach_m <= high, || {
        format!("`approach_m` is `{approach_m}`, limits `{low}` to `{high}`")
    })?;
    Ok(Touch { pose, normal: Vector::new(normal.x, normal.y, 0.0).normalize(), approach: *approach_m })
}

fn block(step: &Step, from: &Pose) -> Result<(Block, Pose), String> {
    let to = match step {
        Step::Line { to } | Step::Arc { to, .. } => pose(to, from.axis).map_err(|what| format!("`to`: {what}"))?,
    };
    let block = match step {
        Step::Line { .. } => Block::line(from, &to)?,
        Step::Arc { via_m: Some(via), centre_m: None, .. } => Block::arc_via(from, vector("via_m", via)?, &to)?,
        Step::Arc { via_m: None, centre_m: Some(centre), .. } => {
            Block::arc_about(from, vector("centre_m", centre)?, &to)?
        }
        Step::Arc { .. } => return Err("arc: it has both or none of `via_m` and `centre_m`, must have one".to_owned()),
    };
    Ok((block, to))
}

fn pose(corner: &ProgrammedPoint, before: Vector) -> Result<Pose, String> {
    let axis = match &corner.axis {
        Some(axis) => {
            let axis = vector("axis", axis)?;
            require_or(axis.norm() > 1e-6, || format!("`axis` has the length `{}`, limit `0.000001`", axis.norm()))?;
            axis.normalize()
        }
        None => before,
    };
    Ok(Pose { tip: vector("tip_m", &corner.tip_m)?, axis })
}

fn vector(field: &str, values: &[f64; 3]) -> Result<Vector, String> {
    for value in values {
        require_or(value.abs() <= COORDINATE_MAX, || {
            format!("`{field}` has the entry `{value}`, limits `-{COORDINATE_MAX}` to `{COORDINATE_MAX}`")
        })?;
    }
    Ok(Vector::from(*values))
}

fn require_or(holds: bool, what: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(what()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(file: &str) -> Parameters {
        let mut p = Parameters::START;
        p.path.file = file.to_owned();
        p
    }

    fn read_text(text: &str) -> Result<ProgrammedPath, String> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("path.json"), text).unwrap();
        read(&named("path.json"), Some(folder.path())).map_err(|error| error.to_string())
    }

    /// A path with these blocks.
    fn file(blocks: &str) -> String {
        format!(r#"{{"speed_m_s": 0.1, "start": {{"tip_m": [0.7, 0, -0.2]}}, "blocks": [{blocks}]}}"#)
    }

    #[test]
    fn the_path_in_the_resources_is_the_test_piece() {
        let resources = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("resources");
        let path = read(&named("path.json"), Some(&resources)).unwrap();
        assert_eq!(read(&named(""), None).unwrap().length(), path.length());
        assert_eq!((path.blocks(), path.speed, path.cyclic), (3, 0.1, false));
        // two lines of 120 mm and a quarter of a circle; the joints are tangent, the feed stops at the end only
        assert!((path.length() - 0.24 - 0.0075 * std::f64::consts::PI).abs() < 1e-9);
        assert_eq!(path.next_stop(0.0), path.length());
    }

    #[test]
    fn the_parameter_overrides_the_programmed_speed() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("path.json"), file(r#"{"type": "line", "to": {"tip_m": [0.8, 0, -0.2]}}"#))
            .unwrap();
        let mut p = named("path.json");
        p.path.programmed_speed = 0.06;
        assert_eq!(read(&p, Some(folder.path())).unwrap().speed, 0.06);
    }

    #[test]
    fn lines_arcs_and_tilted_tools_are_read() {
        let path = read_text(&file(
            r#"{"type": "line", "to": {"tip_m": [0.8, 0, -0.2], "axis": [0, 0.2, -1]}},
               {"type": "arc", "via_m": [0.9, 0.1, -0.2], "to": {"tip_m": [0.8, 0.2, -0.2]}},
               {"type": "arc", "centre_m": [0.8, 0.3, -0.2], "to": {"tip_m": [0.7, 0.3, -0.2], "axis": [0, 0, -3]}}"#,
        ))
        .unwrap();
        assert_eq!(path.blocks(), 3);
        let tilted = path.at(0.2).axis;
        assert!((tilted.y / tilted.z + 0.2).abs() < 1e-12 && (tilted.norm() - 1.0).abs() < 1e-12);
        assert!((path.at(path.length()).tip - Vector::new(0.7, 0.3, -0.2)).norm() < 1e-12);
    }

    #[test]
    fn every_malformed_path_is_rejected_with_block_field_value_and_limit() {
        let line = |to: &str| file(&format!(r#"{{"type": "line", "to": {to}}}"#));
        let arc = |how: &str| file(&format!(r#"{{"type": "arc", {how} "to": {{"tip_m": [0.8, 0, -0.2]}}}}"#));
        let good = r#"{"type": "line", "to": {"tip_m": [0.8, 0, -0.2]}}"#;
        let cases = [
            (file(""), "`blocks` has `0` entries, limits `1` to `10000`"),
            (line(r#"{"tip_m": [0.7, 0, -0.2]}"#), "block 1: line: length is `0 m`"),
            (line(r#"{"tip_m": [0.8, 0]}"#), "invalid length 2"),
            (
                line(r#"{"tip_m": [800, 0, -0.2]}"#),
                "block 1: `to`: `tip_m` has the entry `800`, limits `-100` to `100`",
            ),
            (line(r#"{"tip_m": [0.8, 0, -0.2], "axis": [0, 0, 0]}"#), "block 1: `to`: `axis` has the length `0`"),
            (line(r#"{"tip_m": [0.8, 0, -0.2], "axis": [0, 0, 1]}"#), "block 1: `axis` rotates by 180 degrees"),
            (arc(""), "block 1: arc: it has both or none"),
            (arc(r#""via_m": [0.75, 0, -0.2],"#), "block 1: arc: `via_m` is on the line"),
            (arc(r#""centre_m": [0.75, 0.1, -0.1], "via_m": [0.75, 0.1, -0.1],"#), "block 1: arc: it has both or none"),
            (arc(r#""centre_m": [0.72, 0.1, -0.2],"#), "block 1: arc: radii at both ends differ by"),
            (file(&format!("{good}, {good}")), "block 2: line: length"),
            (file(r#"{"type": "spline"}"#), "unknown variant `spline`"),
            (file(r#"{"type": "line", "to": {"tip_m": [0.8, 0, NaN]}}"#), "at line 1 column"),
            (file(good).replace("0.1,", "7,"), "`speed_m_s` or `path.programmed_speed` is `7`, limits `0.001` to `2`"),
            (file(good).replace("0.1,", r#"0.1, "cyclic": true,"#), "a cyclic path: its ends are `0.1"),
            (file(good).replace("speed_m_s", "speed"), "unknown field `speed`"),
            (String::new(), "EOF"),
        ];
        for (text, part) in cases {
            let message = read_text(&text).map(|_| text.clone()).unwrap_err();
            let start = "parameter `path.file` is `path.json`, must be a path: ";
            assert!(message.starts_with(start) && message.contains(part), "{message}");
            assert!(message.contains("hint: write {"), "{message}");
        }
    }

    /// A path with these touches.
    fn touched(touches: &str) -> String {
        let line = r#"{"type": "line", "to": {"tip_m": [0.8, 0, -0.2]}}"#;
        file(line).replace(r#""blocks""#, &format!(r#""touches": [{touches}], "blocks""#))
    }

    fn touch(x: f64, normal: &str, approach: f64) -> String {
        format!(r#"{{"tip_m": [{x}, 0, -0.2], "normal": {normal}, "approach_m": {approach}}}"#)
    }

    #[test]
    fn touches_are_read_with_level_unit_normals_and_an_upright_tool() {
        let text = [touch(0.7, "[0, 3, 0]", 5e-3), touch(0.8, "[0, 1, 0]", 1e-3)].join(", ");
        let more = [touch(0.7, "[2, 0, 0.001]", 0.1), touch(0.75, "[0, -1, 0]", 1e-4)].join(", ");
        let path = read_text(&touched(&format!("{text}, {more}"))).unwrap();
        let normals: Vec<Vector> = path.touches.iter().map(|touch| touch.normal).collect();
        assert_eq!(normals, [Vector::y(), Vector::y(), Vector::x(), -Vector::y()]);
        assert!(path.touches.iter().all(|touch| touch.pose.axis == -Vector::z()));
        assert_eq!((path.touches[1].pose.tip.x, path.touches[2].approach), (0.8, 0.1));
        assert!(read_text(&file(r#"{"type": "line", "to": {"tip_m": [0.8, 0, -0.2]}}"#)).unwrap().touches.is_empty());
    }

    #[test]
    fn every_malformed_touch_is_rejected_with_its_number_field_value_and_limit() {
        let good = touch(0.7, "[0, 1, 0]", 5e-3);
        let with = |last: &str| touched(&[&good, &touch(0.8, "[0, 1, 0]", 5e-3), &good, last].join(", "));
        let cases = [
            (touched(&[&*good, &good, &good].join(", ")), "`touches` has `3` entries, limits `4` to `100`, or none"),
            (with(&touch(0.7, "[0, 0, 0]", 5e-3)), "touch 4: `normal` has the length `0`"),
            (with(&touch(0.7, "[1, 0, 0.01]", 5e-3)), "touch 4: `normal` rises by `0.0099"),
            (with(&touch(0.7, "[1, 0, 0]", 9e-5)), "touch 4: `approach_m` is `0.00009`, limits `0.0001` to `0.1`"),
            (with(&touch(0.7, "[1, 0, 0]", 0.11)), "touch 4: `approach_m` is `0.11`"),
            (with(&touch(700.0, "[1, 0, 0]", 5e-3)), "touch 4: `tip_m` has the entry `700`"),
            (with(&good), "`touches` with errors of 1 mm determine no angle, limit `0.1 rad`"),
            (with(&good.replace("normal", "outward")), "unknown field `outward`"),
        ];
        for (text, part) in cases {
            let message = read_text(&text).map(|_| text.clone()).unwrap_err();
            assert!(message.contains(part), "{message}");
        }
        // all of it within a few millimeter
        let near = |x: f64, normal: &str| touch(0.7 + x, normal, 5e-3);
        let text = [near(0.0, "[0, 1, 0]"), near(5e-3, "[0, 1, 0]"), near(0.0, "[1, 0, 0]"), near(0.0, "[0, -1, 0]")];
        let message = read_text(&touched(&text.join(", "))).map(|_| ()).unwrap_err();
        assert!(message.contains("determine the angle to `0.2"), "{message}");
    }

    #[test]
    fn the_limits_themselves_are_taken() {
        let with = |speed: &str, x: &str| {
            let text = file(&format!(r#"{{"type": "line", "to": {{"tip_m": [{x}, 0, -0.2]}}}}"#));
            read_text(&text.replace("0.1,", &format!("{speed},"))).is_ok()
        };
        for speed in ["0.001", "2", "2.0"] {
            assert!(with(speed, "0.8"), "{speed}");
        }
        for x in ["100", "-100"] {
            assert!(with("0.1", x), "{x}");
        }
        assert!(["0.000999", "2.001"].iter().all(|speed| !with(speed, "0.8")));
        assert!(["100.001", "-100.001"].iter().all(|x| !with("0.1", x)));
        let block = |x: usize| format!(r#"{{"type": "line", "to": {{"tip_m": [{}, 0, -0.2]}}}}"#, [0.8, 0.7][x % 2]);
        let blocks = |count: usize| read_text(&file(&(0..count).map(block).collect::<Vec<_>>().join(","))).is_ok();
        assert!(blocks(BLOCKS_MAX) && !blocks(BLOCKS_MAX + 1));
    }
}
