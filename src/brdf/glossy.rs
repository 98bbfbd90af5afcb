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
