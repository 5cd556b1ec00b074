//! Small motions about a state: natural frequencies with their modes, of structures at rest,
//! deformed or in steady rotation, and linear buckling loads. All are eigenproblems over the
//! unknowns of a [`Structure`], solved with the factorisation the other solvers use.

use super::band::Factor;
use super::eigen::{Goal, Operator, Pair, dominant};
use super::matrix::Matrix;
use super::newton::norm;
use super::structure::{add_growing, held};
use super::{State, Structure};
use crate::error::{Error, Result, finite, positive};
use crate::scalar::Real;

/// Which eigenvalues are sought: a number of the lowest.
///
/// ```
/// use ancf::prelude::*;
///
/// let steel = SaintVenantKirchhoff::isotropic(2.0e11, 0.0)?;
/// let mut scene = Scene::<f64, 2>::new();
/// let rod = Beam::new(FullyParameterised, Disk::new(0.002)?, Continuum::full(steel));
/// let rod = scene.add(rod.straight([0.0; 2], [1.0, 0.0], 16).density(7800.0))?;
/// scene.clamp(rod.start())?;
/// let system = scene.assemble()?;
/// let modes = Modes::lowest(3).vibration(&system, &system.rest(), 1.0)?;
/// let unit = (2.0e11_f64 / 7800.0).sqrt() * 0.002 / 2.0;
/// assert!((modes[0].frequency() / (3.51602 * unit) - 1.0).abs() < 1e-3);
/// # Ok::<(), ancf::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Modes {
    /// How many.
    pub count: usize,
    /// Residual accepted; eigenvalues are right to its square.
    pub tolerance: f64,
    /// Rounds of subspace iteration allowed.
    pub iterations: usize,
}

/// An eigenvalue and its shape.
#[derive(Debug, Clone, PartialEq)]
pub struct Mode<R> {
    /// Square of the circular frequency (rad^2/s^2), negative where the state is unstable; or the
    /// factor of the external load at which the structure buckles.
    pub value: R,
    /// Changes of all coordinates; the largest is 1 in natural sizes.
    pub shape: Vec<R>,
    /// Residual of the pair over its size.
    pub residual: f64,
}

impl<R: Real> Mode<R> {
    /// Circular frequency (rad/s) of a vibration; zero for a mode that is rigid or unstable.
    pub fn frequency(&self) -> R {
        norm(self.value.larger(R::zero()))
    }
}

impl Modes {
    /// The `count` lowest, to rounding.
    pub fn lowest(count: usize) -> Self {
        Self {
            count,
            tolerance: 1e-8,
            iterations: 200,
        }
    }

    fn goal(&self, unknowns: usize) -> Result<Goal> {
        positive("tolerance of an eigenproblem", self.tolerance)?;
        if self.count == 0 {
            return Err(Error::TooFew {
                what: "number of modes",
                value: 0,
                least: 1,
                remedy: "ask for at least one mode",
            });
        }
        if self.count > unknowns {
            return Err(Error::OutOfRange {
                what: "number of modes",
                value: self.count as f64,
                range: "1 to the number of unknowns",
                remedy: "ask for fewer modes or take more elements",
            });
        }
        Ok(Goal {
            count: self.count,
            tolerance: self.tolerance,
            iterations: self.iterations,
        })
    }

    /// Natural frequencies about a state under `factor` of the external load, ascending:
    /// `K phi = omega^2 M phi`, and with gyroscopic forces (a structure seen from a rotating frame)
    /// `(K + i omega G - omega^2 M) phi = 0`, of whose complex shape one phase is given. The state
    /// should be an equilibrium; rigid modes come out with frequencies near zero, modes of an
    /// unstable equilibrium with negative squares. Nonlinear constraints are taken as they are at the
    /// state, which should obey them.
    ///
    /// # Errors
    /// [`Error::Unsupported`] without mass, for an unsymmetric tangent, or for gyroscopic forces
    /// about an equilibrium that is unstable without them; [`Error::Unconverged`]; typed errors for
    /// settings and states that do not fit.
    pub fn vibration<R: Real, S: Structure<R>>(
        &self,
        structure: &S,
        state: &State<R>,
        factor: R,
    ) -> Result<Vec<Mode<R>>> {
        let goal = self.goal(freedom(structure))?;
        if !structure.has_mass() {
            return Err(Error::Unsupported {
                what: "natural frequencies without mass".into(),
                remedy: "give the beams a density with Beam::density",
            });
        }
        let stiffness = tangent(structure, state, factor)?;
        let mut mass = Matrix::zero(structure.unknowns(), true);
        structure.add_mass(R::one(), &mut mass)?;
        if structure.has_gyroscopic() {
            return whirling(structure, &stiffness, &mass, goal);
        }
        let trace = |m: &Matrix<R>| {
            let diagonal = (0..m.stored().size()).map(|i| m.stored().get(i, i).value());
            diagonal.map(f64::abs).sum::<f64>()
        };
        // Of the order of the largest eigenvalue.
        let largest = positive(
            "stiffness over mass of the structure [1/s^2]",
            trace(&stiffness) / trace(&mass),
        )?;
        let least = 1e3 * R::EPSILON * largest;
        let mut inverse = Shifted {
            factor: Factor::new(structure.unknowns().profile(), true),
            matrix: stiffness.clone(),
            stiffness,
            mass,
            held: Multipliers::of(structure),
            shift: 0.0,
        };
        inverse.below(1e-8_f64.max(R::EPSILON) * largest)?;
        let wanted = goal.count - 1;
        let pairs = dominant(&mut inverse, &goal, |inverse, values| {
            // The shift should be small beside the values sought, and no smaller than it need be.
            let last = inverse.value(values[wanted]).value().abs();
            let better = (0.1 * last).max(least);
            match better < 0.1 * inverse.shift.abs() {
                true => inverse.below(better),
                false => Ok(()),
            }
        })?;
        let mut pairs = pairs;
        for pair in &mut pairs {
            pair.value = inverse.value(pair.value);
        }
        Ok(modes(structure, pairs))
    }

    /// Load factors at which an equilibrium under `factor` of the external load would lose its
    /// stability if its stiffness went on changing as it does there, the closest first, whatever
    /// their sign: `(K + (lambda - factor) dK/dlambda) phi = 0` along the path of equilibria. From
    /// the unloaded state this is classical linear buckling; from a state near the critical one it
    /// is accurate for any path. Nonlinear constraints hold in the directions they have at the state.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for an unsymmetric tangent, an unstable state, or a load that changes
    /// no stiffness; [`Error::Unconverged`]; typed errors for settings and states that do not fit.
    pub fn buckling<R: Real, S: Structure<R>>(
        &self,
        structure: &S,
        state: &State<R>,
        factor: R,
    ) -> Result<Vec<Mode<R>>> {
        let unknowns = structure.unknowns();
        let goal = self.goal(freedom(structure))?;
        let stiffness = tangent(structure, state, factor)?;
        let held = Multipliers::of(structure);
        let what = "buckling from an unstable or singular state";
        let factored = definite(&stiffness, &held, what)?;
        let mut inverse = Buckling {
            factor: factored,
            change: Matrix::zero(unknowns, true),
            stiffness,
            held,
        };
        // The path's direction, and a step along it that leaves as many digits as truncation does.
        let mut load = vec![R::zero(); unknowns.coordinates()];
        add_growing(structure, state.time, &state.displacement, &mut load)?;
        unknowns.reduce(&mut load);
        let mut along = vec![R::zero(); unknowns.count()];
        unknowns.gather(&load, &mut along);
        inverse.factor.solve(&mut along)?;
        let along = spread(structure, &along);
        let size = natural(structure, &along);
        if size.is_zero() {
            return Err(Error::Unsupported {
                what: "buckling without an external load".into(),
                remedy: "put a load on the structure",
            });
        }
        let step = R::lit(R::EPSILON.cbrt()) / size;
        for sign in [R::one(), -R::one()] {
            let mut moved = state.clone();
            for (u, along) in moved.displacement.iter_mut().zip(&along) {
                *u += sign * step * *along;
            }
            let there = tangent(structure, &moved, factor + sign * step)?;
            let weight = -sign / (step + step);
            inverse.change.scale_add(weight, &there)?;
        }
        let mut pairs = dominant(&mut inverse, &goal, |_, _| Ok(()))?;
        for pair in &mut pairs {
            pair.value = factor + pair.value.recip();
        }
        Ok(modes(structure, pairs))
    }
}

/// The tangent of a state.
fn tangent<R: Real, S: Structure<R>>(
    structure: &S,
    state: &State<R>,
    factor: R,
) -> Result<Matrix<R>> {
    state.check(structure.unknowns().coordinates())?;
    finite("load factor", factor)?;
    if !structure.symmetric() {
        return Err(Error::Unsupported {
            what: "modes of a structure with an unsymmetric tangent".into(),
            remedy: "replace follower loads by loads that have a potential",
        });
    }
    let mut matrix = Matrix::zero(structure.unknowns(), true);
    let (time, u) = (state.time, &state.displacement);
    structure.add_tangent(time, factor, u, &mut matrix)?;
    structure.subtract_permanent_tangent(time, R::one() - factor, u, &mut matrix)?;
    structure.add_holding_tangent(time, u, &mut matrix)?;
    Ok(matrix)
}

/// How many independent motions a structure has.
fn freedom<R: Real, S: Structure<R>>(structure: &S) -> usize {
    let unknowns = structure.unknowns().count();
    unknowns.saturating_sub(2 * held(structure))
}

/// The unknowns that are multipliers. Matrices with constraints are saddle points: solving with
/// them leads to what the constraints allow, if multipliers are left out on both sides.
#[derive(Debug)]
struct Multipliers(Vec<usize>);

impl Multipliers {
    fn of<R: Real, S: Structure<R>>(structure: &S) -> Self {
        let multipliers = structure.multipliers();
        let unknowns = structure.unknowns().free().iter().enumerate();
        let held = unknowns.filter(|(_, i)| multipliers.contains(i));
        Self(held.map(|(q, _)| q).collect())
    }

    fn leave_out<R: Real>(&self, x: &mut [R]) {
        for q in &self.0 {
            x[*q] = R::zero();
        }
    }

    /// Solves within what the constraints allow.
    fn solve<R: Real>(&self, factor: &mut Factor<R>, x: &mut [R]) -> Result<()> {
        self.leave_out(x);
        factor.solve(x)?;
        self.leave_out(x);
        Ok(())
    }

    /// Whether factors are those of a matrix that is positive definite where the constraints allow
    /// motion: each of these brings one negative eigenvalue.
    fn definite<R: Real>(&self, factor: &Factor<R>) -> bool {
        factor.inertia() == Some(self.0.len())
    }
}

/// The factors of a matrix that must be positive definite where the constraints allow motion.
fn definite<R: Real>(matrix: &Matrix<R>, held: &Multipliers, what: &str) -> Result<Factor<R>> {
    let mut factor = Factor::new(matrix.stored().profile(), true);
    match factor.factor(matrix.stored()) {
        Ok(()) if held.definite(&factor) => Ok(factor),
        Ok(()) | Err(Error::Singular { .. }) => Err(Error::Unsupported {
            what: what.into(),
            remedy: "start from a stable equilibrium with enough supports",
        }),
        Err(error) => Err(error),
    }
}

/// Changes of the unknowns as changes of all coordinates.
pub(super) fn spread<R: Real, S: Structure<R>>(structure: &S, x: &[R]) -> Vec<R> {
    let unknowns = structure.unknowns();
    let mut all = vec![R::zero(); unknowns.coordinates()];
    unknowns.spread(x, &mut all);
    all
}

/// The largest component in natural sizes.
pub(super) fn natural<R: Real, S: Structure<R>>(structure: &S, x: &[R]) -> R {
    let sizes = x.iter().zip(structure.measure());
    sizes.fold(R::zero(), |largest, (x, unit)| {
        largest.larger((*x / *unit).abs())
    })
}

/// The modes of pairs whose vectors begin with the unknowns.
fn modes<R: Real, S: Structure<R>>(structure: &S, pairs: Vec<Pair<R>>) -> Vec<Mode<R>> {
    let mode = |pair: Pair<R>| {
        let mut shape = spread(structure, &pair.vector);
        let scale = natural(structure, &shape).recip();
        shape.iter_mut().for_each(|x| *x *= scale);
        Mode {
            value: pair.value,
            shape,
            residual: pair.residual,
        }
    };
    pairs.into_iter().map(mode).collect()
}

/// `(K - shift M)^-1 M`, in the metric `M`.
struct Shifted<R> {
    stiffness: Matrix<R>,
    mass: Matrix<R>,
    /// `K - shift M`.
    matrix: Matrix<R>,
    factor: Factor<R>,
    held: Multipliers,
    shift: f64,
}

impl<R: Real> Shifted<R> {
    /// Shifts to below zero by at least `distance` and below every eigenvalue.
    fn below(&mut self, mut distance: f64) -> Result<()> {
        for _ in 0..40 {
            self.shift = -distance;
            self.matrix.clear();
            self.matrix.scale_add(R::one(), &self.stiffness)?;
            self.matrix.scale_add(R::lit(distance), &self.mass)?;
            match self.factor.factor(self.matrix.stored()) {
                Ok(()) if self.held.definite(&self.factor) => return Ok(()),
                Ok(()) | Err(Error::Singular { .. }) => distance *= 10.0,
                Err(error) => return Err(error),
            }
        }
        Err(Error::NotPositive {
            what: "definiteness of the mass matrix, whose smallest share",
            value: 0.0,
        })
    }

    /// The eigenvalue of `K phi = value M phi` for one of the operator.
    fn value(&self, of_inverse: R) -> R {
        of_inverse.recip() + R::lit(self.shift)
    }
}

impl<R: Real> Operator<R> for Shifted<R> {
    fn size(&self) -> usize {
        self.mass.stored().size()
    }

    fn rank(&self) -> usize {
        self.size() - 2 * self.held.0.len()
    }

    fn apply(&mut self, x: &[R], y: &mut [R]) -> Result<()> {
        self.mass.stored().mul_vec(x, y)?;
        self.held.solve(&mut self.factor, y)
    }

    fn metric(&mut self, x: &[R], y: &mut [R]) -> Result<()> {
        self.mass.stored().mul_vec(x, y)
    }
}

/// `K^-1 (-dK)`, in the metric `K`.
struct Buckling<R> {
    stiffness: Matrix<R>,
    /// `-dK/dlambda`.
    change: Matrix<R>,
    factor: Factor<R>,
    held: Multipliers,
}

impl<R: Real> Operator<R> for Buckling<R> {
    fn size(&self) -> usize {
        self.stiffness.stored().size()
    }

    fn rank(&self) -> usize {
        self.size() - 2 * self.held.0.len()
    }

    fn apply(&mut self, x: &[R], y: &mut [R]) -> Result<()> {
        self.change.stored().mul_vec(x, y)?;
        self.held.solve(&mut self.factor, y)
    }

    fn metric(&mut self, x: &[R], y: &mut [R]) -> Result<()> {
        self.stiffness.stored().mul_vec(x, y)?;
        self.held.leave_out(y);
        Ok(())
    }
}

/// Gyroscopic systems without damping (L. Meirovitch, *A new method of solution of the eigenvalue
/// problem for gyroscopic systems*, AIAA Journal 12, 1974): on displacements and velocities
/// `(u, s)`, `T (u, s) = (-K^-1 (G u + M s), u)` has the eigenvalues `1 / (i omega)` and is skew in
/// the metric of the energy, so `-T^2` is symmetric there, with `1 / omega^2` twice.
struct Whirling<'a, R, S> {
    structure: &'a S,
    stiffness: &'a Matrix<R>,
    mass: &'a Matrix<R>,
    factor: Factor<R>,
    /// By coordinates.
    moved: Vec<R>,
    force: Vec<R>,
    half: Vec<R>,
}

impl<R: Real, S: Structure<R>> Whirling<'_, R, S> {
    /// `y = T x`.
    fn once(&mut self, x: &[R], y: &mut [R]) -> Result<()> {
        let unknowns = self.structure.unknowns();
        let n = unknowns.count();
        let (u, s) = x.split_at(n);
        let (top, bottom) = y.split_at_mut(n);
        unknowns.spread(u, &mut self.moved);
        self.force.fill(R::zero());
        self.structure.add_gyroscopic(&self.moved, &mut self.force);
        unknowns.reduce(&mut self.force);
        self.mass.stored().mul_vec(s, top)?;
        for (q, i) in top.iter_mut().zip(unknowns.free()) {
            *q = -*q - self.force[*i];
        }
        self.factor.solve(top)?;
        bottom.copy_from_slice(u);
        Ok(())
    }
}

impl<R: Real, S: Structure<R>> Operator<R> for Whirling<'_, R, S> {
    fn size(&self) -> usize {
        2 * self.mass.stored().size()
    }

    fn apply(&mut self, x: &[R], y: &mut [R]) -> Result<()> {
        let mut half = std::mem::take(&mut self.half);
        self.once(x, &mut half)?;
        self.once(&half, y)?;
        self.half = half;
        y.iter_mut().for_each(|y| *y = -*y);
        Ok(())
    }

    fn metric(&mut self, x: &[R], y: &mut [R]) -> Result<()> {
        let n = self.mass.stored().size();
        let ((u, s), (p, q)) = (x.split_at(n), y.split_at_mut(n));
        self.stiffness.stored().mul_vec(u, p)?;
        self.mass.stored().mul_vec(s, q)
    }
}

fn whirling<R: Real, S: Structure<R>>(
    structure: &S,
    stiffness: &Matrix<R>,
    mass: &Matrix<R>,
    goal: Goal,
) -> Result<Vec<Mode<R>>> {
    let unknowns = structure.unknowns();
    let zeros = || vec![R::zero(); unknowns.coordinates()];
    let what = "frequencies with gyroscopic forces about a state that is unstable without them";
    let mut operator = Whirling {
        structure,
        stiffness,
        mass,
        factor: definite(stiffness, &Multipliers::of(structure), what)?,
        moved: zeros(),
        force: zeros(),
        half: vec![R::zero(); 2 * unknowns.count()],
    };
    let twice = Goal {
        count: 2 * goal.count,
        ..goal
    };
    let pairs = dominant(&mut operator, &twice, |_, _| Ok(()))?;
    // Every frequency comes twice, as two phases of one motion.
    let mut pairs: Vec<_> = pairs.into_iter().step_by(2).collect();
    for pair in &mut pairs {
        pair.value = pair.value.recip();
    }
    Ok(modes(structure, pairs))
}
