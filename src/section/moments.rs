//! A section known only by its area and second moments, as benchmarks given by stiffness and
//! inertia constants need it.

use super::{MAX_OUTLINE, Section};
use crate::error::{Error, Result, positive};
use crate::quadrature::{Cubature, circle};
use crate::scalar::Real;

/// Area and second moments without a shape. With a density of 1 kg/m^3 they are the mass per
/// length `rho A` (kg/m) and the rotary inertias `rho I_y` and `rho I_z` (kg m) themselves, which
/// need not belong to any real section.
///
/// ```
/// use ancf::section::{Moments, Section};
/// let section = Moments::new(1.0_f64, 10.0, 20.0)?;
/// let p = section.properties()?;
/// assert!((p.area - 1.0).abs() + (p.iyy - 10.0).abs() + (p.izz - 20.0).abs() < 1e-13);
/// # Ok::<(), ancf::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moments<R> {
    area: R,
    iyy: R,
    izz: R,
}

impl<R: Real> Moments<R> {
    /// `area` (m^2), `iyy` the integral of `z^2` and `izz` that of `y^2` (m^4); the axis passes
    /// through the centroid along the principal axes.
    ///
    /// # Errors
    /// [`Error::NotPositive`] for a number that is not finite and above zero.
    pub fn new(area: R, iyy: R, izz: R) -> Result<Self> {
        Ok(Self {
            area: positive("area of the section [m^2]", area)?,
            iyy: positive("second moment Iyy of the section [m^4]", iyy)?,
            izz: positive("second moment Izz of the section [m^4]", izz)?,
        })
    }

    /// Radii of gyration along y and z (m).
    fn gyration(&self) -> [R; 2] {
        [self.izz, self.iyy].map(|second| (second / self.area).sqrt())
    }
}

impl<R: Real> Section<R> for Moments<R> {
    /// Four equal points on the axes at `sqrt(2)` radii of gyration, exact to degree 3; more the
    /// numbers do not say, and higher degrees are refused.
    fn rule(&self, degree: usize) -> Result<Cubature<R, 2>> {
        if degree > 3 {
            return Err(Error::Unsupported {
                what: format!("a rule of degree {degree} of a section given by its second moments"),
                remedy: "use a formulation by stiffness constants, or a section with a shape",
            });
        }
        let [y, z] = self.gyration().map(|radius| radius * R::lit(2.0).sqrt());
        let zero = R::zero();
        Cubature::new(
            vec![[y, zero], [zero, z], [-y, zero], [zero, -z]],
            vec![self.area * R::lit(0.25); 4],
            3,
        )
    }

    /// For drawing: the ellipse with these radii of gyration.
    fn outline(&self, n: usize) -> Vec<Vec<[R; 2]>> {
        let [y, z] = self.gyration().map(|radius| radius * R::lit(2.0));
        let unit = circle(R::one(), n.clamp(3, MAX_OUTLINE));
        vec![unit.into_iter().map(|[c, s]| [y * c, z * s]).collect()]
    }
}
