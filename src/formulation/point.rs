//! The law of a material at section points: what [`Continuum`](super::Continuum) samples where the
//! elasticity is not constant.

use super::law::{SectionLaw, SectionStiffness};
use crate::material::{Material, green_lagrange};
use crate::scalar::{Algebra, Real};
use crate::tensor::{add_scaled, add_times, array, between, cross, dot};

/// A material sampled at points of the section of a beam whose position is linear in the cross
/// coordinates. Its `K = 2 D - 1` vectors are `r'`, the cross slopes `r_y`[, `r_z`] and their
/// derivatives along the axis; the deformation gradient at a section point is
/// `J = [r' + y r_y' + z r_z', r_y, r_z]` (the inner sum of eq. 18 of Orzechowski 2012). On a
/// curved reference with gradient `J0` it is `J J0^-1`, by an orthonormal frame of the section; on a
/// `STRAIGHT` one that frame is the beam's own.
#[derive(Debug, Clone)]
pub struct PointSection<R, M, const D: usize, const STRAIGHT: bool> {
    material: M,
    /// Section points `(1, y[, z])` with weights: the factors of the vectors in the first column.
    points: Vec<([R; D], R)>,
}

/// Which sampled vector has the factor `m` of `(1, y, z)` in the first gradient column.
#[inline(always)]
pub(super) const fn first_column<const D: usize>(m: usize) -> usize {
    if m == 0 { 0 } else { D - 1 + m }
}

impl<R: Real, M, const D: usize, const STRAIGHT: bool> PointSection<R, M, D, STRAIGHT> {
    /// `material` at the section points `(0, y[, z])` (m) with weights (m^2).
    pub(super) fn new(material: M, points: Vec<([R; D], R)>) -> Self {
        let factors = |(mut y, w): ([R; D], R)| {
            y[0] = R::one();
            (y, w)
        };
        Self {
            material,
            points: points.into_iter().map(factors).collect(),
        }
    }
}

impl<R: Real, M, const D: usize, const STRAIGHT: bool> PointSection<R, M, D, STRAIGHT> {
    /// Mean stress between two strains with the viscous part.
    #[inline(always)]
    fn secant_stress<T: Algebra<R>>(
        &self,
        viscosity: R,
        before: &[[T; D]; D],
        after: &[[T; D]; D],
    ) -> [[T; D]; D]
    where
        M: Material<R, D>,
    {
        let mut stress = self.material.secant(before, after);
        if !viscosity.is_zero() {
            let (old, new) = (self.material.stress(before), self.material.stress(after));
            for a in 0..D {
                add_times(&mut stress[a], viscosity, &new[a]);
                add_times(&mut stress[a], -viscosity, &old[a]);
            }
        }
        stress
    }
}

/// Columns of the gradient at a section point.
#[inline(always)]
fn columns<R: Real, T: Algebra<R>, const D: usize, const K: usize>(
    g: &[[T; D]; K],
    y: &[R; D],
) -> [[T; D]; D] {
    const {
        assert!(
            K == 2 * D - 1,
            "r', D - 1 cross slopes and their derivatives"
        )
    };
    let mut columns: [[T; D]; D] = array(|a| g[a]);
    for m in 1..D {
        add_times(&mut columns[0], y[m], &g[first_column::<D>(m)]);
    }
    columns
}

impl<R, M, const D: usize, const K: usize, const STRAIGHT: bool> SectionLaw<R, D, K>
    for PointSection<R, M, D, STRAIGHT>
where
    R: Real,
    M: Material<R, D>,
{
    const LANES: bool = M::LANES;
    const ABSENT: bool = M::CONSTANT;

    #[inline(always)]
    fn energy<T: Algebra<R>>(&self, reference: &[[R; D]; K], h: &[[T; D]; K]) -> T {
        let mut energy = T::zero();
        for point in &self.points {
            let point = Self::by_frame(reference, point);
            let strain = green_lagrange(&point.initial, &point.columns(h));
            energy += self.material.energy(&strain).times(point.weight);
        }
        energy
    }

    #[inline(always)]
    fn resultants<T: Algebra<R>>(&self, reference: &[[R; D]; K], h: &[[T; D]; K]) -> [[T; D]; K] {
        let mut n = [[T::zero(); D]; K];
        for point in &self.points {
            let point = Self::by_frame(reference, point);
            let displacement = point.columns(h);
            let strain = green_lagrange(&point.initial, &displacement);
            let stress = self.material.stress(&strain);
            point.add_resultants(&mut n, &stress, &total(&point.initial, &displacement));
        }
        n
    }

    fn has_strain(&self) -> bool {
        true
    }

    /// The mean stress on the gradient half way (Simo and Tarnow 1992): its torque vanishes, as
    /// that of the mean of the forces does not.
    #[inline(always)]
    fn secant<T: Algebra<R>>(
        &self,
        viscosity: R,
        reference: &[[R; D]; K],
        from: &[[T; D]; K],
        to: &[[T; D]; K],
    ) -> [[T; D]; K] {
        let middle = between(from, to, R::lit(0.5));
        let mut n = [[T::zero(); D]; K];
        for point in &self.points {
            let point = Self::by_frame(reference, point);
            let strain = |h| green_lagrange(&point.initial, &point.columns(h));
            let stress = self.secant_stress(viscosity, &strain(from), &strain(to));
            let c = total(&point.initial, &point.columns(&middle));
            point.add_resultants(&mut n, &stress, &c);
        }
        n
    }

    #[inline(always)]
    fn secant_stiffness<T: Algebra<R>>(
        &self,
        viscosity: R,
        reference: &[[R; D]; K],
        from: &[[T; D]; K],
        to: &[[T; D]; K],
    ) -> SectionStiffness<T, D, K> {
        let half = R::lit(0.5);
        let middle = between(from, to, half);
        let mut k = [[[[T::zero(); D]; D]; K]; K];
        for point in &self.points {
            let point = Self::by_frame(reference, point);
            let strain = |h| green_lagrange(&point.initial, &point.columns(h));
            let (before, after) = (strain(from), strain(to));
            let stress = self.secant_stress(viscosity, &before, &after);
            let mut elasticity = self.material.secant_elasticity(&before, &after);
            if !viscosity.is_zero() {
                let viscous = self.material.elasticity(&after);
                for (sum, term) in elasticity
                    .as_flattened_mut()
                    .as_flattened_mut()
                    .iter_mut()
                    .zip(viscous.as_flattened().as_flattened())
                {
                    add_times(sum, viscosity, term);
                }
            }
            let left = total(&point.initial, &point.columns(&middle));
            let right = total(&point.initial, &point.columns(to));
            let mut blocks = [[[[T::zero(); D]; D]; D]; D];
            for a in 0..D {
                for b in 0..D {
                    for e in 0..D {
                        let mut column = [T::zero(); D];
                        for f in 0..D {
                            add_scaled(&mut column, elasticity[a][e][b][f], &right[f]);
                        }
                        for i in 0..D {
                            add_scaled(&mut blocks[a][b][i], left[e][i], &column);
                        }
                    }
                    for i in 0..D {
                        blocks[a][b][i][i] += stress[a][b].times(half);
                    }
                }
            }
            let blocks = point.by_coordinates(blocks);
            // The gradient column that a sampled vector is in, and its factor there.
            let place = |k: usize| match k {
                0 => (0, point.y[0]),
                k if k < D => (k, R::one()),
                k => (0, point.y[k + 1 - D]),
            };
            for m in 0..K {
                let (a, left) = place(m);
                for n in 0..K {
                    let (b, right) = place(n);
                    for i in 0..D {
                        let factor = point.weight * left * right;
                        add_times(&mut k[m][n][i], factor, &blocks[a][b][i]);
                    }
                }
            }
        }
        k
    }

    #[inline(always)]
    fn stiffness<T: Algebra<R>>(
        &self,
        reference: &[[R; D]; K],
        h: &[[T; D]; K],
        k: &mut SectionStiffness<T, D, K>,
    ) -> [[T; D]; K] {
        let mut n = [[T::zero(); D]; K];
        *k = [[[[T::zero(); D]; D]; K]; K];
        for point in &self.points {
            let point = Self::by_frame(reference, point);
            let displacement = point.columns(h);
            let c = total(&point.initial, &displacement);
            let strain = green_lagrange(&point.initial, &displacement);
            let stress = self.material.stress(&strain);
            point.add_resultants(&mut n, &stress, &c);
            let mut blocks = self.material.stiffness(&strain, &c);
            for a in 0..D {
                for b in a..D {
                    for i in 0..D {
                        blocks[a][b][i][i] += stress[a][b];
                    }
                }
            }
            if point.map.is_some() {
                for a in 0..D {
                    for b in 0..a {
                        blocks[a][b] = array(|i| array(|j| blocks[b][a][j][i]));
                    }
                }
            }
            add_stiffness(k, point.y, point.weight, &point.by_coordinates(blocks));
        }
        n
    }
}

/// A section point with its gradient by the orthonormal material frame, in which materials are written.
struct ByFrame<'a, R, const D: usize> {
    y: &'a [R; D],
    weight: R,
    initial: [[R; D]; D],
    /// Frame axes by the reciprocal vectors of the reference's gradient; nothing where these are one.
    map: Option<[[R; D]; D]>,
}

impl<R: Real, M, const D: usize, const STRAIGHT: bool> PointSection<R, M, D, STRAIGHT> {
    /// A point by its frame.
    #[inline(always)]
    fn by_frame<'a, const K: usize>(
        reference: &[[R; D]; K],
        (y, w): &'a ([R; D], R),
    ) -> ByFrame<'a, R, D> {
        let initial = columns(reference, y);
        if STRAIGHT {
            return ByFrame {
                y,
                weight: *w,
                initial,
                map: None,
            };
        }
        let (map, volume) = material_frame(&initial);
        ByFrame {
            y,
            weight: *w * volume,
            initial: mapped(&map, &initial),
            map: Some(map),
        }
    }
}

impl<R: Real, const D: usize> ByFrame<'_, R, D> {
    /// Columns of the gradient of a displacement.
    #[inline(always)]
    fn columns<T: Algebra<R>, const K: usize>(&self, h: &[[T; D]; K]) -> [[T; D]; D] {
        let columns = columns(h, self.y);
        match &self.map {
            Some(map) => mapped(map, &columns),
            None => columns,
        }
    }

    /// What is conjugate to pairs of the frame's columns, by those of the coordinates.
    #[inline(always)]
    fn by_coordinates<T: Algebra<R>>(
        &self,
        blocks: [[[[T; D]; D]; D]; D],
    ) -> [[[[T; D]; D]; D]; D] {
        let Some(map) = &self.map else { return blocks };
        let mut half = [[[[T::zero(); D]; D]; D]; D];
        let mut whole = half;
        for a in 0..D {
            for (b, l) in (0..D).flat_map(|b| (0..D).map(move |l| (b, l))) {
                for i in 0..D {
                    add_times(&mut half[a][l][i], map[b][l], &blocks[a][b][i]);
                }
            }
        }
        for (a, k) in (0..D).flat_map(|a| (0..D).map(move |k| (a, k))) {
            for l in 0..D {
                for i in 0..D {
                    add_times(&mut whole[k][l][i], map[a][k], &half[a][l][i]);
                }
            }
        }
        whole
    }

    /// Adds the derivatives of the point's energy by the station vectors.
    #[inline(always)]
    fn add_resultants<T: Algebra<R>, const K: usize>(
        &self,
        n: &mut [[T; D]; K],
        stress: &[[T; D]; D],
        c: &[[T; D]; D],
    ) {
        // Columns of the first Piola-Kirchhoff stress.
        let mut piola: [[T; D]; D] = array(|a| {
            array(|i| {
                let column: [T; D] = array(|b| c[b][i]);
                dot(&stress[a], &column)
            })
        });
        if let Some(map) = &self.map {
            let by_frame = piola;
            piola = [[T::zero(); D]; D];
            for (a, k) in (0..D).flat_map(|a| (0..D).map(move |k| (a, k))) {
                add_times(&mut piola[k], map[a][k], &by_frame[a]);
            }
        }
        for m in 0..D {
            add_times(
                &mut n[first_column::<D>(m)],
                self.weight * self.y[m],
                &piola[0],
            );
        }
        for a in 1..D {
            add_times(&mut n[a], self.weight, &piola[a]);
        }
    }
}

/// The columns by another frame: `map columns`.
#[inline(always)]
fn mapped<R: Real, T: Algebra<R>, const D: usize>(
    map: &[[R; D]; D],
    columns: &[[T; D]; D],
) -> [[T; D]; D] {
    let mut by_frame = [[T::zero(); D]; D];
    for a in 0..D {
        for k in 0..D {
            add_times(&mut by_frame[a], map[a][k], &columns[k]);
        }
    }
    by_frame
}

/// The map from gradients by reference coordinates to those by the orthonormal material frame,
/// and the reference volume per volume of coordinates. The frame has its axes 1 and 2
/// in the section, the first of them along the first cross slope.
#[inline(always)]
pub(super) fn material_frame<R: Real, const D: usize>(initial: &[[R; D]; D]) -> ([[R; D]; D], R) {
    // A planar gradient is one in space with the normal for its third column.
    let c: [[R; 3]; 3] = std::array::from_fn(|a| {
        std::array::from_fn(|i| match (a < D, i < D) {
            (true, true) => initial[a][i],
            (false, false) => R::one(),
            _ => R::zero(),
        })
    });
    let area = cross(&c[1], &c[2]);
    let volume = dot(&area, &c[0]);
    let unit = |v: [R; 3]| {
        let size = dot(&v, &v).sqrt();
        v.map(|c| c / size)
    };
    let (normal, first) = (unit(area), unit(c[1]));
    let frame = [normal, first, cross(&normal, &first)];
    // Frame axes by the reciprocal vectors of the columns.
    let map = std::array::from_fn(|a| {
        std::array::from_fn(|k| {
            let reciprocal = cross(&c[(k + 1) % 3], &c[(k + 2) % 3]);
            dot(&frame[a], &reciprocal) / volume
        })
    });
    (map, volume)
}

/// Columns of the deformation gradient.
#[inline(always)]
fn total<R: Real, T: Algebra<R>, const D: usize>(
    initial: &[[R; D]; D],
    displacement: &[[T; D]; D],
) -> [[T; D]; D] {
    array(|a| array(|c| displacement[a][c] + T::lift(initial[a][c])))
}

/// Adds one section point to the second derivatives of the section's energy by the station
/// vectors; upper triangle of blocks only.
#[inline(always)]
fn add_stiffness<R: Real, T: Algebra<R>, const D: usize, const K: usize>(
    stiffness: &mut SectionStiffness<T, D, K>,
    y: &[R; D],
    w: R,
    blocks: &[[[[T; D]; D]; D]; D],
) {
    for m in 0..D {
        let k = first_column::<D>(m);
        for p in m..D {
            let l = first_column::<D>(p);
            for i in 0..D {
                add_times(&mut stiffness[k][l][i], w * y[m] * y[p], &blocks[0][0][i]);
            }
        }
        for b in 1..D {
            for i in 0..D {
                if k <= b {
                    add_times(&mut stiffness[k][b][i], w * y[m], &blocks[0][b][i]);
                } else {
                    // The pair (b, k) is the transpose of (k, b).
                    for j in 0..D {
                        stiffness[b][k][j][i] += blocks[0][b][i][j].times(w * y[m]);
                    }
                }
            }
        }
    }
    for a in 1..D {
        for b in a..D {
            for i in 0..D {
                add_times(&mut stiffness[a][b][i], w, &blocks[a][b][i]);
            }
        }
    }
}
