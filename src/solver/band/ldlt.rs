//! Factorisation `L D L^T` of symmetric matrices without pivoting. This is where a simulation of
//! a long chain spends its time, hence the form: pivots are eliminated four at a time, and whole
//! columns are updated in the widest registers of the processor.

mod solution;

use super::blocks::{SUMS, add_one, first_blocks, first_blocks_mut};
use super::matrix::{column_starts, overrun};
use super::pivots::Pivots;
use super::{BandMatrix, Profile, ahead};
use crate::error::{Error, Result};
use crate::scalar::{LaneWork, Lanes, Mask, Real};
use crate::solver::Tape;
use solution::Solution;

/// Pivots eliminated together.
const PANEL: usize = 4;

/// Rounding units below which a pivot is taken for rounding of the terms it was summed from: each
/// panel of pivots before it adds up to two, half of them of one sign or the other.
pub(in crate::solver) const NOISE: f64 = 8.0;

/// Growth of a diagonal term over the largest entry of its row that is still accepted. The
/// backward error is at most this many rounding units; definite matrices never exceed 2, and
/// saddle points whose stiffness block is definite stay of that order.
pub(in crate::solver) const GROWTH: f64 = 256.0;

#[derive(Debug, Clone)]
pub(super) struct Ldlt<R> {
    /// Columns of `L` from the diagonal down, which itself is left out of use, and zeros behind
    /// them: registers reach beyond the end of a column.
    columns: Vec<R>,
    /// Where each column starts, and where the last ends.
    starts: Vec<usize>,
    /// How many unknowns are eliminated together with each one: their reach is the same, so that
    /// they share their rows.
    counts: Vec<u8>,
    /// How many unknowns are eliminated, and how many columns that has touched.
    done: usize,
    seen: usize,
    /// Whether a right-hand side is eliminated along with a matrix that is assembled.
    along: bool,
    /// How many unknowns are still to be found from those behind them.
    behind: usize,
    /// The matrix's diagonal, as far as columns were touched.
    diagonal: Vec<R>,
    /// Reciprocals of the pivots.
    inverse: Vec<R>,
    /// Columns of the current pivots below them, before division by the pivot and with the other sign.
    panel: Vec<R>,
    /// Room for one of them.
    room: usize,
    /// Sum of the magnitudes of all terms of a diagonal entry: its rounding is a few units of it.
    magnitude: Vec<R>,
    /// The vector being solved for, and zeros behind it.
    vector: Vec<R>,
    negative: R,
}

/// How many unknowns of equal `reach` go together with each one.
fn counts(reach: &[usize]) -> Vec<u8> {
    let mut counts = vec![1; reach.len()];
    let mut j = 0;
    while j < reach.len() {
        let alike = |count: usize| reach.get(j + count - 1) == Some(&reach[j]);
        let count = [PANEL, 2]
            .into_iter()
            .find(|count| alike(*count))
            .unwrap_or(1);
        counts[j..j + count].fill(count as u8);
        j += count;
    }
    counts
}

impl<R: Real> Ldlt<R> {
    pub(super) fn new(profile: &Profile) -> Self {
        let (size, half) = (profile.size(), profile.half_bandwidth());
        let starts = column_starts::<R>(profile);
        Self {
            columns: vec![R::zero(); starts[size]],
            starts,
            done: 0,
            seen: 0,
            along: false,
            behind: 0,
            diagonal: vec![R::zero(); size],
            counts: counts(profile.reach()),
            inverse: vec![R::zero(); size],
            room: half + 1 + overrun::<R>(),
            panel: vec![R::zero(); PANEL * (half + 1 + overrun::<R>())],
            magnitude: vec![R::zero(); size],
            vector: vec![R::zero(); size + SUMS - 1],
            negative: R::zero(),
        }
    }

    pub(super) fn negative(&self) -> usize {
        self.negative.value() as usize
    }

    pub(super) fn definite(&self) -> bool {
        self.negative.at_most(R::zero()).all()
    }

    pub(super) fn history(&mut self, tape: &mut Tape<R>) -> Result<()> {
        tape.number(&mut self.negative)?;
        // What lies behind a column depends on the processor.
        for bounds in self.starts.windows(2) {
            tape.numbers(&mut self.columns[bounds[0]..bounds[1] - overrun::<R>()])?;
        }
        tape.numbers(&mut self.inverse)
    }

    /// Whether the matrix could be factorised stably; if not, it needs pivoting. A right-hand side `x` is
    /// then replaced by the solution: elimination takes it along, while columns are at hand.
    pub(super) fn factor(&mut self, matrix: &BandMatrix<R>, x: Option<&mut [R]>) -> Result<bool> {
        let from = x.as_deref();
        self.begin(from.map(|x| |vector: &mut [R]| vector.copy_from_slice(x)));
        let stable = self.go_on(matrix.profile(), Some(matrix), self.inverse.len());
        if let (Some(x), Ok(true)) = (x, &stable) {
            self.behind = x.len();
            x.copy_from_slice(self.back(matrix.profile(), 0));
        }
        stable
    }

    /// Eliminates as far as the first `lines` allow, in the columns or from a matrix that they are fetched
    /// from.
    fn go_on(
        &mut self,
        profile: &Profile,
        matrix: Option<&BandMatrix<R>>,
        lines: usize,
    ) -> Result<bool> {
        let mut vector = std::mem::take(&mut self.vector);
        let sound = R::dispatch(Factorisation {
            lines,
            reach: profile.reach(),
            matrix,
            x: self.along.then_some(&mut vector[..]),
            ldlt: self,
        });
        self.vector = vector;
        sound
    }

    /// Begins to eliminate in a matrix, of which [`advance`](Self::advance) takes the lines as they come,
    /// along with a right-hand side if one is loaded.
    pub(super) fn begin(&mut self, load: Option<impl FnOnce(&mut [R])>) {
        (self.done, self.seen, self.behind) = (0, 0, 0);
        self.negative = R::zero();
        self.along = load.is_some();
        if let Some(load) = load {
            self.load(load);
        }
    }

    /// Eliminates in the storage of a matrix as far as its first `lines` allow, to which nothing more
    /// may be added. False where the matrix turns out not to be definite: what it holds is then of no
    /// more use.
    pub(super) fn advance(&mut self, matrix: &mut BandMatrix<R>, lines: usize) -> Result<bool> {
        let Some(last) = lines.checked_sub(1) else {
            return Ok(true);
        };
        // What was written there before are factors.
        matrix.write_up_to(last);
        matrix.exchange(&mut self.columns);
        let sound = self.go_on(matrix.profile(), None, lines);
        matrix.exchange(&mut self.columns);
        sound
    }

    /// Takes the storage of a matrix in which all is eliminated for that of the factors. For a right-hand
    /// side that went along, the way [`back`](Self::back) is still to be gone.
    pub(super) fn keep(&mut self, matrix: &mut BandMatrix<R>) {
        matrix.exchange(&mut self.columns);
        matrix.clear();
        if self.along {
            self.behind = self.inverse.len();
        }
    }

    pub(super) fn solve(&mut self, profile: &Profile, x: &mut [R]) {
        self.load(|own| own.copy_from_slice(x));
        self.behind = x.len();
        x.copy_from_slice(self.way::<true>(profile, 0));
    }

    pub(super) fn is_halfway(&self) -> bool {
        self.behind > 0
    }

    /// Finds the unknowns from the last down to `line` at least, as far as they are not found yet: those
    /// from `line` on are what comes back.
    pub(super) fn back(&mut self, profile: &Profile, line: usize) -> &[R] {
        self.way::<false>(profile, line)
    }

    /// Has a right-hand side written to where it is worked on.
    fn load(&mut self, load: impl FnOnce(&mut [R])) {
        let (own, behind) = self.vector.split_at_mut(self.inverse.len());
        load(own);
        // Infinite forces leave what is no number there.
        behind.fill(R::zero());
    }

    /// Solves down to a line, with elimination (`FORWARD`) or after it.
    fn way<const FORWARD: bool>(&mut self, profile: &Profile, line: usize) -> &[R] {
        if self.behind > line {
            let mut vector = std::mem::take(&mut self.vector);
            self.behind = R::dispatch(Solution::<_, FORWARD> {
                ldlt: self,
                reach: profile.reach(),
                lines: line..self.behind,
                x: &mut vector,
            });
            self.vector = vector;
        }
        &self.vector[line..self.inverse.len()]
    }

    /// Whether the pivots of a matrix that may be indefinite can be trusted, by the magnitudes of the
    /// terms they were summed from. Those of a definite one cannot, or they would not come here.
    #[cold]
    #[inline(never)]
    fn watch<const P: usize>(
        &mut self,
        j: usize,
        [before, after]: [[[R; P]; P]; 2],
        matrix: Option<&BandMatrix<R>>,
        definite: bool,
    ) -> Result<bool> {
        let mut negative = R::zero();
        for p in 0..P {
            let pivot = before[p][p];
            if !pivot.finite() {
                return Err(Error::NotFinite {
                    what: "a pivot of the matrix to factorise",
                    value: pivot.value(),
                });
            }
            let Some(matrix) = matrix.filter(|_| !definite) else {
                return Ok(false);
            };
            let terms = self.magnitude[j + p];
            let noise = pivot.abs().at_most(R::lit(NOISE * R::EPSILON) * terms);
            let bound = R::lit(GROWTH) * matrix.largest_of_row(j + p);
            if (noise | !terms.at_most(bound)).any() {
                // A lane that is definite would not have been watched in a run of its own.
                let _ = Mask::among(R::LANES == 1).common();
                return Ok(false);
            }
            negative += R::one().where_else(pivot.at_most(R::zero()), R::zero());
            for i in p + 1..P {
                self.magnitude[j + i] += (before[p][i] * after[p][i]).abs();
            }
        }
        self.negative += negative;
        Ok(true)
    }

    /// Magnitudes of the diagonal terms from row `j` on. Up to there all pivots were positive, so
    /// every term was subtracted with one sign and the magnitudes, which definite matrices need
    /// not keep, follow from the sums.
    fn find_magnitudes(&mut self, j: usize, matrix: &BandMatrix<R>) {
        for i in j..self.inverse.len() {
            let start = matrix.diagonal(i);
            let now = if i < self.seen {
                self.columns[self.starts[i]]
            } else {
                start
            };
            self.magnitude[i] = start.abs() + (start - now).abs();
        }
    }

    /// Eliminates the unknowns `j..j + P`, which are coupled up to row `last`. False if a pivot
    /// cannot be trusted; the columns are then as before.
    #[inline(always)]
    fn eliminate<L: Lanes<R>, const P: usize>(
        &mut self,
        j: usize,
        last: usize,
        matrix: Option<&BandMatrix<R>>,
        definite: bool,
    ) -> Result<bool> {
        let room = self.room;
        let mut before = [[R::zero(); P]; P];
        for p in 0..P {
            let column = &self.columns[self.starts[j + p]..][..P - p];
            before[p][p..].copy_from_slice(column);
        }
        let Pivots {
            before,
            after,
            inverse,
        } = Pivots::of::<L>(before);
        // The least of what the pivots are above nothing and above rounding, and what tells whether all
        // of them are numbers.
        let (mut least, mut sum) = (before[0][0], R::zero());
        for p in 0..P {
            let pivot = before[p][p];
            let noise = R::lit(NOISE * R::EPSILON) * self.diagonal[j + p];
            least = least.smaller(pivot).smaller(pivot - noise);
            sum += pivot;
        }
        if !(definite && sum.finite() && !least.at_most(R::zero()).any()) {
            let triangles = [before, after];
            if !self.watch(j, triangles, matrix, definite)? {
                return Ok(false);
            }
        }
        let starts = &self.starts[j..=last + 1];
        for p in 0..P {
            self.inverse[j + p] = inverse[p];
            for i in p + 1..P {
                self.columns[starts[p] + i - p] = after[p][i];
            }
        }
        let below = last + 1 - (j + P);
        let (pivots, open) =
            self.columns[starts[0]..starts[last + 1 - j]].split_at_mut(starts[P] - starts[0]);
        // Of every column of the panel and of its copy what is below the pivots.
        let reached = below + L::WIDTH - 1;
        let mut scaled: [&mut [R]; P] = std::array::from_fn(|_| Default::default());
        let mut unscaled: [&mut [R]; P] = std::array::from_fn(|_| Default::default());
        let mut rest = pivots;
        for (p, copy) in (0..P).zip(self.panel.chunks_mut(room)) {
            let (column, others) = rest.split_at_mut(starts[p + 1] - starts[p]);
            scaled[p] = &mut column[P - p..][..reached];
            unscaled[p] = &mut copy[..reached];
            rest = others;
        }
        let (mut minus, mut inverses) = ([[L::zero(); P]; P], [L::zero(); P]);
        for p in 0..P {
            inverses[p] = L::lift(inverse[p]);
            for q in 0..p {
                minus[q][p] = L::lift(-before[q][p]);
            }
        }
        let count = reached / L::WIDTH;
        let mut columns: [&mut [L::Block]; P] = std::array::from_fn(|_| Default::default());
        let mut copies: [&mut [L::Block]; P] = std::array::from_fn(|_| Default::default());
        for (p, (column, copy)) in scaled.iter_mut().zip(&mut unscaled).enumerate() {
            columns[p] = first_blocks_mut::<R, L>(column, count);
            copies[p] = first_blocks_mut::<R, L>(copy, count);
        }
        for i in 0..count {
            let mut l = [L::zero(); P];
            for p in 0..P {
                let mut entry = L::load(columns[p][i].as_ref());
                for q in 0..p {
                    entry = entry.plus_product(l[q], minus[q][p]);
                }
                l[p] = entry * inverses[p];
                // With the sign that the columns behind take it with.
                (-entry).store(copies[p][i].as_mut());
                l[p].store(columns[p][i].as_mut());
            }
        }
        let scaled = scaled.map(|column| &*column);
        let unscaled = unscaled.map(|copy| &copy[..below]);
        if !definite {
            for i in 0..below {
                for p in 0..P {
                    self.magnitude[j + P + i] += (scaled[p][i] * unscaled[p][i]).abs();
                }
            }
        }
        // Two columns at a time, which share what is loaded of the pivots'; of the first one row more.
        let mut k = 0;
        while k + 1 < below {
            let (own, next) = (starts[P + k] - starts[P], starts[P + k + 1] - starts[P]);
            let (first, second) = open[own..].split_at_mut(next - own);
            let mut factors = [[L::zero(); P]; 2];
            for (p, unscaled) in unscaled.iter().enumerate() {
                for c in 0..2 {
                    factors[c][p] = L::lift(unscaled[k + c]);
                }
            }
            let mut pivots = [R::zero(); P];
            for (pivot, scaled) in pivots.iter_mut().zip(scaled) {
                *pivot = scaled[k];
            }
            add_one(&mut first[0], &factors[0], &pivots);
            let reached = below - k - 1 + L::WIDTH - 1;
            let count = reached / L::WIDTH;
            let first = first_blocks_mut::<R, L>(&mut first[1..], count);
            let second = first_blocks_mut::<R, L>(second, count);
            let mut columns: [&[L::Block]; P] = [&[]; P];
            for p in 0..P {
                columns[p] = first_blocks::<R, L>(&scaled[p][k + 1..], count);
            }
            for i in 0..count {
                let mut entries = [L::load(first[i].as_ref()), L::load(second[i].as_ref())];
                for p in 0..P {
                    let along = L::load(columns[p][i].as_ref());
                    for c in 0..2 {
                        entries[c] = entries[c].plus_product(along, factors[c][p]);
                    }
                }
                entries[0].store(first[i].as_mut());
                entries[1].store(second[i].as_mut());
            }
            k += 2;
        }
        if k < below {
            let (mut factors, mut pivots) = ([L::zero(); P], [R::zero(); P]);
            for p in 0..P {
                (factors[p], pivots[p]) = (L::lift(unscaled[p][k]), scaled[p][k]);
            }
            add_one(&mut open[starts[P + k] - starts[P]], &factors, &pivots);
        }
        Ok(true)
    }
}

struct Factorisation<'a, R> {
    ldlt: &'a mut Ldlt<R>,
    reach: &'a [usize],
    /// A matrix to factorise, if it is not in the columns already.
    matrix: Option<&'a BandMatrix<R>>,
    /// How many of its lines there are yet.
    lines: usize,
    /// A right-hand side to eliminate from on the way.
    x: Option<&'a mut [R]>,
}

impl<R: Real> LaneWork<R> for Factorisation<'_, R> {
    type Output = Result<bool>;
    const HEAVY: bool = true;

    #[inline(always)]
    fn run<L: Lanes<R>>(self) -> Result<bool> {
        let Self {
            ldlt,
            reach,
            matrix,
            lines,
            mut x,
        } = self;
        assert!(L::WIDTH <= overrun::<R>() + 1, "registers of HEAVY work");
        let mut definite = true;
        // Of what is assembled piece by piece, the next piece is fetched while this one is eliminated.
        let lines = lines.max(ldlt.done);
        let piece = &ldlt.columns[ldlt.starts[ldlt.done]..ldlt.starts[lines]];
        let next = (matrix.is_none() && ahead::far(&ldlt.columns) && !ahead::far(piece))
            .then_some(lines - ldlt.done);
        while let Some(last) = reach.get(ldlt.done).copied().filter(|last| *last < lines) {
            let j = ldlt.done;
            // Columns are fetched just before their first use, while the cache still holds them.
            while ldlt.seen <= last {
                let i = ldlt.seen;
                if let Some(matrix) = matrix {
                    let (start, end) = (ldlt.starts[i], ldlt.starts[i + 1]);
                    let target = &mut ldlt.columns[start..end];
                    target.copy_from_slice(&matrix.line(i)[..end - start]);
                }
                ldlt.diagonal[i] = ldlt.columns[ldlt.starts[i]];
                ldlt.seen += 1;
            }
            let count = usize::from(ldlt.counts[j]);
            if let Some(next) = next
                && let Some(soon) = ldlt.starts.get(j + next..=j + next + count)
            {
                ahead::fetch(&ldlt.columns[soon[0]..soon[count]]);
            }
            loop {
                let trusted = match count {
                    PANEL => ldlt.eliminate::<L, PANEL>(j, last, matrix, definite),
                    2 => ldlt.eliminate::<L, 2>(j, last, matrix, definite),
                    _ => ldlt.eliminate::<L, 1>(j, last, matrix, definite),
                };
                match (trusted?, definite, matrix) {
                    (true, ..) => break,
                    (false, true, Some(matrix)) => ldlt.find_magnitudes(j, matrix),
                    (false, ..) => return Ok(false),
                }
                definite = false;
            }
            if let Some(x) = &mut x {
                match count {
                    PANEL => ldlt.forward::<L, PANEL>(j, last, x),
                    2 => ldlt.forward::<L, 2>(j, last, x),
                    _ => ldlt.forward::<L, 1>(j, last, x),
                }
            }
            ldlt.done += count;
        }
        Ok(true)
    }
}
