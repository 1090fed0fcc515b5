//! `model.png`, the picture of an FMU in tools: a block with as many ports as the model has, and a sampled signal in it.

use std::collections::BTreeSet;

use anyhow::{Context, Result};

use super::terminals::Ports;

/// Width and height, pixels.
const SIZE: usize = 256;
/// Points per pixel and direction that the edges are smoothed with.
const FINE: usize = 4;
/// Ports of a side that are shown at most.
const MOST: usize = 12;
/// The digits and a plus sign, three bits a row from the top, and the size of a bit in pixels.
const GLYPHS: [u16; 10] = [0x7b6f, 0x2c97, 0x73e7, 0x73cf, 0x5bc9, 0x79cf, 0x79ef, 0x72a4, 0x7bef, 0x7bcf];
const PLUS: u16 = 0x05d0;
const BIT: f64 = 2.2;
/// The ends of the block, and half its height at most, in pixels from the middle.
const BLOCK: f64 = 88.0;
/// Red, green and blue of the block, its frame, and the signal.
const FILL: [u8; 3] = [240, 245, 250];
const FRAME: [u8; 3] = [86, 101, 120];
const SIGNAL: [u8; 3] = [10, 88, 168];

/// The picture as PNG.
///
/// # Errors
/// When it cannot be encoded.
pub fn write(ports: &Ports) -> Result<Vec<u8>> {
    let pixels = (0..SIZE).flat_map(|y| (0..SIZE).map(move |x| (y, x)));
    let pixels: Vec<_> = pixels.map(|(y, x)| pixel(x, y, ports.inputs.len(), ports.outputs.len())).collect();
    // three colours and what lies between them: few enough for a palette, a third of the size
    let palette: Vec<_> = BTreeSet::from_iter(pixels.iter().copied()).into_iter().collect();
    let indices = pixels.iter().map(|pixel| palette.binary_search(pixel).unwrap_or_default());
    let indices =
        indices.map(u8::try_from).collect::<Result<Vec<_>, _>>().context("the picture has too many colors")?;
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, SIZE as u32, SIZE as u32);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_palette(palette.iter().flat_map(|&[red, green, blue, _]| [red, green, blue]).collect::<Vec<_>>());
    encoder.set_trns(palette.iter().map(|&[.., opacity]| opacity).collect::<Vec<_>>());
    encoder.set_filter(png::Filter::NoFilter);
    encoder.set_compression(png::Compression::High);
    let mut writer = encoder.write_header().context("cannot write the picture")?;
    writer.write_image_data(&indices).context("cannot write the picture")?;
    drop(writer);
    Ok(bytes)
}

/// The mean color of the points in a pixel, and their fraction as opacity.
fn pixel(x: usize, y: usize, inputs: usize, outputs: usize) -> [u8; 4] {
    let at = |pixel: usize, k: usize| pixel as f64 + (k as f64 + 0.5) / FINE as f64 - SIZE as f64 / 2.0;
    let points = (0..FINE * FINE).filter_map(|k| colour(at(x, k % FINE), at(y, k / FINE), inputs, outputs));
    let (sum, count) = points.fold(([0_usize; 3], 0), |(sum, count), colour| {
        (std::array::from_fn(|i| sum[i] + usize::from(colour[i])), count + 1)
    });
    let mean = sum.map(|sum| (sum / count.max(1)) as u8);
    [mean[0], mean[1], mean[2], (255 * count / (FINE * FINE)) as u8]
}

/// What lies at a point, from the front to the back; the origin is in the middle, and y points down.
fn colour(x: f64, y: f64, inputs: usize, outputs: usize) -> Option<[u8; 3]> {
    let outside = |half: f64| {
        let corner = 14.0;
        let (dx, dy) = (x.abs() - (half - corner), y.abs() - (half - corner));
        dx.max(0.0).hypot(dy.max(0.0)) > corner
    };
    if is_signal(x, y) {
        Some(SIGNAL)
    } else if !outside(BLOCK - 3.0) {
        Some(FILL)
    } else if !outside(BLOCK) || is_port(x + BLOCK + 26.0, y, inputs) || is_port(x - BLOCK - 4.0, y, outputs) {
        Some(FRAME)
    } else {
        None
    }
}

/// Triangles that point to the right, 22 pixels long at most, in a column; of many ports the first [`MOST`] less one, and
/// the number of the others.
fn is_port(x: f64, y: f64, count: usize) -> bool {
    if count > MOST {
        let last = (BLOCK - 12.0) - (2.0 * BLOCK - 24.0) / MOST as f64;
        let others = count + 1 - MOST;
        return if y < last { is_port(x, y, MOST) } else { is_number(x, y - last, others) };
    }
    let pitch = (2.0 * BLOCK - 24.0) / count.max(1) as f64;
    let (half, from_top) = ((0.38 * pitch).min(9.0), y + BLOCK - 12.0);
    let off = (from_top.rem_euclid(pitch) - 0.5 * pitch).abs();
    let is_inside = count > 0 && (0.0..2.0 * BLOCK - 24.0).contains(&from_top);
    is_inside && (0.0..22.0).contains(&x) && off <= half * (1.0 - x / 22.0)
}

/// `+` and a number, from the left and the top.
fn is_number(x: f64, y: f64, number: usize) -> bool {
    let (column, row) = ((x / BIT).floor(), (y / BIT).floor() - 1.0);
    if column < 0.0 || !(0.0..5.0).contains(&row) {
        return false;
    }
    let (column, row) = (column as usize, row as usize);
    let digit = |c: char| c.to_digit(10).map_or(PLUS, |digit| GLYPHS[digit as usize]);
    let glyph = format!("+{number}").chars().nth(column / 4).map_or(0, digit);
    column % 4 < 3 && glyph >> (14 - 3 * row - column % 4) & 1 == 1
}

/// A step response as a sampled controller sees it: held between samples.
fn is_signal(x: f64, y: f64) -> bool {
    const SAMPLE: f64 = 16.0;
    const LINE: f64 = 2.5;
    let level = |k: f64| {
        let t = (k + 4.0).max(0.0);
        44.0 - 84.0 * (1.0 - (-0.6 * t).exp() * ((0.9 * t).cos() + 0.6 * (0.9 * t).sin()))
    };
    let k = (x / SAMPLE).floor();
    if !(-4.4..4.0).contains(&(x / SAMPLE)) {
        return false;
    }
    let (before, now) = (level(k - 1.0), level(k));
    let rise = x - k * SAMPLE < LINE && k > -4.0 && (before.min(now) - LINE..=before.max(now) + LINE).contains(&y);
    let sample = (x / SAMPLE).round();
    (y - now).abs() <= LINE || rise || (x - sample * SAMPLE).hypot(y - level(sample)) < 5.5
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ports(inputs: usize, outputs: usize) -> Ports {
        Ports { inputs: vec![String::new(); inputs], outputs: vec![String::new(); outputs] }
    }

    #[test]
    fn the_picture_is_small_the_same_each_time_and_shows_the_ports() {
        let picture = write(&ports(3, 12)).unwrap();
        assert_eq!(picture[..8], *b"\x89PNG\r\n\x1a\n");
        assert!(picture.len() < 4_000, "{} bytes", picture.len());
        assert_eq!(write(&ports(3, 12)).unwrap(), picture);
        assert_ne!(write(&ports(2, 12)).unwrap(), picture);
    }

    #[test]
    fn a_side_has_as_many_triangles_as_ports() {
        for count in [0, 1, 3, MOST] {
            assert_eq!(shapes(1.0, count), count);
        }
    }

    #[test]
    fn of_many_ports_some_are_shown_and_the_number_of_the_others() {
        assert_eq!(shapes(1.0, 88), MOST - 1 + 1);
        let last = BLOCK - 12.0 - (2.0 * BLOCK - 24.0) / MOST as f64;
        let line = |row: usize| {
            let at = |k: usize| is_port((k as f64 + 0.5) * BIT, last + (row as f64 + 1.5) * BIT, 88);
            (0..11).map(|k| if at(k) { '#' } else { '.' }).collect::<String>()
        };
        let wanted = ["....###.###", ".#....#...#", "###..#...#.", ".#..#...#..", "....#...#.."];
        assert_eq!((0..5).map(line).collect::<Vec<_>>(), wanted);
    }

    /// How many shapes a line down through the ports meets.
    fn shapes(x: f64, count: usize) -> usize {
        let column: Vec<_> = (0..SIZE * 8).map(|k| is_port(x, k as f64 / 8.0 - 128.0, count)).collect();
        column.windows(2).filter(|pair| !pair[0] && pair[1]).count()
    }

    #[test]
    fn corners_are_clear_and_the_middle_is_not() {
        assert_eq!(pixel(0, 0, 1, 1)[3], 0);
        assert_eq!(pixel(SIZE / 2, SIZE / 2 + 70, 1, 1)[3], 255);
    }
}
