//! The readers of snapshots and of pictures.

use std::path::Path;

use penumbra::io::scene_file::parse;
use penumbra::io::{image_file, snapshot};

/// Larger pictures are refused by their headers in other tests; here they would only cost time.
const MAX_TEXELS: u64 = 1 << 18;

/// A snapshot, a picture, both, or refused in a sentence.
pub fn snapshot(data: &[u8]) {
    match snapshot::read(data, Path::new("shot.png")) {
        Ok(found) => {
            if let Ok(scene) = parse(&found.scene, &[])
                && n_texels(data) <= MAX_TEXELS
            {
                let size = (scene.render.width, scene.render.height);
                match snapshot::read_pixels(data, size) {
                    Ok(pixels) => {
                        let n_bytes = 3 * size.0 as usize * size.1 as usize;
                        assert_eq!(pixels.len(), n_bytes, "three bytes a pixel");
                    }
                    Err(error) => super::check_message(&error.to_string()),
                }
            }
        }
        Err(error) => super::check_message(&error.to_string()),
    }
    if MAX_TEXELS < n_texels(data) {
        return;
    }
    match image_file::decode(data) {
        Ok(image) => {
            let n_texels = image.width as usize * image.height as usize;
            assert!(n_texels > 0 && image.texels.len() == n_texels, "a texel a pixel");
            let is_light = |value: &f32| (0.0..=1.0).contains(value);
            assert!(image.texels.as_flattened().iter().all(is_light), "linear light in 0..=1");
        }
        Err(error) => super::check_message(&error.to_string()),
    }
}

/// What the header promises: of a PNG, or the largest of the frame headers that a JPEG may have.
fn n_texels(data: &[u8]) -> u64 {
    if let (true, Some(size)) = (data.starts_with(b"\x89PNG"), data.get(16..24)) {
        let side = |at: usize| size[at..at + 4].iter().fold(0, |n, b| n << 8 | u64::from(*b));
        return side(0) * side(4);
    }
    let is_frame = |kind: u8| (0xc0..=0xcf).contains(&kind);
    let product = |s: &[u8]| {
        let side = |at: usize| u64::from(s[at]) << 8 | u64::from(s[at + 1]);
        side(5) * side(7)
    };
    data.windows(9).filter(|s| s[0] == 0xff && is_frame(s[1])).map(product).max().unwrap_or(0)
}
