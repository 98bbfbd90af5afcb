//! How surfaces scatter light, as pure functions of two directions.
//!
//! Directions are unit vectors in the shading frame: `z` is the normal, `x` the tangent. Both `wo`
//! (towards the viewer) and `wi` (towards the light) point away from the surface.

pub mod fresnel;
pub mod glossy;
pub mod ward;

pub use glossy::Glossy;
pub use ward::{Ward, WardForm};
