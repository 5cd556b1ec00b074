//! How the lower triangle of a symmetric matrix and its factors lie in memory: column after column, in
//! panels of columns that reach as far and are eliminated together. Registers are filled with rows of
//! a panel from its first on, so that none begins or ends within another, hence room for what they
//! hold above the diagonal and behind the last row.

use super::Profile;

/// Pivots eliminated together.
pub(super) const PANEL: usize = 4;

/// How many unknowns of equal `reach` go together with each one.
pub(super) fn counts(reach: &[usize]) -> Vec<u8> {
    let mut counts = vec![1; reach.len()];
    let mut j = 0;
    while j < reach.len() {
        let alike = |count: usize| reach.get(j + count - 1) == Some(&reach[j]);
        let count = [PANEL, 2]
            .into_iter()
            .find(|count| alike(*count))
            .unwrap_or(1);
        counts[j..j + count].fill(count as u8);
        j += count;
    }
    counts
}

/// Numbers that a register of heavy work reaches at most beyond the end of a column.
pub(super) const fn overrun<R>() -> usize {
    const BYTES: usize = 32;
    match (BYTES / size_of::<R>()).checked_ilog2() {
        None => 0,
        Some(doubled) => (1 << doubled) - 1,
    }
}

/// Where the columns of a lower triangle start, at the diagonal, and where the last ends.
pub(super) fn column_starts<R>(profile: &Profile) -> Vec<usize> {
    let (reach, width) = (profile.reach(), overrun::<R>() + 1);
    let counts = counts(reach);
    let mut starts = Vec::with_capacity(reach.len() + 1);
    let (mut j, mut end) = (0, 0);
    while let Some(last) = reach.get(j) {
        let count = usize::from(counts[j]);
        let below = last + 1 - (j + count);
        for p in 0..count {
            // Rows above the diagonal in its register.
            let above = p % width;
            starts.push(end + above);
            let own = count - (p - above);
            // As pivots, columns are read from the panel's end on, before that from its start.
            let padded = (own + below).next_multiple_of(width);
            end += padded.max(own + below.next_multiple_of(width));
        }
        j += count;
    }
    starts.push(end);
    starts
}
