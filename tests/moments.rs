//! Claims about elements integrated once and for all: energy, force and tangent by the quadratic form
//! are those of the very rule the form was taken from, for every section, remedy, dimension and
//! number type, to rounding. The independent truth is the same material with its constant
//! elasticity hidden, which is sampled point by point.

use ancf::formulation::{ElementKernel, Reference, Tangent};
use ancf::prelude::*;
use ancf::verify::{self, ByPoints};
use num_dual::{Dual, Dual64};
use simba::simd::WideF64x4;

const LENGTH: f64 = 0.3;

fn sections<R: Real>() -> Vec<Box<dyn Section<R>>> {
    let lit = R::lit;
    let mut all: Vec<Box<dyn Section<R>>> = vec![
        Box::new(Disk::new(lit(0.04)).unwrap()),
        Box::new(Annulus::new(lit(0.05), lit(0.03)).unwrap()),
        Box::new(Rectangle::new(lit(0.08), lit(0.03)).unwrap()),
        Box::new(Offset::new(Disk::new(lit(0.02)).unwrap(), [lit(0.05), lit(-0.03)]).unwrap()),
    ];
    // Fitting a rule to an outline in double-doubles takes seconds.
    if R::EPSILON > 1e-20 {
        let (h, b, t) = (lit(0.1), lit(0.06), lit(0.01));
        all.push(Box::new(l_profile(h, b, t).unwrap()));
    }
    all
}

type Pair<M> = (Continuum<M>, Continuum<ByPoints<M>>);

/// Every remedy with the material as it is and hidden.
fn remedies<R: Real, const D: usize>() -> Vec<Pair<SaintVenantKirchhoff<R, D>>> {
    let rubber = SaintVenantKirchhoff::<R, D>::isotropic(R::lit(2.0e7), R::lit(0.3)).unwrap();
    let all = [
        Continuum::full(rubber),
        Continuum::reduced(rubber),
        Continuum::sampled(rubber, 3, 7),
        Continuum::zero_poisson(rubber),
        Continuum::selective_reduced(rubber),
        Continuum::layered([
            Layer {
                material: rubber.uncoupled(),
                axial: 5,
                across: Across::Degree(5),
            },
            Layer {
                material: rubber.coupled(),
                axial: 4,
                across: Across::Centroid,
            },
        ]),
    ];
    let hide = |c: &Continuum<_>| {
        Continuum::layered(c.layers().iter().map(|layer: &Layer<_>| Layer {
            material: ByPoints(layer.material),
            axial: layer.axial,
            across: layer.across,
        }))
    };
    all.into_iter().map(|c| (c.clone(), hide(&c))).collect()
}

/// A frame turned out of the global axes.
fn frame<R: Real, const D: usize>() -> [[R; D]; D] {
    let ((s, c), (p, q)) = (
        (R::lit(0.7).sin(), R::lit(0.7).cos()),
        (R::lit(0.4).sin(), R::lit(0.4).cos()),
    );
    let zero = R::zero();
    let space = [[c * q, s * q, p], [-s, c, zero], [-c * p, -s * p, q]];
    let plane = [[c, s, zero], [-s, c, zero], [zero; 3]];
    std::array::from_fn(|a| std::array::from_fn(|i| if D == 3 { space[a][i] } else { plane[a][i] }))
}

/// A state with displacements of `size` (of the length for positions).
fn state<const D: usize, const S: usize>(size: f64, seed: usize) -> [[f64; D]; S] {
    std::array::from_fn(|i| {
        let unit = if i % (D + 1) == 0 { LENGTH } else { 1.0 };
        std::array::from_fn(|c| size * unit * ((7 * i + 3 * c + seed) as f64).sin())
    })
}

/// Largest difference of energy, force and tangent of two kernels, each over the largest entry,
/// in all the parts that `parts` takes from a number.
fn difference<R, T, A, B, const D: usize, const S: usize>(
    (a, b): (&A, &B),
    u: &[[T; D]; S],
    parts: impl Fn(T) -> Vec<f64>,
) -> f64
where
    R: Real,
    T: Algebra<R>,
    A: ElementKernel<R, D, S>,
    B: ElementKernel<R, D, S>,
{
    let zero = T::zero();
    let evaluate =
        |out: &mut [Vec<T>; 4], energy: T, force: [[T; D]; S], q, k: Tangent<T, D, S>| {
            let q: [[T; D]; S] = q;
            let flat = k.as_flattened().as_flattened().as_flattened().to_vec();
            *out = [
                vec![energy],
                force.as_flattened().to_vec(),
                q.as_flattened().to_vec(),
                flat,
            ];
        };
    let mut results: [[Vec<T>; 4]; 2] = std::array::from_fn(|_| std::array::from_fn(|_| vec![]));
    let (mut f, mut q, mut k) = ([[zero; D]; S], [[zero; D]; S], [[[[zero; D]; S]; D]; S]);
    a.force(u, &mut f);
    a.tangent(u, &mut q, &mut k);
    evaluate(&mut results[0], a.energy(u), f, q, k);
    let (mut f, mut q, mut k) = ([[zero; D]; S], [[zero; D]; S], [[[[zero; D]; S]; D]; S]);
    b.force(u, &mut f);
    b.tangent(u, &mut q, &mut k);
    evaluate(&mut results[1], b.energy(u), f, q, k);
    let mut worst: f64 = 0.0;
    for (a, b) in results[0].iter().zip(&results[1]) {
        let count = parts(a[0]).len();
        for part in 0..count {
            let values = |v: &[T]| v.iter().map(|x| parts(*x)[part]).collect::<Vec<_>>();
            let (a, b) = (values(a), values(b));
            let size = b.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            assert!(size > 0.0, "nothing to compare");
            for (a, b) in a.iter().zip(&b) {
                assert!(a.is_finite() && b.is_finite());
                worst = worst.max((a - b).abs() / size);
            }
        }
    }
    worst
}

/// Largest difference over all sections, remedies and three states: small, large, absurd.
fn worst<R: Real, T: Algebra<R>, E, const D: usize, const S: usize>(
    element: E,
    lift: impl Fn(f64, usize) -> T,
    parts: impl Fn(T) -> Vec<f64>,
) -> f64
where
    E: Element<D, S>,
    Continuum<SaintVenantKirchhoff<R, D>>: Formulation<R, E, D, S>,
    Continuum<ByPoints<SaintVenantKirchhoff<R, D>>>: Formulation<R, E, D, S>,
{
    let reference = Reference::straight(&element, R::lit(LENGTH), frame::<R, D>());
    let mut worst: f64 = 0.0;
    for section in sections::<R>() {
        for (plain, hidden) in remedies::<R, D>() {
            let moments = plain.kernel(&element, &reference, &*section).unwrap();
            let points = hidden.kernel(&element, &reference, &*section).unwrap();
            for (seed, size) in [1e-2, 0.5, 10.0].into_iter().enumerate() {
                let values = state::<D, S>(size, seed);
                let u =
                    std::array::from_fn(|i| std::array::from_fn(|c| lift(values[i][c], i * D + c)));
                worst = worst.max(difference((&moments, &points), &u, &parts));
            }
        }
    }
    worst
}

/// Rounding of some hundred terms, few of which cancel: 200 units are far above what is seen and
/// far below any moment left out.
const UNITS: f64 = 200.0;

#[test]
fn moments_are_the_rule_in_double_precision() {
    let real = |x: f64| vec![x];
    let space = worst::<f64, f64, _, 3, 8>(FullyParameterised, |x, _| x, real);
    let plane = worst::<f64, f64, _, 2, 6>(FullyParameterised, |x, _| x, real);
    assert!(
        space.max(plane) < UNITS * f64::EPSILON,
        "{space:e} {plane:e}"
    );
}

/// A planar element of three nodes, each with all its slopes: an odd number of nodal vectors.
#[derive(Debug, Clone, Copy)]
struct ThreeNodes;

impl Element<2, 9> for ThreeNodes {
    const NODES: usize = 3;
    const VECTORS: &'static [NodalVector] = &[
        NodalVector::Position,
        NodalVector::Slope(0),
        NodalVector::Slope(1),
    ];
    const AXIAL_DEGREE: usize = 5;

    fn shape<T: Scalar>(&self, l: T, [xi, eta]: [T; 2]) -> [T; 9] {
        let lit = T::lit;
        // Each node with its Lagrange polynomial and the slope of this there.
        let nodes = [
            (lit(0.0), lit(2.0) * (xi - lit(0.5)) * (xi - lit(1.0)), -3.0),
            (lit(0.5), lit(4.0) * xi * (lit(1.0) - xi), 0.0),
            (lit(1.0), lit(2.0) * xi * (xi - lit(0.5)), 3.0),
        ];
        let mut shape = [T::zero(); 9];
        for (vectors, (at, lagrange, slope)) in shape.chunks_mut(3).zip(nodes) {
            let square = lagrange * lagrange;
            vectors[0] = (T::one() - lit(2.0 * slope) * (xi - at)) * square;
            vectors[1] = l * (xi - at) * square;
            vectors[2] = l * eta * lagrange;
        }
        shape
    }
}

#[test]
fn moments_are_the_rule_for_any_number_of_vectors() {
    verify::element(&ThreeNodes, LENGTH).into_result().unwrap();
    let alone = worst::<f64, f64, _, 2, 9>(ThreeNodes, |x, _| x, |x| vec![x]);
    let quadratic = worst::<f64, f64, _, 3, 9>(Quadratic, |x, _| x, |x| vec![x]);
    assert!(
        alone.max(quadratic) < UNITS * f64::EPSILON,
        "{alone:e} {quadratic:e}"
    );
}

#[test]
fn moments_are_the_rule_in_single_precision() {
    let real = |x: f32| vec![f64::from(x)];
    let space = worst::<f32, f32, _, 3, 8>(FullyParameterised, |x, _| x as f32, real);
    let plane = worst::<f32, f32, _, 2, 6>(FullyParameterised, |x, _| x as f32, real);
    let unit = f64::from(f32::EPSILON);
    assert!(space.max(plane) < UNITS * unit, "{space:e} {plane:e}");
}

#[test]
fn moments_are_the_rule_in_dual_numbers() {
    let dual = |x: f64, i: usize| Dual64::new(x, (1.3 * i as f64).cos());
    let both = |x: Dual64| vec![x.re, x.eps];
    let inner = worst::<f64, Dual64, _, 3, 8>(FullyParameterised, dual, both);
    let outer = worst::<Dual<f64>, Dual<f64>, _, 2, 6>(FullyParameterised, dual, both);
    assert!(
        inner.max(outer) < UNITS * f64::EPSILON,
        "{inner:e} {outer:e}"
    );
}

#[test]
fn moments_are_the_rule_in_lanes() {
    let lanes = |x: f64, _| WideF64x4::from([x, 2.0 * x, -x, 0.1 * x]);
    let parts = |x: WideF64x4| <[f64; 4]>::from(x.0).to_vec();
    let space = worst::<f64, WideF64x4, _, 3, 8>(FullyParameterised, lanes, parts);
    let plane = worst::<f64, WideF64x4, _, 2, 6>(FullyParameterised, lanes, parts);
    assert!(
        space.max(plane) < UNITS * f64::EPSILON,
        "{space:e} {plane:e}"
    );
}

#[cfg(feature = "double-double")]
mod precise {
    use super::*;
    use ancf::scalar::DoubleDouble;

    #[test]
    fn moments_are_the_rule_in_double_doubles() {
        let real = |x: DoubleDouble| vec![x.value()];
        let lift = |x, _| DoubleDouble::lit(x);
        let space = worst::<DoubleDouble, DoubleDouble, _, 3, 8>(FullyParameterised, lift, real);
        // Compared in f64, whose rounding is all there is to see.
        assert!(space < 4.0 * f64::EPSILON, "{space:e}");
    }

    /// The force of a bent slender element in double precision, against both laws in
    /// double-double at the same state: moments lose no digit that the rule keeps.
    #[test]
    fn moments_keep_the_digits_of_slender_beams() {
        for slenderness in [1e-2, 1e-4] {
            let error = |hidden: bool| {
                fn force<R: Real>(hidden: bool, radius: f64) -> [[R; 3]; 8] {
                    let solid = SaintVenantKirchhoff::isotropic(R::lit(2e7), R::lit(0.3)).unwrap();
                    let disk = Disk::new(R::lit(radius)).unwrap();
                    let axes = std::array::from_fn(|a| {
                        std::array::from_fn(|c| R::lit(f64::from(u8::from(a == c))))
                    });
                    let reference = Reference::straight(&FullyParameterised, R::one(), axes);
                    // The arc of a quarter radian: slopes turn by 1/8 to either side.
                    let (s, c) = 0.125_f64.sin_cos();
                    let mut u = [[R::zero(); 3]; 8];
                    u[1] = [R::lit(c - 1.0), R::lit(-s), R::zero()];
                    u[2] = [R::lit(s), R::lit(c - 1.0), R::zero()];
                    u[4] = [R::lit(8.0 * s - 1.0), R::zero(), R::zero()];
                    u[5] = [R::lit(c - 1.0), R::lit(s), R::zero()];
                    u[6] = [R::lit(-s), R::lit(c - 1.0), R::zero()];
                    let mut q = [[R::zero(); 3]; 8];
                    fn add<R: Real>(
                        rule: &impl Formulation<R, FullyParameterised, 3, 8>,
                        (reference, disk): (&Reference<R, 3, 8>, &Disk<R>),
                        (u, q): (&[[R; 3]; 8], &mut [[R; 3]; 8]),
                    ) {
                        let kernel = rule.kernel(&FullyParameterised, reference, disk);
                        kernel.unwrap().force(u, q);
                    }
                    let (on, at) = ((&reference, &disk), (&u, &mut q));
                    match hidden {
                        true => add(&Continuum::full(ByPoints(solid)), on, at),
                        false => add(&Continuum::full(solid), on, at),
                    }
                    q
                }
                let truth = force::<DoubleDouble>(true, slenderness);
                let force = force::<f64>(hidden, slenderness);
                let pairs = truth.as_flattened().iter().zip(force.as_flattened());
                pairs.fold(0.0_f64, |m, (t, f)| m.max((t.value() - f).abs()))
            };
            let (moments, points) = (error(false), error(true));
            assert!(
                moments < 4.0 * points,
                "slenderness {slenderness}: {moments:e} N against {points:e} N"
            );
        }
    }
}
