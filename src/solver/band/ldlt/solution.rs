//! The ways through factors: forward, elimination from a right-hand side, and back, which finds the
//! unknowns from the last to the first.

use std::ops::Range;

use super::super::ahead;
use super::super::blocks::{SUMS, first_blocks, first_blocks_mut, products};
use super::super::columns::{PANEL, overrun};
use super::Ldlt;
use crate::scalar::{LaneWork, Lanes, Real};
use crate::tensor::array;

impl<R: Real> Ldlt<R> {
    /// Eliminates `P` unknowns from the right-hand side and divides them by their pivots.
    #[inline(always)]
    pub(super) fn forward<L: Lanes<R>, const P: usize>(&self, j: usize, last: usize, x: &mut [R]) {
        let (own, columns, below) = self.panel::<P>(j, last);
        let mut known = [R::zero(); P];
        for p in 0..P {
            known[p] = x[j + p];
            for q in 0..p {
                known[p] -= own[q][p - q] * known[q];
            }
        }
        let mut minus = [L::zero(); P];
        for p in 0..P {
            minus[p] = L::lift(-known[p]);
        }
        let count = below.div_ceil(L::WIDTH);
        let rest = first_blocks_mut::<R, L>(&mut x[j + P..], count);
        let mut blocks: [&[L::Block]; P] = [&[]; P];
        for p in 0..P {
            blocks[p] = first_blocks::<R, L>(columns[p], count);
        }
        for i in 0..count {
            let mut sum = L::load(rest[i].as_ref());
            for p in 0..P {
                sum = sum.plus_product(L::load(blocks[p][i].as_ref()), minus[p]);
            }
            sum.store(rest[i].as_mut());
        }
        for p in 0..P {
            x[j + p] = known[p] * self.inverse[j + p];
        }
    }

    /// Finds `P` unknowns from those behind them.
    #[inline(always)]
    fn backward<L: Lanes<R>, const P: usize>(&self, j: usize, last: usize, x: &mut [R]) {
        let (own, columns, below) = self.panel::<P>(j, last);
        let (x, behind) = x.split_at_mut(j + P);
        let mut parts = [[R::zero(); SUMS]; P];
        // As many columns at a time as there are registers for their sums.
        match (L::WIDTH, P) {
            (1, PANEL) => {
                for (columns, parts) in columns.chunks(2).zip(parts.chunks_mut(2)) {
                    products::<R, L, 2>(columns, behind, below, parts);
                }
            }
            _ => products::<R, L, P>(&columns, behind, below, &mut parts),
        }
        for p in (0..P).rev() {
            let sums = parts[p];
            let pairs: [R; SUMS / 2] = array(|k| sums[k] + sums[k + SUMS / 2]);
            let mut value = x[j + p] - ((pairs[0] + pairs[2]) + (pairs[1] + pairs[3]));
            for q in p + 1..P {
                value -= own[p][q - p] * x[j + q];
            }
            x[j + p] = value;
        }
    }

    /// The columns of the unknowns `j..j + P`, each from its diagonal down and all as long from the
    /// first row below them on, and the number of rows up to `last`.
    #[inline(always)]
    fn panel<const P: usize>(&self, j: usize, last: usize) -> ([&[R]; P], [&[R]; P], usize) {
        let below = last + 1 - (j + P);
        let starts = &self.starts[j..j + P];
        let reached = below.next_multiple_of(overrun::<R>() + 1);
        let (mut own, mut columns): ([&[R]; P], [&[R]; P]) = ([&[]; P], [&[]; P]);
        for p in 0..P {
            let column = &self.columns[starts[p]..];
            let (above, rest) = column.split_at(P - p);
            (own[p], columns[p]) = (above, &rest[..reached]);
        }
        (own, columns, below)
    }
}

/// Solution by the factors, after elimination from the right-hand side or with it (`FORWARD`), of some
/// lines: the first that it found comes out.
pub(super) struct Solution<'a, R, const FORWARD: bool> {
    pub(super) ldlt: &'a Ldlt<R>,
    pub(super) reach: &'a [usize],
    pub(super) lines: Range<usize>,
    pub(super) x: &'a mut [R],
}

impl<R: Real, const FORWARD: bool> LaneWork<R> for Solution<'_, R, FORWARD> {
    type Output = usize;
    const HEAVY: bool = true;

    #[inline(always)]
    fn run<L: Lanes<R>>(self) -> usize {
        let Self {
            ldlt,
            reach,
            lines,
            x,
        } = self;
        let mut j = if FORWARD { 0 } else { lines.end };
        while j < lines.end {
            let count = usize::from(ldlt.counts[j]);
            match count {
                PANEL => ldlt.forward::<L, PANEL>(j, reach[j], x),
                2 => ldlt.forward::<L, 2>(j, reach[j], x),
                _ => ldlt.forward::<L, 1>(j, reach[j], x),
            }
            j += count;
        }
        let far = ahead::far(&ldlt.columns);
        while j > lines.start {
            let count = usize::from(ldlt.counts[j - 1]);
            j -= count;
            if far && let Some(soon) = j.checked_sub(ahead::COLUMNS) {
                ahead::fetch(&ldlt.columns[ldlt.starts[soon]..ldlt.starts[soon + count]]);
            }
            match count {
                PANEL => ldlt.backward::<L, PANEL>(j, reach[j], x),
                2 => ldlt.backward::<L, 2>(j, reach[j], x),
                _ => ldlt.backward::<L, 1>(j, reach[j], x),
            }
        }
        j
    }
}
