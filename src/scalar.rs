//! Number types. A kernel takes any [`Scalar`] (a ring: no division, no order, no square
//! root), so that one source serves floats, SIMD lanes and dual numbers; a solver takes any
//! [`Real`], which adds order and elementary functions. [`Algebra`] says that a kernel's number
//! type can be mixed with the parameters of a model stored in another one: lanes over `f64`,
//! dual numbers over `f32`, and every type over itself.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use num_dual::{Dual, DualNumCopy, DualSVec, HyperDual};
use num_traits::{Float, One, Zero};
use simba::simd::{WideF32x4, WideF32x8, WideF64x4};

/// What a kernel needs of a number: ring operations and constants.
///
/// Implemented for `f32`, `f64`, simba's wide lanes and num-dual's [`Dual`], [`DualSVec`] and
/// [`HyperDual`] over any of the reals (nested as deep as wanted).
///
/// ```
/// use ancf::scalar::Scalar;
/// use num_dual::Dual64;
///
/// fn quartic<T: Scalar>(x: T) -> T {
///     let square = x * x;
///     square * square + T::lit(0.5)
/// }
/// assert_eq!(quartic(2.0_f32), 16.5);
/// let slope = quartic(Dual64::from_re(2.0).derivative());
/// assert_eq!((slope.re, slope.eps), (16.5, 32.0));
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` cannot be used as the number type of a kernel",
    note = "kernels run in f32, f64, simba's WideF32x4, WideF32x8 and WideF64x4, and num-dual's Dual, DualSVec and HyperDual",
    note = "a number type of your own needs `impl Scalar` (ring operations and `lit`) and `impl Algebra<R>` for the reals its models are stored in"
)]
pub trait Scalar:
    Copy
    + Debug
    + Send
    + Sync
    + 'static
    + Zero
    + One
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
{
    /// The constant `x`, rounded to this type.
    fn lit(x: f64) -> Self;
}

/// Numbers that contain the reals `R`: a value of `R` can be lifted into them and can scale
/// them. Every [`Scalar`] is an algebra over itself.
#[diagnostic::on_unimplemented(
    message = "a model stored in `{R}` cannot be evaluated in `{Self}`",
    note = "`{Self}` must be `{R}` itself, a lane type of it, or a dual number over it"
)]
pub trait Algebra<R>: Scalar {
    /// The constant `r` in this type.
    fn lift(r: R) -> Self;
    /// `r * self`.
    fn times(self, r: R) -> Self;
}

impl<T: Scalar> Algebra<T> for T {
    #[inline(always)]
    fn lift(r: T) -> T {
        r
    }
    #[inline(always)]
    fn times(self, r: T) -> T {
        self * r
    }
}

/// What a solver needs of a number: a [`Scalar`] with order, division, elementary functions and
/// a rounding unit. `f32`, `f64` and dual numbers over them; dual numbers compare by their real
/// part, so a simulation in duals takes the very steps of the plain one.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a real number type of the solvers",
    note = "solvers run in f32, f64 and in num-dual's Dual and DualSVec over them"
)]
pub trait Real: Scalar + DualNumCopy {
    /// Distance from 1 to the next number of the real part's type.
    const EPSILON: f64;
    /// The real part, in double precision: for messages, plots and decisions that need no more.
    fn value(self) -> f64;
    /// Whether the value (and every derivative it carries) is finite.
    fn finite(self) -> bool;
    /// The larger of two by real part.
    #[inline]
    fn larger(self, other: Self) -> Self {
        if other > self { other } else { self }
    }
    /// The smaller of two by real part.
    #[inline]
    fn smaller(self, other: Self) -> Self {
        if other < self { other } else { self }
    }
}

macro_rules! float {
    ($($t:ty),*) => {$(
        impl Scalar for $t {
            #[inline(always)]
            fn lit(x: f64) -> Self {
                x as $t
            }
        }
        impl Real for $t {
            const EPSILON: f64 = <$t>::EPSILON as f64;
            #[inline(always)]
            fn value(self) -> f64 {
                self as f64
            }
            #[inline(always)]
            fn finite(self) -> bool {
                Float::is_finite(self)
            }
        }
    )*};
}
float!(f32, f64);

macro_rules! lanes {
    ($($t:ident of $r:ty),*) => {$(
        impl Scalar for $t {
            #[inline(always)]
            fn lit(x: f64) -> Self {
                Self::lift(x as $r)
            }
        }
        impl Algebra<$r> for $t {
            #[inline(always)]
            fn lift(r: $r) -> Self {
                $t(r.into())
            }
            #[inline(always)]
            fn times(self, r: $r) -> Self {
                self * Self::lift(r)
            }
        }
    )*};
}
lanes!(WideF32x4 of f32, WideF32x8 of f32, WideF64x4 of f64);

impl<T: Scalar + DualNumCopy> Scalar for Dual<T> {
    #[inline]
    fn lit(x: f64) -> Self {
        Self::from_re(T::lit(x))
    }
}
impl<T: Scalar + DualNumCopy> Algebra<T> for Dual<T> {
    #[inline]
    fn lift(r: T) -> Self {
        Self::from_re(r)
    }
    #[inline]
    fn times(self, r: T) -> Self {
        Self::new(self.re * r, self.eps * r)
    }
}
impl<T: Real> Real for Dual<T> {
    const EPSILON: f64 = T::EPSILON;
    #[inline]
    fn value(self) -> f64 {
        self.re.value()
    }
    #[inline]
    fn finite(self) -> bool {
        self.re.finite() && self.eps.finite()
    }
}

impl<T: Scalar + DualNumCopy, const N: usize> Scalar for DualSVec<T, N> {
    #[inline]
    fn lit(x: f64) -> Self {
        Self::from_re(T::lit(x))
    }
}
impl<T: Scalar + DualNumCopy, const N: usize> Algebra<T> for DualSVec<T, N> {
    #[inline]
    fn lift(r: T) -> Self {
        Self::from_re(r)
    }
    #[inline]
    fn times(self, r: T) -> Self {
        Self::new(self.re * r, self.eps * r)
    }
}
impl<T: Real, const N: usize> Real for DualSVec<T, N> {
    const EPSILON: f64 = T::EPSILON;
    #[inline]
    fn value(self) -> f64 {
        self.re.value()
    }
    #[inline]
    fn finite(self) -> bool {
        self.re.finite() && self.eps.0.iter().flatten().all(|d| d.finite())
    }
}

impl<T: Scalar + DualNumCopy> Scalar for HyperDual<T> {
    #[inline]
    fn lit(x: f64) -> Self {
        Self::from_re(T::lit(x))
    }
}
impl<T: Scalar + DualNumCopy> Algebra<T> for HyperDual<T> {
    #[inline]
    fn lift(r: T) -> Self {
        Self::from_re(r)
    }
    #[inline]
    fn times(self, r: T) -> Self {
        Self::new(self.re * r, self.eps1 * r, self.eps2 * r, self.eps1eps2 * r)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube<R: Scalar, T: Algebra<R>>(x: T, k: R) -> T {
        (x * x * x).times(k)
    }

    #[test]
    fn one_kernel_serves_floats_lanes_and_nested_duals() {
        assert_eq!(cube(2.0_f32, 3.0), 24.0);
        let lanes = cube(WideF64x4::from([1.0, 2.0, 3.0, 4.0]), 2.0_f64);
        assert_eq!(<[f64; 4]>::from(lanes.0), [2.0, 16.0, 54.0, 128.0]);
        let nested = Dual::new(Dual::new(2.0_f64, 1.0), Dual::from_re(1.0));
        let second = cube(nested, Dual::from_re(1.0)).eps.eps;
        assert_eq!(second, 12.0);
    }

    #[test]
    fn duals_are_finite_only_with_their_derivatives() {
        assert!(Dual::new(1.0, 2.0).finite());
        assert!(!Dual::new(1.0, f64::NAN).finite());
        assert!(!DualSVec::<f64, 2>::new(f64::INFINITY, num_dual::Derivative::none()).finite());
    }
}
