//! The taught path from a JSON file.

use control_blocks::ParameterError;
use serde::Deserialize;

use crate::file::FileParameter;
use crate::geometry::{Block, Pose, Vector};
use crate::parameters::Parameters;
use crate::path::Path;

/// Most blocks of a path.
const BLOCKS_MAX: usize = 10_000;
/// Taught speeds, m/s.
const SPEEDS: (f64, f64) = (1e-3, 2.0);
/// No place is farther from the base, m.
const PLACE_MAX: f64 = 100.0;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(rename = "description", default)]
    _description: String,
    speed_m_s: f64,
    #[serde(default)]
    cyclic: bool,
    start: Corner,
    blocks: Vec<Step>,
}

/// A teaching point; without `axis` the tool keeps its direction.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Corner {
    tip_m: [f64; 3],
    axis: Option<[f64; 3]>,
}

#[derive(Deserialize)]
#[serde(tag = "type", rename_all = "lowercase", deny_unknown_fields)]
enum Step {
    Line { to: Corner },
    Arc { to: Corner, via_m: Option<[f64; 3]>, centre_m: Option<[f64; 3]> },
}

/// Reads the path that `path.file` names.
///
/// # Errors
/// Names the file, the block, the field, its value and the limit.
pub fn read(p: &Parameters, file: &str, resources: Option<&std::path::Path>) -> Result<Path, ParameterError> {
    let parameter = FileParameter {
        name: "path.file",
        file,
        hint: "write {\"speed_m_s\": 0.1, \"start\": {\"tip_m\": [0.7, 0, -0.2], \"axis\": [0, 0, -1]}, \"blocks\": \
               [{\"type\": \"line\", \"to\": {\"tip_m\": [0.7, 0.1, -0.2]}}]}",
    };
    let bytes = parameter.read(resources)?;
    let path = parse(p, &bytes);
    path.map_err(|what| parameter.wrong(format!("a path: {what}")))
}

fn parse(p: &Parameters, bytes: &[u8]) -> Result<Path, String> {
    let file: File = serde_json::from_slice(bytes).map_err(|error| error.to_string())?;
    let count = file.blocks.len();
    require_or(count > 0 && count <= BLOCKS_MAX, || {
        format!("`blocks` has `{count}` entries, limits `1` to `{BLOCKS_MAX}`")
    })?;
    let speed = if p.path.taught_speed > 0.0 { p.path.taught_speed } else { file.speed_m_s };
    let (low, high) = SPEEDS;
    require_or(speed >= low && speed <= high, || {
        format!("`speed_m_s` or `path.taught_speed` is `{speed}`, limits `{low}` to `{high}`")
    })?;
    let upright = Vector::new(0.0, 0.0, -1.0);
    let mut from = pose(&file.start, upright).map_err(|what| format!("`start`: {what}"))?;
    let mut blocks = Vec::with_capacity(count);
    for (i, step) in file.blocks.iter().enumerate() {
        let (block, to) = block(step, &from).map_err(|what| format!("block {}: {what}", i + 1))?;
        blocks.push(block);
        from = to;
    }
    Path::new(blocks, speed, file.cyclic, p.path.corner)
}

fn block(step: &Step, from: &Pose) -> Result<(Block, Pose), String> {
    let to = match step {
        Step::Line { to } | Step::Arc { to, .. } => pose(to, from.axis).map_err(|what| format!("`to`: {what}"))?,
    };
    let block = match step {
        Step::Line { .. } => Block::line(from, &to)?,
        Step::Arc { via_m: Some(via), centre_m: None, .. } => Block::arc_via(from, place("via_m", via)?, &to)?,
        Step::Arc { via_m: None, centre_m: Some(centre), .. } => {
            Block::arc_about(from, place("centre_m", centre)?, &to)?
        }
        Step::Arc { .. } => return Err("arc: it has both or none of `via_m` and `centre_m`, must have one".to_owned()),
    };
    Ok((block, to))
}

fn pose(corner: &Corner, before: Vector) -> Result<Pose, String> {
    let axis = match &corner.axis {
        Some(axis) => {
            let axis = place("axis", axis)?;
            require_or(axis.norm() > 1e-6, || format!("`axis` has the length `{}`, limit `0.000001`", axis.norm()))?;
            axis.normalize()
        }
        None => before,
    };
    Ok(Pose { tip: place("tip_m", &corner.tip_m)?, axis })
}

fn place(field: &str, values: &[f64; 3]) -> Result<Vector, String> {
    for value in values {
        require_or(value.abs() <= PLACE_MAX, || {
            format!("`{field}` has the entry `{value}`, limits `-{PLACE_MAX}` to `{PLACE_MAX}`")
        })?;
    }
    Ok(Vector::from(*values))
}

fn require_or(holds: bool, what: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(what()) }
}
