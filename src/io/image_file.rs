//! Pictures that scenes name: PNG and JPEG, told apart by their first bytes.
//!
//! Colours are taken as sRGB and decoded to linear light; alpha is ignored, and so are colour
//! profiles. The decoders have no SIMD paths of their own choosing, and the transfer function is
//! computed by a portable `pow`: the same file gives the same texels on every machine. Truncated
//! and damaged files are errors, never grey areas.

mod jpeg;
mod png;

use crate::color::linear_from_srgb;
use crate::io::memory::NoMemory;
use crate::io::{crash, excerpt, memory, printable_ends};
use crate::scene::image::Image;

/// Pixels that a picture may have along each side.
pub const MAX_SIDE: u32 = 16_384;

/// Pixels that a picture may have in all: decoded, they take 1 GiB.
pub const MAX_TEXELS: u64 = (1 << 30) / size_of::<[f32; 3]>() as u64;

/// Why a file is not a picture.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ImageFileError {
    /// Neither of the two formats.
    #[error("neither PNG nor JPEG: it starts with `{start}`")]
    UnknownFormat {
        /// The first bytes, escaped.
        start: String,
    },

    /// The file is empty.
    #[error("empty: a PNG or JPEG picture is expected")]
    Empty,

    /// The header promises more pixels than are read.
    #[error(
        "too large: {width} x {height} pixels, where at most {MAX_SIDE} a side and {MAX_TEXELS} in \
         all are read"
    )]
    TooLarge {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
    },

    /// The machine cannot hold its pixels.
    #[error("{width} x {height} pixels: decoding it {error}")]
    NoMemory {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
        /// How much is needed, and how much there is.
        error: NoMemory,
    },

    /// A JPEG with other colours than grey, RGB or YCbCr.
    #[error("JPEG in {colors} colours, which are not read; save it as RGB")]
    UnsupportedColors {
        /// What the file has, as the decoder calls it.
        colors: String,
    },

    /// Truncated or damaged.
    #[error("damaged or incomplete {format}: {reason}")]
    Damaged {
        /// `PNG` or `JPEG`.
        format: &'static str,
        /// What the decoder says, escaped.
        reason: String,
    },
}

/// Decodes a PNG or JPEG file to linear light.
pub fn decode(bytes: &[u8]) -> Result<Image, ImageFileError> {
    if bytes.is_empty() {
        return Err(ImageFileError::Empty);
    }
    if bytes.starts_with(b"\x89PNG\r\n\x1a\n") {
        return contained(png::FORMAT, || png::decode(bytes));
    }
    if bytes.starts_with(b"\xff\xd8\xff") {
        return contained(jpeg::FORMAT, || jpeg::decode(bytes));
    }
    let start = excerpt(&bytes[..bytes.len().min(8)]);
    Err(ImageFileError::UnknownFormat { start })
}

/// Both decoders panic on what no encoder writes: odd palettes, odd sampling factors.
fn contained(
    format: &'static str,
    decode: impl FnOnce() -> Result<Image, ImageFileError>,
) -> Result<Image, ImageFileError> {
    let decoded = crash::contain(decode);
    decoded.unwrap_or_else(|| Err(damaged(format, &"the decoder cannot make sense of it")))
}

/// Refuses a header whose pixels would take more than the documented memory, or more than there
/// is; a decoded pixel of the file has so many bytes.
fn check_size(width: u32, height: u32, pixel_bytes: usize) -> Result<(), ImageFileError> {
    let n_texels = u64::from(width) * u64::from(height);
    if MAX_SIDE < width.max(height) || MAX_TEXELS < n_texels {
        return Err(ImageFileError::TooLarge { width, height });
    }
    memory::check(n_texels * (pixel_bytes + size_of::<[f32; 3]>()) as u64)
        .map_err(|error| ImageFileError::NoMemory { width, height, error })
}

/// Linear light of each sRGB code from 0 to `max_code`.
fn linear_by_code(max_code: u16) -> Vec<f32> {
    (0..=max_code).map(|code| linear_from_srgb(f32::from(code) / f32::from(max_code))).collect()
}

/// Texels of rows of interleaved samples: one or two channels are grey, three or four RGB, and
/// the last of two or four is alpha.
fn texels_of<T: Copy>(
    samples: &[T],
    n_channels: usize,
    linear: impl Fn(T) -> f32,
) -> Vec<[f32; 3]> {
    let color = |texel: &[T]| match texel {
        [r, g, b, ..] => [linear(*r), linear(*g), linear(*b)],
        [grey, ..] => [linear(*grey); 3],
        [] => [0.0; 3],
    };
    samples.chunks_exact(n_channels).map(color).collect()
}

/// A damaged file, with the decoder's words made safe to print.
fn damaged(format: &'static str, reason: &impl ToString) -> ImageFileError {
    let reason = reason.to_string();
    // One of the decoders quotes some of its words.
    let reason = printable_ends(reason.trim().trim_matches('"'));
    ImageFileError::Damaged { format, reason }
}

#[cfg(test)]
mod tests;
