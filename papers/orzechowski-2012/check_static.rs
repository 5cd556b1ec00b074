//! Claims about integration (sections 3 and 4 of the paper) and static bending (section 5.1).

use std::error::Error;
use std::f64::consts::PI;

use ancf::analytical::EndMoment;
use ancf::quadrature::disk_order;
use ancf::section::{Rectangle, Section};

use crate::claims::Claim;
use crate::model::Rule;
use crate::static_bending::{Case, LAWS, RADIUS, Study, TURNS, YOUNG, limit};

type Checked = Result<Vec<Claim>, Box<dyn Error>>;

/// Integral of `y^a z^b` over the unit disk.
fn moment(a: usize, b: usize) -> f64 {
    if a % 2 == 1 || b % 2 == 1 {
        return 0.0;
    }
    let odd = |n: usize| (1..n).step_by(2).product::<usize>() as f64;
    let even = (2..=a + b).step_by(2).product::<usize>() as f64;
    2.0 * PI * odd(a) * odd(b) / even / (a + b + 2) as f64
}

/// Claims about the integration rules.
///
/// # Errors
/// Whatever the library refuses.
pub fn integration() -> Checked {
    let mut worst = 0.0_f64;
    let mut counts_wrong = 0.0;
    for s in 1..=4 {
        let rule = disk_order::<f64>(s)?;
        let points = if s % 2 == 0 { s * s } else { s * s - s + 1 };
        counts_wrong += f64::from(u8::from(rule.len() != points));
        for a in 0..2 * s {
            for b in 0..2 * s - a {
                let value = rule.integrate(|[y, z]| y.powi(a as i32) * z.powi(b as i32));
                worst = worst.max((value - moment(a, b)).abs());
            }
        }
    }
    let fourth = disk_order::<f64>(2)?.integrate(|[y, _]| y.powi(4)) / moment(4, 0);
    let gauss = Rectangle::new(1.0, 1.0)?.rule(3)?.len() as f64;
    let (radius, length) = (RADIUS, 0.05);
    let scaled = disk_order::<f64>(3)?.scaled(radius / length)?;
    let area: f64 = scaled.weights().iter().sum();
    Ok(vec![
        Claim::holds(
            "3",
            "Table 1: order s is exact to degree 2 s - 1 (s = 1 to 4): largest error",
            "exact",
            (worst, ""),
            0.0..=1e-14,
        ),
        Claim::holds(
            "3",
            "s^2 points for even s, s^2 - s + 1 for odd s: orders that differ",
            "0",
            (counts_wrong, ""),
            0.0..=0.0,
        ),
        Claim::holds(
            "4",
            "the disk takes as many points as the rectangle (reduced rules): ratio",
            "4/4",
            (disk_order::<f64>(2)?.len() as f64 / gauss, ""),
            1.0..=1.0,
        ),
        Claim::refuted(
            "4",
            "order 2 loses no accuracy: fourth moment of the disk over the true one",
            "1",
            (fourth, ""),
            0.499_999..=0.500_001,
            "the strain energy is quartic in y and z, order 2 is exact to degree 3",
        ),
        Claim::refuted(
            "4",
            "eq. 21 integrates over eta^2 + zeta^2 <= R: area over that region's (l = 50 mm)",
            "1",
            (area / (PI * radius), ""),
            7.999..=8.001,
            "misprint: the region is eta^2 + zeta^2 <= (R/l)^2",
        ),
    ])
}

/// Figures of independent computations in mm on 10, 20, 40 and 80 elements.
const TABLE: [(usize, Rule, [f64; 4]); 5] = [
    (0, Rule::Full, [108.197, 6.2402, 19.5970, 21.6473]),
    (0, Rule::Reduced, [106.865, 8.2600, 21.689, 23.746]),
    (1, Rule::Full, [87.330, 10.5881, 17.6488, 18.0712]),
    (2, Rule::Full, [87.564, 10.4695, 17.5798, 18.0315]),
    (3, Rule::Full, [90.281, 4.7981, 11.5075, 11.9036]),
];

/// Claims about the roll-up.
///
/// # Errors
/// Whatever the library refuses.
pub fn bending(study: &Study) -> Checked {
    let full = Case::new(20, Rule::Full);
    let paper = Case::new(20, Rule::Reduced);
    let mm = "mm";
    let ends = "5.1";
    let stiffness = YOUNG * PI * RADIUS.powi(4) / 4.0;
    let mut claims = vec![
        Claim::close(
            ends,
            "bending stiffness",
            "2.513e4 Nm^2",
            (stiffness, "Nm^2"),
            2.513e4,
            5.0,
        ),
        Claim::close(
            ends,
            "gap at the full moment, 20 elements, the paper's rule",
            "about 8.3 mm",
            (study.gap(paper), mm),
            8.2600,
            1e-3,
        ),
        Claim::refuted(
            ends,
            "the same with the exact rule (reduction 'without apparent loss of accuracy')",
            "8.3 mm",
            (study.gap(full), mm),
            6.239..=6.2415,
            "a quarter of the gap comes from the rule",
        ),
        Claim::refuted(
            ends,
            "8.3 mm is the method's answer: limit of ever finer meshes, the paper's rule",
            "8.3 mm",
            (study.extrapolated(Case::new(0, Rule::Reduced)), mm),
            24.298..=24.318,
            "locking and material softening cancel near n = 20",
        ),
        Claim::refuted(
            ends,
            "more elements improve the result: gap of n = 80 over gap of n = 20, paper's rule",
            "below 1",
            (
                study.gap(Case::new(80, Rule::Reduced)) / study.gap(paper),
                "",
            ),
            2.8..=2.95,
            "without locking the softening is all that is left",
        ),
        Claim::holds(
            ends,
            "points beyond order 3 change nothing: gap of order 4 less gap of order 3",
            "exact",
            (
                study.gap(Case::new(20, Rule::Degree(7))) - study.gap(full),
                mm,
            ),
            -1e-6..=1e-6,
        ),
    ];
    for (law, rule, figures) in TABLE {
        let law = LAWS[law];
        let deviation = [10, 20, 40, 80].into_iter().zip(figures);
        let deviation = deviation.map(|(elements, figure)| {
            let case = Case {
                law,
                ..Case::new(elements, rule)
            };
            (study.gap(case) - figure).abs()
        });
        let name = rule.name();
        claims.push(Claim::holds(
            ends,
            format!(
                "moment {}, {name} rule: deviation from independent code, 4 meshes",
                law.0
            ),
            "-",
            (deviation.fold(0.0, f64::max), mm),
            0.0..=1e-3,
        ));
    }
    for (law, kind, rule, exact, tolerance) in [
        (0, EndMoment::Conjugate, Rule::Full, 22.208, 0.01),
        (0, EndMoment::Conjugate, Rule::Reduced, 24.308, 0.01),
        (1, EndMoment::NormalToSlope, Rule::Full, 18.0854, 0.02),
        (2, EndMoment::AlongAxis, Rule::Full, 18.0854, 0.02),
        (3, EndMoment::SecondPiola, Rule::Full, 11.9429, 0.02),
    ] {
        let law = LAWS[law];
        let derived = limit(RADIUS, kind, rule)?;
        let case = Case {
            law,
            ..Case::new(0, rule)
        };
        claims.push(Claim::close(
            ends,
            format!(
                "exact limit, moment {}, {} rule ({exact} mm): extrapolated",
                law.0,
                rule.name()
            ),
            "-",
            (study.extrapolated(case), mm),
            derived,
            tolerance,
        ));
    }
    claims.extend(thin(study)?);
    claims.extend(coupled(study));
    claims.extend(rotation(study));
    Ok(claims)
}

/// Thin beams.
fn thin(study: &Study) -> Checked {
    let mut claims = vec![Claim::holds(
        "5.1",
        "correct only for moderately thick beams: gap, R = 1 mm, n = 20 (limit 0.0543 mm)",
        "qualitative",
        (
            study.gap(Case {
                radius: 0.001,
                ..Case::new(20, Rule::Full)
            }),
            "mm",
        ),
        576.8..=577.8,
    )];
    for (elements, figure, tolerance) in [(40, 132.39, 0.05), (80, 10.95, 0.01), (160, 0.743, 2e-3)]
    {
        let case = Case {
            radius: 0.001,
            ..Case::new(elements, Rule::Full)
        };
        claims.push(Claim::close(
            "5.1",
            format!("thickness locking: the same with n = {elements}"),
            "-",
            (study.gap(case), "mm"),
            figure,
            tolerance,
        ));
    }
    for (radius, figure, tolerance) in [(0.005, 1.359, 1e-3), (0.001, 0.0543, 1e-4)] {
        let exact = limit(radius, EndMoment::Conjugate, Rule::Full)?;
        let what = format!("exact limit, R = {} mm", 1e3 * radius);
        claims.push(Claim::close(
            "5.1",
            what,
            "-",
            (exact, "mm"),
            figure,
            tolerance,
        ));
    }
    Ok(claims)
}

/// Poisson ratio 0.3, and definitions of the moment that have no limit.
fn coupled(study: &Study) -> Vec<Claim> {
    let mut claims = Vec::new();
    for (rule, figure, tolerance) in [
        (Rule::Full, 296.98, 0.05),
        (Rule::SelectiveReduced, 14.834, 0.01),
        (Rule::ZeroPoisson, 22.208, 0.01),
    ] {
        let case = Case {
            poisson: 0.3,
            ..Case::new(0, rule)
        };
        claims.push(Claim::close(
            "5.1",
            format!("nu = 0.3, {} integration: extrapolated gap", rule.name()),
            "-",
            (study.extrapolated(case), "mm"),
            figure,
            tolerance,
        ));
    }
    let along = |elements| {
        study.gap(Case {
            law: LAWS[4],
            ..Case::new(elements, Rule::Full)
        })
    };
    let meshes = [48, 64, 80].map(along);
    claims.push(Claim::holds(
        "5.1",
        "moment on r_x (b1) has no limit: of the meshes 48, 64 and 80, those without equilibrium",
        "-",
        (meshes.iter().filter(|gap| gap.is_nan()).count() as f64, ""),
        1.0..=3.0,
    ));
    claims
}

/// The rules turned about the axis.
fn rotation(study: &Study) -> Vec<Claim> {
    let turned = |turn: f64, rule: Rule| Case {
        turn,
        ..Case::new(20, rule)
    };
    let mut claims = Vec::new();
    for (turn, figure) in [(0.0, 8.260), (30.0, 7.282), (45.0, 6.240)] {
        claims.push(Claim::close(
            "5.1",
            format!("order 2 turned by {turn} degrees: gap, n = 20"),
            "isotropic",
            (study.gap(turned(turn, Rule::Reduced)), "mm"),
            figure,
            1e-3,
        ));
    }
    let cases = || {
        TURNS
            .into_iter()
            .flat_map(|turn| study.find(turned(turn, Rule::Reduced)))
    };
    let out = cases().map(|outcome| outcome.out_of_plane());
    claims.push(Claim::refuted(
        "5.1",
        "order 2 bends the beam in its plane whatever its orientation: tip out of plane",
        "0 mm",
        (out.fold(0.0, f64::max), "mm"),
        3.1..=3.25,
        "four points have no circular symmetry in the fourth moments",
    ));
    let gap = study.gap(Case::new(20, Rule::Full));
    let change = |turn| (study.gap(turned(turn, Rule::Full)) - gap).abs();
    claims.push(Claim::holds(
        "5.1",
        "order 3 does not depend on its orientation: largest change of the gap",
        "-",
        (TURNS.into_iter().map(change).fold(0.0, f64::max), "mm"),
        0.0..=1e-6,
    ));
    claims
}
