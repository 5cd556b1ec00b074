//! Runs that are saved and go on later, in another process: a checkpoint is plain data, and its file
//! format is the user's (with the feature `serde`).

use super::Method;
use super::driver::RunReport;
use super::pace::Pace;
use crate::error::{Error, Result, finite, positive};
use crate::scalar::Real;
use crate::solver::{Record, State, Structure, Tape, norm};

/// How far a run has come and what its step control remembers: all of it but the state and what the
/// method remembers itself.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Progress<R> {
    /// Time at which the integration began (s).
    pub(super) start: R,
    pub(super) report: RunReport,
    /// Step the error control would take next (s).
    pub(super) proposed: Option<R>,
    /// Error of the last step accepted over the one allowed.
    pub(super) error: f64,
    /// Largest size of the motion so far.
    pub(super) motion: R,
    /// Equal steps under way.
    pub(super) pace: Option<Pace<R>>,
}

impl<R: Real> Progress<R> {
    pub(super) fn new(start: R) -> Self {
        Self {
            start,
            report: RunReport::default(),
            proposed: None,
            error: 1.0,
            motion: R::zero(),
            pace: None,
        }
    }

    fn check(&self) -> Result<()> {
        finite("time at which the integration began [s]", self.start)?;
        finite("largest size of the motion", self.motion)?;
        positive("error of the last step over the one allowed", self.error)?;
        if let Some(step) = self.proposed {
            positive("time step proposed [s]", step)?;
        }
        Ok(())
    }
}

/// A run at a step, to be resumed: taken by [`Integration::checkpoint`](super::Integration::checkpoint),
/// used by [`Integration::resume`](super::Integration::resume).
///
/// With the feature `serde` it can be written in any format that keeps every bit of a number; all of
/// its numbers are finite. Write it to a file of another name first and rename that, so that
/// whatever interrupts the program leaves one that is whole (example `resume`).
///
/// It knows the scheme and its settings, and the system by its size, its forces at the state and its
/// mass: it does not resume with others.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Checkpoint<R> {
    /// Version of the library, number type and scheme.
    version: String,
    number: String,
    scheme: String,
    /// Norms of internal forces, external forces and momenta of a given motion, by which the system
    /// is known.
    system: [f64; 3],
    state: State<R>,
    progress: Progress<R>,
    /// What the method remembers.
    history: Record<R>,
}

impl<R: Real> Checkpoint<R> {
    /// The state at which it was taken.
    pub fn state(&self) -> &State<R> {
        &self.state
    }

    /// What the run had taken up to there.
    pub fn report(&self) -> RunReport {
        self.progress.report
    }

    pub(super) fn progress(&self) -> &Progress<R> {
        &self.progress
    }

    pub(super) fn take<S: Structure<R>>(
        structure: &S,
        scheme: &str,
        state: State<R>,
        progress: Progress<R>,
        method: &mut impl Method<R>,
    ) -> Result<Self> {
        state.check(structure.unknowns().coordinates())?;
        progress.check()?;
        let mut tape = Tape::write();
        method.history(&mut tape)?;
        Ok(Self {
            version: VERSION.into(),
            number: std::any::type_name::<R>().into(),
            scheme: scheme.into(),
            system: answer(structure, &state)?,
            state,
            progress,
            history: tape.end()?,
        })
    }

    /// Refuses a checkpoint of another run, or a damaged one.
    pub(super) fn check<S: Structure<R>>(&self, structure: &S, scheme: &str) -> Result<()> {
        for (what, given, needed) in [
            ("version of the library", &self.version[..], VERSION),
            ("number type", &self.number, std::any::type_name::<R>()),
            ("scheme", &self.scheme, scheme),
        ] {
            if given != needed {
                return Err(foreign(what, given, needed));
            }
        }
        self.state.check(structure.unknowns().coordinates())?;
        self.progress.check()?;
        let [internal, external, mass] = answer(structure, &self.state)?;
        let forces = internal.max(external);
        for ((what, now, scale), then) in [
            (
                "system, by its internal forces at the state [N m]",
                internal,
                forces,
            ),
            (
                "system, by its external forces at the state [N m]",
                external,
                forces,
            ),
            ("system, by its mass [kg m^2]", mass, mass),
        ]
        .into_iter()
        .zip(self.system)
        {
            finite("measure of the system in the checkpoint", then)?;
            // Lanes of another processor round otherwise.
            let rounding = R::EPSILON.sqrt() * scale.max(then);
            if now != then && (now - then).abs() > rounding {
                return Err(foreign(what, &format!("{then:e}"), &format!("{now:e}")));
            }
        }
        Ok(())
    }

    pub(super) fn restore(&self, method: &mut impl Method<R>) -> Result<()> {
        let mut tape = Tape::read(self.history.clone());
        method.history(&mut tape)?;
        tape.end()?;
        Ok(())
    }
}

const VERSION: &str = env!("CARGO_PKG_VERSION");

fn foreign(what: &'static str, given: &str, needed: &str) -> Error {
    Error::ForeignCheckpoint {
        what,
        given: given.into(),
        needed: needed.into(),
    }
}

/// By what a system is known: the norms, in natural sizes, of its internal forces and of its
/// external forces at a state, and of its momenta in a motion that moves everything.
fn answer<R: Real, S: Structure<R>>(structure: &S, state: &State<R>) -> Result<[f64; 3]> {
    let (u, measure) = (&state.displacement, structure.measure());
    let mut q = vec![R::zero(); u.len()];
    let size = |q: &mut [R]| {
        let parts = q.iter().zip(measure).map(|(q, size)| *q * *size);
        let square: R = parts.map(|part| part * part).sum();
        q.fill(R::zero());
        finite(
            "force of the system at the checkpoint [N m]",
            norm(square).value(),
        )
    };
    structure.add_internal(u, &mut q);
    structure.add_holding(state.time, u, &mut q);
    let internal = size(&mut q)?;
    structure.add_external(state.time, R::one(), u, &mut q)?;
    let external = size(&mut q)?;
    let motion = |(i, size): (usize, &R)| *size * R::lit((i as f64 + 1.0).sin());
    let motion: Vec<R> = measure.iter().enumerate().map(motion).collect();
    structure.add_mass_times(R::one(), &motion, &mut q);
    Ok([internal, external, size(&mut q)?])
}
