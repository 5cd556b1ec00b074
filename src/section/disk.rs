//! The solid circular section, the subject of Orzechowski 2012.

use super::{MAX_OUTLINE, Section};
use crate::error::{Result, positive};
use crate::quadrature::{Cubature, circle, disk_of_radius};
use crate::scalar::Real;

/// A solid disk centred at the origin.
///
/// ```
/// use ancf::section::{Disk, Section};
/// let section = Disk::new(0.02_f64)?;
/// // The strain energy of a section-linear element is quartic: seven points.
/// assert_eq!(section.rule(4)?.len(), 7);
/// # Ok::<(), ancf::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disk<R> {
    radius: R,
}

impl<R: Real> Disk<R> {
    /// A disk of the given `radius` (m).
    ///
    /// # Errors
    /// [`Error::NotPositive`](crate::Error::NotPositive) for a radius that is not finite and
    /// above zero.
    pub fn new(radius: R) -> Result<Self> {
        let radius = positive("radius of the disk [m]", radius)?;
        Ok(Self { radius })
    }

    /// Radius (m).
    pub fn radius(&self) -> R {
        self.radius
    }
}

impl<R: Real> Section<R> for Disk<R> {
    /// The rule of [`disk_of_radius`] with the smallest order that reaches the degree.
    fn rule(&self, degree: usize) -> Result<Cubature<R, 2>> {
        disk_of_radius(self.radius, degree / 2 + 1)
    }

    fn outline(&self, n: usize) -> Vec<Vec<[R; 2]>> {
        vec![circle(self.radius, n.clamp(3, MAX_OUTLINE))]
    }
}
