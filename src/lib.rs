//! Penumbra: see how a picture is made of light.
//!
//! The crate is a house of floors; a module uses only what is below it, or in its own folder:
//!
//! 0. [`math`], [`color`], [`threads`]: vectors, numbers, and the one way to start a thread.
//! 1. [`geometry`], [`brdf`]: what rays meet, and how surfaces scatter light.
//! 2. [`scene`]: as a person describes it, and as the renderer sees it.
//! 3. [`render`], [`io`], [`tone_mapping`]: films, files, displays.
//! 4. [`session`], [`loader`], [`document`]: the live render, opening files, editing.
//! 5. [`cli`] and, with the feature of that name, `window`.

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
