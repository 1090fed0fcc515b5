//! The touches of a teaching: at which speed each is, and what all of them say about the bias.
//!
//! It goes through all speeds and then again, so that work which a touch dents shows as scatter. On hard work the first round lowers the speeds
//! that are still to come to what `teach.force_max` bears.

use std::array;
use std::f64::consts::TAU;

use control_blocks::{NoEstimate, Observation, Welford, least_squares};
use nalgebra::SVector;
use serde::{Deserialize, Serialize};

use crate::interface::{Parameters, Taught};
use crate::teaching::bias::{Bias, SPEEDS};
use crate::teaching::press::Hardness;
use crate::teaching::spread::Spread;

/// Least ratio of the fastest speed to the slowest.
pub const RATIO: f64 = 3.0;

/// A stage may be so many times heavier than told, and each force as many times larger.
const HEAVIER: f64 = 1.3;
/// So many times harder than one touch at a speed others may press there, as the flutes lie at another angle.
const SCATTER: f64 = 1.2;
/// So many times harder than slower ones tell a touch may press.
const FASTER: f64 = 1.3;

/// What the three parts leave out at a speed, as deviation, m: the likeliest beside the scatter of the five means of 29 machines whose mass
/// and thrust constant are wrong by up to 30 %, on work of 0.1 to 2 N/um.
const LEFT_OUT: f64 = 6e-9;

/// Share of a turn of the spindle for which the stage stands longer before each touch of a round than before one of the round before. The touches between
/// two that a flute holds add up: up to four of them come 0.4 to 1.6 turns later in each round, so that five rounds spread evenly over the half of a
/// turn with two flutes.
const LATER: f64 = 0.4;
/// A turn that takes longer is not waited for, s.
const TURN_MAX: f64 = 0.1;

/// Degrees of freedom with which the scatter of all speeds counts beside that of one: more than one, or two touches have no variance, and few, as one
/// speed may scatter several times as much as the others.
const POOLED: f64 = 2.0;

/// Touches at each speed at most.
fn most(p: &Parameters) -> u32 {
    p.teach.touches.max(p.teach.touches_max).unsigned_abs()
}

/// Touches so far.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Lesson {
    /// the slowest first, m/s
    speeds: [f64; SPEEDS],
    /// those that count
    touches: u32,
    /// those at speeds that were given up
    given_up: u32,
    /// rounds beyond `teach.touches`
    more: u32,
    late: [Welford; SPEEDS],
    hardness: Hardness,
}

impl Lesson {
    /// None so far, and the speeds of the parameters.
    pub fn new(p: &Parameters) -> Self {
        let slowest = p.teach.velocity_min;
        Self {
            speeds: array::from_fn(|i| between(slowest, p.teach.velocity_max, i, SPEEDS - 1)),
            touches: 0,
            given_up: 0,
            more: 0,
            late: [Welford::default(); SPEEDS],
            hardness: Hardness::default(),
        }
    }

    /// Touches so far.
    pub fn touches(&self) -> u32 {
        self.touches + self.given_up
    }

    /// Speed of the next touch, m/s.
    pub fn velocity(&self) -> f64 {
        self.speeds[self.next()]
    }

    /// Lowers the speeds of the first round that are still to come, where the next touch would press harder than `teach.force_max`, and the fastest
    /// where that has come near it; the force grows as the speed. Those that were touched and are slower than what is bearable stay.
    ///
    /// # Errors
    /// When that leaves too little of the range: the fastest speed that is bearable, m/s.
    pub fn lower(&mut self, p: &Parameters) -> Result<(), f64> {
        let next = self.touches as usize;
        if p.teach.force_max == 0.0 || next > SPEEDS {
            return Ok(());
        }
        let speed = self.speeds[next.min(SPEEDS - 1)];
        let margin = HEAVIER * SCATTER * if speed > self.hardness.fastest() { FASTER } else { 1.0 };
        let fastest = p.teach.force_max / (margin * self.hardness.slope());
        if speed <= fastest {
            return Ok(());
        }
        if fastest < RATIO * p.teach.velocity_min {
            return Err(fastest);
        }
        let stay = self.speeds[..next].iter().take_while(|speed| **speed < fastest).count().max(1);
        let from = self.speeds[stay - 1];
        for i in stay..SPEEDS {
            self.speeds[i] = between(from, fastest, i + 1 - stay, SPEEDS - stay);
            self.late[i] = Welford::default();
        }
        (self.touches, self.given_up) = (stay as u32, self.given_up + (next - stay) as u32);
        Ok(())
    }

    /// Speed of the touch after that (m/s), if there may be one.
    pub fn after(&self, p: &Parameters) -> Option<f64> {
        let last = self.touches + 1 >= SPEEDS as u32 * most(p);
        (!last).then(|| self.speeds[(self.next() + 1) % SPEEDS])
    }

    /// How long (s) the stage stands before the next touch, at `spindle_speed` rad/s. A slow touch is found where a flute cuts, and all that
    /// follows takes equally long: without this each speed would touch at one angle of the spindle, and its mean be wrong by what that makes.
    pub fn pause(&self, spindle_speed: f64) -> f64 {
        let round = f64::from(self.touches / SPEEDS as u32);
        if TAU < TURN_MAX * spindle_speed.abs() { (LATER * round).fract() * TAU / spindle_speed.abs() } else { 0.0 }
    }

    /// Whether all speeds were touched as often as they are to be.
    pub fn over(&self, p: &Parameters) -> bool {
        self.touches >= SPEEDS as u32 * (p.teach.touches.unsigned_abs() + self.more)
    }

    /// Touches at all speeds once more, if that may be; whether it may.
    pub fn once_more(&mut self, p: &Parameters) -> bool {
        let may = self.touches() + SPEEDS as u32 <= SPEEDS as u32 * most(p);
        self.more += u32::from(may);
        may
    }

    /// Takes how far (m) behind the first touch a contact was found at [`Self::velocity`], and how hard (N) it pressed.
    pub fn take(&mut self, late: f64, force: f64) {
        self.hardness.push(self.velocity(), force);
        self.late[self.next()].push(late);
        self.touches += 1;
    }

    /// Least and largest mean of a speed, m.
    pub fn extremes(&self) -> [f64; 2] {
        self.late.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], late| {
            [least.min(late.mean()), most.max(late.mean())]
        })
    }

    /// What all touches say, and how far a place that one more touch tells may be off. The scatter s of a speed is its own with as much weight as
    /// it has degrees of freedom, and that of all speeds with [`POOLED`], as few touches scatter little by chance. That of a mean of n is
    /// s / n^(1/2), beside what the three parts leave out; where they leave more than both unexplained, they are less sure. A touch
    /// has at least the deviation of an encoder's step.
    ///
    /// # Errors
    /// When they do not tell the three parts apart.
    pub fn conclude(&self, p: &Parameters) -> Result<(Taught, Spread), NoEstimate> {
        let touches = f64::from(self.touches / SPEEDS as u32);
        let step = p.stage.encoder_resolution / 12f64.sqrt();
        let own = self.late.map(|late| late.sigma().powi(2) + step * step);
        let pooled = own.iter().sum::<f64>() / SPEEDS as f64;
        let freedom = touches - 1.0;
        let squares = own.map(|own| POOLED * pooled + freedom * own);
        let likely = squares.map(|squares| (squares / (POOLED + freedom)).sqrt());
        // what one more touch does is Student's: the mean of what its variance may be
        let touch = squares.map(|squares| (squares / (POOLED + freedom - 2.0)).sqrt());
        // parts in units of what they give at the speed in the middle
        let units = Bias::parts_at((self.speeds[0] * self.speeds[SPEEDS - 1]).sqrt());
        let parts = |i: usize| SVector::from(Bias::parts_at(self.speeds[i])).component_div(&SVector::from(units));
        let found = least_squares(SVector::zeros(), SPEEDS, |i, value| {
            let sigma = f64::hypot(likely[i] / touches.sqrt(), LEFT_OUT);
            Observation { residual: (parts(i).dot(value) - self.late[i].mean()) / sigma, gradient: parts(i) / sigma }
        })?;
        let variance = |i: usize| parts(i).dot(&(found.covariance * parts(i)));
        let unsure = p.teach.place_deviation;
        let deviation = (0..SPEEDS).map(variance).fold(0.0, f64::max).sqrt().hypot(LEFT_OUT).hypot(unsure);
        let taught = Taught {
            valid: false,
            touches: self.touches() as i32,
            velocity_max: self.speeds[SPEEDS - 1],
            bias: found.value[0] / units[0],
            bias_deviation: (found.sigma(0) / units[0]).hypot(unsure),
            bias_fast: found.value[1] / units[1],
            bias_fast_deviation: found.sigma(1) / units[1],
            bias_slow: found.value[2] / units[2],
            bias_slow_deviation: found.sigma(2) / units[2],
            deviation,
            scatter: pooled.sqrt(),
            scatter_deviation: (pooled / (2.0 * SPEEDS as f64 * freedom)).sqrt(),
        };
        Ok((taught, Spread { speeds: self.speeds, touch, bias: deviation }))
    }

    fn next(&self) -> usize {
        self.touches as usize % SPEEDS
    }
}

/// Speed `i` of `n` behind `from` (m/s), which lie in equal ratios, the last at `to`.
fn between(from: f64, to: f64, i: usize, n: usize) -> f64 {
    from * (to / from).powf(i as f64 / n as f64)
}

impl Taught {
    /// The bias that was taught.
    pub fn parts(&self) -> Bias {
        Bias { constant: self.bias, fast: self.bias_fast, slow: self.bias_slow }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    const TRUTH: Bias = Bias { constant: 1.6e-7, fast: 1.3e-7, slow: 3.5e-13 };

    /// A whole lesson whose touches scatter by `sigma` m, and what the three parts leave out at the speeds by `left` m.
    fn lesson(p: &Parameters, seed: u64, sigma: f64, left: f64) -> Lesson {
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
        let mut noise =
            |deviation: f64| -> f64 { deviation * Distribution::<f64>::sample(&StandardNormal, &mut random) };
        let mut lesson = Lesson::new(&p);
        let left: [f64; SPEEDS] = std::array::from_fn(|_| noise(left));
        while !lesson.over(p) {
            lesson.take(TRUTH.at(lesson.velocity()) + left[lesson.next()] + noise(sigma), 0.0);
        }
        lesson
    }

    #[test]
    fn it_goes_through_all_speeds_again_and_again() {
        let p = Parameters::START;
        let mut lesson = Lesson::new(&p);
        let mut seen = Vec::new();
        while !lesson.over(&p) {
            seen.push((1e7 * lesson.velocity()).round());
            lesson.take(0.0, 0.0);
        }
        // 10 to 300 um/s
        assert_eq!((seen.len(), lesson.touches()), (20, 20));
        assert_eq!(seen[..6], [100.0, 234.0, 548.0, 1282.0, 3000.0, 100.0]);
    }

    #[test]
    fn the_parts_are_found_and_as_sure_as_told() {
        let p = Parameters::START;
        let exact = lesson(&p, 1, 0.0, 0.0).conclude(&p).unwrap().0;
        for velocity in [1e-5, 5e-5, 3e-4] {
            assert!((exact.parts().at(velocity) - TRUTH.at(velocity)).abs() < 1e-12, "{exact:?}");
        }
        let many: Vec<Taught> = (0..400).map(|seed| lesson(&p, seed, 2e-8, LEFT_OUT).conclude(&p).unwrap().0).collect();
        let rms = |of: &dyn Fn(&Taught) -> f64| (many.iter().map(|t| of(t).powi(2)).sum::<f64>() / 400.0).sqrt();
        for ratio in [
            rms(&|t| (t.bias - TRUTH.constant) / t.bias_deviation),
            rms(&|t| (t.bias_fast - TRUTH.fast) / t.bias_fast_deviation),
            rms(&|t| (t.bias_slow - TRUTH.slow) / t.bias_slow_deviation),
            rms(&|t| (t.scatter - 2e-8) / t.scatter_deviation),
        ] {
            assert!((0.8..1.2).contains(&ratio), "{ratio}");
        }
        // at the ends of the range it is the least sure; what is left out there is in it besides
        let worst = [1e-5, 3e-4].map(|v| rms(&|t| (t.parts().at(v) - TRUTH.at(v)).hypot(LEFT_OUT) / t.deviation));
        assert!(worst.iter().all(|ratio| *ratio < 1.2) && worst[0].max(worst[1]) > 0.8, "{worst:?}");
    }

    #[test]
    fn a_speed_whose_touches_scatter_more_is_told_with_more_and_counts_for_less() {
        let p = Parameters::START;
        let mut lesson = Lesson::new(&p);
        while !lesson.over(&p) {
            let round = lesson.touches() / SPEEDS as u32;
            // to and fro by 50 nm at the slowest, and by 5 nm
            let swing = if lesson.next() == 0 { 5e-8 } else { 5e-9 };
            lesson.take(TRUTH.at(lesson.velocity()) + if round.is_multiple_of(2) { swing } else { -swing }, 0.0);
        }
        let (taught, spread) = lesson.conclude(&p).unwrap();
        let variance = |x: f64| x * x * 4.0 / 3.0 + 1e-18 / 12.0;
        let pooled = (variance(5e-8) + 4.0 * variance(5e-9)) / 5.0;
        assert!((taught.scatter / pooled.sqrt() - 1.0).abs() < 1e-9, "{taught:?}");
        // three degrees of freedom of its own, and two, less the two of Student's variance
        for (touch, x) in [(spread.touch[0], 5e-8), (spread.touch[4], 5e-9)] {
            assert!((touch / ((2.0 * pooled + 3.0 * variance(x)) / 3.0).sqrt() - 1.0).abs() < 1e-9, "{spread:?}");
        }
        assert_eq!((spread.bias, spread.speeds[0]), (taught.deviation, 1e-5));
        // as sure as its mean is at the slowest: 44 nm / 2 and what is left out, less what the others know of it
        let likely = (0.4 * pooled + 0.6 * variance(5e-8)).sqrt();
        assert!((0.7..1.0).contains(&(taught.deviation / (0.5 * likely).hypot(LEFT_OUT))), "{taught:?}");
    }

    #[test]
    fn a_place_that_is_hardly_known_makes_the_constant_part_less_sure_and_no_other() {
        let mut p = Parameters::START;
        let sure = lesson(&p, 3, 2e-8, 0.0).conclude(&p).unwrap().0;
        p.teach.place_deviation = 1e-7;
        let unsure = lesson(&p, 3, 2e-8, 0.0).conclude(&p).unwrap().0;
        assert!((unsure.bias_deviation.powi(2) - sure.bias_deviation.powi(2) - 1e-14).abs() < 1e-20);
        assert!((unsure.deviation.powi(2) - sure.deviation.powi(2) - 1e-14).abs() < 1e-20);
        assert_eq!(unsure.bias_fast_deviation, sure.bias_fast_deviation);
    }

    #[test]
    fn no_bias_is_surer_than_what_the_three_parts_leave_out() {
        let p = Parameters::START;
        let taught = lesson(&p, 4, 0.0, 0.0).conclude(&p).unwrap().0;
        assert!((1.0..1.5).contains(&(taught.deviation / LEFT_OUT)), "{taught:?}");
        assert!(taught.bias_deviation > 0.3 * LEFT_OUT, "{taught:?}");
    }

    #[test]
    fn what_the_three_parts_do_not_explain_makes_them_less_sure() {
        let p = Parameters::START;
        let bent = |by: f64| {
            let mut lesson = Lesson::new(&p);
            while !lesson.over(&p) {
                let odd = if lesson.next() == 2 { by } else { 0.0 };
                // to and fro by 10 nm
                let scatter = if (lesson.touches() / SPEEDS as u32).is_multiple_of(2) { 1e-8 } else { -1e-8 };
                lesson.take(TRUTH.at(lesson.velocity()) + odd + scatter, 0.0);
            }
            lesson.conclude(&p).unwrap().0.deviation
        };
        assert!(bent(1e-7) > 3.0 * bent(0.0), "{} {}", bent(1e-7), bent(0.0));
    }

    #[test]
    fn the_rounds_spread_over_half_a_turn_of_the_spindle_after_any_number_of_touches() {
        for between in 1..SPEEDS {
            let mut lesson = Lesson::new(&Parameters::START);
            let mut shares: Vec<f64> = (0..5)
                .map(|_| {
                    // 10 ms a turn, either way round
                    let pause = lesson.pause(TAU / 0.01);
                    assert_eq!(
                        (pause, 0.0, 0.0),
                        (lesson.pause(-TAU / 0.01), lesson.pause(0.0), lesson.pause(TAU / 0.1))
                    );
                    (0..SPEEDS).for_each(|_| lesson.take(0.0, 0.0));
                    (between as f64 * pause / 0.01 * 2.0 + 0.05).fract()
                })
                .collect();
            shares.sort_by(f64::total_cmp);
            assert!(
                shares.iter().zip(0..).all(|(share, k)| (share - 0.05 - 0.2 * f64::from(k)).abs() < 1e-9),
                "{shares:?}"
            );
        }
    }

    #[test]
    fn the_extremes_are_means_of_a_speed() {
        let p = Parameters::START;
        let mut lesson = Lesson::new(&p);
        while !lesson.over(&p) {
            let late = [3e-7, -1e-7, 2e-7, 2e-7, 2e-7][lesson.next()];
            lesson.take(late + if lesson.touches() < 5 { 1e-8 } else { 0.0 }, 0.0);
        }
        let [least, most] = lesson.extremes();
        assert!((least + 9.75e-8).abs() < 1e-15 && (most - 3.025e-7).abs() < 1e-15, "{least} {most}");
    }

    /// A lesson whose touches press as `force` says (N) of their speed (m/s), after the first round; or the error that ends it.
    fn pressed(p: &Parameters, force: impl Fn(f64) -> f64) -> Result<Lesson, f64> {
        let mut lesson = Lesson::new(p);
        while lesson.touches < SPEEDS as u32 {
            lesson.take(1e-7, force(lesson.velocity()));
            lesson.lower(p)?;
        }
        Ok(lesson)
    }

    fn speeds(lesson: &Lesson) -> [f64; SPEEDS] {
        lesson.speeds.map(|speed| (1e7 * speed).round() / 10.0)
    }

    #[test]
    fn hard_work_lowers_the_speeds_that_are_still_to_come() {
        let mut p = Parameters::START;
        let hard = |slope: f64| move |velocity: f64| slope * velocity;
        // no limit, however hard
        assert_eq!(speeds(&pressed(&p, hard(1e6)).unwrap()), [10.0, 23.4, 54.8, 128.2, 300.0]);
        p.teach.force_max = 0.8;
        // bearable is 0.8 N less 30 % of mass, 20 % of scatter and 30 % of what is not known yet
        let at = |speed: f64| 0.8 / (1.3 * 1.2 * 1.3 * 1e-6 * speed);
        for (slope, expected) in [
            (at(300.1), [10.0, 23.4, 54.8, 128.2, 300.0]),
            (at(200.0), [10.0, 23.4, 54.8, 128.2, 200.0]),
            (at(50.0), [10.0, 23.4, 30.1, 38.8, 50.0]),
        ] {
            let lesson = pressed(&p, hard(slope)).unwrap();
            assert_eq!((speeds(&lesson), lesson.touches()), (expected, 5), "{slope}");
        }
        // three times the slowest, and a little less
        let fastest = |slope: f64| pressed(&p, hard(slope)).map(|lesson| speeds(&lesson)[SPEEDS - 1]);
        assert_eq!(fastest(at(30.001)), Ok(30.0));
        assert!(fastest(at(29.9)).is_err_and(|speed| (speed - 29.9e-6).abs() < 1e-12));
    }

    #[test]
    fn the_fastest_touch_of_the_first_round_is_given_up_where_others_may_press_too_hard() {
        let mut p = Parameters::START;
        p.teach.force_max = 0.8;
        // what all five tell of 300 um/s is bearable up to 0.8 N less 30 % of mass and 20 % of scatter
        let after = |force: f64| {
            let hard = |velocity: f64| if velocity > 2.99e-4 { force } else { 1000.0 * velocity };
            let lesson = pressed(&p, hard).unwrap();
            (speeds(&lesson), lesson.touches())
        };
        assert_eq!(after(0.55), ([10.0, 23.4, 54.8, 128.2, 300.0], 5));
        assert_eq!(after(0.57), ([10.0, 23.4, 54.8, 128.2, 295.4], 6));
        assert_eq!(after(2.0), ([10.0, 23.4, 54.8, 70.6, 91.0], 7));
    }

    #[test]
    fn a_touch_that_has_pressed_too_hard_is_given_up_and_counts_for_how_often_more_may_follow() {
        let mut p = Parameters::START;
        (p.teach.force_max, p.teach.touches, p.teach.touches_max) = (0.8, 2, 4);
        let mut given_up = false;
        let mut lesson = Lesson::new(&p);
        while !lesson.over(&p) {
            let jump = !given_up && lesson.next() == 2;
            given_up |= jump;
            // 0.5 N at 54.8 um/s: bearable are 45 um/s, by all three touches
            lesson.take(TRUTH.at(lesson.velocity()), if jump { 0.5 } else { 1000.0 * lesson.velocity() });
            lesson.lower(&p).unwrap();
        }
        let speeds = speeds(&lesson);
        assert!(given_up && speeds[1] == 23.4 && speeds[4] > 43.0 && speeds[4] < 53.0, "{speeds:?}");
        assert!((speeds[3] / speeds[2] - speeds[4] / speeds[3]).abs() < 0.01, "{speeds:?}");
        assert_eq!((lesson.touches(), lesson.touches), (11, 10));
        let (taught, spread) = lesson.conclude(&p).unwrap();
        assert_eq!((taught.touches, taught.velocity_max, spread.speeds), (11, lesson.speeds[4], lesson.speeds));
        // the bias is that of the speeds that were touched
        assert!((taught.parts().at(4e-5) - TRUTH.at(4e-5)).abs() < 1e-12, "{taught:?}");
        // 16 of at most 20, and 21 are too many
        assert!(lesson.once_more(&p));
        (0..SPEEDS).for_each(|_| lesson.take(0.0, 9.0));
        assert_eq!(lesson.lower(&p), Ok(()));
        assert!(lesson.over(&p) && !lesson.once_more(&p));
    }
}
