//! Throughput of the rows of a sweep in lanes against the same rows one after the other, on one
//! thread, and in lanes on all cores: by turns in one run, as many times 8 scenes of 10 elements as
//! there are cores, assembly included. What runs one by one has its elements in lanes (column 2); the same
//! in baseline code has none (column 1). In all registers but these. `cargo bench --bench ensembles`

use std::time::Instant;

use ancf::prelude::*;
use ancf::scalar::Registers;
use ancf::sweep::{Experiment, Sweep};

/// A pendulum for `[E, R]` and 200 steps of 1 ms.
struct Pendulum<S, const D: usize>(S);
/// A cantilever for `[E, R, load]`, loaded in 10 steps.
struct Cantilever<const D: usize>;
/// An arch in the plane for `[E, R, load]`, clamped and loaded at its crown in 10 steps. Each of its
/// elements has a kernel of its own, so that alone they have no lanes.
struct Arch;

impl Experiment<3> for Arch {
    fn run<R: Real>(&self, [young, radius, load]: [R; 3]) -> Result<Vec<R>> {
        let mut scene = Scene::<R, 2>::new();
        let rubber = SaintVenantKirchhoff::isotropic(young, R::lit(0.3))?;
        let formulation = Continuum::selective_reduced(rubber);
        let beam = Beam::new(FullyParameterised, Disk::new(radius)?, formulation);
        let arch = scene.add(beam.curved(R::pi(), 10, |s| {
            let (sin, cos) = (Field::sin(s * R::pi()), Field::cos(s * R::pi()));
            ([-cos, sin], [[sin, cos], [-cos, sin]])
        }))?;
        scene.clamp(arch.start())?;
        scene.clamp(arch.end())?;
        scene.force(arch.node(5), [R::zero(), -load])?;
        let system = scene.assemble()?;
        let mut state = system.rest();
        Statics::in_steps(10).solve(&system, &mut state)?;
        Ok(system.position(&state, arch.node(5))?.to_vec())
    }
}

macro_rules! experiments {
    ($($d:literal),*) => {$(
        experiments!(@pendulum $d, Newmark);
        experiments!(@pendulum $d, EnergyMomentum);

        impl Experiment<3> for Cantilever<$d> {
            fn run<R: Real>(&self, [young, radius, load]: [R; 3]) -> Result<Vec<R>> {
                let mut scene = Scene::<R, $d>::new();
                let rod = scene.add(rod::<R, $d>(young, radius)?)?;
                scene.clamp(rod.start())?;
                scene.force(rod.end(), axis(1, -load))?;
                let system = scene.assemble()?;
                let mut state = system.rest();
                Statics::in_steps(10).solve(&system, &mut state)?;
                Ok(system.position(&state, rod.end())?.to_vec())
            }
        }
    )*};
    (@pendulum $d:literal, $scheme:ty) => {
        impl Experiment<2> for Pendulum<$scheme, $d> {
            fn run<R: Real>(&self, [young, radius]: [R; 2]) -> Result<Vec<R>> {
                let mut scene = Scene::<R, $d>::new();
                let rod = scene.add(rod::<R, $d>(young, radius)?)?;
                scene.pin(rod.start())?;
                scene.gravity(axis(1, R::lit(-9.81)))?;
                let system = scene.assemble()?;
                let mut run = Integration::start(&system, system.rest(), &self.0)?;
                run.until(R::lit(0.2), Stepping::Fixed(1e-3), |_| {})?;
                Ok(system.position(run.state(), rod.end())?.to_vec())
            }
        }
    };
}
experiments!(2, 3);

type Rod<R, const D: usize> =
    Beam<R, FullyParameterised, Continuum<SaintVenantKirchhoff<R, D>>, Disk<R>, D>;

fn axis<R: Real, const D: usize>(a: usize, size: R) -> [R; D] {
    std::array::from_fn(|c| if c == a { size } else { R::zero() })
}

fn rod<R: Real, const D: usize>(young: R, radius: R) -> Result<Rod<R, D>> {
    let rubber = SaintVenantKirchhoff::isotropic(young, R::lit(0.3))?;
    let formulation = Continuum::selective_reduced(rubber);
    let beam = Beam::new(FullyParameterised, Disk::new(radius)?, formulation);
    let placed = beam.straight([R::zero(); D], axis(0, R::one()), 10);
    Ok(placed.density(R::lit(7200.0)))
}

/// Best times of several, and the largest difference of the results.
fn compare<const P: usize>(
    name: &str,
    experiment: &impl Experiment<P>,
    row: impl Fn(f64) -> [f64; P],
) -> Result<()> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let rows = (0..8 * cores).map(|n| row((n % 8) as f64));
    let alone = Sweep::list(rows.collect())?;
    let lanes = alone.clone().in_lanes();
    let spread = lanes.clone().on_threads(cores)?;
    let mut best = [f64::INFINITY; 4];
    let mut apart = 0.0_f64;
    let registers = Registers::widest();
    let turns = [
        (&alone, Registers::Baseline),
        (&alone, registers),
        (&lanes, registers),
        (&spread, registers),
    ];
    for _ in 0..7 {
        let mut results = Vec::new();
        for ((sweep, registers), best) in turns.into_iter().zip(&mut best) {
            Registers::limit(registers);
            let start = Instant::now();
            results.push(sweep.run(experiment));
            *best = best.min(start.elapsed().as_secs_f64());
        }
        let [_, alone, in_lanes @ ..] = &results[..] else {
            continue;
        };
        for other in in_lanes {
            for (one, lane) in alone.rows().iter().zip(other.rows()) {
                for (one, lane) in one.outputs.clone()?.iter().zip(lane.outputs.clone()?) {
                    apart = apart.max((one - lane).abs());
                }
            }
        }
    }
    let [plain, alone, lanes, spread] = best.map(|time| 1e3 * time / cores as f64);
    println!(
        "{name:22} {plain:8.2} {alone:8.2} {lanes:8.2} {:6.1} {:6.2} {spread:9.2} {:6.2} {apart:9.1e}",
        plain / lanes,
        alone / lanes,
        alone / spread,
    );
    Ok(())
}

fn main() -> Result<()> {
    let rod = |n: f64| [2.0e7 * (1.0 + 0.05 * n), 0.01 * (1.0 + 0.02 * n)];
    let loaded = |n: f64| [rod(n)[0], rod(n)[1], 0.1 * (1.0 + 0.1 * n)];
    let newmark = Newmark::trapezoidal();
    // When its tangent is renewed must not depend on the lane.
    let conserving = EnergyMomentum::conserving();
    let newton = Newton {
        refresh: Refresh::EverySolve,
        ..conserving.newton
    };
    let conserving = conserving.with_newton(newton);
    let all: Vec<_> = Registers::available().collect();
    for registers in &all[all.len().min(2) - 1..] {
        Registers::limit(*registers);
        println!("{registers:?}, ms for 8 scenes");
        println!(
            "{:22} {:>8} {:>8} {:>8} {:>6} {:>6} {:>9} {:>6} {:>9}",
            "",
            "no lanes",
            "elements",
            "scenes",
            "over 1",
            "over 2",
            "all cores",
            "over 2",
            "apart (m)"
        );
        compare("plane, Newmark", &Pendulum::<_, 2>(newmark), rod)?;
        compare("plane, statics", &Cantilever::<2>, loaded)?;
        compare("plane, arch, statics", &Arch, loaded)?;
        compare("plane, energy-momentum", &Pendulum::<_, 2>(conserving), rod)?;
        compare("space, Newmark", &Pendulum::<_, 3>(newmark), rod)?;
        compare("space, statics", &Cantilever::<3>, loaded)?;
        compare("space, energy-momentum", &Pendulum::<_, 3>(conserving), rod)?;
    }
    Ok(())
}
