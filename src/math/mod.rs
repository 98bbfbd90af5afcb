//! Vectors, rays, numbers: what every other floor stands on.

mod aabb;

pub use aabb::Aabb;
