//! A Lambertian surface under a Ward lobe, sampled as a mixture.

use glam::Vec3;

use crate::brdf::Ward;
use crate::color::{Rgb, luminance};
use crate::math::warp;

/// Diffuse and glossy reflection at one point.
#[derive(Clone, Copy, Debug)]
pub struct Glossy {
    /// Lambertian reflectance, 0..=1.
    pub diffuse: Rgb,
    /// Ward's rho_s, 0..=1.
    pub specular: Rgb,
    /// The lobe that rho_s scales.
    pub lobe: Ward,
}

impl Glossy {
    /// Whether nothing is scattered.
    pub fn is_black(&self) -> bool {
        self.diffuse == Rgb::ZERO && self.specular == Rgb::ZERO
    }

    /// Value in 1/sr. The diffuse part takes light from above, whatever the side of the viewer.
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        if wi.z <= 0.0 {
            return Rgb::ZERO;
        }
        let mut value = self.diffuse / std::f32::consts::PI;
        if self.specular != Rgb::ZERO {
            value += self.specular * self.lobe.eval(wo, wi);
        }
        value
    }

    /// Chance with which the diffuse lobe is sampled: by albedo.
    fn diffuse_share(&self, wo: Vec3) -> f32 {
        let specular = if wo.z > 0.0 { luminance(self.specular) } else { 0.0 };
        let diffuse = luminance(self.diffuse);
        let total = diffuse + specular;
        if total > 0.0 { diffuse / total } else { 1.0 }
    }

    /// A direction for two numbers in [0, 1), with density [`Glossy::pdf`]; `None` where it would
    /// be below the surface.
    pub fn sample(&self, wo: Vec3, [u, v]: [f32; 2]) -> Option<Vec3> {
        let share = self.diffuse_share(wo);
        // The first number chooses the lobe and is stretched back to [0, 1).
        const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;
        if u < share {
            let wi = warp::square_to_cosine_hemisphere([(u / share).min(BELOW_ONE), v]);
            (wi.z > 0.0).then_some(wi)
        } else {
            self.lobe.sample(wo, [((u - share) / (1.0 - share)).min(BELOW_ONE), v])
        }
    }

    /// Density of [`Glossy::sample`] per solid angle of `wi`.
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let share = self.diffuse_share(wo);
        let mut pdf = share * warp::cosine_hemisphere_pdf(wi.z);
        if share < 1.0 {
            pdf += (1.0 - share) * self.lobe.pdf(wo, wi);
        }
        pdf
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brdf::WardForm;

    /// How the lobes share the samples moves no mean, only noise: by their luminances; from below only
    /// the diffuse one is left.
    #[test]
    fn lobes_share_the_samples_by_luminance() {
        let glossy = Glossy {
            diffuse: Rgb::new(0.2, 0.4, 0.1),
            specular: Rgb::new(0.5, 0.1, 0.6),
            lobe: Ward { form: WardForm::Duer, alpha_x: 0.05, alpha_y: 0.05 },
        };
        let diffuse = 0.2126 * 0.2 + 0.7152 * 0.4 + 0.0722 * 0.1;
        let specular = 0.2126 * 0.5 + 0.7152 * 0.1 + 0.0722 * 0.6;
        let wo = Vec3::new(0.6, 0.0, 0.8);
        // Far beside the lobe, so that the diffuse part alone is as dense.
        let wi = Vec3::new(0.0, 0.8, 0.6);
        for (wo, share) in [(wo, diffuse / (diffuse + specular)), (-wo, 1.0)] {
            let (found, expected) = (glossy.pdf(wo, wi), share * 0.6 / std::f32::consts::PI);
            assert!((found / expected - 1.0).abs() < 1e-5, "{found}, not {expected}");
        }
    }
}
