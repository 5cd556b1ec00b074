//! Exact derivatives against finite differences over a sweep of increments. Truncation makes the
//! error fall with the increment, rounding makes it rise again: a V, whose floor a correct
//! derivative reaches and a wrong one never does. With differences of order `p` the best increment
//! is near `eps^(1/(p+1))`: square root of the machine epsilon for forward differences, cube root
//! for central ones, fifth root for Richardson's extrapolation of central ones.

use std::fmt;

use super::{Limit, Report};
use crate::error::{Error, Result};
use crate::formulation::{ElementKernel, Tangent};
use crate::scalar::{Algebra, Real};
use crate::solver::{Matrix, Rate, Structure};

/// A function of several variables, written once for every number type over `R`.
pub trait Residual<R: Real> {
    /// Values at `x`; as many at every `x`.
    fn eval<T: Algebra<R>>(&self, x: &[T]) -> Vec<T>;
}

/// How finite differences are taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Scheme {
    /// `(f(x + h) - f(x)) / h`, order 1.
    Forward,
    /// `(f(x + h) - f(x - h)) / 2h`, order 2.
    Central,
    /// Richardson's extrapolation `(4 c(h/2) - c(h)) / 3` of central differences, order 4.
    Richardson,
}

impl Scheme {
    /// The three of them.
    pub const ALL: [Self; 3] = [Self::Forward, Self::Central, Self::Richardson];

    /// Order of the truncation error.
    #[must_use]
    pub fn order(self) -> i32 {
        match self {
            Self::Forward => 1,
            Self::Central => 2,
            Self::Richardson => 4,
        }
    }

    /// The increment theory expects to be best, `eps^(1/(order + 1))`, for functions of unit scale.
    #[must_use]
    pub fn expected_increment(self, epsilon: f64) -> f64 {
        epsilon.powf(1.0 / f64::from(self.order() + 1))
    }
}

/// Errors at one increment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveRow {
    /// Increment over the natural size of each variable.
    pub increment: f64,
    /// Relative errors in the order of [`Scheme::ALL`]: Frobenius norm of the difference of the
    /// Jacobians over that of the exact one.
    pub errors: [f64; 3],
}

/// The V-shaped error curves; prints as a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Machine epsilon of the number type.
    pub epsilon: f64,
    /// Errors from the largest increment to the smallest.
    pub rows: Vec<CurveRow>,
}

impl Curve {
    /// Increment and relative error of a scheme, for every increment.
    pub fn points(&self, scheme: Scheme) -> impl Iterator<Item = [f64; 2]> {
        self.rows
            .iter()
            .map(move |row| [row.increment, row.errors[scheme as usize]])
    }

    /// Increment and error at the bottom of the V; NaN without a finite error.
    #[must_use]
    pub fn best(&self, scheme: Scheme) -> [f64; 2] {
        let finite = self.points(scheme).filter(|p| p[1].is_finite());
        finite
            .min_by(|a, b| a[1].total_cmp(&b[1]))
            .unwrap_or([f64::NAN; 2])
    }

    /// The verdict: each scheme's best error must come down to what rounding leaves, `eps` to the
    /// power `order / (order + 1)` times `margin` (1000 for the checks of this module; more for
    /// functions whose derivative is small against their terms). Errors are of the whole matrix: on a
    /// slender element what bends is a small part of it, `(R/L)^2`, and in single precision a wrong bending
    /// stiffness hides below the limit; check slender parts in `f64`, or stocky ones.
    #[must_use]
    pub fn report(&self, margin: f64) -> Report {
        let mut report = Report::new(format!("Jacobian, machine epsilon {:.1e}", self.epsilon));
        for scheme in Scheme::ALL {
            let [increment, error] = self.best(scheme);
            let case = format!("{scheme:?}");
            let order = f64::from(scheme.order());
            let limit = margin * self.epsilon.powf(order / (order + 1.0));
            report.push(
                "best error of differences",
                &case,
                error,
                Limit::AtMost(limit.min(0.1)),
            );
            let ratio = increment / scheme.expected_increment(self.epsilon);
            report.push("best increment over theory's", case, ratio, Limit::None);
        }
        report
    }
}

impl fmt::Display for Curve {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:>10}", "increment")?;
        for scheme in Scheme::ALL {
            write!(f, "  {:>10}", format!("{scheme:?}"))?;
        }
        for row in &self.rows {
            write!(f, "\n{:10.2e}", row.increment)?;
            for error in row.errors {
                write!(f, "  {error:10.2e}")?;
            }
        }
        Ok(())
    }
}

/// Increments per decade of a sweep.
const PER_DECADE: i32 = 4;

/// Sweeps finite differences of `f` at `x` against its `jacobian` there (row by row, one row for
/// each value of `f`). Increments are relative to `units`, the natural size of each variable, which
/// also weighs the columns. The general form of the checks of this module, for a derivative of any
/// origin.
///
/// # Errors
/// [`Error::Length`] when units or Jacobian do not fit, [`Error::NotPositive`] for a Jacobian that
/// is zero, and those of `f`.
pub fn differences<R: Real>(
    f: impl Fn(&[R]) -> Result<Vec<R>>,
    jacobian: &[R],
    x: &[R],
    units: &[R],
) -> Result<Curve> {
    let (n, at) = (x.len(), f(x)?);
    Error::check_length("number of natural sizes", units.len(), n)?;
    Error::check_length("entries of the Jacobian", jacobian.len(), at.len() * n)?;
    let scaled = |i: usize, j: usize| (jacobian[i * n + j] * units[j]).value();
    let norm: f64 = (0..jacobian.len())
        .map(|k| scaled(k / n, k % n).powi(2))
        .sum::<f64>()
        .sqrt();
    crate::error::positive("Frobenius norm of the Jacobian", R::lit(norm))?;
    let decades = -R::EPSILON.log10().ceil() as i32;
    let mut rows = Vec::new();
    for k in PER_DECADE / 2..=PER_DECADE * decades {
        let h = 10.0_f64.powf(-f64::from(k) / f64::from(PER_DECADE));
        let mut square = [0.0_f64; 3];
        for j in 0..n {
            let moved = |h: f64| -> Result<(R, Vec<R>)> {
                let mut y = x.to_vec();
                y[j] += R::lit(h) * units[j];
                Ok((y[j], f(&y)?))
            };
            // The increment the number type could store, not the one asked for.
            let slope = |(a, fa): &(R, Vec<R>), (b, fb): &(R, Vec<R>)| -> Vec<f64> {
                let per_unit = units[j] / (*a - *b);
                fa.iter()
                    .zip(fb)
                    .map(|(a, b)| ((*a - *b) * per_unit).value())
                    .collect()
            };
            let [plus, minus] = [moved(h)?, moved(-h)?];
            let central = slope(&plus, &minus);
            let halved = slope(&moved(0.5 * h)?, &moved(-0.5 * h)?);
            let forward = slope(&plus, &(x[j], at.clone()));
            for i in 0..at.len() {
                let richardson = (4.0 * halved[i] - central[i]) / 3.0;
                for (sum, d) in square.iter_mut().zip([forward[i], central[i], richardson]) {
                    *sum += (d - scaled(i, j)).powi(2);
                }
            }
        }
        let errors = square.map(|sum| sum.sqrt() / norm);
        rows.push(CurveRow {
            increment: h,
            errors,
        });
    }
    Ok(Curve {
        epsilon: R::EPSILON,
        rows,
    })
}

/// The Jacobian of a function by dual numbers against finite differences; the variables are taken
/// to be of size one.
///
/// ```
/// use ancf::scalar::{Algebra, Field};
/// use ancf::verify::{Residual, Scheme, jacobian};
///
/// struct Spiral;
/// impl Residual<f64> for Spiral {
///     fn eval<T: Algebra<f64>>(&self, x: &[T]) -> Vec<T> {
///         vec![x[0].exp() * x[1].cos(), x[0].exp() * x[1].sin()]
///     }
/// }
/// let curve = jacobian(&Spiral, &[0.3, 0.8])?;
/// curve.report(1e3).into_result()?;
/// assert!(curve.best(Scheme::Central)[1] < 1e-9);
/// # Ok::<(), ancf::Error>(())
/// ```
///
/// # Errors
/// Those of [`differences`].
pub fn jacobian<R: Real, F: Residual<R>>(function: &F, x: &[R]) -> Result<Curve> {
    let n = x.len();
    let rows = function.eval(x).len();
    let mut exact = vec![R::zero(); rows * n];
    for j in 0..n {
        let dual = |(i, x): (usize, &R)| match i == j {
            true => x.variable::<1>(0),
            false => x.constant::<1>(),
        };
        let dual: Vec<<R as Algebra<R>>::Dual<1>> = x.iter().enumerate().map(dual).collect();
        for (i, value) in function.eval(&dual).iter().enumerate() {
            exact[i * n + j] = R::derivative::<1>(value, 0);
        }
    }
    differences(|x| Ok(function.eval(x)), &exact, x, &vec![R::one(); n])
}

/// The force of an element kernel against differences of its energy, at nodal displacements `u`
/// with natural sizes `units` of the nodal vectors (the length for positions (m), 1 for slopes).
///
/// # Errors
/// Those of [`differences`].
pub fn energy_gradient<R: Real, K, const D: usize, const S: usize>(
    kernel: &K,
    u: &[[R; D]; S],
    units: &[R; S],
) -> Result<Curve>
where
    K: ElementKernel<R, D, S>,
{
    let mut q = [[R::zero(); D]; S];
    kernel.force(u, &mut q);
    let energy = |x: &[R]| Ok(vec![kernel.energy(&nodal::<R, D, S>(x))]);
    differences(
        energy,
        q.as_flattened(),
        u.as_flattened(),
        &spread::<R, D, S>(units),
    )
}

/// The tangent of an element kernel against differences of its force, with the arguments of
/// [`energy_gradient`].
///
/// # Errors
/// Those of [`differences`].
pub fn force_gradient<R: Real, K, const D: usize, const S: usize>(
    kernel: &K,
    u: &[[R; D]; S],
    units: &[R; S],
) -> Result<Curve>
where
    K: ElementKernel<R, D, S>,
{
    let units = spread::<R, D, S>(units);
    let mut q = [[R::zero(); D]; S];
    let mut k: Tangent<R, D, S> = [[[[R::zero(); D]; S]; D]; S];
    kernel.tangent(u, &mut q, &mut k);
    // In units of energy, so that forces on positions and on slopes can be added.
    let rows = k.as_flattened().as_flattened().as_flattened().chunks(S * D);
    let exact = rows
        .zip(&units)
        .flat_map(|(row, unit)| row.iter().map(|k| *k * *unit));
    let force = |x: &[R]| {
        let mut q = [[R::zero(); D]; S];
        kernel.force(&nodal::<R, D, S>(x), &mut q);
        Ok(q.as_flattened()
            .iter()
            .zip(&units)
            .map(|(q, unit)| *q * *unit)
            .collect())
    };
    differences(force, &exact.collect::<Vec<_>>(), u.as_flattened(), &units)
}

/// The assembled tangent of a structure against differences of its residual, internal minus
/// external forces, by the unknowns, at the time `time` (s) and displacements `u` (as far as no
/// support or joint says otherwise).
///
/// # Errors
/// Those of [`differences`] and of the structure's loads.
pub fn structure_tangent<R: Real, S: Structure<R>>(
    structure: &S,
    time: R,
    u: &[R],
) -> Result<Curve> {
    let (unknowns, measure) = (structure.unknowns(), structure.measure());
    Error::check_length("length of the displacements", u.len(), measure.len())?;
    let mut u = u.to_vec();
    structure.impose(time, Rate::Displacement, &mut u)?;
    let mut k = Matrix::zero(unknowns, false);
    structure.add_tangent(time, R::one(), &u, &mut k)?;
    let units: Vec<R> = unknowns.free().iter().map(|i| measure[*i]).collect();
    let n = units.len();
    let exact: Vec<R> = (0..n * n)
        .map(|e| k.stored().get(e / n, e % n) * units[e / n])
        .collect();
    let residual = |q: &[R]| {
        let mut u = u.clone();
        for (q, i) in q.iter().zip(unknowns.free()) {
            u[*i] = *q;
        }
        structure.impose(time, Rate::Displacement, &mut u)?;
        let (mut internal, mut external) = (vec![R::zero(); u.len()], vec![R::zero(); u.len()]);
        structure.add_internal(&u, &mut internal);
        structure.add_external(time, R::one(), &u, &mut external)?;
        for (q, external) in internal.iter_mut().zip(&external) {
            *q -= *external;
        }
        unknowns.reduce(&mut internal);
        let free = unknowns.free().iter().zip(&units);
        Ok(free.map(|(i, unit)| internal[*i] * *unit).collect())
    };
    let q: Vec<R> = unknowns.free().iter().map(|i| u[*i]).collect();
    differences(residual, &exact, &q, &units)
}

fn nodal<R: Real, const D: usize, const S: usize>(x: &[R]) -> [[R; D]; S] {
    std::array::from_fn(|i| std::array::from_fn(|c| x[i * D + c]))
}

/// The unit of each nodal vector for each of its components.
fn spread<R: Real, const D: usize, const S: usize>(units: &[R; S]) -> Vec<R> {
    units.iter().flat_map(|unit| [*unit; D]).collect()
}
