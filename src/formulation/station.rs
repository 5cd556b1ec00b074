//! The kernel of continuum beams whose shape functions are linear across the section. Such an
//! element has, at each station of the axis, only `K = 2 D - 1` independent vectors: `r'`, the
//! cross slopes `r_y`, `r_z` and their derivatives `r_y'`, `r_z'`. The paper's split of the volume
//! integral (eq. 18) then becomes two nested loops: the section cubature works on the station
//! vectors alone, and the shape functions of the element enter once per station, not once per
//! point.

use num_dual::HyperDual;

use super::{ElementKernel, Reference, Tangent};
use crate::element::{Element, NodalVector};
use crate::error::{Error, Result};
use crate::material::{Material, green_lagrange};
use crate::quadrature::Cubature;
use crate::scalar::{Algebra, Real};
use crate::tensor::{add_scaled, add_times, dot, sum, times};

/// A sparse row of the station operator: how one station vector is combined from nodal vectors.
#[derive(Debug, Clone)]
struct Row<R, const S: usize> {
    nodal: [usize; S],
    value: [R; S],
    count: usize,
}

impl<R: Real, const S: usize> Row<R, S> {
    fn new(dense: [R; S]) -> Self {
        let mut row = Self {
            nodal: [0; S],
            value: [R::zero(); S],
            count: 0,
        };
        for (i, value) in dense.into_iter().enumerate() {
            if !value.is_zero() {
                row.nodal[row.count] = i;
                row.value[row.count] = value;
                row.count += 1;
            }
        }
        row
    }

    #[inline(always)]
    fn iter(&self) -> impl Iterator<Item = (usize, R)> + '_ {
        let entries = self.nodal.iter().zip(&self.value).take(self.count);
        // The remainder is the identity; it lets the optimiser drop the bounds checks.
        entries.map(|(&i, &v)| (i % S, v))
    }
}

#[derive(Debug, Clone)]
struct Station<R, const S: usize, const K: usize> {
    weight: R,
    rows: [Row<R, S>; K],
}

/// One part of the energy: a material on a grid of stations times section points.
#[derive(Debug, Clone)]
struct Sampled<R, M, const D: usize, const S: usize, const K: usize> {
    material: M,
    stations: Vec<Station<R, S, K>>,
    /// Section points `(1, y[, z])` and weights: the monomials that multiply the station vectors
    /// of the first gradient column.
    points: Vec<([R; D], R)>,
}

/// Kernel of a [`Continuum`](super::Continuum) beam: the sampled parts of its energy. `K` is
/// `2 D - 1`.
#[derive(Debug, Clone)]
pub struct ContinuumKernel<R, M, const D: usize, const S: usize, const K: usize> {
    /// `r'`, `r_y`[, `r_z`] in the reference state; the others vanish in a straight beam.
    frame: [[R; D]; D],
    parts: Vec<Sampled<R, M, D, S, K>>,
}

/// Which station vector multiplies monomial `m` of `(1, y, z)` in the first gradient column.
#[inline(always)]
const fn first_column<const D: usize>(m: usize) -> usize {
    if m == 0 { 0 } else { D - 1 + m }
}

impl<R: Real, M, const D: usize, const S: usize, const K: usize> ContinuumKernel<R, M, D, S, K> {
    pub(super) fn new(reference: &Reference<R, D>) -> Self {
        const {
            assert!(
                K == 2 * D - 1,
                "r', D - 1 cross slopes and their derivatives"
            )
        };
        Self {
            frame: reference.frame,
            parts: Vec::new(),
        }
    }

    /// Adds a part of the energy: `material` sampled at the axial rule `axial` (on [0, 1]) times
    /// the section points `(0, y[, z])`.
    pub(super) fn add_part<E: Element<D, S>>(
        &mut self,
        element: &E,
        length: R,
        material: M,
        axial: &Cubature<R, 1>,
        points: Vec<([R; D], R)>,
    ) -> Result<()> {
        let stations = axial.iter().map(|([xi], w)| {
            Ok(Station {
                weight: w * length,
                rows: operator(element, length, xi)?.map(Row::new),
            })
        });
        let stations = stations.collect::<Result<_>>()?;
        let monomials = |(mut y, w): ([R; D], R)| {
            y[0] = R::one();
            (y, w)
        };
        self.parts.push(Sampled {
            material,
            stations,
            points: points.into_iter().map(monomials).collect(),
        });
        Ok(())
    }

    #[inline(always)]
    fn vectors<T: Algebra<R>>(station: &Station<R, S, K>, u: &[[T; D]; S]) -> [[T; D]; K] {
        let mut h = [[T::zero(); D]; K];
        for k in 0..K {
            for (i, value) in station.rows[k].iter() {
                add_times(&mut h[k], value, &u[i]);
            }
        }
        h
    }

    /// Columns of the displacement gradient at a section point.
    #[inline(always)]
    fn gradient<T: Algebra<R>>(h: &[[T; D]; K], y: &[R; D]) -> [[T; D]; D] {
        let mut columns: [[T; D]; D] = std::array::from_fn(|a| h[a]);
        for m in 1..D {
            add_times(&mut columns[0], y[m], &h[first_column::<D>(m)]);
        }
        columns
    }

    /// Columns of the deformation gradient from those of the displacement gradient.
    #[inline(always)]
    fn total<T: Algebra<R>>(&self, displacement: &[[T; D]; D]) -> [[T; D]; D] {
        std::array::from_fn(|a| sum(&displacement[a], &self.frame[a].map(T::lift)))
    }
}

impl<R, M, const D: usize, const S: usize, const K: usize> ElementKernel<R, D, S>
    for ContinuumKernel<R, M, D, S, K>
where
    R: Real,
    M: Material<R, D>,
{
    #[inline]
    fn energy<T: Algebra<R>>(&self, u: &[[T; D]; S]) -> T {
        let mut energy = T::zero();
        for part in &self.parts {
            for station in &part.stations {
                let h = Self::vectors(station, u);
                for (y, w) in &part.points {
                    let strain = green_lagrange(&self.frame, &Self::gradient(&h, y));
                    energy += part.material.energy(&strain).times(*w * station.weight);
                }
            }
        }
        energy
    }

    #[inline]
    fn force<T: Algebra<R>>(&self, u: &[[T; D]; S], q: &mut [[T; D]; S]) {
        for part in &self.parts {
            for station in &part.stations {
                let h = Self::vectors(station, u);
                let mut n = [[T::zero(); D]; K];
                for (y, w) in &part.points {
                    let displacement = Self::gradient(&h, y);
                    let c = self.total(&displacement);
                    let strain = green_lagrange(&self.frame, &displacement);
                    let stress = part.material.stress(&strain);
                    add_resultants(&mut n, y, *w, &stress, &c);
                }
                scatter_force(station, &n, q);
            }
        }
    }

    #[inline]
    fn tangent<T: Algebra<R>>(
        &self,
        u: &[[T; D]; S],
        q: &mut [[T; D]; S],
        k: &mut Tangent<T, D, S>,
    ) {
        for part in &self.parts {
            for station in &part.stations {
                let h = Self::vectors(station, u);
                let mut n = [[T::zero(); D]; K];
                let mut hessian = [[[[T::zero(); D]; D]; K]; K];
                for (y, w) in &part.points {
                    let displacement = Self::gradient(&h, y);
                    let c = self.total(&displacement);
                    let strain = green_lagrange(&self.frame, &displacement);
                    let stress = part.material.stress(&strain);
                    add_resultants(&mut n, y, *w, &stress, &c);
                    let mut blocks = part.material.stiffness(&strain, &c);
                    for a in 0..D {
                        for b in a..D {
                            for i in 0..D {
                                blocks[a][b][i][i] += stress[a][b];
                            }
                        }
                    }
                    add_hessian(&mut hessian, y, *w, &blocks);
                }
                scatter_force(station, &n, q);
                scatter_tangent(station, &hessian, k);
            }
        }
    }
}

/// Adds one section point to the derivatives of the section's energy by the station vectors.
#[inline(always)]
fn add_resultants<R: Real, T: Algebra<R>, const D: usize, const K: usize>(
    n: &mut [[T; D]; K],
    y: &[R; D],
    w: R,
    stress: &[[T; D]; D],
    c: &[[T; D]; D],
) {
    for a in 0..D {
        // Column a of the first Piola-Kirchhoff stress.
        let piola: [T; D] = std::array::from_fn(|i| {
            let column: [T; D] = std::array::from_fn(|b| c[b][i]);
            dot(&stress[a], &column)
        });
        if a == 0 {
            for m in 0..D {
                add_times(&mut n[first_column::<D>(m)], w * y[m], &piola);
            }
        } else {
            add_times(&mut n[a], w, &piola);
        }
    }
}

/// Adds one section point to the second derivatives of the section's energy by the station
/// vectors; upper triangle of blocks only.
#[inline(always)]
fn add_hessian<R: Real, T: Algebra<R>, const D: usize, const K: usize>(
    hessian: &mut [[[[T; D]; D]; K]; K],
    y: &[R; D],
    w: R,
    blocks: &[[[[T; D]; D]; D]; D],
) {
    for m in 0..D {
        let k = first_column::<D>(m);
        for p in m..D {
            let l = first_column::<D>(p);
            for i in 0..D {
                add_times(&mut hessian[k][l][i], w * y[m] * y[p], &blocks[0][0][i]);
            }
        }
        for b in 1..D {
            for i in 0..D {
                if k <= b {
                    add_times(&mut hessian[k][b][i], w * y[m], &blocks[0][b][i]);
                } else {
                    // The pair (b, k) is the transpose of (k, b).
                    for j in 0..D {
                        hessian[b][k][j][i] += blocks[0][b][i][j].times(w * y[m]);
                    }
                }
            }
        }
    }
    for a in 1..D {
        for b in a..D {
            for i in 0..D {
                add_times(&mut hessian[a][b][i], w, &blocks[a][b][i]);
            }
        }
    }
}

#[inline(always)]
fn scatter_force<R: Real, T: Algebra<R>, const D: usize, const S: usize, const K: usize>(
    station: &Station<R, S, K>,
    n: &[[T; D]; K],
    q: &mut [[T; D]; S],
) {
    for k in 0..K {
        let n = times(station.weight, &n[k]);
        for (i, value) in station.rows[k].iter() {
            add_times(&mut q[i], value, &n);
        }
    }
}

#[inline(always)]
fn scatter_tangent<R: Real, T: Algebra<R>, const D: usize, const S: usize, const K: usize>(
    station: &Station<R, S, K>,
    hessian: &[[[[T; D]; D]; K]; K],
    tangent: &mut Tangent<T, D, S>,
) {
    for k in 0..K {
        for l in k..K {
            let block: [[T; D]; D] =
                std::array::from_fn(|c| times(station.weight, &hessian[k][l][c]));
            for (i, left) in station.rows[k].iter() {
                for (j, right) in station.rows[l].iter() {
                    let factor = left * right;
                    for c in 0..D {
                        for d in 0..D {
                            let value = block[c][d].times(factor);
                            tangent[i][c][j][d] += value;
                            if k != l {
                                tangent[j][d][i][c] += value;
                            }
                        }
                    }
                }
            }
        }
    }
}

/// The station operator at the natural coordinate `xi`: rows `r'`, cross slopes, derivatives of
/// the cross slopes, each a combination of the nodal vectors.
///
/// # Errors
/// [`Error::Unsupported`] when the shape functions are not linear across the section.
fn operator<R: Real, E: Element<D, S>, const D: usize, const S: usize, const K: usize>(
    element: &E,
    length: R,
    xi: R,
) -> Result<[[R; S]; K]> {
    type Second<R> = HyperDual<R>;
    let at = |a: usize, b: usize, point: [R; D]| {
        let mut x = point.map(Second::from_re);
        x[a] = x[a].derivative1();
        x[b] = x[b].derivative2();
        element.shape(Second::from_re(length), x)
    };
    let mut axis = [R::zero(); D];
    axis[0] = xi;
    let per_length = length.recip();
    let mut rows = [[R::zero(); S]; K];
    for a in 1..D {
        let s = at(0, a, axis);
        rows[0] = std::array::from_fn(|i| s[i].eps1 * per_length);
        rows[a] = std::array::from_fn(|i| s[i].eps2 * per_length);
        rows[D - 1 + a] = std::array::from_fn(|i| s[i].eps1eps2 * per_length * per_length);
        for b in a..D {
            let mut off = axis;
            off[a] = R::lit(0.5);
            off[b] = R::lit(0.25);
            let curved =
                |s: Second<R>| s.eps1eps2.value().abs() > 1e3 * R::EPSILON * length.value();
            if at(a, b, off).into_iter().any(curved) {
                return Err(Error::Unsupported {
                    what: format!(
                        "{element:?} in a continuum sampled at stations: its shape functions are not linear across the section"
                    ),
                    remedy: "use an element whose position is linear in the cross coordinates",
                });
            }
        }
    }
    Ok(rows)
}

/// Reference values of the nodal vectors of an element that starts at `origin`.
pub(crate) fn reference_vectors<R: Real, E: Element<D, S>, const D: usize, const S: usize>(
    _element: &E,
    reference: &Reference<R, D>,
    origin: &[R; D],
) -> [[R; D]; S] {
    let per_node = E::VECTORS.len();
    std::array::from_fn(|i| match E::VECTORS[i % per_node] {
        NodalVector::Slope(a) => reference.frame[a],
        NodalVector::Position => {
            let along = R::lit((i / per_node) as f64) / R::lit((E::NODES - 1) as f64);
            let mut r = *origin;
            add_scaled(&mut r, along * reference.length, &reference.frame[0]);
            r
        }
    })
}
