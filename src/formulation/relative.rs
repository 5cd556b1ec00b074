//! Positions by their differences from the element's first node. A strain never sees where the
//! element is; formed from differences it is free of the rounding of numbers that large, and the
//! forces on positions balance by construction.

use super::Tangent;
use crate::element::{Element, NodalVector};
use crate::scalar::Scalar;

/// Which nodal vectors are positions. Without any, nothing is relative to anything.
#[derive(Debug, Clone, Default)]
pub(super) struct Positions {
    places: Vec<usize>,
}

impl Positions {
    pub(super) fn of<E: Element<D, S>, const D: usize, const S: usize>() -> Self {
        let position = |i: &usize| E::VECTORS[i % E::VECTORS.len()] == NodalVector::Position;
        let places = (0..S).filter(position).collect();
        Self { places }
    }

    /// The first position and the others.
    #[inline(always)]
    pub(super) fn split<const S: usize>(
        &self,
    ) -> Option<(usize, impl DoubleEndedIterator<Item = usize> + '_)> {
        let (first, others) = self.places.split_first()?;
        // The remainder is the identity; it lets the optimiser drop the bounds checks.
        Some((first % S, others.iter().map(|p| p % S)))
    }

    /// Makes all positions but the first relative to the first.
    #[inline(always)]
    pub(super) fn make_relative<T: Scalar, const D: usize, const S: usize>(
        &self,
        u: &mut [[T; D]; S],
    ) {
        if let Some((first, others)) = self.split::<S>() {
            for p in others {
                for c in 0..D {
                    let origin = u[first][c];
                    u[p][c] -= origin;
                }
            }
        }
    }

    /// Adds a force by relative vectors to one by vectors: the first position is pushed back by
    /// what pushes the others.
    #[inline(always)]
    pub(super) fn add_force<T: Scalar, const D: usize, const S: usize>(
        &self,
        mut relative: [[T; D]; S],
        q: &mut [[T; D]; S],
    ) {
        if let Some((first, others)) = self.split::<S>() {
            for p in others {
                for c in 0..D {
                    let force = relative[p][c];
                    relative[first][c] -= force;
                }
            }
        }
        for (q, force) in q.as_flattened_mut().iter_mut().zip(relative.as_flattened()) {
            *q += *force;
        }
    }

    /// The same for the tangent.
    #[inline(always)]
    pub(super) fn add_tangent<T: Scalar, const D: usize, const S: usize>(
        &self,
        mut relative: Tangent<T, D, S>,
        k: &mut Tangent<T, D, S>,
    ) {
        if let Some((first, others)) = self.split::<S>() {
            for p in others {
                for row in relative.as_flattened_mut() {
                    for d in 0..D {
                        let stiffness = row[p][d];
                        row[first][d] -= stiffness;
                    }
                }
                let rows = relative[p];
                let opposite = relative[first].as_flattened_mut().as_flattened_mut();
                for (k, stiffness) in opposite.iter_mut().zip(rows.as_flattened().as_flattened()) {
                    *k -= *stiffness;
                }
            }
        }
        let k = k.as_flattened_mut().as_flattened_mut().as_flattened_mut();
        let relative = relative.as_flattened().as_flattened().as_flattened();
        for (k, stiffness) in k.iter_mut().zip(relative) {
            *k += *stiffness;
        }
    }
}
