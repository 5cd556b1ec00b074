//! The kernel of materials with constant elasticity. Green-Lagrange strain is linear in the scalar
//! products of an element's nodal vectors, at every point and whatever the element, its reference
//! shape and its section are: the strain energy is a quadratic form in the changes of these products.
//! The rule is run once, when the kernel is made; exact sections, reduced rules and a Poisson part on
//! the axis alone differ in the numbers of the form only and cost the same.

use std::ops::Range;

use super::basis::Basis;
use super::point::{first_column, material_frame};
use super::products::{Products, Square, Vectors, vanishes};
use super::sampled::Sample;
use super::{ElementKernel, KernelWork, Reference, Tangent, mirrored};
use crate::element::Element;
use crate::material::Moduli;
use crate::quadrature::Cubature;
use crate::scalar::{Algebra, Real};
use crate::tensor::{add_scaled, add_times, array, between, sum, times};

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

/// The quadratic form while parts are added to it: between the pairs `i <= j` of nodal vectors, numbered
/// row by row, those `[p][q]` with `p <= q`, for the form is symmetric.
pub(super) struct Form<R, const D: usize, const S: usize>(Vec<R>);

/// How many pairs `i <= j` of vectors there are.
const fn pairs(vectors: usize) -> usize {
    vectors * (vectors + 1) / 2
}

impl<R: Real, const D: usize, const S: usize> Form<R, D, S> {
    pub(super) fn new() -> Self {
        Self(vec![R::zero(); pairs(S) * pairs(S)])
    }

    /// Adds constant moduli at the section points `(0, y[, z])` (m) with weights (m^2), at the
    /// points of `axial`, a rule on [0, 1] along the element. `K = 2 D - 1` samples as those of
    /// [`PointSection`](super::PointSection).
    pub(super) fn add<E: Element<D, S>, const K: usize>(
        &mut self,
        (element, reference): (&E, &Reference<R, D, S>),
        samples: [Sample; K],
        axial: &Cubature<R, 1>,
        moduli: &Moduli<R, D>,
        points: &[([R; D], R)],
    ) {
        let basis = Basis::of::<E, D, S>(reference.length);
        let mut strain = Vec::with_capacity(pairs(S));
        for ([xi], along) in axial.iter() {
            let mut axis = [R::zero(); D];
            axis[0] = xi;
            let absolute = samples.map(|sample| sample.of(element, reference.length, axis));
            let mut rows = absolute;
            rows.iter_mut().for_each(|row| basis.change_row(row));
            for (y, area) in points {
                let mut weight = along * reference.length * *area;
                let mut columns = gradient_rows(&rows, y);
                if !reference.is_straight() {
                    let initial = gradient_rows(&absolute, y).map(|row| {
                        let mut g = [R::zero(); D];
                        for i in 0..S {
                            add_scaled(&mut g, row[i], &reference.vectors[i]);
                        }
                        g
                    });
                    let (map, volume) = material_frame(&initial);
                    weight *= volume;
                    columns = array(|a| {
                        array(|i| (0..D).fold(R::zero(), |s, k| s + map[a][k] * columns[k][i]))
                    });
                }
                self.add_point(moduli, &columns, weight, &mut strain);
            }
        }
    }

    /// Adds a point at which column `a` of the gradient is `sum_i columns[a][i] v_i`. `strain` is room.
    fn add_point(
        &mut self,
        moduli: &Moduli<R, D>,
        columns: &[[R; S]; D],
        weight: R,
        strain: &mut Vec<(usize, R)>,
    ) {
        let all = || (0..S).flat_map(|i| (i..S).map(move |j| (i, j))).enumerate();
        for (a, b) in (0..D).flat_map(|a| (a..D).map(move |b| (a, b))) {
            strain.clear();
            for (q, (i, j)) in all() {
                let value = strain_of(columns, [a, b], i, j);
                if !value.is_nothing() {
                    strain.push((q, value));
                }
            }
            for (p, (i, j)) in all() {
                let stress = weight
                    * match a == b {
                        true => (0..D).fold(R::zero(), |s, c| {
                            s + moduli.normal[a][c] * strain_of(columns, [c, c], i, j)
                        }),
                        false => moduli.shear[a][b] * strain_of(columns, [a, b], i, j),
                    };
                if stress.is_nothing() {
                    continue;
                }
                let form = &mut self.0[p * pairs(S)..][..pairs(S)];
                let from = strain.partition_point(|(q, _)| *q < p);
                for (q, strain) in &strain[from..] {
                    form[*q] += stress * *strain;
                }
            }
        }
    }

    /// Which products couple, by groups, and the forms of these.
    fn groups(&self) -> (Vec<Group>, Vec<R>) {
        let small = R::lit(64.0 * R::EPSILON);
        let all: Vec<_> = (0..S).flat_map(|i| (i..S).map(move |j| (i, j))).collect();
        let raw = |p: usize, q: usize| {
            // One triangle, so that the form is symmetric to the last digit.
            self.0[p.min(q) * pairs(S) + p.max(q)]
        };
        let entry = |p: usize, q: usize| {
            // Rounding of what cancels; but an entry that vanishes may have a derivative that does not.
            let bound = small * raw(p, p).abs().sqrt() * raw(q, q).abs().sqrt();
            match R::ORDER {
                0 => R::zero().where_else(raw(p, q).abs().at_most(bound), raw(p, q)),
                _ => raw(p, q),
            }
        };
        let couples = |p: usize, q: usize| !vanishes(entry(p, q));
        let met = |p: &usize| (0..all.len()).any(|q| couples(*p, q));
        let mut left: Vec<usize> = (0..all.len()).filter(met).collect();
        let (mut groups, mut form) = (Vec::new(), Vec::new());
        while let Some(first) = left.first().copied() {
            let mut group = vec![first];
            left.remove(0);
            let mut n = 0;
            while n < group.len() {
                let (more, others) = left.iter().partition(|q| couples(group[n], **q));
                left = others;
                group.extend::<Vec<usize>>(more);
                n += 1;
            }
            group.sort_unstable_by_key(|p| (all[*p].0 != all[*p].1, *p));
            let place = |(i, j): (usize, usize)| if i == j { i } else { j * S + i };
            groups.push(Group {
                pairs: group.iter().map(|p| all[*p].0 * S + all[*p].1).collect(),
                own: group.iter().filter(|p| all[**p].0 == all[**p].1).count(),
                changes: group.iter().map(|p| place(all[*p])).collect(),
                form: form.len(),
            });
            for p in &group {
                form.extend(group.iter().map(|q| entry(*p, *q)));
            }
        }
        (groups, form)
    }

    /// The kernel with the energy of what was added.
    pub(super) fn kernel<E: Element<D, S>, P: Products<R, D, S>>(
        &self,
        reference: &Reference<R, D, S>,
    ) -> GramKernel<R, P, D, S> {
        let basis = Basis::of::<E, D, S>(reference.length);
        let (groups, mut form) = self.groups();
        let terms = Terms::new::<R, S>(&groups, &form);
        form.push(R::zero());
        let pairs: Vec<usize> = groups.iter().flat_map(|g| &g.pairs).copied().collect();
        let met = |i| pairs.iter().any(|pair| pair / S == i || pair % S == i);
        let vectors = Vectors::new(basis, reference, array(met));
        GramKernel {
            products: P::new(&vectors),
            vectors,
            groups,
            form,
            terms,
        }
    }
}

/// How a strain depends on a product: `E_aa`, and `2 E_ab`.
#[inline(always)]
fn strain_of<R: Real, const D: usize, const S: usize>(
    columns: &[[R; S]; D],
    [a, b]: [usize; 2],
    i: usize,
    j: usize,
) -> R {
    match a == b {
        true => columns[a][i] * columns[a][j],
        false => columns[a][i] * columns[b][j] + columns[a][j] * columns[b][i],
    }
}

/// Rows of the gradient's columns at a section point over nodal vectors.
fn gradient_rows<R: Real, const D: usize, const S: usize, const K: usize>(
    rows: &[[R; S]; K],
    y: &[R; D],
) -> [[R; S]; D] {
    let mut columns: [[R; S]; D] = array(|a| rows[a]);
    for m in 1..D {
        add_scaled(&mut columns[0], y[m], &rows[first_column::<D>(m)]);
    }
    columns
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
