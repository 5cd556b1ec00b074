//! Rules for the disk and the annulus: equally spaced angles times a Gauss rule in the squared
//! radius, in which the area element is uniform. For the disk these are the circular rules that
//! the cross-sections of Orzechowski 2012 are integrated with, for every order.

use std::sync::OnceLock;

use super::line::{legendre_nodes, radau_nodes};
use super::twofold::Twofold;
use super::{Cubature, MAX_ORDER, admissible};
use crate::error::{Error, Result, finite, positive};
use crate::scalar::Real;

/// Cosine and sine of `part / whole` of a full turn, reduced to half a right angle so that
/// points mirrored in the axes or diagonals are mirrored to the last bit.
fn direction(part: usize, whole: usize) -> [Twofold<f64>; 2] {
    let quarters = 4 * (part % whole);
    let (quadrant, mut rest) = (quarters / whole, quarters % whole);
    let reflected = 2 * rest > whole;
    if reflected {
        rest = whole - rest;
    }
    let right_angle = Twofold::pi() * Twofold::lit(0.5);
    let (mut cos, mut sin) = (right_angle * Twofold::count(rest) / Twofold::count(whole)).cos_sin();
    if reflected {
        (cos, sin) = (sin, cos);
    }
    match quadrant {
        0 => [cos, sin],
        1 => [-sin, cos],
        2 => [-cos, -sin],
        _ => [sin, -cos],
    }
}

/// `n` equally spaced points of the circle of the given radius, counter-clockwise from the first
/// axis.
pub(crate) fn circle<R: Real>(radius: R, n: usize) -> Vec<[R; 2]> {
    let radius = Twofold::new(radius);
    (0..n)
        .map(|k| direction(k, n).map(|x| (radius * Twofold::lifted(x)).round()))
        .collect()
}

/// Rule of the unit disk of order `s`, exact to degree `2 s - 1`: the rule of Orzechowski 2012,
/// eq. (19) and (20), which for `s` = 1 to 4 is its Table 1, points and orientation included.
/// On `s` equally spaced diameters lie Gauss nodes in `u = r^2`: Legendre's for even `s`,
/// Radau's with the centre for odd `s`. That makes `s^2` points for even and `s^2 - s + 1` for
/// odd `s`, the centre being counted once with its whole weight. All weights are positive and
/// all points inside.
///
/// Orders 1 and 2 are not isotropic in the fourth moments that a section-linear element needs;
/// order 3 is the lowest that integrates its strain energy exactly.
///
/// # Errors
/// [`Error::TooFew`] for `s = 0`, [`Error::Unsupported`] for `s` above
/// [`MAX_ORDER`](super::MAX_ORDER).
///
/// ```
/// let rule = ancf::quadrature::disk_order::<f64>(2)?;
/// assert_eq!(rule.points()[0], [0.5, 0.5]);
/// assert_eq!(rule.weights(), [std::f64::consts::FRAC_PI_4; 4]);
/// # Ok::<(), ancf::Error>(())
/// ```
pub fn disk_order<R: Real>(s: usize) -> Result<Cubature<R, 2>> {
    disk_of_radius(R::one(), s)
}

/// The rule of [`disk_order`] for a disk of the given `radius` (m), Orzechowski 2012, eq. (21):
/// points (m), weights (m^2). It is rounded once, so it is slightly better than the scaled rule
/// of the unit disk.
///
/// # Errors
/// Those of [`disk_order`]; [`Error::NotPositive`] for a radius that is not finite and above
/// zero, [`Error::NotFinite`] when its square is beyond the number type.
pub fn disk_of_radius<R: Real>(radius: R, s: usize) -> Result<Cubature<R, 2>> {
    let radius = Twofold::new(positive("radius of the disk [m]", radius)?);
    let odd = admissible(s)? % 2 == 1;
    let nodes = if odd {
        radau_nodes(s.div_ceil(2))?
    } else {
        legendre_nodes(s / 2)?
    };
    let area = radius * radius;
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    let mut rings = Vec::with_capacity(nodes.len());
    for (k, (square, weight)) in nodes.into_iter().enumerate() {
        if odd && k == 0 {
            points.push([R::zero(); 2]);
            weights.push((Twofold::pi() * area * weight).round());
        } else {
            rings.push((radius * square.sqrt(), area * weight));
        }
    }
    let phase = usize::from(!odd);
    spread(&rings, 2 * s, phase, &mut points, &mut weights);
    Cubature::new(points, weights, 2 * s - 1)
}

/// Rule of the annulus between the circles of radius `inner` and `outer` (m), exact to `degree`:
/// Gauss-Legendre in `u = r^2` from `inner^2` to `outer^2` times `degree + 1` equally spaced
/// angles (Peirce 1957). All weights are positive and all points inside the material; thin walls
/// cost no digits.
///
/// # Errors
/// [`Error::NotPositive`], [`Error::NotFinite`] or [`Error::OutOfRange`] unless
/// 0 < `inner` < `outer` and both are finite, [`Error::Unsupported`] for a degree beyond twice
/// [`MAX_ORDER`](super::MAX_ORDER).
///
/// ```
/// let rule = ancf::quadrature::annulus(1.0, 0.5, 2)?;
/// let area: f64 = rule.weights().iter().sum();
/// assert!((area - 0.75 * std::f64::consts::PI).abs() < 1e-15);
/// # Ok::<(), ancf::Error>(())
/// ```
pub fn annulus<R: Real>(outer: R, inner: R, degree: usize) -> Result<Cubature<R, 2>> {
    let [outer, inner] = wall(outer, inner)?.map(Twofold::new);
    let order = admissible(degree / 2 + 1)?;
    // Differences of squares as products: nothing cancels in a thin wall.
    let area = (outer - inner) * (outer + inner);
    let place = |(t, w)| ((inner * inner + area * t).sqrt(), area * w);
    let nodes = legendre_nodes(order.div_ceil(2))?;
    let rings: Vec<_> = nodes.into_iter().map(place).collect();
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    spread(&rings, degree + 1, 0, &mut points, &mut weights);
    Cubature::new(points, weights, degree)
}

/// `[outer, inner]` if they are the radii (m) of an annulus, a typed error that names the
/// offending one otherwise.
pub(crate) fn wall<R: Real>(outer: R, inner: R) -> Result<[R; 2]> {
    let outer = positive("outer radius of the annulus [m]", outer)?;
    let what = "inner radius of the annulus [m]";
    let inner = finite(what, inner)?;
    let remedy = if inner == R::zero() {
        "use Disk (its rule is disk_order) for a solid section"
    } else if inner >= outer {
        "give the outer radius first and leave a wall between the two"
    } else {
        return Ok([outer, positive(what, inner)?]);
    };
    Err(Error::OutOfRange {
        what,
        value: inner.value(),
        range: "(0, outer radius)",
        remedy,
    })
}

/// Appends, for every ring given by its radius and its area over pi, `rays` equally spaced
/// points, the first at `phase` half steps from the first axis.
fn spread<R: Real>(
    rings: &[(Twofold<R>, Twofold<R>)],
    rays: usize,
    phase: usize,
    points: &mut Vec<[R; 2]>,
    weights: &mut Vec<R>,
) {
    // As nodes of every order: what depends on nothing is computed once, in pairs of doubles. Rules of the
    // highest order have twice as many rays, and each number of rays two phases.
    const ALL: usize = 2 * (2 * MAX_ORDER + 1);
    static KNOWN: [OnceLock<Vec<[Twofold<f64>; 2]>>; ALL] = [const { OnceLock::new() }; ALL];
    let directions = KNOWN[2 * rays + phase].get_or_init(|| {
        let all = (0..rays).map(|k| direction(2 * k + phase, 2 * rays));
        all.collect()
    });
    let share = Twofold::pi() / Twofold::count(rays);
    for &(radius, area) in rings {
        for unit in directions {
            points.push(unit.map(|x| (radius * Twofold::lifted(x)).round()));
            weights.push((share * area).round());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_those_of_the_library_functions() {
        for whole in 1..=48 {
            for part in 0..2 * whole {
                let angle = 2.0 * std::f64::consts::PI * part as f64 / whole as f64;
                let [cos, sin] = direction(part, whole).map(|x| x.round());
                assert!((cos - angle.cos()).abs() < 4e-15, "{part}/{whole}");
                assert!((sin - angle.sin()).abs() < 4e-15, "{part}/{whole}");
            }
        }
    }

    #[test]
    fn multiples_of_thirty_and_forty_five_degrees_are_exact() {
        let [cos, sin] = direction(1, 12).map(|x| x.round());
        assert_eq!([cos, sin], [0.75_f64.sqrt(), 0.5]);
        let [cos, sin] = direction(3, 8).map(|x| Twofold::<f32>::lifted(x).round());
        assert_eq!([cos, sin], [-0.5_f32.sqrt(), 0.5_f32.sqrt()]);
        assert_eq!(direction(3, 4).map(|x| x.round()), [0.0, -1.0]);
    }

    #[test]
    fn rules_have_the_number_of_points_of_the_paper() {
        for s in (1..=12).chain([MAX_ORDER - 1, MAX_ORDER]) {
            let points = if s % 2 == 0 { s * s } else { s * s - s + 1 };
            assert_eq!(disk_order::<f64>(s).unwrap().len(), points);
        }
    }
}
