//! Time of the kernels and of whole steps: `cargo bench`. Elements per second for force and
//! tangent of the spatial and the planar beam, factorisation per element, and the paper's
//! pendulum per step.
#![allow(
    missing_docs,
    reason = "criterion's macros define items without documentation"
)]

use std::hint::black_box;

use ancf::formulation::{ElementKernel, Reference, Tangent};
use ancf::prelude::*;
use ancf::solver::{Factor, Matrix};
use criterion::measurement::WallTime;
use criterion::{
    BenchmarkGroup, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main,
};

type Rule<const D: usize> =
    fn(SaintVenantKirchhoff<f64, D>) -> Continuum<SaintVenantKirchhoff<f64, D>>;

fn rubber<const D: usize>() -> SaintVenantKirchhoff<f64, D> {
    SaintVenantKirchhoff::isotropic(2.0e7, 0.3).expect("admissible constants")
}

/// Force, and force with tangent, of one kernel.
fn timed<R: Real, K: ElementKernel<R, D, S>, const D: usize, const S: usize>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    name: &str,
    kernel: &K,
    u: &[[R; D]; S],
) {
    group.bench_function(BenchmarkId::new("force", name), |b| {
        b.iter(|| {
            let mut q = [[R::zero(); D]; S];
            kernel.force(black_box(u), &mut q);
            q
        });
    });
    group.bench_function(BenchmarkId::new("force and tangent", name), |b| {
        let mut k: Tangent<R, D, S> = [[[[R::zero(); D]; S]; D]; S];
        b.iter(|| {
            let mut q = [[R::zero(); D]; S];
            kernel.tangent(black_box(u), &mut q, &mut k);
            black_box(&k);
            q
        });
    });
}

fn element<const D: usize, const S: usize>(c: &mut Criterion, name: &str)
where
    FullyParameterised: Element<D, S>,
    Continuum<SaintVenantKirchhoff<f64, D>>: Formulation<f64, FullyParameterised, D, S>,
{
    let rules: [(&str, Rule<D>); 3] = [
        ("full", Continuum::full),
        ("reduced", Continuum::reduced),
        ("selective", Continuum::selective_reduced),
    ];
    let disk = Disk::new(0.01).expect("a radius");
    let reference = Reference::straight(
        &FullyParameterised,
        0.1,
        std::array::from_fn(|a| std::array::from_fn(|c| f64::from(u8::from(a == c)))),
    );
    let u: [[f64; D]; S] =
        std::array::from_fn(|i| std::array::from_fn(|c| 1e-2 * ((3 * i + c + 1) as f64).sin()));
    let mut group = c.benchmark_group(name);
    for (rule, make) in rules {
        let kernel = make(rubber())
            .kernel(&FullyParameterised, &reference, &disk)
            .expect("a rule of full rank");
        timed(&mut group, rule, &kernel, &u);
    }
    group.finish();
}

/// What the co-moving frame costs a spatial element with full integration.
fn co_moving<R: Real>(c: &mut Criterion, name: &str) {
    let solid = SaintVenantKirchhoff::isotropic(R::lit(2.0e7), R::lit(0.3));
    let rule = Continuum::full(solid.expect("admissible constants"));
    let disk = Disk::new(R::lit(0.01)).expect("a radius");
    let axis = |a| std::array::from_fn(|c| R::lit(if a == c { 1.0 } else { 0.0 }));
    let frame = std::array::from_fn(axis);
    let reference = Reference::straight(&FullyParameterised, R::lit(0.1), frame);
    let u = |i| std::array::from_fn(|c| R::lit(1e-2 * ((3 * i + c + 1) as f64).sin()));
    let u: [[R; 3]; 8] = std::array::from_fn(u);
    let plain = rule.kernel(&FullyParameterised, &reference, &disk);
    let moving = CoMoving(rule).kernel(&FullyParameterised, &reference, &disk);
    let mut group = c.benchmark_group(name);
    timed(
        &mut group,
        "plain",
        &plain.expect("a rule of full rank"),
        &u,
    );
    timed(&mut group, "co-moving", &moving.expect("the same"), &u);
    group.finish();
}

/// The paper's pendulum with `n` elements.
fn pendulum<const D: usize, const S: usize>(n: usize) -> System<f64, D>
where
    FullyParameterised: Element<D, S>,
    Continuum<SaintVenantKirchhoff<f64, D>>: Formulation<f64, FullyParameterised, D, S>,
{
    let axis = |k: usize, v: f64| std::array::from_fn(|c| if c == k { v } else { 0.0 });
    let mut scene = Scene::<f64, D>::new();
    let disk = Disk::new(0.01).expect("a radius");
    let solid = SaintVenantKirchhoff::isotropic(2.0e7, 0.0).expect("admissible constants");
    let beam = Beam::new(FullyParameterised, disk, Continuum::full(solid))
        .straight([0.0; D], axis(0, 1.0), n)
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
    let system = pendulum::<D, S>(10);
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

fn factorisation(c: &mut Criterion) {
    let mut group = c.benchmark_group("factor and solve, spatial chain");
    for n in [10, 100, 1000] {
        let system = pendulum::<3, 8>(n);
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
    element::<3, 8>(c, "spatial element");
    element::<2, 6>(c, "planar element");
    co_moving::<f32>(c, "co-moving frame, f32");
    co_moving::<f64>(c, "co-moving frame, f64");
    steps::<3, 8>(c, "pendulum in space, 10 elements");
    steps::<2, 6>(c, "pendulum in the plane, 10 elements");
    factorisation(c);
}

criterion_group!(benches, all);
criterion_main!(benches);
