//! Where samples are summed: linear, whole passes only.

use crate::color::{Picture, Rgb, luminance};
use crate::render::noise::NoiseEstimate;
use crate::render::plan::Tile;

/// Sums of all samples of every pixel, row 0 at the top.
#[derive(Clone, Debug)]
pub struct Film {
    width: u32,
    height: u32,
    n_samples: u32,
    sums: Vec<[f64; 3]>,
    noise: NoiseEstimate,
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
    /// A black film.
    ///
    /// # Errors
    /// When memory does not suffice.
    pub fn new(width: u32, height: u32) -> Result<Self, FilmTooLarge> {
        let n_pixels = width as usize * height as usize;
        let bytes = n_pixels as u64 * (size_of::<[f64; 3]>() + NoiseEstimate::BYTES_A_PIXEL) as u64;
        let too_large = FilmTooLarge { width, height, bytes };
        let mut sums = Vec::new();
        sums.try_reserve_exact(n_pixels).map_err(|_| too_large)?;
        sums.resize(n_pixels, [0.0; 3]);
        let noise = NoiseEstimate::new(n_pixels).ok_or(too_large)?;
        Ok(Self { width, height, n_samples: 0, sums, noise })
    }

    /// Width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Samples a pixel so far.
    pub fn n_samples(&self) -> u32 {
        self.n_samples
    }

    /// The mean of a pixel's samples; black without samples.
    pub fn mean(&self, x: u32, y: u32) -> [f32; 3] {
        let scale = 1.0 / f64::from(self.n_samples.max(1));
        self.sums[(y * self.width + x) as usize].map(|sum| (sum * scale) as f32)
    }

    /// The means of all pixels.
    pub fn picture(&self) -> Picture {
        let scale = 1.0 / f64::from(self.n_samples.max(1));
        let pixels = self.sums.iter().map(|sum| sum.map(|s| (s * scale) as f32)).collect();
        Picture { width: self.width, height: self.height, pixels }
    }

    /// 100 x the estimated RMSE of linear luminance over its mean; `None` while there are too few
    /// samples to tell, and for a black picture.
    pub fn noise_percent(&self) -> Option<f64> {
        self.noise.percent(self.n_samples)
    }

    /// The running sums of a tile, row by row: what the next pass starts from.
    pub(super) fn tile_sums(&self, tile: &Tile) -> Vec<[f64; 3]> {
        tile.rows().flat_map(|y| self.sums[self.row(tile, y)].iter().copied()).collect()
    }

    /// Takes the sums of all tiles of a pass of `n_samples`.
    pub(super) fn commit(&mut self, n_samples: u32, tiles: &[(Tile, Vec<[f64; 3]>)]) {
        for (tile, sums) in tiles {
            for (y, row) in tile.rows().zip(sums.chunks_exact(tile.width as usize)) {
                let to = self.row(tile, y);
                self.sums[to].copy_from_slice(row);
            }
        }
        self.n_samples += n_samples;
        if self.n_samples.is_power_of_two() {
            let sums = self
                .sums
                .iter()
                .map(|s| f64::from(luminance(Rgb::new(s[0] as f32, s[1] as f32, s[2] as f32))));
            self.noise.record(self.n_samples, sums);
        }
    }

    fn row(&self, tile: &Tile, y: u32) -> std::ops::Range<usize> {
        let first = (y * self.width + tile.x) as usize;
        first..first + tile.width as usize
    }
}
