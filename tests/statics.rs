//! Claims about static equilibrium: linear and large deflections against exact solutions, locking
//! in closed form, torsion, and indifference to the scale, position and orientation of the scene.

use ancf::analytical::{
    Elastica, cantilever_small_deflection, fully_parameterised_tip_ratio, poisson_locked_ratio,
};
use ancf::prelude::*;
use std::f64::consts::PI;

type Steel = SaintVenantKirchhoff<f64, 3>;

/// A straight cantilever of length 1 with a dead tip force; the system and its tip.
fn cantilever<const D: usize, const S: usize, F>(
    n: usize,
    radius: f64,
    force: f64,
    formulation: F,
) -> (System<f64, D>, Node)
where
    FullyParameterised: Element<D, S>,
    F: Formulation<f64, FullyParameterised, D, S>,
{
    let mut scene = Scene::<f64, D>::new();
    let axis = |k: usize, v: f64| std::array::from_fn(|c| if c == k { v } else { 0.0 });
    let disk = Disk::new(radius).unwrap();
    let beam = Beam::new(FullyParameterised, disk, formulation);
    let beam = scene.add(beam.straight([0.0; D], axis(0, 1.0), n)).unwrap();
    scene.clamp(beam.start()).unwrap();
    scene.force(beam.end(), axis(1, force)).unwrap();
    (scene.assemble().unwrap(), beam.end())
}

fn tip<const D: usize>((system, end): &(System<f64, D>, Node), steps: usize) -> [f64; D] {
    let mut state = system.rest();
    Statics::in_steps(steps).solve(system, &mut state).unwrap();
    system.displacement(&state, *end).unwrap()
}

/// `1 - 1/(4 n^2)` of `F L^3 / (3 E I)`: the directors' curvature is constant in an element.
#[test]
fn linear_tip_deflection_has_its_closed_form() {
    let (young, radius) = (2.0e11, 2.5e-3_f64);
    let bending = young * PI * radius.powi(4) / 4.0;
    for n in [1, 2, 4, 8, 16] {
        let solid = Steel::isotropic(young, 0.0).unwrap();
        let force = 1e-4;
        let deflection = tip(&cantilever(n, radius, force, Continuum::full(solid)), 1)[1];
        let slender = cantilever_small_deflection(force, 1.0, bending).unwrap();
        let shear = force / (young / 2.0 * PI * radius * radius);
        let ratio = (deflection - shear) / slender;
        let exact = fully_parameterised_tip_ratio::<f64>(n).unwrap();
        assert!(
            (ratio / exact - 1.0).abs() < 1e-5,
            "{n} elements: {ratio}, not {exact}"
        );
    }
}

/// Full elasticity with a section-linear element converges to the wrong answer, and says which;
/// selective reduced integration and the zero-Poisson option do not.
#[test]
fn poisson_locking_has_its_closed_form_and_its_remedies() {
    let (young, radius, nu, n) = (2.0e11, 2.5e-3_f64, 0.3, 64);
    let steel = Steel::isotropic(young, nu).unwrap();
    let force = 1e-4;
    let exact = cantilever_small_deflection(force, 1.0, young * PI * radius.powi(4) / 4.0).unwrap();
    let ratio = |rule| tip(&cantilever(n, radius, force, rule), 1)[1] / exact;
    let locked = ratio(Continuum::full(steel));
    assert!(
        (locked - poisson_locked_ratio(nu).unwrap()).abs() < 1e-4,
        "{locked}"
    );
    assert!((locked - 0.742857).abs() < 1e-4, "{locked}");
    for rule in [
        Continuum::selective_reduced(steel),
        Continuum::zero_poisson(steel),
    ] {
        let ratio = ratio(rule);
        assert!((ratio - 1.0).abs() < 1e-4, "{ratio}");
    }
}

/// In the plane (plane stress) the locked factor is that of `E / (1 - nu^2)`.
#[test]
fn planar_poisson_locking_is_that_of_plane_stress() {
    let (young, radius, nu, force) = (2.0e11, 2.5e-3_f64, 0.3, 1e-4);
    let steel = SaintVenantKirchhoff::<f64, 2>::isotropic(young, nu).unwrap();
    let exact = cantilever_small_deflection(force, 1.0, young * PI * radius.powi(4) / 4.0).unwrap();
    let locked = tip::<2>(&cantilever(64, radius, force, Continuum::full(steel)), 1)[1] / exact;
    assert!((locked - (1.0 - nu * nu)).abs() < 1e-4, "{locked}");
    let free = Continuum::selective_reduced(steel);
    let free = tip::<2>(&cantilever(64, radius, force, free), 1)[1] / exact;
    assert!((free - 1.0).abs() < 1e-4, "{free}");
}

/// A slender beam under a large dead load follows the elastica (Mattiasson 1981).
#[test]
fn large_deflection_follows_the_elastica() {
    let (young, radius) = (2.0e9, 1e-3_f64);
    let bending = young * PI * radius.powi(4) / 4.0;
    let solid = Steel::isotropic(young, 0.0).unwrap();
    for load in [1.0, 5.0, 10.0] {
        let exact = Elastica::under_transverse_load(load).unwrap();
        let force = load * bending;
        let [x, y, _] = tip(&cantilever(128, radius, force, Continuum::full(solid)), 4);
        assert!(
            (y - exact.deflection).abs() < 2e-4,
            "{load}: {y} not {}",
            exact.deflection
        );
        assert!(
            (x + exact.shortening).abs() < 2e-4,
            "{load}: {x} not {}",
            exact.shortening
        );
    }
}

#[test]
fn plane_and_space_bend_alike() {
    let (young, radius, force) = (2.0e11, 2.5e-3, 10.0);
    let in_space = Continuum::full(Steel::isotropic(young, 0.0).unwrap());
    let in_plane = Continuum::full(SaintVenantKirchhoff::isotropic(young, 0.0).unwrap());
    let [x3, y3, z3] = tip(&cantilever::<3, 8, _>(8, radius, force, in_space), 4);
    let [x2, y2] = tip(&cantilever::<2, 6, _>(8, radius, force, in_plane), 4);
    assert!((x3 - x2).abs() < 1e-9 && (y3 - y2).abs() < 1e-9 && z3.abs() < 1e-12);
}

/// A beam of a millimetre and one of a kilometre, similar in every number without dimension,
/// take the same iterations and give similar answers.
#[test]
fn millimetre_and_kilometre_converge_alike() {
    let solve = |size: f64, young: f64| {
        let mut scene = Scene::<f64, 3>::new();
        let solid = Steel::isotropic(young, 0.3).unwrap();
        let disk = Disk::new(0.01 * size).unwrap();
        let beam = Beam::new(
            FullyParameterised,
            disk,
            Continuum::selective_reduced(solid),
        );
        let beam = scene
            .add(beam.straight([0.0; 3], [size, 0.0, 0.0], 10))
            .unwrap();
        scene.clamp(beam.start()).unwrap();
        let force = 3.0 * young * PI * 1e-8 / 4.0 * size * size;
        scene.force(beam.end(), [0.0, force, 0.0]).unwrap();
        let system = scene.assemble().unwrap();
        let mut state = system.rest();
        let report = Statics::in_steps(3).solve(&system, &mut state).unwrap();
        let tip = system.displacement(&state, beam.end()).unwrap();
        (report, tip.map(|c| c / size))
    };
    let (usual, tip) = solve(1.0, 2e11);
    for (size, young) in [(1e-3, 2e11), (1e3, 2e11), (1e-3, 1e3), (1e3, 1e15)] {
        let (report, other) = solve(size, young);
        assert_eq!(report.iterations, usual.iterations, "{size} m, {young} Pa");
        for c in 0..3 {
            assert!(
                (other[c] - tip[c]).abs() < 1e-9,
                "{size} m, {young} Pa: {other:?} not {tip:?}"
            );
        }
    }
}

/// Turning and moving the whole scene turns and moves the answer; also for a rectangle, whose
/// frame matters, and far from the origin.
#[test]
fn orientation_and_position_of_the_scene_do_not_matter() {
    let turn = nalgebra::Rotation3::from_euler_angles(0.5, -1.1, 2.0);
    let to = |v: [f64; 3]| <[f64; 3]>::from(turn * nalgebra::Vector3::from(v));
    let solve = |turned: bool| {
        let place = |v: [f64; 3]| if turned { to(v) } else { v };
        let origin = if turned { [10.0, -20.0, 5.0] } else { [0.0; 3] };
        let end = place([1.0, 0.0, 0.0]);
        let mut scene = Scene::<f64, 3>::new();
        let solid = Steel::isotropic(2e11, 0.3).unwrap();
        let section = Rectangle::new(0.02, 0.01).unwrap();
        let beam = Beam::new(
            FullyParameterised,
            section,
            Continuum::selective_reduced(solid),
        )
        .straight(origin, std::array::from_fn(|c| origin[c] + end[c]), 6)
        .up(place([0.3, 1.0, 0.0]));
        let beam = scene.add(beam).unwrap();
        scene.clamp(beam.start()).unwrap();
        scene.force(beam.end(), place([0.0, 300.0, 200.0])).unwrap();
        let twist = Moment::new(place([40.0, 0.0, 0.0]), MomentLaw::MeanRotation);
        scene.moment(beam.end(), twist).unwrap();
        let system = scene.assemble().unwrap();
        let mut state = system.rest();
        Statics::in_steps(4).solve(&system, &mut state).unwrap();
        system.displacement(&state, beam.end()).unwrap()
    };
    let (plain, turned) = (to(solve(false)), solve(true));
    for c in 0..3 {
        assert!((plain[c] - turned[c]).abs() < 1e-9, "{plain:?} {turned:?}");
    }
}

/// Both second moments are felt: a rectangle is stiffer about one axis, by the square of the
/// ratio of its sides.
#[test]
fn the_section_frame_decides_which_way_is_stiff() {
    let deflection = |direction: [f64; 3]| {
        let mut scene = Scene::<f64, 3>::new();
        let solid = Steel::isotropic(2e11, 0.0).unwrap();
        let section = Rectangle::new(0.02, 0.01).unwrap();
        let beam = Beam::new(FullyParameterised, section, Continuum::full(solid));
        let beam = scene
            .add(beam.straight([0.0; 3], [1.0, 0.0, 0.0], 8))
            .unwrap();
        scene.clamp(beam.start()).unwrap();
        scene.force(beam.end(), direction).unwrap();
        let system = scene.assemble().unwrap();
        let mut state = system.rest();
        Statics::default().solve(&system, &mut state).unwrap();
        let tip = system.displacement(&state, beam.end()).unwrap();
        tip[1] + tip[2]
    };
    let ratio = deflection([0.0, 0.0, 1e-2]) / deflection([0.0, 1e-2, 0.0]);
    assert!((ratio - 4.0).abs() < 1e-2, "{ratio}");
}

/// A simply supported beam needs only the supports it is given: pinned at one end, its other end
/// free to slide along the axis.
#[test]
fn supports_of_single_components_make_a_simple_beam() {
    let (young, radius, weight) = (2e11, 5e-3, 7800.0 * 9.81);
    let mut scene = Scene::<f64, 3>::new();
    let solid = Steel::isotropic(young, 0.0).unwrap();
    let disk = Disk::new(radius).unwrap();
    let beam = Beam::new(FullyParameterised, disk, Continuum::full(solid));
    let beam = beam.straight([0.0; 3], [1.0, 0.0, 0.0], 32).density(7800.0);
    let beam = scene.add(beam).unwrap();
    scene.pin(beam.start()).unwrap();
    scene
        .fix(beam.end(), NodalVector::Position, [false, true, true])
        .unwrap();
    // The beam must not spin about its axis.
    scene
        .fix(beam.start(), NodalVector::Slope(1), [false, false, true])
        .unwrap();
    scene.gravity([0.0, -9.81, 0.0]).unwrap();
    let system = scene.assemble().unwrap();
    let mut state = system.rest();
    Statics::default().solve(&system, &mut state).unwrap();
    let middle = system.displacement(&state, beam.node(16)).unwrap()[1];
    let area = PI * radius * radius;
    let exact = -5.0 * weight * area / (384.0 * young * area * radius * radius / 4.0);
    assert!((middle / exact - 1.0).abs() < 2e-3, "{middle} not {exact}");
}

/// Whole statics in dual numbers: the tip's derivative by Young's modulus and by the radius,
/// against a central difference of plain runs.
#[test]
fn statics_in_dual_numbers_differentiate_the_tip() {
    use num_dual::Dual64;
    fn run<R: Real>(young: R, radius: R) -> R {
        let mut scene = Scene::<R, 3>::new();
        let solid = SaintVenantKirchhoff::isotropic(young, R::lit(0.3)).unwrap();
        let disk = Disk::new(radius).unwrap();
        let beam = Beam::new(
            FullyParameterised,
            disk,
            Continuum::selective_reduced(solid),
        );
        let zero = R::zero();
        let beam = scene
            .add(beam.straight([zero; 3], [R::one(), zero, zero], 4))
            .unwrap();
        scene.clamp(beam.start()).unwrap();
        scene.force(beam.end(), [zero, R::lit(10.0), zero]).unwrap();
        let system = scene.assemble().unwrap();
        let mut state = system.rest();
        Statics::in_steps(2).solve(&system, &mut state).unwrap();
        system.displacement(&state, beam.end()).unwrap()[1]
    }
    let (young, radius) = (2e11, 5e-3);
    let by_young = run(Dual64::from_re(young).derivative(), Dual64::from_re(radius)).eps;
    let by_radius = run(Dual64::from_re(young), Dual64::from_re(radius).derivative()).eps;
    let h = 1e-4;
    let difference = |f: &dyn Fn(f64) -> f64, x: f64| {
        let d = |h: f64| (f(x * (1.0 + h)) - f(x * (1.0 - h))) / (2.0 * h * x);
        (4.0 * d(h) - d(2.0 * h)) / 3.0
    };
    let young_truth = difference(&|e| run(e, radius), young);
    let radius_truth = difference(&|r| run(young, r), radius);
    assert!(
        (by_young / young_truth - 1.0).abs() < 1e-7,
        "{by_young} not {young_truth}"
    );
    assert!(
        (by_radius / radius_truth - 1.0).abs() < 1e-7,
        "{by_radius} not {radius_truth}"
    );
}

/// The same program in single precision.
#[test]
fn statics_run_in_single_precision() {
    let mut scene = Scene::<f32, 2>::new();
    let solid = SaintVenantKirchhoff::isotropic(2e7_f32, 0.0).unwrap();
    let disk = Disk::new(0.05_f32).unwrap();
    let beam = Beam::new(FullyParameterised, disk, Continuum::full(solid));
    let beam = scene.add(beam.straight([0.0; 2], [1.0, 0.0], 4)).unwrap();
    scene.clamp(beam.start()).unwrap();
    scene.force(beam.end(), [0.0, 20.0]).unwrap();
    let system = scene.assemble().unwrap();
    let mut state = system.rest();
    let mut solver = Statics::in_steps(2);
    solver.newton.residual = 1e-5;
    solver.newton.correction = 1e-3;
    solver.solve(&system, &mut state).unwrap();
    let single = system.displacement(&state, beam.end()).unwrap()[1];

    let solid = SaintVenantKirchhoff::isotropic(2e7, 0.0).unwrap();
    let double = tip::<2>(&cantilever(4, 0.05, 20.0, Continuum::full(solid)), 2)[1];
    assert!(
        (f64::from(single) / double - 1.0).abs() < 1e-4,
        "{single} not {double}"
    );
}

/// A solved state is a starting point like any other: solving again stays there, and a new load
/// is reached from it.
#[test]
fn statics_goes_on_from_any_state() {
    let (young, radius) = (2.0e11, 0.02_f64);
    let steel = Steel::isotropic(young, 0.0).unwrap();
    let mut scene = Scene::<f64, 3>::new();
    let beam = Beam::new(
        FullyParameterised,
        Disk::new(radius).unwrap(),
        Continuum::full(steel),
    );
    let beam = scene
        .add(beam.straight([0.0; 3], [1.0, 0.0, 0.0], 10))
        .unwrap();
    scene.clamp(beam.start()).unwrap();
    let moment = 2.0 * PI * young * PI * radius.powi(4) / 4.0;
    // Time stands for the share of the full moment.
    scene
        .moment_in_time(beam.end(), Moment::about_z(moment), |t| t)
        .unwrap();
    let system = scene.assemble().unwrap();
    let mut state = system.rest();
    let mut ends = Vec::new();
    for time in [0.5, 1.0, 1.0, 0.25] {
        state.time = time;
        Statics::in_steps(10).solve(&system, &mut state).unwrap();
        ends.push(system.position(&state, beam.end()).unwrap());
    }
    let far = |a: [f64; 3], b: [f64; 3]| (0..3).map(|c| (a[c] - b[c]).abs()).sum::<f64>();
    assert!(far(ends[1], ends[2]) < 1e-9);
    let mut direct = system.rest();
    direct.time = 0.25;
    Statics::in_steps(10).solve(&system, &mut direct).unwrap();
    assert!(far(ends[3], system.position(&direct, beam.end()).unwrap()) < 1e-8);
}

/// A heavy load, on a support or on another beam, does not hide a light one.
#[test]
fn heavy_neighbours_do_not_hide_a_light_beam() {
    let steel = Steel::isotropic(2e11, 0.3).unwrap();
    let formulation = Continuum::selective_reduced(steel);
    let place = |scene: &mut Scene<f64, 3>, radius: f64, length: f64, y: f64| {
        let disk = Disk::new(radius).unwrap();
        let beam = Beam::new(FullyParameterised, disk, formulation.clone());
        let beam = beam
            .straight([0.0, y, 0.0], [length, y, 0.0], 8)
            .density(7800.0);
        scene.add(beam).unwrap()
    };
    let mut scene = Scene::<f64, 3>::new();
    let heavy = place(&mut scene, 1.0, 100.0, 0.0);
    let light = place(&mut scene, 3e-4, 0.1, 5.0);
    scene.clamp(heavy.start()).unwrap();
    scene.clamp(heavy.end()).unwrap();
    scene.clamp(light.start()).unwrap();
    scene.force(heavy.start(), [0.0, 1e11, 0.0]).unwrap();
    scene.gravity([0.0, -9.81, 0.0]).unwrap();
    let system = scene.assemble().unwrap();
    let mut state = system.rest();
    Statics::default().solve(&system, &mut state).unwrap();
    let tip = system.displacement(&state, light.end()).unwrap()[1];
    // rho A g L^4 / (8 E I).
    let exact = -7800.0 * 9.81 * 0.1_f64.powi(4) / (8.0 * 2e11 * 9e-8 / 4.0);
    assert!((tip / exact - 1.0).abs() < 1e-2, "{tip} not {exact}");
}

/// Derivatives are found where the value needs no iteration: at zero load, and from a state that
/// is already in equilibrium.
#[test]
fn derivatives_need_no_residual() {
    use num_dual::Dual64;
    let run = |force: Dual64, start: Option<&[f64]>| {
        let lift = Dual64::from_re;
        let mut scene = Scene::<Dual64, 3>::new();
        let solid = SaintVenantKirchhoff::isotropic(lift(2e11), lift(0.0)).unwrap();
        let disk = Disk::new(lift(5e-3)).unwrap();
        let beam = Beam::new(FullyParameterised, disk, Continuum::full(solid));
        let ends = ([lift(0.0); 3], [lift(1.0), lift(0.0), lift(0.0)]);
        let beam = scene.add(beam.straight(ends.0, ends.1, 4)).unwrap();
        scene.clamp(beam.start()).unwrap();
        scene
            .force(beam.end(), [lift(0.0), force, lift(0.0)])
            .unwrap();
        let system = scene.assemble().unwrap();
        let mut state = system.rest();
        if let Some(start) = start {
            state.displacement = start.iter().map(|u| lift(*u)).collect();
        }
        Statics::default().solve(&system, &mut state).unwrap();
        let tip = system.displacement(&state, beam.end()).unwrap()[1];
        let plain: Vec<f64> = state.displacement.iter().map(|u| u.re).collect();
        (tip, plain)
    };
    let seed = |f| Dual64::from_re(f).derivative();
    let at_rest = run(seed(0.0), None).0.eps;
    let bending = 2e11 * PI * 5e-3_f64.powi(4) / 4.0;
    let exact = (1.0 - 1.0 / 64.0) / (3.0 * bending) + 1.0 / (1e11 * PI * 25e-6);
    assert!(
        (at_rest / exact - 1.0).abs() < 1e-5,
        "{at_rest} not {exact}"
    );
    let (cold, plain) = run(seed(50.0), None);
    let warm = run(seed(50.0), Some(&plain)).0;
    assert!(
        (warm.eps / cold.eps - 1.0).abs() < 1e-9,
        "{} not {}",
        warm.eps,
        cold.eps
    );
}

/// Points of the beam off its nodes and off its axis: on a straight stretch they are where the
/// stretch puts them, in a deformed section they follow the slopes.
#[test]
fn any_point_of_a_beam_can_be_found() {
    let steel = Steel::isotropic(2e11, 0.0).unwrap();
    let mut scene = Scene::<f64, 3>::new();
    let section = Rectangle::new(0.02, 0.01).unwrap();
    let beam = Beam::new(FullyParameterised, section, Continuum::full(steel));
    let beam = scene
        .add(beam.straight([1.0, 0.0, 0.0], [3.0, 0.0, 0.0], 4))
        .unwrap();
    // Held without a clamp, which would keep the axis from stretching at its node.
    scene.pin(beam.start()).unwrap();
    scene
        .fix(beam.start(), NodalVector::Slope(0), [false, true, true])
        .unwrap();
    scene
        .fix(beam.start(), NodalVector::Slope(1), [false, false, true])
        .unwrap();
    scene.force(beam.end(), [4e5, 0.0, 0.0]).unwrap();
    let system = scene.assemble().unwrap();
    let mut state = system.rest();
    Statics::default().solve(&system, &mut state).unwrap();
    let strain = system.displacement(&state, beam.end()).unwrap()[0] / 2.0;
    // St Venant-Kirchhoff: N = E A (1 + e) (e + e^2 / 2).
    let force = 4e7 * (1.0 + strain) * strain * (1.0 + strain / 2.0);
    assert!((force / 4e5 - 1.0).abs() < 1e-10, "{force}");
    for s in [0.0, 0.1, 0.25, 0.6, 1.0] {
        let [x, y, z] = system
            .point(&state, beam.start(), s, [0.0, 0.01, -0.005])
            .unwrap();
        let exact = 1.0 + 2.0 * s * (1.0 + strain);
        assert!((x - exact).abs() < 1e-12 && (y - 0.01).abs() < 1e-12 && (z + 0.005).abs() < 1e-12);
    }
}

/// A square tube by its outline, whatever degree is asked: a rule with points off the centroid.
#[derive(Debug, Clone, Copy)]
struct Tube;

impl Section<f64> for Tube {
    fn rule(&self, degree: usize) -> Result<Cubature<f64, 2>> {
        let square = |a: f64| Loop::polygon(vec![[-a, -a], [a, -a], [a, a], [-a, a]]);
        let outline = Outline::new(square(0.01))?.with_hole(square(0.008))?;
        outline.rule(degree.max(4))
    }
    fn outline(&self, _: usize) -> Vec<Vec<[f64; 2]>> {
        Vec::new()
    }
}

/// A cantilever along x under an end load, and its end.
fn loaded(
    section: &dyn Section<f64>,
    n: usize,
    load: impl Fn(&mut Scene<f64, 3>, Node),
) -> (System<f64, 3>, Node, State<f64>) {
    let steel = Steel::isotropic(2e11, 0.3).unwrap();
    let mut scene = Scene::<f64, 3>::new();
    let beam = Beam::new(
        FullyParameterised,
        section,
        Continuum::selective_reduced(steel),
    );
    let beam = scene
        .add(beam.straight([0.0; 3], [1.0, 0.0, 0.0], n))
        .unwrap();
    scene.clamp(beam.start()).unwrap();
    load(&mut scene, beam.end());
    let system = scene.assemble().unwrap();
    let mut state = system.rest();
    Statics::default().solve(&system, &mut state).unwrap();
    (system, beam.end(), state)
}

fn shapes() -> [Box<dyn Section<f64>>; 4] {
    [
        Box::new(Disk::new(0.01).unwrap()),
        Box::new(Annulus::new(0.01, 0.0075).unwrap()),
        Box::new(Rectangle::new(0.02, 0.01).unwrap()),
        Box::new(Tube),
    ]
}

/// Selective reduced integration bends every section the right way about both axes, also one whose
/// rule of degree 1 is more than the centroid, a user's among them.
#[test]
fn selective_reduction_frees_every_section_about_both_axes() {
    for section in shapes() {
        let properties = section.properties().unwrap();
        for (force, inertia) in [
            ([0.0, 1.0, 0.0], properties.izz),
            ([0.0, 0.0, 1.0], properties.iyy),
        ] {
            let (system, end, state) =
                loaded(&*section, 16, |scene, end| scene.force(end, force).unwrap());
            let tip = system.displacement(&state, end).unwrap();
            let ratio = (tip[1] + tip[2]) * 3.0 * 2e11 * inertia;
            assert!(
                (ratio - 1.0).abs() < 2e-3,
                "{section:?} under {force:?}: {ratio}"
            );
        }
    }
}

/// A twisted beam turns by `M L / (G J)` with `J = I_y + I_z`: exact for a disk and an annulus;
/// others cannot warp and are too stiff by the ratio to their St Venant constant.
#[test]
fn torsion_turns_the_section_without_warping() {
    let moment = 1e-2;
    for section in shapes() {
        let properties = section.properties().unwrap();
        for n in [1, 8] {
            let (system, end, state) = loaded(&*section, n, |scene, end| {
                scene.moment(end, Moment::about_x(moment)).unwrap();
            });
            let [_, y, z] = system.vector(&state, end, NodalVector::Slope(1)).unwrap();
            let shear = 2e11 / (2.0 * 1.3);
            let exact = moment / (shear * (properties.iyy + properties.izz));
            let twist = z.atan2(y);
            assert!(
                (twist / exact - 1.0).abs() < 1e-3,
                "{section:?}, {n}: {twist} not {exact}"
            );
        }
    }
}
