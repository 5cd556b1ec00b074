//! What a solver knows of a mechanical system: a residual, a tangent and a mass matrix over a
//! vector of coordinates. Beams are one implementation; a pendulum of one unknown in a test is
//! another.

use super::matrix::Matrix;
use super::unknowns::Unknowns;
use crate::error::Result;
use crate::scalar::Real;

/// What a vector of coordinates holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rate {
    /// Displacements.
    Displacement,
    /// Their first derivatives by time.
    Velocity,
    /// Their second derivatives by time.
    Acceleration,
}

/// A structure with `n` coordinates: `M a + Q_s(u) = Q_e(t, u)` (eq. 16 of Orzechowski 2012) in
/// displacements `u` from the reference state. Every method adds to its output.
pub trait Structure<R: Real> {
    /// Which coordinates are solved for, how the others follow from them, and which couple.
    fn unknowns(&self) -> &Unknowns<R>;

    /// Whether the tangent is symmetric at every state.
    fn symmetric(&self) -> bool;

    /// Makes the coordinates that are not solved for obey what binds them: displacements, or
    /// rates of them, as they are at `time` (s). By default no motion is given in time.
    ///
    /// # Errors
    /// When a given motion is not finite.
    fn impose(&self, _time: R, _rate: Rate, x: &mut [R]) -> Result<()> {
        self.unknowns().follow(x);
        Ok(())
    }

    /// Natural size of each coordinate (the length of the body for positions, 1 for slopes): what
    /// makes residuals and corrections comparable between scenes of any size.
    fn measure(&self) -> &[R];

    /// Adds the internal forces `Q_s(u)`.
    fn add_internal(&self, u: &[R], q: &mut [R]);

    /// Adds `factor * Q_e(t, u)`, all external forces; none by default.
    ///
    /// # Errors
    /// When a load is not finite.
    fn add_external(&self, _time: R, _factor: R, _u: &[R], _q: &mut [R]) -> Result<()> {
        Ok(())
    }

    /// Whether there are external forces whose work is counted step by step (nodal loads, which
    /// are no potential of the structure's own); none by default.
    fn has_applied(&self) -> bool {
        false
    }

    /// Adds the part of the external forces whose work is counted.
    ///
    /// # Errors
    /// When a load is not finite.
    fn add_applied(&self, _time: R, _factor: R, _u: &[R], _q: &mut [R]) -> Result<()> {
        Ok(())
    }

    /// Adds the tangent `d(Q_s - factor Q_e)/du` to `k`.
    ///
    /// # Errors
    /// When a load is not finite.
    fn add_tangent(&self, time: R, factor: R, u: &[R], k: &mut Matrix<R>) -> Result<()>;

    /// What coordinate `i` is, in words, for messages.
    fn name(&self, i: usize) -> String {
        format!("coordinate {i}")
    }

    /// Whether a converged state is one the model can mean; by default every state is.
    ///
    /// # Errors
    /// For a state that solves the equations but not the problem, such as a beam turned inside
    /// out.
    fn check(&self, _u: &[R]) -> Result<()> {
        Ok(())
    }

    /// Whether there is a mass matrix.
    fn has_mass(&self) -> bool;

    /// Adds `factor * M a`.
    fn add_mass_times(&self, factor: R, a: &[R], out: &mut [R]);

    /// Adds `factor * M` to a matrix.
    ///
    /// # Errors
    /// When the matrix is of other unknowns.
    fn add_mass(&self, factor: R, k: &mut Matrix<R>) -> Result<()>;

    /// Whether there are gyroscopic forces, as in a rotating frame; none by default.
    fn has_gyroscopic(&self) -> bool {
        false
    }

    /// Adds the gyroscopic forces `G v`, `G` skew; none by default.
    fn add_gyroscopic(&self, _v: &[R], _out: &mut [R]) {}
}
