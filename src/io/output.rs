//! Pictures to disk: whole or not at all.

use std::ffi::OsStr;
use std::fs::{DirEntry, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use image::{ExtendedColorType, ImageEncoder};
use serde::{Deserialize, Serialize};

use crate::color::Picture;
use crate::io::memory::Limited;
use crate::io::printable_path;

/// Begins the names of files that are being written; then come [`N_RANDOM`] letters and digits.
const TEMPORARY: &str = ".penumbra-";
const N_RANDOM: usize = 6;
/// A file of such a name that nobody holds and that has not changed for so long was left behind by a
/// program that was killed.
const LEFT_BEHIND: Duration = Duration::from_secs(60 * 60);

/// The format of a picture file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum OutputFormat {
    /// 8-bit sRGB, tone-mapped, with its scene inside.
    Png,
    /// Linear 32-bit float RGB.
    Exr,
    /// Linear RGB with a shared exponent (Radiance).
    Hdr,
}

impl OutputFormat {
    /// The ending of its files, without the dot.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Exr => "exr",
            Self::Hdr => "hdr",
        }
    }

    /// The format that a file's ending asks for.
    pub fn of(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        [Self::Png, Self::Exr, Self::Hdr].into_iter().find(|format| format.ending() == ending)
    }
}

/// Why a file could not be written.
#[derive(Debug, thiserror::Error)]
#[error("{}: cannot be written: {reason}", printable_path(.path))]
pub struct WriteError {
    path: PathBuf,
    reason: String,
}

impl WriteError {
    /// `path` is where it should have gone.
    pub fn new(path: &Path, reason: impl ToString) -> Self {
        Self { path: path.to_owned(), reason: reason.to_string() }
    }

    /// Whether a file of that name was there already.
    pub fn is_name_clash(&self) -> bool {
        self.path.exists()
    }
}

/// Text that a PNG carries: keyword and UTF-8 text.
pub type TextChunk = (&'static str, String);

/// The bytes of a PNG with text chunks; `srgb` is what the display shows, three bytes a pixel.
///
/// # Errors
/// When encoding fails.
pub fn encode_png(
    (width, height): (u32, u32),
    srgb: &[u8],
    texts: &[TextChunk],
) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    for (keyword, text) in texts {
        encoder.add_itxt_chunk((*keyword).to_owned(), text.clone())?;
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(srgb)?;
    writer.finish()?;
    Ok(bytes)
}

/// The bytes of an OpenEXR file: linear, 32-bit float.
///
/// # Errors
/// When encoding fails.
pub fn encode_exr(picture: &Picture) -> Result<Vec<u8>, image::ImageError> {
    let mut bytes = io::Cursor::new(Vec::new());
    let floats = picture.pixels.as_flattened();
    let raw: Vec<u8> = floats.iter().flat_map(|x| x.to_ne_bytes()).collect();
    image::codecs::openexr::OpenExrEncoder::new(&mut bytes).write_image(
        &raw,
        picture.width,
        picture.height,
        ExtendedColorType::Rgb32F,
    )?;
    Ok(bytes.into_inner())
}

/// The bytes of a Radiance file: linear, 8 bits a channel and a shared exponent, to the nearest.
///
/// # Errors
/// When encoding fails.
pub fn encode_hdr(picture: &Picture) -> Result<Vec<u8>, image::ImageError> {
    let mut bytes = Vec::new();
    let nearest = |pixel: &[f32; 3]| image::Rgb(nearest_rgbe(*pixel));
    let pixels: Vec<image::Rgb<f32>> = picture.pixels.iter().map(nearest).collect();
    let (width, height) = (picture.width as usize, picture.height as usize);
    image::codecs::hdr::HdrEncoder::new(&mut bytes).encode(&pixels, width, height)?;
    Ok(bytes)
}

/// The nearest colour that a Radiance file can hold. The encoder takes the exponent from a logarithm
/// and cuts off what eight bits do not hold; of these colours it cuts nothing off, whatever the
/// logarithm's last bit, and none is so dark that its exponent wraps round to the largest.
fn nearest_rgbe(pixel: [f32; 3]) -> [f32; 3] {
    /// 255 x 2^119: the brightest that there is.
    const BRIGHTEST: f32 = 1.694_765_7e38;
    let [r, g, b] = pixel.map(|x| if x > 0.0 { x.min(BRIGHTEST) } else { 0.0 });
    let largest = r.max(g).max(b);
    if largest < f32::MIN_POSITIVE {
        return [0.0; 3];
    }
    // One step of the largest channel, which takes 128 to 255 of them.
    let exponent = (largest.to_bits() >> 23) as i32 - 127 - 7;
    let step = f64::from_bits(((exponent + 1023) as u64) << 52);
    let step = if f64::from(largest) < 255.5 * step { step } else { 2.0 * step };
    [r, g, b].map(|x| ((f64::from(x) / step).round() * step) as f32)
}

/// Replaces a file by these bytes: temporary file beside it, synced, renamed. Until then the old
/// file is as it was. Where the name is a link, the file behind it is replaced.
///
/// # Errors
/// When the folder is not there or not writable, or the disk is full.
pub fn replace_file(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    let place = behind_links(path);
    write_temporary(&place, bytes)?
        .persist(&place)
        .map_err(|error| WriteError::new(path, error.error))?;
    sync_folder(&place);
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

/// Keeps what could not be written where it should be: in the system's folder for temporary files,
/// under a name that nobody has. `None` where that is no place either.
pub fn keep_elsewhere(path: &Path, bytes: &[u8]) -> Option<PathBuf> {
    let name = format!("penumbra-{}-{}", std::process::id(), path.file_name()?.to_string_lossy());
    let place = std::env::temp_dir().join(name);
    create_file(&place, bytes).ok()?;
    Some(place)
}

/// Finds out whether a file could be written there, by making a temporary one beside it.
///
/// # Errors
/// When the name is a folder's, or its folder is not there or not writable.
pub fn check_writable(path: &Path) -> Result<(), WriteError> {
    let is_folder = path.is_dir() || path.as_os_str().as_encoded_bytes().ends_with(b"/");
    if is_folder {
        return Err(WriteError::new(path, "this is the name of a folder"));
    }
    let place = behind_links(path);
    if place.exists() && !place.is_file() {
        return Err(WriteError::new(path, "this is the name of a pipe or a device"));
    }
    let folder = folder_of(&place);
    if !folder.exists() {
        let reason = format!("there is no folder {}; make it first", printable_path(folder));
        return Err(WriteError::new(path, reason));
    }
    let file = write_temporary(&place, &[])?;
    file.close().map_err(|error| WriteError::new(path, error))
}

fn write_temporary(path: &Path, bytes: &[u8]) -> Result<tempfile::NamedTempFile, WriteError> {
    let needed = bytes.len() as u64;
    if let Some(most) = Limited::now().file
        && most < needed
    {
        let reason = format!("takes {needed} bytes, and a file may have {most} here (ulimit -f)");
        return Err(WriteError::new(path, reason));
    }
    remove_left_behind(folder_of(path));
    let mut builder = tempfile::Builder::new();
    builder.prefix(TEMPORARY).rand_bytes(N_RANDOM);
    #[cfg(unix)]
    {
        // As any program would create it; the process's umask takes its share.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let file = builder
        .tempfile_in(folder_of(path))
        .map_err(|error| WriteError::new(path, plain(&error)))?;
    // Where files cannot be locked, their age protects them from being taken for left behind.
    let _ = file.as_file().try_lock();
    let mut writer = BufWriter::new(file);
    let written = writer.write_all(bytes).and_then(|()| writer.flush());
    written.map_err(|error| WriteError::new(path, plain(&error)))?;
    let file = writer.into_inner().map_err(|error| WriteError::new(path, error.error().kind()))?;
    // Who may read what was there may read what comes.
    if let Ok(old) = std::fs::metadata(path) {
        let _ = file.as_file().set_permissions(old.permissions());
    }
    file.as_file().sync_all().map_err(|error| WriteError::new(path, error))?;
    Ok(file)
}

/// Removes what killed programs left in a folder. Nothing depends on it.
fn remove_left_behind(folder: &Path) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        if is_temporary(&entry.file_name()) && is_left_behind(&entry).unwrap_or(false) {
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

fn is_temporary(name: &OsStr) -> bool {
    let random = name.to_str().and_then(|name| name.strip_prefix(TEMPORARY));
    random.is_some_and(|text| {
        text.len() == N_RANDOM && text.chars().all(|c| c.is_ascii_alphanumeric())
    })
}

/// Whether a file is old, and whoever wrote it is gone.
fn is_left_behind(entry: &DirEntry) -> io::Result<bool> {
    let metadata = entry.metadata()?;
    let is_old = metadata.modified()?.elapsed().is_ok_and(|age| LEFT_BEHIND <= age);
    Ok(metadata.is_file() && is_old && File::open(entry.path())?.try_lock().is_ok())
}

/// What the system said, without the name of the temporary file: nobody knows that one.
fn plain(error: &io::Error) -> String {
    let text = error.to_string();
    text.split_once(" at path ").map_or_else(|| text.clone(), |(reason, _)| reason.to_owned())
}

/// The file that a link stands for, also where that is not there yet; the path itself where it is no
/// link, or leads round in a circle.
fn behind_links(path: &Path) -> PathBuf {
    /// As many as Linux follows.
    const MOST: usize = 40;
    let mut place = path.to_owned();
    for _ in 0..MOST {
        let Ok(target) = std::fs::read_link(&place) else { return place };
        place = folder_of(&place).join(target);
    }
    path.to_owned()
}

/// The folder that a file is in, or is to be in.
fn folder_of(path: &Path) -> &Path {
    let parent = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    parent.unwrap_or(Path::new("."))
}

/// Makes the new name last through a power cut, where the system can; the file itself is whole
/// either way.
fn sync_folder(path: &Path) {
    if let Ok(folder) = File::open(folder_of(path)) {
        drop(folder.sync_all());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::SystemTime;

    /// Within half a step of the largest channel, from the darkest that a float can be to the brightest.
    #[test]
    fn a_radiance_file_holds_the_nearest_colors() {
        let mut pixels = vec![[0.0; 3], [1.0; 3], [0.9999, 0.2, 0.3], [1023.9999, 1.0, -1.0]];
        let mut largest = f32::from_bits(2);
        while largest < 1e38 {
            pixels.push([largest, 0.3 * largest, 0.7 * largest]);
            largest *= 1.37;
        }
        let picture = Picture { width: pixels.len() as u32, height: 1, pixels };
        let bytes = encode_hdr(&picture).unwrap();
        let decoded = image::load_from_memory(&bytes).unwrap().into_rgb32f();
        for (exact, found) in picture.pixels.iter().zip(decoded.pixels()) {
            let largest = exact.iter().copied().fold(255.0 * f32::MIN_POSITIVE, f32::max);
            for (x, y) in exact.iter().zip(found.0) {
                let error = (f64::from(x.max(0.0)) - f64::from(y)).abs();
                assert!(error <= f64::from(largest) / 255.0, "{x} of {exact:?} is {y}");
            }
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_and_the_file_behind_it_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        std::fs::create_dir(path("elsewhere")).unwrap();
        std::fs::write(path("elsewhere/a.toml"), "old").unwrap();
        std::os::unix::fs::symlink("elsewhere/a.toml", path("a.toml")).unwrap();
        check_writable(&path("a.toml")).unwrap();
        replace_file(&path("a.toml"), b"new").unwrap();
        assert!(path("a.toml").is_symlink(), "the link is gone");
        assert_eq!(std::fs::read(path("elsewhere/a.toml")).unwrap(), b"new", "the file behind it");
        create_file(&path("a.toml"), b"newer").unwrap_err();
        std::os::unix::fs::symlink("a.toml", path("b.toml")).unwrap();
        std::fs::remove_file(path("elsewhere/a.toml")).unwrap();
        replace_file(&path("b.toml"), b"anew").unwrap();
        assert!(path("b.toml").is_symlink() && path("a.toml").is_symlink(), "a link is gone");
        assert_eq!(std::fs::read(path("elsewhere/a.toml")).unwrap(), b"anew", "two links on");
        std::os::unix::fs::symlink("c.toml", path("c.toml")).unwrap();
        replace_file(&path("c.toml"), b"round").unwrap();
        assert_eq!(std::fs::read(path("c.toml")).unwrap(), b"round", "a link to itself gives way");
    }

    #[cfg(unix)]
    #[test]
    fn who_may_read_a_file_may_read_what_replaces_it_and_pipes_stay() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.toml");
        replace_file(&path, b"old").unwrap();
        for mode in [0o600, 0o664] {
            std::fs::set_permissions(&path, std::fs::Permissions::from_mode(mode)).unwrap();
            replace_file(&path, b"new").unwrap();
            let found = std::fs::metadata(&path).unwrap().permissions().mode() & 0o777;
            assert_eq!(found, mode, "{found:o}");
        }
        let pipe = folder.path().join("p.png");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let error = check_writable(&pipe).unwrap_err().to_string();
        assert!(error.contains("a pipe or a device"), "{error}");
    }

    #[test]
    fn what_a_killed_program_left_is_removed_by_the_next_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let file = |name: &str, age: Duration| {
            let file = File::create(path(name)).unwrap();
            file.set_modified(SystemTime::now().checked_sub(age).unwrap()).unwrap();
            file
        };
        let old = 2 * LEFT_BEHIND;
        file(".penumbra-Ab3xYz", old);
        file(".penumbra-youngx", LEFT_BEHIND / 2);
        file(".penumbra-notes.txt", old);
        file("penumbra-Ab3xYz", old);
        let held = file(".penumbra-livesx", old);
        held.try_lock().unwrap();
        std::fs::create_dir(path(".penumbra-folder")).unwrap();
        replace_file(&path("a.png"), b"new").unwrap();
        let mut names: Vec<_> = std::fs::read_dir(folder.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        let kept = [".penumbra-folder", ".penumbra-livesx", ".penumbra-notes.txt"];
        let kept = [&kept[..], &[".penumbra-youngx", "a.png", "penumbra-Ab3xYz"]].concat();
        assert_eq!(names, kept, "one file is left behind, and the rest is others'");
        assert_eq!(std::fs::read(path("a.png")).unwrap(), b"new", "what was written");
    }
}
