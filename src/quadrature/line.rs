//! Gauss rules on a line, all from one mechanism: the nodes are the zeros of the polynomial that
//! a three-term recurrence ends with, bracketed by Sturm's sequence and polished by Newton's
//! method; the weights are Christoffel numbers. Legendre's and Radau's rules, rules for any
//! other weight function and the projected rules differ only in their recurrence.

use std::sync::OnceLock;

use super::twofold::Twofold;
use super::{Cubature, MAX_ORDER, admissible};
use crate::error::{Error, Result, finite, positive};
use crate::scalar::Real;

/// Nodes with their weights, ascending, before rounding.
pub(crate) type Nodes<R> = Vec<(Twofold<R>, Twofold<R>)>;

/// Recurrence of orthonormal polynomials,
/// `root[k+1] p[k+1] = (x - alpha[k]) p[k] - root[k] p[k-1]`, with `p[0] = 1 / root[0]`, so that
/// `root[0]^2` is the total weight.
pub(super) struct Recurrence<R> {
    pub(super) alpha: Vec<Twofold<R>>,
    pub(super) root: Vec<Twofold<R>>,
}

/// The polynomials of a recurrence at one place.
struct Value<R> {
    /// The one after the last, up to a constant factor: its zeros are the nodes.
    end: Twofold<R>,
    /// Derivative of `end`.
    slope: Twofold<R>,
    /// The last and the last but one.
    last: [Twofold<R>; 2],
    /// Sum of the squares of all up to the last: the reciprocal of the weight at a node.
    squares: Twofold<R>,
}

impl<R: Real> Recurrence<R> {
    /// Legendre's polynomials on the interval from 0 to 1.
    pub(super) fn legendre(n: usize) -> Self {
        let root = |k: usize| match k {
            0 => Twofold::lit(1.0),
            _ => {
                let squares = Twofold::count(4 * (4 * k * k - 1));
                Twofold::count(k) / squares.sqrt()
            }
        };
        Self {
            alpha: vec![Twofold::lit(0.5); n],
            root: (0..n).map(root).collect(),
        }
    }

    /// The recurrence whose Gauss rule has a node at `end`, a boundary of the interval (Golub
    /// 1973): only the last `alpha` changes.
    fn with_node_at(mut self, end: Twofold<R>) -> Self {
        let [last, before] = self.evaluate(end).last;
        if let (Some(alpha), Some(&root)) = (self.alpha.last_mut(), self.root.last()) {
            *alpha = end - root * before / last;
        }
        self
    }

    fn evaluate(&self, x: Twofold<R>) -> Value<R> {
        let zero = Twofold::lit(0.0);
        let (mut before, mut slope_before) = (zero, zero);
        let (mut end, mut slope) = (Twofold::lit(1.0), zero);
        let (mut last, mut squares) = ([zero; 2], zero);
        for (k, (&alpha, &root)) in self.alpha.iter().zip(&self.root).enumerate() {
            let (p, dp) = (end / root, slope / root);
            last = [p, before];
            squares = squares + p * p;
            (end, slope) = ((x - alpha) * p, (x - alpha) * dp + p);
            if k > 0 {
                end = end - root * before;
                slope = slope - root * slope_before;
            }
            (before, slope_before) = (p, dp);
        }
        Value {
            end,
            slope,
            last,
            squares,
        }
    }

    /// Gauss rule with as many nodes as there are coefficients.
    pub(super) fn gauss(&self) -> Result<Nodes<R>> {
        let diagonal: Vec<R> = self.alpha.iter().map(|a| a.round()).collect();
        let off: Vec<R> = self.root.iter().map(|r| r.round()).collect();
        let mut nodes = Nodes::with_capacity(diagonal.len());
        for k in 0..diagonal.len() {
            let mut x = Twofold::new(eigenvalue(&diagonal, &off, k));
            // One step doubles the digits that the bracket has given; each further one
            // settles another order of derivatives.
            for _ in 0..4 {
                let value = self.evaluate(x);
                x = x - value.end / value.slope;
            }
            nodes.push((x, Twofold::lit(1.0) / self.evaluate(x).squares));
        }
        let ascending = nodes.windows(2).all(|w| w[0].0.round() < w[1].0.round());
        let sound = nodes
            .iter()
            .all(|(x, w)| x.round().finite() && w.round().finite());
        if ascending && sound {
            Ok(nodes)
        } else {
            Err(Error::Unsupported {
                what: format!(
                    "a Gauss rule of {} nodes that the number type cannot separate",
                    nodes.len()
                ),
                remedy: "scale the measure to length and mass of order one, or lower the degree",
            })
        }
    }
}

/// The `k`-th eigenvalue from below of the symmetric tridiagonal matrix, by bisection on the
/// number of negative pivots. `off[0]` is not part of the matrix.
fn eigenvalue<R: Real>(diagonal: &[R], off: &[R], k: usize) -> R {
    let n = diagonal.len();
    let radius = |i: usize| {
        let left = if i > 0 { off[i].abs() } else { R::zero() };
        let right = if i + 1 < n {
            off[i + 1].abs()
        } else {
            R::zero()
        };
        left + right
    };
    let (mut low, mut high) = (diagonal[0], diagonal[0]);
    for i in 0..n {
        low = low.smaller(diagonal[i] - radius(i));
        high = high.larger(diagonal[i] + radius(i));
    }
    let bound = low.abs().larger(high.abs());
    let tiny = bound * R::lit(R::EPSILON * R::EPSILON);
    let below = |x: R| {
        let mut count = R::zero();
        let mut pivot = R::one();
        for i in 0..n {
            let coupling = if i > 0 { off[i] * off[i] } else { R::zero() };
            pivot = diagonal[i] - x - coupling / pivot;
            pivot = pivot.where_else(tiny.at_most(pivot.abs()), -tiny);
            count += R::zero().where_else(R::zero().at_most(pivot), R::one());
        }
        count
    };
    let half = R::lit(0.5);
    let resolution = bound * R::lit(2.0 * R::EPSILON);
    loop {
        let gap = high - low;
        let open = resolution.at_most(gap) & !gap.at_most(resolution);
        if !open.any() {
            return half * (low + high);
        }
        let middle = half * (low + high);
        let above = R::lit(k as f64 + 1.0).at_most(below(middle));
        high = middle.where_else(above & open, high);
        low = middle.where_else(!above & open, low);
    }
}

/// Rules of every order, once they have been asked for. Pairs of doubles hold the digits of every number
/// type, and what depends on nothing need not be computed in lanes or with derivatives.
type Known = [OnceLock<Result<Nodes<f64>>>; MAX_ORDER + 1];

fn known<R: Real>(
    known: &Known,
    n: usize,
    nodes: fn(usize) -> Result<Nodes<f64>>,
) -> Result<Nodes<R>> {
    let nodes = known[admissible(n)?].get_or_init(|| nodes(n)).clone()?;
    let lifted = |(x, weight): (Twofold<f64>, _)| (Twofold::lifted(x), Twofold::lifted(weight));
    Ok(nodes.into_iter().map(lifted).collect())
}

/// Legendre nodes on the interval from 0 to 1, mirrored about its middle to the last bit.
pub(crate) fn legendre_nodes<R: Real>(n: usize) -> Result<Nodes<R>> {
    static KNOWN: Known = [const { OnceLock::new() }; MAX_ORDER + 1];
    known(&KNOWN, n, |n| {
        let mut nodes = Recurrence::legendre(n).gauss()?;
        for i in 0..n / 2 {
            let (x, weight) = nodes[i];
            nodes[n - 1 - i] = (Twofold::lit(1.0) - x, weight);
        }
        if n % 2 == 1 {
            nodes[n / 2].0 = Twofold::lit(0.5);
        }
        Ok(nodes)
    })
}

/// Radau nodes on the interval from 0 to 1 with the first one at 0 exactly.
pub(super) fn radau_nodes<R: Real>(n: usize) -> Result<Nodes<R>> {
    static KNOWN: Known = [const { OnceLock::new() }; MAX_ORDER + 1];
    known(&KNOWN, n, |n| {
        let zero = Twofold::lit(0.0);
        let mut nodes = Recurrence::legendre(n).with_node_at(zero).gauss()?;
        if let Some(first) = nodes.first_mut() {
            first.0 = zero;
        }
        Ok(nodes)
    })
}

/// The rule of `nodes`, rounded.
pub(super) fn rounded<R: Real>(nodes: &Nodes<R>, degree: usize) -> Result<Cubature<R, 1>> {
    let points = nodes.iter().map(|(x, _)| [x.round()]).collect();
    let weights = nodes.iter().map(|(_, w)| w.round()).collect();
    Cubature::new(points, weights, degree)
}

/// Gauss-Legendre rule on the interval from 0 to 1 with `n` nodes in ascending order, exact to
/// degree `2 n - 1` (Golub and Welsch 1969).
///
/// # Errors
/// [`Error::TooFew`] for `n = 0`, [`Error::Unsupported`] for `n` above
/// [`MAX_ORDER`](super::MAX_ORDER).
///
/// ```
/// let rule = ancf::quadrature::gauss_legendre::<f64>(2)?;
/// assert_eq!(rule.weights(), [0.5, 0.5]);
/// assert_eq!(rule.points()[1][0], 0.5 + 0.5 / 3.0_f64.sqrt());
/// # Ok::<(), ancf::Error>(())
/// ```
pub fn gauss_legendre<R: Real>(n: usize) -> Result<Cubature<R, 1>> {
    rounded(&legendre_nodes(n)?, (2 * n).saturating_sub(1))
}

/// Gauss-Legendre rule with `n` nodes on the interval from `start` to `end` (m or any unit),
/// exact to degree `2 n - 1`.
///
/// # Errors
/// Those of [`gauss_legendre`]; [`Error::NotFinite`] for an end that is not finite and
/// [`Error::NotPositive`] when `end` is not above `start`.
pub fn gauss_legendre_on<R: Real>(start: R, end: R, n: usize) -> Result<Cubature<R, 1>> {
    let start = Twofold::new(finite("start of the interval", start)?);
    let end = Twofold::new(finite("end of the interval", end)?);
    positive("length of the interval", (end - start).round())?;
    // From the middle outwards, so that an interval about zero gets a rule mirrored about zero.
    let half = Twofold::lit(0.5);
    let (middle, length) = ((start + end) * half, end - start);
    let place = |(x, w)| (middle + length * (x - half), length * w);
    let nodes = legendre_nodes(n)?.into_iter().map(place).collect();
    rounded(&nodes, (2 * n).saturating_sub(1))
}

/// Gauss-Radau rule on the interval from 0 to 1 with `n` nodes in ascending order, the first of
/// them at 0 exactly; exact to degree `2 n - 2` (Golub 1973).
///
/// # Errors
/// [`Error::TooFew`] for `n = 0`, [`Error::Unsupported`] for `n` above
/// [`MAX_ORDER`](super::MAX_ORDER).
///
/// ```
/// let rule = ancf::quadrature::gauss_radau::<f64>(2)?;
/// assert_eq!(rule.points(), [[0.0], [2.0 / 3.0]]);
/// assert_eq!(rule.weights(), [0.25, 0.75]);
/// # Ok::<(), ancf::Error>(())
/// ```
pub fn gauss_radau<R: Real>(n: usize) -> Result<Cubature<R, 1>> {
    rounded(&radau_nodes(n)?, (2 * n).saturating_sub(2))
}

/// Gauss rule of the measure whose monic orthogonal polynomials obey
/// `p[k+1] = (x - alpha[k]) p[k] - beta[k] p[k-1]`; `beta[0]` is the total weight, as in
/// Gautschi 2004. The `n` coefficients of either kind give `n` nodes, ascending, exact to degree
/// `2 n - 1` for that measure.
///
/// # Errors
/// [`Error::TooFew`] without coefficients, [`Error::Unsupported`] when there are not as many of
/// either kind, more than [`MAX_ORDER`](super::MAX_ORDER), or nodes too close for the number
/// type; [`Error::NotFinite`] for an `alpha` that is not finite and [`Error::NotPositive`] for a
/// `beta` that is not finite and above zero.
///
/// ```
/// use ancf::quadrature::gauss_from_recurrence;
/// // Hermite: weight exp(-x^2) on the whole line.
/// let mass = std::f64::consts::PI.sqrt();
/// let rule = gauss_from_recurrence(&[0.0; 3], &[mass, 0.5, 1.0])?;
/// assert!((rule.points()[2][0] - 1.5_f64.sqrt()).abs() < 1e-15);
/// # Ok::<(), ancf::Error>(())
/// ```
pub fn gauss_from_recurrence<R: Real>(alpha: &[R], beta: &[R]) -> Result<Cubature<R, 1>> {
    let n = admissible(alpha.len())?;
    if beta.len() != n {
        return Err(Error::Unsupported {
            what: format!(
                "a recurrence of {n} alpha and {} beta coefficients",
                beta.len()
            ),
            remedy: "give as many of either kind; the first beta is the total weight",
        });
    }
    let (mut diagonal, mut root) = (Vec::with_capacity(n), Vec::with_capacity(n));
    for (&a, &b) in alpha.iter().zip(beta) {
        diagonal.push(Twofold::new(finite("coefficient alpha", a)?));
        root.push(Twofold::new(positive("coefficient beta", b)?).sqrt());
    }
    let alpha = diagonal;
    rounded(&Recurrence { alpha, root }.gauss()?, 2 * n - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn high_orders_keep_their_nodes_apart_in_single_precision() {
        let rule = gauss_legendre::<f32>(MAX_ORDER).unwrap();
        assert!(rule.points().windows(2).all(|x| x[0] < x[1]));
        assert!(rule.weights().iter().all(|&w| w > 0.0));
    }

    #[test]
    fn the_radau_weight_at_the_end_is_one_over_the_square_of_the_order() {
        for n in 1..=20 {
            let rule = gauss_radau::<f64>(n).unwrap();
            assert_eq!(rule.points()[0], [0.0]);
            assert_eq!(rule.weights()[0], 1.0 / (n * n) as f64);
        }
    }

    #[test]
    fn mirrored_intervals_have_mirrored_rules() {
        let rule = gauss_legendre_on(-0.7, 0.7, 7).unwrap();
        for k in 0..7 {
            assert_eq!(rule.points()[k][0], -rule.points()[6 - k][0]);
            assert_eq!(rule.weights()[k], rule.weights()[6 - k]);
        }
    }
}
