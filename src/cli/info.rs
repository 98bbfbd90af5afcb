//! `penumbra info`: what a scene or mesh holds.

use glam::Vec3;
use serde_json::json;

use crate::cli::render::{open, world_of};
use crate::cli::{Failure, InfoArguments, pool, print, print_json, warn};
use crate::geometry::AcceleratorKind;
use crate::loader::Loaded;
use crate::scene::assets::MeshKey;

pub(super) fn run(arguments: &InfoArguments) -> Result<(), Failure> {
    let mut loaded = open(&arguments.file, &[])?;
    warn(&loaded.report, false);
    // No picture is made, and none has to fit into memory.
    (loaded.description.render.width, loaded.description.render.height) = (1, 1);
    let pool = pool("build", None)?;
    let world = world_of(&loaded, AcceleratorKind::default(), &pool)?;
    let counts = Counts::of(&loaded);
    let tree = world.geometry.statistics();
    let name = AcceleratorKind::default().name();
    let build_ms = tree.build_secs * 1e3;
    let bounds = world.geometry.extent().map(|corners| corners.map(|p| p.as_vec3()));
    if arguments.json {
        let bounds = bounds.map(|[min, max]| json!({ "min": shortest(min), "max": shortest(max) }));
        let info = json!({
            "vertices": counts.vertices,
            "triangles": counts.triangles,
            "materials": counts.materials,
            "objects": counts.objects,
            "lights": counts.lights,
            "bounds": bounds,
            "accelerator": {
                "name": name,
                "build_ms": build_ms,
                "nodes": tree.n_nodes,
                "bytes": tree.n_bytes,
            },
        });
        return Ok(print_json(&info)?);
    }
    let Counts { vertices, triangles, materials, objects, lights } = counts;
    let bounds = bounds.map_or("none".to_owned(), |b| format!("{} to {}", b[0], b[1]));
    print(&format!(
        "vertices     {vertices}\n\
         triangles    {triangles}\n\
         materials    {materials}\n\
         objects      {objects}\n\
         lights       {lights}\n\
         bounds       {bounds}\n\
         accelerator  {name}: {build_ms:.1} ms, {} nodes, {} KiB",
        tree.n_nodes,
        tree.n_bytes >> 10
    ))?;
    Ok(())
}

/// The numbers with no more digits than tell them apart, as files have them.
fn shortest(point: Vec3) -> [f64; 3] {
    point.to_array().map(|x| x.to_string().parse().unwrap_or(f64::from(x)))
}

/// How much of everything; what is disabled is not there.
struct Counts {
    vertices: usize,
    triangles: usize,
    materials: usize,
    objects: usize,
    lights: usize,
}

impl Counts {
    /// A file used by two objects counts twice.
    fn of(loaded: &Loaded) -> Self {
        let description = &loaded.description;
        let mut counts = Self {
            vertices: 0,
            triangles: 0,
            materials: description.materials.len(),
            objects: 0,
            lights: description.lights.iter().filter(|light| light.enabled).count(),
        };
        for object in description.objects.iter().filter(|object| object.enabled) {
            counts.objects += 1;
            let key = MeshKey::of(object);
            if let Some(asset) = key.and_then(|key| loaded.assets.meshes.get(&key)) {
                counts.vertices += asset.traced.mesh.positions.len();
                counts.triangles += asset.traced.mesh.triangles.len();
                if object.material.is_none() {
                    counts.materials += asset.slots.iter().flatten().count();
                }
            }
        }
        counts
    }
}
