//! Step control: the tolerance is delivered, steps are halved where they fail, explicit steps stay
//! stable, and events are met when they happen.

use std::f64::consts::PI;

use ancf::prelude::*;

use super::models::{Particle, Potential, Solid, Spring, Swing, pendulum};

/// A quarter of the period from 90 degrees.
const QUARTER: f64 = 1.854_074_677_301_371_9;

/// Tip of the paper's pendulum at half a second.
fn tip(scheme: &impl Scheme<f64>, stepping: Stepping) -> ([f64; 2], RunReport) {
    let (system, beam) = pendulum(6);
    let mut run = Integration::start(&system, system.rest(), scheme).unwrap();
    run.until(0.5, stepping, |_| {}).unwrap();
    let at = system.position(run.state(), beam.end()).unwrap();
    (at, run.report())
}

/// Error of the tip over the tolerance (the motion is of the size of a metre), for two tolerances.
fn delivered(scheme: &impl Scheme<f64>, truth: [f64; 2]) -> [f64; 2] {
    [1e-4, 1e-5].map(|tolerance| {
        let control = Adaptive::smoothly_to(tolerance);
        let (at, report) = tip(scheme, Stepping::Adaptive(control));
        assert!(20 * report.rejected < report.steps, "{report:?}");
        (at[0] - truth[0]).hypot(at[1] - truth[1]) / tolerance
    })
}

/// Half a second of the pendulum, against the same mesh at tiny steps: the error of the tip is
/// the tolerance within a factor of five. Gauss's methods are better than what they control, the
/// polynomial inside the step.
#[test]
fn the_error_delivered_is_the_tolerance() {
    let radau = Collocation::radau(3);
    let [fine, truth] = [5e-4, 2.5e-4].map(|step| tip(&radau, Stepping::Fixed(step)).0);
    let known = (fine[0] - truth[0]).hypot(fine[1] - truth[1]);
    assert!(known < 1e-7, "truth known to {known:e} m");
    for (name, [loose, tight]) in [
        ("trapezoidal", delivered(&Newmark::trapezoidal(), truth)),
        ("alpha", delivered(&Newmark::generalised_alpha(0.6), truth)),
        ("midpoint", delivered(&Midpoint::default(), truth)),
        ("energy", delivered(&EnergyMomentum::conserving(), truth)),
        ("Radau 2", delivered(&Collocation::radau(2), truth)),
        ("Radau 3", delivered(&radau, truth)),
    ] {
        for ratio in [loose, tight] {
            assert!((0.2..5.0).contains(&ratio), "{name}: {loose}, {tight}");
        }
    }
    for stages in [2, 3] {
        let [loose, tight] = delivered(&Collocation::gauss(stages), truth);
        assert!(loose < 0.2 && tight < 0.2, "{stages}: {loose}, {tight}");
    }
}

/// The estimate of every method shrinks with the power of the step that the control assumes.
#[test]
fn error_estimates_have_the_order_they_claim() {
    fn observed(scheme: &impl Scheme<f64>) -> (f64, i32) {
        let swing = Particle::new(Swing);
        // The last step before 0.4 s.
        let [coarse, fine] = [0.02, 0.01].map(|step| {
            let mut now = swing.at(1.0, 0.5);
            let mut method = scheme.start(&swing, &mut now).unwrap();
            let mut next = now.clone();
            while now.time < 0.4 - 0.5 * step {
                method.advance(&swing, &now, &mut next, step).unwrap();
                method.accept(&now, &next);
                std::mem::swap(&mut now, &mut next);
            }
            let (error, _) = method.error(&swing, &next, &now);
            (error, method.error_order())
        });
        ((coarse.0 / fine.0).log2(), fine.1)
    }
    for (name, (order, claimed)) in [
        ("trapezoidal", observed(&Newmark::trapezoidal())),
        ("alpha", observed(&Newmark::generalised_alpha(0.6))),
        ("midpoint", observed(&Midpoint::default())),
        ("energy", observed(&EnergyMomentum::conserving())),
        ("central", observed(&CentralDifference::default())),
        ("Gauss 2", observed(&Collocation::gauss(2))),
        ("Gauss 3", observed(&Collocation::gauss(3))),
        ("Radau 2", observed(&Collocation::radau(2))),
        ("Radau 3", observed(&Collocation::radau(3))),
    ] {
        let gap = (order - f64::from(claimed)).abs();
        assert!(gap < 0.4, "{name}: {order}, claimed {claimed}");
    }
}

/// Proportional control rejects fewer steps than the paper's procedure, on a motion whose error
/// swings.
#[test]
fn smooth_control_rejects_less() {
    let rejected = |control| {
        let (_, report) = tip(&Newmark::trapezoidal(), Stepping::Adaptive(control));
        report.rejected
    };
    let (smooth, paper) = (
        rejected(Adaptive::smoothly_to(1e-5)),
        rejected(Adaptive::to(1e-5)),
    );
    assert!(4 * smooth < paper, "{smooth} and {paper}");
}

/// A rod dropped on a step that Newton's method cannot take gets through by halves, and ends at the
/// very times asked for.
#[test]
fn failed_steps_are_halved() {
    let (system, _) = pendulum(6);
    let newton = Newton {
        iterations: 4,
        ..Newton::default()
    };
    let scheme = Newmark::trapezoidal().with_newton(newton);
    let run = |stepping| {
        let mut run = Integration::start(&system, system.rest(), &scheme).unwrap();
        let result = run.until(0.6, stepping, |_| {});
        (result, run.state().time, run.report())
    };
    let step = 0.03;
    let (alone, time, _) = run(Stepping::Fixed(step));
    assert!(matches!(alone, Err(Error::StepFailed { .. })) && time < 0.6);
    let (halved, time, report) = run(Stepping::Halved { step, halvings: 6 });
    halved.unwrap();
    assert_eq!(time, 0.6);
    assert!(report.failed > 0 && report.steps > 20, "{report:?}");
}

/// The limit found for a spring is `2 / omega`; beyond it a step is refused.
#[test]
fn the_stability_limit_of_a_spring_is_exact() {
    let spring = Particle::new(Spring(50.0));
    let scheme = CentralDifference::default();
    let mut run = Integration::start(&spring, spring.at(1.0, 0.0), &scheme).unwrap();
    run.step(0.0399).unwrap();
    let refused = run.step(0.0401).unwrap_err().to_string();
    assert!(refused.contains("stability limit of 4e-2"), "{refused}");
}

/// The step of the automatic control follows the fastest motion of a beam: the thickness mode at
/// `(2 / R) sqrt(E / rho)` or above it. Just below the limit the energy stays, with a support that moves
/// nothing in error.
#[test]
fn explicit_steps_stay_below_the_fastest_motion() {
    let (system, _) = pendulum(4);
    let scheme = CentralDifference { renewal: 10 };
    let mut method = scheme.start(&system, &mut system.rest()).unwrap();
    let limit = method
        .stable_step(&system, &system.rest())
        .unwrap()
        .unwrap();
    let thickness = 200.0 * (2e7_f64 / 7200.0).sqrt();
    assert!(2.0 / limit > thickness, "{limit:e} s");
    let mut run = Integration::start(&system, system.rest(), &scheme).unwrap();
    let mut worst = 0.0_f64;
    run.until(0.3, Stepping::Stable(0.95), |s| {
        worst = worst.max(system.energies(s.after).unwrap().balance().abs());
    })
    .unwrap();
    assert!(worst < 1e-3, "{worst} J");
    let mut free = Integration::start(&system, system.rest(), &Newmark::trapezoidal()).unwrap();
    free.until(0.3, Stepping::Fixed(2e-4), |_| {}).unwrap();
    let gap = run
        .state()
        .displacement
        .iter()
        .zip(&free.state().displacement);
    let gap = gap.fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
    assert!(gap < 1e-4, "explicit and implicit differ by {gap}");
}

/// The pendulum passes the vertical after a quarter of its period, at a time that is known, whatever
/// the step; the run stands there and can go on to the next passage.
#[test]
fn events_are_met_when_they_happen() {
    let swing = Particle::new(Swing);
    let scheme = Collocation::gauss(3).with_newton(Newton {
        residual: 1e-13,
        ..Newton::default()
    });
    for stepping in [
        Stepping::Fixed(0.1),
        Stepping::Adaptive(Adaptive::smoothly_to(1e-9)),
    ] {
        let mut run = Integration::start(&swing, swing.at(PI / 2.0, 0.0), &scheme).unwrap();
        let angle = |state: &State<f64>| state.displacement[0];
        let mut seen = 0.0;
        let mut next = |crossing, end| {
            run.until_event(end, stepping, crossing, angle, |s| seen = s.after.time)
                .map(|met| (met, run.state().time))
                .unwrap()
        };
        let (met, time) = next(Crossing::Falling, 10.0);
        assert!(
            met == Ending::Event && (time - QUARTER).abs() < 1e-7,
            "{time}"
        );
        // The same direction is met a whole period on, either direction half a period on.
        let (met, time) = next(Crossing::Falling, 10.0);
        assert!(
            met == Ending::Event && (time - 5.0 * QUARTER).abs() < 1e-7,
            "{time}"
        );
        let (met, time) = next(Crossing::Any, 20.0);
        assert!(
            met == Ending::Event && (time - 7.0 * QUARTER).abs() < 1e-7,
            "{time}"
        );
        // And not met before an end that comes first.
        let (met, time) = next(Crossing::Any, time + QUARTER);
        assert!(met == Ending::End && time == seen);
    }
}

/// The end of a beam that is thrown up comes down again when mechanics says so, and the state at the
/// event is one of the run's.
#[test]
fn a_beam_lands_on_time() {
    let mut scene = Scene::<f64, 2>::new();
    let disk = Disk::new(0.01).unwrap();
    let solid = Continuum::full(Solid::isotropic(2e7, 0.0).unwrap());
    let beam = Beam::new(FullyParameterised, disk, solid);
    let beam = scene
        .add(beam.straight([0.0; 2], [1.0, 0.0], 2).density(1000.0))
        .unwrap();
    scene.gravity([0.0, -10.0]).unwrap();
    let system = scene.assemble().unwrap();
    let mut state = system.rest();
    system
        .set_rigid_velocity(&mut state, [0.0, 3.0], [0.0; 3])
        .unwrap();
    let at = system
        .coordinate(beam.end(), NodalVector::Position)
        .unwrap()
        + 1;
    let mut run = Integration::start(&system, state, &Midpoint::default()).unwrap();
    let height = |state: &State<f64>| state.displacement[at];
    let step = Stepping::Fixed(0.037);
    let ending = run.until_event(1.0, step, Crossing::Falling, height, |_| {});
    assert_eq!(ending, Ok(Ending::Event));
    assert!(
        (run.state().time - 0.6).abs() < 1e-12,
        "{}",
        run.state().time
    );
    assert!((run.state().velocity[at] + 3.0).abs() < 1e-11);
}

/// No force but a gap in which there is none to be known.
struct Gap;

impl Potential for Gap {
    fn force(&self, q: f64) -> f64 {
        match (0.72..0.74).contains(&q) {
            true => f64::NAN,
            false => 0.0,
        }
    }
    fn stiffness(&self, _: f64) -> f64 {
        0.0
    }
}

/// A free particle is at 0.9 m after 0.9 s; the secant of the cube looks for that at 0.729 s, where a
/// step fails that ends there. Halved and adaptive steps come by another way, fixed ones say so.
#[test]
fn a_step_that_fails_on_the_way_to_an_event_is_recovered() {
    let free = Particle::new(Gap);
    let beyond = |state: &State<f64>| state.displacement[0].powi(3) - 0.9_f64.powi(3);
    let run = |stepping| {
        let scheme = Newmark::trapezoidal();
        let mut run = Integration::start(&free, free.at(0.0, 1.0), &scheme)?;
        let ending = run.until_event(2.0, stepping, Crossing::Rising, beyond, |_| {})?;
        Ok((ending, run.state().displacement[0], run.report().failed))
    };
    let long = Adaptive {
        first: 1.0,
        longest: 1.0,
        ..Adaptive::to(1e-3)
    };
    let halved = Stepping::Halved {
        step: 1.0,
        halvings: 2,
    };
    for stepping in [halved, Stepping::Adaptive(long)] {
        let (ending, place, failed) = run(stepping).unwrap();
        assert!(ending == Ending::Event && failed == 1, "{failed} failed");
        assert!((place - 0.9).abs() < 1e-12, "{place}");
    }
    let refused: Result<(Ending, f64, usize)> = run(Stepping::Fixed(1.0));
    assert!(matches!(refused, Err(Error::StepFailed { .. })));
}
