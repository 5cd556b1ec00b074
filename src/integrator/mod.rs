//! Time integration: one file per method behind [`Method`], and one driver for all of them with
//! fixed or error-controlled steps. A step allocates nothing; a failed or rejected step leaves the
//! last good state untouched.

mod driver;
mod newmark;

pub use driver::{Adaptive, Integration, Observation, RunReport, Step, Stepping};
pub use newmark::{Estimator, Newmark, NewmarkMethod};

use crate::error::Result;
use crate::scalar::Real;
use crate::solver::{Solved, State, Structure};

/// A time integration scheme: settings from which a run makes the [`Method`] at work.
pub trait Scheme<R: Real> {
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
    const ERROR_ORDER: i32;

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
    /// both root-mean-squares over the coordinates in their natural sizes.
    fn error<S: Structure<R>>(&self, structure: &S, now: &State<R>, next: &State<R>) -> (R, R);

    /// Tells the method that the step was taken: history moves on.
    fn accept(&mut self, now: &State<R>, next: &State<R>);
}
