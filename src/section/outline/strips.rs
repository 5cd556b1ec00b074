//! Division of a section into strips of constant `y` between the heights where its boundary
//! turns or has a corner. Within a strip the boundary curves are graphs over `y` that keep their
//! order, so the material is a row of curved trapezia, on each of which a product of Gauss rules
//! has positive weights and all its points strictly inside: walls of any thinness are covered.

use super::edge::{Edge, Monotone};
use crate::error::Result;
use crate::quadrature::gauss_legendre;

/// Points strictly inside the material with positive weights, exact to `degree` for straight
/// boundaries and nearly so for curved ones; more than enough to carry every polynomial.
pub(super) fn sample(edges: &[Edge<f64>], degree: usize) -> Result<Vec<([f64; 2], f64)>> {
    let curves: Vec<Monotone> = edges.iter().flat_map(Edge::monotone).collect();
    let mut levels: Vec<f64> = curves.iter().flat_map(|c| c.span()).collect();
    levels.sort_by(f64::total_cmp);
    let height = levels
        .last()
        .zip(levels.first())
        .map_or(0.0, |(b, a)| b - a);
    levels.dedup_by(|b, a| *b - *a <= 1e-12 * height);

    let across = gauss_legendre::<f64>(degree + 1)?;
    let [polynomial, curved] = [degree + 2, degree + 6].map(gauss_legendre::<f64>);
    let (polynomial, curved) = (polynomial?, curved?);
    let mut sample = Vec::new();
    for strip in levels.windows(2) {
        let (low, rise) = (strip[0], strip[1] - strip[0]);
        let middle = low + 0.5 * rise;
        let mut row: Vec<(f64, &Monotone)> = curves
            .iter()
            .filter(|c| c.span()[0] < middle && middle < c.span()[1])
            .map(|c| (c.z(middle), c))
            .collect();
        row.sort_by(|a, b| a.0.total_cmp(&b.0));
        for sides in row.chunks_exact(2) {
            let [left, right] = [sides[0].1, sides[1].1];
            let straight = left.edge.straight() && right.edge.straight();
            let along = if straight { &polynomial } else { &curved };
            for ([t], w) in along.iter() {
                // An arc may start like a square root where it turns; the substitution makes
                // that smooth at both ends of the strip.
                let (part, rate) = if straight {
                    (t, 1.0)
                } else {
                    (t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t))
                };
                let y = low + rise * part;
                let [from, to] = [left.z(y), right.z(y)];
                for ([u], v) in across.iter() {
                    let weight = w * rate * rise * v * (to - from);
                    if weight > 0.0 {
                        sample.push(([y, from + (to - from) * u], weight));
                    }
                }
            }
        }
    }
    Ok(sample)
}

/// How often the boundary winds around a point: 1 in the material, 0 outside and in holes.
pub(super) fn winding(curves: &[Monotone], [y, z]: [f64; 2]) -> i32 {
    let mut turns = 0;
    for curve in curves {
        let [low, high] = curve.span();
        if low <= y && y < high && curve.z(y) > z {
            turns += if curve.ends[1][0] > curve.ends[0][0] {
                -1
            } else {
                1
            };
        }
    }
    // The ray runs towards larger z, where a counter-clockwise boundary goes to smaller y.
    turns
}
