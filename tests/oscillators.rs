//! Claims about time steps on structures of one unknown: orders of accuracy, error estimates and their
//! control, runs that stop and go on.

use ancf::prelude::*;
use ancf::solver::{Matrix, Profile, Unknowns};
use std::cell::Cell;
use std::f64::consts::PI;

/// A mathematical pendulum as a structure of one unknown: `theta'' + sin theta = 0`.
struct Pendulum {
    unknowns: Unknowns<f64>,
}

impl Pendulum {
    fn new() -> Self {
        let unknowns = Unknowns::all(Profile::from_ranges(1, [0..1]).unwrap());
        Self { unknowns }
    }

    fn at(&self, angle: f64) -> State<f64> {
        State {
            time: 0.0,
            displacement: vec![angle],
            velocity: vec![0.0],
            acceleration: vec![0.0],
            work: 0.0,
        }
    }
}

impl Structure<f64> for Pendulum {
    fn unknowns(&self) -> &Unknowns<f64> {
        &self.unknowns
    }
    fn symmetric(&self) -> bool {
        true
    }
    fn measure(&self) -> &[f64] {
        &[1.0]
    }
    fn add_internal(&self, u: &[f64], q: &mut [f64]) {
        q[0] += u[0].sin();
    }
    fn add_tangent(&self, _: f64, _: f64, u: &[f64], k: &mut Matrix<f64>) -> Result<()> {
        k.add(0, 0, u[0].cos())
    }
    fn has_mass(&self) -> bool {
        true
    }
    fn add_mass_times(&self, factor: f64, a: &[f64], out: &mut [f64]) {
        out[0] += factor * a[0];
    }
    fn add_mass(&self, factor: f64, k: &mut Matrix<f64>) -> Result<()> {
        k.add(0, 0, factor)
    }
}

/// A quarter of the period from 90 degrees: the complete elliptic integral K(sin 45 deg).
const QUARTER: f64 = 1.854_074_677_301_371_9;

#[test]
fn the_trapezoidal_rule_is_of_second_order() {
    let pendulum = Pendulum::new();
    let errors = [50.0, 100.0, 200.0].map(|steps| {
        let method = Newmark::trapezoidal();
        let mut run = Integration::start(&pendulum, pendulum.at(PI / 2.0), &method).unwrap();
        run.until(QUARTER, Stepping::Fixed(QUARTER / steps), |_| {})
            .unwrap();
        assert_eq!(run.report().steps, steps as usize);
        run.state().displacement[0].abs()
    });
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 2.0).abs() < 0.02, "order {order}");
    }
}

#[test]
fn more_damping_costs_an_order() {
    let pendulum = Pendulum::new();
    let errors = [100.0, 200.0].map(|steps| {
        let mut method = Newmark::trapezoidal();
        (method.beta, method.gamma) = (0.3025, 0.6);
        let mut run = Integration::start(&pendulum, pendulum.at(PI / 2.0), &method).unwrap();
        run.until(QUARTER, Stepping::Fixed(QUARTER / steps), |_| {})
            .unwrap();
        run.state().displacement[0].abs()
    });
    let order = (errors[0] / errors[1]).log2();
    assert!((order - 1.0).abs() < 0.1, "order {order}");
}

/// The error at the end falls with the tolerance as `tolerance^(2/3)` must, for both estimators.
#[test]
fn the_adaptive_step_delivers_what_the_tolerance_asks() {
    let pendulum = Pendulum::new();
    for estimator in [Estimator::LiZengWiberg, Estimator::ZienkiewiczXie] {
        let errors = [1e-5, 1e-8].map(|tolerance| {
            let method = Newmark::trapezoidal().with_estimator(estimator);
            let mut run = Integration::start(&pendulum, pendulum.at(PI / 2.0), &method).unwrap();
            let control = Stepping::Adaptive(Adaptive::to(tolerance));
            run.until(QUARTER, control, |_| {}).unwrap();
            assert_eq!(run.state().time, QUARTER);
            run.state().displacement[0].abs()
        });
        let ratio = errors[0] / errors[1];
        assert!((30.0..300.0).contains(&ratio), "{estimator:?}: {errors:?}");
    }
}

/// `u = t^5` as a motion: the acceleration `20 t^3` is prescribed by the load, so that the third
/// and fourth derivatives, and with them the local error of a step, are known.
struct Quintic {
    unknowns: Unknowns<f64>,
}

impl Structure<f64> for Quintic {
    fn unknowns(&self) -> &Unknowns<f64> {
        &self.unknowns
    }
    fn symmetric(&self) -> bool {
        true
    }
    fn measure(&self) -> &[f64] {
        &[1.0]
    }
    fn add_internal(&self, _: &[f64], _: &mut [f64]) {}
    fn add_external(&self, t: f64, factor: f64, _: &[f64], q: &mut [f64]) -> Result<()> {
        q[0] += factor * 20.0 * t.powi(3);
        Ok(())
    }
    fn add_tangent(&self, _: f64, _: f64, _: &[f64], _: &mut Matrix<f64>) -> Result<()> {
        Ok(())
    }
    fn has_mass(&self) -> bool {
        true
    }
    fn add_mass_times(&self, factor: f64, a: &[f64], out: &mut [f64]) {
        out[0] += factor * a[0];
    }
    fn add_mass(&self, factor: f64, k: &mut Matrix<f64>) -> Result<()> {
        k.add(0, 0, factor)
    }
}

/// Both estimators against the true local error of a step, after a step of another length. Li,
/// Zeng and Wiberg's is right to the next order, at any ratio of the steps; Zienkiewicz and Xie's
/// to the first.
#[test]
fn the_error_estimators_estimate_the_local_error() {
    let unknowns = Unknowns::all(Profile::from_ranges(1, [0..1]).unwrap());
    let structure = Quintic { unknowns };
    let exact = |t: f64| State {
        time: t,
        displacement: vec![t.powi(5)],
        velocity: vec![5.0 * t.powi(4)],
        acceleration: vec![20.0 * t.powi(3)],
        work: 0.0,
    };
    // Error of the estimate relative to the true local error of the second of two steps.
    let relative = |estimator, first: f64, second: f64| {
        let scheme = Newmark::trapezoidal().with_estimator(estimator);
        let mut start = exact(1.0);
        let mut method = scheme.start(&structure, &mut start).unwrap();
        let mut middle = start.clone();
        method
            .advance(&structure, &start, &mut middle, first)
            .unwrap();
        // Asked for at every step, as control does: what an estimate takes of the step before is kept then.
        let (estimate, _) = method.error(&structure, &start, &middle);
        assert!(estimate > 0.0);
        method.accept(&start, &middle);
        // From the exact state, so that the step's own error is seen.
        let middle = exact(1.0 + first);
        let mut end = middle.clone();
        method
            .advance(&structure, &middle, &mut end, second)
            .unwrap();
        let truth = (end.displacement[0] - exact(1.0 + first + second).displacement[0]).abs();
        let (estimate, size) = method.error(&structure, &middle, &end);
        assert_eq!(size, end.displacement[0]);
        estimate / truth - 1.0
    };
    for (first, second) in [(1.0, 1.0), (1.0, 2.0), (2.0, 1.0)] {
        for (estimator, order) in [
            (Estimator::LiZengWiberg, 2.0),
            (Estimator::ZienkiewiczXie, 1.0),
        ] {
            let coarse = relative(estimator, 4e-2 * first, 4e-2 * second);
            let fine = relative(estimator, 2e-2 * first, 2e-2 * second);
            let observed = (coarse / fine).abs().log2();
            assert!(
                (observed - order).abs() < 0.3,
                "{estimator:?} {first}:{second}: order {observed}"
            );
        }
    }
}

/// Halving the tolerance shortens the steps by its cube root: the order the control assumes.
#[test]
fn steps_shrink_with_the_cube_root_of_the_tolerance() {
    let pendulum = Pendulum::new();
    let steps = [1e-6, 1e-9].map(|tolerance| {
        let method = Newmark::trapezoidal();
        let mut run = Integration::start(&pendulum, pendulum.at(PI / 2.0), &method).unwrap();
        let control = Stepping::Adaptive(Adaptive::to(tolerance));
        run.until(4.0 * QUARTER, control, |_| {}).unwrap();
        let report = run.report();
        assert!(report.rejected < report.steps / 10, "{report:?}");
        report.steps as f64
    });
    let ratio = steps[1] / steps[0];
    assert!((ratio - 10.0).abs() < 1.5, "{ratio}");
}

/// A small vibration is resolved like a large one: the error is relative to the motion.
#[test]
fn small_and_large_motions_take_the_same_steps() {
    let pendulum = Pendulum::new();
    let steps = [1e-1, 1e-4].map(|amplitude| {
        let method = Newmark::trapezoidal();
        let mut run = Integration::start(&pendulum, pendulum.at(amplitude), &method).unwrap();
        let control = Stepping::Adaptive(Adaptive::to(1e-5));
        run.until(4.0 * QUARTER, control, |_| {}).unwrap();
        run.report().steps as f64
    });
    assert!((steps[0] / steps[1] - 1.0).abs() < 0.05, "{steps:?}");
}

/// Many short runs are one long run: ends below the shortest step are reached all the same.
#[test]
fn a_run_may_stop_at_any_time() {
    let pendulum = Pendulum::new();
    let control = Adaptive {
        shortest: 1e-3,
        ..Adaptive::to(1e-6)
    };
    let method = Newmark::trapezoidal();
    let mut run = Integration::start(&pendulum, pendulum.at(PI / 2.0), &method).unwrap();
    let mut end = 0.0;
    while end < QUARTER {
        end = (end + 0.9e-3_f64).min(QUARTER);
        run.until(end, Stepping::Adaptive(control), |_| {}).unwrap();
        assert_eq!(run.state().time, end);
    }
    assert!(run.state().displacement[0].abs() < 1e-5);
    // Fixed steps are seen end to end, without gaps.
    let mut run = Integration::start(&pendulum, pendulum.at(1.0), &method).unwrap();
    let mut last = 0.0;
    run.until(0.333, Stepping::Fixed(1e-3), |step| {
        assert_eq!(step.before.time, last);
        last = step.after.time;
    })
    .unwrap();
    assert_eq!(last, 0.333);
}

/// An observer's error ends the run and is handed on.
#[test]
fn an_observer_may_end_the_run() {
    let pendulum = Pendulum::new();
    let method = Newmark::trapezoidal();
    let mut run = Integration::start(&pendulum, pendulum.at(1.0), &method).unwrap();
    let result = run.until(1.0, Stepping::Fixed(0.01), |step| {
        match step.after.time > 0.5 {
            true => Err(Error::EmptyScene),
            false => Ok(()),
        }
    });
    assert_eq!(result, Err(Error::EmptyScene));
    assert!((run.state().time - 0.51).abs() < 1e-9);
}

/// Single precision follows double at a small step.
#[test]
fn single_precision_swings_like_double() {
    fn tip<R: Real>(step: f64) -> f64 {
        let mut scene = Scene::<R, 2>::new();
        let disk = Disk::new(R::lit(0.01)).unwrap();
        let solid = SaintVenantKirchhoff::isotropic(R::lit(2e7), R::zero()).unwrap();
        let beam = Beam::new(FullyParameterised, disk, Continuum::full(solid))
            .straight([R::zero(); 2], [R::one(), R::zero()], 6)
            .density(R::lit(7200.0));
        let beam = scene.add(beam).unwrap();
        scene.pin(beam.start()).unwrap();
        scene.gravity([R::zero(), R::lit(-9.81)]).unwrap();
        let system = scene.assemble().unwrap();
        let mut run = Integration::start(&system, system.rest(), &Newmark::trapezoidal()).unwrap();
        run.until(R::lit(0.3), Stepping::Fixed(step), |_| {})
            .unwrap();
        system.position(run.state(), beam.end()).unwrap()[1].value()
    }
    for step in [1e-3, 1e-4] {
        let (single, double) = (tip::<f32>(step), tip::<f64>(step));
        assert!(
            (single - double).abs() < 2e-3,
            "{step}: {single} not {double}"
        );
    }
}

/// The interpolation shown to observers agrees with the ends of the step and is smooth inside.
#[test]
fn observers_can_look_inside_a_step() {
    let pendulum = Pendulum::new();
    let method = Newmark::trapezoidal();
    let mut run = Integration::start(&pendulum, pendulum.at(PI / 2.0), &method).unwrap();
    let mut quarter = None;
    run.until(2.0, Stepping::Fixed(0.01), |s| {
        assert_eq!(
            s.displacement_at(s.before.time, 0).unwrap(),
            s.before.displacement[0]
        );
        assert!(
            (s.displacement_at(s.after.time, 0).unwrap() - s.after.displacement[0]).abs() < 1e-15
        );
        if s.contains(QUARTER) {
            quarter = Some(s.displacement_at(QUARTER, 0).unwrap());
        }
    })
    .unwrap();
    assert!(quarter.unwrap().abs() < 1e-4, "{quarter:?}");
}

/// A mass of 1 kg on a spring of 1 N/m, in any number type, that counts how often its load is asked for.
struct Loaded<R> {
    unknowns: Unknowns<R>,
    measure: Vec<R>,
    load: fn(R) -> R,
    steady: bool,
    asked: Cell<usize>,
    /// A force that grows with the third power of the displacement (N/m^3).
    cubic: R,
    /// What all forces and the mass are multiplied by.
    scale: Cell<R>,
}

impl<R: Real> Loaded<R> {
    fn new(load: fn(R) -> R, steady: bool) -> Self {
        Self {
            unknowns: Unknowns::all(Profile::from_ranges(1, [0..1]).unwrap()),
            measure: vec![R::one()],
            load,
            steady,
            asked: Cell::new(0),
            cubic: R::zero(),
            scale: Cell::new(R::one()),
        }
    }

    fn rest(&self) -> State<R> {
        let rest = || vec![R::zero()];
        State {
            time: R::zero(),
            displacement: rest(),
            velocity: rest(),
            acceleration: rest(),
            work: R::zero(),
        }
    }
}

impl<R: Real> Structure<R> for Loaded<R> {
    fn unknowns(&self) -> &Unknowns<R> {
        &self.unknowns
    }
    fn symmetric(&self) -> bool {
        true
    }
    fn measure(&self) -> &[R] {
        &self.measure
    }
    fn add_internal(&self, u: &[R], q: &mut [R]) {
        q[0] += self.scale.get() * (u[0] + self.cubic * u[0] * u[0] * u[0]);
    }
    fn has_following(&self) -> bool {
        false
    }
    fn is_steady(&self) -> bool {
        self.steady
    }
    fn add_external(&self, time: R, factor: R, _: &[R], q: &mut [R]) -> Result<()> {
        self.asked.set(self.asked.get() + 1);
        q[0] += self.scale.get() * factor * (self.load)(time);
        Ok(())
    }
    fn has_applied(&self) -> bool {
        true
    }
    fn add_applied(&self, time: R, factor: R, _: &[R], q: &mut [R]) -> Result<()> {
        q[0] += self.scale.get() * factor * (self.load)(time);
        Ok(())
    }
    fn add_tangent(&self, _: R, _: R, u: &[R], k: &mut Matrix<R>) -> Result<()> {
        let slope = R::one() + R::lit(3.0) * self.cubic * u[0] * u[0];
        k.add(0, 0, self.scale.get() * slope)
    }
    fn has_mass(&self) -> bool {
        true
    }
    fn add_mass_times(&self, factor: R, a: &[R], out: &mut [R]) {
        out[0] += self.scale.get() * factor * a[0];
    }
    fn add_mass(&self, factor: R, k: &mut Matrix<R>) -> Result<()> {
        k.add(0, 0, self.scale.get() * factor)
    }
}

/// Displacement after 20 steps of 0.1 s from rest, and how often the load was asked for.
fn loaded<R: Real>(load: fn(R) -> R, steady: bool) -> (R, usize) {
    let structure = Loaded::new(load, steady);
    let method = Newmark::trapezoidal();
    let mut run = Integration::start(&structure, structure.rest(), &method).unwrap();
    for _ in 0..20 {
        run.step(R::lit(0.1)).unwrap();
    }
    (run.state().displacement[0], structure.asked.get())
}

/// Loads that are said to be the same at all times are formed once, others step by step; the motion is
/// the same to the last bit.
#[test]
fn steady_loads_are_formed_once() {
    let (moved, asked) = loaded(|_| 2.0, true);
    let (other, each_step) = loaded(|_| 2.0, false);
    assert_eq!(moved, other);
    assert_eq!(asked, 1);
    assert!(each_step >= 20);
    assert!((moved - 2.0 * (1.0 - 2.0_f64.cos())).abs() < 1e-2);
}

/// Forces are measured by one of about their size from step to step, and by another where they leap or
/// fall: their squares by the old one are no numbers of single precision. A motion in which all forces
/// change by one factor stays what it was.
#[test]
fn forces_may_leap_and_fall_by_thirty_orders_of_magnitude() {
    let swing = |scale: fn(usize) -> f32| {
        let structure = Loaded {
            cubic: 1.0,
            ..Loaded::<f32>::new(|_| 2.0, false)
        };
        let method = Newmark::trapezoidal();
        structure.scale.set(scale(0));
        let mut run = Integration::start(&structure, structure.rest(), &method).unwrap();
        for n in 0..12 {
            structure.scale.set(scale(n));
            run.step(0.7).unwrap();
        }
        (run.state().displacement[0], run.report().iterations)
    };
    let (plain, iterations) = swing(|_| 1.0);
    assert!(plain.abs() > 0.1 && iterations > 24);
    for scale in [
        |n| {
            if n < 6 {
                2_f32.powi(-50)
            } else {
                2_f32.powi(50)
            }
        },
        |n| {
            if n < 6 {
                2_f32.powi(50)
            } else {
                2_f32.powi(-50)
            }
        },
    ] {
        assert_eq!(swing(scale), (plain, iterations));
    }
}
