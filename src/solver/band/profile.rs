//! The sparsity envelope of a chain: which entries of a matrix may be non-zero. It is found once
//! from the elements and shared by every matrix and factorisation of the model. Where the envelope
//! of a tree or grid would be mostly zeros it carries the pattern of a sparse factor beside.

use std::ops::Range;
use std::sync::Arc;

use crate::error::{Error, Result};
use crate::solver::sparse::Pattern;

/// Symmetric envelope of a square matrix: column `j` is coupled to the rows `j..=reach(j)`.
///
/// `reach` never decreases, which is exactly what makes elimination without pivoting stay inside
/// the envelope. Cloning is cheap: the tables are shared.
#[derive(Debug, Clone)]
pub struct Profile {
    reach: Arc<[usize]>,
    first: Arc<[usize]>,
    half: usize,
    pattern: Option<Arc<Pattern>>,
}

/// Profiles of the same envelope, stored in the same way.
impl PartialEq for Profile {
    fn eq(&self, other: &Self) -> bool {
        let stored = match (&self.pattern, &other.pattern) {
            (None, None) => true,
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            _ => false,
        };
        stored && (Arc::ptr_eq(&self.reach, &other.reach) || self.reach == other.reach)
    }
}

impl Eq for Profile {}

impl Profile {
    /// Envelope of `size` unknowns in which every one of `ranges` couples all its unknowns with
    /// each other, as an element or a constraint between neighbours does. An unknown in no range
    /// is coupled to itself only.
    ///
    /// # Errors
    /// [`Error::TooFew`] without unknowns, [`Error::BadRange`] for a range that is empty or
    /// exceeds `0..size`.
    pub fn from_ranges(
        size: usize,
        ranges: impl IntoIterator<Item = Range<usize>>,
    ) -> Result<Self> {
        if size == 0 {
            return Err(Error::TooFew {
                what: "number of unknowns",
                value: 0,
                least: 1,
                remedy: "a model needs at least one element",
            });
        }
        let mut reach: Vec<usize> = (0..size).collect();
        for Range { start, end } in ranges {
            if start >= end || end > size {
                return Err(Error::BadRange { start, end, size });
            }
            // The columns between start and end follow from the running maximum below.
            reach[start] = reach[start].max(end - 1);
        }
        let mut first = vec![0; size];
        let (mut furthest, mut half) = (0, 0);
        for j in 0..size {
            let from = if j == 0 { 0 } else { furthest + 1 };
            furthest = furthest.max(reach[j]);
            for row in from..=furthest {
                first[row] = j;
            }
            reach[j] = furthest;
            half = half.max(furthest - j);
        }
        Ok(Self {
            reach: reach.into(),
            first: first.into(),
            half,
            pattern: None,
        })
    }

    /// The same envelope, with symmetric matrices stored by a sparse pattern.
    pub(in crate::solver) fn with_pattern(mut self, pattern: Pattern) -> Self {
        self.pattern = Some(Arc::new(pattern));
        self
    }

    pub(in crate::solver) fn pattern(&self) -> Option<&Arc<Pattern>> {
        self.pattern.as_ref()
    }

    /// Multiplications of a factorisation within the envelope.
    pub(in crate::solver) fn cost(&self) -> f64 {
        let square = |(j, reach): (usize, &usize)| ((reach - j) as f64).powi(2);
        self.reach.iter().enumerate().map(square).sum()
    }

    /// Number of unknowns.
    #[must_use]
    pub fn size(&self) -> usize {
        self.reach.len()
    }

    /// Largest distance of an entry of the envelope from the diagonal.
    #[must_use]
    pub fn half_bandwidth(&self) -> usize {
        self.half
    }

    /// Last row coupled to every column; never decreases.
    #[must_use]
    pub fn reach(&self) -> &[usize] {
        &self.reach
    }

    /// First column coupled to every row; never decreases.
    #[must_use]
    pub fn first(&self) -> &[usize] {
        &self.first
    }

    /// Whether entry `(i, j)` lies inside the envelope.
    #[must_use]
    pub fn contains(&self, i: usize, j: usize) -> bool {
        let (low, high) = if i < j { (i, j) } else { (j, i) };
        self.reach.get(low).is_some_and(|&reach| high <= reach)
    }

    /// Refuses an entry outside the envelope.
    pub(super) fn check_holds(&self, row: usize, column: usize) -> Result<()> {
        match self.contains(row, column) {
            true => Ok(()),
            false => Err(Error::OutsideProfile { row, column }),
        }
    }

    pub(super) fn check_same(&self, other: &Self) -> Result<()> {
        Error::check_length("size of the matrix", other.size(), self.size())?;
        Error::check_length(
            "half bandwidth of the matrix",
            other.half_bandwidth(),
            self.half,
        )?;
        if self == other {
            return Ok(());
        }
        Err(Error::Unsupported {
            what: "mixing matrices of different profiles".into(),
            remedy: "build all matrices and factors of a model from one Profile",
        })
    }
}
