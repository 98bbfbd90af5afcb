//! Scene: objects, their place and material, and what loading had to report.

use super::parts::{Placement, part_list};
use super::{Selection, path_segment, subheading};
use crate::scene::description::{
    NormalsKind, ObjectDescription, ObjectKind, OneOrThree, SceneDescription,
};
use crate::window::fields::{FileLine, file_line};
use crate::window::structure::{self, Part};
use crate::window::widgets::{Figure, LENGTH, choice, pick_one, row, switch, triple};
use egui::Ui;

const NO_MATERIAL: &str = "none";
const KINDS: [(ObjectKind, &str); 6] = [
    (ObjectKind::Mesh, "Mesh"),
    (ObjectKind::Sphere, "Sphere"),
    (ObjectKind::Plane, "Plane"),
    (ObjectKind::Box, "Box"),
    (ObjectKind::Cone, "Cone"),
    (ObjectKind::Cylinder, "Cylinder"),
];
const NORMALS: [(NormalsKind, &str, &str); 3] = [
    (NormalsKind::File, "File", "as stored in the mesh file, smooth where it has none"),
    (NormalsKind::Smooth, "Smooth", "averaged over the faces around each vertex"),
    (NormalsKind::Flat, "Flat", "each face its own: facets"),
];

/// The objects of the scene, one at a time.
pub(in crate::window) fn objects_ui(
    ui: &mut Ui,
    scene: &mut SceneDescription,
    selection: &mut Selection,
) {
    let index = part_list(ui, scene, Part::Object, &mut selection.object, &mut selection.renaming);
    let reach = Placement::of(scene).reach;
    let materials: Vec<String> =
        scene.materials.iter().map(|material| material.name.clone()).collect();
    if let Some(object) = index.and_then(|index| scene.objects.get_mut(index)) {
        object_ui(ui, object, &materials, reach, &mut selection.wants_file);
    }
}

/// What was missing or repaired while the scene was loaded.
pub(in crate::window) fn report_ui(ui: &mut Ui, report: &[String]) {
    subheading(ui, "Loading");
    if report.is_empty() {
        ui.weak("nothing was missing or repaired");
    }
    for line in report {
        ui.add(egui::Label::new(line).wrap());
    }
}

fn object_ui(
    ui: &mut Ui,
    object: &mut ObjectDescription,
    materials: &[String],
    reach: f64,
    wants_file: &mut Option<(Part, String)>,
) {
    let prefix = format!("objects.{}", path_segment(&object.name));
    let path = |key: &str| format!("{prefix}.{key}");
    let help = "off: as if it were not there";
    switch(ui, "Enabled", &path("enabled"), help, &mut object.enabled);
    row(ui, "Shape", "", |ui| {
        let shown =
            KINDS.iter().find(|(kind, _)| *kind == object.kind).map_or("", |(_, name)| name);
        let names = KINDS.iter().map(|(_, name)| *name);
        if let Some(picked) = pick_one(ui, "Shape", &path("type"), shown, names) {
            let kind = KINDS[picked].0;
            if kind == ObjectKind::Mesh && object.file.is_none() {
                // It becomes one with its file.
                *wants_file = Some((Part::Object, object.name.clone()));
            } else {
                object.kind = kind;
                structure::complete(object, reach * 0.12);
            }
        }
    });
    row(ui, "Made of", "", |ui| {
        let shown = object.material.clone().unwrap_or_else(|| NO_MATERIAL.to_owned());
        let options = std::iter::once(NO_MATERIAL).chain(materials.iter().map(String::as_str));
        match pick_one(ui, "Made of", &path("material"), &shown, options) {
            None => {}
            Some(0) => object.material = None,
            Some(index) => object.material = Some(materials[index - 1].clone()),
        }
    });
    if let Some(file) = object.file.clone() {
        let help = "an OBJ file, relative to the scene";
        match file_line(ui, "Mesh file", help, "path of an OBJ file", &path("file"), &file) {
            FileLine::Left => {}
            FileLine::Entered(file) => object.file = Some(file),
            FileLine::Choose => *wants_file = Some((Part::Object, object.name.clone())),
        }
    }
    transform_ui(ui, object, reach);
    shape_ui(ui, object, reach);
}

fn transform_ui(ui: &mut Ui, object: &mut ObjectDescription, reach: f64) {
    let path = |key: &str| format!("objects.{}.{key}", path_segment(&object.name));
    let (translate, rotate, scale) = (path("translate"), path("rotate"), path("scale"));
    let speed = (reach * 0.002).max(1e-5);
    triple(
        ui,
        "Move",
        &translate,
        "added last, in scene units",
        LENGTH,
        speed,
        &mut object.translate,
    );
    triple(ui, "Turn", &rotate, "degrees about X, then Y, then Z", "°", 0.5, &mut object.rotate);
    let mut per_axis = matches!(object.scale, OneOrThree::Three(_));
    let help = "scales each axis by itself";
    switch(ui, "Scale each axis", "", help, &mut per_axis);
    object.scale = match (per_axis, object.scale) {
        (true, OneOrThree::One(factor)) => OneOrThree::Three([factor; 3]),
        (false, OneOrThree::Three([factor, ..])) => OneOrThree::One(factor),
        (_, scale) => scale,
    };
    match object.scale {
        OneOrThree::One(factor) => {
            let mut new = factor;
            Figure::new("Scale", scale, 0.1..=10.0)
                .logarithmic(0.01)
                .unit("×")
                .help("size, the same along all axes; below 0 mirrors")
                .show(ui, &mut new);
            if new != factor && new != 0.0 {
                object.scale = OneOrThree::One(new);
            }
        }
        OneOrThree::Three(factors) => {
            let mut new = factors;
            let help = "size along each axis; below 0 mirrors";
            triple(ui, "Scale", &scale, help, "×", 0.01, &mut new);
            if new != factors && !new.contains(&0.0) {
                object.scale = OneOrThree::Three(new);
            }
        }
    }
}

fn shape_ui(ui: &mut Ui, object: &mut ObjectDescription, reach: f64) {
    let prefix = format!("objects.{}", path_segment(&object.name));
    let path = |key: &str| format!("{prefix}.{key}");
    let speed = (reach * 0.002).max(1e-5);
    match object.kind {
        ObjectKind::Mesh => {
            let (help, path) = ("how the surface is shaded", path("normals"));
            choice(ui, "Normals", &path, help, &mut object.normals, &NORMALS);
            if object.normals != NormalsKind::Flat {
                Figure::new("Crease", format!("{prefix}.crease_angle"), 0.0..=180.0)
                    .allowed(0.0..=180.0)
                    .unit("°")
                    .help("edges sharper than this stay edges where normals are averaged")
                    .show(ui, &mut object.crease_angle);
            }
        }
        ObjectKind::Sphere => {
            point_ui(ui, "Centre", &path("center"), speed, &mut object.center);
            radius_ui(ui, path("radius"), reach, &mut object.radius);
        }
        ObjectKind::Plane => {
            point_ui(ui, "Point", &path("point"), speed, &mut object.point);
            let before = object.normal;
            point_ui(ui, "Normal", &path("normal"), 0.01, &mut object.normal);
            if object.normal == Some([0.0; 3]) {
                object.normal = before;
            }
        }
        ObjectKind::Box => {
            let before = (object.min, object.max);
            point_ui(ui, "Lowest", &path("min"), speed, &mut object.min);
            point_ui(ui, "Highest", &path("max"), speed, &mut object.max);
            if let (Some(min), Some(max)) = (object.min, object.max)
                && (0..3).any(|axis| max[axis] <= min[axis])
            {
                (object.min, object.max) = before;
            }
        }
        ObjectKind::Cone => {
            let before = (object.base, object.tip);
            point_ui(ui, "Base", &path("base"), speed, &mut object.base);
            point_ui(ui, "Tip", &path("tip"), speed, &mut object.tip);
            if object.base == object.tip {
                (object.base, object.tip) = before;
            }
            radius_ui(ui, path("radius"), reach, &mut object.radius);
        }
        ObjectKind::Cylinder => {
            let before = (object.base, object.top);
            point_ui(ui, "Base", &path("base"), speed, &mut object.base);
            point_ui(ui, "Top", &path("top"), speed, &mut object.top);
            if object.base == object.top {
                (object.base, object.top) = before;
            }
            radius_ui(ui, path("radius"), reach, &mut object.radius);
        }
    }
}

fn point_ui(ui: &mut Ui, label: &str, path: &str, speed: f64, value: &mut Option<[f64; 3]>) {
    if let Some(point) = value {
        let unit = if path.ends_with(".normal") { "" } else { LENGTH };
        triple(ui, label, path, "in the object's own space", unit, speed, point);
    }
}

fn radius_ui(ui: &mut Ui, path: String, reach: f64, radius: &mut Option<f64>) {
    if let Some(radius) = radius {
        let largest = (reach * 0.5).max(1e-3);
        Figure::new("Radius", path, 0.0..=largest)
            .allowed(1e-9..=1e12)
            .logarithmic(largest * 1e-3)
            .unit(LENGTH)
            .show(ui, radius);
    }
}
