//! What observers and the log of a run see.

use super::RunReport;
use crate::error::{Error, Result};
use crate::scalar::Real;
use crate::solver::State;

/// An accepted step, as observers see it.
#[derive(Debug, Clone, Copy)]
pub struct Step<'a, R> {
    /// State at the start of the step.
    pub before: &'a State<R>,
    /// State at its end.
    pub after: &'a State<R>,
    /// What the run took so far, this step included.
    pub report: &'a RunReport,
    /// Start of the integration and end of the run under way (s).
    pub(super) span: [R; 2],
    /// Order of the method, which that of the interpolation follows.
    pub(super) order: i32,
}

impl<R: Real> Step<'_, R> {
    /// Length of the step (s).
    pub fn length(&self) -> R {
        self.after.time - self.before.time
    }

    /// Share of the way from the start of the integration, wherever it was resumed since, to the end
    /// of the run under way: from 0 to 1.
    pub fn share(&self) -> f64 {
        let [start, end] = self.span;
        ((self.after.time - start) / (end - start)).value().min(1.0)
    }

    /// Whether a time (s) lies within the step: after its start, up to its end.
    pub fn contains(&self, time: R) -> bool {
        time > self.before.time && time <= self.after.time
    }

    /// Displacement of coordinate `i` at a time (s) within the step, by Hermite interpolation: cubic
    /// from displacements and velocities (error of the fourth order in the step), quintic from
    /// accelerations, too (sixth order), where the method is of the fifth order or more.
    ///
    /// # Errors
    /// [`Error::NoSuchCoordinate`] when the structure has no coordinate `i`.
    pub fn displacement_at(&self, time: R, i: usize) -> Result<R> {
        let size = self.after.displacement.len();
        if i >= size {
            return Err(Error::NoSuchCoordinate { index: i, size });
        }
        let (before, after) = (self.before, self.after);
        let step = after.time - before.time;
        let x = (time - before.time) / step;
        let y = R::one() - x;
        let (two, three) = (R::lit(2.0), R::lit(3.0));
        let (u0, u1) = (before.displacement[i], after.displacement[i]);
        let (v0, v1) = (before.velocity[i], after.velocity[i]);
        let cubic = x * x * (three - two * x) * (u1 - u0) + step * x * y * (y * v0 - x * v1);
        if self.order < 5 {
            return Ok(u0 + cubic);
        }
        // What the cubic misses of the accelerations at both ends.
        let six = R::lit(6.0);
        let mean = (u1 - u0) / step;
        let a0 = (six * mean - R::lit(4.0) * v0 - two * v1) / step;
        let a1 = (two * v0 + R::lit(4.0) * v1 - six * mean) / step;
        let missed = y * (before.acceleration[i] - a0) + x * (after.acceleration[i] - a1);
        let bubble = x * x * y * y * step * step * R::lit(0.5);
        Ok(u0 + cubic + bubble * missed)
    }
}

/// A step that was tried and not taken, as the [log](super::Integration::logging) sees it.
#[derive(Debug, Clone, Copy)]
pub struct Refusal<'a, R> {
    /// Time at which the step began (s).
    pub time: R,
    /// Length of the step (s).
    pub step: R,
    /// Why it was not taken: [`Error::Inaccurate`] by error control, any other because the step's
    /// equations could not be solved.
    pub cause: &'a Error,
    /// The step asked for instead (s), made shorter still where the end of the run is near; none
    /// where the run ends with the cause.
    pub retry: Option<R>,
}

/// Who is told of refused steps: a closure, or nobody.
pub trait Log<R> {
    /// Takes note of a refused step.
    fn refused(&mut self, refusal: Refusal<'_, R>);
}

/// Nobody is told of refused steps.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl<R> Log<R> for Silent {
    #[inline(always)]
    fn refused(&mut self, _refusal: Refusal<'_, R>) {}
}

impl<R, F: FnMut(Refusal<'_, R>)> Log<R> for F {
    fn refused(&mut self, refusal: Refusal<'_, R>) {
        self(refusal);
    }
}
