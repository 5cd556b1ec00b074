//! Long chains in shares: by halves, and those by halves again, which the threads of a rayon pool take
//! where the feature `rayon` is on and the work is done in one. The element over a cut comes after both
//! sides, and no more than two elements meet in a sum that starts from nothing: results are the same
//! wherever a chain is cut, for any number of threads, and without them.

use std::ops::Range;

use super::Chain;
use crate::error::Result;
use crate::formulation::{ElementKernel, KernelWork};
use crate::scalar::{Lanes, Real};
use crate::solver::{Matrix, Part, Ready, Rows};

/// Elements that are not worth a thread of their own.
pub(super) const SHARE: usize = 512;

/// Elements whose tangents and factors the second cache holds.
const PIECE: usize = 64;

/// Elements of which it holds displacements, accelerations and forces, in numbers of eight bytes.
const PART: usize = 512;

/// The same in other numbers, some at least of the largest: a multiple of what registers hold.
const fn part<R>() -> usize {
    match PART * size_of::<f64>() / size_of::<R>() {
        0 => 32,
        some => some.next_multiple_of(32),
    }
}

/// What elements of a chain add, and what they add it to.
pub(super) trait Task<R: Real, const D: usize, const S: usize>: Sync {
    /// What the elements add to.
    type Out<'o>: Send;

    /// As [`KernelWork::HEAVY`].
    const HEAVY: bool = false;

    /// The parts before and from a coordinate on, which two threads may write; nothing where that
    /// cannot be.
    fn halves<'h>(
        out: &'h mut Self::Out<'_>,
        coordinate: usize,
    ) -> Option<(Self::Out<'h>, Self::Out<'h>)>;

    /// Adds what the elements give. Must be inlined, as [`KernelWork::run`].
    fn add<L: Lanes<R>, K: ElementKernel<R, D, S>>(
        &self,
        kernel: &K,
        elements: Range<usize>,
        out: &mut Self::Out<'_>,
    ) -> Result<()>;
}

/// A task for some elements of a chain that share a kernel.
struct Share<'t, 'o, T: Task<R, D, S>, R: Real, const D: usize, const S: usize> {
    task: &'t T,
    elements: Range<usize>,
    alone: bool,
    out: &'t mut T::Out<'o>,
}

impl<T, R, const D: usize, const S: usize> KernelWork<R, D, S> for Share<'_, '_, T, R, D, S>
where
    T: Task<R, D, S>,
    R: Real,
{
    type Output = Result<()>;
    const HEAVY: bool = T::HEAVY;

    #[inline(always)]
    fn is_alone(&self) -> bool {
        self.alone
    }

    #[inline(always)]
    fn run<L: Lanes<R>, K: ElementKernel<R, D, S>>(self, kernel: &K) -> Result<()> {
        self.task.add::<L, K>(kernel, self.elements, self.out)
    }
}

impl<R, Kn, const D: usize, const S: usize> Chain<R, Kn, D, S>
where
    R: Real,
    Kn: ElementKernel<R, D, S>,
{
    /// Does a task for some elements.
    pub(super) fn share<T: Task<R, D, S>>(
        &self,
        task: &T,
        elements: Range<usize>,
        out: &mut T::Out<'_>,
    ) -> Result<()> {
        if elements.len() >= 2 * SHARE {
            let middle = elements.start + elements.len() / 2 / SHARE * SHARE;
            let halves = T::halves(out, self.range(middle).start);
            let results = halves.map(|(mut left, mut right)| {
                join::<R, _>(
                    || self.share(task, elements.start..middle - 1, &mut left),
                    || self.share(task, middle..elements.end, &mut right),
                )
            });
            if let Some((left, right)) = results {
                left.and(right)?;
                return self.run(task, middle - 1..middle, out);
            }
        }
        self.run(task, elements, out)
    }

    /// Runs a task on some elements: together if one kernel is that of all, and else one by one.
    #[inline(always)]
    fn run<T: Task<R, D, S>>(
        &self,
        task: &T,
        elements: Range<usize>,
        out: &mut T::Out<'_>,
    ) -> Result<()> {
        if let [kernel] = &self.kernels[..] {
            return kernel.dispatch(Share {
                task,
                elements,
                alone: false,
                out,
            });
        }
        for n in elements {
            self.kernels[n].dispatch(Share {
                task,
                elements: n..n + 1,
                alone: true,
                out,
            })?;
        }
        Ok(())
    }

    /// Shows all elements part by part, from the last to the first, larger ones where threads share them.
    pub(super) fn each_part(&self, each: &mut dyn FnMut(&Part)) {
        let count = self.starts.len();
        let size = match threads::<R>() {
            1 => part::<R>(),
            threads => 2 * SHARE * threads,
        };
        for first in (0..count).step_by(size).rev() {
            let next = count.min(first + size);
            each(&Part {
                elements: Some(first..next),
                coordinates: self.range(first).start..self.range(next - 1).end,
                complete: first.checked_sub(1).map_or(0, |last| self.range(last).end),
            });
        }
    }

    /// Does a task that adds to a matrix for all elements: of a long chain together for those that
    /// follow each other in an envelope, and for those at supports and joints between them. Who is
    /// `ready` for complete unknowns is told of them piece by piece, larger ones where threads share
    /// them.
    pub(super) fn share_matrix<T>(
        &self,
        task: &T,
        k: &mut Matrix<R>,
        mut ready: Option<Ready<'_, R>>,
    ) -> Result<()>
    where
        T: for<'o> Task<R, D, S, Out<'o> = Sink<'o, R>>,
    {
        let count = self.starts.len();
        if count < 2 * SHARE || k.stored().is_sparse() {
            return self.share(task, 0..count, &mut Sink::Matrix(k));
        }
        let piece = match (&ready, threads::<R>()) {
            (None, _) => count,
            (Some(_), 1) => PIECE,
            (Some(_), threads) => 2 * SHARE * threads,
        };
        let mut next = 0;
        while next < count {
            let inner = |n: usize| match k.in_a_row(self.range(n).start).checked_sub(S * D) {
                Some(more) => (1 + more / self.stride()).min(count - n),
                None => 0,
            };
            let elements = match inner(next) {
                0 => next..(next..count).find(|n| inner(*n) > 0).unwrap_or(count),
                inner => next..next + inner.min(piece),
            };
            next = elements.end;
            let (first, end) = (self.range(elements.start).start, self.range(next - 1).end);
            let mut sink = match inner(elements.start) {
                0 => Sink::Matrix(k),
                _ => Sink::Rows(k.rows(first, end - first)?),
            };
            self.share(task, elements, &mut sink)?;
            drop(sink);
            if let Some(ready) = &mut ready
                && next < count
                && let Some(line) = k.place_in_order(self.range(next).start)
            {
                ready(k, line)?;
            }
        }
        Ok(())
    }
}

/// Numbers by coordinates, from one of them on.
pub(super) struct Numbers<'a, R> {
    pub(super) first: usize,
    pub(super) numbers: &'a mut [R],
}

impl<R> Numbers<'_, R> {
    pub(super) fn halves(&mut self, coordinate: usize) -> (Numbers<'_, R>, Numbers<'_, R>) {
        let (left, right) = self.numbers.split_at_mut(coordinate - self.first);
        let first = self.first;
        let part = |first, numbers| Numbers { first, numbers };
        (part(first, left), part(coordinate, right))
    }
}

/// What tangents are added to: a matrix, or rows of one.
pub(super) enum Sink<'a, R: Real> {
    Matrix(&'a mut Matrix<R>),
    Rows(Rows<'a, R>),
}

impl<R: Real> Sink<'_, R> {
    pub(super) fn halves(&mut self, coordinate: usize) -> Option<(Sink<'_, R>, Sink<'_, R>)> {
        let Self::Rows(rows) = self else { return None };
        let (left, right) = rows.halves(coordinate);
        Some((Sink::Rows(left), Sink::Rows(right)))
    }

    pub(super) fn is_symmetric(&self) -> bool {
        match self {
            Self::Matrix(k) => k.stored().is_symmetric(),
            Self::Rows(rows) => rows.is_symmetric(),
        }
    }
}

/// How many threads share the work: those of the pool that it is done in. Packs stay on theirs: whether
/// their lanes have parted is told by thread.
fn threads<R: Real>() -> usize {
    if R::LANES == 1 { pool() } else { 1 }
}

fn pool() -> usize {
    #[cfg(feature = "rayon")]
    if rayon::current_thread_index().is_some() {
        return rayon::current_num_threads();
    }
    1
}

/// Runs both, on two threads where there are.
fn join<R: Real, T: Send>(
    left: impl FnOnce() -> T + Send,
    right: impl FnOnce() -> T + Send,
) -> (T, T) {
    #[cfg(feature = "rayon")]
    if threads::<R>() > 1 {
        return rayon::join(left, right);
    }
    debug_assert_eq!(threads::<R>(), 1, "threads come with a pool");
    (left(), right())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_hold_elements_whatever_the_numbers() {
        assert_eq!(part::<f64>(), PART);
        assert_eq!(part::<f32>(), 2 * PART);
        // As dual numbers of a thousand directions are.
        assert_eq!(part::<[f64; 1001]>(), 32);
    }
}
