//! Section 5.3: a slender steel cantilever whose tip force grows from 0 to 1 N within a second,
//! with and without Poisson's ratio, and the remedies for the locking it causes. Statics of the
//! same beam gives the two errors of the element in closed form.

use std::f64::consts::PI;

use ancf::analytical::{Elastica, cantilever_shear_deflection, cantilever_small_deflection};
use ancf::prelude::*;
use indicatif::ProgressBar;

use crate::model::{LENGTH, Rule, Specimen};
use crate::parallel;
use crate::track::{Plan, Track};

/// Young's modulus (Pa).
pub const YOUNG: f64 = 2e11;
/// Radius (m).
pub const RADIUS: f64 = 2.5e-3;
/// Meshes.
pub const MESHES: [usize; 4] = [4, 8, 16, 32];
/// Time step (s). Halving it once more changes the tip at 1 s by less than 1e-3 mm.
pub const STEP: f64 = 2.5e-4;
/// Poisson ratios and rules of the study.
pub const KINDS: [(f64, Rule); 4] = [
    (0.0, Rule::Full),
    (0.3, Rule::Full),
    (0.3, Rule::SelectiveReduced),
    (0.3, Rule::ZeroPoisson),
];

/// One run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    /// Number of elements.
    pub elements: usize,
    /// Poisson ratio and integration rule.
    pub kind: (f64, Rule),
    /// Time step (s).
    pub step: f64,
}

impl Case {
    /// A run with the study's step.
    pub fn new(elements: usize, kind: (f64, Rule)) -> Self {
        Self {
            elements,
            kind,
            step: STEP,
        }
    }

    fn specimen(&self) -> Specimen {
        Specimen {
            elements: self.elements,
            young: YOUNG,
            poisson: self.kind.0,
            rule: self.kind.1,
        }
    }

    fn run(&self) -> Result<Track> {
        let (system, beam) = self.specimen().ramp(Disk::new(RADIUS)?)?;
        let plan = Plan {
            method: Newmark::trapezoidal(),
            stepping: Stepping::Fixed(self.step),
            end: 1.0,
            every: 0.01,
        };
        Track::run(&system, beam.end(), &plan)
    }
}

/// Static tip deflection (m) under a constant force (N).
fn statics(elements: usize, kind: (f64, Rule), force: f64) -> Result<f64> {
    let specimen = Case::new(elements, kind).specimen();
    let (system, beam) = specimen.cantilever(Disk::new(RADIUS)?, force)?;
    let mut state = system.rest();
    Statics::default().solve(&system, &mut state)?;
    Ok(system.displacement(&state, beam.end())?[1])
}

/// Static figures.
#[derive(Debug, Clone)]
pub struct Static {
    /// Elements, and the bending deflection under a small load over Euler and Bernoulli's, for
    /// zero Poisson ratio.
    pub mesh_ratios: Vec<(usize, f64)>,
    /// The same at Poisson ratio 0.3 with full integration and 64 elements.
    pub locked_ratio: f64,
    /// Tip deflection (mm) under 1 N with 64 elements, zero Poisson ratio.
    pub large: f64,
    /// The same of the elastica, exact for a beam without shear and axial strain.
    pub elastica: f64,
}

impl Static {
    fn run() -> Result<Self> {
        // Small enough that thickness locking, which is quadratic in the load, does not show.
        let small = 1e-4;
        let stiffness = YOUNG * PI * RADIUS.powi(4) / 4.0;
        let slender = cantilever_small_deflection(small, LENGTH, stiffness)?;
        let ratio = |elements: usize, kind: (f64, Rule)| -> Result<f64> {
            let shear_stiffness = YOUNG / (2.0 * (1.0 + kind.0)) * PI * RADIUS.powi(2);
            let shear = cantilever_shear_deflection(small, LENGTH, shear_stiffness)?;
            Ok((statics(elements, kind, small)? - shear) / slender)
        };
        let mesh_ratio = |n: usize| Ok((n, ratio(n, KINDS[0])?));
        let load = LENGTH * LENGTH / stiffness;
        Ok(Self {
            mesh_ratios: [1, 2, 4, 8, 16, 32]
                .into_iter()
                .map(mesh_ratio)
                .collect::<Result<_>>()?,
            locked_ratio: ratio(64, KINDS[1])?,
            large: 1e3 * statics(64, KINDS[0], 1.0)?,
            elastica: 1e3 * LENGTH * Elastica::under_transverse_load(load)?.deflection,
        })
    }
}

/// All runs.
#[derive(Debug, Clone)]
pub struct Study {
    runs: Vec<(Case, Track)>,
    /// Static figures.
    pub statics: Static,
}

/// The runs of the study, longest first.
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for elements in MESHES.into_iter().rev() {
        for kind in KINDS {
            cases.push(Case::new(elements, kind));
        }
    }
    cases.push(Case {
        step: STEP / 2.0,
        ..Case::new(8, KINDS[0])
    });
    cases.push(Case::new(8, (0.0, Rule::Reduced)));
    cases
}

impl Study {
    /// Runs all cases.
    ///
    /// # Errors
    /// When a run cannot be started or statics finds no equilibrium.
    pub fn run(bar: &ProgressBar) -> Result<Self> {
        let cases = cases();
        let tracks: Result<Vec<_>> = parallel::map(&cases, bar, Case::run).into_iter().collect();
        Ok(Self {
            runs: cases.into_iter().zip(tracks?).collect(),
            statics: Static::run()?,
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

    /// Tip deflection (mm) at a time (s); not a number if the run was not made.
    pub fn deflection(&self, case: Case, time: f64) -> f64 {
        let sample = self.find(case).and_then(|track| track.at(time).ok());
        sample.map_or(f64::NAN, |sample| 1e3 * sample.tip[1])
    }
}
