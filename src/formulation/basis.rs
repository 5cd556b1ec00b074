//! Nodal vectors by means and differences. Rigid motions and constant strains are in few of them, the
//! others are small where elements are short: energies formed from such vectors lose fewer digits than
//! from the nodal ones, and more of their terms vanish by symmetry.

use super::Tangent;
use crate::element::{Element, NodalVector};
use crate::scalar::{Algebra, Real};
use crate::tensor::{add_scaled, add_times};

/// Adds to one vector a multiple of another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Step<R> {
    pub(super) from: usize,
    pub(super) to: usize,
    pub(super) factor: R,
    pub(super) kind: Kind,
    /// Whether a leading vector has its final value after it.
    pub(super) completes: bool,
}

/// What a step does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// A slope less the first.
    Bend,
    /// To the first slope its share of the difference: their mean in the end.
    Mean,
    /// A position less the first.
    Apart,
    /// Less what a uniform stretch makes of a position.
    Along,
}

/// A change of basis as a sequence of steps, each of which is undone by its opposite.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Basis<R> {
    steps: Vec<Step<R>>,
    /// Mean slopes, and the chord where no slope is along the axis: those that are not zero in a
    /// straight reference.
    leads: Vec<usize>,
}

impl<R: Real> Basis<R> {
    /// Positions relative to the first, less what the mean slope along the axis, or without one the
    /// chord, makes of them; slopes as their mean and what differs from the first.
    pub(super) fn of<E: Element<D, S>, const D: usize, const S: usize>(length: R) -> Self {
        let per_node = E::VECTORS.len();
        let places = |vector: NodalVector| {
            let at = E::VECTORS.iter().position(|v| *v == vector);
            let all = at.map(|at| (at..S).step_by(per_node).collect::<Vec<_>>());
            all.unwrap_or_default()
        };
        let (mut steps, mut leads) = (Vec::<Step<R>>::new(), Vec::new());
        let mut step = |from: usize, to: usize, factor: R, kind: Kind| {
            let completes = false;
            steps.push(Step {
                from,
                to,
                factor,
                kind,
                completes,
            });
        };
        for a in 0..D {
            if let [first, others @ ..] = &places(NodalVector::Slope(a))[..] {
                let share = R::one() / R::lit((others.len() + 1) as f64);
                leads.push(*first);
                for other in others {
                    step(*first, *other, -R::one(), Kind::Bend);
                }
                for other in others {
                    step(*other, *first, share, Kind::Mean);
                }
            }
        }
        if let [first, others @ ..] = &places(NodalVector::Position)[..] {
            for other in others {
                step(*first, *other, -R::one(), Kind::Apart);
            }
            let along = |n: usize| R::lit((n + 1) as f64) / R::lit(others.len() as f64);
            let slope = places(NodalVector::Slope(0)).first().copied();
            match (slope, others) {
                (Some(slope), _) => {
                    for (n, other) in others.iter().enumerate() {
                        step(slope, *other, -(along(n) * length), Kind::Along);
                    }
                }
                (None, [middle @ .., last]) => {
                    leads.push(*last);
                    for (n, other) in middle.iter().enumerate() {
                        step(*last, *other, -along(n), Kind::Along);
                    }
                }
                (None, []) => {}
            }
        }
        for lead in &leads {
            if let Some(last) = steps.iter_mut().rfind(|step| step.to == *lead) {
                last.completes = true;
            }
        }
        Self { steps, leads }
    }

    pub(super) fn steps(&self) -> &[Step<R>] {
        &self.steps
    }

    pub(super) fn leads(&self) -> &[usize] {
        &self.leads
    }

    /// Nodal vectors turned into those of the basis, in place.
    #[inline(always)]
    pub(super) fn change<T: Algebra<R>, const D: usize, const S: usize>(
        &self,
        v: &mut [[T; D]; S],
    ) {
        for Step {
            from, to, factor, ..
        } in &self.steps
        {
            // The minima are identities; they let the optimiser drop the bounds checks.
            let from = v[(*from).min(S - 1)];
            add_times(&mut v[(*to).min(S - 1)], *factor, &from);
        }
    }

    /// Turns a row over nodal vectors into one over the basis. What is left of numbers that cancel is
    /// nothing: a complete element does not feel where its first node is.
    pub(super) fn change_row<const S: usize>(&self, row: &mut [R; S]) {
        let mut sizes = row.map(|a| a.abs());
        for Step {
            from, to, factor, ..
        } in &self.steps
        {
            let (value, size) = (row[*to], sizes[*to]);
            row[*from] -= *factor * value;
            sizes[*from] += factor.abs() * size;
        }
        for (a, size) in row.iter_mut().zip(sizes) {
            let nothing = a.abs().at_most(size * R::lit(64.0 * R::EPSILON));
            *a = R::zero().where_else(nothing, *a);
        }
    }

    /// Forces on the vectors of the basis turned into those on nodal vectors, in place.
    #[inline(always)]
    pub(super) fn change_force<T: Algebra<R>, const D: usize, const S: usize>(
        &self,
        q: &mut [[T; D]; S],
    ) {
        for Step {
            from, to, factor, ..
        } in self.steps.iter().rev()
        {
            let to = q[(*to).min(S - 1)];
            add_times(&mut q[(*from).min(S - 1)], *factor, &to);
        }
    }

    /// The blocks `k[i][..][j]`, `i <= j`, of a symmetric tangent by vectors of the basis turned into
    /// those by nodal vectors, in place.
    #[inline(always)]
    pub(super) fn change_upper<T: Algebra<R>, const D: usize, const S: usize>(
        &self,
        k: &mut Tangent<T, D, S>,
    ) {
        for Step {
            from, to, factor, ..
        } in self.steps.iter().rev()
        {
            let (from, to) = ((*from).min(S - 1), (*to).min(S - 1));
            let (low, high) = (from.min(to), from.max(to));
            // The diagonal block gains the column as it was and the row as it is then.
            add_block(k, *factor, (to, from), (from, from));
            // Of the others either both are stored as they are, or both by the rows they are columns
            // of, or one by the columns of the other.
            for j in 0..low {
                for row in &mut k[j] {
                    let value = row[to];
                    add_times(&mut row[from], *factor, &value);
                }
            }
            for j in (low..high).filter(|j| *j != from) {
                add_block(k, *factor, (to, j), (from, j));
            }
            for j in (high..S).filter(|j| *j != from) {
                for c in 0..D {
                    let value = k[to][c][j];
                    add_times(&mut k[from][c][j], *factor, &value);
                }
            }
            add_block(k, *factor, (from, to), (from, from));
        }
    }

    /// The same for a tangent that need not be symmetric.
    #[inline(always)]
    pub(super) fn change_tangent<T: Algebra<R>, const D: usize, const S: usize>(
        &self,
        k: &mut Tangent<T, D, S>,
    ) {
        let factor = |step: &Step<R>| T::lift(step.factor);
        for step in self.steps.iter().rev() {
            let (from, to) = (step.from.min(S - 1), step.to.min(S - 1));
            for c in 0..D {
                for j in 0..S {
                    let value = k[to][c][j];
                    add_scaled(&mut k[from][c][j], factor(step), &value);
                }
            }
            for row in k.as_flattened_mut() {
                let column = row[to];
                add_scaled(&mut row[from], factor(step), &column);
            }
        }
    }
}

/// Adds a multiple of one block of a symmetric tangent, of which those with `i <= j` are stored, to
/// another.
#[inline(always)]
fn add_block<R: Real, T: Algebra<R>, const D: usize, const S: usize>(
    k: &mut Tangent<T, D, S>,
    factor: R,
    from: (usize, usize),
    to: (usize, usize),
) {
    for c in 0..D {
        for d in 0..D {
            let value = match from.0 <= from.1 {
                true => k[from.0][c][from.1][d],
                false => k[from.1][d][from.0][c],
            };
            let sum = match to.0 <= to.1 {
                true => &mut k[to.0][c][to.1][d],
                false => &mut k[to.1][d][to.0][c],
            };
            *sum = sum.plus_times(factor, value);
        }
    }
}
