//! What accuracy costs: processor time against error for elements, formulations, meshes, number
//! types, integrators and steps, on the three problems of Orzechowski (2012) and on three published
//! references. Tables, figures and the cheapest run for every tolerance go to
//! `target/work-precision/`; what they say is told in `papers/speed-against-error.md`.

mod figures;
mod measure;
mod model;
mod paper;
#[allow(dead_code, reason = "the papers draw more than this example")]
#[path = "../../papers/orzechowski-2012/plot.rs"]
mod plot;
mod published;
mod ranking;
mod sweep;
mod table;

use std::error::Error;
use std::path::PathBuf;

use clap::Parser;
use sweep::Study;

/// What the command line offers.
#[derive(Debug, Parser)]
#[command(about = "Processor time against error, for everything there is to choose")]
struct Options {
    /// Directory for tables and figures.
    #[arg(long, default_value = "target/work-precision")]
    out: PathBuf,
    /// Leave out the two finest meshes of what moves.
    #[arg(long)]
    quick: bool,
    /// Only problems whose name contains this.
    #[arg(long, default_value = "")]
    only: String,
}

/// Runs a problem.
type Problem = fn(&mut Study) -> ancf::Result<()>;

/// Names, titles and programs of the problems.
const PROBLEMS: [(&str, &str, Problem); 6] = [
    ("roll-up", "5.1 roll-up", paper::roll_up),
    ("pendulum", "5.2 pendulum, 0.5 s", paper::pendulum),
    ("ramp", "5.3 ramp, 1 s", paper::ramp),
    ("bend", "45 degree bend", published::bend),
    (
        "right-angle",
        "right-angle cantilever, 4 s",
        published::right_angle,
    ),
    ("spin-up", "spin-up, 8 s", published::spin_up),
];

fn main() -> Result<(), Box<dyn Error>> {
    let options = Options::parse();
    let out = &options.out;
    std::fs::create_dir_all(out)?;
    plot::prepare()?;
    let mut records = Vec::new();
    for (name, title, run) in PROBLEMS {
        if !name.contains(&options.only) {
            continue;
        }
        let start = cpu_time::ThreadTime::now();
        let mut study = Study::new(name, options.quick);
        run(&mut study)?;
        let spent = start.elapsed().as_secs_f64();
        eprintln!("{title}: {} runs in {spent:.0} s", study.records.len());
        figures::draw(title, &study.records, out)?;
        records.extend(study.records);
        // A run that is cut short leaves what it has.
        ranking::runs(&records, out)?;
    }
    ranking::write(&records, out)
}
