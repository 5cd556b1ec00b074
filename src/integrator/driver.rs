//! The driver of all integrators: fixed steps, halved where they fail, steps below the stability
//! limit, or steps chosen so that the local error stays at a tolerance. Observers see every
//! accepted step and cannot change it, a log sees every other; an event ends the run where it happens.

use super::event::{Crossing, Event, Never, Watch, locate};
use super::observe::{Log, Refusal, Silent, Step};
use super::pace::{Pace, even};
use super::progress::{Checkpoint, Progress};
use super::stepping::{Adaptive, Stepping};
use super::{Method, Scheme};
use crate::error::{Error, Result, finite, positive};
use crate::scalar::Real;
use crate::solver::{Ending, Observation, State, Structure, Tape};

/// What a run took so far.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RunReport {
    /// Steps accepted.
    pub steps: usize,
    /// Steps rejected because their error was too large.
    pub rejected: usize,
    /// Steps that failed, Newton's method for the most part, whether a shorter one was tried or not.
    pub failed: usize,
    /// Steps accepted at the residual that rounding leaves, above Newton's tolerance.
    pub at_floor: usize,
    /// Newton iterations of all steps that converged, rejected ones among them.
    pub iterations: usize,
    /// Tangents evaluated in them.
    pub tangents: usize,
}

/// A run in progress: a structure, a method with its workspace, and the state it has reached.
///
/// ```
/// use ancf::prelude::*;
///
/// let rubber = SaintVenantKirchhoff::isotropic(2.0e7, 0.0)?;
/// let mut scene = Scene::<f64, 2>::new();
/// let beam = scene.add(
///     Beam::new(FullyParameterised, Disk::new(0.01)?, Continuum::full(rubber))
///         .straight([0.0, 0.0], [1.0, 0.0], 6)
///         .density(7200.0),
/// )?;
/// scene.pin(beam.start())?;
/// scene.gravity([0.0, -9.81])?;
/// let system = scene.assemble()?;
///
/// let mut run = Integration::start(&system, system.rest(), &Newmark::trapezoidal())?;
/// run.until(0.1, Stepping::Fixed(1e-3), |_| {})?;
/// let energies = system.energies(run.state())?;
/// assert!(energies.balance().abs() < 1e-4 * energies.kinetic);
/// # Ok::<(), ancf::Error>(())
/// ```
#[derive(Debug)]
pub struct Integration<'a, R: Real, S, M, L = Silent> {
    structure: &'a S,
    method: M,
    state: State<R>,
    next: State<R>,
    progress: Progress<R>,
    /// The scheme with its settings, in words.
    scheme: String,
    log: L,
    /// End of the run under way (s).
    end: R,
    /// Whether the last attempt ended at the rounding floor.
    floored: bool,
}

impl<'a, R: Real, S: Structure<R>, M: Method<R>> Integration<'a, R, S, M> {
    /// Prepares a run from a state; all memory is allocated here.
    ///
    /// # Errors
    /// For settings out of range, a structure without mass, a state of the wrong size or with
    /// values that are not finite.
    pub fn start(
        structure: &'a S,
        mut state: State<R>,
        scheme: &impl Scheme<R, Method = M>,
    ) -> Result<Self> {
        if structure.has_gyroscopic() {
            return Err(Error::Unsupported {
                what: "time integration in a rotating frame".into(),
                remedy: "integrate the system itself, with System::set_rigid_velocity",
            });
        }
        let method = scheme.start(structure, &mut state)?;
        Ok(Self {
            structure,
            method,
            next: state.clone(),
            progress: Progress::new(state.time),
            scheme: format!("{scheme:?}"),
            log: Silent,
            end: state.time,
            floored: false,
            state,
        })
    }

    /// Goes on from a checkpoint, to the last bit as the run that it was taken from would have gone
    /// on, whatever the scheme and the stepping: to that end what the method remembers is restored,
    /// kept tangents among it. On another kind of processor, whose lanes round otherwise, the last
    /// digits differ.
    ///
    /// ```
    /// use ancf::prelude::*;
    ///
    /// # let rubber = SaintVenantKirchhoff::isotropic(2.0e7, 0.0)?;
    /// # let mut scene = Scene::<f64, 2>::new();
    /// # let beam = scene.add(
    /// #     Beam::new(FullyParameterised, Disk::new(0.01)?, Continuum::full(rubber))
    /// #         .straight([0.0, 0.0], [1.0, 0.0], 4)
    /// #         .density(7200.0),
    /// # )?;
    /// # scene.pin(beam.start())?;
    /// # scene.gravity([0.0, -9.81])?;
    /// # let system = scene.assemble()?;
    /// let (scheme, stepping) = (Newmark::trapezoidal(), Stepping::Adaptive(Adaptive::to(1e-4)));
    /// let mut run = Integration::start(&system, system.rest(), &scheme)?;
    /// let mut kept = None;
    /// while run.until(0.1, stepping, |step| match step.report.steps % 10 {
    ///     0 => std::ops::ControlFlow::Break(()),
    ///     _ => std::ops::ControlFlow::Continue(()),
    /// })? == Ending::Stopped
    /// {
    ///     kept = kept.or(Some(run.checkpoint()?));
    /// }
    /// let mut again = Integration::resume(&system, &kept.expect("ten steps"), &scheme)?;
    /// again.until(0.1, stepping, |_| {})?;
    /// assert_eq!(again.state(), run.state());
    /// # Ok::<(), ancf::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::ForeignCheckpoint`] naming what differs, [`Error::Length`] for a system of another
    /// size, [`Error::NotFinite`] and the like for a checkpoint that is damaged; those of
    /// [`start`](Self::start).
    pub fn resume(
        structure: &'a S,
        checkpoint: &Checkpoint<R>,
        scheme: &impl Scheme<R, Method = M>,
    ) -> Result<Self> {
        checkpoint.check(structure, ("scheme", &format!("{scheme:?}")))?;
        checkpoint.progress().check()?;
        let mut run = Self::start(structure, checkpoint.state().clone(), scheme)?;
        checkpoint.restore(|tape| run.method.history(tape))?;
        run.state.clone_from(checkpoint.state());
        run.progress = checkpoint.progress().clone();
        Ok(run)
    }

    /// The same run, telling `log` of every step that is tried and not taken, as many as
    /// [`RunReport`] counts as rejected and failed from here on. Without a log nothing is told and
    /// nothing is lost.
    ///
    /// ```
    /// use ancf::prelude::*;
    ///
    /// # let rubber = SaintVenantKirchhoff::isotropic(2.0e7, 0.0)?;
    /// # let mut scene = Scene::<f64, 2>::new();
    /// # let beam = scene.add(
    /// #     Beam::new(FullyParameterised, Disk::new(0.01)?, Continuum::full(rubber))
    /// #         .straight([0.0, 0.0], [1.0, 0.0], 4)
    /// #         .density(7200.0),
    /// # )?;
    /// # scene.pin(beam.start())?;
    /// # scene.gravity([0.0, -9.81])?;
    /// # let system = scene.assemble()?;
    /// let run = Integration::start(&system, system.rest(), &Newmark::trapezoidal())?;
    /// let mut run = run.logging(|refused| {
    ///     println!("{:.4} s: {:.1e} s refused, {}", refused.time, refused.step, refused.cause);
    /// });
    /// run.until(0.1, Stepping::Adaptive(Adaptive::to(1e-4)), |_| {})?;
    /// # Ok::<(), ancf::Error>(())
    /// ```
    pub fn logging<L: FnMut(Refusal<'_, R>)>(self, log: L) -> Integration<'a, R, S, M, L> {
        Integration {
            structure: self.structure,
            method: self.method,
            state: self.state,
            next: self.next,
            progress: self.progress,
            scheme: self.scheme,
            log,
            end: self.end,
            floored: self.floored,
        }
    }
}

impl<R: Real, S: Structure<R>, M: Method<R>, L: Log<R>> Integration<'_, R, S, M, L> {
    /// The state reached: after an error, the last good one.
    pub fn state(&self) -> &State<R> {
        &self.state
    }

    /// Ends the run and gives the state reached.
    pub fn into_state(self) -> State<R> {
        self.state
    }

    /// What the run took so far.
    pub fn report(&self) -> RunReport {
        self.progress.report
    }

    /// All that the run needs to be [resumed](Integration::resume) from the state reached. What the
    /// run does next does not depend on whether a checkpoint was taken. A tangent that is kept from
    /// step to step ([`Refresh::WhenSlow`](crate::solver::Refresh::WhenSlow), `Never`) is part of it
    /// and makes it larger.
    ///
    /// # Errors
    /// When a number that belongs to it is not finite.
    pub fn checkpoint(&mut self) -> Result<Checkpoint<R>> {
        let (state, progress) = (self.state.clone(), self.progress.clone());
        progress.check()?;
        let history = |tape: &mut Tape<R>| self.method.history(tape);
        Checkpoint::take(self.structure, &self.scheme, state, progress, history)
    }

    /// One step of `step` seconds. Allocates nothing.
    ///
    /// # Errors
    /// [`Error::StepFailed`] with the cause; the state before the step is kept.
    pub fn step(&mut self, step: R) -> Result<()> {
        positive("time step [s]", step)?;
        self.told(step)?;
        self.sure(step)?;
        self.accept();
        Ok(())
    }

    /// Runs to `end` seconds, showing every accepted step to `observe`, and says whether it came
    /// there or the observer stopped it. What was stopped goes on by another call, to the last bit
    /// as if it had not been stopped if `end` and `stepping` are the same.
    ///
    /// # Errors
    /// For an end that lies before the state's time, steps that are not positive, and
    /// [`Error::StepFailed`] when a fixed step fails or an adaptive one shrinks below its limit, and
    /// those of the observer;
    /// the last good state is kept and the run can go on with other settings.
    pub fn until<O: Observation>(
        &mut self,
        end: R,
        stepping: Stepping,
        observe: impl FnMut(Step<'_, R>) -> O,
    ) -> Result<Ending> {
        self.drive(end, stepping, &mut Never, observe)
    }

    /// Runs until `function` of the state crosses zero, but no longer than to `end` seconds, and
    /// says how it ended. After the event the run stands just behind the crossing, at a state that the
    /// method has stepped to, and can go on from there.
    ///
    /// A function that crosses zero twice within one step is not seen to cross; of three crossings
    /// one is found, not always the first. Steps should be short beside the time between crossings.
    /// A step that fails on the way to the crossing is treated as one that fails by itself: halved or
    /// shortened where the stepping does so.
    ///
    /// ```
    /// use ancf::prelude::*;
    ///
    /// # let rubber = SaintVenantKirchhoff::isotropic(2.0e7, 0.0)?;
    /// # let mut scene = Scene::<f64, 2>::new();
    /// # let beam = scene.add(
    /// #     Beam::new(FullyParameterised, Disk::new(0.01)?, Continuum::full(rubber))
    /// #         .straight([0.0, 0.0], [1.0, 0.0], 4)
    /// #         .density(7200.0),
    /// # )?;
    /// # scene.pin(beam.start())?;
    /// # scene.gravity([0.0, -9.81])?;
    /// # let system = scene.assemble()?;
    /// // When does the tip of a falling pendulum pass a wall at x = 0.9 m?
    /// let tip = system.coordinate(beam.end(), NodalVector::Position)?;
    /// let beyond = |state: &State<f64>| 1.0 + state.displacement[tip] - 0.9;
    /// let mut run = Integration::start(&system, system.rest(), &Newmark::trapezoidal())?;
    /// let met = run.until_event(1.0, Stepping::Fixed(1e-3), Crossing::Falling, beyond, |_| {})?;
    /// assert!(met == Ending::Event && beyond(run.state()).abs() < 1e-12);
    /// # Ok::<(), ancf::Error>(())
    /// ```
    ///
    /// # Errors
    /// Those of [`until`](Self::until), and [`Error::NotFinite`] when the function is not finite.
    pub fn until_event<O: Observation>(
        &mut self,
        end: R,
        stepping: Stepping,
        crossing: Crossing,
        function: impl FnMut(&State<R>) -> R,
        observe: impl FnMut(Step<'_, R>) -> O,
    ) -> Result<Ending> {
        self.drive(end, stepping, &mut Event::new(crossing, function), observe)
    }

    fn drive<O: Observation>(
        &mut self,
        end: R,
        stepping: Stepping,
        watch: &mut impl Watch<R>,
        mut observe: impl FnMut(Step<'_, R>) -> O,
    ) -> Result<Ending> {
        finite("end of the run [s]", end)?;
        if end < self.state.time {
            return Err(Error::OutOfRange {
                what: "end of the run [s]",
                value: end.value(),
                range: "the time after the present state",
                remedy: "give a later end, or start again from an earlier state",
            });
        }
        self.end = end;
        match stepping {
            Stepping::Fixed(step) => self.equal(step, 0, watch, &mut observe),
            Stepping::Halved { step, halvings } => self.equal(step, halvings, watch, &mut observe),
            Stepping::Stable(share) => self.stable(share, watch, &mut observe),
            Stepping::Adaptive(control) => self.adaptive(&control, watch, &mut observe),
        }
    }

    /// Equal steps, in halves where they fail.
    fn equal<O: Observation>(
        &mut self,
        step: f64,
        halvings: u32,
        watch: &mut impl Watch<R>,
        observe: &mut impl FnMut(Step<'_, R>) -> O,
    ) -> Result<Ending> {
        let step = R::lit(positive("time step [s]", step)?);
        let mut pace = Pace::from(self.progress.pace, self.state.time, step, self.end);
        while let Some(part) = pace.next(self.state.time, self.end) {
            self.told(part)?;
            let tried = self.attempt(part);
            let met = self.met(&tried, watch)?;
            if let Err(cause) = tried.and_then(|()| self.narrow(part, met, watch)) {
                let vain = matches!(cause, Error::LoadNotFinite { .. });
                let Some(half) = (!vain).then(|| pace.halve(halvings)).flatten() else {
                    return Err(self.failed(part, cause));
                };
                self.refuse(part, &cause, Some(half));
                continue;
            }
            let taken = self.take(Some(pace.end()), met.is_some(), observe);
            pace.advance();
            self.progress.pace = Some(pace);
            if let Some(ending) = taken? {
                return Ok(ending);
            }
        }
        Ok(Ending::End)
    }

    /// Refuses a step that the clock cannot tell from the steps beside it.
    fn told(&self, step: R) -> Result<()> {
        let least = self.state.time.abs() * R::lit(TICKS * R::EPSILON);
        if step >= least {
            return Ok(());
        }
        Err(Error::OutOfRange {
            what: "time step [s]",
            value: step.value(),
            range: "four rounding units of the time, or more",
            remedy: "the clock would not see the step: start it at zero, or take a number type of more digits",
        })
    }

    /// How far from the event the ends of a step are, if it was taken and meets it.
    fn met<T, E>(
        &self,
        tried: &std::result::Result<T, E>,
        watch: &mut impl Watch<R>,
    ) -> Result<Option<[R; 2]>> {
        match tried {
            Ok(_) => watch.meets(&self.state, &self.next),
            Err(_) => Ok(None),
        }
    }

    /// Shortens the step just tried to the part up to the event that it met, if it did.
    fn narrow(&mut self, step: R, met: Option<[R; 2]>, watch: &mut impl Watch<R>) -> Result<()> {
        let Some(distances) = met else { return Ok(()) };
        let least = self.next.time.abs() * R::lit(TICKS * R::EPSILON);
        locate([R::zero(), step], distances, least, |part| {
            self.attempt(part)?;
            Ok(watch.distance(&self.next))
        })
        .map(|_| ())
    }

    /// Takes the step just tried, which ends at `time` if that is known better than by summing, or
    /// at an event, and says whether the run ends with it.
    fn take<O: Observation>(
        &mut self,
        time: Option<R>,
        event: bool,
        observe: &mut impl FnMut(Step<'_, R>) -> O,
    ) -> Result<Option<Ending>> {
        if let (Some(time), false) = (time, event) {
            self.next.time = time;
        }
        self.accept();
        let flow = observe(self.last()).flow()?;
        let stopped = flow.is_break().then_some(Ending::Stopped);
        Ok(event.then_some(Ending::Event).or(stopped))
    }

    fn stable<O: Observation>(
        &mut self,
        share: f64,
        watch: &mut impl Watch<R>,
        observe: &mut impl FnMut(Step<'_, R>) -> O,
    ) -> Result<Ending> {
        let share = R::lit(positive("share of the longest stable step", share)?);
        while let Some(left) = self.left() {
            let Some(limit) = self.method.stable_step(self.structure, &self.state)? else {
                return Err(Error::Unsupported {
                    what: "steps by stability with a method that is stable at any step".into(),
                    remedy: "use Stepping::Fixed or Stepping::Adaptive",
                });
            };
            let step = even(left, share * limit);
            self.sure(step)?;
            let time = (step == left).then_some(self.end);
            let met = watch.meets(&self.state, &self.next)?;
            let narrowed = self.narrow(step, met, watch);
            narrowed.map_err(|cause| self.failed(step, cause))?;
            if let Some(ending) = self.take(time, met.is_some(), observe)? {
                return Ok(ending);
            }
        }
        Ok(Ending::End)
    }

    /// Time left to the end; what rounding of the time leaves is no step.
    fn left(&mut self) -> Option<R> {
        let (end, now) = (self.end, self.state.time);
        let left = end - now;
        if left <= end.abs().larger(now.abs()) * R::lit(TICKS * R::EPSILON) {
            self.state.time = end;
            return None;
        }
        Some(left)
    }

    fn adaptive<O: Observation>(
        &mut self,
        control: &Adaptive,
        watch: &mut impl Watch<R>,
        observe: &mut impl FnMut(Step<'_, R>) -> O,
    ) -> Result<Ending> {
        control.check()?;
        while let Some(left) = self.left() {
            let first = || R::lit(control.first);
            let mut step = self.progress.proposed.unwrap_or_else(first);
            step = step.smaller(R::lit(control.longest));
            if let Some(limit) = self.method.stable_step(self.structure, &self.state)? {
                step = step.smaller(limit * R::lit(0.9));
            }
            let trial = even(left, step);
            let judged = match self.attempt(trial) {
                Ok(()) => self.judge(control),
                Err(error @ Error::LoadNotFinite { .. }) => return Err(self.failed(trial, error)),
                Err(error) => Err((0.25, error)),
            };
            let met = self.met(&judged, watch)?;
            let narrowed = judged.and_then(|factor| match self.narrow(trial, met, watch) {
                Ok(()) => Ok(factor),
                Err(error) => Err((0.25, error)),
            });
            match narrowed {
                Ok(factor) => {
                    let asked = trial * R::lit(factor);
                    // A step cut short by the end says nothing against the longer one proposed.
                    let cut = trial < step;
                    let next = if cut { step.larger(asked) } else { asked };
                    // Before the step is taken: it may be the last of this call.
                    self.progress.proposed = Some(next);
                    if let Some(ending) = self.take(None, met.is_some(), observe)? {
                        return Ok(ending);
                    }
                }
                Err((factor, cause)) => {
                    let asked = trial * R::lit(factor);
                    self.progress.proposed = Some(asked);
                    let short = asked.value() < control.shortest;
                    self.refuse(trial, &cause, (!short).then_some(asked));
                    if short {
                        return Err(self.stuck(trial, asked, control, cause));
                    }
                }
            }
        }
        Ok(Ending::End)
    }

    /// The factor for the next step, if the step just tried meets the tolerance, and otherwise that
    /// for the same and why.
    fn judge(&mut self, control: &Adaptive) -> std::result::Result<f64, (f64, Error)> {
        let (error, size) = self.method.error(self.structure, &self.state, &self.next);
        let size = self.progress.motion.larger(size);
        let error = (error / size.larger(R::lit(control.least_motion))).value();
        let order = f64::from(self.method.error_order());
        finite("local error of the step over its motion", error).map_err(|cause| (0.25, cause))?;
        let tolerance = control.tolerance;
        // No error at all lets the step grow a hundredfold at most.
        let share = (error / tolerance).max(1e-6);
        if error > tolerance {
            let factor = control.safety * share.powf(-1.0 / order);
            let cause = Error::Inaccurate { error, tolerance };
            return Err((factor.clamp(0.1, 0.9), cause));
        }
        let [integral, proportional] = control.gains.map(|gain| gain / order);
        let trend = (self.progress.error / share).powf(proportional);
        let factor = control.safety * share.powf(-integral) * trend;
        self.progress.motion = size;
        self.progress.error = share;
        Ok(factor.clamp(0.3, 2.0))
    }

    /// Computes the next state without taking the step.
    fn attempt(&mut self, step: R) -> Result<()> {
        let solved = self
            .method
            .advance(self.structure, &self.state, &mut self.next, step)?;
        self.progress.report.iterations += solved.iterations;
        self.progress.report.tangents += solved.tangents;
        self.floored = solved.at_floor;
        Ok(())
    }

    /// The same where nothing else is tried if it fails.
    fn sure(&mut self, step: R) -> Result<()> {
        self.attempt(step).map_err(|cause| self.failed(step, cause))
    }

    fn accept(&mut self) {
        self.method.accept(&self.state, &self.next);
        std::mem::swap(&mut self.state, &mut self.next);
        self.progress.report.steps += 1;
        self.progress.report.at_floor += usize::from(self.floored);
    }

    /// The step just accepted.
    fn last(&self) -> Step<'_, R> {
        Step {
            before: &self.next,
            after: &self.state,
            report: &self.progress.report,
            span: [self.progress.start, self.end],
            order: self.method.order(),
        }
    }

    /// Counts and logs a step that is not taken.
    fn refuse(&mut self, step: R, cause: &Error, retry: Option<R>) {
        let report = &mut self.progress.report;
        match cause {
            Error::Inaccurate { .. } => report.rejected += 1,
            _ => report.failed += 1,
        }
        self.log.refused(Refusal {
            time: self.state.time,
            step,
            cause,
            retry,
        });
    }

    /// Counts and logs the step that ends a run.
    fn failed(&mut self, step: R, cause: Error) -> Error {
        self.refuse(step, &cause, None);
        self.step_failed(step, cause)
    }

    /// The end of a run whose error control asks for steps too short.
    fn stuck(&self, trial: R, asked: R, control: &Adaptive, cause: Error) -> Error {
        let cause = match cause {
            Error::Inaccurate { .. } => Error::StepTooShort {
                step: asked.value(),
                shortest: control.shortest,
            },
            other => other,
        };
        self.step_failed(trial, cause)
    }

    fn step_failed(&self, step: R, cause: Error) -> Error {
        Error::StepFailed {
            time: self.state.time.value(),
            step: step.value(),
            cause: Box::new(cause),
        }
    }
}

/// Rounding units of the time below which a step is none.
const TICKS: f64 = 4.0;
