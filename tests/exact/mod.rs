//! Reference arithmetic of the tests: double-double numbers, in which sums over a rule are
//! accumulated so that it is the rule that is tested and not the summation, and closed-form
//! moments.
#![allow(dead_code)]

use std::ops::{Add, Mul, Neg, Sub};

use ancf::quadrature::Cubature;
use ancf::scalar::Real;

/// About 32 digits: `.0 + .1`.
#[derive(Clone, Copy, Debug)]
pub struct Exact(pub f64, pub f64);

fn sum(a: f64, b: f64) -> Exact {
    let s = a + b;
    let part = s - a;
    Exact(s, (a - (s - part)) + (b - part))
}

impl From<f64> for Exact {
    fn from(x: f64) -> Self {
        Exact(x, 0.0)
    }
}
impl Add for Exact {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        let high = sum(self.0, o.0);
        let low = sum(self.1, o.1);
        let s = sum(high.0, high.1 + low.0);
        sum(s.0, s.1 + low.1)
    }
}
impl Neg for Exact {
    type Output = Self;
    fn neg(self) -> Self {
        Exact(-self.0, -self.1)
    }
}
impl Sub for Exact {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        self + -o
    }
}
impl Mul for Exact {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        let p = self.0 * o.0;
        let e = self.0.mul_add(o.0, -p);
        sum(p, e + (self.0 * o.1 + self.1 * o.0))
    }
}

impl Exact {
    pub const PI: Exact = Exact(std::f64::consts::PI, 1.2246467991473532e-16);

    pub fn over(self, d: f64) -> Self {
        let q = self.0 / d;
        let rest = self - Exact::from(q) * Exact::from(d);
        sum(q, (rest.0 + rest.1) / d)
    }

    pub fn powi(self, n: usize) -> Self {
        (0..n).fold(Exact::from(1.0), |p, _| p * self)
    }

    /// Square root of a number above zero, by one Newton step.
    pub fn sqrt(self) -> Self {
        let guess = self.0.sqrt();
        let rest = self - Exact::from(guess) * Exact::from(guess);
        sum(guess, (rest.0 + rest.1) / (2.0 * guess))
    }

    pub fn abs(self) -> f64 {
        (self.0 + self.1).abs()
    }
}

/// Defect of a rule for the monomial `f` with the given exponents, in two units. The first,
/// EPSILON * sum |w f|, is the rounding of weights and values of the integrand. The second,
/// EPSILON/2 * sum |w| (|f| + |x . grad f|), is what storing the rule costs at most: weights and
/// coordinates that are the nearest numbers to the true ones stay within one such unit, and no
/// rule can be asked for more.
pub fn both_units<R: Real, const C: usize>(
    rule: &Cubature<R, C>,
    exponents: [usize; C],
    exact: Exact,
) -> [f64; 2] {
    let (mut total, mut size) = (Exact::from(0.0), 0.0);
    for (x, w) in rule.iter() {
        let mut term = Exact::from(w.value());
        for c in 0..C {
            term = term * Exact::from(x[c].value()).powi(exponents[c]);
        }
        size += term.abs();
        total = total + term;
    }
    let defect = (total - exact).abs() / R::EPSILON;
    if defect == 0.0 {
        return [0.0; 2];
    }
    let degree = exponents.iter().sum::<usize>() as f64;
    [defect / size, 2.0 * defect / (size * (1.0 + degree))]
}

/// The second of [`both_units`].
pub fn units<R: Real, const C: usize>(
    rule: &Cubature<R, C>,
    exponents: [usize; C],
    exact: Exact,
) -> f64 {
    both_units(rule, exponents, exact)[1]
}

/// All pairs of exponents up to a total degree.
pub fn pairs(degree: usize) -> impl Iterator<Item = [usize; 2]> {
    (0..=degree).flat_map(|d| (0..=d).map(move |a| [a, d - a]))
}

fn double_factorial(n: usize) -> f64 {
    (1..=n).rev().step_by(2).map(|k| k as f64).product()
}

/// Mean of cos^a sin^b over the circle.
fn angular([a, b]: [usize; 2]) -> Exact {
    if a % 2 == 1 || b % 2 == 1 {
        return Exact::from(0.0);
    }
    let top = double_factorial(a.max(1) - 1) * double_factorial(b.max(1) - 1);
    Exact::from(top).over(double_factorial(a + b))
}

/// Integral of y^a z^b over the ring between two radii (a disk for the inner radius zero).
pub fn ring([a, b]: [usize; 2], outer: f64, inner: f64) -> Exact {
    let n = a + b + 2;
    let radial = Exact::from(outer).powi(n) - Exact::from(inner).powi(n);
    (Exact::PI * Exact::from(2.0) * radial * angular([a, b])).over(n as f64)
}

/// Integral of x^a over the interval from -h/2 to h/2.
pub fn centred(a: usize, h: f64) -> Exact {
    if a % 2 == 1 {
        return Exact::from(0.0);
    }
    let half = Exact::from(h / 2.0);
    (half.powi(a + 1) * Exact::from(2.0)).over((a + 1) as f64)
}
