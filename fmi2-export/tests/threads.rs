//! Instances on their own threads do not notice each other.
#![allow(clippy::undocumented_unsafe_blocks, reason = "each is one call of the C API with pointers that live")]

mod common;

use common::*;
use std::ffi::CString;
use std::sync::Barrier;

const THREADS: u32 = 8;

/// A run that depends on its number: outputs after every tenth of 2000 steps, through a rollback and bytes.
fn run(fmu: &Fmu, number: u32) -> Vec<(Vec<u64>, Vec<i32>, String)> {
    let mut instance = Instance::started(fmu);
    assert_eq!(instance.set_real("gain", f64::from(1 + number)), OK);
    let mut seen = Vec::new();
    for k in 0..2000_u32 {
        if k == 777 {
            // half of it in an instance made of bytes, while the others are being made and freed
            let next = Instance::new(fmu);
            next.restore(&instance.bytes());
            instance = next;
        }
        assert_eq!(instance.set_real("position", f64::from(k * (number + 3)).sin()), OK);
        assert_eq!(instance.set_integer("count", (k % (number + 2)) as i32), OK);
        assert_eq!(instance.step(f64::from(k) * 0.4e-3, 0.4e-3), OK);
        if k % 10 == 0 {
            seen.push(instance.outputs());
        }
    }
    seen
}

#[test]
fn eight_threads_give_what_one_gives() {
    let fmu = Fmu::probe();
    let alone: Vec<_> = (0..THREADS).map(|number| run(&fmu, number)).collect();
    assert!(alone.windows(2).all(|pair| pair[0] != pair[1]));
    let (fmu, start) = (&fmu, &Barrier::new(THREADS as usize));
    let together: Vec<_> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..THREADS)
            .map(|number| {
                scope.spawn(move || {
                    start.wait();
                    run(fmu, number)
                })
            })
            .collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect()
    });
    assert_eq!(together, alone);
}

#[test]
fn an_instance_may_move_to_another_thread_between_calls() {
    let fmu = Fmu::probe();
    let mut instance = Instance::started(&fmu);
    let stays = Instance::started(&fmu);
    for k in 0..20_u32 {
        let time = f64::from(k) * 1e-3;
        instance = std::thread::scope(|scope| {
            scope
                .spawn(move || {
                    assert_eq!((instance.set_real("position", time), instance.step(time, 1e-3)), (OK, OK));
                    instance
                })
                .join()
                .unwrap()
        });
        assert_eq!((stays.set_real("position", time), stays.step(time, 1e-3)), (OK, OK));
    }
    assert_eq!(instance.outputs(), stays.outputs());
}

#[test]
fn panics_on_several_threads_keep_their_instances_apart() {
    let fmu = Fmu::probe();
    std::thread::scope(|scope| {
        for number in 0..THREADS {
            let fmu = &fmu;
            scope.spawn(move || {
                let label = format!("thread {number}");
                for _ in 0..20 {
                    let instance = Instance::in_phase(fmu, Phase::Initialization);
                    assert_eq!(instance.set_texts(&["label"], &[&CString::new(label.as_str()).unwrap()]), OK);
                    assert_eq!(instance.set_integer("failure", if number % 2 == 0 { 3 } else { 1 }), OK);
                    assert_eq!(instance.exit(), OK);
                    let (expected, count) = if number % 2 == 0 { (ERROR, 1) } else { (OK, 0) };
                    assert_eq!(instance.step(0.0, 1e-3), expected);
                    let messages = instance.messages();
                    assert_eq!(messages.len(), count);
                    assert!(messages.iter().all(|message| message.text.contains(&label)), "{label}: {messages:?}");
                }
            });
        }
    });
}
