//! What solvers and methods remember, as plain numbers: every one of them names what it remembers
//! once, to a [`Tape`] that writes it down or reads it back, so that saving and resuming cannot
//! differ.

use std::ops::RangeInclusive;

use crate::error::{Error, Result, finite};
use crate::scalar::Real;

/// What a [`Tape`] holds: numbers of the run's type, and counts, in the order in which they were
/// named.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Record<R> {
    numbers: Vec<R>,
    counts: Vec<u64>,
}

/// Writes down what it is shown, or overwrites it by what was written down before.
///
/// ```
/// use ancf::solver::Tape;
///
/// let (mut step, mut mode) = (Some(0.1), vec![1.0, 2.0]);
/// let mut tape = Tape::write();
/// tape.option(&mut step)?;
/// tape.numbers(&mut mode)?;
/// let record = tape.end()?;
///
/// (step, mode) = (None, vec![0.0, 0.0]);
/// let mut tape = Tape::read(record);
/// tape.option(&mut step)?;
/// tape.numbers(&mut mode)?;
/// tape.end()?;
/// assert_eq!((step, mode), (Some(0.1), vec![1.0, 2.0]));
/// # Ok::<(), ancf::Error>(())
/// ```
#[derive(Debug)]
pub struct Tape<R> {
    record: Record<R>,
    /// Numbers and counts read so far; none while writing.
    read: Option<[usize; 2]>,
}

impl<R: Real> Tape<R> {
    /// A tape to write on.
    pub fn write() -> Self {
        let (numbers, counts) = (Vec::new(), Vec::new());
        Self {
            record: Record { numbers, counts },
            read: None,
        }
    }

    /// A tape to read from.
    pub fn read(record: Record<R>) -> Self {
        let read = Some([0, 0]);
        Self { record, read }
    }

    /// A number.
    ///
    /// # Errors
    /// [`Error::NotFinite`] for one that is not finite, [`Error::Length`] at the end of the record.
    pub fn number(&mut self, x: &mut R) -> Result<()> {
        self.numbers(std::slice::from_mut(x))
    }

    /// Numbers, as many as there are.
    ///
    /// # Errors
    /// Those of [`number`](Self::number).
    pub fn numbers(&mut self, x: &mut [R]) -> Result<()> {
        let numbers = &mut self.record.numbers;
        match &mut self.read {
            None => numbers.extend_from_slice(x),
            Some([at, _]) => {
                let end = *at + x.len();
                let source = numbers.get(*at..end);
                x.copy_from_slice(source.ok_or_else(|| too_short(numbers.len(), end))?);
                *at = end;
            }
        }
        for x in x {
            finite("number in the history of a run", *x)?;
        }
        Ok(())
    }

    /// A count.
    ///
    /// # Errors
    /// [`Error::Length`] at the end of the record.
    pub fn count(&mut self, n: &mut usize) -> Result<()> {
        let counts = &mut self.record.counts;
        match &mut self.read {
            None => counts.push(*n as u64),
            Some([_, at]) => {
                let source = counts.get(*at);
                *n = *source.ok_or_else(|| too_short(counts.len(), *at + 1))? as usize;
                *at += 1;
            }
        }
        Ok(())
    }

    /// A count that indexes something: nothing outside the range is read.
    pub(crate) fn index(&mut self, n: &mut usize, range: RangeInclusive<usize>) -> Result<()> {
        self.count(n)?;
        if !range.contains(n) {
            return Err(Error::OutOfRange {
                what: "index in the history of a run",
                value: *n as f64,
                range: "the size of the system",
                remedy: "the checkpoint is damaged: take an earlier one",
            });
        }
        Ok(())
    }

    /// Whether something is so.
    ///
    /// # Errors
    /// Those of [`count`](Self::count).
    pub fn flag(&mut self, x: &mut bool) -> Result<()> {
        let mut n = usize::from(*x);
        self.index(&mut n, 0..=1)?;
        *x = n == 1;
        Ok(())
    }

    /// A number that there may be.
    ///
    /// # Errors
    /// Those of [`number`](Self::number).
    pub fn option(&mut self, x: &mut Option<R>) -> Result<()> {
        let mut some = x.is_some();
        self.flag(&mut some)?;
        if !some {
            *x = None;
            return Ok(());
        }
        self.number(x.get_or_insert(R::zero()))
    }

    /// Ends the tape and gives what is on it.
    ///
    /// # Errors
    /// [`Error::Length`] when not all of it was read.
    pub fn end(self) -> Result<Record<R>> {
        if let Some([numbers, counts]) = self.read {
            let given = self.record.numbers.len() + self.record.counts.len();
            Error::check_length(LENGTH, given, numbers + counts)?;
        }
        Ok(self.record)
    }
}

const LENGTH: &str = "length of the history of a run";

fn too_short(given: usize, needed: usize) -> Error {
    Error::Length {
        what: LENGTH,
        given,
        needed,
    }
}
