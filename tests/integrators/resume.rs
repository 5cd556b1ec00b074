//! A run that is stopped, saved and resumed, however often, is to the last bit the run that was not,
//! with every scheme, stepping and way to renew tangents; and a checkpoint is of one run only.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

use ancf::prelude::*;
use ancf::solver::Matrix;

use super::models::{Particle, Spring, Swing, pendulum, rubber, soft};

/// All bits of a state.
fn bits(state: &State<f64>) -> Vec<u64> {
    let vectors = [&state.displacement, &state.velocity, &state.acceleration];
    let numbers = vectors.into_iter().flatten();
    let numbers = numbers.chain([&state.time, &state.work]);
    numbers.map(|x| x.to_bits()).collect()
}

/// A checkpoint as it comes back from a file, where files can be written.
fn filed(checkpoint: Checkpoint<f64>) -> Checkpoint<f64> {
    #[cfg(feature = "serde")]
    let checkpoint = {
        let text = serde_json::to_string(&checkpoint).unwrap();
        let read: Checkpoint<f64> = serde_json::from_str(&text).unwrap();
        assert_eq!(read, checkpoint);
        read
    };
    checkpoint
}

/// Checks every state of a run to `end` against that of a run stopped every few steps, each time
/// resumed with a structure and a scheme built anew. Tells what the run took.
fn same<S: Structure<f64>>(
    build: impl Fn() -> (S, State<f64>),
    scheme: &impl Scheme<f64>,
    stepping: Stepping,
    end: f64,
) -> RunReport {
    let name = format!("{scheme:?} {stepping:?}");
    let (structure, rest) = build();
    let mut whole = Vec::new();
    let mut run = Integration::start(&structure, rest.clone(), scheme).unwrap();
    let ending = run.until(end, stepping, |step| whole.push(bits(step.after)));
    assert_eq!(ending, Ok(Ending::End), "{name}");

    let mut pieces = Vec::new();
    let mut kept = Integration::start(&structure, rest, scheme)
        .unwrap()
        .checkpoint()
        .unwrap();
    for every in [3, 1, 7, 4].into_iter().cycle() {
        let (structure, _) = build();
        let mut part = Integration::resume(&structure, &filed(kept), scheme).unwrap();
        let begun = part.report().steps;
        let ending = part.until(end, stepping, |step| {
            pieces.push(bits(step.after));
            match step.report.steps - begun {
                n if n == every => ControlFlow::Break(()),
                _ => ControlFlow::Continue(()),
            }
        });
        kept = part.checkpoint().unwrap();
        if ending.unwrap() == Ending::End {
            assert_eq!(part.report(), run.report(), "{name}");
            assert_eq!(bits(part.state()), bits(run.state()), "{name}");
            break;
        }
    }
    let parts = whole.iter().zip(&pieces).position(|(a, b)| a != b);
    assert_eq!(parts, None, "{name}: first other step");
    assert_eq!(whole.len(), pieces.len(), "{name}");
    assert!(whole.len() > 15, "{name}: {} steps", whole.len());
    run.report()
}

fn falling() -> (System<f64, 2>, State<f64>) {
    let system = soft();
    let rest = system.rest();
    (system, rest)
}

fn renewed(refresh: Refresh) -> Newton {
    Newton {
        refresh,
        ..Newton::default()
    }
}

const ALL: [Refresh; 4] = [
    Refresh::EveryIteration,
    Refresh::EverySolve,
    Refresh::WhenSlow,
    Refresh::Never,
];

/// Fixed steps that do not divide the time, in every scheme.
#[test]
fn fixed_steps_of_every_scheme() {
    let step = Stepping::Fixed(1.1e-3);
    for refresh in ALL {
        let newton = renewed(refresh);
        for scheme in [
            Newmark::trapezoidal(),
            Newmark::hht(0.1),
            Newmark::generalised_alpha(0.5),
        ] {
            same(falling, &scheme.with_newton(newton), step, 0.03);
        }
        same(falling, &Midpoint { newton }, step, 0.03);
        let conserving = EnergyMomentum::conserving().with_newton(newton);
        same(falling, &conserving, step, 0.03);
        for scheme in [Collocation::gauss(2), Collocation::radau(2)] {
            same(falling, &scheme.with_newton(newton), step, 0.03);
        }
    }
    same(falling, &EnergyMomentum::conserving(), step, 0.03);
    same(falling, &EnergyMomentum::kelvin_voigt(1e-3), step, 0.03);
    same(
        falling,
        &CentralDifference { renewal: 9 },
        Stepping::Fixed(2.1e-4),
        0.01,
    );
}

/// Kept tangents make the difference that the test above is about: with them restored, fewer are
/// made than steps.
#[test]
fn kept_tangents_are_kept() {
    let newton = renewed(Refresh::WhenSlow);
    let scheme = Newmark::trapezoidal().with_newton(newton);
    let report = same(falling, &scheme, Stepping::Fixed(1e-3), 0.05);
    assert!(2 * report.tangents < report.steps, "{report:?}");
    let scheme = scheme.with_newton(renewed(Refresh::Never));
    let report = same(falling, &scheme, Stepping::Fixed(1e-3), 0.05);
    assert_eq!(report.tangents, 1, "{report:?}");
}

#[test]
fn steps_under_error_control() {
    for control in [Adaptive::to(1e-6), Adaptive::smoothly_to(1e-6)] {
        let control = Stepping::Adaptive(control);
        for refresh in [Refresh::EveryIteration, Refresh::WhenSlow] {
            let newton = renewed(refresh);
            let scheme = Newmark::generalised_alpha(0.7).with_newton(newton);
            same(falling, &scheme, control, 0.05);
            let scheme = scheme.with_estimator(Estimator::ZienkiewiczXie);
            same(falling, &scheme, control, 0.05);
            same(falling, &Midpoint { newton }, control, 0.05);
            same(
                falling,
                &Collocation::radau(2).with_newton(newton),
                control,
                0.1,
            );
        }
        same(falling, &EnergyMomentum::conserving(), control, 0.05);
        same(falling, &CentralDifference { renewal: 7 }, control, 0.01);
    }
    let swing = || (Particle::new(Swing), Particle::new(Swing).at(3.0, 0.0));
    let control = Stepping::Adaptive(Adaptive::to(1e-5));
    let report = same(swing, &Newmark::trapezoidal(), control, 20.0);
    assert!(report.rejected > 0, "{report:?}");
}

/// What a step that was refused leaves behind goes on, too: here that its error was asked for, which the
/// estimate of the next takes for granted.
#[test]
fn a_run_that_failed_under_error_control() {
    let (system, rest) = falling();
    let scheme = Newmark::trapezoidal();
    let mut run = Integration::start(&system, rest, &scheme).unwrap();
    run.step(1e-3).unwrap();
    let hopeless = Adaptive {
        first: 1e-3,
        shortest: 1e-3,
        ..Adaptive::to(1e-14)
    };
    run.until(0.05, Stepping::Adaptive(hopeless), |_| {})
        .unwrap_err();
    let kept = filed(run.checkpoint().unwrap());
    let resumed = Integration::resume(&system, &kept, &scheme).unwrap();
    let ends = [run, resumed].map(|mut run| {
        run.step(1e-3).unwrap();
        let control = Stepping::Adaptive(Adaptive::to(1e-6));
        run.until(0.05, control, |_| {}).unwrap();
        (bits(run.state()), run.report())
    });
    assert_eq!(ends[0], ends[1]);
}

#[test]
fn steps_below_the_stability_limit() {
    let scheme = CentralDifference { renewal: 5 };
    same(falling, &scheme, Stepping::Stable(0.8), 0.2);
}

/// Also in the midst of a step that is made of halves of halves.
#[test]
fn halved_steps() {
    let rod = || {
        let (system, _) = pendulum(6);
        let rest = system.rest();
        (system, rest)
    };
    for refresh in [Refresh::EveryIteration, Refresh::WhenSlow] {
        let newton = Newton {
            iterations: 4,
            ..renewed(refresh)
        };
        let scheme = Newmark::trapezoidal().with_newton(newton);
        let stepping = Stepping::Halved {
            step: 0.03,
            halvings: 8,
        };
        let report = same(rod, &scheme, stepping, 0.5);
        assert!(report.failed > 2, "{report:?}");
    }
}

/// Multipliers, and a kept tangent of sparse blocks: a planar star, its hub pinned or tied.
#[test]
fn stars_and_constraints() {
    #[derive(Debug)]
    struct Tether;
    impl Constraint<f64, 2, 1, 1> for Tether {
        fn residual<T: Algebra<f64>>(&self, _time: T, [r]: &[[T; 2]; 1]) -> [T; 1] {
            let [x, y] = r.map(|x| x + T::one());
            [x * x + y * y - T::lit(2.0)]
        }
    }
    let star = |arms: usize, elements: usize, tied: bool| {
        let mut scene = Scene::<f64, 2>::new();
        let (disk, solid) = (Disk::new(0.02).unwrap(), Continuum::full(rubber(0.0)));
        let mut add = |arm: usize| {
            let (y, x) = (arm as f64 * std::f64::consts::TAU / arms as f64).sin_cos();
            let beam = Beam::new(FullyParameterised, disk, solid.clone());
            let beam = beam.straight([0.0; 2], [x, y], elements).density(1000.0);
            scene.add(beam).unwrap().start()
        };
        let ends: Vec<Node> = (0..arms).map(&mut add).collect();
        for end in &ends[1..] {
            scene.join(ends[0], *end, Joint::Rigid).unwrap();
        }
        if tied {
            let hub = [(ends[0], NodalVector::Position)];
            scene.bind(hub, Tether).unwrap();
        } else {
            scene.pin(ends[0]).unwrap();
        }
        scene.gravity([0.0, -9.81]).unwrap();
        let system = scene.assemble().unwrap();
        let rest = system.rest();
        (system, rest)
    };
    let scheme = Newmark::generalised_alpha(0.5).with_newton(renewed(Refresh::WhenSlow));
    let (large, _) = star(7, 30, false);
    let matrix = Matrix::<f64>::zero(large.unknowns(), true);
    assert!(matrix.stored().is_sparse());
    same(|| star(7, 30, false), &scheme, Stepping::Fixed(1e-3), 0.02);
    same(|| star(3, 2, true), &scheme, Stepping::Fixed(1e-3), 0.02);
}

/// Runs in pieces that end at whole steps are the run in one piece.
#[test]
fn pieces_of_equal_steps() {
    let spring = Particle::new(Spring(5.0));
    let run = |ends: &[f64]| {
        let start = spring.at(1.0, 0.0);
        let mut run = Integration::start(&spring, start, &Newmark::trapezoidal()).unwrap();
        for end in ends {
            run.until(*end, Stepping::Fixed(0.1), |_| {}).unwrap();
        }
        bits(run.state())
    };
    let once = run(&[7.0]);
    assert_eq!(run(&[0.3, 0.7, 4.9, 7.0]), once);
    assert_eq!(f64::from_bits(once[3]), 7.0);
}

/// A flag that is raised from outside stops the run after the step under way, and the run says so.
#[test]
fn a_flag_stops_a_run() {
    let system = soft();
    let (scheme, stepping) = (Newmark::trapezoidal(), Stepping::Fixed(1e-3));
    let mut run = Integration::start(&system, system.rest(), &scheme).unwrap();
    let flag = AtomicBool::new(false);
    let observe = |step: Step<'_, f64>| {
        // As if by a signal, while this step is made.
        flag.fetch_or(step.report.steps == 12, Ordering::Relaxed);
        match flag.load(Ordering::Relaxed) {
            true => Ok(ControlFlow::Break(())),
            false => Ok(ControlFlow::Continue(())),
        }
    };
    assert_eq!(run.until(0.1, stepping, observe), Ok(Ending::Stopped));
    assert_eq!((run.state().time, run.report().steps), (0.012, 12));
    flag.store(false, Ordering::Relaxed);
    assert_eq!(run.until(0.1, stepping, |_| {}), Ok(Ending::End));
    assert_eq!(run.state().time, 0.1);
}

/// What differs is named, and a checkpoint is not changed by a refusal.
#[test]
fn a_checkpoint_is_of_one_run() {
    let (system, _) = pendulum(4);
    let scheme = Newmark::trapezoidal();
    let mut run = Integration::start(&system, system.rest(), &scheme).unwrap();
    run.until(0.1, Stepping::Fixed(0.01), |_| {}).unwrap();
    let kept = run.checkpoint().unwrap();
    let refusal = |system: &System<f64, 2>, scheme: &Newmark| {
        let resumed = Integration::resume(system, &kept, scheme).map(|_| ());
        resumed.unwrap_err()
    };
    let text = refusal(&system, &Newmark::hht(0.1)).to_string();
    assert!(
        text.contains("another scheme") && text.contains("alpha_f: 0.1"),
        "{text}"
    );
    let other = Integration::resume(&system, &kept, &Midpoint::default()).map(|_| ());
    assert!(matches!(
        other,
        Err(Error::ForeignCheckpoint { what: "scheme", .. })
    ));
    let (longer, _) = pendulum(5);
    assert!(matches!(
        refusal(&longer, &scheme),
        Error::Length {
            given: 30,
            needed: 36,
            ..
        }
    ));
    // Of the same size, but of another stiffness, mass or load.
    let like = |young: f64, density: f64, gravity: f64| {
        let mut scene = Scene::<f64, 2>::new();
        let solid = SaintVenantKirchhoff::isotropic(young, 0.0).unwrap();
        let disk = Disk::new(0.01).unwrap();
        let beam = Beam::new(FullyParameterised, disk, Continuum::full(solid));
        let beam = beam.straight([0.0; 2], [1.0, 0.0], 4).density(density);
        let beam = scene.add(beam).unwrap();
        scene.pin(beam.start()).unwrap();
        scene.gravity([0.0, -gravity]).unwrap();
        scene.assemble().unwrap()
    };
    for (system, named) in [
        (like(2.1e7, 7200.0, 9.81), "internal forces"),
        (like(2e7, 7100.0, 9.81), "external forces"),
        (like(2e7, 7100.0, 9.81 * 7200.0 / 7100.0), "mass"),
        (like(2e7, 7200.0, 9.80665), "external forces"),
    ] {
        let text = refusal(&system, &scheme).to_string();
        assert!(text.contains(named), "{text}");
    }
    let twin = like(2e7, 7200.0, 9.81);
    let twin = Integration::resume(&twin, &kept, &scheme).unwrap();
    assert_eq!(bits(twin.state()), bits(run.state()));
}

#[cfg(feature = "serde")]
mod files {
    use super::*;
    use num_dual::Dual;
    use serde_json::Value;

    /// Damaged numbers and missing ones are refused, and never make a run.
    #[test]
    fn damage_is_refused() {
        let system = soft();
        let newton = renewed(Refresh::WhenSlow);
        let scheme = Newmark::trapezoidal().with_newton(newton);
        let mut run = Integration::start(&system, system.rest(), &scheme).unwrap();
        run.until(0.01, Stepping::Fixed(1e-3), |_| {}).unwrap();
        let kept = serde_json::to_value(run.checkpoint().unwrap()).unwrap();
        let damaged = |path: &str, change: &dyn Fn(&mut Value)| {
            let mut value = kept.clone();
            change(value.pointer_mut(path).unwrap());
            let checkpoint: Checkpoint<f64> = match serde_json::from_value(value) {
                Ok(checkpoint) => checkpoint,
                Err(error) => return error.to_string(),
            };
            let resumed = Integration::resume(&system, &checkpoint, &scheme);
            resumed.map(|_| ()).unwrap_err().to_string()
        };
        let pop = |value: &mut Value| drop(value.as_array_mut().unwrap().pop());
        let push = |value: &mut Value| value.as_array_mut().unwrap().push(1.into());
        for (path, change, named) in [
            // What a format without NaN makes of one.
            (
                "/state/velocity/3",
                &(|v: &mut Value| *v = Value::Null) as &dyn Fn(&mut Value),
                "null",
            ),
            (
                "/state/displacement/9",
                &|v| *v = 1e300.into(),
                "force of the system",
            ),
            (
                "/state/displacement/9",
                &|v| *v = 0.2.into(),
                "internal forces",
            ),
            ("/state/acceleration", &pop, "accelerations"),
            (
                "/progress/error",
                &|v| *v = (-1.0).into(),
                "error of the last step",
            ),
            ("/history/numbers", &pop, "history"),
            ("/history/numbers", &push, "history"),
            ("/history/counts/0", &|v| *v = 7.into(), "history"),
            ("/version", &|v| *v = "0.0.1".into(), "0.0.1"),
            ("/number", &|v| *v = "f32".into(), "f32"),
        ] {
            let text = damaged(path, change);
            assert!(text.contains(named), "{path}: {text}");
        }
    }

    /// Single precision and dual numbers, with their derivatives, come back from a file as they were.
    #[test]
    fn other_number_types() {
        fn check<R: Real + serde::Serialize + serde::de::DeserializeOwned>(young: R) -> State<R> {
            let mut scene = Scene::<R, 2>::new();
            let solid = SaintVenantKirchhoff::isotropic(young, R::zero()).unwrap();
            let disk = Disk::new(R::lit(0.05)).unwrap();
            let beam = Beam::new(FullyParameterised, disk, Continuum::full(solid));
            let [zero, half] = [0.0, 0.5].map(R::lit);
            let beam = beam.straight([zero; 2], [half, zero], 2);
            let beam = scene.add(beam.density(R::lit(1000.0))).unwrap();
            scene.clamp(beam.start()).unwrap();
            scene.gravity([zero, R::lit(-9.81)]).unwrap();
            let system = scene.assemble().unwrap();
            let stepping = Stepping::Adaptive(Adaptive::to(1e-4));
            let scheme = Newmark::trapezoidal();
            let mut run = Integration::start(&system, system.rest(), &scheme).unwrap();
            run.until(R::lit(0.01), stepping, |_| {}).unwrap();
            let text = serde_json::to_string(&run.checkpoint().unwrap()).unwrap();
            run.until(R::lit(0.02), stepping, |_| {}).unwrap();
            let kept: Checkpoint<R> = serde_json::from_str(&text).unwrap();
            let mut again = Integration::resume(&system, &kept, &scheme).unwrap();
            again.until(R::lit(0.02), stepping, |_| {}).unwrap();
            // `Debug` shows derivatives, which comparisons of dual numbers leave out.
            assert_eq!(format!("{:?}", again.state()), format!("{:?}", run.state()));
            run.into_state()
        }
        check(2e4_f32);
        let state = check(Dual::from_re(2e4).derivative());
        assert!(state.displacement.iter().any(|u| u.eps != 0.0));
        #[cfg(feature = "double-double")]
        check(ancf::scalar::DoubleDouble::lit(2e4));
    }
}
