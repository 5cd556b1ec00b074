//! Inertia of an element: the constant mass matrix and the constant first moments that carry
//! gravity. Both need only scalars per pair of shape functions, whatever the dimension.

use super::{Reference, Sample, section_points};
use crate::element::Element;
use crate::error::{Result, positive};
use crate::quadrature::gauss_legendre;
use crate::scalar::Real;
use crate::section::Section;
use crate::tensor::{add_scaled, cross, dot};

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
    /// Inertia of an element of `density` (kg/m^3), integrated exactly; on a curved reference with
    /// two axial points more than the straight one needs.
    ///
    /// # Errors
    /// For a density that is not positive, and those of the section's rule.
    pub fn new<E: Element<D, S>, const D: usize>(
        element: &E,
        reference: &Reference<R, D, S>,
        section: &dyn Section<R>,
        density: R,
    ) -> Result<Self> {
        let density = positive("density [kg/m^3]", density)?;
        let axial =
            gauss_legendre::<R>(E::AXIAL_DEGREE + if reference.is_straight() { 1 } else { 3 })?;
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
                let mut dm = density * along * reference.length * *area;
                if !reference.is_straight() {
                    dm *= volume_ratio(element, reference, x);
                }
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

/// Reference volume at a natural point over that of the straight element: the determinant of the
/// reference gradient, or the stretch of the axis for an element without a section.
fn volume_ratio<R: Real, E: Element<D, S>, const D: usize, const S: usize>(
    element: &E,
    reference: &Reference<R, D, S>,
    x: [R; D],
) -> R {
    let mut columns = [[R::zero(); 3]; 3];
    columns[2][2] = R::one();
    for a in 0..D {
        let mut column = [R::zero(); D];
        let slopes = Sample::First(a).of(element, reference.length, x);
        for (slope, vector) in slopes.into_iter().zip(&reference.vectors) {
            add_scaled(&mut column, slope, vector);
        }
        columns[a] = std::array::from_fn(|c| if c < D { column[c] } else { R::zero() });
    }
    match E::SECTION_DEGREE {
        0 => dot(&columns[0], &columns[0]).sqrt(),
        _ => dot(&columns[0], &cross(&columns[1], &columns[2])),
    }
}
