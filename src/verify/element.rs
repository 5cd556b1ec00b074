//! Checks of shape functions alone. Which fields an element must reproduce follows from the nodal
//! vectors it names: with every cross slope it must represent any linear field, without one of them
//! only what the axis does.

use nalgebra::{DMatrix, SymmetricEigen};
use num_dual::DualSVec;

use super::material::most;
use super::{Limit, Report};
use crate::element::{Element, NodalVector};
use crate::scalar::Scalar;

/// Rounding allowed in sums of a few shape functions.
const EXACT: f64 = 1e-12;
/// Stations along the axis at which fields are compared, off every special point.
const STATIONS: [f64; 7] = [0.0, 0.137, 0.291, 0.5, 0.618, 0.823, 1.0];
/// Cross positions over the length.
const ACROSS: [[f64; 2]; 4] = [[0.0, 0.0], [0.11, 0.03], [-0.05, 0.07], [0.02, -0.13]];

/// Checks the shape functions of an element of `length` (m): each node carries the vectors it is
/// said to, positions add up to one, every linear field within the reach of the element's slopes
/// is represented, the functions are independent, neighbours fit, and the declared degrees are
/// those of the functions. Errors are relative to the length where they are lengths.
pub fn element<E: Element<D, S>, const D: usize, const S: usize>(
    element: &E,
    length: f64,
) -> Report {
    let mut report = Report::new(format!("{element:?} in {D} dimensions, length {length} m"));
    let kit = Kit { element, length };
    let counted = E::NODES * E::VECTORS.len();
    let missing = (S as f64 - counted as f64).abs();
    report.push(
        "vectors beside nodes times vectors",
        "",
        missing,
        Limit::AtMost(0.0),
    );
    if missing > 0.0 || E::NODES < 2 || !(length.is_finite() && length > 0.0) {
        report.push(
            "nodes of the element",
            "",
            E::NODES as f64,
            Limit::AtLeast(2.0),
        );
        report.push("length", "m", length, Limit::Above(0.0));
        return report;
    }

    report.push(
        "sum of the position functions minus 1",
        "",
        kit.unity(),
        Limit::AtMost(EXACT),
    );
    for a in 0..E::VECTORS.len() {
        let case = format!("{:?}", E::VECTORS[a]);
        report.push(
            "what a node reads of its own vectors",
            case,
            kit.nodal(a),
            Limit::AtMost(EXACT),
        );
    }
    for axis in 0..D {
        // A slope that no node carries is not part of the element.
        if axis > 0 && !E::VECTORS.contains(&NodalVector::Slope(axis)) {
            continue;
        }
        let case = format!("r along X_{axis}");
        report.push(
            "linear field represented",
            case,
            kit.linear(axis),
            Limit::AtMost(EXACT),
        );
    }
    report.push(
        "other element's share of an end face",
        "",
        kit.overlap(),
        Limit::AtMost(EXACT),
    );
    let independent = kit.independence();
    report.push(
        "independence of the shape functions",
        "",
        independent,
        Limit::AtLeast(1e-10),
    );
    let (axial, across) = kit.beyond();
    let case = format!("beyond {}", E::AXIAL_DEGREE);
    report.push("axial degree left over", case, axial, Limit::AtMost(1e-9));
    let case = format!("beyond {}", E::SECTION_DEGREE);
    report.push(
        "section degree left over",
        case,
        across,
        Limit::AtMost(1e-9),
    );
    report
}

struct Kit<'a, E> {
    element: &'a E,
    length: f64,
}

impl<E> Kit<'_, E> {
    fn point<const D: usize>(xi: f64, across: [f64; 2]) -> [f64; D] {
        std::array::from_fn(|a| if a == 0 { xi } else { across[a - 1] })
    }

    fn points<const D: usize>() -> impl Iterator<Item = [f64; D]> {
        STATIONS
            .into_iter()
            .flat_map(|xi| ACROSS.map(|y| Self::point(xi, y)))
    }

    fn shape<const D: usize, const S: usize>(&self, x: [f64; D]) -> [f64; S]
    where
        E: Element<D, S>,
    {
        self.element.shape(self.length, x)
    }

    /// Functions of positions add up to one, so that a translation moves every point alike.
    fn unity<const D: usize, const S: usize>(&self) -> f64
    where
        E: Element<D, S>,
    {
        let sum = |x| -> f64 { self.positions(&self.shape(x)).map(|(_, s)| s).sum() };
        Self::points().fold(0.0, |worst, x| most(worst, (sum(x) - 1.0).abs()))
    }

    fn positions<'s, const D: usize, const S: usize>(
        &self,
        s: &'s [f64; S],
    ) -> impl Iterator<Item = (usize, f64)> + 's
    where
        E: Element<D, S>,
    {
        let per_node = E::VECTORS.len();
        let at = move |i: &usize| E::VECTORS[i % per_node] == NodalVector::Position;
        (0..S).filter(at).map(move |i| (i / per_node, s[i]))
    }

    /// Reads vector `a` at every node from the field of each shape function in turn: one for its
    /// own, zero for every other (slopes times the length for those of positions).
    fn nodal<const D: usize, const S: usize>(&self, a: usize) -> f64
    where
        E: Element<D, S>,
    {
        let per_node = E::VECTORS.len();
        let mut worst = 0.0;
        for node in 0..E::NODES {
            let xi = node as f64 / (E::NODES - 1) as f64;
            let at = Self::point::<D>(xi, [0.0; 2]);
            let read: [f64; S] = match E::VECTORS[a] {
                NodalVector::Position => self.shape(at),
                NodalVector::Slope(axis) => self.gradient(at, axis),
            };
            for (i, value) in read.into_iter().enumerate() {
                let own = i == node * per_node + a;
                let scale = match (E::VECTORS[a], E::VECTORS[i % per_node]) {
                    (NodalVector::Slope(_), NodalVector::Position) => self.length,
                    (NodalVector::Position, NodalVector::Slope(_)) => 1.0 / self.length,
                    _ => 1.0,
                };
                worst = most(worst, (scale * (value - if own { 1.0 } else { 0.0 })).abs());
            }
        }
        worst
    }

    /// Derivatives of the shape functions by `X_axis` (1/m).
    fn gradient<const D: usize, const S: usize>(&self, at: [f64; D], axis: usize) -> [f64; S]
    where
        E: Element<D, S>,
    {
        let mut x = at.map(DualSVec::<f64, 1>::from_re);
        x[axis] = x[axis].derivative(0);
        let s = self.element.shape(DualSVec::lit(self.length), x);
        s.map(|s| s.eps.0.map_or(0.0, |d| d[0] / self.length))
    }

    /// Error of the field `r = X_axis` (over the length) from its nodal values.
    fn linear<const D: usize, const S: usize>(&self, axis: usize) -> f64
    where
        E: Element<D, S>,
    {
        let per_node = E::VECTORS.len();
        let nodal = |i: usize| match E::VECTORS[i % per_node] {
            NodalVector::Position if axis == 0 => {
                self.length * (i / per_node) as f64 / (E::NODES - 1) as f64
            }
            NodalVector::Slope(a) if a == axis => 1.0,
            _ => 0.0,
        };
        Self::points::<D>().fold(0.0, |worst, x| {
            let s: [f64; S] = self.shape(x);
            let r: f64 = (0..S).map(|i| s[i] * nodal(i)).sum();
            most(worst, (r / self.length - x[axis]).abs())
        })
    }

    /// Largest share that vectors of other nodes have in an end face: neighbours part otherwise.
    fn overlap<const D: usize, const S: usize>(&self) -> f64
    where
        E: Element<D, S>,
    {
        let per_node = E::VECTORS.len();
        let mut worst = 0.0;
        for (xi, node) in [(0.0, 0), (1.0, E::NODES - 1)] {
            for across in ACROSS {
                let s: [f64; S] = self.shape(Self::point(xi, across));
                for (i, s) in s.into_iter().enumerate() {
                    let unit = match E::VECTORS[i % per_node] {
                        NodalVector::Position => 1.0,
                        NodalVector::Slope(_) => self.length,
                    };
                    if i / per_node != node {
                        worst = most(worst, (s / unit).abs());
                    }
                }
            }
        }
        worst
    }

    /// Smallest over largest eigenvalue of the Gram matrix of the normalised functions.
    fn independence<const D: usize, const S: usize>(&self) -> f64
    where
        E: Element<D, S>,
    {
        let samples: Vec<[f64; S]> = Self::points::<D>().map(|x| self.shape(x)).collect();
        let inner = |i: usize, j: usize| samples.iter().map(|s| s[i] * s[j]).sum::<f64>();
        let norm: [f64; S] = std::array::from_fn(|i| inner(i, i).sqrt());
        let gram = DMatrix::from_fn(S, S, |i, j| inner(i, j) / (norm[i] * norm[j]));
        if !gram.iter().all(|v| v.is_finite()) {
            return f64::NAN;
        }
        let values = SymmetricEigen::new(gram).eigenvalues;
        values.min() / values.max()
    }

    /// Divided differences of one order above the declared degrees, along and across, over the
    /// largest value of each function.
    fn beyond<const D: usize, const S: usize>(&self) -> (f64, f64)
    where
        E: Element<D, S>,
    {
        let along = |t: f64| self.shape(Self::point::<D>(t, ACROSS[1]));
        let across = |t: f64| self.shape(Self::point::<D>(0.3, [0.2 * t - 0.1, 0.13 * t]));
        (
            left_over(E::AXIAL_DEGREE, along),
            left_over(E::SECTION_DEGREE, across),
        )
    }
}

/// What the polynomial through `degree + 1` points of [0, 1] misses at others.
fn left_over<const S: usize>(degree: usize, f: impl Fn(f64) -> [f64; S]) -> f64 {
    // Chebyshev nodes keep the interpolation well conditioned.
    let count = degree + 1;
    let node =
        |k: usize| 0.5 - 0.5 * (std::f64::consts::PI * (k as f64 + 0.5) / count as f64).cos();
    let values: Vec<[f64; S]> = (0..count).map(|k| f(node(k))).collect();
    let mut worst = 0.0;
    for t in [0.03, 0.33, 0.58, 0.97] {
        let basis = |k: usize| -> f64 {
            let others = (0..count).filter(|&j| j != k);
            others
                .map(|j| (t - node(j)) / (node(k) - node(j)))
                .product()
        };
        let truth = f(t);
        for i in 0..S {
            let interpolated: f64 = (0..count).map(|k| basis(k) * values[k][i]).sum();
            let size = values
                .iter()
                .fold(f64::MIN_POSITIVE, |m, v| m.max(v[i].abs()));
            // Functions that vanish on the line sampled carry rounding only.
            if size > 1e-12 || truth[i].abs() > 1e-12 {
                worst = most(
                    worst,
                    (interpolated - truth[i]).abs() / size.max(truth[i].abs()),
                );
            }
        }
    }
    worst
}
