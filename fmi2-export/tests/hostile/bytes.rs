//! State bytes that are damaged, foreign or forged.

use crate::common::*;

/// State bytes of an instance in the middle of a run.
fn running_bytes(fmu: &Fmu) -> Vec<u8> {
    let instance = Instance::started(fmu);
    assert_eq!(instance.set_reals(&["position", "gain"], &[0.25, 7.125]), OK);
    assert_eq!(instance.step(0.0, 12.5e-3), OK);
    instance.bytes()
}

/// The bytes must be rejected with these words, and no state must result.
fn assert_bytes_rejected(instance: &Instance, bytes: &[u8], words: &[&str]) {
    let (status, state) = instance.deserialize(bytes);
    instance.assert_rejected(status, ERROR, &[&["fmi2DeSerializeFMUstate"][..], words].concat());
    assert!(state.is_null());
}

#[test]
fn bytes_cut_at_any_length_are_rejected() {
    let fmu = Fmu::probe();
    let (bytes, instance) = (running_bytes(&fmu), Instance::new(&fmu));
    for length in 0..bytes.len() {
        assert_bytes_rejected(&instance, &bytes[..length], &[]);
    }
    instance.restore(&bytes);
}

#[test]
fn bytes_with_any_bit_flipped_are_rejected() {
    let fmu = Fmu::probe();
    let (mut bytes, instance) = (running_bytes(&fmu), Instance::new(&fmu));
    for bit in 0..8 * bytes.len() {
        bytes[bit / 8] ^= 1 << (bit % 8);
        assert_bytes_rejected(&instance, &bytes, &[]);
        bytes[bit / 8] ^= 1 << (bit % 8);
    }
    instance.restore(&bytes);
}

#[test]
fn bytes_with_trailing_bytes_are_rejected() {
    let fmu = Fmu::probe();
    let (bytes, instance) = (running_bytes(&fmu), Instance::new(&fmu));
    for extra in [1, 15, 16, 255, 256, 4096] {
        assert_bytes_rejected(&instance, &[&bytes[..], &vec![0; extra]].concat(), &[]);
        assert_bytes_rejected(&instance, &[&bytes[..], &bytes[..extra.min(bytes.len())]].concat(), &[]);
    }
}

#[test]
fn bytes_that_are_no_state_at_all_are_rejected() {
    let fmu = Fmu::probe();
    let instance = Instance::new(&fmu);
    for bytes in [&[][..], b"hello", &[0; 256], &[0xff; 4096]] {
        assert_bytes_rejected(&instance, bytes, &["no state"]);
    }
    // the instance is not worse for it
    instance.restore(&running_bytes(&fmu));
    assert_eq!(instance.step(12.5e-3, 1e-3), OK);
}

#[test]
fn bytes_of_another_fmu_are_rejected_by_guid() {
    let (probe, other) = (Fmu::probe(), Fmu::load(&example("pass_through")));
    for (own, foreign) in [(&probe, &other), (&other, &probe)] {
        let bytes = Instance::started(foreign).bytes();
        let words = ["another FMU", foreign.guid.to_str().unwrap(), own.guid.to_str().unwrap()];
        assert_bytes_rejected(&Instance::new(own), &bytes, &words);
    }
}

/// FNV-1a with 128 bits, the checksum of the last 16 bytes.
fn sign(bytes: &mut [u8]) {
    let (body, sum) = bytes.split_last_chunk_mut::<16>().unwrap();
    let hash = body.iter().fold(0x6c62_272e_07bb_0142_62b8_2175_6295_c58d_u128, |hash, byte| {
        (hash ^ u128::from(*byte)).wrapping_mul(0x0000_0000_0100_0000_0000_0000_0000_013b)
    });
    *sum = hash.to_le_bytes();
}

/// The bytes with every number `from` replaced, and a good checksum.
fn forge(bytes: &[u8], from: f64, to: f64) -> Vec<u8> {
    let mut forged = bytes.to_vec();
    for at in 0..bytes.len() - 8 {
        if bytes[at..at + 8] == from.to_le_bytes() {
            forged[at..at + 8].copy_from_slice(&to.to_le_bytes());
        }
    }
    assert_ne!(forged, bytes, "{from} is not in the state");
    sign(&mut forged);
    forged
}

#[test]
fn forged_bytes_cannot_bring_in_what_no_call_could_set() {
    let fmu = Fmu::probe();
    let (bytes, instance) = (running_bytes(&fmu), Instance::new(&fmu));
    let mut signed = bytes.clone();
    sign(&mut signed);
    assert_eq!(signed, bytes, "the checksum of this test is not that of the state bytes");

    assert_bytes_rejected(&instance, &forge(&bytes, 7.125, f64::NAN), &["`gain` = NaN"]);
    assert_bytes_rejected(&instance, &forge(&bytes, 0.25, f64::INFINITY), &["`position` = inf"]);
    let (status, _) = instance.deserialize(&forge(&bytes, 7.125, -1.0));
    assert_ne!(status, OK);
    instance.messages();
    // the clock is 0.5 samples after the last one, at the communication point 0.0125 s
    assert_bytes_rejected(&instance, &forge(&bytes, 12.5e-3, f64::NAN), &["impossible clock"]);
    assert_bytes_rejected(&instance, &forge(&bytes, 0.5, 1.5), &["impossible clock"]);
}

/// The bytes with another one `distance` bytes from where a number begins, and a good checksum.
fn forge_near(bytes: &[u8], number: f64, distance: isize, from: u8, to: u8) -> Vec<u8> {
    let mut forged = bytes.to_vec();
    let at = forged.windows(8).position(|window| window == number.to_le_bytes()).unwrap();
    let byte = &mut forged[at.checked_add_signed(distance).unwrap()];
    assert_eq!(*byte, from);
    *byte = to;
    sign(&mut forged);
    forged
}

#[test]
fn forged_bytes_cannot_bring_in_derivatives_and_integers_that_no_call_could_set() {
    let fmu = Fmu::probe();
    let instance = Instance::started(&fmu);
    let number = 123.456;
    assert_eq!(instance.set_real("bias[3]", number), OK);
    // `order` = 2 follows it; the signs of integers are in their last bit
    assert_bytes_rejected(&instance, &forge_near(&instance.bytes(), number, 8, 4, 40), &["`order` = 20"]);

    let instance = Instance::started(&fmu);
    assert_eq!(instance.set_derivatives(&["position"], &[1], &[number]), OK);
    // reference and order lie before it
    let bytes = instance.bytes();
    assert_bytes_rejected(&instance, &forge_near(&bytes, number, -2, 0, 100), &["value reference 100"]);
    let gain = u8::try_from(fmu.reference("gain")).unwrap();
    assert_bytes_rejected(&instance, &forge_near(&bytes, number, -2, 0, gain), &["`gain` is no Real input"]);
    assert_bytes_rejected(&instance, &forge_near(&bytes, number, -1, 2, 0), &["order 0"]);
}

#[test]
fn a_buffer_too_small_is_rejected_and_one_too_large_is_not_filled_up() {
    let fmu = Fmu::probe();
    let instance = Instance::started(&fmu);
    let (good, state) = (instance.bytes(), instance.take_state());
    let mut buffer = vec![0xaa_u8; good.len() + 100];
    let mut serialize = |size| unsafe {
        let status = (fmu.serialize)(instance.component, state, buffer.as_mut_ptr().cast(), size);
        (status, buffer.clone())
    };
    assert_eq!(serialize(good.len() + 100).0, OK);
    let (_, filled) = serialize(good.len());
    assert_eq!(filled[..good.len()], good);
    assert!(filled[good.len()..].iter().all(|byte| *byte == 0xaa));
    let (status, _) = serialize(good.len() - 1);
    let words = ["fmi2SerializeFMUstate", &format!("{} bytes", good.len()), &format!("`size` = {}", good.len() - 1)];
    instance.assert_rejected(status, ERROR, &words);
    instance.free_state(state);
}
