//! Linear RGB with Rec. 709 primaries, pictures of it, and the way to sRGB and back.

use glam::Vec3;

/// Linear light in three channels: reflectance, radiance or power.
pub type Rgb = Vec3;

/// A linear picture, row 0 at the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// `width * height` linear colours, row by row.
    pub pixels: Vec<[f32; 3]>,
}

/// Relative luminance of linear RGB (Rec. 709).
#[inline]
pub fn luminance(c: Rgb) -> f32 {
    0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z
}

/// sRGB transfer function, the same bits on every machine, IEC 61966-2-1: linear 0..=1 to encoded 0..=1.
pub fn srgb_from_linear(x: f32) -> f32 {
    if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * libm::powf(x, 1.0 / 2.4) - 0.055 }
}

/// Inverse of [`srgb_from_linear`].
pub fn linear_from_srgb(x: f32) -> f32 {
    if x <= 0.040_45 { x / 12.92 } else { libm::powf((x + 0.055) / 1.055, 2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_transfer_function_and_its_inverse_cancel() {
        for i in 0..=1000 {
            let x = i as f32 / 1000.0;
            let back = linear_from_srgb(srgb_from_linear(x));
            assert!((back - x).abs() < 1e-5, "{x} comes back as {back}");
        }
    }
}
