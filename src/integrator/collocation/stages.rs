//! The stages of a step as one structure. Constraints hold in their rate at every stage, which keeps
//! the order that holding them in position would take (index two instead of three: E. Hairer, C.
//! Lubich, M. Roche, *The Numerical Solution of Differential-Algebraic Systems by Runge-Kutta
//! Methods*, 1989); position and velocity are brought onto them at the end of the step (U. M. Ascher, L. R.
//! Petzold, *Projected implicit Runge-Kutta methods for differential-algebraic equations*, SIAM J.
//! Numer. Anal. 28, 1991), without which Gauss points would lose it, too.

use std::cell::RefCell;
use std::ops::Range;

use super::tableau::{Tableau, weighted};
use crate::error::Result;
use crate::scalar::Real;
use crate::solver::{Matrix, Structure, Unknowns, each_gradient};

/// Unknowns and natural sizes of the stages.
#[derive(Debug)]
pub(super) struct Layout<R> {
    pub(super) unknowns: Unknowns<R>,
    pub(super) measure: Vec<R>,
}

impl<R: Real> Layout<R> {
    pub(super) fn new<S: Structure<R>>(structure: &S, stages: usize) -> Result<Self> {
        Ok(Self {
            unknowns: structure.unknowns().repeated(stages)?,
            measure: structure
                .measure()
                .iter()
                .flat_map(|m| std::iter::repeat_n(*m, stages))
                .collect(),
        })
    }
}

/// Vectors and a matrix of one stage.
#[derive(Debug)]
pub(super) struct Scratch<R> {
    pub(super) u: Vec<R>,
    pub(super) q: Vec<R>,
    pub(super) v: Vec<R>,
    pub(super) matrix: Matrix<R>,
}

impl<R: Real> Scratch<R> {
    /// Takes stage `i` out of the vector of all and clears the forces.
    pub(super) fn stage(&mut self, all: &[R], i: usize, stages: usize) {
        let own = all.iter().skip(i).step_by(stages);
        for (u, value) in self.u.iter_mut().zip(own) {
            *u = *value;
        }
        self.q.fill(R::zero());
    }

    /// Adds the forces of stage `i` to those of all.
    pub(super) fn give(&self, all: &mut [R], i: usize, stages: usize) {
        let own = all.iter_mut().skip(i).step_by(stages);
        for (sum, q) in own.zip(&self.q) {
            *sum += *q;
        }
    }

    /// Puts stage `i` back into the vector of all.
    pub(super) fn put(&self, all: &mut [R], i: usize, stages: usize) {
        let own = all.iter_mut().skip(i).step_by(stages);
        for (value, u) in own.zip(&self.u) {
            *value = *u;
        }
    }

    /// Shows every entry of the matrix, by unknowns.
    pub(super) fn entries(
        &self,
        mut show: impl FnMut(usize, usize, R) -> Result<()>,
    ) -> Result<()> {
        let matrix = self.matrix.stored();
        let profile = matrix.profile();
        for (i, (first, reach)) in profile.first().iter().zip(profile.reach()).enumerate() {
            for j in *first..=*reach {
                show(i, j, matrix.get(i, j))?;
            }
        }
        Ok(())
    }
}

/// The stages of a step as one structure.
pub(super) struct Stages<'a, R, S> {
    pub(super) structure: &'a S,
    pub(super) tableau: &'a Tableau<R>,
    pub(super) layout: &'a Layout<R>,
    pub(super) step: R,
    /// Displacements at the start of the step.
    pub(super) from: &'a [R],
    pub(super) scratch: RefCell<&'a mut Scratch<R>>,
}

impl<R: Real, S: Structure<R>> Stages<'_, R, S> {
    fn count(&self) -> usize {
        self.tableau.at.len()
    }

    /// Takes stage `i` and its velocity out of the displacements of all.
    fn moving(&self, scratch: &mut Scratch<R>, all: &[R], i: usize) {
        scratch.stage(all, i, self.count());
        let stages = all.chunks_exact(self.count());
        for ((v, stages), from) in scratch.v.iter_mut().zip(stages).zip(self.from) {
            let moved = |(rate, u): (&R, &R)| *rate * (*u - *from);
            let sum: R = self.tableau.rate[i].iter().zip(stages).map(moved).sum();
            *v = sum / self.step;
        }
    }
}

impl<R: Real, S: Structure<R>> Structure<R> for Stages<'_, R, S> {
    fn unknowns(&self) -> &Unknowns<R> {
        &self.layout.unknowns
    }
    fn symmetric(&self) -> bool {
        false
    }
    fn measure(&self) -> &[R] {
        &self.layout.measure
    }
    fn multipliers(&self) -> Range<usize> {
        let own = self.structure.multipliers();
        own.start * self.count()..own.end * self.count()
    }
    fn add_holding(&self, time: R, u: &[R], q: &mut [R]) {
        let multipliers = self.structure.multipliers();
        if multipliers.is_empty() {
            return;
        }
        let mut scratch = self.scratch.borrow_mut();
        for (i, at) in self.tableau.at.iter().enumerate() {
            self.moving(&mut scratch, u, i);
            let Scratch { u, v, q: own, .. } = &mut **scratch;
            let time = time + self.step * *at;
            self.structure.violation(time, &[u, v], own);
            for residual in &mut own[multipliers.clone()] {
                *residual *= self.step;
            }
            self.structure
                .gradient(time, &[u], &mut |multiplier, k, slope| {
                    own[k] += u[multiplier] * slope;
                });
            scratch.give(q, i, self.count());
        }
    }
    fn add_holding_tangent(&self, time: R, u: &[R], k: &mut Matrix<R>) -> Result<()> {
        if self.structure.multipliers().is_empty() {
            return Ok(());
        }
        let mut scratch = self.scratch.borrow_mut();
        let count = self.count();
        for (i, at) in self.tableau.at.iter().enumerate() {
            self.moving(&mut scratch, u, i);
            let Scratch { u, v, matrix, .. } = &mut **scratch;
            let time = time + self.step * *at;
            matrix.clear();
            self.structure.add_curvature(time, R::one(), u, matrix)?;
            each_gradient(self.structure, time, &[u], |multiplier, a, slope| {
                for (j, rate) in self.tableau.rate[i].iter().enumerate() {
                    k.add(multiplier * count + i, a * count + j, *rate * slope)?;
                }
                k.add(a * count + i, multiplier * count + i, slope)
            })?;
            each_gradient(self.structure, time, &[u, v], |multiplier, a, bend| {
                let (row, column) = (multiplier * count + i, a * count + i);
                k.add(row, column, self.step * bend)
            })?;
            let k = k.stored_mut();
            scratch.entries(|a, b, value| k.add(a * count + i, b * count + i, value))?;
        }
        Ok(())
    }
    fn add_internal(&self, u: &[R], q: &mut [R]) {
        let mut scratch = self.scratch.borrow_mut();
        for i in 0..self.count() {
            scratch.stage(u, i, self.count());
            let Scratch { u, q: own, .. } = &mut **scratch;
            self.structure.add_internal(u, own);
            scratch.give(q, i, self.count());
        }
    }
    fn has_following(&self) -> bool {
        self.structure.has_following()
    }
    fn is_steady(&self) -> bool {
        self.structure.is_steady()
    }
    fn add_external(&self, time: R, factor: R, u: &[R], q: &mut [R]) -> Result<()> {
        let mut scratch = self.scratch.borrow_mut();
        for (i, at) in self.tableau.at.iter().enumerate() {
            scratch.stage(u, i, self.count());
            let Scratch { u, q: own, .. } = &mut **scratch;
            let time = time + self.step * *at;
            self.structure.add_external(time, factor, u, own)?;
            scratch.give(q, i, self.count());
        }
        Ok(())
    }
    fn add_tangent(&self, time: R, factor: R, u: &[R], k: &mut Matrix<R>) -> Result<()> {
        let mut scratch = self.scratch.borrow_mut();
        let count = self.count();
        for (i, at) in self.tableau.at.iter().enumerate() {
            scratch.stage(u, i, count);
            let Scratch { u, matrix, .. } = &mut **scratch;
            matrix.clear();
            let time = time + self.step * *at;
            self.structure.add_tangent(time, factor, u, matrix)?;
            let k = k.stored_mut();
            scratch.entries(|a, b, value| k.add(a * count + i, b * count + i, value))?;
        }
        Ok(())
    }
    fn name(&self, i: usize) -> String {
        self.structure.name(i / self.count())
    }
    fn check(&self, u: &[R]) -> Result<()> {
        let mut scratch = self.scratch.borrow_mut();
        for i in 0..self.count() {
            scratch.stage(u, i, self.count());
            self.structure.check(&scratch.u)?;
        }
        Ok(())
    }
    fn has_mass(&self) -> bool {
        self.structure.has_mass()
    }
    /// `M (A^2)^-1`: takes displacements of the stages, per square of the step, to inertia forces.
    fn add_mass_times(&self, factor: R, x: &[R], out: &mut [R]) {
        let mut scratch = self.scratch.borrow_mut();
        for (i, inverse) in self.tableau.inverse.iter().enumerate() {
            scratch.stage(x, i, self.count());
            let Scratch { u, q, .. } = &mut **scratch;
            for (u, all) in u.iter_mut().zip(x.chunks_exact(self.count())) {
                *u = weighted(inverse, all);
            }
            self.structure.add_mass_times(factor, u, q);
            scratch.give(out, i, self.count());
        }
    }
    fn add_mass(&self, factor: R, k: &mut Matrix<R>) -> Result<()> {
        let mut scratch = self.scratch.borrow_mut();
        let count = self.count();
        scratch.matrix.clear();
        self.structure.add_mass(factor, &mut scratch.matrix)?;
        let k = k.stored_mut();
        scratch.entries(|a, b, value| {
            for (i, row) in self.tableau.inverse.iter().enumerate() {
                for (j, inverse) in row.iter().enumerate() {
                    k.add(a * count + i, b * count + j, value * *inverse)?;
                }
            }
            Ok(())
        })
    }
}
