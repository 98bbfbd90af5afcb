//! A scene file, with overrides before it.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| penumbra_fuzz::scene_file(data));
