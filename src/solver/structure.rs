//! What a solver knows of a mechanical system: a residual, a tangent and a mass matrix over a
//! vector of coordinates. Beams are one implementation; a pendulum of one unknown in a test is
//! another.

use std::ops::Range;

use super::matrix::Matrix;
use super::unknowns::Unknowns;
use crate::error::{Error, Result};
use crate::scalar::Real;

/// What a vector of coordinates holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rate {
    /// Displacements.
    Displacement,
    /// Their first derivatives by time.
    Velocity,
    /// Their second derivatives by time.
    Acceleration,
}

/// What the force of a structure over a step, [`Structure::add_secant`], is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Secant {
    /// The structure has none.
    Absent,
    /// Its work is the change of the internal energy. Linear momentum is kept, angular momentum
    /// only to the order of the step, and there is no strain to be viscous in.
    Path,
    /// The same from strains that no rotation changes: angular momentum is kept, too, and the
    /// strain may be viscous.
    Strain,
}

/// Takes a matrix of which as many of the first unknowns are complete.
pub type Ready<'a, R> = &'a mut dyn FnMut(&mut Matrix<R>, usize) -> Result<()>;

/// A part of a structure whose forces are evaluated together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Part {
    /// Its elements, as the structure counts them; none for the whole structure.
    pub elements: Option<Range<usize>>,
    /// The coordinates that its forces depend on and act on.
    pub coordinates: Range<usize>,
    /// From which coordinate on no later part acts.
    pub complete: usize,
}

impl Part {
    /// All of a structure with as many coordinates.
    #[must_use]
    pub fn whole(coordinates: usize) -> Self {
        Self {
            elements: None,
            coordinates: 0..coordinates,
            complete: 0,
        }
    }
}

/// A structure with `n` coordinates: `M a + Q_s(u) = Q_e(t, u)` (eq. 16 of Orzechowski 2012) in
/// displacements `u` from the reference state. Every method adds to its output.
pub trait Structure<R: Real> {
    /// Which coordinates are solved for, how the others follow from them, and which couple.
    fn unknowns(&self) -> &Unknowns<R>;

    /// Whether the tangent is symmetric at every state.
    fn symmetric(&self) -> bool;

    /// Makes the coordinates that are not solved for obey what binds them: displacements, or
    /// rates of them, as they are at `time` (s). By default no motion is given in time.
    ///
    /// # Errors
    /// When a given motion is not finite.
    fn impose(&self, _time: R, _rate: Rate, x: &mut [R]) -> Result<()> {
        self.unknowns().follow(x);
        Ok(())
    }

    /// Coordinates that are Lagrange multipliers of nonlinear constraints; none by default. They
    /// have no mass, and states carry no velocity or acceleration of them.
    fn multipliers(&self) -> Range<usize> {
        0..0
    }

    /// Adds what the constraints contribute to the internal forces: their forces on the
    /// coordinates they hold, and their residuals, in units that make the tangent symmetric, on
    /// their multipliers.
    fn add_holding(&self, _time: R, _u: &[R], _q: &mut [R]) {}

    /// Adds the derivative of [`add_holding`](Self::add_holding) by the coordinates.
    ///
    /// # Errors
    /// When the matrix is of other unknowns.
    fn add_holding_tangent(&self, _time: R, _u: &[R], _k: &mut Matrix<R>) -> Result<()> {
        Ok(())
    }

    /// Writes on the multipliers in `out`, in the units of [`add_holding`](Self::add_holding), what
    /// the constraints leave of as much of a motion as is given: of displacements `[u]` their
    /// residuals, of `[u, v]` the first and of `[u, v, a]` the second derivatives of them by time.
    fn violation(&self, _time: R, _motion: &[&[R]], _out: &mut [R]) {}

    /// Tells the derivatives `G` of the residuals at `[u]`, or the derivatives of those by time
    /// along `[u, v]`: every entry by its multiplier and its coordinate, in the units of
    /// [`add_holding`](Self::add_holding).
    fn gradient(&self, _time: R, _motion: &[&[R]], _tell: &mut dyn FnMut(usize, usize, R)) {}

    /// Adds `factor` times the derivative of the constraints' forces `G^T lambda` by the coordinates
    /// they hold, with the multipliers in `u`.
    ///
    /// # Errors
    /// When the matrix is of other unknowns.
    fn add_curvature(&self, _time: R, _factor: R, _u: &[R], _k: &mut Matrix<R>) -> Result<()> {
        Ok(())
    }

    /// The factor that brings the mass to the size of the constraints' derivatives, beside which it
    /// stands where rates are projected onto what the constraints allow.
    fn mass_factor(&self) -> R {
        R::one()
    }

    /// Natural size of each coordinate (the length of the body for positions, 1 for slopes): what
    /// makes residuals and corrections comparable between scenes of any size.
    fn measure(&self) -> &[R];

    /// Adds the internal forces `Q_s(u)`.
    fn add_internal(&self, u: &[R], q: &mut [R]);

    /// Shows the parts that internal forces and inertia are evaluated in, from the last coordinates to
    /// the first, as a linear system is solved backwards: each part depends and acts on no coordinate
    /// that is complete before it, and the last one shown completes all. So a long structure goes
    /// through the caches once where several sums are formed side by side. By default it is one part. A
    /// structure in several implements this, [`add_internal_of`](Self::add_internal_of) and
    /// [`add_mass_times_of`](Self::add_mass_times_of), or none of them. Where coordinates follow from others or are multipliers, forces are evaluated as a
    /// whole, whatever is shown.
    fn each_part(&self, each: &mut dyn FnMut(&Part)) {
        each(&Part::whole(self.unknowns().coordinates()));
    }

    /// Adds the internal forces of a part that [`each_part`](Self::each_part) showed, or of the whole, to
    /// `q`, which starts at the first of the part's coordinates. What `u` holds before these is not the
    /// state.
    fn add_internal_of(&self, part: &Part, u: &[R], q: &mut [R]) {
        debug_assert!(part.elements.is_none(), "parts have forces of their own");
        self.add_internal(u, q);
    }

    /// Adds `factor * M a` of a part that [`each_part`](Self::each_part) showed, or of the whole; `a` and
    /// `out` start at the first of the part's coordinates.
    fn add_mass_times_of(&self, part: &Part, factor: R, a: &[R], out: &mut [R]) {
        debug_assert!(part.elements.is_none(), "parts have inertia of their own");
        self.add_mass_times(factor, a, out);
    }

    /// Whether external forces at a given time and load factor change with the state; by default they
    /// may.
    fn has_following(&self) -> bool {
        true
    }

    /// Whether external forces at a given state and load factor are the same at all times, so that those
    /// that do not follow the state need not be formed step by step; by default they may change.
    fn is_steady(&self) -> bool {
        false
    }

    /// Adds `factor * Q_e(t, u)`, all external forces; none by default.
    ///
    /// # Errors
    /// When a load is not finite.
    fn add_external(&self, _time: R, _factor: R, _u: &[R], _q: &mut [R]) -> Result<()> {
        Ok(())
    }

    /// Adds `factor` times the permanent ones of the external forces, which act in full whatever the
    /// load factor of a path of equilibria; none by default.
    ///
    /// # Errors
    /// When a load is not finite.
    fn add_permanent(&self, _time: R, _factor: R, _u: &[R], _q: &mut [R]) -> Result<()> {
        Ok(())
    }

    /// Subtracts the derivative of [`add_permanent`](Self::add_permanent) by the coordinates.
    ///
    /// # Errors
    /// When a load is not finite.
    fn subtract_permanent_tangent(
        &self,
        _time: R,
        _factor: R,
        _u: &[R],
        _k: &mut Matrix<R>,
    ) -> Result<()> {
        Ok(())
    }

    /// Whether there are external forces whose work is counted step by step (nodal loads, which
    /// are no potential of the structure's own); none by default.
    fn has_applied(&self) -> bool {
        false
    }

    /// Whether coordinates or constraints are moved in time, so that what moves them does work; not
    /// by default.
    fn is_driven(&self) -> bool {
        false
    }

    /// Adds the part of the external forces whose work is counted.
    ///
    /// # Errors
    /// When a load is not finite.
    fn add_applied(&self, _time: R, _factor: R, _u: &[R], _q: &mut [R]) -> Result<()> {
        Ok(())
    }

    /// Adds the tangent `d(Q_s - factor Q_e)/du` to `k`, without that of constraints.
    ///
    /// # Errors
    /// When a load is not finite.
    fn add_tangent(&self, time: R, factor: R, u: &[R], k: &mut Matrix<R>) -> Result<()>;

    /// Adds the tangent and `mass * M`; by default one after the other.
    ///
    /// # Errors
    /// Those of [`add_tangent`](Self::add_tangent) and [`add_mass`](Self::add_mass).
    fn add_tangent_and_mass(
        &self,
        time: R,
        factor: R,
        u: &[R],
        mass: R,
        k: &mut Matrix<R>,
    ) -> Result<()> {
        self.add_tangent(time, factor, u, k)?;
        self.add_mass(mass, k)
    }

    /// Adds the tangent and, with a `mass`, that times `M`, and may tell as it goes how many of the first
    /// unknowns are complete, which means that nothing more is added to an entry of theirs: elimination
    /// follows while the caches hold their lines, and leaves nothing of these that can be read. What is
    /// not told of counts as complete in the end; by default that is all.
    ///
    /// # Errors
    /// Those of [`add_tangent`](Self::add_tangent), [`add_mass`](Self::add_mass) and `ready`.
    fn add_tangent_in_order(
        &self,
        time: R,
        factor: R,
        u: &[R],
        mass: Option<R>,
        k: &mut Matrix<R>,
        _ready: Ready<'_, R>,
    ) -> Result<()> {
        add_tangent_with(self, (time, factor), u, mass, k)
    }

    /// What coordinate `i` is, in words, for messages.
    fn name(&self, i: usize) -> String {
        format!("coordinate {i}")
    }

    /// Whether a motion from the state `u` deforms nothing and nothing holds it, asked where the
    /// tangent is singular; by default that is not known.
    fn moves_rigidly(&self, _u: &[R]) -> Option<bool> {
        None
    }

    /// Whether a converged state is one the model can mean; by default every state is.
    ///
    /// # Errors
    /// For a state that solves the equations but not the problem, such as a beam turned inside
    /// out.
    fn check(&self, _u: &[R]) -> Result<()> {
        Ok(())
    }

    /// Whether there is a mass matrix.
    fn has_mass(&self) -> bool;

    /// Adds `factor * M a`.
    fn add_mass_times(&self, factor: R, a: &[R], out: &mut [R]);

    /// Adds `factor * M` to a matrix.
    ///
    /// # Errors
    /// When the matrix is of other unknowns.
    fn add_mass(&self, factor: R, k: &mut Matrix<R>) -> Result<()>;

    /// What the secant force is made of; absent by default.
    fn secant(&self) -> Secant {
        Secant::Absent
    }

    /// Adds the secant force of the step between two states, which does the work
    /// `U(to) - U(from)` on the way, and with a `viscosity` the force of the stress that this share
    /// of the change of strain makes. Only called where [`secant`](Self::secant) is not absent.
    fn add_secant(&self, _viscosity: R, _from: &[R], _to: &[R], _q: &mut [R]) {}

    /// Adds the derivative by `to` of the secant force minus `factor` times the external forces half
    /// way, `at` being that time and factor.
    ///
    /// # Errors
    /// When a load is not finite, or there is no secant force.
    fn add_secant_tangent(
        &self,
        _at: (R, R),
        _viscosity: R,
        _from: &[R],
        _to: &[R],
        _k: &mut Matrix<R>,
    ) -> Result<()> {
        Err(Error::Unsupported {
            what: "the energy-momentum method on a structure without a secant force".into(),
            remedy: "implement secant, add_secant and add_secant_tangent of Structure, or use another method",
        })
    }

    /// Whether there are gyroscopic forces, as in a rotating frame; none by default.
    fn has_gyroscopic(&self) -> bool {
        false
    }

    /// Adds the gyroscopic forces `G v`, `G` skew; none by default.
    fn add_gyroscopic(&self, _v: &[R], _out: &mut [R]) {}
}

/// Adds the tangent and, with a `mass`, that times `M`.
pub(crate) fn add_tangent_with<R: Real, S: Structure<R> + ?Sized>(
    structure: &S,
    (time, factor): (R, R),
    u: &[R],
    mass: Option<R>,
    k: &mut Matrix<R>,
) -> Result<()> {
    match mass {
        Some(mass) => structure.add_tangent_and_mass(time, factor, u, mass, k),
        None => structure.add_tangent(time, factor, u, k),
    }
}

/// Shows every entry of [`Structure::gradient`] to what may fail.
pub(crate) fn each_gradient<R: Real, S: Structure<R> + ?Sized>(
    structure: &S,
    time: R,
    motion: &[&[R]],
    mut show: impl FnMut(usize, usize, R) -> Result<()>,
) -> Result<()> {
    let mut result = Ok(());
    structure.gradient(time, motion, &mut |multiplier, i, slope| {
        if result.is_ok() {
            result = show(multiplier, i, slope);
        }
    });
    result
}

/// Adds `[f M, G^T; G, 0]` to a matrix, by which rates are projected onto what the
/// constraints allow at `u`; `f` is [`Structure::mass_factor`].
pub(crate) fn add_projection<R: Real, S: Structure<R> + ?Sized>(
    structure: &S,
    time: R,
    u: &[R],
    k: &mut Matrix<R>,
) -> Result<()> {
    structure.add_mass(structure.mass_factor(), k)?;
    each_gradient(structure, time, &[u], |multiplier, i, slope| {
        k.add(multiplier, i, slope)?;
        k.add(i, multiplier, slope)
    })
}

/// Adds the external forces that grow with the load factor of a path.
pub(crate) fn add_growing<R: Real, S: Structure<R> + ?Sized>(
    structure: &S,
    time: R,
    u: &[R],
    q: &mut [R],
) -> Result<()> {
    structure.add_external(time, R::one(), u, q)?;
    structure.add_permanent(time, -R::one(), u, q)
}

/// How many multipliers are solved for: those of conditions that do not follow from others.
pub(crate) fn held<R: Real, S: Structure<R> + ?Sized>(structure: &S) -> usize {
    let multipliers = structure.multipliers();
    let free = structure.unknowns().free().iter();
    free.filter(|i| multipliers.contains(i)).count()
}
