//! Normals, bumps and textures: what a surface is like at a known point.

use std::f64::consts::PI;

use glam::{DMat3, DVec3, Vec3};
use penumbra::geometry::AcceleratorKind;
use penumbra::geometry::mesh::Mesh;
use penumbra::math::Transform;
use penumbra::scene::image::Image;
use penumbra::scene::texture::{Lookup, Texture};

use crate::common::{Files, Look, assert_close, film, job, job_with, mean};

/// Places that move, turn, stretch and mirror.
const PLACES: [([f64; 3], [f64; 3], [f64; 3]); 4] = [
    ([0.0; 3], [0.0; 3], [1.0; 3]),
    ([5.0, -2.0, 1.0], [20.0, 70.0, -40.0], [1.0; 3]),
    ([0.0, 3.0, 0.0], [0.0, 30.0, 0.0], [2.0, 0.5, 3.0]),
    ([-1.0, 0.0, 0.5], [45.0, 0.0, 10.0], [-1.0, 1.5, 1.0]),
];

fn transform((translate, rotate, scale): ([f64; 3], [f64; 3], [f64; 3])) -> Transform {
    Transform::new(translate.into(), rotate.into(), scale.into())
}

fn keys((translate, rotate, scale): ([f64; 3], [f64; 3], [f64; 3])) -> String {
    format!("translate = {translate:?}\nrotate = {rotate:?}\nscale = {scale:?}\n")
}

/// Looks at an object's point along its normal, from a short way off, in the world.
fn look_at_point(place: &Transform, point: DVec3, normal: DVec3) -> Look {
    let p = place.world_from_object_point(point);
    let n = place.world_from_object_normal(normal).normalize();
    Look::at((p + 0.5 * n).to_array(), p.to_array()).samples(16)
}

/// A sun from a world direction.
fn sun(towards: DVec3) -> String {
    format!(
        "[[lights]]\ntype = 'sun'\nposition = {:?}\ntarget = [0, 0, 0]\npower = [1, 1, 1]\n",
        towards.to_array()
    )
}

/// Marble without distortion is 1/2 + 1/2 sin(pi s x): its gradient is known.
#[test]
fn a_bump_bends_the_normal_by_the_gradient_in_object_space() {
    let (scale, height) = (0.7, 0.3);
    for place in PLACES {
        for (x, from_below) in [(0.1, false), (0.6, false), (-0.4, true)] {
            let slope = 0.5 * PI * scale * f64::cos(PI * scale * x);
            let bent = DVec3::new(-height * slope, 1.0, 0.0).normalize();
            let side = if from_below { -1.0 } else { 1.0 };
            let t = transform(place);
            let normal = t.world_from_object_normal(bent).normalize() * side;
            let flat = t.world_from_object_normal(DVec3::Y).normalize() * side;
            // A sun far off the bent normal, the way that it is bent, on the viewer's side.
            let aside = t.world_from_object_vector(DVec3::X);
            let aside = (aside - flat * aside.dot(flat)).normalize();
            let towards = (normal + 0.9 * aside).normalize();
            let body = format!(
                "[[textures]]\nname = 't'\ntype = 'marble'\nscale = {scale}\n\
                 [[materials]]\nname = 'm'\ndiffuse = [1, 1, 1]\n\
                 bump = {{ texture = 't', height = {height} }}\n\
                 [[objects]]\ntype = 'plane'\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\n\
                 material = 'm'\n{}{}",
                keys(place),
                sun(towards)
            );
            let point = DVec3::new(x, 0.0, 0.3);
            let look = look_at_point(&t, point, DVec3::Y * side);
            let found = look.radiance(&body).x * PI;
            assert_close(found, towards.dot(normal), 1e-3, &format!("bump at {x} in {place:?}"));
        }
    }
}

/// Between two texel centres a picture's height rises evenly: the gradient goes through uv.
#[test]
fn a_picture_bumps_along_its_uv() {
    let image = || Image { width: 2, height: 1, texels: vec![[0.0; 3], [1.0; 3]] };
    for place in PLACES {
        // Cells of the plane's uv are 1 / 0.5 = 2 wide; the slope is 2 a cell.
        let bent = DVec3::new(-0.4 * 2.0 * 0.5, 1.0, 0.0).normalize();
        let t = transform(place);
        let normal = t.world_from_object_normal(bent).normalize();
        let towards = (normal + 0.3 * normal.any_orthonormal_vector()).normalize();
        let body = format!(
            "[[textures]]\nname = 't'\ntype = 'image'\nfile = 'i'\nscale = 0.5\n\
             [[materials]]\nname = 'm'\ndiffuse = [1, 1, 1]\nbump = {{ texture = 't', height = 0.4 }}\n\
             [[objects]]\ntype = 'plane'\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\nmaterial = 'm'\n\
             {}{}",
            keys(place),
            sun(towards)
        );
        let text = look_at_point(&t, DVec3::new(0.9, 0.0, 0.2), DVec3::Y).text(&body);
        let files = Files { images: vec![("i", image())], ..Files::default() };
        let found = mean(&film(&job_with(&text, files, AcceleratorKind::KdTree), 16)).x * PI;
        assert_close(found, towards.dot(normal), 1e-3, &format!("in {place:?}"));
    }
}

const CORNERS: [DVec3; 3] =
    [DVec3::new(-1.0, 0.0, 1.0), DVec3::new(1.0, 0.0, 1.0), DVec3::new(0.0, 0.0, -1.0)];
const CORNER_NORMALS: [DVec3; 3] =
    [DVec3::new(-0.6, 0.8, 0.0), DVec3::new(0.6, 0.8, 0.0), DVec3::new(0.0, 0.6, -0.8)];

/// One triangle in the plane y = 0, counter-clockwise from above, with bent corner normals.
fn bent_triangle() -> Mesh {
    Mesh {
        positions: CORNERS.map(|p| p.as_vec3()).to_vec(),
        triangles: vec![[0, 1, 2]],
        normals: CORNER_NORMALS.map(|n| n.as_vec3()).to_vec(),
        normal_ids: vec![[0, 1, 2]],
        ..Mesh::default()
    }
}

fn of_bent_triangle(look: &Look, body: &str) -> DVec3 {
    let files = Files { meshes: vec![("t", bent_triangle)], ..Files::default() };
    mean(&film(&job_with(&look.text(body), files, AcceleratorKind::KdTree), 16))
}

#[test]
fn corner_normals_are_interpolated_and_go_to_the_world_by_the_inverse_transpose() {
    for place in PLACES {
        for weights in [[0.2, 0.5, 0.3], [0.8, 0.1, 0.1]] {
            let at =
                |corners: [DVec3; 3]| -> DVec3 { (0..3).map(|k| corners[k] * weights[k]).sum() };
            let t = transform(place);
            for side in [1.0, -1.0] {
                let normal = t.world_from_object_normal(at(CORNER_NORMALS)).normalize() * side;
                let flat = t.world_from_object_normal(DVec3::Y).normalize() * side;
                let towards = (normal + flat).normalize();
                let body = format!(
                    "[[materials]]\nname = 'm'\ndiffuse = [1, 1, 1]\n[[objects]]\ntype = 'mesh'\n\
                     file = 't'\nmaterial = 'm'\n{}{}",
                    keys(place),
                    sun(towards)
                );
                let look = look_at_point(&t, at(CORNERS), DVec3::Y * side);
                let found = of_bent_triangle(&look, &body).x * PI;
                let what = format!("{weights:?} from side {side} in {place:?}");
                assert_close(found, towards.dot(normal), 1e-3, &what);
            }
        }
    }
}

/// Light counts above the flat surface and above the shading normal's plane; a mirrored ray that
/// goes below the flat surface carries nothing.
#[test]
fn light_below_either_normal_does_not_count() {
    // Near the second corner the shading normal leans to +x by some 37 degrees.
    let point = CORNERS[0] * 0.01 + CORNERS[1] * 0.98 + CORNERS[2] * 0.01;
    let look = look_at_point(&Transform::IDENTITY, point, DVec3::Y);
    let lit = |towards: DVec3| {
        let body = format!(
            "[[materials]]\nname = 'm'\ndiffuse = [1, 1, 1]\n[[objects]]\ntype = 'mesh'\n\
             file = 't'\nmaterial = 'm'\n{}",
            sun(towards)
        );
        of_bent_triangle(&look, &body).x
    };
    assert_eq!(lit(DVec3::new(1.0, -0.05, 0.0)), 0.0, "below the flat surface");
    assert_eq!(lit(DVec3::new(-1.0, 0.2, 0.0)), 0.0, "below the shading normal's plane");
    assert!(lit(DVec3::new(1.0, 0.05, 0.0)) > 0.1, "above both");
    let mirror = "[environment]\nbackground = [1, 1, 1]\n[[materials]]\nname = 'm'\n\
                  reflection = [1, 1, 1]\n[[objects]]\ntype = 'mesh'\nfile = 't'\nmaterial = 'm'\n";
    let from = |eye: DVec3| {
        of_bent_triangle(&Look::at((point + eye).to_array(), point.to_array()), mirror).x
    };
    assert_close(from(DVec3::new(0.3, 1.0, 0.0)), 1.0, 1e-6, "mirrored above");
    assert_eq!(from(DVec3::new(-1.0, 0.5, 0.0)), 0.0, "mirrored below the flat surface");
}

#[test]
fn surfaces_have_two_sides_each_lit_from_its_own() {
    let body = |y: f64| format!("{}{}", crate::common::WHITE_FLOOR, sun(DVec3::new(0.0, y, 0.0)));
    for (eye, towards, expected) in
        [(1.0, 1.0, 1.0), (1.0, -1.0, 0.0), (-1.0, 1.0, 0.0), (-1.0, -1.0, 1.0)]
    {
        let found = Look::at([0.5, eye, 0.0], [0.0; 3]).radiance(&body(towards)).x * PI;
        assert!((found - expected).abs() < 1e-5, "{found} seen from {eye}, lit from {towards}");
    }
}

/// Every texture sticks to the object: at one of its points it has one colour, wherever that is.
#[test]
fn textures_stick_to_moved_objects() {
    let textures = [
        "type = 'checker'\nscale = 3.3\ncolors = [[1, 0.5, 0], [0, 0.2, 1]]",
        "type = 'marble'\nscale = 2\ndistortion = 3",
        "type = 'wood'\nscale = 3\ndistortion = 1",
        "type = 'clouds'\nscale = 2\ndistortion = 1",
        "type = 'spots'\nscale = 4\ndistortion = 0.5",
    ];
    let normal = DVec3::new(0.48, 0.6, 0.64);
    let point = DVec3::new(0.2, -0.3, 0.1) + 0.7 * normal;
    for texture in textures {
        for place in PLACES {
            let body = format!(
                "[environment]\nambient = [1, 1, 1]\n[[textures]]\nname = 't'\n{texture}\n\
                 [[materials]]\nname = 'm'\ndiffuse = 't'\n[[objects]]\ntype = 'sphere'\n\
                 center = [0.2, -0.3, 0.1]\nradius = 0.7\nmaterial = 'm'\n{}",
                keys(place)
            );
            let look = look_at_point(&transform(place), point, normal);
            let job = job(&look.text(&body));
            let lookup = Lookup { point, uv: glam::Vec2::ZERO, uv_gradients: [Vec3::ZERO; 2] };
            let expected = job.scene.textures[0].eval(&lookup).as_dvec3();
            let found = mean(&film(&job, 16));
            assert!((found - expected).length() < 5e-3, "{found}, not {expected}: {texture}");
        }
    }
}

/// A picture of 4 x 2 texels, each of its own colour: red tells the column, green the row.
fn chart() -> Image {
    let texels = (0..8).map(|i| [0.1 + 0.2 * (i % 4) as f32, 0.3 + 0.4 * (i / 4) as f32, 0.0]);
    Image { width: 4, height: 2, texels: texels.collect() }
}

fn with_chart(look: &Look, body: &str) -> DVec3 {
    let files = Files { images: vec![("chart", chart())], ..Files::default() };
    mean(&film(&job_with(&look.text(body), files, AcceleratorKind::KdTree), 16))
}

/// The colour of the texel in a column and a row from the top.
fn texel(column: i32, row: i32) -> DVec3 {
    DVec3::new(0.1 + 0.2 * f64::from(column), 0.3 + 0.4 * f64::from(row), 0.0)
}

/// u to the right and v up: texel centres on the sphere, the plane, the box and the mesh.
#[test]
fn pictures_lie_the_right_way_round_on_every_shape() {
    let body = |shape: &str| {
        format!(
            "[environment]\nambient = [1, 1, 1]\n[[textures]]\nname = 't'\ntype = 'image'\n\
             file = 'chart'\n[[materials]]\nname = 'm'\ndiffuse = 't'\n[[objects]]\n{shape}\n\
             material = 'm'\n"
        )
    };
    let check = |shape: &str, point: DVec3, normal: DVec3, column, row| {
        let look = Look::at((point + 0.4 * normal).to_array(), point.to_array());
        let found = with_chart(&look, &body(shape));
        let expected = texel(column, row);
        let miss = (found - expected).length();
        assert!(miss < 2e-3, "{found}, not {expected} at {point} of {shape}");
    };
    for column in 0..4 {
        for row in 0..2 {
            let u = (f64::from(column) + 0.5) / 4.0;
            let v = 1.0 - (f64::from(row) + 0.5) / 2.0;
            let (azimuth, height) = (2.0 * PI * (u - 0.5), PI * (v - 0.5));
            let n = DVec3::new(
                height.cos() * azimuth.sin(),
                height.sin(),
                height.cos() * azimuth.cos(),
            );
            let center = DVec3::new(1.0, 2.0, 3.0);
            check(
                "type = 'sphere'\ncenter = [1, 2, 3]\nradius = 2",
                center + 2.0 * n,
                n,
                column,
                row,
            );
            // X is [1, 0, 0] on the plane, Y = N x X.
            let p = DVec3::new(1.0, 5.0, 2.0) + DVec3::new(u, 0.0, -v);
            check(
                "type = 'plane'\npoint = [1, 5, 2]\nnormal = [0, 1, 0]",
                p,
                DVec3::Y,
                column,
                row,
            );
            let p = DVec3::new(1.0, 2.0, 5.0) + DVec3::new(u, v, 0.0);
            check(
                "type = 'plane'\npoint = [1, 2, 5]\nnormal = [0, 0, 1]",
                p,
                DVec3::Z,
                column,
                row,
            );
            // The tangent rule: [1, 0, 0] stands on this plane, so X is [0, 0, 1], Y = N x X = -Y.
            let p = DVec3::new(0.0, -v, u);
            check(
                "type = 'plane'\npoint = [0, 0, 0]\nnormal = [1, 0, 0]",
                p,
                DVec3::X,
                column,
                row,
            );
            let p = DVec3::new(4.0 * u, 2.0 * v, 1.0);
            check("type = 'box'\nmin = [0, 0, 0]\nmax = [4, 2, 1]", p, DVec3::Z, column, row);
        }
    }
}

/// Seen from within, looking along -z with +y up, the sky's picture has its middle ahead, u to the
/// right and v up.
#[test]
fn the_sky_is_looked_up_by_direction() {
    let body = "[environment]\nbackground = 't'\n[[textures]]\nname = 't'\ntype = 'image'\n\
                file = 'chart'\n";
    for column in 0..4 {
        for row in 0..2 {
            let azimuth = 2.0 * PI * ((f64::from(column) + 0.5) / 4.0 - 0.5);
            let height = PI * (0.5 - (f64::from(row) + 0.5) / 2.0);
            let d = DVec3::new(
                height.cos() * azimuth.sin(),
                height.sin(),
                -height.cos() * azimuth.cos(),
            );
            let found = with_chart(&Look::at([0.0; 3], d.to_array()), body);
            assert!((found - texel(column, row)).length() < 2e-3, "{found} towards {d}");
        }
    }
    let ahead = Look::at([3.0; 3], [3.0, 3.1, 2.0]);
    let found = with_chart(&ahead, body);
    assert!((found.x - 0.4).abs() < 2e-3, "ahead is between the middle columns: {found}");
}

/// A face on the border of two cells has one of their colours, the one above it, not both.
#[test]
fn a_checkered_face_on_a_border_is_not_speckled() {
    let text = "[render]\nwidth = 32\nheight = 32\n[camera]\neye = [0.5, 3, 0.5]\n\
                target = [0.5, 0, 0.5]\nup = [0, 0, -1]\nvertical_fov = 10\n\
                [environment]\nambient = [1, 1, 1]\n\
                [[textures]]\nname = 't'\ntype = 'checker'\ncolors = [[0.2, 0.2, 0.2], [0.9, 0, 0]]\n\
                [[materials]]\nname = 'm'\ndiffuse = 't'\n\
                [[objects]]\ntype = 'plane'\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\nmaterial = 'm'\n";
    for turn in ["", "rotate = [0, 0.3, 0]", "translate = [0, 0.7, 0]"] {
        let picture = film(&job(&format!("{text}{turn}")), 4).picture();
        assert!(picture.pixels.iter().all(|p| *p == [0.2; 3]), "one colour with {turn:?}");
    }
}

/// The order of the cells' colours, across 0: floor, not truncation.
#[test]
fn checkers_count_cells_by_floor() {
    let colors = [Vec3::splat(0.25), Vec3::splat(0.75)];
    let texture = Texture::Checker { scale: 2.0, colors };
    for (x, y, z) in [(0_i32, 0, 0), (1, 0, 0), (-1, 0, 0), (-1, -1, 0), (3, -2, 4), (-3, -3, -3)] {
        let point = (DVec3::new(f64::from(x), f64::from(y), f64::from(z)) + 0.5) / 2.0;
        let lookup = Lookup { point, uv: glam::Vec2::ZERO, uv_gradients: [Vec3::ZERO; 2] };
        let expected = colors[(x + y + z).rem_euclid(2) as usize];
        assert_eq!(texture.eval(&lookup), expected, "cell ({x}, {y}, {z})");
    }
    // A thousandth of a cell on either side of a far border.
    for (x, color) in [(8.999, colors[0]), (9.001, colors[1])] {
        let point = DVec3::new(x / 2.0, 0.1, 0.1);
        let lookup = Lookup { point, uv: glam::Vec2::ZERO, uv_gradients: [Vec3::ZERO; 2] };
        assert_eq!(texture.eval(&lookup), color, "{x} cells along");
    }
}

/// Right-handed, about fixed axes, X then Y then Z, after the scale.
#[test]
fn objects_are_scaled_then_turned_about_x_y_and_z_then_moved() {
    let t = Transform::new(
        DVec3::new(1.0, 2.0, 3.0),
        DVec3::new(30.0, 50.0, 70.0),
        DVec3::new(2.0, 3.0, -4.0),
    );
    let [x, y, z] = [30.0_f64, 50.0, 70.0].map(f64::to_radians);
    let turned = DMat3::from_rotation_z(z) * DMat3::from_rotation_y(y) * DMat3::from_rotation_x(x);
    let p = DVec3::new(0.3, -0.7, 1.1);
    let expected = DVec3::new(1.0, 2.0, 3.0) + turned * (DVec3::new(2.0, 3.0, -4.0) * p);
    assert!((t.world_from_object_point(p) - expected).length() < 1e-12, "{expected}");
}
