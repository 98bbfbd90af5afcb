//! Every accelerator against brute force on small triangles and rays.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| penumbra_fuzz::accelerators(data));
