//! The textbook form of the strain: what the library's form is measured against.

use crate::element::Element;
use crate::error::Result;
use crate::formulation::{ElementKernel, Formulation, Reference, Sample, section_points};
use crate::material::Material;
use crate::quadrature::gauss_legendre;
use crate::scalar::{Algebra, Real};
use crate::section::Section;
use crate::tensor::{add_times, dot};

/// A fully integrated straight continuum beam as textbooks write it: at every point of the volume
/// `J = e G` from the total nodal vectors `e` and `E = (J^T J - I) / 2`, which squares numbers near
/// one to find strains that are small.
///
/// Its kernel takes the total nodal vectors `e` where others take displacements, so that what the
/// form loses is not mixed with the rounding of a sum. For measurements, not for use.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Textbook<M>(pub M);

/// Kernel of a [`Textbook`] beam: its table of gradients and weights.
#[derive(Debug, Clone)]
pub struct TextbookKernel<R, M, const D: usize, const S: usize> {
    material: M,
    points: Vec<([[R; D]; S], R)>,
}

impl<R, E, M, const D: usize, const S: usize> Formulation<R, E, D, S> for Textbook<M>
where
    R: Real,
    E: Element<D, S>,
    M: Material<R, D>,
{
    type Kernel = TextbookKernel<R, M, D, S>;

    fn kernel(
        &self,
        element: &E,
        reference: &Reference<R, D, S>,
        section: &dyn Section<R>,
    ) -> Result<Self::Kernel> {
        let length = reference.length;
        let across = section_points::<R, D>(section, 5)?;
        let mut points = Vec::new();
        for ([xi], along) in gauss_legendre::<R>(5)?.iter() {
            for (y, area) in &across {
                let mut x = y.map(|y| y / length);
                x[0] = xi;
                let mut gradient = [[R::zero(); D]; S];
                for a in 0..D {
                    let slopes = Sample::First(a).of(element, length, x);
                    for i in 0..S {
                        gradient[i][a] = slopes[i];
                    }
                }
                points.push((gradient, along * length * *area));
            }
        }
        let material = self.0.clone();
        Ok(TextbookKernel { material, points })
    }
}

impl<R, M, const D: usize, const S: usize> ElementKernel<R, D, S> for TextbookKernel<R, M, D, S>
where
    R: Real,
    M: Material<R, D>,
{
    fn energy<T: Algebra<R>>(&self, e: &[[T; D]; S]) -> T {
        let mut energy = T::zero();
        for (gradient, weight) in &self.points {
            let mut j = [[T::zero(); D]; D];
            for i in 0..S {
                for a in 0..D {
                    add_times(&mut j[a], gradient[i][a], &e[i]);
                }
            }
            let strain = std::array::from_fn(|a| {
                std::array::from_fn(|b| {
                    let unit = if a == b { T::one() } else { T::zero() };
                    (dot(&j[a], &j[b]) - unit).times(R::lit(0.5))
                })
            });
            energy += self.material.energy(&strain).times(*weight);
        }
        energy
    }
}
