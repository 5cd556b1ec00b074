//! How a run chooses its steps.

use crate::error::{Error, Result, positive};

/// How steps are chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stepping {
    /// Equal steps of this many seconds; a step that fails ends the run.
    Fixed(f64),
    /// Equal steps (s); one that fails is made of two halves, and each of these again, up to
    /// `halvings` times.
    Halved {
        /// Step (s).
        step: f64,
        /// How often a step may be halved.
        halvings: u32,
    },
    /// Steps of this share of the longest stable one, for explicit methods.
    Stable(f64),
    /// Steps by local error control.
    Adaptive(Adaptive),
}

/// Error-controlled stepping: a step is accepted when its relative local error `e` is below the
/// tolerance, and the next is `safety dt (tolerance / e)^(i/k) (e_before / e)^(p/k)` with the power
/// `k` of the step that the error follows, an integral and a proportional gain (Gustafsson 1991).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Adaptive {
    /// Relative local error allowed.
    pub tolerance: f64,
    /// First step (s).
    pub first: f64,
    /// Longest step (s).
    pub longest: f64,
    /// Shortest step (s): below it the run ends with an error.
    pub shortest: f64,
    /// Factor applied to the step that would just meet the tolerance.
    pub safety: f64,
    /// Integral and proportional gain. Without the second (the paper's procedure) steps follow the
    /// error at once, with it they follow smoothly and fewer are rejected.
    pub gains: [f64; 2],
    /// Displacements, as a share of the size of the structure, below which the error is measured
    /// against this share and no longer against the motion: motions far smaller than it are not
    /// resolved. The motion is the largest so far.
    pub least_motion: f64,
}

impl Adaptive {
    /// Error control to `tolerance`, the procedure of the paper
    /// (`0.8 dt (tolerance / error)^(1/3)`), with usual limits: first step 10 us, steps between
    /// 1 ns and 0.1 s, least motion a millionth of the structure.
    pub fn to(tolerance: f64) -> Self {
        Self {
            tolerance,
            first: 1e-5,
            longest: 0.1,
            shortest: 1e-9,
            safety: 0.8,
            gains: [1.0, 0.0],
            least_motion: 1e-6,
        }
    }

    /// Error control to `tolerance` by proportional and integral gains: smoother steps, closer to
    /// the longest that the tolerance allows.
    pub fn smoothly_to(tolerance: f64) -> Self {
        Self {
            safety: 0.9,
            gains: [0.3, 0.4],
            ..Self::to(tolerance)
        }
    }

    pub(super) fn check(&self) -> Result<()> {
        for (what, value) in [
            ("tolerance of the local error", self.tolerance),
            ("first time step [s]", self.first),
            ("longest time step [s]", self.longest),
            ("shortest time step [s]", self.shortest),
            ("safety factor of the step control", self.safety),
            ("integral gain of the step control", self.gains[0]),
            ("least motion of the error control", self.least_motion),
        ] {
            positive(what, value)?;
        }
        if !(0.0..=1.0).contains(&self.gains[1]) {
            return Err(Error::OutOfRange {
                what: "proportional gain of the step control",
                value: self.gains[1],
                range: "0 to 1",
                remedy: "use Adaptive::to (none) or Adaptive::smoothly_to (0.4)",
            });
        }
        Ok(())
    }
}
