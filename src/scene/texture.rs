//! Colours that change from place to place.
//!
//! A noise pattern is a number from 0 to 1 at every point, shown through a ramp of colours. With
//! q = point · scale and octaves, lacunarity and gain as in [`Octaves`]:
//!
//! - *spots*: q is displaced by `distortion` · (three Perlin noises of q); the pattern is a smooth
//!   step of the fractal sum there, from 0 below 0.06 to 1 above 0.2;
//! - *marble*: 1/2 + 1/2 sin(π (q.x + `distortion` · turbulence(q)));
//! - *clouds*: 1/2 + the fractal sum at q displaced as for spots;
//! - *wood*: with r the distance of q from the Y axis plus `distortion` · the fractal sum, the
//!   fraction of r: rising as its square over 0.85 of a ring, then falling smoothly.
//!
//! Values are clamped to 0..=1.
//!
//! Sources: K. Perlin, "An Image Synthesizer", SIGGRAPH 1985; D. S. Ebert et al., "Texturing and
//! Modeling", 3rd edition, 2003, chapters 2 and 12.

mod block;

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::{DVec2, DVec3, Vec2, Vec3};

use crate::color::{Rgb, luminance};
use crate::math::elementary::{self, floor};
use crate::math::noise::{Octaves, perlin};
use crate::math::portable;
use crate::scene::image::Image;

/// A colour for every point of an object, or for every direction.
#[derive(Clone, Debug)]
pub enum Texture {
    /// The same everywhere.
    Solid(Rgb),
    /// Cubes of two colours.
    Checker {
        /// Cubes per unit.
        scale: f64,
        /// Of even and odd cubes.
        colors: [Rgb; 2],
    },
    /// A picture, repeated.
    Image {
        /// Repetitions per unit of uv.
        scale: f64,
        /// The picture.
        image: Arc<Image>,
    },
    /// Perlin noise.
    Noise(Noise),
}

/// Images are equal if they are the same one.
impl PartialEq for Texture {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Solid(a), Self::Solid(b)) => a == b,
            (Self::Checker { scale: s, colors: a }, Self::Checker { scale: t, colors: b }) => {
                s == t && a == b
            }
            (Self::Image { scale: s, image: a }, Self::Image { scale: t, image: b }) => {
                s == t && Arc::ptr_eq(a, b)
            }
            (Self::Noise(a), Self::Noise(b)) => a == b,
            _ => false,
        }
    }
}

/// A noise pattern and its colours.
#[derive(Clone, Debug, PartialEq)]
pub struct Noise {
    /// Which pattern.
    pub pattern: Pattern,
    /// Cells per unit.
    pub scale: f64,
    /// The fractal sum.
    pub octaves: Octaves,
    /// How strongly turbulence bends the pattern.
    pub distortion: f64,
    /// Two or more colours, evenly spaced over 0..=1.
    pub colors: Vec<Rgb>,
}

/// The patterns made of noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pattern {
    /// Round spots.
    Spots,
    /// Bent veins.
    Marble,
    /// Clouds.
    Clouds,
    /// Annual rings.
    Wood,
}

/// Where a texture is looked up.
#[derive(Clone, Copy, Debug)]
pub struct Lookup {
    /// In object space.
    pub point: DVec3,
    /// Texture coordinates.
    pub uv: Vec2,
    /// Gradients of u and v by the point.
    pub uv_gradients: [Vec3; 2],
}

impl Texture {
    /// Colour at a place of an object.
    pub fn eval(&self, at: &Lookup) -> Rgb {
        match self {
            Self::Solid(color) => *color,
            Self::Checker { scale, colors } => checker(*scale, colors, at.point),
            Self::Image { scale, image } => image.lookup(at.uv.as_dvec2() * *scale),
            Self::Noise(noise) => noise.color(at.point),
        }
    }

    /// Colour in a unit direction: for backgrounds.
    pub fn eval_direction(&self, direction: Vec3) -> Rgb {
        let d = direction.as_dvec3();
        match self {
            Self::Solid(color) => *color,
            Self::Checker { scale, colors } => checker(*scale, colors, d),
            Self::Image { scale, image } => {
                let u = 0.5 + portable::atan2_f64(d.x, -d.z) / TAU;
                let v = 0.5 + portable::asin_f64(d.y.clamp(-1.0, 1.0)) / PI;
                image.lookup(DVec2::new(u, v) * *scale)
            }
            Self::Noise(noise) => noise.color(d),
        }
    }

    /// Gradient of the luminance by the object-space point: of images along the surface through
    /// uv, of noise by central differences; 0 for the rest.
    pub fn luminance_gradient(&self, at: &Lookup) -> Vec3 {
        match self {
            Self::Solid(_) | Self::Checker { .. } => Vec3::ZERO,
            Self::Image { scale, image } => {
                let slope = image.luminance_gradient(at.uv.as_dvec2() * *scale) * *scale as f32;
                at.uv_gradients[0] * slope.x + at.uv_gradients[1] * slope.y
            }
            Self::Noise(noise) => noise.luminance_gradient(at.point),
        }
    }
}

/// Looked up a little further along each axis, so that a face on a cell's border is not speckled.
fn checker(scale: f64, colors: &[Rgb; 2], p: DVec3) -> Rgb {
    const SHIFT: f64 = 1e-4;
    let q = p * scale + SHIFT;
    let sum = floor(q.x) + floor(q.y) + floor(q.z);
    let parity = sum - 2.0 * floor(0.5 * sum);
    colors[usize::from(parity >= 1.0)]
}

impl Noise {
    /// Colour at a point.
    pub fn color(&self, p: DVec3) -> Rgb {
        self.ramp(self.value(p))
    }

    /// The pattern's value at a point, 0..=1.
    pub fn value(&self, p: DVec3) -> f64 {
        let q = p * self.scale;
        let sum = match self.pattern {
            Pattern::Spots | Pattern::Clouds => self.octaves.fbm(self.displaced(q)),
            Pattern::Marble | Pattern::Wood if self.distortion == 0.0 => 0.0,
            Pattern::Marble => self.octaves.turbulence(q),
            Pattern::Wood => self.octaves.fbm(q),
        };
        self.pattern.shape(q, sum, self.distortion)
    }

    fn displaced(&self, q: DVec3) -> DVec3 {
        if self.distortion == 0.0 {
            return q;
        }
        let [x, y, z] = ELSEWHERE.map(|shift| perlin(q + shift));
        q + DVec3::new(x, y, z) * self.distortion
    }

    fn ramp(&self, value: f64) -> Rgb {
        let n_steps = self.colors.len() - 1;
        let at = value * n_steps as f64;
        let step = (at as usize).min(n_steps.saturating_sub(1));
        let (a, b) = (self.colors[step], self.colors[(step + 1).min(n_steps)]);
        a + (b - a) * (at - step as f64) as f32
    }

    fn luminance_gradient(&self, p: DVec3) -> Vec3 {
        let h = self.step();
        let at = |d: DVec3| self.exact_luminance(self.value(p + d));
        let slope = |axis: DVec3| (at(axis * h) - at(axis * -h)) / (2.0 * h);
        let gradient = DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z)).as_vec3();
        if gradient.is_finite() { gradient } else { Vec3::ZERO }
    }

    /// A small part of the finest cell, yet far above the rounding of f64.
    fn step(&self) -> f64 {
        let finest = self.octaves.lacunarity.max(1.0).powi(self.octaves.count as i32 - 1);
        1e-3 / (self.scale * finest)
    }

    /// Luminance in f64 of a pattern's value: a difference of rounded colours would be noise.
    fn exact_luminance(&self, value: f64) -> f64 {
        let n_steps = self.colors.len() - 1;
        let at = value * n_steps as f64;
        let step = (at as usize).min(n_steps.saturating_sub(1));
        let a = f64::from(luminance(self.colors[step]));
        let b = f64::from(luminance(self.colors[(step + 1).min(n_steps)]));
        a + (b - a) * (at - step as f64)
    }
}

/// Where the three noises of a displacement are looked up.
const ELSEWHERE: [DVec3; 3] =
    [DVec3::new(31.7, 11.3, 5.9), DVec3::new(7.1, 43.9, 23.3), DVec3::new(53.3, 2.7, 37.1)];

impl Pattern {
    /// The pattern's value from a point, in cells, and its sum of noise.
    #[inline(always)]
    fn shape(self, q: DVec3, sum: f64, distortion: f64) -> f64 {
        let value = match self {
            Self::Spots => smooth_step(0.06, 0.2, sum),
            Self::Marble => 0.5 + 0.5 * elementary::sin_half_turns(q.x + distortion * sum),
            Self::Clouds => 0.5 + sum,
            Self::Wood => {
                let r = (q.x * q.x + q.z * q.z).sqrt() + distortion * sum;
                let f = r - floor(r);
                const LATE: f64 = 0.85;
                let early = (f / LATE) * (f / LATE);
                if f < LATE { early } else { 1.0 - smooth_step(LATE, 1.0, f) }
            }
        };
        if value.is_finite() { value.clamp(0.0, 1.0) } else { 0.0 }
    }
}

#[inline(always)]
fn smooth_step(low: f64, high: f64, x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of every pattern at five points, computed apart from this program by the formulas at
    /// the head of this file.
    #[test]
    fn patterns_have_the_values_of_their_formulas() {
        const POINTS: [DVec3; 5] = [
            DVec3::new(0.31, -0.42, 0.77),
            DVec3::new(1.13, 2.21, -0.58),
            DVec3::new(-0.87, 0.36, 1.49),
            DVec3::new(0.52, 0.93, 0.18),
            DVec3::new(2.4, -1.3, 0.6),
        ];
        let octaves = Octaves { count: 4, lacunarity: 2.1, gain: 0.6 };
        let expected = [
            (Pattern::Spots, [0.0, 0.0, 0.884_557, 0.0, 0.0]),
            (Pattern::Marble, [0.959_037, 0.753_348, 0.924_140, 0.404_760, 0.885_393]),
            (Pattern::Clouds, [0.344_231, 0.554_463, 0.670_366, 0.445_815, 0.422_945]),
            (Pattern::Wood, [0.238_531, 0.229_724, 0.000_181, 0.810_828, 0.037_100]),
        ];
        for (pattern, values) in expected {
            let colors = vec![Rgb::ZERO, Rgb::ONE];
            let noise = Noise { pattern, scale: 1.7, octaves, distortion: 0.8, colors };
            for (point, value) in POINTS.into_iter().zip(values) {
                let found = noise.value(point);
                assert!((found - value).abs() < 1e-6, "{pattern:?} at {point}: {found}");
            }
        }
    }

    /// Without distortion a ring of wood rises by its square up to 0.85, and then falls smoothly, half
    /// of it half way.
    #[test]
    fn a_ring_of_wood_rises_and_falls() {
        let octaves = Octaves { count: 1, lacunarity: 2.0, gain: 0.5 };
        let colors = vec![Rgb::ZERO, Rgb::ONE];
        let noise = Noise { pattern: Pattern::Wood, scale: 2.0, octaves, distortion: 0.0, colors };
        for (fraction, expected) in
            [(0.425, 0.25), (0.85, 1.0), (0.8875, 0.843_75), (0.925, 0.5), (0.9625, 0.156_25)]
        {
            let radius = 0.5 * (3.0 + fraction);
            let found = noise.value(DVec3::new(0.6 * radius, 5.0, -0.8 * radius));
            assert!((found - expected).abs() < 1e-9, "{found}, not {expected} at {fraction}");
        }
    }

    /// Marble without distortion is 1/2 + 1/2 sin(pi s x), and its slope is known.
    #[test]
    fn the_slope_of_marble_is_that_of_its_formula() {
        let octaves = Octaves { count: 3, lacunarity: 2.0, gain: 0.5 };
        let colors = vec![Rgb::splat(0.2), Rgb::splat(0.7)];
        let noise =
            Noise { pattern: Pattern::Marble, scale: 1.3, octaves, distortion: 0.0, colors };
        for x in [-2.3, 0.1, 0.4, 7.7] {
            let at = DVec3::new(x, 0.3, -0.8);
            let found = noise.luminance_gradient(at).as_dvec3();
            let expected = DVec3::X * (0.5 * 0.5 * PI * 1.3 * f64::cos(PI * 1.3 * x));
            assert!((found - expected).length() < 1e-5, "{found}, not {expected} at {x}");
        }
    }

    /// Evenly spaced, linear in between.
    #[test]
    fn a_ramp_goes_through_its_colors() {
        let octaves = Octaves { count: 1, lacunarity: 2.0, gain: 0.5 };
        let colors = vec![Rgb::X, Rgb::Y, 3.0 * Rgb::Z];
        let noise =
            Noise { pattern: Pattern::Clouds, scale: 1.0, octaves, distortion: 0.0, colors };
        for (value, expected) in [
            (0.0, Rgb::X),
            (0.25, Rgb::new(0.5, 0.5, 0.0)),
            (0.5, Rgb::Y),
            (0.9, Rgb::new(0.0, 0.2, 2.4)),
            (1.0, 3.0 * Rgb::Z),
        ] {
            let found = noise.ramp(value);
            assert!((found - expected).length() < 1e-6, "{found} at {value}");
        }
    }

    /// 1e-4 of a cell further along each axis: a point that is less than that below a border counts to
    /// the cell above.
    #[test]
    fn checkers_are_looked_up_a_little_further() {
        let scale = 2.5;
        for (below, expected) in [(0.99e-4, Rgb::ONE), (1.01e-4, Rgb::ZERO)] {
            for axis in DVec3::AXES {
                let middle = DVec3::splat(0.5) - 0.5 * axis;
                let p = (middle + axis * (1.0 - below)) / scale;
                let found = checker(scale, &[Rgb::ZERO, Rgb::ONE], p);
                assert_eq!(found, expected, "{below} below a border along {axis}");
            }
        }
    }
}
