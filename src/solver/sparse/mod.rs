//! Direct solution of the symmetric systems of trees, loops and grids of beams, whose envelope
//! would be mostly zeros. Unknowns that couple alike (a node's) are eliminated together, so that
//! the work is done on small dense blocks by contiguous rows, in any [`Real`].

mod ldlt;
mod pattern;

pub(super) use ldlt::SparseLdlt;
pub(crate) use pattern::Pattern;

use std::sync::Arc;

use num_traits::Signed;

use super::band::BandMatrix;
use crate::error::{Error, Result};
use crate::scalar::Real;

/// Symmetric matrix with room for its factor: panels of rows, one for each group of unknowns.
#[derive(Debug, Clone)]
pub(super) struct SparseMatrix<R> {
    pattern: Arc<Pattern>,
    values: Vec<R>,
}

impl<R: Real> SparseMatrix<R> {
    pub(super) fn zero(pattern: &Arc<Pattern>) -> Self {
        Self {
            pattern: pattern.clone(),
            values: vec![R::zero(); pattern.values],
        }
    }

    pub(super) fn clear(&mut self) {
        self.values.fill(R::zero());
    }

    /// Where an entry is stored; none for entries outside the pattern.
    fn index(&self, i: usize, j: usize) -> Option<usize> {
        let pattern = &*self.pattern;
        let (g, h) = (*pattern.group.get(i)?, *pattern.group.get(j)?);
        let ((row, g), (column, h)) = if (g, i) < (h, j) {
            ((j, h), (i, g))
        } else {
            ((i, g), (j, h))
        };
        let start = pattern.block(g, h)?;
        let (rows, columns) = (&pattern.columns[g], &pattern.columns[h]);
        let place = (row - rows.unknowns.start) * columns.width();
        Some(start + place + column - columns.unknowns.start)
    }

    pub(super) fn get(&self, i: usize, j: usize) -> R {
        self.index(i, j).map_or(R::zero(), |at| self.values[at])
    }

    /// Adds to an entry of the lower triangle in the numbering of the unknowns; those above it are
    /// ignored.
    #[inline]
    pub(super) fn add(&mut self, i: usize, j: usize, value: R) -> Result<()> {
        let Some(at) = self.index(i, j) else {
            return Err(Error::OutsideProfile { row: i, column: j });
        };
        if j <= i {
            self.values[at] += value;
        }
        Ok(())
    }

    /// Adds the full matrix of an element with `n` unknowns from `offset` on, block by block.
    pub(super) fn add_block(&mut self, offset: usize, n: usize, block: &[R]) -> Result<()> {
        let outside = |row, column| Error::OutsideProfile { row, column };
        Error::check_length("element matrix", block.len(), n * n)?;
        let pattern = &*self.pattern;
        let end = offset + n;
        if end > pattern.size() {
            return Err(outside(end - 1, offset));
        }
        let mut i = offset;
        while i < end {
            let g = pattern.group[i];
            let rows = i..pattern.columns[g].unknowns.end.min(end);
            let mut j = offset;
            while j < end {
                let h = pattern.group[j];
                let columns = j..pattern.columns[h].unknowns.end.min(end);
                j = columns.end;
                if g < h {
                    continue;
                }
                let start = pattern.block(g, h).ok_or(outside(i, columns.start))?;
                let width = pattern.columns[h].width();
                let (first_row, first_column) = (
                    pattern.columns[g].unknowns.start,
                    pattern.columns[h].unknowns.start,
                );
                for row in rows.clone() {
                    // Of the diagonal block only the lower triangle is kept.
                    let last = if g == h { row + 1 } else { columns.end };
                    let to = start + (row - first_row) * width + columns.start - first_column;
                    let from = (row - offset) * n + columns.start - offset;
                    let count = last - columns.start;
                    let target = &mut self.values[to..to + count];
                    for (t, s) in target.iter_mut().zip(&block[from..from + count]) {
                        *t += *s;
                    }
                }
            }
            i = rows.end;
        }
        Ok(())
    }

    pub(super) fn scale_add(&mut self, alpha: R, other: &Self) -> Result<()> {
        Error::check_length("values of a matrix", other.values.len(), self.values.len())?;
        for (a, b) in self.values.iter_mut().zip(&other.values) {
            *a += alpha * *b;
        }
        Ok(())
    }

    pub(super) fn copy_from(&mut self, other: &Self) -> Result<()> {
        Error::check_length("values of a matrix", other.values.len(), self.values.len())?;
        self.values.copy_from_slice(&other.values);
        Ok(())
    }

    /// Calls `see` for every stored entry with its row and column, the diagonal and one triangle.
    fn each(&self, mut see: impl FnMut(usize, usize, R)) {
        for column in &self.pattern.columns {
            let width = column.width();
            let mut rows = self.values[column.start..][..column.height * width].chunks_exact(width);
            let below = column.below.iter();
            let below = below.flat_map(|(g, _)| self.pattern.columns[*g].unknowns.clone());
            for (r, i) in column.unknowns.clone().chain(below).enumerate() {
                let row = rows.next().unwrap_or(&[]);
                let count = if r < width { r + 1 } else { width };
                for (j, value) in column.unknowns.clone().zip(&row[..count]) {
                    see(i, j, *value);
                }
            }
        }
    }

    pub(super) fn product(&self, x: &[R], y: &mut [R], absolute: bool) -> Result<()> {
        let size = self.pattern.size();
        Error::check_length("vector to multiply", x.len(), size)?;
        Error::check_length("product", y.len(), size)?;
        let map = |a: R| if absolute { Signed::abs(&a) } else { a };
        y.fill(R::zero());
        self.each(|i, j, a| {
            y[i] += map(a) * map(x[j]);
            if i != j {
                y[j] += map(a) * map(x[i]);
            }
        });
        Ok(())
    }

    /// Writes the matrix into an envelope.
    pub(super) fn copy_to(&self, band: &mut BandMatrix<R>) -> Result<()> {
        band.clear();
        let mut result = Ok(());
        self.each(|i, j, a| {
            // Fill that is zero may lie outside the envelope.
            if result.is_ok() && !a.is_zero() {
                result = band.add(i.max(j), i.min(j), a);
            }
        });
        result
    }
}
