//! A picture of whatever scene a text is, by every accelerator.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| penumbra_fuzz::scene_render(data));
