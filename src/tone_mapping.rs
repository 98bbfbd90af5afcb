//! From linear light to the 8-bit sRGB picture that a display shows.
//!
//! Exposure, then one of four operators, then the sRGB transfer function, rounded to nearest, no
//! dither. Negative light is black. This is display, not rendering: nothing here changes a film.

use std::sync::OnceLock;

use crate::color::{Picture, linear_from_srgb};
use crate::math::vectorized::{BLOCK, NO_LANES, vectorized};
use crate::math::{approx, portable};
use crate::scene::description::{ToneMappingDescription, ToneOperator};

/// A picture as a display shows it: sRGB bytes, row by row, three a pixel.
pub fn srgb_bytes(picture: &Picture, tone_mapping: &ToneMappingDescription) -> Vec<u8> {
    let mut out = vec![[0_u8; 3]; picture.pixels.len()];
    let exposure_ev = tone_mapping.exposure as f32;
    map_to_srgb8(&picture.pixels, exposure_ev, tone_mapping.operator, &mut out);
    out.into_flattened()
}

/// Maps linear pixels to sRGB bytes. `exposure_ev` is in stops; `out` has the length of `pixels`.
pub fn map_to_srgb8(
    pixels: &[[f32; 3]],
    exposure_ev: f32,
    operator: ToneOperator,
    out: &mut [[u8; 3]],
) {
    let gain = portable::exp2(exposure_ev);
    let encoder = Encoder::get();
    match operator {
        ToneOperator::Linear => map_linear(pixels, gain, encoder, out),
        ToneOperator::Reinhard => map_reinhard(pixels, gain, encoder, out),
        ToneOperator::Aces => map_aces(pixels, gain, encoder, out),
        ToneOperator::Agx => map_agx(pixels, gain, encoder, out),
    }
}

/// An operator on one exposed colour.
trait Curve {
    fn map(c: [f32; 3]) -> [f32; 3];
}

struct Clip;
struct Reinhard;
struct Aces;
struct Agx;

impl Curve for Clip {
    #[inline(always)]
    fn map(c: [f32; 3]) -> [f32; 3] {
        c
    }
}

impl Curve for Reinhard {
    #[inline(always)]
    fn map(c: [f32; 3]) -> [f32; 3] {
        [c[0] / (1.0 + c[0]), c[1] / (1.0 + c[1]), c[2] / (1.0 + c[2])]
    }
}

impl Curve for Aces {
    #[inline(always)]
    fn map(c: [f32; 3]) -> [f32; 3] {
        aces(c)
    }
}

impl Curve for Agx {
    #[inline(always)]
    fn map(c: [f32; 3]) -> [f32; 3] {
        agx(c)
    }
}

#[inline(always)]
fn each<C: Curve>(pixels: &[[f32; 3]], gain: f32, encoder: &Encoder, out: &mut [[u8; 3]]) {
    for (pixels, out) in pixels.chunks(BLOCK).zip(out.chunks_mut(BLOCK)) {
        let mut lanes = NO_LANES;
        for (i, pixel) in pixels.iter().enumerate() {
            [lanes[0][i], lanes[1][i], lanes[2][i]] = *pixel;
        }
        for i in 0..BLOCK {
            let light = |channel: usize| finite_light(lanes[channel][i] * gain);
            let [r, g, b] = C::map([light(0), light(1), light(2)]);
            [lanes[0][i], lanes[1][i], lanes[2][i]] = [r, g, b];
        }
        let mut bytes = [[0; BLOCK]; 3];
        for (bytes, lane) in bytes.iter_mut().zip(&lanes) {
            for i in 0..BLOCK {
                bytes[i] = encoder.encode(lane[i]);
            }
        }
        for (i, out) in out.iter_mut().enumerate() {
            *out = [bytes[0][i] as u8, bytes[1][i] as u8, bytes[2][i] as u8];
        }
    }
}

vectorized! {
    fn map_linear(pixels: &[[f32; 3]], gain: f32, encoder: &Encoder, out: &mut [[u8; 3]]) {
        each::<Clip>(pixels, gain, encoder, out);
    }
    fn map_reinhard(pixels: &[[f32; 3]], gain: f32, encoder: &Encoder, out: &mut [[u8; 3]]) {
        each::<Reinhard>(pixels, gain, encoder, out);
    }
    fn map_aces(pixels: &[[f32; 3]], gain: f32, encoder: &Encoder, out: &mut [[u8; 3]]) {
        each::<Aces>(pixels, gain, encoder, out);
    }
    fn map_agx(pixels: &[[f32; 3]], gain: f32, encoder: &Encoder, out: &mut [[u8; 3]]) {
        each::<Agx>(pixels, gain, encoder, out);
    }
}

/// Black for what is negative or no number, a large number for what is infinite.
#[inline(always)]
fn finite_light(x: f32) -> f32 {
    if x > 0.0 { if x < 1e30 { x } else { 1e30 } } else { 0.0 }
}

/// Fit of the ACES reference rendering transform and output transform for sRGB displays.
///
/// Source: S. Hill, "ACES fitted", in the BakingLab of M. Pettineo, 2016.
#[inline(always)]
fn aces(c: [f32; 3]) -> [f32; 3] {
    const INPUT: Matrix =
        [[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]];
    const OUTPUT: Matrix = [
        [1.60475, -0.53108, -0.07367],
        [-0.10208, 1.10813, -0.00605],
        [-0.00327, -0.07276, 1.07602],
    ];
    let curve = |v: f32| {
        let v = v.min(1e15);
        let a = v * (v + 0.024_578_6) - 0.000_090_537;
        let b = v * (0.983_729 * v + 0.432_951) + 0.238_081;
        a / b
    };
    multiply(&OUTPUT, multiply(&INPUT, c).map(curve))
}

/// AgX base look: Rec. 2020 primaries, an inset that makes bright colours lose saturation, a
/// sigmoid over 16.5 stops of log light, and the way back; the display encoding (2.2) is undone.
///
/// Sources: T. Sobotka, "AgX", 2022, as adapted by E. Chow for Blender 4.0; sigmoid fitted by
/// B. Wrensch, "Minimal AgX Implementation", 2023; constants of the Rec. 2020 version in Filament.
#[inline(always)]
fn agx(c: [f32; 3]) -> [f32; 3] {
    const REC2020_FROM_REC709: Matrix =
        [[0.6274, 0.3293, 0.0433], [0.0691, 0.9195, 0.0113], [0.0164, 0.0880, 0.8956]];
    const REC709_FROM_REC2020: Matrix =
        [[1.6605, -0.5876, -0.0728], [-0.1246, 1.1329, -0.0083], [-0.0182, -0.1006, 1.1187]];
    const INSET: Matrix = [
        [0.856_627_15, 0.095_121_24, 0.048_251_606],
        [0.137_318_97, 0.761_242, 0.101_439_04],
        [0.111_898_21, 0.076_799_42, 0.811_302_37],
    ];
    const OUTSET: Matrix = [
        [1.127_100_6, -0.110_606_64, -0.016_493_939],
        [-0.141_329_76, 1.157_823_7, -0.016_493_939],
        [-0.141_329_76, -0.110_606_64, 1.251_936_4],
    ];
    const MIN_EV: f32 = -12.473_93;
    const MAX_EV: f32 = 4.026_069;
    let inset = multiply(&INSET, multiply(&REC2020_FROM_REC709, c));
    let curved = inset.map(|x| {
        let log = approx::log2(x.max(1e-10));
        sigmoid(((log - MIN_EV) / (MAX_EV - MIN_EV)).clamp(0.0, 1.0))
    });
    let display = multiply(&OUTSET, curved).map(|x| approx::pow(x.max(0.0), 2.2));
    multiply(&REC709_FROM_REC2020, display)
}

#[inline(always)]
fn sigmoid(x: f32) -> f32 {
    let (x2, x4) = (x * x, x * x * x * x);
    15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x
        - 0.00232
}

/// Rows of a 3 x 3 matrix.
type Matrix = [[f32; 3]; 3];

#[inline(always)]
fn multiply(m: &Matrix, c: [f32; 3]) -> [f32; 3] {
    m.map(|row| row[0] * c[0] + row[1] * c[1] + row[2] * c[2])
}

/// The sRGB transfer function rounded to 8 bits, by the exact linear values at which the byte
/// changes.
struct Encoder {
    /// `thresholds[k]` is the least linear value that becomes byte k + 1 or more.
    thresholds: [f32; 256],
    /// A byte at most 1 too low for linear values in each 1/4096, in which there is at most one
    /// threshold.
    starts: [u32; 4096],
}

impl Encoder {
    fn get() -> &'static Self {
        static ENCODER: OnceLock<Encoder> = OnceLock::new();
        ENCODER.get_or_init(Self::new)
    }

    fn new() -> Self {
        let mut thresholds = [f32::INFINITY; 256];
        for (byte, threshold) in thresholds.iter_mut().take(255).enumerate() {
            *threshold = linear_from_srgb((byte as f32 + 0.5) / 255.0);
        }
        let mut starts = [0; 4096];
        for (cell, start) in starts.iter_mut().enumerate() {
            let linear = cell as f32 / 4096.0;
            *start = thresholds.iter().take_while(|t| **t <= linear).count() as u32;
        }
        Self { thresholds, starts }
    }

    #[inline(always)]
    fn encode(&self, linear: f32) -> u32 {
        let linear = if linear > 0.0 { linear } else { 0.0 };
        const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;
        let linear = if linear < BELOW_ONE { linear } else { BELOW_ONE };
        let byte = self.starts[((linear * 4096.0) as i32 as u32 & 4095) as usize];
        byte + u32::from(self.thresholds[(byte & 255) as usize] <= linear)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::srgb_from_linear;
    use crate::math::vectorized::at_every_level;

    fn mapped(c: [f32; 3], operator: ToneOperator) -> [u8; 3] {
        let mut out = [[0; 3]];
        map_to_srgb8(&[c], 0.0, operator, &mut out);
        out[0]
    }

    #[test]
    fn bytes_are_the_rounded_transfer_function() {
        let encoder = Encoder::get();
        for i in 0..=100_000 {
            let x = i as f32 / 100_000.0;
            let exact = 255.0 * srgb_from_linear(x);
            let byte = encoder.encode(x) as f32;
            assert!((byte - exact).abs() <= 0.5 + 1e-3, "{x} is {byte}, not {exact}");
        }
    }

    #[test]
    fn operators_know_black_and_white() {
        for operator in
            [ToneOperator::Linear, ToneOperator::Reinhard, ToneOperator::Aces, ToneOperator::Agx]
        {
            assert_eq!(mapped([0.0; 3], operator), [0; 3], "{operator:?} of black");
            assert_eq!(mapped([-1.0, f32::NAN, 0.0], operator), [0; 3], "{operator:?} of no light");
            let white = mapped([f32::INFINITY; 3], operator);
            assert!(white.iter().all(|c| *c >= 250), "{operator:?} of the brightest is {white:?}");
        }
        assert_eq!(mapped([1.0, 0.5, 3.0], ToneOperator::Linear), [255, 188, 255], "linear");
        assert_eq!(mapped([1.0; 3], ToneOperator::Reinhard), [188; 3], "reinhard halves 1");
    }

    #[test]
    fn every_operator_rises_and_keeps_grey_grey() {
        for operator in
            [ToneOperator::Linear, ToneOperator::Reinhard, ToneOperator::Aces, ToneOperator::Agx]
        {
            let mut previous = 0;
            for i in 0..400 {
                let x = 1e-4 * 1.03_f32.powi(i);
                let [r, g, b] = mapped([x; 3], operator);
                assert!(r >= previous, "{operator:?} falls at {x}");
                assert!(r.abs_diff(g) <= 1 && g.abs_diff(b) <= 1, "{operator:?} tints {x}");
                previous = r;
            }
        }
    }

    /// Encoded values of seven colours, computed in double precision from the published matrices and
    /// curves.
    #[test]
    fn operators_give_the_values_of_their_sources() {
        const COLORS: [[f32; 3]; 7] = [
            [0.18, 0.18, 0.18],
            [0.8, 0.2, 0.05],
            [0.02, 0.3, 1.5],
            [4.0, 6.0, 1.0],
            [0.002, 0.004, 0.003],
            [0.1, 1.2, 0.6],
            [9.0, 0.5, 3.0],
        ];
        let expected = [
            (ToneOperator::Linear, LINEAR),
            (ToneOperator::Reinhard, REINHARD),
            (ToneOperator::Aces, ACES),
            (ToneOperator::Agx, AGX),
        ];
        for (operator, values) in expected {
            for (color, value) in COLORS.iter().zip(values) {
                let found = mapped(*color, operator);
                let is_near = |(a, b): (&u8, &f32)| (f32::from(*a) - b).abs() <= 0.55;
                let are_near = found.iter().zip(&value).all(is_near);
                assert!(are_near, "{operator:?} of {color:?}: {found:?}, not {value:?}");
            }
        }
    }

    const LINEAR: [[f32; 3]; 7] = [
        [117.65, 117.65, 117.65],
        [231.11, 123.55, 63.19],
        [38.68, 148.88, 255.00],
        [255.00, 255.00, 255.00],
        [6.59, 12.93, 9.88],
        [89.04, 255.00, 203.42],
        [255.00, 187.52, 255.00],
    ];
    const REINHARD: [[f32; 3]; 7] = [
        [108.87, 108.87, 108.87],
        [177.86, 113.49, 61.64],
        [38.25, 132.01, 203.42],
        [231.11, 238.26, 187.52],
        [6.58, 12.89, 9.85],
        [85.03, 194.96, 164.75],
        [243.45, 156.19, 224.61],
    ];
    const ACES: [[f32; 3]; 7] = [
        [91.41, 91.41, 91.41],
        [198.45, 103.68, 45.16],
        [39.69, 128.51, 222.71],
        [246.13, 248.75, 226.28],
        [0.00, 0.30, 0.00],
        [133.22, 215.03, 181.57],
        [255.00, 209.86, 240.90],
    ];
    const AGX: [[f32; 3]; 7] = [
        [127.64, 127.63, 127.63],
        [201.08, 137.39, 98.30],
        [108.73, 167.70, 226.48],
        [240.42, 243.77, 219.03],
        [0.96, 3.44, 2.17],
        [154.80, 208.10, 183.63],
        [255.00, 216.58, 234.88],
    ];

    #[test]
    fn bytes_are_the_same_on_every_processor() {
        let light = |i: usize| 1e-5 * 1.1_f32.powi(i as i32) - 1e-4;
        let pixels: Vec<[f32; 3]> = (0..157).map(|i| [light(i), light(157 - i), 0.5]).collect();
        for operator in
            [ToneOperator::Linear, ToneOperator::Reinhard, ToneOperator::Aces, ToneOperator::Agx]
        {
            let mapped = at_every_level(|| {
                let mut out = vec![[0; 3]; pixels.len()];
                map_to_srgb8(&pixels, 0.3, operator, &mut out);
                out
            });
            for (level, bytes) in &mapped {
                assert_eq!(*bytes, mapped[0].1, "{operator:?}, {level:?}");
            }
        }
    }

    #[test]
    fn a_stop_of_exposure_doubles() {
        let mut out = [[0; 3]];
        map_to_srgb8(&[[0.25; 3]], 1.0, ToneOperator::Linear, &mut out);
        assert_eq!(out[0], mapped([0.5; 3], ToneOperator::Linear), "0.25 at +1 EV");
        map_to_srgb8(&[[0.25; 3]], -3.0, ToneOperator::Linear, &mut out);
        assert_eq!(out[0], mapped([0.031_25; 3], ToneOperator::Linear), "0.25 at -3 EV");
    }
}
