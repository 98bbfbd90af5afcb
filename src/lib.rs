//! Penumbra.

pub mod geometry;
pub mod math;
pub mod scene;
