//! The balance of forces: its residual in the units of the structure, what rounding may leave of it
//! and what that takes of the answer.

use super::{Assembled, Equations, Rest, Workspace};
use crate::error::{Error, Result};
use crate::scalar::{Elementwise, Loops, Mask, Real, elementwise};
use crate::solver::{Part, Structure};
use crate::tensor::array;

/// A force balance: the residual's norm and the largest norm among its parts, in units of the
/// solve's force.
pub(super) struct Balance<R> {
    pub(super) residual: R,
    pub(super) scale: R,
}

impl<R: Real> Workspace<R> {
    /// Makes the correction in `scratch`, where one is due, in the lanes that are to be corrected. Then
    /// the residual `Q_e - Q_s - M a` comes to `scratch`, its norm and that of the largest force, over
    /// what acts on the unknowns: what a support carries is no measure of the rest. Both are formed part
    /// by part, from the last, while the caches hold what the way back through the factors finds. Returns
    /// the largest change that the correction made, too, in natural sizes.
    pub(super) fn balance<S: Structure<R> + ?Sized>(
        &mut self,
        structure: &S,
        equations: &Equations<'_, R>,
        correcting: Option<Mask>,
        u: &mut [R],
    ) -> Result<(Balance<R>, Option<R>)> {
        let unknowns = structure.unknowns();
        // What follows or is held acts across parts, and so do loads that are wanted whole.
        let by_parts = unknowns.in_order() && structure.multipliers().is_empty();
        let following = structure.has_following();
        let mut correction = correcting.map(|open| Correction::of(open, !self.corrected));
        let mut due = correction.as_mut();
        if (following || !by_parts)
            && let Some(correction) = due.take()
        {
            self.find_changes(unknowns);
            let changes = [&self.scratch[..], &self.per_size];
            correction.make([u, &mut self.moved], changes);
            self.corrected = true;
        }
        if !self.loaded || following {
            self.load(structure, equations, u)?;
        }
        self.corrected |= due.is_some();
        // As long as no force is known, the loads tell of the unit: most often rightly.
        let none = self.force.at_most(R::zero());
        if !self.measured && none.any() {
            let loads = self.external.iter().map(|q| q.abs());
            let load = loads.fold(R::zero(), R::larger);
            self.force = load.where_else(none, self.force);
        }
        let mut norms = self.sum(structure, equations, due, by_parts, u)?;
        // The unit stays for all of a solve that starts from some force, and from solve to solve as long
        // as squares by it are numbers.
        let (force, now) = (self.force, norms.largest());
        let mut stays = now.at_most(force * R::lit(FAR)) & force.at_most(now * R::lit(FAR));
        if self.measured {
            stays |= !force.at_most(R::zero());
        }
        self.measured = true;
        if !stays.all() {
            self.force = force.where_else(stays, now);
            norms = self.sum(structure, equations, None, by_parts, u)?;
        }
        Ok((norms.balance(), correction.map(|made| made.size())))
    }

    /// Goes through all parts: makes the correction that is due, and sums forces.
    fn sum<S: Structure<R> + ?Sized>(
        &mut self,
        structure: &S,
        equations: &Equations<'_, R>,
        mut due: Option<&mut Correction<R>>,
        by_parts: bool,
        u: &mut [R],
    ) -> Result<Norms<R>> {
        let (count, unknowns) = (u.len(), structure.unknowns());
        let mut norms = Norms::new(R::one() / self.unit());
        let halfway = self.factor.is_halfway();
        let Self {
            external,
            internal,
            inertia,
            acceleration,
            scratch,
            factor,
            moved,
            corrected,
            weights,
            per_size,
            ..
        } = self;
        // Coordinates from `first` on have been met, from `done` on they are complete.
        let (mut first, mut done) = (count, count);
        let mut take = |part: &Part| {
            let fresh = part.coordinates.start.min(first)..first;
            if let Some(correction) = &mut due {
                if halfway {
                    let found = factor.back(unknowns.before(fresh.start));
                    unknowns.spread_within(fresh.clone(), found, scratch);
                }
                let changes = [&scratch[fresh.clone()], &per_size[fresh.clone()]];
                let changed = [&mut u[fresh.clone()], &mut moved[fresh.clone()]];
                correction.make(changed, changes);
            }
            // Whole blocks, so that sums round as those of the whole do.
            let least = part.complete.next_multiple_of(PARTS);
            let complete = least.max(fresh.start).min(done)..done;
            let (window, begun) = (fresh.start..done, done - first);
            let open = |forces: &mut [R]| {
                forces.copy_within(..begun, fresh.len());
                forces[..fresh.len()].fill(R::zero());
            };
            (first, done) = (window.start, complete.start);
            let sums = complete.start - window.start..complete.end - window.start;
            let on = part.coordinates.start - window.start..window.len();
            let known = &external[complete.clone()];
            let (residual, weights) = (&mut scratch[complete.clone()], &weights[complete.clone()]);
            open(internal);
            structure.add_internal_of(part, u, &mut internal[on.clone()]);
            if part.elements.is_none() {
                structure.add_holding(equations.time, u, internal);
            }
            unknowns.reduce_within(complete.clone(), window.start, internal);
            let Some((rate, predicted)) = equations.inertia else {
                norms.take([known, &internal[sums]], residual, weights);
                return;
            };
            open(inertia);
            let own = part.coordinates.clone();
            let mut a = &predicted[own.clone()];
            if *corrected {
                let corrected = &mut acceleration[..own.len()];
                Accelerations { rate }.run([a, &moved[own]], [&mut *corrected]);
                a = corrected;
            }
            structure.add_mass_times_of(part, R::one(), a, &mut inertia[on]);
            unknowns.reduce_within(complete, window.start, inertia);
            let forces = [known, &internal[sums.clone()], &inertia[sums]];
            norms.take(forces, residual, weights);
        };
        match by_parts {
            true => structure.each_part(&mut take),
            false => take(&Part::whole(count)),
        }
        Error::check_length(
            "coordinates of all parts of a structure",
            count - done,
            count,
        )?;
        Ok(norms)
    }

    /// Whether the external forces are known from a solve before: time steps all take them in full.
    pub(super) fn lasts(&self, equations: &Equations<'_, R>) -> bool {
        self.lasting && equations.inertia.is_some()
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
        self.lasting = structure.is_steady() && equations.inertia.is_some();
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

/// Times that the largest force may be off the unit of forces, either way: squares by it are numbers
/// of single precision yet.
const FAR: f64 = 1024.0;

/// A correction of the lanes that are open, and its largest components in natural sizes.
struct Correction<R> {
    open: Mask,
    /// Whether nothing has moved before.
    first: bool,
    largest: [R; PARTS],
}

impl<R: Real> Correction<R> {
    fn of(open: Mask, first: bool) -> Self {
        let largest = [R::zero(); PARTS];
        Self {
            open,
            first,
            largest,
        }
    }

    /// Adds changes to some coordinates and to what these have moved.
    fn make(&mut self, coordinates: [&mut [R]; 2], changes: [&[R]; 2]) {
        match self.first {
            true => self.add(
                coordinates,
                changes,
                #[inline(always)]
                |_, du| du,
            ),
            false => self.add(
                coordinates,
                changes,
                #[inline(always)]
                |moved, du| moved + du,
            ),
        }
    }

    #[inline(always)]
    fn add(
        &mut self,
        [u, moved]: [&mut [R]; 2],
        [changes, per_size]: [&[R]; 2],
        sum: impl Fn(R, R) -> R,
    ) {
        let Self { open, largest, .. } = self;
        R::dispatch(Loops(
            #[inline(always)]
            || {
                let u = u.chunks_mut(PARTS).zip(moved.chunks_mut(PARTS));
                let changes = changes.chunks(PARTS).zip(per_size.chunks(PARTS));
                for ((u, moved), (changes, per_size)) in u.zip(changes) {
                    let parts = u.iter_mut().zip(moved).zip(changes).zip(per_size);
                    for ((((u, moved), du), per_size), largest) in parts.zip(&mut *largest) {
                        let du = du.where_else(*open, R::zero());
                        *u += du;
                        *moved = sum(*moved, du);
                        *largest = largest.larger((du * *per_size).abs());
                    }
                }
            },
        ));
    }

    fn size(&self) -> R {
        most(self.largest)
    }
}

/// The largest of numbers that are not negative.
fn most<R: Real, const N: usize>(numbers: [R; N]) -> R {
    numbers.into_iter().fold(R::zero(), R::larger)
}

/// What the norms of a residual and of the forces it is made of are formed from, by parts of the forces.
struct Norms<R> {
    /// Reciprocal of the unit of forces.
    unit: R,
    /// The largest of the forces.
    largest: [R; PARTS],
    /// Partial sums of squares, by weights: of the residual, and of each force.
    left: [R; PARTS],
    own: [[R; PARTS]; 3],
}

impl<R: Real> Norms<R> {
    fn new(unit: R) -> Self {
        let zeros = [R::zero(); PARTS];
        Self {
            unit,
            largest: zeros,
            left: zeros,
            own: [zeros; 3],
        }
    }

    fn largest(&self) -> R {
        most(self.largest)
    }

    fn balance(self) -> Balance<R> {
        let sum = |parts: [R; PARTS]| parts.into_iter().sum::<R>();
        let largest = most(self.own.map(sum));
        // A state without any force is its own solution: avoid 0 / 0.
        let scale = R::one().where_else(largest.at_most(R::zero()), largest);
        Balance {
            residual: norm(sum(self.left)),
            scale: norm(scale),
        }
    }

    /// Takes forces on some coordinates: overwrites the `residual` there, the first force less the
    /// others, and adds the squares. From the last block to the first, as parts come: sums round as those
    /// of the whole do where all parts but the last coordinates' are multiples of [`PARTS`] long.
    fn take<const N: usize>(&mut self, forces: [&[R]; N], residual: &mut [R], weights: &[R]) {
        R::dispatch(Loops(
            #[inline(always)]
            || {
                let count = residual.len();
                let whole = count - count % PARTS;
                if whole < count {
                    let last = array(|n: usize| load_some(&forces[n][whole..]));
                    let weights = load_some(&weights[whole..]);
                    let rest = self.add_some::<N>(last, &weights);
                    residual[whole..].copy_from_slice(&rest[..count - whole]);
                }
                for at in (0..whole).step_by(PARTS).rev() {
                    let forces = array(|n| load(&forces[n][at..]));
                    let rest = self.add_some::<N>(forces, &load(&weights[at..]));
                    residual[at..at + PARTS].copy_from_slice(&rest);
                }
            },
        ));
    }

    #[inline(always)]
    fn add_some<const N: usize>(
        &mut self,
        forces: [[R; PARTS]; N],
        weights: &[R; PARTS],
    ) -> [R; PARTS] {
        let unit = self.unit;
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
                self.largest[k] = self.largest[k].larger(forces[n][k].abs());
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
