//! Claims about loads that stay while others grow: what a structure carries besides them.

use ancf::prelude::*;

/// Work of the load on the tip of a clamped column of length and bending stiffness 1 at which it
/// buckles under this load and a weight: `theta'' + (load + weight s) theta = 0` from the tip down,
/// free there and clamped at `s = 1`; what the power series leaves at the clamp.
fn slope_at_clamp(load: f64, weight: f64) -> f64 {
    let mut terms = [1.0, 0.0, -load / 2.0];
    let mut sum = terms.iter().sum::<f64>();
    for n in 3..60 {
        let next = -(load * terms[1] + weight * terms[0]) / f64::from(n * (n - 1));
        terms = [terms[1], terms[2], next];
        sum += next;
    }
    sum
}

fn root(mut low: f64, mut high: f64, function: impl Fn(f64) -> f64) -> f64 {
    let side = function(low) > 0.0;
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        match (function(middle) > 0.0) == side {
            true => low = middle,
            false => high = middle,
        }
    }
    low
}

/// What of a column's loads is permanent.
#[derive(Clone, Copy, PartialEq)]
enum Held {
    Weight,
    Load,
    Nothing,
}

/// The column under a weight and a load on its tip.
fn column(weight: f64, load: f64, held: Held) -> System<f64, 2> {
    let mut scene = Scene::<f64, 2>::new();
    let rule = EulerBernoulli::with_stiffness(1e6, 1.0).unwrap();
    let beam = Beam::new(Cable, Moments::new(1.0, 1.0, 1.0).unwrap(), rule);
    let beam = beam.straight([0.0; 2], [0.0, 1.0], 24).density(1.0);
    let beam = scene.add(beam).unwrap();
    scene.clamp(beam.start()).unwrap();
    let top = beam.end();
    if held == Held::Load {
        scene.force(top, [0.0, -load]).unwrap();
        scene.hold_loads();
        scene.gravity([0.0, -weight]).unwrap();
    } else {
        scene.gravity([0.0, -weight]).unwrap();
        if held == Held::Weight {
            scene.hold_loads();
        }
        scene.force(top, [0.0, -load]).unwrap();
    }
    scene.assemble().unwrap()
}

/// The weight a column bears alone is Greenhill's 7.837; with part of it, standing or hanging, the
/// load on its tip is that of the series. The path's bifurcation and linear buckling from its start
/// agree, and so they do when the load stays and the weight grows.
#[test]
fn a_column_carries_less_for_its_own_weight() {
    let greenhill = root(5.0, 10.0, |weight| slope_at_clamp(0.0, weight));
    assert!((greenhill - 7.837_347).abs() < 1e-6, "{greenhill}");
    for weight in [-6.0, 2.0, 6.0] {
        let exact = root(0.01, 8.0, |load| slope_at_clamp(load, weight));
        let mut cases = vec![(column(weight, 1.0, Held::Weight), exact)];
        if weight > 0.0 {
            cases.push((column(1.0, exact, Held::Load), weight));
        }
        for (system, exact) in cases {
            let settings = Path::by(Control::Load, 0.4);
            let start = Continuation::start(&system, system.rest(), 0.0, &settings);
            let mut path = start.unwrap();
            let modes = Modes::lowest(1).buckling(&system, path.state(), 0.0);
            // The column shortens by a millionth before it buckles.
            let linear = modes.unwrap()[0].value;
            assert!((linear / exact - 1.0).abs() < 1e-4, "{linear} {exact}");
            path.until(Target::Critical, |_| {}).unwrap();
            let critical = &path.criticals()[0];
            let error = (critical.factor / exact - 1.0).abs();
            assert!(error < 1e-4, "{} {exact}", critical.factor);
            assert_eq!(critical.kind, Criticality::Bifurcation);
        }
    }
    // Without a permanent load the factor is that of both.
    let both = column(2.0, 1.0, Held::Nothing);
    let exact = root(0.01, 8.0, |factor| slope_at_clamp(factor, 2.0 * factor));
    let modes = Modes::lowest(1).buckling(&both, &both.rest(), 0.0).unwrap();
    assert!((modes[0].value / exact - 1.0).abs() < 1e-4);
}

/// A couple that stays, with a tangent of its own, and a force that grows: the path ends where
/// statics does under both, by corrections that converge quadratically.
#[test]
fn a_permanent_couple_bends_the_path() {
    for law in [MomentLaw::SlopeRotation(0), MomentLaw::FollowerCouple(0)] {
        let mut scene = Scene::<f64, 2>::new();
        let rule = EulerBernoulli::with_stiffness(1e3, 1.0).unwrap();
        let beam = Beam::new(Cable, Moments::new(1.0, 1.0, 1.0).unwrap(), rule);
        let beam = scene.add(beam.straight([0.0; 2], [1.0, 0.0], 8)).unwrap();
        scene.clamp(beam.start()).unwrap();
        let couple = Moment::new([0.0, 0.0, 1.5], law);
        scene.moment(beam.end(), couple).unwrap();
        scene.hold_loads();
        scene.force(beam.end(), [0.0, -2.0]).unwrap();
        let system = scene.assemble().unwrap();
        let mut truth = system.rest();
        Statics::in_steps(4).solve(&system, &mut truth).unwrap();
        let settings = Path::by(Control::Load, 0.25);
        let start = Continuation::start(&system, system.rest(), 0.0, &settings);
        let mut path = start.unwrap();
        let [_, bent] = system.displacement(path.state(), beam.end()).unwrap();
        assert!(bent > 0.5, "{bent}");
        path.until(Target::Factor(1.0), |_| {}).unwrap();
        let report = path.report();
        assert!(report.corrections <= 6 * report.points, "{report:?}");
        let ends = [path.state(), &truth].map(|s| system.displacement(s, beam.end()).unwrap());
        assert!((ends[0][0] - ends[1][0]).hypot(ends[0][1] - ends[1][1]) < 1e-8);
    }
}
