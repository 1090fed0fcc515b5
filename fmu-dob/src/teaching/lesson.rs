//! The touches of a teaching: at which speed each is, and what all of them say about the bias.
//!
//! It goes through all speeds and then again, so that work which a touch dents shows as scatter.

use std::array;
use std::f64::consts::TAU;

use control_blocks::{NoEstimate, Observation, Welford, least_squares};
use nalgebra::SVector;
use serde::{Deserialize, Serialize};

use crate::interface::{Parameters, Taught};
use crate::teaching::bias::{Bias, SPEEDS};
use crate::teaching::spread::Spread;

/// Speed `i` of a teaching, m/s.
pub fn speed(p: &Parameters, i: usize) -> f64 {
    let share = i as f64 / (SPEEDS - 1) as f64;
    p.teach.velocity_min * (p.teach.velocity_max / p.teach.velocity_min).powf(share)
}

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

/// So many of the slowest speeds a conclusion may leave out: one more are left than the bias has parts.
pub const SLOWER_MAX: usize = SPEEDS - 4;

/// Touches at each speed at most.
fn most(p: &Parameters) -> u32 {
    p.teach.touches.max(p.teach.touches_max).unsigned_abs()
}

/// Touches so far; by default none.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Lesson {
    touches: u32,
    /// rounds beyond `teach.touches`
    more: u32,
    late: [Welford; SPEEDS],
}

impl Lesson {
    /// Touches so far.
    pub fn touches(&self) -> u32 {
        self.touches
    }

    /// Speed of the next touch, m/s.
    pub fn velocity(&self, p: &Parameters) -> f64 {
        speed(p, self.next())
    }

    /// Speed of the touch after that (m/s), if there may be one.
    pub fn after(&self, p: &Parameters) -> Option<f64> {
        let last = self.touches + 1 >= SPEEDS as u32 * most(p);
        (!last).then(|| speed(p, (self.next() + 1) % SPEEDS))
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
        let may = p.teach.touches.unsigned_abs() + self.more < most(p);
        self.more += u32::from(may);
        may
    }

    /// Takes how far (m) behind the first touch a contact was found at [`Self::velocity`].
    pub fn take(&mut self, late: f64) {
        self.late[self.next()].push(late);
        self.touches += 1;
    }

    /// Least and largest mean of a speed, from speed `slowest` on, m.
    pub fn extremes(&self, slowest: usize) -> [f64; 2] {
        self.late[slowest..].iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], late| {
            [least.min(late.mean()), most.max(late.mean())]
        })
    }

    /// What the touches from speed `slowest` on say of the bias, and how far a place that one more touch tells may be off. The scatter s of a speed is
    /// its own with as much weight as it has degrees of freedom, and that of all these speeds with [`POOLED`], as few touches scatter little by
    /// chance. That of a mean of n is s / n^(1/2), beside what the three parts leave out; where they leave more than both unexplained, they are less
    /// sure. A touch has at least the deviation of an encoder's step. At a slower speed the bias is as unsure as the three parts are there, and as far off
    /// as its touches were.
    ///
    /// # Errors
    /// When they do not tell the three parts apart.
    pub fn conclude(&self, p: &Parameters, slowest: usize) -> Result<(Taught, Spread), NoEstimate> {
        let touches = f64::from(self.touches / SPEEDS as u32);
        let step = p.stage.encoder_resolution / 12f64.sqrt();
        let own = self.late.map(|late| late.sigma().powi(2) + step * step);
        let judged = (SPEEDS - slowest) as f64;
        let pooled = own[slowest..].iter().sum::<f64>() / judged;
        let freedom = touches - 1.0;
        let squares: [f64; SPEEDS] =
            array::from_fn(|i| POOLED * if i < slowest { own[i] } else { pooled } + freedom * own[i]);
        let likely = squares.map(|squares| (squares / (POOLED + freedom)).sqrt());
        // what one more touch does is Student's: the mean of what its variance may be
        let touch = squares.map(|squares| (squares / (POOLED + freedom - 2.0)).sqrt());
        // parts in units of what they give at the speed in the middle
        let units = Bias::parts_at((p.teach.velocity_min * p.teach.velocity_max).sqrt());
        let parts = |i: usize| SVector::from(Bias::parts_at(speed(p, i))).component_div(&SVector::from(units));
        let found = least_squares(SVector::zeros(), SPEEDS - slowest, |k, value| {
            let i = slowest + k;
            let sigma = f64::hypot(likely[i] / touches.sqrt(), LEFT_OUT);
            Observation { residual: (parts(i).dot(value) - self.late[i].mean()) / sigma, gradient: parts(i) / sigma }
        })?;
        let variance = |i: usize| parts(i).dot(&(found.covariance * parts(i)));
        let unsure = p.teach.place_deviation;
        let deviations: [f64; SPEEDS] = array::from_fn(|i| variance(i).sqrt().hypot(LEFT_OUT).hypot(unsure));
        let deviation = deviations[slowest..].iter().copied().fold(0.0, f64::max);
        let taught = Taught {
            valid: false,
            touches: self.touches as i32,
            velocity_min: speed(p, slowest),
            bias: found.value[0] / units[0],
            bias_deviation: (found.sigma(0) / units[0]).hypot(unsure),
            bias_fast: found.value[1] / units[1],
            bias_fast_deviation: found.sigma(1) / units[1],
            bias_slow: found.value[2] / units[2],
            bias_slow_deviation: found.sigma(2) / units[2],
            deviation,
            scatter: pooled.sqrt(),
            scatter_deviation: (pooled / (2.0 * judged * freedom)).sqrt(),
        };
        let off = |i: usize| parts(i).dot(&found.value) - self.late[i].mean();
        let bias = array::from_fn(|i| if i < slowest { deviations[i].hypot(off(i)) } else { deviation });
        Ok((taught, Spread { speeds: array::from_fn(|i| speed(p, i)), touch, bias }))
    }

    fn next(&self) -> usize {
        self.touches as usize % SPEEDS
    }
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
        let mut lesson = Lesson::default();
        let left: [f64; SPEEDS] = std::array::from_fn(|_| noise(left));
        while !lesson.over(p) {
            lesson.take(TRUTH.at(lesson.velocity(p)) + left[lesson.next()] + noise(sigma));
        }
        lesson
    }

    #[test]
    fn it_goes_through_all_speeds_again_and_again() {
        let p = Parameters::START;
        let mut lesson = Lesson::default();
        let mut seen = Vec::new();
        while !lesson.over(&p) {
            seen.push((1e7 * lesson.velocity(&p)).round());
            lesson.take(0.0);
        }
        // 10 to 300 um/s
        assert_eq!((seen.len(), lesson.touches()), (20, 20));
        assert_eq!(seen[..6], [100.0, 234.0, 548.0, 1282.0, 3000.0, 100.0]);
    }

    #[test]
    fn the_parts_are_found_and_as_sure_as_told() {
        let p = Parameters::START;
        let exact = lesson(&p, 1, 0.0, 0.0).conclude(&p, 0).unwrap().0;
        for velocity in [1e-5, 5e-5, 3e-4] {
            assert!((exact.parts().at(velocity) - TRUTH.at(velocity)).abs() < 1e-12, "{exact:?}");
        }
        let many: Vec<Taught> =
            (0..400).map(|seed| lesson(&p, seed, 2e-8, LEFT_OUT).conclude(&p, 0).unwrap().0).collect();
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
        let mut lesson = Lesson::default();
        while !lesson.over(&p) {
            let round = lesson.touches() / SPEEDS as u32;
            // to and fro by 50 nm at the slowest, and by 5 nm
            let swing = if lesson.next() == 0 { 5e-8 } else { 5e-9 };
            lesson.take(TRUTH.at(lesson.velocity(&p)) + if round.is_multiple_of(2) { swing } else { -swing });
        }
        let (taught, spread) = lesson.conclude(&p, 0).unwrap();
        let variance = |x: f64| x * x * 4.0 / 3.0 + 1e-18 / 12.0;
        let pooled = (variance(5e-8) + 4.0 * variance(5e-9)) / 5.0;
        assert!((taught.scatter / pooled.sqrt() - 1.0).abs() < 1e-9, "{taught:?}");
        // three degrees of freedom of its own, and two, less the two of Student's variance
        for (touch, x) in [(spread.touch[0], 5e-8), (spread.touch[4], 5e-9)] {
            assert!((touch / ((2.0 * pooled + 3.0 * variance(x)) / 3.0).sqrt() - 1.0).abs() < 1e-9, "{spread:?}");
        }
        assert_eq!((spread.bias, spread.speeds[0]), ([taught.deviation; SPEEDS], 1e-5));
        // as sure as its mean is at the slowest: 44 nm / 2 and what is left out, less what the others know of it
        let likely = (0.4 * pooled + 0.6 * variance(5e-8)).sqrt();
        assert!((0.7..1.0).contains(&(taught.deviation / (0.5 * likely).hypot(LEFT_OUT))), "{taught:?}");
    }

    #[test]
    fn the_slowest_may_be_left_out_and_is_as_unsure_as_its_touches_are_off() {
        let p = Parameters::START;
        let mut lesson = Lesson::default();
        while !lesson.over(&p) {
            let round = lesson.touches() / SPEEDS as u32;
            // to and fro by 200 nm about 400 nm too late, or by 5 nm
            let (late, swing) = if lesson.next() == 0 { (4e-7, 2e-7) } else { (0.0, 5e-9) };
            lesson.take(TRUTH.at(lesson.velocity(&p)) + late + if round.is_multiple_of(2) { swing } else { -swing });
        }
        let (whole, (taught, spread)) = (lesson.conclude(&p, 0).unwrap().0, lesson.conclude(&p, 1).unwrap());
        assert_eq!((whole.velocity_min, taught.velocity_min), (speed(&p, 0), speed(&p, 1)));
        let variance = |x: f64| x * x * 4.0 / 3.0 + 1e-18 / 12.0;
        assert!((taught.scatter / variance(5e-9).sqrt() - 1.0).abs() < 1e-9, "{taught:?}");
        assert!((taught.scatter_deviation / taught.scatter / 24f64.sqrt().recip() - 1.0).abs() < 1e-9, "{taught:?}");
        assert!((taught.parts().at(1e-4) - TRUTH.at(1e-4)).abs() < 1e-12, "{taught:?}");
        assert!(taught.deviation < 1e-8 && whole.deviation > 1e-7, "{taught:?}");
        // its own scatter alone, by Student; what the others say of it, and that it was 400 nm off
        assert!((spread.touch[0] / (variance(2e-7) * 5.0 / 3.0).sqrt() - 1.0).abs() < 1e-9, "{spread:?}");
        assert!((4e-7..4.1e-7).contains(&spread.bias[0]), "{spread:?}");
        assert!(spread.bias[1..].iter().all(|bias| *bias == taught.deviation), "{spread:?}");
        assert!(lesson.extremes(0)[1] > 5.5e-7 && lesson.extremes(1)[1] < 4.5e-7);
    }

    #[test]
    fn a_place_that_is_hardly_known_makes_the_constant_part_less_sure_and_no_other() {
        let mut p = Parameters::START;
        let sure = lesson(&p, 3, 2e-8, 0.0).conclude(&p, 0).unwrap().0;
        p.teach.place_deviation = 1e-7;
        let unsure = lesson(&p, 3, 2e-8, 0.0).conclude(&p, 0).unwrap().0;
        assert!((unsure.bias_deviation.powi(2) - sure.bias_deviation.powi(2) - 1e-14).abs() < 1e-20);
        assert!((unsure.deviation.powi(2) - sure.deviation.powi(2) - 1e-14).abs() < 1e-20);
        assert_eq!(unsure.bias_fast_deviation, sure.bias_fast_deviation);
    }

    #[test]
    fn no_bias_is_surer_than_what_the_three_parts_leave_out() {
        let p = Parameters::START;
        let taught = lesson(&p, 4, 0.0, 0.0).conclude(&p, 0).unwrap().0;
        assert!((1.0..1.5).contains(&(taught.deviation / LEFT_OUT)), "{taught:?}");
        assert!(taught.bias_deviation > 0.3 * LEFT_OUT, "{taught:?}");
    }

    #[test]
    fn what_the_three_parts_do_not_explain_makes_them_less_sure() {
        let p = Parameters::START;
        let bent = |by: f64| {
            let mut lesson = Lesson::default();
            while !lesson.over(&p) {
                let odd = if lesson.next() == 2 { by } else { 0.0 };
                // to and fro by 10 nm
                let scatter = if (lesson.touches() / SPEEDS as u32).is_multiple_of(2) { 1e-8 } else { -1e-8 };
                lesson.take(TRUTH.at(lesson.velocity(&p)) + odd + scatter);
            }
            lesson.conclude(&p, 0).unwrap().0.deviation
        };
        assert!(bent(1e-7) > 3.0 * bent(0.0), "{} {}", bent(1e-7), bent(0.0));
    }

    #[test]
    fn the_rounds_spread_over_half_a_turn_of_the_spindle_after_any_number_of_touches() {
        for between in 1..SPEEDS {
            let mut lesson = Lesson::default();
            let mut shares: Vec<f64> = (0..5)
                .map(|_| {
                    // 10 ms a turn, either way round
                    let pause = lesson.pause(TAU / 0.01);
                    assert_eq!(
                        (pause, 0.0, 0.0),
                        (lesson.pause(-TAU / 0.01), lesson.pause(0.0), lesson.pause(TAU / 0.1))
                    );
                    (0..SPEEDS).for_each(|_| lesson.take(0.0));
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
        let mut lesson = Lesson::default();
        while !lesson.over(&p) {
            let late = [3e-7, -1e-7, 2e-7, 2e-7, 2e-7][lesson.next()];
            lesson.take(late + if lesson.touches() < 5 { 1e-8 } else { 0.0 });
        }
        let [least, most] = lesson.extremes(0);
        assert!((least + 9.75e-8).abs() < 1e-15 && (most - 3.025e-7).abs() < 1e-15, "{least} {most}");
    }
}
