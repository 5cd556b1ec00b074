//! What nonlinear constraints make of a system: a saddle point, which needs conditions scaled to the
//! stiffness they meet, and states that may drift from what the conditions ask.

use std::collections::BTreeMap;

use super::super::joint::Course;
use super::super::tie::Holding;
use super::System;
use crate::error::{Error, Result, finite};
use crate::scalar::Real;
use crate::solver::{
    Condition, Factor, Matrix, Rate, State, Structure, Unknowns, dependent, each_gradient,
};

/// Times (s) at which moving conditions that seem implied by others are examined.
const TIMES: [f64; 3] = [0.0, 0.37, 1.9];

/// Share of its size that a condition may leave where those hold that imply it, and its derivative
/// where theirs are taken out: what frames, given to so many digits, leave.
fn implied<R: Real>() -> R {
    R::lit(4.0 * R::EPSILON.sqrt())
}

/// The derivatives of every condition of a constraint by all coordinates, by multiplier.
fn rows<R: Real>(constraint: &dyn Holding<R>, time: R, u: &[R]) -> BTreeMap<usize, Vec<R>> {
    let mut rows: BTreeMap<usize, Vec<R>> = BTreeMap::new();
    constraint.gradient(time, &[u], &mut |multiplier, i, slope| {
        let row = rows.entry(multiplier);
        row.or_insert_with(|| vec![R::zero(); u.len()])[i] += slope;
    });
    rows
}

/// The multipliers of conditions whose derivatives at the reference state follow from those of
/// supports, joints and the conditions before them, each with the size of its condition: they are
/// not solved for. Two bodies welded to each other need the rigidity of one only.
pub(super) fn redundant<R: Real>(
    unknowns: &Unknowns<R>,
    courses: &[Course<R>],
    measure: &[R],
    constraints: &[Box<dyn Holding<R>>],
) -> Result<Vec<(usize, R)>> {
    let mut u = vec![R::zero(); measure.len()];
    unknowns.impose(&mut u, |k| courses[k].at(R::zero(), Rate::Displacement))?;
    let (mut sizes, mut conditions) = (Vec::new(), Vec::new());
    for constraint in constraints {
        for (multiplier, mut row) in rows(constraint.as_ref(), R::zero(), &u) {
            let parts = row.iter().zip(measure).map(|(slope, unit)| *slope * *unit);
            let size: R = parts.map(|part| part.abs()).sum();
            sizes.push((multiplier, finite("derivative of a constraint", size)?));
            unknowns.reduce(&mut row);
            let bound = row.iter().zip(measure).enumerate();
            let bound = bound.filter(|(_, (slope, _))| R::ORDER > 0 || !slope.is_zero());
            conditions.push(Condition {
                terms: match size.is_zero() {
                    true => Vec::new(),
                    false => bound
                        .map(|(i, (slope, unit))| (i, *slope * *unit / size))
                        .collect(),
                },
                known: Vec::new(),
            });
        }
    }
    let dropped = dependent(measure.len(), conditions, implied())?;
    Ok(dropped.into_iter().map(|n| sizes[n]).collect())
}

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
            body.elastic().tangent(&u, None, &mut matrix, None)?;
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
            for (multiplier, mut row) in rows(constraint.as_ref(), R::zero(), &u) {
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
                if !self.unknowns.free().contains(&multiplier) {
                    // The condition is implied by others and pushes nothing.
                    scales.push(R::zero());
                    continue;
                }
                let give = finite("derivative of a constraint", give)?;
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

    /// Makes sure that conditions that seem implied at the reference state (each with its size
    /// there) hold wherever the others do: near the reference state, at places without pattern that
    /// are brought onto the others. What only seems implied is a singular position of a mechanism,
    /// what does not hold contradicts the others.
    pub(super) fn confirm(&self, redundant: &[(usize, R)]) -> Result<()> {
        let Some((first, _)) = redundant.first() else {
            return Ok(());
        };
        let name = |i, left: R| Error::Redundant {
            constraint: self.name(i),
            pivot: left.value(),
        };
        let times: &[f64] = if self.is_driven() {
            &TIMES
        } else {
            &TIMES[..1]
        };
        let mut left = vec![R::zero(); self.multipliers().len()];
        let start = self.multipliers().start;
        for time in times.iter().map(|time| R::lit(*time)) {
            let mut departures = [0.1, 0.02, 0.004, 0.0].into_iter();
            let u = loop {
                let Some(departure) = departures.next() else {
                    return Err(name(*first, R::zero()));
                };
                if let Some(u) = self.nearby(time, R::lit(departure))? {
                    break u;
                }
            };
            for constraint in &self.constraints {
                constraint.violation(time, &[&u], &mut |i, value, _| left[i - start] = value);
            }
            for (i, size) in redundant {
                let left = left[i - start];
                if !left.finite() || left.abs() > *size * implied::<R>() {
                    return Err(name(*i, left));
                }
            }
        }
        Ok(())
    }

    /// Displacements without pattern of a size relative to the structure's, brought onto the
    /// constraints by Newton's method; none where that fails.
    fn nearby(&self, time: R, departure: R) -> Result<Option<Vec<R>>> {
        let multipliers = self.multipliers();
        let mut u = vec![R::zero(); self.reference.len()];
        for (i, u) in u[..multipliers.start].iter_mut().enumerate() {
            *u = departure * self.measure[i] * R::lit((1.0 + 7.0 * i as f64).sin());
        }
        let mut matrix = Matrix::zero(&self.unknowns, true);
        let mut factor = Factor::new(self.unknowns.profile(), true);
        let free = self.unknowns.free();
        let mut change = vec![R::zero(); u.len()];
        let mut unknown = vec![R::zero(); free.len()];
        for _ in 0..30 {
            self.impose(time, Rate::Displacement, &mut u)?;
            matrix.clear();
            for i in free.iter().filter(|i| !multipliers.contains(i)) {
                matrix.add(*i, *i, (self.measure[*i] * self.measure[*i]).recip())?;
            }
            each_gradient(self, time, &[&u], |multiplier, i, slope| {
                matrix.add(multiplier, i, slope)?;
                matrix.add(i, multiplier, slope)
            })?;
            if factor.factor(matrix.stored()).is_err() {
                return Ok(None);
            }
            self.violation(time, &[&u], &mut change);
            for (q, i) in unknown.iter_mut().zip(free) {
                *q = if multipliers.contains(i) {
                    -change[*i]
                } else {
                    R::zero()
                };
            }
            factor.solve(&mut unknown)?;
            let mut largest = R::zero();
            for (q, i) in unknown
                .iter()
                .zip(free)
                .filter(|(_, i)| !multipliers.contains(i))
            {
                u[*i] += *q;
                largest = largest.larger((*q / self.measure[*i]).abs());
            }
            if !largest.finite() {
                return Ok(None);
            }
            if largest <= R::lit(1e3 * R::EPSILON) {
                self.impose(time, Rate::Displacement, &mut u)?;
                return Ok(Some(u));
            }
        }
        Ok(None)
    }

    /// How far a state is from what its nonlinear constraints ask.
    ///
    /// # Errors
    /// When the state is of another system's size.
    pub fn drift(&self, state: &State<R>) -> Result<Drift<R>> {
        self.check_size(state)?;
        let motion = [
            &state.displacement[..],
            &state.velocity,
            &state.acceleration,
        ];
        let [position, velocity, acceleration] = [1, 2, 3].map(|known| {
            let mut largest = R::zero();
            for constraint in &self.constraints {
                constraint.violation(state.time, &motion[..known], &mut |_, value, _| {
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
