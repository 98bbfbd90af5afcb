//! Rays against brute force, and what must not depend on how rays are traced.

mod invariance;
mod rays;
