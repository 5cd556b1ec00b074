//! Claims about lanes: their arithmetic is that of the numbers they are made of, the lanes picked
//! at run time and the portable ones agree to rounding, and a chain of elements gives the same in
//! lanes as element by element, whatever its length and wherever in a group an element falls.

use ancf::formulation::{CableEnergy, ElementKernel, KernelWork, Reference, Tangent};
use ancf::prelude::*;
use ancf::scalar::{LaneWork, Lanes, Registers};
use ancf::solver::Matrix;
use ancf::verify::ByPoints;
use simba::simd::{WideF32x8, WideF64x4};

/// Every operation of a lane type on `count` numbers, padded to whole lanes.
struct Operations<R>(Vec<R>);

impl<R: Real> LaneWork<R> for Operations<R> {
    type Output = (usize, Vec<Vec<R>>);

    #[inline(always)]
    fn run<L: Lanes<R>>(self) -> Self::Output {
        let mut results: Vec<Vec<R>> = vec![];
        for group in self.0.chunks_exact(L::WIDTH) {
            let x = L::load(group);
            let mut sum = x;
            sum += x * x;
            sum -= L::lit(0.25);
            sum *= x;
            sum /= L::lit(3.0);
            let all = [
                x + L::one(),
                x - L::lit(2.0),
                x * x,
                x / L::lit(3.0),
                -x,
                x.sqrt(),
                x.recip(),
                x.exp(),
                x.ln(),
                x.sin(),
                x.cos(),
                x.powf(1.5),
                x.times(R::lit(7.0)),
                x.plus_times(R::lit(7.0), x),
                L::one().plus_product(x, x),
                L::lift(R::lit(0.1)) * x,
                sum,
            ];
            results.resize(all.len(), vec![]);
            for (result, y) in results.iter_mut().zip(all) {
                let mut values = vec![R::zero(); L::WIDTH];
                y.store(&mut values);
                result.extend(values);
            }
            assert!(!x.is_zero() && L::zero().is_zero());
        }
        (L::WIDTH, results)
    }
}

fn numbers<R: Real>() -> Vec<R> {
    (0..48).map(|i| R::lit(0.3 + 0.37 * f64::from(i))).collect()
}

fn agree<R: Real>(a: Vec<Vec<R>>, b: Vec<Vec<R>>, units: f64) {
    assert_eq!(a.len(), b.len());
    for (operation, (a, b)) in a.iter().zip(&b).enumerate() {
        assert_eq!(a.len(), b.len());
        for (a, b) in a.iter().zip(b) {
            let (a, b) = (a.value(), b.value());
            let error = (a - b).abs() / (1.0 + b.abs());
            assert!(
                error <= units * R::EPSILON,
                "operation {operation}: {a} and {b}"
            );
        }
    }
}

/// Sums and products round alike, fused ones once less; functions of other libraries differ by a
/// unit or two, and the power by the logarithm's error times its size.
#[test]
fn lanes_compute_what_numbers_compute() {
    let plain = Operations(numbers::<f64>()).run::<f64>();
    assert_eq!(plain.0, 1);
    let (width, picked) = f64::dispatch(Operations(numbers()));
    assert!(width >= 4);
    agree(picked, plain.1.clone(), 8.0);
    agree(Operations(numbers()).run::<WideF64x4>().1, plain.1, 8.0);
    let plain = Operations(numbers::<f32>()).run::<f32>();
    let (width, picked) = f32::dispatch(Operations(numbers()));
    assert!(width >= 8);
    agree(picked, plain.1.clone(), 8.0);
    agree(Operations(numbers()).run::<WideF32x8>().1, plain.1, 8.0);
}

/// Reads overlapping rows into columns and adds back those of some lanes.
struct Exchange<const PAIRED: bool>(usize, usize);

impl<R: Real, const PAIRED: bool> LaneWork<R> for Exchange<PAIRED> {
    type Output = ();
    const PAIRED: bool = PAIRED;

    #[inline(always)]
    fn run<L: Lanes<R>>(self) {
        // To the end of the last row and a little further.
        let start = |lane: usize| 3 * lane;
        let length = start(L::WIDTH - 1) + self.0 + self.1;
        let x: Vec<R> = (0..length).map(|i| R::lit(i as f64)).collect();
        let mut columns = vec![L::zero(); self.0];
        L::gather(&x, start, &mut columns);
        for lanes in 1..=L::WIDTH {
            let skipped = lanes / 2;
            // What is added to a signalling NaN makes it a quiet one.
            let untouched = f64::from_bits(0x7ff0_0000_0000_0001);
            let mut sum = vec![R::one(); x.len()];
            sum.resize(x.len() + 8, R::lit(untouched));
            let some = |lane: usize| (lane < lanes && lane != skipped).then(|| start(lane));
            L::scatter(&columns, &mut sum[..x.len()], some);
            let behind = sum.split_off(x.len());
            if size_of::<R>() == size_of::<f64>() {
                let untouched = |y: &R| y.value().to_bits() == untouched.to_bits();
                assert!(behind.iter().all(untouched), "behind {} columns", self.0);
            }
            let mut expected = vec![R::one(); x.len()];
            for lane in (0..lanes).filter(|lane| *lane != skipped) {
                for i in 0..self.0 {
                    expected[start(lane) + i] += x[start(lane) + i];
                }
            }
            assert_eq!(sum, expected, "{lanes} lanes of {} columns", self.0);
        }
    }
}

#[test]
fn rows_become_columns_and_rows_again() {
    for (columns, behind) in (0..=13).flat_map(|columns| (0..4).map(move |more| (columns, more))) {
        // Those of AVX2, too, of which every other test here gets the same bits.
        let widest = Registers::widest();
        for registers in Registers::available().filter(|one| *one > Registers::Baseline) {
            Registers::limit(registers);
            f64::dispatch(Exchange::<false>(columns, behind));
            f32::dispatch(Exchange::<false>(columns, behind));
            f64::dispatch(Exchange::<true>(columns, behind));
            f32::dispatch(Exchange::<true>(columns, behind));
        }
        Registers::limit(widest);
        LaneWork::<f64>::run::<WideF64x4>(Exchange::<false>(columns, behind));
        LaneWork::<f32>::run::<WideF32x8>(Exchange::<false>(columns, behind));
        LaneWork::<f64>::run::<f64>(Exchange::<false>(columns, behind));
    }
}

/// Adds columns to rows, of which the last begins somewhere.
struct Beyond<const PAIRED: bool>(usize);

impl<R: Real, const PAIRED: bool> LaneWork<R> for Beyond<PAIRED> {
    type Output = f64;
    const PAIRED: bool = PAIRED;

    #[inline(always)]
    fn run<L: Lanes<R>>(self) -> f64 {
        let start = |lane: usize| Some(if lane + 1 == L::WIDTH { self.0 } else { 0 });
        let mut x = [R::zero(); 8];
        L::scatter(&[L::one(); 5], &mut x, start);
        x[self.0 + 4].value()
    }
}

fn rows_stay_within<R: Real, const PAIRED: bool>() {
    assert_eq!(R::dispatch(Beyond::<PAIRED>(3)), 1.0);
    for start in [4, 9, usize::MAX - 4, usize::MAX] {
        let beyond = std::panic::catch_unwind(|| R::dispatch(Beyond::<PAIRED>(start)));
        assert!(beyond.is_err(), "from {start}");
    }
}

#[test]
fn rows_do_not_reach_beyond_what_they_are_added_to() {
    let widest = Registers::widest();
    for registers in Registers::available().filter(|one| *one > Registers::Baseline) {
        Registers::limit(registers);
        rows_stay_within::<f64, false>();
        rows_stay_within::<f32, false>();
        rows_stay_within::<f64, true>();
        rows_stay_within::<f32, true>();
    }
    Registers::limit(widest);
}

/// The number of lanes.
struct Width;

impl<R: Real, const D: usize, const S: usize> KernelWork<R, D, S> for Width {
    type Output = usize;

    #[inline(always)]
    fn run<L: Lanes<R>, K: ElementKernel<R, D, S>>(self, _kernel: &K) -> usize {
        L::WIDTH
    }
}

fn axis<R: Real, const D: usize>(k: usize) -> [R; D] {
    std::array::from_fn(|c| if c == k { R::one() } else { R::zero() })
}

type Solid<R, const D: usize> = SaintVenantKirchhoff<R, D>;

fn system<R, E, F, const D: usize, const S: usize>(element: E, rule: &F, n: usize) -> System<R, D>
where
    R: Real,
    E: Element<D, S>,
    F: Formulation<R, E, D, S> + Clone,
{
    let disk = Disk::new(R::lit(0.05)).unwrap();
    let beam = Beam::new(element, disk, rule.clone());
    let end = axis::<R, D>(0).map(|c| c * R::lit(0.25 * n as f64));
    let mut scene = Scene::<R, D>::new();
    scene.add(beam.straight([R::zero(); D], end, n)).unwrap();
    scene.assemble().unwrap()
}

fn largest<R: Real>(values: &[R]) -> f64 {
    values.iter().fold(0.0, |m, v| v.value().abs().max(m))
}

/// Energy, force and tangent of chains of 1 to 20 elements against their elements one by one.
fn check_chains<R, E, F, const D: usize, const S: usize>(element: E, rule: &F)
where
    R: Real,
    E: Element<D, S>,
    F: Formulation<R, E, D, S> + Clone,
{
    let disk = Disk::new(R::lit(0.05)).unwrap();
    let reference = Reference::straight(&element, R::lit(0.25), std::array::from_fn(axis));
    let kernel = rule.kernel(&element, &reference, &disk).unwrap();
    assert!(kernel.dispatch(Width) >= 4);
    let stride = (E::NODES - 1) * E::VECTORS.len() * D;
    // Rounding of some hundred terms on either side.
    let small = 200.0 * R::EPSILON;
    for n in 1..=20 {
        let system = system::<R, E, F, D, S>(element, rule, n);
        let mut state = system.rest();
        let size = state.displacement.len();
        for (i, u) in state.displacement.iter_mut().enumerate() {
            *u = R::lit(0.1 * (1.7 * i as f64).sin());
        }
        let u = &state.displacement;
        let (mut force, mut expected) = (vec![R::zero(); size], vec![R::zero(); size]);
        system.add_internal(u, &mut force);
        let mut tangent = Matrix::zero(system.unknowns(), true);
        let mut general = Matrix::zero(system.unknowns(), false);
        system
            .add_tangent(R::zero(), R::one(), u, &mut tangent)
            .unwrap();
        system
            .add_tangent(R::zero(), R::one(), u, &mut general)
            .unwrap();
        let mut sum = Matrix::zero(system.unknowns(), false);
        let mut energy = R::zero();
        for element in 0..n {
            let start = element * stride;
            let own: [[R; D]; S] =
                std::array::from_fn(|i| std::array::from_fn(|c| u[start + i * D + c]));
            energy += kernel.energy(&own);
            let mut q = [[R::zero(); D]; S];
            let mut k: Tangent<R, D, S> = [[[[R::zero(); D]; S]; D]; S];
            kernel.tangent(&own, &mut q, &mut k);
            for (e, q) in expected[start..].iter_mut().zip(q.as_flattened()) {
                *e += *q;
            }
            let block = k.as_flattened().as_flattened().as_flattened();
            sum.add_block(start, S * D, block).unwrap();
        }
        let elastic = system.energies(&state).unwrap().elastic;
        assert!(
            (elastic / energy - R::one()).value().abs() < small,
            "energy, {n}"
        );
        let top = largest(&expected);
        for (a, b) in force.iter().zip(&expected) {
            assert!(
                (*a - *b).value().abs() < small * top,
                "force of {n} elements"
            );
        }
        let entries = |m: &Matrix<R>| -> Vec<R> {
            (0..size)
                .flat_map(|i| (0..size).map(move |j| (i, j)))
                .map(|(i, j)| m.stored().get(i, j))
                .collect()
        };
        let expected = entries(&sum);
        let top = largest(&expected);
        for matrix in [&tangent, &general] {
            for (a, b) in entries(matrix).iter().zip(&expected) {
                assert!(
                    (*a - *b).value().abs() < small * top,
                    "tangent of {n} elements"
                );
            }
        }
    }
}

/// All formulations that run in lanes, of one dimension and number type.
macro_rules! check_all {
    ($r:ty, $d:literal, $s:literal, $q:literal) => {{
        let solid = Solid::<$r, $d>::isotropic(1e6, 0.3).unwrap();
        let rule = Continuum::selective_reduced(solid);
        check_chains::<$r, _, _, $d, $s>(FullyParameterised, &rule);
        let points = Continuum::full(ByPoints(solid));
        check_chains::<$r, _, _, $d, $s>(FullyParameterised, &points);
        check_chains::<$r, _, _, $d, $q>(Quadratic, &StructuralMechanics::new(&solid));
        for energy in [
            CableEnergy::MaterialCurvature,
            CableEnergy::GeometricCurvature,
        ] {
            let cable = EulerBernoulli::new(&solid).with_energy(energy);
            check_chains::<$r, _, _, $d, 4>(Cable, &cable);
        }
    }};
}

#[test]
fn a_chain_is_the_sum_of_its_elements() {
    check_all!(f64, 3, 8, 9);
    check_all!(f64, 2, 6, 6);
    check_all!(f32, 3, 8, 9);
    check_all!(f32, 2, 6, 6);
}

/// How a chain is held: some components of a nodal vector of a node.
type Hold = (usize, NodalVector, [bool; 3]);

/// Tangents of a chain held in some way, stored by one triangle or both, and those of its secant force,
/// which are not symmetric, against those of the free chain: `T^T K T` of the coordinates by the unknowns.
/// Elements of a bent chain come one by one.
fn check_held<R: Real>(bent: bool, holds: &[Hold], ties: &[[usize; 2]]) {
    let [zero, one] = [R::zero(), R::one()];
    let solid = Solid::<R, 3>::isotropic(R::lit(1e6), R::lit(0.3)).unwrap();
    for n in [1, 4, 7] {
        let clamped = |(node, _, held): &&Hold| *node <= n && *held == [true; 3];
        if holds.iter().filter(clamped).count() == 4 * (n + 1) {
            continue;
        }
        let system = |held: bool| {
            let mut scene = Scene::<R, 3>::new();
            let disk = Disk::new(R::lit(0.05)).unwrap();
            let length = R::lit(0.25 * n as f64);
            let beam = Beam::new(FullyParameterised, disk, Continuum::full(solid));
            let beam = match bent {
                false => beam.straight([zero; 3], [length, zero, zero], n),
                true => beam.curved(length, n, move |s| {
                    let (sin, cos) = (s * length).sin_cos();
                    let frame = [[cos, sin, zero], [-sin, cos, zero], [zero, zero, one]];
                    ([sin, one - cos, zero], frame)
                }),
            };
            let beam = scene.add(beam.density(R::lit(1e3))).unwrap();
            let holds = if held { holds } else { &[] };
            for (node, vector, components) in holds.iter().filter(|hold| hold.0 <= n) {
                scene.fix(beam.node(*node), *vector, *components).unwrap();
            }
            let ties = if held { ties } else { &[] };
            for nodes in ties.iter().filter(|tie| tie[1] <= n) {
                let [first, second] = nodes.map(|node| beam.node(node));
                let position = NodalVector::Position;
                let alike = [
                    (first, position, 1, one),
                    (second, position, 2, R::lit(-0.5)),
                ];
                scene.constrain(&alike).unwrap();
            }
            scene.assemble().unwrap()
        };
        let (free, held) = (system(false), system(true));
        let unknowns = held.unknowns();
        let size = unknowns.coordinates();
        let moved = |wave: f64| -> Vec<R> {
            (0..size)
                .map(|i| R::lit(0.1 * (wave * i as f64).sin()))
                .collect()
        };
        let (u, later) = (moved(1.7), moved(1.1));
        let tangent = |system: &System<R, 3>, symmetric| {
            let mut k = Matrix::zero(system.unknowns(), symmetric);
            system.add_tangent(zero, one, &u, &mut k).unwrap();
            system.add_mass(R::lit(3.0), &mut k).unwrap();
            k
        };
        let secant = |system: &System<R, 3>| {
            let mut k = Matrix::zero(system.unknowns(), false);
            let at = (zero, one);
            system
                .add_secant_tangent(at, zero, &u, &later, &mut k)
                .unwrap();
            k
        };
        let columns: Vec<Vec<R>> = (unknowns.free().iter())
            .map(|i| {
                let mut column = vec![zero; size];
                column[*i] = one;
                unknowns.follow(&mut column);
                column
            })
            .collect();
        let check = |k: &Matrix<R>, whole: &Matrix<R>| {
            let diagonal = (0..size).map(|i| whole.stored().get(i, i).value().abs());
            let small = 400.0 * R::EPSILON * diagonal.fold(0.0, f64::max);
            let mut product = vec![zero; size];
            for (q, column) in columns.iter().enumerate() {
                whole.stored().mul_vec(column, &mut product).unwrap();
                for (p, row) in columns.iter().enumerate() {
                    let expected: R = row.iter().zip(&product).map(|(a, b)| *a * *b).sum();
                    let own = k.stored().get(p, q);
                    assert!(
                        (own - expected).value().abs() < small,
                        "entry {p}, {q} of {n} elements, {holds:?}: {own} and not {expected}"
                    );
                }
            }
        };
        let whole = tangent(&free, false);
        check(&tangent(&held, true), &whole);
        check(&tangent(&held, false), &whole);
        check(&secant(&held), &secant(&free));
    }
}

fn check_supports<R: Real>(bent: bool) {
    use NodalVector::{Position, Slope};
    const ALL: [bool; 3] = [true; 3];
    let vectors = [Position, Slope(0), Slope(1), Slope(2)];
    let fix = |nodes: &[usize], held: [bool; 3]| -> Vec<Hold> {
        let node = |node: &usize| vectors.map(|vector| (*node, vector, held));
        nodes.iter().flat_map(node).collect()
    };
    let every: Vec<usize> = (0..=7).collect();
    let component = |c: usize| std::array::from_fn(|k| k == c);
    check_held::<R>(bent, &[], &[]);
    check_held::<R>(bent, &[(0, Position, ALL)], &[]);
    check_held::<R>(bent, &[(7, Position, ALL)], &[]);
    check_held::<R>(
        bent,
        &[(0, Position, ALL), (4, Position, [false, true, true])],
        &[],
    );
    check_held::<R>(bent, &[(2, Slope(1), [false, true, false])], &[]);
    check_held::<R>(bent, &fix(&[0], ALL), &[]);
    check_held::<R>(bent, &fix(&[3], ALL), &[]);
    check_held::<R>(bent, &fix(&[4, 7], ALL), &[]);
    // Groups of which all is held, beside nodes that are free.
    check_held::<R>(bent, &fix(&every[..5], ALL), &[]);
    check_held::<R>(bent, &fix(&every[..2], ALL), &[]);
    // Many stretches: as many as go in lanes, and more than do where nodes are held in turn.
    for c in 0..3 {
        check_held::<R>(bent, &fix(&every, component(c)), &[]);
        check_held::<R>(bent, &fix(&[c], component(c)), &[]);
    }
    let in_turn: Vec<Hold> = (0..=7).flat_map(|k| fix(&[k], component(k % 3))).collect();
    check_held::<R>(bent, &in_turn, &[]);
    // Coordinates that follow others.
    check_held::<R>(bent, &[(0, Position, ALL)], &[[1, 2]]);
    check_held::<R>(bent, &fix(&[7], ALL), &[[3, 5]]);
}

#[test]
fn tangents_of_held_chains_are_those_of_free_ones_less_what_is_held() {
    check_supports::<f64>(false);
    check_supports::<f32>(false);
    check_supports::<f64>(true);
}

/// All nodes displaced alike strain all elements alike: forces on inner nodes are then the same to
/// the last bit, wherever groups of lanes begin and end.
#[test]
fn equal_elements_give_equal_forces_to_the_last_bit() {
    let solid = Solid::<f64, 3>::isotropic(1e6, 0.3).unwrap();
    for n in [2, 7, 21] {
        let system = system::<f64, _, _, 3, 8>(FullyParameterised, &Continuum::full(solid), n);
        let displacement = |i: usize| 0.1 * (1.3 * (i % 12) as f64).cos();
        let u: Vec<f64> = (0..12 * (n + 1)).map(displacement).collect();
        let mut q = vec![0.0; u.len()];
        system.add_internal(&u, &mut q);
        let inner: Vec<_> = q[12..12 * n].chunks(12).collect();
        assert!(largest(inner[0]) > 1.0);
        assert!(inner.iter().all(|node| node == &inner[0]), "{n} elements");
    }
}
