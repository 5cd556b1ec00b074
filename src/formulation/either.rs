//! One of two kernels, chosen when a scene is assembled: what makes a formulation of several paths a
//! single type, with one choice per element and none in its arithmetic.

use super::{ElementKernel, KernelWork, Tangent};
use crate::scalar::{Algebra, Real};

/// One of two kernels.
///
/// # Panics
/// In all that is asked of it, if it is of a kind that is [`ABSENT`](ElementKernel::ABSENT).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Either<A, B> {
    /// The first.
    First(A),
    /// The second.
    Second(B),
}

/// Calls a method of the kernel there is, constants of blocks telling which there can be.
macro_rules! of_either {
    ($self:ident.$method:ident($($argument:expr),*)) => {
        match $self {
            Self::First(kernel) if const { !A::ABSENT } => kernel.$method($($argument),*),
            Self::Second(kernel) if const { !B::ABSENT } => kernel.$method($($argument),*),
            _ => absent(),
        }
    };
}

/// Never reached from a beam: a form is made of materials that are constant only, a frame of kernels that do
/// not turn, and parts of an absent law are refused where a sampled kernel is given them.
#[cold]
#[inline(never)]
fn absent() -> ! {
    unreachable!("no element is made of a kernel that is ABSENT")
}

impl<R, A, B, const D: usize, const S: usize> ElementKernel<R, D, S> for Either<A, B>
where
    R: Real,
    A: ElementKernel<R, D, S>,
    B: ElementKernel<R, D, S>,
{
    const ABSENT: bool = A::ABSENT && B::ABSENT;
    const TURNS: bool = (A::ABSENT || A::TURNS) && (B::ABSENT || B::TURNS);

    #[inline(always)]
    fn dispatch<W: KernelWork<R, D, S>>(&self, work: W) -> W::Output {
        of_either!(self.dispatch(work))
    }

    #[inline(always)]
    fn energy<T: Algebra<R>>(&self, u: &[[T; D]; S]) -> T {
        of_either!(self.energy(u))
    }

    #[inline(always)]
    fn force<T: Algebra<R>>(&self, u: &[[T; D]; S], q: &mut [[T; D]; S]) {
        of_either!(self.force(u, q));
    }

    #[inline(always)]
    fn tangent<T: Algebra<R>>(
        &self,
        u: &[[T; D]; S],
        q: &mut [[T; D]; S],
        k: &mut Tangent<T, D, S>,
    ) {
        of_either!(self.tangent(u, q, k));
    }

    #[inline(always)]
    fn upper_tangent<T: Algebra<R>>(&self, u: &[[T; D]; S], k: &mut Tangent<T, D, S>) {
        of_either!(self.upper_tangent(u, k));
    }

    fn has_strain(&self) -> bool {
        of_either!(self.has_strain())
    }

    #[inline(always)]
    fn secant<T: Algebra<R>>(
        &self,
        viscosity: R,
        from: &[[T; D]; S],
        to: &[[T; D]; S],
        q: &mut [[T; D]; S],
    ) {
        of_either!(self.secant(viscosity, from, to, q));
    }

    #[inline(always)]
    fn secant_tangent<T: Algebra<R>>(
        &self,
        viscosity: R,
        from: &[[T; D]; S],
        to: &[[T; D]; S],
        k: &mut Tangent<T, D, S>,
    ) {
        of_either!(self.secant_tangent(viscosity, from, to, k));
    }
}
