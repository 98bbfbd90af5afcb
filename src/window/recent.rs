//! Small pictures of the files opened before, for the start page: one a file, in the program's own
//! folder, gone when the file leaves the list. Nobody is told where one cannot be kept or read: the
//! page then shows the kind of file in its place.

use super::app::App;
use super::files::Written;
use crate::color::Picture;
use crate::io::files::read_file;
use crate::io::output::{OutputFormat, WriteError, replace_file};
use crate::io::snapshot::read_pixels;
use crate::loader::Source;
use crate::scene::description::ToneMappingDescription;
use crate::session::Frame;
use crate::session::develop::encode;
use egui::ColorImage;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Size in pixels of a kept picture.
pub(super) const SIZE: (u32, u32) = (160, 90);
/// Longest file that is read, in bytes: more than so many pixels can take.
const LARGEST_FILE: u64 = 1 << 17;
/// A picture is kept again once it has so many times the samples.
const BETTER: u32 = 4;

/// Where the pictures are, and what this window has kept.
#[derive(Debug)]
pub(super) struct RecentPictures {
    /// `None` where there is no such place.
    folder: Option<PathBuf>,
    /// The file whose picture was kept last, and its samples.
    kept: Option<(PathBuf, u32)>,
    /// Whether one is being written: the next waits, so that the newest stays.
    is_writing: bool,
}

impl RecentPictures {
    /// Those below the program's own folder.
    pub(super) fn new(own_folder: Option<&Path>) -> Self {
        Self { folder: own_folder.map(|own| own.join("recent")), kept: None, is_writing: false }
    }

    /// Where the picture of each of these files would be.
    pub(super) fn places(&self, recent: &[PathBuf]) -> Vec<PathBuf> {
        let folder = self.folder.iter();
        folder.flat_map(|folder| recent.iter().map(|of| place(folder, of))).collect()
    }

    /// The open file holds another scene now: its next picture is kept whatever its samples.
    pub(super) fn forget(&mut self) {
        self.kept = None;
    }

    /// What was being written is there, or cannot be.
    pub(super) fn note_written(&mut self) {
        self.is_writing = false;
    }

    /// Whether the picture with so many samples is the last that was kept.
    #[cfg(test)]
    pub(super) fn is_kept_at(&self, samples: u32) -> bool {
        !self.is_writing && self.kept.as_ref().is_some_and(|(_, kept)| *kept == samples)
    }

    /// Whether a picture of that file with so many samples tells more than what is kept.
    fn is_news(&self, of: &Path, samples: u32, goal: u32) -> bool {
        match &self.kept {
            Some((kept, before)) if kept == of => {
                let is_last = goal <= samples && *before < samples;
                is_last || before.saturating_mul(BETTER) <= samples
            }
            _ => true,
        }
    }
}

impl App {
    /// Keeps a small picture of the open file as it is: the first one, and better ones as samples
    /// come.
    pub(super) fn keep_recent_picture(&mut self, ctx: &egui::Context, frame: &Arc<Frame>) {
        let (Some(folder), Some(Source::File(path))) =
            (&self.recent_pictures.folder, &self.files.source)
        else {
            return;
        };
        let goal = self.document.description.render.samples;
        let is_ready = frame.scale == 1 && 0 < frame.samples && !self.recent_pictures.is_writing;
        let is_news = is_ready && self.recent_pictures.is_news(path, frame.samples, goal);
        let is_listed = self.interface.recent.contains(path);
        if !is_news || !is_listed || self.document.is_dirty() || !self.work.is_current(frame) {
            return;
        }
        let (folder, path) = (folder.clone(), path.clone());
        self.recent_pictures.kept = Some((path.clone(), frame.samples));
        self.recent_pictures.is_writing = true;
        let (frame, recent) = (Arc::clone(frame), self.interface.recent.clone());
        let tone = self.document.description.tone_mapping.clone();
        self.files.write(ctx, move || {
            // The page does without.
            let _ = keep(&folder, &path, &frame.picture, &tone);
            remove_others(&folder, &recent);
            Written::RecentPicture
        });
    }
}

/// Reads a kept picture; `None` where there is none, or none of ours.
pub(super) fn read(place: &Path) -> Option<ColorImage> {
    let bytes = read_file(place, LARGEST_FILE).ok()?;
    let pixels = read_pixels(&bytes, SIZE).ok()?;
    Some(ColorImage::from_rgb([SIZE.0 as usize, SIZE.1 as usize], &pixels))
}

/// Named by a hash of the file's path.
fn place(folder: &Path, of: &Path) -> PathBuf {
    let hash = Sha256::digest(of.as_os_str().as_encoded_bytes());
    let name: String = hash.iter().take(16).map(|byte| format!("{byte:02x}")).collect();
    folder.join(name + ".png")
}

fn keep(
    folder: &Path,
    of: &Path,
    picture: &Picture,
    tone: &ToneMappingDescription,
) -> Result<(), WriteError> {
    let path = place(folder, of);
    let bytes = encode(&path, OutputFormat::Png, &small(picture), tone, &[])?;
    std::fs::create_dir_all(folder).map_err(|error| WriteError::new(folder, error))?;
    replace_file(&path, &bytes)
}

/// Removes the pictures of files that are not in the list.
fn remove_others(folder: &Path, recent: &[PathBuf]) {
    let wanted: Vec<PathBuf> = recent.iter().map(|of| place(folder, of)).collect();
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for path in entries.flatten().map(|entry| entry.path()) {
        let is_ours = path.extension().is_some_and(|ending| ending == "png");
        if is_ours && !wanted.contains(&path) {
            // What stays is tried again with the next picture.
            let _ = std::fs::remove_file(path);
        }
    }
}

/// The middle of a picture in the shape of [`SIZE`], each pixel the mean of those that it covers.
fn small(picture: &Picture) -> Picture {
    let (width, height) = (picture.width as usize, picture.height as usize);
    let (columns, rows) = (SIZE.0 as usize, SIZE.1 as usize);
    let cut_width = width.min((height * columns).div_ceil(rows)).max(1);
    let cut_height = height.min((width * rows).div_ceil(columns)).max(1);
    let (left, top) = ((width - cut_width) / 2, (height - cut_height) / 2);
    let covered = |index: usize, n: usize, cut: usize| {
        let begin = index * cut / n;
        begin..((index + 1) * cut).div_ceil(n).max(begin + 1)
    };
    let mean = |x: usize, y: usize| {
        let across = covered(x, columns, cut_width);
        let mut sum = [0.0_f32; 3];
        let mut n_summed = 0;
        for row in covered(y, rows, cut_height) {
            let begin = (top + row) * width + left;
            for pixel in &picture.pixels[begin + across.start..begin + across.end] {
                if pixel.iter().all(|value| value.is_finite()) {
                    for (sum, value) in sum.iter_mut().zip(pixel) {
                        *sum += value;
                    }
                    n_summed += 1;
                }
            }
        }
        sum.map(|sum| sum / n_summed.max(1) as f32)
    };
    let places = (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y)));
    let pixels = places.map(|(x, y)| mean(x, y)).collect();
    Picture { width: SIZE.0, height: SIZE.1, pixels }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Red grows to the right and green downwards, both 0..1.
    fn ramp(width: u32, height: u32) -> Picture {
        let pixel = |x: u32, y: u32| {
            [(x as f32 + 0.5) / width as f32, (y as f32 + 0.5) / height as f32, 0.25]
        };
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        Picture { width, height, pixels: places.map(|(x, y)| pixel(x, y)).collect() }
    }

    #[test]
    fn a_small_picture_is_the_middle_of_the_large_one_in_its_own_shape() {
        for (width, height, left, top) in [
            (1280, 720, 0.0, 0.0),
            (48, 27, 0.0, 0.0),
            (900, 900, 0.0, 0.21875),
            (3200, 900, 0.25, 0.0),
        ] {
            let small = small(&ramp(width, height));
            assert_eq!((small.width, small.height), SIZE, "from {width} x {height}");
            assert_eq!(small.pixels.len(), 160 * 90, "from {width} x {height}");
            for (pixel, expected) in [
                (small.pixels[0], [left, top]),
                (small.pixels[160 * 90 - 1], [1.0 - left, 1.0 - top]),
            ] {
                for axis in [0, 1] {
                    let away = (pixel[axis] - expected[axis]).abs();
                    assert!(away < 0.02, "{pixel:?}, not {expected:?}, of {width} x {height}");
                }
            }
        }
    }

    #[test]
    fn a_pixel_that_is_no_number_does_not_spoil_its_neighbours() {
        let mut picture = ramp(320, 180);
        picture.pixels[0] = [f32::NAN; 3];
        picture.pixels[1] = [f32::INFINITY; 3];
        let small = small(&picture);
        assert!(small.pixels[0].iter().all(|value| (0.0..1.0).contains(value)), "{small:?}");
        assert_eq!(
            super::small(&Picture { width: 1, height: 1, pixels: vec![[f32::NAN; 3]] }).pixels[0],
            [0.0; 3]
        );
    }

    #[test]
    fn the_first_picture_is_news_then_better_ones_and_the_last() {
        let mut pictures = RecentPictures::new(None);
        let (a, b) = (Path::new("a"), Path::new("b"));
        assert!(pictures.is_news(a, 1, 40), "the first");
        pictures.kept = Some((a.to_owned(), 10));
        assert!(!pictures.is_news(a, 39, 64), "hardly better");
        assert!(pictures.is_news(a, 40, 64), "four times the samples");
        assert!(pictures.is_news(a, 12, 12), "the last");
        assert!(!pictures.is_news(a, 10, 10), "the same again");
        assert!(pictures.is_news(b, 1, 64), "another file");
        pictures.forget();
        assert!(pictures.is_news(a, 1, 64), "another scene in the same file");
    }

    #[test]
    fn pictures_are_kept_for_the_files_of_the_list_and_no_others() {
        let own = tempfile::tempdir().unwrap();
        let pictures = RecentPictures::new(Some(own.path()));
        let folder = own.path().join("recent");
        let list: Vec<PathBuf> = ["a", "b", "c"].map(PathBuf::from).to_vec();
        let tone = ToneMappingDescription::default();
        for of in &list {
            keep(&folder, of, &ramp(320, 180), &tone).unwrap();
        }
        let places = pictures.places(&list);
        assert!(places.iter().all(|place| read(place).is_some()), "{places:?}");
        std::fs::write(folder.join("notes.txt"), "not ours").unwrap();
        remove_others(&folder, &list[1..]);
        let left: Vec<bool> = places.iter().map(|place| place.exists()).collect();
        assert_eq!(left, [false, true, true], "others were removed");
        assert!(folder.join("notes.txt").exists(), "what is no picture was removed");
    }
}
