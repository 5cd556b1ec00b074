//! Band LU with pivoting: the path of general matrices and the fallback for symmetric ones that
//! elimination without pivoting cannot factorise stably. Rows and columns are first equilibrated,
//! because stiffnesses and constraint coefficients differ by many powers of ten and the choice of a
//! pivot compares them. Of general matrices the diagonal is taken unless it is small in its column:
//! interchanges widen the rows, and the lanes of a pack choose the same pivots where all choose those.

use super::blocks::{SUMS, add_multiple, products};
use super::columns::overrun;
use super::{BandMatrix, Profile};
use crate::error::{Error, Result};
use crate::scalar::{Elementwise, LaneWork, Lanes, MOST_LANES, Real, elementwise};
use crate::solver::Tape;

/// Rounding units, relative to the equilibrated matrix, below which a pivot is taken for zero.
const NOISE: f64 = 4.0;

/// Share of the largest entry of its column from which on a diagonal entry is the pivot. The smaller it is,
/// the seldomer lanes part, and the more entries may grow, at most by 33 in a step.
const SHARE: f64 = 1.0 / 32.0;

/// Pivots, of entries that were scaled to less than two, beyond which these have grown: the matrix is then
/// eliminated again, with the largest entry of each column for pivot.
const GROWN: f64 = 8.0;

#[derive(Debug, Clone)]
pub(super) struct Lu<R> {
    /// Row `i` holds the columns from `i - half` to `i + 2 half`: interchanges widen the upper
    /// triangle by up to `half`. Zeros are behind them: registers reach beyond the end of a row.
    rows: Vec<R>,
    width: usize,
    half: usize,
    /// Multipliers of pivot `j`, contiguous, and zeros behind them.
    multipliers: Vec<R>,
    inverse: Vec<R>,
    /// Row interchanged with row `j`.
    swapped: Vec<usize>,
    /// Last column of row `j` of the upper factor.
    upper_end: Vec<usize>,
    /// Last column of row `i` behind which there are no zeros yet.
    widened: Vec<usize>,
    row_scale: Vec<R>,
    /// Zeros are behind them.
    column_scale: Vec<R>,
    /// The sign of the determinant.
    sign: R,
    /// The vector being solved for, and zeros behind it.
    vector: Vec<R>,
}

impl<R: Real> Lu<R> {
    pub(super) fn new(profile: &Profile) -> Self {
        let (size, half) = (profile.size(), profile.half_bandwidth());
        let width = 3 * half + 1 + overrun::<R>();
        Self {
            rows: vec![R::zero(); size * width],
            width,
            half,
            multipliers: vec![R::zero(); size * (half + overrun::<R>())],
            inverse: vec![R::zero(); size],
            swapped: vec![0; size],
            upper_end: vec![0; size],
            widened: vec![0; size],
            row_scale: vec![R::zero(); size],
            column_scale: vec![R::zero(); size + overrun::<R>()],
            sign: R::one(),
            vector: vec![R::zero(); size + SUMS - 1],
        }
    }

    #[inline(always)]
    fn index(&self, i: usize, j: usize) -> usize {
        i * self.width + self.half + j - i
    }

    /// The first multipliers of pivot `j`.
    #[inline(always)]
    fn multipliers_of(&self, j: usize, count: usize) -> &[R] {
        &self.multipliers[j * (self.half + overrun::<R>())..][..count]
    }

    pub(super) fn factor(&mut self, profile: &Profile, matrix: &BandMatrix<R>) -> Result<()> {
        let mut eliminate = |share: f64| {
            R::dispatch(Elimination {
                lu: self,
                profile,
                matrix,
                share: R::lit(share),
            })
        };
        // A symmetric matrix comes here where elimination without pivoting failed: no digit is given away.
        if !matrix.is_symmetric() && eliminate(SHARE)?.at_most(R::lit(GROWN)).common() {
            return Ok(());
        }
        eliminate(1.0).map(|_| ())
    }

    /// The row with the largest entry of column `j` among the rows up to `last`.
    #[cold]
    fn largest_of_column(&self, j: usize, last: usize) -> usize {
        let (mut chosen, mut largest) = (j, R::zero());
        for i in j..=last {
            let magnitude = self.rows[self.index(i, j)].abs();
            if magnitude > largest {
                (chosen, largest) = (i, magnitude);
            }
        }
        chosen
    }

    /// Has row `i` filled with zeros up to column `end`.
    #[cold]
    fn widen(&mut self, i: usize, end: usize) {
        if end > self.widened[i] {
            let fresh = self.index(i, self.widened[i] + 1)..=self.index(i, end) + overrun::<R>();
            self.rows[fresh].fill(R::zero());
            self.widened[i] = end;
        }
    }

    /// What is wrong where every entry of column `j` is taken for zero.
    #[cold]
    fn singular(&self, j: usize, last: usize, chosen: usize) -> Error {
        // A NaN is never the largest: do not mistake it for a zero.
        for i in j..=last {
            let entry = self.rows[self.index(i, j)];
            if !entry.finite() {
                return not_finite(entry);
            }
        }
        let pivot = self.rows[self.index(chosen, j)];
        Error::Singular {
            unknown: j,
            pivot: (pivot / (self.row_scale[chosen] * self.column_scale[j])).value(),
        }
    }

    /// Copies the matrix into the workspace, both triangles, and finds the scales of its rows and columns.
    /// They are powers of two, so that no rounding enters.
    #[inline(always)]
    fn fetch<L: Lanes<R>>(&mut self, profile: &Profile, matrix: &BandMatrix<R>) -> Result<()> {
        let (first, reach) = (profile.first(), profile.reach());
        let size = profile.size();
        if matrix.is_symmetric() {
            for i in 0..size {
                let (start, row) = matrix.row(i);
                for (j, entry) in (start..).zip(row) {
                    let (upper, lower) = (self.index(i, j), self.index(j, i));
                    (self.rows[upper], self.rows[lower]) = (*entry, *entry);
                }
            }
        }
        self.column_scale.fill(R::zero());
        for i in 0..size {
            let (start, end) = (self.index(i, first[i]), self.index(i, reach[i]) + 1);
            self.rows[end..end + overrun::<R>()].fill(R::zero());
            if !matrix.is_symmetric() {
                self.rows[start..end].copy_from_slice(matrix.row(i).1);
            }
            let length = (end - start).next_multiple_of(L::WIDTH);
            let row = &self.rows[start..][..length];
            let row_scale = scale(largest::<R, L>(row)?, i)?;
            self.row_scale[i] = row_scale;
            let columns = &mut self.column_scale[first[i]..][..length];
            Measure { row_scale }.run_in::<L>([row], [columns]);
        }
        for j in 0..size {
            self.column_scale[j] = scale(self.column_scale[j], j)?;
        }
        Ok(())
    }

    /// Scales row `i` and its columns.
    #[inline(always)]
    fn scale_row<L: Lanes<R>>(&mut self, profile: &Profile, i: usize) {
        let (first, last) = (profile.first()[i], profile.reach()[i]);
        let start = self.index(i, first);
        let length = (last + 1 - first).next_multiple_of(L::WIDTH);
        let row_scale = self.row_scale[i];
        let columns = &self.column_scale[first..][..length];
        Scale { row_scale }.run_in::<L>([columns], [&mut self.rows[start..][..length]]);
    }

    /// Whether the determinant of the last matrix is negative.
    pub(super) fn negative(&self) -> bool {
        self.sign < R::zero()
    }

    pub(super) fn history(&mut self, tape: &mut Tape<R>) -> Result<()> {
        tape.number(&mut self.sign)?;
        let size = self.inverse.len();
        for j in 0..size {
            let last = size - 1;
            tape.index(&mut self.swapped[j], j..=last)?;
            tape.index(&mut self.upper_end[j], j..=last.min(j + 2 * self.half))?;
            let (start, end) = (self.index(j, j), self.index(j, self.upper_end[j]));
            tape.numbers(&mut self.rows[start..=end])?;
            // What lies behind a row depends on the processor.
            self.rows[end + 1..][..overrun::<R>()].fill(R::zero());
        }
        let (half, stride) = (self.half, self.half + overrun::<R>());
        for multipliers in self.multipliers.chunks_mut(stride.max(1)) {
            tape.numbers(&mut multipliers[..half])?;
        }
        for numbers in [
            &mut self.inverse[..],
            &mut self.row_scale,
            &mut self.column_scale[..size],
        ] {
            tape.numbers(numbers)?;
        }
        Ok(())
    }

    pub(super) fn solve(&mut self, profile: &Profile, x: &mut [R]) {
        let mut vector = std::mem::take(&mut self.vector);
        R::dispatch(Solution {
            lu: self,
            reach: profile.reach(),
            x,
            vector: &mut vector,
        });
        self.vector = vector;
    }
}

/// Factorisation of a matrix, with the diagonal for pivot from a share of its column on; tells the largest
/// pivot.
struct Elimination<'a, R> {
    lu: &'a mut Lu<R>,
    profile: &'a Profile,
    matrix: &'a BandMatrix<R>,
    share: R,
}

impl<R: Real> LaneWork<R> for Elimination<'_, R> {
    type Output = Result<R>;
    const HEAVY: bool = true;

    #[inline(always)]
    fn run<L: Lanes<R>>(self) -> Result<R> {
        let Self {
            lu,
            profile,
            matrix,
            share,
        } = self;
        assert!(L::WIDTH <= overrun::<R>() + 1, "registers of HEAVY work");
        lu.fetch::<L>(profile, matrix)?;
        let (size, reach) = (profile.size(), profile.reach());
        let (width, half, stride) = (lu.width, lu.half, lu.half + overrun::<R>());
        let (mut end, mut seen, mut top) = (0, 0, R::zero());
        lu.sign = R::one();
        for j in 0..size {
            let last = reach[j];
            // Just before their first use, while the cache still holds them.
            while seen <= last {
                lu.scale_row::<L>(profile, seen);
                lu.widened[seen] = reach[seen];
                seen += 1;
            }
            let diagonal = lu.rows[lu.index(j, j)].abs();
            let mut below = R::zero();
            for i in j + 1..=last {
                below = below.larger(lu.rows[lu.index(i, j)].abs());
            }
            let noise = R::lit(NOISE * R::EPSILON);
            let least = noise.larger(below * share);
            let chosen = match least.at_most(diagonal).common() {
                true => j,
                false => lu.largest_of_column(j, last),
            };
            let pivot = lu.rows[lu.index(chosen, j)];
            if !pivot.finite() {
                return Err(not_finite(pivot));
            }
            if pivot.abs().at_most(noise).common() {
                return Err(lu.singular(j, last, chosen));
            }
            top = top.larger(pivot.abs());
            end = end.max(reach[chosen]);
            // Every interchange turns the sign; the scales are positive.
            if chosen != j {
                lu.sign = -lu.sign;
            }
            lu.sign = (-lu.sign).where_else(pivot.at_most(R::zero()), lu.sign);
            lu.swapped[j] = chosen;
            lu.upper_end[j] = end;
            if end > last {
                (j..=last).for_each(|i| lu.widen(i, end));
            }
            let count = end + 1 - j;
            let pivot_start = lu.index(j, j);
            let (upper, lower) = lu.rows.split_at_mut((j + 1) * width);
            let pivot_row = &mut upper[pivot_start..];
            let at = |i: usize| (i - j - 1) * width + half + j - i;
            if chosen != j {
                let other = at(chosen);
                pivot_row[..count].swap_with_slice(&mut lower[other..other + count]);
            }
            let inverse = R::one() / pivot;
            lu.inverse[j] = inverse;
            let reached = count - 1 + L::WIDTH - 1;
            let multipliers = &mut lu.multipliers[j * stride..][..last - j];
            for (i, multiplier) in (j + 1..=last).zip(multipliers) {
                let row = &mut lower[at(i)..];
                *multiplier = row[0] * inverse;
                add_multiple::<R, L>(-*multiplier, &pivot_row[1..], &mut row[1..], reached);
            }
        }
        Ok(top)
    }
}

/// Solution by the factors.
struct Solution<'a, R> {
    lu: &'a Lu<R>,
    reach: &'a [usize],
    x: &'a mut [R],
    vector: &'a mut [R],
}

impl<R: Real> LaneWork<R> for Solution<'_, R> {
    type Output = ();
    const HEAVY: bool = true;

    #[inline(always)]
    fn run<L: Lanes<R>>(self) {
        let Self {
            lu,
            reach,
            x,
            vector,
        } = self;
        let size = x.len();
        for (y, (x, scale)) in vector.iter_mut().zip(x.iter().zip(&lu.row_scale)) {
            *y = *x * *scale;
        }
        vector[size..].fill(R::zero());
        for j in 0..size {
            vector.swap(j, lu.swapped[j]);
            let reached = reach[j] - j + L::WIDTH - 1;
            let multipliers = lu.multipliers_of(j, reached);
            let (known, rest) = vector.split_at_mut(j + 1);
            add_multiple::<R, L>(-known[j], multipliers, rest, reached);
        }
        for j in (0..size).rev() {
            let count = lu.upper_end[j] - j;
            let row = &lu.rows[lu.index(j, j) + 1..][..count + L::WIDTH - 1];
            let mut parts = [[R::zero(); SUMS]];
            products::<R, L, 1>(&[row], &vector[j + 1..], count, &mut parts);
            // In three steps: the next row waits for this.
            let [mut parts] = parts;
            let mut half = SUMS;
            while half > 1 {
                half /= 2;
                for k in 0..half {
                    let other = parts[k + half];
                    parts[k] += other;
                }
            }
            vector[j] = (vector[j] - parts[0]) * lu.inverse[j];
        }
        for ((x, y), scale) in x.iter_mut().zip(&*vector).zip(&lu.column_scale) {
            *x = *y * *scale;
        }
    }
}

impl<R: Real> Lu<R> {
    /// Replaces `x` by the solution of the transposed system.
    pub(super) fn solve_transposed(&self, profile: &Profile, x: &mut [R]) {
        let reach = profile.reach();
        for (x, scale) in x.iter_mut().zip(&self.column_scale) {
            *x *= *scale;
        }
        for j in 0..x.len() {
            let value = x[j] * self.inverse[j];
            x[j] = value;
            let end = self.upper_end[j];
            let row = &self.rows[self.index(j, j)..=self.index(j, end)];
            for (x, u) in x[j + 1..=end].iter_mut().zip(&row[1..]) {
                *x -= *u * value;
            }
        }
        for j in (0..x.len()).rev() {
            let count = reach[j] - j;
            let multipliers = self.multipliers_of(j, count);
            let mut sum = x[j];
            for (l, x) in multipliers.iter().zip(&x[j + 1..]) {
                sum -= *l * *x;
            }
            x[j] = sum;
            x.swap(j, self.swapped[j]);
        }
        for (x, scale) in x.iter_mut().zip(&self.row_scale) {
            *x *= *scale;
        }
    }
}

#[cold]
fn not_finite<R: Real>(entry: R) -> Error {
    Error::NotFinite {
        what: "an entry of the matrix to factorise",
        value: entry.value(),
    }
}

elementwise! {
    /// The largest magnitudes of columns, by one more row.
    Measure(row_scale): [entry] -> [largest] {
        let entry = entry * row_scale;
        *largest = largest.greater(entry.greater(-entry));
    }
}

elementwise! {
    /// Scales a row by the scales of its columns and its own.
    Scale(row_scale): [column_scale] -> [entry] {
        *entry = *entry * row_scale * column_scale;
    }
}

/// Largest magnitude in a row that fills registers, refusing what is not finite.
#[inline(always)]
fn largest<R: Real, L: Lanes<R>>(row: &[R]) -> Result<R> {
    let mut numbers = [R::zero(); MOST_LANES];
    // Times zero, what is no number or infinite is none, and all others are nothing.
    let (mut largest, mut nothing) = (L::zero(), L::zero());
    for block in L::blocks(row) {
        let entries = L::load(block.as_ref());
        largest = largest.greater(entries.greater(-entries));
        nothing += entries * L::zero();
    }
    let mut sum = R::zero();
    nothing.store(&mut numbers);
    for number in &numbers[..L::WIDTH] {
        sum += *number;
    }
    if !sum.finite()
        && let Some(entry) = row.iter().find(|entry| !entry.finite())
    {
        return Err(not_finite(*entry));
    }
    largest.store(&mut numbers);
    let largest = &numbers[..L::WIDTH];
    Ok(largest.iter().copied().fold(R::zero(), R::larger))
}

/// Power of two that brings `largest` into 1..=2.
fn scale<R: Real>(largest: R, unknown: usize) -> Result<R> {
    if largest.at_most(R::zero()).common() {
        return Err(Error::Singular {
            unknown,
            pivot: 0.0,
        });
    }
    Ok(R::by_lanes(|lane| {
        // The sign and the digits of a double give way, and the exponent is turned.
        let exponent = (largest.lane(lane).to_bits() >> 52) & 0x7ff;
        f64::from_bits(2046_u64.saturating_sub(exponent).max(1) << 52)
    }))
}
