//! Elementary functions of double-doubles: Taylor's series after a reduction of the argument, or
//! one correction of the double result, which doubles its digits. All hold to a few units of the
//! last digit; qd's own exponential and logarithm do not for large or small arguments.

use num_dual::DualNum;
use num_traits::{One, Signed, Zero};
use qd::Quad;

use super::DoubleDouble;
use crate::scalar::Real;

const LN_2: DoubleDouble = DoubleDouble(Quad::LN_2);
const LN_10: DoubleDouble = DoubleDouble(Quad::LN_10);

/// A quarter of a turn in three doubles, enough for the sine of a double near a multiple of it.
const QUARTER: [f64; 3] = [
    std::f64::consts::FRAC_PI_2,
    6.123_233_995_736_766e-17,
    -1.497_384_904_859_17e-33,
];

/// `x^first/first! + x^(first + step)/(first + step)! + ..`, with alternating signs if asked for.
fn taylor(x: DoubleDouble, first: u32, step: u32, alternating: bool) -> DoubleDouble {
    let next = |term: DoubleDouble, n: u32| term * x / f64::from(n);
    let mut n = first;
    let mut term = (1..=first).fold(DoubleDouble::one(), next);
    let mut sum = term;
    while term.value().abs() > sum.value().abs() * (0.01 * DoubleDouble::EPSILON) {
        term = (n + 1..=n + step).fold(term, next);
        if alternating {
            term = -term;
        }
        sum += term;
        n += step;
    }
    sum
}

/// The area hyperbolic tangent by its series, for arguments up to 0.2 in magnitude.
fn small_atanh(x: DoubleDouble) -> DoubleDouble {
    let square = x * x;
    let (mut power, mut sum, mut n) = (x, x, 1.0);
    while power.value().abs() > sum.value().abs() * (0.01 * DoubleDouble::EPSILON) {
        n += 2.0;
        power *= square;
        sum += power / n;
    }
    sum
}

fn quarter() -> DoubleDouble {
    DoubleDouble::new(QUARTER[0], QUARTER[1])
}

/// Spherical Bessel function of the first kind and the given order near zero, by its series.
fn small_bessel(x: DoubleDouble, order: u32) -> DoubleDouble {
    let mut term = (1..=order).fold(DoubleDouble::one(), |p, k| p * x / f64::from(2 * k + 1));
    let (mut sum, mut k) = (term, 0);
    while term.value().abs() > sum.value().abs() * (0.01 * DoubleDouble::EPSILON) {
        k += 1;
        term *= -(x * x) / f64::from(2 * k * (2 * (order + k) + 1));
        sum += term;
    }
    sum
}

/// Arguments below this go to a series, where the closed form would cancel.
const SMALL: f64 = 0.3;

impl DualNum for DoubleDouble {
    type Primitive = f64;
    const NDERIV: usize = 0;
    type InnerDual = Self;

    fn from_re(re: Self) -> Self {
        re
    }
    fn scale(self, factor: &Self) -> Self {
        self * factor
    }
    fn recip(&self) -> Self {
        Self::one() / *self
    }
    fn powi(&self, n: i32) -> Self {
        let (mut power, mut square, mut left) = (Self::one(), *self, n.unsigned_abs());
        while left > 0 {
            if left % 2 == 1 {
                power *= square;
            }
            square *= square;
            left /= 2;
        }
        if n < 0 { power.recip() } else { power }
    }
    fn powf(&self, n: f64) -> Self {
        if self.is_zero() {
            Self::from(self.value().powf(n))
        } else if n.fract() == 0.0 && n.abs() < 1e9 {
            self.powi(n as i32)
        } else {
            (self.ln() * n).exp()
        }
    }
    fn sqrt(&self) -> Self {
        let root = self.value().sqrt();
        if !(root > 0.0 && root.is_finite()) {
            return Self::from(root);
        }
        let root = Self::from(root);
        root + (*self - root * root) / (root + root)
    }
    fn cbrt(&self) -> Self {
        let root = self.value().cbrt();
        if root == 0.0 || !root.is_finite() {
            return Self::from(root);
        }
        let root = Self::from(root);
        root + (*self - root * root * root) / (root * root * 3.0)
    }
    fn exp(&self) -> Self {
        let leading = self.value();
        if leading.is_nan() || leading.abs() > 745.0 {
            return Self::from(leading.exp());
        }
        let shift = (leading / LN_2.value()).round();
        let rest = *self - LN_2 * shift;
        taylor(rest, 0, 1, false).scaled(2.0, shift as i32)
    }
    fn exp2(&self) -> Self {
        (*self * LN_2).exp()
    }
    fn exp_m1(&self) -> Self {
        if self.value().abs() < SMALL {
            taylor(*self, 1, 1, false)
        } else {
            self.exp() - 1.0
        }
    }
    fn ln(&self) -> Self {
        let leading = self.value();
        if !(leading > 0.0 && leading.is_finite()) {
            return Self::from(leading.ln());
        }
        let shift = leading.log2().round();
        let rest = self.scaled(2.0, -shift as i32);
        LN_2 * shift + small_atanh((rest - 1.0) / (rest + 1.0)) * 2.0
    }
    fn ln_1p(&self) -> Self {
        if self.value().abs() < SMALL {
            small_atanh(*self / (*self + 2.0)) * 2.0
        } else {
            (*self + 1.0).ln()
        }
    }
    fn log(&self, base: f64) -> Self {
        self.ln() / Self::from(base).ln()
    }
    fn log2(&self) -> Self {
        self.ln() / LN_2
    }
    fn log10(&self) -> Self {
        self.ln() / LN_10
    }
    fn sin(&self) -> Self {
        self.sin_cos().0
    }
    fn cos(&self) -> Self {
        self.sin_cos().1
    }
    fn tan(&self) -> Self {
        let (sin, cos) = self.sin_cos();
        sin / cos
    }
    fn sin_cos(&self) -> (Self, Self) {
        if !self.value().is_finite() {
            return (Self::from(f64::NAN), Self::from(f64::NAN));
        }
        let turns = (self.value() / QUARTER[0]).round();
        let part = |sum: Self, part: f64| sum - Self::from(turns) * part;
        let rest = QUARTER.into_iter().fold(*self, part);
        let (sin, cos) = (taylor(rest, 1, 2, true), taylor(rest, 0, 2, true));
        match turns.rem_euclid(4.0) as u8 {
            0 => (sin, cos),
            1 => (cos, -sin),
            2 => (-sin, -cos),
            _ => (-cos, sin),
        }
    }
    fn asin(&self) -> Self {
        let one = Self::one();
        (*self / ((one - *self) * (one + *self)).sqrt()).atan()
    }
    fn acos(&self) -> Self {
        let one = Self::one();
        ((one - *self) / (one + *self)).sqrt().atan() * 2.0
    }
    fn atan(&self) -> Self {
        if self.value().abs() > 1.0 {
            return quarter() * self.signum() - self.recip().atan();
        }
        // The angle between the slope and the tangent of the double result.
        let guess = Self::from(self.value().atan());
        let (sin, cos) = guess.sin_cos();
        guess + (*self * cos - sin) / (cos + *self * sin)
    }
    fn atan2(&self, other: Self) -> Self {
        let (y, x) = (*self, other);
        if y.is_zero() {
            let half = if x.value().is_sign_negative() {
                2.0
            } else {
                0.0
            };
            quarter() * half * y.signum()
        } else if y.abs() > x.abs() {
            quarter() * y.signum() - (x / y).atan()
        } else if x.value() < 0.0 {
            quarter() * 2.0 * y.signum() + (y / x).atan()
        } else {
            (y / x).atan()
        }
    }
    fn sinh(&self) -> Self {
        if self.value().abs() < SMALL {
            let up = self.exp_m1();
            (up + up / (up + 1.0)) * 0.5
        } else {
            (self.exp() - (-*self).exp()) * 0.5
        }
    }
    fn cosh(&self) -> Self {
        (self.exp() + (-*self).exp()) * 0.5
    }
    fn tanh(&self) -> Self {
        if self.value().abs() > 40.0 {
            return self.signum();
        }
        let up = (*self + *self).exp_m1();
        up / (up + 2.0)
    }
    fn asinh(&self) -> Self {
        let (size, square) = (self.abs(), *self * *self);
        let root = (square + 1.0).sqrt();
        (size + square / (root + 1.0)).ln_1p() * self.signum()
    }
    fn acosh(&self) -> Self {
        let above = *self - 1.0;
        (above + (above * (above + 2.0)).sqrt()).ln_1p()
    }
    fn atanh(&self) -> Self {
        ((*self + *self) / (-*self + 1.0)).ln_1p() * 0.5
    }
    fn sph_j0(&self) -> Self {
        if self.value().abs() < 1.0 {
            return small_bessel(*self, 0);
        }
        self.sin() / *self
    }
    fn sph_j1(&self) -> Self {
        if self.value().abs() < 1.0 {
            return small_bessel(*self, 1);
        }
        let (sin, cos) = self.sin_cos();
        (sin / *self - cos) / *self
    }
    fn sph_j2(&self) -> Self {
        if self.value().abs() < 1.0 {
            return small_bessel(*self, 2);
        }
        self.sph_j1() * 3.0 / *self - self.sph_j0()
    }
}
