//! Samples neither get lost nor multiply, whatever the communication step.
#![allow(clippy::undocumented_unsafe_blocks, reason = "each is one call of the C API with pointers that live")]

mod common;

use common::*;

/// An instance with a sample period, started at a time.
fn started(fmu: &Fmu, period: f64, start: f64) -> Instance<'_> {
    let instance = Instance::new(fmu);
    assert_eq!(instance.set_real("sample_period", period), OK);
    assert_eq!((instance.setup(start, None), instance.enter(), instance.exit()), (OK, OK, OK));
    instance
}

/// Samples after `steps` steps of `h`, with the communication point computed by three methods.
fn ticks(period: f64, h: f64, steps: u32) -> i32 {
    let fmu = Fmu::probe();
    let instances = [(); 3].map(|()| started(&fmu, period, 0.0));
    let mut sum = 0.0;
    for k in 0..steps {
        let exact = f64::from(k) * h;
        // multiples of h, a running sum, and differences of multiples as the step
        assert_eq!(instances[0].step(exact, h), OK);
        assert_eq!(instances[1].step(sum, h), OK);
        assert_eq!(instances[2].step(exact, f64::from(k + 1) * h - exact), OK);
        sum += h;
    }
    let [first, second, third] = instances.map(|instance| instance.integer("ticks"));
    assert!(first == second && second == third, "{first} {second} {third}");
    first
}

#[test]
fn fractions_of_the_period_add_up_to_it() {
    assert_eq!(ticks(1e-4, 1e-4 / 3.0, 30_000), 10_000);
    assert_eq!(ticks(1e-3, 1e-4, 30_000), 3_000);
    assert_eq!(ticks(1e-4, 0.7e-4, 100_000), 70_000);
    assert_eq!(ticks(1.0 / 3.0, 0.1, 1_000), 300);
    assert_eq!(ticks(1e-4, 1e-4 / 7.0, 7_000), 1_000);
}

#[test]
fn multiples_of_the_period_hold_so_many_samples() {
    assert_eq!(ticks(1e-4, 1e-3, 1_000), 10_000);
    assert_eq!(ticks(1e-4, 3.3e-4, 10_000), 33_000);
    assert_eq!(ticks(1e-3, 1.0 / 60.0, 600), 10_000);
    assert_eq!(ticks(1e-6, 1.0, 1), 1_000_000);
}

#[test]
fn a_million_steps_of_one_period_are_a_million_samples() {
    let fmu = Fmu::probe();
    let (h, instance) = (1e-4, started(&fmu, 1e-4, 0.0));
    for k in 0..1_000_000_u32 {
        assert_eq!(instance.step(f64::from(k) * h, h), OK);
    }
    assert_eq!(instance.integer("ticks"), 1_000_000);
    // the time of the last sample is a product, not a sum
    assert_eq!(instance.text("text"), format!("100 % <probe> at {} s", 999_999.0 * h));
}

#[test]
fn a_sample_at_the_start_of_a_step_belongs_to_it_and_one_at_its_end_does_not() {
    let fmu = Fmu::probe();
    let instance = started(&fmu, 1e-2, 0.0);
    for (time, step, expected) in [
        (0.0, 1e-2, 1),
        (1e-2, 2.5e-3, 2),
        (1.25e-2, 2.5e-3, 2),
        (1.5e-2, 5e-3, 2),
        (2e-2, 1e-9, 3),
        (2e-2 + 1e-9, 1e-2 - 1e-9, 3),
        (3e-2, 1e-2 * (1.0 - 1e-12), 4),
        (4e-2, 1e-2 * (1.0 + 1e-12), 5),
        (5e-2, 1e-2, 6),
    ] {
        assert_eq!(instance.step(time, step), OK);
        assert_eq!(instance.integer("ticks"), expected, "after {time} + {step}");
    }
}

#[test]
fn inputs_count_from_the_next_sample_on_and_outputs_are_held() {
    let fmu = Fmu::load(&example("pass_through"));
    let instance = Instance::started(&fmu);
    let mut seen = Vec::new();
    for k in 0..8_u32 {
        // a new input every quarter of the period, and every fourth is sampled
        assert_eq!(instance.set_real("u", f64::from(k + 1)), OK);
        assert_eq!(instance.step(f64::from(k) * 0.25e-3, 0.25e-3), OK);
        seen.push(instance.real("y"));
    }
    assert_eq!(seen, [1.0, 1.0, 1.0, 1.0, 5.0, 5.0, 5.0, 5.0]);
}

#[test]
fn samples_are_counted_from_the_start_time() {
    let fmu = Fmu::probe();
    for start in [-5.0, 0.3, 1e5] {
        let instance = started(&fmu, 1e-3, start);
        for k in 0..1000_u32 {
            assert_eq!(instance.step(start + f64::from(k) * 1e-3, 1e-3), OK);
        }
        assert_eq!(instance.integer("ticks"), 1000);
        assert_eq!(instance.text("text"), format!("100 % <probe> at {} s", start + 999.0 * 1e-3));
    }
}

#[test]
fn the_last_step_may_be_shortened_to_the_stop_time() {
    let fmu = Fmu::probe();
    let instance = Instance::new(&fmu);
    assert_eq!((instance.setup(0.0, Some(1.0)), instance.enter(), instance.exit()), (OK, OK, OK));
    let (h, mut time, mut steps) = (3e-3, 0.0, 0);
    while time < 1.0 - 1e-12 {
        let step = f64::min(h, 1.0 - time);
        assert_eq!(instance.step(time, step), OK, "{time}");
        time += step;
        steps += 1;
    }
    assert_eq!((steps, instance.integer("ticks")), (334, 1000));
}
