//! The solid elliptical section, the affine image of a disk.

use super::{MAX_OUTLINE, Section};
use crate::error::{Result, positive};
use crate::quadrature::{Cubature, circle, disk_order};
use crate::scalar::Real;

/// A solid ellipse centred at the origin with its axes along the coordinate axes.
///
/// ```
/// use ancf::section::{Ellipse, Section};
/// let section = Ellipse::new(0.02_f64, 0.01)?;
/// let exact = std::f64::consts::PI / 4.0 * 0.02_f64.powi(3) * 0.01;
/// assert!((section.properties()?.izz - exact).abs() < 1e-21);
/// # Ok::<(), ancf::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ellipse<R> {
    semi_axes: [R; 2],
}

impl<R: Real> Ellipse<R> {
    /// An ellipse of semi-axis `semi_y` along y and `semi_z` along z (m).
    ///
    /// # Errors
    /// [`Error::NotPositive`](crate::Error::NotPositive) for a semi-axis that is not finite and
    /// above zero.
    pub fn new(semi_y: R, semi_z: R) -> Result<Self> {
        let semi_y = positive("semi-axis of the ellipse along y [m]", semi_y)?;
        let semi_z = positive("semi-axis of the ellipse along z [m]", semi_z)?;
        Ok(Self {
            semi_axes: [semi_y, semi_z],
        })
    }

    /// Semi-axes along y and z (m).
    pub fn semi_axes(&self) -> [R; 2] {
        self.semi_axes
    }
}

impl<R: Real> Section<R> for Ellipse<R> {
    /// The image of the rule of the unit disk, [`disk_order`].
    fn rule(&self, degree: usize) -> Result<Cubature<R, 2>> {
        let ([y, z], zero) = (self.semi_axes, R::zero());
        disk_order(degree / 2 + 1)?.affine([[y, zero], [zero, z]], [zero; 2])
    }

    fn outline(&self, n: usize) -> Vec<Vec<[R; 2]>> {
        let [y, z] = self.semi_axes;
        let unit = circle(R::one(), n.clamp(3, MAX_OUTLINE));
        vec![unit.into_iter().map(|p| [p[0] * y, p[1] * z]).collect()]
    }
}
