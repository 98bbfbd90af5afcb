//! PNG: 1 to 16 bits, grey, palette and RGB, interlaced or not.

use std::io::Cursor;

use super::{ImageFileError, check_size, damaged, linear_by_code, texels_of};
use crate::scene::image::Image;

pub(super) const FORMAT: &str = "PNG";

pub(super) fn decode(bytes: &[u8]) -> Result<Image, ImageFileError> {
    let fail = |reason: png::DecodingError| damaged(FORMAT, &reason);
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    let header = decoder.read_header_info().map_err(fail)?;
    let (width, height) = (header.width, header.height);
    // At most four channels of two bytes.
    check_size(width, height, 8)?;
    // Palettes and depths below 8 bits become 8 bits a channel.
    decoder.set_transformations(png::Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(fail)?;
    let (color, depth) = reader.output_color_type();
    let Some(n_bytes) = reader.output_buffer_size() else {
        return Err(ImageFileError::TooLarge { width, height });
    };
    let mut samples = Vec::new();
    samples.try_reserve_exact(n_bytes).map_err(|error| damaged(FORMAT, &error))?;
    samples.resize(n_bytes, 0);
    reader.next_frame(&mut samples).map_err(fail)?;
    // What follows the pixels tells whether the file is complete.
    reader.finish().map_err(fail)?;
    let n_channels = color.samples();
    let texels = if depth == png::BitDepth::Sixteen {
        let table = linear_by_code(u16::MAX);
        let (pairs, _) = samples.as_chunks::<2>();
        texels_of(pairs, n_channels, |pair| table[usize::from(u16::from_be_bytes(pair))])
    } else {
        let table = linear_by_code(u16::from(u8::MAX));
        texels_of(&samples, n_channels, |code| table[usize::from(code)])
    };
    Ok(Image { width, height, texels })
}
