//! Elementary functions that return the same bits on every machine.
//!
//! The platform's libm differs between systems and versions; a picture must not. These are thin
//! names over the pure Rust `libm` crate. Angles are radians. Square roots, absolute values and
//! rounding are exact in hardware and need no entry here.

macro_rules! portable {
    ($($(#[$doc:meta])* $name:ident($($arg:ident),+) -> $ty:ty = $target:path;)+) => {
        $($(#[$doc])* #[inline] pub fn $name($($arg: $ty),+) -> $ty { $target($($arg),+) })+
    };
}

portable! {
    /// Sine.
    sin(x) -> f32 = libm::sinf;
    /// Cosine.
    cos(x) -> f32 = libm::cosf;
    /// 2 to the x.
    exp2(x) -> f32 = libm::exp2f;
    /// Sine.
    sin_f64(x) -> f64 = libm::sin;
    /// Cosine.
    cos_f64(x) -> f64 = libm::cos;
    /// Tangent.
    tan_f64(x) -> f64 = libm::tan;
    /// Arc cosine, 0..=π.
    acos_f64(x) -> f64 = libm::acos;
    /// Arc sine, -π/2..=π/2.
    asin_f64(x) -> f64 = libm::asin;
    /// Angle of the point (x, y), -π..=π.
    atan2_f64(y, x) -> f64 = libm::atan2;
    /// e to the x.
    exp_f64(x) -> f64 = libm::exp;
    /// x to the y.
    pow_f64(x, y) -> f64 = libm::pow;
}

/// Sine and cosine at once.
#[inline]
pub fn sin_cos(x: f32) -> (f32, f32) {
    libm::sincosf(x)
}
