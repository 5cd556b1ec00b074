//! Continuum beams: a material sampled over the volume of the element by an axial Gauss rule
//! times a section cubature (eqs. 17 and 18 of Orzechowski 2012). Every locking remedy is a list
//! of [`Layer`]s: which part of the material is sampled with which rule. Those of a material that is
//! [`Material::CONSTANT`] are all integrated once, when the kernel is made.

use super::either::Either;
use super::gram::{Form, GramKernel};
use super::point::PointSection;
use super::products::{Direct, InParts};
use super::rank::{Stocky, check_rank};
use super::sampled::{SampledKernel, section_samples};
use super::{Formulation, Reference, section_points};
use crate::element::Element;
use crate::error::{Error, Result};
use crate::material::{Material, PoissonSplit};
use crate::quadrature::gauss_legendre;
use crate::scalar::Real;
use crate::section::Section;

/// One part of the material and where it is sampled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layer<M> {
    /// The part of the material.
    pub material: M,
    /// Number of Gauss points along the axis.
    pub axial: usize,
    /// Where the section is sampled.
    pub across: Across,
}

/// Where a section is sampled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Across {
    /// By the section's rule, exact to this polynomial degree: `2 s - 1` for the paper's rule of
    /// order `s`.
    Degree(usize),
    /// At the centroid alone, with the whole area. Not the same as a rule of degree 1, which may
    /// have points off the centroid and then feels part of the bending.
    Centroid,
}

/// A continuum beam: the sum of its [`Layer`]s.
///
/// ```
/// use ancf::formulation::Continuum;
/// use ancf::material::SaintVenantKirchhoff;
///
/// let rubber = SaintVenantKirchhoff::<f64, 3>::isotropic(2e7, 0.3)?;
/// let exact = Continuum::full(rubber); // 5 axial points, section rule of degree 5
/// let paper = Continuum::reduced(rubber); // 4 axial points, section rule of order 2
/// let remedy = Continuum::selective_reduced(rubber); // no Poisson locking
/// assert_eq!(remedy.layers().len(), 2);
/// # let _ = (exact, paper);
/// # Ok::<(), ancf::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Continuum<M> {
    layers: Vec<Layer<M>>,
}

/// Axial points that integrate the quartic energy of a cubic axis exactly.
const AXIAL: usize = 5;
/// Section degree that integrates the quartic energy of a section-linear element exactly.
const SECTION: usize = 5;

impl<M> Continuum<M> {
    /// Exact integration for the paper's element and St Venant-Kirchhoff: 5 axial points, section
    /// rule of degree 5 (7 points on a disk, 9 on a rectangle). Locks when the Poisson ratio is
    /// not zero.
    pub fn full(material: M) -> Self {
        Self::sampled(material, AXIAL, SECTION)
    }

    /// The paper's faster rule: 4 axial points, section rule of order 2 (4 points). Not isotropic
    /// on a disk, see the notes of the paper's reproduction.
    pub fn reduced(material: M) -> Self {
        Self::sampled(material, 4, 3)
    }

    /// Any pair of orders: `axial` Gauss points along the beam, a section rule exact to
    /// `section_degree`.
    pub fn sampled(material: M, axial: usize, section_degree: usize) -> Self {
        Self::layered([Layer {
            material,
            axial,
            across: Across::Degree(section_degree),
        }])
    }

    /// Any sum of layers: the general remedy.
    pub fn layered(layers: impl IntoIterator<Item = Layer<M>>) -> Self {
        Self {
            layers: layers.into_iter().collect(),
        }
    }

    /// The same layers with `points` Gauss points along the axis in every one. The quadratic
    /// element wants 2, the only points where its rotation, which is quadratic along the element,
    /// can follow the slope of its axis, which is linear; with 3 it bends too little by one part
    /// in `4 n^2` on `n` elements.
    ///
    /// ```
    /// use ancf::prelude::*;
    ///
    /// let rubber = SaintVenantKirchhoff::<f64, 3>::isotropic(2e7, 0.3)?;
    /// let remedy = Continuum::selective_reduced(rubber).axial(2);
    /// assert!(remedy.layers().iter().all(|layer| layer.axial == 2));
    /// # Ok::<(), ancf::Error>(())
    /// ```
    #[must_use]
    pub fn axial(mut self, points: usize) -> Self {
        for layer in &mut self.layers {
            layer.axial = points;
        }
        self
    }

    /// The parts that are summed.
    pub fn layers(&self) -> &[Layer<M>] {
        &self.layers
    }
}

impl<M: PoissonSplit> Continuum<M> {
    /// The zero-Poisson option: only the part of the material that does not couple normal strains
    /// (Young's modulus for each, the true shear modulus), fully integrated.
    pub fn zero_poisson(material: M) -> Self {
        Self::full(material.uncoupled())
    }

    /// Selective reduced integration (enhanced continuum mechanics of Gerstmayr, Matikainen and
    /// Mikkola 2008): the uncoupled part over the volume, the Poisson-coupled part on the axis
    /// only. Cures Poisson locking.
    pub fn selective_reduced(material: M) -> Self {
        Self::layered([
            Layer {
                material: material.uncoupled(),
                axial: AXIAL,
                across: Across::Degree(SECTION),
            },
            Layer {
                material: material.coupled(),
                axial: AXIAL,
                across: Across::Centroid,
            },
        ])
    }
}

/// Kernel of a [`Continuum`] beam; `K = 2 D - 1`. Layers of a material that is [`Material::CONSTANT`] are
/// integrated once and for all, everything else is sampled at every evaluation, on a straight reference or
/// on another.
pub type ContinuumKernel<R, M, const D: usize, const S: usize, const K: usize> = Either<
    Either<GramKernel<R, M, Direct, D, S>, GramKernel<R, M, InParts<R, D, S>, D, S>>,
    Either<PointKernel<R, M, D, S, K, true>, PointKernel<R, M, D, S, K, false>>,
>;

/// Kernel of a material sampled at section points.
type PointKernel<R, M, const D: usize, const S: usize, const K: usize, const STRAIGHT: bool> =
    SampledKernel<R, PointSection<R, M, D, STRAIGHT>, D, S, K>;

impl<M> Continuum<M> {
    /// Section points of a layer.
    fn points<R: Real, const D: usize>(
        layer: &Layer<M>,
        section: &dyn Section<R>,
    ) -> Result<Vec<([R; D], R)>> {
        match layer.across {
            Across::Degree(degree) => section_points(section, degree),
            Across::Centroid => Ok(vec![centroid(section)?]),
        }
    }

    /// The energy of all layers as a form, if their material's elasticity is constant.
    fn form<R, E, const D: usize, const S: usize, const K: usize>(
        &self,
        element: &E,
        reference: &Reference<R, D, S>,
        section: &dyn Section<R>,
    ) -> Result<Option<Form<R, D, S>>>
    where
        R: Real,
        E: Element<D, S>,
        M: Material<R, D>,
    {
        if self.layers.is_empty() {
            return Err(Error::TooFew {
                what: "number of layers of a continuum",
                value: 0,
                least: 1,
                remedy: "give at least one layer, or use Continuum::full",
            });
        }
        if !M::CONSTANT {
            return Ok(None);
        }
        let moduli = |layer: &Layer<M>| layer.material.constant_elasticity();
        let Some(moduli) = self.layers.iter().map(moduli).collect::<Option<Vec<_>>>() else {
            return Err(Error::Unsupported {
                what: format!(
                    "{self:?}, of a material that is CONSTANT and has no constant_elasticity"
                ),
                remedy: "give the moduli of a material whose elasticity is constant, or leave Material::CONSTANT false",
            });
        };
        let samples: [_; K] = section_samples(element, reference.length)?;
        let mut form = Form::new();
        for (layer, moduli) in self.layers.iter().zip(moduli) {
            let axial = gauss_legendre(layer.axial)?;
            let points = Self::points(layer, section)?;
            form.add((element, reference), samples, &axial, &moduli, &points);
        }
        Ok(Some(form))
    }

    fn kernel_of<R, E, const D: usize, const S: usize, const K: usize>(
        &self,
        element: &E,
        reference: &Reference<R, D, S>,
        section: &dyn Section<R>,
    ) -> Result<ContinuumKernel<R, M, D, S, K>>
    where
        R: Real,
        E: Element<D, S>,
        M: Material<R, D>,
    {
        if let Some(form) = self.form::<R, E, D, S, K>(element, reference, section)? {
            return Ok(Either::First(Either::First(
                form.kernel::<E, _, _>(reference),
            )));
        }
        Ok(Either::Second(match reference.is_straight() {
            true => Either::First(self.sampled_kernel(element, reference, section)?),
            false => Either::Second(self.sampled_kernel(element, reference, section)?),
        }))
    }

    fn sampled_kernel<R, E, const D: usize, const S: usize, const K: usize, const STRAIGHT: bool>(
        &self,
        element: &E,
        reference: &Reference<R, D, S>,
        section: &dyn Section<R>,
    ) -> Result<PointKernel<R, M, D, S, K, STRAIGHT>>
    where
        R: Real,
        E: Element<D, S>,
        M: Material<R, D>,
    {
        let samples = section_samples(element, reference.length)?;
        let mut kernel = SampledKernel::new();
        for layer in &self.layers {
            let points = Self::points(layer, section)?;
            let law = PointSection::new(layer.material.clone(), points);
            let axial = gauss_legendre(layer.axial)?;
            kernel = kernel.with_part(element, reference, law, samples, &axial);
        }
        Ok(kernel)
    }
}

/// The centroid `(0, y[, z])` (m) with the area (m^2) as its weight.
fn centroid<R: Real, const D: usize>(section: &dyn Section<R>) -> Result<([R; D], R)> {
    let properties = section.properties()?;
    let at = |a| {
        if a == 0 {
            R::zero()
        } else {
            properties.centroid[a - 1]
        }
    };
    Ok((std::array::from_fn(at), properties.area))
}

macro_rules! dimension {
    ($d:literal, $k:literal) => {
        impl<R, M, E, const S: usize> Formulation<R, E, $d, S> for Continuum<M>
        where
            R: Real,
            M: Material<R, $d>,
            E: Element<$d, S>,
        {
            type Kernel = ContinuumKernel<R, M, $d, S, $k>;

            fn kernel(
                &self,
                element: &E,
                reference: &Reference<R, $d, S>,
                section: &dyn Section<R>,
            ) -> Result<Self::Kernel> {
                self.kernel_of(element, reference, section)
            }

            fn turning_kernel(
                &self,
                element: &E,
                reference: &Reference<R, $d, S>,
                section: &dyn Section<R>,
            ) -> Result<Option<Self::Kernel>> {
                let form = self.form::<R, E, $d, S, $k>(element, reference, section)?;
                let kernel = |form: Form<R, $d, S>| form.kernel::<E, _, _>(reference);
                Ok(form.map(|form| Either::First(Either::Second(kernel(form)))))
            }

            fn resampled(&self, axial: usize, section_degree: usize) -> Option<Self> {
                Some(Self::layered(self.layers.iter().map(|layer| Layer {
                    material: layer.material.clone(),
                    axial,
                    across: Across::Degree(section_degree),
                })))
            }

            fn check(&self, element: &E, section: &dyn Section<R>) -> Result<()> {
                check_rank(self, element, R::one(), &Stocky::new(section)?)
            }
        }
    };
}
dimension!(2, 3);
dimension!(3, 5);
