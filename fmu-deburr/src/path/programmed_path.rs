//! The programmed path: blocks joined end to end, with the positions where the feed must come to rest.

use serde::{Deserialize, Serialize};

use crate::fingerprint::Fingerprint;
use crate::path::displacement::Displacement;
use crate::path::geometry::{Block, Pose};
use crate::path::touch::Touch;

/// Ends of a path that are closer than this are one position, m.
const CLOSED: f64 = 1e-6;
/// Change of direction of the tangent at which the feed stops, rad: below it the drives follow a corner at speed.
pub const CORNER: f64 = 0.2;

/// A path of blocks.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ProgrammedPath {
    blocks: Vec<Block>,
    /// distance from the start to the beginning of each block, and to the end, m
    starts: Vec<f64>,
    /// distances at which the feed stops, ascending, m; the last is the end
    stops: Vec<f64>,
    /// Programmed speed, m/s.
    pub speed: f64,
    /// The path is run again and again without a return.
    pub cyclic: bool,
    /// Where its part is touched.
    pub touches: Vec<Touch>,
    /// Where its part lies.
    pub displacement: Displacement,
}

/// A position on the path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Location {
    /// Number of the block, from 0.
    pub block: usize,
    /// Distance from the beginning of the block (the paper's L*), m.
    pub distance: f64,
}

impl ProgrammedPath {
    /// Joins blocks (at least one); the feed stops where the tangent changes by more than `corner` rad.
    ///
    /// # Errors
    /// Message for the user if a cyclic path does not end where it starts.
    pub fn new(blocks: Vec<Block>, speed: f64, cyclic: bool, corner: f64) -> Result<Self, String> {
        let mut starts = vec![0.0];
        let mut stops = Vec::new();
        let mut end = 0.0;
        for (i, block) in blocks.iter().enumerate() {
            end += block.length;
            starts.push(end);
            let corner_angle = blocks.get(i + 1).map(|next| corner_angle(block, next));
            if corner_angle.is_none_or(|corner_angle| corner_angle > corner) {
                stops.push(end);
            }
        }
        let path =
            Self { blocks, starts, stops, speed, cyclic, touches: Vec::new(), displacement: Displacement::default() };
        let gap = path.gap();
        if cyclic && gap > CLOSED {
            return Err(format!("a cyclic path: its ends are `{gap} m` apart, limit `{CLOSED} m`"));
        }
        Ok(path)
    }

    /// Length, m.
    pub fn length(&self) -> f64 {
        self.starts[self.blocks.len()]
    }

    /// Number of blocks.
    pub fn blocks(&self) -> usize {
        self.blocks.len()
    }

    /// Number of positions at which the feed stops, the end among them.
    pub fn stops(&self) -> usize {
        self.stops.len()
    }

    /// First distance (m) beyond `distance` at which the feed stops.
    pub fn next_stop(&self, distance: f64) -> f64 {
        let passed = self.stops.partition_point(|stop| *stop <= distance);
        self.stops.get(passed).copied().unwrap_or(self.length())
    }

    /// Block and distance in it at the distance (m) from the start.
    pub fn locate(&self, distance: f64) -> Location {
        let begun = self.starts[..self.blocks.len()].partition_point(|start| *start <= distance);
        let block = begun.saturating_sub(1);
        Location { block, distance: distance - self.starts[block] }
    }

    /// Pose at the distance (m) from the start, where the part lies.
    pub fn at(&self, distance: f64) -> Pose {
        let locate = self.locate(distance.clamp(0.0, self.length()));
        self.displacement.of(&self.blocks[locate.block].at(locate.distance))
    }

    /// Adds the programmed values to a fingerprint.
    pub fn fingerprint(&self, print: &mut Fingerprint) {
        self.blocks.iter().for_each(|block| block.fingerprint(print));
        print.add(self.speed);
        print.add(f64::from(u8::from(self.cyclic)));
    }

    /// Distance between both ends, tip and tool, m.
    fn gap(&self) -> f64 {
        let (first, last) = (self.at(0.0), self.at(self.length()));
        (first.tip - last.tip).norm().max((first.axis - last.axis).norm())
    }
}

/// Angle between the end of a block and the beginning of the next, rad.
fn corner_angle(block: &Block, next: &Block) -> f64 {
    let (a, b) = (block.tangent(block.length), next.tangent(0.0));
    a.cross(&b).norm().atan2(a.dot(&b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::geometry::Vector;

    fn pose(x: f64, y: f64) -> Pose {
        Pose { tip: Vector::new(x, y, 0.0), axis: Vector::new(0.0, 0.0, -1.0) }
    }

    fn path(points: &[(f64, f64)], cyclic: bool) -> Result<ProgrammedPath, String> {
        let block = |pair: &[(f64, f64)]| Block::line(&pose(pair[0].0, pair[0].1), &pose(pair[1].0, pair[1].1));
        let blocks = points.windows(2).map(block).collect::<Result<Vec<_>, _>>()?;
        ProgrammedPath::new(blocks, 0.1, cyclic, 0.1)
    }

    #[test]
    fn positions_are_counted_from_the_beginning_of_their_block() {
        let path = path(&[(1.0, 0.0), (1.0, 0.2), (1.3, 0.2)], false).unwrap();
        assert!((path.length() - 0.5).abs() < 1e-15);
        assert_eq!(path.locate(0.1).block, 0);
        let later = path.locate(0.35);
        assert!(later.block == 1 && (later.distance - 0.15).abs() < 1e-15);
        assert!((path.at(0.35).tip - Vector::new(1.15, 0.2, 0.0)).norm() < 1e-15);
        assert_eq!(path.at(-1.0), path.at(0.0));
        assert_eq!(path.at(9.0), path.at(path.length()));
    }

    #[test]
    fn the_feed_stops_at_corners_and_at_the_end_only() {
        let path = path(&[(1.0, 0.0), (1.1, 0.0), (1.2, 0.005), (1.2, 0.1)], false).unwrap();
        let corner = path.next_stop(0.0);
        assert!((corner - 0.2001).abs() < 1e-4, "{corner}");
        assert_eq!(path.next_stop(corner), path.length());
        assert_eq!(path.next_stop(path.length()), path.length());
    }

    #[test]
    fn a_cyclic_path_must_be_closed() {
        assert!(path(&[(1.0, 0.0), (1.2, 0.0), (1.0, 0.0)], true).is_ok());
        let message = path(&[(1.0, 0.0), (1.2, 0.0), (1.1, 0.0)], true).unwrap_err();
        assert!(message.contains("ends are `0.1"), "{message}");
    }

    #[test]
    fn another_path_has_another_fingerprint() {
        let print = |path: ProgrammedPath| {
            let mut print = Fingerprint::default();
            path.fingerprint(&mut print);
            print.value()
        };
        let points = [(1.0, 0.0), (1.2, 0.0), (1.0, 0.0)];
        let one = print(path(&points, true).unwrap());
        assert_eq!(one, print(path(&points, true).unwrap()));
        assert_ne!(one, print(path(&points, false).unwrap()));
        assert_ne!(one, print(path(&[(1.0, 0.0), (1.2, 1e-9), (1.0, 0.0)], true).unwrap()));
    }
}
