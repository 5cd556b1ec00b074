//! What each integrator keeps of energy, linear and angular momentum: to rounding where theory says
//! so, and to the order of the step where it does not.

use ancf::prelude::*;

use super::models::{Particle, Solid, Swing, pendulum, rubber, thrown};

/// Largest departures of the energy balance, and of the linear and angular momentum, from what
/// they are at 0.25 s, when the forces are gone; the last over a tenth of a second before the end.
fn departures(system: &System<f64, 2>, scheme: &impl Scheme<f64>, step: f64, end: f64) -> [f64; 3] {
    let mut run = Integration::start(system, system.rest(), scheme).unwrap();
    run.until(0.25, Stepping::Fixed(step), |_| {}).unwrap();
    let report = |state: &State<f64>| {
        let energy = system.energies(state).unwrap();
        let Momenta { linear, angular } = system.momenta(state).unwrap();
        (energy.balance(), linear, angular[2])
    };
    let (energy, [px, py], turn) = report(run.state());
    let mut worst = [0.0_f64; 3];
    let mut count = 0;
    run.until(end, Stepping::Fixed(step), |s| {
        count += 1;
        if count % 10 == 0 {
            let (e, [x, y], l) = report(s.after);
            let now = [(e - energy).abs(), (x - px).hypot(y - py), (l - turn).abs()];
            worst = std::array::from_fn(|i| worst[i].max(now[i]));
        }
    })
    .unwrap();
    worst
}

/// Ten thousand steps of a free rod with 15 J in it, bent as it spins: energy to
/// rounding, momenta to the digits of the numbers. (A hundred thousand steps are in the example
/// `long_run`.)
#[test]
fn the_energy_momentum_method_keeps_all_three() {
    let system = thrown(3, Continuum::selective_reduced(rubber(0.3)));
    let scheme = EnergyMomentum::conserving();
    let [energy, linear, angular] = departures(&system, &scheme, 1e-3, 10.25);
    assert!(energy < 1e-11 * 11.0, "energy: {energy:e} J");
    assert!(linear < 1e-12, "linear momentum: {linear:e}");
    assert!(angular < 1e-12, "angular momentum: {angular:e}");
    // Steps that resolve next to nothing are no worse, and nor are curved rods.
    let [energy, linear, angular] = departures(&system, &scheme, 1e-2, 5.25);
    assert!(energy < 1e-11 * 11.0, "energy: {energy:e} J");
    assert!(linear < 1e-12 && angular < 1e-12, "{linear:e} {angular:e}");
}

/// A ring segment in space, curved, twisted and spinning about an axis of its own: strain is
/// measured in the material frame, and all seven numbers are kept.
#[test]
fn curved_beams_in_space_keep_energy_and_momenta() {
    let mut scene = Scene::<f64, 3>::new();
    let disk = Disk::new(0.02).unwrap();
    let formulation = Continuum::selective_reduced(rubber::<3>(0.3));
    let arc = Beam::new(FullyParameterised, disk, formulation)
        .curved(1.0, 3, |s: f64| {
            let (sin, cos) = s.sin_cos();
            let frame = [[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]];
            ([sin, 1.0 - cos, 0.0], frame)
        })
        .density(1000.0);
    scene.add(arc).unwrap();
    let system = scene.assemble().unwrap();
    let mut state = system.rest();
    system
        .set_rigid_velocity(&mut state, [1.0, -2.0, 0.5], [20.0, 15.0, -25.0])
        .unwrap();
    let start = (
        system.energies(&state).unwrap(),
        system.momenta(&state).unwrap(),
    );
    let scheme = EnergyMomentum::conserving();
    let mut run = Integration::start(&system, state, &scheme).unwrap();
    let mut strained = 0.0_f64;
    run.until(0.5, Stepping::Fixed(2e-3), |s| {
        strained = strained.max(system.energies(s.after).unwrap().elastic);
    })
    .unwrap();
    let end = system.energies(run.state()).unwrap();
    let exchanged = start.0.kinetic;
    assert!(strained > 1.0, "{strained} of {exchanged} J");
    let drift = (end.total() - start.0.total()).abs();
    assert!(drift < 1e-11 * exchanged, "{drift:e} of {exchanged} J");
    let momenta = system.momenta(run.state()).unwrap();
    for c in 0..3 {
        assert!((momenta.linear[c] - start.1.linear[c]).abs() < 1e-12);
        assert!((momenta.angular[c] - start.1.angular[c]).abs() < 1e-12);
    }
}

/// Momenta of a rigid motion by the mechanics of a rod: mass times velocity of the centre, and the
/// moment of inertia times the angular velocity.
#[test]
fn momenta_are_those_of_a_rigid_rod() {
    let (length, radius, density) = (2.0, 0.05, 500.0);
    let mut scene = Scene::<f64, 3>::new();
    let disk = Disk::new(radius).unwrap();
    let formulation = Continuum::full(Solid::<3>::isotropic(1e9, 0.3).unwrap());
    let rod = Beam::new(FullyParameterised, disk, formulation)
        .straight([1.0, 2.0, 0.0], [1.0 + length, 2.0, 0.0], 3)
        .density(density);
    scene.add(rod).unwrap();
    let system = scene.assemble().unwrap();
    let mut state = system.rest();
    let (v, omega) = ([0.3, -0.2, 0.7], [0.5, -1.0, 2.0]);
    system.set_rigid_velocity(&mut state, v, omega).unwrap();
    let mass = density * std::f64::consts::PI * radius * radius * length;
    let cross = |a: [f64; 3], b: [f64; 3]| -> [f64; 3] {
        std::array::from_fn(|c| {
            let (i, j) = ((c + 1) % 3, (c + 2) % 3);
            a[i] * b[j] - a[j] * b[i]
        })
    };
    let centre = [1.0 + length / 2.0, 2.0, 0.0];
    let turned = cross(omega, centre);
    let linear: [f64; 3] = std::array::from_fn(|c| mass * (v[c] + turned[c]));
    let about = cross(centre, linear);
    let [along, across] = [
        mass * radius * radius / 2.0,
        mass * (length * length / 12.0 + radius * radius / 4.0),
    ];
    let momenta = system.momenta(&state).unwrap();
    for c in 0..3 {
        let inertia = if c == 0 { along } else { across };
        let angular = about[c] + inertia * omega[c];
        assert!((momenta.linear[c] - linear[c]).abs() < 1e-12 * mass);
        assert!((momenta.angular[c] - angular).abs() < 1e-11 * mass, "{c}");
    }
}

/// The secant of an energy that is no polynomial keeps it all the same: the pendulum of one
/// unknown, through full turns.
#[test]
fn any_structure_with_a_secant_keeps_its_energy() {
    let swing = Particle::new(Swing);
    let scheme = EnergyMomentum::conserving();
    let mut run = Integration::start(&swing, swing.at(0.0, 2.1), &scheme).unwrap();
    let energy = |s: &State<f64>| 0.5 * s.velocity[0].powi(2) - s.displacement[0].cos();
    let start = energy(run.state());
    run.until(1000.0, Stepping::Fixed(0.1), |_| {}).unwrap();
    let drift = (energy(run.state()) - start).abs();
    assert!(drift < 1e-12, "{drift:e}");
    assert!(
        run.state().displacement[0] > 100.0,
        "it turns over and over"
    );
}

/// Formulations without strain take the mean of the forces along the way: linear momentum is kept,
/// angular momentum only to the second order of the step, and energy, which is no quartic there,
/// to the fourth.
#[test]
fn the_average_of_forces_turns_the_beam_a_little() {
    let stiffness = BeamStiffness {
        axial: 6e3,
        shear: [3e3; 2],
        torsion: 0.1,
        bending: [0.15; 2],
    };
    let mut scene = Scene::<f64, 2>::new();
    let section = Moments::new(2.26, 0.05, 0.05).unwrap();
    let law = StructuralMechanics::with_stiffness(stiffness).unwrap();
    let rod = Beam::new(Quadratic, section, law)
        .straight([0.0; 2], [1.0, 0.0], 2)
        .density(1.0);
    let rod = scene.add(rod).unwrap();
    let on = |t: f64| if t < 0.2 { 1.0 } else { 0.0 };
    scene.force_in_time(rod.end(), [5.0, 20.0], on).unwrap();
    let system = scene.assemble().unwrap();
    let scheme = EnergyMomentum::conserving();
    let coarse = departures(&system, &scheme, 2e-3, 0.75);
    let fine = departures(&system, &scheme, 1e-3, 0.75);
    assert!(coarse[1] < 1e-12 && fine[1] < 1e-12, "{coarse:?} {fine:?}");
    assert!(fine[2] > 1e-10, "angular momentum drifts: {:e}", fine[2]);
    assert!(
        fine[2] < coarse[2] / 2.0 && fine[0] < coarse[0] / 4.0,
        "{coarse:?} {fine:?}"
    );
}

/// Gauss collocation, the midpoint rule among it, and the central difference keep momenta because
/// they are quadratic in the coordinates; the trapezoidal rule does not keep angular momentum.
#[test]
fn symplectic_methods_keep_momenta() {
    let system = thrown(2, Continuum::full(rubber(0.0)));
    let newton = Newton {
        residual: 1e-13,
        ..Newton::default()
    };
    let midpoint = departures(&system, &Midpoint { newton }, 1e-3, 0.75);
    let gauss = Collocation::gauss(2).with_newton(newton);
    let gauss = departures(&system, &gauss, 1e-3, 0.75);
    let explicit = departures(&system, &CentralDifference::default(), 5e-5, 0.75);
    for [_, linear, angular] in [midpoint, gauss, explicit] {
        assert!(linear < 1e-10 && angular < 1e-10, "{linear:e} {angular:e}");
    }
    let trapezoidal = departures(&system, &Newmark::trapezoidal(), 1e-3, 0.75);
    assert!(trapezoidal[2] > 1e-6, "{trapezoidal:?}");
}

/// The paper's pendulum of six elements at a nominal step of 1 ms: energy to 1e-9 of the 11 J
/// exchanged in a bounded number of iterations per step, where it bends like a whip, too: some eight
/// with a tangent that is kept until it is slow, half as many with new ones. (The first three of
/// sixty seconds; all are in the example `long_run`.)
#[test]
fn the_pendulum_keeps_its_energy() {
    for (refresh, bound) in [(Refresh::WhenSlow, 15), (Refresh::EveryIteration, 8)] {
        keeps_its_energy(refresh, bound);
    }
}

/// No step takes more than `bound` iterations.
fn keeps_its_energy(refresh: Refresh, bound: usize) {
    let (system, _) = pendulum(6);
    let mut scheme = EnergyMomentum::conserving();
    scheme.newton.refresh = refresh;
    let mut run = Integration::start(&system, system.rest(), &scheme).unwrap();
    let mut worst = 0.0_f64;
    let mut exchanged = 0.0_f64;
    let (mut before, mut most) = (0, 0);
    run.until(
        3.0,
        Stepping::Halved {
            step: 1e-3,
            halvings: 6,
        },
        |s| {
            let energies = system.energies(s.after).unwrap();
            worst = worst.max(energies.balance().abs());
            exchanged = exchanged.max(energies.kinetic);
            most = most.max(s.report.iterations - before);
            before = s.report.iterations;
        },
    )
    .unwrap();
    assert!(exchanged > 10.0);
    assert!(worst < 1e-9 * exchanged, "{worst:e} of {exchanged} J");
    assert_eq!(run.report().failed, 0);
    assert!(most <= bound, "{refresh:?}: {most} iterations");
}
