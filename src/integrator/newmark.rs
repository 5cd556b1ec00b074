//! Newmark's method, the integrator of the paper, with the two local error estimators that its
//! adaptive step can be controlled by.

use super::Method;
use crate::error::{Error, Result};
use crate::scalar::Real;
use crate::solver::{Equations, Newton, Solved, State, Structure, Workspace};

/// How the local error of a Newmark step is estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Estimator {
    /// Li, Zeng and Wiberg (1993), the paper's choice: the exact third-order terms for a jerk that
    /// varies linearly over this step and the last.
    #[default]
    LiZengWiberg,
    /// Zienkiewicz and Xie (1991): `(beta - 1/6) dt^2 (a_{n+1} - a_n)`.
    ZienkiewiczXie,
}

/// Newmark's family: `u_{n+1} = u + dt v + dt^2 ((1/2 - beta) a + beta a_{n+1})`,
/// `v_{n+1} = v + dt ((1 - gamma) a + gamma a_{n+1})`, equilibrium at the end of the step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Newmark {
    /// Weight of the new acceleration in the displacement.
    pub beta: f64,
    /// Weight of the new acceleration in the velocity.
    pub gamma: f64,
    /// Newton's method within a step.
    pub newton: Newton,
    /// Local error estimator of the adaptive step.
    pub estimator: Estimator,
}

impl Default for Newmark {
    fn default() -> Self {
        Self::trapezoidal()
    }
}

impl Newmark {
    /// Constant average acceleration, the trapezoidal rule: `beta = 1/4`, `gamma = 1/2`; second
    /// order, no numerical damping.
    pub fn trapezoidal() -> Self {
        Self {
            beta: 0.25,
            gamma: 0.5,
            newton: Newton::default(),
            estimator: Estimator::default(),
        }
    }

    /// The same method with other settings of Newton's method.
    pub fn with_newton(mut self, newton: Newton) -> Self {
        self.newton = newton;
        self
    }

    /// The same method with another error estimator.
    pub fn with_estimator(mut self, estimator: Estimator) -> Self {
        self.estimator = estimator;
        self
    }

    /// Allocates the method's workspace for a structure and makes the state's acceleration
    /// consistent with its displacement, velocity and time.
    pub(super) fn start<R: Real, S: Structure<R>>(
        &self,
        structure: &S,
        state: &mut State<R>,
    ) -> Result<NewmarkMethod<R>> {
        self.newton.check()?;
        for (what, value, least) in [
            ("Newmark's beta", self.beta, 0.0),
            ("Newmark's gamma", self.gamma, 0.5),
        ] {
            if !(value.is_finite() && value >= least && value <= 1.0 && value > 0.0) {
                return Err(Error::OutOfRange {
                    what,
                    value,
                    range: "(0, 1] for beta and [1/2, 1] for gamma",
                    remedy: "use Newmark::trapezoidal (1/4, 1/2), or gamma >= 1/2 with beta >= gamma / 2",
                });
            }
        }
        if !structure.has_mass() {
            return Err(Error::Unsupported {
                what: "dynamics of a structure without mass".into(),
                remedy: "give the beams a density with Beam::density, or solve statics",
            });
        }
        let n = structure.profile().size();
        state.check(n)?;
        let mut method = NewmarkMethod {
            settings: *self,
            workspace: Workspace::new(structure),
            base: vec![R::zero(); n],
            before: vec![R::zero(); n],
            step_before: None,
            step_of_factor: None,
        };
        method.workspace.accelerate(structure, state)?;
        Ok(method)
    }
}

/// Newmark's method at work on a structure.
#[derive(Debug)]
pub struct NewmarkMethod<R> {
    settings: Newmark,
    workspace: Workspace<R>,
    /// The displacement at which the new acceleration would vanish.
    base: Vec<R>,
    /// Acceleration one step earlier, and the length of that step.
    before: Vec<R>,
    step_before: Option<R>,
    step_of_factor: Option<R>,
}

impl<R: Real> Method<R> for NewmarkMethod<R> {
    fn advance<S: Structure<R>>(
        &mut self,
        structure: &S,
        now: &State<R>,
        next: &mut State<R>,
        step: R,
    ) -> Result<Solved> {
        let beta = R::lit(self.settings.beta);
        let gamma = R::lit(self.settings.gamma);
        let half = R::lit(0.5);
        let square = step * step;
        for i in 0..self.base.len() {
            let drift = now.displacement[i] + step * now.velocity[i];
            self.base[i] = drift + square * (half - beta) * now.acceleration[i];
            next.displacement[i] = drift + square * half * now.acceleration[i];
        }
        for &i in structure.fixed() {
            self.base[i] = now.displacement[i];
            next.displacement[i] = now.displacement[i];
        }
        // The mass term of a kept tangent belongs to one step size only.
        if self.step_of_factor != Some(step) {
            self.workspace.forget();
            self.step_of_factor = Some(step);
        }
        next.time = now.time + step;
        let rate = (beta * square).recip();
        let equations = Equations {
            time: next.time,
            factor: R::one(),
            inertia: Some((rate, &self.base)),
        };
        let solved = self.workspace.solve(
            structure,
            &self.settings.newton,
            &equations,
            &mut next.displacement,
        )?;
        for i in 0..self.base.len() {
            let a = rate * (next.displacement[i] - self.base[i]);
            let mean = (R::one() - gamma) * now.acceleration[i] + gamma * a;
            next.acceleration[i] = a;
            next.velocity[i] = now.velocity[i] + step * mean;
        }
        next.work = now.work + self.workspace.work(structure, now, next)?;
        Ok(solved)
    }

    fn error<S: Structure<R>>(&mut self, structure: &S, now: &State<R>, next: &State<R>) -> R {
        let beta = R::lit(self.settings.beta);
        let step = next.time - now.time;
        let (mut error, mut size) = (R::zero(), R::zero());
        let measure = structure.measure();
        let cube = step * step * step / R::lit(24.0);
        let weight = |factor: f64| R::lit(12.0) * beta - R::lit(factor);
        for i in 0..measure.len() {
            let jerk = (next.acceleration[i] - now.acceleration[i]) / step;
            let (first, last) = match (self.settings.estimator, self.step_before) {
                (Estimator::LiZengWiberg, Some(step_before)) => {
                    let jerk_before = (now.acceleration[i] - self.before[i]) / step_before;
                    let change = (jerk - jerk_before) * step / (step + step_before);
                    (jerk - change, jerk + change)
                }
                // A constant jerk turns the first formula into the second.
                _ => (jerk, jerk),
            };
            let local = cube * (weight(3.0) * first + weight(1.0) * last) / measure[i];
            error += local * local;
            let moved = next.displacement[i] / measure[i];
            size += moved * moved;
        }
        if error.is_zero() {
            return error;
        }
        // A structure that has hardly moved is measured against a thousandth of its size.
        let least = R::lit(1e-6) * R::lit(measure.len() as f64);
        (error / size.larger(least)).sqrt()
    }

    fn error_order(&self) -> u32 {
        3
    }

    fn accept(&mut self, now: &State<R>, next: &State<R>) {
        self.before.copy_from_slice(&now.acceleration);
        self.step_before = Some(next.time - now.time);
    }
}
