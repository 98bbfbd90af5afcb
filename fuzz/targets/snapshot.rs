//! A PNG as a snapshot, and a PNG or JPEG as a texture.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| penumbra_fuzz::snapshot(data));
