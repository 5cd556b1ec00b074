//! The explicit central difference method. No equations are solved but those of the constant mass,
//! from which the supports are taken out before it is factorised: solving with all of it and
//! holding the supports afterwards would leave an error that no time step removes. Its steps are
//! bounded by the highest frequency, which is found by iteration and renewed as the motion goes on.

use super::{Method, Scheme, mean_squares, prepare};
use crate::error::{Error, Result, positive};
use crate::scalar::Real;
use crate::solver::{
    Factor, Matrix, Rate, Sample, Solved, State, Structure, Tape, Workspace, add_projection, norm,
};

/// The central difference method in its velocity form (Verlet), with the consistent mass: second
/// order, symplectic, keeps momenta, stable for steps below `2 / omega` with `omega` the highest
/// frequency. A step beyond is refused; [`Stepping::Stable`](super::Stepping::Stable) chooses
/// those below. Nonlinear constraints are held by RATTLE (Andersen 1983) in position and velocity,
/// which keeps all of this.
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
/// let mut run = Integration::start(&system, system.rest(), &CentralDifference::default())?;
/// run.until(0.1, Stepping::Stable(0.9), |_| {})?;
/// assert!(system.energies(run.state())?.balance().abs() < 1e-3);
/// # Ok::<(), ancf::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CentralDifference {
    /// Steps after which the highest frequency is found anew.
    pub renewal: usize,
}

impl Default for CentralDifference {
    fn default() -> Self {
        Self { renewal: 100 }
    }
}

impl<R: Real> Scheme<R> for CentralDifference {
    type Method = CentralDifferenceMethod<R>;

    fn start<S: Structure<R>>(
        &self,
        structure: &S,
        state: &mut State<R>,
    ) -> Result<CentralDifferenceMethod<R>> {
        if self.renewal == 0 {
            return Err(Error::TooFew {
                what: "number of steps after which the highest frequency is found anew",
                value: 0,
                least: 1,
                remedy: "find it every step (1) or every 100 steps",
            });
        }
        let workspace = prepare(structure, state)?;
        let unknowns = structure.unknowns();
        let mut mass = Matrix::zero(unknowns, true);
        add_projection(structure, state.time, &state.displacement, &mut mass)?;
        let mut factor = Factor::new(unknowns.profile(), true);
        factor.factor(mass.stored())?;
        let n = unknowns.count();
        // Any direction that is not without a share of the fastest motion.
        let mode = (0..n).map(|i| R::lit((i as f64 + 1.0).sin())).collect();
        let multipliers = structure.multipliers();
        let held = unknowns.free().iter().enumerate();
        let held = held.filter(|(_, i)| multipliers.contains(i));
        Ok(CentralDifferenceMethod {
            renewal: self.renewal,
            workspace,
            stiffness: Matrix::zero(unknowns, structure.symmetric()),
            mass,
            factor,
            mode,
            force: vec![R::zero(); n],
            held: held.map(|(q, _)| q).collect(),
            limit: None,
            age: 0,
            step: R::zero(),
        })
    }
}

/// The central difference method at work on a structure.
#[derive(Debug)]
pub struct CentralDifferenceMethod<R> {
    renewal: usize,
    workspace: Workspace<R>,
    /// The mass, and beside it the derivatives of the constraints.
    mass: Matrix<R>,
    factor: Factor<R>,
    stiffness: Matrix<R>,
    /// The fastest motion, by unknowns.
    mode: Vec<R>,
    force: Vec<R>,
    /// The unknowns that are multipliers.
    held: Vec<usize>,
    /// Longest stable step, once known, and the steps taken since.
    limit: Option<R>,
    age: usize,
    step: R,
}

/// Relative change of the squared frequency at which its iteration stops, and how many it takes.
const SETTLED: f64 = 1e-4;
const ITERATIONS: usize = 200;

impl<R: Real> CentralDifferenceMethod<R> {
    /// The square of the highest frequency by power iteration on `M^-1 K`, within what the
    /// constraints allow.
    fn highest<S: Structure<R>>(&mut self, structure: &S, now: &State<R>) -> Result<R> {
        let (k, u) = (&mut self.stiffness, &now.displacement);
        k.clear();
        structure.add_tangent(now.time, R::one(), u, k)?;
        structure.add_curvature(now.time, R::one(), u, k)?;
        if !self.held.is_empty() {
            self.mass.clear();
            add_projection(structure, now.time, u, &mut self.mass)?;
            self.factor.factor(self.mass.stored())?;
        }
        let mut square = R::zero();
        for _ in 0..ITERATIONS {
            for q in &self.held {
                self.mode[*q] = R::zero();
            }
            let dot = |a: &[R], b: &[R]| a.iter().zip(b).map(|(a, b)| *a * *b).sum::<R>();
            self.mass.stored().mul_vec(&self.mode, &mut self.force)?;
            let kinetic = dot(&self.mode, &self.force);
            k.stored().mul_vec(&self.mode, &mut self.force)?;
            let last = square;
            square = dot(&self.mode, &self.force) / kinetic;
            if (square - last).abs() <= square.abs() * R::lit(SETTLED) {
                break;
            }
            for q in &self.held {
                self.force[*q] = R::zero();
            }
            self.factor.solve(&mut self.force)?;
            let size = norm(dot(&self.force, &self.force));
            if size.is_zero() {
                // Nothing but what the constraints hold.
                break;
            }
            for (mode, force) in self.mode.iter_mut().zip(&self.force) {
                *mode = *force / size;
            }
        }
        Ok(square * structure.mass_factor())
    }
}

impl<R: Real> Method<R> for CentralDifferenceMethod<R> {
    fn stable_step<S: Structure<R>>(&mut self, structure: &S, now: &State<R>) -> Result<Option<R>> {
        if self.limit.is_none() || self.age >= self.renewal {
            let square = self.highest(structure, now)?;
            self.limit = Some(match square <= R::zero() && !self.held.is_empty() {
                // Rigid bodies have nothing that vibrates.
                true => R::lit(f64::INFINITY),
                false => {
                    let what = "square of the highest frequency [1/s^2]";
                    R::lit(2.0) / positive(what, square)?.sqrt()
                }
            });
            self.age = 0;
        }
        Ok(self.limit)
    }

    fn advance<S: Structure<R>>(
        &mut self,
        structure: &S,
        now: &State<R>,
        next: &mut State<R>,
        step: R,
    ) -> Result<Solved> {
        if let Some(limit) = self.stable_step(structure, now)?
            && step > limit
        {
            return Err(Error::Unstable {
                step: step.value(),
                limit: limit.value(),
            });
        }
        self.step = step;
        let half = step * R::lit(0.5);
        next.time = now.time + step;
        for i in 0..next.velocity.len() {
            next.velocity[i] = now.velocity[i] + half * now.acceleration[i];
            next.displacement[i] = now.displacement[i] + step * next.velocity[i];
        }
        structure.impose(next.time, Rate::Displacement, &mut next.displacement)?;
        self.workspace.restore(structure, Some(now), next)?;
        if !self.held.is_empty() {
            for (v, moved) in next.velocity.iter_mut().zip(self.workspace.moved()) {
                *v += *moved / step;
            }
        }
        self.workspace.accelerate(structure, next)?;
        for (v, a) in next.velocity.iter_mut().zip(&next.acceleration) {
            crate::error::finite("acceleration [1/s^2]", *a)?;
            *v += half * *a;
        }
        structure.impose(next.time, Rate::Velocity, &mut next.velocity)?;
        self.workspace.settle(structure, next)?;
        structure.check(&next.displacement)?;
        let ends = Sample::ends(now, next);
        next.work = now.work + self.workspace.work(structure, &ends, now, next)?;
        Ok(Solved::default())
    }

    fn error<S: Structure<R>>(&mut self, structure: &S, now: &State<R>, next: &State<R>) -> (R, R) {
        let share = self.step * self.step / R::lit(6.0);
        mean_squares(structure, &next.displacement, |i| {
            share * (next.acceleration[i] - now.acceleration[i])
        })
    }

    fn history(&mut self, tape: &mut Tape<R>) -> Result<()> {
        tape.option(&mut self.limit)?;
        tape.count(&mut self.age)?;
        tape.numbers(&mut self.mode)
    }

    fn accept(&mut self, _now: &State<R>, _next: &State<R>) {
        self.age += 1;
    }
}
