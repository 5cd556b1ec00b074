//! Cables and shear-rigid beams: an axis with stretching and bending stiffness, no section frame
//! and no torsion. The literature has two strain energies of this kind under one name; both are
//! here, each given by its energy alone.

use super::change::changes;
use super::sampled::{Sample, SampledKernel};
use super::{Formulation, Reference, SectionLaw};
use crate::element::Element;
use crate::error::{Error, Result, positive};
use crate::material::SaintVenantKirchhoff;
use crate::quadrature::gauss_legendre;
use crate::scalar::{Algebra, Real, Scalar};
use crate::section::Section;
use crate::tensor::dot;

/// Which strains the energy `1/2 EA eps^2 + 1/2 EI kappa^2` of a cable is made of. They differ by
/// terms of the size of the axial strain: 0.1 % in the benchmark of Gerstmayr and Irschik (2008).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum CableEnergy {
    /// Engineering strain `|r'| - 1` and material curvature, the rotation of the tangent per
    /// *reference* length, `|r' x r''| / |r'|^2`: the rod of Reissner without shear, the energy
    /// that Gerstmayr and Irschik recommend.
    #[default]
    MaterialCurvature,
    /// Green-Lagrange strain `(r'.r' - 1) / 2` and geometric curvature, the rotation of the
    /// tangent per *current* length, `|r' x r''| / |r'|^3`: the energy of the original cable
    /// (Berzeri and Shabana 2000).
    GeometricCurvature,
}

/// Where the stiffness comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Source<R> {
    Young(R),
    Constants { axial: R, bending: R },
}

/// The strain energy of an Euler-Bernoulli beam, for elements that need no section slopes.
///
/// Bending in space is isotropic: without a section frame there is nothing that could tell two
/// stiffnesses apart, and a section with `Iyy != Izz` is refused. In space the reference must be
/// straight.
///
/// ```
/// use ancf::formulation::CableEnergy;
/// use ancf::prelude::*;
///
/// let steel = SaintVenantKirchhoff::<f64, 2>::isotropic(2.07e11, 0.3)?;
/// let mut scene = Scene::<f64, 2>::new();
/// let energy = EulerBernoulli::new(&steel).with_energy(CableEnergy::GeometricCurvature);
/// let beam = Beam::new(Cable, Rectangle::new(0.1, 0.1)?, energy);
/// let beam = scene.add(beam.straight([0.0, 0.0], [2.0, 0.0], 8))?;
/// # let _ = beam;
/// # Ok::<(), ancf::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EulerBernoulli<R> {
    source: Source<R>,
    energy: CableEnergy,
    stretching: usize,
    bending: usize,
}

impl<R: Real> EulerBernoulli<R> {
    /// `EA` and `EI` from Young's modulus of the material and the area and second moment of the
    /// beam's section.
    pub fn new<const D: usize>(material: &SaintVenantKirchhoff<R, D>) -> Self {
        Self::from(Source::Young(material.young()))
    }

    /// Given stiffness: `axial` `EA` (N) and `bending` `EI` (N m^2). The beam's section is then
    /// needed for the mass only.
    ///
    /// # Errors
    /// [`Error::NotPositive`] for a stiffness that is not.
    pub fn with_stiffness(axial: R, bending: R) -> Result<Self> {
        Ok(Self::from(Source::Constants {
            axial: positive("axial stiffness EA [N]", axial)?,
            bending: positive("bending stiffness EI [N m^2]", bending)?,
        }))
    }

    /// 5 axial points for stretching, which integrate the Green-Lagrange energy of a cubic axis
    /// exactly, and 3 for bending, which do so for the straight one.
    fn from(source: Source<R>) -> Self {
        Self {
            source,
            energy: CableEnergy::default(),
            stretching: 5,
            bending: 3,
        }
    }

    /// The same stiffness with these strains.
    #[must_use]
    pub fn with_energy(self, energy: CableEnergy) -> Self {
        Self { energy, ..self }
    }

    /// The same with other numbers of Gauss points along an element, for stretching and bending;
    /// 5 and 3 by default.
    #[must_use]
    pub fn sampled(self, stretching: usize, bending: usize) -> Self {
        Self {
            stretching,
            bending,
            ..self
        }
    }

    /// `EA` and `EI` on this section, in `dimension` dimensions.
    fn stiffness(&self, section: &dyn Section<R>, dimension: usize) -> Result<(R, R)> {
        let young = match self.source {
            Source::Constants { axial, bending } => return Ok((axial, bending)),
            Source::Young(young) => young,
        };
        let p = section.properties()?;
        let small = (p.iyy + p.izz) * R::lit(1e4 * R::EPSILON);
        if dimension > 2 && ((p.iyy - p.izz).abs() > small || p.iyz.abs() > small) {
            return Err(Error::Unsupported {
                what: format!(
                    "a cable in space with the second moments {}, {} and {} m^4",
                    p.iyy.value(),
                    p.izz.value(),
                    p.iyz.value()
                ),
                remedy: "without a section frame bending is isotropic: take a section with Iyy = Izz, EulerBernoulli::with_stiffness, or an element with cross slopes",
            });
        }
        Ok((young * p.area, young * p.izz))
    }
}

/// Kernel of an [`EulerBernoulli`] beam.
pub type CableKernel<R, const D: usize, const S: usize> =
    SampledKernel<R, CableSection<R>, D, S, 2>;

impl<R: Real, E: Element<D, S>, const D: usize, const S: usize> Formulation<R, E, D, S>
    for EulerBernoulli<R>
{
    type Kernel = CableKernel<R, D, S>;

    fn kernel(
        &self,
        element: &E,
        reference: &Reference<R, D, S>,
        section: &dyn Section<R>,
    ) -> Result<Self::Kernel> {
        if D > 2 && !reference.is_straight() {
            return Err(Error::Unsupported {
                what: "a cable in space that is curved from the start".into(),
                remedy: "without a section frame nothing says to which side it is curved: use an element with cross slopes, or a planar scene",
            });
        }
        let (axial, bending) = self.stiffness(section, D)?;
        let samples = [Sample::First(0), Sample::Second(0, 0)];
        let stretching = CableSection::Stretching(self.energy, axial);
        let bending = CableSection::Bending(self.energy, bending);
        let mut kernel = SampledKernel::new();
        for (law, points) in [(stretching, self.stretching), (bending, self.bending)] {
            kernel = kernel.with_part(element, reference, law, samples, &gauss_legendre(points)?);
        }
        Ok(kernel)
    }

    fn resampled(&self, axial: usize, _section_degree: usize) -> Option<Self> {
        Some(self.sampled(axial, axial))
    }
}

/// Energy per unit length of a cable as a function of `r'` and `r''`, one part at a time because
/// the two are sampled with different rules.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CableSection<R> {
    /// `1/2 EA eps^2`, with `EA` (N).
    Stretching(CableEnergy, R),
    /// `1/2 EI kappa^2`, with `EI` (N m^2).
    Bending(CableEnergy, R),
}

impl<R: Real, const D: usize> SectionLaw<R, D, 2> for CableSection<R> {
    #[inline]
    fn energy<T: Algebra<R>>(&self, reference: &[[R; D]; 2], h: &[[T; D]; 2]) -> T {
        let half = R::lit(0.5);
        let square0 = dot(&reference[0], &reference[0]);
        // Reference length per unit of the coordinate X: 1 up to rounding on a straight axis.
        let length0 = square0.sqrt();
        let [tangent, bend] = changes(reference, h);
        let square = dot(&tangent, &tangent);
        match *self {
            Self::Stretching(energy, stiffness) => {
                let green = square.change.times(half / square0);
                let strain = match energy {
                    CableEnergy::GeometricCurvature => green,
                    // sqrt(1 + 2 E) - 1 without the difference of numbers near one.
                    CableEnergy::MaterialCurvature => {
                        let twice = green.times(R::lit(2.0));
                        twice / (T::one() + (T::one() + twice).sqrt())
                    }
                };
                (strain * strain).times(half * stiffness * length0)
            }
            Self::Bending(energy, stiffness) => {
                let per_length = square.rsqrt();
                let (scale, unit) = match energy {
                    CableEnergy::MaterialCurvature => (per_length * per_length, length0.recip()),
                    CableEnergy::GeometricCurvature => {
                        (per_length * per_length * per_length, length0)
                    }
                };
                // The square of the curvature, never the curvature: its root has no derivative on
                // a straight axis.
                let mut twice = T::zero();
                for turn in wedge(&tangent, &bend) {
                    let curvature = (turn * scale).change;
                    twice += curvature * curvature;
                }
                twice.times(half * stiffness * unit)
            }
        }
    }
}

/// Components of `a x b` in space; in the plane the one component that there is, with its sign.
#[inline(always)]
fn wedge<T: Scalar, const D: usize>(a: &[T; D], b: &[T; D]) -> [T; 3] {
    std::array::from_fn(|k| match (k + 1, k + 2) {
        (i, j) if D == 3 => a[i % D] * b[j % D] - a[j % D] * b[i % D],
        _ if k == 0 => a[0] * b[1] - a[1] * b[0],
        _ => T::zero(),
    })
}
