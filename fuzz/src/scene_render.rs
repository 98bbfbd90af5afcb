//! From a text to light, all the way.

use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use penumbra::geometry::{AcceleratorKind, TracedMesh};
use penumbra::io::obj::load_mesh;
use penumbra::io::scene_file::parse;
use penumbra::render::{Film, RenderJob, RenderSettings, World, render_pass};
use penumbra::scene::assets::{Assets, MeshAsset, MeshKey};
use penumbra::scene::description::{SceneDescription, TextureKind};
use penumbra::scene::image::Image;
use penumbra::scene::resolve;

/// Stands for every mesh file: a box with a hole, a fin, and triangles on top of each other.
const MESH: &[u8] = b"v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\n\
    v -1 1 1\nv 0 2 0\nvt 0 0\nvt 1 0\nvt 1 1\nf 4/1 3/2 2/3 1/1\nf 5/1 6/2 7/3 8/1\n\
    f 1/1 2/2 6/3 5/1\nusemtl a\nf 2 3 7 6\nf 3 4 8 7\nf 1 9 7\nf 1 9 7\nf 2 2 9\n";

/// Side of the picture in pixels.
const SIDE: u32 = 4;

/// A scene renders to finite light, the same by every accelerator and every grouping of passes.
pub fn scene_render(data: &[u8]) {
    let Ok(text) = str::from_utf8(data) else { return };
    let Ok(description) = parse(text, &[]) else { return };
    let assets = assets_of(&description);
    let scene = resolve(&description, &assets).unwrap_or_else(|error| panic!("{error}"));
    let scene = Arc::new(scene);
    let mut first: Option<Vec<u32>> = None;
    for (kind, passes) in AcceleratorKind::ALL.into_iter().zip([[1, 1], [2, 0], [2, 0], [1, 1]]) {
        let mut settings = RenderSettings::new(&description.render, kind);
        settings.max_depth = settings.max_depth.min(6);
        let job = RenderJob { scene: Arc::clone(&scene), width: SIDE, height: SIDE, settings };
        let world = World::new(job);
        world.pick(0.5, 0.5);
        let mut film = Film::new(SIDE, SIDE).unwrap_or_else(|error| panic!("{error}"));
        for n in passes.into_iter().filter(|n| *n > 0) {
            let Ok(_) = render_pass(&world, &mut film, n, &AtomicBool::new(false)) else {
                panic!("nobody stops it")
            };
        }
        let pixels = film.picture().pixels.into_flattened();
        assert!(pixels.iter().all(|x| x.is_finite()), "{}: {pixels:?}", kind.name());
        let bits: Vec<u32> = pixels.iter().map(|x| x.to_bits()).collect();
        let first = first.get_or_insert_with(|| bits.clone());
        assert!(*first == bits, "{} has another picture", kind.name());
    }
}

fn assets_of(description: &SceneDescription) -> Assets {
    let mut assets = Assets { meshes: HashMap::new(), images: HashMap::new() };
    for key in description.objects.iter().filter_map(MeshKey::of) {
        let mesh = || {
            let (mesh, notes) =
                load_mesh(MESH, key.normals, key.crease_angle_deg(), &AtomicBool::new(false))
                    .unwrap_or_else(|error| panic!("{error}"));
            let slots = notes.slot_names.iter().map(|_| None).collect();
            Arc::new(MeshAsset { traced: Arc::new(TracedMesh::new(mesh)), slots })
        };
        assets.meshes.entry(key.clone()).or_insert_with(mesh);
    }
    for texture in &description.textures {
        if let (TextureKind::Image, Some(file)) = (texture.kind, &texture.file) {
            let texels = vec![[0.0; 3], [1.0, 0.5, 0.25], [0.25, 0.5, 1.0]];
            let image = Image { width: 3, height: 1, texels };
            assets.images.insert(file.clone(), Arc::new(image));
        }
    }
    assets
}
