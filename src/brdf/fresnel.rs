//! Reflection and refraction at the border of two dielectrics.

use glam::Vec3;

/// Share of unpolarised light that is reflected, 0..=1; 1 at total internal reflection.
///
/// `cos_i` is the cosine of incidence, 0..=1; `eta` the index of refraction on the far side over
/// that on the near side. Source: M. Born and E. Wolf, "Principles of Optics", section 1.5.2.
pub fn dielectric(cos_i: f32, eta: f32) -> f32 {
    let cos_i = cos_i.clamp(0.0, 1.0);
    let sin2_t = (1.0 - cos_i * cos_i) / (eta * eta);
    if sin2_t >= 1.0 {
        return 1.0;
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    let parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    let perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    0.5 * (parallel * parallel + perpendicular * perpendicular)
}

/// Mirror image of `wo` about the unit `normal`.
pub fn reflect(wo: Vec3, normal: Vec3) -> Vec3 {
    2.0 * wo.dot(normal) * normal - wo
}

/// Direction of `wo` refracted through a surface whose unit `normal` is on its side; `None` at
/// total internal reflection. `eta` as in [`dielectric`].
pub fn refract(wo: Vec3, normal: Vec3, eta: f32) -> Option<Vec3> {
    let cos_i = wo.dot(normal);
    let sin2_t = (1.0 - cos_i * cos_i).max(0.0) / (eta * eta);
    if sin2_t >= 1.0 {
        return None;
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    Some((normal * (cos_i / eta - cos_t) - wo / eta).normalize())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn glass_reflects_four_percent_and_everything_when_grazing() {
        let (head_on, grazing) = (dielectric(1.0, 1.5), dielectric(0.0, 1.5));
        assert!((head_on - 0.04).abs() < 1e-6, "head on {head_on}");
        assert!((grazing - 1.0).abs() < 1e-6, "grazing {grazing}");
        assert_eq!(dielectric(0.5, 1.0 / 1.5), 1.0, "total internal reflection");
    }

    /// Reflectance is the same from both sides along one path of light.
    #[test]
    fn fresnel_is_symmetric_along_a_path() {
        for cos_i in [0.1_f32, 0.4, 0.8, 0.99] {
            let cos_t = (1.0 - (1.0 - cos_i * cos_i) / 2.25).sqrt();
            let (there, back) = (dielectric(cos_i, 1.5), dielectric(cos_t, 1.0 / 1.5));
            assert!((there - back).abs() < 1e-5, "{there} and {back} at {cos_i}");
        }
    }

    #[test]
    fn refraction_obeys_snell() {
        let wo = Vec3::new(0.6, 0.0, 0.8);
        let wt = refract(wo, Vec3::Z, 1.5).unwrap();
        assert!((wt.x + 0.6 / 1.5).abs() < 1e-6 && wt.z < 0.0, "{wt}");
        assert!(refract(wo, Vec3::Z, 0.5).is_none(), "total internal reflection");
    }
}
