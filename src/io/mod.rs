//! Files: what is read from the disk and what is written to it.

pub mod scene_file;
