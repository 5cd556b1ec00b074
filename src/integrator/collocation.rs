//! Collocation at Gauss and at Radau IIA points: implicit Runge-Kutta methods of any number of
//! stages. The stages are the coordinates of a larger structure, numbered coordinate by coordinate,
//! so that it keeps a band and Newton's method sees nothing new.

mod stages;
mod tableau;

use std::cell::RefCell;

use super::{Method, Scheme, mean_squares, prepare};
use crate::error::{Error, Result};
use crate::scalar::Real;
use crate::solver::{
    Equations, Matrix, Newton, Rate, Rest, Solved, State, Structure, Tape, Workspace,
};
use stages::{Layout, Scratch, Stages};
use tableau::{Points, Tableau, weighted};

/// Collocation with `s` stages: the motion over a step is the polynomial that obeys the equations
/// of motion at `s` points (Hairer, Norsett and Wanner, *Solving ODEs I*, II.7 and *II*, IV.5). A
/// step costs what a structure of `s` times the coordinates costs. Nonlinear constraints hold in
/// their rates at these points, and in position, velocity and acceleration at the end of the step,
/// with no loss of order.
///
/// Error control holds the polynomial inside the step to the tolerance; with more than two stages
/// the end of the step is better than that.
///
/// ```
/// use ancf::prelude::*;
///
/// let rubber = SaintVenantKirchhoff::isotropic(2.0e7, 0.0)?;
/// let mut scene = Scene::<f64, 2>::new();
/// let beam = scene.add(
///     Beam::new(FullyParameterised, Disk::new(0.01)?, Continuum::full(rubber))
///         .straight([0.0, 0.0], [1.0, 0.0], 4)
///         .density(7200.0),
/// )?;
/// scene.pin(beam.start())?;
/// scene.gravity([0.0, -9.81])?;
/// let system = scene.assemble()?;
/// let mut run = Integration::start(&system, system.rest(), &Collocation::radau(3))?;
/// run.until(0.1, Stepping::Fixed(5e-3), |_| {})?;
/// assert!(system.energies(run.state())?.balance().abs() < 1e-5);
/// # Ok::<(), ancf::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Collocation {
    points: Points,
    stages: usize,
    newton: Newton,
}

impl Collocation {
    /// Gauss points: order `2 s`, symmetric and symplectic, no dissipation. Keeps momenta.
    pub fn gauss(stages: usize) -> Self {
        Self {
            points: Points::Gauss,
            stages,
            newton: Newton::default(),
        }
    }

    /// Radau points, the last of them at the end of the step: order `2 s - 1`; motion that the
    /// step does not resolve is gone after it.
    pub fn radau(stages: usize) -> Self {
        Self {
            points: Points::Radau,
            ..Self::gauss(stages)
        }
    }

    /// The same method with other settings of Newton's method.
    pub fn with_newton(mut self, newton: Newton) -> Self {
        self.newton = newton;
        self
    }
}

impl<R: Real> Scheme<R> for Collocation {
    type Method = CollocationMethod<R>;

    fn start<S: Structure<R>>(
        &self,
        structure: &S,
        state: &mut State<R>,
    ) -> Result<CollocationMethod<R>> {
        self.newton.check()?;
        if !(1..=8).contains(&self.stages) {
            return Err(Error::OutOfRange {
                what: "number of stages of a collocation method",
                value: self.stages as f64,
                range: "1 to 8",
                remedy: "use 2 or 3",
            });
        }
        let (tableau, layout) = (
            Tableau::new(self.points, self.stages)?,
            Layout::new(structure, self.stages)?,
        );
        let outer = prepare(structure, state)?;
        let n = state.displacement.len();
        let mut scratch = Scratch {
            u: vec![R::zero(); n],
            q: vec![R::zero(); n],
            v: vec![R::zero(); n],
            matrix: Matrix::zero(structure.unknowns(), structure.symmetric()),
        };
        let workspace = Workspace::new(&Stages {
            structure,
            tableau: &tableau,
            layout: &layout,
            step: R::one(),
            from: &state.displacement,
            scratch: RefCell::new(&mut scratch),
        });
        Ok(CollocationMethod {
            settings: *self,
            workspace,
            outer,
            scratch,
            predicted: vec![R::zero(); n * self.stages],
            stages: vec![R::zero(); n * self.stages],
            tableau,
            layout,
            step: None,
        })
    }
}

/// A collocation method at work on a structure.
#[derive(Debug)]
pub struct CollocationMethod<R> {
    settings: Collocation,
    tableau: Tableau<R>,
    layout: Layout<R>,
    workspace: Workspace<R>,
    /// Workspace of the structure itself.
    outer: Workspace<R>,
    scratch: Scratch<R>,
    /// Displacements of the stages beyond uniform motion, per square of the step, as guessed.
    predicted: Vec<R>,
    /// Displacements of the stages; after the step their accelerations.
    stages: Vec<R>,
    /// Length of the last step tried, to which a kept tangent belongs.
    step: Option<R>,
}

impl<R: Real> CollocationMethod<R> {
    /// Work of the applied forces, by the rule of the method. The stages still hold displacements.
    fn work<S: Structure<R>>(&mut self, structure: &S, now: &State<R>, step: R) -> Result<R> {
        let mut work = R::zero();
        if !structure.has_applied() {
            return Ok(work);
        }
        let count = self.tableau.at.len();
        let rate = R::one() / (step * step);
        for (i, at) in self.tableau.at.iter().enumerate() {
            self.scratch.stage(&self.stages, i, count);
            let Scratch { u, q, .. } = &mut self.scratch;
            structure.add_applied(now.time + step * *at, R::one(), u, q)?;
            // Velocities of the stage: A a = A (A^2)^-1 x.
            for (k, q) in q.iter().enumerate() {
                let own = k * count..(k + 1) * count;
                let (x, moved) = (&self.predicted[own.clone()], &self.workspace.moved()[own]);
                let mut v = now.velocity[k];
                for (once, row) in self.tableau.once[i].iter().zip(&self.tableau.inverse) {
                    let a = weighted(row, x) + rate * weighted(row, moved);
                    v += step * *once * a;
                }
                work += step * self.tableau.weight[i] * *q * v;
            }
        }
        Ok(work)
    }
}

impl<R: Real> Method<R> for CollocationMethod<R> {
    fn order(&self) -> i32 {
        let twice = 2 * self.settings.stages as i32;
        match self.settings.points {
            Points::Gauss => twice,
            Points::Radau => twice - 1,
        }
    }

    fn error_order(&self) -> i32 {
        (self.order() + 1).min(self.settings.stages as i32 + 2)
    }

    fn advance<S: Structure<R>>(
        &mut self,
        structure: &S,
        now: &State<R>,
        next: &mut State<R>,
        step: R,
    ) -> Result<Solved> {
        let count = self.tableau.at.len();
        let square = step * step;
        // Accelerations of the guess: that of the start, or as given in time.
        for (i, at) in self.tableau.at.iter().enumerate() {
            let Scratch { u, .. } = &mut self.scratch;
            u.copy_from_slice(&now.acceleration);
            structure.impose(now.time + step * *at, Rate::Acceleration, u)?;
            self.scratch.put(&mut self.stages, i, count);
        }
        for k in 0..now.displacement.len() {
            let own = k * count..(k + 1) * count;
            let (a, x) = (&mut self.stages[own.clone()], &mut self.predicted[own]);
            for (x, twice) in x.iter_mut().zip(&self.tableau.twice) {
                *x = weighted(twice, a);
            }
            for ((u, x), at) in a.iter_mut().zip(x).zip(&self.tableau.at) {
                let drift = step * *at * now.velocity[k] + square * *x;
                *u = now.displacement[k] + drift;
            }
        }
        for (i, at) in self.tableau.at.iter().enumerate() {
            self.scratch.stage(&self.stages, i, count);
            let time = now.time + step * *at;
            structure.impose(time, Rate::Displacement, &mut self.scratch.u)?;
            self.scratch.put(&mut self.stages, i, count);
        }
        // The mass term of a kept tangent belongs to one step size only.
        if self.step != Some(step) {
            self.workspace.forget();
            self.step = Some(step);
        }
        let rate = R::one() / square;
        let equations = Equations {
            time: now.time,
            factor: R::one(),
            rest: Rest::Nothing,
            inertia: Some((rate, &self.predicted)),
        };
        let stages = Stages {
            structure,
            tableau: &self.tableau,
            layout: &self.layout,
            step,
            from: &now.displacement,
            scratch: RefCell::new(&mut self.scratch),
        };
        let newton = &self.settings.newton;
        let solved = self
            .workspace
            .solve(&stages, newton, &equations, &mut self.stages)?;
        next.work = now.work + self.work(structure, now, step)?;
        next.time = now.time + step;
        let moved = self.workspace.moved();
        let multipliers = structure.multipliers();
        for k in 0..now.displacement.len() {
            let own = k * count..(k + 1) * count;
            if multipliers.contains(&k) {
                // Those of the last stage, whose acceleration is left, too.
                next.displacement[k] = self.stages[own.end - 1];
                (next.velocity[k], next.acceleration[k]) = (R::zero(), R::zero());
                continue;
            }
            let (x, moved) = (&self.predicted[own.clone()], &moved[own.clone()]);
            let a = &mut self.stages[own];
            for (a, row) in a.iter_mut().zip(&self.tableau.inverse) {
                *a = weighted(row, x) + rate * weighted(row, moved);
            }
            let drift = step * (now.velocity[k] + step * weighted(&self.tableau.end, a));
            next.displacement[k] = now.displacement[k] + drift;
            next.velocity[k] = now.velocity[k] + step * weighted(&self.tableau.weight, a);
            next.acceleration[k] = a[count - 1];
        }
        for (rate, x) in [
            (Rate::Displacement, &mut next.displacement),
            (Rate::Velocity, &mut next.velocity),
            (Rate::Acceleration, &mut next.acceleration),
        ] {
            structure.impose(next.time, rate, x)?;
        }
        self.outer.restore(structure, None, next)?;
        // Radau's last stage is the end.
        match self.settings.points {
            Points::Gauss => self.outer.accelerate(structure, next)?,
            Points::Radau => self.outer.settle(structure, next)?,
        }
        next.work += self.outer.driven_work(structure, now, next)?;
        Ok(solved)
    }

    fn error<S: Structure<R>>(&mut self, structure: &S, now: &State<R>, next: &State<R>) -> (R, R) {
        let step = self.step.unwrap_or(R::zero());
        let count = self.tableau.at.len();
        let [start, stages] = [&self.tableau.estimate[..1], &self.tableau.estimate[1..]];
        mean_squares(structure, &next.displacement, |k| {
            let own = &self.stages[k * count..(k + 1) * count];
            step * step * (start[0] * now.acceleration[k] + weighted(stages, own))
        })
    }

    fn history(&mut self, tape: &mut Tape<R>) -> Result<()> {
        tape.option(&mut self.step)?;
        self.workspace.history(self.settings.newton.refresh, tape)
    }

    fn accept(&mut self, _now: &State<R>, _next: &State<R>) {}
}
