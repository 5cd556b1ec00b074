//! How a beam is modelled: an element, what gives it its elasticity, and the limit it goes to.

use ancf::material::{Blocks, Material, Tensor};
use ancf::prelude::*;
use ancf::scalar::Algebra;

/// Shear factor of the rods that made the references (Cowper's for a disk at Poisson ratio 0.3).
pub const SHEAR: f64 = 0.88636364;

/// Elements with what gives them their elasticity.
#[derive(Debug, Clone)]
pub struct Model<E, F> {
    /// Name in tables and legends.
    pub name: &'static str,
    /// The element.
    pub element: E,
    /// Its formulation.
    pub law: F,
    /// Where it goes on ever finer meshes.
    pub limit: Limit,
}

/// Which of the references a model answers to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Limit {
    /// The section-linear continuum without Poisson's ratio.
    Continuum,
    /// The rod.
    Rod,
}

/// A round beam along the x axis, of length 1 m.
#[derive(Debug, Clone, Copy)]
pub struct Specimen {
    /// Young's modulus (Pa).
    pub young: f64,
    /// Radius (m).
    pub radius: f64,
    /// Density (kg/m^3).
    pub density: f64,
}

impl Specimen {
    /// Its material with a Poisson ratio.
    ///
    /// # Errors
    /// For a ratio out of range.
    pub fn material<R: Real, const D: usize>(
        &self,
        poisson: f64,
    ) -> Result<SaintVenantKirchhoff<R, D>> {
        SaintVenantKirchhoff::isotropic(R::lit(self.young), R::lit(poisson))
    }

    /// Adds the beam to a scene.
    ///
    /// # Errors
    /// Whatever the library refuses.
    pub fn place<R, E, F, const D: usize, const S: usize>(
        &self,
        scene: &mut Scene<R, D>,
        model: &Model<E, F>,
        elements: usize,
    ) -> Result<Placed>
    where
        R: Real,
        E: Element<D, S> + Copy,
        F: Formulation<R, E, D, S> + Clone,
    {
        let section = Disk::new(R::lit(self.radius))?;
        let to = std::array::from_fn(|c| if c == 0 { R::one() } else { R::zero() });
        let beam = Beam::new(model.element, section, model.law.clone());
        let beam = beam.straight([R::zero(); D], to, elements);
        scene.add(beam.density(R::lit(self.density)))
    }
}

/// A material that beams sample at section points, one element after the other: the paper's way, without
/// what lanes of a chain make of it.
#[derive(Debug, Clone, Copy)]
pub struct PointByPoint<M>(pub M);

impl<R: Real, M: Material<R, D>, const D: usize> Material<R, D> for PointByPoint<M> {
    const LANES: bool = false;

    fn energy<T: Algebra<R>>(&self, strain: &Tensor<T, D>) -> T {
        self.0.energy(strain)
    }
    fn stress<T: Algebra<R>>(&self, strain: &Tensor<T, D>) -> Tensor<T, D> {
        self.0.stress(strain)
    }
    fn elasticity<T: Algebra<R>>(&self, strain: &Tensor<T, D>) -> Blocks<T, D> {
        self.0.elasticity(strain)
    }
    fn stiffness<T: Algebra<R>>(&self, strain: &Tensor<T, D>, c: &Tensor<T, D>) -> Blocks<T, D> {
        self.0.stiffness(strain, c)
    }
}
