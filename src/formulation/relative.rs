//! Positions by their differences from the element's first node. A strain never sees where the
//! element is; formed from differences it is free of the rounding of numbers that large, and the
//! forces on positions balance by construction.

use super::Tangent;
use crate::element::{Element, NodalVector};
use crate::scalar::{Real, Scalar};
use crate::tensor::{difference, sum};

/// Which nodal vectors are positions. Without any, nothing is relative to anything.
#[derive(Debug, Clone, Copy)]
pub(super) struct Positions<const S: usize> {
    places: [usize; S],
    count: usize,
}

impl<const S: usize> Positions<S> {
    pub(super) const NONE: Self = Self {
        places: [0; S],
        count: 0,
    };

    pub(super) fn of<E: Element<D, S>, const D: usize>() -> Self {
        let mut all = Self::NONE;
        for i in 0..S {
            if E::VECTORS[i % E::VECTORS.len()] == NodalVector::Position {
                all.places[all.count] = i;
                all.count += 1;
            }
        }
        all
    }

    /// The first position and the others.
    #[inline(always)]
    pub(super) fn split(
        &self,
    ) -> Option<(usize, impl DoubleEndedIterator<Item = usize> + Clone + '_)> {
        // The minimum is the identity; it lets the optimiser drop the bounds checks.
        let place = |i: &usize| (*i).min(S - 1);
        let (first, others) = self.places[..self.count.min(S)].split_first()?;
        Some((place(first), others.iter().map(place)))
    }

    /// Makes all positions but the first relative to the first.
    #[inline(always)]
    pub(super) fn make_relative<T: Scalar, const D: usize>(&self, u: &mut [[T; D]; S]) {
        if let Some((first, others)) = self.split() {
            let origin = u[first];
            for p in others {
                u[p] = difference(&u[p], &origin);
            }
        }
    }

    /// Turns a row over nodal vectors into one over those with relative positions. What the entries
    /// of the positions add up to stays with the first: nothing for a complete element.
    pub(super) fn make_relative_row<R: Real>(&self, row: &mut [R; S]) {
        if let Some((first, others)) = self.split() {
            let (mut sum, mut size) = (row[first], row[first].abs());
            for p in others {
                sum += row[p];
                size += row[p].abs();
            }
            let rounding = size * R::lit(64.0 * R::EPSILON);
            let complete = sum.abs() <= rounding;
            row[first] = if complete { R::zero() } else { sum };
        }
    }

    /// Adds a force by relative vectors to one by vectors: the first position is pushed back by
    /// what pushes the others.
    #[inline(always)]
    pub(super) fn add_force<T: Scalar, const D: usize>(
        &self,
        relative: &[[T; D]; S],
        q: &mut [[T; D]; S],
    ) {
        for i in 0..S {
            q[i] = sum(&q[i], &relative[i]);
        }
        if let Some((first, others)) = self.split() {
            for p in others {
                q[first] = difference(&q[first], &relative[p]);
            }
        }
    }

    /// Turns the blocks `k[i][..][j]`, `i <= j`, of a symmetric tangent by relative vectors into those
    /// of the one by vectors.
    #[inline(always)]
    pub(super) fn finish_upper<T: Scalar, const D: usize>(&self, k: &mut Tangent<T, D, S>) {
        if let Some((first, others)) = self.split() {
            // The diagonal block loses the row of every other position as it was and its column as
            // it is then.
            for p in others.clone() {
                subtract_block(k, (first, p), (first, first));
            }
            for p in others.clone() {
                for j in 0..S {
                    if j != first {
                        subtract_block(k, (p, j), (first, j));
                    }
                }
            }
            for p in others {
                subtract_block(k, (p, first), (first, first));
            }
        }
    }

    /// Adds a tangent by relative vectors to one by vectors.
    #[inline(always)]
    pub(super) fn add_tangent<T: Scalar, const D: usize>(
        &self,
        mut relative: Tangent<T, D, S>,
        k: &mut Tangent<T, D, S>,
    ) {
        if let Some((first, others)) = self.split() {
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

/// Subtracts one block of a symmetric tangent, of which those with `i <= j` are stored, from another.
#[inline(always)]
fn subtract_block<T: Scalar, const D: usize, const S: usize>(
    k: &mut Tangent<T, D, S>,
    from: (usize, usize),
    to: (usize, usize),
) {
    for c in 0..D {
        for d in 0..D {
            let value = match from.0 <= from.1 {
                true => k[from.0][c][from.1][d],
                false => k[from.1][d][from.0][c],
            };
            match to.0 <= to.1 {
                true => k[to.0][c][to.1][d] -= value,
                false => k[to.1][d][to.0][c] -= value,
            }
        }
    }
}
