//! The error of every integrator shrinks with the power of the step that theory gives it.

use std::f64::consts::PI;

use ancf::prelude::*;

use super::models::{Particle, Swing, soft};

/// A quarter of the period from 90 degrees: the complete elliptic integral K(sin 45 deg).
const QUARTER: f64 = 1.854_074_677_301_371_9;

/// Newton's method solved far below the errors of the steps.
fn exact() -> Newton {
    Newton {
        residual: 1e-12,
        correction: 1e-9,
        ..Newton::default()
    }
}

/// A claim for each scheme, with the steps on which it is to be seen.
trait Claim {
    fn check(&self, name: &str, scheme: &impl Scheme<f64>, order: f64, steps: usize);
}

fn every_scheme(claim: &impl Claim) {
    let newmark = |scheme: Newmark| scheme.with_newton(exact());
    let collocation = |scheme: Collocation| scheme.with_newton(exact());
    let midpoint = Midpoint { newton: exact() };
    let conserving = EnergyMomentum::conserving();
    claim.check("trapezoidal", &newmark(Newmark::trapezoidal()), 2.0, 64);
    claim.check("HHT", &newmark(Newmark::hht(0.2)), 2.0, 64);
    for radius in [0.0, 0.5, 1.0] {
        let scheme = newmark(Newmark::generalised_alpha(radius));
        claim.check("generalised alpha", &scheme, 2.0, 128);
    }
    claim.check("midpoint", &midpoint, 2.0, 64);
    claim.check("energy-momentum", &conserving, 2.0, 64);
    claim.check("central difference", &CentralDifference::default(), 2.0, 64);
    claim.check("Gauss 1", &collocation(Collocation::gauss(1)), 2.0, 64);
    claim.check("Gauss 2", &collocation(Collocation::gauss(2)), 4.0, 16);
    claim.check("Gauss 3", &collocation(Collocation::gauss(3)), 6.0, 10);
    claim.check("Radau 1", &collocation(Collocation::radau(1)), 1.0, 256);
    claim.check("Radau 2", &collocation(Collocation::radau(2)), 3.0, 24);
    claim.check("Radau 3", &collocation(Collocation::radau(3)), 5.0, 8);
}

/// The pendulum of one unknown after a quarter of its period, known exactly.
struct ByQuarter;

impl Claim for ByQuarter {
    fn check(&self, name: &str, scheme: &impl Scheme<f64>, order: f64, steps: usize) {
        let pendulum = Particle::new(Swing);
        let error = |steps: usize| {
            let start = pendulum.at(PI / 2.0, 0.0);
            let mut run = Integration::start(&pendulum, start, scheme).unwrap();
            let step = Stepping::Fixed(QUARTER / steps as f64);
            run.until(QUARTER, step, |_| {}).unwrap();
            run.state().displacement[0].abs()
        };
        let observed = (error(steps) / error(2 * steps)).log2();
        assert!((observed - order).abs() < 0.15, "{name}: order {observed}");
    }
}

#[test]
fn on_a_pendulum_of_one_unknown() {
    every_scheme(&ByQuarter);
}

/// A beam that all steps resolve, by the differences between three runs.
struct ByRichardson;

impl Claim for ByRichardson {
    fn check(&self, name: &str, scheme: &impl Scheme<f64>, order: f64, steps: usize) {
        let system = soft();
        let end = 0.2;
        let state = |steps: usize| {
            let mut run = Integration::start(&system, system.rest(), scheme).unwrap();
            let step = Stepping::Fixed(end / steps as f64);
            run.until(end, step, |_| {}).unwrap();
            run.into_state().displacement
        };
        let runs = [3, 6, 12].map(|share| state(share * steps));
        let distance = |a: &[f64], b: &[f64]| -> f64 {
            a.iter()
                .zip(b)
                .map(|(a, b)| (a - b) * (a - b))
                .sum::<f64>()
                .sqrt()
        };
        let ratio = distance(&runs[0], &runs[1]) / distance(&runs[1], &runs[2]);
        let observed = ratio.log2();
        assert!((observed - order).abs() < 0.3, "{name}: order {observed}");
    }
}

#[test]
fn on_a_beam() {
    every_scheme(&ByRichardson);
}

/// Viscosity takes energy at first order in the step, and so the order of the method; a retardation
/// time does not.
#[test]
fn viscosity_is_of_first_order_and_retardation_of_second() {
    let mut scheme = EnergyMomentum::dissipating(0.3).with_newton(exact());
    ByRichardson.check("viscous", &scheme, 1.0, 512);
    (scheme.viscosity, scheme.retardation) = (0.0, 1e-2);
    ByRichardson.check("Kelvin-Voigt", &scheme, 2.0, 64);
}

/// The auxiliary acceleration follows the step, or the order would be lost with every change.
#[test]
fn the_order_survives_changing_steps() {
    let pendulum = Particle::new(Swing);
    let scheme = Newmark::generalised_alpha(0.3).with_newton(exact());
    let error = |pairs: usize| {
        let start = pendulum.at(PI / 2.0, 0.0);
        let mut run = Integration::start(&pendulum, start, &scheme).unwrap();
        let unit = QUARTER / (4 * pairs) as f64;
        for _ in 0..pairs {
            run.step(unit).unwrap();
            run.step(3.0 * unit).unwrap();
        }
        run.state().displacement[0].abs()
    };
    let observed = (error(64) / error(128)).log2();
    assert!((observed - 2.0).abs() < 0.15, "order {observed}");
}

/// Inside a step the interpolation errs by a higher power of the step than the method: the fourth
/// with the cubic, the sixth with the quintic.
#[test]
fn observers_see_inside_a_step_at_the_order_of_the_method() {
    let pendulum = Particle::new(Swing);
    // The motion at any time, by many short steps.
    let truth = |time: f64| {
        let start = pendulum.at(PI / 2.0, 0.0);
        let scheme = Collocation::gauss(3).with_newton(exact());
        let mut run = Integration::start(&pendulum, start, &scheme).unwrap();
        run.until(time, Stepping::Fixed(0.01), |_| {}).unwrap();
        run.state().displacement[0]
    };
    let error = |stages: usize, step: f64| {
        let scheme = Collocation::gauss(stages).with_newton(exact());
        let start = pendulum.at(PI / 2.0, 0.0);
        let mut run = Integration::start(&pendulum, start, &scheme).unwrap();
        let mut inside = 0.0;
        // The middle of the last step.
        let time = 1.2 - 0.5 * step;
        run.until(1.2, Stepping::Fixed(step), |s| {
            if s.contains(time) {
                inside = s.displacement_at(time, 0).unwrap();
            }
        })
        .unwrap();
        (inside - truth(time)).abs()
    };
    for (stages, order) in [(2, 4.0), (3, 6.0)] {
        let observed = (error(stages, 0.2) / error(stages, 0.1)).log2();
        assert!(
            (observed - order).abs() < 0.5,
            "{stages} stages: {observed}"
        );
    }
}
