//! Real meshes, as tobj reads them.

use glam::{DVec3, Vec2, Vec3};

use super::*;

/// Meshes of the folder that the environment variable `PENUMBRA_MESHES` names, read by this
/// reader and by tobj.
#[test]
fn real_meshes_are_read_as_tobj_reads_them() {
    let Some(folder) = std::env::var_os("PENUMBRA_MESHES") else {
        eprintln!("skipped: PENUMBRA_MESHES names no folder of OBJ files");
        return;
    };
    let root = std::path::PathBuf::from(folder);
    let table = std::fs::read_to_string(root.join("SOURCES.md")).unwrap_or_default();
    let mut n_compared = 0;
    let mut folders = vec![root.clone()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "obj") {
                compare_with_tobj(&path);
                let name = path.strip_prefix(&root).unwrap().to_str().unwrap();
                compare_with_table(&path, name, &table);
                n_compared += 1;
            }
        }
    }
    assert!(n_compared > 0, "no OBJ files there");
}

/// The table's rows start with file, source, `v` lines and triangles.
fn compare_with_table(path: &std::path::Path, name: &str, table: &str) {
    let row = table.lines().find_map(|line| line.strip_prefix(&format!("| {name} |")));
    let Ok(file) = parse(&std::fs::read(path).unwrap()) else { return };
    let Some(row) = row else { return };
    let counts: Vec<_> = row.split('|').map(str::trim).skip(1).take(2).collect();
    let found = [file.positions.len().to_string(), file.triangles.len().to_string()];
    assert_eq!(counts, found, "{name}");
}

/// Position, texture coordinate and normal of a corner.
type CornerValues = (Vec3, Option<Vec2>, Option<Vec3>);

#[track_caller]
fn compare_with_tobj(path: &std::path::Path) {
    let bytes = std::fs::read(path).unwrap();
    let polygons = polygons_by_tobj(&bytes);
    if polygons.is_empty() {
        assert!(matches!(parse(&bytes), Err(ObjError::NoTriangles { .. })), "{path:?}");
        return;
    }
    let file = parse(&bytes).unwrap_or_else(|error| panic!("{path:?}: {error}"));
    let mut triangles = (0..file.triangles.len()).map(|i| values_of(&file, i));
    for (face, polygon) in polygons.iter().enumerate() {
        let pieces: Vec<_> = triangles.by_ref().take(polygon.len() - 2).collect();
        assert_eq!(pieces.len(), polygon.len() - 2, "{path:?}: face {face}");
        for corner in pieces.iter().flatten() {
            assert!(polygon.contains(corner), "{path:?}: face {face}: {corner:?} of {polygon:?}");
        }
        // However a polygon is cut, the sum of its pieces' vector areas is the same.
        let area = |points: &[CornerValues]| -> DVec3 {
            let from_first = |i: usize| (points[i].0 - points[0].0).as_dvec3();
            (2..points.len()).map(|i| from_first(i - 1).cross(from_first(i))).sum()
        };
        let (found, whole) = (pieces.iter().map(|p| area(p)).sum::<DVec3>(), area(polygon));
        let size = polygon.iter().map(|c| c.0.length()).fold(1.0, f32::max);
        let slack = 1e-6 * f64::from(size) * f64::from(size);
        assert!((found - whole).length() <= slack, "{path:?}: face {face}: {found} for {whole}");
    }
    assert_eq!(triangles.next(), None, "{path:?}: more triangles than tobj finds");
}

fn values_of(file: &ObjFile, triangle: usize) -> [CornerValues; 3] {
    let pick = |ids: &[[u32; 3]], corner: usize| {
        let id = ids.get(triangle).map(|ids| ids[corner]);
        id.filter(|id| *id != ABSENT).map(|id| id as usize)
    };
    [0, 1, 2].map(|corner| {
        let position = file.positions[file.triangles[triangle][corner] as usize];
        let uv = pick(&file.uv_ids, corner).map(|id| file.uvs[id]);
        (position, uv, pick(&file.normal_ids, corner).map(|id| file.normals[id]))
    })
}

fn polygons_by_tobj(bytes: &[u8]) -> Vec<Vec<CornerValues>> {
    let options =
        tobj::LoadOptions { ignore_lines: true, ignore_points: true, ..Default::default() };
    let no_library = |_: &std::path::Path| Ok(Default::default());
    let (models, _) = tobj::load_obj_buf(&mut &bytes[..], &options, no_library).unwrap();
    let mut polygons = Vec::new();
    for mesh in models.into_iter().map(|model| model.mesh) {
        let triple = |v: &[f32], id: u32| Vec3::from_slice(&v[3 * id as usize..]);
        let mut corners = mesh.indices.iter().enumerate().map(|(i, id)| {
            let uv = mesh.texcoord_indices.get(i);
            let normal = mesh.normal_indices.get(i);
            (
                triple(&mesh.positions, *id),
                uv.map(|id| Vec2::from_slice(&mesh.texcoords[2 * *id as usize..])),
                normal.map(|id| triple(&mesh.normals, *id).as_dvec3().normalize().as_vec3()),
            )
        });
        if mesh.face_arities.is_empty() {
            polygons
                .extend((0..mesh.indices.len() / 3).map(|_| corners.by_ref().take(3).collect()));
        }
        for n in mesh.face_arities {
            polygons.push(corners.by_ref().take(n as usize).collect());
        }
    }
    polygons
}
