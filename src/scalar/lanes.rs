//! simba's wide lanes as numbers of kernels: several models, or several elements, at once.

use num_traits::{One, Zero};
use simba::simd::{SimdComplexField, WideF32x4, WideF32x8, WideF64x4};

use super::jet::{self, Jet};
use super::{Algebra, Field, Scalar};

macro_rules! lanes {
    ($($t:ident of $r:ty),*) => {$(
        impl Scalar for $t {
            #[inline(always)]
            fn lit(x: f64) -> Self {
                Self::lift(x as $r)
            }
        }
        impl Field for $t {
            #[inline(always)]
            fn sqrt(self) -> Self {
                self.simd_sqrt()
            }
            #[inline(always)]
            fn recip(self) -> Self {
                Self::one() / self
            }
            #[inline(always)]
            fn exp(self) -> Self {
                self.simd_exp()
            }
            #[inline(always)]
            fn ln(self) -> Self {
                self.simd_ln()
            }
            #[inline(always)]
            fn sin(self) -> Self {
                self.simd_sin()
            }
            #[inline(always)]
            fn cos(self) -> Self {
                self.simd_cos()
            }
            #[inline(always)]
            fn frozen(self) -> Self {
                self
            }
        }
        impl Algebra<$r> for $t {
            // num-dual's numbers need an order, which lanes do not have.
            type Dual<const M: usize> = Jet<Self, M>;
            #[inline(always)]
            fn lift(r: $r) -> Self {
                $t(r.into())
            }
            #[inline(always)]
            fn times(self, r: $r) -> Self {
                self * Self::lift(r)
            }
            jet::by_jet!();
        }
    )*};
}
lanes!(WideF32x4 of f32, WideF32x8 of f32, WideF64x4 of f64);
