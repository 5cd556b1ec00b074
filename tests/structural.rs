//! Claims about structural mechanics and about curved beams: cantilevers with shear against
//! boundary-value problems solved to ten digits by independent codes, stiffness by constants, arcs
//! made straight. Published beams in space are in `published.rs`.

use ancf::formulation::{ElementKernel, Reference, Sample, SampledKernel, SectionLaw, changes};
use ancf::prelude::*;
use ancf::quadrature::gauss_legendre;
use ancf::verify;

/// A cantilever of quadratic elements along x with a dead tip force; tip displacement.
fn tip<X, const D: usize, const S: usize>(
    formulation: StructuralMechanics<f64>,
    section: X,
    (length, force, n): (f64, [f64; D], usize),
) -> [f64; D]
where
    X: Section<f64>,
    Quadratic: Element<D, S>,
    StructuralMechanics<f64>: Formulation<f64, Quadratic, D, S>,
{
    let mut scene = Scene::<f64, D>::new();
    let end = std::array::from_fn(|c| if c == 0 { length } else { 0.0 });
    let beam = Beam::new(Quadratic, section, formulation).straight([0.0; D], end, n);
    let beam = scene.add(beam).unwrap();
    scene.clamp(beam.start()).unwrap();
    scene.force(beam.end(), force).unwrap();
    let system = scene.assemble().unwrap();
    let mut state = system.rest();
    Statics::in_steps(10).solve(&system, &mut state).unwrap();
    system.displacement(&state, beam.end()).unwrap()
}

fn steel<const D: usize>() -> SaintVenantKirchhoff<f64, D> {
    SaintVenantKirchhoff::isotropic(2.07e11, 0.3).unwrap()
}

/// Nachbagauer et al. (2011): L = 2 m, 0.5 m x 0.1 m, tip forces 5e5 h^3 and 5e8 h^3 N, three shear
/// correction factors.
#[test]
fn nachbagauer_2011_cantilevers_converge_to_the_shear_deformable_rod() {
    let section = Rectangle::new(0.5, 0.1).unwrap();
    for (force, factor, exact) in [
        (6.25e4, 0.849673, [1.88849163196e-07, 0.000809903253977]),
        (6.25e4, 1.0, [1.86702089344e-07, 0.000804347700413]),
        (6.25e4, 5.0 / 6.0, [1.89129214956e-07, 0.000810627891398]),
        (6.25e7, 0.849673, [0.150971144239, 0.710568597854]),
        (6.25e7, 1.0, [0.149529375006, 0.706350847751]),
        (6.25e7, 5.0 / 6.0, [0.15115906923, 0.71111897496]),
    ] {
        let solve = |n| {
            let rule = StructuralMechanics::new(&steel::<2>()).with_shear_factors([factor; 2]);
            tip::<_, 2, 6>(rule, section, (2.0, [0.0, force], n))
        };
        let error = |u: [f64; 2]| {
            (-u[0] / exact[0] - 1.0)
                .abs()
                .max((u[1] / exact[1] - 1.0).abs())
        };
        let errors = [4, 8, 32].map(|n| error(solve(n)));
        // Twice the elements, a sixteenth of the error.
        assert!(
            errors[1] < errors[0] / 14.0,
            "F = {force}, k = {factor}: {errors:?}"
        );
        assert!(errors[2] < 2e-7, "F = {force}, k = {factor}: {errors:?}");
        let rule = StructuralMechanics::new(&steel::<3>()).with_shear_factors([factor; 2]);
        let [x, y, z] = tip::<_, 3, 9>(rule, section, (2.0, [0.0, force, 0.0], 8));
        let plane = solve(8);
        let apart = (x - plane[0]).abs().max((y - plane[1]).abs());
        assert!(apart < 1e-12 && z == 0.0, "{x} {y} {z} not {plane:?}");
    }
}

/// Constants given are constants used: the same beam from its section and from its stiffness.
#[test]
fn stiffness_by_constants_is_that_of_the_section() {
    let section = Rectangle::new(0.02, 0.01).unwrap();
    let force = [0.0, 300.0, 200.0];
    let from_section = tip::<_, 3, 9>(
        StructuralMechanics::new(&steel::<3>()),
        section,
        (1.0, force, 4),
    );
    let (young, shear) = (2.07e11, 2.07e11 / 2.6);
    let (iy, iz) = (0.02 * 1e-6 / 12.0, 0.01 * 8e-6 / 12.0);
    let given = BeamStiffness {
        axial: young * 2e-4,
        shear: [shear * 2e-4; 2],
        torsion: shear * (iy + iz),
        bending: [young * iy, young * iz],
    };
    let rule = StructuralMechanics::with_stiffness(given).unwrap();
    let moments = Moments::new(1.0, 1.0, 1.0).unwrap();
    let by_constants = tip::<_, 3, 9>(rule, moments, (1.0, force, 4));
    for c in 0..3 {
        assert!((from_section[c] - by_constants[c]).abs() < 1e-9);
    }
    let mut wrong = given;
    wrong.bending[1] = 0.0;
    let refused = StructuralMechanics::with_stiffness(wrong)
        .unwrap_err()
        .to_string();
    assert!(refused.contains("EI_z"), "{refused}");
}

/// Constants of inertia: the mass and the rotary inertia that a rigid motion feels.
#[test]
fn moments_give_the_inertia_they_state() {
    let stiffness = BeamStiffness {
        axial: 1e6,
        shear: [1e6; 2],
        torsion: 1e3,
        bending: [1e3; 2],
    };
    let rule = StructuralMechanics::with_stiffness(stiffness).unwrap();
    let mut scene = Scene::<f64, 3>::new();
    let beam = Beam::new(Quadratic, Moments::new(2.0, 7.0, 5.0).unwrap(), rule)
        .straight([0.0; 3], [3.0, 0.0, 0.0], 2)
        .density(1.0);
    scene.add(beam).unwrap();
    let system = scene.assemble().unwrap();
    let mut state = system.rest();
    for (omega, inertia) in [
        ([1.0, 0.0, 0.0], 3.0 * 12.0),
        ([0.0, 1.0, 0.0], 2.0 * 27.0 / 3.0 + 3.0 * 7.0),
        ([0.0, 0.0, 1.0], 2.0 * 27.0 / 3.0 + 3.0 * 5.0),
    ] {
        system
            .set_rigid_velocity(&mut state, [0.0; 3], omega)
            .unwrap();
        let kinetic = system.energies(&state).unwrap().kinetic;
        assert!(
            (kinetic - 0.5 * inertia).abs() < 1e-12,
            "{omega:?}: {kinetic}"
        );
    }
    let degree = Section::<f64>::rule(&Moments::new(2.0, 7.0, 5.0).unwrap(), 4);
    assert!(degree.is_err());
}

/// Whatever the slopes of the node, stretched and skew as they may be, a moment on the section
/// does the work of its vector in every rotation: the moments of its forces add up to it. Its
/// tangent is the gradient of its forces.
#[test]
fn a_moment_on_the_section_has_the_resultant_it_states() {
    let rule = StructuralMechanics::new(&steel::<3>());
    let mut scene = Scene::<f64, 3>::new();
    let beam = Beam::new(Quadratic, Rectangle::new(0.02, 0.02).unwrap(), rule);
    let beam = scene
        .add(beam.straight([0.0; 3], [1.0, 0.0, 0.0], 1))
        .unwrap();
    scene.clamp(beam.start()).unwrap();
    let vector = [3e3, -7e3, 5e3];
    let moment = Moment::new(vector, MomentLaw::SectionRotation);
    scene.moment(beam.end(), moment).unwrap();
    let system = scene.assemble().unwrap();
    let size = system.reference().len();
    let u: Vec<f64> = (0..size)
        .map(|i| 0.3 * (2.0 * i as f64 + 1.0).sin())
        .collect();
    let mut q = vec![0.0; size];
    system.add_external(0.0, 1.0, &u, &mut q).unwrap();
    let mut sum = [0.0; 3];
    for axis in [1, 2] {
        let at = system.coordinate(beam.end(), NodalVector::Slope(axis));
        let at = at.unwrap();
        let slope = |c: usize| system.reference()[at + c] + u[at + c];
        for c in 0..3 {
            let (a, b) = ((c + 1) % 3, (c + 2) % 3);
            sum[c] += slope(a) * q[at + b] - slope(b) * q[at + a];
        }
    }
    for c in 0..3 {
        assert!((sum[c] - vector[c]).abs() < 1e-10, "{sum:?}");
    }
    let tangent = verify::structure_tangent(&system, 0.0, &u).unwrap();
    tangent.report(1e3).into_result().unwrap();
}

/// A planar arc of radius 1 m and angle 1 rad, with a density.
fn arc<E, F, const S: usize>(element: E, formulation: F) -> (Scene<f64, 2>, Placed)
where
    E: Element<2, S>,
    F: Formulation<f64, E, 2, S>,
{
    let section = Rectangle::new(0.01, 0.01).unwrap();
    let mut scene = Scene::new();
    let arc = Beam::new(element, section, formulation).curved(1.0, 16, |s: f64| {
        let (sin, cos) = s.sin_cos();
        ([sin, 1.0 - cos], [[cos, sin], [-sin, cos]])
    });
    let arc = scene.add(arc.density(1e4)).unwrap();
    (scene, arc)
}

/// Tip of the arc under the moment -EI/R at its end, which makes it straight, and the mass of the
/// free one.
fn straightened<E, F, const S: usize>(element: E, formulation: F, slope: usize) -> ([f64; 2], f64)
where
    E: Element<2, S>,
    F: Formulation<f64, E, 2, S> + Clone,
{
    let (scene, _) = arc(element, formulation.clone());
    let system = scene.assemble().unwrap();
    let mut state = system.rest();
    system
        .set_rigid_velocity(&mut state, [1.0, 0.0], [0.0; 3])
        .unwrap();
    let mass = 2.0 * system.energies(&state).unwrap().kinetic;

    let (mut scene, beam) = arc(element, formulation);
    scene.clamp(beam.start()).unwrap();
    let law = MomentLaw::SlopeRotation(slope);
    let moment = Moment::new([0.0, 0.0, -2.07e11 * 1e-8 / 12.0], law);
    scene.moment(beam.end(), moment).unwrap();
    let system = scene.assemble().unwrap();
    let mut state = system.rest();
    Statics::in_steps(10).solve(&system, &mut state).unwrap();
    (system.position(&state, beam.end()).unwrap(), mass)
}

#[test]
fn an_arc_is_made_straight_by_the_moment_of_its_curvature() {
    let cable = straightened(Cable, EulerBernoulli::new(&steel::<2>()), 0);
    let rod = straightened(Quadratic, StructuralMechanics::new(&steel::<2>()), 1);
    let solid = Continuum::selective_reduced(steel::<2>()).axial(2);
    let solid = straightened(Quadratic, solid, 1);
    // A continuum is a curved bar in the sense of Winkler: off by (h/R)^2.
    for (name, ([x, y], mass), near) in [
        ("cable", cable, 1e-5),
        ("rod", rod, 1e-5),
        ("continuum", solid, 2e-4),
    ] {
        assert!((x - 1.0).abs() < near && y.abs() < near, "{name}: {x}, {y}");
        assert!((mass - 1.0).abs() < 1e-5, "{name}: {mass} kg");
    }
}

/// What is wrong with a curve is named; a cable in space cannot be curved.
#[test]
fn curves_that_are_none_are_refused() {
    let mut scene = Scene::<f64, 2>::new();
    let beam = || {
        let rule = StructuralMechanics::new(&steel::<2>());
        Beam::new(Quadratic, Rectangle::new(0.01, 0.01).unwrap(), rule)
    };
    let line = |s: f64| ([s, 0.0], [[1.0, 0.0], [0.0, 1.0]]);
    assert!(scene.add(beam().curved(1.0, 4, line)).is_ok());
    let short = scene
        .add(beam().curved(0.5, 4, line))
        .unwrap_err()
        .to_string();
    assert!(
        short.contains("arc length") && short.contains('2'),
        "{short}"
    );
    let left = scene.add(beam().curved(1.0, 4, |s| ([s, 0.0], [[1.0, 0.0], [0.0, -1.0]])));
    assert!(left.unwrap_err().to_string().contains("right-handed"));
    let long = scene.add(beam().curved(1.0, 4, |s| ([s, 0.0], [[1.1, 0.0], [0.0, 1.0]])));
    assert!(long.unwrap_err().to_string().contains("fraction 0"));
    let infinite = scene.add(beam().curved(1.0, 4, move |s| ([1.0 / s, 0.0], line(s).1)));
    assert!(matches!(infinite, Err(Error::NotFinite { .. })));
    assert!(scene.add(beam().curved(-1.0, 4, line)).is_err());
    assert!(scene.add(beam().curved(1.0, 0, line)).is_err());

    let square = Rectangle::new(0.01, 0.01).unwrap();
    let beam = Beam::new(Cable, square, EulerBernoulli::new(&steel::<3>()));
    let curved = beam.curved(1.0, 4, |s: f64| {
        let (sin, cos) = s.sin_cos();
        let frame = [[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]];
        ([sin, 1.0 - cos, 0.0], frame)
    });
    let refused = Scene::<f64, 3>::new().add(curved).unwrap_err().to_string();
    assert!(refused.contains("cross slopes"), "{refused}");
}

/// A planar beam with the moment `EI k0 tanh(kappa / k0)`, stretching with `EA`, once as a law of the
/// axis and once as the energy of a whole element.
#[derive(Debug, Clone, Copy)]
struct Yielding(f64, f64, f64);

impl Yielding {
    fn density<T: Algebra<f64>>(self, rest: &[[f64; 2]; 2], change: &[[T; 2]; 2]) -> T {
        let [t, b] = changes(rest, change);
        let square = t[0] * t[0] + t[1] * t[1];
        let stretch = square.sqrt().change;
        let curvature = ((t[0] * b[1] - t[1] * b[0]) / square).change;
        let sinh = curvature.times(0.5 / self.2).sinh();
        let bending = (sinh * sinh).times(2.0).ln_1p();
        (stretch * stretch).times(0.5 * self.0) + bending.times(self.1 * self.2 * self.2)
    }
}

impl SectionLaw<f64, 2, 2> for Yielding {
    fn energy<T: Algebra<f64>>(&self, rest: &[[f64; 2]; 2], change: &[[T; 2]; 2]) -> T {
        self.density(rest, change)
    }
}

impl Formulation<f64, Cable, 2, 4> for Yielding {
    type Kernel = SampledKernel<f64, Self, 2, 4, 2>;
    fn kernel(
        &self,
        element: &Cable,
        reference: &Reference<f64, 2, 4>,
        _: &dyn Section<f64>,
    ) -> Result<Self::Kernel> {
        let samples = [Sample::First(0), Sample::Second(0, 0)];
        let points = gauss_legendre(3)?;
        Ok(SampledKernel::new().with_part(element, reference, *self, samples, &points))
    }
}

/// The energy of an element, from derivatives of its shape functions and their weights.
#[derive(Debug)]
struct Whole(Yielding, [[f64; 2]; 4], Vec<([[f64; 4]; 2], f64)>);

impl ElementKernel<f64, 2, 4> for Whole {
    fn energy<T: Algebra<f64>>(&self, u: &[[T; 2]; 4]) -> T {
        fn combined<T: Algebra<f64>>(rows: &[[f64; 4]; 2], v: &[[T; 2]; 4]) -> [[T; 2]; 2] {
            let term = |k: usize, c: usize, i: usize| v[i][c].times(rows[k][i]);
            let sum = |k, c| (0..4).fold(T::zero(), |g, i| g + term(k, c, i));
            [0, 1].map(|k| [0, 1].map(|c| sum(k, c)))
        }
        let mut energy = T::zero();
        for (rows, weight) in &self.2 {
            let density = self.0.density(&combined(rows, &self.1), &combined(rows, u));
            energy += density.times(*weight);
        }
        energy
    }
}

#[test]
fn an_energy_of_the_whole_element_is_enough() {
    let law = Yielding(1e6, 10.0, 4.0);
    let (frame, disk) = ([[0.6, 0.8], [-0.8, 0.6]], Disk::new(0.01).unwrap());
    let reference = Reference::straight(&Cable, 0.3, frame);
    let rule = gauss_legendre::<f64>(3).unwrap();
    let points = rule.iter().map(|([x], weight)| {
        let samples = [Sample::First(0), Sample::Second(0, 0)];
        let rows = samples.map(|s| s.of(&Cable, 0.3, [x, 0.0]));
        (rows, weight * 0.3)
    });
    let whole = Whole(law, reference.vectors, points.collect());
    let sampled = law.kernel(&Cable, &reference, &disk).unwrap();
    let u: [[f64; 2]; 4] = std::array::from_fn(|i| [0.02, 0.03].map(|c| c * (i as f64).sin()));
    let (mut q, mut k) = ([[[0.0; 2]; 4]; 2], [[[[[0.0; 2]; 4]; 2]; 4]; 2]);
    whole.tangent(&u, &mut q[0], &mut k[0]);
    sampled.tangent(&u, &mut q[1], &mut k[1]);
    let close = |a: &[f64], b: &[f64]| {
        let size = b.iter().fold(0.0_f64, |top, b| top.max(b.abs()));
        let error = a.iter().zip(b).map(|(a, b)| (a - b).abs() / size);
        assert!(
            size > 0.0 && error.fold(0.0, f64::max) < 1e-13,
            "{a:?} {b:?}"
        );
    };
    close(q[0].as_flattened(), q[1].as_flattened());
    let [a, b] = k
        .each_ref()
        .map(|k| k.as_flattened().as_flattened().as_flattened());
    close(a, b);
    let report = verify::formulation(&Cable, &law, &disk, 0.1).unwrap();
    report.into_result().unwrap();
    // Pure bending: `M = EI k0 tanh(kappa / k0)` bends to an arc.
    let mut scene = Scene::<f64, 2>::new();
    let beam = Beam::new(Cable, disk, law).straight([0.0; 2], [1.0, 0.0], 16);
    let (beam, moment) = (scene.add(beam).unwrap(), [0.0, 0.0, 0.5 * 40.0]);
    scene.clamp(beam.start()).unwrap();
    let moment = Moment::new(moment, MomentLaw::SlopeRotation(0));
    scene.moment(beam.end(), moment).unwrap();
    let (system, curvature) = (scene.assemble().unwrap(), 4.0 * 0.5_f64.atanh());
    let mut state = system.rest();
    Statics::default().solve(&system, &mut state).unwrap();
    let tip = system.position(&state, beam.end()).unwrap()[1];
    let exact = (1.0 - curvature.cos()) / curvature;
    assert!((tip / exact - 1.0).abs() < 1e-5, "{tip}, not {exact}");
}
