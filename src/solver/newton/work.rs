//! Forces of what holds a structure, and the work over a step of what acts on it.

use super::Workspace;
use crate::error::Result;
use crate::scalar::Real;
use crate::solver::{State, Structure};

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

impl<R: Real> Workspace<R> {
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
        self.scratch.fill(R::zero());
        for sample in samples {
            let (time, u) = (sample.time, sample.displacement);
            structure.add_applied(time, sample.weight, u, &mut self.scratch)?;
        }
        let moved = next.displacement.iter().zip(&now.displacement);
        let work = self.scratch.iter().zip(moved);
        Ok(driven + work.map(|(q, (b, a))| *q * (*b - *a)).sum::<R>())
    }
}
