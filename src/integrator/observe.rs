//! What observers of a run see, and what they may answer.

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
    /// Order of the method, which that of the interpolation follows.
    pub(super) order: i32,
}

impl<R: Real> Step<'_, R> {
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

/// What an observer may return: nothing, or a [`Result`] whose error ends the run after the step.
pub trait Observation {
    /// The observation as a result.
    ///
    /// # Errors
    /// The observer's own.
    fn result(self) -> Result<()>;
}

impl Observation for () {
    fn result(self) -> Result<()> {
        Ok(())
    }
}

impl Observation for Result<()> {
    fn result(self) -> Result<()> {
        self
    }
}
