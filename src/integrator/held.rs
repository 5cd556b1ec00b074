//! Constraints over a step, for methods whose forces are those half way: the multipliers push along
//! the derivatives half way and the conditions hold at the end. For conditions quadratic in the
//! coordinates (rigidity, distances, and functions of those) the derivative half way is a discrete
//! gradient, `G (u_{n+1} - u_n) = g_{n+1} - g_n` (Gonzalez 1999): such multipliers do no work. They
//! exert no net force or torque where the conditions are blind to rigid motion. Other conditions
//! let energy go with the second order of the step.

use std::cell::RefCell;
use std::ops::Range;

use crate::error::Result;
use crate::scalar::Real;
use crate::solver::{Matrix, Part, Ready, Structure, Unknowns, each_gradient};

/// Where a step's constraints act, `at` the time half way, and where they hold, the time `end`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Held<R> {
    pub(super) at: R,
    pub(super) end: R,
}

impl<R: Real> Held<R> {
    /// Adds the forces of the multipliers in `middle` and the residuals at the end.
    pub(super) fn add<S: Structure<R>>(self, structure: &S, middle: &[R], end: &[R], q: &mut [R]) {
        structure.gradient(self.at, &[middle], &mut |multiplier, i, slope| {
            q[i] += middle[multiplier] * slope;
        });
        structure.violation(self.end, &[end], q);
    }

    /// Adds the derivative of both where a unit of change of the unknowns moves the middle and the
    /// end by these.
    pub(super) fn add_tangent<S: Structure<R>>(
        self,
        structure: &S,
        middle: &[R],
        end: &[R],
        moves: [R; 2],
        k: &mut Matrix<R>,
    ) -> Result<()> {
        structure.add_curvature(self.at, moves[0], middle, k)?;
        each_gradient(structure, self.at, &[middle], |multiplier, i, slope| {
            k.add(i, multiplier, slope)
        })?;
        each_gradient(structure, self.end, &[end], |multiplier, i, slope| {
            k.add(multiplier, i, moves[1] * slope)
        })
    }
}

/// A structure half way through a step from a given state: its unknowns are those half way, where
/// its forces act.
pub(super) struct Middle<'a, R, S> {
    pub(super) structure: &'a S,
    pub(super) from: &'a [R],
    pub(super) held: Held<R>,
    /// Displacements at the end.
    pub(super) end: RefCell<&'a mut [R]>,
}

impl<R: Real, S: Structure<R>> Middle<'_, R, S> {
    fn run(&self, middle: &[R]) {
        let mut end = self.end.borrow_mut();
        for (i, end) in end.iter_mut().enumerate() {
            *end = middle[i] + (middle[i] - self.from[i]);
        }
    }
}

impl<R: Real, S: Structure<R>> Structure<R> for Middle<'_, R, S> {
    fn unknowns(&self) -> &Unknowns<R> {
        self.structure.unknowns()
    }
    fn symmetric(&self) -> bool {
        self.structure.symmetric() && self.multipliers().is_empty()
    }
    fn multipliers(&self) -> Range<usize> {
        self.structure.multipliers()
    }
    fn add_holding(&self, _time: R, u: &[R], q: &mut [R]) {
        if !self.multipliers().is_empty() {
            self.run(u);
            self.held.add(self.structure, u, &self.end.borrow(), q);
        }
    }
    fn add_holding_tangent(&self, _time: R, u: &[R], k: &mut Matrix<R>) -> Result<()> {
        if self.multipliers().is_empty() {
            return Ok(());
        }
        self.run(u);
        let moves = [R::one(), R::lit(2.0)];
        self.held
            .add_tangent(self.structure, u, &self.end.borrow(), moves, k)
    }
    fn measure(&self) -> &[R] {
        self.structure.measure()
    }
    fn add_internal(&self, u: &[R], q: &mut [R]) {
        self.structure.add_internal(u, q);
    }
    fn each_part(&self, each: &mut dyn FnMut(&Part)) {
        self.structure.each_part(each);
    }
    fn add_internal_of(&self, part: &Part, u: &[R], q: &mut [R]) {
        self.structure.add_internal_of(part, u, q);
    }
    fn add_mass_times_of(&self, part: &Part, factor: R, a: &[R], out: &mut [R]) {
        self.structure.add_mass_times_of(part, factor, a, out);
    }
    fn has_following(&self) -> bool {
        self.structure.has_following()
    }
    fn is_steady(&self) -> bool {
        self.structure.is_steady()
    }
    fn add_external(&self, time: R, factor: R, u: &[R], q: &mut [R]) -> Result<()> {
        self.structure.add_external(time, factor, u, q)
    }
    fn add_tangent(&self, time: R, factor: R, u: &[R], k: &mut Matrix<R>) -> Result<()> {
        self.structure.add_tangent(time, factor, u, k)
    }
    fn add_tangent_and_mass(
        &self,
        time: R,
        factor: R,
        u: &[R],
        mass: R,
        k: &mut Matrix<R>,
    ) -> Result<()> {
        self.structure
            .add_tangent_and_mass(time, factor, u, mass, k)
    }
    fn add_tangent_in_order(
        &self,
        time: R,
        factor: R,
        u: &[R],
        mass: Option<R>,
        k: &mut Matrix<R>,
        ready: Ready<'_, R>,
    ) -> Result<()> {
        self.structure
            .add_tangent_in_order(time, factor, u, mass, k, ready)
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
