//! States that agree with what holds them: accelerations from the balance of forces, and
//! displacements, velocities and accelerations brought onto nonlinear constraints by one saddle point
//! of mass and derivatives. What integrators do besides solving for a step.

use super::super::structure::add_projection;
use super::{Equations, Rest, STALLED, Workspace, singular, solve_by};
use crate::error::{Error, Result};
use crate::scalar::Real;
use crate::solver::{Rate, State, Structure};

/// Corrections allowed to bring displacements onto the constraints, and their size in rounding units
/// of the structure's below which they may stop falling.
const RESTORATIONS: usize = 50;
const NOISE: f64 = 1e3;

impl<R: Real> Workspace<R> {
    /// Makes the acceleration of a state consistent: `M a = Q_e - Q_s`.
    pub(crate) fn accelerate<S: Structure<R> + ?Sized>(
        &mut self,
        structure: &S,
        state: &mut State<R>,
    ) -> Result<()> {
        // Motions given in time bring accelerations of their own, whose inertia is a load.
        state.acceleration.fill(R::zero());
        structure.impose(state.time, Rate::Acceleration, &mut state.acceleration)?;
        let equations = Equations {
            time: state.time,
            factor: R::one(),
            rest: Rest::Nothing,
            inertia: Some((R::zero(), &state.acceleration)),
        };
        self.loaded = self.lasts(&equations);
        self.balance(structure, &equations, None, &mut state.displacement)?;
        let multipliers = structure.multipliers();
        // Constraints turn with the motion, the mass alone never changes.
        let mass = structure.mass_factor();
        if !(self.held_mass && multipliers.is_empty()) {
            self.forget();
            self.tangent.clear();
            add_projection(
                structure,
                state.time,
                &state.displacement,
                &mut self.tangent,
            )?;
            let factored = self.factor.factor(self.tangent.stored());
            factored.map_err(|error| match singular(structure, error.clone()) {
                redundant @ Error::Redundant { .. } => redundant,
                _ => error,
            })?;
            self.held_mass = true;
        }
        for force in &mut self.scratch {
            *force *= mass;
        }
        self.scratch[multipliers.clone()].fill(R::zero());
        self.solve_linear(structure.unknowns())?;
        for (a, change) in state.acceleration.iter_mut().zip(&self.scratch) {
            *a += *change;
        }
        for i in multipliers {
            state.displacement[i] += self.scratch[i] / mass;
        }
        self.settle(structure, state)
    }

    /// Makes velocity and acceleration of a state obey the constraints, by the smallest change in
    /// kinetic energy, and the multipliers balance the acceleration. Without constraints there is
    /// nothing to do.
    pub(crate) fn settle<S: Structure<R> + ?Sized>(
        &mut self,
        structure: &S,
        state: &mut State<R>,
    ) -> Result<()> {
        let multipliers = structure.multipliers();
        if multipliers.is_empty() {
            return Ok(());
        }
        state.velocity[multipliers.clone()].fill(R::zero());
        state.acceleration[multipliers.clone()].fill(R::zero());
        self.project(structure, state.time, &state.displacement)?;
        for rate in [Rate::Velocity, Rate::Acceleration] {
            let (u, v, a) = (&state.displacement, &state.velocity, &state.acceleration);
            let motion = [&u[..], v, a];
            let known = if rate == Rate::Velocity { 2 } else { 3 };
            self.close(structure, state.time, &motion[..known])?;
            let x = match rate {
                Rate::Acceleration => &mut state.acceleration,
                _ => &mut state.velocity,
            };
            for i in (0..x.len()).filter(|i| !multipliers.contains(i)) {
                x[i] += self.scratch[i];
            }
        }
        let mass = structure.mass_factor();
        for i in multipliers {
            state.displacement[i] += self.scratch[i] / mass;
        }
        Ok(())
    }

    /// Moves a state's displacements onto the constraints along the directions `M^-1 G^T` in which
    /// these push at the state `from`, or at its own where none is given: with the former the
    /// positions of SHAKE (Ryckaert, Ciccotti and Berendsen 1977), with the latter the nearest
    /// ones in the metric of the mass. [`moved`](Self::moved) tells by how much.
    pub(crate) fn restore<S: Structure<R> + ?Sized>(
        &mut self,
        structure: &S,
        from: Option<&State<R>>,
        state: &mut State<R>,
    ) -> Result<()> {
        self.moved.fill(R::zero());
        self.corrected = true;
        let multipliers = structure.multipliers();
        if multipliers.is_empty() {
            return Ok(());
        }
        let at = from.unwrap_or(state);
        self.project(structure, at.time, &at.displacement)?;
        let mut extra = R::ORDER;
        let mut before: Option<R> = None;
        // A chord converges linearly, the faster the shorter the step.
        for _ in 0..RESTORATIONS {
            self.close(structure, state.time, &[&state.displacement])?;
            let mut largest = R::zero();
            for i in (0..self.scratch.len()).filter(|i| !multipliers.contains(i)) {
                let change = self.scratch[i];
                state.displacement[i] += change;
                self.moved[i] += change;
                largest = largest.larger((change / structure.measure()[i]).abs());
            }
            if !largest.finite() {
                break;
            }
            let small = |units: f64| largest <= R::lit(units * R::EPSILON);
            let stalled = before.is_some_and(|before| largest > before * R::lit(STALLED));
            if small(4.0) || (small(NOISE) && stalled) {
                if extra == 0 {
                    return Ok(());
                }
                extra -= 1;
            }
            before = Some(largest);
        }
        Err(Error::Unconverged {
            reason: "the displacements could not be brought onto the constraints",
            iterations: RESTORATIONS,
            residual: before.map_or(f64::NAN, R::value),
        })
    }

    /// Factorises what projects onto the constraints at `u`.
    fn project<S: Structure<R> + ?Sized>(&mut self, structure: &S, time: R, u: &[R]) -> Result<()> {
        if let Some((matrix, factor)) = &mut self.projection {
            matrix.clear();
            add_projection(structure, time, u, matrix)?;
            let factored = factor.factor(matrix.stored());
            factored.map_err(|error| singular(structure, error))?;
        }
        Ok(())
    }

    /// The smallest change, in `scratch`, that takes what the constraints leave of a motion away.
    fn close<S: Structure<R> + ?Sized>(
        &mut self,
        structure: &S,
        time: R,
        motion: &[&[R]],
    ) -> Result<()> {
        self.scratch.fill(R::zero());
        structure.violation(time, motion, &mut self.scratch);
        for residual in &mut self.scratch[structure.multipliers()] {
            *residual = -*residual;
        }
        match &mut self.projection {
            Some((_, factor)) => solve_by(
                |x| factor.solve(x),
                structure.unknowns(),
                &mut self.unknown,
                &mut self.scratch,
            ),
            None => Ok(()),
        }
    }
}
