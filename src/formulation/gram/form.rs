//! How the quadratic form of a kernel is made: moduli are summed over the points of a rule, then the
//! scalar products that couple are told from those that do not.

use std::marker::PhantomData;

use super::super::Reference;
use super::super::basis::Basis;
use super::super::point::{first_column, material_frame};
use super::super::products::{Products, Vectors, vanishes};
use super::super::sampled::Sample;
use super::{GramKernel, Group, ROWS, Terms};
use crate::element::Element;
use crate::material::Moduli;
use crate::quadrature::Cubature;
use crate::scalar::{LaneWork, Lanes, Real, Scalar};
use crate::tensor::{Pairs, Room, add_scaled, array};

/// The quadratic form while parts are added to it: between the pairs `i <= j` of nodal vectors, numbered
/// row by row, those `[p][q]` with `p <= q`, for the form is symmetric.
pub(in crate::formulation) struct Form<R, const D: usize, const S: usize>(Vec<R>);

/// How many pairs `i <= j` of vectors there are.
const fn pairs(vectors: usize) -> usize {
    vectors * (vectors + 1) / 2
}

impl<R: Real, const D: usize, const S: usize> Form<R, D, S> {
    pub(in crate::formulation) fn new() -> Self {
        Self(vec![R::zero(); pairs(S) * pairs(S)])
    }

    /// Adds constant moduli at the section points `(0, y[, z])` (m) with weights (m^2), at the
    /// points of `axial`, a rule on [0, 1] along the element. `K = 2 D - 1` samples as those of
    /// [`PointSection`](super::PointSection).
    pub(in crate::formulation) fn add<E: Element<D, S>, const K: usize>(
        &mut self,
        (element, reference): (&E, &Reference<R, D, S>),
        samples: [Sample; K],
        axial: &Cubature<R, 1>,
        moduli: &Moduli<R, D>,
        points: &[([R; D], R)],
    ) {
        let basis = Basis::of::<E, D, S>(reference.length);
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
                R::dispatch_singly(Point {
                    form: &mut self.0,
                    moduli,
                    columns: &columns,
                    weight,
                });
            }
        }
    }

    /// Which products couple, by groups, and the forms of these.
    fn groups(&self) -> (Vec<Group>, Vec<R>) {
        let small = R::lit(64.0 * R::EPSILON);
        let count = pairs(S);
        let all: Vec<_> = all_pairs::<S>().map(|(_, pair)| pair).collect();
        let size = |p: usize| self.0[p * count + p].abs().sqrt();
        let sizes: Vec<_> = (0..count).map(size).collect();
        // One triangle, so that the form is symmetric to the last digit.
        let entry = |p: usize, q: usize| {
            let raw = self.0[p.min(q) * count + p.max(q)];
            // Rounding of what cancels; but an entry that vanishes may have a derivative that does not.
            let bound = small * sizes[p] * sizes[q];
            match R::ORDER {
                0 => R::zero().where_else(raw.abs().at_most(bound), raw),
                _ => raw,
            }
        };
        let places = (0..count).flat_map(|p| (0..count).map(move |q| (p, q)));
        let coupled: Vec<_> = places.map(|(p, q)| !vanishes(entry(p, q))).collect();
        let couples = |p: usize, q: usize| coupled[p * count + q];
        let strained = |p: &usize| (0..count).any(|q| couples(*p, q));
        let mut left: Vec<usize> = (0..count).filter(strained).collect();
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
            groups.push(Group {
                pairs: group.iter().map(|p| all[*p]).collect(),
                form: form.len(),
            });
            for rows in group.chunks(ROWS) {
                let columns = group.iter();
                form.extend(columns.flat_map(|q| rows.iter().map(|p| entry(*p, *q))));
            }
        }
        (groups, form)
    }

    /// The kernel with the energy of what was added.
    pub(in crate::formulation) fn kernel<E: Element<D, S>, M, P: Products<R, D, S>>(
        &self,
        reference: &Reference<R, D, S>,
    ) -> GramKernel<R, M, P, D, S> {
        let basis = Basis::of::<E, D, S>(reference.length);
        let (groups, mut form) = self.groups();
        let at_once = GramKernel::<R, M, P, D, S>::AT_ONCE;
        let terms = Terms::new::<R, S>(&groups, &form, at_once);
        form.push(R::zero());
        let pairs = groups.iter().flat_map(|group| &group.pairs).copied();
        let vectors = Vectors::new(basis, reference, pairs);
        GramKernel {
            material: PhantomData,
            products: P::new(&vectors),
            vectors,
            form,
            terms,
        }
    }
}

/// A point to add to a form, at which column `a` of the gradient is `sum_i columns[a][i] v_i`.
struct Point<'a, R, const D: usize, const S: usize> {
    form: &'a mut [R],
    moduli: &'a Moduli<R, D>,
    columns: &'a [[R; S]; D],
    weight: R,
}

impl<R: Real, const D: usize, const S: usize> LaneWork<R> for Point<'_, R, D, S> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes<R>>(self) {
        let Self {
            form,
            moduli,
            columns,
            weight,
        } = self;
        const { assert!(L::WIDTH == 1, "a point has no others beside it") };
        let met = columns.map(|row| row.map(|a| !a.is_nothing()));
        let strained = |[a, b]: [usize; 2], i: usize, j: usize| {
            met[a][i] && met[b][j] || met[a][j] && met[b][i]
        };
        let mut lifted = [[L::zero(); S]; D];
        for (lifted, row) in lifted.iter_mut().zip(columns) {
            for (lifted, a) in lifted.iter_mut().zip(row) {
                *lifted = L::lift(*a);
            }
        }
        let weight = L::lift(weight);
        let mut room = Room::<Pairs<L, S>>::new();
        for (a, b) in (0..D).flat_map(|a| (a..D).map(move |b| (a, b))) {
            let (mut strains, mut places, mut count) = (room.stack(), [[0; S]; S], 0);
            for (q, (i, j)) in all_pairs::<S>() {
                if strained([a, b], i, j) {
                    strains.push([strain_of(&lifted, [a, b], i, j)]);
                    places.as_flattened_mut()[count] = q;
                    count += 1;
                }
            }
            let places = &places.as_flattened()[..count];
            for (p, (i, j)) in all_pairs::<S>() {
                let mut stress = L::zero();
                if a != b {
                    if !strained([a, b], i, j) {
                        continue;
                    }
                    stress = strain_of(&lifted, [a, b], i, j).times(moduli.shear[a][b]);
                } else {
                    let mut any = false;
                    for c in 0..D {
                        let modulus = moduli.normal[a][c];
                        if strained([c, c], i, j) && !modulus.is_nothing() {
                            let strain = strain_of(&lifted, [c, c], i, j);
                            stress = stress.plus_times(modulus, strain);
                            any = true;
                        }
                    }
                    if !any {
                        continue;
                    }
                }
                let stress = weight * stress;
                let row = &mut form[p * pairs(S)..][..pairs(S)];
                let from = places.partition_point(|q| *q < p);
                for (q, strain) in places[from..].iter().zip(&strains.numbers()[from..]) {
                    let entry = &mut row[*q..];
                    L::load(entry).plus_product(stress, *strain).store(entry);
                }
            }
        }
    }
}

/// Pairs `i <= j` of vectors with their numbers, row by row.
fn all_pairs<const S: usize>() -> impl Iterator<Item = (usize, (usize, usize))> {
    (0..S).flat_map(|i| (i..S).map(move |j| (i, j))).enumerate()
}

/// How a strain depends on a product: `E_aa`, and `2 E_ab`.
#[inline(always)]
fn strain_of<T: Scalar, const D: usize, const S: usize>(
    columns: &[[T; S]; D],
    [a, b]: [usize; 2],
    i: usize,
    j: usize,
) -> T {
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
