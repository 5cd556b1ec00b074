//! The kernel of materials with constant elasticity. Green-Lagrange strain is linear in the scalar
//! products of an element's nodal vectors, at every point and whatever the element, its reference
//! shape and its section are: the strain energy is a quadratic form in the changes of these products.
//! The rule is run once, when the kernel is made; exact sections, reduced rules and a Poisson part on
//! the axis alone differ in the numbers of the form only and cost the same.

mod form;

use std::ops::Range;

use super::products::{Products, Square, Vectors, vanishes};
use super::{ElementKernel, KernelWork, Tangent, mirrored};
use crate::scalar::{Algebra, Real};
use crate::tensor::{add_scaled, add_times, array, between, sum, times};
pub(super) use form::Form;

/// Scalar products that couple with one another, and with no others: where a section is symmetric,
/// stretching, bending about each axis and torsion part.
#[derive(Debug, Clone, PartialEq)]
struct Group {
    /// Pairs `i <= j` of nodal vectors, as `i S + j`: first those of vectors with themselves.
    pairs: Vec<usize>,
    /// Where the changes of the products are in a [`Square`]: of how many vectors with themselves, as `i`,
    /// and of others, as `j S + i`.
    own: usize,
    changes: Vec<usize>,
    /// Where the quadratic form over them (J) starts, row by row.
    form: usize,
}

/// Right vectors of a term: those of a vector that is quadratic along the element.
const WIDE: usize = 3;

/// Places of vectors and of entries of the form: the first cache holds a kernel of packs, too, for all
/// terms with one entry share it.
type Place = u32;

/// The dyad of a nodal vector with a sum of `N` others, each with its entry of the form; filled up with
/// zeros, so that no loop is of a length of its own.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Dyad<const N: usize> {
    left: Place,
    right: [(Place, Place); N],
}

/// The block of the tangent between two nodal vectors.
#[derive(Debug, Clone, PartialEq)]
struct Block {
    row: usize,
    column: usize,
    /// Dyads of two vectors, four of five of all.
    pairs: Range<usize>,
    /// Dyads with sums.
    sums: Range<usize>,
}

/// The material part of the tangent, block by block.
#[derive(Debug, Clone, PartialEq)]
struct Terms {
    blocks: Vec<Block>,
    pairs: Vec<Dyad<1>>,
    sums: Vec<Dyad<WIDE>>,
}

/// Strain energy as half a quadratic form in the changes `g_ij = v_i . v_j - v0_i . v0_j`, halved for
/// `i = j`, of the scalar products of an element's vectors, by a basis of means and differences.
///
/// With `sigma = C g`, the force on `v_i` is `sum_j sigma_ij v_j` and its derivative by `v_j`
/// `sigma_ij I + sum_kl C_(ik)(jl) v_k v_l^T`. How changes keep their digits is told by `P`, a
/// [`Products`]. An entry of `C` below 64 rounding units of its diagonal ones is taken for rounding: in
/// single precision an eccentricity of less than `8e-6` radii of gyration is none.
#[derive(Debug, Clone)]
pub struct GramKernel<R, P, const D: usize, const S: usize> {
    products: P,
    vectors: Vectors<R, D, S>,
    groups: Vec<Group>,
    /// The forms of all groups, and a zero.
    form: Vec<R>,
    terms: Terms,
}

impl Terms {
    /// The terms of a form by groups; a zero is to follow it.
    fn new<R: Real, const S: usize>(groups: &[Group], form: &[R]) -> Self {
        let other = |pair: usize, of: usize| match (pair / S == of, pair % S == of) {
            (true, _) => Some(pair % S),
            (_, true) => Some(pair / S),
            _ => None,
        };
        let place = |at: usize| at as Place;
        let (mut blocks, mut pairs, mut sums) = (Vec::new(), Vec::new(), Vec::new());
        let mut rights = Vec::new();
        for (row, column) in (0..S).flat_map(|row| (row..S).map(move |column| (row, column))) {
            let (first_pair, first_sum) = (pairs.len(), sums.len());
            for group in groups {
                for (p, pair) in group.pairs.iter().enumerate() {
                    let Some(left) = other(*pair, row) else {
                        continue;
                    };
                    rights.clear();
                    for (q, pair) in group.pairs.iter().enumerate() {
                        let at = group.form + p * group.pairs.len() + q;
                        if let Some(right) = other(*pair, column).filter(|_| !vanishes(form[at])) {
                            rights.push((place(right), place(at)));
                        }
                    }
                    let left = place(left);
                    for some in rights.chunks(WIDE) {
                        if let [right] = some {
                            let right = [*right];
                            pairs.push(Dyad { left, right });
                            continue;
                        }
                        let mut right = [(left, place(form.len())); WIDE];
                        right[..some.len()].copy_from_slice(some);
                        sums.push(Dyad { left, right });
                    }
                }
            }
            blocks.push(Block {
                row,
                column,
                pairs: first_pair..pairs.len(),
                sums: first_sum..sums.len(),
            });
        }
        Self {
            blocks,
            pairs,
            sums,
        }
    }

    /// Adds the dyads of a block, of vectors out of two sets.
    #[inline(always)]
    fn add_dyads<R: Real, T: Algebra<R>, const D: usize, const S: usize>(
        &self,
        form: &[R],
        of: &Block,
        sets: (&[[T; D]; S], &[[T; D]; S]),
        block: &mut [[T; D]; D],
    ) {
        assert!(!form.is_empty(), "a form ends with a zero");
        for dyad in &self.pairs[of.pairs.clone()] {
            dyad.add(form, sets, block);
        }
        for dyad in &self.sums[of.sums.clone()] {
            dyad.add(form, sets, block);
        }
    }
}

impl<const N: usize> Dyad<N> {
    #[inline(always)]
    fn add<R: Real, T: Algebra<R>, const D: usize, const S: usize>(
        &self,
        form: &[R],
        (lefts, rights): (&[[T; D]; S], &[[T; D]; S]),
        block: &mut [[T; D]; D],
    ) {
        // The minima are identities; they let the optimiser drop the bounds checks.
        let last = form.len() - 1;
        let vector = |at: Place| (at as usize).min(S - 1);
        let value = |at: Place| form[(at as usize).min(last)];
        let [(first, at), others @ ..] = &self.right[..] else {
            return;
        };
        let mut along = times(value(*at), &rights[vector(*first)]);
        for (right, at) in others {
            add_times(&mut along, value(*at), &rights[vector(*right)]);
        }
        let left = &lefts[vector(self.left)];
        for c in 0..D {
            add_scaled(&mut block[c], left[c], &along);
        }
    }
}

/// Products that go through the form at once.
const ROWS: usize = 4;

/// What is conjugate to the `N` products of some pairs of a group: rows of the form times changes.
#[inline(always)]
fn stress_of<R: Real, T: Algebra<R>, const S: usize, const N: usize>(
    group: &Group,
    rows: &[R],
    pairs: &[usize],
    square: &mut Square<T, S>,
) {
    // The minima are identities; they let the optimiser drop the bounds checks.
    let (count, last) = (group.changes.len(), S * S - 1);
    let (own, others) = group.changes.split_at(group.own);
    let by_own: [&[R]; N] = array(|r| &rows[r * count..][..own.len()]);
    let by_others: [&[R]; N] = array(|r| &rows[r * count + own.len()..][..others.len()]);
    let mut sums = [T::zero(); N];
    for m in 0..own.len() {
        let g = square.own[own[m].min(S - 1)];
        for r in 0..N {
            sums[r] = sums[r].plus_times(by_own[r][m], g);
        }
    }
    let entries = square.entries.as_flattened_mut();
    for m in 0..others.len() {
        let g = entries[others[m].min(last)];
        for r in 0..N {
            sums[r] = sums[r].plus_times(by_others[r][m], g);
        }
    }
    for r in 0..N {
        entries[pairs[r].min(last)] = sums[r];
    }
}

impl<R: Real, P: Products<R, D, S>, const D: usize, const S: usize> GramKernel<R, P, D, S> {
    /// What is conjugate to the products, from their changes.
    #[inline(always)]
    fn stress<T: Algebra<R>>(&self, square: &mut Square<T, S>) {
        for group in &self.groups {
            let count = group.pairs.len();
            let form = &self.form[group.form..][..count * count];
            for (rows, pairs) in form.chunks(ROWS * count).zip(group.pairs.chunks(ROWS)) {
                match pairs.len() {
                    ROWS => stress_of::<R, T, S, ROWS>(group, rows, pairs, square),
                    3 => stress_of::<R, T, S, 3>(group, rows, pairs, square),
                    2 => stress_of::<R, T, S, 2>(group, rows, pairs, square),
                    _ => stress_of::<R, T, S, 1>(group, rows, pairs, square),
                }
            }
        }
    }

    /// Changes of the products and what is conjugate to them, and the displaced vectors.
    #[inline(always)]
    fn strain<T: Algebra<R>>(
        &self,
        u: &[[T; D]; S],
        square: &mut Square<T, S>,
        v: &mut [[T; D]; S],
    ) {
        self.products.change(&self.vectors, u, square, v);
        self.stress(square);
    }

    /// What is conjugate to the products in the mean of a step, and the vectors at its ends.
    #[inline(always)]
    fn secant_stress<T: Algebra<R>>(
        &self,
        viscosity: R,
        ends: [&[[T; D]; S]; 2],
    ) -> ([[T; S]; S], [[[T; D]; S]; 2]) {
        let half = R::lit(0.5);
        let mut changes = [Square::new(); 2];
        let mut vectors = [[[T::zero(); D]; S]; 2];
        for end in 0..2 {
            let (g, v) = (&mut changes[end], &mut vectors[end]);
            self.products.change(&self.vectors, ends[end], g, v);
        }
        let [mut old, mut square] = changes;
        for i in 0..S {
            for j in i..S {
                let (g, old) = (square.change(i, j), *old.change(i, j));
                *g = g.times(half + viscosity) + old.times(half - viscosity);
            }
        }
        self.stress(&mut square);
        (square.entries, vectors)
    }

    /// Overwrites the upper blocks of the tangent.
    #[inline(always)]
    fn upper_of<T: Algebra<R>>(
        &self,
        stress: &[[T; S]; S],
        v: &[[T; D]; S],
        k: &mut Tangent<T, D, S>,
    ) {
        for block in &self.terms.blocks {
            let (i, j) = (block.row.min(S - 1), block.column.min(S - 1));
            let mut sum = [[T::zero(); D]; D];
            for c in 0..D {
                sum[c][c] = stress[i][j];
            }
            let terms = &self.terms;
            terms.add_dyads(&self.form, block, (v, v), &mut sum);
            for c in 0..D {
                k[i][c][j] = sum[c];
            }
        }
        self.vectors.basis.change_upper(k);
    }

    /// Adds the force on nodal vectors.
    #[inline(always)]
    fn add_force<T: Algebra<R>>(&self, stress: &[[T; S]; S], v: &[[T; D]; S], q: &mut [[T; D]; S]) {
        let mut force = [[T::zero(); D]; S];
        // Two rows at a time, which share what is loaded of the vectors.
        for i in (0..S).step_by(2) {
            let next = (i + 1).min(S - 1);
            let mut rows = [[T::zero(); D]; 2];
            for j in 0..S {
                add_scaled(&mut rows[0], stress[i.min(j)][i.max(j)], &v[j]);
                add_scaled(&mut rows[1], stress[next.min(j)][next.max(j)], &v[j]);
            }
            force[i] = rows[0];
            force[next] = rows[1];
        }
        self.vectors.basis.change_force(&mut force);
        for i in 0..S {
            q[i] = sum(&q[i], &force[i]);
        }
    }
}

impl<R: Real, P: Products<R, D, S>, const D: usize, const S: usize> ElementKernel<R, D, S>
    for GramKernel<R, P, D, S>
{
    #[inline(always)]
    fn dispatch<W: KernelWork<R, D, S>>(&self, work: W) -> W::Output {
        work.run_in_lanes(self)
    }

    #[inline(always)]
    fn energy<T: Algebra<R>>(&self, u: &[[T; D]; S]) -> T {
        let (mut square, mut v) = (Square::new(), [[T::zero(); D]; S]);
        self.strain(u, &mut square, &mut v);
        let mut twice = T::zero();
        for i in 0..S {
            for j in i..S {
                let change = *square.change(i, j);
                twice = twice.plus_product(change, square.entries[i][j]);
            }
        }
        twice.times(R::lit(0.5))
    }

    #[inline(always)]
    fn force<T: Algebra<R>>(&self, u: &[[T; D]; S], q: &mut [[T; D]; S]) {
        // Written in place: arrays of lanes are long.
        let (mut square, mut v) = (Square::new(), [[T::zero(); D]; S]);
        self.strain(u, &mut square, &mut v);
        let stress = &square.entries;
        self.add_force(stress, &v, q);
    }

    #[inline(always)]
    fn tangent<T: Algebra<R>>(
        &self,
        u: &[[T; D]; S],
        q: &mut [[T; D]; S],
        k: &mut Tangent<T, D, S>,
    ) {
        let (mut square, mut v) = (Square::new(), [[T::zero(); D]; S]);
        self.strain(u, &mut square, &mut v);
        self.add_force(&square.entries, &v, q);
        mirrored(
            k,
            #[inline(always)]
            |upper| self.upper_of(&square.entries, &v, upper),
        );
    }

    #[inline(always)]
    fn upper_tangent<T: Algebra<R>>(&self, u: &[[T; D]; S], k: &mut Tangent<T, D, S>) {
        let (mut square, mut v) = (Square::new(), [[T::zero(); D]; S]);
        self.strain(u, &mut square, &mut v);
        self.upper_of(&square.entries, &v, k);
    }

    fn has_strain(&self) -> bool {
        true
    }

    /// The mean stress on the vectors half way (Simo and Tarnow 1992), as at section points.
    #[inline(always)]
    fn secant<T: Algebra<R>>(
        &self,
        viscosity: R,
        from: &[[T; D]; S],
        to: &[[T; D]; S],
        q: &mut [[T; D]; S],
    ) {
        let (stress, [from, to]) = self.secant_stress(viscosity, [from, to]);
        self.add_force(&stress, &between(&from, &to, R::lit(0.5)), q);
    }

    #[inline(always)]
    fn secant_tangent<T: Algebra<R>>(
        &self,
        viscosity: R,
        from: &[[T; D]; S],
        to: &[[T; D]; S],
        k: &mut Tangent<T, D, S>,
    ) {
        let half = R::lit(0.5);
        let (stress, [from, to]) = self.secant_stress(viscosity, [from, to]);
        let middle = between(&from, &to, half);
        let share = half + viscosity;
        let mut relative: Tangent<T, D, S> = [[[[T::zero(); D]; S]; D]; S];
        for block in &self.terms.blocks {
            let (i, j) = (block.row.min(S - 1), block.column.min(S - 1));
            let geometric = stress[i][j].times(half);
            let mut upper = [[T::zero(); D]; D];
            let terms = &self.terms;
            terms.add_dyads(&self.form, block, (&middle, &to), &mut upper);
            // Across the diagonal the vectors of the dyads change places.
            let mut lower = [[T::zero(); D]; D];
            terms.add_dyads(&self.form, block, (&to, &middle), &mut lower);
            for c in 0..D {
                for d in 0..D {
                    let diagonal = if c == d { geometric } else { T::zero() };
                    relative[i][c][j][d] = diagonal.plus_times(share, upper[c][d]);
                    if i != j {
                        relative[j][c][i][d] = diagonal.plus_times(share, lower[d][c]);
                    }
                }
            }
        }
        self.vectors.basis.change_tangent(&mut relative);
        let sums = k.as_flattened_mut().as_flattened_mut();
        for (k, row) in sums.iter_mut().zip(relative.as_flattened().as_flattened()) {
            *k = sum(k, row);
        }
    }
}
