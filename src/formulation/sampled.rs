//! The kernel of every formulation that samples derivatives of the position at stations of the
//! axis: each station turns nodal vectors into `K` sampled vectors by a constant sparse operator,
//! a [`SectionLaw`] turns those into energy per unit length, and the derivatives come back by the
//! transpose. Shape functions enter once per station, not once per section point, which is the
//! paper's split of the volume integral (eq. 18) carried to its end. Positions enter as differences
//! to the element's first node, of which alone derivatives of the position are made: that keeps
//! digits, and saves the first node's column.

use num_dual::HyperDual;

use super::law::{SectionLaw, SectionStiffness};
use super::relative::Positions;
use super::{ElementKernel, Reference, Tangent, Together, mirrored};
use crate::element::Element;
use crate::error::{Error, Result};
use crate::quadrature::Cubature;
use crate::scalar::{Algebra, Real};
use crate::tensor::{add_scaled, add_times, array, times};

/// A derivative of the position field on the axis, by reference coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sample {
    /// `dr/dX_a`.
    First(usize),
    /// `d^2 r/dX_a dX_b`.
    Second(usize, usize),
}

/// A sparse row of a station's operator: how one sampled vector is combined from nodal vectors.
#[derive(Debug, Clone)]
struct Row<R, const S: usize> {
    nodal: [usize; S],
    value: [R; S],
    /// Values times the station's weight.
    weighted: [R; S],
    count: usize,
}

impl<R: Real, const S: usize> Row<R, S> {
    fn new(dense: [R; S], weight: R) -> Self {
        let mut row = Self {
            nodal: [0; S],
            value: [R::zero(); S],
            weighted: [R::zero(); S],
            count: 0,
        };
        for (i, value) in dense.into_iter().enumerate() {
            if !value.is_zero() {
                row.nodal[row.count] = i;
                row.value[row.count] = value;
                row.weighted[row.count] = weight * value;
                row.count += 1;
            }
        }
        row
    }

    #[inline(always)]
    fn entries<'a>(&'a self, values: &'a [R; S]) -> impl Iterator<Item = (usize, R)> + 'a {
        let entries = self.nodal.iter().zip(values).take(self.count);
        // The minimum is the identity; it lets the optimiser drop the bounds checks.
        entries.map(|(&i, &v)| (i.min(S - 1), v))
    }

    #[inline(always)]
    fn iter(&self) -> impl Iterator<Item = (usize, R)> + '_ {
        self.entries(&self.value)
    }

    #[inline(always)]
    fn weighted(&self) -> impl Iterator<Item = (usize, R)> + '_ {
        self.entries(&self.weighted)
    }
}

#[derive(Debug, Clone)]
struct Station<R, const D: usize, const S: usize, const K: usize> {
    weight: R,
    rows: [Row<R, S>; K],
    /// The sampled vectors in the reference state.
    reference: [[R; D]; K],
}

impl<R: Real, const D: usize, const S: usize, const K: usize> Station<R, D, S, K> {
    #[inline(always)]
    fn sample<T: Algebra<R>>(&self, v: &[[T; D]; S]) -> [[T; D]; K] {
        let mut h = [[T::zero(); D]; K];
        for k in 0..K {
            for (i, value) in self.rows[k].iter() {
                add_times(&mut h[k], value, &v[i]);
            }
        }
        h
    }

    #[inline(always)]
    fn scatter_force<T: Algebra<R>>(&self, n: &[[T; D]; K], q: &mut [[T; D]; S]) {
        for k in 0..K {
            for (i, value) in self.rows[k].weighted() {
                add_times(&mut q[i], value, &n[k]);
            }
        }
    }
}

impl<R: Real, const D: usize, const S: usize, const K: usize> Station<R, D, S, K> {
    /// Adds a stiffness of which every block is given.
    #[inline(always)]
    fn scatter_all<T: Algebra<R>>(
        &self,
        stiffness: &SectionStiffness<T, D, K>,
        tangent: &mut Tangent<T, D, S>,
    ) {
        for k in 0..K {
            for l in 0..K {
                let block: [[T; D]; D] = array(|c| times(self.weight, &stiffness[k][l][c]));
                for (i, left) in self.rows[k].iter() {
                    for (j, right) in self.rows[l].iter() {
                        for c in 0..D {
                            add_times(&mut tangent[i][c][j], left * right, &block[c]);
                        }
                    }
                }
            }
        }
    }
}

/// Stations whose stiffness is held at once, so that each block of the tangent is summed over them
/// in registers: more of them, and packs leave the first cache.
const BATCH: usize = 2;

/// A block of section stiffness in a block of the tangent: sampled vectors, and the weight at each
/// station of a batch.
#[derive(Debug, Clone)]
struct Term<R> {
    pair: (usize, usize),
    weight: [R; BATCH],
}

/// The block of the tangent between two nodal vectors, as a sum of blocks of section stiffness.
#[derive(Debug, Clone)]
struct Block<R> {
    row: usize,
    column: usize,
    /// Terms taken as they are, then terms transposed.
    terms: [Vec<Term<R>>; 2],
}

#[derive(Debug, Clone)]
struct Batch<R, const D: usize, const S: usize, const K: usize> {
    stations: Vec<Station<R, D, S, K>>,
    blocks: Vec<Block<R>>,
}

impl<R: Real, const D: usize, const S: usize, const K: usize> Batch<R, D, S, K> {
    fn new(stations: &[Station<R, D, S, K>]) -> Self {
        let dense = |station: &Station<R, D, S, K>, k: usize, i: usize| {
            let row = &station.rows[k];
            let entry = row.iter().find(|&(nodal, _)| nodal == i);
            entry.map_or(R::zero(), |(_, value)| value)
        };
        let term = |(i, k): (usize, usize), (j, l): (usize, usize)| {
            let mut weight = [R::zero(); BATCH];
            for (weight, s) in weight.iter_mut().zip(stations) {
                *weight = s.weight * dense(s, k, i) * dense(s, l, j);
            }
            let pair = (k, l);
            let present = weight.iter().any(|w| !w.is_zero());
            present.then_some(Term { pair, weight })
        };
        let mut blocks = Vec::new();
        for row in 0..S {
            for column in row..S {
                let mut terms = [Vec::new(), Vec::new()];
                for k in 0..K {
                    for l in k..K {
                        terms[0].extend(term((row, k), (column, l)));
                        if l > k {
                            terms[1].extend(term((column, k), (row, l)));
                        }
                    }
                }
                if terms.iter().any(|terms| !terms.is_empty()) {
                    blocks.push(Block { row, column, terms });
                }
            }
        }
        Self {
            stations: stations.to_vec(),
            blocks,
        }
    }

    #[inline(always)]
    fn scatter_stiffness<T: Algebra<R>>(
        &self,
        stiffness: &[SectionStiffness<T, D, K>; BATCH],
        tangent: &mut Tangent<T, D, S>,
    ) {
        for block in &self.blocks {
            // The minima are identities; they let the optimiser drop the bounds checks.
            let (i, j) = (block.row.min(S - 1), block.column.min(S - 1));
            let mut sum: [[T; D]; D] = array(|c| tangent[i][c][j]);
            for Term { pair, weight } in &block.terms[0] {
                let (k, l) = (pair.0.min(K - 1), pair.1.min(K - 1));
                for (s, weight) in stiffness.iter().zip(weight).take(self.stations.len()) {
                    for c in 0..D {
                        add_times(&mut sum[c], *weight, &s[k][l][c]);
                    }
                }
            }
            for Term { pair, weight } in &block.terms[1] {
                let (k, l) = (pair.0.min(K - 1), pair.1.min(K - 1));
                for (s, weight) in stiffness.iter().zip(weight).take(self.stations.len()) {
                    for c in 0..D {
                        for d in 0..D {
                            sum[d][c] = sum[d][c].plus_times(*weight, s[k][l][c][d]);
                        }
                    }
                }
            }
            for c in 0..D {
                tangent[i][c][j] = sum[c];
            }
        }
    }
}

/// Kernel of an element whose energy is a sum of laws, each sampled at stations of its own.
///
/// The forces on the positions of a complete element add up to zero, to the last digit for two
/// nodes.
#[derive(Debug, Clone)]
pub struct SampledKernel<R, L, const D: usize, const S: usize, const K: usize> {
    parts: Vec<(L, Vec<Batch<R, D, S, K>>)>,
    positions: Positions<S>,
}

impl<R: Real, L, const D: usize, const S: usize, const K: usize> SampledKernel<R, L, D, S, K> {
    /// A kernel without energy; give it parts.
    pub fn new() -> Self {
        Self {
            parts: Vec::new(),
            positions: Positions::NONE,
        }
    }

    /// Adds a law sampled by `samples` at the points of `axial`, a rule on [0, 1] along the
    /// element.
    ///
    /// # Panics
    /// For a law that says that it is [`ABSENT`](SectionLaw::ABSENT).
    #[must_use]
    pub fn with_part<E: Element<D, S>>(
        mut self,
        element: &E,
        reference: &Reference<R, D, S>,
        law: L,
        samples: [Sample; K],
        axial: &Cubature<R, 1>,
    ) -> Self
    where
        L: SectionLaw<R, D, K>,
    {
        assert!(!L::ABSENT, "no element is made of a law that is ABSENT");
        let nodal = &reference.vectors;
        self.positions = Positions::of::<E, D>();
        let station = |([xi], w): ([R; 1], R)| {
            let mut axis = [R::zero(); D];
            axis[0] = xi;
            let mut rows = samples.map(|sample| sample.of(element, reference.length, axis));
            let vector = |row: &[R; S]| {
                let mut g = [R::zero(); D];
                for i in 0..S {
                    add_scaled(&mut g, row[i], &nodal[i]);
                }
                g
            };
            let sampled = std::array::from_fn(|k| vector(&rows[k]));
            for row in &mut rows {
                self.positions.make_relative_row(row);
            }
            let weight = w * reference.length;
            Station {
                weight,
                reference: sampled,
                rows: rows.map(|row| Row::new(row, weight)),
            }
        };
        let stations: Vec<_> = axial.iter().map(station).collect();
        self.parts
            .push((law, stations.chunks(BATCH).map(Batch::new).collect()));
        self
    }
}

impl<R: Real, L, const D: usize, const S: usize, const K: usize> Default
    for SampledKernel<R, L, D, S, K>
{
    fn default() -> Self {
        Self::new()
    }
}

impl<R, L, const D: usize, const S: usize, const K: usize> SampledKernel<R, L, D, S, K>
where
    R: Real,
    L: SectionLaw<R, D, K>,
{
    /// Overwrites the upper blocks of the tangent; the force, relative to the first position.
    #[inline(always)]
    fn upper_of<T: Algebra<R>>(&self, u: &[[T; D]; S], k: &mut Tangent<T, D, S>) -> [[T; D]; S] {
        let mut f = [[T::zero(); D]; S];
        T::outlined(
            #[inline(always)]
            || {
                let mut v = *u;
                self.positions.make_relative(&mut v);
                for i in 0..S {
                    for row in &mut k[i] {
                        row[i..].fill([T::zero(); D]);
                    }
                }
                let mut stiffness = [[[[[T::zero(); D]; D]; K]; K]; BATCH];
                for (law, batches) in &self.parts {
                    for batch in batches {
                        for (station, stiffness) in batch.stations.iter().zip(&mut stiffness) {
                            let h = station.sample(&v);
                            let n = law.stiffness(&station.reference, &h, stiffness);
                            station.scatter_force(&n, &mut f);
                        }
                        batch.scatter_stiffness(&stiffness, k);
                    }
                }
                self.positions.finish_upper(k);
            },
        );
        f
    }
}

impl<R, L, const D: usize, const S: usize, const K: usize> ElementKernel<R, D, S>
    for SampledKernel<R, L, D, S, K>
where
    R: Real,
    L: SectionLaw<R, D, K>,
{
    const TOGETHER: Together = match L::LANES {
        true => Together::InLanes,
        false => Together::Never,
    };
    const ABSENT: bool = L::ABSENT;

    #[inline(always)]
    fn energy<T: Algebra<R>>(&self, u: &[[T; D]; S]) -> T {
        let mut energy = T::zero();
        T::outlined(
            #[inline(always)]
            || {
                let mut v = *u;
                self.positions.make_relative(&mut v);
                for (law, batches) in &self.parts {
                    for station in batches.iter().flat_map(|batch| &batch.stations) {
                        let density = law.energy(&station.reference, &station.sample(&v));
                        energy = energy.plus_times(station.weight, density);
                    }
                }
            },
        );
        energy
    }

    #[inline(always)]
    fn force<T: Algebra<R>>(&self, u: &[[T; D]; S], q: &mut [[T; D]; S]) {
        T::outlined(
            #[inline(always)]
            || {
                let mut v = *u;
                self.positions.make_relative(&mut v);
                let mut f = [[T::zero(); D]; S];
                for (law, batches) in &self.parts {
                    for batch in batches {
                        for station in &batch.stations {
                            let n = law.resultants(&station.reference, &station.sample(&v));
                            station.scatter_force(&n, &mut f);
                        }
                    }
                }
                self.positions.add_force(&f, q);
            },
        );
    }

    #[inline(always)]
    fn tangent<T: Algebra<R>>(
        &self,
        u: &[[T; D]; S],
        q: &mut [[T; D]; S],
        k: &mut Tangent<T, D, S>,
    ) {
        mirrored(
            k,
            #[inline(always)]
            |upper| {
                let force = self.upper_of(u, upper);
                self.positions.add_force(&force, q);
            },
        );
    }

    #[inline(always)]
    fn upper_tangent<T: Algebra<R>>(&self, u: &[[T; D]; S], k: &mut Tangent<T, D, S>) {
        self.upper_of(u, k);
    }

    fn has_strain(&self) -> bool {
        self.parts.iter().all(|(law, _)| law.has_strain())
    }

    #[inline(always)]
    fn secant<T: Algebra<R>>(
        &self,
        viscosity: R,
        from: &[[T; D]; S],
        to: &[[T; D]; S],
        q: &mut [[T; D]; S],
    ) {
        T::outlined(
            #[inline(always)]
            || {
                let (mut from, mut to) = (*from, *to);
                self.positions.make_relative(&mut from);
                self.positions.make_relative(&mut to);
                let mut relative = [[T::zero(); D]; S];
                for (law, batches) in &self.parts {
                    for station in batches.iter().flat_map(|batch| &batch.stations) {
                        let (from, to) = (station.sample(&from), station.sample(&to));
                        let n = law.secant(viscosity, &station.reference, &from, &to);
                        station.scatter_force(&n, &mut relative);
                    }
                }
                self.positions.add_force(&relative, q);
            },
        );
    }

    #[inline(always)]
    fn secant_tangent<T: Algebra<R>>(
        &self,
        viscosity: R,
        from: &[[T; D]; S],
        to: &[[T; D]; S],
        k: &mut Tangent<T, D, S>,
    ) {
        *k = [[[[T::zero(); D]; S]; D]; S];
        T::outlined(
            #[inline(always)]
            || {
                let (mut from, mut to) = (*from, *to);
                self.positions.make_relative(&mut from);
                self.positions.make_relative(&mut to);
                let mut relative = [[[[T::zero(); D]; S]; D]; S];
                for (law, batches) in &self.parts {
                    for station in batches.iter().flat_map(|batch| &batch.stations) {
                        let (from, to) = (station.sample(&from), station.sample(&to));
                        let reference = &station.reference;
                        let stiffness = law.secant_stiffness(viscosity, reference, &from, &to);
                        station.scatter_all(&stiffness, &mut relative);
                    }
                }
                self.positions.add_tangent(relative, k);
            },
        );
    }
}

/// Second derivatives of the shape functions at a natural point, by the natural coordinates `a`
/// and `b`; the first derivatives come along.
fn derivatives<R: Real, E: Element<D, S>, const D: usize, const S: usize>(
    element: &E,
    length: R,
    point: [R; D],
    (a, b): (usize, usize),
) -> [HyperDual<R>; S] {
    let mut x = point.map(HyperDual::from_re);
    x[a] = x[a].derivative1();
    x[b] = x[b].derivative2();
    element.shape(HyperDual::from_re(length), x)
}

impl Sample {
    /// This derivative of every shape function (1/m, 1/m^2 for second ones; those of slopes times m)
    /// at the natural coordinates `point` of an element of this `length` (m): the nodal vectors
    /// weighted by it are the sampled vector.
    ///
    /// ```
    /// use ancf::formulation::Sample;
    /// use ancf::prelude::*;
    ///
    /// // The slope of a cubic axis half way along an element of 2 m.
    /// let row: [f64; 4] = Sample::First(0).of::<_, Cable, 2, 4>(&Cable, 2.0, [0.5, 0.0]);
    /// assert_eq!(row, [-0.75, -0.25, 0.75, -0.25]);
    /// ```
    ///
    /// # Panics
    /// For an axis that `D` dimensions do not have.
    pub fn of<R: Real, E: Element<D, S>, const D: usize, const S: usize>(
        self,
        element: &E,
        length: R,
        point: [R; D],
    ) -> [R; S] {
        let per_length = R::one() / length;
        match self {
            Self::First(a) => {
                derivatives(element, length, point, (a, a)).map(|s| s.eps1 * per_length)
            }
            Self::Second(a, b) => {
                let s = derivatives(element, length, point, (a, b));
                s.map(|s| s.eps1eps2 * per_length * per_length)
            }
        }
    }
}

/// What a law of the whole section samples: `r'`, the `D - 1` cross slopes and their derivatives
/// along the axis, which is all there is to know of an element linear in the cross coordinates;
/// any other is refused.
pub(super) fn section_samples<R, E, const D: usize, const S: usize, const K: usize>(
    element: &E,
    length: R,
) -> Result<[Sample; K]>
where
    R: Real,
    E: Element<D, S>,
{
    const {
        assert!(
            K == 2 * D - 1,
            "r', D - 1 cross slopes and their derivatives"
        )
    };
    if !section_linear(element, length) {
        return Err(Error::Unsupported {
            what: format!(
                "a law of the section on {element:?}, whose shape functions are not linear across it"
            ),
            remedy: "use an element whose position is linear in the cross coordinates",
        });
    }
    Ok(std::array::from_fn(|k| match k {
        k if k < D => Sample::First(k),
        k => Sample::Second(0, k - D + 1),
    }))
}

/// Whether the shape functions are linear in the cross coordinates.
fn section_linear<R: Real, E: Element<D, S>, const D: usize, const S: usize>(
    element: &E,
    length: R,
) -> bool {
    let small = R::lit(1e3 * R::EPSILON) * length;
    let curved = |s: HyperDual<R>| s.eps1eps2.abs() > small;
    // Two points off the axis tell any polynomial but one made to vanish there.
    [0.3, 0.9].into_iter().all(|xi| {
        let mut point = [R::lit(0.25); D];
        point[0] = R::lit(xi);
        point[D - 1] = R::lit(0.5);
        (1..D).all(|a| {
            (a..D).all(|b| {
                !derivatives(element, length, point, (a, b))
                    .into_iter()
                    .any(curved)
            })
        })
    })
}
