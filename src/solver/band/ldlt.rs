//! Factorisation `L D L^T` of symmetric matrices without pivoting. This is where a simulation of
//! a long chain spends its time, hence the form: pivots are eliminated four at a time, and whole
//! columns are updated in the widest registers of the processor.

mod elimination;
mod solution;

use super::aligned::Aligned;
use super::blocks::SUMS;
use super::columns::{PANEL, Panel, column_starts, overrun, panels};
use super::{BandMatrix, Profile, ahead};
use crate::error::Result;
use crate::scalar::{LaneWork, Lanes, Real};
use crate::solver::Tape;
use solution::Solution;

/// Rounding units below which a pivot is taken for rounding of the terms it was summed from: each
/// panel of pivots before it adds up to two, half of them of one sign or the other.
pub(in crate::solver) const NOISE: f64 = 8.0;

/// Growth of a diagonal term over the largest entry of its row that is still accepted. The
/// backward error is at most this many rounding units; definite matrices never exceed 2, and
/// saddle points whose stiffness block is definite stay of that order.
pub(in crate::solver) const GROWTH: f64 = 256.0;

#[derive(Debug, Clone)]
pub(super) struct Ldlt<R> {
    /// Columns of `L` below the reciprocals of the pivots, where [`Panel`] has them start. Behind
    /// the last row of each are zeros, above its diagonal anything: registers reach there.
    columns: Aligned<R>,
    /// Unknowns that are eliminated together: their reach is the same, so that they share their rows.
    panels: Vec<Panel>,
    /// How many are eliminated together with each one.
    counts: Vec<u8>,
    /// How many panels are eliminated, and how many columns that has touched.
    done: usize,
    seen: usize,
    /// Whether a right-hand side is eliminated along with a matrix that is assembled.
    along: bool,
    /// How many panels are still to be found from those behind them.
    behind: usize,
    /// The matrix's diagonal, as far as columns were touched.
    diagonal: Vec<R>,
    /// Columns of the current pivots below them, before division by the pivot and with the other sign,
    /// zeros behind each.
    panel: Aligned<R>,
    /// Room for one of them and a register of zeros.
    room: usize,
    /// Sum of the magnitudes of all terms of a diagonal entry: its rounding is a few units of it.
    magnitude: Vec<R>,
    /// The vector being solved for, and zeros behind it.
    vector: Aligned<R>,
    negative: R,
}

impl<R: Real> Ldlt<R> {
    pub(super) fn new(profile: &Profile) -> Self {
        let (size, half) = (profile.size(), profile.half_bandwidth());
        let panels = panels::<R>(profile);
        let mut counts = Vec::with_capacity(size);
        for pair in panels.windows(2) {
            let count = pair[1].first - pair[0].first;
            counts.resize(counts.len() + count, count as u8);
        }
        let width = overrun::<R>() + 1;
        let room = half.next_multiple_of(width) + width;
        Self {
            columns: Aligned::zero(panels[panels.len() - 1].at),
            panels,
            counts,
            done: 0,
            seen: 0,
            along: false,
            behind: 0,
            diagonal: vec![R::zero(); size],
            room,
            panel: Aligned::zero(PANEL * room),
            magnitude: vec![R::zero(); size],
            vector: Aligned::zero(size + SUMS - 1),
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
        // What lies between columns depends on the type of registers that they are made for, and a matrix
        // that could not be factorised leaves what is no number there.
        let starts = column_starts::<R>(&self.panels);
        for pair in self.panels.windows(2) {
            let end = pair[1].first + pair[0].below;
            for j in pair[0].first..pair[1].first {
                let column = &mut self.columns[starts[j]..starts[j + 1]];
                let (own, between) = column.split_at_mut(end - j);
                tape.numbers(own)?;
                between.fill(R::zero());
            }
        }
        Ok(())
    }

    /// Whether the matrix could be factorised stably; if not, it needs pivoting. A right-hand side `x` is
    /// then replaced by the solution: elimination takes it along, while columns are at hand.
    pub(super) fn factor(&mut self, matrix: &BandMatrix<R>, x: Option<&mut [R]>) -> Result<bool> {
        let from = x.as_deref();
        self.begin(from.map(|x| |vector: &mut [R]| vector.copy_from_slice(x)));
        let stable = self.go_on(matrix.starts(), Some(matrix), matrix.size());
        if let (Some(x), Ok(true)) = (x, &stable) {
            self.turn();
            x.copy_from_slice(self.back(0));
        }
        stable
    }

    /// Eliminates as far as the first `lines` allow, in the columns or from a matrix that they are fetched
    /// from.
    fn go_on(
        &mut self,
        starts: &[usize],
        matrix: Option<&BandMatrix<R>>,
        lines: usize,
    ) -> Result<bool> {
        let mut vector = std::mem::take(&mut self.vector);
        let sound = R::dispatch(Factorisation {
            lines,
            starts,
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
        let sound = self.go_on(matrix.starts(), None, lines);
        matrix.exchange(&mut self.columns);
        sound
    }

    /// Takes the storage of a matrix in which all is eliminated for that of the factors. For a right-hand
    /// side that went along, the way [`back`](Self::back) is still to be gone.
    pub(super) fn keep(&mut self, matrix: &mut BandMatrix<R>) {
        matrix.exchange(&mut self.columns);
        matrix.clear();
        if self.along {
            self.turn();
        }
    }

    /// Turns to the way back.
    fn turn(&mut self) {
        self.behind = self.panels.len() - 1;
    }

    pub(super) fn solve(&mut self, x: &mut [R]) {
        self.load(|own| own.copy_from_slice(x));
        self.turn();
        x.copy_from_slice(self.way::<true>(0));
    }

    pub(super) fn is_halfway(&self) -> bool {
        self.behind > 0
    }

    /// Finds the unknowns from the last down to `line` at least, as far as they are not found yet: those
    /// from `line` on are what comes back.
    pub(super) fn back(&mut self, line: usize) -> &[R] {
        self.way::<false>(line)
    }

    /// Has a right-hand side written to where it is worked on.
    fn load(&mut self, load: impl FnOnce(&mut [R])) {
        let (own, behind) = self.vector.split_at_mut(self.diagonal.len());
        load(own);
        // Infinite forces leave what is no number there.
        behind.fill(R::zero());
    }

    /// Solves down to a line, with elimination (`FORWARD`) or after it.
    fn way<const FORWARD: bool>(&mut self, line: usize) -> &[R] {
        if self.panels[self.behind].first > line {
            let mut vector = std::mem::take(&mut self.vector);
            self.behind = R::dispatch(Solution::<_, FORWARD> {
                ldlt: self,
                line,
                x: &mut vector,
            });
            self.vector = vector;
        }
        &self.vector[line..self.diagonal.len()]
    }

    /// Magnitudes of the diagonal terms from row `j` on. Up to there all pivots were positive, so
    /// every term was subtracted with one sign and the magnitudes, which definite matrices need
    /// not keep, follow from the sums.
    fn find_magnitudes(&mut self, j: usize, matrix: &BandMatrix<R>) {
        let starts = matrix.starts();
        for i in j..self.diagonal.len() {
            let start = matrix.diagonal(i);
            let now = if i < self.seen {
                self.columns[starts[i]]
            } else {
                start
            };
            self.magnitude[i] = start.abs() + (start - now).abs();
        }
    }
}

struct Factorisation<'a, R> {
    ldlt: &'a mut Ldlt<R>,
    /// Where the columns start.
    starts: &'a [usize],
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
            starts,
            matrix,
            lines,
            mut x,
        } = self;
        let fits = (overrun::<R>() + 1).is_multiple_of(L::WIDTH);
        assert!(fits, "registers of HEAVY work");
        let mut definite = true;
        // Of what is assembled piece by piece, the next piece is fetched while this one is eliminated.
        let mut j = ldlt.panels[ldlt.done].first;
        let lines = lines.max(j);
        let piece = &ldlt.columns[starts[j]..starts[lines]];
        let next = (matrix.is_none() && ahead::far(&ldlt.columns) && !ahead::far(piece))
            .then_some(lines - j);
        while let Some(behind) = ldlt.panels.get(ldlt.done + 1).map(|panel| panel.first) {
            let panel = ldlt.panels[ldlt.done];
            let (count, end) = (behind - j, behind + panel.below);
            if end > lines {
                break;
            }
            // Columns are fetched just before their first use, while the cache still holds them.
            while ldlt.seen < end {
                let i = ldlt.seen;
                if let Some(matrix) = matrix {
                    let target = &mut ldlt.columns[starts[i]..starts[i + 1]];
                    target.copy_from_slice(&matrix.line(i)[..starts[i + 1] - starts[i]]);
                }
                ldlt.diagonal[i] = ldlt.columns[starts[i]];
                ldlt.seen += 1;
            }
            if let Some(next) = next
                && let Some(soon) = starts.get(j + next..=j + next + count)
            {
                ahead::fetch(&ldlt.columns[soon[0]..soon[count]]);
            }
            let starts = &starts[j..=end];
            loop {
                let trusted = match count {
                    PANEL => ldlt.eliminate::<L, PANEL>(j, starts, matrix, definite),
                    2 => ldlt.eliminate::<L, 2>(j, starts, matrix, definite),
                    _ => ldlt.eliminate::<L, 1>(j, starts, matrix, definite),
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
                    PANEL => ldlt.forward::<L, PANEL>(panel, x),
                    2 => ldlt.forward::<L, 2>(panel, x),
                    _ => ldlt.forward::<L, 1>(panel, x),
                }
            }
            ldlt.done += 1;
            j = behind;
        }
        Ok(true)
    }
}
