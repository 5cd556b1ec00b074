//! The implicit midpoint rule: forces half way through the step. It is symplectic and keeps
//! quadratic invariants, linear and angular momentum among them, at any step.

use std::cell::RefCell;

use super::held::{Held, Middle};
use super::{Method, Scheme, end_by_mean, impose_mean, mean_squares, prepare};
use crate::error::Result;
use crate::scalar::Real;
use crate::solver::{
    Equations, Newton, Rate, Rest, Sample, Solved, State, Structure, Tape, Workspace,
};

/// The implicit midpoint rule: `M (v_{n+1} - v_n) / dt = Q(t + dt/2, (u_n + u_{n+1}) / 2)`,
/// `u_{n+1} - u_n = dt (v_n + v_{n+1}) / 2`. Second order, no dissipation. The
/// [`acceleration`](State::acceleration) it leaves is the mean over the step.
///
/// Nonlinear constraints hold at the end of every step to rounding, their multipliers are the means
/// over the step. Velocities obey them in the mean over a step, at its end to second order: bringing
/// them onto the constraints would take energy.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Midpoint {
    /// Newton's method within a step.
    pub newton: Newton,
}

impl<R: Real> Scheme<R> for Midpoint {
    type Method = MidpointMethod<R>;

    fn start<S: Structure<R>>(
        &self,
        structure: &S,
        state: &mut State<R>,
    ) -> Result<MidpointMethod<R>> {
        self.newton.check()?;
        prepare(structure, state)?;
        let mut middle = vec![R::zero(); state.displacement.len()];
        let time = state.time;
        let way = Middle {
            structure,
            from: &state.displacement,
            held: Held {
                at: time,
                end: time,
            },
            end: RefCell::new(&mut middle),
        };
        Ok(MidpointMethod {
            newton: self.newton,
            workspace: Workspace::new(&way),
            middle,
            mean: vec![R::zero(); state.displacement.len()],
            clock: Clock::default(),
        })
    }
}

/// The midpoint rule at work on a structure.
#[derive(Debug)]
pub struct MidpointMethod<R> {
    newton: Newton,
    workspace: Workspace<R>,
    /// Displacements half way.
    middle: Vec<R>,
    /// Mean acceleration guessed.
    mean: Vec<R>,
    clock: Clock<R>,
}

/// Lengths of the step tried and of the last one taken, for methods whose accelerations are means
/// over a step.
#[derive(Debug)]
pub(super) struct Clock<R> {
    step: Option<R>,
    taken: Option<R>,
}

impl<R> Default for Clock<R> {
    fn default() -> Self {
        let (step, taken) = (None, None);
        Self { step, taken }
    }
}

impl<R: Real> Clock<R> {
    /// Notes a step to try, and whether it differs from the one before.
    pub(super) fn changes_to(&mut self, step: R) -> bool {
        let differs = self.step != Some(step);
        self.step = Some(step);
        differs
    }

    pub(super) fn history(&mut self, tape: &mut Tape<R>) -> Result<()> {
        tape.option(&mut self.step)?;
        tape.option(&mut self.taken)
    }

    pub(super) fn accept(&mut self) {
        self.taken = self.step;
    }

    /// The local error `dt^3 jerk / 12` from the change of the mean acceleration between steps, and
    /// the size of the displacements.
    pub(super) fn error<S: Structure<R>>(
        &self,
        structure: &S,
        now: &State<R>,
        next: &State<R>,
    ) -> (R, R) {
        let step = self.step.unwrap_or(R::zero());
        // The first acceleration is that of the start, not a mean.
        let apart = (step + self.taken.unwrap_or(R::zero())) * R::lit(0.5);
        let cube = step * step * step / (R::lit(12.0) * apart);
        mean_squares(structure, &next.displacement, |i| {
            cube * (next.acceleration[i] - now.acceleration[i])
        })
    }
}

impl<R: Real> Method<R> for MidpointMethod<R> {
    fn advance<S: Structure<R>>(
        &mut self,
        structure: &S,
        now: &State<R>,
        next: &mut State<R>,
        step: R,
    ) -> Result<Solved> {
        let half = step * R::lit(0.5);
        let quarter = half * half;
        next.time = now.time + step;
        self.mean.copy_from_slice(&now.acceleration);
        let way = (now, next.time);
        impose_mean(structure, way, &mut self.mean, &mut next.velocity)?;
        for (i, u) in self.middle.iter_mut().enumerate() {
            let drift = half * now.velocity[i] + quarter * self.mean[i];
            *u = now.displacement[i] + drift;
        }
        let halfway = now.time + half;
        structure.impose(halfway, Rate::Displacement, &mut self.middle)?;
        // The mass term of a kept tangent belongs to one step size only.
        if self.clock.changes_to(step) {
            self.workspace.forget();
        }
        let rate = R::one() / quarter;
        let way = Middle {
            structure,
            from: &now.displacement,
            held: Held {
                at: halfway,
                end: next.time,
            },
            end: RefCell::new(&mut next.displacement),
        };
        let equations = Equations {
            time: halfway,
            factor: R::one(),
            rest: Rest::Nothing,
            inertia: Some((rate, &self.mean)),
        };
        let solved = self
            .workspace
            .solve(&way, &self.newton, &equations, &mut self.middle)?;
        for i in structure.multipliers() {
            next.displacement[i] = self.middle[i];
        }
        let corrected = (&self.mean[..], rate, self.workspace.moved());
        end_by_mean(structure, corrected, now, next, step)?;
        let middle = [Sample {
            weight: R::one(),
            time: halfway,
            displacement: &self.middle,
            acceleration: &next.acceleration,
        }];
        next.work = now.work + self.workspace.work(structure, &middle, now, next)?;
        Ok(solved)
    }

    fn error<S: Structure<R>>(&mut self, structure: &S, now: &State<R>, next: &State<R>) -> (R, R) {
        self.clock.error(structure, now, next)
    }

    fn history(&mut self, tape: &mut Tape<R>) -> Result<()> {
        self.clock.history(tape)?;
        self.workspace.history(self.newton.refresh, tape)
    }

    fn accept(&mut self, _now: &State<R>, _next: &State<R>) {
        self.clock.accept();
    }
}
