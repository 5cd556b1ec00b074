//! Claims about paths of equilibria: snap-through and snap-back against exact and reference
//! solutions, buckling found along the way, branches taken, and what keeps a path whole.

use ancf::analytical::{BendingSection, EndMoment, pure_bending};
use ancf::formulation::CableEnergy;
use ancf::prelude::*;
use num_dual::Dual64;
use std::f64::consts::PI;

fn rows(table: &str) -> impl Iterator<Item = Vec<f64>> {
    let row = |line: &str| line.split(',').map(|v| v.parse().unwrap()).collect();
    table.lines().skip(1).map(row)
}

/// Half the span of the truss is 1; stiffness `EA` is 1.
fn truss<R: Real>(height: R, load: R) -> (System<R, 2>, Node)
where
    EulerBernoulli<R>: Formulation<R, Cable, 2, 4>,
{
    let [zero, one] = [R::zero(), R::one()];
    let stocky = EulerBernoulli::with_stiffness(one, one)
        .unwrap()
        .with_energy(CableEnergy::GeometricCurvature);
    let mut scene = Scene::<R, 2>::new();
    let bar = Beam::new(Cable, Moments::new(one, one, one).unwrap(), stocky);
    let [foot, top, other] = [[zero; 2], [one, height], [one + one, zero]];
    let left = scene.add(bar.clone().straight(foot, top, 1)).unwrap();
    let right = scene.add(bar.straight(top, other, 1)).unwrap();
    scene.pin(left.start()).unwrap();
    scene.pin(right.end()).unwrap();
    scene
        .join(left.end(), right.start(), Joint::Spherical)
        .unwrap();
    let across = [true, false];
    scene
        .fix(left.end(), NodalVector::Position, across)
        .unwrap();
    scene.force(left.end(), [zero, -load]).unwrap();
    (scene.assemble().unwrap(), left.end())
}

/// With Green-Lagrange strain `P = EA z (h^2 - z^2) / L^3` at the height `z`, with extrema
/// `2 h^3 / (3 sqrt(3) L^3)`.
fn truss_limit(height: f64) -> f64 {
    2.0 * height.powi(3) / (3.0 * 3_f64.sqrt() * (1.0 + height * height).powf(1.5))
}

/// Under every control that can, the truss follows its closed form through both limit points.
#[test]
fn a_truss_snaps_through_at_its_exact_limit() {
    let height = 0.3_f64;
    let limit = truss_limit(height);
    let (system, top) = truss(height, limit);
    let at = system.coordinate(top, NodalVector::Position).unwrap() + 1;
    let controls = [
        Path::by(Control::Sphere, 0.05),
        Path::by(Control::Plane, 0.05),
        Path::by(Control::Coordinate(at), -0.02),
        Path {
            load_weight: 0.0,
            ..Path::by(Control::Sphere, 0.02)
        },
    ];
    for settings in controls {
        let mut path = Continuation::start(&system, system.rest(), 0.0, &settings).unwrap();
        let mut points = 0;
        let check = |point: &PathPoint<'_, f64>| {
            let z = height + point.state.displacement[at];
            let length = (1.0 + height * height).sqrt();
            let truth = z * (height * height - z * z) / length.powi(3) / limit;
            assert!((point.factor - truth).abs() < 1e-9, "{settings:?}");
            let between = z.abs() < height / 3_f64.sqrt();
            assert_eq!(point.unstable, Some(usize::from(between)));
            points += 1;
        };
        path.until(Target::Factor(1.0 - 1e-3), check).unwrap();
        assert_eq!(path.unstable(), Some(0));
        path.until(Target::Coordinate(at, -0.65), |_| {}).unwrap();
        assert!((path.state().displacement[at] + 0.65).abs() < 1e-15);
        assert!(points > 3);
        let found = path.criticals();
        assert_eq!(found.len(), 2, "{settings:?}");
        for (critical, truth) in found.iter().zip([1.0, -1.0]) {
            assert_eq!(critical.kind, Criticality::Limit);
            assert!((critical.factor - truth).abs() < 1e-9, "{settings:?}");
        }
    }
    // Load control cannot; it keeps what it has.
    let settings = Path::by(Control::Load, 0.1);
    let mut path = Continuation::start(&system, system.rest(), 0.0, &settings).unwrap();
    let mut last = 0.0;
    let result = path.until(Target::Coordinate(at, -0.3), |p| last = p.factor);
    assert!(
        matches!(result, Err(Error::PathStopped { .. })),
        "{result:?}"
    );
    assert_eq!(path.factor(), last);
}

#[test]
fn limit_loads_carry_derivatives_and_come_in_single_precision() {
    let height = 0.3;
    let (system, _) = truss(Dual64::new(height, 1.0), Dual64::from(truss_limit(height)));
    let rest = system.rest();
    let zero = Dual64::from(0.0);
    let mut path = Continuation::start(&system, rest, zero, &Path::default()).unwrap();
    path.until(Target::Critical, |_| {}).unwrap();
    let load = path.criticals()[0].factor;
    // d ln(h^3 / (1 + h^2)^(3/2)) / dh
    let slope = 3.0 / height - 3.0 * height / (1.0 + height * height);
    assert!((load.re - 1.0).abs() < 1e-9);
    assert!((load.eps / slope - 1.0).abs() < 1e-5, "{}", load.eps);

    let (system, _) = truss(0.3_f32, truss_limit(height) as f32);
    let settings = Path {
        locate: Some(1e-3),
        ..Path::default()
    };
    let mut path = Continuation::start(&system, system.rest(), 0.0, &settings).unwrap();
    path.until(Target::Critical, |_| {}).unwrap();
    assert!((path.criticals()[0].factor - 1.0).abs() < 1e-4);
}

/// Lee's frame: two hinged legs of 120, rigidly joined. In the plane the director of the one leg is
/// that of the other turned by a right angle, which is linear.
#[test]
fn lees_frame_snaps_back_along_its_reference() {
    let stiffness = BeamStiffness {
        axial: 4320.0,
        shear: [1e6; 2],
        torsion: 1.0,
        bending: [1440.0; 2],
    };
    let rule = StructuralMechanics::with_stiffness(stiffness).unwrap();
    let leg = Beam::new(Quadratic, Moments::new(6.0, 2.0, 2.0).unwrap(), rule);
    let mut scene = Scene::<f64, 2>::new();
    let (foot, corner, far) = ([0.0, 0.0], [0.0, 120.0], [120.0, 120.0]);
    let column = scene.add(leg.clone().straight(foot, corner, 15)).unwrap();
    let girder = scene.add(leg.straight(corner, far, 15)).unwrap();
    scene.pin(column.start()).unwrap();
    scene.pin(girder.end()).unwrap();
    let (one, other) = (column.end(), girder.start());
    scene.join(one, other, Joint::Spherical).unwrap();
    let director = NodalVector::Slope(1);
    scene
        .constrain(&[(other, director, 0, 1.0), (one, director, 1, -1.0)])
        .unwrap();
    scene
        .constrain(&[(other, director, 1, 1.0), (one, director, 0, 1.0)])
        .unwrap();
    // Nodes are half an element apart.
    let loaded = girder.node(6);
    scene.force(loaded, [0.0, -1.0]).unwrap();
    let system = scene.assemble().unwrap();
    let x = system.coordinate(loaded, NodalVector::Position).unwrap();
    let settings = Path::by(Control::Sphere, 0.05);
    let mut path = Continuation::start(&system, system.rest(), 0.0, &settings).unwrap();
    let table: Vec<_> = rows(include_str!("data/lee_frame_E720_A6_I2_L120.csv")).collect();
    for pair in table.windows(2).step_by(8) {
        // The coordinate that changes more tells where on the path the row is.
        let [along, across] = [pair[1][1] - pair[0][1], pair[1][2] - pair[0][2]];
        let row = &pair[1];
        let target = match along.abs() > across.abs() {
            true => Target::Coordinate(x, row[1]),
            false => Target::Coordinate(x + 1, -row[2]),
        };
        path.until(target, |_| {}).unwrap();
        let [u, v] = [0, 1].map(|c| path.state().displacement[x + c]);
        let errors = [path.factor() - row[0], u - row[1], v + row[2]].map(f64::abs);
        assert!(
            errors[0] < 1e-3 && errors[1] < 1e-2 && errors[2] < 1e-2,
            "{row:?}: {errors:?}"
        );
    }
    let limits = path.criticals();
    assert!(limits.len() >= 2);
    for (limit, truth) in limits.iter().zip([1.855678, -0.941305]) {
        assert_eq!(limit.kind, Criticality::Limit);
        assert!(
            (limit.factor / truth - 1.0).abs() < 1e-3,
            "{}",
            limit.factor
        );
    }
}

/// A shallow arch loaded beside its crown goes through loop after loop until it has snapped, with loads that
/// weigh far more than displacements in the arc length. No control turns back where a step leads over a limit
/// point: both pass the same ten loops, each as unstable as it left the one before, and end stable.
#[test]
fn a_shallow_arch_unwinds_its_loops_under_every_arc_length() {
    let rise = 0.2_f64;
    let radius = (1.0 + rise * rise) / (2.0 * rise);
    let half = (1.0 / radius).asin();
    let steel = SaintVenantKirchhoff::<f64, 2>::isotropic(2.1e11, 0.3).unwrap();
    let section = Rectangle::new(0.02, 0.02).unwrap();
    let arch = Beam::new(Cable, section, EulerBernoulli::new(&steel)).curved(
        2.0 * half * radius,
        20,
        move |s| {
            let (sin, cos) = (half * (2.0 * s - 1.0)).sin_cos();
            let x = [radius * sin, radius * (cos - half.cos())];
            (x, [[cos, -sin], [sin, cos]])
        },
    );
    let mut scene = Scene::<f64, 2>::new();
    let arch = scene.add(arch).unwrap();
    scene.pin(arch.start()).unwrap();
    scene.pin(arch.end()).unwrap();
    scene.force(arch.node(11), [0.0, -1e5]).unwrap();
    let system = scene.assemble().unwrap();
    let below = system
        .coordinate(arch.node(11), NodalVector::Position)
        .unwrap()
        + 1;
    let loops = [Control::Sphere, Control::Plane].map(|control| {
        let settings = Path {
            points: 1000,
            ..Path::by(control, 0.02)
        };
        let mut path = Continuation::start(&system, system.rest(), 0.0, &settings).unwrap();
        path.until(Target::Coordinate(below, -0.44), |_| {})
            .unwrap();
        assert_eq!(path.unstable(), Some(0), "{control:?}");
        let mut refused = path.refusals().iter();
        assert!(refused.any(|refused| matches!(refused.cause, Error::OffPath { .. })));
        path.criticals()
            .iter()
            .map(|c| (c.factor, c.unstable))
            .collect::<Vec<_>>()
    });
    assert_eq!(loops[0].len(), 20);
    assert_eq!(loops[1].len(), 20);
    let mut unstable = Some(0);
    for ((sphere, counts), (plane, same)) in loops[0].iter().zip(&loops[1]) {
        assert!((sphere - plane).abs() < 1e-4, "{sphere} {plane}");
        assert_eq!(counts, same);
        assert_eq!(counts[0], unstable);
        unstable = counts[1];
    }
}

/// A clamped strut of length and bending stiffness 1 under its Euler load and a force across.
fn strut(across: f64) -> (System<f64, 2>, Node) {
    let mut scene = Scene::<f64, 2>::new();
    let rule = EulerBernoulli::with_stiffness(1e6, 1.0).unwrap();
    let beam = Beam::new(Cable, Moments::new(1.0, 1.0, 1.0).unwrap(), rule);
    let beam = scene.add(beam.straight([0.0; 2], [1.0, 0.0], 32)).unwrap();
    scene.pin(beam.start()).unwrap();
    let across_only = [false, true];
    scene
        .fix(beam.start(), NodalVector::Slope(0), across_only)
        .unwrap();
    let euler = PI * PI / 4.0;
    scene.force(beam.end(), [-euler, across]).unwrap();
    (scene.assemble().unwrap(), beam.end())
}

/// The perfect strut stays straight until its stability changes; the branch it is put on is that of
/// Euler's elastica, on either side.
#[test]
fn the_perfect_strut_bifurcates_and_its_branch_is_eulers() {
    let (system, tip) = strut(0.0);
    for side in [1.0, -1.0] {
        let settings = Path::by(Control::Sphere, 0.3);
        let mut path = Continuation::start(&system, system.rest(), 0.0, &settings).unwrap();
        path.until(Target::Critical, |_| {}).unwrap();
        assert_eq!(path.unstable(), Some(1));
        let critical = path.criticals()[0].clone();
        assert_eq!(critical.kind, Criticality::Bifurcation);
        let euler = critical.factor;
        assert!((euler - 1.0).abs() < 1e-5, "{euler}");
        let up = critical.shape[system.coordinate(tip, NodalVector::Position).unwrap() + 1];
        path.switch(&critical, side * up.signum() * 0.1).unwrap();
        assert_eq!(path.unstable(), Some(0));
        for row in rows(include_str!(
            "data/euler_strut_clamped_free_postbuckling.csv"
        )) {
            if row[0] < 20.0 || row[0] > 140.0 {
                continue;
            }
            path.until(Target::Factor(row[1]), |_| {}).unwrap();
            let [x, y] = system.position(path.state(), tip).unwrap();
            let error = (x - row[2]).hypot(y * side - row[3]);
            assert!(error < 2e-4, "{} degrees: {error}", row[0]);
        }
    }
}

/// A small force across makes a path without critical points that joins the same branch.
#[test]
fn the_imperfect_strut_joins_the_branch() {
    let (system, tip) = strut(1e-4);
    let settings = Path::by(Control::Sphere, 0.1);
    let mut path = Continuation::start(&system, system.rest(), 0.0, &settings).unwrap();
    for row in rows(include_str!(
        "data/euler_strut_clamped_free_postbuckling.csv"
    )) {
        if row[0] < 40.0 || row[0] > 120.0 {
            continue;
        }
        path.until(Target::Factor(row[1]), |_| {}).unwrap();
        let [x, y] = system.position(path.state(), tip).unwrap();
        let error = (x - row[2]).hypot(y - row[3]);
        assert!(error < 1e-3, "{} degrees: {error}", row[0]);
    }
    assert!(path.criticals().is_empty());
}

/// Statics says that the straight strut beyond Euler's load is unstable, and refuses to go there
/// when asked to.
#[test]
fn statics_reports_and_refuses_a_change_of_stability() {
    let (system, _) = strut(0.0);
    let euler = {
        let mut path = Continuation::start(&system, system.rest(), 0.0, &Path::default()).unwrap();
        path.until(Target::Critical, |_| {}).unwrap();
        path.criticals()[0].factor
    };
    let mut scene = Scene::<f64, 2>::new();
    let rule = EulerBernoulli::with_stiffness(1e6, 1.0).unwrap();
    let beam = Beam::new(Cable, Moments::new(1.0, 1.0, 1.0).unwrap(), rule);
    let beam = scene.add(beam.straight([0.0; 2], [1.0, 0.0], 16)).unwrap();
    scene.pin(beam.start()).unwrap();
    scene
        .fix(beam.start(), NodalVector::Slope(0), [false, true])
        .unwrap();
    scene.force(beam.end(), [-PI * PI / 2.0, 0.0]).unwrap();
    let system = scene.assemble().unwrap();
    let mut state = system.rest();
    let report = Statics::in_steps(5).solve(&system, &mut state).unwrap();
    assert_eq!(report.unstable, Some(1));
    let holding = Statics {
        hold_stability: true,
        ..Statics::in_steps(5)
    };
    let mut state = system.rest();
    let error = holding.solve(&system, &mut state).unwrap_err();
    let Error::StaticsFailed { reached, cause, .. } = error else {
        panic!("{error}")
    };
    assert!(matches!(
        *cause,
        Error::StabilityChanged { before: 0, now: 1 }
    ));
    assert!((2.0 * reached / euler - 1.0).abs() < 1e-3, "{reached}");
    let at_once = Statics {
        hold_stability: true,
        cutbacks: 3,
        ..Statics::default()
    };
    let mut state = system.rest();
    assert!(at_once.solve(&system, &mut state).is_err());
}

/// A thin rod rolled up to one and to three turns by an end moment meets the exact solution of its
/// section; the moment turns with the end.
#[test]
fn three_turns_meet_the_exact_section_model() {
    let (young, radius, n) = (2.0e11, 5e-3_f64, 160_u16);
    let material = SaintVenantKirchhoff::<f64, 2>::isotropic(young, 0.0).unwrap();
    let section = Disk::new(radius).unwrap();
    let mut scene = Scene::<f64, 2>::new();
    let rod = Beam::new(FullyParameterised, section, Continuum::full(material));
    let rod = scene
        .add(rod.straight([0.0; 2], [1.0, 0.0], n.into()))
        .unwrap();
    scene.clamp(rod.start()).unwrap();
    let turn = 2.0 * PI * young * PI * radius.powi(4) / 4.0;
    scene.moment(rod.end(), Moment::about_z(turn)).unwrap();
    let system = scene.assemble().unwrap();
    let settings = Path::by(Control::Load, 0.1);
    let mut path = Continuation::start(&system, system.rest(), 0.0, &settings).unwrap();
    for turns in [1.0, 3.0] {
        path.until(Target::Factor(turns), |_| {}).unwrap();
        let bending = BendingSection::disk(young, radius);
        let exact = pure_bending(&bending, turns * turn, EndMoment::Conjugate).unwrap();
        let curvature = exact.curvature / exact.axial_stretch;
        let angle: f64 = exact.curvature;
        let truth = [angle.sin() / curvature, (1.0 - angle.cos()) / curvature];
        let r = system.position(path.state(), rod.end()).unwrap();
        let error = (r[0] - truth[0]).hypot(r[1] - truth[1]);
        // Straight directors turn by (kappa h)^2 / 12 less; they shrink between nodes, which
        // costs twice the energy's share (kappa h^2 / R)^2 / 180 of the curvature.
        let element = angle / f64::from(n);
        let lag = element * element / 12.0 + (element / f64::from(n) / radius).powi(2) / 90.0;
        assert!(
            (error / lag - 1.0).abs() < 0.05,
            "{turns} turns: {r:?}, not {truth:?}: {error:e}, not {lag:e}"
        );
    }
}

#[test]
fn paths_that_make_no_sense_are_refused() {
    let (system, _) = strut(0.0);
    let start = |settings: Path| {
        let path = Continuation::start(&system, system.rest(), 0.0, &settings);
        path.map(|_| ()).unwrap_err()
    };
    let usual = Path::default();
    for first in [f64::NAN, 0.0] {
        assert!(matches!(
            start(Path { first, ..usual }),
            Error::OutOfRange { .. }
        ));
    }
    let longest = 0.0;
    assert!(matches!(
        start(Path { longest, ..usual }),
        Error::NotPositive { .. }
    ));
    let load_weight = -1.0;
    assert!(matches!(
        start(Path {
            load_weight,
            ..usual
        }),
        Error::OutOfRange { .. }
    ));
    let points = 0;
    assert!(matches!(
        start(Path { points, ..usual }),
        Error::TooFew { .. }
    ));
    let control = Control::Coordinate(10_000);
    assert!(matches!(
        start(Path { control, ..usual }),
        Error::NoSuchCoordinate { .. }
    ));
    assert!(Continuation::start(&system, system.rest(), f64::NAN, &usual).is_err());

    let few = Path { points: 2, ..usual };
    let mut path = Continuation::start(&system, system.rest(), 0.0, &few).unwrap();
    let missed = path.until(Target::Factor(0.9), |_| {}).unwrap_err();
    assert!(matches!(missed, Error::TargetMissed { points: 2, .. }));
    let far = path.until(Target::Factor(f64::NAN), |_| {});
    assert!(matches!(far, Err(Error::NotFinite { .. })));
    let none = path.until(Target::Coordinate(10_000, 0.0), |_| {});
    assert!(matches!(none, Err(Error::NoSuchCoordinate { .. })));
    path.until(Target::Factor(path.factor()), |_| {}).unwrap();
}
