//! Numbers that know how far they are from their value in the reference state. A strain is the
//! difference of two nearly equal numbers; formed at the end it has lost the digits that a slender
//! beam needs, carried along through every operation it keeps them. Laws write their strains as in
//! the book, in these numbers, and take the change.

use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

use num_traits::{One, Zero};

use crate::scalar::{Algebra, Field, Scalar};
use crate::tensor::array;

/// A value and its change since the reference state. Sums, products, quotients and roots of such
/// numbers carry the change along without ever forming the difference of two values.
///
/// ```
/// use ancf::formulation::{Change, changes};
///
/// // A strain of 1e-12: the difference of two lengths near one would know four digits of it.
/// let [[x, y]] = changes::<f64, f64, 2, 1>(&[[0.6, 0.8]], &[[0.6e-12, 0.8e-12]]);
/// let strain = (x * x + y * y).sqrt().change;
/// assert!((strain / 1e-12 - 1.0).abs() < 1e-11);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Change<T> {
    /// The value now.
    pub value: T,
    /// The value now less the value in the reference state.
    pub change: T,
}

/// The vectors `g = g0 + h` that a [`SectionLaw`](super::SectionLaw) is given, from their
/// `reference` values `g0` and displacement parts `h`.
#[inline(always)]
pub fn changes<R: Copy, T: Algebra<R>, const D: usize, const K: usize>(
    reference: &[[R; D]; K],
    h: &[[T; D]; K],
) -> [[Change<T>; D]; K] {
    array(|k| {
        array(|c| Change {
            value: T::lift(reference[k][c]) + h[k][c],
            change: h[k][c],
        })
    })
}

/// The vector as it is now.
#[inline(always)]
pub(super) fn values<T: Copy, const D: usize>(v: &[Change<T>; D]) -> [T; D] {
    array(|c| v[c].value)
}

impl<T: Scalar> Change<T> {
    /// A number that is the same in every state.
    #[inline(always)]
    pub fn fixed(value: T) -> Self {
        let change = T::zero();
        Self { value, change }
    }
}

impl<T: Field> Change<T> {
    /// Square root of a number that is positive now and in the reference state.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        let (now, then) = (self.value.sqrt(), (self.value - self.change).sqrt());
        Self {
            value: now,
            change: self.change / (now + then),
        }
    }

    /// Reciprocal of a number that vanishes neither now nor in the reference state.
    #[inline(always)]
    pub fn recip(self) -> Self {
        let then = self.value - self.change;
        Self {
            value: self.value.recip(),
            change: -self.change / (self.value * then),
        }
    }

    /// One over the square root of a positive number.
    #[inline(always)]
    pub fn rsqrt(self) -> Self {
        let (now, then) = (self.value.sqrt(), (self.value - self.change).sqrt());
        let product = now * then;
        Self {
            value: now.recip(),
            change: -self.change / (product * (now + then)),
        }
    }
}

impl<T: Scalar> Add for Change<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            change: self.change + other.change,
        }
    }
}

impl<T: Scalar> Neg for Change<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self {
            value: -self.value,
            change: -self.change,
        }
    }
}

impl<T: Scalar> Sub for Change<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self {
            value: self.value - other.value,
            change: self.change - other.change,
        }
    }
}

impl<T: Scalar> Mul for Change<T> {
    type Output = Self;
    /// `a b - a0 b0 = (a - a0) b + a0 (b - b0)`.
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let then = self.value - self.change;
        Self {
            value: self.value * other.value,
            change: self.change * other.value + then * other.change,
        }
    }
}

impl<T: Field> Div for Change<T> {
    type Output = Self;
    /// `a / b - a0 / b0 = (a - a0 - (a0 / b0) (b - b0)) / b`.
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let then = (self.value - self.change) / (other.value - other.change);
        Self {
            value: self.value / other.value,
            change: (self.change - then * other.change) / other.value,
        }
    }
}

impl<T: Scalar> AddAssign for Change<T> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<T: Scalar> SubAssign for Change<T> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<T: Scalar> MulAssign for Change<T> {
    #[inline(always)]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl<T: Scalar> Zero for Change<T> {
    fn zero() -> Self {
        Self::fixed(T::zero())
    }
    fn is_zero(&self) -> bool {
        self.value.is_zero() && self.change.is_zero()
    }
}

impl<T: Scalar> One for Change<T> {
    fn one() -> Self {
        Self::fixed(T::one())
    }
}

impl<T: Scalar> Scalar for Change<T> {
    fn lit(x: f64) -> Self {
        Self::fixed(T::lit(x))
    }
    #[inline(always)]
    fn outlined<O>(work: impl FnMut() -> O) -> O {
        T::outlined(work)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The change of `x / sqrt(x^2 + 1)` from x = 1 by 1e-12, which the difference of the two
    /// values knows to four digits.
    #[test]
    fn small_changes_keep_their_digits() {
        let h = 1e-12;
        let [[x]] = changes::<f64, f64, 1, 1>(&[[1.0]], &[[h]]);
        let f = x * (x * x + Change::one()).rsqrt();
        let slope = 0.5_f64.sqrt() / 2.0;
        assert!((f.change / (slope * h) - 1.0).abs() < 1e-11);
        assert!((f.value - 0.5_f64.sqrt()).abs() < 1e-11);
        for same in [x / (x * x + Change::one()).sqrt(), {
            let square = x * x;
            (Change::one() + square.recip()).rsqrt()
        }] {
            assert!((same.change / (slope * h) - 1.0).abs() < 1e-11);
            assert!((same.value - f.value).abs() < 1e-15);
        }
    }
}
