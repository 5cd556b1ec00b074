//! Claims about the checks: what the library builds in passes every one of them, and a wrong
//! element, section, material or tangent fails the check that is meant for it.

use std::collections::BTreeSet;
use std::f64::consts::PI;

use ancf::element::NodalVector;
use ancf::formulation::{ElementKernel, Reference, Tangent};
use ancf::material::{Blocks, Tensor};
use ancf::prelude::*;
use ancf::quadrature::Cubature;
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

/// Names of the checks that failed.
fn failures(report: &Report) -> BTreeSet<&'static str> {
    report.failed().map(|row| row.check).collect()
}

fn assert_fails(report: &Report, only: &[&'static str]) {
    assert_eq!(failures(report), only.iter().copied().collect(), "{report}");
    assert!(report.clone().into_result().is_err());
}

fn sections() -> Vec<Box<dyn Section<f64>>> {
    vec![
        Box::new(Disk::new(0.04).unwrap()),
        Box::new(Annulus::new(0.05, 0.03).unwrap()),
        Box::new(Rectangle::new(0.08, 0.03).unwrap()),
    ]
}

// What is built in passes.

#[test]
fn the_built_in_element_passes() {
    for length in [0.01, 0.5, 30.0] {
        assert_passes(verify::element::<_, 2, 6>(&FullyParameterised, length));
        assert_passes(verify::element::<_, 3, 8>(&FullyParameterised, length));
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
    assert_fails(&report, &["frequency against Timoshenko's"]);
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

// Wrong elements.

/// The planar built-in element with one coefficient off.
#[derive(Debug, Clone, Copy)]
enum Wrong {
    /// A position function that is not one at its node.
    Position,
    /// A slope function of the right values and the wrong slope at the far node.
    Slope,
    /// A cross slope that reaches into the neighbour.
    Cross,
    /// A bubble on a position function: right at the nodes, wrong between them.
    Bubble,
}

impl Element<2, 6> for Wrong {
    const NODES: usize = 2;
    const VECTORS: &'static [NodalVector] = &[
        NodalVector::Position,
        NodalVector::Slope(0),
        NodalVector::Slope(1),
    ];
    const AXIAL_DEGREE: usize = 4;

    fn shape<T: Scalar>(&self, l: T, xi: [T; 2]) -> [T; 6] {
        let mut s = Element::<2, 6>::shape(&FullyParameterised, l, xi);
        let x = xi[0];
        let rest = T::one() - x;
        match self {
            Self::Position => s[0] += T::lit(0.01) * rest,
            Self::Slope => s[1] += T::lit(0.01) * l * x * x * rest,
            Self::Cross => s[2] += T::lit(0.01) * l * xi[1] * x,
            Self::Bubble => s[3] += x * x * rest * rest,
        }
        s
    }
}

#[test]
fn wrong_shape_functions_are_caught() {
    let report = |wrong| verify::element::<_, 2, 6>(&wrong, 0.5);
    let (unity, nodal) = (
        "sum of the position functions minus 1",
        "what a node reads of its own vectors",
    );
    assert!(failures(&report(Wrong::Position)).contains(unity));
    assert!(failures(&report(Wrong::Position)).contains(nodal));
    assert_fails(&report(Wrong::Slope), &[nodal, "linear field represented"]);
    assert_fails(
        &report(Wrong::Cross),
        &[
            nodal,
            "linear field represented",
            "other element's share of an end face",
        ],
    );
    assert_fails(&report(Wrong::Bubble), &[unity, "linear field represented"]);
}

#[test]
fn wrong_shape_functions_are_caught_by_their_physics() {
    let disk = Disk::new(0.04).unwrap();
    let report = |wrong| {
        verify::formulation::<_, _, _, 2, 6>(&wrong, &Continuum::full(rubber()), &disk, 0.3)
            .unwrap()
    };
    let rigid = failures(&report(Wrong::Bubble));
    assert!(rigid.contains("energy of a rigid motion"), "{rigid:?}");
    assert!(rigid.contains("first moment of the mass"), "{rigid:?}");
    // A part element that does not meet its neighbour still moves rigidly, but fails in a chain.
    let parted = failures(&report(Wrong::Cross));
    assert!(parted.contains("patch test"), "{parted:?}");
    // Derivatives are exact of whatever is wrong.
    for wrong in [Wrong::Position, Wrong::Slope, Wrong::Cross, Wrong::Bubble] {
        let failed = failures(&report(wrong));
        assert!(!failed.contains("tangent against the gradient of the force"));
        assert!(!failed.contains("symmetry of the tangent"));
    }
}

/// Declares fewer degrees than its functions have.
#[derive(Debug, Clone, Copy)]
struct Underdeclared;

impl Element<2, 6> for Underdeclared {
    const NODES: usize = 2;
    const VECTORS: &'static [NodalVector] = <Wrong as Element<2, 6>>::VECTORS;
    const AXIAL_DEGREE: usize = 2;

    fn shape<T: Scalar>(&self, l: T, xi: [T; 2]) -> [T; 6] {
        FullyParameterised.shape(l, xi)
    }
}

#[test]
fn a_wrong_degree_is_caught() {
    let report = verify::element::<_, 2, 6>(&Underdeclared, 0.5);
    assert_fails(&report, &["axial degree left over"]);
}

// Wrong formulations.

/// A continuum whose force or tangent is off.
#[derive(Debug, Clone, Copy)]
enum Careless {
    Force,
    Tangent,
    Frame,
}

#[derive(Debug)]
struct CarelessKernel(
    Careless,
    <Continuum<SaintVenantKirchhoff<f64, 2>> as Formulation<f64, FullyParameterised, 2, 6>>::Kernel,
);

impl Formulation<f64, FullyParameterised, 2, 6> for Careless {
    type Kernel = CarelessKernel;

    fn kernel(
        &self,
        element: &FullyParameterised,
        reference: &Reference<f64, 2, 6>,
        section: &dyn Section<f64>,
    ) -> Result<CarelessKernel> {
        let inner = Continuum::full(rubber()).kernel(element, reference, section)?;
        Ok(CarelessKernel(*self, inner))
    }
}

impl ElementKernel<f64, 2, 6> for CarelessKernel {
    fn energy<T: Algebra<f64>>(&self, u: &[[T; 2]; 6]) -> T {
        let energy = self.1.energy(u);
        match self.0 {
            // Depends on a component and not on the length of a slope.
            Careless::Frame => energy + (u[1][0] * u[1][0]).times(1e2),
            _ => energy,
        }
    }

    fn force<T: Algebra<f64>>(&self, u: &[[T; 2]; 6], q: &mut [[T; 2]; 6]) {
        self.1.force(u, q);
        match self.0 {
            Careless::Force => q[3][1] += u[3][1].times(1e2),
            Careless::Frame => q[1][0] += u[1][0].times(2e2),
            Careless::Tangent => {}
        }
    }

    fn tangent<T: Algebra<f64>>(
        &self,
        u: &[[T; 2]; 6],
        q: &mut [[T; 2]; 6],
        k: &mut Tangent<T, 2, 6>,
    ) {
        self.1.tangent(u, q, k);
        match self.0 {
            Careless::Force => {
                q[3][1] += u[3][1].times(1e2);
                k[3][1][3][1] += T::lit(1e2);
            }
            Careless::Tangent => k[0][0][1][1] += T::lit(1.0),
            Careless::Frame => {
                q[1][0] += u[1][0].times(2e2);
                k[1][0][1][0] += T::lit(2e2);
            }
        }
    }
}

#[test]
fn wrong_forces_and_tangents_are_caught() {
    let disk = Disk::new(0.04).unwrap();
    let report = |wrong| {
        verify::formulation::<_, _, _, 2, 6>(&FullyParameterised, &wrong, &disk, 0.3).unwrap()
    };
    assert!(
        failures(&report(Careless::Force)).contains("force against the gradient of the energy")
    );
    let tangent = failures(&report(Careless::Tangent));
    assert!(tangent.contains("tangent against the gradient of the force"));
    assert!(tangent.contains("symmetry of the tangent"));
    let frame = failures(&report(Careless::Frame));
    assert!(
        frame.contains("energy of a rigid motion") && frame.contains("force of a turned state")
    );
    assert!(
        !frame.contains("force against the gradient of the energy"),
        "{frame:?}"
    );
}

// Wrong sections.

#[derive(Debug, Clone, Copy, PartialEq)]
enum Flaw {
    None,
    Weight,
    Negative,
    Outside,
    Degree,
    Area,
    Plane,
}

/// A disk with a flaw.
#[derive(Debug)]
struct Flawed(Flaw);

impl Section<f64> for Flawed {
    fn rule(&self, degree: usize) -> Result<Cubature<f64, 2>> {
        let disk = Disk::new(0.04)?;
        let asked = if self.0 == Flaw::Degree { 1 } else { degree };
        let rule = disk.rule(asked)?;
        let (mut points, mut weights) = (rule.points().to_vec(), rule.weights().to_vec());
        match self.0 {
            Flaw::Weight => weights[0] *= 1.001,
            Flaw::Negative => {
                // The weight at the centre, taken twice and given back.
                let all: f64 = weights.iter().sum();
                points.extend([[0.01, 0.01], [0.01, 0.01]]);
                weights.extend([-0.1 * all, 0.1 * all]);
            }
            Flaw::Outside => points[0][0] = 0.05,
            _ => {}
        }
        Cubature::new(points, weights, degree)
    }

    fn outline(&self, n: usize) -> Vec<Vec<[f64; 2]>> {
        let radius = if self.0 == Flaw::Area { 0.041 } else { 0.04 };
        Disk::new(radius).map_or(Vec::new(), |disk| disk.outline(n))
    }

    fn planar_rule(&self, degree: usize) -> Result<Cubature<f64, 1>> {
        let rule = Disk::new(0.04)?.planar_rule(degree)?;
        match self.0 {
            // Forgets the width.
            Flaw::Plane => {
                let weights = rule.weights().iter().map(|w| w * 1.01).collect();
                Cubature::new(rule.points().to_vec(), weights, rule.degree())
            }
            _ => Ok(rule),
        }
    }
}

#[test]
fn wrong_sections_are_caught() {
    let report = |flaw| verify::section(&Flawed(flaw), 5).unwrap();
    assert_passes(report(Flaw::None));
    let outline = "moments against the outline";
    let properties = "properties against the outline";
    let plane = "planar rule against the projection";
    for flaw in [Flaw::Weight, Flaw::Degree] {
        let failed = failures(&report(flaw));
        assert!(failed.contains(outline), "{flaw:?}: {failed:?}");
        assert!(!failed.contains("points outside the outline"));
    }
    let failed = failures(&report(Flaw::Negative));
    assert!(failed.contains("smallest weight over the area") && !failed.contains(outline));
    assert!(failures(&report(Flaw::Outside)).contains("points outside the outline"));
    assert_fails(&report(Flaw::Area), &[outline, properties]);
    assert_fails(&report(Flaw::Plane), &[plane]);
}

// Wrong materials.

#[derive(Debug, Clone, Copy, PartialEq)]
enum Slip {
    Prestress,
    Stress,
    Elasticity,
    Asymmetric,
    Unstable,
    Stiffness,
    Anisotropic,
}

/// St Venant-Kirchhoff with a slip.
#[derive(Debug, Clone)]
struct Slipped(Slip);

impl Slipped {
    fn is(&self, slip: Slip) -> bool {
        self.0 == slip
    }
}

const SIZE: f64 = 1e6;

impl Material<f64, 3> for Slipped {
    fn energy<T: Algebra<f64>>(&self, e: &Tensor<T, 3>) -> T {
        let energy = Material::<f64, 3>::energy(&rubber::<f64, 3>(), e);
        match self.0 {
            Slip::Prestress => energy + e[0][0].times(SIZE),
            Slip::Unstable => energy - (e[2][2] * e[2][2]).times(1e2 * SIZE),
            Slip::Anisotropic => energy + (e[0][0] * e[0][0]).times(SIZE),
            _ => energy,
        }
    }

    fn stress<T: Algebra<f64>>(&self, e: &Tensor<T, 3>) -> Tensor<T, 3> {
        let mut stress = ByEnergy(rubber::<f64, 3>()).stress(e);
        match self.0 {
            Slip::Prestress => stress[0][0] += T::lit(SIZE),
            Slip::Stress => stress[0][0] += (e[1][1] * e[1][1]).times(SIZE),
            Slip::Unstable => stress[2][2] += e[2][2].times(-2e2 * SIZE),
            Slip::Anisotropic => stress[0][0] += e[0][0].times(2.0 * SIZE),
            _ => {}
        }
        stress
    }

    fn elasticity<T: Algebra<f64>>(&self, e: &Tensor<T, 3>) -> Blocks<T, 3> {
        let mut c = Material::<f64, 3>::elasticity(&rubber::<f64, 3>(), e);
        match self.0 {
            Slip::Stress => c[0][0][1][1] += e[1][1].times(2.0 * SIZE),
            Slip::Unstable => c[2][2][2][2] += T::lit(-2e2 * SIZE),
            Slip::Anisotropic => c[0][0][0][0] += T::lit(2.0 * SIZE),
            Slip::Elasticity => c[0][0][0][0] += T::lit(SIZE),
            Slip::Asymmetric => c[0][0][1][1] += T::lit(SIZE),
            _ => {}
        }
        c
    }

    fn stiffness<T: Algebra<f64>>(&self, e: &Tensor<T, 3>, c: &Tensor<T, 3>) -> Blocks<T, 3> {
        if self.is(Slip::Stiffness) {
            let softer = SaintVenantKirchhoff::<f64, 3>::isotropic(2.0e7, 0.2).unwrap();
            return softer.stiffness(e, c);
        }
        // The default's contraction of this elasticity, by a material that has nothing else.
        #[derive(Debug, Clone)]
        struct Only(Slipped);
        impl Material<f64, 3> for Only {
            fn energy<T: Algebra<f64>>(&self, e: &Tensor<T, 3>) -> T {
                self.0.energy(e)
            }
            fn elasticity<T: Algebra<f64>>(&self, e: &Tensor<T, 3>) -> Blocks<T, 3> {
                self.0.elasticity(e)
            }
        }
        Only(self.clone()).stiffness(e, c)
    }
}

#[test]
fn wrong_materials_are_caught() {
    let report = |slip| verify::material::<f64, _, 3>(&Slipped(slip));
    let elasticity = "elasticity against the gradient of the stress";
    let major = "major symmetry of the elasticity";
    let failed = failures(&report(Slip::Prestress));
    assert!(
        failed.contains("stress of the reference state"),
        "{failed:?}"
    );
    assert!(!failed.contains(elasticity));
    assert_fails(
        &report(Slip::Stress),
        &["stress against the gradient of the energy", major],
    );
    assert_fails(&report(Slip::Elasticity), &[elasticity]);
    assert_fails(&report(Slip::Asymmetric), &[elasticity, major]);
    let failed = failures(&report(Slip::Unstable));
    assert!(
        failed.contains("smallest modulus over the largest"),
        "{failed:?}"
    );
    assert_fails(
        &report(Slip::Stiffness),
        &["stiffness against the contracted elasticity"],
    );
    assert!(
        report(Slip::Anisotropic).passed(),
        "a law may be anisotropic"
    );
    assert_fails(
        &verify::isotropy::<f64, _, 3>(&Slipped(Slip::Anisotropic)),
        &["energy of a turned strain"],
    );
    let soft = verify::linear_elasticity::<f64, _, 3>(&rubber(), 2.0e7, 0.29).unwrap();
    assert_fails(&soft, &["elasticity at small strain"]);
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
fn kernels_and_systems_pass_and_wrong_tangents_do_not() {
    let reference = Reference::straight(&FullyParameterised, 0.3, [[1.0, 0.0], [0.0, 1.0]]);
    let disk = Disk::new(0.04).unwrap();
    let units = std::array::from_fn(|i| if i % 3 == 0 { 0.3 } else { 1.0 });
    let u: [[f64; 2]; 6] = std::array::from_fn(|i| {
        std::array::from_fn(|c| 0.1 * units[i] * ((3 * i + c) as f64).sin())
    });
    let kernel = |wrong: Careless| {
        wrong
            .kernel(&FullyParameterised, &reference, &disk)
            .unwrap()
    };
    let right = kernel(Careless::Frame);
    assert_passes(
        verify::energy_gradient(&right, &u, &units)
            .unwrap()
            .report(1e3),
    );
    assert_passes(
        verify::force_gradient(&right, &u, &units)
            .unwrap()
            .report(1e3),
    );
    let wrong = verify::energy_gradient(&kernel(Careless::Force), &u, &units).unwrap();
    assert_fails(&wrong.report(1e3), &["best error of differences"]);
    let wrong = verify::force_gradient(&kernel(Careless::Tangent), &u, &units).unwrap();
    assert_fails(&wrong.report(1e3), &["best error of differences"]);

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
