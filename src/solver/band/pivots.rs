//! The triangle of pivots that are eliminated together: the one place of a factorisation where numbers
//! wait for one another, hence in registers, every number in all lanes of one: compilers would shuffle
//! single numbers about.

use crate::scalar::Field;

/// The triangle of some pivots, before and after division by them, and their reciprocals.
pub(super) struct Pivots<T, const P: usize> {
    pub(super) before: [[T; P]; P],
    pub(super) after: [[T; P]; P],
    pub(super) inverse: [T; P],
}

impl<T: Field, const P: usize> Pivots<T, P> {
    /// Of the entries of a matrix. No branches: it must stay in registers.
    #[inline(always)]
    pub(super) fn of(mut before: [[T; P]; P]) -> Self {
        let (mut after, mut inverse) = ([[T::zero(); P]; P], [T::zero(); P]);
        for p in 0..P {
            inverse[p] = T::one() / before[p][p];
            for i in p + 1..P {
                after[p][i] = before[p][i] * inverse[p];
            }
            for k in p + 1..P {
                let minus = -before[p][k];
                for i in k..P {
                    before[k][i] = before[k][i].plus_product(after[p][i], minus);
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
