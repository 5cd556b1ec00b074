//! Every bad input gives a typed error whose text names the value and says what to do; none
//! panics, and none is answered by a number.

use ancf::analytical::{BendingSection, Elastica, EndMoment, pure_bending};
use ancf::formulation::{Layer, Reference};
use ancf::prelude::*;
use ancf::quadrature::{Cubature, disk_order, gauss_legendre, gauss_radau};
use ancf::solver::{BandMatrix, Factor, Profile};

type Steel = SaintVenantKirchhoff<f64, 3>;
type Formula = Continuum<Steel>;

/// The error's text, which must hold all of `parts`.
#[track_caller]
fn names<T>(result: Result<T>, parts: &[&str]) {
    let Err(error) = result else {
        panic!("accepted, but should name {parts:?}");
    };
    let text = error.to_string();
    for part in parts {
        assert!(text.contains(part), "`{text}` does not name `{part}`");
    }
}

fn steel() -> Steel {
    Steel::isotropic(2e11, 0.3).unwrap()
}

fn beam() -> Beam<f64, FullyParameterised, Formula, Disk<f64>, 3> {
    let disk = Disk::new(0.01).unwrap();
    Beam::new(FullyParameterised, disk, Continuum::full(steel()))
        .straight([0.0; 3], [1.0, 0.0, 0.0], 4)
        .density(7800.0)
}

fn scene() -> (Scene<f64, 3>, Placed) {
    let mut scene = Scene::new();
    let placed = scene.add(beam()).unwrap();
    (scene, placed)
}

#[test]
fn material_constants() {
    for young in [f64::NAN, f64::INFINITY, 0.0, -1.0] {
        names(
            Steel::isotropic(young, 0.3),
            &["Young's modulus", &young.to_string()],
        );
    }
    for poisson in [f64::NAN, 0.5, 0.7, -1.0, f64::NEG_INFINITY] {
        names(
            Steel::isotropic(1.0, poisson),
            &[
                "Poisson ratio",
                &poisson.to_string(),
                "(-1, 0.5)",
                "below 0.5",
            ],
        );
    }
}

#[test]
fn section_sizes() {
    for size in [f64::NAN, f64::INFINITY, 0.0, -0.01] {
        names(
            Disk::new(size),
            &["radius", &size.to_string(), "above zero"],
        );
        names(Rectangle::new(size, 1.0), &[&size.to_string()]);
        names(Rectangle::new(1.0, size), &[&size.to_string()]);
        names(Annulus::new(size, 0.1), &[&size.to_string()]);
    }
    names(Annulus::new(0.1, 0.2), &["0.2"]);
    names(Annulus::new(0.1, 0.1), &["0.1"]);
    names(Annulus::new(0.1, 0.0), &["Disk"]);
}

#[test]
fn geometry_of_a_beam() {
    let add = |beam| Scene::<f64, 3>::new().add(beam);
    names(
        add(beam().straight([0.0; 3], [0.0; 3], 4)),
        &["length of a beam", "0"],
    );
    names(
        add(beam().straight([0.0; 3], [f64::NAN, 0.0, 0.0], 4)),
        &["end", "NaN"],
    );
    names(
        add(beam().straight([f64::INFINITY; 3], [0.0; 3], 4)),
        &["end", "inf"],
    );
    names(
        add(beam().straight([0.0; 3], [1.0, 0.0, 0.0], 0)),
        &["number of elements", "0", "at least one"],
    );
    names(
        add(beam().straight([0.0; 3], [1.0, 0.0, 0.0], usize::MAX)),
        &["number of elements", "[1, 1e8]", "memory"],
    );
    names(
        add(beam().up([2.0, 0.0, 0.0])),
        &["up direction", "parallel", "across"],
    );
    names(add(beam().up([0.0; 3])), &["up direction", "zero"]);
    names(
        add(beam().up([f64::NAN, 0.0, 0.0])),
        &["up direction", "NaN"],
    );
    let disk = Disk::new(0.01).unwrap();
    let lineless = Beam::new(FullyParameterised, disk, Continuum::full(steel()));
    names(add(lineless), &["without an axis", "Beam::straight"]);
    for density in [f64::NAN, 0.0, -7800.0] {
        names(
            add(beam().density(density)),
            &["density", &density.to_string()],
        );
    }
}

#[test]
fn integration_orders() {
    let add = |rule| {
        let disk = Disk::new(0.01).unwrap();
        let beam = Beam::new(FullyParameterised, disk, rule);
        Scene::<f64, 3>::new().add(beam.straight([0.0; 3], [1.0, 0.0, 0.0], 1))
    };
    names(add(Continuum::sampled(steel(), 0, 5)), &["0"]);
    names(
        add(Continuum::sampled(steel(), 2, 5)),
        &["zero-energy modes", "3 axial points"],
    );
    names(
        add(Continuum::sampled(steel(), 5, 1)),
        &["15 of 18", "degree 3"],
    );
    names(add(Continuum::sampled(steel(), 5, 100_000)), &["256"]);
    names(add(Continuum::layered([])), &["layers", "0"]);
    // The coupled part alone has no stiffness in shear.
    let part = Layer {
        material: steel().coupled(),
        axial: 5,
        across: Across::Degree(5),
    };
    names(
        add(Continuum::layered([part])),
        &["zero-energy modes", "stiffness"],
    );
    names(gauss_legendre::<f64>(0), &["0"]);
    names(gauss_radau::<f64>(0), &["0"]);
    names(disk_order::<f64>(0), &["0"]);
    names(Cubature::<f64, 2>::new(vec![], vec![], 1), &["0"]);
    names(Cubature::new(vec![[0.0]], vec![f64::NAN], 1), &["NaN"]);
}

#[test]
fn scenes_that_cannot_be_assembled() {
    names(Scene::<f64, 3>::new().assemble(), &["no beam", "add"]);
    let disk = Disk::new(0.01).unwrap();
    let light = || {
        Beam::new(FullyParameterised, disk, Continuum::full(steel())).straight(
            [0.0; 3],
            [1.0, 0.0, 0.0],
            1,
        )
    };
    let mut weightless = Scene::<f64, 3>::new();
    weightless.add(light()).unwrap();
    weightless.gravity([0.0, -9.81, 0.0]).unwrap();
    names(
        weightless.assemble(),
        &["gravity", "without density", "Beam::density"],
    );
    let (mut mixed, _) = scene();
    mixed.add(light()).unwrap();
    names(mixed.assemble(), &["density", "every beam"]);
}

#[test]
fn supports_and_loads() {
    let (mut scene, beam) = scene();
    names(scene.clamp(beam.node(5)), &["5 nodes", "no node 5"]);
    names(scene.pin(beam.node(99)), &["no node 99"]);
    names(
        scene.fix(beam.start(), NodalVector::Slope(3), [true; 3]),
        &["Slope(3)", "choose a nodal vector"],
    );
    names(scene.gravity([0.0, f64::NAN, 0.0]), &["gravity", "NaN"]);
    names(
        scene.force(beam.end(), [f64::INFINITY, 0.0, 0.0]),
        &["force", "inf"],
    );
    names(scene.force(beam.node(7), [0.0; 3]), &["no node 7"]);
    names(
        scene.moment(beam.end(), Moment::about_z(f64::NAN)),
        &["moment", "NaN"],
    );
    let torsion = Moment::new([2.5, 0.0, 0.0], MomentLaw::TangentTraction);
    names(
        scene.moment(beam.end(), torsion),
        &["2.5", "axis 0", "MeanRotation"],
    );
    let slope = Moment::new([0.0, 0.0, 1.0], MomentLaw::SlopeRotation(3));
    names(scene.moment(beam.end(), slope), &["slope 3", "D - 1"]);
    let mut plane = Scene::<f64, 2>::new();
    let disk = Disk::new(0.01).unwrap();
    let solid = SaintVenantKirchhoff::isotropic(2e11, 0.3).unwrap();
    let flat = Beam::new(FullyParameterised, disk, Continuum::full(solid));
    let flat = plane.add(flat.straight([0.0; 2], [1.0, 0.0], 1)).unwrap();
    let tilted = Moment::new([1.5, 0.0, 1.0], MomentLaw::SlopeRotation(1));
    names(
        plane.moment(flat.end(), tilted),
        &["in-plane components", "1.5"],
    );
}

#[test]
fn mechanisms_in_statics() {
    for (pin, load) in [
        (false, [0.0, 1.0, 0.0]),
        (false, [1.0, 0.0, 0.0]),
        (true, [0.0, 1.0, 0.0]),
    ] {
        let (mut scene, beam) = scene();
        if pin {
            scene.pin(beam.start()).unwrap();
        }
        scene.force(beam.end(), load).unwrap();
        let system = scene.assemble().unwrap();
        let mut state = system.rest();
        let result = Statics::default().solve(&system, &mut state);
        // Rounding may hold a pinned beam by a hair; then the size of its motion gives it away.
        if pin {
            names(result, &["supports"]);
        } else {
            names(
                result,
                &["nothing holds", "of node 4 of beam 0", "add supports"],
            );
        }
        assert_eq!(state, system.rest(), "the last good state is kept");
    }
}

#[test]
fn loads_no_beam_can_carry() {
    for load in [[0.0, 1e30, 0.0], [-1e9, 0.0, 0.0]] {
        let (mut scene, beam) = scene();
        scene.clamp(beam.start()).unwrap();
        scene.force(beam.end(), load).unwrap();
        let system = scene.assemble().unwrap();
        let mut state = system.rest();
        let result = Statics::default().solve(&system, &mut state);
        names(result, &["of the load", "last equilibrium is kept"]);
        assert!(state.displacement.iter().all(|u| u.is_finite()));
    }
}

/// Beyond the limit of St Venant-Kirchhoff in compression there are solutions, turned inside out.
#[test]
fn inverted_beams_are_no_answer() {
    let (mut scene, beam) = scene();
    scene.clamp(beam.start()).unwrap();
    scene.force(beam.end(), [-1e9, 0.0, 0.0]).unwrap();
    let system = scene.assemble().unwrap();
    let mut state = system.rest();
    let direct = Statics {
        cutbacks: 0,
        ..Statics::default()
    };
    names(
        direct.solve(&system, &mut state),
        &["inside out", "volume ratio"],
    );
}

#[test]
fn solver_settings() {
    let (mut scene, beam) = scene();
    scene.clamp(beam.start()).unwrap();
    let system = scene.assemble().unwrap();
    let solve = |statics: Statics| statics.solve(&system, &mut system.rest());
    names(solve(Statics::in_steps(0)), &["load steps", "0"]);
    let mut statics = Statics::default();
    statics.newton.residual = f64::NAN;
    names(solve(statics), &["residual tolerance", "NaN"]);
    statics.newton.residual = -1.0;
    names(solve(statics), &["residual tolerance", "-1"]);
    statics.newton = Newton {
        correction: 0.0,
        ..Newton::default()
    };
    names(solve(statics), &["correction tolerance", "0"]);
    statics.newton = Newton {
        iterations: 0,
        ..Newton::default()
    };
    names(solve(statics), &["Newton iterations", "0"]);
    let mut short = system.rest();
    short.displacement.pop();
    names(
        Statics::default().solve(&system, &mut short),
        &["displacements", "59", "60"],
    );
    let mut broken = system.rest();
    broken.displacement[3] = f64::NAN;
    names(
        Statics::default().solve(&system, &mut broken),
        &["displacement", "NaN"],
    );
}

#[test]
fn time_steps() {
    let (mut scene, beam) = scene();
    scene.clamp(beam.start()).unwrap();
    scene.force(beam.end(), [0.0, 1.0, 0.0]).unwrap();
    let system = scene.assemble().unwrap();
    let start = |method: Newmark| Integration::start(&system, system.rest(), &method);
    let mut run = start(Newmark::trapezoidal()).unwrap();
    for step in [0.0, -1e-3, f64::NAN, f64::INFINITY] {
        let parts: &[&str] = &["time step", &step.to_string()];
        names(run.until(1.0, Stepping::Fixed(step), |_| {}), parts);
        names(run.step(step), parts);
    }
    names(
        run.until(f64::NAN, Stepping::Fixed(1e-3), |_| {}),
        &["end of the run", "NaN"],
    );
    names(
        run.until(-1.0, Stepping::Fixed(1e-3), |_| {}),
        &["end of the run", "-1"],
    );
    let adaptive = |change: fn(&mut Adaptive)| {
        let mut control = Adaptive::to(1e-4);
        change(&mut control);
        Stepping::Adaptive(control)
    };
    names(
        run.until(1.0, adaptive(|c| c.tolerance = 0.0), |_| {}),
        &["tolerance", "0"],
    );
    names(
        run.until(1.0, adaptive(|c| c.first = -1.0), |_| {}),
        &["first time step", "-1"],
    );
    names(
        run.until(1.0, adaptive(|c| c.safety = f64::NAN), |_| {}),
        &["safety", "NaN"],
    );
    let result = run.until(
        1.0,
        adaptive(|c| {
            c.tolerance = 1e-14;
            c.shortest = 1e-6;
        }),
        |_| {},
    );
    names(result, &["below the limit", "loosen the tolerance"]);
    for (beta, gamma) in [(0.0, 0.5), (f64::NAN, 0.5), (0.25, 0.3), (2.0, 0.5)] {
        let mut method = Newmark::trapezoidal();
        (method.beta, method.gamma) = (beta, gamma);
        names(start(method), &["Newmark's", "trapezoidal"]);
    }
    let mut state = system.rest();
    state.velocity[0] = f64::INFINITY;
    names(
        Integration::start(&system, state, &Newmark::default()),
        &["velocity", "inf"],
    );
}

#[test]
fn dynamics_without_mass() {
    let mut scene = Scene::<f64, 3>::new();
    let disk = Disk::new(0.01).unwrap();
    let light = Beam::new(FullyParameterised, disk, Continuum::full(steel()));
    scene
        .add(light.straight([0.0; 3], [1.0, 0.0, 0.0], 1))
        .unwrap();
    let system = scene.assemble().unwrap();
    let result = Integration::start(&system, system.rest(), &Newmark::default());
    names(result, &["without mass", "Beam::density"]);
}

#[test]
fn matrices() {
    names(Profile::from_ranges(3, [0..4]), &["0..4", "3"]);
    names(Profile::from_ranges(3, [1..1]), &["1..1"]);
    let profile = Profile::from_ranges(2, [0..2]).unwrap();
    let mut matrix = BandMatrix::<f64>::symmetric(&profile);
    names(matrix.add(5, 0, 1.0), &["(5, 0)"]);
    let mut factor = Factor::new(&profile, true);
    names(
        factor.solve(&mut [1.0, 1.0]),
        &["without factors", "factor"],
    );
    names(
        factor.factor(&matrix),
        &["singular", "unknown 0", "supports"],
    );
    matrix.add(0, 0, f64::NAN).unwrap();
    names(factor.factor(&matrix), &["NaN"]);
}

#[test]
fn analytical_solutions() {
    let section = BendingSection::disk(2e11, 0.02);
    names(
        pure_bending(&section, f64::NAN, EndMoment::Conjugate),
        &["NaN"],
    );
    names(
        pure_bending(&section, 1e12, EndMoment::Conjugate),
        &["397887", "reduce the moment"],
    );
    names(Elastica::under_transverse_load(f64::NAN), &["NaN"]);
}

#[test]
fn states_of_another_system() {
    let (scene, beam) = scene();
    let system = scene.assemble().unwrap();
    let mut short = system.rest();
    short.displacement.truncate(7);
    names(system.position(&short, beam.end()), &["7", "60"]);
    names(system.displacement(&short, beam.end()), &["7", "60"]);
    names(
        system.point(&short, beam.end(), 0.5, [0.0; 3]),
        &["7", "60"],
    );
    names(system.energies(&short), &["7", "60"]);
    names(
        system.set_rigid_velocity(&mut short, [0.0; 3], [0.0; 3]),
        &["7", "60"],
    );
    names(
        system.point(&system.rest(), beam.end(), f64::NAN, [0.0; 3]),
        &["NaN"],
    );
    let mut state = system.rest();
    names(
        system.set_rigid_velocity(&mut state, [f64::NAN, 0.0, 0.0], [0.0; 3]),
        &["NaN"],
    );
    let method = Newmark::trapezoidal();
    let mut run = Integration::start(&system, system.rest(), &method).unwrap();
    let result = run.until(1e-3, Stepping::Fixed(1e-3), |step| {
        step.displacement_at(step.after.time, 60).map(|_| ())
    });
    names(result, &["no coordinate 60", "60"]);
}

/// Sizes at the ends of the number range are refused by name, not answered with a wrong rank or
/// an endless loop.
#[test]
fn sizes_beyond_the_number_range() {
    names(Steel::isotropic(1e308, 0.4999), &["modulus", "inf"]);
    let disk = Disk::new(1e-100).unwrap();
    let beam = Beam::new(FullyParameterised, disk, Continuum::full(steel()));
    let result = Scene::<f64, 3>::new().add(beam.straight([0.0; 3], [1.0, 0.0, 0.0], 1));
    names(result, &["second moment", "0"]);
}

/// Along its own slope a moment could do no work and would be lost.
#[test]
fn moments_that_a_law_cannot_carry() {
    let (mut scene, beam) = scene();
    for law in [MomentLaw::SlopeRotation(1), MomentLaw::FollowerCouple(1)] {
        let lost = Moment::new([0.0, 12.5, 0.0], law);
        names(
            scene.moment(beam.end(), lost),
            &["12.5", "axis 1", "another slope"],
        );
    }
}

/// What would sample it is not compiled.
#[test]
fn materials_that_are_constant_and_give_no_moduli() {
    #[derive(Debug, Clone)]
    struct Vague(Steel);
    impl Material<f64, 3> for Vague {
        const CONSTANT: bool = true;

        fn energy<T: Algebra<f64>>(&self, strain: &[[T; 3]; 3]) -> T {
            self.0.energy(strain)
        }
    }
    let vague = Continuum::full(Vague(steel()));
    let beam = Beam::new(FullyParameterised, Disk::new(0.1).unwrap(), vague);
    let result = Scene::<f64, 3>::new().add(beam.straight([0.0; 3], [1.0, 0.0, 0.0], 1));
    names(
        result,
        &["Vague", "constant_elasticity", "Material::CONSTANT"],
    );
}

/// A frame for it is not compiled.
#[test]
fn formulations_that_do_not_tell_how_their_kernels_turn() {
    #[derive(Debug, Clone)]
    struct Silent(Formula);
    impl Formulation<f64, FullyParameterised, 3, 8> for Silent {
        type Kernel = <Formula as Formulation<f64, FullyParameterised, 3, 8>>::Kernel;

        fn kernel(
            &self,
            element: &FullyParameterised,
            reference: &Reference<f64, 3, 8>,
            section: &dyn Section<f64>,
        ) -> Result<Self::Kernel> {
            self.0.kernel(element, reference, section)
        }
    }
    let turned = CoMoving(Silent(Continuum::full(steel())));
    let beam = Beam::new(FullyParameterised, Disk::new(0.1).unwrap(), turned);
    let result = Scene::<f64, 3>::new().add(beam.straight([0.0; 3], [1.0, 0.0, 0.0], 1));
    names(result, &["Silent", "turning_kernel"]);
}

#[test]
fn nodes_of_another_scene() {
    let (_, stranger) = scene();
    let (mut scene, _) = scene();
    names(scene.clamp(stranger.start()), &["another scene", "handle"]);
    names(scene.force(stranger.end(), [0.0; 3]), &["another scene"]);
    let system = scene.assemble().unwrap();
    names(
        system.position(&system.rest(), stranger.end()),
        &["another scene"],
    );
}

/// A program whose `main` returns the error shows its message.
#[test]
fn debug_prints_the_message() {
    let error = Disk::new(-1.0).unwrap_err();
    assert_eq!(format!("{error:?}"), error.to_string());
}
