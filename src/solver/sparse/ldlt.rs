//! Factorisation `L D L^T` by groups of unknowns, without pivoting: each group's panel is
//! eliminated and updates the panels of the groups below it, whose places were found before.

use std::sync::Arc;

use super::{Pattern, SparseMatrix};
use crate::error::{Error, Result};
use crate::scalar::Real;
use crate::solver::Tape;
use crate::solver::band::{GROWTH, NOISE};

#[derive(Debug, Clone)]
pub(in crate::solver) struct SparseLdlt<R> {
    pattern: Arc<Pattern>,
    values: Vec<R>,
    /// Reciprocals of the pivots, by unknown.
    inverse: Vec<R>,
    /// Columns of the present panel before division by their pivots.
    columns: Vec<R>,
    stride: usize,
    /// Sum of the magnitudes of all terms of a diagonal entry, by unknown.
    magnitude: Vec<f64>,
    /// Largest magnitude in each row of the matrix, by unknown.
    largest: Vec<f64>,
    negative: usize,
}

impl<R: Real> SparseLdlt<R> {
    pub(in crate::solver) fn new(pattern: &Arc<Pattern>) -> Self {
        let columns = &pattern.columns;
        let stride = columns.iter().map(|c| c.height).max().unwrap_or(0);
        let width = columns.iter().map(|c| c.width()).max().unwrap_or(0);
        let size = pattern.size();
        Self {
            pattern: pattern.clone(),
            values: vec![R::zero(); pattern.values],
            inverse: vec![R::zero(); size],
            columns: vec![R::zero(); stride * width],
            stride,
            magnitude: vec![0.0; size],
            largest: vec![0.0; size],
            negative: 0,
        }
    }

    pub(in crate::solver) fn negative(&self) -> usize {
        self.negative
    }

    pub(in crate::solver) fn history(&mut self, tape: &mut Tape<R>) -> Result<()> {
        tape.count(&mut self.negative)?;
        tape.numbers(&mut self.values)?;
        tape.numbers(&mut self.inverse)
    }

    /// Whether the matrix could be factorised stably; if not, it needs pivoting.
    pub(in crate::solver) fn factor(&mut self, matrix: &SparseMatrix<R>) -> Result<bool> {
        self.values.copy_from_slice(&matrix.values);
        self.negative = 0;
        self.largest.fill(0.0);
        let (largest, magnitude) = (&mut self.largest, &mut self.magnitude);
        matrix.each(|i, j, a| {
            let size = a.value().abs();
            largest[i] = largest[i].max(size);
            largest[j] = largest[j].max(size);
            if i == j {
                magnitude[i] = size;
            }
        });
        for g in 0..self.pattern.columns.len() {
            if !self.eliminate(g)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn eliminate(&mut self, g: usize) -> Result<bool> {
        let pattern = &*self.pattern;
        let column = &pattern.columns[g];
        let (width, stride) = (column.width(), self.stride);
        let end = column.start + column.height * width;
        let (before, after) = self.values.split_at_mut(end);
        let panel = &mut before[column.start..];
        let first = column.unknowns.start;
        for (r, row) in panel[..width * width].chunks_exact_mut(width).enumerate() {
            let i = first + r;
            for p in 0..r {
                let (terms, inverse) = (&self.columns[p * stride..], self.inverse[first + p]);
                let (entry, l) = eliminated(&mut row[p..r], &terms[p + 1..r], inverse);
                // The last term is the square of this entry, which is not in its column yet.
                row[r] -= entry * l;
                self.columns[p * stride + r] = entry;
                self.magnitude[i] += (entry * l).value().abs();
            }
            let (pivot, d) = (row[r], row[r].value());
            if !pivot.finite() {
                return Err(Error::NotFinite {
                    what: "a pivot of the matrix to factorise",
                    value: d,
                });
            }
            let terms = self.magnitude[i];
            let noise = d.abs() <= NOISE * R::EPSILON * terms;
            if noise || terms > GROWTH * self.largest[i] {
                return Ok(false);
            }
            self.negative += usize::from(d < 0.0);
            self.inverse[i] = R::one() / pivot;
        }
        for (below, at) in &column.below {
            for (i, r) in pattern.columns[*below].unknowns.clone().zip(*at..) {
                let row = &mut panel[r * width..(r + 1) * width];
                for p in 0..width {
                    let (terms, inverse) = (&self.columns[p * stride..], self.inverse[first + p]);
                    let (entry, l) = eliminated(&mut row[p..], &terms[p + 1..width], inverse);
                    self.columns[p * stride + r] = entry;
                    self.magnitude[i] += (entry * l).value().abs();
                }
            }
        }
        let mut targets = column.targets.iter();
        for (a, (below, at)) in column.below.iter().enumerate() {
            let count = pattern.columns[*below].width();
            for (other, from) in &column.below[..=a] {
                let Some(target) = targets.next() else {
                    continue;
                };
                let breadth = pattern.columns[*other].width();
                let block = &mut after[target - end..][..count * breadth];
                for (r, row) in block.chunks_exact_mut(breadth).enumerate() {
                    let l = &panel[(at + r) * width..(at + r + 1) * width];
                    let terms = &self.columns[*from..];
                    let mut p = 0;
                    while p + 4 <= width {
                        let c: [&[R]; 4] =
                            std::array::from_fn(|k| &terms[(p + k) * stride..][..breadth]);
                        for (k, t) in row.iter_mut().enumerate() {
                            *t -= (l[p] * c[0][k] + l[p + 1] * c[1][k])
                                + (l[p + 2] * c[2][k] + l[p + 3] * c[3][k]);
                        }
                        p += 4;
                    }
                    while p < width {
                        let c = &terms[p * stride..][..breadth];
                        for (t, c) in row.iter_mut().zip(c) {
                            *t -= l[p] * *c;
                        }
                        p += 1;
                    }
                }
            }
        }
        Ok(true)
    }

    pub(in crate::solver) fn solve(&self, x: &mut [R]) {
        let columns = &self.pattern.columns;
        let rows = |g: usize| {
            let column = &columns[g];
            let below = column.below.iter();
            let below = below.flat_map(|(h, _)| columns[*h].unknowns.clone());
            let values = self.values[column.start..][..column.height * column.width()]
                .chunks_exact(column.width());
            column.unknowns.clone().chain(below).zip(values)
        };
        for g in 0..columns.len() {
            let first = columns[g].unknowns.start;
            for (i, row) in rows(g) {
                let mut sum = x[i];
                // In the group itself L is a triangle.
                let count = match columns[g].unknowns.contains(&i) {
                    true => i - first,
                    false => row.len(),
                };
                for (l, x) in row[..count].iter().zip(&x[first..]) {
                    sum -= *l * *x;
                }
                x[i] = sum;
            }
        }
        for (x, inverse) in x.iter_mut().zip(&self.inverse) {
            *x *= *inverse;
        }
        for g in (0..columns.len()).rev() {
            let (first, width) = (columns[g].unknowns.start, columns[g].width());
            for (i, row) in rows(g).skip(width) {
                let value = x[i];
                for (l, x) in row.iter().zip(&mut x[first..]) {
                    *x -= *l * value;
                }
            }
            let triangle = &self.values[columns[g].start..];
            for r in (0..width).rev() {
                let value = x[first + r];
                for p in 0..r {
                    x[first + p] -= triangle[r * width + p] * value;
                }
            }
        }
    }
}

/// Eliminates the first entry of a row and updates those after it that `terms`, the rest of the
/// pivot's column, cover. Returns the entry before and after division by the pivot.
#[inline(always)]
fn eliminated<R: Real>(row: &mut [R], terms: &[R], inverse: R) -> (R, R) {
    let entry = row[0];
    let l = entry * inverse;
    row[0] = l;
    for (t, c) in row[1..].iter_mut().zip(terms) {
        *t -= l * *c;
    }
    (entry, l)
}
