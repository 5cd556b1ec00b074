//! Direct solution of the linear systems of chains. Numbering the unknowns along a chain keeps
//! every coupling near the diagonal, so storage and work grow linearly with the number of
//! elements; this module stores only the envelope of such matrices and factorises it in place,
//! in any [`Real`] number type: with dual numbers the solution carries its exact derivatives.
//!
//! ```
//! use ancf::solver::{BandMatrix, Factor, Profile};
//!
//! // Three springs in a row, held at the left end, pulled at the right one.
//! let profile = Profile::from_ranges(3, [0..2, 1..3])?;
//! let mut matrix = BandMatrix::symmetric(&profile);
//! matrix.add(0, 0, 1.0)?;
//! for node in 0..2 {
//!     matrix.add_block(node, 2, &[1.0, -1.0, -1.0, 1.0])?;
//! }
//! let mut factor = Factor::new(&profile, true);
//! factor.factor(&matrix)?;
//! let mut x = [0.0, 0.0, 1.0];
//! factor.solve(&mut x)?;
//! assert!((x[2] - 3.0_f64).abs() < 1e-14);
//! assert_eq!(factor.inertia(), Some(0));
//! # Ok::<(), ancf::Error>(())
//! ```

mod ahead;
mod aligned;
mod blocks;
mod columns;
mod ldlt;
mod lines;
mod lu;
mod matrix;
mod pivots;
mod profile;

pub(super) use ldlt::{GROWTH, NOISE};
pub(super) use lines::{Lines, STRETCHES};
pub use matrix::BandMatrix;
pub use profile::Profile;

use super::sparse::{SparseLdlt, SparseMatrix};
use super::stored::Stored;
use super::tape::Tape;
use crate::error::{Error, Result};
use crate::scalar::Real;
use ldlt::Ldlt;
use lu::Lu;

/// Factorisation of a [`BandMatrix`] or of a structure's [`Stored`] matrix, with workspace that is
/// allocated once and used again for every matrix of the same profile.
///
/// Symmetric matrices are factorised as `L D L^T` without pivoting, which keeps to the envelope
/// and costs about a fifth of LU. Without pivoting this is stable for definite matrices and for
/// saddle points in which every multiplier is numbered after the unknowns it holds and its
/// coefficients are not large against their stiffness. The growth of the entries is watched:
/// when they outgrow their row or a pivot drowns in rounding, the matrix is factorised afresh
/// by equilibrated band LU with partial pivoting. General matrices always take LU, with the diagonal as
/// pivot unless it is below a thirty-second of the largest entry of its column or entries grow by that.
/// Matrices that are stored sparse are factorised by blocks in an order of little fill, under the same
/// watch.
#[derive(Debug, Clone)]
pub struct Factor<R> {
    profile: Profile,
    ldlt: Option<Ldlt<R>>,
    sparse: Option<SparseLdlt<R>>,
    lu: Option<Lu<R>>,
    /// A sparse matrix on its way to LU.
    spread: Option<BandMatrix<R>>,
    held: Held,
}

/// Which of the workspaces holds the factors of the last matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Held {
    Nothing,
    Ldlt,
    Sparse,
    Lu,
}

/// A matrix to factorise, in whatever way it is stored.
#[derive(Debug)]
pub struct Entries<'a, R>(Kept<'a, R>);

#[derive(Debug)]
enum Kept<'a, R> {
    Band(&'a BandMatrix<R>),
    Sparse(&'a SparseMatrix<R>),
}

impl<'a, R> From<&'a BandMatrix<R>> for Entries<'a, R> {
    fn from(matrix: &'a BandMatrix<R>) -> Self {
        Self(Kept::Band(matrix))
    }
}

impl<'a, R> From<&'a Stored<R>> for Entries<'a, R> {
    fn from(matrix: &'a Stored<R>) -> Self {
        Self(match matrix.kept() {
            super::stored::Kept::Band(matrix) => Kept::Band(matrix),
            super::stored::Kept::Sparse(_, matrix) => Kept::Sparse(matrix),
        })
    }
}

impl<R: Real> Factor<R> {
    /// Workspace for matrices of `profile`.
    ///
    /// With `symmetric` the workspace of `L D L^T` is allocated now (about one matrix) and that
    /// of LU (about four) only when a matrix first needs it; otherwise that of LU is allocated
    /// now and symmetric matrices, too, are factorised by LU.
    #[must_use]
    pub fn new(profile: &Profile, symmetric: bool) -> Self {
        Self {
            profile: profile.clone(),
            ldlt: (symmetric && profile.pattern().is_none()).then(|| Ldlt::new(profile)),
            sparse: profile.pattern().filter(|_| symmetric).map(SparseLdlt::new),
            lu: (!symmetric).then(|| Lu::new(profile)),
            spread: None,
            held: Held::Nothing,
        }
    }

    /// Factorises `matrix`; [`solve`](Self::solve) then solves with it. Allocates nothing but,
    /// the first time it is needed, the workspace of LU (see [`new`](Self::new)).
    ///
    /// # Errors
    /// [`Error::Singular`] names the first unknown whose pivot vanishes (a matrix that is
    /// singular only up to rounding may pass, and then gives huge solutions),
    /// [`Error::NotFinite`] reports NaN or infinity met in elimination, [`Error::Length`] a
    /// matrix of another profile, [`Error::Unsupported`] one stored in another way. After an error there is nothing to solve with.
    pub fn factor<'a>(&mut self, matrix: impl Into<Entries<'a, R>>) -> Result<()> {
        self.decompose(matrix.into(), None)
    }

    /// [`factor`](Self::factor) and [`solve`](Self::solve) in one, which spares a long chain one way of
    /// its factors through the caches.
    ///
    /// # Errors
    /// Those of both.
    pub fn factor_and_solve<'a>(
        &mut self,
        matrix: impl Into<Entries<'a, R>>,
        x: &mut [R],
    ) -> Result<()> {
        Error::check_length("right-hand side", x.len(), self.profile.size())?;
        self.decompose(matrix.into(), Some(x))
    }

    fn decompose(
        &mut self,
        Entries(matrix): Entries<'_, R>,
        mut x: Option<&mut [R]>,
    ) -> Result<()> {
        self.held = Held::Nothing;
        let matrix = match (matrix, &mut self.sparse) {
            (Kept::Band(matrix), _) => matrix,
            (Kept::Sparse(matrix), Some(sparse)) => {
                if sparse.factor(matrix)? {
                    self.held = Held::Sparse;
                    return x.map_or(Ok(()), |x| self.solve(x));
                }
                let spread = self
                    .spread
                    .get_or_insert_with(|| BandMatrix::symmetric(&self.profile));
                matrix.copy_to(spread)?;
                spread
            }
            (Kept::Sparse(_), None) => {
                return Err(Error::Unsupported {
                    what: "a sparse matrix given to a factorisation of general ones".into(),
                    remedy: "construct both from one profile as symmetric, or both as general",
                });
            }
        };
        self.profile.check_same(matrix.profile())?;
        if matrix.is_symmetric()
            && let Some(ldlt) = &mut self.ldlt
            && ldlt.factor(matrix, x.as_deref_mut())?
        {
            self.held = Held::Ldlt;
            return Ok(());
        }
        let lu = self.lu.get_or_insert_with(|| Lu::new(&self.profile));
        lu.factor(&self.profile, matrix)?;
        self.held = Held::Lu;
        x.map_or(Ok(()), |x| self.solve(x))
    }

    /// Begins to factorise in the storage of a matrix while it is assembled, for
    /// [`advance`](Self::advance) and [`keep`](Self::keep), along with a right-hand side if one is
    /// loaded. False where that is not done: for sparse and for general matrices.
    pub(super) fn begin(&mut self, load: Option<impl FnOnce(&mut [R])>) -> bool {
        self.held = Held::Nothing;
        self.ldlt.as_mut().map(|ldlt| ldlt.begin(load)).is_some()
    }

    /// Eliminates as far as the first `lines` of a matrix allow, to which nothing more may be added.
    /// False where the matrix is not definite: it is then to be assembled anew, for
    /// [`factor`](Self::factor).
    ///
    /// # Errors
    /// [`Error::NotFinite`] as in factorisation.
    pub(super) fn advance(&mut self, matrix: &mut Stored<R>, lines: usize) -> Result<bool> {
        match (&mut self.ldlt, matrix.envelope()) {
            (Some(ldlt), Some(matrix)) => ldlt.advance(matrix, lines.min(self.profile.size())),
            _ => Ok(false),
        }
    }

    /// Keeps the factors of a matrix that is eliminated to the end, which is then clear.
    pub(super) fn keep(&mut self, matrix: &mut Stored<R>) {
        if let (Some(ldlt), Some(matrix)) = (&mut self.ldlt, matrix.envelope()) {
            ldlt.keep(matrix);
            self.held = Held::Ldlt;
        }
    }

    /// Whether [`back`](Self::back) is still to be gone, or some of it.
    pub(super) fn is_halfway(&self) -> bool {
        self.ldlt.as_ref().is_some_and(Ldlt::is_halfway)
    }

    /// The solution for the right-hand side that went along with the factors [kept](Self::keep), from
    /// `line` on: found from the last unknown down to there, so that what follows from a part of it can be
    /// done while the caches hold it.
    pub(super) fn back(&mut self, line: usize) -> &[R] {
        match (self.held, &mut self.ldlt) {
            (Held::Ldlt, Some(ldlt)) => ldlt.back(line),
            _ => &[],
        }
    }

    /// Replaces the right-hand side `x` by the solution. Allocates nothing.
    ///
    /// # Errors
    /// [`Error::Length`] if `x` is not as long as the matrix, [`Error::Unsupported`] if no
    /// matrix has been factorised.
    pub fn solve(&mut self, x: &mut [R]) -> Result<()> {
        Error::check_length("right-hand side", x.len(), self.profile.size())?;
        match (self.held, &mut self.ldlt, &self.sparse, &mut self.lu) {
            (Held::Ldlt, Some(ldlt), ..) => ldlt.solve(x),
            (Held::Sparse, _, Some(sparse), _) => sparse.solve(x),
            (Held::Lu, .., Some(lu)) => lu.solve(&self.profile, x),
            _ => {
                return Err(Error::Unsupported {
                    what: "solving without factors".into(),
                    remedy: "call `factor` first and heed its error",
                });
            }
        }
        Ok(())
    }

    /// Replaces the right-hand side `x` by the solution of the transposed system, which for a
    /// symmetric matrix is that of the system itself. Allocates nothing.
    ///
    /// # Errors
    /// Those of [`solve`](Self::solve).
    pub fn solve_transposed(&mut self, x: &mut [R]) -> Result<()> {
        match (self.held, &self.lu) {
            (Held::Lu, Some(lu)) => {
                Error::check_length("right-hand side", x.len(), self.profile.size())?;
                lu.solve_transposed(&self.profile, x);
                Ok(())
            }
            _ => self.solve(x),
        }
    }

    /// The factors of the last matrix, if there are any, to a tape or from it.
    pub(super) fn history(&mut self, tape: &mut Tape<R>) -> Result<()> {
        const ALL: [Held; 4] = [Held::Nothing, Held::Ldlt, Held::Sparse, Held::Lu];
        let mut held = self.held as usize;
        tape.index(&mut held, 0..=ALL.len() - 1)?;
        self.held = Held::Nothing;
        match (ALL[held], &mut self.ldlt, &mut self.sparse) {
            (Held::Nothing, ..) => {}
            (Held::Ldlt, Some(ldlt), _) => ldlt.history(tape)?,
            (Held::Sparse, _, Some(sparse)) => sparse.history(tape)?,
            (Held::Lu, ..) => {
                let lu = self.lu.get_or_insert_with(|| Lu::new(&self.profile));
                lu.history(tape)?;
            }
            _ => {
                return Err(Error::Unsupported {
                    what: "factors that were made for a matrix stored in another way".into(),
                    remedy: "resume with the system that the checkpoint was taken from",
                });
            }
        }
        self.held = ALL[held];
        Ok(())
    }

    /// Number of negative pivots of the last matrix, which by Sylvester's law is the number of
    /// its negative eigenvalues; `None` if it was factorised by LU or not at all. Zero means
    /// that the matrix is positive definite: the equilibrium it belongs to is stable.
    #[must_use]
    pub fn inertia(&self) -> Option<usize> {
        match self.held {
            Held::Ldlt => self.ldlt.as_ref().map(Ldlt::negative),
            Held::Sparse => self.sparse.as_ref().map(SparseLdlt::negative),
            Held::Lu | Held::Nothing => None,
        }
    }

    /// Whether the last matrix is known to be positive definite, in every lane.
    pub(super) fn definite(&self) -> bool {
        match (self.held, &self.ldlt, &self.sparse) {
            (Held::Ldlt, Some(ldlt), _) => ldlt.definite(),
            (Held::Sparse, _, Some(sparse)) => sparse.negative() == 0,
            _ => false,
        }
    }

    /// Whether the determinant of the last matrix is negative, so that an odd number of its real
    /// eigenvalues is; `None` without factors. LU, too, tells so much.
    #[must_use]
    pub fn odd(&self) -> Option<bool> {
        match self.held {
            Held::Lu => self.lu.as_ref().map(Lu::negative),
            _ => self.inertia().map(|negative| negative % 2 == 1),
        }
    }
}
