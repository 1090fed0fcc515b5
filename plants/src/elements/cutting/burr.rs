//! Burr along an edge: the remaining burr, bin by bin.

/// Height and thickness of a burr over the distance along its edge; heights decrease as a tool passes.
#[derive(Clone, Debug)]
pub struct Burr {
    /// distance of the first bin, m
    from: f64,
    /// length of a bin, m
    pitch: f64,
    /// m
    thickness: Vec<f64>,
    /// remaining height, negative after gouging, m
    left: Vec<f64>,
    /// lowest and highest of the passed bins, m
    finish: [f64; 2],
}

impl Burr {
    /// A burr from the distance `from` m on, in bins of `pitch` m; none if the columns differ in length.
    pub fn new(from: f64, pitch: f64, height: Vec<f64>, thickness: Vec<f64>) -> Option<Self> {
        let fits = height.len() == thickness.len() && pitch > 0.0;
        fits.then_some(Self { from, pitch, thickness, left: height, finish: [0.0; 2] })
    }

    /// Remaining height and thickness at a distance, m; zero outside of the part.
    pub fn at(&self, distance: f64) -> (f64, f64) {
        let bin = ((distance - self.from) / self.pitch).floor();
        let inside = bin >= 0.0 && bin < self.left.len() as f64;
        if inside { (self.left[bin as usize], self.thickness[bin as usize]) } else { (f64::NEG_INFINITY, 0.0) }
    }

    /// A tool `deviation` m outside of the edge leaves the bins between two distances; returns the volume cut in m3.
    ///
    /// A bin is passed when the tool has reached its end, or its start when it moves backward.
    pub fn pass(&mut self, before: f64, now: f64, deviation: f64) -> f64 {
        let boundary = |distance: f64| ((distance - self.from) / self.pitch).floor().clamp(0.0, self.left.len() as f64);
        // a tool that moves forward has cut the previous bins, one that moves backward the next ones
        let (first, end) = if now >= before {
            (boundary(before), boundary(now))
        } else {
            (boundary(now + self.pitch), boundary(before + self.pitch))
        };
        let mut volume = 0.0;
        for bin in first as usize..end as usize {
            let cut = (self.left[bin] - deviation).max(0.0);
            self.left[bin] -= cut;
            volume += cut * self.thickness[bin] * self.pitch;
            self.finish = [self.finish[0].min(self.left[bin]), self.finish[1].max(self.left[bin])];
        }
        volume
    }

    /// Lowest and highest height after the passes so far, m.
    pub fn finish(&self) -> [f64; 2] {
        self.finish
    }

    /// Volume above the edge, m3.
    pub fn volume(&self) -> f64 {
        let sections = self.left.iter().zip(&self.thickness).map(|(left, thickness)| left.max(0.0) * thickness);
        self.pitch * sections.sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 10 bins of 1 mm from 20 mm on, 3 mm high, 2 mm thick
    fn burr() -> Burr {
        Burr::new(0.02, 1e-3, vec![3e-3; 10], vec![2e-3; 10]).expect("fits")
    }

    #[test]
    fn a_pass_cuts_what_it_has_passed_and_no_more() {
        let mut burr = burr();
        let volume = burr.pass(0.019, 0.0245, 1e-4);
        assert!((volume - 4.0 * 2.9e-3 * 2e-3 * 1e-3).abs() < 1e-18);
        assert!((burr.at(0.0235).0 - 1e-4).abs() < 1e-15);
        assert_eq!(burr.at(0.0245), (3e-3, 2e-3));
        assert!((burr.volume() + volume - 10.0 * 6e-9).abs() < 1e-18);
        // the second pass finds nothing, a lower one the rest
        assert_eq!(burr.pass(0.019, 0.0245, 1e-4), 0.0);
        let gouge = burr.pass(0.019, 0.0245, -2e-4);
        assert!((gouge - 4.0 * 3e-4 * 2e-6).abs() < 1e-18);
        assert!((burr.finish()[0] + 2e-4).abs() < 1e-15);
        assert!((burr.finish()[1] - 1e-4).abs() < 1e-15);
    }

    #[test]
    fn many_small_steps_cut_as_one_large_one_in_both_directions() {
        for (from, to) in [(0.0185, 0.0312), (0.0312, 0.0185)] {
            let (mut once, mut many) = (burr(), burr());
            let all = once.pass(from, to, 5e-4);
            let at = |k: i32| from + (to - from) * f64::from(k) / 777.0;
            let sum: f64 = (0..777).map(|k| many.pass(at(k), at(k + 1), 5e-4)).sum();
            assert!((all - 10.0 * 2.5e-3 * 2e-6).abs() < 1e-15, "{all} m3");
            assert!((all - sum).abs() < 1e-15);
        }
    }

    #[test]
    fn beside_the_part_there_is_nothing() {
        let mut burr = burr();
        assert_eq!(burr.at(0.0199).0, f64::NEG_INFINITY);
        assert_eq!(burr.at(0.0301).0, f64::NEG_INFINITY);
        assert_eq!(burr.pass(0.0, 0.019, 0.0), 0.0);
        assert_eq!(burr.pass(0.031, 1.0, 0.0), 0.0);
        assert_eq!((burr.finish(), burr.at(0.025)), ([0.0; 2], (3e-3, 2e-3)));
        assert!(Burr::new(0.0, 1e-3, vec![1.0], vec![]).is_none());
    }
}
