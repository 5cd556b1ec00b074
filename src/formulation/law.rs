//! Laws of the cross-section: strain energy per unit length as a function of the vectors that a
//! station samples. A law given by its energy alone gets its resultants and stiffness by dual
//! numbers, one sampled vector at a time; built-in laws override them with closed forms.

use std::fmt::Debug;

use crate::material::{Material, green_lagrange};
use crate::scalar::{Algebra, LaneWork, Real};
use crate::tensor::{add_times, cross, dot, sum};

/// Second derivatives of a section's energy: `k[a][b]` is the `D x D` block that couples the
/// sampled vectors `a` and `b`. Only blocks with `a <= b` are used.
pub type SectionStiffness<T, const D: usize, const K: usize> = [[[[T; D]; D]; K]; K];

/// Strain energy per unit length of a beam as a function of `K` sampled vectors in `D` dimensions.
///
/// The vectors are `g = g0 + h`: `reference` holds `g0`, the displacement part `h` carries the
/// number type. Energies formed from `h` keep their digits on slender beams.
pub trait SectionLaw<R: Real, const D: usize, const K: usize>:
    Debug + Send + Sync + 'static
{
    /// Runs work on elements with these laws: see
    /// [`ElementKernel::dispatch`](super::ElementKernel::dispatch).
    #[inline(always)]
    fn dispatch<'a, W: LaneWork<R>>(_laws: impl Iterator<Item = &'a Self>, work: W) -> W::Output
    where
        Self: Sized,
    {
        work.run::<R>()
    }

    /// Energy per unit length (J/m).
    fn energy<T: Algebra<R>>(&self, reference: &[[R; D]; K], h: &[[T; D]; K]) -> T;

    /// Derivatives of the energy by the sampled vectors.
    #[inline]
    fn resultants<T: Algebra<R>>(&self, reference: &[[R; D]; K], h: &[[T; D]; K]) -> [[T; D]; K] {
        derived_resultants(self, reference, h)
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

/// Dual numbers with unit derivatives along the components of vector `k` of `vectors`.
#[inline(always)]
pub(super) fn varied<R, T: Algebra<R>, const D: usize, const K: usize>(
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
                    let (strain, volume) = in_material_frame(&initial, &strain);
                    self.material.energy(&strain).times(*w * volume)
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

    #[inline]
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

/// The strain by reference coordinates turned to the strain by the orthonormal material frame,
/// and the reference volume per volume of coordinates. The frame has its axes 1 and 2 in the
/// section, the first of them along the first cross slope.
#[inline(always)]
fn in_material_frame<R: Real, T: Algebra<R>, const D: usize>(
    initial: &[[R; D]; D],
    strain: &[[T; D]; D],
) -> ([[T; D]; D], R) {
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
    let map: [[R; D]; D] = std::array::from_fn(|a| {
        std::array::from_fn(|k| {
            let reciprocal = cross(&c[(k + 1) % 3], &c[(k + 2) % 3]);
            dot(&frame[a], &reciprocal) / volume
        })
    });
    let half: [[T; D]; D] = std::array::from_fn(|a| {
        let mut row = [T::zero(); D];
        for k in 0..D {
            add_times(&mut row, map[a][k], &strain[k]);
        }
        row
    });
    let turned = std::array::from_fn(|a| {
        std::array::from_fn(|b| (0..D).fold(T::zero(), |s, k| s + half[a][k].times(map[b][k])))
    });
    (turned, volume)
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
