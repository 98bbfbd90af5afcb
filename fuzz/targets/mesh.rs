//! An OBJ file and its material library.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| penumbra_fuzz::mesh(data));
