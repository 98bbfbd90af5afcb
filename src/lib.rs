//! Penumbra: see how a picture is made of light.

pub mod color;
pub mod math;
pub mod threads;

pub mod brdf;
pub mod geometry;

pub mod scene;

pub mod io;
pub mod render;
pub mod tone_mapping;

pub mod document;
pub mod loader;
pub mod session;

pub mod cli;
#[cfg(feature = "window")]
pub mod window;
