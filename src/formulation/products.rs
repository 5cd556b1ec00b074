//! Changes of the scalar products of an element's vectors, without the difference of two products.
//! From displacements they keep the digits of beams that bend little; in two parts they keep them
//! however far an element turns, for turned vectors have the products of those that did not turn.

use std::fmt::Debug;

use super::Reference;
use super::basis::{Basis, Kind, Step};
use crate::scalar::{Algebra, Real};
use crate::tensor::{Room, Stack, array, difference, dot};

/// Vectors of an element by a basis of means and differences.
#[derive(Debug, Clone)]
pub struct Vectors<R, const D: usize, const S: usize> {
    pub(super) basis: Basis<R>,
    /// Vectors in the reference state.
    pub(super) reference: [[R; D]; S],
    /// The products of which strain is made.
    pairs: Vec<Pair>,
}

/// The scalar product of two vectors.
#[derive(Debug, Clone, Copy)]
struct Pair {
    i: u32,
    j: u32,
    /// Whether one of them is zero in the reference state.
    bare: bool,
}

impl<R: Real, const D: usize, const S: usize> Vectors<R, D, S> {
    /// Strain is to be made of the products of these pairs, in the order in which changes are wanted.
    pub(super) fn new(
        basis: Basis<R>,
        element: &Reference<R, D, S>,
        pairs: impl Iterator<Item = (usize, usize)>,
    ) -> Self {
        let mut reference = element.vectors;
        basis.change(&mut reference);
        if element.is_straight() {
            // To the last digit: they are what its positions and slopes stand for.
            for i in (0..S).filter(|i| !basis.leads().contains(i)) {
                reference[i] = [R::zero(); D];
            }
        }
        let bare = reference.map(|vector| vector.iter().all(|c| vanishes(*c)));
        let pair = |(i, j): (usize, usize)| Pair {
            i: i as u32,
            j: j as u32,
            bare: bare[i] || bare[j],
        };
        Self {
            basis,
            reference,
            pairs: pairs.map(pair).collect(),
        }
    }

    /// Vectors displaced by `h`.
    #[inline(always)]
    fn displaced<'v, T: Algebra<R>>(
        &self,
        h: &[[T; D]; S],
        room: &'v mut Room<[[T; D]; S]>,
    ) -> &'v [[T; D]; S] {
        room.fill(
            #[inline(always)]
            |v| {
                for i in 0..S {
                    let (h, reference) = (&h[i], &self.reference[i]);
                    v.push([array(
                        #[inline(always)]
                        |c| h[c] + T::lift(reference[c]),
                    )]);
                }
            },
        )
    }

    /// Changes of the products: the product itself where either vector is zero in the reference, and what
    /// `change` makes of the others.
    #[inline(always)]
    fn changes<T: Algebra<R>>(
        &self,
        v: &[[T; D]; S],
        change: impl Fn(usize, usize) -> T,
        changes: &mut Stack<'_, T>,
    ) {
        changes.push_each(
            &self.pairs,
            #[inline(always)]
            |pair| {
                // The minima are identities; they let the optimiser drop the bounds checks.
                let (i, j) = ((pair.i as usize).min(S - 1), (pair.j as usize).min(S - 1));
                let change = match pair.bare {
                    true => dot(&v[i], &v[j]),
                    false => change(i, j),
                };
                match i == j {
                    true => change.times(R::lit(0.5)),
                    false => change,
                }
            },
        );
    }

    /// Change of the product of two displaced vectors.
    #[inline(always)]
    fn change<T: Algebra<R>>(
        &self,
        (h, v): (&[[T; D]; S], &[[T; D]; S]),
        (i, j): (usize, usize),
    ) -> T {
        let mut change = dot(&h[i], &v[j]);
        for c in 0..D {
            change = change.plus_times(self.reference[i][c], h[j][c]);
        }
        change
    }
}

/// How changes of scalar products are formed from nodal displacements: [`Direct`] or [`InParts`].
pub trait Products<R: Real, const D: usize, const S: usize>:
    Debug + Clone + Send + Sync + 'static
{
    /// For elements with these vectors.
    #[doc(hidden)]
    fn new(vectors: &Vectors<R, D, S>) -> Self;

    /// The displaced vectors, and on the stack the changes of the products, halved for those of vectors
    /// with themselves.
    #[doc(hidden)]
    fn change<'v, T: Algebra<R>>(
        &self,
        vectors: &Vectors<R, D, S>,
        u: &[[T; D]; S],
        changes: &mut Stack<'_, T>,
        room: &'v mut Room<[[T; D]; S]>,
    ) -> &'v [[T; D]; S];
}

/// From displacements, which keep the digits that a product of displaced vectors loses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Direct;

impl<R: Real, const D: usize, const S: usize> Products<R, D, S> for Direct {
    fn new(_vectors: &Vectors<R, D, S>) -> Self {
        Self
    }

    #[inline(always)]
    fn change<'v, T: Algebra<R>>(
        &self,
        vectors: &Vectors<R, D, S>,
        u: &[[T; D]; S],
        changes: &mut Stack<'_, T>,
        room: &'v mut Room<[[T; D]; S]>,
    ) -> &'v [[T; D]; S] {
        let mut h = *u;
        vectors.basis.change(&mut h);
        let v = vectors.displaced(&h, room);
        vectors.changes(
            v,
            #[inline(always)]
            |i, j| vectors.change((&h, v), (i, j)),
            changes,
        );
        v
    }
}

/// From displacements in two parts, for elements that turn.
///
/// The displacements of an element that has turned are as large as its vectors, and so is the rounding
/// of their products. What a rotation makes large are the leading vectors alone, mean slopes or the
/// chord; those that differ from them are as small as the element is little bent. So the leading
/// displacements are taken as `h = c + f`, `c` on a grid of half the digits and `f` the rest with what
/// rounding took on the way to `h`. In
///
/// `h_a . v_b + v0_a . h_b = (c_a . (C_b + c_b) + C_a . c_b) + ((C_a + c_a) . f_b + f_a . v_b + c_a . F_b + F_a . h_b)`,
///
/// with `v0 = C + F`, the first bracket is exact up to stretches of one and a half and the second small: the error
/// is that of the same element in a frame which turns with it, for a quarter of its price, and nothing is
/// turned back. Double-double, whose sums keep more digits than their grid has, gains nothing by it.
#[derive(Debug, Clone)]
pub struct InParts<R, const D: usize, const S: usize> {
    /// Which vectors are leading.
    leads: [bool; S],
    /// The factor of every step, on the grid and the rest.
    factors: Vec<[R; 2]>,
    /// What rounds leading vectors to the grid by being added and taken away.
    grid: [R; S],
    /// Leading vectors of the reference, on the grid and the rest.
    coarse: [[R; D]; S],
    fine: [[R; D]; S],
}

impl<R: Real, const D: usize, const S: usize> Products<R, D, S> for InParts<R, D, S> {
    fn new(vectors: &Vectors<R, D, S>) -> Self {
        let digits = -R::EPSILON.log2().round() as i32;
        // Products on the grid, and sums of them up to 4, fit in the digits of the type.
        let unit = R::lit(1.5 * 2.0_f64.powi(digits - (digits - 1) / 2));
        let factor = |step: &Step<R>| {
            let coarse = on_grid(step.factor, unit * magnitude(step.factor.abs()));
            [coarse, step.factor - coarse]
        };
        let grid = vectors.reference.map(|v| {
            let size = dot(&v, &v).frozen().sqrt();
            unit * magnitude(R::one().where_else(size.at_most(R::zero()), size))
        });
        let coarse = array(|i| vectors.reference[i].map(|c| on_grid(c, grid[i])));
        Self {
            leads: array(|i| vectors.basis.leads().contains(&i)),
            factors: vectors.basis.steps().iter().map(factor).collect(),
            grid,
            fine: array(|i| difference(&vectors.reference[i], &coarse[i])),
            coarse,
        }
    }

    #[inline(always)]
    fn change<'v, T: Algebra<R>>(
        &self,
        vectors: &Vectors<R, D, S>,
        u: &[[T; D]; S],
        changes: &mut Stack<'_, T>,
        room: &'v mut Room<[[T; D]; S]>,
    ) -> &'v [[T; D]; S] {
        let [h, coarse, fine] = self.parts(&vectors.basis, u);
        let v = vectors.displaced(&h, room);
        let on_grid: [[T; D]; S] = array(|i| array(|c| coarse[i][c] + T::lift(self.coarse[i][c])));
        vectors.changes(
            v,
            #[inline(always)]
            |i: usize, j: usize| {
                if !(self.leads[i] && self.leads[j]) {
                    return vectors.change((&h, v), (i, j));
                }
                let mut exact = dot(&coarse[i], &on_grid[j]);
                let mut small = dot(&on_grid[i], &fine[j]);
                for c in 0..D {
                    exact = exact.plus_times(self.coarse[i][c], coarse[j][c]);
                    small = small.plus_product(fine[i][c], v[j][c]);
                    small = small.plus_times(self.fine[j][c], coarse[i][c]);
                    small = small.plus_times(self.fine[i][c], h[j][c]);
                }
                exact + small
            },
            changes,
        );
        v
    }
}

impl<R: Real, const D: usize, const S: usize> InParts<R, D, S> {
    /// Displacements of the vectors of a basis, whole and, of leading ones, on the grid and the rest.
    #[inline(always)]
    fn parts<T: Algebra<R>>(&self, basis: &Basis<R>, u: &[[T; D]; S]) -> [[[T; D]; S]; 3] {
        let (mut h, mut coarse, mut fine) = (*u, [[T::zero(); D]; S], [[T::zero(); D]; S]);
        for (step, factor) in basis.steps().iter().zip(&self.factors) {
            // The minima are identities; they let the optimiser drop the bounds checks.
            let (from, to) = (step.from.min(S - 1), step.to.min(S - 1));
            let (start, other) = (h[to], h[from]);
            match step.kind {
                // Exact where slopes are close, and small where they are not.
                Kind::Bend => h[to] = difference(&start, &other),
                // The larger first, but for a start that bending alone moves: what is lost then is small.
                Kind::Mean => {
                    for c in 0..D {
                        let share = other[c].times(step.factor);
                        h[to][c] = start[c] + share;
                        fine[to][c] += share - (h[to][c] - start[c]);
                    }
                }
                Kind::Apart => {
                    for c in 0..D {
                        h[to][c] = start[c] - other[c];
                        let part = h[to][c] - start[c];
                        fine[to][c] = (start[c] - (h[to][c] - part)) - (other[c] + part);
                    }
                }
                Kind::Along => {
                    for c in 0..D {
                        let rest = fine[to][c].plus_times(factor[1], coarse[from][c]);
                        let rest = rest.plus_times(step.factor, fine[from][c]);
                        h[to][c] = start[c].plus_times(factor[0], coarse[from][c]) + rest;
                    }
                }
            }
            if step.completes {
                let grid = T::lift(self.grid[to]);
                for c in 0..D {
                    coarse[to][c] = (h[to][c] + grid) - grid;
                    fine[to][c] += h[to][c] - coarse[to][c];
                }
            }
        }
        [h, coarse, fine]
    }
}

/// Whether a number of the model is zero; in a pack each lane must give the same answer, or it would not
/// be summed as in a run of its own.
pub(super) fn vanishes<R: Real>(x: R) -> bool {
    R::ORDER == 0 && x.abs().at_most(R::zero()).common()
}

/// A positive number by its first two digits, lane by lane (Veltkamp's splitting).
pub(super) fn magnitude<R: Real>(x: R) -> R {
    let x = x.frozen();
    let digits = -R::EPSILON.log2().round() as i32;
    let wide = x * R::lit(2.0_f64.powi(digits - 1) + 1.0);
    wide - (wide - x)
}

fn on_grid<R: Real>(x: R, grid: R) -> R {
    (x + grid) - grid
}
