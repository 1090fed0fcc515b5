//! Wear of a height map under a ball that rubs (Preston), where higher points carry more pressure.

use std::ops::Range;

/// Contact of ball and paste on the mold.
#[derive(Clone, Copy, Debug)]
pub struct Abrasion {
    /// removed depth per pressure and distance, m2/N
    pub preston: f64,
    /// contact modulus, Pa
    pub modulus: f64,
    /// radius of the equivalent ball on a plane for ball and hollow, m
    pub radius: f64,
    /// pressure per height, Pa/m
    pub selectivity: f64,
}

/// One stroke of the ball: its midpoint and its averages.
#[derive(Clone, Copy, Debug)]
pub struct Stroke {
    /// contact point, m
    pub centre: [f64; 3],
    /// N
    pub load: f64,
    /// distance of the slip, m
    pub distance: f64,
}

/// Square map of heights along the normal of a surface.
#[derive(Clone, Debug)]
pub struct HeightMap {
    /// position of the first row and of the first column, m
    pub start: f64,
    /// distance of rows and of columns, m
    pub pitch: f64,
    /// rows and columns
    pub count: usize,
    /// height of the nominal surface along z, row by row, m
    pub nominal: Vec<f64>,
    /// true area of each point, m2; 0 outside of the mold
    pub area: Vec<f64>,
    /// height over the nominal surface, m
    pub height: Vec<f64>,
}

impl HeightMap {
    /// Wears the map by one stroke. The pressure is Hertz's plus `selectivity (h - mean)`, never negative, scaled to
    /// the load; `patch` is a buffer for it.
    pub fn rub(&mut self, abrasion: &Abrasion, stroke: &Stroke, patch: &mut Vec<(usize, f64)>) {
        let reach = (0.75 * stroke.load * abrasion.radius / abrasion.modulus).cbrt();
        patch.clear();
        self.hertz(stroke.centre, reach, patch);
        let (mut total, mut moment) = (0.0, 0.0);
        for &(point, pressure) in &*patch {
            total += pressure * self.area[point];
            moment += pressure * self.area[point] * self.height[point];
        }
        if total <= 0.0 {
            return;
        }
        let (scale, mean) = (stroke.load / total, moment / total);
        let mut carried = 0.0;
        for (point, pressure) in &mut *patch {
            let higher = self.height[*point] - mean;
            *pressure = (*pressure * scale + abrasion.selectivity * higher).max(0.0);
            carried += *pressure * self.area[*point];
        }
        let depth = abrasion.preston * stroke.distance * stroke.load / carried;
        for &(point, pressure) in &*patch {
            self.height[point] -= depth * pressure;
        }
    }

    /// Points of the contact with Hertz's pressure over its maximum.
    fn hertz(&self, centre: [f64; 3], reach: f64, patch: &mut Vec<(usize, f64)>) {
        let square = reach * reach;
        for row in self.within(centre[0], reach) {
            let dx = self.place(row) - centre[0];
            for column in self.within(centre[1], reach) {
                let point = row * self.count + column;
                let (dy, dz) = (self.place(column) - centre[1], self.nominal[point] - centre[2]);
                let inside = 1.0 - (dx * dx + dy * dy + dz * dz) / square;
                if inside > 0.0 {
                    patch.push((point, inside.sqrt()));
                }
            }
        }
    }

    /// Rows or columns at most `reach` away.
    fn within(&self, place: f64, reach: f64) -> Range<usize> {
        let first = ((place - reach - self.start) / self.pitch).ceil();
        let end = ((place + reach - self.start) / self.pitch).floor() + 1.0;
        // a cast from below zero gives zero
        first as usize..(end as usize).min(self.count)
    }

    fn place(&self, index: usize) -> f64 {
        self.start + self.pitch * index as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ABRASION: Abrasion = Abrasion { preston: 4e-11, modulus: 1e9, radius: 0.6e-3, selectivity: 0.0 };
    const PITCH: f64 = 10e-6;

    /// a plane with waves along y
    fn map(amplitude: f64) -> HeightMap {
        let count = 81;
        let wave = |k: usize| amplitude * (std::f64::consts::TAU * (k % count) as f64 / 10.0).cos();
        HeightMap {
            start: -40.0 * PITCH,
            pitch: PITCH,
            count,
            nominal: vec![0.0; count * count],
            area: vec![PITCH * PITCH; count * count],
            height: (0..count * count).map(wave).collect(),
        }
    }

    fn volume(before: &HeightMap, after: &HeightMap) -> f64 {
        before.height.iter().zip(&after.height).zip(&before.area).map(|((b, a), area)| (b - a) * area).sum()
    }

    #[test]
    fn the_volume_is_prestons_whatever_stands_out() {
        for selectivity in [0.0, 3e13, 1e15] {
            let before = map(1e-6);
            let mut after = before.clone();
            let stroke = Stroke { centre: [35e-6, -80e-6, 0.0], load: 3.0, distance: 2e-6 };
            after.rub(&Abrasion { selectivity, ..ABRASION }, &stroke, &mut Vec::new());
            assert!((volume(&before, &after) / (4e-11 * 3.0 * 2e-6) - 1.0).abs() < 1e-9, "{selectivity}");
            assert!(before.height.iter().zip(&after.height).all(|(b, a)| a <= b));
        }
    }

    #[test]
    fn the_deepest_point_is_one_and_a_half_times_the_mean() {
        let (before, mut after) = (map(0.0), map(0.0));
        let stroke = Stroke { centre: [0.0; 3], load: 5.0, distance: 1e-6 };
        after.rub(&ABRASION, &stroke, &mut Vec::new());
        let reach = (0.75 * 5.0 * 0.6e-3 / 1e9_f64).cbrt();
        let wanted = 4e-11 * 1e-6 * 1.5 * 5.0 / (std::f64::consts::PI * reach * reach);
        let middle = 40 * 81 + 40;
        assert!(((before.height[middle] - after.height[middle]) / wanted - 1.0).abs() < 0.02);
        assert_eq!(after.height[middle + 14], 0.0);
    }

    #[test]
    fn crests_wear_faster_than_troughs_by_the_selectivity() {
        let mut after = map(1e-7);
        let before = after.clone();
        let stroke = Stroke { centre: [0.0; 3], load: 5.0, distance: 1e-6 };
        after.rub(&Abrasion { selectivity: 3e13, ..ABRASION }, &stroke, &mut Vec::new());
        let removed = |k: usize| before.height[k] - after.height[k];
        let (crest, trough) = (40 * 81 + 40, 40 * 81 + 45);
        let hertz = (1.0 - (50e-6_f64).powi(2) / (0.75 * 5.0 * 0.6e-3 / 1e9_f64).cbrt().powi(2)).sqrt();
        let base = removed(crest) - removed(trough) - 4e-11 * 1e-6 * 3e13 * 2e-7;
        // what is left is the round of the pressure
        let plain = 4e-11 * 1e-6 * 1.5 * 5.0 / (std::f64::consts::PI * (0.75 * 5.0 * 0.6e-3 / 1e9_f64).cbrt().powi(2));
        assert!((base / (plain * (1.0 - hertz)) - 1.0).abs() < 0.05, "{base:e}");
    }

    #[test]
    fn beyond_the_map_nothing_happens() {
        let (before, mut after) = (map(1e-7), map(1e-7));
        for centre in [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]] {
            after.rub(&ABRASION, &Stroke { centre, load: 5.0, distance: 1e-6 }, &mut Vec::new());
        }
        assert_eq!(before.height, after.height);
    }
}
