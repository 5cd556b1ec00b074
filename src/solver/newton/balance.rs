//! The balance of forces: its residual in the units of the structure, what rounding may leave of it
//! and what that takes of the answer.

use super::{Assembled, Equations, Rest, Workspace, gather};
use crate::error::Result;
use crate::scalar::{Elementwise, Loops, Real, elementwise};
use crate::solver::Structure;
use crate::tensor::array;

/// A force balance: the residual's norm and the largest norm among its parts, in units of the
/// solve's force.
pub(super) struct Balance<R> {
    pub(super) residual: R,
    pub(super) scale: R,
}

impl<R: Real> Workspace<R> {
    /// Residual `Q_e - Q_s - M a` in `scratch`, and its norm.
    pub(super) fn balance<S: Structure<R> + ?Sized>(
        &mut self,
        structure: &S,
        equations: &Equations<'_, R>,
        u: &[R],
    ) -> Result<Balance<R>> {
        self.internal.fill(R::zero());
        self.external.fill(R::zero());
        structure.add_internal(u, &mut self.internal);
        structure.add_holding(equations.time, u, &mut self.internal);
        structure.add_external(equations.time, equations.factor, u, &mut self.external)?;
        let rest = R::one() - equations.factor;
        match equations.rest {
            Rest::Nothing => {}
            Rest::Permanent => {
                structure.add_permanent(equations.time, rest, u, &mut self.external)?;
            }
            Rest::Start(internal) => {
                for (q, internal) in self.external.iter_mut().zip(internal) {
                    *q += rest * *internal;
                }
            }
        }
        match equations.inertia {
            Some((rate, predicted)) => {
                self.inertia.fill(R::zero());
                Accelerations { rate }.run([predicted, &self.moved], [&mut self.scratch]);
                structure.add_mass_times(R::one(), &self.scratch, &mut self.inertia);
                Ok(self.norms(structure, true))
            }
            None => Ok(self.norms(structure, false)),
        }
    }

    /// Residual in `scratch` and the norms of `[external, internal, inertia]` and of their
    /// balance, over what acts on the unknowns: what a support carries is no measure of the rest.
    pub(super) fn norms<S: Structure<R> + ?Sized>(
        &mut self,
        structure: &S,
        inertia: bool,
    ) -> Balance<R> {
        let unknowns = structure.unknowns();
        unknowns.reduce(&mut self.external);
        unknowns.reduce(&mut self.internal);
        if inertia {
            unknowns.reduce(&mut self.inertia);
        }
        let open = self.force.at_most(R::zero());
        if open.any() {
            let mut largest = R::zero();
            for &i in unknowns.free() {
                let inertia = if inertia { self.inertia[i] } else { R::zero() };
                for force in [self.external[i], self.internal[i], inertia] {
                    largest = largest.larger(force.abs());
                }
            }
            self.force = largest.where_else(open, self.force);
        }
        let unit = R::one() / self.unit();
        let (residual, weights) = (&mut self.scratch[..], &self.weights[..]);
        let (residual, largest) = match inertia {
            true => {
                let forces = [&self.external[..], &self.internal, &self.inertia];
                squares(forces, residual, weights, unit)
            }
            false => {
                let forces = [&self.external[..], &self.internal];
                squares(forces, residual, weights, unit)
            }
        };
        // A state without any force is its own solution: avoid 0 / 0.
        let scale = R::one().where_else(largest.at_most(R::zero()), largest);
        Balance {
            residual: norm(residual),
            scale: norm(scale),
        }
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
        gather(unknowns, sizes, &mut self.unknown);
        let stored = self.tangent.stored();
        stored.abs_mul_vec(&self.unknown, &mut self.rounded)?;
        let measure = structure.measure();
        let multipliers = structure.multipliers();
        if !multipliers.is_empty() {
            // Constraints are formed from positions, which are as large as the structure however
            // small its displacements.
            gather(unknowns, measure, &mut self.unknown);
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
        gather(structure.unknowns(), &self.scratch, &mut self.unknown);
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

/// Overwrites the `residual`, the first force less the others; the square of its norm and the largest of
/// those of the forces, in units and by weights.
fn squares<R: Real, const N: usize>(
    forces: [&[R]; N],
    residual: &mut [R],
    weights: &[R],
    unit: R,
) -> (R, R) {
    let mut sums = Squares([R::zero(); PARTS], [[R::zero(); PARTS]; N]);
    R::dispatch(Loops(
        #[inline(always)]
        || {
            let count = residual.len();
            let whole = count - count % PARTS;
            for at in (0..whole).step_by(PARTS) {
                let forces = array(|n| load(&forces[n][at..]));
                let rest = sums.add(forces, &load(&weights[at..]), unit);
                residual[at..at + PARTS].copy_from_slice(&rest);
            }
            let left = count - whole;
            let mut last = [[R::zero(); PARTS]; N];
            let mut weight = [R::zero(); PARTS];
            for k in 0..left {
                weight[k] = weights[whole + k];
                for n in 0..N {
                    last[n][k] = forces[n][whole + k];
                }
            }
            let rest = sums.add(last, &weight, unit);
            residual[whole..].copy_from_slice(&rest[..left]);
        },
    ));
    let Squares(left, own) = sums;
    let sum = |parts: [R; PARTS]| parts.into_iter().sum::<R>();
    let largest = own.map(sum).into_iter().fold(R::zero(), R::larger);
    (sum(left), largest)
}

/// Partial sums of the squares of a residual and of the forces it is made of.
struct Squares<R, const N: usize>([R; PARTS], [[R; PARTS]; N]);

impl<R: Real, const N: usize> Squares<R, N> {
    #[inline(always)]
    fn add(&mut self, forces: [[R; PARTS]; N], weights: &[R; PARTS], unit: R) -> [R; PARTS] {
        let mut rest = forces[0];
        for n in 1..N {
            for k in 0..PARTS {
                rest[k] -= forces[n][k];
            }
        }
        // Twice a factor, and not by their product, which leaves the range of singles.
        for k in 0..PARTS {
            let part = rest[k] * unit * weights[k];
            self.0[k] += part * part;
        }
        for n in 0..N {
            for k in 0..PARTS {
                let part = forces[n][k] * unit * weights[k];
                self.1[n][k] += part * part;
            }
        }
        rest
    }
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
