//! The kernel of materials with constant elasticity. Green-Lagrange strain is linear in the scalar
//! products of an element's nodal vectors, at every point and whatever the element, its reference
//! shape and its section are: the strain energy is a quadratic form in the changes of these products.
//! The rule is run once, when the kernel is made; exact sections, reduced rules and a Poisson part on
//! the axis alone differ in the numbers of the form only and cost the same.

mod form;

use std::marker::PhantomData;
use std::ops::Range;

use super::products::{Products, Vectors, vanishes};
use super::{ElementKernel, Tangent, Together, mirrored};
use crate::material::Material;
use crate::scalar::{Algebra, Real, Scalar};
use crate::tensor::{Pairs, Room, Stack, add_scaled, add_times, between, sum, times};
pub(super) use form::Form;

/// Scalar products that couple with one another, and with no others: where a section is symmetric,
/// stretching, bending about each axis and torsion part.
#[derive(Debug, Clone, PartialEq)]
struct Group {
    /// Pairs `i <= j` of nodal vectors: first those of vectors with themselves.
    pairs: Vec<(usize, usize)>,
    /// Where the quadratic form over them (J) starts: [`ROWS`] rows at a time, column by column.
    form: usize,
}

impl Group {
    /// Where an entry of the form is.
    fn place(&self, row: usize, column: usize) -> usize {
        let (first, count) = (row / ROWS * ROWS, self.pairs.len());
        self.form + first * count + column * ROWS.min(count - first) + row - first
    }
}

/// Products that go through the form at once.
const ROWS: usize = 4;

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
    /// What is conjugate to the product of the two, or a zero.
    stress: Place,
    /// Dyads of two vectors, four of five of all.
    pairs: Range<usize>,
    /// Dyads with sums.
    sums: Range<usize>,
}

/// What is computed from changes: stress, the force on each nodal vector, and the tangent block by block.
#[derive(Debug, Clone, PartialEq)]
struct Terms {
    /// How many products couple, group by group, as their forms and changes follow each other.
    groups: Vec<usize>,
    /// Vectors of which strain is made, from the first to the last: all but the first position of a
    /// complete element.
    met: Range<usize>,
    /// Where what is conjugate to the product of two vectors is, or a zero: for forces on some vectors at
    /// once, by those they are sums of.
    forces: Vec<Place>,
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
///
/// Kernels of all materials are alike; the type `M` tells that there are none of a material that is sampled.
#[derive(Debug, Clone)]
pub struct GramKernel<R, M, P, const D: usize, const S: usize> {
    material: PhantomData<fn() -> M>,
    products: P,
    vectors: Vectors<R, D, S>,
    /// The forms of all groups, and a zero.
    form: Vec<R>,
    terms: Terms,
}

impl Terms {
    /// The terms of a form by groups; a zero is to follow it. Forces are summed so many `at_once`.
    fn new<R: Real, const S: usize>(groups: &[Group], form: &[R], at_once: usize) -> Self {
        let other = |(i, j): (usize, usize), of: usize| match (i == of, j == of) {
            (true, _) => Some(j),
            (_, true) => Some(i),
            _ => None,
        };
        let place = |at: usize| at as Place;
        let all: Vec<_> = groups.iter().flat_map(|group| &group.pairs).collect();
        let place_of = |i: usize, j: usize| {
            let pair = (i.min(j), i.max(j));
            place(all.iter().position(|p| **p == pair).unwrap_or(all.len()))
        };
        let strained = |i: &usize| all.iter().any(|(a, b)| a == i || b == i);
        let first = (0..S).find(strained).unwrap_or(S);
        let met = first..(first..S).rfind(strained).map_or(S, |last| last + 1);
        let rows: Vec<usize> = (0..S).collect();
        let (whole, rest) = rows.split_at(S / at_once * at_once);
        let mut forces = Vec::new();
        for rows in whole.chunks(at_once).chain(rest.chunks(1)) {
            let columns = met.clone();
            forces.extend(columns.flat_map(|j| rows.iter().map(move |i| place_of(*i, j))));
        }
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
                        let at = group.place(p, q);
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
                stress: place_of(row, column),
                pairs: first_pair..pairs.len(),
                sums: first_sum..sums.len(),
            });
        }
        Self {
            groups: groups.iter().map(|group| group.pairs.len()).collect(),
            forces,
            met,
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

/// What is conjugate to `N` products, from their changes: rows of a form, which goes on with others.
#[inline(always)]
fn stress_of<R: Real, T: Algebra<R>, const N: usize>(form: &mut &[R], changes: &[T]) -> [T; N] {
    let (columns, rest) = form.split_at(N * changes.len());
    *form = rest;
    let mut sums = [T::zero(); N];
    for (column, change) in columns.as_chunks::<N>().0.iter().zip(changes) {
        for r in 0..N {
            sums[r] = sums[r].plus_times(column[r], *change);
        }
    }
    sums
}

/// Forces on `N` vectors, from the places of what is conjugate to their products with the vectors `v`.
#[inline(always)]
fn force_on<T: Scalar, const D: usize, const N: usize>(
    places: &mut &[Place],
    stress: &[T],
    v: &[[T; D]],
) -> [[T; D]; N] {
    let last = last_of(stress);
    let (columns, rest) = places.split_at(N * v.len());
    *places = rest;
    let mut sums = [[T::zero(); D]; N];
    for (column, v) in columns.as_chunks::<N>().0.iter().zip(v) {
        for n in 0..N {
            // The minimum is an identity; it lets the optimiser drop the bounds check.
            add_scaled(&mut sums[n], stress[(column[n] as usize).min(last)], v);
        }
    }
    sums
}

/// The last place of numbers.
///
/// # Panics
/// If there are none, so that an index of at most this many needs no check.
#[inline(always)]
fn last_of<T>(numbers: &[T]) -> usize {
    assert!(!numbers.is_empty(), "a zero is on the stack");
    numbers.len() - 1
}

impl<R, M, P, const D: usize, const S: usize> GramKernel<R, M, P, D, S>
where
    R: Real,
    P: Products<R, D, S>,
{
    /// Puts what is conjugate to the products, and a zero, on top of their changes.
    #[inline(always)]
    fn stress<T: Algebra<R>>(&self, stack: &mut Stack<'_, T>) {
        let (mut form, mut first) = (&self.form[..], 0);
        for count in &self.terms.groups {
            let group = first..first + count;
            first = group.end;
            for _ in 0..count / ROWS {
                let stress: [T; ROWS] = stress_of(&mut form, &stack.numbers()[group.clone()]);
                stack.push(stress);
            }
            let changes = &stack.numbers()[group];
            const { assert!(ROWS == 4, "an arm for each rest") };
            match count % ROWS {
                3 => stack.push(stress_of::<R, T, 3>(&mut form, changes)),
                2 => stack.push(stress_of::<R, T, 2>(&mut form, changes)),
                1 => stack.push(stress_of::<R, T, 1>(&mut form, changes)),
                _ => {}
            }
        }
        stack.push([T::zero()]);
    }

    /// The displaced vectors, and on the stack the changes of the products and what is conjugate to them.
    #[inline(always)]
    fn strain<'v, T: Algebra<R>>(
        &self,
        u: &[[T; D]; S],
        stack: &mut Stack<'_, T>,
        room: &'v mut Room<[[T; D]; S]>,
    ) -> &'v [[T; D]; S] {
        let v = self.products.change(&self.vectors, u, stack, room);
        self.stress(stack);
        v
    }

    /// What is conjugate to the products in the mean of a step on the stack, and the vectors at its ends.
    #[inline(always)]
    fn secant_stress<'v, T: Algebra<R>>(
        &self,
        viscosity: R,
        ends: [&[[T; D]; S]; 2],
        stack: &mut Stack<'_, T>,
        rooms: &'v mut [Room<[[T; D]; S]>; 2],
    ) -> [&'v [[T; D]; S]; 2] {
        let half = R::lit(0.5);
        let mut room = Room::<Pairs<T, S>>::new();
        let mut old = room.stack();
        let [first, second] = rooms;
        let from = self
            .products
            .change(&self.vectors, ends[0], &mut old, first);
        let to = self.products.change(&self.vectors, ends[1], stack, second);
        for (g, old) in stack.numbers_mut().iter_mut().zip(old.numbers()) {
            *g = g.times(half + viscosity) + old.times(half - viscosity);
        }
        self.stress(stack);
        [from, to]
    }

    /// Overwrites the upper blocks of the tangent.
    #[inline(always)]
    fn upper_of<T: Algebra<R>>(&self, stress: &[T], v: &[[T; D]; S], k: &mut Tangent<T, D, S>) {
        let (terms, last) = (&self.terms, last_of(stress));
        for block in &terms.blocks {
            let (i, j) = (block.row.min(S - 1), block.column.min(S - 1));
            let mut sum = [[T::zero(); D]; D];
            for c in 0..D {
                sum[c][c] = stress[(block.stress as usize).min(last)];
            }
            terms.add_dyads(&self.form, block, (v, v), &mut sum);
            for c in 0..D {
                k[i][c][j] = sum[c];
            }
        }
        self.vectors.basis.change_upper(k);
    }

    /// How many vectors the force is summed up on at once: as many as registers hold the sums of, where
    /// numbers take two of them.
    const AT_ONCE: usize = if D == 2 { 2 } else { 1 };

    /// Puts the force on the vectors of the basis on an empty stack, `N` at once.
    #[inline(always)]
    fn push_rows<T: Algebra<R>, const N: usize>(
        &self,
        stress: &[T],
        v: &[[T; D]; S],
        rows: &mut Stack<'_, [T; D]>,
    ) {
        let met = self.terms.met.clone();
        let (mut places, v) = (&self.terms.forces[..], &v[met.clone()]);
        let unmet = met.start / N;
        for _ in 0..unmet {
            rows.push([[T::zero(); D]; N]);
        }
        places = &places[unmet * N * v.len()..];
        for _ in unmet..S / N {
            rows.push(force_on::<T, D, N>(&mut places, stress, v));
        }
        for _ in 0..S % N {
            rows.push(force_on::<T, D, 1>(&mut places, stress, v));
        }
    }

    /// Adds the force on nodal vectors.
    #[inline(always)]
    fn add_force<T: Algebra<R>>(&self, stress: &[T], v: &[[T; D]; S], q: &mut [[T; D]; S]) {
        let mut room = Room::<[[T; D]; S]>::new();
        let force = room.fill(
            #[inline(always)]
            |rows| match Self::AT_ONCE {
                2 => self.push_rows::<T, 2>(stress, v, rows),
                _ => self.push_rows::<T, 1>(stress, v, rows),
            },
        );
        self.vectors.basis.change_force(force);
        for i in 0..S {
            q[i] = sum(&q[i], &force[i]);
        }
    }

    /// The changes of the products, and what is conjugate to them and a zero, as [`stress`](Self::stress)
    /// left them.
    #[inline(always)]
    fn halves<'s, T: Copy>(stack: &'s Stack<'_, T>) -> (&'s [T], &'s [T]) {
        let all = stack.numbers();
        all.split_at(all.len() / 2)
    }
}

impl<R, M, P, const D: usize, const S: usize> ElementKernel<R, D, S> for GramKernel<R, M, P, D, S>
where
    R: Real,
    M: Material<R, D>,
    P: Products<R, D, S>,
{
    const TOGETHER: Together = Together::InPairs;
    const ABSENT: bool = !M::CONSTANT;
    const TURNS: bool = true;

    #[inline(always)]
    fn energy<T: Algebra<R>>(&self, u: &[[T; D]; S]) -> T {
        let (mut products, mut vectors) = (Room::<Pairs<T, S>>::new(), Room::new());
        let mut stack = products.stack();
        self.strain(u, &mut stack, &mut vectors);
        let mut twice = T::zero();
        let (changes, stress) = Self::halves(&stack);
        for (change, stress) in changes.iter().zip(stress) {
            twice = twice.plus_product(*change, *stress);
        }
        twice.times(R::lit(0.5))
    }

    #[inline(always)]
    fn force<T: Algebra<R>>(&self, u: &[[T; D]; S], q: &mut [[T; D]; S]) {
        let (mut products, mut vectors) = (Room::<Pairs<T, S>>::new(), Room::new());
        let mut stack = products.stack();
        let v = self.strain(u, &mut stack, &mut vectors);
        self.add_force(Self::halves(&stack).1, v, q);
    }

    #[inline(always)]
    fn tangent<T: Algebra<R>>(
        &self,
        u: &[[T; D]; S],
        q: &mut [[T; D]; S],
        k: &mut Tangent<T, D, S>,
    ) {
        let (mut products, mut vectors) = (Room::<Pairs<T, S>>::new(), Room::new());
        let mut stack = products.stack();
        let v = self.strain(u, &mut stack, &mut vectors);
        let (_, stress) = Self::halves(&stack);
        self.add_force(stress, v, q);
        mirrored(
            k,
            #[inline(always)]
            |upper| self.upper_of(stress, v, upper),
        );
    }

    #[inline(always)]
    fn upper_tangent<T: Algebra<R>>(&self, u: &[[T; D]; S], k: &mut Tangent<T, D, S>) {
        let (mut products, mut vectors) = (Room::<Pairs<T, S>>::new(), Room::new());
        let mut stack = products.stack();
        let v = self.strain(u, &mut stack, &mut vectors);
        self.upper_of(Self::halves(&stack).1, v, k);
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
        let (mut products, mut rooms) = (Room::<Pairs<T, S>>::new(), [Room::new(), Room::new()]);
        let mut stack = products.stack();
        let [from, to] = self.secant_stress(viscosity, [from, to], &mut stack, &mut rooms);
        let (_, stress) = Self::halves(&stack);
        self.add_force(stress, &between(from, to, R::lit(0.5)), q);
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
        let (mut products, mut rooms) = (Room::<Pairs<T, S>>::new(), [Room::new(), Room::new()]);
        let mut stack = products.stack();
        let [from, to] = self.secant_stress(viscosity, [from, to], &mut stack, &mut rooms);
        let (_, stress) = Self::halves(&stack);
        let middle = between(from, to, half);
        let share = half + viscosity;
        let (terms, last) = (&self.terms, last_of(stress));
        for block in &terms.blocks {
            let (i, j) = (block.row.min(S - 1), block.column.min(S - 1));
            let geometric = stress[(block.stress as usize).min(last)].times(half);
            let mut upper = [[T::zero(); D]; D];
            terms.add_dyads(&self.form, block, (&middle, to), &mut upper);
            // Across the diagonal the vectors of the dyads change places.
            let mut lower = [[T::zero(); D]; D];
            terms.add_dyads(&self.form, block, (to, &middle), &mut lower);
            for c in 0..D {
                for d in 0..D {
                    let diagonal = if c == d { geometric } else { T::zero() };
                    k[i][c][j][d] = diagonal.plus_times(share, upper[c][d]);
                    if i != j {
                        k[j][c][i][d] = diagonal.plus_times(share, lower[d][c]);
                    }
                }
            }
        }
        self.vectors.basis.change_tangent(k);
    }
}
