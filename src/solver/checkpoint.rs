//! Runs that are saved and go on later, in another process: a checkpoint is plain data, and its file
//! format is the user's (with the feature `serde`). Integrations and paths of equilibria are saved
//! alike, and say themselves how far they have come.

use super::{Record, State, Structure, Tape, norm};
use crate::error::{Error, Result, finite};
use crate::scalar::Real;

/// A run between two steps, to be resumed, with its progress `P`: an
/// [integration](crate::integrator::Checkpoint) or a [path of equilibria](super::PathCheckpoint).
///
/// With the feature `serde` it can be written in any format that keeps every bit of a number; all of
/// its numbers are finite. Write it to a file of another name first and rename that, so that
/// whatever interrupts the program leaves one that is whole (example `resume`).
///
/// It knows the scheme or the path with its settings, and the system by its size, its forces at the
/// state and its mass: it does not resume with others.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Checkpoint<R, P> {
    /// Version of the library, number type, and scheme or path with its settings.
    version: String,
    number: String,
    settings: String,
    /// Norms of internal forces, external forces and momenta of a given motion, by which the system
    /// is known.
    system: [f64; 3],
    state: State<R>,
    progress: P,
    /// What the solver or the method remembers.
    history: Record<R>,
}

impl<R: Real, P> Checkpoint<R, P> {
    /// The state at which it was taken.
    pub fn state(&self) -> &State<R> {
        &self.state
    }

    pub(crate) fn progress(&self) -> &P {
        &self.progress
    }

    /// Takes one, with what `history` shows the tape; `settings` in words.
    pub(crate) fn take<S: Structure<R>>(
        structure: &S,
        settings: &str,
        state: State<R>,
        progress: P,
        history: impl FnOnce(&mut Tape<R>) -> Result<()>,
    ) -> Result<Self> {
        state.check(structure.unknowns().coordinates())?;
        let mut tape = Tape::write();
        history(&mut tape)?;
        Ok(Self {
            version: VERSION.into(),
            number: std::any::type_name::<R>().into(),
            settings: settings.into(),
            system: answer(structure, &state)?,
            state,
            progress,
            history: tape.end()?,
        })
    }

    /// Refuses a checkpoint of a run with other settings, named by `what` they are of, or of another
    /// system, or a damaged one.
    pub(crate) fn check<S: Structure<R>>(
        &self,
        structure: &S,
        (what, settings): (&'static str, &str),
    ) -> Result<()> {
        for (what, given, needed) in [
            ("version of the library", &self.version[..], VERSION),
            ("number type", &self.number, std::any::type_name::<R>()),
            (what, &self.settings, settings),
        ] {
            if given != needed {
                return Err(foreign(what, given, needed));
            }
        }
        self.state.check(structure.unknowns().coordinates())?;
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

    /// Gives back to `history` what it showed when this was taken.
    pub(crate) fn restore(&self, history: impl FnOnce(&mut Tape<R>) -> Result<()>) -> Result<()> {
        let mut tape = Tape::read(self.history.clone());
        history(&mut tape)?;
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
    if structure.has_mass() {
        structure.add_mass_times(R::one(), &motion, &mut q);
    }
    Ok([internal, external, size(&mut q)?])
}
