//! The balance of forces: its residual in the units of the structure, what rounding may leave of it
//! and what that takes of the answer.

use std::ops::Range;

use super::{Assembled, Equations, Rest, Workspace};
use crate::error::{Error, Result};
use crate::scalar::{Elementwise, Loops, Real, elementwise};
use crate::solver::{Part, Structure};
use crate::tensor::array;

/// A force balance: the residual's norm and the largest norm among its parts, in units of the
/// solve's force.
pub(super) struct Balance<R> {
    pub(super) residual: R,
    pub(super) scale: R,
}

impl<R: Real> Workspace<R> {
    /// Residual `Q_e - Q_s - M a` in `scratch`, its norm and that of the largest force, over what acts on
    /// the unknowns: what a support carries is no measure of the rest. Formed part by part, while the
    /// caches hold it.
    pub(super) fn balance<S: Structure<R> + ?Sized>(
        &mut self,
        structure: &S,
        equations: &Equations<'_, R>,
        u: &[R],
    ) -> Result<Balance<R>> {
        if !self.loaded || structure.has_following() {
            self.load(structure, equations, u)?;
        }
        let (count, unknowns) = (u.len(), structure.unknowns());
        let open = self.force.at_most(R::zero());
        let mut norms = Norms::new((!open.any()).then(|| R::one() / self.unit()));
        let Self {
            external,
            internal,
            inertia,
            scratch,
            moved,
            weights,
            ..
        } = self;
        let (mut touched, mut done) = (0, 0);
        let mut take = |part: &Part| {
            let fresh = touched..part.coordinates.end.max(touched);
            let complete = done..part.complete;
            (touched, done) = (fresh.end, complete.end);
            internal[fresh.clone()].fill(R::zero());
            structure.add_internal_of(part, u, internal);
            if part.elements.is_none() {
                structure.add_holding(equations.time, u, internal);
            }
            unknowns.reduce_within(complete.clone(), internal);
            let Some((rate, predicted)) = equations.inertia else {
                norms.take([external, internal], complete, scratch, weights);
                return;
            };
            inertia[fresh.clone()].fill(R::zero());
            let known = [predicted, moved].map(|known| &known[fresh.clone()]);
            Accelerations { rate }.run(known, [&mut scratch[fresh]]);
            structure.add_mass_times_of(part, R::one(), scratch, inertia);
            unknowns.reduce_within(complete.clone(), inertia);
            norms.take([external, internal, inertia], complete, scratch, weights);
        };
        // What follows or is held acts across parts.
        match unknowns.in_order() && structure.multipliers().is_empty() {
            true => structure.each_part(&mut take),
            false => take(&Part::whole(count)),
        }
        Error::check_length("coordinates of all parts of a structure", done, count)?;
        if open.any() {
            let largest = norms.largest.into_iter().fold(R::zero(), R::larger);
            self.force = largest.where_else(open, self.force);
            norms.unit = Some(R::one() / self.unit());
            let (scratch, weights) = (&mut self.scratch, &self.weights);
            let (external, internal) = (&self.external, &self.internal);
            match equations.inertia {
                Some(_) => {
                    let forces = [external, internal, &self.inertia];
                    norms.take(forces, 0..count, scratch, weights);
                }
                None => norms.take([external, internal], 0..count, scratch, weights),
            }
        }
        Ok(norms.balance())
    }

    /// The external forces on the unknowns.
    fn load<S: Structure<R> + ?Sized>(
        &mut self,
        structure: &S,
        equations: &Equations<'_, R>,
        u: &[R],
    ) -> Result<()> {
        let q = &mut self.external;
        q.fill(R::zero());
        structure.add_external(equations.time, equations.factor, u, q)?;
        let rest = R::one() - equations.factor;
        match equations.rest {
            Rest::Nothing => {}
            Rest::Permanent => structure.add_permanent(equations.time, rest, u, q)?,
            Rest::Start(internal) => {
                for (q, internal) in q.iter_mut().zip(internal) {
                    *q += rest * *internal;
                }
            }
        }
        structure.unknowns().reduce(q);
        self.loaded = true;
        Ok(())
    }

    /// The force by which this solve measures others: squares of those on the smallest beams are no
    /// numbers of single precision.
    pub(super) fn unit(&self) -> R {
        R::one().where_else(self.force.at_most(R::zero()), self.force)
    }

    /// What rounding may leave of a balance.
    pub(super) fn leftover<S: Structure<R> + ?Sized>(
        &mut self,
        structure: &S,
        equations: &Equations<'_, R>,
        balance: &Balance<R>,
        u: &[R],
    ) -> Result<R> {
        match self.assembled {
            Assembled::Tangent => {}
            Assembled::WithMass(mass) => {
                structure.add_mass(-mass, &mut self.tangent)?;
                self.assembled = Assembled::Tangent;
            }
            // Not kept, for lanes come to ask at iterations of their own.
            Assembled::Nothing => {
                self.tangent.clear();
                self.add_tangent(structure, equations, u, None)?;
            }
        }
        let floor = self.rounding(structure, u)?;
        Ok(floor / self.unit() + balance.scale * R::lit(8.0 * R::EPSILON))
    }

    /// Norm of the forces that the tangent makes of a rounding unit of numbers of the sizes given:
    /// with displacements, what the library's own strains leave; with the natural sizes of the
    /// coordinates, what any law does that forms its strains from the whole of them.
    pub(super) fn rounding<S: Structure<R> + ?Sized>(
        &mut self,
        structure: &S,
        sizes: &[R],
    ) -> Result<R> {
        let unknowns = structure.unknowns();
        unknowns.gather(sizes, &mut self.unknown);
        let stored = self.tangent.stored();
        stored.abs_mul_vec(&self.unknown, &mut self.rounded)?;
        let measure = structure.measure();
        let multipliers = structure.multipliers();
        if !multipliers.is_empty() {
            // Constraints are formed from positions, which are as large as the structure however
            // small its displacements.
            unknowns.gather(measure, &mut self.unknown);
            stored.abs_mul_vec(&self.unknown, &mut self.positions)?;
            for (q, rounded) in self.rounded.iter_mut().enumerate() {
                if multipliers.contains(&unknowns.free()[q]) {
                    *rounded = self.positions[q] * R::lit(4.0);
                }
            }
        }
        let force = self.unit();
        let mut square = R::zero();
        for (rounded, &i) in self.rounded.iter().zip(unknowns.free()) {
            let part = *rounded / force * self.weights[i];
            square += part * part;
        }
        Ok(norm(square) * R::lit(R::EPSILON) * self.unit())
    }

    /// What one more correction would change of the displacements `u` just solved for, largest over
    /// largest in natural sizes, when the factors are those of the tangent at `u`. Where rounding is
    /// all that is left of the residual, this is what it takes of the answer: forces that rounding
    /// leaves but that bend nothing do not count, and a tangent that is all rounding itself would
    /// go on as it came. Zero where nothing moved.
    pub(crate) fn open<S: Structure<R> + ?Sized>(&mut self, structure: &S, u: &[R]) -> Result<f64> {
        let (free, multipliers) = (structure.unknowns().free(), structure.multipliers());
        let measure = structure.measure();
        let unknowns = structure.unknowns();
        unknowns.gather(&self.scratch, &mut self.unknown);
        self.factor.solve(&mut self.unknown)?;
        let (mut change, mut moved) = (R::zero(), R::zero());
        for (x, &i) in self.unknown.iter().zip(free) {
            if !multipliers.contains(&i) {
                change = change.larger((*x / measure[i]).abs());
                moved = moved.larger((u[i] / measure[i]).abs());
            }
        }
        let still = moved.at_most(R::zero());
        let share = change / R::one().where_else(still, moved);
        Ok(R::zero().where_else(still, share).largest())
    }
}

elementwise! {
    /// Accelerations after corrections of displacements.
    Accelerations(rate): [predicted, moved] -> [acceleration] {
        *acceleration = predicted + rate * moved;
    }
}

/// Partial sums of a reduction, which registers hold side by side; as many whatever the registers, so
/// that all of them round alike.
pub(super) const PARTS: usize = 8;

/// What the norms of a residual and of the forces it is made of are formed from, by parts of the forces.
struct Norms<R> {
    /// Reciprocal of the unit of forces; as long as there is none, the largest of them is looked for.
    unit: Option<R>,
    largest: [R; PARTS],
    /// Partial sums of squares, by weights: of the residual, and of each force.
    left: [R; PARTS],
    own: [[R; PARTS]; 3],
}

impl<R: Real> Norms<R> {
    fn new(unit: Option<R>) -> Self {
        let zeros = [R::zero(); PARTS];
        Self {
            unit,
            largest: zeros,
            left: zeros,
            own: [zeros; 3],
        }
    }

    fn balance(self) -> Balance<R> {
        let sum = |parts: [R; PARTS]| parts.into_iter().sum::<R>();
        let largest = self.own.map(sum).into_iter().fold(R::zero(), R::larger);
        // A state without any force is its own solution: avoid 0 / 0.
        let scale = R::one().where_else(largest.at_most(R::zero()), largest);
        Balance {
            residual: norm(sum(self.left)),
            scale: norm(scale),
        }
    }

    /// Takes forces on some coordinates: with a unit, overwrites the `residual` there, the first force
    /// less the others, and adds the squares; without, looks for the largest. Sums round as those of the
    /// whole do where all parts but the last are multiples of [`PARTS`] long.
    fn take<const N: usize>(
        &mut self,
        forces: [&Vec<R>; N],
        within: Range<usize>,
        residual: &mut [R],
        weights: &[R],
    ) {
        let forces = forces.map(|force| &force[within.clone()]);
        match self.unit {
            Some(unit) => self.add(
                forces,
                &mut residual[within.clone()],
                &weights[within],
                unit,
            ),
            None => self.enlarge(forces),
        }
    }

    fn enlarge<const N: usize>(&mut self, forces: [&[R]; N]) {
        let largest = &mut self.largest;
        R::dispatch(Loops(
            #[inline(always)]
            || {
                for some in forces.iter().flat_map(|force| force.chunks(PARTS)) {
                    for (largest, force) in largest.iter_mut().zip(some) {
                        *largest = largest.larger(force.abs());
                    }
                }
            },
        ));
    }

    fn add<const N: usize>(
        &mut self,
        forces: [&[R]; N],
        residual: &mut [R],
        weights: &[R],
        unit: R,
    ) {
        R::dispatch(Loops(
            #[inline(always)]
            || {
                let count = residual.len();
                let whole = count - count % PARTS;
                for at in (0..whole).step_by(PARTS) {
                    let forces = array(|n| load(&forces[n][at..]));
                    let rest = self.add_some::<N>(forces, &load(&weights[at..]), unit);
                    residual[at..at + PARTS].copy_from_slice(&rest);
                }
                let left = count - whole;
                if left > 0 {
                    let last = array(|n: usize| load_some(&forces[n][whole..]));
                    let weights = load_some(&weights[whole..]);
                    let rest = self.add_some::<N>(last, &weights, unit);
                    residual[whole..].copy_from_slice(&rest[..left]);
                }
            },
        ));
    }

    #[inline(always)]
    fn add_some<const N: usize>(
        &mut self,
        forces: [[R; PARTS]; N],
        weights: &[R; PARTS],
        unit: R,
    ) -> [R; PARTS] {
        let mut rest = forces[0];
        for n in 1..N {
            for k in 0..PARTS {
                rest[k] -= forces[n][k];
            }
        }
        // Twice a factor, and not by their product, which leaves the range of singles.
        for k in 0..PARTS {
            let part = rest[k] * unit * weights[k];
            self.left[k] += part * part;
        }
        for n in 0..N {
            for k in 0..PARTS {
                let part = forces[n][k] * unit * weights[k];
                self.own[n][k] += part * part;
            }
        }
        rest
    }
}

/// The numbers of a slice of less than [`PARTS`], and zeros.
#[inline(always)]
fn load_some<R: Real>(from: &[R]) -> [R; PARTS] {
    let mut some = [R::zero(); PARTS];
    some[..from.len()].copy_from_slice(from);
    some
}

/// The first numbers of a slice.
#[inline(always)]
fn load<R: Real>(from: &[R]) -> [R; PARTS] {
    let from = &from[..PARTS];
    array(|k| from[k])
}

/// Square root that carries a zero derivative at zero instead of NaN.
pub(crate) fn norm<R: Real>(square: R) -> R {
    if R::ORDER > 0 && square.is_zero() {
        R::zero()
    } else {
        square.sqrt()
    }
}
