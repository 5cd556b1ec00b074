//! The triangle of pivots that are eliminated together: the one place of a factorisation where numbers
//! wait for one another, hence in registers.

use super::blocks::first;
use crate::scalar::{Field, Lanes, Real};

/// The triangle of some pivots, before and after division by them, and their reciprocals.
pub(super) struct Pivots<T, const P: usize> {
    pub(super) before: [[T; P]; P],
    pub(super) after: [[T; P]; P],
    pub(super) inverse: [T; P],
}

impl<T: Field, const P: usize> Pivots<T, P> {
    /// Of the entries of a matrix. No branches: it must stay in registers.
    #[inline(always)]
    fn eliminated(mut before: [[T; P]; P]) -> Self {
        let (mut after, mut inverse) = ([[T::zero(); P]; P], [T::zero(); P]);
        for p in 0..P {
            inverse[p] = T::one() / before[p][p];
            for i in p + 1..P {
                after[p][i] = before[p][i] * inverse[p];
            }
            for k in p + 1..P {
                for i in k..P {
                    before[k][i] -= after[p][i] * before[p][k];
                }
            }
        }
        Self {
            before,
            after,
            inverse,
        }
    }
}

impl<R: Real, const P: usize> Pivots<R, P> {
    /// Of the entries of a matrix; those of packs in their registers, for compilers take arrays of packs for
    /// strided ones.
    #[inline(always)]
    pub(super) fn of<L: Lanes<R>>(entries: [[R; P]; P]) -> Self {
        if R::LANES == 1 {
            return Self::eliminated(entries);
        }
        let mut before = [[L::zero(); P]; P];
        for p in 0..P {
            for i in p..P {
                before[p][i] = L::lift(entries[p][i]);
            }
        }
        let pivots = Pivots::eliminated(before);
        let mut all = Self {
            before: entries,
            after: entries,
            inverse: [R::zero(); P],
        };
        for p in 0..P {
            all.inverse[p] = first(pivots.inverse[p]);
            for i in p..P {
                all.before[p][i] = first(pivots.before[p][i]);
                all.after[p][i] = first(pivots.after[p][i]);
            }
        }
        all
    }
}
