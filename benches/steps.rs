//! Time of steps and iterations: `cargo bench --bench steps`. The paper's pendulum per step, steps of
//! pendulums of 4 to 65 536 elements, a static Newton iteration and the factorisation in it; pendulum and
//! iteration in narrower registers, too. Processor time of the thread and not of the clock: such runs are long
//! enough for others to have their turns in.
#![allow(
    missing_docs,
    reason = "criterion's macros define items without documentation"
)]

use std::hint::black_box;
use std::time::Duration;

use ancf::prelude::*;
use ancf::scalar::Registers;
use ancf::solver::{Factor, Matrix};
use cpu_time::ThreadTime;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group};

/// Processor time of work done a number of times.
fn spent(times: u64, mut work: impl FnMut()) -> Duration {
    let start = ThreadTime::now();
    for _ in 0..times {
        work();
    }
    start.elapsed()
}

/// How the start of the beam is held.
enum Held {
    Pinned,
    Clamped,
}

/// The paper's pendulum of a length (m) with `n` elements.
fn pendulum<const D: usize, const S: usize>(held: Held, length: f64, n: usize) -> System<f64, D>
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
    match held {
        Held::Pinned => scene.pin(beam.start()),
        Held::Clamped => scene.clamp(beam.start()),
    }
    .expect("a node");
    scene.gravity(axis(1, -9.81)).expect("finite gravity");
    scene.assemble().expect("a system")
}

fn steps<const D: usize, const S: usize>(c: &mut Criterion, name: &str)
where
    FullyParameterised: Element<D, S>,
    Continuum<SaintVenantKirchhoff<f64, D>>: Formulation<f64, FullyParameterised, D, S>,
{
    let mut group = c.benchmark_group(name);
    let system = pendulum::<D, S>(Held::Pinned, 1.0, 10);
    for refresh in [
        Refresh::EveryIteration,
        Refresh::EverySolve,
        Refresh::WhenSlow,
    ] {
        group.throughput(Throughput::Elements(200));
        group.bench_function(format!("200 steps, tangent {refresh:?}"), |b| {
            b.iter_custom(|times| {
                spent(times, || {
                    let newton = Newton {
                        refresh,
                        ..Newton::default()
                    };
                    let method = Newmark::trapezoidal().with_newton(newton);
                    let mut run =
                        Integration::start(&system, system.rest(), &method).expect("a run");
                    run.until(0.2, Stepping::Fixed(1e-3), |_| {})
                        .expect("0.2 s");
                    black_box(run.into_state());
                })
            });
        });
    }
    group.finish();
}

/// Numbers as many as the factors of a system, which go to memory and back as those of a step of two
/// iterations do, without any work.
struct Passing(Vec<f64>);

impl Passing {
    fn new<const D: usize>(system: &System<f64, D>) -> Self {
        // Four columns at a time begin with the row of the first.
        let column = |(j, reach): (usize, &usize)| reach + 1 - j + j % 4;
        let columns = system.unknowns().profile().reach().iter().enumerate();
        Self(vec![1.0; columns.map(column).sum()])
    }

    fn go(&mut self) {
        for _ in 0..2 {
            self.0.iter_mut().for_each(|x| *x *= 1.0 + 1e-9);
            let mut sums = [0.0; 32];
            for some in black_box(&self.0).rchunks_exact(sums.len()) {
                for (sum, x) in sums.iter_mut().zip(some) {
                    *sum += x;
                }
            }
            black_box(sums);
        }
    }
}

/// Forces, tangents and factors of a system at rest, one after the other.
struct Evaluations<'s, const D: usize> {
    system: &'s System<f64, D>,
    u: Vec<f64>,
    force: Vec<f64>,
    tangent: Matrix<f64>,
    factor: Factor<f64>,
    x: Vec<f64>,
}

impl<'s, const D: usize> Evaluations<'s, D> {
    fn of(system: &'s System<f64, D>) -> Self {
        let u = system.rest().displacement;
        Self {
            force: vec![0.0; u.len()],
            u,
            tangent: Matrix::zero(system.unknowns(), true),
            factor: Factor::new(system.unknowns().profile(), true),
            x: vec![0.0; system.unknowns().count()],
            system,
        }
    }

    /// Internal forces.
    fn force(&mut self) {
        self.force.fill(0.0);
        self.system
            .add_internal(black_box(&self.u), &mut self.force);
    }

    /// The tangent, this much of the mass with it, its factors and a solution.
    fn correction(&mut self, mass: Option<f64>) {
        let Self { system, u, x, .. } = self;
        self.tangent.clear();
        let ready = &mut |_: &mut Matrix<f64>, _| Ok(());
        system
            .add_tangent_in_order(0.0, 1.0, black_box(u), mass, &mut self.tangent, ready)
            .expect("a tangent");
        x.fill(1.0);
        self.factor
            .factor_and_solve(self.tangent.stored(), x)
            .expect("a definite matrix");
    }

    /// What a step of two iterations evaluates, and nothing else that it does.
    fn go(&mut self) {
        for iteration in 0..3 {
            self.force();
            let Self { system, u, .. } = self;
            system.add_mass_times(1.0, black_box(u), &mut self.force);
            if iteration < 2 {
                self.correction(Some(4e6));
            }
        }
    }
}

/// Steps from rest of pendulums whose elements are all of the same length: every element has the same
/// work to do, however many there are. By turns, the best of each: what others do on a machine, and to its
/// memory, comes and goes within a run. Beside them what forces, tangents and factors take by themselves, and
/// memory alone for the factors.
fn sizes<const D: usize, const S: usize>(name: &str)
where
    FullyParameterised: Element<D, S>,
    Continuum<SaintVenantKirchhoff<f64, D>>: Formulation<f64, FullyParameterised, D, S>,
{
    const SIZES: [usize; 8] = [4, 16, 64, 256, 1024, 4096, 16384, 65536];
    const TURNS: usize = 12;
    let systems = SIZES.map(|n| pendulum::<D, S>(Held::Pinned, 0.1 * n as f64, n));
    let method = Newmark::trapezoidal();
    let mut best = [[Duration::MAX; 3]; SIZES.len()];
    for _ in 0..TURNS {
        for (system, (n, best)) in systems.iter().zip(SIZES.iter().zip(&mut best)) {
            let (mut evaluations, mut passing) = (Evaluations::of(system), Passing::new(system));
            evaluations.go();
            passing.go();
            // As many elements in every turn, within limits.
            for _ in 0..(16384 / n).clamp(1, 256) {
                let run = Integration::start(system, system.rest(), &method);
                let mut run = run.expect("a run");
                // Pages of memory that are asked for first take longer than a step.
                run.until(1e-3, Stepping::Fixed(1e-3), |_| {})
                    .expect("a step");
                let four = spent(1, || {
                    run.until(5e-3, Stepping::Fixed(1e-3), |_| {})
                        .expect("four steps");
                });
                let times = [
                    four,
                    spent(4, || evaluations.go()),
                    spent(4, || passing.go()),
                ];
                *best = std::array::from_fn(|k| times[k].min(best[k]));
            }
        }
    }
    println!(
        "{name}: us per step and element and over that of 64; the same of forces, tangents and"
    );
    println!("factors by themselves, and what factors take in memory alone");
    let per_element =
        |k: usize| best[k].map(|time| time.as_secs_f64() * 1e6 / (4 * SIZES[k]) as f64);
    let [step_of_64, evaluations_of_64, _] = per_element(2);
    for (k, n) in SIZES.iter().enumerate() {
        let [step, evaluations, memory] = per_element(k);
        let over = [step / step_of_64, evaluations / evaluations_of_64];
        println!(
            "{n:6} {step:6.3} {:5.2} {evaluations:6.3} {:5.2} {memory:6.3}",
            over[0], over[1]
        );
    }
}

/// Residual, tangent, factors and correction of a static Newton iteration.
fn iteration<const D: usize, const S: usize>(c: &mut Criterion, name: &str)
where
    FullyParameterised: Element<D, S>,
    Continuum<SaintVenantKirchhoff<f64, D>>: Formulation<f64, FullyParameterised, D, S>,
{
    let mut group = c.benchmark_group(name);
    for n in [4, 64, 65536] {
        let system = pendulum::<D, S>(Held::Clamped, 0.1 * n as f64, n);
        let mut evaluations = Evaluations::of(&system);
        group.throughput(Throughput::Elements(n as u64));
        group.bench_function(BenchmarkId::from_parameter(n), |b| {
            b.iter_custom(|times| {
                spent(times, || {
                    evaluations.force();
                    evaluations.correction(None);
                })
            });
        });
    }
    group.finish();
}

/// A step of a long chain, by the clock, on one thread and on two of rayon's.
#[cfg(feature = "rayon")]
fn threads(c: &mut Criterion) {
    let mut group = c.benchmark_group("four steps in space, 65536 elements, threads");
    let system = pendulum::<3, 8>(Held::Pinned, 6553.6, 65536);
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = pool.build().expect("threads");
        group.throughput(Throughput::Elements(4 * 65536));
        group.bench_function(BenchmarkId::from_parameter(threads), |b| {
            let method = Newmark::trapezoidal();
            b.iter_batched(
                || {
                    let mut run =
                        Integration::start(&system, system.rest(), &method).expect("a run");
                    run.until(1e-3, Stepping::Fixed(1e-3), |_| {})
                        .expect("a step");
                    run
                },
                |mut run| {
                    pool.install(|| run.until(5e-3, Stepping::Fixed(1e-3), |_| {}))
                        .expect("four steps");
                    run
                },
                criterion::BatchSize::PerIteration,
            );
        });
    }
    group.finish();
}

fn factorisation(c: &mut Criterion) {
    let mut group = c.benchmark_group("factor and solve, spatial chain");
    for n in [10, 100, 1000] {
        let system = pendulum::<3, 8>(Held::Pinned, 1.0, n);
        let mut evaluations = Evaluations::of(&system);
        evaluations.correction(Some(4e6));
        let Evaluations {
            tangent, factor, x, ..
        } = &mut evaluations;
        group.throughput(Throughput::Elements(n as u64));
        group.bench_function(BenchmarkId::from_parameter(n), |b| {
            b.iter_custom(|times| {
                spent(times, || {
                    factor.factor(tangent.stored()).expect("a definite matrix");
                    x.fill(1.0);
                    factor.solve(x).expect("factors");
                })
            });
        });
    }
    group.finish();
}

fn all(c: &mut Criterion) {
    for registers in Registers::available() {
        Registers::limit(registers);
        let name = |room| format!("pendulum in {room}, 10 elements, {registers:?}");
        steps::<3, 8>(c, &name("space"));
        steps::<2, 6>(c, &name("the plane"));
        let name = |room| format!("static iteration in {room}, {registers:?}, elements");
        iteration::<3, 8>(c, &name("space"));
        iteration::<2, 6>(c, &name("the plane"));
    }
    factorisation(c);
    #[cfg(feature = "rayon")]
    threads(c);
}

/// Short measurements, whose noise is that of the machine.
fn settings() -> Criterion {
    Criterion::default()
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1))
        .sample_size(10)
}

criterion_group!(name = benches; config = settings(); targets = all);

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let has = |name: &str| arguments.iter().any(|one| one == name);
    let measures = has("--bench") && !has("--test") && !has("--list");
    // What criterion takes for a filter: no option, nor the value of one.
    let filter = (0..arguments.len()).find(|k| {
        let is_option = |k: usize| arguments[k].starts_with('-');
        !is_option(*k) && (*k == 0 || arguments[k - 1] == "--bench" || !is_option(k - 1))
    });
    let asked = |name: &str| measures && filter.is_none_or(|k| name.contains(&arguments[k]));
    for (name, sizes) in [
        ("four steps in space", sizes::<3, 8> as fn(&str)),
        ("four steps in the plane", sizes::<2, 6>),
    ] {
        if asked(name) {
            sizes(name);
        }
    }
    benches();
    Criterion::default().configure_from_args().final_summary();
}
