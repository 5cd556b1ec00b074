//! Newton's method for one equilibrium, static or within a time step. Residuals and corrections
//! are measured in the structure's natural sizes, so that scenes of a millimetre and of a
//! kilometre converge alike, and the residual that rounding leaves is estimated from the tangent,
//! so that no slender beam is asked for digits its number type does not have.

mod balance;
mod equations;
mod project;
mod search;
mod settings;
mod work;

use super::band::Factor;
use super::matrix::Matrix;
use super::structure::{add_growing, add_tangent_with, held};
use super::unknowns::Unknowns;
use super::{Structure, Tape};
use crate::error::{Error, Result};
use crate::scalar::{Mask, Real};
use balance::Balance;
pub(crate) use balance::norm;
pub(crate) use equations::{Changes, Choice, Equations, Rest};
pub use settings::{Newton, Refresh, Solved};
pub(crate) use work::Sample;

/// What is known of an equilibrium's stability.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Stability {
    /// Negative eigenvalues of the tangent, where it is symmetric.
    pub(crate) unstable: Option<usize>,
    /// Whether its negative eigenvalues are odd in number.
    pub(crate) odd: Option<bool>,
}

impl Stability {
    /// Whether two equilibria are known to differ in stability, and by which numbers: of negative
    /// eigenvalues, or 0 and 1 for an even and an odd number where no more is known.
    pub(crate) fn differs(self, other: Self) -> Option<[usize; 2]> {
        let parity = |s: Self| s.odd.map(usize::from);
        let numbers = match (self.unstable, other.unstable) {
            (Some(a), Some(b)) => [a, b],
            _ => [parity(self)?, parity(other)?],
        };
        (numbers[0] != numbers[1]).then_some(numbers)
    }
}

/// What is left, for use in this solve, in a matrix that tangents are added to. Symmetric ones leave
/// nothing: whether they are factorised in their own storage depends on whether they are definite, in
/// which lanes, and runs that were resumed, may differ from others.
#[derive(Debug, Clone, Copy)]
enum Assembled<R> {
    /// Nothing.
    Nothing,
    /// The last tangent.
    Tangent,
    /// The last tangent and this much of the mass.
    WithMass(R),
}

/// Vectors and matrices of Newton's method, allocated once.
#[derive(Debug)]
pub(crate) struct Workspace<R> {
    tangent: Matrix<R>,
    factor: Factor<R>,
    factored: bool,
    /// Whether tangents are taken for definite: as long as the last one was.
    definite: bool,
    /// What the matrix holds.
    assembled: Assembled<R>,
    /// Whether the factors are those of the mass alone.
    held_mass: bool,
    /// Whether the factors are those of the state that the next solve starts from.
    current: bool,
    /// Whether the external forces of this solve are known.
    loaded: bool,
    /// Whether they are those of every time step, too.
    lasting: bool,
    /// A force of about the size of the largest met first in this solve, and whether that has been
    /// looked at; zero as long as there was none.
    force: R,
    measured: bool,
    /// Natural sizes of the coordinates over the largest; zero for those that are no unknowns.
    weights: Vec<R>,
    /// Reciprocals of the natural sizes of all coordinates; zero for multipliers, which have none: the
    /// residual tells about them.
    per_size: Vec<R>,
    external: Vec<R>,
    /// Internal forces, inertia and accelerations of a part of the structure, at the front: long ones
    /// stay in the caches.
    internal: Vec<R>,
    inertia: Vec<R>,
    acceleration: Vec<R>,
    /// The residual, or the changes that it brings.
    scratch: Vec<R>,
    /// What projects rates onto the constraints; nothing without constraints.
    projection: Option<(Matrix<R>, Factor<R>)>,
    /// Sum of the corrections of the last solve, once there was one, and whether there was: before that it
    /// is taken for zero, whatever it holds.
    moved: Vec<R>,
    corrected: bool,
    /// Right-hand side and solution by unknowns.
    unknown: Vec<R>,
    /// Two more vectors by unknowns.
    rounded: Vec<R>,
    positions: Vec<R>,
    /// Change of coordinates at a fixed load factor, where that is an unknown; the correction made,
    /// where it may be shortened.
    fixed: Vec<R>,
}

/// Largest correction, in natural sizes, after which the rounding floor still holds.
const NEAR: f64 = 1e-2;
/// Correction, in natural sizes, that no structure makes unless it is a mechanism.
const RUNAWAY: f64 = 1e4;
/// Old tangents are kept while each iteration reduces the residual at least by this.
const SLOW: f64 = 0.1;
/// A residual that one iteration reduces by less has stopped falling.
const STALLED: f64 = 0.3;
/// Times a residual must have risen before it is taken for noise. One that falls slowly, by a
/// wrong tangent, does not rise; one that rounding makes does every other time.
const RISES: f64 = 3.0;

impl<R: Real> Workspace<R> {
    pub(crate) fn new<S: Structure<R> + ?Sized>(structure: &S) -> Self {
        let unknowns = structure.unknowns();
        let symmetric = structure.symmetric();
        let zeros = || vec![R::zero(); unknowns.coordinates()];
        let measure = structure.measure();
        let size = measure.iter().copied().fold(R::zero(), R::larger);
        let multipliers = structure.multipliers();
        let per_size = |(i, size): (usize, &R)| match multipliers.contains(&i) {
            true => R::zero(),
            false => R::one() / *size,
        };
        let mut weights = zeros();
        for &i in unknowns.free() {
            weights[i] = measure[i] / size;
        }
        Self {
            tangent: Matrix::zero(unknowns, symmetric),
            factor: Factor::new(unknowns.profile(), symmetric),
            factored: false,
            definite: true,
            assembled: Assembled::Nothing,
            held_mass: false,
            current: false,
            loaded: false,
            lasting: false,
            force: R::zero(),
            measured: false,
            weights,
            per_size: measure.iter().enumerate().map(per_size).collect(),
            external: zeros(),
            internal: zeros(),
            inertia: zeros(),
            acceleration: zeros(),
            scratch: zeros(),
            projection: (!structure.multipliers().is_empty()).then(|| {
                let matrix = Matrix::zero(unknowns, true);
                (matrix, Factor::new(unknowns.profile(), true))
            }),
            moved: zeros(),
            corrected: true,
            unknown: vec![R::zero(); unknowns.count()],
            rounded: vec![R::zero(); unknowns.count()],
            positions: vec![R::zero(); unknowns.count()],
            fixed: Vec::new(),
        }
    }

    /// Forgets the factorisation, so that the next solve makes a new one.
    pub(crate) fn forget(&mut self) {
        self.factored = false;
        self.held_mass = false;
        self.current = false;
    }

    /// Says that the next solve starts from the state of the last factorisation.
    pub(crate) fn stay(&mut self) {
        self.current = self.factored;
    }

    /// The unit of forces and the tangent that the next solve starts with, to a tape or from it, the
    /// latter where it is kept from solve to solve.
    pub(crate) fn history(&mut self, refresh: Refresh, tape: &mut Tape<R>) -> Result<()> {
        tape.number(&mut self.force)?;
        let kept = matches!(refresh, Refresh::WhenSlow | Refresh::Never);
        let mut factored = kept && self.factored;
        tape.flag(&mut factored)?;
        if factored {
            self.factor.history(tape)?;
            self.factored = true;
            self.held_mass = false;
        }
        Ok(())
    }

    /// Whether there are factors of a tangent.
    pub(crate) fn factored(&self) -> bool {
        self.factored
    }

    /// The factors of the last tangent.
    pub(crate) fn factor(&mut self) -> &mut Factor<R> {
        &mut self.factor
    }

    /// Factorises the tangent at `u`, and tells what the factors tell of its stability.
    pub(crate) fn stability<S: Structure<R> + ?Sized>(
        &mut self,
        structure: &S,
        equations: &Equations<'_, R>,
        u: &[R],
    ) -> Result<Stability> {
        match self.renew(structure, equations, u, false) {
            // Every multiplier brings an eigenvalue that says nothing of stability.
            Ok(()) => {
                let held = held(structure);
                Ok(Stability {
                    unstable: self.factor.inertia().and_then(|all| all.checked_sub(held)),
                    odd: self.factor.odd().map(|odd| odd != (held % 2 == 1)),
                })
            }
            Err(Error::Mechanism { .. } | Error::StiffnessLost { .. }) => Ok(Stability::default()),
            Err(error) => Err(error),
        }
    }

    /// Sum of the corrections of the last solve: `u` minus the guess, with all its digits.
    pub(crate) fn moved(&self) -> &[R] {
        &self.moved
    }

    /// Solves `M a(u) + Q_s(u) = factor Q_e(t, u) + (1 - factor) rest` from the guess in `u`,
    /// by at least one correction: a small residual alone may hide a light beam beside a heavy
    /// one, and derivatives that a dual number carries.
    pub(crate) fn solve<S: Structure<R> + ?Sized>(
        &mut self,
        structure: &S,
        settings: &Newton,
        equations: &Equations<'_, R>,
        u: &mut [R],
    ) -> Result<Solved> {
        let solved = self.solve_along(structure, settings, equations, None, u)?;
        Ok(solved.0)
    }

    /// As [`solve`](Self::solve), with the load factor an unknown that `choice` gives; returns it,
    /// too.
    pub(crate) fn solve_along<S: Structure<R> + ?Sized>(
        &mut self,
        structure: &S,
        settings: &Newton,
        equations: &Equations<'_, R>,
        mut choice: Option<&mut Choice<'_, R>>,
        u: &mut [R],
    ) -> Result<(Solved, R)> {
        let mut equations = *equations;
        let mut current = std::mem::take(&mut self.current);
        let mut solved = Solved::default();
        let mut correction: Option<R> = None;
        let mut correcting: Option<Mask> = None;
        let mut previous: Option<R> = None;
        let mut rises = R::zero();
        // Lanes that go on, and those that ended at the rounding floor. One that has converged is
        // corrected no more, so that its answer is that of its own run.
        let (mut open, mut floored) = (Mask::ALL, Mask::NONE);
        // Derivatives follow the value one correction behind, each order one more.
        let mut extra = R::ORDER;
        self.loaded = self.lasts(&equations);
        self.measured = false;
        self.assembled = Assembled::Nothing;
        self.corrected = false;
        if settings.refresh == Refresh::EverySolve {
            self.forget();
        }
        let searching =
            settings.line_search && choice.is_none() && structure.multipliers().is_empty();
        let mut work = R::zero();
        loop {
            let (mut balance, made) = self.balance(structure, &equations, correcting, u)?;
            correction = made.or(correction);
            if searching && let Some(made) = &mut correction {
                let share;
                (balance, share) =
                    self.search(structure, settings, &equations, (work, balance), u)?;
                *made *= share;
            }
            solved.residual = (balance.residual / balance.scale).largest();
            if !balance.residual.finite() {
                return Err(self.unconverged(solved, "the residual is not finite"));
            }
            let corrected_by =
                |least: f64| correction.map_or(Mask::NONE, |c| c.at_most(R::lit(least)));
            let fell_to = |share: f64| {
                previous.map_or(Mask::ALL, |p| balance.residual.at_most(p * R::lit(share)))
            };
            let small = balance
                .residual
                .at_most(balance.scale * R::lit(settings.residual));
            let solved_for = small & corrected_by(settings.correction);
            let stalled = open & !solved_for & corrected_by(NEAR) & !fell_to(STALLED);
            let mut at_floor = Mask::NONE;
            if stalled.any() {
                let floor = self.leftover(structure, &equations, &balance, u)?;
                at_floor = stalled & balance.residual.at_most(floor);
            }
            rises += R::zero().where_else(fell_to(1.0), R::one());
            // Only a solve that gets nowhere pays for this bound. Along a path a state accepted so
            // may lie on another branch: there a shorter step is tried.
            let stuck = match choice.is_none() {
                true => open & !at_floor & R::lit(RISES).at_most(rises),
                false => Mask::NONE,
            } & corrected_by(settings.correction);
            if stuck.any() {
                self.tangent.clear();
                self.add_tangent(structure, &equations, u, None)?;
                self.assembled = Assembled::Nothing;
                let rounding = self.rounding(structure, structure.measure())? / self.unit();
                at_floor |= stuck & balance.residual.at_most(rounding);
            }
            let done = open & (solved_for | at_floor);
            if done.any() {
                if open.all() {
                    solved.fewest = solved.iterations;
                }
                floored = (floored & !done) | (done & !small);
                open = open & !done;
            }
            if !open.any() {
                solved.at_floor = floored.any();
                if extra == 0 {
                    structure.check(u)?;
                    return Ok((solved, equations.factor));
                }
                extra -= 1;
                open = Mask::ALL;
                self.forget();
            }
            if correction.is_some() && (!corrected_by(RUNAWAY) & open).common() {
                let reason = "a correction ten thousand times the size of the structure: a \
                              mechanism or an absurd load, check supports and loads";
                return Err(self.unconverged(solved, reason));
            }
            if solved.iterations == settings.iterations && open.common() {
                return Err(self.unconverged(solved, "no convergence"));
            }
            let renew = match settings.refresh {
                Refresh::EveryIteration => true,
                Refresh::EverySolve | Refresh::Never => false,
                Refresh::WhenSlow => (!fell_to(SLOW) & open).common(),
            };
            previous = Some(balance.residual);
            if searching {
                self.fixed.clear();
                self.fixed.extend_from_slice(&self.scratch);
            }
            if (renew && !current) || !self.factored {
                self.renew(structure, &equations, u, true)?;
                solved.tangents += 1;
            } else {
                self.solve_linear(structure.unknowns())?;
            }
            current = false;
            if searching {
                self.find_changes(structure.unknowns());
                work = self.work_left(structure);
                self.fixed.copy_from_slice(&self.scratch);
            }
            if let Some(choice) = &mut choice {
                let change = self.load_change(structure, &equations, *choice, u)?;
                equations.factor += change.ok_or_else(|| {
                    self.give_up();
                    let reason = "no change of the load leads to a point of it";
                    Error::OffPath { reason }
                })?;
                self.loaded = false;
            }
            correcting = Some(open);
            solved.iterations += 1;
        }
    }

    /// Forgets all that a solve that failed may have led astray.
    fn give_up(&mut self) {
        self.forget();
        self.force = R::zero();
    }

    fn unconverged(&mut self, solved: Solved, reason: &'static str) -> Error {
        self.give_up();
        Error::Unconverged {
            reason,
            iterations: solved.iterations,
            residual: solved.residual,
        }
    }

    fn add_tangent<S: Structure<R> + ?Sized>(
        &mut self,
        structure: &S,
        equations: &Equations<'_, R>,
        u: &[R],
        mass: Option<R>,
    ) -> Result<()> {
        let (time, factor, k) = (equations.time, equations.factor, &mut self.tangent);
        add_tangent_with(structure, (time, factor), u, mass, k)?;
        if let Rest::Permanent = equations.rest {
            structure.subtract_permanent_tangent(time, R::one() - equations.factor, u, k)?;
        }
        structure.add_holding_tangent(time, u, k)
    }

    /// Factorises the tangent at `u` and, where that is wanted, solves with it as
    /// [`solve_linear`](Self::solve_linear) does, or leaves half of the way for
    /// [`find_changes`](Self::find_changes).
    fn renew<S: Structure<R> + ?Sized>(
        &mut self,
        structure: &S,
        equations: &Equations<'_, R>,
        u: &[R],
        solving: bool,
    ) -> Result<()> {
        self.forget();
        let mass = equations.inertia.map(|(rate, _)| rate);
        if self.in_order(structure, equations, u, mass, solving)? {
            self.factored = true;
            return Ok(());
        }
        self.tangent.clear();
        self.add_tangent(structure, equations, u, mass)?;
        let (factor, matrix) = (&mut self.factor, self.tangent.stored());
        let factored = match solving {
            true => {
                let solve = |x: &mut [R]| factor.factor_and_solve(matrix, x);
                solve_by(
                    solve,
                    structure.unknowns(),
                    &mut self.unknown,
                    &mut self.scratch,
                )
            }
            false => factor.factor(matrix),
        };
        self.assembled = match (structure.symmetric(), mass) {
            (true, _) => Assembled::Nothing,
            (false, None) => Assembled::Tangent,
            (false, Some(mass)) => Assembled::WithMass(mass),
        };
        self.definite = self.factor.definite();
        self.factored = factored.is_ok();
        factored.map_err(|error| match singular(structure, error) {
            // Without inertia what moves freely is seen by geometry alone.
            Error::Mechanism { coordinate, pivot }
                if equations.inertia.is_none() && structure.moves_rigidly(u) == Some(false) =>
            {
                Error::StiffnessLost { coordinate, pivot }
            }
            other => other,
        })
    }

    /// [`renew`](Self::renew) for tangents that are likely definite: eliminates in the storage of the
    /// matrix while it is assembled, so that long chains go through the caches once. False where that
    /// cannot be, or the tangent turns out not to be definite.
    fn in_order<S: Structure<R> + ?Sized>(
        &mut self,
        structure: &S,
        equations: &Equations<'_, R>,
        u: &[R],
        mass: Option<R>,
        solving: bool,
    ) -> Result<bool> {
        let Equations { time, factor, .. } = *equations;
        if !self.definite
            || matches!(equations.rest, Rest::Permanent)
            || !structure.multipliers().is_empty()
        {
            return Ok(false);
        }
        let unknowns = structure.unknowns();
        let (factors, k) = (&mut self.factor, &mut self.tangent);
        let load = |x: &mut [R]| unknowns.gather(&self.scratch, x);
        if !factors.begin(solving.then_some(load)) {
            return Ok(false);
        }
        k.clear();
        self.assembled = Assembled::Nothing;
        let mut sound = true;
        structure.add_tangent_in_order(time, factor, u, mass, k, &mut |k, ready| {
            if sound {
                sound = factors.advance(k.stored_mut(), ready)?;
            }
            Ok(())
        })?;
        sound = sound && factors.advance(k.stored_mut(), unknowns.count())?;
        self.definite = sound;
        if sound {
            factors.keep(k.stored_mut());
        }
        Ok(sound)
    }

    /// Replaces the reduced forces in `scratch` by the changes of all coordinates they bring where that
    /// has been done half way.
    fn find_changes(&mut self, unknowns: &Unknowns<R>) {
        if self.factor.is_halfway() {
            unknowns.spread(self.factor.back(0), &mut self.scratch);
        }
    }

    /// Replaces the reduced forces in `scratch` by the changes of all coordinates they bring.
    fn solve_linear(&mut self, unknowns: &Unknowns<R>) -> Result<()> {
        let solve = |x: &mut [R]| self.factor.solve(x);
        solve_by(solve, unknowns, &mut self.unknown, &mut self.scratch)
    }

    /// The changes of all coordinates, in `scratch`, that a load factor larger by one brings by the tangent
    /// last factorised.
    pub(crate) fn find_growth<S: Structure<R> + ?Sized>(
        &mut self,
        structure: &S,
        time: R,
        u: &[R],
    ) -> Result<&[R]> {
        self.scratch.fill(R::zero());
        add_growing(structure, time, u, &mut self.scratch)?;
        structure.unknowns().reduce(&mut self.scratch);
        self.solve_linear(structure.unknowns())?;
        Ok(&self.scratch)
    }

    /// The change of the load factor that goes with the correction in `scratch`, to which what that
    /// change brings is added.
    fn load_change<S: Structure<R> + ?Sized>(
        &mut self,
        structure: &S,
        equations: &Equations<'_, R>,
        choice: &mut Choice<'_, R>,
        u: &[R],
    ) -> Result<Option<R>> {
        self.find_changes(structure.unknowns());
        if !std::mem::replace(&mut self.corrected, true) {
            self.moved.fill(R::zero());
        }
        self.fixed.clear();
        self.fixed.extend_from_slice(&self.scratch);
        self.find_growth(structure, equations.time, u)?;
        let change = choice(&Changes {
            moved: &self.moved,
            residual: &self.fixed,
            load: &self.scratch,
        });
        let Some(change) = change.filter(|change| change.finite()) else {
            return Ok(None);
        };
        for (load, fixed) in self.scratch.iter_mut().zip(&self.fixed) {
            *load = *fixed + change * *load;
        }
        Ok(Some(change))
    }
}

/// Replaces the reduced forces in `x` by the changes of all coordinates they bring.
fn solve_by<R: Real>(
    solve: impl FnOnce(&mut [R]) -> Result<()>,
    unknowns: &Unknowns<R>,
    unknown: &mut [R],
    x: &mut [R],
) -> Result<()> {
    unknowns.gather(x, unknown);
    solve(unknown)?;
    unknowns.spread(unknown, x);
    Ok(())
}

/// A singular matrix in the words of the structure.
fn singular<R: Real, S: Structure<R> + ?Sized>(structure: &S, error: Error) -> Error {
    match error {
        Error::Singular { unknown, pivot } => {
            let coordinate = structure.unknowns().free()[unknown];
            let name = structure.name(coordinate);
            match structure.multipliers().contains(&coordinate) {
                true => Error::Redundant {
                    constraint: name,
                    pivot,
                },
                false => Error::Mechanism {
                    coordinate: name,
                    pivot,
                },
            }
        }
        other => other,
    }
}
