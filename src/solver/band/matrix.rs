//! Storage of matrices inside the envelope, allocated once and refilled at every step, with the
//! few operations that assembly, supports and residuals need.

use std::ops::Add;

use num_traits::Signed;

use super::aligned::Aligned;
use super::blocks::SUMS;
use super::columns::{column_starts, panels};
use super::lines::Lines;
use super::{Profile, ahead};
use crate::error::{Error, Result};
use crate::scalar::{Loops, Real};

/// Square matrix whose entries outside the envelope of a [`Profile`] are zero.
///
/// A general matrix is stored by rows, row `i` from column `i - half_bandwidth` to
/// `i + half_bandwidth`; a symmetric one by the columns of its lower triangle, each from the diagonal
/// as far as it reaches, with room between them: its factors are formed in the same storage, by
/// registers. No method but the constructors allocates.
///
/// Clearing costs nothing: such a line is filled with zeros when something is added to it or behind
/// it, so that long matrices go through the cache once where they are assembled in order.
#[derive(Debug, Clone)]
pub struct BandMatrix<R> {
    profile: Profile,
    symmetric: bool,
    /// Where each line starts, and where the last ends.
    starts: Vec<usize>,
    /// Lines one after another. Behind each column of a symmetric matrix are zeros, and behind these what
    /// lies above the diagonal of the next, where registers of a factorisation leave anything.
    data: Aligned<R>,
    /// Lines from this one on are zero, whatever `data` holds.
    written: usize,
    /// The longest line of zeros.
    zeros: Vec<R>,
}

impl<R: Real> BandMatrix<R> {
    /// Zero matrix that stores its lower triangle only.
    #[must_use]
    pub fn symmetric(profile: &Profile) -> Self {
        Self::zero(profile, true, column_starts::<R>(&panels::<R>(profile)))
    }

    /// Zero matrix that stores both triangles.
    #[must_use]
    pub fn general(profile: &Profile) -> Self {
        let width = 2 * profile.half_bandwidth() + 1;
        let starts = (0..=profile.size()).map(|line| line * width);
        Self::zero(profile, false, starts.collect())
    }

    fn zero(profile: &Profile, symmetric: bool, starts: Vec<usize>) -> Self {
        let longest = starts.windows(2).map(|ends| ends[1] - ends[0]).max();
        Self {
            profile: profile.clone(),
            symmetric,
            data: Aligned::zero(starts[profile.size()]),
            written: profile.size(),
            zeros: vec![R::zero(); longest.unwrap_or(0)],
            starts,
        }
    }

    /// The envelope.
    #[must_use]
    pub fn profile(&self) -> &Profile {
        &self.profile
    }

    /// Number of rows.
    #[must_use]
    pub fn size(&self) -> usize {
        self.profile.size()
    }

    /// Whether only the lower triangle is stored.
    #[must_use]
    pub fn is_symmetric(&self) -> bool {
        self.symmetric
    }

    /// Where entry `(i, j)` is stored; of a symmetric matrix one of the lower triangle.
    #[inline(always)]
    fn index(&self, i: usize, j: usize) -> usize {
        match self.symmetric {
            true => self.starts[j] + i - j,
            false => self.starts[i] + self.profile.half_bandwidth() + j - i,
        }
    }

    /// The entries of row `i` inside the envelope and the column of the first of them: all of them
    /// in a general matrix, those from the diagonal on in a symmetric one.
    #[inline(always)]
    #[must_use]
    pub fn row(&self, i: usize) -> (usize, &[R]) {
        let first = match self.symmetric {
            true => i,
            false => self.profile.first()[i],
        };
        // From the diagonal on, a row is the column below.
        let start = match self.symmetric {
            true => 0,
            false => self.profile.half_bandwidth() + first - i,
        };
        (
            first,
            &self.line(i)[start..=start + self.profile.reach()[i] - first],
        )
    }

    #[inline(always)]
    pub(super) fn diagonal(&self, i: usize) -> R {
        match self.symmetric {
            true => self.line(i)[0],
            false => self.line(i)[self.profile.half_bandwidth()],
        }
    }

    /// What is stored of row `i`, or of column `i` of a symmetric matrix, and what lies
    /// behind it.
    #[inline(always)]
    pub(super) fn line(&self, i: usize) -> &[R] {
        match i < self.written {
            true => &self.data[self.starts[i]..self.starts[i + 1]],
            false => &self.zeros,
        }
    }

    /// Has all lines up to this one written.
    #[inline(always)]
    pub(super) fn write_up_to(&mut self, line: usize) {
        if line >= self.written {
            self.lines(line + 1).write_up_to(line);
        }
    }

    /// Sets every entry to zero.
    pub fn clear(&mut self) {
        self.written = 0;
    }

    /// Where each line starts, and where the last ends.
    pub(super) fn starts(&self) -> &[usize] {
        &self.starts
    }

    /// Exchanges the storage for that of factors.
    pub(super) fn exchange(&mut self, columns: &mut Aligned<R>) {
        std::mem::swap(&mut self.data, columns);
    }

    /// Entry `(i, j)`; zero outside the envelope.
    #[must_use]
    pub fn get(&self, i: usize, j: usize) -> R {
        if !self.profile.contains(i, j) {
            return R::zero();
        }
        match self.symmetric {
            true => self.line(i.min(j))[i.abs_diff(j)],
            false => self.line(i)[self.profile.half_bandwidth() + j - i],
        }
    }

    /// The largest magnitude in row `i`.
    pub(super) fn largest_of_row(&self, i: usize) -> R {
        let (_, row) = self.row(i);
        let right = row.iter().map(|a| a.abs()).fold(R::zero(), R::larger);
        let first = self.profile.first()[i];
        (first..i)
            .map(|k| self.get(i, k).abs())
            .fold(right, R::larger)
    }

    /// Adds `value` to entry `(i, j)`. In a symmetric matrix an entry of the strict upper
    /// triangle is ignored, so that whole element matrices can be added entry by entry.
    ///
    /// # Errors
    /// [`Error::OutsideProfile`] for an entry that the envelope does not hold.
    #[inline]
    pub fn add(&mut self, i: usize, j: usize, value: R) -> Result<()> {
        self.profile.check_holds(i, j)?;
        if !self.symmetric || j <= i {
            self.write_up_to(if self.symmetric { j } else { i });
            let index = self.index(i, j);
            self.data[index] += value;
        }
        Ok(())
    }

    /// Adds `factor` times a row that couples vectors of `n` unknowns component by component, and its
    /// mirror image: the vector from unknown `p` on with those from unknown `q >= p` on.
    pub(in crate::solver) fn add_alike(
        &mut self,
        p: usize,
        q: usize,
        n: usize,
        factor: R,
        row: &[R],
    ) -> Result<()> {
        let last = q + n * row.len() - 1;
        self.profile.check_holds(last, p)?;
        self.write_up_to(if self.symmetric { p + n - 1 } else { last });
        for (t, m) in row.iter().enumerate() {
            // Sections about their centroid couple positions with no slope across.
            if m.is_nothing() {
                continue;
            }
            for c in 0..n {
                let (i, j) = (q + t * n + c, p + c);
                let entry = self.index(i, j);
                self.data[entry] += factor * *m;
                if !self.symmetric && i != j {
                    let mirrored = self.index(j, i);
                    self.data[mirrored] += factor * *m;
                }
            }
        }
        Ok(())
    }

    /// Adds the matrix of an element whose `n` unknowns are numbered consecutively from
    /// `offset`.
    ///
    /// `block` is row-major and either full (`n * n` entries, of which a symmetric matrix reads
    /// the upper triangle) or the lower triangle alone, row after row without gaps
    /// (`n * (n + 1) / 2` entries, mirrored in a general matrix).
    ///
    /// # Errors
    /// [`Error::OutsideProfile`] if the envelope does not hold the block, [`Error::Length`] if
    /// `block` has neither of the two lengths.
    pub fn add_block(&mut self, offset: usize, n: usize, block: &[R]) -> Result<()> {
        if n == 0 {
            return Ok(());
        }
        self.profile.check_holds(offset + n - 1, offset)?;
        self.write_up_to(offset + n - 1);
        let full = block.len() == n * n;
        if !full {
            Error::check_length("element matrix", block.len(), n * (n + 1) / 2)?;
        }
        if full {
            for i in 0..n {
                let from = if self.symmetric { i } else { 0 };
                let target = match self.symmetric {
                    true => self.index(offset + i, offset + i),
                    false => self.index(offset + i, offset),
                };
                let source = &block[i * n + from..(i + 1) * n];
                for (t, s) in self.data[target..].iter_mut().zip(source) {
                    *t += *s;
                }
            }
            return Ok(());
        }
        for i in 0..n {
            for j in 0..=i {
                let value = block[i * (i + 1) / 2 + j];
                let index = self.index(offset + i, offset + j);
                self.data[index] += value;
                if !self.symmetric && j < i {
                    let mirrored = self.index(offset + j, offset + i);
                    self.data[mirrored] += value;
                }
            }
        }
        Ok(())
    }

    /// Adds `values` to the entries of row `i` from column `first` on; in a symmetric matrix those
    /// left of the diagonal are ignored.
    pub(in crate::solver) fn add_row(
        &mut self,
        i: usize,
        first: usize,
        values: &[R],
    ) -> Result<()> {
        let skipped = match self.symmetric {
            true => i.saturating_sub(first).min(values.len()),
            false => 0,
        };
        let (first, values) = (first + skipped, &values[skipped..]);
        let Some(last) = (first + values.len())
            .checked_sub(1)
            .filter(|_| !values.is_empty())
        else {
            return Ok(());
        };
        for column in [first, last] {
            self.profile.check_holds(i, column)?;
        }
        self.write_up_to(i);
        // Right of the diagonal, a row is the column below.
        let start = match self.symmetric {
            true => self.index(first, i),
            false => self.index(i, first),
        };
        for (entry, value) in self.data[start..].iter_mut().zip(values) {
            *entry += *value;
        }
        Ok(())
    }

    /// The lines before `end`, to be written by parts.
    pub(in crate::solver) fn lines(&mut self, end: usize) -> Lines<'_, R> {
        let fresh = self.starts[self.written.min(end)]..self.starts[end];
        let fetching = ahead::far(&self.data[fresh]);
        Lines {
            profile: &self.profile,
            symmetric: self.symmetric,
            starts: &self.starts,
            lines: 0..end,
            data: &mut self.data[..self.starts[end]],
            written: self.written,
            fetching,
            whole: Some(&mut self.written),
        }
    }

    /// All lines.
    #[inline(always)]
    pub(in crate::solver) fn all_lines(&mut self) -> Lines<'_, R> {
        self.lines(self.size())
    }

    /// `y = A x`.
    ///
    /// # Errors
    /// [`Error::Length`] if `x` or `y` is not as long as the matrix.
    pub fn mul_vec(&self, x: &[R], y: &mut [R]) -> Result<()> {
        self.product(x, y, |a| a)
    }

    /// `y_i = sum_j |a_ij| |x_j|`: times the rounding unit, this is how far rounding moves
    /// [`mul_vec`](Self::mul_vec), and the floor below which no residual can be driven.
    ///
    /// # Errors
    /// [`Error::Length`] if `x` or `y` is not as long as the matrix.
    pub fn abs_mul_vec(&self, x: &[R], y: &mut [R]) -> Result<()> {
        self.product(x, y, |a| Signed::abs(&a))
    }

    #[inline(always)]
    fn product(&self, x: &[R], y: &mut [R], map: impl Fn(R) -> R) -> Result<()> {
        Error::check_length("vector to multiply", x.len(), self.size())?;
        Error::check_length("product", y.len(), self.size())?;
        R::dispatch(Loops(
            #[inline(always)]
            || {
                y.fill(R::zero());
                for i in 0..self.size() {
                    let (first, row) = self.row(i);
                    // Partial sums, which registers hold side by side.
                    let mut sums = [R::zero(); SUMS];
                    let x_of = &x[first..first + row.len()];
                    let (whole, rest) = row.as_chunks::<SUMS>();
                    let (x_whole, x_rest) = x_of.as_chunks::<SUMS>();
                    for (row, x) in whole.iter().zip(x_whole) {
                        for k in 0..SUMS {
                            sums[k] += map(row[k]) * map(x[k]);
                        }
                    }
                    for (sum, (a, x)) in sums.iter_mut().zip(rest.iter().zip(x_rest)) {
                        *sum += map(*a) * map(*x);
                    }
                    let sum = sums.into_iter().fold(R::zero(), Add::add);
                    y[i] += sum;
                    if self.symmetric {
                        let own = map(x[i]);
                        for (a, y) in row.iter().zip(&mut y[i..]).skip(1) {
                            *y += map(*a) * own;
                        }
                    }
                }
            },
        ));
        Ok(())
    }

    /// Overwrites this matrix by `other`.
    ///
    /// # Errors
    /// [`Error::Length`] or [`Error::Unsupported`] unless both have the same profile and store
    /// the same triangles.
    pub fn copy_from(&mut self, other: &Self) -> Result<()> {
        self.check_alike(other)?;
        let written = self.starts[other.written];
        self.data[..written].copy_from_slice(&other.data[..written]);
        self.written = other.written;
        Ok(())
    }

    /// Adds `alpha * other`.
    ///
    /// # Errors
    /// [`Error::Length`] or [`Error::Unsupported`] unless both have the same profile and store
    /// the same triangles.
    pub fn scale_add(&mut self, alpha: R, other: &Self) -> Result<()> {
        self.check_alike(other)?;
        if let Some(last) = other.written.checked_sub(1) {
            self.write_up_to(last);
        }
        let written = self.starts[other.written];
        for (a, b) in self.data.iter_mut().zip(&other.data[..written]) {
            *a += alpha * *b;
        }
        Ok(())
    }

    fn check_alike(&self, other: &Self) -> Result<()> {
        self.profile.check_same(&other.profile)?;
        if self.symmetric == other.symmetric {
            return Ok(());
        }
        Err(Error::Unsupported {
            what: "mixing a symmetric and a general matrix".into(),
            remedy: "construct both with `symmetric` or both with `general`",
        })
    }
}
