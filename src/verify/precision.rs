//! Where digits are lost: a computation in stages, run in a working number type and in a reference
//! type, over a sweep of a parameter. Every stage's share is what it alone adds when the other
//! stages run in the reference type.

use std::fmt;

use super::{Limit, Report};
use crate::element::most;
use crate::error::{Error, Result, positive};
use crate::scalar::Real;

/// A computation in stages, written once for every number type. A stage takes the numbers of the
/// one before; what they mean is between the two.
///
/// A beam's force may be one stage; or the coordinates' difference, the strain, the force and the
/// solution of a linear system four.
pub trait Staged {
    /// Names of the stages, in order; at least one.
    const STAGES: &'static [&'static str];

    /// What the first stage takes at a value of the sweep's parameter. Taken in the reference type.
    ///
    /// # Errors
    /// Those of the computation.
    fn given<X: Real>(&self, parameter: f64) -> Result<Vec<X>>;

    /// Stage `k` in the number type `R`. It has the same number of results in every type.
    ///
    /// # Errors
    /// Those of the computation.
    fn stage<R: Real>(&self, k: usize, parameter: f64, given: &[R]) -> Result<Vec<R>>;

    /// Natural size of the results, which errors are relative to; by default their Euclidean norm.
    fn size(&self, _parameter: f64) -> Option<f64> {
        None
    }
}

/// What one stage adds to the error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Share {
    /// Name of the stage.
    pub stage: &'static str,
    /// Error of the results from storing in the working type what the stage takes.
    pub stored: f64,
    /// Error of the results from the stage's arithmetic in the working type, on what is stored.
    pub computed: f64,
}

/// Errors at one value of the parameter: Euclidean norms over the size of the results.
#[derive(Debug, Clone, PartialEq)]
pub struct PrecisionRow {
    /// Value of the parameter.
    pub parameter: f64,
    /// Error of the whole computation in the working type.
    pub error: f64,
    /// Share of every stage.
    pub shares: Vec<Share>,
}

/// Errors over a sweep; prints as a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Precision {
    /// Machine epsilon of the working type.
    pub epsilon: f64,
    /// One row for each value of the parameter, in the order given.
    pub rows: Vec<PrecisionRow>,
}

impl Precision {
    /// Decimal digits of the working type that are lost in a row: the logarithm of its error over
    /// `epsilon`, not below zero.
    #[must_use]
    pub fn digits_lost(&self, row: &PrecisionRow) -> f64 {
        most((row.error / self.epsilon).log10(), 0.0)
    }

    /// The verdict: every row may lose at most this number of digits. The shares inform.
    #[must_use]
    pub fn report(&self, digits: f64) -> Report {
        let mut report = Report::new(format!("Precision, machine epsilon {:.1e}", self.epsilon));
        for row in &self.rows {
            let at = format!("at {:.1e}", row.parameter);
            let limit = Limit::AtMost(digits);
            report.push("digits lost", &at, self.digits_lost(row), limit);
            for share in &row.shares {
                let case = format!("{at}, {}", share.stage);
                report.push("error stored", &case, share.stored, Limit::None);
                report.push("error computed", case, share.computed, Limit::None);
            }
        }
        report
    }
}

impl fmt::Display for Precision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:>10}  {:>10}  {:>6}", "parameter", "error", "lost")?;
        for share in self.rows.first().iter().flat_map(|row| &row.shares) {
            write!(f, "  {:>21}", share.stage)?;
        }
        for row in &self.rows {
            let lost = self.digits_lost(row);
            let (parameter, error) = (row.parameter, row.error);
            write!(f, "\n{parameter:10.2e}  {error:10.2e}  {lost:6.1}")?;
            for share in &row.shares {
                write!(f, "  {:10.2e} {:10.2e}", share.stored, share.computed)?;
            }
        }
        Ok(())
    }
}

/// Runs a computation in the working type `W` and measures it in the reference type `X` over the
/// values of a parameter.
///
/// ```
/// use ancf::Result;
/// use ancf::scalar::{Field, Real};
/// use ancf::verify::{Staged, precision};
///
/// /// The stretch of a fibre that shears by `x`, less one.
/// struct Stretch;
/// impl Staged for Stretch {
///     const STAGES: &'static [&'static str] = &["root", "difference"];
///     fn given<X: Real>(&self, x: f64) -> Result<Vec<X>> {
///         Ok(vec![X::lit(x)])
///     }
///     fn stage<R: Real>(&self, k: usize, _: f64, x: &[R]) -> Result<Vec<R>> {
///         Ok(vec![match k {
///             0 => Field::sqrt(R::one() + x[0] * x[0]),
///             _ => x[0] - R::one(),
///         }])
///     }
/// }
/// let single = precision::<f32, f64, _>(&Stretch, &[1.0, 1e-3])?;
/// println!("{single}");
/// // A strain of 5e-7 is lost, and no other stage is to blame than the one that adds to one.
/// let lost = &single.rows[1];
/// assert!(single.digits_lost(lost) > 5.0);
/// assert!(lost.shares[0].computed > 1e-2 && lost.shares[1].computed < 1e-7);
/// # Ok::<(), ancf::Error>(())
/// ```
///
/// # Errors
/// [`Error::TooFew`] without values or stages, [`Error::Length`] when a stage's results differ in
/// number, [`Error::NotPositive`] when there is no size to relate errors to, and those of the
/// computation.
pub fn precision<W: Real, X: Real, C: Staged>(
    computation: &C,
    parameters: &[f64],
) -> Result<Precision> {
    for (what, value) in [
        ("number of values of a precision sweep", parameters.len()),
        ("number of stages of a computation", C::STAGES.len()),
    ] {
        if value == 0 {
            return Err(Error::TooFew {
                what,
                value,
                least: 1,
                remedy: "give at least one",
            });
        }
    }
    let row = |&parameter: &f64| {
        let mut taken = vec![computation.given::<X>(parameter)?];
        for k in 0..C::STAGES.len() {
            taken.push(computation.stage(k, parameter, &taken[k])?);
        }
        let truth = &taken[C::STAGES.len()];
        let norm: X = truth.iter().map(|y| *y * *y).sum();
        let size = computation.size(parameter);
        let size = size.unwrap_or(norm.value().sqrt());
        positive("size of the results of a computation", size)?;
        let error = |y: &[X], other: &[X]| {
            Error::check_length("results of a computation", y.len(), other.len())?;
            let square = y.iter().zip(other).map(|(a, b)| (*a - *b) * (*a - *b));
            Ok(square.sum::<X>().value().sqrt() / size)
        };
        // Stages from the first on in the type of what it takes.
        let rest = |first: usize, mut y: Vec<X>| {
            for k in first..C::STAGES.len() {
                y = computation.stage(k, parameter, &y)?;
            }
            Ok::<_, Error>(y)
        };
        let mut all = stored::<X, W>(&taken[0]);
        let mut shares = Vec::new();
        for (k, stage) in C::STAGES.iter().enumerate() {
            all = computation.stage(k, parameter, &all)?;
            let given = stored::<X, W>(&taken[k]);
            let exact = rest(k, stored(&given))?;
            let computed = computation.stage(k, parameter, &given)?;
            let computed = rest(k + 1, stored(&computed))?;
            shares.push(Share {
                stage,
                stored: error(&exact, truth)?,
                computed: error(&computed, &exact)?,
            });
        }
        Ok(PrecisionRow {
            parameter,
            error: error(&stored(&all), truth)?,
            shares,
        })
    };
    let rows: Result<Vec<_>> = parameters.iter().map(row).collect();
    Ok(Precision {
        epsilon: W::EPSILON,
        rows: rows?,
    })
}

/// Numbers in another type, to double precision.
fn stored<A: Real, B: Real>(numbers: &[A]) -> Vec<B> {
    numbers.iter().map(|x| B::lit(x.value())).collect()
}
