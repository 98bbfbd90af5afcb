//! A picture that carries the scene that made it.
//!
//! Two text chunks of a PNG: `penumbra:scene`, the scene file with its size and samples as
//! rendered and its paths as written; and `penumbra:render`, JSON with the program's version, the
//! samples, the seed, the files used with size and hash, and, where made in the window, the folder
//! that the scene was opened from.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::io::folder::{FileRecord, Folder};
use crate::io::output::TextChunk;
use crate::io::printable_ends;
use crate::io::scene_file;
use crate::scene::description::SceneDescription;

const SCENE: &str = "penumbra:scene";
const RENDER: &str = "penumbra:render";
/// Text chunks are read up to this many bytes.
const LARGEST_TEXT: usize = 64 << 20;

/// What a snapshot says of how it was made.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RenderRecord {
    /// Of the program.
    pub version: String,
    /// Samples a pixel.
    pub samples: u32,
    /// Seed of all numbers.
    pub seed: u32,
    /// What the scene used.
    pub files: Vec<FileRecord>,
    /// The folder that the scene was opened from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub folder: Option<RecordedFolder>,
}

/// A folder in a snapshot.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RecordedFolder {
    /// Inside the program.
    Gallery,
    /// On disk.
    Path(PathBuf),
}

/// A snapshot that was read.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// The scene file's text.
    pub scene: String,
    /// How it was made.
    pub record: RenderRecord,
    /// Where its files are looked for.
    pub folder: Folder,
}

/// Why a PNG is no snapshot.
#[derive(Debug, thiserror::Error)]
pub enum SnapshotError {
    /// No PNG at all.
    #[error("is not a readable PNG: {}", printable_ends(&.0.to_string()))]
    Png(#[from] png::DecodingError),
    /// A PNG without a scene.
    #[error("carries no scene; only pictures saved by penumbra do")]
    NoScene,
    /// The picture is not of the size that its scene says.
    #[error("the picture is {found_width} x {found_height}, its scene {width} x {height}")]
    OtherSize {
        /// Width in pixels.
        found_width: u32,
        /// Height in pixels.
        found_height: u32,
        /// What it should be.
        width: u32,
        /// What it should be.
        height: u32,
    },
    /// The record is damaged.
    #[error("carries a damaged record: {}", printable_ends(.0))]
    Record(String),
}

/// The text chunks of a picture of this description at `samples` samples; `folder` is given by the
/// window only.
///
/// # Errors
/// Never in practice: when the record cannot be written as JSON.
pub fn texts(
    description: &SceneDescription,
    (width, height): (u32, u32),
    samples: u32,
    files: &[FileRecord],
    folder: Option<&Folder>,
) -> Result<Vec<TextChunk>, serde_json::Error> {
    let mut description = description.clone();
    description.render.width = width;
    description.render.height = height;
    description.render.samples = samples;
    let folder = folder.map(|folder| match folder.home() {
        Folder::Disk(path) => RecordedFolder::Path(std::path::absolute(&path).unwrap_or(path)),
        Folder::Gallery | Folder::Snapshot { .. } => RecordedFolder::Gallery,
    });
    let record = RenderRecord {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        samples,
        seed: description.render.seed,
        files: files.to_vec(),
        folder,
    };
    Ok(vec![(SCENE, scene_file::write(&description)), (RENDER, serde_json::to_string(&record)?)])
}

/// Reads the scene out of a PNG's bytes; `path` is where it lies.
///
/// # Errors
/// When it is no PNG, or carries no scene.
pub fn read(bytes: &[u8], path: &Path) -> Result<Snapshot, SnapshotError> {
    let limits = png::Limits { bytes: LARGEST_TEXT };
    let mut decoder = png::Decoder::new_with_limits(std::io::Cursor::new(bytes), limits);
    decoder.set_transformations(png::Transformations::IDENTITY);
    let reader = decoder.read_info()?;
    let text = |keyword: &str| {
        let chunk = reader.info().utf8_text.iter().find(|chunk| chunk.keyword == keyword);
        let mut chunk = chunk?.clone();
        // Another program may have compressed it; a small chunk can hold a very large text.
        chunk.decompress_text_with_limit(LARGEST_TEXT).ok()?;
        chunk.get_text().ok()
    };
    let scene = text(SCENE).ok_or(SnapshotError::NoScene)?;
    let record = text(RENDER).ok_or(SnapshotError::NoScene)?;
    let record: RenderRecord =
        serde_json::from_str(&record).map_err(|error| SnapshotError::Record(error.to_string()))?;
    let beside = match Folder::of(path) {
        Folder::Disk(folder) => folder,
        Folder::Gallery | Folder::Snapshot { .. } => PathBuf::from("."),
    };
    let recorded = record.folder.as_ref().map(|folder| {
        Box::new(match folder {
            RecordedFolder::Gallery => Folder::Gallery,
            RecordedFolder::Path(path) => Folder::Disk(path.clone()),
        })
    });
    let folder = Folder::Snapshot { recorded, beside, files: record.files.clone() };
    Ok(Snapshot { scene, record, folder })
}

/// The 8-bit RGB bytes of a PNG, which has to be of this size.
///
/// # Errors
/// When it is no such PNG, or damaged.
pub fn read_pixels(bytes: &[u8], (width, height): (u32, u32)) -> Result<Vec<u8>, SnapshotError> {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info()?;
    let info = reader.info();
    if (info.width, info.height) != (width, height) {
        let (found_width, found_height) = (info.width, info.height);
        return Err(SnapshotError::OtherSize { found_width, found_height, width, height });
    }
    let is_rgb8 = info.color_type == png::ColorType::Rgb && info.bit_depth == png::BitDepth::Eight;
    if !is_rgb8 {
        return Err(SnapshotError::Record("the picture is not 8-bit RGB".to_owned()));
    }
    let size = reader.output_buffer_size().unwrap_or(0);
    let mut pixels = Vec::new();
    pixels
        .try_reserve_exact(size)
        .map_err(|_| SnapshotError::Record("the picture does not fit into memory".to_owned()))?;
    pixels.resize(size, 0);
    reader.next_frame(&mut pixels)?;
    // What follows the pixels tells whether the file is whole.
    reader.finish()?;
    Ok(pixels)
}
