//! The driver of all integrators: fixed steps, halved where they fail, steps below the stability
//! limit, or steps chosen so that the local error stays at a tolerance. Observers see every
//! accepted step and cannot change it; an event ends the run where it happens.

use super::event::{Crossing, Event, Never, Watch, locate};
use super::observe::{Observation, Step};
use super::stepping::{Adaptive, Stepping};
use super::{Method, Scheme};
use crate::error::{Error, Result, finite, positive};
use crate::scalar::Real;
use crate::solver::{State, Structure};

/// What a run took so far.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RunReport {
    /// Steps accepted.
    pub steps: usize,
    /// Steps rejected because their error was too large.
    pub rejected: usize,
    /// Steps in which Newton's method failed and a shorter one was tried.
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
pub struct Integration<'a, R: Real, S, M> {
    structure: &'a S,
    method: M,
    state: State<R>,
    next: State<R>,
    report: RunReport,
    /// Step the error control would take next (s).
    proposed: Option<R>,
    /// Error of the last step accepted over the one allowed.
    error: f64,
    /// Largest size of the motion so far.
    motion: R,
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
            state,
            report: RunReport::default(),
            proposed: None,
            error: 1.0,
            motion: R::zero(),
            floored: false,
        })
    }

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
        self.report
    }

    /// One step of `step` seconds. Allocates nothing.
    ///
    /// # Errors
    /// [`Error::StepFailed`] with the cause; the state before the step is kept.
    pub fn step(&mut self, step: R) -> Result<()> {
        positive("time step [s]", step)?;
        self.told(step)?;
        self.attempt(step)
            .map_err(|cause| self.failed(step, cause))?;
        self.accept();
        Ok(())
    }

    /// Runs to `end` seconds, showing every accepted step to `observe`.
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
    ) -> Result<()> {
        self.drive(end, stepping, &mut Never, observe)?;
        Ok(())
    }

    /// Runs until `function` of the state crosses zero, but no longer than to `end` seconds, and
    /// says whether it did. The run then stands just behind the crossing, at a state that the
    /// method has stepped to, and can go on from there.
    ///
    /// A function that crosses zero twice within one step is not seen to cross.
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
    /// assert!(met && beyond(run.state()).abs() < 1e-12);
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
    ) -> Result<bool> {
        self.drive(end, stepping, &mut Event::new(crossing, function), observe)
    }

    /// Runs to the end or to the event, and says whether it was the event.
    fn drive<O: Observation>(
        &mut self,
        end: R,
        stepping: Stepping,
        watch: &mut impl Watch<R>,
        mut observe: impl FnMut(Step<'_, R>) -> O,
    ) -> Result<bool> {
        finite("end of the run [s]", end)?;
        if end < self.state.time {
            return Err(Error::OutOfRange {
                what: "end of the run [s]",
                value: end.value(),
                range: "the time after the present state",
                remedy: "give a later end, or start again from an earlier state",
            });
        }
        let (step, halvings) = match stepping {
            Stepping::Fixed(step) => (step, 0),
            Stepping::Halved { step, halvings } => (step, halvings),
            Stepping::Stable(share) => return self.stable(end, share, watch, &mut observe),
            Stepping::Adaptive(control) => {
                return self.adaptive(end, &control, watch, &mut observe);
            }
        };
        let step = R::lit(positive("time step [s]", step)?);
        // Whole steps are counted, not summed, so that rounding adds no sliver at the end.
        let start = self.state.time;
        let count = ((end - start) / step).value();
        let whole = (count + 1e-6).floor();
        for n in 1..=whole as u64 {
            let time = start + step * R::lit(n as f64);
            if self.whole(step, time, halvings, watch, &mut observe)? {
                return Ok(true);
            }
        }
        match self.left(end) {
            Some(rest) if rest > step * R::lit(1e-6) => {
                self.whole(rest, end, halvings, watch, &mut observe)
            }
            _ => Ok(false),
        }
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

    /// One step that ends at `time`, in halves where it fails.
    fn whole<O: Observation>(
        &mut self,
        step: R,
        time: R,
        halvings: u32,
        watch: &mut impl Watch<R>,
        observe: &mut impl FnMut(Step<'_, R>) -> O,
    ) -> Result<bool> {
        self.told(step)?;
        match self.attempt(step) {
            Ok(()) => self.take(step, Some(time), watch, observe),
            Err(cause @ Error::LoadNotFinite { .. }) => Err(self.failed(step, cause)),
            Err(cause) if halvings == 0 => Err(self.failed(step, cause)),
            Err(_) => {
                self.report.failed += 1;
                let half = step * R::lit(0.5);
                let middle = time - half;
                Ok(self.whole(half, middle, halvings - 1, watch, observe)?
                    || self.whole(half, time, halvings - 1, watch, observe)?)
            }
        }
    }

    /// Takes the step just tried, which ends at `time` if that is known better than by summing, or
    /// the part of it up to an event, and says whether there was one.
    fn take<O: Observation>(
        &mut self,
        step: R,
        time: Option<R>,
        watch: &mut impl Watch<R>,
        observe: &mut impl FnMut(Step<'_, R>) -> O,
    ) -> Result<bool> {
        let met = watch.meets(&self.state, &self.next)?;
        if let Some(distances) = met {
            let least = self.next.time.abs() * R::lit(4.0 * R::EPSILON);
            locate([R::zero(), step], distances, least, |part| {
                self.attempt(part)
                    .map_err(|cause| self.failed(part, cause))?;
                Ok(watch.distance(&self.next))
            })?;
        } else if let Some(time) = time {
            self.next.time = time;
        }
        self.accept();
        observe(self.last()).result()?;
        Ok(met.is_some())
    }

    fn stable<O: Observation>(
        &mut self,
        end: R,
        share: f64,
        watch: &mut impl Watch<R>,
        observe: &mut impl FnMut(Step<'_, R>) -> O,
    ) -> Result<bool> {
        let share = R::lit(positive("share of the longest stable step", share)?);
        while let Some(left) = self.left(end) {
            let Some(limit) = self.method.stable_step(self.structure, &self.state)? else {
                return Err(Error::Unsupported {
                    what: "steps by stability with a method that is stable at any step".into(),
                    remedy: "use Stepping::Fixed or Stepping::Adaptive",
                });
            };
            let step = even(left, share * limit);
            let time = (step == left).then_some(end);
            if self.whole(
                step,
                time.unwrap_or(self.state.time + step),
                0,
                watch,
                observe,
            )? {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Time left to `end`; what rounding of the time leaves is no step.
    fn left(&mut self, end: R) -> Option<R> {
        let left = end - self.state.time;
        if left <= end.abs().larger(self.state.time.abs()) * R::lit(TICKS * R::EPSILON) {
            self.state.time = end;
            return None;
        }
        Some(left)
    }

    fn adaptive<O: Observation>(
        &mut self,
        end: R,
        control: &Adaptive,
        watch: &mut impl Watch<R>,
        observe: &mut impl FnMut(Step<'_, R>) -> O,
    ) -> Result<bool> {
        control.check()?;
        let mut step = self.proposed.unwrap_or(R::lit(control.first));
        while let Some(left) = self.left(end) {
            step = step.smaller(R::lit(control.longest));
            if let Some(limit) = self.method.stable_step(self.structure, &self.state)? {
                step = step.smaller(limit * R::lit(0.9));
            }
            let trial = even(left, step);
            let (factor, refused) = match self.attempt(trial) {
                Ok(()) => {
                    let (accepted, factor) = self.judge(control);
                    if accepted && self.take(trial, None, watch, observe)? {
                        return Ok(true);
                    }
                    (factor, (!accepted).then_some(None))
                }
                Err(error @ Error::LoadNotFinite { .. }) => return Err(self.failed(trial, error)),
                Err(error) => {
                    self.report.failed += 1;
                    (0.25, Some(Some(error)))
                }
            };
            let asked = trial * R::lit(factor);
            match refused {
                // A step cut short by the end says nothing against the longer one proposed.
                None if trial < step => step = step.larger(asked),
                _ => step = asked,
            }
            self.proposed = Some(step);
            if let Some(cause) = refused
                && step.value() < control.shortest
            {
                let cause = cause.unwrap_or(Error::StepTooShort {
                    step: step.value(),
                    shortest: control.shortest,
                });
                return Err(self.failed(trial, cause));
            }
        }
        Ok(false)
    }

    /// Whether the step just tried meets the tolerance, and the factor for the next.
    fn judge(&mut self, control: &Adaptive) -> (bool, f64) {
        let (error, size) = self.method.error(self.structure, &self.state, &self.next);
        let size = self.motion.larger(size);
        let error = (error / size.larger(R::lit(control.least_motion))).value();
        let order = f64::from(self.method.error_order());
        if !error.is_finite() {
            self.report.failed += 1;
            return (false, 0.25);
        }
        // No error at all lets the step grow a hundredfold at most.
        let share = (error / control.tolerance).max(1e-6);
        let [integral, proportional] = control.gains.map(|gain| gain / order);
        let trend = (self.error / share).powf(proportional);
        let factor = control.safety * share.powf(-integral) * trend;
        if error <= control.tolerance {
            self.motion = size;
            self.error = share;
            (true, factor.clamp(0.3, 2.0))
        } else {
            self.report.rejected += 1;
            let factor = control.safety * share.powf(-1.0 / order);
            (false, factor.clamp(0.1, 0.9))
        }
    }

    /// Computes the next state without taking the step.
    fn attempt(&mut self, step: R) -> Result<()> {
        let solved = self
            .method
            .advance(self.structure, &self.state, &mut self.next, step)?;
        self.report.iterations += solved.iterations;
        self.report.tangents += solved.tangents;
        self.floored = solved.at_floor;
        Ok(())
    }

    fn accept(&mut self) {
        self.method.accept(&self.state, &self.next);
        std::mem::swap(&mut self.state, &mut self.next);
        self.report.steps += 1;
        self.report.at_floor += usize::from(self.floored);
    }

    /// The step just accepted.
    fn last(&self) -> Step<'_, R> {
        Step {
            before: &self.next,
            after: &self.state,
            order: self.method.order(),
        }
    }

    fn failed(&self, step: R, cause: Error) -> Error {
        Error::StepFailed {
            time: self.state.time.value(),
            step: step.value(),
            cause: Box::new(cause),
        }
    }
}

/// Rounding units of the time below which a step is none.
const TICKS: f64 = 4.0;

/// A step towards an end `left` seconds away: two even steps rather than one and a sliver.
fn even<R: Real>(left: R, step: R) -> R {
    match left {
        left if left <= step => left,
        left if left < step * R::lit(2.0) => left * R::lit(0.5),
        _ => step,
    }
}
