//! Pictures of every kind, damaged ones, and headers that promise too much.
//!
//! The JPEG files show red rising by 10 a pixel to the right, green by 10 downwards, blue 100.

use ::png::{BitDepth, ColorType, Encoder};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use super::*;
use crate::color::srgb_from_linear;

const COLOR: &[u8] = include_bytes!("../../../tests/data/color.jpg");
const PROGRESSIVE: &[u8] = include_bytes!("../../../tests/data/progressive.jpg");
const GREY: &[u8] = include_bytes!("../../../tests/data/grey.jpg");
const CMYK: &[u8] = include_bytes!("../../../tests/data/cmyk.jpg");

fn png_file(size: [u32; 2], color: ColorType, depth: BitDepth, samples: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, size[0], size[1]);
    encoder.set_color(color);
    encoder.set_depth(depth);
    if color == ColorType::Indexed {
        encoder.set_palette(vec![255, 0, 0, 0, 0, 255]);
        encoder.set_trns(vec![0, 255]);
    }
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(samples).unwrap();
    writer.finish().unwrap();
    bytes
}

/// sRGB codes of a picture's texels.
fn codes(image: &Image) -> Vec<[u8; 3]> {
    let code = |x: f32| (255.0 * srgb_from_linear(x)).round() as u8;
    image.texels.iter().map(|texel| texel.map(code)).collect()
}

#[test]
fn every_kind_of_png_is_decoded() {
    use BitDepth::{Eight, One, Sixteen, Two};
    let grey = |g: u8| [g; 3];
    let two = [2, 1];
    let cases: [(_, _, &[u8], _); 9] = [
        (ColorType::Rgb, Eight, &[1, 2, 3, 250, 251, 252], [[1, 2, 3], [250, 251, 252]]),
        (ColorType::Rgba, Eight, &[1, 2, 3, 0, 4, 5, 6, 9], [[1, 2, 3], [4, 5, 6]]),
        (ColorType::Grayscale, Eight, &[7, 200], [grey(7), grey(200)]),
        (ColorType::GrayscaleAlpha, Eight, &[7, 0, 200, 1], [grey(7), grey(200)]),
        (ColorType::Grayscale, One, &[0b0100_0000], [grey(0), grey(255)]),
        (ColorType::Grayscale, Two, &[0b0110_0000], [grey(85), grey(170)]),
        (ColorType::Indexed, One, &[0b0100_0000], [[255, 0, 0], [0, 0, 255]]),
        (
            ColorType::Rgb,
            Sixteen,
            &[1, 1, 2, 2, 3, 3, 250, 250, 251, 251, 252, 252],
            [[1, 2, 3], [250, 251, 252]],
        ),
        (ColorType::GrayscaleAlpha, Sixteen, &[7, 7, 0, 0, 9, 9, 0, 0], [grey(7), grey(9)]),
    ];
    for (color, depth, samples, expected) in cases {
        let image = decode(&png_file(two, color, depth, samples)).unwrap();
        assert_eq!((image.width, image.height), (2, 1), "{color:?} {depth:?}");
        assert_eq!(codes(&image), expected, "{color:?} {depth:?}");
    }
}

#[test]
fn sixteen_bits_are_not_cut_to_eight() {
    let samples = [0x80, 0x00, 0x80, 0x40];
    let image = decode(&png_file([2, 1], ColorType::Grayscale, BitDepth::Sixteen, &samples));
    let [a, b] = image.unwrap().texels[..] else { panic!("two texels") };
    assert!(a[0] < b[0], "{} and {}", a[0], b[0]);
}

#[test]
fn the_ends_of_the_scale_are_exact_and_the_first_row_is_the_top() {
    let samples = [255, 255, 255, 0, 0, 0];
    let image = decode(&png_file([1, 2], ColorType::Rgb, BitDepth::Eight, &samples)).unwrap();
    assert_eq!(image.texels, [[1.0; 3], [0.0; 3]]);
}

#[test]
fn every_kind_of_jpeg_is_decoded_near_what_was_saved() {
    for (name, bytes, slack) in [("color", COLOR, 4), ("progressive", PROGRESSIVE, 12)] {
        let image = decode(bytes).unwrap();
        assert_eq!((image.width, image.height), (24, 24), "{name}");
        for (i, code) in codes(&image).into_iter().enumerate() {
            let expected = [10 * (i % 24) as u8, 10 * (i / 24) as u8, 100];
            let differences = [0, 1, 2].map(|c| code[c].abs_diff(expected[c]));
            let worst = differences.into_iter().max().unwrap();
            assert!(worst <= slack, "{name}: {code:?} for {expected:?}");
        }
    }
    let grey = decode(GREY).unwrap();
    assert!(grey.texels.iter().all(|[r, g, b]| r == g && g == b));
    assert!(grey.texels[0][0] < grey.texels[575][0]);
}

/// A decoder that rounds otherwise would change pictures.
#[test]
fn jpegs_decode_to_the_same_codes_everywhere() {
    let sums = [COLOR, PROGRESSIVE, GREY].map(|bytes| {
        let codes = codes(&decode(bytes).unwrap());
        codes
            .as_flattened()
            .iter()
            .fold(0_u32, |sum, c| sum.wrapping_mul(31).wrapping_add(u32::from(*c)))
    });
    assert_eq!(sums, [3_310_820_343, 3_223_021_633, 1_206_442_567]);
}

#[test]
fn colours_for_print_are_refused() {
    let message = decode(CMYK).unwrap_err().to_string();
    assert_eq!(message, "JPEG in YCCK colours, which are not read; save it as RGB");
}

#[test]
fn what_is_no_picture_is_named_by_its_start() {
    let cases: [(&[u8], &str); 3] = [
        (b"", "empty: a PNG or JPEG picture is expected"),
        (b"GIF89a\x01\x00rest", "neither PNG nor JPEG: it starts with `GIF89a\\u{1}\\0`"),
        (b"\x89PN", "neither PNG nor JPEG: it starts with `\\x89PN`"),
    ];
    for (bytes, expected) in cases {
        assert_eq!(decode(bytes).unwrap_err().to_string(), expected);
    }
}

#[test]
fn headers_that_promise_too_much_are_refused_at_once() {
    let mut bytes = png_file([1, 1], ColorType::Rgb, BitDepth::Eight, &[0; 3]);
    for [width, height] in [[60_000_u32, 60_000], [1, 16_385], [16_384, 16_384]] {
        bytes[16..20].copy_from_slice(&width.to_be_bytes());
        bytes[20..24].copy_from_slice(&height.to_be_bytes());
        let checksum = crc(&bytes[12..29]);
        bytes[29..33].copy_from_slice(&checksum.to_be_bytes());
        assert_eq!(decode(&bytes).unwrap_err(), ImageFileError::TooLarge { width, height });
    }
    let mut bytes = COLOR.to_vec();
    let frame = bytes.windows(2).position(|pair| pair == [0xff, 0xc0]).unwrap();
    bytes[frame + 5..frame + 9].copy_from_slice(&[0xea, 0x60, 0xea, 0x60]);
    assert_eq!(
        decode(&bytes).unwrap_err().to_string(),
        "too large: 60000 x 60000 pixels, where at most 16384 a side and 89478485 in all are read"
    );
}

/// The checksum of a PNG chunk, bit by bit.
fn crc(bytes: &[u8]) -> u32 {
    let mut crc = u32::MAX;
    for byte in bytes {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = (crc >> 1) ^ if crc & 1 == 1 { 0xedb8_8320 } else { 0 };
        }
    }
    !crc
}

/// Its second colour has one channel.
#[test]
fn a_palette_that_no_encoder_writes_is_damage() {
    let png = png_file([2, 1], ColorType::Indexed, BitDepth::Eight, &[0, 1]);
    let at = png.windows(4).position(|name| name == b"PLTE").unwrap();
    let palette = b"PLTE\xff\0\0\xff";
    let (length, checksum) = (4_u32.to_be_bytes(), crc(palette).to_be_bytes());
    let rest = &png[at + palette.len() + 2 + checksum.len()..];
    let bytes = [&png[..at - 4], &length, palette, &checksum, rest].concat();
    let message = decode(&bytes).unwrap_err().to_string();
    assert_eq!(message, "damaged or incomplete PNG: the decoder cannot make sense of it");
}

#[test]
fn a_file_cut_short_anywhere_is_an_error() {
    let samples: Vec<u8> = (0..48 * 48).map(|i| (i * i) as u8).collect();
    let png = png_file([48, 48], ColorType::Grayscale, BitDepth::Eight, &samples);
    for bytes in [&png[..], COLOR, PROGRESSIVE, GREY] {
        for n in 0..bytes.len() - 1 {
            assert!(decode(&bytes[..n]).is_err(), "{n} of {} bytes", bytes.len());
        }
    }
    let message = decode(&COLOR[..400]).unwrap_err().to_string();
    assert!(message.starts_with("damaged or incomplete JPEG: "), "{message}");
    let message = decode(&png[..png.len() / 2]).unwrap_err().to_string();
    assert!(message.starts_with("damaged or incomplete PNG: "), "{message}");
}

proptest! {
    #![proptest_config(ProptestConfig {
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn no_damage_makes_it_panic(
        file in 0usize..4,
        edits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let png = png_file([4, 4], ColorType::Rgb, BitDepth::Eight, &[77; 48]);
        let mut bytes = [&png, COLOR, PROGRESSIVE, GREY][file].to_vec();
        for (at, byte) in edits {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        if let Ok(image) = decode(&bytes) {
            prop_assert_eq!(image.texels.len() as u32, image.width * image.height);
        }
    }
}
