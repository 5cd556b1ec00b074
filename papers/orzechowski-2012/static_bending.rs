//! Section 5.1: a clamped beam bent by an end moment `2 pi E I/L`, which would close it to a
//! circle if it were a rod. Measured is the gap between the two ends, over meshes, radii,
//! definitions of the moment and integration rules.

use std::f64::consts::{PI, TAU};

use ancf::analytical::{BendingSection, EndMoment, pure_bending};
use ancf::prelude::*;
use indicatif::ProgressBar;

use crate::model::{LENGTH, Rule, Specimen};
use crate::parallel;
use crate::turned::Turned;

/// Young's modulus (Pa).
pub const YOUNG: f64 = 2e11;
/// The paper's radius (m).
pub const RADIUS: f64 = 0.02;
/// Elements of the studies over the mesh.
pub const MESHES: [usize; 17] = [
    160, 80, 64, 48, 40, 32, 24, 20, 16, 12, 10, 8, 6, 5, 4, 3, 2,
];
/// Radii (m): the paper's and two thinner ones.
pub const RADII: [f64; 3] = [0.02, 0.005, 0.001];
/// Definitions of the end moment with the short names used in tables and figures.
pub const LAWS: [(&str, MomentLaw); 7] = [
    ("a1", MomentLaw::SlopeRotation(1)),
    ("a2", MomentLaw::FollowerCouple(1)),
    ("a3", MomentLaw::TangentTraction),
    ("d2", MomentLaw::PiolaTraction),
    ("b1", MomentLaw::SlopeRotation(0)),
    ("c1", MomentLaw::MeanRotation),
    ("c2", MomentLaw::PolarRotation),
];

/// One roll-up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    /// Number of elements.
    pub elements: usize,
    /// Radius of the section (m).
    pub radius: f64,
    /// Definition of the moment: its name and law.
    pub law: (&'static str, MomentLaw),
    /// Integration rule.
    pub rule: Rule,
    /// Poisson ratio.
    pub poisson: f64,
    /// Turn of the integration points about the axis (degrees).
    pub turn: f64,
}

impl Case {
    /// The paper's beam with the default moment.
    pub fn new(elements: usize, rule: Rule) -> Self {
        Self {
            elements,
            radius: RADIUS,
            law: LAWS[0],
            rule,
            poisson: 0.0,
            turn: 0.0,
        }
    }

    fn system(&self, share: f64) -> Result<(System<f64, 3>, Placed)> {
        let specimen = Specimen {
            elements: self.elements,
            young: YOUNG,
            poisson: self.poisson,
            rule: self.rule,
        };
        let (mut scene, beam) = specimen.scene(Turned::new(self.radius, self.turn)?, None)?;
        scene.clamp(beam.start())?;
        let moment = share * TAU * YOUNG * PI * self.radius.powi(4) / 4.0 / LENGTH;
        scene.moment(beam.end(), Moment::new([0.0, 0.0, moment], self.law.1))?;
        Ok((scene.assemble()?, beam))
    }

    fn solve(&self) -> Result<[f64; 3]> {
        let (system, beam) = self.system(1.0)?;
        let mut state = system.rest();
        // A turned rule of order 2 bends the beam out of its plane, and long load steps then
        // land on equilibria far from the roll-up.
        let steps = if self.turn == 0.0 { 20 } else { 80 };
        Statics::in_steps(steps).solve(&system, &mut state)?;
        system.position(&state, beam.end())
    }

    /// Upper and lower edge and axis of the beam in its plane, from clamp to tip, under a share
    /// of the full moment.
    ///
    /// # Errors
    /// When there is no equilibrium.
    pub fn shape(&self, share: f64) -> Result<[Vec<[f64; 2]>; 3]> {
        let (system, beam) = self.system(share)?;
        let mut state = system.rest();
        Statics::in_steps(20).solve(&system, &mut state)?;
        let edge = |y: f64| -> Result<Vec<[f64; 2]>> {
            let point = |k: usize| {
                let s = k as f64 / 240.0;
                let [x, y, _] = system.point(&state, beam.start(), s, [0.0, y, 0.0])?;
                Ok([x, y])
            };
            (0..=240).map(point).collect()
        };
        Ok([edge(self.radius)?, edge(-self.radius)?, edge(0.0)?])
    }
}

/// A case with what came of it.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// The case.
    pub case: Case,
    /// Position of the tip (m), or why there is none.
    pub tip: std::result::Result<[f64; 3], String>,
}

impl Outcome {
    /// Distance between the ends (mm); not a number when there was no equilibrium.
    pub fn gap(&self) -> f64 {
        match self.tip {
            Ok([x, y, z]) => 1e3 * x.hypot(y).hypot(z),
            Err(_) => f64::NAN,
        }
    }

    /// Distance of the tip from the plane of bending (mm).
    pub fn out_of_plane(&self) -> f64 {
        self.tip.as_ref().map_or(f64::NAN, |tip| 1e3 * tip[2].abs())
    }
}

/// All roll-ups.
#[derive(Debug, Clone)]
pub struct Study {
    /// Every case with its outcome.
    pub outcomes: Vec<Outcome>,
}

/// Angles (degrees) by which the order-2 rule is turned, mirrored about 45.
pub const TURNS: [f64; 17] = [
    0.0, 7.5, 15.0, 20.0, 22.5, 25.0, 30.0, 37.5, 45.0, 52.5, 60.0, 65.0, 67.5, 70.0, 75.0, 82.5,
    90.0,
];

/// The cases of the study.
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for elements in MESHES {
        for radius in RADII {
            for law in LAWS {
                // Definitions that have a limit are taken one mesh further.
                if elements <= 80 || LAWS[..4].contains(&law) {
                    cases.push(Case {
                        radius,
                        law,
                        ..Case::new(elements, Rule::Full)
                    });
                }
            }
            cases.push(Case {
                radius,
                ..Case::new(elements, Rule::Reduced)
            });
        }
        for rule in [Rule::Full, Rule::SelectiveReduced, Rule::ZeroPoisson] {
            cases.push(Case {
                poisson: 0.3,
                ..Case::new(elements, rule)
            });
        }
    }
    cases.push(Case::new(20, Rule::Degree(7)));
    for turn in TURNS {
        for rule in [Rule::Reduced, Rule::Full] {
            if turn != 0.0 {
                cases.push(Case {
                    turn,
                    ..Case::new(20, rule)
                });
            }
        }
    }
    cases
}

impl Study {
    /// Runs all cases.
    pub fn run(bar: &ProgressBar) -> Self {
        let cases = cases();
        let tips = parallel::map(&cases, bar, |case| {
            case.solve().map_err(|error| error.to_string())
        });
        let pairs = cases.into_iter().zip(tips);
        Self {
            outcomes: pairs.map(|(case, tip)| Outcome { case, tip }).collect(),
        }
    }

    /// The outcome of a case.
    pub fn find(&self, case: Case) -> Option<&Outcome> {
        self.outcomes.iter().find(|o| o.case == case)
    }

    /// Gap of a case (mm); not a number when it was not run or has no equilibrium.
    pub fn gap(&self, case: Case) -> f64 {
        self.find(case).map_or(f64::NAN, Outcome::gap)
    }

    /// Pairs of mesh and gap (mm) of a case on every mesh, coarse to fine, without those that
    /// have no equilibrium.
    pub fn over_meshes(&self, case: Case) -> Vec<[f64; 2]> {
        let meshes = MESHES.iter().rev().copied();
        let gap = |elements: usize| [elements as f64, self.gap(Case { elements, ..case })];
        meshes.map(gap).filter(|p| p[1].is_finite()).collect()
    }

    /// The limit (mm) of a case on ever finer meshes: Richardson's extrapolation of the terms in
    /// `1/n^2` and `1/n^4` from 40, 80 and 160 elements.
    pub fn extrapolated(&self, case: Case) -> f64 {
        let [a, b, c] = [40, 80, 160].map(|elements| self.gap(Case { elements, ..case }));
        let (ab, bc) = ((4.0 * b - a) / 3.0, (4.0 * c - b) / 3.0);
        (16.0 * bc - ab) / 15.0
    }
}

/// Exact gap (mm) of the section-linear beam, without a mesh. The order-2 rule sees half of the
/// disk's fourth moment.
///
/// # Errors
/// For a moment beyond what the section carries.
pub fn limit(radius: f64, kind: EndMoment, rule: Rule) -> Result<f64> {
    let mut section = BendingSection::disk(YOUNG, radius);
    if rule == Rule::Reduced {
        section.fourth *= 0.5;
    }
    let moment = TAU * YOUNG * section.second / LENGTH;
    Ok(1e3 * pure_bending(&section, moment, kind)?.gap(LENGTH))
}
