//! A kernel called, not inlined. Lanes need the functions of kernels inlined down to the arithmetic;
//! where one element is evaluated at a time, in many places, that multiplies machine code for nothing.

use super::{ElementKernel, Tangent};
use crate::scalar::{Algebra, Real};

/// A kernel whose functions are compiled once per number type, however many places call them.
#[derive(Debug, Clone)]
pub(crate) struct Outlined<K>(pub(crate) K);

impl<R, K, const D: usize, const S: usize> ElementKernel<R, D, S> for Outlined<K>
where
    R: Real,
    K: ElementKernel<R, D, S>,
{
    #[inline(never)]
    fn energy<T: Algebra<R>>(&self, u: &[[T; D]; S]) -> T {
        self.0.energy(u)
    }

    #[inline(never)]
    fn force<T: Algebra<R>>(&self, u: &[[T; D]; S], q: &mut [[T; D]; S]) {
        self.0.force(u, q);
    }

    #[inline(never)]
    fn tangent<T: Algebra<R>>(
        &self,
        u: &[[T; D]; S],
        q: &mut [[T; D]; S],
        k: &mut Tangent<T, D, S>,
    ) {
        self.0.tangent(u, q, k);
    }

    #[inline(never)]
    fn upper_tangent<T: Algebra<R>>(
        &self,
        u: &[[T; D]; S],
        q: &mut [[T; D]; S],
        k: &mut Tangent<T, D, S>,
    ) {
        self.0.upper_tangent(u, q, k);
    }

    fn has_strain(&self) -> bool {
        self.0.has_strain()
    }

    #[inline(never)]
    fn secant<T: Algebra<R>>(
        &self,
        viscosity: R,
        from: &[[T; D]; S],
        to: &[[T; D]; S],
        q: &mut [[T; D]; S],
    ) {
        self.0.secant(viscosity, from, to, q);
    }

    #[inline(never)]
    fn secant_tangent<T: Algebra<R>>(
        &self,
        viscosity: R,
        from: &[[T; D]; S],
        to: &[[T; D]; S],
        k: &mut Tangent<T, D, S>,
    ) {
        self.0.secant_tangent(viscosity, from, to, k);
    }
}
