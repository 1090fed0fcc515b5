//! A teaching as the controller sees it: which touch is next, what was learned, and which bias is in force.

use control_blocks::{InForce, SIGNIFICANT, ticks};
use serde::{Deserialize, Serialize};

use crate::interface::{Approach, Measured, Parameters, Taught};
use crate::monitoring::rest::SETTLING;
use crate::teaching::bias::Bias;
use crate::teaching::lesson::Lesson;
use crate::teaching::press::{Drive, Press};
use crate::teaching::spread::Spread;

/// One teaching after the other.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Teacher {
    /// What was learned.
    pub taught: Taught,
    /// Touches are made to learn from them.
    pub active: bool,
    /// All touches are made, and what they say cannot be used.
    pub rejected: bool,
    /// The fastest speed that `teach.force_max` bears (m/s), where that is too slow to teach.
    pub bearable: Option<f64>,
    broken: bool,
    /// samples for which the stage still stands before the next touch
    pause: u32,
    lesson: Lesson,
    press: Press,
    bias: InForce<Bias>,
    /// how sure the bias in force is, where it was taught
    spread: Option<Spread>,
}

impl Teacher {
    /// Nothing learned so far.
    pub fn new(p: &Parameters) -> Self {
        Self {
            taught: Taught::START,
            active: false,
            rejected: false,
            bearable: None,
            broken: false,
            pause: 0,
            lesson: Lesson::new(p),
            press: Press::default(),
            bias: InForce::new(Bias::of(p)),
            spread: None,
        }
    }

    /// Begins.
    pub fn begin(&mut self, p: &Parameters) {
        (self.taught, self.lesson) = (Taught::START, Lesson::new(p));
        (self.active, self.rejected, self.bearable) = (true, false, None);
        (self.broken, self.pause) = (false, 0);
    }

    /// Is to end before its end; whether that is news.
    pub fn break_off(&mut self) -> bool {
        let news = self.active && !self.broken && !self.rejected && !self.taught.valid;
        self.broken |= news;
        news
    }

    /// Whether it is to end before its end.
    pub fn broken(&self) -> bool {
        self.broken
    }

    /// Whether there is no touch to be made any more.
    pub fn over(&self) -> bool {
        self.broken || self.taught.valid
    }

    /// Whether it has come to its end, good or not.
    pub fn ended(&self) -> bool {
        self.over() || self.rejected
    }

    /// Ends; one that has not come to a good end leaves what was told.
    pub fn end(&mut self) {
        if self.active && !self.taught.valid {
            self.bias.restore();
            self.spread = None;
        }
        self.active = false;
    }

    /// The next approach: that of the parameters, no faster than was taught with `teach.force_max`, and in a teaching at the speed that is next.
    pub fn approach(&self, p: &Parameters) -> Approach {
        let touch = self.active && !self.ended();
        let velocity = if touch { self.lesson.velocity() } else { self.job_velocity(p) };
        Approach { velocity, ..p.approach }
    }

    /// The approach after the touch that is being made: the next one of the teaching, or that of a job behind it.
    pub fn approach_after(&self, p: &Parameters) -> Approach {
        let after = self.lesson.after(p).filter(|_| !self.ended());
        Approach { velocity: after.unwrap_or_else(|| self.job_velocity(p)), ..p.approach }
    }

    /// Speed of a job, m/s.
    fn job_velocity(&self, p: &Parameters) -> f64 {
        let limit = self.spread.filter(|_| p.teach.force_max > 0.0).map(|spread| spread.fastest());
        limit.map_or(p.approach.velocity, |fastest| p.approach.velocity.min(fastest))
    }

    /// One sample at `position` m, towards the work, with the current that acted (A), on a machine of which a commission may have measured something: how hard
    /// the touch presses, where that is asked for.
    pub fn feel(&mut self, p: &Parameters, measured: &Measured, position: f64, acted: f64, found: bool) {
        if self.active && p.teach.force_max > 0.0 {
            let depth = position - p.direction() * p.teach.place;
            self.press.update(p, &Drive::of(p, measured), depth, acted, self.lesson.velocity(), found);
        }
    }

    /// One sample at rest before the next touch; whether it is to be made now.
    pub fn rested(&mut self) -> bool {
        let rested = self.pause == 0 || self.over();
        self.pause = self.pause.saturating_sub(1);
        rested
    }

    /// Takes a contact (m, towards the work) of the approach that has just ended, with a spindle at `spindle_speed` rad/s.
    pub fn take(&mut self, p: &Parameters, measured: &Measured, contact: f64, spindle_speed: f64) {
        let late = contact - p.direction() * p.teach.place;
        self.lesson.take(p, late, self.press.force(&Drive::of(p, measured)));
        self.taught.touches = self.lesson.touches() as i32;
        let next = self.lesson.velocity();
        self.bearable = self.lesson.lower(p).err();
        self.rejected = self.bearable.is_some();
        // what needs a longer way than was gone back leaves a motion
        let settle = if self.lesson.velocity() > next { SETTLING / p.servo.bandwidth } else { 0.0 };
        self.pause = ticks(self.lesson.pause(spindle_speed).max(settle), p.sample_period);
        if self.lesson.over(p) {
            self.conclude(p);
        }
    }

    /// Least and largest mean bias of a speed, m.
    pub fn extremes(&self) -> [f64; 2] {
        self.lesson.extremes()
    }

    /// The bias in force: what was taught where `teach.apply` says so, else what the parameters tell now, as they are tunable.
    pub fn bias(&self, p: &Parameters) -> Bias {
        if self.bias.as_told() { Bias::of(p) } else { self.bias.now() }
    }

    /// Standard deviation (m) of the place that a touch at `velocity` m/s tells with the bias in force; 0 where that was not taught.
    pub fn deviation(&self, velocity: f64) -> f64 {
        self.spread.map_or(0.0, |spread| spread.at(velocity))
    }

    /// Names and values of what a good teaching has learned.
    pub fn derived(&self) -> [(&'static str, f64); 4] {
        let [constant, fast, slow] = self.bias.derived().entries();
        [constant, fast, slow, ("teach.velocity_max", self.taught.velocity_max)]
    }

    fn conclude(&mut self, p: &Parameters) {
        let found = self.lesson.conclude(p);
        self.taught = found.map_or(self.taught, |(taught, _)| taught);
        let possible = possible(p, &self.taught, self.extremes());
        match found {
            Ok((taught, spread)) if possible && sure(p, &taught) => {
                self.taught.valid = true;
                self.bias.conclude(taught.parts(), p.teach.apply);
                self.spread = p.teach.apply.then_some(spread);
            }
            _ => self.rejected = !(possible && self.lesson.once_more(p)),
        }
    }
}

/// Whether the touches are alike and the bias sure.
fn sure(p: &Parameters, taught: &Taught) -> bool {
    taught.scatter <= p.limits.touch_scatter && taught.deviation <= p.teach.deviation_max
}

/// Whether the bias is one that can be: none is found before the touch, beyond what place and scatter explain, nor so late that the
/// work is too soft.
fn possible(p: &Parameters, taught: &Taught, [least, most]: [f64; 2]) -> bool {
    least >= -SIGNIFICANT * taught.deviation && most <= p.limits.bias
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    /// A teaching whose touches are as late (m) as `late` says, at a place of 50 um; with what it is afterwards.
    fn taught(p: &Parameters, late: impl Fn(f64, u32) -> f64) -> Teacher {
        let mut teacher = Teacher::new(p);
        teacher.begin(p);
        for touch in 0..20 {
            assert!(!teacher.over() && !teacher.rejected);
            let velocity = teacher.approach(p).velocity;
            teacher.take(p, &Measured::START, p.direction() * p.teach.place + late(velocity, touch), 0.0);
        }
        teacher
    }

    fn parameters(change: impl Fn(&mut Parameters)) -> Parameters {
        let mut p = Parameters::START;
        (p.teach.place, p.teach.touches_max) = (5e-5, 4);
        change(&mut p);
        p
    }

    #[test]
    fn a_good_teaching_is_in_force_where_it_is_to_be_and_derived_in_any_case() {
        for (apply, direction) in [(false, 1), (true, 1), (true, -1)] {
            let p = parameters(|p| (p.teach.apply, p.approach.direction) = (apply, direction));
            let truth = Bias { constant: 2e-7, fast: 1e-7, slow: 0.0 };
            let teacher = taught(&p, |v, _| truth.at(v));
            assert!(teacher.taught.valid && teacher.over() && !teacher.rejected);
            let mut later = p.clone();
            later.contact.bias = 7e-7;
            let expected = if apply { 3e-7 } else { 7e-7 };
            assert!((teacher.bias(&later).at(1e-4) - expected).abs() < 1e-12, "{apply}");
            let derived = teacher.derived();
            assert!((derived[0].1 - 2e-7).abs() < 1e-12);
            assert_eq!(derived[3], ("teach.velocity_max", 3e-4));
        }
    }

    #[test]
    fn each_limit_is_the_last_value_that_is_accepted() {
        let p = parameters(|p| p.limits.touch_scatter = 1.2e-8);
        let good = |late: &dyn Fn(f64, u32) -> f64| {
            let teacher = taught(&p, late);
            assert_ne!(teacher.taught.valid, teacher.rejected);
            teacher.taught.valid
        };
        // four touches to and fro by x have the deviation x (4/3)^(1/2)
        let swing = |x: f64| move |_: f64, touch: u32| 2e-7 + if (touch / 5).is_multiple_of(2) { x } else { -x };
        assert!(good(&swing(1.03e-8)) && !good(&swing(1.05e-8)));
        // too soft, and before the touch
        assert!(good(&|v, _| 9.9e-7 - 1e-4 * v) && !good(&|_, _| 1.01e-6));
        // what the parts leave out, and as much of their own at an end: 8.4 nm
        assert!(good(&|_, _| -2.4e-8) && !good(&|_, _| -2.6e-8));
        let unsure = |deviation: f64| {
            let p = parameters(|p| p.teach.place_deviation = deviation);
            taught(&p, |_, _| 2e-7).taught.valid
        };
        assert!(unsure(2.86e-8) && !unsure(2.9e-8));
    }

    #[test]
    fn touches_that_are_not_sure_are_made_once_more_while_that_may_help() {
        let touches = |most: i32, first: f64| {
            let p = parameters(|p| (p.teach.touches_max, p.teach.apply) = (most, true));
            let mut teacher = Teacher::new(&p);
            teacher.begin(&p);
            let mut made = 0;
            while !teacher.ended() {
                teacher.take(&p, &Measured::START, p.teach.place + if made < 5 { first } else { 2e-7 }, 0.0);
                made += 1;
                // the slowest is next, unless this was the last
                let next = if teacher.ended() { p.approach.velocity } else { teacher.approach(&p).velocity };
                assert!(teacher.ended() || made % 5 != 0 || next == 1e-5, "{made}");
            }
            assert_eq!(teacher.approach_after(&p), p.approach);
            let told = teacher.deviation(1e-4);
            assert_eq!(told > 0.0, teacher.taught.valid);
            (made, teacher.taught.valid, teacher.taught.touches)
        };
        // one of four is 121 nm off, 60.5 nm of scatter; of five 54 nm
        assert_eq!(touches(4, 3.21e-7), (20, false, 20));
        assert_eq!(touches(8, 3.21e-7), (25, true, 25));
        assert_eq!(touches(8, 2e-7), (20, true, 20));
        // one that is too far off is never sure, and a bias that cannot be is none of scatter
        assert_eq!(touches(6, 6e-7), (30, false, 30));
        assert_eq!(touches(8, 4e-6), (20, false, 20));
    }

    #[test]
    fn one_that_is_broken_off_or_rejected_leaves_what_was_told() {
        let p = parameters(|p| p.teach.apply = true);
        for broken in [true, false] {
            let mut teacher = taught(&p, |_, _| 2e-7);
            teacher.end();
            teacher.begin(&p);
            assert!(!teacher.taught.valid && teacher.taught.bias == 0.0);
            if broken {
                teacher.take(&p, &Measured::START, 5.03e-5, 0.0);
                assert!(teacher.break_off() && !teacher.break_off());
                assert!(teacher.over());
            } else {
                (0..20).for_each(|_| teacher.take(&p, &Measured::START, 6e-5, 0.0));
                assert!(teacher.rejected && teacher.taught.bias > 9e-6);
            }
            teacher.end();
            assert_eq!(teacher.bias(&p), Bias::of(&p));
        }
    }

    #[test]
    fn it_stands_for_its_share_of_a_turn_before_a_touch_and_for_none_at_its_end() {
        let p = parameters(|_| ());
        let mut teacher = Teacher::new(&p);
        teacher.begin(&p);
        let stands = |teacher: &mut Teacher| (0..99).find(|_| teacher.rested());
        for touch in 0..20 {
            // 0.4 of 10 ms more in each round
            let expected = [0, 40, 80, 20][touch / 5];
            assert_eq!(stands(&mut teacher), Some(expected), "{touch}");
            teacher.take(&p, &Measured::START, 5.02e-5, TAU / 0.01);
        }
        assert_eq!(stands(&mut teacher), Some(0));
        teacher.begin(&p);
        (0..6).for_each(|_| teacher.take(&p, &Measured::START, 5.02e-5, TAU / 0.01));
        teacher.break_off();
        assert_eq!(stands(&mut teacher), Some(0));
    }

    #[test]
    fn beside_a_teaching_the_approach_is_that_of_the_parameters() {
        let p = parameters(|_| ());
        let mut teacher = Teacher::new(&p);
        assert_eq!(teacher.approach(&p), p.approach);
        assert!(!teacher.break_off() && !teacher.broken());
        teacher.begin(&p);
        let slowest = Approach { velocity: 1e-5, ..p.approach };
        assert_eq!(teacher.approach(&p), slowest);
        for touch in 0..20 {
            let (last, after) = (touch == 19, teacher.approach_after(&p));
            teacher.take(&p, &Measured::START, 5.02e-5, 0.0);
            assert_eq!(after, if last { p.approach } else { teacher.approach(&p) });
        }
        teacher.begin(&p);
        assert!(teacher.break_off());
        assert_eq!(teacher.approach_after(&p), p.approach);
    }

    #[test]
    fn a_job_is_no_faster_than_was_taught_with_a_limit_of_the_force_and_is_in_force() {
        for (force_max, apply, expected) in [(0.8, true, 3e-4), (0.0, true, 1e-3), (0.8, false, 1e-3)] {
            let p = parameters(|p| {
                (p.teach.force_max, p.teach.apply, p.approach.velocity) = (force_max, apply, 1e-3);
            });
            let mut teacher = taught(&p, |_, _| 2e-7);
            assert_eq!(teacher.approach_after(&p).velocity, expected);
            teacher.end();
            assert_eq!([teacher.approach(&p).velocity, teacher.approach_after(&p).velocity], [expected; 2]);
            let slower = Approach { velocity: 5e-5, ..p.approach };
            assert_eq!(teacher.approach(&Parameters { approach: slower, ..p.clone() }), slower);
            // broken off, what was told counts
            teacher.begin(&p);
            teacher.break_off();
            teacher.end();
            assert_eq!(teacher.approach(&p).velocity, 1e-3);
        }
    }

    /// A touch for so many samples, after which 10 kg stand without any thrust: F over v is 1.25 times their mass, over that time.
    fn touch(teacher: &mut Teacher, p: &Parameters, samples: u32) {
        let place = p.teach.place;
        teacher.feel(p, &Measured::START, place - 1e-9, 0.0, false);
        (0..samples).for_each(|_| teacher.feel(p, &Measured::START, place + 1e-8, 0.0, false));
        (0..70).for_each(|_| teacher.feel(p, &Measured::START, place - 1e-8, 0.0, true));
        teacher.take(p, &Measured::START, place + 1e-8, 0.0);
    }

    #[test]
    fn touches_that_press_too_hard_even_at_the_slowest_speeds_end_the_teaching() {
        let p = parameters(|p| p.teach.force_max = 0.8);
        let mut teacher = Teacher::new(&p);
        teacher.begin(&p);
        // 23.4 um/s are touched in any case
        for last in [false, true] {
            touch(&mut teacher, &p, 4);
            assert_eq!((teacher.rejected, teacher.ended(), teacher.over()), (last, last, false));
        }
        let bearable = teacher.bearable.unwrap();
        assert!(bearable < 3e-5, "{bearable}");
        teacher.begin(&p);
        assert!(!teacher.rejected && teacher.bearable.is_none());
    }

    #[test]
    fn where_a_longer_way_back_is_needed_than_was_gone_the_stage_comes_to_rest_first() {
        // 9.4 N at 300 um/s, and twice that
        let p = parameters(|p| p.teach.force_max = 24.0);
        let mut teacher = Teacher::new(&p);
        teacher.begin(&p);
        for samples in [4, 4, 4, 4, 2] {
            assert_eq!((0..9999).find(|_| teacher.rested()), Some(0));
            touch(&mut teacher, &p, samples);
        }
        let velocity = teacher.approach(&p).velocity;
        assert!((2.6e-4..2.8e-4).contains(&velocity), "{velocity} m/s");
        assert_eq!((0..9999).find(|_| teacher.rested()), Some(1064));
    }
}
