//! Time of the kernels and of whole steps: `cargo bench`. Force and tangent of the spatial and the
//! planar element at section points, from moments, in lanes and in a chain, factorisation per
//! element, and the paper's pendulum per step.
#![allow(
    missing_docs,
    reason = "criterion's macros define items without documentation"
)]

use std::hint::black_box;
use std::time::{Duration, Instant};

use ancf::formulation::{ElementKernel, Reference, Tangent};
use ancf::prelude::*;
use ancf::scalar::{LaneWork, Lanes};
use ancf::solver::{Factor, Matrix};
use ancf::verify::ByPoints;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};

fn rubber<R: Real, const D: usize>() -> SaintVenantKirchhoff<R, D> {
    SaintVenantKirchhoff::isotropic(R::lit(2.0e7), R::lit(0.3)).expect("admissible constants")
}

fn axes<R: Real, const D: usize>() -> [[R; D]; D] {
    std::array::from_fn(|a| std::array::from_fn(|c| if a == c { R::one() } else { R::zero() }))
}

/// Evaluates a group of elements, one in each lane, a number of times; says how many and how long.
struct Timed<'a, Kn, const D: usize, const S: usize> {
    kernel: &'a Kn,
    tangent: bool,
    times: u64,
}

impl<R, Kn, const D: usize, const S: usize> LaneWork<R> for Timed<'_, Kn, D, S>
where
    R: Real,
    Kn: ElementKernel<R, D, S>,
{
    type Output = (usize, Duration);

    #[inline(always)]
    fn run<L: Lanes<R>>(self) -> (usize, Duration) {
        let mut u = [[L::zero(); D]; S];
        for i in 0..S {
            for c in 0..D {
                u[i][c] = L::lit(1e-2 * ((3 * i + c + 1) as f64).sin());
            }
        }
        let mut k: Tangent<L, D, S> = [[[[L::zero(); D]; S]; D]; S];
        let start = Instant::now();
        for _ in 0..self.times {
            let mut q = [[L::zero(); D]; S];
            if self.tangent {
                self.kernel.tangent(black_box(&u), &mut q, &mut k);
            } else {
                self.kernel.force(black_box(&u), &mut q);
            }
            black_box((&q, &k));
        }
        (L::WIDTH, start.elapsed())
    }
}

/// One element at section points and from moments, then in lanes, then in a chain.
fn element<R: Real, const D: usize, const S: usize>(c: &mut Criterion, name: &str)
where
    FullyParameterised: Element<D, S>,
    Continuum<SaintVenantKirchhoff<R, D>>: Formulation<R, FullyParameterised, D, S>,
    Continuum<ByPoints<SaintVenantKirchhoff<R, D>>>: Formulation<R, FullyParameterised, D, S>,
{
    let disk = Disk::new(R::lit(0.01)).expect("a radius");
    let reference = Reference::straight(&FullyParameterised, R::lit(0.1), axes::<R, D>());
    let moments = Continuum::selective_reduced(rubber())
        .kernel(&FullyParameterised, &reference, &disk)
        .expect("a rule of full rank");
    let points = Continuum::full(ByPoints(rubber()))
        .kernel(&FullyParameterised, &reference, &disk)
        .expect("a rule of full rank");
    const CHAIN: usize = 64;
    let mut scene = Scene::<R, D>::new();
    let beam = Beam::new(FullyParameterised, disk, Continuum::full(rubber()));
    scene
        .add(beam.straight([R::zero(); D], axes::<R, D>()[0], CHAIN))
        .expect("a beam");
    let system = scene.assemble().expect("a system");
    let size = system.reference().len();
    let u: Vec<R> = (0..size).map(|i| R::lit(1e-2 * (i as f64).sin())).collect();
    let mut q = vec![R::zero(); size];
    let mut k = Matrix::zero(system.unknowns(), true);
    let mut group = c.benchmark_group(name);
    for (what, tangent) in [("force", false), ("force and tangent", true)] {
        group.throughput(Throughput::Elements(1));
        let kernel = &points;
        group.bench_function(BenchmarkId::new(what, "points"), |b| {
            let timed = |times| Timed {
                kernel,
                tangent,
                times,
            };
            b.iter_custom(|times| timed(times).run::<R>().1);
        });
        let kernel = &moments;
        let timed = |times| Timed {
            kernel,
            tangent,
            times,
        };
        group.bench_function(BenchmarkId::new(what, "moments"), |b| {
            b.iter_custom(|times| timed(times).run::<R>().1);
        });
        let (width, _) = R::dispatch(timed(1));
        group.throughput(Throughput::Elements(width as u64));
        group.bench_function(BenchmarkId::new(what, format!("{width} lanes")), |b| {
            b.iter_custom(|times| R::dispatch(timed(times)).1);
        });
        group.throughput(Throughput::Elements(CHAIN as u64));
        group.bench_function(BenchmarkId::new(what, "chain of 64"), |b| {
            b.iter(|| match tangent {
                false => system.add_internal(black_box(&u), &mut q),
                true => system
                    .add_tangent(R::zero(), R::one(), black_box(&u), &mut k)
                    .expect("a tangent"),
            });
        });
    }
    group.finish();
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
    let mut group = c.benchmark_group(name);
    for (what, tangent) in [("force", false), ("force and tangent", true)] {
        let kernel = &plain;
        group.bench_function(BenchmarkId::new(what, "plain"), |b| {
            let timed = |times| Timed {
                kernel,
                tangent,
                times,
            };
            b.iter_custom(|times| timed(times).run::<R>().1);
        });
        let kernel = &moving;
        group.bench_function(BenchmarkId::new(what, "co-moving"), |b| {
            let timed = |times| Timed {
                kernel,
                tangent,
                times,
            };
            b.iter_custom(|times| timed(times).run::<R>().1);
        });
    }
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
    element::<f64, 3, 8>(c, "spatial element");
    element::<f64, 2, 6>(c, "planar element");
    element::<f32, 3, 8>(c, "spatial element in f32");
    element::<f32, 2, 6>(c, "planar element in f32");
    co_moving::<f32>(c, "co-moving frame, f32");
    co_moving::<f64>(c, "co-moving frame, f64");
    steps::<3, 8>(c, "pendulum in space, 10 elements");
    steps::<2, 6>(c, "pendulum in the plane, 10 elements");
    factorisation(c);
}

criterion_group!(benches, all);
criterion_main!(benches);
