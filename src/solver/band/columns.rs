//! How the lower triangle of a symmetric matrix and its factors lie in memory: column after column, in
//! panels of columns that reach as far and are eliminated together. Registers are filled with rows of
//! a panel from its first on, so that none begins or ends within another, hence room for what they
//! hold above the diagonal and behind the last row.

use super::Profile;

/// Pivots eliminated together.
pub(super) const PANEL: usize = 4;

/// Numbers that a register of heavy work reaches at most beyond the end of a column.
pub(super) const fn overrun<R>() -> usize {
    const BYTES: usize = 32;
    match (BYTES / size_of::<R>()).checked_ilog2() {
        None => 0,
        Some(doubled) => (1 << doubled) - 1,
    }
}

/// Unknowns in a row that are eliminated together, and where their columns lie.
#[derive(Debug, Clone, Copy)]
pub(super) struct Panel {
    /// The first unknown.
    pub(super) first: usize,
    /// Rows below them that they are coupled to.
    pub(super) below: usize,
    /// Where the first column starts.
    pub(super) at: usize,
}

impl Panel {
    /// Numbers that lie between the starts of two of `count` columns, of which the first is `p`, and those
    /// of the row above the second that are in its register.
    #[inline(always)]
    fn between<R>(self, count: usize, p: usize) -> usize {
        let width = overrun::<R>() + 1;
        let above = |p: usize| p % width;
        let own = count - (p - above(p));
        // As pivots, columns are read from the panel's end on, before that from its start.
        let padded = (own + self.below).next_multiple_of(width);
        let padded = padded.max(own + self.below.next_multiple_of(width));
        padded - above(p) + above((p + 1) % count)
    }

    /// Where each of its `P` columns starts.
    #[inline(always)]
    pub(super) fn starts<R, const P: usize>(self) -> [usize; P] {
        let mut starts = [self.at; P];
        for p in 1..P {
            starts[p] = starts[p - 1] + self.between::<R>(P, p - 1);
        }
        starts
    }
}

/// The panels of a lower triangle, and behind them where the last column ends.
pub(super) fn panels<R>(profile: &Profile) -> Vec<Panel> {
    let reach = profile.reach();
    let (mut panels, mut first, mut at) = (Vec::new(), 0, 0);
    while let Some(last) = reach.get(first) {
        let alike = |count: &usize| reach.get(first + count - 1) == Some(last);
        let count = [PANEL, 2].into_iter().find(alike).unwrap_or(1);
        let below = last + 1 - (first + count);
        let panel = Panel { first, below, at };
        panels.push(panel);
        at += (0..count)
            .map(|p| panel.between::<R>(count, p))
            .sum::<usize>();
        first += count;
    }
    let below = 0;
    panels.push(Panel { first, below, at });
    panels.shrink_to_fit();
    panels
}

/// Where the columns of panels start, at the diagonal, and where the last ends.
pub(super) fn column_starts<R>(panels: &[Panel]) -> Vec<usize> {
    let mut starts = Vec::with_capacity(panels[panels.len() - 1].first + 1);
    for pair in panels.windows(2) {
        let count = pair[1].first - pair[0].first;
        let mut start = pair[0].at;
        for p in 0..count {
            starts.push(start);
            start += pair[0].between::<R>(count, p);
        }
    }
    starts.push(panels[panels.len() - 1].at);
    starts
}
