//! Collocation at Gauss and at Radau IIA points: implicit Runge-Kutta methods of any number of
//! stages. The stages are the coordinates of a larger structure, numbered coordinate by coordinate,
//! so that it keeps a band and Newton's method sees nothing new.

use std::cell::RefCell;

use super::{Method, Scheme, mean_squares, prepare};
use crate::error::{Error, Result};
use crate::quadrature::{gauss_legendre, gauss_radau};
use crate::scalar::Real;
use crate::solver::band::{BandMatrix, Profile};
use crate::solver::{Equations, Newton, Solved, State, Structure, Workspace};

/// Where the equations of motion hold within a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Points {
    Gauss,
    Radau,
}

/// Collocation with `s` stages: the motion over a step is the polynomial that obeys the equations
/// of motion at `s` points (Hairer, Norsett and Wanner, *Solving ODEs I*, II.7 and *II*, IV.5). A
/// step costs what a structure of `s` times the coordinates costs.
///
/// Error control holds the polynomial inside the step to the tolerance; with more than two stages
/// the end of the step is better than that.
///
/// ```
/// use ancf::prelude::*;
///
/// let rubber = SaintVenantKirchhoff::isotropic(2.0e7, 0.0)?;
/// let mut scene = Scene::<f64, 2>::new();
/// let beam = scene.add(
///     Beam::new(FullyParameterised, Disk::new(0.01)?, Continuum::full(rubber))
///         .straight([0.0, 0.0], [1.0, 0.0], 4)
///         .density(7200.0),
/// )?;
/// scene.pin(beam.start())?;
/// scene.gravity([0.0, -9.81])?;
/// let system = scene.assemble()?;
/// let mut run = Integration::start(&system, system.rest(), &Collocation::radau(3))?;
/// run.until(0.1, Stepping::Fixed(5e-3), |_| {})?;
/// assert!(system.energies(run.state())?.balance().abs() < 1e-5);
/// # Ok::<(), ancf::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Collocation {
    points: Points,
    stages: usize,
    newton: Newton,
}

impl Collocation {
    /// Gauss points: order `2 s`, symmetric and symplectic, no dissipation. Keeps momenta.
    pub fn gauss(stages: usize) -> Self {
        Self {
            points: Points::Gauss,
            stages,
            newton: Newton::default(),
        }
    }

    /// Radau points, the last of them at the end of the step: order `2 s - 1`; motion that the
    /// step does not resolve is gone after it.
    pub fn radau(stages: usize) -> Self {
        Self {
            points: Points::Radau,
            ..Self::gauss(stages)
        }
    }

    /// The same method with other settings of Newton's method.
    pub fn with_newton(mut self, newton: Newton) -> Self {
        self.newton = newton;
        self
    }
}

/// Coefficients of a method in second-order form: stage `i` is at the displacement
/// `u + dt c_i v + dt^2 sum_j twice_ij a_j` with the stage accelerations `a`.
#[derive(Debug)]
struct Tableau<R> {
    /// Points in the step.
    at: Vec<R>,
    /// Weights of the accelerations in the velocity at the end.
    weight: Vec<R>,
    /// Runge-Kutta matrix, and its square.
    once: Vec<Vec<R>>,
    twice: Vec<Vec<R>>,
    /// Inverse of the square.
    inverse: Vec<Vec<R>>,
    /// Weights of the accelerations in the displacement at the end.
    end: Vec<R>,
    /// Weights of the error estimate, that of the acceleration at the start first: what the
    /// displacement a quarter into the step would change by if that acceleration counted, too. (At
    /// the end it would change by nothing: the method is that good there.)
    estimate: Vec<R>,
}

/// Integrals `int_0^end weight(x) l_j(x) dx` of Lagrange's polynomials on `nodes`.
fn lagrange<R: Real>(nodes: &[R], end: R, weight: impl Fn(R) -> R) -> Result<Vec<R>> {
    let rule = gauss_legendre::<R>(nodes.len() / 2 + 1)?;
    let integral = |j: usize| {
        rule.iter()
            .map(|([x], w)| {
                let x = x * end;
                let factors = (0..nodes.len()).filter(|&k| k != j);
                let value = factors.map(|k| (x - nodes[k]) / (nodes[j] - nodes[k]));
                w * end * weight(x) * value.fold(R::one(), |product, factor| product * factor)
            })
            .sum()
    };
    Ok((0..nodes.len()).map(integral).collect())
}

/// Inverse of a small matrix, by elimination with partial pivoting.
fn inverse<R: Real>(mut matrix: Vec<Vec<R>>) -> Vec<Vec<R>> {
    let n = matrix.len();
    let unit = |i: usize, j: usize| if i == j { R::one() } else { R::zero() };
    for (i, row) in matrix.iter_mut().enumerate() {
        row.extend((0..n).map(|j| unit(i, j)));
    }
    for j in 0..n {
        let larger = |a: usize, i: usize| match matrix[i][j].abs() > matrix[a][j].abs() {
            true => i,
            false => a,
        };
        let chosen = (j..n).fold(j, larger);
        matrix.swap(j, chosen);
        let pivot = matrix[j].clone();
        for (i, row) in matrix.iter_mut().enumerate() {
            let factor = row[j] / pivot[j];
            for k in 0..2 * n {
                match i == j {
                    true => row[k] = pivot[k] / pivot[j],
                    false => row[k] -= factor * pivot[k],
                }
            }
        }
    }
    matrix.into_iter().map(|row| row[n..].to_vec()).collect()
}

impl<R: Real> Tableau<R> {
    fn new(points: Points, stages: usize) -> Result<Self> {
        let one = |_: R| R::one();
        let at: Vec<R> = match points {
            Points::Gauss => gauss_legendre(stages)?.iter().map(|([x], _)| x).collect(),
            // The rule has its first node at the start: mirrored.
            Points::Radau => {
                let rule = gauss_radau::<R>(stages)?;
                let mut at: Vec<R> = rule.iter().map(|([x], _)| R::one() - x).collect();
                at.reverse();
                at
            }
        };
        let once = at
            .iter()
            .map(|&c| lagrange(&at, c, one))
            .collect::<Result<Vec<_>>>()?;
        let product = |row: &[R], j: usize| (0..stages).map(|k| row[k] * once[k][j]).sum();
        let weight = lagrange(&at, R::one(), one)?;
        let times = |row: &[R]| (0..stages).map(|j| product(row, j)).collect();
        let twice: Vec<Vec<R>> = once.iter().map(|row| times(row)).collect();
        let end: Vec<R> = times(&weight);
        let with_start: Vec<R> = std::iter::once(R::zero())
            .chain(at.iter().copied())
            .collect();
        let inside = R::lit(0.25);
        let mut estimate = lagrange(&with_start, inside, |x| inside - x)?;
        let without = lagrange(&at, inside, |x| inside - x)?;
        for (estimate, without) in estimate[1..].iter_mut().zip(without) {
            *estimate -= without;
        }
        Ok(Self {
            inverse: inverse(twice.clone()),
            at,
            weight,
            once,
            twice,
            end,
            estimate,
        })
    }
}

/// Profile, supports and natural sizes of the stages.
#[derive(Debug)]
struct Layout<R> {
    profile: Profile,
    fixed: Vec<usize>,
    measure: Vec<R>,
}

impl<R: Real> Layout<R> {
    fn new<S: Structure<R>>(structure: &S, stages: usize) -> Result<Self> {
        let profile = structure.profile();
        let range = |(i, reach): (usize, &usize)| i * stages..(reach + 1) * stages;
        let ranges = profile.reach().iter().enumerate().map(range);
        let spread = |i: &usize| i * stages..(i + 1) * stages;
        Ok(Self {
            profile: Profile::from_ranges(profile.size() * stages, ranges)?,
            fixed: structure.fixed().iter().flat_map(spread).collect(),
            measure: structure
                .measure()
                .iter()
                .flat_map(|m| std::iter::repeat_n(*m, stages))
                .collect(),
        })
    }
}

/// Vectors and a matrix of one stage.
#[derive(Debug)]
struct Scratch<R> {
    u: Vec<R>,
    q: Vec<R>,
    matrix: BandMatrix<R>,
}

impl<R: Real> Scratch<R> {
    /// Takes stage `i` out of the vector of all and clears the forces.
    fn stage(&mut self, all: &[R], i: usize, stages: usize) {
        let own = all.iter().skip(i).step_by(stages);
        for (u, value) in self.u.iter_mut().zip(own) {
            *u = *value;
        }
        self.q.fill(R::zero());
    }

    /// Adds the forces of stage `i` to those of all.
    fn give(&self, all: &mut [R], i: usize, stages: usize) {
        let own = all.iter_mut().skip(i).step_by(stages);
        for (sum, q) in own.zip(&self.q) {
            *sum += *q;
        }
    }

    /// Shows every entry of the matrix.
    fn entries(&self, mut show: impl FnMut(usize, usize, R) -> Result<()>) -> Result<()> {
        for i in 0..self.matrix.size() {
            let (first, row) = self.matrix.row(i);
            for (j, value) in (first..).zip(row) {
                show(i, j, *value)?;
                if self.matrix.is_symmetric() && i != j {
                    show(j, i, *value)?;
                }
            }
        }
        Ok(())
    }
}

/// The stages of a step as one structure.
struct Stages<'a, R, S> {
    structure: &'a S,
    tableau: &'a Tableau<R>,
    layout: &'a Layout<R>,
    step: R,
    scratch: RefCell<&'a mut Scratch<R>>,
}

impl<R: Real, S: Structure<R>> Stages<'_, R, S> {
    fn count(&self) -> usize {
        self.tableau.at.len()
    }
}

impl<R: Real, S: Structure<R>> Structure<R> for Stages<'_, R, S> {
    fn profile(&self) -> &Profile {
        &self.layout.profile
    }
    fn symmetric(&self) -> bool {
        false
    }
    fn fixed(&self) -> &[usize] {
        &self.layout.fixed
    }
    fn measure(&self) -> &[R] {
        &self.layout.measure
    }
    fn add_internal(&self, u: &[R], q: &mut [R]) {
        let mut scratch = self.scratch.borrow_mut();
        for i in 0..self.count() {
            scratch.stage(u, i, self.count());
            let Scratch { u, q: own, .. } = &mut **scratch;
            self.structure.add_internal(u, own);
            scratch.give(q, i, self.count());
        }
    }
    fn add_external(&self, time: R, factor: R, u: &[R], q: &mut [R]) -> Result<()> {
        let mut scratch = self.scratch.borrow_mut();
        for (i, at) in self.tableau.at.iter().enumerate() {
            scratch.stage(u, i, self.count());
            let Scratch { u, q: own, .. } = &mut **scratch;
            let time = time + self.step * *at;
            self.structure.add_external(time, factor, u, own)?;
            scratch.give(q, i, self.count());
        }
        Ok(())
    }
    fn add_tangent(&self, time: R, factor: R, u: &[R], k: &mut BandMatrix<R>) -> Result<()> {
        let mut scratch = self.scratch.borrow_mut();
        let count = self.count();
        for (i, at) in self.tableau.at.iter().enumerate() {
            scratch.stage(u, i, count);
            let Scratch { u, matrix, .. } = &mut **scratch;
            matrix.clear();
            let time = time + self.step * *at;
            self.structure.add_tangent(time, factor, u, matrix)?;
            scratch.entries(|a, b, value| k.add(a * count + i, b * count + i, value))?;
        }
        Ok(())
    }
    fn name(&self, i: usize) -> String {
        self.structure.name(i / self.count())
    }
    fn check(&self, u: &[R]) -> Result<()> {
        let mut scratch = self.scratch.borrow_mut();
        for i in 0..self.count() {
            scratch.stage(u, i, self.count());
            self.structure.check(&scratch.u)?;
        }
        Ok(())
    }
    fn has_mass(&self) -> bool {
        self.structure.has_mass()
    }
    /// `M (A^2)^-1`: takes displacements of the stages, per square of the step, to inertia forces.
    fn add_mass_times(&self, factor: R, x: &[R], out: &mut [R]) {
        let mut scratch = self.scratch.borrow_mut();
        for (i, inverse) in self.tableau.inverse.iter().enumerate() {
            scratch.stage(x, i, self.count());
            let Scratch { u, q, .. } = &mut **scratch;
            for (u, all) in u.iter_mut().zip(x.chunks_exact(self.count())) {
                *u = weighted(inverse, all);
            }
            self.structure.add_mass_times(factor, u, q);
            scratch.give(out, i, self.count());
        }
    }
    fn add_mass(&self, factor: R, k: &mut BandMatrix<R>) -> Result<()> {
        let mut scratch = self.scratch.borrow_mut();
        let count = self.count();
        scratch.matrix.clear();
        self.structure.add_mass(factor, &mut scratch.matrix)?;
        scratch.entries(|a, b, value| {
            for (i, row) in self.tableau.inverse.iter().enumerate() {
                for (j, inverse) in row.iter().enumerate() {
                    k.add(a * count + i, b * count + j, value * *inverse)?;
                }
            }
            Ok(())
        })
    }
}

fn weighted<R: Real>(weights: &[R], values: &[R]) -> R {
    weights.iter().zip(values).map(|(w, x)| *w * *x).sum()
}

impl<R: Real> Scheme<R> for Collocation {
    type Method = CollocationMethod<R>;

    fn start<S: Structure<R>>(
        &self,
        structure: &S,
        state: &mut State<R>,
    ) -> Result<CollocationMethod<R>> {
        self.newton.check()?;
        if !(1..=8).contains(&self.stages) {
            return Err(Error::OutOfRange {
                what: "number of stages of a collocation method",
                value: self.stages as f64,
                range: "1 to 8",
                remedy: "use 2 or 3",
            });
        }
        let (tableau, layout) = (
            Tableau::new(self.points, self.stages)?,
            Layout::new(structure, self.stages)?,
        );
        let outer = prepare(structure, state)?;
        let n = state.displacement.len();
        let profile = structure.profile();
        let mut scratch = Scratch {
            u: vec![R::zero(); n],
            q: vec![R::zero(); n],
            matrix: match structure.symmetric() {
                true => BandMatrix::symmetric(profile),
                false => BandMatrix::general(profile),
            },
        };
        let workspace = Workspace::new(&Stages {
            structure,
            tableau: &tableau,
            layout: &layout,
            step: R::one(),
            scratch: RefCell::new(&mut scratch),
        });
        Ok(CollocationMethod {
            settings: *self,
            workspace,
            outer,
            scratch,
            predicted: vec![R::zero(); n * self.stages],
            stages: vec![R::zero(); n * self.stages],
            tableau,
            layout,
            step: None,
        })
    }
}

/// A collocation method at work on a structure.
#[derive(Debug)]
pub struct CollocationMethod<R> {
    settings: Collocation,
    tableau: Tableau<R>,
    layout: Layout<R>,
    workspace: Workspace<R>,
    /// Workspace of the structure itself.
    outer: Workspace<R>,
    scratch: Scratch<R>,
    /// Displacements of the stages beyond uniform motion, per square of the step, as guessed.
    predicted: Vec<R>,
    /// Displacements of the stages; after the step their accelerations.
    stages: Vec<R>,
    /// Length of the last step tried, to which a kept tangent belongs.
    step: Option<R>,
}

impl<R: Real> CollocationMethod<R> {
    /// Work of the applied forces, by the rule of the method. The stages still hold displacements.
    fn work<S: Structure<R>>(&mut self, structure: &S, now: &State<R>, step: R) -> Result<R> {
        let mut work = R::zero();
        if !structure.has_applied() {
            return Ok(work);
        }
        let count = self.tableau.at.len();
        let rate = R::one() / (step * step);
        for (i, at) in self.tableau.at.iter().enumerate() {
            self.scratch.stage(&self.stages, i, count);
            let Scratch { u, q, .. } = &mut self.scratch;
            structure.add_applied(now.time + step * *at, R::one(), u, q)?;
            // Velocities of the stage: A a = A (A^2)^-1 x.
            for (k, q) in q.iter().enumerate() {
                let own = k * count..(k + 1) * count;
                let (x, moved) = (&self.predicted[own.clone()], &self.workspace.moved()[own]);
                let mut v = now.velocity[k];
                for (once, row) in self.tableau.once[i].iter().zip(&self.tableau.inverse) {
                    let a = weighted(row, x) + rate * weighted(row, moved);
                    v += step * *once * a;
                }
                work += step * self.tableau.weight[i] * *q * v;
            }
        }
        Ok(work)
    }
}

impl<R: Real> Method<R> for CollocationMethod<R> {
    fn order(&self) -> i32 {
        let twice = 2 * self.settings.stages as i32;
        match self.settings.points {
            Points::Gauss => twice,
            Points::Radau => twice - 1,
        }
    }

    fn error_order(&self) -> i32 {
        (self.order() + 1).min(self.settings.stages as i32 + 2)
    }

    fn advance<S: Structure<R>>(
        &mut self,
        structure: &S,
        now: &State<R>,
        next: &mut State<R>,
        step: R,
    ) -> Result<Solved> {
        let count = self.tableau.at.len();
        let square = step * step;
        for (i, twice) in self.tableau.twice.iter().enumerate() {
            let share: R = twice.iter().copied().sum();
            for k in 0..now.displacement.len() {
                let x = share * now.acceleration[k];
                let drift = step * self.tableau.at[i] * now.velocity[k] + square * x;
                self.predicted[k * count + i] = x;
                self.stages[k * count + i] = now.displacement[k] + drift;
            }
        }
        // The mass term of a kept tangent belongs to one step size only.
        if self.step != Some(step) {
            self.workspace.forget();
            self.step = Some(step);
        }
        let rate = R::one() / square;
        let equations = Equations {
            time: now.time,
            factor: R::one(),
            initial: None,
            inertia: Some((rate, &self.predicted)),
        };
        let stages = Stages {
            structure,
            tableau: &self.tableau,
            layout: &self.layout,
            step,
            scratch: RefCell::new(&mut self.scratch),
        };
        let newton = &self.settings.newton;
        let solved = self
            .workspace
            .solve(&stages, newton, &equations, &mut self.stages)?;
        next.work = now.work + self.work(structure, now, step)?;
        next.time = now.time + step;
        let moved = self.workspace.moved();
        for k in 0..now.displacement.len() {
            let own = k * count..(k + 1) * count;
            let (x, moved) = (&self.predicted[own.clone()], &moved[own.clone()]);
            let a = &mut self.stages[own];
            for (a, row) in a.iter_mut().zip(&self.tableau.inverse) {
                *a = weighted(row, x) + rate * weighted(row, moved);
            }
            let drift = step * (now.velocity[k] + step * weighted(&self.tableau.end, a));
            next.displacement[k] = now.displacement[k] + drift;
            next.velocity[k] = now.velocity[k] + step * weighted(&self.tableau.weight, a);
            next.acceleration[k] = a[count - 1];
        }
        // Radau's last stage is the end.
        if self.settings.points == Points::Gauss {
            self.outer.accelerate(structure, next)?;
        }
        Ok(solved)
    }

    fn error<S: Structure<R>>(&self, structure: &S, now: &State<R>, next: &State<R>) -> (R, R) {
        let step = self.step.unwrap_or(R::zero());
        let count = self.tableau.at.len();
        let [start, stages] = [&self.tableau.estimate[..1], &self.tableau.estimate[1..]];
        mean_squares(structure.measure(), &next.displacement, |k| {
            let own = &self.stages[k * count..(k + 1) * count];
            step * step * (start[0] * now.acceleration[k] + weighted(stages, own))
        })
    }

    fn accept(&mut self, _now: &State<R>, _next: &State<R>) {}
}
