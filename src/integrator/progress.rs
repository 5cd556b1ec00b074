//! How far an integration has come, which its checkpoints know.

use super::driver::RunReport;
use super::pace::Pace;
use crate::error::{Result, finite, positive};
use crate::scalar::Real;

/// An integration between two steps, to be resumed: taken by
/// [`Integration::checkpoint`](super::Integration::checkpoint), used by
/// [`Integration::resume`](super::Integration::resume).
pub type Checkpoint<R> = crate::solver::Checkpoint<R, Progress<R>>;

impl<R: Real> Checkpoint<R> {
    /// What the run had taken up to there.
    pub fn report(&self) -> RunReport {
        self.progress().report
    }
}

/// How far a run has come and what its step control remembers: all of it but the state and what the
/// method remembers itself.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Progress<R> {
    /// Time at which the integration began (s).
    pub(super) start: R,
    pub(super) report: RunReport,
    /// Step the error control would take next (s).
    pub(super) proposed: Option<R>,
    /// Error of the last step accepted over the one allowed.
    pub(super) error: f64,
    /// Largest size of the motion so far.
    pub(super) motion: R,
    /// Equal steps under way.
    pub(super) pace: Option<Pace<R>>,
}

impl<R: Real> Progress<R> {
    pub(super) fn new(start: R) -> Self {
        Self {
            start,
            report: RunReport::default(),
            proposed: None,
            error: 1.0,
            motion: R::zero(),
            pace: None,
        }
    }

    pub(super) fn check(&self) -> Result<()> {
        finite("time at which the integration began [s]", self.start)?;
        finite("largest size of the motion", self.motion)?;
        positive("error of the last step over the one allowed", self.error)?;
        if let Some(step) = self.proposed {
            positive("time step proposed [s]", step)?;
        }
        Ok(())
    }
}
