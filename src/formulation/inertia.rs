//! Inertia of an element: the constant mass matrix and the constant first moments that carry
//! gravity. Both need only scalars per pair of shape functions, whatever the dimension.

use super::{Reference, section_points};
use crate::element::Element;
use crate::error::{Result, positive};
use crate::quadrature::gauss_legendre;
use crate::scalar::Real;
use crate::section::Section;

/// Mass of one element: `mass[i][j] = int rho s_i s_j dV` (kg) times the squares of metres that
/// slopes carry (eq. 8 of Orzechowski 2012 is this matrix times the `D x D` identity), and the
/// first moments `int rho s_i dV`, which multiply the acceleration of gravity.
#[derive(Debug, Clone, PartialEq)]
pub struct Inertia<R, const S: usize> {
    /// Consistent mass matrix.
    pub mass: [[R; S]; S],
    /// First moments of the shape functions.
    pub first: [R; S],
}

impl<R: Real, const S: usize> Inertia<R, S> {
    /// Inertia of an element of `density` (kg/m^3), integrated exactly.
    ///
    /// # Errors
    /// For a density that is not positive, and those of the section's rule.
    pub fn new<E: Element<D, S>, const D: usize>(
        element: &E,
        reference: &Reference<R, D>,
        section: &dyn Section<R>,
        density: R,
    ) -> Result<Self> {
        let density = positive("density [kg/m^3]", density)?;
        let axial = gauss_legendre::<R>(E::AXIAL_DEGREE + 1)?;
        let across = section_points::<R, D>(section, 2 * E::SECTION_DEGREE)?;
        let mut inertia = Self {
            mass: [[R::zero(); S]; S],
            first: [R::zero(); S],
        };
        for ([xi], along) in axial.iter() {
            for (y, area) in &across {
                let mut x = y.map(|y| y / reference.length);
                x[0] = xi;
                let s = element.shape(reference.length, x);
                let dm = density * along * reference.length * *area;
                for i in 0..S {
                    inertia.first[i] += dm * s[i];
                    for j in 0..S {
                        inertia.mass[i][j] += dm * s[i] * s[j];
                    }
                }
            }
        }
        Ok(inertia)
    }
}
