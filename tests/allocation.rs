//! A time step and a Newton iteration allocate nothing: counted, not promised. One test only in
//! this file, so that no other thread allocates meanwhile.

use std::alloc::System as SystemAllocator;

use ancf::prelude::*;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

#[global_allocator]
static COUNTED: &StatsAlloc<SystemAllocator> = &INSTRUMENTED_SYSTEM;

fn allocations(mut work: impl FnMut()) -> usize {
    let region = Region::new(COUNTED);
    work();
    let change = region.change();
    change.allocations + change.reallocations
}

#[test]
fn a_step_allocates_nothing() {
    // Whatever started this test may still be allocating beside it.
    std::thread::sleep(std::time::Duration::from_millis(500));
    assert!(allocations(|| drop(vec![1.0; 8])) > 0, "the counter counts");

    let rubber = SaintVenantKirchhoff::isotropic(2.0e7, 0.3).unwrap();
    let disk = Disk::new(0.01).unwrap();
    let formulation = CoMoving(Continuum::selective_reduced(rubber));
    let build = |moment: bool| {
        let mut scene = Scene::<f64, 3>::new();
        let beam = Beam::new(FullyParameterised, disk, formulation.clone())
            .straight([0.0; 3], [1.0, 0.0, 0.0], 10)
            .density(7200.0);
        let beam = scene.add(beam).unwrap();
        scene.pin(beam.start()).unwrap();
        scene.gravity([0.0, -9.81, 0.0]).unwrap();
        if moment {
            // A follower moment: unsymmetric tangents, factorised with pivoting.
            let moment = Moment::new([0.0, 0.0, 0.1], MomentLaw::MeanRotation);
            scene.moment_in_time(beam.end(), moment, f64::sin).unwrap();
        }
        scene.assemble().unwrap()
    };
    // A rigid body on a beam, tied to the origin: multipliers and projections.
    #[derive(Debug)]
    struct Tether;
    impl Constraint<f64, 3, 1, 1> for Tether {
        fn residual<T: Algebra<f64>>(&self, _time: T, [r]: &[[T; 3]; 1]) -> [T; 1] {
            [(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]).sqrt() - T::one()]
        }
    }
    let system = {
        let mut scene = Scene::<f64, 3>::new();
        let beam = Beam::new(FullyParameterised, disk, formulation.clone())
            .straight([0.0; 3], [1.0, 0.0, 0.0], 4)
            .density(7200.0);
        let beam = scene.add(beam).unwrap();
        scene.pin(beam.start()).unwrap();
        let unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let body = RigidBody::new(1.0, unit).at([1.0, 0.0, 0.0]);
        let body = scene.add_body(body).unwrap();
        scene.join(beam.end(), body.start(), Joint::Rigid).unwrap();
        let vectors = [(body.start(), NodalVector::Position)];
        scene.bind(vectors, Tether).unwrap();
        scene.gravity([0.0, -9.81, 0.0]).unwrap();
        scene.assemble().unwrap()
    };
    fn constrained(system: &System<f64, 3>, scheme: &impl Scheme<f64>, step: f64) {
        let mut run = Integration::start(system, system.rest(), scheme).unwrap();
        run.step(step).unwrap();
        let count = allocations(|| {
            for _ in 0..20 {
                run.step(step).unwrap();
            }
        });
        assert_eq!(count, 0, "with constraints");
    }
    constrained(&system, &Newmark::trapezoidal(), 1e-3);
    constrained(&system, &Midpoint::default(), 1e-3);
    constrained(&system, &EnergyMomentum::conserving(), 1e-3);
    constrained(&system, &Collocation::radau(2), 1e-3);
    constrained(&system, &CentralDifference::default(), 1e-6);

    for moment in [false, true] {
        for refresh in [
            Refresh::EveryIteration,
            Refresh::EverySolve,
            Refresh::WhenSlow,
        ] {
            let system = build(moment);
            let newton = Newton {
                refresh,
                ..Newton::default()
            };
            let method = Newmark::trapezoidal().with_newton(newton);
            let mut run = Integration::start(&system, system.rest(), &method).unwrap();
            run.step(1e-3).unwrap();
            let count = allocations(|| {
                for _ in 0..20 {
                    run.step(1e-3).unwrap();
                }
            });
            assert_eq!(count, 0, "{refresh:?}, moment: {moment}");
            let count = allocations(|| {
                let control = Stepping::Adaptive(Adaptive::to(1e-4));
                run.until(0.05, control, |_| {}).unwrap();
            });
            assert_eq!(count, 0, "adaptive, {refresh:?}, moment: {moment}");
        }
    }
    let system = build(false);
    let fixed = Stepping::Halved {
        step: 1e-3,
        halvings: 3,
    };
    quiet(&system, &Newmark::generalised_alpha(0.8), fixed);
    quiet(&system, &Midpoint::default(), fixed);
    quiet(&system, &EnergyMomentum::conserving(), fixed);
    quiet(&system, &EnergyMomentum::dissipating(0.1), fixed);
    quiet(&system, &Collocation::gauss(2), fixed);
    quiet(&system, &Collocation::radau(3), fixed);
    let explicit = CentralDifference { renewal: 5 };
    quiet(&system, &explicit, Stepping::Stable(0.9));
    // A step along a path of equilibria.
    let mut scene = Scene::<f64, 3>::new();
    let beam = Beam::new(FullyParameterised, disk, formulation);
    let beam = scene
        .add(beam.straight([0.0; 3], [1.0, 0.0, 0.0], 10))
        .unwrap();
    scene.clamp(beam.start()).unwrap();
    scene.force(beam.end(), [0.0, 1.0, 0.0]).unwrap();
    let system = scene.assemble().unwrap();
    for control in [Control::Sphere, Control::Plane, Control::Load] {
        let settings = Path::by(control, 0.01);
        let mut path = Continuation::start(&system, system.rest(), 0.0, &settings).unwrap();
        path.step().unwrap();
        let count = allocations(|| {
            path.until(Target::Points(5), |_| {}).unwrap();
        });
        assert_eq!(count, 0, "{control:?}");
    }
}

/// No allocation in a run of this scheme, nor in finding an event.
fn quiet<M: Scheme<f64> + std::fmt::Debug>(
    system: &System<f64, 3>,
    scheme: &M,
    stepping: Stepping,
) {
    let mut run = Integration::start(system, system.rest(), scheme).unwrap();
    run.until(2e-3, stepping, |_| {}).unwrap();
    let count = allocations(|| {
        run.until(1e-2, stepping, |_| {}).unwrap();
        let clock = |state: &State<f64>| state.time - 0.0123;
        let met = run.until_event(2e-2, stepping, Crossing::Rising, clock, |_| {});
        assert_eq!(met, Ok(Ending::Event));
    });
    assert_eq!(count, 0, "{scheme:?}");
}
