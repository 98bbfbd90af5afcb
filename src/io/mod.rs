//! Files: what a scene names, read with every limit checked before memory is taken.

pub mod crash;
mod excerpt;
pub mod files;
pub mod folder;
pub mod gallery;
pub mod image_file;
pub mod memory;
pub mod mtl;
pub mod obj;
pub mod output;
pub mod progress;
pub mod scene_file;
pub mod snapshot;

pub use excerpt::{excerpt, printable, printable_ends, printable_path};
