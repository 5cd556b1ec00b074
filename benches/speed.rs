//! Time of the kernels: `cargo bench --bench speed`. Force and tangent of every element with every
//! formulation in `f64` and `f32`, alone, in lanes and in a chain.
#![allow(
    missing_docs,
    reason = "criterion's macros define items without documentation"
)]

use std::hint::black_box;
use std::time::Duration;

use ancf::formulation::{ElementKernel, Reference};
use ancf::prelude::*;
use ancf::scalar::Registers;
use ancf::solver::Matrix;
use ancf::verify::ByPoints;
use criterion::measurement::WallTime;
use criterion::{
    BenchmarkGroup, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main,
};
use timed::Timed;

mod timed;

fn rubber<R: Real, const D: usize>() -> SaintVenantKirchhoff<R, D> {
    SaintVenantKirchhoff::isotropic(R::lit(2.0e7), R::lit(0.3)).expect("admissible constants")
}

fn axes<R: Real, const D: usize>() -> [[R; D]; D] {
    std::array::from_fn(|a| std::array::from_fn(|c| if a == c { R::one() } else { R::zero() }))
}

/// One kernel, force or tangent, alone.
fn alone<R, Kn, const TANGENT: bool, const D: usize, const S: usize>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    name: &str,
    kernel: &Kn,
) where
    R: Real,
    Kn: ElementKernel<R, D, S>,
{
    group.throughput(Throughput::Elements(1));
    group.bench_function(name, |b| {
        b.iter_custom(|times| timed::alone::<R, _, TANGENT, D, S>(kernel, times).1);
    });
}

/// One kernel, force or tangent: alone, and in lanes as chains have it, of AVX2 and of the widest
/// registers, which tangents do not use.
fn evaluation<R, Kn, const TANGENT: bool, const D: usize, const S: usize>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    kernel: &Kn,
) where
    R: Real,
    Kn: ElementKernel<R, D, S>,
{
    let what = if TANGENT { "tangent" } else { "force" };
    alone::<R, _, TANGENT, D, S>(group, &format!("{what}/alone"), kernel);
    let timed = |times| kernel.dispatch(Timed::<TANGENT> { times });
    let widest = Registers::widest();
    let most = if TANGENT { Registers::Avx2 } else { widest };
    for registers in Registers::available().filter(|one| *one > Registers::Baseline && *one <= most)
    {
        Registers::limit(registers);
        let (width, _) = timed(1);
        group.throughput(Throughput::Elements(width as u64));
        let name = format!("{registers:?}, {width} elements");
        group.bench_function(BenchmarkId::new(what, name), |b| {
            b.iter_custom(|times| timed(times).1);
        });
    }
    Registers::limit(widest);
}

fn kernel<R, Kn, const D: usize, const S: usize>(c: &mut Criterion, name: &str, kernel: &Kn)
where
    R: Real,
    Kn: ElementKernel<R, D, S>,
{
    let mut group = c.benchmark_group(name);
    evaluation::<R, _, false, D, S>(&mut group, kernel);
    evaluation::<R, _, true, D, S>(&mut group, kernel);
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
    group.bench_function(BenchmarkId::new("tangent", "chain of 64"), |b| {
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
        let name = "fully parameterised, section once, co-moving";
        formulation::<$r, _, _, $d, $s>($c, name, FullyParameterised, CoMoving(once.clone()));
        formulation::<$r, _, _, $d, $q>($c, "quadratic continuum", Quadratic, once.axial(2));
        let rod = StructuralMechanics::new(&solid);
        formulation::<$r, _, _, $d, $q>($c, "quadratic rod", Quadratic, rod);
        formulation::<$r, _, _, $d, 4>($c, "cable", Cable, EulerBernoulli::new(&solid));
    }};
}

/// What the co-moving frame adds to the 35 points of full integration, one element at a time: frames
/// have no lanes.
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
    let mut group = c.benchmark_group(name);
    alone::<R, _, false, 3, 8>(&mut group, "force, plain", &plain);
    alone::<R, _, false, 3, 8>(&mut group, "force, co-moving", &moving);
    alone::<R, _, true, 3, 8>(&mut group, "tangent, plain", &plain);
    alone::<R, _, true, 3, 8>(&mut group, "tangent, co-moving", &moving);
    group.finish();
}

fn all(c: &mut Criterion) {
    elements!(c, f64, 3, 8, 9);
    elements!(c, f64, 2, 6, 6);
    elements!(c, f32, 3, 8, 9);
    elements!(c, f32, 2, 6, 6);
    co_moving::<f32>(c, "co-moving frame, f32");
    co_moving::<f64>(c, "co-moving frame, f64");
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
