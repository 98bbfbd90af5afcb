//! Vectors, rays, numbers: what every other floor stands on.
//!
//! Vectors are glam's. Everything here is pure arithmetic: no scene, no state.

mod aabb;
pub mod approx;
mod batch;
pub mod distribution;
pub mod elementary;
mod frame;
mod nets;
pub mod noise;
pub mod portable;
pub mod sampler;
pub mod sobol;
pub mod spherical_ellipse;
pub mod spherical_rectangle;
mod transform;
pub(crate) mod vectorized;
pub mod warp;

pub use aabb::Aabb;
pub(crate) use batch::RayBlock;
pub use batch::{PrimitiveId, Ray, RayBatch};
pub use frame::Frame;
pub use transform::Transform;
