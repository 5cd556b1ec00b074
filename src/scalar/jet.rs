//! First-order dual numbers over any [`Field`], for those that num-dual cannot take: lanes have no
//! order, which num-dual asks for.

use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use num_traits::{One, Zero};

use super::{Algebra, Field, Scalar};
use crate::tensor::array;

/// A value with `N` derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jet<T, const N: usize> {
    /// The value.
    pub re: T,
    /// Its derivatives.
    pub eps: [T; N],
}

/// Differentiation by [`Jet`], inside an `impl Algebra`.
macro_rules! by_jet {
    () => {
        #[inline(always)]
        fn constant<const M: usize>(self) -> Jet<Self, M> {
            Jet {
                re: self,
                eps: $crate::tensor::array(|_| Self::zero()),
            }
        }
        #[inline(always)]
        fn variable<const M: usize>(self, k: usize) -> Jet<Self, M> {
            let eps = $crate::tensor::array(|_| Self::zero());
            let mut jet = Jet { re: self, eps };
            jet.eps[k] = Self::one();
            jet
        }
        #[inline(always)]
        fn real_part<const M: usize>(dual: &Jet<Self, M>) -> Self {
            dual.re
        }
        #[inline(always)]
        fn derivative<const M: usize>(dual: &Jet<Self, M>, k: usize) -> Self {
            dual.eps[k]
        }
    };
}
pub(super) use by_jet;

impl<T: Field, const N: usize> Jet<T, N> {
    #[inline(always)]
    fn constant(re: T) -> Self {
        Self {
            re,
            eps: array(|_| T::zero()),
        }
    }

    /// The chain rule: a function's value and its derivative at the real part.
    #[inline(always)]
    fn chain(self, value: T, slope: T) -> Self {
        Self {
            re: value,
            eps: array(|k| self.eps[k] * slope),
        }
    }

    #[inline(always)]
    fn combine(self, other: Self, re: T, f: impl Fn(T, T) -> T) -> Self {
        Self {
            re,
            eps: array(|k| f(self.eps[k], other.eps[k])),
        }
    }
}

impl<T: Field, const N: usize> Add for Jet<T, N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.combine(other, self.re + other.re, |a, b| a + b)
    }
}
impl<T: Field, const N: usize> Sub for Jet<T, N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.combine(other, self.re - other.re, |a, b| a - b)
    }
}
impl<T: Field, const N: usize> Mul for Jet<T, N> {
    type Output = Self;
    #[expect(clippy::suspicious_arithmetic_impl, reason = "the product rule")]
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let product = |a, b| a * other.re + b * self.re;
        self.combine(other, self.re * other.re, product)
    }
}
impl<T: Field, const N: usize> Div for Jet<T, N> {
    type Output = Self;
    #[expect(clippy::suspicious_arithmetic_impl, reason = "the quotient rule")]
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let inverse = other.re.recip();
        let ratio = self.re * inverse;
        self.combine(other, ratio, |a, b| (a - b * ratio) * inverse)
    }
}
impl<T: Field, const N: usize> Neg for Jet<T, N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self {
            re: -self.re,
            eps: array(|k| -self.eps[k]),
        }
    }
}
macro_rules! assign {
    ($($trait:ident $method:ident $op:tt),*) => {$(
        impl<T: Field, const N: usize> $trait for Jet<T, N> {
            #[inline(always)]
            fn $method(&mut self, other: Self) {
                *self = *self $op other;
            }
        }
    )*};
}
assign!(AddAssign add_assign +, SubAssign sub_assign -, MulAssign mul_assign *, DivAssign div_assign /);

impl<T: Field, const N: usize> Zero for Jet<T, N> {
    fn zero() -> Self {
        Self::constant(T::zero())
    }
    fn is_zero(&self) -> bool {
        self.re.is_zero() && self.eps.iter().all(Zero::is_zero)
    }
}
impl<T: Field, const N: usize> One for Jet<T, N> {
    fn one() -> Self {
        Self::constant(T::one())
    }
}
impl<T: Field, const N: usize> Scalar for Jet<T, N> {
    fn lit(x: f64) -> Self {
        Self::constant(T::lit(x))
    }
    #[inline(always)]
    fn outlined<O>(work: impl FnMut() -> O) -> O {
        T::outlined(work)
    }
}
impl<T: Field, const N: usize> Field for Jet<T, N> {
    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.re.sqrt();
        self.chain(root, T::lit(0.5) / root)
    }
    #[inline(always)]
    fn recip(self) -> Self {
        let inverse = self.re.recip();
        self.chain(inverse, -inverse * inverse)
    }
    #[inline(always)]
    fn exp(self) -> Self {
        let value = self.re.exp();
        self.chain(value, value)
    }
    #[inline(always)]
    fn exp_m1(self) -> Self {
        self.chain(self.re.exp_m1(), self.re.exp())
    }
    #[inline(always)]
    fn ln(self) -> Self {
        self.chain(self.re.ln(), self.re.recip())
    }
    #[inline(always)]
    fn ln_1p(self) -> Self {
        self.chain(self.re.ln_1p(), (T::one() + self.re).recip())
    }
    #[inline(always)]
    fn sin(self) -> Self {
        self.chain(self.re.sin(), self.re.cos())
    }
    #[inline(always)]
    fn cos(self) -> Self {
        self.chain(self.re.cos(), -self.re.sin())
    }
    #[inline(always)]
    fn asin(self) -> Self {
        let cosine = ((T::one() - self.re) * (T::one() + self.re)).sqrt();
        self.chain(self.re.asin(), cosine.recip())
    }
    #[inline(always)]
    fn acos(self) -> Self {
        let sine = ((T::one() - self.re) * (T::one() + self.re)).sqrt();
        self.chain(self.re.acos(), -sine.recip())
    }
    #[inline(always)]
    fn atan(self) -> Self {
        self.chain(self.re.atan(), (T::one() + self.re * self.re).recip())
    }
    #[inline(always)]
    fn sinh(self) -> Self {
        self.chain(self.re.sinh(), self.re.cosh())
    }
    #[inline(always)]
    fn cosh(self) -> Self {
        self.chain(self.re.cosh(), self.re.sinh())
    }
    #[inline(always)]
    fn tanh(self) -> Self {
        let value = self.re.tanh();
        self.chain(value, (T::one() - value) * (T::one() + value))
    }
    #[inline(always)]
    fn frozen(self) -> Self {
        Self::constant(self.re.frozen())
    }
}
impl<R: Copy, T: Algebra<R>, const N: usize> Algebra<R> for Jet<T, N> {
    type Dual<const M: usize> = Jet<Self, M>;
    #[inline(always)]
    fn lift(r: R) -> Self {
        Self::constant(T::lift(r))
    }
    #[inline(always)]
    fn times(self, r: R) -> Self {
        Self {
            re: self.re.times(r),
            eps: array(|k| self.eps[k].times(r)),
        }
    }
    by_jet!();
}
