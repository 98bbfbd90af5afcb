//! The readers of meshes and of their material libraries.

use std::sync::atomic::AtomicBool;

use penumbra::geometry::mesh::{ABSENT, Mesh};
use penumbra::io::mtl::materials_of_slots;
use penumbra::io::obj::load_mesh;
use penumbra::io::scene_file::{parse, validate};
use penumbra::scene::description::NormalsKind;

/// A mesh is whole, in range and finite, or is refused in a sentence; its materials could stand in
/// a scene file. The library, whatever its name, is what follows the first NUL.
pub fn mesh(data: &[u8]) {
    let split = data.iter().position(|byte| *byte == 0).unwrap_or(data.len());
    let (obj, library) = (&data[..split], &data[data.len().min(split + 1)..]);
    for (kind, crease_angle_deg) in
        [(NormalsKind::File, 180.0), (NormalsKind::Smooth, 40.0), (NormalsKind::Flat, 0.0)]
    {
        let (mesh, notes) = match load_mesh(obj, kind, crease_angle_deg, &AtomicBool::new(false)) {
            Ok(loaded) => loaded,
            Err(error) => return super::check_message(&error.to_string()),
        };
        check_mesh(&mesh, notes.slot_names.len());
        let (materials, warnings) =
            materials_of_slots(&notes.slot_names, &notes.libraries, |_| Ok(library.to_vec()));
        assert_eq!(materials.len(), notes.slot_names.len(), "a material or none for every slot");
        for warning in notes.warnings.iter().chain(&warnings) {
            super::check_message(warning);
        }
        let mut scene = parse("camera = { eye = [0, 0, 1], target = [0, 0, 0] }", &[])
            .unwrap_or_else(|error| panic!("{error}"));
        for (index, material) in materials.into_iter().flatten().enumerate() {
            let mut description = material.description;
            description.name = format!("m{index}");
            scene.materials.push(description);
        }
        if let Err(error) = validate(&scene) {
            panic!("a material is none: {error}");
        }
    }
}

fn check_mesh(mesh: &Mesh, n_slots: usize) {
    let n = mesh.triangles.len();
    assert!(n > 0, "a mesh has triangles");
    let in_range = |ids: &[[u32; 3]], count: usize, may_lack: bool| {
        let is_right = |id: &u32| (*id as usize) < count || (may_lack && *id == ABSENT);
        ids.iter().flatten().all(is_right)
    };
    let is_full = |length: usize| length == 0 || length == n;
    assert!(in_range(&mesh.triangles, mesh.positions.len(), false), "positions");
    assert!(in_range(&mesh.normal_ids, mesh.normals.len(), true), "normals");
    assert!(in_range(&mesh.uv_ids, mesh.uvs.len(), true), "texture coordinates");
    assert!(is_full(mesh.normal_ids.len()) && is_full(mesh.uv_ids.len()), "an entry a triangle");
    assert!(is_full(mesh.slots.len()), "a slot a triangle");
    assert!(mesh.slots.iter().all(|slot| (*slot as usize) < n_slots), "slots");
    assert!(mesh.positions.iter().all(|p| p.is_finite()), "a position is no number");
    assert!(mesh.uvs.iter().all(|p| p.is_finite()), "a texture coordinate is no number");
    for id in mesh.normal_ids.iter().flatten().filter(|id| **id != ABSENT) {
        let length = mesh.normals[*id as usize].length();
        assert!((length - 1.0).abs() < 1e-3, "a normal of length {length}");
    }
}
