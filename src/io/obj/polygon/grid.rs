//! Points of a plane by the cell of a grid that each lies in, to find those near a triangle.

use glam::DVec2;

/// A corner of an outline.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub(super) corner: u32,
    pub(super) point: DVec2,
}

/// Cells of the shape that the outline's edges have in the mean: then few of them touch an ear,
/// be it a long tooth. Some two corners lie in each, where they are spread evenly.
#[derive(Debug, Default)]
pub(super) struct Grid {
    low: DVec2,
    /// Cells a unit of length.
    scale: DVec2,
    n_columns: usize,
    n_rows: usize,
    /// Where the corners of each cell begin, row after row; and where those of the last end.
    starts: Vec<u32>,
    entries: Vec<Entry>,
}

impl Grid {
    /// The grid of other corners, whose memory is kept. `edges` is the size of all edges together.
    pub(super) fn fill(&mut self, corners: &[Entry], edges: DVec2) {
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for Entry { point, .. } in corners {
            (low, high) = (low.min(*point), high.max(*point));
        }
        let n_cells = corners.len().div_ceil(2).max(1) as f64;
        let shape = (high - low) / edges;
        // `max` and `min` leave no NaN.
        let n_columns = (n_cells * shape.x / shape.y).sqrt().max(1.0).min(n_cells).floor();
        let n_rows = (n_cells / n_columns).max(1.0).floor();
        (self.n_columns, self.n_rows) = (n_columns as usize, n_rows as usize);
        self.low = low;
        let scale = DVec2::new(n_columns, n_rows) / (high - low);
        // Where nothing is wide, or so little that its reciprocal overflows, one cell is all.
        self.scale = DVec2::from_array(scale.to_array().map(|s| if s < 1e300 { s } else { 0.0 }));
        self.starts.clear();
        self.starts.resize(self.n_columns * self.n_rows + 1, 0);
        for entry in corners {
            let cell = self.cell(entry.point);
            self.starts[cell] += 1;
        }
        let mut end = 0;
        for start in &mut self.starts {
            end += *start;
            *start = end;
        }
        self.entries.clear();
        self.entries.resize(corners.len(), Entry { corner: 0, point: DVec2::ZERO });
        // From the ends of the cells downwards; then they are the beginnings.
        for entry in corners {
            let cell = self.cell(entry.point);
            self.starts[cell] -= 1;
            self.entries[self.starts[cell] as usize] = *entry;
        }
    }

    /// The corners in the cells of each row that touch a triangle: all that lie in it, and some
    /// beside.
    pub(super) fn near(&self, triangle: [DVec2; 3]) -> impl Iterator<Item = &[Entry]> {
        let rows = triangle.map(|p| self.row(p.y));
        let first = rows.into_iter().min().unwrap_or_default();
        let last = rows.into_iter().max().unwrap_or_default();
        (first..=last).map(move |row| {
            let (low, high) = extent_between(triangle, self.heights(row));
            let begin = row * self.n_columns;
            let first = self.starts[begin + self.column(low)] as usize;
            let last = self.starts[begin + self.column(high) + 1] as usize;
            &self.entries[first..last.max(first)]
        })
    }

    /// The lower and the upper end of a row, with some room for rounding. Corners that are on one
    /// level have one row without height.
    fn heights(&self, row: usize) -> (f64, f64) {
        const SLACK: f64 = 1e-6;
        let height = |rows: f64| {
            let above = rows / self.scale.y;
            self.low.y + if above.is_finite() { above } else { 0.0 }
        };
        (height(row as f64 - SLACK), height(row as f64 + 1.0 + SLACK))
    }

    fn cell(&self, point: DVec2) -> usize {
        self.row(point.y) * self.n_columns + self.column(point.x)
    }

    /// The column of a coordinate; one outside belongs to that at the border.
    fn column(&self, x: f64) -> usize {
        (((x - self.low.x) * self.scale.x) as usize).min(self.n_columns - 1)
    }

    /// The row of a coordinate, as [`Self::column`].
    fn row(&self, y: f64) -> usize {
        (((y - self.low.y) * self.scale.y) as usize).min(self.n_rows - 1)
    }
}

/// The least and the largest x of what lies of a triangle between two heights that it touches, a
/// little wider than that for the rounding.
fn extent_between(triangle: [DVec2; 3], (bottom, top): (f64, f64)) -> (f64, f64) {
    const SLACK: f64 = 1e-9;
    let [a, b, c] = triangle;
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for (p, q) in [(a, b), (b, c), (c, a)] {
        let (lower, upper) = if p.y < q.y { (p, q) } else { (q, p) };
        // Both are 0 and 1 on a level edge, whose 0 / 0 means nothing here.
        let height = upper.y - lower.y;
        let from = ((bottom - lower.y) / height - SLACK).max(0.0);
        let to = ((top - lower.y) / height + SLACK).min(1.0);
        if from <= to {
            let ends = [from, to].map(|t| lower.x + t * (upper.x - lower.x));
            low = low.min(ends[0]).min(ends[1]);
            high = high.max(ends[0]).max(ends[1]);
        }
    }
    let slack = SLACK * (high - low);
    (low - slack, high + slack)
}
