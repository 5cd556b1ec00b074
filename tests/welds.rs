//! Claims about rigid joints of nodes that lack slopes: the right-angle cantilever of Simo and Vu-Quoc
//! and Lee's frame against their references, element families against each other.

use ancf::prelude::*;

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

fn solved<const D: usize>(
    scene: Scene<f64, D>,
    steps: usize,
) -> Result<(System<f64, D>, State<f64>)> {
    let system = scene.assemble()?;
    let mut state = system.rest();
    Statics::in_steps(steps).solve(&system, &mut state)?;
    Ok((system, state))
}

/// Stiffness constants with a shear stiffness that keeps sections normal to the axis.
fn constants(axial: f64, shear: f64, torsion: f64, bending: f64) -> BeamStiffness<f64> {
    BeamStiffness {
        axial,
        shear: [shear; 2],
        torsion,
        bending: [bending; 2],
    }
}

/// The right-angle cantilever of Simo and Vu-Quoc (1988): two legs of 10, whose nodes lack the axial
/// slope, under a force at the elbow out of their plane that comes and goes within two seconds.
#[test]
fn the_right_angle_cantilever_meets_its_reference() {
    let rule = StructuralMechanics::with_stiffness(constants(1e6, 1e6, 1e3, 1e3)).unwrap();
    let section = Moments::new(1.0, 10.0, 10.0).unwrap();
    let leg = |from, to| {
        Beam::new(Quadratic, section, rule)
            .straight(from, to, 4)
            .density(1.0)
    };
    let elbow = [10.0, 0.0, 0.0];
    let mut scene = Scene::<f64, 3>::new();
    let inner = scene.add(leg([0.0; 3], elbow)).unwrap();
    let outer = scene.add(leg(elbow, [10.0, 10.0, 0.0])).unwrap();
    scene.clamp(inner.start()).unwrap();
    scene
        .join(inner.end(), outer.start(), Joint::Rigid)
        .unwrap();
    let hat = |t: f64| (1.0 - (t - 1.0).abs()).max(0.0);
    scene
        .force_in_time(inner.end(), [0.0, 0.0, 50.0], hat)
        .unwrap();
    let system = scene.assemble().unwrap();
    let mut run = Integration::start(&system, system.rest(), &Newmark::trapezoidal()).unwrap();
    let table = include_str!("data/right_angle_cantilever_simo_vuquoc_1988.csv");
    let mut worst = [0.0_f64; 2];
    for line in table.lines().skip(1) {
        let row: Vec<f64> = line.split(',').map(|v| v.parse().unwrap()).collect();
        if row[0] > 10.0 {
            break;
        }
        run.until(row[0], Stepping::Fixed(0.05), |_| {}).unwrap();
        for (k, node) in [inner.end(), outer.end()].into_iter().enumerate() {
            let u = system.displacement(run.state(), node).unwrap();
            worst[k] = worst[k].max((u[2] - row[1 + k]).abs());
        }
    }
    // The tip travels by 10 either way; steps of 0.05 s and four elements a leg leave this much.
    assert!(worst[0] < 0.02 && worst[1] < 0.02, "{worst:?}");
    assert!(system.drift(run.state()).unwrap().position < 1e-9);
}

/// Lee's frame (1968): two legs of 120 hinged to the ground, loaded a fifth along the second, on
/// its way to the limit point.
#[test]
fn lees_frame_meets_its_reference_before_the_limit_point() {
    let stiffness = constants(720.0 * 6.0, 1e7, 1.0, 720.0 * 2.0);
    let rule = StructuralMechanics::with_stiffness(stiffness).unwrap();
    let section = Moments::new(6.0, 2.0, 2.0).unwrap();
    let leg = |from, to, n| Beam::new(Quadratic, section, rule).straight(from, to, n);
    let (corner, far) = ([0.0, 120.0], [120.0, 120.0]);
    let mut scene = Scene::<f64, 2>::new();
    let first = scene.add(leg([0.0; 2], corner, 20)).unwrap();
    let second = scene.add(leg(corner, far, 20)).unwrap();
    scene.pin(first.start()).unwrap();
    scene.pin(second.end()).unwrap();
    scene
        .join(first.end(), second.start(), Joint::Rigid)
        .unwrap();
    let loaded = second.node(8);
    scene
        .force_in_time(loaded, [0.0, -1.0], |load| load)
        .unwrap();
    let system = scene.assemble().unwrap();
    let mut state = system.rest();
    let table = include_str!("data/lee_frame_E720_A6_I2_L120.csv");
    let (mut worst, mut rows) = (0.0_f64, 0);
    for line in table.lines().skip(2) {
        let row: Vec<f64> = line.split(',').map(|v| v.parse().unwrap()).collect();
        // The limit load is 1.8557.
        if row[0] > 1.7 || row[0] < state.time {
            break;
        }
        state.time = row[0];
        Statics::default().solve(&system, &mut state).unwrap();
        let u = system.displacement(&state, loaded).unwrap();
        let gap = (u[0] - row[1]).hypot(-u[1] - row[2]);
        worst = worst.max(gap / row[2]);
        rows += 1;
    }
    assert!(rows > 10 && state.time > 1.6);
    // Near the limit point, where the stiffness goes, the mesh shows most.
    assert!(worst < 2e-4, "{worst}");
}

/// Two beams that meet at an angle turn by one angle, whatever slopes their nodes have: against
/// fully parameterised ones, whose weld is linear, or among themselves in the plane.
#[test]
fn every_family_can_be_welded() {
    fn corner<E, F, G, H, const S: usize, const P: usize>(
        one: Beam<f64, E, F, Disk<f64>, 2>,
        other: Beam<f64, G, H, Disk<f64>, 2>,
    ) -> [f64; 2]
    where
        E: Element<2, S>,
        F: Formulation<f64, E, 2, S>,
        G: Element<2, P>,
        H: Formulation<f64, G, 2, P>,
    {
        let mut scene = Scene::<f64, 2>::new();
        let one = scene.add(one.straight([0.0; 2], [1.0, 0.0], 16)).unwrap();
        let other = other.straight([1.0, 0.0], [1.6, 0.8], 16);
        let other = scene.add(other).unwrap();
        scene.clamp(one.start()).unwrap();
        scene.join(one.end(), other.start(), Joint::Rigid).unwrap();
        scene.force(other.end(), [-0.2, 0.4]).unwrap();
        let (system, state) = solved(scene, 2).unwrap();
        system.displacement(&state, other.end()).unwrap()
    }
    let disk = Disk::new(RADIUS).unwrap();
    let material = || SaintVenantKirchhoff::<f64, 2>::isotropic(YOUNG, 0.0).unwrap();
    let full = || Beam::new(FullyParameterised, disk, Continuum::full(material()));
    let stout = || Beam::new(Quadratic, disk, StructuralMechanics::new(&material()));
    let cable = || Beam::new(Cable, disk, EulerBernoulli::new(&material()));
    let truth = corner(cable(), cable());
    assert!(truth[1] > 0.01, "{truth:?}");
    let pairs = [
        corner(full(), full()),
        corner(full(), stout()),
        corner(stout(), full()),
        corner(stout(), stout()),
        corner(full(), cable()),
        corner(cable(), full()),
        corner(stout(), cable()),
        corner(cable(), stout()),
    ];
    for (k, u) in pairs.iter().enumerate() {
        let gap = (u[0] - truth[0]).hypot(u[1] - truth[1]);
        assert!(
            gap < 3e-3 * truth[0].hypot(truth[1]),
            "{k}: {u:?} {truth:?}"
        );
    }
}

/// In space the weld holds all three rotations of the triads, at any angle.
#[test]
fn welds_hold_every_rotation() {
    let material = || SaintVenantKirchhoff::<f64, 3>::isotropic(YOUNG, 0.0).unwrap();
    let disk = Disk::new(RADIUS).unwrap();
    let stout = || Beam::new(Quadratic, disk, StructuralMechanics::new(&material()));
    let ends = [
        [1.0, 1.0, 0.0],
        [1.6, 0.8, 0.0],
        [1.5, 0.5, 0.7],
        [0.3, 0.1, 0.8],
    ];
    for end in ends {
        let frame = |reference: bool| {
            let elbow = [1.0, 0.0, 0.0];
            let mut scene = Scene::<f64, 3>::new();
            let (inner, outer) = if reference {
                let inner = scene.add(rod([0.0; 3], elbow, 16)).unwrap();
                (inner, scene.add(rod(elbow, end, 16)).unwrap())
            } else {
                let inner = scene.add(stout().straight([0.0; 3], elbow, 4)).unwrap();
                let outer = stout().straight(elbow, end, 4);
                (inner, scene.add(outer).unwrap())
            };
            scene.clamp(inner.start()).unwrap();
            scene
                .join(inner.end(), outer.start(), Joint::Rigid)
                .unwrap();
            scene.force(outer.end(), [0.1, 0.05, 0.15]).unwrap();
            let (system, state) = solved(scene, 2).unwrap();
            system.displacement(&state, outer.end()).unwrap()
        };
        let (truth, u) = (frame(true), frame(false));
        let size = truth.iter().map(|u| u * u).sum::<f64>().sqrt();
        assert!(size > 0.005);
        for c in 0..3 {
            assert!((u[c] - truth[c]).abs() < 0.01 * size, "{u:?} {truth:?}");
        }
    }
}

/// A cable, which knows no twist, keeps its direction in the triad that it leaves from, and its angle
/// to another cable.
#[test]
fn welded_cables_keep_their_direction() {
    let material = || SaintVenantKirchhoff::<f64, 3>::isotropic(YOUNG, 0.0).unwrap();
    let disk = Disk::new(RADIUS).unwrap();
    let stout = || Beam::new(Quadratic, disk, StructuralMechanics::new(&material()));
    let cable = || Beam::new(Cable, disk, EulerBernoulli::new(&material()));
    let elbow = [1.0, 0.0, 0.0];
    for (end, first) in [([1.3, 0.4, 0.2], true), ([2.0, 0.0, 0.0], false)] {
        let mut scene = Scene::<f64, 3>::new();
        let leg = scene.add(stout().straight([0.0; 3], elbow, 2)).unwrap();
        let rope = scene.add(cable().straight(elbow, end, 2)).unwrap();
        scene.clamp(leg.start()).unwrap();
        let (one, other) = match first {
            true => (leg.end(), rope.start()),
            false => (rope.start(), leg.end()),
        };
        scene.join(one, other, Joint::Rigid).unwrap();
        scene.force(rope.end(), [0.5, 1.0, -2.0]).unwrap();
        let (system, state) = solved(scene, 4).unwrap();
        let slope = |state: &State<f64>, node, a| {
            let v = system.vector(state, node, NodalVector::Slope(a)).unwrap();
            let size = v.iter().map(|c| c * c).sum::<f64>().sqrt();
            v.map(|c| c / size)
        };
        let cosines = |state: &State<f64>| {
            let rope = slope(state, rope.start(), 0);
            [1, 2].map(|a| {
                let axis = slope(state, leg.end(), a);
                (0..3).map(|c| rope[c] * axis[c]).sum::<f64>()
            })
        };
        let turned = system.displacement(&state, rope.end()).unwrap()[2];
        assert!(turned < -0.05, "{turned}");
        let (before, after) = (cosines(&system.rest()), cosines(&state));
        for k in 0..2 {
            // To the strain of the section at the node.
            assert!((before[k] - after[k]).abs() < 1e-4, "{before:?} {after:?}");
        }
    }
    let mut scene = Scene::<f64, 3>::new();
    let first = scene.add(cable().straight([0.0; 3], elbow, 2)).unwrap();
    let second = cable().straight(elbow, [1.0, 1.0, 0.0], 2);
    let second = scene.add(second).unwrap();
    scene.clamp(first.start()).unwrap();
    scene
        .join(first.end(), second.start(), Joint::Rigid)
        .unwrap();
    let level = [false, false, true];
    let position = NodalVector::Position;
    scene.fix(second.end(), position, level).unwrap();
    scene.force(second.end(), [2.0, 0.0, 0.0]).unwrap();
    let (system, state) = solved(scene, 4).unwrap();
    let axial = NodalVector::Slope(0);
    let [a, b] = [first.end(), second.start()].map(|n| system.vector(&state, n, axial).unwrap());
    assert!(a[1].abs() > 0.05);
    assert!((a[0] * b[0] + a[1] * b[1] + a[2] * b[2]).abs() < 1e-9);
}
