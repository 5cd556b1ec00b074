//! Laws of the cross-section: strain energy per unit length as a function of the vectors that a
//! station samples. A law given by its energy alone gets its resultants and stiffness by dual
//! numbers, one sampled vector at a time; built-in laws override them with closed forms.

use std::fmt::Debug;

use crate::material::{Material, green_lagrange};
use crate::scalar::{Algebra, Real};
use crate::tensor::{add_scaled, add_times, between, cross, dot, gauss_pair, sum, times};

/// Second derivatives of a section's energy: `k[a][b]` is the `D x D` block that couples the
/// sampled vectors `a` and `b`. Only blocks with `a <= b` are used,
/// except of secants, which are not symmetric.
pub type SectionStiffness<T, const D: usize, const K: usize> = [[[[T; D]; D]; K]; K];

/// Strain energy per unit length of a beam as a function of `K` sampled vectors in `D` dimensions.
///
/// The vectors are `g = g0 + h`: `reference` holds `g0`, the displacement part `h` carries the
/// number type. Energies formed from `h` keep their digits on slender beams.
pub trait SectionLaw<R: Real, const D: usize, const K: usize>:
    Debug + Send + Sync + 'static
{
    /// Energy per unit length (J/m).
    fn energy<T: Algebra<R>>(&self, reference: &[[R; D]; K], h: &[[T; D]; K]) -> T;

    /// Derivatives of the energy by the sampled vectors.
    #[inline]
    fn resultants<T: Algebra<R>>(&self, reference: &[[R; D]; K], h: &[[T; D]; K]) -> [[T; D]; K] {
        derived_resultants(self, reference, h)
    }

    /// Whether [`secant`](Self::secant) is made of strains that rotations do not change, so that
    /// it keeps angular momentum and may be viscous; by default it is not.
    fn has_strain(&self) -> bool {
        false
    }

    /// The mean of the resultants on the straight way of the sampled vectors, whose work is the
    /// change of energy; by default by two Gauss points, exact for energies up to the fourth
    /// degree. With a `viscosity`, and only for laws that have strain, the stress that this share
    /// of the change of strain makes is added.
    #[inline]
    fn secant<T: Algebra<R>>(
        &self,
        _viscosity: R,
        reference: &[[R; D]; K],
        from: &[[T; D]; K],
        to: &[[T; D]; K],
    ) -> [[T; D]; K] {
        path_mean(from, to, |h| self.resultants(reference, h))
    }

    /// Derivatives of the secant resultants by the sampled vectors `to`, all blocks of them: they are
    /// not symmetric.
    #[inline]
    fn secant_stiffness<T: Algebra<R>>(
        &self,
        viscosity: R,
        reference: &[[R; D]; K],
        from: &[[T; D]; K],
        to: &[[T; D]; K],
    ) -> SectionStiffness<T, D, K> {
        derived_secant_stiffness(self, viscosity, reference, from, to)
    }

    /// First derivatives of the energy by the sampled vectors; the second derivatives overwrite the
    /// blocks `a <= b` of `k`.
    #[inline]
    fn stiffness<T: Algebra<R>>(
        &self,
        reference: &[[R; D]; K],
        h: &[[T; D]; K],
        k: &mut SectionStiffness<T, D, K>,
    ) -> [[T; D]; K] {
        derived_stiffness(self, reference, h, k)
    }
}

/// Mean of `force` on the straight way between two sets of vectors, by two Gauss points.
#[inline(always)]
pub(super) fn path_mean<R: Real, T: Algebra<R>, const D: usize, const N: usize>(
    from: &[[T; D]; N],
    to: &[[T; D]; N],
    force: impl Fn(&[[T; D]; N]) -> [[T; D]; N],
) -> [[T; D]; N] {
    let mut mean = [[T::zero(); D]; N];
    for share in gauss_pair::<R>() {
        let part = force(&between(from, to, share));
        for i in 0..N {
            add_times(&mut mean[i], R::lit(0.5), &part[i]);
        }
    }
    mean
}

#[inline(always)]
fn derived_resultants<R, T, L, const D: usize, const K: usize>(
    law: &L,
    reference: &[[R; D]; K],
    h: &[[T; D]; K],
) -> [[T; D]; K]
where
    R: Real,
    T: Algebra<R>,
    L: SectionLaw<R, D, K> + ?Sized,
{
    std::array::from_fn(|k| {
        let energy = law.energy(reference, &varied(h, k));
        std::array::from_fn(|c| T::derivative::<D>(&energy, c))
    })
}

#[inline(always)]
fn derived_stiffness<R, T, L, const D: usize, const K: usize>(
    law: &L,
    reference: &[[R; D]; K],
    h: &[[T; D]; K],
    stiffness: &mut SectionStiffness<T, D, K>,
) -> [[T; D]; K]
where
    R: Real,
    T: Algebra<R>,
    L: SectionLaw<R, D, K> + ?Sized,
{
    let mut resultants = [[T::zero(); D]; K];
    for b in 0..K {
        let dual = law.resultants(reference, &varied(h, b));
        for a in 0..=b {
            for c in 0..D {
                for d in 0..D {
                    stiffness[a][b][c][d] = T::derivative::<D>(&dual[a][c], d);
                }
            }
        }
        resultants[b] = std::array::from_fn(|c| T::real_part::<D>(&dual[b][c]));
    }
    resultants
}

#[inline(always)]
fn derived_secant_stiffness<R, T, L, const D: usize, const K: usize>(
    law: &L,
    viscosity: R,
    reference: &[[R; D]; K],
    from: &[[T; D]; K],
    to: &[[T; D]; K],
) -> SectionStiffness<T, D, K>
where
    R: Real,
    T: Algebra<R>,
    L: SectionLaw<R, D, K> + ?Sized,
{
    let from = from.map(|h| h.map(|x| x.constant::<D>()));
    let mut stiffness = [[[[T::zero(); D]; D]; K]; K];
    for b in 0..K {
        let dual = law.secant(viscosity, reference, &from, &varied(to, b));
        for a in 0..K {
            for c in 0..D {
                stiffness[a][b][c] = std::array::from_fn(|d| T::derivative::<D>(&dual[a][c], d));
            }
        }
    }
    stiffness
}

/// Dual numbers with unit derivatives along the components of vector `k` of `vectors`.
#[inline(always)]
pub(crate) fn varied<R, T: Algebra<R>, const D: usize, const K: usize>(
    vectors: &[[T; D]; K],
    k: usize,
) -> [[T::Dual<D>; D]; K] {
    std::array::from_fn(|a| {
        std::array::from_fn(|c| match a == k {
            true => vectors[a][c].variable(c),
            false => vectors[a][c].constant(),
        })
    })
}

/// A material sampled at points of the section of a beam whose position is linear in the cross
/// coordinates. Its `K = 2 D - 1` vectors are `r'`, the cross slopes `r_y`[, `r_z`] and their
/// derivatives along the axis; the deformation gradient at a section point is
/// `J = [r' + y r_y' + z r_z', r_y, r_z]` (the inner sum of eq. 18 of Orzechowski 2012). On a
/// curved reference with gradient `J0` it is `J J0^-1`, and derivatives come from the energy.
#[derive(Debug, Clone)]
pub struct PointSection<R, M, const D: usize> {
    material: M,
    /// Section points `(1, y[, z])` with weights: the factors of the vectors in the first column.
    points: Vec<([R; D], R)>,
    straight: bool,
}

/// Which sampled vector has the factor `m` of `(1, y, z)` in the first gradient column.
#[inline(always)]
pub(super) const fn first_column<const D: usize>(m: usize) -> usize {
    if m == 0 { 0 } else { D - 1 + m }
}

impl<R: Real, M, const D: usize> PointSection<R, M, D> {
    /// `material` at the section points `(0, y[, z])` (m) with weights (m^2), on references that
    /// are `straight` or not.
    pub(super) fn new(material: M, points: Vec<([R; D], R)>, straight: bool) -> Self {
        let factors = |(mut y, w): ([R; D], R)| {
            y[0] = R::one();
            (y, w)
        };
        Self {
            material,
            points: points.into_iter().map(factors).collect(),
            straight,
        }
    }
}

impl<R: Real, M, const D: usize> PointSection<R, M, D> {
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
    let mut columns: [[T; D]; D] = std::array::from_fn(|a| g[a]);
    for m in 1..D {
        add_times(&mut columns[0], y[m], &g[first_column::<D>(m)]);
    }
    columns
}

impl<R, M, const D: usize, const K: usize> SectionLaw<R, D, K> for PointSection<R, M, D>
where
    R: Real,
    M: Material<R, D>,
{
    #[inline]
    fn energy<T: Algebra<R>>(&self, reference: &[[R; D]; K], h: &[[T; D]; K]) -> T {
        let mut energy = T::zero();
        for (y, w) in &self.points {
            let initial = columns(reference, y);
            let strain = green_lagrange(&initial, &columns(h, y));
            energy += match self.straight {
                true => self.material.energy(&strain).times(*w),
                false => {
                    let (map, volume) = material_frame(&initial);
                    let energy = self.material.energy(&turned(&map, &strain));
                    energy.times(*w * volume)
                }
            };
        }
        energy
    }

    #[inline]
    fn resultants<T: Algebra<R>>(&self, reference: &[[R; D]; K], h: &[[T; D]; K]) -> [[T; D]; K] {
        if !self.straight {
            return derived_resultants(self, reference, h);
        }
        let mut n = [[T::zero(); D]; K];
        for (y, w) in &self.points {
            let (initial, displacement) = (columns(reference, y), columns(h, y));
            let strain = green_lagrange(&initial, &displacement);
            let stress = self.material.stress(&strain);
            add_resultants(&mut n, y, *w, &stress, &total(&initial, &displacement));
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
        for (y, w) in &self.points {
            let initial = columns(reference, y);
            let strain = |h| green_lagrange(&initial, &columns(h, y));
            let (before, after) = (strain(from), strain(to));
            let stress = match self.straight {
                true => self.secant_stress(viscosity, &before, &after),
                false => {
                    let (map, volume) = material_frame(&initial);
                    let (before, after) = (turned(&map, &before), turned(&map, &after));
                    let stress = self.secant_stress(viscosity, &before, &after);
                    let back = std::array::from_fn(|k| std::array::from_fn(|a| map[a][k]));
                    turned(&back, &stress).map(|row| times(volume, &row))
                }
            };
            let c = total(&initial, &columns(&middle, y));
            add_resultants(&mut n, y, *w, &stress, &c);
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
        if !self.straight {
            return derived_secant_stiffness(self, viscosity, reference, from, to);
        }
        let half = R::lit(0.5);
        let middle = between(from, to, half);
        let mut k = [[[[T::zero(); D]; D]; K]; K];
        for (y, w) in &self.points {
            let initial = columns(reference, y);
            let strain = |h| green_lagrange(&initial, &columns(h, y));
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
            let left = total(&initial, &columns(&middle, y));
            let right = total(&initial, &columns(to, y));
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
            // The gradient column that a sampled vector is in, and its factor there.
            let place = |k: usize| match k {
                0 => (0, y[0]),
                k if k < D => (k, R::one()),
                k => (0, y[k + 1 - D]),
            };
            for m in 0..K {
                let (a, left) = place(m);
                for n in 0..K {
                    let (b, right) = place(n);
                    for i in 0..D {
                        add_times(&mut k[m][n][i], *w * left * right, &blocks[a][b][i]);
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
        if !self.straight {
            return derived_stiffness(self, reference, h, k);
        }
        let mut n = [[T::zero(); D]; K];
        *k = [[[[T::zero(); D]; D]; K]; K];
        for (y, w) in &self.points {
            let (initial, displacement) = (columns(reference, y), columns(h, y));
            let c = total(&initial, &displacement);
            let strain = green_lagrange(&initial, &displacement);
            let stress = self.material.stress(&strain);
            add_resultants(&mut n, y, *w, &stress, &c);
            let mut blocks = self.material.stiffness(&strain, &c);
            for a in 0..D {
                for b in a..D {
                    for i in 0..D {
                        blocks[a][b][i][i] += stress[a][b];
                    }
                }
            }
            add_stiffness(k, y, *w, &blocks);
        }
        n
    }
}

/// The map from strain by reference coordinates to strain by the orthonormal material frame, for
/// [`turned`], and the reference volume per volume of coordinates. The frame has its axes 1 and 2
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

/// The tensor by the axes of another frame: `map tensor map^T`.
#[inline(always)]
fn turned<R: Real, T: Algebra<R>, const D: usize>(
    map: &[[R; D]; D],
    tensor: &[[T; D]; D],
) -> [[T; D]; D] {
    let half: [[T; D]; D] = std::array::from_fn(|a| {
        let mut row = [T::zero(); D];
        for k in 0..D {
            add_times(&mut row, map[a][k], &tensor[k]);
        }
        row
    });
    std::array::from_fn(|a| {
        std::array::from_fn(|b| (0..D).fold(T::zero(), |s, k| s + half[a][k].times(map[b][k])))
    })
}

/// Columns of the deformation gradient.
#[inline(always)]
fn total<R: Real, T: Algebra<R>, const D: usize>(
    initial: &[[R; D]; D],
    displacement: &[[T; D]; D],
) -> [[T; D]; D] {
    std::array::from_fn(|a| sum(&displacement[a], &initial[a].map(T::lift)))
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
