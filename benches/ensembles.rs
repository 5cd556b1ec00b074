//! Throughput of scenes in lanes against the same scenes one after the other, on one thread, both
//! measured by turns in one run.
//! `cargo bench --bench ensembles`

use std::time::Instant;

use ancf::prelude::*;
use ancf::scalar::{Laned, together};

/// Pendulum of `D` dimensions: the path of its tip by fixed steps.
fn swing<R: Real, const D: usize>(
    young: R,
    radius: R,
    scheme: &impl Scheme<R>,
    steps: usize,
) -> Result<[R; D]>
where
    FullyParameterised: Build<R, D>,
{
    FullyParameterised::pendulum(young, radius, scheme, steps)
}

/// What differs between the plane and space in types only.
trait Build<R: Real, const D: usize> {
    fn pendulum(young: R, radius: R, scheme: &impl Scheme<R>, steps: usize) -> Result<[R; D]>;
    fn cantilever(young: R, radius: R, load: R) -> Result<[R; D]>;
}

macro_rules! build {
    ($($d:literal),*) => {$(
        impl<R: Real> Build<R, $d> for FullyParameterised {
            fn pendulum(
                young: R,
                radius: R,
                scheme: &impl Scheme<R>,
                steps: usize,
            ) -> Result<[R; $d]> {
                let rubber = SaintVenantKirchhoff::isotropic(young, R::lit(0.3))?;
                let mut scene = Scene::<R, $d>::new();
                let mut along = [R::zero(); $d];
                along[0] = R::one();
                let rod = Beam::new(Self, Disk::new(radius)?, Continuum::selective_reduced(rubber))
                    .straight([R::zero(); $d], along, 10)
                    .density(R::lit(7200.0));
                let rod = scene.add(rod)?;
                scene.pin(rod.start())?;
                let mut down = [R::zero(); $d];
                down[1] = R::lit(-9.81);
                scene.gravity(down)?;
                let system = scene.assemble()?;
                let mut run = Integration::start(&system, system.rest(), scheme)?;
                for _ in 0..steps {
                    run.step(R::lit(1e-3))?;
                }
                system.position(run.state(), rod.end())
            }
            fn cantilever(young: R, radius: R, load: R) -> Result<[R; $d]> {
                let steel = SaintVenantKirchhoff::isotropic(young, R::lit(0.3))?;
                let mut scene = Scene::<R, $d>::new();
                let mut along = [R::zero(); $d];
                along[0] = R::one();
                let rod = Beam::new(Self, Disk::new(radius)?, Continuum::selective_reduced(steel))
                    .straight([R::zero(); $d], along, 10);
                let rod = scene.add(rod)?;
                scene.clamp(rod.start())?;
                let mut down = [R::zero(); $d];
                down[1] = -load;
                scene.force(rod.end(), down)?;
                let system = scene.assemble()?;
                let mut state = system.rest();
                Statics::in_steps(10).solve(&system, &mut state)?;
                system.position(&state, rod.end())
            }
        }
    )*};
}
build!(2, 3);

/// Best time of several of each, taken by turns, and the largest difference of the results.
fn compare<T: Laned, const D: usize>(
    name: &str,
    single: impl Fn(usize) -> Result<[T; D]>,
    packed: impl Fn() -> Result<[T::Pack; D]>,
) -> Result<()> {
    let (mut alone, mut lanes) = (f64::INFINITY, f64::INFINITY);
    let mut apart = 0.0_f64;
    for _ in 0..7 {
        let start = Instant::now();
        let one_by_one = (0..T::Pack::LANES)
            .map(&single)
            .collect::<Result<Vec<_>>>()?;
        alone = alone.min(start.elapsed().as_secs_f64());
        let start = Instant::now();
        let Some(together) = together(&packed) else {
            println!("{name}: the lanes part");
            return Ok(());
        };
        let together = together?.map(T::unpack);
        lanes = lanes.min(start.elapsed().as_secs_f64());
        for (lane, one) in one_by_one.iter().enumerate() {
            for (one, pack) in one.iter().zip(&together) {
                apart = apart.max((one.value() - pack[lane].value()).abs());
            }
        }
    }
    println!(
        "{name:42} {:9.3} ms {:9.3} ms {:6.2} {apart:9.1e} m",
        1e3 * alone,
        1e3 * lanes,
        alone / lanes
    );
    Ok(())
}

fn young<T: Laned>(lane: usize) -> T {
    T::lit(2.0e7 * (1.0 + 0.05 * lane as f64))
}
fn radius<T: Laned>(lane: usize) -> T {
    T::lit(0.01 * (1.0 + 0.02 * lane as f64))
}
fn load<T: Laned>(lane: usize) -> T {
    T::lit(0.3 * (1.0 + 0.1 * lane as f64))
}

fn both<T: Laned, const D: usize>(number: &str) -> Result<()>
where
    FullyParameterised: Build<T, D> + Build<T::Pack, D>,
{
    let (e, r, f) = (
        T::pack(young::<T>),
        T::pack(radius::<T>),
        T::pack(load::<T>),
    );
    compare::<T, D>(
        &format!("statics, {D}D, {number}"),
        |n| <FullyParameterised as Build<T, D>>::cantilever(young(n), radius(n), load(n)),
        || <FullyParameterised as Build<T::Pack, D>>::cantilever(e, r, f),
    )?;
    let newmark = Newmark::trapezoidal();
    compare::<T, D>(
        &format!("Newmark, {D}D, {number}"),
        |n| swing(young::<T>(n), radius(n), &newmark, 100),
        || swing(e, r, &newmark, 100),
    )?;
    let conserving = EnergyMomentum::conserving();
    compare::<T, D>(
        &format!("energy-momentum, {D}D, {number}"),
        |n| swing(young::<T>(n), radius(n), &conserving, 100),
        || swing(e, r, &conserving, 100),
    )
}

fn main() -> Result<()> {
    println!("10 elements, best of 7:                    one by one    in lanes  ratio      apart");
    both::<f64, 3>("f64")?;
    both::<f64, 2>("f64")
}
