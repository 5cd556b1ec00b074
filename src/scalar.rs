//! Number types. Shape functions take any [`Scalar`] (a ring: no division, no order, no square
//! root); energies take any [`Field`], which adds division and elementary functions; a solver takes
//! any [`Real`], which adds order. [`Algebra`] says that a kernel's number type contains the
//! numbers a model is stored in, and how to differentiate with it: lanes over `f64`, dual numbers
//! over `f32`, and every real over itself.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use num_dual::{Derivative, Dual, DualNum, DualNumCopy, DualSVec, DualStruct, HyperDual};
use num_traits::{Float, FloatConst, One, Zero};
#[cfg(not(target_arch = "x86_64"))]
use simba::simd::{WideF32x8, WideF64x4};

#[cfg(test)]
mod functions;
mod jet;
mod lanes;
mod mask;
#[cfg(target_arch = "x86_64")]
#[allow(
    unsafe_code,
    reason = "vector instructions beyond the baseline of the architecture"
)]
mod x86;

/// Has the caches fetch what is soon read, where the architecture knows how.
#[cfg(not(target_arch = "x86_64"))]
pub(crate) fn prefetch<T>(_number: &T) {}

#[cfg(feature = "double-double")]
pub use double_double::DoubleDouble;
pub use jet::Jet;
pub(crate) use lanes::{Elementwise, Loops, MOST_LANES, elementwise};
pub use lanes::{LaneWork, Lanes};
pub use mask::{Mask, together};
pub use pack::{Laned, Pack};
pub use registers::Registers;
#[cfg(target_arch = "x86_64")]
pub(crate) use x86::prefetch;

/// What a kernel needs of a number: ring operations and constants.
///
/// Implemented for `f32`, `f64`, `DoubleDouble` (with the feature `double-double`), simba's wide
/// lanes and num-dual's [`Dual`], [`DualSVec`] and [`HyperDual`] over any of the reals (nested as
/// deep as wanted).
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
    note = "kernels run in f32, f64, DoubleDouble (feature `double-double`), simba's WideF32x4, WideF32x8 and WideF64x4, and num-dual's Dual, DualSVec and HyperDual",
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
    /// `self + a b`, rounded once where that is one instruction.
    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        self + a * b
    }
    /// Runs `work` as a function of its own, so that machine code of it exists once, however many
    /// places it is asked for in. Lanes run it in place, for it must be compiled for their registers;
    /// hence the closure must be inlined (`#[inline(always)]`), and it is not asked to be one that is
    /// called once, because those are called by way of a function that is not.
    #[inline(never)]
    fn outlined<T>(mut work: impl FnMut() -> T) -> T {
        work()
    }
}

/// A [`Scalar`] with division and elementary functions: what a strain energy may use.
///
/// Methods take their receiver by value, so that they win over num-dual's of the same name.
pub trait Field: Scalar + Div<Output = Self> + DivAssign {
    /// Square root.
    fn sqrt(self) -> Self;
    /// Reciprocal.
    fn recip(self) -> Self;
    /// Exponential.
    fn exp(self) -> Self;
    /// `exp(x) - 1`, with all digits where `x` is small: energies of Fung's kind.
    fn exp_m1(self) -> Self;
    /// Natural logarithm.
    fn ln(self) -> Self;
    /// `ln(1 + x)`, with all digits where `x` is small: energies in `ln J`, formed from a strain.
    fn ln_1p(self) -> Self;
    /// Sine (rad).
    fn sin(self) -> Self;
    /// Cosine (rad).
    fn cos(self) -> Self;
    /// Angle (rad) from `-pi/2` to `pi/2` of this sine; no derivative at -1 and 1.
    fn asin(self) -> Self;
    /// Angle (rad) from 0 to `pi` of this cosine; no derivative at -1 and 1.
    fn acos(self) -> Self;
    /// Angle (rad) from `-pi/2` to `pi/2` of this tangent.
    fn atan(self) -> Self;
    /// Hyperbolic sine.
    fn sinh(self) -> Self;
    /// Hyperbolic cosine.
    fn cosh(self) -> Self;
    /// Hyperbolic tangent.
    fn tanh(self) -> Self;
    /// Tangent (rad).
    fn tan(self) -> Self {
        self.sin() / self.cos()
    }
    /// The same value as a constant: without derivatives, to double precision at least.
    fn frozen(self) -> Self;
    /// Power with a whole exponent, for numbers of either sign; 1 for the exponent 0.
    fn powi(self, exponent: i32) -> Self {
        let (mut power, mut square) = (Self::one(), self);
        let mut rest = exponent.unsigned_abs();
        while rest > 0 {
            if rest % 2 == 1 {
                power *= square;
            }
            rest /= 2;
            if rest > 0 {
                square *= square;
            }
        }
        if exponent < 0 { power.recip() } else { power }
    }
    /// Power with a constant exponent, for positive numbers.
    fn powf(self, exponent: f64) -> Self {
        (self.ln() * Self::lit(exponent)).exp()
    }
}

/// Numbers that contain the reals `R` and can be differentiated: a value of `R` can be lifted into
/// them and can scale them, and there are dual numbers over them with the same gifts. Every
/// [`Real`] is an algebra over itself.
///
/// ```
/// use ancf::scalar::Algebra;
///
/// /// The slope of `k x^2`, whatever the number type of `x`.
/// fn slope<R: Copy, T: Algebra<R>>(x: T, k: R) -> T {
///     let x = x.variable::<1>(0);
///     T::derivative(&(x * x).times(k), 0)
/// }
/// assert_eq!(slope(3.0_f64, 0.5), 3.0);
/// ```
#[diagnostic::on_unimplemented(
    message = "a model stored in `{R}` cannot be evaluated in `{Self}`",
    note = "`{Self}` must be `{R}` itself, a lane type of it, or a dual number over it"
)]
pub trait Algebra<R>: Field {
    /// Dual numbers over this type with `N` derivatives.
    type Dual<const N: usize>: Algebra<R>;
    /// The constant `r` in this type.
    fn lift(r: R) -> Self;
    /// `r * self`.
    fn times(self, r: R) -> Self;
    /// `self + r a`, rounded once where that is one instruction.
    #[inline(always)]
    fn plus_times(self, r: R, a: Self) -> Self {
        self + a.times(r)
    }
    /// The dual number with this value and no derivatives.
    fn constant<const N: usize>(self) -> Self::Dual<N>;
    /// The dual number with this value and the unit derivative in direction `k < N`.
    fn variable<const N: usize>(self, k: usize) -> Self::Dual<N>;
    /// The value of a dual number.
    fn real_part<const N: usize>(dual: &Self::Dual<N>) -> Self;
    /// Derivative `k` of a dual number.
    fn derivative<const N: usize>(dual: &Self::Dual<N>, k: usize) -> Self;
}

/// What a solver needs of a number: a [`Scalar`] with order, division, elementary functions and
/// a rounding unit. `f32`, `f64`, `DoubleDouble` (with the feature `double-double`), dual numbers
/// over them, and [`Pack`]s. Dual numbers compare by their real part, so a simulation in duals takes
/// the very steps of the plain one; packs compare in all lanes at once, see [`together`].
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a real number type of the solvers",
    note = "solvers run in f32, f64, DoubleDouble (feature `double-double`), in num-dual's Dual and DualSVec over them, and in packs of f32 and f64"
)]
pub trait Real: Algebra<Self> + DualNumCopy {
    /// Distance from 1 to the next number of the real part's type.
    const EPSILON: f64;
    /// Order of the derivatives the type carries: 0 for plain floats.
    const ORDER: usize;
    /// Simultaneous computations that a number carries: one, but for [`Pack`]s.
    const LANES: usize = 1;
    /// The real part, in double precision: for messages, plots and decisions that need no more. Of a
    /// pack it must be that of every lane, or the run is [void](together).
    fn value(self) -> f64;
    /// The real part of one of its computations, by its number from zero.
    fn lane(self, _lane: usize) -> f64 {
        self.value()
    }
    /// One number for each of its computations, by its number from zero.
    fn by_lanes(x: impl Fn(usize) -> f64) -> Self {
        Self::lit(x(0))
    }
    /// The largest of the real parts of its computations: for reports.
    fn largest(self) -> f64 {
        // What is no number stays none.
        (0..Self::LANES)
            .map(|n| self.lane(n))
            .fold(f64::NEG_INFINITY, |most, x| {
                if most.is_nan() || x <= most { most } else { x }
            })
    }
    /// Whether the value (and every derivative it carries) is finite. Packs are not once their
    /// lanes have parted.
    fn finite(self) -> bool;
    /// In which of its computations the number is at most `other`: a decision that may differ
    /// between them. Comparisons by operators are one decision for all.
    #[inline(always)]
    fn at_most(self, other: Self) -> Mask {
        (self <= other).into()
    }
    /// This number where `mask` holds and `other` elsewhere.
    #[inline(always)]
    fn where_else(self, mask: Mask, other: Self) -> Self {
        if mask.all() { self } else { other }
    }
    /// Runs `work` in the lanes of this type that suit the processor best, within the limit of
    /// [`Registers`]; in the type itself where there are none.
    #[inline]
    fn dispatch<W: LaneWork<Self>>(work: W) -> W::Output {
        work.run_singly()
    }
    /// Runs `work` on one number at a time, where those of one computation have no lanes: packs in their
    /// registers, rounded as the number of each lane would be alone.
    #[inline]
    fn dispatch_singly<W: LaneWork<Self>>(work: W) -> W::Output {
        work.run_singly()
    }
    /// The circle constant, to the last digit of the type.
    fn pi() -> Self {
        // The sine of the rounded value is what the rounding left out.
        let rounded = Self::from(Self::Primitive::PI());
        rounded + Field::sin(rounded)
    }
    /// Whether there is nothing in a number: zero in every lane, and of a type without derivatives,
    /// which need not vanish where values do.
    #[inline]
    fn is_nothing(self) -> bool {
        Self::ORDER == 0 && self.abs().at_most(Self::zero()).all()
    }
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

/// Elementary functions by their names in num-dual's trait.
macro_rules! by_dual_num {
    ($($function:ident)*) => {$(
        #[inline(always)]
        fn $function(self) -> Self {
            DualNum::$function(&self)
        }
    )*};
}

/// The elementary functions of num-dual's trait, under [`Field`].
macro_rules! field {
    ([$($bound:tt)*] $t:ty) => {
        impl<$($bound)*> Field for $t {
            by_dual_num!(sqrt recip exp exp_m1 ln ln_1p sin cos asin acos atan sinh cosh tanh);
            #[inline(always)]
            fn frozen(self) -> Self {
                Self::from(DualStruct::re(&self))
            }
        }
    };
}

/// Differentiation by num-dual's vector dual numbers, inside an `impl Algebra`.
macro_rules! by_num_dual {
    () => {
        type Dual<const M: usize> = DualSVec<Self, M>;
        #[inline(always)]
        fn constant<const M: usize>(self) -> DualSVec<Self, M> {
            DualSVec::from_re(self)
        }
        #[inline(always)]
        fn variable<const M: usize>(self, k: usize) -> DualSVec<Self, M> {
            DualSVec::from_re(self).derivative(k)
        }
        #[inline(always)]
        fn real_part<const M: usize>(dual: &DualSVec<Self, M>) -> Self {
            dual.re
        }
        #[inline(always)]
        fn derivative<const M: usize>(dual: &DualSVec<Self, M>, k: usize) -> Self {
            match &dual.eps {
                Derivative(Some(eps)) => eps[k],
                Derivative(None) => Self::zero(),
            }
        }
    };
}

/// A real number type is an algebra over itself.
macro_rules! over_itself {
    ([$($bound:tt)*] $t:ty) => {
        impl<$($bound)*> Algebra<$t> for $t {
            by_num_dual!();
            #[inline(always)]
            fn lift(r: $t) -> Self {
                r
            }
            #[inline(always)]
            fn times(self, r: $t) -> Self {
                self * r
            }
        }
    };
}

/// A plain number type with its functions and the dual numbers over it.
macro_rules! plain {
    ($t:ty) => {
        field!([] $t);
        over_itself!([] $t);
        over_itself!([] Dual<$t>);
        over_itself!([] Dual<Dual<$t>>);
        over_itself!([const N: usize] DualSVec<$t, N>);
    };
}

#[cfg(feature = "double-double")]
mod double_double;
mod pack;
mod registers;

macro_rules! float {
    ($($t:ty, $portable:ty, $run:ident, $both:ident, $wide:ident);*) => {$(
        impl Scalar for $t {
            #[inline(always)]
            fn lit(x: f64) -> Self {
                x as $t
            }
        }
        impl Real for $t {
            const EPSILON: f64 = <$t>::EPSILON as f64;
            const ORDER: usize = 0;
            #[inline(always)]
            fn value(self) -> f64 {
                self as f64
            }
            #[inline(always)]
            fn finite(self) -> bool {
                Float::is_finite(self)
            }
            #[inline]
            #[cfg_attr(target_arch = "x86_64", allow(unsafe_code, reason = "crosses the check"))]
            fn dispatch<W: LaneWork<Self>>(work: W) -> W::Output {
                #[cfg(target_arch = "x86_64")]
                return match Registers::widest() {
                    Registers::Baseline => work.run_singly(),
                    // What is not called for is not compiled, either: a question of constants alone.
                    // SAFETY, four times: the processor has the instructions.
                    _ if W::HEAVY => unsafe { x86::$run(work) },
                    Registers::Avx2 if W::PAIRED => unsafe { x86::$both(work) },
                    Registers::Avx2 => unsafe { x86::$run(work) },
                    Registers::Avx512 => unsafe { x86::$wide(work) },
                };
                #[cfg(not(target_arch = "x86_64"))]
                work.run::<$portable>()
            }
        }
        plain!($t);
    )*};
}
float!(
    f32, WideF32x8, in_f32x8, in_both_f32x8, in_f32x16;
    f64, WideF64x4, in_f64x4, in_both_f64x4, in_f64x8
);

impl<T: Scalar + DualNumCopy> Scalar for Dual<T> {
    #[inline]
    fn lit(x: f64) -> Self {
        Self::from_re(T::lit(x))
    }
}
field!([T: Scalar + DualNumCopy] Dual<T>);
impl<R: Copy, T: Algebra<R> + DualNumCopy> Algebra<R> for Dual<T> {
    by_num_dual!();
    #[inline]
    fn lift(r: R) -> Self {
        Self::from_re(T::lift(r))
    }
    #[inline]
    fn times(self, r: R) -> Self {
        Self::new(self.re.times(r), self.eps.times(r))
    }
}
impl<T: Real> Real for Dual<T>
where
    Self: Algebra<Self>,
{
    const EPSILON: f64 = T::EPSILON;
    const ORDER: usize = T::ORDER + 1;
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
field!([T: Scalar + DualNumCopy, const N: usize] DualSVec<T, N>);
impl<R: Copy, T: Algebra<R> + DualNumCopy, const N: usize> Algebra<R> for DualSVec<T, N> {
    by_num_dual!();
    #[inline]
    fn lift(r: R) -> Self {
        Self::from_re(T::lift(r))
    }
    #[inline]
    fn times(self, r: R) -> Self {
        let eps = self.eps.0.map(|eps| eps.map(|d| d.times(r)));
        Self::new(self.re.times(r), Derivative(eps))
    }
}
impl<T: Real, const N: usize> Real for DualSVec<T, N>
where
    Self: Algebra<Self>,
{
    const EPSILON: f64 = T::EPSILON;
    const ORDER: usize = T::ORDER + 1;
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
field!([T: Scalar + DualNumCopy] HyperDual<T>);
impl<R: Copy, T: Algebra<R> + DualNumCopy> Algebra<R> for HyperDual<T> {
    by_num_dual!();
    #[inline]
    fn lift(r: R) -> Self {
        Self::from_re(T::lift(r))
    }
    #[inline]
    fn times(self, r: R) -> Self {
        let parts = [self.re, self.eps1, self.eps2, self.eps1eps2];
        let [re, eps1, eps2, both] = parts.map(|part| part.times(r));
        Self::new(re, eps1, eps2, both)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use simba::simd::WideF64x4;

    fn cube<R: Copy, T: Algebra<R>>(x: T, k: R) -> T {
        (x * x * x).times(k)
    }

    #[test]
    fn one_kernel_serves_floats_lanes_and_nested_duals() {
        assert_eq!(cube(2.0_f32, 3.0), 24.0);
        let lanes = cube(WideF64x4::from([1.0, 2.0, 3.0, 4.0]), 2.0_f64);
        assert_eq!(<[f64; 4]>::from(lanes.0), [2.0, 16.0, 54.0, 128.0]);
        let nested = Dual::new(Dual::new(2.0_f64, 1.0), Dual::from_re(1.0));
        assert_eq!(cube(nested, Dual::from_re(1.0)).eps.eps, 12.0);
        assert_eq!(cube(nested, 1.0_f64).eps.eps, 12.0);
    }

    #[test]
    fn duals_are_finite_only_with_their_derivatives() {
        assert!(f64::NAN.largest().is_nan() && f64::NEG_INFINITY.largest() < 0.0);
        assert!(Dual::new(1.0, 2.0).finite());
        assert!(!Dual::new(1.0, f64::NAN).finite());
        assert!(!DualSVec::<f64, 2>::new(f64::INFINITY, Derivative::none()).finite());
    }
}
