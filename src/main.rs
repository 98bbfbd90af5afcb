//! Penumbra.
fn main() {}
