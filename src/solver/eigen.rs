//! The dominant eigenpairs of an operator that is self-adjoint in a metric, by subspace iteration
//! with full orthogonalisation (K. J. Bathe, *Finite Element Procedures*, 1996, section 11.6). A
//! block of vectors is iterated at once, so equal eigenvalues, which every circular section has,
//! come out with all their vectors; and nothing but field operations is used, so they come in any
//! [`Real`] number type, derivatives included.

use crate::error::{Error, Result};
use crate::scalar::Real;

/// An operator `A` with `P A` symmetric for a positive definite metric `P`.
pub(super) trait Operator<R> {
    /// Length of the vectors.
    fn size(&self) -> usize;
    /// Dimension of what the operator leads to.
    fn rank(&self) -> usize {
        self.size()
    }
    /// `y = A x`.
    fn apply(&mut self, x: &[R], y: &mut [R]) -> Result<()>;
    /// `y = P x`.
    fn metric(&mut self, x: &[R], y: &mut [R]) -> Result<()>;
}

/// An eigenpair, its vector of unit length in the metric.
pub(super) struct Pair<R> {
    pub(super) value: R,
    pub(super) vector: Vec<R>,
    /// `|A x - value x|` in the metric, over `|value|`.
    pub(super) residual: f64,
}

/// When to stop.
pub(super) struct Goal {
    pub(super) count: usize,
    /// Residual asked for; the one that rounding leaves is accepted above it.
    pub(super) tolerance: f64,
    pub(super) iterations: usize,
}

/// Rounds without halving the residual after which it has stopped falling.
const PATIENCE: usize = 6;

/// The `goal.count` eigenpairs of largest magnitude, in descending order. `adapt` sees the
/// eigenvalues after every round and may change the operator for another of the same vectors.
///
/// # Errors
/// [`Error::Unconverged`], and those of the operator.
pub(super) fn dominant<R: Real, O: Operator<R>>(
    operator: &mut O,
    goal: &Goal,
    mut adapt: impl FnMut(&mut O, &[R]) -> Result<()>,
) -> Result<Vec<Pair<R>>> {
    let count = goal.count;
    let mut block = Block::random(operator, count + count.max(8))?;
    // Derivatives follow the value one round behind, each order one more.
    let mut extra = R::ORDER;
    let (mut marked, mut since) = (f64::INFINITY, 0);
    for round in 0.. {
        block.rotate(operator)?;
        let worst = block.residuals[..count].iter().copied().fold(0.0, f64::max);
        since += 1;
        if worst < 0.5 * marked {
            (marked, since) = (worst, 0);
        }
        let floor = since >= PATIENCE && worst < 100.0 * R::EPSILON.sqrt();
        if worst <= goal.tolerance || floor {
            if extra == 0 {
                break;
            }
            extra -= 1;
        } else if round >= goal.iterations || worst.is_nan() {
            return Err(Error::Unconverged {
                reason: "the eigenvectors have not settled",
                iterations: round,
                residual: worst,
            });
        }
        adapt(operator, &block.values)?;
        block.advance(operator)?;
    }
    let vectors = block.vectors.into_iter().take(count);
    let values = block.values.into_iter().zip(block.residuals);
    let pairs = vectors.zip(values);
    Ok(pairs
        .map(|(vector, (value, residual))| Pair {
            value,
            vector,
            residual,
        })
        .collect())
}

/// Vectors `x`, orthonormal in the metric, with `P x` and `A x`.
struct Block<R> {
    vectors: Vec<Vec<R>>,
    metrics: Vec<Vec<R>>,
    images: Vec<Vec<R>>,
    values: Vec<R>,
    residuals: Vec<f64>,
    random: Random,
}

impl<R: Real> Block<R> {
    fn random<O: Operator<R>>(operator: &mut O, count: usize) -> Result<Self> {
        let size = operator.size();
        let count = count.min(operator.rank());
        let vectors = || vec![vec![R::zero(); size]; count];
        let mut random = Random(0x9e37_79b9_7f4a_7c15);
        let mut images = vectors();
        images.iter_mut().for_each(|x| random.fill(x));
        let mut block = Self {
            vectors: vectors(),
            metrics: vectors(),
            images,
            values: vec![R::zero(); count],
            residuals: vec![0.0; count],
            random,
        };
        block.advance(operator)?;
        Ok(block)
    }

    /// Makes the images the next vectors: orthonormal in the metric by Gram and Schmidt, twice.
    fn advance<O: Operator<R>>(&mut self, operator: &mut O) -> Result<()> {
        std::mem::swap(&mut self.vectors, &mut self.images);
        for k in 0..self.vectors.len() {
            let (before, rest) = self.vectors.split_at_mut(k);
            let (earlier, metric) = self.metrics.split_at_mut(k);
            let (x, metric) = (&mut rest[0], &mut metric[0]);
            // A vector that depends on the earlier ones leaves rounding: start it afresh.
            for attempt in 0.. {
                operator.metric(x, metric)?;
                let start = dot(x, metric);
                for _ in 0..2 {
                    for (y, p) in before.iter().zip(earlier.iter()) {
                        let share = dot(x, p);
                        add(x, -share, y);
                    }
                }
                operator.metric(x, metric)?;
                let square = dot(x, metric);
                if square > start * R::lit(R::EPSILON) && square.finite() {
                    let scale = square.sqrt().recip();
                    x.iter_mut()
                        .chain(metric.iter_mut())
                        .for_each(|x| *x *= scale);
                    break;
                }
                if attempt == 3 {
                    return Err(Error::NotPositive {
                        what: "length of a vector in the metric of the eigenproblem (mass or stiffness)",
                        value: square.value(),
                    });
                }
                self.random.fill(x);
            }
        }
        Ok(())
    }

    /// Applies the operator and turns the block into the Ritz vectors of its span.
    fn rotate<O: Operator<R>>(&mut self, operator: &mut O) -> Result<()> {
        for (x, y) in self.vectors.iter().zip(&mut self.images) {
            operator.apply(x, y)?;
        }
        let n = self.vectors.len();
        let mut small = vec![vec![R::zero(); n]; n];
        for i in 0..n {
            for j in 0..=i {
                let forth = dot(&self.metrics[i], &self.images[j]);
                let back = dot(&self.metrics[j], &self.images[i]);
                small[i][j] = (forth + back) * R::lit(0.5);
                small[j][i] = small[i][j];
            }
        }
        let turned = diagonalise(&mut small);
        let mut order: Vec<usize> = (0..n).collect();
        let size = |k: usize| small[k][k].value().abs();
        order.sort_by(|a, b| size(*b).total_cmp(&size(*a)));
        for block in [&mut self.vectors, &mut self.metrics, &mut self.images] {
            let combine = |k: &usize| {
                let mut sum = vec![R::zero(); block[0].len()];
                for (x, row) in block.iter().zip(&turned) {
                    add(&mut sum, row[*k], x);
                }
                sum
            };
            *block = order.iter().map(combine).collect();
        }
        let mut rest = vec![R::zero(); operator.size()];
        let mut metric = rest.clone();
        for (k, from) in order.iter().enumerate() {
            self.values[k] = small[*from][*from];
            rest.copy_from_slice(&self.images[k]);
            add(&mut rest, -self.values[k], &self.vectors[k]);
            operator.metric(&rest, &mut metric)?;
            let square = dot(&rest, &metric).value().max(0.0);
            self.residuals[k] = square.sqrt() / self.values[k].value().abs();
        }
        Ok(())
    }
}

/// Diagonalises a symmetric matrix in place by Jacobi's rotations; returns the eigenvectors as
/// columns. Written without division by off-diagonal entries, so that dual numbers carry the
/// derivatives of simple eigenvalues and their vectors.
fn diagonalise<R: Real>(a: &mut [Vec<R>]) -> Vec<Vec<R>> {
    let n = a.len();
    let unit = |i: usize, j: usize| if i == j { R::one() } else { R::zero() };
    let mut q: Vec<Vec<R>> = (0..n)
        .map(|i| (0..n).map(|j| unit(i, j)).collect())
        .collect();
    let mut extra = R::ORDER;
    for _ in 0..60 {
        let sum = |off: bool| {
            let entries = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
            let chosen = entries.filter(|(i, j)| (i != j) == off);
            chosen
                .map(|(i, j)| a[i][j].value().powi(2))
                .sum::<f64>()
                .sqrt()
        };
        let scale = sum(false).max(f64::MIN_POSITIVE);
        if sum(true) <= R::EPSILON * scale {
            if extra == 0 {
                break;
            }
            extra -= 1;
        }
        for i in 0..n {
            for j in i + 1..n {
                let (gap, off) = (a[j][j] - a[i][i], a[i][j] + a[i][j]);
                let square = gap * gap + off * off;
                // Equal eigenvalues of a diagonal block: any vectors will do.
                if square.value().sqrt() <= 0.01 * R::EPSILON * scale {
                    continue;
                }
                let root = square.sqrt();
                let sum = if gap < R::zero() {
                    gap - root
                } else {
                    gap + root
                };
                let tangent = off / sum;
                let cosine = (R::one() + tangent * tangent).sqrt().recip();
                let sine = tangent * cosine;
                let turn = |x: &mut R, y: &mut R| {
                    let (old_x, old_y) = (*x, *y);
                    *x = cosine * old_x - sine * old_y;
                    *y = sine * old_x + cosine * old_y;
                };
                for row in a.iter_mut().chain(q.iter_mut()) {
                    let (left, right) = row.split_at_mut(j);
                    turn(&mut left[i], &mut right[0]);
                }
                let (top, bottom) = a.split_at_mut(j);
                for (x, y) in top[i].iter_mut().zip(&mut bottom[0]) {
                    turn(x, y);
                }
            }
        }
    }
    q
}

fn dot<R: Real>(a: &[R], b: &[R]) -> R {
    a.iter().zip(b).map(|(a, b)| *a * *b).sum()
}

fn add<R: Real>(x: &mut [R], factor: R, y: &[R]) {
    for (x, y) in x.iter_mut().zip(y) {
        *x += factor * *y;
    }
}

/// Numbers without pattern, the same in every run (Marsaglia's xorshift).
struct Random(u64);

impl Random {
    fn fill<R: Real>(&mut self, x: &mut [R]) {
        for x in x {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            *x = R::lit((self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0);
        }
    }
}
