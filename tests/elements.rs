//! Claims about the element families as beams: the cable against both published energies, the
//! quadratic element against Timoshenko's theory with one element, both against the elastica.

use ancf::analytical::Elastica;
use ancf::formulation::CableEnergy;
use ancf::prelude::*;

/// Tip displacement of a straight cantilever of `length` along x under a dead force along y. At
/// the clamp only `across` components of slopes are fixed for elements with an axial slope.
fn tip<E, F, const D: usize, const S: usize>(
    element: E,
    formulation: F,
    section: Rectangle<f64>,
    (length, force, n): (f64, f64, usize),
) -> [f64; D]
where
    E: Element<D, S>,
    F: Formulation<f64, E, D, S>,
{
    let along = |k: usize, size: f64| std::array::from_fn(|c| if c == k { size } else { 0.0 });
    let mut scene = Scene::<f64, D>::new();
    let beam = Beam::new(element, section, formulation).straight([0.0; D], along(0, length), n);
    let beam = scene.add(beam).unwrap();
    if E::VECTORS.contains(&NodalVector::Slope(0)) {
        // A clamp that lets the axis stretch and holds its direction.
        scene.pin(beam.start()).unwrap();
        let across = std::array::from_fn(|c| c > 0);
        scene
            .fix(beam.start(), NodalVector::Slope(0), across)
            .unwrap();
    } else {
        scene.clamp(beam.start()).unwrap();
    }
    scene.force(beam.end(), along(1, force)).unwrap();
    let system = scene.assemble().unwrap();
    let mut state = system.rest();
    let steps = if force.abs() > 1.0 { 10 } else { 1 };
    Statics::in_steps(steps).solve(&system, &mut state).unwrap();
    system.displacement(&state, beam.end()).unwrap()
}

fn steel<const D: usize>(poisson: f64) -> SaintVenantKirchhoff<f64, D> {
    SaintVenantKirchhoff::isotropic(2.07e11, poisson).unwrap()
}

/// Gerstmayr and Irschik (2008): L = 2 m, 0.1 m x 0.1 m, F = 3 E I / L^2.
fn gerstmayr_irschik<const D: usize>(energy: CableEnergy, n: usize) -> [f64; 2]
where
    Cable: Element<D, 4>,
{
    let section = Rectangle::new(0.1, 0.1).unwrap();
    let force = 3.0 * 2.07e11 * 1e-4 / 12.0 / 4.0;
    let formulation = EulerBernoulli::new(&steel::<D>(0.3)).with_energy(energy);
    let u: [f64; D] = tip(Cable, formulation, section, (2.0, force, n));
    [-u[0], u[1]]
}

/// Both published figures are right, each for its energy; boundary-value problems solved to ten
/// digits by an independent code. The error falls with the fourth power of the element length.
#[test]
fn the_cable_meets_both_published_energies_to_nine_digits() {
    for (energy, exact) in [
        (
            CableEnergy::MaterialCurvature,
            [0.508537304326, 1.20723985455],
        ),
        (
            CableEnergy::GeometricCurvature,
            [0.5089228704, 1.2083981311],
        ),
    ] {
        let error = |n| {
            let u = gerstmayr_irschik::<2>(energy, n);
            (u[0] - exact[0]).abs().max((u[1] - exact[1]).abs())
        };
        let errors = [16, 32, 128].map(error);
        assert!(errors[1] < errors[0] / 12.0, "{energy:?}: {errors:?}");
        assert!(errors[2] < 5e-10, "{energy:?}: {errors:?}");
        let plane = gerstmayr_irschik::<2>(energy, 8);
        let space = gerstmayr_irschik::<3>(energy, 8);
        for c in 0..2 {
            assert!((plane[c] - space[c]).abs() < 1e-9, "{plane:?} {space:?}");
        }
    }
}

/// The figures of the same element in another code, element count by element count.
#[test]
fn the_cable_agrees_with_another_code_on_coarse_meshes() {
    for (n, exact) in [
        (1, [0.362244729890507, 0.994144758724975]),
        (4, [0.507428715455792, 1.20553370256025]),
        (16, [0.508536579914956, 1.20723889500359]),
    ] {
        let u = gerstmayr_irschik::<2>(CableEnergy::MaterialCurvature, n);
        for c in 0..2 {
            assert!(
                (u[c] - exact[c]).abs() < 1e-9,
                "{n} elements: {u:?} not {exact:?}"
            );
        }
    }
}

/// Timoshenko's tip with one element, slender and stocky, in both dimensions; with a third axial
/// point one element bends a quarter too little.
#[test]
fn one_quadratic_element_with_two_axial_points_is_a_timoshenko_beam() {
    let nu = 0.3;
    for height in [0.1, 0.01, 0.001_f64] {
        let young = 2.07e11;
        let section = Rectangle::new(height, height).unwrap();
        let (area, second) = (height * height, height.powi(4) / 12.0);
        let force = 1e-6 * young * second;
        let shear = young / (2.0 * (1.0 + nu)) * area;
        let exact = force / (3.0 * young * second) + force / shear;
        let space = |axial| {
            let remedy = Continuum::selective_reduced(steel::<3>(nu)).axial(axial);
            tip::<_, _, 3, 9>(Quadratic, remedy, section, (1.0, force, 1))[1] / exact
        };
        let plane = |axial| {
            let remedy = Continuum::selective_reduced(steel::<2>(nu)).axial(axial);
            tip::<_, _, 2, 6>(Quadratic, remedy, section, (1.0, force, 1))[1] / exact
        };
        for ratio in [space(2), plane(2)] {
            assert!((ratio - 1.0).abs() < 1e-5, "h = {height}: {ratio}");
        }
        for ratio in [space(3), plane(3)] {
            assert!(
                height > 0.05 || (ratio - 0.75).abs() < 1e-3,
                "h = {height}: {ratio}"
            );
        }
    }
}

/// Mattiasson's cantilever: nearly inextensible and shear-rigid beams follow the elastica.
#[test]
fn cable_and_quadratic_element_follow_the_elastica() {
    let height = 2e-3_f64;
    let section = Rectangle::new(height, height).unwrap();
    let bending = 2.07e11 * height.powi(4) / 12.0;
    for load in [1.0, 5.0, 10.0] {
        let exact = Elastica::under_transverse_load(load).unwrap();
        let case = (1.0, load * bending, 32);
        let solid = Continuum::selective_reduced(steel::<2>(0.3)).axial(2);
        for u in [
            tip::<_, _, 2, 4>(Cable, EulerBernoulli::new(&steel::<2>(0.3)), section, case),
            tip::<_, _, 2, 6>(Quadratic, solid, section, case),
            tip::<_, _, 2, 6>(
                Quadratic,
                StructuralMechanics::new(&steel::<2>(0.3)),
                section,
                case,
            ),
        ] {
            let error = (u[1] - exact.deflection)
                .abs()
                .max((u[0] + exact.shortening).abs());
            assert!(error < 5e-5, "load {load}: {u:?}, off by {error}");
        }
    }
}

/// What a cable cannot tell apart it refuses, and says what to do.
#[test]
fn a_cable_in_space_refuses_a_section_with_two_stiffnesses() {
    let flat = Rectangle::new(0.02, 0.01).unwrap();
    let beam = || Beam::new(Cable, flat, EulerBernoulli::new(&steel::<3>(0.3)));
    let mut scene = Scene::<f64, 3>::new();
    let refused = scene.add(beam().straight([0.0; 3], [1.0, 0.0, 0.0], 4));
    let message = refused.unwrap_err().to_string();
    assert!(
        message.contains("Iyy = Izz") && message.contains("with_stiffness"),
        "{message}"
    );
    let given = EulerBernoulli::with_stiffness(1e6, 1e2).unwrap();
    let beam = Beam::new(Cable, flat, given).straight([0.0; 3], [1.0, 0.0, 0.0], 4);
    scene.add(beam).unwrap();
    assert!(EulerBernoulli::with_stiffness(1e6, -1.0).is_err());
    assert!(EulerBernoulli::with_stiffness(f64::NAN, 1.0).is_err());
}

/// Too few axial points leave zero-energy modes; the refusal counts them. A cable in space has
/// five rigid motions, for it cannot turn about its axis.
#[test]
fn sampling_that_leaves_zero_energy_modes_is_refused() {
    let square = Rectangle::new(0.02, 0.02).unwrap();
    let mut scene = Scene::<f64, 3>::new();
    for (stretching, bending, enough) in [(5, 3, true), (3, 2, true), (5, 1, false), (2, 3, false)]
    {
        let rule = EulerBernoulli::new(&steel::<3>(0.3)).sampled(stretching, bending);
        let beam = Beam::new(Cable, square, rule).straight([0.0; 3], [1.0, 0.0, 0.0], 4);
        let made = scene.add(beam);
        assert_eq!(made.is_ok(), enough, "{stretching}, {bending}: {made:?}");
        if let Err(error) = made {
            assert!(
                matches!(error, Error::ZeroEnergyModes { target: 7, .. }),
                "{error}"
            );
        }
    }
    for (axial, enough) in [(1, false), (2, true), (3, true)] {
        let rule = Continuum::selective_reduced(steel::<3>(0.3)).axial(axial);
        let beam = Beam::new(Quadratic, square, rule).straight([0.0; 3], [1.0, 0.0, 0.0], 4);
        let made = scene.add(beam);
        assert_eq!(made.is_ok(), enough, "{axial} axial points");
        if let Err(error) = made {
            assert!(
                matches!(error, Error::ZeroEnergyModes { target: 21, .. }),
                "{error}"
            );
        }
    }
}
