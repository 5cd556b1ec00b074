//! Wrong sections and materials.

use ancf::material::{Blocks, Moduli, Tensor};
use ancf::prelude::*;
use ancf::quadrature::Cubature;
use ancf::section::Properties;
use ancf::verify::{self, ByEnergy, Pose, Precision, PrecisionRow, SlenderRow, SlenderStudy};

use crate::{assert_each_check_catches, assert_fails, disk, failures, rubber};

#[derive(Debug, Clone, Copy, PartialEq)]
enum Flaw {
    None,
    Weight,
    Negative,
    Outside,
    Degree,
    Area,
    Plane,
    Claim,
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
        let claimed = if self.0 == Flaw::Claim { 0 } else { degree };
        Cubature::new(points, weights, claimed)
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
    assert_fails(&report(Flaw::Claim), &["degree the rule claims"]);
    let wrong = [
        Flaw::Weight,
        Flaw::Negative,
        Flaw::Outside,
        Flaw::Degree,
        Flaw::Area,
        Flaw::Plane,
        Flaw::Claim,
    ];
    let mut wrong: Vec<_> = wrong.map(report).into();
    wrong.push(verify::section(&Unruled, 5).unwrap());
    assert_each_check_catches(&report(Flaw::None), &wrong);
    let failed = failures(&verify::section(&Alone, 5).unwrap());
    assert!(failed.contains("properties against the rule"), "{failed:?}");
}

/// A section that says nothing but its properties.
#[derive(Debug)]
struct Unruled;

impl Section<f64> for Unruled {
    fn rule(&self, degree: usize) -> Result<Cubature<f64, 2>> {
        Err(Error::NoRule {
            degree,
            cause: "it has none",
            remedy: "give it one",
        })
    }
    fn outline(&self, _n: usize) -> Vec<Vec<[f64; 2]>> {
        Vec::new()
    }
}

/// A disk without an outline, whose properties are not those of its rule.
#[derive(Debug)]
struct Alone;

impl Section<f64> for Alone {
    fn rule(&self, degree: usize) -> Result<Cubature<f64, 2>> {
        Disk::new(0.04)?.rule(degree)
    }
    fn outline(&self, _n: usize) -> Vec<Vec<[f64; 2]>> {
        Vec::new()
    }
    fn properties(&self) -> Result<Properties<f64>> {
        let mut properties = Disk::new(0.04)?.properties()?;
        properties.iyy = -properties.iyy;
        Ok(properties)
    }
}

/// Mooney and Rivlin's law as in the book, in the invariants of `C = 1 + 2 E`.
#[derive(Debug, Clone, Copy)]
struct MooneyRivlin(f64, f64);

impl Material<f64, 3> for MooneyRivlin {
    fn energy<T: Algebra<f64>>(&self, e: &Tensor<T, 3>) -> T {
        let c = |a: usize, b: usize| e[a][b] + e[a][b] + T::lit(f64::from(u8::from(a == b)));
        let minor = |a, b| c(a, a) * c(b, b) - c(a, b) * c(a, b);
        let mixed = c(0, 1) * (c(1, 2) * c(0, 2) - c(0, 1) * c(2, 2))
            + c(0, 2) * (c(0, 1) * c(1, 2) - c(0, 2) * c(1, 1));
        let log = (c(0, 0) * minor(1, 2) + mixed).ln();
        (c(0, 0) + c(1, 1) + c(2, 2) - log - T::lit(3.0)).times(self.0)
            + (minor(0, 1) + minor(1, 2) + minor(2, 0) - log - log - T::lit(3.0)).times(self.1)
    }
}

/// Its energy is a difference of numbers near 3; that is rounding and no mistake.
#[test]
fn laws_of_the_book_pass() {
    let law = MooneyRivlin(2e5, 3e5);
    verify::material::<f64, _, 3>(&law).into_result().unwrap();
    verify::isotropy::<f64, _, 3>(&law).into_result().unwrap();
    let solid = Continuum::full(law);
    let report = verify::formulation::<_, _, _, 3, 8>(&FullyParameterised, &solid, &disk(), 0.3);
    report.unwrap().into_result().unwrap();
}

/// A law that is no number is not told to sample more points.
#[test]
fn laws_that_are_no_numbers_are_called_that() {
    let law = MooneyRivlin(f64::NAN, 3e5);
    let beam = Beam::new(FullyParameterised, disk(), Continuum::full(law));
    let added = Scene::<f64, 3>::new().add(beam.straight([0.0; 3], [1.0, 0.0, 0.0], 4));
    assert!(matches!(added, Err(Error::NotFinite { .. })), "{added:?}");
}

/// An error that is no number has lost every digit, and is the worst there is.
#[test]
fn errors_that_are_no_numbers_pass_nowhere() {
    let row = SlenderRow {
        pose: Pose::default(),
        error: f64::NAN,
        storage: 1.0,
        rule: 0.0,
        strain: f64::NAN,
        assembly: 0.0,
        factorisation: 0.0,
    };
    assert_eq!(row.worst(), "strain");
    let study = SlenderStudy {
        epsilon: 1e-7,
        rows: vec![row],
    };
    assert!(!study.report(20.0).passed());
    let staged = Precision {
        epsilon: 1e-7,
        rows: vec![PrecisionRow {
            parameter: 1.0,
            error: f64::NAN,
            shares: Vec::new(),
        }],
    };
    assert!(!staged.report(20.0).passed());
}

/// A length that is none is named before anything is made of it.
#[test]
fn elements_without_length_are_not_checked() {
    let solid = Continuum::full(rubber::<3>());
    for length in [0.0, -1.0, f64::NAN] {
        let report =
            verify::formulation::<_, _, _, 3, 8>(&FullyParameterised, &solid, &disk(), length);
        assert!(
            matches!(report, Err(Error::NotPositive { .. })),
            "{report:?}"
        );
    }
}

// Wrong materials.

#[derive(Debug, Clone, Copy, PartialEq)]
enum Slip {
    None,
    Energy,
    Prestress,
    Stress,
    Elasticity,
    Asymmetric,
    Unstable,
    Stiffness,
    Anisotropic,
    Couple,
    Minor,
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
        let energy = Material::<f64, 3>::energy(&rubber(), e);
        match self.0 {
            Slip::Energy => energy + T::lit(SIZE),
            Slip::Prestress => energy + e[0][0].times(SIZE),
            Slip::Unstable => energy - (e[2][2] * e[2][2]).times(1e2 * SIZE),
            Slip::Anisotropic => energy + (e[0][0] * e[0][0]).times(SIZE),
            _ => energy,
        }
    }

    fn stress<T: Algebra<f64>>(&self, e: &Tensor<T, 3>) -> Tensor<T, 3> {
        let mut stress = ByEnergy(rubber::<3>()).stress(e);
        match self.0 {
            Slip::Prestress => stress[0][0] += T::lit(SIZE),
            Slip::Stress => stress[0][0] += (e[1][1] * e[1][1]).times(SIZE),
            Slip::Unstable => stress[2][2] += e[2][2].times(-2e2 * SIZE),
            Slip::Anisotropic => stress[0][0] += e[0][0].times(2.0 * SIZE),
            Slip::Couple => stress[0][1] += (e[1][1] * e[1][1]).times(SIZE),
            _ => {}
        }
        stress
    }

    fn elasticity<T: Algebra<f64>>(&self, e: &Tensor<T, 3>) -> Blocks<T, 3> {
        let mut c = Material::<f64, 3>::elasticity(&rubber(), e);
        match self.0 {
            Slip::Stress => c[0][0][1][1] += e[1][1].times(2.0 * SIZE),
            Slip::Unstable => c[2][2][2][2] += T::lit(-2e2 * SIZE),
            Slip::Anisotropic => c[0][0][0][0] += T::lit(2.0 * SIZE),
            Slip::Elasticity => c[0][0][0][0] += T::lit(SIZE),
            Slip::Asymmetric => c[0][0][1][1] += T::lit(SIZE),
            Slip::Minor => c[0][1][0][1] += T::lit(SIZE),
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
    assert!(failures(&report(Slip::Energy)).contains("energy of the reference state"));
    assert!(failures(&report(Slip::Couple)).contains("symmetry of the stress"));
    assert!(failures(&report(Slip::Minor)).contains("minor symmetry of the elasticity"));
    let wrong = [
        Slip::Energy,
        Slip::Prestress,
        Slip::Stress,
        Slip::Elasticity,
        Slip::Asymmetric,
        Slip::Unstable,
        Slip::Stiffness,
        Slip::Couple,
        Slip::Minor,
    ];
    assert_each_check_catches(&report(Slip::None), &wrong.map(report));
    let soft = verify::linear_elasticity::<f64, _, 3>(&rubber(), 2.0e7, 0.29).unwrap();
    assert_fails(&soft, &["elasticity at small strain"]);
}

/// A type of constant elasticity whose material has the moduli given: elements would be integrated with
/// these, and its stress never be asked for.
#[test]
fn moduli_that_are_not_those_of_the_stress_are_caught() {
    #[derive(Debug, Clone)]
    struct Promised(Option<Moduli<f64, 3>>);
    impl Material<f64, 3> for Promised {
        const CONSTANT: bool = true;
        fn energy<T: Algebra<f64>>(&self, e: &Tensor<T, 3>) -> T {
            Material::<f64, 3>::energy(&rubber(), e)
        }
        fn constant_elasticity(&self) -> Option<Moduli<f64, 3>> {
            self.0
        }
    }
    let moduli = Material::<f64, 3>::constant_elasticity(&rubber());
    let stiffer = moduli.map(|mut moduli| {
        moduli.shear[0][1] *= 1.001;
        moduli.shear[1][0] *= 1.001;
        moduli
    });
    let report = |moduli| verify::material::<f64, _, 3>(&Promised(moduli));
    report(moduli).into_result().unwrap();
    for wrong in [stiffer, None] {
        assert_fails(&report(wrong), &["constant elasticity against the stress"]);
    }
}

/// A rule of a lower degree than the section was asked for would bend a beam too softly, or not at all:
/// no beam is made with it, and the error names both degrees.
#[test]
fn section_rules_of_too_low_a_degree_are_refused() {
    /// All of the area in one point.
    #[derive(Debug)]
    struct Lumped;
    impl Section<f64> for Lumped {
        fn rule(&self, _: usize) -> Result<Cubature<f64, 2>> {
            Cubature::new(vec![[0.0; 2]], vec![1e-4], 1)
        }
        fn outline(&self, n: usize) -> Vec<Vec<[f64; 2]>> {
            disk().outline(n)
        }
    }
    fn refusal(section: impl Section<f64> + 'static) -> String {
        let beam = Beam::new(FullyParameterised, section, Continuum::full(rubber()));
        let beam = beam.straight([0.0; 3], [1.0, 0.0, 0.0], 2);
        Scene::<f64, 3>::new().add(beam).unwrap_err().to_string()
    }
    let lumped = "exact to degree 1 where degree 2 was asked for";
    let claimed = "exact to degree 0 where degree";
    for (message, says) in [
        (refusal(Lumped), lumped),
        (refusal(Flawed(Flaw::Claim)), claimed),
    ] {
        assert!(
            message.contains(says) && message.contains("verify::section"),
            "{message}"
        );
    }
}
