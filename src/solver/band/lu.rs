//! Band LU with partial pivoting: the path of general matrices and the fallback for symmetric
//! ones that elimination without pivoting cannot factorise stably. Rows and columns are first
//! equilibrated, because stiffnesses and constraint coefficients differ by many powers of ten
//! and the choice of a pivot compares them.

use super::{BandMatrix, Profile};
use crate::error::{Error, Result};
use crate::scalar::Real;
use crate::solver::Tape;

/// Rounding units, relative to the equilibrated matrix, below which a pivot is taken for zero.
const NOISE: f64 = 4.0;

#[derive(Debug, Clone)]
pub(super) struct Lu<R> {
    /// Row `i` holds the columns from `i - half` to `i + 2 half`: interchanges widen the upper
    /// triangle by up to `half`.
    rows: Vec<R>,
    width: usize,
    half: usize,
    /// Multipliers of pivot `j`, contiguous from `j * half`.
    multipliers: Vec<R>,
    inverse: Vec<R>,
    /// Row interchanged with row `j`.
    swapped: Vec<usize>,
    /// Last column of row `j` of the upper factor.
    upper_end: Vec<usize>,
    row_scale: Vec<R>,
    column_scale: Vec<R>,
    /// Whether the determinant is negative.
    negative: bool,
}

impl<R: Real> Lu<R> {
    pub(super) fn new(profile: &Profile) -> Self {
        let (size, half) = (profile.size(), profile.half_bandwidth());
        let width = 3 * half + 1;
        Self {
            rows: vec![R::zero(); size * width],
            width,
            half,
            multipliers: vec![R::zero(); size * half],
            inverse: vec![R::zero(); size],
            swapped: vec![0; size],
            upper_end: vec![0; size],
            row_scale: vec![R::zero(); size],
            column_scale: vec![R::zero(); size],
            negative: false,
        }
    }

    #[inline(always)]
    fn index(&self, i: usize, j: usize) -> usize {
        i * self.width + self.half + j - i
    }

    pub(super) fn factor(&mut self, profile: &Profile, matrix: &BandMatrix<R>) -> Result<()> {
        self.fetch(profile, matrix)?;
        let (size, reach) = (profile.size(), profile.reach());
        let mut end = 0;
        self.negative = false;
        for j in 0..size {
            let last = reach[j];
            let (mut chosen, mut largest) = (j, R::zero());
            for i in j..=last {
                let entry = self.rows[self.index(i, j)];
                let magnitude = if entry < R::zero() { -entry } else { entry };
                if magnitude > largest {
                    (chosen, largest) = (i, magnitude);
                }
            }
            let pivot = self.rows[self.index(chosen, j)];
            if !pivot.finite() {
                return Err(not_finite(pivot));
            }
            if largest.value() <= NOISE * R::EPSILON {
                // A NaN is never the largest: do not mistake it for a zero.
                for i in j..=last {
                    let entry = self.rows[self.index(i, j)];
                    if !entry.finite() {
                        return Err(not_finite(entry));
                    }
                }
                return Err(Error::Singular {
                    unknown: j,
                    pivot: (pivot / (self.row_scale[chosen] * self.column_scale[j])).value(),
                });
            }
            end = end.max(reach[chosen]);
            // Every interchange turns the sign; the scales are positive.
            self.negative ^= (pivot < R::zero()) != (chosen != j);
            self.swapped[j] = chosen;
            self.upper_end[j] = end;
            let count = end + 1 - j;
            let pivot_start = self.index(j, j);
            let (upper, lower) = self.rows.split_at_mut((j + 1) * self.width);
            let pivot_row = &mut upper[pivot_start..pivot_start + count];
            let at = |i: usize| (i - j - 1) * self.width + self.half + j - i;
            if chosen != j {
                pivot_row.swap_with_slice(&mut lower[at(chosen)..at(chosen) + count]);
            }
            let inverse = R::one() / pivot;
            self.inverse[j] = inverse;
            for i in j + 1..=last {
                let row = &mut lower[at(i)..at(i) + count];
                let multiplier = row[0] * inverse;
                self.multipliers[j * self.half + i - j - 1] = multiplier;
                for (a, u) in row[1..].iter_mut().zip(&pivot_row[1..]) {
                    *a -= multiplier * *u;
                }
            }
        }
        Ok(())
    }

    /// Copies the equilibrated matrix into the workspace, both triangles. The scales are powers
    /// of two, so that no rounding enters.
    fn fetch(&mut self, profile: &Profile, matrix: &BandMatrix<R>) -> Result<()> {
        let (first, reach) = (profile.first(), profile.reach());
        self.rows.fill(R::zero());
        for i in 0..profile.size() {
            let (start, row) = matrix.row(i);
            let target = self.index(i, start);
            self.rows[target..target + row.len()].copy_from_slice(row);
            if matrix.is_symmetric() {
                for (j, entry) in (start..).zip(row).skip(1) {
                    let mirrored = self.index(j, i);
                    self.rows[mirrored] = *entry;
                }
            }
        }
        for i in 0..profile.size() {
            let range = self.index(i, first[i])..=self.index(i, reach[i]);
            let largest = largest(self.rows[range].iter().copied())?;
            self.row_scale[i] = scale(largest, i)?;
        }
        for j in 0..profile.size() {
            let column =
                (first[j]..=reach[j]).map(|i| self.rows[self.index(i, j)] * self.row_scale[i]);
            self.column_scale[j] = scale(largest(column)?, j)?;
        }
        for i in 0..profile.size() {
            for j in first[i]..=reach[i] {
                let index = self.index(i, j);
                self.rows[index] = self.rows[index] * self.row_scale[i] * self.column_scale[j];
            }
        }
        Ok(())
    }

    /// Whether the determinant of the last matrix is negative.
    pub(super) fn negative(&self) -> bool {
        self.negative
    }

    pub(super) fn history(&mut self, tape: &mut Tape<R>) -> Result<()> {
        tape.flag(&mut self.negative)?;
        for numbers in [
            &mut self.rows,
            &mut self.multipliers,
            &mut self.inverse,
            &mut self.row_scale,
            &mut self.column_scale,
        ] {
            tape.numbers(numbers)?;
        }
        let last = self.inverse.len().saturating_sub(1);
        let indices = self.swapped.iter_mut().zip(&mut self.upper_end);
        indices.enumerate().try_for_each(|(j, (swapped, end))| {
            tape.index(swapped, j..=last)?;
            tape.index(end, j..=last)
        })
    }

    pub(super) fn solve(&mut self, profile: &Profile, x: &mut [R]) {
        let reach = profile.reach();
        for (x, scale) in x.iter_mut().zip(&self.row_scale) {
            *x *= *scale;
        }
        for j in 0..x.len() {
            x.swap(j, self.swapped[j]);
            let value = x[j];
            let count = reach[j] - j;
            let multipliers = &self.multipliers[j * self.half..j * self.half + count];
            for (x, l) in x[j + 1..].iter_mut().zip(multipliers) {
                *x -= *l * value;
            }
        }
        for j in (0..x.len()).rev() {
            let end = self.upper_end[j];
            let row = &self.rows[self.index(j, j)..=self.index(j, end)];
            let mut sum = x[j];
            for (u, x) in row[1..].iter().zip(&x[j + 1..=end]) {
                sum -= *u * *x;
            }
            x[j] = sum * self.inverse[j];
        }
        for (x, scale) in x.iter_mut().zip(&self.column_scale) {
            *x *= *scale;
        }
    }
}

impl<R: Real> Lu<R> {
    /// Replaces `x` by the solution of the transposed system.
    pub(super) fn solve_transposed(&self, profile: &Profile, x: &mut [R]) {
        let reach = profile.reach();
        for (x, scale) in x.iter_mut().zip(&self.column_scale) {
            *x *= *scale;
        }
        for j in 0..x.len() {
            let value = x[j] * self.inverse[j];
            x[j] = value;
            let end = self.upper_end[j];
            let row = &self.rows[self.index(j, j)..=self.index(j, end)];
            for (x, u) in x[j + 1..=end].iter_mut().zip(&row[1..]) {
                *x -= *u * value;
            }
        }
        for j in (0..x.len()).rev() {
            let count = reach[j] - j;
            let multipliers = &self.multipliers[j * self.half..j * self.half + count];
            let mut sum = x[j];
            for (l, x) in multipliers.iter().zip(&x[j + 1..]) {
                sum -= *l * *x;
            }
            x[j] = sum;
            x.swap(j, self.swapped[j]);
        }
        for (x, scale) in x.iter_mut().zip(&self.row_scale) {
            *x *= *scale;
        }
    }
}

fn not_finite<R: Real>(entry: R) -> Error {
    Error::NotFinite {
        what: "an entry of the matrix to factorise",
        value: entry.value(),
    }
}

/// Largest magnitude, refusing what is not finite.
fn largest<R: Real>(entries: impl Iterator<Item = R>) -> Result<f64> {
    let mut largest = 0.0_f64;
    for entry in entries {
        if !entry.finite() {
            return Err(not_finite(entry));
        }
        largest = largest.max(entry.value().abs());
    }
    Ok(largest)
}

/// Power of two that brings `largest` into 1..=2.
fn scale<R: Real>(largest: f64, unknown: usize) -> Result<R> {
    if largest == 0.0 {
        return Err(Error::Singular {
            unknown,
            pivot: 0.0,
        });
    }
    Ok(R::lit((-largest.log2().floor()).exp2()))
}
