//! Claims about the checks: what the library builds in passes every one of them, every family with
//! every formulation it works with, in both dimensions. What they catch is in `mutations.rs`.

use std::collections::BTreeSet;
use std::f64::consts::PI;

use ancf::formulation::{CableEnergy, Reference};
use ancf::prelude::*;
use ancf::verify::{self, ByEnergy, ByStress, Limit, Report, Rod, Scheme};

fn rubber<R: Real, const D: usize>() -> SaintVenantKirchhoff<R, D> {
    SaintVenantKirchhoff::isotropic(R::lit(2.0e7), R::lit(0.3)).unwrap()
}

fn assert_passes(report: Report) {
    assert!(report.rows().len() > 1);
    if let Err(error) = report.clone().into_result() {
        panic!("{error}\n{report}");
    }
}

/// An I profile with fillets of radius `r` (m).
fn filleted(r: f64) -> Outline<f64> {
    let (b, h, flange, web) = (0.02, 0.03, 0.024, 0.0025);
    let bulge = -(PI / 8.0).tan();
    let half = |side: f64, profile: Loop<f64>| {
        let at = |y: f64, z: f64| [side * y, side * z];
        profile
            .line_to(at(b, -h))
            .line_to(at(b, -flange))
            .line_to(at(web + r, -flange))
            .arc_to(at(web, r - flange), bulge)
            .line_to(at(web, flange - r))
            .arc_to(at(web + r, flange), bulge)
            .line_to(at(b, flange))
            .line_to(at(b, h))
    };
    Outline::new(half(-1.0, half(1.0, Loop::start([-b, -h])))).unwrap()
}

fn sections() -> Vec<Box<dyn Section<f64>>> {
    vec![
        Box::new(filleted(0.002)),
        Box::new(filleted(0.005)),
        Box::new(Disk::new(0.04).unwrap()),
        Box::new(Annulus::new(0.05, 0.03).unwrap()),
        Box::new(Rectangle::new(0.08, 0.03).unwrap()),
    ]
}

// What is built in passes.

#[test]
fn the_built_in_elements_pass() {
    for length in [0.01, 0.5, 30.0] {
        assert_passes(verify::element::<_, 2, 6>(&FullyParameterised, length));
        assert_passes(verify::element::<_, 3, 8>(&FullyParameterised, length));
        assert_passes(verify::element::<_, 2, 6>(&Quadratic, length));
        assert_passes(verify::element::<_, 3, 9>(&Quadratic, length));
        assert_passes(verify::element::<_, 2, 4>(&Cable, length));
        assert_passes(verify::element::<_, 3, 4>(&Cable, length));
    }
}

#[test]
fn the_built_in_formulations_pass() {
    fn remedies<const D: usize>() -> [Continuum<SaintVenantKirchhoff<f64, D>>; 4] {
        [
            Continuum::full(rubber()),
            Continuum::reduced(rubber()),
            Continuum::zero_poisson(rubber()),
            Continuum::selective_reduced(rubber()),
        ]
    }
    for section in sections() {
        for remedy in remedies::<2>() {
            let plane =
                verify::formulation::<_, _, _, 2, 6>(&FullyParameterised, &remedy, &section, 0.3);
            assert_passes(plane.unwrap());
        }
        for remedy in remedies::<3>() {
            let space =
                verify::formulation::<_, _, _, 3, 8>(&FullyParameterised, &remedy, &section, 0.3);
            assert_passes(space.unwrap());
        }
    }
}

/// The two other families: a cable has no direction in its section, hence the square.
#[test]
fn the_formulations_of_cable_and_quadratic_element_pass() {
    fn all<const D: usize, const P: usize, const Q: usize>()
    where
        FullyParameterised: Element<D, P>,
        Quadratic: Element<D, Q>,
        StructuralMechanics<f64>:
            Formulation<f64, FullyParameterised, D, P> + Formulation<f64, Quadratic, D, Q>,
        Continuum<SaintVenantKirchhoff<f64, D>>: Formulation<f64, Quadratic, D, Q>,
    {
        let cable = EulerBernoulli::new(&rubber::<f64, D>());
        let rod = StructuralMechanics::new(&rubber::<f64, D>()).with_shear_factors([0.85; 2]);
        for section in sections() {
            let passes = |report: Result<Report>| assert_passes(report.unwrap());
            for axial in [2, 3] {
                let solid = Continuum::selective_reduced(rubber::<f64, D>()).axial(axial);
                passes(verify::formulation::<_, _, _, D, Q>(
                    &Quadratic, &solid, &section, 0.3,
                ));
                let rod = rod.axial(axial);
                passes(verify::formulation::<_, _, _, D, Q>(
                    &Quadratic, &rod, &section, 0.3,
                ));
            }
            let full = Continuum::full(rubber::<f64, D>());
            passes(verify::formulation::<_, _, _, D, Q>(
                &Quadratic, &full, &section, 0.3,
            ));
            passes(verify::formulation::<_, _, _, D, P>(
                &FullyParameterised,
                &rod,
                &section,
                0.3,
            ));
        }
        let square = Rectangle::new(0.05, 0.05).unwrap();
        for section in [&square as &dyn Section<f64>, &Disk::new(0.04).unwrap()] {
            for energy in [
                CableEnergy::MaterialCurvature,
                CableEnergy::GeometricCurvature,
            ] {
                let cable = cable.with_energy(energy);
                let report = verify::formulation::<_, _, _, D, 4>(&Cable, &cable, &section, 0.3);
                assert_passes(report.unwrap());
            }
        }
    }
    all::<2, 6, 6>();
    all::<3, 8, 9>();
}

/// Energy, force and tangent of one kernel of every family against differences, in single and
/// double precision.
#[test]
fn derivatives_of_every_family_are_gradients_in_both_precisions() {
    fn curves<R, E, F, const D: usize, const S: usize>(element: E, formulation: F)
    where
        R: Real,
        E: Element<D, S>,
        F: Formulation<R, E, D, S>,
    {
        let length = R::lit(0.3);
        let axis = |a: usize, c: usize| if a == c { R::one() } else { R::zero() };
        let frame = std::array::from_fn(|a| std::array::from_fn(|c| axis(a, c)));
        let reference = Reference::straight(&element, length, frame);
        let disk = Disk::new(R::lit(0.04)).unwrap();
        let kernel = formulation.kernel(&element, &reference, &disk).unwrap();
        let units = std::array::from_fn(|i| match E::VECTORS[i % E::VECTORS.len()] {
            NodalVector::Position => length,
            NodalVector::Slope(_) => R::one(),
        });
        let u = std::array::from_fn(|i| {
            std::array::from_fn(|c| R::lit(0.1 * ((3 * i + c) as f64).sin()) * units[i])
        });
        for curve in [
            verify::energy_gradient(&kernel, &u, &units),
            verify::force_gradient(&kernel, &u, &units),
        ] {
            assert_passes(curve.unwrap().report(1e3));
        }
    }
    fn all<R: Real, const D: usize, const Q: usize>()
    where
        Quadratic: Element<D, Q>,
        StructuralMechanics<R>: Formulation<R, Quadratic, D, Q>,
        Continuum<SaintVenantKirchhoff<R, D>>: Formulation<R, Quadratic, D, Q>,
    {
        let rubber = rubber::<R, D>();
        curves::<R, _, _, D, 4>(Cable, EulerBernoulli::new(&rubber));
        curves::<R, _, _, D, Q>(Quadratic, StructuralMechanics::new(&rubber));
        curves::<R, _, _, D, Q>(Quadratic, Continuum::selective_reduced(rubber).axial(2));
    }
    all::<f64, 2, 6>();
    all::<f64, 3, 9>();
    all::<f32, 2, 6>();
    all::<f32, 3, 9>();
}

#[test]
fn zero_energy_modes_are_those_known() {
    let disk = Disk::new(0.04).unwrap();
    let report =
        verify::sampling::<_, _, _, 3, 8>(&FullyParameterised, &rubber::<f64, 3>(), &disk).unwrap();
    assert!(report.passed(), "{report}");
    // facts: axial orders below 3 and section order 1 never reach rank 18; order 1 leaves 3 modes.
    for row in report.rows() {
        let coarse = row.case.starts_with(['1', '2']) || row.case.ends_with("degree 1");
        assert_eq!(row.value > 0.0, coarse, "{report}");
    }
    let lone = report
        .rows()
        .iter()
        .find(|row| row.case == "5 axial, section degree 1");
    assert_eq!(lone.unwrap().value, 3.0);
    let plane =
        verify::sampling::<_, _, _, 2, 6>(&FullyParameterised, &rubber::<f64, 2>(), &disk).unwrap();
    assert_passes(plane);
    // The quadratic element needs two axial points, and a third is no more than enough.
    for report in [
        verify::sampling::<_, _, _, 3, 9>(&Quadratic, &rubber::<f64, 3>(), &disk),
        verify::sampling::<_, _, _, 2, 6>(&Quadratic, &rubber::<f64, 2>(), &disk),
    ] {
        let report = report.unwrap();
        assert!(report.passed(), "{report}");
        for row in report.rows() {
            let coarse = row.case.starts_with('1') || row.case.ends_with("degree 1");
            assert_eq!(row.value > 0.0, coarse, "{report}");
        }
    }
}

/// The same number of elements errs a hundred times less than the fully parameterised one. A cable
/// knows neither shear nor rotary inertia: on a slender beam it is Timoshenko's but for
/// `(mode pi r / L)^2 / 2`, 8e-5 for the second mode of a radius of gyration of 2 mm.
#[test]
fn frequencies_of_cable_and_quadratic_element_are_timoshenkos() {
    fn all<const D: usize, const Q: usize>()
    where
        Quadratic: Element<D, Q>,
        StructuralMechanics<f64>: Formulation<f64, Quadratic, D, Q>,
        Continuum<SaintVenantKirchhoff<f64, D>>: Formulation<f64, Quadratic, D, Q>,
    {
        let young = 2.0e7;
        let rod = Rod {
            length: 1.0,
            elements: 24,
            young,
            shear: young / 2.0,
            density: 7200.0,
            tolerance: 7e-5,
        };
        let solid = SaintVenantKirchhoff::<f64, D>::isotropic(young, 0.0).unwrap();
        for section in sections() {
            let continuum = Continuum::full(solid).axial(2);
            let report =
                verify::frequencies::<_, _, _, D, Q>(&Quadratic, &continuum, &section, &rod);
            assert_passes(report.unwrap());
            let structural = StructuralMechanics::new(&solid);
            let report =
                verify::frequencies::<_, _, _, D, Q>(&Quadratic, &structural, &section, &rod);
            assert_passes(report.unwrap());
        }
        let slender = Rod {
            shear: 1e6 * young,
            tolerance: 1e-4,
            ..rod
        };
        let cable = EulerBernoulli::new(&solid);
        let disk = Disk::new(0.004).unwrap();
        let report = verify::frequencies::<_, _, _, D, 4>(&Cable, &cable, &disk, &slender);
        assert_passes(report.unwrap());
    }
    all::<2, 6>();
    all::<3, 9>();
}

#[test]
fn frequencies_are_timoshenkos() {
    let young = 2.0e7;
    let rod = Rod {
        length: 1.0,
        elements: 24,
        young,
        shear: young / 2.0,
        density: 7200.0,
        tolerance: 7e-3, // piecewise constant curvature errs by (mode pi / 24)^2 / 24
    };
    for section in sections() {
        let solid = Continuum::full(SaintVenantKirchhoff::isotropic(young, 0.0).unwrap());
        let space =
            verify::frequencies::<_, _, _, 3, 8>(&FullyParameterised, &solid, &section, &rod);
        assert_passes(space.unwrap());
        let solid = Continuum::full(SaintVenantKirchhoff::isotropic(young, 0.0).unwrap());
        let plane =
            verify::frequencies::<_, _, _, 2, 6>(&FullyParameterised, &solid, &section, &rod);
        assert_passes(plane.unwrap());
    }
    // The second mode of this thick beam is 2 % below Euler's: the comparison sees the shear.
    let solid = Continuum::full(SaintVenantKirchhoff::isotropic(young, 0.0).unwrap());
    let disk = Disk::new(0.04).unwrap();
    let report =
        verify::frequencies::<_, _, _, 3, 8>(&FullyParameterised, &solid, &disk, &rod).unwrap();
    let over_euler = report
        .rows()
        .iter()
        .rfind(|row| row.limit == Limit::None)
        .unwrap();
    assert!(over_euler.value < 0.985, "{report}");
    // Poisson locking is seen.
    let locked = Continuum::full(rubber());
    let report =
        verify::frequencies::<_, _, _, 3, 8>(&FullyParameterised, &locked, &disk, &rod).unwrap();
    assert!(!report.passed(), "{report}");
}

#[test]
fn the_built_in_sections_pass() {
    for section in sections() {
        assert_passes(verify::section(&section, 9).unwrap());
    }
    assert_passes(verify::section(&Disk::new(0.04_f32).unwrap(), 7).unwrap());
    assert_passes(verify::section(&Annulus::new(0.05_f32, 0.03).unwrap(), 5).unwrap());
    assert_passes(verify::section(&Rectangle::new(0.05_f32, 0.03).unwrap(), 5).unwrap());
}

#[test]
fn the_built_in_material_passes() {
    fn all<R: Real, const D: usize>() {
        for poisson in [-0.5, 0.0, 0.3, 0.49] {
            let (young, poisson) = (R::lit(2.0e7), R::lit(poisson));
            let solid = SaintVenantKirchhoff::<R, D>::isotropic(young, poisson).unwrap();
            assert_passes(verify::material(&solid).and(verify::isotropy(&solid)));
            let small = verify::linear_elasticity(&solid, young, poisson).unwrap();
            assert!(small.passed(), "{small}");
            assert_passes(verify::material(&ByEnergy(solid)));
            assert_passes(verify::material(&ByStress(solid)));
        }
    }
    all::<f64, 2>();
    all::<f64, 3>();
    all::<f32, 2>();
    all::<f32, 3>();
}

/// Plane stress is no plane strain: the check of the constants knows the dimension.
#[test]
fn constants_are_checked_in_their_dimension() {
    let (e, nu) = (2.0e7_f64, 0.3);
    let plane = verify::linear_elasticity::<f64, _, 2>(&rubber(), e, nu).unwrap();
    assert!(plane.passed());
    let strain = SaintVenantKirchhoff::isotropic(e / (1.0 - nu * nu), nu / (1.0 - nu)).unwrap();
    let report = verify::linear_elasticity::<f64, _, 2>(&strain, e, nu).unwrap();
    assert!(!report.passed());
}

// Derivatives.

/// Smooth, of unit scale, with third and fifth derivatives of unit size.
struct Wave;

impl<R: Real> verify::Residual<R> for Wave {
    fn eval<T: Algebra<R>>(&self, x: &[T]) -> Vec<T> {
        vec![
            Field::exp(x[0]) * Field::sin(x[1]),
            Field::cos(x[0] * x[1]),
            Field::ln(x[0]) / x[1],
        ]
    }
}

/// The bottom of each V lies where truncation meets rounding, in both precisions.
#[test]
fn the_best_increment_is_the_root_of_machine_epsilon_that_theory_says() {
    fn check<R: Real>() {
        let curve = verify::jacobian(&Wave, &[R::lit(0.9), R::lit(1.1)]).unwrap();
        for scheme in Scheme::ALL {
            let [increment, error] = curve.best(scheme);
            let expected = scheme.expected_increment(R::EPSILON);
            assert!(
                (0.1..10.0).contains(&(increment / expected)),
                "{scheme:?}: {increment:e}\n{curve}"
            );
            // The V: at 100 times the best increment truncation grew by 100^order.
            let order = f64::from(scheme.order());
            assert!(
                error < 30.0 * R::EPSILON.powf(order / (order + 1.0)),
                "{error:e}\n{curve}"
            );
            let mut coarse = curve.points(scheme).filter(|p| p[0] > 30.0 * increment);
            let least = error * 30.0_f64.powf(order).min(100.0);
            assert!(coarse.all(|p| p[1] > 0.1 * least), "{scheme:?}\n{curve}");
            let mut fine = curve.points(scheme).filter(|p| p[0] < 1e-2 * increment);
            assert!(fine.all(|p| p[1] > 3.0 * error), "{scheme:?}\n{curve}");
        }
        assert_passes(curve.report(1e3));
    }
    check::<f64>();
    check::<f32>();
    let central = Scheme::Central.expected_increment(f64::EPSILON);
    assert!((central - 6.06e-6).abs() < 1e-8);
}

#[test]
fn the_tangent_of_a_system_is_the_gradient_of_its_forces() {
    fn system<R: Real>() -> verify::Curve {
        let mut scene = Scene::<R, 3>::new();
        let disk = Disk::new(R::lit(0.04)).unwrap();
        let beam = Beam::new(FullyParameterised, disk, Continuum::full(rubber()));
        let end = [R::one(), R::zero(), R::zero()];
        let beam = scene.add(beam.straight([R::zero(); 3], end, 2)).unwrap();
        scene.clamp(beam.start()).unwrap();
        let moment = R::lit(2e7 * PI * 0.04_f64.powi(4) / 4.0);
        scene.moment(beam.end(), Moment::about_z(moment)).unwrap();
        let system = scene.assemble().unwrap();
        let u: Vec<R> = (0..system.reference().len())
            .map(|i| R::lit(0.05 * (2.0 * i as f64 + 1.0).sin()))
            .collect();
        verify::structure_tangent(&system, R::zero(), &u).unwrap()
    }
    assert_passes(system::<f64>().report(1e3));
    assert_passes(system::<f32>().report(1e3));
}

// Reports.

/// Where a type leaves its derivatives to dual numbers there is nothing to compare them with, and the
/// report says so; closed forms are checked.
#[test]
fn derivatives_by_dual_numbers_alone_are_not_shown_as_checked() {
    let derived = |report: &Report| {
        let rows = report.rows().iter().filter(|r| r.limit == Limit::Derived);
        rows.map(|row| row.check).collect::<BTreeSet<_>>()
    };
    let solid = rubber::<f64, 3>();
    let closed = verify::material(&solid);
    let gradient = "stress against the gradient of the energy";
    assert!(!derived(&closed).contains(gradient), "{closed}");
    let stress = verify::material(&ByStress(solid));
    let elasticity = "elasticity against the gradient of the stress";
    assert!(derived(&stress).contains(elasticity), "{stress}");
    assert!(!derived(&stress).contains(gradient), "{stress}");
    let energy = verify::material(&ByEnergy(solid));
    assert!(derived(&energy).contains(gradient), "{energy}");
    assert!(derived(&energy).contains(elasticity), "{energy}");
    let text = energy.to_string();
    assert!(
        text.contains("derived") && text.contains("left out"),
        "{text}"
    );
    let line = text.lines().find(|line| line.contains(gradient)).unwrap();
    assert!(!line.contains("passed"), "{line}");

    let disk = Disk::new(0.04).unwrap();
    let solid = Continuum::full(solid);
    let closed = verify::formulation::<_, _, _, 3, 8>(&FullyParameterised, &solid, &disk, 0.3);
    let closed = closed.unwrap();
    assert!(derived(&closed).is_empty(), "{closed}");
}

#[test]
fn reports_read_as_tables_and_errors_name_the_rows() {
    let mut report = Report::new("a beam");
    report.push("weight", "first", 2.0, Limit::AtMost(1.0));
    report.push("length", "", f64::NAN, Limit::AtLeast(0.0));
    report.push("colour", "", 7.0, Limit::None);
    let text = report.to_string();
    assert!(
        text.contains("FAILED") && text.contains("0 of 2 checks passed"),
        "{text}"
    );
    let end = |line: &&str| line.contains("<= 1") || line.contains(">= 0");
    let ends: BTreeSet<usize> = text.lines().filter(end).map(str::len).collect();
    assert_eq!(ends.len(), 1, "columns line up: {text}");
    let error = report.into_result().unwrap_err().to_string();
    assert!(
        error.contains("weight (first) is 2, must be <= 1"),
        "{error}"
    );
    assert!(error.contains("length is NaN"), "{error}");
}
