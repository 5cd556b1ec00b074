//! Claims about the way along a path: it neither turns back at a limit point nor jumps to another
//! branch, whatever the first step, and a prescribed load stops at its limit.

use ancf::formulation::CableEnergy;
use ancf::prelude::*;

/// Two bars that meet at a height of 0.3 above their supports, under a load that at a factor of 1
/// is the limit they carry; the coordinate that it pushes down.
pub fn truss() -> (System<f64, 2>, usize) {
    let bar = EulerBernoulli::with_stiffness(1.0, 1.0)
        .unwrap()
        .with_energy(CableEnergy::GeometricCurvature);
    let bar = Beam::new(Cable, Moments::new(1.0, 1.0, 1.0).unwrap(), bar);
    let mut scene = Scene::<f64, 2>::new();
    let left = bar.clone().straight([0.0; 2], [1.0, HEIGHT], 1);
    let left = scene.add(left).unwrap();
    let right = bar.straight([1.0, HEIGHT], [2.0, 0.0], 1);
    let right = scene.add(right).unwrap();
    scene.pin(left.start()).unwrap();
    scene.pin(right.end()).unwrap();
    scene
        .join(left.end(), right.start(), Joint::Spherical)
        .unwrap();
    let top = NodalVector::Position;
    scene.fix(left.end(), top, [true, false]).unwrap();
    let length = 1.0_f64.hypot(HEIGHT);
    let limit = 2.0 * HEIGHT.powi(3) / (3.0 * 3_f64.sqrt() * length.powi(3));
    scene.force(left.end(), [0.0, -limit]).unwrap();
    let system = scene.assemble().unwrap();
    let down = system.coordinate(left.end(), top).unwrap() + 1;
    (system, down)
}

const HEIGHT: f64 = 0.3;

/// Share of the limit that the truss carries with its top at a height: `z (h^2 - z^2)` over its
/// extremum.
fn carried(z: f64) -> f64 {
    1.5 * 3_f64.sqrt() * z * (HEIGHT * HEIGHT - z * z) / HEIGHT.powi(3)
}

/// Near a limit point the next point lies as far back as ahead, and an iteration may end at either; a
/// tangent kept from elsewhere tells no direction, neither for a shorter step nor to locate the limit.
#[test]
fn paths_do_not_turn_back() {
    let (system, down) = truss();
    for first in [0.005, 0.01, 0.02, 0.03, 0.05, 0.1, 0.2] {
        for control in [Control::Sphere, Control::Plane] {
            for refresh in [
                Refresh::EveryIteration,
                Refresh::EverySolve,
                Refresh::WhenSlow,
            ] {
                let way = format!("{control:?}, {refresh:?}, {first}");
                let newton = Newton {
                    refresh,
                    ..Newton::default()
                };
                let settings = Path {
                    newton,
                    ..Path::by(control, first)
                };
                let mut path = Continuation::start(&system, system.rest(), 0.0, &settings).unwrap();
                let mut last = 0.0;
                let target = Target::Coordinate(down, -2.3 * HEIGHT);
                path.until(target, |point| {
                    let u = point.state.displacement[down];
                    assert!(u < last, "{way}: {u} after {last}");
                    last = u;
                    let error = (point.factor - carried(HEIGHT + u)).abs();
                    assert!(error < 1e-8, "{way}: {error:e} at {u}");
                })
                .unwrap();
                let limits = path.criticals();
                assert_eq!(limits.len(), 2, "{way}");
                for (limit, truth) in limits.iter().zip([1.0, -1.0]) {
                    assert!((limit.factor - truth).abs() < 1e-8);
                }
            }
        }
    }
}

/// Beyond the limit there is an equilibrium under the same load, snapped through: Newton's method
/// finds it, and it is not taken, whatever the step.
#[test]
fn a_prescribed_load_stops_at_its_limit() {
    let (system, down) = truss();
    for first in [0.01, 0.1, 0.3, 1.0, 2.0] {
        let settings = Path::by(Control::Load, first);
        let mut path = Continuation::start(&system, system.rest(), 0.0, &settings).unwrap();
        let stopped = path.until(Target::Factor(2.0), |point| {
            let z = HEIGHT + point.state.displacement[down];
            assert!(z > HEIGHT / 3_f64.sqrt(), "{first}: at {z}");
        });
        assert!(matches!(stopped, Err(Error::PathStopped { .. })));
        let left = 1.0 - path.factor();
        assert!((0.0..1e-3).contains(&left), "{first}: {left}");
    }
}
