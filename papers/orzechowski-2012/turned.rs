//! A cross-section defined outside the library: the disk with its points turned about the axis.
//! The shape is the same; only a rule that is not isotropic notices. It shows all that a section
//! of one's own needs, and it measures that the paper's order-2 rule depends on where its first
//! diameter lies.

use ancf::prelude::*;
use ancf::quadrature::Cubature;

/// A disk whose integration points are turned about the beam's axis.
#[derive(Debug, Clone, Copy)]
pub struct Turned {
    disk: Disk<f64>,
    degrees: f64,
}

impl Turned {
    /// A disk of `radius` (m) with its points turned by an angle in degrees.
    ///
    /// # Errors
    /// For a radius that is not positive.
    pub fn new(radius: f64, degrees: f64) -> Result<Self> {
        let disk = Disk::new(radius)?;
        Ok(Self { disk, degrees })
    }
}

impl Section<f64> for Turned {
    fn rule(&self, degree: usize) -> Result<Cubature<f64, 2>> {
        let rule = self.disk.rule(degree)?;
        if self.degrees == 0.0 {
            return Ok(rule);
        }
        let (sin, cos) = self.degrees.to_radians().sin_cos();
        rule.affine([[cos, -sin], [sin, cos]], [0.0; 2])
    }

    fn outline(&self, n: usize) -> Vec<Vec<[f64; 2]>> {
        self.disk.outline(n)
    }
}
