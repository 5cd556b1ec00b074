//! What every element must be before a beam is made of it: nodal vectors that its dimension has, and
//! shape functions that give each node its own. The kit of checks goes on from here.

use num_dual::DualSVec;

use super::{Element, NodalVector};
use crate::error::{Error, Result};
use crate::scalar::Scalar;

/// Error of a shape function that is a mistake and not rounding.
const WRONG: f64 = 1e-3;
/// Stations along the axis at which fields are compared, off every special point.
const STATIONS: [f64; 7] = [0.0, 0.137, 0.291, 0.5, 0.618, 0.823, 1.0];
/// Cross positions over the length.
pub(crate) const ACROSS: [[f64; 2]; 4] = [[0.0, 0.0], [0.11, 0.03], [-0.05, 0.07], [0.02, -0.13]];

/// Whether the constants of an element describe one.
pub(crate) fn check_layout<E: Element<D, S>, const D: usize, const S: usize>() -> Result<()> {
    if E::NODES < 2 {
        return Err(Error::TooFew {
            what: "number of nodes of an element",
            value: E::NODES,
            least: 2,
            remedy: "give it a node at each end",
        });
    }
    let wrong = |what: String| {
        Err(Error::Unsupported {
            what,
            remedy: NAMES,
        })
    };
    for (i, vector) in E::VECTORS.iter().enumerate() {
        if E::VECTORS[..i].contains(vector) {
            return wrong(format!("an element with {vector:?} twice at a node"));
        }
        if matches!(vector, NodalVector::Slope(axis) if *axis >= D) {
            return wrong(format!("an element with {vector:?} in {D} dimensions"));
        }
    }
    if !E::VECTORS.contains(&NodalVector::Position) {
        return wrong("an element without positions of its nodes".into());
    }
    let what = "number S of shape functions, to be NODES times the VECTORS of a node,";
    Error::check_length(what, S, E::NODES * E::VECTORS.len())
}

const NAMES: &str = "name in Element::VECTORS the position and those of the slopes 0 to D - 1 that a node carries, each once";

/// Whether a beam can be made of an element: its constants, and shape functions that add up to one
/// and give every node its own vectors, but for rounding.
pub(crate) fn check<E: Element<D, S>, const D: usize, const S: usize>(element: &E) -> Result<()> {
    check_layout::<E, D, S>()?;
    // Of no round length, so that one left out is seen.
    let kit = Kit {
        element,
        length: 0.7,
    };
    let wrong = |what: String| {
        let remedy = "correct Element::shape; verify::element tells more";
        Err(Error::Unsupported { what, remedy })
    };
    // An error that is no number is one, too.
    let sound = |error: f64| error < WRONG;
    let unity = kit.unity();
    if !sound(unity) {
        return wrong(format!(
            "an element whose position functions miss a sum of one by {unity:.1e}"
        ));
    }
    let (axial, across) = kit.beyond();
    for (error, which, degree) in [
        (axial, "AXIAL_DEGREE", E::AXIAL_DEGREE),
        (across, "SECTION_DEGREE", E::SECTION_DEGREE),
    ] {
        if !sound(error) {
            return wrong(format!(
                "an element whose shape functions are of a higher degree than its {which} of {degree}"
            ));
        }
    }
    for (a, vector) in E::VECTORS.iter().enumerate() {
        let error = kit.nodal(a);
        if !sound(error) {
            return wrong(format!(
                "an element whose shape functions give a node another {vector:?} than its own, by {error:.1e}"
            ));
        }
    }
    Ok(())
}

/// The shape functions of an element of a length (m), to be sampled.
pub(crate) struct Kit<'a, E> {
    pub(crate) element: &'a E,
    pub(crate) length: f64,
}

impl<E> Kit<'_, E> {
    pub(crate) fn point<const D: usize>(xi: f64, across: [f64; 2]) -> [f64; D] {
        std::array::from_fn(|a| if a == 0 { xi } else { across[a - 1] })
    }

    pub(crate) fn points<const D: usize>() -> impl Iterator<Item = [f64; D]> {
        STATIONS
            .into_iter()
            .flat_map(|xi| ACROSS.map(|y| Self::point(xi, y)))
    }

    pub(crate) fn shape<const D: usize, const S: usize>(&self, x: [f64; D]) -> [f64; S]
    where
        E: Element<D, S>,
    {
        self.element.shape(self.length, x)
    }

    /// Functions of positions add up to one, so that a translation moves every point alike.
    pub(crate) fn unity<const D: usize, const S: usize>(&self) -> f64
    where
        E: Element<D, S>,
    {
        let sum = |x| -> f64 { self.positions(&self.shape(x)).map(|(_, s)| s).sum() };
        Self::points().fold(0.0, |worst, x| most(worst, (sum(x) - 1.0).abs()))
    }

    pub(crate) fn positions<'s, const D: usize, const S: usize>(
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
    pub(crate) fn nodal<const D: usize, const S: usize>(&self, a: usize) -> f64
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

    /// Divided differences of one order above the declared degrees, along and across, over the
    /// largest value of each function.
    pub(crate) fn beyond<const D: usize, const S: usize>(&self) -> (f64, f64)
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

    /// Derivatives of the shape functions by `X_axis` (1/m).
    pub(crate) fn gradient<const D: usize, const S: usize>(
        &self,
        at: [f64; D],
        axis: usize,
    ) -> [f64; S]
    where
        E: Element<D, S>,
    {
        let mut x = at.map(DualSVec::<f64, 1>::from_re);
        x[axis] = x[axis].derivative(0);
        let s = self.element.shape(DualSVec::lit(self.length), x);
        s.map(|s| s.eps.0.map_or(0.0, |d| d[0] / self.length))
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

/// The larger of two, NaN if either is: a failed evaluation must not hide behind a good one.
pub(crate) fn most(a: f64, b: f64) -> f64 {
    if a >= b || a.is_nan() { a } else { b }
}
