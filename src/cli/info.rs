//! `penumbra info`: what a scene or mesh holds.

use serde_json::json;

use crate::cli::render::{open, world_of};
use crate::cli::{Failure, InfoArguments, print, warn};
use crate::geometry::AcceleratorKind;
use crate::loader::Loaded;
use crate::scene::assets::MeshKey;
use crate::threads;

pub(super) fn run(arguments: &InfoArguments) -> Result<(), Failure> {
    let loaded = open(&arguments.file, &[])?;
    warn(&loaded.report, false);
    let pool = threads::pool("build", threads::available())?;
    let world = world_of(&loaded, AcceleratorKind::default(), &pool)?;
    let counts = Counts::of(&loaded);
    let tree = world.geometry.statistics();
    let name = AcceleratorKind::default().name();
    let build_ms = tree.build_secs * 1e3;
    let bounds = world.geometry.bounds();
    if arguments.json {
        let bounds = bounds.map(|b| json!({ "min": b.min.to_array(), "max": b.max.to_array() }));
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
        print(&info.to_string());
        return Ok(());
    }
    let Counts { vertices, triangles, materials, objects, lights } = counts;
    print(&format!("vertices     {vertices}"));
    print(&format!("triangles    {triangles}"));
    print(&format!("materials    {materials}"));
    print(&format!("objects      {objects}"));
    print(&format!("lights       {lights}"));
    match bounds {
        Some(b) => print(&format!("bounds       {} to {}", b.min, b.max)),
        None => print("bounds       none"),
    }
    print(&format!(
        "accelerator  {name}: {build_ms:.1} ms, {} nodes, {} KiB",
        tree.n_nodes,
        tree.n_bytes >> 10
    ));
    Ok(())
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
