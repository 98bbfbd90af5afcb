//! Digital nets that reach over several pairs of numbers, and over neighbouring pixels.
//!
//! All matrices are over the field of two elements. Their columns are written with the digit of most
//! weight in bit 0, as the scrambles of [`crate::math::sobol`] want numbers.
//!
//! *Over pairs*: read in another order, the (0, 2)-sequence of [`crate::math::sobol`] is another one.
//! The orders here are invertible linear maps of the sample's index that keep every block of 2^k
//! samples, chosen by a search so that two pairs together, four dimensions, have the least t of
//! (t, m, 4)-nets for all blocks up to 4096 samples, and likewise for each two of the four.
//!
//! *Over pixels*: a sequence whose points are shifted, digit by digit, by a constant of the pixel, is
//! still a net in each pixel. The constants are chosen so that 2^k samples in each of the pixels of an
//! aligned block of 1, 2, 4, … pixels are together a net of all those points. What one pixel has too
//! much, its neighbours then have too little: the error has few low frequencies. The idea is that of
//! A. Ahmed and P. Wonka, "Screen-Space Blue-Noise Diffusion of Monte Carlo Sampling Error via
//! Hierarchical Ordering of Pixels", ACM Transactions on Graphics 39(6), 2020, who give each pixel a
//! piece of one sequence, whose length must be known before; the constants do without.

use crate::math::sampler::mix;

/// Pairs beside the first that form a net with it.
pub(super) const N_JOINT: usize = 2;
/// Side of a block of pixels whose shifts belong together.
pub(super) const BLOCK_SIZE: u32 = 16;

/// Samples that an order is defined for: 2^24.
const N_BYTES: usize = 3;

/// The first columns of each order; later ones are drawn at random.
const ORDERS: [[u32; 12]; N_JOINT] = [
    [1, 2, 5, 11, 26, 43, 73, 164, 387, 1001, 1511, 3391],
    [1, 3, 4, 12, 26, 49, 127, 249, 469, 774, 1614, 3737],
];

/// Columns of the shifts, for each bit of a pixel's place in its block, the nearest first.
const SHIFTS: [[u32; 2]; 8] = [
    [62171, 731],
    [58806, 38765],
    [43507, 51496],
    [45031, 11641],
    [9992, 45793],
    [15809, 62746],
    [30912, 15929],
    [4221, 50598],
];

/// Images of every value of every byte of an index.
static ORDER_TABLES: [[[u32; 256]; N_BYTES]; N_JOINT] = order_tables();
/// Shifts by the place's bits from the farthest to the nearest, as [`place_of`] gives them.
static SHIFT_TABLE: [[u32; 2]; 256] = shift_table();

/// The index at which sample `index` (below 2^24) reads the first sequence, for pair `1 + joint`.
#[inline(always)]
pub(super) fn reordered(joint: usize, index: u32) -> u32 {
    let [low, middle, high] = &ORDER_TABLES[joint];
    let byte = |shift: u32| (index >> shift & 0xff) as usize;
    low[byte(0)] ^ middle[byte(8)] ^ high[byte(16)]
}

/// The shift of both numbers for a place in a block.
#[inline(always)]
pub(super) fn shift(place: u8) -> [u32; 2] {
    SHIFT_TABLE[place as usize]
}

/// A pixel's place in its block: the bits of column and row in turn, from the highest (in bit 0) to
/// the lowest, so that places with equal low bits form an aligned block.
#[inline(always)]
pub(super) fn place_of(x: u32, y: u32) -> u8 {
    let spread = |v: u32| {
        let v = (v % BLOCK_SIZE).reverse_bits() >> 28;
        let v = (v | v << 2) & 0x33;
        (v | v << 1) & 0x55
    };
    (spread(y) | spread(x) << 1) as u8
}

const fn order_tables() -> [[[u32; 256]; N_BYTES]; N_JOINT] {
    let mut tables = [[[0; 256]; N_BYTES]; N_JOINT];
    let mut joint = 0;
    while joint < N_JOINT {
        let mut bit = 0;
        while bit < 8 * N_BYTES {
            let column = if bit < ORDERS[joint].len() {
                ORDERS[joint][bit]
            } else {
                let at_random = mix((bit * N_JOINT + joint) as u32);
                at_random & ((1 << bit) - 1) | 1 << bit
            };
            let mut byte = 0;
            while byte < 256 {
                if byte >> (bit % 8) & 1 == 1 {
                    tables[joint][bit / 8][byte] ^= column;
                }
                byte += 1;
            }
            bit += 1;
        }
        joint += 1;
    }
    tables
}

const fn shift_table() -> [[u32; 2]; 256] {
    let mut table = [[0; 2]; 256];
    let mut place = 0;
    while place < 256 {
        let mut bit = 0;
        while bit < 8 {
            if place >> bit & 1 == 1 {
                table[place][0] ^= SHIFTS[7 - bit][0];
                table[place][1] ^= SHIFTS[7 - bit][1];
            }
            bit += 1;
        }
        place += 1;
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sobol::second_dimension;

    /// The columns of one dimension's matrix.
    type Columns = Vec<u32>;

    /// The least t for which the columns make a (t, m, s)-net in base 2: every choice of leading
    /// digits of the dimensions, m - t in all, is an independent set of rows (H. Niederreiter,
    /// "Random Number Generation and Quasi-Monte Carlo Methods", 1992, theorem 4.28).
    fn quality(dimensions: &[&Columns]) -> usize {
        let m = dimensions[0].len();
        let row = |columns: &Columns, digit: usize| -> u32 {
            (0..m).map(|column| (columns[column] >> digit & 1) << column).sum()
        };
        let rows: Vec<Vec<u32>> =
            dimensions.iter().map(|c| (0..m).map(|digit| row(c, digit)).collect()).collect();
        (0..m).find(|t| all_independent(&rows, m - t, &[])).unwrap_or(m)
    }

    /// Whether all choices of `n` leading rows are independent of `basis`, whose rows are reduced.
    fn all_independent(rows: &[Vec<u32>], n: usize, basis: &[u32]) -> bool {
        let Some((first, others)) = rows.split_first() else { return n > 0 || !basis.is_empty() };
        let mut basis = basis.to_vec();
        if others.is_empty() {
            return first[..n].iter().all(|row| insert(&mut basis, *row));
        }
        for n_first in 0..=n {
            if n_first > 0 && !insert(&mut basis, first[n_first - 1]) {
                return false;
            }
            if !all_independent(others, n - n_first, &basis) {
                return false;
            }
        }
        true
    }

    fn insert(basis: &mut Vec<u32>, row: u32) -> bool {
        let reduced = basis.iter().fold(row, |row, b| row.min(row ^ b));
        basis.push(reduced);
        basis.sort_unstable_by_key(|b| std::cmp::Reverse(*b));
        reduced != 0
    }

    /// Both dimensions of pair `kind` on the first 2^m samples.
    fn pair(kind: usize, m: usize) -> [Columns; 2] {
        let index = |bit: usize| if kind == 0 { 1 << bit } else { reordered(kind - 1, 1 << bit) };
        let columns: Columns = (0..m).map(index).collect();
        let second = columns.iter().map(|column| second_dimension(*column)).collect();
        [columns, second]
    }

    #[test]
    fn pairs_are_nets_alone_and_together() {
        for m in 1..=12 {
            let pairs = [pair(0, m), pair(1, m), pair(2, m)];
            for (kind, [x, y]) in pairs.iter().enumerate() {
                assert_eq!(quality(&[x, y]), 0, "pair {kind} of 2^{m} samples");
            }
            for (a, b, most) in [(0, 1, 3), (0, 2, 4), (1, 2, 4)] {
                let ([x, y], [z, w]) = (&pairs[a], &pairs[b]);
                let t = quality(&[x, y, z, w]);
                assert!(t <= most, "pairs {a} and {b} of 2^{m} samples: t = {t}");
            }
        }
    }

    #[test]
    fn pixels_of_a_block_are_nets_together() {
        for (n_bits, most) in [(2, 0), (4, 1), (6, 2), (8, 2)] {
            for m in 0..=6 {
                let [mut x, mut y] = pair(0, m);
                for bit in 0..n_bits {
                    let [shift_x, shift_y] = shift(1 << (7 - bit));
                    x.push(shift_x);
                    y.push(shift_y);
                }
                let t = quality(&[&x, &y]);
                assert!(t <= most, "{} pixels of 2^{m} samples: t = {t}", 1 << n_bits);
            }
        }
    }

    #[test]
    fn places_with_equal_first_bits_form_blocks() {
        assert_eq!(place_of(0, 0), 0);
        let bits = |x: u32, y: u32| u32::from(place_of(x, y));
        for (x, y, expected) in
            [(1, 0, 0x80), (0, 1, 0x40), (2, 0, 0x20), (0, 8, 0x01), (8, 0, 0x02)]
        {
            assert_eq!(bits(x, y), expected, "({x}, {y})");
            assert_eq!(bits(x + 16, y + 32), expected, "the next block");
        }
    }
}
