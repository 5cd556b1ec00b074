//! A matrix that is written by coordinates and stored by unknowns: elements and loads add to the
//! coordinates they know, and what follows from other coordinates goes where those are.

use super::band::{Lines, STRETCHES};
use super::stored::Stored;
use super::unknowns::{Combination, Stretches, Unknowns};
use crate::error::{Error, Result};
use crate::scalar::{Lanes, MOST_LANES, Real};

/// A tangent or mass matrix over the coordinates of a structure, `T^T K T` over its [`Unknowns`].
/// No method but the constructors allocates.
#[derive(Debug, Clone)]
pub struct Matrix<R> {
    unknowns: Unknowns<R>,
    stored: Stored<R>,
}

impl<R: Real> Matrix<R> {
    /// Zero matrix; `symmetric` ones store one triangle.
    #[must_use]
    pub fn zero(unknowns: &Unknowns<R>, symmetric: bool) -> Self {
        let profile = unknowns.profile();
        Self {
            unknowns: unknowns.clone(),
            stored: if symmetric {
                Stored::symmetric(profile)
            } else {
                Stored::general(profile)
            },
        }
    }

    /// The matrix over the unknowns.
    #[must_use]
    pub fn stored(&self) -> &Stored<R> {
        &self.stored
    }

    /// The entries over the unknowns, to write.
    pub(crate) fn stored_mut(&mut self) -> &mut Stored<R> {
        &mut self.stored
    }

    /// The diagonal entry of every coordinate that is an unknown; zero for the others.
    pub(crate) fn diagonal(&self) -> Vec<R> {
        let mut diagonal = vec![R::zero(); self.unknowns.coordinates()];
        for (q, i) in self.unknowns.free().iter().enumerate() {
            diagonal[*i] = self.stored.get(q, q);
        }
        diagonal
    }

    /// Sets every entry to zero.
    pub fn clear(&mut self) {
        self.stored.clear();
    }

    /// Adds `value` to the entry of the coordinates `i` and `j`. Both `(i, j)` and `(j, i)` of a
    /// symmetric matrix are to be added; one of them is stored.
    ///
    /// # Errors
    /// [`Error::OutsideProfile`](crate::Error::OutsideProfile) for coordinates that do not couple.
    #[inline]
    pub fn add(&mut self, i: usize, j: usize, value: R) -> Result<()> {
        let Self { unknowns, stored } = self;
        for_each(unknowns, i, value, |p, value| {
            for_each(unknowns, j, value, |q, value| stored.add(p, q, value))
        })
    }

    /// Adds `factor` times the entries of a row that couples vectors of `n` coordinates component by
    /// component, and their mirror images: those of the vector from coordinate `i` on with the vectors
    /// from coordinate `j >= i` on.
    pub(crate) fn add_alike(
        &mut self,
        i: usize,
        j: usize,
        n: usize,
        factor: R,
        row: &[R],
    ) -> Result<()> {
        let Self { unknowns, stored } = self;
        if let (Some(p), Some(q), Some(envelope)) = (
            unknowns.run(i, n),
            unknowns.run(j, n * row.len()),
            stored.envelope(),
        ) {
            return envelope.add_alike(p, q, n, factor, row);
        }
        for (t, m) in row.iter().enumerate() {
            for (i, j) in (i..i + n).zip(j + t * n..) {
                self.add(i, j, factor * *m)?;
                if i != j {
                    self.add(j, i, factor * *m)?;
                }
            }
        }
        Ok(())
    }

    /// Adds the full row-major matrix of an element whose `n` coordinates are numbered
    /// consecutively from `offset`.
    ///
    /// # Errors
    /// Those of [`add`](Self::add), [`Error::Length`](crate::Error::Length) for a block of another
    /// size.
    pub fn add_block(&mut self, offset: usize, n: usize, block: &[R]) -> Result<()> {
        Error::check_length("element matrix", block.len(), n * n)?;
        if let Some(first) = self.unknowns.run(offset, n) {
            return self.stored.add_block(first, n, block);
        }
        for (i, row) in block.chunks_exact(n).enumerate() {
            let mut j = 0;
            while j < n {
                let (p, q) = (offset + i, offset + j);
                let stretch = self.unknowns.stretch(q, n - j);
                match (self.unknowns.combination(p), stretch) {
                    (Combination::Unknown(p), Some(unknowns)) => {
                        let values = &row[j..j + unknowns.len()];
                        self.stored.add_row(p, unknowns.start, values)?;
                        j += unknowns.len();
                    }
                    _ => {
                        self.add(p, q, row[j])?;
                        j += 1;
                    }
                }
            }
        }
        Ok(())
    }

    /// Adds the matrices of the elements in the lanes that have a start, the first of `n` coordinates
    /// numbered consecutively, where these are unknowns of an envelope, numbered upwards, or held, in
    /// stretches of which there are not too many beside those of the lanes before. The others are left:
    /// lanes of which this returns a bit. The entries of `block` are row-major and full; of those added to a
    /// symmetric matrix the upper triangles are read.
    #[inline(always)]
    pub(crate) fn add_blocks<L: Lanes<R>>(
        &mut self,
        n: usize,
        block: &[L],
        start: impl Fn(usize) -> Option<usize>,
    ) -> Result<u32> {
        let Self { unknowns, stored } = self;
        let envelope = stored.envelope();
        let mut left = 0;
        let mut all = Stretches::default();
        let mut starts = [None; MOST_LANES];
        for lane in 0..L::WIDTH {
            let Some(offset) = start(lane) else { continue };
            let own = unknowns.stretches(offset, n).filter(|_| envelope.is_some());
            let with = own.map(|own| all.and(own));
            match with.filter(|with| with.count() <= STRETCHES) {
                Some(with) => (starts[lane], all) = (Some(offset), with),
                None => left |= 1 << lane,
            }
        }
        let Some(envelope) = envelope.filter(|_| all.unknown != 0) else {
            return Ok(left);
        };
        let mut lines = envelope.all_lines();
        if all.breaks == 0 {
            lines.add_blocks(
                n,
                block,
                #[inline(always)]
                |lane| unknowns.run(starts[lane]?, n),
            )?;
        } else {
            lines.add_stretches(
                n,
                block,
                all.each(n),
                #[inline(always)]
                |lane, i| unknowns.unknown(starts[lane]? + i),
            )?;
        }
        Ok(left)
    }

    /// The unknown that a coordinate is, and all unknowns before it come from coordinates before; else
    /// nothing.
    pub(crate) fn place_in_order(&self, coordinate: usize) -> Option<usize> {
        let ordered = self.unknowns.in_order();
        self.unknowns.run(coordinate, 1).filter(|_| ordered)
    }

    /// How many coordinates from this one on are unknowns in a row.
    pub(crate) fn in_a_row(&self, coordinate: usize) -> usize {
        self.unknowns.in_a_row(coordinate)
    }

    /// The rows of `count` coordinates that are unknowns in a row, stored in an envelope.
    ///
    /// # Errors
    /// [`Error::OutsideProfile`](crate::Error::OutsideProfile) where they are not.
    pub(crate) fn rows(&mut self, coordinate: usize, count: usize) -> Result<Rows<'_, R>> {
        let first = self.unknowns.run(coordinate, count);
        let (Some(first), Some(envelope)) = (first, self.stored.envelope()) else {
            return Err(Error::OutsideProfile {
                row: coordinate + count,
                column: coordinate,
            });
        };
        Ok(Rows {
            lines: envelope.lines(first + count),
            coordinate,
            first,
        })
    }

    /// Adds `alpha * other`.
    ///
    /// # Errors
    /// [`Error::Unsupported`](crate::Error::Unsupported) unless both are of the same unknowns and
    /// store the same triangles.
    pub fn scale_add(&mut self, alpha: R, other: &Self) -> Result<()> {
        self.stored.scale_add(alpha, &other.stored)
    }
}

/// Rows of a [`Matrix`] whose coordinates are unknowns in a row: what one thread may write while others
/// write the rest.
pub(crate) struct Rows<'a, R: Real> {
    lines: Lines<'a, R>,
    /// The first coordinate, and the unknown that it is.
    coordinate: usize,
    first: usize,
}

impl<R: Real> Rows<'_, R> {
    /// Those before and from a coordinate on.
    pub(crate) fn halves(&mut self, coordinate: usize) -> (Rows<'_, R>, Rows<'_, R>) {
        let Self {
            lines,
            coordinate: start,
            first,
        } = self;
        let (left, right) = lines.halves(coordinate - *start + *first);
        let rows = |lines| Rows {
            lines,
            coordinate: *start,
            first: *first,
        };
        (rows(left), rows(right))
    }

    pub(crate) fn is_symmetric(&self) -> bool {
        self.lines.is_symmetric()
    }

    /// Adds the matrices of the elements in the lanes that have a start, the first of `n` coordinates
    /// numbered consecutively, all of them among these.
    #[inline(always)]
    pub(crate) fn add_blocks<L: Lanes<R>>(
        &mut self,
        n: usize,
        block: &[L],
        start: impl Fn(usize) -> Option<usize>,
    ) -> Result<()> {
        let (first, coordinate) = (self.first, self.coordinate);
        let unknown = |lane| start(lane).map(|start| start - coordinate + first);
        self.lines.add_blocks(n, block, unknown)
    }
}

/// Calls `give` for every unknown that coordinate `i` is made of, with its share of `value`.
#[inline]
fn for_each<R: Real>(
    unknowns: &Unknowns<R>,
    i: usize,
    value: R,
    mut give: impl FnMut(usize, R) -> Result<()>,
) -> Result<()> {
    match unknowns.combination(i) {
        Combination::Unknown(p) => give(p, value),
        Combination::Sum(terms) => terms.iter().try_for_each(|(i, a)| {
            match unknowns.combination(*i) {
                Combination::Unknown(p) => give(p, value * *a),
                // Followers follow unknowns only.
                Combination::Sum(_) => Ok(()),
            }
        }),
    }
}
