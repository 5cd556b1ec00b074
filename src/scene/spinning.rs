//! A system in steady rotation, seen from the frame that turns with it: there it is at rest under
//! centrifugal forces, and vibrates under gyroscopic ones. In absolute nodal coordinates both are
//! the constant mass matrix times a constant matrix.

use super::System;
use crate::error::{Error, Result, finite};
use crate::scalar::Real;
use crate::solver::{Matrix, Rate, Structure, Unknowns};
use crate::tensor::cross;

/// A [`System`] in a frame that turns about an axis through the origin with constant angular
/// velocity, see [`System::spinning`]: `M (a + 2 W v + W^2 x) + Q_s = Q_e` with `W v = omega x v`
/// on every nodal vector and `x` the absolute coordinates. Supports and dead loads turn with the
/// frame. Its centrifugal forces `-M W^2 x` are external ones, so a share of the load is a share of
/// `omega^2`.
///
/// ```
/// use ancf::prelude::*;
///
/// let steel = SaintVenantKirchhoff::isotropic(2.0e11, 0.0)?;
/// let mut scene = Scene::<f64, 2>::new();
/// let blade = Beam::new(FullyParameterised, Rectangle::new(0.01, 0.01)?, Continuum::full(steel));
/// let blade = scene.add(blade.straight([0.0; 2], [1.0, 0.0], 16).density(7800.0))?;
/// scene.pin(blade.start())?;
/// scene.fix(blade.start(), NodalVector::Slope(1), [true; 2])?;
/// let system = scene.assemble()?;
/// let spinning = system.spinning([0.0, 0.0, 100.0])?;
/// let mut state = system.rest();
/// Statics::default().solve(&spinning, &mut state)?;
/// let stretch = system.displacement(&state, blade.end())?[0];
/// assert!((stretch / (7800.0 * 100.0_f64.powi(2) / (3.0 * 2.0e11)) - 1.0).abs() < 1e-3);
/// let frequencies = Modes::lowest(1).vibration(&spinning, &state, 1.0)?;
/// # assert!(frequencies[0].frequency() > 50.0);
/// # Ok::<(), ancf::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Spinning<'a, R: Real, const D: usize> {
    system: &'a System<R, D>,
    omega: [R; 3],
}

impl<R: Real, const D: usize> System<R, D> {
    /// The system seen from a frame that turns with `omega` (rad/s) about an axis through the
    /// origin; for statics and for [`Modes`](crate::solver::Modes). In the plane only the third
    /// component can act.
    ///
    /// # Errors
    /// When the system has no mass, a component is not finite, or a planar system is to turn out of
    /// its plane.
    pub fn spinning(&self, omega: [R; 3]) -> Result<Spinning<'_, R, D>> {
        for component in omega {
            finite("component of an angular velocity [rad/s]", component)?;
        }
        if !self.multipliers().is_empty() {
            return Err(Error::Unsupported {
                what: "nonlinear constraints in a rotating frame".into(),
                remedy: "use linear joints, or integrate the system itself with System::set_rigid_velocity",
            });
        }
        if !self.has_mass() {
            return Err(Error::Unsupported {
                what: "centrifugal forces without mass".into(),
                remedy: "give the beams a density with Beam::density",
            });
        }
        if D == 2 && !(omega[0].is_zero() && omega[1].is_zero()) {
            return Err(Error::Unsupported {
                what: "a planar system that turns out of its plane".into(),
                remedy: "give the third component only, or use a spatial scene",
            });
        }
        Ok(Spinning {
            system: self,
            omega,
        })
    }
}

impl<R: Real, const D: usize> Spinning<'_, R, D> {
    /// `omega x v`.
    fn turn(&self, v: &[R]) -> [R; D] {
        let v = std::array::from_fn(|c| if c < D { v[c] } else { R::zero() });
        let turned = cross(&self.omega, &v);
        std::array::from_fn(|c| turned[c])
    }
}

impl<R: Real, const D: usize> Structure<R> for Spinning<'_, R, D> {
    fn unknowns(&self) -> &Unknowns<R> {
        self.system.unknowns()
    }

    fn symmetric(&self) -> bool {
        self.system.symmetric()
    }

    fn impose(&self, time: R, rate: Rate, x: &mut [R]) -> Result<()> {
        self.system.impose(time, rate, x)
    }

    fn measure(&self) -> &[R] {
        self.system.measure()
    }

    fn add_internal(&self, u: &[R], q: &mut [R]) {
        self.system.add_internal(u, q);
    }

    fn add_external(&self, time: R, factor: R, u: &[R], q: &mut [R]) -> Result<()> {
        self.system.add_external(time, factor, u, q)?;
        let reference = self.system.reference();
        self.system.each_mass(|i, j, m| {
            let at = j * D;
            let x: [R; D] = std::array::from_fn(|c| reference[at + c] + u[at + c]);
            let inward = self.turn(&self.turn(&x));
            for c in 0..D {
                q[i * D + c] -= factor * m * inward[c];
            }
        });
        Ok(())
    }

    fn add_permanent(&self, time: R, factor: R, u: &[R], q: &mut [R]) -> Result<()> {
        self.system.add_permanent(time, factor, u, q)
    }

    fn subtract_permanent_tangent(
        &self,
        time: R,
        factor: R,
        u: &[R],
        k: &mut Matrix<R>,
    ) -> Result<()> {
        self.system.subtract_permanent_tangent(time, factor, u, k)
    }

    fn has_applied(&self) -> bool {
        self.system.has_applied()
    }

    fn add_applied(&self, time: R, factor: R, u: &[R], q: &mut [R]) -> Result<()> {
        self.system.add_applied(time, factor, u, q)
    }

    fn add_tangent(&self, time: R, factor: R, u: &[R], k: &mut Matrix<R>) -> Result<()> {
        self.system.add_tangent(time, factor, u, k)?;
        let unit = |d: usize| std::array::from_fn(|c| if c == d { R::one() } else { R::zero() });
        let inward: [[R; D]; D] = std::array::from_fn(|d| {
            let axis: [R; D] = unit(d);
            self.turn(&self.turn(&axis))
        });
        let mut result = Ok(());
        self.system.each_mass(|i, j, m| {
            for (d, column) in inward.iter().enumerate() {
                for (c, inward) in column.iter().enumerate() {
                    if !inward.is_zero() && result.is_ok() {
                        result = k.add(i * D + c, j * D + d, factor * m * *inward);
                    }
                }
            }
        });
        result
    }

    fn name(&self, i: usize) -> String {
        self.system.name(i)
    }

    fn moves_rigidly(&self, u: &[R]) -> Option<bool> {
        Structure::moves_rigidly(self.system, u)
    }

    fn check(&self, u: &[R]) -> Result<()> {
        self.system.check(u)
    }

    fn has_mass(&self) -> bool {
        true
    }

    fn add_mass_times(&self, factor: R, a: &[R], out: &mut [R]) {
        self.system.add_mass_times(factor, a, out);
    }

    fn add_mass(&self, factor: R, k: &mut Matrix<R>) -> Result<()> {
        self.system.add_mass(factor, k)
    }

    fn has_gyroscopic(&self) -> bool {
        true
    }

    fn add_gyroscopic(&self, v: &[R], out: &mut [R]) {
        let two = R::lit(2.0);
        self.system.each_mass(|i, j, m| {
            let turned = self.turn(&v[j * D..]);
            for c in 0..D {
                out[i * D + c] += two * m * turned[c];
            }
        });
    }
}
