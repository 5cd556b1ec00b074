//! Rigid bodies joined to each other, to the ground and in loops, where some of their conditions
//! follow from others.

use ancf::prelude::*;
use ancf::solver::{Matrix, Structure};

const G: f64 = 9.81;

fn diagonal(i: [f64; 3]) -> [[f64; 3]; 3] {
    std::array::from_fn(|a| std::array::from_fn(|b| if a == b { i[a] } else { 0.0 }))
}

/// Two bodies welded at an angle move like one of summed inertia.
#[test]
fn welded_bodies_are_one() {
    let (masses, centre) = ([2.0, 1.0], [0.3, -0.2, 0.1]);
    let inertias = [[0.2, 0.3, 0.4], [0.1, 0.2, 0.25]];
    // The second lies beside the first, its axes exchanged: (0, 1, 0), (0, 0, 1), (1, 0, 0).
    let turned = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]];
    let across = [inertias[1][2], inertias[1][0], inertias[1][1]];
    let own = [centre[2], centre[0], centre[1]];
    let run = |welded: bool| {
        let mut scene = Scene::<f64, 3>::new();
        let body = match welded {
            true => {
                let one = RigidBody::new(masses[0], diagonal(inertias[0]));
                let other = RigidBody::new(masses[1], diagonal(inertias[1]))
                    .centre(centre)
                    .turned(turned);
                let one = scene.add_body(one).unwrap().start();
                let other = scene.add_body(other).unwrap().start();
                scene.join(one, other, Joint::Rigid).unwrap();
                one
            }
            false => {
                let whole = masses[0] + masses[1];
                let middle = own.map(|x| x * masses[1] / whole);
                let reduced = masses[0] * masses[1] / whole;
                let square: f64 = own.iter().map(|x| x * x).sum();
                let inertia = std::array::from_fn(|a| {
                    std::array::from_fn(|b| {
                        let sum = if a == b {
                            inertias[0][a] + across[a] + reduced * square
                        } else {
                            0.0
                        };
                        sum - reduced * own[a] * own[b]
                    })
                });
                let body = RigidBody::new(whole, inertia).centre(middle);
                scene.add_body(body).unwrap().start()
            }
        };
        scene.pin(body).unwrap();
        scene.gravity([0.0, 0.0, -G]).unwrap();
        let system = scene.assemble().unwrap();
        let mut start = system.rest();
        system
            .set_rigid_velocity(&mut start, [0.0; 3], [1.0, 2.0, 3.0])
            .unwrap();
        let mut run = Integration::start(&system, start, &Collocation::gauss(2)).unwrap();
        run.until(1.0, Stepping::Fixed(0.01), |_| {}).unwrap();
        assert!(system.drift(run.state()).unwrap().position < 1e-12);
        [0, 1, 2].map(|a| {
            system
                .vector(run.state(), body, NodalVector::Slope(a))
                .unwrap()
        })
    };
    let (two, one) = (run(true), run(false));
    for (two, one) in two.as_flattened().iter().zip(one.as_flattened()) {
        assert!((two - one).abs() < 1e-9, "{two} {one}");
    }
}

/// A clamped body stays, and the clamp carries its weight and what hangs on it.
#[test]
fn a_clamped_body_carries_its_weight() {
    let mut scene = Scene::<f64, 3>::new();
    let body = scene
        .add_body(RigidBody::new(3.0, diagonal([0.1; 3])))
        .unwrap()
        .start();
    let swing = RigidBody::new(2.0, diagonal([0.1; 3])).centre([0.0, 0.0, -0.5]);
    let swing = scene.add_body(swing).unwrap().start();
    scene.clamp(body).unwrap();
    scene.join(body, swing, Joint::Spherical).unwrap();
    scene.gravity([0.0, 0.0, -G]).unwrap();
    let system = scene.assemble().unwrap();
    let mut run = Integration::start(&system, system.rest(), &Newmark::trapezoidal()).unwrap();
    run.until(0.1, Stepping::Fixed(0.01), |_| {}).unwrap();
    let state = run.state();
    for vector in [
        NodalVector::Position,
        NodalVector::Slope(0),
        NodalVector::Slope(2),
    ] {
        let at = system.coordinate(body, vector).unwrap();
        assert!(state.displacement[at..at + 3].iter().all(|u| *u == 0.0));
    }
    // It hangs at rest: the position of both is one and carries both.
    let forces = system.reactions(state).unwrap();
    let at = |node| system.coordinate(node, NodalVector::Position).unwrap() + 2;
    let up = forces[at(body)] + forces[at(swing)];
    assert!((up - 5.0 * G).abs() < 1e-9, "{up}");
}

/// A four-bar linkage of three bodies, the cranks' nodes at the ground and the coupler's at the
/// first crank; in space with hinges about its normal.
fn four_bar<const D: usize>(corners: [[f64; 2]; 4]) -> Result<(System<f64, D>, Node)> {
    let lift = |[x, y]: [f64; 2]| std::array::from_fn(|c| [x, y, 0.0][c]);
    let [a, p, q, b] = corners;
    let mut scene = Scene::<f64, D>::new();
    let mut bar = |from: [f64; 2], to: [f64; 2]| {
        let along = [to[0] - from[0], to[1] - from[1]];
        let body = RigidBody::new(1.0, diagonal([0.1; 3]))
            .at(lift(from))
            .centre(lift(along.map(|x| 0.5 * x)));
        (scene.add_body(body).unwrap().start(), along)
    };
    let (crank, coupler, rocker) = (bar(a, p), bar(p, q), bar(b, q));
    let position = NodalVector::Position;
    let end = |(node, along): (Node, [f64; 2]), c, sign: f64| {
        let slope = |axis: usize| (node, NodalVector::Slope(axis), c, sign * along[axis]);
        [(node, position, c, sign), slope(0), slope(1)]
    };
    scene.pin(crank.0)?;
    scene.pin(rocker.0)?;
    for c in 0..D {
        let mut start = end(crank, c, 1.0).to_vec();
        start.push((coupler.0, position, c, -1.0));
        scene.constrain(&start)?;
        scene.constrain(&[end(coupler, c, 1.0), end(rocker, c, -1.0)].concat())?;
    }
    if D == 3 {
        let axis = NodalVector::Slope(2);
        scene.fix(crank.0, axis, [true; D])?;
        scene.fix(rocker.0, axis, [true; D])?;
        for c in 0..D {
            for (one, other) in [(crank.0, coupler.0), (coupler.0, rocker.0)] {
                scene.constrain(&[(one, axis, c, 1.0), (other, axis, c, -1.0)])?;
            }
        }
    }
    scene.gravity(lift([0.0, -G]))?;
    Ok((scene.assemble()?, coupler.0))
}

/// The closed loop of parallel hinges, over-constrained thrice in space, moves as in the plane.
#[test]
fn a_spatial_four_bar_linkage_moves_as_in_the_plane() {
    fn trace<const D: usize>() -> ([f64; 2], String, f64) {
        let corners = [[0.0, 0.0], [0.0, 1.0], [2.0, 1.5], [2.5, 0.0]];
        let (system, coupler) = four_bar::<D>(corners).unwrap();
        let scheme = EnergyMomentum::conserving();
        let mut run = Integration::start(&system, system.rest(), &scheme).unwrap();
        run.until(0.6, Stepping::Fixed(5e-3), |_| {}).unwrap();
        let r = system.position(run.state(), coupler).unwrap();
        let energy = system.energies(run.state()).unwrap();
        assert!(energy.total().abs() < 1e-10, "{energy:?}");
        let drift = system.drift(run.state()).unwrap().position;
        ([r[0], r[1]], system.describe(), drift)
    }
    let (plane, described, drift) = trace::<2>();
    assert!(
        !described.contains("implied") && drift < 1e-12,
        "{described}"
    );
    assert!((plane[0] - 0.0).abs() > 0.1, "{plane:?}");
    let (space, described, drift) = trace::<3>();
    assert!(
        described.contains("implied") && drift < 1e-12,
        "{described}"
    );
    let gap = (plane[0] - space[0]).hypot(plane[1] - space[1]);
    assert!(gap < 1e-10, "{gap:e}");
}

/// At a dead point conditions seem to follow from each other that do not: refused, as is what
/// contradicts them.
#[test]
fn dead_points_and_contradictions_are_refused() {
    let flat = [[0.0, 0.0], [1.0, 0.0], [3.0, 0.0], [2.0, 0.0]];
    let error = four_bar::<2>(flat).unwrap_err();
    assert!(matches!(error, Error::Redundant { .. }), "{error}");
    assert!(error.to_string().contains("dead point"), "{error}");

    #[derive(Debug)]
    struct Length(f64);
    impl Constraint<f64, 2, 1, 1> for Length {
        fn residual<T: Algebra<f64>>(&self, _: T, [x]: &[[T; 2]; 1]) -> [T; 1] {
            [(x[0] * x[0] + x[1] * x[1]).sqrt() - T::lit(self.0)]
        }
    }
    // The axis of a body has length one, whatever it is asked.
    let scene = |length| {
        let mut scene = Scene::<f64, 2>::new();
        let body = RigidBody::new(1.0, diagonal([1.0; 3]));
        let body = scene.add_body(body).unwrap().start();
        scene.bind([(body, NodalVector::Slope(0))], Length(length))?;
        scene.assemble()
    };
    scene(1.0).unwrap();
    let error = scene(1.1).unwrap_err();
    assert!(matches!(error, Error::Redundant { .. }), "{error}");
}

/// The tangent with a share of the mass is the tangent and that share of the mass, for beams in lanes and
/// at supports, rigid bodies and point masses.
#[test]
fn the_mass_added_with_the_tangent_is_the_mass() {
    let mut scene = Scene::<f64, 3>::new();
    let solid = SaintVenantKirchhoff::isotropic(2e7, 0.3).unwrap();
    let formulation = Continuum::selective_reduced(solid);
    let rod = Beam::new(FullyParameterised, Disk::new(0.02).unwrap(), formulation);
    let rod = rod.straight([0.0; 3], [1.0, 0.0, 0.0], 7).density(1e3);
    let rod = scene.add(rod).unwrap();
    scene.pin(rod.start()).unwrap();
    scene.mass(rod.end(), 0.7).unwrap();
    let body = RigidBody::new(2.0, diagonal([0.2, 0.3, 0.4])).centre([0.1, 0.2, -0.1]);
    scene.add_body(body).unwrap();
    let system = scene.assemble().unwrap();
    let size = system.reference().len();
    let u: Vec<f64> = (0..size).map(|i| 1e-2 * (i as f64).sin()).collect();
    let unknowns = system.unknowns();
    let matrix = || Matrix::zero(unknowns, system.symmetric());
    let (mut whole, mut parts, mut tangent) = (matrix(), matrix(), matrix());
    system
        .add_tangent_and_mass(0.0, 1.0, &u, 3e5, &mut whole)
        .unwrap();
    system.add_tangent(0.0, 1.0, &u, &mut tangent).unwrap();
    system.add_tangent(0.0, 1.0, &u, &mut parts).unwrap();
    system.add_mass(3e5, &mut parts).unwrap();
    let [whole, parts, tangent] = [&whole, &parts, &tangent].map(|k| k.stored());
    let (mut worst, mut largest, mut moved) = (0.0_f64, 0.0_f64, 0.0_f64);
    for i in 0..unknowns.count() {
        for j in 0..unknowns.count() {
            worst = worst.max((whole.get(i, j) - parts.get(i, j)).abs());
            moved = moved.max((tangent.get(i, j) - parts.get(i, j)).abs());
            largest = largest.max(parts.get(i, j).abs());
        }
    }
    assert!(worst < 1e-14 * largest, "{worst:e} of {largest:e}");
    assert!(moved > 1e-3 * largest, "the mass counts");
}
