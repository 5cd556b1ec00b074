//! Newton's method for one equilibrium, static or within a time step. Residuals and corrections
//! are measured in the structure's natural sizes, so that scenes of a millimetre and of a
//! kilometre converge alike, and the residual that rounding leaves is estimated from the tangent,
//! so that no slender beam is asked for digits its number type does not have.

mod project;
mod search;

use super::band::Factor;
use super::matrix::Matrix;
use super::structure::{add_growing, held};
use super::unknowns::Unknowns;
use super::{State, Structure, Tape};
use crate::error::{Error, Result};
use crate::scalar::{Mask, Real};

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
    /// Once, at the first solve: how modified Newton fails, for comparison.
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
    /// stretched ones of high energy, and shortened corrections creep. Without effect along paths
    /// and where there are nonlinear constraints.
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

/// What is known of an equilibrium's stability.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
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

/// The equations of one solve: statics at a load level, or a time step.
#[derive(Clone, Copy)]
pub(crate) struct Equations<'a, R> {
    /// Time at which loads are taken (s).
    pub(crate) time: R,
    /// Share of the external forces.
    pub(crate) factor: R,
    /// What acts in place of the rest, `1 - factor`.
    pub(crate) rest: Rest<'a, R>,
    /// Acceleration `predicted + rate * (u - guess)`; none in statics. Formed from corrections
    /// and not from displacements, it keeps its digits at any step size.
    pub(crate) inertia: Option<(R, &'a [R])>,
}

/// What acts in place of the external forces' share that does not.
#[derive(Clone, Copy)]
pub(crate) enum Rest<'a, R> {
    /// Nothing.
    Nothing,
    /// The same share of the permanent ones among them.
    Permanent,
    /// The same share of the internal forces of the state that a load step starts from.
    Start(&'a [R]),
}

/// What the load factor is chosen by when it is an unknown itself: changes of all coordinates.
pub(crate) struct Changes<'a, R> {
    /// Since the start of the solve.
    pub(crate) moved: &'a [R],
    /// By the correction at a fixed load factor.
    pub(crate) residual: &'a [R],
    /// By a unit of the load factor.
    pub(crate) load: &'a [R],
}

/// Chooses the next change of the load factor; none when there is none.
pub(crate) type Choice<'a, R> = dyn FnMut(&Changes<'_, R>) -> Option<R> + 'a;

/// Where forces are taken along a step, with their weight in its mean.
pub(crate) struct Sample<'a, R> {
    pub(crate) weight: R,
    pub(crate) time: R,
    pub(crate) displacement: &'a [R],
    pub(crate) acceleration: &'a [R],
}

impl<'a, R: Real> Sample<'a, R> {
    /// The two ends of a step, with half the weight each.
    pub(crate) fn ends(now: &'a State<R>, next: &'a State<R>) -> [Self; 2] {
        [now, next].map(|state| Self {
            weight: R::lit(0.5),
            time: state.time,
            displacement: &state.displacement,
            acceleration: &state.acceleration,
        })
    }
}

/// Vectors and matrices of Newton's method, allocated once.
#[derive(Debug)]
pub(crate) struct Workspace<R> {
    tangent: Matrix<R>,
    factor: Factor<R>,
    factored: bool,
    /// Whether the factors are those of the mass alone.
    held_mass: bool,
    /// Whether the factors are those of the state that the next solve starts from.
    current: bool,
    /// What rounding of the internal forces may leave at the state of the last tangent.
    floor: R,
    /// The largest force met first in this solve; zero as long as there was none.
    force: R,
    /// The largest natural size of a coordinate.
    size: R,
    internal: Vec<R>,
    external: Vec<R>,
    inertia: Vec<R>,
    scratch: Vec<R>,
    /// What projects rates onto the constraints; nothing without constraints.
    projection: Option<(Matrix<R>, Factor<R>)>,
    /// Sum of the corrections of the last solve.
    moved: Vec<R>,
    /// Right-hand side and solution by unknowns.
    unknown: Vec<R>,
    /// Two more vectors by unknowns.
    rounded: Vec<R>,
    positions: Vec<R>,
    /// Change of coordinates at a fixed load factor, where that is an unknown; the correction made,
    /// where it may be shortened.
    fixed: Vec<R>,
}

/// A force balance: the residual's norm and the largest norm among its parts, in units of the
/// solve's force.
struct Balance<R> {
    residual: R,
    scale: R,
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
        Self {
            tangent: Matrix::zero(unknowns, symmetric),
            factor: Factor::new(unknowns.profile(), symmetric),
            factored: false,
            held_mass: false,
            current: false,
            floor: R::zero(),
            force: R::zero(),
            size: structure
                .measure()
                .iter()
                .copied()
                .fold(R::zero(), R::larger),
            internal: zeros(),
            external: zeros(),
            inertia: zeros(),
            scratch: zeros(),
            projection: (!structure.multipliers().is_empty()).then(|| {
                let matrix = Matrix::zero(unknowns, true);
                (matrix, Factor::new(unknowns.profile(), true))
            }),
            moved: zeros(),
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

    /// The tangent that the next solve starts with, to a tape or from it, where it is kept from
    /// solve to solve.
    pub(crate) fn history(&mut self, refresh: Refresh, tape: &mut Tape<R>) -> Result<()> {
        let kept = matches!(refresh, Refresh::WhenSlow | Refresh::Never);
        let mut factored = kept && self.factored;
        tape.flag(&mut factored)?;
        if factored {
            tape.number(&mut self.floor)?;
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
        match self.renew(structure, equations, u) {
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
        let mut previous: Option<R> = None;
        let mut rises = R::zero();
        // Lanes that go on, and those that ended at the rounding floor. One that has converged is
        // corrected no more, so that its answer is that of its own run.
        let (mut open, mut floored) = (Mask::ALL, Mask::NONE);
        // Derivatives follow the value one correction behind, each order one more.
        let mut extra = R::ORDER;
        self.force = R::zero();
        self.moved.fill(R::zero());
        if settings.refresh == Refresh::EverySolve {
            self.forget();
        }
        let searching =
            settings.line_search && choice.is_none() && structure.multipliers().is_empty();
        let mut work = R::zero();
        loop {
            let mut balance = self.balance(structure, &equations, u)?;
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
            let floor = self.leftover(&balance);
            let mut at_floor =
                balance.residual.at_most(floor) & corrected_by(NEAR) & !fell_to(STALLED);
            rises += R::zero().where_else(fell_to(1.0), R::one());
            // Only a solve that gets nowhere pays for this bound. Along a path a state accepted so
            // may lie on another branch: there a shorter step is tried.
            let stuck = match choice.is_none() {
                true => open & !at_floor & R::lit(RISES).at_most(rises),
                false => Mask::NONE,
            } & corrected_by(settings.correction);
            if stuck.any() {
                self.tangent.clear();
                self.add_tangent(structure, &equations, u)?;
                let rounding = self.rounding(structure, structure.measure())? / self.unit();
                at_floor |= stuck & balance.residual.at_most(rounding);
            }
            let done = open & ((small & corrected_by(settings.correction)) | at_floor);
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
            if (renew && !current) || !self.factored {
                self.renew(structure, &equations, u)?;
                solved.tangents += 1;
            }
            current = false;
            previous = Some(balance.residual);
            if searching {
                self.fixed.clear();
                self.fixed.extend_from_slice(&self.scratch);
            }
            self.solve_linear(structure.unknowns())?;
            if searching {
                work = self.work_left(structure);
                self.fixed.copy_from_slice(&self.scratch);
            }
            if let Some(choice) = &mut choice {
                let change = self.load_change(structure, &equations, *choice, u)?;
                equations.factor += change.ok_or_else(|| {
                    self.unconverged(solved, "the step leads to no point of the path")
                })?;
            }
            correction = Some(self.correct(structure, open, u));
            solved.iterations += 1;
        }
    }

    /// Adds to `q`, zero before, the forces that supports, joints, motions and constraints exert in a
    /// state: what is left of the balance without them.
    pub(crate) fn add_reactions<S: Structure<R> + ?Sized>(
        structure: &S,
        state: &State<R>,
        q: &mut [R],
    ) -> Result<()> {
        structure.add_internal(&state.displacement, q);
        structure.add_mass_times(R::one(), &state.acceleration, q);
        structure.add_external(state.time, -R::one(), &state.displacement, q)
    }

    /// Work over a step, by the trapezoidal rule, of what moves coordinates in time: the reactions'
    /// own, since those of resting supports and joints do none.
    pub(crate) fn driven_work<S: Structure<R> + ?Sized>(
        &mut self,
        structure: &S,
        now: &State<R>,
        next: &State<R>,
    ) -> Result<R> {
        self.driven_work_by(structure, &Sample::ends(now, next), now, next)
    }

    fn driven_work_by<S: Structure<R> + ?Sized>(
        &mut self,
        structure: &S,
        samples: &[Sample<'_, R>],
        now: &State<R>,
        next: &State<R>,
    ) -> Result<R> {
        let mut work = R::zero();
        if structure.is_driven() {
            for sample in samples {
                let (u, a) = (sample.displacement, sample.acceleration);
                self.internal.fill(R::zero());
                structure.add_internal(u, &mut self.internal);
                structure.add_mass_times(R::one(), a, &mut self.internal);
                structure.add_external(sample.time, -R::one(), u, &mut self.internal)?;
                let moved = next.displacement.iter().zip(&now.displacement);
                let forces = self.internal.iter().zip(moved);
                work += forces.map(|(q, (b, a))| *q * (*b - *a)).sum::<R>() * sample.weight;
            }
        }
        Ok(work)
    }

    /// Work over a step of the applied forces, their mean over `samples` along the way from the
    /// state `now` to `next`, and of given motions.
    pub(crate) fn work<S: Structure<R> + ?Sized>(
        &mut self,
        structure: &S,
        samples: &[Sample<'_, R>],
        now: &State<R>,
        next: &State<R>,
    ) -> Result<R> {
        let driven = self.driven_work_by(structure, samples, now, next)?;
        if !structure.has_applied() {
            return Ok(driven);
        }
        self.external.fill(R::zero());
        for sample in samples {
            let (time, u) = (sample.time, sample.displacement);
            structure.add_applied(time, sample.weight, u, &mut self.external)?;
        }
        let moved = next.displacement.iter().zip(&now.displacement);
        let work = self.external.iter().zip(moved);
        Ok(driven + work.map(|(q, (b, a))| *q * (*b - *a)).sum::<R>())
    }

    fn unconverged(&mut self, solved: Solved, reason: &'static str) -> Error {
        self.forget();
        Error::Unconverged {
            reason,
            iterations: solved.iterations,
            residual: solved.residual,
        }
    }

    /// Residual `Q_e - Q_s - M a` in `scratch`, and its norm.
    fn balance<S: Structure<R> + ?Sized>(
        &mut self,
        structure: &S,
        equations: &Equations<'_, R>,
        u: &[R],
    ) -> Result<Balance<R>> {
        self.internal.fill(R::zero());
        self.external.fill(R::zero());
        structure.add_internal(u, &mut self.internal);
        structure.add_holding(equations.time, u, &mut self.internal);
        structure.add_external(equations.time, equations.factor, u, &mut self.external)?;
        let rest = R::one() - equations.factor;
        match equations.rest {
            Rest::Nothing => {}
            Rest::Permanent => {
                structure.add_permanent(equations.time, rest, u, &mut self.external)?;
            }
            Rest::Start(internal) => {
                for (q, internal) in self.external.iter_mut().zip(internal) {
                    *q += rest * *internal;
                }
            }
        }
        match equations.inertia {
            Some((rate, predicted)) => {
                self.inertia.fill(R::zero());
                for i in 0..u.len() {
                    self.scratch[i] = predicted[i] + rate * self.moved[i];
                }
                structure.add_mass_times(R::one(), &self.scratch, &mut self.inertia);
                Ok(self.norms(structure, true))
            }
            None => Ok(self.norms(structure, false)),
        }
    }

    /// Residual in `scratch` and the norms of `[external, internal, inertia]` and of their
    /// balance, over what acts on the unknowns: what a support carries is no measure of the rest.
    fn norms<S: Structure<R> + ?Sized>(&mut self, structure: &S, inertia: bool) -> Balance<R> {
        let measure = structure.measure();
        let unknowns = structure.unknowns();
        unknowns.reduce(&mut self.external);
        unknowns.reduce(&mut self.internal);
        if inertia {
            unknowns.reduce(&mut self.inertia);
        }
        let open = self.force.at_most(R::zero());
        if open.any() {
            let mut largest = R::zero();
            for &i in unknowns.free() {
                let inertia = if inertia { self.inertia[i] } else { R::zero() };
                for force in [self.external[i], self.internal[i], inertia] {
                    largest = largest.larger(force.abs());
                }
            }
            self.force = largest.where_else(open, self.force);
        }
        let (force, size) = (self.unit(), self.size);
        let mut squares = [R::zero(); 4];
        for &i in unknowns.free() {
            let (external, internal) = (self.external[i], self.internal[i]);
            let inertia = if inertia { self.inertia[i] } else { R::zero() };
            let residual = external - internal - inertia;
            self.scratch[i] = residual;
            let size = measure[i] / size;
            for (square, part) in squares
                .iter_mut()
                .zip([residual, external, internal, inertia])
            {
                let part = part / force * size;
                *square += part * part;
            }
        }
        let largest = squares[1].larger(squares[2]).larger(squares[3]);
        // A state without any force is its own solution: avoid 0 / 0.
        let scale = R::one().where_else(largest.at_most(R::zero()), largest);
        Balance {
            residual: norm(squares[0]),
            scale: norm(scale),
        }
    }

    /// The force by which this solve measures others: squares of those on the smallest beams are no
    /// numbers of single precision.
    fn unit(&self) -> R {
        R::one().where_else(self.force.at_most(R::zero()), self.force)
    }

    /// What rounding may leave of a balance.
    fn leftover(&self, balance: &Balance<R>) -> R {
        self.floor / self.unit() + balance.scale * R::lit(8.0 * R::EPSILON)
    }

    fn add_tangent<S: Structure<R> + ?Sized>(
        &mut self,
        structure: &S,
        equations: &Equations<'_, R>,
        u: &[R],
    ) -> Result<()> {
        let (time, k) = (equations.time, &mut self.tangent);
        structure.add_tangent(time, equations.factor, u, k)?;
        if let Rest::Permanent = equations.rest {
            structure.subtract_permanent_tangent(time, R::one() - equations.factor, u, k)?;
        }
        structure.add_holding_tangent(time, u, k)
    }

    fn renew<S: Structure<R> + ?Sized>(
        &mut self,
        structure: &S,
        equations: &Equations<'_, R>,
        u: &[R],
    ) -> Result<()> {
        self.forget();
        self.tangent.clear();
        self.add_tangent(structure, equations, u)?;
        self.floor = self.rounding(structure, u)?;
        if let Some((rate, _)) = equations.inertia {
            structure.add_mass(rate, &mut self.tangent)?;
        }
        let factored = self.factor.factor(self.tangent.stored());
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

    /// Norm of the forces that the tangent makes of a rounding unit of numbers of the sizes given:
    /// with displacements, what the library's own strains leave; with the natural sizes of the
    /// coordinates, what any law does that forms its strains from the whole of them.
    fn rounding<S: Structure<R> + ?Sized>(&mut self, structure: &S, sizes: &[R]) -> Result<R> {
        let unknowns = structure.unknowns();
        for (q, &i) in self.unknown.iter_mut().zip(unknowns.free()) {
            *q = sizes[i];
        }
        let stored = self.tangent.stored();
        stored.abs_mul_vec(&self.unknown, &mut self.rounded)?;
        let measure = structure.measure();
        let multipliers = structure.multipliers();
        if !multipliers.is_empty() {
            // Constraints are formed from positions, which are as large as the structure however
            // small its displacements.
            for (q, &i) in self.unknown.iter_mut().zip(unknowns.free()) {
                *q = measure[i];
            }
            stored.abs_mul_vec(&self.unknown, &mut self.positions)?;
            for (q, rounded) in self.rounded.iter_mut().enumerate() {
                if multipliers.contains(&unknowns.free()[q]) {
                    *rounded = self.positions[q] * R::lit(4.0);
                }
            }
        }
        let (force, size) = (self.unit(), self.size);
        let mut square = R::zero();
        for (rounded, &i) in self.rounded.iter().zip(unknowns.free()) {
            let part = *rounded / force * (measure[i] / size);
            square += part * part;
        }
        Ok(norm(square) * R::lit(R::EPSILON) * self.unit())
    }

    /// What one more correction would change of the displacements `u` just solved for, largest over
    /// largest in natural sizes, when the factors are those of the tangent at `u`. Where rounding is
    /// all that is left of the residual, this is what it takes of the answer: forces that rounding
    /// leaves but that bend nothing do not count, and a tangent that is all rounding itself would
    /// go on as it came. Zero where nothing moved.
    pub(crate) fn open<S: Structure<R> + ?Sized>(&mut self, structure: &S, u: &[R]) -> Result<f64> {
        let (free, multipliers) = (structure.unknowns().free(), structure.multipliers());
        let measure = structure.measure();
        for (x, &i) in self.unknown.iter_mut().zip(free) {
            *x = self.scratch[i];
        }
        self.factor.solve(&mut self.unknown)?;
        let (mut change, mut moved) = (R::zero(), R::zero());
        for (x, &i) in self.unknown.iter().zip(free) {
            if !multipliers.contains(&i) {
                change = change.larger((*x / measure[i]).abs());
                moved = moved.larger((u[i] / measure[i]).abs());
            }
        }
        let still = moved.at_most(R::zero());
        let share = change / R::one().where_else(still, moved);
        Ok(R::zero().where_else(still, share).largest())
    }

    /// Replaces the reduced forces in `scratch` by the changes of all coordinates they bring.
    fn solve_linear(&mut self, unknowns: &Unknowns<R>) -> Result<()> {
        solve_by(
            &mut self.factor,
            unknowns,
            &mut self.unknown,
            &mut self.scratch,
        )
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
        self.fixed.clear();
        self.fixed.extend_from_slice(&self.scratch);
        self.scratch.fill(R::zero());
        add_growing(structure, equations.time, u, &mut self.scratch)?;
        structure.unknowns().reduce(&mut self.scratch);
        self.solve_linear(structure.unknowns())?;
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

    /// Applies the correction in `scratch` to the lanes that are `open` and returns its largest
    /// component in natural sizes.
    fn correct<S: Structure<R> + ?Sized>(&mut self, structure: &S, open: Mask, u: &mut [R]) -> R {
        let mut largest = R::zero();
        let corrected = u.iter_mut().zip(&mut self.moved).zip(&self.scratch);
        let multipliers = structure.multipliers();
        for (i, (((u, moved), du), measure)) in corrected.zip(structure.measure()).enumerate() {
            let du = du.where_else(open, R::zero());
            *u += du;
            *moved += du;
            // Multipliers have no natural size; the residual tells about them.
            if !multipliers.contains(&i) {
                largest = largest.larger((du / *measure).abs());
            }
        }
        largest
    }
}

/// Replaces the reduced forces in `x` by the changes of all coordinates they bring.
fn solve_by<R: Real>(
    factor: &mut Factor<R>,
    unknowns: &Unknowns<R>,
    unknown: &mut [R],
    x: &mut [R],
) -> Result<()> {
    for (q, &i) in unknown.iter_mut().zip(unknowns.free()) {
        *q = x[i];
    }
    factor.solve(unknown)?;
    for (q, &i) in unknown.iter().zip(unknowns.free()) {
        x[i] = *q;
    }
    unknowns.follow(x);
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

/// Square root that carries a zero derivative at zero instead of NaN.
pub(crate) fn norm<R: Real>(square: R) -> R {
    if R::ORDER > 0 && square.is_zero() {
        R::zero()
    } else {
        square.sqrt()
    }
}
