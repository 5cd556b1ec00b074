//! Newton's method for one equilibrium, static or within a time step. Residuals and corrections
//! are measured in the structure's natural sizes, so that scenes of a millimetre and of a
//! kilometre converge alike, and the residual that rounding leaves is estimated from the tangent,
//! so that no slender beam is asked for digits its number type does not have.

use super::band::{BandMatrix, Factor};
use super::{State, Structure};
use crate::error::{Error, Result};
use crate::scalar::Real;

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
}

impl Default for Newton {
    fn default() -> Self {
        Self {
            residual: 1e-10,
            correction: 1e-6,
            iterations: 40,
            refresh: Refresh::EveryIteration,
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

/// What one solve took.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Solved {
    /// Corrections made.
    pub iterations: usize,
    /// Tangents evaluated and factorised.
    pub tangents: usize,
    /// Last residual over the force scale.
    pub residual: f64,
    /// Whether the solve ended above the tolerance, at the residual that rounding leaves: the
    /// answer has no more digits in this number type.
    pub at_floor: bool,
}

/// The equations of one solve: statics at a load level, or a time step. `inertia` gives the
/// factor of the mass matrix in the tangent and the acceleration as a linear function of `u`.
pub(crate) struct Equations<'a, R> {
    /// Time at which loads are taken (s).
    pub(crate) time: R,
    /// Factor of all external forces.
    pub(crate) factor: R,
    /// Acceleration `a = rate * (u - base)`; none in statics.
    pub(crate) inertia: Option<(R, &'a [R])>,
}

/// Vectors and matrices of Newton's method, allocated once.
#[derive(Debug)]
pub(crate) struct Workspace<R> {
    tangent: BandMatrix<R>,
    factor: Factor<R>,
    factored: bool,
    /// The residual that rounding of the forces may leave at the state of the last tangent.
    floor: R,
    internal: Vec<R>,
    external: Vec<R>,
    inertia: Vec<R>,
    pub(crate) scratch: Vec<R>,
    is_fixed: Vec<bool>,
}

/// A force balance: the residual's norm and the largest norm among its parts.
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

impl<R: Real> Workspace<R> {
    pub(crate) fn new<S: Structure<R> + ?Sized>(structure: &S) -> Self {
        let profile = structure.profile();
        let n = profile.size();
        let symmetric = structure.symmetric();
        let zeros = || vec![R::zero(); n];
        let mut is_fixed = vec![false; n];
        for &i in structure.fixed() {
            is_fixed[i] = true;
        }
        Self {
            tangent: if symmetric {
                BandMatrix::symmetric(profile)
            } else {
                BandMatrix::general(profile)
            },
            factor: Factor::new(profile, symmetric),
            factored: false,
            floor: R::zero(),
            internal: zeros(),
            external: zeros(),
            inertia: zeros(),
            scratch: zeros(),
            is_fixed,
        }
    }

    /// Forgets the factorisation, so that the next solve makes a new one.
    pub(crate) fn forget(&mut self) {
        self.factored = false;
    }

    /// Solves `M a(u) + Q_s(u) = factor Q_e(t, u)` from the guess in `u`.
    pub(crate) fn solve<S: Structure<R> + ?Sized>(
        &mut self,
        structure: &S,
        settings: &Newton,
        equations: &Equations<'_, R>,
        u: &mut [R],
    ) -> Result<Solved> {
        let mut solved = Solved::default();
        let mut correction = R::zero();
        let mut previous: Option<R> = None;
        if settings.refresh == Refresh::EverySolve {
            self.forget();
        }
        loop {
            let balance = self.balance(structure, equations, u)?;
            solved.residual = (balance.residual / balance.scale).value();
            if !balance.residual.finite() {
                return Err(self.unconverged(solved, "the residual is not finite"));
            }
            let small = balance.residual <= balance.scale * R::lit(settings.residual);
            let settled = correction <= R::lit(settings.correction);
            // The floor belongs to the state of the last tangent, so to states near it only.
            let near = solved.iterations > 0 && correction <= R::lit(NEAR);
            solved.at_floor = !small && near && balance.residual <= self.floor;
            if (small && settled) || solved.at_floor || balance.residual.is_zero() {
                structure.check(u)?;
                return Ok(solved);
            }
            if correction > R::lit(RUNAWAY) {
                let reason = "a correction ten thousand times the size of the structure: a \
                              mechanism or an absurd load, check supports and loads";
                return Err(self.unconverged(solved, reason));
            }
            if solved.iterations == settings.iterations {
                return Err(self.unconverged(solved, "no convergence"));
            }
            let slow = previous.is_some_and(|p| balance.residual > p * R::lit(SLOW));
            let renew = match settings.refresh {
                Refresh::EveryIteration => true,
                Refresh::EverySolve | Refresh::Never => false,
                Refresh::WhenSlow => slow,
            };
            if renew || !self.factored {
                self.renew(structure, equations, u)?;
                solved.tangents += 1;
            }
            previous = Some(balance.residual);
            correction = self.correct(structure, u)?;
            solved.iterations += 1;
        }
    }

    /// Makes the acceleration of a state consistent: `M a = Q_e - Q_s`.
    pub(crate) fn accelerate<S: Structure<R> + ?Sized>(
        &mut self,
        structure: &S,
        state: &mut State<R>,
    ) -> Result<()> {
        let equations = Equations {
            time: state.time,
            factor: R::one(),
            inertia: None,
        };
        self.inertia.fill(R::zero());
        self.balance(structure, &equations, &state.displacement)?;
        self.tangent.clear();
        structure.add_mass(R::one(), &mut self.tangent)?;
        for &i in structure.fixed() {
            let diagonal = self.tangent.get(i, i);
            self.tangent.fix(i, diagonal)?;
        }
        self.factor.factor(&self.tangent)?;
        self.forget();
        state.acceleration.copy_from_slice(&self.scratch);
        self.factor.solve(&mut state.acceleration)
    }

    /// Work of the applied forces over a step, by the trapezoidal rule.
    pub(crate) fn work<S: Structure<R> + ?Sized>(
        &mut self,
        structure: &S,
        now: &State<R>,
        next: &State<R>,
    ) -> Result<R> {
        if !structure.has_applied() {
            return Ok(R::zero());
        }
        self.external.fill(R::zero());
        for state in [now, next] {
            let u = &state.displacement;
            structure.add_applied(state.time, R::lit(0.5), u, &mut self.external)?;
        }
        let moved = next.displacement.iter().zip(&now.displacement);
        Ok(self
            .external
            .iter()
            .zip(moved)
            .map(|(q, (b, a))| *q * (*b - *a))
            .sum())
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
        structure.add_external(equations.time, equations.factor, u, &mut self.external)?;
        if let Some((rate, base)) = equations.inertia {
            self.inertia.fill(R::zero());
            for i in 0..u.len() {
                self.scratch[i] = rate * (u[i] - base[i]);
            }
            structure.add_mass_times(R::one(), &self.scratch, &mut self.inertia);
        }
        let measure = structure.measure();
        let mut squares = [R::zero(); 4];
        for i in 0..u.len() {
            let mut residual = self.external[i] - self.internal[i] - self.inertia[i];
            if self.is_fixed[i] {
                residual = R::zero();
            }
            self.scratch[i] = residual;
            let parts = [
                residual,
                self.external[i],
                self.internal[i],
                self.inertia[i],
            ];
            for (square, part) in squares.iter_mut().zip(parts) {
                let part = part * measure[i];
                *square += part * part;
            }
        }
        let largest = squares[1].larger(squares[2]).larger(squares[3]);
        // A state without any force is its own solution: avoid 0 / 0.
        let scale = if largest.is_zero() { R::one() } else { largest };
        Ok(Balance {
            residual: norm(squares[0]),
            scale: norm(scale),
        })
    }

    fn renew<S: Structure<R> + ?Sized>(
        &mut self,
        structure: &S,
        equations: &Equations<'_, R>,
        u: &[R],
    ) -> Result<()> {
        self.factored = false;
        self.tangent.clear();
        self.internal.fill(R::zero());
        structure.add_tangent(
            equations.time,
            equations.factor,
            u,
            &mut self.internal,
            &mut self.tangent,
        )?;
        if let Some((rate, _)) = equations.inertia {
            structure.add_mass(rate, &mut self.tangent)?;
        }
        self.tangent.abs_mul_vec(u, &mut self.internal)?;
        let measure = structure.measure();
        let mut square = R::zero();
        for i in 0..u.len() {
            if !self.is_fixed[i] {
                let part = self.internal[i] * measure[i];
                square += part * part;
            }
        }
        self.floor = norm(square) * R::lit(R::EPSILON);
        for &i in structure.fixed() {
            let diagonal = self.tangent.get(i, i).abs();
            self.tangent.fix(i, diagonal)?;
        }
        self.factor.factor(&self.tangent)?;
        self.factored = true;
        Ok(())
    }

    /// Applies one correction and returns its largest component in natural sizes.
    fn correct<S: Structure<R> + ?Sized>(&mut self, structure: &S, u: &mut [R]) -> Result<R> {
        self.factor.solve(&mut self.scratch)?;
        let mut largest = R::zero();
        for ((u, du), measure) in u.iter_mut().zip(&self.scratch).zip(structure.measure()) {
            *u += *du;
            largest = largest.larger((*du / *measure).abs());
        }
        Ok(largest)
    }
}

/// Square root that carries a zero derivative at zero instead of NaN.
fn norm<R: Real>(square: R) -> R {
    if square.is_zero() {
        R::zero()
    } else {
        square.sqrt()
    }
}
