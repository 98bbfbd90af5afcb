//! What a driver shows before a picture is there in full size: coarse pictures, and maps.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use super::{Driver, Work};
use crate::render::{RenderJob, plan};
use crate::session::{Frame, Renderer, Wanted, lock};

/// A preview is made as fine as fits this.
const PREVIEW_SECS: f64 = 0.013;
/// A full-size pass that takes longer than this is preceded by finer previews.
const PATIENCE_SECS: f64 = 0.15;

impl<R: Renderer> Driver<'_, R> {
    /// The coarse picture, which only closing and another scene stop; then finer ones while a full pass is
    /// far away, which give way to a newer job.
    pub(super) fn preview(&mut self, work: &mut Work<R::World>) {
        let n_pixels = u64::from(work.job.width) * u64::from(work.job.height);
        let wanted = work.maps.absent(self.shared.orders().wanted);
        if wanted != Wanted::NOTHING {
            let scale = self.map_scale(&work.job);
            self.survey(work, scale, wanted, &self.shared.stop_preview);
        }
        let mut scale = plan::preview_scale(n_pixels, self.rate, PREVIEW_SECS);
        let mut stop = &self.shared.stop_preview;
        if scale == 1 {
            // So fast that the first sample is the preview: it is not stopped by an edit either.
            return self.refine(work, stop);
        }
        while scale > 1 {
            if !self.coarse(work, scale, stop) {
                return;
            }
            stop = &self.shared.stop_refining;
            let is_near = n_pixels as f64 <= self.rate * PATIENCE_SECS;
            if is_near {
                return;
            }
            scale = plan::finer_scale(scale);
        }
    }

    fn coarse(&mut self, work: &mut Work<R::World>, scale: u32, stop: &AtomicBool) -> bool {
        let world = self.renderer.coarse(&work.world, scale);
        let Ok(mut film) = self.renderer.film(&world) else { return false };
        let start = Instant::now();
        let Ok(statistics) = self.renderer.pass(&world, &mut film, 1, stop) else { return false };
        self.measure(&film, 1, statistics, start.elapsed().as_secs_f64());
        let frame = self.frame(work, scale, &film);
        self.publish(work, frame);
        true
    }

    /// The wanted maps in full size, or coarse where there is none yet, shown with the picture that
    /// is there.
    pub(super) fn finish_maps(&mut self, work: &mut Work<R::World>) {
        let wanted = work.unfinished(self.shared.orders().wanted);
        let absent = work.maps.absent(wanted);
        if absent == Wanted::NOTHING {
            self.survey(work, 1, wanted, &self.shared.stop_refining);
        } else {
            let scale = self.map_scale(&work.job);
            self.survey(work, scale, absent, &self.shared.stop_refining);
        }
        let shown = lock(&self.shared.slot).clone();
        let Some(shown) = shown.filter(|frame| frame.generation == work.generation) else { return };
        if wanted.sampling {
            work.maps.sampling = Some(Arc::new(self.renderer.sampling(&work.film)));
        }
        self.sequence += 1;
        let (sequence, maps) = (self.sequence, work.maps.clone());
        self.publish(work, Frame { sequence, maps, ..Frame::clone(&shown) });
    }

    /// By how much a coarse map is smaller than the picture.
    fn map_scale(&self, job: &RenderJob) -> u32 {
        let n_pixels = u64::from(job.width) * u64::from(job.height);
        plan::preview_scale(n_pixels, self.map_rate, PREVIEW_SECS)
    }

    /// Makes maps of a picture smaller by `scale`.
    fn survey(&mut self, work: &mut Work<R::World>, scale: u32, wanted: Wanted, stop: &AtomicBool) {
        let coarse = (1 < scale).then(|| self.renderer.coarse(&work.world, scale));
        let world = coarse.as_ref().unwrap_or(&*work.world);
        let start = Instant::now();
        let mut n_made = 0.0;
        if wanted.features
            && let Ok(map) = self.renderer.features(world, stop)
        {
            n_made += map.pixels.len() as f64;
            work.maps.features = Some(Arc::new(map));
        }
        if wanted.costs
            && let Ok(map) = self.renderer.costs(world, stop)
        {
            n_made += map.pixels.len() as f64;
            work.maps.costs = Some(Arc::new(map));
        }
        if n_made >= 256.0 {
            let measured = n_made / start.elapsed().as_secs_f64().max(1e-6);
            self.map_rate = measured.max(0.5 * (self.map_rate + measured));
        }
        let is_tried = wanted.features || wanted.costs;
        work.has_no_maps = is_tried && n_made == 0.0 && !stop.load(Ordering::Relaxed);
    }
}
