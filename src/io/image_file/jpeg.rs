//! JPEG: baseline and progressive, grey and colour.

use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use super::{ImageFileError, check_size, damaged, linear_by_code, texels_of};
use crate::scene::image::Image;

pub(super) const FORMAT: &str = "JPEG";

pub(super) fn decode(bytes: &[u8]) -> Result<Image, ImageFileError> {
    // Strict: what is missing is an error. The size is checked here, in our words.
    let options = DecoderOptions::default()
        .set_strict_mode(true)
        .set_max_width(usize::from(u16::MAX))
        .set_max_height(usize::from(u16::MAX))
        .jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(|reason| damaged(FORMAT, &reason))?;
    let (Some(info), Some(colors)) = (decoder.info(), decoder.input_colorspace()) else {
        return Err(damaged(FORMAT, &"it has no header"));
    };
    let (width, height) = (u32::from(info.width), u32::from(info.height));
    // Components of every kind that a scan may hold, and what is made of them.
    check_size(width, height, 16)?;
    if !matches!(colors, ColorSpace::Luma | ColorSpace::RGB | ColorSpace::YCbCr) {
        return Err(ImageFileError::UnsupportedColors { colors: format!("{colors:?}") });
    }
    if !has_end(bytes) {
        return Err(damaged(FORMAT, &"it ends before its last marker"));
    }
    let samples = decoder.decode().map_err(|reason| damaged(FORMAT, &reason))?;
    let table = linear_by_code(u16::from(u8::MAX));
    let texels =
        texels_of(&samples, ColorSpace::RGB.num_components(), |code| table[usize::from(code)]);
    Ok(Image { width, height, texels })
}

/// Whether an end marker follows the start of the first scan. The decoder does without the last
/// few bytes of a picture; and one in a preview before the scan proves nothing.
fn has_end(bytes: &[u8]) -> bool {
    const START_OF_SCAN: u8 = 0xda;
    let mut at = 2;
    // Segments: 0xff, their kind, and a length that counts itself.
    while let Some([0xff, kind, high, low]) = bytes.get(at..at + 4) {
        if *kind == START_OF_SCAN {
            break;
        }
        at += if *kind == 0xff { 1 } else { 2 + usize::from(u16::from_be_bytes([*high, *low])) };
    }
    bytes.get(at..).is_some_and(|rest| rest.windows(2).any(|pair| pair == [0xff, 0xd9]))
}
