//! One edge of an outline, straight or circular, in one rational form that holds for both: with
//! the half chord as unit of length, `x = s (1 + b^2) / (1 + s^2 b^2)` along the chord and
//! `y = b (1 - s^2) / (1 + s^2 b^2)` to its right, for `s` from -1 to 1. The bulge `b` is the
//! tangent of a quarter of the swept angle and zero for a straight edge, where nothing is
//! singular, so that derivatives with respect to it are right there too.

use crate::quadrature::{Nodes, Twofold};
use crate::scalar::Real;

/// Bulge of a quarter circle, tan(pi/8), and a little: longer arcs are divided.
const QUARTER: f64 = 0.414_213_562_373_095_1 + 1e-9;

/// A boundary curve from one point to another (m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Edge<R> {
    pub(super) from: [R; 2],
    pub(super) to: [R; 2],
    pub(super) bulge: R,
    /// Which edge of the loop as the user gave it, for messages.
    pub(super) number: usize,
}

impl<R: Real> Edge<R> {
    /// The edge in pieces of a quarter circle at most.
    pub(super) fn pieces(self) -> Vec<Self> {
        if self.bulge.abs() <= R::lit(QUARTER) {
            return vec![self];
        }
        let (half, b) = (R::lit(0.5), self.bulge);
        let chord: [R; 2] = std::array::from_fn(|c| (self.to[c] - self.from[c]) * half);
        let normal = [chord[1], -chord[0]];
        let top = std::array::from_fn(|c| (self.from[c] + self.to[c]) * half + normal[c] * b);
        // tan(a/2) from tan(a).
        let bulge = b / (R::one() + (R::one() + b * b).sqrt());
        let (mut first, mut second) = (self, self);
        (first.to, first.bulge) = (top, bulge);
        (second.from, second.bulge) = (top, bulge);
        let mut pieces = first.pieces();
        pieces.extend(second.pieces());
        pieces
    }

    /// The same curve the other way round.
    pub(super) fn reversed(self) -> Self {
        Self {
            from: self.to,
            to: self.from,
            bulge: -self.bulge,
            ..self
        }
    }

    pub(super) fn straight(&self) -> bool {
        self.bulge == R::zero()
    }

    /// The point at `s` from -1 to 1.
    pub(super) fn at(&self, s: R) -> [R; 2] {
        let (half, b) = (R::lit(0.5), self.bulge);
        let chord: [R; 2] = std::array::from_fn(|c| (self.to[c] - self.from[c]) * half);
        let normal = [chord[1], -chord[0]];
        let below = R::one() + s * s * b * b;
        let (x, y) = (
            s * (R::one() + b * b) / below,
            b * (R::one() - s * s) / below,
        );
        std::array::from_fn(|c| (self.from[c] + self.to[c]) * half + chord[c] * x + normal[c] * y)
    }

    /// Points of the edge with the increments of `z` that integrate over it, from the Gauss
    /// nodes of the interval from 0 to 1.
    pub(super) fn increments(
        &self,
        nodes: &Nodes<R>,
    ) -> impl Iterator<Item = ([Twofold<R>; 2], Twofold<R>)> {
        let (one, half) = (Twofold::lit(1.0), Twofold::lit(0.5));
        let [from, to] = [self.from, self.to].map(|p| p.map(Twofold::new));
        let b = Twofold::new(self.bulge);
        let mid = [0, 1].map(|c| (from[c] + to[c]) * half);
        let chord = [0, 1].map(|c| (to[c] - from[c]) * half);
        let normal = [chord[1], -chord[0]];
        nodes.iter().map(move |&(t, w)| {
            let s = t + t - one;
            let below = one + s * s * b * b;
            let stretch = (one + b * b) / below;
            let (x, y) = (s * stretch, b * (one - s * s) / below);
            let point = [0, 1].map(|c| mid[c] + chord[c] * x + normal[c] * y);
            // Derivatives with respect to s; t runs half as far.
            let dx = stretch * (one - s * s * b * b) / below;
            let dy = -(stretch * (s + s) * b / below);
            (point, (chord[1] * dx + normal[1] * dy) * (w + w))
        })
    }

    /// The edge in double precision, where all decisions are made.
    pub(super) fn real(&self) -> Edge<f64> {
        Edge {
            from: self.from.map(Real::value),
            to: self.to.map(Real::value),
            bulge: self.bulge.value(),
            number: self.number,
        }
    }
}

/// Distance of two points.
pub(super) fn distance(p: [f64; 2], q: [f64; 2]) -> f64 {
    (p[0] - q[0]).hypot(p[1] - q[1])
}

impl Edge<f64> {
    fn half(&self) -> f64 {
        0.5 * distance(self.from, self.to)
    }

    fn middle(&self) -> [f64; 2] {
        [0, 1].map(|c| 0.5 * (self.from[c] + self.to[c]))
    }

    /// Coordinates along and right of the chord, in half chords from its middle.
    fn local(&self, p: [f64; 2]) -> [f64; 2] {
        let m = self.middle();
        let chord = [0, 1].map(|c| 0.5 * (self.to[c] - self.from[c]));
        let [u, v] = [0, 1].map(|c| (p[c] - m[c]) / self.half());
        let [e, f] = chord.map(|c| c / self.half());
        [u * e + v * f, u * f - v * e]
    }

    /// Zero on the circle or line of the edge.
    fn implicit(&self, [x, y]: [f64; 2]) -> f64 {
        let b = self.bulge;
        b * (x * x + y * y - 1.0) + y * (1.0 - b * b)
    }

    /// The parameter of the point of the edge closest to `p`, exactly for points on the edge.
    fn parameter(&self, p: [f64; 2]) -> f64 {
        let [x, y] = self.local(p);
        let below = 1.0 + self.bulge * y;
        // Not below 1 on the edge, and zero opposite to it on its circle.
        if below > 0.5 {
            x / below
        } else {
            f64::INFINITY
        }
    }

    /// Arc length.
    pub(super) fn length(&self) -> f64 {
        let b = self.bulge;
        let ratio = if b == 0.0 { 1.0 } else { b.atan() / b };
        2.0 * self.half() * (1.0 + b * b) * ratio
    }

    /// Distance of a point from the edge, to first order for points close to it.
    pub(super) fn gap(&self, p: [f64; 2]) -> f64 {
        let ends = distance(p, self.from).min(distance(p, self.to));
        if self.parameter(p).abs() > 1.0 {
            return ends;
        }
        let ([x, y], b) = (self.local(p), self.bulge);
        let slope = (2.0 * b * x).hypot(2.0 * b * y + 1.0 - b * b);
        let across = self.half() * self.implicit([x, y]).abs() / slope;
        across.min(ends)
    }

    /// A point that the two edges have in common, other than a common end when they are
    /// `neighbours`; distances below `tolerance` count as none.
    pub(super) fn meets(&self, other: &Self, neighbours: bool, tolerance: f64) -> Option<[f64; 2]> {
        // No point of an arc below a half circle is farther from the chord's middle than its end.
        let reach = self.half() + other.half() + tolerance;
        if distance(self.middle(), other.middle()) > reach {
            return None;
        }
        let ends = |a: &Self, b: &Self| {
            let near = |p: &[f64; 2]| b.gap(*p) <= tolerance;
            [a.from, a.to].into_iter().find(near)
        };
        if !neighbours && let Some(p) = ends(self, other).or_else(|| ends(other, self)) {
            return Some(p);
        }
        // Along the other edge the implicit function is a quadratic over 1 + s^2 b^2.
        let along = |s: f64| {
            let b = other.bulge;
            self.implicit(self.local(other.at(s))) * (1.0 + s * s * b * b)
        };
        let [left, c0, right] = [-1.0, 0.0, 1.0].map(along);
        let (c1, c2) = (0.5 * (right - left), 0.5 * (right + left) - c0);
        let small = tolerance / self.half();
        if [c0, c1, c2].iter().all(|c| c.abs() <= 4.0 * small) {
            // The same line or circle: they overlap where one has an end or its middle within
            // the other.
            let within = |a: &Self, b: &Self| {
                let inner = |p: &[f64; 2]| b.parameter(*p).abs() < 1.0 - 1e-9;
                [a.from, a.at(0.0), a.to].into_iter().find(inner)
            };
            return within(self, other).or_else(|| within(other, self));
        }
        let mut places = roots(c2, c1, c0).to_vec();
        // Curves that touch without crossing.
        let vertex = -0.5 * c1 / c2;
        if c2 != 0.0 && along(vertex).abs() <= small {
            places.push(vertex);
        }
        // Neighbours that pass smoothly into one another have a double root at the common end,
        // which rounding moves by the root of its unit.
        let clear = 1e-4 * self.half().min(other.half());
        let apart = |p: [f64; 2]| {
            let common = [self.from, self.to]
                .into_iter()
                .filter(|&p| p == other.from || p == other.to);
            !neighbours || common.into_iter().all(|end| distance(p, end) > clear)
        };
        places
            .into_iter()
            .filter(|s| s.abs() <= 1.0)
            .map(|s| other.at(s))
            .find(|&p| self.parameter(p).abs() <= 1.0 && apart(p))
    }

    /// The place within the edge where coordinate `c` is stationary.
    pub(super) fn turn(&self, c: usize) -> Option<f64> {
        let chord = [0, 1].map(|c| 0.5 * (self.to[c] - self.from[c]));
        let across = [chord[1], -chord[0]][c];
        let sign = if across < 0.0 { -1.0 } else { 1.0 };
        let s = chord[c] / (across + sign * self.half()) / self.bulge;
        (!self.straight() && s.abs() < 1.0 - 1e-12).then_some(s)
    }

    /// The edge as curves along which `y` does not turn back.
    pub(super) fn monotone(&self) -> Vec<Monotone> {
        let mut stops = vec![-1.0];
        stops.extend(self.turn(0));
        stops.push(1.0);
        let part = |pair: &[f64]| {
            let at = |s: f64| match s {
                -1.0 => self.from,
                1.0 => self.to,
                _ => self.at(s),
            };
            Monotone {
                edge: *self,
                range: [pair[0], pair[1]],
                ends: [at(pair[0]), at(pair[1])],
            }
        };
        stops.windows(2).map(part).collect()
    }
}

/// Part of an edge along which `y` rises or falls throughout.
#[derive(Debug, Clone, Copy)]
pub(super) struct Monotone {
    pub(super) edge: Edge<f64>,
    range: [f64; 2],
    pub(super) ends: [[f64; 2]; 2],
}

impl Monotone {
    /// Lower and upper end of `y`.
    pub(super) fn span(&self) -> [f64; 2] {
        let [[a, _], [b, _]] = self.ends;
        [a.min(b), a.max(b)]
    }

    /// The `z` of the curve at `y`.
    pub(super) fn z(&self, y: f64) -> f64 {
        let (edge, b) = (&self.edge, self.edge.bulge);
        let chord = [0, 1].map(|c| 0.5 * (edge.to[c] - edge.from[c]));
        let below = edge.middle()[0] - y;
        let found = roots(
            below * b * b - chord[1] * b,
            chord[0] * (1.0 + b * b),
            below + chord[1] * b,
        );
        let [low, high] = self.range;
        let off = |s: &f64| (low - s).max(s - high).max(0.0);
        let best = found
            .into_iter()
            .filter(|s| s.is_finite())
            .min_by(|a, b| off(a).total_cmp(&off(b)));
        edge.at(best.unwrap_or(low).clamp(low, high))[1]
    }
}

/// Real roots of `a s^2 + b s + c`, without cancellation; not finite where there is none. A
/// discriminant below zero is taken for the rounding of a double root only if it is tiny.
fn roots(a: f64, b: f64, c: f64) -> [f64; 2] {
    let mut discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 && discriminant > -1e-14 * (b * b).max((4.0 * a * c).abs()) {
        discriminant = 0.0;
    }
    let sign = if b < 0.0 { -1.0 } else { 1.0 };
    let q = -0.5 * (b + sign * discriminant.sqrt());
    if q == 0.0 {
        // Without a linear term: zero twice, or a constant.
        return [if c == 0.0 { 0.0 } else { f64::NAN }, f64::NAN];
    }
    [q / a, c / q]
}
