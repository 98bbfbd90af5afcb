//! What a key means that a file leaves out, where that is not zero.

use super::{ColorOrTexture, OneOrThree, OneOrTwo, Triple};

pub(super) fn yes() -> bool {
    true
}
pub(super) fn one() -> f64 {
    1.0
}
pub(super) fn two() -> f64 {
    2.0
}
pub(super) fn half() -> f64 {
    0.5
}
pub(super) fn six() -> u32 {
    6
}
pub(super) fn default_fov() -> f64 {
    40.0
}
pub(super) fn default_alpha() -> f64 {
    0.15
}
pub(super) fn default_ior() -> f64 {
    1.5
}
pub(super) fn straight_angle() -> f64 {
    180.0
}
pub(super) fn x_axis() -> Triple {
    [1.0, 0.0, 0.0]
}
pub(super) fn y_axis() -> Triple {
    [0.0, 1.0, 0.0]
}
pub(super) fn black() -> ColorOrTexture {
    ColorOrTexture::Color([0.0; 3])
}
pub(super) fn point_size() -> OneOrTwo {
    OneOrTwo::One(0.0)
}
pub(super) fn unit_scale() -> OneOrThree {
    OneOrThree::One(1.0)
}
