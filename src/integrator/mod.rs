//! Time integration: one file per method behind [`Method`], and one driver for all of them with
//! fixed or error-controlled steps. A step allocates nothing; a failed or rejected step leaves the
//! last good state untouched.

mod driver;
mod newmark;

pub use driver::{Adaptive, Integration, RunReport, Step, Stepping};
pub use newmark::{Estimator, Newmark};

use crate::error::Result;
use crate::scalar::Real;
use crate::solver::{Solved, State, Structure};

/// A one-step method, with whatever workspace and history it keeps.
pub trait Method<R: Real> {
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

    /// Local error of the displacements of the step just made, relative to the size of the motion.
    fn error<S: Structure<R>>(&mut self, structure: &S, now: &State<R>, next: &State<R>) -> R;

    /// Power of the step with which [`error`](Self::error) shrinks.
    fn error_order(&self) -> u32;

    /// Tells the method that the step was taken: history moves on.
    fn accept(&mut self, now: &State<R>, next: &State<R>);
}
