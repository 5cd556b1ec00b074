//! The energy-momentum method: over each step acts the secant force, whose work is the change of
//! strain energy to the last digit, made of the mean stress on the gradient half way, which exerts
//! no torque (Simo and Tarnow 1992). Energy and both momenta are then kept at any step, and no
//! growth of a fast mode can fake energy, which is how the trapezoidal rule loses long runs. (The
//! mean of the *forces* along the way, the average vector field, keeps energy and linear momentum
//! but turns the structure: it is what structures without strain get.)
//!
//! Rounding is all that is left. Newton's method goes to the residual that it leaves, because any
//! residual does work in every step; positions and velocities are formed from one mean
//! acceleration. What is then left is the rounding of stored coordinates, a random walk: carrying the
//! digits cut off from step to step did not change it. It grows with the distance from the
//! reference state, so let what flies far start near the middle of its path.

use std::cell::RefCell;
use std::ops::Range;

use super::held::Held;
use super::midpoint::Clock;
use super::{Method, Scheme, end_by_mean, impose_mean, prepare};
use crate::error::{Error, Result};
use crate::scalar::Real;
use crate::solver::{
    Equations, Matrix, Newton, Rate, Refresh, Rest, Sample, Secant, Solved, State, Structure, Tape,
    Unknowns, Workspace,
};

/// The energy-momentum method with optional dissipation that keeps the momenta: the stress
/// `C (E_{n+1} - E_n) (viscosity + retardation / dt)` acts beside the mean stress and takes
/// the energy `dE : C : dE` times that factor in every step. Second order without `viscosity`, of first
/// order with it. Loads act as they are half way. The [`acceleration`](State::acceleration) it
/// leaves is the mean over the step.
///
/// Nonlinear constraints hold at the end of every step to rounding; their multipliers, means over
/// the step, do no work where the conditions are quadratic, or functions of quadratic ones, as
/// rigidity and distances are, and take or give energy of the second order of the step elsewhere.
/// Velocities obey the constraints in the mean over a step.
///
/// Needs [`Structure::add_secant`]. Energy is exact for strain energies up to the fourth degree
/// in strain; angular momentum for formulations made of strain, as continua are
/// ([`Secant::Strain`]).
///
/// ```
/// use ancf::prelude::*;
///
/// let rubber = SaintVenantKirchhoff::isotropic(2.0e7, 0.0)?;
/// let mut scene = Scene::<f64, 2>::new();
/// let beam = scene.add(
///     Beam::new(FullyParameterised, Disk::new(0.01)?, Continuum::full(rubber))
///         .straight([0.0, 0.0], [1.0, 0.0], 6)
///         .density(7200.0),
/// )?;
/// scene.pin(beam.start())?;
/// scene.gravity([0.0, -9.81])?;
/// let system = scene.assemble()?;
/// let mut run = Integration::start(&system, system.rest(), &EnergyMomentum::conserving())?;
/// run.until(0.2, Stepping::Fixed(5e-3), |_| {})?;
/// assert!(system.energies(run.state())?.balance().abs() < 1e-11);
/// # Ok::<(), ancf::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnergyMomentum {
    /// Viscous stress per elastic stress that the step adds: dissipation of what the step does not
    /// resolve, zero for none.
    pub viscosity: f64,
    /// Retardation time of a Kelvin-Voigt material (s), zero for none.
    pub retardation: f64,
    /// Newton's method within a step.
    pub newton: Newton,
}

impl Default for EnergyMomentum {
    fn default() -> Self {
        Self::conserving()
    }
}

impl EnergyMomentum {
    /// Energy and momenta kept to rounding, Newton's method run to it. Its tangent, not symmetric
    /// and so dearer than others, is renewed when it is slow, which bears any step. Renewed in every
    /// solve ([`Refresh::EverySolve`]) it takes a tenth less time where steps resolve the motion, and
    /// runs in the lanes of a [`Sweep`](crate::sweep::Sweep); renewed in every iteration
    /// ([`Refresh::EveryIteration`]) it halves the iterations where they do not.
    pub fn conserving() -> Self {
        Self {
            viscosity: 0.0,
            retardation: 0.0,
            newton: Newton {
                residual: f64::MIN_POSITIVE,
                refresh: Refresh::WhenSlow,
                ..Newton::default()
            },
        }
    }

    /// Momenta kept, energy let down by this [`viscosity`](Self::viscosity) (0.5 damps unresolved
    /// motion most). Motion that steps do not resolve loses a few times this share of its energy in
    /// each of them, resolved motion less by the square of the step over its period: 1e-8 is small
    /// enough for a minute of a whipping pendulum at 1 ms to lose less than 0.1 % (example `long_run`).
    pub fn dissipating(viscosity: f64) -> Self {
        let mut method = Self::conserving();
        method.viscosity = viscosity;
        method.newton.residual = Newton::default().residual;
        method
    }

    /// A Kelvin-Voigt material: this retardation time (s), in which a strain whose stress is taken
    /// away falls to `1/e`.
    pub fn kelvin_voigt(retardation: f64) -> Self {
        let mut method = Self::dissipating(0.0);
        method.retardation = retardation;
        method
    }

    /// The same method with other settings of Newton's method.
    pub fn with_newton(mut self, newton: Newton) -> Self {
        self.newton = newton;
        self
    }
}

/// A structure over a step from a given state: its unknowns are those at the end of the step, its
/// forces those of the whole step.
struct Way<'a, R, S> {
    structure: &'a S,
    from: &'a [R],
    viscosity: R,
    held: Held<R>,
    /// Displacements half way.
    middle: RefCell<&'a mut [R]>,
}

impl<R: Real, S: Structure<R>> Way<'_, R, S> {
    /// Displacements half way to `to`, with the multipliers at the end.
    fn meet(&self, to: &[R]) {
        let mut middle = self.middle.borrow_mut();
        for (i, middle) in middle.iter_mut().enumerate() {
            *middle = R::lit(0.5) * (self.from[i] + to[i]);
        }
        for i in self.structure.multipliers() {
            middle[i] = to[i];
        }
    }
}

impl<R: Real, S: Structure<R>> Structure<R> for Way<'_, R, S> {
    fn unknowns(&self) -> &Unknowns<R> {
        self.structure.unknowns()
    }
    fn symmetric(&self) -> bool {
        false
    }
    fn measure(&self) -> &[R] {
        self.structure.measure()
    }
    fn add_internal(&self, u: &[R], q: &mut [R]) {
        self.structure.add_secant(self.viscosity, self.from, u, q);
    }
    fn has_following(&self) -> bool {
        self.structure.has_following()
    }
    fn is_steady(&self) -> bool {
        self.structure.is_steady()
    }
    fn add_external(&self, time: R, factor: R, u: &[R], q: &mut [R]) -> Result<()> {
        self.meet(u);
        self.structure
            .add_external(time, factor, &self.middle.borrow(), q)
    }
    fn multipliers(&self) -> Range<usize> {
        self.structure.multipliers()
    }
    fn add_holding(&self, _time: R, u: &[R], q: &mut [R]) {
        if !self.multipliers().is_empty() {
            self.meet(u);
            self.held.add(self.structure, &self.middle.borrow(), u, q);
        }
    }
    fn add_holding_tangent(&self, _time: R, u: &[R], k: &mut Matrix<R>) -> Result<()> {
        if self.multipliers().is_empty() {
            return Ok(());
        }
        self.meet(u);
        let moves = [R::lit(0.5), R::one()];
        self.held
            .add_tangent(self.structure, &self.middle.borrow(), u, moves, k)
    }
    fn add_tangent(&self, time: R, factor: R, u: &[R], k: &mut Matrix<R>) -> Result<()> {
        let (at, viscosity) = ((time, factor), self.viscosity);
        self.structure
            .add_secant_tangent(at, viscosity, self.from, u, k)
    }
    fn name(&self, i: usize) -> String {
        self.structure.name(i)
    }
    fn check(&self, u: &[R]) -> Result<()> {
        self.structure.check(u)
    }
    fn has_mass(&self) -> bool {
        self.structure.has_mass()
    }
    fn add_mass_times(&self, factor: R, a: &[R], out: &mut [R]) {
        self.structure.add_mass_times(factor, a, out);
    }
    fn add_mass(&self, factor: R, k: &mut Matrix<R>) -> Result<()> {
        self.structure.add_mass(factor, k)
    }
}

impl<R: Real> Scheme<R> for EnergyMomentum {
    type Method = EnergyMomentumMethod<R>;

    fn start<S: Structure<R>>(
        &self,
        structure: &S,
        state: &mut State<R>,
    ) -> Result<EnergyMomentumMethod<R>> {
        self.newton.check()?;
        for (what, value) in [
            ("viscosity of the energy-momentum method", self.viscosity),
            ("retardation time [s]", self.retardation),
        ] {
            if !(0.0..f64::INFINITY).contains(&value) {
                return Err(Error::OutOfRange {
                    what,
                    value,
                    range: "the finite numbers from zero on",
                    remedy: "use EnergyMomentum::conserving, or a viscosity of 0.01 to 0.5",
                });
            }
        }
        let viscous = self.viscosity > 0.0 || self.retardation > 0.0;
        let unsupported = |what: &str, remedy| {
            Err(Error::Unsupported {
                what: what.into(),
                remedy,
            })
        };
        match structure.secant() {
            Secant::Absent => unsupported(
                "the energy-momentum method on a structure without a secant force",
                "implement secant, add_secant and add_secant_tangent of Structure, or use another method",
            )?,
            Secant::Path if viscous => unsupported(
                "viscosity of a formulation that is given by its energy and has no strain",
                "use EnergyMomentum::conserving, Newmark::generalised_alpha, or a continuum formulation",
            )?,
            _ => {}
        }
        prepare(structure, state)?;
        let zeros = || vec![R::zero(); state.displacement.len()];
        let mut middle = zeros();
        let way = Way {
            structure,
            from: &state.displacement,
            viscosity: R::zero(),
            held: Held {
                at: state.time,
                end: state.time,
            },
            middle: RefCell::new(&mut middle),
        };
        Ok(EnergyMomentumMethod {
            settings: *self,
            workspace: Workspace::new(&way),
            guess: zeros(),
            middle,
            clock: Clock::default(),
        })
    }
}

/// The energy-momentum method at work on a structure.
#[derive(Debug)]
pub struct EnergyMomentumMethod<R> {
    settings: EnergyMomentum,
    workspace: Workspace<R>,
    /// Mean acceleration guessed.
    guess: Vec<R>,
    middle: Vec<R>,
    clock: Clock<R>,
}

impl<R: Real> EnergyMomentumMethod<R> {
    /// One attempt to solve the step from a guess of the mean acceleration.
    fn attempt<S: Structure<R>>(
        &mut self,
        structure: &S,
        now: &State<R>,
        next: &mut State<R>,
        step: R,
        guess: impl Fn(usize) -> R,
    ) -> Result<Solved> {
        let half = step * R::lit(0.5);
        for i in 0..self.guess.len() {
            self.guess[i] = guess(i);
        }
        let end = now.time + step;
        impose_mean(structure, (now, end), &mut self.guess, &mut next.velocity)?;
        for i in 0..self.guess.len() {
            let drift = step * (now.velocity[i] + half * self.guess[i]);
            next.displacement[i] = now.displacement[i] + drift;
        }
        structure.impose(end, Rate::Displacement, &mut next.displacement)?;
        let way = Way {
            structure,
            from: &now.displacement,
            viscosity: R::lit(self.settings.viscosity) + R::lit(self.settings.retardation) / step,
            held: Held {
                at: now.time + half,
                end,
            },
            middle: RefCell::new(&mut self.middle),
        };
        let equations = Equations {
            time: now.time + half,
            factor: R::one(),
            rest: Rest::Nothing,
            inertia: Some((R::one() / (half * step), &self.guess)),
        };
        let u = &mut next.displacement;
        self.workspace
            .solve(&way, &self.settings.newton, &equations, u)
    }
}

impl<R: Real> Method<R> for EnergyMomentumMethod<R> {
    fn advance<S: Structure<R>>(
        &mut self,
        structure: &S,
        now: &State<R>,
        next: &mut State<R>,
        step: R,
    ) -> Result<Solved> {
        // The mass term of a kept tangent belongs to one step size only.
        if self.clock.changes_to(step) {
            self.workspace.forget();
        }
        let half = step * R::lit(0.5);
        // A guess that misleads is replaced by a calmer one: no acceleration, then no motion.
        let mut solved = self.attempt(structure, now, next, step, |i| now.acceleration[i]);
        if let Err(Error::Unconverged { .. }) = solved {
            solved = self.attempt(structure, now, next, step, |_| R::zero());
        }
        if let Err(Error::Unconverged { .. }) = solved {
            solved = self.attempt(structure, now, next, step, |i| -now.velocity[i] / half);
        }
        let solved = solved?;
        next.time = now.time + step;
        let rate = R::one() / (half * step);
        let corrected = (&self.guess[..], rate, self.workspace.moved());
        end_by_mean(structure, corrected, now, next, step)?;
        for (i, middle) in self.middle.iter_mut().enumerate() {
            *middle = R::lit(0.5) * (now.displacement[i] + next.displacement[i]);
        }
        let middle = [Sample {
            weight: R::one(),
            time: now.time + half,
            displacement: &self.middle,
            acceleration: &next.acceleration,
        }];
        next.work = now.work + self.workspace.work(structure, &middle, now, next)?;
        Ok(solved)
    }

    fn error<S: Structure<R>>(&mut self, structure: &S, now: &State<R>, next: &State<R>) -> (R, R) {
        self.clock.error(structure, now, next)
    }

    fn history(&mut self, tape: &mut Tape<R>) -> Result<()> {
        self.clock.history(tape)?;
        self.workspace.history(self.settings.newton.refresh, tape)
    }

    fn accept(&mut self, _now: &State<R>, _next: &State<R>) {
        self.clock.accept();
    }
}
