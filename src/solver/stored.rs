//! How the matrix of a structure is stored: in an envelope, or, symmetric and mostly zero there, by
//! sparse blocks. The profile decides, once; nobody else asks.

use super::band::{BandMatrix, Profile};
use super::sparse::SparseMatrix;
use crate::error::{Error, Result};
use crate::scalar::Real;

/// Matrix over the unknowns of a structure. No method but the constructors allocates.
#[derive(Debug, Clone)]
pub struct Stored<R>(Kept<R>);

#[derive(Debug, Clone)]
pub(super) enum Kept<R> {
    Band(BandMatrix<R>),
    Sparse(Profile, SparseMatrix<R>),
}

impl<R: Real> Stored<R> {
    /// Zero matrix that stores one triangle.
    #[must_use]
    pub fn symmetric(profile: &Profile) -> Self {
        Self(match profile.pattern() {
            None => Kept::Band(BandMatrix::symmetric(profile)),
            Some(pattern) => Kept::Sparse(profile.clone(), SparseMatrix::zero(pattern)),
        })
    }

    /// Zero matrix that stores both triangles, always in the envelope.
    #[must_use]
    pub fn general(profile: &Profile) -> Self {
        Self(Kept::Band(BandMatrix::general(profile)))
    }

    /// Which unknowns couple.
    #[must_use]
    pub fn profile(&self) -> &Profile {
        match &self.0 {
            Kept::Band(matrix) => matrix.profile(),
            Kept::Sparse(profile, _) => profile,
        }
    }

    /// Number of rows.
    #[must_use]
    pub fn size(&self) -> usize {
        self.profile().size()
    }

    /// Whether only one triangle is stored.
    #[must_use]
    pub fn is_symmetric(&self) -> bool {
        match &self.0 {
            Kept::Band(matrix) => matrix.is_symmetric(),
            Kept::Sparse(..) => true,
        }
    }

    /// Whether the matrix is stored by sparse blocks.
    #[must_use]
    pub fn is_sparse(&self) -> bool {
        matches!(self.0, Kept::Sparse(..))
    }

    /// The matrix if it is stored in an envelope.
    pub(super) fn envelope(&mut self) -> Option<&mut BandMatrix<R>> {
        match &mut self.0 {
            Kept::Band(matrix) => Some(matrix),
            Kept::Sparse(..) => None,
        }
    }

    /// Entry `(i, j)`; zero where nothing is stored.
    #[must_use]
    pub fn get(&self, i: usize, j: usize) -> R {
        match &self.0 {
            Kept::Band(matrix) => matrix.get(i, j),
            Kept::Sparse(_, matrix) => matrix.get(i, j),
        }
    }

    /// Sets every entry to zero.
    pub fn clear(&mut self) {
        match &mut self.0 {
            Kept::Band(matrix) => matrix.clear(),
            Kept::Sparse(_, matrix) => matrix.clear(),
        }
    }

    /// Adds `value` to entry `(i, j)`. In a symmetric matrix an entry of the strict upper triangle
    /// is ignored.
    ///
    /// # Errors
    /// [`Error::OutsideProfile`](crate::Error::OutsideProfile) for unknowns that do not couple.
    #[inline]
    pub fn add(&mut self, i: usize, j: usize, value: R) -> Result<()> {
        match &mut self.0 {
            Kept::Band(matrix) => matrix.add(i, j, value),
            Kept::Sparse(_, matrix) => matrix.add(i, j, value),
        }
    }

    /// Adds `values` to the entries of row `i` from column `first` on. All rows of what is added to a
    /// symmetric matrix are to be given; one triangle is stored.
    pub(super) fn add_row(&mut self, i: usize, first: usize, values: &[R]) -> Result<()> {
        match &mut self.0 {
            Kept::Band(matrix) => matrix.add_row(i, first, values),
            Kept::Sparse(_, matrix) => (first..)
                .zip(values)
                .try_for_each(|(j, value)| matrix.add(i, j, *value)),
        }
    }

    /// Adds the full row-major matrix of an element whose `n` unknowns are numbered consecutively
    /// from `offset`.
    ///
    /// # Errors
    /// Those of [`add`](Self::add), [`Error::Length`](crate::Error::Length) for a block of another
    /// size.
    #[inline]
    pub fn add_block(&mut self, offset: usize, n: usize, block: &[R]) -> Result<()> {
        match &mut self.0 {
            Kept::Band(matrix) => matrix.add_block(offset, n, block),
            Kept::Sparse(_, matrix) => matrix.add_block(offset, n, block),
        }
    }

    /// `y = A x`.
    ///
    /// # Errors
    /// [`Error::Length`](crate::Error::Length) if `x` or `y` is not as long as the matrix.
    pub fn mul_vec(&self, x: &[R], y: &mut [R]) -> Result<()> {
        match &self.0 {
            Kept::Band(matrix) => matrix.mul_vec(x, y),
            Kept::Sparse(_, matrix) => matrix.product(x, y, false),
        }
    }

    /// `y_i = sum_j |a_ij| |x_j|`: times the rounding unit, how far rounding moves
    /// [`mul_vec`](Self::mul_vec).
    ///
    /// # Errors
    /// [`Error::Length`](crate::Error::Length) if `x` or `y` is not as long as the matrix.
    pub fn abs_mul_vec(&self, x: &[R], y: &mut [R]) -> Result<()> {
        match &self.0 {
            Kept::Band(matrix) => matrix.abs_mul_vec(x, y),
            Kept::Sparse(_, matrix) => matrix.product(x, y, true),
        }
    }

    /// Overwrites this matrix by `other`.
    ///
    /// # Errors
    /// [`Error::Length`] or [`Error::Unsupported`] unless both are of one profile and store the
    /// same triangles.
    pub fn copy_from(&mut self, other: &Self) -> Result<()> {
        match (&mut self.0, &other.0) {
            (Kept::Band(a), Kept::Band(b)) => a.copy_from(b),
            (Kept::Sparse(_, a), Kept::Sparse(_, b)) => a.copy_from(b),
            _ => Err(unlike()),
        }
    }

    /// Adds `alpha * other`.
    ///
    /// # Errors
    /// [`Error::Length`] or [`Error::Unsupported`] unless both are of one profile and store the
    /// same triangles.
    pub fn scale_add(&mut self, alpha: R, other: &Self) -> Result<()> {
        match (&mut self.0, &other.0) {
            (Kept::Band(a), Kept::Band(b)) => a.scale_add(alpha, b),
            (Kept::Sparse(_, a), Kept::Sparse(_, b)) => a.scale_add(alpha, b),
            _ => Err(unlike()),
        }
    }
}

impl<R> Stored<R> {
    pub(super) fn kept(&self) -> &Kept<R> {
        &self.0
    }
}

fn unlike() -> Error {
    Error::Unsupported {
        what: "mixing matrices that are stored in different ways".into(),
        remedy: "construct both from one profile, both with `symmetric` or both with `general`",
    }
}
