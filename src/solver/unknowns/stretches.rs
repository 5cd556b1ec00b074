//! Elements at supports among those in lanes: how the coordinates of an element fall into held ones and
//! unknowns in a row.

use std::ops::Range;

use super::{Combination, Unknowns};
use crate::scalar::Real;

/// How coordinates in a row fall into stretches, of unknowns in a row and of held ones: a bit for each that
/// begins another one, and for each that is an unknown.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::solver) struct Stretches {
    pub(in crate::solver) breaks: u64,
    pub(in crate::solver) unknown: u64,
}

impl Stretches {
    /// What is one stretch in both, and what is an unknown in one of them.
    pub(in crate::solver) fn and(self, other: Self) -> Self {
        Self {
            breaks: self.breaks | other.breaks,
            unknown: self.unknown | other.unknown,
        }
    }

    /// How many stretches have unknowns.
    pub(in crate::solver) fn count(self) -> usize {
        ((self.breaks | 1) & self.unknown).count_ones() as usize
    }

    /// Those of `n` coordinates that have.
    pub(in crate::solver) fn each(self, n: usize) -> impl Iterator<Item = Range<usize>> {
        let begins = move |i: &usize| *i == 0 || self.breaks >> i & 1 == 1;
        let unknown = move |i: &usize| self.unknown >> i & 1 == 1;
        let end = move |i: usize| (i + 1..n).find(begins).unwrap_or(n);
        let first = (0..n).filter(begins).filter(unknown);
        first.map(move |i| i..end(i))
    }
}

impl<R: Real> Unknowns<R> {
    /// How `n` coordinates from `offset` on fall into stretches. Nothing if some follow others, if unknowns
    /// are not numbered upwards, or if bits do not suffice.
    #[inline(always)]
    pub(in crate::solver) fn stretches(&self, offset: usize, n: usize) -> Option<Stretches> {
        match self.run(offset, n) {
            Some(_) => Some(Stretches {
                breaks: 0,
                unknown: u64::MAX,
            }),
            None => self.several_stretches(offset, n),
        }
    }

    fn several_stretches(&self, offset: usize, n: usize) -> Option<Stretches> {
        if n > u64::BITS as usize {
            return None;
        }
        let mut all = Stretches::default();
        let (mut next, mut before) = (0, None);
        for i in 0..n {
            let own = match self.combination(offset + i) {
                Combination::Unknown(q) if q >= next => Some(q),
                Combination::Sum([]) => None,
                _ => return None,
            };
            let goes_on = own == before.map(|q| q + 1);
            all.breaks |= u64::from(i > 0 && !goes_on) << i;
            all.unknown |= u64::from(own.is_some()) << i;
            next = own.map_or(next, |q| q + 1);
            before = own;
        }
        Some(all)
    }
}
