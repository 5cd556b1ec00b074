//! What nonlinear constraints make of a system: a saddle point, which needs conditions scaled to the
//! stiffness they meet, and states that may drift from what the conditions ask.

use std::collections::BTreeMap;

use super::System;
use crate::error::{Error, Result, finite};
use crate::scalar::Real;
use crate::solver::{Matrix, Rate, State, Structure};

/// How far a state is from what its nonlinear constraints ask, each the largest over all of them in
/// their own units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drift<R> {
    /// Residual of the constraints.
    pub position: R,
    /// Its first derivative by time (1/s).
    pub velocity: R,
    /// Its second derivative by time (1/s^2).
    pub acceleration: R,
}

impl<R: Real, const D: usize> System<R, D> {
    /// Scales every condition by the stiffness that it meets in the reference state, and the mass
    /// beside the constraints alike, so that the saddle point is as well conditioned as the
    /// stiffness.
    pub(super) fn scale_constraints(&mut self) -> Result<()> {
        let multipliers = self.multipliers();
        if multipliers.is_empty() {
            return Ok(());
        }
        let u = vec![R::zero(); self.reference.len()];
        let mut matrix = Matrix::zero(&self.unknowns, true);
        for body in &self.bodies {
            body.elastic().tangent(&u, &mut matrix)?;
        }
        for link in &self.connectors {
            link.tangent(&u, &mut matrix)?;
        }
        let mut stiffness = matrix.diagonal();
        matrix.clear();
        self.add_mass(R::one(), &mut matrix)?;
        let mass = matrix.diagonal();
        let natural = |x: &[R]| {
            let energies = x
                .iter()
                .zip(&self.measure)
                .map(|(k, size)| *k * *size * *size);
            energies.fold(R::zero(), R::larger)
        };
        let mut typical = natural(&stiffness);
        if typical.is_zero() {
            // Rigid bodies alone: as if they moved by their own size in a second.
            typical = natural(&mass);
        }
        for (k, size) in stiffness.iter_mut().zip(&self.measure) {
            let least = typical / (*size * *size);
            if *k <= least * R::lit(1e-12) {
                *k = least;
            }
        }
        let mut scales = Vec::with_capacity(multipliers.len());
        let mut mass_factor = R::zero();
        for constraint in &self.constraints {
            let mut rows: BTreeMap<usize, Vec<R>> = BTreeMap::new();
            constraint.gradient(R::zero(), &u, &mut |multiplier, i, slope| {
                let row = rows.entry(multiplier);
                row.or_insert_with(|| vec![R::zero(); u.len()])[i] += slope;
            });
            for (multiplier, mut row) in rows {
                self.unknowns.reduce(&mut row);
                let (mut give, mut light, mut size) = (R::zero(), R::zero(), R::zero());
                for &i in self.unknowns.free() {
                    let square = row[i] * row[i];
                    give += square / stiffness[i];
                    size += row[i].abs() * self.measure[i];
                    if !mass[i].is_zero() {
                        light += square / mass[i];
                    }
                }
                let give = finite("derivative of a constraint", give)?;
                if give.is_zero() {
                    return Err(Error::Redundant {
                        constraint: self.name(multiplier),
                        pivot: 0.0,
                    });
                }
                scales.push(give.recip());
                mass_factor = mass_factor.larger(light / give);
                self.measure[multiplier] = size;
            }
        }
        let mut rest = &scales[..];
        for constraint in &mut self.constraints {
            let (own, others) = rest.split_at(constraint.count());
            constraint.scale(own);
            rest = others;
        }
        if !mass_factor.is_zero() {
            self.mass_factor = mass_factor;
        }
        Ok(())
    }

    /// How far a state is from what its nonlinear constraints ask.
    ///
    /// # Errors
    /// When the state is of another system's size.
    pub fn drift(&self, state: &State<R>) -> Result<Drift<R>> {
        self.check_size(state)?;
        let [position, velocity, acceleration] =
            [Rate::Displacement, Rate::Velocity, Rate::Acceleration].map(|rate| {
                let mut largest = R::zero();
                for constraint in &self.constraints {
                    constraint.violation(rate, state, &mut |_, value, _| {
                        largest = largest.larger(value.abs());
                    });
                }
                largest
            });
        Ok(Drift {
            position,
            velocity,
            acceleration,
        })
    }

    /// The constraint that a multiplier belongs to, in words.
    pub(super) fn name_constraint(&self, i: usize) -> String {
        let mut first = self.multipliers().start;
        for constraint in &self.constraints {
            let end = first + constraint.count();
            if (first..end).contains(&i) {
                return format!("condition {} of {}", i - first, constraint.describe());
            }
            first = end;
        }
        format!("coordinate {i}")
    }
}
