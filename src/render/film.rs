//! Where samples are summed: linear, whole passes only.

use rayon::prelude::*;

use crate::color::Picture;
use crate::render::adaptive::{Allotment, is_told_anew};
use crate::render::course::Course;
use crate::render::features::PixelMap;
use crate::render::integrator::Part;
use crate::render::job::RenderSettings;
use crate::render::noise::{ErrorModel, Noise};
use crate::render::pixel::PixelSums;
use crate::render::plan::Tile;

/// Sums of all samples of every pixel, row 0 at the top.
#[derive(Clone, Debug)]
pub struct Film {
    width: u32,
    height: u32,
    n_samples: u32,
    /// Row by row. Room for all of them, but none before the first pass: to clear them takes longer
    /// than a preview.
    pixels: Vec<PixelSums>,
    /// Where samples do not go evenly: who gets how many until the next power of two.
    allotment: Option<Allotment>,
    /// How errors were last told from the sums.
    model: Option<ErrorModel>,
    noise: Option<Noise>,
}

/// What is known of a pixel beside its colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Samples so far.
    pub n_samples: u32,
    /// 100 x the estimated standard error of its luminance over the mean luminance of the whole
    /// picture: the noise figure is its root mean square. NaN while there are too few samples.
    pub error_percent: f32,
}

/// The film of that size does not fit into memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a film of {width} x {height} pixels takes {} MiB, more than there is; give a smaller size", .bytes >> 20)]
pub struct FilmTooLarge {
    width: u32,
    height: u32,
    bytes: u64,
}

impl Film {
    /// Bytes a pixel while a picture is made: these sums, those of the pass on its way, and one
    /// picture in `f32`.
    pub(super) const BYTES_A_PIXEL: u64 =
        (2 * size_of::<PixelSums>() + size_of::<[f32; 3]>()) as u64;

    /// A black film.
    ///
    /// # Errors
    /// When memory does not suffice.
    pub fn new(width: u32, height: u32) -> Result<Self, FilmTooLarge> {
        let n_pixels = width as usize * height as usize;
        let bytes = (n_pixels * size_of::<PixelSums>()) as u64;
        let too_large = FilmTooLarge { width, height, bytes };
        let mut pixels = Vec::new();
        pixels.try_reserve_exact(n_pixels).map_err(|_| too_large)?;
        Ok(Self { width, height, n_samples: 0, pixels, allotment: None, model: None, noise: None })
    }

    /// Width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Samples a pixel so far; their mean where samples go where the error is.
    pub fn n_samples(&self) -> u32 {
        self.n_samples
    }

    /// Samples of one pixel.
    pub fn samples_at(&self, x: u32, y: u32) -> u32 {
        self.pixel((y * self.width + x) as usize).n_samples
    }

    /// The mean of a pixel's samples; black without samples.
    pub fn mean(&self, x: u32, y: u32) -> [f32; 3] {
        self.pixel((y * self.width + x) as usize).mean()
    }

    /// The means of all pixels.
    pub fn picture(&self) -> Picture {
        let pixels = (0..self.n_pixels()).map(|place| self.pixel(place).mean()).collect();
        Picture { width: self.width, height: self.height, pixels }
    }

    /// The estimated error; `None` while there are too few samples to tell, and for a black picture.
    pub fn noise(&self) -> Option<Noise> {
        self.noise
    }

    /// 100 x the estimated RMSE of linear luminance over its mean.
    pub fn noise_percent(&self) -> Option<f64> {
        self.noise.map(|noise| noise.percent)
    }

    /// What is known of every pixel beside its colour, on the current pool.
    pub fn sampling(&self) -> PixelMap<Sampling> {
        let n_samples = |pixel: &PixelSums| f64::from(pixel.n_samples.max(1));
        let light = self.pixels.iter().map(|pixel| pixel.luminance() / n_samples(pixel));
        let mean = light.sum::<f64>() / self.pixels.len() as f64;
        let of_pixel = |place: usize| {
            let pixel = &self.pixel(place);
            let known = self.model.filter(|_| 2 <= pixel.n_samples);
            let error = known.map_or(f64::NAN, |model| model.variance(pixel).sqrt());
            let error_percent = (100.0 * error / mean) as f32;
            Sampling { n_samples: pixel.n_samples, error_percent }
        };
        let pixels = (0..self.n_pixels()).into_par_iter().map(of_pixel).collect();
        PixelMap { width: self.width, height: self.height, pixels }
    }

    /// What the next pass of a tile starts from, and where it goes when the mean is `n_samples`.
    pub(super) fn part(&self, tile: Tile, n_samples: u32) -> Part {
        let places = tile.rows().flat_map(|y| self.row(&tile, y));
        let pixels = places.clone().map(|place| self.pixel(place)).collect();
        let goal = |place| match &self.allotment {
            Some(allotment) => allotment.n_samples(place, n_samples),
            None => n_samples,
        };
        let goals = places.map(goal).collect();
        Part { tile, goals, pixels }
    }

    /// Takes all tiles of a pass, with which the mean is `n_samples`.
    pub(super) fn commit<'a>(
        &mut self,
        n_samples: u32,
        settings: &RenderSettings,
        parts: impl Iterator<Item = &'a Part>,
    ) {
        self.pixels.resize(self.n_pixels(), PixelSums::default());
        for Part { tile, pixels, .. } in parts {
            for (y, row) in tile.rows().zip(pixels.chunks_exact(tile.width as usize)) {
                let to = self.row(tile, y);
                self.pixels[to].copy_from_slice(row);
            }
        }
        self.n_samples = n_samples;
        if n_samples < 2 {
            return;
        }
        let model = ErrorModel::new(settings.sampler, &self.pixels);
        if settings.adaptive && is_told_anew(n_samples) {
            let width = self.width as usize;
            self.allotment = Some(Allotment::new(width, n_samples, &self.pixels, &model));
        }
        let allotment = self.allotment.as_ref();
        let course = allotment.and_then(|all| all.course(n_samples, &self.pixels, &model));
        let course = course.unwrap_or(Course::even(model.ratio()));
        self.noise = model.noise(&self.pixels, course);
        self.model = Some(model);
    }

    fn n_pixels(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// The sums of a pixel.
    fn pixel(&self, place: usize) -> PixelSums {
        self.pixels.get(place).copied().unwrap_or_default()
    }

    fn row(&self, tile: &Tile, y: u32) -> std::ops::Range<usize> {
        let first = (y * self.width + tile.x) as usize;
        first..first + tile.width as usize
    }
}
