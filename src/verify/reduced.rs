//! Materials and kernels stripped of their closed forms, so that dual numbers give the rest: the
//! truth closed forms answer to, and what a law costs that has none.

use crate::formulation::ElementKernel;
use crate::material::{Blocks, Material, PoissonSplit, Tensor};
use crate::scalar::{Algebra, Real};

/// A material or an element kernel reduced to its energy: every derivative by dual numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ByEnergy<M>(pub M);

impl<R: Real, M: Material<R, D>, const D: usize> Material<R, D> for ByEnergy<M> {
    #[inline(always)]
    fn energy<T: Algebra<R>>(&self, strain: &Tensor<T, D>) -> T {
        self.0.energy(strain)
    }
}

impl<R, K, const D: usize, const S: usize> ElementKernel<R, D, S> for ByEnergy<K>
where
    R: Real,
    K: ElementKernel<R, D, S>,
{
    fn energy<T: Algebra<R>>(&self, u: &[[T; D]; S]) -> T {
        self.0.energy(u)
    }
}

/// A material reduced to its energy and stress: elasticity by dual numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ByStress<M>(pub M);

impl<R: Real, M: Material<R, D>, const D: usize> Material<R, D> for ByStress<M> {
    #[inline(always)]
    fn energy<T: Algebra<R>>(&self, strain: &Tensor<T, D>) -> T {
        self.0.energy(strain)
    }
    #[inline(always)]
    fn stress<T: Algebra<R>>(&self, strain: &Tensor<T, D>) -> Tensor<T, D> {
        self.0.stress(strain)
    }
}

/// A material that does not say that its elasticity is constant: a beam of it is sampled at section
/// points, which is what sections integrated once and for all answer to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ByPoints<M>(pub M);

impl<R: Real, M: Material<R, D>, const D: usize> Material<R, D> for ByPoints<M> {
    const LANES: bool = M::LANES;

    #[inline(always)]
    fn energy<T: Algebra<R>>(&self, strain: &Tensor<T, D>) -> T {
        self.0.energy(strain)
    }
    #[inline(always)]
    fn stress<T: Algebra<R>>(&self, strain: &Tensor<T, D>) -> Tensor<T, D> {
        self.0.stress(strain)
    }
    #[inline(always)]
    fn elasticity<T: Algebra<R>>(&self, strain: &Tensor<T, D>) -> Blocks<T, D> {
        self.0.elasticity(strain)
    }
    #[inline(always)]
    fn stiffness<T: Algebra<R>>(&self, strain: &Tensor<T, D>, c: &Tensor<T, D>) -> Blocks<T, D> {
        self.0.stiffness(strain, c)
    }
}

impl<M: PoissonSplit> PoissonSplit for ByPoints<M> {
    fn uncoupled(&self) -> Self {
        Self(self.0.uncoupled())
    }
    fn coupled(&self) -> Self {
        Self(self.0.coupled())
    }
}

/// An element kernel reduced to its energy and force: tangent by dual numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ByForce<K>(pub K);

impl<R, K, const D: usize, const S: usize> ElementKernel<R, D, S> for ByForce<K>
where
    R: Real,
    K: ElementKernel<R, D, S>,
{
    fn energy<T: Algebra<R>>(&self, u: &[[T; D]; S]) -> T {
        self.0.energy(u)
    }
    fn force<T: Algebra<R>>(&self, u: &[[T; D]; S], q: &mut [[T; D]; S]) {
        self.0.force(u, q);
    }
    fn has_strain(&self) -> bool {
        self.0.has_strain()
    }
    fn secant<T: Algebra<R>>(
        &self,
        viscosity: R,
        from: &[[T; D]; S],
        to: &[[T; D]; S],
        q: &mut [[T; D]; S],
    ) {
        self.0.secant(viscosity, from, to, q);
    }
}
