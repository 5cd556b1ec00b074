//! Factorisation `L D L^T` of symmetric matrices without pivoting. This is where a simulation of
//! a long chain spends its time, hence the form: pivots are eliminated four at a time, from
//! contiguous copies of their columns, by updates of contiguous rows that compilers vectorise.

use super::{BandMatrix, Profile};
use crate::error::{Error, Result};
use crate::scalar::{LaneWork, Lanes, Mask, Real};

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
    magnitude: Vec<R>,
    negative: R,
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
            magnitude: vec![R::zero(); size],
            negative: R::zero(),
        }
    }

    pub(super) fn negative(&self) -> usize {
        self.negative.value() as usize
    }

    #[inline(always)]
    fn index(&self, i: usize, j: usize) -> usize {
        i * self.stride + self.half + j - i
    }

    /// Whether the matrix could be factorised stably; if not, it needs pivoting.
    pub(super) fn factor(&mut self, profile: &Profile, matrix: &BandMatrix<R>) -> Result<bool> {
        R::dispatch_single(Factorisation {
            ldlt: self,
            profile,
            matrix,
        })
    }

    #[inline(always)]
    fn factor_in<L: Lanes<R>>(
        &mut self,
        profile: &Profile,
        matrix: &BandMatrix<R>,
    ) -> Result<bool> {
        let size = profile.size();
        let reach = profile.reach();
        self.negative = R::zero();
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
            let eliminated = match count {
                PANEL => self.eliminate::<L, PANEL>(j, last, matrix, definite)?,
                2 => self.eliminate::<L, 2>(j, last, matrix, definite)?,
                _ => self.eliminate::<L, 1>(j, last, matrix, definite)?,
            };
            if eliminated {
                j += count;
            } else if definite {
                // The same pivots once more, under watch.
                definite = false;
                self.find_magnitudes(j, copied, matrix);
            } else {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Magnitudes of the diagonal terms from row `j` on. Up to there all pivots were positive, so
    /// every term was subtracted with one sign and the magnitudes, which definite matrices need
    /// not keep, follow from the sums.
    fn find_magnitudes(&mut self, j: usize, copied: usize, matrix: &BandMatrix<R>) {
        for i in j..self.inverse.len() {
            let start = matrix.diagonal(i);
            let now = if i < copied {
                self.rows[self.index(i, i)]
            } else {
                start
            };
            self.magnitude[i] = start.abs() + (start - now).abs();
        }
    }

    /// Eliminates the unknowns `j..j + P`, which are coupled up to row `last`. False if a pivot
    /// cannot be trusted; the rows are then as before.
    #[inline(always)]
    fn eliminate<L: Lanes<R>, const P: usize>(
        &mut self,
        j: usize,
        last: usize,
        matrix: &BandMatrix<R>,
        definite: bool,
    ) -> Result<bool> {
        // The triangle of the pivots themselves, before and after division by them.
        let mut before = [[L::zero(); P]; P];
        let mut after = [[L::zero(); P]; P];
        let mut inverse = [L::zero(); P];
        let mut negative = R::zero();
        for p in 0..P {
            for i in p..P {
                let mut entry = L::lift(self.rows[self.index(j + i, j + p)]);
                for q in 0..p {
                    entry -= after[q][i] * before[q][p];
                }
                before[p][i] = entry;
            }
            let pivot = number(before[p][p]);
            if !pivot.finite() {
                return Err(Error::NotFinite {
                    what: "a pivot of the matrix to factorise",
                    value: pivot.value(),
                });
            }
            if definite {
                let noise = R::lit(NOISE * R::EPSILON) * matrix.diagonal(j + p);
                if (pivot.at_most(R::zero()) | pivot.at_most(noise)).any() {
                    return Ok(false);
                }
            } else {
                let terms = self.magnitude[j + p];
                let noise = pivot.abs().at_most(R::lit(NOISE * R::EPSILON) * terms);
                let bound = R::lit(GROWTH) * largest_of_row(matrix, j + p);
                if (noise | !terms.at_most(bound)).any() {
                    // A lane that is definite would not have been watched in a run of its own.
                    let _ = Mask::among(R::LANES == 1).common();
                    return Ok(false);
                }
                negative += R::one().where_else(pivot.at_most(R::zero()), R::zero());
            }
            inverse[p] = L::one() / before[p][p];
            for i in p + 1..P {
                after[p][i] = before[p][i] * inverse[p];
                if !definite {
                    self.magnitude[j + i] += number(before[p][i] * after[p][i]).abs();
                }
            }
        }
        self.negative += negative;
        for i in 0..P {
            inverse[i].set(&mut self.inverse[j + i]);
            for p in 0..i {
                let index = self.index(j + i, j + p);
                after[p][i].set(&mut self.rows[index]);
            }
        }
        for i in j + P..=last {
            let start = self.index(i, j);
            let (pivots, row) = self.rows[start..=start + i - j].split_at_mut(P);
            let mut l = [L::zero(); P];
            for p in 0..P {
                let mut entry = L::lift(pivots[p]);
                for q in 0..p {
                    entry -= l[q] * before[q][p];
                }
                entry.set(&mut self.columns[p * self.stride + row.len() - 1]);
                l[p] = entry * inverse[p];
                l[p].set(&mut pivots[p]);
                if !definite {
                    self.magnitude[i] += number(entry * l[p]).abs();
                }
            }
            // The columns up to row i are complete by now: no second pass is needed.
            let c: [&[R]; P] =
                std::array::from_fn(|p| &self.columns[p * self.stride..][..row.len()]);
            for k in 0..row.len() {
                let mut sum = l[0].times(c[0][k]);
                for p in 1..P {
                    sum += l[p].times(c[p][k]);
                }
                (L::lift(row[k]) - sum).set(&mut row[k]);
            }
        }
        Ok(true)
    }

    pub(super) fn solve(&self, profile: &Profile, x: &mut [R]) {
        R::dispatch_single(Solution {
            ldlt: self,
            profile,
            x,
        });
    }

    #[inline(always)]
    fn solve_in<L: Lanes<R>>(&self, profile: &Profile, x: &mut [R]) {
        let first = profile.first();
        for i in 0..x.len() {
            let row = &self.rows[self.index(i, first[i])..self.index(i, i)];
            let (solved, rest) = x.split_at_mut(i);
            let sum: L = dot(row, &solved[first[i]..]);
            (L::lift(rest[0]) - sum).set(&mut rest[0]);
        }
        for (x, inverse) in x.iter_mut().zip(&self.inverse) {
            L::lift(*x).times(*inverse).set(x);
        }
        for i in (0..x.len()).rev() {
            let row = &self.rows[self.index(i, first[i])..self.index(i, i)];
            let (open, solved) = x.split_at_mut(i);
            let value = L::lift(solved[0]);
            for (x, l) in open[first[i]..].iter_mut().zip(row) {
                (L::lift(*x) - L::lift(*l) * value).set(x);
            }
        }
    }
}

/// A factorisation, to be done in registers.
struct Factorisation<'a, R> {
    ldlt: &'a mut Ldlt<R>,
    profile: &'a Profile,
    matrix: &'a BandMatrix<R>,
}

impl<R: Real> LaneWork<R> for Factorisation<'_, R> {
    type Output = Result<bool>;

    #[inline(always)]
    fn run<L: Lanes<R>>(self) -> Result<bool> {
        self.ldlt.factor_in::<L>(self.profile, self.matrix)
    }
}

/// A solution, to be done in registers.
struct Solution<'a, R> {
    ldlt: &'a Ldlt<R>,
    profile: &'a Profile,
    x: &'a mut [R],
}

impl<R: Real> LaneWork<R> for Solution<'_, R> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes<R>>(self) {
        self.ldlt.solve_in::<L>(self.profile, self.x);
    }
}

/// What a register of one number holds.
#[inline(always)]
fn number<R: Real, L: Lanes<R>>(register: L) -> R {
    let mut number = R::zero();
    register.set(&mut number);
    number
}

/// Inner product in four independent sums, which can be formed at the same time.
#[inline(always)]
fn dot<R: Real, L: Lanes<R>>(a: &[R], b: &[R]) -> L {
    let mut sums = [L::zero(); 4];
    let (a4, b4) = (a.chunks_exact(4), b.chunks_exact(4));
    let mut sum = L::zero();
    for (a, b) in a4.remainder().iter().zip(b4.remainder()) {
        sum += L::lift(*a).times(*b);
    }
    for (a, b) in a4.zip(b4) {
        for k in 0..4 {
            sums[k] += L::lift(a[k]).times(b[k]);
        }
    }
    sum + ((sums[0] + sums[2]) + (sums[1] + sums[3]))
}

fn largest_of_row<R: Real>(matrix: &BandMatrix<R>, i: usize) -> R {
    let (_, row) = matrix.row(i);
    let left = row.iter().map(|a| a.abs()).fold(R::zero(), R::larger);
    let reach = matrix.profile().reach()[i];
    (i + 1..=reach)
        .map(|k| matrix.get(k, i).abs())
        .fold(left, R::larger)
}
