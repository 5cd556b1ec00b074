//! Elimination of the unknowns of a panel from the columns behind it: what factorisation spends its time
//! on. Slices are cut once, registers filled by whole rows of panels, so that little but products is left.

use super::super::BandMatrix;
use std::ops::Range;

use super::super::blocks::{first, first_blocks, first_blocks_mut};
use super::super::columns::PANEL;
use super::super::pivots::Pivots;
use super::{GROWTH, Ldlt, NOISE};
use crate::error::{Error, Result};
use crate::scalar::{Lanes, Mask, Real};

impl<R: Real> Ldlt<R> {
    /// Eliminates the unknowns `j..j + P` from those that they are coupled to, whose columns start at
    /// `starts`, the last of which is where they end. False if a pivot
    /// cannot be trusted; the columns are then as before. Reciprocals replace the pivots.
    #[inline(always)]
    pub(super) fn eliminate<L: Lanes<R>, const P: usize>(
        &mut self,
        j: usize,
        starts: &[usize],
        matrix: Option<&BandMatrix<R>>,
        definite: bool,
    ) -> Result<bool> {
        let Self {
            columns,
            counts,
            diagonal,
            panel,
            room,
            magnitude,
            negative,
            ..
        } = self;
        let below = starts.len() - 1 - P;
        let (own, open) = columns[starts[0]..starts[P + below]].split_at_mut(starts[P] - starts[0]);
        // Of every column of the panel the pivots, and what is below them.
        let mut triangle: [&mut [R]; P] = std::array::from_fn(|_| Default::default());
        let mut scaled: [&mut [R]; P] = std::array::from_fn(|_| Default::default());
        let mut rest = own;
        for p in 0..P {
            let (column, others) = rest.split_at_mut(starts[p + 1] - starts[p]);
            (triangle[p], scaled[p]) = column.split_at_mut(P - p);
            rest = others;
        }
        let mut entries = [[L::zero(); P]; P];
        for p in 0..P {
            for i in p..P {
                entries[p][i] = L::lift(triangle[p][i - p]);
            }
        }
        let pivots = Pivots::of(entries);
        // The least of what the pivots are above nothing and above rounding, and what tells whether all
        // of them are numbers.
        let (mut least, mut sum) = (R::one(), R::zero());
        let diagonal = &diagonal[j..j + P];
        for p in 0..P {
            let pivot = first(pivots.before[p][p]);
            let noise = R::lit(NOISE * R::EPSILON) * diagonal[p];
            least = least.smaller(pivot).smaller(pivot - noise);
            sum += pivot;
        }
        if !(definite && sum.finite() && !least.at_most(R::zero()).any()) {
            let triangles =
                [pivots.before, pivots.after].map(|rows| rows.map(|row| row.map(first)));
            match watch(
                &mut magnitude[j..],
                triangles,
                j,
                matrix.filter(|_| !definite),
            )? {
                Some(found) => *negative += found,
                None => return Ok(false),
            }
        }
        for p in 0..P {
            triangle[p][0] = first(pivots.inverse[p]);
            for i in p + 1..P {
                triangle[p][i - p] = first(pivots.after[p][i]);
            }
        }
        let count = below.div_ceil(L::WIDTH);
        let mut blocks: [&mut [L::Block]; P] = std::array::from_fn(|_| Default::default());
        let mut copies: [&mut [L::Block]; P] = std::array::from_fn(|_| Default::default());
        let mut rest = &mut panel[..];
        for (p, column) in scaled.iter_mut().enumerate() {
            let (copy, others) = rest.split_at_mut(*room);
            blocks[p] = first_blocks_mut::<R, L>(column, count);
            let (copy, behind) = first_blocks_mut::<R, L>(copy, count + 1).split_at_mut(count);
            // Read where a panel begins in the middle of a register.
            L::zero().store(behind[0].as_mut());
            copies[p] = copy;
            rest = others;
        }
        let mut minus = [[L::zero(); P]; P];
        for p in 0..P {
            for q in 0..p {
                minus[q][p] = -pivots.before[q][p];
            }
        }
        for i in 0..count {
            let mut l = [L::zero(); P];
            for p in 0..P {
                let mut entry = L::load(blocks[p][i].as_ref());
                for q in 0..p {
                    entry = entry.plus_product(l[q], minus[q][p]);
                }
                l[p] = entry * pivots.inverse[p];
                // With the sign that the columns behind take it with.
                (-entry).store(copies[p][i].as_mut());
                l[p].store(blocks[p][i].as_mut());
            }
        }
        let scaled = scaled.map(|column| &column[..below]);
        let mut unscaled: [&[R]; P] = [&[]; P];
        let mut rest = &panel[..];
        for p in 0..P {
            (unscaled[p], rest) = rest.split_at(*room);
        }
        if !definite {
            for i in 0..below {
                for p in 0..P {
                    magnitude[j + P + i] += (scaled[p][i] * unscaled[p][i]).abs();
                }
            }
        }
        Update {
            scaled,
            unscaled,
            starts: &starts[P..],
            rows: below,
        }
        .run::<L>(&counts[j + P..][..below], open);
        Ok(true)
    }
}

/// How many pivots are negative of those of a matrix that may be indefinite, if they can be trusted, by the
/// `magnitude` of the terms that diagonal entries from row `j` on were summed from. Those of a definite one
/// cannot, or they would not come here.
#[cold]
#[inline(never)]
fn watch<R: Real, const P: usize>(
    magnitude: &mut [R],
    [before, after]: [[[R; P]; P]; 2],
    j: usize,
    matrix: Option<&BandMatrix<R>>,
) -> Result<Option<R>> {
    let mut negative = R::zero();
    for p in 0..P {
        let pivot = before[p][p];
        if !pivot.finite() {
            return Err(Error::NotFinite {
                what: "a pivot of the matrix to factorise",
                value: pivot.value(),
            });
        }
        let Some(matrix) = matrix else {
            return Ok(None);
        };
        let terms = magnitude[p];
        let noise = pivot.abs().at_most(R::lit(NOISE * R::EPSILON) * terms);
        let bound = R::lit(GROWTH) * matrix.largest_of_row(j + p);
        if (noise | !terms.at_most(bound)).any() {
            // A lane that is definite would not have been watched in a run of its own.
            let _ = Mask::among(R::LANES == 1).common();
            return Ok(None);
        }
        negative += R::one().where_else(pivot.at_most(R::zero()), R::zero());
        for i in p + 1..P {
            magnitude[i] += (before[p][i] * after[p][i]).abs();
        }
    }
    Ok(Some(negative))
}

/// What the elimination of a panel adds to the columns behind it, as many as there are rows below it.
struct Update<'a, R, const P: usize> {
    /// The columns of the panel below the pivots, after division by them.
    scaled: [&'a [R]; P],
    /// The same before, with the other sign and zeros behind it.
    unscaled: [&'a [R]; P],
    /// Where the columns behind the panel start.
    starts: &'a [usize],
    rows: usize,
}

impl<R: Real, const P: usize> Update<'_, R, P> {
    /// Goes through the columns by panels of as many as `counts` tells.
    #[inline(always)]
    fn run<L: Lanes<R>>(&self, counts: &[u8], open: &mut [R]) {
        let end = self.rows;
        let mut k = 0;
        if L::WIDTH == 1 {
            // No register reaches above a diagonal: of two columns, the first has a row of its own.
            while k + 1 < end {
                self.columns::<L, 1>(k, k..k + 1, open);
                self.columns::<L, 2>(k, k + 1..end, open);
                k += 2;
            }
        }
        while k < end {
            let top = k;
            let behind = (top + usize::from(counts[top])).min(end);
            if L::WIDTH >= PANEL && behind == top + PANEL {
                self.columns::<L, PANEL>(top, top..end, open);
                k = behind;
            }
            while k < behind {
                let rows = k - (k - top) % L::WIDTH..end;
                if k + 1 < behind {
                    self.columns::<L, 2>(k, rows, open);
                    k += 2;
                } else {
                    self.columns::<L, 1>(k, rows, open);
                    k += 1;
                }
            }
        }
    }

    /// Adds to `C` columns from `k` on, in rows of which the first may lie above their diagonals and the
    /// last fill no register.
    #[inline(always)]
    fn columns<L: Lanes<R>, const C: usize>(&self, k: usize, rows: Range<usize>, open: &mut [R]) {
        let count = rows.len().div_ceil(L::WIDTH);
        let mut columns: [&mut [L::Block]; C] = std::array::from_fn(|_| Default::default());
        let (mut rest, mut passed) = (open, 0);
        for c in 0..C {
            let start = self.starts[k + c] - self.starts[0] + rows.start - (k + c);
            let column = rest.split_at_mut(start - passed).1;
            let (column, others) = column.split_at_mut(count * L::WIDTH);
            columns[c] = first_blocks_mut::<R, L>(column, count);
            (rest, passed) = (others, start + count * L::WIDTH);
        }
        let mut along: [&[L::Block]; P] = [&[]; P];
        for p in 0..P {
            along[p] = first_blocks::<R, L>(&self.unscaled[p][rows.start..], count);
        }
        let mut factors = [[R::zero(); C]; P];
        for (factors, scaled) in factors.iter_mut().zip(self.scaled) {
            factors.copy_from_slice(&scaled[k..k + C]);
        }
        // Short loops of known length have no end to be guessed.
        if L::WIDTH > 1 && C > 1 {
            match count {
                1 => return add_rows::<R, L, P, C>(1, &along, columns, factors),
                2 => return add_rows::<R, L, P, C>(2, &along, columns, factors),
                3 => return add_rows::<R, L, P, C>(3, &along, columns, factors),
                4 => return add_rows::<R, L, P, C>(4, &along, columns, factors),
                5 => return add_rows::<R, L, P, C>(5, &along, columns, factors),
                _ => {}
            }
        }
        add_rows::<R, L, P, C>(count, &along, columns, factors);
    }
}

/// Adds multiples of the pivots' columns to others, two at a time, which share what is loaded.
#[inline(always)]
fn add_rows<R: Real, L: Lanes<R>, const P: usize, const C: usize>(
    count: usize,
    along: &[&[L::Block]; P],
    mut columns: [&mut [L::Block]; C],
    factors: [[R; C]; P],
) {
    let (pairs, rest) = columns.as_chunks_mut::<2>();
    for (pair, [first, second]) in pairs.iter_mut().enumerate() {
        let mut known = [[L::zero(); P]; 2];
        for c in 0..2 {
            for p in 0..P {
                known[c][p] = L::lift(factors[p][2 * pair + c]);
            }
        }
        for i in 0..count {
            let mut entries = [L::load(first[i].as_ref()), L::load(second[i].as_ref())];
            for p in 0..P {
                let pivot = L::load(along[p][i].as_ref());
                for c in 0..2 {
                    entries[c] = entries[c].plus_product(pivot, known[c][p]);
                }
            }
            entries[0].store(first[i].as_mut());
            entries[1].store(second[i].as_mut());
        }
    }
    for column in rest {
        for i in 0..count {
            let mut entry = L::load(column[i].as_ref());
            for p in 0..P {
                let pivot = L::load(along[p][i].as_ref());
                entry = entry.plus_product(pivot, L::lift(factors[p][C - 1]));
            }
            entry.store(column[i].as_mut());
        }
    }
}
