//! A path that is stopped, saved and resumed, however often, is to the last bit the path that was not,
//! under every control; what it refuses it says, and a checkpoint is of one path only.

use std::ops::ControlFlow;

use ancf::prelude::*;

use super::truss::truss;

/// All bits of a point.
fn bits(point: &PathPoint<'_, f64>) -> Vec<u64> {
    let numbers = point.state.displacement.iter().chain([&point.factor]);
    numbers.map(|x| x.to_bits()).collect()
}

/// A checkpoint as it comes back from a file, where files can be written.
fn filed(checkpoint: PathCheckpoint<f64>) -> PathCheckpoint<f64> {
    #[cfg(feature = "serde")]
    let checkpoint = {
        let text = serde_json::to_string(&checkpoint).unwrap();
        let read: PathCheckpoint<f64> = serde_json::from_str(&text).unwrap();
        assert_eq!(read, checkpoint);
        read
    };
    checkpoint
}

/// Checks every point of a path to a target against that of one stopped every few points, each
/// time resumed with a system built anew. Tells how many critical points it passed.
fn same(settings: &Path, target: impl Fn(usize) -> Target<f64>) -> usize {
    let (system, down) = truss();
    let target = target(down);
    let mut whole = Vec::new();
    let mut path = Continuation::start(&system, system.rest(), 0.0, settings).unwrap();
    let ending = path.until(target, |point| whole.push(bits(point)));
    assert_eq!(ending, Ok(Ending::End), "{settings:?}");

    let mut pieces = Vec::new();
    let mut start = Continuation::start(&system, system.rest(), 0.0, settings).unwrap();
    let mut kept = start.checkpoint().unwrap();
    for every in [2, 1, 5, 3].into_iter().cycle() {
        let (system, _) = truss();
        let mut part = Continuation::resume(&system, &filed(kept), settings).unwrap();
        let begun = part.report().points;
        let ending = part.until(target, |point| {
            pieces.push(bits(point));
            match point.report.points - begun {
                n if n == every => ControlFlow::Break(()),
                _ => ControlFlow::Continue(()),
            }
        });
        kept = part.checkpoint().unwrap();
        assert_eq!(kept.report(), *part.report());
        if ending.unwrap() == Ending::End {
            assert_eq!(part.report(), path.report(), "{settings:?}");
            assert_eq!(part.criticals(), path.criticals(), "{settings:?}");
            assert_eq!(part.unstable(), path.unstable());
            break;
        }
    }
    let other = whole.iter().zip(&pieces).position(|(a, b)| a != b);
    assert_eq!(other, None, "{settings:?}: first other point");
    assert_eq!(whole.len(), pieces.len(), "{settings:?}");
    assert!(whole.len() > 10, "{settings:?}: {} points", whole.len());
    path.criticals().len()
}

#[test]
fn a_path_in_pieces_is_the_path_in_one() {
    let through = |down| Target::Coordinate(down, -0.7);
    for refresh in [
        Refresh::EveryIteration,
        Refresh::EverySolve,
        Refresh::WhenSlow,
    ] {
        let newton = Newton {
            refresh,
            ..Newton::default()
        };
        for control in [Control::Sphere, Control::Plane] {
            let settings = Path {
                newton,
                ..Path::by(control, 0.02)
            };
            assert_eq!(same(&settings, through), 2, "{settings:?}");
        }
        let settings = Path {
            newton,
            ..Path::by(Control::Load, 0.01)
        };
        assert_eq!(same(&settings, |_| Target::Factor(0.3)), 0);
    }
    let (_, down) = truss();
    let settings = Path::by(Control::Coordinate(down), -0.02);
    assert_eq!(same(&settings, through), 2);
}

/// Along the load alone the path ends at the limit point, and every step refused on the way is
/// told with its reason; the last equilibrium is one that can be saved.
#[test]
fn every_refused_step_has_its_reason() {
    let (system, _) = truss();
    let settings = Path::by(Control::Load, 0.1);
    let mut path = Continuation::start(&system, system.rest(), 0.0, &settings).unwrap();
    let stopped = path.until(Target::Factor(2.0), |_| {}).unwrap_err();
    let Error::PathStopped { factor, cause, .. } = stopped else {
        panic!("{stopped}")
    };
    let refusals = path.refusals();
    assert_eq!(refusals.len(), path.report().cutbacks);
    for (one, next) in refusals.iter().zip(&refusals[1..]) {
        assert!(one.factor <= next.factor);
        assert!(one.factor != next.factor || next.step == 0.5 * one.step);
    }
    let last = refusals.last().unwrap();
    assert_eq!((last.factor, &last.cause), (factor, &*cause));
    // An observer's error ends the path, too, and leaves the point that it saw.
    let mut path = Continuation::start(&system, system.rest(), 0.0, &settings).unwrap();
    let mut seen = 0.0;
    let full = Error::NoSuchCoordinate { index: 1, size: 0 };
    let ended = path.until(Target::Factor(2.0), |point| {
        seen = point.factor;
        Err::<(), _>(full.clone())
    });
    assert_eq!(ended, Err(full));
    assert_eq!(path.factor(), seen);
    let kept = filed(path.checkpoint().unwrap());
    let again = Continuation::resume(&system, &kept, &settings).unwrap();
    assert_eq!((again.state(), again.factor()), (path.state(), seen));
}

#[test]
fn a_checkpoint_is_of_one_path() {
    let (system, _) = truss();
    let settings = Path::by(Control::Sphere, 0.02);
    let mut path = Continuation::start(&system, system.rest(), 0.0, &settings).unwrap();
    path.until(Target::Points(3), |_| {}).unwrap();
    let kept = path.checkpoint().unwrap();
    let other = Path::by(Control::Plane, 0.02);
    let refused = Continuation::resume(&system, &kept, &other).map(|_| ());
    let text = refused.unwrap_err().to_string();
    assert!(
        text.contains("another path") && text.contains("Plane"),
        "{text}"
    );
    #[cfg(feature = "serde")]
    for (at, value, named) in [
        ("/progress/step", 0.0, "step along the path"),
        ("/progress/before/0/3", f64::NAN, "null"),
        (
            &format!("/state/displacement/{}", truss().1),
            0.1,
            "internal forces",
        ),
    ] {
        let mut file = serde_json::to_value(&kept).unwrap();
        *file.pointer_mut(at).unwrap() = value.into();
        let text = match serde_json::from_value::<PathCheckpoint<f64>>(file) {
            Err(error) => error.to_string(),
            Ok(kept) => {
                let refused = Continuation::resume(&system, &kept, &settings).map(|_| ());
                refused.unwrap_err().to_string()
            }
        };
        assert!(text.contains(named), "{at}: {text}");
    }
}
