//! Shapes, and what a ray meets of them.

pub mod mesh;
