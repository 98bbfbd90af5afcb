//! Rays against brute force, and what must not depend on how rays are traced.

mod closed;
mod invariance;
mod memory;
mod rays;
mod work;
