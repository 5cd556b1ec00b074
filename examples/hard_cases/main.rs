//! The hard cases, row by row: slenderness, near incompressibility, roll-up, snap-through and
//! buckling, long and violent motions, the ends of the number range, each in double and single
//! precision. Every row says whether it converged or was refused and why, how many digits it kept
//! and against which truth. Figures and the table (CSV) go to `target/hard-cases/`; the exit
//! status is a failure when a row is wrong without saying so. `--quick` leaves out the long runs:
//! `cargo run --release --example hard_cases`.

mod buckle;
mod figures;
mod limits;
mod model;
mod motion;
#[allow(dead_code, reason = "the papers draw more than this example")]
#[path = "../../papers/orzechowski-2012/plot.rs"]
mod plot;
mod row;
mod slender;

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use row::{Claim, Done};

/// What the command line offers.
#[derive(Debug, Parser)]
#[command(about = "The hard cases: what converges, what is refused, and how many digits are kept")]
struct Options {
    /// Directory for the table and the figures.
    #[arg(long, default_value = "target/hard-cases")]
    out: PathBuf,
    /// Leave out the long runs.
    #[arg(long)]
    quick: bool,
    /// Only the rows of this family, without figures.
    #[arg(long)]
    only: Option<String>,
}

/// One decimal of a number of digits, a dash without.
fn decimal(digits: Option<f64>) -> String {
    digits.map_or("-".into(), |digits| format!("{digits:.1}"))
}

/// Digits that the row must keep: by theory and by what its report says of rounding.
fn claimed(done: &Done) -> Option<f64> {
    let Claim::Within(limit) = done.row.claim else {
        return None;
    };
    let told = done.answer()?.told;
    Some((limit + told).min(1.0).log10().abs())
}

fn print(done: &Done) {
    let (row, answer) = (&done.row, done.answer());
    println!(
        "{:58} {:4} {:17} {:>5} {:>6} {:6} {:7} {:7.2}  {}",
        row.case,
        row.number,
        row.form,
        decimal(done.digits()),
        decimal(claimed(done)),
        answer.map_or(0, |answer| answer.steps),
        answer.map_or(0, |answer| answer.iterations),
        done.seconds,
        done.verdict()
    );
}

fn table(rows: &[Done], out: &Path) -> Result<(), Box<dyn Error>> {
    let mut file = csv::Writer::from_path(out.join("hard-cases.csv"))?;
    file.write_record([
        "family",
        "case",
        "number",
        "formulation",
        "verdict",
        "digits",
        "digits_claimed",
        "truth",
        "steps",
        "iterations",
        "seconds",
    ])?;
    for done in rows {
        let (row, answer) = (&done.row, done.answer());
        file.write_record([
            row.family,
            &row.case,
            row.number,
            row.form,
            &done.verdict(),
            &decimal(done.digits()),
            &decimal(claimed(done)),
            row.truth,
            &answer.map_or(0, |answer| answer.steps).to_string(),
            &answer.map_or(0, |answer| answer.iterations).to_string(),
            &format!("{:.3}", done.seconds),
        ])?;
    }
    file.flush()?;
    Ok(())
}

fn run(options: &Options) -> Result<bool, Box<dyn Error>> {
    let start = Instant::now();
    std::fs::create_dir_all(&options.out)?;
    let rows = [
        slender::rows(),
        buckle::rows(),
        limits::rows(),
        motion::rows(),
    ];
    let wanted = rows.into_iter().flatten().filter(|row| {
        let only = options.only.as_ref();
        !(options.quick && row.long) && only.is_none_or(|family| row.family == family)
    });
    println!(
        "{:58} {:4} {:17} {:>5} {:>6} {:>6} {:>7} {:>7}  verdict",
        "case", "type", "formulation", "digits", "claim", "steps", "iter", "s"
    );
    let mut family = "";
    let mut done = Vec::new();
    for row in wanted {
        if row.family != family {
            family = row.family;
            println!("-- {family}");
        }
        let row = row.run();
        print(&row);
        done.push(row);
    }
    table(&done, &options.out)?;
    if options.only.is_none() {
        figures::all(&done, &options.out)?;
    }
    let silent = done.iter().filter(|row| row.silent()).count();
    let refused = done.iter().filter(|row| row.answer().is_none()).count();
    println!(
        "{} rows: {} answered, {refused} refused, {silent} silently wrong; {:.0} s; table and figures in {}",
        done.len(),
        done.len() - refused,
        start.elapsed().as_secs_f64(),
        options.out.display()
    );
    Ok(silent == 0)
}

fn main() -> ExitCode {
    match run(&Options::parse()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
