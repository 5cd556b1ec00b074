//! The driver of all integrators: fixed steps, or steps chosen so that the local error stays at a
//! tolerance. Observers see every accepted step and cannot change it.

use super::{Method, Scheme};
use crate::error::{Error, Result, finite, positive};
use crate::scalar::Real;
use crate::solver::{State, Structure};

/// How steps are chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stepping {
    /// Equal steps of this many seconds; a step that fails ends the run.
    Fixed(f64),
    /// Steps by local error control.
    Adaptive(Adaptive),
}

/// Error-controlled stepping: a step is accepted when its relative local error is below the
/// tolerance, and the next is `safety * dt * (tolerance / error)^(1/3)` (the paper's procedure).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Adaptive {
    /// Relative local error allowed.
    pub tolerance: f64,
    /// First step (s).
    pub first: f64,
    /// Longest step (s).
    pub longest: f64,
    /// Shortest step (s): below it the run ends with an error.
    pub shortest: f64,
    /// Factor applied to the step that would just meet the tolerance.
    pub safety: f64,
    /// Displacements, as a share of the size of the structure, below which the error is measured
    /// against this share and no longer against the motion: motions far smaller than it are not
    /// resolved. The motion is the largest so far.
    pub least_motion: f64,
}

impl Adaptive {
    /// Error control to `tolerance` with usual limits: first step 10 us, steps between 1 ns and
    /// 0.1 s, least motion a millionth of the structure.
    pub fn to(tolerance: f64) -> Self {
        Self {
            tolerance,
            first: 1e-5,
            longest: 0.1,
            shortest: 1e-9,
            safety: 0.8,
            least_motion: 1e-6,
        }
    }
}

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

/// An accepted step, as observers see it.
#[derive(Debug, Clone, Copy)]
pub struct Step<'a, R> {
    /// State at the start of the step.
    pub before: &'a State<R>,
    /// State at its end.
    pub after: &'a State<R>,
}

impl<R: Real> Step<'_, R> {
    /// Whether a time (s) lies within the step: after its start, up to its end.
    pub fn contains(&self, time: R) -> bool {
        time > self.before.time && time <= self.after.time
    }

    /// Displacement of coordinate `i` at a time (s) within the step, by cubic Hermite
    /// interpolation.
    ///
    /// # Errors
    /// [`Error::NoSuchCoordinate`] when the structure has no coordinate `i`.
    pub fn displacement_at(&self, time: R, i: usize) -> Result<R> {
        let size = self.after.displacement.len();
        if i >= size {
            return Err(Error::NoSuchCoordinate { index: i, size });
        }
        let step = self.after.time - self.before.time;
        let x = (time - self.before.time) / step;
        let y = R::one() - x;
        let (two, three) = (R::lit(2.0), R::lit(3.0));
        let (u0, u1) = (self.before.displacement[i], self.after.displacement[i]);
        let (v0, v1) = (self.before.velocity[i], self.after.velocity[i]);
        let change = x * x * (three - two * x) * (u1 - u0);
        Ok(u0 + change + step * x * y * (y * v0 - x * v1))
    }
}

/// What an observer may return: nothing, or a [`Result`] whose error ends the run after the step.
pub trait Observation {
    /// The observation as a result.
    ///
    /// # Errors
    /// The observer's own.
    fn result(self) -> Result<()>;
}

impl Observation for () {
    fn result(self) -> Result<()> {
        Ok(())
    }
}

impl Observation for Result<()> {
    fn result(self) -> Result<()> {
        self
    }
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
        mut observe: impl FnMut(Step<'_, R>) -> O,
    ) -> Result<()> {
        finite("end of the run [s]", end)?;
        if end < self.state.time {
            return Err(Error::OutOfRange {
                what: "end of the run [s]",
                value: end.value(),
                range: "the time after the present state",
                remedy: "give a later end, or start again from an earlier state",
            });
        }
        match stepping {
            Stepping::Fixed(step) => {
                self.fixed(end, R::lit(positive("time step [s]", step)?), &mut observe)
            }
            Stepping::Adaptive(control) => self.adaptive(end, &control, &mut observe),
        }
    }

    fn fixed<O: Observation>(
        &mut self,
        end: R,
        step: R,
        observe: &mut impl FnMut(Step<'_, R>) -> O,
    ) -> Result<()> {
        // Whole steps are counted, not summed, so that rounding adds no sliver at the end.
        let start = self.state.time;
        let count = ((end - start) / step).value();
        let whole = (count + 1e-6).floor();
        for n in 1..=whole as u64 {
            self.step(step)?;
            self.state.time = start + step * R::lit(n as f64);
            observe(self.last()).result()?;
        }
        let rest = end - self.state.time;
        if rest > step * R::lit(1e-6) {
            self.step(rest)?;
            self.state.time = end;
            observe(self.last()).result()?;
        }
        Ok(())
    }

    fn adaptive<O: Observation>(
        &mut self,
        end: R,
        control: &Adaptive,
        observe: &mut impl FnMut(Step<'_, R>) -> O,
    ) -> Result<()> {
        for (what, value) in [
            ("tolerance of the local error", control.tolerance),
            ("first time step [s]", control.first),
            ("longest time step [s]", control.longest),
            ("shortest time step [s]", control.shortest),
            ("safety factor of the step control", control.safety),
            ("least motion of the error control", control.least_motion),
        ] {
            positive(what, value)?;
        }
        let mut step = self.proposed.unwrap_or(R::lit(control.first));
        loop {
            let left = end - self.state.time;
            // What rounding of the time leaves is no step.
            if left <= end.abs().larger(self.state.time.abs()) * R::lit(4.0 * R::EPSILON) {
                self.state.time = end;
                return Ok(());
            }
            step = step.smaller(R::lit(control.longest));
            // Two even steps rather than one and a sliver.
            let trial = match left {
                left if left <= step => left,
                left if left < step * R::lit(2.0) => left * R::lit(0.5),
                _ => step,
            };
            let (factor, refused) = match self.attempt(trial) {
                Ok(()) => {
                    let (accepted, factor) = self.judge(control);
                    if accepted {
                        self.accept();
                        observe(self.last()).result()?;
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
    }

    /// Whether the step just tried meets the tolerance, and the factor for the next.
    fn judge(&mut self, control: &Adaptive) -> (bool, f64) {
        let (error, size) = self.method.error(self.structure, &self.state, &self.next);
        let size = self.motion.larger(size);
        let error = (error / size.larger(R::lit(control.least_motion))).value();
        if !error.is_finite() {
            self.report.failed += 1;
            return (false, 0.25);
        }
        let ratio = (control.tolerance / error).min(1e6);
        let factor = control.safety * ratio.powf(1.0 / f64::from(M::ERROR_ORDER));
        if error <= control.tolerance {
            self.motion = size;
            (true, factor.clamp(0.3, 2.0))
        } else {
            self.report.rejected += 1;
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
