//! Checks of shape functions alone. Which fields an element must reproduce follows from the nodal
//! vectors it names: with every cross slope it must represent any linear field, without one of them
//! only what the axis does.

use nalgebra::{DMatrix, SymmetricEigen};

use super::{Limit, Report};
use crate::element::{ACROSS, Element, Kit, NodalVector, check_layout, most};

/// Rounding allowed in sums of a few shape functions.
const EXACT: f64 = 1e-12;
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
    if !(length.is_finite() && length > 0.0) {
        report.push("length", "m", length, Limit::Above(0.0));
    }
    if let Err(error) = check_layout::<E, D, S>() {
        report.push(
            "nodes and nodal vectors",
            error.to_string(),
            1.0,
            Limit::AtMost(0.0),
        );
    }
    if !report.passed() {
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

impl<E> Kit<'_, E> {
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
}
