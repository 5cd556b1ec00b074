//! Which blocks of a sparse symmetric matrix and of its factor may be non-zero, found once.

use std::collections::BTreeSet;
use std::ops::Range;

/// One group of unknowns in the order of elimination, with the panel of rows that its columns
/// fill.
#[derive(Debug)]
pub(super) struct Column {
    /// Its unknowns.
    pub(super) unknowns: Range<usize>,
    /// Later groups whose rows are in the panel, and the first row of each in it.
    pub(super) below: Vec<(usize, usize)>,
    /// Rows of the panel, those of the group itself first.
    pub(super) height: usize,
    /// Where the panel starts in the values; its rows are as long as the group.
    pub(super) start: usize,
    /// Where the values start that each pair of groups below updates, row by row of the triangle.
    pub(super) targets: Vec<usize>,
}

impl Column {
    pub(super) fn width(&self) -> usize {
        self.unknowns.len()
    }
}

/// Pattern of a factor by groups of unknowns, in the order of elimination.
#[derive(Debug)]
pub(crate) struct Pattern {
    pub(super) columns: Vec<Column>,
    /// Group of each unknown.
    pub(super) group: Vec<usize>,
    /// Number of values.
    pub(super) values: usize,
}

impl Pattern {
    /// Groups given by their unknowns in the order of elimination, and sets of groups that couple
    /// with each other.
    pub(crate) fn new(
        groups: Vec<Range<usize>>,
        cliques: impl IntoIterator<Item = Vec<usize>>,
    ) -> Self {
        let mut rows = vec![BTreeSet::new(); groups.len()];
        for clique in cliques {
            for (k, g) in clique.iter().enumerate() {
                rows[*g].extend(clique[k + 1..].iter().copied());
            }
        }
        for g in 0..groups.len() {
            // What a group fills, the first group of it inherits.
            let mut below = rows[g].iter().copied();
            if let Some(parent) = below.next() {
                let rest: Vec<usize> = below.collect();
                rows[parent].extend(rest);
            }
        }
        let mut group = vec![0; groups.iter().map(Range::len).sum()];
        let mut columns = Vec::with_capacity(groups.len());
        let mut values = 0;
        for (g, (unknowns, rows)) in groups.iter().zip(&rows).enumerate() {
            group[unknowns.clone()].fill(g);
            let mut height = unknowns.len();
            let mut below = Vec::with_capacity(rows.len());
            for row in rows {
                below.push((*row, height));
                height += groups[*row].len();
            }
            columns.push(Column {
                unknowns: unknowns.clone(),
                below,
                height,
                start: values,
                targets: Vec::new(),
            });
            values += height * unknowns.len();
        }
        let mut pattern = Self {
            columns,
            group,
            values,
        };
        for g in 0..groups.len() {
            let below = &pattern.columns[g].below;
            let mut targets = Vec::with_capacity(below.len() * (below.len() + 1) / 2);
            for (a, (row, _)) in below.iter().enumerate() {
                // The first group below inherited the others: every pair has its place.
                targets.extend(
                    below[..=a]
                        .iter()
                        .filter_map(|(c, _)| pattern.block(*row, *c)),
                );
            }
            pattern.columns[g].targets = targets;
        }
        pattern
    }

    /// Where the block of the groups `row >= column` starts.
    pub(super) fn block(&self, row: usize, column: usize) -> Option<usize> {
        let panel = &self.columns[column];
        let first = match row == column {
            true => 0,
            false => {
                let at = panel.below.binary_search_by_key(&row, |(g, _)| *g).ok()?;
                panel.below[at].1
            }
        };
        Some(panel.start + first * panel.width())
    }

    /// Number of unknowns.
    pub(super) fn size(&self) -> usize {
        self.group.len()
    }

    /// Multiplications of a factorisation.
    pub(crate) fn cost(&self) -> f64 {
        let cost = |column: &Column| {
            let (w, h) = (column.width() as f64, column.height as f64);
            w * h * h - w * w * h + w * w * w / 3.0
        };
        self.columns.iter().map(cost).sum()
    }
}
