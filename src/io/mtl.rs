//! Materials of OBJ files, turned into this renderer's.
//!
//! Colours are `Kd`, `Ks` and `Ke`, the gloss `Ns`, the glass `d` or `Tr` and `Ni`, the picture
//! `map_Kd`. Everything else, `illum` too, means nothing here. Lines are checked and written out
//! plainly before tobj reads them, so that a broken line costs a warning and no more.

mod lines;

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use crate::io::excerpt;
use crate::io::scene_file::{LARGEST, LARGEST_LIGHT, SMALLEST};
use crate::scene::description::{ColorOrTexture, MaterialDescription, Triple};

/// Warnings about one library; a file of another kind would have one a line.
const MAX_WARNINGS: usize = 10;

/// Bytes of all libraries of one mesh: room for a hundred thousand materials.
const LARGEST_LIBRARIES: usize = 8 << 20;

/// Largest `Ns`: the roughness that it stands for is still one of a scene file.
const LARGEST_EXPONENT: f64 = 1e24;

/// One material of a library.
#[derive(Clone, Debug, PartialEq)]
pub struct MtlMaterial {
    /// The name after `newmtl`.
    pub name: String,
    /// The material, with a plain colour as its diffuse part.
    pub description: MaterialDescription,
    /// A picture that the diffuse colour is multiplied by: its file, relative to the library.
    pub diffuse_map: Option<String>,
}

/// The material of every slot of a mesh, and what was odd. `libraries` are named as in the OBJ
/// file; `read` gives the bytes of a file named relative to it, or says why it cannot. A slot that
/// names no material, or none that is found, has none. The file of a `diffuse_map` is relative to
/// the OBJ file here.
pub fn materials_of_slots(
    slot_names: &[Option<String>],
    libraries: &[String],
    mut read: impl FnMut(&Path) -> Result<Vec<u8>, String>,
) -> (Vec<Option<MtlMaterial>>, Vec<String>) {
    let mut warnings = Vec::new();
    let mut n_bytes = 0;
    let mut known: HashMap<String, MtlMaterial> = HashMap::new();
    for library in libraries {
        let path = portable_path(library);
        let label = excerpt(library.as_bytes());
        match read(&path) {
            Ok(bytes) if LARGEST_LIBRARIES < n_bytes + bytes.len() => {
                let limit = LARGEST_LIBRARIES >> 20;
                warnings.push(format!(
                    "material library {label}: passed over; libraries of {limit} MiB in all are read"
                ));
            }
            Ok(bytes) => {
                n_bytes += bytes.len();
                let (materials, told) = parse(&bytes);
                warnings.extend(told.into_iter().map(|warning| format!("{label}: {warning}")));
                for material in materials {
                    // Of two with one name the first is meant.
                    let entry = known.entry(material.name.clone());
                    entry.or_insert_with(|| relative_to(&path, material));
                }
            }
            Err(reason) => warnings.push(format!("material library {label}: {reason}")),
        }
    }
    let mut unknown = Vec::new();
    let materials = slot_names
        .iter()
        .map(|name| {
            let name = name.as_ref()?;
            let found = known.get(name);
            if found.is_none() {
                unknown.push(name.as_str());
            }
            found.cloned()
        })
        .collect();
    if !unknown.is_empty() {
        warnings.push(tell_unknown(&unknown));
    }
    (materials, warnings)
}

/// The materials of a library in its order, and what was odd.
pub fn parse(bytes: &[u8]) -> (Vec<MtlMaterial>, Vec<String>) {
    let (text, mut warnings) = lines::plain(&String::from_utf8_lossy(bytes));
    let materials = match tobj::load_mtl_buf(&mut text.as_bytes()) {
        Ok((materials, _)) => materials,
        Err(error) => {
            warnings.push(error.to_string());
            Vec::new()
        }
    };
    let materials = materials.into_iter().map(|m| translate(m, &mut warnings)).collect();
    if MAX_WARNINGS < warnings.len() {
        let n_more = warnings.len() - MAX_WARNINGS;
        warnings.truncate(MAX_WARNINGS);
        warnings.push(format!("and {n_more} more of this kind"));
    }
    (materials, warnings)
}

/// The file system's path of a name that may have been written on Windows.
pub fn portable_path(name: &str) -> PathBuf {
    PathBuf::from(name.replace('\\', "/"))
}

fn relative_to(library: &Path, mut material: MtlMaterial) -> MtlMaterial {
    if let (Some(folder), Some(map)) = (library.parent(), &mut material.diffuse_map) {
        *map = folder.join(&*map).to_string_lossy().into_owned();
    }
    material
}

fn tell_unknown(names: &[&str]) -> String {
    const N_NAMED: usize = 3;
    let named: Vec<_> =
        names.iter().take(N_NAMED).map(|n| format!("`{}`", excerpt(n.as_bytes()))).collect();
    let more = match names.len().saturating_sub(N_NAMED) {
        0 => String::new(),
        n => format!(" and {n} more"),
    };
    format!("no library has the materials {}{more}; they are neutral grey", named.join(", "))
}

fn translate(material: tobj::Material, warnings: &mut Vec<String>) -> MtlMaterial {
    let mut range = Range { name: &material.name, warnings };
    // 1 where it is opaque.
    let opacity = match (material.dissolve, material.unknown_param.get("Tr")) {
        (Some(d), _) => range.clamp("d", decimal(d), 0.0, 1.0),
        (None, Some(tr)) => 1.0 - range.clamp("Tr", tr.parse().unwrap_or(0.0), 0.0, 1.0),
        (None, None) => 1.0,
    };
    let has_map = material.diffuse_texture.is_some();
    let diffuse = match material.diffuse {
        Some(kd) => range.clamp_color("Kd", kd, 1.0),
        None if has_map => [1.0; 3],
        None => [0.0; 3],
    };
    let mut description = MaterialDescription::new(material.name.clone());
    description.diffuse = ColorOrTexture::Color(diffuse.map(|channel| opacity * channel));
    description.specular = range.clamp_color("Ks", material.specular.unwrap_or_default(), 1.0);
    description.emission =
        range.clamp_color("Ke", material.emissive.unwrap_or_default(), LARGEST_LIGHT);
    description.transmission = [1.0 - opacity; 3];
    if let Some(ns) = material.shininess {
        // The slope at which Ward's lobe falls as Blinn's does near its peak.
        let exponent = range.clamp("Ns", decimal(ns), 0.0, LARGEST_EXPONENT);
        let alpha = (2.0 / (exponent + 2.0)).sqrt();
        (description.alpha_x, description.alpha_y) = (alpha, alpha);
    }
    match material.optical_density.map(decimal) {
        Some(ior) if 0.0 < ior => description.ior = range.clamp("Ni", ior, SMALLEST, LARGEST),
        Some(ior) => {
            let default = description.ior;
            range.tell(format!("Ni {ior} is not above 0; {default} is used"));
        }
        None => {}
    }
    MtlMaterial { name: material.name, description, diffuse_map: material.diffuse_texture }
}

/// Brings the numbers of one material into their ranges, and says so.
struct Range<'a> {
    name: &'a str,
    warnings: &'a mut Vec<String>,
}

impl Range<'_> {
    fn clamp(&mut self, key: &str, value: f64, min: f64, max: f64) -> f64 {
        let clamped = value.clamp(min, max);
        if clamped != value {
            self.tell(format!("{key} {value} is out of range; {clamped} is used"));
        }
        clamped
    }

    fn clamp_color(&mut self, key: &str, color: [f32; 3], max: f64) -> Triple {
        color.map(|channel| self.clamp(key, decimal(channel), 0.0, max))
    }

    fn tell(&mut self, what: String) {
        let line = format!("material `{}`: {what}", excerpt(self.name.as_bytes()));
        // Channels are often alike.
        if self.warnings.last() != Some(&line) {
            self.warnings.push(line);
        }
    }
}

/// The number as it was written: 0.8 and not 0.800000011920929.
fn decimal(value: f32) -> f64 {
    value.to_string().parse().unwrap_or_else(|_| f64::from(value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::scene_file::{parse as parse_scene, validate};
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    #[track_caller]
    fn one(text: &str) -> (MtlMaterial, Vec<String>) {
        let (mut materials, warnings) = parse(format!("newmtl m\n{text}").as_bytes());
        assert_eq!(materials.len(), 1, "{materials:?}");
        (materials.remove(0), warnings)
    }

    #[test]
    fn every_number_goes_where_the_contract_says() {
        let (material, warnings) = one("Kd 0.8 0.4 0.2\nKs 0.1 0.2 0.3\nKe 0 5 1e3\nNs 48\n\
            d 0.75\nNi 1.33\nillum 7\nKa 1 1 1\nmap_Kd a.png\n");
        let m = &material.description;
        assert_eq!(m.diffuse, ColorOrTexture::Color([0.75 * 0.8, 0.75 * 0.4, 0.75 * 0.2]));
        assert_eq!(m.specular, [0.1, 0.2, 0.3]);
        assert_eq!(m.emission, [0.0, 5.0, 1e3]);
        assert_eq!((m.alpha_x, m.alpha_y), (0.2, 0.2));
        assert_eq!(m.transmission, [0.25; 3]);
        assert_eq!(m.ior, 1.33);
        assert_eq!(m.reflection, [0.0; 3]);
        assert_eq!(material.diffuse_map.as_deref(), Some("a.png"));
        assert!(warnings.is_empty(), "{warnings:?}");
    }

    #[test]
    fn tr_is_what_d_leaves_and_d_wins() {
        assert_eq!(one("Tr 0.25").0.description.transmission, [0.25; 3]);
        assert_eq!(one("Tr 0.25\nd 1").0.description.transmission, [0.0; 3]);
        assert_eq!(one("d 1\nTr 0.25").0.description.transmission, [0.0; 3]);
        assert_eq!(one("d -halo 0.5").0.description.transmission, [0.5; 3]);
    }

    #[test]
    fn one_number_is_a_grey() {
        assert_eq!(one("Kd 0.5").0.description.diffuse, ColorOrTexture::Color([0.5; 3]));
    }

    #[test]
    fn a_picture_without_a_colour_is_shown_as_it_is() {
        let (material, _) = one("map_Kd a.png");
        assert_eq!(material.description.diffuse, ColorOrTexture::Color([1.0; 3]));
    }

    #[test]
    fn numbers_out_of_range_are_clamped_and_told() {
        let cases = [
            ("Kd 1.5 0 0", "material `m`: Kd 1.5 is out of range; 1 is used"),
            ("Ks 0 -1 0", "material `m`: Ks -1 is out of range; 0 is used"),
            ("Ke -2 0 0", "material `m`: Ke -2 is out of range; 0 is used"),
            ("Ns -5", "material `m`: Ns -5 is out of range; 0 is used"),
            ("Ni 0", "material `m`: Ni 0 is not above 0; 1.5 is used"),
            ("d 2", "material `m`: d 2 is out of range; 1 is used"),
            ("Tr -1", "material `m`: Tr -1 is out of range; 0 is used"),
        ];
        for (text, expected) in cases {
            let (material, warnings) = one(text);
            assert_eq!(warnings, [expected]);
            let m = material.description;
            let ColorOrTexture::Color(diffuse) = m.diffuse else { panic!("a colour") };
            let colors = [diffuse, m.specular, m.emission, m.transmission].concat();
            assert!(colors.iter().all(|c| (0.0..=1.0).contains(c)), "{text}: {colors:?}");
            assert!(m.alpha_x > 0.0 && m.ior > 0.0, "{text}");
        }
    }

    #[test]
    fn slots_get_the_materials_that_they_name() {
        let names = ["b", "no\u{1b}", "a"].map(|name| Some(name.to_owned()));
        let slots = [&[None], &names[..]].concat();
        let libraries = ["sub\\x.mtl".to_owned(), "gone.mtl".to_owned()];
        let (materials, warnings) = materials_of_slots(&slots, &libraries, |path| {
            if path == Path::new("sub/x.mtl") {
                Ok(b"newmtl a\nKd 1 0 0\nnewmtl b\nKd 0 1 0\nmap_Kd tex\\b.png\n".to_vec())
            } else {
                Err("not there".into())
            }
        });
        let diffuse = |slot: &Option<MtlMaterial>| {
            slot.as_ref().map(|material| material.description.diffuse.clone())
        };
        let expected = [None, Some([0.0, 1.0, 0.0]), None, Some([1.0, 0.0, 0.0])];
        let expected = expected.map(|color| color.map(ColorOrTexture::Color));
        assert_eq!(materials.iter().map(diffuse).collect::<Vec<_>>(), expected);
        let map = materials[1].as_ref().unwrap().diffuse_map.as_deref();
        assert_eq!(map, Some("sub/tex/b.png"));
        assert_eq!(
            warnings,
            [
                "material library gone.mtl: not there",
                "no library has the materials `no\\u{1b}`; they are neutral grey",
            ]
        );
    }

    #[test]
    fn a_library_of_nonsense_makes_few_warnings() {
        let (materials, warnings) = parse(&b"Kd\n".repeat(10_000));
        assert!(materials.is_empty());
        assert_eq!(warnings.len(), MAX_WARNINGS + 1);
        assert_eq!(warnings[MAX_WARNINGS], "and 9990 more of this kind");
    }

    #[test]
    fn many_unknown_materials_make_one_warning() {
        let slots: Vec<_> = (0..9).map(|i| Some(format!("m{i}"))).collect();
        let (_, warnings) = materials_of_slots(&slots, &[], |_| Err(String::new()));
        assert_eq!(
            warnings,
            ["no library has the materials `m0`, `m1`, `m2` and 6 more; they are neutral grey"]
        );
    }

    proptest! {
        #![proptest_config(ProptestConfig {
            rng_seed: RngSeed::Fixed(1),
            failure_persistence: None,
            ..ProptestConfig::default()
        })]

        #[test]
        fn no_library_makes_it_panic_or_leave_a_range(
            words in prop::collection::vec(prop::sample::select(vec![
                "newmtl ", "m", "\n", "Kd ", "Ks ", "Ke ", "Ns ", "Ni ", "d ", "Tr ", "map_Kd ",
                "-s ", "-halo ", "0.5 ", "-1 ", "1e39 ", "nan ", "inf ", "\\\n", "# ", "\u{e9} ",
                "illum ", "map_Bump ", "a.png ", "spectral ", "\t", "\r\n", "bump", "map_d",
            ]), 0..60),
        ) {
            let (materials, _) = parse(words.concat().as_bytes());
            for material in materials {
                let m = material.description;
                let ColorOrTexture::Color(diffuse) = m.diffuse else { panic!("a colour") };
                let shares = [diffuse, m.specular, m.transmission].concat();
                prop_assert!(shares.iter().all(|c| (0.0..=1.0).contains(c)));
                prop_assert!(m.emission.iter().all(|c| 0.0 <= *c && c.is_finite()));
                prop_assert!(0.0 < m.alpha_x && m.alpha_x <= 1.0);
                prop_assert!(0.0 < m.ior && m.ior.is_finite());
            }
        }
    }

    #[test]
    fn endless_libraries_are_passed_over_with_a_warning() {
        let slots = [Some("m".to_owned())];
        let libraries = ["long.mtl".to_owned(), "short.mtl".to_owned()];
        let (materials, warnings) = materials_of_slots(&slots, &libraries, |path| {
            let is_long = path == Path::new("long.mtl");
            let end = if is_long { "\n".repeat(LARGEST_LIBRARIES) } else { String::new() };
            Ok(format!("newmtl m\nNs {}{end}", u8::from(is_long)).into_bytes())
        });
        let material = materials[0].as_ref().expect("the short one has it");
        assert_eq!(material.description.alpha_x, 1.0, "of the short one");
        assert!(warnings.len() == 1 && warnings[0].contains("long.mtl"), "{warnings:?}");
    }

    #[test]
    fn every_material_could_stand_in_a_scene_file() {
        for line in ["Ke 1 1.2e30 2", "Ns 3e38", "Ni 1e-30", "Ni 3e38", "Kd 2 -1 0"] {
            let (material, warnings) = one(line);
            let mut scene =
                parse_scene("camera = { eye = [0, 0, 1], target = [0, 0, 0] }", &[]).unwrap();
            scene.materials.push(material.description);
            assert_eq!(validate(&scene), Ok(()), "{line}");
            assert!(warnings.iter().any(|warning| warning.contains("out of range")), "{line}");
        }
    }
}
