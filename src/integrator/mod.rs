//! Time integration: one file per method behind [`Method`], and one driver for all of them with
//! fixed, error-controlled or stability-bound steps and with events. A step allocates nothing; a
//! failed or rejected step leaves the last good state untouched. Every method holds nonlinear
//! constraints by Lagrange multipliers, of which the state keeps the last.
//!
//! | scheme | order | what it is for |
//! |---|---|---|
//! | [`Newmark::trapezoidal`] | 2 | the paper's runs; no dissipation, and no bound on the energy of long stiff runs |
//! | [`Newmark::hht`], [`Newmark::generalised_alpha`] | 2 | dissipation of what the step does not resolve, tuned by one parameter |
//! | [`Midpoint`] | 2 | symplectic; momenta kept |
//! | [`EnergyMomentum`] | 2 | long runs: energy and momenta kept to rounding, or the energy let down at will |
//! | [`Collocation::gauss`], [`Collocation::radau`] | 3 to 6 | accuracy; Radau's dissipates what it does not resolve |
//! | [`CentralDifference`] | 2 | explicit: impacts and waves, steps below the stability limit |

mod collocation;
mod driver;
mod energy_momentum;
mod event;
mod explicit;
mod held;
mod midpoint;
mod newmark;
mod observe;
mod pace;
mod progress;
mod stepping;

pub use collocation::{Collocation, CollocationMethod};
pub use driver::{Integration, RunReport};
pub use energy_momentum::{EnergyMomentum, EnergyMomentumMethod};
pub use event::Crossing;
pub use explicit::{CentralDifference, CentralDifferenceMethod};
pub use midpoint::{Midpoint, MidpointMethod};
pub use newmark::{Estimator, Newmark, NewmarkMethod};
pub use observe::{Log, Refusal, Silent, Step};
pub use progress::Checkpoint;
pub use stepping::{Adaptive, Stepping};

pub use crate::solver::{Ending, Observation};

use crate::error::{Error, Result};
use crate::scalar::Real;
use crate::solver::{Rate, Solved, State, Structure, Tape, Workspace, norm};

/// A time integration scheme: settings from which a run makes the [`Method`] at work. Its `Debug`
/// text names all of them: by it a [`Checkpoint`] knows the scheme it was taken from.
pub trait Scheme<R: Real>: std::fmt::Debug {
    /// The scheme at work on a structure.
    type Method: Method<R>;

    /// Allocates the workspace for a structure and makes the state consistent.
    ///
    /// # Errors
    /// For settings out of range, a structure without mass, a state that does not fit.
    fn start<S: Structure<R>>(&self, structure: &S, state: &mut State<R>) -> Result<Self::Method>;
}

/// A one-step method at work, with whatever workspace and history it keeps.
pub trait Method<R: Real> {
    /// Power of the step with which [`error`](Self::error) shrinks.
    fn error_order(&self) -> i32 {
        3
    }

    /// Order of accuracy: the power of the step with which the error at a given time shrinks.
    /// From the fifth on, observers see inside a step by quintic interpolation, which takes
    /// accelerations, and below by cubic.
    fn order(&self) -> i32 {
        2
    }

    /// Longest stable step (s) at a state; none for methods that are stable at any.
    ///
    /// # Errors
    /// When it cannot be found.
    fn stable_step<S: Structure<R>>(
        &mut self,
        _structure: &S,
        _now: &State<R>,
    ) -> Result<Option<R>> {
        Ok(None)
    }

    /// Makes `next` from `now`, `step` seconds later.
    ///
    /// # Errors
    /// When the step's equations cannot be solved; `next` is then meaningless, `now` is untouched.
    fn advance<S: Structure<R>>(
        &mut self,
        structure: &S,
        now: &State<R>,
        next: &mut State<R>,
        step: R,
    ) -> Result<Solved>;

    /// Local error of the displacements of the step just made and the size of the displacements,
    /// both root-mean-squares over the coordinates in their natural sizes. Ask for it at every step:
    /// methods may keep what the next estimate takes of this one only then.
    fn error<S: Structure<R>>(&mut self, structure: &S, now: &State<R>, next: &State<R>) -> (R, R);

    /// Shows the tape all that the next step depends on beside the state, so that a run can be
    /// saved and resumed: each number once, always in the same order.
    ///
    /// # Errors
    /// Those of the tape.
    fn history(&mut self, tape: &mut Tape<R>) -> Result<()>;

    /// Tells the method that the step was taken: history moves on.
    fn accept(&mut self, now: &State<R>, next: &State<R>);
}

/// What every scheme does at the start: refuses a structure without mass and a state that does not
/// fit, holds the supports, and makes the acceleration consistent.
fn prepare<R: Real, S: Structure<R>>(structure: &S, state: &mut State<R>) -> Result<Workspace<R>> {
    if !structure.has_mass() {
        return Err(Error::Unsupported {
            what: "dynamics of a structure without mass".into(),
            remedy: "give the beams a density with Beam::density, or solve statics",
        });
    }
    state.check(structure.unknowns().coordinates())?;
    let time = state.time;
    structure.impose(time, Rate::Displacement, &mut state.displacement)?;
    structure.impose(time, Rate::Velocity, &mut state.velocity)?;
    let mut workspace = Workspace::new(structure);
    workspace.accelerate(structure, state)?;
    Ok(workspace)
}

/// Makes a guessed mean acceleration over a step that which brings the coordinates that are not
/// solved for to the velocity they must have at its end.
fn impose_mean<R: Real, S: Structure<R>>(
    structure: &S,
    (now, end): (&State<R>, R),
    mean: &mut [R],
    scratch: &mut [R],
) -> Result<()> {
    let step = end - now.time;
    for i in 0..mean.len() {
        scratch[i] = now.velocity[i] + step * mean[i];
    }
    structure.impose(end, Rate::Velocity, scratch)?;
    for i in 0..mean.len() {
        // Nothing but what had to change, so that rounding is not divided by the step.
        let change = scratch[i] - (now.velocity[i] + step * mean[i]);
        mean[i] += change / step;
    }
    Ok(())
}

/// Makes the end of a step, `next.time` its time, from the mean acceleration over it: that guessed
/// and `rate` times what Newton's method corrected. The acceleration left is the mean; multipliers
/// stay as they are in `next`.
fn end_by_mean<R: Real, S: Structure<R>>(
    structure: &S,
    (guess, rate, moved): (&[R], R, &[R]),
    now: &State<R>,
    next: &mut State<R>,
    step: R,
) -> Result<()> {
    let half = step * R::lit(0.5);
    let multipliers = structure.multipliers();
    for i in multipliers.clone() {
        (next.velocity[i], next.acceleration[i]) = (R::zero(), R::zero());
    }
    for (i, moved) in moved.iter().enumerate() {
        if multipliers.contains(&i) {
            continue;
        }
        let a = guess[i] + rate * *moved;
        let drift = step * (now.velocity[i] + half * a);
        next.acceleration[i] = a;
        next.velocity[i] = now.velocity[i] + step * a;
        next.displacement[i] = now.displacement[i] + drift;
    }
    structure.impose(next.time, Rate::Displacement, &mut next.displacement)?;
    structure.impose(next.time, Rate::Velocity, &mut next.velocity)
}

/// Root-mean-squares, over the coordinates in their natural sizes (multipliers are none), of a local error and of the
/// displacements.
fn mean_squares<R: Real, S: Structure<R>>(
    structure: &S,
    u: &[R],
    local: impl Fn(usize) -> R,
) -> (R, R) {
    let (measure, multipliers) = (structure.measure(), structure.multipliers());
    let (mut error, mut size) = (R::zero(), R::zero());
    for i in (0..measure.len()).filter(|i| !multipliers.contains(i)) {
        let local = local(i) / measure[i];
        error += local * local;
        let moved = u[i] / measure[i];
        size += moved * moved;
    }
    let mean = |square: R| norm(square / R::lit((measure.len() - multipliers.len()) as f64));
    (mean(error), mean(size))
}
