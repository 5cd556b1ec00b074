//! Settings and structures that an integrator cannot serve are refused by name, with the remedy, and
//! the state is kept.

use ancf::prelude::*;

use super::models::{Particle, Potential, Spring, pendulum, soft};

fn refusal(scheme: &impl Scheme<f64>) -> String {
    let system = soft();
    Integration::start(&system, system.rest(), scheme)
        .map(|_| ())
        .unwrap_err()
        .to_string()
}

#[test]
fn parameters_out_of_range() {
    for radius in [-0.1, 1.1, f64::NAN] {
        let text = refusal(&Newmark::generalised_alpha(radius));
        assert!(text.contains("generalised_alpha with 0 to 1"), "{text}");
    }
    // By the number given, not by those it was turned into.
    let text = refusal(&Newmark::generalised_alpha(1.5));
    assert!(
        text.contains("spectral radius") && text.contains("1.5"),
        "{text}"
    );
    for alpha in [-0.1, 0.6, f64::NAN] {
        assert!(
            refusal(&Newmark::hht(alpha)).contains("Newmark::hht"),
            "{alpha}"
        );
    }
    for bad in [-0.1, f64::NAN, f64::INFINITY] {
        assert!(refusal(&EnergyMomentum::dissipating(bad)).contains("viscosity"));
        assert!(refusal(&EnergyMomentum::kelvin_voigt(bad)).contains("retardation"));
    }
    for stages in [0, 9] {
        assert!(refusal(&Collocation::radau(stages)).contains("stages"));
    }
    assert!(refusal(&CentralDifference { renewal: 0 }).contains("frequency"));
    let newton = Newton {
        iterations: 0,
        ..Newton::default()
    };
    assert!(refusal(&Midpoint { newton }).contains("iteration"));
    assert!(refusal(&Collocation::gauss(2).with_newton(newton)).contains("iteration"));
    assert!(refusal(&EnergyMomentum::conserving().with_newton(newton)).contains("iteration"));
}

#[test]
fn stepping_out_of_range() {
    let (system, _) = pendulum(2);
    let mut run = Integration::start(&system, system.rest(), &Newmark::trapezoidal()).unwrap();
    let mut smooth = Adaptive::smoothly_to(1e-4);
    smooth.gains[1] = -1.0;
    let mut idle = Adaptive::smoothly_to(1e-4);
    idle.gains[0] = 0.0;
    for (stepping, named) in [
        (
            Stepping::Halved {
                step: 0.0,
                halvings: 2,
            },
            "time step",
        ),
        (Stepping::Stable(-1.0), "share of the longest stable step"),
        (Stepping::Stable(0.9), "stable at any step"),
        (Stepping::Adaptive(smooth), "proportional gain"),
        (Stepping::Adaptive(idle), "integral gain"),
    ] {
        let text = run.until(1.0, stepping, |_| {}).unwrap_err().to_string();
        assert!(text.contains(named), "{text}");
        assert_eq!(run.state().time, 0.0);
    }
    let text = run
        .until_event(
            1.0,
            Stepping::Fixed(1e-3),
            Crossing::Any,
            |_| f64::NAN,
            |_| {},
        )
        .unwrap_err()
        .to_string();
    assert!(text.contains("event is NaN"), "{text}");
    assert_eq!(run.state().time, 0.0);
}

/// A potential without a secant.
struct Bare;

impl Potential for Bare {
    fn force(&self, q: f64) -> f64 {
        q
    }
    fn stiffness(&self, _: f64) -> f64 {
        1.0
    }
}

/// Structures say what they have; the method says what it needs.
#[test]
fn what_a_structure_lacks_is_named() {
    let bare = Particle::new(Bare);
    let scheme = EnergyMomentum::conserving();
    let text = Integration::start(&bare, bare.at(1.0, 0.0), &scheme)
        .map(|_| ())
        .unwrap_err()
        .to_string();
    assert!(text.contains("secant"), "{text}");
    let spring = Particle::new(Spring(1.0));
    let scheme = EnergyMomentum::dissipating(0.1);
    let text = Integration::start(&spring, spring.at(1.0, 0.0), &scheme)
        .map(|_| ())
        .unwrap_err()
        .to_string();
    assert!(text.contains("has no strain"), "{text}");
}

/// A load that breaks stops every method with the last good state.
#[test]
fn loads_that_break_are_named() {
    fn check(scheme: &impl Scheme<f64>, stepping: Stepping) {
        let mut scene = Scene::<f64, 2>::new();
        let disk = Disk::new(0.01).unwrap();
        let solid = Continuum::full(super::models::rubber(0.0));
        let beam = Beam::new(FullyParameterised, disk, solid);
        let beam = scene
            .add(beam.straight([0.0; 2], [1.0, 0.0], 2).density(7200.0))
            .unwrap();
        scene.clamp(beam.start()).unwrap();
        let course = |t: f64| if t > 0.02 { f64::NAN } else { 1.0 };
        scene.force_in_time(beam.end(), [0.0, 1.0], course).unwrap();
        let system = scene.assemble().unwrap();
        let mut run = Integration::start(&system, system.rest(), scheme).unwrap();
        let text = run.until(1.0, stepping, |_| {}).unwrap_err().to_string();
        assert!(text.contains("load"), "{text}");
        assert!(run.state().time > 0.0 && run.state().time <= 0.02 + 1e-9);
        assert!(run.state().displacement.iter().all(|u| u.is_finite()));
    }
    let halved = Stepping::Halved {
        step: 1e-3,
        halvings: 3,
    };
    check(&Newmark::generalised_alpha(0.8), halved);
    check(&Midpoint::default(), halved);
    check(&EnergyMomentum::conserving(), halved);
    check(&Collocation::radau(2), halved);
    check(&CentralDifference::default(), Stepping::Stable(0.9));
}
