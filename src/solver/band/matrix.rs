//! Storage of matrices inside the envelope, allocated once and refilled at every step, with the
//! few operations that assembly, supports and residuals need.

use num_traits::Signed;

use super::Profile;
use crate::error::{Error, Result};
use crate::scalar::{Lanes, Real};

/// Square matrix whose entries outside the envelope of a [`Profile`] are zero.
///
/// Row-major: row `i` holds the columns from `i - half_bandwidth` on, up to the diagonal in a
/// symmetric matrix and up to `i + half_bandwidth` in a general one. No method but the
/// constructors allocates.
#[derive(Debug, Clone)]
pub struct BandMatrix<R> {
    profile: Profile,
    symmetric: bool,
    width: usize,
    data: Vec<R>,
}

impl<R: Real> BandMatrix<R> {
    /// Zero matrix that stores its lower triangle only.
    #[must_use]
    pub fn symmetric(profile: &Profile) -> Self {
        Self::zero(profile, true, profile.half_bandwidth() + 1)
    }

    /// Zero matrix that stores both triangles.
    #[must_use]
    pub fn general(profile: &Profile) -> Self {
        Self::zero(profile, false, 2 * profile.half_bandwidth() + 1)
    }

    fn zero(profile: &Profile, symmetric: bool, width: usize) -> Self {
        Self {
            profile: profile.clone(),
            symmetric,
            width,
            data: vec![R::zero(); profile.size() * width],
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

    #[inline(always)]
    fn index(&self, i: usize, j: usize) -> usize {
        i * self.width + self.profile.half_bandwidth() + j - i
    }

    /// The stored entries of row `i` inside the envelope and the column of the first of them: up
    /// to the diagonal in a symmetric matrix.
    #[inline(always)]
    #[must_use]
    pub fn row(&self, i: usize) -> (usize, &[R]) {
        let first = self.profile.first()[i];
        let last = if self.symmetric {
            i
        } else {
            self.profile.reach()[i]
        };
        (
            first,
            &self.data[self.index(i, first)..=self.index(i, last)],
        )
    }

    #[inline(always)]
    pub(super) fn diagonal(&self, i: usize) -> R {
        self.data[self.index(i, i)]
    }

    /// Sets every entry to zero.
    pub fn clear(&mut self) {
        self.data.fill(R::zero());
    }

    /// Entry `(i, j)`; zero outside the envelope.
    #[must_use]
    pub fn get(&self, i: usize, j: usize) -> R {
        if !self.profile.contains(i, j) {
            return R::zero();
        }
        if self.symmetric && j > i {
            self.data[self.index(j, i)]
        } else {
            self.data[self.index(i, j)]
        }
    }

    /// Adds `value` to entry `(i, j)`. In a symmetric matrix an entry of the strict upper
    /// triangle is ignored, so that whole element matrices can be added entry by entry.
    ///
    /// # Errors
    /// [`Error::OutsideProfile`] for an entry that the envelope does not hold.
    #[inline]
    pub fn add(&mut self, i: usize, j: usize, value: R) -> Result<()> {
        if !self.profile.contains(i, j) {
            return Err(Error::OutsideProfile { row: i, column: j });
        }
        if !self.symmetric || j <= i {
            let index = self.index(i, j);
            self.data[index] += value;
        }
        Ok(())
    }

    /// Adds the matrix of an element whose `n` unknowns are numbered consecutively from
    /// `offset`.
    ///
    /// `block` is row-major and either full (`n * n` entries, of which a symmetric matrix reads
    /// the lower triangle) or the lower triangle alone, row after row without gaps
    /// (`n * (n + 1) / 2` entries, mirrored in a general matrix).
    ///
    /// # Errors
    /// [`Error::OutsideProfile`] if the envelope does not hold the block, [`Error::Length`] if
    /// `block` has neither of the two lengths.
    pub fn add_block(&mut self, offset: usize, n: usize, block: &[R]) -> Result<()> {
        if n == 0 {
            return Ok(());
        }
        if !self.profile.contains(offset + n - 1, offset) {
            return Err(Error::OutsideProfile {
                row: offset + n - 1,
                column: offset,
            });
        }
        let full = block.len() == n * n;
        if !full {
            Error::check_length("element matrix", block.len(), n * (n + 1) / 2)?;
        }
        for i in 0..n {
            let start = if full { i * n } else { i * (i + 1) / 2 };
            let count = if full && !self.symmetric { n } else { i + 1 };
            let source = &block[start..start + count];
            let target = self.index(offset + i, offset);
            for (t, s) in self.data[target..target + count].iter_mut().zip(source) {
                *t += *s;
            }
            if !full && !self.symmetric {
                for j in 0..i {
                    let mirrored = self.index(offset + j, offset + i);
                    self.data[mirrored] += source[j];
                }
            }
        }
        Ok(())
    }

    /// Adds the matrices of `lanes` elements of `n` unknowns each, numbered consecutively from
    /// `offset(lane)`: the entries of `block`, row-major and full.
    #[inline(always)]
    pub(crate) fn add_blocks<L: Lanes<R>>(
        &mut self,
        lanes: usize,
        offset: impl Fn(usize) -> usize,
        n: usize,
        block: &[L],
    ) -> Result<()> {
        for lane in 0..lanes {
            let (column, row) = (offset(lane), offset(lane) + n - 1);
            if !self.profile.contains(row, column) {
                return Err(Error::OutsideProfile { row, column });
            }
        }
        for i in 0..n {
            let count = if self.symmetric { i + 1 } else { n };
            let (width, half) = (self.width, self.profile.half_bandwidth());
            let target = |lane: usize| (offset(lane) + i) * width + half - i;
            L::scatter(&block[i * n..i * n + count], lanes, &mut self.data, target);
        }
        Ok(())
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
        for i in 0..self.size() {
            let (first, row) = self.row(i);
            let mut sum = R::zero();
            for (a, x) in row.iter().zip(&x[first..]) {
                sum += map(*a) * map(*x);
            }
            y[i] = sum;
            if self.symmetric {
                let own = map(x[i]);
                for (a, y) in row.iter().zip(&mut y[first..i]) {
                    *y += map(*a) * own;
                }
            }
        }
        Ok(())
    }

    /// Makes row and column `i` those of the identity times `diagonal`: with a zero right-hand
    /// side there, unknown `i` of the solution is zero and the others are those of the system
    /// without it. A `diagonal` near the others of the matrix keeps it well scaled; a positive
    /// one leaves [`inertia`](super::Factor::inertia) that of the free unknowns.
    ///
    /// # Errors
    /// [`Error::OutsideProfile`] if there is no unknown `i`.
    pub fn fix(&mut self, i: usize, diagonal: R) -> Result<()> {
        if i >= self.size() {
            return Err(Error::OutsideProfile { row: i, column: i });
        }
        let (first, last) = (self.profile.first()[i], self.profile.reach()[i]);
        let row_end = if self.symmetric { i } else { last };
        let row = self.index(i, first)..=self.index(i, row_end);
        self.data[row].fill(R::zero());
        let column_start = if self.symmetric { i } else { first };
        for k in column_start..=last {
            let index = self.index(k, i);
            self.data[index] = R::zero();
        }
        let index = self.index(i, i);
        self.data[index] = diagonal;
        Ok(())
    }

    /// Overwrites this matrix by `other`.
    ///
    /// # Errors
    /// [`Error::Length`] or [`Error::Unsupported`] unless both have the same profile and store
    /// the same triangles.
    pub fn copy_from(&mut self, other: &Self) -> Result<()> {
        self.check_alike(other)?;
        self.data.copy_from_slice(&other.data);
        Ok(())
    }

    /// Adds `alpha * other`.
    ///
    /// # Errors
    /// [`Error::Length`] or [`Error::Unsupported`] unless both have the same profile and store
    /// the same triangles.
    pub fn scale_add(&mut self, alpha: R, other: &Self) -> Result<()> {
        self.check_alike(other)?;
        for (a, b) in self.data.iter_mut().zip(&other.data) {
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
