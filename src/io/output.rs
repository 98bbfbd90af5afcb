//! Pictures to disk: whole or not at all.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use image::{ExtendedColorType, ImageEncoder};

use crate::render::Picture;
use crate::scene::description::ToneMappingDescription;
use crate::tone_mapping::map_to_srgb8;

/// The format of a picture file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutputFormat {
    /// 8-bit sRGB, tone-mapped, with its scene inside.
    Png,
    /// Linear 32-bit float RGB.
    Exr,
    /// Linear RGB with a shared exponent (Radiance).
    Hdr,
}

impl OutputFormat {
    /// The format that a file's ending asks for.
    pub fn of(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        match ending.as_str() {
            "png" => Some(Self::Png),
            "exr" => Some(Self::Exr),
            "hdr" => Some(Self::Hdr),
            _ => None,
        }
    }
}

/// Why a file could not be written.
#[derive(Debug, thiserror::Error)]
#[error("{}: cannot be written: {reason}", .path.display())]
pub struct WriteError {
    path: PathBuf,
    reason: String,
}

impl WriteError {
    fn new(path: &Path, reason: impl ToString) -> Self {
        Self { path: path.to_owned(), reason: reason.to_string() }
    }

    /// Whether a file of that name was there already.
    pub fn is_name_clash(&self) -> bool {
        self.path.exists()
    }
}

/// Text that a PNG carries: keyword and UTF-8 text.
pub type TextChunk = (&'static str, String);

/// The bytes of a PNG: 8-bit sRGB with text chunks.
///
/// # Errors
/// When encoding fails.
pub fn encode_png(
    picture: &Picture,
    tone_mapping: &ToneMappingDescription,
    texts: &[TextChunk],
) -> Result<Vec<u8>, png::EncodingError> {
    let rgb = srgb_bytes(picture, tone_mapping);
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, picture.width, picture.height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    for (keyword, text) in texts {
        encoder.add_itxt_chunk((*keyword).to_owned(), text.clone())?;
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&rgb)?;
    writer.finish()?;
    Ok(bytes)
}

/// The tone-mapped bytes of a picture, row by row, three a pixel.
pub fn srgb_bytes(picture: &Picture, tone_mapping: &ToneMappingDescription) -> Vec<u8> {
    let mut out = vec![[0_u8; 3]; picture.pixels.len()];
    let exposure = tone_mapping.exposure as f32;
    map_to_srgb8(&picture.pixels, exposure, tone_mapping.operator, &mut out);
    out.into_flattened()
}

/// The bytes of an OpenEXR or Radiance file: linear, tone mapping left out.
///
/// # Errors
/// When encoding fails.
pub fn encode_linear(
    picture: &Picture,
    format: OutputFormat,
) -> Result<Vec<u8>, image::ImageError> {
    let (width, height) = (picture.width, picture.height);
    let mut bytes = io::Cursor::new(Vec::new());
    if format == OutputFormat::Hdr {
        let pixels: Vec<image::Rgb<f32>> = picture.pixels.iter().map(|p| image::Rgb(*p)).collect();
        image::codecs::hdr::HdrEncoder::new(&mut bytes).encode(
            &pixels,
            width as usize,
            height as usize,
        )?;
    } else {
        let floats = picture.pixels.as_flattened();
        let raw: Vec<u8> = floats.iter().flat_map(|x| x.to_ne_bytes()).collect();
        image::codecs::openexr::OpenExrEncoder::new(&mut bytes).write_image(
            &raw,
            width,
            height,
            ExtendedColorType::Rgb32F,
        )?;
    }
    Ok(bytes.into_inner())
}

/// Encodes a picture in a format. `texts` go into PNG only.
///
/// # Errors
/// When encoding fails; `path` is named.
pub fn encode(
    path: &Path,
    format: OutputFormat,
    picture: &Picture,
    tone_mapping: &ToneMappingDescription,
    texts: &[TextChunk],
) -> Result<Vec<u8>, WriteError> {
    match format {
        OutputFormat::Png => {
            encode_png(picture, tone_mapping, texts).map_err(|error| WriteError::new(path, error))
        }
        OutputFormat::Exr | OutputFormat::Hdr => {
            encode_linear(picture, format).map_err(|error| WriteError::new(path, error))
        }
    }
}

/// Replaces a file by these bytes: temporary file beside it, synced, renamed. Until then the old
/// file is as it was.
///
/// # Errors
/// When the folder is not there or not writable, or the disk is full.
pub fn replace_file(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    write_temporary(path, bytes)?
        .persist(path)
        .map_err(|error| WriteError::new(path, error.error))?;
    sync_folder(path);
    Ok(())
}

/// Creates a file with these bytes; fails where one of that name is there.
///
/// # Errors
/// As [`replace_file`], and when the name is taken: see [`WriteError::is_name_clash`].
pub fn create_file(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    write_temporary(path, bytes)?
        .persist_noclobber(path)
        .map_err(|error| WriteError::new(path, error.error))?;
    sync_folder(path);
    Ok(())
}

fn write_temporary(path: &Path, bytes: &[u8]) -> Result<tempfile::NamedTempFile, WriteError> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let mut builder = tempfile::Builder::new();
    builder.prefix(".penumbra-");
    #[cfg(unix)]
    {
        // As any program would create it; the process's umask takes its share.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let file = builder
        .tempfile_in(folder.unwrap_or(Path::new(".")))
        .map_err(|error| WriteError::new(path, error))?;
    let mut writer = BufWriter::new(file);
    let written = writer.write_all(bytes).and_then(|()| writer.flush());
    written.map_err(|error| WriteError::new(path, error))?;
    let file = writer.into_inner().map_err(|error| WriteError::new(path, error.error().kind()))?;
    file.as_file().sync_all().map_err(|error| WriteError::new(path, error))?;
    Ok(file)
}

/// Makes the new name last through a power cut, where the system can; the file itself is whole
/// either way.
fn sync_folder(path: &Path) {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    if let Ok(folder) = File::open(folder.unwrap_or(Path::new("."))) {
        drop(folder.sync_all());
    }
}
