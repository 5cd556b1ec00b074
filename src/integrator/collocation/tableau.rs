//! Coefficients of collocation methods, computed in the precision of the number type.

use crate::error::Result;
use crate::quadrature::{gauss_legendre, gauss_radau};
use crate::scalar::Real;

/// Where the equations of motion hold within a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Points {
    Gauss,
    Radau,
}

/// Coefficients of a method in second-order form: stage `i` is at the displacement
/// `u + dt c_i v + dt^2 sum_j twice_ij a_j` with the stage accelerations `a`.
#[derive(Debug)]
pub(super) struct Tableau<R> {
    /// Points in the step.
    pub(super) at: Vec<R>,
    /// Weights of the accelerations in the velocity at the end.
    pub(super) weight: Vec<R>,
    /// Runge-Kutta matrix, and its square.
    pub(super) once: Vec<Vec<R>>,
    pub(super) twice: Vec<Vec<R>>,
    /// Inverses of both.
    pub(super) rate: Vec<Vec<R>>,
    pub(super) inverse: Vec<Vec<R>>,
    /// Weights of the accelerations in the displacement at the end.
    pub(super) end: Vec<R>,
    /// Weights of the error estimate, that of the acceleration at the start first: what the
    /// displacement a quarter into the step would change by if that acceleration counted, too. (At
    /// the end it would change by nothing: the method is that good there.)
    pub(super) estimate: Vec<R>,
}

/// Integrals `int_0^end weight(x) l_j(x) dx` of Lagrange's polynomials on `nodes`.
fn lagrange<R: Real>(nodes: &[R], end: R, weight: impl Fn(R) -> R) -> Result<Vec<R>> {
    let rule = gauss_legendre::<R>(nodes.len() / 2 + 1)?;
    let integral = |j: usize| {
        rule.iter()
            .map(|([x], w)| {
                let x = x * end;
                let factors = (0..nodes.len()).filter(|&k| k != j);
                let value = factors.map(|k| (x - nodes[k]) / (nodes[j] - nodes[k]));
                w * end * weight(x) * value.fold(R::one(), |product, factor| product * factor)
            })
            .sum()
    };
    Ok((0..nodes.len()).map(integral).collect())
}

/// Inverse of a small matrix, by elimination with partial pivoting.
fn inverse<R: Real>(mut matrix: Vec<Vec<R>>) -> Vec<Vec<R>> {
    let n = matrix.len();
    let unit = |i: usize, j: usize| if i == j { R::one() } else { R::zero() };
    for (i, row) in matrix.iter_mut().enumerate() {
        row.extend((0..n).map(|j| unit(i, j)));
    }
    for j in 0..n {
        let larger = |a: usize, i: usize| match matrix[i][j].abs() > matrix[a][j].abs() {
            true => i,
            false => a,
        };
        let chosen = (j..n).fold(j, larger);
        matrix.swap(j, chosen);
        let pivot = matrix[j].clone();
        for (i, row) in matrix.iter_mut().enumerate() {
            let factor = row[j] / pivot[j];
            for k in 0..2 * n {
                match i == j {
                    true => row[k] = pivot[k] / pivot[j],
                    false => row[k] -= factor * pivot[k],
                }
            }
        }
    }
    matrix.into_iter().map(|row| row[n..].to_vec()).collect()
}

impl<R: Real> Tableau<R> {
    pub(super) fn new(points: Points, stages: usize) -> Result<Self> {
        let one = |_: R| R::one();
        let at: Vec<R> = match points {
            Points::Gauss => gauss_legendre(stages)?.iter().map(|([x], _)| x).collect(),
            // The rule has its first node at the start: mirrored.
            Points::Radau => {
                let rule = gauss_radau::<R>(stages)?;
                let mut at: Vec<R> = rule.iter().map(|([x], _)| R::one() - x).collect();
                at.reverse();
                at
            }
        };
        let once = at
            .iter()
            .map(|&c| lagrange(&at, c, one))
            .collect::<Result<Vec<_>>>()?;
        let product = |row: &[R], j: usize| (0..stages).map(|k| row[k] * once[k][j]).sum();
        let weight = lagrange(&at, R::one(), one)?;
        let times = |row: &[R]| (0..stages).map(|j| product(row, j)).collect();
        let twice: Vec<Vec<R>> = once.iter().map(|row| times(row)).collect();
        let end: Vec<R> = times(&weight);
        let with_start: Vec<R> = std::iter::once(R::zero())
            .chain(at.iter().copied())
            .collect();
        let inside = R::lit(0.25);
        let mut estimate = lagrange(&with_start, inside, |x| inside - x)?;
        let without = lagrange(&at, inside, |x| inside - x)?;
        for (estimate, without) in estimate[1..].iter_mut().zip(without) {
            *estimate -= without;
        }
        Ok(Self {
            rate: inverse(once.clone()),
            inverse: inverse(twice.clone()),
            at,
            weight,
            once,
            twice,
            end,
            estimate,
        })
    }
}

pub(super) fn weighted<R: Real>(weights: &[R], values: &[R]) -> R {
    weights.iter().zip(values).map(|(w, x)| *w * *x).sum()
}
