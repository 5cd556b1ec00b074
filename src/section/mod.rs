//! Cross-sections of beams: shapes that give an integration rule of any degree, their outline
//! for drawing and contact, their area and second moments, and their rule in a planar scene. An
//! element knows its section only through the [`Section`] trait, so a shape of your own needs
//! no more than a rule and an outline; a shape of which only the outline is at hand is an
//! [`Outline`], which finds its rules itself.

mod annulus;
mod disk;
mod ellipse;
mod moments;
mod offset;
mod outline;
mod profile;
mod rectangle;
mod remembered;

pub use annulus::Annulus;
pub use disk::Disk;
pub use ellipse::Ellipse;
pub use moments::Moments;
pub use offset::Offset;
pub use outline::{Loop, Outline};
pub use profile::{box_profile, c_profile, i_profile, l_profile, t_profile};
pub use rectangle::Rectangle;

pub(crate) use remembered::Remembered;

use std::fmt::Debug;
use std::sync::Arc;

use crate::error::{Result, positive};
use crate::quadrature::{Cubature, project};
use crate::scalar::Real;

/// Largest number of points of one loop of an outline; more would not show.
pub const MAX_OUTLINE: usize = 65_536;

/// Area and second moments of a section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Properties<R> {
    /// Area, the integral of 1 (m^2).
    pub area: R,
    /// Centroid `(y, z)`, the mean of the coordinates (m).
    pub centroid: [R; 2],
    /// Integral of `z^2` about the centroid (m^4): bending about the y axis.
    pub iyy: R,
    /// Integral of `y^2` about the centroid (m^4): bending about the z axis.
    pub izz: R,
    /// Integral of `y z` about the centroid (m^4), zero for a section symmetric in either axis.
    pub iyz: R,
}

/// The cross-section of a beam: a region of the plane of the coordinates `(y, z)` (m), whose
/// origin is where the axis of the beam passes through.
///
/// ```
/// use ancf::quadrature::Cubature;
/// use ancf::section::Section;
///
/// /// Two thin flanges at a distance: lumped areas.
/// #[derive(Debug)]
/// struct Sandwich;
///
/// impl Section<f64> for Sandwich {
///     fn rule(&self, _degree: usize) -> ancf::Result<Cubature<f64, 2>> {
///         let points = vec![[-0.1, 0.0], [0.1, 0.0]];
///         Cubature::new(points, vec![2e-4; 2], usize::MAX)
///     }
///     fn outline(&self, _n: usize) -> Vec<Vec<[f64; 2]>> {
///         let strip = |y: f64| vec![[y, -0.05], [y + 0.002, -0.05], [y + 0.002, 0.05], [y, 0.05]];
///         vec![strip(-0.1), strip(0.1)]
///     }
/// }
/// let bending = Sandwich.properties()?.izz;
/// assert!((bending - 4e-6).abs() < 1e-20);
/// # Ok::<(), ancf::Error>(())
/// ```
pub trait Section<R: Real>: Debug + Send + Sync {
    /// Integration rule of the region: points `(y, z)` (m) and weights (m^2), exact for
    /// polynomials of total degree up to `degree` at least.
    ///
    /// # Errors
    /// [`Error::Unsupported`](crate::Error::Unsupported) for a degree that the section has no
    /// rule for; [`Error::NotFinite`](crate::Error::NotFinite) when the section is too large
    /// for the number type.
    fn rule(&self, degree: usize) -> Result<Cubature<R, 2>>;

    /// Boundary as closed loops of points (m) without repetition of the first: an outer loop
    /// counter-clockwise, then the holes clockwise; seen with y to the right and z up. Each loop
    /// has `n` points, or as many as the shape needs at least (3 for a curved one, 4 for a
    /// rectangle) or [`MAX_OUTLINE`] at most.
    fn outline(&self, n: usize) -> Vec<Vec<[R; 2]>>;

    /// Area, centroid and second moments about it; by default from the rule of degree 2.
    ///
    /// # Errors
    /// Those of [`rule`](Self::rule), and [`Error::NotPositive`](crate::Error::NotPositive)
    /// when its weights do not add up to a positive area.
    fn properties(&self) -> Result<Properties<R>> {
        let rule = self.rule(2)?;
        let area = positive("area of the section [m^2]", rule.integrate(|_| R::one()))?;
        let cy = rule.integrate(|[y, _]| y) / area;
        let cz = rule.integrate(|[_, z]| z) / area;
        Ok(Properties {
            area,
            centroid: [cy, cz],
            iyy: rule.integrate(|[_, z]| (z - cz) * (z - cz)),
            izz: rule.integrate(|[y, _]| (y - cy) * (y - cy)),
            iyz: rule.integrate(|[y, z]| (y - cy) * (z - cz)),
        })
    }

    /// Rule of the section in a planar scene: nodes `y` (m), with weights (m^2) that carry the
    /// width in z, exact for polynomials in y up to `degree` at least. By default the Gauss
    /// rule of the section's [projection](project), which has `degree/2 + 1` nodes.
    ///
    /// # Errors
    /// Those of [`rule`](Self::rule) and of [`project`].
    fn planar_rule(&self, degree: usize) -> Result<Cubature<R, 1>> {
        // Gauss rules have odd degree, and so much must the rule of the section have.
        project(&self.rule(degree | 1)?, degree)
    }
}

macro_rules! forward {
    ($($owner:ty),*) => {$(
        impl<R: Real, S: Section<R> + ?Sized> Section<R> for $owner {
            fn rule(&self, degree: usize) -> Result<Cubature<R, 2>> {
                (**self).rule(degree)
            }
            fn outline(&self, n: usize) -> Vec<Vec<[R; 2]>> {
                (**self).outline(n)
            }
            fn properties(&self) -> Result<Properties<R>> {
                (**self).properties()
            }
            fn planar_rule(&self, degree: usize) -> Result<Cubature<R, 1>> {
                (**self).planar_rule(degree)
            }
        }
    )*};
}
forward!(&S, Box<S>, Arc<S>);
