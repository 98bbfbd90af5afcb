//! The gallery inside the program: scenes and the files they use, whole, so that they open from
//! any folder on any machine.

/// One scene of the gallery.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Its file name without `.toml`.
    pub name: &'static str,
    /// What it shows.
    pub title: &'static str,
}

/// The scenes, the final one first.
pub const GALLERY: &[Entry] = &[
    Entry { name: "final", title: "Everything at once" },
    Entry { name: "antialiasing", title: "Stochastic antialiasing" },
    Entry { name: "depth-of-field", title: "Depth of field" },
    Entry { name: "pyramid", title: "Ray-triangle intersection" },
    Entry { name: "cube-flat-and-smooth", title: "Normal interpolation" },
    Entry { name: "kd-tree", title: "Many triangles" },
    Entry { name: "ward-ceramic", title: "Ward's anisotropic gloss" },
    Entry { name: "soft-shadows", title: "Soft shadows" },
    Entry { name: "noise-spotted", title: "Perlin noise: spots" },
    Entry { name: "noise-marble", title: "Perlin noise: marble" },
    Entry { name: "sky", title: "Perlin noise: a sky with clouds" },
    Entry { name: "glass-and-mirrors", title: "Glass and mirrors" },
];

macro_rules! embedded {
    ($($path:literal),+ $(,)?) => {
        &[$(($path, include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/", $path)))),+]
    };
}

/// Every file of `scenes/` and `assets/`, by its path with `/`.
static FILES: &[(&str, &[u8])] = embedded![
    "scenes/antialiasing.toml",
    "scenes/cube-flat-and-smooth.toml",
    "scenes/depth-of-field.toml",
    "scenes/final.toml",
    "scenes/glass-and-mirrors.toml",
    "scenes/kd-tree.toml",
    "scenes/noise-marble.toml",
    "scenes/noise-spotted.toml",
    "scenes/pyramid.toml",
    "scenes/sky.toml",
    "scenes/soft-shadows.toml",
    "scenes/ward-ceramic.toml",
    "assets/backdrop.obj",
    "assets/block.obj",
    "assets/book-cover.obj",
    "assets/book-pages.obj",
    "assets/bowl.obj",
    "assets/candle.obj",
    "assets/candlestick.obj",
    "assets/cube.obj",
    "assets/curtain.obj",
    "assets/dandelion.obj",
    "assets/egg.obj",
    "assets/flame.obj",
    "assets/hills.obj",
    "assets/icon.png",
    "assets/knot.obj",
    "assets/pawn.obj",
    "assets/peaks.obj",
    "assets/plate.obj",
    "assets/pyramid.obj",
    "assets/ring.obj",
    "assets/shell.obj",
    "assets/teapot.obj",
    "assets/urn.obj",
    "assets/window.obj",
];

/// The bytes of an embedded file, by its path from the top of the project, as `scenes/sky.toml`.
pub fn file(path: &str) -> Option<&'static [u8]> {
    FILES.iter().find(|(name, _)| *name == path).map(|(_, bytes)| *bytes)
}

/// Width and height in pixels of the pictures of the gallery.
pub const PICTURE_SIZE: (u32, u32) = (480, 270);

macro_rules! pictures {
    ($($name:literal),+ $(,)?) => {
        &[$((
            $name,
            include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/gallery/", $name, ".png")),
        )),+]
    };
}

/// The picture of every scene, as the documentation shows it.
static PICTURES: &[(&str, &[u8])] = pictures![
    "antialiasing",
    "cube-flat-and-smooth",
    "depth-of-field",
    "final",
    "glass-and-mirrors",
    "kd-tree",
    "noise-marble",
    "noise-spotted",
    "pyramid",
    "sky",
    "soft-shadows",
    "ward-ceramic",
];

/// A PNG of [`PICTURE_SIZE`] that shows a gallery scene.
pub fn picture(name: &str) -> Option<&'static [u8]> {
    PICTURES.iter().find(|(known, _)| *known == name).map(|(_, bytes)| *bytes)
}

/// The text of a gallery scene.
pub fn scene_text(name: &str) -> Option<&'static str> {
    std::str::from_utf8(file(&format!("scenes/{name}.toml"))?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_of_the_gallery_is_embedded() {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
        for folder in ["scenes", "assets"] {
            for entry in std::fs::read_dir(root.join(folder)).unwrap() {
                let name = entry.unwrap().file_name().into_string().unwrap();
                let path = format!("{folder}/{name}");
                assert!(file(&path).is_some(), "{path} is not embedded");
            }
        }
    }

    #[test]
    fn every_scene_has_an_entry_and_every_entry_a_scene() {
        let scenes = FILES.iter().filter(|(path, _)| path.starts_with("scenes/"));
        assert_eq!(scenes.count(), GALLERY.len(), "scenes and entries");
        for entry in GALLERY {
            assert!(scene_text(entry.name).is_some(), "{} has no scene", entry.name);
        }
    }
}
