//! Penumbra: see how a picture is made of light.

pub mod color;
pub mod geometry;
pub mod io;
pub mod math;
pub mod scene;
