//! How far a path of equilibria has come: what its checkpoints know, and which steps it refused.

use super::continuation::Continuation;
use super::critical::Critical;
use super::newton::{Refresh, Stability};
use super::path::{Path, PathReport};
use super::{Checkpoint, Structure, Tape};
use crate::error::{Error, Result, finite, positive};
use crate::scalar::Real;

/// A step along a path that was tried and not taken; one half as long was tried next.
#[derive(Debug, Clone, PartialEq)]
pub struct PathRefusal<R> {
    /// Share of the external load at which the step began.
    pub factor: R,
    /// The step, in units of what is [prescribed](super::Control).
    pub step: R,
    /// Why it was not taken.
    pub cause: Error,
}

/// All that a path goes on from beside its last equilibrium.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Progress<R> {
    factor: R,
    /// What is known of the stability of the last point and of that before.
    stability: [Stability; 2],
    /// Displacements and load factor of the point before.
    before: Option<(Vec<R>, R)>,
    /// The step that is tried next.
    step: R,
    criticals: Vec<Critical<R>>,
    report: PathReport,
}

impl<R: Real> Progress<R> {
    fn check(&self, size: usize) -> Result<()> {
        finite("load factor", self.factor)?;
        positive("step along the path", self.step.abs())?;
        if let Some((displacements, factor)) = &self.before {
            Error::check_length(
                "displacements of the point before",
                displacements.len(),
                size,
            )?;
            for u in displacements {
                finite("displacement of the point before", *u)?;
            }
            finite("load factor of the point before", *factor)?;
        }
        for critical in &self.criticals {
            critical.state.check(size)?;
            Error::check_length("critical direction", critical.shape.len(), size)?;
        }
        Ok(())
    }
}

/// A path of equilibria between two steps, to be resumed: taken by [`Continuation::checkpoint`], used
/// by [`Continuation::resume`].
pub type PathCheckpoint<R> = Checkpoint<R, Progress<R>>;

impl<R: Real> PathCheckpoint<R> {
    /// What the path had taken up to there.
    pub fn report(&self) -> PathReport {
        self.progress().report
    }
}

/// The tangent at the last point is kept for the next step, whatever the settings.
const KEPT: Refresh = Refresh::WhenSlow;

impl<'a, R: Real, S: Structure<R>> Continuation<'a, R, S> {
    /// All that the path needs to be [resumed](Self::resume) from the last equilibrium. What the
    /// path does next does not depend on whether a checkpoint was taken.
    ///
    /// # Errors
    /// When a number that belongs to it is not finite.
    pub fn checkpoint(&mut self) -> Result<PathCheckpoint<R>> {
        let progress = Progress {
            factor: self.factor,
            stability: [self.stability, self.was],
            before: self.before.clone(),
            step: self.step,
            criticals: self.criticals.clone(),
            report: self.report,
        };
        progress.check(self.u.len())?;
        let settings = format!("{:?}", self.settings);
        let history = |tape: &mut Tape<R>| self.workspace.history(KEPT, tape);
        Checkpoint::take(
            self.structure,
            &settings,
            self.state.clone(),
            progress,
            history,
        )
    }

    /// Goes on from a checkpoint, to the last bit as the path that it was taken from would have gone
    /// on. On another kind of processor, whose lanes round otherwise, the last digits differ.
    ///
    /// ```
    /// use ancf::prelude::*;
    ///
    /// # let rubber = SaintVenantKirchhoff::isotropic(2.0e7, 0.0)?;
    /// # let mut scene = Scene::<f64, 2>::new();
    /// # let beam = Beam::new(FullyParameterised, Disk::new(0.01)?, Continuum::full(rubber));
    /// # let beam = scene.add(beam.straight([0.0, 0.0], [1.0, 0.0], 4))?;
    /// # scene.clamp(beam.start())?;
    /// # scene.force(beam.end(), [0.0, 0.3])?;
    /// # let system = scene.assemble()?;
    /// let settings = Path::default();
    /// let mut path = Continuation::start(&system, system.rest(), 0.0, &settings)?;
    /// path.until(Target::Points(5), |_| {})?;
    /// let kept = path.checkpoint()?;
    /// path.until(Target::Factor(1.0), |_| {})?;
    ///
    /// let mut again = Continuation::resume(&system, &kept, &settings)?;
    /// again.until(Target::Factor(1.0), |_| {})?;
    /// assert_eq!(again.state(), path.state());
    /// # Ok::<(), ancf::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::ForeignCheckpoint`] naming what differs, [`Error::Length`] for a system of another
    /// size, [`Error::NotFinite`] and the like for a checkpoint that is damaged.
    pub fn resume(
        structure: &'a S,
        checkpoint: &PathCheckpoint<R>,
        settings: &Path,
    ) -> Result<Self> {
        checkpoint.check(structure, ("path", &format!("{settings:?}")))?;
        let progress = checkpoint.progress();
        progress.check(structure.unknowns().coordinates())?;
        let state = checkpoint.state().clone();
        let mut path = Self::at(structure, state, progress.factor, settings)?;
        checkpoint.restore(|tape| path.workspace.history(KEPT, tape))?;
        path.workspace.stay();
        [path.stability, path.was] = progress.stability;
        path.before.clone_from(&progress.before);
        path.step = progress.step;
        path.criticals.clone_from(&progress.criticals);
        path.report = progress.report;
        Ok(path)
    }
}
