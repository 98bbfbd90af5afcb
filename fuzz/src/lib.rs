//! What must hold for any bytes at all: each check panics where it does not.
//!
//! The fuzz targets feed these with what libFuzzer finds; the tests feed them with the corpus.
//! Nothing here touches the disk.

mod accelerators;
mod mesh;
mod scene_file;
mod scene_render;
mod snapshot;

pub use accelerators::accelerators;
pub use mesh::mesh;
pub use scene_file::scene_file;
pub use scene_render::scene_render;
pub use snapshot::snapshot;

/// A message is one line without control characters, and not endless.
fn check_message(message: &str) {
    assert!(!message.is_empty() && message.len() < 4000, "{} bytes", message.len());
    assert!(!message.contains(char::is_control), "{message:?}");
}
