//! A picture used as a texture.

use glam::{DVec2, Vec2, Vec3};

use crate::color::{Rgb, luminance};

/// Linear texels, row 0 at the top.
#[derive(Debug, Default)]
pub struct Image {
    /// Width in texels, at least 1.
    pub width: u32,
    /// Height in texels, at least 1.
    pub height: u32,
    /// `width * height` linear colours, row by row.
    pub texels: Vec<[f32; 3]>,
}

impl Image {
    /// Colour at (u, v), u to the right and v up, repeating, bilinear between texel centres.
    pub fn lookup(&self, uv: DVec2) -> Rgb {
        let (cell, f) = self.cell(uv);
        let row = |dy: i64| {
            let (a, b) = (self.texel(cell[0], cell[1] + dy), self.texel(cell[0] + 1, cell[1] + dy));
            a + (b - a) * f.x
        };
        let (top, bottom) = (row(0), row(1));
        top + (bottom - top) * f.y
    }

    /// Derivatives of the luminance by u and v at (u, v).
    pub fn luminance_gradient(&self, uv: DVec2) -> Vec2 {
        let (cell, f) = self.cell(uv);
        let corner = |dx: i64, dy: i64| luminance(self.texel(cell[0] + dx, cell[1] + dy));
        let (a, b, c, d) = (corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1));
        let across = (b - a) + ((d - c) - (b - a)) * f.y;
        let down = (c - a) + ((d - b) - (c - a)) * f.x;
        Vec2::new(across * self.width as f32, -down * self.height as f32)
    }

    /// The texel up and to the left of (u, v), and the place between it and the next.
    fn cell(&self, uv: DVec2) -> ([i64; 2], Vec2) {
        let wrapped = uv - uv.floor();
        let wrapped = if wrapped.is_finite() { wrapped } else { DVec2::ZERO };
        let size = DVec2::new(f64::from(self.width), f64::from(self.height));
        let at = DVec2::new(wrapped.x, 1.0 - wrapped.y) * size - 0.5;
        let floor = at.floor();
        ([floor.x as i64, floor.y as i64], (at - floor).as_vec2())
    }

    fn texel(&self, x: i64, y: i64) -> Vec3 {
        let x = x.rem_euclid(i64::from(self.width)) as usize;
        let y = y.rem_euclid(i64::from(self.height)) as usize;
        Vec3::from_array(self.texels[y * self.width as usize + x])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_by_two() -> Image {
        let texels = vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 1.0]];
        Image { width: 2, height: 2, texels }
    }

    #[test]
    fn texel_centres_are_exact_and_v_is_up() {
        let image = two_by_two();
        assert_eq!(image.lookup(DVec2::new(0.25, 0.75)), Vec3::X, "upper left");
        assert_eq!(image.lookup(DVec2::new(0.75, 0.25)), Vec3::ONE, "lower right");
        assert_eq!(image.lookup(DVec2::new(-0.75, 5.75)), Vec3::X, "repeats");
    }

    #[test]
    fn the_gradient_is_that_of_the_lookup() {
        let image = two_by_two();
        for uv in [DVec2::new(0.4, 0.6), DVec2::new(0.9, 0.1), DVec2::new(0.1, 0.45)] {
            let at = |d: DVec2| f64::from(luminance(image.lookup(uv + d)));
            let h = 1e-3;
            let numeric = DVec2::new(
                at(DVec2::new(h, 0.0)) - at(DVec2::new(-h, 0.0)),
                at(DVec2::new(0.0, h)) - at(DVec2::new(0.0, -h)),
            ) / (2.0 * h);
            let found = image.luminance_gradient(uv).as_dvec2();
            assert!((found - numeric).length() < 1e-3, "{found} is not {numeric} at {uv}");
        }
    }
}
