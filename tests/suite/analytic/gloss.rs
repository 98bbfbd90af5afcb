//! Ward's lobes: reciprocity, albedo, and rendered gloss against quadrature.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;
use penumbra::brdf::{Ward, WardForm};

use crate::common::{Look, Numbers, assert_close};

pub(super) const FORMS: [(WardForm, &str); 3] =
    [(WardForm::Original, "original"), (WardForm::Duer, "duer"), (WardForm::Bounded, "bounded")];

/// The contract's formulas, written down again in double precision.
pub(super) fn reference(form: WardForm, ax: f64, ay: f64, wo: DVec3, wi: DVec3) -> f64 {
    if wo.z <= 0.0 || wi.z <= 0.0 {
        return 0.0;
    }
    let sum = wo + wi;
    let h = sum.normalize();
    let exponent = -2.0 * ((h.x / ax).powi(2) + (h.y / ay).powi(2)) / (1.0 + h.z);
    match form {
        WardForm::Original => exponent.exp() / (4.0 * PI * ax * ay * (wo.z * wi.z).sqrt()),
        WardForm::Duer => exponent.exp() / (4.0 * PI * ax * ay * wo.z * wi.z),
        WardForm::Bounded => {
            let slope = ((sum.x / ax).powi(2) + (sum.y / ay).powi(2)) / sum.z.powi(2);
            (-slope).exp() * sum.length_squared() / (PI * ax * ay * sum.z.powi(4))
        }
    }
}

pub(super) fn direction(theta: f64, phi: f64) -> DVec3 {
    DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
}

/// Share of the light from `wi` that is reflected, by quadrature about the mirror direction.
pub(super) fn albedo(form: WardForm, ax: f64, ay: f64, wi: DVec3) -> f64 {
    // Over half vectors h, which crowd about the normal: dw = 4 (h.wi) dh.
    let (n_theta, n_phi) = (400, 200);
    let mut sum = 0.0;
    for i in 0..n_theta {
        let s = (f64::from(i) + 0.5) / f64::from(n_theta);
        // Theta as the cube of an even grid: fine where the lobe is sharp.
        let (theta, d_theta) =
            (FRAC_PI_2 * s.powi(3), FRAC_PI_2 * 3.0 * s * s / f64::from(n_theta));
        for j in 0..n_phi {
            let h = direction(theta, TAU * (f64::from(j) + 0.5) / f64::from(n_phi));
            let cos = h.dot(wi);
            let wo = 2.0 * cos * h - wi;
            if cos > 0.0 && wo.z > 0.0 {
                let d_omega = 4.0 * cos * theta.sin() * d_theta * TAU / f64::from(n_phi);
                sum += reference(form, ax, ay, wo, wi) * wo.z * d_omega;
            }
        }
    }
    sum
}

#[test]
fn lobes_have_the_value_of_the_published_formulas_and_are_reciprocal() {
    let mut numbers = Numbers::new(1);
    for (form, _) in FORMS {
        for (alpha_x, alpha_y) in [(0.15, 0.15), (0.05, 0.4), (1.5, 0.7)] {
            let lobe = Ward { form, alpha_x, alpha_y };
            for _ in 0..2000 {
                let wo = numbers.direction();
                let mut wi = numbers.direction();
                if numbers.next() < 0.7 && wo.z > 0.0 {
                    // Near the mirror direction, where the lobe is.
                    wi = (DVec3::new(-wo.x, -wo.y, wo.z) + wi * 0.2).normalize();
                }
                let found = f64::from(lobe.eval(wo.as_vec3(), wi.as_vec3()));
                let expected = reference(form, f64::from(alpha_x), f64::from(alpha_y), wo, wi);
                let limit = 1e-3 * expected + 1e-6;
                assert!((found - expected).abs() < limit, "{lobe:?}: {found}, not {expected}");
                let back = lobe.eval(wi.as_vec3(), wo.as_vec3());
                assert_eq!(f64::from(back), found, "{lobe:?} is reciprocal");
            }
        }
    }
}

/// "bounded" never reflects more than it receives, at any roughness and angle; where lobes are
/// narrow and light comes from above, every form reflects nearly all of rho_s.
#[test]
fn albedo_is_bounded_where_the_contract_says_so() {
    for theta_deg in [0.0_f64, 30.0, 60.0, 80.0, 88.0] {
        let wi = direction(theta_deg.to_radians(), 0.7);
        for (ax, ay) in [(0.05, 0.05), (0.15, 0.4), (0.5, 0.5), (2.0, 0.3)] {
            let bounded = albedo(WardForm::Bounded, ax, ay, wi);
            assert!(bounded <= 1.0 + 1e-3, "bounded reflects {bounded} at {theta_deg}");
        }
    }
    for (form, name) in FORMS {
        let straight = albedo(form, 0.1, 0.1, direction(0.2, 0.0));
        assert!((0.95..=1.02).contains(&straight), "{name} reflects {straight} from above");
    }
    let original = albedo(WardForm::Original, 0.15, 0.15, direction(1.5, 0.0));
    let duer = albedo(WardForm::Duer, 0.15, 0.15, direction(1.5, 0.0));
    assert!(original < 0.9 && duer > 1.02, "grazing: {original} of original, {duer} of duer");
}

/// A glossy floor, X along `tangent`, turned about Y by `turn` degrees.
fn glossy_floor(form: &str, alpha: [f64; 2], tangent: [f64; 3], turn: f64) -> String {
    format!(
        "[[materials]]\nname = 'gloss'\nspecular = [0.6, 0.6, 0.6]\ndiffuse = [0.1, 0.1, 0.1]\n\
         ward = '{form}'\nalpha_x = {}\nalpha_y = {}\ntangent = {tangent:?}\n\
         [[objects]]\ntype = 'plane'\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\nmaterial = 'gloss'\n\
         rotate = [0, {turn}, 0]\n",
        alpha[0], alpha[1]
    )
}

const EYE: DVec3 = DVec3::new(1.0, 1.1, 0.6);

/// Radiance towards the eye under a rectangle or a point light, by quadrature.
fn expected_radiance(form: WardForm, alpha: [f64; 2], x_axis: DVec3, size: f64) -> f64 {
    let (n, x) = (DVec3::Y, x_axis.normalize());
    let y = n.cross(x);
    let local = |v: DVec3| {
        let v = v.normalize();
        DVec3::new(v.dot(x), v.dot(y), v.dot(n))
    };
    let position = DVec3::new(-1.2, 1.1, -0.4);
    let axis = -position.normalize();
    let u = axis.cross(DVec3::Y).normalize();
    let v = u.cross(axis);
    let count = if size == 0.0 { 1 } else { 300 };
    let mut sum = 0.0;
    for i in 0..count * count {
        let at = |k: i32| (f64::from(k) + 0.5) / f64::from(count) - 0.5;
        let place = position + size * (u * at(i % count) + v * at(i / count));
        let wi = local(place);
        let brdf = 0.1 / PI + 0.6 * reference(form, alpha[0], alpha[1], local(EYE), wi);
        let cos_light = (-axis.dot(place.normalize()) * -1.0).abs();
        sum += brdf * wi.z * cos_light / place.length_squared();
    }
    // Power 4: intensity 4 / pi, shared by all parts of the light.
    4.0 / PI * sum / f64::from(count * count)
}

/// Rendered gloss against quadrature, for lights from a point to a large rectangle and lobes from
/// sharp to broad: both ways of finding the light together are unbiased.
#[test]
fn rendered_gloss_agrees_with_quadrature_for_every_light_and_lobe() {
    for (form, name) in FORMS {
        for alpha in [[0.03, 0.03], [0.15, 0.3], [0.8, 0.5]] {
            for size in [0.0, 0.05, 2.0] {
                let floor = glossy_floor(name, alpha, [1.0, 0.0, 0.0], 0.0);
                let body = format!(
                    "{floor}[[lights]]\ntype = 'rectangle'\nposition = [-1.2, 1.1, -0.4]\n\
                     size = {size}\npower = [4, 4, 4]\nvisible = false\n"
                );
                let expected = expected_radiance(form, alpha, DVec3::X, size);
                for render in ["", "integrator = 'path'\nmax_depth = 1"] {
                    let look = Look::at(EYE.to_array(), [0.0; 3]).samples(1024).with(render);
                    let found = look.radiance(&body).x;
                    let what = format!("{name} {alpha:?} under {size} ({render})");
                    assert_close(found, expected, 6e-3, &what);
                }
            }
        }
    }
}

/// Gloss under a sphere and a sun: the density of each is that of its cap.
#[test]
fn spheres_and_suns_shine_on_gloss_as_their_caps_do() {
    let towards = DVec3::new(-1.2, 1.3, -0.7);
    let distance = towards.length();
    for (half_angle_deg, alpha) in [(1.0_f64, 0.2), (25.0, 0.05), (25.0, 0.4)] {
        let half_angle = half_angle_deg.to_radians();
        let radius = distance * half_angle.sin();
        let axis = towards / distance;
        let side = axis.any_orthonormal_vector();
        let other = axis.cross(side);
        let local = |v: DVec3| DVec3::new(v.x, -v.z, v.y);
        let (n_r, n_phi) = (400, 400);
        let mut sum = 0.0;
        for i in 0..n_r * n_phi {
            let drop = (1.0 - half_angle.cos()) * (f64::from(i % n_r) + 0.5) / f64::from(n_r);
            let phi = TAU * (f64::from(i / n_r) + 0.5) / f64::from(n_phi);
            let sin = (drop * (2.0 - drop)).sqrt();
            let d = axis * (1.0 - drop) + (side * phi.cos() + other * phi.sin()) * sin;
            let (wo, wi) = (local(EYE.normalize()), local(d));
            let lobe = reference(WardForm::Duer, alpha, alpha, wo, wi);
            sum += (0.1 / PI + 0.6 * lobe) * wi.z.max(0.0);
        }
        let solid_angle = TAU * (1.0 - half_angle.cos());
        let mean = sum / f64::from(n_r * n_phi) * solid_angle;
        let floor = glossy_floor("duer", [alpha, alpha], [1.0, 0.0, 0.0], 0.0);
        let position = towards.to_array();
        let lights = [
            (
                format!("type = 'sphere'\nsize = {}", 2.0 * radius),
                4.0 / (4.0 * PI * PI * radius * radius),
            ),
            (
                format!("type = 'sun'\nsize = {}", 2.0 * half_angle_deg),
                4.0 / (PI * half_angle.sin().powi(2)),
            ),
        ];
        for (keys, radiance) in lights {
            let body = format!(
                "{floor}[[lights]]\n{keys}\nposition = {position:?}\npower = [4, 4, 4]\n\
                 visible = false\n"
            );
            let found = Look::at(EYE.to_array(), [0.0; 3]).samples(1024).radiance(&body).x;
            assert_close(found, radiance * mean, 5e-3, &format!("{keys}, alpha {alpha}"));
        }
    }
}

/// The long axis of the highlight follows `tangent`, carried along by the object's rotation, and
/// falls back to the world's z where the tangent stands on the surface.
#[test]
fn anisotropy_follows_the_tangent() {
    let alpha = [0.4, 0.1];
    let turned = 30.0_f64.to_radians();
    let cases = [
        ([1.0, 0.0, 0.0], 0.0, DVec3::X),
        ([0.0, 0.0, 2.0], 0.0, DVec3::Z),
        ([3.0, 5.0, 3.0], 0.0, DVec3::new(1.0, 0.0, 1.0)),
        ([1.0, 0.0, 0.0], 30.0, DVec3::new(turned.cos(), 0.0, -turned.sin())),
        ([0.0, 1.0, 0.0], 30.0, DVec3::Z),
    ];
    for (tangent, turn, x_axis) in cases {
        let floor = glossy_floor("bounded", alpha, tangent, turn);
        let body = format!(
            "{floor}[[lights]]\ntype = 'rectangle'\nposition = [-1.2, 1.1, -0.4]\nsize = 0\n\
             power = [4, 4, 4]\n"
        );
        let found = Look::at(EYE.to_array(), [0.0; 3]).samples(4).radiance(&body).x;
        let expected = expected_radiance(WardForm::Bounded, alpha, x_axis, 0.0);
        assert_close(found, expected, 1e-3, &format!("tangent {tangent:?} turned by {turn}"));
    }
}

/// Under a white sky gloss shows the albedo of its form, more than 1 or not: by quadrature.
#[test]
fn gloss_under_a_white_sky_shows_its_albedo() {
    for (form, name) in FORMS {
        for alpha in [[0.1, 0.1], [0.3, 0.6]] {
            for theta_deg in [30.0_f64, 70.0] {
                let theta = theta_deg.to_radians();
                let body = format!(
                    "[environment]\nbackground = [1, 1, 1]\n{}",
                    glossy_floor(name, alpha, [1.0, 0.0, 0.0], 0.0)
                );
                let eye = [theta.sin(), theta.cos(), 0.0];
                let look = Look::at(eye, [0.0; 3]).samples(8192);
                let found = look.with("integrator = 'path'\nmax_depth = 1").radiance(&body).x;
                let expected = 0.1 + 0.6 * albedo(form, alpha[0], alpha[1], direction(theta, 0.0));
                assert_close(found, expected, 4e-3, &format!("{name} {alpha:?} at {theta_deg}°"));
            }
        }
    }
}
