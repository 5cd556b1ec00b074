//! What the user chooses of Newton's method, and what a solve reports.

use crate::error::{Error, Result};
use crate::scalar::Mask;

/// When the tangent is evaluated and factorised anew.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Refresh {
    /// In every iteration: full Newton, quadratic convergence.
    #[default]
    EveryIteration,
    /// Once per solve (load or time step).
    EverySolve,
    /// When the old one no longer reduces the residual fast enough to pay for its age.
    WhenSlow,
    /// Once, at the first solve: how modified Newton fails, for comparison. Paths of equilibria form the
    /// tangent at each of their points to tell its stability, and begin from there.
    Never,
}

/// Settings of Newton's method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Newton {
    /// Residual accepted, relative to the largest of internal, external and inertia forces.
    pub residual: f64,
    /// Correction accepted, relative to the natural sizes of the coordinates.
    pub correction: f64,
    /// Iterations allowed per solve.
    pub iterations: usize,
    /// When the tangent is renewed.
    pub refresh: Refresh,
    /// Whether a correction that overshoots, so that the forces left work against it, is shortened.
    /// Cables and nets that stand by their tension converge so from a straight or slack state under
    /// any load, where full corrections need many short load steps or fail; corrections that do not
    /// overshoot cost nothing. Not for bending: a thin beam comes to its bent state through
    /// stretched ones of high energy, and shortened corrections creep. Without effect where there are
    /// nonlinear constraints, and along paths, where the load gives way instead: a wire that full
    /// corrections cannot hang at once takes three points of an arc length without
    /// [`load_weight`](crate::solver::Path::load_weight), 16 corrections and no refused step.
    pub line_search: bool,
}

impl Default for Newton {
    fn default() -> Self {
        Self {
            residual: 1e-10,
            correction: 1e-6,
            iterations: 40,
            refresh: Refresh::EveryIteration,
            line_search: false,
        }
    }
}

impl Newton {
    pub(crate) fn check(&self) -> Result<()> {
        for (what, value) in [
            ("Newton's residual tolerance", self.residual),
            ("Newton's correction tolerance", self.correction),
        ] {
            crate::error::positive(what, value)?;
        }
        if self.iterations == 0 {
            return Err(Error::TooFew {
                what: "number of Newton iterations",
                value: 0,
                least: 1,
                remedy: "allow at least one iteration (40 by default)",
            });
        }
        Ok(())
    }
}

/// What one solve took; in lanes, the most that any of them did.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Solved {
    /// Corrections made.
    pub iterations: usize,
    /// The fewest corrections after which a lane had converged.
    pub(crate) fewest: usize,
    /// Tangents evaluated and factorised.
    pub tangents: usize,
    /// Last residual over the force scale.
    pub residual: f64,
    /// Whether the solve ended above the tolerance, at the residual that rounding leaves: the
    /// answer has no more digits in this number type.
    pub at_floor: bool,
}

impl Solved {
    /// A decision that hangs on the number of corrections.
    pub(crate) fn decide<T: PartialEq>(&self, by: impl Fn(usize) -> T) -> T {
        let decision = by(self.iterations);
        // What lanes in between decide does not matter: if these differ, the run is void.
        let _ = Mask::among(decision == by(self.fewest)).common();
        decision
    }
}
