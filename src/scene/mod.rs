//! The scene.

pub mod description;
