//! Perlin's improved gradient noise, and sums of it over octaves.
//!
//! In f64, as the reference: the patterns built on it are differentiated numerically for bump
//! mapping.
//!
//! Source: K. Perlin, "Improving Noise", SIGGRAPH 2002, with the published permutation.

use glam::DVec3;

use crate::math::elementary::floor;
use crate::math::vectorized::{BLOCK, DLane3, Lane, dvec3, vectorized};

/// Perlin's permutation of 0..=255 (2002).
#[rustfmt::skip]
static PERMUTATION: [u32; 256] = [
    151, 160, 137, 91, 90, 15, 131, 13, 201, 95, 96, 53, 194, 233, 7, 225, 140, 36, 103, 30, 69,
    142, 8, 99, 37, 240, 21, 10, 23, 190, 6, 148, 247, 120, 234, 75, 0, 26, 197, 62, 94, 252, 219,
    203, 117, 35, 11, 32, 57, 177, 33, 88, 237, 149, 56, 87, 174, 20, 125, 136, 171, 168, 68, 175,
    74, 165, 71, 134, 139, 48, 27, 166, 77, 146, 158, 231, 83, 111, 229, 122, 60, 211, 133, 230,
    220, 105, 92, 41, 55, 46, 245, 40, 244, 102, 143, 54, 65, 25, 63, 161, 1, 216, 80, 73, 209, 76,
    132, 187, 208, 89, 18, 169, 200, 196, 135, 130, 116, 188, 159, 86, 164, 100, 109, 198, 173,
    186, 3, 64, 52, 217, 226, 250, 124, 123, 5, 202, 38, 147, 118, 126, 255, 82, 85, 212, 207, 206,
    59, 227, 47, 16, 58, 17, 182, 189, 28, 42, 223, 183, 170, 213, 119, 248, 152, 2, 44, 154, 163,
    70, 221, 153, 101, 155, 167, 43, 172, 9, 129, 22, 39, 253, 19, 98, 108, 110, 79, 113, 224, 232,
    178, 185, 112, 104, 218, 246, 97, 228, 251, 34, 242, 193, 238, 210, 144, 12, 191, 179, 162,
    241, 81, 51, 145, 235, 249, 14, 239, 107, 49, 192, 214, 31, 181, 199, 106, 157, 184, 84, 204,
    176, 115, 121, 50, 45, 127, 4, 150, 254, 138, 236, 205, 93, 222, 114, 67, 29, 24, 72, 243, 141,
    128, 195, 78, 66, 215, 61, 156, 180,
];

/// Gradient noise: 0 at integer points, smooth between them, period 256, within ±1.04.
#[inline(always)]
pub fn perlin(p: DVec3) -> f64 {
    let cell = DVec3::new(floor(p.x), floor(p.y), floor(p.z));
    let f = p - cell;
    let [x, y, z] = [within_period(cell.x), within_period(cell.y), within_period(cell.z)];
    let (u, v, w) = (fade(f.x), fade(f.y), fade(f.z));
    let (a, b) = (hash(x), hash(x + 1));
    let (aa, ab) = (hash(a + y), hash(a + y + 1));
    let (ba, bb) = (hash(b + y), hash(b + y + 1));
    let near = layer([aa, ba, ab, bb], z, f, u, v);
    let far = layer([aa, ba, ab, bb], z + 1, f - DVec3::Z, u, v);
    let noise = lerp(w, near, far);
    if p.is_finite() { noise } else { 0.0 }
}

/// The four corners of a cell at one height.
#[inline(always)]
fn layer([aa, ba, ab, bb]: [u32; 4], z: u32, f: DVec3, u: f64, v: f64) -> f64 {
    let (x, y) = (f.x - 1.0, f.y - 1.0);
    let near = lerp(u, gradient(hash(aa + z), f.x, f.y, f.z), gradient(hash(ba + z), x, f.y, f.z));
    let far = lerp(u, gradient(hash(ab + z), f.x, y, f.z), gradient(hash(bb + z), x, y, f.z));
    lerp(v, near, far)
}

#[inline(always)]
fn hash(i: u32) -> u32 {
    PERMUTATION[(i & 255) as usize]
}

/// An integer modulo 256.
#[inline(always)]
fn within_period(cell: f64) -> u32 {
    const TO_BITS: f64 = 4_503_599_627_370_496.0;
    let rest = cell - 256.0 * floor(cell / 256.0);
    (rest + TO_BITS).to_bits() as u32 & 255
}

vectorized! {
    /// [`perlin`] at every point of a block, all of them shifted.
    pub(crate) fn perlin_block(p: &DLane3, shift: DVec3, values: &mut Lane<f64>) {
        for i in 0..BLOCK {
            values[i] = perlin(dvec3(p, i) + shift);
        }
    }
    /// Adds one octave.
    fn add_octave(
        p: &DLane3,
        shift: DVec3,
        frequency: f64,
        amplitude: f64,
        is_folded: bool,
        totals: &mut Lane<f64>,
    ) {
        for i in 0..BLOCK {
            let noise = perlin(dvec3(p, i) * frequency + shift);
            totals[i] += amplitude * if is_folded { noise.abs() } else { noise };
        }
    }
}

/// How a sum of noise over octaves is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Octaves {
    /// Number of terms, 1..=12.
    pub count: u32,
    /// Frequency ratio of successive terms, above 0.
    pub lacunarity: f64,
    /// Amplitude ratio of successive terms, at least 0.
    pub gain: f64,
}

impl Octaves {
    /// Fractal sum of signed noise, normalised by the sum of the amplitudes: within ±1.04.
    pub fn fbm(&self, p: DVec3) -> f64 {
        self.sum(p, |n| n)
    }

    /// Fractal sum of |noise|, normalised by the sum of the amplitudes: 0..=1.04, with creases.
    pub fn turbulence(&self, p: DVec3) -> f64 {
        self.sum(p, f64::abs)
    }

    /// [`Octaves::fbm`] at a block of points, or [`Octaves::turbulence`].
    pub(crate) fn sum_block(&self, p: &DLane3, is_folded: bool) -> Lane<f64> {
        let (mut totals, mut weight) = ([0.0; BLOCK], 0.0);
        for (shift, frequency, amplitude) in self.terms() {
            add_octave(p, shift, frequency, amplitude, is_folded, &mut totals);
            weight += amplitude;
        }
        totals.map(|total| mean(total, weight))
    }

    fn sum(&self, p: DVec3, shape: impl Fn(f64) -> f64) -> f64 {
        let (mut total, mut weight) = (0.0, 0.0);
        for (shift, frequency, amplitude) in self.terms() {
            total += amplitude * shape(perlin(p * frequency + shift));
            weight += amplitude;
        }
        mean(total, weight)
    }

    /// Shift, frequency and amplitude of every term. Later ones are shifted, so that the zeros that
    /// all of them have at integer points do not fall together.
    fn terms(&self) -> impl Iterator<Item = (DVec3, f64, f64)> {
        const SHIFT: DVec3 = DVec3::new(19.19, 47.43, 73.71);
        let (mut frequency, mut amplitude) = (1.0, 1.0);
        (0..self.count).map(move |octave| {
            let term = (SHIFT * f64::from(octave), frequency, amplitude);
            frequency *= self.lacunarity;
            amplitude *= self.gain;
            term
        })
    }
}

/// A gain so large that it overflows leaves no meaningful sum.
fn mean(total: f64, weight: f64) -> f64 {
    let mean = total / weight;
    if mean.is_finite() { mean } else { 0.0 }
}

#[inline(always)]
fn fade(t: f64) -> f64 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

#[inline(always)]
fn lerp(t: f64, a: f64, b: f64) -> f64 {
    a + t * (b - a)
}

/// Dot product with one of the 12 directions to the edges of a cube (4 of them twice).
#[inline(always)]
fn gradient(hash: u32, x: f64, y: f64, z: f64) -> f64 {
    let h = hash & 15;
    let u = if h < 8 { x } else { y };
    let v = if h == 12 || h == 14 { x } else { z };
    let v = if h < 4 { y } else { v };
    (if h & 1 == 0 { u } else { -u }) + (if h & 2 == 0 { v } else { -v })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of the published Java reference.
    #[test]
    fn perlin_agrees_with_the_reference() {
        let known = [
            (DVec3::new(314.0 / 100.0, 42.0, 7.0), 0.136_919_958_784),
            (DVec3::new(0.5, 0.5, 0.5), -0.25),
            (DVec3::new(1.0, 2.0, 3.0), 0.0),
            (DVec3::new(314.0 / 100.0 + 256.0, 42.0 - 512.0, 7.0 - 256.0), 0.136_919_958_784),
        ];
        for (p, value) in known {
            let found = perlin(p);
            assert!((found - value).abs() < 1e-12, "noise at {p} is {found}, not {value}");
        }
    }

    #[test]
    fn every_hash_is_used_once() {
        let mut seen = [false; 256];
        PERMUTATION.iter().for_each(|p| seen[*p as usize] = true);
        assert_eq!(seen, [true; 256], "a permutation");
    }

    #[test]
    fn noise_is_continuous_across_cells_and_bounded() {
        let mut previous = perlin(DVec3::new(-3.0, 0.3, 0.7));
        let mut largest = 0.0_f64;
        for i in 1..60_000 {
            let x = -3.0 + f64::from(i) * 1e-4;
            let value = perlin(DVec3::new(x, 0.3, 0.7));
            assert!((value - previous).abs() < 1e-3, "jump at {x}: {previous} to {value}");
            previous = value;
            largest = largest.max(perlin(DVec3::new(x * 7.3, x * 3.1, x * 5.7)).abs());
        }
        assert!((0.5..=1.04).contains(&largest), "largest {largest}");
    }

    #[test]
    fn one_octave_is_the_noise_itself_and_sums_stay_normalised() {
        let p = DVec3::new(0.3, 1.7, -2.2);
        let one = Octaves { count: 1, lacunarity: 2.0, gain: 0.5 };
        assert_eq!(one.fbm(p), perlin(p), "fbm of one octave");
        assert_eq!(one.turbulence(p), perlin(p).abs(), "turbulence of one octave");
        let heavy = Octaves { count: 12, lacunarity: 2.0, gain: 1e300 };
        assert!(heavy.fbm(p).abs() <= 1.04, "{}", heavy.fbm(p));
    }

    /// Octaves have nothing to do with each other, so their variances add up: of amplitudes 1, g, g², …
    /// normalised by their sum. Each has as many cells as lacunarity says: a sum of one term at a time,
    /// taken out by a gain without end, is the noise at that frequency.
    #[test]
    fn gain_and_lacunarity_are_ratios_of_amplitude_and_frequency() {
        let points = || {
            (0..40_000_i32).map(|i| {
                DVec3::new(f64::from(i) * 0.754_877, f64::from(i) * 0.569_840, f64::from(i) * 0.381)
            })
        };
        let moments = |octaves: Octaves| {
            let [sum, squares] = points().fold([0.0, 0.0], |[sum, squares], p| {
                let value = octaves.fbm(p);
                [sum + value, squares + value * value]
            });
            [sum, squares].map(|x| x / 40_000.0)
        };
        let [_, one] = moments(Octaves { count: 1, lacunarity: 2.0, gain: 0.5 });
        assert!((one / 0.0730 - 1.0).abs() < 0.02, "variance of the noise itself: {one}");
        for (count, gain) in [(2_u32, 0.5_f64), (2, 1.0), (4, 0.5), (4, 0.8)] {
            let [mean, variance] = moments(Octaves { count, lacunarity: 2.1, gain });
            let amplitudes = (0..count).map(|k| gain.powi(k as i32));
            let squares: f64 = amplitudes.clone().map(|a| a * a).sum();
            let expected = one * squares / amplitudes.sum::<f64>().powi(2);
            assert!((variance / expected - 1.0).abs() < 0.03, "{variance}, not {expected}");
            assert!(mean.abs() < 0.01, "mean {mean} of {count} by {gain}");
        }
        // All of the weight in the last term.
        let last = Octaves { count: 3, lacunarity: 1.7, gain: 1e12 };
        let shift = 2.0 * DVec3::new(19.19, 47.43, 73.71);
        for p in points().take(50) {
            let (found, expected) = (last.fbm(p), perlin(p * (1.7 * 1.7) + shift));
            assert!((found - expected).abs() < 1e-9, "{found}, not {expected} at {p}");
        }
    }
}
