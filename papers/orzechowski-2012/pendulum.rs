//! Section 5.2: a soft pendulum released from the horizontal. Trajectories with error-controlled
//! steps for several meshes and both Poisson ratios, distances to the limit that finer meshes
//! approach, and the energies of a run of 10 s.

use ancf::prelude::*;
use indicatif::ProgressBar;

use crate::model::{Rule, Specimen};
use crate::parallel;
use crate::track::{Plan, Track};

/// Young's modulus (Pa).
pub const YOUNG: f64 = 2e7;
/// Radius (m).
pub const RADIUS: f64 = 0.01;
/// Meshes: the paper's two and two finer ones.
pub const MESHES: [usize; 4] = [6, 10, 20, 40];
/// Tolerance of the local error.
pub const TOLERANCE: f64 = 1e-4;

/// How the steps of a run are chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Steps {
    /// Fixed steps of this length (s).
    Fixed(f64),
    /// Error control with this estimator at [`TOLERANCE`].
    Controlled(Estimator),
}

impl Steps {
    /// Name in tables and files.
    pub fn name(self) -> String {
        match self {
            Self::Fixed(step) => format!("fixed{step}"),
            Self::Controlled(estimator) => format!("{estimator:?}"),
        }
    }
}

/// One run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    /// Number of elements.
    pub elements: usize,
    /// Poisson ratio.
    pub poisson: f64,
    /// Integration rule.
    pub rule: Rule,
    /// Steps.
    pub steps: Steps,
    /// End of the run (s).
    pub end: f64,
}

impl Case {
    fn run(&self) -> Result<Track> {
        let specimen = Specimen {
            elements: self.elements,
            young: YOUNG,
            poisson: self.poisson,
            rule: self.rule,
        };
        let (system, beam) = specimen.pendulum(Disk::new(RADIUS)?, 0.0)?;
        let (method, stepping) = match self.steps {
            Steps::Fixed(step) => (Newmark::trapezoidal(), Stepping::Fixed(step)),
            Steps::Controlled(estimator) => (
                Newmark::trapezoidal().with_estimator(estimator),
                Stepping::Adaptive(Adaptive::to(TOLERANCE)),
            ),
        };
        let plan = Plan {
            method,
            stepping,
            end: self.end,
            every: 0.01,
        };
        Track::run(&system, beam.end(), &plan)
    }
}

/// All runs.
#[derive(Debug, Clone)]
pub struct Study {
    runs: Vec<(Case, Track)>,
}

/// The paper's estimator.
pub const LI: Steps = Steps::Controlled(Estimator::LiZengWiberg);
/// The other estimator.
pub const ZIENKIEWICZ: Steps = Steps::Controlled(Estimator::ZienkiewiczXie);
/// Steps fine enough that the mesh is what is measured.
pub const FINE: Steps = Steps::Fixed(1e-4);

/// The runs of the study, longest first.
pub fn cases(quick: bool) -> Vec<Case> {
    let case = |elements, poisson, rule, steps, end| Case {
        elements,
        poisson,
        rule,
        steps,
        end,
    };
    let mut cases = Vec::new();
    for elements in MESHES.into_iter().rev() {
        if quick && elements > 10 {
            continue;
        }
        cases.push(case(elements, 0.0, Rule::Full, FINE, 2.0));
        for poisson in [0.0, 0.3] {
            cases.push(case(elements, poisson, Rule::Full, LI, 2.0));
        }
    }
    cases.push(case(6, 0.0, Rule::Full, LI, 10.0));
    cases.push(case(6, 0.0, Rule::Full, ZIENKIEWICZ, 10.0));
    cases.push(case(10, 0.0, Rule::Reduced, FINE, 2.0));
    for rule in [Rule::SelectiveReduced, Rule::ZeroPoisson] {
        let elements = if quick { 10 } else { 40 };
        cases.push(case(elements, 0.3, rule, LI, 2.0));
        if !quick {
            cases.push(case(10, 0.3, rule, LI, 2.0));
        }
    }
    for elements in [10, 6] {
        cases.push(case(elements, 0.0, Rule::Full, ZIENKIEWICZ, 2.0));
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

    /// The run with full integration, if it was made.
    pub fn full(&self, elements: usize, poisson: f64, steps: Steps, end: f64) -> Option<&Track> {
        self.find(elements, poisson, Rule::Full, steps, end)
    }

    /// A run, if it was made.
    pub fn find(
        &self,
        elements: usize,
        poisson: f64,
        rule: Rule,
        steps: Steps,
        end: f64,
    ) -> Option<&Track> {
        let wanted = Case {
            elements,
            poisson,
            rule,
            steps,
            end,
        };
        let found = self.runs.iter().find(|(case, _)| *case == wanted);
        found.map(|(_, track)| track)
    }
}
