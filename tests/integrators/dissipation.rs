//! Dissipation is what the parameters say: the spectral radius of the alpha methods, the decay of
//! unresolved motion, viscosity that takes energy and leaves momenta, and a Kelvin-Voigt material.

use std::f64::consts::PI;

use ancf::prelude::*;

use super::models::{Particle, Solid, Spring, Swing, pendulum, rubber, thrown};

/// Size of the state of an oscillator after `steps` steps a million times too long for it.
fn unresolved(scheme: &impl Scheme<f64>, steps: usize) -> f64 {
    let spring = Particle::new(Spring(1e6));
    let mut run = Integration::start(&spring, spring.at(1e-9, 0.0), scheme).unwrap();
    for _ in 0..steps {
        run.step(1.0).unwrap();
    }
    // At such steps the displacement is nothing and the velocity little beside the acceleration.
    run.state().acceleration[0].abs()
}

/// The factor per step by which unresolved motion falls is the parameter of the generalised alpha
/// method. Its three roots coincide there, so that the motion is the factor's power times a
/// quadratic in the number of steps.
#[test]
fn unresolved_motion_falls_by_the_spectral_radius() {
    for radius in [0.9_f64, 0.7, 0.5] {
        let scheme = Newmark::generalised_alpha(radius);
        let steps = 200;
        let [half, all] = [steps, 2 * steps].map(|n| unresolved(&scheme, n));
        let polynomial = 5.0_f64;
        let observed = (all / half).powf(1.0 / steps as f64);
        let bounds = [1.0, polynomial.powf(1.0 / steps as f64)];
        assert!(
            observed > 0.999 * radius * bounds[0] && observed < 1.001 * radius * bounds[1],
            "{observed}, not {radius}"
        );
    }
    // Annihilated in the steps that the three roots need.
    assert!(unresolved(&Newmark::generalised_alpha(0.0), 4) < 1e-3 * 1e3);
    // Hilber, Hughes and Taylor with alpha = 0.3 at infinity: the known limit 0.538.
    let [half, all] = [40, 80].map(|n| unresolved(&Newmark::hht(0.3), n));
    let observed = (all / half).powf(1.0 / 40.0);
    assert!((observed - 7.0 / 13.0).abs() < 0.02, "{observed}");
}

/// Without dissipation all of the family are the trapezoidal rule or follow it.
#[test]
fn the_limits_of_the_family_coincide() {
    assert_eq!(Newmark::hht(0.0), Newmark::trapezoidal());
    let swing = Particle::new(Swing);
    let end = |scheme: Newmark| {
        let mut run = Integration::start(&swing, swing.at(1.0, 0.0), &scheme).unwrap();
        run.until(5.0, Stepping::Fixed(0.05), |_| {}).unwrap();
        run.into_state().displacement[0]
    };
    // Chung and Hulbert's limit averages accelerations as well as forces: the same without lag.
    let gap = (end(Newmark::generalised_alpha(1.0)) - end(Newmark::trapezoidal())).abs();
    assert!(gap < 1e-8, "{gap:e}");
}

/// Radau's methods forget unresolved motion within a step; Gauss's and the midpoint rule never do.
#[test]
fn radau_forgets_what_the_step_does_not_resolve() {
    let spring = Particle::new(Spring(1e6));
    let after = |scheme: Collocation| {
        let mut run = Integration::start(&spring, spring.at(1e-9, 0.0), &scheme).unwrap();
        run.step(1.0).unwrap();
        run.state().displacement[0].abs()
    };
    for stages in [2, 3] {
        assert!(after(Collocation::radau(stages)) < 1e-12);
        assert!((after(Collocation::gauss(stages)) - 1e-9).abs() < 1e-12);
    }
}

/// Viscosity never adds energy, step by step, and does not touch the momenta.
#[test]
fn viscosity_takes_energy_and_leaves_momenta() {
    let system = thrown(3, Continuum::selective_reduced(rubber(0.3)));
    let mut scheme = EnergyMomentum::conserving();
    scheme.viscosity = 0.1;
    let mut run = Integration::start(&system, system.rest(), &scheme).unwrap();
    run.until(0.25, Stepping::Fixed(2e-3), |_| {}).unwrap();
    let start = system.momenta(run.state()).unwrap();
    let first = system.energies(run.state()).unwrap().balance();
    let mut last = first;
    run.until(2.25, Stepping::Fixed(2e-3), |s| {
        let balance = system.energies(s.after).unwrap().balance();
        assert!(balance <= last + 1e-12, "{balance} after {last}");
        last = balance;
    })
    .unwrap();
    assert!(first - last > 0.1, "{first} to {last} J");
    let end = system.momenta(run.state()).unwrap();
    assert!((end.linear[0] - start.linear[0]).abs() < 1e-12);
    assert!((end.linear[1] - start.linear[1]).abs() < 1e-12);
    assert!((end.angular[2] - start.angular[2]).abs() < 1e-12);
}

/// Longitudinal vibration of a bar of a Kelvin-Voigt material: with the retardation time `tau` the
/// amplitude falls as `exp(-omega^2 tau t / 2)`.
#[test]
fn retardation_damps_as_a_kelvin_voigt_material() {
    let (young, density, tau) = (2e7_f64, 1000.0, 2e-4);
    let mut scene = Scene::<f64, 2>::new();
    let disk = Disk::new(0.01).unwrap();
    let solid = Continuum::full(Solid::isotropic(young, 0.0).unwrap());
    let bar = Beam::new(FullyParameterised, disk, solid)
        .straight([0.0; 2], [1.0, 0.0], 4)
        .density(density);
    let bar = scene.add(bar).unwrap();
    scene.pin(bar.start()).unwrap();
    let system = scene.assemble().unwrap();
    // The first mode, small enough to be linear.
    let mut state = system.rest();
    for n in 0..bar.nodes() {
        let x = PI / 2.0 * n as f64 / (bar.nodes() - 1) as f64;
        let node = bar.node(n);
        let at = system.coordinate(node, NodalVector::Position).unwrap();
        state.displacement[at] = 1e-6 * x.sin();
        let slope = system.coordinate(node, NodalVector::Slope(0)).unwrap();
        state.displacement[slope] = 1e-6 * PI / 2.0 * x.cos();
    }
    system.unknowns().follow(&mut state.displacement);
    let omega = PI / 2.0 * (young / density).sqrt();
    let period = 2.0 * PI / omega;
    let energy = |state: &State<f64>| system.energies(state).unwrap().total();
    let scheme = EnergyMomentum::kelvin_voigt(tau);
    let start = energy(&state);
    let mut run = Integration::start(&system, state, &scheme).unwrap();
    run.until(2.0 * period, Stepping::Fixed(period / 200.0), |_| {})
        .unwrap();
    let observed = -(energy(run.state()) / start).ln() / (2.0 * period);
    let exact = omega * omega * tau;
    assert!(
        (observed / exact - 1.0).abs() < 5e-3,
        "{observed} not {exact}"
    );
}

/// A little viscosity on the paper's pendulum at 1 ms: while the motion is resolved the energy falls
/// by no more than a thousandth of what is exchanged, and never grows; with 1e-8 by little enough to
/// stay within that for a minute (example `long_run`), in few iterations a step.
#[test]
fn a_little_viscosity_costs_little_energy() {
    for (viscosity, share) in [(1e-3, 1e-3), (1e-8, 1e-8)] {
        costs_little(viscosity, share);
    }
}

fn costs_little(viscosity: f64, share: f64) {
    let (system, _) = pendulum(6);
    let mut scheme = EnergyMomentum::conserving();
    scheme.viscosity = viscosity;
    scheme.newton.refresh = Refresh::EveryIteration;
    let mut run = Integration::start(&system, system.rest(), &scheme).unwrap();
    let (mut exchanged, mut last) = (0.0_f64, 0.0_f64);
    run.until(2.0, Stepping::Fixed(1e-3), |s| {
        let energies = system.energies(s.after).unwrap();
        assert!(energies.balance() <= last + 1e-12);
        last = energies.balance();
        exchanged = exchanged.max(energies.kinetic);
    })
    .unwrap();
    assert!(
        last < 0.0 && last > -share * exchanged,
        "{last} of {exchanged} J"
    );
    let report = run.report();
    assert!(report.iterations < 6 * report.steps, "{report:?}");
}
