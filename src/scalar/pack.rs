//! Packs: as many numbers as the widest register holds, each of a computation of its own. A pack is
//! a [`Real`], so that a whole scene, its solution and its motion run with one scene in each lane.
//! In memory it is an array; kernels and factorisation meet it in registers, by
//! [`Real::dispatch`]. Decisions are common to all lanes, see [`Mask`].

use std::cmp::Ordering;
use std::fmt;
use std::iter::{Product, Sum};
use std::ops::{
    Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Rem, RemAssign, Sub, SubAssign,
};

use num_dual::{Derivative, DualNum, DualSVec, DualStruct, Mappable};
use num_traits::{FromPrimitive, Inv, Num, One, Signed, Zero};

use super::lanes::blocks;
use super::mask::{Mask, parted};
use super::{Algebra, Field, Jet, LaneWork, Lanes, Real, Registers, Scalar, jet};
use crate::tensor::{array, each};

/// `N` numbers that go through a computation together.
///
/// Arithmetic is that of each lane alone. A comparison asks all lanes at once; where they answer
/// differently the run is [void](super::together).
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub struct Pack<R, const N: usize>(pub [R; N]);

/// A real number type that can be packed.
pub trait Laned: Real {
    /// As many as the widest registers hold.
    type Pack: Real;
    /// One number in each lane, by its number from zero.
    fn pack(lane: impl Fn(usize) -> Self) -> Self::Pack;
    /// The number of one lane.
    ///
    /// # Panics
    /// If there is no such lane.
    fn unpack(pack: Self::Pack, lane: usize) -> Self;
}

/// `C` registers at once: of a [`Pack`], or of elements where two hide better what is not arithmetic.
/// Products and sums are not `FUSED` where packs must round as plain numbers that have no lanes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wide<L, const C: usize, const FUSED: bool = true>(pub(super) [L; C]);

impl<L: Copy, const C: usize, const FUSED: bool> Wide<L, C, FUSED> {
    #[inline(always)]
    fn map(self, f: impl Fn(L) -> L) -> Self {
        Self(array(
            #[inline(always)]
            |m| f(self.0[m]),
        ))
    }
    #[inline(always)]
    pub(super) fn with(self, other: Self, f: impl Fn(L, L) -> L) -> Self {
        Self(array(
            #[inline(always)]
            |m| f(self.0[m], other.0[m]),
        ))
    }
}

macro_rules! wide_operators {
    ($($trait:ident $method:ident $assign:ident $assigned:ident;)*) => {$(
        impl<L: Field, const C: usize, const FUSED: bool> $trait for Wide<L, C, FUSED> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.with(other, L::$method)
            }
        }
        impl<L: Field, const C: usize, const FUSED: bool> $assign for Wide<L, C, FUSED> {
            #[inline(always)]
            fn $assigned(&mut self, other: Self) {
                *self = $trait::$method(*self, other);
            }
        }
    )*};
}
wide_operators! {
    Add add AddAssign add_assign;
    Sub sub SubAssign sub_assign;
    Mul mul MulAssign mul_assign;
    Div div DivAssign div_assign;
}
impl<L: Field, const C: usize, const FUSED: bool> Neg for Wide<L, C, FUSED> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(L::neg)
    }
}
impl<L: Field, const C: usize, const FUSED: bool> Zero for Wide<L, C, FUSED> {
    #[inline(always)]
    fn zero() -> Self {
        Self(array(|_| L::zero()))
    }
    fn is_zero(&self) -> bool {
        self.0.iter().all(L::is_zero)
    }
}
impl<L: Field, const C: usize, const FUSED: bool> One for Wide<L, C, FUSED> {
    #[inline(always)]
    fn one() -> Self {
        Self(array(|_| L::one()))
    }
}
impl<L: Field, const C: usize, const FUSED: bool> Scalar for Wide<L, C, FUSED> {
    #[inline(always)]
    fn lit(x: f64) -> Self {
        Self(array(|_| L::lit(x)))
    }
    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        Self(array(
            #[inline(always)]
            |m| match FUSED {
                true => self.0[m].plus_product(a.0[m], b.0[m]),
                false => self.0[m] + a.0[m] * b.0[m],
            },
        ))
    }
    #[inline(always)]
    fn outlined<O>(work: impl FnMut() -> O) -> O {
        L::outlined(work)
    }
}
macro_rules! by_map {
    ($($function:ident)*) => {$(
        fn $function(self) -> Self {
            self.map(L::$function)
        }
    )*};
}
impl<L: Field, const C: usize, const FUSED: bool> Field for Wide<L, C, FUSED> {
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.map(L::sqrt)
    }
    #[inline(always)]
    fn recip(self) -> Self {
        self.map(L::recip)
    }
    by_map!(exp exp_m1 ln ln_1p sin cos asin acos atan sinh cosh tanh);
    #[inline(always)]
    fn frozen(self) -> Self {
        self
    }
}
impl<R, L, const C: usize, const N: usize, const FUSED: bool> Algebra<Pack<R, N>>
    for Wide<L, C, FUSED>
where
    R: Real,
    L: Lanes<R>,
{
    type Dual<const K: usize> = Jet<Self, K>;
    #[inline(always)]
    fn lift(pack: Pack<R, N>) -> Self {
        const { assert!(C * L::WIDTH == N) };
        Self(array(
            #[inline(always)]
            |m| L::load(&pack.0[m * L::WIDTH..]),
        ))
    }
    #[inline(always)]
    fn times(self, pack: Pack<R, N>) -> Self {
        self * Self::lift(pack)
    }
    #[inline(always)]
    fn plus_times(self, pack: Pack<R, N>, a: Self) -> Self {
        self.plus_product(a, Self::lift(pack))
    }
    jet::by_jet!();
}
impl<R, L, const C: usize, const N: usize, const FUSED: bool> Lanes<Pack<R, N>>
    for Wide<L, C, FUSED>
where
    R: Real,
    L: Lanes<R>,
{
    blocks!(Pack<R, N>, 1);

    #[inline(always)]
    fn greater(self, other: Self) -> Self {
        self.with(other, L::greater)
    }

    #[inline(always)]
    fn load(from: &[Pack<R, N>]) -> Self {
        Self::lift(from[0])
    }
    #[inline(always)]
    fn store(self, to: &mut [Pack<R, N>]) {
        each!(m in 0..C, { self.0[m].store(&mut to[0].0[m * L::WIDTH..]) });
    }
    #[inline(always)]
    fn gather(x: &[Pack<R, N>], starts: impl Fn(usize) -> usize, columns: &mut [Self]) {
        for (column, x) in columns.iter_mut().zip(&x[starts(0)..]) {
            *column = Self::lift(*x);
        }
    }
    #[inline(always)]
    fn scatter(columns: &[Self], x: &mut [Pack<R, N>], starts: impl Fn(usize) -> Option<usize>) {
        let Some(start) = starts(0) else { return };
        for (x, column) in x[start..start + columns.len()].iter_mut().zip(columns) {
            each!(m in 0..C, {
                let numbers = &mut x.0[m * L::WIDTH..];
                (L::load(numbers) + column.0[m]).store(numbers);
            });
        }
    }
}

macro_rules! operators {
    ($p:ty, $r:ty, $n:literal: $($trait:ident $method:ident $assign:ident $assigned:ident;)*) => {$(
        impl $trait for $p {
            type Output = Self;
            #[inline(always)]
            fn $method(mut self, other: Self) -> Self {
                for lane in 0..$n {
                    self.0[lane] = $trait::$method(self.0[lane], other.0[lane]);
                }
                self
            }
        }
        impl $trait<&Self> for $p {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: &Self) -> Self {
                $trait::$method(self, *other)
            }
        }
        impl $trait<$r> for $p {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: $r) -> Self {
                $trait::$method(self, Self::from(other))
            }
        }
        impl $assign for $p {
            #[inline(always)]
            fn $assigned(&mut self, other: Self) {
                *self = $trait::$method(*self, other);
            }
        }
        impl $assign<$r> for $p {
            #[inline(always)]
            fn $assigned(&mut self, other: $r) {
                *self = $trait::$method(*self, other);
            }
        }
    )*};
}

macro_rules! lane_by_lane {
    ($($function:ident)*) => {$(
        #[inline]
        fn $function(&self) -> Self {
            Self(self.0.map(|x| DualNum::$function(&x)))
        }
    )*};
}

macro_rules! field_by_lanes {
    ($($function:ident)*) => {$(
        #[inline(always)]
        fn $function(self) -> Self {
            Self(self.0.map(Field::$function))
        }
    )*};
}

macro_rules! packs {
    ($($r:ty, $n:literal, $parse:ty, $portable:ty, $narrow:ident, $wide:ident, $single:ident;)*) => {$(
        impl Laned for $r {
            type Pack = Pack<$r, $n>;
            fn pack(lane: impl Fn(usize) -> Self) -> Self::Pack {
                Pack(std::array::from_fn(lane))
            }
            fn unpack(pack: Self::Pack, lane: usize) -> Self {
                pack.0[lane]
            }
        }
        operators! {
            Pack<$r, $n>, $r, $n:
            Add add AddAssign add_assign;
            Sub sub SubAssign sub_assign;
            Mul mul MulAssign mul_assign;
            Div div DivAssign div_assign;
            Rem rem RemAssign rem_assign;
        }
        impl Neg for Pack<$r, $n> {
            type Output = Self;
            #[inline(always)]
            fn neg(mut self) -> Self {
                for lane in 0..$n {
                    self.0[lane] = -self.0[lane];
                }
                self
            }
        }
        impl Inv for Pack<$r, $n> {
            type Output = Self;
            fn inv(self) -> Self {
                Field::recip(self)
            }
        }
        impl From<$r> for Pack<$r, $n> {
            #[inline(always)]
            fn from(x: $r) -> Self {
                Self([x; $n])
            }
        }
        impl Sum for Pack<$r, $n> {
            fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
                // A sum of floats starts from minus zero.
                terms.fold(Self([-0.0; $n]), Add::add)
            }
        }
        impl Product for Pack<$r, $n> {
            fn product<I: Iterator<Item = Self>>(factors: I) -> Self {
                factors.fold(Self::one(), Mul::mul)
            }
        }
        impl PartialEq for Pack<$r, $n> {
            #[inline]
            fn eq(&self, other: &Self) -> bool {
                Mask::of::<$n>(|lane| self.0[lane] == other.0[lane]).common()
            }
        }
        impl PartialEq<$r> for Pack<$r, $n> {
            fn eq(&self, other: &$r) -> bool {
                *self == Self::from(*other)
            }
        }
        impl PartialOrd for Pack<$r, $n> {
            fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
                let order = |lane: usize| self.0[lane].partial_cmp(&other.0[lane]);
                let same = Mask::of::<$n>(|lane| order(lane) == order(0)).common();
                order(0).filter(|_| same)
            }
            #[inline]
            fn lt(&self, other: &Self) -> bool {
                Mask::of::<$n>(|lane| self.0[lane] < other.0[lane]).common()
            }
            #[inline]
            fn le(&self, other: &Self) -> bool {
                Mask::of::<$n>(|lane| self.0[lane] <= other.0[lane]).common()
            }
            #[inline]
            fn gt(&self, other: &Self) -> bool {
                other < self
            }
            #[inline]
            fn ge(&self, other: &Self) -> bool {
                other <= self
            }
        }
        impl PartialOrd<$r> for Pack<$r, $n> {
            fn partial_cmp(&self, other: &$r) -> Option<Ordering> {
                self.partial_cmp(&Self::from(*other))
            }
        }
        impl Zero for Pack<$r, $n> {
            #[inline(always)]
            fn zero() -> Self {
                Self([0.0; $n])
            }
            #[inline]
            fn is_zero(&self) -> bool {
                *self == Self::zero()
            }
        }
        impl One for Pack<$r, $n> {
            #[inline(always)]
            fn one() -> Self {
                Self([1.0; $n])
            }
        }
        impl Signed for Pack<$r, $n> {
            #[inline(always)]
            fn abs(&self) -> Self {
                let mut abs = *self;
                for lane in 0..$n {
                    abs.0[lane] = abs.0[lane].abs();
                }
                abs
            }
            fn abs_sub(&self, other: &Self) -> Self {
                (*self - *other).larger(Self::zero())
            }
            fn signum(&self) -> Self {
                Self(self.0.map(|x| x.signum()))
            }
            fn is_positive(&self) -> bool {
                *self > Self::zero()
            }
            fn is_negative(&self) -> bool {
                *self < Self::zero()
            }
        }
        impl FromPrimitive for Pack<$r, $n> {
            fn from_i64(n: i64) -> Option<Self> {
                <$r>::from_i64(n).map(Self::from)
            }
            fn from_u64(n: u64) -> Option<Self> {
                <$r>::from_u64(n).map(Self::from)
            }
            fn from_f64(x: f64) -> Option<Self> {
                <$r>::from_f64(x).map(Self::from)
            }
        }
        impl Num for Pack<$r, $n> {
            type FromStrRadixErr = $parse;
            /// The same number in every lane.
            fn from_str_radix(text: &str, radix: u32) -> Result<Self, $parse> {
                <$r>::from_str_radix(text, radix).map(Self::from)
            }
        }
        impl fmt::Display for Pack<$r, $n> {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                fmt::Debug::fmt(&self.0, f)
            }
        }
        impl DualStruct for Pack<$r, $n> {
            type Real = $r;
            type Inner = Self;
            fn re(&self) -> $r {
                let same = *self == Self([self.0[0]; $n]);
                if same { self.0[0] } else { <$r>::NAN }
            }
            fn from_inner(inner: &Self) -> Self {
                *inner
            }
        }
        impl Mappable<Self> for Pack<$r, $n> {
            type Output<O> = O;
            fn map_dual<M: Fn(Self) -> O, O>(self, f: M) -> O {
                f(self)
            }
        }
        impl DualNum for Pack<$r, $n> {
            type Primitive = $r;
            const NDERIV: usize = 0;
            type InnerDual = Self;

            fn from_re(re: Self) -> Self {
                re
            }
            fn scale(self, factor: &Self) -> Self {
                self * factor
            }
            lane_by_lane! {
                recip sqrt cbrt exp exp2 exp_m1 ln log2 log10 ln_1p sin cos tan asin acos atan sinh
                cosh tanh asinh acosh atanh sph_j0 sph_j1 sph_j2
            }
            fn powi(&self, n: i32) -> Self {
                Self(self.0.map(|x| DualNum::powi(&x, n)))
            }
            fn powf(&self, n: $r) -> Self {
                Self(self.0.map(|x| DualNum::powf(&x, n)))
            }
            fn log(&self, base: $r) -> Self {
                Self(self.0.map(|x| DualNum::log(&x, base)))
            }
            fn sin_cos(&self) -> (Self, Self) {
                (Field::sin(*self), Field::cos(*self))
            }
            fn atan2(&self, other: Self) -> Self {
                Self(std::array::from_fn(|lane| DualNum::atan2(&self.0[lane], other.0[lane])))
            }
        }
        impl Scalar for Pack<$r, $n> {
            #[inline(always)]
            fn lit(x: f64) -> Self {
                Self([x as $r; $n])
            }
        }
        impl Field for Pack<$r, $n> {
            field_by_lanes! {
                sqrt recip exp exp_m1 ln ln_1p sin cos asin acos atan sinh cosh tanh
            }
            #[inline(always)]
            fn frozen(self) -> Self {
                self
            }
        }
        over_itself!([] Pack<$r, $n>);
        impl Real for Pack<$r, $n> {
            const EPSILON: f64 = <$r as Real>::EPSILON;
            const ORDER: usize = 0;
            const LANES: usize = $n;

            fn value(self) -> f64 {
                Real::value(DualStruct::re(&self))
            }
            fn lane(self, lane: usize) -> f64 {
                Real::value(self.0[lane])
            }
            fn by_lanes(x: impl Fn(usize) -> f64) -> Self {
                Self(std::array::from_fn(|lane| x(lane) as $r))
            }
            #[inline]
            fn finite(self) -> bool {
                !parted() && Mask::of::<$n>(|lane| self.0[lane].is_finite()).common()
            }
            #[inline]
            fn at_most(self, other: Self) -> Mask {
                Mask::of::<$n>(|lane| self.0[lane] <= other.0[lane])
            }
            #[inline]
            fn where_else(self, mask: Mask, other: Self) -> Self {
                let choose = |lane| if mask.lane(lane) { self.0[lane] } else { other.0[lane] };
                Self(std::array::from_fn(choose))
            }
            // Loops without calls, of which compilers make one instruction.
            #[inline(always)]
            fn larger(mut self, other: Self) -> Self {
                for lane in 0..$n {
                    let (a, b) = (self.0[lane], other.0[lane]);
                    self.0[lane] = if b > a { b } else { a };
                }
                self
            }
            #[inline(always)]
            fn smaller(mut self, other: Self) -> Self {
                for lane in 0..$n {
                    let (a, b) = (self.0[lane], other.0[lane]);
                    self.0[lane] = if b < a { b } else { a };
                }
                self
            }
            #[inline]
            #[cfg_attr(target_arch = "x86_64", allow(unsafe_code, reason = "crosses the check"))]
            fn dispatch<W: LaneWork<Self>>(work: W) -> W::Output {
                // SAFETY, twice: the processor has the instructions.
                #[cfg(target_arch = "x86_64")]
                return match Registers::widest() {
                    Registers::Baseline => work.run_singly(),
                    Registers::Avx2 => unsafe { super::x86::$narrow(work) },
                    Registers::Avx512 => unsafe { super::x86::$wide(work) },
                };
                #[cfg(not(target_arch = "x86_64"))]
                work.run::<$portable>()
            }
            #[inline]
            #[cfg_attr(target_arch = "x86_64", allow(unsafe_code, reason = "crosses the check"))]
            fn dispatch_singly<W: LaneWork<Self>>(work: W) -> W::Output {
                // SAFETY: the processor has the instructions.
                #[cfg(target_arch = "x86_64")]
                return match Registers::widest() {
                    Registers::Baseline => work.run_singly(),
                    _ => unsafe { super::x86::$single(work) },
                };
                #[cfg(not(target_arch = "x86_64"))]
                work.run_singly()
            }
        }
    )*};
}
packs! {
    f32, 16, num_traits::ParseFloatError, Wide<simba::simd::WideF32x8, 2>, in_two_f32x8, in_one_f32x16, singly_f32x8;
    f64, 8, num_traits::ParseFloatError, Wide<simba::simd::WideF64x4, 2>, in_two_f64x4, in_one_f64x8, singly_f64x4;
}
