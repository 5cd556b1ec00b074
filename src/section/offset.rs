//! A section moved away from the axis of its beam.

use super::{Properties, Section};
use crate::error::{Result, finite};
use crate::quadrature::Cubature;
use crate::scalar::Real;

/// A section whose origin is moved by a shift, so that the axis of the beam passes elsewhere:
/// an eccentric stiffener, a layer of a laminate.
///
/// ```
/// use ancf::section::{Offset, Rectangle, Section};
/// let rib = Offset::new(Rectangle::new(0.02_f64, 0.01)?, [0.05, 0.0])?;
/// assert!((rib.properties()?.centroid[0] - 0.05).abs() < 1e-16);
/// # Ok::<(), ancf::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Offset<R, S> {
    section: S,
    shift: [R; 2],
}

impl<R: Real, S: Section<R>> Offset<R, S> {
    /// `section` moved by `shift` along y and z (m).
    ///
    /// # Errors
    /// [`Error::NotFinite`](crate::Error::NotFinite) for a shift that is not finite.
    pub fn new(section: S, shift: [R; 2]) -> Result<Self> {
        for x in shift {
            finite("shift of the section [m]", x)?;
        }
        Ok(Self { section, shift })
    }
}

impl<R: Real, S: Section<R>> Section<R> for Offset<R, S> {
    fn rule(&self, degree: usize) -> Result<Cubature<R, 2>> {
        let (one, zero) = (R::one(), R::zero());
        let rule = self.section.rule(degree)?;
        rule.affine([[one, zero], [zero, one]], self.shift)
    }

    fn outline(&self, n: usize) -> Vec<Vec<[R; 2]>> {
        let mut loops = self.section.outline(n);
        for point in loops.iter_mut().flatten() {
            *point = [0, 1].map(|c| point[c] + self.shift[c]);
        }
        loops
    }

    fn properties(&self) -> Result<Properties<R>> {
        let mut own = self.section.properties()?;
        own.centroid = [0, 1].map(|c| own.centroid[c] + self.shift[c]);
        Ok(own)
    }

    fn planar_rule(&self, degree: usize) -> Result<Cubature<R, 1>> {
        let own = self.section.planar_rule(degree)?;
        let moved = own
            .points()
            .iter()
            .map(|[y]| [*y + self.shift[0]])
            .collect();
        Cubature::new(moved, own.weights().to_vec(), own.degree())
    }
}
