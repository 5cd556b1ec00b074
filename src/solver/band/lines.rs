//! Lines of a matrix on their own: elements in lanes add to them, and threads write some of them each.

use std::ops::Range;

use super::{Profile, ahead};
use crate::error::Result;
use crate::scalar::{Lanes, MOST_LANES, Real};

/// Stretches of unknowns that go in lanes, those of all elements of a group together. Of more, most rows
/// would have no more than a number in each.
pub(in crate::solver) const STRETCHES: usize = 12;

/// Lines in a row of a [`BandMatrix`](super::BandMatrix): what one thread may write while others write
/// the rest. Those that it leaves unwritten are zero in the end.
#[derive(Debug)]
pub(in crate::solver) struct Lines<'a, R: Real> {
    pub(super) profile: &'a Profile,
    pub(super) symmetric: bool,
    pub(super) starts: &'a [usize],
    pub(super) lines: Range<usize>,
    pub(super) data: &'a mut [R],
    /// Lines from this one on are zero, whatever `data` holds.
    pub(super) written: usize,
    /// Whether lines further on are asked for. Smaller pieces are where those before are eliminated.
    pub(super) fetching: bool,
    /// What the matrix knows of that, if these are no part of others.
    pub(super) whole: Option<&'a mut usize>,
}

impl<R: Real> Lines<'_, R> {
    pub(in crate::solver) fn is_symmetric(&self) -> bool {
        self.symmetric
    }

    /// Those before and from one of them on.
    pub(in crate::solver) fn halves(&mut self, line: usize) -> (Lines<'_, R>, Lines<'_, R>) {
        let Range { start, end } = self.lines;
        let written = self.written;
        self.written = written.max(end);
        let (left, right) = self
            .data
            .split_at_mut(self.starts[line] - self.starts[start]);
        let part = |lines, data, written| Lines {
            profile: self.profile,
            symmetric: self.symmetric,
            starts: self.starts,
            lines,
            data,
            written,
            fetching: self.fetching,
            whole: None,
        };
        (
            part(start..line, left, written),
            part(line..end, right, written.max(line)),
        )
    }

    /// Has all lines up to this one written.
    #[inline(always)]
    pub(super) fn write_up_to(&mut self, line: usize) {
        if line >= self.written {
            let start = self.starts[self.lines.start];
            let fresh = self.starts[self.written] - start..self.starts[line + 1] - start;
            if self.fetching {
                let soon = fresh.end + ahead::BYTES / size_of::<R>();
                if let Some(soon) = self.data.get(soon..soon + fresh.len()) {
                    ahead::fetch(soon);
                }
            }
            self.data[fresh].fill(R::zero());
            self.written = line + 1;
        }
    }

    /// Adds the matrices of the elements in the lanes that have a start, the first of `n` unknowns
    /// numbered consecutively: the entries of `block`, row-major and full.
    #[inline(always)]
    pub(in crate::solver) fn add_blocks<L: Lanes<R>>(
        &mut self,
        n: usize,
        block: &[L],
        start: impl Fn(usize) -> Option<usize>,
    ) -> Result<()> {
        // Where the lines of each element start.
        let mut starts: [&[usize]; MOST_LANES] = [&[]; MOST_LANES];
        for lane in 0..L::WIDTH {
            let Some(column) = start(lane) else { continue };
            let row = column + n - 1;
            self.profile.check_holds(row, column)?;
            // Of one element at a time, fresh lines are overwritten below.
            self.write_up_to(if L::WIDTH == 1 { column } else { row });
            starts[lane] = &self.starts[column..column + n];
        }
        let first = self.starts[self.lines.start];
        for i in 0..n {
            // Rows of lanes from behind: of two elements that meet the first adds first.
            let i = if L::WIDTH == 1 { i } else { n - 1 - i };
            // Stored by columns from the diagonal on, or by rows in which the block starts before it.
            let (from, before) = match self.symmetric {
                true => (i, 0),
                false => (0, self.profile.half_bandwidth() - i),
            };
            let row = &block[i * n + from..(i + 1) * n];
            if let (1, Some(start)) = (L::WIDTH, starts[0].get(i))
                && *start == self.starts[self.written]
            {
                let line = *start - first..self.starts[self.written + 1] - first;
                self.written += 1;
                let (before, own) = self.data[line].split_at_mut(before);
                let (own, behind) = own.split_at_mut(row.len());
                before.fill(R::zero());
                for (entry, value) in L::blocks_mut(own).iter_mut().zip(row) {
                    value.store(entry.as_mut());
                }
                behind.fill(R::zero());
                continue;
            }
            L::scatter(
                row,
                self.data,
                #[inline(always)]
                |lane| Some(starts[lane].get(i)? - first + before),
            );
        }
        Ok(())
    }

    /// The same of elements of which not all `n` coordinates are unknowns, or not in a row: in every lane,
    /// those of a stretch are unknowns in a row, as `unknown(lane, i)` tells, or none of them is one.
    /// What belongs to no stretch is none in all lanes, unknowns are numbered upwards in each, and stretches
    /// are no more than [`STRETCHES`].
    #[inline(always)]
    pub(in crate::solver) fn add_stretches<L: Lanes<R>>(
        &mut self,
        n: usize,
        block: &[L],
        stretches: impl Iterator<Item = Range<usize>>,
        unknown: impl Fn(usize, usize) -> Option<usize>,
    ) -> Result<()> {
        let mut all = [const { (0..0, [None; MOST_LANES]) }; STRETCHES];
        let mut count = 0;
        for (stretch, (own, shifts)) in stretches.zip(&mut all) {
            for lane in 0..L::WIDTH {
                // Unknowns less the coordinates that they are.
                shifts[lane] = unknown(lane, stretch.start).map(|q| q.wrapping_sub(stretch.start));
            }
            *own = stretch;
            count += 1;
        }
        let all = &all[..count];
        for lane in 0..L::WIDTH {
            let mut own = all.iter().filter_map(|(stretch, shifts)| {
                let shift = shifts[lane]?;
                Some([stretch.start, stretch.end - 1].map(|i| i.wrapping_add(shift)))
            });
            let Some([first, last]) = own.next() else {
                continue;
            };
            let last = own.next_back().map_or(last, |[_, last]| last);
            self.profile.check_holds(last, first)?;
            self.write_up_to(last);
        }
        let first = self.starts[self.lines.start];
        let (symmetric, half) = (self.symmetric, self.profile.half_bandwidth());
        let before = if symmetric { 0 } else { half };
        for (k, (rows, row_shifts)) in all.iter().enumerate().rev() {
            for i in rows.clone().rev() {
                let from = if symmetric { k } else { 0 };
                for (columns, shifts) in &all[from..] {
                    let j = if symmetric {
                        i.max(columns.start)
                    } else {
                        columns.start
                    };
                    L::scatter(
                        &block[i * n + j..i * n + columns.end],
                        self.data,
                        #[inline(always)]
                        |lane| {
                            let p = row_shifts[lane]?.wrapping_add(i);
                            let q = shifts[lane]?.wrapping_add(j);
                            Some(self.starts[p] - first + before + q - p)
                        },
                    );
                }
            }
        }
        Ok(())
    }
}

impl<R: Real> Drop for Lines<'_, R> {
    fn drop(&mut self) {
        match &mut self.whole {
            Some(whole) => **whole = self.written,
            None if self.lines.is_empty() => {}
            None => self.write_up_to(self.lines.end - 1),
        }
    }
}
