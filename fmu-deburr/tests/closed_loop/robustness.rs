//! Whatever comes in, in whatever order: no panic, finite outputs, commands within their limits.

use fmu_deburr::interface::{Mode, Parameters, State};
use fmu_deburr::learning::speeds::Speeds;

use crate::robot::Build;
use crate::setup::Loop;

/// Numbers that look random, the same in every run.
struct Dice(u64);

impl Dice {
    fn roll(&mut self, sides: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % sides
    }
}

#[test]
fn random_inputs_do_no_damage() {
    const NONSENSE: [f64; 4] = [f64::NAN, f64::INFINITY, 1e300, -1e5];
    let mut p = Parameters::START;
    p.learn.repetitions = 1;
    p.path.file = "touched.json".to_owned();
    (p.path.programmed_speed, p.transfer.time) = (0.5, 0.3);
    p.learn.factors = Speeds::new(&[1.0]).unwrap();
    let mut visited = [false; State::ALL.len() + 1];
    for seed in 0..12 {
        let mut run = Loop::new(&p, &Build::NOMINAL);
        run.parameters.lookup.enable = seed % 2 == 0;
        let mut dice = Dice(seed);
        for k in 0..6000 {
            run.input.commission = k / 150 % 3 == 1;
            (run.input.register, run.input.contact) = (k / 150 % 3 == 2, k / 7 % 40 == 0);
            if dice.roll(300) == 0 {
                run.input.mode = Mode::ALL[dice.roll(6) as usize];
            }
            run.input.hold = dice.roll(50) == 0 || run.input.hold && dice.roll(30) != 0;
            run.input.enable = dice.roll(2000) != 0;
            run.input.reset_fault = dice.roll(20) == 0;
            run.input.spindle_speed = 1640.0 + dice.roll(100) as f64;
            run.input.speed_override = dice.roll(5) as f64 / 3.0 - 0.2;
            match dice.roll(3000) {
                0 => run.input.spindle_speed = NONSENSE[dice.roll(4) as usize],
                1 => run.input.speed_override = NONSENSE[dice.roll(2) as usize],
                _ => {}
            }
            run.step();
            visited[run.output.state as usize] = true;
            for (axis, limits) in run.output.axis.iter().zip(&p.axis) {
                for value in [axis.reference, axis.error, axis.compensation, axis.rms, axis.peak] {
                    assert!(value.is_finite());
                }
                assert!(axis.velocity.abs() <= limits.velocity_max);
                let held = run.output.state == State::Fault && run.output.drive_enable;
                assert!(axis.velocity == 0.0 || held || !matches!(run.output.state, State::Off | State::Fault));
            }
            let found = &run.output.registration;
            for value in [found.x, found.x_std, found.angle, found.angle_std, found.residual] {
                assert!(value.is_finite());
            }
            assert!(run.output.path.distance >= 0.0 && run.output.path.distance <= run.output.path.length);
        }
    }
    assert_eq!(visited[1..], [true; State::ALL.len()]);
}
