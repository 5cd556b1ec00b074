//! What observers of a run, in time or along a path, may answer, and how a run ended.

use std::ops::ControlFlow;

use crate::error::Result;

/// How a run ended, in time or along a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// The end asked for is reached.
    End,
    /// The event happened (in time alone).
    Event,
    /// The observer stopped the run, which can go on from there as if it had not been stopped.
    Stopped,
}

/// What an observer may return: nothing, a [`ControlFlow`] whose `Break` stops the run after the
/// step, or a [`Result`] of either, whose error ends the run after the step.
pub trait Observation {
    /// Whether the run goes on.
    ///
    /// # Errors
    /// The observer's own.
    fn flow(self) -> Result<ControlFlow<()>>;
}

impl Observation for () {
    fn flow(self) -> Result<ControlFlow<()>> {
        Ok(ControlFlow::Continue(()))
    }
}

impl Observation for ControlFlow<()> {
    fn flow(self) -> Result<ControlFlow<()>> {
        Ok(self)
    }
}

impl<O: Observation> Observation for Result<O> {
    fn flow(self) -> Result<ControlFlow<()>> {
        self?.flow()
    }
}
