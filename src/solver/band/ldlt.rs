//! Factorisation `L D L^T` of symmetric matrices without pivoting. This is where a simulation of
//! a long chain spends its time, hence the form: pivots are eliminated four at a time, from
//! contiguous copies of their columns, by updates of contiguous rows that compilers vectorise.

use super::{BandMatrix, Profile};
use crate::error::{Error, Result};
use crate::scalar::Real;
use crate::solver::Tape;

/// Pivots eliminated together.
const PANEL: usize = 4;

/// Rounding units below which a pivot is taken for rounding of the terms it was summed from.
pub(in crate::solver) const NOISE: f64 = 4.0;

/// Growth of a diagonal term over the largest entry of its row that is still accepted. The
/// backward error is at most this many rounding units; definite matrices never exceed 2, and
/// saddle points whose stiffness block is definite stay of that order.
pub(in crate::solver) const GROWTH: f64 = 256.0;

#[derive(Debug, Clone)]
pub(super) struct Ldlt<R> {
    /// Rows as in [`BandMatrix`], with the unit diagonal of `L` left out of use.
    rows: Vec<R>,
    stride: usize,
    half: usize,
    /// Reciprocals of the pivots.
    inverse: Vec<R>,
    /// Columns of the current pivots below them, before division by the pivot.
    columns: Vec<R>,
    /// Sum of the magnitudes of all terms of a diagonal entry: its rounding is a few units of it.
    magnitude: Vec<f64>,
    negative: usize,
}

impl<R: Real> Ldlt<R> {
    pub(super) fn new(profile: &Profile) -> Self {
        let (size, half) = (profile.size(), profile.half_bandwidth());
        let stride = half + 1;
        Self {
            rows: vec![R::zero(); size * stride],
            stride,
            half,
            inverse: vec![R::zero(); size],
            columns: vec![R::zero(); PANEL * stride],
            magnitude: vec![0.0; size],
            negative: 0,
        }
    }

    pub(super) fn negative(&self) -> usize {
        self.negative
    }

    pub(super) fn history(&mut self, tape: &mut Tape<R>) -> Result<()> {
        tape.count(&mut self.negative)?;
        tape.numbers(&mut self.rows)?;
        tape.numbers(&mut self.inverse)
    }

    #[inline(always)]
    fn index(&self, i: usize, j: usize) -> usize {
        i * self.stride + self.half + j - i
    }

    /// Whether the matrix could be factorised stably; if not, it needs pivoting.
    pub(super) fn factor(&mut self, profile: &Profile, matrix: &BandMatrix<R>) -> Result<bool> {
        let size = profile.size();
        let reach = profile.reach();
        self.negative = 0;
        let mut definite = true;
        let (mut j, mut copied) = (0, 0);
        while j < size {
            let last = reach[j];
            // Rows are fetched just before their first use, while the cache still holds them.
            while copied <= last {
                let (first, source) = matrix.row(copied);
                let start = self.index(copied, first);
                self.rows[start..start + source.len()].copy_from_slice(source);
                copied += 1;
            }
            // Pivots of equal reach share their rows and can go together.
            let alike = |count: usize| reach.get(j + count - 1) == Some(&last);
            let count = if alike(PANEL) {
                PANEL
            } else if alike(2) {
                2
            } else {
                1
            };
            let eliminate = match count {
                PANEL => Self::eliminate::<PANEL>,
                2 => Self::eliminate::<2>,
                _ => Self::eliminate::<1>,
            };
            if definite && !eliminate(self, j, last, matrix, true)? {
                definite = false;
                self.find_magnitudes(j, copied, matrix);
            }
            if !definite && !eliminate(self, j, last, matrix, false)? {
                return Ok(false);
            }
            j += count;
        }
        Ok(true)
    }

    /// Magnitudes of the diagonal terms from row `j` on. Up to there all pivots were positive, so
    /// every term was subtracted with one sign and the magnitudes, which definite matrices need
    /// not keep, follow from the sums.
    fn find_magnitudes(&mut self, j: usize, copied: usize, matrix: &BandMatrix<R>) {
        for i in j..self.inverse.len() {
            let start = matrix.diagonal(i).value();
            let now = if i < copied {
                self.rows[self.index(i, i)].value()
            } else {
                start
            };
            self.magnitude[i] = start.abs() + (start - now).abs();
        }
    }

    /// Eliminates the unknowns `j..j + P`, which are coupled up to row `last`. False if a pivot
    /// cannot be trusted; the rows are then as before.
    fn eliminate<const P: usize>(
        &mut self,
        j: usize,
        last: usize,
        matrix: &BandMatrix<R>,
        definite: bool,
    ) -> Result<bool> {
        // The triangle of the pivots themselves, before and after division by them.
        let mut before = [[R::zero(); P]; P];
        let mut after = [[R::zero(); P]; P];
        let mut inverse = [R::zero(); P];
        let mut negative = 0;
        for p in 0..P {
            for i in p..P {
                let mut entry = self.rows[self.index(j + i, j + p)];
                for q in 0..p {
                    entry -= after[q][i] * before[q][p];
                }
                before[p][i] = entry;
            }
            let pivot = before[p][p];
            if !pivot.finite() {
                return Err(Error::NotFinite {
                    what: "a pivot of the matrix to factorise",
                    value: pivot.value(),
                });
            }
            if definite {
                let noise = R::lit(NOISE * R::EPSILON) * matrix.diagonal(j + p);
                if !(pivot > R::zero() && pivot > noise) {
                    return Ok(false);
                }
            } else {
                let (d, terms) = (pivot.value(), self.magnitude[j + p]);
                let noise = d.abs() <= NOISE * R::EPSILON * terms;
                if noise || terms > GROWTH * largest_of_row(matrix, j + p) {
                    return Ok(false);
                }
                negative += usize::from(d < 0.0);
            }
            inverse[p] = R::one() / pivot;
            for i in p + 1..P {
                after[p][i] = before[p][i] * inverse[p];
                if !definite {
                    self.magnitude[j + i] += (before[p][i] * after[p][i]).value().abs();
                }
            }
        }
        self.negative += negative;
        for i in 0..P {
            self.inverse[j + i] = inverse[i];
            for p in 0..i {
                let index = self.index(j + i, j + p);
                self.rows[index] = after[p][i];
            }
        }
        for i in j + P..=last {
            let start = self.index(i, j);
            let (pivots, row) = self.rows[start..=start + i - j].split_at_mut(P);
            let mut l = [R::zero(); P];
            for p in 0..P {
                let mut entry = pivots[p];
                for q in 0..p {
                    entry -= l[q] * before[q][p];
                }
                self.columns[p * self.stride + row.len() - 1] = entry;
                l[p] = entry * inverse[p];
                pivots[p] = l[p];
                if !definite {
                    self.magnitude[i] += (entry * l[p]).value().abs();
                }
            }
            // The columns up to row i are complete by now: no second pass is needed.
            let c: [&[R]; P] =
                std::array::from_fn(|p| &self.columns[p * self.stride..][..row.len()]);
            for k in 0..row.len() {
                let mut sum = l[0] * c[0][k];
                for p in 1..P {
                    sum += l[p] * c[p][k];
                }
                row[k] -= sum;
            }
        }
        Ok(true)
    }

    pub(super) fn solve(&self, profile: &Profile, x: &mut [R]) {
        let first = profile.first();
        for i in 0..x.len() {
            let row = &self.rows[self.index(i, first[i])..self.index(i, i)];
            let (solved, rest) = x.split_at_mut(i);
            rest[0] -= dot(row, &solved[first[i]..]);
        }
        for (x, inverse) in x.iter_mut().zip(&self.inverse) {
            *x *= *inverse;
        }
        for i in (0..x.len()).rev() {
            let row = &self.rows[self.index(i, first[i])..self.index(i, i)];
            let (open, solved) = x.split_at_mut(i);
            let value = solved[0];
            for (x, l) in open[first[i]..].iter_mut().zip(row) {
                *x -= *l * value;
            }
        }
    }
}

/// Inner product in four independent sums, which can be formed at the same time.
#[inline(always)]
fn dot<R: Real>(a: &[R], b: &[R]) -> R {
    let mut sums = [R::zero(); 4];
    let (a4, b4) = (a.chunks_exact(4), b.chunks_exact(4));
    let mut sum = R::zero();
    for (a, b) in a4.remainder().iter().zip(b4.remainder()) {
        sum += *a * *b;
    }
    for (a, b) in a4.zip(b4) {
        for k in 0..4 {
            sums[k] += a[k] * b[k];
        }
    }
    sum + ((sums[0] + sums[2]) + (sums[1] + sums[3]))
}

fn largest_of_row<R: Real>(matrix: &BandMatrix<R>, i: usize) -> f64 {
    let (_, row) = matrix.row(i);
    let left = row.iter().map(|a| a.value().abs()).fold(0.0, f64::max);
    let reach = matrix.profile().reach()[i];
    (i + 1..=reach)
        .map(|k| matrix.get(k, i).value().abs())
        .fold(left, f64::max)
}
