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

    /// Bytes 10, 11, 64, 128 and 200, by the standard's formula in double precision; the luminances of
    /// the primaries add up to that of white.
    #[test]
    fn known_values_of_the_standard() {
        let known = [
            (10.0, 0.003_035_27),
            (11.0, 0.003_346_54),
            (64.0, 0.051_269_46),
            (128.0, 0.215_860_5),
            (200.0, 0.577_580_4),
        ];
        for (byte, expected) in known {
            let found = linear_from_srgb(byte / 255.0);
            assert!((found / expected - 1.0).abs() < 1e-5, "{byte} is {found}, not {expected}");
        }
        let primaries = [Rgb::X, Rgb::Y, Rgb::Z].map(luminance);
        assert_eq!(primaries, [0.2126, 0.7152, 0.0722], "Rec. 709");
    }

    #[test]
    fn the_transfer_function_and_its_inverse_cancel() {
        for i in 0..=1000 {
            let x = i as f32 / 1000.0;
            let back = linear_from_srgb(srgb_from_linear(x));
            assert!((back - x).abs() < 1e-5, "{x} comes back as {back}");
        }
    }
}
