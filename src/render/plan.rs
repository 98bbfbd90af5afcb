//! How a picture is cut into tiles and its samples into passes: pure arithmetic.

/// Side of a tile in pixels.
pub const TILE_SIZE: u32 = 16;

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile {
    /// First column.
    pub x: u32,
    /// First row.
    pub y: u32,
    /// Columns, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
}

impl Tile {
    /// Rows from top to bottom.
    pub fn rows(&self) -> std::ops::Range<u32> {
        self.y..self.y + self.height
    }

    /// Pixels, row by row.
    pub fn pixels(&self) -> impl Iterator<Item = (u32, u32)> {
        let (x, width) = (self.x, self.width);
        self.rows().flat_map(move |y| (x..x + width).map(move |x| (x, y)))
    }
}

/// All tiles of a picture, row by row.
pub fn tiles(width: u32, height: u32) -> Vec<Tile> {
    let starts = |length: u32| (0..length).step_by(TILE_SIZE as usize);
    let tile = |x: u32, y: u32| Tile {
        x,
        y,
        width: TILE_SIZE.min(width - x),
        height: TILE_SIZE.min(height - y),
    };
    starts(height).flat_map(|y| starts(width).map(move |x| tile(x, y))).collect()
}

/// Samples of the next pass: 1, 1, 2, 4, 8, then 16 at a time. A pass ends at `goal`, and at every
/// power of two, where the noise is read.
pub fn pass_samples(n_samples: u32, goal: u32) -> u32 {
    const LARGEST: u32 = 16;
    let size = n_samples.clamp(1, LARGEST);
    let next_power = (n_samples + 1).next_power_of_two();
    size.min(next_power - n_samples).min(goal.saturating_sub(n_samples))
}

/// How many tiles to render together, so that few samples a pixel make waves worth their while, and
/// every thread has a few shares.
pub fn tiles_together(n_tiles: usize, n_samples: u32, n_threads: usize) -> usize {
    const WAVE: u32 = 1024;
    const SHARES: usize = 4;
    let of_wave = WAVE / (TILE_SIZE * TILE_SIZE) / n_samples.max(1);
    (of_wave as usize).min(n_tiles / (SHARES * n_threads.max(1))).max(1)
}

/// By how much a preview is smaller than the picture: the least number up to 64 at which one sample a
/// pixel fits `budget_secs`, at a measured number of samples a second.
pub fn preview_scale(n_pixels: u64, samples_per_sec: f64, budget_secs: f64) -> u32 {
    const COARSEST: f64 = 64.0;
    let affordable = samples_per_sec * budget_secs;
    let scale = (n_pixels as f64 / affordable).sqrt().ceil();
    // Not a number where there is nothing to do and nothing done.
    (scale.clamp(1.0, COARSEST) as u32).max(1)
}

/// By how much the next preview is smaller, after one by `scale`; 1 where the picture itself comes soon.
pub fn finer_scale(scale: u32) -> u32 {
    if scale > 4 { (2 * scale + 2) / 5 } else { 1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_every_pixel_once() {
        for (width, height) in [(1, 1), (16, 16), (17, 33), (100, 3)] {
            let mut seen = vec![0; (width * height) as usize];
            for (x, y) in tiles(width, height).iter().flat_map(Tile::pixels) {
                seen[(y * width + x) as usize] += 1;
            }
            assert!(seen.iter().all(|n| *n == 1), "{width} x {height}: {seen:?}");
        }
    }

    #[test]
    fn passes_reach_the_goal_and_stop_at_powers_of_two() {
        for goal in [1, 2, 3, 7, 64, 100, 257] {
            let (mut n, mut stops) = (0, Vec::new());
            while n < goal {
                n += pass_samples(n, goal);
                stops.push(n);
            }
            assert_eq!(n, goal, "{stops:?}");
            let mut power = 1;
            while power <= goal {
                assert!(stops.contains(&power), "{power} is no stop of {stops:?}");
                power *= 2;
            }
        }
    }

    #[test]
    fn passes_grow_to_sixteen_samples_and_never_cross_a_power_of_two() {
        let sizes = [0, 1, 2, 4, 8, 16, 32, 4096].map(|n| pass_samples(n, u32::MAX));
        assert_eq!(sizes, [1, 1, 2, 4, 8, 16, 16, 16], "other passes");
        // Also where a goal in between was reached before.
        for n in 1..300 {
            let end = n + pass_samples(n, 1000);
            let next_power = (n + 1).next_power_of_two();
            assert!(n < end && end <= next_power, "a pass from {n} to {end}");
        }
    }

    #[test]
    fn tiles_go_together_for_few_samples_and_few_threads() {
        assert_eq!(tiles_together(1000, 1, 2), 4, "1024 paths");
        assert_eq!(tiles_together(1000, 2, 2), 2, "the same");
        assert_eq!(tiles_together(1000, 16, 2), 1, "enough paths each");
        assert_eq!(tiles_together(20, 1, 2), 2, "four shares a thread");
        assert_eq!(tiles_together(3, 1, 64), 1, "fewer tiles than threads");
        assert_eq!(tiles_together(1000, 0, 2), 4, "a pass without samples");
        assert_eq!(tiles_together(20, 1, 0), 4, "no thread yet: as for one");
    }

    #[test]
    fn previews_fit_their_budget() {
        assert_eq!(preview_scale(1_000_000, 1e9, 0.02), 1, "fast enough for all");
        assert_eq!(preview_scale(921_600, 5e6, 0.02), 4, "57600 of 100000, 3 takes 102400");
        assert_eq!(preview_scale(921_600, 3e6, 0.02), 4, "57600 of 60000");
        assert_eq!(preview_scale(921_600, 2e6, 0.02), 5, "36864 of 40000");
        assert_eq!(preview_scale(921_600, 1.0, 0.02), 64, "never coarser than 64");
        assert_eq!(preview_scale(921_600, 0.0, 0.02), 64, "nor where nothing is done");
        assert_eq!(preview_scale(0, 0.0, 0.02), 1, "of nothing");
    }

    /// Each takes at most nine times as long as the one before, and the picture itself comes after one
    /// by four at most.
    #[test]
    fn finer_previews_lead_to_the_picture() {
        for coarsest in 1..=64 {
            let mut scale = coarsest;
            while scale > 1 {
                let next = finer_scale(scale);
                assert!(next < scale, "{next} after {scale}");
                assert!(scale <= 4 || 9 * next * next >= scale * scale, "{next} after {scale}");
                assert!(next == 1 || 4 * next * next <= scale * scale, "{next} after {scale}");
                assert!(next == 1 || 4 < scale, "{next} after {scale}, not the picture");
                scale = next;
            }
        }
    }
}
