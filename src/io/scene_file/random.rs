//! Random valid descriptions, for tests.

use proptest::collection::{btree_set, vec};
use proptest::option;
use proptest::prelude::*;
use proptest::sample::{Index, select};

use crate::scene::description::{
    BumpDescription, CameraDescription, ColorOrTexture, EnvironmentDescription, FilterKind,
    IntegratorKind, LightDescription, LightKind, MaterialDescription, NormalsKind,
    ObjectDescription, ObjectKind, OneOrThree, OneOrTwo, RenderDescription, SamplerKind,
    SceneDescription, TextureDescription, TextureKind, ToneMappingDescription, ToneOperator,
    Triple, WardForm,
};

pub(super) fn scene() -> impl Strategy<Value = SceneDescription> {
    let lists = (names(), names()).prop_flat_map(|(textures, materials)| {
        let references = (textures.clone(), materials.clone());
        let mut all_textures = textures.into_iter().map(texture).collect::<Vec<_>>();
        // One that may be a bump, so that there can be any.
        all_textures.push(texture("\u{0}only noise".into()));
        let materials: Vec<_> =
            materials.into_iter().map(|name| material(name, references.0.clone())).collect();
        let lights =
            names().prop_flat_map(|names| names.into_iter().map(light).collect::<Vec<_>>());
        let objects = names().prop_flat_map(move |names| {
            let object = |name| object(name, references.1.clone());
            names.into_iter().map(object).collect::<Vec<_>>()
        });
        (all_textures, materials, lights, objects)
    });
    (
        render(),
        camera(),
        tone_mapping(),
        triple(light_number()),
        any::<Index>(),
        any::<bool>(),
        lists,
    )
        .prop_map(|(render, camera, tone_mapping, ambient, index, is_sky, lists)| {
            let (mut textures, materials, lights, objects) = lists;
            if let Some(noise) = textures.last_mut() {
                noise.kind = TextureKind::Clouds;
                noise.colors = None;
            }
            let background = if is_sky {
                ColorOrTexture::Texture(index.get(&textures).name.clone())
            } else {
                ColorOrTexture::Color(ambient.map(|x| x * 0.5))
            };
            let environment = EnvironmentDescription { ambient, background };
            SceneDescription {
                render,
                camera,
                tone_mapping,
                environment,
                textures,
                materials,
                lights,
                objects,
            }
        })
}

fn names() -> impl Strategy<Value = Vec<String>> {
    let strange = vec(any::<char>(), 0..6).prop_map(|letters| letters.into_iter().collect());
    let plain =
        select(vec!["a", "light-1", "object-1", "1", "a.b", "a b", "\"", "\\", "'", "\r\n"]);
    let name = prop_oneof![strange, plain.prop_map(String::from)];
    btree_set(name, 0..4).prop_map(|names| names.into_iter().collect::<Vec<_>>()).prop_shuffle()
}

fn number() -> impl Strategy<Value = f64> + Clone {
    prop_oneof![-1e12..1e12, -1.0..1.0, -1e-300..1e-300, (-9..9_i32).prop_map(f64::from)]
}

fn positive() -> impl Strategy<Value = f64> + Clone {
    prop_oneof![1e-12..1e-9, 0.001..10.0, 1e9..1e12]
}

fn light_number() -> impl Strategy<Value = f64> + Clone {
    prop_oneof![Just(0.0), 0.0..1.0, 1e20..1e30]
}

fn triple(number: impl Strategy<Value = f64> + Clone) -> impl Strategy<Value = Triple> {
    [number.clone(), number.clone(), number]
}

fn direction() -> impl Strategy<Value = Triple> {
    (number(), number(), positive()).prop_map(|(x, y, z)| [x, y, z])
}

fn render() -> impl Strategy<Value = RenderDescription> {
    let sizes = (1..=16384_u32, 1..=16384_u32, 1..=1_048_576_u32, 0..=1024_u32);
    let integrator = select(vec![IntegratorKind::Direct, IntegratorKind::Path]);
    let sampler = select(vec![SamplerKind::Sobol, SamplerKind::Random]);
    (sizes, integrator, any::<u32>(), any::<bool>(), sampler).prop_map(
        |((width, height, samples, max_depth), integrator, seed, adaptive, sampler)| {
            let filter = FilterKind::Box;
            RenderDescription {
                width,
                height,
                samples,
                max_depth,
                integrator,
                seed,
                filter,
                adaptive,
                sampler,
            }
        },
    )
}

fn camera() -> impl Strategy<Value = CameraDescription> {
    let blades = prop_oneof![Just(0_u32), 3..=16_u32];
    let lens = (1e-3..179.999, 0.0..1e3, option::of(positive()), blades);
    (triple(-1e3..1e3), 0.01..1e3, (-1.0..1.0, 0.1..1.0), lens).prop_map(
        |(
            eye,
            distance,
            (x, y),
            (vertical_fov, aperture_radius, focal_distance, aperture_blades),
        )| {
            let target = [eye[0], eye[1], eye[2] - distance];
            let up = [x, y, 0.0];
            CameraDescription {
                eye,
                target,
                up,
                vertical_fov,
                aperture_radius,
                focal_distance,
                aperture_blades,
            }
        },
    )
}

fn tone_mapping() -> impl Strategy<Value = ToneMappingDescription> {
    use ToneOperator::{Aces, Agx, Linear, Reinhard};
    (-100.0..100.0, select(vec![Linear, Reinhard, Aces, Agx]))
        .prop_map(|(exposure, operator)| ToneMappingDescription { exposure, operator })
}

fn texture(name: String) -> impl Strategy<Value = TextureDescription> {
    use TextureKind::{Checker, Clouds, Image, Marble, Solid, Spots, Wood};
    let kind = select(vec![Solid, Checker, Image, Spots, Marble, Clouds, Wood]);
    let colors = vec(triple(light_number()), 2..9);
    let numbers = (positive(), 1..=12_u32, 0.001..1e3, 0.0..1e3, number());
    (kind, numbers, option::of(colors), any::<char>()).prop_map(
        move |(kind, (scale, octaves, lacunarity, gain, distortion), mut colors, letter)| {
            match kind {
                Solid => colors = Some(vec![[0.5; 3]]),
                Checker => colors.iter_mut().for_each(|colors| colors.truncate(2)),
                Image | Spots | Marble | Clouds | Wood => {}
            }
            let file = (kind == Image).then(|| format!("{letter}.png"));
            let name = name.clone();
            TextureDescription {
                name,
                kind,
                scale,
                octaves,
                lacunarity,
                gain,
                distortion,
                colors,
                file,
            }
        },
    )
}

fn material(name: String, textures: Vec<String>) -> impl Strategy<Value = MaterialDescription> {
    let unit = || triple(0.0..=1.0);
    let ward = select(vec![WardForm::Original, WardForm::Duer, WardForm::Bounded]);
    let colors = (unit(), unit(), unit(), unit(), triple(light_number()));
    let numbers = (positive(), positive(), positive(), number());
    (colors, numbers, ward, direction(), any::<(Index, bool, bool)>()).prop_map(
        move |(
            colors,
            (alpha_x, alpha_y, ior, height),
            ward,
            tangent,
            (index, is_textured, has_bump),
        )| {
            let (diffuse, specular, reflection, transmission, emission) = colors;
            let diffuse = if is_textured && !textures.is_empty() {
                ColorOrTexture::Texture(index.get(&textures).clone())
            } else {
                ColorOrTexture::Color(diffuse)
            };
            let bump =
                has_bump.then(|| BumpDescription { texture: "\u{0}only noise".into(), height });
            let name = name.clone();
            MaterialDescription {
                name,
                diffuse,
                specular,
                alpha_x,
                alpha_y,
                ward,
                tangent,
                reflection,
                transmission,
                ior,
                emission,
                bump,
            }
        },
    )
}

fn light(name: String) -> impl Strategy<Value = LightDescription> {
    use LightKind::{Disk, Point, Rectangle, Sphere, Sun};
    let kind = select(vec![Rectangle, Disk, Sphere, Point, Sun]);
    let points = (triple(-1e3..1e3), 0.1..1e3, direction(), triple(light_number()));
    (kind, points, 0.01..180.0, 0..4, any::<[bool; 2]>()).prop_map(
        move |(kind, (position, distance, up, power), size, form, [visible, enabled])| {
            let size = match (form, kind) {
                (0, _) => OneOrTwo::One(0.0),
                (1, _) => OneOrTwo::Single([size]),
                (2, Rectangle | Point) => OneOrTwo::Two([size, 0.5 * size]),
                (_, _) => OneOrTwo::One(size),
            };
            let target = [position[0], position[1] - distance, position[2]];
            let name = name.clone();
            LightDescription { name, kind, position, target, up, size, power, visible, enabled }
        },
    )
}

fn object(name: String, materials: Vec<String>) -> impl Strategy<Value = ObjectDescription> {
    use ObjectKind::{Box, Cone, Cylinder, Mesh, Plane, Sphere};
    let kind = select(vec![Mesh, Sphere, Plane, Box, Cone, Cylinder]);
    let normals = select(vec![NormalsKind::File, NormalsKind::Smooth, NormalsKind::Flat]);
    let place = (triple(number()), triple(number()), positive(), any::<bool>());
    (kind, normals, place, 0.0..=180.0, triple(-1e3..1e3), any::<(bool, bool, Index, char)>())
        .prop_map(
            move |(
                kind,
                normals,
                (translate, rotate, scale, is_uniform),
                crease_angle,
                point,
                rest,
            )| {
                let (enabled, has_material, index, letter) = rest;
                let mut object = ObjectDescription::new(name.clone(), kind);
                object.enabled = enabled;
                if has_material && !materials.is_empty() {
                    object.material = Some(index.get(&materials).clone());
                }
                (object.translate, object.rotate, object.normals) = (translate, rotate, normals);
                object.crease_angle = crease_angle;
                object.scale = if is_uniform {
                    OneOrThree::One(-scale)
                } else {
                    OneOrThree::Three([scale, -scale, 1.0])
                };
                let above = point.map(|x| x + 1.0);
                match kind {
                    Mesh => object.file = Some(format!("../{letter}.obj")),
                    Sphere => (object.center, object.radius) = (Some(point), Some(scale)),
                    Plane => {
                        (object.point, object.normal) = (Some(point), Some(above.map(|x| x + 2e3)));
                    }
                    Box => (object.min, object.max) = (Some(point), Some(above)),
                    Cone => {
                        (object.base, object.tip, object.radius) =
                            (Some(point), Some(above), Some(scale));
                    }
                    Cylinder => {
                        (object.base, object.top, object.radius) =
                            (Some(point), Some(above), Some(scale));
                    }
                }
                object
            },
        )
}
