//! Time of the kernels and of whole steps: `cargo bench --bench speed`. Force and tangent of every
//! element with every formulation in `f64` and `f32`, alone, in lanes and in a chain; steps of the
//! paper's pendulum and of pendulums of 4 to 65 536 elements; a static Newton iteration and the
//! factorisation in it.
#![allow(
    missing_docs,
    reason = "criterion's macros define items without documentation"
)]

use std::hint::black_box;
use std::time::{Duration, Instant};

use ancf::formulation::{ElementKernel, Reference};
use ancf::prelude::*;
use ancf::scalar::LaneWork;
use ancf::solver::{Factor, Matrix};
use ancf::verify::ByPoints;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use timed::Timed;

mod timed;

fn rubber<R: Real, const D: usize>() -> SaintVenantKirchhoff<R, D> {
    SaintVenantKirchhoff::isotropic(R::lit(2.0e7), R::lit(0.3)).expect("admissible constants")
}

fn axes<R: Real, const D: usize>() -> [[R; D]; D] {
    std::array::from_fn(|a| std::array::from_fn(|c| if a == c { R::one() } else { R::zero() }))
}

/// Force and tangent of one kernel: alone, and in the lanes that suit the processor.
fn kernel<R, Kn, const D: usize, const S: usize>(c: &mut Criterion, name: &str, kernel: &Kn)
where
    R: Real,
    Kn: ElementKernel<R, D, S>,
{
    let mut group = c.benchmark_group(name);
    for (what, tangent) in [("force", false), ("force and tangent", true)] {
        let timed = |times| Timed {
            kernel,
            tangent,
            times,
        };
        group.throughput(Throughput::Elements(1));
        group.bench_function(BenchmarkId::new(what, "alone"), |b| {
            b.iter_custom(|times| timed(times).run::<R>().1);
        });
        let (width, _) = R::dispatch(timed(1));
        group.throughput(Throughput::Elements(width as u64));
        group.bench_function(BenchmarkId::new(what, format!("{width} lanes")), |b| {
            b.iter_custom(|times| R::dispatch(timed(times)).1);
        });
    }
    group.finish();
}

/// A formulation on one straight element, then in a chain with gather, scatter and assembly.
fn formulation<R, E, F, const D: usize, const S: usize>(
    c: &mut Criterion,
    name: &str,
    element: E,
    law: F,
) where
    R: Real,
    E: Element<D, S>,
    F: Formulation<R, E, D, S>,
{
    let room = if D == 3 { "space" } else { "plane" };
    let name = format!("{room}, {}-byte numbers, {name}", size_of::<R>());
    let disk = Disk::new(R::lit(0.01)).expect("a radius");
    let reference = Reference::straight(&element, R::lit(0.1), axes::<R, D>());
    let one = law.kernel(&element, &reference, &disk);
    kernel(c, &name, &one.expect("a rule of full rank"));
    const CHAIN: usize = 64;
    let mut scene = Scene::<R, D>::new();
    let beam = Beam::new(element, disk, law);
    scene
        .add(beam.straight([R::zero(); D], axes::<R, D>()[0], CHAIN))
        .expect("a beam");
    let system = scene.assemble().expect("a system");
    let size = system.reference().len();
    let u: Vec<R> = (0..size).map(|i| R::lit(1e-2 * (i as f64).sin())).collect();
    let mut q = vec![R::zero(); size];
    let mut k = Matrix::zero(system.unknowns(), true);
    let mut group = c.benchmark_group(name);
    group.throughput(Throughput::Elements(CHAIN as u64));
    group.bench_function(BenchmarkId::new("force", "chain of 64"), |b| {
        b.iter(|| system.add_internal(black_box(&u), &mut q));
    });
    group.bench_function(BenchmarkId::new("force and tangent", "chain of 64"), |b| {
        b.iter(|| {
            system
                .add_tangent(R::zero(), R::one(), black_box(&u), &mut k)
                .expect("a tangent");
        });
    });
    group.finish();
}

/// Every element with its formulations, in one dimension and number type.
macro_rules! elements {
    ($c:ident, $r:ty, $d:literal, $s:literal, $q:literal) => {{
        let solid = rubber::<$r, $d>();
        let points = Continuum::full(ByPoints(solid));
        let name = "fully parameterised, section points";
        formulation::<$r, _, _, $d, $s>($c, name, FullyParameterised, points);
        // Any remedy costs the same.
        let once = Continuum::selective_reduced(solid);
        let name = "fully parameterised, section once";
        formulation::<$r, _, _, $d, $s>($c, name, FullyParameterised, once.clone());
        formulation::<$r, _, _, $d, $q>($c, "quadratic continuum", Quadratic, once.axial(2));
        let rod = StructuralMechanics::new(&solid);
        formulation::<$r, _, _, $d, $q>($c, "quadratic rod", Quadratic, rod);
        formulation::<$r, _, _, $d, 4>($c, "cable", Cable, EulerBernoulli::new(&solid));
    }};
}

/// What the co-moving frame adds to the 35 points of full integration.
fn co_moving<R: Real>(c: &mut Criterion, name: &str) {
    let rule = Continuum::full(ByPoints(rubber::<R, 3>()));
    let disk = Disk::new(R::lit(0.01)).expect("a radius");
    let reference = Reference::straight(&FullyParameterised, R::lit(0.1), axes::<R, 3>());
    let plain = rule
        .kernel(&FullyParameterised, &reference, &disk)
        .expect("a rule of full rank");
    let moving = CoMoving(rule)
        .kernel(&FullyParameterised, &reference, &disk)
        .expect("a rule of full rank");
    kernel(c, &format!("{name}, plain"), &plain);
    kernel(c, &format!("{name}, co-moving"), &moving);
}

/// The paper's pendulum of a length (m) with `n` elements.
fn pendulum<const D: usize, const S: usize>(length: f64, n: usize) -> System<f64, D>
where
    FullyParameterised: Element<D, S>,
    Continuum<SaintVenantKirchhoff<f64, D>>: Formulation<f64, FullyParameterised, D, S>,
{
    let axis = |k: usize, v: f64| std::array::from_fn(|c| if c == k { v } else { 0.0 });
    let mut scene = Scene::<f64, D>::new();
    let disk = Disk::new(0.01).expect("a radius");
    let solid = SaintVenantKirchhoff::isotropic(2.0e7, 0.0).expect("admissible constants");
    let beam = Beam::new(FullyParameterised, disk, Continuum::full(solid))
        .straight([0.0; D], axis(0, length), n)
        .density(7200.0);
    let beam = scene.add(beam).expect("a beam");
    scene.pin(beam.start()).expect("a node");
    scene.gravity(axis(1, -9.81)).expect("finite gravity");
    scene.assemble().expect("a system")
}

fn steps<const D: usize, const S: usize>(c: &mut Criterion, name: &str)
where
    FullyParameterised: Element<D, S>,
    Continuum<SaintVenantKirchhoff<f64, D>>: Formulation<f64, FullyParameterised, D, S>,
{
    let mut group = c.benchmark_group(name);
    group.sample_size(10);
    let system = pendulum::<D, S>(1.0, 10);
    for refresh in [
        Refresh::EveryIteration,
        Refresh::EverySolve,
        Refresh::WhenSlow,
    ] {
        group.throughput(Throughput::Elements(200));
        group.bench_function(format!("200 steps, tangent {refresh:?}"), |b| {
            b.iter(|| {
                let newton = Newton {
                    refresh,
                    ..Newton::default()
                };
                let method = Newmark::trapezoidal().with_newton(newton);
                let mut run = Integration::start(&system, system.rest(), &method).expect("a run");
                run.until(0.2, Stepping::Fixed(1e-3), |_| {})
                    .expect("0.2 s");
                run.into_state()
            });
        });
    }
    group.finish();
}

/// Steps from rest of pendulums whose elements are all of the same length: every element has the same
/// work to do, however many there are.
fn sizes<const D: usize, const S: usize>(c: &mut Criterion, name: &str)
where
    FullyParameterised: Element<D, S>,
    Continuum<SaintVenantKirchhoff<f64, D>>: Formulation<f64, FullyParameterised, D, S>,
{
    let mut group = c.benchmark_group(name);
    group.sample_size(10);
    for n in [4, 16, 64, 256, 1024, 4096, 16384, 65536] {
        let system = pendulum::<D, S>(0.1 * n as f64, n);
        group.throughput(Throughput::Elements(4 * n as u64));
        group.bench_function(BenchmarkId::from_parameter(n), |b| {
            b.iter_custom(|times| {
                let mut spent = Duration::ZERO;
                for _ in 0..times {
                    let method = Newmark::trapezoidal();
                    let run = Integration::start(&system, system.rest(), &method);
                    let mut run = run.expect("a run");
                    let start = Instant::now();
                    run.until(4e-3, Stepping::Fixed(1e-3), |_| {})
                        .expect("four steps");
                    spent += start.elapsed();
                }
                spent
            });
        });
    }
    group.finish();
}

/// Residual, tangent, factors and correction of a static Newton iteration.
fn iteration<R: Real, const D: usize, const S: usize>(c: &mut Criterion, name: &str)
where
    FullyParameterised: Element<D, S>,
    Continuum<SaintVenantKirchhoff<R, D>>: Formulation<R, FullyParameterised, D, S>,
{
    let mut group = c.benchmark_group(name);
    group.sample_size(10);
    for n in [64, 65536] {
        let mut scene = Scene::<R, D>::new();
        let disk = Disk::new(R::lit(0.01)).expect("a radius");
        let beam = Beam::new(FullyParameterised, disk, Continuum::full(rubber()));
        let mut end = [R::zero(); D];
        end[0] = R::lit(0.1 * n as f64);
        let beam = scene.add(beam.straight([R::zero(); D], end, n));
        scene.clamp(beam.expect("a beam").start()).expect("a node");
        let system = scene.assemble().expect("a system");
        let u = system.rest().displacement;
        let mut q = vec![R::zero(); u.len()];
        let mut k = Matrix::zero(system.unknowns(), true);
        let mut factor = Factor::new(system.unknowns().profile(), true);
        let mut x = vec![R::one(); system.unknowns().count()];
        group.throughput(Throughput::Elements(n as u64));
        group.bench_function(BenchmarkId::from_parameter(n), |b| {
            b.iter(|| {
                q.fill(R::zero());
                system.add_internal(black_box(&u), &mut q);
                k.clear();
                system
                    .add_tangent(R::zero(), R::one(), &u, &mut k)
                    .expect("a tangent");
                factor.factor(k.stored()).expect("a definite matrix");
                x.fill(R::one());
                factor.solve(&mut x).expect("factors");
            });
        });
    }
    group.finish();
}

fn factorisation(c: &mut Criterion) {
    let mut group = c.benchmark_group("factor and solve, spatial chain");
    for n in [10, 100, 1000] {
        let system = pendulum::<3, 8>(1.0, n);
        let u = system.rest().displacement;
        let mut k = Matrix::zero(system.unknowns(), true);
        system.add_tangent(0.0, 1.0, &u, &mut k).expect("a tangent");
        system.add_mass(4e6, &mut k).expect("the same profile");
        let mut x = vec![0.0; system.unknowns().count()];
        let mut factor = Factor::new(system.unknowns().profile(), true);
        group.throughput(Throughput::Elements(n as u64));
        group.bench_function(BenchmarkId::from_parameter(n), |b| {
            b.iter(|| {
                factor.factor(k.stored()).expect("a definite matrix");
                x.fill(1.0);
                factor.solve(&mut x).expect("factors");
            });
        });
    }
    group.finish();
}

fn all(c: &mut Criterion) {
    elements!(c, f64, 3, 8, 9);
    elements!(c, f64, 2, 6, 6);
    elements!(c, f32, 3, 8, 9);
    elements!(c, f32, 2, 6, 6);
    co_moving::<f32>(c, "co-moving frame, f32");
    co_moving::<f64>(c, "co-moving frame, f64");
    steps::<3, 8>(c, "pendulum in space, 10 elements");
    steps::<2, 6>(c, "pendulum in the plane, 10 elements");
    sizes::<3, 8>(c, "four steps in space, elements");
    sizes::<2, 6>(c, "four steps in the plane, elements");
    iteration::<f64, 3, 8>(c, "static iteration in space, f64, elements");
    iteration::<f32, 3, 8>(c, "static iteration in space, f32, elements");
    iteration::<f64, 2, 6>(c, "static iteration in the plane, f64, elements");
    factorisation(c);
}

/// Short measurements: a hundred and more rows are told apart by far more than their noise.
fn settings() -> Criterion {
    Criterion::default()
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_millis(800))
        .sample_size(20)
}

criterion_group!(name = benches; config = settings(); targets = all);
criterion_main!(benches);
