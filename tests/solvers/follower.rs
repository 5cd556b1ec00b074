//! Claims about paths under loads that follow the motion: their critical points are found and told
//! apart though the tangent is unsymmetric.

use ancf::prelude::*;
use ancf::solver::{Matrix, Profile, Unknowns};
use std::f64::consts::PI;

/// A bar from the origin to `(1, h)`, held there by a spring along `x`, under a force across the bar
/// that turns with it: stiffness of the bar and of the spring.
struct FollowerTruss {
    height: f64,
    stiffness: [f64; 2],
    unknowns: Unknowns<f64>,
}

impl FollowerTruss {
    fn new(height: f64, stiffness: [f64; 2]) -> Self {
        let unknowns = Unknowns::all(Profile::from_ranges(2, [0..2]).unwrap());
        Self {
            height,
            stiffness,
            unknowns,
        }
    }

    /// Place of the top and, with `1 / length`, the direction of the bar.
    fn top(&self, u: &[f64]) -> [f64; 3] {
        let (x, y) = (1.0 + u[0], self.height + u[1]);
        [x, y, x.hypot(y)]
    }

    /// The load that keeps the bar at an angle, and the length it has there: balance along the bar
    /// gives the length, balance across it the load.
    fn exact(&self, angle: f64) -> (f64, f64) {
        let [bar, spring] = self.stiffness;
        let (cos, sin) = (angle.cos(), angle.sin());
        let free = 1.0_f64.hypot(self.height);
        let length = (bar * free + spring * cos) / (bar + spring * cos * cos);
        (spring * (length * cos - 1.0) * sin, length)
    }
}

impl Structure<f64> for FollowerTruss {
    fn unknowns(&self) -> &Unknowns<f64> {
        &self.unknowns
    }
    fn symmetric(&self) -> bool {
        false
    }
    fn measure(&self) -> &[f64] {
        &[1.0, 1.0]
    }
    fn add_internal(&self, u: &[f64], q: &mut [f64]) {
        let ([x, y, length], [bar, spring]) = (self.top(u), self.stiffness);
        let tension = bar * (length - 1.0_f64.hypot(self.height)) / length;
        q[0] += tension * x + spring * u[0];
        q[1] += tension * y;
    }
    fn add_external(&self, _: f64, factor: f64, u: &[f64], q: &mut [f64]) -> Result<()> {
        let [x, y, length] = self.top(u);
        q[0] += factor * y / length;
        q[1] -= factor * x / length;
        Ok(())
    }
    fn add_tangent(&self, _: f64, factor: f64, u: &[f64], k: &mut Matrix<f64>) -> Result<()> {
        let ([x, y, length], [bar, spring]) = (self.top(u), self.stiffness);
        let tension = bar * (1.0 - 1.0_f64.hypot(self.height) / length);
        let free = bar * 1.0_f64.hypot(self.height) / length.powi(3);
        let cube = length.powi(3);
        k.add(
            0,
            0,
            tension + free * x * x + spring + factor * x * y / cube,
        )?;
        k.add(0, 1, free * x * y - factor * x * x / cube)?;
        k.add(1, 0, free * x * y + factor * y * y / cube)?;
        k.add(1, 1, tension + free * y * y - factor * x * y / cube)
    }
    fn has_mass(&self) -> bool {
        false
    }
    fn add_mass_times(&self, _: f64, _: &[f64], _: &mut [f64]) {}
    fn add_mass(&self, _: f64, _: &mut Matrix<f64>) -> Result<()> {
        Ok(())
    }
}

fn rest(size: usize) -> State<f64> {
    State {
        time: 0.0,
        displacement: vec![0.0; size],
        velocity: vec![0.0; size],
        acceleration: vec![0.0; size],
        work: 0.0,
    }
}

/// The path is that of the closed form, and its limit points are the extrema of the load.
#[test]
fn a_follower_force_snaps_a_truss_at_its_exact_limit() {
    for (height, stiffness) in [(0.3, [1.0, 1.0]), (0.5, [2.0, 0.3])] {
        let truss = FollowerTruss::new(height, stiffness);
        // The extremum of the load over the angle, where its slope changes sign.
        let slope = |angle: f64| truss.exact(angle + 1e-6).0 - truss.exact(angle - 1e-6).0;
        let (mut low, mut high) = (0.0, height.atan());
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            match slope(middle) < 0.0 {
                true => high = middle,
                false => low = middle,
            }
        }
        let (limit, _) = truss.exact(low);
        let settings = Path {
            load_weight: 0.0,
            ..Path::by(Control::Sphere, 0.02)
        };
        let mut path = Continuation::start(&truss, rest(2), 0.0, &settings).unwrap();
        let follow = |point: &PathPoint<'_, f64>| {
            let [x, y, length] = truss.top(&point.state.displacement);
            let (load, exact) = truss.exact(y.atan2(x));
            assert!((point.factor - load).abs() < 1e-9 && (length - exact).abs() < 1e-9);
            assert_eq!(point.unstable, None);
        };
        path.until(Target::Coordinate(1, -1.7 * height), follow)
            .unwrap();
        let found = path.criticals();
        assert_eq!(found.len(), 2, "{height}");
        // Snapped through the truss is its own image.
        for (critical, truth) in found.iter().zip([limit, -limit]) {
            assert_eq!(critical.kind, Criticality::Limit);
            assert_eq!(critical.unstable, [None, None]);
            let error = (critical.factor / truth - 1.0).abs();
            assert!(error < 1e-8, "{} for {truth}", critical.factor);
        }
    }
}

/// A clamped strut of length and bending stiffness 1 under a multiple of Euler's load, with a couple on its tip
/// that follows it, or none.
fn strut(load: f64, couple: Option<f64>) -> System<f64, 2> {
    let mut scene = Scene::<f64, 2>::new();
    let rule = EulerBernoulli::with_stiffness(1e6, 1.0).unwrap();
    let beam = Beam::new(Cable, Moments::new(1.0, 1.0, 1.0).unwrap(), rule);
    let beam = scene.add(beam.straight([0.0; 2], [1.0, 0.0], 16)).unwrap();
    scene.clamp(beam.start()).unwrap();
    scene
        .force(beam.end(), [-load * PI * PI / 4.0, 0.0])
        .unwrap();
    if let Some(couple) = couple {
        let moment = Moment::new([0.0, 0.0, couple], MomentLaw::FollowerCouple(0));
        scene.moment(beam.end(), moment).unwrap();
    }
    scene.assemble().unwrap()
}

/// A couple of no size makes the tangent unsymmetric in storage alone: the bifurcation found by the
/// determinant is the one found by counting, and the branch is reached from it.
#[test]
fn the_sign_of_the_determinant_finds_eulers_bifurcation() {
    let critical = |system: &System<f64, 2>| {
        let settings = Path::by(Control::Sphere, 0.3);
        let mut path = Continuation::start(system, system.rest(), 0.0, &settings).unwrap();
        path.until(Target::Critical, |_| {}).unwrap();
        let critical = path.criticals()[0].clone();
        path.switch(&critical, 0.1).unwrap();
        path.until(Target::Factor(1.2), |_| {}).unwrap();
        let slope = path.state().displacement.last().copied().unwrap();
        (critical, slope.abs())
    };
    let (counted, bent) = critical(&strut(1.0, None));
    let (signed, same) = critical(&strut(1.0, Some(0.0)));
    assert_eq!(counted.unstable, [Some(0), Some(1)]);
    assert_eq!(signed.unstable, [None, None]);
    for kind in [counted.kind, signed.kind] {
        assert_eq!(kind, Criticality::Bifurcation);
    }
    // Each is located to a millionth of a step of 0.3.
    assert!((signed.factor - counted.factor).abs() < 1e-6);
    assert!(
        bent > 0.5 && (bent / same - 1.0).abs() < 1e-8,
        "{bent} {same}"
    );
}

/// Statics that is to hold stability stops at Euler's load, too, where only parity is known.
#[test]
fn statics_stops_where_the_determinant_changes_its_sign() {
    let system = strut(2.0, Some(0.0));
    let report = Statics::in_steps(5).solve(&system, &mut system.rest());
    assert_eq!(report.unwrap().unstable, None);
    let holding = Statics {
        hold_stability: true,
        ..Statics::in_steps(5)
    };
    let refused = holding.solve(&system, &mut system.rest()).unwrap_err();
    let Error::StaticsFailed { reached, cause, .. } = refused else {
        panic!("{refused}")
    };
    let changed = Error::StabilityChanged { before: 0, now: 1 };
    assert!(*cause == changed && (2.0 * reached - 1.0).abs() < 1e-3);
}

/// Two legs that meet at an angle, turned through by a couple on a foot.
fn frame(law: MomentLaw) -> System<f64, 2> {
    let mut scene = Scene::<f64, 2>::new();
    let rule = EulerBernoulli::with_stiffness(1e4, 1.0).unwrap();
    let leg = Beam::new(Cable, Moments::new(1.0, 1.0, 1.0).unwrap(), rule);
    let left = leg.clone().straight([0.0; 2], [1.0, 0.1], 8);
    let left = scene.add(left).unwrap();
    let right = scene.add(leg.straight([1.0, 0.1], [2.0, 0.0], 8)).unwrap();
    scene.pin(left.start()).unwrap();
    scene.pin(right.end()).unwrap();
    scene.join(left.end(), right.start(), Joint::Rigid).unwrap();
    let moment = Moment::new([0.0, 0.0, -1.0], law);
    scene.moment(left.start(), moment).unwrap();
    scene.assemble().unwrap()
}

/// On a leg that hardly stretches a couple of two forces and the couple conjugate to the rotation do
/// the same; only the second has a potential. Both find the same critical points.
#[test]
fn follower_couples_meet_the_limits_of_conservative_ones() {
    let criticals = |law| {
        let system = frame(law);
        let settings = Path::by(Control::Sphere, 0.02);
        let mut path = Continuation::start(&system, system.rest(), 0.0, &settings).unwrap();
        path.until(Target::Points(60), |_| {}).unwrap();
        path.criticals().to_vec()
    };
    let conservative = criticals(MomentLaw::SlopeRotation(0));
    let follower = criticals(MomentLaw::FollowerCouple(0));
    assert!(conservative.len() == 3);
    assert_eq!(conservative.len(), follower.len());
    for (one, other) in conservative.iter().zip(&follower) {
        assert_eq!(one.kind, other.kind);
        assert!((one.factor / other.factor - 1.0).abs() < 2e-3);
    }
}
