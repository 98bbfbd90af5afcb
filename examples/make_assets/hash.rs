//! Fixed hashes in place of random numbers, and gradient noise made of them.

/// A well-mixed 32-bit number for a 32-bit number: the output step of O'Neill's PCG
/// (M. Jarzynski and M. Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020).
pub(crate) fn hash(n: u32) -> u32 {
    let state = n.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

/// A number in 0..1 for a number.
pub(crate) fn unit(n: u32) -> f64 {
    f64::from(hash(n)) / 4_294_967_296.0
}

/// Gradient noise in the plane, about -0.7..0.7, smooth to the second derivative.
pub(crate) fn noise(x: f64, y: f64) -> f64 {
    let (cell_x, cell_y) = (x.floor(), y.floor());
    let (fx, fy) = (x - cell_x, y - cell_y);
    let slope = |dx: i32, dy: i32| {
        let cell = hash((cell_x as i32 + dx) as u32).wrapping_add((cell_y as i32 + dy) as u32);
        let (gx, gy) = (2.0 * unit(cell) - 1.0, 2.0 * unit(cell ^ 0x5bd1_e995) - 1.0);
        gx * (fx - f64::from(dx)) + gy * (fy - f64::from(dy))
    };
    let (u, v) = (fade(fx), fade(fy));
    lerp(v, lerp(u, slope(0, 0), slope(1, 0)), lerp(u, slope(0, 1), slope(1, 1)))
}

/// From 0 below `low` to 1 above `high`, smoothly.
pub(crate) fn smooth_step(low: f64, high: f64, x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

fn fade(t: f64) -> f64 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

fn lerp(t: f64, a: f64, b: f64) -> f64 {
    a + t * (b - a)
}
