//! A PNG as a snapshot, and a PNG or JPEG as a texture.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(
    init: {
        // libFuzzer's own hook ends the process, also at the panic of a decoder that is answered.
        let hook = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            if !penumbra::io::crash::is_contained() {
                hook(panic);
            }
        }));
    },
    |data: &[u8]| penumbra_fuzz::snapshot(data)
);
