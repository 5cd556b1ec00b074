//! Why the paper's fixed-step Newmark runs may not have converged: the pendulum of six elements
//! for 10 s with steps of 10 to 0.1 ms and the tangent renewed in every iteration, once per step,
//! or never; with the disk and, for comparison, with a square. Energies are summed over section
//! points, as in the paper: the sums over a square cancel to the last bit, so that it never leaves
//! the plane (nor does any section integrated from its moments, the library's choice); a square
//! pushed sideways by a millionth of a millionth of a metre per second squared shows what that is
//! worth.

use ancf::prelude::*;
use ancf::verify::ByPoints;
use indicatif::ProgressBar;

use crate::model::{Rule, Specimen};
use crate::parallel;
use crate::pendulum::{RADIUS, YOUNG};
use crate::track::{Plan, Track};

/// Shape of the section.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// The paper's disk.
    Disk,
    /// A square of the same second moment of area.
    Square,
    /// The same square with [`NUDGE`] sideways.
    NudgedSquare,
}

/// Sideways component of gravity (m/s^2) that takes the square out of its plane.
pub const NUDGE: f64 = 1e-12;

/// One run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    /// Section.
    pub shape: Shape,
    /// When the tangent is renewed.
    pub refresh: Refresh,
    /// Step (s).
    pub step: f64,
    /// Residual at which an iteration is taken as converged, relative to the forces.
    pub residual: f64,
    /// Integration rule.
    pub rule: Rule,
}

/// The residual tolerance of the study.
pub const RESIDUAL: f64 = 1e-8;
/// A tolerance near what rounding allows.
pub const TIGHT: f64 = 1e-10;

impl Case {
    /// A run of the disk.
    pub fn disk(refresh: Refresh, step: f64) -> Self {
        Self {
            shape: Shape::Disk,
            refresh,
            step,
            residual: RESIDUAL,
            rule: Rule::Full,
        }
    }

    /// The same run with the paper's reduced rule.
    pub fn reduced(refresh: Refresh, step: f64) -> Self {
        Self {
            rule: Rule::Reduced,
            ..Self::disk(refresh, step)
        }
    }

    /// The same run of the square.
    pub fn square(refresh: Refresh, step: f64) -> Self {
        Self {
            shape: Shape::Square,
            ..Self::disk(refresh, step)
        }
    }

    /// The same run of the nudged square.
    pub fn nudged(refresh: Refresh, step: f64) -> Self {
        Self {
            shape: Shape::NudgedSquare,
            ..Self::disk(refresh, step)
        }
    }

    /// Name of the way the tangent is renewed.
    pub fn tangent(&self) -> &'static str {
        match self.refresh {
            Refresh::EveryIteration => "every iteration",
            Refresh::EverySolve => "every step",
            Refresh::WhenSlow => "when slow",
            Refresh::Never => "never",
        }
    }

    fn run(&self) -> Result<Track> {
        let specimen = Specimen {
            elements: 6,
            young: YOUNG,
            poisson: 0.0,
            rule: self.rule,
        };
        let material = ByPoints(specimen.material()?);
        let side = (3.0 * std::f64::consts::PI).powf(0.25) * RADIUS;
        let (system, beam) = match self.shape {
            Shape::Disk => specimen.pendulum_of(material, Disk::new(RADIUS)?, 0.0)?,
            Shape::Square => specimen.pendulum_of(material, Rectangle::new(side, side)?, 0.0)?,
            Shape::NudgedSquare => {
                specimen.pendulum_of(material, Rectangle::new(side, side)?, NUDGE)?
            }
        };
        let newton = Newton {
            refresh: self.refresh,
            residual: self.residual,
            ..Newton::default()
        };
        let plan = Plan {
            method: Newmark::trapezoidal().with_newton(newton),
            stepping: Stepping::Fixed(self.step),
            end: 10.0,
            every: 0.02,
        };
        Track::run(&system, beam.end(), &plan)
    }
}

/// All runs.
#[derive(Debug, Clone)]
pub struct Study {
    runs: Vec<(Case, Track)>,
}

/// The runs of the study, longest first.
pub fn cases(quick: bool) -> Vec<Case> {
    use Refresh::{EveryIteration, EverySolve, Never};
    let mut cases = Vec::new();
    if !quick {
        for refresh in [EveryIteration, EverySolve, Never] {
            cases.push(Case::disk(refresh, 1e-4));
        }
        cases.push(Case {
            residual: TIGHT,
            ..Case::disk(Never, 1e-4)
        });
    }
    cases.push(Case::reduced(EverySolve, 1e-2));
    for step in [1e-3, 2e-3, 5e-3, 1e-2] {
        for refresh in [EveryIteration, EverySolve, Never] {
            cases.push(Case::disk(refresh, step));
            cases.push(Case::square(refresh, step));
            cases.push(Case::nudged(refresh, step));
        }
    }
    cases
}

impl Study {
    /// Runs all cases.
    ///
    /// # Errors
    /// When a run cannot be started.
    pub fn run(quick: bool, bar: &ProgressBar) -> Result<Self> {
        let cases = cases(quick);
        let tracks: Result<Vec<_>> = parallel::map(&cases, bar, Case::run).into_iter().collect();
        Ok(Self {
            runs: cases.into_iter().zip(tracks?).collect(),
        })
    }

    /// Every run.
    pub fn runs(&self) -> &[(Case, Track)] {
        &self.runs
    }

    /// A run, if it was made.
    pub fn find(&self, case: Case) -> Option<&Track> {
        let found = self.runs.iter().find(|(other, _)| *other == case);
        found.map(|(_, track)| track)
    }
}
