//! Sections given by nothing but their outline. Moments follow from Green's theorem, which turns
//! integrals over the material into integrals along its boundary; integration rules follow from
//! the moments by [moment fitting](Outline::rule). The outline is decided upon in double
//! precision and integrated in twice the working precision, with all derivatives that its points
//! carry.

mod edge;
mod path;
mod strips;

pub use path::Loop;

use super::{MAX_OUTLINE, Properties, Section};
use crate::error::{Error, Result, finite, positive};
use crate::quadrature::{
    Cubature, Shape, Twofold, Weighted, chebyshev, fit, legendre_nodes, pairs,
};
use crate::scalar::Real;
use edge::{Edge, Monotone};

/// A region bounded by an outer [`Loop`] less the regions within any number of holes.
///
/// ```
/// use ancf::section::{Loop, Outline, Section};
/// let square = Loop::polygon([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]);
/// let plate = Outline::new(square)?.with_hole(Loop::circle([0.0, 0.0], 0.5))?;
/// let area: f64 = plate.properties()?.area;
/// assert!((area - (4.0 - std::f64::consts::PI / 4.0)).abs() < 1e-14);
/// assert!(plate.contains([0.75, 0.0]) && !plate.contains([0.25, 0.0]));
/// let rule = plate.rule(4)?;
/// assert!(rule.len() <= 15 && rule.weights().iter().all(|&w| w > 0.0));
/// # Ok::<(), ancf::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Outline<R> {
    /// The outer loop counter-clockwise, then the holes clockwise.
    loops: Vec<Vec<Edge<R>>>,
}

impl<R: Real> Outline<R> {
    /// The region within a loop, whichever way round the loop is given.
    ///
    /// # Errors
    /// [`Error::NotFinite`] for a coordinate or bulge that is not finite, [`Error::TooFew`] for
    /// fewer than three straight edges (two edges if one is an arc), [`Error::NotPositive`] for
    /// an edge without length or a loop without area, [`Error::EdgesMeet`] for a loop that
    /// crosses or touches itself.
    pub fn new(outer: Loop<R>) -> Result<Self> {
        let outline = Self {
            loops: vec![outer.edges(true)?],
        };
        outline.check_crossings()?;
        Ok(outline)
    }

    /// The region without that within another loop.
    ///
    /// # Errors
    /// Those of [`new`](Self::new), also when the hole touches or crosses another loop;
    /// [`Error::HoleMisplaced`] when it lies outside the outer loop, within another hole or
    /// around one.
    pub fn with_hole(mut self, hole: Loop<R>) -> Result<Self> {
        let number = self.loops.len();
        self.loops.push(hole.edges(false)?);
        self.check_crossings()?;
        let curves: Vec<Vec<Monotone>> = self.loops.iter().map(|l| curves(l)).collect();
        let inside = |inner: usize, outer: usize| {
            strips::winding(&curves[outer], self.loops[inner][0].real().from) != 0
        };
        let fault = if !inside(number, 0) {
            "lies outside the outer loop"
        } else if (1..number).any(|other| inside(number, other)) {
            "lies within another hole"
        } else if (1..number).any(|other| inside(other, number)) {
            "lies around another hole"
        } else {
            return Ok(self);
        };
        Err(Error::HoleMisplaced {
            hole: number,
            fault,
        })
    }

    /// The same region moved by `shift` along y and z (m).
    ///
    /// # Errors
    /// [`Error::NotFinite`] for a shift that is not finite.
    pub fn moved(mut self, shift: [R; 2]) -> Result<Self> {
        for x in shift {
            finite("shift of the outline [m]", x)?;
        }
        for edge in self.loops.iter_mut().flatten() {
            for end in [&mut edge.from, &mut edge.to] {
                *end = [0, 1].map(|c| end[c] + shift[c]);
            }
        }
        Ok(self)
    }

    /// The same region moved so that its centroid is the origin, where the axis of the beam is.
    ///
    /// # Errors
    /// Those of [`properties`](Section::properties).
    pub fn centred(self) -> Result<Self> {
        let [y, z] = self.properties()?.centroid;
        self.moved([-y, -z])
    }

    /// The integral of `y^a z^b` over the material (m^(2 + a + b)), by Green's theorem: exact
    /// but for rounding.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for exponents too high for a Gauss rule of
    /// [`MAX_ORDER`](crate::quadrature::MAX_ORDER), [`Error::NotFinite`] when the result is beyond the number type.
    pub fn moment(&self, a: usize, b: usize) -> Result<R> {
        let about = [Twofold::lit(0.0); 2];
        finite(
            "moment of the outline",
            self.moment_about(about, a, b)?.round(),
        )
    }

    /// Whether a point `(y, z)` (m) lies in the material or, to rounding, on its boundary.
    pub fn contains(&self, point: [R; 2]) -> bool {
        let (curves, point) = (self.curves(), point.map(Real::value));
        strips::winding(&curves, point) != 0
            || curves.iter().any(|c| c.edge.gap(point) <= self.tolerance())
    }

    fn edges(&self) -> impl Iterator<Item = &Edge<R>> {
        self.loops.iter().flatten()
    }

    fn curves(&self) -> Vec<Monotone> {
        self.loops.iter().flat_map(|l| curves(l)).collect()
    }

    /// Middle and half sides of the box around the outline, with the derivatives of the points
    /// that define it.
    fn frame(&self) -> [[R; 2]; 2] {
        let far = |edge: &Edge<R>| {
            // The ends, and the farthest points of arcs as constants of the parameter.
            let turns = [0, 1].map(|c| edge.real().turn(c).map(R::lit));
            let tops: Vec<_> = turns.into_iter().flatten().map(|s| edge.at(s)).collect();
            [edge.from, edge.to].into_iter().chain(tops)
        };
        let first = self.loops[0][0].from;
        let (mut low, mut high) = (first, first);
        for point in self.loops[0].iter().flat_map(far) {
            for c in 0..2 {
                low[c] = low[c].smaller(point[c]);
                high[c] = high[c].larger(point[c]);
            }
        }
        let half = R::lit(0.5);
        let middle = [0, 1].map(|c| (low[c] + high[c]) * half);
        [middle, [0, 1].map(|c| (high[c] - low[c]) * half)]
    }

    /// Length that rounding of the coordinates, or of decisions in double precision, cannot tell
    /// from zero (m).
    fn tolerance(&self) -> f64 {
        let ends = self.edges().flat_map(|e| e.from.map(Real::value));
        16.0 * R::EPSILON.max(f64::EPSILON) * ends.fold(0.0, |m: f64, x| m.max(x.abs()))
    }

    fn check_crossings(&self) -> Result<()> {
        let tolerance = self.tolerance();
        let all: Vec<(usize, usize, Edge<f64>)> = (self.loops.iter().enumerate())
            .flat_map(|(l, edges)| edges.iter().enumerate().map(move |(e, x)| (l, e, x.real())))
            .collect();
        for (i, (la, ea, a)) in all.iter().enumerate() {
            let n = self.loops[*la].len();
            for (lb, eb, b) in &all[i + 1..] {
                let neighbours = la == lb && (ea + 1 == *eb || (*ea == 0 && eb + 1 == n));
                let Some(place) = a.meets(b, neighbours, tolerance) else {
                    continue;
                };
                let (mut first, mut second) = ((*la, a.number), (*lb, b.number));
                if first > second {
                    (first, second) = (second, first);
                }
                return Err(Error::EdgesMeet {
                    loops: [first.0, second.0],
                    edges: [first.1, second.1],
                    place,
                });
            }
        }
        Ok(())
    }

    /// Gauss points of the boundary with increments of z: the integral of `f` over the material
    /// is the sum of `F dz` with `dF/dy = f`, for polynomials `f` to `degree`.
    fn boundary(&self, degree: usize) -> Result<Weighted<R>> {
        // Arcs are rational in the parameter, with poles no closer than 2.4 half intervals: each
        // node gains 4 binary digits, and each degree may cost one node.
        let digits = (-R::EPSILON.log2() / 4.0) as usize;
        //
        // Straight edges would do with two nodes less, but not for the first and second
        // derivatives of one that is about to bend.
        let straight = legendre_nodes((degree / 2).saturating_add(3))?;
        let curved = if self.edges().all(Edge::straight) {
            Vec::new()
        } else {
            legendre_nodes(degree.saturating_add(digits + 4))?
        };
        let nodes = |edge: &Edge<R>| if edge.straight() { &straight } else { &curved };
        let increments = |edge: &Edge<R>| edge.increments(nodes(edge)).collect::<Vec<_>>();
        Ok(self.edges().flat_map(increments).collect())
    }

    fn moment_about(&self, about: [Twofold<R>; 2], a: usize, b: usize) -> Result<Twofold<R>> {
        let (one, zero) = (Twofold::lit(1.0), Twofold::lit(0.0));
        let power = |x: Twofold<R>, n: usize| (0..n).fold(one, |p, _| p * x);
        let boundary = self.boundary(a.saturating_add(b))?;
        let sum = boundary.into_iter().fold(zero, |sum, ([y, z], dz)| {
            sum + power(y - about[0], a + 1) * power(z - about[1], b) * dz
        });
        Ok(sum / Twofold::count(a + 1))
    }
}

fn curves<R: Real>(edges: &[Edge<R>]) -> Vec<Monotone> {
    edges.iter().flat_map(|e| e.real().monotone()).collect()
}

/// Highest degree of the rules of an [`Outline`].
const MAX_DEGREE: usize = 20;

impl<R: Real> Section<R> for Outline<R> {
    /// A rule with at most as many points as there are moments, `(degree + 1)(degree + 2)/2`,
    /// all weights positive and all points in the material; to degree 8 mostly with half of
    /// that, down to a third for compact shapes and up to all for the thinnest walls. It is found by
    /// moment fitting: of a dense positive rule at most as many points as moments are kept, chosen
    /// once by a linear program that draws them together as in a Gauss rule (Ryu and Boyd 2015; to
    /// degree 8, for sections of few edges) and once by Caratheodory's theorem; then points are
    /// taken away one by one while the others, moved by Gauss and Newton's method, can still carry
    /// the moments (Xiao and Gimbutas 2010). The better of the two rules is taken.
    ///
    /// Points and weights follow a change of the outline by the least change, in the mean
    /// square and relative to the box around the outline, that keeps all moments exact: so
    /// derivatives of integrals of polynomials are exact, and in a uniform scaling points and
    /// weights just scale.
    ///
    /// # Errors
    /// [`Error::NoRule`] when none is found: for a degree above 20, or walls so thin that the
    /// moments of the degree do not tell the section from its middle lines (a thousandth of the
    /// height is no obstacle to degree 8, a fiftieth to degree 12).
    fn rule(&self, degree: usize) -> Result<Cubature<R, 2>> {
        if degree > MAX_DEGREE {
            return Err(Error::NoRule {
                degree,
                cause: "degrees above 20 are not tried",
                remedy: "lower the degree or give the section as a type with its own rule",
            });
        }
        let [middle, half] = self.frame();
        let [origin, side] = [middle, half].map(|v| v.map(Twofold::new));
        // Moments of products of Chebyshev's polynomials over the box, in units of the box.
        let zero = Twofold::lit(0.0);
        let mut moments = vec![zero; pairs(degree).count()];
        for (point, dz) in self.boundary(degree)? {
            let [u, v] = [0, 1].map(|c| (point[c] - origin[c]) / side[c]);
            let one = Twofold::lit(1.0);
            let (u, v) = (
                chebyshev(one, u, u, degree + 1),
                chebyshev(one, v, v, degree),
            );
            let dv = dz / side[1];
            // Indefinite integrals of the polynomials.
            let integral = |a: usize| match a {
                0 => u[1],
                1 => u[2] / Twofold::count(4),
                _ => {
                    (u[a + 1] / Twofold::count(a + 1) - u[a - 1] / Twofold::count(a - 1))
                        / Twofold::count(2)
                }
            };
            let integrals: Vec<_> = (0..=degree).map(|a| integral(a) * dv).collect();
            for (moment, (a, b)) in moments.iter_mut().zip(pairs(degree)) {
                *moment = *moment + integrals[a] * v[b];
            }
        }
        let (c, h) = (middle.map(Real::value), half.map(Real::value));
        let edges: Vec<Edge<f64>> = self.edges().map(Edge::real).collect();
        let candidates = strips::sample(&edges, degree)?
            .into_iter()
            .map(|(p, w)| ([0, 1].map(|k| (p[k] - c[k]) / h[k]), w / (h[0] * h[1])))
            .collect();
        let curves = self.curves();
        let margin = 4.0 * self.tolerance();
        let inside = |p: [f64; 2]| {
            let point = [0, 1].map(|k| c[k] + h[k] * p[k]);
            strips::winding(&curves, point) != 0 && edges.iter().all(|e| e.gap(point) > margin)
        };
        let shape = Shape {
            degree,
            candidates,
            moments,
            inside,
        };
        let area = side[0] * side[1];
        let (mut points, mut weights) = (Vec::new(), Vec::new());
        for (x, w) in fit(shape)? {
            points.push([0, 1].map(|c| (origin[c] + side[c] * x[c]).round()));
            weights.push((w * area).round());
        }
        Cubature::new(points, weights, degree)
    }

    /// The ends of all edges and, of the points that are left, a share for each edge that is
    /// proportional to its length.
    fn outline(&self, n: usize) -> Vec<Vec<[R; 2]>> {
        let drawn = |edges: &Vec<Edge<R>>| {
            let spare = n.min(MAX_OUTLINE).saturating_sub(edges.len()) as f64;
            let whole: f64 = edges.iter().map(|e| e.real().length()).sum();
            let mut points = Vec::new();
            let (mut passed, mut given) = (0.0, 0);
            for edge in edges {
                passed += edge.real().length();
                let share = (spare * passed / whole).round() as usize - given;
                given += share;
                points.push(edge.from);
                for k in 1..=share {
                    let part = R::lit(2.0 * k as f64) / R::lit((share + 1) as f64);
                    points.push(edge.at(part - R::one()));
                }
            }
            points
        };
        self.loops.iter().map(drawn).collect()
    }

    /// By Green's theorem.
    fn properties(&self) -> Result<Properties<R>> {
        // About a point of the section first, lest a distant origin cost digits.
        let [y, z] = self.frame()[0].map(Twofold::new);
        let moment = |about, a, b| self.moment_about(about, a, b);
        let area = moment([y, z], 0, 0)?;
        positive("area of the section [m^2]", area.round())?;
        let cy = y + moment([y, z], 1, 0)? / area;
        let cz = z + moment([y, z], 0, 1)? / area;
        let second = |a, b| {
            let moment = moment([cy, cz], a, b)?.round();
            finite("second moment of the section [m^4]", moment)
        };
        Ok(Properties {
            area: area.round(),
            centroid: [cy.round(), cz.round()],
            iyy: second(0, 2)?,
            izz: second(2, 0)?,
            iyz: second(1, 1)?,
        })
    }
}
