//! Wrong elements and formulations.

use std::collections::BTreeSet;

use ancf::formulation::{ContinuumKernel, ElementKernel, Reference, Tangent};
use ancf::prelude::*;
use ancf::verify::{self, Report};

use crate::{assert_each_check_catches, assert_fails, disk, failures, rubber};

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

/// The planar built-in element with a degree too low for its mass.
#[derive(Debug, Clone, Copy)]
struct Low;

impl Element<2, 6> for Low {
    const NODES: usize = 2;
    const VECTORS: &'static [NodalVector] = Wrong::VECTORS;
    const AXIAL_DEGREE: usize = 2;

    fn shape<T: Scalar>(&self, l: T, xi: [T; 2]) -> [T; 6] {
        Element::<2, 6>::shape(&FullyParameterised, l, xi)
    }
}

/// The quadratic element with one line wrong.
#[derive(Debug, Clone, Copy)]
enum WrongQuadratic {
    /// A middle function that is not one at its node.
    Middle,
    /// The same function for the cross slopes of the middle and of the end.
    Twice,
}

impl Element<2, 6> for WrongQuadratic {
    const NODES: usize = 3;
    const VECTORS: &'static [NodalVector] = &[NodalVector::Position, NodalVector::Slope(1)];
    const AXIAL_DEGREE: usize = 2;

    fn shape<T: Scalar>(&self, l: T, xi: [T; 2]) -> [T; 6] {
        let mut s = Element::<2, 6>::shape(&Quadratic, l, xi);
        match self {
            Self::Middle => s[2] *= T::lit(0.99),
            Self::Twice => s[5] = s[3],
        }
        s
    }
}

/// The cable with the slope at its end turned round.
#[derive(Debug, Clone, Copy)]
struct BackwardCable;

impl<const D: usize> Element<D, 4> for BackwardCable {
    const NODES: usize = 2;
    const VECTORS: &'static [NodalVector] = &[NodalVector::Position, NodalVector::Slope(0)];
    const AXIAL_DEGREE: usize = 3;
    const SECTION_DEGREE: usize = 0;

    fn shape<T: Scalar>(&self, l: T, xi: [T; D]) -> [T; 4] {
        let mut s = Element::<D, 4>::shape(&Cable, l, xi);
        s[3] = -s[3];
        s
    }
}

/// The functions of the fully parameterised element, wrongly declared.
macro_rules! declared {
    ($name:ident, $nodes:literal, $vectors:expr, $axial:literal, $section:literal, $unit:expr) => {
        #[derive(Debug, Clone, Copy)]
        struct $name;

        impl Element<2, 6> for $name {
            const NODES: usize = $nodes;
            const VECTORS: &'static [NodalVector] = $vectors;
            const AXIAL_DEGREE: usize = $axial;
            const SECTION_DEGREE: usize = $section;

            fn shape<T: Scalar>(&self, l: T, xi: [T; 2]) -> [T; 6] {
                FullyParameterised.shape(l, xi).map(|s| s * T::lit($unit))
            }
        }
    };
}
const NODE: &[NodalVector] = <Wrong as Element<2, 6>>::VECTORS;
const TWO: &[NodalVector] = &[NODE[0], NODE[1], NODE[2], NODE[0], NODE[1], NODE[2]];
declared!(Underdeclared, 2, NODE, 2, 1, 1.0);
declared!(Flat, 2, NODE, 3, 0, 1.0);
declared!(Uncounted, 3, NODE, 3, 1, 1.0);
declared!(OneNode, 1, TWO, 3, 1, 1.0);
declared!(
    Sloping,
    2,
    &[NODE[0], NODE[1], NodalVector::Slope(5)],
    3,
    1,
    1.0
);
declared!(Repeated, 2, &[NODE[0], NODE[1], NODE[1]], 3, 1, 1.0);
declared!(
    Placeless,
    2,
    &[NODE[1], NODE[2], NodalVector::Slope(2)],
    3,
    1,
    1.0
);
declared!(Percent, 2, NODE, 3, 1, 1.01);
declared!(Undefined, 2, NODE, 3, 1, f64::NAN);

const UNITY: &str = "sum of the position functions minus 1";
const NODAL: &str = "what a node reads of its own vectors";
const LINEAR: &str = "linear field represented";
const AXIAL: &str = "axial degree left over";
const SECTION: &str = "section degree left over";
const FACE: &str = "other element's share of an end face";
const INDEPENDENT: &str = "independence of the shape functions";

#[test]
fn wrong_shape_functions_are_caught() {
    fn report<E: Element<D, S>, const D: usize, const S: usize>(wrong: E) -> Report {
        verify::element(&wrong, 0.5)
    }
    let position = report(Wrong::Position);
    assert!(failures(&position).is_superset(&BTreeSet::from([UNITY, NODAL])));
    let wrong: Vec<Report> = [
        (report(Wrong::Slope), &[NODAL, LINEAR][..]),
        (report(Wrong::Cross), &[NODAL, LINEAR, FACE]),
        (report(Wrong::Bubble), &[UNITY, LINEAR]),
        (report(WrongQuadratic::Middle), &[UNITY, NODAL, LINEAR]),
        (report(WrongQuadratic::Twice), &[NODAL, LINEAR, INDEPENDENT]),
        (report::<_, 2, 4>(BackwardCable), &[NODAL, LINEAR]),
        (report::<_, 3, 4>(BackwardCable), &[NODAL, LINEAR]),
        (report(Underdeclared), &[AXIAL]),
        (report(Flat), &[SECTION]),
        (report(Uncounted), &["nodes and nodal vectors"]),
        (report(OneNode), &["nodes and nodal vectors"]),
        (report(Sloping), &["nodes and nodal vectors"]),
        (report(Repeated), &["nodes and nodal vectors"]),
        (report(Placeless), &["nodes and nodal vectors"]),
    ]
    .into_iter()
    .map(|(report, only)| {
        assert_fails(&report, only);
        report
    })
    .chain([position])
    .collect();
    assert_each_check_catches(
        &verify::element::<_, 2, 6>(&FullyParameterised, 0.5),
        &wrong,
    );
    assert_each_check_catches(&verify::element::<_, 2, 6>(&Quadratic, 0.5), &wrong);
    assert_each_check_catches(&verify::element::<_, 2, 4>(&Cable, 0.5), &wrong);
    assert_fails(&verify::element::<_, 2, 4>(&Cable, f64::NAN), &["length"]);
}

/// No beam is made of what is no element, and no check of one panics or hangs.
#[test]
fn beams_of_wrong_elements_are_refused() {
    fn refusal<E: Element<2, 6>>(element: E) -> String {
        let rule = Continuum::full(rubber());
        let beam = Beam::new(element, disk(), rule.clone()).straight([0.0; 2], [1.0, 0.0], 2);
        let mut scene = Scene::<f64, 2>::new();
        // The checks of a formulation find what they can find in wrong shape functions.
        let _ = verify::formulation::<_, _, _, 2, 6>(&element, &rule, &disk(), 0.3);
        scene.add(beam).unwrap_err().to_string()
    }
    for (message, says) in [
        (refusal(OneNode), "a node at each end"),
        (refusal(Sloping), "Slope(5) in 2 dimensions"),
        (refusal(Repeated), "Slope(0) twice"),
        (refusal(Percent), "a sum of one by 1.0e-2"),
        (refusal(Undefined), "a sum of one by NaN"),
        (refusal(Wrong::Position), "a sum of one"),
        (refusal(Wrong::Slope), "another Slope(0)"),
        (refusal(Wrong::Bubble), "a sum of one"),
        (refusal(WrongQuadratic::Twice), "another Slope(1)"),
        (refusal(Low), "higher degree than its AXIAL_DEGREE of 2"),
    ] {
        assert!(message.contains(says), "{message}");
    }
}

#[test]
fn wrong_shape_functions_are_caught_by_their_physics() {
    let report = |wrong| {
        let solid = Continuum::full(rubber());
        verify::formulation::<_, _, _, 2, 6>(&wrong, &solid, &disk(), 0.3).unwrap()
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
    let rod = StructuralMechanics::new(&rubber::<2>());
    let middle = verify::formulation::<_, _, _, 2, 6>(&WrongQuadratic::Middle, &rod, &disk(), 0.3);
    let middle = failures(&middle.unwrap());
    assert!(middle.contains("patch test"), "{middle:?}");
    assert!(middle.contains("first moment of the mass"), "{middle:?}");
    let cable = EulerBernoulli::new(&rubber::<2>());
    let turned = verify::formulation::<_, _, _, 2, 4>(&BackwardCable, &cable, &disk(), 0.3);
    let turned = failures(&turned.unwrap());
    assert!(turned.contains("patch test"), "{turned:?}");
    assert!(turned.contains("first moment of the mass"), "{turned:?}");
}

// Wrong formulations.

/// A continuum that is off.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Careless {
    /// Not at all.
    Not,
    /// A force that is no gradient of the energy.
    Force,
    /// A tangent that is not that of the force.
    Tangent,
    /// Another force with the tangent than without.
    Pair,
    /// An energy that depends on a component and not on the length of a slope.
    Frame,
    /// A force at rest.
    Prestress,
    /// Another upper half of the tangent than the tangent's.
    Upper,
    /// A tangent that is not that of the secant force.
    Secant,
    /// A section that turns against its neighbour for less than nothing.
    Soft,
}

#[derive(Debug)]
struct CarelessKernel(
    Careless,
    ContinuumKernel<f64, SaintVenantKirchhoff<f64, 2>, 2, 6, 3>,
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
            Careless::Frame => energy + (u[1][0] * u[1][0]).times(1e2),
            Careless::Prestress => energy + u[1][0].times(1e2),
            Careless::Soft => -energy,
            _ => energy,
        }
    }

    fn force<T: Algebra<f64>>(&self, u: &[[T; 2]; 6], q: &mut [[T; 2]; 6]) {
        self.1.force(u, q);
        match self.0 {
            Careless::Force => q[3][1] += u[3][1].times(1e2),
            Careless::Frame => q[1][0] += u[1][0].times(2e2),
            Careless::Prestress => q[1][0] += T::lit(1e2),
            Careless::Soft => {
                let mut twice = [[T::zero(); 2]; 6];
                self.1.force(u, &mut twice);
                for (q, twice) in q.as_flattened_mut().iter_mut().zip(twice.as_flattened()) {
                    *q -= *twice + *twice;
                }
            }
            _ => {}
        }
    }

    fn upper_tangent<T: Algebra<f64>>(&self, u: &[[T; 2]; 6], k: &mut Tangent<T, 2, 6>) {
        *k = [[[[T::zero(); 2]; 6]; 2]; 6];
        self.tangent(u, &mut [[T::zero(); 2]; 6], k);
        if self.0 == Careless::Upper {
            k[0][0][1][1] += T::lit(1.0);
        }
    }

    fn secant<T: Algebra<f64>>(
        &self,
        viscosity: f64,
        from: &[[T; 2]; 6],
        to: &[[T; 2]; 6],
        q: &mut [[T; 2]; 6],
    ) {
        self.1.secant(viscosity, from, to, q);
    }

    fn secant_tangent<T: Algebra<f64>>(
        &self,
        viscosity: f64,
        from: &[[T; 2]; 6],
        to: &[[T; 2]; 6],
        k: &mut Tangent<T, 2, 6>,
    ) {
        self.1.secant_tangent(viscosity, from, to, k);
        if self.0 == Careless::Secant {
            k[0][0][1][1] += T::lit(1.0);
        }
    }

    fn tangent<T: Algebra<f64>>(
        &self,
        u: &[[T; 2]; 6],
        q: &mut [[T; 2]; 6],
        k: &mut Tangent<T, 2, 6>,
    ) {
        let mut unused = [[T::zero(); 2]; 6];
        self.1.tangent(u, &mut unused, k);
        self.force(u, q);
        match self.0 {
            Careless::Force => k[3][1][3][1] += T::lit(1e2),
            Careless::Tangent => k[0][0][1][1] += T::lit(1.0),
            Careless::Pair => q[0][0] += T::lit(1.0),
            Careless::Frame => k[1][0][1][0] += T::lit(2e2),
            Careless::Soft => k
                .as_flattened_mut()
                .as_flattened_mut()
                .as_flattened_mut()
                .iter_mut()
                .for_each(|k| *k = -*k),
            _ => {}
        }
    }
}

/// A spring on every coordinate: a formulation that does not look at its element.
#[derive(Debug, Clone, Copy)]
struct Springs;

impl<E: Element<2, 6>> Formulation<f64, E, 2, 6> for Springs {
    type Kernel = Self;

    fn kernel(&self, _: &E, _: &Reference<f64, 2, 6>, _: &dyn Section<f64>) -> Result<Self> {
        Ok(Self)
    }
}

impl ElementKernel<f64, 2, 6> for Springs {
    fn energy<T: Algebra<f64>>(&self, u: &[[T; 2]; 6]) -> T {
        let squares = u.as_flattened().iter().map(|u| *u * *u);
        squares.fold(T::zero(), |sum, square| sum + square)
    }
}

#[test]
fn wrong_forces_and_tangents_are_caught() {
    let report = |wrong: Careless| {
        verify::formulation::<_, _, _, 2, 6>(&FullyParameterised, &wrong, &disk(), 0.3).unwrap()
    };
    let force = report(Careless::Force);
    assert!(failures(&force).contains("force against the gradient of the energy"));
    let tangent = report(Careless::Tangent);
    assert_fails(
        &tangent,
        &[
            "tangent against the gradient of the force",
            "symmetry of the tangent",
            "upper half of the tangent",
            "patch test",
        ],
    );
    let pair = report(Careless::Pair);
    assert_fails(&pair, &["force that comes with the tangent"]);
    let frame = report(Careless::Frame);
    let failed = failures(&frame);
    assert!(
        failed.contains("energy of a rigid motion") && failed.contains("force of a turned state")
    );
    assert!(
        !failed.contains("force against the gradient of the energy"),
        "{failed:?}"
    );
    let prestress = report(Careless::Prestress);
    assert!(failures(&prestress).contains("force of the reference state"));
    let upper = report(Careless::Upper);
    assert_fails(&upper, &["upper half of the tangent"]);
    let secant = report(Careless::Secant);
    assert_fails(&secant, &["tangent of the secant against its gradient"]);
    let soft = report(Careless::Soft);
    assert!(failures(&soft).contains("smallest stiffness beyond rigid motions"));
    // A mass of an element whose functions are no numbers is none.
    let springs = verify::formulation::<_, _, _, 2, 6>(&Undefined, &Springs, &disk(), 0.3).unwrap();
    assert!(failures(&springs).contains("smallest eigenvalue of the scaled mass"));
    let solid = Continuum::full(rubber::<2>());
    let parted = verify::formulation::<_, _, _, 2, 6>(&Wrong::Cross, &solid, &disk(), 0.3).unwrap();
    assert_each_check_catches(
        &report(Careless::Not),
        &[
            force, tangent, pair, frame, prestress, upper, secant, soft, springs, parted,
        ],
    );
}

#[test]
fn wrong_kernels_are_caught_by_differences() {
    let reference = Reference::straight(&FullyParameterised, 0.3, [[1.0, 0.0], [0.0, 1.0]]);
    let kernel = |wrong: Careless| {
        wrong
            .kernel(&FullyParameterised, &reference, &disk())
            .unwrap()
    };
    let units = std::array::from_fn(|i| if i % 3 == 0 { 0.3 } else { 1.0 });
    let u: [[f64; 2]; 6] = std::array::from_fn(|i| {
        std::array::from_fn(|c| 0.1 * units[i] * ((3 * i + c) as f64).sin())
    });
    let energy = |wrong| verify::energy_gradient(&kernel(wrong), &u, &units).unwrap();
    let force = |wrong| verify::force_gradient(&kernel(wrong), &u, &units).unwrap();
    assert!(energy(Careless::Frame).report(1e3).passed());
    assert!(force(Careless::Frame).report(1e3).passed());
    let best = ["best error of differences"];
    assert_fails(&energy(Careless::Force).report(1e3), &best);
    assert_fails(&force(Careless::Tangent).report(1e3), &best);
}

/// The coupled part of the material alone has no shear stiffness: no rule gives it full rank.
#[test]
fn a_material_with_free_shear_is_caught() {
    let free = rubber::<2>().coupled();
    let report = verify::sampling::<_, _, _, 2, 6>(&Quadratic, &free, &disk()).unwrap();
    assert_fails(&report, &["zero-energy modes"]);
}
