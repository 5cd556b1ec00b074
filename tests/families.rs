//! Claims about one element of every family under every formulation it works with, in both
//! dimensions, straight and curved: completeness, rigid motion, gradients, patch tests and mass.

use ancf::formulation::{CableEnergy, ElementKernel, Inertia, Reference, Tangent};
use ancf::prelude::*;
use ancf::verify::ByPoints;
use num_dual::DualSVec64;

const LENGTH: f64 = 0.3;
const YOUNG: f64 = 2.0e7;
const HEIGHT: f64 = 0.05;

fn square() -> Rectangle<f64> {
    Rectangle::new(HEIGHT, HEIGHT).unwrap()
}

fn rubber<const D: usize>(poisson: f64) -> SaintVenantKirchhoff<f64, D> {
    SaintVenantKirchhoff::isotropic(YOUNG, poisson).unwrap()
}

fn axes<const D: usize>() -> [[f64; D]; D] {
    std::array::from_fn(|a| std::array::from_fn(|c| f64::from(u8::from(a == c))))
}

fn is_position<E: Element<D, S>, const D: usize, const S: usize>(i: usize) -> bool {
    E::VECTORS[i % E::VECTORS.len()] == NodalVector::Position
}

/// An element of an arc of 0.8 rad, in space twisted by 0.5 rad as well.
fn curved<E: Element<D, S>, const D: usize, const S: usize>() -> Reference<f64, D, S> {
    let per_node = E::VECTORS.len();
    let vectors = std::array::from_fn(|i| {
        let s = (i / per_node) as f64 / (E::NODES - 1) as f64;
        let (sin, cos) = (0.8 * s).sin_cos();
        let (p, q) = (0.5 * s).sin_cos();
        let radius = LENGTH / 0.8;
        let space = [
            [radius * sin, radius * (1.0 - cos), 0.0],
            [cos, sin, 0.0],
            [-sin * q, cos * q, p],
            [sin * p, -cos * p, q],
        ];
        let plane = [space[0], space[1], [-sin, cos, 0.0]];
        let row = match E::VECTORS[i % per_node] {
            NodalVector::Position => 0,
            NodalVector::Slope(a) => a + 1,
        };
        let vector = if D == 3 { space[row] } else { plane[row] };
        std::array::from_fn(|c| vector[c])
    });
    Reference::curved(LENGTH, vectors)
}

/// Nodal displacements of the affine motion `r -> a r + b`, `a` by rows.
fn affine<const D: usize, const S: usize, E: Element<D, S>>(
    reference: &Reference<f64, D, S>,
    a: &[[f64; D]; D],
    b: f64,
) -> [[f64; D]; S] {
    std::array::from_fn(|i| {
        let e = reference.vectors[i];
        let shift = if is_position::<E, D, S>(i) { b } else { 0.0 };
        std::array::from_fn(|c| (0..D).map(|k| a[c][k] * e[k]).sum::<f64>() - e[c] + shift)
    })
}

fn rotation<const D: usize>() -> [[f64; D]; D] {
    let turn = nalgebra::Rotation3::from_euler_angles(if D == 3 { 2.1 } else { 0.0 }, 0.0, -1.3);
    let turn = match D {
        3 => turn * nalgebra::Rotation3::from_euler_angles(0.0, 0.9, 0.4),
        _ => turn,
    };
    std::array::from_fn(|i| std::array::from_fn(|j| turn[(i, j)]))
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m, v| v.abs().max(m))
}

/// Everything that must hold of a kernel whatever its formulation; `N = D S`.
fn check<E, F, const D: usize, const S: usize, const N: usize>(
    name: &str,
    element: E,
    formulation: &F,
    reference: &Reference<f64, D, S>,
) where
    E: Element<D, S>,
    F: Formulation<f64, E, D, S>,
{
    let kernel = formulation.kernel(&element, reference, &square()).unwrap();
    let moved = affine::<D, S, E>(reference, &rotation(), 5.0);
    let mut stretch = axes::<D>();
    stretch[0][0] += 1e-3;
    let unit = kernel.energy(&affine::<D, S, E>(reference, &stretch, 0.0)) * 1e6;
    let rigid = kernel.energy(&moved);
    let rounding = 1e2 * f64::EPSILON / LENGTH;
    assert!(
        rigid.abs() < unit * rounding.powi(2),
        "{name}: {rigid} J of a rigid motion"
    );

    for size in [1e-3, 0.1] {
        let u: [[f64; D]; S] = std::array::from_fn(|i| {
            let unit = if is_position::<E, D, S>(i) {
                LENGTH
            } else {
                1.0
            };
            std::array::from_fn(|c| size * unit * ((5 * i + 3 * c + 1) as f64).sin())
        });
        check_gradients::<_, D, S, N>(name, &kernel, &u);
        // The same strains after a rigid rotation: the same energy.
        let turn = rotation::<D>();
        let turned: [[f64; D]; S] = std::array::from_fn(|i| {
            std::array::from_fn(|c| {
                let now = |k: usize| reference.vectors[i][k] + u[i][k];
                (0..D).map(|k| turn[c][k] * now(k)).sum::<f64>() - reference.vectors[i][c]
            })
        });
        let (plain, turned) = (kernel.energy(&u), kernel.energy(&turned));
        assert!(
            (turned / plain - 1.0).abs() < 1e-9,
            "{name}: {plain} turns to {turned}"
        );
    }
}

fn check_gradients<K, const D: usize, const S: usize, const N: usize>(
    name: &str,
    kernel: &K,
    u: &[[f64; D]; S],
) where
    K: ElementKernel<f64, D, S>,
{
    // Over a step that ends here, with viscosity where there are strains.
    let viscosity = if kernel.has_strain() { 0.1 } else { 0.0 };
    let from: [[f64; D]; S] = std::array::from_fn(|i| u[S - 1 - i].map(|u| -0.5 * u));
    let before = from.map(|v| v.map(DualSVec64::<D>::from_re));
    let gradient = |x: DualSVec64<D>, k: usize| x.eps.0.map_or(0.0, |eps| eps[k]);
    let mut energy_gradient = [0.0; N];
    let (mut force_gradient, mut secant_gradient) = ([[0.0; N]; N], [[0.0; N]; N]);
    // One nodal vector after the other: the dual numbers that kernels differentiate in, too.
    for varied in 0..S {
        let dual: [[DualSVec64<D>; D]; S] = std::array::from_fn(|i| {
            std::array::from_fn(|c| match DualSVec64::from_re(u[i][c]) {
                x if i == varied => x.derivative(c),
                x => x,
            })
        });
        let energy = kernel.energy(&dual);
        let mut force = [[DualSVec64::<D>::from_re(0.0); D]; S];
        kernel.force(&dual, &mut force);
        let mut secant = [[DualSVec64::<D>::from_re(0.0); D]; S];
        kernel.secant(viscosity, &before, &dual, &mut secant);
        for c in 0..D {
            let j = varied * D + c;
            energy_gradient[j] = gradient(energy, c);
            for i in 0..N {
                force_gradient[i][j] = gradient(force.as_flattened()[i], c);
                secant_gradient[i][j] = gradient(secant.as_flattened()[i], c);
            }
        }
    }
    let mut force = [[0.0; D]; S];
    let mut tangent: Tangent<f64, D, S> = [[[[0.0; D]; S]; D]; S];
    kernel.tangent(u, &mut force, &mut tangent);
    let mut secant_tangent: Tangent<f64, D, S> = [[[[0.0; D]; S]; D]; S];
    kernel.secant_tangent(viscosity, &from, u, &mut secant_tangent);
    let secant_rows = secant_tangent.as_flattened().as_flattened().as_flattened();
    let force = force.as_flattened();
    let rows = tangent.as_flattened().as_flattened().as_flattened();
    for i in 0..N {
        let error = (force[i] - energy_gradient[i]).abs();
        assert!(
            error <= 1e-12 * largest(force),
            "{name}: force {i} off by {error}"
        );
        for j in 0..N {
            let truth = force_gradient[i][j];
            let error = (rows[i * N + j] - truth).abs();
            assert!(
                error <= 1e-12 * largest(rows),
                "{name}: tangent {i}, {j} off by {error}"
            );
            let truth = secant_gradient[i][j];
            let error = (secant_rows[i * N + j] - truth).abs();
            assert!(
                error <= 1e-12 * largest(secant_rows),
                "{name}: secant tangent {i}, {j} off by {error}"
            );
            let skew = (rows[i * N + j] - rows[j * N + i]).abs();
            assert!(
                skew <= 1e-13 * largest(rows),
                "{name}: skew {i}, {j} by {skew}"
            );
        }
    }
}

/// Every family with every formulation it works with.
macro_rules! in_dimension {
    ($d:literal, $visit:ident, $check:ident) => {{
        const D: usize = $d;
        const Q: usize = 3 * D;
        const P: usize = 2 * (D + 1);
        for energy in [
            CableEnergy::MaterialCurvature,
            CableEnergy::GeometricCurvature,
        ] {
            let cable = EulerBernoulli::new(&rubber::<D>(0.3)).with_energy(energy);
            $visit!($check, Cable, cable, D, 4, { 4 * D });
            $visit!($check, Cable, CoMoving(cable), D, 4, { 4 * D });
        }
        let rod = StructuralMechanics::new(&rubber::<D>(0.3));
        let solid = Continuum::selective_reduced(rubber::<D>(0.3));
        $visit!($check, Quadratic, rod, D, Q, { D * Q });
        $visit!($check, Quadratic, solid.clone().axial(2), D, Q, { D * Q });
        $visit!($check, Quadratic, CoMoving(rod), D, Q, { D * Q });
        $visit!($check, FullyParameterised, CoMoving(solid.clone()), D, P, {
            D * P
        });
        $visit!($check, FullyParameterised, rod, D, P, { D * P });
        let points = Continuum::full(ByPoints(rubber::<D>(0.3)));
        $visit!($check, FullyParameterised, points, D, P, { D * P });
        $visit!($check, FullyParameterised, solid, D, P, { D * P });
    }};
}

macro_rules! straight {
    ($check:ident, $element:ident, $rule:expr, $d:expr, $s:expr, $n:expr) => {
        let rule = $rule;
        let name = format!("straight {} {rule:?}", stringify!($element));
        let reference = Reference::<f64, $d, $s>::straight(&$element, LENGTH, rotation());
        $check::<_, _, $d, $s, $n>(&name, $element, &rule, &reference);
    };
}

macro_rules! bent {
    ($check:ident, $element:ident, $rule:expr, $d:expr, $s:expr, $n:expr) => {
        let rule = $rule;
        let name = format!("curved {} {rule:?}", stringify!($element));
        if !($d == 3 && stringify!($element) == "Cable") {
            let reference = curved::<$element, $d, $s>();
            $check::<_, _, $d, $s, $n>(&name, $element, &rule, &reference);
        }
    };
}

#[test]
fn straight_elements_are_objective_and_their_derivatives_gradients() {
    in_dimension!(2, straight, check);
    in_dimension!(3, straight, check);
}

#[test]
fn curved_elements_are_objective_and_their_derivatives_gradients() {
    in_dimension!(2, bent, check);
    in_dimension!(3, bent, check);
}

/// Constant strain: the energy of a stretched, sheared or twisted bar, to rounding, and no force
/// on an inner node.
fn patch<E, F, const D: usize, const S: usize, const N: usize>(
    name: &str,
    element: E,
    formulation: &F,
    _: &Reference<f64, D, S>,
) where
    E: Element<D, S>,
    F: Formulation<f64, E, D, S>,
{
    let reference = Reference::<f64, D, S>::straight(&element, LENGTH, axes());
    let kernel = formulation.kernel(&element, &reference, &square()).unwrap();
    let (area, e, g) = (HEIGHT * HEIGHT, 0.01, 0.02);
    let mut motion = axes::<D>();
    motion[0][0] += e;
    let mut q = [[0.0; D]; S];
    let u = affine::<D, S, E>(&reference, &motion, 0.0);
    let engineering = 0.5 * YOUNG * area * LENGTH * e * e;
    let green = engineering * (1.0 + 0.5 * e).powi(2);
    let measured = kernel.energy(&u);
    let continuum = name.contains("Continuum");
    let truth = if name.contains("GeometricCurvature") {
        green
    } else {
        engineering
    };
    if !continuum {
        assert!(
            (measured / truth - 1.0).abs() < 1e-11,
            "{name}: {measured} not {truth}"
        );
    }
    kernel.force(&u, &mut q);
    for i in (0..S).filter(|i| is_position::<E, D, S>(*i)) {
        let node = i / E::VECTORS.len();
        let inner = node > 0 && node + 1 < E::NODES;
        let expected = if inner { 0.0 } else { YOUNG * area * e };
        let force = q[i][0].abs();
        assert!(
            (force - expected).abs() <= 0.4 * expected + 1e-9,
            "{name}, node {node}: {force}"
        );
    }
    if E::SECTION_DEGREE == 0 {
        return;
    }
    let shear = YOUNG / 2.6;
    let mut motion = axes::<D>();
    motion[1][0] = g;
    let measured = kernel.energy(&affine::<D, S, E>(&reference, &motion, 0.0));
    let truth = 0.5 * shear * area * LENGTH * g * g;
    // A Green-Lagrange continuum stretches by g^2/2 as it shears.
    let near = if continuum { 2.0 * g * g } else { 1e-11 };
    assert!(
        (measured / truth - 1.0).abs() < near,
        "{name}: {measured} not {truth}"
    );
    if D == 3 {
        let twist = 1e-4;
        let u = std::array::from_fn(|i| {
            let angle = twist * (i / E::VECTORS.len()) as f64 / (E::NODES - 1) as f64;
            let mut u = [0.0; D];
            match E::VECTORS[i % E::VECTORS.len()] {
                NodalVector::Slope(1) => u[2] = angle,
                NodalVector::Slope(2) => u[1] = -angle,
                _ => {}
            }
            u
        });
        let measured = kernel.energy(&u);
        let polar = 2.0 * HEIGHT.powi(4) / 12.0;
        let truth = 0.5 * shear * polar * twist * twist / LENGTH;
        assert!(
            (measured / truth - 1.0).abs() < 1e-5,
            "{name}: {measured} not {truth}"
        );
    }
}

#[test]
fn constant_strain_stores_what_a_bar_stores() {
    in_dimension!(2, straight, patch);
    in_dimension!(3, straight, patch);
}

/// Any linear field is met everywhere by its nodal values, constants first.
fn complete<E: Element<D, S>, const D: usize, const S: usize>(element: E) {
    let a: [[f64; D]; D] =
        std::array::from_fn(|i| std::array::from_fn(|j| ((3 * i + j + 1) as f64).cos()));
    for k in 0..20 {
        let x: [f64; D] = std::array::from_fn(|c| match c {
            0 => f64::from(k) / 19.0,
            _ if E::SECTION_DEGREE == 0 => 0.0,
            _ => 0.3 * f64::from(k * c as i32).sin(),
        });
        let s = element.shape(LENGTH, x);
        for c in 0..D {
            let mut field = 0.0;
            for (i, s) in s.into_iter().enumerate() {
                let node = i / E::VECTORS.len();
                let along = node as f64 / (E::NODES - 1) as f64;
                field += s * match E::VECTORS[i % E::VECTORS.len()] {
                    NodalVector::Position => 7.0 + a[c][0] * along * LENGTH,
                    NodalVector::Slope(b) => a[c][b],
                };
            }
            let exact = 7.0 + (0..D).map(|b| a[c][b] * x[b] * LENGTH).sum::<f64>();
            assert!(
                (field - exact).abs() < 1e-14 * 10.0,
                "{element:?}: {field} not {exact}"
            );
        }
    }
}

/// Mass and rotary inertia that a rigid motion feels.
fn mass<E: Element<D, S>, const D: usize, const S: usize>(element: E) {
    let reference = Reference::<f64, D, S>::straight(&element, LENGTH, axes());
    let inertia = Inertia::new(&element, &reference, &square(), 1000.0).unwrap();
    let area = HEIGHT * HEIGHT;
    let ones: [f64; S] = std::array::from_fn(|i| f64::from(u8::from(is_position::<E, D, S>(i))));
    let form = |v: &[f64; S]| -> f64 {
        (0..S)
            .map(|i| {
                (0..S)
                    .map(|j| v[i] * inertia.mass[i][j] * v[j])
                    .sum::<f64>()
            })
            .sum()
    };
    let total = 1000.0 * area * LENGTH;
    assert!((form(&ones) / total - 1.0).abs() < 1e-13, "{element:?}");
    let first: f64 = (0..S).map(|i| ones[i] * inertia.first[i]).sum();
    assert!((first / total - 1.0).abs() < 1e-13, "{element:?}");
    // Rotation in the plane of the first two axes: the velocities are (-y, x).
    let x: [f64; S] = std::array::from_fn(|i| reference.vectors[i][0]);
    let y: [f64; S] = std::array::from_fn(|i| reference.vectors[i][1]);
    let rotary = if E::SECTION_DEGREE == 0 {
        0.0
    } else {
        area * HEIGHT * HEIGHT / 12.0
    };
    let truth = total * LENGTH * LENGTH / 3.0 + 1000.0 * rotary * LENGTH;
    assert!(
        ((form(&x) + form(&y)) / truth - 1.0).abs() < 1e-13,
        "{element:?}"
    );
}

#[test]
fn elements_are_complete_and_weigh_what_they_should() {
    complete::<Cable, 2, 4>(Cable);
    complete::<Cable, 3, 4>(Cable);
    complete::<Quadratic, 2, 6>(Quadratic);
    complete::<Quadratic, 3, 9>(Quadratic);
    complete::<FullyParameterised, 2, 6>(FullyParameterised);
    complete::<FullyParameterised, 3, 8>(FullyParameterised);
    mass::<Cable, 2, 4>(Cable);
    mass::<Cable, 3, 4>(Cable);
    mass::<Quadratic, 2, 6>(Quadratic);
    mass::<Quadratic, 3, 9>(Quadratic);
    mass::<FullyParameterised, 2, 6>(FullyParameterised);
    mass::<FullyParameterised, 3, 8>(FullyParameterised);
}
