//! Closed loops as the user writes them down.

use super::edge::{Edge, distance};
use crate::error::{Error, Result, finite, positive};
use crate::quadrature::legendre_nodes;
use crate::scalar::Real;

/// A closed loop of straight edges and circular arcs in the plane of `(y, z)` (m), in either
/// direction. The last point is joined to the first by a straight edge unless it is the first.
/// What is wrong with a loop is said when it becomes part of an [`Outline`](super::Outline).
///
/// ```
/// use ancf::section::{Loop, Outline};
/// // A square of side 2 with its right side bowed out to a half circle.
/// let stadium = Loop::start([-1.0, -1.0])
///     .line_to([1.0, -1.0])
///     .arc_to([1.0, 1.0], 1.0)
///     .line_to([-1.0, 1.0]);
/// let area: f64 = Outline::new(stadium)?.moment(0, 0)?;
/// assert!((area - (4.0 + std::f64::consts::PI / 2.0)).abs() < 1e-14);
/// # Ok::<(), ancf::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Loop<R> {
    points: Vec<[R; 2]>,
    /// Bulge of the edge that leaves each point.
    bulges: Vec<R>,
    /// Radius of a circle, which its points do not tell the sign of.
    radius: Option<R>,
}

impl<R: Real> Loop<R> {
    /// A loop that starts at a point `(y, z)` (m).
    pub fn start(point: [R; 2]) -> Self {
        Self {
            points: vec![point],
            bulges: vec![R::zero()],
            radius: None,
        }
    }

    /// A straight edge to `point` (m).
    pub fn line_to(self, point: [R; 2]) -> Self {
        self.arc_to(point, R::zero())
    }

    /// A circular arc to `point` (m). The `bulge` is the tangent of a quarter of the angle that
    /// the arc turns by: 1 for a half circle, `tan(pi/8)` for a quarter, positive
    /// counter-clockwise; it is also the height of the arc over half its chord.
    pub fn arc_to(mut self, point: [R; 2], bulge: R) -> Self {
        if let Some(last) = self.bulges.last_mut() {
            *last = bulge;
        }
        self.points.push(point);
        self.bulges.push(R::zero());
        self
    }

    /// The loop of straight edges through `points` (m).
    pub fn polygon(points: impl IntoIterator<Item = [R; 2]>) -> Self {
        let points: Vec<_> = points.into_iter().collect();
        let bulges = vec![R::zero(); points.len()];
        Self {
            points,
            bulges,
            radius: None,
        }
    }

    /// The circle of this centre and radius (m).
    pub fn circle(centre: [R; 2], radius: R) -> Self {
        let at = |y: R| [centre[0] + y, centre[1]];
        let circle = Self::start(at(radius))
            .arc_to(at(-radius), R::one())
            .arc_to(at(radius), R::one());
        Self {
            radius: Some(radius),
            ..circle
        }
    }

    /// The edges, arcs divided to quarter circles at most, counter-clockwise or not.
    pub(super) fn edges(mut self, counter_clockwise: bool) -> Result<Vec<Edge<R>>> {
        for &x in self.points.iter().flatten() {
            finite("coordinate of a point of the outline [m]", x)?;
        }
        for &bulge in &self.bulges {
            finite("bulge of an arc of the outline", bulge)?;
        }
        if let Some(radius) = self.radius {
            positive("radius of a circle of the outline [m]", radius)?;
        }
        if self.points.len() > 1 && self.points.first() == self.points.last() {
            self.points.pop();
            self.bulges.pop();
        }
        let least = if self.bulges.iter().all(R::is_zero) {
            3
        } else {
            2
        };
        let n = self.points.len();
        if n < least {
            return Err(Error::TooFew {
                what: "number of edges of a loop of the outline",
                value: n,
                least,
                remedy: "give three corners, or two points when an arc joins them",
            });
        }
        // Decisions are made in double precision.
        let unit = R::EPSILON.max(f64::EPSILON);
        let mut edges = Vec::with_capacity(n);
        for number in 0..n {
            let edge = Edge {
                from: self.points[number],
                to: self.points[(number + 1) % n],
                bulge: self.bulges[number],
                number,
            };
            let real = edge.real();
            let size = real
                .from
                .iter()
                .chain(&real.to)
                .fold(0.0, |m: f64, x| m.max(x.abs()));
            let length = distance(real.from, real.to);
            if length <= 4.0 * unit * size {
                let what = "distance of two successive points of the outline [m]";
                positive(what, R::lit(0.0))?;
            }
            edges.extend(edge.pieces());
        }
        for &x in edges.iter().flat_map(|e| &e.to) {
            finite("coordinate of an arc of the outline [m]", x)?;
        }
        let origin = edges[0].real().from[0];
        let nodes = legendre_nodes(17)?;
        let (mut area, mut size) = (0.0, 0.0);
        for edge in edges.iter().map(Edge::real) {
            for ([y, _], dz) in edge.increments(&nodes) {
                area += (y.round() - origin) * dz.round();
            }
            size += distance(edge.from, edge.to).powi(2);
        }
        if area.abs() <= 64.0 * unit * size {
            let what = "area enclosed by a loop of the outline [m^2]";
            positive(what, R::lit(0.0))?;
        }
        if (area > 0.0) != counter_clockwise {
            edges.reverse();
            for edge in &mut edges {
                *edge = edge.reversed();
            }
        }
        Ok(edges)
    }
}
