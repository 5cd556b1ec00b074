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

mod ldlt;
mod lu;
mod matrix;
mod profile;

pub use matrix::BandMatrix;
pub use profile::Profile;

use crate::error::{Error, Result};
use crate::scalar::Real;
use ldlt::Ldlt;
use lu::Lu;

/// Factorisation of a [`BandMatrix`], with workspace that is allocated once and used again for
/// every matrix of the same profile.
///
/// Symmetric matrices are factorised as `L D L^T` without pivoting, which keeps to the envelope
/// and costs about a fifth of LU. Without pivoting this is stable for definite matrices and for
/// saddle points in which every multiplier is numbered after the unknowns it holds and its
/// coefficients are not large against their stiffness. The growth of the entries is watched:
/// when they outgrow their row or a pivot drowns in rounding, the matrix is factorised afresh
/// by equilibrated band LU with partial pivoting. General matrices always take LU.
#[derive(Debug, Clone)]
pub struct Factor<R> {
    profile: Profile,
    ldlt: Option<Ldlt<R>>,
    lu: Option<Lu<R>>,
    held: Held,
}

/// Which of the two workspaces holds the factors of the last matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Held {
    Nothing,
    Ldlt,
    Lu,
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
            ldlt: symmetric.then(|| Ldlt::new(profile)),
            lu: (!symmetric).then(|| Lu::new(profile)),
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
    /// matrix of another profile. After an error there is nothing to solve with.
    pub fn factor(&mut self, matrix: &BandMatrix<R>) -> Result<()> {
        self.held = Held::Nothing;
        self.profile.check_same(matrix.profile())?;
        if matrix.is_symmetric()
            && let Some(ldlt) = &mut self.ldlt
            && ldlt.factor(&self.profile, matrix)?
        {
            self.held = Held::Ldlt;
            return Ok(());
        }
        let lu = self.lu.get_or_insert_with(|| Lu::new(&self.profile));
        lu.factor(&self.profile, matrix)?;
        self.held = Held::Lu;
        Ok(())
    }

    /// Replaces the right-hand side `x` by the solution. Allocates nothing.
    ///
    /// # Errors
    /// [`Error::Length`] if `x` is not as long as the matrix, [`Error::Unsupported`] if no
    /// matrix has been factorised.
    pub fn solve(&mut self, x: &mut [R]) -> Result<()> {
        Error::check_length("right-hand side", x.len(), self.profile.size())?;
        match (self.held, &self.ldlt, &mut self.lu) {
            (Held::Ldlt, Some(ldlt), _) => ldlt.solve(&self.profile, x),
            (Held::Lu, _, Some(lu)) => lu.solve(&self.profile, x),
            _ => {
                return Err(Error::Unsupported {
                    what: "solving without factors".into(),
                    remedy: "call `factor` first and heed its error",
                });
            }
        }
        Ok(())
    }

    /// Number of negative pivots of the last matrix, which by Sylvester's law is the number of
    /// its negative eigenvalues; `None` if it was factorised by LU or not at all. Zero means
    /// that the matrix is positive definite: the equilibrium it belongs to is stable.
    #[must_use]
    pub fn inertia(&self) -> Option<usize> {
        match (self.held, &self.ldlt) {
            (Held::Ldlt, Some(ldlt)) => Some(ldlt.negative()),
            _ => None,
        }
    }
}
