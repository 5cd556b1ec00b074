//! Double-double: the sum of two doubles, about 31 decimal digits, for what single and double
//! precision are measured against. Storage, sums, products and quotients are those of the `qd`
//! crate; this wrapper gives them the traits of a [`Real`].

use std::fmt;
use std::iter::{Product, Sum};
use std::ops::{
    Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Rem, RemAssign, Sub, SubAssign,
};
use std::str::FromStr;

use num_dual::{Derivative, Dual, DualNum, DualSVec, DualStruct, Mappable};
use num_traits::{FromPrimitive, Inv, Num, One, ParseFloatError, Signed, Zero};
use qd::Quad;

use super::{Algebra, Field, Real, Scalar};

mod elementary;

/// A number of two doubles, the second below half a unit in the last place of the first: 106
/// binary digits with the range of a double.
///
/// A constant [`lit(0.1)`](Scalar::lit) is the double nearest to 0.1, wrong in the 17th digit;
/// for more digits divide (`lit(1.0) / lit(10.0)`), parse a decimal, or take [`Real::pi`].
/// Below 1e-290 the second double fades away, so scale a model that small. An overflow gives a number that is not [`finite`](Real::finite), infinite or NaN. In dual
/// numbers over it, the derivatives of `cbrt`, `exp2`, `log2`, `log10` and `log` have double
/// precision only, because num-dual's constants are doubles; all others are exact.
///
/// ```
/// use ancf::scalar::{DoubleDouble, Field, Real, Scalar};
/// let tenth: DoubleDouble = "0.1".parse()?;
/// assert_eq!(tenth, DoubleDouble::lit(1.0) / DoubleDouble::lit(10.0));
/// assert_eq!(tenth.value(), 0.1);
/// assert_ne!(tenth, DoubleDouble::lit(0.1));
/// assert_eq!(DoubleDouble::lit(2.0).sqrt().to_string(), "1.414213562373095048801688724210e0");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(from = "[f64; 2]", into = "[f64; 2]")
)]
pub struct DoubleDouble(Quad);

#[cfg(feature = "serde")]
impl From<[f64; 2]> for DoubleDouble {
    fn from([leading, rest]: [f64; 2]) -> Self {
        Self::new(leading, rest)
    }
}

#[cfg(feature = "serde")]
impl From<DoubleDouble> for [f64; 2] {
    fn from(x: DoubleDouble) -> Self {
        x.parts()
    }
}

impl DoubleDouble {
    /// The sum of two doubles, exact to the last of the digits kept.
    pub fn new(leading: f64, rest: f64) -> Self {
        Self::from(leading) + Self::from(rest)
    }

    /// The leading double, which is the number rounded, and the rest.
    pub fn parts(self) -> [f64; 2] {
        [self.0.0, self.0.1]
    }

    /// Multiplied by `base^exponent`, in two steps so that no power overflows before the product.
    fn scaled(self, base: f64, exponent: i32) -> Self {
        let power = |n: i32| DualNum::powi(&Self::from(base), n.abs());
        let (first, second) = (power(exponent / 2), power(exponent - exponent / 2));
        match exponent {
            0.. => self * first * second,
            _ => self / first / second,
        }
    }
}

impl From<f64> for DoubleDouble {
    #[inline(always)]
    fn from(x: f64) -> Self {
        Self(Quad(x, 0.0))
    }
}

/// The quotient; infinite and vanishing ones as in doubles, where qd gives NaN.
#[inline(always)]
fn quotient(a: Quad, b: Quad) -> Quad {
    let leading = a.0 / b.0;
    if leading.is_finite() && b.0.is_finite() {
        a.div(b)
    } else {
        Quad(leading, 0.0)
    }
}

/// The remainder of the division that rounds towards zero.
fn remainder(a: Quad, b: Quad) -> Quad {
    a.sub_accurate(quotient(a, b).trunc().mul(b))
}

// Sums are formed by qd's accurate variant: that of its operators loses the digits that
// cancellation leaves.
macro_rules! operators {
    ($($trait:ident $method:ident $assign:ident $assigned:ident = $f:expr;)*) => {$(
        impl $trait for DoubleDouble {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self($f(self.0, other.0))
            }
        }
        impl $trait<&Self> for DoubleDouble {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: &Self) -> Self {
                self.$method(*other)
            }
        }
        impl $trait<f64> for DoubleDouble {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: f64) -> Self {
                self.$method(Self::from(other))
            }
        }
        impl $assign for DoubleDouble {
            #[inline(always)]
            fn $assigned(&mut self, other: Self) {
                *self = self.$method(other);
            }
        }
        impl $assign<f64> for DoubleDouble {
            #[inline(always)]
            fn $assigned(&mut self, other: f64) {
                *self = self.$method(other);
            }
        }
    )*};
}
operators! {
    Add add AddAssign add_assign = Quad::add_accurate;
    Sub sub SubAssign sub_assign = Quad::sub_accurate;
    Mul mul MulAssign mul_assign = Quad::mul;
    Div div DivAssign div_assign = quotient;
    Rem rem RemAssign rem_assign = remainder;
}

impl Neg for DoubleDouble {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.0.neg())
    }
}

impl Inv for DoubleDouble {
    type Output = Self;
    fn inv(self) -> Self {
        Self::one() / self
    }
}

impl Sum for DoubleDouble {
    fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
        terms.fold(Self::zero(), Add::add)
    }
}

impl Product for DoubleDouble {
    fn product<I: Iterator<Item = Self>>(factors: I) -> Self {
        factors.fold(Self::one(), Mul::mul)
    }
}

impl PartialEq<f64> for DoubleDouble {
    fn eq(&self, other: &f64) -> bool {
        *self == Self::from(*other)
    }
}

impl PartialOrd<f64> for DoubleDouble {
    fn partial_cmp(&self, other: &f64) -> Option<std::cmp::Ordering> {
        self.partial_cmp(&Self::from(*other))
    }
}

impl Zero for DoubleDouble {
    #[inline(always)]
    fn zero() -> Self {
        Self(Quad::ZERO)
    }
    #[inline(always)]
    fn is_zero(&self) -> bool {
        self.0.0 == 0.0
    }
}

impl One for DoubleDouble {
    #[inline(always)]
    fn one() -> Self {
        Self(Quad::ONE)
    }
}

impl Signed for DoubleDouble {
    #[inline(always)]
    fn abs(&self) -> Self {
        Self(self.0.abs())
    }
    fn abs_sub(&self, other: &Self) -> Self {
        if self > other {
            *self - *other
        } else {
            Self::zero()
        }
    }
    fn signum(&self) -> Self {
        Self::from(self.0.0.signum())
    }
    fn is_positive(&self) -> bool {
        self.0.0 > 0.0
    }
    fn is_negative(&self) -> bool {
        self.0.0 < 0.0
    }
}

impl FromPrimitive for DoubleDouble {
    fn from_i64(n: i64) -> Option<Self> {
        let leading = n as f64;
        // The difference is below 2^11, so it is exact.
        Some(Self::new(leading, (i128::from(n) - leading as i128) as f64))
    }
    fn from_u64(n: u64) -> Option<Self> {
        let leading = n as f64;
        Some(Self::new(leading, (i128::from(n) - leading as i128) as f64))
    }
    fn from_f64(x: f64) -> Option<Self> {
        Some(Self::from(x))
    }
}

impl FromStr for DoubleDouble {
    type Err = std::num::ParseFloatError;
    /// All digits of a decimal, in any notation that doubles have.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let rounded: f64 = text.parse()?;
        if rounded == 0.0 || !rounded.is_finite() {
            return Ok(Self::from(rounded));
        }
        // A valid decimal from here on.
        let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
        let mut exponent = exponent.parse().unwrap_or(0);
        let (mut value, mut fraction) = (Self::zero(), false);
        for c in mantissa.chars() {
            if let Some(digit) = c.to_digit(10) {
                value = value * 10.0 + f64::from(digit);
                exponent -= i32::from(fraction);
            }
            fraction |= c == '.';
        }
        let value = value.scaled(10.0, exponent);
        Ok(if rounded < 0.0 { -value } else { value })
    }
}

impl Num for DoubleDouble {
    type FromStrRadixErr = ParseFloatError;
    /// Radix 10 gives all digits, any other those of a double.
    fn from_str_radix(text: &str, radix: u32) -> Result<Self, ParseFloatError> {
        let rounded = f64::from_str_radix(text, radix)?;
        let all = (radix == 10).then(|| text.parse().ok()).flatten();
        Ok(all.unwrap_or(Self::from(rounded)))
    }
}

/// Digits written if no precision is asked for: all that are sure.
const DIGITS: usize = 31;

/// Scientific notation with 31 digits, or with the given number of decimals up to 30.
impl fmt::Display for DoubleDouble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let leading = self.value();
        if leading == 0.0 || !leading.is_finite() {
            return fmt::Display::fmt(&leading, f);
        }
        let digits = f.precision().map_or(DIGITS, |p| (p + 1).min(DIGITS));
        let mut exponent = leading.abs().log10().floor() as i32;
        let integer = |exponent: i32| {
            let [high, low] = self
                .abs()
                .scaled(10.0, digits as i32 - 1 - exponent)
                .parts();
            (high.trunc() as i128 + (low + high.fract()).round() as i128).to_string()
        };
        let mut text = integer(exponent);
        if text.len() != digits {
            // The logarithm was that of a neighbour of a power of ten.
            exponent += text.len() as i32 - digits as i32;
            text = integer(exponent);
        }
        let (first, rest) = text.split_at(1);
        let point = if rest.is_empty() { "" } else { "." };
        let text = format!("{first}{point}{rest}e{exponent}");
        f.pad_integral(leading >= 0.0, "", &text)
    }
}

impl DualStruct for DoubleDouble {
    type Real = f64;
    type Inner = Self;
    fn re(&self) -> f64 {
        self.value()
    }
    fn from_inner(inner: &Self) -> Self {
        *inner
    }
}

impl Mappable<Self> for DoubleDouble {
    type Output<O> = O;
    fn map_dual<M: Fn(Self) -> O, O>(self, f: M) -> O {
        f(self)
    }
}

impl Scalar for DoubleDouble {
    #[inline(always)]
    fn lit(x: f64) -> Self {
        Self::from(x)
    }
}

impl Real for DoubleDouble {
    const EPSILON: f64 = f64::EPSILON * f64::EPSILON;
    const ORDER: usize = 0;
    #[inline(always)]
    fn value(self) -> f64 {
        self.0.0
    }
    #[inline(always)]
    fn finite(self) -> bool {
        self.0.is_finite()
    }
}
plain!(DoubleDouble);

/// Models stored in floats, evaluated with all digits of double-doubles: what tells the rounding of a
/// model's constants from that of arithmetic. (Not `f64` over `f32`: with two algebras to choose from,
/// `f64::variable` would be ambiguous.)
macro_rules! over_floats {
    ($($float:ty)*) => {$(
        impl Algebra<$float> for DoubleDouble {
            by_num_dual!();
            #[inline(always)]
            fn lift(r: $float) -> Self {
                Self::from(f64::from(r))
            }
            #[inline(always)]
            fn times(self, r: $float) -> Self {
                self * f64::from(r)
            }
        }
    )*};
}
over_floats!(f32 f64);
