//! Critical points of a path of equilibria, where its stability changes: located between two
//! points of the path, told apart as limit and bifurcation points, and left along another branch.
//! Where loads follow the motion the tangent is unsymmetric, and only the sign of its determinant
//! tells: what changes it is found all the same, two eigenvalues that cross zero in one step are not,
//! nor is flutter, in which none does.

use super::band::Factor;
use super::continuation::{Continuation, mean};
use super::newton::{Changes, Stability, norm};
use super::{State, Structure, add_growing};
use crate::error::{Error, Result, positive};
use crate::scalar::Real;

/// What happens at a critical point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Criticality {
    /// The load has an extremum: the critical direction does work with it.
    Limit,
    /// Another path crosses: the load does no work along the critical direction.
    Bifurcation,
}

/// A limit or bifurcation point.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Critical<R> {
    /// Which of the two.
    pub kind: Criticality,
    /// The equilibrium.
    pub state: State<R>,
    /// Share of the external load it carries.
    pub factor: R,
    /// The critical direction, changes of all coordinates; the largest is 1 in natural sizes.
    pub shape: Vec<R>,
    /// In how many directions the path is unstable before and after the point; `None` where the
    /// factorisation does not tell: of unsymmetric tangents, and of those so near to singular that they
    /// had to be pivoted.
    pub unstable: [Option<usize>; 2],
}

/// Share of the load in the critical direction, in natural sizes, below which a point is one of
/// bifurcation: a structure as perfect as this has no use for the difference.
const ACROSS: f64 = 1e-4;

/// Points tried to locate a critical one.
const TRIES: usize = 60;

impl<R: Real, S: Structure<R>> Continuation<'_, R, S> {
    /// The critical point within the step from the last point to the one tried, which is in
    /// `spare`, too, and has `factor` of the load, to a share `accuracy` of the step.
    ///
    /// The eigenvalue nearest zero is driven to zero by the rule of Illinois, inside brackets that
    /// the count of negative eigenvalues keeps, or under follower loads the sign of the determinant.
    ///
    /// # Errors
    /// [`Error::OffPath`] when the two points are not of one path: brackets close in a jump.
    pub(super) fn locate(
        &mut self,
        accuracy: f64,
        factor: R,
        [start, end]: [Stability; 2],
    ) -> Result<Critical<R>> {
        let whole = self.length(factor);
        let mut shape = self.start_shape();
        // What the forces must do work along for the load to have an extremum.
        let mut left = shape.clone();
        // The eigenvalue at the end tried, whose tangent is at hand, and at the start.
        let mut last = self.nearest(&mut shape)?;
        let here = self.equations(self.factor);
        self.workspace
            .stability(self.structure, &here, &self.state.displacement)?;
        let mut first = self.nearest(&mut shape)?;
        let (mut low, mut high) = (R::zero(), R::one());
        let mut ends = [
            (self.state.displacement.clone(), self.factor),
            (self.spare.clone(), factor),
        ];
        let step = self.apart(&ends);
        let mut nearer = 1;
        for attempt in 0..TRIES {
            let share = match first * last < R::zero() && attempt % 4 != 3 {
                true => first / (first - last),
                false => R::lit(0.5),
            };
            // Brackets close from both sides.
            let margin = (R::lit(0.1 * accuracy) / (high - low)).smaller(R::lit(0.5));
            let share = share.larger(margin).smaller(R::one() - margin);
            let at = low + (high - low) * share;
            // A tangent kept from another point leads astray at first, so far that points at hardly
            // different lengths lie apart.
            self.workspace.forget();
            let (_, load) = self.advance(at * whole)?;
            let equations = self.equations(load);
            let found = self
                .workspace
                .stability(self.structure, &equations, &self.u)?;
            let value = self.nearest(&mut shape)?;
            if !self.structure.symmetric() {
                self.iterate(&mut left, Factor::solve_transposed)?;
            }
            let before = match found.odd {
                Some(_) => start.differs(found).is_none(),
                None => value * first > R::zero(),
            };
            nearer = usize::from(!before);
            ends[nearer].0.copy_from_slice(&self.u);
            ends[nearer].1 = load;
            if before {
                (low, first, last) = (at, value, last * R::lit(0.5));
            } else {
                (high, last, first) = (at, value, first * R::lit(0.5));
            }
            let gap = high - low;
            if gap.value() < 0.1 && self.apart(&ends) > R::lit(10.0) * gap * step {
                let reason = "it jumped to another one";
                return Err(Error::OffPath { reason });
            }
            if gap.value() <= accuracy || value.is_zero() {
                break;
            }
        }
        let (displacement, factor) = ends[nearer].clone();
        let mut state = self.state.clone();
        state.displacement = displacement;
        let kind = match self.structure.symmetric() {
            true => self.kind(&state, &shape)?,
            false => self.kind(&state, &left)?,
        };
        Ok(Critical {
            kind,
            state,
            factor,
            shape: self.unit(shape),
            unstable: [start, end].map(|point| point.unstable),
        })
    }

    /// Distance of two points.
    fn apart(&self, [(a, from), (b, to)]: &[(Vec<R>, R); 2]) -> R {
        let weight = R::lit(self.settings.load_weight);
        let change = weight * (*to - *from);
        let moved = mean(self.structure, |i| (b[i] - a[i]) * (b[i] - a[i]));
        norm(moved + change * change)
    }

    /// Leaves the path at a critical point along its critical direction, by `amplitude` of it (its
    /// largest change in natural sizes; the sign chooses the side), onto the branch found there.
    ///
    /// # Errors
    /// [`Error::Unconverged`] or [`Error::OffPath`] when no other branch is near: try another amplitude; the last
    /// equilibrium is kept. [`Error::NotPositive`] for an amplitude of zero or not finite,
    /// [`Error::Length`] for a point of another structure.
    pub fn switch(&mut self, critical: &Critical<R>, amplitude: R) -> Result<()> {
        positive("amplitude to leave a path by", amplitude.abs())?;
        let size = self.u.len();
        critical.state.check(size)?;
        Error::check_length("critical direction", critical.shape.len(), size)?;
        let (structure, shape) = (self.structure, &critical.shape);
        let start = critical.state.displacement.iter().zip(shape);
        for (u, (at, shape)) in self.u.iter_mut().zip(start) {
            *u = *at + amplitude * *shape;
        }
        let mut choice = |changes: &Changes<'_, R>| {
            let part = |x: &[R]| mean(structure, |i| shape[i] * x[i]);
            Some(-(part(changes.moved) + part(changes.residual)) / part(changes.load))
        };
        self.workspace.forget();
        let equations = self.equations(critical.factor);
        let (_, factor) = self.workspace.solve_along(
            structure,
            &self.settings.newton,
            &equations,
            Some(&mut choice),
            &mut self.u,
        )?;
        self.before = Some((critical.state.displacement.clone(), critical.factor));
        self.state.displacement.copy_from_slice(&self.u);
        self.factor = factor;
        self.look()
    }

    /// What a step to the point tried prescribes.
    fn length(&self, factor: R) -> R {
        use super::path::Control::{Coordinate, Load, Plane, Sphere};
        let (u, here) = (&self.u, &self.state.displacement);
        let change = factor - self.factor;
        match self.settings.control {
            Load => change,
            Coordinate(c) => u[c] - here[c],
            Sphere | Plane => {
                let ends = [(here.clone(), self.factor), (u.clone(), factor)];
                let length = self.apart(&ends);
                if self.settings.first < 0.0 {
                    -length
                } else {
                    length
                }
            }
        }
    }

    /// Unknowns without pattern, to start the search for a critical direction.
    fn start_shape(&self) -> Vec<R> {
        let count = self.structure.unknowns().count();
        (0..count)
            .map(|k| R::lit((12.9898 * (k + 1) as f64).sin()))
            .collect()
    }

    /// The eigenvalue nearest zero of the tangent factorised last, in natural sizes, with its
    /// vector by unknowns; zero if that tangent was singular.
    fn nearest(&mut self, shape: &mut [R]) -> Result<R> {
        self.iterate(shape, Factor::solve)
    }

    /// The same by inverse iteration with a way to solve: transposed for the left vector.
    fn iterate(
        &mut self,
        shape: &mut [R],
        solve: impl Fn(&mut Factor<R>, &mut [R]) -> Result<()>,
    ) -> Result<R> {
        if !self.workspace.factored() {
            return Ok(R::zero());
        }
        let (unknowns, measure) = (self.structure.unknowns(), self.structure.measure());
        let mut value = R::zero();
        for _ in 0..10 + 2 * R::ORDER {
            let size: R = shape
                .iter()
                .zip(unknowns.free())
                .map(|(x, i)| *x * *x / (measure[*i] * measure[*i]))
                .sum();
            let scale = size.sqrt().recip();
            let mut next = shape.to_vec();
            for ((x, y), i) in shape.iter_mut().zip(&mut next).zip(unknowns.free()) {
                *x *= scale;
                *y = *x / (measure[*i] * measure[*i]);
            }
            let weighted = next.clone();
            solve(self.workspace.factor(), &mut next)?;
            // x.W.x = 1 by now.
            value = weighted
                .iter()
                .zip(&next)
                .map(|(a, b)| *a * *b)
                .sum::<R>()
                .recip();
            shape.copy_from_slice(&next);
        }
        Ok(value)
    }

    /// Whether the load does work along the critical direction (the left one of an unsymmetric
    /// tangent), so that no equilibrium goes on.
    fn kind(&self, state: &State<R>, shape: &[R]) -> Result<Criticality> {
        let (unknowns, measure) = (self.structure.unknowns(), self.structure.measure());
        let mut load = vec![R::zero(); state.displacement.len()];
        add_growing(self.structure, state.time, &state.displacement, &mut load)?;
        unknowns.reduce(&mut load);
        let [mut work, mut force, mut size] = [R::zero(); 3];
        for (x, &i) in shape.iter().zip(unknowns.free()) {
            let (q, x) = (load[i] * measure[i], *x / measure[i]);
            work += q * x;
            force += q * q;
            size += x * x;
        }
        let limit = work * work > R::lit(ACROSS * ACROSS) * force * size;
        Ok(match limit {
            true => Criticality::Limit,
            false => Criticality::Bifurcation,
        })
    }

    /// Unknowns as changes of all coordinates, the largest 1 in natural sizes.
    fn unit(&self, shape: Vec<R>) -> Vec<R> {
        let mut all = super::modes::spread(self.structure, &shape);
        let scale = super::modes::natural(self.structure, &all).recip();
        all.iter_mut().for_each(|x| *x *= scale);
        all
    }
}
