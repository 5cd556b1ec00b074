//! Claims about structural mechanics: published cantilevers of Nachbagauer, the Princeton beam and
//! stiffness by constants, against boundary-value problems solved to ten digits by independent
//! codes.

use ancf::prelude::*;

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
        (6.25e7, 0.849673, [0.150971144239, 0.710568597854]),
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

/// The Princeton beam, bent about both axes and twisted by its own tip load: a geometrically exact
/// rod with the torsion constant of St Venant, at the largest load. The reference states `GJ` to
/// five digits.
#[test]
fn the_princeton_beam_twists_as_it_bends() {
    let aluminium = SaintVenantKirchhoff::<f64, 3>::isotropic(71.7e9, 0.31).unwrap();
    let section = Rectangle::new(12.377e-3, 3.2024e-3).unwrap();
    for (angle, exact) in [
        (
            15.0_f64,
            [-5.298375171e-03, -1.650289204e-02, 6.449630947e-02],
        ),
        (45.0, [-3.036111446e-02, -1.534225758e-02, 1.565878233e-01]),
        (75.0, [-4.807460916e-02, -6.328438282e-03, 1.961247073e-01]),
    ] {
        let rule = StructuralMechanics::new(&aluminium)
            .with_shear_factors([5.0 / 6.0; 2])
            .with_torsion(3.1033);
        let (s, c) = angle.to_radians().sin_cos();
        let force = [0.0, -13.345 * c, 13.345 * s];
        let u = tip::<_, 3, 9>(rule, section, (0.508, force, 16));
        for i in 0..3 {
            let error = (u[i] - exact[i]).abs();
            assert!(
                error < 3e-5 * exact[i].abs(),
                "{angle} degrees: {u:?} not {exact:?}"
            );
        }
        // The torsion constant is felt: with I_y + I_z the beam twists ten times less.
        let stiff = rule.with_torsion(
            71.7e9 / 2.62 * 12.377e-3 * 3.2024e-3 / 12.0
                * (12.377e-3_f64.powi(2) + 3.2024e-3_f64.powi(2)),
        );
        let other = tip::<_, 3, 9>(stiff, section, (0.508, force, 16));
        assert!(
            (other[1] - exact[1]).abs() > 1e-2 * exact[1].abs(),
            "{other:?}"
        );
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
        system.set_rigid_velocity(&mut state, [0.0; 3], omega);
        let kinetic = system.energies(&state).kinetic;
        assert!(
            (kinetic - 0.5 * inertia).abs() < 1e-12,
            "{omega:?}: {kinetic}"
        );
    }
    let degree = Section::<f64>::rule(&Moments::new(2.0, 7.0, 5.0).unwrap(), 4);
    assert!(degree.is_err());
}
