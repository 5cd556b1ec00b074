//! Line search: a correction that overshoots is shortened to where the forces left do little work
//! along it. What a structure that stiffens as it moves needs, and one that must pass through
//! stretched states on its way to a bent one cannot use.

use super::{Balance, Equations, Newton, Workspace};
use crate::error::Result;
use crate::scalar::Real;
use crate::solver::Structure;

/// Work along a correction, over that at its start, which is near enough to none (M. A. Crisfield,
/// *Non-linear finite element analysis of solids and structures*, vol. 1, 1991, section 9.2).
const SLACK: f64 = 0.8;
/// Lengths tried for one correction.
const TRIES: usize = 10;

impl<R: Real> Workspace<R> {
    /// Work of the forces left along the correction kept in `fixed`.
    pub(super) fn work_left<S: Structure<R> + ?Sized>(&self, structure: &S) -> R {
        let free = structure.unknowns().free().iter();
        free.map(|&i| self.scratch[i] * self.fixed[i]).sum()
    }

    /// Shortens the correction in `fixed`, which has been made in full and led to `balance`, until
    /// the forces left do not work against it by more than [`SLACK`] of the `work` they did along
    /// it before; a balance within tolerance or rounding is left as it is. Returns the balance and
    /// the share of the correction that is kept.
    pub(super) fn search<S: Structure<R> + ?Sized>(
        &mut self,
        structure: &S,
        settings: &Newton,
        equations: &Equations<'_, R>,
        (work, mut balance): (R, Balance<R>),
        u: &mut [R],
    ) -> Result<(Balance<R>, R)> {
        let mut share = R::one();
        for _ in 0..TRIES {
            let left = self.work_left(structure);
            let known = balance.residual.finite() && left.finite();
            let closed = balance.scale * R::lit(settings.residual);
            // Along a direction in which the energy grows there is nothing to find.
            let enough = work <= R::zero()
                || (known
                    && (left >= -work * R::lit(SLACK)
                        || balance.residual <= closed
                        || balance.residual
                            <= self.leftover(structure, equations, &balance, u)?));
            if enough {
                break;
            }
            let secant = match known {
                true => work / (work - left),
                false => R::lit(0.5),
            };
            let next = share * secant.larger(R::lit(0.1));
            for ((u, moved), du) in u.iter_mut().zip(&mut self.moved).zip(&self.fixed) {
                let back = (next - share) * *du;
                *u += back;
                *moved += back;
            }
            share = next;
            balance = self.balance(structure, equations, None, u)?.0;
        }
        Ok((balance, share))
    }
}
