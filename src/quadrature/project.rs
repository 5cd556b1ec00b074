//! Rules for planar scenes. A planar beam integrates over one cross coordinate, the section's
//! width being part of the measure; that measure is the projection of the section on the
//! coordinate, and its Gauss rule follows from any sufficiently exact rule of the section by the
//! discretised Stieltjes procedure (Gautschi 2004), whatever the shape.

use super::line::{Recurrence, rounded};
use super::twofold::Twofold;
use super::{Cubature, admissible};
use crate::error::{Error, Result};
use crate::scalar::Real;

/// Gauss rule of the projection of a plane region on its first coordinate: `n = degree/2 + 1`
/// nodes in ascending order, exact to degree `2 n - 1` for functions of that coordinate alone.
/// Units: nodes as the coordinates, weights as the weights of `rule`. For the unit disk this is
/// the Gauss-Chebyshev rule of the second kind. Derivatives carried by the points and weights
/// of `rule` pass to the result.
///
/// # Errors
/// [`Error::TooFew`] when `rule` is not exact to degree `2 n - 1`, which the result would need;
/// [`Error::Unsupported`] when its points or the signs of its weights do not admit `n` nodes, or
/// for `n` above [`MAX_ORDER`](super::MAX_ORDER).
///
/// ```
/// use ancf::quadrature::{disk_order, project};
/// let rule = project(&disk_order::<f64>(2)?, 3)?;
/// assert!((rule.points()[1][0] - 0.5).abs() < 1e-15);
/// assert!((rule.weights()[1] - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
/// # Ok::<(), ancf::Error>(())
/// ```
pub fn project<R: Real>(rule: &Cubature<R, 2>, degree: usize) -> Result<Cubature<R, 1>> {
    let n = admissible(degree / 2 + 1)?;
    let reached = 2 * n - 1;
    if rule.degree() < reached {
        return Err(Error::TooFew {
            what: "degree of the rule to project",
            value: rule.degree(),
            least: reached,
            remedy: "project a rule of higher degree",
        });
    }
    let zero = Twofold::lit(0.0);
    let weights: Vec<Twofold<R>> = rule.weights().iter().map(|&w| Twofold::new(w)).collect();
    let mut places: Vec<Twofold<R>> = rule
        .points()
        .iter()
        .map(|&[y, _]| Twofold::new(y))
        .collect();
    let sum = |terms: &dyn Fn(usize) -> Twofold<R>| {
        (0..weights.len()).fold(zero, |total, i| total + terms(i))
    };
    let mass = sum(&|i| weights[i]);
    if mass.round() <= R::zero() {
        return Err(unsupported(n));
    }
    // The recurrence is soundest for a measure about zero of half-length one.
    let centre = sum(&|i| weights[i] * places[i]) / mass;
    let farthest = |far: R, y: &Twofold<R>| far.larger((*y - centre).round().abs());
    let mut scale = places.iter().fold(R::zero(), farthest);
    if scale <= R::zero() {
        scale = R::one();
    }
    let scale = Twofold::new(scale);
    for y in &mut places {
        *y = (*y - centre) / scale;
    }

    let mut recurrence = Recurrence {
        alpha: Vec::with_capacity(n),
        root: Vec::with_capacity(n),
    };
    let mut before = vec![zero; weights.len()];
    let mut now = vec![Twofold::lit(1.0); weights.len()];
    for k in 0..n {
        let square = sum(&|i| weights[i] * now[i] * now[i]);
        // Squares of roots are near 1/4 for a measure of half-length one; rounding is all
        // that is left once the polynomial vanishes at every point. The square of that is far
        // below this bound, in double-doubles too, where twofold numbers carry no more digits.
        let unit = (R::EPSILON * R::EPSILON).max(f64::EPSILON * f64::EPSILON);
        if k > 0 && square.round() <= R::lit(64.0 * unit) {
            return Err(unsupported(n));
        }
        let root = square.sqrt();
        for p in &mut now {
            *p = *p / root;
        }
        let alpha = sum(&|i| weights[i] * places[i] * now[i] * now[i]);
        for i in 0..now.len() {
            let mut next = (places[i] - alpha) * now[i];
            if k > 0 {
                next = next - root * before[i];
            }
            before[i] = now[i];
            now[i] = next;
        }
        recurrence.alpha.push(alpha);
        recurrence.root.push(root);
    }
    let place = |(x, w)| (centre + scale * x, w);
    let nodes = recurrence.gauss()?.into_iter().map(place).collect();
    rounded(&nodes, reached)
}

fn unsupported(n: usize) -> Error {
    Error::Unsupported {
        what: format!("the projection of a rule that does not admit {n} nodes"),
        remedy: "project a rule with positive weights that has the degree it claims",
    }
}
