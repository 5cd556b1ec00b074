//! The state of a structure, which statics and dynamics move on.

use crate::error::{Error, Result};
use crate::scalar::Real;

/// Where a structure is: time, nodal displacements (current minus reference coordinates), their
/// rates, and the work done by nodal loads and given motions so far.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct State<R> {
    /// Time (s); in statics the parameter at which time-dependent loads are taken.
    pub time: R,
    /// Displacement of every coordinate: metres for positions, dimensionless for slopes; after them
    /// the multipliers of nonlinear constraints, if there are any.
    pub displacement: Vec<R>,
    /// Velocity of every coordinate (1/s).
    pub velocity: Vec<R>,
    /// Acceleration of every coordinate (1/s^2): at this time, or its mean over the last step after
    /// methods whose forces are those of a whole step.
    pub acceleration: Vec<R>,
    /// Work of nodal forces and moments and of motions given in time since the state was made (J)
    /// (gravity is a potential and counted apart).
    pub work: R,
}

impl<R: Real> State<R> {
    /// Refuses a state of the wrong size or with a value that is not finite.
    pub(crate) fn check(&self, size: usize) -> Result<()> {
        crate::error::finite("time of the state [s]", self.time)?;
        for (what, values) in [
            ("length of the displacements of a state", &self.displacement),
            ("length of the velocities of a state", &self.velocity),
            ("length of the accelerations of a state", &self.acceleration),
        ] {
            Error::check_length(what, values.len(), size)?;
        }
        for (what, values) in [
            ("displacement in the state", &self.displacement),
            ("velocity in the state", &self.velocity),
            ("acceleration in the state", &self.acceleration),
        ] {
            for value in values {
                crate::error::finite(what, *value)?;
            }
        }
        crate::error::finite("work in the state [J]", self.work)?;
        Ok(())
    }
}
