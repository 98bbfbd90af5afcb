//! Textures at a block of points, in lanes; the formulas are those of a single point.

use glam::{DVec3, Vec3};

use super::{ELSEWHERE, Noise, Pattern, Texture};
use crate::color::Rgb;
use crate::math::noise::perlin_block;
use crate::math::vectorized::{
    BLOCK, DLane3, Lane, Lane3, dvec3, set_dvec3, set_vec3, vec3, vectorized,
};

impl Texture {
    /// [`Texture::eval`] at points of an object. `false` where that takes more than the points, and
    /// nothing is done.
    pub(crate) fn eval_block(&self, points: &DLane3, colors: &mut Lane3) -> bool {
        match self {
            Self::Solid(color) => each(colors, |_| *color),
            Self::Checker { scale, colors: pair } => {
                each(colors, |i| super::checker(*scale, pair, dvec3(points, i)));
            }
            Self::Image { .. } => return false,
            Self::Noise(noise) => {
                let values = noise.values(points);
                each(colors, |i| noise.ramp(values[i]));
            }
        }
        true
    }

    /// [`Texture::eval_direction`] for a block of directions.
    pub(crate) fn eval_directions(&self, directions: &Lane3, colors: &mut Lane3) {
        let mut points = [[0.0; BLOCK]; 3];
        for (points, directions) in points.iter_mut().zip(directions) {
            *points = directions.map(f64::from);
        }
        if !self.eval_block(&points, colors) {
            each(colors, |i| self.eval_direction(vec3(directions, i)));
        }
    }

    /// [`Texture::luminance_gradient`] at points of an object; as [`Texture::eval_block`].
    pub(crate) fn luminance_gradients(&self, points: &DLane3, gradients: &mut Lane3) -> bool {
        match self {
            Self::Solid(_) | Self::Checker { .. } => each(gradients, |_| Vec3::ZERO),
            Self::Image { .. } => return false,
            Self::Noise(noise) => noise.luminance_gradients(points, gradients),
        }
        true
    }
}

fn each(lanes: &mut Lane3, value: impl Fn(usize) -> Rgb) {
    for i in 0..BLOCK {
        set_vec3(lanes, i, value(i));
    }
}

impl Noise {
    /// [`Noise::value`] at a block of points.
    fn values(&self, points: &DLane3) -> Lane<f64> {
        let q = points.map(|axis| axis.map(|x| x * self.scale));
        let sums = match self.pattern {
            Pattern::Spots | Pattern::Clouds => {
                self.octaves.sum_block(&self.displaced_block(&q), false)
            }
            Pattern::Marble | Pattern::Wood if self.distortion == 0.0 => [0.0; BLOCK],
            Pattern::Marble => self.octaves.sum_block(&q, true),
            Pattern::Wood => self.octaves.sum_block(&q, false),
        };
        let mut values = sums;
        shape(self.pattern, self.distortion, &q, &mut values);
        values
    }

    fn displaced_block(&self, q: &DLane3) -> DLane3 {
        let mut displaced = *q;
        if self.distortion != 0.0 {
            for (axis, shift) in displaced.iter_mut().zip(ELSEWHERE) {
                let mut noise = [0.0; BLOCK];
                perlin_block(q, shift, &mut noise);
                for (x, noise) in axis.iter_mut().zip(noise) {
                    *x += noise * self.distortion;
                }
            }
        }
        displaced
    }

    fn luminance_gradients(&self, points: &DLane3, gradients: &mut Lane3) {
        let h = self.step();
        let at = |shift: DVec3| {
            let mut shifted = *points;
            for i in 0..BLOCK {
                set_dvec3(&mut shifted, i, dvec3(points, i) + shift);
            }
            self.values(&shifted).map(|value| self.exact_luminance(value))
        };
        let slopes = DVec3::AXES.map(|axis| {
            let (above, below) = (at(axis * h), at(axis * -h));
            let mut slope = [0.0; BLOCK];
            for i in 0..BLOCK {
                slope[i] = (above[i] - below[i]) / (2.0 * h);
            }
            slope
        });
        each(gradients, |i| {
            let gradient = dvec3(&slopes, i).as_vec3();
            if gradient.is_finite() { gradient } else { Vec3::ZERO }
        });
    }
}

vectorized! {
    fn shape(pattern: Pattern, distortion: f64, q: &DLane3, values: &mut Lane<f64>) {
        // Each pattern has its own loop, in which it is known.
        match pattern {
            Pattern::Spots => each_shape(Pattern::Spots, distortion, q, values),
            Pattern::Marble => each_shape(Pattern::Marble, distortion, q, values),
            Pattern::Clouds => each_shape(Pattern::Clouds, distortion, q, values),
            Pattern::Wood => each_shape(Pattern::Wood, distortion, q, values),
        }
    }
}

#[inline(always)]
fn each_shape(pattern: Pattern, distortion: f64, q: &DLane3, values: &mut Lane<f64>) {
    for i in 0..BLOCK {
        values[i] = pattern.shape(dvec3(q, i), values[i], distortion);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::math::noise::Octaves;
    use crate::math::vectorized::{NO_LANES, at_every_level};
    use crate::scene::image::Image;
    use crate::scene::texture::Lookup;

    fn textures() -> Vec<Texture> {
        let colors = vec![Rgb::new(0.9, 0.1, 0.3), Rgb::new(0.0, 0.7, 0.2), Rgb::ONE];
        let mut textures = vec![
            Texture::Solid(Rgb::new(0.1, 0.2, 0.3)),
            Texture::Checker { scale: 3.0, colors: [Rgb::ZERO, Rgb::ONE] },
        ];
        for pattern in [Pattern::Spots, Pattern::Marble, Pattern::Clouds, Pattern::Wood] {
            for distortion in [0.0, 2.5] {
                let octaves = Octaves { count: 4, lacunarity: 2.1, gain: 0.45 };
                let (scale, colors) = (1.7, colors.clone());
                let noise = Noise { pattern, scale, octaves, distortion, colors };
                textures.push(Texture::Noise(noise));
            }
        }
        textures
    }

    #[test]
    fn a_block_of_points_has_the_colors_and_slopes_of_its_points() {
        let mut points = [[0.0; BLOCK]; 3];
        for i in 0..BLOCK {
            let x = i as f64 - 11.0;
            set_dvec3(&mut points, i, DVec3::new(0.37 * x, 1.1 - 0.21 * x, 0.05 * x * x));
        }
        set_dvec3(&mut points, 3, DVec3::new(f64::INFINITY, 1e300, -1e18));
        for texture in textures() {
            let results = at_every_level(|| {
                let (mut colors, mut gradients) = (NO_LANES, NO_LANES);
                assert!(texture.eval_block(&points, &mut colors), "{texture:?}");
                assert!(texture.luminance_gradients(&points, &mut gradients), "{texture:?}");
                (colors, gradients)
            });
            for (level, (colors, gradients)) in results {
                for i in 0..BLOCK {
                    let point = dvec3(&points, i);
                    let uv = glam::Vec2::ZERO;
                    let at = Lookup { point, uv, uv_gradients: [Vec3::ZERO; 2] };
                    let name = format!("{level:?}, {texture:?} at {point}");
                    assert_eq!(vec3(&colors, i), texture.eval(&at), "{name}");
                    assert_eq!(vec3(&gradients, i), texture.luminance_gradient(&at), "{name}");
                }
            }
        }
        let image = Texture::Image { scale: 1.0, image: Arc::new(Image::default()) };
        assert!(!image.eval_block(&points, &mut NO_LANES.clone()), "needs uv");
    }
}
