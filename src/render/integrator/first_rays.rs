//! Camera rays of a wave, made block by block.

use glam::Vec2;

use super::dimension;
use crate::math::sampler::{Net, NumbersBlock, SampleNumbers, Sampler};
use crate::math::vectorized::{BLOCK, Lane};
use crate::math::{RayBatch, RayBlock};
use crate::scene::Camera;

/// Camera rays on their way into a batch.
pub(super) struct FirstRays {
    n: usize,
    numbers: NumbersBlock,
    /// The pixels.
    at: [Lane<f32>; 2],
    rays: RayBlock,
}

impl FirstRays {
    pub(super) fn new(sampler: Sampler) -> Self {
        let (numbers, rays) = (NumbersBlock::new(sampler), RayBlock::IDLE);
        Self { n: 0, numbers, at: [[0.0; BLOCK]; 2], rays }
    }

    /// Takes the next sample of a pixel.
    pub(super) fn push(
        &mut self,
        (x, y): (u32, u32),
        numbers: &SampleNumbers,
        camera: &Camera,
        size: Vec2,
        rays: &mut RayBatch,
    ) {
        self.numbers.set(self.n, numbers);
        (self.at[0][self.n], self.at[1][self.n]) = (x as f32, y as f32);
        self.n += 1;
        if self.n == BLOCK {
            self.flush(camera, size, rays);
        }
    }

    /// Sends those that are still waiting.
    pub(super) fn flush(&mut self, camera: &Camera, size: Vec2, rays: &mut RayBatch) {
        let (mut at, mut lens) = ([[0.0; BLOCK]; 2], [[0.0; BLOCK]; 2]);
        self.numbers.pairs(dimension::PIXEL, Some(Net::First), &mut at);
        for (at, pixel) in at.iter_mut().flatten().zip(self.at.as_flattened()) {
            *at += pixel;
        }
        if camera.aperture_radius > 0.0 {
            self.numbers.pairs(dimension::LENS, Some(Net::Second), &mut lens);
        }
        camera.rays(&at, size, &lens, &mut self.rays);
        rays.append(&self.rays, self.n);
        self.n = 0;
    }
}
