//! The balance of forces: its residual in the units of the structure, what rounding may leave of it
//! and what that takes of the answer.

use super::{Equations, Rest, Workspace};
use crate::error::Result;
use crate::scalar::{Loops, Real};
use crate::solver::Structure;

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
                for i in 0..u.len() {
                    self.scratch[i] = predicted[i] + rate * self.moved[i];
                }
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
        let squares = R::dispatch(Loops(
            #[inline(always)]
            || {
                let mut squares = [R::zero(); 4];
                for (&i, weight) in unknowns.free().iter().zip(&self.weights) {
                    let (external, internal) = (self.external[i], self.internal[i]);
                    let inertia = if inertia { self.inertia[i] } else { R::zero() };
                    let residual = external - internal - inertia;
                    self.scratch[i] = residual;
                    // Twice a factor, and not by their product, which leaves the range of singles.
                    for (square, part) in squares
                        .iter_mut()
                        .zip([residual, external, internal, inertia])
                    {
                        let part = part * unit * *weight;
                        *square += part * part;
                    }
                }
                squares
            },
        ));
        let largest = squares[1].larger(squares[2]).larger(squares[3]);
        // A state without any force is its own solution: avoid 0 / 0.
        let scale = R::one().where_else(largest.at_most(R::zero()), largest);
        Balance {
            residual: norm(squares[0]),
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
        // With inertia the tangent at hand holds the mass, too. Few solves come to ask, so it is not
        // found before.
        if equations.inertia.is_some() {
            self.tangent.clear();
            self.add_tangent(structure, equations, u)?;
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
        for (q, &i) in self.unknown.iter_mut().zip(unknowns.free()) {
            *q = sizes[i];
        }
        let stored = self.tangent.stored();
        stored.abs_mul_vec(&self.unknown, &mut self.rounded)?;
        let measure = structure.measure();
        let multipliers = structure.multipliers();
        if !multipliers.is_empty() {
            // Constraints are formed from positions, which are as large as the structure however
            // small its displacements.
            for (q, &i) in self.unknown.iter_mut().zip(unknowns.free()) {
                *q = measure[i];
            }
            stored.abs_mul_vec(&self.unknown, &mut self.positions)?;
            for (q, rounded) in self.rounded.iter_mut().enumerate() {
                if multipliers.contains(&unknowns.free()[q]) {
                    *rounded = self.positions[q] * R::lit(4.0);
                }
            }
        }
        let force = self.unit();
        let mut square = R::zero();
        for (rounded, weight) in self.rounded.iter().zip(&self.weights) {
            let part = *rounded / force * *weight;
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
        for (x, &i) in self.unknown.iter_mut().zip(free) {
            *x = self.scratch[i];
        }
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

/// Square root that carries a zero derivative at zero instead of NaN.
pub(crate) fn norm<R: Real>(square: R) -> R {
    if R::ORDER > 0 && square.is_zero() {
        R::zero()
    } else {
        square.sqrt()
    }
}
