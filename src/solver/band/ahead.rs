//! What is asked of memory before it is needed, where a matrix is larger than the caches. Processors
//! follow long reads upwards by themselves, but not the way back through factors, and fresh lines late.
//! They wait with what they work on as soon as some ten lines are on their way, hence no more at a
//! time, between work that needs none.

use crate::scalar::prefetch;

/// Bytes of a matrix from which on it is asked for: about what second caches hold.
const CACHE: usize = 1 << 19;
/// Bytes of a line of the caches.
pub(super) const LINE: usize = 64;

/// Columns between what is read and what is asked for: memory takes as long as some elements do.
pub(super) const COLUMNS: usize = 64;
/// The same in bytes, where lines are written.
pub(super) const BYTES: usize = 1 << 13;

/// Whether numbers are more than the caches hold.
pub(super) fn far<R>(numbers: &[R]) -> bool {
    size_of_val(numbers) > CACHE
}

/// Asks for numbers, of those longer than a line for their first.
#[inline(always)]
pub(super) fn fetch<R>(numbers: &[R]) {
    let per_line = (LINE / size_of::<R>()).max(1);
    numbers.iter().step_by(per_line).for_each(prefetch);
}
