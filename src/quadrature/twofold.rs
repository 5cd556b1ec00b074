//! Numbers held as an unevaluated sum of two reals, carrying twice the digits of the working
//! type. Rules are computed in them and rounded once at the end, so that their nodes and
//! weights are as good as the working type can store, in any type: single precision, double
//! precision and dual numbers alike. Over double-doubles, whose own sums and products are not
//! rounded correctly, little is gained: rules there are good to a few units of the last digit.

use std::ops::{Add, Div, Mul, Neg, Sub};

use num_traits::FloatConst;

use crate::scalar::Real;

/// `hi + lo` with `lo` below half a unit in the last place of `hi`. The error-free sum is
/// Knuth's and the error-free product Dekker's (1971), which need no fused multiply-add. The
/// operations are differentiable: duals keep correct derivatives, in working precision.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Twofold<R> {
    hi: R,
    lo: R,
}

/// 2^k + 1 with 2k at least the number of digits: splits a number into two halves whose
/// products are exact.
const fn splitter(epsilon: f64) -> f64 {
    let mut half = 1.0;
    while half * half * epsilon < 2.0 {
        half *= 2.0;
    }
    half + 1.0
}

fn exact_sum<R: Real>(a: R, b: R) -> Twofold<R> {
    let hi = a + b;
    let part = hi - a;
    let lo = (a - (hi - part)) + (b - part);
    Twofold { hi, lo }
}

fn split<R: Real>(a: R) -> (R, R) {
    let wide = R::lit(splitter(R::EPSILON)) * a;
    let high = wide - (wide - a);
    (high, a - high)
}

fn exact_product<R: Real>(a: R, b: R) -> Twofold<R> {
    let hi = a * b;
    let ((ah, al), (bh, bl)) = (split(a), split(b));
    let lo = ((ah * bh - hi) + ah * bl + al * bh) + al * bl;
    Twofold { hi, lo }
}

impl<R: Real> Twofold<R> {
    /// The number `x` itself.
    pub(crate) fn new(x: R) -> Self {
        let lo = R::zero();
        Self { hi: x, lo }
    }

    /// A constant that is exact in the working type.
    pub(crate) fn lit(x: f64) -> Self {
        Self::new(R::lit(x))
    }

    /// A count, exact below 2^24 in every type.
    pub(crate) fn count(n: usize) -> Self {
        Self::lit(n as f64)
    }

    /// The circle constant. The sine of its rounded value is what the rounding left out.
    pub(crate) fn pi() -> Self {
        let hi = R::from(R::Primitive::PI());
        Self { hi, lo: hi.sin() }
    }

    /// Rounded to the working type.
    pub(crate) fn round(self) -> R {
        self.hi + self.lo
    }

    /// A pair of doubles in any type, to twice its digits or to those of the pair.
    pub(crate) fn lifted(x: Twofold<f64>) -> Self {
        let hi = R::lit(x.hi);
        let lo = R::lit((x.hi - hi.value()) + x.lo);
        Self { hi, lo }
    }

    /// Square root of a number above zero.
    pub(crate) fn sqrt(self) -> Self {
        let guess = Self::new(self.hi.sqrt());
        guess + (self - guess * guess) / (guess + guess)
    }

    /// Cosine and sine of an angle (rad) from zero to pi/4, by their Taylor series: libraries
    /// offer them in working precision only.
    pub(crate) fn cos_sin(self) -> (Self, Self) {
        let mut term = Self::lit(1.0);
        let mut sums = [term, Self::lit(0.0)];
        let mut k = 0;
        while term.hi.value().abs() > R::EPSILON * R::EPSILON / 16.0 {
            k += 1;
            term = term * self / Self::count(k);
            let signed = if k % 4 < 2 { term } else { -term };
            sums[k % 2] = sums[k % 2] + signed;
        }
        (sums[0], sums[1])
    }
}

impl<R: Real> Add for Twofold<R> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let high = exact_sum(self.hi, other.hi);
        let low = exact_sum(self.lo, other.lo);
        let sum = exact_sum(high.hi, high.lo + low.hi);
        exact_sum(sum.hi, sum.lo + low.lo)
    }
}

impl<R: Real> Neg for Twofold<R> {
    type Output = Self;
    fn neg(self) -> Self {
        let (hi, lo) = (-self.hi, -self.lo);
        Self { hi, lo }
    }
}

impl<R: Real> Sub for Twofold<R> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + (-other)
    }
}

impl<R: Real> Mul for Twofold<R> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let high = exact_product(self.hi, other.hi);
        exact_sum(high.hi, high.lo + (self.hi * other.lo + self.lo * other.hi))
    }
}

impl<R: Real> Div for Twofold<R> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let first = Self::new(self.hi / other.hi);
        let rest = self - other * first;
        let second = Self::new(rest.hi / other.hi);
        let rest = rest - other * second;
        first + second + Self::new(rest.hi / other.hi)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_dual::Dual64;

    fn digits<R: Real>() {
        let third = Twofold::<R>::lit(1.0) / Twofold::lit(3.0);
        let defect = third * Twofold::lit(3.0) - Twofold::lit(1.0);
        assert!(defect.hi.value().abs() < 4.0 * R::EPSILON * R::EPSILON);
        let two = Twofold::<R>::lit(2.0);
        let defect = two.sqrt() * two.sqrt() - two;
        assert!(defect.hi.value().abs() < 8.0 * R::EPSILON * R::EPSILON);
        let (cos, sin) = (Twofold::<R>::pi() / Twofold::lit(6.0)).cos_sin();
        let defect = sin - Twofold::lit(0.5);
        assert!(defect.hi.value().abs() < 8.0 * R::EPSILON * R::EPSILON);
        let defect = cos * cos - Twofold::lit(0.75);
        assert!(defect.hi.value().abs() < 8.0 * R::EPSILON * R::EPSILON);
    }

    #[test]
    fn arithmetic_holds_twice_the_digits_in_every_type() {
        digits::<f32>();
        digits::<f64>();
        digits::<Dual64>();
    }

    #[test]
    fn derivatives_pass_through() {
        let x = Twofold::new(Dual64::from_re(0.3).derivative());
        let y = ((x * x + Twofold::lit(1.0)) / x).sqrt().round();
        let value: f64 = (0.3_f64 + 1.0 / 0.3).sqrt();
        assert!((y.re - value).abs() < 1e-15);
        let slope = (1.0 - 1.0 / 0.09) / (2.0 * value);
        assert!((y.eps - slope).abs() < 1e-14);
    }
}
