//! The ways through factors: forward, elimination from a right-hand side, and back, which finds the
//! unknowns from the last to the first.

use super::super::ahead;
use super::super::blocks::{SUMS, first_blocks, first_blocks_mut, products};
use super::super::columns::{PANEL, Panel, overrun};
use super::Ldlt;
use crate::scalar::{LaneWork, Lanes, Real};
use crate::tensor::array;

impl<R: Real> Ldlt<R> {
    /// Eliminates `P` unknowns from the right-hand side and divides them by their pivots.
    #[inline(always)]
    pub(super) fn forward<L: Lanes<R>, const P: usize>(&self, panel: Panel, x: &mut [R]) {
        let (j, below) = (panel.first, panel.below);
        let (own, columns) = self.columns_of::<P>(panel);
        let mut known = [R::zero(); P];
        for p in 0..P {
            known[p] = x[j + p];
            for q in 0..p {
                known[p] -= own[q][p - q] * known[q];
            }
        }
        let mut minus = [L::zero(); P];
        for p in 0..P {
            minus[p] = L::lift(-known[p]);
        }
        let count = below.div_ceil(L::WIDTH);
        let rest = first_blocks_mut::<R, L>(&mut x[j + P..], count);
        let mut blocks: [&[L::Block]; P] = [&[]; P];
        for p in 0..P {
            blocks[p] = first_blocks::<R, L>(columns[p], count);
        }
        for i in 0..count {
            let mut sum = L::load(rest[i].as_ref());
            for p in 0..P {
                sum = sum.plus_product(L::load(blocks[p][i].as_ref()), minus[p]);
            }
            sum.store(rest[i].as_mut());
        }
        for p in 0..P {
            x[j + p] = known[p] * own[p][0];
        }
    }

    /// Finds `P` unknowns from those behind them.
    #[inline(always)]
    fn backward<L: Lanes<R>, const P: usize>(&self, panel: Panel, x: &mut [R]) {
        let (j, below) = (panel.first, panel.below);
        let (own, columns) = self.columns_of::<P>(panel);
        let (x, behind) = x.split_at_mut(j + P);
        let mut parts = [[R::zero(); SUMS]; P];
        // As many columns at a time as there are registers for their sums.
        match (L::WIDTH, P) {
            (1, PANEL) => {
                for (columns, parts) in columns.chunks(2).zip(parts.chunks_mut(2)) {
                    products::<R, L, 2>(columns, behind, below, parts);
                }
            }
            _ => products::<R, L, P>(&columns, behind, below, &mut parts),
        }
        for p in (0..P).rev() {
            let sums = parts[p];
            let pairs: [R; SUMS / 2] = array(|k| sums[k] + sums[k + SUMS / 2]);
            let mut value = x[j + p] - ((pairs[0] + pairs[2]) + (pairs[1] + pairs[3]));
            for q in p + 1..P {
                value -= own[p][q - p] * x[j + q];
            }
            x[j + p] = value;
        }
    }

    /// The columns of a panel, each from its diagonal down and all as long from the first row below the
    /// panel on.
    #[inline(always)]
    fn columns_of<const P: usize>(&self, panel: Panel) -> ([&[R]; P], [&[R]; P]) {
        let starts = panel.starts::<R, P>();
        let reached = panel.below.next_multiple_of(overrun::<R>() + 1);
        let (mut own, mut columns): ([&[R]; P], [&[R]; P]) = ([&[]; P], [&[]; P]);
        for p in 0..P {
            let column = &self.columns[starts[p]..];
            let (above, rest) = column.split_at(P - p);
            (own[p], columns[p]) = (above, &rest[..reached]);
        }
        (own, columns)
    }
}

/// Solution by the factors, after elimination from the right-hand side or with it (`FORWARD`), of what is
/// not found yet down to a line: how many panels are left comes out.
pub(super) struct Solution<'a, R, const FORWARD: bool> {
    pub(super) ldlt: &'a Ldlt<R>,
    pub(super) line: usize,
    pub(super) x: &'a mut [R],
}

impl<R: Real, const FORWARD: bool> LaneWork<R> for Solution<'_, R, FORWARD> {
    type Output = usize;
    const HEAVY: bool = true;

    #[inline(always)]
    fn run<L: Lanes<R>>(self) -> usize {
        let Self { ldlt, line, x } = self;
        let panels = &ldlt.panels[..=ldlt.behind];
        let count = |k: usize| panels[k + 1].first - panels[k].first;
        let mut k = if FORWARD { 0 } else { ldlt.behind };
        while k < ldlt.behind {
            match count(k) {
                PANEL => ldlt.forward::<L, PANEL>(panels[k], x),
                2 => ldlt.forward::<L, 2>(panels[k], x),
                _ => ldlt.forward::<L, 1>(panels[k], x),
            }
            k += 1;
        }
        let far = ahead::far(&ldlt.columns);
        // Panels from `soon` on are asked for.
        let next = |soon: usize, k: usize| {
            let soon = soon.checked_sub(1)?;
            (panels[soon].first + ahead::COLUMNS > panels[k].first).then_some(soon)
        };
        let mut soon = k;
        while let Some(asked) = next(soon, k) {
            soon = asked;
        }
        while panels[k].first > line {
            k -= 1;
            while far && let Some(asked) = next(soon, k) {
                ahead::fetch(&ldlt.columns[panels[asked].at..panels[asked + 1].at]);
                soon = asked;
            }
            match count(k) {
                PANEL => ldlt.backward::<L, PANEL>(panels[k], x),
                2 => ldlt.backward::<L, 2>(panels[k], x),
                _ => ldlt.backward::<L, 1>(panels[k], x),
            }
        }
        k
    }
}
