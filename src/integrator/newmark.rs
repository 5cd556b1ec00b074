//! Newmark's method, the integrator of the paper, with the two local error estimators that its
//! adaptive step can be controlled by.

use super::{Method, Scheme};
use crate::error::{Error, Result};
use crate::scalar::Real;
use crate::solver::{Equations, Newton, Rate, Solved, State, Structure, Workspace, norm};

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
}

impl<R: Real> Scheme<R> for Newmark {
    type Method = NewmarkMethod<R>;

    fn start<S: Structure<R>>(
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
        let n = structure.unknowns().coordinates();
        state.check(n)?;
        let time = state.time;
        structure.impose(time, Rate::Displacement, &mut state.displacement)?;
        structure.impose(time, Rate::Velocity, &mut state.velocity)?;
        let mut method = NewmarkMethod {
            settings: *self,
            workspace: Workspace::new(structure),
            before: vec![R::zero(); n],
            step_before: None,
            step: None,
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
    /// Acceleration one step earlier, and the length of that step.
    before: Vec<R>,
    step_before: Option<R>,
    /// Length of the last step tried, to which a kept tangent belongs.
    step: Option<R>,
}

impl<R: Real> Method<R> for NewmarkMethod<R> {
    const ERROR_ORDER: i32 = 3;

    fn advance<S: Structure<R>>(
        &mut self,
        structure: &S,
        now: &State<R>,
        next: &mut State<R>,
        step: R,
    ) -> Result<Solved> {
        let beta = R::lit(self.settings.beta);
        let gamma = R::lit(self.settings.gamma);
        let square = step * step;
        // The guess is the motion with constant acceleration; each metre of correction then
        // changes the acceleration by 1 / (beta dt^2).
        let half = square * R::lit(0.5);
        for i in 0..next.displacement.len() {
            let drift = step * now.velocity[i] + half * now.acceleration[i];
            next.displacement[i] = now.displacement[i] + drift;
        }
        // The mass term of a kept tangent belongs to one step size only.
        if self.step != Some(step) {
            self.workspace.forget();
            self.step = Some(step);
        }
        next.time = now.time + step;
        next.acceleration.copy_from_slice(&now.acceleration);
        structure.impose(next.time, Rate::Displacement, &mut next.displacement)?;
        structure.impose(next.time, Rate::Acceleration, &mut next.acceleration)?;
        let rate = R::one() / (beta * square);
        let equations = Equations {
            time: next.time,
            factor: R::one(),
            initial: None,
            inertia: Some((rate, &next.acceleration)),
        };
        let newton = &self.settings.newton;
        let u = &mut next.displacement;
        let solved = self.workspace.solve(structure, newton, &equations, u)?;
        for (i, moved) in self.workspace.moved().iter().enumerate() {
            next.acceleration[i] += rate * *moved;
            let mean = (R::one() - gamma) * now.acceleration[i] + gamma * next.acceleration[i];
            next.velocity[i] = now.velocity[i] + step * mean;
        }
        structure.impose(next.time, Rate::Velocity, &mut next.velocity)?;
        self.workspace.settle(structure, next)?;
        next.work = now.work + self.workspace.work(structure, now, next)?;
        Ok(solved)
    }

    fn error<S: Structure<R>>(&self, structure: &S, now: &State<R>, next: &State<R>) -> (R, R) {
        let Some(step) = self.step else {
            return (R::zero(), R::zero());
        };
        let beta = R::lit(self.settings.beta);
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
        let mean = |square: R| norm(square / R::lit(measure.len() as f64));
        (mean(error), mean(size))
    }

    fn accept(&mut self, now: &State<R>, _next: &State<R>) {
        self.before.copy_from_slice(&now.acceleration);
        self.step_before = self.step;
    }
}
