//! The system as the solvers see it: residual, tangent and mass by sums over bodies, connectors,
//! constraints and loads.

use std::ops::Range;

use super::System;
use crate::element::NodalVector;
use crate::error::{Error, Result};
use crate::scalar::{Elementwise, Real, elementwise};
use crate::scene::chain::Body;
use crate::scene::load::NodalLoad;
use crate::solver::{Matrix, Part, Rate, Ready, Secant, Structure, Unknowns, add_tangent_with};

elementwise! {
    /// Adds a multiple.
    AddTimes(factor): [x] -> [sum] {
        *sum += factor * x;
    }
}

impl<R: Real, const D: usize> System<R, D> {
    fn add_weight(&self, factor: R, q: &mut [R]) {
        if let Some(weight) = &self.weight {
            AddTimes { factor }.run([weight], [&mut q[..weight.len()]]);
        }
    }

    fn add_loads(
        &self,
        loads: &[NodalLoad<R, D>],
        time: R,
        factor: R,
        u: &[R],
        q: &mut [R],
    ) -> Result<()> {
        for load in loads {
            let amplitude = factor * load.amplitude(time)?;
            load.add(amplitude, |i| self.reference[i] + u[i], q);
        }
        Ok(())
    }

    /// Whether the forces of one long beam are all that acts between coordinates.
    fn alone(&self) -> Option<&Body<R, D>> {
        let bare = self.connectors.is_empty() && self.masses.is_empty();
        match &self.bodies[..] {
            [body] if bare && self.constraints.is_empty() => Some(body),
            _ => None,
        }
    }

    /// Internal forces of all elements, or of a part.
    fn add_elastic(&self, part: Option<&Part>, u: &[R], q: &mut [R]) {
        for body in &self.bodies {
            body.elastic().force(part, u, q);
        }
        for link in &self.connectors {
            link.force(u, q);
        }
    }

    /// The same of inertia.
    fn add_inertia(&self, part: Option<&Part>, factor: R, a: &[R], out: &mut [R]) {
        if self.mass.is_none() {
            return;
        }
        for body in &self.bodies {
            body.elastic().add_mass_times(part, factor, a, out);
        }
        for (vector, m) in &self.masses {
            for i in vector * D..(vector + 1) * D {
                out[i] += factor * *m * a[i];
            }
        }
    }

    /// Tangents of all but bodies.
    fn add_other_tangents(&self, time: R, factor: R, u: &[R], k: &mut Matrix<R>) -> Result<()> {
        for link in &self.connectors {
            link.tangent(u, k)?;
        }
        self.subtract_loads(&self.loads, time, factor, u, k)
    }

    fn subtract_loads(
        &self,
        loads: &[NodalLoad<R, D>],
        time: R,
        factor: R,
        u: &[R],
        k: &mut Matrix<R>,
    ) -> Result<()> {
        for load in loads {
            let amplitude = factor * load.amplitude(time)?;
            load.subtract_tangent(amplitude, |i| self.reference[i] + u[i], k)?;
        }
        Ok(())
    }
}

impl<R: Real, const D: usize> Structure<R> for System<R, D> {
    fn unknowns(&self) -> &Unknowns<R> {
        &self.unknowns
    }

    fn symmetric(&self) -> bool {
        self.loads.iter().all(NodalLoad::symmetric)
    }

    fn impose(&self, time: R, rate: Rate, x: &mut [R]) -> Result<()> {
        self.unknowns.impose(x, |k| self.courses[k].at(time, rate))
    }

    fn multipliers(&self) -> Range<usize> {
        let count: usize = self.constraints.iter().map(|c| c.count()).sum();
        self.reference.len() - count..self.reference.len()
    }

    fn add_holding(&self, time: R, u: &[R], q: &mut [R]) {
        for constraint in &self.constraints {
            constraint.force(time, u, q);
        }
    }

    fn add_holding_tangent(&self, time: R, u: &[R], k: &mut Matrix<R>) -> Result<()> {
        let mut constraints = self.constraints.iter();
        constraints.try_for_each(|constraint| constraint.tangent(time, u, k))
    }

    fn violation(&self, time: R, motion: &[&[R]], out: &mut [R]) {
        for constraint in &self.constraints {
            constraint.violation(time, motion, &mut |i, value, scale| out[i] = scale * value);
        }
    }

    fn gradient(&self, time: R, motion: &[&[R]], tell: &mut dyn FnMut(usize, usize, R)) {
        for constraint in &self.constraints {
            constraint.gradient(time, motion, tell);
        }
    }

    fn add_curvature(&self, time: R, factor: R, u: &[R], k: &mut Matrix<R>) -> Result<()> {
        let mut constraints = self.constraints.iter();
        constraints.try_for_each(|constraint| constraint.curvature(time, factor, u, k))
    }

    fn mass_factor(&self) -> R {
        self.mass_factor
    }

    fn measure(&self) -> &[R] {
        &self.measure
    }

    fn add_internal(&self, u: &[R], q: &mut [R]) {
        self.add_elastic(None, u, q);
    }

    fn each_part(&self, each: &mut dyn FnMut(&Part)) {
        match self.alone() {
            Some(body) => body.elastic().parts(each),
            None => each(&Part::whole(self.unknowns.coordinates())),
        }
    }

    fn add_internal_of(&self, part: &Part, u: &[R], q: &mut [R]) {
        debug_assert!(part.elements.is_none() || self.alone().is_some());
        self.add_elastic(Some(part), u, q);
    }

    fn add_mass_times_of(&self, part: &Part, factor: R, a: &[R], out: &mut [R]) {
        debug_assert!(part.elements.is_none() || self.alone().is_some());
        self.add_inertia(Some(part), factor, a, out);
    }

    fn has_following(&self) -> bool {
        self.loads.iter().any(NodalLoad::has_tangent)
    }

    fn is_steady(&self) -> bool {
        self.loads.iter().all(|load| load.amplitude.is_none())
    }

    fn add_external(&self, time: R, factor: R, u: &[R], q: &mut [R]) -> Result<()> {
        self.add_weight(factor, q);
        self.add_applied(time, factor, u, q)
    }

    fn add_permanent(&self, time: R, factor: R, u: &[R], q: &mut [R]) -> Result<()> {
        if self.permanent.weight {
            self.add_weight(factor, q);
        }
        self.add_loads(&self.loads[..self.permanent.loads], time, factor, u, q)
    }

    fn subtract_permanent_tangent(
        &self,
        time: R,
        factor: R,
        u: &[R],
        k: &mut Matrix<R>,
    ) -> Result<()> {
        self.subtract_loads(&self.loads[..self.permanent.loads], time, factor, u, k)
    }

    fn is_driven(&self) -> bool {
        !self.courses.is_empty() || self.constraints.iter().any(|c| c.moves())
    }

    fn has_applied(&self) -> bool {
        !self.loads.is_empty()
    }

    fn add_applied(&self, time: R, factor: R, u: &[R], q: &mut [R]) -> Result<()> {
        self.add_loads(&self.loads, time, factor, u, q)
    }

    fn add_tangent(&self, time: R, factor: R, u: &[R], k: &mut Matrix<R>) -> Result<()> {
        for body in &self.bodies {
            body.elastic().tangent(u, None, k, None)?;
        }
        self.add_other_tangents(time, factor, u, k)
    }

    fn add_tangent_and_mass(
        &self,
        time: R,
        factor: R,
        u: &[R],
        mass: R,
        k: &mut Matrix<R>,
    ) -> Result<()> {
        for body in &self.bodies {
            body.elastic().tangent(u, Some(mass), k, None)?;
        }
        for (vector, m) in &self.masses {
            k.add_alike(vector * D, vector * D, D, mass, &[*m])?;
        }
        self.add_other_tangents(time, factor, u, k)
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
        match self.alone().filter(|_| !self.has_following()) {
            Some(body) => body.elastic().tangent(u, mass, k, Some(ready)),
            None => add_tangent_with(self, (time, factor), u, mass, k),
        }
    }

    fn secant(&self) -> Secant {
        let strained = self.bodies.iter().all(|b| b.elastic().has_strain());
        match strained && self.connectors.is_empty() {
            true => Secant::Strain,
            false => Secant::Path,
        }
    }

    fn add_secant(&self, viscosity: R, from: &[R], to: &[R], q: &mut [R]) {
        for body in &self.bodies {
            body.elastic().secant(viscosity, from, to, q);
        }
        for link in &self.connectors {
            link.secant(from, to, q);
        }
    }

    fn add_secant_tangent(
        &self,
        (time, factor): (R, R),
        viscosity: R,
        from: &[R],
        to: &[R],
        k: &mut Matrix<R>,
    ) -> Result<()> {
        for body in &self.bodies {
            body.elastic().secant_tangent(viscosity, from, to, k)?;
        }
        for link in &self.connectors {
            link.secant_tangent(from, to, k)?;
        }
        let half = R::lit(0.5);
        for load in &self.loads {
            let amplitude = half * factor * load.amplitude(time)?;
            let e = |i| self.reference[i] + half * (from[i] + to[i]);
            load.subtract_tangent(amplitude, e, k)?;
        }
        Ok(())
    }

    fn name(&self, i: usize) -> String {
        let inside = |(_, body): &(usize, &Body<R, D>)| body.range().contains(&i);
        let Some((index, body)) = self.bodies.iter().enumerate().find(inside) else {
            return self.name_constraint(i);
        };
        let vector = (i - body.range().start) / D;
        let per_node = body.vectors().len();
        let what = match body.vectors()[vector % per_node] {
            NodalVector::Position => "the position".to_string(),
            NodalVector::Slope(a) => format!("slope {a}"),
        };
        let component = ["x", "y", "z"][(i % D).min(2)];
        format!(
            "{component} of {what} of node {} of beam {index}",
            vector / per_node
        )
    }

    fn moves_rigidly(&self, u: &[R]) -> Option<bool> {
        self.moves_rigidly(u)
    }

    /// The material triad of every fully parameterised node must keep its orientation.
    fn check(&self, u: &[R]) -> Result<()> {
        for (index, body) in self.bodies.iter().enumerate() {
            if let Some((node, ratio)) = body.inverted(&self.reference, u) {
                return Err(Error::Inverted {
                    body: index,
                    node,
                    ratio: ratio.value(),
                });
            }
        }
        Ok(())
    }

    fn has_mass(&self) -> bool {
        self.mass.is_some()
    }

    fn add_mass_times(&self, factor: R, a: &[R], out: &mut [R]) {
        self.add_inertia(None, factor, a, out);
    }

    fn add_mass(&self, factor: R, k: &mut Matrix<R>) -> Result<()> {
        let Some(mass) = &self.mass else {
            return Ok(());
        };
        for i in 0..mass.size() {
            let (first, row) = mass.row(i);
            k.add_alike(i * D, first * D, D, factor, row)?;
        }
        Ok(())
    }
}
