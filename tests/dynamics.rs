//! Claims about the motion of beams: exact motions, conservation, the paper's pendulum and ramp
//! against independent references, and what happens when a step fails.

use ancf::prelude::*;
use std::f64::consts::PI;

type Solid<const D: usize> = SaintVenantKirchhoff<f64, D>;

/// The paper's pendulum or a variant of it in `D` dimensions.
fn paper_pendulum<const D: usize, const S: usize>(
    n: usize,
    formulation: Continuum<Solid<D>>,
) -> (System<f64, D>, Placed)
where
    FullyParameterised: Element<D, S>,
    Continuum<Solid<D>>: Formulation<f64, FullyParameterised, D, S>,
{
    let axis = |k: usize, v: f64| std::array::from_fn(|c| if c == k { v } else { 0.0 });
    let mut scene = Scene::<f64, D>::new();
    let disk = Disk::new(0.01).unwrap();
    let beam = Beam::new(FullyParameterised, disk, formulation);
    let beam = beam.straight([0.0; D], axis(0, 1.0), n).density(7200.0);
    let beam = scene.add(beam).unwrap();
    scene.pin(beam.start()).unwrap();
    scene.gravity(axis(1, -9.81)).unwrap();
    (scene.assemble().unwrap(), beam)
}

fn rubber<const D: usize>(poisson: f64) -> Solid<D> {
    Solid::isotropic(2.0e7, poisson).unwrap()
}

/// Rows `t, x, y` of a reference trajectory.
fn reference(csv: &str) -> Vec<[f64; 3]> {
    let rows = csv.lines().filter(|line| !line.starts_with('#'));
    rows.map(|line| {
        let mut numbers = line.split(',').map(|x| x.parse().unwrap());
        std::array::from_fn(|_| numbers.next().unwrap())
    })
    .collect()
}

/// Largest distance of the tip to the reference at every `every`-th row up to `end`.
fn distance<const D: usize>(
    (system, beam): &(System<f64, D>, Placed),
    rows: &[[f64; 3]],
    every: usize,
    end: f64,
    step: f64,
) -> f64 {
    let at = system
        .coordinate(beam.end(), NodalVector::Position)
        .unwrap();
    let mut left = rows.iter().step_by(every).skip(1).peekable();
    let mut largest = 0.0_f64;
    let method = Newmark::trapezoidal();
    let mut run = Integration::start(system, system.rest(), &method).unwrap();
    run.until(end, Stepping::Fixed(step), |s| {
        while let Some([t, x, y]) = left.next_if(|row| row[0] <= s.after.time + 1e-9) {
            let time = t.min(s.after.time);
            let dx = system.reference()[at] + s.displacement_at(time, at).unwrap() - x;
            let dy = system.reference()[at + 1] + s.displacement_at(time, at + 1).unwrap() - y;
            largest = largest.max(dx.hypot(dy));
        }
    })
    .unwrap();
    largest
}

const PENDULUM: &str = include_str!("../papers/orzechowski-2012/data/pendulum_ancf_limit_nu0.csv");

/// The tip of the pendulum against the converged trajectory, at every tenth of a second to 1 s:
/// figures of an independent implementation of the same element.
#[test]
fn the_pendulum_converges_to_its_limit() {
    let rows = reference(PENDULUM);
    for (n, published) in [(6, 5.3e-2), (10, 1.5e-2), (20, 1.4e-3)] {
        let scene = paper_pendulum::<2, 6>(n, Continuum::full(rubber(0.0)));
        let distance = distance(&scene, &rows, 10, 1.0, 2e-4);
        assert!(
            (distance / published - 1.0).abs() < 0.1,
            "{n} elements: {distance} m"
        );
    }
}

#[test]
fn plane_and_space_swing_alike() {
    let tip = |x: f64, y: f64| [x, y];
    let space = paper_pendulum::<3, 8>(6, Continuum::full(rubber(0.0)));
    let plane = paper_pendulum::<2, 6>(6, Continuum::full(rubber(0.0)));
    let method = Newmark::trapezoidal();
    let mut in_space = Integration::start(&space.0, space.0.rest(), &method).unwrap();
    let mut in_plane = Integration::start(&plane.0, plane.0.rest(), &method).unwrap();
    in_space.until(1.0, Stepping::Fixed(1e-3), |_| {}).unwrap();
    in_plane.until(1.0, Stepping::Fixed(1e-3), |_| {}).unwrap();
    let [x, y, z] = space.0.position(in_space.state(), space.1.end()).unwrap();
    let [u, v] = plane.0.position(in_plane.state(), plane.1.end()).unwrap();
    let (a, b) = (tip(x, y), tip(u, v));
    assert!(
        (a[0] - b[0]).abs() < 1e-7 && (a[1] - b[1]).abs() < 1e-7,
        "{a:?} {b:?}"
    );
    assert!(z.abs() < 1e-9);
}

/// Both estimators carry the pendulum through 2 s at a tolerance of 1e-4, losing little energy of
/// the 11 J exchanged.
#[test]
fn adaptive_newmark_completes_the_pendulum() {
    for estimator in [Estimator::LiZengWiberg, Estimator::ZienkiewiczXie] {
        let (system, _) = paper_pendulum::<3, 8>(6, Continuum::full(rubber(0.0)));
        let method = Newmark::trapezoidal().with_estimator(estimator);
        let mut run = Integration::start(&system, system.rest(), &method).unwrap();
        let control = Stepping::Adaptive(Adaptive::to(1e-4));
        let mut worst = 0.0_f64;
        run.until(2.0, control, |step| {
            worst = worst.max(system.energies(step.after).unwrap().balance().abs());
        })
        .unwrap();
        assert_eq!(run.state().time, 2.0);
        assert!(worst < 2e-2, "{estimator:?}: energy error {worst} J");
    }
}

/// A tangent frozen at the start loses the pendulum early at every step, and keeps the last good
/// state; full Newton goes on from there.
#[test]
fn a_frozen_tangent_dies_and_full_newton_goes_on() {
    for step in [1e-2, 1e-3] {
        let (system, _) = paper_pendulum::<3, 8>(6, Continuum::full(rubber(0.0)));
        let frozen = Newton {
            refresh: Refresh::Never,
            ..Newton::default()
        };
        let method = Newmark::trapezoidal().with_newton(frozen);
        let mut run = Integration::start(&system, system.rest(), &method).unwrap();
        let error = run.until(2.0, Stepping::Fixed(step), |_| {}).unwrap_err();
        let Error::StepFailed { time, .. } = error else {
            panic!("{error}");
        };
        assert!((0.02..0.4).contains(&time), "{step}: died at {time} s");
        let state = run.into_state();
        assert!((state.time - time).abs() < 1e-12);
        assert!(state.displacement.iter().all(|u| u.is_finite()));
        let mut run = Integration::start(&system, state, &Newmark::trapezoidal()).unwrap();
        run.until(1.0, Stepping::Fixed(step), |_| {}).unwrap();
    }
}

/// An undeformed free beam falls and drifts exactly: the trapezoidal rule integrates a constant
/// acceleration without error, and no strain arises.
#[test]
fn a_thrown_beam_follows_the_parabola() {
    let mut scene = Scene::<f64, 3>::new();
    let disk = Disk::new(0.01).unwrap();
    let beam = Beam::new(FullyParameterised, disk, Continuum::full(rubber(0.3)));
    let beam = beam
        .straight([1.0, 2.0, 3.0], [1.5, 2.5, 3.0], 4)
        .density(1000.0);
    let beam = scene.add(beam).unwrap();
    scene.gravity([0.0, 0.0, -9.81]).unwrap();
    let system = scene.assemble().unwrap();
    let mut state = system.rest();
    system
        .set_rigid_velocity(&mut state, [3.0, -2.0, 5.0], [0.0; 3])
        .unwrap();
    let mut run = Integration::start(&system, state, &Newmark::trapezoidal()).unwrap();
    run.until(1.0, Stepping::Fixed(1e-2), |_| {}).unwrap();
    for node in 0..beam.nodes() {
        let moved = system.displacement(run.state(), beam.node(node)).unwrap();
        for (c, exact) in [3.0, -2.0, 5.0 - 9.81 / 2.0].into_iter().enumerate() {
            assert!((moved[c] - exact).abs() < 1e-9, "node {node}: {moved:?}");
        }
    }
    assert!(system.energies(run.state()).unwrap().elastic < 1e-12);
}

/// A free spinning beam turns by the angle it should, and its centre stays.
#[test]
fn a_spinning_beam_turns_about_its_centre() {
    let mut scene = Scene::<f64, 3>::new();
    let disk = Disk::new(0.02).unwrap();
    let steel = Solid::isotropic(2e11, 0.3).unwrap();
    let beam = Beam::new(FullyParameterised, disk, Continuum::full(steel));
    let beam = beam
        .straight([-0.5, 0.0, 0.0], [0.5, 0.0, 0.0], 4)
        .density(7800.0);
    let beam = scene.add(beam).unwrap();
    let system = scene.assemble().unwrap();
    let mut state = system.rest();
    let omega = 2.0 * PI;
    system
        .set_rigid_velocity(&mut state, [0.0; 3], [0.0, 0.0, omega])
        .unwrap();
    let mut run = Integration::start(&system, state, &Newmark::trapezoidal()).unwrap();
    run.until(0.25, Stepping::Fixed(5e-4), |_| {}).unwrap();
    let tip = system.position(run.state(), beam.end()).unwrap();
    // A quarter turn; the rule's phase lag is (omega dt)^2 / 12 of it.
    assert!(
        tip[0].abs() < 1e-5 && (tip[1] - 0.5).abs() < 1e-5,
        "{tip:?}"
    );
    let centre = system.position(run.state(), beam.node(2)).unwrap();
    assert!(centre.iter().all(|c| c.abs() < 1e-9), "{centre:?}");
}

/// First natural frequency of a cantilever, from the zero crossings of a small free vibration:
/// `1.8751^2 sqrt(E I / (rho A L^4))`.
#[test]
fn a_cantilever_vibrates_at_its_first_natural_frequency() {
    let (young, radius, density) = (2e9, 5e-3, 1000.0);
    let mut scene = Scene::<f64, 2>::new();
    let disk = Disk::new(radius).unwrap();
    let solid = Solid::isotropic(young, 0.0).unwrap();
    let beam = Beam::new(FullyParameterised, disk, Continuum::full(solid));
    let beam = scene
        .add(beam.straight([0.0; 2], [1.0, 0.0], 12).density(density))
        .unwrap();
    scene.clamp(beam.start()).unwrap();
    // Unloaded a moment after the start: the static shape is nearly the first mode.
    scene
        .force_in_time(beam.end(), [0.0, 1e-3], |t| if t > 0.0 { 0.0 } else { 1.0 })
        .unwrap();
    let system = scene.assemble().unwrap();
    let mut state = system.rest();
    Statics::default().solve(&system, &mut state).unwrap();
    let at = system
        .coordinate(beam.end(), NodalVector::Position)
        .unwrap()
        + 1;
    let mut run = Integration::start(&system, state, &Newmark::trapezoidal()).unwrap();
    let mut crossings = Vec::new();
    let omega = 3.516_015_3 * (young * radius * radius / 4.0 / density).sqrt();
    let period = 2.0 * PI / omega;
    run.until(5.2 * period, Stepping::Fixed(period / 400.0), |s| {
        let (a, b) = (s.before.displacement[at], s.after.displacement[at]);
        if a * b < 0.0 {
            crossings.push(s.before.time + (s.after.time - s.before.time) * a / (a - b));
        }
    })
    .unwrap();
    let half_periods = (crossings.len() - 1) as f64;
    let measured = 2.0 * (crossings[crossings.len() - 1] - crossings[0]) / half_periods;
    assert!(
        (measured / period - 1.0).abs() < 3e-3,
        "{measured} s, not {period}"
    );
}

/// Energy supplied by a growing force is found again in the beam.
#[test]
fn the_energy_balance_closes() {
    let errors = [2e-3, 1e-3].map(|step| {
        let mut scene = Scene::<f64, 2>::new();
        let disk = Disk::new(0.01).unwrap();
        let beam = Beam::new(FullyParameterised, disk, Continuum::full(rubber(0.0)));
        let beam = scene
            .add(beam.straight([0.0; 2], [1.0, 0.0], 8).density(7200.0))
            .unwrap();
        scene.clamp(beam.start()).unwrap();
        scene.force_in_time(beam.end(), [0.0, 2.0], |t| t).unwrap();
        let system = scene.assemble().unwrap();
        let mut run = Integration::start(&system, system.rest(), &Newmark::trapezoidal()).unwrap();
        run.until(1.0, Stepping::Fixed(step), |_| {}).unwrap();
        let energies = system.energies(run.state()).unwrap();
        assert!(energies.work > 0.05);
        (energies.balance() / energies.work).abs()
    });
    assert!(errors[1] < 1e-4 && errors[1] < errors[0], "{errors:?}");
}

/// The paper's ramp: tip deflection at the end, figures of an independent implementation of the
/// same element at the same time step (millimetres).
#[test]
fn the_ramp_reaches_the_known_deflections() {
    let steel = |nu| Solid::<2>::isotropic(2e11, nu).unwrap();
    let tip = |n: usize, formulation: Continuum<Solid<2>>| {
        let mut scene = Scene::<f64, 2>::new();
        let disk = Disk::new(2.5e-3).unwrap();
        let beam = Beam::new(FullyParameterised, disk, formulation);
        let beam = scene
            .add(beam.straight([0.0; 2], [1.0, 0.0], n).density(7200.0))
            .unwrap();
        scene.clamp(beam.start()).unwrap();
        scene.force_in_time(beam.end(), [0.0, 1.0], |t| t).unwrap();
        let system = scene.assemble().unwrap();
        let mut run = Integration::start(&system, system.rest(), &Newmark::trapezoidal()).unwrap();
        let at = system
            .coordinate(beam.end(), NodalVector::Position)
            .unwrap()
            + 1;
        run.until(1.0, Stepping::Fixed(1e-3), |_| {}).unwrap();
        1e3 * run.state().displacement[at]
    };
    for (n, truth) in [(4, 45.065), (8, 55.557), (16, 56.191)] {
        let deflection = tip(n, Continuum::full(steel(0.0)));
        assert!(
            (deflection - truth).abs() < 5e-3,
            "{n} elements: {deflection} mm, not {truth}"
        );
    }
    let free = tip(16, Continuum::selective_reduced(steel(0.3)));
    assert!((free - 56.191).abs() < 0.02, "{free} mm");
}

/// A load that turns into NaN stops the run with its time, and the state before it is kept.
#[test]
fn a_load_that_breaks_mid_run_is_named_and_the_last_state_kept() {
    for stepping in [
        Stepping::Fixed(1e-3),
        Stepping::Adaptive(Adaptive::to(1e-3)),
    ] {
        let mut scene = Scene::<f64, 2>::new();
        let disk = Disk::new(0.01).unwrap();
        let beam = Beam::new(FullyParameterised, disk, Continuum::full(rubber(0.0)));
        let beam = scene
            .add(beam.straight([0.0; 2], [1.0, 0.0], 4).density(7200.0))
            .unwrap();
        scene.clamp(beam.start()).unwrap();
        let course = |t: f64| if t > 0.05 { f64::NAN } else { 1.0 };
        scene.force_in_time(beam.end(), [0.0, 1.0], course).unwrap();
        let system = scene.assemble().unwrap();
        let mut run = Integration::start(&system, system.rest(), &Newmark::trapezoidal()).unwrap();
        let error = run.until(1.0, stepping, |_| {}).unwrap_err();
        let text = error.to_string();
        assert!(text.contains("NaN") && text.contains("load"), "{text}");
        assert!(run.state().time > 0.03 && run.state().time <= 0.05 + 1e-9);
        assert!(run.state().displacement.iter().all(|u| u.is_finite()));
    }
}

/// A step so small that positions hardly change keeps its accelerations: they are not formed
/// from differences of positions.
#[test]
fn tiny_steps_keep_the_acceleration() {
    let (system, beam) = paper_pendulum::<2, 6>(4, Continuum::full(rubber(0.0)));
    let at = system
        .coordinate(beam.end(), NodalVector::Position)
        .unwrap()
        + 1;
    let method = Newmark::trapezoidal();
    let mut run = Integration::start(&system, system.rest(), &method).unwrap();
    run.until(0.1, Stepping::Fixed(1e-3), |_| {}).unwrap();
    let before = run.state().acceleration[at];
    for _ in 0..10 {
        run.step(1e-8).unwrap();
    }
    let after = run.state().acceleration[at];
    assert!((after / before - 1.0).abs() < 1e-4, "{before} {after}");
}

/// Velocities given to supports are not kept.
#[test]
fn supports_do_not_move() {
    let (system, _) = paper_pendulum::<2, 6>(4, Continuum::full(rubber(0.0)));
    let mut state = system.rest();
    state.velocity[1] = 5.0;
    let run = Integration::start(&system, state, &Newmark::trapezoidal()).unwrap();
    assert_eq!(run.state().velocity[1], 0.0);
}
