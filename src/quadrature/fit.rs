//! Moment fitting: a positive rule with few points for a region of which only the moments and a
//! dense positive sample are known. At most as many points as moments are chosen from the sample
//! in two ways, by a linear program whose cost makes them gather about the points of a Gauss rule
//! (Ryu and Boyd 2015), and by handing weights on, after Caratheodory's theorem. From each choice
//! points are taken away one by one while Gauss and Newton's method finds positions and weights
//! of the others that carry the moments (Xiao and Gimbutas 2010); the rule with fewer points is
//! taken. All decisions are made in double precision; the moments are met in twice the working
//! one.

use std::ops::{Add, Mul, Sub};

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::twofold::Twofold;
use crate::error::{Error, Result};
use crate::scalar::Real;

/// Points with their weights, before rounding.
pub(crate) type Weighted<R> = Vec<([Twofold<R>; 2], Twofold<R>)>;

/// A region in coordinates of order one.
pub(crate) struct Shape<R, F> {
    /// Total degree of the polynomials to integrate.
    pub(crate) degree: usize,
    /// Points in the region with positive weights that nearly have the moments.
    pub(crate) candidates: Vec<([f64; 2], f64)>,
    /// Integrals of the products of Chebyshev polynomials, in the order of [`pairs`].
    pub(crate) moments: Vec<Twofold<R>>,
    /// Whether a point is within the region.
    pub(crate) inside: F,
}

/// Exponents or orders `(a, b)` of total degree up to `degree`.
pub(crate) fn pairs(degree: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..=degree).flat_map(|d| (0..=d).map(move |b| (d - b, b)))
}

/// Chebyshev polynomials at `x` from order 0 to `n`: of the first kind when `first` is `x`, of
/// the second when it is `2 x`. No division, so the polynomials are the same in every type.
pub(crate) fn chebyshev<T>(one: T, x: T, first: T, n: usize) -> Vec<T>
where
    T: Copy + Add<Output = T> + Sub<Output = T> + Mul<Output = T>,
{
    let mut values = vec![one, first];
    for k in 1..n {
        values.push((x + x) * values[k] - values[k - 1]);
    }
    values
}

#[derive(Debug, Clone, Copy)]
struct Node {
    x: [f64; 2],
    w: f64,
}

/// Degree to which points are taken away beyond Caratheodory's theorem. The work grows with the
/// eighth power of the degree: here it takes up to a quarter of a second, once for a beam.
const THINNED: usize = 8;

/// Most work of a step of the linear program, as candidates times the square of moments, for it
/// to be tried: some 30 ms in all. Larger programs have not paid.
const PROGRAMMED: usize = 1_500_000;

/// Share of chance in the costs of the linear program: enough to tell mirror images apart.
const CHANCE: f64 = 0.1;

/// Weights of the linear program that count as zero, relative to the largest.
const ABSENT: f64 = 1e-6;

/// A rule of positive weights with its points in the region, in the coordinates of `shape`.
pub(crate) fn fit<R: Real, F: Fn([f64; 2]) -> bool>(shape: Shape<R, F>) -> Result<Weighted<R>> {
    let failed = |cause| Error::NoRule {
        degree: shape.degree,
        cause,
        remedy: "lower the degree, or thicken the thinnest walls",
    };
    let fitting = Fitting::new(&shape).ok_or(failed("its moments are not independent"))?;
    let programmed = fitting.programmed().and_then(|v| fitting.rule(v).ok());
    match programmed {
        Some(rule) if rule.len() <= fitting.fewest() => Ok(rule),
        Some(rule) => match fitting.rule(fitting.exchanged(&shape.candidates)) {
            Ok(other) if other.len() < rule.len() => Ok(other),
            _ => Ok(rule),
        },
        None => fitting
            .rule(fitting.exchanged(&shape.candidates))
            .map_err(failed),
    }
}

struct Fitting<'a, R, F> {
    shape: &'a Shape<R, F>,
    /// Moments in double precision.
    target: DVector<f64>,
    /// Lower triangle that turns the polynomials into orthonormal ones: in a thin-walled
    /// section some polynomials are very small everywhere in the material.
    lower: DMatrix<f64>,
}

impl<'a, R: Real, F: Fn([f64; 2]) -> bool> Fitting<'a, R, F> {
    fn new(shape: &'a Shape<R, F>) -> Option<Self> {
        let target = shape.moments.iter().map(|m| m.round().value());
        let target = DVector::from_iterator(shape.moments.len(), target);
        let mut weighted = values(shape.degree, shape.candidates.iter().map(|c| c.0));
        for (mut column, (_, w)) in weighted.column_iter_mut().zip(&shape.candidates) {
            column *= w.sqrt();
        }
        if weighted.ncols() < weighted.nrows() {
            return None;
        }
        let lower = weighted.transpose().qr().r().transpose();
        let diagonal = lower.diagonal().map(f64::abs);
        (diagonal.min() > 1e-13 * diagonal.max()).then_some(Self {
            shape,
            target,
            lower,
        })
    }

    /// Rows of `matrix` for the polynomials turned into rows for the orthonormal ones.
    fn orthonormal(&self, matrix: &DMatrix<f64>) -> DMatrix<f64> {
        let mut rows = matrix.clone();
        // The diagonal has been checked, so there always is a solution.
        self.lower.solve_lower_triangular_mut(&mut rows);
        rows
    }

    /// No rule has fewer points than there are polynomials of half the degree: the square of one
    /// that is zero at all points has a positive integral.
    fn fewest(&self) -> usize {
        pairs(self.shape.degree / 2).count()
    }

    /// The rule that a choice of points leads to, or why there is none.
    fn rule(&self, vertex: Vec<Node>) -> std::result::Result<Weighted<R>, &'static str> {
        let settled = self.settled(vertex);
        let mut nodes = settled.ok_or("positions and weights do not settle on the moments")?;
        if self.shape.degree <= THINNED {
            nodes = self.thinned(nodes);
        }
        let rule = self.polished(&nodes);
        let sound = |(x, w): &([Twofold<R>; 2], Twofold<R>)| {
            w.round() > R::zero() && (self.shape.inside)(x.map(|x| x.round().value()))
        };
        let sound = rule.iter().all(sound);
        sound
            .then_some(rule)
            .ok_or("the last digits drive a point out of the material")
    }

    /// At most as many points as moments, chosen among the candidates by a linear program: of
    /// all nonnegative weights with the moments, those with the least mean square of the
    /// orthonormal polynomials of the degree beyond half. On a line that mean is zero for the
    /// Gauss rule alone; in the plane it draws the points together where a rule of few points
    /// has them. A share of chance in the cost, the same at every call, makes the answer unique
    /// in symmetric sections. None if the program is too large, has no such polynomials, would not
    /// be followed by thinning, or is not solved.
    fn programmed(&self) -> Option<Vec<Node>> {
        let Shape {
            degree, candidates, ..
        } = self.shape;
        let (m, n) = (self.target.len(), candidates.len());
        let work = n.saturating_mul(m).saturating_mul(m);
        if *degree == 0 || *degree > THINNED || work > PROGRAMMED {
            return None;
        }
        let columns = self.orthonormal(&values(*degree, candidates.iter().map(|c| c.0)));
        // Equations of unit rows: the unknowns are weights over the roots of those that the
        // candidates have, in units that make the right-hand side a unit vector.
        let mut moments = self.target.clone();
        self.lower.solve_lower_triangular_mut(&mut moments);
        let unit = moments.norm();
        let roots: Vec<f64> = candidates.iter().map(|c| c.1.sqrt()).collect();
        let top = pairs(*degree).map(|(a, b)| a + b == degree / 2 + 1);
        let top: Vec<usize> = top.enumerate().filter(|t| t.1).map(|t| t.0).collect();
        let mut state = 1_u64;
        let costs: Vec<f64> = (columns.column_iter().zip(&roots))
            .map(|(column, root)| {
                // Knuth's linear congruential generator.
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                let chance = (state >> 32) as f64 / f64::from(u32::MAX);
                let square: f64 = top.iter().map(|&k| column[k] * column[k]).sum();
                self.target[0] * square * (1.0 + CHANCE * chance) * root
            })
            .collect();
        // The dual program has few unknowns, one for each moment, and the weights as the
        // multipliers of its inequalities.
        let entries: Vec<f64> = (columns.row_iter())
            .flat_map(|row| {
                row.iter()
                    .zip(&roots)
                    .map(|(x, r)| x * r)
                    .collect::<Vec<_>>()
            })
            .collect();
        let unknowns = CscMatrix::new(
            n,
            m,
            (0..=m).map(|k| k * n).collect(),
            (0..m).flat_map(|_| 0..n).collect(),
            entries,
        );
        let settings = DefaultSettings {
            verbose: false,
            max_iter: 60,
            max_threads: 1,
            direct_solve_method: "qdldl".into(),
            ..DefaultSettings::default()
        };
        let mut solver = DefaultSolver::new(
            &CscMatrix::zeros((m, m)),
            (-moments / unit).as_slice(),
            &unknowns,
            &costs,
            &[NonnegativeConeT(n)],
            settings,
        )
        .ok()?;
        solver.solve();
        let solution = &solver.solution;
        if !matches!(
            solution.status,
            SolverStatus::Solved | SolverStatus::AlmostSolved
        ) {
            return None;
        }
        let weight = |j: usize| unit * roots[j] * solution.z[j];
        let least = ABSENT * (0..n).map(weight).fold(0.0, f64::max);
        let support: Vec<_> = (0..n)
            .filter(|&j| weight(j) > least)
            .map(|j| (candidates[j].0, weight(j)))
            .collect();
        Some(if support.len() > m {
            self.exchanged(&support)
        } else {
            support.into_iter().map(|(x, w)| Node { x, w }).collect()
        })
    }

    /// As many points as moments, chosen among the candidates so that the moments stay.
    fn exchanged(&self, candidates: &[([f64; 2], f64)]) -> Vec<Node> {
        let places = candidates.iter().map(|c| c.0);
        let columns = self.orthonormal(&values(self.shape.degree, places));
        let (m, n) = columns.shape();
        let weight = |j: usize| candidates[j].1;

        // To begin with, columns far from one another: pivoted Gram-Schmidt.
        let mut rest = columns.clone();
        for (j, mut column) in rest.column_iter_mut().enumerate() {
            column *= weight(j).sqrt();
        }
        let mut support: Vec<usize> = Vec::with_capacity(m);
        for _ in 0..m {
            let norms = rest.column_iter().map(|c| c.norm_squared());
            let Some((best, norm)) = norms.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)) else {
                break;
            };
            support.push(best);
            let axis = rest.column(best) / norm.sqrt();
            let along = rest.tr_mul(&axis);
            rest.ger(-1.0, &axis, &along, 1.0);
            rest.column_mut(best).fill(0.0);
        }
        let chosen = columns.select_columns(&support);
        let mut weights: Vec<f64> = support.iter().map(|&j| weight(j)).collect();
        let mut kept = vec![false; n];
        support.iter().for_each(|&j| kept[j] = true);
        let Some(mut inverse) = chosen.try_inverse() else {
            return (0..n)
                .map(|j| Node {
                    x: candidates[j].0,
                    w: weight(j),
                })
                .collect();
        };
        // Every other point hands its weight to those; where one of them would turn negative
        // the point takes its place instead.
        for j in (0..n).filter(|&j| !kept[j]) {
            let share = &inverse * columns.column(j);
            let mut most = weight(j);
            let mut leaving = None;
            for i in 0..m {
                if share[i] < -1e-9 && weights[i] < -most * share[i] {
                    (most, leaving) = (-weights[i] / share[i], Some(i));
                }
            }
            for i in 0..m {
                weights[i] = (weights[i] + most * share[i]).max(0.0);
            }
            if let Some(i) = leaving {
                (support[i], weights[i]) = (j, weight(j) - most);
                let row = inverse.row(i) / share[i];
                let mut others = share;
                others[i] = 0.0;
                inverse.row_mut(i).copy_from(&row);
                inverse.ger(-1.0, &others, &row.transpose(), 1.0);
            }
        }
        let pairs = support.iter().zip(weights);
        pairs
            .filter(|&(_, w)| w > 0.0)
            .map(|(&j, w)| Node {
                x: candidates[j].0,
                w,
            })
            .collect()
    }

    /// Derivatives of the moments by relative changes of the weights and by the positions, for
    /// the orthonormal polynomials, and the factors of its Gram matrix; none if the rule cannot
    /// follow every change of the moments.
    fn linearised(&self, nodes: &[Node]) -> Option<(DMatrix<f64>, Cholesky<f64, Dyn>)> {
        let rows = self.orthonormal(&gradients(self.shape.degree, nodes));
        let gram = Cholesky::new(&rows * rows.transpose())?;
        // What the weights alone contribute to a pivot; positions may add far more in thin walls.
        let usual = (self.target[0].abs() / nodes.len() as f64).sqrt();
        (gram.l_dirty().diagonal().min() > 3e-3 * usual).then_some((rows, gram))
    }

    /// The rule near the given one that has the moments, by Gauss and Newton's method.
    fn settled(&self, mut nodes: Vec<Node>) -> Option<Vec<Node>> {
        let mut last = f64::INFINITY;
        for _ in 0..20 {
            let places = nodes.iter().map(|n| n.x);
            let weights = DVector::from_iterator(nodes.len(), nodes.iter().map(|n| n.w));
            let defect = &self.target - values(self.shape.degree, places) * weights;
            let size = defect.amax();
            if size <= 1e-14 * self.target[0].abs() {
                return self.linearised(&nodes).map(|_| nodes);
            }
            if size > 4.0 * last {
                return None;
            }
            last = size;
            let (rows, gram) = self.linearised(&nodes)?;
            let mut rhs = defect;
            self.lower.solve_lower_triangular_mut(&mut rhs);
            let step = rows.tr_mul(&gram.solve(&rhs));
            // A point that would leave the region goes part of its way, or stays.
            for (i, node) in nodes.iter_mut().enumerate() {
                let [w, y, z] = [0, 1, 2].map(|c| step[3 * i + c]);
                let part = |part: f64| [node.x[0] + part * y, node.x[1] + part * z];
                let parts = [1.0, 0.5, 0.25, 0.125].map(part).into_iter();
                if let Some(x) = parts.into_iter().find(|&x| (self.shape.inside)(x)) {
                    node.x = x;
                }
                node.w *= (1.0 + w).max(0.1);
            }
        }
        None
    }

    /// The rule without all the points that can be spared, the least important first.
    fn thinned(&self, mut nodes: Vec<Node>) -> Vec<Node> {
        let m = self.target.len();
        let fewest = self.fewest();
        'fewer: while nodes.len() > fewest && 3 * (nodes.len() - 1) >= m {
            let columns = values(self.shape.degree, nodes.iter().map(|n| n.x));
            let columns = self.orthonormal(&columns);
            let weight = |i: usize| nodes[i].w * columns.column(i).norm_squared();
            let mut order: Vec<usize> = (0..nodes.len()).collect();
            order.sort_by(|&i, &j| weight(i).total_cmp(&weight(j)));
            for i in order {
                let mut fewer = nodes.clone();
                fewer.remove(i);
                if let Some(fewer) = self.settled(fewer) {
                    nodes = fewer;
                    continue 'fewer;
                }
            }
            break;
        }
        nodes
    }

    /// The rule with its moments exact in twice the working precision, derivatives included.
    fn polished(&self, nodes: &[Node]) -> Weighted<R> {
        let degree = self.shape.degree;
        let mut rule: Weighted<R> = nodes
            .iter()
            .map(|node| (node.x.map(Twofold::lit), Twofold::lit(node.w)))
            .collect();
        let Some((rows, gram)) = self.linearised(nodes) else {
            return rule;
        };
        // The change of the rule per change of the moments, as constants: each step settles
        // another order of derivatives.
        let mut inverse = gram.solve(&rows).transpose();
        let upper = self.lower.transpose();
        let mut transposed = inverse.transpose();
        upper.solve_upper_triangular_mut(&mut transposed);
        inverse.copy_from(&transposed.transpose());
        for _ in 0..5 {
            let mut defect = self.shape.moments.clone();
            for &([u, v], w) in &rule {
                let one = Twofold::lit(1.0);
                let (u, v) = (chebyshev(one, u, u, degree), chebyshev(one, v, v, degree));
                for (d, (a, b)) in defect.iter_mut().zip(pairs(degree)) {
                    *d = *d - u[a] * v[b] * w;
                }
            }
            let defect: Vec<R> = defect.iter().map(|d| d.round()).collect();
            let change = |row: usize| {
                let terms = defect.iter().enumerate();
                let sum = terms.fold(R::zero(), |sum, (k, &d)| {
                    sum + d * R::lit(inverse[(row, k)])
                });
                Twofold::new(sum)
            };
            for (i, (x, w)) in rule.iter_mut().enumerate() {
                *w = *w + change(3 * i) * Twofold::lit(nodes[i].w);
                *x = [0, 1].map(|c| x[c] + change(3 * i + 1 + c));
            }
        }
        rule
    }
}

/// Values of all polynomials, one column for each point.
fn values(degree: usize, points: impl ExactSizeIterator<Item = [f64; 2]>) -> DMatrix<f64> {
    let mut values = DMatrix::zeros(pairs(degree).count(), points.len());
    for (mut column, [u, v]) in values.column_iter_mut().zip(points) {
        let (u, v) = (chebyshev(1.0, u, u, degree), chebyshev(1.0, v, v, degree));
        for (value, (a, b)) in column.iter_mut().zip(pairs(degree)) {
            *value = u[a] * v[b];
        }
    }
    values
}

/// Derivatives of the moments, three columns for each point: by the logarithm of its weight and
/// by its two coordinates.
fn gradients(degree: usize, nodes: &[Node]) -> DMatrix<f64> {
    let mut gradients = DMatrix::zeros(pairs(degree).count(), 3 * nodes.len());
    let slopes = |x: f64| {
        // The derivative of the first kind is of the second kind.
        let second = chebyshev(1.0, x, 2.0 * x, degree);
        let slope = |k: usize| {
            if k == 0 {
                0.0
            } else {
                k as f64 * second[k - 1]
            }
        };
        (0..=degree).map(slope).collect::<Vec<_>>()
    };
    for (i, &Node { x: [u, v], w }) in nodes.iter().enumerate() {
        let (du, dv) = (slopes(u), slopes(v));
        let (u, v) = (chebyshev(1.0, u, u, degree), chebyshev(1.0, v, v, degree));
        for (row, (a, b)) in pairs(degree).enumerate() {
            gradients[(row, 3 * i)] = w * u[a] * v[b];
            gradients[(row, 3 * i + 1)] = w * du[a] * v[b];
            gradients[(row, 3 * i + 2)] = w * u[a] * dv[b];
        }
    }
    gradients
}
