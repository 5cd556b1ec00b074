//! The driver of path following: one Newton iteration with the load factor among the unknowns,
//! steps that adapt and never lose the last equilibrium, and exact landing on targets.

use super::critical::Critical;
use super::newton::{Changes, Equations, Rest, Solved, Stability, Workspace};
use super::observation::{Ending, Observation};
use super::path::{Control, Path, PathPoint, PathReport, Target, check_coordinate};
use super::progress::PathRefusal;
use super::{Rate, State, Structure};
use crate::error::{Error, Result, finite};
use crate::scalar::Real;

/// A path of equilibria under way.
#[derive(Debug)]
pub struct Continuation<'a, R: Real, S> {
    pub(super) structure: &'a S,
    pub(super) settings: Path,
    pub(super) workspace: Workspace<R>,
    pub(super) state: State<R>,
    pub(super) factor: R,
    pub(super) stability: Stability,
    /// The same of the point before.
    pub(super) was: Stability,
    /// The point before, once there is one.
    pub(super) before: Option<(Vec<R>, R)>,
    /// Displacements tried.
    pub(super) u: Vec<R>,
    /// Displacements of another point, while a step is kept.
    pub(super) spare: Vec<R>,
    /// Changes by a unit of the load at the start of the step.
    tangent: Vec<R>,
    pub(super) step: R,
    pub(super) criticals: Vec<Critical<R>>,
    pub(super) report: PathReport,
    refusals: Vec<PathRefusal<R>>,
}

impl<'a, R: Real, S: Structure<R>> Continuation<'a, R, S> {
    /// Starts at the equilibrium near `state` under `factor` of the external load, and all of those
    /// that are [permanent](crate::scene::Scene::hold_loads). Motions given in
    /// time stay as they are at the state's time.
    ///
    /// # Errors
    /// For settings out of range, a state of the wrong size or with values that are not finite, and
    /// those of Newton's method when there is no equilibrium near.
    pub fn start(structure: &'a S, state: State<R>, factor: R, settings: &Path) -> Result<Self> {
        let mut path = Self::at(structure, state, factor, settings)?;
        let structure = path.structure;
        structure.impose(path.state.time, Rate::Displacement, &mut path.u)?;
        let equations = path.equations(factor);
        path.workspace
            .solve(structure, &settings.newton, &equations, &mut path.u)?;
        path.state.displacement.copy_from_slice(&path.u);
        path.look()?;
        Ok(path)
    }

    /// A path at a state, which is taken for an equilibrium.
    pub(super) fn at(
        structure: &'a S,
        state: State<R>,
        factor: R,
        settings: &Path,
    ) -> Result<Self> {
        let size = structure.unknowns().coordinates();
        settings.check(size)?;
        state.check(size)?;
        finite("load factor", factor)?;
        Ok(Self {
            structure,
            settings: *settings,
            workspace: Workspace::new(structure),
            u: state.displacement.clone(),
            spare: vec![R::zero(); size],
            tangent: vec![R::zero(); size],
            state,
            factor,
            stability: Stability::default(),
            was: Stability::default(),
            before: None,
            step: R::lit(settings.first),
            criticals: Vec::new(),
            report: PathReport::default(),
            refusals: Vec::new(),
        })
    }

    /// The last equilibrium found.
    pub fn state(&self) -> &State<R> {
        &self.state
    }

    /// Ends the path and gives the last equilibrium found.
    pub fn into_state(self) -> State<R> {
        self.state
    }

    /// Share of the external load that the last equilibrium carries.
    pub fn factor(&self) -> R {
        self.factor
    }

    /// In how many directions the last equilibrium is unstable; `None` where the factorisation does
    /// not tell: of an unsymmetric tangent, and of one so near to singular that it had to be pivoted.
    pub fn unstable(&self) -> Option<usize> {
        self.stability.unstable
    }

    /// What the path took so far.
    pub fn report(&self) -> &PathReport {
        &self.report
    }

    /// The limit and bifurcation points passed so far.
    pub fn criticals(&self) -> &[Critical<R>] {
        &self.criticals
    }

    /// The steps tried and not taken since the path was started or resumed, with the reasons.
    pub fn refusals(&self) -> &[PathRefusal<R>] {
        &self.refusals
    }

    /// One step: its length is halved until it succeeds, and adapted to the number of corrections
    /// it took.
    ///
    /// # Errors
    /// [`Error::PathStopped`] when even the shortest step fails: the last equilibrium is kept;
    /// [`Error::LoadNotFinite`].
    pub fn step(&mut self) -> Result<()> {
        loop {
            let tried = self.advance(self.step);
            let kept = tried.and_then(|(solved, factor)| self.keep(factor).map(|()| solved));
            match kept {
                Ok(solved) => {
                    self.report.points += 1;
                    self.report.corrections += solved.iterations;
                    self.report.at_floor += usize::from(solved.at_floor);
                    let ratio =
                        solved.decide(|n| (self.settings.corrections as f64 / n as f64).sqrt());
                    let length = self.step.abs() * R::lit(ratio.clamp(0.5, 2.0));
                    let length = length.smaller(R::lit(self.settings.longest));
                    self.step = if self.step < R::zero() {
                        -length
                    } else {
                        length
                    };
                    return Ok(());
                }
                Err(error @ Error::LoadNotFinite { .. }) => return Err(error),
                Err(error) => self.cut(error)?,
            }
        }
    }

    /// Steps until the target, showing every point to `observe`, and says whether it came there or
    /// the observer stopped it. What was stopped goes on by another call, to the last bit as if it
    /// had not been stopped.
    ///
    /// # Errors
    /// Those of [`step`](Self::step), [`Error::TargetMissed`] after [`Path::points`],
    /// [`Error::NoSuchCoordinate`], a target that is not finite, and those of the observer; the last
    /// equilibrium is kept.
    pub fn until<O: Observation>(
        &mut self,
        target: Target<R>,
        mut observe: impl FnMut(&PathPoint<'_, R>) -> O,
    ) -> Result<Ending> {
        match target {
            Target::Coordinate(c, value) => {
                check_coordinate(c, self.u.len())?;
                finite("displacement to follow a path to", value)?;
            }
            Target::Factor(factor) => {
                finite("load factor to follow a path to", factor)?;
            }
            Target::Points(_) | Target::Critical => {}
        }
        let known = self.criticals.len();
        let mut points = 0;
        while points < self.settings.points {
            let arrived = match target {
                Target::Points(count) => points == count,
                Target::Critical => self.criticals.len() > known,
                _ => self.distance(target).is_zero(),
            };
            if arrived {
                return Ok(Ending::End);
            }
            let far = self.distance(target);
            let passed = self.criticals.len();
            self.step()?;
            let near = self.distance(target);
            let beyond = far * near < R::zero();
            let landed = beyond && self.land(target, far / (far - near))?;
            // What lies between the target and the point left is yet to be passed.
            if beyond && (!landed || self.stability.differs(self.was).is_none()) {
                self.criticals.truncate(passed);
            }
            points += 1;
            let flow = observe(&PathPoint {
                state: &self.state,
                factor: self.factor,
                unstable: self.stability.unstable,
                report: &self.report,
            });
            let stopped = flow.flow()?.is_break();
            if landed {
                return Ok(Ending::End);
            }
            if stopped {
                return Ok(Ending::Stopped);
            }
        }
        Err(Error::TargetMissed {
            points,
            factor: self.factor.value(),
        })
    }

    /// Signed distance from a target that has one.
    fn distance(&self, target: Target<R>) -> R {
        match target {
            Target::Factor(factor) => self.factor - factor,
            Target::Coordinate(c, value) => self.state.displacement[c] - value,
            Target::Points(_) | Target::Critical => R::one(),
        }
    }

    /// Moves the last point back to the target, which lies at about `share` of the last step;
    /// false if that fails, and the path goes on from the point before by shorter steps.
    fn land(&mut self, target: Target<R>, share: R) -> Result<bool> {
        let Some((before, from)) = &self.before else {
            return Ok(false);
        };
        for (u, (a, b)) in self
            .u
            .iter_mut()
            .zip(before.iter().zip(&self.state.displacement))
        {
            *u = *a + share * (*b - *a);
        }
        let guess = *from + share * (self.factor - *from);
        let newton = &self.settings.newton;
        let result = match target {
            Target::Coordinate(c, value) => {
                let start = self.u[c];
                let mut choice = |changes: &Changes<'_, R>| {
                    let gap = value - start - changes.moved[c] - changes.residual[c];
                    Some(gap / changes.load[c])
                };
                let equations = self.equations(guess);
                self.workspace.solve_along(
                    self.structure,
                    newton,
                    &equations,
                    Some(&mut choice),
                    &mut self.u,
                )
            }
            Target::Factor(factor) => {
                let equations = self.equations(factor);
                let workspace = &mut self.workspace;
                workspace
                    .solve(self.structure, newton, &equations, &mut self.u)
                    .map(|solved| (solved, factor))
            }
            Target::Points(_) | Target::Critical => return Ok(false),
        };
        match result {
            Ok((_, factor)) if self.belongs(share, factor)? => {
                // Exactly, whatever rounding Newton's method left.
                if let Target::Coordinate(c, value) = target {
                    self.u[c] = value;
                }
                self.state.displacement.copy_from_slice(&self.u);
                self.factor = factor;
                self.look()?;
                Ok(true)
            }
            Ok(_)
            | Err(
                Error::Unconverged { .. }
                | Error::OffPath { .. }
                | Error::Mechanism { .. }
                | Error::StiffnessLost { .. },
            ) => {
                // The point before the last is mirrored, so that the direction stays.
                if let Some((before, from)) = &mut self.before {
                    let two = R::lit(2.0);
                    for (old, here) in before.iter_mut().zip(&mut self.state.displacement) {
                        (*old, *here) = (two * *old - *here, *old);
                    }
                    (*from, self.factor) = (two * *from - self.factor, *from);
                }
                self.step = R::lit(0.5) * self.step;
                self.look()?;
                Ok(false)
            }
            Err(error) => Err(error),
        }
    }

    /// Whether a solution at about `share` of the last step is of the same path: near the chord of
    /// that step, and as stable as one of its ends.
    fn belongs(&mut self, share: R, factor: R) -> Result<bool> {
        let Some((before, _)) = &self.before else {
            return Ok(false);
        };
        let (u, here) = (&self.u, &self.state.displacement);
        let step = square(self.structure, |i| here[i] - before[i]);
        let off = |i: usize| u[i] - before[i] - share * (here[i] - before[i]);
        if square(self.structure, off) > R::lit(0.1) * step {
            return Ok(false);
        }
        let equations = self.equations(factor);
        let found = self
            .workspace
            .stability(self.structure, &equations, &self.u)?;
        let mut ends = [self.was, self.stability].into_iter();
        if ends.all(|end| end.differs(found).is_some()) {
            return Ok(false);
        }
        let Some((before, from)) = &self.before else {
            return Ok(false);
        };
        subtract([&self.u, before], &mut self.spare);
        self.goes_on(factor - *from)
    }

    pub(super) fn equations(&self, factor: R) -> Equations<'static, R> {
        Equations {
            time: self.state.time,
            factor,
            rest: Rest::Permanent,
            inertia: None,
        }
    }

    /// Looks at the stability of the last point, and keeps its tangent for the next step.
    pub(super) fn look(&mut self) -> Result<()> {
        let equations = self.equations(self.factor);
        let u = &self.state.displacement;
        self.stability = self.workspace.stability(self.structure, &equations, u)?;
        self.workspace.stay();
        Ok(())
    }

    /// Halves the step after a failure.
    fn cut(&mut self, cause: Error) -> Result<()> {
        self.refusals.push(PathRefusal {
            factor: self.factor,
            step: self.step,
            cause: cause.clone(),
        });
        self.step *= R::lit(0.5);
        // The tangent at hand is of somewhere else: the path would not begin along its own.
        self.workspace.forget();
        self.report.cutbacks += 1;
        if self.step.abs() < R::lit(self.settings.shortest) {
            return Err(Error::PathStopped {
                factor: self.factor.value(),
                step: self.step.abs().value(),
                cause: Box::new(cause),
            });
        }
        Ok(())
    }

    /// Weight of squares of the load's change beside those of displacements. A jump shows in the latter: the
    /// load is no part of it where it is prescribed.
    fn load_weight(&self) -> R {
        match self.settings.control {
            Control::Sphere | Control::Plane => R::lit(self.settings.load_weight.powi(2)),
            Control::Load | Control::Coordinate(_) => R::zero(),
        }
    }

    /// Whether a path that came to the displacements tried by the changes in `spare` and of the load goes on
    /// as it came, by the tangent just factorised there. Displacements tell of that, which change all along
    /// a path under dead loads: where the load's change weighs more than theirs, a step over a limit point
    /// may look like none.
    fn goes_on(&mut self, change: R) -> Result<bool> {
        let weight = self.load_weight();
        if weight.is_zero() || !self.workspace.factored() {
            return Ok(true);
        }
        let time = self.state.time;
        let growth = self.workspace.find_growth(self.structure, time, &self.u)?;
        let along = mean(self.structure, |i| self.spare[i] * growth[i]);
        let turned = along * (along + weight * change) < R::zero();
        // Of steps so short that rounding is all they are, the tangent where they started knows more.
        let against = mean(self.structure, |i| self.tangent[i] * growth[i]) < R::zero();
        Ok(!(turned && against))
    }

    /// Makes the displacements tried the last point.
    fn keep(&mut self, factor: R) -> Result<()> {
        let was = self.stability;
        let equations = self.equations(factor);
        let now = self
            .workspace
            .stability(self.structure, &equations, &self.u)?;
        subtract([&self.u, &self.state.displacement], &mut self.spare);
        if !self.goes_on(factor - self.factor)? {
            let reason = "it turns within the step, or another one was met";
            return Err(Error::OffPath { reason });
        }
        if let Some(locate) = self.settings.locate
            && was.differs(now).is_some()
        {
            self.spare.copy_from_slice(&self.u);
            let found = self.locate(locate, factor, [was, now])?;
            self.criticals.push(found);
            self.u.copy_from_slice(&self.spare);
            self.workspace
                .stability(self.structure, &equations, &self.u)?;
        }
        self.spare.copy_from_slice(&self.state.displacement);
        self.state.displacement.copy_from_slice(&self.u);
        match &mut self.before {
            Some((before, from)) => {
                before.copy_from_slice(&self.spare);
                *from = self.factor;
            }
            None => self.before = Some((self.spare.clone(), self.factor)),
        }
        self.factor = factor;
        self.was = was;
        self.stability = now;
        self.workspace.stay();
        Ok(())
    }

    /// Tries a step of this size from the last point into `u`; returns its load factor.
    pub(super) fn advance(&mut self, step: R) -> Result<(Solved, R)> {
        let (equations, weight) = (self.equations(self.factor), self.load_weight());
        let Self {
            structure,
            settings,
            workspace,
            state,
            factor,
            before,
            u,
            tangent,
            ..
        } = self;
        let (structure, newton) = (*structure, &settings.newton);
        u.copy_from_slice(&state.displacement);
        let here = &state.displacement;
        let forward = match step < R::zero() {
            true => -R::one(),
            false => R::one(),
        };
        // Change of the load factor so far, and the first.
        let (mut total, mut first) = (R::zero(), None);
        let mut choice = |changes: &Changes<'_, R>| {
            let Changes {
                moved,
                residual,
                load,
            } = changes;
            let inner =
                |a: &dyn Fn(usize) -> R, b: &dyn Fn(usize) -> R| mean(structure, |i| a(i) * b(i));
            let change = match settings.control {
                Control::Load => step - total,
                Control::Coordinate(c) => (step - moved[c] - residual[c]) / load[c],
                _ if first.is_none() => {
                    let along = match &before {
                        None => forward,
                        Some((old, from)) => {
                            inner(&|i| here[i] - old[i], &|i| load[i]) + weight * (*factor - *from)
                        }
                    };
                    let size = (inner(&|i| load[i], &|i| load[i]) + weight).sqrt();
                    let length = step.abs() / size;
                    if along < R::zero() { -length } else { length }
                }
                Control::Plane => {
                    let off = inner(&|i| moved[i], &|i| residual[i]);
                    -off / (inner(&|i| moved[i], &|i| load[i]) + weight * total)
                }
                Control::Sphere => {
                    let to = |i: usize| moved[i] + residual[i];
                    let a = inner(&|i| load[i], &|i| load[i]) + weight;
                    let b = inner(&|i| load[i], &to) + weight * total;
                    let c = inner(&to, &to) + weight * total * total - step * step;
                    let root = b * b - a * c;
                    if root < R::zero() {
                        return None;
                    }
                    let ahead = inner(&|i| moved[i], &|i| load[i]) + weight * total;
                    let root = super::norm(root);
                    // Without cancellation.
                    let sum = -(b + if b < R::zero() { -root } else { root });
                    let (one, two) = (sum / a, c / sum);
                    if (one > two) == (ahead > R::zero()) {
                        one
                    } else {
                        two
                    }
                }
            };
            if first.is_none() {
                tangent.copy_from_slice(load);
                first = Some(change);
            }
            total += change;
            Some(change)
        };
        let solved = workspace.solve_along(structure, newton, &equations, Some(&mut choice), u)?;
        let (change, first) = (solved.1 - *factor, first.unwrap_or(R::zero()));
        let moved = square(structure, |i| u[i] - here[i]) + weight * change * change;
        let ahead = mean(structure, |i| (u[i] - here[i]) * tangent[i]) + weight * change;
        let slope = square(structure, |i| tangent[i]) + weight;
        // Far beyond where the path was heading at first, back, or more than 45 degrees off.
        let beyond = moved > R::lit(4.0) * first * first * slope;
        let back = ahead * first < R::zero();
        let off = ahead * ahead < R::lit(0.5) * moved * slope;
        if slope > R::zero() && (beyond || back || off) {
            let reason = "it bends too much within the step, or another one was met";
            return Err(Error::OffPath { reason });
        }
        Ok(solved)
    }
}

fn subtract<R: Real>([a, b]: [&[R]; 2], difference: &mut [R]) {
    for (difference, (a, b)) in difference.iter_mut().zip(a.iter().zip(b)) {
        *difference = *a - *b;
    }
}

/// Mean of products of changes of the unknowns, in natural sizes.
pub(super) fn mean<R: Real, S: Structure<R>>(structure: &S, product: impl Fn(usize) -> R) -> R {
    let (unknowns, measure) = (structure.unknowns(), structure.measure());
    let terms = unknowns.free().iter();
    let sum: R = terms.map(|&i| product(i) / (measure[i] * measure[i])).sum();
    sum / R::lit(unknowns.count() as f64)
}

fn square<R: Real, S: Structure<R>>(structure: &S, change: impl Fn(usize) -> R) -> R {
    mean(structure, |i| change(i) * change(i))
}
