//! Numbers that begin where a line of the caches does, so that registers of them lie on one as far as
//! columns are multiples of registers, as those of spatial elements are: on two, they cost twice as much
//! to load and to store.

use std::ops::{Deref, DerefMut};

use super::ahead::LINE;
use crate::scalar::Real;

/// A vector of fixed length.
#[derive(Debug)]
pub(super) struct Aligned<R> {
    numbers: Vec<R>,
    /// How many numbers lie before the first line that begins in them.
    before: usize,
    length: usize,
}

impl<R> Aligned<R> {
    const SPARE: usize = LINE / size_of::<R>();

    pub(super) fn zero(length: usize) -> Self
    where
        R: Real,
    {
        Self::within(vec![R::zero(); length + Self::SPARE], length)
    }

    fn within(numbers: Vec<R>, length: usize) -> Self {
        // Numbers that do not divide a line may begin with one too late or never.
        let before = Some(numbers.as_ptr().align_offset(LINE)).filter(|n| *n <= Self::SPARE);
        Self {
            numbers,
            before: before.unwrap_or(0),
            length,
        }
    }
}

impl<R> Default for Aligned<R> {
    fn default() -> Self {
        Self {
            numbers: Vec::new(),
            before: 0,
            length: 0,
        }
    }
}

/// A copy may come to lie elsewhere.
impl<R: Clone> Clone for Aligned<R> {
    fn clone(&self) -> Self {
        let mut copy = Self::within(self.numbers.clone(), self.length);
        copy.clone_from_slice(self);
        copy
    }
}

impl<R> Deref for Aligned<R> {
    type Target = [R];

    #[inline(always)]
    fn deref(&self) -> &[R] {
        &self.numbers[self.before..self.before + self.length]
    }
}

impl<R> DerefMut for Aligned<R> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [R] {
        &mut self.numbers[self.before..self.before + self.length]
    }
}
