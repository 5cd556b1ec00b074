//! Formulations: which strain energy an element carries and where it is sampled. A formulation
//! turns an element, a section and a reference geometry into an [`ElementKernel`]: energy, force
//! and tangent of one element over any number type. Locking remedies live here, as choices of
//! what is sampled where.

mod continuum;
mod inertia;
mod law;
mod rank;
mod sampled;

pub use continuum::{Continuum, ContinuumKernel, Layer};
pub use inertia::Inertia;
pub use law::{ContinuumSection, SectionLaw, SectionStiffness};
pub(crate) use sampled::reference_vectors;
pub use sampled::{Sample, SampledKernel};

use std::fmt::Debug;

use crate::element::Element;
use crate::error::{Error, Result};
use crate::quadrature::Cubature;
use crate::scalar::{Algebra, Real};
use crate::section::Section;

/// Tangent of one element: `k[i][c][j][d]` is the derivative of component `c` of the force on
/// nodal vector `i` by component `d` of nodal vector `j`; flattened, a row-major matrix in the
/// order of the coordinates.
pub type Tangent<T, const D: usize, const S: usize> = [[[[T; D]; S]; D]; S];

/// Reference geometry of one straight element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reference<R, const D: usize> {
    /// Length (m) (`l` in eq. 5).
    pub length: R,
    /// Orthonormal material frame: `frame[a]` is the direction of material axis `a` (0 along the
    /// beam) in global components.
    pub frame: [[R; D]; D],
}

/// Energy, force and tangent of one element with nodal displacements `u` (current minus reference
/// nodal vectors). Force and tangent are *added* to what they are given.
///
/// A kernel given by its energy alone gets both by dual numbers, one nodal vector at a time.
pub trait ElementKernel<R: Real, const D: usize, const S: usize>:
    Debug + Send + Sync + 'static
{
    /// Strain energy (J) (eq. 10).
    fn energy<T: Algebra<R>>(&self, u: &[[T; D]; S]) -> T;

    /// Adds the elastic force `Q_s = dU/de` (eq. 14).
    fn force<T: Algebra<R>>(&self, u: &[[T; D]; S], q: &mut [[T; D]; S]) {
        for i in 0..S {
            let energy = self.energy(&law::varied(u, i));
            for c in 0..D {
                q[i][c] += T::derivative::<D>(&energy, c);
            }
        }
    }

    /// Adds the elastic force and the tangent stiffness `dQ_s/de`.
    fn tangent<T: Algebra<R>>(
        &self,
        u: &[[T; D]; S],
        q: &mut [[T; D]; S],
        k: &mut Tangent<T, D, S>,
    ) {
        for j in 0..S {
            let mut dual = [[T::zero().constant::<D>(); D]; S];
            self.force(&law::varied(u, j), &mut dual);
            for c in 0..D {
                q[j][c] += T::real_part::<D>(&dual[j][c]);
                for i in 0..S {
                    for d in 0..D {
                        k[i][c][j][d] += T::derivative::<D>(&dual[i][c], d);
                    }
                }
            }
        }
    }
}

/// What gives an element of family `E` its elasticity.
pub trait Formulation<R: Real, E: Element<D, S>, const D: usize, const S: usize>:
    Debug + Send + Sync
{
    /// The kernel this formulation makes.
    type Kernel: ElementKernel<R, D, S>;

    /// The kernel of one element of this reference geometry.
    ///
    /// # Errors
    /// Whatever is wrong with the sampling asked for, above all a rule that leaves zero-energy
    /// modes ([`Error::ZeroEnergyModes`]).
    fn kernel(
        &self,
        element: &E,
        reference: &Reference<R, D>,
        section: &dyn Section<R>,
    ) -> Result<Self::Kernel>;
}

impl<R, E, F, const D: usize, const S: usize> Formulation<R, E, D, S> for &F
where
    R: Real,
    E: Element<D, S>,
    F: Formulation<R, E, D, S>,
{
    type Kernel = F::Kernel;

    fn kernel(
        &self,
        element: &E,
        reference: &Reference<R, D>,
        section: &dyn Section<R>,
    ) -> Result<Self::Kernel> {
        (**self).kernel(element, reference, section)
    }
}

/// A rule in the cross coordinates of a `D`-dimensional scene: points `X = (0, y[, z])` (m) and
/// weights (m^2). In the plane the section is projected (weights carry the width).
pub(crate) fn section_points<R: Real, const D: usize>(
    section: &dyn Section<R>,
    degree: usize,
) -> Result<Vec<([R; D], R)>> {
    fn embed<R: Real, const C: usize, const D: usize>(rule: &Cubature<R, C>) -> Vec<([R; D], R)> {
        let at = |y: [R; C]| std::array::from_fn(|a| if a == 0 { R::zero() } else { y[a - 1] });
        rule.iter().map(|(y, w)| (at(y), w)).collect()
    }
    match D {
        2 => Ok(embed(&section.planar_rule(degree)?)),
        3 => Ok(embed(&section.rule(degree)?)),
        _ => Err(Error::Unsupported {
            what: format!("a scene in {D} dimensions"),
            remedy: "use D = 2 (plane) or D = 3 (space)",
        }),
    }
}
