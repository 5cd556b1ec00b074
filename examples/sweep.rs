//! The pendulum of the paper for many moduli, radii and weights: in lanes, on threads and, by
//! shards, on any number of machines.
//! `cargo run --release --example sweep`
//!
//! Spread over processes and put together again:
//! `sweep --shard 0/2 > a.csv`, `sweep --shard 1/2 > b.csv`, `sweep --merge a.csv b.csv`

use std::path::PathBuf;

use ancf::prelude::*;
use ancf::sweep::{Experiment, Sweep, merge};
use clap::Parser;

/// Where the tip of a pendulum is after 0.3 s, for a Young's modulus (Pa), a radius (m) and an
/// acceleration of gravity (m/s^2).
struct Pendulum;

impl Experiment<3> for Pendulum {
    fn run<R: Real>(&self, [young, radius, gravity]: [R; 3]) -> Result<Vec<R>> {
        let rubber = SaintVenantKirchhoff::isotropic(young, R::lit(0.3))?;
        let formulation = Continuum::selective_reduced(rubber);
        let mut scene = Scene::<R, 2>::new();
        let rod = Beam::new(FullyParameterised, Disk::new(radius)?, formulation)
            .straight([R::zero(); 2], [R::one(), R::zero()], 8)
            .density(R::lit(7200.0));
        let rod = scene.add(rod)?;
        scene.pin(rod.start())?;
        scene.gravity([R::zero(), -gravity])?;
        let system = scene.assemble()?;
        let mut run = Integration::start(&system, system.rest(), &Newmark::trapezoidal())?;
        run.until(R::lit(0.3), Stepping::Fixed(1e-3), |_| {})?;
        Ok(system.position(run.state(), rod.end())?.to_vec())
    }
}

/// Runs a sweep, or one shard of it, and writes its table; or merges tables.
#[derive(Parser)]
struct Options {
    /// Shard to run and number of shards, counted from zero: 0/4 to 3/4.
    #[arg(long, value_parser = shard, default_value = "0/1")]
    shard: (usize, usize),
    /// Threads to use.
    #[arg(long, default_value_t = 1)]
    threads: usize,
    /// Runs one row after the other, for comparison.
    #[arg(long)]
    one_by_one: bool,
    /// Tables of all shards, to merge instead.
    #[arg(long, num_args = 1..)]
    merge: Vec<PathBuf>,
}

fn shard(text: &str) -> std::result::Result<(usize, usize), String> {
    let (index, count) = text.split_once('/').ok_or("give it as i/n")?;
    let number = |text: &str| text.parse().map_err(|_| format!("{text} is not a number"));
    Ok((number(index)?, number(count)?))
}

fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    let options = Options::parse();
    if !options.merge.is_empty() {
        let read = options.merge.iter().map(std::fs::read_to_string);
        print!("{}", merge(&read.collect::<std::io::Result<Vec<_>>>()?)?);
        return Ok(());
    }
    let young = [1e7, 1.5e7, 2e7, 3e7, 4e7, 6e7];
    let radius = [0.008, 0.01, 0.012, 0.014];
    let gravity = [1.62, 3.72, 9.81];
    let (index, count) = options.shard;
    let sweep = Sweep::grid([&young, &radius, &gravity])?
        .shard(index, count)?
        .on_threads(options.threads)?;
    let sweep = match options.one_by_one {
        true => sweep,
        false => sweep.in_lanes(),
    };
    let start = std::time::Instant::now();
    let results = sweep.run(&Pendulum);
    eprintln!("{} rows in {:.2?}", results.rows().len(), start.elapsed());
    let names = ["E (Pa)", "R (m)", "g (m/s^2)", "x (m)", "y (m)"];
    print!("{}", results.table("pendulum", &names)?);
    Ok(())
}
