//! Which way gloss is long: the tangent rule on every shape, wherever it stands.

use std::f64::consts::PI;

use glam::DVec3;
use penumbra::brdf::WardForm;
use penumbra::geometry::AcceleratorKind;
use penumbra::geometry::mesh::Mesh;
use penumbra::math::Transform;

use super::gloss::reference;
use crate::common::{Files, Look, assert_close, film, job_with, mean};

const ALPHA: [f64; 2] = [0.4, 0.1];

/// A slope whose normal is (0, 0.8, 0.6).
fn slope() -> Mesh {
    let corner = |x: f32, s: f32| glam::Vec3::new(x, -0.6 * s, 0.8 * s);
    let positions =
        vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    Mesh { positions, triangles: vec![[0, 2, 1], [0, 3, 2]], ..Mesh::default() }
}

/// The same with texture coordinates, which tangents have nothing to do with.
fn slope_with_uv() -> Mesh {
    let uvs = [[0.0, 0.0], [0.3, 1.0], [1.0, 0.2], [0.1, 0.9]].map(glam::Vec2::from).to_vec();
    Mesh { uvs, uv_ids: vec![[0, 2, 1], [0, 3, 2]], ..slope() }
}

/// Keys of a shape, a point of it and the normal there, in object space.
fn places() -> Vec<(&'static str, DVec3, DVec3)> {
    let ball = "type = 'sphere'\ncenter = [0.2, -0.1, 0.3]\nradius = 0.8";
    let plane = "type = 'plane'\npoint = [0, 0.1, 0]\nnormal = [0, 0.8, -0.6]";
    let block = "type = 'box'\nmin = [-0.7, -0.5, -0.9]\nmax = [0.6, 0.9, 0.4]";
    let tube = "type = 'cylinder'\nbase = [0, -0.5, 0]\ntop = [0, 0.7, 0]\nradius = 0.5";
    let cone = "type = 'cone'\nbase = [0, -0.5, 0]\ntip = [0, 0.7, 0]\nradius = 0.6";
    let (mesh, uv) = ("type = 'mesh'\nfile = 'slope'", "type = 'mesh'\nfile = 'slope with uv'");
    let out = DVec3::new(0.48, 0.6, 0.64);
    let aslant = DVec3::new(1.2 * 0.6, 0.6, 1.2 * 0.8).normalize();
    vec![
        (ball, DVec3::new(0.2, -0.1, 0.3) + 0.8 * out, out),
        (plane, DVec3::new(0.4, 0.1, 0.0), DVec3::new(0.0, 0.8, -0.6)),
        (block, DVec3::new(0.6, 0.1, -0.2), DVec3::X),
        (block, DVec3::new(0.1, 0.2, -0.9), DVec3::NEG_Z),
        (tube, DVec3::new(0.3, 0.1, 0.4), DVec3::new(0.6, 0.0, 0.8)),
        (tube, DVec3::new(0.1, 0.7, 0.2), DVec3::Y),
        (cone, DVec3::new(0.27, -0.2, 0.36), aslant),
        (cone, DVec3::new(0.1, -0.5, 0.2), DVec3::NEG_Y),
        (mesh, DVec3::new(0.2, 0.0, 0.0), DVec3::new(0.0, 0.8, 0.6)),
        (uv, DVec3::new(0.2, 0.0, 0.0), DVec3::new(0.0, 0.8, 0.6)),
    ]
}

/// Radiance of gloss under a point light, as rendered and by the contract's words: X is the projection
/// of the tangent, which is carried to the world by scale and rotation.
fn rendered_and_expected(
    (shape, point, normal): (&str, DVec3, DVec3),
    (translate, rotate, scale): ([f64; 3], [f64; 3], [f64; 3]),
    tangent: DVec3,
) -> [f64; 2] {
    let place = Transform::new(translate.into(), rotate.into(), scale.into());
    let p = place.world_from_object_point(point);
    let n = place.world_from_object_normal(normal).normalize();
    let along = place.world_from_object_vector(tangent).normalize();
    let project = |t: DVec3| t - t.dot(n) * n;
    let candidates = [along, DVec3::Z, DVec3::Y].map(project);
    let x = candidates.into_iter().find(|x| x.length() >= 1e-4).unwrap().normalize();
    let y = n.cross(x);
    let side = n.any_orthonormal_vector();
    let other = n.cross(side);
    let wo = (0.8 * n + 0.6 * side).normalize();
    let way = 3.0 * (0.75 * n - 0.5 * side + 0.2 * other);
    let body = format!(
        "[[materials]]\nname = 'gloss'\nspecular = [0.6, 0.6, 0.6]\nward = 'bounded'\n\
         alpha_x = {}\nalpha_y = {}\ntangent = {:?}\n\
         [[objects]]\n{shape}\nmaterial = 'gloss'\ntranslate = {translate:?}\nrotate = {rotate:?}\n\
         scale = {scale:?}\nnormals = 'flat'\n\
         [[lights]]\ntype = 'point'\nposition = {:?}\npower = [9, 9, 9]\n",
        ALPHA[0],
        ALPHA[1],
        tangent.to_array(),
        (p + way).to_array()
    );
    let files = Files {
        meshes: vec![("slope", slope), ("slope with uv", slope_with_uv)],
        ..Files::default()
    };
    let look = Look::at((p + 0.4 * wo).to_array(), p.to_array());
    let job = job_with(&look.text(&body), files, AcceleratorKind::WideBvh);
    let local = |v: DVec3| DVec3::new(v.dot(x), v.dot(y), v.dot(n));
    let wi = local(way.normalize());
    let lobe = reference(WardForm::Bounded, ALPHA[0], ALPHA[1], local(wo), wi);
    let expected = 0.6 * lobe * wi.z * 9.0 / (4.0 * PI) / way.length_squared();
    [mean(&film(&job, 16)).x, expected]
}

#[test]
fn gloss_is_long_along_the_tangent_on_every_shape() {
    let stands = [
        ([0.0; 3], [0.0; 3], [1.0; 3]),
        ([5.0, -2.0, 1.0], [20.0, 70.0, -40.0], [1.0; 3]),
        ([0.3, 1.0, 0.0], [40.0, 30.0, -70.0], [2.0, 0.5, 1.3]),
        ([-1.0, 0.0, 0.5], [45.0, 0.0, 10.0], [-1.0, 1.5, 1.0]),
    ];
    for shape in places() {
        for stand in stands {
            for tangent in [DVec3::X, DVec3::new(0.3, 1.0, -0.5)] {
                let [found, expected] = rendered_and_expected(shape, stand, tangent);
                // Across the lobe it makes a difference of several times.
                assert_close(found, expected, 5e-3, &format!("{shape:?} {stand:?} {tangent}"));
            }
        }
    }
}

/// A tangent that stands on the surface gives way to the world's z, however the object is turned, and
/// that to y.
#[test]
fn a_tangent_that_stands_on_the_surface_gives_way() {
    let still = ([0.0; 3], [0.0; 3], [1.0; 3]);
    let turned = ([0.5, 0.0, 0.0], [0.0, 35.0, 20.0], [1.0; 3]);
    for shape in places() {
        for stand in [still, turned] {
            let [found, expected] = rendered_and_expected(shape, stand, 2.5 * shape.2);
            assert_close(found, expected, 5e-3, &format!("{shape:?} {stand:?}"));
        }
    }
}
