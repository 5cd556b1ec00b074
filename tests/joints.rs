//! Claims about joints, linear constraints and driven coordinates: frames against the formulas of
//! structural mechanics, a cut beam against the uncut one, and the spin-up of Simo and Vu-Quoc
//! against its reference.

use ancf::prelude::*;
use ancf::solver::Rate;

const RADIUS: f64 = 1e-3;
const YOUNG: f64 = 2.0e13;

type Spatial = Beam<f64, FullyParameterised, Continuum<SaintVenantKirchhoff<f64, 3>>, Disk<f64>, 3>;

fn rod(from: [f64; 3], to: [f64; 3], n: usize) -> Spatial {
    let material = SaintVenantKirchhoff::isotropic(YOUNG, 0.0).unwrap();
    Beam::new(
        FullyParameterised,
        Disk::new(RADIUS).unwrap(),
        Continuum::full(material),
    )
    .straight(from, to, n)
}

fn planar(from: [f64; 2], to: [f64; 2], n: usize) -> impl Fn(&mut Scene<f64, 2>) -> Placed {
    let material = SaintVenantKirchhoff::isotropic(YOUNG, 0.0).unwrap();
    let section = Disk::new(RADIUS).unwrap();
    let beam = Beam::new(FullyParameterised, section, Continuum::full(material));
    let beam = beam.straight(from, to, n);
    move |scene| scene.add(beam.clone()).unwrap()
}

/// Bending, axial, shear and torsional stiffness of the rod (no Poisson effect).
fn stiffness() -> [f64; 4] {
    let area = std::f64::consts::PI * RADIUS * RADIUS;
    let second = area * RADIUS * RADIUS / 4.0;
    let shear = YOUNG / 2.0;
    [
        YOUNG * second,
        YOUNG * area,
        shear * area,
        shear * 2.0 * second,
    ]
}

fn solved<const D: usize>(
    scene: Scene<f64, D>,
    steps: usize,
) -> Result<(System<f64, D>, State<f64>)> {
    let system = scene.assemble()?;
    let mut state = system.rest();
    Statics::in_steps(steps).solve(&system, &mut state)?;
    Ok((system, state))
}

/// A beam cut in two and welded is the uncut beam, in large deflection, whichever way its second
/// half runs, and in whatever order its parts come.
#[test]
fn a_weld_is_no_cut() {
    let load = [0.0, 200.0, 100.0];
    let mut scene = Scene::new();
    let whole = scene.add(rod([0.0; 3], [1.0, 0.0, 0.0], 4)).unwrap();
    scene.clamp(whole.start()).unwrap();
    scene.force(whole.end(), load).unwrap();
    let (system, state) = solved(scene, 4).unwrap();
    let truth = system.displacement(&state, whole.end()).unwrap();
    assert!(truth[1] > 0.1);
    let middle = [0.5, 0.0, 0.0];
    for (reversed, outer_first) in [(false, false), (true, false), (true, true), (false, true)] {
        let mut scene = Scene::new();
        let inner = rod([0.0; 3], middle, 2);
        let outer = match reversed {
            false => rod(middle, [1.0, 0.0, 0.0], 2),
            true => rod([1.0, 0.0, 0.0], middle, 2),
        };
        let (inner, outer) = match outer_first {
            true => {
                let outer = scene.add(outer).unwrap();
                (scene.add(inner).unwrap(), outer)
            }
            false => (scene.add(inner).unwrap(), scene.add(outer).unwrap()),
        };
        let (near, tip) = match reversed {
            false => (outer.start(), outer.end()),
            true => (outer.end(), outer.start()),
        };
        scene.clamp(inner.start()).unwrap();
        scene.join(inner.end(), near, Joint::Rigid).unwrap();
        scene.force(tip, load).unwrap();
        let (system, state) = solved(scene, 4).unwrap();
        let u = system.displacement(&state, tip).unwrap();
        for c in 0..3 {
            assert!((u[c] - truth[c]).abs() < 1e-9, "{u:?} is not {truth:?}");
        }
    }
}

/// Two legs of 1 m at a right angle, clamped at the foot, with a small force at the tip along each
/// direction in turn: bending of both legs, and torsion of the first. The rods are thin enough for
/// the shear of the elbow's node not to be seen.
#[test]
fn a_right_angle_frame_deflects_as_structural_mechanics_says() {
    let [bending, axial, shear, torsion] = stiffness();
    let force = 1e-3;
    let n = 8;
    // Cubic elements with linear sections give a tip load's deflection this share of the truth.
    let share = 1.0 - 1.0 / (4.0 * (n * n) as f64);
    let cantilever = share / (3.0 * bending) + 1.0 / shear;
    let cases = [
        (0, cantilever + 1.0 / bending + 1.0 / axial),
        (2, 2.0 * cantilever + 1.0 / torsion),
    ];
    for (direction, flexibility) in cases {
        let mut scene = Scene::new();
        let elbow = [1.0, 0.0, 0.0];
        let first = scene.add(rod([0.0; 3], elbow, n)).unwrap();
        let second = scene.add(rod(elbow, [1.0, 1.0, 0.0], n)).unwrap();
        scene.clamp(first.start()).unwrap();
        scene
            .join(first.end(), second.start(), Joint::Rigid)
            .unwrap();
        let mut load = [0.0; 3];
        load[direction] = force;
        scene.force(second.end(), load).unwrap();
        let (system, state) = solved(scene, 1).unwrap();
        let u = system.displacement(&state, second.end()).unwrap();
        let ratio = u[direction] / (force * flexibility);
        assert!((ratio - 1.0).abs() < 1e-4, "along {direction}: {ratio}");
    }
}

/// A cantilever carries a second beam, of another mesh, by a hinge, whose far end rests on a roller. A
/// force at the hinge bends the cantilever alone.
#[test]
fn no_moment_passes_a_hinge() {
    let [bending, _, shear, _] = stiffness();
    let n = 4;
    let mut scene = Scene::new();
    let first = planar([0.0; 2], [1.0, 0.0], n)(&mut scene);
    let second = planar([1.0, 0.0], [2.0, 0.0], n + 3)(&mut scene);
    scene.clamp(first.start()).unwrap();
    scene
        .join(first.end(), second.start(), Joint::Spherical)
        .unwrap();
    let up = [false, true];
    scene.fix(second.end(), NodalVector::Position, up).unwrap();
    scene.force(first.end(), [0.0, 1e-3]).unwrap();
    let (system, state) = solved(scene, 1).unwrap();
    let u = system.displacement(&state, second.start()).unwrap();
    let share = 1.0 - 1.0 / (4.0 * (n * n) as f64);
    let expected = 1e-3 * (share / (3.0 * bending) + 1.0 / shear);
    assert!((u[1] / expected - 1.0).abs() < 1e-5, "{u:?}");
}

/// A hinge about z carries bending about y like a weld, and lets the beam swing about z.
#[test]
fn a_hinge_turns_about_its_axis_only() {
    let scene = |joint, load| {
        let mut scene = Scene::new();
        let first = scene.add(rod([0.0; 3], [1.0, 0.0, 0.0], 2)).unwrap();
        let second = rod([1.0, 0.0, 0.0], [2.0, 0.0, 0.0], 2);
        let second = scene.add(second).unwrap();
        scene.clamp(first.start()).unwrap();
        scene.join(first.end(), second.start(), joint).unwrap();
        scene.force(second.end(), load).unwrap();
        if load[1] == 0.0 {
            let sideways = [false, true, false];
            scene
                .fix(second.end(), NodalVector::Position, sideways)
                .unwrap();
        }
        (scene, second.end())
    };
    let sag = |joint| {
        let (scene, tip) = scene(joint, [0.0, 0.0, 1e-3]);
        let (system, state) = solved(scene, 1).unwrap();
        system.displacement(&state, tip).unwrap()[2]
    };
    let hinge = Joint::Hinge([0.0, 0.0, 3.0]);
    let (hinged, welded) = (sag(hinge), sag(Joint::Rigid));
    // The weld also holds the lengths of the other slopes at the node together.
    assert!((hinged / welded - 1.0).abs() < 1e-3, "{hinged} {welded}");
    let (free, _) = scene(hinge, [0.0, 1e-3, 0.0]);
    let error = solved(free, 1).unwrap_err();
    assert!(matches!(error, Error::Mechanism { .. }), "{error}");
}

/// Two cantilevers whose tips are told to move alike carry a force on one of them in halves.
#[test]
fn a_linear_constraint_shares_the_load() {
    let mut scene = Scene::new();
    let beams = [0.0, 1.0].map(|y| {
        let beam = planar([0.0, y], [1.0, y], 2)(&mut scene);
        scene.clamp(beam.start()).unwrap();
        beam
    });
    let tip = |k: usize, factor| (beams[k].end(), NodalVector::Position, 1, factor);
    scene.constrain(&[tip(0, 2.0), tip(1, -2.0)]).unwrap();
    scene.force(beams[1].end(), [0.0, 2.0]).unwrap();
    let (system, state) = solved(scene, 1).unwrap();
    let mut alone = Scene::new();
    let one = planar([0.0; 2], [1.0, 0.0], 2)(&mut alone);
    alone.clamp(one.start()).unwrap();
    alone.force(one.end(), [0.0, 1.0]).unwrap();
    let (single, half) = solved(alone, 1).unwrap();
    let truth = single.displacement(&half, one.end()).unwrap();
    for beam in beams {
        let u = system.displacement(&state, beam.end()).unwrap();
        assert!((u[1] / truth[1] - 1.0).abs() < 1e-9, "{u:?}");
    }
}

struct Pull;

impl Motion<f64, 2> for Pull {
    fn at<T: Algebra<f64>>(&self, t: T) -> [T; 2] {
        [T::lit(1.0) + t.times(0.25), T::zero()]
    }
}

/// A bar pulled by a given displacement: uniform Green-Lagrange strain, reached in load steps and
/// left again.
#[test]
fn statics_follows_a_driven_end() {
    let mut scene = Scene::new();
    let bar = planar([0.0; 2], [1.0, 0.0], 3)(&mut scene);
    scene.pin(bar.start()).unwrap();
    let position = NodalVector::Position;
    scene.drive(bar.end(), position, [true; 2], Pull).unwrap();
    let system = scene.assemble().unwrap();
    let mut state = system.rest();
    for (time, stretch) in [(1.0, 0.25), (0.4, 0.1), (0.0, 0.0)] {
        state.time = time;
        Statics::in_steps(2).solve(&system, &mut state).unwrap();
        let strain: f64 = stretch + stretch * stretch / 2.0;
        let expected = 0.5 * stiffness()[1] * strain * strain;
        let energy = system.energies(&state).unwrap().elastic;
        assert!(
            (energy - expected).abs() < 1e-9 * stiffness()[1],
            "{energy}"
        );
    }
}

/// Root angle of the spin-up manoeuvre of Simo and Vu-Quoc (1986).
struct SpinUp;

impl Motion<f64, 2> for SpinUp {
    fn at<T: Algebra<f64>>(&self, t: T) -> [T; 2] {
        let pi = std::f64::consts::PI;
        let swing = (t.times(2.0 * pi / 15.0).cos() - T::one()).times((7.5 / pi).powi(2));
        let angle = ((t * t).times(0.5) + swing).times(0.4);
        [-angle.sin(), angle.cos()]
    }
}

/// Tip displacement in the frame of the root while it spins up to 6 rad/s, against the reference
/// until the end of the manoeuvre's hardest part.
#[test]
fn the_spin_up_manoeuvre_meets_its_reference() {
    let stiffness = BeamStiffness {
        axial: 2.8e7,
        shear: [1e7; 2],
        torsion: 1.0,
        bending: [1.4e4; 2],
    };
    let rule = StructuralMechanics::with_stiffness(stiffness).unwrap();
    let section = Moments::new(1.2, 6e-4, 6e-4).unwrap();
    let mut scene = Scene::<f64, 2>::new();
    let beam = Beam::new(Quadratic, section, rule)
        .straight([0.0; 2], [10.0, 0.0], 8)
        .density(1.0);
    let beam = scene.add(beam).unwrap();
    let (start, tip) = (beam.start(), beam.end());
    scene.pin(start).unwrap();
    scene
        .drive(start, NodalVector::Slope(1), [true; 2], SpinUp)
        .unwrap();
    let system = scene.assemble().unwrap();
    let mut run = Integration::start(&system, system.rest(), &Newmark::trapezoidal()).unwrap();
    let table = include_str!("data/spinup_simo_vuquoc_1986.csv");
    let mut worst: f64 = 0.0;
    for line in table.lines().skip(1) {
        let row: Vec<f64> = line.split(',').map(|v| v.parse().unwrap()).collect();
        if row[0] == 0.0 || row[0] > 8.0 {
            continue;
        }
        run.until(row[0], Stepping::Fixed(0.005), |_| {}).unwrap();
        let state = run.state();
        let r = system.position(state, tip).unwrap();
        let [sin, cos] = {
            let [s, c] = SpinUp.at(state.time);
            [-s, c]
        };
        let local = [r[0] * cos + r[1] * sin - 10.0, r[1] * cos - r[0] * sin];
        worst = worst.max((local[0] - row[1]).hypot(local[1] - row[2]));
    }
    // The tip bends back by 0.58 m.
    assert!(worst < 1e-3, "{worst}");
    // What turns the root has done all the work, to second order in the step.
    let energies = system.energies(run.state()).unwrap();
    assert!(energies.kinetic > 100.0);
    assert!(energies.balance().abs() < 1e-4 * energies.kinetic);
    let mut velocity = run.state().velocity.clone();
    let before = velocity.clone();
    let time = run.state().time;
    system.impose(time, Rate::Velocity, &mut velocity).unwrap();
    assert_eq!(before, velocity);
}

/// The clamp of a cantilever carries its load and its weight, and the moment of both about the
/// clamp.
#[test]
fn a_clamp_carries_what_acts() {
    let mut scene = Scene::<f64, 2>::new();
    let material = SaintVenantKirchhoff::isotropic(YOUNG, 0.0).unwrap();
    let disk = Disk::new(RADIUS).unwrap();
    let beam = Beam::new(FullyParameterised, disk, Continuum::full(material));
    let beam = beam.straight([0.0; 2], [1.0, 0.0], 4).density(7200.0);
    let beam = scene.add(beam).unwrap();
    scene.clamp(beam.start()).unwrap();
    scene.gravity([0.0, -10.0]).unwrap();
    scene.force(beam.end(), [0.0, -0.1]).unwrap();
    let (system, state) = solved(scene, 1).unwrap();
    let reactions = system.reactions(&state).unwrap();
    let weight = 7200.0 * std::f64::consts::PI * RADIUS * RADIUS * 10.0;
    assert!((reactions[1] / (weight + 0.1) - 1.0).abs() < 1e-9);
    // Turning the clamp with its slopes e_x and e_y does the work of the moment.
    let moment = reactions[3] - reactions[4];
    let [tip, _] = system.position(&state, beam.end()).unwrap();
    let expected = 0.1 * tip + weight / 2.0;
    assert!(
        (moment / expected - 1.0).abs() < 1e-3,
        "{moment} {expected}"
    );
    let load = system
        .coordinate(beam.end(), NodalVector::Position)
        .unwrap();
    assert!(reactions[load + 1].abs() < 1e-9);
}

/// What cannot be joined is refused.
#[test]
fn joints_that_make_no_sense_are_refused() {
    let mut scene = Scene::new();
    let first = scene.add(rod([0.0; 3], [1.0, 0.0, 0.0], 1)).unwrap();
    let second = scene.add(rod([1.1, 0.0, 0.0], [2.0, 0.0, 0.0], 1)).unwrap();
    let gap = scene.join(first.end(), second.start(), Joint::Spherical);
    assert!(gap.unwrap_err().to_string().contains("apart"));
    let axis = scene.join(first.end(), first.end(), Joint::Hinge([0.0; 3]));
    assert!(matches!(axis, Err(Error::NotPositive { .. })));
    let component = scene.constrain(&[(first.end(), NodalVector::Position, 3, 1.0)]);
    assert!(matches!(component, Err(Error::NoSuchCoordinate { .. })));
    let unknown = scene.constrain(&[(first.end(), NodalVector::Position, 0, f64::NAN)]);
    assert!(unknown.is_ok() && scene.assemble().is_err());

    let mut scene = Scene::new();
    let bar = planar([0.0; 2], [1.0, 0.0], 1)(&mut scene);
    let end = [true, false];
    let position = NodalVector::Position;
    scene.drive(bar.end(), position, end, Pull).unwrap();
    scene.fix(bar.end(), position, end).unwrap();
    let error = scene.assemble().unwrap_err();
    assert!(matches!(error, Error::Contradiction { .. }), "{error}");
}

/// A root that swings up and down.
struct Shaker;

impl Motion<f64, 2> for Shaker {
    fn at<T: Algebra<f64>>(&self, t: T) -> [T; 2] {
        let height = (t.times(8.0).cos() - T::one()).times(0.05);
        [T::zero(), height]
    }
}

/// Energy balance over total energy, and the tip, after 0.4 s of a beam shaken at its root.
fn shaken<M: Scheme<f64>>(scheme: &M, step: f64) -> (f64, f64) {
    let rubber = SaintVenantKirchhoff::isotropic(2.0e7, 0.0).unwrap();
    let disk = Disk::new(0.02).unwrap();
    let beam = Beam::new(FullyParameterised, disk, Continuum::full(rubber));
    let mut scene = Scene::<f64, 2>::new();
    let beam = beam.straight([0.0; 2], [0.5, 0.0], 2).density(2000.0);
    let beam = scene.add(beam).unwrap();
    let root = beam.start();
    let slopes = [0, 1].map(NodalVector::Slope);
    for slope in slopes {
        scene.fix(root, slope, [true; 2]).unwrap();
    }
    scene
        .drive(root, NodalVector::Position, [true; 2], Shaker)
        .unwrap();
    let system = scene.assemble().unwrap();
    let mut run = Integration::start(&system, system.rest(), scheme).unwrap();
    run.until(0.4, Stepping::Fixed(step), |_| {}).unwrap();
    let energies = system.energies(run.state()).unwrap();
    let tip = system.position(run.state(), beam.end()).unwrap();
    (energies.balance() / energies.total(), tip[1])
}

/// What a driven root puts in is counted by every method, and what it sets in motion agrees.
#[test]
fn every_method_counts_the_work_of_a_driven_root() {
    let runs = [
        ("trapezoidal", shaken(&Newmark::trapezoidal(), 5e-4)),
        ("midpoint", shaken(&Midpoint::default(), 5e-4)),
        (
            "energy-momentum",
            shaken(&EnergyMomentum::conserving(), 5e-4),
        ),
        ("one Gauss point", shaken(&Collocation::gauss(1), 5e-4)),
        ("two Gauss points", shaken(&Collocation::gauss(2), 5e-4)),
        ("two Radau points", shaken(&Collocation::radau(2), 5e-4)),
    ];
    let (_, truth) = shaken(&Collocation::gauss(3), 5e-4);
    for (name, (balance, tip)) in runs {
        assert!(balance.abs() < 2e-3, "{name}: {balance:e}");
        assert!((tip - truth).abs() < 1e-5, "{name}: {tip} not {truth}");
    }
}
