//! The law of a section whose material has constant elasticity. On a straight reference the strain
//! of an element linear in the cross coordinates is a polynomial of degree two in them, so that the
//! energy of any section and any rule depends on sums of their products alone: the section is
//! integrated once, when the kernel is made, and costs the same whatever its shape or rule.

use super::law::{SectionLaw, SectionStiffness, first_column};
use crate::material::{Moduli, green_lagrange};
use crate::scalar::{Algebra, Field, Real, Scalar};
use crate::tensor::{add_scaled, add_times, array, between, dot};

/// Constant moduli contracted with the moments `sum_p w_p phi_k phi_l ..` of a rule over the
/// factors `phi = (1, y[, z])` of the first gradient column.
///
/// With `p_k` the sampled vectors of that column (`r', r_y'[, r_z']`) and `c_a` the cross slopes,
/// `E_xx = sum_kl phi_k phi_l (p_k . p_l - 1) / 2`, `2 E_xa = sum_k phi_k p_k . c_a` and
/// `2 E_ab = c_a . c_b`, and the energy is a quadratic form of these sums' terms. Exact sections,
/// reduced rules and a Poisson part on the axis alone differ in the numbers held here only, and
/// parts sampled at the same stations add up to one. Where the section is `SYMMETRIC` about its
/// axes, moments odd in one of them vanish and are not met.
#[derive(Debug, Clone, PartialEq)]
pub struct MomentSection<R, const D: usize, const SYMMETRIC: bool> {
    /// Between the terms `kl` and `mn` of the axial strain (N, N m, .., N m^4).
    axial: [[[[R; D]; D]; D]; D],
    /// Between the normal strain across, `aa`, and the term `kl` of the axial one.
    coupling: [[[R; D]; D]; D],
    /// Between the terms `k` and `l` of the shear strain `xa`.
    shear: [[[R; D]; D]; D],
    /// Normal and shear moduli across times the area (N).
    across: Moduli<R, D>,
}

impl<R: Real, const D: usize> MomentSection<R, D, false> {
    /// A law without stiffness; give it moduli.
    pub(super) fn new() -> Self {
        let zero = R::zero();
        Self {
            axial: [[[[zero; D]; D]; D]; D],
            coupling: [[[zero; D]; D]; D],
            shear: [[[zero; D]; D]; D],
            across: Moduli {
                normal: [[zero; D]; D],
                shear: [[zero; D]; D],
            },
        }
    }

    /// Adds moduli sampled at the section points `(0, y[, z])` (m) with weights (m^2).
    pub(super) fn add(&mut self, moduli: &Moduli<R, D>, points: &[([R; D], R)]) {
        let Moduli { normal, shear } = moduli;
        for (y, w) in points {
            let phi: [R; D] = std::array::from_fn(|k| if k == 0 { R::one() } else { y[k] });
            for a in 1..D {
                for b in 1..D {
                    self.across.normal[a][b] += *w * normal[a][b];
                    self.across.shear[a][b] += *w * shear[a][b];
                }
            }
            for k in 0..D {
                for l in 0..D {
                    // Moduli first: moments alone of a small section leave the range of singles.
                    let moment = |modulus: R| *w * modulus * phi[k] * phi[l];
                    for a in 1..D {
                        self.coupling[a][k][l] += moment(normal[0][a]);
                        self.shear[a][k][l] += moment(shear[0][a]);
                    }
                    for m in 0..D {
                        for n in 0..D {
                            self.axial[k][l][m][n] += moment(normal[0][0]) * phi[m] * phi[n];
                        }
                    }
                }
            }
        }
    }
}

impl<R: Real, const D: usize> MomentSection<R, D, false> {
    /// The same law for a symmetric section, unless a moment odd in `y` or `z` says that it is none.
    pub(super) fn symmetric(&self) -> Option<MomentSection<R, D, true>> {
        // A moment that vanishes may have a derivative that does not.
        if R::ORDER > 0 {
            return None;
        }
        let small = R::lit(64.0 * R::EPSILON);
        // Against the even moments that bound it, by Cauchy and Schwarz.
        let root = |a: R| Field::sqrt(a.abs());
        let vanishes = |odd: R, a: R, b: R| odd.abs() <= root(a) * root(b) * small;
        for k in 0..D {
            for l in 0..D {
                for a in 1..D {
                    let [shear, coupling] = [&self.shear[a], &self.coupling[a]];
                    if is_odd(&[k, l])
                        && !(vanishes(shear[k][l], shear[k][k], shear[l][l])
                            && vanishes(coupling[k][l], coupling[k][k], coupling[l][l]))
                    {
                        return None;
                    }
                }
                for m in 0..D {
                    for n in 0..D {
                        let bounds = (self.axial[k][l][k][l], self.axial[m][n][m][n]);
                        let odd = self.axial[k][l][m][n];
                        if is_odd(&[k, l, m, n]) && !vanishes(odd, bounds.0, bounds.1) {
                            return None;
                        }
                    }
                }
            }
        }
        Some(MomentSection {
            axial: self.axial,
            coupling: self.coupling,
            shear: self.shear,
            across: self.across,
        })
    }
}

/// Whether a product of the factors `(1, y[, z])` with these indices is odd in one of them.
#[inline(always)]
const fn is_odd<const N: usize>(indices: &[usize; N]) -> bool {
    let (mut y, mut z, mut i) = (false, false, 0);
    while i < N {
        y ^= indices[i] == 1;
        z ^= indices[i] == 2;
        i += 1;
    }
    y || z
}

/// The state of a station: vectors, terms of the strain, and the stresses conjugate to them.
struct Station<T, const D: usize> {
    /// Vectors of the first gradient column.
    p: [[T; D]; D],
    /// Cross slopes; entry 0 is not used.
    c: [[T; D]; D],
    /// Terms `kl` of the axial strain for `k <= l`, those of `kl` and `lk` in one.
    axial: [[T; D]; D],
    /// Terms `[a][k]` of the shear strain `2 E_xa`.
    shear: [[T; D]; D],
    /// Strain across the beam, and the axial strain on the axis.
    strain: [[T; D]; D],
    /// Conjugate to the axial terms, for `k <= l`.
    tension: [[T; D]; D],
    /// Conjugate to the shear terms.
    drag: [[T; D]; D],
    /// Conjugate to the strain across, for `a <= b`.
    stress: [[T; D]; D],
}

impl<R: Real, const D: usize, const SYMMETRIC: bool> MomentSection<R, D, SYMMETRIC> {
    /// Whether the moment of these factors vanishes by symmetry.
    #[inline(always)]
    fn vanishes<const N: usize>(indices: [usize; N]) -> bool {
        SYMMETRIC && is_odd(&indices)
    }

    #[inline(always)]
    fn station<T: Algebra<R>, const K: usize>(
        &self,
        reference: &[[R; D]; K],
        h: &[[T; D]; K],
    ) -> Station<T, D> {
        const {
            assert!(
                K == 2 * D - 1,
                "r', D - 1 cross slopes and their derivatives"
            )
        };
        let (half, two) = (R::lit(0.5), R::lit(2.0));
        let zero = [[T::zero(); D]; D];
        let initial: [[R; D]; D] = array(|a| reference[a]);
        let displacement: [[T; D]; D] = array(|a| h[a]);
        let strain = green_lagrange(&initial, &displacement);
        let c: [[T; D]; D] = array(|a| array(|i| T::lift(initial[a][i]) + h[a][i]));
        // The derivatives of the slopes have no reference value.
        let p: [[T; D]; D] = array(|k| match k {
            0 => c[0],
            _ => h[first_column::<D>(k)],
        });
        let (mut axial, mut shear) = (zero, zero);
        axial[0][0] = strain[0][0];
        for l in 1..D {
            axial[0][l] = dot(&p[0], &p[l]);
            axial[l][l] = dot(&p[l], &p[l]).times(half);
            for k in 1..l {
                axial[k][l] = dot(&p[k], &p[l]);
            }
            shear[l][0] = strain[0][l].times(two);
            for k in 1..D {
                shear[l][k] = dot(&c[l], &p[k]);
            }
        }
        let (mut tension, mut drag, mut stress) = (zero, zero, zero);
        for k in 0..D {
            for l in k..D {
                let mut sum = T::zero();
                for m in 0..D {
                    for n in m..D {
                        if !Self::vanishes([k, l, m, n]) {
                            sum = sum.plus_times(self.axial[k][l][m][n], axial[m][n]);
                        }
                    }
                }
                if !Self::vanishes([k, l]) {
                    for a in 1..D {
                        sum = sum.plus_times(self.coupling[a][k][l], strain[a][a]);
                    }
                }
                tension[k][l] = sum;
            }
        }
        for a in 1..D {
            for k in 0..D {
                for l in 0..D {
                    if Self::vanishes([k, l]) {
                        continue;
                    }
                    drag[a][k] = drag[a][k].plus_times(self.shear[a][k][l], shear[a][l]);
                    if l >= k {
                        stress[a][a] = stress[a][a].plus_times(self.coupling[a][k][l], axial[k][l]);
                    }
                }
            }
            for b in 1..D {
                stress[a][a] = stress[a][a].plus_times(self.across.normal[a][b], strain[b][b]);
                if b > a {
                    stress[a][b] = strain[a][b].times(two * self.across.shear[a][b]);
                }
            }
        }
        Station {
            p,
            c,
            axial,
            shear,
            strain,
            tension,
            drag,
            stress,
        }
    }
}

impl<R: Real, const D: usize, const SYMMETRIC: bool> MomentSection<R, D, SYMMETRIC> {
    /// The station half way between two states with the mean of their stresses, and viscous ones, and
    /// the station at the end.
    #[inline(always)]
    fn midway<T: Algebra<R>, const K: usize>(
        &self,
        viscosity: R,
        reference: &[[R; D]; K],
        from: &[[T; D]; K],
        to: &[[T; D]; K],
    ) -> [Station<T, D>; 2] {
        let half = R::lit(0.5);
        let (old, new) = (self.station(reference, from), self.station(reference, to));
        let mean = |old: &[[T; D]; D], new: &[[T; D]; D]| {
            array(|a| {
                array(|b| old[a][b].times(half - viscosity) + new[a][b].times(half + viscosity))
            })
        };
        let mut middle = self.station(reference, &between(from, to, half));
        middle.tension = mean(&old.tension, &new.tension);
        middle.drag = mean(&old.drag, &new.drag);
        middle.stress = mean(&old.stress, &new.stress);
        [middle, new]
    }
}

impl<T: Scalar, const D: usize> Station<T, D> {
    #[inline(always)]
    fn resultants<const K: usize>(&self) -> [[T; D]; K] {
        let mut n = [[T::zero(); D]; K];
        for k in 0..D {
            let force = &mut n[first_column::<D>(k)];
            for l in 0..D {
                add_scaled(force, self.tension[k.min(l)][k.max(l)], &self.p[l]);
            }
            for a in 1..D {
                add_scaled(force, self.drag[a][k], &self.c[a]);
            }
        }
        for a in 1..D {
            for b in 1..D {
                add_scaled(&mut n[a], self.stress[a.min(b)][a.max(b)], &self.c[b]);
            }
            for k in 0..D {
                add_scaled(&mut n[a], self.drag[a][k], &self.p[k]);
            }
        }
        n
    }
}

impl<R, const D: usize, const K: usize, const SYMMETRIC: bool> SectionLaw<R, D, K>
    for MomentSection<R, D, SYMMETRIC>
where
    R: Real,
{
    #[inline(always)]
    fn energy<T: Algebra<R>>(&self, reference: &[[R; D]; K], h: &[[T; D]; K]) -> T {
        let s = self.station(reference, h);
        let mut twice = T::zero();
        for k in 0..D {
            for l in k..D {
                twice = twice.plus_product(s.tension[k][l], s.axial[k][l]);
            }
            for a in 1..D {
                twice = twice.plus_product(s.drag[a][k], s.shear[a][k]);
            }
        }
        for a in 1..D {
            twice = twice.plus_product(s.stress[a][a], s.strain[a][a]);
            for b in a + 1..D {
                let both = s.strain[a][b].times(R::lit(2.0));
                twice = twice.plus_product(s.stress[a][b], both);
            }
        }
        twice.times(R::lit(0.5))
    }

    #[inline(always)]
    fn resultants<T: Algebra<R>>(&self, reference: &[[R; D]; K], h: &[[T; D]; K]) -> [[T; D]; K] {
        self.station(reference, h).resultants()
    }

    fn has_strain(&self) -> bool {
        true
    }

    /// The mean stress on the gradient half way, as at section points.
    #[inline(always)]
    fn secant<T: Algebra<R>>(
        &self,
        viscosity: R,
        reference: &[[R; D]; K],
        from: &[[T; D]; K],
        to: &[[T; D]; K],
    ) -> [[T; D]; K] {
        let [midway, _] = self.midway(viscosity, reference, from, to);
        midway.resultants()
    }

    /// Every stress adds the derivative of its mean, by the gradient at the end, on the gradient half
    /// way, and half of itself on the derivative of that.
    #[inline]
    fn secant_stiffness<T: Algebra<R>>(
        &self,
        viscosity: R,
        reference: &[[R; D]; K],
        from: &[[T; D]; K],
        to: &[[T; D]; K],
    ) -> SectionStiffness<T, D, K> {
        let [midway, end] = self.midway(viscosity, reference, from, to);
        let (p, c) = (&end.p, &end.c);
        let mut stiffness = [[[[T::zero(); D]; D]; K]; K];
        let share = R::lit(0.5) + viscosity;
        // What a stress couples: two sampled vectors, each forced along the other.
        let mut add = |stress: T, pair: [(usize, &[T; D]); 2], slope: &[[T; D]; K]| {
            let [(row, along), (other, back)] = pair;
            for x in 0..K {
                for i in 0..D {
                    add_scaled(&mut stiffness[row][x][i], along[i], &slope[x]);
                    if row != other {
                        add_scaled(&mut stiffness[other][x][i], back[i], &slope[x]);
                    }
                }
            }
            let half = stress.times(R::lit(0.5));
            for i in 0..D {
                stiffness[row][other][i][i] += half;
                if row != other {
                    stiffness[other][row][i][i] += half;
                }
            }
        };
        for k in 0..D {
            for l in k..D {
                let mut slope = [[T::zero(); D]; K];
                for m in 0..D {
                    for n in 0..D {
                        if !Self::vanishes([k, l, m, n]) {
                            let modulus = share * self.axial[k][l][m][n];
                            add_times(&mut slope[first_column::<D>(m)], modulus, &p[n]);
                        }
                    }
                }
                if !Self::vanishes([k, l]) {
                    for a in 1..D {
                        add_times(&mut slope[a], share * self.coupling[a][k][l], &c[a]);
                    }
                }
                let [one, other] = [k, l].map(first_column::<D>);
                let pair = [(one, &midway.p[l]), (other, &midway.p[k])];
                add(midway.tension[k][l], pair, &slope);
            }
        }
        for a in 1..D {
            for k in 0..D {
                let mut slope = [[T::zero(); D]; K];
                for l in 0..D {
                    if !Self::vanishes([k, l]) {
                        let modulus = share * self.shear[a][k][l];
                        add_times(&mut slope[a], modulus, &p[l]);
                        add_times(&mut slope[first_column::<D>(l)], modulus, &c[a]);
                    }
                }
                let pair = [(first_column::<D>(k), &midway.c[a]), (a, &midway.p[k])];
                add(midway.drag[a][k], pair, &slope);
            }
            for b in a..D {
                let mut slope = [[T::zero(); D]; K];
                if b > a {
                    let modulus = share * self.across.shear[a][b];
                    add_times(&mut slope[a], modulus, &c[b]);
                    add_times(&mut slope[b], modulus, &c[a]);
                } else {
                    for m in 0..D {
                        for n in 0..D {
                            if !Self::vanishes([m, n]) {
                                let modulus = share * self.coupling[a][m][n];
                                add_times(&mut slope[first_column::<D>(m)], modulus, &p[n]);
                            }
                        }
                        if m > 0 {
                            add_times(&mut slope[m], share * self.across.normal[a][m], &c[m]);
                        }
                    }
                }
                let pair = [(a, &midway.c[b]), (b, &midway.c[a])];
                add(midway.stress[a][b], pair, &slope);
            }
        }
        stiffness
    }

    #[inline(always)]
    fn stiffness<T: Algebra<R>>(
        &self,
        reference: &[[R; D]; K],
        h: &[[T; D]; K],
        stiffness: &mut SectionStiffness<T, D, K>,
    ) -> [[T; D]; K] {
        let s = self.station(reference, h);
        let (p, c) = (&s.p, &s.c);
        for i in 0..D {
            for j in i..D {
                // Symmetric blocks: products of the first column with itself, in all their pairs.
                let mut pp = [[T::zero(); D]; D];
                for m in 0..D {
                    pp[m][m] = p[m][i] * p[m][j];
                    for n in m + 1..D {
                        pp[m][n] = (p[m][i] * p[n][j]).plus_product(p[n][i], p[m][j]);
                    }
                }
                let cc: [T; D] = array(|a| c[a][i] * c[a][j]);
                for k in 0..D {
                    for l in k..D {
                        let mut sum = if i == j { s.tension[k][l] } else { T::zero() };
                        for m in 0..D {
                            for n in m..D {
                                if !Self::vanishes([k, l, m, n]) {
                                    sum = sum.plus_times(self.axial[k][l][m][n], pp[m][n]);
                                }
                            }
                        }
                        if !Self::vanishes([k, l]) {
                            for a in 1..D {
                                sum = sum.plus_times(self.shear[a][k][l], cc[a]);
                            }
                        }
                        let block = &mut stiffness[first_column::<D>(k)][first_column::<D>(l)];
                        block[i][j] = sum;
                        block[j][i] = sum;
                    }
                }
                for a in 1..D {
                    let mut sum = if i == j { s.stress[a][a] } else { T::zero() };
                    for m in 0..D {
                        for n in m..D {
                            if !Self::vanishes([m, n]) {
                                sum = sum.plus_times(self.shear[a][m][n], pp[m][n]);
                            }
                        }
                    }
                    for b in 1..D {
                        let modulus = match a == b {
                            true => self.across.normal[a][a],
                            false => self.across.shear[a][b],
                        };
                        sum = sum.plus_times(modulus, cc[b]);
                    }
                    stiffness[a][a][i][j] = sum;
                    stiffness[a][a][j][i] = sum;
                }
            }
        }
        for a in 1..D {
            for b in a + 1..D {
                for i in 0..D {
                    let mut row = [T::zero(); D];
                    row[i] = s.stress[a][b];
                    add_scaled(&mut row, c[a][i].times(self.across.normal[a][b]), &c[b]);
                    add_scaled(&mut row, c[b][i].times(self.across.shear[a][b]), &c[a]);
                    stiffness[a][b][i] = row;
                }
            }
            for k in 0..D {
                let (mut sheared, mut coupled) = ([T::zero(); D], [T::zero(); D]);
                for l in 0..D {
                    if !Self::vanishes([k, l]) {
                        add_times(&mut sheared, self.shear[a][k][l], &p[l]);
                        add_times(&mut coupled, self.coupling[a][k][l], &p[l]);
                    }
                }
                for i in 0..D {
                    for j in 0..D {
                        let mut sum = if i == j { s.drag[a][k] } else { T::zero() };
                        sum = sum.plus_product(c[a][i], sheared[j]);
                        sum = sum.plus_product(coupled[i], c[a][j]);
                        // The column of k comes first in the pair with r' only.
                        match k {
                            0 => stiffness[0][a][i][j] = sum,
                            _ => stiffness[a][first_column::<D>(k)][j][i] = sum,
                        }
                    }
                }
            }
        }
        s.resultants()
    }
}
