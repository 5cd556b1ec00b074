//! Every integrator on a double pendulum of two bodies and on a tethered beam: its order against the
//! equations in angles, what it conserves, and how well it holds the conditions.

use ancf::prelude::*;

const G: f64 = 9.81;

fn about_normal(inertia: f64) -> [[f64; 3]; 3] {
    let mut tensor = [[0.0; 3]; 3];
    tensor[2][2] = inertia;
    tensor
}

/// Two uniform rods of 1 m and 1 kg, the second hinged to the end of the first, level at rest.
fn double_pendulum() -> (System<f64, 2>, [Node; 2]) {
    let mut scene = Scene::<f64, 2>::new();
    let rod = |x| {
        RigidBody::new(1.0, about_normal(1.0 / 12.0))
            .at([x, 0.0])
            .centre([0.5, 0.0])
    };
    let one = scene.add_body(rod(0.0)).unwrap().start();
    let other = scene.add_body(rod(1.0)).unwrap().start();
    scene.pin(one).unwrap();
    let (position, slope) = (NodalVector::Position, NodalVector::Slope(0));
    for c in 0..2 {
        let end = [(one, position, c, 1.0), (one, slope, c, 1.0)];
        let terms = [end[0], end[1], (other, position, c, -1.0)];
        scene.constrain(&terms).unwrap();
    }
    scene.gravity([0.0, -G]).unwrap();
    (scene.assemble().unwrap(), [one, other])
}

/// The angles of the two rods at a time, by Runge and Kutta's rule.
fn angles(end: f64) -> [f64; 2] {
    let rate = |y: [f64; 4]| {
        let [a, b, wa, wb] = y;
        let (sin, cos) = (a - b).sin_cos();
        let (m, c, n) = (4.0 / 3.0, 0.5 * cos, 1.0 / 3.0);
        let p = -1.5 * G * a.cos() - 0.5 * sin * wb * wb;
        let q = -0.5 * G * b.cos() + 0.5 * sin * wa * wa;
        let det = m * n - c * c;
        [wa, wb, (n * p - c * q) / det, (m * q - c * p) / det]
    };
    let count = 20_000;
    let h = end / f64::from(count);
    let mut y = [0.0; 4];
    for _ in 0..count {
        let add = |k: [f64; 4], f: f64| std::array::from_fn(|i| y[i] + f * k[i]);
        let k1 = rate(y);
        let k2 = rate(add(k1, h / 2.0));
        let k3 = rate(add(k2, h / 2.0));
        let k4 = rate(add(k3, h));
        y = std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
    }
    [y[0], y[1]]
}

/// Distance of the rods' directions from the truth after a second, and the drifts on the way.
fn swing(scheme: &impl Scheme<f64>, step: f64, truth: [f64; 2]) -> (f64, [f64; 2]) {
    let (system, nodes) = double_pendulum();
    let mut run = Integration::start(&system, system.rest(), scheme).unwrap();
    let mut drifts = [0.0_f64; 2];
    run.until(1.0, Stepping::Fixed(step), |step| {
        let drift = system.drift(step.after)?;
        drifts = [drifts[0].max(drift.position), drifts[1].max(drift.velocity)];
        Ok(())
    })
    .unwrap();
    let gap = |(node, angle): (&Node, f64)| {
        let axis = system.vector(run.state(), *node, NodalVector::Slope(0));
        let [x, y] = axis.unwrap();
        (x - angle.cos()).hypot(y - angle.sin())
    };
    (nodes.iter().zip(truth).map(gap).fold(0.0, f64::max), drifts)
}

/// All of them with their order, positions held to rounding, velocities where the method brings
/// them onto the constraints.
#[test]
fn a_double_pendulum_of_bodies_swings_at_every_order() {
    fn check(name: &str, scheme: &impl Scheme<f64>, order: i32, step: f64, projected: bool) {
        let truth = angles(1.0);
        let (coarse, _) = swing(scheme, step, truth);
        let (fine, [position, velocity]) = swing(scheme, 0.5 * step, truth);
        let found = (coarse / fine).log2();
        assert!(
            found > f64::from(order) - 0.3,
            "{name}: {coarse:e} {fine:e}"
        );
        assert!(position < 1e-11, "{name}: {position:e}");
        // Of 10 rad/s; half-way methods keep it to second order.
        let bound = if projected { 1e-10 } else { 2e-3 };
        assert!(velocity < bound, "{name}: {velocity:e}");
    }
    let alpha = Newmark::generalised_alpha(0.8);
    check("trapezoidal", &Newmark::trapezoidal(), 2, 5e-3, true);
    check("generalised alpha", &alpha, 2, 5e-3, true);
    check("midpoint", &Midpoint::default(), 2, 5e-3, false);
    let conserving = EnergyMomentum::conserving();
    check("energy-momentum", &conserving, 2, 5e-3, false);
    check("central", &CentralDifference::default(), 2, 5e-3, true);
    check("gauss 1", &Collocation::gauss(1), 2, 5e-3, true);
    check("gauss 2", &Collocation::gauss(2), 4, 0.02, true);
    check("gauss 3", &Collocation::gauss(3), 6, 0.05, true);
    check("radau 2", &Collocation::radau(2), 3, 0.02, true);
    check("radau 3", &Collocation::radau(3), 5, 0.04, true);
}

/// Departures of energy, linear and angular momentum over ten thousand steps, relative to what
/// there is, and the largest drift in position.
fn departures<const D: usize>(
    system: &System<f64, D>,
    start: State<f64>,
    scheme: &impl Scheme<f64>,
    step: f64,
) -> [f64; 4] {
    let mut run = Integration::start(system, start, scheme).unwrap();
    let energy = system.energies(run.state()).unwrap().total();
    let before = system.momenta(run.state()).unwrap();
    let mut worst = [0.0_f64; 4];
    for _ in 0..10_000 {
        run.step(step).unwrap();
        let now = system.momenta(run.state()).unwrap();
        let apart = |a: &[f64], b: &[f64]| {
            let gaps = a.iter().zip(b).map(|(a, b)| (a - b).abs());
            gaps.fold(0.0, f64::max)
        };
        let gaps = [
            (system.energies(run.state()).unwrap().total() - energy).abs(),
            apart(&now.linear, &before.linear),
            apart(&now.angular, &before.angular),
            system.drift(run.state()).unwrap().position,
        ];
        worst = std::array::from_fn(|k| worst[k].max(gaps[k]));
    }
    worst
}

/// Two bodies in space hinged about a skew axis (rigidity of the second then says again how long
/// the axis is) tumble freely: all that is conserved is, to rounding.
#[test]
fn hinged_bodies_keep_energy_and_momenta() {
    let mut scene = Scene::<f64, 3>::new();
    let diagonal = |i: [f64; 3]| {
        std::array::from_fn(|a| std::array::from_fn(|b| if a == b { i[a] } else { 0.0 }))
    };
    let one = RigidBody::new(2.0, diagonal([0.2, 0.3, 0.4])).centre([0.3, 0.0, 0.1]);
    let other = RigidBody::new(1.0, diagonal([0.1, 0.1, 0.15])).centre([-0.4, 0.1, 0.0]);
    let one = scene.add_body(one).unwrap().start();
    let other = scene.add_body(other).unwrap().start();
    scene
        .join(one, other, Joint::Hinge([1.0, 2.0, 2.0]))
        .unwrap();
    let system = scene.assemble().unwrap();
    assert!(system.describe().contains("1 of them implied"), "{system}");
    let mut start = system.rest();
    system
        .set_rigid_velocity(&mut start, [0.0; 3], [0.5, -1.0, 2.0])
        .unwrap();
    // The second turns about the hinge besides.
    let axis = [1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0];
    for a in 0..3 {
        let at = system.coordinate(other, NodalVector::Slope(a)).unwrap();
        let (b, c) = ((a + 1) % 3, (a + 2) % 3);
        start.velocity[at + b] += 3.0 * axis[c];
        start.velocity[at + c] -= 3.0 * axis[b];
    }
    // The initial velocity is brought onto the constraints when a run starts.
    for worst in [
        departures(&system, start.clone(), &EnergyMomentum::conserving(), 0.01),
        departures(&system, start, &Midpoint::default(), 0.01),
    ] {
        // Of some 4 J and 3 kg m^2/s: ten thousand roundings.
        assert!(worst[..3].iter().all(|d| *d < 1e-11), "{worst:?}");
        assert!(worst[3] < 1e-11, "{worst:?}");
    }
}

/// Two points at a distance.
#[derive(Debug)]
struct Cord {
    length: f64,
}

impl<const D: usize> Constraint<f64, D, 2, 1> for Cord {
    fn residual<T: Algebra<f64>>(&self, _time: T, [a, b]: &[[T; D]; 2]) -> [T; 1] {
        let mut square = T::zero();
        for c in 0..D {
            square += (b[c] - a[c]) * (b[c] - a[c]);
        }
        [square.sqrt() - T::lit(self.length)]
    }
}

/// A rubber bow: a beam whose ends a string keeps apart, thrown and let go. Its length is no
/// quadratic function, but one of a quadratic one.
#[test]
fn a_strung_beam_keeps_energy_and_momenta() {
    let rubber = SaintVenantKirchhoff::isotropic(2.0e7, 0.0).unwrap();
    let beam = Beam::new(
        FullyParameterised,
        Disk::new(0.01).unwrap(),
        Continuum::full(rubber),
    );
    let mut scene = Scene::<f64, 2>::new();
    let beam = scene
        .add(beam.straight([0.0; 2], [1.0, 0.0], 3).density(7200.0))
        .unwrap();
    let ends = [beam.start(), beam.end()].map(|node| (node, NodalVector::Position));
    scene.bind(ends, Cord { length: 1.0 }).unwrap();
    let system = scene.assemble().unwrap();
    let mut start = system.rest();
    system
        .set_rigid_velocity(&mut start, [0.0; 2], [0.0, 0.0, 1.0])
        .unwrap();
    let middle = system
        .coordinate(beam.node(1), NodalVector::Position)
        .unwrap();
    start.velocity[middle + 1] += 2.0;
    let worst = departures(&system, start.clone(), &EnergyMomentum::conserving(), 2e-3);
    assert!(
        worst[0] < 1e-10 && worst[1] < 1e-10 && worst[2] < 1e-10,
        "{worst:?}"
    );
    assert!(worst[3] < 1e-11, "{worst:?}");
    // Explicit steps below the limit keep momenta and the string, and lose no energy in the long
    // run.
    let mut run = Integration::start(&system, start, &CentralDifference::default()).unwrap();
    let energy = system.energies(run.state()).unwrap().total();
    let turn = system.momenta(run.state()).unwrap().angular[2];
    let (mut worst, mut drift) = (0.0_f64, 0.0_f64);
    run.until(0.2, Stepping::Stable(0.5), |step| {
        let now = system.energies(step.after)?.total();
        worst = worst.max((now / energy - 1.0).abs());
        let held = system.drift(step.after)?;
        drift = drift.max(held.position).max(held.velocity);
        Ok(())
    })
    .unwrap();
    assert!(worst < 1e-3 && drift < 1e-11, "{worst:e} {drift:e}");
    let left = system.momenta(run.state()).unwrap().angular[2] - turn;
    assert!(left.abs() < 1e-10, "{left:e}");
}
