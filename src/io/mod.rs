//! Files: what a scene names, read with every limit checked before memory is taken.

mod excerpt;
pub mod obj;
pub mod scene_file;

pub use excerpt::excerpt;
