//! The hollow circular section: tubes.

use super::{MAX_OUTLINE, Section};
use crate::error::Result;
use crate::quadrature::{Cubature, annulus, circle, wall};
use crate::scalar::Real;

/// A circular tube centred at the origin.
///
/// ```
/// use ancf::section::{Annulus, Section};
/// let section = Annulus::new(0.02_f64, 0.015)?;
/// let exact = std::f64::consts::PI / 4.0 * (0.02_f64.powi(4) - 0.015_f64.powi(4));
/// assert!((section.properties()?.iyy - exact).abs() < 1e-21);
/// # Ok::<(), ancf::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Annulus<R> {
    outer: R,
    inner: R,
}

impl<R: Real> Annulus<R> {
    /// The region between the circles of radius `inner` and `outer` (m).
    ///
    /// # Errors
    /// [`Error::NotPositive`](crate::Error::NotPositive) for an outer radius that is not finite and above zero or a
    /// negative inner one, [`Error::NotFinite`](crate::Error::NotFinite) for an inner radius that is not finite,
    /// [`Error::OutOfRange`](crate::Error::OutOfRange) when it is not below the outer one or is zero (use
    /// [`Disk`](super::Disk) then).
    pub fn new(outer: R, inner: R) -> Result<Self> {
        let [outer, inner] = wall(outer, inner)?;
        Ok(Self { outer, inner })
    }

    /// Outer radius (m).
    pub fn outer(&self) -> R {
        self.outer
    }

    /// Inner radius (m).
    pub fn inner(&self) -> R {
        self.inner
    }
}

impl<R: Real> Section<R> for Annulus<R> {
    /// The rule of [`annulus`].
    fn rule(&self, degree: usize) -> Result<Cubature<R, 2>> {
        annulus(self.outer, self.inner, degree)
    }

    fn outline(&self, n: usize) -> Vec<Vec<[R; 2]>> {
        let n = n.clamp(3, MAX_OUTLINE);
        let mut hole = circle(self.inner, n);
        hole.reverse();
        vec![circle(self.outer, n), hole]
    }
}
